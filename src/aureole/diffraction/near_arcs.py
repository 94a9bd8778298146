"""The near field of openings whose edges are circular arcs, exact: curved blades, cat's eyes.

In Fresnel units, √(λz / 2), with ρ from a place of the plane to a point of the boundary,

    D = −(1/2π) ∮ (exp(iπρ²/2) − 1) dφ,   dφ = (ρ × dρ) / ρ²,

whose integrand is smooth everywhere, on the edge too. Where the phase along an edge turns little a
Gauss-Legendre sum takes it. Elsewhere the edge's ends count, and the points of its circle that are nearest
and farthest. For an arc of radius R, d from its centre and δ from the place's direction,

    ρ² = h² + τ², h = R − d, τ = 2√(Rd) sin(δ/2),   dφ = ½ [1 + h(R + d) / ρ²] dδ.

With t = τ² / (4Rd), u = √(1 − t), v = (R + d) / (2√(Rd)) and c = h / (R + d) this is

    dφ = h dτ / (h² + τ²) + 1 / (2√(Rd)) [(1 + c) / u − c / (u + v)] dτ,

the first term of which integrates to the corner functions of a straight edge at the distance h, ends at τ;
the second is smooth and small, and its expansion in 1 / (2πRd) ends with two terms: the stationary point's,
by the Fresnel integral from τ on, and the end's, by parts (N. Bleistein, Comm. Pure Appl. Math. 19, 1966).
Ends that are nearer to the farthest point have ρ² = (R + d)² − σ², σ = 2√(Rd) cos(δ/2), and no pole.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole.aperture import Circle
from aureole.diffraction.corner import corner_table
from aureole.diffraction.fresnel import taylor_table
from aureole.diffraction.near_circles import circle_near
from aureole.diffraction.near_pixels import scale_of
from aureole.diffraction.polygons import gauss, node_count, short_arcs, to_whole_tiles
from aureole.records import Grid, Outline

# From this 2πRd on two terms of an arc's expansion are accurate to 4e-7.
FAR = 800.0
# Half the phase along an edge up to which nodes serve it: less than arcs of 60 degrees have at FAR. Of a
# panel, and the factor by which it falls from set to set.
MOST_PHASE, PANEL_PHASE, LEAST_PHASE, LADDER = 240.0, 40.0, 2.0, math.sqrt(2)
QUADRATURE_ERROR = 1e-8
FLATTEST_BULGE = 1e-8
# Arcs whose centres and radii agree to this part of the radius lie on one circle.
ONE_CIRCLE = 1e-12
# Lengths in Fresnel units: smaller rings let nothing through, larger ones and farther places cast shadows.
SMALLEST, LARGEST, FARTHEST = 1e-100, 1e7, 1e8


@dataclass(frozen=True)
class Edge:
    """An edge of a ring, lengths in Fresnel units, √(λz / 2).

    Parameters
    ----------
    start, end : ndarray of float64, shape (2,)
        x, y.
    radius : float
        0 of a straight edge.
    centre : ndarray of float64, shape (2,)
        x, y of an arc's.
    first, sweep : float
        Angle of an arc's start seen from its centre, and how far it turns, at most 60 degrees; radians.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    radius: float
    centre: NDArray[np.float64]
    first: float
    sweep: float

    @property
    def length(self) -> float:
        return self.radius * abs(self.sweep) if self.radius else math.dist(self.start, self.end)

    def bound(self) -> NDArray[np.float64]:
        """Return origin, tangent, sine and reach, from which follows how fast the phase turns."""
        tangent = (self.end - self.start) / math.dist(self.start, self.end)
        if self.radius:
            return np.array([*self.centre, *tangent, math.sin(abs(self.sweep) / 2), 0.0])
        return np.array([*(0.5 * (self.start + self.end)), *tangent, 0.0, 0.5 * self.length])

    def shape(self, turn: float) -> NDArray[np.float64]:
        """Return what the kernel of single edges reads: arcs turn from +x to +y."""
        back = self.sweep < 0
        first, last = (self.end, self.start) if back else (self.start, self.end)
        tangents = [self._tangent(first), self._tangent(last)]
        curvature = 1 / self.radius if self.radius else 0.0
        sign = -turn if back else turn
        return np.array([sign, *first, *last, self.radius, *self.centre, *np.ravel(tangents), curvature])

    def _tangent(self, corner: NDArray[np.float64]) -> NDArray[np.float64]:
        if not self.radius:
            return (self.end - self.start) / self.length
        x, y = (corner - self.centre) / self.radius
        return np.array([-y, x])

    def panels(self, half_phase: float) -> tuple[int, int]:
        """Return into how many panels the edge goes for that, and how many nodes each of them has."""
        panels = math.ceil(half_phase / PANEL_PHASE)
        # Two nodes more, for what is not phase.
        return panels, node_count(half_phase / panels, QUADRATURE_ERROR) + 2

    def nodes(self, half_phase: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return nodes and steps that integrate along the edge a phase which turns by this at most."""
        panels, count = self.panels(half_phase)
        nodes, weights = gauss(count)
        where = ((np.arange(panels)[:, None] + (nodes + 1) / 2) / panels).ravel()
        share = np.tile(weights / (2 * panels), panels)
        if not self.radius:
            chord = self.end - self.start
            return self.start + where[:, None] * chord, share[:, None] * chord
        angles = self.first + self.sweep * where
        out = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        across = np.stack([-out[:, 1], out[:, 0]], axis=1)
        return self.centre + self.radius * out, (self.radius * self.sweep * share)[:, None] * across


def arcs_near(ring: Outline, grid: Grid, distance: float, wavelength: float) -> NDArray[np.complex64]:
    """Return the near field of a ring of arcs and straight edges that lets all light through.

    Parameters
    ----------
    ring : Outline
        Metres; its transmittance is not counted, nor which way it turns.
    grid : Grid
        Metres.
    distance, wavelength : float
        Metres.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Without unit; accurate to about 1e-6.
    """
    from aureole.diffraction import _kernels_boundary  # compiled code: loaded when first used

    circle = _as_one_circle(ring)
    if circle is not None:
        return circle_near(circle, grid, distance, wavelength)
    size = float(np.max(np.abs(ring.vertices)))
    scale = min(scale_of(distance, wavelength), LARGEST / size)
    out = np.zeros(grid.shape, dtype=np.complex64)
    if scale * size < SMALLEST:
        return out
    y, x = (np.clip(axis, -FARTHEST / scale, FARTHEST / scale) * scale for axis in grid.axes())
    edges = _edges(Outline(ring.vertices * scale, ring.bulges), x, y)
    tables = _kernels_boundary.Tables(taylor_table(), *corner_table("coarse"))
    _kernels_boundary.fill_boundary(edges, tables, to_whole_tiles(x, _kernels_boundary.TILE), y, out)
    return out


def _as_one_circle(ring: Outline) -> Circle | None:
    """Return the circle on which all edges lie, once round, or None."""
    if not np.all(ring.bulges) or not math.isclose(abs(4 * np.arctan(ring.bulges).sum()), 2 * math.pi):
        return None
    ends = np.roll(ring.vertices, -1, axis=0)
    arcs = [apertures.arc_of(*edge)[:2] for edge in zip(ring.vertices, ends, ring.bulges, strict=True)]
    centres, radii = np.array([arc[0] for arc in arcs]), np.array([arc[1] for arc in arcs])
    if max(np.ptp(radii), *np.ptp(centres, axis=0)) > ONE_CIRCLE * radii[0]:
        return None
    (x, y), radius = centres.mean(axis=0), radii.mean()
    return Circle(float(x), float(y), float(radius))


def _edges(ring: Outline, x: NDArray[np.float64], y: NDArray[np.float64]) -> Any:
    """Return the edges of a ring in Fresnel units, with sets of nodes for places of a plane."""
    from aureole.diffraction import _kernels_boundary

    turn = apertures.orientation(ring)
    vertices, arcs = short_arcs(ring, FLATTEST_BULGE)
    edges = [
        Edge(start, end, arc[0], arc[1:3], arc[3], arc[4])
        for start, end, arc in zip(vertices, np.roll(vertices, -1, axis=0), arcs, strict=True)
        if np.any(start != end)
    ]
    corners = np.array([[along, down] for along in (x[0], x[-1]) for down in (y[0], y[-1])])
    limits, first, counts = [], [], []
    points: list[NDArray[np.float64]] = []
    steps: list[NDArray[np.float64]] = []
    for edge in edges:
        phases = _phases(0.5 * math.pi * edge.length * _fastest(edge.bound(), corners))
        sets = [edge.nodes(phase) for phase in phases]
        limits.append([phase / (0.5 * math.pi * edge.length) for phase in phases])
        first.append(
            sum(len(nodes) for nodes in points) + np.cumsum([0, *(len(nodes) for nodes, _ in sets[:-1])])
        )
        counts.append([len(nodes) for nodes, _ in sets])
        points.append(np.concatenate([nodes for nodes, _ in sets]))
        steps.append(turn * np.concatenate([step for _, step in sets]))
    return _kernels_boundary.Edges(
        np.array([edge.shape(turn) for edge in edges]),
        np.array([FAR / (2 * math.pi * edge.radius) if edge.radius else 0.0 for edge in edges]),
        np.array([edge.bound() for edge in edges]),
        _filled(limits, np.float64),
        _filled(first, np.int64),
        _filled(counts, np.int64),
        np.concatenate(points),
        np.concatenate(steps),
    )


def _fastest(bound: NDArray[np.float64], places: NDArray[np.float64]) -> float:
    """Return how fast the phase along an edge turns at most, seen from any of some places."""
    v, (along, down) = places - bound[:2], bound[2:4]
    turns = np.abs(v @ bound[2:4]) + np.abs(v[:, 0] * down - v[:, 1] * along) * bound[4]
    return float(turns.max() + bound[5])


def _phases(most: float) -> list[float]:
    """Return the half phases that an edge's sets of nodes serve, rising."""
    phases = [min(1.0001 * most, MOST_PHASE)]
    while phases[-1] > LEAST_PHASE:
        phases.append(phases[-1] / LADDER)
    return phases[::-1]


def _filled(rows: list[Any], kind: type) -> NDArray[Any]:
    """Return rows of different lengths as a table, their last values repeated."""
    size = max(map(len, rows))
    return np.array([[*row, *[row[-1]] * (size - len(row))] for row in rows], dtype=kind)
