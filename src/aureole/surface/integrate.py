"""From a pattern at one to three wavelengths, or a formula, to a table for all of a light's wavelengths.

One wavelength diffracts S_λ(h) = (λ_m / λ)^p M(λ_m h / λ), M being the pattern at λ_m. Eq. 6 of the
surface paper holds one 1/λ² already, so a relief that shifts the phase (Eq. 8) has p = 4, and a grating of
mirrors and gaps p = 2, which keeps its energy. The table is S_X = ∫ S_λ P x̄ dλ / ∫ P ȳ dλ (Eq. 12), so too
for Y and Z. Pattern and formula are the surface's own: no F, no G and no 4π² in them.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse
from aureole.light.lookups import stretched_at
from aureole.records import Spectrum, Stage
from aureole.surface.cell_means import CellMeans, reference_means
from aureole.surface.pattern import DiffractionPattern, on_grid
from aureole.surface.table import (
    HALF_RANGE,
    MODELS,
    SIZE,
    WARP,
    WAVELENGTHS,
    ScatterTable,
    axis,
    cells,
    checked_half_range,
    checked_warp,
    scatter_table,
)

SAMPLES = ("cell", "point")
METHODS = ("auto", "reference", "separable")
Bands = list[tuple[DiffractionPattern, NDArray[np.float64], NDArray[np.float64]]]
Adder = Callable[[NDArray[np.float64], NDArray[np.float32]], None]

_ROWS = 256  # rows of a table between two stages


def table_from_pattern(
    patterns: DiffractionPattern | Sequence[DiffractionPattern],
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = SIZE,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    model: str = "phase",
    method: str = "auto",
    wavelengths: int = WAVELENGTHS,
    zero_order: str = "keep",
    metadata: Mapping[str, Any] | None = None,
    sample: str = "cell",
) -> ScatterTable:
    """Integrate a pattern over the wavelengths of a light (surface paper, Eq. 12 and 15).

    Parameters
    ----------
    patterns : DiffractionPattern or sequence of them
        The pattern at one wavelength, or at several: then each is scaled to the wavelength, and the two
        nearest are mixed linearly in wavelength; beyond the outermost there is one alone.
    spectrum : Spectrum or str
        The light, or an illuminant's name.
    size : int or tuple of int
        Samples of the table, or its (rows, columns).
    half_range : float
        h of the table's outermost samples, at most 2.
    warp : int
        n of h = half_range · uⁿ, odd.
    model : {"phase", "amplitude", "paper"}
        Power p of λ_m / λ: 4, 2, and 2 as in the paper's Eq. 15.
    method : {"auto", "separable", "reference"}
        "separable" mixes two rows of the pattern for a row of the table, then looks up along it, in
        float32; "reference" adds them in float64, wavelength by wavelength. "auto" is "separable".
    wavelengths : int
        Number of wavelengths; those without light are left out, and lines are themselves.
    zero_order : {"keep", "remove", "specular"}
        What became of the light about h = 0 in the pattern.
    metadata : Mapping or None
        What else the table shall say.
    sample : {"cell", "point"}
        Means of the bilinear pattern over the table's cells, which keep its energy where cells are wider than
        the pattern's samples, or its values at the table's samples, as Eq. 15 has it.

    Returns
    -------
    ScatterTable
        In XYZ relative to the light's luminance.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    for stage in table_from_pattern_stages(
        patterns, spectrum, size, half_range, warp, model, method, wavelengths, zero_order, metadata, sample
    ):
        last = stage
    table: ScatterTable = last.result
    return table


def table_from_pattern_stages(
    patterns: DiffractionPattern | Sequence[DiffractionPattern],
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = SIZE,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    model: str = "phase",
    method: str = "auto",
    wavelengths: int = WAVELENGTHS,
    zero_order: str = "keep",
    metadata: Mapping[str, Any] | None = None,
    sample: str = "cell",
) -> Iterator[Stage]:
    """Do what `table_from_pattern` does, with a stage after every few rows.

    Parameters
    ----------
    patterns : DiffractionPattern or sequence of them
        As for `table_from_pattern`, and so are the others.
    spectrum : Spectrum or str
        The light.
    size : int or tuple of int
        Samples of the table.
    half_range : float
        h of the outermost samples.
    warp : int
        n of h = half_range · uⁿ.
    model : str
        Power of λ_m / λ.
    method : str
        How it is computed.
    wavelengths : int
        Number of wavelengths.
    zero_order : str
        What became of the light about h = 0.
    metadata : Mapping or None
        What else the table shall say.
    sample : str
        Means over cells, or points.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    refuse.one_of("method", method, METHODS)
    refuse.one_of("model", model, MODELS)
    refuse.one_of("sample", sample, SAMPLES)
    source = as_spectrum(spectrum)
    bands = weighed_bands(patterns, source, MODELS[model], wavelengths)
    rows, columns = checked_size(size)
    # Samples, or cells' ends; of the rows −h · b, which rises.
    places = axis if sample == "point" else cells
    t = places(columns, checked_half_range(half_range), checked_warp(warp))
    down = places(rows, half_range, warp)
    values = np.zeros((rows, columns, 3), np.float32)
    add = _MEMBERS[sample, "separable" if method == "auto" else method](bands, t)
    for start in range(0, rows, _ROWS):
        yield Stage(start / rows, "adding wavelengths")
        add(down[..., start : start + _ROWS], values[start : start + _ROWS])
    notes = {"patterns": [_described(band[0]) for band in bands], "sample": sample, **(metadata or {})}
    white = light.white(source)
    yield Stage(
        1.0,
        "table",
        scatter_table(values, white, half_range, warp, source.name, model, zero_order, notes),
    )


def table_rows(
    patterns: DiffractionPattern | Sequence[DiffractionPattern],
    spectrum: Spectrum | str,
    size: int | tuple[int, int],
    chosen: slice,
    wavelengths: int = WAVELENGTHS,
    sample: str = "cell",
    model: str = "phase",
    half_range: float = HALF_RANGE,
    warp: int = WARP,
) -> NDArray[np.float32]:
    """Return some rows of a table by the direct sum in float64, to judge the fast ones by.

    Parameters
    ----------
    patterns : DiffractionPattern or sequence of them
        As for `table_from_pattern`, and so are the others.
    spectrum : Spectrum or str
        The light.
    size : int or tuple of int
        Samples of the whole table.
    chosen : slice
        Which of its rows.
    wavelengths : int
        Number of wavelengths.
    sample : str
        Means over cells, or points.
    model : str
        Power of λ_m / λ.
    half_range : float
        h of the outermost samples.
    warp : int
        n of h = half_range · uⁿ.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        X, Y, Z.
    """
    bands = weighed_bands(patterns, as_spectrum(spectrum), MODELS[model], wavelengths)
    rows, columns = checked_size(size)
    places = axis if sample == "point" else cells
    down = places(rows, half_range, warp)[..., chosen]
    found = np.zeros((down.shape[-1], columns, 3), np.float32)
    _MEMBERS[sample, "reference"](bands, places(columns, half_range, warp))(down, found)
    return found


def as_spectrum(spectrum: Spectrum | str) -> Spectrum:
    """Return a light given by itself or by its name.

    Parameters
    ----------
    spectrum : Spectrum or str
        A light, or what `light.illuminant` takes.

    Returns
    -------
    Spectrum
        The light.
    """
    return light.illuminant(spectrum) if isinstance(spectrum, str) else spectrum


def checked_size(size: int | tuple[int, int]) -> tuple[int, int]:
    """Return a table's (rows, columns).

    Parameters
    ----------
    size : int or tuple of int
        One number for both, or both.

    Returns
    -------
    tuple of int
        Rows and columns, at least 2 each.

    Raises
    ------
    refuse.Refusal
        Where a number is smaller, or no integer.
    """
    rows, columns = (size, size) if isinstance(size, int | np.integer) else size
    return refuse.at_least("size", rows, 2), refuse.at_least("size", columns, 2)


def weighed_bands(
    patterns: DiffractionPattern | Sequence[DiffractionPattern],
    spectrum: Spectrum,
    power: float,
    wavelengths: int,
) -> Bands:
    """Say how each pattern enters the sum over wavelengths.

    Parameters
    ----------
    patterns : DiffractionPattern or sequence of them
        At different wavelengths.
    spectrum : Spectrum
        The light.
    power : float
        p of (λ_m / λ)^p.
    wavelengths : int
        Number of wavelengths of the sum.

    Returns
    -------
    list of (DiffractionPattern, ndarray (W,), ndarray (W, 3))
        For each pattern its scales λ_m / λ and the weights for X, Y and Z, (λ_m / λ)^p in them. Where a
        pattern has no weight the wavelength is left out.

    Raises
    ------
    refuse.Refusal
        Where there is no pattern, or two are of one wavelength.
    """
    given = [patterns] if isinstance(patterns, DiffractionPattern) else list(patterns)
    if not given:
        raise refuse.Refusal("'patterns' needs one pattern or more, got none.")
    given.sort(key=lambda pattern: pattern.wavelength)
    centres = np.array([pattern.wavelength for pattern in given])
    if np.any(np.diff(centres) <= 0):
        raise refuse.Refusal("'patterns' must be of different wavelengths; two are of the same.")
    places, weights = light.quadrature(spectrum, wavelengths)
    bands = []
    for k, pattern in enumerate(given):
        share = np.interp(places, centres, np.eye(centres.size)[k])
        lit = share > 0
        scales = pattern.wavelength / places[lit]
        bands.append((pattern, scales, weights[lit] * (share[lit] * scales**power)[:, None]))
    return bands


def _separable(bands: Bands, t: NDArray[np.float64]) -> Adder:
    """Return what fills rows of a table by the separable look-ups of the spectral sum."""

    def add(down: NDArray[np.float64], out: NDArray[np.float32]) -> None:
        for pattern, scales, weights in bands:
            if scales.size:
                out += stretched_at(on_grid(pattern), scales, weights, down, t, taps=2)

    return add


def _reference(bands: Bands, t: NDArray[np.float64]) -> Adder:
    """Return what fills rows of a table by bilinear look-ups in float64, one wavelength after the other."""

    def add(down: NDArray[np.float64], out: NDArray[np.float32]) -> None:
        total = np.zeros(out.shape)
        for pattern, scales, weights in bands:
            for scale, weight in zip(scales, weights, strict=True):
                found = bilinear(pattern, scale * t[None, :], -scale * down[:, None])
                total += found[:, :, None] * weight
        out[:] = total

    return add


def _means(bands: Bands, t: NDArray[np.float64]) -> Adder:
    """Return what fills rows of a table by means over cells, along rows and columns in turn."""
    parts = [CellMeans(*band, t) for band in bands if band[1].size]

    def add(down: NDArray[np.float64], out: NDArray[np.float32]) -> None:
        for part in parts:
            part.add(down, out)

    return add


def _reference_means(bands: Bands, t: NDArray[np.float64]) -> Adder:
    """Return what fills rows of a table by means over cells in float64, one wavelength after the other."""

    def add(down: NDArray[np.float64], out: NDArray[np.float32]) -> None:
        total = np.zeros(out.shape)
        for pattern, scales, weights in bands:
            for scale, weight in zip(scales, weights, strict=True):
                total += reference_means(pattern, float(scale), down, t)[:, :, None] * weight
        out[:] = total

    return add


def bilinear(
    pattern: DiffractionPattern, h_t: NDArray[np.float64], h_b: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Read a pattern at any h, bilinear between its samples, which have zeros for neighbours outside.

    Parameters
    ----------
    pattern : DiffractionPattern
        Any.
    h_t, h_b : ndarray of float64
        Of shapes that broadcast.

    Returns
    -------
    ndarray of float64
        Of the shape they broadcast to.
    """
    rows, columns = pattern.values.shape
    framed = np.pad(pattern.values.astype(np.float64), 2)
    y = np.clip((1.0 - h_b / pattern.half_range) * (rows - 1) / 2, -2.0, rows) + 2.0
    x = np.clip((1.0 + h_t / pattern.half_range) * (columns - 1) / 2, -2.0, columns) + 2.0
    i, j = y.astype(np.int64), x.astype(np.int64)
    upper = (1 - (x - j)) * framed[i, j] + (x - j) * framed[i, j + 1]
    lower = (1 - (x - j)) * framed[i + 1, j] + (x - j) * framed[i + 1, j + 1]
    found: NDArray[np.float64] = (1 - (y - i)) * upper + (y - i) * lower
    return found


def _described(pattern: DiffractionPattern) -> dict[str, Any]:
    said = {"name": pattern.name, "wavelength": pattern.wavelength, "half_range": pattern.half_range}
    return {**said, **pattern.metadata}


_MEMBERS = {
    ("point", "separable"): _separable,
    ("point", "reference"): _reference,
    ("cell", "separable"): _means,
    ("cell", "reference"): _reference_means,
}
