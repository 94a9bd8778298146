"""Rays near the axis: matrices of a lens and of its ghosts, and what follows from them.

A ray is its height y and its slope dy/dz; both are measured in the lens's own axes, also while the light
travels back. At a surface of curvature c the normal leans by -c y, so that refraction from n to n' gives
u' = (n / n') (u + c y) - c y, and reflection u' = -u - 2 c y. Source: Gerrard & Burch, Introduction to
Matrix Methods in Optics (1975), chapter II, with slopes in place of optical angles.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.flare.ghost_paths import steps
from aureole.flare.glass import C_LINE, D_LINE, F_LINE, index
from aureole.flare.prescription import Lens

AXES = ("x", "y")
Matrix = NDArray[np.float64]


def matrix(
    lens: Lens, reflections: Sequence[int] = (), axis: str = "y", wavelength: float = D_LINE
) -> Matrix:
    """Return the matrix from the first surface's vertex to the sensor.

    Parameters
    ----------
    lens : Lens
        The lens.
    reflections : sequence of int
        Reflecting surfaces as in `aureole.flare.GhostPath`; none is the way of the image.
    axis : {"x", "y"}
        In which plane the ray lies; the planes differ where surfaces are cylinders.
    wavelength : float
        Metres.

    Returns
    -------
    ndarray, shape (2, 2)
        (y, dy/dz) at the sensor from those in front of the lens; A, D without unit, B metres, C 1/m.

    Raises
    ------
    refuse.Refusal
        Where the axis is unknown or the reflections are no way through the lens.
    """
    last = steps(lens, reflections)
    heights = _follow(lens, last, axis, wavelength)
    return _move(lens.sensor_distance) @ heights[-1]


def heights(lens: Lens, axis: str = "y", wavelength: float = D_LINE) -> list[Matrix]:
    """Return the matrix to just behind each surface on the way of the image.

    Parameters
    ----------
    lens : Lens
        The lens.
    axis : {"x", "y"}
        In which plane the ray lies.
    wavelength : float
        Metres.

    Returns
    -------
    list of ndarray, shape (2, 2)
        One for each surface; the first row is the height on it.
    """
    return _follow(lens, steps(lens), axis, wavelength)


def focal_length(lens: Lens, axis: str = "y", wavelength: float = D_LINE) -> float:
    """Return the effective focal length.

    Parameters
    ----------
    lens : Lens
        The lens.
    axis : {"x", "y"}
        In which plane the ray lies.
    wavelength : float
        Metres.

    Returns
    -------
    float
        Metres, -1 / C; infinity for an afocal lens, negative for one that spreads light.
    """
    power = -heights(lens, axis, wavelength)[-1][1, 0]
    return float(1.0 / power) if power else float("inf")


def back_focus(lens: Lens, axis: str = "y", wavelength: float = D_LINE) -> float:
    """Return the distance from the last surface to the focus of light from afar.

    Parameters
    ----------
    lens : Lens
        The lens.
    axis : {"x", "y"}
        In which plane the ray lies.
    wavelength : float
        Metres.

    Returns
    -------
    float
        Metres, -A / C; infinity for an afocal lens.
    """
    (a, _), (c, _) = heights(lens, axis, wavelength)[-1]
    return float(-a / c) if c else float("inf")


def axial_colour(lens: Lens, axis: str = "y") -> float:
    """Return how far the focus of blue light lies behind that of red light, over the focal length.

    Parameters
    ----------
    lens : Lens
        The lens.
    axis : {"x", "y"}
        In which plane the rays lie.

    Returns
    -------
    float
        (back focus at F - back focus at C) / focal length; 0 for an achromat, near -1/V for a single lens.
    """
    blue, red = (back_focus(lens, axis, line) for line in (F_LINE, C_LINE))
    return (blue - red) / focal_length(lens, axis)


def entrance_radius(lens: Lens, axis: str = "y") -> tuple[float, int]:
    """Return the height of the highest ray along the axis that no semi-aperture stops.

    Parameters
    ----------
    lens : Lens
        The lens.
    axis : {"x", "y"}
        In which plane the ray lies.

    Returns
    -------
    radius : float
        Metres, in front of the lens.
    limit : int
        Index of the surface that stops the next higher ray.
    """
    reach = [
        surface.semi_aperture / max(abs(float(found[0, 0])), 1e-12)
        for surface, found in zip(lens.surfaces, heights(lens, axis), strict=True)
    ]
    limit = int(np.argmin(reach))
    return float(reach[limit]), limit


def f_number(lens: Lens, axis: str = "y") -> float:
    """Return the f-number wide open that the semi-apertures allow.

    Parameters
    ----------
    lens : Lens
        The lens.
    axis : {"x", "y"}
        In which plane the rays lie.

    Returns
    -------
    float
        |focal length| over the diameter of the bundle that passes.
    """
    return abs(focal_length(lens, axis)) / (2.0 * entrance_radius(lens, axis)[0])


def stop_radius(lens: Lens, wanted: float, axis: str = "y") -> float:
    """Return the radius of the iris at an f-number.

    Parameters
    ----------
    lens : Lens
        The lens.
    wanted : float
        The f-number.
    axis : {"x", "y"}
        In which plane the rays lie.

    Returns
    -------
    float
        Metres; at most the stop's semi-aperture.

    Raises
    ------
    refuse.Refusal
        Where the f-number is not above zero.
    """
    height = abs(focal_length(lens, axis)) / (2.0 * refuse.positive("f_number", wanted))
    at_stop = abs(float(heights(lens, axis)[lens.stop][0, 0])) * height
    return min(at_stop, lens.surfaces[lens.stop].semi_aperture)


def entrance_pupil(lens: Lens, axis: str = "y") -> tuple[float, float]:
    """Return the stop's image as it is seen from the front.

    Parameters
    ----------
    lens : Lens
        The lens.
    axis : {"x", "y"}
        In which plane the rays lie.

    Returns
    -------
    place : float
        Behind the first surface's vertex, metres.
    radius : float
        Metres, with the stop wide open.
    """
    (a, b), _ = heights(lens, axis)[lens.stop]
    return float(b / a), float(lens.surfaces[lens.stop].semi_aperture / abs(a))


def _follow(lens: Lens, way: Sequence[tuple[int, bool]], axis: str, wavelength: float) -> list[Matrix]:
    """Return the matrix to just behind each step of a way through the lens."""
    refuse.one_of("axis", axis, AXES)
    places = np.concatenate([[0.0], np.cumsum([surface.thickness for surface in lens.surfaces])])
    indices = [float(index(lens.glass_before(0), wavelength))]
    indices += [float(index(surface.glass, wavelength)) for surface in lens.surfaces]
    total, place, ahead, found = np.eye(2), 0.0, True, []
    for k, reflects in way:
        curvature = lens.surfaces[k].curvature_along(axis)
        total = _move(places[k] - place) @ total
        if reflects:
            bend = np.array([[1.0, 0.0], [-2.0 * curvature, -1.0]])
            ahead = not ahead
        else:
            ratio = indices[k] / indices[k + 1] if ahead else indices[k + 1] / indices[k]
            bend = np.array([[1.0, 0.0], [(ratio - 1.0) * curvature, ratio]])
        total, place = bend @ total, places[k]
        found.append(total)
    return found


def _move(distance: float) -> Matrix:
    return np.array([[1.0, distance], [0.0, 1.0]])
