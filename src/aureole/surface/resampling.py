"""A warped table on even steps of h, and back.

A table's samples are even in u, with h = half_range · uⁿ along each axis, and between samples it is
linear in u along each axis. Both ways are a product with a matrix along each axis, which has few entries.

In: values (rows, columns, channels) with their range and warp; out: values on other samples.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from aureole import refuse
from aureole.surface.table import axis, unwarp

GAUSS_POINTS = 3
FILTERS = ("point", "average", "sharpened")


def on_even_steps(
    values: NDArray[np.floating],
    half_range: float,
    warp: int,
    counts: tuple[int, int],
    step: float,
    filter: str = "average",
) -> NDArray[np.float32]:
    """Resample a table on even steps of h about h = 0; beyond the table's range is black.

    Parameters
    ----------
    values : ndarray, shape (rows, columns, channels)
        The table, row 0 at h_b = +half_range.
    half_range : float
        h at its border.
    warp : int
        The odd power in h = half_range · uⁿ.
    counts : tuple of int
        Samples to give (rows, columns), each odd: the middle one is h = 0.
    step : float
        Between them, in h.
    filter : str
        "point" takes the table's values at the samples; "average" its exact mean over the square
        of side `step` about each, so that no light falls between samples; "sharpened" is that mean with
        its own blur taken off again, to the fourth order in the step, of the same sum.

    Returns
    -------
    ndarray of float32, shape (*counts, channels)
        Row 0 at the largest h_b.
    """
    refuse.one_of("filter", filter, FILTERS)
    refuse.positive("step", step)
    down, along = (
        _matrix(size, half_range, warp, np.float64(step) * (np.arange(count) - count // 2), step, filter)
        for size, count in zip(values.shape[:2], counts, strict=True)
    )
    channels = [
        # Rows run against h_b, in the table and on the plane alike, and h = 0 is in the middle of both.
        along @ (down @ values[..., channel].astype(np.float64)).T
        for channel in range(values.shape[2])
    ]
    plane = np.stack([channel.T for channel in channels], axis=-1)
    if filter == "sharpened":
        # A mean over a step is the value and a 24th of the step squared times its second derivatives.
        plane = plane - (_differences(plane, 0) + _differences(plane, 1)) / 24
    return plane.astype(np.float32)


def on_warped_steps(
    plane: NDArray[np.floating], step: float, counts: tuple[int, int], half_range: float, warp: int
) -> NDArray[np.float32]:
    """Resample even steps of h as a warped table whose whole light is the plane's.

    The plane is taken as linear between its samples and black beyond them. A table's sample is the mean
    over what it stands for, a tent in u between its neighbours: where the warp is finer than the plane that
    is linear interpolation, and where it is coarser no light falls between samples.

    Parameters
    ----------
    plane : ndarray, shape (rows, columns, channels)
        Values on even steps, odd counts, h = 0 in the middle, row 0 at the largest h_b.
    step : float
        Between them, in h.
    counts : tuple of int
        The table's (rows, columns).
    half_range : float
        h at its border.
    warp : int
        The odd power in h = half_range · uⁿ.

    Returns
    -------
    ndarray of float32, shape (*counts, channels)
        Row 0 at h_b = +half_range.
    """
    down, along = (
        _tents(count, half_range, warp, size, step)
        for size, count in zip(plane.shape[:2], counts, strict=True)
    )
    channels = [(along @ (down @ plane[..., channel]).T).T for channel in range(plane.shape[2])]
    return np.stack(channels, axis=-1).astype(np.float32)


def _tents(count: int, half_range: float, warp: int, size: int, step: float) -> sparse.csr_matrix:
    """Weights (count, size) of means under a warped axis's tents of what is linear between even samples."""
    nodes, samples = axis(count, half_range, warp), step * (np.arange(size) - size // 2)
    inside = samples[(samples > nodes[0]) & (samples < nodes[-1])]
    cuts = np.union1d(nodes, inside)
    # Between cuts a tent is a smooth function of h and the plane is linear: three Gauss points are enough.
    places, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    length = np.diff(cuts)[:, None]
    h = (cuts[:-1, None] + length * (0.5 + 0.5 * places)).ravel()
    share = (length * 0.5 * weights).ravel()
    place = 0.5 * (count - 1) * (1.0 + unwarp(h, half_range, warp))
    i = np.clip(place.astype(np.int64), 0, count - 2)
    up = np.clip(place - i, 0.0, 1.0)
    even = h / step + size // 2
    j = np.floor(even).astype(np.int64)
    right = even - j
    entries, where, whole = [], [], np.zeros(count)
    for row, high in ((i, 1.0 - up), (i + 1, up)):
        np.add.at(whole, row, share * high)
        for column, part in ((j, 1.0 - right), (j + 1, right)):
            entries.append(share * high * part * ((column >= 0) & (column < size)))
            where.append((row, np.clip(column, 0, size - 1)))
    rows, columns = (np.concatenate(each) for each in zip(*where, strict=True))
    values = np.concatenate(entries) / whole[rows]
    return sparse.csr_matrix((values, (rows, columns)), shape=(count, size))


def _matrix(
    size: int, half_range: float, warp: int, places: NDArray[np.float64], step: float, filter: str
) -> sparse.csr_matrix:
    """Weights (places, size) of a warped axis's samples at, or about, even places."""
    if filter != "point":
        return _means(axis(size, half_range, warp), half_range, warp, places, step)
    return _linear(0.5 * (size - 1) * (1.0 + unwarp(places, half_range, warp)), size)


def _differences(plane: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """Second differences along an axis, the plane black beyond its border."""
    turned = np.moveaxis(plane, axis, 0)
    out = -2.0 * turned
    out[1:] += turned[:-1]
    out[:-1] += turned[1:]
    return np.moveaxis(out, 0, axis)


def _linear(index: NDArray[np.float64], size: int) -> sparse.csr_matrix:
    """Weights (places, size) of linear interpolation at fractional indices, none outside 0..size − 1."""
    rows = np.flatnonzero((index >= -1e-9) & (index <= size - 1 + 1e-9))
    low = np.clip(np.floor(index[rows]).astype(np.int64), 0, size - 2)
    right = np.clip(index[rows] - low, 0.0, 1.0)
    entries = np.concatenate([1.0 - right, right])
    where = np.concatenate([rows, rows]), np.concatenate([low, low + 1])
    return sparse.csr_matrix((entries, where), shape=(len(index), size))


def _means(
    nodes: NDArray[np.float64], half_range: float, warp: int, places: NDArray[np.float64], step: float
) -> sparse.csr_matrix:
    """Weights of the exact mean over each step of what is linear in u between the nodes."""
    edges = np.append(places - step / 2, places[-1] + step / 2)
    # Each piece between neighbouring cuts lies in one step and between two nodes.
    cuts = np.union1d(nodes, edges[(edges > nodes[0]) & (edges < nodes[-1])])
    middles = 0.5 * (cuts[1:] + cuts[:-1])
    cell = np.searchsorted(edges, middles) - 1
    inside = (cell >= 0) & (cell < len(places))
    left = np.clip(np.searchsorted(nodes, middles) - 1, 0, len(nodes) - 2)
    u = unwarp(cuts, half_range, warp)
    length = np.diff(cuts)
    # The integral of u over h, of which u − u[left] is the part of the node on the right.
    moment = half_range * warp / (warp + 1) * np.diff(u ** (warp + 1))
    gap = 2.0 / (len(nodes) - 1)
    right = (moment - (-1.0 + gap * left) * length) / gap
    entries = np.concatenate([length - right, right]) / step
    where = np.concatenate([cell, cell]), np.concatenate([left, left + 1])
    kept = np.concatenate([inside, inside])
    shape = (len(places), len(nodes))
    return sparse.csr_matrix((entries[kept], (where[0][kept], where[1][kept])), shape=shape)
