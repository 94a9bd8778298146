"""Sums over wavelengths of orders that are Gaussian lobes in h: what tables of height fields are made of.

A lobe is narrow: it reaches a few cells where orders are far apart, and each cell a few orders. So rows and
columns keep lists of what reaches what, and a table is the sum over these only. `height.spread_orders` is
the same with whole matrices, one wavelength at a time: the reference.
"""

import math
import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from aureole.surface import _kernels_orders
from aureole.surface.gratings import normal_mean

# A lobe ends this many standard deviations from its middle, where 2e-9 of it are left.
REACH = 6.0
# Rows of a table between two stages.
ROWS = 256

Array = NDArray[np.float64]


def lobe_deviation(wavelength: float, coherence: float) -> float:
    """Return the standard deviation in h of an order under a Gaussian window.

    A window of standard deviation σ makes an order a Gaussian of λ / (2√2 π σ) in h.

    Parameters
    ----------
    wavelength : float
        Metres.
    coherence : float
        Coherence length, metres; the window's σ is a quarter of it.

    Returns
    -------
    float
        In h.
    """
    return wavelength / (2.0 * math.sqrt(2.0) * math.pi * 0.25 * coherence)


@dataclass(frozen=True, eq=False)
class Lobes:
    """Which orders reach which cells of a table at each wavelength, and how much of each they bring.

    Parameters
    ----------
    rows : ndarray of int64, shape (W, R, 3)
        First and end of the orders that reach a row, and where their shares begin.
    row_shares : ndarray of float64
        Mean of an order's lobe over a row's cell.
    columns : ndarray of int64, shape (W, N, 3)
        First and end of the columns that an order reaches, and where its shares begin.
    column_shares : ndarray of float64
        Mean of its lobe over their cells.
    """

    rows: NDArray[np.int64]
    row_shares: Array
    columns: NDArray[np.int64]
    column_shares: Array


def lobes(
    frequencies: tuple[Array, Array],
    wavelengths: Array,
    cells: tuple[Array, Array],
    coherence: float,
) -> Lobes:
    """List where the lobes of all orders fall at all wavelengths.

    Parameters
    ----------
    frequencies : tuple of ndarray of float64, shape (N,) and (M,)
        Of the orders along columns (t) and rows (−b, since a field's rows run downward), rising, 1/m.
    wavelengths : ndarray of float64, shape (W,)
        Metres.
    cells : tuple of ndarray of float64, shape (2, C) and (2, R)
        Ends in h of the columns' cells along t, rising, and of the rows' along b, falling.
    coherence : float
        Coherence length, metres.

    Returns
    -------
    Lobes
        For `add_lobes`.
    """
    downward = -cells[1][::-1]
    return Lobes(
        *_listed(frequencies[1], wavelengths, downward, coherence, True),
        *_listed(frequencies[0], wavelengths, cells[0], coherence, False),
    )


def add_lobes(
    powers: Array, wanted: NDArray[np.int64], weights: Array, where: Lobes, out: Array
) -> Iterator[float]:
    """Add the lobes of all orders at all wavelengths to a table.

    Parameters
    ----------
    powers : ndarray of float64, shape (P, M, N)
        Powers of orders.
    wanted : ndarray of int64, shape (W,)
        Which of the P each wavelength has.
    weights : ndarray of float64, shape (W, 3)
        What each wavelength counts for X, Y and Z.
    where : Lobes
        Where they fall.
    out : ndarray of float64, shape (3, R, C)
        Is added to, in 1/sr.

    Yields
    ------
    float
        Share done.
    """
    scaled = np.ascontiguousarray(weights / (4.0 * np.pi**2))
    lists = (where.rows, where.row_shares, where.columns, where.column_shares)
    threads = os.cpu_count() or 1
    with ThreadPoolExecutor(threads) as pool:
        for start in range(0, out.shape[1], ROWS):
            end = min(start + ROWS, out.shape[1])
            tasks = [
                pool.submit(_kernels_orders.add_orders, powers, wanted, scaled, *lists, low, out[:, low:high])
                for low, high in pairwise(np.linspace(start, end, threads + 1).astype(int))
            ]
            for task in tasks:
                task.result()
            yield end / out.shape[1]


def _listed(
    frequencies: Array, wavelengths: Array, cells: Array, coherence: float, of_cells: bool
) -> tuple[NDArray[np.int64], Array]:
    """List for each cell the orders that reach it, or for each order the cells that it reaches.

    Returns (W, ·, 3): first, end and place of the shares; and the shares.
    """
    lists, shares, place = [], [], 0
    for wavelength in wavelengths:
        deviation = lobe_deviation(wavelength, coherence)
        centres, wide = wavelength * frequencies, REACH * deviation
        if of_cells:
            first, end = np.searchsorted(centres, cells[0] - wide), np.searchsorted(centres, cells[1] + wide)
        else:
            first, end = np.searchsorted(cells[1], centres - wide), np.searchsorted(cells[0], centres + wide)
        lengths = end - first
        begin = np.cumsum(lengths) - lengths
        owner = np.repeat(np.arange(lengths.size), lengths)
        member = np.arange(owner.size) - np.repeat(begin - first, lengths)
        cell, order = (owner, member) if of_cells else (member, owner)
        shares.append(normal_mean(cells[:, cell], deviation, centres[order]))
        lists.append(np.stack([first, end, begin + place], axis=1))
        place += owner.size
    return np.stack(lists), np.concatenate(shares)
