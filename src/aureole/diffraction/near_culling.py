"""The near field's power where it may exceed a level, zero elsewhere (quad paper §4.5).

Scandolo, Lee, Eisemann, "Quad-based Fourier transform for efficient diffraction synthesis", 2018, test the
near field at a lower resolution by its power alone: there is no derivative to help. Here every fourth
place of each axis is tested, and a tile counts as dark where no sample within it or next to it comes
near the level.

Shadows darken slowly, as one over the square of the distance from the opening's edge: to 2.5e-4 of the
unblocked irradiance at half the opening's width from it, at a Fresnel number of 100. So culling saves
little: of a plane four times as wide as the opening a third of the time, at levels about a thousandth and
Fresnel numbers in the hundreds; nothing of a plane twice as wide (benchmarks/near_culling.py).
"""

import numpy as np
from numpy.typing import NDArray

from aureole.diffraction import _kernels_near
from aureole.diffraction.culling import TILE, Survey, check_level, runs
from aureole.diffraction.near_pixels import Part, power_of, write_tiles
from aureole.records import Grid

# Places of an axis that one sample stands for.
STEP = 4
# What is tested lies below the brightest place of a tile, down to a tenth of it (benchmarks/near_culling.py
# over four shapes, planes, Fresnel numbers 10 to 1000): tiles count as lit from this share of the level on.
CAUTION = 0.05
# Tiles take longer than the same places all at once: nothing is left out where more than this is lit.
WORTH = 0.35


def culled_near_power(parts: list[Part], grid: Grid, level: float) -> NDArray[np.float32]:
    """Return |D|² in the tiles that may exceed a level, zero elsewhere.

    Parameters
    ----------
    parts : list of Part
        Two sides each, from `near_pixels.rows_parts` or `near_pixels.quads_parts`.
    grid : Grid
        Metres.
    level : float
        Of the irradiance where nothing blocks the wave, between 0 and 1.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Without unit.

    Raises
    ------
    refuse.Refusal
        Where the level is not between 0 and 1.
    """
    check_level(level)
    if not parts:
        return power_of(parts, grid)
    found = survey(parts, grid, level)
    if found.share() > WORTH:
        return power_of(parts, grid)
    out = np.zeros(grid.shape, dtype=np.float32)
    write_tiles(parts, grid, runs(found), _kernels_near.write_power, out)
    return out


def survey(parts: list[Part], grid: Grid, level: float) -> Survey:
    """Find the tiles of the plane that may exceed a level.

    Parameters
    ----------
    parts : list of Part
        Two sides each, one at least.
    grid : Grid
        Metres.
    level : float
        Of the irradiance where nothing blocks the wave.

    Returns
    -------
    Survey
        With the parts, the tiles' edges, and which are lit.
    """
    edges, seen = seen_in_tiles(parts, grid)
    found = {part: (left, right) for part, left, right in parts}
    return Survey(found, edges, seen > CAUTION * level)


def seen_in_tiles(
    parts: list[Part], grid: Grid
) -> tuple[tuple[NDArray[np.int64], NDArray[np.int64]], NDArray[np.float32]]:
    """Return the highest of each tile's samples, and of those next to it.

    Parameters
    ----------
    parts : list of Part
        Two sides each, one at least.
    grid : Grid
        Metres.

    Returns
    -------
    edges : tuple of ndarray of int64
        Where the tiles begin along y and x among the computed places, and where the last ends.
    seen : ndarray of float32, shape (N, K)
        |D|².
    """
    rows, columns = (
        np.append(np.arange(0, side.shape[1] // 2, TILE), side.shape[1] // 2) for side in parts[0][1:]
    )
    seen = _highest(_brightness(parts, grid), len(rows) - 1)
    return (rows, columns), _highest(seen.T, len(columns) - 1).T


def _brightness(parts: list[Part], grid: Grid) -> NDArray[np.float32]:
    """Return |D|² at every `STEP`-th computed place, the brightest of those that mirror each other."""
    products = [(part, _every(left).T @ _every(right)) for part, left, right in parts]
    signs = [(1.0, -1.0) if centre == 0 else (1.0,) for centre in grid.centre]
    best = np.zeros((), dtype=np.float32)
    for sign_y in signs[0]:
        for sign_x in signs[1]:
            total = sum(
                np.float32(sign_y ** (part >> 1) * sign_x ** (part & 1)) * product
                for part, product in products
            )
            best = np.maximum(best, 0.25 * np.abs(total) ** 2)
    return np.asarray(best, dtype=np.float32)


def _every(side: NDArray[np.float32]) -> NDArray[np.complex64]:
    """Return a side at every `STEP`-th place, and at the last."""
    places = np.append(np.arange(0, side.shape[1] // 2 - 1, STEP), side.shape[1] // 2 - 1)
    return np.ascontiguousarray(side.view(np.complex64)[:, places])


def _highest(samples: NDArray[np.float32], tiles: int) -> NDArray[np.float32]:
    """Return the highest of each tile's samples along the first axis, those next to it counted."""
    each = TILE // STEP
    beside = np.pad(samples, [(1, tiles * each + 2), (0, 0)])
    windows = [beside[k : k + tiles * each : each] for k in range(each + 2)]
    return np.asarray(np.max(windows, axis=0))
