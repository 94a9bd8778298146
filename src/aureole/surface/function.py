"""From a formula S(h · t, h · b, λ) to a table, sharp orders averaged over the table's cells.

A grating's orders are narrower than a cell of the table, so samples would miss them. A formula that can
integrate itself is asked for its means over cells; any other is sampled ever finer until the table stands.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse
from aureole.records import Spectrum, Stage
from aureole.surface.integrate import as_spectrum, checked_size
from aureole.surface.table import (
    HALF_RANGE,
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
Formula = Callable[[NDArray[np.float64], NDArray[np.float64], float], NDArray[np.floating]]
Light = tuple[NDArray[np.float64], NDArray[np.float64]]

# No cell is taken to be narrower than this: far below any order, and its mean keeps its digits.
NARROWEST = 1e-7
_ROWS, _COLUMNS = 128, 128  # of a part of the table that is sampled at one fineness
_FINEST = 16  # samples a cell and axis
_TOLERANCE = 1e-3  # of the brightest cell, of what twice the samples may change


def table_from_function(
    function: Formula,
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = SIZE,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    sample: str = "cell",
    wavelengths: int = WAVELENGTHS,
    zero_order: str = "keep",
    metadata: Mapping[str, Any] | None = None,
) -> ScatterTable:
    """Integrate a formula over the wavelengths of a light (surface paper, Eq. 12).

    Parameters
    ----------
    function : callable
        S(h_t, h_b, wavelength) in 1/sr, from h · t and h · b as arrays that broadcast and metres. It may
        have one of two methods that give means over cells: `cell_factors(t_cells, b_cells, wavelength)`
        returns the factors along b (R,) and along t (C,) of a separable S, `cell_mean` of the same
        arguments the means (R, C); cells are (2, C) and (2, R), lower and upper ends. The rows may lie in
        any order.
    spectrum : Spectrum or str
        The light, or an illuminant's name.
    size : int or tuple of int
        Samples of the table, or its (rows, columns).
    half_range : float
        h of the table's outermost samples, at most 2.
    warp : int
        n of h = half_range · uⁿ, odd.
    sample : {"cell", "point"}
        Means over the table's cells, which keep the energy of orders narrower than a cell, or values at
        its samples. Without either method, cells are sampled at up to 16 × 16 places.
    wavelengths : int
        Number of wavelengths; those without light are left out, and lines are themselves.
    zero_order : {"keep", "remove", "specular"}
        What the formula does about h = 0.
    metadata : Mapping or None
        What the table shall say.

    Returns
    -------
    ScatterTable
        In XYZ relative to the light's luminance.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described, or the formula gives NaN or infinity.
    """
    for stage in table_from_function_stages(
        function, spectrum, size, half_range, warp, sample, wavelengths, zero_order, metadata
    ):
        last = stage
    table: ScatterTable = last.result
    return table


def table_from_function_stages(
    function: Formula,
    spectrum: Spectrum | str = "E",
    size: int | tuple[int, int] = SIZE,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    sample: str = "cell",
    wavelengths: int = WAVELENGTHS,
    zero_order: str = "keep",
    metadata: Mapping[str, Any] | None = None,
) -> Iterator[Stage]:
    """Do what `table_from_function` does, with a stage after every few rows.

    Parameters
    ----------
    function : callable
        As for `table_from_function`, and so are the others.
    spectrum : Spectrum or str
        The light.
    size : int or tuple of int
        Samples of the table.
    half_range : float
        h of the outermost samples.
    warp : int
        n of h = half_range · uⁿ.
    sample : str
        Means over cells, or points.
    wavelengths : int
        Number of wavelengths.
    zero_order : str
        What the formula does about h = 0.
    metadata : Mapping or None
        What the table shall say.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    refuse.one_of("sample", sample, SAMPLES)
    source = as_spectrum(spectrum)
    quadrature = light.quadrature(source, wavelengths)
    rows, columns = checked_size(size)
    checked_half_range(half_range)
    checked_warp(warp)
    t, b = _cells(columns, half_range, warp, sample), _cells(rows, half_range, warp, sample)[:, ::-1]
    values = np.empty((rows, columns, 3), np.float32)
    add = _member(function, sample)
    for start in range(0, rows, _ROWS):
        yield Stage(start / rows, "adding wavelengths")
        values[start : start + _ROWS] = add(function, quadrature, t, b[:, start : start + _ROWS])
    white = light.white(source)
    yield Stage(
        1.0,
        "table",
        scatter_table(values, white, half_range, warp, source.name, "function", zero_order, metadata),
    )


def _cells(count: int, half_range: float, warp: int, sample: str) -> NDArray[np.float64]:
    """Return the cells' ends (2, count), the same place twice for point samples."""
    middles = axis(count, half_range, warp)
    if sample == "point":
        return np.stack([middles, middles])
    low, high = cells(count, half_range, warp)
    return np.stack([np.minimum(low, middles - NARROWEST / 2), np.maximum(high, middles + NARROWEST / 2)])


def _member(function: Formula, sample: str) -> Callable[..., NDArray[np.float64]]:
    """Choose how the formula is averaged."""
    if sample == "point":
        return _points
    if hasattr(function, "cell_factors"):
        return _factors
    return _means if hasattr(function, "cell_mean") else _finer


def _factors(
    function: Any, quadrature: Light, t: NDArray[np.float64], b: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Add separable wavelengths: one product of matrices a channel."""
    wavelengths, weights = quadrature
    pairs = [function.cell_factors(t, b, float(wavelength)) for wavelength in wavelengths]
    along_b, along_t = (np.stack(parts) for parts in zip(*pairs, strict=True))
    planes = [(along_b * weight[:, None]).T @ along_t for weight in weights.T]
    return np.asarray(np.stack(planes, axis=-1), dtype=np.float64)


def _means(
    function: Any, quadrature: Light, t: NDArray[np.float64], b: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Add the formula's own means over cells."""
    total = np.zeros((b.shape[1], t.shape[1], 3))
    for wavelength, weight in zip(*quadrature, strict=True):
        total += np.asarray(function.cell_mean(t, b, float(wavelength)))[..., None] * weight
    return total


def _points(
    function: Formula, quadrature: Light, t: NDArray[np.float64], b: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Add the formula's values at one place a cell."""
    return _sampled(function, quadrature, t, b, 1)


def _finer(
    function: Formula, quadrature: Light, t: NDArray[np.float64], b: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Sample each part of the table twice as finely until it changes no more."""
    out = np.empty((b.shape[1], t.shape[1], 3))
    for start in range(0, t.shape[1], _COLUMNS):
        part = t[:, start : start + _COLUMNS]
        count = 2
        before, now = (_sampled(function, quadrature, part, b, n) for n in (1, 2))
        while count < _FINEST and np.abs(now - before).max() > _TOLERANCE * np.abs(now).max():
            count *= 2
            before, now = now, _sampled(function, quadrature, part, b, count)
        out[:, start : start + _COLUMNS] = now
    return out


def _sampled(
    function: Formula, quadrature: Light, t: NDArray[np.float64], b: NDArray[np.float64], count: int
) -> NDArray[np.float64]:
    """Average over count × count places in each cell."""
    shares = (np.arange(count) + 0.5) / count
    h_t = (t[0][:, None] + (t[1] - t[0])[:, None] * shares).reshape(1, -1)
    h_b = (b[0][:, None] + (b[1] - b[0])[:, None] * shares).reshape(-1, 1)
    rows, columns = b.shape[1], t.shape[1]
    total = np.zeros((rows, columns, 3))
    for wavelength, weight in zip(*quadrature, strict=True):
        fine = np.broadcast_to(function(h_t, h_b, float(wavelength)), (rows * count, columns * count))
        total += fine.reshape(rows, count, columns, count).mean(axis=(1, 3))[..., None] * weight
    return total
