"""Which light of a picture is that of its lamps: a matte, soft at the threshold so that nothing pops.

A pixel's light counts from the threshold on and in full from twice that: a lamp that fades, or passes behind
something, loses its glare as smoothly as its light.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from aureole import picture, refuse
from aureole.glare.lamps import MARGIN, Lamp, lamp_threshold, luminances
from aureole.records import Picture

# A pixel is all lamp from so many times the threshold on.
FULL = 2.0
# A lamp without a box is looked for so far from its place, in pictures' widths, and in pixels at least; what
# belongs to it is so bright beside its brightest pixel.
SEARCH, SEARCH_LEAST = 0.02, 2
EDGE = 0.1
# Boxes are the same lamp's where they have so much of their area in common.
ALIKE = 0.3


def lamp_matte(
    source: Picture,
    threshold: float | None = None,
    lamps: Sequence[Lamp] | None = None,
    connect: int = 1,
) -> NDArray[np.float32]:
    """Return how much of each pixel's light is that of lamps.

    Parameters
    ----------
    source : Picture
        Linear, in a space of `light.SPACES`.
    threshold : float, optional
        Luminance from which on light counts; that of `lamp_threshold` without it.
    lamps : sequence of Lamp, optional
        Only these, by their places on the picture's pixels; all pixels above the threshold without it. A
        lamp's pixels are those of the region whose box is most like its own; of one without a box, the
        region of the brightest pixel about its place, from a tenth of that one's luminance on.
    connect : int
        As the lamps were found with.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        0..1.

    Raises
    ------
    refuse.Refusal
        Where a number is out of its range.
    """
    level = lamp_threshold(source) if threshold is None else refuse.positive("threshold", threshold)
    seen = luminances(source)
    matte = np.zeros(seen.shape, dtype=np.float32)
    if level == 0:
        # A black picture has no threshold, and no lamps.
        return matte
    if lamps is None:
        return _soft(seen, level)
    boxed = [lamp for lamp in lamps if _area(lamp.box) > 0]
    if boxed:
        labels = picture.bright_labels(seen, level, connect, MARGIN)
        matte = np.where(np.isin(labels, _regions_of(boxed, labels)), _soft(seen, level), matte)
    for lamp in lamps:
        if _area(lamp.box) == 0:
            lit, brightest = lit_about(seen, lamp.place, lamp.size / 2)
            # Where nothing is as bright as a lamp, the lamp is hidden.
            lit = lit & (brightest > level)
            matte = np.maximum(matte, np.where(lit, _soft(seen, max(level, EDGE * brightest)), 0))
    return np.asarray(matte, dtype=np.float32)


def lit_about(
    seen: NDArray[np.floating], place: tuple[float, float], radius: float = 0.0
) -> tuple[NDArray[np.bool_], float]:
    """Return the pixels of the light that stands about a place.

    Parameters
    ----------
    seen : ndarray, shape (rows, columns)
        Luminance.
    place : tuple of float
        (x, y) in pixels from the upper left corner.
    radius : float
        Pixels from the place within which the light's brightest pixel lies; a fiftieth of the width where
        that is more.

    Returns
    -------
    lit : ndarray of bool, shape (rows, columns)
        The brightest pixel near the place, and those joined to it that are a tenth as bright.
    brightest : float
        Its luminance; 0 where there is none near.
    """
    reach = max(math.ceil(SEARCH * seen.shape[1]), math.ceil(radius), SEARCH_LEAST)
    x, y = math.floor(place[0]), math.floor(place[1])
    top, left = max(y - reach, 0), max(x - reach, 0)
    near = seen[top : max(y + reach + 1, 0), left : max(x + reach + 1, 0)]
    brightest = float(near.max(initial=0.0))
    if brightest <= 0:
        return np.zeros(seen.shape, dtype=bool), 0.0
    row, column = np.unravel_index(np.argmax(near), near.shape)
    labels = picture.bright_labels(seen, EDGE * brightest)
    return labels == labels[top + row, left + column], brightest


def _soft(seen: NDArray[np.floating], level: float) -> NDArray[np.float32]:
    """Return 0 up to the threshold and 1 from `FULL` times that on; light grows evenly between."""
    share = (1.0 - level / np.maximum(seen, level)) * (FULL / (FULL - 1.0))
    return np.asarray(np.minimum(share, 1.0), dtype=np.float32)


def _regions_of(lamps: Sequence[Lamp], labels: NDArray[np.integer]) -> list[int]:
    """Return the number of each lamp's region; a lamp that is not to be seen has none."""
    found = [
        (number, (box[1].start, box[0].start, box[1].stop, box[0].stop))
        for number, box in enumerate(ndimage.find_objects(labels), 1)
        if box is not None
    ]
    if not found:
        return []
    boxes = np.array([box for _, box in found])
    chosen = []
    for lamp in lamps:
        common = _common(np.array(lamp.box), boxes)
        areas = np.prod(boxes[:, 2:] - boxes[:, :2], axis=1) + _area(lamp.box) - common
        best = int(np.argmax(common / areas))
        if common[best] >= ALIKE * areas[best]:
            chosen.append(found[best][0])
    return chosen


def _common(box: NDArray[np.intp], others: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the area that a box shares with each of others."""
    sides = np.minimum(box[2:], others[:, 2:]) - np.maximum(box[:2], others[:, :2])
    return np.asarray(np.prod(np.maximum(sides, 0), axis=1))


def _area(box: tuple[int, int, int, int]) -> int:
    return (box[2] - box[0]) * (box[3] - box[1])
