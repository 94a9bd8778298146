"""A field of one aperture after another, each from the one before: what the far and the near field share.

Where two masks differ is found by their bits. The change's own field is added to a running one, whose
rounding is bounded; before it gathers, the whole mask is transformed afresh.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction import _kernels_progressive as kernels
from aureole.diffraction.far import check_grid
from aureole.diffraction.quadtree import Quads, difference_quads
from aureole.records import Aperture, Field, Grid

F32 = NDArray[np.float32]

# How far the running field may stray by the bound of its rounding, of its largest value, before a fresh
# start.
MOST_DRIFT = 3e-5
# Rounding of one update in units of float32's: of the running sum, and of the change's transform.
ROUNDING_OF_SUM, ROUNDING_OF_CHANGE = 0.5, 4.0
EPSILON = float(np.finfo(np.float32).eps)


@dataclass(frozen=True, eq=False)
class Change:
    """Where two masks differ: the difference within a box of pixels, and where the box begins.

    Parameters
    ----------
    values : ndarray of float32, shape (H, W)
        The later mask less the earlier one.
    top, left : int
        Row and column of the first.
    """

    values: F32
    top: int
    left: int


class ProgressiveField(ABC):
    """A running field, and its power, of one aperture after another.

    Parameters
    ----------
    grid : Grid
        Where the field is wanted; any spacing, any centre, odd and even sizes.
    raster_size : int
        Pixels a side to which outlines are rasterized, unless the first aperture is a raster: then
        its size holds.
    whole : str
        What computes such a field at once, for refusals.

    Raises
    ------
    refuse.Refusal
        Where the grid or the size does not fit.
    """

    def __init__(self, grid: Grid, raster_size: int, whole: str) -> None:
        check_grid(grid)
        self._grid = grid
        self._size = refuse.at_least("raster_size", raster_size, 1)
        self._whole = whole
        self._width: float | None = None
        self._field = np.zeros(grid.shape, dtype=np.complex64)
        self._power = np.zeros(grid.shape, dtype=np.float32)
        self._change: Change | None = None
        self._evaluated: tuple[int, int] | None = None
        self._refreshed = False

    @abstractmethod
    def _prepare(self) -> None:
        """Prepare tables for the width and the size of the first aperture."""

    @abstractmethod
    def _add(self, change: Change) -> None:
        """Add a change's field to the running one, and square the sum."""

    @abstractmethod
    def _largest(self, total: float) -> float:
        """Return what the field of pixels that add up to so much is at its largest, about."""

    def update(self, aperture: Aperture) -> Field:
        """Return the field of the next aperture.

        Parameters
        ----------
        aperture : Aperture
            Outlines or a raster, of the width and the pixels of the first one.

        Returns
        -------
        Field
            Complex64. Its array is the running one, not to be written: the next
            update changes it, so copy what is to be kept.

        Raises
        ------
        refuse.Refusal
            Where the width or the mask's size differs from the first aperture's, the mask is not
            finite, or there is a wavefront; the running field stays as it was.
        """
        mask = self._mask_of(aperture)
        change = changed(self._mask, mask)
        if change is not None and not np.isfinite(change.values).all():
            raise refuse.Refusal("'mask' must be finite, got NaN or infinity.")
        self._change, self._evaluated, self._refreshed = change, None, False
        if change is not None:
            self._take(change, mask)
        return Field(_read_only(self._field), self._grid)

    def power(self) -> F32:
        """Return the squared modulus of the last aperture's field.

        Returns
        -------
        ndarray of float32, shape (rows, columns)
            The running array, which the next update changes.
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
                f"{type(self).__name__} takes real transmittances and this aperture has a wavefront; use "
                f"'{self._whole}', which takes a wavelength."
            )
        if self._width is None:
            self._begin(aperture)
        if aperture.width != self._width:
            raise refuse.Refusal(
                f"'aperture' must be {self._width:g} m wide as the first one, got {aperture.width:g} m; "
                f"begin another {type(self).__name__} for another width."
            )
        if aperture.mask is None:
            return apertures.rasterize(aperture, self._size)
        if aperture.mask.shape != self._mask.shape:
            rows, columns = aperture.mask.shape
            raise refuse.Refusal(
                f"'aperture' must have {self._size} x {self._size} pixels as the first one, "
                f"got {rows} x {columns}; begin another {type(self).__name__} for another size."
            )
        return np.ascontiguousarray(aperture.mask, dtype=np.float32)

    def _begin(self, aperture: Aperture) -> None:
        """Take width and size from the first aperture; nothing lets light through yet."""
        self._width = refuse.positive("aperture width", aperture.width)
        if aperture.mask is not None:
            self._size = len(aperture.mask)
        self._pixel = self._width / self._size
        self._mask = np.zeros((self._size, self._size), dtype=np.float32)
        self._area = self._error = 0.0
        self._prepare()

    def _take(self, change: Change, mask: F32) -> None:
        """Add a change, or begin afresh where rounding has gathered."""
        self._area += float(change.values.sum(dtype=np.float64))
        moved = float(np.abs(change.values).sum(dtype=np.float64))
        whole, part = self._largest(self._area), self._largest(moved)
        self._error += EPSILON * (ROUNDING_OF_SUM * whole + ROUNDING_OF_CHANGE * part)
        if self._error <= MOST_DRIFT * whole:
            rows = np.s_[change.top : change.top + len(change.values)]
            self._mask[rows] = mask[rows]
            self._add(change)
            return
        self._refreshed = True
        self._mask[:] = 0
        self._field[:] = 0
        self._power[:] = 0
        everything = changed(self._mask, mask)
        self._mask[:] = mask
        self._area = float(mask.sum(dtype=np.float64))
        self._error = EPSILON * ROUNDING_OF_CHANGE * self._largest(self._area)
        if everything is not None:
            self._add(everything)


def changed(old: F32, new: F32) -> Change | None:
    """Return the difference of two masks within the box where their bits differ.

    Parameters
    ----------
    old, new : ndarray of float32, shape (n, n)
        Masks.

    Returns
    -------
    Change or None
        None where they are alike.
    """
    size = len(old)
    first, last = np.empty(size, dtype=np.int64), np.empty(size, dtype=np.int64)
    kernels.changed_columns(old.view(np.int32), new.view(np.int32), first, last)
    rows = np.flatnonzero(last)
    if not len(rows):
        return None
    top, bottom, left, right = int(rows[0]), int(rows[-1]) + 1, int(first.min()), int(last.max())
    box = np.s_[top:bottom, left:right]
    return Change(new[box] - old[box], top, left)


def _read_only(array: Any) -> Any:
    view = array.view()
    view.flags.writeable = False
    return view
