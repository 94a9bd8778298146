"""Weighed sums of the powers of many openings, by several methods.

transforms   a transform each: what the others are held against
modes        few transforms, of the openings' mean and of their principal components, to a tolerance
progressive  each opening from the one before, by the change alone (quad paper §4.3)
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from aureole import diffraction, refuse
from aureole.glare.coherent_modes import coherent_modes
from aureole.records import Aperture, Grid

F32 = NDArray[np.float32]

# Bytes of masks whose modes are taken together, and the fewest masks.
MOST_BYTES, FEWEST = 2**29, 16
# Fewer openings than these are transformed one by one by "auto".
FEW = 6


class TransformSum:
    """The weighed sum of the powers of openings, each transformed by itself.

    Parameters
    ----------
    grid : Grid
        Frequencies in cycles per metre.

    Attributes
    ----------
    transforms : int
        Openings transformed so far.
    estimated : float
        0: nothing is.

    Raises
    ------
    refuse.Refusal
        Where the grid does not fit.
    """

    estimated = 0.0

    def __init__(self, grid: Grid) -> None:
        diffraction.check_grid(grid)
        self._grid = grid
        self._total = np.zeros(grid.shape, dtype=np.float32)
        self.transforms = 0

    def add(self, opening: Aperture, weight: float) -> None:
        """Add an opening's power.

        Parameters
        ----------
        opening : Aperture
            A raster without a wavefront.
        weight : float
            Of its power.
        """
        _check(opening)
        power = diffraction.far_power(opening, self._grid)
        power *= np.float32(weight)
        self._total += power
        self.transforms += 1

    def result(self) -> F32:
        """Return the sum so far.

        Returns
        -------
        ndarray of float32, shape (rows, columns)
            A copy.
        """
        return self._total.copy()


class ModeSum:
    """The weighed sum of the powers of openings, by their mean and their principal components.

    Openings are held until there are many: half a gigabyte of them.

    Parameters
    ----------
    grid : Grid
        Frequencies in cycles per metre.
    tolerance : float
        Share of the light whose spread may be estimated by sums with random signs, 0..1; see
        `coherent_modes`.

    Attributes
    ----------
    transforms : int
        Transforms so far.
    estimated : float
        Share of the light so far whose spread was estimated: the sum's mean absolute difference from
        that of all powers is at most this part of it.

    Raises
    ------
    refuse.Refusal
        Where the grid or the tolerance does not fit.
    """

    def __init__(self, grid: Grid, tolerance: float) -> None:
        self._tolerance = refuse.between("tolerance", tolerance, 0.0, 1.0)
        self._sum = TransformSum(grid)
        self._masks: list[F32] = []
        self._weights: list[float] = []
        self._width = 0.0
        self._light = self._guessed = 0.0

    @property
    def transforms(self) -> int:
        """Transforms so far."""
        return self._sum.transforms

    @property
    def estimated(self) -> float:
        """Share of the light so far whose spread was estimated."""
        return self._guessed / self._light if self._light > 0 else 0.0

    def add(self, opening: Aperture, weight: float) -> None:
        """Add an opening's power.

        Parameters
        ----------
        opening : Aperture
            A raster without a wavefront, of one width and size with the others.
        weight : float
            Of its power; without a weight nothing is added.
        """
        _check(opening)
        assert opening.mask is not None
        if weight <= 0:
            return
        self._width = opening.width
        self._masks.append(np.ascontiguousarray(opening.mask, dtype=np.float32))
        self._weights.append(weight)
        if len(self._masks) >= max(FEWEST, MOST_BYTES // opening.mask.nbytes):
            self._settle()

    def result(self) -> F32:
        """Return the sum so far.

        Returns
        -------
        ndarray of float32, shape (rows, columns)
            A copy.
        """
        self._settle()
        return self._sum.result()

    def _settle(self) -> None:
        """Transform what is held."""
        if not self._masks:
            return
        found = coherent_modes(self._masks, np.array(self._weights), self._tolerance)
        self._masks, self._weights = [], []
        light = float(np.einsum("mij,mij->", found.patterns, found.patterns, dtype=np.float64))
        self._light += light
        self._guessed += light * found.estimated
        for pattern in found.patterns:
            self._sum.add(Aperture(self._width, mask=pattern), 1.0)


class PowerSum:
    """The weighed sum of the powers of openings that differ little from one to the next.

    Parameters
    ----------
    grid : Grid
        Frequencies in cycles per metre.
    size : int
        Pixels a side of the openings.

    Attributes
    ----------
    transforms : int
        Updates so far.
    estimated : float
        0: nothing is.

    Raises
    ------
    refuse.Refusal
        Where the grid or the size does not fit.
    """

    estimated = 0.0

    def __init__(self, grid: Grid, size: int) -> None:
        self._running = diffraction.ProgressiveFarField(grid, size)
        # On a grid about zero the upper half says all, but for the first column of even grids.
        rows, columns = grid.shape
        self._half = rows // 2 + 1 if grid.centre == (0.0, 0.0) else rows
        self._total = np.zeros(grid.shape, dtype=np.float32)
        self._lone = np.s_[self._half :, : 1 - columns % 2]
        self._last: F32 | None = None
        self._waiting = 0.0
        self.transforms = 0

    def add(self, opening: Aperture, weight: float) -> None:
        """Add an opening's power.

        Parameters
        ----------
        opening : Aperture
            A raster; one that is the very one before is not transformed again.
        weight : float
            Of its power.
        """
        assert opening.mask is not None
        if self._last is None or not np.array_equal(self._last, opening.mask):
            self._settle()
            self._running.update(opening)
            self._last = opening.mask
            self.transforms += 1
        self._waiting += weight

    def restart(self) -> None:
        """Begin another sum; what comes next is still transformed from what came last."""
        self._settle()
        self._total[...] = 0
        self.transforms = 0

    def result(self) -> F32:
        """Return the sum so far.

        Returns
        -------
        ndarray of float32, shape (rows, columns)
            A copy.
        """
        self._settle()
        out = self._total.copy()
        rows, columns = out.shape
        first = 1 - columns % 2
        lower = out[self._half :, first:]
        # Row r is the mirror image of row 2 (rows // 2) − r.
        lower[...] = out[2 * (rows // 2) - np.arange(self._half, rows)][:, first:][:, ::-1]
        return out

    def _settle(self) -> None:
        """Add the running power as often as it was asked for."""
        if self._waiting:
            power, weight = self._running.power(), np.float32(self._waiting)
            self._total[: self._half] += weight * power[: self._half]
            self._total[self._lone] += weight * power[self._lone]
        self._waiting = 0.0


Summing = TransformSum | ModeSum | PowerSum
METHODS: dict[str, Callable[[Grid, int, float], Summing]] = {
    "transforms": lambda grid, size, tolerance: TransformSum(grid),
    "modes": lambda grid, size, tolerance: ModeSum(grid, tolerance),
    "progressive": lambda grid, size, tolerance: PowerSum(grid, size),
}


def power_sum(method: str, grid: Grid, size: int, tolerance: float, count: int) -> Summing:
    """Begin a sum of powers.

    Parameters
    ----------
    method : str
        "transforms", "modes", "progressive", or "auto": modes unless openings are few.
    grid : Grid
        Frequencies in cycles per metre.
    size : int
        Pixels a side of the openings.
    tolerance : float
        For "modes", the share of the light whose spread may be estimated.
    count : int
        How many openings there will be.

    Returns
    -------
    TransformSum, ModeSum or PowerSum
        Without light yet.

    Raises
    ------
    refuse.Refusal
        Where a choice or a number does not fit.
    """
    name = refuse.one_of("method", method, ("auto", *METHODS))
    if name == "auto":
        name = "transforms" if count < FEW else "modes"
    return METHODS[name](grid, size, tolerance)


def _check(opening: Aperture) -> None:
    """Refuse what is no raster of real transmittances."""
    if opening.wavefront is not None:
        raise refuse.Refusal("sums of powers take real transmittances and this aperture has a wavefront.")
    if opening.mask is None:
        raise refuse.Refusal("sums of powers need rasters; rasterize the outlines first.")
