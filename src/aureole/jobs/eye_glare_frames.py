"""A picture as an eye sees it through time."""

import hashlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import glare, light, picture, refuse
from aureole.glare import EyeState, FlashLimiter, Flipbooks, RealTimeGlare
from aureole.jobs.eye import animation_report, description, is_shut, psf_numbers, state_report
from aureole.jobs.eye_glare import EyeGlareJob, EyeView, eye_view, ready_stages, seen
from aureole.jobs.frames import AnimationResult, Frame, Frames, FramesResult, frame_stages
from aureole.jobs.glare import picture_sums
from aureole.records import Picture, Stage

# Of flipbooks: half floats of three channels, of half the spectrum of a torus twice the picture's sides.
BYTES_PER_FLIPBOOK_PIXEL = 12
Make = Callable[[int], Iterator[Stage]]


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
    white : float, optional
        For that: the picture's value that the screen shows as its brightest white; the value that the
        automatic exposure brings there unless given.
    real_time : bool
        Whether frames come from flipbooks that are made first.
    """

    still: EyeGlareJob
    frames: Frames
    photosafe: bool = False
    white: float | None = None
    real_time: bool = False


def run_eye_glare_animation(job: EyeGlareAnimationJob) -> Iterator[Stage]:
    """Run an animation of a picture as an eye sees it.

    Parameters
    ----------
    job : EyeGlareAnimationJob
        What to do.

    Yields
    ------
    Stage
        Each frame as an `Frame` when it is ready; the last one holds an `AnimationResult`.
    """
    still, view = job.still, eye_view(job.still)
    times = job.frames.times(still.eye.time)
    limiter = _limiter(job, view) if job.photosafe else None
    if job.real_time:
        _refuse_real_time(still)
    yield Stage(0.0, "the eye's states")
    states = still.eye.viewer.states(times)
    awake = replace(still.eye.viewer, blinking=False).states(times)
    reports = [state_report(state) for state in states]
    make = _Flipbooks(still, view, states, awake) if job.real_time else _fresh(still, view, states, awake)
    words = description(view.kernel, *_more(job))
    for stage in frame_stages(job.frames, reports, words, make, limiter):
        made = stage.result
        yield Stage(0.999 * stage.fraction, stage.label, made if isinstance(made, Frame) else None)
    assert isinstance(made, FramesResult)
    report = animation_report(still.eye, job.frames, made.reports)
    report |= {"mode": still.mode, "resolution": still.resolution, "sum_before": picture_sums(still.picture)}
    if limiter is not None:
        report["frames_held_back"] = limiter.held
    if isinstance(make, _Flipbooks) and make.nbytes:
        report["flipbooks_megabytes"] = make.nbytes / 1e6
    yield Stage(1.0, "glare", AnimationResult(report, made.contact_sheet))


class _Limited:
    """Holds frames back that would flash, and counts them."""

    def __init__(self, limit: FlashLimiter) -> None:
        self._limit, self.held = limit, 0

    def __call__(self, frame: Picture) -> Picture:
        pixels = self._limit(frame.pixels)
        self.held += self._limit.share < 1
        return Picture(pixels, frame.colour_space, frame.metadata)


class _Flipbooks:
    """Makes frames from flipbooks, which are made with the first frame."""

    def __init__(
        self, job: EyeGlareJob, view: EyeView, states: list[EyeState], awake: list[EyeState]
    ) -> None:
        self._job, self._view, self._states, self._awake = job, view, states, awake
        self._renderer: RealTimeGlare | None = None
        self._books: Flipbooks | None = None

    @property
    def nbytes(self) -> int:
        """Bytes of the flipbooks, 0 where none were needed."""
        return 0 if self._books is None else self._books.nbytes

    def __call__(self, number: int) -> Iterator[Stage]:
        if self._renderer is None:
            for stage in self._made():
                yield Stage(0.99 * stage.fraction, stage.label)
        assert self._renderer is not None
        assert self._books is not None
        state, awake = self._states[number - 1], self._awake[number - 1]
        share = 1.0
        if state.lid_opening != awake.lid_opening:
            share = min(1.0, self._books.open_share(state) / self._books.open_share(awake))
        source = self._view.source
        pixels = source.pixels.copy()
        pixels[..., :3] = self._renderer(source.pixels[..., :3], state) * np.float32(share)
        out = Picture(pixels, self._job.picture.colour_space, self._job.picture.metadata)
        yield Stage(1.0, "glare", (out, {"sum_after": picture_sums(out)}))

    def _made(self) -> Iterator[Stage]:
        job, view = self._job, self._view
        shape = (view.source.pixels.shape[0], view.source.pixels.shape[1])
        space = view.kernel.colour_space
        lamp = light.illuminant(job.eye.illuminant)
        how = (shape, view.field_of_view)
        grid: dict[str, Any] = {} if job.eye.grid is None else {"size": job.eye.grid}
        patterns = glare.eye_patterns(*how, job.resolution, space, spectrum=lamp, **grid)
        for stage in glare.make_flipbooks_stages(
            job.eye.viewer.eye(),
            *how,
            resolution=job.resolution,
            colour_space=space,
            patterns=patterns,
        ):
            self._books = stage.result
            yield Stage(stage.fraction, f"flipbooks: {stage.label}")
        assert self._books is not None
        self._renderer = RealTimeGlare(
            self._books, job.mode, threshold=job.threshold, knee=job.knee, gain=job.gain
        )


def _fresh(job: EyeGlareJob, view: EyeView, states: list[EyeState], awake: list[EyeState]) -> Make:
    """Return how a frame is made from a wave of its own."""

    def make(number: int) -> Iterator[Stage]:
        state = states[number - 1]
        return seen_stages(job, view, state, dimming(state, awake[number - 1]))

    return make


def seen_stages(job: EyeGlareJob, view: EyeView, state: EyeState, share: float) -> Iterator[Stage]:
    """Make a frame; lids that are shut leave it black.

    Parameters
    ----------
    job : EyeGlareJob
        How glare is mixed in.
    view : EyeView
        The picture.
    state : EyeState
        The eye.
    share : float
        Of the light that the lids let through, 0 to 1.

    Yields
    ------
    Stage
        The last one holds the `Picture` and its plain numbers.
    """
    if is_shut(state):
        pixels = job.picture.pixels.copy()
        pixels[..., :3] = 0
        black = Picture(pixels, job.picture.colour_space, job.picture.metadata)
        yield Stage(1.0, "shut", (black, {"sum_after": [0.0, 0.0, 0.0]}))
        return
    for stage in ready_stages(job, view, state):
        made = stage.result
        yield Stage(0.9 * stage.fraction, stage.label)
    psf, ready = made
    out = seen(job, view, ready, share)
    yield Stage(1.0, "glare", (out, psf_numbers(psf) | {"sum_after": picture_sums(out)}))


def dimming(state: EyeState, awake: EyeState) -> float:
    """Return how much of the light a blink lets through; an eye that squints is used to it.

    Parameters
    ----------
    state, awake : EyeState
        The eye, and the same one without blinking.

    Returns
    -------
    float
        0 to 1.
    """
    if state.lid_opening == awake.lid_opening:
        return 1.0
    return min(1.0, glare.open_share(state) / glare.open_share(awake))


def _limiter(job: EyeGlareAnimationJob, view: EyeView) -> _Limited:
    """Return what holds frames back that would flash."""
    if job.frames.numbers is not None:
        raise refuse.Refusal("'frames' does not go with 'photosafe', which needs each frame in its order.")
    white = job.white
    if white is None:
        white = 2.0 ** -picture.auto_exposure(view.source)
    limit = FlashLimiter(job.frames.rate, refuse.positive("white", white), view.kernel.colour_space)
    return _Limited(limit)


def _refuse_real_time(job: EyeGlareJob) -> None:
    """Refuse what flipbooks cannot serve, and more of them than memory holds."""
    plain = EyeGlareJob(job.picture)
    asked = {
        "matte": job.matte is not None,
        "tint": job.tint != plain.tint,
        "patterns": job.patterns != plain.patterns,
        "stamps": job.stamps != plain.stamps,
        "kernel-size": job.kernel_size is not None,
        "combine thesis": job.eye.combine != plain.eye.combine,
        "no-tail": not job.eye.tail,
    }
    for name in (name for name, is_asked in asked.items() if is_asked):
        raise refuse.Refusal(f"'{name}' does not go with 'real-time'.")
    if job.mode == "scatter":
        raise refuse.Refusal("'mode' must be 'replace' or 'add' with 'real-time', got 'scatter'.")
    rows, columns = job.picture.pixels.shape[:2]
    count = sum(_nodes(axes) for axes in glare.FRAMES.values())
    needed = count * BYTES_PER_FLIPBOOK_PIXEL * rows * columns / (4 if job.resolution == "half" else 1)
    limit = picture.allowed_memory(job.memory)
    if needed > limit:
        raise refuse.Refusal(
            f"flipbooks for {columns} x {rows} pixels need about {needed / 1e9:.3g} GB of memory, "
            f"{limit / 1e9:.3g} GB are allowed; see --memory and --half."
        )


def _nodes(axes: Any) -> int:
    """Return how many frames a component has."""
    counts = [nodes if isinstance(nodes, int) else len(nodes) for nodes in axes.values()]
    return int(np.prod(counts))


def _more(job: EyeGlareAnimationJob) -> tuple[Any, ...]:
    """Return what frames depend on besides the eye: the picture, and how glare is mixed in."""
    still = job.still
    apart = ("picture", "eye", "matte", "memory", "kernel_size")
    mixing = {name: value for name, value in vars(still).items() if name not in apart}
    grown = (job.photosafe, job.white, job.real_time, job.frames.rate)
    return _digest(still.picture.pixels), still.matte is None or _digest(still.matte), mixing, grown


def _digest(values: NDArray[Any]) -> str:
    return hashlib.sha256(values.tobytes()).hexdigest()
