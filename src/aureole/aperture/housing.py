"""The housing of a lens: round rims before and behind the pupil, which crop light from off the axis.

A rim at a distance before the pupil casts its shadow there displaced by −distance · tan θ, where θ is the
direction that the light comes from: the cat's eye of lenses (quad paper §6.2). Dirt on the front glass
moves behind the opening by the same law.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from aureole import refuse
from aureole.aperture.geometry import energy
from aureole.aperture.obstructions import cats_eye
from aureole.records import Aperture

# Light from farther off the axis passes no lens of this kind, radians.
STEEPEST = math.radians(80)


@dataclass(frozen=True)
class Rim:
    """A round rim of the lens, as it is seen from the front.

    Parameters
    ----------
    diameter : float
        Of its image before all glass, metres.
    distance : float
        How far the image stands before the entrance pupil, metres; negative behind it.
    """

    diameter: float
    distance: float


def parallax(direction: tuple[float, float], distance: float) -> tuple[float, float]:
    """Return by how much light from a direction moves the shadow of what stands before the pupil.

    Parameters
    ----------
    direction : tuple of float
        Towards the light, radians off the axis (right, down).
    distance : float
        How far before the pupil it stands, metres; negative behind it.

    Returns
    -------
    tuple of float
        (x, y) on the pupil, metres.

    Raises
    ------
    refuse.Refusal
        Where an angle is beyond 80 degrees.
    """
    refuse.finite("distance", distance)
    right, down = (refuse.between("direction", angle, -STEEPEST, STEEPEST) for angle in direction)
    return -distance * math.tan(right), -distance * math.tan(down)


def behind_rims(shape: Aperture, rims: Sequence[Rim], direction: tuple[float, float]) -> Aperture:
    """Crop a pupil by all rims of its lens, as light from a direction finds it.

    Parameters
    ----------
    shape : Aperture
        The entrance pupil in metres: outlines, which keep their exact edges, or a raster.
    rims : sequence of Rim
        Of the lens, in any order.
    direction : tuple of float
        Towards the light, radians off the axis (right, down).

    Returns
    -------
    Aperture
        What is left, on the pupil's width; the pupil itself where no rim cuts it.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, or nothing is left.
    """
    left = shape
    # A pupil of any shape lies within the circle about its square.
    corner = shape.width * math.sqrt(0.5)
    for rim in rims:
        radius = refuse.positive("rim's diameter", rim.diameter) / 2
        offset = parallax(direction, rim.distance)
        if math.hypot(*offset) + corner > radius:
            left = cats_eye(left, rim.diameter, offset)
    return left if left is shape else replace(left, width=shape.width, name=f"{shape.name} within a housing")


def open_part(shape: Aperture, rims: Sequence[Rim], direction: tuple[float, float]) -> float:
    """Return the part of a pupil's light that the rims let pass: the lens's mechanical vignetting.

    Parameters
    ----------
    shape : Aperture
        As in `behind_rims`.
    rims : sequence of Rim
        As in `behind_rims`.
    direction : tuple of float
        As in `behind_rims`.

    Returns
    -------
    float
        0 to 1.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, or nothing is left.
    """
    return min(1.0, energy(behind_rims(shape, rims, direction)) / energy(shape))
