"""Figure 10 of the quad paper: a shadow that moves before an aperture, followed by its change alone."""

import statistics
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import diffraction
from aureole.bench import shapes
from aureole.bench.peer_scipy import real_power
from aureole.bench.report import Column, Table
from aureole.bench.timing import milliseconds
from aureole.records import Aperture, Grid, Stage

STEP = (5.0, 0.0)
# The shadow's radius over the mask's size; the paper does not print its own.
RADII = (0.05, 0.1)
# Quads are counted at every so many frames.
COUNTED = 4
COLUMNS = (
    Column("aperture", "{aperture}", words=True),
    Column("shadow", "{radius:.0f} px"),
    Column("quads", "{fresh_quads:.0f}"),
    Column("updated", "{update_quads:.0f}"),
    Column("part", "{part:.1%}"),
    Column("printed", "{printed_part}"),
    Column("update", "{update_ms:.2f}"),
    Column("fresh", "{fresh_ms:.2f}"),
    Column("gain", "{gain:.1f}x"),
    Column("printed", "{printed_gain}"),
    Column("rfft2", "{rfft2_ms:.2f}"),
    Column("error", "{error:.0e}"),
)
NOTES = (
    "A circular shadow of so many pixels radius moves 5 pixels a frame across the middle; the paper does not "
    "print its radius. quads: of each frame's own tree; updated: positive and negative ones of the change; "
    "both merged across the tree's levels. "
    "update, fresh, rfft2 (SciPy's): median ms to the power of the full plane.",
    "Printed in section 5.1: quads fall to roughly 10-20 %, the box excepted, and frames are about twice as "
    "fast (GeForce GTX 1080 Ti). error: of the last frame's field, of the peak.",
)


def frames(
    name: str,
    size: int,
    count: int,
    radius: float,
    step: tuple[float, float] = STEP,
    grey: bool = False,
) -> list[Aperture]:
    """Paint an aperture with a shadow at every place of its way.

    Parameters
    ----------
    name : str
        box, circle, heptagon or whirl.
    size : int
        Pixels on each side.
    count : int
        Frames; the shadow is in the middle at half of them.
    radius : float
        The shadow's, in pixels.
    step : tuple of float
        Pixels a frame, (x, y).
    grey : bool
        Whether the opening's edge keeps its grey pixels; black and white otherwise, as the paper's.

    Returns
    -------
    list of Aperture
        Rasters.
    """
    opening = shapes.mask(name, size, across=1.0)
    if not grey:
        opening = np.round(opening)
    y, x = np.ogrid[:size, :size]
    painted = []
    for frame in range(count):
        column, row = (size / 2 + (frame - count // 2) * each for each in step)
        shadow = (x + 0.5 - column) ** 2 + (y + 0.5 - row) ** 2 < radius**2
        painted.append(Aperture(1.0, mask=np.where(shadow, np.float32(0), opening), name=name))
    return painted


def follow(painted: list[Aperture]) -> dict[str, Any]:
    """Follow frames progressively and afresh, in turn.

    Parameters
    ----------
    painted : list of Aperture
        Rasters; the first two are not timed.

    Returns
    -------
    dict
        Medians in milliseconds, mean numbers of quads, and the last frame's error of the peak.
    """
    size = len(_mask(painted[0]))
    grid = Grid((size, size), (1.0, 1.0))
    progressive = diffraction.ProgressiveFarField(grid)
    for frame in painted[:2]:
        progressive.update(frame)
        diffraction.far_power(frame, grid)
        real_power(_mask(frame))
    update, fresh, rfft2, whole, changed = [], [], [], [], []
    for index, frame in enumerate(painted[2:]):
        update.append(milliseconds(partial(_updated, progressive, frame)))
        fresh.append(milliseconds(partial(diffraction.far_power, frame, grid)))
        rfft2.append(milliseconds(partial(real_power, _mask(frame))))
        if index % COUNTED == 0:
            whole.append(len(diffraction.quadtree(_mask(frame), 1.0, merge=True)))
            changed.append(sum(progressive.evaluated))
    found = progressive.update(painted[-1]).amplitude
    truth = diffraction.far_field(painted[-1], grid).amplitude
    return {
        "update_ms": statistics.median(update),
        "fresh_ms": statistics.median(fresh),
        "rfft2_ms": statistics.median(rfft2),
        "gain": statistics.median(fresh) / statistics.median(update),
        "fresh_quads": statistics.mean(whole),
        "update_quads": statistics.mean(changed),
        "part": statistics.mean(changed) / statistics.mean(whole),
        "error": float(np.abs(found - truth).max() / np.abs(truth).max()),
    }


def figure_10(size: int, count: int) -> Iterator[Stage]:
    """Follow a shadow before each of the four apertures.

    Parameters
    ----------
    size : int
        Pixels and frequencies on each side.
    count : int
        Frames.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    total = len(shapes.OUTLINES) * len(RADII)
    for name in shapes.OUTLINES:
        printed = {} if name == "box" else {"printed_part": "10-20 %", "printed_gain": "~2x"}
        for radius in (part * size for part in RADII):
            yield Stage(len(rows) / total, f"progressive, {name}")
            row = {"aperture": name, "radius": radius} | follow(frames(name, size, count, radius))
            rows.append(row | printed)
    title = f"Figure 10: progressive updates, {size}², {count} frames"
    yield Stage(1.0, "progressive", (Table("figure-10", title, COLUMNS, tuple(rows), NOTES),))


def _updated(progressive: diffraction.ProgressiveFarField, frame: Aperture) -> NDArray[np.float32]:
    progressive.update(frame)
    return progressive.power()


def _mask(aperture: Aperture) -> NDArray[np.float32]:
    assert aperture.mask is not None
    return aperture.mask
