"""Pictures of a diffractive surface on an object, still or turning."""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse, surface
from aureole.jobs.frames import AnimationResult, Frame, Frames, FramesResult, digest, frame_stages
from aureole.records import Picture, Stage

ABOUT = ("turn", "tilt", "spin")
# Percentiles of the lit pixels' luminance, what their geometric mean is shown as, and the most stops for it.
# Orders may be most of a picture or a few of its pixels, and are far brighter than what is matt.
PERCENTILES, SHOWN, MOST_STOPS = (95.0, 99.9), 0.5, 40.0


@dataclass(frozen=True, eq=False)
class SurfaceRenderJob:
    """What to draw.

    Parameters
    ----------
    table : ScatterTable
        What the surface does to light.
    shape : Plane, Disc, Cylinder or Mesh
        The object.
    lamps : tuple of Lamp
        Near and distant ones.
    view : View
        From where it is seen.
    material : Material
        What it is made of besides.
    environment : Environment, optional
        Light from all around.
    environment_samples : int
        Parts that the table is cut into for it, on objects that are not flat.
    tilt, turn, spin : float
        How the object is turned, as `aureole.surface.pose_of` does, radians.
    mask : ndarray of float32, shape (rows, columns), optional
        How much of the object diffracts, over its texture coordinates.
    samples : int
        Samples a pixel along each axis.
    colour_space : str
        Of the picture.
    opening : float
        Diameter of the camera's lens, metres; 0 leaves everything sharp.
    focus : float, optional
        Metres along the line of sight at which things are sharp; the object's middle where it is left out.
    lens_samples : int
        Points of the lens through which the object is drawn.
    """

    table: surface.ScatterTable
    shape: surface.Plane | surface.Disc | surface.Cylinder | surface.Mesh
    lamps: tuple[surface.Lamp, ...]
    view: surface.View
    material: surface.Material = field(default_factory=surface.Material)
    environment: surface.Environment | None = None
    environment_samples: int = 1024
    tilt: float = 0.0
    turn: float = 0.0
    spin: float = 0.0
    mask: NDArray[np.float32] | None = None
    samples: int = 2
    colour_space: str = "rec709"
    opening: float = 0.0
    focus: float | None = None
    lens_samples: int = 64


@dataclass(frozen=True, eq=False)
class SurfaceTurnJob:
    """A turntable.

    Parameters
    ----------
    still : SurfaceRenderJob
        The first frame.
    frames : Frames
        How many, and which of them.
    about : str
        What grows from frame to frame: "turn", "tilt" or "spin".
    sweep : float
        By how much it grows over the whole, radians.
    """

    still: SurfaceRenderJob
    frames: Frames
    about: str = "turn"
    sweep: float = 2.0 * math.pi


@dataclass(frozen=True, eq=False)
class SurfaceRenderResult:
    """A picture of a surface.

    Parameters
    ----------
    picture : Picture
        Radiance, with coverage as alpha.
    report : dict
        Plain numbers.
    """

    picture: Picture
    report: dict[str, Any]


def run_surface_render(job: SurfaceRenderJob) -> Iterator[Stage]:
    """Run a rendering.

    Parameters
    ----------
    job : SurfaceRenderJob
        What to draw.

    Yields
    ------
    Stage
        The last one holds a `SurfaceRenderResult`.
    """
    check_render(job)
    yield Stage(0.0, "preparing the shader")
    prepared = _shader(job)
    drawn = None
    for stage in _drawn(job, prepared):
        drawn = stage.result
        yield Stage(0.02 + 0.97 * stage.fraction, stage.label)
    assert isinstance(drawn, Picture)
    report = render_report(job) | picture_report(drawn)
    yield Stage(1.0, "rendered", SurfaceRenderResult(drawn, report))


def run_surface_turn(job: SurfaceTurnJob) -> Iterator[Stage]:
    """Run a turntable.

    Parameters
    ----------
    job : SurfaceTurnJob
        What to draw.

    Yields
    ------
    Stage
        Each frame as a `Frame` when it is ready; the last one holds an `AnimationResult`.
    """
    check_render(job.still)
    refuse.one_of("about", job.about, ABOUT)
    count = job.frames.count()
    yield Stage(0.0, "preparing the shader")
    prepared = _shader(job.still)
    first = getattr(job.still, job.about)
    angles = [first + refuse.finite("sweep", job.sweep) * k / count for k in range(count)]
    reports = [
        {"time_s": time, f"{job.about}_deg": round(math.degrees(angle), 9)}
        for time, angle in zip(job.frames.times(0.0), angles, strict=True)
    ]

    def make(number: int) -> Iterator[Stage]:
        one = replace(job.still, **{job.about: angles[number - 1]})
        for stage in _drawn(one, prepared):
            seen = stage.result
            yield Stage(stage.fraction, stage.label)
        assert isinstance(seen, Picture)
        yield Stage(1.0, "rendered", (seen, {"coverage": picture_report(seen)["coverage"]}))

    for stage in frame_stages(job.frames, reports, description(job), make):
        made = stage.result
        yield Stage(0.999 * stage.fraction, stage.label, made if isinstance(made, Frame) else None)
    assert isinstance(made, FramesResult)
    report = render_report(job.still) | {
        "duration_s": count / job.frames.rate,
        "frames_per_second": job.frames.rate,
        "frames_made": sum(not told["kept"] for told in made.reports),
        "frames_kept": sum(told["kept"] for told in made.reports),
        "frames": made.reports,
    }
    yield Stage(1.0, "rendered", AnimationResult(report, made.contact_sheet))


def check_render(job: SurfaceRenderJob) -> None:
    """Refuse, before any work, what a rendering cannot serve.

    Parameters
    ----------
    job : SurfaceRenderJob
        Any.

    Raises
    ------
    refuse.Refusal
        Where a choice or a number does not fit.
    """
    refuse.one_of("colour-space", job.colour_space, light.SPACES)
    refuse.between("samples", refuse.at_least("samples", job.samples, 1), 1, 16)
    refuse.at_least("lens-samples", job.lens_samples, 1)
    if not job.lamps and job.environment is None:
        raise refuse.Refusal("there is no light: give 'lamp' or 'environment'.")
    if refuse.between("depth-of-field", job.opening, 0.0, 10.0) and not job.view.perspective:
        raise refuse.Refusal("'depth-of-field' needs a view in perspective; leave 'view-height' out.")
    if job.focus is not None:
        refuse.positive("focus", job.focus)


def render_report(job: SurfaceRenderJob) -> dict[str, Any]:
    """Return the plain numbers of what is drawn.

    Parameters
    ----------
    job : SurfaceRenderJob
        What is drawn.

    Returns
    -------
    dict
        Units in the names.
    """
    told: dict[str, Any] = {
        "shape": type(job.shape).__name__.lower(),
        "size": [job.view.shape[1], job.view.shape[0]],
        "samples": job.samples,
        "lamps": len(job.lamps),
    }
    if job.environment is not None:
        told["environment"] = job.environment.name
    if isinstance(job.shape, surface.Mesh):
        told["triangles"] = len(job.shape.triangles)
    told |= {f"{name}_deg": round(math.degrees(getattr(job, name)), 9) for name in ABOUT}
    if job.opening:
        told |= {"lens_opening_m": job.opening, "focus_m": _focus(job)}
    return told


def picture_report(drawn: Picture) -> dict[str, Any]:
    """Return the plain numbers of a picture of a surface.

    Parameters
    ----------
    drawn : Picture
        Radiance, with coverage as alpha.

    Returns
    -------
    dict
        "coverage": share of the picture that the object covers; "exposure_stops": for a screen.
    """
    return {
        "coverage": float(drawn.pixels[..., 3].mean(dtype=np.float64)),
        "exposure_stops": render_exposure(drawn),
    }


def render_exposure(drawn: Picture) -> float:
    """Choose an exposure that shows the orders' colours.

    Parameters
    ----------
    drawn : Picture
        Radiance.

    Returns
    -------
    float
        Stops.
    """
    luminance = light.convert(drawn, "xyz").pixels[..., 1]
    lit = luminance[luminance > 0]
    if lit.size == 0:
        return 0.0
    stops = math.log2(SHOWN) - float(np.log2(np.percentile(lit, PERCENTILES)).mean())
    return min(max(stops, -MOST_STOPS), MOST_STOPS)


def description(job: SurfaceTurnJob) -> str:
    """Say what a turntable's files hold; all that they depend on but the time is in the last word.

    Parameters
    ----------
    job : SurfaceTurnJob
        What is drawn.

    Returns
    -------
    str
        The same for the same job alone.
    """
    parts = [_plain(getattr(job.still, name)) for name in vars(job.still)]
    count = (job.frames.count(), job.frames.rate)
    return f"a diffractive surface that turns, job {digest(*parts, job.about, job.sweep, count)}"


def _shader(job: SurfaceRenderJob) -> surface.Shader:
    return surface.shader(job.table, job.material, job.mask, colour_space=job.colour_space)


def _focus(job: SurfaceRenderJob) -> float:
    """Return the distance of the plane of focus: through the object's middle where none is given."""
    away = -float(job.view.eye @ job.view.forward) if job.focus is None else job.focus
    return refuse.positive("focus", away)


def _drawn(job: SurfaceRenderJob, prepared: surface.Shader) -> Iterator[Stage]:
    """Draw a picture; the last stage holds it."""
    lens = surface.ThinLens(job.opening, _focus(job), job.lens_samples) if job.opening else None
    scene = surface.Scene(
        job.lamps,
        job.view,
        surface.pose_of(tilt=job.tilt, turn=job.turn, spin=job.spin),
        environment=job.environment,
        environment_samples=job.environment_samples,
        lens=lens,
    )
    yield from surface.render_stages(scene, prepared, job.shape, job.samples)


def _plain(value: Any) -> Any:
    """Return what tells a value from others: arrays by all of their numbers."""
    if isinstance(value, np.ndarray):
        return value.shape, hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()
    if isinstance(value, tuple | list):
        return [_plain(one) for one in value]
    if hasattr(value, "__dataclass_fields__"):
        return type(value).__name__, [_plain(getattr(value, name)) for name in vars(value)]
    return value
