"""Light from all around summed over directions, or along the borders of its pixels: what is held to be right.

Along a border the direction cosines are x(t) = c + a cos t + b sin t and y(t) alike. The light that a pixel
of even radiance sends is its radiance times the table's integral over the pixel, which is the integral
along its border of P dy, with P the table's own integral along x, known exactly.
"""

import math

import numpy as np
from numba import njit, prange


@njit(cache=True, nogil=True)
def _place(h, half_range, inverse_warp, count):  # type: ignore[no-untyped-def]
    """Where a component of h lies among the table's samples, which are even in u with h = half_range uⁿ."""
    ratio = min(abs(h) / half_range, 1.0)
    u = ratio**inverse_warp
    return 0.5 * (count - 1) * (1.0 + (u if h >= 0 else -u))


@njit(cache=True, nogil=True, parallel=True)
def add_samples(views, places, energies, count, values, half_range, inverse_warp, total):  # type: ignore[no-untyped-def]
    """Add the table's value at each sample's and view's h, times its energy, to each view's total."""
    rows, columns, _ = values.shape
    for v in prange(views.shape[0]):
        red, green, blue = 0.0, 0.0, 0.0
        for p in range(count):
            if abs(places[p, 0] + views[v, 0]) > half_range or abs(places[p, 1] + views[v, 1]) > half_range:
                continue
            x = _place(places[p, 0] + views[v, 0], half_range, inverse_warp, columns)
            y = rows - 1 - _place(places[p, 1] + views[v, 1], half_range, inverse_warp, rows)
            j, i = min(int(x), columns - 2), min(int(y), rows - 2)
            right, down = x - j, y - i
            a, b = (1.0 - down) * (1.0 - right), (1.0 - down) * right
            c, d = down * (1.0 - right), down * right
            upper, lower = values[i], values[i + 1]
            red += energies[p, 0] * (
                a * upper[j, 0] + b * upper[j + 1, 0] + c * lower[j, 0] + d * lower[j + 1, 0]
            )
            green += energies[p, 1] * (
                a * upper[j, 1] + b * upper[j + 1, 1] + c * lower[j, 1] + d * lower[j + 1, 1]
            )
            blue += energies[p, 2] * (
                a * upper[j, 2] + b * upper[j + 1, 2] + c * lower[j, 2] + d * lower[j + 1, 2]
            )
        total[v, 0] += red
        total[v, 1] += green
        total[v, 2] += blue


@njit(cache=True, nogil=True)
def _root(h, half_range, inverse_warp):  # type: ignore[no-untyped-def]
    """u of h = half_range uⁿ."""
    u = min(abs(h) / half_range, 1.0) ** inverse_warp
    return u if h >= 0.0 else -u


@njit(cache=True, nogil=True)
def _cell(h, nodes, half_range, inverse_warp):  # type: ignore[no-untyped-def]
    """Number of nodes at or below h, less 1: −1 below all of them."""
    if h < nodes[0]:
        return -1
    last = nodes.size - 1
    j = min(max(int(0.5 * (last) * (1.0 + _root(h, half_range, inverse_warp))), 0), last)
    while j < last and nodes[j + 1] <= h:
        j += 1
    while nodes[j] > h:
        j -= 1
    return j


@njit(cache=True, nogil=True)
def _crossing(node, centre, radius, phase, t, rises):  # type: ignore[no-untyped-def]
    """The t where centre + radius cos(t − phase) meets a node, rising or falling, on the half turn near t."""
    angle = math.acos(max(-1.0, min(1.0, (node - centre) / radius)))
    whole = 2.0 * math.pi
    angle = phase - angle if rises else phase + angle
    return angle + whole * round((t - angle) / whole)


@njit(cache=True, nogil=True)
def _add_piece(x, y, i, j, nodes_x, nodes_y, values, sums, numbers, scale, share):  # type: ignore[no-untyped-def]
    """Add scale · P(x, y) to share (3,), x between nodes j and j + 1, y between nodes i and i + 1."""
    if i < 0 or i >= nodes_y.size - 1 or j < 0:
        return
    half_range, inverse_warp, warp = numbers[0], numbers[1], numbers[2]
    gap_y, gap_x = 2.0 / (nodes_y.size - 1), 2.0 / (nodes_x.size - 1)
    up = min(max((_root(y, half_range, inverse_warp) + 1.0) / gap_y - i, 0.0), 1.0)
    if j >= nodes_x.size - 1:
        for k in range(3):
            share[k] += scale * ((1.0 - up) * sums[i, j, k] + up * sums[i + 1, j, k])
        return
    u, before = _root(x, half_range, inverse_warp), gap_x * j - 1.0
    length = x - nodes_x[j]
    moment = half_range * warp / (warp + 1.0) * (u ** (warp + 1.0) - before ** (warp + 1.0))
    right = (moment - before * length) / gap_x
    left = length - right
    for k in range(3):
        low = sums[i, j, k] + left * values[i, j, k] + right * values[i, j + 1, k]
        high = sums[i + 1, j, k] + left * values[i + 1, j, k] + right * values[i + 1, j + 1, k]
        share[k] += scale * (low + up * (high - low))


@njit(cache=True, nogil=True, parallel=True)
def add_borders(views, borders, nodes_x, nodes_y, values, sums, numbers, points, weights, total):  # type: ignore[no-untyped-def]
    """Add the integral of P dy along borders (N, 11), times what they separate, to each view's total.

    A border is c, a, b of x, the same of y, its first and last t, and three channels; x and y do not turn
    back on it. It is cut wherever it crosses a node of the table; `points` and `weights` are Gauss's on each
    piece. Numbers are half range, 1 / warp, warp. Rows of values and sums rise with y.
    """
    for v in prange(views.shape[0]):
        share = np.empty(3)
        for e in range(borders.shape[0]):
            cx, ax, bx = borders[e, 0], borders[e, 1], borders[e, 2]
            cy, ay, by = borders[e, 3], borders[e, 4], borders[e, 5]
            t, end = borders[e, 6], borders[e, 7]
            cx, cy = cx + views[v, 0], cy + views[v, 1]
            rx, ry = math.hypot(ax, bx), math.hypot(ay, by)
            px, py = math.atan2(bx, ax), math.atan2(by, ay)
            middle = 0.5 * (t + end)
            right, up = -math.sin(middle - px) > 0.0, -math.sin(middle - py) > 0.0
            j = _cell(cx + rx * math.cos(t - px), nodes_x, numbers[0], numbers[1])
            i = _cell(cy + ry * math.cos(t - py), nodes_y, numbers[0], numbers[1])
            share[:] = 0.0
            after_x = after_y = -math.inf
            while t < end:
                # The next node along x and along y; beyond the last one there is none.
                if after_x == -math.inf:
                    n = j + 1 if right else j
                    after_x = math.inf
                    if rx > 1e-15 and 0 <= n < nodes_x.size and abs(nodes_x[n] - cx) <= rx:
                        after_x = max(_crossing(nodes_x[n], cx, rx, px, middle, right), t)
                if after_y == -math.inf:
                    n = i + 1 if up else i
                    after_y = math.inf
                    if ry > 1e-15 and 0 <= n < nodes_y.size and abs(nodes_y[n] - cy) <= ry:
                        after_y = max(_crossing(nodes_y[n], cy, ry, py, middle, up), t)
                stop = min(after_x, after_y, end)
                for g in range(points.size):
                    s = t + points[g] * (stop - t)
                    scale = -weights[g] * (stop - t) * ry * math.sin(s - py)
                    x, y = cx + rx * math.cos(s - px), cy + ry * math.cos(s - py)
                    _add_piece(x, y, i, j, nodes_x, nodes_y, values, sums, numbers, scale, share)
                if stop == after_x:
                    j += 1 if right else -1
                    after_x = -math.inf
                if stop == after_y:
                    i += 1 if up else -1
                    after_y = -math.inf
                t = stop
            for k in range(3):
                total[v, k] += borders[e, 8 + k] * share[k]
