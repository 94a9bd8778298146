"""What a filter's width and the lens's blur do to a photograph of a pattern, and undoing it.

A band of wavelengths smears every order along its ray from the zero order. With the shares w_k of the
wavelengths λ_k and the exponent p of the model, the photograph is

    L(h) = B Σ_k w_k s_k^p M(s_k h),    s_k = λ_m / λ_k,

where M is the pattern at λ_m and B the blur. `sharpen` inverts it by Richardson and Lucy's iteration
(1972, 1974), which keeps the pattern positive; its adjoint scales back by 1 / s_k and divides by s_k².
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.light.lookups import stretched_at
from aureole.records import Pattern, Spectrum, Stage
from aureole.surface.pattern import DiffractionPattern, on_grid

Plane = NDArray[np.float32]
Operator = Callable[[Plane], Plane]

_CUBIC = 4  # taps: linear look-ups would blur what the iteration then sharpens twice
MOST_WAVELENGTHS = 64
TAIL = 2e-3  # of a band's height: what is fainter is left out
REACHED = 1e-2  # of a sample's light: what the photograph saw less of says nothing about it


def band_of(*parts: Spectrum) -> Spectrum:
    """Multiply a lamp, a filter and a sensor into the band that a photograph shows.

    Parameters
    ----------
    *parts : Spectrum
        One or more; one of them at most of kind "lines".

    Returns
    -------
    Spectrum
        Of kind "lines" where one is, and otherwise "power".

    Raises
    ------
    refuse.Refusal
        Where no light passes all of them, or two are lines.
    """
    lines = [part for part in parts if part.kind == "lines"]
    if not parts or len(lines) > 1:
        raise refuse.Refusal("A band needs one spectrum or more, and one of lines at most.")
    places = (
        lines[0].wavelengths if lines else np.unique(np.concatenate([part.wavelengths for part in parts]))
    )
    values = np.ones(places.size)
    for part in parts:
        if part.kind == "lines":
            values = values * part.values
        else:
            values = values * np.interp(places, part.wavelengths, part.values, left=0.0, right=0.0)
    if not values.any():
        names = ", ".join(part.name for part in parts)
        raise refuse.Refusal(f"No light passes all of: {names}.")
    return Spectrum(places, values, "lines" if lines else "power", " × ".join(part.name for part in parts))


def mean_wavelength(band: Spectrum) -> float:
    """Return the mean wavelength of a band, which its pattern belongs to best.

    Parameters
    ----------
    band : Spectrum
        Lamp × filter × sensor.

    Returns
    -------
    float
        Metres.
    """
    wavelengths, shares = shares_of(band, MOST_WAVELENGTHS)
    return float(wavelengths @ shares)


def shares_of(band: Spectrum, count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cut a band into wavelengths and their shares of the light.

    Parameters
    ----------
    band : Spectrum
        Of kind "lines", which gives its own, or "power".
    count : int
        Number of equal cells over the lit part of a density.

    Returns
    -------
    wavelengths : ndarray of float64, shape (K,)
        Metres.
    shares : ndarray of float64, shape (K,)
        They sum to 1.
    """
    if band.kind == "lines":
        lit = band.values > 0
        return band.wavelengths[lit], band.values[lit] / band.values[lit].sum()
    low, high = _lit(band)
    edges = np.linspace(low, high, count + 1)
    # Eight points in each cell follow the corners of a sampled density.
    fine = (edges[:-1, None] + np.diff(edges)[:, None] * (np.arange(8) + 0.5) / 8.0).ravel()
    density = np.interp(fine, band.wavelengths, band.values).reshape(count, 8)
    power = density.sum(axis=1)
    seen = power > 0
    middles = (density * fine.reshape(count, 8)).sum(axis=1)[seen] / power[seen]
    return middles, power[seen] / power.sum()


def _lit(band: Spectrum) -> tuple[float, float]:
    """Return the shortest and the longest wavelength of a band, its faintest tails left out."""
    lit = np.flatnonzero(band.values > TAIL * band.values.max())
    if band.kind == "lines":
        return float(band.wavelengths[lit[0]]), float(band.wavelengths[lit[-1]])
    low, high = max(lit[0] - 1, 0), min(lit[-1] + 1, band.values.size - 1)
    return float(band.wavelengths[low]), float(band.wavelengths[high])


def smeared(
    pattern: DiffractionPattern, band: Spectrum, power: float = 4.0, blur: float = 0.0
) -> DiffractionPattern:
    """Compute the photograph of a pattern through a filter and a lens.

    Parameters
    ----------
    pattern : DiffractionPattern
        At its own wavelength λ_m.
    band : Spectrum
        Lamp × filter × sensor.
    power : float
        p of the model: 4 phase, 2 amplitude.
    blur : float
        Standard deviation of the Gaussian blur, in h.

    Returns
    -------
    DiffractionPattern
        On the same grid.
    """
    forward, _ = _operators(on_grid(pattern), band, power, blur)
    return replace(pattern, values=forward(pattern.values))


def sharpen(
    pattern: DiffractionPattern,
    band: Spectrum | None = None,
    power: float = 4.0,
    blur: float = 0.0,
    iterations: int = 10,
    seen: NDArray[np.bool_] | None = None,
) -> DiffractionPattern:
    """Undo a filter's width and the lens's blur in a measured pattern.

    Parameters
    ----------
    pattern : DiffractionPattern
        As measured, said to be at λ_m.
    band : Spectrum or None
        Lamp × filter × sensor; None is a single wavelength.
    power : float
        p of the model: 4 phase, 2 amplitude.
    blur : float
        Standard deviation of the Gaussian blur, in h; 0 is sharp.
    iterations : int
        More recover finer detail, and noise with it.
    seen : ndarray of bool, shape (rows, columns), or None
        Where the pattern was measured; None is everywhere. What lies beyond is left to follow from what was
        measured, so that light which the band brought in from there is not crowded at the rim.

    Returns
    -------
    DiffractionPattern
        At λ_m on the same grid, none of it negative, zero where not measured.

    Raises
    ------
    refuse.Refusal
        Where a number is not as described.
    """
    for stage in sharpen_stages(pattern, band, power, blur, iterations, seen):
        last = stage
    sharp: DiffractionPattern = last.result
    return sharp


def sharpen_stages(
    pattern: DiffractionPattern,
    band: Spectrum | None = None,
    power: float = 4.0,
    blur: float = 0.0,
    iterations: int = 10,
    seen: NDArray[np.bool_] | None = None,
) -> Iterator[Stage]:
    """Do what `sharpen` does, with a stage before every iteration.

    Parameters
    ----------
    pattern : DiffractionPattern
        As for `sharpen`, and so are the others.
    band : Spectrum or None
        Lamp × filter × sensor.
    power : float
        p of the model.
    blur : float
        Standard deviation of the Gaussian blur, in h.
    iterations : int
        How many.
    seen : ndarray of bool, shape (rows, columns), or None
        Where the pattern was measured.

    Yields
    ------
    Stage
        The last one holds the pattern.
    """
    iterations = refuse.at_least("iterations", iterations, 1)
    plane = on_grid(pattern)
    known = np.ones(pattern.values.shape, bool) if seen is None else np.asarray(seen)
    margin = _margin(plane, band, blur)
    forward, adjoint = _operators(_framed(plane, margin), band, power, blur)
    measured: Plane = np.where(known, np.maximum(pattern.values, np.float32(0.0)), np.float32(0.0))
    top = float(measured.max())
    if not top > 0:
        yield Stage(1.0, "pattern", pattern)
        return
    # What is far below the pattern's least light cannot change, so that a zero divides nothing.
    floor = np.float32(1e-9 * top)
    inside = tuple(slice(margin, margin + count) for count in known.shape)
    reached = adjoint(np.pad(known.astype(np.float32), margin))
    told = reached > REACHED * reached.max()
    estimate = np.maximum(np.pad(_filled(measured, known), margin, mode="edge"), floor).astype(np.float32)
    for k in range(iterations):
        yield Stage(k / iterations, "undoing band and blur")
        ratio = np.where(known, measured / np.maximum(forward(estimate)[inside], floor), 0.0)
        change = adjoint(np.pad(ratio.astype(np.float32), margin))
        change = np.divide(change, reached, out=np.ones_like(change), where=told)
        estimate = np.maximum(estimate * change, floor).astype(np.float32)
    sharp = np.where(known, estimate[inside], np.float32(0.0))
    yield Stage(1.0, "pattern", replace(pattern, values=sharp))


def _filled(values: Plane, known: NDArray[np.bool_]) -> Plane:
    """Carry the nearest known values into what is not known, as a first guess."""
    from scipy.ndimage import distance_transform_edt

    if known.all() or not known.any():
        return values
    rows, columns = distance_transform_edt(~known, return_distances=False, return_indices=True)
    return np.asarray(values[rows, columns], dtype=np.float32)


def _margin(plane: Pattern, band: Spectrum | None, blur: float) -> int:
    """Count the samples beyond the rim from which band and blur bring light in."""
    shortest = plane.wavelength
    if band is not None:
        shortest = min(shortest, _lit(band)[0])
    half = 0.5 * float(max(plane.intensity.shape))
    blurred = 3.0 * blur / min(plane.grid.spacing)
    wide: float = min(half * (plane.wavelength / shortest - 1.0), half) + blurred
    return math.ceil(wide) + 1


def _framed(plane: Pattern, margin: int) -> Pattern:
    """Return a plane with a margin on each side."""
    rows, columns = plane.intensity.shape
    grid = replace(plane.grid, shape=(rows + 2 * margin, columns + 2 * margin))
    return replace(plane, intensity=np.pad(plane.intensity, margin), grid=grid)


def _operators(plane: Pattern, band: Spectrum | None, power: float, blur: float) -> tuple[Operator, Operator]:
    """Return the photograph of a pattern as an operator on its values, and the operator's adjoint."""
    grid = plane.grid
    if blur < 0:
        raise refuse.Refusal(f"'blur' must be >= 0, got {blur:g}.")
    widths = tuple(refuse.finite("blur", blur) / step for step in grid.spacing)
    wavelengths, shares = np.array([plane.wavelength]), np.ones(1)
    if band is not None:
        wavelengths, shares = shares_of(band, _enough(plane, band))
    scales = plane.wavelength / wavelengths
    weights = shares * scales ** refuse.finite("power", power)

    def forward(values: Plane) -> Plane:
        return _blurred(_scaled(values, scales, weights), widths)

    def adjoint(values: Plane) -> Plane:
        return _scaled(_blurred(values, widths), 1.0 / scales, weights / scales**2)

    def _scaled(values: Plane, by: NDArray[np.float64], share: NDArray[np.float64]) -> Plane:
        if band is None:
            return values
        y, x = grid.axes()
        colours = np.repeat(share[:, None], 3, axis=1)
        return stretched_at(replace(plane, intensity=values), by, colours, y, x, _CUBIC)[..., 0]

    return forward, adjoint


def _enough(plane: Pattern, band: Spectrum) -> int:
    """Count the wavelengths that step by about two samples from one to the next at the rim."""
    low, high = _lit(band)
    smear = (high - low) / plane.wavelength * max(plane.intensity.shape) / 2.0
    return int(np.clip(np.ceil(smear / 2.0), 8, MOST_WAVELENGTHS))


def _blurred(values: Plane, widths: tuple[float, ...]) -> Plane:
    from scipy.ndimage import gaussian_filter

    if not any(widths):
        return values
    return np.asarray(gaussian_filter(values, widths, mode="nearest"), dtype=np.float32)
