"""What real-time glare does pixel by pixel before and after the convolution.

Pictures come as rows of numbers, (rows, 3 columns): the three channels of a pixel stand side by side. Every
kernel works on the rows from `first` to `last` and lets the interpreter go, so the caller's threads share
rows out.
"""

import numpy as np
from numba import njit


@njit(fastmath=True, cache=True, nogil=True)
def weigh(pixels, weights, first, last, out):  # type: ignore[no-untyped-def]
    """Weigh each pixel's light by its solid angle."""
    for i in range(first, last):
        p, w, o = pixels[i], weights[i], out[i]
        for j in range(len(w)):
            o[3 * j], o[3 * j + 1], o[3 * j + 2] = w[j] * p[3 * j], w[j] * p[3 * j + 1], w[j] * p[3 * j + 2]


@njit(fastmath=True, cache=True, nogil=True, error_model="numpy")
def weigh_above(pixels, weights, luminance, low, high, first, last, out):  # type: ignore[no-untyped-def]
    """Weigh the part of each pixel's light whose luminance lies above a soft knee; its hue stays."""
    middle, bend = (low + high) / 2, np.float32(0.5) / max(high - low, np.float32(1e-30))
    red, green, blue = luminance
    for i in range(first, last):
        p, w, o = pixels[i], weights[i], out[i]
        for j in range(len(w)):
            r, g, b = p[3 * j], p[3 * j + 1], p[3 * j + 2]
            strength = red * r + green * g + blue * b
            over = max(strength - low, np.float32(0))
            above = strength - middle if strength >= high else over * over * bend
            share = w[j] * above / strength if over > 0 else np.float32(0)
            o[3 * j], o[3 * j + 1], o[3 * j + 2] = share * r, share * g, share * b


@njit(fastmath=True, cache=True, nogil=True)
def boxes(pixels, first, last, out):  # type: ignore[no-untyped-def]
    """Average boxes of 2 x 2 pixels; what lies beyond the border is black."""
    rows, wide = pixels.shape
    quarter = np.float32(0.25)
    for i in range(first, last):
        a, b, o = pixels[2 * i], pixels[min(2 * i + 1, rows - 1)], out[i]
        second = quarter if 2 * i + 1 < rows else np.float32(0)
        for j in range(wide // 6):
            for c in range(3):
                at = 6 * j + c
                o[3 * j + c] = quarter * (a[at] + a[at + 3]) + second * (b[at] + b[at + 3])
        if wide % 6:
            for c in range(3):
                o[len(o) - 3 + c] = quarter * a[wide - 3 + c] + second * b[wide - 3 + c]


@njit(cache=True, nogil=True)
def spread_nodes(nodes, along, after, out):  # type: ignore[no-untyped-def]
    """Join values at nodes, (node rows, node columns, 3), by straight lines along the rows."""
    for i in range(len(nodes)):
        for j in range(len(along)):
            for c in range(3):
                a, b = nodes[i, along[j], c], nodes[i, along[j] + 1, c]
                out[i, 3 * j + c] = a + after[j] * (b - a)


@njit(fastmath=True, cache=True, nogil=True)
def widen(low, first, last, out):  # type: ignore[no-untyped-def]
    """Bring rows of boxes of 2 pixels to pixels: 3/4 of the nearest box and 1/4 of the next."""
    near, far = np.float32(0.75), np.float32(0.25)
    end, wide = low.shape[1] - 3, out.shape[1]
    for i in range(first, last):
        a, o = low[i], out[i]
        for k in range(0, end + 3, 3):
            before, behind = max(k - 3, 0), min(k + 3, end)
            for c in range(3):
                o[2 * k + c] = near * a[k + c] + far * a[before + c]
            if 2 * k + 3 < wide:
                for c in range(3):
                    o[2 * k + 3 + c] = near * a[k + c] + far * a[behind + c]


@njit(fastmath=True, cache=True, nogil=True)
def _raise_row(glare, i, row):  # type: ignore[no-untyped-def]
    """Bring rows of boxes of 2 pixels to one row of pixels, likewise."""
    a, b = glare[i // 2], glare[min(max(i // 2 + 2 * (i % 2) - 1, 0), len(glare) - 1)]
    for k in range(len(row)):
        row[k] = np.float32(0.75) * a[k] + np.float32(0.25) * b[k]


@njit(fastmath=True, cache=True, nogil=True)
def take(lit, shares, down, after, glare, first, last, sums):  # type: ignore[no-untyped-def]
    """Multiply light by the share that is taken from it; add up what is taken, and the glare.

    The glare may have half as many rows. Shares are rows at nodes; row i lies at `after[i]` of the way from
    node `down[i]` to the next. Sums are (2, 3 columns): a number for each column, of the rows from `first` to
    `last`.
    """
    row = np.empty(glare.shape[1], np.float32)
    taken, found = sums[0], sums[1]
    taken[:], found[:] = 0, 0
    for i in range(first, last):
        light, a, b, t = lit[i], shares[down[i]], shares[down[i] + 1], after[i]
        for k in range(len(light)):
            value = light[k] * (a[k] + t * (b[k] - a[k]))
            light[k] = value
            taken[k] += value
        if len(glare) < len(lit):
            _raise_row(glare, i, row)
            for k in range(len(light)):
                found[k] += row[k]
        else:
            g = glare[i]
            for k in range(len(light)):
                found[k] += g[k]


@njit(fastmath=True, cache=True, nogil=True)
def _lay_row(p, taken, g, less, more, dimming, o):  # type: ignore[no-untyped-def]
    for k in range(len(o)):
        o[k] = dimming * (p[k] - less[k] * taken[k] + more[k] * g[k])


@njit(fastmath=True, cache=True, nogil=True)
def lay(pixels, taken, glare, less, more, dimming, first, last, out):  # type: ignore[no-untyped-def]
    """Take from the pixels what was taken, add the glare, and dim both; factors are given for each column."""
    row = np.empty(glare.shape[1], np.float32)
    for i in range(first, last):
        if len(glare) < len(out):
            _raise_row(glare, i, row)
            _lay_row(pixels[i], taken[i], row, less, more, dimming, out[i])
        else:
            _lay_row(pixels[i], taken[i], glare[i], less, more, dimming, out[i])
