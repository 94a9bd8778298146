"""Optical problems as every library can pose them: a mask, a lens and a sensor, or a mask and a plane."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole.records import Aperture, Grid

# The intensity on the sensor at a wavelength in metres, up to a factor: |F(x / λf)|² / λ².
Intensity = Callable[[float], NDArray[np.floating]]
# The irradiance on the plane at a distance in metres, 1 where nothing is in the way.
Irradiance = Callable[[float], NDArray[np.floating]]


@dataclass(frozen=True, eq=False)
class Optics:
    """A lens that is stopped down by a mask, focused at infinity.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Transmittance; a sample stands for a square pixel.
    width : float
        Of the mask, metres.
    focal_length : float
        Metres.
    pitch : float
        Of the n × n sensor pixels, metres; pixel (n // 2, n // 2) lies on the axis.
    """

    mask: NDArray[np.float32]
    width: float
    focal_length: float
    pitch: float

    @property
    def size(self) -> int:
        """Pixels on each side, of the mask and of the sensor."""
        return len(self.mask)

    @property
    def pixel(self) -> float:
        """The mask's pixel, metres."""
        return self.width / self.size


@dataclass(frozen=True, eq=False)
class Plane:
    """A mask in a plane wave, and as many places on a plane behind it, as far apart.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Transmittance.
    width : float
        Of the mask and of the plane, metres.
    wavelength : float
        Metres.
    """

    mask: NDArray[np.float32]
    width: float
    wavelength: float

    @property
    def size(self) -> int:
        """Pixels on each side."""
        return len(self.mask)

    @property
    def aperture(self) -> Aperture:
        """The mask, its pixels squares."""
        return Aperture(self.width, mask=self.mask)

    @property
    def grid(self) -> Grid:
        """The middles of the pixels, where libraries that take pixels for samples have theirs."""
        step = self.width / self.size
        middle = 0.0 if self.size % 2 else 0.5 * step
        return Grid((self.size, self.size), (step, step), (middle, middle))

    @property
    def centred(self) -> Grid:
        """As many places as far apart, of which the middle one lies on the axis."""
        return Grid(self.grid.shape, self.grid.spacing)

    def distance(self, fresnel_number: float) -> float:
        """Return the distance at which an opening across half of the mask has a Fresnel number.

        Parameters
        ----------
        fresnel_number : float
            (width / 4)² / (λz).

        Returns
        -------
        float
            Metres.
        """
        return (0.25 * self.width) ** 2 / (self.wavelength * fresnel_number)
