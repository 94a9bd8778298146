"""Filters over pictures of ghosts: what coarse ray grids and few wavelengths leave, smoothed.

The tile paper (Bodonyi and Kunkli 2023, section 5.3) names both as remedies for its merged quads: a blur
along the dispersion, as Hullin et al. (2011) suggest, and a median. Finer grids and more wavelengths are
right where these only look right.
"""

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse

from aureole import refuse
from aureole.records import Picture

SPREAD, SIZE = 0.01, 3
WIDEST, LARGEST = 0.5, 99
# How far apart copies lie where they lie farthest apart, in pixels.
STEP = 1.0
Plane = NDArray[np.float32]


def spectral(picture: Picture, spread: float = SPREAD, centre: tuple[float, float] | None = None) -> Picture:
    """Blur a picture of ghosts along their dispersion: on the lines through the picture's middle.

    Near the axis a ghost's place and size are its matrix's elements times the light's angle and the pupil, so
    that from one wavelength to the next it is magnified about the optical axis. The picture is laid down at
    all magnifications between those of two neighbouring wavelengths, weighted by a hat function, as colours
    blended between the wavelengths would be.

    Parameters
    ----------
    picture : Picture
        Ghosts, in any linear colour space.
    spread : float
        Relative change of the distance from the middle between neighbouring wavelengths, 0..0.5.
    centre : tuple of float, optional
        (x, y) of the optical axis in pixels from the upper left corner; the picture's middle without it.

    Returns
    -------
    Picture
        Its energy is kept, but for what is magnified over the border. Every channel is treated alike.

    Raises
    ------
    refuse.Refusal
        Where the spread is out of range, or the picture holds NaN.
    """
    width = refuse.between("spread", spread, 0.0, WIDEST)
    pixels = refuse.all_finite("picture", picture.pixels).astype(np.float32)
    rows, columns = pixels.shape[:2]
    middle = (columns / 2, rows / 2) if centre is None else centre
    for name, value in zip(("centre's x", "centre's y"), middle, strict=True):
        refuse.finite(name, value)
    reach = math.hypot(*(max(c, n - c) for c, n in zip(middle, (columns, rows), strict=True)))
    # A hat function of copies so close together that they are not seen as such.
    steps = max(math.ceil(width * reach / STEP), 1)
    blurred = np.zeros_like(pixels)
    for k in range(1 - steps, steps):
        share = np.float32((1.0 - abs(k) / steps) / steps)
        blurred += share * _magnified(pixels, 1.0 + width * k / steps, middle)
    return dataclasses.replace(picture, pixels=blurred)


def median(picture: Picture, size: int = SIZE) -> Picture:
    """Replace every pixel by the median around it, channel by channel, and keep each channel's energy.

    It takes off lone bright pixels and thin seams and keeps edges. What it takes from them is given to the
    whole channel: each is scaled to its old sum.

    Parameters
    ----------
    picture : Picture
        Ghosts, in any linear colour space.
    size : int
        Pixels on each side of the window, odd.

    Returns
    -------
    Picture
        Of the same sum in each channel; a channel of which nothing would be left stays as it is.

    Raises
    ------
    refuse.Refusal
        Where the size is even or out of range, or the picture holds NaN.
    """
    refuse.at_least("size", size, 1)
    if size % 2 == 0 or size > LARGEST:
        raise refuse.Refusal(f"'size' must be an odd number of pixels up to {LARGEST}, got {size}.")
    pixels = refuse.all_finite("picture", picture.pixels).astype(np.float32)
    found = np.empty_like(pixels)
    for channel in range(pixels.shape[2]):
        plane = np.ascontiguousarray(pixels[..., channel])
        smooth = ndimage.median_filter(plane, size, mode="nearest")
        before, after = plane.sum(dtype=np.float64), smooth.sum(dtype=np.float64)
        found[..., channel] = smooth * (before / after) if before * after > 0 else plane
    return dataclasses.replace(picture, pixels=found)


def _magnified(pixels: Plane, factor: float, middle: tuple[float, float]) -> Plane:
    """Return a picture magnified about a point, each pixel's energy shared out by the area that it covers."""
    rows, columns, channels = pixels.shape
    down, across = _shares(rows, factor, middle[1]), _shares(columns, factor, middle[0])
    tall = (down @ pixels.reshape(rows, -1)).reshape(rows, columns, channels)
    turned = np.ascontiguousarray(tall.transpose(1, 0, 2)).reshape(columns, -1)
    wide = (across @ turned).reshape(columns, rows, channels)
    found: Plane = np.ascontiguousarray(wide.transpose(1, 0, 2))
    return found


def _shares(count: int, factor: float, middle: float) -> sparse.csr_array:
    """Return which part of each pixel (column) falls on each pixel (row) along one axis."""
    edges = middle + (np.arange(count + 1) - middle) * factor
    first = np.floor(edges[:-1]).astype(np.int64)
    # A pixel that is magnified by less than two covers three pixels at most.
    onto = first[:, None] + np.arange(3)
    part = np.minimum(edges[1:, None], onto + 1) - np.maximum(edges[:-1, None], onto)
    part = np.maximum(part, 0.0) / factor
    source = np.broadcast_to(np.arange(count)[:, None], onto.shape)
    inside = (onto >= 0) & (onto < count)
    where = (onto[inside], source[inside])
    return sparse.csr_array((part[inside].astype(np.float32), where), shape=(count, count))
