"""The lights of a flare as people give them, and the lights that they mean.

A light's strength is what its own image sums to, in the picture's unit. Over a picture it is measured there:
the pixels round the light's place that are a tenth as bright as the brightest of them, and join it.
"""

import math
from dataclasses import dataclass

import numpy as np

from aureole import flare, glare, light, refuse
from aureole.flare.lights import pixels_per_tangent
from aureole.flare.prescription import Lens
from aureole.glare import LampList, lamp_threshold, lit_about, luminances
from aureole.records import Light, Picture, Spectrum

MOST_LIGHTS = 8


@dataclass(frozen=True)
class Lamp:
    """A light as people give it.

    Parameters
    ----------
    place : tuple of float
        Angles to the right and downward, radians; or pixels from the picture's upper left corner, as it is
        meant to be seen.
    on_picture : bool
        Whether the place is in pixels.
    colour : tuple of float, optional
        Linear red, green and blue; that of the picture at its place, else of the illuminant.
    strength : float, optional
        What its image sums to, in luminance; that of the picture at its place, else 1.
    diameter : float, optional
        Pixels across, where that is known of this light alone.
    """

    place: tuple[float, float]
    on_picture: bool = False
    colour: tuple[float, float, float] | None = None
    strength: float | None = None
    diameter: float | None = None


@dataclass(frozen=True, eq=False)
class Scene:
    """Where lights stand and what is known of them.

    Parameters
    ----------
    lens : Lens
        Through which they are seen, its sensor as wide as the shape.
    shape : tuple of int
        (rows, columns) that the lens sees.
    shown : tuple of int
        Row and column in that shape of the first pixel that is meant to be seen; places count from there.
    corner : tuple of int
        Row and column in that shape of the picture's first pixel, which may lie beyond.
    over : Picture, optional
        The picture, in a space of `light.SPACES`.
    illuminant : Spectrum
        Of a light whose colour nothing says.
    size : float
        Of each light, radians across; 0 is a point.
    """

    lens: Lens
    shape: tuple[int, int]
    shown: tuple[int, int]
    corner: tuple[int, int]
    over: Picture | None
    illuminant: Spectrum
    size: float = 0.0


def light_of(lamp: Lamp, scene: Scene) -> Light:
    """Return the light that a lamp is.

    Parameters
    ----------
    lamp : Lamp
        As given.
    scene : Scene
        Where it stands.

    Returns
    -------
    Light
        With its spectrum and its strength as the irradiance.

    Raises
    ------
    refuse.Refusal
        Where it is not in front of the lens, or the picture shows no light at its place.
    """
    if lamp.on_picture:
        top, left = scene.shown
        place = lamp.place[0] + left, lamp.place[1] + top
        point = flare.light_on_picture(scene.lens, place, scene.shape)
    else:
        point = flare.light_at(*lamp.place)
    seen: tuple[float, float, float] | None = None
    if scene.over is not None and lamp.strength is None:
        seen = measured(scene, point)
    colour = lamp.colour or seen
    strength = lamp.strength
    if strength is None:
        strength = 1.0 if seen is None else _luminance(seen, scene)
    spectrum = scene.illuminant if colour is None else _spectrum(colour, scene)
    size = scene.size if lamp.diameter is None else _angle(lamp.diameter, scene)
    return Light(point.direction, spectrum, refuse.positive("strength", strength), size)


def lamps_of_file(found: LampList, space: str) -> list[Lamp]:
    """Return lights of a file as lights of a flare.

    Parameters
    ----------
    found : LampList
        Of one frame, in pixels of what the picture is meant to show.
    space : str
        Colour space in which their colours are wanted.

    Returns
    -------
    list of Lamp
        The strongest first; of one that does not say its flux the picture says it, and its colour.
    """
    lamps = sorted((seen.lamp for seen in found.sightings), key=lambda lamp: -lamp.flux)
    return [_lamp_of_file(lamp, found.colour_space, space) for lamp in lamps]


def found_lights(scene: Scene, threshold: float | None, most: int = MOST_LIGHTS) -> list[Light]:
    """Return the lights that the picture shows.

    Parameters
    ----------
    scene : Scene
        With a picture.
    threshold : float, optional
        Luminance of a pixel that belongs to a light; that of `glare.lamp_threshold` without it.
    most : int
        So many of the brightest.

    Returns
    -------
    list of Light
        The brightest first.

    Raises
    ------
    refuse.Refusal
        Where there is no picture, or nothing in it is as bright.
    """
    if scene.over is None:
        raise refuse.Refusal("'find-lights' needs the picture in which to look: --over IN.exr.")
    (rows, columns), (top, left) = scene.shape, scene.corner
    height, width = scene.over.pixels.shape[:2]
    whole = np.zeros((rows, columns, 3), np.float32)
    whole[top : top + height, left : left + width] = scene.over.pixels[..., :3]
    seen = Picture(whole, scene.over.colour_space)
    if threshold is None:
        threshold = lamp_threshold(scene.over)
    if threshold == 0:
        raise refuse.Refusal("'find-lights' finds nothing: the picture is black.")
    found = flare.find_lights(seen, scene.lens, refuse.positive("find-lights", threshold), most)
    if not found:
        brightest = float(luminances(seen).max())
        raise refuse.Refusal(
            f"'find-lights' finds nothing brighter than {threshold:g}; "
            f"the brightest pixel is {brightest:.4g}."
        )
    return found


def measured(scene: Scene, point: Light) -> tuple[float, float, float]:
    """Return what the picture shows of a light: its pixels' sum.

    Parameters
    ----------
    scene : Scene
        With a picture.
    point : Light
        Towards the light.

    Returns
    -------
    tuple of float
        Red, green and blue, none negative.

    Raises
    ------
    refuse.Refusal
        Where the light stands off the picture, or the picture is black there.
    """
    assert scene.over is not None
    x, y = flare.place_on_picture(scene.lens, point, scene.shape)
    x, y = x - scene.corner[1], y - scene.corner[0]
    rows, columns = scene.over.pixels.shape[:2]
    if not (0 <= x < columns and 0 <= y < rows):
        raise refuse.Refusal(
            f"the light at {x:.0f},{y:.0f} pixels is off the picture, which cannot say how strong it is; "
            "give --strength."
        )
    lit, brightest = lit_about(luminances(scene.over), (x, y))
    if brightest <= 0:
        raise refuse.Refusal(f"the picture is black at {x:.0f},{y:.0f} pixels; give --strength.")
    red, green, blue = np.maximum(scene.over.pixels[..., :3][lit].sum(axis=0, dtype=np.float64), 0.0)
    return float(red), float(green), float(blue)


def _lamp_of_file(lamp: glare.Lamp, space: str, wanted: str) -> Lamp:
    if lamp.flux == 0:
        return Lamp(lamp.place, True)
    colour = light.from_xyz(light.to_xyz(np.asarray(lamp.colour), space), wanted)
    red, green, blue = np.maximum(colour, 0.0)
    return Lamp(lamp.place, True, (float(red), float(green), float(blue)), lamp.flux, lamp.size)


def _angle(diameter: float, scene: Scene) -> float:
    """Return the angle across a light of some pixels, at the picture's centre."""
    scale = min(pixels_per_tangent(scene.lens, scene.shape))
    return 2.0 * math.atan(0.5 * diameter / scale)


def _luminance(colour: tuple[float, float, float], scene: Scene) -> float:
    """Return Y relative to equal energy, in which spectra are summed."""
    return float(light.to_xyz(np.asarray(colour), _space(scene))[1])


def _spectrum(colour: tuple[float, float, float], scene: Scene) -> Spectrum:
    largest = max(max(colour), 1e-30)
    return flare.colour_spectrum([part / largest for part in colour], _space(scene))


def _space(scene: Scene) -> str:
    return "rec709" if scene.over is None else scene.over.colour_space
