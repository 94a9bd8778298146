"""A sequence's frames made by a crew: what `SequenceJob.spread` takes where others are to make them."""

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from aureole import picture
from aureole.jobs.cluster import Crew, Delivery, deliver
from aureole.jobs.frames import FrameOutcome, FrameTask, run_frame
from aureole.jobs.sequence import Spreader


def spread_over(crew: Crew, say: Callable[[str], None] = lambda note: None) -> Spreader:
    """Return how a crew makes a sequence's frames.

    Parameters
    ----------
    crew : Crew
        Who makes them.
    say : callable
        Gets notes about the workers, a line each.

    Returns
    -------
    callable
        For `SequenceJob`.
    """

    def spread(tasks: Sequence[FrameTask]) -> Iterator[FrameOutcome]:
        sent = anywhere(tasks)
        for delivery in deliver(run_frame, sent, crew, folders(sent), say):
            outcome = _outcome(tasks[delivery.index], delivery)
            if outcome.is_there:
                # A worker that was killed in the middle of a frame leaves the half of it under another name.
                picture.clear_partials(outcome.target)
            yield outcome

    return spread


def _outcome(task: FrameTask, delivery: Delivery[FrameOutcome]) -> FrameOutcome:
    """Return a frame's outcome with the paths as they were given."""
    made = delivery.outcome
    if made is None:
        return FrameOutcome(task.number, task.source, task.target, "broken", f"{delivery.reason}.")
    return dataclasses.replace(made, source=task.source, target=task.target)


def anywhere(tasks: Sequence[FrameTask]) -> list[FrameTask]:
    """Make all paths in frames absolute, since workers stand in other folders.

    Parameters
    ----------
    tasks : sequence of FrameTask
        Frames, most of which share their maker.

    Returns
    -------
    list of FrameTask
        The same otherwise.
    """
    makers = {id(task.maker): task.maker for task in tasks}
    placed = {key: absolute(maker) for key, maker in makers.items()}
    return [
        dataclasses.replace(
            task,
            source=task.source.absolute(),
            target=task.target.absolute(),
            maker=placed[id(task.maker)],
            reading=absolute(task.reading),
            writing=absolute(task.writing),
        )
        for task in tasks
    ]


def folders(tasks: Sequence[FrameTask]) -> list[Path]:
    """Return the folders that frames read from and write to.

    Parameters
    ----------
    tasks : sequence of FrameTask
        Frames with absolute paths.

    Returns
    -------
    list of Path
        Each once.
    """
    makers = {id(task.maker): task.maker for task in tasks}
    needed = {path.parent for task in tasks for path in (task.source, task.target)}
    needed |= {path.parent for maker in makers.values() for path in _paths(maker)}
    return sorted(needed)


def absolute(value: Any) -> Any:
    """Make all paths in records absolute.

    Parameters
    ----------
    value : object
        A path, the name of a file that is there, or records, tuples and mappings that hold some.

    Returns
    -------
    object
        The same otherwise.
    """
    if isinstance(value, Path):
        return value.absolute()
    if isinstance(value, str):
        # A name of a preset has no suffix; one of a preset's file has.
        return str(Path(value).absolute()) if _is_file(value) else value
    if isinstance(value, Mapping):
        return {key: absolute(part) for key, part in value.items()}
    if type(value) is tuple:
        return tuple(absolute(part) for part in value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        parts = _parts(value)
        changed = {name: absolute(part) for name, part in parts.items()}
        different = {name: part for name, part in changed.items() if part is not parts[name]}
        return dataclasses.replace(value, **different) if different else value
    return value


def _paths(value: Any) -> Iterator[Path]:
    """Return all paths in records, those of files named by their text as well."""
    if isinstance(value, Path):
        yield value
    elif isinstance(value, str):
        if _is_file(value):
            yield Path(value)
    elif isinstance(value, Mapping):
        yield from (path for part in value.values() for path in _paths(part))
    elif isinstance(value, tuple):
        yield from (path for part in value for path in _paths(part))
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        yield from _paths(_parts(value))


def _parts(record: Any) -> dict[str, Any]:
    return {f.name: getattr(record, f.name) for f in dataclasses.fields(record) if f.init}


def _is_file(text: str) -> bool:
    """Return whether a text names a file that is there."""
    return Path(text).suffix != "" and len(text) < 1024 and "\n" not in text and Path(text).is_file()
