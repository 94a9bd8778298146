"""Compiled loop of the aperture room: coverage of pixels by radial gratings."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

# A slope of an edge, as part of the pixel's side, below which the edge counts as parallel to it.
PARALLEL = 1e-3
# From a pixel's centre to its corner.
CORNER = 0.7072
# atan(t) / t in powers of t², from its Chebyshev interpolation on 0..1: within 1e-8 radians.
ARC_TANGENT = (
    0.9999999817886542,
    -0.33333036709275093,
    0.19991872028914512,
    -0.14197797792667383,
    0.10618370631665379,
    -0.07456854815050179,
    0.04213762346183295,
    -0.015731249044452084,
    0.0027662834823881997,
)


@numba.njit(cache=True, nogil=True)
def cover_gratings(
    counts: NDArray[np.float64],
    phases: NDArray[np.float64],
    radii: NDArray[np.float64],
    reach: float,
    pixels: NDArray[np.float32],
    first: int,
    last: int,
) -> None:
    """Add the part of each pixel that the bars of radial gratings cover.

    Bar and gap are equally broad; a pixel is so small against the radius that a border's edge is
    straight and the bars' edges parallel.

    Parameters
    ----------
    counts : ndarray of float64, shape (S,)
        Bars of each ring about the middle of the pixels.
    phases : ndarray, shape (S,)
        Periods by which a ring's bars are turned counter-clockwise from +x as seen.
    radii : ndarray, shape (S + 1,)
        Rising borders of the rings, pixels.
    reach : float
        Pixels whose centre is farther away are left as they are.
    pixels : ndarray of float32, shape (rows, columns)
        Added to in place, where rings lie.
    first, last : int
        Rows first..last − 1 are served, so that threads can share the work.
    """
    rows, columns = pixels.shape
    for row in range(first, last):
        y = row + 0.5 - rows / 2
        for ring in range(len(counts)):
            count, phase, inner, outer = counts[ring], phases[ring], radii[ring], radii[ring + 1]
            # Where the row enters the ring, lies wholly in it, and leaves it, from its middle outward.
            start = _half_chord(max(inner - CORNER, 1.0), y)
            wholly = max(start, _half_chord(min(inner + CORNER, reach), y))
            leaving = max(wholly, _half_chord(min(outer - CORNER, reach), y))
            end = max(leaving, _half_chord(min(outer + CORNER, reach), y))
            for low, high, crossed in ((start, wholly, True), (wholly, leaving, False), (leaving, end, True)):
                left, right = math.ceil(columns / 2 + low - 0.5), math.ceil(columns / 2 + high - 0.5)
                _add(count, phase, inner, outer, crossed, y, max(left, 0), min(right, columns), pixels[row])
                # At an odd number of columns the middle one is the right half's.
                left, right = columns - right, min(columns - left, columns // 2)
                _add(count, phase, inner, outer, crossed, y, max(left, 0), min(right, columns), pixels[row])


@numba.njit(cache=True, error_model="numpy", fastmath=True)
def _half_chord(radius: float, y: float) -> float:
    return math.sqrt(max(radius * radius - y * y, 0.0))


@numba.njit(cache=True, error_model="numpy", fastmath=True)
def _add(
    count: float,
    phase: float,
    inner: float,
    outer: float,
    crossed: bool,
    y: float,
    left: int,
    right: int,
    pixels: NDArray[np.float32],
) -> None:
    """Add the bars' part of the pixels left..right − 1 of a row."""
    start = left + 0.5 - len(pixels) / 2
    row = pixels[left : max(left, right)]
    for column in range(len(row)):
        x = start + column
        radius = math.sqrt(x * x + y * y)
        cosine, sine = max(abs(x) / radius, PARALLEL), max(abs(y) / radius, PARALLEL)
        # Across the bars a pixel is a trapezoid with corners at these distances, in periods.
        periods = count / (2 * math.pi * radius)
        wide, narrow = (cosine + sine) / 2 * periods, (cosine - sine) / 2 * periods
        at = count * _turn(x, -y) - phase
        bend = _twice(at + wide) + _twice(at - wide) - _twice(at + narrow) - _twice(at - narrow)
        covered = 0.5 + bend / (cosine * sine * periods * periods)
        if crossed:
            covered *= 1 - _beyond(inner - radius, cosine, sine) - _beyond(radius - outer, cosine, sine)
        row[column] += covered


@numba.njit(cache=True, inline="always", error_model="numpy")
def _turn(x: float, y: float) -> float:
    """Return the direction of a place as part of a whole turn, −½..½, without a branch."""
    wide, high = abs(x), abs(y)
    slope = min(wide, high) / max(wide, high)
    square = slope * slope
    a0, a1, a2, a3, a4, a5, a6, a7, a8 = ARC_TANGENT
    high_terms = (((a8 * square + a7) * square + a6) * square + a5) * square + a4
    angle = slope * ((((high_terms * square + a3) * square + a2) * square + a1) * square + a0)
    angle = math.pi / 2 - angle if high > wide else angle
    angle = math.pi - angle if x < 0 else angle
    return (-angle if y < 0 else angle) / (2 * math.pi)


@numba.njit(cache=True, inline="always", error_model="numpy")
def _twice(at: float) -> float:
    """Return the second integral of the bars (1 on 0..½, 0 on ½..1) less their mean."""
    part = at - math.floor(at)
    # Both halves of a period hold one parabola, upside down in the other.
    sign = 0.25 if part < 0.5 else -0.25
    part = part if part < 0.5 else part - 0.5
    return sign * part * (part - 0.5)


@numba.njit(cache=True, inline="always", error_model="numpy")
def _beyond(distance: float, cosine: float, sine: float) -> float:
    """Return the part of a pixel that lies beyond a straight edge at a distance from its centre.

    The edge's normal has these absolute components; a positive distance puts most of the pixel beyond.
    """
    wide, narrow = (cosine + sine) / 2, (cosine - sine) / 2
    outside = _ramp(distance + wide) + _ramp(distance - wide)
    return (outside - _ramp(distance + narrow) - _ramp(distance - narrow)) / (cosine * sine)


@numba.njit(cache=True, inline="always", error_model="numpy")
def _ramp(distance: float) -> float:
    return max(distance, 0.0) ** 2 / 2
