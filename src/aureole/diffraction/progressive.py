"""The far field of an aperture that changes: only the change is transformed (quad paper §4.3).

Scandolo, Lee, Eisemann, "Quad-based Fourier transform for efficient diffraction synthesis", 2018. The
difference of two masks is few quads, positive and negative ones, and the transform is linear. The sum
over those quads is taken row by row of the difference: it is folded about its centre into even and
odd parts, which have half as many rows and real waves, and rows equal by their bits are taken once.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole.diffraction import _kernels_progressive as kernels
from aureole.diffraction.changes import Change, ProgressiveField
from aureole.diffraction.far import RASTER_SIZE
from aureole.records import Grid

F32 = NDArray[np.float32]

# Above this part of values that are not zero, a dense product of the rows is faster.
MOST_SPARSE = 0.2


@dataclass(frozen=True, eq=False)
class _Axis:
    """One axis's frequencies, and waves of pixels at distances from a centre, times the pixel's sinc.

    waves[parity] are cosines and sines (2, distances, frequencies), of the distances 0, 1, 2, … pixels
    for parity 1, and of 1/2, 3/2, … for parity 0.
    """

    frequencies: NDArray[np.float64]
    waves: tuple[F32, F32]


class ProgressiveFarField(ProgressiveField):
    """The far field of one aperture after another, each from the one before.

    The running field is complex64. A bound of its rounding is kept, and where it passes 3e-5 of the
    peak, after some 400 small updates, the whole mask is transformed afresh; this is cheaper than to carry
    a compensation for every sample. So any number of updates agrees with `far_field` to 1e-4 of the
    peak ∬|f| dx dy.

    Parameters
    ----------
    grid : Grid
        Frequencies in cycles per metre; any spacing, any centre, odd and even sizes. A grid centred
        on zero takes a quarter of the products.
    raster_size : int
        Pixels a side to which outlines are rasterized, unless the first aperture is a raster: then
        its size holds.

    Raises
    ------
    refuse.Refusal
        Where the grid or the size does not fit.
    """

    def __init__(self, grid: Grid, raster_size: int = RASTER_SIZE) -> None:
        super().__init__(grid, raster_size, "far_field")

    def _prepare(self) -> None:
        self._mirrored = self._grid.centre == (0.0, 0.0)
        y, x = self._grid.axes()
        if self._mirrored:
            # The frequencies that are not negative, and at even sizes the mirror image of the first.
            y, x = np.unique(np.abs(y)), np.unique(np.abs(x))
        self._rows = _axis(y, self._size, self._pixel)
        self._columns = self._rows if np.array_equal(x, y) else _axis(x, self._size, self._pixel)

    def _largest(self, total: float) -> float:
        return total

    def _add(self, change: Change) -> None:
        """Add a change's transform to the field, and square the sum."""
        height, width = change.values.shape
        left, right, starts = _factors(change.values, self._rows, self._columns)
        y = (change.top + (height - self._size) / 2) * self._pixel
        x = (change.left + (width - self._size) / 2) * self._pixel
        turn_y = _turns(self._rows.frequencies * y)
        turn_x = np.zeros((2, right.shape[1]), dtype=np.float32)
        turn_x[:, : len(self._columns.frequencies)] = _turns(self._columns.frequencies * x)
        add = kernels.add_mirrored if self._mirrored else kernels.add_plain
        add(left, right, starts, turn_y, turn_x, self._field.view(np.float32), self._power)


def _axis(frequencies: NDArray[np.float64], size: int, pixel: float) -> _Axis:
    """Tabulate the waves of pixels at whole and at half distances from a centre."""
    scale = pixel * np.sinc(frequencies * pixel)
    tables = []
    for parity in range(2):
        distance = (np.arange((size + 1) // 2) + (0.0 if parity else 0.5)) * pixel
        turns = np.outer(distance, frequencies)
        phase = 2 * np.pi * (turns - np.rint(turns))
        tables.append(np.stack([np.cos(phase) * scale, np.sin(phase) * scale]).astype(np.float32))
    return _Axis(frequencies, (tables[0], tables[1]))


def _factors(values: F32, rows: _Axis, columns: _Axis) -> tuple[F32, F32, NDArray[np.int64]]:
    """Return the factors of a change's four parts, K rows of each, and where the parts begin.

    The parts are even along y and x, odd along y, odd along x, odd along both. The left factors are
    waves along y, those of equal rows added up; the right ones are the spectra of the distinct rows.
    """
    even_y, odd_y = _folded(values)
    wave_y, wave_x = rows.waves[len(values) % 2], columns.waves[values.shape[1] % 2]
    parts = []
    for along_x in range(2):
        for along_y, folded in enumerate((even_y, odd_y)):
            part = np.ascontiguousarray(_folded(folded.T)[along_x].T)
            distinct, which = _distinct(part)
            parts.append((along_y, along_x, distinct, which))
    lengths = [_whole(len(distinct), kernels.BLOCK) for _, _, distinct, _ in parts]
    starts = np.cumsum([0, *lengths], dtype=np.int64)
    left = np.zeros((starts[-1], _whole(wave_y.shape[2], kernels.BLOCK)), dtype=np.float32)
    right = np.zeros((starts[-1], _whole(wave_x.shape[2], kernels.TILE)), dtype=np.float32)
    for start, (along_y, along_x, distinct, which) in zip(starts, parts, strict=False):
        kernels.add_waves(which, wave_y[along_y], left[start:])
        _fill_spectra(distinct, wave_x[along_x], right[start:])
    return left, right, starts


def _fill_spectra(rows: F32, waves: F32, spectra: F32) -> None:
    """Fill the spectra of rows, summed in float64, by whichever way suits the part that is not zero."""
    if np.count_nonzero(rows) < MOST_SPARSE * rows.size:
        kernels.row_spectra(rows, waves, spectra)
        return
    used = waves[: rows.shape[1]].astype(np.float64)
    spectra[: len(rows), : used.shape[1]] = rows.astype(np.float64) @ used


def _folded(values: F32) -> tuple[F32, F32]:
    """Return the even and the odd part of rows about their middle, from there outward."""
    count = len(values)
    outer, mirror = values[count // 2 :], values[(count - 1) // 2 :: -1]
    even, odd = outer + mirror, outer - mirror
    if count % 2:
        even[0] = outer[0]
    return even, odd


def _distinct(rows: F32) -> tuple[F32, NDArray[np.int64]]:
    """Return the rows that differ by their bits, without dark ones, and (row, which of them) pairs."""
    seen: dict[bytes, int] = {}
    kept: list[int] = []
    pairs: list[tuple[int, int]] = []
    for row in np.flatnonzero(rows.any(axis=1)).tolist():
        key = rows[row].tobytes()
        if key not in seen:
            seen[key] = len(seen)
            kept.append(row)
        pairs.append((row, seen[key]))
    return rows[kept], np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _whole(count: int, step: int) -> int:
    return -(-count // step) * step


def _turns(turns: NDArray[np.float64]) -> F32:
    """Return the real and the imaginary part of exp(−i2π turns), whole turns taken off in float64."""
    phase = (-2 * np.pi * (turns - np.rint(turns))).astype(np.float32)
    return np.stack([np.cos(phase), np.sin(phase)])
