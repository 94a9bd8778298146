"""How the near field's time grows with the number of places on the plane."""

from collections.abc import Iterator
from typing import Any

from aureole import diffraction
from aureole.bench import shapes
from aureole.bench.near_table import DISTANCE, WAVELENGTH, WIDTH
from aureole.bench.report import Column, Table
from aureole.bench.timing import Task, alternate
from aureole.records import Aperture, Grid, Stage

STEPS = 3
COLUMNS = (
    Column("places", "{places}²"),
    Column("median", "{median_ms:.1f} ms"),
    Column("growth", "{growth:.2f}x"),
)


def growth(size: int, runs: int) -> Iterator[Stage]:
    """Time one opening on planes of more and more places, at one Fresnel number.

    Parameters
    ----------
    size : int
        Pixels of the mask, and places on the smallest plane, on each side.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    counts = [size << step for step in range(STEPS)]
    opening = shapes.raster("heptagon", size)
    tasks: dict[str, Task] = {
        f"{count}²": lambda count=count: _power(opening, count)  # type: ignore[misc]
        for count in counts
    }
    times = yield from alternate(tasks, runs, label="growth,")
    rows: list[dict[str, Any]] = []
    for index, count in enumerate(counts):
        row: dict[str, Any] = {"places": count, "median_ms": times[f"{count}²"]}
        if index:
            row["growth"] = row["median_ms"] / rows[-1]["median_ms"]
        rows.append(row)
    note = (
        f"Irradiance of the heptagon, a mask of {size}² pixels, on one plane with four times as many places "
        "in each row."
    )
    table = Table("growth", f"A {size}² mask on finer and finer planes", COLUMNS, tuple(rows), (note,))
    yield Stage(1.0, "growth", (table,))


def _power(opening: Aperture, count: int) -> object:
    grid = Grid((count, count), (WIDTH / count, WIDTH / count))
    return diffraction.near_power(opening, grid, DISTANCE, WAVELENGTH)
