"""The spectral sum: a pattern at one wavelength, scaled to every wavelength of a light and added up.

Diffraction patterns scale with wavelength. Where P_r is the pattern at the reference wavelength λ_r
over frequency q, the colour at q is (Scandolo, Lee and Eisemann 2018, Eq. 14-16)

    S_c(q) = Σ_λ w_c(λ) ρ(λ)² P_r(ρ(λ) q),    ρ(λ) = λ_r / λ,

with the weights w_c of `observer.quadrature`. The square keeps the energy: over an infinite plane
each channel holds the pattern's energy times the light's white, whose luminance is 1.

METHODS: "reference" here, "full" and "batch" in `lookups`, "rays" in `rays`.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.light.lookups import batch, full, full_at, look_ups, stretched_at
from aureole.light.observer import quadrature, white
from aureole.light.rays import counts, rays, refusal
from aureole.light.scaling import TAPS, Analytic, Task, index_positions
from aureole.light.spaces import WHITE_KEY
from aureole.records import Grid, Pattern, Picture, Spectrum

DEFAULT_SAMPLES = 60
# Costs in nanoseconds on two cores; only their ratios count.
LOOK_UP = {"linear": 3.0, "cubic": 6.0}
RAYS_START, RAYS_CROSSING, RAYS_PIXEL = 2.5e6, 25.0, 25.0


def spectral_sum(
    pattern: Pattern | NDArray[np.floating] | Analytic,
    reference_wavelength: float | None,
    spectrum: Spectrum,
    method: str = "auto",
    *,
    grid: Grid | None = None,
    samples: int = DEFAULT_SAMPLES,
    interpolation: str = "linear",
    symmetric: bool = False,
) -> Picture:
    """Add up a diffraction pattern over the wavelengths of a light, in XYZ.

    Parameters
    ----------
    pattern : Pattern, ndarray of shape (rows, columns), or callable
        Intensity over frequency at the reference wavelength; zero outside its grid. A bare array
        has a grid of spacing 1. A callable takes frequencies (u, v), broadcast against each other,
        and is evaluated exactly. A pattern should reach λ_r / 400 nm times as far as the output
        grid, or blue and violet are missing at the rim.
    reference_wavelength : float or None
        Metres; None takes the pattern's own.
    spectrum : Spectrum
        The light.
    method : {"auto", "reference", "full", "batch", "rays"}
        "reference" adds in float64 without any haste (Eq. 16). "full" does the same in float32, fast.
        "batch" is the paper's two passes, 4 + 15 look-ups for 60 wavelengths over 400 to 700 nm;
        λ_r is free, and best at the range's geometric mean, 529 nm. "rays" integrates along rays from
        the origin, with as many wavelengths as follow every fringe. "auto" takes the cheaper of "full" and
        "rays", by a fitted cost. See Notes.
    grid : Grid or None
        Where to compute the sum, in the pattern's frequency; None is the pattern's own grid. Values
        are point samples of a density, whatever the spacing.
    samples : int
        Number of wavelengths over 380 to 780 nm. With the default of 60, fringes at frequency q
        step by about |q| / 80 from one to the next; take more where that is coarser than the
        fringes.
    interpolation : {"linear", "cubic"}
        Between the pattern's samples. "cubic" is Catmull-Rom, clipped at zero.
    symmetric : bool
        Say that the pattern has P(−q) = P(q), as a real aperture's far field has, and half the work
        is saved: the lower half is the upper one turned by 180°. The output grid must be centred on
        zero.

    Returns
    -------
    Picture
        (rows, columns, 3) in colour space "xyz"; its metadata names the light's white.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described, or a method cannot serve it.

    Notes
    -----
    "full" equals "reference" to 2e-6 of the brightest value. "batch" and "rays" stand for other sums
    of wavelengths, closer to the integral or coarser; they need a light of kind "power", "rays" a pattern
    centred on zero. For a heptagon at 1024², equal-energy light, 60 samples, `benchmarks/spectral_sum.py`
    gives the PSNR of the logarithms to 401 wavelengths without interpolation, the worst of X, Y, Z, and
    for "batch" to "full":

    =================================  =====  =====  =====  =============
    cubic, samples in 1 / diameter     full   batch  rays   batch to full
    =================================  =====  =====  =====  =============
    1 (fringes under-sampled)          46 dB  41 dB  44 dB  44 dB
    2 (their Nyquist rate)             51 dB  45 dB  50 dB  45 dB
    4                                  44 dB  46 dB  63 dB  42 dB
    =================================  =====  =====  =====  =============
    """
    refuse.one_of("method", method, ("auto", *METHODS))
    refuse.one_of("interpolation", interpolation, TAPS)
    source, wavelength = _source(pattern, reference_wavelength)
    target = _target(source, grid, symmetric)
    samples = refuse.at_least("samples", samples, 1)
    task = Task(source, target, wavelength, spectrum, samples, interpolation, symmetric)
    pixels = METHODS[_choice(task) if method == "auto" else method](task)
    return in_white_of(spectrum, pixels)


def spectral_sum_at(
    pattern: Pattern,
    spectrum: Spectrum,
    rows: NDArray[np.float64],
    columns: NDArray[np.float64],
    samples: int = DEFAULT_SAMPLES,
    interpolation: str = "linear",
) -> NDArray[np.float32]:
    """Add up a diffraction pattern over wavelengths where chosen rows and columns cross.

    Parameters
    ----------
    pattern : Pattern
        As for `spectral_sum`.
    spectrum : Spectrum
        The light.
    rows, columns : ndarray of float64, shapes (R,) and (C,)
        Frequencies, rising, at any distances.
    samples : int
        Number of wavelengths.
    interpolation : {"linear", "cubic"}
        Between the pattern's samples.

    Returns
    -------
    ndarray of float32, shape (R, C, 3)
        XYZ.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    refuse.one_of("interpolation", interpolation, TAPS)
    return full_at(pattern, spectrum, rows, columns, samples, TAPS[interpolation])


def stretched_sum(
    pattern: Pattern,
    spectrum: Spectrum,
    scale: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    grid: Grid,
    samples: int = DEFAULT_SAMPLES,
    interpolation: str = "linear",
) -> Picture:
    """Add up a pattern over wavelengths, stretched by a rule of the caller's and made no brighter.

    S_c(q) = Σ_λ w_c(λ) P_r(s(ρ) q), ρ = λ_r / λ: where the pattern is 1, the sum is the light's white.

    Parameters
    ----------
    pattern : Pattern
        At its own wavelength λ_r; zero outside its grid.
    spectrum : Spectrum
        The light.
    scale : callable
        Takes ρ of each wavelength, shape (W,), and returns s(ρ), all positive.
    grid : Grid
        Where the sum is wanted, in the pattern's unit.
    samples : int
        Number of wavelengths.
    interpolation : {"linear", "cubic"}
        Between the pattern's samples.

    Returns
    -------
    Picture
        (rows, columns, 3) in colour space "xyz"; its metadata names the light's white.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    refuse.one_of("interpolation", interpolation, TAPS)
    _checked_grid("grid", grid)
    wavelengths, weights = quadrature(spectrum, samples)
    scales = scale(pattern.wavelength / wavelengths)
    if not np.all(scales > 0):
        raise refuse.Refusal(f"'scale' must be > 0 for every wavelength, got {np.min(scales):g}.")
    pixels = stretched_at(pattern, scales, weights, *grid.axes(), TAPS[interpolation])
    return in_white_of(spectrum, pixels)


def in_white_of(spectrum: Spectrum, pixels: NDArray[np.floating]) -> Picture:
    """Make a picture in XYZ that knows the white of its light.

    Parameters
    ----------
    spectrum : Spectrum
        The light.
    pixels : ndarray, shape (rows, columns, 3)
        X, Y, Z.

    Returns
    -------
    Picture
        In colour space "xyz"; its metadata names the light's white.
    """
    light_white = tuple(float(value) for value in white(spectrum))
    return Picture(pixels.astype(np.float32, copy=False), "xyz", {WHITE_KEY: light_white})


def _reference(task: Task) -> NDArray[np.floating]:
    """Scale, sample and add each wavelength by itself. Uses no symmetry."""
    wavelengths, weights = quadrature(task.spectrum, task.samples)
    source, (y, x) = task.source, task.grid.axes()
    total = np.zeros((*task.grid.shape, 3))
    for ratio, weight in zip(task.wavelength / wavelengths, weights, strict=True):
        if isinstance(source, Pattern):
            scaled = _interpolated(source, ratio * y, ratio * x, task.interpolation)
        else:
            scaled = np.broadcast_to(source(ratio * x[None, :], ratio * y[:, None]), task.grid.shape)
        total += ratio**2 * scaled[:, :, None] * weight
    return total


def _interpolated(
    pattern: Pattern, y: NDArray[np.float64], x: NDArray[np.float64], interpolation: str
) -> NDArray[np.float64]:
    """Interpolate at rows y and columns x: Σ_mn h(y − m) P_mn h(x − n), the definition itself."""
    kernel = _tent if interpolation == "linear" else _catmull_rom
    places_y, places_x = index_positions(pattern.grid, y, x)
    rows = kernel(places_y[:, None] - np.arange(pattern.grid.shape[0]))
    columns = kernel(places_x[:, None] - np.arange(pattern.grid.shape[1]))
    values = np.asarray(rows @ pattern.intensity.astype(np.float64) @ columns.T)
    return np.maximum(values, 0.0) if interpolation == "cubic" else values


def _tent(t: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.maximum(1.0 - np.abs(t), 0.0)


def _catmull_rom(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Evaluate the kernel of Keys 1981, Eq. 15 (a = −1/2)."""
    s = np.abs(t)
    inner = (1.5 * s - 2.5) * s * s + 1.0
    outer = ((-0.5 * s + 2.5) * s - 4.0) * s + 2.0
    return np.where(s <= 1.0, inner, np.where(s < 2.0, outer, 0.0))


def _source(
    pattern: Pattern | NDArray[np.floating] | Analytic, wavelength: float | None
) -> tuple[Pattern | Analytic, float]:
    """Check the pattern and find its wavelength."""
    own = pattern.wavelength if isinstance(pattern, Pattern) else None
    if wavelength is None and own is None:
        raise refuse.Refusal("'reference_wavelength' is needed, in metres: only a Pattern knows its own.")
    chosen = refuse.positive("reference_wavelength", own if wavelength is None else wavelength)  # type: ignore[arg-type]
    if own is not None and abs(own - chosen) > 1e-6 * own:
        raise refuse.Refusal(
            f"'reference_wavelength' is {chosen:g} but the pattern's own is {own:g}; give None to use that."
        )
    if callable(pattern):
        return pattern, chosen
    intensity = pattern.intensity if isinstance(pattern, Pattern) else pattern
    values = refuse.all_finite("pattern", refuse.shape_of("pattern", intensity, (None, None)))
    if isinstance(pattern, Pattern):
        _checked_grid("pattern", pattern.grid)
        refuse.shape_of("pattern", intensity, pattern.grid.shape)
        return pattern, chosen
    shape = (values.shape[0], values.shape[1])
    return Pattern(values, Grid(shape, (1.0, 1.0)), chosen, float(values.sum())), chosen


def _target(source: Pattern | Analytic, grid: Grid | None, symmetric: bool) -> Grid:
    """Check the output grid, or take the pattern's own."""
    if grid is None:
        if not isinstance(source, Pattern):
            raise refuse.Refusal("'grid' is needed where the pattern is a callable.")
        grid = source.grid
    _checked_grid("grid", grid)
    if symmetric and grid.centre != (0.0, 0.0):
        raise refuse.Refusal(f"'symmetric' needs a 'grid' centred on zero, got its centre at {grid.centre}.")
    return grid


def _checked_grid(name: str, grid: Grid) -> None:
    for axis, count, step, centre in zip(("y", "x"), grid.shape, grid.spacing, grid.centre, strict=True):
        refuse.at_least(f"{name}.shape ({axis})", count, 1)
        refuse.positive(f"{name}.spacing ({axis})", step)
        refuse.finite(f"{name}.centre ({axis})", centre)


def _choice(task: Task) -> str:
    """Return the cheaper method that serves, by costs that `benchmarks/spectral_sum.py --fit` measures."""
    if not isinstance(task.source, Pattern):
        return "reference"
    if refusal(task):
        return "full"
    crossings, pixels = counts(task)
    by_rays = RAYS_START + RAYS_CROSSING * crossings + RAYS_PIXEL * pixels
    return "rays" if by_rays < LOOK_UP[task.interpolation] * look_ups(task) else "full"


METHODS = {"reference": _reference, "full": full, "batch": batch, "rays": rays}
