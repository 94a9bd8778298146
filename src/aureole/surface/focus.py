"""Depth of field: views through the points of a lens, or a picture spread over circles of confusion.

A diffraction pattern is not focused where the surface is: a flat grating shows it as far behind the surface
as the lamp is before it, like a mirror's image, which the surface paper leaves open (section 7). Views
through the points of a lens have it right by themselves. After a picture is drawn, only one depth can be
given to each pixel: draw the diffuse part and the rest as two pictures, and defocus them by their own depths.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.picture import convolve
from aureole.surface.views import View


@dataclass(frozen=True)
class ThinLens:
    """A lens's opening, and where it is focused.

    Parameters
    ----------
    diameter : float
        Of the opening in metres.
    focus : float
        Depth in metres at which points are sharp.
    samples : int
        Points of the opening; each is a whole picture.
    """

    diameter: float
    focus: float
    samples: int = 64


def lens_views(view: View, lens: ThinLens) -> tuple[View, ...]:
    """Return the views through points all over a lens: the mean of their pictures has its depth of field.

    Parameters
    ----------
    view : View
        Of the lens's middle, in perspective.
    lens : ThinLens
        The lens.

    Returns
    -------
    tuple of View
        Shifted so that all agree at the focused depth.

    Raises
    ------
    refuse.Refusal
        Where the view has parallel rays, a length is not positive or there are no samples.
    """
    _refuse_parallel(view)
    wide, focus = refuse.positive("diameter", lens.diameter), refuse.positive("focus", lens.focus)
    count = refuse.at_least("samples", lens.samples, 1)
    # A sunflower's seeds: equal areas, never in line (Vogel 1979).
    turn = np.pi * (3.0 - np.sqrt(5.0))
    views = []
    for k in range(count):
        radius, angle = 0.5 * wide * np.sqrt((k + 0.5) / count), k * turn
        across = view.right / np.linalg.norm(view.right) * np.cos(angle)
        aside = radius * (across + view.up / np.linalg.norm(view.up) * np.sin(angle))
        views.append(replace(view, eye=view.eye + aside, shift=view.shift - aside / focus))
    return tuple(views)


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
    _refuse_parallel(view)
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


def _refuse_parallel(view: View) -> None:
    if not view.perspective:
        raise refuse.Refusal("'view' must be in perspective: parallel rays have no circle of confusion.")
