"""The shapes that a material is on, and what of them a view sees: plane, disc, cylinder, meshes.

Each shape lies in coordinates of its own; `Pose` puts it into the world.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.aperture.bands import in_bands
from aureole.surface import _kernels_cast
from aureole.surface.rasters import frames_at, nearest_triangles
from aureole.surface.views import View


@dataclass(frozen=True, eq=False)
class Pose:
    """Where a shape is and how it is turned.

    Parameters
    ----------
    axes : ndarray of float64, shape (3, 3)
        Its x, y and z axis in the world, a row each: orthonormal, right-handed.
    place : ndarray of float64, shape (3,)
        Its origin, in metres.
    """

    axes: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))
    place: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True)
class Plane:
    """A rectangle in z = 0 about the origin: tangent x, bitangent y, both sides reflect.

    Parameters
    ----------
    width, height : float
        Metres along x and y.
    """

    width: float
    height: float


@dataclass(frozen=True)
class Disc:
    """A disc in z = 0 about the origin, with a hole; both sides reflect.

    Parameters
    ----------
    diameter : float
        Metres; a compact disc has 0.12.
    hole : float
        Diameter of the hole; the grooves of a compact disc start at 0.046.
    radial : bool
        Whether the tangent points away from the centre, as across the tracks of an optical disc, or along x.
    """

    diameter: float
    hole: float = 0.0
    radial: bool = True


@dataclass(frozen=True)
class Cylinder:
    """A sheet bent about the y axis, its middle at z = radius: tangent around it, bitangent along its axis.

    Parameters
    ----------
    radius, height : float
        Metres.
    sweep : float
        Angle that it covers, in radians; 2π is closed.
    """

    radius: float
    height: float
    sweep: float = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles with a normal, a tangent and texture coordinates at each corner.

    Parameters
    ----------
    vertices : ndarray of float64, shape (V, 3)
        Metres.
    triangles : ndarray of int64, shape (T, 3)
        Numbers of the corners, counter-clockwise as seen from outside.
    normals, tangents : ndarray of float64, shape (V, 3)
        Unit vectors, at right angles.
    signs : ndarray of float64, shape (V,)
        ±1: bitangent = sign · normal × tangent.
    texture : ndarray of float64, shape (V, 2)
        u to the right, v upward, 0..1.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]
    normals: NDArray[np.float64]
    tangents: NDArray[np.float64]
    signs: NDArray[np.float64]
    texture: NDArray[np.float64]


Shape = Plane | Disc | Cylinder | Mesh


@dataclass(frozen=True, eq=False)
class Seen:
    """What a view sees of a shape, a frame for each sample.

    Parameters
    ----------
    frames : ndarray of float32, shape (rows, columns, 17)
        0 whether there is a surface (all are 0 where not), 1-3 place, 4-6 normal, 7-9 tangent, 10 sign of
        the bitangent, 11-12 texture coordinates, 13-15 unit vector to the eye, 16 depth along the
        line of sight in metres.
    """

    frames: NDArray[np.float32]

    @property
    def hit(self) -> NDArray[np.bool_]:
        """Whether each sample sees a surface, (rows, columns)."""
        return self.frames[..., 0] > 0

    @property
    def places(self) -> NDArray[np.float32]:
        """Where each sample meets the surface, (rows, columns, 3), metres."""
        return self.frames[..., 1:4]

    @property
    def normals(self) -> NDArray[np.float32]:
        """Unit vectors towards the viewer's side, (rows, columns, 3)."""
        return self.frames[..., 4:7]

    @property
    def tangents(self) -> NDArray[np.float32]:
        """Unit vectors, (rows, columns, 3)."""
        return self.frames[..., 7:10]

    @property
    def bitangents(self) -> NDArray[np.float32]:
        """Unit vectors, (rows, columns, 3)."""
        return np.cross(self.normals, self.tangents) * self.frames[..., 10:11]

    @property
    def texture(self) -> NDArray[np.float32]:
        """Texture coordinates u to the right, v upward, (rows, columns, 2)."""
        return self.frames[..., 11:13]

    @property
    def outward(self) -> NDArray[np.float32]:
        """Unit vectors towards the eye, (rows, columns, 3)."""
        return self.frames[..., 13:16]

    @property
    def depth(self) -> NDArray[np.float32]:
        """Metres along the line of sight, (rows, columns); only where `hit`."""
        return self.frames[..., 16]


def pose_of(
    place: ArrayLike = (0.0, 0.0, 0.0),
    tilt: float = 0.0,
    turn: float = 0.0,
    spin: float = 0.0,
) -> Pose:
    """Make a pose: the shape spins about its own z, then tilts about x, then turns about y, then moves.

    Parameters
    ----------
    place : array_like, shape (3,)
        Where its origin goes, in metres.
    tilt, turn, spin : float
        Angles in radians, counter-clockwise as seen against the axis.

    Returns
    -------
    Pose
        The pose.

    Raises
    ------
    refuse.Refusal
        Where a number is missing or not finite.
    """
    where = np.array(refuse.all_finite("place", refuse.shape_of("place", place, (3,))), dtype=np.float64)
    turned = (
        _rotation(1, refuse.finite("turn", turn))
        @ _rotation(0, refuse.finite("tilt", tilt))
        @ _rotation(2, refuse.finite("spin", spin))
    )
    return Pose(np.ascontiguousarray(turned.T), where)


def see(
    shape: Shape,
    view: View,
    pose: Pose | None = None,
    samples: int = 1,
    rows: tuple[int, int] | None = None,
) -> Seen:
    """Find what a view sees of a shape.

    Parameters
    ----------
    shape : Plane, Disc, Cylinder or Mesh
        The shape.
    view : View
        The view.
    pose : Pose or None
        Where the shape is; None leaves it at the origin, unturned.
    samples : int
        Samples a pixel along each axis.
    rows : tuple of int or None
        First row of samples, and the one after the last; None is all of them.

    Returns
    -------
    Seen
        A frame for each sample, samples · view.shape of them where `rows` is None.

    Raises
    ------
    refuse.Refusal
        Where a length is not positive or the samples are not at least 1.
    """
    count = refuse.at_least("samples", samples, 1)
    size = view.shape[0] * count, view.shape[1] * count
    first, last = (0, size[0]) if rows is None else rows
    where = Pose() if pose is None else pose
    frames = np.zeros((last - first, size[1], _kernels_cast.WIDTH), dtype=np.float32)
    if isinstance(shape, Mesh):
        _see_mesh(shape, where, view, size, (first, last), frames)
        return Seen(frames)
    caster = Caster(shape, where, view, count)

    def fill(begin: int, end: int) -> None:
        for row, until, blocks, places in caster(first + begin, first + end, 8, 1):
            flat = frames[row - first : until - first].reshape(-1, _kernels_cast.WIDTH)
            flat[places] = unblocked(blocks, len(places))

    in_bands(fill, last - first)
    return Seen(frames)


Cast = tuple[int, int, NDArray[np.float32], NDArray[np.int64]]


class Caster:
    """Casts a view's rays at a plane, a disc or a cylinder, some rows of samples at a time.

    Parameters
    ----------
    shape : Plane, Disc or Cylinder
        The shape.
    pose : Pose
        Where it is.
    view : View
        The view.
    samples : int
        Samples a pixel along each axis.
    """

    def __init__(self, shape: Plane | Disc | Cylinder, pose: Pose, view: View, samples: int) -> None:
        self._size = view.shape[0] * samples, view.shape[1] * samples
        self._kind, *numbers = shape_numbers(shape, pose, view)
        self._fine, self._plain = tuple(numbers), tuple(part.astype(np.float32) for part in numbers)

    def __call__(self, first: int, last: int, step: int, side: int) -> Iterator[Cast]:
        """Cast rows of samples, a few at a time.

        Parameters
        ----------
        first, last : int
            The first row, and the one after the last.
        step : int
            Rows at a time.
        side : int
            Samples along a pixel's side; a divisor of `step`.

        Yields
        ------
        first, last : int
            The rows.
        blocks : ndarray of float32, shape (B, 17 · 64)
            Frames as the shader takes them; written anew for the next rows.
        pixels : ndarray of int64, shape (N,)
            Which pixel each of the N frames is in, counted from the first of these rows.
        """
        most = -(-step * self._size[1] // _kernels_cast.LANES)
        hits = np.zeros((most, _kernels_cast.HIT_WIDTH * _kernels_cast.LANES), dtype=np.float32)
        blocks = np.empty((most, _kernels_cast.WIDTH * _kernels_cast.LANES), dtype=np.float32)
        pixels = np.empty(most * _kernels_cast.LANES, dtype=np.int64)
        for row in range(first, last, step):
            until = min(last, row + step)
            given: tuple[Any, ...] = (*self._fine, (*self._size, row, until, side), hits, pixels)
            count = _kernels_cast.cast(self._kind, *given)
            filled = blocks[: -(-count // _kernels_cast.LANES)]
            given = (*self._plain, hits, len(filled), filled)
            _kernels_cast.lay_frames(self._kind, *given)
            yield row, until, filled, pixels[:count]


def blocked(frames: NDArray[np.float32]) -> NDArray[np.float32]:
    """Lay frames out as the shader takes them: 64 samples in a block, number after number.

    Parameters
    ----------
    frames : ndarray of float32, shape (N, 17)
        Frames.

    Returns
    -------
    ndarray of float32, shape (B, 17 · 64)
        Zero after the last one.
    """
    lanes = _kernels_cast.LANES
    padded = np.zeros((-(-len(frames) // lanes) * lanes, frames.shape[1]), dtype=np.float32)
    padded[: len(frames)] = frames
    width = frames.shape[1]
    turned = padded.reshape(-1, lanes, width).transpose(0, 2, 1)
    return np.ascontiguousarray(turned).reshape(-1, width * lanes)


def unblocked(blocks: NDArray[np.float32], count: int) -> NDArray[np.float32]:
    """Turn blocks into frames one after another.

    Parameters
    ----------
    blocks : ndarray of float32, shape (B, 17 · 64)
        From `Caster` or `blocked`.
    count : int
        How many frames they hold.

    Returns
    -------
    ndarray of float32, shape (N, 17)
        Frames.
    """
    rows = blocks.reshape(len(blocks), _kernels_cast.WIDTH, _kernels_cast.LANES).transpose(0, 2, 1)
    return rows.reshape(-1, _kernels_cast.WIDTH)[:count]


def shape_numbers(
    shape: Plane | Disc | Cylinder, pose: Pose, view: View
) -> tuple[int, NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Check a shape and write it, its pose and the view's rays as the kernels' numbers.

    Parameters
    ----------
    shape : Plane, Disc or Cylinder
        The shape.
    pose : Pose
        Where it is.
    view : View
        The view.

    Returns
    -------
    kind : int
        Which shape.
    numbers : ndarray of float64, shape (4,)
        Its lengths in metres and angles in radians.
    pose : ndarray of float64, shape (4, 3)
        Its axes and its place.
    rays : ndarray of float64, shape (6, 3)
        Origin and direction of the middle ray, and what x and y add to each.

    Raises
    ------
    refuse.Refusal
        Where a length is not positive.
    """
    kind, numbers = _numbers(shape)
    return kind, numbers, np.vstack([pose.axes, pose.place[None]]), _rays(view)


def _numbers(shape: Plane | Disc | Cylinder) -> tuple[int, NDArray[np.float64]]:
    """Write a shape as a kind and its numbers."""
    match shape:
        case Plane():
            width = refuse.positive("width", shape.width)
            kind, numbers = _kernels_cast.PLANE, [width, refuse.positive("height", shape.height), 0.0, 0.0]
        case Disc():
            across = refuse.positive("diameter", shape.diameter)
            hole = refuse.between("hole", shape.hole, 0.0, across)
            kind, numbers = _kernels_cast.DISC, [across, across, 0.5 * hole, float(shape.radial)]
        case Cylinder():
            radius, height = refuse.positive("radius", shape.radius), refuse.positive("height", shape.height)
            sweep = refuse.between("sweep", shape.sweep, 1e-6, 2.0 * np.pi)
            kind, numbers = _kernels_cast.CYLINDER, [radius, height, sweep, 0.0]
    return kind, np.array(numbers)


def _rays(view: View) -> NDArray[np.float64]:
    """Write a view as origin and direction of its middle ray, and what x and y add to each."""
    still = np.zeros((2, 3))
    aside = np.vstack([view.right, view.up])
    both = [still, aside] if view.perspective else [aside, still]
    return np.vstack([view.eye, view.forward + view.shift, *both])


def _see_mesh(
    mesh: Mesh,
    pose: Pose,
    view: View,
    size: tuple[int, int],
    rows: tuple[int, int],
    frames: NDArray[np.float32],
) -> None:
    """Turn a mesh into the world and fill the frames of its nearest triangles."""
    vertices = mesh.vertices @ pose.axes + pose.place
    parts = vertices, mesh.normals @ pose.axes, mesh.tangents @ pose.axes, mesh.signs[:, None], mesh.texture
    attributes = np.hstack(parts).astype(np.float32)
    depth, number, weights = nearest_triangles(vertices, mesh.triangles, view, size, rows)

    def fill(begin: int, end: int) -> None:
        met = np.isfinite(depth[begin:end])
        corners, shares = mesh.triangles[number[begin:end][met]], weights[begin:end][met]
        frames[begin:end][met] = frames_at(attributes, corners, shares, view, depth[begin:end][met])

    in_bands(fill, rows[1] - rows[0])


def _rotation(axis: int, angle: float) -> NDArray[np.float64]:
    """Return the matrix that turns counter-clockwise about an axis."""
    one, other = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[one, one] = matrix[other, other] = np.cos(angle)
    matrix[other, one], matrix[one, other] = np.sin(angle), -np.sin(angle)
    return matrix
