"""Spectral sums by looking the pattern up at scaled places: "full" and, with far fewer look-ups, "batch"."""

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.light.observer import bands, lit_range, quadrature
from aureole.light.scaling import TAPS, Task, index_positions, pixels_summed
from aureole.records import Pattern, Spectrum

Table = tuple[NDArray[np.uint32], NDArray[np.float32]]

FINE = 4  # neighbours that the first pass of "batch" adds up
LOW, HIGH = 400e-9, 700e-9  # the range that "batch" samples; light beyond counts for its ends


def full(task: Task) -> NDArray[np.float32]:
    """Add all wavelengths row by row in float32 (quad paper Eq. 16).

    Parameters
    ----------
    task : Task
        What to sum.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        The sum in XYZ.

    Raises
    ------
    refuse.Refusal
        Where the source is a callable.
    """
    pattern = task.pattern("full")
    wavelengths, weights = quadrature(task.spectrum, task.samples)
    ratios = task.wavelength / wavelengths
    lookup = _Lookup(pattern, task.taps, ratios, _brighter(weights, ratios), *_upper(task))
    return _plane(task, lookup, _padded(pattern.intensity, lookup.rows))


def full_at(
    pattern: Pattern,
    spectrum: Spectrum,
    y: NDArray[np.float64],
    x: NDArray[np.float64],
    samples: int,
    taps: int,
) -> NDArray[np.float32]:
    """Add all wavelengths where chosen rows and columns cross.

    Parameters
    ----------
    pattern : Pattern
        The pattern, at its own wavelength.
    spectrum : Spectrum
        The light.
    y, x : ndarray of float64, shapes (R,) and (C,)
        Frequencies, rising, at any distances.
    samples : int
        Number of wavelengths.
    taps : int
        2 interpolates linearly, 4 by cubics.

    Returns
    -------
    ndarray of float32, shape (R, C, 3)
        The sum in XYZ.
    """
    wavelengths, weights = quadrature(spectrum, samples)
    ratios = pattern.wavelength / wavelengths
    return stretched_at(pattern, ratios, _brighter(weights, ratios), y, x, taps)


def stretched_at(
    pattern: Pattern,
    scales: NDArray[np.float64],
    weights: NDArray[np.float64],
    y: NDArray[np.float64],
    x: NDArray[np.float64],
    taps: int,
) -> NDArray[np.float32]:
    """Add a pattern up, looked up at places multiplied by one scale after the other.

    Parameters
    ----------
    pattern : Pattern
        Zero outside its grid.
    scales : ndarray of float64, shape (W,)
        Positive.
    weights : ndarray of float64, shape (W, 3)
        Of each scale for X, Y and Z.
    y, x : ndarray of float64, shapes (R,) and (C,)
        Places in the pattern's unit, rising, at any distances.
    taps : int
        2 interpolates linearly, 4 by cubics.

    Returns
    -------
    ndarray of float32, shape (R, C, 3)
        Σ_k weights[k] P(scales[k] (x, y)).
    """
    out = np.empty((y.size, x.size, 3), dtype=np.float32)
    lookup = _Lookup(pattern, taps, scales, weights, y, x)
    lookup.add(_padded(pattern.intensity, lookup.rows), out)
    return out


def batch(task: Task) -> NDArray[np.float32]:
    """Add neighbouring wavelengths first, then look up a quarter of them: the paper's two passes.

    The wavelengths λ_mj stand at even ratios over 400 to 700 nm, four neighbours j to each of 15 bands m
    (for 60 samples; quad paper, section 4.3, "batch-scaling"). The scales ρ = λ_r / λ_mj factor into
    γ_j ρ_m, so that Eq. 16 becomes

        S_c(q) = Σ_m w_cm ρ_m² T(ρ_m q),    T(q) = ¼ Σ_j γ_j² P_r(γ_j q):

    4 + 15 look-ups for 60 wavelengths. The paper keeps the four terms of T apart; here they are added,
    each band having one weight. T, which is smoother than P_r along the rays, is interpolated linearly.

    Parameters
    ----------
    task : Task
        What to sum; the number of samples is rounded up to a multiple of four.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        The sum in XYZ.

    Raises
    ------
    refuse.Refusal
        Where the source is a callable, or the light has lines.
    """
    pattern = task.pattern("batch")
    if task.spectrum.kind == "lines":
        raise refuse.Refusal("'method' 'batch' needs a spectrum of kind 'power'; use 'full' for lines.")
    count = -(-task.samples // FINE)
    low, high = lit_range(task.spectrum, LOW, HIGH)
    edges = np.geomspace(low, high, count + 1)
    step = (high / low) ** (1 / (FINE * count))
    neighbours = step ** (np.arange(FINE) - (FINE - 1) / 2)
    middles = np.sqrt(edges[1:] * edges[:-1])
    ratios = task.wavelength / middles
    weights = _brighter(bands(task.spectrum, edges), ratios)
    lookup = _Lookup(pattern, TAPS["linear"], ratios, weights, *_upper(task))
    return _plane(task, lookup, _first_pass(pattern, neighbours, lookup.rows, task.taps))


def look_ups(task: Task) -> int:
    """Count the look-ups of "full".

    Parameters
    ----------
    task : Task
        What to sum.

    Returns
    -------
    int
        Pixels times wavelengths.
    """
    return pixels_summed(task) * task.samples


class _Lookup:
    """Tables of where each wavelength reads a pattern for rows y and columns x."""

    def __init__(
        self,
        pattern: Pattern,
        taps: int,
        ratios: NDArray[np.float64],
        weights: NDArray[np.float64],
        y: NDArray[np.float64],
        x: NDArray[np.float64],
    ) -> None:
        from aureole.light import _kernels  # compiled code: loaded when first used

        self._kernels, self._pattern, self._taps = _kernels, pattern, taps
        # Fill up the last group with wavelengths that lie outside and weigh nothing.
        spare = -ratios.size % _kernels.GROUP
        self._scales = np.concatenate([ratios, np.full(spare, 1e9)])
        self._weights = np.concatenate([weights, np.zeros((spare, 3))]).astype(np.float32)
        self._table = self._tables(y, x)
        self.rows = _rows_read(self._table[0][0], taps, pattern.grid.shape[0])

    def add(self, padded: NDArray[np.float32], out: NDArray[np.float32]) -> None:
        """Fill out with the sum of all wavelengths' look-ups of a padded pattern."""
        self._kernels.sum_wavelengths(
            padded, self._taps, *self._table[0], *self._table[1], self._weights, out
        )

    def add_at(
        self,
        padded: NDArray[np.float32],
        y: NDArray[np.float64],
        x: NDArray[np.float64],
        out: NDArray[np.float32],
    ) -> None:
        """Do the same for other rows and columns."""
        rows, columns = self._tables(y, x)
        self._kernels.sum_wavelengths(padded, self._taps, *rows, *columns, self._weights, out)

    def _tables(self, y: NDArray[np.float64], x: NDArray[np.float64]) -> tuple[Table, Table]:
        places = index_positions(self._pattern.grid, np.outer(self._scales, y), np.outer(self._scales, x))
        rows, columns = self._pattern.grid.shape
        return _taps(places[0], rows, self._taps), _taps(places[1], columns, self._taps)


def _brighter(weights: NDArray[np.float64], ratios: NDArray[np.float64]) -> NDArray[np.float64]:
    """Multiply weights (W, 3) by ρ², which keeps the energy of a far field that shrinks by ρ."""
    return np.asarray(weights * ratios[:, None] ** 2)


def _upper(task: Task) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the rows that a task has to sum, those down to the centre where it is symmetric, and columns."""
    y, x = task.grid.axes()
    return (y[: task.grid.shape[0] // 2 + 1] if task.symmetric else y), x


def _plane(task: Task, lookup: _Lookup, padded: NDArray[np.float32]) -> NDArray[np.float32]:
    """Fill the plane from a padded pattern; where symmetric, only its upper half is read."""
    from aureole.light import _kernels

    (y, x), centre = task.grid.axes(), task.grid.shape[0] // 2
    pixels = np.empty((*task.grid.shape, 3), dtype=np.float32)
    lookup.add(padded, pixels[: centre + 1] if task.symmetric else pixels)
    if task.symmetric:
        _kernels.turn(pixels, centre)
        if x.size % 2 == 0 and y.size > centre + 1:
            # At even sizes the first column has no partner on the grid: look its opposite up.
            edge = np.empty((y.size - centre - 1, 1, 3), dtype=np.float32)
            lookup.add_at(padded, -y[centre + 1 :], -x[:1], edge)
            pixels[centre + 1 :, :1] = edge
    return pixels


def _first_pass(
    pattern: Pattern, neighbours: NDArray[np.float64], rows: slice, taps: int
) -> NDArray[np.float32]:
    """Return T, padded: the mean of a pattern's neighbours at scales γ_j, each times γ_j²."""
    from aureole.light import _kernels, _kernels_batch

    y, x = pattern.grid.axes()
    places = index_positions(pattern.grid, np.outer(neighbours, y[rows]), np.outer(neighbours, x))
    row_table = _taps(places[0], len(y), taps)
    column_table = _taps(places[1], len(x), taps)
    source = np.ascontiguousarray(pattern.intensity, dtype=np.float32)
    total = _frame(source.shape)
    part = total[_kernels.BEFORE + rows.start : _kernels.BEFORE + rows.stop]
    shares = (neighbours**2 / neighbours.size).astype(np.float32)
    jumps = _jumps(column_table[0])
    _kernels_batch.add_neighbours(source, taps, *row_table, *column_table, jumps, shares, part)
    return total


def _jumps(index: NDArray[np.uint32]) -> NDArray[np.int64]:
    """Return where each row of indices (K, C) does not rise by one: (K, J), from 0 to C, filled with C."""
    count = index.shape[1]
    found = [np.flatnonzero(np.diff(row.astype(np.int64)) != 1) + 1 for row in index]
    jumps = np.full((len(index), max(map(len, found)) + 2), count, dtype=np.int64)
    jumps[:, 0] = 0
    for row, places in zip(jumps, found, strict=True):
        row[1 : len(places) + 1] = places
    return jumps


def _padded(intensity: NDArray[np.floating], rows: slice) -> NDArray[np.float32]:
    """Copy rows of a pattern into a frame of zeros, so that every tap of a clipped position exists."""
    from aureole.light._kernels import AFTER, BEFORE

    padded = _frame(intensity.shape)
    padded[BEFORE:-AFTER, BEFORE:-AFTER][rows] = intensity[rows]
    return padded


def _frame(shape: tuple[int, ...]) -> NDArray[np.float32]:
    from aureole.light._kernels import AFTER, BEFORE

    return np.zeros((shape[0] + BEFORE + AFTER, shape[1] + BEFORE + AFTER), dtype=np.float32)


def _rows_read(index: NDArray[np.uint32], taps: int, count: int) -> slice:
    """Return which of a pattern's rows are read at these padded indices of first taps."""
    from aureole.light._kernels import BEFORE

    low = min(max(int(index.min()) - BEFORE, 0), count)
    high = min(max(int(index.max()) - BEFORE + taps, low), count)
    return slice(low, high)


def _taps(places: NDArray[np.float64], count: int, taps: int) -> Table:
    """Split positions into the padded index of the first tap and the fraction; outside is clipped."""
    from aureole.light._kernels import BEFORE

    inside = np.clip(places, -2.0, count + 1.0)
    whole = np.floor(inside)
    first = whole + (BEFORE + 1 - taps // 2)
    return first.astype(np.uint32), (inside - whole).astype(np.float32)
