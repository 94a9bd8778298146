"""The discrete near field: samples of the opening convolved by FFT, in a frame of zeros.

Two ways: with samples of the impulse response exp(iπr² / (λz)) / (iλz), which alias where its phase turns
by more than half a cycle a sample, at short distances; and with samples of its transform, the transfer
function exp(−iπλz(u² + v²)), which alias at long ones (D. G. Voelz, "Computational Fourier optics", 2011,
chapter 5). Both take the light round the frame to be periodic.
"""

import math
from collections.abc import Callable

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from aureole.bench.timing import workers

Convolution = Callable[[NDArray[np.float32], float, float, float, int], NDArray[np.complex64]]


def impulse_response(
    mask: NDArray[np.float32], width: float, distance: float, wavelength: float, padding: int = 2
) -> NDArray[np.complex64]:
    """Return the near field of samples with the sampled impulse response, as textbooks write it.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Transmittance.
    width : float
        Of the mask, metres.
    distance, wavelength : float
        Metres.
    padding : int
        The frame's width, of the mask's; with 2 and more nothing reaches round it.

    Returns
    -------
    ndarray of complex64, shape (n, n)
        D, without unit, at the mask's own samples.
    """
    line = _response(len(mask), width, distance, wavelength, padding).astype(np.complex64)
    kernel = scipy.fft.fft2(line[:, None] * line, workers=workers(), overwrite_x=True)
    spectrum = _spectrum(mask, padding)
    spectrum *= kernel
    return _back(spectrum, len(mask))


def impulse_response_by_axes(
    mask: NDArray[np.float32], width: float, distance: float, wavelength: float, padding: int = 2
) -> NDArray[np.complex64]:
    """Return what `impulse_response` does, the response's transform as a product of two lines'.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Transmittance.
    width : float
        Of the mask, metres.
    distance, wavelength : float
        Metres.
    padding : int
        As for `impulse_response`.

    Returns
    -------
    ndarray of complex64, shape (n, n)
        As from `impulse_response`.
    """
    line = _response(len(mask), width, distance, wavelength, padding)
    return _by_axes(mask, scipy.fft.fft(line), padding)


def transfer_function(
    mask: NDArray[np.float32], width: float, distance: float, wavelength: float, padding: int = 2
) -> NDArray[np.complex64]:
    """Return the near field of samples with the sampled transfer function.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Transmittance.
    width : float
        Of the mask, metres.
    distance, wavelength : float
        Metres.
    padding : int
        The frame's width, of the mask's.

    Returns
    -------
    ndarray of complex64, shape (n, n)
        D, without unit, at the mask's own samples.
    """
    size = len(mask)
    frequencies = scipy.fft.fftfreq(padding * size, width / size)
    return _by_axes(mask, np.exp(-1j * np.pi * wavelength * distance * frequencies**2), padding)


def _response(
    size: int, width: float, distance: float, wavelength: float, padding: int
) -> NDArray[np.complex128]:
    """Return the impulse response of one direction times the spacing, the sample on the axis first."""
    spacing = width / size
    places = scipy.fft.fftfreq(padding * size, 1 / (padding * size)) * spacing
    phase = np.pi * places**2 / (wavelength * distance) - 0.25 * np.pi
    return np.asarray(spacing / math.sqrt(wavelength * distance) * np.exp(1j * phase))


def _by_axes(mask: NDArray[np.float32], line: NDArray[np.complex128], padding: int) -> NDArray[np.complex64]:
    spectrum, cast = _spectrum(mask, padding), line.astype(np.complex64)
    spectrum *= cast
    spectrum *= cast[:, None]
    return _back(spectrum, len(mask))


def _spectrum(mask: NDArray[np.float32], padding: int) -> NDArray[np.complex64]:
    side = padding * len(mask)
    found: NDArray[np.complex64] = scipy.fft.fft2(
        mask.astype(np.complex64), (side, side), workers=workers(), overwrite_x=True
    )
    return found


def _back(spectrum: NDArray[np.complex64], size: int) -> NDArray[np.complex64]:
    found: NDArray[np.complex64] = scipy.fft.ifft2(spectrum, workers=workers(), overwrite_x=True)
    return found[:size, :size]
