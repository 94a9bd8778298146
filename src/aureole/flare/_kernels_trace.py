"""Compiled loop of rays through a lens: a block of rays goes from surface to surface on one way.

A block is a table with a row for each quantity; its rays are measured from the vertex of the surface that
they are at, so that lengths stay small. A ray that is lost keeps its last state.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
BLOCK = 128
NEWTON_STEPS = 8
# Rows of a block: position, direction, whether the ray goes on, what it carries, how far from the axis.
X, Y, Z, DX, DY, DZ, ALIVE, WEIGHT, LEVEL, STOP_X, STOP_Y, STOP = range(12)
# Rows for one step: point and normal on the surface, whether it was met, cosines before and behind.
HIT_X, HIT_Y, HIT_Z, NX, NY, NZ, MET, BEFORE, BEHIND = range(12, 21)
ROWS = 21


@numba.njit(cache=True, error_model="numpy", parallel=True)
def follow(
    points: Numbers,
    direction: Numbers,
    pieces: NDArray[np.int64],
    ways: NDArray[np.int64],
    shapes: Numbers,
    aspheres: Numbers,
    indices: Numbers,
    shares: Numbers,
    floats: NDArray[np.float32],
    reached: NDArray[np.bool_],
) -> None:
    """Follow pieces of work, each a run of rays on one way at one wavelength.

    Parameters
    ----------
    points : ndarray, shape (N, 2)
        Where rays cross the plane of the first vertex.
    direction : ndarray, shape (3,)
        Unit vector of travel.
    pieces : ndarray of int64, shape (P, 6)
        First point, number of points, wavelength, first and last + 1 of the way's steps, first ray written.
    ways : ndarray of int64, shape (steps, 2)
        Surface, and 1 where it throws the light back.
    shapes : ndarray, shape (S + 1, 9)
        Curvature, curved along x, along y, 1 + conic constant, place, 1 over the square of the semi-aperture,
        kind (0 sphere, 1 any other), 1 over the stop's radius (0 elsewhere), whether a coating is
        on it; the last row is the sensor.
    aspheres : ndarray, shape (S, M)
        Coefficients of r⁴, r⁶, ...
    indices : ndarray, shape (W, S + 1)
        Of the media before each surface and behind the last.
    shares : ndarray, shape (W, S, 2, 12)
        Polynomials in 2 cos - 1, on the side of the lower index, of what coatings let through and throw back.
    floats : ndarray of float32, shape (6, rays)
        Filled: x, y, weight, level, stop_x, stop_y.
    reached : ndarray of bool, shape (rays,)
        Filled.
    """
    for k in numba.prange(len(pieces)):
        first, count, wave, begin, end, written = pieces[k]
        rays = np.empty((ROWS, BLOCK))
        for start in range(0, count, BLOCK):
            size = min(BLOCK, count - start)
            _launch(rays, points[first + start : first + start + size], direction)
            _through(rays, ways[begin:end], shapes, aspheres, indices[wave], shares[wave])
            _arrive(rays, floats, reached, written + start, size)


@numba.njit(cache=True)
def _launch(rays: Numbers, points: Numbers, direction: Numbers) -> None:
    """Set a block of parallel rays out; a block that is not full repeats its last ray."""
    for i in range(BLOCK):
        k = min(i, len(points) - 1)
        rays[X, i], rays[Y, i], rays[Z, i] = points[k, 0], points[k, 1], 0.0
        rays[DX, i], rays[DY, i], rays[DZ, i] = direction[0], direction[1], direction[2]
        rays[ALIVE, i], rays[WEIGHT, i], rays[LEVEL, i] = 1.0, 1.0, 0.0
        rays[STOP_X, i], rays[STOP_Y, i], rays[STOP, i] = 0.0, 0.0, -1.0


@numba.njit(cache=True, error_model="numpy")
def _through(
    rays: Numbers,
    way: NDArray[np.int64],
    shapes: Numbers,
    aspheres: Numbers,
    indices: Numbers,
    shares: Numbers,
) -> None:
    """Take a block through all steps of its way and on to the sensor."""
    ahead, place = True, 0.0
    for step in range(len(way)):
        k, mirror = way[step, 0], way[step, 1] == 1
        shape = shapes[k]
        _move(rays, shape[4] - place)
        place = shape[4]
        if shape[6] == 0.0:
            _meet_sphere(rays, shape[0])
        else:
            _meet_asphere(rays, shape, aspheres[k])
        before, behind = (indices[k], indices[k + 1]) if ahead else (indices[k + 1], indices[k])
        _turn(rays, before / behind, mirror)
        if shape[8] == 1.0:
            low = BEFORE if before <= behind else BEHIND
            _coated(rays, rays[low], shares[k, 1 if mirror else 0])
        elif before != behind or mirror:
            _bare(rays, before, behind, mirror)
        if shape[7] > 0.0:
            _stop(rays, shape[7])
        else:
            _limit(rays, shape[5])
        ahead = ahead != mirror
    _move(rays, shapes[-1, 4] - place)


@numba.njit(cache=True)
def _move(rays: Numbers, distance: float) -> None:
    """Measure a block's rays from another vertex, and from their point nearest to it."""
    for i in range(BLOCK):
        rays[Z, i] -= distance


@numba.njit(cache=True, error_model="numpy")
def _meet_sphere(rays: Numbers, curvature: float) -> None:
    """Find the points on a sphere or plane on the vertex's side, and the normals, which have unit length."""
    for i in range(BLOCK):
        x, y, z = rays[X, i], rays[Y, i], rays[Z, i]
        dx, dy, dz = rays[DX, i], rays[DY, i], rays[DZ, i]
        # From the point of the ray nearest to the vertex nothing cancels in the quadratic's root.
        near = -(x * dx + y * dy + z * dz)
        x, y, z = x + near * dx, y + near * dy, z + near * dz
        rest = curvature * (x * x + y * y + z * z) - 2.0 * z
        inner = dz * dz - curvature * rest
        root = math.sqrt(inner if inner > 0.0 else 0.0)
        below = dz + (root if dz > 0.0 else -root)
        distance = rest / (below if below != 0.0 else 1.0)
        x, y, z = x + distance * dx, y + distance * dy, z + distance * dz
        rays[HIT_X, i], rays[HIT_Y, i], rays[HIT_Z, i] = x, y, z
        normal = 1.0 - curvature * z
        rays[NX, i], rays[NY, i], rays[NZ, i] = -curvature * x, -curvature * y, normal
        met = inner > 0.0 and below != 0.0 and normal > 0.0
        rays[MET, i] = rays[ALIVE, i] if met else 0.0


@numba.njit(cache=True, error_model="numpy")
def _meet_asphere(rays: Numbers, shape: Numbers, asphere: Numbers) -> None:
    """Find the points on a conic, asphere or cylinder, and the unit normals, by Newton's steps."""
    curvature, along_x, along_y, conic = shape[0], shape[1], shape[2], shape[3]
    widest = 1.0 / math.sqrt(shape[5])
    for i in range(BLOCK):
        dx, dy, dz = rays[DX, i], rays[DY, i], rays[DZ, i]
        near = -(rays[X, i] * dx + rays[Y, i] * dy + rays[Z, i] * dz)
        x, y, z = rays[X, i] + near * dx, rays[Y, i] + near * dy, rays[Z, i] + near * dz
        # The conic c (x² + y² + (1 + k) z²) = 2 z, a quadratic in the distance.
        square = curvature * (along_x * dx * dx + along_y * dy * dy + conic * dz * dz)
        half = dz - curvature * (along_x * x * dx + along_y * y * dy + conic * z * dz)
        rest = curvature * (along_x * x * x + along_y * y * y + conic * z * z) - 2.0 * z
        inner = half * half - square * rest
        root = math.copysign(math.sqrt(max(inner, 0.0)), dz)
        alike = half * root >= 0.0
        above, below = (rest, half + root) if alike else (half - root, square)
        met = inner >= 0.0 and below != 0.0
        distance = above / below if met else 0.0
        step, slope, reach = 0.0, 0.0, 1.0
        for turn in range(NEWTON_STEPS + 1):
            hx, hy, hz = x + distance * dx, y + distance * dy, z + distance * dz
            sag, slope, reach = _sag(curvature, conic, asphere, along_x * hx * hx + along_y * hy * hy)
            if len(asphere) == 0 or turn == NEWTON_STEPS:
                break
            rate = dz - 2.0 * slope * (along_x * hx * dx + along_y * hy * dy)
            step = (hz - sag) / (rate if abs(rate) > 1e-9 else 1.0)
            # A step longer than the surface is wide leads nowhere.
            step = min(max(step, -widest), widest)
            distance -= step
            if abs(step) < 1e-13:
                break
        hx, hy, hz = x + distance * dx, y + distance * dy, z + distance * dz
        nx, ny = -2.0 * slope * along_x * hx, -2.0 * slope * along_y * hy
        length = 1.0 / math.sqrt(1.0 + nx * nx + ny * ny)
        rays[HIT_X, i], rays[HIT_Y, i], rays[HIT_Z, i] = hx, hy, hz
        rays[NX, i], rays[NY, i], rays[NZ, i] = nx * length, ny * length, length
        rays[MET, i] = rays[ALIVE, i] if met and reach > 1e-12 and abs(step) < 1e-12 else 0.0


@numba.njit(cache=True, error_model="numpy")
def _sag(curvature: float, conic: float, asphere: Numbers, square: float) -> tuple[float, float, float]:
    """Return a surface's sag, its slope over r², and what is above 0 as far as its conic reaches."""
    inner = 1.0 - conic * curvature * curvature * square
    root = math.sqrt(max(inner, 1e-12))
    sag, slope, power = curvature * square / (1.0 + root), curvature / (2.0 * root), square
    for m in range(len(asphere)):
        slope += (m + 2) * asphere[m] * power
        power *= square
        sag += asphere[m] * power
    return sag, slope, inner


@numba.njit(cache=True, error_model="numpy")
def _turn(rays: Numbers, ratio: float, mirror: bool) -> None:
    """Bend rays by the vector form of Snell's law, or throw them back; lost rays keep their state."""
    on, kept = (0.0, 1.0) if mirror else (1.0, ratio)
    for i in range(BLOCK):
        nx, ny, nz = rays[NX, i], rays[NY, i], rays[NZ, i]
        dx, dy, dz = rays[DX, i], rays[DY, i], rays[DZ, i]
        along = nx * dx + ny * dy + nz * dz
        # What is left along the normal after n sin θ is kept; nothing is where all light is reflected.
        inner = 1.0 - ratio * ratio * (1.0 - along * along)
        behind = math.sqrt(inner if inner > 0.0 else 0.0)
        rays[BEFORE, i], rays[BEHIND, i] = abs(along), behind
        signed = behind if along > 0.0 else -behind
        turn = on * (signed - ratio * along) - (1.0 - on) * 2.0 * along
        goes = rays[MET, i] > 0.0 and (mirror or inner > 0.0)
        rays[X, i] = rays[HIT_X, i] if goes else rays[X, i]
        rays[Y, i] = rays[HIT_Y, i] if goes else rays[Y, i]
        rays[Z, i] = rays[HIT_Z, i] if goes else rays[Z, i]
        rays[DX, i] = kept * dx + turn * nx if goes else dx
        rays[DY, i] = kept * dy + turn * ny if goes else dy
        rays[DZ, i] = kept * dz + turn * nz if goes else dz
        rays[ALIVE, i] = 1.0 if goes else 0.0


@numba.njit(cache=True, error_model="numpy")
def _bare(rays: Numbers, before: float, behind: float, mirror: bool) -> None:
    """Multiply weights by what a bare surface lets through or throws back (Fresnel, both polarisations)."""
    for i in range(BLOCK):
        one, other = rays[BEFORE, i], rays[BEHIND, i]
        s_before, s_behind = before * one, behind * other
        p_before, p_behind = behind * one, before * other
        s, p = (s_before + s_behind) ** 2, (p_before + p_behind) ** 2
        below = s * p
        back = (s_before - s_behind) ** 2 * p + (p_before - p_behind) ** 2 * s
        on = 4.0 * s_before * s_behind * (s + p)
        share = 0.5 * (back if mirror else on) / (below if below > 0.0 else 1.0)
        rays[WEIGHT, i] *= share


@numba.njit(cache=True, error_model="numpy")
def _coated(rays: Numbers, cosines: Numbers, c: Numbers) -> None:
    """Multiply weights by a polynomial of the cosine on the side of the lower index."""
    c0, c1, c2, c3, c4, c5 = c[0], c[1], c[2], c[3], c[4], c[5]
    c6, c7, c8, c9, c10, c11 = c[6], c[7], c[8], c[9], c[10], c[11]
    for i in range(BLOCK):
        t = 2.0 * cosines[i] - 1.0
        upper = c6 + t * (c7 + t * (c8 + t * (c9 + t * (c10 + t * c11))))
        share = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * upper)))))
        rays[WEIGHT, i] *= share


@numba.njit(cache=True)
def _limit(rays: Numbers, scale: float) -> None:
    """Keep the largest square of the distance from the axis, in semi-apertures."""
    for i in range(BLOCK):
        square = (rays[X, i] * rays[X, i] + rays[Y, i] * rays[Y, i]) * scale
        rays[LEVEL, i] = square if square > rays[LEVEL, i] else rays[LEVEL, i]


@numba.njit(cache=True)
def _stop(rays: Numbers, scale: float) -> None:
    """Keep where a ray crosses the stop outermost; a crossing further in counts in the level."""
    for i in range(BLOCK):
        x, y = rays[X, i] * scale, rays[Y, i] * scale
        square = x * x + y * y
        outer = square > rays[STOP, i]
        inner = rays[STOP, i] if outer else square
        rays[LEVEL, i] = inner if inner > rays[LEVEL, i] else rays[LEVEL, i]
        rays[STOP_X, i] = x if outer else rays[STOP_X, i]
        rays[STOP_Y, i] = y if outer else rays[STOP_Y, i]
        rays[STOP, i] = square if outer else rays[STOP, i]


@numba.njit(cache=True, error_model="numpy")
def _arrive(
    rays: Numbers, floats: NDArray[np.float32], reached: NDArray[np.bool_], written: int, size: int
) -> None:
    """Carry a block's rays on to the sensor, and write what they bring there."""
    for i in range(size):
        k, dz = written + i, rays[DZ, i]
        lands = rays[ALIVE, i] > 0.0 and dz > 1e-9
        distance = -rays[Z, i] / dz if lands else 0.0
        floats[0, k] = rays[X, i] + distance * rays[DX, i]
        floats[1, k] = rays[Y, i] + distance * rays[DY, i]
        floats[2, k] = rays[WEIGHT, i] if lands else 0.0
        floats[3, k] = math.sqrt(rays[LEVEL, i])
        floats[4, k] = rays[STOP_X, i]
        floats[5, k] = rays[STOP_Y, i]
        reached[k] = lands
