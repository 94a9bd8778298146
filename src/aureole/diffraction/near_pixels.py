"""The near field of pixels: products of tables of Fresnel integrals along x and along y.

The field of a rectangle is a product of two differences of Fresnel integrals (quad paper §4.5,
Eq. 17-19), so that of a mask is a matrix product. An opening's even and odd parts have even and odd
fields: on a plane centred on the axis only a quarter is computed.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy import special

from aureole import aperture as apertures
from aureole.diffraction import _kernels_fresnel
from aureole.diffraction.fresnel import taylor_table
from aureole.diffraction.quads import ALIKE, Axis, intervals_of, parity_weights, thin_sides
from aureole.diffraction.quadtree import Quads, quadtree
from aureole.diffraction.rows import Factor, factor, multiply, sides
from aureole.records import Aperture, Grid

# A scale above this differs in nothing that a float can show, and its products stay finite.
LARGEST_SCALE = 1e150
# Fresnel integrals are at their limit long before.
FARTHEST = 1e15
# Pixels across which the phase turns by less than this many radians are integrated, not subtracted.
SMOOTH = 2.0
NODES = 10

Part = tuple[int, NDArray[np.float32], NDArray[np.float32]]


def reference_near(
    aperture: Aperture, grid: Grid, distance: float, wavelength: float
) -> NDArray[np.complex128]:
    """Return the near field as a sum over pixels, in float64.

    Parameters
    ----------
    aperture : Aperture
        A raster, with a wavefront or without.
    grid : Grid
        Metres.
    distance, wavelength : float
        Metres.

    Returns
    -------
    ndarray of complex128, shape (rows, columns)
        Without unit.
    """
    mask = apertures.transmittance(aperture, wavelength)
    edges = np.linspace(-0.5, 0.5, len(mask) + 1) * aperture.width
    along_y, along_x = (_differences(edges, axis, scale_of(distance, wavelength)) for axis in grid.axes())
    return np.asarray(-0.5j * (along_y @ mask.astype(np.complex128) @ along_x.T))


def quads_near(
    aperture: Aperture, grid: Grid, distance: float, wavelength: float, quads: Quads | None = None
) -> NDArray[np.complex64]:
    """Return the near field of a mask's signed rectangles (quad paper Eq. 17-19).

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Metres.
    distance, wavelength : float
        Metres.
    quads : Quads, optional
        The mask as `quadtree` breaks it.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Without unit.
    """
    assert aperture.mask is not None
    quads = quadtree(aperture.mask, aperture.width) if quads is None else quads
    axes = [intervals_of(quads.rectangles[:, k::2] / aperture.width) for k in (1, 0)]
    scale = scale_of(distance, wavelength) * aperture.width
    factors_y, factors_x = (
        _interval_factors(axis, places / aperture.width, scale)
        for axis, places in zip(axes, _computed(grid), strict=True)
    )
    parts: list[Part] = []
    for part in range(4):
        weights = parity_weights(quads, axes, part)
        if weights is not None:
            parts.append((part, *thin_sides(weights, factors_y[part >> 1], factors_x[part & 1])))
    return _unfolded(parts, grid)


def rows_near(
    aperture: Aperture,
    grid: Grid,
    distance: float,
    wavelength: float,
    factors: list[Factor] | None = None,
) -> NDArray[np.complex64]:
    """Return the near field of a mask from its distinct rows or columns.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Metres; four times faster centred on the axis.
    distance, wavelength : float
        Metres.
    factors : list of Factor, optional
        What `rows.factor` found in the aperture's mask.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Without unit.
    """
    assert aperture.mask is not None
    size = len(aperture.mask)
    half = (size + 1) // 2
    edges = np.append(0.0, (np.arange(1, half + 1) - 0.5 * (size % 2)) * (aperture.width / size))
    first, last = np.zeros(half, dtype=np.int64), np.arange(1, half + 1)
    places_y, places_x = _computed(grid)
    tables_y = tables_x = _factors(edges, first, last, places_y, scale_of(distance, wavelength))
    if not np.array_equal(places_y, places_x):
        tables_x = _factors(edges, first, last, places_x, scale_of(distance, wavelength))
    parts: list[Part] = []
    for each in factor(aperture.mask) if factors is None else factors:
        y, x = each.odd
        parts.append((2 * y + x, *sides(each, tables_y[y], tables_x[x])))
    return _unfolded(parts, grid)


def scale_of(distance: float, wavelength: float) -> float:
    """Return √(2 / (λz)), which makes a length the argument of a Fresnel integral.

    Parameters
    ----------
    distance, wavelength : float
        Metres.

    Returns
    -------
    float
        Per metre.
    """
    return min(math.sqrt(2) / math.sqrt(wavelength) / math.sqrt(distance), LARGEST_SCALE)


def _differences(
    edges: NDArray[np.float64], places: NDArray[np.float64], scale: float
) -> NDArray[np.complex128]:
    """Return ∫ exp(iπt²/2) dt over each pixel as each place sees it, shape (places, pixels)."""
    with np.errstate(over="ignore"):
        t = np.clip(scale * (edges - places[:, None]), -FARTHEST, FARTHEST)
        size = np.minimum(scale * np.diff(edges), FARTHEST)
    sine, cosine = special.fresnel(t)
    out: NDArray[np.complex128] = np.diff(cosine + 1j * sine, axis=1)
    # A difference of near values keeps few digits: where the phase hardly turns, Gauss-Legendre does.
    middle = 0.5 * (t[:, 1:] + t[:, :-1])
    near = np.abs(middle) < _kernels_fresnel.FLAT
    smooth = near & (np.pi * size * (np.where(near, np.abs(middle), 0) + np.minimum(size, 1)) < SMOOTH)
    middle, size = middle[smooth], np.broadcast_to(size, smooth.shape)[smooth]
    total = np.zeros(len(middle), dtype=np.complex128)
    for node, weight in zip(*np.polynomial.legendre.leggauss(NODES), strict=True):
        total += weight * np.exp(0.5j * np.pi * (middle + 0.5 * node * size) ** 2)
    out[smooth] = 0.5 * size * total
    return out


def _computed(grid: Grid) -> list[NDArray[np.float64]]:
    """Return the places of the rows and the columns, from zero on where the grid is centred on zero."""
    return [
        np.arange(count // 2 + 1, dtype=np.float64) * spacing if centre == 0 else axis
        for axis, count, spacing, centre in zip(
            grid.axes(), grid.shape, grid.spacing, grid.centre, strict=True
        )
    ]


def _interval_factors(axis: Axis, places: NDArray[np.float64], scale: float) -> NDArray[np.float32]:
    """Return the even and the odd factor of each of a list's intervals, in units of the width."""
    ends = np.concatenate([axis.centres - 0.5 * axis.sizes, axis.centres + 0.5 * axis.sizes])
    _, place, which = np.unique(np.rint(ends / ALIKE), return_index=True, return_inverse=True)
    low, high = np.split(which.ravel().astype(np.int64), 2)
    return _factors(ends[place], low, high, places, scale)


def _factors(
    edges: NDArray[np.float64],
    low: NDArray[np.int64],
    high: NDArray[np.int64],
    places: NDArray[np.float64],
    scale: float,
) -> NDArray[np.float32]:
    """Return the even and the odd factor of intervals, shape (2, K, 2 M): real parts, imaginary parts."""
    table = np.empty((len(edges), 2, len(places)), dtype=np.complex128)
    _kernels_fresnel.edge_integrals(edges, places, scale, taylor_table(), table)
    out = np.empty((2, len(low), 2 * len(places)), dtype=np.float32)
    _kernels_fresnel.interval_factors(table, low, high, out)
    return out


def _unfolded(parts: list[Part], grid: Grid) -> NDArray[np.complex64]:
    """Multiply the two sides of each part and put the parts together."""
    places_y, places_x = _computed(grid)
    products = np.empty((4, 2 * len(places_y), 2 * len(places_x)), dtype=np.float32)
    present = np.zeros(4, dtype=np.bool_)
    for part, _, _ in parts:
        present[part] = True
    multiply([(left.T, right, products[part]) for part, left, right in parts])
    rows, columns = (
        count // 2 if centre == 0 else -1 for count, centre in zip(grid.shape, grid.centre, strict=True)
    )
    out = np.empty(grid.shape, dtype=np.complex64)
    _kernels_fresnel.unfold(products, present, (rows, columns), out)
    return out
