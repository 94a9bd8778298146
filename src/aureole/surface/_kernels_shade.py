"""What a surface reflects from a handful of lamps: diffuse, Cook-Torrance, diffraction from a table.

Frames are the numbers that `_kernels_cast` describes. A lamp is a row: 0-2 place or direction, 3 is 1 for a
place and 0 for a direction, 4-6 intensity, 7-9 the unit vector it faces (zero: all ways alike).

Tables are (T, R, C, 3), regions say which of them a texture pixel has, mask how much of it. Numbers are
diffuse / π (3), the weights of Cook-Torrance and diffraction, roughness, 1/(2σ²) of the window along tangent
and bitangent, whether G is Stam's ratio, and |h| at the table's border. Fresnel (K, 3) is over the cosine
0..1 between light and half vector.
"""

import math

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from aureole.surface._kernels_cast import WIDTH, cast_row

ONE = np.float32(1.0)
ZERO = np.float32(0.0)
HALF = np.float32(0.5)
_LEAST = np.float32(1e-30)
_BITS = 1065353216  # of 1.0


@njit(cache=True, fastmath={"contract"})
def _places(h, sign, half_range, power, size, work, place):  # type: ignore[no-untyped-def]
    """Fill the places among a table's samples along an axis, whose ends are sign · h = ±half_range.

    The odd root of |h| / half_range starts from the exponent's bits divided and takes Newton's steps.
    """
    count = h.size
    inverse, bias = ONE / np.float32(power), np.float32(_BITS) - np.float32(_BITS) / np.float32(power)
    for j in range(count):
        place[j] = max(min(abs(h[j]) / half_range, ONE), _LEAST)
    if power > 1:
        start = place.view(np.int32)
        for j in range(count):
            work[1, j] = place[j]
            start[j] = np.int32(np.float32(start[j]) * inverse + bias)
        for _ in range(3):
            for j in range(count):
                work[0, j] = place[j]
            for _ in range(power - 2):
                for j in range(count):
                    work[0, j] *= place[j]
            for j in range(count):
                place[j] += (work[1, j] / work[0, j] - place[j]) * inverse
    for j in range(count):
        place[j] = HALF * np.float32(size - 1) * (ONE + (place[j] if sign * h[j] > ZERO else -place[j]))


@njit(cache=True, fastmath={"contract"})
def _directions(f, count, lamp, along):  # type: ignore[no-untyped-def]
    """Fill along (6, count): irradiance, cosines to lamp and eye, h·t, h·b, the half vector's cosine."""
    px, py, pz, near = lamp[0], lamp[1], lamp[2], lamp[3]
    facing = lamp[7] * lamp[7] + lamp[8] * lamp[8] + lamp[9] * lamp[9] > ZERO
    for j in range(count):
        ix, iy, iz = px - near * f[1, j], py - near * f[2, j], pz - near * f[3, j]
        close = ONE / math.sqrt(ix * ix + iy * iy + iz * iz)
        ix, iy, iz = ix * close, iy * close, iz * close
        nx, ny, nz, tx, ty, tz = f[4, j], f[5, j], f[6, j], f[7, j], f[8, j], f[9, j]
        ox, oy, oz = f[13, j], f[14, j], f[15, j]
        hx, hy, hz = ix + ox, iy + oy, iz + oz
        bx, by, bz = ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
        ni, no = nx * ix + ny * iy + nz * iz, nx * ox + ny * oy + nz * oz
        lit = ni * (near * close * close + (ONE - near))
        toward = max(ZERO, -(lamp[7] * ix + lamp[8] * iy + lamp[9] * iz)) if facing else ONE
        along[0, j] = lit * toward if ni > ZERO and no > ZERO else ZERO
        along[1, j], along[2, j] = ni, no
        along[3, j] = hx * tx + hy * ty + hz * tz
        along[4, j] = f[10, j] * (hx * bx + hy * by + hz * bz)
        along[5, j] = min(HALF * math.sqrt(hx * hx + hy * hy + hz * hz), ONE)


@njit(cache=True, fastmath={"contract"})
def _cook_torrance(ni, no, oh, roughness):  # type: ignore[no-untyped-def]
    """Beckmann's distribution and the V-shaped grooves' shadow, over 4 cos cos (Cook and Torrance 1982)."""
    nh = min(HALF * (ni + no) / oh, ONE)
    c2, m2 = nh * nh, roughness * roughness
    spread = math.exp(-(ONE - c2) / (c2 * m2)) / (np.float32(math.pi) * m2 * c2 * c2)
    shadow = min(ONE, np.float32(2.0) * nh * min(ni, no) / oh)
    return spread * shadow / (np.float32(4.0) * ni * no)


@njit(cache=True, fastmath={"contract"})
def _gain(ht, hb, ni, no, oh, numbers):  # type: ignore[no-untyped-def]
    """What multiplies a table's value besides F²: its weight, the window, G."""
    gain = numbers[4]
    if abs(ht) > numbers[9] or abs(hb) > numbers[9]:
        return ZERO
    if numbers[6] + numbers[7] > ZERO:
        gain *= math.exp(-(numbers[6] * ht * ht + numbers[7] * hb * hb))
    if numbers[8] > ZERO:
        gain *= oh * oh * oh * oh / (ni * no)
    return gain


@njit(cache=True, fastmath={"contract"})
def shade_row(f, count, lamps, tables, warp, regions, mask, numbers, fresnel, drawn):  # type: ignore[no-untyped-def]
    """Fill drawn (3, columns) with the radiance of the first `count` frames of f (17, columns)."""
    along, work = np.empty((6, count), np.float32), np.empty((2, count), np.float32)
    columns, rows = np.empty(count, np.float32), np.empty(count, np.float32)
    drawn[:, :count] = ZERO
    last_row, last_column = tables.shape[1] - 2, tables.shape[2] - 2
    for k in range(lamps.shape[0]):
        _directions(f, count, lamps[k], along)
        _places(along[3], ONE, numbers[9], warp, tables.shape[2], work, columns)
        _places(along[4], -ONE, numbers[9], warp, tables.shape[1], work, rows)
        for j in range(count):
            light, ni, no, oh = along[0, j], along[1, j], along[2, j], along[5, j]
            if light <= ZERO:
                continue
            up, right = ONE - f[12, j], f[11, j]
            strength = mask[
                min(int(up * mask.shape[0]), mask.shape[0] - 1),
                min(int(right * mask.shape[1]), mask.shape[1] - 1),
            ]
            s = regions[
                min(int(up * regions.shape[0]), regions.shape[0] - 1),
                min(int(right * regions.shape[1]), regions.shape[1] - 1),
            ]
            lobe = numbers[3] * _cook_torrance(ni, no, oh, numbers[5]) if numbers[3] > ZERO else ZERO
            gain = strength * _gain(along[3, j], along[4, j], ni, no, oh, numbers)
            step = oh * np.float32(fresnel.shape[0] - 1)
            cell = min(int(step), fresnel.shape[0] - 2)
            step -= np.float32(cell)
            r, c = min(int(rows[j]), last_row), min(int(columns[j]), last_column)
            y, x = rows[j] - np.float32(r), columns[j] - np.float32(c)
            for m in range(3):
                above = tables[s, r, c, m] + x * (tables[s, r, c + 1, m] - tables[s, r, c, m])
                below = tables[s, r + 1, c, m] + x * (tables[s, r + 1, c + 1, m] - tables[s, r + 1, c, m])
                mirror = fresnel[cell, m] + step * (fresnel[cell + 1, m] - fresnel[cell, m])
                sheet = gain * (above + y * (below - above))
                drawn[m, j] += light * lamps[k, 4 + m] * (numbers[m] + mirror * (lobe + mirror * sheet))


@njit(cache=True, parallel=True)
def shade(
    frames: NDArray[np.float32],
    lamps: NDArray[np.float32],
    tables: NDArray[np.float32],
    warp: int,
    regions: NDArray[np.int32],
    mask: NDArray[np.float32],
    numbers: NDArray[np.float32],
    fresnel: NDArray[np.float32],
    out: NDArray[np.float32],
) -> None:
    """Fill out (rows, columns, 4) from frames (rows, columns, 17): radiance, and 1 on a surface."""
    columns = frames.shape[1]
    for i in prange(frames.shape[0]):
        found, where = np.empty((WIDTH, columns), np.float32), np.empty(columns, np.int64)
        drawn = np.empty((3, columns), np.float32)
        count = 0
        for j in range(columns):
            if frames[i, j, 0] > ZERO:
                where[count] = j
                for k in range(WIDTH):
                    found[k, count] = frames[i, j, k]
                count += 1
        shade_row(found, count, lamps, tables, warp, regions, mask, numbers, fresnel, drawn)
        out[i] = ZERO
        for m in range(count):
            out[i, where[m], 3] = ONE
            for k in range(3):
                out[i, where[m], k] = drawn[k, m]


@njit(cache=True, parallel=True)
def draw(
    kind: int,
    shape: NDArray[np.float64],
    pose: NDArray[np.float64],
    rays: NDArray[np.float64],
    samples: int,
    lamps: NDArray[np.float32],
    tables: NDArray[np.float32],
    warp: int,
    regions: NDArray[np.int32],
    mask: NDArray[np.float32],
    numbers: NDArray[np.float32],
    fresnel: NDArray[np.float32],
    span: NDArray[np.int64],
    out: NDArray[np.float32],
) -> None:
    """Cast and shade a picture's rows from span[0] to span[1] of out (rows, columns, 4), samples² a pixel."""
    columns = out.shape[1] * samples
    share = ONE / np.float32(samples * samples)
    for i in prange(span[0], span[1]):
        found, where = np.empty((WIDTH, columns), np.float32), np.empty(columns, np.int64)
        drawn = np.empty((3, columns), np.float32)
        out[i] = ZERO
        for part in range(samples):
            y = 1.0 - (2.0 * (i * samples + part) + 1.0) / (out.shape[0] * samples)
            count = cast_row(kind, shape, pose, rays, y, columns, found, where)
            shade_row(found, count, lamps, tables, warp, regions, mask, numbers, fresnel, drawn)
            for m in range(count):
                j = where[m] // samples
                out[i, j, 3] += share
                for k in range(3):
                    out[i, j, k] += share * drawn[k, m]
