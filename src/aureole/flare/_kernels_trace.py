"""Compiled loop of rays through a lens: a block of rays goes from surface to surface on one way.

A block is a table with a row for each quantity; its rays are measured from the vertex of the surface that
they are at, so that lengths stay small. A ray that is lost keeps its last state.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

import numba
import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
Singles = NDArray[np.float32]
# A number in the precision of a block, or in that of the tables.
Real = Any
Function = TypeVar("Function", bound=Callable[..., Any])
BLOCK = 128
NEWTON_STEPS = 8
# Rows of a block: position, direction, whether the ray goes on, the part of its power that is left, the
# square of its largest relative radius, where it crossed the stop, the cosines before and behind a surface.
X, Y, Z, DX, DY, DZ, ALIVE, WEIGHT, LEVEL, STOP_X, STOP_Y, BEFORE, BEHIND = range(0, 13 * BLOCK, BLOCK)
ROWS = 13
ZERO, HALF, ONE, TWO = np.float32(0.0), np.float32(0.5), np.float32(1.0), np.float32(2.0)
# Rays that travel less than this along the axis do not reach the sensor; squares of radii end at the second.
LEAST, FARTHEST = np.float32(1e-9), np.float32(1e12)


def _inner(forceinline: bool = False) -> Callable[[Function], Function]:
    """Compile what only `follow` calls: without a door of its own, which takes a third off its making."""
    options: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}, "forceinline": forceinline}
    options |= {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    compiled: Callable[[Function], Function] = numba.njit(**options)
    return compiled


@numba.njit(cache=True, nogil=True)
def follow(
    pieces: NDArray[np.int64],
    points: Numbers,
    direction: Numbers,
    ways: NDArray[np.int64],
    shapes: Numbers,
    aspheres: Numbers,
    indices: Numbers,
    shares: Singles,
    floats: Singles,
    reached: NDArray[np.bool_],
) -> None:
    """Follow pieces of work, each a run of rays on one way at one wavelength.

    Parameters
    ----------
    pieces : ndarray of int64, shape (P, 6)
        First point, number of points, wavelength, first and last + 1 of the way's steps, first ray written.
    points : ndarray, shape (N, 2)
        Where rays cross the plane of the first vertex.
    direction : ndarray, shape (3,)
        Unit vector of travel.
    ways : ndarray of int64, shape (steps, 3)
        Surface, 1 where it throws the light back, and 1 where this crossing of the stop is told.
    shapes : ndarray, shape (S + 1, 9)
        Curvature, curved along x, along y, 1 + conic constant, place, 1 over the square of the semi-aperture,
        kind (0 sphere, 1 any other), 1 over the stop's radius (0 elsewhere), whether a coating is
        on it; the last row is the sensor.
    aspheres : ndarray, shape (S, M)
        Coefficients of r⁴, r⁶, ...
    indices : ndarray, shape (W, S + 1)
        Of the media before each surface and behind the last.
    shares : ndarray of float32, shape (W, S, 2, 12)
        Polynomials in 2 cos - 1, on the side of the lower index, of what coatings let through and throw back.
    floats : ndarray of float32, shape (6, rays)
        Filled: x, y, weight, level, stop_x, stop_y.
    reached : ndarray of bool, shape (rays,)
        Filled.
    """
    rays = np.empty(ROWS * BLOCK, dtype=np.float32)
    for k in range(len(pieces)):
        first, count, wave, begin, end, written = pieces[k]
        for start in range(0, count, BLOCK):
            size = min(BLOCK, count - start)
            _launch(rays, points[first + start : first + start + size], direction)
            _through(rays, ways[begin:end], shapes, aspheres, indices[wave], shares[wave])
            _arrive(rays, floats, reached, written + start, size)


@_inner()
def _launch(rays: Singles, points: Numbers, direction: Numbers) -> None:
    """Set a block of parallel rays out; a block that is not full repeats its last ray."""
    for i in range(BLOCK):
        k = min(i, len(points) - 1)
        rays[X + i], rays[Y + i], rays[Z + i] = points[k, 0], points[k, 1], ZERO
        rays[DX + i], rays[DY + i], rays[DZ + i] = direction[0], direction[1], direction[2]
        rays[ALIVE + i], rays[WEIGHT + i], rays[LEVEL + i] = ONE, ONE, ZERO
        rays[STOP_X + i], rays[STOP_Y + i] = ZERO, ZERO


@_inner()
def _through(
    rays: Singles,
    way: NDArray[np.int64],
    shapes: Numbers,
    aspheres: Numbers,
    indices: Numbers,
    shares: Singles,
) -> None:
    """Take a block through all steps of its way and on to the sensor's plane."""
    ahead, place = True, 0.0
    for step in range(len(way)):
        k, mirror = way[step, 0], way[step, 1] == 1
        shape = shapes[k]
        at_stop, shift = shape[7] > 0.0, shape[4] - place
        before, behind = (indices[k], indices[k + 1]) if ahead else (indices[k + 1], indices[k])
        ratio, scale = before / behind, 0.0 if at_stop else shape[5]
        if shape[6] == 0.0:
            _sphere(rays, *_singles(shape[0], shift, ratio, scale), mirror)
        else:
            _asphere(rays, shape, aspheres[k], shift, ratio, scale, mirror)
        if shape[8] == 1.0:
            _coated(rays, BEFORE if before <= behind else BEHIND, shares[k, 1 if mirror else 0])
        elif before != behind or mirror:
            _bare(rays, np.float32(before), np.float32(behind), mirror)
        if at_stop:
            _stop(rays, np.float32(shape[7]), way[step, 2] == 1)
        ahead, place = ahead != mirror, shape[4]
    for i in range(BLOCK):
        rays[Z + i] -= np.float32(shapes[-1, 4] - place)


@_inner(forceinline=True)
def _singles(a: Real, b: Real, c: Real, d: Real) -> tuple[Real, Real, Real, Real]:
    """Return four numbers in single precision."""
    return np.float32(a), np.float32(b), np.float32(c), np.float32(d)


@_inner()
def _sphere(rays: Singles, curvature: Real, shift: Real, ratio: Real, scale: Real, mirror: bool) -> None:
    """Take rays to a sphere or plane, on its vertex's side, and bend them or throw them back there."""
    for i in range(BLOCK):
        x, y, z = rays[X + i], rays[Y + i], rays[Z + i] - shift
        dx, dy, dz = rays[DX + i], rays[DY + i], rays[DZ + i]
        # From the point of the ray nearest to the vertex nothing cancels in the quadratic's root.
        near = x * dx + y * dy + z * dz
        x, y, z = x - near * dx, y - near * dy, z - near * dz
        rest = curvature * (x * x + y * y + z * z) - TWO * z
        inner = dz * dz - curvature * rest
        root = math.sqrt(inner if inner > ZERO else ZERO)
        along = root if dz > ZERO else -root
        below = dz + along
        distance = rest / (below if below != ZERO else ONE)
        x, y, z = x + distance * dx, y + distance * dy, z + distance * dz
        # The normal has unit length, and the root is the cosine to it.
        nx, ny, nz = -curvature * x, -curvature * y, ONE - curvature * z
        met = inner > ZERO and below != ZERO and nz > ZERO
        kept, turn, behind, left = _bend(along, ratio, mirror)
        heading = kept * dx + turn * nx, kept * dy + turn * ny, kept * dz + turn * nz
        _settle(rays, i, met, left, (x, y, z), heading, scale)
        rays[BEFORE + i], rays[BEHIND + i] = root, behind


@_inner()
def _asphere(
    rays: Singles, shape: Numbers, asphere: Numbers, shift: Real, ratio: Real, scale: Real, mirror: bool
) -> None:
    """Take rays to a conic, asphere or cylinder by Newton's steps, and bend them or throw them back there."""
    curvature, along_x, along_y, conic = shape[0], shape[1], shape[2], shape[3]
    widest = 1.0 / math.sqrt(shape[5])
    for i in range(BLOCK):
        dx, dy, dz = float(rays[DX + i]), float(rays[DY + i]), float(rays[DZ + i])
        x, y, z = float(rays[X + i]), float(rays[Y + i]), float(rays[Z + i]) - shift
        near = x * dx + y * dy + z * dz
        x, y, z = x - near * dx, y - near * dy, z - near * dz
        distance, met = _to_conic(shape, x, y, z, dx, dy, dz)
        step, slope, reach = 0.0, 0.0, 1.0
        for turn in range(NEWTON_STEPS + 1):
            px, py, pz = x + distance * dx, y + distance * dy, z + distance * dz
            sag, slope, reach = _sag(curvature, conic, asphere, along_x * px * px + along_y * py * py)
            rate = dz - 2.0 * slope * (along_x * px * dx + along_y * py * dy)
            step = (pz - sag) / (rate if abs(rate) > 1e-9 else 1.0)
            if turn == NEWTON_STEPS or abs(step) < 1e-12:
                break
            # A step longer than the surface is wide leads nowhere.
            distance -= min(max(step, -widest), widest)
        x, y, z = x + distance * dx, y + distance * dy, z + distance * dz
        nx, ny = -2.0 * slope * along_x * x, -2.0 * slope * along_y * y
        nz = 1.0 / math.sqrt(1.0 + nx * nx + ny * ny)
        nx, ny = nx * nz, ny * nz
        along = nx * dx + ny * dy + nz * dz
        kept, turned, behind, left = _bend(along, ratio, mirror)
        heading = kept * dx + turned * nx, kept * dy + turned * ny, kept * dz + turned * nz
        met = met and reach > 1e-12 and abs(step) < 1e-9
        _settle(rays, i, met, left, (x, y, z), heading, scale)
        rays[BEFORE + i], rays[BEHIND + i] = abs(along), behind


@_inner(forceinline=True)
def _bend(along: Real, ratio: Real, mirror: bool) -> tuple[Real, Real, Real, Real]:
    """Return what is kept of a direction, what of the normal joins it, the cosine behind, and its square.

    The vector form of Snell's law keeps n sin θ along the surface; the rest is along the normal, and its
    square is negative where all light is reflected.
    """
    inner = ONE - ratio * ratio * (ONE - along * along)
    behind = math.sqrt(inner if inner > ZERO else ZERO)
    turn = -TWO * along if mirror else (behind if along > ZERO else -behind) - ratio * along
    return (ONE if mirror else ratio), turn, behind, ONE if mirror else inner


@_inner(forceinline=True)
def _settle(
    rays: Singles,
    i: int,
    met: bool,
    inner: Real,
    place: tuple[Real, Real, Real],
    heading: tuple[Real, Real, Real],
    scale: Real,
) -> None:
    """Give a ray its new state and note how far from the axis it is; a lost one keeps its last state."""
    x, y, z = place
    dx, dy, dz = heading
    old_x, old_y, old_z, level = rays[X + i], rays[Y + i], rays[Z + i], rays[LEVEL + i]
    old_dx, old_dy, old_dz, alive = rays[DX + i], rays[DY + i], rays[DZ + i], rays[ALIVE + i] > ZERO
    goes = alive and met and inner > ZERO
    rays[X + i], rays[Y + i], rays[Z + i] = x if goes else old_x, y if goes else old_y, z if goes else old_z
    rays[DX + i] = dx if goes else old_dx
    rays[DY + i] = dy if goes else old_dy
    rays[DZ + i] = dz if goes else old_dz
    rays[ALIVE + i] = ONE if goes else ZERO
    # How far out a ray is lost tells the way back.
    square = (x * x + y * y) * scale
    far = square if inner > ZERO or not met else ONE - inner
    rays[LEVEL + i] = far if alive and far > level else level


@_inner()
def _to_conic(shape: Numbers, x: Real, y: Real, z: Real, dx: Real, dy: Real, dz: Real) -> tuple[Real, bool]:
    """Return the distance to c (x² + y² + (1 + k) z²) = 2 z, and whether there is one."""
    curvature, along_x, along_y, conic = shape[0], shape[1], shape[2], shape[3]
    square = curvature * (along_x * dx * dx + along_y * dy * dy + conic * dz * dz)
    half = dz - curvature * (along_x * x * dx + along_y * y * dy + conic * z * dz)
    rest = curvature * (along_x * x * x + along_y * y * y + conic * z * z) - 2.0 * z
    inner = half * half - square * rest
    root = math.copysign(math.sqrt(max(inner, 0.0)), dz)
    # Of the root's two forms the one in which nothing cancels.
    above, below = (rest, half + root) if half * root >= 0.0 else (half - root, square)
    met = inner >= 0.0 and below != 0.0
    return above / below if met else 0.0, met


@_inner()
def _sag(curvature: Real, conic: Real, asphere: Numbers, square: Real) -> tuple[Real, Real, Real]:
    """Return a surface's sag, its slope over r², and what is above 0 as far as its conic reaches."""
    inner = 1.0 - conic * curvature * curvature * square
    root = math.sqrt(max(inner, 1e-12))
    sag, slope, power = curvature * square / (1.0 + root), curvature / (2.0 * root), square
    for m in range(len(asphere)):
        slope += (m + 2) * asphere[m] * power
        power *= square
        sag += asphere[m] * power
    return sag, slope, inner


@_inner()
def _bare(rays: Singles, before: Real, behind: Real, mirror: bool) -> None:
    """Multiply weights by what a bare surface lets through or throws back (Fresnel, both polarisations)."""
    for i in range(BLOCK):
        one, other = rays[BEFORE + i], rays[BEHIND + i]
        s_before, s_behind = before * one, behind * other
        p_before, p_behind = behind * one, before * other
        s, p = s_before + s_behind, p_before + p_behind
        s, p = s * s, p * p
        s_less, p_less = s_before - s_behind, p_before - p_behind
        back = s_less * s_less * p + p_less * p_less * s
        on = TWO * TWO * s_before * s_behind * (s + p)
        below = s * p
        rays[WEIGHT + i] *= HALF * (back if mirror else on) / (below if below > ZERO else ONE)


@_inner()
def _coated(rays: Singles, low: int, c: Singles) -> None:
    """Multiply weights by a polynomial of the cosine on the side of the lower index."""
    c0, c1, c2, c3, c4, c5 = c[0], c[1], c[2], c[3], c[4], c[5]
    c6, c7, c8, c9, c10, c11 = c[6], c[7], c[8], c[9], c[10], c[11]
    for i in range(BLOCK):
        t = TWO * rays[low + i] - ONE
        upper = c6 + t * (c7 + t * (c8 + t * (c9 + t * (c10 + t * c11))))
        rays[WEIGHT + i] *= c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * upper)))))


@_inner()
def _stop(rays: Singles, scale: Real, told: bool) -> None:
    """Keep where rays cross the stop, or note in their levels how far from its middle they do."""
    for i in range(BLOCK):
        x, y, level = rays[X + i] * scale, rays[Y + i] * scale, rays[LEVEL + i]
        square = ZERO if told else x * x + y * y
        rays[LEVEL + i] = square if square > level else level
        rays[STOP_X + i] = x if told else rays[STOP_X + i]
        rays[STOP_Y + i] = y if told else rays[STOP_Y + i]


@_inner()
def _arrive(rays: Singles, floats: Singles, reached: NDArray[np.bool_], written: int, size: int) -> None:
    """Carry a block's rays on to the sensor, and write what they bring there."""
    for i in range(size):
        k, dz = written + i, rays[DZ + i]
        lands = rays[ALIVE + i] > ZERO and dz > LEAST
        distance = -rays[Z + i] / dz if lands else ZERO
        floats[0, k] = rays[X + i] + distance * rays[DX + i]
        floats[1, k] = rays[Y + i] + distance * rays[DY + i]
        floats[2, k] = rays[WEIGHT + i] if lands else ZERO
        level = rays[LEVEL + i]
        floats[3, k] = math.sqrt(level if level < FARTHEST else FARTHEST)
        floats[4, k] = rays[STOP_X + i]
        floats[5, k] = rays[STOP_Y + i]
        reached[k] = lands
