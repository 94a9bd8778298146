"""Compiled loops of the far field at an FFT's own frequencies: cosine and sine transforms of quadrants.

A quadrant of a folded mask has real transforms along both axes: Σ x_n cos(π f (2n + 1) / 2M), or the
sine. The cosines are the real part of a turned Fourier transform of M samples, taken in another order
(J. Makhoul, IEEE Trans. Acoust. Speech Signal Process. 28, 1980, Eq. 15-18); the sines at f are the
cosines at M − f of the samples with every other sign changed. Two sequences are transformed as one
complex one, and 64 of those side by side (`aureole.picture._kernels`).

A sequence has M values: the frequency f stands at place f, but that a sine's place 0, which would
hold zeros, holds its frequency M (where a cosine is zero).
"""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.diffraction._kernels_rows import F32, parts_of, write_both, write_powers
from aureole.picture._kernels import LANES, down

SEQUENCES = 2 * LANES
thread_of = numba.get_thread_id  # type: ignore[attr-defined]
# Rows that are turned round together.
GROUP = 16


class Cosines(NamedTuple):
    """What a transform of M samples reads.

    radices (S,), cosines and sines (M,) and places (M + 1,) are those of the Fourier transform;
    turns (2, M) are the cosine and the sine of π f / 2M.
    """

    radices: NDArray[np.int64]
    cosines: F32
    sines: F32
    places: NDArray[np.int64]
    turns: F32


class Plane(NamedTuple):
    """Where the frequencies go.

    weights_y (A,) and weights_x (B,) are factors of the frequencies 0, 1, … along both axes; row_zero
    and column_zero say where the frequency zero is; nyquist is the M of the rows.
    """

    weights_y: F32
    weights_x: F32
    row_zero: int
    column_zero: int
    nyquist: int


def thread_count() -> int:
    """Return how many threads share the loops, each with a work array of its own."""
    return int(numba.get_num_threads())


@numba.njit(cache=True)
def _transform(work: F32, cosines: Cosines) -> None:
    """Transform sequences in Makhoul's order in place; frequencies come out digit-reversed."""
    down(work, cosines.radices, cosines.cosines, cosines.sines)
    size = len(work)
    for f in range(1, size // 2 + 1):
        one, two = work[cosines.places[f]], work[cosines.places[size - f]]
        _part(one, two, cosines.turns[0, f], cosines.turns[1, f])


@numba.njit(cache=True, fastmath={"contract", "nsz"})
def _part(one: F32, two: F32, cosine: np.float32, sine: np.float32) -> None:
    """Part two spectra that are one complex one at f and M − f, and turn them to cosine transforms."""
    half_cosine, half_sine = np.float32(0.5) * cosine, np.float32(0.5) * sine
    for j in range(LANES):
        real, imag, back, behind = one[j], one[LANES + j], two[j], two[LANES + j]
        even, odd = real + back, imag - behind
        other_even, other_odd = imag + behind, back - real
        one[j] = half_cosine * even + half_sine * odd
        one[LANES + j] = half_cosine * other_even + half_sine * other_odd
        two[j] = half_sine * even - half_cosine * odd
        two[LANES + j] = half_sine * other_even - half_cosine * other_odd


@numba.njit(cache=True)
def _place_of(sample: int, size: int) -> int:
    """Return where a sample stands in Makhoul's order: even ones from the start, odd ones from the end."""
    return sample // 2 if sample % 2 == 0 else size - 1 - sample // 2


@numba.njit(cache=True)
def _source(place: int, odd: int, size: int) -> int:
    """Return which of a transform's frequencies stands at a place of the sequence."""
    return size - place if odd and place > 0 else place


@numba.njit(cache=True)
def _copy(source: F32, sign: np.float32, target: F32) -> None:
    for j in range(len(source)):
        target[j] = sign * source[j]


@numba.njit(cache=True, parallel=True)
def along_y(
    quadrants: F32,
    sums: NDArray[np.float64],
    odd: NDArray[np.int64],
    cosines: Cosines,
    works: F32,
    spectra: F32,
) -> None:
    """Transform the columns of quadrants.

    Parameters
    ----------
    quadrants : ndarray of float32, shape (4, h, h)
        From the mask's centre outwards; h at most M.
    sums : ndarray of float64, shape (4, h)
        Zero where a row is to be taken as dark.
    odd : ndarray of int64, shape (P, 2)
        Along (y, x): 1 for sines, 0 for cosines.
    cosines : Cosines
        Of M samples.
    works : ndarray of float32, shape (threads, 1, M, WIDTH)
        Overwritten.
    spectra : ndarray of float32, shape (P, K, W)
        Filled with the first K places of the first W columns.
    """
    parts, _, width = spectra.shape
    blocks = (width + SEQUENCES - 1) // SEQUENCES
    for task in numba.prange(parts * blocks):
        part, first = task // blocks, task % blocks * SEQUENCES
        count = min(SEQUENCES, width - first)
        work = works[thread_of()][0]
        size = len(work)
        work[:] = 0
        quadrant = 2 * odd[part, 0] + odd[part, 1]
        for row in range(quadrants.shape[1]):
            if sums[quadrant, row] > 0:
                sign = np.float32(1 - 2 * (odd[part, 0] & row & 1))
                _copy(quadrants[quadrant, row, first : first + count], sign, work[_place_of(row, size)])
        _transform(work, cosines)
        for place in range(spectra.shape[1]):
            row = cosines.places[_source(place, odd[part, 0], size)]
            _copy(work[row, :count], np.float32(1), spectra[part, place, first:])


@numba.njit(cache=True)
def _load_turned(rows: F32, odd: int, work: F32) -> None:
    """Put rows side by side, their samples in Makhoul's order, with zeros after them."""
    size, count = len(work), rows.shape[1]
    sign = np.float32(1 - 2 * odd)
    for low in range(0, count, GROUP):
        high = min(low + GROUP, count)
        for lane in range(len(rows)):
            row = rows[lane]
            for sample in range(low, high, 2):
                work[np.uint64(sample // 2), np.uint64(lane)] = row[np.uint64(sample)]
            for sample in range(low + 1, high, 2):
                work[np.uint64(size - 1 - sample // 2), np.uint64(lane)] = sign * row[np.uint64(sample)]
    work[(count + 1) // 2 : size - count // 2] = 0
    work[:, len(rows) : SEQUENCES] = 0


@numba.njit(cache=True)
def _turn_back(rows: F32, order: NDArray[np.int64], lane: int, weights: F32, lines: F32) -> None:
    """Write a group of lanes as rows, each frequency with its weight; zeros where its order is −1."""
    for f in range(len(order)):
        if order[f] < 0:
            lines[:, f] = 0
            continue
        row, weight = rows[order[f], lane : lane + GROUP], weights[f]
        for j in range(GROUP):
            lines[j, f] = weight * row[j]


@numba.njit(cache=True)
def _transform_block(
    spectra: F32, odd: NDArray[np.int64], cosines: Cosines, first: np.int64, works: F32
) -> int:
    """Transform a block of rows of all parts along x; return how many they are."""
    count = int(min(SEQUENCES, spectra.shape[1] - first))
    for part in range(len(spectra)):
        _load_turned(spectra[part, first : first + count], odd[part, 1], works[part])
        _transform(works[part], cosines)
    return count


@numba.njit(cache=True)
def _order_of(odd: int, cosines: Cosines, columns: int) -> NDArray[np.int64]:
    """Return where a part's transform has the frequencies, −1 where it has none."""
    size = len(cosines.sines)
    order = np.empty(columns, np.int64)
    for f in range(columns):
        order[f] = cosines.places[_source(f % size, odd, size)]
        if f == (0 if odd else size):
            order[f] = -1
    return order


@numba.njit(cache=True)
def _rows_of(odd: NDArray[np.int64], cosines: Cosines, columns: int) -> NDArray[np.int64]:
    """Return where the work arrays hold the four quadrants' transforms: (part, row) of each frequency.

    What does not exist is looked up in the row after all parts', which holds zeros.
    """
    where = np.zeros((4, columns, 2), np.int64)
    where[:, :, 0] = len(odd)
    for part in range(len(odd)):
        order = _order_of(odd[part, 1], cosines, columns)
        for f in range(columns):
            if order[f] >= 0:
                where[2 * odd[part, 0] + odd[part, 1], f] = part, order[f]
    return where


@numba.njit(cache=True, fastmath={"contract", "nsz"})
def _fill_powers(works: F32, where: NDArray[np.int64], weights: F32, planes: F32) -> None:
    """Square the transforms of a block of rows, right and left of the central column."""
    for f in range(planes.shape[1]):
        a, b = works[where[0, f, 0], where[0, f, 1]], works[where[1, f, 0], where[1, f, 1]]
        c, d = works[where[2, f, 0], where[2, f, 1]], works[where[3, f, 0], where[3, f, 1]]
        right = planes[0, f]
        for j in range(SEQUENCES):
            real, imag = a[j] - d[j], b[j] + c[j]
            right[j] = weights[j] * (real * real + imag * imag)
        if len(planes) > 1:
            left = planes[1, f]
            for j in range(SEQUENCES):
                real, imag = a[j] + d[j], b[j] - c[j]
                left[j] = weights[j] * (real * real + imag * imag)


@numba.njit(cache=True)
def _part_first(works: F32, where: NDArray[np.int64], weight: np.float32, planes: F32, edge: F32) -> None:
    """Square the first lane anew: the even parts' are of the frequency 0, the odd ones' of M (`edge`)."""
    for f in range(planes.shape[1]):
        a, b = works[where[0, f, 0], where[0, f, 1], 0], works[where[1, f, 0], where[1, f, 1], 0]
        c, d = works[where[2, f, 0], where[2, f, 1], 0], works[where[3, f, 0], where[3, f, 1], 0]
        planes[:, f, 0] = weight * (a * a + b * b)
        edge[f] = c * c + d * d


@numba.njit(cache=True, parallel=True)
def power_along_x(
    spectra: F32,
    odd: NDArray[np.int64],
    cosines: Cosines,
    plane: Plane,
    works: F32,
    planes: F32,
    out: F32,
) -> None:
    """Transform the rows of half-transformed quadrants and write the power of the plane.

    Parameters
    ----------
    spectra : ndarray of float32, shape (P, K, W)
        From `along_y`.
    odd : ndarray of int64, shape (P, 2)
        As for `along_y`.
    cosines : Cosines
        Of M samples.
    plane : Plane
        Where the frequencies go; the weights are those of the power.
    works : ndarray of float32, shape (threads, P + 1, M, WIDTH)
        Overwritten.
    planes : ndarray of float32, shape (threads, 1 or 2, B, WIDTH)
        Overwritten; 1 where the power at (−u, v) is that at (u, v).
    out : ndarray of float32, shape (rows, columns)
        Filled.
    """
    sides, columns = planes.shape[1], len(plane.weights_x)
    order, where = np.arange(columns), _rows_of(odd, cosines, columns)
    for block in numba.prange((spectra.shape[1] + SEQUENCES - 1) // SEQUENCES):
        first, thread = np.int64(block) * SEQUENCES, thread_of()
        work, squares = works[thread], planes[thread]
        count = _transform_block(spectra, odd, cosines, first, work)
        weights = np.zeros(SEQUENCES, np.float32)
        weights[:count] = plane.weights_y[first : first + count]
        work[len(odd), 0] = 0
        _fill_powers(work, where, weights, squares)
        edge = np.empty(columns, np.float32)
        if first == 0:
            _part_first(work, where, weights[0], squares, edge)
        lines = np.empty((2, GROUP, columns), np.float32)
        for lane in range(count):
            if lane % GROUP == 0:
                for side in range(sides):
                    _turn_back(squares[side], order, lane, plane.weights_x, lines[side])
            left = lines[sides - 1, lane % GROUP]
            write_powers(lines[0, lane % GROUP], left, first + lane, plane.row_zero, plane.column_zero, out)
        if first == 0 and len(plane.weights_y) > plane.nyquist:
            edge *= plane.weights_y[plane.nyquist] * plane.weights_x
            write_powers(edge, edge, plane.nyquist, plane.row_zero, plane.column_zero, out)


@numba.njit(cache=True)
def _present(odd: NDArray[np.int64], place: np.int64, f: np.int64) -> NDArray[np.bool_]:
    """Return which quadrants hold anything at a frequency of the rows."""
    present = np.zeros(4, np.bool_)
    for part in range(len(odd)):
        if place > 0 or odd[part, 0] == int(f > 0):
            present[2 * odd[part, 0] + odd[part, 1]] = True
    return present


@numba.njit(cache=True, parallel=True)
def field_along_x(
    spectra: F32,
    odd: NDArray[np.int64],
    cosines: Cosines,
    plane: Plane,
    works: F32,
    out: NDArray[np.complex64],
) -> None:
    """Transform the rows of half-transformed quadrants and write the field.

    Parameters as of `power_along_x`; the weights are those of the amplitude.
    """
    columns = len(plane.weights_x)
    orders = [_order_of(parity, cosines, columns) for parity in range(2)]
    for block in numba.prange((spectra.shape[1] + SEQUENCES - 1) // SEQUENCES):
        first, work = np.int64(block) * SEQUENCES, works[thread_of()]
        count = _transform_block(spectra, odd, cosines, first, work)
        lines = np.empty((4, GROUP, columns), np.float32)
        parts = np.empty((4, columns), np.float32)
        for lane in range(count):
            if lane % GROUP == 0:
                for part in range(len(odd)):
                    y, x = odd[part]
                    _turn_back(work[part], orders[x], lane, plane.weights_x, lines[2 * y + x])
            place = first + lane
            for f in (place, np.int64(plane.nyquist if place == 0 else -1)):
                if 0 <= f < len(plane.weights_y):
                    weight = np.float32(plane.weights_y[f])
                    parts_of(lines, _present(odd, place, f), lane % GROUP, weight, parts)
                    write_both(parts, f, plane.row_zero, plane.column_zero, out)
