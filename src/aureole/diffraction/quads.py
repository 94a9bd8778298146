"""The far field of rectangles as a product of one-dimensional factors (quad paper Eq. 8-13).

A rectangle's transform is I Γ_x(u) Γ_y(v), and Γ is the transform of the interval's size times the
phase of its place (Eq. 11-13): a size is tabulated once, however many quads share it. With the phase's
cosine and sine apart, intervals at c and −c have the same factors but for a sign, and all products are
real. The sum over quads takes the factors of one axis first, for every distinct interval of the other;
what is left are four real products of a quarter plane, put together as those of `rows` are.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from aureole.diffraction import _kernels_quads, _kernels_rows
from aureole.diffraction.quadtree import Quads
from aureole.diffraction.rows import multiply
from aureole.records import Grid

# Intervals whose ends differ by less than this share of the whole extent are one.
ALIKE = 2.0**-31
# A part that holds less than this share of the weights is rounding.
NEGLIGIBLE = 1e-9
# Frequencies whose phases follow from one.
BLOCK = 32
# With more entries than one in so many places, a plain matrix product is faster than a sparse one.
ENTRIES_APART = 16


@dataclass(frozen=True, eq=False)
class Axis:
    """The distinct intervals along one axis, those at c and −c as one.

    Parameters
    ----------
    centres, sizes : ndarray of float64, shape (K,)
        Distances of the middles from zero, and lengths.
    which : ndarray of int64, shape (N,)
        Which interval each quad has.
    signs : ndarray of float32, shape (N,)
        On which side of zero it lies.
    """

    centres: NDArray[np.float64]
    sizes: NDArray[np.float64]
    which: NDArray[np.int64]
    signs: NDArray[np.float32]


def quads_field(quads: Quads, grid: Grid) -> NDArray[np.complex64]:
    """Return the far field of signed rectangles (Eq. 8 and 12).

    Parameters
    ----------
    quads : Quads
        Rectangles in metres.
    grid : Grid
        Frequencies in cycles per metre.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Square metres.
    """
    out = np.empty(grid.shape, dtype=np.complex64)
    _kernels_rows.unfold(*_transforms(quads, grid), out)
    return out


def quads_power(quads: Quads, grid: Grid) -> NDArray[np.float32]:
    """Return the power |F|² of the far field of signed rectangles, without the field.

    Parameters
    ----------
    quads : Quads
        Rectangles in metres.
    grid : Grid
        Frequencies in cycles per metre.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Metres to the fourth.
    """
    out = np.empty(grid.shape, dtype=np.float32)
    _kernels_rows.unfold_power(*_transforms(quads, grid), out)
    return out


def box_factors(intervals: NDArray[np.float64], frequencies: NDArray[np.float64]) -> NDArray[np.complex64]:
    """Return Γ(u) = s sinc(u s) exp(−i2π u c) of intervals (Eq. 11).

    Parameters
    ----------
    intervals : ndarray, shape (N, 2)
        Ends in metres; centre c, length s.
    frequencies : ndarray, shape (M,)
        Cycles per metre.

    Returns
    -------
    ndarray of complex64, shape (N, M)
        Metres.
    """
    centre, length = intervals.mean(axis=1)[:, None], (intervals[:, 1] - intervals[:, 0])[:, None]
    size = (length * np.sinc(frequencies * length)).astype(np.float32)
    return np.asarray(size * _phases(-frequencies * centre), dtype=np.complex64)


def _phases(turns: NDArray[np.float64]) -> NDArray[np.complex64]:
    """Return exp(i2π turns)."""
    # Whole turns are taken off in float64, before float32 would lose them.
    phase = (2 * np.pi * (turns - np.rint(turns))).astype(np.float32)
    return np.asarray(np.cos(phase) + 1j * np.sin(phase), dtype=np.complex64)


def _transforms(
    quads: Quads, grid: Grid
) -> tuple[NDArray[np.float32], NDArray[np.bool_], np.float32, tuple[int, int]]:
    """Transform the four parities, in units of a width, as `_kernels_rows.unfold` takes them."""
    width = float(np.abs(quads.rectangles).max(initial=0)) or 1.0
    axes = [intervals_of(quads.rectangles[:, k::2] / width) for k in (1, 0)]
    factors = [
        _factors(axis, count, float(spacing * width), float(centre * width))
        for axis, count, spacing, centre in zip(axes, grid.shape, grid.spacing, grid.centre, strict=True)
    ]
    products = np.empty((4, factors[0].shape[2], factors[1].shape[2]), dtype=np.float32)
    present = np.zeros(4, dtype=np.bool_)
    pairs = []
    for part in range(4):
        weights = parity_weights(quads, axes, part)
        if weights is not None:
            left, right = thin_sides(weights, factors[0][part >> 1], factors[1][part & 1])
            pairs.append((left.T, right, products[part]))
            present[part] = True
    multiply(pairs)
    zero = [count // 2 if centre == 0 else -1 for count, centre in zip(grid.shape, grid.centre, strict=True)]
    return products, present, np.float32(width**2), (zero[0], zero[1])


def intervals_of(ends: NDArray[np.float64]) -> Axis:
    """Number the distinct intervals along an axis.

    Parameters
    ----------
    ends : ndarray of float64, shape (N, 2)
        Between −1 and 1.

    Returns
    -------
    Axis
        Equal intervals as one.
    """
    centres, sizes = ends.mean(axis=1), ends[:, 1] - ends[:, 0]
    places = np.rint(np.abs(centres) / ALIKE).astype(np.int64)
    keys = (places << 32) + np.rint(sizes / ALIKE).astype(np.int64) // 2
    _, first, which = np.unique(keys, return_index=True, return_inverse=True)
    signs = np.sign(centres).astype(np.float32)
    return Axis(np.abs(centres[first]), sizes[first], which.ravel(), signs)


def _factors(axis: Axis, count: int, spacing: float, centre: float) -> NDArray[np.float32]:
    """Return the even and the odd factor of each interval, s sinc(us) cos(2πuc) and the sine.

    Shape (2, K, M): M the frequencies, those from zero upwards where the grid is centred on zero.
    """
    index = np.arange(count // 2 + 1) if centre == 0 else np.arange(count) - count // 2
    u = centre + index * spacing
    places, which_place = np.unique(axis.centres, return_inverse=True)
    # Congruent quads share the transform of their size (Eq. 13).
    sizes, which_size = np.unique(np.rint(axis.sizes / ALIKE), return_inverse=True)
    lengths = (sizes * ALIKE)[:, None]
    boxes = (lengths * np.sinc(u * lengths)).astype(np.float32)
    coarse = _phases(places[:, None] * u[::BLOCK])
    fine = _phases(places[:, None] * (spacing * np.arange(BLOCK)))
    out = np.empty((2, len(axis.centres), len(u)), dtype=np.float32)
    _kernels_quads.interval_factors(coarse, fine, boxes, which_place.ravel(), which_size.ravel(), out)
    return out


def parity_weights(quads: Quads, axes: list[Axis], part: int) -> sparse.csr_array | None:
    """Return a parity's weight for each pair of intervals (y, x).

    Parameters
    ----------
    quads : Quads
        N signed rectangles.
    axes : list of Axis
        Their intervals along y and along x.
    part : int
        0 even, 1 odd along x, 2 odd along y, 3 odd along both.

    Returns
    -------
    csr_array of float32, or None
        None where all cancel.
    """
    y, x = axes
    weights = quads.weights.copy()
    for odd, axis in ((part >> 1, y), (part & 1, x)):
        if odd:
            weights *= axis.signs
    shape = (len(y.centres), len(x.centres))
    summed = sparse.coo_array((weights, (y.which, x.which)), shape=shape).tocsr()
    summed.data[np.abs(summed.data) < NEGLIGIBLE * np.abs(quads.weights).max(initial=0)] = 0
    summed.eliminate_zeros()
    return summed.astype(np.float32) if summed.nnz else None


def thin_sides(
    weights: sparse.csr_array, factors_y: NDArray[np.float32], factors_x: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return two thin matrices whose product is the sum over all quads.

    Summing along the axis with more intervals first keeps R small.

    Parameters
    ----------
    weights : csr_array of float32
        From `parity_weights`.
    factors_y, factors_x : ndarray of float32, shapes (K, P) and (L, Q)
        What each interval does at each place.

    Returns
    -------
    along_y, along_x : ndarray of float32, shapes (R, P) and (R, Q)
        Their product over R is the sum.
    """
    rows = np.flatnonzero(np.diff(weights.indptr))
    columns = np.unique(weights.indices)
    if len(rows) <= len(columns):
        return factors_y[rows], _sums(weights[rows], factors_x)
    return _sums(weights[:, columns].T.tocsr(), factors_y), factors_x[columns]


def _sums(weights: sparse.csr_array, factors: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return a sparse matrix times a dense one."""
    out = np.empty((weights.shape[0], factors.shape[1]), dtype=np.float32)
    if weights.nnz * ENTRIES_APART > weights.shape[0] * weights.shape[1]:
        multiply([(weights.toarray(), factors, out)])
    else:
        _kernels_quads.weighted_sums(weights.indptr, weights.indices, weights.data, factors, out)
    return out
