"""Light from all around on a flat sample: by correlation and by the paper's prefilter, beside the sum."""

import time
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import surface
from aureole.bench.report import Column, Table
from aureole.records import Stage

# Section 6.2 of the surface paper: RMSE of its prefiltered map for a phone's screen, views not told.
PRINTED_RMSE = 0.076
SEED, LOBES, WIDTH = 5, 10, 0.03
FRAME = surface.frame_of((0.2, 0.9, 0.3), (1.0, 0.0, 0.0), 0.4)
VIEWS, FARTHEST = 40, 0.95
COLUMNS = (
    Column("way", "{way}", words=True),
    Column("normal", "{normal:.2%}"),
    Column("oblique, of brightest", "{oblique:.2%}"),
    Column("of the view's own", "{own:.2%}"),
    Column("RMSE", "{rmse:.2%}"),
    Column("time", "{seconds:.1f} s"),
    Column("printed", "{printed_rmse:.1%}"),
)


def around(planes: Sequence[int], room_rows: int, size: int) -> Iterator[Stage]:
    """Compare ways to light from all around.

    Parameters
    ----------
    planes : sequence of int
        Samples across the disc of directions that correlations take.
    room_rows : int
        Rows of the room's latitudes.
    size : int
        Samples of the table on each side.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    table, room, views = smooth(size), surface.lamps_and_windows(room_rows), seen_from(VIEWS)
    yield Stage(0.0, "all directions")
    start = time.perf_counter()
    truth = surface.quadrature(table, room, FRAME, views)
    rows: list[dict[str, Any]] = [{"way": "every direction", "seconds": time.perf_counter() - start}]
    surface.reflect(table, room, FRAME, 63)  # warm
    for index, plane in enumerate(planes):
        yield Stage(0.4 + 0.3 * index / len(planes), f"correlation, {plane}²")
        start = time.perf_counter()
        found = surface.reflect(table, room, FRAME, plane).towards(views)
        row = {"way": f"correlation, {plane}²", "seconds": time.perf_counter() - start}
        rows.append(row | errors(found, truth.radiance))
    yield Stage(0.7, "prefilter")
    start = time.perf_counter()
    mapped = surface.prefiltered(table, room, FRAME, views)
    row = {"way": "the paper's prefilter", "seconds": time.perf_counter() - start}
    rows.append(row | errors(mapped, truth.radiance) | {"printed_rmse": PRINTED_RMSE})
    notes = (
        f"{LOBES} smooth lobes in a table of {size}², a room of lamps and windows, {room_rows} rows, "
        f"{len(views)} views over the hemisphere. normal: along it, of its light; oblique: the largest of "
        "the other views, of the brightest view's light and of its own where that is above 1 % of it. RMSE: "
        "of the mean. correlation: towards all views at once, table and room prepared in the time. every "
        f"direction: settled to {truth.change.max():.0e} of a view's light.",
    )
    title = "Light from all around on a flat sample"
    yield Stage(1.0, "environment", (Table("environment", title, COLUMNS, tuple(rows), notes),))


def smooth(size: int) -> surface.ScatterTable:
    """Return smooth neutral lobes, one of them about h = 0.

    Parameters
    ----------
    size : int
        Samples on each side.

    Returns
    -------
    ScatterTable
        Under light E.
    """
    places = np.random.default_rng(SEED).uniform(-1.2, 1.2, (LOBES, 2)) * (np.arange(LOBES) > 0)[:, None]

    def lobes(h_t: NDArray[np.float64], h_b: NDArray[np.float64], wavelength: float) -> NDArray[np.float64]:
        parts = (
            np.exp(-((h_t - t) ** 2) / (2 * WIDTH**2)) * np.exp(-((h_b - b) ** 2) / (2 * WIDTH**2))
            for t, b in places
        )
        return np.asarray(sum(parts))

    return surface.table_from_function(lobes, "E", size, sample="point", wavelengths=1)


def seen_from(count: int) -> NDArray[np.float64]:
    """Return the normal and views evenly over the hemisphere's disc.

    Parameters
    ----------
    count : int
        How many.

    Returns
    -------
    ndarray of float64, shape (count, 2)
        Direction cosines.
    """
    order = np.arange(count)
    radius, angle = FARTHEST * np.sqrt(order / (count - 1)), order * np.pi * (3.0 - np.sqrt(5.0))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


def errors(found: NDArray[np.floating], truth: NDArray[np.float64]) -> dict[str, float]:
    """Return how far light towards views is from the truth.

    Parameters
    ----------
    found, truth : ndarray, shape (V, 3)
        Radiance; the first view is the normal.

    Returns
    -------
    dict
        normal, oblique, own and rmse, relative.
    """
    apart, level = np.abs(found - truth).max(axis=1), truth.max(axis=1)
    lit = level[1:] > 0.01 * level.max()
    return {
        "normal": float(apart[0] / level[0]),
        "oblique": float(apart[1:].max() / level.max()),
        "own": float((apart[1:][lit] / level[1:][lit]).max()),
        "rmse": float(np.sqrt(np.mean((found - truth) ** 2)) / truth.mean()),
    }
