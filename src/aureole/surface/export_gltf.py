"""A scatter table for glTF 2.0: extras of a material, in a file of one's own or a new one with one object.

A viewer that knows nothing of them shows an ordinary metal.
"""

import base64
import json
import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.picture import whole_file
from aureole.surface.table import ScatterTable

GLTF_KEY = "aureole_diffraction"
GLTF_SHAPES = ("disc", "plane")
_SEGMENTS = 128
_FLOAT, _INDEX = 5126, 5125  # glTF's numbers for float and unsigned int
_KINDS = {2: "VEC2", 3: "VEC3", 4: "VEC4"}


def gltf_extras(table: ScatterTable, texture: str, f0: float = 1.0) -> dict[str, Any]:
    """Return what a glTF material says about its diffraction in its ``extras``.

    Parameters
    ----------
    table : ScatterTable
        What the surface scatters.
    texture : str
        Where its file lies, relative to the glTF file.
    f0 : float
        Reflectance at normal incidence.

    Returns
    -------
    dict
        JSON values under one key of ours.

    Raises
    ------
    refuse.Refusal
        Where the reflectance is not from 0 to 1.
    """
    return {
        GLTF_KEY: {
            "texture": texture,
            "f0": refuse.between("f0", f0, 0.0, 1.0),
            "halfRange": float(table.half_range),
            "warp": int(table.warp),
            "unit": "1/sr",
            "illuminant": table.illuminant,
            "coordinates": "h = toLight + toEye, not normalised; columns grow along TANGENT.xyz, "
            "rows from the top fall along cross(NORMAL, TANGENT.xyz) * TANGENT.w; "
            "h = halfRange * sign(u) * |u|^warp, u from -1 to 1 at the centres of the border's texels",
        }
    }


def write_gltf(
    path: str | os.PathLike[str],
    table: ScatterTable,
    texture: str,
    source: str | os.PathLike[str] | None = None,
    material: str | None = None,
    f0: float = 1.0,
    shape: str = "disc",
) -> Path:
    """Write a glTF file with a table in the extras of one of its materials.

    Parameters
    ----------
    path : path_like
        The file to write, ``.gltf``.
    table : ScatterTable
        What the surface scatters.
    texture : str
        Where its file lies, relative to the glTF file; `write_table` writes it.
    source : path_like or None
        A file to read, glTF 2.0 as JSON; buffers and pictures are left where they are. None makes a new
        file with one object: a compact disc, or a plane.
    material : str or None
        The name of the source's material; it may be left out where there is one alone.
    f0 : float
        Reflectance at normal incidence.
    shape : {"disc", "plane"}
        The object of a new file.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    refuse.Refusal
        Where the source is no glTF, has no such material, or the file cannot be written.
    """
    place = Path(path)
    refuse.one_of(f"suffix of {place.name}", place.suffix.lower(), (".gltf",))
    scene = _object(refuse.one_of("shape", shape, GLTF_SHAPES)) if source is None else _gltf(Path(source))
    extras = gltf_extras(table, texture, f0)
    _material_of(scene, "the new file" if source is None else os.fspath(source), material).setdefault(
        "extras", {}
    ).update(extras)
    with whole_file(place) as part:
        part.write_text(json.dumps(scene, indent=2), encoding="utf-8")
    return place


def _material_of(scene: dict[str, Any], source: str, name: str | None) -> dict[str, Any]:
    """Find a material by its name, or the only one."""
    named = {entry.get("name", ""): entry for entry in scene.get("materials", [])}
    if name is None and len(named) == 1:
        return next(iter(named.values()))
    if name is None:
        raise refuse.Refusal(f"'material' must name one of the materials of '{source}': {sorted(named)}.")
    if name not in named:
        raise refuse.unknown_key(f"'{source}'", name, named)
    found: dict[str, Any] = named[name]
    return found


def _object(shape: str) -> dict[str, Any]:
    """Describe one object with tangents, its numbers within the file."""
    parts, triangles = _disc() if shape == "disc" else _plane()
    blob = b""
    views: list[dict[str, Any]] = []
    accessors: list[dict[str, Any]] = []
    for name, values in (*parts.items(), ("indices", triangles)):
        data = values.tobytes()
        index = name == "indices"
        views.append(
            {
                "buffer": 0,
                "byteOffset": len(blob),
                "byteLength": len(data),
                "target": 34963 if index else 34962,
            }
        )
        accessor: dict[str, Any] = {
            "bufferView": len(accessors),
            "componentType": _INDEX if index else _FLOAT,
            "count": len(values),
            "type": "SCALAR" if index else _KINDS[values.shape[1]],
        }
        if name == "POSITION":
            accessor["min"], accessor["max"] = values.min(axis=0).tolist(), values.max(axis=0).tolist()
        accessors.append(accessor)
        blob += data
    primitive = {
        "attributes": {name: k for k, name in enumerate(parts)},
        "indices": len(parts),
        "material": 0,
    }
    metal = {"metallicFactor": 1.0, "roughnessFactor": 0.15}
    uri = "data:application/octet-stream;base64," + base64.b64encode(blob).decode()
    return {
        "asset": {"version": "2.0", "generator": "Aureole"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": shape}],
        "meshes": [{"primitives": [primitive], "name": shape}],
        "materials": [{"name": "diffractive", "pbrMetallicRoughness": metal, "doubleSided": True}],
        "buffers": [{"byteLength": len(blob), "uri": uri}],
        "bufferViews": views,
        "accessors": accessors,
    }


def _disc() -> tuple[dict[str, NDArray[np.float32]], NDArray[np.uint32]]:
    """A compact disc in metres: its tangents are radial, its texture is radius and angle."""
    angle = np.linspace(0.0, 2.0 * np.pi, _SEGMENTS + 1)
    radius = np.repeat([0.023, 0.06], angle.size)
    angle = np.tile(angle, 2)
    radial = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    texture = np.stack([radius / 0.06, angle / (2.0 * np.pi)], axis=1)
    inner = np.arange(_SEGMENTS)
    outer = inner + _SEGMENTS + 1
    triangles = np.stack([inner, outer, outer + 1, inner, outer + 1, inner + 1], axis=1)
    return _parts(radius[:, None] * radial, radial, texture), triangles.ravel().astype("<u4")


def _plane() -> tuple[dict[str, NDArray[np.float32]], NDArray[np.uint32]]:
    """A sheet of 10 by 6 cm: its tangents and its texture's u run along x."""
    texture = np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])
    places = np.concatenate([(texture - 0.5) * [0.1, -0.06], np.zeros((4, 1))], axis=1)
    tangents = np.tile([1.0, 0.0, 0.0], (4, 1))
    return _parts(places, tangents, texture), np.array([0, 1, 2, 0, 2, 3], dtype="<u4")


def _parts(
    places: NDArray[np.float64], tangents: NDArray[np.float64], texture: NDArray[np.float64]
) -> dict[str, NDArray[np.float32]]:
    normals = np.tile([0.0, 0.0, 1.0], (len(places), 1))
    handed = np.concatenate([tangents, np.ones((len(places), 1))], axis=1)
    parts = {"POSITION": places, "NORMAL": normals, "TANGENT": handed, "TEXCOORD_0": texture}
    return {name: np.ascontiguousarray(values, dtype="<f4") for name, values in parts.items()}


def _gltf(source: Path) -> dict[str, Any]:
    try:
        scene = json.loads(source.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise refuse.Refusal(f"There is no file '{source}'.") from None
    except (OSError, ValueError) as error:
        raise refuse.Refusal(f"'{source}' cannot be read as glTF: {error}.") from error
    if not isinstance(scene, dict) or "asset" not in scene:
        raise refuse.Refusal(f"'{source}' is no glTF file: it has no 'asset'.")
    return scene
