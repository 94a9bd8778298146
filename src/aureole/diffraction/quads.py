"""The far field of rectangles as a product of one-dimensional factors (quad paper Eq. 8-13).

A rectangle's transform is I Γ_x(u) Γ_y(v). On a regular grid the sum over all of them is a product of
three small matrices: the factors of the distinct y-intervals, the weights of the pairs of intervals,
and the factors of the distinct x-intervals. Congruent quads share their factors that way (Eq. 13).
"""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from aureole.diffraction.quadtree import Quads
from aureole.records import Grid


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
    v, u = grid.axes()
    if not len(quads):
        return np.zeros(grid.shape, dtype=np.complex64)
    along_x, which_x = np.unique(quads.rectangles[:, 0::2], axis=0, return_inverse=True)
    along_y, which_y = np.unique(quads.rectangles[:, 1::2], axis=0, return_inverse=True)
    weights = sparse.coo_array(
        (quads.weights.astype(np.float32), (which_y.ravel(), which_x.ravel())),
        shape=(len(along_y), len(along_x)),
    ).tocsr()
    factors_y, factors_x = box_factors(along_y, v), box_factors(along_x, u)
    # Summing along the axis with fewer intervals first keeps the dense product small.
    if len(along_x) <= len(along_y):
        return np.asarray((weights.T @ factors_y).T @ factors_x)
    return np.asarray(factors_y.T @ (weights @ factors_x))


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
    turns = frequencies * centre
    # Whole turns are taken off in float64, before float32 would lose them.
    phase = (-2 * np.pi * (turns - np.rint(turns))).astype(np.float32)
    size = (length * np.sinc(frequencies * length)).astype(np.float32)
    return np.asarray(size * (np.cos(phase) + 1j * np.sin(phase)), dtype=np.complex64)
