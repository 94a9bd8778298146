"""Small stars without flicker: sources of a few pixels, measured whole.

A star one pixel wide that moves by half a pixel lights two pixels half as strongly. Whatever is decided
pixel by pixel then changes from frame to frame, though the star does not. Here a source is measured in a
window that holds all of it wherever it lies, so that its strength stays. The measure has no yes or no:
it falls smoothly to zero as light is spread wider, so nothing pops in or out.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from aureole import refuse


def lumps(strength: NDArray[np.floating], size: int = 1) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the light that stands about each pixel in a lump no wider than a few pixels.

    Parameters
    ----------
    strength : ndarray, shape (rows, columns)
        Luminance, or any other measure of light.
    size : int
        Width of the widest lump in pixels. At any fraction of a pixel it fits a window of 2·size + 1
        pixels about each pixel that it lights.

    Returns
    -------
    whole : ndarray of float32, shape (rows, columns)
        Sum of the window less what it would hold if it were as bright as the brightest pixel of the ring
        around it; zero where that is more.
    ring : ndarray of float32, shape (rows, columns)
        The brightest pixel of the ring: the ground that the lump stands on. What pixels have above it
        adds up to `whole` where the ground is even.

    Raises
    ------
    refuse.Refusal
        Where the size is not at least 1.
    """
    side = 2 * refuse.at_least("size", size, 1) + 1
    light = np.asarray(strength, dtype=np.float64)
    ring = _ring(light, size + 1)
    held = ndimage.uniform_filter(light, side, mode="constant")
    return np.maximum((held - ring) * side**2, 0).astype(np.float32), ring.astype(np.float32)


def compact_light(light: NDArray[np.floating], size: int = 1) -> NDArray[np.float32]:
    """Return the part of a picture's light that belongs to sources of a few pixels.

    Parameters
    ----------
    light : ndarray, shape (rows, columns, 3)
        Light that makes glare.
    size : int
        As in `lumps`.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        All of a star on black, nothing of a surface or an edge, and a part of what lies between.
    """
    strength = np.maximum(light, 0).sum(axis=2)
    whole, ring = lumps(strength, size)
    # Part of the window above its ring, times part of the pixel above it: both fall smoothly to zero.
    held = whole + np.float32((2 * size + 1) ** 2) * ring
    share = whole * np.maximum(strength - ring, 0)
    share /= np.where(share > 0, held * strength, 1)
    return np.asarray(light * share[..., None], dtype=np.float32)


def _ring(light: NDArray[np.float64], distance: int) -> NDArray[np.float64]:
    """Return the greatest value on the square ring at a distance about each pixel; dark outside."""
    side = 2 * distance + 1
    padded = np.pad(light, distance)
    rows, columns = light.shape
    along = ndimage.maximum_filter1d(padded, side, axis=1, mode="constant")[:, distance:-distance]
    down = ndimage.maximum_filter1d(padded, side, axis=0, mode="constant")[distance:-distance]
    level = np.maximum(along[:rows], along[2 * distance :])
    upright = np.maximum(down[:, :columns], down[:, 2 * distance :])
    return np.asarray(np.maximum(level, upright))
