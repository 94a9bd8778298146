"""The near field of exact outlines, from their edges: no raster, no stair steps.

With r = p − p' from a place of the plane to a point of the boundary, polar coordinates about p' turn the
Fresnel integral over a shape into one over its boundary (the boundary wave of Maggi and Rubinowicz, in
Fresnel's approximation):

    D(p') = −1 / (2π) ∮ (exp(iπ|r|² / (λz)) − 1) / |r|² (r × dr).

The integrand is smooth everywhere, on the boundary too. Straight edges have it in closed form: `corner`.
"""

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction.near_arcs import arcs_near
from aureole.diffraction.near_circles import circle_near
from aureole.diffraction.near_pixels import scale_of
from aureole.diffraction.near_polygons import straight_near
from aureole.records import Aperture, Grid, Outline

# Turns of the phase, at most, along a panel of twelve nodes: its error is below 1e-11.
PANEL_TURNS = 2.0
# Nodes are summed in batches, so that memory stays flat; more panels than this are refused.
BATCH = 1 << 14
MOST_PANELS = 1e7


def reference_outlines(
    aperture: Aperture, grid: Grid, distance: float, wavelength: float
) -> NDArray[np.complex128]:
    """Return the near field of outlines as a Gauss-Legendre sum along their boundary, in float64.

    Parameters
    ----------
    aperture : Aperture
        With outlines, straight edges and arcs alike.
    grid : Grid
        Metres.
    distance, wavelength : float
        Metres.

    Returns
    -------
    ndarray of complex128, shape (rows, columns)
        Without unit; to about 1e-10.

    Raises
    ------
    refuse.Refusal
        Where the sum would have too many terms.
    """
    scale = scale_of(distance, wavelength)
    total = np.zeros(grid.shape, dtype=np.complex128)
    for ring in aperture.outlines:
        total += ring.transmittance * apertures.orientation(ring) * _boundary_sum(ring, grid, scale)
    return total


def polygons_near(
    aperture: Aperture, grid: Grid, distance: float, wavelength: float
) -> NDArray[np.complex64]:
    """Return the near field of outlines from their edges, in closed form.

    Parameters
    ----------
    aperture : Aperture
        With outlines.
    grid : Grid
        Metres.
    distance, wavelength : float
        Metres.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Without unit; to about 2e-6.

    Raises
    ------
    refuse.Refusal
        Where the aperture is a raster.
    """
    if aperture.mask is not None:
        raise refuse.Refusal("method 'polygons' needs outlines and this aperture is a raster; use 'rows'.")
    out = np.zeros(grid.shape, dtype=np.complex64)
    straight = []
    for ring in aperture.outlines:
        circle = apertures.as_circle(ring)
        if circle is not None:
            out += np.float32(ring.transmittance) * circle_near(circle, grid, distance, wavelength)
        elif np.any(ring.bulges):
            out += np.float32(ring.transmittance) * arcs_near(ring, grid, distance, wavelength)
        else:
            straight.append(ring)
    if straight:
        out += straight_near(straight, grid, scale_of(distance, wavelength))
    return out


def _boundary_sum(ring: Outline, grid: Grid, scale: float) -> NDArray[np.complex128]:
    """Return −1 / (2π) ∮ (exp(iπρ² / 2) − 1) / ρ² (ρ × dρ), lengths in units of √(λz / 2)."""
    points, steps = apertures.boundary_nodes(ring, _panel_length(ring, grid, scale))
    points, steps = points * scale, steps * scale
    y, x = (axis * scale for axis in grid.axes())
    across, along = (places.ravel() for places in np.meshgrid(y, x, indexing="ij"))
    out = np.zeros(across.size, dtype=np.complex128)
    places = max(1, BATCH // len(points))
    for first in range(0, across.size, places):
        part = slice(first, first + places)
        for low in range(0, len(points), BATCH):
            nodes = slice(low, low + BATCH)
            out[part] += _kernel_sum(points[nodes], steps[nodes], along[part, None], across[part, None])
    return out.reshape(grid.shape)


def _kernel_sum(
    points: NDArray[np.float64], steps: NDArray[np.float64], x: NDArray[np.float64], y: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Sum over nodes for every place (M, 1), without a cancelling difference where ρ is small."""
    along, across = points[:, 0] - x, points[:, 1] - y
    half_phase = 0.25 * np.pi * (along * along + across * across)
    sine = np.sin(half_phase)
    # exp(2iα) − 1 = 2i sin α exp(iα)
    kernel = np.divide(sine, half_phase, out=np.ones_like(sine), where=half_phase > 0)
    kernel *= along * steps[:, 1] - across * steps[:, 0]
    return np.asarray(
        0.25 * np.sum(kernel * sine, axis=1) - 0.25j * np.sum(kernel * np.cos(half_phase), axis=1)
    )


def _panel_length(ring: Outline, grid: Grid, scale: float) -> float:
    """Return how long panels may be where the phase turns fastest, in metres."""
    chords = np.hypot(*(np.roll(ring.vertices, -1, axis=0) - ring.vertices).T)
    bulges = np.abs(ring.bulges)
    # No arc strays farther from its ends than its bulge times its chord.
    stray = float(np.max(bulges * chords))
    low, high = ring.vertices.min(axis=0) - stray, ring.vertices.max(axis=0) + stray
    ends = np.array([[axis[0], axis[-1]] for axis in reversed(grid.axes())]).T
    with np.errstate(over="ignore"):
        farthest = float(np.hypot(*np.maximum(ends[1] - low, high - ends[0])))
        # A phase of πρ² / 2 turns by ρ / 2 a unit of length.
        panel = PANEL_TURNS / (0.5 * farthest * scale) / scale
    if not np.sum(chords * (1 + np.pi * bulges)) < panel * MOST_PANELS:
        raise refuse.Refusal(
            f"method 'reference' would sum more than {MOST_PANELS * apertures.GAUSS_NODES:.2g} nodes a place "
            "here: the plane is too close to the aperture, or too wide; use 'auto'."
        )
    return panel
