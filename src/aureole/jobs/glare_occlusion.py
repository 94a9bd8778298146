"""Glare of lights that stand behind something, in pictures that were made: each light has an iris of its own.

What crops the iris is guessed from the picture about the light (quad paper §4.4, its cheap way), or taken
from a matte of what stands before the lights.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import glare, picture, refuse
from aureole.glare.camera import pupil
from aureole.jobs import frame_files
from aureole.records import Camera, Picture

# Lights smaller than this many pixels across show no silhouette.
LEAST_RADIUS = 2.0
# An iris of which more than this is left is taken as whole.
WHOLE = 0.995
MOST, RASTER_SIZE = 8, 1024


@dataclass(frozen=True)
class GlareOcclusion:
    """What hides parts of the iris from the lights of a picture; plain values.

    Parameters
    ----------
    matte : Path, optional
        Picture whose white stands before the lights, #### for the frame's number; the picture's own dark
        parts about each light without it.
    distance : float, optional
        Of the occluder, metres; without it the circle about each light stands for the iris.
    most : int
        Lights that are looked at, those with most light.
    """

    matte: Path | None = None
    distance: float | None = None
    most: int = MOST

    def at(self, number: int) -> "GlareOcclusion":
        """Return the same with the matte of a frame."""
        if self.matte is None or not frame_files.is_pattern(self.matte):
            return self
        return replace(self, matte=frame_files.frame(self.matte, number))


@dataclass(frozen=True, eq=False)
class OccludedLight:
    """A light whose iris is cropped.

    Parameters
    ----------
    lamp : aureole.glare.Lamp
        The light.
    camera : Camera
        With the iris as the light sees it.
    open_part : float
        Part of the iris that is left.
    radius : float
        Pixels about the light that stand for the iris.
    """

    lamp: glare.Lamp
    camera: Camera
    open_part: float
    radius: float


def occluded_lights(source: Picture, camera: Camera, how: GlareOcclusion) -> list[OccludedLight]:
    """Find the lights of a picture whose iris something crops.

    Parameters
    ----------
    source : Picture
        Linear, in a space of `light.SPACES`.
    camera : Camera
        Of the picture.
    how : GlareOcclusion
        What hides.

    Returns
    -------
    list of OccludedLight
        The one with most light first; a light that is hidden whole by a matte is none.

    Raises
    ------
    refuse.Refusal
        Where the matte cannot be read, or has another size.
    """
    refuse.at_least("most", how.most, 1)
    opening, seen = pupil(camera), glare.luminances(source)
    matte = None if how.matte is None else _matte(how.matte, seen.shape)
    whole = apertures.energy(opening)
    found = []
    for lamp in glare.find_lamps(source, most=how.most):
        own = glare.light_pixels(seen, lamp)
        centre, radius = glare.circle_about(own >= 0.5) if np.any(own >= 0.5) else (lamp.place, 0.0)
        if matte is not None:
            centre = lamp.place
        if how.distance is not None:
            radius = glare.neighbourhood_radius(camera, opening, how.distance)
        else:
            radius *= glare.INSIDE
        if radius < LEAST_RADIUS:
            continue
        left = glare.cropped_opening(
            opening, own if matte is None else 1 - matte, centre, radius, RASTER_SIZE
        )
        if left is None:
            continue
        part = min(apertures.energy(left) / whole, 1.0)
        if part < WHOLE:
            found.append(OccludedLight(lamp, replace(camera, iris=left), part, radius))
    return found


def with_occlusion(
    out: Picture,
    source: Picture,
    lights: list[OccludedLight],
    psf_of: Callable[[Camera], Picture],
    lay: Callable[[Picture, Any], Picture],
    usual: Any,
) -> Picture:
    """Give lights the glare of their own irises, in place of the camera's.

    Parameters
    ----------
    out : Picture
        With the camera's glare on all of it.
    source : Picture
        Without.
    lights : list of OccludedLight
        Whose glare is to change.
    psf_of : callable
        Makes the point spread function of a camera.
    lay : callable
        Lays glare over a picture, as the rest of the picture has it.
    usual : object
        The camera's point spread function, as `lay` takes it.

    Returns
    -------
    Picture
        The sum of its light is that of `out`, but for what leaves the frame.
    """
    if not lights:
        return out
    patches = [_patch(source, found.lamp) for found in lights]
    together = Picture(np.sum([patch.pixels for patch in patches], axis=0), source.colour_space)
    pixels = out.pixels.astype(np.float32, copy=True)
    pixels[..., :3] -= lay(together, usual).pixels
    for found, patch in zip(lights, patches, strict=True):
        pixels[..., :3] += lay(patch, psf_of(found.camera)).pixels
    # What was added and taken away again leaves rounding behind.
    np.maximum(pixels, np.minimum(out.pixels, 0), out=pixels)
    return Picture(pixels, out.colour_space, out.metadata)


def occlusion_report(lights: list[OccludedLight]) -> list[dict[str, Any]]:
    """Return what is worth knowing of occluded lights.

    Parameters
    ----------
    lights : list of OccludedLight
        Any.

    Returns
    -------
    list of dict
        Plain numbers.
    """
    return [
        {
            "place_pixels": list(found.lamp.place),
            "iris_open": found.open_part,
            "neighbourhood_pixels": found.radius,
        }
        for found in lights
    ]


def _patch(source: Picture, lamp: glare.Lamp) -> Picture:
    """Return a lamp's light alone."""
    share = glare.lamp_matte(source, lamps=[lamp])
    return Picture(source.pixels[..., :3] * share[..., None], source.colour_space)


def _matte(path: Path, shape: tuple[int, ...]) -> NDArray[np.floating]:
    given = picture.read(path)
    if given.pixels.shape[:2] != shape[:2]:
        have = given.pixels.shape
        raise refuse.Refusal(
            f"'occluder' must be {shape[1]} x {shape[0]} pixels like the picture, got {have[1]} x {have[0]}."
        )
    return np.asarray(np.clip(given.pixels[..., :3].mean(axis=2), 0, 1))


def check(how: GlareOcclusion, mode: str) -> None:
    """Refuse, before any work, an occlusion that means nothing.

    Parameters
    ----------
    how : GlareOcclusion
        What hides.
    mode : str
        Of the glare.

    Raises
    ------
    refuse.Refusal
        Where the mode is "add", whose light is not shared among lights, or a number does not fit.
    """
    if mode == "add":
        raise refuse.Refusal("'occlusion' does not go with mode 'add'; use replace, scatter or bloom.")
    if how.distance is not None and not (how.distance > 0 and math.isfinite(how.distance)):
        raise refuse.Refusal(f"'occluder-distance' must be a finite number > 0, got {how.distance:g}.")
