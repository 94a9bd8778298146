"""Geometry of outlines: arcs from bulges, chords, areas, moments and energy.

The bulge of an edge is tan(sweep / 4) of its arc, so one number tells the arc's radius and centre.
Everything here is exact for straight edges and circular arcs, except `chords`, which says how far
it may stray, and overlaps of outlines, which are measured on such chords.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole.records import Aperture, Outline

# Chords that stand for arcs where shapes are cut stray by this part of the aperture's width.
CUT_TOLERANCE = 1e-7
GAUSS_NODES = 12
NODES, WEIGHTS = np.polynomial.legendre.leggauss(GAUSS_NODES)
# Corners that are as near as this, of the size, are one; longer rings are not searched for symmetry.
SAME_PLACE, MOST_COMPARED = 1e-12, 512


@dataclass(frozen=True)
class Circle:
    """A full circle.

    Parameters
    ----------
    x, y : float
        Centre, metres.
    radius : float
        Metres.
    """

    x: float
    y: float
    radius: float


def arc_of(
    start: NDArray[np.float64], end: NDArray[np.float64], bulge: float
) -> tuple[NDArray[np.float64], float, float, float]:
    """Return centre, radius, first angle and sweep of the arc of an edge.

    Parameters
    ----------
    start, end : ndarray, shape (2,)
        The edge's ends (x, y) in metres.
    bulge : float
        tan(sweep / 4), not zero.

    Returns
    -------
    centre : ndarray, shape (2,)
        Metres.
    radius : float
        Metres, positive.
    first : float
        Angle of `start` seen from the centre, radians from +x towards +y.
    sweep : float
        Signed angle from `start` to `end`, radians.
    """
    chord = end - start
    left = np.array([-chord[1], chord[0]])
    centre = (start + end) / 2 + left * (1 - bulge**2) / (4 * bulge)
    radius = math.hypot(*chord) * (1 + bulge**2) / (4 * abs(bulge))
    first = math.atan2(start[1] - centre[1], start[0] - centre[0])
    return centre, radius, first, 4 * math.atan(bulge)


def as_circle(outline: Outline) -> Circle | None:
    """Return the circle that an outline of two half arcs draws, or None.

    Parameters
    ----------
    outline : Outline
        Any ring.

    Returns
    -------
    Circle or None
        None where the ring is not a full circle of two halves.
    """
    half = outline.bulges.shape == (2,) and bool(np.all(outline.bulges == outline.bulges[0]))
    if not half or abs(outline.bulges[0]) != 1:
        return None
    first, second = outline.vertices
    x, y = (first + second) / 2
    return Circle(float(x), float(y), math.hypot(*(second - first)) / 2)


def chords(outline: Outline, tolerance: float) -> NDArray[np.float64]:
    """Replace arcs by chords that stray from them by less than a tolerance.

    Parameters
    ----------
    outline : Outline
        Any ring.
    tolerance : float
        Largest distance between chord and arc, metres.

    Returns
    -------
    ndarray, shape (K, 2)
        Vertices (x, y) in metres, those of the outline among them.
    """
    if not np.any(outline.bulges):
        return outline.vertices
    pieces = []
    for start, end, bulge in edges(outline):
        if bulge == 0:
            pieces.append(start[None])
            continue
        centre, radius, first, sweep = arc_of(start, end, bulge)
        # The sagitta r (1 − cos(step / 2)) stays below the tolerance.
        step = 2 * math.acos(1 - min(tolerance / radius, 0.5))
        angles = first + sweep * np.linspace(0, 1, math.ceil(abs(sweep) / step) + 1)[:-1]
        points = centre + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        points[0] = start
        pieces.append(points)
    return np.concatenate(pieces)


def boundary_nodes(outline: Outline, panel_length: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return Gauss-Legendre nodes along the boundary, for integrals over it.

    Parameters
    ----------
    outline : Outline
        Any ring.
    panel_length : float
        Longest piece of boundary that one set of twelve nodes serves, metres.

    Returns
    -------
    points : ndarray, shape (K, 2)
        Positions (x, y), metres.
    steps : ndarray, shape (K, 2)
        Boundary element dp at each node times its weight, metres.
    """
    points, steps = [], []
    for start, end, bulge in edges(outline):
        chord = end - start
        length = math.hypot(*chord) * _arc_over_chord(bulge)
        panels = max(1, math.ceil(length / panel_length))
        where = ((np.arange(panels)[:, None] + (NODES + 1) / 2) / panels).ravel()
        share = np.tile(WEIGHTS / (2 * panels), panels)
        if bulge == 0:
            points.append(start + where[:, None] * chord)
            steps.append(share[:, None] * chord)
        else:
            centre, radius, first, sweep = arc_of(start, end, bulge)
            cosine, sine = np.cos(first + sweep * where), np.sin(first + sweep * where)
            points.append(centre + radius * np.stack([cosine, sine], axis=1))
            steps.append((radius * sweep * share)[:, None] * np.stack([-sine, cosine], axis=1))
    return np.concatenate(points), np.concatenate(steps)


def ring_moments(outline: Outline) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Return area, first and second moments of a ring's inside, signed by its direction.

    Parameters
    ----------
    outline : Outline
        Any ring; transmittance is not counted.

    Returns
    -------
    area : float
        Square metres; positive where the ring turns from +x towards +y.
    first : ndarray, shape (2,)
        Integrals of x and y, m³.
    second : ndarray, shape (2, 2)
        Integrals of xx, xy, yy, m⁴.
    """
    points, steps = boundary_nodes(outline, math.inf)
    (x, y), (dx, dy) = points.T, steps.T
    # Green's theorem turns each area integral into one over the boundary.
    area_ = float(np.sum(x * dy - y * dx)) / 2
    first = np.array([np.sum(x * x * dy) / 2, -np.sum(y * y * dx) / 2])
    xy = np.sum(x * x * y * dy) / 2
    second = np.array([[np.sum(x**3 * dy) / 3, xy], [xy, -np.sum(y**3 * dx) / 3]])
    return area_, first, second


def central_moments(outline: Outline) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Return area, centroid and second moments about the centroid of a ring's inside.

    Parameters
    ----------
    outline : Outline
        Any ring; transmittance is not counted.

    Returns
    -------
    area : float
        Square metres; positive where the ring turns from +x towards +y.
    centroid : ndarray, shape (2,)
        Metres.
    second : ndarray, shape (2, 2)
        Integrals of xx, xy, yy from the centroid, m⁴, signed like the area.
    """
    # Moments about a corner first, lest a small ring far off the axis lose its digits.
    corner = outline.vertices[0]
    area_, first, second = ring_moments(Outline(outline.vertices - corner, outline.bulges))
    offset = first / area_
    return area_, corner + offset, second - area_ * np.outer(offset, offset)


def is_mirrored(outline: Outline, axis: int) -> bool:
    """Say whether a ring is its own mirror image where one coordinate changes its sign.

    Parameters
    ----------
    outline : Outline
        Any ring; one of more than 512 corners is not searched.
    axis : int
        0 where x changes its sign, 1 where y does.

    Returns
    -------
    bool
        To 1e-12 of its size.
    """
    count = len(outline.vertices)
    if count > MOST_COMPARED:
        return False
    signs = (-1.0 if axis == 0 else 1.0, -1.0 if axis == 1 else 1.0)
    distances = np.abs((outline.vertices * signs)[:, None] - outline.vertices).max(axis=2)
    there = distances.argmin(axis=1)
    if distances.min(axis=1).max() > SAME_PLACE * np.max(np.abs(outline.vertices)):
        return False
    # The image runs the other way round: edge j lies where the edge before its start's image was.
    before = np.roll(there, -1)
    bent_alike = np.allclose(outline.bulges[before], outline.bulges, rtol=0, atol=SAME_PLACE)
    return bool((before == (there - 1) % count).all()) and bent_alike


def orientation(outline: Outline) -> float:
    """Return +1 where a ring turns from +x towards +y, −1 where it turns the other way.

    Parameters
    ----------
    outline : Outline
        Any ring.

    Returns
    -------
    float
        +1.0 or −1.0.
    """
    return math.copysign(1.0, ring_moments(outline)[0])


def area(aperture: Aperture) -> float:
    """Return the integral of the amplitude transmittance: the far field's value at the origin.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.

    Returns
    -------
    float
        Square metres.
    """
    if aperture.mask is not None:
        pixel = aperture.width**2 / aperture.mask.size
        return float(aperture.mask.sum(dtype=np.float64)) * pixel
    return sum(abs(ring_moments(ring)[0]) * ring.transmittance for ring in aperture.outlines)


def energy(aperture: Aperture) -> float:
    """Return the integral of the squared transmittance: what passes of a unit irradiance.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.

    Returns
    -------
    float
        Square metres; by Parseval also the integral of the far field's squared modulus.
    """
    if aperture.mask is not None:
        pixel = aperture.width**2 / aperture.mask.size
        return float(np.sum(np.square(aperture.mask, dtype=np.float64))) * pixel
    rings = aperture.outlines
    total = 0.0
    for i, ring in enumerate(rings):
        total += ring.transmittance**2 * abs(ring_moments(ring)[0])
        for other in rings[:i]:
            shared = _shared_area(ring, other, aperture.width)
            total += 2 * ring.transmittance * other.transmittance * shared
    return total


def region(outline: Outline, width: float) -> Any:
    """Return a ring's inside as a shapely polygon of straight edges.

    Parameters
    ----------
    outline : Outline
        Any ring.
    width : float
        The aperture's width in metres, which sets how fine the chords are.

    Returns
    -------
    shapely.Polygon
        Vertices in units of `width`, where shapely's tolerances suit.
    """
    from shapely import Polygon

    return Polygon(chords(outline, CUT_TOLERANCE * width) / width)


def _shared_area(ring: Outline, other: Outline, width: float) -> float:
    """Return the area that two rings share, exact where one lies within the other."""
    inside, outside = region(ring, width), region(other, width)
    if inside.within(outside):
        return abs(ring_moments(ring)[0])
    if outside.within(inside):
        return abs(ring_moments(other)[0])
    return float(inside.intersection(outside).area) * width**2


def edges(outline: Outline) -> list[tuple[NDArray[np.float64], NDArray[np.float64], float]]:
    """List the edges of a ring.

    Parameters
    ----------
    outline : Outline
        Any ring.

    Returns
    -------
    list of tuple
        Start (2,), end (2,) in metres and bulge of each.
    """
    ends = np.roll(outline.vertices, -1, axis=0)
    return [
        (start, end, float(bulge))
        for start, end, bulge in zip(outline.vertices, ends, outline.bulges, strict=True)
    ]


def _arc_over_chord(bulge: float) -> float:
    if bulge == 0:
        return 1.0
    return abs(2 * math.atan(bulge) * (1 + bulge**2) / (2 * bulge))
