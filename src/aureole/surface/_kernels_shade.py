"""What a surface reflects from a handful of lamps: diffuse, Cook-Torrance, diffraction from a table.

Frames come in blocks, as `_kernels_cast` describes. A lamp is a row: 0-2 place or direction, 3 is 1 for a
place and 0 for a direction, 4-6 intensity, 7-9 the unit vector it faces (zero: all ways alike), 10 the first
of its tables, 11-13 the intensity's colour as a white surface shows it.

Tables are (T, R, C, 3), regions say which of a lamp's tables a texture pixel has, mask how much of it.
Numbers are diffuse / π (3), the mean weight of Cook-Torrance, the weight of diffraction, roughness, 1/(2σ²)
of the window along tangent and bitangent, whether G is Stam's ratio, the weights of Cook-Torrance (3), and
|h| at the table's border. Fresnel (K, 3) is over the cosine 0..1 between light and half vector.
"""

import math

import numpy as np
from numba import njit

from aureole.surface._kernels_cast import (
    LANES,
    NX,
    NY,
    NZ,
    OX,
    OY,
    OZ,
    PX,
    PY,
    PZ,
    RIGHT,
    SIGN,
    TX,
    TY,
    TZ,
    UP,
)

# Rows of a block of results: light, cosines to lamp and eye, of half the angle between them, h along tangent
# and bitangent, weights of Cook-Torrance and diffraction, places among a table's columns and rows, and room.
LIGHT, NI, NO, HALF_COSINE, HT, HB, LOBE, GAIN, COLUMN, ROW, ROOM, TARGET, ROOT = range(0, 13 * LANES, LANES)
ONE, ZERO, HALF, TWO = np.float32(1.0), np.float32(0.0), np.float32(0.5), np.float32(2.0)
FOUR_PI = np.float32(4.0 * math.pi)
_FAINT = np.float32(30.0)  # e to minus this is nothing
_LEAST = np.float32(1e-30)
NEXT = np.uintp(1)
_BITS = 1065353216  # of 1.0


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _directions(frames, b, lamps, k, w):  # type: ignore[no-untyped-def]
    """Fill a block's light, cosines and h for one lamp."""
    px, py, pz, near = lamps[k, 0], lamps[k, 1], lamps[k, 2], lamps[k, 3]
    fx, fy, fz = lamps[k, 7], lamps[k, 8], lamps[k, 9]
    even = ZERO if fx * fx + fy * fy + fz * fz > ZERO else ONE
    for j in range(LANES):
        ix, iy, iz = (
            px - near * frames[b, PX + j],
            py - near * frames[b, PY + j],
            pz - near * frames[b, PZ + j],
        )
        close = ONE / math.sqrt(ix * ix + iy * iy + iz * iz)
        ix, iy, iz = ix * close, iy * close, iz * close
        nx, ny, nz = frames[b, NX + j], frames[b, NY + j], frames[b, NZ + j]
        tx, ty, tz = frames[b, TX + j], frames[b, TY + j], frames[b, TZ + j]
        ox, oy, oz = frames[b, OX + j], frames[b, OY + j], frames[b, OZ + j]
        hx, hy, hz = ix + ox, iy + oy, iz + oz
        bx, by, bz = ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
        ni, no = nx * ix + ny * iy + nz * iz, nx * ox + ny * oy + nz * oz
        light = ni * (near * close * close + (ONE - near)) * max(even, -(fx * ix + fy * iy + fz * iz))
        w[LIGHT + j] = light if min(ni, no) > ZERO else ZERO
        w[NI + j], w[NO + j] = ni, no
        w[HALF_COSINE + j] = min(HALF * math.sqrt(hx * hx + hy * hy + hz * hz), ONE)
        w[HT + j] = hx * tx + hy * ty + hz * tz
        w[HB + j] = frames[b, SIGN + j] * (hx * bx + hy * by + hz * bz)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _odd_roots(w, power):  # type: ignore[no-untyped-def]
    """Fill a block's ROOT with the odd roots of TARGET, which lies above 0 and at most at 1.

    They start from the exponent's bits divided by the power and take Halley's steps.
    """
    bits = w.view(np.int32)
    inverse = ONE / np.float32(power)
    bias = np.float32(_BITS) - np.float32(_BITS) * inverse
    more, less = np.float32(power + 1), np.float32(power - 1)
    for j in range(LANES):
        bits[ROOT + j] = np.int32(np.float32(bits[TARGET + j]) * inverse + bias)
    for _ in range(2):
        for j in range(LANES):
            w[ROOM + j] = w[ROOT + j]
        for _ in range(power - 1):
            for j in range(LANES):
                w[ROOM + j] *= w[ROOT + j]
        for j in range(LANES):
            here, wanted = w[ROOM + j], w[TARGET + j]
            w[ROOT + j] *= (less * here + more * wanted) / (more * here + less * wanted)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _places(w, half_range, power, rows, columns):  # type: ignore[no-untyped-def]
    """Fill a block's places among a table's samples: columns along the tangent, rows against the bitangent.

    All rows of a block that are read and written have fixed places, so that lanes go together.
    """
    scale = ONE / half_range
    middle = HALF * np.float32(columns - 1)
    for j in range(LANES):
        w[TARGET + j] = w[ROOT + j] = max(min(abs(w[HT + j]) * scale, ONE), _LEAST)
    if power > 1:
        _odd_roots(w, power)
    for j in range(LANES):
        w[COLUMN + j] = middle * (ONE + (w[ROOT + j] if w[HT + j] > ZERO else -w[ROOT + j]))
    middle = HALF * np.float32(rows - 1)
    for j in range(LANES):
        w[TARGET + j] = w[ROOT + j] = max(min(abs(w[HB + j]) * scale, ONE), _LEAST)
    if power > 1:
        _odd_roots(w, power)
    for j in range(LANES):
        w[ROW + j] = middle * (ONE + (w[ROOT + j] if w[HB + j] < ZERO else -w[ROOT + j]))


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _weights(w, numbers):  # type: ignore[no-untyped-def]
    """Fill a block's weights of Cook-Torrance, without its colour, and of the table, without the mask."""
    border, window, stam = numbers[12], numbers[6] + numbers[7], numbers[8]
    for j in range(LANES):
        outside = max(abs(w[HT + j]), abs(w[HB + j])) > border
        w[GAIN + j] = ZERO if outside else numbers[4] * w[LIGHT + j]
        w[LOBE + j] = ZERO
    if window > ZERO:
        for j in range(LANES):
            w[GAIN + j] *= math.exp(
                -(numbers[6] * w[HT + j] * w[HT + j] + numbers[7] * w[HB + j] * w[HB + j])
            )
    if stam > ZERO:
        for j in range(LANES):
            if w[LIGHT + j] > ZERO:
                w[GAIN + j] *= w[HALF_COSINE + j] ** 4 / (w[NI + j] * w[NO + j])
    if numbers[3] > ZERO:
        _cook_torrance(w, numbers[5] * numbers[5])


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _cook_torrance(w, m2):  # type: ignore[no-untyped-def]
    """Fill Beckmann's distribution and the V grooves' shadow over 4 cos cos (Cook and Torrance 1982)."""
    for j in range(LANES):
        nh = HALF * (w[NI + j] + w[NO + j]) / w[HALF_COSINE + j]
        w[ROOM + j] = nh
        c2 = min(nh * nh, ONE)
        w[TARGET + j] = (ONE - c2) / (c2 * m2)
    for j in range(LANES):
        if w[TARGET + j] < _FAINT and w[LIGHT + j] > ZERO:
            ni, no, nh = w[NI + j], w[NO + j], w[ROOM + j]
            shadow = min(ONE, TWO * nh * min(ni, no) / w[HALF_COSINE + j])
            spread = math.exp(-w[TARGET + j]) / (FOUR_PI * m2 * nh * nh * nh * nh)
            w[LOBE + j] = w[LIGHT + j] * spread * shadow / (ni * no)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _pixel(values, right, up):  # type: ignore[no-untyped-def]
    """Return a map's value at texture coordinates, u right and v up."""
    row = min(int((ONE - up) * np.float32(values.shape[0])), values.shape[0] - 1)
    return values[row, min(int(right * np.float32(values.shape[1])), values.shape[1] - 1)]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def shade(frames, where, share, lamps, tables, warp, regions, mask, numbers, fresnel, out):  # type: ignore[no-untyped-def]
    """Add the radiance of frames (B, 17 · 64), times a share, to the pixels `where` (N,) of out (P, 4)."""
    w = np.empty(13 * LANES, np.float32)
    last_row, last_column, last_cosine = tables.shape[1] - 2, tables.shape[2] - 2, fresnel.shape[0] - 2
    maps = mask.size + regions.size > 2
    for k in range(lamps.shape[0]):
        first = int(lamps[k, 10])
        for b in range((where.size + LANES - 1) // LANES):
            _directions(frames, b, lamps, k, w)
            _places(w, numbers[12], warp, tables.shape[1], tables.shape[2])
            _weights(w, numbers)
            for j in range(min(LANES, where.size - b * LANES)):
                if w[LIGHT + j] <= ZERO:
                    continue
                light, lobe, gain = share * w[LIGHT + j], share * w[LOBE + j], share * w[GAIN + j]
                s = np.uintp(first)
                if maps:
                    gain *= _pixel(mask, frames[b, RIGHT + j], frames[b, UP + j])
                    s += np.uintp(_pixel(regions, frames[b, RIGHT + j], frames[b, UP + j]))
                r = np.uintp(min(int(w[ROW + j]), last_row))
                c = np.uintp(min(int(w[COLUMN + j]), last_column))
                y, x = w[ROW + j] - np.float32(r), w[COLUMN + j] - np.float32(c)
                step = w[HALF_COSINE + j] * np.float32(last_cosine + 1)
                cell = np.uintp(min(int(step), last_cosine))
                step -= np.float32(cell)
                pixel = np.uintp(where[b * LANES + j])
                r1, c1, cell1 = r + NEXT, c + NEXT, cell + NEXT
                for m in range(3):
                    above = tables[s, r, c, m] + x * (tables[s, r, c1, m] - tables[s, r, c, m])
                    below = tables[s, r1, c, m] + x * (tables[s, r1, c1, m] - tables[s, r1, c, m])
                    mirror = fresnel[cell, m] + step * (fresnel[cell1, m] - fresnel[cell, m])
                    sheet = lamps[k, 4 + m] * gain * mirror * mirror * (above + y * (below - above))
                    rest = lamps[k, 11 + m] * (numbers[m] * light + numbers[9 + m] * mirror * lobe)
                    out[pixel, m] += sheet + rest
    for n in range(where.size):
        out[where[n], 3] += share
