"""A mask as few signed rectangles: the quadtree of the quad paper, §4.2.

Scandolo, Lee, Eisemann, "Quad-based Fourier transform for efficient diffraction synthesis", 2018.
The tree is built from the pixels up. Four equal children merge. One lit child of four is listed and
dark goes up; two adjacent ones are listed as one 2:1 rectangle; of three lit ones, lit goes up and a
negative quad covers the dark one. Grey masks follow the same rule with weights: the value that goes
up is the one that leaves the fewest rectangles to list, the darkest of such values where they tie.

Merging across levels is what the paper leaves for later (§7): rectangles of equal weight that share a
whole side become one, whichever levels they come from. At 1024² this takes a quarter to a third of the
quads off a binary shape and a twentieth to an eighth off an anti-aliased one; the distinct intervals
stay, and with them the time of `quads` (benchmarks/quadtree.py).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.diffraction import _kernels_quadtree

# Pixels of the mask that one pixel of the finest level stands for, along each axis.
FINEST = {"full": 1, "half": 2, "quarter": 4, "eighth": 8}


@dataclass(frozen=True, eq=False)
class Quads:
    """Axis-aligned rectangles whose weights add up to a mask.

    Parameters
    ----------
    rectangles : ndarray of float64, shape (N, 4)
        x0, y0, x1, y1 in metres.
    weights : ndarray of float64, shape (N,)
        Signed amplitude of each.
    """

    rectangles: NDArray[np.float64]
    weights: NDArray[np.float64]

    def __len__(self) -> int:
        """Return the number of rectangles."""
        return len(self.weights)


def quadtree(mask: ArrayLike, width: float, finest: str = "full", merge: bool = False) -> Quads:
    """Break a mask into signed rectangles (quad paper §4.2).

    Parameters
    ----------
    mask : array_like, shape (n, n)
        Amplitude transmittance of the pixels, row 0 on top.
    width : float
        Side of the whole mask, metres.
    finest : str
        "full", or "half", "quarter" or "eighth" to start from a mask averaged over squares of 2, 4 or
        8 pixels.
    merge : bool
        Whether to merge rectangles across levels, which takes as long again as the tree.

    Returns
    -------
    Quads
        Painting them with `paint` gives back the mask of the finest level exactly.

    Raises
    ------
    refuse.Refusal
        Where the mask is not square, not finite, or too small for the level.
    """
    level = level_mask(mask, finest)
    size = len(level)
    pixel = refuse.positive("width", width) / size
    # Dark pixels fill the square up to a power of two, below and to the right.
    side = 1 << (size - 1).bit_length()
    values = level
    if side > size:
        values = np.zeros((side, side))
        values[:size, :size] = level
    listed = []
    step = 1
    while len(values) > 1:
        values, found = _kernels_quadtree.merge_level(values)
        found[:, :4] *= step
        listed.append(found)
        step *= 2
    if values[0, 0] != 0:
        listed.append(np.array([[0.0, 0.0, side, side, values[0, 0]]]))
    quads = np.concatenate(listed) if listed else np.zeros((0, 5))
    boxes, weights = quads[:, :4].astype(np.int64), np.ascontiguousarray(quads[:, 4])
    if merge:
        boxes, weights = _merged(boxes, weights)
    return Quads(boxes.astype(np.float64) * pixel - width / 2, weights)


def _merged(
    boxes: NDArray[np.int64], weights: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Merge along x and along y in turn until nothing merges any more."""
    before = len(weights) + 1
    while len(weights) < before:
        before = len(weights)
        for axis in (0, 1):
            boxes, weights = _merged_along(boxes, weights, axis)
    return boxes, weights


def _merged_along(
    boxes: NDArray[np.int64], weights: NDArray[np.float64], axis: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Merge the rectangles of one magnitude and the same ends along the other axis.

    Such rectangles are steps up and down at their ends. Where one ends another may begin: both steps
    cancel. What is left is paired again, the first step up with the first one down, so that there are
    never more rectangles than before.
    """
    side = int(boxes.max(initial=0)) + 1
    magnitudes, which = np.unique(np.abs(weights), return_inverse=True)
    low, high = boxes[:, axis], boxes[:, axis + 2]
    across = (boxes[:, 1 - axis] * side + boxes[:, 3 - axis]) * len(magnitudes) + which.ravel()
    groups, group = np.unique(across, return_inverse=True)
    keys = np.concatenate([group.ravel() * side + low, group.ravel() * side + high])
    rises = np.sign(weights).astype(np.int64)
    found, place = np.unique(keys, return_inverse=True)
    net = np.rint(np.bincount(place.ravel(), np.concatenate([rises, -rises]))).astype(np.int64)
    up, down = np.repeat(found, np.maximum(net, 0)), np.repeat(found, np.maximum(-net, 0))
    ends = np.stack([np.minimum(up, down) % side, np.maximum(up, down) % side])
    across, size = groups[up // side], len(magnitudes)
    others = np.stack([across // size // side, across // size % side])
    merged = np.empty((len(up), 4), dtype=np.int64)
    merged[:, [axis, axis + 2]], merged[:, [1 - axis, 3 - axis]] = ends.T, others.T
    return merged, np.where(up < down, 1.0, -1.0) * magnitudes[across % size]


def difference_quads(
    difference: ArrayLike, width: float, finest: str = "full", merge: bool = True
) -> tuple[Quads, Quads]:
    """Break the difference of two masks into rectangles to add and rectangles to take away.

    Both parts are extracted on their own (quad paper §4.3, Fig. 3).

    Parameters
    ----------
    difference : array_like, shape (n, n)
        The later mask less the earlier one.
    width : float
        Side of the masks, metres.
    finest : str
        As in `quadtree`.
    merge : bool
        As in `quadtree`.

    Returns
    -------
    tuple of Quads
        Of what the change opens, and of what it covers; the weights of the latter are those of its
        absolute value.

    Raises
    ------
    refuse.Refusal
        As in `quadtree`.
    """
    change = np.asarray(difference)
    opened, covered = np.maximum(change, 0), np.maximum(-change, 0)
    return quadtree(opened, width, finest, merge), quadtree(covered, width, finest, merge)


def level_mask(mask: ArrayLike, finest: str = "full") -> NDArray[np.float64]:
    """Return the mask that a quadtree of a finest level stands for.

    Parameters
    ----------
    mask : array_like, shape (n, n)
        Amplitude transmittance.
    finest : str
        "full", "half", "quarter" or "eighth".

    Returns
    -------
    ndarray of float64, shape (n / k, n / k)
        Means over squares of k = 1, 2, 4 or 8 pixels.

    Raises
    ------
    refuse.Refusal
        Where the mask is not square and finite, or its size is not a multiple of k.
    """
    step = FINEST[refuse.one_of("finest", finest, FINEST)]
    values = refuse.all_finite("mask", refuse.shape_of("mask", mask, (None, None))).astype(np.float64)
    rows, columns = values.shape
    if rows != columns or rows % step:
        wanted = "square" if step == 1 else f"square, its side a multiple of {step} for '{finest}'"
        raise refuse.Refusal(f"'mask' must be {wanted}, got {rows} x {columns} pixels.")
    if step == 1:
        return values
    blocks = values.reshape(rows // step, step, columns // step, step)
    return np.asarray(blocks.mean(axis=(1, 3)))


def paint(quads: Quads, size: int, width: float) -> NDArray[np.float64]:
    """Add up signed rectangles on a pixel grid that their edges lie on.

    Parameters
    ----------
    quads : Quads
        Rectangles in metres on the square [−width/2, width/2]².
    size : int
        Pixels on each side of the square.
    width : float
        Side of the square, metres.

    Returns
    -------
    ndarray of float64, shape (size, size)
        The mask.
    """
    edges = np.rint((quads.rectangles + width / 2) * (size / width)).astype(int)
    side = max(size, int(edges.max(initial=0)))
    # Each rectangle is four corner steps, summed along both axes at the end.
    corners = np.zeros((side + 1, side + 1))
    x0, y0, x1, y1 = edges.T
    for rows, columns, sign in ((y0, x0, 1), (y0, x1, -1), (y1, x0, -1), (y1, x1, 1)):
        np.add.at(corners, (rows, columns), sign * quads.weights)
    return corners.cumsum(axis=0).cumsum(axis=1)[:size, :size]
