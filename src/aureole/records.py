"""The records that cross the walls between rooms: public fields, named units, no mathematics.

Arrays are C-order. Pictures are (row, column[, channel]). Points are (x, y) with x to the right
along columns and y downward along rows, as on a picture. Records are frozen; the arrays in them
are shared, so nobody writes into an array that arrived in a record.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Grid:
    """A regular grid of samples on a plane, in frequency or in angle.

    Sample (i, j) lies at centre + ((i − rows//2)·spacing_y, (j − columns//2)·spacing_x), so the
    centre is a sample at odd and at even sizes.

    Parameters
    ----------
    shape : tuple of int
        Number of (rows, columns).
    spacing : tuple of float
        Distance between samples as (y, x): metres on a plane, cycles per metre in frequency.
    centre : tuple of float
        Position of the central sample as (y, x), same unit.
    """

    shape: tuple[int, int]
    spacing: tuple[float, float]
    centre: tuple[float, float] = (0.0, 0.0)

    def axes(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the positions of the rows (R,) and of the columns (C,), in the grid's unit."""
        (rows, columns), (step_y, step_x), (centre_y, centre_x) = self.shape, self.spacing, self.centre
        return _axis(rows, step_y, centre_y), _axis(columns, step_x, centre_x)


def _axis(count: int, step: float, centre: float) -> NDArray[np.float64]:
    return np.asarray(centre + (np.arange(count) - count // 2) * step, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Outline:
    """One closed ring of straight edges and circular arcs, with the amplitude it lets through.

    Parameters
    ----------
    vertices : ndarray of float64, shape (V, 2)
        Corners (x, y) in metres, in order; the last joins the first.
    bulges : ndarray of float64, shape (V,)
        Edge j runs from vertex j to vertex j + 1. Its bulge is tan(sweep / 4) of the arc, signed:
        0 is straight, ±1 half a circle, positive where the arc turns from +x towards +y.
    transmittance : float
        Amplitude that the inside adds. Rings add up, so a hole is a ring with a negative value.
    """

    vertices: NDArray[np.float64]
    bulges: NDArray[np.float64]
    transmittance: float = 1.0


@dataclass(frozen=True, eq=False)
class Aperture:
    """What lets light through: rings with exact edges, or a raster mask.

    Parameters
    ----------
    width : float
        Side in metres of the square [−width/2, width/2]² on which the aperture is rasterized; for
        an iris also the diameter that its f-number counts.
    outlines : tuple of Outline
        Rings whose transmittances add up; empty for a raster.
    mask : ndarray of float32, shape (rows, columns), or None
        Amplitude transmittance 0..1 of pixels that tile the square, each a small square of constant
        transmittance; None where outlines are given. In an eye it goes down to −1, which is light that
        passes whole and half a wave late.
    name : str
        What to call it in reports.
    wavefront : ndarray of float32, shape (rows, columns), or None
        Wavefront error W of each of the mask's pixels in metres of optical path, positive where light
        has gone a longer way; at the wavelength λ a pixel lets through mask · exp(i 2π W / λ). None is
        a flat wavefront.
    """

    width: float
    outlines: tuple[Outline, ...] = ()
    mask: NDArray[np.float32] | None = None
    name: str = "aperture"
    wavefront: NDArray[np.float32] | None = None


@dataclass(frozen=True, eq=False)
class Field:
    """Complex amplitude on a grid.

    Parameters
    ----------
    amplitude : ndarray of complex64 or complex128, shape (rows, columns)
        From `far_field` the Fourier integral itself, in square metres.
    grid : Grid
        Where the samples lie.
    """

    amplitude: NDArray[np.complexfloating]
    grid: Grid


@dataclass(frozen=True, eq=False)
class Pattern:
    """Intensity on a grid at one wavelength.

    Parameters
    ----------
    intensity : ndarray of float32, shape (rows, columns)
        Squared amplitude, or its mean over each pixel.
    grid : Grid
        Where the samples lie; in frequency, cycles per metre at `wavelength`.
    wavelength : float
        Metres.
    energy : float
        Integral of the intensity over the infinite plane.
    """

    intensity: NDArray[np.float32]
    grid: Grid
    wavelength: float
    energy: float


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Values over wavelength.

    Parameters
    ----------
    wavelengths : ndarray of float64, shape (W,)
        Metres, rising.
    values : ndarray of float64, shape (W,)
        Power per wavelength for kind "power" (relative or W m⁻³); power for kind "lines".
    kind : str
        "power": a density, joined by straight lines between samples; "lines": separate lines.
    name : str
        What to call it in reports.
    """

    wavelengths: NDArray[np.float64]
    values: NDArray[np.float64]
    kind: str = "power"
    name: str = "spectrum"


@dataclass(frozen=True, eq=False)
class Picture:
    """A linear picture.

    Parameters
    ----------
    pixels : ndarray of float32, shape (rows, columns, channels)
        Linear colour in the first three channels; a fourth is alpha. Colour is associated with
        (already multiplied by) alpha, as in EXR.
    colour_space : str
        One of the names in `aureole.light.SPACES`.
    metadata : mapping
        What the file said besides: windows, chromaticities, extra channels, attributes.
    """

    pixels: NDArray[np.float32]
    colour_space: str = "rec709"
    metadata: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Camera:
    """A camera as far as its glare goes.

    Parameters
    ----------
    focal_length : float
        Metres.
    f_number : float
        Focal length over the iris's width.
    sensor_width, sensor_height : float
        Metres.
    resolution : tuple of int
        Pixels of the whole sensor as (rows, columns).
    iris : Aperture
        Shape of the opening; its width stands for focal_length / f_number whatever it is.
    """

    focal_length: float
    f_number: float
    sensor_width: float
    sensor_height: float
    resolution: tuple[int, int]
    iris: Aperture

    @property
    def pixel_pitch(self) -> tuple[float, float]:
        """Pixel size on the sensor as (y, x), in metres."""
        rows, columns = self.resolution
        return self.sensor_height / rows, self.sensor_width / columns


@dataclass(frozen=True, eq=False)
class Light:
    """A light source far from the lens.

    Parameters
    ----------
    direction : tuple of float
        Unit vector (x, y, z) from the lens towards the light, z forward.
    spectrum : Spectrum
        Its colour.
    irradiance : float
        At the lens, W/m² or relative.
    angular_size : float
        Diameter in radians; 0 is a point.
    """

    direction: tuple[float, float, float]
    spectrum: Spectrum
    irradiance: float = 1.0
    angular_size: float = 0.0


@dataclass(frozen=True, eq=False)
class Stage:
    """One step of a long computation: the only progress protocol.

    Parameters
    ----------
    fraction : float
        Work done, 0..1; the last stage of a computation has 1.
    label : str
        What is being done, for a person.
    result : object
        The result so far, or None; in the last stage the same as the one-shot answer.
    """

    fraction: float
    label: str
    result: Any = None
