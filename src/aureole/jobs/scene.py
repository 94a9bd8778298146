"""Scenes as people describe them: where their lamps and occluders are at a frame, as records of physics."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from aureole import aperture as apertures
from aureole import glare, picture, presets, refuse
from aureole.aperture import Occluder
from aureole.jobs import frame_files
from aureole.jobs.optics import Opening, Optics
from aureole.records import Aperture, Camera, Picture

# What each shape of an occluder is described by.
USES = {
    "railing": ("bar_mm", "gap_mm"),
    "edge": (),
    "disc": ("diameter_mm",),
    "rectangle": ("width_mm", "height_mm"),
    "polygon": ("corners_mm",),
    "picture": ("file", "width_mm"),
}
# What it may have besides.
MAY = {"railing": ("height_mm",)}
# An edge, and bars of no given length, reach so many times as far as they are away.
FAR = 20.0


@dataclass(frozen=True, eq=False)
class LampAt:
    """A lamp at a frame.

    Parameters
    ----------
    name : str
        For the report.
    light : aureole.glare.AreaLight
        Shape, direction and distance.
    illuminant : str
        Its spectrum.
    radiance : tuple of float
        What a pixel that it fills is worth: red, green and blue.
    """

    name: str
    light: glare.AreaLight
    illuminant: str
    radiance: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class OccluderAt:
    """An occluder at a frame.

    Parameters
    ----------
    occluder : Occluder
        Shape, distance and place.
    colour : tuple of float
        What it looks like.
    """

    occluder: Occluder
    colour: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class SceneAt:
    """A scene at a frame.

    Parameters
    ----------
    camera : Camera
        Its resolution is the frame's.
    lamps : tuple of LampAt
        All of them.
    occluders : tuple of OccluderAt
        The nearest first.
    background : Picture
        Of the frame's size.
    """

    camera: Camera
    lamps: tuple[LampAt, ...]
    occluders: tuple[OccluderAt, ...]
    background: Picture


@dataclass(frozen=True)
class SceneFile:
    """A scene, and where the files that it names lie.

    Parameters
    ----------
    scene : presets.ScenePreset
        What the file holds.
    folder : Path
        The file's own, in which the names of other files begin.
    path : Path
        The file.
    """

    scene: presets.ScenePreset
    folder: Path
    path: Path

    def names(self) -> list[str]:
        """Return the names of the files that the scene is made of."""
        lamps = [lamp.file for lamp in self.scene.lamps]
        occluders = [occluder.file for occluder in self.scene.occluders]
        return [name for name in (self.scene.background.file, *lamps, *occluders) if name is not None]

    def named(self, file: str, frame: float) -> Path:
        """Return the path of a file that the scene names, at a frame."""
        path = self.folder / file
        return frame_files.frame(path, round(frame)) if frame_files.is_pattern(path) else path


def read_scene(name: str) -> SceneFile:
    """Read a scene, and refuse what means nothing in it.

    Parameters
    ----------
    name : str
        A preset's name, or a path that ends in ".toml".

    Returns
    -------
    SceneFile
        The scene; all of it but the contents of the pictures that it names is checked.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read, or something in it does not fit.
    """
    scene: presets.ScenePreset = presets.load("scenes", name)
    path = presets.path("scenes", name).absolute()
    file = SceneFile(scene, path.parent, path)
    _optics(scene.camera).camera((scene.rows, scene.columns))
    for index, lamp in enumerate(scene.lamps):
        _check_lamp(lamp, _called("lamp", lamp.name, index))
    for index, occluder in enumerate(scene.occluders):
        _check_occluder(occluder, _called("occluder", occluder.name, index))
    return file


def scene_at(file: SceneFile, frame: float, shape: tuple[int, int] | None = None) -> SceneAt:
    """Return a scene at a frame.

    Parameters
    ----------
    file : SceneFile
        The scene.
    frame : float
        From 1; between two frames things are between their places.
    shape : tuple of int, optional
        (rows, columns) of the frame, in place of the scene's own.

    Returns
    -------
    SceneAt
        Lamps, occluders and background as they are then.

    Raises
    ------
    refuse.Refusal
        Where a picture cannot be read, or does not have the frame's size.
    """
    scene = file.scene
    refuse.finite("frame", frame)
    background = _background(file, frame, shape)
    rows, columns = background.pixels.shape[:2]
    camera = _optics(scene.camera).camera((rows, columns))
    lamps = tuple(
        LampAt(
            _called("lamp", lamp.name, index),
            glare.AreaLight(_lamp_shape(lamp, file, frame), _toward(lamp, frame), _distance(lamp)),
            lamp.illuminant,
            _colour([lamp.radiance * part for part in lamp.colour]),
        )
        for index, lamp in enumerate(scene.lamps)
    )
    occluders = []
    for each in sorted(scene.occluders, key=lambda occluder: occluder.distance_m):
        shape_then = _occluder_shape(each, file, frame)
        if shape_then is not None:
            standing = apertures.occluder(shape_then, each.distance_m, _on_path(each.path_m, frame))
            occluders.append(OccluderAt(standing, _colour(each.colour)))
    return SceneAt(camera, lamps, tuple(occluders), background)


def _called(what: str, name: str, index: int) -> str:
    return name or f"{what} {index + 1}"


def _colour(parts: Sequence[float]) -> tuple[float, float, float]:
    red, green, blue = (float(part) for part in parts)
    return red, green, blue


def _optics(camera: presets.SceneCamera) -> Optics:
    turn = None if camera.rotation_deg is None else math.radians(camera.rotation_deg)
    return Optics(
        Opening(blades=camera.blades, curvature=camera.curvature, rotation=turn),
        camera.preset,
        camera.iris,
        None if camera.focal_length_mm is None else camera.focal_length_mm * 1e-3,
        camera.f_number,
        None if camera.sensor_width_mm is None else camera.sensor_width_mm * 1e-3,
    )


def _check_lamp(lamp: presets.SceneLamp, name: str) -> None:
    """Refuse a lamp that says too little or too much."""
    needs = {"polygon": ("corners_mm",), "picture": ("file",)}.get(lamp.shape, ())
    for key in ("corners_mm", "file"):
        _check_key(lamp, key, name, key in needs, key in needs)
    sizes = [key for key in ("size_mm", "size_deg") if getattr(lamp, key) is not None]
    if len(sizes) != (0 if lamp.shape == "polygon" else 1):
        wanted = "no size" if lamp.shape == "polygon" else "one of 'size_mm' and 'size_deg'"
        raise refuse.Refusal(f"'{name}' of shape '{lamp.shape}' must have {wanted}, got {len(sizes)}.")
    if (lamp.path_m is None) == (lamp.path_deg is None):
        raise refuse.Refusal(f"'{name}' must have one of 'path_m' and 'path_deg'.")
    if lamp.distance_m is None:
        for key in ("size_mm", "path_m", "corners_mm"):
            if getattr(lamp, key) is not None:
                raise refuse.Refusal(f"'{key}' of '{name}' needs 'distance_m'.")
    _check_path(lamp.path_m or lamp.path_deg or [], name)
    if lamp.path_deg is not None and any(max(abs(x), abs(y)) >= 90 for _, x, y in lamp.path_deg):
        raise refuse.Refusal(f"'path_deg' of '{name}' must lie before the camera, within 90 degrees.")


def _check_occluder(occluder: presets.SceneOccluder, name: str) -> None:
    """Refuse an occluder that says too little or too much."""
    needs = USES[occluder.shape]
    for key in sorted({key for keys in (*USES.values(), *MAY.values()) for key in keys}):
        _check_key(occluder, key, name, key in needs, key in (*needs, *MAY.get(occluder.shape, ())))
    if occluder.shape == "picture" and occluder.rotation_deg:
        raise refuse.Refusal(
            f"'rotation_deg' of '{name}' does not go with a picture; turn the picture itself."
        )
    _check_path(occluder.path_m, name)


def _check_key(
    record: presets.SceneLamp | presets.SceneOccluder, key: str, name: str, needed: bool, may: bool
) -> None:
    there = getattr(record, key) is not None
    if needed and not there:
        raise refuse.Refusal(f"'{name}' of shape '{record.shape}' needs '{key}'.")
    if there and not may:
        raise refuse.Refusal(f"'{key}' of '{name}' does not go with shape '{record.shape}'.")


def _check_path(path: Sequence[Sequence[float]], name: str) -> None:
    frames = [key[0] for key in path]
    if any(after <= before for before, after in itertools.pairwise(frames)):
        raise refuse.Refusal(f"the path of '{name}' must have rising frames, got {frames}.")


def _on_path(path: Sequence[Sequence[float]], frame: float) -> tuple[float, float]:
    """Return (right, down) at a frame."""
    keys = np.asarray(path, dtype=np.float64)
    return float(np.interp(frame, keys[:, 0], keys[:, 1])), float(np.interp(frame, keys[:, 0], keys[:, 2]))


def _distance(lamp: presets.SceneLamp) -> float:
    return math.inf if lamp.distance_m is None else lamp.distance_m


def _toward(lamp: presets.SceneLamp, frame: float) -> tuple[float, float]:
    """Return the tangents of a lamp's direction."""
    if lamp.path_deg is not None:
        x, y = (math.tan(math.radians(angle)) for angle in _on_path(lamp.path_deg, frame))
    else:
        assert lamp.path_m is not None
        x, y = (at / _distance(lamp) for at in _on_path(lamp.path_m, frame))
    return x, y


def _lamp_shape(lamp: presets.SceneLamp, file: SceneFile, frame: float) -> Aperture:
    """Return a lamp's shape in tangents."""
    if lamp.corners_mm is not None:
        return apertures.polygon(np.asarray(lamp.corners_mm) * 1e-3 / _distance(lamp))
    if lamp.size_deg is not None:
        size = 2 * math.tan(math.radians(lamp.size_deg) / 2)
    else:
        assert lamp.size_mm is not None
        size = lamp.size_mm * 1e-3 / _distance(lamp)
    if lamp.shape == "disc":
        return apertures.circle(size)
    if lamp.shape == "square":
        return apertures.rectangle(size, size)
    assert lamp.file is not None
    return apertures.from_picture(picture.read(file.named(lamp.file, frame)), size)


def _occluder_shape(occluder: presets.SceneOccluder, file: SceneFile, frame: float) -> Aperture | None:
    """Return an occluder's silhouette in metres, None where its picture is black."""
    turn = math.radians(occluder.rotation_deg)
    far = FAR * occluder.distance_m
    width, height, bar, gap, across = (
        1e-3 * (value or 0.0)
        for value in (
            occluder.width_mm,
            occluder.height_mm,
            occluder.bar_mm,
            occluder.gap_mm,
            occluder.diameter_mm,
        )
    )
    match occluder.shape:
        case "railing":
            return apertures.railing(bar, gap, occluder.bars, height or far, turn)
        case "edge":
            return apertures.rotated(
                apertures.polygon([(0.0, -far), (far, -far), (far, far), (0.0, far)]), turn
            )
        case "disc":
            return apertures.circle(across)
        case "rectangle":
            return apertures.rotated(apertures.rectangle(width, height), turn)
        case "polygon":
            assert occluder.corners_mm is not None
            return apertures.rotated(apertures.polygon(np.asarray(occluder.corners_mm) * 1e-3), turn)
        case _:
            assert occluder.file is not None
            return silhouette(picture.read(file.named(occluder.file, frame)), width)


def silhouette(matte: Picture, width: float) -> Aperture | None:
    """Return the silhouette that a matte shows.

    Parameters
    ----------
    matte : Picture
        White is opaque.
    width : float
        Of its longer side, metres.

    Returns
    -------
    Aperture or None
        A raster that is 1 where it is opaque; None where nothing is.
    """
    if not np.any(matte.pixels[..., :3] > 0):
        return None
    return apertures.from_picture(matte, width)


def _background(file: SceneFile, frame: float, shape: tuple[int, int] | None) -> Picture:
    """Return what is behind all: a picture, or colours from the upper border to the lower."""
    scene = file.scene
    if scene.background.file is not None:
        given = picture.read(file.named(scene.background.file, frame))
        if shape is not None and given.pixels.shape[:2] != shape:
            raise refuse.Refusal(
                f"the background has {given.pixels.shape[1]} x {given.pixels.shape[0]} pixels, "
                f"not {shape[1]} x {shape[0]}; leave 'size' out."
            )
        return given
    rows, columns = (scene.rows, scene.columns) if shape is None else shape
    down = ((np.arange(rows) + 0.5) / rows)[:, None, None]
    top, bottom = np.array(scene.background.top), np.array(scene.background.bottom)
    pixels = np.broadcast_to(top + (bottom - top) * down, (rows, columns, 3))
    return Picture(np.ascontiguousarray(pixels, dtype=np.float32), scene.colour_space)
