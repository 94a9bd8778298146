"""The near field of pixels where the plane's places have the pixels' own pitch: a convolution, by FFT.

What a pixel does to a place depends on how far apart they are, along each axis by itself: it is a
difference of two Fresnel integrals (quad paper Eq. 17-19), and no sample of the kernel. So the
convolution is exact, at any distance, where that of a sampled kernel is aliased near the opening. It is
taken along x and then along y, each line in a frame long enough that nothing comes round.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction.near_pixels import differences, scale_of
from aureole.diffraction.rows import in_threads
from aureole.records import Aperture, Grid

# How far a place may lie from the lattice, in its steps.
ON_LATTICE = 1e-6
# Parts into which a pixel may be cut along an axis.
MOST_PARTS = 8
# Lines that are transformed at once: they stay in the processor's cache.
BLOCK = 32
# The near field is −i/2 times the product of both axes: each gets a root of it.
ROOT = np.sqrt(-0.5j)


def fft_near(aperture: Aperture, grid: Grid, distance: float, wavelength: float) -> NDArray[np.complex64]:
    """Return the near field of a raster as a convolution.

    Parameters
    ----------
    aperture : Aperture
        A raster, with a wavefront or without.
    grid : Grid
        Metres; along each axis the spacing is the mask's pixel, a whole number of pixels, or a half, a
        third … an eighth of one. Any centre.
    distance, wavelength : float
        Metres.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Without unit.

    Raises
    ------
    refuse.Refusal
        Where the spacing is another one.
    """
    out = np.empty(grid.shape, dtype=np.complex64)
    _convolve(aperture, grid, distance, wavelength, out)
    return out


def fft_near_power(aperture: Aperture, grid: Grid, distance: float, wavelength: float) -> NDArray[np.float32]:
    """Return |D|² of a raster by a convolution, without storing D.

    Parameters
    ----------
    aperture : Aperture
        A raster, with a wavefront or without.
    grid : Grid
        As for `fft_near`.
    distance, wavelength : float
        Metres.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Without unit.

    Raises
    ------
    refuse.Refusal
        As for `fft_near`.
    """
    out = np.empty(grid.shape, dtype=np.float32)
    _convolve(aperture, grid, distance, wavelength, out)
    return out


def lattice(aperture: Aperture, grid: Grid) -> list[tuple[int, int]] | None:
    """Return how a grid's places lie among a mask's pixels.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Metres.

    Returns
    -------
    list of tuple of int, or None
        Along y and along x: into how many parts a pixel is cut, and how many parts apart the places
        are, one of both 1. None where they are not on such a lattice.
    """
    assert aperture.mask is not None
    pixel = aperture.width / len(aperture.mask)
    found = []
    for count, spacing in zip(grid.shape, grid.spacing, strict=True):
        ratio = spacing / pixel
        parts = 1 if ratio > 0.75 else min(round(1 / ratio), MOST_PARTS + 1)
        apart = ratio * parts
        if parts > MOST_PARTS or apart > 1e6 or abs(apart - round(apart)) * count > ON_LATTICE:
            return None
        found.append((parts, round(apart)))
    return found


def lengths(aperture: Aperture, grid: Grid, found: list[tuple[int, int]]) -> list[tuple[int, int, int]]:
    """Return the lines that a convolution takes along y and along x.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Metres.
    found : list of tuple of int
        From `lattice`.

    Returns
    -------
    list of tuple of int
        Along y and x: parts of pixels, places (those left out between them, too), length of the FFT.
    """
    assert aperture.mask is not None
    sizes = []
    for (parts, apart), count in zip(found, grid.shape, strict=True):
        pixels, places = parts * len(aperture.mask), apart * (count - 1) + 1
        sizes.append((pixels, places, int(fft.next_fast_len(pixels + places - 1))))
    return sizes


def _convolve(aperture: Aperture, grid: Grid, distance: float, wavelength: float, out: NDArray[Any]) -> None:
    """Fill the field, or its power where `out` is real."""
    found = lattice(aperture, grid)
    if found is None:
        raise refuse.Refusal(
            "method 'fft' needs places a whole number of pixels apart, or a whole number to a pixel; "
            "use 'rows'."
        )
    values = apertures.transmittance(aperture, wavelength)
    values = values.astype(np.complex64 if np.iscomplexobj(values) else np.float32, copy=False)
    (parts_y, apart_y), (parts_x, apart_x) = found
    size_y, size_x = lengths(aperture, grid, found)
    scale = scale_of(distance, wavelength)
    kernel_y, kernel_x = (
        _kernel(aperture.width, size, places[0], scale)
        for size, places in zip((size_y, size_x), grid.axes(), strict=True)
    )
    lit = np.flatnonzero(values.any(axis=1))
    across = np.zeros((grid.shape[1], len(values)), dtype=np.complex64)

    def along_x(rows: NDArray[np.int64]) -> None:
        lines = np.repeat(values[rows], parts_x, axis=1)
        across[:, rows] = _convolved(lines, kernel_x, size_x, apart_x).T

    def along_y(columns: slice) -> None:
        lines = np.repeat(across[columns], parts_y, axis=1)
        done = _convolved(lines, kernel_y, size_y, apart_y).T
        out[:, columns] = done if np.iscomplexobj(out) else done.real**2 + done.imag**2

    in_threads(along_x, np.split(lit, range(BLOCK, len(lit), BLOCK)))
    in_threads(along_y, [slice(low, low + BLOCK) for low in range(0, len(across), BLOCK)])


def _kernel(width: float, size: tuple[int, int, int], first: float, scale: float) -> NDArray[np.complex64]:
    """Return the transform of what a part of a pixel does to the places around it."""
    pixels, places, length = size
    # Seen from the first place, the pixels come nearer from place to place.
    edges = (np.arange(-(places - 1), pixels + 1) / pixels - 0.5) * width
    seen = differences(edges, np.array([first]), scale)[0]
    turned = np.zeros(length, dtype=np.complex128)
    turned[: len(seen)] = seen[::-1]
    return np.asarray(ROOT * fft.fft(turned), dtype=np.complex64)


def _convolved(
    lines: NDArray[Any], kernel: NDArray[np.complex64], size: tuple[int, int, int], apart: int
) -> NDArray[np.complex64]:
    """Return the part of each line's convolution that belongs to places of the plane."""
    pixels, places, length = size
    spectra = fft.fft(lines, length, axis=1, overwrite_x=True)
    spectra *= kernel
    whole = fft.ifft(spectra, axis=1, overwrite_x=True)
    return np.asarray(whole[:, pixels - 1 : pixels - 1 + places : apart])
