"""Ghosts of a lens as a picture: from lights to rays, primitives and pixels.

For each light and ghost a sheet of rays is traced at few wavelengths, bands of colour between them are drawn,
and every quad of rays lays its power down where it lands. Pictures are in XYZ, in units in which the light's
own image would sum to its irradiance: the ghosts' sum over that is the ghost-to-image ratio.
"""

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from aureole import light, refuse
from aureole.diffraction.ringing import RingingTexture
from aureole.flare import blending, energy, paraxial, primitives, pupil, raster, tracing
from aureole.flare.blending import Blend
from aureole.flare.ghost_paths import GhostPath
from aureole.flare.iris import StopMask, stop_mask
from aureole.flare.lights import checked, place_on_picture, point_count, points_of, white_of
from aureole.flare.prescription import Lens
from aureole.flare.primitives import Primitives
from aureole.flare.spectral import DEFAULT_WAVELENGTHS, sample_spectrum
from aureole.light.spaces import WHITE_KEY
from aureole.records import Aperture, Light, Picture, Spectrum, Stage

SHAPE = (1080, 1920)
# Metadata of a picture of ghosts: the part of the lights' images that the ghosts in the frame make up.
RATIO_KEY = "ghost_to_image"
# How many ghosts are traced at once, and how many primitives are drawn at once: 120 bytes each.
ADAPTS = ("frame", "bounds", "paper")
BATCH, MOST_PRIMITIVES = 32, 2_000_000
IMAGE_SIDE = 64
AXIS = (0.0, 0.0, 1.0)
# Of a layer's window, beyond its primitives.
MARGIN = 2

Pixels = NDArray[np.float32]
Iris = Aperture | RingingTexture | NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class Options:
    """How ghosts are rendered.

    Parameters
    ----------
    ghosts : str or sequence of GhostPath
        "same-side", "paper" or "all" as in `aureole.flare.ghosts`; the strongest as in
        `aureole.flare.energy.chosen`: "top:20" or "90%"; or paths.
    f_number : float, optional
        Of the iris; wide open without it.
    iris : Aperture, RingingTexture or ndarray, optional
        The iris's shape, as in `aureole.flare.iris.stop_mask`; round without it. What the housing cuts off
        (a cat's eye) follows from the lens.
    wavelengths : int
        How many are traced for each light.
    blend : {"blended", "flat"}
        Whether bands between the traced wavelengths are drawn, so that dispersion is a smooth spectrum, or
        each traced wavelength is a picture of one colour.
    band_step : float
        How far apart, in pixels, neighbouring bands of a ghost may lie.
    bands : int
        The most bands of a ghost.
    grid : int
        The most rays along each side of a ghost's grid.
    adapt : {"frame", "bounds", "paper"}
        As many rays as the picture's pixels want, over the part of the pupil that lands on it; always `grid`,
        over the part of the pupil that makes the ghost; or by the tile paper's Eq. 13, over the whole front
        of the lens.
    error : float
        With "frame", how far points between rays may lie off, pixels (`aureole.flare.pupil.sheets`).
    merge : str or Merge
        "none", "light" or "heavy", or another of `aureole.flare.primitives.MERGES`.
    method : str
        One of `aureole.flare.raster.METHODS`.
    coordinates : str
        One of `aureole.flare.raster.COORDINATES`.
    points : int, optional
        How many points stand for a light of some size; as many as lie three pixels apart on its image, at
        most 32, without it.
    gain : float
        Multiplies the picture, and nothing else: the ratio in the metadata is that of the lens.
    white : Spectrum, optional
        The light that counts as white; the lights' own where all have the same, else equal energy.
    """

    ghosts: str | Sequence[GhostPath] = "same-side"
    f_number: float | None = None
    iris: Iris | None = None
    wavelengths: int = DEFAULT_WAVELENGTHS
    blend: str = "blended"
    band_step: float = 3.0
    bands: int = 8
    grid: int = 128
    adapt: str = "frame"
    error: float = 0.25
    merge: str | primitives.Merge = "light"
    method: str = "auto"
    coordinates: str = "auto"
    points: int | None = None
    gain: float = 1.0
    white: Spectrum | None = None


@dataclass(frozen=True, eq=False)
class GhostLayer:
    """One ghost's part of the picture.

    Parameters
    ----------
    path : GhostPath
        The ghost; `path.name` is such as "2-5".
    top, left : int
        Row and column of the picture where the crop begins.
    pixels : ndarray of float32, shape (rows, columns, 3)
        XYZ of the crop; outside it the ghost is dark.
    """

    path: GhostPath
    top: int
    left: int
    pixels: Pixels


class _Source(NamedTuple):
    """A point of a light: where its rays come from, and how its power becomes colour."""

    direction: tuple[float, float, float]
    scale: float
    blend: Blend


@dataclass(frozen=True, eq=False)
class _Scene:
    """All that is known before ghosts are traced."""

    lens: Lens
    paths: tuple[GhostPath, ...]
    frame: primitives.Frame
    sources: tuple[_Source, ...]
    mask: StopMask | None
    white: Spectrum | None
    irradiance: float
    options: Options


class _Palette:
    """The table of colours that primitives point into: rows for each ghost, light and band."""

    def __init__(self) -> None:
        self._blocks: list[NDArray[np.float64]] = []
        self._count = 0

    def add(self, colours: NDArray[np.float64]) -> range:
        """Add colours, (M, 3), and return their rows."""
        self._blocks.append(colours)
        self._count += len(colours)
        return range(self._count - len(colours), self._count)

    def table(self) -> Pixels:
        """Return the whole table, shape (K, 3)."""
        return np.concatenate(self._blocks).astype(np.float32)


def render(
    lens: Lens, lights: Light | Sequence[Light], shape: tuple[int, int] = SHAPE, **options: Any
) -> Picture:
    """Return the ghosts that lights make in a lens.

    Parameters
    ----------
    lens : Lens
        The lens.
    lights : Light or sequence of Light
        In the frame or off it. A light's irradiance is what its own image would sum to; off the frame, what
        it would sum to at the frame's edge.
    shape : tuple of int
        (rows, columns) of the picture, which is as wide as the sensor.
    **options : Any
        The fields of `Options`: which ghosts, the iris, wavelengths, grid, merging, gain.

    Returns
    -------
    Picture
        (rows, columns, 3) in "xyz", each pixel the power that lands on it. Its metadata holds
        "ghost_to_image", the luminance of the ghosts in the frame, without gain, over that of the lights' own
        images, and "white_xyz".

    Raises
    ------
    refuse.Refusal
        Where an option or a word is unknown, a number out of its range, a light not in front of the lens, or
        the lens cannot be opened as far.
    """
    for stage in render_stages(lens, lights, shape, **options):
        picture = stage.result
    assert isinstance(picture, Picture)
    return picture


def render_stages(
    lens: Lens, lights: Light | Sequence[Light], shape: tuple[int, int] = SHAPE, **options: Any
) -> Iterator[Stage]:
    """Do what `render` does, telling how far it is.

    Parameters
    ----------
    lens : Lens
        The lens.
    lights : Light or sequence of Light
        As in `render`.
    shape : tuple of int
        (rows, columns) of the picture.
    **options : Any
        The fields of `Options`.

    Yields
    ------
    Stage
        The picture so far, without metadata but in the last one.

    Raises
    ------
    refuse.Refusal
        As in `render`.
    """
    scene = _scene(lens, lights, shape, _options(options))
    picture = np.zeros((*scene.frame.shape, 3), dtype=np.float32)
    batches = [scene.paths[k : k + BATCH] for k in range(0, len(scene.paths), BATCH)]
    work = [(source, batch) for batch in batches for source in scene.sources]
    waiting: list[Primitives] = []
    palette = _Palette()
    for done, (source, batch) in enumerate(work, 1):
        waiting.append(_primitives(scene, source, _traced(scene, source, batch), palette))
        if done == len(work) or sum(len(part.area) for part in waiting) > MOST_PRIMITIVES:
            picture += _drawn(scene, _joined(waiting), palette, scene.frame)
            waiting = []
        if done < len(work):
            yield Stage(done / len(work), "tracing ghosts", Picture(picture, "xyz"))
    yield Stage(1.0, "ghosts", _finished(scene, picture))


def render_layers(
    lens: Lens, lights: Light | Sequence[Light], shape: tuple[int, int] = SHAPE, **options: Any
) -> Iterator[GhostLayer]:
    """Render one ghost after the other, each on its own part of the picture.

    Parameters
    ----------
    lens : Lens
        The lens.
    lights : Light or sequence of Light
        As in `render`.
    shape : tuple of int
        (rows, columns) of the whole picture.
    **options : Any
        The fields of `Options`.

    Yields
    ------
    GhostLayer
        In the order of the ghosts; together they are the picture of `render`. One without light in the frame
        has no rows and columns.

    Raises
    ------
    refuse.Refusal
        As in `render`.
    """
    scene = _scene(lens, lights, shape, _options(options))
    # As many ghosts are traced at once as there are fewer lights.
    batch = max(BATCH // len(scene.sources), 1)
    for start in range(0, len(scene.paths), batch):
        together = scene.paths[start : start + batch]
        traced = [(source, _traced(scene, source, together)) for source in scene.sources]
        for path in together:
            palette = _Palette()
            own = [(source, [each for each in sheets if each.path is path]) for source, sheets in traced]
            parts = [_primitives(scene, source, sheets, palette) for source, sheets in own if sheets]
            yield _layer(scene, path, parts, palette)


def _options(given: dict[str, Any]) -> Options:
    known = [field.name for field in dataclasses.fields(Options)]
    for name in given:
        if name not in known:
            raise refuse.unknown_key("'render'", name, known)
    made = Options(**given)
    refuse.positive("gain", made.gain)
    refuse.positive("band_step", made.band_step)
    refuse.at_least("bands", made.bands, 1)
    refuse.at_least("grid", made.grid, 5)
    refuse.positive("error", made.error)
    refuse.one_of("adapt", made.adapt, ADAPTS)
    if made.points is not None:
        refuse.at_least("points", made.points, 1)
    primitives.checked(made.merge)
    refuse.one_of("method", made.method, raster.METHODS)
    return made


def _scene(lens: Lens, lights: Light | Sequence[Light], shape: tuple[int, int], options: Options) -> _Scene:
    """Check what was asked, choose ghosts and wavelengths, and weigh each light by its own image."""
    given = [lights] if isinstance(lights, Light) else list(lights)
    if not given:
        raise refuse.Refusal("'lights' needs one light or more, got none.")
    for source in given:
        checked(source)
    frame = primitives.frame_of(lens, shape)
    mask = None if options.iris is None else stop_mask(options.iris)
    opened = _opened(lens, options.f_number, mask)
    paths = _paths(lens, options, given)
    sources: list[_Source] = []
    ready: dict[int, Blend] = {}
    for source in given:
        key = id(source.spectrum)
        if key not in ready:
            sampling = sample_spectrum(source.spectrum, options.wavelengths, options.blend)
            ready[key] = blending.prepare_blend(opened, sampling)
        image = _image_luminance(ready[key], _in_frame(lens, source, frame.shape), mask)
        count = options.points or point_count(lens, source, frame.shape)
        for point in points_of(source, count):
            scale = point.irradiance * options.gain / image
            sources.append(_Source(point.direction, scale, ready[key]))
    white = options.white or white_of(given)
    irradiance = sum(source.irradiance for source in given)
    return _Scene(lens, paths, frame, tuple(sources), mask, white, irradiance, options)


def _opened(lens: Lens, f_number: float | None, mask: StopMask | None) -> Lens:
    """Return the lens with its stop's semi-aperture set, and as much larger as the mask reaches."""
    radius = lens.surfaces[lens.stop].semi_aperture
    if f_number is not None:
        widest = paraxial.f_number(lens)
        # A lens's stated f-number is rounded to two digits or three.
        if refuse.positive("f_number", f_number) < 0.97 * widest:
            raise refuse.Refusal(
                f"'f_number' must be at least {widest:.3g}, '{lens.name}' wide open, got {f_number:g}."
            )
        radius = paraxial.stop_radius(lens, f_number)
    reach = 1.0 if mask is None else mask.reach
    surfaces = list(lens.surfaces)
    surfaces[lens.stop] = dataclasses.replace(surfaces[lens.stop], semi_aperture=radius * reach)
    return dataclasses.replace(lens, surfaces=tuple(surfaces))


def _paths(lens: Lens, options: Options, lights: Sequence[Light]) -> tuple[GhostPath, ...]:
    if isinstance(options.ghosts, str):
        return tuple(energy.chosen(lens, options.ghosts, lights, options.f_number))
    return tuple(options.ghosts)


def _in_frame(lens: Lens, source: Light, shape: tuple[int, int]) -> tuple[float, float, float]:
    """Return the direction of a light, or of the frame's edge on the way to it."""
    x, y = place_on_picture(lens, source, shape)
    across, down = x / (0.5 * shape[1]) - 1.0, y / (0.5 * shape[0]) - 1.0
    part = 1.0 / max(1.0, abs(across), abs(down))
    dx, dy, dz = source.direction
    length = float(np.sqrt((part * dx) ** 2 + (part * dy) ** 2 + dz**2))
    return part * dx / length, part * dy / length, dz / length


def _image_luminance(blend: Blend, direction: Sequence[float], mask: StopMask | None) -> float:
    """Return the luminous power of a light's own image over its luminous irradiance, m²."""
    for towards in (direction, AXIS):
        luminous = blending.image_luminance(blend, _image_powers(blend.prepared, towards, mask))
        # In a corner that the lens leaves dark, an image on the axis counts.
        if luminous > 0.0:
            return luminous
    raise refuse.Refusal(f"'{blend.prepared.lens.name}' lets no light through to its sensor.")


def _image_powers(
    prepared: tracing.Prepared, direction: Sequence[float], mask: StopMask | None
) -> NDArray[np.float64]:
    if mask is None:
        return pupil.image_power(prepared, direction, IMAGE_SIDE)
    made = pupil.sheets(prepared, [()], direction, 2 * IMAGE_SIDE)
    if not made:
        return np.zeros(len(prepared.wavelengths))
    sheet = made[0]
    # The mask's pixel that each ray goes through.
    size = len(mask.pixels)
    places = [0.5 * (part + 1.0) * size - 0.5 for part in (sheet.stop_y, sheet.stop_x)]
    seen = ndimage.map_coordinates(mask.pixels, places, order=1, mode="constant")
    passed = np.where(sheet.reached & (sheet.level <= 1.0), sheet.weight * seen, 0.0)
    return np.asarray(passed.sum(axis=(1, 2), dtype=np.float64) * sheet.cell)


def _traced(scene: _Scene, source: _Source, paths: Sequence[GhostPath]) -> list[pupil.Sheet]:
    """Trace ghosts of one point of light; those without light in the frame have no sheet."""
    grid, fit = scene.options.grid, _fit(scene)
    return pupil.sheets(source.blend.prepared, paths, source.direction, grid, *fit)


def _primitives(
    scene: _Scene, source: _Source, traced: Sequence[pupil.Sheet], palette: _Palette
) -> Primitives:
    """Return the quads of ghosts in all bands."""
    options = scene.options
    spread = scene.frame, options.band_step, options.bands
    sheets, colours = blending.in_bands(source.blend, traced, source.direction, *spread)
    rows = [palette.add(each * source.scale) for each in colours]
    return primitives.construct(sheets, scene.frame, rows, options.merge)


def _fit(scene: _Scene) -> tuple[str, primitives.Frame | None, float]:
    """Return how grids of rays are fitted, as `pupil.sheets` takes it."""
    adapt, error = scene.options.adapt, scene.options.error
    return ("bounds", scene.frame, error) if adapt == "frame" else (adapt, None, error)


def _joined(parts: Sequence[Primitives]) -> Primitives:
    """Return primitives of several runs as one table."""
    if len(parts) == 1:
        return parts[0]
    names = [field.name for field in dataclasses.fields(Primitives)]
    return Primitives(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def _drawn(scene: _Scene, quads: Primitives, palette: _Palette, frame: primitives.Frame) -> Pixels:
    if not len(quads.area):
        return np.zeros((*frame.shape, 3), dtype=np.float32)
    options = scene.options
    iris = None if scene.mask is None else scene.mask.pixels
    return raster.rasterize(quads, palette.table(), frame, options.method, options.coordinates, iris)


def _layer(scene: _Scene, path: GhostPath, parts: Sequence[Primitives], palette: _Palette) -> GhostLayer:
    """Draw one ghost on the window that its quads touch."""
    rows, columns = scene.frame.shape
    if not sum(len(part.area) for part in parts):
        return GhostLayer(path, 0, 0, np.zeros((0, 0, 3), dtype=np.float32))
    quads = _joined(parts)
    places = quads.corners.reshape(-1, 2)
    low = np.clip(np.floor(places.min(axis=0)) - MARGIN, 0, (columns, rows)).astype(int)
    high = np.clip(np.ceil(places.max(axis=0)) + MARGIN, 0, (columns, rows)).astype(int)
    window = primitives.Frame((int(high[1] - low[1]), int(high[0] - low[0])), scene.frame.pitch)
    moved = dataclasses.replace(quads, corners=quads.corners - low.astype(np.float32))
    return GhostLayer(path, int(low[1]), int(low[0]), _drawn(scene, moved, palette, window))


def _finished(scene: _Scene, picture: Pixels) -> Picture:
    """Return the picture with what is known about it."""
    ratio = float(picture[..., 1].sum(dtype=np.float64)) / (scene.irradiance * scene.options.gain)
    metadata: dict[str, Any] = {RATIO_KEY: ratio}
    if scene.white is not None:
        metadata[WHITE_KEY] = tuple(float(part) for part in light.white(scene.white))
    return Picture(picture, "xyz", metadata)
