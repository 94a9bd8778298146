"""A file appears whole or not at all: written beside its place, then renamed into it.

The temporary is hidden, carries the process's number and the word "partial" and keeps the suffix
(writers choose the format by it): ``.out.exr.4711-0.partial.exr``. A kill -9 may leave one behind;
no name of ours and no frame pattern takes it for a result.
"""

import contextlib
import glob
import itertools
import os
from collections.abc import Iterator
from pathlib import Path

from aureole import refuse

_turns = itertools.count()


def writable(path: str | os.PathLike[str]) -> Path:
    """Refuse a place where no file can be written, before any work is done for it.

    Parameters
    ----------
    path : path_like
        Where the file shall lie; one that exists will be replaced.

    Returns
    -------
    Path
        The same place.

    Raises
    ------
    refuse.Refusal
        Where the folder is missing or read-only, or the place is a folder or a read-only file.
    """
    place = Path(path)
    folder = place.parent
    if place.is_dir():
        raise refuse.Refusal(f"'{place}' is a folder; name the file to write in it.")
    if not folder.is_dir():
        raise refuse.Refusal(f"'{place}' cannot be written: there is no folder '{folder}'.")
    if not os.access(folder, os.W_OK):
        raise refuse.Refusal(f"'{place}' cannot be written: the folder '{folder}' is read-only.")
    if place.exists() and not os.access(place, os.W_OK):
        raise refuse.Refusal(f"'{place}' cannot be replaced: it is read-only.")
    return place


@contextlib.contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Write a file so that it appears whole or not at all.

    Write and close the yielded temporary inside the ``with``; on leaving, it is flushed to the disk
    and renamed to `path`. On an error or an interrupt it is removed and `path` stays as it was.

    Parameters
    ----------
    path : path_like
        Where the file shall lie; one that exists is replaced.

    Yields
    ------
    Path
        The temporary to write, in the same folder and with the same suffix.

    Raises
    ------
    refuse.Refusal
        Where the place cannot be written, or the disk fails (no space, a name too long).
    """
    place = writable(path).resolve()
    part = place.with_name(f".{place.name}.{os.getpid()}-{next(_turns)}.partial{place.suffix}")
    try:
        yield part
        _flush(part)
        os.replace(part, place)
    except OSError as error:
        raise refuse.Refusal(f"'{path}' could not be written: {error.strerror or error}.") from error
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
    with contextlib.suppress(OSError):  # not every system lets a folder be flushed
        _flush(place.parent)


def clear_partials(path: str | os.PathLike[str]) -> int:
    """Remove what processes that were killed left beside a file that has been written whole since.

    Parameters
    ----------
    path : path_like
        The whole file.

    Returns
    -------
    int
        How many were removed: those that are older than the file.
    """
    place = Path(path).resolve()
    removed = 0
    with contextlib.suppress(OSError):
        whole = place.stat().st_mtime_ns
        for part in place.parent.glob(f".{glob.escape(place.name)}.*.partial{glob.escape(place.suffix)}"):
            if part.stat().st_mtime_ns < whole:
                part.unlink()
                removed += 1
    return removed


def _flush(path: Path) -> None:
    """Wait until the disk has what was written."""
    # A file is opened for writing, as Windows asks for it; a folder can only be opened for reading.
    handle = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
