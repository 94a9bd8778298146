"""A scatter table for browsers and engines: one HTML page, a GLSL function.

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
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.picture import whole_file
from aureole.surface.material import GEOMETRY, Material, material_of, schlick, shader_numbers
from aureole.surface.scene import Scene
from aureole.surface.shapes import Cylinder, Disc, Mesh, Plane, Shape
from aureole.surface.table import ScatterTable, rgb
from aureole.surface.table_files import write_table

SHAPES = ("plane", "disc", "cylinder")
# A texture's brightest sample, an eighth of the largest half float: dim orders keep the most digits.
_BRIGHTEST = 8192.0
_LARGEST_TEXTURE = 2048
_COSINES = 65  # of Fresnel's factors; as in page.glsl


@dataclasses.dataclass(frozen=True)
class WebView:
    """How the page first shows the object, which lies at the origin with z toward the eye.

    Parameters
    ----------
    shape : str
        One of `SHAPES`: a plane, a disc whose tangents are radial, a cylinder that stands upright.
    extents : dict of str to tuple of float
        Half width and half height; outer and inner radius; radius and half height: any unit of length.
    sweep : float
        Angle that a cylinder covers, its middle toward +z; radians.
    radial : bool
        Whether a disc's tangents are radial, or along x.
    yaw : float
        Radians, about the page's y axis.
    pitch : float
        Radians, about the page's x axis, before the yaw.
    axes : tuple of tuple of float
        The object's x, y and z axis in the page, a row each, before pitch and yaw.
    pan : tuple of float
        The eye's x and y; it looks along -z.
    distance : float
        The eye's z.
    field_of_view : float
        Radians from the picture's lower to its upper edge.
    lamp : tuple of float
        The lamp's place; the direction to it where `lamp_distant`.
    lamp_power : float
        Its radiant intensity: the irradiance at distance 1, facing it; the irradiance where `lamp_distant`.
    lamp_colour : tuple of float
        What multiplies it, linear Rec.709.
    lamp_distant : bool
        Whether its light comes from one direction.
    exposure : float or None
        Stops; None leaves it to the page, which finds one that suits the picture.
    f0 : tuple of float
        Reflectance at normal incidence, linear Rec.709; Schlick's factor follows from it.
    fresnel : tuple of tuple of float or None
        Factors F at evenly spaced cosines 0..1 instead.
    diffraction : float
        Weight of the table's part.
    diffuse : tuple of float
        Albedo of the diffuse part, linear Rec.709.
    specular : float
        Weight of the Cook-Torrance lobe.
    roughness : float
        Root mean square slope of its facets.
    geometry : str
        "one" or "stam", as in `Material`.
    window : tuple of float or None
        σ in h along tangent and bitangent of the Gaussian that multiplies the table.
    samples : int
        Samples a pixel along each axis, 1..4.
    """

    shape: str = "disc"
    extents: dict[str, tuple[float, float]] = dataclasses.field(
        default_factory=lambda: {"plane": (1.0, 0.6), "disc": (1.0, 0.25), "cylinder": (0.6, 0.8)}
    )
    sweep: float = 2.0 * np.pi
    radial: bool = True
    yaw: float = 0.0
    pitch: float = 0.0
    axes: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    pan: tuple[float, float] = (0.0, 0.0)
    distance: float = 4.0
    field_of_view: float = 0.6
    lamp: tuple[float, float, float] = (0.0, 1.2, 4.0)
    lamp_power: float = 16.0
    lamp_colour: tuple[float, float, float] = (1.0, 1.0, 1.0)
    lamp_distant: bool = False
    exposure: float | None = None
    f0: tuple[float, float, float] = (1.0, 1.0, 1.0)
    fresnel: tuple[tuple[float, ...], ...] | None = None
    diffraction: float = 1.0
    diffuse: tuple[float, float, float] = (0.0, 0.0, 0.0)
    specular: float = 0.0
    roughness: float = 0.1
    geometry: str = "one"
    window: tuple[float, float] | None = None
    samples: int = 2


def web_view(
    scene: Scene,
    shape: Shape,
    exposure: float | None = None,
    samples: int = 2,
    table: ScatterTable | None = None,
) -> WebView:
    """Return the page's view of a scene that `render` draws.

    Parameters
    ----------
    scene : Scene
        One lamp that shines all ways alike, a view in perspective, pose and material.
    shape : Plane, Disc or Cylinder
        The shape.
    exposure : float or None
        Stops; None leaves it to the page.
    samples : int
        Samples a pixel along each axis, 1..4.
    table : ScatterTable or None
        What the page will show; it says the material where the scene does not (`material_of`).

    Returns
    -------
    WebView
        A page of the view's own size shows the same picture.

    Raises
    ------
    refuse.Refusal
        Where the page has nothing for a part of the scene.
    """
    kind, extent = _extent(shape)
    if len(scene.lamps) != 1 or np.any(scene.lamps[0].facing):
        raise refuse.Refusal("'lamps' must be one lamp that shines all ways alike, for a page.")
    if scene.mask is not None or scene.regions is not None or not scene.view.perspective:
        raise refuse.Refusal("A page has a view in perspective, and neither 'mask' nor 'regions'.")
    for name in ("groups", "environment", "angles", "lens"):
        if getattr(scene, name) not in (None, ()):
            raise refuse.Refusal(f"'{name}' is nothing that a page can show.")
    view, lamp = scene.view, scene.lamps[0]
    material = scene.material
    if material is None:
        material = Material() if table is None else material_of(table)
    shader_numbers(material)
    # The page's axes are the picture's: right, up, and toward the eye.
    up = float(np.linalg.norm(view.up))
    axes = np.stack([view.right / np.linalg.norm(view.right), view.up / up, -view.forward])
    eye = axes @ (view.eye - scene.pose.place)
    place = axes @ (lamp.place if lamp.distant else lamp.place - scene.pose.place)
    power = float(np.max(lamp.intensity))
    own = WebView()
    return dataclasses.replace(
        own,
        shape=kind,
        extents={**_scaled(own.extents, extent[0]), kind: extent},
        sweep=shape.sweep if isinstance(shape, Cylinder) else own.sweep,
        radial=not isinstance(shape, Disc) or shape.radial,
        axes=tuple(_three(row) for row in (scene.pose.axes @ axes.T)),
        pan=(float(eye[0]), float(eye[1])),
        distance=float(eye[2]),
        field_of_view=2.0 * float(np.arctan(up)),
        lamp=_three(place),
        lamp_power=power,
        lamp_colour=_three(lamp.intensity / power if power > 0 else np.ones(3)),
        lamp_distant=lamp.distant,
        exposure=exposure,
        samples=samples,
        **_of_material(material),
    )


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
    state = _state(view or WebView())
    page = _asset("page.html")
    for mark, text in (
        ("TITLE", html.escape(title)),
        ("DIFFRACTION", _asset("diffraction.glsl")),
        ("SCENE", _asset("page.glsl")),
        ("STATE", _json_in_html(state)),
        ("TABLE", _json_in_html(_uniforms(table, texels, scale))),
        ("TEXELS", base64.b64encode(gzip.compress(texels.tobytes(), mtime=0)).decode()),
        ("SCRIPT", _asset("page.js")),
    ):
        page = page.replace(f"@{mark}@", text)
    with whole_file(place) as part:
        part.write_text(page, encoding="utf-8")
    return place


def write_glsl(path: str | os.PathLike[str], table: ScatterTable | None = None) -> Path:
    """Write the GLSL functions that look a table up and return the diffracted part of the BRDF.

    Its comments say how three.js, Godot and Unreal take it.

    Parameters
    ----------
    path : path_like
        The file, ``.glsl``.
    table : ScatterTable or None
        Written beside it as ``.exr`` in linear Rec.709, with its numbers in the file's first lines.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    refuse.Refusal
        Where the suffix is another or a file cannot be written.
    """
    place = _suffixed(path, ".glsl")
    text = _asset("diffraction.glsl") + "\n" + _asset("engines.glsl")
    if table is not None:
        beside = write_table(place.with_suffix(".exr"), table, "rec709")[0]
        rows, columns = table.values.shape[:2]
        text = (
            f"// {beside.name}: {columns} x {rows} samples, light {table.illuminant}; aureole_scale = 1.0, "
            f"aureole_half_range = {float(table.half_range)}, aureole_warp = {float(table.warp)}.\n//\n{text}"
        )
    with whole_file(place) as part:
        part.write_text(text, encoding="utf-8")
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


def _extent(shape: Shape) -> tuple[str, tuple[float, float]]:
    """Check a shape and write it as the page's kind and lengths."""
    if isinstance(shape, Mesh):
        raise refuse.Refusal("'shape' must be a Plane, Disc or Cylinder for a page, not a mesh.")
    match shape:
        case Plane():
            kind, extent = "plane", (0.5 * shape.width, 0.5 * shape.height)
        case Disc():
            kind, extent = "disc", (0.5 * shape.diameter, 0.5 * shape.hole)
        case Cylinder():
            kind, extent = "cylinder", (shape.radius, 0.5 * shape.height)
    refuse.positive("shape", extent[0])
    return kind, extent


def _scaled(extents: dict[str, tuple[float, float]], size: float) -> dict[str, tuple[float, float]]:
    return {kind: (size * first, size * second) for kind, (first, second) in extents.items()}


def _three(values: NDArray[np.floating] | ArrayLike) -> tuple[float, float, float]:
    first, second, third = (float(value) for value in np.broadcast_to(np.asarray(values), (3,)))
    return first, second, third


def _of_material(material: Material) -> dict[str, Any]:
    """Write a material as the page's state."""
    found: dict[str, Any] = {
        name: getattr(material, name) for name in ("roughness", "diffraction", "geometry", "window")
    }
    found["diffuse"] = _three(material.diffuse)
    found["specular"] = float(np.mean(_three(material.specular)))
    if material.fresnel is not None:
        found["fresnel"] = tuple(tuple(row) for row in material.fresnel.tolist())
    return found


def _state(view: WebView) -> dict[str, Any]:
    """Check a view and write it for the page, Fresnel's factors on the page's cosines."""
    refuse.one_of("shape", view.shape, SHAPES)
    refuse.one_of("geometry", view.geometry, GEOMETRY)
    refuse.positive("distance", view.distance)
    refuse.between("samples", refuse.at_least("samples", view.samples, 1), 1, 4)
    given = schlick(view.f0) if view.fresnel is None else np.asarray(view.fresnel, dtype=np.float64)
    cosines, own = np.linspace(0.0, 1.0, _COSINES), np.linspace(0.0, 1.0, len(given))
    factors = np.stack([np.interp(cosines, own, channel) for channel in given.T], axis=1)
    state = dataclasses.asdict(view)
    state["fresnel"] = [round(float(value), 7) for value in factors.ravel()]
    state["inverse_window"] = [0.0 if view.window is None else 0.5 / s**2 for s in view.window or (1.0, 1.0)]
    return state


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
