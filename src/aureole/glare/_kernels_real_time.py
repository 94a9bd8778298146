"""What real-time glare does pixel by pixel before and after the convolution.

Pixels are (row, column, 3). The share of a pixel's light that is taken is given at nodes that crowd towards
the frame's borders, (node row, node column, 3), and is joined by straight lines: pixel j lies at `after[j]`
of the way from node `node[j]` to the next.

Every kernel works on some rows and lets the interpreter go, so the caller's threads share rows out.
"""

import numpy as np
from numba import njit


@njit(fastmath=True, cache=True, nogil=True)
def weigh(pixels, weights, first, last, out):  # type: ignore[no-untyped-def]
    """Weigh each pixel's light by its solid angle."""
    for i in range(first, last):
        for j in range(pixels.shape[1]):
            w = weights[i, j]
            for c in range(3):
                out[i, j, c] = w * pixels[i, j, c]


@njit(fastmath=True, cache=True, nogil=True)
def weigh_above(pixels, weights, luminance, low, high, first, last, out):  # type: ignore[no-untyped-def]
    """Weigh the part of each pixel's light whose luminance lies above a soft knee; its hue stays."""
    width, middle = high - low, (low + high) / 2
    for i in range(first, last):
        for j in range(pixels.shape[1]):
            p = pixels[i, j]
            strength = luminance[0] * p[0] + luminance[1] * p[1] + luminance[2] * p[2]
            above = np.float32(0)
            if strength >= high:
                above = strength - middle
            elif strength > low:
                above = (strength - low) ** 2 / (2 * width)
            share = weights[i, j] * above / strength if above > 0 else np.float32(0)
            for c in range(3):
                out[i, j, c] = share * p[c]


@njit(fastmath=True, cache=True, nogil=True)
def boxes(pixels, first, last, out):  # type: ignore[no-untyped-def]
    """Average boxes of 2 x 2 pixels; what lies beyond the border is black."""
    rows, columns = pixels.shape[:2]
    for i in range(first, last):
        a = pixels[2 * i]
        b = pixels[min(2 * i + 1, rows - 1)]
        second = np.float32(0.25) if 2 * i + 1 < rows else np.float32(0)
        for j in range(columns // 2):
            for c in range(3):
                out[i, j, c] = np.float32(0.25) * (a[2 * j, c] + a[2 * j + 1, c]) + second * (
                    b[2 * j, c] + b[2 * j + 1, c]
                )
        if columns % 2:
            for c in range(3):
                out[i, columns // 2, c] = np.float32(0.25) * a[columns - 1, c] + second * b[columns - 1, c]


@njit(fastmath=True, cache=True, nogil=True)
def _node_row(nodes, node, after, i, row):  # type: ignore[no-untyped-def]
    a, b, t = nodes[node[i]], nodes[node[i] + 1], after[i]
    for k in range(nodes.shape[1]):
        for c in range(3):
            row[k, c] = a[k, c] + t * (b[k, c] - a[k, c])


@njit(fastmath=True, cache=True, nogil=True)
def _glare_row(glare, i, step, row):  # type: ignore[no-untyped-def]
    """Read one row of the glare, or bring it up from boxes: 3/4 of the nearest and 1/4 of the next."""
    columns = row.shape[0]
    if step == 1:
        for j in range(columns):
            for c in range(3):
                row[j, c] = glare[i, j, c]
        return
    near, high, wide = np.float32(0.75), glare.shape[0], glare.shape[1]
    a = glare[i // 2]
    b = glare[min(max(i // 2 + 2 * (i % 2) - 1, 0), high - 1)]
    far = np.float32(1) - near
    for k in range(wide):
        before, behind = max(k - 1, 0), min(k + 1, wide - 1)
        for c in range(3):
            middle = near * (near * a[k, c] + far * b[k, c])
            row[2 * k, c] = middle + far * (near * a[before, c] + far * b[before, c])
            if 2 * k + 1 < columns:
                row[2 * k + 1, c] = middle + far * (near * a[behind, c] + far * b[behind, c])


@njit(fastmath=True, cache=True, nogil=True)
def take(lit, nodes, down, down_after, along, along_after, glare, step, first, last, sums):  # type: ignore[no-untyped-def]
    """Multiply light by the share that is taken from it; add up, row by row, what is taken and the glare."""
    columns = lit.shape[1]
    shares = np.empty((nodes.shape[1], 3), np.float32)
    row = np.empty((columns, 3), np.float32)
    for i in range(first, last):
        _node_row(nodes, down, down_after, i, shares)
        _glare_row(glare, i, step, row)
        for c in range(3):
            taken, found = np.float32(0), np.float32(0)
            for j in range(columns):
                a, b = shares[along[j], c], shares[along[j] + 1, c]
                value = lit[i, j, c] * (a + along_after[j] * (b - a))
                lit[i, j, c] = value
                taken += value
                found += row[j, c]
            sums[i, 0, c], sums[i, 1, c] = taken, found


@njit(fastmath=True, cache=True, nogil=True)
def lay(pixels, taken, glare, step, less, more, dimming, first, last, out):  # type: ignore[no-untyped-def]
    """Take from the pixels what was taken, add the glare, and dim both."""
    columns = pixels.shape[1]
    row = np.empty((columns, 3), np.float32)
    for i in range(first, last):
        _glare_row(glare, i, step, row)
        for j in range(columns):
            for c in range(3):
                out[i, j, c] = dimming * (pixels[i, j, c] - less[c] * taken[i, j, c] + more[c] * row[j, c])
