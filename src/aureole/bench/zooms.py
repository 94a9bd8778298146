"""The far field of masks, four times finer than the transform's own spacing, by every library."""

from collections.abc import Callable, Generator, Iterator
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import diffraction
from aureole.bench import peer_scipy, shapes
from aureole.bench.optics import Intensity, Optics
from aureole.bench.peer_ways import F_NUMBER, FOCAL_LENGTH, WAVELENGTH, WIDTH, ways_of
from aureole.bench.report import Column, Table
from aureole.bench.timing import alternate
from aureole.records import Aperture, Grid, Stage

OURS = "Aureole"
PADDED = "SciPy rfft, padded"
FINER = 4
# Diameters of the shapes, of the mask's width.
ACROSS = (1.0, 0.5)
NOTE = (
    "Medians, and times ours in brackets. SciPy's padded transform leaves out rows of zeros and columns that "
    "are not wanted. error: largest difference from direct sums in float64, of the peak, over the shapes."
)


def zooms(size: int, runs: int, peers: list[ModuleType]) -> Iterator[Stage]:
    """Time every way over four shapes, large and small in the mask.

    Parameters
    ----------
    size : int
        Pixels and frequencies on each side.
    runs : int
        How often each is timed.
    peers : list of module
        Whom to compare with.

    Yields
    ------
    Stage
        The last one holds a table for each diameter.
    """
    tables = []
    for index, across in enumerate(ACROSS):
        rows: dict[str, dict[str, Any]] = {}
        notes: dict[str, None] = {}
        for number, name in enumerate(shapes.OUTLINES):
            for stage in _shape(name, across, size, runs, peers, rows, notes):
                done = (number + stage.fraction) / len(shapes.OUTLINES)
                yield Stage((index + done) / len(ACROSS), stage.label)
        tables.append(_table(across, size, tuple(rows.values()), (NOTE, *notes)))
    yield Stage(1.0, "zoom", tuple(tables))


def _shape(
    name: str,
    across: float,
    size: int,
    runs: int,
    peers: list[ModuleType],
    rows: dict[str, dict[str, Any]],
    notes: dict[str, None],
) -> Generator[Stage, None, None]:
    """Time one shape by every way and put what is found into the ways' rows."""
    yield Stage(0.0, f"{name}, reference")
    mask = shapes.mask(name, size, across)
    aperture, grid = Aperture(1.0, mask=mask), Grid((size, size), (1 / FINER, 1 / FINER))
    truth = diffraction.far_power(aperture, grid, "reference")
    tasks: dict[str, Callable[[], NDArray[Any]]] = {
        OURS: lambda: diffraction.far_power(aperture, grid),
        PADDED: lambda: peer_scipy.padded_power(mask, FINER),
    }
    said: list[str] = []
    optics = Optics(mask, WIDTH, FOCAL_LENGTH, WAVELENGTH * F_NUMBER / FINER)
    tasks |= {way: _at(at) for way, at, _ in ways_of(peers, optics, said)}
    notes |= dict.fromkeys(said)
    times = yield from alternate(tasks, runs, label=f"{name},")
    for way, spent in times.items():
        row = rows.setdefault(way, {"way": way, "error": 0.0})
        row[f"{name}_ms"], row[f"{name}_ratio"] = spent, spent / times[OURS]
        row["error"] = max(row["error"], _error(tasks[way](), truth, way))


def _at(at: Intensity) -> Callable[[], NDArray[Any]]:
    return lambda: at(WAVELENGTH)


def _error(found: NDArray[Any], truth: NDArray[Any], way: str) -> float:
    """Return the largest difference from the truth, of the peak, both scaled to the same peak.

    The others transform samples, not square pixels: the pixel's own transform is multiplied in here.
    """
    values = found.astype(np.float64) / found.max()
    if way != OURS:
        size = len(values)
        pixel = np.sinc((np.arange(size) - size // 2) / (FINER * size)) ** 2
        values *= pixel[:, None] * pixel
    return float(np.abs(values - truth / truth.max()).max())


def _table(across: float, size: int, rows: tuple[dict[str, Any], ...], notes: tuple[str, ...]) -> Table:
    columns = (
        Column("power of the full plane", "{way}", words=True),
        *(Column(f"{name}, ms", f"{{{name}_ms:.1f}} ({{{name}_ratio:.1f}}x)") for name in shapes.OUTLINES),
        Column("error", "{error:.0e}"),
    )
    part = "the whole mask" if across == 1 else f"{across:g} of the mask"
    title = f"Far field of a {size}² mask, {size}² frequencies {FINER} times finer; shapes across {part}"
    return Table("zoom" if across == 1 else "zoom-half", title, columns, rows, notes)
