"""Compiled loops of arcs and circles: their waves at a tile of columns, without branches.

The Fresnel auxiliary functions are f = N_f / D and g = N_g / D, N_f, N_g and D of degrees 8, 6 and 9
in w, fitted together by reweighted least squares in the error relative to |f + ig|, which is below
6e-9 for all w >= 0, so that what is left is float32's. D and both numerators are scaled down, so that
large w overflow nowhere. sin, and J1's parts (J1 = √(2 / πx) (P cos χ − Q sin χ), χ = x − 3π/4, from
x = 3 on, and J1 / x below), are Chebyshev interpolations. `benchmarks/polygons.py --fit` computes all
these numbers anew.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

# Columns of a tile: 513, 1025 and 2049 of them fill whole tiles but for three in a hundred.
TILE = 176
FAST = {"contract", "nsz", "arcp"}
# Where a tile's buffer holds what; each complex row takes two, real and imaginary part. FREQUENCY,
# ROOT and INVERSE are |q|, √|q|, 1 / |q| and after it 1 / (2π |q|²).
FIELD, TOTAL, WAVE = 0, 2 * TILE, 4 * TILE
PLACE, FREQUENCY, ROOT, INVERSE, MARK, SIZE = 6 * TILE, 7 * TILE, 8 * TILE, 9 * TILE, 11 * TILE, 12 * TILE


def _f32(*values: float, scale: float = 1.0) -> tuple[np.float32, ...]:
    return tuple(np.float32(scale * value) for value in values)


ONE, TWO, HALF, QUARTER = np.float32(1), np.float32(2), np.float32(0.5), np.float32(0.25)
DENOMINATOR = _f32(
    *(1, 3.070562629, 5.200416216, 5.97124172, 5.174315779),
    *(3.485066284, 1.888466635, 0.8177232811, 0.2511247814, 0.08254323588),
    scale=1e-33,
)
F_TOP = _f32(
    *(0.4999999967, 1.535281712, 1.814804502, 1.621194289, 1.101903566),
    *(0.6010501475, 0.2602929993, 0.07993542665, 0.02627432837),
    scale=1e-33,
)
G_TOP = _f32(
    *(0.4999999962, 0.5352820384, 0.3150220628, 0.197058424),
    *(0.08218016449, 0.0254835751, 0.008362494768),
    scale=1e-33,
)
SINE = _f32(6.283185307, -41.341702117, 81.605226174, -76.70427987, 42.009779216, -14.39396588)
NEAR_DISC = 3.0
BESSEL_P = _f32(
    *(1.00000001, 0.0130198569, -0.00176286773, 0.00079926511),
    *(-0.00049275527, 0.00023338864, -5.26938055e-05),
)
BESSEL_Q = _f32(
    *(0.374999959, -0.0113891631, 0.00335363653, -0.00217252218),
    *(0.00157319006, -0.000800147874, 0.000187027848),
)
BESSEL_CORE = _f32(
    *(0.5, -0.0624999991, 0.00260416514, -5.42524527e-05, 6.77842836e-07, -5.59778418e-09, 2.92101329e-11)
)
# The third term of an edge wave: h₃ = −t Σ c_k r^k / (512 r⁵ (1 + r)³).
THIRD = _f32(24, 72, 96, 96, 72, 45, 15, scale=-1 / 512)


@numba.njit(cache=True)
def line_through(u: F64, a: float, b: float) -> tuple[float, float, float]:
    """Return slope, shift, rest with u[j] a + b = slope (j + shift) + rest.

    The shift is whole and the rest below half a slope, so that float32 holds small values as well as
    large ones.
    """
    slope = (u[1] - u[0]) * a
    base = u[0] * a + b
    if abs(slope) < 1e-300:
        slope = 1e-300
    shift = np.rint(base / slope) if abs(base) < 4e6 * abs(slope) else 0.0
    return slope, shift, base - shift * slope


@numba.njit(inline="always")
def _sine(turns: np.float32) -> np.float32:
    """Return sin(2π turns) for |turns| <= 1/4."""
    s, C = turns * turns, SINE
    return turns * (C[0] + s * (C[1] + s * (C[2] + s * (C[3] + s * (C[4] + s * C[5])))))


@numba.njit(inline="always")
def cos_sin(turns: float) -> tuple[np.float32, np.float32]:
    """Return cosine and sine of 2π turns, turns float64 of any size."""
    part = np.float32(turns - np.floor(turns + 0.5))
    before = part - QUARTER
    before = before + ONE if before < -HALF else before
    return _sine(QUARTER - abs(part)), _sine(QUARTER - abs(before))


@numba.njit(inline="always")
def _sixth(x: np.float32, C: tuple[np.float32, ...]) -> np.float32:
    """Return a polynomial of the sixth degree."""
    return C[0] + x * (C[1] + x * (C[2] + x * (C[3] + x * (C[4] + x * (C[5] + x * C[6])))))


@numba.njit(inline="always")
def auxiliary(w: np.float32) -> tuple[np.float32, np.float32]:
    """Return the Fresnel auxiliary functions f and g of w >= 0."""
    D, F, G = DENOMINATOR, F_TOP, G_TOP
    d = D[4] + w * (D[5] + w * (D[6] + w * (D[7] + w * (D[8] + w * D[9]))))
    d = D[0] + w * (D[1] + w * (D[2] + w * (D[3] + w * d)))
    f = F[3] + w * (F[4] + w * (F[5] + w * (F[6] + w * (F[7] + w * F[8]))))
    f = F[0] + w * (F[1] + w * (F[2] + w * f))
    g = G[2] + w * (G[3] + w * (G[4] + w * (G[5] + w * G[6])))
    g = G[0] + w * (G[1] + w * g)
    inverse = ONE / d
    return f * inverse, g * inverse


@numba.njit(inline="always")
def _end(
    t: np.float32,
    r: np.float32,
    inverse_r: np.float32,
    inverse_z: np.float32,
    root: np.float32,
    w: np.float32,
) -> tuple[np.float32, np.float32]:
    """Return the edge wave of an arc's end: its expansion in 1 / z with the Fresnel tail.

    With t = 2 sin(α / 2) the arc is ∫ g(t) exp(i z t² / 2) dt, g = 2r − 1/r, r = cos(α / 2); each
    integration by parts takes one term off and leaves (g − g(0)) / t. root is √(π / z), w = |t| / root.
    """
    inverse_s = ONE / (ONE + r)
    h1 = -QUARTER * t * (inverse_r + inverse_s)
    m = inverse_r * inverse_r * inverse_r + TWO * (inverse_r - inverse_s) - HALF * inverse_s * inverse_s
    h2 = -QUARTER * QUARTER * t * m
    both = inverse_r * inverse_s
    h3 = t * _sixth(r, THIRD) * both * both * both * inverse_r * inverse_r
    f, g = auxiliary(w)
    square = inverse_z * inverse_z
    # g(0) − g₁(0) / (iz) + g₂(0) / (iz)²
    real, imag = ONE + np.float32(0.1171875) * square, np.float32(-0.375) * inverse_z
    root = -root if t < 0 else root
    return (
        h2 * square - root * (real * g - imag * f),
        inverse_z * (h3 * square - h1) - root * (real * f + imag * g),
    )


@numba.njit(cache=True)
def arc(
    u: F64,
    v: float,
    shape: F64,
    start: tuple[F32, F32, np.float32, np.float32],
    end: tuple[F32, F32, np.float32, np.float32],
    frequency: F64,
    sums: F32,
) -> None:
    """Add i ∫ (q × dp) exp(−i2π q·p) along an arc of at most 60 degrees.

    Parameters
    ----------
    u, v : ndarray and float
        Frequencies of a tile's columns and of its row.
    shape : ndarray, shape (9,)
        Radius, centre x, y, cosine and sine of first, last and middle angle.
    start, end : tuple
        The waves of the arc's ends: real and imaginary part of the columns', then of the row's.
    frequency : ndarray
        |q| of the tile.
    sums : ndarray
        The tile's buffer.
    """
    radius = shape[0]
    rising0 = line_through(u, shape[4], -shape[3] * v)
    rising1 = line_through(u, shape[6], -shape[5] * v)
    _ends(u, v, shape, rising0, rising1, start, end, sums)
    for j in range(TILE):
        if sums[MARK + j] != 0:
            _stationary(radius, shape[1], shape[2], u, v, frequency, sums)
            return


@numba.njit(inline="always")
def _falling(u: F64, v: float, cosine: float, sine: float) -> tuple[np.float32, np.float32]:
    """Return slope and start of u cosine + v sine along a tile."""
    return np.float32((u[1] - u[0]) * cosine), np.float32(u[0] * cosine + v * sine)


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _ends(
    u: F64,
    v: float,
    shape: F64,
    rising0: tuple[float, float, float],
    rising1: tuple[float, float, float],
    start: tuple[F32, F32, np.float32, np.float32],
    end: tuple[F32, F32, np.float32, np.float32],
    sums: F32,
) -> None:
    """Add the edge waves of an arc's ends; mark where a point between them has its normal along q.

    With α the angle from q (or −q, whichever is nearer the arc's middle) to an end, |q| cos α and
    |q| sin α are linear in u.
    """
    radius = np.float32(shape[0])
    spread, narrow = np.float32(math.sqrt(2 * shape[0])), np.float32(1 / math.sqrt(2 * shape[0]))
    inverse_turn = np.float32(1 / (2 * math.pi * shape[0]))
    (a0, b0), (a1, b1) = _falling(u, v, shape[3], shape[4]), _falling(u, v, shape[5], shape[6])
    am, bm = _falling(u, v, shape[7], shape[8])
    p0, m0, r0 = np.float32(rising0[0]), np.float32(rising0[1]), np.float32(rising0[2])
    p1, m1, r1 = np.float32(rising1[0]), np.float32(rising1[1]), np.float32(rising1[2])
    (real0, imag0, x0, y0), (real1, imag1, x1, y1) = start, end
    least = np.float32(1e-6)
    for j in range(TILE):
        place, inverse, root_q = sums[PLACE + j], sums[INVERSE + j], sums[ROOT + j]
        side = ONE if place * am + bm >= 0 else -ONE
        sided = side * inverse
        c0 = np.sqrt(max(HALF + HALF * (place * a0 + b0) * sided, least))
        c1 = np.sqrt(max(HALF + HALF * (place * a1 + b1) * sided, least))
        over0, over1 = ONE / c0, ONE / c1
        t0 = (p0 * (place + m0) + r0) * sided * over0
        t1 = (p1 * (place + m1) + r1) * sided * over1
        inverse_z, root, w = inverse * inverse_turn, narrow * root_q * inverse, spread * root_q
        e0, f0 = _end(t0, c0, over0, inverse_z, root, abs(t0) * w)
        e1, f1 = _end(t1, c1, over1, inverse_z, root, abs(t1) * w)
        e0, e1 = e0 * side, e1 * side
        wr0, wi0 = real0[j] * x0 - imag0[j] * y0, real0[j] * y0 + imag0[j] * x0
        wr1, wi1 = real1[j] * x1 - imag1[j] * y1, real1[j] * y1 + imag1[j] * x1
        factor = radius * sums[FREQUENCY + j]
        sums[TOTAL + j] += factor * ((f0 * wr0 + e0 * wi0) - (f1 * wr1 + e1 * wi1))
        sums[TOTAL + TILE + j] += factor * ((f0 * wi0 - e0 * wr0) - (f1 * wi1 - e1 * wr1))
        # Sign: side, turned where the arc runs backward. Size: 1 towards q, 2 towards −q.
        mark = (side if t1 > t0 else -side) * (ONE if side > 0 else TWO)
        sums[MARK + j] = mark if (t0 < 0) != (t1 < 0) else np.float32(0)


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _stationary(radius: float, x: float, y: float, u: F64, v: float, frequency: F64, sums: F32) -> None:
    """Add the wave from the point of an arc whose normal is along q, where it is marked."""
    inverse_turn = np.float32(1 / (2 * math.pi * radius))
    wide = np.float32(math.sqrt(radius / 2))
    for j in range(TILE):
        mark = sums[MARK + j]
        side = ONE if abs(mark) < ONE + HALF else -ONE
        cosine, sine = cos_sin(-(u[j] * x + v * y) - side * radius * frequency[j])
        inverse_z = inverse_turn * sums[INVERSE + j]
        # g(0) − g₁(0) / (iz) + g₂(0) / (iz)² times 1 + i
        even = ONE + np.float32(0.1171875) * inverse_z * inverse_z
        odd = np.float32(-0.375) * inverse_z
        # √(π / z) R |q| = √(R |q| / 2)
        strength = wide * sums[ROOT + j]
        strength = strength if mark > 0 else -strength
        strength = strength if mark != 0 else np.float32(0)
        real, imag = strength * (even - odd), side * strength * (even + odd)
        sums[TOTAL + j] -= real * sine + imag * cosine
        sums[TOTAL + TILE + j] += real * cosine - imag * sine


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def disc(radius: float, transmittance: float, frequency: F64, sums: F32) -> None:
    """Add R J1(2π R |q|) / |q| to the field, times the noted wave of the centre."""
    scale = np.float32(2 * math.pi * radius * radius * transmittance)
    limit = np.float32(NEAR_DISC)
    amplitude = np.float32(math.sqrt(2 / math.pi))
    for j in range(TILE):
        turns = radius * frequency[j]
        x = np.float32(2 * math.pi * turns)
        over = ONE / max(x, limit)
        square = limit * limit * over * over
        cosine, sine = cos_sin(turns - 0.375)
        wave = _sixth(square, BESSEL_P) * cosine - _sixth(square, BESSEL_Q) * over * sine
        wave *= amplitude * np.sqrt(over) * over
        low = min(x, limit)
        value = scale * (_sixth(low * low, BESSEL_CORE) if x < limit else wave)
        sums[FIELD + j] += value * sums[WAVE + j]
        sums[FIELD + TILE + j] += value * sums[WAVE + TILE + j]
