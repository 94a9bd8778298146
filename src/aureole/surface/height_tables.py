"""From a height field to a look-up table, and to Dhillon's tables of a Taylor series.

Each wavelength has its own orders and its own pattern, so nothing is extrapolated from one wavelength to
another. A series that is too short for the heights is told in the table's notes.
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
from aureole.surface.grating_tables import needed_wavelengths
from aureole.surface.height import (
    COHERENCE,
    HIGHEST_ORDER,
    METHODS,
    TOLERANCE,
    HeightField,
    height_field,
    order_powers,
    phases,
    spread_orders,
    taylor_error,
    taylor_order,
)
from aureole.surface.integrate import as_spectrum, checked_size
from aureole.surface.pattern import DiffractionPattern, diffraction_pattern
from aureole.surface.table import (
    HALF_RANGE,
    WARP,
    ZERO_ORDERS,
    ScatterTable,
    cells,
    checked_half_range,
    checked_warp,
    scatter_table,
)

HEIGHT_SIZE = 1024

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


def height_pattern(
    heights: HeightField | ArrayLike,
    pixel: float | None = None,
    wavelength: float = 550e-9,
    size: int = 513,
    half_range: float = HALF_RANGE,
    method: str = "exact",
    order: int = 1,
    cosines: float = 2.0,
    coherence: float = COHERENCE,
) -> DiffractionPattern:
    """Return a height field's pattern at one wavelength.

    Parameters
    ----------
    heights : HeightField or array_like
        Metres.
    pixel : float or None
        Metres; None where the field knows it.
    wavelength : float
        Metres.
    size : int
        Rows and columns; each value is the mean over its cell.
    half_range : float
        h of the outermost samples.
    method, order, cosines, coherence : see there
        As for `table_from_height`.

    Returns
    -------
    DiffractionPattern
        1/sr.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    field = _field(heights, pixel)
    rows, columns = checked_size(size)
    refuse.positive("coherence", coherence)
    powers = order_powers(field, wavelength, method, order, cosines)
    t, b = cells(columns, half_range, 1), cells(rows, half_range, 1)[:, ::-1]
    values = spread_orders(powers, field.pixel, wavelength, t, b, coherence)
    return diffraction_pattern(values, half_range, wavelength, field.name)


def table_from_height(
    heights: HeightField | ArrayLike,
    pixel: float | None = None,
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = HEIGHT_SIZE,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    wavelengths: int | None = None,
    method: str = "exact",
    order: int = 1,
    zero_order: str = "keep",
    cosines: float = 2.0,
    coherence: float = COHERENCE,
) -> ScatterTable:
    """Make the look-up table of a height field under a light.

    Parameters
    ----------
    heights : HeightField or array_like, shape (rows, columns)
        Metres, one period of a field that repeats itself; row 0 is the uppermost.
    pixel : float or None
        From sample to sample, metres; None where the field knows it.
    spectrum : Spectrum or str
        The light, or an illuminant's name.
    size : int or tuple of int
        Samples of the table, or its (rows, columns).
    half_range : float
        h of the table's outermost samples, at most 2.
    warp : int
        n of h = half_range · uⁿ, odd.
    wavelengths : int or None
        Number of wavelengths; None for as many as sharp orders need.
    method : {"exact", "born", "taylor", "amplitude"}
        What stands for exp(i k w z); see `aureole.surface.height`.
    order : int
        The last power of the series, for "taylor".
    zero_order : {"keep", "remove", "specular"}
        "remove" and "specular" leave out the order at h = 0; "specular" says in the metadata how much light
        that was, for an ordinary lobe to render.
    cosines : float
        w = cos θ_i + cos θ_o that the table is for: 2 at normal incidence.
    coherence : float
        Length over which the light is in phase, metres.

    Returns
    -------
    ScatterTable
        In XYZ; its metadata has "notes" where a series is too short for the heights.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    for stage in table_from_height_stages(
        heights,
        pixel,
        spectrum,
        size,
        half_range,
        warp,
        wavelengths,
        method,
        order,
        zero_order,
        cosines,
        coherence,
    ):
        last = stage
    table: ScatterTable = last.result
    return table


def table_from_height_stages(
    heights: HeightField | ArrayLike,
    pixel: float | None = None,
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = HEIGHT_SIZE,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    wavelengths: int | None = None,
    method: str = "exact",
    order: int = 1,
    zero_order: str = "keep",
    cosines: float = 2.0,
    coherence: float = COHERENCE,
) -> Iterator[Stage]:
    """Do what `table_from_height` does, with a stage after each wavelength.

    Parameters
    ----------
    heights, pixel, spectrum, size, half_range, warp, wavelengths : see there
        As for `table_from_height`.
    method, order, zero_order, cosines : see there
        As for `table_from_height`.
    coherence : float
        As for `table_from_height`.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    field = _field(heights, pixel)
    refuse.one_of("method", method, METHODS)
    refuse.one_of("zero_order", zero_order, ZERO_ORDERS)
    lamp, quadrature, t, b = _axes(spectrum, size, half_range, warp, wavelengths, coherence)
    refuse.between("cosines", cosines, 0.0, 2.0)
    planes = np.zeros((3, b.shape[1], t.shape[1]))
    specular = np.zeros(3)
    for index, (wavelength, weight) in enumerate(zip(*quadrature, strict=True)):
        yield Stage(index / quadrature[0].size, "adding wavelengths")
        powers = order_powers(field, float(wavelength), method, order, cosines)
        specular += powers[0, 0] * weight
        if zero_order != "keep":
            powers[0, 0] = 0.0
        pattern = spread_orders(powers, field.pixel, float(wavelength), t, b, coherence)
        for channel in range(3):
            planes[channel] += weight[channel] * pattern
    metadata: dict[str, Any] = {"heights": field.name, "method": method, "wavelengths": quadrature[0].size}
    if zero_order == "specular":
        metadata["zero_order_energy"] = tuple(float(part) for part in specular)
    metadata |= _series_facts(field, float(quadrature[0].min()), method, order, cosines)
    values, white = np.moveaxis(planes, 0, -1), light.white(lamp)
    table = scatter_table(values, white, half_range, warp, lamp.name, "function", zero_order, metadata)
    yield Stage(1.0, "table", table)


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

    I_p = Σ_{n + m = p} k^p / (n! m!) Re(F_n F_m*) with F_n the transform of (i z)ⁿ: 2N + 1 tables of order N.

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
        Where an input is not as described.
    """
    field = _field(heights, pixel)
    refuse.between("order", refuse.at_least("order", order, 1), 1, HIGHEST_ORDER)
    lamp, quadrature, t, b = _axes(spectrum, size, half_range, warp, wavelengths, coherence)
    values = np.zeros((2 * order + 1, b.shape[1], t.shape[1], 3))
    for wavelength, weight in zip(*quadrature, strict=True):
        for power, terms in enumerate(_series_terms(field, float(wavelength), order)):
            pattern = spread_orders(terms, field.pixel, float(wavelength), t, b, coherence)
            values[power] += pattern[..., None] * weight
    metadata = {"heights": field.name, "method": "taylor", "wavelengths": quadrature[0].size}
    metadata |= _series_facts(field, float(quadrature[0].min()), "taylor", order, 2.0)
    whole = np.tensordot(2.0 ** np.arange(2 * order + 1), values, axes=1)
    white = light.white(lamp)
    table = scatter_table(whole, white, half_range, warp, lamp.name, "function", "keep", metadata)
    return TaylorTables(values, order, table)


def _series_terms(field: HeightField, wavelength: float, order: int) -> list[Array]:
    """Return I_p over the orders for p from 0 to 2N."""
    phase = phases(field, wavelength, 1.0)
    transforms = [fft.fft2((1j * phase) ** n / math.factorial(n), norm="forward") for n in range(order + 1)]
    terms = []
    for power in range(2 * order + 1):
        pairs = range(max(0, power - order), min(order, power) + 1)
        terms.append(
            np.asarray(
                sum((transforms[n] * transforms[power - n].conj()).real for n in pairs), dtype=np.float64
            )
        )
    return terms


def _series_facts(
    field: HeightField, wavelength: float, method: str, order: int, cosines: float
) -> dict[str, Any]:
    """Return how wrong a series is at the shortest wavelength, and a note where that is too much."""
    if method not in ("born", "taylor"):
        return {}
    used = 1 if method == "born" else order
    error = taylor_error(field, wavelength, used, cosines)
    facts: dict[str, Any] = {"order": used, "series_error": error}
    if error > TOLERANCE:
        try:
            remedy = f"order {taylor_order(field, wavelength, TOLERANCE, cosines)} is below {TOLERANCE:.0%}"
        except refuse.Refusal:
            remedy = "no order up to 60 is good enough; use method 'exact'"
        facts["notes"] = (
            f"Order {used} puts {error:.2g} of the light at {wavelength * 1e9:.0f} nm in the wrong place; "
            f"{remedy}.",
        )
    return facts


def _field(heights: HeightField | ArrayLike, pixel: float | None) -> HeightField:
    if isinstance(heights, HeightField):
        return height_field(heights.heights, heights.pixel if pixel is None else pixel, heights.name)
    if pixel is None:
        raise refuse.Refusal("'pixel' is needed, in metres: only a HeightField knows its own.")
    return height_field(heights, pixel)


def _axes(
    spectrum: Spectrum | str,
    size: int | tuple[int, int],
    half_range: float,
    warp: int,
    wavelengths: int | None,
    coherence: float,
) -> tuple[Spectrum, tuple[Array, Array], Array, Array]:
    """Return the light, its wavelengths and weights, and the table's cells along t and b."""
    rows, columns = checked_size(size)
    checked_half_range(half_range)
    checked_warp(warp)
    refuse.positive("coherence", coherence)
    lamp = as_spectrum(spectrum)
    if wavelengths is None:
        wavelengths = needed_wavelengths((coherence, coherence), (rows, columns), half_range, warp)
    t, b = cells(columns, half_range, warp), cells(rows, half_range, warp)[:, ::-1]
    return lamp, light.quadrature(lamp, wavelengths), t, b
