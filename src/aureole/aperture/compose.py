"""Openings from openings: union, intersection, subtraction, and moving them about.

With transmittances a and b at a point, the intersection lets through a·b, the subtraction
a·(1 − b) and the union 1 − (1 − a)·(1 − b). Rings add up, so all three follow from products of
rings. A ring that lies within another keeps its exact arcs, and so does one that crosses a full circle;
where other arcs cross, they become chords that stray by less than 1e-7 of the width. With a raster among
them the result is a raster. A wavefront goes where its raster goes unchanged, and is refused where it
would be resampled or lose its meaning.
"""

import itertools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.aperture.clipping import within_circle
from aureole.aperture.geometry import CUT_TOLERANCE, as_circle, region, ring_moments
from aureole.aperture.masks import rasterize
from aureole.records import Aperture, Outline

# Slivers below this part of the width's square are rounding, not shape.
SLIVER = 1e-13
# Where borders cancel, vertices are the same if they are within this part of the width.
SNAP = 1e-12
# And sums of rings are the opening itself if their areas agree to this part of the width's square.
ROUNDING = 1e-9


def intersection(first: Aperture, second: Aperture) -> Aperture:
    """Let through what both let through.

    Parameters
    ----------
    first, second : Aperture
        Outlines or rasters.

    Returns
    -------
    Aperture
        Transmittance a·b on the width of the first, the wavefronts added up.

    Raises
    ------
    refuse.Refusal
        Where nothing is left, or a wavefront would be resampled.
    """
    if first.mask is not None or second.mask is not None:
        masks = _on_one_raster(first, second, first.width)
        wavefront = _sum_of_wavefronts(first, second, len(masks[0]))
        return _raster(masks[0] * masks[1], first.width, "intersection", wavefront)
    return _vector(_products(first, second), first.width, f"{first.name} within {second.name}")


def subtraction(first: Aperture, second: Aperture) -> Aperture:
    """Block what the second lets through: an obstruction in an opening.

    Parameters
    ----------
    first : Aperture
        The opening.
    second : Aperture
        The obstruction, as the opening of its shape.

    Returns
    -------
    Aperture
        Transmittance a·(1 − b) on the width of the first, with its wavefront.

    Raises
    ------
    refuse.Refusal
        Where nothing is left, the obstruction has a wavefront, or one would be resampled.
    """
    if second.wavefront is not None:
        raise refuse.Refusal("an obstruction cannot have a wavefront; give the wavefront to what is left.")
    if first.mask is not None or second.mask is not None:
        masks = _on_one_raster(first, second, first.width)
        wavefront = _sum_of_wavefronts(first, second, len(masks[0]))
        return _raster(masks[0] * (1 - masks[1]), first.width, "subtraction", wavefront)
    rings = (*first.outlines, *_negative(_products(first, second)))
    return _vector(rings, first.width, f"{first.name} without {second.name}")


def union(first: Aperture, second: Aperture) -> Aperture:
    """Let through what either lets through.

    Parameters
    ----------
    first, second : Aperture
        Outlines or rasters.

    Returns
    -------
    Aperture
        Transmittance 1 − (1 − a)·(1 − b) on the larger of the two widths.

    Raises
    ------
    refuse.Refusal
        Where either has a wavefront.
    """
    if first.wavefront is not None or second.wavefront is not None:
        raise refuse.Refusal("a union cannot carry a wavefront; join first, then give it to the whole.")
    width = max(first.width, second.width)
    if first.mask is not None or second.mask is not None:
        masks = _on_one_raster(first, second, width)
        return _raster(1 - (1 - masks[0]) * (1 - masks[1]), width, "union")
    rings = (*first.outlines, *second.outlines, *_negative(_products(first, second)))
    return _vector(rings, width, f"{first.name} and {second.name}")


def dimmed(aperture: Aperture, transmittance: float) -> Aperture:
    """Multiply an aperture's amplitude transmittance.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.
    transmittance : float
        Amplitude factor, 0 < t <= 1; its square is the part of the energy that passes.

    Returns
    -------
    Aperture
        The same shape, darker.

    Raises
    ------
    refuse.Refusal
        Where the factor is outside its range.
    """
    factor = refuse.between("transmittance", refuse.positive("transmittance", transmittance), 0, 1)
    if aperture.mask is not None:
        return _raster(aperture.mask * factor, aperture.width, aperture.name, aperture.wavefront)
    rings = tuple(Outline(r.vertices, r.bulges, r.transmittance * factor) for r in aperture.outlines)
    return Aperture(aperture.width, rings, name=aperture.name)


def scaled(aperture: Aperture, factor: float) -> Aperture:
    """Make an aperture larger or smaller about the axis.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.
    factor : float
        Size of the result over that of the aperture, > 0.

    Returns
    -------
    Aperture
        The same shape, its width multiplied too; a wavefront keeps its optical paths.
    """
    refuse.positive("factor", factor)
    rings = tuple(Outline(r.vertices * factor, r.bulges, r.transmittance) for r in aperture.outlines)
    return Aperture(aperture.width * factor, rings, aperture.mask, aperture.name, aperture.wavefront)


def rotated(aperture: Aperture, angle: float) -> Aperture:
    """Turn an aperture with outlines about the axis.

    Parameters
    ----------
    aperture : Aperture
        Outlines; a raster is refused, since its pixels would blur.
    angle : float
        Radians, counter-clockwise as seen.

    Returns
    -------
    Aperture
        The turned shape on the same width, which grows where a corner would leave its square.

    Raises
    ------
    refuse.Refusal
        Where the aperture is a raster.
    """
    _need_outlines(aperture, "rotated")
    refuse.finite("angle", angle)
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    rings = tuple(Outline(r.vertices @ turn, r.bulges, r.transmittance) for r in aperture.outlines)
    return Aperture(_width_for(rings, aperture.width), rings, name=aperture.name)


def moved(aperture: Aperture, x: float, y: float) -> Aperture:
    """Shift an aperture with outlines off the axis.

    Parameters
    ----------
    aperture : Aperture
        Outlines; a raster is refused.
    x, y : float
        Metres, x to the right, y downward.

    Returns
    -------
    Aperture
        The shifted shape on a square that still holds it.

    Raises
    ------
    refuse.Refusal
        Where the aperture is a raster.
    """
    _need_outlines(aperture, "moved")
    shift = np.array([refuse.finite("x", x), refuse.finite("y", y)])
    rings = tuple(Outline(r.vertices + shift, r.bulges, r.transmittance) for r in aperture.outlines)
    return Aperture(_width_for(rings, aperture.width), rings, name=aperture.name)


def _products(first: Aperture, second: Aperture) -> tuple[Outline, ...]:
    """Return the rings of the product of two sums of rings."""
    width = max(first.width, second.width)
    return tuple(
        Outline(ring.vertices, ring.bulges, one.transmittance * other.transmittance)
        for one in first.outlines
        for other in second.outlines
        for ring in _overlap(one, other, width)
    )


def _overlap(one: Outline, other: Outline, width: float) -> list[Outline]:
    """Return the rings of what lies in both rings, holes with transmittance −1."""
    here, there = region(one, width), region(other, width)
    # Shapes that touch only within the chords' tolerance count as one within the other.
    if here.within(there) or here.difference(there).area < CUT_TOLERANCE * here.area:
        return [Outline(one.vertices, one.bulges)]
    if there.within(here):
        return [Outline(other.vertices, other.bulges)]
    exact = _cut_by_circle(one, other)
    if exact is not None:
        return [ring for ring in exact if abs(ring_moments(ring)[0]) > SLIVER * width**2]
    rings = []
    for piece in _polygons(here.intersection(there)):
        if piece.area > SLIVER:
            rings.append(_ring(piece.exterior, 1.0, width))
            rings += [_ring(hole, -1.0, width) for hole in piece.interiors]
    return [Outline(r.vertices, r.bulges, r.transmittance) for r in rings]


def _cut_by_circle(one: Outline, other: Outline) -> list[Outline] | None:
    """Return what lies in both rings where one of them is a circle and the other crosses it clearly."""
    for ring, cutter in ((one, as_circle(other)), (other, as_circle(one))):
        if cutter is not None:
            return within_circle(ring, cutter)
    return None


def _polygons(shape: Any) -> list[Any]:
    """Return the polygons of any shapely result, without the points and lines of mere contact."""
    if shape.geom_type == "Polygon":
        return [shape]
    return [part for part in getattr(shape, "geoms", ()) if part.geom_type == "Polygon"]


def _ring(ring: Any, transmittance: float, width: float) -> Outline:
    points = np.asarray(ring.coords, dtype=np.float64)[:-1] * width
    return Outline(points, np.zeros(len(points)), transmittance)


def _negative(rings: tuple[Outline, ...]) -> tuple[Outline, ...]:
    return tuple(Outline(r.vertices, r.bulges, -r.transmittance) for r in rings)


def _vector(rings: tuple[Outline, ...], width: float, name: str) -> Aperture:
    rings = _without_shared_borders(_without_pairs(rings), width)
    if not rings:
        raise refuse.Refusal(f"'{name}' lets no light through.")
    return Aperture(width, rings, name=name)


def _without_shared_borders(rings: tuple[Outline, ...], width: float) -> tuple[Outline, ...]:
    """Return straight-edged rings without borders along which two of them cancel.

    Such borders are no edges of the opening, and sums that treat edges one by one, as the closed form of
    a starburst does, would see light from them.
    """
    weights = {abs(ring.transmittance) for ring in rings}
    if len(rings) < 2 or len(weights) > 1 or any(np.any(ring.bulges) for ring in rings):
        return rings
    regions = [region(ring, width) for ring in rings]
    borders = [each.boundary for each in regions]
    if all(one.distance(two) > SNAP for one, two in itertools.combinations(borders, 2)):
        return rings
    inside = regions[0]
    for each in regions[1:]:
        inside = inside.symmetric_difference(each, grid_size=SNAP)
    weight = weights.pop()
    # Openings that are open once or not at all everywhere are open where an odd number of rings lie.
    total = sum(
        math.copysign(1, ring.transmittance) * one.area for ring, one in zip(rings, regions, strict=True)
    )
    if abs(total - inside.area) > ROUNDING:
        return rings
    left = []
    for piece in _polygons(inside):
        if piece.area > SLIVER:
            left.append(_ring(piece.exterior, weight, width))
            left += [_ring(hole, -weight, width) for hole in piece.interiors]
    return tuple(left)


def _without_pairs(rings: tuple[Outline, ...]) -> tuple[Outline, ...]:
    """Drop rings that stand twice with transmittances that cancel."""
    kept: list[Outline] = []
    for ring in rings:
        for index, other in enumerate(kept):
            same = np.array_equal(ring.vertices, other.vertices) and np.array_equal(ring.bulges, other.bulges)
            if same:
                total = ring.transmittance + other.transmittance
                kept[index : index + 1] = [Outline(ring.vertices, ring.bulges, total)] if total else []
                break
        else:
            kept.append(ring)
    return tuple(kept)


def _on_one_raster(
    first: Aperture, second: Aperture, width: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Paint two apertures on one square, as finely as the finer raster among them."""
    pixels = [a.width / len(a.mask) for a in (first, second) if a.mask is not None]
    size = max(1, round(width / min(pixels)))
    return _on_square(first, width, size), _on_square(second, width, size)


def _on_square(aperture: Aperture, width: float, size: int) -> NDArray[np.float64]:
    """Paint an aperture on a centred square of another width."""
    if aperture.mask is None:
        return rasterize(Aperture(width, aperture.outlines), size).astype(np.float64)
    edges = np.linspace(-width / 2, width / 2, size + 1)
    have = np.linspace(-aperture.width / 2, aperture.width / 2, len(aperture.mask) + 1)
    low = np.maximum(have[None, :-1], edges[:-1, None])
    high = np.minimum(have[None, 1:], edges[1:, None])
    overlap = np.clip(high - low, 0, None) * (size / width)
    return np.asarray(overlap @ aperture.mask @ overlap.T)


def _sum_of_wavefronts(first: Aperture, second: Aperture, size: int) -> NDArray[np.float32] | None:
    """Add up the wavefronts of two apertures whose pixels become those of one raster."""
    total: NDArray[np.float32] | None = None
    for each in (first, second):
        if each.wavefront is None:
            continue
        if len(each.wavefront) != size or each.width != first.width:
            raise refuse.Refusal(
                f"a wavefront of {len(each.wavefront)} pixels a side cannot be resampled to {size}; compose "
                "the openings first, then give the wavefront to the whole."
            )
        total = each.wavefront if total is None else total + each.wavefront
    return total


def _raster(
    mask: NDArray[Any], width: float, name: str, wavefront: NDArray[np.float32] | None = None
) -> Aperture:
    if not mask.any():
        raise refuse.Refusal(f"'{name}' lets no light through.")
    pixels = np.clip(mask, 0, 1).astype(np.float32)
    return Aperture(width, mask=pixels, name=name, wavefront=wavefront)


def _need_outlines(aperture: Aperture, verb: str) -> None:
    if aperture.mask is not None:
        raise refuse.Refusal(f"a raster cannot be {verb} exactly; change the picture, or use outlines.")


def _width_for(rings: tuple[Outline, ...], width: float) -> float:
    """Return a width whose square holds every ring."""
    reach = 0.0
    for ring in rings:
        box = np.abs(np.array(region(ring, width).bounds)) * width
        reach = max(reach, float(box.max()))
    return width if reach <= width / 2 * (1 + 1e-9) else 2 * reach
