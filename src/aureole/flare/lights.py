"""Lights for a lens: by angles, by places on the picture, of a size, of a colour, or found in a picture.

A direction points from the lens towards the light: x to the right, y downward, z forward, as on the picture.
A light stands on the picture where a lens without distortion would show it.
"""

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import light, refuse
from aureole.flare.paraxial import focal_length
from aureole.flare.prescription import Lens
from aureole.picture import Regions, bright_labels, measured_regions
from aureole.records import Light, Picture, Spectrum

# No lens here sees a light beside itself; the tangent has no end there.
WIDEST = math.radians(89.0)
# How far apart, on the picture, the points lie that stand for a light of some size; the most of them.
POINT_STEP = 3.0
MOST_POINTS = 32
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))
COLOUR_NAME = "colour"
# Mean and width of the three smooth lights of which colours are mixed, metres; their triangle of
# chromaticities holds that of Rec.709.
BASIS = ((630e-9, 20e-9), (530e-9, 18e-9), (455e-9, 18e-9))

Numbers = NDArray[np.float64]


def light_at(
    angle_x: float,
    angle_y: float = 0.0,
    spectrum: Spectrum | None = None,
    irradiance: float = 1.0,
    angular_size: float = 0.0,
) -> Light:
    """Make a light by the angles at which it stands.

    Parameters
    ----------
    angle_x, angle_y : float
        To the right and downward, radians: the light stands where tan angle_x and tan angle_y times the
        focal length lie on the picture.
    spectrum : Spectrum, optional
        Its colour; equal energy without it.
    irradiance : float
        At the lens: what the light's own image sums to.
    angular_size : float
        Its diameter, radians; 0 is a point.

    Returns
    -------
    Light
        In front of the lens.

    Raises
    ------
    refuse.Refusal
        Where an angle is 89 degrees or more to either side, so that the light is not in front of the lens,
        or a number is out of its range.
    """
    tangents = []
    for name, angle in (("angle_x", angle_x), ("angle_y", angle_y)):
        if not abs(refuse.finite(name, angle)) < WIDEST:
            degrees = math.degrees(angle)
            raise refuse.Refusal(
                f"'{name}' must be less than 89 degrees to a side, before the lens, got {degrees:g}."
            )
        tangents.append(math.tan(angle))
    return _towards(tangents[0], tangents[1], spectrum, irradiance, angular_size)


def light_on_picture(
    lens: Lens,
    place: tuple[float, float],
    shape: tuple[int, int],
    spectrum: Spectrum | None = None,
    irradiance: float = 1.0,
    angular_size: float = 0.0,
) -> Light:
    """Make a light by its place on the picture, or off it.

    Parameters
    ----------
    lens : Lens
        The lens; its focal length and the sensor's width give the scale.
    place : tuple of float
        (x, y) in pixels from the picture's upper left corner; may lie outside.
    shape : tuple of int
        (rows, columns) of the picture.
    spectrum : Spectrum, optional
        Its colour; equal energy without it.
    irradiance : float
        At the lens: what the light's own image sums to.
    angular_size : float
        Its diameter, radians; 0 is a point.

    Returns
    -------
    Light
        In front of the lens.

    Raises
    ------
    refuse.Refusal
        Where a number is out of its range.
    """
    rows, columns = shape
    scale_x, scale_y = pixels_per_tangent(lens, shape)
    x = (refuse.finite("place (x)", place[0]) - 0.5 * columns) / scale_x
    y = (refuse.finite("place (y)", place[1]) - 0.5 * rows) / scale_y
    return _towards(x, y, spectrum, irradiance, angular_size)


def place_on_picture(lens: Lens, source: Light, shape: tuple[int, int]) -> tuple[float, float]:
    """Return where a light stands on the picture.

    Parameters
    ----------
    lens : Lens
        The lens.
    source : Light
        The light.
    shape : tuple of int
        (rows, columns) of the picture.

    Returns
    -------
    tuple of float
        (x, y) in pixels from the upper left corner, outside the picture for an off-frame light.
    """
    scale_x, scale_y = pixels_per_tangent(lens, shape)
    x, y, z = checked(source).direction
    return 0.5 * shape[1] + scale_x * x / z, 0.5 * shape[0] + scale_y * y / z


def pixels_per_tangent(lens: Lens, shape: tuple[int, int]) -> tuple[float, float]:
    """Return how many pixels the tangent of an angle is long on the picture, along x and y.

    Parameters
    ----------
    lens : Lens
        The lens; an anamorphic one has two focal lengths.
    shape : tuple of int
        (rows, columns) of the picture, which is as wide as the sensor.

    Returns
    -------
    tuple of float
        Focal lengths in pixels.
    """
    pitch = lens.sensor[0] / refuse.at_least("shape (columns)", shape[1], 1)
    return abs(focal_length(lens, "x")) / pitch, abs(focal_length(lens, "y")) / pitch


def point_count(lens: Lens, source: Light, shape: tuple[int, int], most: int = MOST_POINTS) -> int:
    """Return how many points stand for a light of some size.

    Parameters
    ----------
    lens : Lens
        The lens.
    source : Light
        The light.
    shape : tuple of int
        (rows, columns) of the picture.
    most : int
        The most points to take.

    Returns
    -------
    int
        As many as lie three pixels apart on the light's own image, and at most `most`.
    """
    across = max(pixels_per_tangent(lens, shape)) * math.tan(0.5 * source.angular_size) / POINT_STEP
    return min(max(math.ceil(math.pi * across**2), 1), refuse.at_least("most", most, 1))


def points_of(source: Light, count: int) -> list[Light]:
    """Return the points that stand for a light of some size: an evenly bright disc.

    Parameters
    ----------
    source : Light
        The light.
    count : int
        How many points; each brings the same share of the irradiance.

    Returns
    -------
    list of Light
        On a sunflower's spiral about the light's direction, whose mean is that direction (Vogel 1979);
        the light itself where it is a point or `count` is 1.

    Raises
    ------
    refuse.Refusal
        Where the count is below 1, or part of the light is not in front of the lens.
    """
    count = refuse.at_least("count", count, 1)
    checked(source)
    if count == 1 or source.angular_size == 0.0:
        return [dataclasses.replace(source, angular_size=0.0)]
    towards = np.asarray(source.direction)
    across = np.cross((0.0, 1.0, 0.0), towards)
    across /= np.linalg.norm(across)
    along = np.cross(towards, across)
    k = np.arange(count)
    radius = math.tan(0.5 * source.angular_size) * np.sqrt((k + 0.5) / count)
    offsets = np.column_stack([radius * np.cos(GOLDEN_ANGLE * k), radius * np.sin(GOLDEN_ANGLE * k)])
    offsets -= offsets.mean(axis=0)
    found = towards + offsets[:, :1] * across + offsets[:, 1:] * along
    share = source.irradiance / count
    return [checked(Light(_unit(*map(float, direction)), source.spectrum, share)) for direction in found]


def colour_spectrum(colour: ArrayLike, space: str = "rec709") -> Spectrum:
    """Return a smooth spectrum of a colour.

    As much equal-energy light as the least of red, green and blue asks for, and three smooth humps, at 630,
    530 and 455 nm, for the rest: no part is negative, and the spectrum's XYZ is the colour's.

    Parameters
    ----------
    colour : array_like, shape (3,)
        Linear red, green and blue, none negative.
    space : str
        One of `light.SPACES`.

    Returns
    -------
    Spectrum
        Its `light.tristimulus` is the colour's XYZ relative to the equal-energy white.

    Raises
    ------
    refuse.Refusal
        Where a part is negative or all are zero, or the colour is beyond Rec.709 and the humps' triangle.
    """
    rgb = refuse.all_finite("colour", refuse.shape_of("colour", colour, (3,))).astype(np.float64)
    if rgb.min() < 0 or not rgb.any():
        shown = ", ".join(f"{part:g}" for part in rgb)
        raise refuse.Refusal(f"'colour' must have no negative part and some light, got ({shown}).")
    wavelengths = np.arange(380, 781) / 1e9
    humps = [np.exp(-0.5 * ((wavelengths - mean) / width) ** 2) for mean, width in BASIS]
    even = light.spectrum(wavelengths, np.ones_like(wavelengths))
    white = light.tristimulus(even)
    # The tables' equal-energy white is not quite (1, 1, 1); the humps make up for a hundredth of it.
    least = 0.99 * float(rgb.min())
    wanted = light.to_xyz(rgb, space) - least * white / white[1]
    mixture = np.column_stack([light.tristimulus(light.spectrum(wavelengths, hump)) for hump in humps])
    parts = np.linalg.solve(mixture, wanted)
    if parts.min() < -1e-9 * parts.max():
        raise refuse.Refusal("'colour' is more saturated than its smooth spectrum can be; use a line.")
    values = least / white[1] + np.maximum(parts, 0.0) @ np.asarray(humps)
    shown = ", ".join(f"{part:g}" for part in rgb)
    return light.spectrum(wavelengths, values, name=f"{COLOUR_NAME} ({shown})")


def find_lights(
    picture: Picture, lens: Lens, threshold: float, most: int = 8, connect: int = 1
) -> list[Light]:
    """Find the lights that a picture shows: connected regions brighter than a threshold.

    Parameters
    ----------
    picture : Picture
        Linear, as wide as the lens's sensor.
    lens : Lens
        The lens through which it is seen; it gives the directions.
    threshold : float
        Luminance in the picture's unit above which a pixel belongs to a light.
    most : int
        Keep so many of the brightest.
    connect : int
        Regions fewer than so many pixels apart count as one light.

    Returns
    -------
    list of Light
        The brightest first. Irradiance is the luminance of the region's pixels summed, the direction that
        of its centre of brightness, the colour its mean, the size that of a disc as large as the region.

    Raises
    ------
    refuse.Refusal
        Where the threshold is not above zero.
    """
    refuse.positive("threshold", threshold)
    xyz = np.maximum(np.asarray(light.convert(picture, "xyz").pixels[..., :3], dtype=np.float64), 0.0)
    luminance = xyz[..., 1]
    found = measured_regions(bright_labels(luminance, threshold, connect), luminance, xyz)
    shape = (int(luminance.shape[0]), int(luminance.shape[1]))
    count = min(len(found), refuse.at_least("most", most, 1))
    return [_light_of(found, k, lens, shape) for k in range(count)]


def checked(source: Light) -> Light:
    """Refuse a light that is not in front of the lens, or whose numbers are out of their range.

    Parameters
    ----------
    source : Light
        The light.

    Returns
    -------
    Light
        The light.

    Raises
    ------
    refuse.Refusal
        With the reason.
    """
    x, y, z = (refuse.finite("direction", part) for part in source.direction)
    length = math.sqrt(x * x + y * y + z * z)
    if not abs(length - 1.0) < 1e-6:
        raise refuse.Refusal(f"'direction' must be a unit vector, got one of length {length:g}.")
    if z < math.cos(WIDEST):
        degrees = math.degrees(math.acos(max(-1.0, min(1.0, z))))
        raise refuse.Refusal(
            f"'direction' must be in front of the lens, less than 89 degrees off its axis, got {degrees:.4g}."
        )
    refuse.positive("irradiance", source.irradiance)
    refuse.between("angular_size", source.angular_size, 0.0, math.radians(90.0))
    return source


def white_of(sources: Sequence[Light]) -> Spectrum | None:
    """Return the light that counts as white for some lights together.

    Parameters
    ----------
    sources : sequence of Light
        The lights.

    Returns
    -------
    Spectrum or None
        The one spectrum that all of them have, so that a lamp's ghosts are as neutral as the lamp; None,
        for equal energy, where they differ or are coloured on purpose by `colour_spectrum`.
    """
    first = sources[0].spectrum
    alike = all(_same(source.spectrum, first) for source in sources)
    return first if alike and not first.name.startswith(COLOUR_NAME) else None


def _same(one: Spectrum, other: Spectrum) -> bool:
    return one is other or (
        one.kind == other.kind
        and np.array_equal(one.wavelengths, other.wavelengths)
        and np.array_equal(one.values, other.values)
    )


def _light_of(found: Regions, k: int, lens: Lens, shape: tuple[int, int]) -> Light:
    """Return the light that a region of a picture is."""
    flux, centre = float(found.flux[k]), (float(found.places[k, 0]), float(found.places[k, 1]))
    mean = light.from_xyz(found.colour[k] / flux, "rec709")
    spectrum = colour_spectrum(np.maximum(mean, 0.0))
    # A single pixel is a point: its size is the picture's, not the light's.
    scale_x, scale_y = pixels_per_tangent(lens, shape)
    area = found.areas[k] / (scale_x * scale_y) if found.areas[k] > 1 else 0.0
    size = 2.0 * math.atan(math.sqrt(area / math.pi))
    return light_on_picture(lens, centre, shape, spectrum, flux, size)


def _towards(x: float, y: float, spectrum: Spectrum | None, irradiance: float, angular_size: float) -> Light:
    colour = light.illuminant("E") if spectrum is None else spectrum
    return checked(Light(_unit(x, y, 1.0), colour, irradiance, angular_size))


def _unit(x: float, y: float, z: float) -> tuple[float, float, float]:
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length
