"""The starbursts of a flare's lights: the far field of the lens's stop, laid where each light stands."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import diffraction, flare
from aureole.flare import paraxial
from aureole.flare.prescription import Lens
from aureole.records import Aperture, Grid, Light, Stage

# Pixels about a light that stay as the picture shows them, fading over as many again.
CORE_RADIUS = 2.0


def working_f_number(lens: Lens, f_number: float | None, axis: str) -> float:
    """Return the f-number of the light that leaves the lens.

    Parameters
    ----------
    lens : Lens
        The lens.
    f_number : float, optional
        To which the iris is set; wide open without it.
    axis : {"x", "y"}
        In which plane; an anamorphic lens has two.

    Returns
    -------
    float
        |focal length| over the diameter of the bundle that passes, along this axis.
    """
    reach = paraxial.entrance_radius(lens, axis)[0]
    if f_number is not None:
        through_stop = abs(float(paraxial.heights(lens, axis)[lens.stop][0, 0]))
        reach = min(reach, paraxial.stop_radius(lens, f_number) / through_stop)
    return abs(paraxial.focal_length(lens, axis)) / (2.0 * reach)


def starburst_stages(
    lens: Lens,
    lights: Sequence[Light],
    shape: tuple[int, int],
    iris: Aperture,
    f_number: float | None = None,
    with_core: bool = True,
) -> Iterator[Stage]:
    """Lay the starburst of each light on one picture, telling how far it is.

    Parameters
    ----------
    lens : Lens
        The lens; its focal length, f-number and sensor width give the scale.
    lights : sequence of Light
        Anywhere in front of the lens, in the picture or off it.
    shape : tuple of int
        (rows, columns).
    iris : Aperture
        The stop's shape; its width stands for the stop's diameter.
    f_number : float, optional
        Wide open without it.
    with_core : bool
        Whether the light's own image is there, so that each light sums to its irradiance over an endless
        picture; what falls within two pixels of it is left out otherwise, fading until four.

    Yields
    ------
    Stage
        The last one holds the pixels in XYZ: ndarray of float32, shape (rows, columns, 3).
    """
    spacing, opening = _scale(lens, shape, iris, f_number)
    total = np.zeros((*shape, 3), np.float32)
    for k, lamp in enumerate(lights):
        x, y = flare.place_on_picture(lens, lamp, shape)
        # Sample (rows // 2, columns // 2) is the middle of its pixel.
        centre = (shape[0] // 2 + 0.5 - y) * spacing[0], (shape[1] // 2 + 0.5 - x) * spacing[1]
        grid, size = Grid(shape, spacing, centre), math.sin(lamp.angular_size / 2.0)
        for stage in diffraction.starburst_stages(opening, grid, lamp.spectrum, light_radius=size):
            found = stage.result
            yield Stage((k + 0.99 * stage.fraction) / len(lights), stage.label)
        assert found is not None
        share = np.float32(lamp.irradiance)
        total += share * (found.pixels if with_core else found.pixels * _beyond_core(shape, x, y))
    yield Stage(1.0, "starbursts", total)


def _scale(
    lens: Lens, shape: tuple[int, int], iris: Aperture, f_number: float | None
) -> tuple[tuple[float, float], Aperture]:
    """Return a pixel's size in direction cosines and the opening in metres.

    The far field's size on the sensor is that of the wavelength times the f-number; where an anamorphic lens
    has another f-number across, its pixels are taken as so much smaller.
    """
    along, across = (working_f_number(lens, f_number, axis) for axis in ("y", "x"))
    length = abs(paraxial.focal_length(lens, "y"))
    pitch = lens.sensor[0] / shape[1] / length
    opening = apertures.scaled(iris, length / along / iris.width)
    return (pitch, pitch * along / across), opening


def _beyond_core(shape: tuple[int, int], x: float, y: float) -> NDArray[np.float32]:
    """Return 0 round a place, rising smoothly to 1 at twice the core's radius."""
    rows, columns = np.arange(shape[0]) + 0.5 - y, np.arange(shape[1]) + 0.5 - x
    share = np.clip(np.hypot(rows[:, None], columns) / CORE_RADIUS - 1.0, 0.0, 1.0)
    return np.asarray(share**2 * (3.0 - 2.0 * share), dtype=np.float32)[..., None]
