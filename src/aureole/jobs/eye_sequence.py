"""Each frame of a sequence as an eye sees it at the frame's time."""

import dataclasses
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from aureole import light
from aureole.jobs.eye import check_field, check_grid, description, state_report
from aureole.jobs.eye_glare import EyeGlareJob, eye_view
from aureole.jobs.eye_glare_frames import dimming, seen_stages
from aureole.jobs.frames import FrameMaker, Pace
from aureole.jobs.glare_sources import GlareSources
from aureole.records import Picture

# Fields of a job that its words do not name: what each frame has of its own, and what changes no pixel.
APART = ("picture", "eye", "matte", "memory")


@dataclass(frozen=True, eq=False)
class EyeGlareMaker(FrameMaker):
    """Lets an eye see frames, each at its time: pupil, lids and needles follow from the time alone.

    Parameters
    ----------
    job : EyeGlareJob
        What to do; the time of its eye is that of the pace's first frame. Its picture and its matte are not
        looked at.
    sources : GlareSources
        Which light makes glare.
    pace : Pace
        When frames are.
    """

    job: EyeGlareJob
    sources: GlareSources = field(default_factory=GlareSources)
    pace: Pace = field(default_factory=Pace)

    def refuse(self) -> None:
        """Refuse, before any work, what no frame could be made with."""
        check_field(self.job.eye.field_of_view, "perspective")
        check_grid(self.job.eye.grid)
        light.illuminant(self.job.eye.illuminant)
        eye_view(self.job)
        self.job.eye.viewer.state(self.job.eye.time)
        self.sources.refuse()

    def words(self) -> str:
        """Return what a frame's file says of itself, the same for the same job alone."""
        mixing = {name: value for name, value in vars(self.job).items() if name not in APART}
        return description(self.job.eye, mixing, self.job.eye.time, self.sources.words(), self.pace)

    def inputs(self, number: int) -> tuple[Path, ...]:
        """Return the files that belong to one frame besides its source.

        Parameters
        ----------
        number : int
            The frame's.

        Returns
        -------
        tuple of Path
            Its matte, where each has its own.
        """
        return self.sources.inputs(number)

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
            As the eye sees it.
        report : dict
            Plain numbers.
        """
        job = dataclasses.replace(self.job, picture=source, matte=self.sources.of(source, number))
        time = job.eye.time + self.pace.time(number)
        state = job.eye.viewer.state(time)
        awake = dataclasses.replace(job.eye.viewer, blinking=False).state(time)
        made: Any = None
        for stage in seen_stages(job, eye_view(job), state, dimming(state, awake)):
            made = stage.result
        out, numbers = made
        return out, state_report(state) | numbers
