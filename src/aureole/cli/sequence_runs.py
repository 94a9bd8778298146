"""Running sequences: numbered pictures in, numbered pictures out, a log and a video besides."""

import contextlib
import json
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from aureole import jobs, picture, refuse
from aureole.cli import output
from aureole.cli.cluster_options import CrewFlags
from aureole.cli.eye_runs import Over
from aureole.cli.glare_options import Look
from aureole.cli.moving import MovingFlags, given
from aureole.cli.runs import GlareFiles, Kernel
from aureole.jobs import frame_files
from aureole.jobs.sequence import Spreader, one_by_one
from aureole.records import Picture

SEQUENCE = "Sequences"
# Of the frames that are not there, how many a person is told one by one.
TOLD = 20
INCOMPLETE = 1


@dataclass(frozen=True)
class SequenceFlags(CrewFlags):
    """The flags of sequences alone; each field's option teaches its use.

    Parameters
    ----------
    workers, scheduler : optional
        Who makes the frames.
    log, video : Path, optional
        Files to write.
    first_frame : int, optional
        When time begins.
    """

    log: Annotated[
        Path | None,
        typer.Option(
            "--log",
            help="Append a line of JSON for each frame: its number, state, seconds, worker and reason.",
            rich_help_panel=SEQUENCE,
        ),
    ] = None
    video: Annotated[
        Path | None,
        typer.Option(
            "--video",
            help="Also write a video of all frames to look at: MP4; --fps sets its pace.",
            rich_help_panel=SEQUENCE,
        ),
    ] = None
    first_frame: Annotated[
        int | None,
        typer.Option(
            "--first-frame",
            help="The frame whose time is 0, for an eye and for dirt that drifts; number 0 unless given. A "
            "frame's time is its number less this one, over --fps.",
            rich_help_panel=SEQUENCE,
        ),
    ] = None


@dataclass(frozen=True)
class Sequence:
    """Which frames to make from which files.

    Parameters
    ----------
    files : GlareFiles
        Names with #### for the frame's number, and how pictures are read and written.
    flags : SequenceFlags
        Log and video.
    moving : MovingFlags
        Which frames, and whether they are made anew.
    """

    files: GlareFiles
    flags: SequenceFlags
    moving: MovingFlags

    @property
    def pace(self) -> jobs.Pace:
        """When frames are."""
        first = self.flags.first_frame
        return jobs.Pace(self.moving.rate(), 0 if first is None else refuse.at_least("first-frame", first, 0))

    def check(self, moves: bool = False) -> None:
        """Refuse flags of single pictures and of animations, and files that could not be written."""
        for name in given(self.moving):
            if name not in ("frames", "overwrite", "fps", "contact-sheet"):
                raise refuse.Refusal(f"'{name}' does not go with a sequence of pictures.")
        for name in ("psf", "preview"):
            if getattr(self.files, name) is not None:
                raise refuse.Refusal(f"'{name}' is for one picture; it does not go with a sequence.")
        if not frame_files.is_pattern(self.files.out):
            raise refuse.Refusal(
                f"'{self.files.out}' must have #### for the frame's number, as the input has."
            )
        picture.format_of(self.files.out)
        if self.moving.fps is not None and self.flags.video is None and not moves:
            raise refuse.Refusal("'fps' needs 'video', an eye, or dirt that moves; nothing else has a pace.")
        if self.flags.first_frame is not None and not moves:
            raise refuse.Refusal("'first-frame' needs an eye, or dirt that moves; nothing else has a time.")
        if self.flags.video is not None:
            picture.writable(picture.check_video(self.flags.video))
        output.places(self.moving.contact_sheet)
        if self.flags.log is not None:
            picture.writable(self.flags.log)
        self.flags.crew()

    @property
    def frame_memory(self) -> int | None:
        """Bytes that each frame may use: workers of this machine share what there is."""
        return self.flags.crew().memory(self.files.how.most())

    def spread(self) -> Spreader:
        """Return who makes the frames, as `SequenceJob` takes it."""
        crew = self.flags.crew()
        return one_by_one if crew.alone else jobs.spread_over(crew, lambda note: output.say_notes([note]))

    def tasks(self, maker: jobs.FrameMaker, words: str | Callable[[int], str]) -> tuple[jobs.FrameTask, ...]:
        """Return the frames to make."""
        files = self.files
        return jobs.sequence_tasks(
            files.source,
            files.out,
            self.moving.numbers(),
            maker,
            words,
            {**files.how.reading(), "memory": self.frame_memory},
            files.how.writing(files.out),
            self.moving.overwrite,
        )


def glare(
    camera: jobs.Optics,
    asked: Sequence,
    look: Look,
    kernel: Kernel,
    as_json: bool,
) -> None:
    """Lay a camera's glare over the frames of a sequence, and report.

    Parameters
    ----------
    camera : Optics
        The camera.
    asked : Sequence
        Which frames, and their files.
    look : Look
        How to mix.
    kernel : Kernel
        Its size, and what of it changes over the frame.
    as_json : bool
        Whether a machine reads the report.
    """
    maker = jobs.GlareMaker.of(
        camera,
        asked.files.matte,
        _lights(asked),
        asked.pace,
        memory=asked.frame_memory,
        **vars(kernel),
        **vars(look),
    )
    asked.check(maker.moves)
    maker.refuse()
    tasks = asked.tasks(maker, maker.words())
    if maker.moves:
        _say_when(asked, tasks[0].number)
    make("glare", asked, tasks, as_json)


def seen(eye: Over, asked: Sequence, as_json: bool) -> None:
    """Let an eye see the frames of a sequence, each at its time, and report.

    Parameters
    ----------
    eye : Over
        The eye, and how glare is mixed in.
    asked : Sequence
        Which frames, and their files.
    as_json : bool
        Whether a machine reads the report.
    """
    asked.check(True)
    for name in ("photosafe", "white", "real-time"):
        if name in given(eye.flags):
            raise refuse.Refusal(f"'{name}' does not go with a sequence, whose frames are made each alone.")
    nothing = Picture(np.zeros((1, 1, 3), dtype=np.float32))
    plain = replace(eye, files=replace(eye.files, matte=None, lights=None))
    job = replace(plain.job(nothing), memory=asked.frame_memory)
    maker = jobs.EyeGlareMaker(job, jobs.GlareSources(asked.files.matte, _lights(asked)), asked.pace)
    maker.refuse()
    tasks = asked.tasks(maker, maker.words())
    if tasks[0].number < maker.pace.first:
        raise refuse.Refusal(f"frame {tasks[0].number} is before 'first-frame', when there is no eye yet.")
    if len(job.eye.viewer.luminance) > 1:
        _say_when(asked, tasks[0].number)
    make("glare", asked, tasks, as_json)


def flare(job: jobs.FlareJob, asked: Sequence, lights: Path | None, as_json: bool) -> None:
    """Add a lens's flare to the frames of a sequence, and report.

    Parameters
    ----------
    job : FlareJob
        What to make, without its picture.
    asked : Sequence
        Which frames, and their files.
    lights : Path, optional
        File of lights.
    as_json : bool
        Whether a machine reads the report.
    """
    pattern = asked.files.source
    if job.find == "auto":
        # One threshold for all frames, so that no light comes and goes with it.
        there = [frame_files.frame(pattern, number) for number in frame_files.found(pattern)]
        job = replace(job, find=jobs.shot_threshold(there, asked.files.how.reading()))
    maker = jobs.FlareMaker(replace(job, memory=asked.frame_memory), lights, asked.pace)
    asked.check(maker.moves)
    maker.refuse()
    tasks = asked.tasks(maker, maker.words)
    if maker.moves:
        _say_when(asked, tasks[0].number)
    make("flare", asked, tasks, as_json)


def _say_when(asked: Sequence, number: int) -> None:
    """Say at which time a sequence begins, where nobody chose it and something changes with it."""
    time = asked.pace.time(number)
    if asked.flags.first_frame is None and time > 0:
        output.say_notes([f"frame {number} is at {time:.4g} s; --first-frame {number} makes that 0 s"])


def _lights(asked: Sequence) -> jobs.GlareLights | None:
    """Return the lights that make glare, with one threshold for all frames that lie there."""
    lights, pattern = asked.files.lights, asked.files.source
    if lights is None:
        return None
    if lights.frame is not None:
        raise refuse.Refusal("'lights-frame' is for one picture; frames of a sequence know their number.")
    there = [frame_files.frame(pattern, number) for number in frame_files.found(pattern)]
    return lights.for_shot(there, asked.files.how.reading())


def make(title: str, asked: Sequence, tasks: tuple[jobs.FrameTask, ...], as_json: bool) -> None:
    """Make frames, tell what became of each, and exit with 1 where one is not there.

    Parameters
    ----------
    title : str
        What is made.
    asked : Sequence
        Log and video.
    tasks : tuple of FrameTask
        The frames.
    as_json : bool
        Whether a machine reads the report.

    Raises
    ------
    typer.Exit
        With 1 where frames are missing or broken; all others are made.
    """
    start = time.perf_counter()
    result = _follow(jobs.SequenceJob(tasks, asked.spread()), asked.flags.log)
    written = [asked.files.out]
    there = [outcome.target for outcome in result.outcomes if outcome.is_there]
    if asked.flags.video is not None and there:
        output.follow(jobs.video_stages(there, asked.flags.video, asked.moving.rate()))
        written.append(asked.flags.video)
    if asked.moving.contact_sheet is not None and there:
        output.write_display(asked.moving.contact_sheet, output.follow(jobs.sheet_stages(there)))
        written.append(asked.moving.contact_sheet)
    failures = result.failures()
    output.say_notes(_told(failures))
    report = dict(result.report)
    if as_json:
        report["frames"] = [_line(outcome) for outcome in result.outcomes]
    output.report(title, report, written, as_json, time.perf_counter() - start)
    if failures:
        raise typer.Exit(INCOMPLETE)


def _follow(job: jobs.SequenceJob, log: Path | None) -> jobs.SequenceResult:
    """Run a sequence under a progress bar, and log each frame as soon as it is known."""
    result: Any = None
    said: set[str] = set()
    with _log(log) as line:
        for stage in output.shown(jobs.run(job)):
            result = stage.result
            if isinstance(result, jobs.FrameOutcome):
                line(_line(result))
                # The same note on every frame is said once.
                fresh = [note for note in result.notes if _about(note) not in said]
                said.update(map(_about, fresh))
                output.say_notes(fresh)
    assert isinstance(result, jobs.SequenceResult)
    return result


@contextlib.contextmanager
def _log(path: Path | None) -> Iterator[Callable[[dict[str, Any]], None]]:
    """Append a line of JSON for each frame, written through at once, so that a crash loses none."""
    if path is None:
        yield lambda values: None
        return
    with path.open("a", encoding="utf-8", buffering=1) as file:
        yield lambda values: print(json.dumps(values), file=file)


def _line(outcome: jobs.FrameOutcome) -> dict[str, Any]:
    """Return what became of a frame, for a machine."""
    told: dict[str, Any] = {
        "number": outcome.number,
        "state": outcome.state,
        "source": str(outcome.source),
        "file": str(outcome.target),
        "seconds": round(outcome.seconds, 3),
        "worker": outcome.worker,
    }
    if outcome.reason:
        told["reason"] = outcome.reason
    return told | outcome.report


def _told(failures: list[jobs.FrameOutcome]) -> list[str]:
    """Return what a person should know about frames that are not there."""
    lines = [f"frame {outcome.number} is {outcome.state}: {outcome.reason}" for outcome in failures[:TOLD]]
    more = len(failures) - TOLD
    return [*lines, f"{more} more frames are missing or broken; --log tells of each"] if more > 0 else lines


def _about(note: str) -> str:
    """Return a note without the name of the file that it begins with."""
    return note.partition(": ")[2] or note
