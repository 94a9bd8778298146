"""Light from all around, sampled in the frame of a flat sample, and laid on a plane of direction cosines.

A sample of the light is a direction, as its cosines along tangent and bitangent, and an energy: radiance
times solid angle times the cosine to the normal, in three channels.
"""

from math import cos, pi, sin, sqrt

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def sample_rows(radiance, first, parts, frame, places, energies):  # type: ignore[no-untyped-def]
    """Sample rows of a latitude-longitude picture by parts² directions a pixel; return how many are kept.

    `radiance` holds rows of the picture from `first` on, whose whole height is `first[1]`.
    """
    start, height = first
    rows, columns, _ = radiance.shape
    count = 0
    for i in range(rows * parts):
        upper = cos(pi * (start + i / parts) / height)
        lower = cos(pi * (start + (i + 1) / parts) / height)
        y = 0.5 * (upper + lower)
        across = sqrt(max(0.0, 1.0 - y * y))
        solid_angle = (upper - lower) * 2.0 * pi / (columns * parts)
        pixels = radiance[i // parts]
        for j in range(columns):
            if pixels[j, 0] == 0 and pixels[j, 1] == 0 and pixels[j, 2] == 0:
                continue
            for k in range(parts):
                longitude = 2.0 * pi * (j + (k + 0.5) / parts) / columns - pi
                x, z = across * sin(longitude), -across * cos(longitude)
                cosine = frame[2, 0] * x + frame[2, 1] * y + frame[2, 2] * z
                if cosine <= 0.0:
                    continue
                places[count, 0] = frame[0, 0] * x + frame[0, 1] * y + frame[0, 2] * z
                places[count, 1] = frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * z
                for c in range(3):
                    energies[count, c] = pixels[j, c] * solid_angle * cosine
                count += 1
    return count


@njit(cache=True, nogil=True)
def _cubic(t, weights):  # type: ignore[no-untyped-def]
    """Weights of the four samples around a place: they keep sum, mean and spread of what is laid on them."""
    weights[0] = t * (-0.5 + t * (1.0 - 0.5 * t))
    weights[1] = 1.0 + t * t * (-2.5 + 1.5 * t)
    weights[2] = t * (0.5 + t * (2.0 - 1.5 * t))
    weights[3] = t * t * (-0.5 + 0.5 * t)


@njit(cache=True, nogil=True)
def lay_rows(radiance, first, parts, frame, centre, step, plane):  # type: ignore[no-untyped-def]
    """Lay rows of a latitude-longitude picture on a plane whose middle sample is the direction `centre`.

    Each pixel is cut into parts² directions; `radiance` holds rows from `first[0]` on of `first[1]` in all.
    Rows of the plane run against the bitangent.
    """
    start, height = first
    rows, columns, _ = radiance.shape
    across_weights, down_weights = np.empty(4), np.empty(4)
    middle = plane.shape[0] // 2, plane.shape[1] // 2
    # Pixels that lie farther from the plane than they are large are left out whole.
    far = (middle[0] + 2) * step + 2.0 * pi / height, (middle[1] + 2) * step + 2.0 * pi / height
    for i in range(rows * parts):
        upper = cos(pi * (start + i / parts) / height)
        lower = cos(pi * (start + (i + 1) / parts) / height)
        y = 0.5 * (upper + lower)
        across = sqrt(max(0.0, 1.0 - y * y))
        solid_angle = (upper - lower) * 2.0 * pi / (columns * parts)
        pixels = radiance[i // parts]
        for j in range(columns):
            red, green, blue = pixels[j, 0], pixels[j, 1], pixels[j, 2]
            if red == 0 and green == 0 and blue == 0:
                continue
            longitude = 2.0 * pi * (j + 0.5) / columns - pi
            x, z = across * sin(longitude), -across * cos(longitude)
            p = frame[0, 0] * x + frame[0, 1] * y + frame[0, 2] * z - centre[0]
            q = frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * z - centre[1]
            if abs(p) > far[1] or abs(q) > far[0]:
                continue
            for k in range(parts):
                longitude = 2.0 * pi * (j + (k + 0.5) / parts) / columns - pi
                x, z = across * sin(longitude), -across * cos(longitude)
                cosine = frame[2, 0] * x + frame[2, 1] * y + frame[2, 2] * z
                if cosine <= 0.0:
                    continue
                p = frame[0, 0] * x + frame[0, 1] * y + frame[0, 2] * z - centre[0]
                q = frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * z - centre[1]
                right, down = middle[1] + p / step, middle[0] - q / step
                n, m = int(right), int(down)
                if not (1 <= n < plane.shape[1] - 2 and 1 <= m < plane.shape[0] - 2):
                    continue
                _cubic(right - n, across_weights)
                _cubic(down - m, down_weights)
                energy = solid_angle * cosine
                for a in range(4):
                    for b in range(4):
                        share = energy * down_weights[a] * across_weights[b]
                        plane[m - 1 + a, n - 1 + b, 0] += share * red
                        plane[m - 1 + a, n - 1 + b, 1] += share * green
                        plane[m - 1 + a, n - 1 + b, 2] += share * blue
