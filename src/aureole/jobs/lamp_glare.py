"""Lamps behind occluders: one frame of a scene, each lamp seen in part, with the glare of that part.

Each lamp's glare is that of the openings that its points see past the occluders (quad paper §4.4, §6.1). The
occluders themselves lie over the background as soft as they are out of focus.
"""

import dataclasses
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import glare, light, picture, refuse
from aureole.glare.sources import with_colour
from aureole.jobs.frames import digest
from aureole.jobs.glare import BYTES_PER_KERNEL_PIXEL, BYTES_PER_PIXEL, in_working_space, picture_sums
from aureole.jobs.scene import LampAt, OccluderAt, SceneAt, SceneFile, scene_at
from aureole.records import Aperture, Camera, Picture, Stage

TOLERANCE, RASTER_SIZE = 0.05, 1024
# Spreads of lamps that are kept for the frames that come next.
KEPT = 8


@dataclass(frozen=True, eq=False)
class LampGlareJob:
    """A frame of a scene.

    Parameters
    ----------
    file : SceneFile
        The scene.
    frame : float
        From 1.
    shape : tuple of int, optional
        (rows, columns), in place of the scene's own.
    samples : int, optional
        Samples across each lamp; as many as the tolerance needs otherwise.
    tolerance : float
        By what part a lamp's glare may change from about half as many samples across.
    raster : int
        Pixels across the opening where an occluder is a matte.
    memory : int, optional
        Most bytes to use; three quarters of what is free otherwise.
    """

    file: SceneFile
    frame: float = 1.0
    shape: tuple[int, int] | None = None
    samples: int | None = None
    tolerance: float = TOLERANCE
    raster: int = RASTER_SIZE
    memory: int | None = None


@dataclass(frozen=True, eq=False)
class LampGlareResult:
    """A frame of a scene, and what is worth knowing.

    Parameters
    ----------
    picture : Picture
        Background and occluders, and the lamps with their glare.
    layers : tuple of Picture
        Each lamp's light alone.
    camera : Camera
        The camera.
    report : dict
        Plain numbers; "lamps" holds a dict for each lamp.
    """

    picture: Picture
    layers: tuple[Picture, ...]
    camera: Camera
    report: dict[str, Any]


def run_lamp_glare(job: LampGlareJob) -> Iterator[Stage]:
    """Make a frame of a scene.

    Parameters
    ----------
    job : LampGlareJob
        What to make.

    Yields
    ------
    Stage
        The last one holds a `LampGlareResult`.
    """
    refuse_numbers(job)
    scene = scene_at(job.file, job.frame, job.shape)
    behind, space = in_working_space(scene.background)
    patches = [glare.lamp_patch(scene.camera, lamp.light) for lamp in scene.lamps]
    _refuse_memory(job, scene, patches)
    layers, told = [], []
    for index, (lamp, patch) in enumerate(zip(scene.lamps, patches, strict=True)):
        found = None
        for stage in _spread(job, scene, lamp, patch, space):
            found = stage.result
            yield Stage(0.95 * (index + stage.fraction) / len(patches), f"{lamp.name}: {stage.label}")
        assert isinstance(found, glare.AreaPsf)
        layer, report = _lit(scene, lamp, patch, found)
        layers.append(layer)
        told.append(report)
    yield Stage(0.95, "background")
    pixels = seen_past(scene, behind)
    for layer in layers:
        pixels += layer.pixels
    out = with_colour(behind, pixels)
    out = Picture(out.pixels, scene.background.colour_space, scene.background.metadata)
    report = {
        "frame": job.frame,
        "visible": [lamp["visible"] for lamp in told],
        "sum": picture_sums(out),
        "lamps": told,
    }
    yield Stage(1.0, "frame", LampGlareResult(out, tuple(layers), scene.camera, report))


def refuse_numbers(job: LampGlareJob) -> None:
    """Refuse numbers of a job that mean nothing.

    Parameters
    ----------
    job : LampGlareJob
        Any.

    Raises
    ------
    refuse.Refusal
        Where the samples, the tolerance or the raster do not fit.
    """
    if job.samples is not None:
        refuse.at_least("samples", job.samples, 1)
    refuse.positive("tolerance", job.tolerance)
    refuse.at_least("raster", job.raster, 16)


def seen_past(scene: SceneAt, behind: Picture) -> NDArray[np.float32]:
    """Lay a scene's occluders over what is behind them.

    Parameters
    ----------
    scene : SceneAt
        Its occluders, the nearest first.
    behind : Picture
        Of the frame's size.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Each occluder out of focus, the camera being focused far away.
    """
    through = np.ones((*scene.camera.resolution, 1), dtype=np.float32)
    pixels = np.zeros((*scene.camera.resolution, 3), dtype=np.float32)
    for each in scene.occluders:
        open_part = glare.visibility(scene.camera, [each.occluder])[..., None]
        pixels += through * (1 - open_part) * np.asarray(each.colour, dtype=np.float32)
        through = through * open_part
    pixels += through * behind.pixels[..., :3]
    return pixels


def _lit(
    scene: SceneAt, lamp: LampAt, patch: glare.LampPatch, found: glare.AreaPsf
) -> tuple[Picture, dict[str, Any]]:
    """Return a lamp's light on the frame, and its plain numbers."""
    camera = scene.camera
    occluders = [each.occluder for each in scene.occluders]
    seen = glare.visibility(camera, occluders, lamp.light.distance, patch.window)
    share = glare.lamp_layer(found, patch, seen, camera.resolution)
    unhidden = np.asarray(lamp.radiance) * patch.pixels
    layer = Picture(share.pixels * unhidden.astype(np.float32), share.colour_space)
    pitches = [pitch / camera.focal_length for pitch in camera.pixel_pitch]
    x, y = (
        tangent / pitch + count // 2 + 0.5
        for tangent, pitch, count in zip(
            lamp.light.toward, pitches[::-1], camera.resolution[::-1], strict=True
        )
    )
    report = {
        "name": lamp.name,
        "place_pixels": [x, y],
        "visible": found.visible,
        "light_unhidden": [float(value) for value in unhidden],
        "light": picture_sums(layer),
        "samples_across": len(found.seen),
        "openings": found.openings,
        "error": found.error,
    }
    return layer, report


def _spread(
    job: LampGlareJob, scene: SceneAt, lamp: LampAt, patch: glare.LampPatch, space: str
) -> Iterator[Stage]:
    """Make a lamp's point spread function, or recall it from a frame on which nothing was different."""
    before = [each for each in scene.occluders if each.occluder.distance < lamp.light.distance]
    raster = job.raster if _needs_raster(scene, before) else None
    shape = _kernel_shape(scene, lamp, patch)
    spectrum = light.illuminant(lamp.illuminant)

    def made() -> Iterator[Stage]:
        return glare.area_psf_stages(
            scene.camera,
            lamp.light,
            [each.occluder for each in before],
            shape,
            spectrum,
            space,
            job.samples,
            job.tolerance,
            raster,
        )

    toward = lamp.light.toward if before else ()
    views = [
        (_shape_words(each.occluder.shape), each.occluder.distance, each.occluder.place) for each in before
    ]
    camera = [getattr(scene.camera, field.name) for field in dataclasses.fields(scene.camera)[:-1]]
    word = digest(
        camera,
        _shape_words(scene.camera.iris),
        _shape_words(lamp.light.shape),
        (toward, lamp.light.distance, lamp.illuminant, space, shape),
        views,
        (job.samples, job.tolerance, raster),
    )
    yield from _spreads.stages(word, made)


def _kernel_shape(scene: SceneAt, lamp: LampAt, patch: glare.LampPatch) -> tuple[int, int]:
    """Return the size of a lamp's point spread function; before all occluders one serves wherever it goes."""
    needed = glare.lamp_reach(patch, scene.camera.resolution)
    if any(each.occluder.distance < lamp.light.distance for each in scene.occluders):
        return needed
    rows, columns = scene.camera.resolution
    return max(needed[0], 2 * rows - 1), max(needed[1], 2 * columns - 1)


def _shape_words(shape: Aperture) -> list[Any]:
    """Return what tells a shape from others."""
    rings = [(ring.vertices.tobytes(), ring.bulges.tobytes(), ring.transmittance) for ring in shape.outlines]
    return [shape.width, rings, None if shape.mask is None else digest(shape.mask.tobytes())]


def _needs_raster(scene: SceneAt, before: Sequence[OccluderAt]) -> bool:
    return scene.camera.iris.mask is not None or any(each.occluder.shape.mask is not None for each in before)


class _Spreads:
    """The spreads of lamps that were made last."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._kept: dict[str, glare.AreaPsf] = {}

    def stages(self, word: str, make: Callable[[], Iterator[Stage]]) -> Iterator[Stage]:
        """Make what a word stands for, unless it is there."""
        with self._lock:
            found = self._kept.get(word)
        if found is not None:
            yield Stage(1.0, "as before", found)
            return
        for stage in make():
            found = stage.result
            yield stage
        assert isinstance(found, glare.AreaPsf)
        with self._lock:
            while len(self._kept) >= KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[word] = found


_spreads = _Spreads()


def _refuse_memory(job: LampGlareJob, scene: SceneAt, patches: Sequence[glare.LampPatch]) -> None:
    """Refuse lamps whose glare would not fit, before any work."""
    rows, columns = scene.camera.resolution
    shapes = [_kernel_shape(scene, *each) for each in zip(scene.lamps, patches, strict=True)]
    largest = max(shapes, key=lambda shape: shape[0] * shape[1])
    needed = BYTES_PER_KERNEL_PIXEL * largest[0] * largest[1] + BYTES_PER_PIXEL * rows * columns
    needed += 12 * (len(patches) * rows * columns + min(KEPT, len(patches)) * largest[0] * largest[1])
    limit = picture.allowed_memory(job.memory)
    if needed > limit:
        raise refuse.Refusal(
            f"glare that reaches over {largest[1]} x {largest[0]} pixels on {columns} x {rows} pixels needs "
            f"about {needed / 1e9:.3g} GB of memory, {limit / 1e9:.3g} GB are allowed; see --memory and "
            "--size."
        )
