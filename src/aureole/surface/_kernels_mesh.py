"""Which triangle of a mesh each ray of a view meets first: edge functions and depths.

Corners are (x, y, w, depth) in the view's coordinates, w their depth in perspective and 1 for parallel rays.
Edge functions of the rays (x, y, 1) are then linear over the picture, and exact for triangles that reach
behind the eye.
"""

import math

from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def raster(triangles, corners, spans, order, size, nearest, number, weights):  # type: ignore[no-untyped-def]
    """Write what is nearest on some rows of samples: its depth, its number and two corners' shares.

    Triangles (T, 3) number corners (V, 4); spans (T, 2) are the rows that each may touch, order (N,) those
    to draw. Size is the view's rows and columns and the first row of nearest (R, C), number (R, C) and
    weights (R, C, 2), which are written over.
    """
    rows, columns, top = size
    bottom = top + nearest.shape[0]
    for n in range(order.size):
        t = order[n]
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, aw, bx, by, bw = (
            corners[a, 0],
            corners[a, 1],
            corners[a, 2],
            corners[b, 0],
            corners[b, 1],
            corners[b, 2],
        )
        cx, cy, cw = corners[c, 0], corners[c, 1], corners[c, 2]
        da, db, dc = corners[a, 3], corners[b, 3], corners[c, 3]
        # Each corner's edge function: its slopes over x and y, and its value in the middle of the picture.
        ex, ey, ez = by * cw - bw * cy, bw * cx - bx * cw, bx * cy - by * cx
        fx, fy, fz = cy * aw - cw * ay, cw * ax - cx * aw, cx * ay - cy * ax
        gx, gy, gz = ay * bw - aw * by, aw * bx - ax * bw, ax * by - ay * bx
        for i in range(max(top, spans[t, 0]), min(bottom, spans[t, 1])):
            y = 1.0 - (2.0 * i + 1.0) / rows
            e, f, g = ey * y + ez, fy * y + fz, gy * y + gz
            # Where all three functions have one sign: between the crossings of each.
            for sign in (1.0, -1.0):
                low, high = -1.0, 1.0
                for slope, value in ((sign * ex, sign * e), (sign * fx, sign * f), (sign * gx, sign * g)):
                    if slope > 0.0:
                        low = max(low, -value / slope)
                    elif slope < 0.0:
                        high = min(high, -value / slope)
                    elif value < 0.0:
                        high = -2.0
                if low > high:
                    continue
                first = max(0, math.ceil(0.5 * (low + 1.0) * columns - 0.5))
                last = min(columns - 1, math.floor(0.5 * (high + 1.0) * columns - 0.5))
                for j in range(first, last + 1):
                    x = (2.0 * j + 1.0) / columns - 1.0
                    one, two, three = ex * x + e, fx * x + f, gx * x + g
                    total = one + two + three
                    depth = (one * da + two * db + three * dc) / total if total != 0.0 else 0.0
                    if 0.0 < depth < nearest[i - top, j]:
                        nearest[i - top, j] = depth
                        number[i - top, j] = t
                        weights[i - top, j, 0], weights[i - top, j, 1] = one / total, two / total
