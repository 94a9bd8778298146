"""What stands in an opening or before it: a central disc, its vanes, a round shadow, a lens's housing."""

import math
from dataclasses import replace

import numpy as np

from aureole import refuse
from aureole.aperture.compose import intersection, moved, subtraction
from aureole.aperture.geometry import area
from aureole.aperture.shapes import circle
from aureole.aperture.wavefront import bounding_radius
from aureole.records import Aperture, Outline

# Vanes end this much beyond the opening, so that their ends leave no trace on its rim.
BEYOND = 1.1
# An opening with less than this part of its light left is blocked but for rounding.
NOTHING = 1e-9


def obstruction(aperture: Aperture, ratio: float) -> Aperture:
    """Block a central disc of an opening, as the secondary mirror of a telescope does.

    Parameters
    ----------
    aperture : Aperture
        Outlines, which stay exact, or a raster.
    ratio : float
        Diameter of the disc over the aperture's width, 0 < ratio < 1.

    Returns
    -------
    Aperture
        The opening without the disc, on the same width.

    Raises
    ------
    refuse.Refusal
        Where the ratio is outside its range, or nothing is left.
    """
    refuse.between("obstruction", refuse.positive("obstruction", ratio), 0, 0.999)
    left = subtraction(aperture, circle(ratio * aperture.width))
    return _with_light(replace(left, name=f"{aperture.name}, {100 * ratio:.3g} % obstructed"), aperture)


def spiders(aperture: Aperture, count: int, width: float, rotation: float = 0.0) -> Aperture:
    """Block an opening by vanes from its centre to its rim, as those that hold a secondary mirror.

    Each vane has two straight edges and so draws a streak across itself, to both sides: an even number
    of vanes makes as many rays, an odd number twice as many.

    Parameters
    ----------
    aperture : Aperture
        Outlines, which stay exact where a vane does not cut them, or a raster.
    count : int
        Number of vanes, evenly spaced, at least 1.
    width : float
        Breadth of a vane, metres.
    rotation : float
        Direction of the first vane, radians, counter-clockwise as seen from +x.

    Returns
    -------
    Aperture
        The opening without the vanes, on the same width.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, or nothing is left.
    """
    from shapely import Polygon, union_all

    refuse.at_least("spiders", count, 1)
    half = refuse.positive("spider width", width) / 2
    refuse.finite("spider rotation", rotation)
    # Shapely's tolerances suit numbers about one.
    unit = aperture.width
    reach, side = BEYOND * bounding_radius(aperture) / unit + half / unit, half / unit
    along = np.array([0.0, reach, reach, 0.0])
    across = np.array([-side, -side, side, side])
    vanes = []
    for angle in rotation + 2 * np.pi * np.arange(count) / count:
        # Points have y downward and angles turn counter-clockwise as seen.
        cosine, sine = math.cos(angle), -math.sin(angle)
        x, y = along * cosine - across * sine, along * sine + across * cosine
        vanes.append(Polygon(np.stack([x, y], axis=1)))
    star = union_all(vanes)
    rings = [(star.exterior, 1.0), *((hole, -1.0) for hole in star.interiors)]
    outlines = tuple(
        Outline(points, np.zeros(len(points)), sign)
        for points, sign in ((np.asarray(ring.coords)[:-1] * unit, sign) for ring, sign in rings)
    )
    left = subtraction(aperture, Aperture(2 * reach * unit, outlines, name="spiders"))
    vane = "vane" if count == 1 else "vanes"
    return _with_light(replace(left, name=f"{aperture.name} with {count} {vane}"), aperture)


def shadow(aperture: Aperture, x: float, y: float, diameter: float) -> Aperture:
    """Cover an opening by a round shadow, as what stands before the lens casts it (quad paper Fig. 3).

    Parameters
    ----------
    aperture : Aperture
        Outlines, which stay exact where the shadow does not cut them, or a raster.
    x, y : float
        Its centre, metres, x to the right, y downward.
    diameter : float
        Metres.

    Returns
    -------
    Aperture
        The opening without what the shadow covers, on the same width.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, or nothing is left.
    """
    disc = moved(circle(refuse.positive("shadow's diameter", diameter)), x, y)
    left = subtraction(aperture, disc)
    return _with_light(replace(left, width=aperture.width, name=f"{aperture.name} in shadow"), aperture)


def cats_eye(shape: Aperture, housing_diameter: float, offset: tuple[float, float] = (0.0, 0.0)) -> Aperture:
    """Crop an opening by the round housing of its lens, as seen from off the axis (quad paper §6.2).

    What is left is the iris where the rim of the lens, seen through it, lets light pass: for an iris wide
    open the lens-shaped "cat's eye" of two circles.

    Parameters
    ----------
    shape : Aperture
        The iris: outlines, which keep their exact edges and get the circle's arcs, or a raster.
    housing_diameter : float
        Of the housing's round opening as it lies over the iris, metres.
    offset : tuple of float
        Its centre (x, y) from the axis, metres, x to the right, y downward. It grows with the angle from
        which the light comes.

    Returns
    -------
    Aperture
        What both let through, on the width of the iris.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, or nothing is left.
    """
    x, y = refuse.all_finite("offset", refuse.shape_of("offset", offset, (2,)))
    housing = moved(circle(refuse.positive("housing_diameter", housing_diameter)), float(x), float(y))
    left = intersection(shape, housing)
    return _with_light(replace(left, name=f"{shape.name} within a housing"), shape)


def _with_light(left: Aperture, whole: Aperture) -> Aperture:
    """Refuse an opening that is blocked."""
    if area(left) <= NOTHING * area(whole):
        raise refuse.Refusal(f"'{left.name}' lets no light through.")
    return left
