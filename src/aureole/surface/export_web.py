"""A scatter table for browsers and engines: one HTML page, a GLSL function, extras of a glTF material.

The page holds everything it shows (WebGL 2, no network): table, shaders and controls. The picture is
that of one small lamp; ``page.html#{"shape": "disc", "bare": true, "size": [960, 540]}`` starts from
another view.
"""

import base64
import dataclasses
import gzip
import html
import importlib.resources
import json
import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.picture import whole_file
from aureole.surface.table import ScatterTable, rgb

SHAPES = ("plane", "disc", "cylinder")
GLTF_KEY = "aureole_diffraction"
# A texture's brightest sample, an eighth of the largest half float: dim orders keep the most digits.
_BRIGHTEST = 8192.0
_LARGEST_TEXTURE = 2048


@dataclasses.dataclass(frozen=True)
class WebView:
    """How the page first shows the object, which lies at the origin with z toward the eye.

    Parameters
    ----------
    shape : str
        One of `SHAPES`: a plane, a disc whose tangents are radial, a cylinder that stands upright.
    extents : dict of str to tuple of float
        Half width and half height; outer and inner radius; radius and half height: any unit of length.
    yaw : float
        Radians, about the y axis.
    pitch : float
        Radians, about the x axis, before the yaw.
    distance : float
        From the eye to the origin.
    field_of_view : float
        Radians from the picture's lower to its upper edge.
    lamp : tuple of float
        The lamp's place.
    lamp_power : float
        Its radiant intensity: the irradiance at distance 1, facing it.
    exposure : float
        Stops.
    f0 : tuple of float
        Reflectance at normal incidence, linear Rec.709; Schlick's factor follows from it.
    diffraction : float
        Weight of the table's part.
    diffuse : tuple of float
        Albedo of the diffuse part, linear Rec.709.
    specular : float
        Weight of the Cook-Torrance lobe.
    roughness : float
        Root mean square slope of its facets.
    """

    shape: str = "disc"
    extents: dict[str, tuple[float, float]] = dataclasses.field(
        default_factory=lambda: {"plane": (1.0, 0.6), "disc": (1.0, 0.25), "cylinder": (0.6, 0.8)}
    )
    yaw: float = 0.0
    pitch: float = 0.0
    distance: float = 4.0
    field_of_view: float = 0.6
    lamp: tuple[float, float, float] = (0.0, 1.2, 4.0)
    lamp_power: float = 16.0
    exposure: float = 0.0
    f0: tuple[float, float, float] = (1.0, 1.0, 1.0)
    diffraction: float = 1.0
    diffuse: tuple[float, float, float] = (0.0, 0.0, 0.0)
    specular: float = 0.0
    roughness: float = 0.1


def write_page(
    path: str | os.PathLike[str],
    table: ScatterTable,
    view: WebView | None = None,
    title: str = "Diffractive surface",
    size: int = 512,
) -> Path:
    """Write a page that shows a table on an object, with lamp and object to drag.

    Parameters
    ----------
    path : path_like
        The page, ``.html``.
    table : ScatterTable
        What the surface scatters.
    view : WebView or None
        What the page shows first; None is a disc facing the eye.
    title : str
        The page's title.
    size : int
        Longest side of the page's table; a larger one is averaged down to it.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    refuse.Refusal
        Where the suffix is another, the size is out of range, or the file cannot be written.
    """
    place = _suffixed(path, ".html")
    size = refuse.at_least("size", size, 2)
    texels, scale = half_floats(reduced(rgb(table), min(size, _LARGEST_TEXTURE)))
    state = view or WebView()
    refuse.one_of("shape", state.shape, SHAPES)
    page = _asset("page.html")
    for mark, text in (
        ("TITLE", html.escape(title)),
        ("DIFFRACTION", _asset("diffraction.glsl")),
        ("SCENE", _asset("page.glsl")),
        ("STATE", _json_in_html(dataclasses.asdict(state))),
        ("TABLE", _json_in_html(_uniforms(table, texels, scale))),
        ("TEXELS", base64.b64encode(gzip.compress(texels.tobytes(), mtime=0)).decode()),
        ("SCRIPT", _asset("page.js")),
    ):
        page = page.replace(f"@{mark}@", text)
    with whole_file(place) as part:
        part.write_text(page, encoding="utf-8")
    return place


def write_glsl(path: str | os.PathLike[str]) -> Path:
    """Write the GLSL function that looks a table up and returns the diffracted part of the BRDF.

    Parameters
    ----------
    path : path_like
        The file, ``.glsl``.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    refuse.Refusal
        Where the suffix is another or the file cannot be written.
    """
    place = _suffixed(path, ".glsl")
    with whole_file(place) as part:
        part.write_text(_asset("diffraction.glsl"), encoding="utf-8")
    return place


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
    source: str | os.PathLike[str],
    material: str,
    table: ScatterTable,
    texture: str,
    f0: float = 1.0,
) -> Path:
    """Write a glTF file anew with a table in the extras of one of its materials.

    Parameters
    ----------
    path : path_like
        The file to write, ``.gltf``.
    source : path_like
        The file to read, glTF 2.0 as JSON; buffers and pictures are left where they are.
    material : str
        The material's name.
    table : ScatterTable
        What the surface scatters.
    texture : str
        Where its file lies, relative to the glTF file.
    f0 : float
        Reflectance at normal incidence.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    refuse.Refusal
        Where the source is no glTF, has no such material, or the file cannot be written.
    """
    place, scene = _suffixed(path, ".gltf"), _gltf(Path(source))
    named = {entry.get("name", ""): entry for entry in scene.get("materials", [])}
    if material not in named:
        raise refuse.unknown_key(f"'{source}'", material, named)
    named[material].setdefault("extras", {}).update(gltf_extras(table, texture, f0))
    with whole_file(place) as part:
        part.write_text(json.dumps(scene, indent=2), encoding="utf-8")
    return place


def reduced(values: NDArray[np.float32], size: int) -> NDArray[np.float32]:
    """Average a table down to at most a size, each sample over the reach of its new cell in u.

    Parameters
    ----------
    values : ndarray of float32, shape (rows, columns, 3)
        The table.
    size : int
        Its longest side afterwards; a smaller table stays as it is.

    Returns
    -------
    ndarray of float32, shape (<= size, <= size, 3)
        The table with its border samples on the same border.
    """
    rows, columns = (_averages(length, min(length, size)) for length in values.shape[:2])
    along = np.tensordot(rows, values, axes=(1, 0))
    return np.asarray(np.einsum("jc,rcx->rjx", columns, along, optimize=True), dtype=np.float32)


def half_floats(values: NDArray[np.float32]) -> tuple[NDArray[np.float16], float]:
    """Fit a table into half floats.

    Parameters
    ----------
    values : ndarray of float32
        The table.

    Returns
    -------
    halves : ndarray of float16
        The table over `scale`.
    scale : float
        What one unit of them stands for.
    """
    brightest = float(np.abs(values).max())
    scale = brightest / _BRIGHTEST if brightest > 0 else 1.0
    return (values / scale).astype("<f2"), scale


def _averages(length: int, size: int) -> NDArray[np.float32]:
    """Weights of a line's samples in each of fewer samples: overlaps of their cells, ends on the ends."""
    if size == length:
        return np.eye(length, dtype=np.float32)
    step = (length - 1) / (size - 1)
    centres = step * np.arange(size)[:, None]
    low, high = np.maximum(centres - step / 2, -0.5), np.minimum(centres + step / 2, length - 0.5)
    samples = np.arange(length)[None, :]
    overlap = np.clip(np.minimum(high, samples + 0.5) - np.maximum(low, samples - 0.5), 0.0, None)
    return np.asarray(overlap / overlap.sum(axis=1, keepdims=True), dtype=np.float32)


def _uniforms(table: ScatterTable, texels: NDArray[np.float16], scale: float) -> dict[str, Any]:
    rows, columns = texels.shape[:2]
    return {
        "rows": rows,
        "columns": columns,
        "scale": scale,
        "half_range": float(table.half_range),
        "warp": int(table.warp),
        "illuminant": table.illuminant,
    }


def _json_in_html(value: object) -> str:
    """JSON that cannot end the element that it lies in."""
    return json.dumps(value).replace("<", "\\u003c")


def _asset(name: str) -> str:
    return importlib.resources.files("aureole.surface").joinpath("web", name).read_text(encoding="utf-8")


def _suffixed(path: str | os.PathLike[str], suffix: str) -> Path:
    place = Path(path)
    refuse.one_of(f"suffix of {place.name}", place.suffix.lower(), (suffix,))
    return place


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
