"""The flare of a lens on each frame of a sequence, for the lights that the frame shows or a file lists."""

import dataclasses
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from aureole import light, refuse
from aureole.glare import luminances
from aureole.jobs.flare import FlareJob, FlareResult, refuse_words, run_flare
from aureole.jobs.frames import FrameMaker, Pace, digest
from aureole.jobs.glare import in_working_space
from aureole.jobs.glare_lights import lights_of_frame
from aureole.records import Picture

# Fields of a job that no frame's words name: what each frame has of its own, and what changes no pixel.
APART = ("over", "lights", "memory")
# Of a frame's numbers, those that its line in a log tells.
TOLD = ("ghosts", "ghost_to_image")


@dataclass(frozen=True, eq=False)
class FlareMaker(FrameMaker):
    """Adds a lens's flare to frames.

    Parameters
    ----------
    job : FlareJob
        What to make; its picture and its listed lights are not looked at, and it keeps no layers.
    lights : Path, optional
        File of lights, as `aureole.glare.write_lamps` writes it; each frame has those of its number.
    pace : Pace
        When frames are, for what moves on the opening.
    """

    job: FlareJob
    lights: Path | None = None
    pace: Pace = field(default_factory=Pace)

    @property
    def moves(self) -> bool:
        """Whether something on the opening is elsewhere at another time."""
        return self.job.opening.at(time=1.0) != self.job.opening

    def refuse(self) -> None:
        """Refuse, before any work, what no frame could be made with."""
        refuse_words(self.job)
        light.illuminant(self.job.illuminant)
        if self.job.find == "auto":
            raise refuse.Refusal("'find' must be one luminance for all frames of a sequence, got 'auto'.")
        if not self.job.lamps and self.job.find is None and self.lights is None:
            raise refuse.Refusal("no light is given for the frames: --lights FILE, --find-lights or --light.")

    def words(self, number: int) -> str:
        """Return what a frame's file says of itself, the same for the same job and lights alone.

        Parameters
        ----------
        number : int
            The frame's.

        Returns
        -------
        str
            A few words.
        """
        plain = {name: value for name, value in vars(self.job).items() if name not in APART}
        named = [Path(name) for name in (self.job.iris, self.job.opening.picture) if name is not None]
        held = [digest(path.read_bytes()) for path in named if path.is_file()]
        listed: Any = None
        if self.lights is not None:
            try:
                listed = lights_of_frame(self.lights, number)
            except refuse.Refusal as refusal:
                # The frame itself will be refused for it, and stops none of the rest.
                listed = str(refusal)
        return f"aureole flare {digest(plain, held, listed, self.pace if self.moves else None)}"

    def make(self, source: Picture, number: int) -> tuple[Picture, dict[str, Any]]:
        """Return a frame from the picture of its source, and its plain numbers.

        Parameters
        ----------
        source : Picture
            Linear.
        number : int
            The frame's.

        Returns
        -------
        picture : Picture
            With the flare; as it was where no light is to be seen.
        report : dict
            Plain numbers.
        """
        listed = None if self.lights is None else lights_of_frame(self.lights, number)
        if not (self.job.lamps or (listed and listed.sightings) or self._shows(source)):
            return source, {"lights": 0}
        # A threshold that no light of this frame reaches would be refused, which is right for one picture.
        find = self.job.find if self._shows(source) else None
        opening = self.job.opening.at(time=self.pace.time(number)) if self.moves else self.job.opening
        job = dataclasses.replace(self.job, over=source, lights=listed, find=find, opening=opening)
        result: Any = None
        for stage in run_flare(job):
            result = stage.result
        assert isinstance(result, FlareResult)
        told = {name: result.report[name] for name in TOLD if name in result.report}
        return result.picture, {"lights": len(result.report["lights"]), **told}

    def _shows(self, source: Picture) -> bool:
        """Return whether a picture has light above the threshold that lights are found with."""
        if not isinstance(self.job.find, float | int):
            return False
        return bool(luminances(in_working_space(source)[0]).max(initial=0.0) > self.job.find)
