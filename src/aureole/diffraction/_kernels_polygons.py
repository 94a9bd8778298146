"""Compiled loops of the far field of outlines: rows of the grid, a tile of columns at a time.

A tile's buffers stay in the first cache, and its loops have no branches, so that they run in vectors.
Phases arrive as float32 tables of their cosines and sines, taken in float64. From there on float32
serves: what passes through zero is measured from the sample nearest its zero (`line_through`), and
nothing cancels outside the discs about the origin that the caller sums by quadrature.
"""

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.diffraction import _kernels_arcs
from aureole.diffraction._kernels_arcs import (
    F32,
    F64,
    FAST,
    FIELD,
    FREQUENCY,
    HALF,
    INVERSE,
    ONE,
    PLACE,
    ROOT,
    SIZE,
    TILE,
    TOTAL,
    WAVE,
    line_through,
)
from aureole.diffraction._kernels_rows import write_both, write_powers

# Below this phase per edge (radians) the quotient of the edge is summed as a series.
SMALL_PHASE = 0.25


class Waves(NamedTuple):
    """What the loops read, in one unit of length; frequencies in cycles per that unit.

    u, v are the frequencies of the columns (filled up to whole tiles) and of the rows. column_wave
    (2, V, C) and row_wave (2, V, R) hold the real and the imaginary part of exp(−i2π u x) and
    exp(−i2π v y) for every vertex. edges (V, 2) lead from each vertex to the next of its ring. arcs
    (V, 9) hold radius (0 for a straight edge), centre x, y, and cosine and sine of first, last and
    middle angle. starts (K + 1,) is the first vertex of each ring, weights (K,) its signed
    transmittance. near (K, 2, R) are the first column that a ring leaves out in each row, and the
    first after those. discs (M, 2) are radius and transmittance of circles, whose centres are the
    last M vertices.
    """

    u: F64
    v: F64
    column_wave: F32
    row_wave: F32
    edges: F64
    arcs: F64
    starts: NDArray[np.int64]
    weights: F64
    near: NDArray[np.int64]
    discs: F64
    curved: bool


@numba.njit(parallel=True, cache=True)
def fill_field(
    waves: Waves,
    core: NDArray[np.complex64],
    corner: tuple[int, int],
    scale: np.float32,
    out: NDArray[np.complex64],
) -> None:
    """Fill a plane with scale × the far field.

    Parameters
    ----------
    waves : Waves
        As above.
    core : ndarray of complex64
        What the quadrature adds, from the sample (row, column) `corner` on.
    corner : tuple of int
        As said.
    scale : float32
        Factor.
    out : ndarray of complex64, shape (R, columns)
        Filled.
    """
    for row in numba.prange(len(waves.v)):
        line = np.empty((2, len(waves.u)), np.float32)
        _fill_line(waves, core, corner, np.int64(row), line)
        for j in range(out.shape[1]):
            out[row, j] = complex(line[0, j] * scale, line[1, j] * scale)


@numba.njit(parallel=True, cache=True)
def fill_centred_field(
    waves: Waves,
    core: NDArray[np.complex64],
    corner: tuple[int, int],
    scale: np.float32,
    mirror: int,
    out: NDArray[np.complex64],
) -> None:
    """Fill a plane centred on the frequency zero with scale × the far field.

    Parameters
    ----------
    waves : Waves
        At the frequencies of the rows from zero upwards, and of the columns: from zero upwards where
        the outlines are mirror-symmetric, else from as far below zero as they go above it.
    core, corner, scale
        As of `fill_field`.
    mirror : int
        1 where F(−u, v) = F(u, v), −1 where it is the conjugate, 0 where it is neither.
    out : ndarray of complex64, shape (rows, columns)
        Filled.
    """
    rows, columns = out.shape
    for row in numba.prange(len(waves.v)):
        parts = np.empty((4, columns // 2 + 1), np.float32)
        _fill_parts(waves, core, corner, np.int64(row), scale, mirror, parts)
        write_both(parts, np.int64(row), rows // 2, columns // 2, out)


@numba.njit(parallel=True, cache=True)
def fill_centred_power(
    waves: Waves,
    core: NDArray[np.complex64],
    corner: tuple[int, int],
    scale: np.float32,
    mirror: int,
    out: F32,
) -> None:
    """Fill a centred plane with scale² × the squared modulus; parameters as of `fill_centred_field`."""
    rows, columns = out.shape
    for row in numba.prange(len(waves.v)):
        parts = np.empty((4, columns // 2 + 1), np.float32)
        power = np.empty((2, columns // 2 + 1), np.float32)
        _fill_parts(waves, core, corner, np.int64(row), scale, mirror, parts)
        sides = 1 if mirror else 2
        for side in range(sides):
            _square(parts[2 * side], parts[2 * side + 1], power[side])
        write_powers(power[0], power[sides - 1], np.int64(row), rows // 2, columns // 2, out)


@numba.njit(parallel=True, cache=True)
def add_power(
    waves: Waves,
    core: NDArray[np.complex64],
    corner: tuple[int, int],
    scale: np.float32,
    out: F32,
) -> None:
    """Add scale × the far field's squared modulus to a plane; parameters as of `fill_field`."""
    for row in numba.prange(len(waves.v)):
        _add_row(waves, core, corner, scale, np.int64(row), out)


@numba.njit(cache=True)
def _fill_line(
    waves: Waves, core: NDArray[np.complex64], corner: tuple[int, int], row: np.int64, line: F32
) -> None:
    """Fill a row's real and imaginary parts, whole tiles."""
    sums = np.zeros(SIZE, np.float32)
    for low in range(0, line.shape[1], TILE):
        _tile(waves, core, corner, row, low, sums)
        line[0, low : low + TILE] = sums[FIELD : FIELD + TILE]
        line[1, low : low + TILE] = sums[FIELD + TILE : FIELD + 2 * TILE]


@numba.njit(cache=True)
def _fill_parts(
    waves: Waves,
    core: NDArray[np.complex64],
    corner: tuple[int, int],
    row: np.int64,
    scale: np.float32,
    mirror: int,
    parts: F32,
) -> None:
    """Fill F(u, v) and F(−u, v) of a row: real, imaginary, real, imaginary part."""
    line = np.empty((2, len(waves.u)), np.float32)
    _fill_line(waves, core, corner, row, line)
    count = parts.shape[1]
    middle = 0 if mirror else count - 1
    for part in range(2):
        right, left, source = parts[part], parts[2 + part], line[part]
        sign = np.float32(mirror if part else 1)
        for j in range(count):
            right[j] = scale * source[middle + j]
        if mirror:
            for j in range(count):
                left[j] = sign * right[j]
        else:
            for j in range(count):
                # An unsigned index needs no check for counting from the end, which would keep vectors out.
                left[j] = scale * source[np.uint64(middle - j)]


@numba.njit(cache=True, fastmath={"contract", "nsz"})
def _square(real: F32, imag: F32, out: F32) -> None:
    for j in range(len(out)):
        out[j] = real[j] * real[j] + imag[j] * imag[j]


@numba.njit(cache=True)
def _add_row(
    waves: Waves,
    core: NDArray[np.complex64],
    corner: tuple[int, int],
    scale: np.float32,
    row: np.int64,
    out: F32,
) -> None:
    """Add the power along a row."""
    columns = out.shape[1]
    sums = np.zeros(SIZE, np.float32)
    for low in range(0, columns, TILE):
        _tile(waves, core, corner, row, low, sums)
        real, imag = sums[FIELD : FIELD + TILE], sums[FIELD + TILE : FIELD + 2 * TILE]
        part = out[row, low:]
        for j in range(min(TILE, columns - low)):
            part[j] += scale * (real[j] * real[j] + imag[j] * imag[j])


@numba.njit(cache=True)
def _tile(
    waves: Waves,
    core: NDArray[np.complex64],
    corner: tuple[int, int],
    row: np.int64,
    low: int,
    sums: F32,
) -> None:
    """Sum the field of all rings and discs at a tile of columns, and what the quadrature knows."""
    frequency = np.empty(TILE if waves.curved else 0)
    _frequencies(waves.u[low : low + TILE], waves.v[row], frequency, sums)
    for ring in range(len(waves.starts) - 1):
        first = max(waves.near[ring, 0, row] - low, 0)
        after = min(waves.near[ring, 1, row] - low, TILE)
        if after - first == TILE:
            continue
        sums[TOTAL : TOTAL + 2 * TILE] = 0
        _ring(waves, ring, row, low, frequency, sums)
        for j in range(first, after):
            sums[TOTAL + j] = 0
            sums[TOTAL + TILE + j] = 0
        _finish(np.float32(waves.weights[ring]), sums)
    vertex = waves.starts[-1]
    for disc in range(len(waves.discs)):
        _wave(waves, vertex + disc, row, low, sums)
        _kernels_arcs.disc(waves.discs[disc, 0], waves.discs[disc, 1], frequency, sums)
    if 0 <= row - corner[0] < core.shape[0]:
        line = core[row - corner[0]]
        shift = low - corner[1]
        for j in range(max(0, -shift), min(TILE, len(line) - shift)):
            sums[FIELD + j] += line[j + shift].real
            sums[FIELD + TILE + j] += line[j + shift].imag


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _frequencies(u: F64, v: float, frequency: F64, sums: F32) -> None:
    """Clear the field; note |q|, its root, its inverse, and 1 / (2π |q|²) of each sample."""
    for j in range(TILE):
        square = np.float32(u[j] * u[j] + v * v + 1e-30)
        inverse = np.float32(1) / square
        q = np.sqrt(square)
        sums[FIELD + j] = np.float32(0)
        sums[FIELD + TILE + j] = np.float32(0)
        sums[PLACE + j] = np.float32(j)
        sums[FREQUENCY + j] = q
        sums[ROOT + j] = np.sqrt(q)
        sums[INVERSE + j] = q * inverse
        sums[INVERSE + TILE + j] = np.float32(1 / (2 * math.pi)) * inverse
    if len(frequency):
        for j in range(TILE):
            frequency[j] = math.sqrt(u[j] * u[j] + v * v)


@numba.njit(cache=True)
def _ring(waves: Waves, ring: int, row: np.int64, low: int, frequency: F64, sums: F32) -> None:
    """Sum the edges of a ring: i ∮ exp(−i2π q·p) (q × dp)."""
    u, v = waves.u[low : low + TILE], waves.v[row]
    begin, end = waves.starts[ring], waves.starts[ring + 1]
    carried = False
    for vertex in range(begin, end):
        to = vertex + 1 if vertex + 1 < end else begin
        there = _wave_of(waves, to, row, low)
        straight = waves.arcs[vertex, 0] == 0
        if straight:
            if not carried:
                _wave(waves, vertex, row, low, sums)
            _straight(u, v, waves.edges[vertex], there, sums)
        else:
            here = _wave_of(waves, vertex, row, low)
            _kernels_arcs.arc(u, v, waves.arcs[vertex], here, there, frequency, sums)
        carried = straight


@numba.njit(inline="always")
def _wave_of(waves: Waves, vertex: int, row: np.int64, low: int) -> tuple[F32, F32, np.float32, np.float32]:
    """Return a vertex's wave: real and imaginary part of the tile's columns, then of the row."""
    return (
        waves.column_wave[0, vertex, low : low + TILE],
        waves.column_wave[1, vertex, low : low + TILE],
        waves.row_wave[0, vertex, row],
        waves.row_wave[1, vertex, row],
    )


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _wave(waves: Waves, vertex: int, row: np.int64, low: int, sums: F32) -> None:
    """Note exp(−i2π q·p) of a vertex."""
    real, imag, row_real, row_imag = _wave_of(waves, vertex, row, low)
    for j in range(TILE):
        sums[WAVE + j] = real[j] * row_real - imag[j] * row_imag
        sums[WAVE + TILE + j] = real[j] * row_imag + imag[j] * row_real


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _straight(u: F64, v: float, edge: F64, there: tuple[F32, F32, np.float32, np.float32], sums: F32) -> None:
    """Add κ (P − P') / θ, θ = 2π q·e, κ = u e_y − v e_x, and note the wave P' of the edge's end.

    Where θ is small, this is iκ P Σ (−iθ)^k / (k + 1)!.
    """
    line = line_through(u, 2 * math.pi * edge[0], 2 * math.pi * v * edge[1])
    slope, shift, rest = np.float32(line[0]), np.float32(line[1]), np.float32(line[2])
    step, start = np.float32((u[1] - u[0]) * edge[1]), np.float32(u[0] * edge[1] - v * edge[0])
    limit, sixth, twelfth = np.float32(SMALL_PHASE), np.float32(1 / 6), np.float32(1 / 12)
    column_real, column_imag, row_real, row_imag = there
    for j in range(TILE):
        place, here_real, here_imag = sums[PLACE + j], sums[WAVE + j], sums[WAVE + TILE + j]
        phase = slope * (place + shift) + rest
        kappa = place * step + start
        steep = abs(phase) > limit
        factor = kappa / (phase if steep else ONE)
        there_real = column_real[j] * row_real - column_imag[j] * row_imag
        there_imag = column_real[j] * row_imag + column_imag[j] * row_real
        square = phase * phase
        even = kappa * (ONE - sixth * square * (ONE - np.float32(1 / 20) * square))
        odd = -HALF * kappa * phase * (ONE - twelfth * square * (ONE - np.float32(1 / 30) * square))
        flat_real = -(even * here_imag + odd * here_real)
        flat_imag = even * here_real - odd * here_imag
        sums[TOTAL + j] += factor * (here_real - there_real) if steep else flat_real
        sums[TOTAL + TILE + j] += factor * (here_imag - there_imag) if steep else flat_imag
        sums[WAVE + j] = there_real
        sums[WAVE + TILE + j] = there_imag


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _finish(weight: np.float32, sums: F32) -> None:
    """Add weight / (2π |q|²) × the ring's sum to the field."""
    for j in range(TILE):
        factor = weight * sums[INVERSE + TILE + j]
        sums[FIELD + j] += factor * sums[TOTAL + j]
        sums[FIELD + TILE + j] += factor * sums[TOTAL + TILE + j]
