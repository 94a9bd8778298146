"""Triangle meshes with tangents: from OBJ and PLY files, or from arrays.

The tangent follows u of the texture coordinates, since the grating is laid on as a texture is; a mesh without
them takes the direction that the caller names, laid onto its surface.
"""

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.surface.shapes import Mesh

SUFFIXES = (".obj", ".ply")


def read_mesh(path: str | Path, scale: float = 1.0, direction: ArrayLike = (1.0, 0.0, 0.0)) -> Mesh:
    """Read a mesh.

    Parameters
    ----------
    path : str or Path
        An OBJ or PLY file.
    scale : float
        Metres in the file's unit.
    direction : array_like, shape (3,)
        Where the file has no texture coordinates: along which gratings have their tangent.

    Returns
    -------
    Mesh
        The mesh; all objects of the file together.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read, has no triangles, or trimesh is not installed.
    """
    where = Path(path)
    refuse.one_of("mesh", where.suffix.lower(), SUFFIXES)
    factor = refuse.positive("scale", scale)
    try:
        import trimesh
    except ImportError:
        raise refuse.Refusal("'mesh' needs trimesh: pip install trimesh.") from None
    try:
        read = trimesh.load(where, force="mesh", process=False)
    except Exception as problem:
        raise refuse.Refusal(f"'{where}' cannot be read as a mesh: {problem}.") from None
    if not isinstance(read, trimesh.Trimesh) or not len(read.faces):
        raise refuse.Refusal(f"'{where}' has no triangles.")
    texture = getattr(read.visual, "uv", None)
    return mesh_of(np.asarray(read.vertices) * factor, read.faces, read.vertex_normals, texture, direction)


def mesh_of(
    vertices: ArrayLike,
    triangles: ArrayLike,
    normals: ArrayLike | None = None,
    texture: ArrayLike | None = None,
    direction: ArrayLike = (1.0, 0.0, 0.0),
) -> Mesh:
    """Make a mesh from arrays.

    Parameters
    ----------
    vertices : array_like, shape (V, 3)
        Metres.
    triangles : array_like of int, shape (T, 3)
        Numbers of the corners, counter-clockwise as seen from outside.
    normals : array_like, shape (V, 3), or None
        Of any length; None is the mean of the triangles around, by area.
    texture : array_like, shape (V, 2), or None
        u to the right, v upward; whole numbers are cut off, as where a texture repeats.
    direction : array_like, shape (3,)
        The tangent where there is no texture.

    Returns
    -------
    Mesh
        With tangents at right angles to the normals.

    Raises
    ------
    refuse.Refusal
        Where an array does not fit the others.
    """
    points = np.array(refuse.all_finite("vertices", refuse.shape_of("vertices", vertices, (None, 3))), float)
    corners = _corners(triangles, len(points))
    if normals is None:
        upright: NDArray[np.float64] = _normals(points, corners)
    else:
        upright = refuse.all_finite("normals", refuse.shape_of("normals", normals, points.shape))
        upright = _unit(upright.astype(float), (0.0, 0.0, 1.0))
    if texture is None:
        along = np.array(refuse.all_finite("direction", refuse.shape_of("direction", direction, (3,))), float)
        tangents, signs = np.broadcast_to(along, points.shape), np.ones(len(points))
        flat = np.full((len(points), 2), 0.5)
    else:
        flat = np.array(
            refuse.all_finite("texture", refuse.shape_of("texture", texture, (len(points), 2))), float
        )
        tangents, signs = _tangents(points, corners, upright, flat)
        if flat.min() < 0 or flat.max() > 1:
            flat = flat - np.floor(flat)
    # What lies along the normal is taken away; a tangent that vanishes so becomes any at right angles.
    lying = tangents - upright * np.sum(tangents * upright, axis=1, keepdims=True)
    least = np.eye(3)[np.abs(upright).argmin(axis=1)]
    spare = np.cross(upright, least)
    lost = np.linalg.norm(lying, axis=1, keepdims=True) < 1e-9 * (1e-30 + np.abs(tangents).max())
    return Mesh(points, corners, upright, _unit(np.where(lost, spare, lying), (1.0, 0.0, 0.0)), signs, flat)


def _corners(triangles: ArrayLike, count: int) -> NDArray[np.int64]:
    found = refuse.shape_of("triangles", triangles, (None, 3))
    if found.dtype.kind not in "iu" or found.min() < 0 or found.max() >= count:
        raise refuse.Refusal(f"'triangles' must hold whole numbers from 0 to {count - 1}.")
    return np.ascontiguousarray(found, dtype=np.int64)


def _sides(values: NDArray[np.float64], corners: NDArray[np.int64]) -> tuple[NDArray[np.float64], ...]:
    """Return what two sides of each triangle add to a value of its corners."""
    first = values[corners[:, 0]]
    return values[corners[:, 1]] - first, values[corners[:, 2]] - first


def _gather(count: int, corners: NDArray[np.int64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Add each triangle's value to its corners."""
    total = np.zeros((count, *values.shape[1:]))
    for k in range(3):
        np.add.at(total, corners[:, k], values)
    return total


def _normals(points: NDArray[np.float64], corners: NDArray[np.int64]) -> NDArray[np.float64]:
    one, other = _sides(points, corners)
    return _unit(_gather(len(points), corners, np.cross(one, other)), (0.0, 0.0, 1.0))


def _tangents(
    points: NDArray[np.float64],
    corners: NDArray[np.int64],
    normals: NDArray[np.float64],
    texture: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where u grows at each corner, and whether v grows along normal × tangent or against it."""
    one, other = _sides(points, corners)
    flat_one, flat_other = _sides(texture, corners)
    area = flat_one[:, 0] * flat_other[:, 1] - flat_other[:, 0] * flat_one[:, 1]
    turn = np.sign(area)[:, None]
    along_u = turn * (one * flat_other[:, 1:] - other * flat_one[:, 1:])
    along_v = turn * (other * flat_one[:, :1] - one * flat_other[:, :1])
    tangents = _gather(len(points), corners, along_u)
    bitangents = _gather(len(points), corners, along_v)
    signs = np.where(np.sum(np.cross(normals, tangents) * bitangents, axis=1) < 0, -1.0, 1.0)
    return tangents, signs


def _unit(vectors: NDArray[np.float64], otherwise: ArrayLike) -> NDArray[np.float64]:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    found = np.where(lengths > 0, vectors / np.where(lengths > 0, lengths, 1.0), np.asarray(otherwise))
    return np.asarray(found, dtype=np.float64)
