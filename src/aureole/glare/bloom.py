"""Bloom: glare at a fraction of the picture's resolution, each place weighed by its light (quad paper, §6.3).

Light is gathered into square boxes of pixels, spread from box to box, and brought back by straight lines
between the boxes' middles; every step keeps the light and its place, so that what moves by parts of a pixel
moves smoothly. The core stays sharp, as in "scatter". Where the picture is rough (small lamps, edges of
bright surfaces) boxes smear the glare near by: there, what the roughest pixels have above their
boxes' light is spread at full resolution, as far as the kernel is steep.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.glare import _kernels_bloom, _kernels_half
from aureole.glare.kernel import beyond_core, cropped
from aureole.picture.torus import share, thread_count

SIDE = 4  # pixels along a box
NEAR = 12  # pixels about a rough one that get its own glare
ROUGH_BOXES = 512  # so many boxes at most have pixels that are spread by themselves
BAND = 16  # rows of boxes that a thread takes at a time


class BloomSpread:
    """A kernel made ready to spread the light of pictures of one size from box to box.

    Parameters
    ----------
    kernel : ndarray of float32, shape (rows, columns, 3)
        Energy per pixel beyond the core, its centre at (rows // 2, columns // 2).
    shape : tuple of int
        (rows, columns) of the pictures.
    precision : str
        As in `aureole.picture.Convolver`.
    side : int
        Pixels along a box.
    """

    def __init__(
        self, kernel: NDArray[np.float32], shape: tuple[int, int], precision: str = "single", side: int = SIDE
    ) -> None:
        self.side = refuse.at_least("side", side, 2)
        self.boxes = -(-shape[0] // side), -(-shape[1] // side)
        near = kernel * (1 - beyond_core((kernel.shape[0], kernel.shape[1]), NEAR / 2)[..., None])
        self._near = cropped(near, NEAR)
        self._near_boxed = boxed_kernel(self._near, side)
        self._spread = picture.Convolver(boxed_kernel(kernel, side), self.boxes, precision)
        self._lowest = np.float32(0 if float(kernel.min()) >= 0 else -np.inf)
        self._threads = thread_count(None)

    def __call__(self, pixels: NDArray[np.floating], kept: NDArray[np.float32]) -> NDArray[np.float32]:
        """Spread the light of one picture, and add what stays.

        Parameters
        ----------
        pixels : ndarray, shape (rows, columns, 3)
            Light.
        kept : ndarray of float32, shape (3,)
            What each channel keeps in its own pixel.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 3)
            Glare and what stays.
        """
        light = np.ascontiguousarray(pixels, dtype=np.float32)
        boxes = self._gathered(light)
        out = np.zeros_like(light)
        glare = np.ascontiguousarray(self._spread(boxes), dtype=np.float32)
        self._spread_rough(light, boxes, out, glare)
        lowest = self._lowest if float(boxes.min()) >= 0 else np.float32(-np.inf)
        side = self.side

        def lay(first: int) -> None:
            rows = first * side, min((first + BAND) * side, len(light))
            _kernels_bloom.lay(glare, side, light, kept, lowest, *rows, out)

        share(lay, range(0, self.boxes[0], BAND), self._threads)
        return out

    def _gathered(self, light: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return light per box."""
        boxes = np.empty((*self.boxes, 3), dtype=np.float32)

        def gather(first: int) -> None:
            _kernels_bloom.gather(light, self.side, first, min(first + BAND, len(boxes)), boxes)

        share(gather, range(0, len(boxes), BAND), self._threads)
        return boxes

    def _spread_rough(
        self, light: NDArray[np.float32], boxes: NDArray[Any], out: NDArray[Any], glare: NDArray[Any]
    ) -> None:
        """Spread what the roughest pixels have above the boxes' light near by, and not from box to box."""
        most = boxes.max(axis=2)
        rank = max(most.size - 16 * ROUGH_BOXES, 0)
        least = np.float32(np.partition(most, rank, axis=None)[rank] if rank else 0)
        rough = np.zeros(self.boxes, dtype=np.float32)

        def measure(first: int) -> None:
            last = min(first + BAND, len(rough))
            _kernels_bloom.roughness(light, boxes, self.side, least, first, last, rough)

        share(measure, range(0, len(rough), BAND), self._threads)
        rank = max(rough.size - ROUGH_BOXES, 0)
        level = np.float32(np.partition(rough, rank, axis=None)[rank] if rank else 0)
        moved = np.zeros_like(boxes)
        _kernels_bloom.splat_rough(light, boxes, self.side, rough, level, self._near, out, moved)
        rows, columns = np.nonzero(moved.any(axis=2))
        _kernels_half.splat(rows, columns, -moved[rows, columns], self._near_boxed, glare)


def boxed_kernel(kernel: NDArray[np.floating], side: int) -> NDArray[np.float32]:
    """Return the kernel that takes light from box to box.

    Parameters
    ----------
    kernel : ndarray, shape (rows, columns, channels)
        Energy per pixel, its centre at (rows // 2, columns // 2).
    side : int
        Pixels along a box.

    Returns
    -------
    ndarray of float32, shape (R, C, channels)
        Its mean over the places in the box that the light comes from; R and C are odd, the sum is the
        kernel's.
    """
    down = _gathered_along(kernel, side)
    return np.asarray(_gathered_along(np.moveaxis(down, 1, 0), side).swapaxes(0, 1), dtype=np.float32)


def _gathered_along(kernel: NDArray[np.floating], side: int) -> NDArray[np.floating]:
    """Share out offsets along the first axis between the two multiples of the side that they lie between."""
    centre = len(kernel) // 2
    reach = -(-max(centre, len(kernel) - 1 - centre) // side)
    # Offset d stands at index d + (reach + 1) side.
    ends = (reach + 1) * side - centre, (reach + 1) * side - (len(kernel) - 1 - centre)
    padded = np.pad(kernel, (ends, (0, 0), (0, 0)))
    count = 2 * reach + 1
    total = padded[side::side][:count].astype(np.float32)
    for d in range(1, side):
        weight = np.float32(1 - d / side)
        total += weight * (padded[side - d :: side][:count] + padded[side + d :: side][:count])
    return total
