"""Compiled loop that finds out what each primitive is, and what its layer needs to know of it."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.flare._kernels_raster import CURVED, EDGED, FLAT, ROUGH, SKIPPED

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I8 = NDArray[np.int8]
I32 = NDArray[np.int32]

# A quad is rough where its cells have less than this area in pixels, or where its smallest corner is under
# this part of its largest. Merged ones lie beside rough cells, whose power is exact, so they are rough, too,
# up to a size at which a pixel's edge no longer counts.
SMALLEST_AREA, SMALLEST_CORNER, LARGEST_ROUGH = 1.0, 0.1, 100.0
# So are, up to that size, ones as uneven as this, up to a small size less uneven ones, and narrow ones whose
# sides meet at an angle with less than this sine: ramps along their edges and a brightness at each pixel's
# middle would miss much of their power.
UNEVEN_CORNER, SMALL_CORNER, SMALL_AREA = 0.5, 0.8, 6.0
NARROWEST, SLANTED = 1.5, 0.25
# Part of the brightness that a plane may leave unsaid.
FLAT_ENOUGH = 0.005
# Pixels by which planes of level and place on the stop may move an edge of light.
STRAIGHT = 0.1
# Radii of the stop beyond which nothing is of interest.
FAR = 1e3


@numba.njit(cache=True, nogil=True, error_model="numpy")
def prepare(
    corners: F32,
    rays: F32,
    areas: F32,
    merged: I32,
    opened: I32,
    frame: I32,
    start: int,
    stop: int,
    table: F32,
    boxes: I32,
    kinds: I8,
) -> None:
    """Fill what the layers need to know of primitives.

    Parameters
    ----------
    corners : ndarray of float32, shape (P, 4, 2)
        Pixels.
    rays : ndarray of float32, shape (P, 4, 4)
        Weight, level, stop_x and stop_y of each corner.
    areas : ndarray of float32, shape (P,)
        Pupil's areas, m².
    merged : ndarray of int32, shape (P,)
        Cells along each side.
    opened : ndarray of int32, shape (2, rows + 1, columns + 1)
        Sums of an iris's samples that are wholly open, and wholly closed; (2, 1, 1) for a round one.
    frame : ndarray of int32, shape (2,)
        Columns and rows.
    start, stop : int
        Which primitives.
    table : ndarray of float32, shape (P, 16)
        Filled with rows for `lay_flat`.
    boxes : ndarray of int32, shape (P, 4)
        Filled with left, top, right, bottom.
    kinds : ndarray of int8, shape (P,)
        Filled; below 0 where a rough quad is open all over.
    """
    sides, turns, low, high = np.empty((4, 2)), np.empty(4), np.empty(6), np.empty(6)
    for p in range(start, stop):
        quad, kinds[p] = corners[p], SKIPPED
        extremes(quad, low, high)
        if not (high[0] > -1 and high[1] > -1 and low[0] < frame[0] + 1 and low[1] < frame[1] + 1):
            continue
        for k in range(2):
            # Ramps of two edges reach a little beyond their corner.
            boxes[p, k] = math.floor(max(low[k] - 1, 0.0))
            boxes[p, 2 + k] = math.floor(min(high[k] + 2, float(frame[k])))
        area = edges(quad, boxes[p], sides, turns, table[p])
        extremes(rays[p], low, high)
        margins(rays[p], sides, area, low, high)
        passing = what_passes(low, high, opened)
        if passing == SKIPPED:
            continue
        least, most = turns[0], turns[0]
        for k in range(1, 4):
            least, most = min(least, turns[k]), max(most, turns[k])
        fine = min(SMALLEST_AREA * merged[p] * merged[p], LARGEST_ROUGH)
        if area >= fine and not is_rough(area, least, most, sides):
            unsaid = brightness(quad, rays[p], areas[p], area, boxes[p], sides, turns, table[p])
            kinds[p] = CURVED
            if unsaid <= FLAT_ENOUGH and (passing == FLAT or twist(quad, rays[p], sides, area) <= STRAIGHT):
                kinds[p] = FLAT if passing == FLAT else EDGED
        else:
            kinds[p] = -ROUGH if passing == FLAT else ROUGH


@numba.njit(cache=True, nogil=True)
def is_rough(area: float, least: float, most: float, sides: F64) -> bool:
    """Return whether a quad is too uneven, or too narrow and slanted, for ramps along its edges."""
    longest, other = 0.0, 0.0
    for k in range(4):
        length = sides[k, 0] * sides[k, 0] + sides[k, 1] * sides[k, 1]
        longest = max(longest, length)
        if k & 1:
            other = max(other, length)
    product = other * (sides[0, 0] * sides[0, 0] + sides[0, 1] * sides[0, 1])
    if area * area < NARROWEST * NARROWEST * longest and area * area < SLANTED * SLANTED * product:
        return True
    corner = UNEVEN_CORNER if area < LARGEST_ROUGH else SMALLEST_CORNER
    return least <= (SMALL_CORNER if area < SMALL_AREA else corner) * most


@numba.njit(cache=True, nogil=True)
def extremes(numbers: F32, low: F64, high: F64) -> None:
    """Fill the least and the most of each of the four corners' numbers."""
    for k in range(numbers.shape[1]):
        low[k] = high[k] = numbers[0, k]
        for c in range(1, 4):
            low[k], high[k] = min(low[k], numbers[c, k]), max(high[k], numbers[c, k])


@numba.njit(cache=True, nogil=True, error_model="numpy")
def edges(quad: F32, box: I32, sides: F64, turns: F64, row: F32) -> float:
    """Fill the ramps of a quad's edges, its sides and its corners' areas; return its area, >= 0."""
    for k in range(4):
        for c in range(2):
            sides[k, c] = np.float64(quad[(k + 1) & 3, c]) - quad[k, c]
    area = 0.0
    for k in range(4):
        before = (k + 3) & 3
        turns[k] = sides[before, 0] * sides[k, 1] - sides[before, 1] * sides[k, 0]
        area += 0.25 * turns[k]
    sign = 1.0 if area >= 0 else -1.0
    for k in range(4):
        dx, dy = sides[k, 0], sides[k, 1]
        length = abs(dx) + abs(dy)
        part = sign / length if length > 0 else 0.0
        row[k], row[4 + k] = -dy * part, dx * part
        # An edge without length leaves everything inside.
        value = part * (dx * (box[1] + 0.5 - quad[k, 1]) - dy * (box[0] + 0.5 - quad[k, 0]))
        row[8 + k] = value if length > 0 else 1e6
        turns[k] *= sign
    row[15] = sign
    return sign * area


@numba.njit(cache=True, nogil=True, error_model="numpy")
def margins(rays: F32, sides: F64, area: float, low: F64, high: F64) -> None:
    """Widen the extremes of a quad's numbers by what they change over half a pixel, at most half the quad."""
    across = 0.25 * (abs(sides[0, 0] - sides[2, 0]) + abs(sides[0, 1] - sides[2, 1])) / max(area, 1e-3)
    along = 0.25 * (abs(sides[1, 0] - sides[3, 0]) + abs(sides[1, 1] - sides[3, 1])) / max(area, 1e-3)
    for k in range(1, 4):
        u = max(abs(rays[1, k] - rays[0, k]), abs(rays[2, k] - rays[3, k]))
        v = max(abs(rays[3, k] - rays[0, k]), abs(rays[2, k] - rays[1, k]))
        margin = u * min(along, 0.5) + v * min(across, 0.5)
        low[k] -= margin
        high[k] += margin


@numba.njit(cache=True, nogil=True)
def what_passes(low: F64, high: F64, opened: I32) -> int:
    """Return whether light passes all of a quad (flat), none of it (skipped) or some (curved)."""
    if low[1] > 1.0:
        return SKIPPED
    rows, columns = opened.shape[1] - 1, opened.shape[2] - 1
    if rows == 0:
        x, y = max(max(low[2], -high[2]), 0.0), max(max(low[3], -high[3]), 0.0)
        if x * x + y * y > 1.0:
            return SKIPPED
        x, y = max(abs(low[2]), abs(high[2])), max(abs(low[3]), abs(high[3]))
        return FLAT if high[1] <= 1.0 and x * x + y * y <= 1.0 else CURVED
    for k in range(2, 4):
        low[k], high[k] = min(max(low[k], -FAR), FAR), min(max(high[k], -FAR), FAR)
    # Samples of the iris that a look-up in the quad can touch.
    j0, j1 = math.floor((low[2] + 1) * 0.5 * columns - 0.5), math.floor((high[2] + 1) * 0.5 * columns + 1.5)
    i0, i1 = math.floor((low[3] + 1) * 0.5 * rows - 0.5), math.floor((high[3] + 1) * 0.5 * rows + 1.5)
    within = j0 >= 0 and i0 >= 0 and j1 <= columns and i1 <= rows
    j0, j1, i0, i1 = max(j0, 0), min(j1, columns), max(i0, 0), min(i1, rows)
    if j1 <= j0 or i1 <= i0:
        return SKIPPED
    kind, samples = CURVED, (j1 - j0) * (i1 - i0)
    for k in range(2):
        found = opened[k, i1, j1] - opened[k, i0, j1] - opened[k, i1, j0] + opened[k, i0, j0]
        if found == samples and k == 0 and within and high[1] <= 1.0:
            kind = FLAT
        if found == samples and k == 1:
            kind = SKIPPED
    return kind


@numba.njit(cache=True, nogil=True, error_model="numpy")
def twist(quad: F32, rays: F32, sides: F64, area: float) -> float:
    """Return by how many pixels an edge of light moves where a quad's bilinear numbers become planes."""
    ux, uy = 0.5 * (sides[0, 0] - sides[2, 0]), 0.5 * (sides[0, 1] - sides[2, 1])
    vx, vy = 0.5 * (sides[1, 0] - sides[3, 0]), 0.5 * (sides[1, 1] - sides[3, 1])
    moved = 0.25 * max(abs(sides[0, 0] + sides[2, 0]), abs(sides[0, 1] + sides[2, 1]))
    for k in range(1, 4):
        along = 0.5 * (rays[1, k] + rays[2, k] - rays[0, k] - rays[3, k])
        across = 0.5 * (rays[3, k] + rays[2, k] - rays[0, k] - rays[1, k])
        slope = (abs(along * vy - across * uy) + abs(across * ux - along * vx)) / area
        bent = 0.25 * abs(rays[0, k] - rays[1, k] + rays[2, k] - rays[3, k])
        moved = max(moved, bent / (slope + 1e-9))
    return float(moved)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def brightness(
    quad: F32, rays: F32, pupil: float, area: float, box: I32, sides: F64, turns: F64, row: F32
) -> float:
    """Fill the plane of a quad's brightness, and return which part of it a plane leaves unsaid."""
    d0, d1 = pupil * rays[0, 0] / turns[0], pupil * rays[1, 0] / turns[1]
    d2, d3 = pupil * rays[2, 0] / turns[2], pupil * rays[3, 0] / turns[3]
    # The mean is such that the power is the cell's.
    mean = 0.25 * pupil * (rays[0, 0] + rays[1, 0] + rays[2, 0] + rays[3, 0]) / area
    along, across = 0.5 * (d1 + d2 - d0 - d3), 0.5 * (d3 + d2 - d0 - d1)
    ux, uy = 0.5 * (sides[0, 0] - sides[2, 0]), 0.5 * (sides[0, 1] - sides[2, 1])
    vx, vy = 0.5 * (sides[1, 0] - sides[3, 0]), 0.5 * (sides[1, 1] - sides[3, 1])
    turn = ux * vy - uy * vx
    slope_x, slope_y = (along * vy - across * uy) / turn, (across * ux - along * vx) / turn
    x, y = 0.0, 0.0
    for k in range(4):
        x += 0.25 * quad[k, 0]
        y += 0.25 * quad[k, 1]
    row[12] = mean + slope_x * (box[0] + 0.5 - x) + slope_y * (box[1] + 0.5 - y)
    row[13], row[14] = slope_x, slope_y
    unsaid = 0.25 * (abs(d0 - d1 + d2 - d3) + abs(d0 + d1 + d2 + d3 - 4.0 * mean))
    return float(unsaid if mean <= 0 else unsaid / mean)
