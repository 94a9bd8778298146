"""The ringing-texture job: the fringes of a lens's stop, for the ghosts that show its shape."""

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from aureole import light, refuse
from aureole.diffraction.ringing import RingingTexture, ringing_texture_stages, samples_a_texel
from aureole.jobs.near_field import HALF_PLANE, NearFieldJob, NearSetup, set_up
from aureole.records import Picture, Stage

MARGIN = 0.25
LEAVE_OUT = "leave it out"
# What says where a plane lies, or how it is computed, and what to do instead.
NOT_FOR_TEXTURES = {
    "distance": "give 'fresnel_number'",
    "extent": "'margin' says how wide it is",
    "centre": "it lies about the axis",
    "obstacle": "it needs an opening",
    "amplitude": LEAVE_OUT,
    "cull": LEAVE_OUT,
    "method": LEAVE_OUT,
    "finest": LEAVE_OUT,
    "spectral": LEAVE_OUT,
}


@dataclass(frozen=True)
class NearTextureJob:
    """What ringing texture to make.

    Parameters
    ----------
    plane : NearFieldJob
        The opening and its light, a Fresnel number, and a square shape in texels; what else would say
        where the plane is, or how to compute it, is left out.
    margin : float
        Beyond the opening's width on each side, in parts of the width, 0 to 10.
    """

    plane: NearFieldJob
    margin: float = MARGIN


@dataclass(frozen=True, eq=False)
class NearTextureResult:
    """A ringing texture.

    Parameters
    ----------
    picture : Picture
        Irradiance, 1 where nothing blocks the light: three equal channels, or colour in which the light
        itself is white.
    texture : RingingTexture
        The same as `aureole.diffraction.ringing_texture` returns it.
    report : dict
        Plain numbers with units in their names.
    description : str
        What it is in words.
    """

    picture: Picture
    texture: RingingTexture
    report: dict[str, Any]
    description: str


def run_near_texture(job: NearTextureJob) -> Iterator[Stage]:
    """Run a ringing-texture job.

    Parameters
    ----------
    job : NearTextureJob
        What to make.

    Yields
    ------
    Stage
        The last one holds a `NearTextureResult`.
    """
    _refuse_what_clashes(job.plane)
    number = job.plane.fresnel_number
    if number is None:
        raise refuse.Refusal("'texture' needs 'fresnel_number', such as --fresnel-number 30.")
    size, columns = job.plane.shape
    if size != columns:
        raise refuse.Refusal(
            f"'size' of a texture must be one number, for it is square; got {columns}x{size}."
        )
    fine = samples_a_texel(number, size, job.margin)
    yield Stage(0.0, "aperture")
    # Memory is needed for all samples of which the texels are means.
    setup = set_up(dataclasses.replace(job.plane, shape=(size * fine, size * fine)))
    stages = ringing_texture_stages(
        setup.aperture, number, size, job.margin, setup.lamp, setup.wavelength, job.plane.samples
    )
    for stage in stages:
        if stage.result is None:
            yield stage
    texture = stage.result
    assert isinstance(texture, RingingTexture)
    yield Stage(1.0, "ringing texture", _result(setup, texture, job.margin))


def _refuse_what_clashes(plane: NearFieldJob) -> None:
    defaults = {part.name: part.default for part in dataclasses.fields(NearFieldJob)}
    for name, instead in NOT_FOR_TEXTURES.items():
        if getattr(plane, name) != defaults[name]:
            raise refuse.Refusal(f"'{name}' does not go with 'texture'; {instead}.")
    if plane.opening.shape == HALF_PLANE:
        raise refuse.Refusal("a half plane has no width and so no texture; take another aperture.")


def _result(setup: NearSetup, texture: RingingTexture, margin: float) -> NearTextureResult:
    if setup.lamp is None:
        pixels = np.repeat(texture.pixels[..., None], 3, axis=2)
        shown, irradiance = Picture(pixels, setup.job.colour_space), texture.pixels
    else:
        shown = light.convert(light.in_white_of(setup.lamp, texture.pixels), setup.job.colour_space)
        irradiance = texture.pixels[..., 1]
    size, width = len(texture.pixels), setup.aperture.width
    report: dict[str, Any] = {
        "aperture": setup.aperture.name,
        "aperture_width_m": width,
        "texture_m": [texture.reach * width, texture.reach * width],
        "size": [size, size],
        "margin": float(margin),
    }
    if setup.lamp is None:
        report["wavelength_m"] = setup.wavelength
    else:
        report["illuminant"] = setup.lamp.name
    report |= {
        "fresnel_number": texture.fresnel_number,
        "reach": texture.reach,
        "kept": texture.kept,
        "border": texture.border,
        "largest_irradiance": float(irradiance.max()),
    }
    words = f"ringing texture, Fresnel number {texture.fresnel_number:g}, behind {setup.words()}"
    return NearTextureResult(shown, texture, report, words)
