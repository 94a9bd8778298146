"""The far field of exact outlines, from their edges: no raster, no stair steps.

The divergence theorem turns the Fourier integral over a shape into one over its boundary (Abbe;
S.-W. Lee and R. Mittra, IEEE Trans. Antennas Propag. 31, 1983):

    F(q) = i / (2π |q|²) ∮ exp(−i2π q·p) (q × dp).

A straight edge from a to b gives κ (exp(−i2π q·a) − exp(−i2π q·b)) / (i2π q·(b − a)), and the
phases of the vertices are outer products of two tables, so there is no trigonometry per sample. A
full circle of diameter D is D J1(π D |q|) / (2 |q|). An arc is an incomplete Bessel integral: its
uniform expansion is a Fresnel integral at the stationary point and edge waves from its ends.

In a disc about the origin, where the terms of a ring cancel or an arc's expansion fails, the
boundary integral is a Gauss-Legendre sum in float64: a product of two matrices.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole.records import Aperture, Grid, Outline

LONGEST_ARC = math.pi / 3
FLATTEST_BULGE = 1e-6
# From this 2π R |q| on, three terms of an arc's expansion are accurate to 1e-6 of its edge wave; a
# flat arc must also hold that much phase itself, lest its ends cancel.
FAR_ARC = 60.0
LONG_ARC = 30.0
# Terms of a ring cancel too much for float32 below so many cycles across it, and, where it is thin,
# below so many across its area over its perimeter.
CORE_CYCLES, THIN_CYCLES = 1.5, 0.05
QUADRATURE_ERROR = 1e-10
# Rows of the core that one matrix product takes.
CORE_ROWS = 256


@dataclass(frozen=True, eq=False)
class _Ring:
    """A ring in units of the aperture's width: corners, arcs of at most 60 degrees, and its core."""

    vertices: NDArray[np.float64]
    arcs: NDArray[np.float64]
    weight: float
    near: float
    area: float
    centroid: NDArray[np.float64]
    second: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Shape:
    """The rings of an aperture and its circles: centre x, y, radius, transmittance.

    mirror is 1 where all are symmetric left to right, so that F(−u, v) = F(u, v); −1 where they are
    top to bottom, so that it is the conjugate; else 0.
    """

    rings: list[_Ring]
    discs: NDArray[np.float64]
    mirror: int


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
    from aureole.diffraction import _kernels_polygons  # compiled code: loaded when first used

    shape, unit = _shape(aperture), aperture.width
    scale = np.float32(unit**2)
    out = np.empty(grid.shape, dtype=np.complex64)
    if grid.centre == (0.0, 0.0):
        _kernels_polygons.fill_centred_field(*_prepared_centred(shape, grid, unit), scale, shape.mirror, out)
    else:
        v, u = (axis * unit for axis in grid.axes())
        _kernels_polygons.fill_field(*_prepared(shape, u, v), scale, out)
    return out


def add_polygons_power(aperture: Aperture, grid: Grid, weight: float, total: NDArray[np.float32]) -> None:
    """Add weight × |F|² of an aperture's outlines to a plane, without storing F.

    Parameters
    ----------
    aperture : Aperture
        With outlines.
    grid : Grid
        Frequencies in cycles per metre.
    weight : float
        Factor.
    total : ndarray of float32, shape (rows, columns)
        Added to in place, in m⁴.
    """
    from aureole.diffraction import _kernels_polygons  # compiled code: loaded when first used

    unit = aperture.width
    v, u = (axis * unit for axis in grid.axes())
    waves, core, corner = _prepared(_shape(aperture), u, v)
    _kernels_polygons.add_power(waves, core, corner, np.float32(weight * unit**4), total)


def polygons_power(aperture: Aperture, grid: Grid) -> NDArray[np.float32]:
    """Return the power |F|² of an aperture's outlines, without the field.

    Parameters
    ----------
    aperture : Aperture
        With outlines.
    grid : Grid
        Frequencies in cycles per metre.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Square metres, squared; accurate to about 1e-6 of the peak's amplitude.
    """
    if grid.centre != (0.0, 0.0):
        total = np.zeros(grid.shape, dtype=np.float32)
        add_polygons_power(aperture, grid, 1.0, total)
        return total
    from aureole.diffraction import _kernels_polygons  # compiled code: loaded when first used

    shape, unit = _shape(aperture), aperture.width
    out = np.empty(grid.shape, dtype=np.float32)
    prepared = _prepared_centred(shape, grid, unit)
    _kernels_polygons.fill_centred_power(*prepared, np.float32(unit**2), shape.mirror, out)
    return out


@lru_cache(maxsize=8)
def _shape(aperture: Aperture) -> _Shape:
    """Prepare the outlines of an aperture, which nobody writes into."""
    unit = aperture.width
    rings, outlines, discs = [], [], []
    for ring in aperture.outlines:
        disc = apertures.as_circle(ring)
        if disc is None:
            outlines.append(ring)
            rings.append(_ring(Outline(ring.vertices / unit, ring.bulges, ring.transmittance)))
        else:
            discs.append([disc.x / unit, disc.y / unit, disc.radius / unit, ring.transmittance])
    circles = np.array(discs).reshape(-1, 4)
    for axis, mirror in ((0, 1), (1, -1)):
        if (circles[:, axis] == 0).all() and all(apertures.is_mirrored(ring, axis) for ring in outlines):
            return _Shape(rings, circles, mirror)
    return _Shape(rings, circles, 0)


def _ring(ring: Outline) -> _Ring:
    vertices, arcs = short_arcs(ring)
    lengths = np.hypot(*(np.roll(vertices, -1, axis=0) - vertices).T)
    size = float(np.hypot(*np.ptp(vertices, axis=0)))
    area, centroid, second = apertures.central_moments(ring)
    near = max(CORE_CYCLES / size, THIN_CYCLES * float(lengths.sum()) / abs(area))
    for radius, *_, sweep in arcs[arcs[:, 0] > 0]:
        near = max(near, max(FAR_ARC, LONG_ARC / abs(sweep)) / (2 * math.pi * radius))
    weight = math.copysign(ring.transmittance, area * ring.transmittance)
    return _Ring(vertices, arcs, weight, near, area, centroid, second)


def short_arcs(
    ring: Outline, flattest: float = FLATTEST_BULGE
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cut the arcs of a ring to at most 60 degrees.

    Parameters
    ----------
    ring : Outline
        Any ring.
    flattest : float
        Edges of a smaller bulge count as straight.

    Returns
    -------
    vertices : ndarray of float64, shape (V, 2)
        In the ring's unit.
    arcs : ndarray of float64, shape (V, 5)
        Radius, 0 for a straight edge, centre x, y, first angle and sweep.
    """
    vertices, arcs = [], []
    ends = np.roll(ring.vertices, -1, axis=0)
    for start, end, bulge in zip(ring.vertices, ends, ring.bulges, strict=True):
        if abs(bulge) < flattest:
            vertices.append(start)
            arcs.append((0.0, 0.0, 0.0, 0.0, 0.0))
            continue
        centre, radius, first, sweep = apertures.arc_of(start, end, float(bulge))
        pieces = math.ceil(abs(sweep) / LONGEST_ARC)
        for piece in range(pieces):
            angle = first + sweep * piece / pieces
            point = centre + radius * np.array([math.cos(angle), math.sin(angle)])
            vertices.append(point if piece else start)
            arcs.append((radius, centre[0], centre[1], angle, sweep / pieces))
    return np.array(vertices), np.array(arcs)


@lru_cache(maxsize=64)
def _boundary(ring: _Ring, reach: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return nodes p and steps dp that integrate waves of up to so many cycles along the boundary."""
    points, steps = [], []
    ends = np.roll(ring.vertices, -1, axis=0)
    for start, end, (radius, x, y, first, sweep) in zip(ring.vertices, ends, ring.arcs, strict=True):
        travel = radius * abs(sweep) if radius else math.hypot(*(end - start))
        nodes, weights = gauss(node_count(math.pi * reach * travel) + (6 if radius else 0))
        where, share = (nodes + 1) / 2, weights[:, None] / 2
        if radius:
            cosine, sine = np.cos(first + sweep * where), np.sin(first + sweep * where)
            points.append(np.array([x, y]) + radius * np.stack([cosine, sine], axis=1))
            steps.append(radius * sweep * share * np.stack([-sine, cosine], axis=1))
        else:
            points.append(start + where[:, None] * (end - start))
            steps.append(share * (end - start))
    return np.concatenate(points), np.concatenate(steps)


def node_count(half_phase: float, error: float = QUADRATURE_ERROR) -> int:
    """Return how many Gauss-Legendre nodes integrate exp(ikt) over [−1, 1].

    Parameters
    ----------
    half_phase : float
        k, radians.
    error : float
        Of the integral.

    Returns
    -------
    int
        At least 2.
    """
    count, log_error = 1, math.inf
    while log_error > math.log(error):
        count += 1
        # 2^(2n+1) n!⁴ k^(2n) / ((2n + 1) (2n)!³)
        log_error = (
            (2 * count + 1) * math.log(2)
            + 4 * math.lgamma(count + 1)
            + 2 * count * math.log(max(half_phase, 1e-9))
            - math.log(2 * count + 1)
            - 3 * math.lgamma(2 * count + 1)
        )
    return count


@lru_cache(maxsize=64)
def gauss(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the Gauss-Legendre nodes and weights over [−1, 1].

    Parameters
    ----------
    count : int
        How many.

    Returns
    -------
    nodes, weights : ndarray of float64, shape (count,)
        Not to be written into.
    """
    return np.polynomial.legendre.leggauss(count)


def _prepared_centred(
    shape: _Shape, grid: Grid, unit: float
) -> tuple[Any, NDArray[np.complex64], tuple[int, int]]:
    """Return what the kernels read on a centred grid: a quarter of it for symmetric shapes, else a half."""
    (rows, columns), (step_y, step_x) = grid.shape, grid.spacing
    first = 0 if shape.mirror else -(columns // 2)
    u = np.arange(first, columns // 2 + 1, dtype=np.float64) * (step_x * unit)
    v = np.arange(rows // 2 + 1, dtype=np.float64) * (step_y * unit)
    return _prepared(shape, u, v)


def _prepared(
    shape: _Shape, u: NDArray[np.float64], v: NDArray[np.float64]
) -> tuple[Any, NDArray[np.complex64], tuple[int, int]]:
    """Return what the kernels read: the waves of all vertices, and the core with its corner."""
    from aureole.diffraction import _kernels_arcs, _kernels_polygons

    rings, discs = shape.rings, shape.discs
    no_vertex = np.empty((0, 2))
    vertices = np.concatenate([no_vertex, *(ring.vertices for ring in rings)])
    ends = np.concatenate([no_vertex, *(np.roll(ring.vertices, -1, axis=0) for ring in rings)])
    arcs = np.concatenate([np.empty((0, 5)), *(ring.arcs for ring in rings)])
    starts = np.cumsum([0] + [len(ring.vertices) for ring in rings])
    points = np.concatenate([vertices, discs[:, :2]])
    tiled = to_whole_tiles(u, _kernels_arcs.TILE)
    near = np.array([_left_out(ring, u, v) for ring in rings], dtype=np.int64).reshape(-1, 2, len(v))
    waves = _kernels_polygons.Waves(
        tiled,
        v,
        _waves(points[:, 0], tiled),
        _waves(points[:, 1], v),
        ends - vertices,
        _directions(arcs),
        starts,
        np.array([ring.weight for ring in rings], dtype=np.float64),
        near,
        discs[:, 2:].copy(),
        bool(len(discs) or np.any(arcs[:, 0])),
    )
    return waves, *_core(rings, near, u, v)


def to_whole_tiles(u: NDArray[np.float64], tile: int) -> NDArray[np.float64]:
    """Continue the columns to a multiple of the tile.

    Parameters
    ----------
    u : ndarray of float64, shape (C,)
        Evenly spaced.
    tile : int
        Columns of a tile.

    Returns
    -------
    ndarray of float64
        The same columns and up to `tile` − 1 more.
    """
    step = u[1] - u[0] if len(u) > 1 else 1.0
    spare = -len(u) % tile
    return np.concatenate([u, u[-1] + step * np.arange(1, spare + 1)])


def _waves(places: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return the real and the imaginary part of exp(−i2π q x), shape (2, V, C)."""
    turns = places[:, None] * q
    angle = (-2 * np.pi * (turns - np.rint(turns))).astype(np.float32)
    return np.stack([np.cos(angle), np.sin(angle)])


def _directions(arcs: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn angles into cosines and sines at an arc's start, end and middle; shape (V, 9)."""
    radius, x, y, first, sweep = arcs.T
    angles = [first, first + sweep, first + sweep / 2]
    return np.stack([radius, x, y, *(f(a) for a in angles for f in (np.cos, np.sin))], axis=1)


def _left_out(
    ring: _Ring, u: NDArray[np.float64], v: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first column of each row within the ring's core, and the first after it."""
    half = np.sqrt(np.maximum(ring.near**2 - v**2, 0.0))
    inside = np.abs(v) < ring.near
    first, after = np.searchsorted(u, -half), np.searchsorted(u, half, side="right")
    return np.where(inside, first, 0), np.where(inside, after, 0)


def _core(
    rings: list[_Ring], near: NDArray[np.int64], u: NDArray[np.float64], v: NDArray[np.float64]
) -> tuple[NDArray[np.complex64], tuple[int, int]]:
    """Sum each ring over its core; return that part of the plane and its corner."""
    lit = near[:, 1] > near[:, 0]
    if not lit.any():
        return np.empty((0, 0), dtype=np.complex64), (0, 0)
    rows = np.flatnonzero(lit.any(axis=0))
    top, bottom = int(rows[0]), int(rows[-1]) + 1
    left, right = int(near[:, 0][lit].min()), int(near[:, 1][lit].max())
    core = np.zeros((bottom - top, right - left), dtype=np.complex64)
    for ring, (first, after) in zip(rings, near, strict=True):
        for low in range(top, bottom, CORE_ROWS):
            part = slice(low, min(low + CORE_ROWS, bottom))
            column = np.arange(left, right)
            inside = (column >= first[part, None]) & (column < after[part, None])
            if inside.any():
                value = _by_quadrature(ring, u[left:right], v[part])
                core[low - top : part.stop - top] += np.where(inside, value, 0)
    return core, (top, left)


def _by_quadrature(ring: _Ring, u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return a ring's field from its nodes, with the moments' series at the origin."""
    farthest = max(math.hypot(np.abs(u).max(), np.abs(v).max()), 1e-9)
    # Halves of the core's radius, so that few sets of nodes serve all grids.
    nodes, steps = _boundary(ring, ring.near / 2.0 ** max(0, math.floor(math.log2(ring.near / farthest))))
    (x, y), (dx, dy) = nodes.T, steps.T
    wave_x = np.exp(-2j * np.pi * np.outer(x, u))
    wave_y = np.exp(-2j * np.pi * np.outer(v, y))
    # u Σ P dy − v Σ P dx as one product
    rows = np.concatenate([wave_y * dy, wave_y * (-dx) * v[:, None]], axis=1)
    total = rows @ np.concatenate([wave_x * u, wave_x])
    square = v[:, None] ** 2 + u**2
    tiny = square * np.trace(ring.second) / ring.area < 1e-9
    value = 1j * total / (2 * np.pi * np.where(tiny, 1.0, square))
    if tiny.any():
        (xx, xy), (_, yy) = ring.second
        quadratic = xx * u**2 + 2 * xy * u * v[:, None] + yy * v[:, None] ** 2
        angle = -2 * np.pi * (u * ring.centroid[0] + v[:, None] * ring.centroid[1])
        value = np.where(tiny, (ring.area - 2 * np.pi**2 * quadratic) * np.exp(1j * angle), value)
    return np.asarray(value * ring.weight)
