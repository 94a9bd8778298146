"""Progress on stderr, results on stdout, previews to look at."""

import json
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from aureole import picture, refuse, units
from aureole.records import Picture, Stage

DIGITS = 6
# Fringes narrower than this many pixels are not seen as what they are.
LEAST_FRINGE = 2.0


def follow(stages: Iterable[Stage]) -> Any:
    """Run stages under a progress bar on stderr and return the last result.

    Parameters
    ----------
    stages : iterable of Stage
        As `aureole.jobs.run` yields them.

    Returns
    -------
    object
        The last stage's result.
    """
    result = None
    for stage in shown(stages):
        result = stage.result
    return result


def shown(stages: Iterable[Stage]) -> Iterator[Stage]:
    """Pass stages on under a progress bar on stderr.

    Parameters
    ----------
    stages : iterable of Stage
        As `aureole.jobs.run` yields them.

    Yields
    ------
    Stage
        The same.
    """
    columns = (
        TextColumn("{task.description:32}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("starting", total=1.0)
        for stage in stages:
            progress.update(task, completed=stage.fraction, description=stage.label)
            yield stage


def say_notes(notes: Iterable[str]) -> None:
    """Print notes on stderr.

    Parameters
    ----------
    notes : iterable of str
        One line each.
    """
    for note in notes:
        print(f"note: {note}", file=sys.stderr)


def report(
    title: str, values: Mapping[str, Any], files: Iterable[Path], for_machine: bool, seconds: float
) -> None:
    """Print what was made: a table for people, or JSON for machines.

    Parameters
    ----------
    title : str
        What was made.
    values : mapping
        Plain numbers, units in their names.
    files : iterable of Path
        Files written.
    for_machine : bool
        Whether a machine reads.
    seconds : float
        How long it took.
    """
    if "raster_true_to_deg" in values:
        angle = values["raster_true_to_deg"]
        say_notes([f"beyond {angle:.3g} degrees the pixels of the aperture's picture show in the rays"])
    fringe = values.get("finest_fringe_pixels", LEAST_FRINGE)
    if fringe < LEAST_FRINGE:
        say_notes(
            [f"the finest fringes are {fringe:.2g} pixels wide; a larger size or a smaller extent shows them"]
        )
    written = [str(path) for path in files]
    if for_machine:
        as_json({**values, "files": written, "seconds": round(seconds, 3)})
        return
    drawn = Table(title=title, show_header=False, title_justify="left", title_style="bold")
    for name, value in values.items():
        drawn.add_row(*_row(name, value))
    for path in written:
        drawn.add_row("wrote", path)
    drawn.add_row("time", f"{seconds:.1f} s")
    Console().print(drawn)


def write(
    path: Path,
    source: Picture,
    pixel_type: str = "auto",
    color_config: Path | None = None,
    color_space: str | None = None,
) -> None:
    """Write a picture, and say what its format could not hold.

    Parameters
    ----------
    path : Path
        Its suffix says the format.
    source : Picture
        Linear.
    pixel_type : str
        "auto", "half", "float", "uint8" or "uint16".
    color_config : Path, optional
        OpenColorIO configuration.
    color_space : str, optional
        Space of the file in that configuration.
    """
    kind: Any = pixel_type
    say_notes(
        picture.write(path, source, pixel_type=kind, color_config=color_config, color_space=color_space)
    )


def write_all(writers: Iterable[Callable[[], None]]) -> None:
    """Write several files at once, two at a time.

    Parameters
    ----------
    writers : iterable of callable
        Each writes one file.
    """
    with ThreadPoolExecutor(2) as pool:
        for done in [pool.submit(writer) for writer in writers]:
            done.result()


def write_display(
    path: Path, pixels: NDArray[np.float32], attributes: Mapping[str, picture.Attribute] | None = None
) -> None:
    """Write pixels that are ready for a display.

    Parameters
    ----------
    path : Path
        A PNG, JPEG or TIFF.
    pixels : ndarray, shape (rows, columns, 3)
        0..1, encoded.
    attributes : mapping of str to Attribute, optional
        What the file says besides.
    """
    ready = Picture(np.asarray(pixels, dtype=np.float32))
    if attributes:
        ready = picture.with_attributes(ready, attributes)
    picture.write(path, ready, transfer="linear", pixel_type="uint8")


def pixel_type_for(path: Path, asked: str) -> str:
    """Return the pixel type to write: float for EXR, since glare's tails fall below what half can hold.

    Parameters
    ----------
    path : Path
        File to write.
    asked : str
        "auto", or a type.

    Returns
    -------
    str
        "auto" where the format has only one.
    """
    if asked == "auto" and picture.format_of(path) == "openexr":
        return "float"
    return asked


def places(*paths: Path | None) -> list[Path]:
    """Refuse, before any work, files that could not be written.

    Parameters
    ----------
    *paths : Path or None
        Files to write; None is passed over.

    Returns
    -------
    list of Path
        Those that are not None.

    Raises
    ------
    refuse.Refusal
        Where a folder is missing, a suffix is unknown, or two files are the same.
    """
    wanted = [path for path in paths if path is not None]
    for index, path in enumerate(wanted):
        picture.format_of(path)
        picture.writable(path)
        another(path, wanted[:index])
    return wanted


def another(path: Path, others: Iterable[Path]) -> Path:
    """Refuse a file that is among others.

    Parameters
    ----------
    path : Path
        File to write.
    others : iterable of Path
        Files that are written, too.

    Returns
    -------
    Path
        The same.

    Raises
    ------
    refuse.Refusal
        Where two files are the same.
    """
    if path.resolve() in [other.resolve() for other in others]:
        raise refuse.Refusal(f"'{path}' would be written twice; give each output its own name.")
    return path


def make_folder(path: Path) -> None:
    """Make a folder for output, where it is not there.

    Parameters
    ----------
    path : Path
        The folder.

    Raises
    ------
    refuse.Refusal
        Where it cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise refuse.Refusal(f"the folder '{path}' cannot be made: {error.strerror}.") from None


def as_json(values: Mapping[str, Any]) -> None:
    """Print values for a machine.

    Parameters
    ----------
    values : mapping
        Plain values.
    """
    print(json.dumps(values))


def table(title: str, rows: Mapping[str, str]) -> None:
    """Print names and what they stand for.

    Parameters
    ----------
    title : str
        Over the table.
    rows : mapping
        Name to text.
    """
    drawn = Table(title=title, show_header=False, title_justify="left", title_style="bold")
    for name, text in rows.items():
        drawn.add_row(name, text)
    Console().print(drawn)


def _row(name: str, value: Any) -> tuple[str, str]:
    """Return a row with its unit moved from the name to the value."""
    if name.endswith("_m"):
        lengths = value if isinstance(value, list) else [value]
        return _words(name[:-2]), " x ".join(units.metres_as_text(length) for length in lengths)
    if isinstance(value, list):
        return _words(name), ", ".join(_shown(part) for part in value)
    return _words(name), _shown(value)


def _shown(value: Any) -> str:
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else str(value)


def _words(name: str) -> str:
    return name.replace("_", " ")
