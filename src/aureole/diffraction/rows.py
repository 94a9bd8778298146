"""The far field of a mask from its distinct rows: real matrix products of small rank.

The mask is folded about its centre, along both axes, into even and odd parts: four quadrants whose
transforms have cosines and sines only (a mirror-symmetric mask leaves half of them empty). A quadrant
whose rows repeat is a product of two thin matrices, and so is its transform: the spectra of its
distinct rows, and those of the sets of places where each stands. Columns serve as well as rows; the
fewer are taken. Both spectra follow from the steps of the lines and one table, ∫ cos(2πux) dx from 0
to each pixel edge (or the sine), so that the pixel's own transform is included exactly.

On an axis of frequencies centred on zero only those from zero upwards are computed, the others follow
by F(−u, −v) = F*(u, v).
"""

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

from aureole import refuse
from aureole.diffraction import _kernels_rows
from aureole.records import Aperture, Grid

# A part of a mask that holds less than this share of its sum is left out: the error is below it.
NEGLIGIBLE = 1e-8
# With more steps than one in so many pixels, a plain matrix product is faster than stepping.
STEPS_APART = 8

# Rows and columns that tell a mask's symmetry and how many of its lines are alike.
SAMPLED = 16


@dataclass(frozen=True, eq=False)
class Factor:
    """One folded quadrant of a mask as few lines, and where each of them stands.

    Parameters
    ----------
    odd : tuple of int
        (y, x): 1 where the quadrant is the odd part along that axis, 0 where it is the even one.
    by_rows : bool
        Whether the lines are rows or columns.
    lines : ndarray of float32, shape (R, h)
        Values from the mask's centre outwards.
    labels : ndarray of int64, shape (h,)
        Which line stands at each place across, −1 for a dark one.
    """

    odd: tuple[int, int]
    by_rows: bool
    lines: NDArray[np.float32]
    labels: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Folded:
    """A mask folded about its centre, along both axes, into even and odd parts.

    Parameters
    ----------
    quadrants : ndarray of float32, shape (4, h, h)
        From the centre outwards: even, odd along x, odd along y, odd along both. Only those kept are
        filled, and of them the rows that are lit.
    sums : ndarray of float64, shape (4, h)
        Sums of the magnitudes of the rows.
    kept : list of int
        Which quadrants hold anything.
    reach : int
        From this column on all are dark.
    """

    quadrants: NDArray[np.float32]
    sums: NDArray[np.float64]
    kept: list[int]
    reach: int


def fold(mask: NDArray[np.float32]) -> Folded:
    """Fold a mask about its centre.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Amplitude transmittance.

    Returns
    -------
    Folded
        Four quadrants at most.
    """
    half = (len(mask) + 1) // 2
    quadrants = np.empty((4, half, half), dtype=np.float32)
    sums, reach = np.empty((4, half)), np.empty(half, dtype=np.int64)
    _kernels_rows.fold(np.ascontiguousarray(mask, dtype=np.float32), quadrants, sums, reach)
    totals = sums.sum(axis=1)
    kept = [part for part in range(4) if totals[part] > NEGLIGIBLE * totals.max()]
    return Folded(quadrants, sums, kept, int(reach.max()))


def sample(mask: NDArray[np.float32]) -> tuple[int, int]:
    """Guess from a few rows and columns how much a mask's symmetry and its equal lines save.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Amplitude transmittance.

    Returns
    -------
    quadrants, lines : int
        How many quadrants of the folded mask hold anything, and about how many distinct lines each has.
    """
    quadrants, share = _kernels_rows.sample(np.ascontiguousarray(mask, dtype=np.float32), SAMPLED)
    return int(quadrants), int(share * (len(mask) + 1) / 2)


def factor(mask: NDArray[np.float32]) -> list[Factor]:
    """Fold a mask about its centre and find the distinct lines of each part that is not empty.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Amplitude transmittance.

    Returns
    -------
    list of Factor
        Four at most.
    """
    folded = fold(mask)
    return [_distinct(part, folded.quadrants[part], folded.sums[part]) for part in folded.kept]


def rows_field(aperture: Aperture, grid: Grid, factors: list[Factor] | None = None) -> NDArray[np.complex64]:
    """Return a raster's far field from its distinct rows or columns.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre, any spacing, any centre; four times faster centred on zero.
    factors : list of Factor, optional
        What `factor` found in the aperture's mask.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Square metres.
    """
    products, present, middle = _transforms(aperture, grid, factors)
    out = np.empty(grid.shape, dtype=np.complex64)
    _kernels_rows.unfold(products, present, np.float32(aperture.width**2), middle, out)
    return out


def rows_power(aperture: Aperture, grid: Grid, factors: list[Factor] | None = None) -> NDArray[np.float32]:
    """Return the power |F|² of a raster's far field, without the field.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre, as for `rows_field`.
    factors : list of Factor, optional
        What `factor` found in the aperture's mask.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Square metres, squared.
    """
    products, present, middle = _transforms(aperture, grid, factors)
    out = np.empty(grid.shape, dtype=np.float32)
    _kernels_rows.unfold_power(products, present, np.float32(aperture.width**2), middle, out)
    return out


def multiplications(factors: list[Factor], rows: int, columns: int) -> int:
    """Return how many multiplications the transforms of factors take, about.

    Parameters
    ----------
    factors : list of Factor
        From `factor`.
    rows, columns : int
        Frequencies that are computed along each axis.

    Returns
    -------
    int
        Of the products and of the lines' spectra.
    """
    total = 0
    for each in factors:
        along = columns if each.by_rows else rows
        steps = _kernels_rows.count_steps(each.lines)
        total += len(each.lines) * rows * columns + along * min(STEPS_APART * steps, each.lines.size)
    return total


def _distinct(part: int, quadrant: NDArray[np.float32], sums: NDArray[np.float64]) -> Factor:
    """Number the distinct rows, or columns where they are fewer."""
    hashed = _kernels_rows.hash_lines(quadrant.view(np.uint32), sums, _keys(len(quadrant)))
    (rows, row_labels), (columns, column_labels) = (_labels(each) for each in hashed)
    odd = (part >> 1, part & 1)
    if len(rows) <= len(columns):
        return Factor(odd, True, quadrant[rows], row_labels)
    # Dark rows hold no values yet.
    lines = np.where(sums > 0, quadrant[:, columns].T, np.float32(0))
    return Factor(odd, False, np.ascontiguousarray(lines), column_labels)


def _labels(hashes: NDArray[np.uint64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return a place of each distinct number but 0, and which of them each place has."""
    found, places, labels = np.unique(hashes, return_index=True, return_inverse=True)
    if found[0] == 0:
        return places[1:], labels - 1
    return places, labels


@lru_cache(maxsize=8)
def _keys(count: int) -> NDArray[np.uint64]:
    """Return fixed random odd numbers."""
    drawn = np.random.default_rng(0).integers(0, 1 << 63, count, dtype=np.uint64)
    return np.asarray(2 * drawn + 1, dtype=np.uint64)


def _transforms(
    aperture: Aperture, grid: Grid, factors: list[Factor] | None
) -> tuple[NDArray[np.float32], NDArray[np.bool_], tuple[int, int]]:
    """Transform every part of a mask, in units of its width, and say where the frequency zero is."""
    if aperture.mask is None:
        raise refuse.Refusal("a transform of pixels needs a raster; rasterize the outlines first.")
    size, width = len(aperture.mask), aperture.width
    tables_y, tables_x = (
        edge_tables(size, count, float(spacing * width), float(centre * width))
        for count, spacing, centre in zip(grid.shape, grid.spacing, grid.centre, strict=True)
    )
    products = np.empty((4, tables_y.shape[2], tables_x.shape[2]), dtype=np.float32)
    present = np.zeros(4, dtype=np.bool_)
    pairs = []
    for each in factor(aperture.mask) if factors is None else factors:
        y, x = each.odd
        left, right = sides(each, tables_y[y], tables_x[x])
        pairs.append((left.T, right, products[2 * y + x]))
        present[2 * y + x] = True
    multiply(pairs)
    zero = [count // 2 if centre == 0 else -1 for count, centre in zip(grid.shape, grid.centre, strict=True)]
    return products, present, (zero[0], zero[1])


def sides(
    each: Factor, table_y: NDArray[np.float32], table_x: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the two thin matrices whose product is a quadrant's transform.

    Parameters
    ----------
    each : Factor
        The quadrant.
    table_y, table_x : ndarray of float32, shapes (h, P) and (h, Q)
        Spectra of lines that are one up to and including each place, or anything linear in them.

    Returns
    -------
    left, right : ndarray of float32, shapes (R, P) and (R, Q)
        The transform is left.T @ right.
    """
    along, across = (table_x, table_y) if each.by_rows else (table_y, table_x)
    places = np.argsort(each.labels, kind="stable")
    starts = np.searchsorted(each.labels[places], np.arange(len(each.lines) + 1))
    shared = _kernels_rows.shared_spectra(places, starts, across)
    spectra = _spectra(each.lines, along)
    return (shared, spectra) if each.by_rows else (spectra, shared)


def _spectra(lines: NDArray[np.float32], table: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the spectra of lines, by their steps where these are few."""
    if _kernels_rows.count_steps(lines) * STEPS_APART <= lines.size:
        return np.asarray(_kernels_rows.line_spectra(lines, table))
    steps = lines.copy()
    steps[:, :-1] -= lines[:, 1:]
    out = np.empty((len(lines), table.shape[1]), dtype=np.float32)
    multiply([(steps, table, out)])
    return out


def multiply(pairs: list[tuple[NDArray[Any], NDArray[Any], NDArray[Any]]]) -> None:
    """Take matrix products in bands of rows, one thread each.

    Parameters
    ----------
    pairs : list of tuple
        Left and right matrix, and the array that their product goes into, real or complex.
    """
    bands = []
    for left, right, out in pairs:
        edges = np.linspace(0, len(out), _workers() + 1).astype(int)
        bands += [(left[i:j], right, out[i:j]) for i, j in pairwise(edges) if i < j]
    in_threads(lambda band: np.matmul(band[0], band[1], out=band[2]), bands)


def in_threads(task: Callable[[Any], object], items: Iterable[Any]) -> None:
    """Run a task that takes matrix products for each item: the machine's threads side by side.

    OpenBLAS's own threads wait for each other at every step: on a busy machine ten times as long.

    Parameters
    ----------
    task : callable
        Takes an item; what it returns is dropped.
    items : iterable
        Any.
    """
    with _blas().limit(limits=1):
        for _ in _pool().map(task, items):
            pass


def _workers() -> int:
    return os.cpu_count() or 1


@lru_cache(maxsize=1)
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(_workers(), thread_name_prefix="rows")


@lru_cache(maxsize=1)
def _blas() -> ThreadpoolController:
    return ThreadpoolController().select(user_api="blas")


@lru_cache(maxsize=4)
def edge_tables(size: int, count: int, spacing: float, centre: float) -> NDArray[np.float32]:
    """Return ∫ cos(2πux) dx and ∫ sin(2πux) dx from 0 to the pixels' edges, in units of the width.

    Parameters
    ----------
    size : int
        Pixels across the mask.
    count : int
        Frequencies of the grid along this axis.
    spacing, centre : float
        The grid's, in cycles per width of the mask.

    Returns
    -------
    ndarray of float32, shape (2, h, M)
        h edges from the centre outwards; M the frequencies, those from zero upwards where the grid is
        centred on zero. Read only.
    """
    half = (size + 1) // 2
    edges = (np.arange(1, half + 1) - 0.5 * (size % 2))[:, None] / size
    index = np.arange(count // 2 + 1) if centre == 0 else np.arange(count) - count // 2
    u = centre + index * spacing
    turns = u * edges
    # Whole turns are taken off in float64, before float32 would lose them.
    phase = (np.pi * (turns - np.rint(turns))).astype(np.float32)
    sine = np.sin(phase)
    rate = np.where(u == 0, np.inf, np.pi * u).astype(np.float32)
    tables = np.asarray([sine * np.cos(phase) / rate, sine * sine / rate], dtype=np.float32)
    tables[0][:, u == 0] = edges
    tables.setflags(write=False)
    return tables
