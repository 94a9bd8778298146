"""Small stars without flicker: sources of a few pixels, measured whole.

A star one pixel wide that moves by half a pixel lights two pixels half as strongly. Whatever is decided
pixel by pixel then changes from frame to frame, though the star does not. Here a source is measured in a
window that holds all of it wherever it lies, so that its strength stays. The measure has no yes or no:
it falls smoothly to zero as light is spread wider, so nothing pops in or out.
"""

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.glare import _kernels_half


def lumps(strength: NDArray[np.floating], size: int = 1) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the light that stands about each pixel in a lump no wider than a few pixels.

    Parameters
    ----------
    strength : ndarray, shape (rows, columns)
        Luminance, or any other measure of light.
    size : int
        Width in pixels of the lumps that are sought. At any fraction of a pixel such a lump fits a square
        of size + 1 pixels.

    Returns
    -------
    whole : ndarray of float32, shape (rows, columns)
        What the densest such square that holds the pixel has above its ground, less what the pixels about
        the square have; zero where that is more, and for pixels that are not above their ground.
    ring : ndarray of float32, shape (rows, columns)
        The ground: the brightest pixel of the square ring at size + 1 pixels about the pixel; zero where
        there is no lump.

    Raises
    ------
    refuse.Refusal
        Where the size is not at least 1.
    """
    refuse.at_least("size", size, 1)
    light = np.ascontiguousarray(strength, dtype=np.float32)
    whole, ring = np.zeros_like(light), np.zeros_like(light)
    _kernels_half.lumps(light, size, whole, ring)
    return whole, ring


def compact_light(
    light: NDArray[np.floating], size: int = 1
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float32]]:
    """Return the part of a picture's light that belongs to sources of a few pixels.

    Parameters
    ----------
    light : ndarray, shape (rows, columns, 3)
        Light that makes glare.
    size : int
        As in `lumps`.

    Returns
    -------
    rows, columns : ndarray of int64, shape (N,)
        The pixels that have such light.
    compact : ndarray of float32, shape (N, 3)
        Theirs: all of a star on black, nothing of a surface or an edge, a part of what lies between.

    Raises
    ------
    refuse.Refusal
        Where the size is not at least 1.
    """
    strength = np.maximum(light[..., 0] + light[..., 1] + light[..., 2], 0)
    whole, ring = lumps(strength, size)
    rows, columns = np.nonzero(whole)
    lump, ground, own = whole[rows, columns], ring[rows, columns], strength[rows, columns]
    # Part of the window above its ring, times part of the pixel above it: both fall smoothly to zero.
    share = lump / (lump + np.float32((2 * size + 1) ** 2) * ground) * ((own - ground) / own)
    return rows, columns, np.asarray(light[rows, columns] * share[:, None], dtype=np.float32)
