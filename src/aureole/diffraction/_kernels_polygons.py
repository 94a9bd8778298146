"""Compiled loops of the far field of outlines: straight edges and arcs, one row of the grid at a time."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

# Below this phase per edge (radians) the quotient of the edge is summed as a series.
SMALL_PHASE = 0.25
# From this 2π R |q| on, three terms of the arc's expansion are accurate to 1e-6 of its edge wave; a
# flat arc must also hold that much phase itself, lest its ends cancel.
FAR_ARC = 40.0
LONG_ARC = 20.0
TABLE_STEPS = 64


@numba.njit(parallel=True, cache=True, fastmath={"contract", "nsz", "arcp"})
def rings(
    u: NDArray[np.float64],
    v: NDArray[np.float64],
    phase_x: NDArray[np.complex128],
    phase_y: NDArray[np.complex128],
    edges: NDArray[np.float64],
    arcs: NDArray[np.float64],
    starts: NDArray[np.int64],
    moments: NDArray[np.float64],
    table: NDArray[np.float64],
    nodes: NDArray[np.float64],
    weights: NDArray[np.float64],
    out: NDArray[np.complex64],
) -> None:
    """Add the far field of rings to a plane.

    Parameters
    ----------
    u, v : ndarray, shapes (C,) and (R,)
        Frequencies of columns and rows, cycles per unit of length.
    phase_x, phase_y : ndarray, shapes (V, C) and (V, R)
        exp(−i2π u x) and exp(−i2π v y) of every vertex.
    edges : ndarray, shape (V, 2)
        Vector from each vertex to the next of its ring.
    arcs : ndarray, shape (V, 5)
        Centre x, y, radius, first angle and sweep of each edge; radius 0 for a straight one.
    starts : ndarray, shape (K + 1,)
        First vertex of each ring.
    moments : ndarray, shape (K, 7)
        Weight, area, centroid x, y and second moments xx, xy, yy about it of each ring.
    table : ndarray, shape (T, 2)
        Fresnel auxiliary functions f and g at steps of 1 / 64.
    nodes, weights : ndarray, shape (N,)
        Gauss-Legendre rule on [−1, 1] for arcs near the origin.
    out : ndarray, shape (R, C)
        Added to in place.
    """
    columns = len(u)
    for row in numba.prange(len(v)):
        total = np.zeros(columns, dtype=np.complex128)
        first = np.empty(columns, dtype=np.complex128)
        second = np.empty(columns, dtype=np.complex128)
        closing = np.empty(columns, dtype=np.complex128)
        for ring in range(len(starts) - 1):
            begin, end = starts[ring], starts[ring + 1]
            total[:] = 0
            for column in range(columns):
                first[column] = phase_x[begin, column] * phase_y[begin, row]
                closing[column] = first[column]
            for vertex in range(begin, end):
                if vertex + 1 < end:
                    for column in range(columns):
                        second[column] = phase_x[vertex + 1, column] * phase_y[vertex + 1, row]
                else:
                    second[:] = closing
                if arcs[vertex, 2] == 0:
                    _straight(u, v[row], edges[vertex], first, second, total)
                else:
                    _arc(u, v[row], arcs[vertex], first, second, table, nodes, weights, total)
                first, second = second, first
            _finish(u, v[row], moments[ring], total, out[row])


@numba.njit(cache=True, fastmath={"contract", "nsz", "arcp"})
def _straight(
    u: NDArray[np.float64],
    v: float,
    edge: NDArray[np.float64],
    first: NDArray[np.complex128],
    second: NDArray[np.complex128],
    total: NDArray[np.complex128],
) -> None:
    """Add κ ∫ exp(−i2π q·p) along a straight edge, κ = u e_y − v e_x."""
    ex, ey = edge[0], edge[1]
    along_v, cross_v = v * ey, v * ex
    limit = SMALL_PHASE / (2 * math.pi)
    for column in range(len(u)):
        along = u[column] * ex + along_v
        # The quotient (P0 − P1) / (i 2π q·e) is safe away from q ⟂ e.
        safe = along if abs(along) > limit else 1.0
        factor = (u[column] * ey - cross_v) / (2 * math.pi * safe)
        if abs(along) <= limit:
            factor = 0.0
        delta = first[column] - second[column]
        total[column] += complex(delta.imag * factor, -delta.real * factor)
    low, high = _near_normal(u, ex, along_v, limit)
    for column in range(low, high):
        along = u[column] * ex + along_v
        if abs(along) <= limit:
            # Σ (−iθ)^k / (k + 1)! with θ = 2π q·e.
            step = complex(0.0, -2 * math.pi * along)
            series = complex(1.0, 0.0)
            for order in range(8, 1, -1):
                series = 1 + step / order * series
            total[column] += (u[column] * ey - cross_v) * first[column] * series


@numba.njit(cache=True)
def _near_normal(u: NDArray[np.float64], ex: float, along_v: float, limit: float) -> tuple[int, int]:
    """Return the range of columns in which |u ex + along_v| can be below a limit."""
    count = len(u)
    if ex == 0:
        return (0, count) if abs(along_v) <= limit else (0, 0)
    if count == 1:
        return 0, 1
    step = u[1] - u[0]
    one = ((limit - along_v) / ex - u[0]) / step
    other = ((-limit - along_v) / ex - u[0]) / step
    low = min(max(min(one, other) - 1, 0.0), float(count))
    high = min(max(max(one, other) + 2, 0.0), float(count))
    return int(low), int(high)


@numba.njit(cache=True)
def _arc(
    u: NDArray[np.float64],
    v: float,
    arc: NDArray[np.float64],
    first: NDArray[np.complex128],
    second: NDArray[np.complex128],
    table: NDArray[np.float64],
    nodes: NDArray[np.float64],
    weights: NDArray[np.float64],
    total: NDArray[np.complex128],
) -> None:
    """Add ∫ (q × dp) exp(−i2π q·p) along an arc of at most 60 degrees."""
    x, y, radius, start, sweep = arc[0], arc[1], arc[2], arc[3], arc[4]
    cos0, sin0 = math.cos(start), math.sin(start)
    cos1, sin1 = math.cos(start + sweep), math.sin(start + sweep)
    cos_mid, sin_mid = math.cos(start + sweep / 2), math.sin(start + sweep / 2)
    for column in range(len(u)):
        uc = u[column]
        q = math.sqrt(uc * uc + v * v)
        z = 2 * math.pi * radius * q
        if z < FAR_ARC or z * abs(sweep) < LONG_ARC:
            total[column] += _arc_by_quadrature(uc, v, x, y, radius, start, sweep, nodes, weights)
            continue
        # The stationary point lies at the angle of q, or opposite to it, whichever is nearer.
        side = 1.0 if uc * cos_mid + v * sin_mid >= 0 else -1.0
        inverse = side / q
        c0, s0 = (cos0 * uc + sin0 * v) * inverse, (sin0 * uc - cos0 * v) * inverse
        c1, s1 = (cos1 * uc + sin1 * v) * inverse, (sin1 * uc - cos1 * v) * inverse
        t0, t1 = s0 * math.sqrt(2 / (1 + c0)), s1 * math.sqrt(2 / (1 + c1))
        end0, end1 = _arc_end(t0, c0, z, table), _arc_end(t1, c1, z, table)
        if side < 0:
            end0, end1 = end0.conjugate(), end1.conjugate()
        value = second[column] * end1 - first[column] * end0
        if (t0 < 0) != (t1 < 0):
            value += _stationary(uc, v, x, y, z, side, t1 > t0)
        total[column] += side * radius * q * value


@numba.njit(cache=True, fastmath={"contract", "nsz", "arcp"})
def _arc_end(t: float, c: float, z: float, table: NDArray[np.float64]) -> complex:
    """Return the edge wave of an arc's end: its expansion in 1 / z with the Fresnel tail.

    With t = 2 sin(α / 2) the arc is ∫ g(t) exp(i z t² / 2) dt, g = 2r − 1/r, r = cos(α / 2); each
    integration by parts takes one term off and leaves (g − g(0)) / t.
    """
    r = math.sqrt((1 + c) / 2)
    inverse_r, inverse_s = 1 / r, 1 / (1 + r)
    cube = inverse_r * inverse_r * inverse_r
    h1 = -t / 4 * (inverse_r + inverse_s)
    m = cube + 2 * inverse_r - 2 * inverse_s - inverse_s * inverse_s / 2
    h2 = -t / 16 * m
    slope = -3 * cube * inverse_r - 2 * inverse_r * inverse_r + 2 * inverse_s**2 + inverse_s**3
    g2 = (-m + (1 - r * r) * inverse_r * slope) / 16
    h3 = (g2 + 0.1171875) / t if abs(t) > 1e-3 else -0.1025390625 * t
    inverse_z = 1 / z
    end = complex(h2 * inverse_z * inverse_z, -h1 * inverse_z + h3 * inverse_z**3)
    root = math.sqrt(math.pi * inverse_z)
    f, g = _auxiliary(abs(t) / root, table)
    sign = -1.0 if t < 0 else 1.0
    return end - sign * root * _amplitude(inverse_z) * complex(g, f)


@numba.njit(cache=True)
def _amplitude(inverse_z: float) -> complex:
    """Return g(0) − g₁(0) / (iz) + g₂(0) / (iz)²."""
    return complex(1 + 0.1171875 * inverse_z * inverse_z, -0.375 * inverse_z)


@numba.njit(cache=True)
def _stationary(u: float, v: float, x: float, y: float, z: float, side: float, forward: bool) -> complex:
    """Return the wave from the point of an arc whose normal is along q."""
    value = math.sqrt(math.pi / z) * _amplitude(1 / z) * complex(1.0, 1.0)
    if side < 0:
        value = value.conjugate()
    angle = -2 * math.pi * (u * x + v * y) - side * z
    value *= complex(math.cos(angle), math.sin(angle))
    return value if forward else -value


@numba.njit(cache=True)
def _auxiliary(w: float, table: NDArray[np.float64]) -> tuple[float, float]:
    """Return the Fresnel auxiliary functions f and g of w >= 0."""
    place = w * TABLE_STEPS
    if place < len(table) - 1:
        index = int(place)
        part = place - index
        step = 1.0 / TABLE_STEPS
        w0 = index * step
        w1 = w0 + step
        f0, g0, f1, g1 = table[index, 0], table[index, 1], table[index + 1, 0], table[index + 1, 1]
        # Cubic Hermite with f' = −π w g and g' = π w f − 1.
        f = _hermite(part, f0, f1, -math.pi * w0 * g0 * step, -math.pi * w1 * g1 * step)
        g = _hermite(part, g0, g1, (math.pi * w0 * f0 - 1) * step, (math.pi * w1 * f1 - 1) * step)
        return f, g
    square = 1 / (math.pi * w * w)
    fourth = square * square
    f = (1 - fourth * (3 - 105 * fourth)) / (math.pi * w)
    g = (1 - fourth * (15 - 945 * fourth)) * square / (math.pi * w)
    return f, g


@numba.njit(cache=True)
def _hermite(part: float, y0: float, y1: float, d0: float, d1: float) -> float:
    rise = y1 - y0
    return y0 + part * (d0 + part * (3 * rise - 2 * d0 - d1 + part * (d0 + d1 - 2 * rise)))


@numba.njit(cache=True)
def _arc_by_quadrature(
    u: float,
    v: float,
    x: float,
    y: float,
    radius: float,
    start: float,
    sweep: float,
    nodes: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> complex:
    total = complex(0.0, 0.0)
    for index in range(len(nodes)):
        angle = start + sweep * (nodes[index] + 1) / 2
        cosine, sine = math.cos(angle), math.sin(angle)
        across = u * cosine + v * sine
        phase = -2 * math.pi * (u * x + v * y + radius * across)
        total += weights[index] * across * complex(math.cos(phase), math.sin(phase))
    return total * radius * sweep / 2


@numba.njit(cache=True)
def _finish(
    u: NDArray[np.float64],
    v: float,
    moments: NDArray[np.float64],
    total: NDArray[np.complex128],
    out: NDArray[np.complex64],
) -> None:
    """Divide the boundary integral by −i2π |q|², with the moments' series about the origin."""
    weight, area = moments[0], moments[1]
    near = 1.5e-8 * area / (moments[4] + moments[6])
    for column in range(len(u)):
        uc = u[column]
        square = uc * uc + v * v
        if square > near:
            factor = weight / (2 * math.pi * square)
            value = total[column]
            out[column] += np.complex64(complex(-value.imag * factor, value.real * factor))
        else:
            # About the centroid, so that a small ring far off the axis has a short series too.
            angle = -2 * math.pi * (uc * moments[2] + v * moments[3])
            second = moments[4] * uc * uc + 2 * moments[5] * uc * v + moments[6] * v * v
            real = weight * (area - 2 * math.pi**2 * second)
            out[column] += np.complex64(complex(real * math.cos(angle), real * math.sin(angle)))
