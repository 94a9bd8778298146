"""Screens without end: the half plane behind a straight edge, and everything but a shape.

They are rings whose outer corners lie so far away that nothing of them is seen: a corner at a distance B
sends less than √(λz) / (2πB) of the light's amplitude.
"""

import math

import numpy as np

from aureole import refuse
from aureole.records import Aperture, Outline

# Where the outer corners of a screen without end lie, in widths of its square.
ENDLESS = 1e9


def half_plane(offset: float = 0.0, rotation: float = 0.0, width: float = 1.0) -> Aperture:
    """Let light pass on one side of a straight edge: a knife's edge, a wall, the horizon.

    Open is where a point's coordinate along the direction `rotation` is less than `offset`; what lies farther
    that way is opaque.

    Parameters
    ----------
    offset : float
        Distance of the edge from the axis along that direction, metres; negative where the axis is behind
        the edge.
    rotation : float
        The direction from the open side to the opaque one, radians, counter-clockwise as seen: 0 is +x, so
        that the left is open.
    width : float
        Side of the square on which it is rasterized, metres.

    Returns
    -------
    Aperture
        One ring, which ends a thousand million widths away.

    Raises
    ------
    refuse.Refusal
        Where a number is not finite, the width is not above zero, or the edge lies that far away itself.
    """
    refuse.finite("offset", offset)
    refuse.finite("rotation", rotation)
    reach = ENDLESS * refuse.positive("width", width)
    if not abs(offset) < reach / 1e3:
        raise refuse.Refusal(
            f"'offset' must be within {ENDLESS / 1e3:g} widths of the axis, got {offset:g} m for a width of "
            f"{width:g} m."
        )
    # Rows run downward, so that a turn counter-clockwise as seen lowers y.
    across = np.array([math.cos(rotation), -math.sin(rotation)])
    along = np.array([-across[1], across[0]])
    nearest = offset * across
    # The edge's point nearest the axis is a corner, so that places near it are told to all digits.
    corners = [
        nearest,
        nearest + reach * along,
        nearest + reach * (along - across),
        nearest - reach * (along + across),
        nearest - reach * along,
    ]
    return Aperture(float(width), (Outline(np.array(corners), np.zeros(5)),), name="half plane")


def obstacle(shape: Aperture) -> Aperture:
    """Block the light where a shape is, and let it pass everywhere else.

    Parameters
    ----------
    shape : Aperture
        Outlines, as of an opening of the obstacle's shape; where it lets a part of the amplitude through, the
        obstacle lets the rest through.

    Returns
    -------
    Aperture
        A ring without end, and the shape's rings taken from it, on the same width.

    Raises
    ------
    refuse.Refusal
        Where the shape is a raster.
    """
    if shape.mask is not None:
        raise refuse.Refusal(
            "an obstacle needs outlines and this is a raster; take its near field as an opening from 1."
        )
    reach = ENDLESS * shape.width
    corners = reach * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    negative = tuple(Outline(r.vertices, r.bulges, -r.transmittance) for r in shape.outlines)
    everything = Outline(corners, np.zeros(4))
    return Aperture(shape.width, (everything, *negative), name=f"obstacle: {shape.name}")
