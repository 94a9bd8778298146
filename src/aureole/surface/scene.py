"""A material on a shape under lamps and light from all around, seen by a view: the picture, or its stages."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.aperture.bands import in_bands
from aureole.records import Picture, Stage
from aureole.surface.around import Around
from aureole.surface.environment import Environment
from aureole.surface.focus import ThinLens, lens_views
from aureole.surface.lamps import Lamp
from aureole.surface.material import Material
from aureole.surface.shading import Shader, Tables, add_light, shader, turned
from aureole.surface.shadows import Shadow
from aureole.surface.shapes import (
    Caster,
    Cylinder,
    Disc,
    Mesh,
    Plane,
    Pose,
    Seen,
    Shape,
    blocked,
    see,
    unblocked,
)
from aureole.surface.views import View

_BAND = 1 << 20  # samples between two stages
_CHUNK = 1 << 13  # samples that a thread casts and shades before the next
_BYTES = 300  # of memory that a sample of a band takes where frames are kept


@dataclass(frozen=True, eq=False)
class Scene:
    """What is before the camera.

    Parameters
    ----------
    lamps : tuple of Lamp
        The lamps with the spectrum of the table.
    view : View
        The view.
    pose : Pose
        Where the shape is.
    material : Material or None
        Its material; None is a surface that only diffracts (`material_of` its table).
    mask : ndarray of float32, shape (rows, columns), or None
        How much diffracts, 0..1, over the texture coordinates, row 0 at v = 1 (segmentation; surface paper,
        Fig. 20).
    regions : ndarray of int, shape (rows, columns), or None
        Which table each part has, where several are given; as the mask.
    angles : ndarray of float, shape (rows, columns), or None
        By how much the tangent is turned towards the bitangent, in radians; as the mask.
    groups : tuple of (tuple of Lamp, ScatterTable or sequence of them)
        Lamps of other spectra, each group with the surface's tables under it. White of the first table's
        light is the picture's white.
    environment : Environment or None
        Light from all around, with the spectrum of the first table where it is white.
    environment_samples : int
        Cells that a table is cut into for light from all around on shapes that are not flat.
    shadows : bool
        Whether cylinders and meshes keep lamps' light from themselves.
    lens : ThinLens or None
        Depth of field: a view from each of its points; None is a pinhole.
    """

    lamps: tuple[Lamp, ...]
    view: View
    pose: Pose = field(default_factory=Pose)
    material: Material | None = None
    mask: NDArray[np.floating] | None = None
    regions: NDArray[np.integer] | None = None
    angles: NDArray[np.floating] | None = None
    groups: tuple[tuple[tuple[Lamp, ...], Tables], ...] = ()
    environment: Environment | None = None
    environment_samples: int = 1024
    shadows: bool = True
    lens: ThinLens | None = None


def render(
    scene: Scene,
    table: Tables | Shader,
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
        What the surface does to light; a `Shader` made before carries its own material, maps and tables of
        the scene's groups, whose lamps then have `light` 1, 2, ...
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
        Where the tables, the maps or a number do not fit, or the picture needs more memory than there is.
    """
    result = None
    for stage in render_stages(scene, table, shape, samples, colour_space):
        result = stage.result
    assert isinstance(result, Picture)
    return result


def render_stages(
    scene: Scene,
    table: Tables | Shader,
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
    _refuse_size(scene.view.shape, count)
    prepared = table if isinstance(table, Shader) else _prepared(scene, table, colour_space)
    rows, columns = scene.view.shape
    pixels = np.zeros((rows, columns, 4), dtype=np.float32)
    views = (scene.view,) if scene.lens is None else lens_views(scene.view, scene.lens)
    step = max(1, _BAND // (columns * count * count))
    bands = [(first, min(rows, first + step)) for first in range(0, rows, step)]
    around = _around(scene, prepared)
    for index, view in enumerate(views):
        draw = _drawer(scene, prepared, shape, count, view, around)
        for number, (first, last) in enumerate(bands):
            draw(first, last, 1.0 / len(views), pixels)
            done = (index * len(bands) + number + 1) / (len(views) * len(bands))
            if done < 1.0:
                yield Stage(done, "rendering")
    yield Stage(1.0, "rendered", Picture(pixels, prepared.colour_space))


Drawer = Callable[[int, int, float, NDArray[np.float32]], None]


def _drawer(
    scene: Scene, prepared: Shader, shape: Shape, samples: int, view: View, around: Around | None
) -> Drawer:
    """Choose how to add rows of a view to a picture: chunk by chunk, or by way of frames that are kept."""
    lamps = _all_lamps(scene)
    shadows = None
    if scene.shadows and isinstance(shape, Cylinder | Mesh):
        shadows = tuple(Shadow(shape, scene.pose, lamp) for lamp in lamps)
    lighting = Lighting(prepared, lamps, shadows)
    even = isinstance(shape, Plane) or (isinstance(shape, Disc) and not shape.radial)

    def by_frames(first: int, last: int, share: float, pixels: NDArray[np.float32]) -> None:
        seen = see(shape, view, scene.pose, samples, (first * samples, last * samples))
        frames = turned(prepared, seen.frames.reshape(-1, seen.frames.shape[2]))
        seen = Seen(frames.reshape(seen.frames.shape))
        _add_lamps(lighting, seen, share, pixels[first:last])
        if around is not None:
            lit = around(seen, even and prepared.angles is None, samples)
            mean = lit.reshape(last - first, samples, -1, samples, 3).mean(axis=(1, 3))
            pixels[first:last, :, :3] += np.float32(share) * mean

    if isinstance(shape, Mesh) or around is not None or prepared.angles is not None:
        return by_frames
    caster = Caster(shape, scene.pose, view, samples)

    def by_chunks(first: int, last: int, share: float, pixels: NDArray[np.float32]) -> None:
        def work(begin: int, end: int) -> None:
            step = samples * max(1, _CHUNK // (view.shape[1] * samples**2))
            rows = (first + begin) * samples, (first + end) * samples
            for row, until, blocks, places in caster(*rows, step, samples):
                part = pixels[row // samples : until // samples]
                lighting(blocks, places, share / samples**2, part)

        in_bands(work, last - first)

    return by_chunks


@dataclass(frozen=True, eq=False)
class Lighting:
    """A surface under lamps, and what keeps their light from it.

    Parameters
    ----------
    prepared : Shader
        The surface.
    lamps : tuple of Lamp
        The lamps.
    shadows : tuple of Shadow, or None
        One for each lamp.
    """

    prepared: Shader
    lamps: tuple[Lamp, ...]
    shadows: tuple[Shadow, ...] | None

    def __call__(
        self, blocks: NDArray[np.float32], places: NDArray[np.int64], share: float, out: NDArray[np.float32]
    ) -> None:
        """Add what frames send to the eye to their pixels, as `add_light`, each lamp where it reaches.

        Parameters
        ----------
        blocks, places, share, out : see there
            As for `add_light`.
        """
        if self.shadows is None:
            add_light(self.prepared, blocks, places, share, self.lamps, out)
            return
        frames = unblocked(blocks, len(places))
        add_light(self.prepared, blocks, places, share, (), out)
        colour = np.zeros_like(out)
        for lamp, shadow in zip(self.lamps, self.shadows, strict=True):
            lit = shadow.reaches(frames)
            given = (blocks, places) if lit.all() else (blocked(frames[lit]), places[lit])
            add_light(self.prepared, *given, share, (lamp,), colour)
        out[..., :3] += colour[..., :3]


def _add_lamps(lighting: Lighting, seen: Seen, share: float, pixels: NDArray[np.float32]) -> None:
    """Add what lamps make kept frames send to the eye to their pixels."""
    samples = len(seen.frames) // len(pixels)

    def work(begin: int, end: int) -> None:
        part = seen.frames[begin * samples : end * samples]
        row, column = np.nonzero(part[..., 0] > 0)
        places = (row // samples) * pixels.shape[1] + column // samples
        lighting(blocked(part[row, column]), places, share / samples**2, pixels[begin:end])

    in_bands(work, len(pixels))


def _all_lamps(scene: Scene) -> tuple[Lamp, ...]:
    """Return the lamps of all groups, each with the number of its light."""
    others = (
        replace(lamp, light=number) for number, group in enumerate(scene.groups, 1) for lamp in group[0]
    )
    return (*scene.lamps, *others)


def _prepared(scene: Scene, table: Tables, colour_space: str) -> Shader:
    others = [group[1] for group in scene.groups]
    return shader(table, scene.material, scene.mask, scene.regions, colour_space, scene.angles, others)


def _around(scene: Scene, prepared: Shader) -> Around | None:
    if scene.environment is None:
        return None
    return Around(prepared, scene.environment, scene.environment_samples)


def _refuse_size(shape: tuple[int, int], samples: int) -> None:
    """Refuse a picture that does not fit into memory."""
    rows, columns = shape
    band = min(max(_BAND, columns * samples**2), rows * columns * samples**2)
    needed, allowed = 16 * rows * columns + _BYTES * band, picture.allowed_memory()
    if needed > allowed:
        raise refuse.Refusal(
            f"A picture of {columns} x {rows} pixels needs {needed / 2**30:.1f} GB of memory,"
            f" {allowed / 2**30:.1f} GB are allowed."
        )
