"""The near field of an aperture that changes: only the change is transformed (quad paper §4.3, §4.5).

Scandolo, Lee, Eisemann, "Quad-based Fourier transform for efficient diffraction synthesis", 2018. The
near field is linear in the mask, as the far field is: the difference of two masks has few distinct rows,
and steps at few edges of pixels, so that both the tables and the products are small.
"""

from functools import partial

import numpy as np

from aureole import refuse
from aureole.diffraction import _kernels_near
from aureole.diffraction.changes import Change, ProgressiveField
from aureole.diffraction.far import RASTER_SIZE
from aureole.diffraction.near_pixels import all_tiles, rows_parts, write_tiles
from aureole.records import Aperture, Grid


class ProgressiveNearField(ProgressiveField):
    """The near field of one aperture after another, each from the one before.

    The running field is complex64. A bound of its rounding is kept, and where it passes 3e-5 of the
    unblocked wave, after some fifty updates, the whole mask is transformed afresh. So any number of
    updates agrees with `near_field` to 1e-4.

    Parameters
    ----------
    grid : Grid
        Places on the plane in metres; any spacing, any centre, odd and even sizes. A grid centred on
        the axis takes a quarter of the products.
    distance, wavelength : float
        Metres.
    raster_size : int
        Pixels a side to which outlines are rasterized, unless the first aperture is a raster: then
        its size holds.

    Raises
    ------
    refuse.Refusal
        Where the grid, the distance, the wavelength or the size does not fit.
    """

    def __init__(
        self, grid: Grid, distance: float, wavelength: float, raster_size: int = RASTER_SIZE
    ) -> None:
        super().__init__(grid, raster_size, "near_field")
        self._distance = refuse.positive("distance", distance)
        self._wavelength = refuse.positive("wavelength", wavelength)

    def _prepare(self) -> None:
        """Prepare nothing: the tables hold the edges that a change has."""

    def _largest(self, total: float) -> float:
        # Far away the field is the area over λz, near by it is that of the unblocked wave.
        return min(1.0, self._pixel / self._wavelength * (self._pixel / self._distance) * total)

    def _add(self, change: Change) -> None:
        difference = np.zeros_like(self._mask)
        rows, columns = change.values.shape
        difference[change.top : change.top + rows, change.left : change.left + columns] = change.values
        shape = Aperture(self._pixel * self._size, mask=difference)
        parts = rows_parts(shape, self._grid, self._distance, self._wavelength)
        write = partial(_kernels_near.add_field, self._power)
        write_tiles(parts, self._grid, all_tiles(parts), write, self._field)
