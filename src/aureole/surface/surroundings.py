"""Light from all around on samples of any shape: discs with radial grooves, cylinders, meshes.

In: what a view sees (`Seen`, a frame for each sample), a table, an environment; out: the light that
leaves towards the eye. A table is cut into cells (`table_cells.py`), each of which sees its part of the
surroundings, blurred by the cell's own extent in copies that are made once: no noise, the same every
time. Flat samples that face a whole picture are quicker and exact by `environment.py`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.surface import _kernels_around
from aureole.surface.environment import Environment, in_space
from aureole.surface.material import GEOMETRY
from aureole.surface.shapes import Seen
from aureole.surface.table import ScatterTable
from aureole.surface.table_cells import OVERLAP, table_cells

FINEST = 0.25  # of a pixel: the first copy's blur
WIDEST = 0.7  # radians: the last copy's blur
TEXELS_A_SIGMA = 1.5
MOST_TEXELS = 1025  # across a copy
IRRADIANCE_ROWS, IRRADIANCE_TEXELS = 64, 65
FACETS, STEEPEST = 256, 2.5


@dataclass(frozen=True, eq=False)
class Surroundings:
    """An environment's blurred copies and its irradiance, made once for many pictures.

    Parameters
    ----------
    texels : ndarray of float32, shape (N, 3)
        Octahedral maps one after another, each wider blurred than the one before.
    sizes, starts : ndarray of int64, shape (K,)
        Samples along a side of each, and its first place in `texels`.
    widths : ndarray of float64, shape (K,)
        σ of its blur, in radians.
    irradiance : ndarray of float32, shape (M, M, 3)
        Octahedral map of the irradiance on a surface by its normal.
    colour_space : str
        Of all.
    """

    texels: NDArray[np.float32]
    sizes: NDArray[np.int64]
    starts: NDArray[np.int64]
    widths: NDArray[np.float64]
    irradiance: NDArray[np.float32]
    colour_space: str


def surroundings(environment: Environment, colour_space: str | None = None) -> Surroundings:
    """Blur an environment step by step, once for many pictures.

    Parameters
    ----------
    environment : Environment
        The light.
    colour_space : str or None
        RGB space to work in; None is the environment's own.

    Returns
    -------
    Surroundings
        What `environment_light` and the others take.
    """
    lit = environment if colour_space is None else in_space(environment, colour_space)
    radiance = np.ascontiguousarray(lit.radiance, dtype=np.float32)
    rows = radiance.shape[0]
    # The first copy is blurred by a quarter of a pixel, each other twice as wide as the one before.
    finest = max(FINEST * np.pi / rows, 3.5 / MOST_TEXELS)
    count = 1 + max(0, int(np.ceil(np.log2(WIDEST / finest))))
    widths = finest * 2.0 ** np.arange(count)
    maps = []
    for sigma in widths:
        size = int(np.clip(np.ceil(6.0 * TEXELS_A_SIGMA / sigma), 9, MOST_TEXELS))
        copy = np.empty((size | 1, size | 1, 3), dtype=np.float32)
        _kernels_around.blur(shrunk(radiance, int(np.ceil(np.pi * 1.6 / sigma))), float(sigma), copy)
        maps.append(copy)
    sizes = np.array([len(copy) for copy in maps], dtype=np.int64)
    starts = np.concatenate([[0], np.cumsum(sizes[:-1] ** 2)]).astype(np.int64)
    texels = np.concatenate([copy.reshape(-1, 3) for copy in maps])
    return Surroundings(texels, sizes, starts, widths, _irradiance(radiance), lit.colour_space)


def environment_light(
    seen: Seen | NDArray[np.float32],
    table: ScatterTable | Sequence[ScatterTable],
    environment: Environment | Surroundings,
    samples: int = 512,
    fresnel: NDArray[np.floating] | None = None,
    geometry: str = "one",
    window: tuple[float, float] | None = None,
    regions: NDArray[np.integer] | None = None,
) -> NDArray[np.float32]:
    """Return the diffracted light that samples of any shape send to the eye from light all around.

    Parameters
    ----------
    seen : Seen, or ndarray of float32, shape (rows, columns, 17)
        From `see`.
    table : ScatterTable, or sequence of them
        What the surface does to light.
    environment : Environment or Surroundings
        The light; `surroundings` prepares it for many pictures.
    samples : int
        Cells that each table is cut into. With smooth lobes in a room of lamps and windows 512 are off by
        5 to 10 % of the mean radiance (root mean square), 2048 by 2 to 4 %; the time is proportional.
    fresnel : ndarray of float, shape (K, 3), or None
        F over the cosine between light and half vector (`schlick`, `conductor`); its square weighs each
        cell. None is a perfect mirror.
    geometry : {"one", "stam"}
        G, as in `Material`.
    window : tuple of float or None
        As in `Material`.
    regions : ndarray of int, shape (rows, columns), or None
        Which table each sample of `seen` has, where several are given.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Radiance 4π² ∫ F² G S_d L_i ds in the environment's colour space; 0 where there is no surface.

    Raises
    ------
    refuse.Refusal
        Where an argument is not as described.
    """
    count = refuse.at_least("samples", samples, 1)
    refuse.one_of("geometry", geometry, GEOMETRY)
    around = _prepared(environment)
    tables = list(table) if isinstance(table, Sequence) else [table]
    cells = np.stack([table_cells(one, count, around.colour_space, window) for one in tables])
    frames = _frames(seen)
    which = np.zeros(frames.shape[:2], dtype=np.int32)
    if regions is not None:
        which[:] = refuse.shape_of("regions", regions, frames.shape[:2])
        if which.size and (which.min() < 0 or which.max() >= len(tables)):
            raise refuse.Refusal(f"'regions' must hold whole numbers from 0 to {len(tables) - 1}.")
    out = np.empty((*frames.shape[:2], 3), dtype=np.float32)
    maps = around.texels, around.sizes, around.starts, around.widths
    _kernels_around.diffracted(frames, cells, which, *maps, _fresnel(fresnel), geometry == "stam", out)
    return out


def mirror_light(
    seen: Seen | NDArray[np.float32],
    environment: Environment | Surroundings,
    roughness: float = 0.0,
    fresnel: NDArray[np.floating] | None = None,
) -> NDArray[np.float32]:
    """Return what a mirror-like surface sends to the eye from light all around.

    Parameters
    ----------
    seen : Seen, or ndarray of float32, shape (rows, columns, 17)
        From `see`.
    environment : Environment or Surroundings
        The light.
    roughness : float
        Root mean square slope m of the facets (Beckmann's distribution, as in `Material`); 0 is a mirror.
    fresnel : ndarray of float, shape (K, 3), or None
        F over the cosine between light and half vector; None is a perfect mirror.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Radiance by Cook and Torrance's lobe; of a mirror where the roughness is 0.
    """
    around, frames = _prepared(environment), _frames(seen)
    out = np.empty((*frames.shape[:2], 3), dtype=np.float32)
    maps = around.texels, around.sizes, around.starts, around.widths
    _kernels_around.mirrored(frames, facets(roughness), *maps, _fresnel(fresnel), out)
    return out


def irradiance(
    seen: Seen | NDArray[np.float32], environment: Environment | Surroundings
) -> NDArray[np.float32]:
    """Return the irradiance on samples of any shape; albedo / π times it is the diffuse light.

    Parameters
    ----------
    seen : Seen, or ndarray of float32, shape (rows, columns, 17)
        From `see`.
    environment : Environment or Surroundings
        The light.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        ∫ L cos θ dω over the hemisphere above each; 0 where there is no surface.
    """
    around, frames = _prepared(environment), _frames(seen)
    size = len(around.irradiance)
    normals = frames[..., 4:7].astype(np.float64)
    u, v = _folded(np.where(frames[..., :1] > 0, normals, (0.0, 1.0, 0.0)))
    x, y = 0.5 * (u + 1.0) * (size - 1), 0.5 * (v + 1.0) * (size - 1)
    j, i = np.clip(x.astype(np.int64), 0, size - 2), np.clip(y.astype(np.int64), 0, size - 2)
    x, y = (x - j)[..., None], (y - i)[..., None]
    read = around.irradiance
    upper = (1 - x) * read[i, j] + x * read[i, j + 1]
    lower = (1 - x) * read[i + 1, j] + x * read[i + 1, j + 1]
    return np.asarray(((1 - y) * upper + y * lower) * (frames[..., :1] > 0), dtype=np.float32)


def facets(roughness: float) -> NDArray[np.float64]:
    """Cut Beckmann's distribution of slopes into even parts.

    Parameters
    ----------
    roughness : float
        Root mean square slope m; 0 is one facet.

    Returns
    -------
    ndarray of float64, shape (count, 4)
        Slopes along tangent and bitangent, variance of the share's blur, and the share.
    """
    m = refuse.between("roughness", roughness, 0.0, 10.0)
    if m == 0.0:
        return np.array([[0.0, 0.0, 0.0, 1.0]])
    # Vogel's spiral (1979) spreads places evenly over the disc of slopes that matter.
    order = np.arange(FACETS) + 0.5
    radius, angle = STEEPEST * m * np.sqrt(order / FACETS), order * np.pi * (3 - np.sqrt(5))
    share = np.exp(-((radius / m) ** 2))
    area = np.pi * (STEEPEST * m) ** 2 / FACETS
    # As wide a blur for a facet's part of the slopes as for a cell of a table.
    variance = np.full(FACETS, OVERLAP * area / 12)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), variance, share / share.sum()], axis=1)


def shrunk(radiance: NDArray[np.float32], rows: int) -> NDArray[np.float32]:
    """Average a latitude-longitude picture to about a number of rows, where it has more; light is kept.

    Parameters
    ----------
    radiance : ndarray of float32, shape (rows, columns, 3)
        The picture.
    rows : int
        Wanted; at least 8 are given.

    Returns
    -------
    ndarray of float32, shape (rows, 2 rows, 3)
        Means over solid angle.
    """
    high, wide = radiance.shape[:2]
    count = max(rows, 8)
    if count >= high:
        return radiance
    sines = np.diff(np.cos(np.pi * np.arange(high + 1) / high))[:, None, None]
    upright = _added(radiance * sines, count) / _added(np.broadcast_to(sines, (high, 1, 1)), count)
    turned = _added(upright.transpose(1, 0, 2), 2 * count) * (2 * count / wide)
    return np.ascontiguousarray(turned.transpose(1, 0, 2), dtype=np.float32)


def _added(values: NDArray[np.floating], count: int) -> NDArray[np.float64]:
    """Sum rows into fewer, those on a border in part."""
    size = len(values)
    sums = np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0, dtype=np.float64)])
    place = np.linspace(0.0, size, count + 1)
    low = np.minimum(place.astype(np.int64), size - 1)
    part = (place - low)[:, None, None]
    return np.asarray(np.diff(sums[low] * (1 - part) + sums[low + 1] * part, axis=0))


def _irradiance(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    """Irradiance by normal, summed over a smaller copy of the light."""
    lit = shrunk(radiance, IRRADIANCE_ROWS).astype(np.float64)
    rows, columns = lit.shape[:2]
    latitude = np.pi / 2 - np.pi * (np.arange(rows) + 0.5) / rows
    longitude = 2 * np.pi * (np.arange(columns) + 0.5) / columns - np.pi
    solid = -np.diff(np.sin(np.pi / 2 - np.pi * np.arange(rows + 1) / rows)) * 2 * np.pi / columns
    toward = np.stack(
        [
            np.cos(latitude)[:, None] * np.sin(longitude),
            np.repeat(np.sin(latitude)[:, None], columns, axis=1),
            -np.cos(latitude)[:, None] * np.cos(longitude),
        ],
        axis=-1,
    ).reshape(-1, 3)
    energy = (lit * solid[:, None, None]).reshape(-1, 3)
    normals = _unfolded(IRRADIANCE_TEXELS).reshape(-1, 3)
    out = [np.maximum(part @ toward.T, 0.0) @ energy for part in np.array_split(normals, 16)]
    size = IRRADIANCE_TEXELS
    return np.concatenate(out).reshape(size, size, 3).astype(np.float32)


def _unfolded(size: int) -> NDArray[np.float64]:
    """Directions of an octahedral map's samples, (size, size, 3)."""
    v, u = np.meshgrid(np.linspace(-1, 1, size), np.linspace(-1, 1, size), indexing="ij")
    y = 1 - np.abs(u) - np.abs(v)
    x = np.where(y < 0, np.copysign(1 - np.abs(v), u), u)
    z = np.where(y < 0, np.copysign(1 - np.abs(u), v), v)
    place = np.stack([x, y, z], axis=-1)
    return np.asarray(place / np.linalg.norm(place, axis=-1, keepdims=True))


def _folded(toward: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places of directions on an octahedral map."""
    x, y, z = np.moveaxis(toward / np.abs(toward).sum(axis=-1, keepdims=True), -1, 0)
    u = np.where(y < 0, np.copysign(1 - np.abs(z), x), x)
    v = np.where(y < 0, np.copysign(1 - np.abs(x), z), z)
    return u, v


def _prepared(environment: Environment | Surroundings) -> Surroundings:
    return environment if isinstance(environment, Surroundings) else surroundings(environment)


def _frames(seen: Seen | NDArray[np.float32]) -> NDArray[np.float32]:
    frames = seen.frames if isinstance(seen, Seen) else seen
    return np.ascontiguousarray(refuse.shape_of("seen", frames, (None, None, 17)), dtype=np.float32)


def _fresnel(fresnel: ArrayLike | None) -> NDArray[np.float32]:
    if fresnel is None:
        return np.ones((2, 3), dtype=np.float32)
    found = refuse.all_finite("fresnel", refuse.shape_of("fresnel", fresnel, (None, 3)))
    return np.ascontiguousarray(found, dtype=np.float32)
