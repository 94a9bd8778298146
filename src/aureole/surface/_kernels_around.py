"""Light from all around on samples of any shape: blurred copies of the light, and sums of look-ups in them.

A copy is an octahedral map: a direction (x, y, z) over |x| + |y| + |z| = 1 is folded about y onto the square
[−1, 1]², whose n × n samples include its border. Copies lie one after another in `texels`; copy k is blurred
by a Gaussian of σ = `widths[k]` radians and has `sizes[k]`² samples from `starts[k]` on.

Frames are the numbers that `_kernels_cast` describes.
"""

import math

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

ONE, ZERO, HALF = np.float32(1.0), np.float32(0.0), np.float32(0.5)
_LOWEST, _RIM = np.float32(0.05), np.float32(0.9999)


@njit(cache=True, nogil=True, parallel=True)
def blur(radiance: NDArray[np.float32], sigma: float, out: NDArray[np.float32]) -> None:
    """Fill out (n, n, 3) with a latitude-longitude picture's means under a Gaussian on the sphere."""
    rows, columns, _ = radiance.shape
    size = out.shape[0]
    reach, part = min(3.2 * sigma, math.pi), 2.0 * math.pi / columns
    cosines, sines = np.empty(rows), np.empty(rows)
    for row in range(rows):
        cosines[row] = math.sin(math.pi * (row + 0.5) / rows)
        sines[row] = math.cos(math.pi * (row + 0.5) / rows)
    ahead, aside = math.cos(part), math.sin(part)
    for i in prange(size):
        for j in range(size):
            # Unfold the square onto the octahedron, and that onto the sphere.
            u, v = 2.0 * j / (size - 1) - 1.0, 2.0 * i / (size - 1) - 1.0
            y = 1.0 - abs(u) - abs(v)
            if y < 0.0:
                u, v = math.copysign(1.0 - abs(v), u), math.copysign(1.0 - abs(u), v)
            length = math.sqrt(u * u + y * y + v * v)
            sine = y / length
            cosine = math.sqrt(max(0.0, 1.0 - sine * sine))
            latitude, longitude = math.asin(max(-1.0, min(1.0, sine))), math.atan2(u, -v)
            top = max(0, int((0.5 * math.pi - latitude - reach) / math.pi * rows))
            low = min(rows - 1, int((0.5 * math.pi - latitude + reach) / math.pi * rows))
            total, red, green, blue = 0.0, 0.0, 0.0, 0.0
            for row in range(top, low + 1):
                across, along = cosine * cosines[row], sine * sines[row]
                wide = math.pi
                if across > 1e-9:
                    wide = math.acos(max(-1.0, min(1.0, (math.cos(reach) - along) / across)))
                middle = (longitude + math.pi) / (2.0 * math.pi) * columns - 0.5
                half = min(wide / (2.0 * math.pi) * columns, 0.5 * (columns - 1))
                first, last = math.ceil(middle - half), math.floor(middle + half)
                if last < first:
                    first = last = round(middle)
                forth, back = math.cos(part * (first - middle)), math.sin(part * (first - middle))
                for column in range(first, last + 1):
                    near = across * forth + along - 1.0
                    weight = math.exp(near / (sigma * sigma)) * cosines[row]
                    forth, back = forth * ahead - back * aside, back * ahead + forth * aside
                    k = column + columns if column < 0 else column
                    k = k - columns if k >= columns else k
                    total += weight
                    red += weight * radiance[row, k, 0]
                    green += weight * radiance[row, k, 1]
                    blue += weight * radiance[row, k, 2]
            out[i, j, 0], out[i, j, 1], out[i, j, 2] = red / total, green / total, blue / total


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _read(texels, start, size, u, v):  # type: ignore[no-untyped-def]
    """Return a copy's colour at a place of its square."""
    x, y = HALF * (u + ONE) * (size - ONE), HALF * (v + ONE) * (size - ONE)
    j, i = min(max(int(x), 0), int(size) - 2), min(max(int(y), 0), int(size) - 2)
    x, y = x - np.float32(j), y - np.float32(i)
    at = np.uintp(start + i * int(size) + j)
    low = at + np.uintp(size)
    next_at, next_low = at + np.uintp(1), low + np.uintp(1)
    b11 = x * y
    b10, b01 = y - b11, x - b11
    b00 = ONE - x - b10
    return (
        b00 * texels[at, 0] + b01 * texels[next_at, 0] + b10 * texels[low, 0] + b11 * texels[next_low, 0],
        b00 * texels[at, 1] + b01 * texels[next_at, 1] + b10 * texels[low, 1] + b11 * texels[next_low, 1],
        b00 * texels[at, 2] + b01 * texels[next_at, 2] + b10 * texels[low, 2] + b11 * texels[next_low, 2],
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _look(x, y, z, variance, level, texels, copies):  # type: ignore[no-untyped-def]
    """Return the light from a direction, blurred by a Gaussian of a variance: two copies mixed to meet it.

    Copies (K, 3) are where they start, their sizes and variances; none below `level` is wide enough.
    """
    share = ONE / (abs(x) + abs(y) + abs(z))
    u, v = x * share, z * share
    if y < ZERO:
        u, v = math.copysign(ONE - abs(v), u), math.copysign(ONE - abs(u), v)
    last = copies.shape[0] - 1
    while level < last and variance >= copies[level + 1, 2]:
        level += 1
    red, green, blue = _read(texels, int(copies[level, 0]), np.float32(copies[level, 1]), u, v)
    less = copies[level, 2]
    if level < last and variance > less:
        mix = np.float32((variance - less) / (copies[level + 1, 2] - less))
        after = _read(texels, int(copies[level + 1, 0]), np.float32(copies[level + 1, 1]), u, v)
        red, green = red + mix * (after[0] - red), green + mix * (after[1] - green)
        blue += mix * (after[2] - blue)
    return red, green, blue


@njit(cache=True, nogil=True)
def _copies(sizes, starts, widths):  # type: ignore[no-untyped-def]
    """Return what `_look` reads of the copies, together."""
    copies = np.empty((sizes.size, 3))
    for k in range(sizes.size):
        copies[k, 0], copies[k, 1], copies[k, 2] = starts[k], sizes[k], widths[k] * widths[k]
    return copies


@njit(cache=True, nogil=True)
def _level(variance, copies):  # type: ignore[no-untyped-def]
    """Return the widest copy that is no wider than a variance."""
    level = 0
    while level < copies.shape[0] - 1 and variance >= copies[level + 1, 2]:
        level += 1
    return level


@njit(cache=True, nogil=True)
def _axes_of(frames, i, axes):  # type: ignore[no-untyped-def]
    """Fill axes (12, columns): tangent, bitangent, normal, the eye along these (its last 0 if unseen)."""
    for j in range(frames.shape[1]):
        axes[11, j] = 0.0
        if frames[i, j, 0] == 0.0:
            continue
        for k in range(3):
            a, b = (k + 1) % 3, (k + 2) % 3
            axes[k, j], axes[6 + k, j] = frames[i, j, 7 + k], frames[i, j, 4 + k]
            turned = frames[i, j, 4 + a] * frames[i, j, 7 + b] - frames[i, j, 4 + b] * frames[i, j, 7 + a]
            axes[3 + k, j] = frames[i, j, 10] * turned
        for m in range(3):
            axes[9 + m, j] = 0.0
            for k in range(3):
                axes[9 + m, j] += axes[3 * m + k, j] * frames[i, j, 13 + k]


@njit(cache=True, nogil=True)
def _turned(axes, j, x, y, z):  # type: ignore[no-untyped-def]
    """Return a direction along tangent, bitangent and normal as one of the world."""
    return (
        x * axes[0, j] + y * axes[3, j] + z * axes[6, j],
        x * axes[1, j] + y * axes[4, j] + z * axes[7, j],
        x * axes[2, j] + y * axes[5, j] + z * axes[8, j],
    )


@njit(cache=True, nogil=True)
def _mirror(fresnel, cosine, k):  # type: ignore[no-untyped-def]
    """Return F at a cosine between light and half vector."""
    place = min(cosine, 1.0) * (fresnel.shape[0] - 1)
    at = min(int(place), fresnel.shape[0] - 2)
    return fresnel[at, k] + (place - at) * (fresnel[at + 1, k] - fresnel[at, k])


@njit(cache=True, nogil=True, parallel=True)
def diffracted(
    frames: NDArray[np.float32],
    cells: NDArray[np.float32],
    which: NDArray[np.int32],
    texels: NDArray[np.float32],
    sizes: NDArray[np.int64],
    starts: NDArray[np.int64],
    widths: NDArray[np.float64],
    fresnel: NDArray[np.float32],
    stam: bool,
    out: NDArray[np.float32],
) -> None:
    """Fill out (rows, columns, 3): each cell (h_t, h_b, variance, reach, R, G, B) meets its light.

    Cells are (tables, count, 7); `which` (rows, columns) numbers the table of each frame.
    """
    columns, tables = frames.shape[1], cells.shape[0]
    copies = _copies(sizes, starts, widths)
    glossy = fresnel.min() < 1.0 or fresnel.max() > 1.0
    for i in prange(frames.shape[0]):
        axes = np.empty((12, columns), np.float32)
        _axes_of(frames, i, axes)
        seen = np.empty(columns, np.int64)
        count = 0
        for j in range(columns):
            if axes[11, j] > ZERO:
                seen[count] = j
                count += 1
        out[i] = ZERO
        # Neighbours look for the same cell into almost the same direction, which lies in the cache.
        for m in range(tables * cells.shape[1]):
            t, c = m % tables, m // tables
            ht, hb, wide = cells[t, c, 0], cells[t, c, 1], cells[t, c, 2]
            reach = HALF / max(cells[t, c, 3], np.float32(1e-12))
            level = _level(wide, copies)
            for n in range(count):
                j = seen[n]
                ox, oy, oz = axes[9, j], axes[10, j], axes[11, j]
                x, y = ht - ox, hb - oy
                square = x * x + y * y
                above = ONE
                if reach * (math.sqrt(square) - ONE) > -HALF:
                    # Of a cell across the horizon, the part above it counts.
                    radius = math.sqrt(square)
                    above = HALF + reach * (ONE - radius)
                    if radius > _RIM:
                        x, y, square = _RIM * x / radius, _RIM * y / radius, _RIM * _RIM
                if above <= ZERO or which[i, j] != t:
                    continue
                z = math.sqrt(ONE - square)
                ahead, up, aside = _turned(axes, j, x, y, z)
                light = _look(ahead, up, aside, wide / max(z, _LOWEST), level, texels, copies)
                red, green, blue = above * light[0], above * light[1], above * light[2]
                half = math.sqrt(max(HALF * (ONE + x * ox + y * oy + z * oz), ZERO))
                if glossy:
                    red *= _mirror(fresnel, half, 0) ** 2
                    green *= _mirror(fresnel, half, 1) ** 2
                    blue *= _mirror(fresnel, half, 2) ** 2
                if stam:
                    gain = half**4 / (max(z, np.float32(1e-3)) * oz)
                    red, green, blue = red * gain, green * gain, blue * gain
                out[i, j, 0] += cells[t, c, 4] * red
                out[i, j, 1] += cells[t, c, 5] * green
                out[i, j, 2] += cells[t, c, 6] * blue


@njit(cache=True, nogil=True, parallel=True)
def mirrored(
    frames: NDArray[np.float32],
    facets: NDArray[np.float64],
    texels: NDArray[np.float32],
    sizes: NDArray[np.int64],
    starts: NDArray[np.int64],
    widths: NDArray[np.float64],
    fresnel: NDArray[np.float32],
    out: NDArray[np.float32],
) -> None:
    """Fill out (rows, columns, 3) with what facets of slopes (p, q), variance and share (count, 4) reflect.

    Cook and Torrance's lobe: each share of the facets weighs F G (m·ω_o) / ((n·ω_o) (n·m)).
    """
    columns = frames.shape[1]
    copies = _copies(sizes, starts, widths)
    for i in prange(frames.shape[0]):
        axes = np.empty((12, columns), np.float32)
        _axes_of(frames, i, axes)
        out[i] = 0.0
        for m in range(facets.shape[0]):
            mz = 1.0 / math.sqrt(1.0 + facets[m, 0] ** 2 + facets[m, 1] ** 2)
            mx, my = facets[m, 0] * mz, facets[m, 1] * mz
            for j in range(columns):
                ox, oy, oz = axes[9, j], axes[10, j], axes[11, j]
                if oz <= 0.0:
                    continue
                half = min(ox * mx + oy * my + oz * mz, 1.0)
                x, y, z = 2.0 * half * mx - ox, 2.0 * half * my - oy, 2.0 * half * mz - oz
                if half <= 0.0 or z <= 0.0:
                    continue
                toward = _turned(axes, j, x, y, z)
                variance = 2.0 * (1.0 + half * half) * mz**3 * facets[m, 2]
                light = _look(toward[0], toward[1], toward[2], variance, 0, texels, copies)
                weight = facets[m, 3] * min(1.0, 2.0 * mz * min(z, oz) / half) * half / (oz * mz)
                for k in range(3):
                    out[i, j, k] += weight * _mirror(fresnel, half, k) * light[k]
