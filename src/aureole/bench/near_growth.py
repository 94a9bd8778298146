"""How the near field's time grows with the number of places on the plane."""

from collections.abc import Iterator
from typing import Any

from aureole import diffraction
from aureole.bench import shapes
from aureole.bench.near_table import DISTANCE, OUTLINES, WAVELENGTH, WIDTH
from aureole.bench.report import Column, Table
from aureole.bench.timing import Task, alternate
from aureole.diffraction.near import METHODS
from aureole.records import Aperture, Grid, Stage

STEPS = 3
COLUMNS = (
    Column("places", "{places}²"),
    Column("mask", "{mask_ms:.1f} ms"),
    Column("growth", "{mask_growth:.2f}x"),
    Column("outline", "{outline_ms:.0f} ms"),
    Column("growth", "{outline_growth:.2f}x"),
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
    openings = {"mask": (shapes.raster("heptagon", size), "auto")}
    if OUTLINES in METHODS:
        openings["outline"] = (shapes.outline("heptagon"), OUTLINES)
    tasks: dict[str, Task] = {
        f"{kind}, {count}²": lambda opening=opening, method=method, count=count: _power(  # type: ignore[misc]
            opening, method, count
        )
        for count in counts
        for kind, (opening, method) in openings.items()
    }
    times = yield from alternate(tasks, runs, label="growth,")
    rows: list[dict[str, Any]] = []
    for index, count in enumerate(counts):
        row: dict[str, Any] = {"places": count}
        for kind in openings:
            row[f"{kind}_ms"] = times[f"{kind}, {count}²"]
            if index:
                row[f"{kind}_growth"] = row[f"{kind}_ms"] / rows[-1][f"{kind}_ms"]
        rows.append(row)
    note = (
        f"Irradiance of the heptagon, as a mask of {size}² pixels and as its exact outline, on one plane "
        "with four times as many places in each row."
    )
    table = Table("growth", f"A {size}² mask on finer and finer planes", COLUMNS, tuple(rows), (note,))
    yield Stage(1.0, "growth", (table,))


def _power(opening: Aperture, method: str, count: int) -> object:
    grid = Grid((count, count), (WIDTH / count, WIDTH / count))
    return diffraction.near_power(opening, grid, DISTANCE, WAVELENGTH, method)
