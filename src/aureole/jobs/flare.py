"""The flare job: a lens and lights in; its ghosts, the lights' starbursts and the whole picture out.

Ghosts and starburst meet here. On black the starburst holds the light's own image, so that the picture is
what the lens makes of the light; over a picture, which shows the light already, only what the stop throws
beyond the light's core is added.
"""

import dataclasses
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import diffraction, flare, glare, light, picture, refuse
from aureole.flare import filters, paraxial
from aureole.flare.ghost_paths import GhostPath
from aureole.flare.lights import white_of
from aureole.flare.prescription import Lens
from aureole.jobs.flare_lights import MOST_LIGHTS, Lamp, Scene, found_lights, lamps_of_file, light_of
from aureole.jobs.flare_ringing import cropped_stages
from aureole.jobs.flare_starburst import starburst_stages, working_f_number
from aureole.jobs.lights import shown_shape
from aureole.jobs.optics import Opening
from aureole.light.spaces import WHITE_KEY
from aureole.picture import Layers, Window
from aureole.records import Aperture, Light, Picture, Spectrum, Stage

SHAPE = (1080, 1920)
ROUND = "circle"
FILTERS: dict[str, Callable[[Picture], Picture]] = {"median": filters.median, "spectral": filters.spectral}
# Measured peak, with starbursts, and as much again for a picture that is given.
BYTES_PER_PIXEL = 80
# Which part of the time ghosts take, and ghosts and starbursts together.
GHOSTS_DONE, STARBURST_DONE = 0.75, 0.95


@dataclass(frozen=True, eq=False)
class FlareJob:
    """What flare to make.

    Parameters
    ----------
    lens : Lens
        The lens, at its position if it is a zoom.
    lamps : tuple of Lamp
        The lights.
    over : Picture, optional
        Linear; the flare is added to it, and it spans the sensor's width.
    shape : tuple of int, optional
        (rows, columns); those of the picture, or 1080 by 1920.
    find : float or str, optional
        Look for lights in the picture: pixels of more luminance belong to them; "auto" finds the luminance.
    lights : LampList, optional
        Lights of one frame, as a file has them; in pixels of the picture or of one of its proportions.
    most_lights : int
        Of those found or listed, the strongest.
    illuminant : str
        Spectrum of lights whose colour nothing says.
    light_size : float
        Of each light that was not found in the picture, radians across; 0 is a point.
    ghosts : str
        "same-side", "paper", "all", "top:20" or "90%".
    hide, only : tuple of str
        Names of ghosts by their surfaces, such as "2-5".
    f_number : float, optional
        Wide open without it.
    opening : Opening
        The iris; round unless it says another shape.
    iris : str, optional
        Iris preset for what the opening leaves out.
    ringing : float, optional
        Fresnel number of fringes along the iris's edge in every ghost.
    crop_ringing : bool
        Whether each ghost's fringes follow what the lens's rims leave of the iris, too.
    wavelengths : int, optional
        How many are traced.
    grid : int, optional
        Cells a side of the pupil's grid.
    points : int, optional
        How many points stand for each light of some size.
    merge : str
        "none", "light" or "heavy".
    filter : str, optional
        "median" or "spectral", over the ghosts.
    gain : float
        Multiplies the ghosts.
    starburst : bool
        Whether to add the lights' starbursts.
    layers : bool
        Whether each ghost is kept on its own.
    colour_space : str
        Of the result, where there is no picture to say it.
    memory : int, optional
        Most bytes to use.
    """

    lens: Lens
    lamps: tuple[Lamp, ...] = ()
    over: Picture | None = None
    shape: tuple[int, int] | None = None
    find: float | Literal["auto"] | None = None
    lights: glare.LampList | None = None
    most_lights: int = MOST_LIGHTS
    illuminant: str = "E"
    light_size: float = 0.0
    ghosts: str = "same-side"
    hide: tuple[str, ...] = ()
    only: tuple[str, ...] = ()
    f_number: float | None = None
    opening: Opening = field(default_factory=Opening)
    iris: str | None = None
    ringing: float | None = None
    crop_ringing: bool = False
    wavelengths: int | None = None
    grid: int | None = None
    points: int | None = None
    merge: str = "light"
    filter: str | None = None
    gain: float = 1.0
    starburst: bool = False
    layers: bool = False
    colour_space: str = "rec709"
    memory: int | None = None


@dataclass(frozen=True, eq=False)
class FlareResult:
    """A flare and what is worth knowing about it.

    Parameters
    ----------
    picture : Picture
        Everything together: with the picture that was given, its size, windows and channels.
    ghosts : Picture
        The ghosts alone, with their gain.
    starburst : Picture, optional
        The starbursts alone, where they were asked for.
    layers : Layers, optional
        Each ghost ("ghost_2_5"), "ghosts" and "starburst", where they were asked for.
    over : Picture, optional
        The picture that was given.
    notes : tuple of str
        What a person should know.
    report : dict
        Plain numbers with units in their names.
    """

    picture: Picture
    ghosts: Picture
    starburst: Picture | None
    layers: Layers | None
    over: Picture | None
    notes: tuple[str, ...]
    report: dict[str, Any]


@dataclass(frozen=True, eq=False)
class _Setup:
    """What follows from a job before any ray is traced.

    `scene` is what the lens sees, `window` where the picture lies in it, `space` the picture's own.
    """

    scene: Scene
    window: Window
    space: str
    white: Spectrum | None
    lights: tuple[Light, ...]
    paths: tuple[GhostPath, ...]
    iris: Aperture | None


def run_flare(job: FlareJob) -> Iterator[Stage]:
    """Run a flare job.

    Parameters
    ----------
    job : FlareJob
        What to make.

    Yields
    ------
    Stage
        The last one holds a `FlareResult`.
    """
    setup = _set_up(job)
    yield Stage(0.0, "ranking the ghosts")
    ranked = tuple(flare.ranked(setup.scene.lens, setup.paths, setup.lights, job.f_number))
    layers = Layers((setup.window.height, setup.window.width)) if job.layers else None
    ghosts = None
    for stage in _ghost_stages(job, setup, layers):
        ghosts = stage.result
        yield Stage(0.05 + (GHOSTS_DONE - 0.05) * stage.fraction, stage.label)
    assert isinstance(ghosts, Picture)
    burst = None
    if job.starburst:
        for stage in _starburst_stages(job, setup):
            burst = stage.result
            yield Stage(GHOSTS_DONE + (STARBURST_DONE - GHOSTS_DONE) * stage.fraction, stage.label)
    yield Stage(STARBURST_DONE, "adding them up")
    if layers is not None:
        layers.add("ghosts", ghosts.pixels)
        if burst is not None:
            layers.add("starburst", burst.pixels)
    whole = _with_attributes(_added(job, ghosts, burst), job, ranked)
    report = _report(job, setup, ranked)
    notes = _notes(job, ghosts)
    yield Stage(1.0, "flare", FlareResult(whole, ghosts, burst, layers, job.over, notes, report))


def layer_name(path: GhostPath) -> str:
    """Return what a ghost's layer is called in a file.

    Parameters
    ----------
    path : GhostPath
        The ghost.

    Returns
    -------
    str
        "ghost_2_5" for the ghost 2-5, which every program keeps as it is.
    """
    return "ghost_" + path.name.replace("-", "_")


def refuse_words(job: FlareJob) -> None:
    """Refuse words of a job that mean nothing, or do not go together.

    Parameters
    ----------
    job : FlareJob
        Any.

    Raises
    ------
    refuse.Refusal
        Where its gain is no number, or its filter is unknown or does not go with layers.
    """
    refuse.finite("gain", job.gain)
    if job.filter is not None:
        refuse.one_of("filter", job.filter, FILTERS)
        if job.filter == "median" and job.layers:
            raise refuse.Refusal("filter 'median' does not go with 'layers', whose sum it would not keep.")
    if job.crop_ringing and (job.ringing is None or job.layers):
        raise refuse.Refusal("'crop-ringing' needs 'ringing', and does not go with 'layers'.")


def _set_up(job: FlareJob) -> _Setup:
    refuse_words(job)
    if job.colour_space != "rec709" and job.over is not None:
        raise refuse.Refusal("'colour-space' does not go with 'over': the flare takes the picture's own.")
    lens, shape, window, shown = _frame(job)
    _refuse_memory(job, shape)
    space = _space(job)
    over = None if job.over is None else Picture(job.over.pixels, space, job.over.metadata)
    corner = window.y, window.x
    scene = Scene(lens, shape, shown, corner, over, light.illuminant(job.illuminant), job.light_size)
    lights = [light_of(lamp, scene) for lamp in (*job.lamps, *_listed(job, scene))]
    if job.find is not None:
        lights += found_lights(scene, None if job.find == "auto" else job.find, job.most_lights)
    if not lights:
        raise refuse.Refusal("'light' is missing: say where one stands, such as --light 8deg,3deg.")
    paths = flare.chosen(lens, job.ghosts, lights, job.f_number)
    # What one asks to see alone may be any ghost of the lens.
    paths = [flare.path_named(lens, name) for name in job.only] or paths
    paths = flare.without(paths, job.hide)
    if not paths:
        raise refuse.Refusal("no ghost is left to be drawn; see --ghosts, --only and --hide.")
    return _Setup(scene, window, space, _white(lights), tuple(lights), tuple(paths), _iris(job, lens))


def _listed(job: FlareJob, scene: Scene) -> list[Lamp]:
    """Return the strongest lights of a list."""
    if job.lights is None:
        return []
    shape = job.shape or SHAPE if job.over is None else shown_shape(job.over)
    space = scene.over.colour_space if scene.over is not None else job.colour_space
    return lamps_of_file(job.lights.scaled_to(shape), space)[: job.most_lights]


def _frame(job: FlareJob) -> tuple[Lens, tuple[int, int], Window, tuple[int, int]]:
    """Return the lens, the pixels that it is to fill, where the picture lies in them, and its shown part.

    The display window spans the sensor's width. Where a picture has pixels beyond it, the sensor is taken as
    so much larger, about the same centre.
    """
    if job.over is None:
        shape = job.shape or SHAPE
        refuse.at_least("size", min(shape), 1)
        return job.lens, shape, Window(0, 0, shape[1], shape[0]), (0, 0)
    if job.shape is not None:
        raise refuse.Refusal("'size' does not go with 'over': the flare has the picture's size.")
    rows, columns = job.over.pixels.shape[:2]
    header = picture.header_of(job.over)
    if header is None or header.shape != (rows, columns):
        return job.lens, (rows, columns), Window(0, 0, columns, rows), (0, 0)
    data, shown = header.data_window, header.display_window
    width, left = _covering(data.x, data.width, shown.x, shown.width)
    height, top = _covering(data.y, data.height, shown.y, shown.height)
    sensor = job.lens.sensor[0] * width / shown.width, job.lens.sensor[1] * height / shown.height
    lens = dataclasses.replace(job.lens, sensor=sensor)
    beyond = (height - shown.height) // 2, (width - shown.width) // 2
    return lens, (height, width), Window(left, top, columns, rows), beyond


def _refuse_memory(job: FlareJob, shape: tuple[int, int]) -> None:
    """Refuse a picture that would not fit, before any work."""
    needed, limit = BYTES_PER_PIXEL * shape[0] * shape[1], picture.allowed_memory(job.memory)
    if needed > limit:
        raise refuse.Refusal(
            f"a flare of {shape[1]} x {shape[0]} pixels needs about {needed / 1e9:.3g} GB of memory, "
            f"{limit / 1e9:.3g} GB are allowed; see --memory and --size."
        )


def _covering(first: int, count: int, shown_first: int, shown: int) -> tuple[int, int]:
    """Return how many pixels about the shown ones' centre cover all, and where the first of them lies."""
    before, behind = shown_first - first, first + count - shown_first - shown
    beyond = max(before, behind, 0)
    return shown + 2 * beyond, beyond - before


def _space(job: FlareJob) -> str:
    if job.over is None:
        return refuse.one_of("colour-space", job.colour_space, light.SPACES)
    # Primaries that have no name of ours are taken as the working space's own.
    return job.over.colour_space if job.over.colour_space in light.SPACES else "rec709"


def _white(lights: Sequence[Light]) -> Spectrum | None:
    """Return what counts as white; None for equal energy, as for a line, which is far from any white."""
    white = white_of(lights)
    return white if white is None or white.kind == "power" else None


def _iris(job: FlareJob, lens: Lens) -> Aperture | None:
    """Return the iris at its size in the entrance pupil; None is round, its edge exact."""
    if job.opening.width is not None or job.opening.height is not None:
        raise refuse.Refusal("'width' and 'height' do not go with a lens; --f-number sets the iris's size.")
    if job.opening == Opening() and job.iris is None:
        return None
    length = abs(paraxial.focal_length(lens))
    diameter = length / working_f_number(lens, job.f_number, "y")
    return job.opening.build(job.iris or ROUND, diameter, length)


def _added(job: FlareJob, ghosts: Picture, burst: Picture | None) -> Picture:
    """Lay the flare over the picture, or on black."""
    light_added = ghosts.pixels if burst is None else ghosts.pixels + burst.pixels
    if job.over is None:
        return Picture(light_added, ghosts.colour_space)
    pixels = job.over.pixels.astype(np.float32, copy=True)
    pixels[..., :3] += light_added
    return Picture(pixels, job.over.colour_space, job.over.metadata)


def _ghost_stages(job: FlareJob, setup: _Setup, layers: Layers | None) -> Iterator[Stage]:
    """Draw the ghosts, each into its layer where there are layers; the last stage holds their sum."""
    scene, how = setup.scene, _options(job, setup)
    if layers is None:
        drawn = flare.render_stages(scene.lens, setup.lights, scene.shape, **how)
        if job.crop_ringing:
            drawn = _cropped_stages(job, setup, how)
        for stage in drawn:
            found = stage.result
            yield Stage(0.98 * stage.fraction, stage.label)
        filtered = found if job.filter is None else FILTERS[job.filter](found)
        yield Stage(1.0, "ghosts", _seen(filtered.pixels, setup))
        return
    total = np.zeros((*layers.shape, 3))
    for k, layer in enumerate(flare.render_layers(scene.lens, setup.lights, scene.shape, **how), 1):
        name = layer.path.name
        crop = _filtered_layer(job, layer, scene.shape) if job.filter else layer
        pixels, window = _cut(_in_space(crop.pixels, setup), crop.top, crop.left, setup.window)
        layers.add(layer_name(layer.path), pixels, window)
        total[window.y : window.y + window.height, window.x : window.x + window.width] += pixels
        yield Stage(0.99 * k / len(setup.paths), f"ghost {name}")
    yield Stage(1.0, "ghosts", Picture(total.astype(np.float32), setup.space))


def _cropped_stages(job: FlareJob, setup: _Setup, how: dict[str, Any]) -> Iterator[Stage]:
    """Draw each ghost with the ringing of its own crop; the last stage holds their sum."""
    scene, iris = setup.scene, setup.iris or apertures.circle(1.0)
    assert job.ringing is not None
    rest = {name: value for name, value in how.items() if name not in ("ghosts", "iris")}
    shape, paths = scene.shape, setup.paths
    return cropped_stages(scene.lens, setup.lights, paths, shape, iris, job.ringing, **rest)


def _options(job: FlareJob, setup: _Setup) -> dict[str, Any]:
    """Return how the ghosts are drawn, by the names of `aureole.flare.render`."""
    iris: Aperture | diffraction.RingingTexture | None = setup.iris
    if job.ringing is not None and not job.crop_ringing:
        iris = diffraction.ringing_texture(setup.iris or apertures.circle(1.0), job.ringing)
    how: dict[str, Any] = {"ghosts": setup.paths, "f_number": job.f_number, "iris": iris, "merge": job.merge}
    how |= {"gain": job.gain, "white": setup.white, "wavelengths": job.wavelengths, "grid": job.grid}
    how["points"] = job.points
    return {name: value for name, value in how.items() if value is not None}


def _starburst_stages(job: FlareJob, setup: _Setup) -> Iterator[Stage]:
    """Lay down the starbursts; the last stage holds them in the picture's space."""
    scene, iris = setup.scene, setup.iris or apertures.circle(1.0)
    on_black = job.over is None
    for stage in starburst_stages(scene.lens, setup.lights, scene.shape, iris, job.f_number, on_black):
        found = stage.result
        yield Stage(0.98 * stage.fraction, stage.label)
    yield Stage(1.0, "starbursts", _seen(found, setup))


def _filtered_layer(job: FlareJob, layer: flare.GhostLayer, shape: tuple[int, int]) -> flare.GhostLayer:
    """Filter a ghost where it lies in the whole view."""
    assert job.filter is not None
    whole = np.zeros((*shape, 3), np.float32)
    rows, columns = layer.pixels.shape[:2]
    whole[layer.top : layer.top + rows, layer.left : layer.left + columns] = layer.pixels
    pixels = FILTERS[job.filter](Picture(whole, "xyz")).pixels
    return dataclasses.replace(layer, top=0, left=0, pixels=pixels)


def _in_space(xyz: NDArray[np.float32], setup: _Setup) -> NDArray[np.float32]:
    """Convert XYZ, in which the lights' white is white, to the picture's space."""
    known = {} if setup.white is None else {WHITE_KEY: tuple(map(float, light.white(setup.white)))}
    return light.convert(Picture(xyz, "xyz", known), setup.space).pixels


def _seen(xyz: NDArray[np.float32], setup: _Setup) -> Picture:
    """Return what of the lens's view the picture shows."""
    pixels, _ = _cut(xyz, 0, 0, setup.window)
    return Picture(_in_space(pixels, setup), setup.space)


def _cut(
    pixels: NDArray[np.float32], top: int, left: int, window: Window
) -> tuple[NDArray[np.float32], Window]:
    """Cut a crop of the lens's view to the picture, and say where it lies in it."""
    rows, columns = pixels.shape[:2]
    first_row, last_row = max(top, window.y), min(top + rows, window.y + window.height)
    first, last = max(left, window.x), min(left + columns, window.x + window.width)
    if first_row >= last_row or first >= last:
        return np.zeros((0, 0, 3), np.float32), Window(0, 0, 0, 0)
    part = pixels[first_row - top : last_row - top, first - left : last - left]
    place = Window(first - window.x, first_row - window.y, last - first, last_row - first_row)
    return np.ascontiguousarray(part), place


def _with_attributes(whole: Picture, job: FlareJob, ranked: tuple[GhostPath, ...]) -> Picture:
    """Say in the file what the flare is of."""
    said: dict[str, str | float | int] = {
        "lens": job.lens.name,
        "ghosts": len(ranked),
        "ghost_to_image": sum(path.energy or 0.0 for path in ranked),
        "gain": float(job.gain),
    }
    if job.f_number is not None:
        said["f_number"] = float(job.f_number)
    return picture.with_attributes(whole, picture.attributes_of(said))


def _notes(job: FlareJob, ghosts: Picture) -> tuple[str, ...]:
    notes = [] if ghosts.pixels.any() else ["no ghost falls on the picture"]
    listed = 0 if job.lights is None else len(job.lights.sightings)
    if listed > job.most_lights:
        notes.append(f"of {listed} lights the {job.most_lights} strongest are taken; see --most-lights")
    return tuple(notes)


def _report(job: FlareJob, setup: _Setup, ranked: tuple[GhostPath, ...]) -> dict[str, Any]:
    lens = job.lens
    return {
        "lens": lens.name,
        "title": lens.title,
        "focal_length_m": paraxial.focal_length(lens),
        "f_number": working_f_number(lens, job.f_number, "y"),
        "size": [setup.window.width, setup.window.height],
        "ghosts": len(ranked),
        "ghost_to_image": sum(path.energy or 0.0 for path in ranked),
        "gain": float(job.gain),
        "lights": [_light_report(source, setup) for source in setup.lights],
        "energies": {path.name: path.energy for path in ranked},
    }


def _light_report(source: Light, setup: _Setup) -> dict[str, Any]:
    x, y, z = source.direction
    place_x, place_y = flare.place_on_picture(setup.scene.lens, source, setup.scene.shape)
    return {
        "angles_deg": [math.degrees(math.atan(x / z)), math.degrees(math.atan(y / z))],
        "place_pixels": [place_x - setup.scene.shown[1], place_y - setup.scene.shown[0]],
        "strength": source.irradiance,
        "size_deg": math.degrees(source.angular_size),
        "spectrum": source.spectrum.name,
    }
