"""Shadows that a shape casts on itself: which of its samples a lamp reaches.

In: a shape in its pose, a lamp, frames; out: whether each is reached. Of a cylinder that is exact. Of a mesh
the lamp's own picture of it tells, which has so many samples along a side; what lies no further behind the
first surface than the slope makes up for within a sample counts as lit.
"""

import numpy as np
from numpy.typing import NDArray

from aureole.surface.lamps import Lamp
from aureole.surface.shapes import Cylinder, Mesh, Pose, see
from aureole.surface.views import View, view_from

SIZE = 1024
_MARGIN = 1.02


class Shadow:
    """What keeps a lamp's light from a shape.

    Parameters
    ----------
    shape : Cylinder or Mesh
        The shape.
    pose : Pose
        Where it is.
    lamp : Lamp
        The lamp; one inside the sphere around a mesh reaches everything.
    size : int
        Samples along a side of the lamp's picture of a mesh.
    """

    def __init__(self, shape: Cylinder | Mesh, pose: Pose, lamp: Lamp, size: int = SIZE) -> None:
        self._shape, self._pose, self._lamp = shape, pose, lamp
        self._view = None
        if isinstance(shape, Mesh):
            centre, radius = _sphere(shape, pose)
            self._view, self._step = _view_of(lamp, centre, radius, size), 2.0 * radius / size
        if self._view is not None:
            seen = see(shape, self._view, pose)
            self._depth = np.where(seen.hit, seen.depth, np.inf)

    def reaches(self, frames: NDArray[np.float32]) -> NDArray[np.bool_]:
        """Tell which frames the lamp reaches.

        Parameters
        ----------
        frames : ndarray of float32, shape (N, 17)
            Of the same shape in the same pose.

        Returns
        -------
        ndarray of bool, shape (N,)
            False where the shape itself is in the way.
        """
        if isinstance(self._shape, Cylinder):
            return self._past_the_wall(self._shape, frames)
        if self._view is None:
            return np.ones(len(frames), dtype=bool)
        return self._in_picture(self._view, frames)

    def _past_the_wall(self, shape: Cylinder, frames: NDArray[np.float32]) -> NDArray[np.bool_]:
        """Follow the chord from inner walls: it meets the wall once more, or passes its edges first."""
        reached = np.ones(len(frames), dtype=bool)
        inner = frames[:, 10] < 0
        if not inner.any():
            return reached
        axes, lamp = self._pose.axes.T, self._lamp
        place = (frames[inner, 1:4] - self._pose.place) @ axes
        toward = np.broadcast_to(lamp.place @ axes, place.shape)
        if not lamp.distant:
            toward = (lamp.place - self._pose.place) @ axes - place
        across = toward[:, 0] ** 2 + toward[:, 2] ** 2
        chord = -2.0 * (place[:, 0] * toward[:, 0] + place[:, 2] * toward[:, 2])
        t = np.divide(chord, across, out=np.full(len(place), np.inf), where=across > 0)
        x, y, z = (place + np.where(np.isfinite(t), t, 0.0)[:, None] * toward).T
        wall = (np.abs(y) <= 0.5 * shape.height) & (np.abs(np.arctan2(x, z)) <= 0.5 * shape.sweep)
        before = (t > 1e-6) & np.isfinite(t) & (lamp.distant | (t < 1.0))
        reached[inner] = ~(wall & before)
        return reached

    def _in_picture(self, view: View, frames: NDArray[np.float32]) -> NDArray[np.bool_]:
        """Compare depths with those in the lamp's picture."""
        size = len(self._depth)
        away = frames[:, 1:4].astype(np.float64) - view.eye
        depth = away @ view.forward
        scale = depth if view.perspective else np.ones_like(depth)
        x, y = (away @ axis / (axis @ axis) / scale for axis in (view.right, view.up))
        column, row = (0.5 * (1 + x) * size).astype(np.int64), (0.5 * (1 - y) * size).astype(np.int64)
        nearest = self._depth[np.clip(row, 0, size - 1), np.clip(column, 0, size - 1)]
        # Half a sample aside, the surface's slope changes its depth.
        light = away / np.linalg.norm(away, axis=1, keepdims=True) if view.perspective else view.forward
        cosine = np.abs(np.sum(light * frames[:, 4:7], axis=1))
        steep = np.sqrt(np.maximum(0.0, 1.0 - cosine**2)) / np.maximum(cosine, 1e-3)
        return np.asarray(depth <= nearest + self._step * np.minimum(20.0, 0.1 + steep))


def _sphere(mesh: Mesh, pose: Pose) -> tuple[NDArray[np.float64], float]:
    """Return the middle and the radius of a sphere around a mesh."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    radius = 0.5 * float(np.linalg.norm(high - low)) * _MARGIN
    return 0.5 * (low + high) @ pose.axes + pose.place, radius


def _view_of(lamp: Lamp, centre: NDArray[np.float64], radius: float, size: int) -> View | None:
    """Return a lamp's view of a sphere; None from inside."""
    away = lamp.place if lamp.distant else lamp.place - centre
    distance = float(np.linalg.norm(away))
    up = np.eye(3)[int(np.abs(away).argmin())]
    if lamp.distant:
        eye = centre + 2.0 * radius * away
        return view_from(eye, centre, (size, size), up=up, height=2.0 * radius)
    if distance <= radius * 1.001:
        return None
    return view_from(lamp.place, centre, (size, size), 2.0 * float(np.arcsin(radius / distance)), up)
