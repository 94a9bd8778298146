"""The discrete fractional Fourier transform, and the near field by it: the quad paper's rival on processors.

H. M. Ozaktas, O. Arıkan, M. A. Kutay, G. Bozdağı, "Digital computation of the fractional Fourier
transform", IEEE Transactions on Signal Processing 44 (9), 1996: a multiplication by a chirp, a convolution
with a chirp by FFT, a multiplication by a chirp, on samples twice as fine as those given.

With φ = aπ/2, order a of f is F_a(x) = A ∫ f(t) exp(iπ(x² cot φ − 2 x t csc φ + t² cot φ)) dt,
A = √(1 − i cot φ); order 1 is the Fourier transform. N samples lie 1/√N apart, about sample N // 2.

Fresnel diffraction is such a transform of an order that depends on the distance, on a plane that grows with
it. On a window of width W, t = x √N / W and tan φ = N λz / W²; the plane's samples lie 1 / cos φ times as
far apart as the window's, where the field is √cos φ exp(−iφ/2) F_a exp(iπ x² tan φ) in each direction.
The order goes from 0 at the opening to 1 far away.
"""

import math

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from aureole.bench.timing import workers

# Between these orders, chirps of samples twice as fine do not alias.
LEAST, MOST = 0.5, 1.5


def fractional(values: NDArray[np.complexfloating], order: float) -> NDArray[np.complexfloating]:
    """Return the fractional Fourier transform of a picture, along rows and along columns.

    Parameters
    ----------
    values : ndarray of complex, shape (n, n)
        Samples 1 / √n apart, (n // 2, n // 2) at the origin.
    order : float
        0 leaves all as it is, 1 is the Fourier transform, 2 turns it about, 4 is 0 again.

    Returns
    -------
    ndarray of complex, shape (n, n)
        At the same places, in the same precision.
    """
    # Orders between 0 and 1 are reached from one Fourier transform more or less.
    turns = round(order)
    rest = order - turns
    for axis in (1, 0):
        if rest == 0:
            values = _whole(values, turns, axis)
        else:
            extra = 1 if rest > 0 else -1
            values = _chirped(_whole(values, turns + extra, axis), rest - extra, axis)
    return values


def fresnel_order(size: int, width: float, distance: float, wavelength: float) -> float:
    """Return the order that is Fresnel diffraction.

    Parameters
    ----------
    size : int
        Samples of the window on each side.
    width : float
        Of the window, metres.
    distance, wavelength : float
        Metres.

    Returns
    -------
    float
        Between 0 and 1. With the Fresnel number N_F = (W/2)² / (λz) of the window,
        tan(order · π/2) = size / (4 N_F).
    """
    return math.atan2(size * wavelength * distance, width**2) / (0.5 * math.pi)


def fractional_near(
    mask: NDArray[np.float32], width: float, distance: float, wavelength: float
) -> tuple[NDArray[np.complex64], float]:
    """Return the near field of a mask by a fractional Fourier transform, and the spacing of its samples.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Transmittance; samples, sample (n // 2, n // 2) on the axis.
    width : float
        Of the mask, metres.
    distance, wavelength : float
        Metres.

    Returns
    -------
    field : ndarray of complex64, shape (n, n)
        D, without unit; sample (n // 2, n // 2) on the axis.
    spacing : float
        Metres.
    """
    size = len(mask)
    order = fresnel_order(size, width, distance, wavelength)
    angle = 0.5 * math.pi * order
    field = fractional(mask.astype(np.complex64), order)
    places = _places(size)
    chirp = np.exp(1j * (np.pi * places**2 * math.tan(angle) - 0.5 * angle))
    chirp *= math.sqrt(math.cos(angle))
    for axis in (0, 1):
        field *= _along(chirp, field, axis)
    return field, width / size / math.cos(angle)


def _places(size: int) -> NDArray[np.float64]:
    return np.asarray((np.arange(size) - size // 2) / math.sqrt(size))


def _whole(values: NDArray[np.complexfloating], turns: int, axis: int) -> NDArray[np.complexfloating]:
    """Apply the Fourier transform along an axis so many times, about the middle sample."""
    for _ in range(turns % 4):
        shifted = scipy.fft.ifftshift(values, axes=axis)
        found = scipy.fft.fft(shifted, axis=axis, norm="ortho", workers=workers(), overwrite_x=True)
        values = scipy.fft.fftshift(found, axes=axis)
    return values


def _chirped(values: NDArray[np.complexfloating], order: float, axis: int) -> NDArray[np.complexfloating]:
    """Return the transform of an order between 1/2 and 3/2, of either sign, along an axis.

    Samples between the given ones are made by a sinc. The result is wanted at the given places only, so the
    convolution falls into one of the given samples and one of those between.
    """
    assert LEAST <= abs(order) <= MOST
    size = values.shape[axis]
    angle = 0.5 * math.pi * order
    tangent, cosecant = math.tan(0.5 * angle), 1 / math.sin(angle)
    places = _places(size)
    total = 0
    for shift in (0.0, 0.5):
        # A sample between lies half a spacing further on.
        lags = np.arange(1 - size, size + 1) - shift
        kernel = np.roll(np.exp(1j * np.pi * cosecant * lags**2 / size), 1 - size)
        chirp = np.exp(-1j * np.pi * tangent * (places + shift / math.sqrt(size)) ** 2)
        samples = _between(values, axis) if shift else values
        spectrum = scipy.fft.fft(
            samples * _along(chirp, values, axis), 2 * size, axis, workers=workers(), overwrite_x=True
        )
        spectrum *= _along(scipy.fft.fft(kernel), values, axis)
        total = total + spectrum
    found = scipy.fft.ifft(total, axis=axis, workers=workers(), overwrite_x=True)
    # √(1 − i cot φ), and the spacing of the finer samples.
    scale = np.sqrt(1 - 1j / math.tan(angle)) / (2 * math.sqrt(size))
    kept = found[:, :size] if axis else found[:size]
    return np.asarray(kept * _along(scale * np.exp(-1j * np.pi * tangent * places**2), values, axis))


def _between(values: NDArray[np.complexfloating], axis: int) -> NDArray[np.complexfloating]:
    """Return the samples half a spacing further on, by a shift of the spectrum."""
    size = values.shape[axis]
    ramp = np.exp(1j * np.pi * scipy.fft.fftfreq(size))
    spectrum = scipy.fft.fft(values, axis=axis, workers=workers())
    spectrum *= _along(ramp, values, axis)
    found: NDArray[np.complexfloating] = scipy.fft.ifft(
        spectrum, axis=axis, workers=workers(), overwrite_x=True
    )
    return found


def _along(
    line: NDArray[np.complex128], values: NDArray[np.complexfloating], axis: int
) -> NDArray[np.complexfloating]:
    """Return a line in the precision of a picture and along one of its axes."""
    cast = line.astype(values.dtype)
    return cast if axis else cast[:, None]
