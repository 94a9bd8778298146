"""A pattern's means over the cells of a table: no order falls between two samples, and none counts twice.

The pattern is bilinear between its samples and falls to zero over one sample beyond its border, so the mean
over a rectangle is one along rows times one along columns, both exact. In: a pattern, scales and weights of
wavelengths, cells; out: their sum.
"""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from aureole.aperture.bands import in_bands
from aureole.surface.pattern import DiffractionPattern

Array = NDArray[np.float64]

NARROWEST = 1e-6  # of a pattern's sample: no cell is taken to be narrower, so that its mean keeps its digits
_BEFORE = 2  # zeros in front of the pattern, so that every neighbour of a place exists


class CellMeans:
    """Adds a pattern's means over cells up, the cells multiplied by one scale after the other.

    Parameters
    ----------
    pattern : DiffractionPattern
        Zero outside.
    scales : ndarray of float64, shape (W,)
        Positive.
    weights : ndarray of float64, shape (W, 3)
        Of each scale for X, Y and Z.
    columns : ndarray of float64, shape (2, C)
        h · t of the columns' cells, low and high ends, rising.
    """

    def __init__(self, pattern: DiffractionPattern, scales: Array, weights: Array, columns: Array) -> None:
        from aureole.light._kernels import GROUP
        from aureole.surface import _kernels_cells  # compiled code: loaded when first used

        # Wavelengths without weight fill up the last group.
        spare = -scales.size % GROUP
        self._add, self._pattern = _kernels_cells.add_cells, pattern
        self._scales = np.concatenate([scales, np.ones(spare)])
        self._weights = np.concatenate([weights, np.zeros((spare, 3))]).astype(np.float32)
        across = _clipped(places_of(pattern, columns, self._scales, 1), pattern.values.shape[1])
        spans = _spans(across)
        spans[scales.size :] = 0
        self._columns = (*_neighbours(across), spans)
        behind = self._columns[1].shape[1]
        self._framed = np.pad(pattern.values, ((_BEFORE, behind), (_BEFORE, behind)))

    def add(self, rows: Array, out: NDArray[np.float32]) -> None:
        """Add the means over some rows' cells.

        Parameters
        ----------
        rows : ndarray of float64, shape (2, R)
            −h · b of the rows' cells, low and high ends, rising.
        out : ndarray of float32, shape (R, C, 3)
            To which Σ_k weights[k] ⟨M(scales[k] h)⟩ is added.
        """
        down = _clipped(places_of(self._pattern, rows, self._scales, 0), self._pattern.values.shape[0])
        in_bands(partial(self._add, self._framed, down, *self._columns, self._weights, out), len(out))


def reference_means(pattern: DiffractionPattern, scale: float, rows: Array, columns: Array) -> Array:
    """Return a pattern's means over cells as a product of matrices, in float64.

    Parameters
    ----------
    pattern : DiffractionPattern
        Zero outside.
    scale : float
        What the cells are multiplied with.
    rows : ndarray of float64, shape (2, R)
        −h · b of the rows' cells.
    columns : ndarray of float64, shape (2, C)
        h · t of the columns' cells.

    Returns
    -------
    ndarray of float64, shape (R, C)
        ∫ tent over the cell / its width, for rows × pattern × the same for columns.
    """
    down, across = (
        _tents(places_of(pattern, cells, np.array([scale]), axis)[0], pattern.values.shape[axis])
        for axis, cells in enumerate((rows, columns))
    )
    found: Array = down @ pattern.values.astype(np.float64) @ across.T
    return found


def places_of(pattern: DiffractionPattern, cells: Array, scales: Array, axis: int) -> Array:
    """Return where cells end among a pattern's samples.

    Parameters
    ----------
    pattern : DiffractionPattern
        Any.
    cells : ndarray of float64, shape (2, N)
        Low and high ends, in h.
    scales : ndarray of float64, shape (K,)
        What the cells are multiplied with.
    axis : int
        0 for rows, downward, 1 for columns.

    Returns
    -------
    ndarray of float64, shape (K, 2, N)
        Samples; the first is 0.
    """
    last = pattern.values.shape[axis] - 1
    places = 0.5 * last * (1.0 + scales[:, None, None] * cells / pattern.half_range)
    short = np.maximum(0.5 * (NARROWEST - (places[:, 1] - places[:, 0])), 0.0)
    return np.stack([places[:, 0] - short, places[:, 1] + short], axis=1)


def _tents(places: Array, count: int) -> Array:
    """Integrate each sample's tent over cells (2, N): (N, count), shares of the cell."""
    x = places[:, :, None] - np.arange(count)
    inside = np.clip(x, -1.0, 1.0)
    running = np.where(inside < 0, 0.5 * (1.0 + inside) ** 2, 1.0 - 0.5 * (1.0 - inside) ** 2)
    return np.asarray((running[1] - running[0]) / (places[1] - places[0])[:, None])


def _clipped(places: Array, count: int) -> Array:
    """Return low and high ends among framed samples and 1 / width, (K, 3, N); outside is cut off."""
    share = 1.0 / (places[:, 1:] - places[:, :1])
    return np.concatenate([np.clip(places, -1.0, count) + _BEFORE, share], axis=1)


def _neighbours(cells: Array) -> tuple[NDArray[np.uint32], NDArray[np.float32]]:
    """Return the first sample that cells (K, 3, N) take, (K, N), and all samples' shares, (K, T, N).

    Between two samples the mean is the value half-way of what is covered.
    """
    low, high, share = cells[:, 0], cells[:, 1], cells[:, 2]
    first = np.floor(low)
    # At the pattern's far border cells of no width may begin, which take nothing.
    steps = max(2, int((np.floor(high) - first).max()) + 1)
    shares = np.zeros((len(cells), steps + 1, cells.shape[2]), dtype=np.float32)
    for step in range(steps):
        start, stop = np.maximum(low - first, step), np.minimum(high - first, step + 1.0)
        part, middle = np.maximum(stop - start, 0.0) * share, 0.5 * (start + stop) - step
        shares[:, step] += part * (1.0 - middle)
        shares[:, step + 1] += part * middle
    return first.astype(np.uint32), shares


def _spans(cells: Array) -> NDArray[np.int64]:
    """Return which cells lie in the pattern, and which of these are narrow: (K, 4), rising."""
    count, middle = cells.shape[2], cells.shape[2] // 2
    lit = cells[:, 1] > cells[:, 0]
    begin, end = lit.argmax(axis=1), count - lit[:, ::-1].argmax(axis=1)
    begin = np.where(lit.any(axis=1), begin, end)
    # Widths fall towards the middle of a table and rise again, but for the half cells at its borders.
    wide = cells[:, 2] < 1.0
    before, behind = wide[:, :middle], wide[:, middle:]
    left = np.where(before.any(axis=1), middle - before[:, ::-1].argmax(axis=1), 0)
    right = np.where(behind.any(axis=1), middle + behind.argmax(axis=1), count)
    inner = [np.clip(place, begin, end) for place in (left, right)]
    return np.stack([begin, *inner, end], axis=1).astype(np.int64)
