"""What a surface reflects from a handful of lamps: diffuse, Cook-Torrance, diffraction from a table.

Frames are the rows of numbers that `_kernels_cast` describes. A lamp is a row: 0-2 place or direction, 3 is 1
for a place and 0 for a direction, 4-6 intensity, 7-9 the unit vector it faces (zero: all ways alike).
"""

import math

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

ONE = np.float32(1.0)
ZERO = np.float32(0.0)


@njit(cache=True, fastmath={"contract"}, inline="always")
def _root(x, power):  # type: ignore[no-untyped-def]
    """Take the odd root of 0..1: the exponent's bits divided, then Newton's steps."""
    if power == 1 or x < np.float32(1e-30):
        return x
    bits = np.float32(x).view(np.int32)
    y = np.int32(bits // power + (1065353216 // power) * (power - 1)).view(np.float32)
    inverse = ONE / np.float32(power)
    for _ in range(3):
        below = ONE
        for _ in range(power - 1):
            below *= y
        y += (x / below - y) * inverse
    return y


@njit(cache=True, fastmath={"contract"}, inline="always")
def _place(h, half_range, warp, count):  # type: ignore[no-untyped-def]
    """Return the position among a table's samples along an axis where h = ±half_range at its ends."""
    u = _root(min(abs(h) / half_range, ONE), warp)
    return np.float32(0.5) * np.float32(count - 1) * (ONE + (u if h > ZERO else -u))


@njit(cache=True, fastmath={"contract"}, inline="always")
def _pixel(weights, u, v):  # type: ignore[no-untyped-def]
    """Return the row and column of the pixel of a map that has a texture coordinate, v up."""
    rows, columns = weights.shape
    return min(int((ONE - v) * rows), rows - 1), min(int(u * columns), columns - 1)


@njit(cache=True, fastmath={"contract"}, inline="always")
def _cook_torrance(nh, ni, no, oh, roughness):  # type: ignore[no-untyped-def]
    """Beckmann's distribution and the V-shaped grooves' shadow, over 4 cos cos (Cook and Torrance 1982)."""
    c2, m2 = nh * nh, roughness * roughness
    spread = math.exp(-(ONE - c2) / (c2 * m2)) / (np.float32(math.pi) * m2 * c2 * c2)
    shadow = min(ONE, np.float32(2.0) * nh * min(ni, no) / oh)
    return spread * shadow / (np.float32(4.0) * ni * no)


@njit(cache=True, parallel=True, fastmath={"contract"})
def shade(
    frames: NDArray[np.float32],
    lamps: NDArray[np.float32],
    tables: NDArray[np.float32],
    ranges: NDArray[np.float32],
    warp: int,
    regions: NDArray[np.int32],
    mask: NDArray[np.float32],
    numbers: NDArray[np.float32],
    fresnel: NDArray[np.float32],
    out: NDArray[np.float32],
) -> None:
    """Fill out (rows, columns, 4) with the radiance towards the eye and 1 where a surface is.

    Tables are (T, R, C, 3), regions say which of them a texture pixel has, mask how much of it. Numbers are
    diffuse / π (3), the weights of Cook-Torrance and diffraction, roughness, 1/(2σ²) of the window along
    tangent and bitangent, and how far G goes from 1 (0) to Stam's ratio (1). Fresnel (K, 3) is over the
    cosine 0..1 between light and half vector.
    """
    count_rows, count_columns = tables.shape[1], tables.shape[2]
    half_range = ranges[0]
    for i in prange(frames.shape[0]):
        for j in range(frames.shape[1]):
            f = frames[i, j]
            red = green = blue = ZERO
            if f[0] > ZERO:
                nx, ny, nz, tx, ty, tz = f[4], f[5], f[6], f[7], f[8], f[9]
                sign, ox, oy, oz = f[10], f[13], f[14], f[15]
                bx, by, bz = sign * (ny * tz - nz * ty), sign * (nz * tx - nx * tz), sign * (nx * ty - ny * tx)
                no = nx * ox + ny * oy + nz * oz
                row, column = _pixel(regions, f[11], f[12])
                sheet = tables[regions[row, column]]
                row, column = _pixel(mask, f[11], f[12])
                strength = mask[row, column] * numbers[4]
                for k in range(lamps.shape[0]):
                    lamp = lamps[k]
                    ix, iy, iz = lamp[0] - lamp[3] * f[1], lamp[1] - lamp[3] * f[2], lamp[2] - lamp[3] * f[3]
                    near = ONE / math.sqrt(ix * ix + iy * iy + iz * iz)
                    ix, iy, iz = ix * near, iy * near, iz * near
                    ni = nx * ix + ny * iy + nz * iz
                    if ni <= ZERO or no <= ZERO:
                        continue
                    light = ni * (near * near * lamp[3] + (ONE - lamp[3]))
                    facing = lamp[7] * lamp[7] + lamp[8] * lamp[8] + lamp[9] * lamp[9]
                    if facing > ZERO:
                        light *= max(ZERO, -(lamp[7] * ix + lamp[8] * iy + lamp[9] * iz))
                    hx, hy, hz = ix + ox, iy + oy, iz + oz
                    length = math.sqrt(hx * hx + hy * hy + hz * hz)
                    oh = np.float32(0.5) * length  # the cosine between either direction and the half vector
                    step = min(oh, ONE) * np.float32(fresnel.shape[0] - 1)
                    cell = min(int(step), fresnel.shape[0] - 2)
                    step -= np.float32(cell)
                    lobe = ZERO
                    if numbers[3] > ZERO:
                        nh = (nx * hx + ny * hy + nz * hz) / length
                        lobe = numbers[3] * _cook_torrance(nh, ni, no, oh, numbers[5])
                    sx = sy = sz = ZERO
                    ht, hb = hx * tx + hy * ty + hz * tz, hx * bx + hy * by + hz * bz
                    if strength > ZERO and abs(ht) <= half_range and abs(hb) <= half_range:
                        x = _place(ht, half_range, warp, count_columns)
                        y = _place(-hb, half_range, warp, count_rows)
                        c, r = min(int(x), count_columns - 2), min(int(y), count_rows - 2)
                        x, y = x - np.float32(c), y - np.float32(r)
                        gain = strength
                        if numbers[6] + numbers[7] > ZERO:
                            gain *= math.exp(-(numbers[6] * ht * ht + numbers[7] * hb * hb))
                        if numbers[8] > ZERO:
                            gain *= oh * oh * oh * oh / (ni * no)
                        a, b = gain * (ONE - x) * (ONE - y), gain * x * (ONE - y)
                        d, e = gain * (ONE - x) * y, gain * x * y
                        p, q = sheet[r], sheet[r + 1]
                        sx = a * p[c, 0] + b * p[c + 1, 0] + d * q[c, 0] + e * q[c + 1, 0]
                        sy = a * p[c, 1] + b * p[c + 1, 1] + d * q[c, 1] + e * q[c + 1, 1]
                        sz = a * p[c, 2] + b * p[c + 1, 2] + d * q[c, 2] + e * q[c + 1, 2]
                    w = ONE - step
                    fr = w * fresnel[cell, 0] + step * fresnel[cell + 1, 0]
                    fg = w * fresnel[cell, 1] + step * fresnel[cell + 1, 1]
                    fb = w * fresnel[cell, 2] + step * fresnel[cell + 1, 2]
                    red += light * lamp[4] * (numbers[0] + fr * (lobe + fr * sx))
                    green += light * lamp[5] * (numbers[1] + fg * (lobe + fg * sy))
                    blue += light * lamp[6] * (numbers[2] + fb * (lobe + fb * sz))
            out[i, j, 0], out[i, j, 1], out[i, j, 2] = red, green, blue
            out[i, j, 3] = ONE if f[0] > ZERO else ZERO
