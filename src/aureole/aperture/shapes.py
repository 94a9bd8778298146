"""Openings whose edges are known exactly.

Angles follow the screen: rotation 0 puts a vertex at +x and a positive one turns counter-clockwise
as seen. Points have y downward, so the sign is turned here, once.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.records import Aperture, Outline

WHIRL_VERTICES_PER_ARM = 64


def circle(diameter: float) -> Aperture:
    """Make a circular opening.

    Parameters
    ----------
    diameter : float
        Metres.

    Returns
    -------
    Aperture
        One ring of two half circles.

    Raises
    ------
    refuse.Refusal
        Where the diameter is not a finite number > 0.
    """
    radius = refuse.positive("diameter", diameter) / 2
    vertices = np.array([[radius, 0.0], [-radius, 0.0]])
    return Aperture(width=float(diameter), outlines=(Outline(vertices, np.ones(2)),), name="circle")


def rectangle(width: float, height: float) -> Aperture:
    """Make a rectangular opening centred on the axis.

    Parameters
    ----------
    width, height : float
        Size along x and along y, metres.

    Returns
    -------
    Aperture
        One ring of four edges.

    Raises
    ------
    refuse.Refusal
        Where a size is not a finite number > 0.
    """
    x, y = refuse.positive("width", width) / 2, refuse.positive("height", height) / 2
    vertices = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    return _straight(vertices, 2 * max(x, y), "rectangle")


def iris(blades: int, diameter: float, curvature: float = 0.0, rotation: float = 0.0) -> Aperture:
    """Make the opening of an iris: a regular polygon, its sides bent outward by choice.

    Parameters
    ----------
    blades : int
        Number of blades, at least 3.
    diameter : float
        Diameter of the circle through the corners, metres.
    curvature : float
        Curvature of the blades' edges over that of this circle: 0 is straight, 1 the circle.
    rotation : float
        Radians, counter-clockwise as seen; 0 puts a corner at +x.

    Returns
    -------
    Aperture
        One ring of `blades` edges.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.at_least("blades", blades, 3)
    radius = refuse.positive("diameter", diameter) / 2
    refuse.between("curvature", curvature, 0, 1)
    angles = 2 * np.pi * np.arange(blades) / blades - refuse.finite("rotation", rotation)
    vertices = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    # The chord 2 R sin(π / N) of a blade of radius R / curvature sweeps 2 asin(curvature sin(π / N)).
    sweep = 2 * math.asin(curvature * math.sin(math.pi / blades))
    bulges = np.full(blades, math.tan(sweep / 4))
    return Aperture(float(diameter), (Outline(vertices, bulges),), name=f"iris of {blades} blades")


def polygon(vertices: ArrayLike) -> Aperture:
    """Make an opening with straight edges.

    Parameters
    ----------
    vertices : array_like, shape (V, 2)
        Corners (x, y) in metres, in order along the edge, y downward.

    Returns
    -------
    Aperture
        One ring; its width is the smallest centred square that holds it.

    Raises
    ------
    refuse.Refusal
        Where there are fewer than three corners, values that are not finite, edges that cross, or
        no inside.
    """
    from shapely import Polygon

    points = refuse.all_finite("vertices", refuse.shape_of("vertices", vertices, (None, 2)))
    if len(points) < 3:
        raise refuse.Refusal(f"'vertices' must hold at least 3 points, got {len(points)}.")
    points = points.astype(np.float64)
    width = 2 * float(np.max(np.abs(points)))
    if width == 0 or not Polygon(points / width).is_valid:
        raise refuse.Refusal("'vertices' must go round an inside without crossing their own edge.")
    return _straight(points, width, "polygon")


def whirl(diameter: float, arms: int = 5, rotation: float = 0.0) -> Aperture:
    """Make a whirl: arms that reach outward and turn as they go.

    With t from 0 to 2π, the edge is at radius r = R (0.64 + 0.36 cos(arms·t)) and at the angle
    t + 1.1 (r / R)², joined by straight edges between 64 points an arm.

    Parameters
    ----------
    diameter : float
        Diameter 2 R of the circle that the arms reach, metres.
    arms : int
        Number of arms, at least 2.
    rotation : float
        Radians, counter-clockwise as seen.

    Returns
    -------
    Aperture
        One ring of 64 edges an arm.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.at_least("arms", arms, 2)
    radius = refuse.positive("diameter", diameter) / 2
    t = 2 * np.pi * np.arange(WHIRL_VERTICES_PER_ARM * arms) / (WHIRL_VERTICES_PER_ARM * arms)
    reach = 0.64 + 0.36 * np.cos(arms * t)
    angles = t + 1.1 * reach**2 - refuse.finite("rotation", rotation)
    vertices = (radius * reach)[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return _straight(vertices, float(diameter), "whirl")


def _straight(vertices: NDArray[np.float64], width: float, name: str) -> Aperture:
    return Aperture(width, (Outline(vertices, np.zeros(len(vertices))),), name=name)
