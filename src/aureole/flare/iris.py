"""The stop's opening as a mask that ghosts look up: any aperture, or a texture with near-field ringing.

A mask tiles the square [-1, 1]² in parts of the iris's radius, x to the right and y downward; it holds the
part of the power that passes. Where it has light beyond the unit circle it is given on a larger square, and
the rays are traced with a stop as much larger.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import aperture, refuse
from aureole.diffraction.ringing import RingingTexture
from aureole.records import Aperture

SIZE = 512
# What lies beyond the unit circle is left out where it is less than this part of the light.
NEGLIGIBLE = 1e-4


@dataclass(frozen=True, eq=False)
class StopMask:
    """A stop's opening.

    Parameters
    ----------
    pixels : ndarray of float32, shape (n, n)
        Part of the power that passes.
    reach : float
        Half the mask's side in parts of the iris's radius, at least 1: all its light is within that circle.
    """

    pixels: NDArray[np.float32]
    reach: float


def stop_mask(iris: Aperture | RingingTexture | NDArray[np.floating]) -> StopMask:
    """Return the mask of an iris.

    Parameters
    ----------
    iris : Aperture, RingingTexture or ndarray of shape (n, n)
        An aperture, whose width is the iris's diameter whatever it is in metres; the ringing behind one,
        from `diffraction.ringing_texture` (a coloured one counts by its luminance); or a mask on [-1, 1]².

    Returns
    -------
    StopMask
        Part of the power: the square of an aperture's amplitude.

    Raises
    ------
    refuse.Refusal
        Where a mask is not square, has values that are no powers, or lets no light through.
    """
    if isinstance(iris, RingingTexture):
        pixels = iris.pixels if iris.pixels.ndim == 2 else iris.pixels[..., 1]
        return _within_circle(np.asarray(pixels, dtype=np.float32), iris.reach)
    if isinstance(iris, Aperture):
        amplitude = aperture.rasterize(iris, SIZE)
        clear = iris.mask is None and all(abs(ring.transmittance) == 1.0 for ring in iris.outlines)
        # In a clear opening a value between 0 and 1 is the part of a pixel that is open.
        return _within_circle(amplitude if clear else amplitude**2, 1.0)
    given = refuse.all_finite("iris", refuse.shape_of("iris", iris, (None, None)))
    if given.shape[0] != given.shape[1]:
        raise refuse.Refusal(f"'iris' must be a square mask, got {given.shape[0]} by {given.shape[1]}.")
    if given.min() < 0 or not given.any():
        raise refuse.Refusal("'iris' must let some light through, and no negative amount.")
    return _within_circle(given.astype(np.float32), 1.0)


def _within_circle(pixels: NDArray[np.float32], reach: float) -> StopMask:
    """Widen the square with darkness until the circle in it holds all light."""
    count = len(pixels)
    places = (np.arange(count) + 0.5) * 2.0 / count - 1.0
    radius = np.hypot(places[:, None], places[None, :])
    order = np.argsort(radius, axis=None)
    held = np.cumsum(pixels.ravel()[order], dtype=np.float64)
    outermost = float(radius.ravel()[order][np.searchsorted(held, (1.0 - NEGLIGIBLE) * held[-1])])
    # A pixel on the circle itself reaches out a little.
    beyond = max(int(np.ceil((outermost - 1.0) * 0.5 * count - 1.0)), 0)
    return StopMask(np.pad(pixels, beyond), reach * (1.0 + 2.0 * beyond / count))
