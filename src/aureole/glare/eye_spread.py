"""Spreading light with a kernel, at the picture's resolution or at half of it.

At half resolution light is gathered into boxes of 2 × 2 pixels, spread with the kernel of those boxes,
and brought back by straight lines between their middles; every step keeps the light and its place. Glare
is smooth but for the few pixels about a small star: there it is laid at full resolution.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.glare import _kernels_splat
from aureole.glare.eye_stars import compact_light
from aureole.glare.kernel import beyond_core

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
    rows, columns = pixels.shape[:2]
    if rows % 2 or columns % 2:
        pixels = np.pad(pixels, ((0, rows % 2), (0, columns % 2), (0, 0)))
    return np.ascontiguousarray(_gathered(_gathered(pixels, 0), 1))


def _gathered(values: NDArray[np.floating], axis: int) -> NDArray[np.float32]:
    """Half as many samples along an axis: the transpose of `_stretched`."""
    moved = np.moveaxis(values, axis, 0)
    first, second = np.float32(0.25) * moved[0::2], np.float32(0.25) * moved[1::2]
    out = 3 * (first + second)
    out[1:] += second[:-1]
    out[:-1] += first[1:]
    out[0] += first[0]
    out[-1] += second[-1]
    return np.asarray(np.moveaxis(out, 0, axis), dtype=np.float32)


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
    wide = _stretched(boxes * np.float32(0.25), 0)[: shape[0]]
    return np.ascontiguousarray(_stretched(wide, 1)[:, : shape[1]])


def _stretched(values: NDArray[np.floating], axis: int) -> NDArray[np.float32]:
    """Twice as many samples along an axis, each a quarter of the way to the next box."""
    moved = np.moveaxis(values, axis, 0)
    out = np.empty((2 * len(moved), *moved.shape[1:]), dtype=np.float32)
    own = np.float32(0.75) * moved
    before, after = np.concatenate([moved[:1], moved[:-1]]), np.concatenate([moved[1:], moved[-1:]])
    out[0::2] = own + np.float32(0.25) * before
    out[1::2] = own + np.float32(0.25) * after
    return np.moveaxis(out, 0, axis)


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
        far = kernel * beyond_core((kernel.shape[0], kernel.shape[1]), NEAR)[..., None]
        self._near = _cropped(kernel - far, int(2 * NEAR))
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
        stars = compact_light(pixels)
        rows, columns = np.nonzero(stars.any(axis=2))
        boxes = self._all(halved(pixels - stars))
        if len(rows):
            boxes += self._far(halved(stars))
        out = doubled(boxes, (pixels.shape[0], pixels.shape[1]))
        _kernels_splat.splat(rows, columns, stars[rows, columns], self._near, out)
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


def _cropped(kernel: NDArray[np.float32], radius: int) -> NDArray[np.float32]:
    """Return the kernel within a radius, its centre where a kernel of that size has it."""
    spans = []
    for length in kernel.shape[:2]:
        before, after = min(radius, length // 2), min(radius, length - 1 - length // 2)
        spans.append(slice(length // 2 - before, length // 2 + after + 1))
    return np.ascontiguousarray(kernel[spans[0], spans[1]])
