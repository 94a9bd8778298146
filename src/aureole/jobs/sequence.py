"""Sequences: which frames there are to make from which files, and all of them made, whatever befalls one."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

from aureole import picture, refuse
from aureole.jobs import frame_files
from aureole.jobs.frames import STATES, FrameMaker, FrameOutcome, FrameTask, digest, run_frame
from aureole.records import Stage

# Takes tasks, gives their outcomes in any order as they come.
Spreader = Callable[[Sequence[FrameTask]], Iterable[FrameOutcome]]


def one_by_one(tasks: Sequence[FrameTask]) -> Iterator[FrameOutcome]:
    """Make frames one after the other in this process.

    Parameters
    ----------
    tasks : sequence of FrameTask
        What to make.

    Yields
    ------
    FrameOutcome
        Of each, in order.
    """
    yield from map(run_frame, tasks)


@dataclass(frozen=True, eq=False)
class SequenceJob:
    """Frames to make.

    Parameters
    ----------
    tasks : tuple of FrameTask
        One for each frame.
    spread : callable
        Runs them: one by one in this process, or by others elsewhere.
    """

    tasks: tuple[FrameTask, ...]
    spread: Spreader = field(default=one_by_one)


@dataclass(frozen=True, eq=False)
class SequenceResult:
    """What became of all frames.

    Parameters
    ----------
    outcomes : tuple of FrameOutcome
        By their numbers.
    report : dict
        Plain numbers: how many frames there are of each state, and the median seconds of one that was made.
    """

    outcomes: tuple[FrameOutcome, ...]
    report: dict[str, Any]

    def failures(self) -> list[FrameOutcome]:
        """Return the outcomes of frames that are not there."""
        return [outcome for outcome in self.outcomes if not outcome.is_there]


def sequence_tasks(
    source: Path,
    target: Path,
    numbers: Iterable[int] | None,
    maker: FrameMaker,
    words: str | Callable[[int], str],
    reading: Mapping[str, Any] | None = None,
    writing: Mapping[str, Any] | None = None,
    overwrite: bool = False,
) -> tuple[FrameTask, ...]:
    """Say which frames there are to make, and refuse before any work what could not be written.

    Parameters
    ----------
    source, target : Path
        Names with #### for the frame's number: pictures in, pictures out. All frames may be made of one file.
    numbers : iterable of int, optional
        The frames; all that are there otherwise.
    maker : FrameMaker
        What to do with each picture.
    words : str or callable
        What the frames' files say of themselves, their number and how they are read and written apart; a
        callable takes the number.
    reading, writing : mapping, optional
        Options of `aureole.picture.read` and `aureole.picture.write`.
    overwrite : bool
        Whether frames that are there are made again, and other files replaced.

    Returns
    -------
    tuple of FrameTask
        One for each frame, by their numbers.

    Raises
    ------
    refuse.Refusal
        Where a name has no place for the number, frames would replace their own sources or files of another
        job, or a place cannot be written.
    """
    wanted = frame_files.found(source) if numbers is None else sorted(set(numbers))
    handled = _handling(reading or {}, writing or {})
    tasks = tuple(
        FrameTask(
            number,
            frame_files.frame(source, number) if frame_files.is_pattern(source) else source,
            frame_files.frame(target, number),
            maker,
            f"{words if isinstance(words, str) else words(number)} {handled}, frame {number}",
            dict(reading or {}),
            dict(writing or {}),
            overwrite,
        )
        for number in wanted
    )
    if not tasks:
        raise refuse.Refusal("'frames' must name at least one frame, got none.")
    if tasks[0].source.resolve() == tasks[0].target.resolve():
        raise refuse.Refusal(f"'{target}' would replace the frames that it is made of; give it another name.")
    if overwrite:
        for task in tasks:
            picture.writable(task.target)
    else:
        frame_files.refuse_strangers((task.target, task.description) for task in tasks)
    return tasks


def run_sequence(job: SequenceJob) -> Iterator[Stage]:
    """Make all frames of a sequence; one that is missing or broken does not stop the rest.

    Parameters
    ----------
    job : SequenceJob
        What to make.

    Yields
    ------
    Stage
        The `FrameOutcome` of each frame when it is known; the last stage holds a `SequenceResult`.
    """
    outcomes: list[FrameOutcome] = []
    count, start = len(job.tasks), perf_counter()
    yield Stage(0.0, f"frame 1 of {count}")
    made, spent = 0, 0.0
    for outcome in job.spread(job.tasks):
        outcomes.append(outcome)
        if outcome.state == "done":
            made, spent = made + 1, perf_counter() - start
        left = spent / made * (count - len(outcomes)) if made else None
        words = f"{len(outcomes)} of {count} frames" + ("" if left is None else f", {_duration(left)} left")
        yield Stage(len(outcomes) / count, words, outcome)
    outcomes.sort(key=lambda outcome: outcome.number)
    yield Stage(1.0, f"{count} frames", SequenceResult(tuple(outcomes), _report(outcomes)))


def _handling(reading: Mapping[str, Any], writing: Mapping[str, Any]) -> str:
    """Return a word that differs where frames are read or written otherwise; memory changes no pixel."""
    options = {name: value for name, value in reading.items() if name != "memory"}
    held = [digest(path.read_bytes()) for path in options.values() if isinstance(path, Path)]
    return digest(sorted(options.items()), sorted(writing.items()), held)


def _report(outcomes: Sequence[FrameOutcome]) -> dict[str, Any]:
    told: dict[str, Any] = {
        f"frames_{state}": sum(outcome.state == state for outcome in outcomes) for state in STATES
    }
    seconds = [outcome.seconds for outcome in outcomes if outcome.state == "done"]
    if seconds:
        told["seconds_per_frame"] = round(median(seconds), 3)
    return told


def _duration(seconds: float) -> str:
    """Return a time as people say it."""
    if seconds < 60:
        return f"{seconds:.0f} s"
    if seconds < 3600:
        return f"{seconds / 60:.0f} min"
    return f"{seconds // 3600:.0f} h {seconds % 3600 / 60:.0f} min"
