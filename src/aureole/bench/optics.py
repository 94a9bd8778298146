"""One far-field problem as every library can pose it: a mask, a lens, a sensor."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# The intensity on the sensor at a wavelength in metres, up to a factor: |F(x / λf)|² / λ².
Intensity = Callable[[float], NDArray[np.floating]]


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
