"""A material on a shape under lamps, seen by a view: the picture, whole or in stages."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import light, refuse
from aureole.records import Picture, Stage
from aureole.surface import _kernels_shade
from aureole.surface.lamps import Lamp, lamp_rows
from aureole.surface.material import Material, shader_numbers
from aureole.surface.shapes import Mesh, Pose, Seen, Shape, see, shape_numbers
from aureole.surface.table import ScatterTable
from aureole.surface.views import View

# Samples between two stages; a mesh keeps a frame for each of them.
_BAND = 1 << 20


@dataclass(frozen=True, eq=False)
class Scene:
    """What is before the camera.

    Parameters
    ----------
    lamps : tuple of Lamp
        The lamps; all with the spectrum of the table.
    view : View
        The view.
    pose : Pose
        Where the shape is.
    material : Material
        Its material.
    mask : ndarray of float32, shape (rows, columns), or None
        How much diffracts, 0..1, over the texture coordinates, row 0 at v = 1 (segmentation; surface paper,
        Fig. 20).
    regions : ndarray of int, shape (rows, columns), or None
        Which table each part has, where several are given; as the mask.
    """

    lamps: tuple[Lamp, ...]
    view: View
    pose: Pose = field(default_factory=Pose)
    material: Material = field(default_factory=Material)
    mask: NDArray[np.floating] | None = None
    regions: NDArray[np.integer] | None = None


@dataclass(frozen=True, eq=False)
class Shader:
    """Tables, material and maps as the shader's arrays: made once, used for many frames.

    Parameters
    ----------
    tables : ndarray of float32, shape (T, rows, columns, 3)
        Linear colour.
    half_range : float
        |h| at their borders.
    warp : int
        Their power.
    numbers, fresnel : ndarray of float32
        From `shader_numbers`.
    mask : ndarray of float32, shape (rows, columns)
        How much diffracts.
    regions : ndarray of int32, shape (rows, columns)
        Which table.
    colour_space : str
        Of tables and pictures.
    """

    tables: NDArray[np.float32]
    half_range: float
    warp: int
    numbers: NDArray[np.float32]
    fresnel: NDArray[np.float32]
    mask: NDArray[np.float32]
    regions: NDArray[np.int32]
    colour_space: str = "rec709"


def shader(
    table: ScatterTable | Sequence[ScatterTable],
    material: Material | None = None,
    mask: ArrayLike | None = None,
    regions: ArrayLike | None = None,
    colour_space: str = "rec709",
) -> Shader:
    """Prepare tables, a material and maps for shading.

    Parameters
    ----------
    table : ScatterTable, or sequence of them
        One, or one for each number in `regions`: of one size, range and warp.
    material : Material or None
        None is a surface that only diffracts.
    mask : array_like, shape (rows, columns), or None
        How much diffracts, 0..1.
    regions : array_like of int, shape (rows, columns), or None
        Which table each part has.
    colour_space : str
        A name in `aureole.light.SPACES`; white of the table's light becomes white of it.

    Returns
    -------
    Shader
        What `shade` takes.

    Raises
    ------
    refuse.Refusal
        Where tables differ in size, range or warp, or a map does not fit.
    """
    tables = list(table) if isinstance(table, Sequence) else [table]
    _refuse_tables(tables)
    colours = [light.from_xyz(one.values, colour_space, one.white) for one in tables]
    together = colours[0][None] if len(colours) == 1 else np.stack(colours)
    numbers, fresnel = shader_numbers(Material() if material is None else material)
    return Shader(
        np.ascontiguousarray(together, dtype=np.float32),
        float(tables[0].half_range),
        int(tables[0].warp),
        numbers,
        fresnel,
        _mask(mask),
        _regions(regions, len(tables)),
        colour_space,
    )


def shade(prepared: Shader, seen: Seen, lamps: Sequence[Lamp]) -> NDArray[np.float32]:
    """Return what lamps make a surface send to the eye.

    Parameters
    ----------
    prepared : Shader
        From `shader`.
    seen : Seen
        From `see`.
    lamps : sequence of Lamp
        The lamps.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 4)
        Radiance in the shader's colour space, and 1 where there is a surface.
    """
    out = np.empty((*seen.frames.shape[:2], 4), dtype=np.float32)
    given: tuple[Any, ...] = (seen.frames, *_arrays(prepared, lamps), out)
    _kernels_shade.shade(*given)
    return out


def render(
    scene: Scene,
    table: ScatterTable | Sequence[ScatterTable] | Shader,
    shape: Shape,
    samples: int = 1,
    colour_space: str = "rec709",
) -> Picture:
    """Render a material on a shape.

    Parameters
    ----------
    scene : Scene
        Lamps, view, pose, material, maps.
    table : ScatterTable, sequence of them, or Shader
        What the surface does to light; a `Shader` made before carries its own material and maps.
    shape : Plane, Disc, Cylinder or Mesh
        The shape.
    samples : int
        Samples a pixel along each axis.
    colour_space : str
        Of the picture; a `Shader` has its own.

    Returns
    -------
    Picture
        Radiance, linear, with coverage as alpha (colour is associated with it).

    Raises
    ------
    refuse.Refusal
        Where the tables, the maps or a number do not fit.
    """
    result = None
    for stage in render_stages(scene, table, shape, samples, colour_space):
        result = stage.result
    assert isinstance(result, Picture)
    return result


def render_stages(
    scene: Scene,
    table: ScatterTable | Sequence[ScatterTable] | Shader,
    shape: Shape,
    samples: int = 1,
    colour_space: str = "rec709",
) -> Iterator[Stage]:
    """Render a material on a shape, band by band.

    Parameters
    ----------
    scene : Scene
        As for `render`, and so are the others.
    table : ScatterTable, sequence of them, or Shader
        What the surface does to light.
    shape : Plane, Disc, Cylinder or Mesh
        The shape.
    samples : int
        Samples a pixel along each axis.
    colour_space : str
        Of the picture.

    Yields
    ------
    Stage
        The last one has the picture.

    Raises
    ------
    refuse.Refusal
        As `render`.
    """
    count = refuse.at_least("samples", samples, 1)
    prepared = (
        table
        if isinstance(table, Shader)
        else shader(table, scene.material, scene.mask, scene.regions, colour_space)
    )
    rows, columns = scene.view.shape
    pixels = np.empty((rows, columns, 4), dtype=np.float32)
    step = max(1, _BAND // (columns * count * count))
    for first in range(0, rows, step):
        last = min(rows, first + step)
        _draw(scene, prepared, shape, count, (first, last), pixels)
        if last < rows:
            yield Stage(last / rows, "rendering")
    yield Stage(1.0, "rendered", Picture(pixels, prepared.colour_space))


def _draw(
    scene: Scene,
    prepared: Shader,
    shape: Shape,
    samples: int,
    span: tuple[int, int],
    pixels: NDArray[np.float32],
) -> None:
    """Fill some rows of a picture: at once where rays are cast, by way of frames where a mesh is drawn."""
    first, last = span
    if not isinstance(shape, Mesh):
        parts = shape_numbers(shape, scene.pose, scene.view)
        arrays = _arrays(prepared, scene.lamps)
        given: tuple[Any, ...] = (*parts, samples, *arrays, np.array(span, dtype=np.int64), pixels)
        _kernels_shade.draw(*given)
        return
    seen = see(shape, scene.view, scene.pose, samples, (first * samples, last * samples))
    drawn = shade(prepared, seen, scene.lamps)
    pixels[first:last] = drawn.reshape(last - first, samples, -1, samples, 4).mean(axis=(1, 3))


def _arrays(prepared: Shader, lamps: Sequence[Lamp]) -> tuple[Any, ...]:
    """What both kernels take, in their order."""
    numbers = np.append(prepared.numbers, np.float32(prepared.half_range))
    return (
        lamp_rows(tuple(lamps)),
        prepared.tables,
        prepared.warp,
        prepared.regions,
        prepared.mask,
        numbers,
        prepared.fresnel,
    )


def _refuse_tables(tables: list[Any]) -> None:
    if not tables:
        raise refuse.Refusal("'table' must be at least one table.")
    kinds = {(one.values.shape, float(one.half_range), int(one.warp)) for one in tables}
    if len(kinds) > 1:
        raise refuse.Refusal("'table' must be tables of one size, range and warp, to be used by region.")


def _mask(mask: ArrayLike | None) -> NDArray[np.float32]:
    if mask is None:
        return np.ones((1, 1), dtype=np.float32)
    found = refuse.all_finite("mask", refuse.shape_of("mask", mask, (None, None)))
    return np.ascontiguousarray(found, dtype=np.float32)


def _regions(regions: ArrayLike | None, count: int) -> NDArray[np.int32]:
    if regions is None:
        return np.zeros((1, 1), dtype=np.int32)
    found = refuse.shape_of("regions", regions, (None, None))
    if found.dtype.kind not in "iub" or found.min() < 0 or found.max() >= count:
        raise refuse.Refusal(f"'regions' must hold whole numbers from 0 to {count - 1}, one for each table.")
    return np.ascontiguousarray(found, dtype=np.int32)
