"""Height fields: the light that a rough mirror sends towards h, at one wavelength.

A height z delays the wave by k w z with k = 2π / λ and w = cos θ_i + cos θ_o, so the mirror is the phase
p = exp(i k w z) and its pattern is (Stam 1999; Toisoul and Ghosh 2017, Eq. 22)

    S(h) = <|P(h / λ)|²> / (4π² λ² A),    P the Fourier transform of p over a lit area A,

which holds all light: 4π² ∬ S dh = 1. METHODS say what stands for p: "exact" p itself; "taylor" its series in
k w z up to any order (Dhillon et al. 2014); "born" the first order of it, 1 + i k w z (Eq. 24); "amplitude"
takes the field for reflectances instead of heights, as of a black matrix.

The field repeats itself on all sides, so P is a set of orders; light that is in phase over a Gaussian window
only, of standard deviation a quarter of its coherence length, makes each order a Gaussian in h.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from aureole import refuse
from aureole.surface.gratings import normal_mean
from aureole.surface.order_sums import lobe_deviation

METHODS = ("exact", "born", "taylor", "amplitude")
# Coherence length of white light (Mashaal et al. 2012), as Toisoul and Ghosh 2017 use it.
COHERENCE = 65e-6
HIGHEST_ORDER = 60
# What of a pattern's light a series may put in the wrong place before a table says so.
TOLERANCE = 0.01

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class HeightField:
    """Heights on square pixels.

    Parameters
    ----------
    heights : ndarray of float64, shape (rows, columns)
        Metres; reflectances of the amplitude, 0 to 1, for the method "amplitude". Row 0 is the uppermost.
    pixel : float
        From sample to sample, metres.
    name : str
        What to call it in reports.
    """

    heights: Array
    pixel: float
    name: str = "height field"


def height_field(heights: ArrayLike, pixel: float, name: str = "height field") -> HeightField:
    """Make a height field from numbers.

    Parameters
    ----------
    heights : array_like, shape (rows, columns)
        Metres.
    pixel : float
        From sample to sample, metres.
    name : str
        What to call it in reports.

    Returns
    -------
    HeightField
        Float64.

    Raises
    ------
    refuse.Refusal
        Where a height is not finite or the pixel is not positive.
    """
    values = refuse.all_finite("heights", refuse.shape_of("heights", heights, (None, None)))
    return HeightField(np.array(values, dtype=np.float64), refuse.positive("pixel", pixel), name)


def order_powers(
    field: HeightField, wavelength: float, method: str = "exact", order: int = 1, cosines: float = 2.0
) -> Array:
    """Return the shares of the light in the orders of a field that repeats itself.

    Parameters
    ----------
    field : HeightField
        One period.
    wavelength : float
        Metres.
    method : {"exact", "born", "taylor", "amplitude"}
        What stands for exp(i k w z).
    order : int
        The last power of the series, for "taylor".
    cosines : float
        w = cos θ_i + cos θ_o.

    Returns
    -------
    ndarray of float64, shape (rows, columns)
        |c|² of each order, in the order of `scipy.fft.fftfreq`, rows downward.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    refuse.one_of("method", method, METHODS)
    refuse.positive("wavelength", wavelength)
    if method == "amplitude":
        reflected = field.heights.astype(np.complex128)
        if field.heights.min() < 0.0 or field.heights.max() > 1.0:
            raise refuse.Refusal("'heights' must be reflectances from 0 to 1 for method 'amplitude'.")
    else:
        highest = {"exact": 0, "born": 1, "taylor": order}[method]
        reflected = _reflected(phases(field, wavelength, cosines), method, highest)
    spectrum = fft.fft2(reflected, norm="forward", workers=2)
    return np.asarray(spectrum.real**2 + spectrum.imag**2)


def order_powers_at(
    field: HeightField, wavelengths: Array, method: str = "exact", order: int = 1, cosines: float = 2.0
) -> tuple[Array, Array]:
    """Return powers of orders at a few wavelengths, and how to mix them for many.

    |c|² is a polynomial in k = 2π / λ for a series, of twice its order, and all but one for exp(i k w z): it
    has no waves faster than the highest less the lowest z. So Chebyshev's points in k give all wavelengths.

    Parameters
    ----------
    field : HeightField
        One period.
    wavelengths : ndarray of float64, shape (W,)
        Metres.
    method, order, cosines : see there
        As for `order_powers`.

    Returns
    -------
    powers : ndarray of float64, shape (P, rows, columns)
        As of `order_powers`, P at most W.
    mixture : ndarray of float64, shape (W, P)
        The powers at wavelength k are Σ_p mixture[k, p] powers[p], to 1e-9 of the light.
    """
    if method == "amplitude":
        one = order_powers(field, float(wavelengths[0]), method)
        return one[None], np.ones((wavelengths.size, 1))
    low, high = 2.0 * np.pi / wavelengths.max(), 2.0 * np.pi / wavelengths.min()
    if method == "exact":
        count = _chebyshev_terms(0.5 * (high - low) * cosines * float(np.ptp(field.heights)))
    else:
        count = 2 * (order if method == "taylor" else 1) + 1
    if count >= wavelengths.size:
        chosen, mixture = wavelengths, np.eye(wavelengths.size)
    else:
        places = np.cos(np.pi * (np.arange(count) + 0.5) / count)
        chosen = 2.0 * np.pi / (0.5 * (high + low) + 0.5 * (high - low) * places)
        wanted = (2.0 * np.pi / wavelengths - 0.5 * (high + low)) / (0.5 * (high - low))
        scale = np.where(np.arange(count) > 0, 2.0, 1.0) / count
        mixture = (chebvander(wanted, count - 1) * scale) @ chebvander(places, count - 1).T
    powers = np.stack([order_powers(field, float(one), method, order, cosines) for one in chosen])
    return powers, np.asarray(mixture)


def _chebyshev_terms(reach: float) -> int:
    """Return how many Chebyshev polynomials give exp(i reach x) for x from −1 to 1 to 1e-10."""
    count = max(4, math.ceil(reach))
    # Coefficients are Bessel functions J_n(reach), below (e reach / 2n)ⁿ.
    while (0.5 * math.e * reach / count) ** count > 1e-10:
        count += 1
    return count


def phases(field: HeightField, wavelength: float, cosines: float = 2.0) -> Array:
    """Return k w z from the middle between the lowest and the highest, where a series converges soonest.

    Parameters
    ----------
    field : HeightField
        Heights.
    wavelength : float
        Metres.
    cosines : float
        w.

    Returns
    -------
    ndarray of float64, shape (rows, columns)
        Radians.
    """
    middle = 0.5 * (field.heights.min() + field.heights.max())
    return np.asarray(2.0 * np.pi / wavelength * cosines * (field.heights - middle))


def taylor_error(field: HeightField, wavelength: float, order: int, cosines: float = 2.0) -> float:
    """Return what share of a pattern's light a Taylor series puts in the wrong place.

    Parameters
    ----------
    field : HeightField
        Heights.
    wavelength : float
        Metres; the shortest is the worst.
    order : int
        The last power of the series.
    cosines : float
        w; 2 is the worst.

    Returns
    -------
    float
        Σ | |c_N|² − |c|² | over all orders, where the exact ones |c|² add up to 1; may be far above 1.
    """
    exact = order_powers(field, wavelength, "exact", cosines=cosines)
    return float(np.abs(order_powers(field, wavelength, "taylor", order, cosines) - exact).sum())


def taylor_order(
    field: HeightField, wavelength: float, tolerance: float = TOLERANCE, cosines: float = 2.0
) -> int:
    """Return the lowest order of a Taylor series that puts no more light than allowed in the wrong place.

    Parameters
    ----------
    field : HeightField
        Heights.
    wavelength : float
        Metres.
    tolerance : float
        The largest `taylor_error` allowed.
    cosines : float
        w.

    Returns
    -------
    int
        At least 1.

    Raises
    ------
    refuse.Refusal
        Where even order 60 does not serve; the exact method does.
    """
    refuse.positive("tolerance", tolerance)
    exact, phase = (
        order_powers(field, wavelength, "exact", cosines=cosines),
        phases(field, wavelength, cosines),
    )
    term = np.ones(phase.shape, np.complex128)
    total = term.copy()
    for order in range(1, HIGHEST_ORDER + 1):
        term *= 1j * phase / order
        total += term
        spectrum = fft.fft2(total, norm="forward", workers=2)
        if float(np.abs(spectrum.real**2 + spectrum.imag**2 - exact).sum()) <= tolerance:
            return order
    raise refuse.Refusal(
        f"A Taylor series of order {HIGHEST_ORDER} is still off by more than {tolerance:g}; "
        "use method 'exact', which has no such limit."
    )


def spread_orders(
    powers: Array,
    pixel: float,
    wavelength: float,
    t_cells: Array,
    b_cells: Array,
    coherence: float = COHERENCE,
) -> Array:
    """Return the mean of a pattern over cells of h, each order a Gaussian.

    Whole matrices for one wavelength: the reference of `order_sums.add_lobes`.

    Parameters
    ----------
    powers : ndarray of float64, shape (rows, columns)
        |c|² of `order_powers`.
    pixel : float
        Metres.
    wavelength : float
        Metres.
    t_cells, b_cells : ndarray of float64, shape (2, C) and (2, R)
        Lower and upper ends in h of the columns and of the rows.
    coherence : float
        Coherence length, metres; the window's σ is a quarter of it.

    Returns
    -------
    ndarray of float64, shape (R, C)
        S in 1/sr.
    """
    deviation = lobe_deviation(wavelength, coherence)
    along_t, columns = _lobes(powers.shape[1], pixel, wavelength, t_cells, deviation, 1.0)
    # Rows of the field run downward, b upward.
    along_b, rows = _lobes(powers.shape[0], pixel, wavelength, b_cells, deviation, -1.0)
    return np.asarray(along_b.T @ (powers[np.ix_(rows, columns)] @ along_t) / (4.0 * np.pi**2))


def _lobes(
    count: int, pixel: float, wavelength: float, cells: Array, deviation: float, sign: float
) -> tuple[Array, NDArray[np.int64]]:
    """Return the cells' shares (M, N) of those orders that reach them, and which orders these are."""
    centres = sign * wavelength * fft.fftfreq(count, pixel)
    reaching = np.flatnonzero(
        (centres > cells.min() - 6.0 * deviation) & (centres < cells.max() + 6.0 * deviation)
    )
    return normal_mean(cells, deviation, centres[reaching, None]), reaching


def _reflected(phase: Array, method: str, order: int) -> NDArray[np.complex128]:
    """Return what stands for exp(i phase)."""
    if method == "exact":
        return np.asarray(np.exp(1j * phase))
    refuse.at_least("order", order, 1)
    # Horner's rule: 1 + (x / 1)(1 + (x / 2)(1 + ...)).
    total = np.ones(phase.shape, np.complex128)
    for power in range(order, 0, -1):
        total = 1.0 + 1j * phase / power * total
    return total
