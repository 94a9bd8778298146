"""Compiled loops of the near field's boundary integral: Gauss-Legendre sums along edges, tile by tile.

Lengths are in Fresnel units, √(λz / 2). The waves exp(iπρ²/2) are products of a table for the columns
and one for the rows, so that a node costs a complex product and a division.
"""

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.diffraction._kernels_fresnel import turned
from aureole.diffraction._kernels_near_arcs import CENTRE, edge_sum

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

# Columns of a tile, and rows for which one task keeps a tile's tables.
TILE, ROWS = 128, 512
FAST = {"contract", "nsz", "arcp"}
# Below this ρ² the wave's difference from 1 is a series.
NEAR = np.float32(0.06)
SERIES = tuple(np.float32(math.pi ** (k + 1) / (2 ** (k + 1) * math.factorial(k + 1))) for k in range(4))
ONE, ZERO = np.float32(1), np.float32(0)


class Edges(NamedTuple):
    """The edges of a ring, and nodes along them, several sets an edge.

    shapes (E, 8) is as of `_kernels_near_arcs.edge_sum`; beyond near[e] from an arc's centre that serves.
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


@numba.njit(cache=True)
def _add_edge(
    edges: Edges, edge: int, x: F64, y: float, waves: F32, place: F32, tables: Tables, sums: F32
) -> None:
    """Add an edge's sum along the places of a row's tile: by nodes, or where it takes many by its ends."""
    turn, sets = _turn(edges, edge, x[0], x[-1], y), edges.limits.shape[1]
    for s in range(sets):
        if turn <= edges.limits[edge, s]:
            _add_nodes(edges, edge, s, x[0], y, waves, place, sums)
            return
    shape = edges.shapes[edge]
    square = edges.near[edge] ** 2
    nearest = np.inf
    for j in range(len(x)):
        nearest = min(nearest, (x[j] - shape[CENTRE]) ** 2 + (y - shape[CENTRE + 1]) ** 2)
    if nearest < square:
        _add_nodes(edges, edge, sets - 1, x[0], y, waves, place, sums)
    for j in range(len(x)):
        if (x[j] - shape[CENTRE]) ** 2 + (y - shape[CENTRE + 1]) ** 2 >= square:
            wave = edge_sum(shape, x[j], y, tables.taylor, tables.corner, tables.orders)
            sums[0, j], sums[1, j] = np.float32(wave.real), np.float32(wave.imag)


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
            total[:] = ZERO
            for edge in range(len(edges.bounds)):
                sums[:] = ZERO
                _add_edge(edges, edge, inside, y[row], waves, place, tables, sums)
                total += sums
            for j in range(len(inside)):
                out[row, low + j] = complex(scale * total[0, j], scale * total[1, j])
