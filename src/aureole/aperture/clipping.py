"""What of a ring lies within a circle, with exact edges: arcs stay arcs, and the circle adds its own.

Edges are cut where they cross the circle. What lies inside is followed along the ring until it leaves,
then along the circle, in the ring's own direction, to where the ring comes in next.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole.aperture.geometry import Circle, arc_of, edges, orientation
from aureole.records import Outline

# Cuts nearer than this part of an edge to its ends, or to each other, are one.
SAME_PLACE = 1e-12
POINT_ON_CIRCLE = 1e-9

Point = NDArray[np.float64]


@dataclass(frozen=True)
class _Piece:
    """A piece of the ring within the circle, which it enters at its start and leaves at its end."""

    vertices: list[Point]
    bulges: list[float]
    end: Point


def within_circle(ring: Outline, circle: Circle) -> list[Outline] | None:
    """Return what of a ring lies within a circle.

    Parameters
    ----------
    ring : Outline
        Any ring that does not cross itself.
    circle : Circle
        Metres.

    Returns
    -------
    list of Outline or None
        Rings without holes, transmittance 1, in the ring's direction; the ring itself where it lies within
        the circle. None where no edge of it does, or where it meets the circle in no clear way.
    """
    centre = np.array([circle.x, circle.y])
    # In units of the radius, about the circle's centre.
    unit = Outline((ring.vertices - centre) / circle.radius, ring.bulges)
    parts = [part for edge in edges(unit) for part in _cut(*edge)]
    inside = [_is_inside(part) for part in parts]
    if all(inside):
        return [Outline(ring.vertices, ring.bulges)]
    if not any(inside):
        return None
    loops = _joined(_pieces(parts, inside), orientation(ring))
    if loops is None:
        return None
    return [
        Outline(np.array(vertices) * circle.radius + centre, np.array(bulges)) for vertices, bulges in loops
    ]


def _cut(start: Point, end: Point, bulge: float) -> list[tuple[Point, Point, float]]:
    """Cut an edge where it crosses the unit circle."""
    places = _line_crossings(start, end) if bulge == 0 else _arc_crossings(start, end, bulge)
    kept = [0.0]
    for t in sorted(places):
        if t - kept[-1] > SAME_PLACE and t < 1 - SAME_PLACE:
            kept.append(t)
    kept.append(1.0)
    points = [_at(start, end, bulge, t) for t in kept]
    turn = math.atan(bulge)
    return [
        (points[k], points[k + 1], math.tan(turn * (kept[k + 1] - kept[k]))) for k in range(len(kept) - 1)
    ]


def _line_crossings(start: Point, end: Point) -> list[float]:
    """Solve |p + t d|² = 1."""
    along = end - start
    a, b, c = float(along @ along), float(start @ along), float(start @ start) - 1
    if b * b - a * c <= 0:
        return []
    # The root without cancellation first; the product of both is c / a.
    q = -(b + math.copysign(math.sqrt(b * b - a * c), b))
    return [t for t in (q / a, c / q if q else -1.0) if 0 < t < 1]


def _arc_crossings(start: Point, end: Point, bulge: float) -> list[float]:
    """Solve |c + r (cos φ, sin φ)|² = 1 for an arc's centre c and radius r."""
    centre, radius, first, sweep = arc_of(start, end, bulge)
    apart = math.hypot(*centre)
    if apart == 0:
        return []
    cosine = (1 - apart**2 - radius**2) / (2 * radius * apart)
    if abs(cosine) >= 1:
        return []
    towards, away = math.atan2(centre[1], centre[0]), math.acos(cosine)
    found = []
    for angle in (towards - away, towards + away):
        # The way from the arc's start, along its sweep.
        t = (math.copysign(1, sweep) * (angle - first) % (2 * math.pi)) / abs(sweep)
        if t < 1:
            found.append(t)
    return found


def _at(start: Point, end: Point, bulge: float, t: float) -> Point:
    """Return the point a part t along an edge."""
    if t in (0.0, 1.0):
        return end if t else start
    if bulge == 0:
        return np.asarray(start + t * (end - start))
    centre, radius, first, sweep = arc_of(start, end, bulge)
    angle = first + t * sweep
    return np.asarray(centre + radius * np.array([math.cos(angle), math.sin(angle)]))


def _is_inside(part: tuple[Point, Point, float]) -> bool:
    """Return whether the middle of a part that does not cross the circle is within it."""
    return math.hypot(*_at(*part, 0.5)) < 1


def _pieces(parts: list[tuple[Point, Point, float]], inside: list[bool]) -> list[_Piece]:
    """Gather the parts inside into pieces between entering the circle and leaving it."""
    count = len(parts)
    pieces = []
    for k in range(count):
        if not inside[k] or inside[k - 1]:
            continue
        vertices, bulges, j = [], [], k
        while inside[j % count]:
            start, end, bulge = parts[j % count]
            vertices.append(start)
            bulges.append(bulge)
            j += 1
        pieces.append(_Piece(vertices, bulges, end))
    return pieces


def _joined(pieces: list[_Piece], direction: float) -> list[tuple[list[Point], list[float]]] | None:
    """Join the pieces by arcs of the circle, each from where one leaves to where the next enters."""
    ends = [(piece.vertices[0], piece.end) for piece in pieces]
    if any(abs(math.hypot(*point) - 1) > POINT_ON_CIRCLE for pair in ends for point in pair):
        return None
    following = [_next_entry(pieces, piece.end, direction) for piece in pieces]
    if len(set(following)) != len(pieces):
        return None
    loops, left = [], set(range(len(pieces)))
    while left:
        first = k = min(left)
        vertices: list[Point] = []
        bulges: list[float] = []
        while True:
            left.discard(k)
            vertices += pieces[k].vertices
            bulges += pieces[k].bulges
            _add_arc(vertices, bulges, pieces[k].end, pieces[following[k]].vertices[0], direction)
            k = following[k]
            if k == first:
                break
        loops.append((vertices, bulges))
    return loops


def _next_entry(pieces: list[_Piece], leaving: Point, direction: float) -> int:
    """Return the piece whose start comes first along the circle."""
    ways = [_way(leaving, piece.vertices[0], direction) for piece in pieces]
    return int(np.argmin(ways))


def _way(start: Point, end: Point, direction: float) -> float:
    """Return the angle from one point on the circle to another, 0 to 2π, in a direction."""
    angle = math.atan2(end[1], end[0]) - math.atan2(start[1], start[0])
    return (direction * angle) % (2 * math.pi)


def _add_arc(vertices: list[Point], bulges: list[float], start: Point, end: Point, direction: float) -> None:
    """Add the circle's arc from one point to another, in halves where it is more than half a circle."""
    way = _way(start, end, direction)
    halves = 2 if way > math.pi else 1
    first = math.atan2(start[1], start[0])
    for half in range(halves):
        angle = first + direction * way * half / halves
        vertices.append(np.array([math.cos(angle), math.sin(angle)]) if half else start)
        bulges.append(direction * math.tan(way / halves / 4))
