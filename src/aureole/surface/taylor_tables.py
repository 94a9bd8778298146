"""Dhillon's tables of a height field: one for each power of w, so that one set serves all directions.

S_d(h) = Σ_p w^p I_p(h) with w = cos θ_i + cos θ_o and I_p = Σ_{n + m = p} k^p / (n! m!) Re(F_n F_m*), F_n the
transform of (i z)ⁿ: 2N + 1 tables for a Taylor series of order N (Dhillon et al. 2014).
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from aureole import light, refuse
from aureole.records import Spectrum, Stage
from aureole.surface.height import COHERENCE, HIGHEST_ORDER, HeightField, phases
from aureole.surface.height_tables import as_field, height_axes, reaching, series_facts
from aureole.surface.order_sums import add_lobes, lobes
from aureole.surface.table import HALF_RANGE, WARP, ScatterTable, bilinear, refuse_too_large, scatter_table

# Where k is 1 / this in the powers of k, so that these stay near 1.
MIDDLE = 550e-9

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TaylorTables:
    """Tables of the powers of w = cos θ_i + cos θ_o: S_d(h) = Σ_p w^p I_p(h) (Dhillon et al. 2014).

    Parameters
    ----------
    values : ndarray of float64, shape (2N + 1, rows, columns, 3)
        I_p in X, Y, Z; of both signs.
    order : int
        N, the last power of the series.
    table : ScatterTable
        Their sum at w = 2, with the axes and the light of all.
    """

    values: Array
    order: int
    table: ScatterTable

    def at(self, cosines: float) -> Array:
        """Return S_d for one sum of cosines.

        Parameters
        ----------
        cosines : float
            w = cos θ_i + cos θ_o, 0 to 2.

        Returns
        -------
        ndarray of float64, shape (rows, columns, 3)
            X, Y, Z.
        """
        powers = refuse.between("cosines", cosines, 0.0, 2.0) ** np.arange(len(self.values))
        return np.asarray(np.tensordot(powers, self.values, axes=1))

    def table_at(self, cosines: float) -> ScatterTable:
        """Return the look-up table for one sum of cosines.

        Parameters
        ----------
        cosines : float
            w = cos θ_i + cos θ_o, 0 to 2.

        Returns
        -------
        ScatterTable
            With axes, light and notes as at w = 2, for any renderer.
        """
        kept, metadata = self.table, {**self.table.metadata, "cosines": float(cosines)}
        values = np.maximum(self.at(cosines), 0.0)
        rest = (kept.half_range, kept.warp, kept.illuminant, kept.model, kept.zero_order, metadata)
        return scatter_table(values, kept.white, *rest)

    def lookup(self, h_t: ArrayLike, h_b: ArrayLike, cosines: ArrayLike) -> Array:
        """Read the tables at any h and any w, as a shader does: a look-up for each power of w.

        Parameters
        ----------
        h_t, h_b : array_like
            Components of h = ω_i + ω_o along tangent and bitangent.
        cosines : array_like
            cos θ_i + cos θ_o of the same directions; the three shapes broadcast.

        Returns
        -------
        ndarray of float64, shape (..., 3)
            X, Y, Z of S_d; zero outside the tables.
        """
        t, b, w = np.broadcast_arrays(*(np.asarray(given, dtype=np.float64) for given in (h_t, h_b, cosines)))
        total = np.zeros((*t.shape, 3))
        # Horner's rule, from the highest power of w.
        for plane in self.values[::-1]:
            total = total * w[..., None] + bilinear(plane, t, b, self.table.half_range, self.table.warp)
        return total


def taylor_tables(
    heights: HeightField | ArrayLike,
    pixel: float | None = None,
    order: int = 1,
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = 256,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    wavelengths: int | None = None,
    coherence: float = COHERENCE,
) -> TaylorTables:
    """Make Dhillon's tables: one for each power of w, so that one set serves all directions.

    Parameters
    ----------
    heights, pixel : see there
        As for `table_from_height`.
    order : int
        N, the last power of the series.
    spectrum, size, half_range, warp, wavelengths, coherence : see there
        As for `table_from_height`.

    Returns
    -------
    TaylorTables
        2N + 1 tables.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described, or the tables would not fit in memory.
    """
    for stage in taylor_tables_stages(
        heights, pixel, order, spectrum, size, half_range, warp, wavelengths, coherence
    ):
        last = stage
    tables: TaylorTables = last.result
    return tables


def taylor_tables_stages(
    heights: HeightField | ArrayLike,
    pixel: float | None = None,
    order: int = 1,
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = 256,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    wavelengths: int | None = None,
    coherence: float = COHERENCE,
) -> Iterator[Stage]:
    """Do what `taylor_tables` does, with a stage after every few rows.

    Parameters
    ----------
    heights, pixel, order, spectrum, size, half_range, warp, wavelengths, coherence : see there
        As for `taylor_tables`.

    Yields
    ------
    Stage
        The last one holds the tables.
    """
    field = as_field(heights, pixel)
    count = 2 * int(refuse.between("order", refuse.at_least("order", order, 1), 1, HIGHEST_ORDER)) + 1
    lamp, quadrature, t, b = height_axes(spectrum, size, half_range, warp, wavelengths, coherence)
    refuse_too_large("size", (b.shape[1], t.shape[1]), 24 * (count + 2))
    refuse_too_large("heights", field.heights.shape, 32 * count)
    yield Stage(0.0, "transforming heights")
    powers, frequencies = reaching(_terms(field, order), field.pixel, quadrature[0], (t, b), coherence)
    where = lobes(frequencies, quadrature[0], (t, b), coherence)
    planes = np.zeros((count, 3, b.shape[1], t.shape[1]))
    wanted = np.zeros(quadrature[0].size, np.int64)
    for power in range(count):
        weights = quadrature[1] * (MIDDLE / quadrature[0][:, None]) ** power
        for done in add_lobes(powers[power : power + 1], wanted, weights, where, planes[power]):
            yield Stage(0.95 * (power + done) / count, f"adding wavelengths of table {power + 1} of {count}")
    values = np.moveaxis(planes, 1, -1)
    yield Stage(0.95, "judging the series")
    metadata: dict[str, Any] = {"heights": field.name, "method": "taylor", "wavelengths": quadrature[0].size}
    metadata |= series_facts(field, float(quadrature[0].min()), "taylor", order, 2.0)
    whole = np.tensordot(2.0 ** np.arange(count), values, axes=1)
    rest = (half_range, warp, lamp.name, "function", "keep", metadata)
    table = scatter_table(np.maximum(whole, 0.0), light.white(lamp), *rest)
    yield Stage(1.0, "tables", TaylorTables(values, order, table))


def _terms(field: HeightField, order: int) -> Array:
    """Return I_p over the orders for p from 0 to 2N, at the middle wavelength."""
    phase = phases(field, MIDDLE, 1.0)
    transforms = [fft.fft2((1j * phase) ** n / math.factorial(n), norm="forward") for n in range(order + 1)]
    terms = np.zeros((2 * order + 1, *phase.shape))
    for n, one in enumerate(transforms):
        for m, other in enumerate(transforms):
            terms[n + m] += (one * other.conj()).real
    return terms
