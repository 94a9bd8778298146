"""What stands between a light and an opening: silhouettes and mattes at a distance, and their shadows.

A point p of the opening sees a point of light in the direction t (its tangents, right and downward) at the
distance D through q = p (1 − d/D) + d t of a plane at the distance d. So what stands in that plane throws a
shadow that is 1 / (1 − d/D) times as large, and moves against the light (quad paper §4.4: the scene is
drawn towards the aperture, as seen from each sample of the light).

The shadow's edge is sharp here. The wave that passes the occluder blurs it over about √(λ d (1 − d/D)),
0.5 mm for half a metre: occluders whose parts are not much larger than that are not served well.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.aperture.compose import subtraction
from aureole.aperture.geometry import area
from aureole.aperture.masks import rasterize
from aureole.records import Aperture, Outline

# An opening with less than this part of its light left is blocked but for rounding.
NOTHING = 1e-9


@dataclass(frozen=True, eq=False)
class Occluder:
    """Something opaque before an opening, flat and parallel to it.

    Parameters
    ----------
    shape : Aperture
        Its silhouette as the opening of its shape, or a matte: a raster that is 1 where it is opaque.
        Metres, as seen from the opening. Rings of a silhouette do not overlap.
    distance : float
        From the opening, metres.
    place : tuple of float
        Of the silhouette's origin from the axis, metres to the right and downward.
    """

    shape: Aperture
    distance: float
    place: tuple[float, float] = (0.0, 0.0)

    def moved_to(self, x: float, y: float) -> "Occluder":
        """Return the same occluder at another place, metres to the right and downward."""
        return replace(self, place=(refuse.finite("x", x), refuse.finite("y", y)))


def occluder(shape: Aperture, distance: float, place: tuple[float, float] = (0.0, 0.0)) -> Occluder:
    """Make an occluder.

    Parameters
    ----------
    shape : Aperture
        Silhouette or matte, metres.
    distance : float
        From the opening, metres, > 0.
    place : tuple of float
        Of its origin from the axis, metres to the right and downward.

    Returns
    -------
    Occluder
        With the numbers as given.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, or the shape has a wavefront.
    """
    if shape.wavefront is not None:
        raise refuse.Refusal("an occluder cannot have a wavefront; give its silhouette alone.")
    x, y = refuse.all_finite("place", refuse.shape_of("place", place, (2,)))
    return Occluder(shape, refuse.positive("distance", distance), (float(x), float(y)))


def railing(bar: float, gap: float, count: int, height: float, rotation: float = 0.0) -> Aperture:
    """Return the silhouette of parallel bars, such as a railing's, upright unless turned.

    Parameters
    ----------
    bar, gap : float
        Width of a bar and of the gap between two, metres.
    count : int
        Number of bars.
    height : float
        Length of the bars, metres.
    rotation : float
        Radians, counter-clockwise as seen.

    Returns
    -------
    Aperture
        One ring a bar; an odd number has one in the middle, an even number a gap.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    half = refuse.positive("bar", bar) / 2
    pitch = 2 * half + refuse.positive("gap", gap)
    reach = refuse.positive("height", height) / 2
    refuse.at_least("count", count, 1)
    angle = refuse.finite("rotation", rotation)
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    corners = np.array([[-half, -reach], [half, -reach], [half, reach], [-half, reach]])
    middles = (np.arange(count) - (count - 1) / 2) * pitch
    rings = [Outline((corners + np.array([x, 0.0])) @ turn, np.zeros(4)) for x in middles]
    width = 2 * max(float(np.abs(ring.vertices).max()) for ring in rings)
    return Aperture(width, tuple(rings), name=f"railing of {count} bars")


def seen_past(
    opening: Aperture,
    occluders: Sequence[Occluder],
    toward: tuple[float, float] = (0.0, 0.0),
    distance: float = math.inf,
    size: int | None = None,
) -> Aperture | None:
    """Return what of an opening a point of light reaches past what stands between them.

    Parameters
    ----------
    opening : Aperture
        Outlines or a raster, at its size in metres.
    occluders : sequence of Occluder
        Those at the light's distance or beyond it cover nothing.
    toward : tuple of float
        Tangents of the light's direction, to the right and downward.
    distance : float
        The light's, metres; infinite for the sun and the stars.
    size : int, optional
        Pixels a side to which all is rasterized; needed for mattes before outlines.

    Returns
    -------
    Aperture or None
        The opening less the shadows, on its width; outlines where all are outlines and no size is given.
        None where the light is hidden from all of it.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, or a matte needs a size.
    """
    x, y = refuse.all_finite("toward", refuse.shape_of("toward", toward, (2,)))
    if not distance > 0:
        raise refuse.Refusal(f"'distance' must be > 0, got {distance:g}.")
    before = [each for each in occluders if each.distance < distance]
    if size is None and opening.mask is not None:
        size = len(opening.mask)
    if size is not None:
        return _raster_past(opening, before, (float(x), float(y)), distance, size)
    whole = area(opening)
    left: Aperture = opening
    for each in before:
        if each.shape.mask is not None:
            raise refuse.Refusal("a matte covers pixels of an opening; give 'size', pixels a side.")
        shade = _shadow_rings(each, (float(x), float(y)), distance, opening.width)
        if not shade:
            continue
        try:
            left = subtraction(left, Aperture(opening.width, shade, name="shadow"))
        except refuse.Refusal:
            # Nothing is left of it.
            return None
        if area(left) <= NOTHING * whole:
            return None
    return replace(left, width=opening.width, name=opening.name)


def _projection(
    occluder: Occluder, toward: tuple[float, float], distance: float
) -> tuple[float, float, float]:
    """Return how many times as large a shadow is, and where the silhouette's origin falls."""
    factor = 1 / (1 - occluder.distance / distance)
    x, y = (
        (at - occluder.distance * tangent) * factor
        for at, tangent in zip(occluder.place, toward, strict=True)
    )
    return factor, x, y


def _shadow_rings(
    occluder: Occluder, toward: tuple[float, float], distance: float, width: float
) -> tuple[Outline, ...]:
    """Return the rings of a shadow that come near a square of a width."""
    factor, x, y = _projection(occluder, toward, distance)
    rings = []
    for ring in occluder.shape.outlines:
        vertices = ring.vertices * factor + [x, y]
        # Arcs swell beyond their corners, by no more than a chord's length for a half circle.
        swell = float(np.ptp(vertices, axis=0).max()) if np.any(ring.bulges) else 0.0
        low, high = vertices.min(axis=0) - swell, vertices.max(axis=0) + swell
        if np.all(high > -width / 2) and np.all(low < width / 2):
            rings.append(Outline(vertices, ring.bulges, ring.transmittance))
    return tuple(rings)


def _raster_past(
    opening: Aperture, occluders: Sequence[Occluder], toward: tuple[float, float], distance: float, size: int
) -> Aperture | None:
    """Multiply an opening's pixels with what each occluder leaves of them."""
    mask = rasterize(opening, size)
    whole = float(mask.sum(dtype=np.float64))
    for each in occluders:
        mask *= 1 - _shadow_mask(each, toward, distance, opening.width, size)
    if float(mask.sum(dtype=np.float64)) <= NOTHING * whole:
        return None
    return Aperture(opening.width, mask=mask, name=opening.name, wavefront=opening.wavefront)


def _shadow_mask(
    occluder: Occluder, toward: tuple[float, float], distance: float, width: float, size: int
) -> NDArray[np.float32]:
    """Paint a shadow on a square, each pixel the mean over its area."""
    if occluder.shape.mask is None:
        rings = _shadow_rings(occluder, toward, distance, width)
        return rasterize(Aperture(width, rings), size) if rings else np.zeros((size, size), np.float32)
    factor, x, y = _projection(occluder, toward, distance)
    matte, side = occluder.shape.mask, occluder.shape.width * factor
    rows, columns = (
        _overlaps(at - side / 2, side / count, count, width, size)
        for at, count in zip((y, x), matte.shape, strict=True)
    )
    return np.asarray(np.clip(rows @ matte @ columns.T, 0, 1), dtype=np.float32)


def _overlaps(first: float, step: float, count: int, width: float, size: int) -> NDArray[np.float64]:
    """Return which part of each pixel of a square each of a row of equal strips covers, (size, count)."""
    edges = np.linspace(-width / 2, width / 2, size + 1)
    strips = first + step * np.arange(count + 1)
    low = np.maximum(strips[None, :-1], edges[:-1, None])
    high = np.minimum(strips[None, 1:], edges[1:, None])
    return np.asarray(np.clip(high - low, 0, None) * (size / width))
