"""The eye's jobs: what a point of light looks like to an eye at a time, or at many."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from aureole import glare, light, picture, refuse
from aureole.glare import EyeState
from aureole.jobs.frames import AnimationResult, Frame, Frames, FramesResult, digest, frame_stages
from aureole.jobs.viewer import Viewer
from aureole.records import Picture, Stage

PROJECTIONS = ("angle", "perspective")
COMBINATIONS = ("coherent", "thesis")
# Samples on each side of the pupil's plane for a quick look; the whole computation chooses its own.
QUICK_GRID = 1024
WIDEST = {"angle": math.pi, "perspective": math.radians(179)}
# Samples on each side of the pupil's plane, of which there is an even number.
LEAST_GRID, MOST_GRID = 64, 16384
# Measured peaks, rounded up: the pupil's own grid, that large at most unless asked for, and the kernel.
BYTES_PER_SAMPLE, LARGEST_GRID, BYTES_PER_PIXEL = 40, 4096, 60
# Less light than this part of an open eye's passes lids that are shut.
SHUT = 1e-3


@dataclass(frozen=True)
class EyeJob:
    """What point spread function of an eye to make.

    Parameters
    ----------
    viewer : Viewer
        The eye, and the light that it is adapted to.
    time : float
        Seconds.
    shape : tuple of int
        (rows, columns).
    field_of_view : float
        Radians across the columns.
    illuminant : str
        The light's spectrum, as `aureole.light.illuminant` reads it.
    colour_space : str
        Primaries of the result.
    combine : str
        "coherent", or "thesis" for the sum of the parts' own patterns.
    tail : bool
        Whether CIE 135 goes on where wave optics ends.
    projection : str
        "angle" (as many degrees in each pixel) or "perspective" (as in a picture).
    source : tuple of float
        Angles of the light to the right and downward in radians, which move the lashes' shadow.
    grid : int, optional
        Samples on each side of the pupil's plane; chosen by the pupil and the field otherwise.
    wavelengths : int
        How many are summed.
    parts : int, optional
        Side in pixels of a front view of the eye's parts, where that is wanted, too.
    """

    viewer: Viewer = field(default_factory=Viewer)
    time: float = 0.0
    shape: tuple[int, int] = (512, 512)
    field_of_view: float = math.radians(60)
    illuminant: str = "E"
    colour_space: str = "rec709"
    combine: str = "coherent"
    tail: bool = True
    projection: str = "angle"
    source: tuple[float, float] = (0.0, 0.0)
    grid: int | None = None
    wavelengths: int = 32
    parts: int | None = None


@dataclass(frozen=True)
class EyeAnimationJob:
    """What point spread functions to make through time.

    Parameters
    ----------
    still : EyeJob
        Each of them; its time is that of the first.
    frames : Frames
        How many, and which of them.
    """

    still: EyeJob
    frames: Frames


@dataclass(frozen=True, eq=False)
class EyeResult:
    """A point spread function of an eye, and what is worth knowing about it.

    Parameters
    ----------
    picture : Picture
        Energy per pixel.
    state : EyeState
        The eye at that time.
    report : dict
        Plain numbers.
    parts : Picture, optional
        Front view of the eye's parts.
    """

    picture: Picture
    state: EyeState
    report: dict[str, Any]
    parts: Picture | None = None


def run_eye(job: EyeJob) -> Iterator[Stage]:
    """Run an eye job.

    Parameters
    ----------
    job : EyeJob
        What to make.

    Yields
    ------
    Stage
        The last one holds an `EyeResult`.
    """
    check_eye(job)
    yield Stage(0.0, "the eye's state")
    state = job.viewer.state(job.time)
    refuse_shut(state)
    psf = None
    for stage in psf_stages(job, state):
        psf = stage.result
        yield Stage(0.9 * stage.fraction, stage.label)
    assert isinstance(psf, Picture)
    parts = None
    if job.parts is not None:
        yield Stage(0.9, "drawing the eye")
        parts = glare.eye_picture(state, refuse.at_least("parts", job.parts, 16))
    report = shared_report(job, state) | psf_numbers(psf)
    said = {name: value for name, value in report.items() if isinstance(value, str | float | int)}
    told = picture.with_attributes(psf, picture.attributes_of(said))
    yield Stage(1.0, "eye", EyeResult(told, state, report, parts))


def run_eye_animation(job: EyeAnimationJob) -> Iterator[Stage]:
    """Run an animation of the eye's point spread function.

    Parameters
    ----------
    job : EyeAnimationJob
        What to make.

    Yields
    ------
    Stage
        Each frame as an `Frame` when it is ready; the last one holds an `AnimationResult`.
    """
    check_eye(job.still)
    times = job.frames.times(job.still.time)
    yield Stage(0.0, "the eye's states")
    states = job.still.viewer.states(times)

    def make(number: int) -> Iterator[Stage]:
        return _frame_stages(job.still, states[number - 1])

    reports = [state_report(state) for state in states]
    for stage in frame_stages(job.frames, reports, description(job.still), make):
        made = stage.result
        yield Stage(0.999 * stage.fraction, stage.label, made if isinstance(made, Frame) else None)
    assert isinstance(made, FramesResult)
    report = animation_report(job.still, job.frames, made.reports)
    yield Stage(1.0, "eye", AnimationResult(report, made.contact_sheet))


def check_eye(job: EyeJob) -> None:
    """Refuse, before any work, what an eye job cannot serve.

    Parameters
    ----------
    job : EyeJob
        Any.

    Raises
    ------
    refuse.Refusal
        Where a choice or a number does not fit.
    """
    for length in job.shape:
        refuse.at_least("size", length, 1)
    refuse.one_of("projection", job.projection, PROJECTIONS)
    refuse.one_of("combine", job.combine, COMBINATIONS)
    refuse.one_of("colour-space", job.colour_space, light.SPACES)
    check_field(job.field_of_view, job.projection)
    light.illuminant(job.illuminant)
    needed = check_grid(job.grid) + BYTES_PER_PIXEL * job.shape[0] * job.shape[1]
    limit = picture.allowed_memory()
    if needed > limit:
        raise refuse.Refusal(
            f"{job.shape[1]} x {job.shape[0]} pixels of an eye's pattern need about {needed / 1e9:.3g} GB of "
            f"memory, {limit / 1e9:.3g} GB are allowed; see --size and --quick."
        )


def check_grid(grid: int | None) -> int:
    """Refuse a grid on the pupil's plane that cannot be.

    Parameters
    ----------
    grid : int, optional
        Samples on each side.

    Returns
    -------
    int
        Bytes that its transforms take.

    Raises
    ------
    refuse.Refusal
        Where it is odd, too small or too large.
    """
    if grid is not None and (grid % 2 or not LEAST_GRID <= grid <= MOST_GRID):
        raise refuse.Refusal(f"'grid' must be an even number from {LEAST_GRID} to {MOST_GRID}, got {grid}.")
    return BYTES_PER_SAMPLE * (grid or LARGEST_GRID) ** 2


def check_field(field_of_view: float, projection: str) -> float:
    """Refuse a field of view that a projection cannot show.

    Parameters
    ----------
    field_of_view : float
        Radians.
    projection : str
        "angle" or "perspective".

    Returns
    -------
    float
        The same.

    Raises
    ------
    refuse.Refusal
        Where it is not above zero and within the projection's reach.
    """
    degrees, widest = math.degrees(field_of_view), math.degrees(WIDEST[projection])
    if not 0 < degrees <= widest * (1 + 1e-12):
        raise refuse.Refusal(
            f"'field-of-view' must be above 0 and at most {widest:g} degrees in projection "
            f"'{projection}', got {degrees:g}."
        )
    return field_of_view


def psf_stages(job: EyeJob, state: EyeState) -> Iterator[Stage]:
    """Make the point spread function of a state.

    Parameters
    ----------
    job : EyeJob
        What to make; its viewer and time do not count.
    state : EyeState
        The eye.

    Yields
    ------
    Stage
        The last one holds a `Picture`.
    """
    yield from glare.eye_psf_stages(
        state,
        job.shape,
        job.field_of_view,
        spectrum=light.illuminant(job.illuminant),
        colour_space=job.colour_space,
        combine=job.combine,
        tail=job.tail,
        projection=job.projection,
        source=job.source,
        size=job.grid,
        wavelengths=job.wavelengths,
    )


def is_shut(state: EyeState) -> bool:
    """Return whether the lids let nothing through that would make a pattern.

    Parameters
    ----------
    state : EyeState
        The eye.

    Returns
    -------
    bool
        Whether less than a thousandth of the pupil's light passes.
    """
    return glare.open_share(state) < SHUT


def refuse_shut(state: EyeState) -> None:
    """Refuse an eye in the middle of a blink, which sees nothing.

    Parameters
    ----------
    state : EyeState
        The eye.

    Raises
    ------
    refuse.Refusal
        Where its lids are shut.
    """
    if is_shut(state):
        raise refuse.Refusal(
            f"the eye is shut at {state.time:.4g} s, in a blink; choose another --time, or --no-blink."
        )


def state_report(state: EyeState) -> dict[str, Any]:
    """Return the plain numbers of a state.

    Parameters
    ----------
    state : EyeState
        The eye.

    Returns
    -------
    dict
        Seconds, candela per square metre, metres and parts.
    """
    return {
        "time_s": state.time,
        "luminance_cd_per_m2": state.luminance,
        "pupil_diameter_m": state.pupil_diameter,
        "lid_opening": state.lid_opening,
        "light_let_through": glare.open_share(state),
    }


def shared_report(job: EyeJob, state: EyeState) -> dict[str, Any]:
    """Return the plain numbers of an eye and of how it is looked through.

    Parameters
    ----------
    job : EyeJob
        What was asked for.
    state : EyeState
        The eye at one time.

    Returns
    -------
    dict
        Units in the names.
    """
    return {
        "eye": state.eye.name,
        "age": state.eye.age,
        "pigment": state.eye.pigment,
        "seed": state.eye.seed,
        **state_report(state),
        "illuminant": light.illuminant(job.illuminant).name,
        "combine": job.combine,
        "projection": job.projection,
        "size": [job.shape[1], job.shape[0]],
        "field_of_view_deg": round(math.degrees(job.field_of_view), 9),
    }


def psf_numbers(psf: Picture) -> dict[str, Any]:
    """Return the plain numbers of an eye's point spread function.

    Parameters
    ----------
    psf : Picture
        As `aureole.glare.eye_psf` returns it.

    Returns
    -------
    dict
        Degrees, and energies as fractions of the whole.
    """
    rows, columns = psf.pixels.shape[:2]
    told = {
        "degrees_per_pixel": round(float(psf.metadata["degrees_per_pixel"]), 12),
        "energy_inside": float(psf.metadata["energy_inside"]),
        "energy_in_core_pixel": float(psf.pixels[rows // 2, columns // 2, :3].mean()),
    }
    if "reach" in psf.metadata:
        told["wave_optics_to_deg"] = math.degrees(psf.metadata["reach"])
    return told


def animation_report(job: EyeJob, frames: Frames, reports: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the plain numbers of an animation.

    Parameters
    ----------
    job : EyeJob
        Of each frame.
    frames : Frames
        How many.
    reports : list of dict
        The wanted frames' own.

    Returns
    -------
    dict
        What all frames share, the extremes of what changes, and "frames".
    """
    eye = job.viewer.eye()
    pupils, lids = ([told[name] for told in reports] for name in ("pupil_diameter_m", "lid_opening"))
    return {
        "eye": eye.name,
        "age": eye.age,
        "pigment": eye.pigment,
        "seed": eye.seed,
        "duration_s": frames.count() / frames.rate,
        "frames_per_second": frames.rate,
        "frames_made": sum(not told["kept"] for told in reports),
        "frames_kept": sum(told["kept"] for told in reports),
        "smallest_pupil_diameter_m": min(pupils),
        "largest_pupil_diameter_m": max(pupils),
        "smallest_lid_opening": min(lids),
        "field_of_view_deg": round(math.degrees(job.field_of_view), 9),
        "frames": reports,
    }


def description(job: EyeJob, *more: Any) -> str:
    """Say what a job's files hold; all that they depend on but the time is in the last word.

    Parameters
    ----------
    job : EyeJob
        What is made.
    *more : object
        Plain values on which the files depend, too.

    Returns
    -------
    str
        The same for the same job alone.
    """
    viewer = job.viewer
    looked = (viewer.eye(), viewer.luminance, viewer.adapting_field, viewer.binocular, viewer.blinking)
    how = replace(job, viewer=Viewer(), time=0.0, parts=None)
    return f"as an eye sees it, job {digest(looked, how, *more)}"


def _frame_stages(job: EyeJob, state: EyeState) -> Iterator[Stage]:
    """Make a frame; lids that are shut let nothing through."""
    psf = None
    if is_shut(state):
        psf = Picture(np.zeros((*job.shape, 3), np.float32), job.colour_space)
        yield Stage(1.0, "shut", (psf, {"energy_inside": 0.0}))
        return
    for stage in psf_stages(job, state):
        psf = stage.result
        yield Stage(stage.fraction, stage.label)
    assert isinstance(psf, Picture)
    yield Stage(1.0, "point spread function", (psf, psf_numbers(psf)))
