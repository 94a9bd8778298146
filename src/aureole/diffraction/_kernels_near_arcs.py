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
# Where an edge's description holds what: sign, ends x, y, x, y, radius (0: straight), centre x, y.
SIGN, START, END, RADIUS, CENTRE = 0, 1, 3, 5, 6


@numba.njit(cache=True)
def _seen(edge: F64, corner: int, x: float, y: float) -> tuple[float, float]:
    """Return the way from a place to one of an edge's corners, never zero."""
    along, down = edge[corner] - x, edge[corner + 1] - y
    if along * along + down * down < ON_CORNER * ON_CORNER:
        return ON_CORNER, 0.6 * ON_CORNER
    return along, down


@numba.njit(cache=True)
def edge_sum(edge: F64, x: float, y: float, taylor: F64, table: F64, orders: I64) -> complex:
    """Return ∫ (exp(iπρ²/2) − 1) dφ along an edge seen from a place.

    Parameters
    ----------
    edge : ndarray of float64, shape (8,)
        Sign; start and end, x and y; radius, 0 for a straight edge; centre x, y. Arcs turn from +x to +y.
    x, y : float
        The place.
    taylor, table, orders
        As of `_kernels_corner.corner`.
    """
    ax, ay = _seen(edge, START, x, y)
    bx, by = _seen(edge, END, x, y)
    cross = ax * by - ay * bx + 0.0
    angle = math.atan2(cross, ax * bx + ay * by)
    if edge[RADIUS] == 0:
        wave = _straight(ax, ay, bx, by, cross, edge, taylor, table, orders)
    else:
        wave, inside = _arc(ax, ay, bx, by, edge, x, y, taylor, table, orders)
        # Between chord and arc the arc goes round the other way.
        if inside and cross < 0:
            angle += 2 * math.pi
    return complex(edge[SIGN] * (2 * math.pi * wave - angle))


@numba.njit(cache=True)
def _wave(turns: float, real: float, imaginary: float) -> complex:
    """Return an amplitude times exp(i2π turns)."""
    cosine, sine = turned(turns)
    return complex(real * cosine - imaginary * sine, real * sine + imaginary * cosine)


@numba.njit(cache=True)
def _straight(
    ax: float,
    ay: float,
    bx: float,
    by: float,
    cross: float,
    edge: F64,
    taylor: F64,
    table: F64,
    orders: I64,
) -> complex:
    """Return ∫ exp(iπρ²/2) dφ / 2π along a straight edge: two corner functions."""
    tx, ty = edge[END] - edge[START], edge[END + 1] - edge[START + 1]
    length = math.sqrt(tx * tx + ty * ty)
    tx, ty = tx / length, ty / length
    first, last = ax * tx + ay * ty, bx * tx + by * ty
    # The same number as the angle's, so that both turn their sign at once.
    h = cross / length
    size = abs(h)
    total = 0j
    for s, sign in ((first, 1.0), (last, -1.0)):
        if size + abs(s) < FLAT:
            real, imag = corner_amplitude(size, abs(s), taylor, table, orders)
            wave = _wave(0.25 * (h * h + s * s), real, imag)
            total += -sign * wave if s < 0 else sign * wave
    if first < 0 and last >= 0 and size < FLAT:
        real, imag = smooth_tail(size, taylor)
        total += _wave(0.25 * h * h, 0.5 * (real + imag), 0.5 * (imag - real))
    return -total if h < 0 else total


@numba.njit(cache=True)
def _arc(
    ax: float,
    ay: float,
    bx: float,
    by: float,
    edge: F64,
    x: float,
    y: float,
    taylor: F64,
    table: F64,
    orders: I64,
) -> tuple[complex, bool]:
    """Return ∫ exp(iπρ²/2) dφ / 2π along an arc, and whether its circle holds the place."""
    radius = edge[RADIUS]
    d = math.hypot(x - edge[CENTRE], y - edge[CENTRE + 1])
    across = radius + d
    root = math.sqrt(radius * d)
    nx, ny = (edge[START] - edge[CENTRE]) / radius, (edge[START + 1] - edge[CENTRE + 1]) / radius
    mx, my = (edge[END] - edge[CENTRE]) / radius, (edge[END + 1] - edge[CENTRE + 1]) / radius
    far_a, far_b = ax * ax + ay * ay, bx * bx + by * by
    out_a, out_b = ax * nx + ay * ny, bx * mx + by * my
    # The nearer corner says on which side of the arc the place is, to all its digits.
    h = (2 * radius * out_a - far_a if far_a < far_b else 2 * radius * out_b - far_b) / across
    c, v = h / across, across / (2 * root)
    e = 1 / (4 * math.pi * root * root)
    scale = 1 / (4 * math.pi * root)
    shape = (h, c, v, e, scale, root)
    sine_a, cosine_a = (nx * ay - ny * ax) / d, (radius - out_a) / d
    sine_b, cosine_b = (mx * by - my * bx) / d, (radius - out_b) / d
    total = _end(sine_a, cosine_a, far_a, shape, taylor, table, orders)
    total -= _end(sine_b, cosine_b, far_b, shape, taylor, table, orders)
    if sine_a < 0 and sine_b >= 0 and cosine_a > 0:
        total += _nearest(shape, taylor)
    elif sine_a >= 0 and sine_b < 0 and cosine_a < 0:
        total += _farthest(shape, across)
    return total, h >= 0


@numba.njit(cache=True)
def _nearest(shape: tuple[float, ...], taylor: F64) -> complex:
    """Return what the circle's nearest point sends."""
    h, c, v, e, scale, _ = shape
    lit, p = 1 + c, 1 / (1 + v)
    even, odd = lit - c * p, 0.5 * e * (lit - c * p * p)
    real, imag = scale * (even - odd), scale * (even + odd)
    size = abs(h)
    if size < FLAT:
        tail_real, tail_imag = smooth_tail(size, taylor)
        half = 0.5 if h >= 0 else -0.5
        real += half * (tail_real + tail_imag)
        imag += half * (tail_imag - tail_real)
    return _wave(0.25 * h * h, real, imag)


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
