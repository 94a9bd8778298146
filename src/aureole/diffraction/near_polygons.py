"""The near field of straight-edged rings, by corners or by nodes; lengths in units of √(λz / 2).

By corners: each corner and edge has its wave in closed form (`corner`). By nodes: Green's theorem turns the
Fresnel integral over a ring into

    D(x', y') = −i / 2 ∮ E(x − x') exp(iπ(y − y')² / 2) dy, E = C + iS,

a product of two matrices in float64, which takes less time where the phase turns little along an edge, far
from the opening, and keeps its digits there. Outlines that are their own mirror image are computed on a part
of the plane.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole.diffraction.corner import corner_table
from aureole.diffraction.fresnel import fresnel_integrals, taylor_table
from aureole.diffraction.near_arcs import Edge
from aureole.diffraction.near_pixels import unfolded
from aureole.diffraction.rows import multiply
from aureole.records import Grid, Outline

if TYPE_CHECKING:
    from aureole.diffraction._kernels_near_polygons import Polygons

# Corners, or nodes, whose tables are held at a time.
MOST_AT_ONCE = 512
# Scaled lengths whose squares float32 holds; nearer planes show the shadow, to 1e-9.
LARGEST = 1e17
# No phase is less, so that one may divide by it.
LEAST_PHASE = 1e-100
# Up to so many nodes an edge the product takes less time.
NODES_AN_EDGE = 45
# Wavelengths, and phases of theirs along the axes, that are held at a time.
MOST_WAVELENGTHS, PHASES = 40, 1 << 22


def straight_near(rings: list[Outline], grid: Grid, scale: float) -> NDArray[np.complex64]:
    """Return the near field of rings of straight edges.

    Parameters
    ----------
    rings : list of Outline
        Without arcs; metres.
    grid : Grid
        Metres.
    scale : float
        √(2 / (λz)), per metre.

    Returns
    -------
    ndarray of complex64, shape (rows, columns)
        Without unit; to about 5e-7.
    """
    straight = StraightRings(rings, grid)
    return unfolded(straight.part(scale), straight.middle, grid.shape)


class StraightRings:
    """Rings of straight edges and the part of a plane that their mirror symmetry leaves.

    Parameters
    ----------
    rings : list of Outline
        Without arcs; metres.
    grid : Grid
        Metres.

    Attributes
    ----------
    middle : tuple of int
        Row and column at the origin, where only places from there on are computed, else −1.
    shape : tuple of int
        Rows and columns that are computed.
    """

    def __init__(self, rings: list[Outline], grid: Grid) -> None:
        self._rings, self._spacing = rings, grid.spacing[1]
        axes, middle = [], []
        for k, (axis, count, spacing) in enumerate(zip(grid.axes(), grid.shape, grid.spacing, strict=True)):
            halved = grid.centre[k] == 0 and all(apertures.is_mirrored(ring, 1 - k) for ring in rings)
            axes.append(np.arange(count // 2 + 1) * spacing if halved else axis)
            middle.append(count // 2 if halved else -1)
        self._axes = axes
        self.middle, self.shape = (middle[0], middle[1]), (len(axes[0]), len(axes[1]))
        self._size = max(float(np.max(np.abs(each))) for each in (*axes, *(ring.vertices for ring in rings)))
        self._edges = sum(len(ring.vertices) for ring in rings)

    def at_once(self) -> int:
        """Return of how many wavelengths the phases take little memory.

        Returns
        -------
        int
            At least 1.
        """
        return max(1, min(MOST_WAVELENGTHS, PHASES // (self._edges * sum(self.shape))))

    def part(self, scale: float) -> NDArray[np.complex64]:
        """Return the field on the part that is computed.

        Parameters
        ----------
        scale : float
            √(2 / (λz)), per metre.

        Returns
        -------
        ndarray of complex64, shape `shape`
            Without unit; to about 5e-7.
        """
        scaled, y, x = self._scaled(scale)
        out = np.zeros(self.shape, dtype=np.complex64)
        edges = _edges(scaled, y, x)
        if _by_nodes(edges):
            _add_by_nodes(edges, y, x, out)
        else:
            _add_by_corners(scaled, y, x, self._spacing * min(scale, LARGEST / self._size), out)
        return out

    def add_powers(
        self, scales: NDArray[np.float64], weights: NDArray[np.float64], total: NDArray[np.float32]
    ) -> None:
        """Add the powers of several wavelengths on the part that is computed.

        Parameters
        ----------
        scales : ndarray of float64, shape (W,)
            √(2 / (λz)) of each, per metre.
        weights : ndarray of float64, shape (W, 3)
            Of each for X, Y and Z.
        total : ndarray of float32, shape (rows, 3, columns)
            Added to.
        """
        from aureole.diffraction import _kernels_near_colour

        scaled, y, x = self._scaled(float(scales.max()))
        if self._edges <= MOST_AT_ONCE and not _by_nodes(_edges(scaled, y, x)):
            reference = min(float(scales.max()), LARGEST / self._size)
            every = np.minimum(scales, LARGEST / self._size) / reference
            _add_colours(scaled, y, x, self._spacing * reference, every, weights, total)
            return
        for scale, weight in zip(scales, weights, strict=True):
            _kernels_near_colour.add_part(self.part(float(scale)), weight.astype(np.float32), total)

    def _scaled(self, scale: float) -> tuple[list[Outline], NDArray[np.float64], NDArray[np.float64]]:
        """Return the rings, the rows and the columns in units of √(λz / 2)."""
        scale = min(scale, LARGEST / self._size)
        y, x = (np.asarray(axis * scale, dtype=np.float64) for axis in self._axes)
        return [Outline(ring.vertices * scale, ring.bulges, ring.transmittance) for ring in self._rings], y, x


def _edges(
    rings: list[Outline], y: NDArray[np.float64], x: NDArray[np.float64]
) -> list[tuple[Edge, float, float]]:
    """Return edges, half the phase along each as the farthest place sees it, and their signed weights."""
    points = np.concatenate([ring.vertices for ring in rings])
    low, high = points.min(axis=0), points.max(axis=0)
    farthest = float(
        np.hypot(*np.maximum([x[-1] - low[0], y[-1] - low[1]], [high[0] - x[0], high[1] - y[0]]))
    )
    found = []
    for ring in rings:
        weight = ring.transmittance * apertures.orientation(ring)
        for start, end in zip(ring.vertices, np.roll(ring.vertices, -1, axis=0), strict=True):
            edge = Edge(start, end, 0.0, np.zeros(2), 0.0, 0.0)
            if edge.length > 0:
                # A phase of πρ² / 2 turns by πρ a unit of length.
                found.append((edge, max(0.5 * math.pi * farthest * edge.length, LEAST_PHASE), weight))
    return found


def _by_nodes(edges: list[tuple[Edge, float, float]]) -> bool:
    """Say whether the product over nodes takes less time than corners."""
    return sum(math.prod(edge.panels(phase)) for edge, phase, _ in edges) <= NODES_AN_EDGE * len(edges)


def _add_by_nodes(
    edges: list[tuple[Edge, float, float]],
    y: NDArray[np.float64],
    x: NDArray[np.float64],
    out: NDArray[np.complex64],
) -> None:
    """Add the field of edges as a product of two matrices, node by node, in float64."""
    from aureole.diffraction import _kernels_near_edges as kernels  # compiled code: loaded when first used

    pieces = [(*edge.nodes(phase), weight) for edge, phase, weight in edges]
    if not pieces:
        return
    points = np.concatenate([points for points, _, _ in pieces])
    factors = np.concatenate([-0.5j * weight * steps[:, 1] for _, steps, weight in pieces])
    # What E is at the middle cancels along the boundary, and takes digits with it.
    middle = _integrals(0.5 * (points[:, 0].min() + points[:, 0].max()) - x)
    total, product = np.zeros(out.shape, dtype=np.complex128), np.empty(out.shape, dtype=np.complex128)
    for first in range(0, len(points), MOST_AT_ONCE):
        part = points[first : first + MOST_AT_ONCE]
        right = (_integrals(part[:, 0, None] - x) - middle) * factors[first : first + MOST_AT_ONCE, None]
        waves = np.empty((len(part), 2, len(y)), dtype=np.float32)
        kernels.fill_waves(np.ascontiguousarray(part[:, 1]), y, waves)
        left = (waves[:, 0] + 1j * waves[:, 1].astype(np.float64)).T
        multiply([(left, right, product)])
        total += product
    out += total.astype(np.complex64)


def _integrals(t: NDArray[np.float64]) -> NDArray[np.complex128]:
    cosine, sine = fresnel_integrals(t)
    return np.asarray(cosine + 1j * sine)


def _add_by_corners(
    rings: list[Outline],
    y: NDArray[np.float64],
    x: NDArray[np.float64],
    step: float,
    out: NDArray[np.complex64],
) -> None:
    """Add what corners and edges bring, on columns that are a step apart."""
    from aureole.diffraction import _kernels_near_edges as kernels  # compiled code: loaded when first used
    from aureole.diffraction._kernels_near_polygons import Tables

    shape = _polygons(rings, (x[len(x) // 2], y[len(y) // 2]))
    filled = _filled(x, step)
    coefficients, orders = corner_table("coarse")
    table = coefficients.astype(np.float32), orders
    for first in range(0, len(shape.after), MOST_AT_ONCE):
        chunk = first, min(first + MOST_AT_ONCE, len(shape.after))
        along_x, along_y = (
            np.empty((chunk[1] - first, 2, len(places)), dtype=np.float32) for places in (filled, y)
        )
        kernels.fill_waves(shape.vertices[first : chunk[1], 0].copy(), filled, along_x)
        kernels.fill_waves(shape.vertices[first : chunk[1], 1].copy(), y, along_y)
        kernels.add_rows(filled, y, shape, chunk, (along_x, along_y), table, out)
    kernels.mend_corners(x, y, shape, Tables(taylor_table(), *corner_table()), out)


def _add_colours(
    rings: list[Outline],
    y: NDArray[np.float64],
    x: NDArray[np.float64],
    step: float,
    scales: NDArray[np.float64],
    weights: NDArray[np.float64],
    total: NDArray[np.float32],
) -> None:
    """Add the powers of wavelengths that see all lengths times a scale, by corners."""
    from aureole.diffraction import _kernels_near_edges as kernels
    from aureole.diffraction._kernels_near_polygons import Tables

    shape = _polygons(rings, (x[len(x) // 2], y[len(y) // 2]))
    filled = _filled(x, step)
    coefficients, orders = corner_table("coarse")
    stops, shares = _stops(scales)
    waves = []
    for k, places in enumerate((filled, y)):
        out = np.empty((len(scales), len(shape.after), 2, len(places)), dtype=np.float32)
        for scale, wave in zip(scales, out, strict=True):
            kernels.fill_waves(scale * shape.vertices[:, k], scale * places, wave)
        waves.append(out)
    kernels.add_colours(
        filled,
        y,
        shape,
        (waves[0], waves[1]),
        (coefficients.astype(np.float32), orders),
        Tables(taylor_table(), *corner_table()),
        kernels.Scales(scales, stops, shares),
        weights.astype(np.float32),
        total,
    )


def _stops(scales: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    """Return the scales to interpolate between, and their shares in each: Chebyshev's nodes, or all."""
    from aureole.diffraction._kernels_near_edges import STOPS

    if len(scales) <= STOPS:
        return scales, np.eye(len(scales), dtype=np.float32)
    low, high = float(scales.min()), float(scales.max())
    # Scales that hardly differ still need stops that do.
    half = max(0.5 * (high - low), 1e-3 * high)
    stops = 0.5 * (high + low) + half * np.polynomial.chebyshev.chebpts1(STOPS)
    shares = np.ones((len(scales), STOPS))
    for n, stop in enumerate(stops):
        for other in np.delete(stops, n):
            shares[:, n] *= (scales - other) / (stop - other)
    return stops, shares.astype(np.float32)


def _filled(x: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Return columns that are a step apart, filled up to whole blocks."""
    from aureole.diffraction._kernels_near_edges import BLOCK

    return np.concatenate([x, x[-1] + step * np.arange(1, -len(x) % BLOCK + 1)])


def _polygons(rings: list[Outline], middle: tuple[float, float]) -> "Polygons":
    """Return the edges of rings as the kernels read them."""
    from aureole.diffraction._kernels_near_polygons import Polygons

    corners, after, weights, first = [], [], [], 0
    for ring in rings:
        points = ring.vertices[np.any(ring.vertices != np.roll(ring.vertices, -1, axis=0), axis=1)]
        corners.append(points)
        after.append(first + (np.arange(len(points)) + 1) % max(len(points), 1))
        weights.append(np.full(len(points), ring.transmittance * apertures.orientation(ring)))
        first += len(points)
    vertices, ends = np.concatenate(corners), np.concatenate(after)
    edges = vertices[ends] - vertices
    away = np.hypot(*(vertices - middle).T)
    anchors = np.where(away[ends] < away, ends, np.arange(len(ends)))
    directions = edges / np.hypot(*edges.T)[:, None]
    return Polygons(vertices, ends, np.argsort(ends), directions, anchors, np.concatenate(weights))
