"""Ringing textures: the Fresnel fringes of a lens's stop, for the ghosts that show its shape.

A ghost is an image of the stop, out of focus: the light on it is the stop's near field (quad paper §6.2).
How far out of focus it is, the Fresnel number (width / 2)² / (λz) says by itself, so no distance is needed.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction.near import near_power
from aureole.diffraction.near_picture import near_picture_stages
from aureole.records import Aperture, Grid, Picture, Spectrum, Stage

WAVELENGTH = 550e-9
# Samples to each √(λz) that keep the fringes, and the most to a texel and axis.
SAMPLES_A_ZONE, MOST_SAMPLES = 4.0, 4
# What is lit lies within the square, but for rounding.
BEYOND = 1 + 1e-6


@dataclass(frozen=True, eq=False)
class RingingTexture:
    """Irradiance behind a stop on a square about its axis, relative to where nothing blocks the light.

    Texel (i, j) of n × n is the mean over a square whose centre has the relative stop coordinates
    x = (2 (j + ½) / n − 1) reach to the right and y = (2 (i + ½) / n − 1) reach downward, where ±1 is half
    the stop's width. So the texture coordinates (u, v) from 0 to 1 of a point (x, y) in the stop are
    ((x / reach + 1) / 2, (y / reach + 1) / 2).

    Parameters
    ----------
    pixels : ndarray of float32, shape (n, n) or (n, n, 3)
        1 where nothing blocks the light; in XYZ the light's white there.
    reach : float
        Half the texture's side over half the stop's width.
    fresnel_number : float
        (width / 2)² / (λz).
    kept : float
        Share of the light through the opening that falls on the square; of its luminance in colour.
    border : float
        Largest irradiance, or luminance, of the outermost texels.
    """

    pixels: NDArray[np.float32]
    reach: float
    fresnel_number: float
    kept: float
    border: float


def ringing_texture(
    shape: Aperture,
    fresnel_number: float,
    size: int = 512,
    margin: float = 0.25,
    spectrum: Spectrum | None = None,
    wavelength: float = WAVELENGTH,
    samples: int | None = None,
    whole: bool = False,
) -> RingingTexture:
    """Return the irradiance behind a stop on the square of its width and a margin (quad paper §6.2).

    Parameters
    ----------
    shape : Aperture
        The stop, cropped by the housing or not (`aperture.cats_eye`); its width is the iris's own.
    fresnel_number : float
        (width / 2)² / (λz) at `wavelength`: large for sharp ghosts with fine fringes along the edge.
    size : int
        Texels a side.
    margin : float
        Beyond the stop's width on each side, in parts of the width. Light falls off as the inverse square
        of the distance from the shadow's edge.
    spectrum : Spectrum, optional
        The light's, for a texture in XYZ. None is light of one wavelength, and the texture has one channel.
    wavelength : float
        Metres; for one without a spectrum only the Fresnel number counts.
    samples : int, optional
        Number of wavelengths, as for `near_picture`.
    whole : bool
        Make up for the light that misses the square, so that the texture's sum is the opening's light.

    Returns
    -------
    RingingTexture
        The mean over each texel, with the share of the light that it holds and what is left at its border.
        The sum of the texels times their area is the opening's area times that share.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, or light comes from beyond the stop's width.
    """
    stages = ringing_texture_stages(shape, fresnel_number, size, margin, spectrum, wavelength, samples, whole)
    for stage in stages:
        texture = stage.result
    assert isinstance(texture, RingingTexture)
    return texture


def ringing_texture_stages(
    shape: Aperture,
    fresnel_number: float,
    size: int = 512,
    margin: float = 0.25,
    spectrum: Spectrum | None = None,
    wavelength: float = WAVELENGTH,
    samples: int | None = None,
    whole: bool = False,
) -> Iterator[Stage]:
    """Do what `ringing_texture` does, telling how far it is.

    Parameters
    ----------
    shape : Aperture
        As in `ringing_texture`.
    fresnel_number : float
        As in `ringing_texture`.
    size : int
        As in `ringing_texture`.
    margin : float
        As in `ringing_texture`.
    spectrum : Spectrum, optional
        As in `ringing_texture`.
    wavelength : float
        Metres.
    samples : int, optional
        As in `ringing_texture`.
    whole : bool
        As in `ringing_texture`.

    Yields
    ------
    Stage
        The last one holds the `RingingTexture`.

    Raises
    ------
    refuse.Refusal
        As `ringing_texture`.
    """
    refuse.positive("wavelength", wavelength)
    fine = samples_a_texel(fresnel_number, size, margin)
    if apertures.bounding_radius(shape) > math.sqrt(0.5) * shape.width * BEYOND:
        raise refuse.Refusal(
            f"the light through '{shape.name}' comes from beyond its width of {shape.width:g} m; a ringing "
            "texture needs an opening."
        )
    reach = 1 + 2 * margin
    grid = _within_texels(size, fine, reach * shape.width)
    distance = (shape.width / 2) ** 2 / wavelength / fresnel_number
    if spectrum is None:
        yield Stage(0.1, "near field")
        found = near_power(shape, grid, distance, wavelength)
    else:
        for stage in near_picture_stages(shape, grid, distance, spectrum, samples=samples):
            yield Stage(0.98 * stage.fraction, stage.label)
        assert isinstance(stage.result, Picture)
        found = stage.result.pixels
    texture = _texture(shape, _mean_over_texels(found, size), reach, float(fresnel_number), whole)
    yield Stage(1.0, "ringing texture", texture)


def samples_a_texel(fresnel_number: float, size: int, margin: float) -> int:
    """Return how many samples along each axis a texel is the mean of.

    Parameters
    ----------
    fresnel_number : float
        As in `ringing_texture`.
    size : int
        Texels a side.
    margin : float
        As in `ringing_texture`.

    Returns
    -------
    int
        As many as the fringes near the edge ask for, 1 to 4.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.positive("fresnel_number", fresnel_number)
    refuse.at_least("size", size, 2)
    refuse.between("margin", margin, 0, 10)
    wanted = SAMPLES_A_ZONE * 2 * (1 + 2 * margin) * math.sqrt(fresnel_number) / size
    return math.ceil(min(max(wanted, 1), MOST_SAMPLES))


def _texture(
    shape: Aperture, pixels: NDArray[np.float64], reach: float, fresnel_number: float, whole: bool
) -> RingingTexture:
    """Measure what the square holds and what its border has left."""
    luminance = pixels if pixels.ndim == 2 else pixels[..., 1]
    texel = (reach * shape.width / len(pixels)) ** 2
    kept = float(luminance.sum()) * texel / apertures.energy(shape)
    if whole and not kept > 0:
        raise refuse.Refusal(
            f"'whole' needs light on the square; 'fresnel_number' {fresnel_number:g} has none."
        )
    pixels = pixels / kept if whole else pixels
    border = max(
        float(side.max()) for side in (luminance[0], luminance[-1], luminance[:, 0], luminance[:, -1])
    )
    return RingingTexture(pixels.astype(np.float32), reach, fresnel_number, kept, border)


def _within_texels(size: int, fine: int, side: float) -> Grid:
    """Return the middles of fine × fine equal parts of each texel of a square about the axis."""
    count = size * fine
    step = side / count
    centre = 0.0 if count % 2 else step / 2
    return Grid((count, count), (step, step), (centre, centre))


def _mean_over_texels(found: NDArray[np.floating], size: int) -> NDArray[np.float64]:
    fine = len(found) // size
    parts = found.reshape(size, fine, size, fine, *found.shape[2:])
    return np.asarray(parts.mean(axis=(1, 3), dtype=np.float64))
