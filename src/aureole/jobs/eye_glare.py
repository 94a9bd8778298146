"""A picture as an eye sees it at a time."""

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
    check_field,
    check_grid,
    psf_numbers,
    psf_stages,
    refuse_shut,
    shared_report,
)
from aureole.jobs.glare import in_working_space, picture_sums
from aureole.records import Picture, Stage

RESOLUTIONS = ("full", "half")
# Measured peaks, rounded up: the kernel, and the convolution's spectra.
BYTES_PER_PATTERN_PIXEL, BYTES_PER_PIXEL = 60, 150


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
        Side of the square kernel in pixels; it reaches from any pixel to any other otherwise.
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
class EyeView:
    """A picture ready for the eye.

    Parameters
    ----------
    source : Picture
        In a colour space that has a name.
    kernel : EyeJob
        The point spread function in its pixels.
    field_of_view : float
        Radians across its pixels' columns, which may be a part of what the eye's field spans.
    """

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
    view = eye_view(job)
    yield Stage(0.0, "the eye's state")
    state = job.eye.viewer.state(job.eye.time)
    refuse_shut(state)
    for stage in ready_stages(job, view, state):
        made = stage.result
        yield Stage(0.8 * stage.fraction, stage.label)
    psf, ready = made
    yield Stage(0.8, "spreading the light")
    out = seen(job, view, ready, 1.0)
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


def eye_view(job: EyeGlareJob) -> EyeView:
    """Refuse, before any work, what cannot be served, and make the picture ready.

    Parameters
    ----------
    job : EyeGlareJob
        Any.

    Returns
    -------
    EyeView
        The picture, its kernel's job and its field of view.

    Raises
    ------
    refuse.Refusal
        Where a choice or a number does not fit, or memory would not suffice.
    """
    refuse.one_of("mode", job.mode, glare.EYE_MODES)
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
    # A kernel that reaches from any pixel to any other has no border that could be seen.
    shape = glare.pattern_shape((rows, columns))
    if job.kernel_size is not None:
        shape = (refuse.at_least("kernel_size", job.kernel_size, 1),) * 2
    _refuse_memory(job, shape)
    tangent = math.tan(job.eye.field_of_view / 2) / wide
    kernel = replace(
        job.eye,
        shape=shape,
        field_of_view=2 * math.atan(tangent * shape[1]),
        projection="perspective",
        colour_space=space,
        parts=None,
    )
    return EyeView(source, kernel, 2 * math.atan(tangent * columns))


def _refuse_memory(job: EyeGlareJob, shape: tuple[int, int]) -> None:
    """Refuse a kernel and a picture that would not fit, before any work."""
    rows, columns = job.picture.pixels.shape[:2]
    down, across = _nodes(job)
    kernels = down * across * BYTES_PER_PATTERN_PIXEL * shape[0] * shape[1]
    needed = check_grid(job.eye.grid) + kernels + BYTES_PER_PIXEL * rows * columns
    limit = picture.allowed_memory(job.memory)
    if needed > limit:
        raise refuse.Refusal(
            f"an eye's kernel of {shape[1]} x {shape[0]} on {columns} x {rows} pixels needs about "
            f"{needed / 1e9:.3g} GB of memory, {limit / 1e9:.3g} GB are allowed; see --memory, --kernel-size "
            "and --quick."
        )


def _nodes(job: EyeGlareJob) -> tuple[int, int]:
    """Return how many patterns there are down and across."""
    rows, columns = job.picture.pixels.shape[:2]
    if refuse.at_least("patterns", job.patterns, 1) == 1:
        return 1, 1
    return max(1, round(job.patterns * rows / columns)), job.patterns


def ready_stages(job: EyeGlareJob, view: EyeView, state: EyeState) -> Iterator[Stage]:
    """Make the eye's patterns ready for the picture.

    Parameters
    ----------
    job : EyeGlareJob
        How many patterns, and how they are mixed in.
    view : EyeView
        The picture.
    state : EyeState
        The eye.

    Yields
    ------
    Stage
        The last one holds the middle pattern, and the `EyeComposition`.
    """
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


def _pattern_at(view: EyeView, state: EyeState, source: tuple[float, float]) -> Picture:
    psf = None
    for stage in psf_stages(replace(view.kernel, source=source), state):
        psf = stage.result
    assert isinstance(psf, Picture)
    return psf


def seen(job: EyeGlareJob, view: EyeView, ready: EyeComposition, share: float) -> Picture:
    """Lay the glare over the picture.

    Parameters
    ----------
    job : EyeGlareJob
        How it is mixed in.
    view : EyeView
        The picture.
    ready : EyeComposition
        The eye's patterns.
    share : float
        Of the light that the lids let through, 0 to 1.

    Returns
    -------
    Picture
        In the picture's own colour space again.
    """
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
