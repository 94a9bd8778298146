"""The slow, obvious truth for the far field, in float64.

A raster is a sum over pixels, each a small square; an outline is a Gauss-Legendre quadrature of the
boundary integral with panels shorter than half a cycle. Nothing here is clever; everything else is
tested against it.
"""

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole.records import Aperture, Grid, Outline

# Nodes are summed in batches, so that memory stays flat.
BATCH = 4096


def reference_field(
    aperture: Aperture, grid: Grid, wavelength: float | None = None
) -> NDArray[np.complex128]:
    """Return the far field by direct summation.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.
    grid : Grid
        Frequencies in cycles per metre.
    wavelength : float, optional
        Metres; an aperture with a wavefront needs it.

    Returns
    -------
    ndarray of complex128, shape (rows, columns)
        Square metres.
    """
    if aperture.mask is not None:
        return _pixels(apertures.transmittance(aperture, wavelength), aperture.width, grid)
    total = np.zeros(grid.shape, dtype=np.complex128)
    for ring in aperture.outlines:
        total += ring.transmittance * apertures.orientation(ring) * _ring(ring, grid)
    return total


def _pixels(mask: NDArray[np.inexact], width: float, grid: Grid) -> NDArray[np.complex128]:
    """Sum exp(−i2π q·p) over the pixels, times the transform of one pixel."""
    size = len(mask)
    pixel = width / size
    centres = (np.arange(size) + 0.5) * pixel - width / 2
    v, u = grid.axes()
    wave_y = np.exp(-2j * np.pi * np.outer(v, centres)) * (pixel * np.sinc(v * pixel))[:, None]
    wave_x = np.exp(-2j * np.pi * np.outer(centres, u)) * (pixel * np.sinc(u * pixel))
    return np.asarray(wave_y @ mask.astype(np.complex128) @ wave_x)


def _ring(ring: Outline, grid: Grid) -> NDArray[np.complex128]:
    """Return i / (2π |q|²) ∮ exp(−i2π q·p) (q × dp), and its series at the origin."""
    v, u = grid.axes()
    reach = float(np.hypot(np.abs(v).max(), np.abs(u).max()))
    panel = 0.5 / reach if reach else np.inf
    points, steps = apertures.boundary_nodes(ring, panel)
    across_x = np.zeros(grid.shape, dtype=np.complex128)
    across_y = np.zeros(grid.shape, dtype=np.complex128)
    for low in range(0, len(points), BATCH):
        x, y = points[low : low + BATCH].T
        dx, dy = steps[low : low + BATCH].T
        wave_y = np.exp(-2j * np.pi * np.outer(v, y))
        wave_x = np.exp(-2j * np.pi * np.outer(x, u))
        across_x += (wave_y * dx) @ wave_x
        across_y += (wave_y * dy) @ wave_x
    square = v[:, None] ** 2 + u**2
    area, (x, y), second = apertures.central_moments(ring)
    near = square * np.trace(second) / area < 1e-9
    value = 1j * (u * across_y - v[:, None] * across_x) / (2 * np.pi * np.where(near, 1.0, square))
    quadratic = second[0, 0] * u**2 + 2 * second[0, 1] * u * v[:, None] + second[1, 1] * v[:, None] ** 2
    series = (area - 2 * np.pi**2 * quadratic) * np.exp(-2j * np.pi * (u * x + v[:, None] * y))
    return np.where(near, series, value)
