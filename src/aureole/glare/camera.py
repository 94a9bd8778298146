"""Cameras and their point spread functions.

A point of light far away is spread over the sensor as the far field of the iris: at x on the sensor
the frequency is x / (f λ). The result is integrated over each pixel and over the spectrum, in RGB
whose white is the light's own, so that every channel holds the same energy.
"""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import diffraction, light, refuse
from aureole.glare.kernel import FADE, fade
from aureole.records import Aperture, Camera, Grid, Picture, Spectrum, Stage

SENSOR_WIDTH, SENSOR_HEIGHT = 36e-3, 24e-3


def camera(
    focal_length: float,
    f_number: float,
    iris: Aperture,
    sensor_width: float = SENSOR_WIDTH,
    sensor_height: float = SENSOR_HEIGHT,
    resolution: tuple[int, int] = (1080, 1920),
) -> Camera:
    """Make a camera.

    Parameters
    ----------
    focal_length : float
        Metres.
    f_number : float
        Focal length over the diameter of the entrance pupil.
    iris : Aperture
        Shape of the opening, of any size; its width stands for the pupil's diameter.
    sensor_width, sensor_height : float
        Metres; 36 mm × 24 mm unless said.
    resolution : tuple of int
        Pixels of the whole sensor as (rows, columns).

    Returns
    -------
    Camera
        With the numbers as given.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.at_least("rows", resolution[0], 1)
    refuse.at_least("columns", resolution[1], 1)
    return Camera(
        refuse.positive("focal_length", focal_length),
        refuse.positive("f_number", f_number),
        refuse.positive("sensor_width", sensor_width),
        refuse.positive("sensor_height", sensor_height),
        resolution,
        iris,
    )


def pupil(camera: Camera) -> Aperture:
    """Return the camera's opening at its size in metres.

    Parameters
    ----------
    camera : Camera
        Any.

    Returns
    -------
    Aperture
        The iris, its width focal_length / f_number.
    """
    return apertures.scaled(camera.iris, camera.focal_length / camera.f_number / camera.iris.width)


def camera_psf(
    camera: Camera,
    shape: tuple[int, int],
    spectrum: Spectrum | None = None,
    colour_space: str = "rec709",
    method: str = "auto",
    sample: str = "area",
    border_fade: float = FADE,
    light_size: float = 0.0,
) -> Picture:
    """Return a camera's point spread function on its own pixels.

    Parameters
    ----------
    camera : Camera
        Any.
    shape : tuple of int
        (rows, columns) of the result; the core lies at (rows//2, columns//2).
    spectrum : Spectrum, optional
        The light's; equal energy unless given. A single line gives three equal channels.
    colour_space : str
        Primaries of the result.
    method : str
        As in `aureole.diffraction.starburst`.
    sample : str
        "area", energy of each pixel; "point", density at its centre times its area.
    border_fade : float
        Part of the half size over which the kernel falls to zero at its border; 0 for none.
    light_size : float
        Angle in radians across a disc-shaped light, such as the sun's 0.53 degrees; 0 is a point.

    Returns
    -------
    Picture
        Shape (rows, columns, 3), energy fraction of each pixel. Its metadata tells
        `energy_inside` (of the result, mean over channels) and `energy_before_fade`.

    Raises
    ------
    refuse.Refusal
        Where a choice or a number does not fit.
    """
    psf = None
    for stage in camera_psf_stages(
        camera, shape, spectrum, colour_space, method, sample, border_fade, light_size
    ):
        psf = stage.result
    assert isinstance(psf, Picture)
    return psf


def camera_psf_stages(
    camera: Camera,
    shape: tuple[int, int],
    spectrum: Spectrum | None = None,
    colour_space: str = "rec709",
    method: str = "auto",
    sample: str = "area",
    border_fade: float = FADE,
    light_size: float = 0.0,
) -> Iterator[Stage]:
    """Do what `camera_psf` does, telling how far it is.

    Parameters
    ----------
    camera : Camera
        As in `camera_psf`.
    shape : tuple of int
        As in `camera_psf`.
    spectrum : Spectrum, optional
        As in `camera_psf`.
    colour_space : str
        As in `camera_psf`.
    method : str
        As in `camera_psf`.
    sample : str
        As in `camera_psf`.
    border_fade : float
        As in `camera_psf`.
    light_size : float
        As in `camera_psf`.

    Yields
    ------
    Stage
        The last one holds the point spread function.
    """
    lamp = light.illuminant("E") if spectrum is None else spectrum
    pitch_y, pitch_x = camera.pixel_pitch
    grid = Grid(shape, (pitch_y / camera.focal_length, pitch_x / camera.focal_length))
    refuse.one_of("colour_space", colour_space, light.SPACES)
    refuse.between("border_fade", border_fade, 0, 1)
    radius = math.sin(refuse.between("light_size", light_size, 0, math.pi) / 2)
    starburst = None
    for stage in diffraction.starburst_stages(pupil(camera), grid, lamp, method, sample, radius):
        starburst = stage.result
        yield Stage(0.95 * stage.fraction, stage.label)
    assert isinstance(starburst, Picture)
    rgb = in_rgb(starburst, lamp, colour_space)
    before = float(rgb.sum(axis=(0, 1), dtype=np.float64).mean())
    rgb *= fade(shape, border_fade)[..., None]
    inside = float(rgb.sum(axis=(0, 1), dtype=np.float64).mean())
    metadata = {
        "energy_inside": inside,
        "energy_before_fade": before,
        "pixel_pitch": camera.pixel_pitch,
        "sample": sample,
    }
    yield Stage(1.0, "point spread function", Picture(rgb, colour_space, metadata))


def in_rgb(starburst: Picture, spectrum: Spectrum, colour_space: str) -> NDArray[np.float32]:
    """Return linear RGB in which the light itself is white, so that channels hold equal energy.

    Parameters
    ----------
    starburst : Picture
        XYZ.
    spectrum : Spectrum
        The light's.
    colour_space : str
        Primaries of the result.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        A single line's luminance in all channels.
    """
    if spectrum.kind == "lines" and len(spectrum.wavelengths) == 1:
        return np.repeat(starburst.pixels[..., 1:2], 3, axis=2)
    white = light.white(spectrum)
    rgb = light.from_xyz(starburst.pixels, colour_space, white=white)
    return np.ascontiguousarray(rgb, dtype=np.float32)
