"""An opening laid over itself, shifted: the transform of its far field's power.

    |F(q)|² = ∬ A(τ) exp(−i2π q·τ) dτ,   A(τ) = ∬ f(x + τ) f*(x) dx.

Divided by A(0) it is the optical transfer function. A mean of |F|² over a pixel of the plane multiplies
A by the pixel's own transform, a sinc, so that a picture of pixel integrals takes two transforms and no
sampling within the pixels. It is computed in double precision: what lies between the rays is below
1e-10 of the peak, and A holds both.

Pixels of a raster are small squares, so between whole shifts A is interpolated along straight lines,
exactly; the sinc of the plane's pixels is taken at the whole shifts.
"""

import os
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction.chirpz import chirp
from aureole.records import Aperture, Grid


def autocorrelation(aperture: Aperture, wavelength: float | None = None) -> NDArray[np.complex128]:
    """Return an opening's autocorrelation at shifts of whole pixels.

    Parameters
    ----------
    aperture : Aperture
        A raster of n × n pixels.
    wavelength : float, optional
        Metres; a wavefront needs it.

    Returns
    -------
    ndarray of complex128, shape (n, 2 n − 1)
        A in square metres. Row i is the shift of i pixels along y, column j that of j − n + 1 along x;
        A(−τ) is the conjugate of A(τ). Where the wavefront is flat it is real. Not to be written.

    Raises
    ------
    refuse.Refusal
        Where the aperture is no raster, or a wavefront cannot be served.
    """
    if aperture.mask is None:
        raise refuse.Refusal("an autocorrelation needs a raster; rasterize the outlines first.")
    return _correlated(aperture, wavelength if aperture.wavefront is not None else None)


def mean_power(aperture: Aperture, grid: Grid, wavelength: float | None = None) -> NDArray[np.float32]:
    """Return the mean of |F|² over each pixel of a grid.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre; each pixel is as large as the spacing.
    wavelength : float, optional
        Metres; a wavefront needs it.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Metres to the fourth. Right to 1e-3 where the grid's pixel spans a 32nd of the raster's own
        frequencies 1 / (its pixel), to 3e-2 where it spans an eighth: the sinc of the raster's pixel is
        taken at the centres.
    """
    shifted = autocorrelation(aperture, wavelength)
    size = len(shifted)
    pixel = aperture.width / size
    v, u = grid.axes()
    shifts = np.arange(1 - size, size) * pixel
    window_y, window_x = (np.sinc(shifts * spacing) for spacing in grid.spacing)
    # Shifts of −y are the conjugates of those of +y, so these count twice and the real part stays.
    window_y = window_y[size - 1 :] * np.where(np.arange(size) == 0, 1.0, 2.0)
    part = shifted * window_y[:, None] * window_x
    across = chirp(part, pixel, u[0], grid.spacing[1], len(u), double=True)
    down = chirp(np.ascontiguousarray(across.T), pixel, v[0], grid.spacing[0], len(v), double=True).T
    # The chirp's rows are centred on zero, and these begin there.
    middle = np.exp(-2j * np.pi * v * (size - 1) / 2 * pixel)
    power = down.real * middle.real[:, None] - down.imag * middle.imag[:, None]
    power *= (pixel * np.sinc(v * pixel) ** 2)[:, None] * (pixel * np.sinc(u * pixel) ** 2)
    # What is below zero is rounding.
    return np.asarray(np.maximum(power, 0), dtype=np.float32)


@lru_cache(maxsize=2)
def _correlated(aperture: Aperture, wavelength: float | None) -> NDArray[np.complex128]:
    """Correlate by padded Fourier transforms."""
    values = apertures.transmittance(aperture, wavelength)
    size, pixel = len(values), aperture.width / len(values)
    length, workers = fft.next_fast_len(2 * size - 1), os.cpu_count() or 1
    # Rows of padding are dark, and stay so.
    across = fft.fft(values.astype(np.complex128), length, axis=1, workers=workers)
    spectrum: Any = fft.fft(across, length, axis=0, workers=workers)
    power = spectrum.real**2 + spectrum.imag**2
    # The power is real, so its inverse transform is the conjugate of half a forward one.
    shifted: Any = fft.rfft2(power, axes=(1, 0), workers=workers)
    columns = np.arange(1 - size, size)
    out = np.conj(shifted[:size, columns]) * (pixel / length) ** 2
    out.setflags(write=False)
    return np.asarray(out)
