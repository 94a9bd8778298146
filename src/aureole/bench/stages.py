"""Figure 11 of the quad paper: where the time of a far-field frame goes, stage by stage."""

from collections.abc import Generator, Iterator
from typing import Any

import numpy as np

from aureole import aperture, diffraction, light
from aureole.bench import shapes
from aureole.bench.report import Column, Table
from aureole.bench.spectral import REFERENCE_WAVELENGTH
from aureole.bench.timing import alternate
from aureole.records import Aperture, Grid, Pattern, Stage

COLUMNS = (
    Column("stage", "{stage}", words=True),
    Column("median", "{median_ms:.1f} ms"),
    Column("share", "{share:.0%}"),
)
NOTES = (
    "The paper prints this figure as bars without numbers (GeForce GTX 1080 Ti). far field: of the mask's "
    "rows, not of the quads, which the paper transforms; the quadtree is listed for comparison.",
)


def figure_11(size: int, runs: int) -> Iterator[Stage]:
    """Time the stages of a frame of the heptagon.

    Parameters
    ----------
    size : int
        Pixels and frequencies on each side.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    yield from _stages(size, runs, rows)
    title = f"Figure 11: stages of a frame, heptagon, {size}²"
    yield Stage(1.0, "stages", (Table("figure-11", title, COLUMNS, tuple(rows), NOTES),))


def _stages(size: int, runs: int, rows: list[dict[str, Any]]) -> Generator[Stage, None, None]:
    grid, outline = Grid((size, size), (1.0, 1.0)), shapes.outline("heptagon")
    mask = np.round(aperture.rasterize(outline, size))
    opening = Aperture(1.0, mask=mask, name="heptagon")
    power = diffraction.far_power(opening, grid)
    pattern = Pattern(power, grid, REFERENCE_WAVELENGTH, float(power.sum()))
    lamp = light.illuminant("E")
    tasks = {
        "aperture drawn": lambda: aperture.rasterize(outline, size),
        "quadtree": lambda: diffraction.quadtree(mask, 1.0, "half"),
        "far field": lambda: diffraction.far_power(opening, grid),
        "spectral sum": lambda: light.spectral_sum(pattern, None, lamp),
    }
    times = yield from alternate(tasks, runs, label="stage")
    total = sum(times.values())
    rows += [{"stage": name, "median_ms": spent, "share": spent / total} for name, spent in times.items()]
