"""Pixels of a starburst: where they lie in frequency, and the nodes that integrate fringes across them."""

import math
from collections.abc import Iterator
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole.diffraction.far import MOST_EDGES, far_power
from aureole.diffraction.polygons import add_polygons_power
from aureole.records import Aperture, Grid

SHORTEST, LONGEST = 380e-9, 780e-9
REFERENCE_WAVELENGTH = math.sqrt(SHORTEST * LONGEST)
# What is left of the finest fringe where few nodes do.
NODE_ERROR = 1e-4


def in_frequency(grid: Grid, wavelength: float) -> Grid:
    """Return the frequencies s / λ of a grid in direction cosines.

    Parameters
    ----------
    grid : Grid
        Direction cosines.
    wavelength : float
        Metres.

    Returns
    -------
    Grid
        Cycles per metre.
    """
    (step_y, step_x), (y, x) = grid.spacing, grid.centre
    return Grid(grid.shape, (step_y / wavelength, step_x / wavelength), (y / wavelength, x / wavelength))


def share(aperture: Aperture, grid: Grid, wavelength: float) -> float:
    """Return what turns |F|² into a pixel's share of the energy: its area over λ² ∬|f|².

    Parameters
    ----------
    aperture : Aperture
        Any.
    grid : Grid
        Direction cosines.
    wavelength : float
        Metres.

    Returns
    -------
    float
        Per square of square metres.
    """
    return grid.spacing[0] * grid.spacing[1] / (wavelength**2 * energy(aperture))


@lru_cache(maxsize=16)
def energy(aperture: Aperture) -> float:
    """Return ∬|f|² of an aperture, which nobody writes into, once and for all.

    Parameters
    ----------
    aperture : Aperture
        Any.

    Returns
    -------
    float
        Square metres.
    """
    return apertures.energy(aperture)


def node_counts(
    aperture: Aperture, grid: Grid, wavelength: float, sample: str, most: int = 1 << 30
) -> tuple[int, int]:
    """Return how many Gauss-Legendre nodes integrate the fringes across a pixel, by rows and columns.

    |F|² has no fringe finer than the width allows: c = width × pixel / λ cycles in a pixel. Gauss's
    rule follows them from π c / 2 nodes on; three more bring the error below 1e-4, and fewer do where
    a fringe is wider than a pixel.

    Parameters
    ----------
    aperture : Aperture
        Any.
    grid : Grid
        Direction cosines.
    wavelength : float
        Metres.
    sample : str
        "area" or "point".
    most : int
        No more than so many.

    Returns
    -------
    tuple of int
        (rows, columns).
    """
    if sample == "point":
        return 1, 1
    rows, columns = (min(most, _nodes(aperture.width * spacing / wavelength)) for spacing in grid.spacing)
    return rows, columns


def _nodes(cycles: float) -> int:
    """Return how many nodes integrate so many cycles."""
    following = math.ceil(math.pi * cycles / 2) + 3
    for count in range(1, following):
        # Gauss's error of cos(2πct) over 0..1: n!⁴ (2πc)^2n / ((2n + 1) (2n)!³), here its logarithm.
        error = 4 * math.lgamma(count + 1) + 2 * count * math.log(2 * math.pi * max(cycles, 1e-30))
        if error < math.log(NODE_ERROR * (2 * count + 1)) + 3 * math.lgamma(2 * count + 1):
            return count
    return following


def shifted(grid: Grid, counts: tuple[int, int]) -> Iterator[tuple[Grid, float]]:
    """Yield the grid moved to each node of a Gauss-Legendre rule over its pixel, with the weight.

    Parameters
    ----------
    grid : Grid
        Any.
    counts : tuple of int
        Nodes along rows and columns.

    Yields
    ------
    tuple
        Grid and weight; the weights sum to 1.
    """
    (nodes_y, weights_y), (nodes_x, weights_x) = (np.polynomial.legendre.leggauss(n) for n in counts)
    for node_y, weight_y in zip(nodes_y, weights_y, strict=True):
        for node_x, weight_x in zip(nodes_x, weights_x, strict=True):
            y = grid.centre[0] + node_y / 2 * grid.spacing[0]
            x = grid.centre[1] + node_x / 2 * grid.spacing[1]
            yield Grid(grid.shape, grid.spacing, (float(y), float(x))), float(weight_y * weight_x / 4)


def divided(grid: Grid, times: int) -> Grid:
    """Return a grid whose samples are the middles of equal parts of each pixel.

    Parameters
    ----------
    grid : Grid
        Any.
    times : int
        Parts along each axis, odd.

    Returns
    -------
    Grid
        Of times² as many samples.
    """
    (rows, columns), (step_y, step_x) = grid.shape, grid.spacing
    spacing = (step_y / times, step_x / times)
    # At even counts the middle sample is the first part of its pixel, not the middle one.
    y, x = (
        middle - (0 if count % 2 else times // 2) * step
        for middle, count, step in zip(grid.centre, grid.shape, spacing, strict=True)
    )
    return Grid((rows * times, columns * times), spacing, (y, x))


def gathered(parts: NDArray[np.floating], times: int) -> NDArray[np.floating]:
    """Return the sum over the parts of each pixel.

    Parameters
    ----------
    parts : ndarray, shape (rows × times, columns × times, channels)
        Values on a `divided` grid.
    times : int
        Parts along each axis.

    Returns
    -------
    ndarray, shape (rows, columns, channels)
        Their sums.
    """
    rows, columns, channels = parts.shape
    split = parts.reshape(rows // times, times, columns // times, times, channels)
    return np.asarray(split.sum(axis=(1, 3)))


def centred_mean(aperture: Aperture, grid: Grid, counts: tuple[int, int]) -> NDArray[np.float32]:
    """Return the mean of |F|² over each pixel of an odd, centred grid in frequency.

    |F(−q)|² = |F(q)|² for a real aperture, so the upper half is computed and turned.

    Parameters
    ----------
    aperture : Aperture
        Any.
    grid : Grid
        Cycles per metre; odd in both directions.
    counts : tuple of int
        Nodes along rows and columns.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Square of square metres.
    """
    rows, columns = grid.shape
    last = (rows // 2 - (rows // 2 + 1) // 2) * grid.spacing[0]
    upper = Grid((rows // 2 + 1, columns), grid.spacing, (-last, grid.centre[1]))
    mean = np.zeros(upper.shape, dtype=np.float32)
    for moved, weight in shifted(upper, counts):
        add_power(aperture, moved, weight, mean)
    return np.concatenate([mean, mean[-2::-1, ::-1]])


def add_power(
    aperture: Aperture,
    grid: Grid,
    weight: float,
    mean: NDArray[np.float32],
    wavelength: float | None = None,
) -> None:
    """Add weight × |F|² at the samples of a grid in frequency.

    Parameters
    ----------
    aperture : Aperture
        Any.
    grid : Grid
        Cycles per metre.
    weight : float
        Factor.
    mean : ndarray of float32, shape (rows, columns)
        Added to in place.
    wavelength : float, optional
        Metres; a wavefront needs it.
    """
    edges = sum(len(ring.vertices) for ring in aperture.outlines)
    if aperture.mask is None and edges <= MOST_EDGES:
        add_polygons_power(aperture, grid, weight, mean)
        return
    mean += np.float32(weight) * far_power(aperture, grid, wavelength=wavelength)
