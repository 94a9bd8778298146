"""Compiled loops from a sheet of rays to primitives: which cells stay, which merge, and their corners.

A block is named by its first cell; `sizes` holds the exponent of its size there, -1 where nothing begins.
"""

import math
from typing import Any, TypeAlias

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
I8 = NDArray[np.int8]
Flags = NDArray[np.bool_]
Rays: TypeAlias = tuple[F32, F32, F32, F32]
# Of the tests' numbers 0 merges nothing.
PUBLISHED, CORRECT = 1, 2
Five: TypeAlias = tuple[float, float, float, float, float]

ZERO: Any = np.float32(0)
QUARTER: Any = np.float32(0.25)
HALF: Any = np.float32(0.5)
ONE: Any = np.float32(1)
TWO: Any = np.float32(2)
THREE: Any = np.float32(3)
NINE: Any = np.float32(9)
HUGE: Any = np.float32(1e9)


@numba.njit(cache=True, nogil=True)
def to_pixels(x: F32, y: F32, reached: Flags, half_width: float, half_height: float, scale: float) -> None:
    """Turn sensor positions into the picture's, in place; lost rays go to the middle.

    Parameters
    ----------
    x, y : ndarray of float32, shape (rows, columns)
        Metres on the sensor; filled with pixels.
    reached : ndarray of bool, shape (rows, columns)
        Whether a ray reached the sensor.
    half_width, half_height : float
        Half the picture, pixels.
    scale : float
        Pixels a metre.
    """
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            x[i, j] = half_width - x[i, j] * scale if reached[i, j] else half_width
            y[i, j] = half_height - y[i, j] * scale if reached[i, j] else half_height


@numba.njit(cache=True, nogil=True)
def mark_cells(
    x: F32,
    y: F32,
    weight: F32,
    valid: tuple[F32, F32, F32, Flags, float, bool],
    convex: bool,
    sizes: I8,
    whole: Flags,
) -> None:
    """Mark the cells that stay, and those among them that may merge.

    Parameters
    ----------
    x, y : ndarray of float32, shape (rows, columns)
        Pixels.
    weight : ndarray of float32, shape (rows, columns)
        Part of the power that is left.
    valid : tuple
        What says whether a ray is valid: level, stop_x, stop_y and reached as a sheet's; how far from the
        stop's middle light passes, in parts of its radius; whether to keep cells, too, that have no valid ray
        but that light may cross.
    convex : bool
        Whether only convex cells may merge, which leaves folds as they are.
    sizes : ndarray of int8, shape (rows - 1, columns - 1)
        Filled with 0 where a cell stays, else -1.
    whole : ndarray of bool, shape (rows - 1, columns - 1)
        Filled: whether a cell may merge, which takes four valid rays.
    """
    level, stop_x, stop_y, reached, reach, crossed = valid
    reach2 = reach * reach
    for i in range(sizes.shape[0]):
        for j in range(sizes.shape[1]):
            sizes[i, j], whole[i, j] = -1, False
            inside, known, light = 0, 0, ZERO
            low = level[i, j]
            left, right, top, bottom = stop_x[i, j], stop_x[i, j], stop_y[i, j], stop_y[i, j]
            for a in range(i, i + 2):
                for b in range(j, j + 2):
                    here, sx, sy = level[a, b], stop_x[a, b], stop_y[a, b]
                    known += reached[a, b]
                    inside += reached[a, b] and here <= ONE and sx * sx + sy * sy <= reach2
                    light = max(light, weight[a, b])
                    low, left, right = min(low, here), min(left, sx), max(right, sx)
                    top, bottom = min(top, sy), max(bottom, sy)
            if known < 3 or light <= ZERO:
                continue
            nearest_x, nearest_y = max(left, min(right, ZERO)), max(top, min(bottom, ZERO))
            met = low <= ONE and nearest_x * nearest_x + nearest_y * nearest_y <= reach2
            if inside > 0 or (crossed and known == 4 and met):
                sizes[i, j] = 0
                whole[i, j] = inside == 4 and (not convex or turning(x, y, i, j, 1) != 0)


@numba.njit(cache=True, nogil=True)
def turning(x: F32, y: F32, i: int, j: int, n: int) -> int:
    """Return 1 or -1 where a block turns the same way at each corner, 0 where it is concave or folded."""
    a = corner(x[i, j], y[i, j], x[i, j + n], y[i, j + n], x[i + n, j], y[i + n, j])
    b = corner(x[i, j + n], y[i, j + n], x[i + n, j + n], y[i + n, j + n], x[i, j], y[i, j])
    c = corner(x[i + n, j + n], y[i + n, j + n], x[i + n, j], y[i + n, j], x[i, j + n], y[i, j + n])
    d = corner(x[i + n, j], y[i + n, j], x[i, j], y[i, j], x[i + n, j + n], y[i + n, j + n])
    if a > ZERO and b > ZERO and c > ZERO and d > ZERO:
        return 1
    return -1 if a < ZERO and b < ZERO and c < ZERO and d < ZERO else 0


@numba.njit(cache=True, nogil=True)
def corner(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> float:
    """Return the cross product of the edges from a to b and from a to c."""
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@numba.njit(cache=True, nogil=True)
def four_alike(sizes: I8, whole: Flags, i: int, j: int, n: int, exponent: int) -> bool:
    """Return whether the four children of a block have one size and may merge."""
    for a in range(i, i + n + 1, n):
        for b in range(j, j + n + 1, n):
            if sizes[a, b] != exponent or not whole[a, b]:
                return False
    return True


@numba.njit(cache=True, nogil=True)
def join(sizes: I8, i: int, j: int, n: int) -> None:
    """Make one block of four: the first child takes its name."""
    sizes[i, j] += 1
    sizes[i, j + n] = sizes[i + n, j] = sizes[i + n, j + n] = -1


@numba.njit(cache=True, nogil=True)
def edges_alike(
    x: F32, y: F32, ai: int, aj: int, bi: int, bj: int, n: int, units: tuple[float, float], bound: float
) -> bool:
    """Return whether each edge of block a is like that of block b by Eq. 12, signs and all."""
    di, dj, ei, ej = 0, 0, 0, n
    for _ in range(4):
        ax, ay = x[ai + ei, aj + ej] - x[ai + di, aj + dj], y[ai + ei, aj + ej] - y[ai + di, aj + dj]
        bx, by = x[bi + ei, bj + ej] - x[bi + di, bj + dj], y[bi + ei, bj + ej] - y[bi + di, bj + dj]
        if not (ax - bx) * units[0] + (ay - by) * units[1] < bound:
            return False
        # The next edge around the block.
        di, dj, ei, ej = ei, ej, n - di, n - dj
    return True


@numba.njit(cache=True, nogil=True)
def merge_published(
    x: F32, y: F32, step: int, units: tuple[float, float], bound: float, sizes: I8, whole: Flags
) -> None:
    """Merge blocks of 2×2 by Eq. 12 as printed.

    Parameters
    ----------
    x, y : ndarray of float32, shape (rows, columns)
        Pixels.
    step : int
        Exponent of the new size.
    units : tuple of float
        Normalised device coordinates a pixel.
    bound : float
        The paper's gamma.
    sizes : ndarray of int8, shape (rows - 1, columns - 1)
        Changed where blocks merge.
    whole : ndarray of bool, shape (rows - 1, columns - 1)
        Whether a block may merge.
    """
    n = 1 << (step - 1)
    for i in range(0, sizes.shape[0] - 2 * n + 1, 2 * n):
        for j in range(0, sizes.shape[1] - 2 * n + 1, 2 * n):
            if (
                four_alike(sizes, whole, i, j, n, step - 1)
                and edges_alike(x, y, i, j, i, j + n, n, units, bound)
                and edges_alike(x, y, i + n, j, i + n, j + n, n, units, bound)
                and edges_alike(x, y, i, j, i + n, j, n, units, bound)
                and edges_alike(x, y, i, j + n, i + n, j + n, n, units, bound)
            ):
                join(sizes, i, j, n)


@numba.njit(cache=True, nogil=True)
def bend(values: F32, i: int, j: int, n: int) -> Five:
    """Return how far the five inner nodes of a block lie off its corners' bilinear map.

    Middle of the top, left, right and bottom edge, and of the block.
    """
    m = 2 * n
    a, b, c, d = values[i, j], values[i, j + m], values[i + m, j + m], values[i + m, j]
    return (
        values[i, j + n] - HALF * (a + b),
        values[i + n, j] - HALF * (a + d),
        values[i + n, j + m] - HALF * (b + c),
        values[i + m, j + n] - HALF * (d + c),
        values[i + n, j + n] - QUARTER * (a + b + c + d),
    )


@numba.njit(cache=True, nogil=True)
def largest(u: Five, v: Five) -> float:
    """Return the length of the longest of five vectors."""
    first = max(u[0] * u[0] + v[0] * v[0], u[1] * u[1] + v[1] * v[1])
    second = max(u[2] * u[2] + v[2] * v[2], u[3] * u[3] + v[3] * v[3])
    return math.sqrt(max(max(first, second), u[4] * u[4] + v[4] * v[4]))


@numba.njit(cache=True, nogil=True)
def span(x: F32, y: F32, i: int, j: int, m: int) -> float:
    """Return the sum of a block's diagonals."""
    ax, ay = x[i + m, j + m] - x[i, j], y[i + m, j + m] - y[i, j]
    bx, by = x[i + m, j] - x[i, j + m], y[i + m, j] - y[i, j + m]
    return math.sqrt(ax * ax + ay * ay) + math.sqrt(bx * bx + by * by)


@numba.njit(cache=True, nogil=True)
def brightness_change(x: F32, y: F32, weight: F32, power: F32, i: int, j: int, n: int) -> float:
    """Return the largest relative change of a child's mean brightness by its parent; huge across a fold.

    Power is conserved, so the parent's is the children's; on its map each of them gets the part that the
    corners' weights say, on the part of the area that the corners' places say.
    """
    m = 2 * n
    whole = power[i, j] + power[i, j + n] + power[i + n, j] + power[i + n, j + n]
    w = weight[i, j], weight[i, j + m], weight[i + m, j + m], weight[i + m, j]
    g = (
        corner(x[i, j], y[i, j], x[i, j + m], y[i, j + m], x[i + m, j], y[i + m, j]),
        corner(x[i, j + m], y[i, j + m], x[i + m, j + m], y[i + m, j + m], x[i, j], y[i, j]),
        corner(x[i + m, j + m], y[i + m, j + m], x[i + m, j], y[i + m, j], x[i, j + m], y[i, j + m]),
        corner(x[i + m, j], y[i + m, j], x[i, j], y[i, j], x[i + m, j + m], y[i + m, j + m]),
    )
    total = w[0] + w[1] + w[2] + w[3]
    worst: float = ZERO
    for k in range(4):
        # Children around the block; a bilinear number's mean over one has 9, 3, 1, 3 parts of the corners.
        a, b = i + n * (k >> 1), j + n * ((k ^ (k >> 1)) & 1)
        p, q, r = (k + 1) & 3, (k + 2) & 3, (k + 3) & 3
        told = whole * (NINE * w[k] + THREE * (w[p] + w[r]) + w[q])
        told_area = NINE * g[k] + THREE * (g[p] + g[r]) + g[q]
        ax, ay = x[a + n, b + n] - x[a, b], y[a + n, b + n] - y[a, b]
        bx, by = x[a + n, b] - x[a, b + n], y[a + n, b] - y[a, b + n]
        below = total * told_area * power[a, b]
        change = abs(TWO * told * (ax * by - ay * bx) / below - ONE) if below != ZERO else HUGE
        worst = max(worst, change)
    return worst


@numba.njit(cache=True, nogil=True)
def merge_correct(
    x: F32,
    y: F32,
    weight: F32,
    stop_x: F32,
    stop_y: F32,
    step: int,
    bounds: tuple[float, float],
    sizes: I8,
    whole: Flags,
    done: tuple[F32, F32, F32],
) -> None:
    """Merge blocks of 2×2 where that moves nothing and changes no brightness by more than is allowed.

    Parameters
    ----------
    x, y : ndarray of float32, shape (rows, columns)
        Pixels.
    weight, stop_x, stop_y : ndarray of float32, shape (rows, columns)
        Parts of the power that are left, and places on the stop.
    step : int
        Exponent of the new size.
    bounds : tuple of float
        Largest distance, in pixels, by which a point of the block, or of an iris's edge in it, may move, and
        largest relative change of brightness; the latter is not heeded in blocks within a pixel.
    sizes : ndarray of int8, shape (rows - 1, columns - 1)
        Changed where blocks merge.
    whole : ndarray of bool, shape (rows - 1, columns - 1)
        Whether a block may merge.
    done : tuple of ndarray of float32, each of shape (rows - 1, columns - 1)
        Of each block: sum of its cells' mean weights, and how far merging has moved it and changed it.
    """
    (position, brightness), (power, moved, changed) = bounds, done
    n = 1 << (step - 1)
    for i in range(0, sizes.shape[0] - 2 * n + 1, 2 * n):
        for j in range(0, sizes.shape[1] - 2 * n + 1, 2 * n):
            if not four_alike(sizes, whole, i, j, n, step - 1) or turning(x, y, i, j, 2 * n) == 0:
                continue
            # Two bilinear maps of a child differ most at a node, so that the steps' bounds add up.
            large = span(x, y, i, j, 2 * n)
            shift = largest(bend(x, i, j, n), bend(y, i, j, n))
            iris = largest(bend(stop_x, i, j, n), bend(stop_y, i, j, n))
            wide = span(stop_x, stop_y, i, j, 2 * n)
            shift = max(shift, iris * large / wide) if wide > ZERO else shift
            shift += worst_child(moved, i, j, n)
            if shift > position:
                continue
            change = worst_child(changed, i, j, n) + brightness_change(x, y, weight, power, i, j, n)
            if change > brightness and large > TWO:
                continue
            join(sizes, i, j, n)
            moved[i, j], changed[i, j] = shift, min(change, brightness)
            power[i, j] += power[i, j + n] + power[i + n, j] + power[i + n, j + n]


@numba.njit(cache=True, nogil=True)
def worst_child(values: F32, i: int, j: int, n: int) -> float:
    """Return the largest of a block's four children's values."""
    worst: float = max(max(values[i, j], values[i, j + n]), max(values[i + n, j], values[i + n, j + n]))
    return worst


@numba.njit(cache=True, nogil=True)
def stitch(x: F32, y: F32, steps: int, sizes: I8) -> None:
    """Move nodes on large blocks' edges onto the straight edges, so that small neighbours leave no crack.

    Parameters
    ----------
    x, y : ndarray of float32, shape (rows, columns)
        Pixels; changed.
    steps : int
        Largest exponent of a size.
    sizes : ndarray of int8, shape (rows - 1, columns - 1)
        Exponents of the blocks' sizes.
    """
    for step in range(steps, 0, -1):
        n = 1 << step
        for i in range(0, sizes.shape[0] - n + 1, n):
            for j in range(0, sizes.shape[1] - n + 1, n):
                if sizes[i, j] == step:
                    straighten(x, i, j, n)
                    straighten(y, i, j, n)


@numba.njit(cache=True, nogil=True)
def straighten(values: F32, i: int, j: int, n: int) -> None:
    """Put a block's edge nodes evenly between its corners."""
    m, part = np.float32(n), ONE / np.float32(n)
    for k in range(1, n):
        t = np.float32(k)
        values[i, j + k] = ((m - t) * values[i, j] + t * values[i, j + n]) * part
        values[i + n, j + k] = ((m - t) * values[i + n, j] + t * values[i + n, j + n]) * part
        values[i + k, j] = ((m - t) * values[i, j] + t * values[i + n, j]) * part
        values[i + k, j + n] = ((m - t) * values[i, j + n] + t * values[i + n, j + n]) * part


@numba.njit(cache=True, nogil=True)
def cell_powers(weight: F32, power: F32) -> None:
    """Fill the mean weight of each cell's four rays."""
    for i in range(power.shape[0]):
        for j in range(power.shape[1]):
            one, two = weight[i, j] + weight[i, j + 1], weight[i + 1, j] + weight[i + 1, j + 1]
            power[i, j] = QUARTER * (one + two)


@numba.njit(cache=True, nogil=True)
def drop_outside(x: F32, y: F32, weight: F32, width: float, height: float, sizes: I8) -> tuple[int, float]:
    """Drop blocks whose box does not meet the frame; return how many stay, and the others' power.

    Parameters
    ----------
    x, y : ndarray of float32, shape (rows, columns)
        Pixels.
    weight : ndarray of float32, shape (rows, columns)
        Part of the power that is left.
    width, height : float
        The frame, pixels.
    sizes : ndarray of int8, shape (rows - 1, columns - 1)
        Filled with -1 where a block is dropped.

    Returns
    -------
    int, float
        Blocks, and cells times mean weight.
    """
    count, outside = 0, 0.0
    for i in range(sizes.shape[0]):
        for j in range(sizes.shape[1]):
            if sizes[i, j] < 0:
                continue
            n = 1 << sizes[i, j]
            a, b, c, d = x[i, j], x[i, j + n], x[i + n, j + n], x[i + n, j]
            e, f, g, h = y[i, j], y[i, j + n], y[i + n, j + n], y[i + n, j]
            misses = max(max(a, b), max(c, d)) < ZERO or min(min(a, b), min(c, d)) > width
            if misses or max(max(e, f), max(g, h)) < ZERO or min(min(e, f), min(g, h)) > height:
                mean = weight[i, j] + weight[i, j + n] + weight[i + n, j] + weight[i + n, j + n]
                outside += 0.25 * mean * n * n
                sizes[i, j] = -1
            else:
                count += 1
    return count, outside


@numba.njit(cache=True, nogil=True)
def arrange(
    x: F32,
    y: F32,
    rays: Rays,
    reached: Flags,
    shape: tuple[int, int],
    scale: float,
    limits: tuple[float, bool],
    test: int,
    steps: int,
    bounds: tuple[float, float],
    stitched: bool,
    sizes: I8,
    power: F32,
    outside: NDArray[np.float64],
) -> int:
    """Find the blocks of a sheet: mark its cells, merge them, close cracks, drop what misses the frame.

    Parameters
    ----------
    x, y : ndarray of float32, shape (W, rows, columns)
        Metres on the sensor; filled with pixels of the picture.
    rays : tuple of ndarray of float32, each of shape (W, rows, columns)
        Weight, level, stop_x and stop_y.
    reached : ndarray of bool, shape (W, rows, columns)
        Whether a ray reached the sensor.
    shape : tuple of int
        The frame's rows and columns.
    scale : float
        Pixels a metre.
    limits : tuple
        How far from the stop's middle light passes, in parts of its radius, and whether to keep cells without
        a valid ray that light may cross.
    test : int
        0 merges nothing, or one of the numbers above.
    steps : int
        Largest exponent of a size.
    bounds : tuple of float
        Gamma and nothing, or the bounds of position and brightness.
    stitched : bool
        Whether to move nodes onto the edges of large blocks.
    sizes : ndarray of int8, shape (W, rows - 1, columns - 1)
        Filled with the exponents of the blocks' sizes, -1 where none begins.
    power : ndarray of float32, shape (W, rows - 1, columns - 1)
        Filled with the blocks' sums of their cells' mean weights.
    outside : ndarray, shape (W,)
        Filled with the power of the blocks outside the frame, in cells.

    Returns
    -------
    int
        How many blocks there are.
    """
    height: Any = np.float32(shape[0])
    width: Any = np.float32(shape[1])
    whole = np.empty(sizes.shape[1:], np.bool_)
    moved, changed = np.empty(sizes.shape[1:], np.float32), np.empty(sizes.shape[1:], np.float32)
    count = 0
    for w in range(len(x)):
        u, v, size, powers, there = x[w], y[w], sizes[w], power[w], reached[w]
        weight, level, stop_x, stop_y = rays[0][w], rays[1][w], rays[2][w], rays[3][w]
        to_pixels(u, v, there, HALF * width, HALF * height, scale)
        valid = level, stop_x, stop_y, there, limits[0], limits[1]
        mark_cells(u, v, weight, valid, test == CORRECT, size, whole)
        cell_powers(weight, powers)
        moved[:] = ZERO
        changed[:] = ZERO
        for step in range(1, steps + 1):
            if test == PUBLISHED:
                units = TWO / width, -TWO / height
                merge_published(u, v, step, units, bounds[0], size, whole)
            elif test == CORRECT:
                done = powers, moved, changed
                merge_correct(u, v, weight, stop_x, stop_y, step, bounds, size, whole, done)
        if stitched:
            stitch(u, v, steps, size)
        found, lost = drop_outside(u, v, weight, width, height, size)
        count, outside[w] = count + found, lost
    return count


@numba.njit(cache=True, nogil=True)
def fill(
    x: F32,
    y: F32,
    rays: Rays,
    reached: Flags,
    sizes: I8,
    power: F32,
    conserved: bool,
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
        Sums of the blocks' mean weights.
    conserved : bool
        Whether a merged block's weights are scaled to its cells' power.
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
                elif n > 1 and conserved:
                    total = (
                        attributes[k, 0, 0] + attributes[k, 1, 0] + attributes[k, 2, 0] + attributes[k, 3, 0]
                    )
                    factor = power[w, i, j] / (QUARTER * total * np.float32(n * n)) if total > ZERO else ONE
                    for c in range(4):
                        attributes[k, c, 0] *= factor
                exponents[k], colour[k] = sizes[w, i, j], colours[w]
                k += 1


@numba.njit(cache=True, nogil=True)
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
