"""The spectral sum: a pattern at one wavelength, scaled to every wavelength of a light and added up.

Diffraction patterns scale with wavelength. Where P_r is the pattern at the reference wavelength λ_r
over frequency q, the colour at q is (Scandolo, Lee and Eisemann 2019, Eq. 14-16)

    S_c(q) = Σ_λ w_c(λ) ρ(λ)² P_r(ρ(λ) q),    ρ(λ) = λ_r / λ,

with the weights w_c of `observer.quadrature`. The square keeps the energy: over an infinite plane
each channel holds the pattern's energy times the light's white, whose luminance is 1.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.light.observer import quadrature, white
from aureole.light.spaces import WHITE_KEY
from aureole.records import Grid, Pattern, Picture, Spectrum

Analytic = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

DEFAULT_SAMPLES = 60
TAPS = {"linear": 2, "cubic": 4}  # samples of the pattern that one interpolated value takes an axis


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
    method : {"auto", "full", "reference"}
        "reference" adds in float64 without any haste; "full" does the same in float32, fast. "auto"
        takes "full" wherever there are samples to interpolate.
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
    """
    refuse.one_of("method", method, ("auto", *METHODS))
    refuse.one_of("interpolation", interpolation, TAPS)
    source, wavelength = _source(pattern, reference_wavelength)
    target = _target(source, grid, symmetric)
    wavelengths, weights = quadrature(spectrum, samples)
    ratios = wavelength / wavelengths
    if method == "auto":
        method = "full" if isinstance(source, Pattern) else "reference"
    pixels = METHODS[method](source, target, ratios, weights, interpolation, symmetric)
    light_white = tuple(float(value) for value in white(spectrum))
    return Picture(pixels.astype(np.float32, copy=False), "xyz", {WHITE_KEY: light_white})


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
    wavelengths, weights = quadrature(spectrum, samples)
    out = np.empty((len(rows), len(columns), 3), dtype=np.float32)
    _adder(pattern, pattern.wavelength / wavelengths, weights, TAPS[interpolation])(rows, columns, out)
    return out


def _reference(
    source: Pattern | Analytic,
    grid: Grid,
    ratios: NDArray[np.float64],
    weights: NDArray[np.float64],
    interpolation: str,
    symmetric: bool,
) -> NDArray[np.floating]:
    """Scale, sample and add each wavelength by itself. Uses no symmetry."""
    y, x = grid.axes()
    total = np.zeros((*grid.shape, 3))
    for ratio, weight in zip(ratios, weights, strict=True):
        if isinstance(source, Pattern):
            scaled = _interpolated(source, ratio * y, ratio * x, interpolation)
        else:
            scaled = np.broadcast_to(source(ratio * x[None, :], ratio * y[:, None]), grid.shape)
        total += ratio**2 * scaled[:, :, None] * weight
    return total


def _interpolated(
    pattern: Pattern, y: NDArray[np.float64], x: NDArray[np.float64], interpolation: str
) -> NDArray[np.float64]:
    """Interpolate at rows y and columns x: Σ_mn h(y − m) P_mn h(x − n), the definition itself."""
    kernel = _tent if interpolation == "linear" else _catmull_rom
    places_y, places_x = _index_positions(pattern.grid, y, x)
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


def _full(
    source: Pattern | Analytic,
    grid: Grid,
    ratios: NDArray[np.float64],
    weights: NDArray[np.float64],
    interpolation: str,
    symmetric: bool,
) -> NDArray[np.floating]:
    """Add all wavelengths row by row in float32."""
    if not isinstance(source, Pattern):
        raise refuse.Refusal(
            "'method' 'full' interpolates a sampled pattern; use 'reference' for a callable."
        )
    add = _adder(source, ratios, weights, TAPS[interpolation])
    (y, x), (rows, columns) = grid.axes(), grid.shape
    pixels = np.empty((rows, columns, 3), dtype=np.float32)
    if not symmetric:
        add(y, x, pixels)
        return pixels
    centre = rows // 2
    add(y[: centre + 1], x, pixels[: centre + 1])
    # Turn the upper half by 180°. At even sizes the first column has no partner.
    below, lone = rows - centre - 1, 1 - columns % 2
    pixels[centre + 1 :, lone:] = pixels[centre - below : centre][::-1, lone:][:, ::-1]
    if lone and below:
        edge = np.empty((below, 1, 3), dtype=np.float32)
        add(y[centre + 1 :], x[:1], edge)
        pixels[centre + 1 :, :1] = edge
    return pixels


def _adder(
    pattern: Pattern, ratios: NDArray[np.float64], weights: NDArray[np.float64], taps: int
) -> Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.float32]], None]:
    """Prepare the pattern and the weights; return what fills the sum at rows y and columns x."""
    from aureole.light import _kernels  # compiled code: loaded when first used

    before, after, group = _kernels.BEFORE, _kernels.AFTER, _kernels.GROUP
    rows, columns = pattern.grid.shape
    padded = np.zeros((rows + before + after, columns + before + after), dtype=np.float32)
    padded[before:-after, before:-after] = pattern.intensity
    # Fill up the last group with wavelengths of no weight.
    spare = -ratios.size % group
    scales = np.concatenate([ratios, np.ones(spare)])
    parts = np.concatenate([weights * ratios[:, None] ** 2, np.zeros((spare, 3))]).astype(np.float32)

    def add(y: NDArray[np.float64], x: NDArray[np.float64], out: NDArray[np.float32]) -> None:
        places = _index_positions(pattern.grid, np.outer(scales, y), np.outer(scales, x))
        row_table, column_table = (
            _taps(place, count, before, taps) for place, count in zip(places, (rows, columns), strict=True)
        )
        _kernels.sum_wavelengths(padded, taps, *row_table, *column_table, parts, out)

    return add


def _taps(
    places: NDArray[np.float64], count: int, before: int, taps: int
) -> tuple[NDArray[np.uint32], NDArray[np.float32]]:
    """Split positions into the padded index of the first tap and the fraction; outside is clipped."""
    inside = np.clip(places, -2.0, count + 1.0)
    whole = np.floor(inside)
    first = whole + (before + 1 - taps // 2)
    return first.astype(np.uint32), (inside - whole).astype(np.float32)


def _index_positions(
    grid: Grid, y: NDArray[np.float64], x: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Turn frequencies into positions counted in samples of the grid."""
    rows = (y - grid.centre[0]) / grid.spacing[0] + grid.shape[0] // 2
    columns = (x - grid.centre[1]) / grid.spacing[1] + grid.shape[1] // 2
    return rows, columns


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


METHODS = {"reference": _reference, "full": _full}
