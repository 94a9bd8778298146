"""The near field of pixels: products of tables of Fresnel integrals along x and along y.

The field of a rectangle is a product of two differences of Fresnel integrals (quad paper §4.5,
Eq. 17-19), so that of a mask is a matrix product. An opening's even and odd parts have even and odd
fields: on a plane centred on the axis only a quarter is computed.
"""

import math
import os
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from aureole import aperture as apertures
from aureole.diffraction import _kernels_fresnel, _kernels_near
from aureole.diffraction.fresnel import decay_polynomial, taylor_table
from aureole.diffraction.quads import ALIKE, Axis, intervals_of, parity_weights, thin_sides
from aureole.diffraction.quadtree import Quads, quadtree
from aureole.diffraction.rows import Factor, factor, in_threads, sides
from aureole.records import Aperture, Grid

# A scale above this differs in nothing that a float can show, and its products stay finite.
LARGEST_SCALE = 1e150
# Fresnel integrals are at their limit long before.
FARTHEST = 1e15
# Pixels across which the phase turns by less than this many radians are integrated, not subtracted.
SMOOTH = 2.0
NODES = 10

# Products that are summed one after another in float32, before their sums are.
AT_A_TIME = 128
# Computed places of a tile along y, and half of those along x, at most.
LARGEST = 512
# Which parity (1 odd along x, 2 odd along y), and the two sides whose product it is, (R, 2 P) and
# (R, 2 Q): real and imaginary parts in turn.
Part = tuple[int, NDArray[np.float32], NDArray[np.float32]]
Tile = tuple[int, int, int, int]


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
    along_y, along_x = (differences(edges, axis, scale_of(distance, wavelength)) for axis in grid.axes())
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
    return field_of(quads_parts(aperture, grid, distance, wavelength, quads), grid)


def quads_near_power(
    aperture: Aperture, grid: Grid, distance: float, wavelength: float, quads: Quads | None = None
) -> NDArray[np.float32]:
    """Return |D|² of a mask's signed rectangles, without the field.

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
    ndarray of float32, shape (rows, columns)
        Without unit.
    """
    return power_of(quads_parts(aperture, grid, distance, wavelength, quads), grid)


def quads_parts(
    aperture: Aperture, grid: Grid, distance: float, wavelength: float, quads: Quads | None = None
) -> list[Part]:
    """Return the two sides of each part of a near field, from rectangles.

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
    list of Part
        Four at most.
    """
    assert aperture.mask is not None
    quads = quadtree(aperture.mask, aperture.width) if quads is None else quads
    axes = [intervals_of(quads.rectangles[:, k::2] / aperture.width) for k in (1, 0)]
    scale = scale_of(distance, wavelength) * aperture.width
    factors_y, factors_x = (
        _interval_factors(axis, places / aperture.width, scale)
        for axis, places in zip(axes, computed_places(grid), strict=True)
    )
    parts: list[Part] = []
    for part in range(4):
        weights = parity_weights(quads, axes, part)
        if weights is not None:
            parts.append((part, *thin_sides(weights, factors_y[part >> 1], factors_x[part & 1])))
    return parts


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
        A raster; with a wavefront, its real and imaginary part are taken as masks.
    grid : Grid
        Metres; four times faster centred on the axis.
    distance, wavelength : float
        Metres.
    factors : list of Factor, optional
        What `rows.factor` found in the aperture's mask, if it has no wavefront.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Without unit.
    """
    if aperture.wavefront is None:
        return field_of(rows_parts(aperture, grid, distance, wavelength, factors), grid)
    wave = apertures.transmittance(aperture, wavelength)
    real, imaginary = (
        rows_near(Aperture(aperture.width, mask=part.astype(np.float32)), grid, distance, wavelength)
        for part in (wave.real, wave.imag)
    )
    return np.asarray(real + np.complex64(1j) * imaginary)


def rows_near_power(
    aperture: Aperture,
    grid: Grid,
    distance: float,
    wavelength: float,
    factors: list[Factor] | None = None,
) -> NDArray[np.float32]:
    """Return |D|² of a mask from its distinct rows or columns, without the field.

    Parameters
    ----------
    aperture : Aperture
        A raster; with a wavefront, its real and imaginary part are taken as masks.
    grid : Grid
        Metres; four times faster centred on the axis.
    distance, wavelength : float
        Metres.
    factors : list of Factor, optional
        What `rows.factor` found in the aperture's mask.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Without unit.
    """
    if aperture.wavefront is None:
        return power_of(rows_parts(aperture, grid, distance, wavelength, factors), grid)
    amplitude = rows_near(aperture, grid, distance, wavelength)
    return np.asarray(amplitude.real**2 + amplitude.imag**2)


def rows_parts(
    aperture: Aperture,
    grid: Grid,
    distance: float,
    wavelength: float,
    factors: list[Factor] | None = None,
) -> list[Part]:
    """Return the two sides of each part of a near field, from rows.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Metres.
    distance, wavelength : float
        Metres.
    factors : list of Factor, optional
        What `rows.factor` found in the aperture's mask.

    Returns
    -------
    list of Part
        Four at most.
    """
    assert aperture.mask is not None
    found = factor(aperture.mask) if factors is None else factors
    tables_y, tables_x = MaskAxes(aperture, grid, found).tables(distance, wavelength)
    parts: list[Part] = []
    for each in found:
        y, x = each.odd
        parts.append((2 * y + x, *sides(each, tables_y[y], tables_x[x])))
    return parts


class MaskAxes:
    """The edges of a mask's pixels and the places of a plane, along both axes.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Metres.
    factors : list of Factor
        What `rows.factor` found in the aperture's mask.
    """

    def __init__(self, aperture: Aperture, grid: Grid, factors: list[Factor]) -> None:
        assert aperture.mask is not None
        size = len(aperture.mask)
        self._edges = (np.arange(1.0, (size + 1) // 2 + 1) - 0.5 * (size % 2)) * (aperture.width / size)
        self._used = used_edges(factors, len(self._edges))
        self._spacing = grid.spacing
        self.places = computed_places(grid)
        self._alike = np.array_equal(*self.places)
        if self._alike:
            self._used = (self._used[0] | self._used[1],) * 2

    def tables(self, distance: float, wavelength: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the field of an interval from the centre to each edge that is used.

        Parameters
        ----------
        distance, wavelength : float
            Metres.

        Returns
        -------
        along_y, along_x : ndarray of float32, shape (2, h, 2 M)
            Even and odd; real and imaginary parts in turn.
        """
        scale = scale_of(distance, wavelength)
        along_y = self._along(0, scale)
        return along_y, along_y if self._alike else self._along(1, scale)

    def _along(self, axis: int, scale: float) -> NDArray[np.float32]:
        return _edge_factors(self._edges, self._used[axis], self.places[axis], self._spacing[axis], scale)


def used_edges(factors: list[Factor], count: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which edges of pixels a mask steps at.

    Parameters
    ----------
    factors : list of Factor
        What `rows.factor` found in it.
    count : int
        Edges from the centre outwards, without that at the centre.

    Returns
    -------
    along_y, along_x : ndarray of bool, shape (count,)
        True where some line steps or where one set of equal lines ends.
    """
    used = np.zeros((2, count), dtype=np.bool_)
    for each in factors:
        axis = 1 if each.by_rows else 0
        used[axis, :-1] |= (each.lines[:, 1:] != each.lines[:, :-1]).any(axis=0)
        used[axis, -1] |= bool(each.lines[:, -1].any())
        used[1 - axis] |= np.append(each.labels[1:], -1) != each.labels
    return used[0], used[1]


def field_of(parts: list[Part], grid: Grid) -> NDArray[np.complex64]:
    """Return the field on the whole plane.

    Parameters
    ----------
    parts : list of Part
        Two sides each.
    grid : Grid
        Metres.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Without unit.
    """
    out = np.empty(grid.shape, dtype=np.complex64) if parts else np.zeros(grid.shape, dtype=np.complex64)
    write_tiles(parts, grid, all_tiles(parts), _kernels_near.write_field, out)
    return out


def power_of(parts: list[Part], grid: Grid) -> NDArray[np.float32]:
    """Return the squared modulus of the field on the whole plane.

    Parameters
    ----------
    parts : list of Part
        Two sides each.
    grid : Grid
        Metres.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Without unit.
    """
    out = np.empty(grid.shape, dtype=np.float32) if parts else np.zeros(grid.shape, dtype=np.float32)
    write_tiles(parts, grid, all_tiles(parts), _kernels_near.write_power, out)
    return out


def write_tiles(
    parts: list[Part],
    grid: Grid,
    tiles: list[Tile],
    write: Callable[..., None],
    out: NDArray[Any],
) -> None:
    """Multiply the two sides of each part on tiles of the plane, and write the tiles.

    A complex product is taken as four real ones: as three it would have five times the error.

    Parameters
    ----------
    parts : list of Part
        Two sides each.
    grid : Grid
        Metres.
    tiles : list of Tile
        (top, bottom, first, last) among the computed rows and columns.
    write : callable
        `_kernels_near.write_field`, or another that takes what this takes.
    out : ndarray, shape (rows, columns)
        The plane.
    """
    present = np.zeros(4, dtype=np.bool_)
    present[[part for part, _, _ in parts]] = True
    middle = middle_of(grid)

    def evaluate(tile: Tile) -> None:
        top, bottom, first, last = tile
        products = np.empty((4, 2 * (bottom - top), 2 * (last - first)), dtype=np.float32)
        some = np.empty_like(products[0])
        for part, left, right in parts:
            for low in range(0, len(left), AT_A_TIME):
                rows = slice(low, low + AT_A_TIME)
                out_of = left[rows, 2 * top : 2 * bottom].T, right[rows, 2 * first : 2 * last]
                np.matmul(*out_of, out=some if low else products[part])
                if low:
                    products[part] += some
        write(products, present, (top, first), middle, out)

    in_threads(evaluate, tiles)


def all_tiles(parts: list[Part]) -> list[Tile]:
    """Return tiles of about the same size, as many in each column as keep all processors busy.

    Parameters
    ----------
    parts : list of Part
        Two sides each.

    Returns
    -------
    list of Tile
        All that is computed; none where there are no parts.
    """
    if not parts:
        return []
    rows, columns = (side.shape[1] // 2 for side in parts[0][1:])
    busy = os.cpu_count() or 1
    across = np.linspace(0, rows, busy * math.ceil(rows / (busy * LARGEST)) + 1).astype(int).tolist()
    along = np.linspace(0, columns, math.ceil(columns / (2 * LARGEST)) + 1).astype(int).tolist()
    return [
        (top, bottom, first, last)
        for top, bottom in pairwise(across)
        for first, last in pairwise(along)
        if top < bottom
    ]


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


def differences(
    edges: NDArray[np.float64], places: NDArray[np.float64], scale: float
) -> NDArray[np.complex128]:
    """Return ∫ exp(iπt²/2) dt over each pixel as each place sees it, in float64.

    Parameters
    ----------
    edges : ndarray of float64, shape (N + 1,)
        Of the pixels, metres.
    places : ndarray of float64, shape (M,)
        Metres.
    scale : float
        √(2 / (λz)), per metre.

    Returns
    -------
    ndarray of complex128, shape (M, N)
        Without unit.
    """
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


def computed_places(grid: Grid) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the places of the rows and the columns, from zero on where the grid is centred on zero.

    Parameters
    ----------
    grid : Grid
        Metres.

    Returns
    -------
    y, x : ndarray of float64
        Metres.
    """
    y, x = (
        np.arange(count // 2 + 1, dtype=np.float64) * spacing if centre == 0 else axis
        for axis, count, spacing, centre in zip(
            grid.axes(), grid.shape, grid.spacing, grid.centre, strict=True
        )
    )
    return y, x


def middle_of(grid: Grid) -> tuple[int, int]:
    """Return the row and the column at the origin, −1 where a plane is not centred on it.

    Parameters
    ----------
    grid : Grid
        Metres.

    Returns
    -------
    row, column : int
        Of the first of the computed places.
    """
    row, column = (
        count // 2 if centre == 0 else -1 for count, centre in zip(grid.shape, grid.centre, strict=True)
    )
    return row, column


def unfolded(part: NDArray[Any], middle: tuple[int, int], shape: tuple[int, int]) -> NDArray[Any]:
    """Return a plane that is its own mirror image from the part from its origin on.

    Parameters
    ----------
    part : ndarray, shape (P, Q) or (P, Q, 3)
        The rows and columns from the origin on, along axes that are mirrored, else all.
    middle : tuple of int
        Row and column at the plane's origin where the plane is mirrored, else −1.
    shape : tuple of int
        Of the plane.

    Returns
    -------
    ndarray, shape (rows, columns) or (rows, columns, 3)
        The plane.
    """
    row, column = max(middle[0], 0), max(middle[1], 0)
    out = np.empty((*shape, *part.shape[2:]), part.dtype)
    out[row:, column:] = part[: shape[0] - row, : shape[1] - column]
    out[row:, :column] = part[: shape[0] - row, column:0:-1]
    out[:row, column:] = part[row:0:-1, : shape[1] - column]
    out[:row, :column] = part[row:0:-1, column:0:-1]
    return out


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
    """Return the even and the odd factor of intervals, shape (2, K, 2 M).

    Real and imaginary parts in turn.
    """
    table = np.empty((len(edges), 2, len(places)), dtype=np.complex128)
    _kernels_fresnel.edge_integrals(edges, places, scale, taylor_table(), table)
    out = np.empty((2, len(low), 2 * len(places)), dtype=np.float32)
    _kernels_fresnel.interval_factors(table, low, high, out)
    return out


def _edge_factors(
    edges: NDArray[np.float64],
    used: NDArray[np.bool_],
    places: NDArray[np.float64],
    spacing: float,
    scale: float,
) -> NDArray[np.float32]:
    """Return the even and the odd factor of intervals from zero to each used edge, as `_factors` does."""
    out = np.zeros((2, len(edges), 2 * len(places)), dtype=np.float32)
    first, step = np.clip((scale * places[0], scale * spacing), -FARTHEST, FARTHEST)
    which = np.flatnonzero(used)
    _kernels_near.edge_factors(scale * edges, which, first, step, len(places), decay_polynomial(), out)
    return out
