"""What hides parts of the iris from a light, guessed from the picture about it.

The quad paper's cheap way (§4.4, end): the light's own pixels, in a small neighbourhood, are laid over the
aperture and crop it. With the occluder at a distance d before a light at D, the point p of the aperture looks
past it in a direction that differs from the light's by p (1/d − 1/D): so the neighbourhood's radius is the
aperture's times that. Where d is not known, the circle about the light is taken for the aperture.

It holds where all that is dark there stands before the light, and shows in the picture as sharp as it is.
What stands near the lens is out of focus in a picture: then only a matte of it, and its distance, tell its
shape.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from aureole import aperture as apertures
from aureole import refuse
from aureole.glare.lamps import Lamp
from aureole.records import Aperture, Camera

# The aperture is laid within this part of the circle about a light, so that its rim does not crop it.
INSIDE = 0.9
# A light's pixels are those that are half as bright as its brighter quarter.
BRIGHT_QUARTER, HALF = 75.0, 0.5
# Points so little beyond a circle lie on it.
NEAR = 1e-9


def light_pixels(seen: NDArray[np.floating], lamp: Lamp) -> NDArray[np.float64]:
    """Return how bright pixels are beside a light's own.

    Parameters
    ----------
    seen : ndarray, shape (rows, columns)
        Luminance.
    lamp : Lamp
        With its box.

    Returns
    -------
    ndarray of float64, shape (rows, columns)
        0..1 in the light's box: 1 where it is as bright as the light's brighter quarter; 0 beyond the box.
    """
    left, top, right, bottom = lamp.box
    out = np.zeros(seen.shape)
    inside = np.asarray(seen[top:bottom, left:right], dtype=np.float64)
    if inside.size == 0 or inside.max() <= 0:
        return out
    bright = inside[inside > HALF * inside.max()]
    out[top:bottom, left:right] = np.clip(inside / np.percentile(bright, BRIGHT_QUARTER), 0, 1)
    return out


def circle_about(lit: NDArray[np.bool_]) -> tuple[tuple[float, float], float]:
    """Return the smallest circle about pixels.

    Parameters
    ----------
    lit : ndarray of bool, shape (rows, columns)
        The pixels; at least one.

    Returns
    -------
    centre : tuple of float
        (x, y) in pixels from the upper left corner, centres of pixels at halves.
    radius : float
        Pixels, to the middles of the pixels' sides.

    Raises
    ------
    refuse.Refusal
        Where there are none.
    """
    rows, columns = np.nonzero(lit)
    if len(rows) == 0:
        raise refuse.Refusal("'lit' must have at least one pixel.")
    # Of each row only the ends can lie on the circle.
    ends = [(x + 0.5, row + 0.5) for row in np.unique(rows) for x in _ends(columns[rows == row])]
    x, y, radius = _smallest_circle(ends)
    return (x, y), radius + 0.5


def _smallest_circle(points: list[tuple[float, float]]) -> tuple[float, float, float]:
    """Return the centre and radius of the smallest circle about points, point by point (Welzl 1991)."""
    circle = (*points[0], 0.0)
    for i, first in enumerate(points):
        if _beyond(first, circle):
            circle = (*first, 0.0)
            for j, second in enumerate(points[:i]):
                if _beyond(second, circle):
                    circle = _across(first, second)
                    for third in points[:j]:
                        if _beyond(third, circle):
                            circle = _through(first, second, third)
    return circle


def _beyond(point: tuple[float, float], circle: tuple[float, float, float]) -> bool:
    return math.hypot(point[0] - circle[0], point[1] - circle[1]) > circle[2] + NEAR


def _across(one: tuple[float, float], other: tuple[float, float]) -> tuple[float, float, float]:
    x, y = (one[0] + other[0]) / 2, (one[1] + other[1]) / 2
    return x, y, math.hypot(one[0] - x, one[1] - y)


def _through(
    first: tuple[float, float], second: tuple[float, float], third: tuple[float, float]
) -> tuple[float, float, float]:
    """Return the circle through three points; through the two farthest where they are on a line."""
    bx, by = second[0] - first[0], second[1] - first[1]
    cx, cy = third[0] - first[0], third[1] - first[1]
    turn = 2 * (bx * cy - by * cx)
    if abs(turn) < NEAR:
        pairs = ((first, second), (first, third), (second, third))
        return max((_across(*pair) for pair in pairs), key=lambda circle: circle[2])
    b, c = bx * bx + by * by, cx * cx + cy * cy
    x, y = (cy * b - by * c) / turn, (bx * c - cx * b) / turn
    return first[0] + x, first[1] + y, math.hypot(x, y)


def _ends(places: NDArray[np.intp]) -> tuple[int, int]:
    return int(places.min()), int(places.max())


def neighbourhood_radius(
    camera: Camera, opening: Aperture, distance: float, behind: float = math.inf
) -> float:
    """Return how far about a light an occluder can hide parts of the opening.

    Parameters
    ----------
    camera : Camera
        Its resolution is the picture's.
    opening : Aperture
        Its opening, metres.
    distance : float
        Of the occluder, metres.
    behind : float
        Of the light, metres.

    Returns
    -------
    float
        Pixels of the picture's columns.

    Raises
    ------
    refuse.Refusal
        Where the occluder does not stand before the light.
    """
    if not 0 < distance < behind:
        raise refuse.Refusal(f"'distance' must be > 0 and before the light, got {distance:g}.")
    angle = apertures.bounding_radius(opening) * (1 / distance - 1 / behind)
    return angle * camera.focal_length / camera.pixel_pitch[1]


def cropped_opening(
    opening: Aperture, passes: NDArray[np.floating], centre: tuple[float, float], radius: float, size: int
) -> Aperture | None:
    """Return an opening cropped by what the pixels about a place let through.

    Parameters
    ----------
    opening : Aperture
        Metres.
    passes : ndarray, shape (rows, columns)
        0..1, which pixels let light through; what lies beyond the picture is as its border.
    centre : tuple of float
        (x, y) in pixels from the upper left corner.
    radius : float
        Pixels that stand for the circle about the opening.
    size : int
        Pixels a side of the raster.

    Returns
    -------
    Aperture or None
        A raster, sharp where `passes` crosses a half; None where nothing is left.

    Raises
    ------
    refuse.Refusal
        Where the radius is not above zero.
    """
    refuse.positive("radius", radius)
    mask = apertures.rasterize(opening, size)
    step = opening.width / size * radius / apertures.bounding_radius(opening)
    offsets = (np.arange(size) - (size - 1) / 2) * step
    rows, columns = np.meshgrid(centre[1] - 0.5 + offsets, centre[0] - 0.5 + offsets, indexing="ij")
    between = ndimage.map_coordinates(
        np.asarray(passes, np.float64), [rows, columns], order=1, mode="nearest"
    )
    # A shadow's edge is sharp on the opening: its contour is where the picture's pixels cross a half.
    sharp = np.clip((between - HALF) / min(step, 1.0) + HALF, 0, 1)
    before = float(mask.sum(dtype=np.float64))
    mask *= sharp.astype(np.float32)
    if float(mask.sum(dtype=np.float64)) <= 1e-6 * before:
        return None
    return apertures.from_mask(mask, opening.width)
