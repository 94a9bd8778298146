"""Depth of field, after a picture is drawn: each pixel's light spread over its circle of confusion.

A diffraction pattern is not focused where the surface is: a flat grating shows it as far behind the surface
as the lamp is before it, like a mirror's image. So draw the diffuse part and the rest as two pictures, and
defocus them by their own depths (surface paper, section 7).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.picture import convolve
from aureole.surface.views import View


def circle_of_confusion(depth: ArrayLike, focus: float, aperture: float, view: View) -> NDArray[np.float64]:
    """Return the diameters of the discs that points out of focus become.

    Parameters
    ----------
    depth : array_like
        Metres along the line of sight.
    focus : float
        Depth in metres at which points are sharp.
    aperture : float
        Diameter of the lens's opening in metres.
    view : View
        A view in perspective.

    Returns
    -------
    ndarray of float64, shape of `depth`
        Pixels: aperture · |1 / focus − 1 / depth| over the angle of a pixel.

    Raises
    ------
    refuse.Refusal
        Where the view has parallel rays, or a length is not positive.
    """
    if not view.perspective:
        raise refuse.Refusal("'view' must be in perspective: parallel rays have no circle of confusion.")
    away = refuse.all_finite("depth", depth).astype(np.float64)
    if (away <= 0).any():
        raise refuse.Refusal("'depth' must be > 0 everywhere.")
    pixel = 2.0 * float(np.linalg.norm(view.right)) / view.shape[1]
    wide = refuse.positive("aperture", aperture)
    return np.asarray(wide * np.abs(1.0 / refuse.positive("focus", focus) - 1.0 / away) / pixel)


def defocus(pixels: ArrayLike, diameters: ArrayLike, layers: int = 12) -> NDArray[np.float32]:
    """Spread each pixel over a disc of its own diameter: light adds up, and its sum is kept.

    Parameters
    ----------
    pixels : array_like, shape (rows, columns, channels)
        Linear colour associated with alpha, and alpha.
    diameters : array_like, shape (rows, columns)
        Pixels, from `circle_of_confusion`.
    layers : int
        Discs that are convolved with, evenly from the smallest to the largest; a pixel between two of them
        takes some of both.

    Returns
    -------
    ndarray of float32, shape of `pixels`
        The blurred picture; what is spread beyond its border is lost.

    Raises
    ------
    refuse.Refusal
        Where the shapes differ, or a diameter is negative.
    """
    picture = refuse.all_finite("pixels", refuse.shape_of("pixels", pixels, (None, None, None)))
    wide = refuse.all_finite("diameters", refuse.shape_of("diameters", diameters, picture.shape[:2]))
    if (wide < 0).any():
        raise refuse.Refusal("'diameters' must be >= 0.")
    count = refuse.at_least("layers", layers, 1)
    lit = wide[np.any(picture != 0, axis=2)]
    if not lit.size:
        return picture.astype(np.float32)
    steps = np.linspace(lit.min(), lit.max(), count if lit.max() > lit.min() else 1)
    place = np.interp(wide, steps, np.arange(len(steps)))
    out = np.zeros(picture.shape, dtype=np.float32)
    for k, diameter in enumerate(steps):
        share = np.maximum(0.0, 1.0 - np.abs(place - k))[..., None]
        if share.any():
            out += convolve((picture * share).astype(np.float32), _disc(float(diameter)))
    return out


def _disc(diameter: float) -> NDArray[np.float32]:
    """Return a disc of unit sum, its border pixels by how much of them it covers."""
    half = int(np.ceil(0.5 * diameter + 0.5))
    fine = 8
    step = (np.arange((2 * half + 1) * fine) + 0.5) / fine - half - 0.5
    # A disc smaller than a pixel is that pixel.
    inside = np.hypot(step[:, None], step[None]) <= max(0.5 * diameter, 0.25)
    size = 2 * half + 1
    kernel = inside.reshape(size, fine, size, fine).mean(axis=(1, 3))
    return np.asarray(kernel / kernel.sum(), dtype=np.float32)
