"""Compiled loops of the near field's boundary integral: Gauss-Legendre sums along edges, tile by tile.

Lengths are in Fresnel units, √(λz / 2). The waves exp(iπρ²/2) are products of a table for the columns
and one for the rows, so that a node costs a complex product and a division.
"""

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.diffraction._kernels_arcs import cos_sin
from aureole.diffraction._kernels_fresnel import turned
from aureole.diffraction._kernels_near_arcs import (
    CENTRE,
    CURVATURE,
    END,
    SIGN,
    START,
    TANGENT,
    angle_of,
    edge_sum,
    end_wave,
    stationary_wave,
    turns_of,
)

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

# Columns of a tile, and rows for which one task keeps a tile's tables.
TILE, ROWS = 128, 512
FAST = {"contract", "nsz", "arcp"}
# Below this ρ² the wave's difference from 1 is a series.
NEAR = np.float32(0.06)
# From this square of the way along the edge on, three terms of an end's wave are accurate to 1e-7.
CLEAR = 36.0
TURN = 2 * math.pi
# Places within this part of a corner may be on either side of it.
SMALL = 4e-9
SERIES = tuple(np.float32(math.pi ** (k + 1) / (2 ** (k + 1) * math.factorial(k + 1))) for k in range(4))
ONE, ZERO = np.float32(1), np.float32(0)


class Edges(NamedTuple):
    """The edges of a ring, and nodes along them, several sets an edge.

    shapes (E, 13) is as of `_kernels_near_arcs.edge_sum`; beyond near[e] from an arc's centre that serves.
    bounds (E, 6) holds of each edge its origin x, y, tangent x, y, sine and reach: a place at v from the
    origin sees the phase along the edge turn by at most |v·t| + |v × t| sine + reach half cycles a unit.
    Set s of edge e serves turns of up to limits[e, s]; its nodes are those from first[e, s] to
    first[e, s] + counts[e, s]. points (K, 2) and steps (K, 2) are in Fresnel units.
    """

    shapes: F64
    near: F64
    bounds: F64
    limits: F64
    first: I64
    counts: I64
    points: F64
    steps: F64


class Tables(NamedTuple):
    """The tables of the Fresnel integrals and of the corner function."""

    taylor: F64
    corner: F64
    orders: I64


@numba.njit(cache=True)
def _turn(edges: Edges, edge: int, x0: float, x1: float, y: float) -> float:
    """Return how fast the phase along an edge turns at most, for a row's places from x0 to x1."""
    origin_x, origin_y, along_x, along_y, sine, reach = edges.bounds[edge]
    turn: float = 0.0
    for x in (x0, x1):
        vx, vy = x - origin_x, y - origin_y
        turn = max(turn, abs(vx * along_x + vy * along_y) + abs(vx * along_y - vy * along_x) * sine)
    return float(turn + reach)


@numba.njit(cache=True)
def _column_waves(edges: Edges, x: F64, waves: F32) -> None:
    """Fill exp(iπ(p − x)²/2) of each node and column: real parts, imaginary parts."""
    for k in range(len(edges.points)):
        for j in range(len(x)):
            along = edges.points[k, 0] - x[j]
            cosine, sine = turned(0.25 * along * along)
            waves[k, 0, j] = cosine
            waves[k, 1, j] = sine


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _add_node(wave: F32, here: tuple[np.float32, ...], place: F32, real: F32, imaginary: F32) -> None:
    """Add (exp(iπρ²/2) − 1) / ρ² (ρ × dρ) of a node along a tile."""
    row_real, row_imaginary, start, turn, slope, height = here
    c1, c2, c3, c4 = SERIES
    for j in range(TILE):
        dx = start - place[j]
        q = dx * dx + height
        factor = turn - slope * place[j]
        r, i = wave[0, j], wave[1, j]
        up = r * row_real - i * row_imaginary - ONE
        side = r * row_imaginary + i * row_real
        inverse = ONE / max(q, NEAR)
        near = q < NEAR
        up = q * (q * q * c4 - c2) if near else up * inverse
        side = c1 - q * q * c3 if near else side * inverse
        real[j] += factor * up
        imaginary[j] += factor * side


@numba.njit(cache=True)
def _add_nodes(
    edges: Edges, edge: int, chosen: int, x0: float, y: float, waves: F32, place: F32, sums: F32
) -> None:
    """Add the sum over a set of an edge's nodes along a tile of a row."""
    first = edges.first[edge, chosen]
    for k in range(first, first + edges.counts[edge, chosen]):
        dx, dy = edges.points[k, 0] - x0, edges.points[k, 1] - y
        step_x, step_y = edges.steps[k]
        cosine, sine = turned(0.25 * dy * dy)
        here = (
            np.float32(cosine),
            np.float32(sine),
            np.float32(dx),
            np.float32(dx * step_y - dy * step_x),
            np.float32(step_y),
            np.float32(dy * dy),
        )
        _add_node(waves[k], here, place, sums[0], sums[1])


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _add_ends(shape: F64, end: int, scale: float, x: F64, y: float, sums: F32) -> None:
    """Add the wave of an edge's end where the place is far from straight ahead, times the scale.

    With a = ρ·t, b = ρ × t, the edge's curvature k and ψ = πρ²/2, dφ / dψ = b / (πρ²a); each further term
    is the derivative of the one before, over iπa.
    """
    tx, ty = shape[TANGENT + 2 * end], shape[TANGENT + 2 * end + 1]
    px, down = shape[START + 2 * end], shape[START + 2 * end + 1] - y
    k, pi = shape[CURVATURE], math.pi
    factor = scale / (2 * pi * pi)
    for j in range(len(x)):
        along = px - x[j]
        a, b, q = along * tx + down * ty, along * ty - down * tx, along * along + down * down
        aa, m = a * a, 1 - k * b
        clear = aa >= CLEAR * max(1.0, abs(m))
        inverse = 1 / (a * q) if clear else 0.0
        # 1 / a and 1 / ρ²
        ia, iq = inverse * q, inverse * a
        y1 = k - 2 * b * iq - b * m * ia * ia
        slope = 4 * a * b * iq * iq - 2 * k * a * iq - k * (1 - 2 * k * b) * ia + 2 * b * m * m * ia * ia * ia
        y2 = ia * (slope - y1 * (2 * a * iq + m * ia))
        real = -factor * inverse * y1 / pi
        imaginary = factor * inverse * (b - y2 / (pi * pi))
        cosine, sine = cos_sin(0.25 * q)
        up, side = np.float32(real), np.float32(imaginary)
        sums[0, j] += up * cosine - side * sine
        sums[1, j] += up * sine + side * cosine


@numba.njit(cache=True)
def _add_waves(shape: F64, scale: float, x: F64, y: float, tables: Tables, sums: F32) -> None:
    """Add ∫ exp(iπρ²/2) dφ along an edge from its ends and the points straight ahead, times the scale."""
    k = shape[CURVATURE]
    for end in range(2):
        sign = -scale if end else scale
        _add_ends(shape, end, sign, x, y, sums)
        tx, ty = shape[TANGENT + 2 * end], shape[TANGENT + 2 * end + 1]
        px, down = shape[START + 2 * end], shape[START + 2 * end + 1] - y
        for j in range(len(x)):
            along = px - x[j]
            a, b = along * tx + down * ty, along * ty - down * tx
            if a * a < CLEAR * max(1.0, abs(1 - k * b)):
                wave = end_wave(shape, end, x[j], y, tables.taylor, tables.corner, tables.orders)
                sums[0, j] += np.float32(sign * wave.real)
                sums[1, j] += np.float32(sign * wave.imag)
    first = (shape[START + 1] - y) * shape[TANGENT + 1]
    last = (shape[END + 1] - y) * shape[TANGENT + 3]
    for j in range(len(x)):
        a = (shape[START] - x[j]) * shape[TANGENT] + first
        b = (shape[END] - x[j]) * shape[TANGENT + 2] + last
        if a * b <= SMALL * (1 + abs(a) + abs(b)):
            wave = stationary_wave(shape, x[j], y, tables.taylor)
            sums[0, j] += np.float32(scale * wave.real)
            sums[1, j] += np.float32(scale * wave.imag)


@numba.njit(cache=True)
def _way(edges: Edges, edge: int, x: F64, y: float) -> tuple[int, float]:
    """Return the set of nodes that serves an edge along a tile, or −1, and the least d² from its centre."""
    turn = _turn(edges, edge, x[0], x[-1], y)
    for s in range(edges.limits.shape[1]):
        if turn <= edges.limits[edge, s]:
            return s, 0.0
    shape = edges.shapes[edge]
    nearest = np.inf
    for j in range(len(x)):
        nearest = min(nearest, (x[j] - shape[CENTRE]) ** 2 + (y - shape[CENTRE + 1]) ** 2)
    return -1, nearest


@numba.njit(cache=True)
def _add_edge(
    edges: Edges, edge: int, x: F64, y: float, waves: F32, place: F32, tables: Tables, sums: F32
) -> None:
    """Fill an edge's sum along the places of a row's tile, in a tile where some edges take nodes."""
    sums[:] = ZERO
    chosen, nearest = _way(edges, edge, x, y)
    if chosen >= 0:
        _add_nodes(edges, edge, chosen, x[0], y, waves, place, sums)
        return
    shape, square = edges.shapes[edge], edges.near[edge] ** 2
    if nearest >= square:
        _add_waves(shape, TURN * shape[SIGN], x, y, tables, sums)
        for j in range(len(x)):
            sums[0, j] -= np.float32(angle_of(shape, x[j], y))
        return
    _add_nodes(edges, edge, edges.limits.shape[1] - 1, x[0], y, waves, place, sums)
    for j in range(len(x)):
        if (x[j] - shape[CENTRE]) ** 2 + (y - shape[CENTRE + 1]) ** 2 >= square:
            wave = edge_sum(shape, x[j], y, tables.taylor, tables.corner, tables.orders)
            sums[0, j], sums[1, j] = np.float32(wave.real), np.float32(wave.imag)


@numba.njit(cache=True)
def _by_waves(edges: Edges, x: F64, y: float) -> bool:
    """Say whether no edge takes nodes along a tile."""
    for edge in range(len(edges.near)):
        chosen, nearest = _way(edges, edge, x, y)
        if chosen >= 0 or nearest < edges.near[edge] ** 2:
            return False
    return True


@numba.njit(cache=True)
def _fill_tile(
    edges: Edges, tables: Tables, x: F64, y: float, waves: F32, place: F32, sums: F32, total: F32
) -> None:
    """Fill ∮ (exp(iπρ²/2) − 1) dφ along a row's tile."""
    total[:] = ZERO
    if not _by_waves(edges, x, y):
        for edge in range(len(edges.near)):
            _add_edge(edges, edge, x, y, waves, place, tables, sums)
            total += sums
        return
    for edge in range(len(edges.near)):
        shape = edges.shapes[edge]
        _add_waves(shape, TURN * shape[SIGN], x, y, tables, total)
    for j in range(len(x)):
        turns = 0.0
        for edge in range(len(edges.near)):
            turns += turns_of(edges.shapes[edge], x[j], y)
        total[0, j] -= np.float32(TURN * turns)


@numba.njit(cache=True, parallel=True)
def fill_boundary(edges: Edges, tables: Tables, x: F64, y: F64, out: NDArray[np.complex64]) -> None:
    """Fill −1 / (2π) ∮ (exp(iπρ²/2) − 1) / ρ² (ρ × dρ).

    Parameters
    ----------
    edges : Edges
        All that the ring has.
    tables : Tables
        Of special functions.
    x, y : ndarray of float64
        Places of the columns and of the rows, Fresnel units; the columns continued to whole tiles.
    out : ndarray of complex64, shape (rows, columns)
        Filled.
    """
    rows, columns = out.shape
    tiles, blocks = len(x) // TILE, (rows + ROWS - 1) // ROWS
    scale = np.float32(-0.5 / math.pi)
    for task in numba.prange(tiles * blocks):
        low, block = np.int64(task) // blocks * TILE, np.int64(task) % blocks
        there = x[low : low + TILE]
        inside = there[: columns - low]
        place = (there - there[0]).astype(np.float32)
        waves = np.empty((len(edges.points), 2, TILE), dtype=np.float32)
        _column_waves(edges, there, waves)
        sums, total = np.empty((2, TILE), dtype=np.float32), np.empty((2, TILE), dtype=np.float32)
        for row in range(block * ROWS, min(rows, (block + 1) * ROWS)):
            _fill_tile(edges, tables, inside, y[row], waves, place, sums, total)
            for j in range(len(inside)):
                out[row, low + j] = complex(scale * total[0, j], scale * total[1, j])
