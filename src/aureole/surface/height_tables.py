"""From a height field to a look-up table.

Each wavelength has its own orders and its own pattern, so nothing is extrapolated from one wavelength to
another. A series that is too short for the heights is told in the table's notes.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from aureole import light, refuse
from aureole.records import Spectrum, Stage
from aureole.surface.grating_tables import needed_wavelengths
from aureole.surface.height import (
    COHERENCE,
    METHODS,
    TOLERANCE,
    HeightField,
    height_field,
    order_powers,
    order_powers_at,
    spread_orders,
    taylor_error,
    taylor_order,
)
from aureole.surface.integrate import as_spectrum, checked_size
from aureole.surface.order_sums import REACH, add_lobes, lobe_deviation, lobes
from aureole.surface.pattern import DiffractionPattern, diffraction_pattern
from aureole.surface.table import (
    HALF_RANGE,
    WARP,
    ZERO_ORDERS,
    ScatterTable,
    cells,
    checked_half_range,
    checked_warp,
    refuse_too_large,
    scatter_table,
)

HEIGHT_SIZE = 1024
# Bytes of orders that are mixed at once.
BLOCK = 128e6
# What a sample of a field and of a table takes while they are worked on: transforms; sums and the table.
FIELD_BYTES, TABLE_BYTES = 48, 48
# Figure 13 of Toisoul and Ghosh 2017.
FIGURE_ORDERS = (1, 2, 5)

Array = NDArray[np.float64]
Axes = tuple[Spectrum, tuple[Array, Array], Array, Array]


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
    field = as_field(heights, pixel)
    rows, columns = checked_size(size)
    refuse_too_large("size", (rows, columns), TABLE_BYTES)
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
    field = as_field(heights, pixel)
    refuse.one_of("method", method, METHODS)
    refuse.one_of("zero_order", zero_order, ZERO_ORDERS)
    refuse.between("cosines", cosines, 0.0, 2.0)
    refuse_too_large("heights", field.heights.shape, FIELD_BYTES)
    lamp, quadrature, t, b = height_axes(spectrum, size, half_range, warp, wavelengths, coherence)
    yield Stage(0.0, "transforming heights")
    powers, mixture = order_powers_at(field, quadrature[0], method, order, cosines)
    specular = (mixture @ powers[:, 0, 0]) @ quadrature[1]
    if zero_order != "keep":
        powers[:, 0, 0] = 0.0
    planes = np.zeros((3, b.shape[1], t.shape[1]))
    for done in spread(powers, mixture, field.pixel, quadrature, (t, b), coherence, planes):
        yield Stage(0.1 + 0.85 * done, "adding wavelengths")
    yield Stage(0.95, "judging the series")
    metadata: dict[str, Any] = {"heights": field.name, "method": method, "wavelengths": quadrature[0].size}
    if zero_order == "specular":
        metadata["zero_order_energy"] = tuple(float(part) for part in specular)
        mean = float(quadrature[0] @ quadrature[1][:, 1] / quadrature[1][:, 1].sum())
        metadata["zero_order_width"] = lobe_deviation(mean, coherence)
    metadata |= series_facts(field, float(quadrature[0].min()), method, order, cosines)
    values, white = np.moveaxis(planes, 0, -1), light.white(lamp)
    table = scatter_table(values, white, half_range, warp, lamp.name, "function", zero_order, metadata)
    yield Stage(1.0, "table", table)


def series_tables(
    heights: HeightField | ArrayLike,
    pixel: float | None = None,
    orders: tuple[int, ...] = FIGURE_ORDERS,
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = HEIGHT_SIZE,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    zero_order: str = "keep",
    coherence: float = COHERENCE,
) -> list[ScatterTable]:
    """Make one height field's tables by Taylor series of rising order, and the exact one (Fig. 13).

    Parameters
    ----------
    heights, pixel : see there
        As for `table_from_height`.
    orders : tuple of int
        Of the series.
    spectrum, size, half_range, warp, zero_order, coherence : see there
        As for `table_from_height`.

    Returns
    -------
    list of ScatterTable
        One for each order, then the exact one. Where the heights are too large for an order its table is too
        bright, and its metadata say so in "series_error" and "notes".

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    rest = (spectrum, size, half_range, warp, None)
    tables = [
        table_from_height(heights, pixel, *rest, "taylor", order, zero_order, coherence=coherence)
        for order in orders
    ]
    return [*tables, table_from_height(heights, pixel, *rest, "exact", 1, zero_order, coherence=coherence)]


def spread(
    powers: Array,
    mixture: Array,
    pixel: float,
    quadrature: tuple[Array, Array],
    cells: tuple[Array, Array],
    coherence: float,
    out: Array,
) -> Iterator[float]:
    """Add orders' lobes to a table, the orders of each wavelength mixed from those of a few.

    Parameters
    ----------
    powers : ndarray of float64, shape (P, rows, columns)
        As `order_powers_at` gives them.
    mixture : ndarray of float64, shape (W, P)
        How each wavelength mixes them.
    pixel : float
        Of the field, metres.
    quadrature : tuple of ndarray of float64, shape (W,) and (W, 3)
        Wavelengths and weights for X, Y and Z.
    cells : tuple of ndarray of float64, shape (2, C) and (2, R)
        Of the table, along t and b.
    coherence : float
        Metres.
    out : ndarray of float64, shape (3, R, C)
        Is added to.

    Yields
    ------
    float
        Share done.
    """
    wavelengths, weights = quadrature
    powers, frequencies = reaching(powers, pixel, wavelengths, cells, coherence)
    shape = powers.shape[1:]
    step = max(1, int(BLOCK / (8.0 * max(1, shape[0] * shape[1]))))
    for start in range(0, wavelengths.size, step):
        part = slice(start, min(start + step, wavelengths.size))
        # Interpolated powers may fall short of 0 by rounding.
        mixed = np.maximum(mixture[part] @ powers.reshape(len(powers), -1), 0.0).reshape(-1, *shape)
        where = lobes(frequencies, wavelengths[part], cells, coherence)
        wanted = np.arange(len(mixed))
        for done in add_lobes(mixed, wanted, weights[part], where, out):
            yield (start + done * (part.stop - start)) / wavelengths.size


def reaching(
    powers: Array, pixel: float, wavelengths: Array, cells: tuple[Array, Array], coherence: float
) -> tuple[Array, tuple[Array, Array]]:
    """Lay orders out by where they go, without those that no wavelength sends into the table.

    Parameters
    ----------
    powers : ndarray of float64, shape (P, rows, columns)
        In the order of `scipy.fft.fftfreq`.
    pixel : float
        Metres.
    wavelengths : ndarray of float64, shape (W,)
        Metres.
    cells : tuple of ndarray of float64, shape (2, C) and (2, R)
        Of the table, along t and b.
    coherence : float
        Metres.

    Returns
    -------
    powers : ndarray of float64, shape (P, M, N)
        Rising along both axes.
    frequencies : tuple of ndarray of float64, shape (N,) and (M,)
        Of the columns and of the rows, 1/m.
    """
    shortest, longest = float(wavelengths.min()), float(wavelengths.max())
    kept, frequencies = [], []
    for count, ends in zip(powers.shape[1:], cells[::-1], strict=True):
        rising = fft.fftshift(fft.fftfreq(count, pixel))
        reach = np.abs(ends).max() + REACH * lobe_deviation(longest, coherence)
        inside = np.flatnonzero(np.abs(rising) * shortest < reach)
        kept.append(fft.fftshift(np.arange(count))[inside])
        frequencies.append(rising[inside])
    return np.ascontiguousarray(powers[:, kept[0][:, None], kept[1]]), (frequencies[1], frequencies[0])


def series_facts(
    field: HeightField, wavelength: float, method: str, order: int, cosines: float
) -> dict[str, Any]:
    """Say how wrong a series is at the shortest wavelength, with a note where that is too much.

    Parameters
    ----------
    field : HeightField
        Heights.
    wavelength : float
        The shortest, metres.
    method : str
        Only "born" and "taylor" are series.
    order : int
        Of "taylor".
    cosines : float
        w.

    Returns
    -------
    dict
        "order", "series_error", and "notes" where the error is above 1 %; empty without a series.
    """
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


def as_field(heights: HeightField | ArrayLike, pixel: float | None) -> HeightField:
    """Return a height field given by itself or by numbers.

    Parameters
    ----------
    heights : HeightField or array_like
        Metres.
    pixel : float or None
        Metres; None where the field knows it.

    Returns
    -------
    HeightField
        The field.

    Raises
    ------
    refuse.Refusal
        Where the pixel is not known, or an input is not as described.
    """
    if isinstance(heights, HeightField):
        return height_field(heights.heights, heights.pixel if pixel is None else pixel, heights.name)
    if pixel is None:
        raise refuse.Refusal("'pixel' is needed, in metres: only a HeightField knows its own.")
    return height_field(heights, pixel)


def height_axes(
    spectrum: Spectrum | str,
    size: int | tuple[int, int],
    half_range: float,
    warp: int,
    wavelengths: int | None,
    coherence: float,
) -> Axes:
    """Return what a table is summed over.

    Parameters
    ----------
    spectrum, size, half_range, warp, wavelengths, coherence : see there
        As for `table_from_height`.

    Returns
    -------
    lamp : Spectrum
        The light.
    quadrature : tuple of ndarray
        Its wavelengths (W,) and weights (W, 3).
    t, b : ndarray of float64, shape (2, C) and (2, R)
        The table's cells.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described, or the table would not fit in memory.
    """
    rows, columns = checked_size(size)
    refuse_too_large("size", (rows, columns), TABLE_BYTES)
    checked_half_range(half_range)
    checked_warp(warp)
    refuse.positive("coherence", coherence)
    lamp = as_spectrum(spectrum)
    if wavelengths is None:
        wavelengths = needed_wavelengths((coherence, coherence), (rows, columns), half_range, warp)
    t, b = cells(columns, half_range, warp), cells(rows, half_range, warp)[:, ::-1]
    return lamp, light.quadrature(lamp, wavelengths), t, b
