"""Rays through a lens, compiled: many rays, wavelengths and ghosts at a time.

A ray is named by the point (x, y) where it crosses the plane of the first surface's vertex, its pupil
coordinates. A light's direction points from the lens towards it, z forward, as in `Light`: its rays travel
along (-x, -y, z). What a coating does is a polynomial of the cosine on the side of the lower index; what bare
glass does is Fresnel's formulas themselves. `trace_reference` is the truth.
"""

import functools
import math
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.flare import _kernels_trace as kernels
from aureole.flare import coating, glass, paraxial, rays
from aureole.flare.ghost_paths import GhostPath, steps
from aureole.flare.prescription import Lens, travelling_layers

Numbers = NDArray[np.float64]
Singles = NDArray[np.float32]
Flags = NDArray[np.bool_]
Path = GhostPath | Sequence[int]

# Rays of one piece of work and pieces that a thread takes at a time: enough to outlast their start.
PIECE, TOGETHER = 4096, 4
# How far out a ray that did not arrive counts.
LOST = np.float32(1e3)
# Coefficients of the polynomials of coatings, and the angles that they are fitted at.
TERMS, NODES = 12, 48


@dataclass(frozen=True, eq=False)
class Prepared:
    """A lens as tables of numbers, at certain wavelengths and with its iris set.

    Parameters
    ----------
    lens : Lens
        The lens.
    wavelengths : ndarray, shape (W,)
        Metres.
    stop_radius : float
        Of the round iris, metres.
    shapes : ndarray, shape (S + 1, 9)
        As the compiled loop reads them; the last row is the sensor.
    aspheres : ndarray, shape (S, M)
        Coefficients of r⁴, r⁶, ...
    indices : ndarray, shape (W, S + 1)
        Of the media before each surface and behind the last.
    shares : ndarray of float32, shape (W, S, 2, TERMS)
        Polynomials in 2 cos - 1 of what coatings let through and throw back.
    """

    lens: Lens
    wavelengths: Numbers
    stop_radius: float
    shapes: Numbers
    aspheres: Numbers
    indices: Numbers
    shares: Singles


class Landed:
    """What rays and sheets of rays know alike."""

    level: Singles
    stop_x: Singles
    stop_y: Singles
    reached: Flags

    @property
    def radius(self) -> Singles:
        """How far out each ray goes: 1 on the rim of a surface or of a round iris, LOST where it is lost."""
        stop = np.sqrt(self.stop_x**2 + self.stop_y**2)
        return np.where(self.reached, np.maximum(self.level, stop), LOST)

    @property
    def passed(self) -> Flags:
        """Whether each ray reached the sensor through all semi-apertures and a round iris."""
        return np.asarray(self.radius <= 1.0, dtype=np.bool_)


@dataclass(frozen=True, eq=False)
class Rays(Landed):
    """Where rays of one way land, for W wavelengths and N rays (or rows and columns of them).

    Parameters
    ----------
    x, y : ndarray of float32, shape (W, N)
        On the sensor, metres; the picture is turned by 180 degrees.
    weight : ndarray of float32, shape (W, N)
        Part of the ray's power that reflections and refractions leave.
    level : ndarray of float32, shape (W, N)
        Largest distance from the axis over the semi-aperture, of all surfaces met but one crossing of the
        iris, `told_crossing`'s.
    stop_x, stop_y : ndarray of float32, shape (W, N)
        That crossing, in parts of the iris's radius; ghosts across the stop cross it twice more, and those
        crossings count in the level as if the iris were round. A ray passes a round iris where it reached the
        sensor with level <= 1 and stop_x² + stop_y² <= 1.
    reached : ndarray of bool, shape (W, N)
        Whether the ray met all surfaces; where it did not, the other values are finite and mean nothing.
    """

    x: Singles
    y: Singles
    weight: Singles
    level: Singles
    stop_x: Singles
    stop_y: Singles
    reached: Flags

    def taken(self, which: NDArray[np.intp]) -> "Rays":
        """Return those of a first axis."""
        x, y, weight, level = self.x[which], self.y[which], self.weight[which], self.level[which]
        return Rays(x, y, weight, level, self.stop_x[which], self.stop_y[which], self.reached[which])

    def part(self, first: int, shape: tuple[int, ...]) -> "Rays":
        """Return a run of rays that lie along one axis, as arrays of a shape."""
        run = slice(first, first + math.prod(shape))
        x, y, weight, level, stop_x, stop_y = (
            values[run].reshape(shape)
            for values in (self.x, self.y, self.weight, self.level, self.stop_x, self.stop_y)
        )
        return Rays(x, y, weight, level, stop_x, stop_y, self.reached[run].reshape(shape))


def prepare(lens: Lens, wavelengths: ArrayLike, f_number: float | None = None) -> Prepared:
    """Make the tables that rays are traced by.

    Parameters
    ----------
    lens : Lens
        The lens.
    wavelengths : array_like, shape (W,)
        Metres.
    f_number : float, optional
        Sets the iris; wide open without it.

    Returns
    -------
    Prepared
        For `trace` and its kin.

    Raises
    ------
    refuse.Refusal
        Where a wavelength or the f-number is not above zero, or a glass has no index there.
    """
    waves = refuse.shape_of("wavelengths", np.asarray(wavelengths, dtype=np.float64), (None,))
    wide = lens.surfaces[lens.stop].semi_aperture
    radius = wide if f_number is None else paraxial.stop_radius(lens, f_number)
    found = rays.shapes_of(lens)
    indices = np.stack([glass.index(medium, waves) for medium in rays.media_of(lens)], axis=1)
    coated = np.array([surface.coating is not None for surface in lens.surfaces])
    round_ = (found.along == 1).all(axis=1) & (found.conic == 0) & (found.asphere == 0).all(axis=1)
    shapes = np.zeros((len(lens.surfaces) + 1, 9))
    shapes[:-1, 0], shapes[:-1, 1:3], shapes[:-1, 3] = found.curvature, found.along, 1.0 + found.conic
    shapes[:, 4] = np.append(found.place, sum(surface.thickness for surface in lens.surfaces))
    shapes[:-1, 5] = found.semi_aperture**-2.0
    shapes[:-1, 6] = ~round_
    shapes[lens.stop, 7] = 1.0 / radius
    shapes[:-1, 8] = coated
    return Prepared(lens, waves, radius, shapes, found.asphere, indices, _shares(lens, indices, waves))


def at(prepared: Prepared, which: Sequence[int]) -> Prepared:
    """Return a lens's tables at some of their wavelengths.

    Parameters
    ----------
    prepared : Prepared
        The lens.
    which : sequence of int
        Places among its wavelengths.

    Returns
    -------
    Prepared
        Of as many wavelengths.
    """
    few = list(which)
    waves, indices, shares = prepared.wavelengths[few], prepared.indices[few], prepared.shares[few]
    return replace(prepared, wavelengths=waves, indices=indices, shares=shares)


def trace(prepared: Prepared, path: Path, points: ArrayLike, direction: ArrayLike) -> Rays:
    """Trace parallel rays by the image's way or a ghost's.

    Parameters
    ----------
    prepared : Prepared
        The lens, from `prepare`.
    path : GhostPath or sequence of int
        The reflections; () is the image.
    points : array_like, shape (N, 2)
        Pupil coordinates (x, y): where rays cross the plane of the first vertex, metres.
    direction : array_like, shape (3,)
        From the lens towards the light, z > 0, of any length.

    Returns
    -------
    Rays
        At all wavelengths.

    Raises
    ------
    refuse.Refusal
        Where the light stands behind the lens, or the reflections are no way through it.
    """
    places = refuse.all_finite("points", refuse.shape_of("points", points, (None, 2))).astype(np.float64)
    found = follow(prepared, [path], [len(places)], places, travel(direction))
    return found.part(0, (len(prepared.wavelengths), len(places)))


def travel(direction: ArrayLike) -> Numbers:
    """Return the direction in which a light's rays travel.

    Parameters
    ----------
    direction : array_like, shape (3,)
        From the lens towards the light, z > 0, of any length.

    Returns
    -------
    ndarray, shape (3,)
        Unit vector along (-x, -y, z).

    Raises
    ------
    refuse.Refusal
        Where the light stands behind the lens.
    """
    towards = refuse.all_finite("direction", refuse.shape_of("direction", direction, (3,)))
    if towards[2] <= 0:
        raise refuse.Refusal(f"'direction' must point forward, z > 0, got z = {towards[2]:g}.")
    along = towards.astype(np.float64) * (-1.0, -1.0, 1.0)
    return np.asarray(along / np.linalg.norm(along))


def reflections(path: Path) -> tuple[int, ...]:
    """Return the reflecting surfaces of a path.

    Parameters
    ----------
    path : GhostPath or sequence of int
        Either form.

    Returns
    -------
    tuple of int
        () for the image.
    """
    return path.reflections if isinstance(path, GhostPath) else tuple(path)


def follow(
    prepared: Prepared, paths: Sequence[Path], counts: Sequence[int], points: Numbers, along: Numbers
) -> Rays:
    """Trace a set of points for each of many paths, as one piece of work for all threads.

    Parameters
    ----------
    prepared : Prepared
        The lens.
    paths : sequence
        The ways.
    counts : sequence of int
        Points of each path.
    points : ndarray, shape (sum of counts, 2)
        Pupil coordinates, path after path, metres.
    along : ndarray, shape (3,)
        Unit vector of travel, from `travel`.

    Returns
    -------
    Rays
        Arrays of one axis: path after path, for each all wavelengths, for each all points.
    """
    waves = len(prepared.wavelengths)
    ways = [_way(prepared, path) for path in paths]
    ends = np.cumsum([0, *(len(way) for way in ways)])
    starts = np.cumsum([0, *counts])
    pieces = []
    for g, count in enumerate(counts):
        for k in range(0, count, PIECE):
            size, way, first = min(PIECE, count - k), (ends[g], ends[g + 1]), starts[g] + k
            pieces += [(first, size, w, *way, starts[g] * waves + w * count + k) for w in range(waves)]
    total = int(starts[-1]) * waves
    floats, reached = np.empty((6, total), dtype=np.float32), np.empty(total, dtype=np.bool_)
    if total:
        order = np.array(pieces, dtype=np.int64)
        tables = prepared.shapes, prepared.aspheres, prepared.indices, prepared.shares
        rest = points, along, np.concatenate(ways), *tables, floats, reached
        # Each thread takes the next few pieces as it is done with its last ones.
        turns = [order[k : k + TOGETHER] for k in range(0, len(order), TOGETHER)]
        for _ in _pool().map(lambda some: kernels.follow(some, *rest), turns):
            pass
    x, y, weight, level, stop_x, stop_y = floats
    return Rays(x, y, weight, level, stop_x, stop_y, reached)


def told_crossing(prepared: Prepared, path: Path) -> int:
    """Return which of a way's crossings of the stop is told by `stop_x` and `stop_y`: the widest one.

    Parameters
    ----------
    prepared : Prepared
        The lens.
    path : GhostPath or sequence of int
        The way.

    Returns
    -------
    int
        Counted from 0; where the ray near the axis is highest on the stop. It is the same for all rays, so
        that places on the stop can be interpolated between them.
    """
    way = steps(prepared.lens, reflections(path))
    if sum(k == prepared.lens.stop for k, _ in way) < 2:
        return 0
    heights = []
    curvatures, places = prepared.shapes[:, 0] * prepared.shapes[:, 2], prepared.shapes[:, 4]
    indices = prepared.indices[len(prepared.indices) // 2]
    height, slope, place, ahead = 1.0, 0.0, 0.0, True
    for k, mirror in way:
        height += slope * (places[k] - place)
        lean = curvatures[k] * height
        if k == prepared.lens.stop:
            heights.append(abs(height))
        if mirror:
            slope, ahead = -slope - 2.0 * lean, not ahead
        else:
            before, behind = (k, k + 1) if ahead else (k + 1, k)
            slope = indices[before] / indices[behind] * (slope + lean) - lean
        place = places[k]
    return int(np.argmax(heights))


def _way(prepared: Prepared, path: Path) -> NDArray[np.int64]:
    """Return a way's steps: surface, whether it throws back, whether this crossing of the stop is told."""
    way = np.array([(*step, 0) for step in steps(prepared.lens, reflections(path))], dtype=np.int64)
    crossings = np.flatnonzero(way[:, 0] == prepared.lens.stop)
    way[crossings[told_crossing(prepared, path)], 2] = 1
    return way


@functools.cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(os.cpu_count() or 1, thread_name_prefix="ghosts")


def _shares(lens: Lens, indices: Numbers, waves: Numbers) -> Singles:
    """Return the polynomials of all coatings, zero where there is none."""
    cosines, fit = _fit()
    shares = np.zeros((len(waves), len(lens.surfaces), 2, TERMS), dtype=np.float32)
    for k, surface in enumerate(lens.surfaces):
        for ahead in (True, False):
            here = (indices[:, k] <= indices[:, k + 1]) == ahead
            if surface.coating is None or not here.any():
                continue
            # Light comes from the side of the lower index.
            media = lens.glass_before(k), surface.glass
            before, behind = media if ahead else media[::-1]
            layers = travelling_layers(lens, k, ahead)
            back, on = coating.reflectance(layers, before, behind, cosines[:, None], waves[None, here])
            shares[here, k, 0], shares[here, k, 1] = (fit @ on).T, (fit @ back).T
    return shares


@functools.cache
def _fit() -> tuple[Numbers, Numbers]:
    """Return cosines, and the matrix from values there to coefficients of powers of 2 cos - 1."""
    place = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    basis = np.polynomial.chebyshev.chebvander(place, TERMS - 1)
    powers = np.zeros((TERMS, TERMS))
    for k in range(TERMS):
        powers[: k + 1, k] = np.polynomial.chebyshev.cheb2poly(np.eye(TERMS)[k, : k + 1])
    # Little light meets glass at grazing angles, so errors there count less.
    trust = (0.05 + (1.0 + place) / 2.0)[:, None]
    return (1.0 + place) / 2.0, powers @ np.linalg.pinv(trust * basis) * trust.T
