"""The far field of exact outlines, from their edges: no raster, no stair steps.

The divergence theorem turns the Fourier integral over a shape into one over its boundary (Abbe;
S.-W. Lee and R. Mittra, IEEE Trans. Antennas Propag. 31, 1983):

    F(q) = i / (2π |q|²) ∮ exp(−i2π q·p) (q × dp).

A straight edge from a to b gives κ (exp(−i2π q·a) − exp(−i2π q·b)) / (i2π q·(b − a)), and the
phases of the vertices are outer products of two tables, so there is no trigonometry per sample. A
full circle of diameter D is D J1(π D |q|) / (2 |q|). An arc is an incomplete Bessel integral: near
the origin by Gauss-Legendre quadrature, elsewhere by its uniform expansion, a Fresnel integral at
the stationary point and edge waves from its ends.
"""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy import special

from aureole import aperture as apertures
from aureole.diffraction import _kernels_polygons
from aureole.records import Aperture, Grid, Outline

LONGEST_ARC = math.pi / 3
FLATTEST_BULGE = 1e-6
QUADRATURE_NODES = 32
# The expansion of the auxiliary functions is accurate to 1e-8 from here on.
TABLE_END = 6


def polygons_field(aperture: Aperture, grid: Grid) -> NDArray[np.complex64]:
    """Return the far field of an aperture's outlines.

    Parameters
    ----------
    aperture : Aperture
        With outlines.
    grid : Grid
        Frequencies in cycles per metre.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Square metres; accurate to about 1e-6 of the peak.
    """
    unit = aperture.width
    v, u = (axis * unit for axis in grid.axes())
    out = np.zeros(grid.shape, dtype=np.complex64)
    edged = []
    for ring in aperture.outlines:
        disc = apertures.as_circle(ring)
        if disc is None:
            edged.append(ring)
        else:
            out += ring.transmittance * _disc_field(disc, unit, u, v)
    if edged:
        _add_rings(edged, unit, u, v, out)
    return out * np.float32(unit**2)


def _disc_field(
    disc: apertures.Circle, unit: float, u: NDArray[np.float64], v: NDArray[np.float64]
) -> NDArray[np.complex64]:
    """Return R J1(2π R |q|) / |q| with the phase of its centre, in units of the width."""
    radius = disc.radius / unit
    q = np.hypot(v[:, None], u[None, :])
    at_origin = q * radius < 1e-9
    values = radius * special.j1(2 * np.pi * radius * q) / np.where(at_origin, 1.0, q)
    values[at_origin] = np.pi * radius**2
    if disc.x == 0 and disc.y == 0:
        return np.asarray(values, dtype=np.complex64)
    phase_y = np.exp(-2j * np.pi * v * (disc.y / unit))
    phase_x = np.exp(-2j * np.pi * u * (disc.x / unit))
    return np.asarray(values * phase_y[:, None] * phase_x, dtype=np.complex64)


def _add_rings(
    rings: list[Outline],
    unit: float,
    u: NDArray[np.float64],
    v: NDArray[np.float64],
    out: NDArray[np.complex64],
) -> None:
    scaled = [Outline(ring.vertices / unit, ring.bulges, ring.transmittance) for ring in rings]
    parts = [_with_short_arcs(ring) for ring in scaled]
    vertices = np.concatenate([part[0] for part in parts])
    edges = np.concatenate([np.roll(part[0], -1, axis=0) - part[0] for part in parts])
    arcs = np.concatenate([part[1] for part in parts])
    starts = np.cumsum([0] + [len(part[0]) for part in parts])
    moments = np.array([_signed_moments(ring) for ring in scaled])
    nodes, weights = np.polynomial.legendre.leggauss(QUADRATURE_NODES)
    phase_x = np.exp(-2j * np.pi * vertices[:, :1] * u)
    phase_y = np.exp(-2j * np.pi * vertices[:, 1:] * v)
    _kernels_polygons.rings(
        u, v, phase_x, phase_y, edges, arcs, starts, moments, _auxiliary_table(), nodes, weights, out
    )


def _with_short_arcs(ring: Outline) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cut arcs to at most 60 degrees; return vertices (V, 2) and arcs (V, 5), radius 0 for straight."""
    vertices, arcs = [], []
    ends = np.roll(ring.vertices, -1, axis=0)
    for start, end, bulge in zip(ring.vertices, ends, ring.bulges, strict=True):
        if abs(bulge) < FLATTEST_BULGE:
            vertices.append(start)
            arcs.append((0.0, 0.0, 0.0, 0.0, 0.0))
            continue
        centre, radius, first, sweep = apertures.arc_of(start, end, float(bulge))
        pieces = math.ceil(abs(sweep) / LONGEST_ARC)
        for piece in range(pieces):
            angle = first + sweep * piece / pieces
            point = centre + radius * np.array([math.cos(angle), math.sin(angle)])
            vertices.append(point if piece else start)
            arcs.append((centre[0], centre[1], radius, angle, sweep / pieces))
    return np.array(vertices), np.array(arcs)


def _signed_moments(ring: Outline) -> list[float]:
    """Return the ring's weight by its direction, its area, its centroid and its moments about that."""
    area, centroid, second = apertures.central_moments(ring)
    weight = math.copysign(ring.transmittance, area * ring.transmittance)
    return [weight, area, centroid[0], centroid[1], second[0, 0], second[0, 1], second[1, 1]]


@cache
def _auxiliary_table() -> NDArray[np.float64]:
    """Tabulate the Fresnel auxiliary functions f and g from C and S (Abramowitz and Stegun 7.3.5-6)."""
    w = np.arange(TABLE_END * _kernels_polygons.TABLE_STEPS + 1) / _kernels_polygons.TABLE_STEPS
    sine_integral, cosine_integral = special.fresnel(w)
    phase = np.pi * w * w / 2
    cosine, sine = np.cos(phase), np.sin(phase)
    f = (0.5 - sine_integral) * cosine - (0.5 - cosine_integral) * sine
    g = (0.5 - cosine_integral) * cosine + (0.5 - sine_integral) * sine
    return np.stack([f, g], axis=1)
