"""Frames: of an animation, which there are, which are done, and each as it is made; of a sequence, one alone.

`run_frame` makes one frame of a sequence from files to a file, and needs nothing of the frames beside it:
so frames may be made in any order, by any process, on any machine, and come out the same.
"""

import hashlib
import os
import socket
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.jobs import frame_files
from aureole.jobs.contact_sheet import sheet, tile
from aureole.records import Picture, Stage

# More frames than this are a slip of the finger.
MOST = 100_000
# What becomes of a frame of a sequence.
STATES = ("done", "kept", "missing", "broken")


@dataclass(frozen=True)
class Frames:
    """Which frames to make.

    Parameters
    ----------
    duration : float
        Seconds.
    rate : float
        Frames a second.
    numbers : tuple of int, optional
        Those that are wanted, from 1; all where it is left out.
    contact_sheet : bool
        Whether to make a sheet of small pictures of them, too.
    is_done : callable, optional
        Asked with a frame's number and description, before any work, whether it need not be made.
    recall : callable, optional
        Gives the picture of a frame that is done, by its number, where it is needed; without it such
        frames are made again.
    """

    duration: float
    rate: float = 24.0
    numbers: tuple[int, ...] | None = None
    contact_sheet: bool = False
    is_done: Callable[[int, str], bool] | None = None
    recall: Callable[[int], Picture] | None = None

    def count(self) -> int:
        """Return how many frames the whole animation has."""
        count = round(refuse.positive("animate", self.duration) * refuse.positive("fps", self.rate))
        if count > MOST:
            raise refuse.Refusal(f"'animate' must be at most {MOST} frames, got {count}.")
        return max(1, count)

    def times(self, first: float) -> list[float]:
        """Return the time in seconds of each, the first one's being given."""
        return [first + k / self.rate for k in range(self.count())]

    def wanted(self) -> list[int]:
        """Return the numbers of those to make."""
        count = self.count()
        numbers = range(1, count + 1) if self.numbers is None else self.numbers
        for number in numbers:
            if not 1 <= number <= count:
                raise refuse.Refusal(f"'frames' must lie from 1 to {count}, got {number}.")
        return sorted(set(numbers))


@dataclass(frozen=True, eq=False)
class Frame:
    """One frame of an animation.

    Parameters
    ----------
    number : int
        From 1.
    picture : Picture
        Energy per pixel, or the picture as the eye sees it.
    description : str
        What it is in words, the same for the same job alone.
    report : dict
        Plain numbers.
    done : bool
        Whether it was said to be done before.
    """

    number: int
    picture: Picture
    description: str
    report: dict[str, Any]
    done: bool = False


@dataclass(frozen=True, eq=False)
class FramesResult:
    """What is left of frames when they have been taken away.

    Parameters
    ----------
    reports : list of dict
        The wanted frames' own.
    contact_sheet : Picture, optional
        Small pictures of them in their order, by rows.
    """

    reports: list[dict[str, Any]]
    contact_sheet: Picture | None = None


@dataclass(frozen=True, eq=False)
class AnimationResult:
    """An animation when its frames have been taken away.

    Parameters
    ----------
    report : dict
        Plain numbers; "frames" holds a dict for each frame.
    contact_sheet : Picture, optional
        Small pictures of all frames in their order, by rows.
    """

    report: dict[str, Any]
    contact_sheet: Picture | None = None


def frame_stages(
    frames: Frames,
    reports: list[dict[str, Any]],
    description: str,
    make: Callable[[int], Iterator[Stage]],
    follow: Callable[[Picture], Picture] | None = None,
) -> Iterator[Stage]:
    """Make the wanted frames one after the other.

    Parameters
    ----------
    frames : Frames
        Which.
    reports : list of dict
        What is known of all frames before they are made; "time_s" among it.
    description : str
        Of the job; the frames' own add their time.
    make : callable
        Makes a frame by its number; the last of its stages holds a `Picture` and its plain numbers.
    follow : callable, optional
        Takes each frame in its order, and gives what is to become of it. Frames that are done are made
        for it again, but stay as they are; those after the last that is not done are left out.

    Yields
    ------
    Stage
        Each frame as an `Frame` when it is ready; the last stage holds a `FramesResult`.
    """
    numbers = frames.wanted()
    words = {n: f"{description}, at {reports[n - 1]['time_s']:.6g} s" for n in numbers}
    done = {n for n in numbers if frames.is_done is not None and frames.is_done(n, words[n])}
    told = {n: reports[n - 1] | {"number": n, "kept": n in done} for n in numbers}
    last = max((n for n in numbers if n not in done), default=0)
    tiles: list[NDArray[np.float32]] = []
    for index, number in enumerate(numbers):
        fraction, label = index / len(numbers), f"frame {number} of {frames.count()}"
        yield Stage(fraction, label)
        seen: Picture | None = None
        again = frames.contact_sheet and (frames.recall is None or follow is not None)
        if number not in done or again or (follow is not None and number < last):
            for stage in make(number):
                result = stage.result
                yield Stage(fraction + stage.fraction / len(numbers), label)
            seen, found = result
            seen = seen if follow is None else follow(seen)
            told[number] |= found
            made = Frame(number, seen, words[number], told[number], number in done)
            yield Stage((index + 1) / len(numbers), label, made)
        elif frames.contact_sheet and frames.recall is not None:
            seen = frames.recall(number)
        if frames.contact_sheet and seen is not None:
            tiles.append(tile(seen.pixels[..., :3]))
            space = seen.colour_space
    whole = Picture(sheet(tiles), space) if tiles else None
    yield Stage(1.0, "frames", FramesResult(list(told.values()), whole))


@dataclass(frozen=True)
class Pace:
    """When the frames of a sequence are.

    Parameters
    ----------
    rate : float
        Frames a second.
    first : int
        The frame whose time is 0; others before it have a time below.
    """

    rate: float = 24.0
    first: int = 1

    def time(self, number: int) -> float:
        """Return the time of a frame in seconds, whichever frames are made with it."""
        return (number - self.first) / refuse.positive("fps", self.rate)


class FrameMaker(ABC):
    """Makes frames of a sequence; plain values, so that it can be sent to other processes."""

    def read(self, path: Path, options: Mapping[str, Any]) -> Picture:
        """Return the picture that a frame is made of, from its file and options of `aureole.picture.read`."""
        return picture.read(path, **options)

    @abstractmethod
    def make(self, source: Picture, number: int) -> tuple[Picture, dict[str, Any]]:
        """Return a frame from the picture and number of its source, and its plain numbers."""

    def inputs(self, number: int) -> tuple[Path, ...]:
        """Return the files that belong to one frame besides its source."""
        return ()


@dataclass(frozen=True)
class FrameTask:
    """One frame of a sequence: what `run_frame` needs to make it, anywhere.

    Parameters
    ----------
    number : int
        The frame's.
    source, target : Path
        Picture in, picture out.
    maker : FrameMaker
        What to do with the picture.
    description : str
        What the frame's file says of itself: the same for the same job and frame alone.
    reading, writing : mapping
        Options of `aureole.picture.read` and `aureole.picture.write`.
    overwrite : bool
        Whether a frame that lies there whole is made again.
    """

    number: int
    source: Path
    target: Path
    maker: FrameMaker
    description: str
    reading: Mapping[str, Any] = field(default_factory=dict)
    writing: Mapping[str, Any] = field(default_factory=dict)
    overwrite: bool = False

    def is_done(self) -> bool:
        """Return whether the frame lies there whole, and is no older than what it is made of."""
        if self.overwrite or not frame_files.lies_whole(self.target, self.description):
            return False
        made = self.target.stat().st_mtime_ns
        parts = (self.source, *self.maker.inputs(self.number))
        return all(part.stat().st_mtime_ns <= made for part in parts if part.exists())


@dataclass(frozen=True)
class FrameOutcome:
    """What became of one frame of a sequence.

    Parameters
    ----------
    number : int
        The frame's.
    source, target : Path
        Picture in, picture out.
    state : str
        One of `STATES`: "done", "kept" (it lay there whole), "missing" (no source), "broken".
    reason : str
        Of a frame that is missing or broken, one line.
    seconds : float
        How long it took.
    worker : str
        Machine and process that made it.
    notes : tuple of str
        What is worth knowing about its files.
    report : dict
        Plain numbers of a frame that was made.
    """

    number: int
    source: Path
    target: Path
    state: str
    reason: str = ""
    seconds: float = 0.0
    worker: str = ""
    notes: tuple[str, ...] = ()
    report: dict[str, Any] = field(default_factory=dict)

    @property
    def is_there(self) -> bool:
        """Whether the frame's file is there, whole."""
        return self.state in ("done", "kept")


def run_frame(task: FrameTask) -> FrameOutcome:
    """Make one frame of a sequence: read, make, write whole; what goes wrong is told, never raised.

    Parameters
    ----------
    task : FrameTask
        What to make.

    Returns
    -------
    FrameOutcome
        What became of it.
    """
    start = time.perf_counter()
    reason = ""
    notes: tuple[str, ...] = ()
    report: dict[str, Any] = {}
    try:
        if task.is_done():
            state = "kept"
        elif not task.source.exists():
            state, reason = "missing", f"there is no '{task.source}'."
        else:
            notes, report = _made(task)
            state = "done"
            # A run that was killed in the middle of this frame left the half of it under another name.
            picture.clear_partials(task.target)
    except refuse.Refusal as refusal:
        state, reason = "broken", str(refusal)
    except MemoryError:
        state, reason = "broken", "not enough memory for this frame."
    except Exception as error:
        state, reason = "broken", f"{type(error).__name__}: {' '.join(str(error).split())}"
    worker = f"{socket.gethostname()}:{os.getpid()}"
    seconds = time.perf_counter() - start
    return FrameOutcome(task.number, task.source, task.target, state, reason, seconds, worker, notes, report)


def _made(task: FrameTask) -> tuple[tuple[str, ...], dict[str, Any]]:
    """Make a frame's file; return notes and numbers."""
    source = task.maker.read(task.source, task.reading)
    made, report = task.maker.make(source, task.number)
    words = {"ImageDescription": picture.Attribute("string", task.description)}
    written = picture.write(task.target, picture.with_attributes(made, words), **task.writing)
    return (*picture.notes(source), *written), report


def digest(*parts: Any) -> str:
    """Return a short word that differs for jobs that differ.

    Parameters
    ----------
    *parts : object
        Records of plain values.

    Returns
    -------
    str
        Ten signs.
    """
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:10]
