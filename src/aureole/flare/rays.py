"""Real rays through a lens: the slow, obvious truth that faster tracers are tested against.

One loop serves the image and every ghost: at each step a ray goes to its next surface, and is refracted or
thrown back there. Surfaces are conics and even aspheres, along one axis only where they are cylinders.
Light starts in front of the lens and travels along +z; the first surface's vertex is the origin.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.flare import coating, glass
from aureole.flare.ghost_paths import steps
from aureole.flare.prescription import Lens, travelling_layers

# Newton's steps from a conic to its asphere, each of which doubles the digits.
NEWTON_STEPS = 12
Numbers = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Traced:
    """Rays that went through a lens.

    Parameters
    ----------
    positions, directions : ndarray, shape (N, 3)
        At the sensor's plane, metres, and unit vectors; where a ray was lost, its last ones.
    reached : ndarray of bool, shape (N,)
        Whether the ray met every surface and was never wholly reflected where it should go through.
    relative_radius : ndarray, shape (N,)
        Largest distance from the axis over the semi-aperture, of all surfaces met; above 1 the ray is
        blocked, and is traced on so that neighbours can be interpolated.
    surfaces : ndarray of int, shape (steps, N)
        Index of the surface met at each step; -1 where a shorter way has ended.
    reflected : ndarray of bool, shape (steps, N)
        Whether the ray was thrown back there.
    points : ndarray, shape (steps + 2, N, 3)
        The origins, the points on the surfaces, and those on the sensor, metres.
    cosines : ndarray, shape (steps, N)
        Of the angle to the normal before the surface.
    wavelengths : ndarray, shape (N,)
        Metres.
    """

    positions: Numbers
    directions: Numbers
    reached: Flags
    relative_radius: Numbers
    surfaces: NDArray[np.int64]
    reflected: Flags
    points: Numbers
    cosines: Numbers
    wavelengths: Numbers

    @property
    def passed(self) -> Flags:
        """Whether each ray reached the sensor inside all semi-apertures, shape (N,)."""
        return self.reached & (self.relative_radius <= 1.0)


class Shapes(NamedTuple):
    """The surfaces' numbers, one row a surface.

    Parameters
    ----------
    curvature : ndarray, shape (S,)
        1/m.
    along : ndarray, shape (S, 2)
        1 for an axis along which the surface is curved, 0 for one along which it is not.
    conic : ndarray, shape (S,)
        Conic constants.
    asphere : ndarray, shape (S, M)
        Coefficients of r⁴, r⁶, ... in the sag; lengths in metres.
    place : ndarray, shape (S,)
        The vertex on the axis, metres behind the first.
    semi_aperture : ndarray, shape (S,)
        Metres.
    """

    curvature: Numbers
    along: Numbers
    conic: Numbers
    asphere: Numbers
    place: Numbers
    semi_aperture: Numbers


def trace_reference(
    lens: Lens,
    reflections: ArrayLike,
    origins: ArrayLike,
    directions: ArrayLike,
    wavelength: ArrayLike = glass.D_LINE,
) -> Traced:
    """Trace rays through a lens, by the image's way or a ghost's.

    Parameters
    ----------
    lens : Lens
        The lens.
    reflections : array_like of int, shape (R,) or (N, R)
        Reflecting surfaces as in `GhostPath`, the same for all rays or each ray's own; () is the image.
    origins : array_like, shape (N, 3)
        Metres, in front of the lens.
    directions : array_like, shape (N, 3)
        Towards the lens, z > 0; of any length.
    wavelength : array_like
        Metres, one or one a ray.

    Returns
    -------
    Traced
        Without NaN: lost rays stay where they were lost.

    Raises
    ------
    refuse.Refusal
        Where a ray does not head for the lens, or the reflections are no way through it.
    """
    start = refuse.all_finite("origins", refuse.shape_of("origins", origins, (None, 3)))
    count = len(start)
    heading = refuse.all_finite("directions", refuse.shape_of("directions", directions, (count, 3)))
    if np.any(heading[:, 2] <= 0):
        raise refuse.Refusal("'directions' must head for the lens: z > 0.")
    waves = np.broadcast_to(np.asarray(wavelength, dtype=np.float64), (count,))
    surfaces, reflected = _ways(lens, np.asarray(reflections, dtype=np.int64), count)
    shapes = shapes_of(lens)
    media = np.stack([glass.index(medium, waves) for medium in media_of(lens)])
    position = start.astype(np.float64)
    direction = heading / np.linalg.norm(heading, axis=1, keepdims=True)
    alive, radius, rays = np.ones(count, dtype=bool), np.zeros(count), np.arange(count)
    points, cosines = [position], []
    for surface, mirror in zip(surfaces, reflected, strict=True):
        k, going = np.maximum(surface, 0), alive & (surface >= 0)
        # Go to the surface and find the normal that faces the ray.
        point, normal, met = _meet(shapes, k, position, direction)
        forward = direction[:, 2] > 0
        before, behind = media[k + ~forward, rays], media[k + forward, rays]
        cosine = np.clip(np.abs(np.sum(normal * direction, axis=1)), 0.0, 1.0)
        turned, bent = _turn(direction, normal, np.where(mirror, 1.0, before / behind), mirror)
        # A ray that misses or is wholly reflected stays at its last point.
        done = going & met & bent
        alive &= done | (surface < 0)
        position = np.where(done[:, None], point, position)
        direction = np.where(done[:, None], turned, direction)
        off_axis = np.hypot(point[:, 0], point[:, 1]) / shapes.semi_aperture[k]
        radius = np.where(done, np.maximum(radius, off_axis), radius)
        points.append(position)
        cosines.append(np.where(done, cosine, 1.0))
    position, alive = _to_sensor(lens, position, direction, alive)
    points.append(position)
    found = np.stack(points), np.stack(cosines)
    return Traced(position, direction, alive, radius, surfaces, reflected, *found, waves)


def power(lens: Lens, traced: Traced) -> Numbers:
    """Return which part of each ray's power its reflections and refractions leave.

    Parameters
    ----------
    lens : Lens
        The lens that the rays went through.
    traced : Traced
        The rays.

    Returns
    -------
    ndarray, shape (N,)
        0..1, for unpolarised light; what semi-apertures block is not taken off; 0 for lost rays.
    """
    left = np.ones(len(traced.reached))
    forward = np.ones_like(traced.reached)
    for surface, mirror, cosine in zip(traced.surfaces, traced.reflected, traced.cosines, strict=True):
        for k in np.unique(surface[surface >= 0]):
            for ahead in (True, False):
                here = (surface == k) & (forward == ahead)
                if not here.any():
                    continue
                layers = travelling_layers(lens, int(k), ahead)
                before, behind = lens.glass_before(int(k)), lens.surfaces[k].glass
                if not ahead:
                    before, behind = behind, before
                waves = traced.wavelengths[here]
                back, on = coating.reflectance(layers, before, behind, cosine[here], waves)
                left[here] *= np.where(mirror[here], back, on)
        forward = np.where(mirror, ~forward, forward)
    return np.where(traced.reached, left, 0.0)


def stop_points(lens: Lens, traced: Traced, crossing: int = 0) -> Numbers:
    """Return where rays cross the stop, in parts of its semi-aperture.

    Parameters
    ----------
    lens : Lens
        The lens that the rays went through.
    traced : Traced
        The rays.
    crossing : int
        Which time they cross it, counted from 0: ghosts across the stop cross it three times.

    Returns
    -------
    ndarray, shape (N, 2)
        (x, y) of that crossing, or of the last where there are fewer.
    """
    places = traced.points[1:-1, :, :2] / lens.surfaces[lens.stop].semi_aperture
    at_stop = traced.surfaces == lens.stop
    turn = np.minimum(np.cumsum(at_stop, axis=0), crossing + 1)
    step = np.argmax(np.where(at_stop, turn, 0), axis=0)
    return np.asarray(places[step, np.arange(places.shape[1])])


def _ways(lens: Lens, reflections: NDArray[np.int64], count: int) -> tuple[NDArray[np.int64], Flags]:
    """Return the surfaces of each step and whether they reflect, shape (steps, N)."""
    if reflections.ndim == 1 or reflections.size == 0:
        way = steps(lens, reflections.ravel().tolist())
        return (
            np.array([[k] * count for k, _ in way], dtype=np.int64),
            np.array([[mirror] * count for _, mirror in way]),
        )
    refuse.shape_of("reflections", reflections, (count, None))
    different, which = np.unique(reflections, axis=0, return_inverse=True)
    ways = [steps(lens, row.tolist()) for row in different]
    longest = max(len(way) for way in ways)
    padded: list[Sequence[tuple[int, bool]]] = [[*way, *[(-1, False)] * (longest - len(way))] for way in ways]
    table = np.array(padded)[which.ravel()]
    return np.ascontiguousarray(table[..., 0].T), np.ascontiguousarray(table[..., 1].T.astype(bool))


def media_of(lens: Lens) -> list[glass.Glass]:
    """Return the media before each surface and behind the last.

    Parameters
    ----------
    lens : Lens
        The lens.

    Returns
    -------
    list of Glass
        One more than surfaces.
    """
    return [lens.glass_before(0), *(surface.glass for surface in lens.surfaces)]


def shapes_of(lens: Lens) -> Shapes:
    """Return the numbers of a lens's surfaces as tables.

    Parameters
    ----------
    lens : Lens
        The lens.

    Returns
    -------
    Shapes
        In metres.
    """
    surfaces = lens.surfaces
    most = max(len(surface.asphere) for surface in surfaces)
    thicknesses = [surface.thickness for surface in surfaces[:-1]]
    return Shapes(
        np.array([surface.curvature for surface in surfaces]),
        np.array([[surface.cylinder != "y", surface.cylinder != "x"] for surface in surfaces], dtype=float),
        np.array([surface.conic for surface in surfaces]),
        np.array([[*surface.asphere, *[0.0] * (most - len(surface.asphere))] for surface in surfaces]),
        np.concatenate([[0.0], np.cumsum(thicknesses)]),
        np.array([surface.semi_aperture for surface in surfaces]),
    )


def _meet(
    shapes: Shapes, k: NDArray[np.int64], position: Numbers, direction: Numbers
) -> tuple[Numbers, Numbers, Flags]:
    """Return the points on the surfaces, the unit normals, and whether there are any."""
    curvature, along, conic = shapes.curvature[k], shapes.along[k], shapes.conic[k]
    weights = np.column_stack([along, 1.0 + conic])
    local = position.copy()
    local[:, 2] -= shapes.place[k]
    # The conic c (x² + y² + (1 + k) z²) = 2 z, a quadratic in the distance; the root on the vertex's side.
    square = curvature * np.sum(weights * direction**2, axis=1)
    half = direction[:, 2] - curvature * np.sum(weights * direction * local, axis=1)
    rest = curvature * np.sum(weights * local**2, axis=1) - 2.0 * local[:, 2]
    inner = half**2 - square * rest
    root = np.copysign(np.sqrt(np.maximum(inner, 0.0)), direction[:, 2])
    # Of the root's two forms the one in which nothing cancels.
    alike = half * root >= 0.0
    above, below = np.where(alike, rest, half - root), np.where(alike, half + root, square)
    distance = above / np.where(below == 0.0, 1.0, below)
    met = (inner >= 0.0) & (below != 0.0)
    if shapes.asphere.shape[1]:
        distance, close = _to_asphere(shapes, k, local, direction, distance)
        met &= close
    point = local + distance[:, None] * direction
    _, slope, inside = sag_of(shapes, k, point)
    normal = np.column_stack([-2.0 * slope[:, None] * along * point[:, :2], np.ones(len(point))])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    point[:, 2] += shapes.place[k]
    return point, normal, met & inside


def _to_asphere(
    shapes: Shapes, k: NDArray[np.int64], local: Numbers, direction: Numbers, distance: Numbers
) -> tuple[Numbers, Flags]:
    """Return the distances to aspheres by Newton's steps, and whether they came to rest."""
    along, step = shapes.along[k], np.zeros_like(distance)
    for _ in range(NEWTON_STEPS):
        point = local + distance[:, None] * direction
        sag, slope, _ = sag_of(shapes, k, point)
        gap = point[:, 2] - sag
        rate = direction[:, 2] - 2.0 * slope * np.sum(along * point[:, :2] * direction[:, :2], axis=1)
        step = gap / np.where(np.abs(rate) < 1e-9, 1.0, rate)
        # A step longer than the surface is wide leads nowhere.
        widest = shapes.semi_aperture[k]
        step = np.clip(step, -widest, widest)
        distance = distance - step
    return distance, np.abs(step) < 1e-12


def sag_of(shapes: Shapes, k: NDArray[np.int64], point: Numbers) -> tuple[Numbers, Numbers, Flags]:
    """Return a surface's sag, its slope over r², and whether the conic reaches that far from the axis.

    Parameters
    ----------
    shapes : Shapes
        All surfaces.
    k : ndarray of int, shape (N,)
        The surface of each point.
    point : ndarray, shape (N, 2) or (N, 3)
        (x, y) from the axis, metres.

    Returns
    -------
    sag : ndarray, shape (N,)
        Behind the vertex, metres.
    slope : ndarray, shape (N,)
        d sag / d r², 1/m.
    inside : ndarray of bool, shape (N,)
        Whether there is a surface.
    """
    curvature = shapes.curvature[k]
    square = np.sum(shapes.along[k] * point[:, :2] ** 2, axis=1)
    inner = 1.0 - (1.0 + shapes.conic[k]) * curvature**2 * square
    root = np.sqrt(np.maximum(inner, 1e-12))
    sag, slope = curvature * square / (1.0 + root), curvature / (2.0 * root)
    for m in range(shapes.asphere.shape[1]):
        factor = shapes.asphere[k, m]
        sag = sag + factor * square ** (m + 2)
        slope = slope + (m + 2) * factor * square ** (m + 1)
    return sag, slope, inner > 1e-12


def _turn(direction: Numbers, normal: Numbers, ratio: Numbers, mirror: Flags) -> tuple[Numbers, Flags]:
    """Return directions behind a surface by the vector form of Snell's law, or thrown back."""
    along = np.sum(normal * direction, axis=1)
    # What is left along the normal after n sin θ is kept; nothing is where all light is reflected.
    inner = 1.0 - ratio**2 * (1.0 - along**2)
    root = np.sqrt(np.maximum(inner, 0.0))
    turn = np.where(mirror, -2.0 * along, np.copysign(root, along) - ratio * along)
    turned = ratio[:, None] * direction + turn[:, None] * normal
    turned /= np.linalg.norm(turned, axis=1, keepdims=True)
    return turned, mirror | (inner > 0.0)


def _to_sensor(lens: Lens, position: Numbers, direction: Numbers, alive: Flags) -> tuple[Numbers, Flags]:
    """Return where rays meet the sensor's plane; those that do not travel towards it are lost."""
    place = sum(surface.thickness for surface in lens.surfaces)
    ahead = alive & (direction[:, 2] > 1e-9)
    distance = (place - position[:, 2]) / np.where(ahead, direction[:, 2], 1.0)
    return np.where(ahead[:, None], position + distance[:, None] * direction, position), ahead
