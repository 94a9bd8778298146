"""Compiled loops around the layers: which tiles each primitive touches, and the sweep over tiles.

Tiles of a level are numbered row by row. A list of a tile holds primitives in the order in which they came.
"""

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.flare._kernels_raster import (
    CURVED,
    EDGED,
    FLAT,
    SKIPPED,
    lay_curved,
    lay_edged,
    lay_flat,
    lay_rough,
)

F32 = NDArray[np.float32]
I8 = NDArray[np.int8]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]


@numba.njit(cache=True, nogil=True)
def count(boxes: I32, items: I32, starts: I64, origins: I32, tile: I32, counts: I64) -> None:
    """Count how many primitives of each group touch each of the group's tiles.

    Parameters
    ----------
    boxes : ndarray of int32, shape (P, 4)
        Left, top, right, bottom of each primitive.
    items : ndarray of int32
        Primitives, group by group.
    starts : ndarray of int64, shape (G + 1,)
        Where each group begins.
    origins : ndarray of int32, shape (G, 4)
        Left, top, right, bottom of each group's tiles.
    tile : ndarray of int32, shape (3,)
        A tile's rows and columns, and tiles in a row of a group.
    counts : ndarray of int64, shape (G, tiles)
        Filled.
    """
    counts[:] = 0
    for g in range(len(starts) - 1):
        origin, own = origins[g], counts[g]
        for k in range(starts[g], starts[g + 1]):
            left, top, right, bottom = tiles_of(boxes[items[k]], origin, tile)
            for i in range(top, bottom):
                for j in range(left, right):
                    own[i * tile[2] + j] += 1


@numba.njit(cache=True, nogil=True)
def fill(boxes: I32, items: I32, starts: I64, origins: I32, tile: I32, places: I64, out: I32) -> None:
    """Fill the lists that `count` has counted.

    Parameters
    ----------
    boxes, items, starts, origins, tile
        As in `count`.
    places : ndarray of int64, shape (G, tiles)
        Where each list begins; moved to its end.
    out : ndarray of int32
        Filled.
    """
    for g in range(len(starts) - 1):
        origin, own = origins[g], places[g]
        for k in range(starts[g], starts[g + 1]):
            left, top, right, bottom = tiles_of(boxes[items[k]], origin, tile)
            for i in range(top, bottom):
                for j in range(left, right):
                    out[own[i * tile[2] + j]] = items[k]
                    own[i * tile[2] + j] += 1


@numba.njit(cache=True, nogil=True)
def tiles_of(box: I32, origin: I32, tile: I32) -> tuple[int, int, int, int]:
    """Return the first of a group's tile columns and rows that a box touches, and those behind the last."""
    high, wide = tile[0], tile[1]
    left, top = max(box[0] - origin[0], 0), max(box[1] - origin[1], 0)
    right, bottom = min(box[2], origin[2]) - origin[0], min(box[3], origin[3]) - origin[1]
    return left // wide, top // high, (right + wide - 1) // wide, (bottom + high - 1) // high


@numba.njit(cache=True, nogil=True)
def sweep(
    table: F32,
    boxes: I32,
    kinds: I8,
    corners: F32,
    rays: F32,
    areas: F32,
    passes: I32,
    indices: I32,
    colours: F32,
    iris: F32,
    windows: I32,
    starts: I64,
    items: I32,
    first: int,
    last: int,
    out: F32,
) -> None:
    """Lay each window's primitives, and write the windows into the picture.

    Parameters
    ----------
    table, boxes, kinds, corners, rays, areas
        Of the primitives, from `prepare` or as there.
    passes, indices : ndarray of int32, shape (P,)
        Primitives of one pass are summed before they are coloured; the colour's index.
    colours : ndarray of float32, shape (K, 3)
        Colours.
    iris : ndarray of float32
        As in `lay_curved`.
    windows : ndarray of int32, shape (W, 4)
        Left, top, right, bottom; they do not overlap, left and top are multiples of 8.
    starts : ndarray of int64, shape (W + 1,)
        Where each window's list begins.
    items : ndarray of int32
        The lists.
    first, last : int
        Which windows: up to, not with, the last.
    out : ndarray of float32, shape (rows, columns, 3)
        Filled in the windows.
    """
    found = np.empty(48, np.float32)
    for w in range(first, last):
        window = windows[w]
        high, wide = (window[3] - window[1] + 7) >> 3, (window[2] - window[0] + 7) >> 3
        total, bare = np.zeros((3, high, wide, 64), np.float32), np.zeros((high, wide, 64), np.float32)
        touched = np.array([window[2], window[3], window[0], window[1]], np.int32)
        for k in range(starts[w], starts[w + 1]):
            p = items[k]
            if k > starts[w] and passes[p] != passes[items[k - 1]]:
                add_pass(bare, colours[indices[items[k - 1]]], window, touched, total)
            widen(touched, boxes[p])
            if kinds[p] == FLAT:
                lay_flat(table[p], boxes[p], window, bare)
            elif kinds[p] == EDGED:
                lay_edged(table[p], boxes[p], corners[p], rays[p], iris, window, bare, found)
            elif kinds[p] == CURVED:
                lay_curved(table[p], boxes[p], corners[p], rays[p], areas[p], iris, window, bare, found)
            elif kinds[p] != SKIPPED:
                lay_rough(corners[p], rays[p], areas[p], kinds[p] < 0, iris, window, bare)
        if starts[w + 1] > starts[w]:
            add_pass(bare, colours[indices[items[starts[w + 1] - 1]]], window, touched, total)
        write(total, window, out)


@numba.njit(cache=True, nogil=True)
def widen(touched: I32, box: I32) -> None:
    """Widen a box by another."""
    touched[0], touched[1] = min(touched[0], box[0]), min(touched[1], box[1])
    touched[2], touched[3] = max(touched[2], box[2]), max(touched[3], box[3])


@numba.njit(cache=True, nogil=True, fastmath={"contract"})
def add_pass(bare: F32, colour: F32, window: I32, touched: I32, total: F32) -> None:
    """Add a pass in its colour, and clear what it has touched."""
    left, right = max(touched[0], window[0]) - window[0], min(touched[2], window[2]) - window[0]
    top, bottom = max(touched[1], window[1]) - window[1], min(touched[3], window[3]) - window[1]
    for i in range(top >> 3, (bottom + 7) >> 3):
        for j in range(left >> 3, (right + 7) >> 3):
            pixels = bare[i, j]
            for c in range(3):
                part, sums = colour[c], total[c, i, j]
                for k in range(64):
                    sums[k] += part * pixels[k]
            pixels[:] = np.float32(0)
    touched[0], touched[1], touched[2], touched[3] = window[2], window[3], window[0], window[1]


@numba.njit(cache=True, nogil=True)
def write(total: F32, window: I32, out: F32) -> None:
    """Write a window's blocks into the picture, row by row."""
    for y in range(window[1], window[3]):
        i, m = (y - window[1]) >> 3, ((y >> 2 & 1) << 5) + ((y & 3) << 2)
        for x in range(window[0], window[2]):
            j, k = (x - window[0]) >> 3, m + ((x >> 2 & 1) << 4) + (x & 3)
            for c in range(3):
                out[y, x, c] = total[c, i, j, k]
