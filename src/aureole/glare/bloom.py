"""Bloom: glare at a fraction of the picture's resolution, each place weighed by its light (quad paper, §6.3).

Light is gathered into square boxes of pixels, spread from box to box, and brought back by straight lines
between the boxes' middles; every step keeps the light and its place, so that what moves by parts of a pixel
moves smoothly. The core stays sharp, as in "scatter". Boxes smear the glare near small lamps and bright
edges: there light goes from pixel to pixel. What the brightest pixels have above a level does so
near by, what few have above a higher level does so farther off.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.glare import _kernels_bloom
from aureole.glare.kernel import beyond_core, cropped
from aureole.picture.torus import share, thread_count

SIDE = 6  # pixels along a box
# How many pixels far light goes from pixel to pixel, and from how many at most; the brightest go farthest.
TIERS = ((16, 6000), (48, 500))
FEW = 6  # first, the brightest pixels are looked for in so many times fewer boxes than pixels
LANES = 32  # values that a processor takes together, four times over
SHARES = 4  # bands of rows for each thread, so that none waits long for the slowest

Pixels = NDArray[np.float32]
# Rows and columns of pixels, and their light.
Sources = tuple[NDArray[np.int64], NDArray[np.int64], Pixels]


class BloomSpread:
    """A kernel made ready to spread the light of pictures of one size from box to box.

    Parameters
    ----------
    kernel : ndarray of float32, shape (rows, columns, 3)
        Energy per pixel beyond the core, its centre at (rows // 2, columns // 2).
    kept : ndarray of float32, shape (3,)
        What each channel keeps in its own pixel.
    shape : tuple of int
        (rows, columns) of the pictures.
    side : int
        Pixels along a box.
    tiers : sequence of (int, int)
        How far light goes from pixel to pixel, and from how many pixels at most: farther from fewer.
    """

    def __init__(
        self,
        kernel: Pixels,
        kept: NDArray[np.floating],
        shape: tuple[int, int],
        side: int = SIDE,
        tiers: Sequence[tuple[int, int]] = TIERS,
    ) -> None:
        self.side = refuse.at_least("side", side, 2)
        self.boxes = -(-shape[0] // side), -(-shape[1] // side)
        self._kept = np.tile(np.asarray(kept, dtype=np.float32), shape[1])
        near = [_middle(kernel, reach) for reach, _ in tiers]
        self._most = [count for _, count in tiers]
        self._near = [Taps(each) for each in near]
        self._near_boxed = [Taps(boxed_kernel(each, side)) for each in near]
        self._spread = picture.Convolver(boxed_kernel(kernel, side), self.boxes, "single")
        self._lowest = np.float32(0 if float(kernel.min()) >= 0 else -np.inf)
        self.threads = thread_count(None)

    def __call__(self, pixels: NDArray[np.floating]) -> Pixels:
        """Spread the light of one picture.

        Parameters
        ----------
        pixels : ndarray, shape (rows, columns, 3)
            Light.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 3)
            Glare, and what stays.
        """
        light = np.ascontiguousarray(pixels, dtype=np.float32)
        boxes, brightest = self._gathered(light)
        bright = self._bright(light, brightest)
        glare = self._spread_boxes(boxes, bright)
        splats = [near.splats(*sources) for near, sources in zip(self._near, bright, strict=True)]
        wide = np.empty((len(glare), light.shape[1], 3), dtype=np.float32)
        out = np.empty_like(light)

        def widen(first: int, last: int) -> None:
            _kernels_bloom.widen(glare[first:last], self.side, wide[first:last])

        def lay(first: int, last: int) -> None:
            _kernels_bloom.lay(wide, self.side, light, self._kept, first, last, out)
            for splat in splats:
                splat(first, last, out)

        self._by_bands(widen, len(glare))
        self._by_bands(lay, len(light))
        return out

    def _gathered(self, light: Pixels) -> tuple[Pixels, Pixels]:
        """Return light per box, and the brightest value in it."""
        boxes = np.empty((*self.boxes, 3), dtype=np.float32)
        brightest = np.empty(self.boxes, dtype=np.float32)

        def gather(first: int, last: int) -> None:
            _kernels_bloom.gather(light, self.side, first, last, boxes, brightest)

        self._by_bands(gather, len(boxes))
        return boxes, brightest

    def _bright(self, light: Pixels, brightest: Pixels) -> list[Sources]:
        """Return for each tier the brightest pixels' rows and columns, and what they have of its light."""
        if not self._most:
            return []
        level, (rows, columns, colour) = self._picked(light, brightest)
        value = np.maximum(np.maximum(colour[:, 0], colour[:, 1]), colour[:, 2])
        levels = [max(_largest(value, most), level) for most in self._most]
        tiers: list[Sources] = []
        for level, next_level in zip(levels, (*levels[1:], np.float32(np.inf)), strict=True):
            place = np.flatnonzero(value > level)
            # All channels are scaled together, so that the hue stays.
            part = (np.minimum(value[place], next_level) - level) / value[place]
            light_above = np.asarray(colour[place] * part[:, None], dtype=np.float32)
            tiers.append((rows[place], columns[place], light_above))
        return tiers

    def _picked(self, light: Pixels, brightest: Pixels) -> tuple[np.float32, Sources]:
        """Return a level, and all pixels above it: at least as many as go from pixel to pixel."""
        wanted = self._most[0]
        # The brightest pixels mostly lie together in few boxes; each box may have but one of them.
        for boxes in (wanted // FEW, wanted):
            level = max(_largest(brightest.ravel(), max(boxes, 1)), np.float32(0))
            room = int(np.count_nonzero(brightest > level)) * self.side**2
            rows, columns = np.empty(room, dtype=np.int64), np.empty(room, dtype=np.int64)
            colour = np.empty((room, 3), dtype=np.float32)
            count = _kernels_bloom.pick(light, brightest, self.side, level, rows, columns, colour)
            if count > wanted:
                break
        return level, (rows[:count], columns[:count], colour[:count])

    def _spread_boxes(self, boxes: Pixels, bright: list[Sources]) -> Pixels:
        """Return light spread from box to box, without that which goes from pixel to pixel."""
        glare = np.ascontiguousarray(self._spread(boxes), dtype=np.float32)
        for sources, taps in zip(bright, self._near_boxed, strict=True):
            moved = np.zeros_like(boxes)
            _kernels_bloom.share_out(*sources, self.side, moved)
            rows, columns = np.nonzero((moved[..., 0] != 0) | (moved[..., 1] != 0) | (moved[..., 2] != 0))
            splat = taps.splats(rows, columns, -moved[rows, columns])
            self._by_bands(partial(_onto, splat, glare), len(glare))
        if float(boxes.min()) >= 0:
            np.maximum(glare, self._lowest, out=glare)
        return glare

    def _by_bands(self, task: Callable[[int, int], None], rows: int) -> None:
        """Do a task for every band of rows, on all threads."""
        size = -(-rows // (SHARES * self.threads))
        share(lambda first: task(first, min(first + size, rows)), range(0, rows, size), self.threads)


class Taps:
    """A small kernel, ready to be added about many places.

    Parameters
    ----------
    kernel : ndarray of float32, shape (rows, columns, 3)
        Its centre at (rows // 2, columns // 2), rows and columns odd and alike.
    """

    def __init__(self, kernel: Pixels) -> None:
        self._reach = kernel.shape[1] // 2
        along = kernel.reshape(len(kernel), -1)
        self._taps = np.pad(along, ((0, 0), (0, -along.shape[1] % LANES)))

    def splats(self, rows: NDArray[np.int64], columns: NDArray[np.int64], light: Pixels) -> Any:
        """Return what adds the kernel, times the light of each place, to some rows of a picture."""
        times = np.tile(light, (1, -(-self._taps.shape[1] // 3)))
        return partial(_kernels_bloom.splat_rows, rows, columns, times, self._taps, self._reach)


def _onto(splat: Any, out: Pixels, first: int, last: int) -> None:
    splat(first, last, out)


def _middle(kernel: Pixels, reach: int) -> Pixels:
    """Return a kernel's middle, fading to 0 at the reach from half of it on."""
    fading = 1 - beyond_core((kernel.shape[0], kernel.shape[1]), reach / 2)
    return cropped(kernel * fading[..., None], reach - 1)


def _largest(values: Pixels, count: int) -> np.float32:
    """Return the level that so many values reach; the least there is of fewer."""
    return np.float32(np.partition(values, -count)[-count] if len(values) > count else -np.inf)


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
