"""The far field of a mask by fast transforms: its DFT at the wanted frequencies, times the pixel's sinc.

A mask's pixels are small squares, so its continuous transform is its discrete one times
sinc(u p) sinc(v p), exactly. The discrete one is taken at any regular set of frequencies by the
chirp-z transform (L. Bluestein, 1970), or by a plain FFT where the frequencies are its own. Pixels
may have a phase of their own, from a wavefront.
"""

import os
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction.cosines import cosines_field, cosines_power, cosines_serve
from aureole.records import Aperture, Grid

# How far a frequency may lie from the FFT's own, in steps.
ON_GRID = 1e-6
NEEDS_RASTER = "a transform of pixels needs a raster; rasterize the outlines first."


def chirpz_field(aperture: Aperture, grid: Grid, wavelength: float | None = None) -> NDArray[np.complex64]:
    """Return a raster's far field by a chirp-z transform along each axis.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre, any spacing, any centre.
    wavelength : float, optional
        Metres; an aperture with a wavefront needs it.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Square metres.
    """
    turned, pixel = _chirped(aperture, grid, wavelength)
    v, u = grid.axes()
    out = np.ascontiguousarray(turned.T)
    out *= (pixel * np.sinc(v * pixel)).astype(np.float32)[:, None]
    out *= (pixel * np.sinc(u * pixel)).astype(np.float32)
    return out


def chirpz_power(aperture: Aperture, grid: Grid, wavelength: float | None = None) -> NDArray[np.float32]:
    """Return the power |F|² of a raster's far field by a chirp-z transform along each axis.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre, any spacing, any centre.
    wavelength : float, optional
        As for `chirpz_field`.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Square metres, squared.
    """
    from aureole.diffraction import _kernels_fft  # compiled code: loaded when first used

    field, pixel = _chirped(aperture, grid, wavelength)
    y, x = (((pixel * np.sinc(axis * pixel)) ** 2).astype(np.float32) for axis in grid.axes())
    turned = np.empty(grid.shape[::-1], dtype=np.float32)
    _kernels_fft.square(field, x, y, turned)
    return np.ascontiguousarray(turned.T)


def _chirped(aperture: Aperture, grid: Grid, wavelength: float | None) -> tuple[NDArray[np.complex64], float]:
    """Return the discrete transform of a mask at any frequencies, columns first, and a pixel's size."""
    mask, pixel = _mask_of(aperture, wavelength)
    v, u = grid.axes()
    lit = np.flatnonzero(mask.any(axis=1))
    # Only rows with light in them are transformed along x.
    across = np.zeros((len(mask), grid.shape[1]), dtype=np.complex64)
    across[lit] = chirp(mask[lit], pixel, u[0], grid.spacing[1], len(u))
    return chirp(np.ascontiguousarray(across.T), pixel, v[0], grid.spacing[0], len(v)), pixel


def fft_field(aperture: Aperture, grid: Grid, wavelength: float | None = None) -> NDArray[np.complex64]:
    """Return a raster's far field at frequencies that a plain FFT has.

    Parameters
    ----------
    aperture : Aperture
        A raster of n × n pixels of size p.
    grid : Grid
        Frequencies whose spacing is 1 / (N p) for a whole number N, and whose centre is a multiple
        of the spacing; any number of them.
    wavelength : float, optional
        Metres; an aperture with a wavefront needs it.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Square metres.

    Raises
    ------
    refuse.Refusal
        Where the frequencies are not an FFT's own.
    """
    lengths = _own_lengths(aperture, grid)
    if aperture.wavefront is None and cosines_serve(aperture, grid, lengths):
        return cosines_field(aperture, grid, lengths)
    from aureole.diffraction import _kernels_fft  # compiled code: loaded when first used

    spectrum, first, axes, pixel = _spectrum(aperture, grid, lengths, wavelength)
    # The first pixel's centre lies at (p − width) / 2, not at the origin.
    shift = (pixel - aperture.width) / 2
    y, x = ((_turns(-axis * shift) * pixel * np.sinc(axis * pixel)).astype(np.complex64) for axis in axes)
    out = np.empty(grid.shape, dtype=np.complex64)
    _kernels_fft.fill_field(spectrum, first, lengths[1], y, x, out)
    return out


def fft_power(aperture: Aperture, grid: Grid, wavelength: float | None = None) -> NDArray[np.float32]:
    """Return the power |F|² of a raster's far field at frequencies that a plain FFT has, without F.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies as for `fft_field`.
    wavelength : float, optional
        As for `fft_field`.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Square metres, squared.

    Raises
    ------
    refuse.Refusal
        Where the frequencies are not an FFT's own.
    """
    lengths = _own_lengths(aperture, grid)
    if aperture.wavefront is None and cosines_serve(aperture, grid, lengths):
        return cosines_power(aperture, grid, lengths)
    from aureole.diffraction import _kernels_fft  # compiled code: loaded when first used

    spectrum, first, axes, pixel = _spectrum(aperture, grid, lengths, wavelength)
    y, x = (((pixel * np.sinc(axis * pixel)) ** 2).astype(np.float32) for axis in axes)
    out = np.empty(grid.shape, dtype=np.float32)
    _kernels_fft.fill_power(spectrum, first, lengths[1], y, x, out)
    return out


def fft_lengths(aperture: Aperture, grid: Grid) -> tuple[int, int] | None:
    """Return the FFT lengths (rows, columns) whose own frequencies a grid has, or None.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre.

    Returns
    -------
    tuple of int or None
        None where the frequencies are not an FFT's own.
    """
    if aperture.mask is None:
        raise refuse.Refusal(NEEDS_RASTER)
    pixel = aperture.width / len(aperture.mask)
    lengths = []
    for count, spacing, centre in zip(grid.shape, grid.spacing, grid.centre, strict=True):
        length = 1 / (spacing * pixel)
        offset = centre / spacing
        drift = abs(length - round(length)) / length * (count // 2 + 1 + abs(offset))
        if round(length) < 1 or drift > ON_GRID or abs(offset - round(offset)) > ON_GRID:
            return None
        lengths.append(round(length))
    return lengths[0], lengths[1]


def _mask_of(aperture: Aperture, wavelength: float | None) -> tuple[NDArray[Any], float]:
    """Return what each pixel lets through, complex where it has a phase, and a pixel's size."""
    if aperture.mask is None:
        raise refuse.Refusal(NEEDS_RASTER)
    values = apertures.transmittance(aperture, wavelength)
    if np.iscomplexobj(values):
        values = values.astype(np.complex64)
    return values, aperture.width / len(values)


def _with_pixel(
    values: NDArray[np.complex64], u: NDArray[np.float64], v: NDArray[np.float64], pixel: float
) -> NDArray[np.complex64]:
    """Multiply by the transform of one pixel."""
    out = np.ascontiguousarray(values)
    out *= (pixel * np.sinc(v * pixel)).astype(np.float32)[:, None]
    out *= (pixel * np.sinc(u * pixel)).astype(np.float32)
    return out


def chirp(
    rows: NDArray[Any], pixel: float, start: float, step: float, count: int, double: bool = False
) -> NDArray[Any]:
    """Sum exp(−i2π f_j x_k) over the samples of each row, x_k the centres of its pixels.

    Parameters
    ----------
    rows : ndarray, shape (R, n)
        Samples at x_k = (k + 1/2 − n/2) pixel.
    pixel : float
        Distance of samples, metres.
    start, step : float
        Frequencies f_j = start + j step, cycles per metre.
    count : int
        Number of frequencies.
    double : bool
        Whether to compute in double precision.

    Returns
    -------
    ndarray of complex64, or of complex128, shape (R, count)
        The sums.
    """
    size, kind = rows.shape[1], np.complex128 if double else np.complex64
    before, spectrum, after, length = _chirp_tables(size, pixel, start, step, count, double)
    wave = np.zeros((len(rows), length), dtype=kind)
    wave[:, :size] = rows * before
    wave = fft.fft(wave, axis=1, workers=_workers(), overwrite_x=True)
    wave *= spectrum
    wave = fft.ifft(wave, axis=1, workers=_workers(), overwrite_x=True)
    return np.asarray(wave[:, size - 1 : size - 1 + count] * after)


@lru_cache(maxsize=8)
def _chirp_tables(
    size: int, pixel: float, start: float, step: float, count: int, double: bool
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], int]:
    """Return Bluestein's factors: jk = (j² + k² − (j − k)²) / 2."""
    rate, kind = step * pixel, np.complex128 if double else np.complex64
    k, j = np.arange(size), np.arange(count)
    first = (0.5 - size / 2) * pixel
    before = _turns(-(start * (first + k * pixel) + rate * k**2 / 2))
    after = _turns(-(j * step * first + rate * j**2 / 2))
    lags = np.arange(-(size - 1), count)
    length = fft.next_fast_len(size + count - 1)
    wave = np.zeros(length, dtype=kind)
    wave[: len(lags)] = _turns(rate * lags.astype(np.float64) ** 2 / 2)
    return before.astype(kind), fft.fft(wave), after.astype(kind), length


def _turns(turns: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return exp(i2π turns), whole turns taken off first."""
    return np.asarray(np.exp(2j * np.pi * (turns - np.rint(turns))))


def _own_lengths(aperture: Aperture, grid: Grid) -> tuple[int, int]:
    lengths = fft_lengths(aperture, grid)
    if lengths is None:
        raise refuse.Refusal(
            "method 'fft' needs a spacing of 1 / (N pixels) with a whole N and a centre that is a "
            "multiple of it; use method 'chirpz', which takes any grid."
        )
    return lengths


def _spectrum(
    aperture: Aperture, grid: Grid, lengths: tuple[int, int], wavelength: float | None
) -> tuple[NDArray[np.complex64], tuple[int, int], tuple[NDArray[np.float64], NDArray[np.float64]], float]:
    """Return the spectrum of a mask, the grid's first frequency in steps, the axes, and a pixel's size.

    Only half of the columns of a real mask's spectrum.
    """
    mask, pixel = _mask_of(aperture, wavelength)
    folded = _fold(_fold(mask, lengths[0], 0), lengths[1], 1)
    transform = fft.fft2 if np.iscomplexobj(folded) else fft.rfft2
    v, u = grid.axes()
    first = round(v[0] / grid.spacing[0]), round(u[0] / grid.spacing[1])
    return np.asarray(transform(folded, workers=_workers())), first, (v, u), pixel


def _fold(mask: NDArray[Any], length: int, axis: int) -> NDArray[Any]:
    """Pad a mask with zeros to a length, or add up its repeats where it is longer."""
    size = mask.shape[axis]
    if size == length:
        return mask
    repeats = -(-size // length)
    pad = [(0, 0), (0, 0)]
    pad[axis] = (0, repeats * length - size)
    padded = np.pad(mask, pad)
    if repeats == 1:
        return padded
    shape = list(padded.shape)
    shape[axis : axis + 1] = [repeats, length]
    return np.asarray(padded.reshape(shape).sum(axis=axis, dtype=mask.dtype))


def _workers() -> int:
    return os.cpu_count() or 1
