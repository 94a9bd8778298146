"""Shadows that a shape casts on itself: the shape as each lamp sees it, and what lies behind that.

In: a shape in its pose, frames, a lamp; out: which frames the lamp reaches. A lamp's picture has so many
samples along a side; what is nearer to the first surface than a sample is wide counts as lit.
"""

import numpy as np
from numpy.typing import NDArray

from aureole.surface.lamps import Lamp
from aureole.surface.shapes import Cylinder, Mesh, Pose, see
from aureole.surface.views import View, view_from

SIZE = 1024
_MARGIN = 1.02


class Shadow:
    """What a lamp sees of a shape.

    Parameters
    ----------
    shape : Cylinder or Mesh
        The shape.
    pose : Pose
        Where it is.
    lamp : Lamp
        The lamp; one inside the sphere around the shape reaches everything.
    size : int
        Samples along a side.
    """

    def __init__(self, shape: Cylinder | Mesh, pose: Pose, lamp: Lamp, size: int = SIZE) -> None:
        centre, radius = _sphere(shape, pose)
        self._view = _view_of(lamp, centre, radius, size)
        if self._view is not None:
            seen = see(shape, self._view, pose)
            self._depth = np.where(seen.hit, seen.depth, np.inf)
            self._step = 2.0 * radius / size

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
        if self._view is None:
            return np.ones(len(frames), dtype=bool)
        view, size = self._view, len(self._depth)
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
        slack = self._step * np.minimum(20.0, 0.1 + steep)
        return np.asarray(depth <= nearest + slack)


def _sphere(shape: Cylinder | Mesh, pose: Pose) -> tuple[NDArray[np.float64], float]:
    """Return the middle and the radius of a sphere around a shape."""
    if isinstance(shape, Mesh):
        low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
        middle, radius = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
    else:
        middle, radius = np.zeros(3), float(np.hypot(shape.radius, 0.5 * shape.height))
    return middle @ pose.axes + pose.place, radius * _MARGIN


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
