"""The near field of a circular opening, exact: it depends on the distance from the centre alone.

In Fresnel units, √(λz / 2), the wave at a distance r from the centre of a circle of radius R is a
boundary integral (Maggi and Rubinowicz's boundary wave; E. Lommel, Abh. Bayer. Akad. 15, 1885, gives it
as series of Bessel functions):

    D(r) = −(1/2π) ∮ (exp(iπρ²/2) − 1) dφ = −(1/2π) ∮ (exp(iπρ²/2) − 1) / ρ² R (R − r cos θ) dθ,

with ρ² = R² + r² − 2Rr cos θ. D exp(−iπr²/2) has no frequency above R/2, so that few nodes tabulate it
where Rr is small. Elsewhere two points of the edge count, the nearest and the farthest: with h = R − r and
τ = 2√(Rr) sin(θ/2), ρ² = h² + τ² exactly, so that the nearest point makes the wave of a straight edge, all
of it, and corrections that fall with 1 / (Rr).
"""

import math

import numpy as np
from numpy.typing import NDArray

from aureole.aperture import Circle
from aureole.diffraction.fresnel import taylor_table
from aureole.diffraction.near_pixels import scale_of
from aureole.records import Grid

# From this 2πRr on four terms of the edge waves are accurate to 1e-7.
FAR = 40.0
# Radians of the table's fastest wave a node; nodes on half a circle beside those that its cycles need.
NODE_PHASE, CIRCLE_NODES = 0.15, 32
# Nodes that a polynomial of the sixth degree goes through.
STENCIL = np.arange(-3, 4)
# Lengths in Fresnel units beyond which nothing changes; their squares stay finite.
SMALLEST, FARTHEST, LARGEST = 1e-100, 1e150, 1e151


def circle_near(circle: Circle, grid: Grid, distance: float, wavelength: float) -> NDArray[np.complex64]:
    """Return the near field of a circular opening.

    Parameters
    ----------
    circle : aperture.Circle
        Metres.
    grid : Grid
        Metres; four times faster centred on the circle.
    distance, wavelength : float
        Metres.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Without unit; accurate to 2e-7.
    """
    from aureole.diffraction import _kernels_circles  # compiled code: loaded when first used

    scale = scale_of(distance, wavelength)
    # Squares must stay finite: a smaller circle lets nothing through, a larger one all.
    radius = min(max(scale * min(circle.radius, LARGEST / scale), SMALLEST), LARGEST)
    axes = zip(grid.axes(), grid.spacing, grid.shape, grid.centre, (circle.y, circle.x), strict=True)
    across, middle = [], []
    for axis, spacing, count, centre, origin in axes:
        centred = centre == origin
        places = np.arange(count // 2 + 1, dtype=np.float64) * spacing if centred else axis - origin
        across.append(np.minimum(np.abs(places), FARTHEST / scale) * scale)
        middle.append(count // 2 if centred else -1)
    table, step = _radial_table(radius, math.hypot(*(float(places.max()) for places in across)))
    out = np.empty(grid.shape, dtype=np.complex64)
    _kernels_circles.fill_disc(
        (across[0], across[1]), radius, table, step, taylor_table(), (middle[0], middle[1]), out
    )
    return out


def radial_field(radius: float, r: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return the near field of a circle by the trapezoidal rule along its edge.

    Parameters
    ----------
    radius : float
        Fresnel units, √(λz / 2).
    r : ndarray of float64, shape (N,)
        Distances from the centre, Fresnel units.

    Returns
    -------
    ndarray of complex128, shape (N,)
        Without unit, to 1e-12: beyond one node a half cycle the rule converges exponentially.
    """
    fastest = math.pi * radius * float(np.max(np.abs(r), initial=0.0))
    nodes = CIRCLE_NODES + math.ceil(0.5 * fastest + 6 * math.cbrt(fastest))
    cosine = np.cos(np.pi * (np.arange(nodes) + 0.5) / nodes)
    distance = r[:, None]
    half_phase = 0.25 * np.pi * ((radius - distance) ** 2 + 2 * radius * distance * (1 - cosine))
    # exp(ix) − 1 = 2i sin(x/2) exp(ix/2)
    kernel = 0.5j * np.pi * np.sinc(half_phase / np.pi) * np.exp(1j * half_phase)
    return np.asarray(-np.mean(radius * (radius - distance * cosine) * kernel, axis=1))


def _radial_table(radius: float, reach: float) -> tuple[NDArray[np.complex128], float]:
    """Return polynomials of D exp(−iπr²/2) about nodes, and their step, as far as they are needed."""
    step = NODE_PHASE / (np.pi * radius)
    count = math.ceil(min(FAR / (2 * np.pi * radius), reach) / step) + 1
    r = step * np.arange(-STENCIL[-1], count + STENCIL[-1])
    values = radial_field(radius, r) * np.exp(-0.5j * np.pi * r**2)
    stencils = values[np.arange(count)[:, None] + np.arange(len(STENCIL))]
    powers = np.vander(STENCIL.astype(np.float64), increasing=True)
    return np.ascontiguousarray(np.linalg.solve(powers, stencils.T).T), step
