"""A lens, a way through it and rays, as every ray tracer can take them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole.flare.prescription import Lens

# Where the rays land on the sensor at a wavelength in metres: (N, 2) in metres.
Positions = Callable[[float], NDArray[np.floating]]
# Rays start so far in front of the first vertex, metres.
BEFORE = 0.05


@dataclass(frozen=True, eq=False)
class LensRays:
    """Parallel rays through a lens, by the image's way or a ghost's.

    Parameters
    ----------
    lens : Lens
        The lens, of spheres and planes.
    reflections : tuple of int
        As in `aureole.flare.GhostPath`; () is the image.
    points : ndarray, shape (N, 2)
        Where rays cross the plane of the first vertex, metres.
    direction : tuple of float
        Unit vector from the lens towards the light.
    """

    lens: Lens
    reflections: tuple[int, ...]
    points: NDArray[np.float64]
    direction: tuple[float, float, float]

    @property
    def heading(self) -> NDArray[np.float64]:
        """The direction in which the rays travel, shape (3,)."""
        x, y, z = self.direction
        return np.array([-x, -y, z])

    @property
    def origins(self) -> NDArray[np.float64]:
        """Where the rays start, in front of the lens, shape (N, 3)."""
        starts = np.column_stack([self.points, np.zeros(len(self.points))])
        return np.asarray(starts - BEFORE * self.heading)
