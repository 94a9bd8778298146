"""A picture as an eye sees it, at a time or through time."""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import glare, light, picture, refuse
from aureole.glare import EyeComposition, EyeState
from aureole.jobs.eye import (
    EyeJob,
    animation_report,
    check_field,
    description,
    is_shut,
    psf_numbers,
    psf_stages,
    refuse_shut,
    shared_report,
    state_report,
)
from aureole.jobs.eye_frames import EyeAnimationResult, EyeFrame, Frames, FramesResult, frame_stages
from aureole.jobs.glare import in_working_space, picture_sums
from aureole.records import Picture, Stage

RESOLUTIONS = ("full", "half")
# Measured peaks, rounded up: the pupil's own grid, the kernel, and the convolution's spectra.
BYTES_PER_GRID, LARGEST_GRID = 40, 4096
BYTES_PER_KERNEL_PIXEL = 60
BYTES_PER_PIXEL = 150


@dataclass(frozen=True, eq=False)
class EyeGlareJob:
    """Which picture an eye sees, and how.

    Parameters
    ----------
    picture : Picture
        Linear; the eye's field of view spans its columns.
    eye : EyeJob
        The eye, the time, the field of view, the light; its shape, projection and colours are the
        picture's.
    mode : str
        "replace", "scatter" or "add".
    matte : ndarray, optional
        0..1, which pixels are sources.
    threshold, knee, gain : float
        Of mode "add".
    tint : tuple of float
        Of mode "add".
    resolution : str
        "full", or "half" for glare on boxes of two by two pixels.
    patterns : int
        Patterns along the picture's width, each for a source there; 1 has one for all.
    stamps : int
        How many of the brightest sources have patterns of their own.
    kernel_size : int, optional
        Side of the square kernel in pixels; as large as the picture's longer side otherwise.
    precision : str
        Of the convolution, "single" or "double".
    memory : int, optional
        Most bytes to use; three quarters of what is free otherwise.
    """

    picture: Picture
    eye: EyeJob = field(default_factory=EyeJob)
    mode: str = "replace"
    matte: NDArray[np.floating] | None = None
    threshold: float = 1.0
    knee: float = 0.5
    gain: float = 1.0
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)
    resolution: str = "full"
    patterns: int = 1
    stamps: int = 0
    kernel_size: int | None = None
    precision: str = "double"
    memory: int | None = None


@dataclass(frozen=True, eq=False)
class EyeGlareAnimationJob:
    """A picture as an eye sees it through time.

    Parameters
    ----------
    still : EyeGlareJob
        Each frame; the time of its eye is that of the first.
    frames : Frames
        How many, and which of them.
    photosafe : bool
        Whether changes from frame to frame are held below those of flashes.
    real_time : bool
        Whether frames come from flipbooks that are made first.
    """

    still: EyeGlareJob
    frames: Frames
    photosafe: bool = False
    real_time: bool = False


@dataclass(frozen=True, eq=False)
class EyeGlareResult:
    """A picture as an eye sees it, and what is worth knowing about it.

    Parameters
    ----------
    picture : Picture
        Size, windows and channels of the source.
    psf : Picture
        The eye's point spread function, for a source straight ahead.
    state : EyeState
        The eye at that time.
    report : dict
        Plain numbers.
    """

    picture: Picture
    psf: Picture
    state: EyeState
    report: dict[str, Any]


@dataclass(frozen=True, eq=False)
class _View:
    """A picture ready for the eye: in a space that has a name, its kernel's job, and its field of view."""

    source: Picture
    kernel: EyeJob
    field_of_view: float


def run_eye_glare(job: EyeGlareJob) -> Iterator[Stage]:
    """Run an eye-glare job.

    Parameters
    ----------
    job : EyeGlareJob
        What to do.

    Yields
    ------
    Stage
        The last one holds an `EyeGlareResult`.
    """
    view = _view(job)
    yield Stage(0.0, "the eye's state")
    state = job.eye.viewer.state(job.eye.time)
    refuse_shut(state)
    for stage in _ready_stages(job, view, state):
        made = stage.result
        yield Stage(0.8 * stage.fraction, stage.label)
    psf, ready = made
    yield Stage(0.8, "spreading the light")
    out = _seen(job, view, ready, 1.0)
    report = shared_report(view.kernel, state) | psf_numbers(psf)
    rows, columns = job.picture.pixels.shape[:2]
    report |= {
        "size": [columns, rows],
        "kernel_size": [view.kernel.shape[1], view.kernel.shape[0]],
        "field_of_view_deg": round(math.degrees(job.eye.field_of_view), 9),
        "mode": job.mode,
        "resolution": job.resolution,
        "sum_before": picture_sums(job.picture),
        "sum_after": picture_sums(out),
    }
    yield Stage(1.0, "glare", EyeGlareResult(out, psf, state, report))


def run_eye_glare_animation(job: EyeGlareAnimationJob) -> Iterator[Stage]:
    """Run an animation of a picture as an eye sees it.

    Parameters
    ----------
    job : EyeGlareAnimationJob
        What to do.

    Yields
    ------
    Stage
        Each frame as an `EyeFrame` when it is ready; the last one holds an `EyeAnimationResult`.
    """
    if job.photosafe or job.real_time:
        raise refuse.Refusal("'photosafe' and 'real-time' are on the way.")
    still, view = job.still, _view(job.still)
    yield Stage(0.0, "the eye's states")
    states = still.eye.viewer.states(job.frames.times(still.eye.time))
    reports = [state_report(state) for state in states]
    awake = replace(still.eye.viewer, blinking=False).states(job.frames.times(still.eye.time))

    def make(number: int) -> Iterator[Stage]:
        state = states[number - 1]
        return _frame_stages(still, view, state, _dimming(state, awake[number - 1]))

    words = description(view.kernel, *_more(job))
    for stage in frame_stages(job.frames, reports, words, make):
        made = stage.result
        yield Stage(0.999 * stage.fraction, stage.label, made if isinstance(made, EyeFrame) else None)
    assert isinstance(made, FramesResult)
    report = animation_report(still.eye, job.frames, made.reports)
    report["sum_before"] = picture_sums(still.picture)
    yield Stage(1.0, "glare", EyeAnimationResult(report, made.contact_sheet))


def _frame_stages(job: EyeGlareJob, view: _View, state: EyeState, share: float) -> Iterator[Stage]:
    """Make a frame; lids that are shut leave it black."""
    if is_shut(state):
        pixels = job.picture.pixels.copy()
        pixels[..., :3] = 0
        black = Picture(pixels, job.picture.colour_space, job.picture.metadata)
        yield Stage(1.0, "shut", (black, {"sum_after": [0.0, 0.0, 0.0]}))
        return
    for stage in _ready_stages(job, view, state):
        made = stage.result
        yield Stage(0.9 * stage.fraction, stage.label)
    psf, ready = made
    out = _seen(job, view, ready, share)
    yield Stage(1.0, "glare", (out, psf_numbers(psf) | {"sum_after": picture_sums(out)}))


def _dimming(state: EyeState, awake: EyeState) -> float:
    """Return how much of the light a blink lets through; an eye that squints is used to it."""
    if state.lid_opening == awake.lid_opening:
        return 1.0
    return min(1.0, glare.open_share(state) / glare.open_share(awake))


def _more(job: EyeGlareAnimationJob) -> tuple[Any, ...]:
    """Return what frames depend on besides the eye: the picture, and how glare is mixed in."""
    still = job.still
    mixing = {
        name: value
        for name, value in vars(still).items()
        if name not in ("picture", "eye", "matte", "memory", "kernel_size")
    }
    pixels = hashlib.sha256(still.picture.pixels.tobytes()).hexdigest()
    matte = None if still.matte is None else hashlib.sha256(still.matte.tobytes()).hexdigest()
    return pixels, matte, mixing, job.photosafe, job.real_time, job.frames.rate


def _view(job: EyeGlareJob) -> _View:
    """Refuse, before any work, what cannot be served, and make the picture ready."""
    refuse.one_of("mode", job.mode, glare.MODES)
    refuse.one_of("resolution", job.resolution, RESOLUTIONS)
    refuse.one_of("precision", job.precision, ("single", "double"))
    check_field(job.eye.field_of_view, "perspective")
    light.illuminant(job.eye.illuminant)
    source, space = in_working_space(job.picture)
    rows, columns = source.pixels.shape[:2]
    wide = columns
    header = picture.header_of(job.picture)
    if header is not None:
        if abs(header.pixel_aspect - 1) > 1e-6:
            raise refuse.Refusal(
                f"an eye's glare needs square pixels, not such of an aspect of {header.pixel_aspect:g}."
            )
        wide = header.display_window.width
    side = max(rows, columns) | 1
    if job.kernel_size is not None:
        side = refuse.at_least("kernel_size", job.kernel_size, 1)
    _refuse_memory(job, side)
    tangent = math.tan(job.eye.field_of_view / 2) / wide
    kernel = replace(
        job.eye,
        shape=(side, side),
        field_of_view=2 * math.atan(tangent * side),
        projection="perspective",
        colour_space=space,
        parts=None,
    )
    return _View(source, kernel, 2 * math.atan(tangent * columns))


def _refuse_memory(job: EyeGlareJob, side: int) -> None:
    """Refuse a kernel and a picture that would not fit, before any work."""
    rows, columns = job.picture.pixels.shape[:2]
    grid = job.eye.grid or LARGEST_GRID
    down, across = _nodes(job)
    kernels = down * across * BYTES_PER_KERNEL_PIXEL * side**2
    needed = BYTES_PER_GRID * grid**2 + kernels + BYTES_PER_PIXEL * rows * columns
    limit = picture.allowed_memory(job.memory)
    if needed > limit:
        raise refuse.Refusal(
            f"an eye's kernel of {side} x {side} on {columns} x {rows} pixels needs about "
            f"{needed / 1e9:.3g} GB of memory, {limit / 1e9:.3g} GB are allowed; see --memory, --kernel-size "
            "and --quick."
        )


def _nodes(job: EyeGlareJob) -> tuple[int, int]:
    """Return how many patterns there are down and across."""
    rows, columns = job.picture.pixels.shape[:2]
    if refuse.at_least("patterns", job.patterns, 1) == 1:
        return 1, 1
    return max(1, round(job.patterns * rows / columns)), job.patterns


def _ready_stages(job: EyeGlareJob, view: _View, state: EyeState) -> Iterator[Stage]:
    """Make the eye's patterns ready for the picture; the last stage holds the middle one, and all ready."""
    shape = (view.source.pixels.shape[0], view.source.pixels.shape[1])
    how: dict[str, Any] = {"mode": job.mode, "resolution": job.resolution, "precision": job.precision}
    nodes = _nodes(job)
    places = glare.field_places(shape, view.field_of_view, nodes) if nodes != (1, 1) else [((0, 0), (0, 0))]
    patterns: dict[tuple[float, float], Picture] = {}
    for index, (_, direction) in enumerate(places):
        for stage in psf_stages(replace(view.kernel, source=direction), state):
            psf = stage.result
            yield Stage((index + 0.9 * stage.fraction) / len(places), stage.label)
        patterns[direction] = psf
    if nodes == (1, 1):
        ready = glare.eye_prepare(psf, shape, view.field_of_view, **how)
    else:
        ready = glare.eye_field(patterns.__getitem__, shape, view.field_of_view, nodes, **how)
    if job.stamps > 0:
        yield Stage(0.95, "patterns of the brightest lights")
        ready = glare.eye_stamps(view.source, partial(_pattern_at, view, state), ready, job.stamps)
    yield Stage(1.0, "patterns", (list(patterns.values())[len(patterns) // 2], ready))


def _pattern_at(view: _View, state: EyeState, source: tuple[float, float]) -> Picture:
    psf = None
    for stage in psf_stages(replace(view.kernel, source=source), state):
        psf = stage.result
    assert isinstance(psf, Picture)
    return psf


def _seen(job: EyeGlareJob, view: _View, ready: EyeComposition, share: float) -> Picture:
    """Lay the glare over the picture; the result has the picture's own colour space again."""
    out = glare.eye_composite(
        view.source,
        ready,
        matte=job.matte,
        threshold=job.threshold,
        knee=job.knee,
        gain=job.gain,
        tint=job.tint,
        open_share=share,
    )
    return Picture(out.pixels, job.picture.colour_space, job.picture.metadata)
