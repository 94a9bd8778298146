"""The lights that a picture shows: where they stand, how strong, how large and of which colour they are.

A light is a connected region brighter than a threshold, with the pixels about it that it covers in part. Its
light is counted above the ground on which it lies, so that it changes smoothly as the light moves over the
pixels, passes behind something, or fades.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import light, picture, refuse
from aureole.records import Picture

# A light is so many times as bright as the median pixel; white paper is five times as bright as grey card.
OVER_MEDIAN = 16.0
# And so bright beside the brightest pixel: what is fainter adds nothing to be seen beside that one's glare.
OF_BRIGHTEST = 1e-3
MARGIN = 1
MOST_LAMPS = 256


@dataclass(frozen=True)
class Lamp:
    """A light that a picture shows.

    Parameters
    ----------
    place : tuple of float
        Its centre of light: (x, y) in pixels from the picture's upper left corner; the centre of the first
        pixel is at (0.5, 0.5).
    flux : float
        Luminance of its pixels, summed, above the ground on which it lies.
    colour : tuple of float
        Linear red, green and blue of luminance 1, in the picture's colour space: flux times colour is the
        sum of its pixels.
    size : float
        Pixels across the even disc that is as spread out; 0 for a point.
    box : tuple of int
        Left, top, right, bottom: the first pixel and the one after the last.
    peak : float
        Luminance of its brightest pixel.
    """

    place: tuple[float, float]
    flux: float
    colour: tuple[float, float, float] = (1.0, 1.0, 1.0)
    size: float = 0.0
    box: tuple[int, int, int, int] = (0, 0, 0, 0)
    peak: float = 0.0


def luminances(source: Picture) -> NDArray[np.float64]:
    """Return the luminance of each pixel.

    Parameters
    ----------
    source : Picture
        Linear, in a space of `light.SPACES`.

    Returns
    -------
    ndarray of float64, shape (rows, columns)
        Y, in the picture's unit.
    """
    weights = light.SPACES[source.colour_space].to_xyz[1].astype(source.pixels.dtype)
    return np.asarray(source.pixels[..., :3] @ weights, dtype=np.float64)


def lamp_threshold(source: Picture) -> float:
    """Return the luminance above which a pixel is taken for a light.

    Parameters
    ----------
    source : Picture
        Linear.

    Returns
    -------
    float
        Sixteen times the median of the pixels, but at least a thousandth of the brightest.
    """
    return _level(luminances(source))


def find_lamps(
    source: Picture, threshold: float | None = None, most: int = MOST_LAMPS, connect: int = 1
) -> list[Lamp]:
    """Find the lights that a picture shows.

    Parameters
    ----------
    source : Picture
        Linear, in a space of `light.SPACES`.
    threshold : float, optional
        Luminance above which a pixel belongs to a light; that of `lamp_threshold` without it.
    most : int
        Keep so many, those with most light.
    connect : int
        Regions fewer than so many pixels apart are one light.

    Returns
    -------
    list of Lamp
        The one with most light first.

    Raises
    ------
    refuse.Refusal
        Where a number is out of its range or the picture holds values that are no numbers.
    """
    refuse.all_finite("picture", source.pixels[..., :3])
    seen = luminances(source)
    level = _level(seen) if threshold is None else refuse.positive("threshold", threshold)
    labels = picture.bright_labels(seen, level, connect, MARGIN)
    found = picture.measured_regions(labels, seen, source.pixels[..., :3], above_ground=True)
    count = min(len(found), refuse.at_least("most", most, 1))
    return [_lamp(found, k) for k in range(count)]


def _level(seen: NDArray[np.floating]) -> float:
    return max(OVER_MEDIAN * float(np.median(seen)), OF_BRIGHTEST * float(seen.max()), 0.0)


def _lamp(found: picture.Regions, k: int) -> Lamp:
    flux = float(found.flux[k])
    x, y = (float(part) for part in found.places[k])
    red, green, blue = (float(part) / flux for part in found.colour[k])
    left, top, right, bottom = (int(part) for part in found.boxes[k])
    box = left, top, right, bottom
    return Lamp((x, y), flux, (red, green, blue), float(found.diameters[k]), box, float(found.peaks[k]))
