"""Starbursts of disc-shaped lights: each point of the disc makes the point light's own, moved.

Discs of several pixels are convolved on the pixels; for smaller ones the point light's starburst is
averaged over nodes on the disc. Both serve every method.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from aureole import picture
from aureole.diffraction.pixels import divided, gathered
from aureole.records import Grid

# From this radius on, in pixels, a disc painted on pixels is round enough, and quite round.
WIDE, ROUND = 2.0, 8.0
RINGS, SPOKES = 2, 8
# A pixel is divided into so many parts at most; discs that stay small even so are points.
MOST_PARTS = 21

Point = Callable[[Grid], NDArray[np.floating]]


def spread(point: Point, grid: Grid, radius: float) -> NDArray[np.floating]:
    """Return the starburst of a disc-shaped light from that of a point, whatever computes it.

    Parameters
    ----------
    point : callable
        Takes a grid in direction cosines and returns the point light's starburst on it,
        (rows, columns, 3), integrals over the pixels.
    grid : Grid
        Direction cosines.
    radius : float
        The disc's, in direction cosines.

    Returns
    -------
    ndarray, shape (rows, columns, 3)
        Of the same light, from all over the disc.
    """
    if radius >= WIDE * max(grid.spacing):
        return _convolved(point, grid, radius)
    total = np.zeros((*grid.shape, 3))
    for y, x, weight in _nodes(radius):
        moved = Grid(grid.shape, grid.spacing, (grid.centre[0] - y, grid.centre[1] - x))
        total += weight * point(moved)
    return total


def spread_on_parts(point: Point, grid: Grid, radius: float) -> NDArray[np.floating]:
    """Do what `spread` does by convolution, on parts of pixels where the disc is small.

    Parameters
    ----------
    point : callable
        As for `spread`.
    grid : Grid
        As for `spread`.
    radius : float
        As for `spread`.

    Returns
    -------
    ndarray, shape (rows, columns, 3)
        As of `spread`.
    """
    pixel = max(grid.spacing)
    if radius * MOST_PARTS < WIDE * pixel:
        return point(grid)
    times = min(math.ceil(ROUND * pixel / radius), MOST_PARTS)
    times += 1 - times % 2
    return gathered(_convolved(point, divided(grid, times), radius), times)


def _convolved(point: Point, grid: Grid, radius: float) -> NDArray[np.floating]:
    """Convolve with the disc on the pixels, of which as many more are computed as it reaches."""
    (rows, columns), (step_y, step_x) = grid.shape, grid.spacing
    high, wide = math.ceil(radius / step_y) + 1, math.ceil(radius / step_x) + 1
    whole = point(Grid((rows + 2 * high, columns + 2 * wide), grid.spacing, grid.centre))
    # Between the rays lies less than the rounding of float32 about the peak.
    disc = _painted(high, wide, radius / step_y, radius / step_x)
    spread_out = picture.convolve(whole, disc, precision="double")
    return np.ascontiguousarray(spread_out[high : high + rows, wide : wide + columns])


def _painted(high: int, wide: int, radius_y: float, radius_x: float) -> NDArray[np.float64]:
    """Return the part of each pixel that a disc covers, over the disc's area."""
    parts = max(4, 128 // max(high, wide))
    middles = (np.arange(parts) + 0.5) / parts - 0.5
    y, x = ((np.arange(-n, n + 1)[:, None] + middles).ravel() for n in (high, wide))
    inside = np.hypot(y[:, None] / radius_y, x / radius_x) <= 1
    share = inside.reshape(2 * high + 1, parts, 2 * wide + 1, parts).mean(axis=(1, 3))
    return np.asarray(share / share.sum())


def _nodes(radius: float) -> list[tuple[float, float, float]]:
    """Return places (y, x) on a disc and weights that average polynomials of degree seven over it."""
    # Rings at Gauss-Legendre nodes of the squared radius, equal angles on each.
    squares, weights = np.polynomial.legendre.leggauss(RINGS)
    nodes = []
    for ring, (square, weight) in enumerate(zip(squares, weights, strict=True)):
        at = radius * math.sqrt((square + 1) / 2)
        for spoke in range(SPOKES):
            angle = 2 * math.pi * (spoke + ring / 2) / SPOKES
            nodes.append((at * math.sin(angle), at * math.cos(angle), float(weight) / 2 / SPOKES))
    return nodes
