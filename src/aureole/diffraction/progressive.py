"""The far field of an aperture that changes: only the change is transformed (quad paper §4.3).

Scandolo, Lee, Eisemann, "Quad-based Fourier transform for efficient diffraction synthesis", 2018. The
difference of two masks is few quads, positive and negative ones, and the transform is linear. The sum
over those quads is taken row by row of the difference: it is folded about its centre into even and
odd parts, which have half as many rows and real waves, and rows equal by their bits are taken once.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction import _kernels_progressive as kernels
from aureole.diffraction.far import RASTER_SIZE, check_grid
from aureole.diffraction.quadtree import Quads, difference_quads
from aureole.records import Aperture, Field, Grid

F32 = NDArray[np.float32]

# How far the running field may stray by the bound of its rounding, of the peak, before a fresh start.
MOST_DRIFT = 3e-5
# Rounding of one update in units of float32's: of the running sum, and of the change's transform.
ROUNDING_OF_SUM, ROUNDING_OF_CHANGE = 0.5, 4.0
# Above this part of values that are not zero, a dense product of the rows is faster.
MOST_SPARSE = 0.2
EPSILON = float(np.finfo(np.float32).eps)


@dataclass(frozen=True, eq=False)
class _Axis:
    """One axis's frequencies, and waves of pixels at distances from a centre, times the pixel's sinc.

    waves[parity] are cosines and sines (2, distances, frequencies), of the distances 0, 1, 2, … pixels
    for parity 1, and of 1/2, 3/2, … for parity 0.
    """

    frequencies: NDArray[np.float64]
    waves: tuple[F32, F32]


@dataclass(frozen=True, eq=False)
class _Change:
    """Where two masks differ: the difference within a box of pixels, and where the box begins."""

    values: F32
    top: int
    left: int


class ProgressiveFarField:
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
        check_grid(grid)
        self._grid = grid
        self._size = refuse.at_least("raster_size", raster_size, 1)
        self._width: float | None = None
        self._field = np.zeros(grid.shape, dtype=np.complex64)
        self._power = np.zeros(grid.shape, dtype=np.float32)
        self._change: _Change | None = None
        self._evaluated: tuple[int, int] | None = None
        self._refreshed = False

    def update(self, aperture: Aperture) -> Field:
        """Return the far field of the next aperture.

        Parameters
        ----------
        aperture : Aperture
            Outlines or a raster, of the width and the pixels of the first one.

        Returns
        -------
        Field
            F in square metres, complex64. Its array is the running one, not to be written: the next
            update changes it, so copy what is to be kept.

        Raises
        ------
        refuse.Refusal
            Where the width or the mask's size differs from the first aperture's, the mask is not
            finite, or there is a wavefront; the running field stays as it was.
        """
        mask = self._mask_of(aperture)
        change = _change(self._mask, mask)
        if change is not None and not np.isfinite(change.values).all():
            raise refuse.Refusal("'mask' must be finite, got NaN or infinity.")
        self._change, self._evaluated, self._refreshed = change, None, False
        if change is not None:
            self._take(change, mask)
        return Field(_read_only(self._field), self._grid)

    def power(self) -> F32:
        """Return |F|² of the last aperture.

        Returns
        -------
        ndarray of float32, shape (rows, columns)
            Metres to the fourth; the running array, which the next update changes.
        """
        power: F32 = _read_only(self._power)
        return power

    @property
    def evaluated(self) -> tuple[int, int]:
        """Quads of the last update, (positive, negative), each extracted on its own.

        They are counted when asked for: the update sums them by rows, and needs no list of them.
        """
        if self._evaluated is None:
            positive, negative = self.quads()
            self._evaluated = len(positive), len(negative)
        return self._evaluated

    @property
    def refreshed(self) -> bool:
        """Whether the last update transformed the whole mask afresh."""
        return self._refreshed

    def quads(self) -> tuple[Quads, Quads]:
        """Return the quads that the last update added and took away (quad paper §4.3).

        Returns
        -------
        tuple of Quads
            Of the positive part of the difference and of the negative one; the weights of the latter
            are those of its absolute value. Neighbours of one weight that are a rectangle together are
            merged across the tree's levels (§7).
        """
        if self._change is None or self._width is None:
            nothing = Quads(np.zeros((0, 4)), np.zeros(0))
            return nothing, nothing
        whole = np.zeros_like(self._mask)
        values, top, left = self._change.values, self._change.top, self._change.left
        whole[top : top + len(values), left : left + values.shape[1]] = values
        return difference_quads(whole, self._width)

    def _mask_of(self, aperture: Aperture) -> F32:
        """Return an aperture's pixels, refusing what does not fit the first one."""
        if aperture.wavefront is not None:
            raise refuse.Refusal(
                "ProgressiveFarField takes real transmittances and this aperture has a wavefront; use "
                "'far_field', which takes a wavelength."
            )
        if self._width is None:
            self._begin(aperture)
        if aperture.width != self._width:
            raise refuse.Refusal(
                f"'aperture' must be {self._width:g} m wide as the first one, got {aperture.width:g} m; "
                "begin another ProgressiveFarField for another width."
            )
        if aperture.mask is None:
            return apertures.rasterize(aperture, self._size)
        if aperture.mask.shape != self._mask.shape:
            rows, columns = aperture.mask.shape
            raise refuse.Refusal(
                f"'aperture' must have {self._size} x {self._size} pixels as the first one, "
                f"got {rows} x {columns}; begin another ProgressiveFarField for another size."
            )
        return np.ascontiguousarray(aperture.mask, dtype=np.float32)

    def _begin(self, aperture: Aperture) -> None:
        """Take width and size from the first aperture and prepare the waves; nothing lets light through."""
        self._width = refuse.positive("aperture width", aperture.width)
        if aperture.mask is not None:
            self._size = len(aperture.mask)
        self._pixel = self._width / self._size
        self._mask = np.zeros((self._size, self._size), dtype=np.float32)
        self._area = self._error = 0.0
        self._mirrored = self._grid.centre == (0.0, 0.0)
        y, x = self._grid.axes()
        if self._mirrored:
            # The frequencies that are not negative, and at even sizes the mirror image of the first.
            y, x = np.unique(np.abs(y)), np.unique(np.abs(x))
        self._rows = _axis(y, self._size, self._pixel)
        self._columns = self._rows if np.array_equal(x, y) else _axis(x, self._size, self._pixel)

    def _take(self, change: _Change, mask: F32) -> None:
        """Add a change, or begin afresh where rounding has gathered."""
        self._area += float(change.values.sum(dtype=np.float64))
        moved = float(np.abs(change.values).sum(dtype=np.float64))
        self._error += EPSILON * (ROUNDING_OF_SUM * self._area + ROUNDING_OF_CHANGE * moved)
        part = np.s_[change.top : change.top + len(change.values)]
        if self._error <= MOST_DRIFT * self._area:
            self._mask[part] = mask[part]
            self._add(change)
            return
        self._refreshed = True
        self._mask[:] = 0
        self._field[:] = 0
        self._power[:] = 0
        whole = _change(self._mask, mask)
        self._mask[:] = mask
        self._area = float(mask.sum(dtype=np.float64))
        self._error = EPSILON * ROUNDING_OF_CHANGE * self._area
        if whole is not None:
            self._add(whole)

    def _add(self, change: _Change) -> None:
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


def _change(old: F32, new: F32) -> _Change | None:
    """Return the difference of two masks within the box where their bits differ, or None."""
    size = len(old)
    first, last = np.empty(size, dtype=np.int64), np.empty(size, dtype=np.int64)
    kernels.changed_columns(old.view(np.int32), new.view(np.int32), first, last)
    rows = np.flatnonzero(last)
    if not len(rows):
        return None
    top, bottom, left, right = int(rows[0]), int(rows[-1]) + 1, int(first.min()), int(last.max())
    box = np.s_[top:bottom, left:right]
    return _Change(new[box] - old[box], top, left)


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


def _read_only(array: Any) -> Any:
    view = array.view()
    view.flags.writeable = False
    return view
