"""From a grating to a look-up table: sums of outer products, one for each wavelength.

Lines and crossed lines are products of a part along columns and a part along rows, so a whole table is one
matrix product a channel; rings are one profile over the distance from h = 0. Wavelengths are close enough
together that the order of one touches that of the next.
"""

import math
from collections.abc import Generator, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse
from aureole.records import Spectrum, Stage
from aureole.surface.gratings import Grating, checked, cloud_radii, grating, ring_cells
from aureole.surface.integrate import as_spectrum, checked_size
from aureole.surface.table import (
    HALF_RANGE,
    SIZE,
    WARP,
    WAVELENGTHS,
    ZERO_ORDERS,
    ScatterTable,
    axis,
    cells,
    checked_half_range,
    checked_warp,
    refuse_too_large,
    scatter_table,
)

MOST_WAVELENGTHS = 801
# What a sample takes while a table is made: three channels, the plane of one, and distances of rings.
TABLE_BYTES = 64
SHORTEST, LONGEST = 380e-9, 780e-9
# The Gaussian that is as wide as an order at half its height, over λ / (N d): 0.886 / √(8 ln 2).
ORDER_DEVIATION = 0.3762
# Rings are integrated over this many distances, which is finer than any table's cells.
DISTANCES = 8192

Array = NDArray[np.float64]
Light = tuple[Array, Array]


def table_from_grating(
    source: Grating | str,
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = SIZE,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    wavelengths: int | None = None,
    zero_order: str = "keep",
    cosines: float = 2.0,
) -> ScatterTable:
    """Make the look-up table of a grating under a light, each cell the mean of the pattern over it.

    Parameters
    ----------
    source : Grating or str
        The grating, or a preset's name.
    spectrum : Spectrum or str
        The light, or an illuminant's name.
    size : int or tuple of int
        Samples of the table, or its (rows, columns).
    half_range : float
        h of the table's outermost samples, at most 2.
    warp : int
        n of h = half_range · uⁿ, odd.
    wavelengths : int or None
        Number of wavelengths; None for as many as sharp orders need, see `needed_wavelengths`.
    zero_order : {"keep", "remove", "specular"}
        "remove" and "specular" leave out half an order about h = 0; "specular" says in the table's
        metadata how much light that was, for an ordinary lobe to render.
    cosines : float
        cos θ_i + cos θ_o for which depths are taken: 2 at normal incidence.

    Returns
    -------
    ScatterTable
        In XYZ relative to the light's luminance; 4π² times its integral over h is the share of light
        that a perfect mirror with these lines would send on.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described, or the table would not fit in memory.
    """
    for stage in table_from_grating_stages(
        source, spectrum, size, half_range, warp, wavelengths, zero_order, cosines
    ):
        last = stage
    table: ScatterTable = last.result
    return table


def table_from_grating_stages(
    source: Grating | str,
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = SIZE,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    wavelengths: int | None = None,
    zero_order: str = "keep",
    cosines: float = 2.0,
) -> Iterator[Stage]:
    """Do what `table_from_grating` does, with a stage after every few wavelengths.

    Parameters
    ----------
    source, spectrum, size, half_range, warp, wavelengths, zero_order, cosines : see there
        As for `table_from_grating`.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    lines = grating(source) if isinstance(source, str) else checked(source)
    rows, columns = checked_size(size)
    refuse_too_large("size", (rows, columns), TABLE_BYTES)
    checked_half_range(half_range)
    checked_warp(warp)
    refuse.one_of("zero_order", zero_order, ZERO_ORDERS)
    refuse.between("cosines", cosines, 0.0, 2.0)
    lamp = as_spectrum(spectrum)
    if wavelengths is None:
        across = lines.along if lines.radial else lines.across
        lengths = (across.count * across.period if across else 0.0, lines.along.count * lines.along.period)
        wavelengths = needed_wavelengths(lengths, (rows, columns), half_range, warp)
    quadrature = light.quadrature(lamp, wavelengths)
    t, b = cells(columns, half_range, warp), cells(rows, half_range, warp)[:, ::-1]
    yield Stage(0.0, "adding wavelengths")
    if lines.radial:
        values = _rings(lines, quadrature, t, b, cosines, zero_order == "keep")
    else:
        values = yield from _products(lines, quadrature, t, b, cosines, zero_order == "keep")
    metadata: dict[str, Any] = {"grating": lines.name, "wavelengths": int(quadrature[0].size)}
    if zero_order == "specular":
        metadata["zero_order_energy"] = _zero_order(lines, quadrature, cosines)
        metadata["zero_order_width"] = _zero_order_width(lines, quadrature)
    white = light.white(lamp)
    table = scatter_table(values, white, half_range, warp, lamp.name, "function", zero_order, metadata)
    yield Stage(1.0, "table", table)


def needed_wavelengths(
    lengths: tuple[float, float], size: tuple[int, int], half_range: float = HALF_RANGE, warp: int = WARP
) -> int:
    """Return how many wavelengths keep orders from falling apart into dots.

    From one wavelength to the next an order at h moves by h Δλ / λ, which shall be no more than a third of an
    order's own width, λ over the length that is lit in phase, or of a cell of the table, whichever is wider
    there.

    Parameters
    ----------
    lengths : tuple of float
        Lit in phase along b (rows) and along t (columns), metres; 0 where nothing repeats.
    size : tuple of int
        The table's (rows, columns).
    half_range : float
        h of the outermost samples.
    warp : int
        n of h = half_range · uⁿ.

    Returns
    -------
    int
        From `WAVELENGTHS` to `MOST_WAVELENGTHS`.
    """
    need = WAVELENGTHS
    for length, count in zip(lengths, size, strict=True):
        if length > 0:
            h = axis(count, half_range, warp)
            low, high = cells(count, half_range, warp)
            width = np.maximum(high - low, SHORTEST / length)
            # The outermost cells are halves, which says nothing about how far wavelengths may lie apart.
            within = (h > 0) & (h < half_range)
            step = SHORTEST / 3.0 * float(np.min((width / np.where(within, h, 1.0))[within], initial=1.0))
            need = max(need, math.ceil((LONGEST - SHORTEST) / step) + 1)
    return min(need, MOST_WAVELENGTHS)


def _products(
    lines: Grating, quadrature: Light, t: Array, b: Array, cosines: float, zero_order: bool
) -> Generator[Stage, None, NDArray[np.float32]]:
    """Add the outer products of all wavelengths: one product of matrices a channel."""
    rows, columns, weights = [], [], []
    for index, (wavelength, weight) in enumerate(zip(*quadrature, strict=True)):
        if index % 32 == 31:
            yield Stage(0.8 * index / quadrature[0].size, "adding wavelengths")
        for row_part, column_part in lines.terms(t, b, float(wavelength), cosines, zero_order):
            rows.append(row_part)
            columns.append(column_part)
            weights.append(weight)
    along_b, along_t = np.stack(rows, axis=1), np.stack(columns)
    values = np.empty((b.shape[1], t.shape[1], 3), np.float32)
    for channel, share in enumerate(np.stack(weights, axis=1)):
        # Lines that run on spread all wavelengths alike along b.
        alike = lines.across is None
        plane = np.outer(rows[0], share @ along_t) if alike else (along_b * share) @ along_t
        values[..., channel] = np.maximum(plane, 0.0)
    return values


def _rings(
    lines: Grating, quadrature: Light, t: Array, b: Array, cosines: float, zero_order: bool
) -> NDArray[np.float32]:
    """Integrate over wavelengths along the distance from h = 0, then average over each cell's distances."""
    reach = math.hypot(np.abs(t).max(), np.abs(b).max())
    distances = reach * np.linspace(0.0, 1.0, DISTANCES + 1) ** 3
    profile = np.zeros((DISTANCES, 3))
    places = cloud_radii(lines, float(quadrature[0].max()))
    cloud = np.zeros((places.size, 3))
    for wavelength, weight in zip(*quadrature, strict=True):
        ends = (distances[:-1], distances[1:])
        mean = lines.along.mean(*ends, float(wavelength), cosines, False)
        if lines.along.profile == "blazed":
            # Only facets send different light to both sides.
            mean = 0.5 * (mean + lines.along.mean(-ends[1], -ends[0], float(wavelength), cosines, False))
        profile += mean[:, None] * weight
        if zero_order:
            cloud += lines.cloud(places, float(wavelength), cosines)[:, None] * weight
    running = np.concatenate([np.zeros((1, 3)), np.cumsum(profile * np.diff(distances)[:, None], axis=0)])
    radius, low, high = ring_cells(t, b)
    # Straight lines between so many distances err by less than 1e-6.
    ring = np.interp(radius, distances, lines.ring(distances)) / (4.0 * np.pi**2)
    values = np.empty((*radius.shape, 3), np.float32)
    for channel in range(3):
        light_in = np.interp(high, distances, running[:, channel])
        light_in -= np.interp(low, distances, running[:, channel])
        near = np.interp(radius, places, cloud[:, channel], right=0.0) / (4.0 * np.pi**2)
        values[..., channel] = light_in / (high - low) * ring + near
    return values


def _zero_order_width(lines: Grating, quadrature: Light) -> float:
    """Return the deviation of h along an axis: of the Gaussian that is as wide as an order at half height."""
    wavelength = float(quadrature[0] @ quadrature[1][:, 1] / quadrature[1][:, 1].sum())
    along = ORDER_DEVIATION * wavelength / (lines.along.count * lines.along.period)
    across = lines.spread
    if lines.across is not None:
        across = ORDER_DEVIATION * wavelength / (lines.across.count * lines.across.period)
    elif lines.radial:
        across = along
    return math.sqrt(0.5 * (along**2 + across**2))


def _zero_order(lines: Grating, quadrature: Light, cosines: float) -> tuple[float, float, float]:
    """Return X, Y, Z of the light within half an order of h = 0."""
    total = np.zeros(3)
    for wavelength, weight in zip(*quadrature, strict=True):
        share = 1.0
        for part in (lines.along, lines.across):
            if part is not None:
                half = 0.5 * float(wavelength) / part.period
                share *= 2.0 * half * float(part.mean([-half], [half], float(wavelength), cosines)[0])
        total += share * weight
    return float(total[0]), float(total[1]), float(total[2])
