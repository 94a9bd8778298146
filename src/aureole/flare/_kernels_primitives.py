"""Compiled loops from a sheet of rays to primitives: which cells stay, and the corners of their blocks.

A block is named by its first cell; `sizes` holds the exponent of its size there, -1 where nothing begins.
"""

from typing import Any, TypeAlias

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
I8 = NDArray[np.int8]
Flags = NDArray[np.bool_]
Rays: TypeAlias = tuple[F32, F32, F32, F32]
ZERO: Any = np.float32(0)
QUARTER: Any = np.float32(0.25)
HALF: Any = np.float32(0.5)
ONE: Any = np.float32(1)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def mark(
    sensor: tuple[F32, F32],
    rays: Rays,
    reached: Flags,
    frame: F32,
    limits: tuple[float, bool, bool],
    x: F32,
    y: F32,
    sizes: I8,
    whole: Flags,
) -> None:
    """Turn rays into pixels, and mark the cells that stay and those among them that may merge.

    Parameters
    ----------
    sensor : tuple of ndarray of float32, each of shape (W, rows, columns)
        x and y on the sensor, metres.
    rays : tuple of ndarray of float32, each of shape (W, rows, columns)
        Weight, level, stop_x and stop_y as a sheet's.
    reached : ndarray of bool, shape (W, rows, columns)
        Whether a ray reached the sensor.
    frame : ndarray of float32, shape (3,)
        Half the picture's width and height, pixels, and pixels a metre.
    limits : tuple
        How far from the stop's middle light passes, in parts of its radius; whether to keep cells, too, that
        have no valid ray but that light may cross; whether only convex cells may merge, which leaves folds.
    x, y : ndarray of float32, shape (W, rows, columns)
        Filled with pixels of the picture; lost rays go to its middle.
    sizes : ndarray of int8, shape (W, rows - 1, columns - 1)
        Filled with 0 where a cell stays, else -1.
    whole : ndarray of bool, shape (W, rows - 1, columns - 1)
        Filled: whether a cell may merge, which takes four valid rays.
    """
    reach, crossed, convex = limits
    state = np.empty(x.shape[1:], np.uint8)
    for w in range(x.shape[0]):
        weight, level, stop_x, stop_y = rays[0][w], rays[1][w], rays[2][w], rays[3][w]
        u, v = x[w], y[w]
        for i in range(x.shape[1]):
            for j in range(x.shape[2]):
                there, sx, sy = reached[w, i, j], stop_x[i, j], stop_y[i, j]
                u[i, j] = frame[0] - sensor[0][w, i, j] * frame[2] if there else frame[0]
                v[i, j] = frame[1] - sensor[1][w, i, j] * frame[2] if there else frame[1]
                # Four rays' sums tell how many arrived (1), through the semi-apertures (8), and validly (64).
                open_ = there and level[i, j] <= ONE
                valid = open_ and sx * sx + sy * sy <= reach * reach
                state[i, j] = there + 8 * open_ + 64 * valid
        for i in range(sizes.shape[1]):
            for j in range(sizes.shape[2]):
                four = state[i, j] + state[i, j + 1] + state[i + 1, j] + state[i + 1, j + 1]
                stays = four > 63 and (four & 7) > 2
                if crossed and 63 > four > 8 and (four & 7) == 4:
                    near_x, near_y = nearest_to_zero(stop_x, i, j), nearest_to_zero(stop_y, i, j)
                    stays = near_x * near_x + near_y * near_y <= reach * reach
                stays = stays and any_light(weight, i, j)
                sizes[w, i, j] = 0 if stays else -1
                whole[w, i, j] = stays and four == 292 and (not convex or turns_one_way(u, v, i, j))


@numba.njit(cache=True, nogil=True, error_model="numpy")
def any_light(weight: F32, i: int, j: int) -> bool:
    """Return whether one of a cell's rays has a weight."""
    pair = max(weight[i, j], weight[i, j + 1])
    return bool(max(pair, max(weight[i + 1, j], weight[i + 1, j + 1])) > ZERO)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def nearest_to_zero(values: F32, i: int, j: int) -> float:
    """Return the number nearest to 0 between the least and the largest of a cell's four."""
    a, b, c, d = values[i, j], values[i, j + 1], values[i + 1, j], values[i + 1, j + 1]
    number: float = max(min(min(a, b), min(c, d)), min(max(max(a, b), max(c, d)), ZERO))
    return number


@numba.njit(cache=True, nogil=True, error_model="numpy")
def turns_one_way(x: F32, y: F32, i: int, j: int) -> bool:
    """Return whether a cell turns the same way at each corner: it is convex and has no fold."""
    # Edges around the cell.
    ax, ay = x[i, j + 1] - x[i, j], y[i, j + 1] - y[i, j]
    bx, by = x[i + 1, j + 1] - x[i, j + 1], y[i + 1, j + 1] - y[i, j + 1]
    cx, cy = x[i + 1, j] - x[i + 1, j + 1], y[i + 1, j] - y[i + 1, j + 1]
    dx, dy = x[i, j] - x[i + 1, j], y[i, j] - y[i + 1, j]
    p, q, r, s = ax * by - ay * bx, bx * cy - by * cx, cx * dy - cy * dx, dx * ay - dy * ax
    low, high = min(min(p, q), min(r, s)), max(max(p, q), max(r, s))
    return bool(low > ZERO or high < ZERO)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def stitch(x: F32, y: F32, steps: int, sizes: I8) -> None:
    """Move nodes on large blocks' edges onto the straight edges, so that small neighbours leave no crack.

    Parameters
    ----------
    x, y : ndarray of float32, shape (W, rows, columns)
        Pixels; changed.
    steps : int
        Largest exponent of a size.
    sizes : ndarray of int8, shape (W, rows - 1, columns - 1)
        Exponents of the blocks' sizes.
    """
    for w in range(sizes.shape[0]):
        # The largest first: their edges carry corners of smaller ones.
        for step in range(steps, 0, -1):
            n = 1 << step
            for i in range(0, sizes.shape[1] - n + 1, n):
                for j in range(0, sizes.shape[2] - n + 1, n):
                    if sizes[w, i, j] == step:
                        for edge in range(4):
                            down, far = edge & 1, n * (edge >> 1)
                            a, b = (i, j + far) if down else (i + far, j)
                            straighten(x[w], a, b, down, n)
                            straighten(y[w], a, b, down, n)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def straighten(values: F32, i: int, j: int, down: int, n: int) -> None:
    """Put the nodes of an edge, along a row or down a column, evenly between its ends."""
    first, last = values[i, j], values[i + down * n, j + (1 - down) * n]
    part = ONE / np.float32(n)
    for k in range(1, n):
        t = np.float32(k) * part
        values[i + down * k, j + (1 - down) * k] = (ONE - t) * first + t * last


@numba.njit(cache=True, nogil=True, error_model="numpy")
def drop_outside(
    x: F32, y: F32, weight: F32, width: float, height: float, sizes: I8, outside: NDArray[np.float64]
) -> None:
    """Drop blocks whose box does not meet the frame.

    Parameters
    ----------
    x, y : ndarray of float32, shape (W, rows, columns)
        Pixels.
    weight : ndarray of float32, shape (W, rows, columns)
        Part of the power that is left.
    width, height : float
        The frame, pixels.
    sizes : ndarray of int8, shape (W, rows - 1, columns - 1)
        Filled with -1 where a block is dropped.
    outside : ndarray, shape (W,)
        Filled with the dropped power: cells times mean weight.
    """
    for w in range(sizes.shape[0]):
        lost = 0.0
        for i in range(sizes.shape[1]):
            for j in range(sizes.shape[2]):
                if sizes[w, i, j] < 0:
                    continue
                n = 1 << sizes[w, i, j]
                light, left, right, top, bottom = ZERO, x[w, i, j], x[w, i, j], y[w, i, j], y[w, i, j]
                for corner in range(4):
                    a, b = i + n * (corner >> 1), j + n * (corner & 1)
                    light += weight[w, a, b]
                    left, right = min(left, x[w, a, b]), max(right, x[w, a, b])
                    top, bottom = min(top, y[w, a, b]), max(bottom, y[w, a, b])
                if right < ZERO or bottom < ZERO or left > width or top > height:
                    lost += 0.25 * light * n * n
                    sizes[w, i, j] = -1
        outside[w] = lost


@numba.njit(cache=True, nogil=True, error_model="numpy")
def fill(
    x: F32,
    y: F32,
    rays: Rays,
    reached: Flags,
    sizes: I8,
    power: F32,
    colours: NDArray[np.int32],
    corners: F32,
    attributes: F32,
    exponents: NDArray[np.int32],
    colour: NDArray[np.int32],
) -> None:
    """Fill the primitives of a sheet's blocks, wavelength by wavelength and row by row.

    Parameters
    ----------
    x, y : ndarray of float32, shape (W, rows, columns)
        Pixels.
    rays : tuple of ndarray of float32, each of shape (W, rows, columns)
        Weight, level, stop_x and stop_y.
    reached : ndarray of bool, shape (W, rows, columns)
        Whether a ray reached the sensor.
    sizes : ndarray of int8, shape (W, rows - 1, columns - 1)
        Exponents of the blocks' sizes.
    power : ndarray of float32, shape (W, rows - 1, columns - 1)
        Sums of the cells' mean weights in each block, which a merged one keeps; empty: it does not.
    colours : ndarray of int32, shape (W,)
        Each wavelength's row of the table of colours.
    corners, attributes : ndarray of float32, shapes (P, 4, 2) and (P, 4, 4)
        Filled, around each block.
    exponents, colour : ndarray of int32, shape (P,)
        Filled.
    """
    k = 0
    for w in range(sizes.shape[0]):
        for i in range(sizes.shape[1]):
            for j in range(sizes.shape[2]):
                if sizes[w, i, j] < 0:
                    continue
                n = 1 << sizes[w, i, j]
                known = 0
                for c in range(4):
                    # Around the block: down for the last two corners, right for the middle two.
                    a, b = i + n * (c >> 1), j + n * ((c ^ (c >> 1)) & 1)
                    corners[k, c, 0], corners[k, c, 1] = x[w, a, b], y[w, a, b]
                    for m in range(4):
                        attributes[k, c, m] = rays[m][w, a, b]
                    known += reached[w, a, b]
                if known < 4:
                    complete(reached[w], i, j, corners[k], attributes[k])
                elif n == 1 or len(power):
                    light = power[w, i, j] / np.float32(n * n) if n > 1 else mean_weight(attributes[k])
                    even(x[w], y[w], reached[w], i, j, n, attributes[k])
                    told = mean_weight(attributes[k])
                    factor = light / told if told > ZERO else ONE
                    for c in range(4):
                        attributes[k, c, 0] *= factor
                exponents[k], colour[k] = sizes[w, i, j], colours[w]
                k += 1


@numba.njit(cache=True, nogil=True, error_model="numpy")
def mean_weight(attributes: F32) -> float:
    """Return the mean of a block's corners' weights."""
    mean: float = QUARTER * (attributes[0, 0] + attributes[1, 0] + attributes[2, 0] + attributes[3, 0])
    return mean


@numba.njit(cache=True, nogil=True, error_model="numpy")
def even(x: F32, y: F32, reached: Flags, i: int, j: int, n: int, attributes: F32) -> None:
    """Scale the weights of a block's corners so that brightness has no step between neighbours.

    Brightness at a corner is the weight over the area of the parallelogram there. The block's own changes
    from cell to cell; that of the node, the mean of those around it, does not.
    """
    m = np.float32(n * n)
    for c in range(4):
        # Around the block: down for the last two corners, right for the middle two.
        a, b = i + n * (c >> 1), j + n * ((c ^ (c >> 1)) & 1)
        shared = node_area(x, y, reached, a, b)
        if shared != ZERO:
            across, down = (n if b == j else -n), (n if a == i else -n)
            ux, uy = x[a, b + across] - x[a, b], y[a, b + across] - y[a, b]
            vx, vy = x[a + down, b] - x[a, b], y[a + down, b] - y[a, b]
            own = (ux * vy - uy * vx) * (ONE if (across > 0) == (down > 0) else -ONE)
            ratio = own / (m * shared)
            if n == 1 or HALF < ratio < ONE + ONE:
                attributes[c, 0] *= ratio


@numba.njit(cache=True, nogil=True, error_model="numpy")
def node_area(x: F32, y: F32, reached: Flags, i: int, j: int) -> float:
    """Return the mean area of the four parallelograms at a node; 0 at a border, a fold or a lost ray."""
    none: float = ZERO
    rows, columns = x.shape
    if i == 0 or j == 0 or i == rows - 1 or j == columns - 1:
        return none
    if not (reached[i - 1, j] and reached[i + 1, j] and reached[i, j - 1] and reached[i, j + 1]):
        return none
    ax, ay, bx, by = (
        x[i, j + 1] - x[i, j],
        y[i, j + 1] - y[i, j],
        x[i, j] - x[i, j - 1],
        y[i, j] - y[i, j - 1],
    )
    cx, cy, dx, dy = (
        x[i + 1, j] - x[i, j],
        y[i + 1, j] - y[i, j],
        x[i, j] - x[i - 1, j],
        y[i, j] - y[i - 1, j],
    )
    p, q, r, s = ax * cy - ay * cx, ax * dy - ay * dx, bx * cy - by * cx, bx * dy - by * dx
    mean: float = QUARTER * (p + q + r + s)
    low, high = min(min(p, q), min(r, s)), max(max(p, q), max(r, s))
    # All four turn one way, and none is less than half or more than twice the mean.
    alike = (
        low > HALF * mean and high < mean + mean if mean > ZERO else high < HALF * mean and low > mean + mean
    )
    return mean if alike else none


@numba.njit(cache=True, nogil=True, error_model="numpy")
def complete(reached: Flags, i: int, j: int, corners: F32, attributes: F32) -> None:
    """Give the one lost corner of a cell the place that makes a parallelogram, and no power."""
    for c in range(4):
        if not reached[i + (c >> 1), j + ((c ^ (c >> 1)) & 1)]:
            before, across, behind = (c + 3) & 3, (c + 2) & 3, (c + 1) & 3
            for m in range(2):
                corners[c, m] = corners[before, m] + corners[behind, m] - corners[across, m]
            for m in range(4):
                attributes[c, m] = attributes[before, m] + attributes[behind, m] - attributes[across, m]
            attributes[c, 0] = ZERO
