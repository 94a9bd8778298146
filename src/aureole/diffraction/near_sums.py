"""Powers of many wavelengths behind one aperture, added up in X, Y and Z.

For a mask's distinct rows what does not depend on the wavelength is found once: where its lines step and
where each of them stands. |D|² goes into the sum tile by tile, without D being stored, and where the plane
is centred on the axis only a quarter of it is computed, and unfolded at the end. So it is for straight-edged
outlines that are their own mirror image; there many wavelengths share the amplitudes of the corners' waves.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole.diffraction import _kernels_near_colour, near_pixels
from aureole.diffraction.near import NearOperator
from aureole.diffraction.near_polygons import StraightRings
from aureole.diffraction.rows import STEPS_APART, Factor, sides

# Rows of a matrix that is mostly zero: where each starts, and place and weight of each entry.
Sparse = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float32]]


def sum_for(operator: NearOperator) -> "PlaneSum | RowsSum | EdgesSum":
    """Return the sum that takes the least time.

    Parameters
    ----------
    operator : NearOperator
        The aperture and the plane.

    Returns
    -------
    PlaneSum, RowsSum or EdgesSum
        Empty.
    """
    rings = operator.aperture.outlines
    if operator.method == "polygons" and rings and not any(np.any(ring.bulges) for ring in rings):
        return EdgesSum(operator)
    of_rows = operator.method == "rows" and operator.aperture.wavefront is None
    return RowsSum(operator) if of_rows else PlaneSum(operator)


class PlaneSum:
    """A sum on the whole plane, of powers however they are found.

    Parameters
    ----------
    operator : NearOperator
        The aperture and the plane.
    """

    at_once = 1

    def __init__(self, operator: NearOperator) -> None:
        self._operator = operator
        self._total = np.zeros((*operator.grid.shape, 3), dtype=np.float32)

    def add(self, distance: float, wavelengths: NDArray[np.float64], weights: NDArray[np.float64]) -> None:
        """Add some wavelengths, `at_once` at most.

        Parameters
        ----------
        distance : float
            Metres.
        wavelengths : ndarray of float64, shape (W,)
            Metres.
        weights : ndarray of float64, shape (W, 3)
            For X, Y and Z.
        """
        for wavelength, weight in zip(wavelengths.tolist(), weights, strict=True):
            power = self._operator.power(distance, wavelength).astype(np.float32, copy=False)
            _kernels_near_colour.add_plane(power, weight.astype(np.float32), self._total)

    def pixels(self) -> NDArray[np.float32]:
        """Return the sum so far.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 3)
            X, Y, Z.
        """
        return self._total


class RowsSum:
    """A sum where the even and odd parts of a mask are computed, from its distinct rows.

    Parameters
    ----------
    operator : NearOperator
        A raster without a wavefront and the plane, method "rows".
    """

    at_once = 1

    def __init__(self, operator: NearOperator) -> None:
        self._grid = operator.grid
        self._factors: list[Factor] = operator.prepared["factors"]
        self._axes = near_pixels.MaskAxes(operator.aperture, operator.grid, self._factors)
        self._sparse = [_steps_of(each) for each in self._factors]
        # What lies left of the axis differs from what lies right where there is an odd part along x.
        halves = [
            2 if centre == 0 and any(each.odd[axis] for each in self._factors) else 1
            for axis, centre in enumerate(operator.grid.centre)
        ]
        rows, columns = (len(places) for places in self._axes.places)
        self._total = np.zeros((*halves, rows, 3, columns), dtype=np.float32)

    def add(self, distance: float, wavelengths: NDArray[np.float64], weights: NDArray[np.float64]) -> None:
        """Add some wavelengths, `at_once` at most.

        Parameters
        ----------
        distance : float
            Metres.
        wavelengths : ndarray of float64, shape (W,)
            Metres.
        weights : ndarray of float64, shape (W, 3)
            For X, Y and Z.
        """
        for wavelength, weight in zip(wavelengths.tolist(), weights, strict=True):
            self._add(distance, wavelength, weight)

    def _add(self, distance: float, wavelength: float, weight: NDArray[np.float64]) -> None:
        tables = self._axes.tables(distance, wavelength)
        parts = [
            (2 * each.odd[0] + each.odd[1], *_sides(each, sparse, tables))
            for each, sparse in zip(self._factors, self._sparse, strict=True)
        ]
        quarter = (0.25 * weight).astype(np.float32)

        def add(products: Any, present: Any, corner: Any, _: Any, total: NDArray[np.float32]) -> None:
            _kernels_near_colour.add_tile(products, present, corner, quarter, total)

        near_pixels.write_tiles(parts, self._grid, near_pixels.all_tiles(parts), add, self._total)

    def pixels(self) -> NDArray[np.float32]:
        """Return the sum so far.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 3)
            X, Y, Z.
        """
        out = np.empty((*self._grid.shape, 3), dtype=np.float32)
        _kernels_near_colour.unfold_colour(self._total, near_pixels.middle_of(self._grid), out)
        return out


class EdgesSum:
    """A sum on the part of the plane that the symmetry of straight-edged outlines leaves.

    Parameters
    ----------
    operator : NearOperator
        Outlines without arcs and the plane, method "polygons".
    """

    def __init__(self, operator: NearOperator) -> None:
        self._grid = operator.grid
        self._rings = StraightRings(list(operator.aperture.outlines), operator.grid)
        self.at_once = self._rings.at_once()
        rows, columns = self._rings.shape
        self._total = np.zeros((rows, 3, columns), dtype=np.float32)

    def add(self, distance: float, wavelengths: NDArray[np.float64], weights: NDArray[np.float64]) -> None:
        """Add some wavelengths, `at_once` at most.

        Parameters
        ----------
        distance : float
            Metres.
        wavelengths : ndarray of float64, shape (W,)
            Metres.
        weights : ndarray of float64, shape (W, 3)
            For X, Y and Z.
        """
        scales = [near_pixels.scale_of(distance, wavelength) for wavelength in wavelengths.tolist()]
        self._rings.add_powers(np.array(scales), weights, self._total)

    def pixels(self) -> NDArray[np.float32]:
        """Return the sum so far.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 3)
            X, Y, Z.
        """
        out = np.empty((*self._grid.shape, 3), dtype=np.float32)
        _kernels_near_colour.unfold_colour(self._total[None, None], self._rings.middle, out)
        return out


def _steps_of(each: Factor) -> tuple[Sparse, Sparse] | None:
    """Return the steps of a part's lines and those of the sets of places where they stand, if few."""
    steps = each.lines.copy()
    steps[:, :-1] -= each.lines[:, 1:]
    row, place = np.nonzero(steps)
    if len(row) * STEPS_APART > steps.size:
        return None
    count = len(each.lines)
    lines = _sparse(count, row, place, steps[row, place])
    # A run of places counts from the edge after its last to the edge before its first.
    labels = each.labels
    last = np.flatnonzero((labels >= 0) & (np.append(labels[1:], -1) != labels))
    first = np.flatnonzero((labels[1:] >= 0) & (labels[1:] != labels[:-1]))
    rows, places = np.append(labels[last], labels[first + 1]), np.append(last, first)
    weights = np.append(np.ones(len(last), np.float32), np.full(len(first), -1, np.float32))
    return lines, _sparse(count, rows, places, weights)


def _sparse(
    count: int, row: NDArray[np.int64], place: NDArray[np.int64], weight: NDArray[np.float32]
) -> Sparse:
    order = np.argsort(row, kind="stable")
    return np.searchsorted(row[order], np.arange(count + 1)), place[order], weight[order]


def _sides(
    each: Factor,
    sparse: tuple[Sparse, Sparse] | None,
    tables: tuple[NDArray[np.float32], NDArray[np.float32]],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the two sides of a part, along y and along x."""
    along_y, along_x = (table[odd] for table, odd in zip(tables, each.odd, strict=True))
    if sparse is None:
        return sides(each, along_y, along_x)
    lines, places = sparse if each.by_rows else sparse[::-1]
    return _times(places, along_y), _times(lines, along_x)


def _times(sparse: Sparse, table: NDArray[np.float32]) -> NDArray[np.float32]:
    out = np.empty((len(sparse[0]) - 1, table.shape[1]), dtype=np.float32)
    _kernels_near_colour.sparse_product(*sparse, table, out)
    return out
