"""Spreading light with a kernel, at the picture's resolution or at half of it.

At half resolution light is gathered into boxes of 2 × 2 pixels, spread with the kernel of those boxes,
and brought back by straight lines between their middles; every step keeps the light and its place. It
takes a quarter of the memory. Small stars' near glare is laid at full resolution; that of other bright
surfaces is smeared over the two or three pixels along their edges.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.glare import _kernels_half
from aureole.glare.eye_stars import compact_light
from aureole.glare.kernel import beyond_core, cropped

RESOLUTIONS = ("full", "half")
# Radius in pixels within which a star's glare is laid at full resolution, fading over as much again.
NEAR = 6.0


def halved(pixels: NDArray[np.floating]) -> NDArray[np.float32]:
    """Return light per box of 2 × 2 pixels, by the same straight lines that bring it back.

    Parameters
    ----------
    pixels : ndarray, shape (rows, columns, channels)
        Light per pixel; an odd side is made even by darkness.

    Returns
    -------
    ndarray of float32, shape ((rows + 1) // 2, (columns + 1) // 2, channels)
        Light per box: three quarters of each pixel go to its own box, one to the next beside it, so that
        the middle of the light stays where it is. The sum is the picture's.
    """
    boxes = (pixels.shape[0] + 1) // 2, (pixels.shape[1] + 1) // 2
    out = np.zeros((*boxes, pixels.shape[2]), dtype=np.float32)
    _kernels_half.halve(np.ascontiguousarray(pixels, dtype=np.float32), out)
    return out


def doubled(boxes: NDArray[np.floating], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return light per pixel from light per box, by straight lines between the boxes' middles.

    Parameters
    ----------
    boxes : ndarray, shape (R, C, channels)
        Light per box of 2 × 2 pixels.
    shape : tuple of int
        (rows, columns) of the result, at most twice the boxes'.

    Returns
    -------
    ndarray of float32, shape (rows, columns, channels)
        Its sum is that of the boxes where the shape is twice theirs.
    """
    out = np.empty((*shape, boxes.shape[2]), dtype=np.float32)
    _kernels_half.double(np.ascontiguousarray(boxes, dtype=np.float32), out)
    return out


def halved_kernel(kernel: NDArray[np.floating]) -> NDArray[np.float32]:
    """Return the kernel that takes light from box to box of 2 × 2 pixels.

    Parameters
    ----------
    kernel : ndarray, shape (rows, columns, channels)
        Energy per pixel, its centre at (rows // 2, columns // 2).

    Returns
    -------
    ndarray of float32, shape (R, C, channels)
        Its mean over the four places in the box that the light comes from; R and C are odd, the sum is
        the kernel's.
    """
    return np.asarray(_paired(np.moveaxis(_paired(kernel), 1, 0)).swapaxes(0, 1), dtype=np.float32)


def _paired(kernel: NDArray[np.floating]) -> NDArray[np.floating]:
    """Gather even offsets along the first axis, and odd ones by halves on both sides."""
    centre = len(kernel) // 2
    reach = (max(centre, len(kernel) - 1 - centre) + 1) // 2
    ends = 2 * reach + 1 - centre, 2 * reach + 2 + centre - len(kernel)
    padded = np.pad(kernel, (ends, (0, 0), (0, 0)))
    return np.asarray(padded[1::2] + 0.5 * (padded[0:-1:2] + padded[2::2]))


class HalfSpread:
    """Convolution at half resolution, with the near glare of small stars at full resolution.

    Parameters
    ----------
    kernel : ndarray, shape (rows, columns, 3)
        Energy per pixel, its centre at (rows // 2, columns // 2).
    shape : tuple of int
        (rows, columns) of the pictures.
    precision : str
        As in `aureole.picture.Convolver`.
    """

    def __init__(
        self, kernel: NDArray[np.float32], shape: tuple[int, int], precision: str = "single"
    ) -> None:
        boxes = (shape[0] + 1) // 2, (shape[1] + 1) // 2
        self._boxes = boxes
        far = kernel * beyond_core((kernel.shape[0], kernel.shape[1]), NEAR)[..., None]
        self._near = cropped(kernel - far, int(2 * NEAR))
        self._all = picture.Convolver(halved_kernel(kernel), boxes, precision)
        self._far = picture.Convolver(halved_kernel(far), boxes, precision)

    def __call__(self, pixels: NDArray[np.float32]) -> NDArray[np.float32]:
        """Spread the light of one picture.

        Parameters
        ----------
        pixels : ndarray of float32, shape (rows, columns, 3)
            Light that makes glare.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 3)
            The glare.
        """
        rows, columns, light = compact_light(pixels)
        if not len(rows):
            return doubled(self._all(halved(pixels)), (pixels.shape[0], pixels.shape[1]))
        rest = pixels.copy()
        rest[rows, columns] -= light
        boxes = self._all(halved(rest)) + self._far(_halved_few(rows, columns, light, self._boxes))
        out = doubled(boxes, (pixels.shape[0], pixels.shape[1]))
        _kernels_half.splat(rows, columns, light, self._near, out)
        return out


def _halved_few(
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    light: NDArray[np.float32],
    boxes: tuple[int, int],
) -> NDArray[np.float32]:
    """Return light per box of a few pixels on black, as `halved` has it."""
    out = np.zeros((*boxes, 3), dtype=np.float32)
    places = [
        [(at // 2, 0.75), (np.clip(at // 2 + 2 * (at % 2) - 1, 0, n - 1), 0.25)]
        for at, n in zip((rows, columns), boxes, strict=True)
    ]
    for row, down in places[0]:
        for column, across in places[1]:
            np.add.at(out, (row, column), np.float32(down * across) * light)
    return out


def spreader(kernel: NDArray[np.float32], shape: tuple[int, int], resolution: str, precision: str) -> Any:
    """Make a kernel ready to spread the light of many pictures.

    Parameters
    ----------
    kernel : ndarray of float32, shape (rows, columns, 3)
        Energy per pixel, its centre at (rows // 2, columns // 2).
    shape : tuple of int
        (rows, columns) of the pictures.
    resolution : str
        "full" or "half".
    precision : str
        As in `aureole.picture.Convolver`.

    Returns
    -------
    callable
        Takes light (rows, columns, 3) to glare of that shape.

    Raises
    ------
    refuse.Refusal
        Where the resolution is unknown.
    """
    if refuse.one_of("resolution", resolution, RESOLUTIONS) == "half":
        return HalfSpread(kernel, shape, precision)
    return picture.Convolver(kernel, shape, precision)
