"""The far field of a mask at an FFT's own frequencies, from cosine and sine transforms.

A mask is folded about its centre, along both axes, into even and odd parts (`rows.fold`). Each is a
quadrant of real values whose transform has cosines or sines only, so there is no phase to turn, and a
mirror-symmetric mask leaves half of the quadrants empty. The transforms of all four take as long as a
real FFT of the whole plane.
"""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from aureole.diffraction.rows import fold, sample
from aureole.records import Aperture, Grid

# From this many times the mask's samples on, a real FFT transforms mostly zeros.
LONGER = 2


def cosines_serve(aperture: Aperture, grid: Grid, lengths: tuple[int, int]) -> bool:
    """Say whether a far field is within reach of these transforms, and they are faster than a real FFT.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre.
    lengths : tuple of int
        Lengths (rows, columns) of the FFT whose own they are.

    Returns
    -------
    bool
        True where mask and lengths are even, no frequency is beyond half a cycle per pixel, the grid is
        centred on zero, the lengths have no prime factor above 5, and the mask is symmetric or the
        lengths are longer than it, so that a real FFT would transform many zeros.
    """
    if aperture.mask is None or len(aperture.mask) % 2 or grid.centre != (0.0, 0.0):
        return False
    size = len(aperture.mask)
    fitting = all(
        length % 2 == 0 and length >= max(size, 2 * (count // 2)) and _is_smooth(length)
        for length, count in zip(lengths, grid.shape, strict=True)
    )
    return fitting and (lengths[0] * lengths[1] > LONGER * size**2 or sample(aperture.mask)[0] <= 2)


def cosines_field(aperture: Aperture, grid: Grid, lengths: tuple[int, int]) -> NDArray[np.complex64]:
    """Return a raster's far field where `cosines_serve`.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre.
    lengths : tuple of int
        Lengths (rows, columns) of the FFT whose own they are.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Square metres.
    """
    from aureole.diffraction import _kernels_cosines  # compiled code: loaded when first used

    out = np.empty(grid.shape, dtype=np.complex64)
    spectra, odd, along, works = _half_done(aperture, grid, lengths)
    plane = _plane(aperture, grid, lengths[0], 1)
    _kernels_cosines.field_along_x(spectra, odd, along, plane, works, out)
    return out


def cosines_power(aperture: Aperture, grid: Grid, lengths: tuple[int, int]) -> NDArray[np.float32]:
    """Return the power |F|² of a raster's far field, without the field; parameters as of `cosines_field`.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre.
    lengths : tuple of int
        Lengths (rows, columns) of the FFT whose own they are.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Square metres, squared.
    """
    from aureole.diffraction import _kernels_cosines  # compiled code: loaded when first used

    out = np.empty(grid.shape, dtype=np.float32)
    spectra, odd, along, works = _half_done(aperture, grid, lengths)
    parts = (2 * odd[:, 0] + odd[:, 1]).tolist()
    # |F| is the same at (−u, v) unless quadrants of one kind, real or imaginary, mix.
    mixed = any((3 - part) in parts for part in parts)
    shape = len(works), 1 + mixed, grid.shape[1] // 2 + 1, works.shape[3]
    planes = np.empty(shape, dtype=np.float32)
    plane = _plane(aperture, grid, lengths[0], 2)
    _kernels_cosines.power_along_x(spectra, odd, along, plane, works, planes, out)
    return out


def _half_done(aperture: Aperture, grid: Grid, lengths: tuple[int, int]) -> tuple[Any, ...]:
    """Transform a mask's columns; return what the transform of the rows reads, and its work arrays."""
    from aureole.diffraction import _kernels_cosines
    from aureole.picture._kernels import WIDTH

    assert aperture.mask is not None
    folded = fold(aperture.mask)
    odd = np.array([(part >> 1, part & 1) for part in folded.kept], dtype=np.int64).reshape(-1, 2)
    down, along = (_cosines(length // 2) for length in lengths)
    threads, lanes = _kernels_cosines.thread_count(), WIDTH
    frequencies = min(grid.shape[0] // 2 + 1, lengths[0] // 2)
    spectra = np.empty((len(odd), frequencies, folded.reach), dtype=np.float32)
    works = np.empty((threads, 1, lengths[0] // 2, lanes), dtype=np.float32)
    _kernels_cosines.along_y(folded.quadrants, folded.sums, odd, down, works, spectra)
    return spectra, odd, along, np.empty((threads, len(odd) + 1, lengths[1] // 2, lanes), dtype=np.float32)


def _plane(aperture: Aperture, grid: Grid, length: int, exponent: int) -> Any:
    """Return the weights of the frequencies, to a power, and where zero is."""
    from aureole.diffraction import _kernels_cosines

    assert aperture.mask is not None
    pixel = aperture.width / len(aperture.mask)
    y, x = (
        _weights(count, spacing * pixel, pixel, exponent)
        for count, spacing in zip(grid.shape, grid.spacing, strict=True)
    )
    return _kernels_cosines.Plane(y, x, grid.shape[0] // 2, grid.shape[1] // 2, length // 2)


@lru_cache(maxsize=8)
def _cosines(size: int) -> Any:
    """Prepare transforms of so many samples."""
    from aureole.diffraction import _kernels_cosines
    from aureole.picture.torus import circle

    ring = circle(size, np.dtype(np.float32))
    angles = np.pi * np.arange(size) / (2 * size)
    turns = np.array([np.cos(angles), np.sin(angles)], dtype=np.float32)
    return _kernels_cosines.Cosines(ring.radices, ring.cosines, ring.sines, ring.places, turns)


@lru_cache(maxsize=8)
def _weights(count: int, spacing: float, pixel: float, exponent: int) -> NDArray[np.float32]:
    """Return the transform of a pixel, in metres, at the frequencies from zero upwards, to a power."""
    transform = pixel * np.sinc(np.arange(count // 2 + 1) * spacing)
    weights: NDArray[np.float32] = (transform**exponent).astype(np.float32)
    weights.setflags(write=False)
    return weights


def _is_smooth(length: int) -> bool:
    return int(fft.next_fast_len(length, real=True)) == length
