"""Animations: the flags that they share, and the files of their frames."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any

import typer

from aureole import jobs, picture, refuse, units
from aureole.cli import output
from aureole.jobs import frame_files
from aureole.records import Picture

MOVING = "Through time"
RATE = 24.0
SHOWN = ("png", "jpeg")


@dataclass(frozen=True)
class MovingFlags:
    """The flags of an animation, as text; each field's option teaches its use.

    Parameters
    ----------
    animate, fps : optional
        How long, and how many frames a second.
    frames : optional
        Which frames are wanted.
    overwrite : bool
        Whether files of frames that are there are made again.
    contact_sheet : Path, optional
        File to write.
    """

    animate: Annotated[
        str | None,
        typer.Option(
            "--animate",
            help="Make frames instead of one picture, for so long: 4s. The output's name has #### for the "
            "frame's number.",
            rich_help_panel=MOVING,
        ),
    ] = None
    fps: Annotated[
        float | None,
        typer.Option("--fps", help=f"Frames a second: {RATE:g} unless given.", rich_help_panel=MOVING),
    ] = None
    frames: Annotated[
        str | None,
        typer.Option("--frames", help="Only these frames: 1-96x2, or 3,7,9.", rich_help_panel=MOVING),
    ] = None
    overwrite: Annotated[
        bool,
        typer.Option(
            "--overwrite",
            help="Make all frames anew; those that lie there whole from this job are kept otherwise.",
            rich_help_panel=MOVING,
        ),
    ] = False
    contact_sheet: Annotated[
        Path | None,
        typer.Option(
            "--contact-sheet",
            help="Also write small pictures of all frames on one sheet: PNG.",
            rich_help_panel=MOVING,
        ),
    ] = None

    def wanted(self, out: Path) -> bool:
        """Return whether there is an animation; refuse flags that need one, and a name that does not fit."""
        if self.animate is None:
            for name in given(self):
                raise refuse.Refusal(f"'{name}' needs 'animate', such as --animate 4s.")
            if frame_files.is_pattern(out):
                raise refuse.Refusal(f"'{out}' has #### for frames' numbers; --animate 4s makes frames.")
            return False
        frame_files.frame(out, 1)
        return True

    def rate(self) -> float:
        """Return the frames a second."""
        return RATE if self.fps is None else refuse.positive("fps", self.fps)

    def duration(self) -> float:
        """Return the length in seconds."""
        assert self.animate is not None
        return refuse.positive("animate", units.seconds(self.animate, "animate"))

    def numbers(self) -> tuple[int, ...] | None:
        """Return the frames that are wanted, None for all."""
        return None if self.frames is None else frame_files.numbers(self.frames)


@dataclass(frozen=True)
class FrameFiles:
    """The files of an animation's frames.

    Parameters
    ----------
    pattern : Path
        Name with #### for the frame's number.
    moving : MovingFlags
        Whether frames are made anew, and the sheet of small pictures.
    write : callable
        Writes a frame to a path.
    """

    pattern: Path
    moving: MovingFlags
    write: Callable[[Path, jobs.Frame], None]

    def places(self) -> list[Path]:
        """Return the files besides the frames, and refuse what could not be written, before any work."""
        return output.places(frame_files.frame(self.pattern, 1), self.moving.contact_sheet)[1:]

    def frames(self) -> jobs.Frames:
        """Return which frames to make; those that lie there whole are kept."""
        return jobs.Frames(
            self.moving.duration(),
            self.moving.rate(),
            self.moving.numbers(),
            self.moving.contact_sheet is not None,
            self.is_done,
            self.recall(),
        )

    def is_done(self, number: int, description: str) -> bool:
        """Return whether a frame lies there whole."""
        path = frame_files.frame(self.pattern, number)
        return frame_files.is_there(path, description, self.moving.overwrite)

    def recall(self) -> Callable[[int], Picture] | None:
        """Return how a frame that is done is read, where its file holds all of it."""
        if picture.format_of(frame_files.frame(self.pattern, 1)) in SHOWN:
            return None
        return lambda number: picture.read(frame_files.frame(self.pattern, number))

    def follow(self, stages: Any) -> Any:
        """Write each frame when it is ready, and return the last result."""
        result = None
        for stage in output.shown(stages):
            result = stage.result
            if isinstance(result, jobs.Frame) and not result.done:
                self.write(frame_files.frame(self.pattern, result.number), result)
        assert isinstance(result, jobs.AnimationResult)
        return result

    def tell(
        self, title: str, report: dict[str, Any], written: list[Path], as_json: bool, seconds: float
    ) -> None:
        """Report every frame to a machine, and their pattern to people."""
        for told in report["frames"]:
            told["file"] = str(frame_files.frame(self.pattern, told["number"]))
        if as_json:
            made = [Path(told["file"]) for told in report["frames"] if not told["kept"]]
            output.report(title, report, [*made, *written], as_json, seconds)
            return
        shared = {name: value for name, value in report.items() if name != "frames"}
        output.report(title, shared, [self.pattern, *written], as_json, seconds)


def given(flags: Any) -> list[str]:
    """Return which flags of a record were typed, as they are written.

    Parameters
    ----------
    flags : dataclass
        Its fields are the flags; each has a default that says nothing.

    Returns
    -------
    list of str
        Such as "luminance-from".
    """
    return [f.name.replace("_", "-") for f in fields(flags) if getattr(flags, f.name) != f.default]
