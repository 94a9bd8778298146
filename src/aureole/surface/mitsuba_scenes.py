"""A scene of ours as one of Mitsuba 3: for `mitsuba.load_dict`, or as a file.

In comes what `render` takes; out goes a scene whose picture has the same mean. Light goes from lamp to
surface to eye, as in `render`; a longer ``path`` shows reflections among surfaces.
"""

import importlib
import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse
from aureole.picture import whole_file
from aureole.records import Spectrum
from aureole.surface.environment import Environment
from aureole.surface.integrate import as_spectrum
from aureole.surface.lamps import Lamp
from aureole.surface.mitsuba import INSTALL, bsdf, bsdf_of_file
from aureole.surface.pattern import DiffractionPattern
from aureole.surface.scene import Scene
from aureole.surface.shapes import Cylinder, Disc, Mesh, Plane, Pose, Shape
from aureole.surface.table import ScatterTable
from aureole.surface.views import View

_ENVIRONMENT_ROWS = 1024  # of a finer picture, where an environment has fewer
_CIE_Y = 106.7502593994  # Mitsuba's films divide by the integral of its ȳ, in nm
# Elements of a scene's file, by the plugin they hold.
_ELEMENTS = {
    "path": "integrator",
    "perspective": "sensor",
    "orthographic": "sensor",
    "hdrfilm": "film",
    "box": "rfilter",
    "independent": "sampler",
    "rectangle": "shape",
    "disk": "shape",
    "cylinder": "shape",
    "mask": "bsdf",
    "aureole_surface": "bsdf",
    "checkerboard": "texture",
    "point": "emitter",
    "directional": "emitter",
}


def mitsuba_scene(
    scene: Scene,
    table: ScatterTable | DiffractionPattern | Sequence[DiffractionPattern],
    shape: Shape,
    samples: int = 64,
    environment: Environment | None = None,
    spectrum: Spectrum | str = "E",
    model: str = "phase",
) -> dict[str, Any]:
    """Return a scene for Mitsuba, in the variant that is set.

    Parameters
    ----------
    scene : Scene
        Lamps, view, pose and material.
    table : ScatterTable, DiffractionPattern or sequence of DiffractionPattern
        What the surface scatters; patterns in a spectral variant.
    shape : Plane, Disc, Cylinder or Mesh
        The shape. A mesh has one tangent for each triangle.
    samples : int
        Samples a pixel.
    environment : Environment or None
        Light from all around, in linear Rec.709; not in a spectral variant.
    spectrum : Spectrum or str
        The lamps' light in a spectral variant, where their intensities are neutral.
    model : {"phase", "amplitude", "paper"}
        Power of the wavelength for patterns.

    Returns
    -------
    dict
        For `mitsuba.load_dict`; its film is linear Rec.709, or X, Y and Z in a spectral variant.

    Raises
    ------
    refuse.Refusal
        Where Mitsuba has nothing for a part of the scene.
    """
    mitsuba = _imported()
    if not mitsuba.variant():
        raise refuse.Refusal("Mitsuba has no variant yet: call 'aureole.surface.mitsuba.use' first.")
    spectral = "spectral" in mitsuba.variant()
    light_of = _spectral_light(spectrum) if spectral else _rgb_light
    found = _described(scene, samples, "xyz" if spectral else "rgb")
    found.update({f"lamp_{k}": _lamp(lamp, light_of) for k, lamp in enumerate(scene.lamps)})
    if environment is not None:
        found["environment"] = _environment(mitsuba, environment, spectral)
    surface = bsdf(table, scene.material, model)
    if isinstance(shape, Mesh):
        return {**_loaded(mitsuba, found), "shape": _mesh(mitsuba, shape, scene.pose, surface)}
    found["shape"] = _shape(shape, scene.pose, surface)
    return _loaded(mitsuba, found)


def write_mitsuba(
    path: str | os.PathLike[str],
    table: str | os.PathLike[str],
    scene: Scene,
    shape: Plane | Disc | Cylinder,
    samples: int = 64,
) -> Path:
    """Write a scene of Mitsuba that refers to a table's file.

    ``aureole.surface.mitsuba.use().load_file(path)`` reads it; Mitsuba itself is not wanted for writing.

    Parameters
    ----------
    path : path_like
        The scene, ``.xml``.
    table : path_like
        The table's file, relative to the scene's folder.
    scene : Scene
        Lamps, view, pose and material.
    shape : Plane, Disc or Cylinder
        The shape.
    samples : int
        Samples a pixel.

    Returns
    -------
    Path
        The scene.

    Raises
    ------
    refuse.Refusal
        Where a scene's file has nothing for a part of the scene, or it cannot be written.
    """
    place = Path(path)
    refuse.one_of(f"suffix of {place.name}", place.suffix.lower(), (".xml",))
    if isinstance(shape, Mesh):
        raise refuse.Refusal(
            "'shape' must be a Plane, Disc or Cylinder: a scene's file holds no mesh of ours."
        )
    found = _described(scene, samples, "rgb")
    found.update({f"lamp_{k}": _lamp(lamp, _rgb_light) for k, lamp in enumerate(scene.lamps)})
    found["shape"] = _shape(shape, scene.pose, bsdf_of_file(table, scene.material))
    root = ElementTree.Element("scene", version="3.0.0")
    root.extend(_elements(found))
    ElementTree.indent(root)
    with whole_file(place) as part:
        ElementTree.ElementTree(root).write(part, encoding="utf-8", xml_declaration=True)
    return place


def _imported() -> Any:
    try:
        return importlib.import_module("mitsuba")
    except ImportError:
        raise refuse.Refusal(f"Mitsuba is not installed; {INSTALL}.") from None


def _described(scene: Scene, samples: int, pixels: str) -> dict[str, Any]:
    """Say in plain words, numbers and matrices how the scene is seen."""
    if scene.mask is not None or scene.regions is not None:
        raise refuse.Refusal(
            "A scene with 'mask' or 'regions' cannot be given to Mitsuba; render it with ours."
        )
    count = refuse.at_least("samples", samples, 1)
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2, "hide_emitters": True},
        "sensor": _sensor(scene.view, count, pixels),
    }


def _sensor(view: View, samples: int, pixels: str) -> dict[str, Any]:
    rows, columns = view.shape
    right, up = (float(np.linalg.norm(side)) for side in (view.right, view.up))
    # Mitsuba's cameras look along z with x to the left.
    sides = (-view.right / right, view.up / up, view.forward)
    kind: dict[str, Any] = {
        "type": "perspective",
        "fov": float(np.degrees(2 * np.arctan(up))),
        "fov_axis": "y",
    }
    scale = (1.0, 1.0, 1.0)
    if not view.perspective:
        kind, scale = {"type": "orthographic"}, (right, right, 1.0)
    return {
        **kind,
        "near_clip": 1e-4,
        "far_clip": 1e5,
        "to_world": _matrix([*(side * by for side, by in zip(sides, scale, strict=True)), view.eye]),
        "film": {
            "type": "hdrfilm",
            "width": columns,
            "height": rows,
            "pixel_format": pixels,
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "independent", "sample_count": samples},
    }


def _lamp(lamp: Lamp, light_of: Callable[[NDArray[np.float64]], dict[str, Any]]) -> dict[str, Any]:
    """Write a lamp that shines all ways alike, or from one direction."""
    if np.any(lamp.facing):
        raise refuse.Refusal(
            "'lamps' must shine all ways alike for Mitsuba; give an area to it as a rectangle of its own."
        )
    if lamp.distant:
        along = [float(-part) for part in lamp.place]
        return {"type": "directional", "direction": along, "irradiance": light_of(lamp.intensity)}
    place = [float(part) for part in lamp.place]
    return {"type": "point", "position": place, "intensity": light_of(lamp.intensity)}


def _rgb_light(intensity: NDArray[np.float64]) -> dict[str, Any]:
    return {"type": "rgb", "value": [float(part) for part in intensity]}


def _spectral_light(spectrum: Spectrum | str) -> Callable[[NDArray[np.float64]], dict[str, Any]]:
    """Return what makes a neutral intensity the light's own, whose luminance it is."""
    given = as_spectrum(spectrum)
    if given.kind == "lines":
        raise refuse.Refusal("'spectrum' must be continuous for Mitsuba, got lines.")
    wavelengths = ", ".join(f"{1e9 * place:.6g}" for place in given.wavelengths)
    values = given.values * (_CIE_Y / (1e9 * light.tristimulus(given)[1]))

    def coloured(intensity: NDArray[np.float64]) -> dict[str, Any]:
        if np.ptp(intensity) > 1e-6 * intensity.max():
            raise refuse.Refusal("'lamps' must be neutral where 'spectrum' is their colour.")
        emitted = ", ".join(f"{value:.7g}" for value in values * intensity.mean())
        return {"type": "irregular", "wavelengths": wavelengths, "values": emitted}

    return coloured


def _environment(mitsuba: Any, environment: Environment, spectral: bool) -> dict[str, Any]:
    """Write light from all around: Mitsuba's pictures have +z in their middle column, ours −z."""
    if spectral:
        raise refuse.Refusal("'environment' holds colours, no spectra: use 'llvm_ad_rgb' for it.")
    if environment.colour_space != "rec709":
        raise refuse.Refusal(f"'environment' must be in rec709 for Mitsuba, got {environment.colour_space}.")
    return {
        "type": "envmap",
        "bitmap": mitsuba.Bitmap(_patches(environment.radiance)),
        "to_world": np.diag([-1.0, 1.0, -1.0, 1.0]),
    }


def _patches(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    """Lay even patches out for Mitsuba, which blends samples and has the poles in its outer rows."""
    rows = len(radiance)
    times = max(1, _ENVIRONMENT_ROWS // rows)
    # A new sample on the border of two patches is their mean.
    places = np.arange(times * rows + 1) / times
    above, below = np.ceil(places).astype(int) - 1, np.floor(places).astype(int)
    lines = 0.5 * (radiance[np.maximum(above, 0)] + radiance[np.minimum(below, rows - 1)])
    return np.ascontiguousarray(np.repeat(lines, times, axis=1), dtype=np.float32)


def _shape(shape: Plane | Disc | Cylinder, pose: Pose, surface: dict[str, Any]) -> dict[str, Any]:
    """Write a shape in its pose; a hole or an open side is cut by the surface's opacity."""
    match shape:
        case Plane():
            across = 0.5 * refuse.positive("width", shape.width)
            along = 0.5 * refuse.positive("height", shape.height)
            to_world = _posed(pose, np.diag([across, along, 1.0]))
            return {"type": "rectangle", "to_world": to_world, "bsdf": surface}
        case Disc():
            if not shape.radial:
                raise refuse.Refusal("'shape' must be a Disc with radial tangents for Mitsuba.")
            radius = 0.5 * refuse.positive("diameter", shape.diameter)
            cut = surface if shape.hole <= 0.0 else _cut(surface, 0.5 * shape.hole / radius, False)
            return {"type": "disk", "to_world": _posed(pose, np.diag([radius, radius, 1.0])), "bsdf": cut}
        case Cylinder():
            half = 0.5 * refuse.between("sweep", shape.sweep, 1e-6, 2.0 * np.pi)
            # Its angle begins at the side where the sheet does.
            start = np.array([-np.sin(half), 0.0, np.cos(half)])
            upright = np.array([0.0, 1.0, 0.0])
            turned = np.stack([start, np.cross(upright, start), upright], axis=1)
            tall = 0.5 * refuse.positive("height", shape.height)
            return {
                "type": "cylinder",
                "p0": [0.0, 0.0, -tall],
                "p1": [0.0, 0.0, tall],
                "radius": refuse.positive("radius", shape.radius),
                "to_world": _posed(pose, turned),
                "bsdf": surface if half >= np.pi else _cut(surface, half / np.pi, True),
            }


def _cut(surface: dict[str, Any], edge: float, below: bool) -> dict[str, Any]:
    """Leave of a surface what lies below or above an edge in u: a field of a checkerboard ends there."""
    to_uv = np.diag([0.5, 0.1, 1.0, 1.0])
    to_uv[:2, 3] = 0.5 - 0.5 * edge, 0.25
    shown, clear = ("color1", "color0") if below else ("color0", "color1")
    opacity = {"type": "checkerboard", shown: 1.0, clear: 0.0, "to_uv": to_uv}
    return {"type": "mask", "opacity": opacity, "nested": surface}


def _mesh(mitsuba: Any, mesh: Mesh, pose: Pose, surface: dict[str, Any]) -> Any:
    """Make triangles whose texture coordinates grow along their mean tangent and bitangent."""
    corners = mesh.triangles.reshape(-1)
    places = (mesh.vertices @ pose.axes + pose.place)[corners]
    normals = (mesh.normals @ pose.axes)[corners]
    tangents = (mesh.tangents @ pose.axes)[corners]
    bitangents = mesh.signs[corners, None] * np.cross(normals, tangents)
    along, across = (
        np.repeat(part.reshape(-1, 3, 3).mean(axis=1), 3, axis=0) for part in (tangents, bitangents)
    )
    texture = np.stack([(places * along).sum(axis=1), (places * across).sum(axis=1)], axis=1)
    properties = mitsuba.Properties()
    properties["bsdf"] = mitsuba.load_dict(surface)
    count = len(corners)
    made = mitsuba.Mesh(
        "surface", count, count // 3, has_vertex_normals=True, has_vertex_texcoords=True, props=properties
    )
    parameters = mitsuba.traverse(made)
    for name, values in (("positions", places), ("normals", normals), ("texcoords", texture)):
        parameters[f"vertex_{name}"] = mitsuba.Float(values.astype(np.float32).ravel())
    parameters["faces"] = mitsuba.UInt32(np.arange(count, dtype=np.uint32))
    parameters.update()
    return made


def _posed(pose: Pose, own: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the matrix of a shape's own axes (as columns), then its pose."""
    turned = pose.axes.T @ own
    return _matrix([*turned.T, pose.place])


def _matrix(columns: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the matrix of three axes and an origin."""
    matrix = np.eye(4)
    matrix[:3] = np.stack(columns, axis=1)
    return matrix


def _loaded(mitsuba: Any, described: dict[str, Any]) -> dict[str, Any]:
    """Give matrices as Mitsuba's own transforms."""
    found: dict[str, Any] = {}
    for name, value in described.items():
        if isinstance(value, dict):
            found[name] = _loaded(mitsuba, value)
        else:
            matrix = isinstance(value, np.ndarray)
            found[name] = mitsuba.ScalarTransform4f(value) if matrix else value
    return found


def _elements(described: dict[str, Any]) -> Iterator[ElementTree.Element]:
    """Write words, numbers, places, colours and plugins as a scene's file has them."""
    for name, value in described.items():
        if name == "type":
            continue
        if isinstance(value, dict) and value["type"] == "rgb":
            yield ElementTree.Element("rgb", name=name, value=_numbers(value["value"]))
        elif isinstance(value, dict):
            plugin = ElementTree.Element(_ELEMENTS[value["type"]], type=value["type"], name=name)
            plugin.extend(_elements(value))
            yield plugin
        elif isinstance(value, np.ndarray):
            transform = ElementTree.Element("transform", name=name)
            transform.append(ElementTree.Element("matrix", value=_numbers(value.ravel())))
            yield transform
        elif isinstance(value, list):
            kind = "vector" if name == "direction" else "point"
            yield ElementTree.Element(kind, name=name, value=_numbers(value))
        else:
            kind, text = _word(value)
            yield ElementTree.Element(kind, name=name, value=text)


def _word(value: Any) -> tuple[str, str]:
    match value:
        case bool():
            return "boolean", str(value).lower()
        case int():
            return "integer", str(value)
        case float():
            return "float", repr(value)
        case _:
            return "string", str(value)


def _numbers(values: Any) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)
