"""Bokeh: the structure of a sharp mirror, from a photograph of an out-of-focus highlight on it.

Out of focus, the spot of a small lamp shows the surface that it lies on (Toisoul and Ghosh 2017, section 5):
turn it by 90 degrees, take blue, undo the lens's blur, take dark for deep, and fit size and heights with a
grating that is known (Appendix C, Eq. 27). What a lens cannot resolve no step brings back: `abbe_limit`.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from aureole import refuse

BLUE = 2
BLUE_WAVELENGTH = 450e-9

Array = NDArray[np.float64]


def bokeh_profile(pixels: ArrayLike, quarter_turns: int = 1, channel: int = BLUE) -> Array:
    """Return one channel of a bokeh, turned upright.

    Parameters
    ----------
    pixels : array_like, shape (rows, columns, 3) or (rows, columns)
        Linear.
    quarter_turns : int
        Counter-clockwise; the paper's lens turned the grating by one.
    channel : int
        2 is blue, the sharpest.

    Returns
    -------
    ndarray of float64, shape (rows, columns) or turned
        The channel.

    Raises
    ------
    refuse.Refusal
        Where the pixels are no picture, or are below zero.
    """
    values = refuse.all_finite("pixels", pixels)
    if values.ndim == 3 and 0 <= channel < values.shape[2]:
        values = values[..., channel]
    refuse.shape_of("pixels", values, (None, None))
    if values.min() < 0:
        raise refuse.Refusal(f"'pixels' must not be below 0, got {values.min():g}; subtract the black level.")
    return np.ascontiguousarray(np.rot90(values, quarter_turns), dtype=np.float64)


def richardson_lucy(blurred: ArrayLike, deviation: float, iterations: int = 30) -> Array:
    """Undo a Gaussian blur by Richardson's and Lucy's iteration, which keeps light positive.

    It is scikit-image's, with borders mirrored far enough that an even picture stays even.

    Parameters
    ----------
    blurred : array_like, shape (rows, columns)
        At least 0.
    deviation : float
        Standard deviation of the blur, pixels.
    iterations : int
        At least 1; more sharpen further and lift noise.

    Returns
    -------
    ndarray of float64, shape (rows, columns)
        Sharpened.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    # Starting the program should not wait for it.
    from skimage import restoration

    seen = np.asarray(refuse.all_finite("blurred", refuse.shape_of("blurred", blurred, (None, None))), float)
    refuse.positive("deviation", deviation)
    refuse.at_least("iterations", iterations, 1)
    if seen.min() < 0:
        raise refuse.Refusal(f"'blurred' must not be below 0, got {seen.min():g}.")
    mean = float(seen.mean())
    if mean == 0.0:
        return seen.copy()
    reach = math.ceil(4.0 * deviation)
    places = np.arange(-reach, reach + 1) / deviation
    line = np.exp(-0.5 * places**2)
    blur = np.outer(line, line) / line.sum() ** 2
    # What borders of zeros do seeps inward by a blur's width for each few steps.
    margin = reach * math.ceil(2.0 + math.sqrt(iterations))
    wide = np.pad(seen / mean, margin, mode="symmetric")
    sharp = restoration.richardson_lucy(wide, blur, iterations, clip=False)  # type: ignore[no-untyped-call]
    inside = sharp[margin : margin + seen.shape[0], margin : margin + seen.shape[1]]
    return np.maximum(np.asarray(inside, dtype=np.float64) * mean, 0.0)


def fit_heights(profile: ArrayLike, known: ArrayLike) -> tuple[float, float, float]:
    """Fit a known height profile by a measured one: minimise Σ (known − a (profile − b))² (Eq. 27).

    Parameters
    ----------
    profile : array_like, shape (N,)
        Measured brightness.
    known : array_like, shape (N,)
        Heights at the same places, metres.

    Returns
    -------
    a : float
        Metres for a unit of brightness.
    b : float
        Brightness of height 0.
    error : float
        Root mean square of what is left over the range of the known heights.

    Raises
    ------
    refuse.Refusal
        Where the profile is even, or the shapes differ.
    """
    x = np.asarray(refuse.all_finite("profile", refuse.shape_of("profile", profile, (None,))), dtype=float)
    y = np.asarray(refuse.all_finite("known", refuse.shape_of("known", known, (x.size,))), dtype=float)
    spread = x - x.mean()
    if not spread.any() or np.ptp(y) == 0:
        raise refuse.Refusal("'profile' and 'known' must vary: an even one fits no grating.")
    a = float(spread @ (y - y.mean()) / (spread @ spread))
    if a == 0.0:
        raise refuse.Refusal("'profile' has nothing in common with 'known'; align them first.")
    b = float(x.mean() - y.mean() / a)
    left = y - a * (x - b)
    return a, b, float(np.sqrt(np.mean(left**2)) / np.ptp(y))


def count_lines(profile: ArrayLike) -> float:
    """Count the lines across a bokeh: how many periods of a grating are lit (section 6.1).

    Parameters
    ----------
    profile : array_like, shape (N,)
        Brightness across the lines, from one border of the bokeh to the other.

    Returns
    -------
    float
        Periods over the profile, with fractions.

    Raises
    ------
    refuse.Refusal
        Where the profile is even or shorter than 8.
    """
    x = np.asarray(refuse.all_finite("profile", refuse.shape_of("profile", profile, (None,))), dtype=float)
    if x.size < 8 or np.ptp(x) == 0:
        raise refuse.Refusal("'profile' needs 8 samples or more that vary.")
    window = np.hanning(x.size + 2)[1:-1]
    # Sixteen-fold padding finds the peak between whole periods.
    power = np.abs(fft.rfft((x - np.average(x, weights=window)) * window, 16 * x.size))
    lowest = 24  # One and a half periods: below, a window's own lobe stands.
    peak = lowest + int(np.argmax(power[lowest:-1]))
    low, top, high = power[peak - 1 : peak + 2]
    bend = low - 2.0 * top + high
    return float((peak + (0.5 * (low - high) / bend if bend else 0.0)) / 16.0)


def pixel_pitch(lines: float, period: float, pixels: int) -> float:
    """Return what a pixel of a bokeh means on the surface, from a grating whose period is known.

    Parameters
    ----------
    lines : float
        Periods that were counted.
    period : float
        Of the grating, metres.
    pixels : int
        Over which they were counted.

    Returns
    -------
    float
        Metres a pixel.
    """
    refuse.positive("lines", lines)
    return lines * refuse.positive("period", period) / refuse.at_least("pixels", pixels, 1)


def abbe_limit(
    distance: float, focal_length: float, f_number: float, wavelength: float = BLUE_WAVELENGTH
) -> float:
    """Return the finest period on a surface that a lens can show at all: λ / 2 NA, in incoherent light.

    Parameters
    ----------
    distance : float
        From the surface to the lens, metres.
    focal_length : float
        Metres.
    f_number : float
        Focal length over the aperture's diameter.
    wavelength : float
        Metres.

    Returns
    -------
    float
        Metres. Coherent light, as of a small lamp in a mirror, needs twice that.
    """
    radius = 0.5 * refuse.positive("focal_length", focal_length) / refuse.positive("f_number", f_number)
    aperture = math.sin(math.atan(radius / refuse.positive("distance", distance)))
    return refuse.positive("wavelength", wavelength) / (2.0 * aperture)


def abbe_note(period: float, limit: float) -> str | None:
    """Return a warning where a structure is finer than a lens can show.

    Parameters
    ----------
    period : float
        Of the structure, metres.
    limit : float
        From `abbe_limit`.

    Returns
    -------
    str or None
        One sentence, or None where the lens suffices in coherent light, too.
    """
    if period >= 2.0 * refuse.positive("limit", limit):
        return None
    means = "cannot be seen" if period < limit else "may be seen faintly or not at all"
    return (
        f"A period of {period * 1e6:.3g} µm {means}: the lens ends at {limit * 1e6:.3g} µm "
        f"({2e6 * limit:.3g} µm in coherent light); take the result as a likeness."
    )
