"""Small pictures of many, side by side on one sheet."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Tiles: longest side, pixels between two, and how many stand in a row.
TILE, GAP, TILES_ABREAST = 160, 4, 8


def tile(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return a picture made small, each pixel the mean of those it stands for.

    Parameters
    ----------
    pixels : ndarray of float32, shape (rows, columns, channels)
        Of any size.

    Returns
    -------
    ndarray of float32
        Its longer side is at most a tile's.
    """
    counts = [min(side, max(1, round(side * TILE / max(pixels.shape[:2])))) for side in pixels.shape[:2]]
    small: NDArray[Any] = pixels.astype(np.float64)
    for axis, count in enumerate(counts):
        side = pixels.shape[axis]
        starts = np.arange(count) * side // count
        parts = np.diff(np.append(starts, side)).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
        small = np.add.reduceat(small, starts, axis=axis) / parts
    return small.astype(np.float32)


def sheet(tiles: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Lay tiles of one size side by side, row under row, black between them.

    Parameters
    ----------
    tiles : sequence of ndarray, shape (rows, columns, 3)
        At least one.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        The sheet.
    """
    rows, columns = tiles[0].shape[:2]
    abreast = min(len(tiles), TILES_ABREAST)
    deep = math.ceil(len(tiles) / abreast)
    whole = np.zeros((deep * (rows + GAP) - GAP, abreast * (columns + GAP) - GAP, 3), dtype=np.float32)
    for index, one in enumerate(tiles):
        top, left = (index // abreast) * (rows + GAP), (index % abreast) * (columns + GAP)
        whole[top : top + rows, left : left + columns] = one
    return whole
