"""Meshes as a view sees them: triangles taken to the view, sorted by rows, and frames of what is nearest."""

import numpy as np
from numpy.typing import NDArray

from aureole.aperture.bands import in_bands
from aureole.surface import _kernels_mesh
from aureole.surface.views import View

BAND = 16  # rows of samples that share a list of triangles


def nearest_triangles(
    vertices: NDArray[np.float64],
    triangles: NDArray[np.int64],
    view: View,
    size: tuple[int, int],
    rows: tuple[int, int],
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.float32]]:
    """Find the first triangle along each ray.

    Parameters
    ----------
    vertices : ndarray of float64, shape (V, 3)
        In the world, in metres.
    triangles : ndarray of int64, shape (T, 3)
        Numbers of their corners.
    view : View
        The view.
    size : tuple of int
        Rows and columns of samples.
    rows : tuple of int
        First row of samples to draw, and the one after the last.

    Returns
    -------
    depth : ndarray of float64, shape (R, C)
        Metres along the line of sight; infinite where nothing is met.
    number : ndarray of int32, shape (R, C)
        Of the triangle.
    weights : ndarray of float32, shape (R, C, 2)
        Shares of its first and second corner.
    """
    first, last = rows
    corners = _projected(vertices, view)
    spans = _rows_touched(corners, triangles, size[0])
    order, starts = _sorted_by_band(spans, first, last)
    shape = (last - first, size[1])
    depth, number = np.full(shape, np.inf), np.zeros(shape, dtype=np.int32)
    weights = np.zeros((*shape, 2), dtype=np.float32)

    def draw(begin: int, end: int) -> None:
        for band in range(begin, end):
            part = slice(band * BAND, min(shape[0], (band + 1) * BAND))
            given = (*size, first + band * BAND), depth[part], number[part], weights[part]
            listed = order[starts[band] : starts[band + 1]]
            _kernels_mesh.raster(triangles, corners, spans, listed, *given)

    in_bands(draw, len(starts) - 1)
    return depth, number, weights


def frames_at(
    attributes: NDArray[np.float32],
    corners: NDArray[np.int64],
    weights: NDArray[np.float32],
    view: View,
    depth: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Blend the corners' attributes and make frames that face the eye.

    Parameters
    ----------
    attributes : ndarray of float32, shape (V, 12)
        Place, normal, tangent, sign of the bitangent, texture coordinates of each vertex, in the world.
    corners : ndarray of int64, shape (N, 3)
        Of the triangle at each sample.
    weights : ndarray of float32, shape (N, 2)
        Shares of the first two corners.
    view : View
        The view.
    depth : ndarray of float64, shape (N,)
        Metres along the line of sight.

    Returns
    -------
    ndarray of float32, shape (N, 17)
        As in `Seen`.
    """
    shares = np.column_stack([weights, 1.0 - weights[:, 0] - weights[:, 1]])
    frames = np.ones((len(weights), 17), dtype=np.float32)
    frames[:, 1:13] = sum(shares[:, k, None] * attributes[corners[:, k]] for k in range(3))
    place, normal, tangent = frames[:, 1:4], frames[:, 4:7], frames[:, 7:10]
    outward = view.eye - place if view.perspective else np.broadcast_to(-view.forward, place.shape)
    normal /= _length(normal)
    tangent -= _dot(normal, tangent) * normal
    tangent /= _length(tangent)
    frames[:, 13:16] = outward / _length(outward)
    front = np.where(_dot(normal, frames[:, 13:16])[:, 0] < 0, np.float32(-1), np.float32(1))
    normal *= front[:, None]
    frames[:, 10] = front * np.where(attributes[corners[:, 0], 9] > 0, 1, -1)
    frames[:, 16] = depth
    return frames


def _projected(vertices: NDArray[np.float64], view: View) -> NDArray[np.float64]:
    """Return x, y, w and depth of vertices (V, 4); x and y are 1 at the picture's border where w is 1."""
    away = vertices - view.eye
    depth = away @ view.forward
    if view.perspective:
        away = away - depth[:, None] * view.shift
    x, y = (away @ axis / (axis @ axis) for axis in (view.right, view.up))
    return np.column_stack([x, y, depth if view.perspective else np.ones_like(depth), depth])


def _rows_touched(corners: NDArray[np.float64], triangles: NDArray[np.int64], rows: int) -> NDArray[np.int64]:
    """Return the first row of samples that each triangle may touch and the one after its last, (T, 2)."""
    y, w = corners[triangles, 1], corners[triangles, 2]
    ahead = (w > 0).all(axis=1)
    height = np.divide(y, w, out=np.zeros_like(y), where=w > 0)
    top, bottom = (0.5 * (1.0 - edge(height, axis=1)) * rows for edge in (np.max, np.min))
    # A triangle that reaches behind the eye may touch any row.
    first = np.where(ahead, np.floor(np.clip(top, 0, rows)), 0)
    last = np.where(ahead, np.ceil(np.clip(bottom, 0, rows)) + 1, rows)
    last[(corners[triangles, 3] <= 0).all(axis=1)] = 0
    return np.stack([first, np.minimum(last, rows)], axis=1).astype(np.int64)


def _sorted_by_band(
    spans: NDArray[np.int64], first: int, last: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """List the triangles of each band of rows, one band after another; starts (B + 1,) begin the lists."""
    bands = -(-(last - first) // BAND)
    inside = np.clip(spans, first, last) - first
    touched = np.flatnonzero(inside[:, 1] > inside[:, 0])
    low, high = inside[touched, 0] // BAND, (inside[touched, 1] - 1) // BAND
    counts = high - low + 1
    band = np.repeat(low - np.concatenate([[0], np.cumsum(counts)[:-1]]), counts) + np.arange(counts.sum())
    order = np.argsort(band, kind="stable")
    return np.repeat(touched, counts)[order], np.searchsorted(band[order], np.arange(bands + 1))


def _length(vectors: NDArray[np.floating]) -> NDArray[np.floating]:
    found: NDArray[np.floating] = np.sqrt(_dot(vectors, vectors) + np.float32(1e-30))
    return found


def _dot(one: NDArray[np.floating], other: NDArray[np.floating]) -> NDArray[np.floating]:
    found: NDArray[np.floating] = np.einsum("ij,ij->i", one, other)[:, None]
    return found
