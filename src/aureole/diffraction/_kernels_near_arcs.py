"""What one edge sends to a place, arc or straight, from its ends and its stationary points.

Lengths are in Fresnel units, √(λz / 2). `near_arcs` has the equations.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.diffraction._kernels_corner import corner_amplitude
from aureole.diffraction._kernels_fresnel import FLAT, smooth_tail, turned

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

# A place as near as this to a corner is moved off it by about as much.
ON_CORNER = 1e-9
# Where an edge's description holds what: sign, ends x, y, x, y, radius (0: straight), centre x, y, tangents
# at the ends x, y, x, y, and curvature. Arcs turn from +x to +y.
SIGN, START, END, RADIUS, CENTRE, TANGENT, CURVATURE, SHAPE = 0, 1, 3, 5, 6, 8, 12, 13


@numba.njit(cache=True)
def _seen(edge: F64, corner: int, x: float, y: float) -> tuple[float, float]:
    """Return the way from a place to one of an edge's corners, never zero."""
    along, down = edge[corner] - x, edge[corner + 1] - y
    if along * along + down * down < ON_CORNER * ON_CORNER:
        return ON_CORNER, 0.6 * ON_CORNER
    return along, down


@numba.njit(cache=True)
def _sides(edge: F64, x: float, y: float) -> tuple[float, float]:
    """Return on which side of the chord a place lies, positive on the left, and how far within the edge.

    The first is twice the area of the triangle of place and ends, the second h (2 R − h) of an arc, from the
    nearer corner, so that the signs hold to all digits; of a straight edge both are the first.
    """
    ax, ay = _seen(edge, START, x, y)
    bx, by = _seen(edge, END, x, y)
    cross = ax * by - ay * bx + 0.0
    if edge[RADIUS] == 0:
        return cross, cross
    far_a, far_b = ax * ax + ay * ay, bx * bx + by * by
    if far_a < far_b:
        return cross, 2 * edge[RADIUS] * (ax * edge[TANGENT + 1] - ay * edge[TANGENT]) - far_a
    return cross, 2 * edge[RADIUS] * (bx * edge[TANGENT + 3] - by * edge[TANGENT + 2]) - far_b


@numba.njit(cache=True)
def angle_of(edge: F64, x: float, y: float) -> float:
    """Return the signed angle that an edge takes up as a place sees it.

    Parameters
    ----------
    edge, x, y
        As of `edge_sum`.
    """
    cross, within = _sides(edge, x, y)
    ax, ay = _seen(edge, START, x, y)
    bx, by = _seen(edge, END, x, y)
    angle = math.atan2(cross, ax * bx + ay * by)
    # Between chord and arc the arc goes round the other way.
    if cross < 0 and within >= 0:
        angle += 2 * math.pi
    return float(edge[SIGN] * angle)


@numba.njit(cache=True)
def turns_of(edge: F64, x: float, y: float) -> float:
    """Return what an edge adds to the winding number about a place: all angles over 2π, without angles.

    Parameters
    ----------
    edge, x, y
        As of `edge_sum`.
    """
    # Corners where they are seen, so that one on the place counts as the angles count it.
    below, above = _seen(edge, START, x, y)[1] <= 0, _seen(edge, END, x, y)[1] > 0
    if below != above and edge[RADIUS] == 0:
        return 0.0
    cross, within = _sides(edge, x, y)
    turns = 1.0 if cross < 0 and within >= 0 else 0.0
    if below and above and cross >= 0:
        turns += 1.0
    elif not below and not above and cross < 0:
        turns -= 1.0
    return float(edge[SIGN] * turns)


@numba.njit(cache=True)
def edge_sum(edge: F64, x: float, y: float, taylor: F64, table: F64, orders: I64) -> complex:
    """Return ∫ (exp(iπρ²/2) − 1) dφ along an edge seen from a place.

    Parameters
    ----------
    edge : ndarray of float64, shape (13,)
        Described as above.
    x, y : float
        The place.
    taylor, table, orders
        As of `_kernels_corner.corner`.
    """
    wave = end_wave(edge, 0, x, y, taylor, table, orders) - end_wave(edge, 1, x, y, taylor, table, orders)
    wave += stationary_wave(edge, x, y, taylor)
    return complex(2 * math.pi * edge[SIGN] * wave - angle_of(edge, x, y))


@numba.njit(cache=True)
def stationary_wave(edge: F64, x: float, y: float, taylor: F64) -> complex:
    """Return what an edge's points send to which the place is straight ahead, over 2π.

    Parameters
    ----------
    edge, x, y, taylor
        As of `edge_sum`.
    """
    ax, ay = _seen(edge, START, x, y)
    bx, by = _seen(edge, END, x, y)
    first = ax * edge[TANGENT] + ay * edge[TANGENT + 1]
    last = bx * edge[TANGENT + 2] + by * edge[TANGENT + 3]
    if (first < 0) == (last < 0):
        return 0j
    cross, within = _sides(edge, x, y)
    if edge[RADIUS] == 0:
        return _straight_wave(cross / math.hypot(bx - ax, by - ay), taylor)
    radius = edge[RADIUS]
    ahead = radius - ax * edge[TANGENT + 1] + ay * edge[TANGENT]
    d = math.hypot(x - edge[CENTRE], y - edge[CENTRE + 1])
    shape = _shape(radius, d, within / (radius + d))
    if first < 0 and ahead > 0:
        return _nearest(shape, taylor)
    if first >= 0 and ahead < 0:
        return _farthest(shape, radius + d)
    return 0j


@numba.njit(cache=True)
def end_wave(edge: F64, end: int, x: float, y: float, taylor: F64, table: F64, orders: I64) -> complex:
    """Return what an edge's start (0) or its end (1) sends, over 2π: from there on in the edge's direction.

    Parameters
    ----------
    edge, x, y, taylor, table, orders
        As of `edge_sum`.
    end : int
        Which.
    """
    rx, ry = _seen(edge, START + 2 * end, x, y)
    tx, ty = edge[TANGENT + 2 * end], edge[TANGENT + 2 * end + 1]
    along, square = rx * tx + ry * ty, rx * rx + ry * ry
    cross, within = _sides(edge, x, y)
    if edge[RADIUS] > 0:
        radius = edge[RADIUS]
        d = math.hypot(x - edge[CENTRE], y - edge[CENTRE + 1])
        ahead = radius - rx * ty + ry * tx
        shape = _shape(radius, d, within / (radius + d))
        return _end(along / d, ahead / d, square, shape, taylor, table, orders)
    # The same number as the angle's, so that both turn their sign at once.
    h = cross / math.hypot(edge[END] - edge[START], edge[END + 1] - edge[START + 1])
    real, imag = corner_amplitude(abs(h), abs(along), taylor, table, orders)
    wave = _wave(0.25 * square, real, imag)
    return -wave if (h < 0) != (along < 0) else wave


@numba.njit(cache=True)
def _straight_wave(h: float, taylor: F64) -> complex:
    """Return the wave of a whole straight edge, odd in h."""
    size = abs(h)
    if size >= FLAT:
        return 0j
    real, imag = smooth_tail(size, taylor)
    half = 0.5 if h >= 0 else -0.5
    return _wave(0.25 * h * h, half * (real + imag), half * (imag - real))


@numba.njit(cache=True)
def _shape(radius: float, d: float, h: float) -> tuple[float, float, float, float, float, float]:
    """Return h, c and v of a circle seen from a place, the small number, the scale, and √(Rd)."""
    product = radius * d
    root = math.sqrt(product)
    e = 1 / (4 * math.pi * product)
    return h, h / (radius + d), (radius + d) / (2 * root), e, e * root, root


@numba.njit(cache=True)
def _wave(turns: float, real: float, imaginary: float) -> complex:
    """Return an amplitude times exp(i2π turns)."""
    cosine, sine = turned(turns)
    return complex(real * cosine - imaginary * sine, real * sine + imaginary * cosine)


@numba.njit(cache=True)
def _nearest(shape: tuple[float, ...], taylor: F64) -> complex:
    """Return what the circle's nearest point sends."""
    h, c, v, e, scale, _ = shape
    lit, p = 1 + c, 1 / (1 + v)
    even, odd = lit - c * p, 0.5 * e * (lit - c * p * p)
    real, imag = scale * (even - odd), scale * (even + odd)
    return _wave(0.25 * h * h, real, imag) + _straight_wave(h, taylor)


@numba.njit(cache=True)
def _farthest(shape: tuple[float, ...], across: float) -> complex:
    """Return what the circle's farthest point sends."""
    _, c, v, e, scale, _ = shape
    even, odd = 1 + c, e * (0.5 * (1 + c) + c / (v * v))
    return _wave(0.25 * across * across, scale * (even - odd), -scale * (even + odd))


@numba.njit(cache=True)
def _end(
    sine: float,
    cosine: float,
    square: float,
    shape: tuple[float, ...],
    taylor: F64,
    table: F64,
    orders: I64,
) -> complex:
    """Return the wave of an arc's end, seen from the centre at an angle from the place."""
    h, c, v, e, scale, root = shape
    side = 1.0 if sine >= 0 else -1.0
    if cosine >= 0:
        u = math.sqrt(0.5 * (1 + cosine))
        tau = root * abs(sine) / u
        real, imag = corner_amplitude(abs(h), tau, taylor, table, orders)
        if h < 0:
            real, imag = -real, -imag
        lit, p = 1 + c, 1 / (1 + v)
        even, odd = lit - c * p, 0.5 * e * (lit - c * p * p)
        tail_real, tail_imag = smooth_tail(tau, taylor)
        rest = e * tau * (lit / u - c * p / (u + v)) / (1 + u)
        real += scale * (even * tail_real - odd * tail_imag)
        imag += scale * (even * tail_imag + odd * tail_real + rest)
    else:
        u = math.sqrt(0.5 * (1 - cosine))
        sigma = root * abs(sine) / u
        tail_real, tail_imag = smooth_tail(sigma, taylor)
        even, odd = 1 + c, e * (0.5 * (1 + c) + c / (v * v))
        w = v * v - 1
        rest = e * sigma * (1 + c * (w + 1 + u + u * u) / (w + u * u)) / (u * (1 + u))
        # (even − i odd) (tail_real − i tail_imag) − i rest, and the other way round
        real = -scale * (even * tail_real - odd * tail_imag)
        imag = scale * (even * tail_imag + odd * tail_real + rest)
    return side * _wave(0.25 * square, real, imag)
