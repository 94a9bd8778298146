"""Bright regions of a picture: which pixels belong together, and what their light measures.

Light may be counted above the ground on which a region lies, so that a region which falls below the threshold
has faded to nothing before it goes, and no pixel makes a jump as it joins.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from aureole import refuse

# Variance of light that is spread evenly over a pixel, in pixels squared, along each axis.
PIXEL_VARIANCE = 1.0 / 12.0


@dataclass(frozen=True, eq=False)
class Regions:
    """Regions of a picture, the one with most light first.

    Parameters
    ----------
    labels : ndarray of int, shape (rows, columns)
        Region k has the pixels with k + 1; 0 is none.
    flux : ndarray of float64, shape (N,)
        Sum of the strength of each region's pixels.
    colour : ndarray of float64, shape (N, C)
        Sum of the channels.
    places : ndarray of float64, shape (N, 2)
        Centre of strength, (x, y) in pixels from the upper left corner; a pixel's centre lies at its half.
    diameters : ndarray of float64, shape (N,)
        Pixels across the even disc whose light is as spread out; 0 for a single pixel.
    boxes : ndarray of int, shape (N, 4)
        Left, top, right and bottom: the first pixel and the one after the last.
    areas : ndarray of int, shape (N,)
        Number of pixels.
    peaks : ndarray of float64, shape (N,)
        Strength of the brightest pixel.
    """

    labels: NDArray[np.integer]
    flux: NDArray[np.float64]
    colour: NDArray[np.float64]
    places: NDArray[np.float64]
    diameters: NDArray[np.float64]
    boxes: NDArray[np.integer]
    areas: NDArray[np.integer]
    peaks: NDArray[np.float64]

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.flux)


def bright_labels(
    strength: NDArray[np.floating], threshold: float, connect: int = 1, margin: int = 0
) -> NDArray[np.integer]:
    """Number the connected regions that are brighter than a threshold.

    Parameters
    ----------
    strength : ndarray, shape (rows, columns)
        Luminance, or any other measure of light.
    threshold : float
        Pixels above it belong to a region.
    connect : int
        Regions fewer than so many pixels apart, corners counted, are one.
    margin : int
        So many pixels about each region belong to it, too, where they belong to no other: those that the
        light's edge covers in part.

    Returns
    -------
    ndarray of int, shape (rows, columns)
        0 outside, from 1 inside.

    Raises
    ------
    refuse.Refusal
        Where a number is out of its range.
    """
    bright = strength > refuse.finite("threshold", threshold)
    near = bright
    if refuse.at_least("connect", connect, 1) > 1:
        near = ndimage.binary_dilation(bright, np.ones((3, 3), dtype=bool), iterations=connect // 2)
    labels: NDArray[np.integer]
    labels, _ = ndimage.label(near, structure=np.ones((3, 3), dtype=int))
    if connect > 1:
        labels[~bright] = 0
    for _ in range(refuse.at_least("margin", margin, 0)):
        labels = labels + _ring(labels)
    return labels


def measured_regions(
    labels: NDArray[np.integer],
    strength: NDArray[np.floating],
    colour: NDArray[np.floating] | None = None,
    above_ground: bool = False,
) -> Regions:
    """Measure regions.

    Parameters
    ----------
    labels : ndarray of int, shape (rows, columns)
        As `bright_labels` returns them.
    strength : ndarray, shape (rows, columns)
        What each pixel weighs.
    colour : ndarray, shape (rows, columns, C), optional
        Channels to be summed; the strength alone without it.
    above_ground : bool
        Count strength and channels above the mean of the pixels that touch the region and belong to none;
        regions that have no light above it are left out.

    Returns
    -------
    Regions
        The one with most light first.
    """
    channels = strength[..., None] if colour is None else colour
    rows, columns = _pixels_of(labels)
    count = int(labels.max(initial=0))
    which = labels[rows, columns] - 1
    own = strength[rows, columns].astype(np.float64)
    hues = channels[rows, columns].astype(np.float64)
    peaks = np.full(count, -np.inf)
    np.maximum.at(peaks, which, own)
    if above_ground:
        around = _ring(labels)
        edge = _pixels_of(around)
        own -= _means(around[edge] - 1, strength[edge][:, None], count)[which, 0]
        hues -= _means(around[edge] - 1, channels[edge], count)[which]
    flux = np.asarray(np.bincount(which, own, count), dtype=np.float64)
    areas = np.bincount(which, minlength=count)
    order = np.argsort(-flux, kind="stable")
    order = order[(areas[order] > 0) & ((flux[order] > 0) | (not above_ground))]
    boxes = _boxes(which, rows, columns, count)[order]
    centres, spread = _moments(which, own, np.stack([columns, rows], axis=1).astype(np.float64) + 0.5, count)
    renumbered = np.zeros(count + 1, dtype=labels.dtype)
    renumbered[order + 1] = np.arange(1, len(order) + 1)
    diameters = 4.0 * np.sqrt(np.maximum(spread[order] - PIXEL_VARIANCE, 0.0))
    # Light that is taken away at a region's edge may push the centre out, where it cannot be.
    places = np.clip(centres[order], boxes[:, :2], boxes[:, 2:])
    light = _sums(which, hues, count)[order]
    numbers = np.zeros_like(labels)
    numbers[rows, columns] = renumbered[labels[rows, columns]]
    return Regions(numbers, flux[order], light, places, diameters, boxes, areas[order], peaks[order])


def _ring(labels: NDArray[np.integer]) -> NDArray[np.integer]:
    """Number the pixels that touch a region and belong to none; the higher number where two are near."""
    beside = labels.copy()
    np.maximum(beside[:, 1:], labels[:, :-1], out=beside[:, 1:])
    np.maximum(beside[:, :-1], labels[:, 1:], out=beside[:, :-1])
    grown = beside.copy()
    np.maximum(grown[1:], beside[:-1], out=grown[1:])
    np.maximum(grown[:-1], beside[1:], out=grown[:-1])
    grown[labels != 0] = 0
    return grown


def _sums(which: NDArray[np.integer], values: NDArray[np.floating], count: int) -> NDArray[np.float64]:
    sums = [np.bincount(which, values[:, channel], count) for channel in range(values.shape[1])]
    return np.stack(sums, axis=1)


def _means(which: NDArray[np.integer], values: NDArray[np.floating], count: int) -> NDArray[np.float64]:
    counts = np.maximum(np.bincount(which, minlength=count), 1)
    return np.asarray(_sums(which, values, count) / counts[:, None])


def _pixels_of(labels: NDArray[np.integer]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return rows and columns of the pixels that belong to a region."""
    rows, columns = np.divmod(np.flatnonzero(labels.ravel() != 0), labels.shape[1])
    return rows, columns


def _boxes(
    which: NDArray[np.integer], rows: NDArray[np.integer], columns: NDArray[np.integer], count: int
) -> NDArray[np.integer]:
    """Return left, top, right and bottom of each region."""
    boxes = np.zeros((count, 4), dtype=np.intp)
    boxes[:, :2] = np.iinfo(np.intp).max
    for first, last, places in ((0, 2, columns), (1, 3, rows)):
        np.minimum.at(boxes[:, first], which, places)
        np.maximum.at(boxes[:, last], which, places + 1)
    return boxes


def _moments(
    which: NDArray[np.integer], weights: NDArray[np.float64], points: NDArray[np.float64], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return each region's centre (N, 2), and its variance along an axis, the mean of both (N,)."""
    total = np.bincount(which, weights, count)
    total = np.where(total > 0, total, np.inf)
    centres = _sums(which, points * weights[:, None], count) / total[:, None]
    apart = ((points - centres[which]) ** 2).sum(axis=1)
    return centres, np.bincount(which, apart * weights, count) / total / 2.0
