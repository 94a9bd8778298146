"""Tables, a material and maps made ready for shading: once, for any number of frames and lamps."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import light, refuse
from aureole.surface import _kernels_shade
from aureole.surface.lamps import Lamp, lamp_rows
from aureole.surface.material import Material, material_of, shader_numbers
from aureole.surface.shapes import Seen, blocked
from aureole.surface.table import ScatterTable, neutral_white

Tables = ScatterTable | Sequence[ScatterTable]


@dataclass(frozen=True, eq=False)
class Shader:
    """Tables, material and maps as the shader's arrays: made once, used for many frames.

    Parameters
    ----------
    tables : ndarray of float32, shape (L · T, rows, columns, 3)
        Linear colour: T tables of the first light, T of the next, ...
    half_range : float
        |h| at their borders.
    warp : int
        Their power.
    numbers, fresnel : ndarray of float32
        From `shader_numbers`, and the half range.
    mask : ndarray of float32, shape (rows, columns)
        How much diffracts.
    regions : ndarray of int32, shape (rows, columns)
        Which table.
    colour_space : str
        Of tables and pictures.
    whites : ndarray of float64, shape (L, 3)
        What a white surface shows under each light.
    angles : ndarray of float32, shape (rows, columns), or None
        By how much the tangent is turned, in radians.
    sources : tuple of ScatterTable
        The first light's tables.
    material : Material
        The material.
    """

    tables: NDArray[np.float32]
    half_range: float
    warp: int
    numbers: NDArray[np.float32]
    fresnel: NDArray[np.float32]
    mask: NDArray[np.float32]
    regions: NDArray[np.int32]
    colour_space: str
    whites: NDArray[np.float64]
    angles: NDArray[np.float32] | None
    sources: tuple[ScatterTable, ...]
    material: Material


def shader(
    table: Tables,
    material: Material | None = None,
    mask: ArrayLike | None = None,
    regions: ArrayLike | None = None,
    colour_space: str = "rec709",
    angles: ArrayLike | None = None,
    others: Sequence[Tables] = (),
) -> Shader:
    """Prepare tables, a material and maps for shading.

    Parameters
    ----------
    table : ScatterTable, or sequence of them
        One, or one for each number in `regions`: of one size, range and warp.
    material : Material or None
        None is a surface that only diffracts, with a mirror's lobe where the table has left its zero order
        to one (`material_of`).
    mask : array_like, shape (rows, columns), or None
        How much diffracts, 0..1.
    regions : array_like of int, shape (rows, columns), or None
        Which table each part has.
    colour_space : str
        A name in `aureole.light.SPACES`; white of the first table's light becomes white of it.
    angles : array_like, shape (rows, columns), or None
        By how much the tangent is turned from the shape's own towards its bitangent, in radians: surfaces
        whose pattern differs in direction from part to part, and so seems to move as they turn.
    others : sequence of (ScatterTable, or sequence of them)
        The same surface's tables under other lights, for lamps whose `light` is 1, 2, ...

    Returns
    -------
    Shader
        What `shade` takes.

    Raises
    ------
    refuse.Refusal
        Where tables differ in size, range or warp, or a map does not fit.
    """
    lights = [tuple(one) if isinstance(one, Sequence) else (one,) for one in (table, *others)]
    _refuse_tables(lights)
    first = lights[0][0]
    neutral = neutral_white(first.white, colour_space)
    tables = np.empty((len(lights) * len(lights[0]), *first.values.shape), dtype=np.float32)
    for k, one in enumerate(part for group in lights for part in group):
        tables[k] = light.from_xyz(one.values, colour_space, neutral)
    whites = light.from_xyz(
        np.array([group[0].white for group in lights], dtype=float), colour_space, neutral
    )
    made_of = material_of(first) if material is None else material
    numbers, fresnel = shader_numbers(made_of)
    return Shader(
        tables,
        float(first.half_range),
        int(first.warp),
        np.append(numbers, np.float32(first.half_range)),
        fresnel,
        _mask(mask),
        _regions(regions, len(lights[0])),
        colour_space,
        np.asarray(whites, dtype=np.float64),
        None if angles is None else _map("angles", angles),
        lights[0],
        made_of,
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
    places = np.flatnonzero(seen.hit)
    out = np.zeros((*seen.hit.shape, 4), dtype=np.float32)
    frames = turned(prepared, seen.frames.reshape(-1, seen.frames.shape[2])[places])
    add_light(prepared, blocked(frames), places, 1.0, lamps, out)
    return out


def add_light(
    prepared: Shader,
    blocks: NDArray[np.float32],
    pixels: NDArray[np.int64],
    share: float,
    lamps: Sequence[Lamp],
    out: NDArray[np.float32],
) -> None:
    """Add what lamps make some frames send to the eye to their pixels.

    Parameters
    ----------
    prepared : Shader
        From `shader`.
    blocks : ndarray of float32, shape (B, 17 · 64)
        Frames, from `Caster` or `blocked`.
    pixels : ndarray of int64, shape (N,)
        Of the N frames.
    share : float
        Of a pixel that each frame fills.
    lamps : sequence of Lamp
        The lamps.
    out : ndarray of float32, shape (..., 4)
        Colour and coverage are added to its pixels.
    """
    rows = lamp_rows(lamps, prepared.whites, len(prepared.sources))
    given: tuple[Any, ...] = (
        np.float32(share),
        rows,
        prepared.tables,
        prepared.warp,
        prepared.regions,
        prepared.mask,
        prepared.numbers,
        prepared.fresnel,
        out.reshape(-1, 4),
    )
    _kernels_shade.shade(blocks, pixels, *given)


def turned(prepared: Shader, frames: NDArray[np.float32]) -> NDArray[np.float32]:
    """Turn frames' tangents by a shader's map of angles.

    Parameters
    ----------
    prepared : Shader
        From `shader`.
    frames : ndarray of float32, shape (N, 17)
        Frames; left as they are.

    Returns
    -------
    ndarray of float32, shape (N, 17)
        The same frames where there is no map.
    """
    if prepared.angles is None:
        return frames
    angle = prepared.angles[map_places(frames, prepared.angles)][:, None]
    bitangents = np.cross(frames[:, 4:7], frames[:, 7:10]) * frames[:, 10:11]
    found = frames.copy()
    found[:, 7:10] = np.cos(angle) * frames[:, 7:10] + np.sin(angle) * bitangents
    return found


def map_places(
    frames: NDArray[np.float32], values: NDArray[Any]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Find which pixels of a map over the texture frames have.

    Parameters
    ----------
    frames : ndarray of float32, shape (..., 17)
        Frames.
    values : ndarray, shape (rows, columns)
        The map, row 0 at v = 1.

    Returns
    -------
    row, column : ndarray of int64, shape (...,)
        Of each frame.
    """
    rows, columns = values.shape
    row = np.clip(((1.0 - frames[..., 12]) * rows).astype(np.int64), 0, rows - 1)
    column = np.clip((frames[..., 11] * columns).astype(np.int64), 0, columns - 1)
    return row, column


def _refuse_tables(lights: list[tuple[Any, ...]]) -> None:
    if any(len(group) != len(lights[0]) or not group for group in lights):
        raise refuse.Refusal("'table' must be at least one table, and as many under each light.")
    kinds = {(one.values.shape, float(one.half_range), int(one.warp)) for group in lights for one in group}
    if len(kinds) > 1:
        raise refuse.Refusal("'table' must be tables of one size, range and warp, to be used together.")


def _mask(mask: ArrayLike | None) -> NDArray[np.float32]:
    if mask is None:
        return np.ones((1, 1), dtype=np.float32)
    found = _map("mask", mask)
    if found.min() < 0 or found.max() > 1:
        raise refuse.Refusal("'mask' must lie in 0..1.")
    return found


def _map(name: str, values: ArrayLike) -> NDArray[np.float32]:
    found = refuse.all_finite(name, refuse.shape_of(name, values, (None, None)))
    return np.ascontiguousarray(found, dtype=np.float32)


def _regions(regions: ArrayLike | None, count: int) -> NDArray[np.int32]:
    if regions is None:
        return np.zeros((1, 1), dtype=np.int32)
    found = refuse.shape_of("regions", regions, (None, None))
    if found.dtype.kind not in "iub" or found.min() < 0 or found.max() >= count:
        raise refuse.Refusal(f"'regions' must hold whole numbers from 0 to {count - 1}, one for each table.")
    return np.ascontiguousarray(found, dtype=np.int32)
