"""An eye's glare on a picture, many times a second.

    out = d (L − a w L + K ⊗ (w L)),   w = cos³θ

L is the picture, w the solid angle of its pixels, K the state's pattern without its middle, a what K takes
from a pixel (all that it spreads, or what of that lands on the frame), d what the lids let through. K comes
from flipbooks, or from a wave computed afresh for each picture: `RealTimeGlare` takes either.
"""

from collections.abc import Callable, Iterator
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse
from aureole.glare import _kernels_real_time
from aureole.glare.eye import EyeState
from aureole.glare.eye_composite import BORDERS, solid_angle_weights
from aureole.glare.flipbook import Flipbooks
from aureole.glare.fresh_glare import FreshGlare
from aureole.glare.glare_frames import border_nodes
from aureole.picture import MixedConvolver
from aureole.picture.torus import share, thread_count

MODES = ("replace", "add")
Pixels = NDArray[np.float32]
GlareSource = Flipbooks | FreshGlare


class RealTimeGlare:
    """Lay a moving eye's glare over pictures of one size; buffers are kept from picture to picture.

    They serve one picture at a time.

    Parameters
    ----------
    source : Flipbooks or FreshGlare
        Where the patterns come from.
    mode : str
        "replace": light is moved to where the eye scatters it, and the frame's sum is kept. "add": light
        above a soft knee is spread and added.
    border : str
        For "replace": "keep", what would leave the frame stays in its own pixel; "lose".
    threshold, knee : float
        For "add": luminance above which light is spread, and how softly that sets in (0 is sharp, 1
        starts at zero). All channels are scaled together, so hue stays.
    gain : float
        For "add": multiplies what is added.
    dimming : bool
        Whether the lids dim the picture as they close.
    threads : int, optional
        How many to use; by default one for each processor that this process may use.

    Raises
    ------
    refuse.Refusal
        Where a word is unknown or a number is out of range.
    """

    def __init__(
        self,
        source: GlareSource,
        mode: str = "replace",
        border: str = "keep",
        threshold: float = 1.0,
        knee: float = 0.5,
        gain: float = 1.0,
        dimming: bool = False,
        threads: int | None = None,
    ) -> None:
        frames = source.frames
        self.source, self.dimming = source, dimming
        self.mode, self.border = refuse.one_of("mode", mode, MODES), refuse.one_of("border", border, BORDERS)
        self.gain = refuse.finite("gain", gain)
        self._knee = _knee(threshold, knee)
        self._luminance = light.SPACES[source.colour_space].to_xyz[1].astype(np.float32)
        self._threads = thread_count(threads)
        self._weights = solid_angle_weights(frames.shape, frames.field_of_view)
        self._convolve = MixedConvolver(frames.kernels, self._threads)
        rows, columns = frames.shape
        low_rows, low_columns = frames.kernels.shape
        self._is_half = frames.resolution == "half"
        self._lit = np.empty((rows, 3 * columns), dtype=np.float32)
        self._low = np.empty((low_rows, 3 * low_columns), dtype=np.float32) if self._is_half else self._lit
        self._glare = np.empty((low_rows, 3 * low_columns), dtype=np.float32)
        wide = (low_rows, 3 * columns)
        self._wide = np.empty(wide, dtype=np.float32) if self._is_half else self._glare
        self._tasks = [*range(0, rows, -(-rows // (4 * self._threads))), rows]
        self._sums = np.empty((len(self._tasks) - 1, 2, 3 * columns), dtype=np.float32)
        step = 2 if self._is_half else 1
        self._down, self._along = _between_nodes(rows, step), _between_nodes(columns, step)

    def __call__(self, pixels: Pixels, state: EyeState, out: Pixels | None = None) -> Pixels:
        """Return a picture as the eye sees it in a state.

        Parameters
        ----------
        pixels : ndarray of float32, shape (rows, columns, 3)
            Linear colour in the patterns' colour space, of the size that was prepared for.
        state : EyeState
            The eye now.
        out : ndarray of float32, shape of `pixels`, optional
            Where the result shall lie.

        Returns
        -------
        ndarray of float32, shape of `pixels`
            With glare.

        Raises
        ------
        refuse.Refusal
            Where the picture has another shape, or holds NaN or infinity.
        """
        result = np.empty((*self.source.frames.shape, 3), dtype=np.float32) if out is None else out
        for _ in self._steps(pixels, state, result):
            pass
        return result

    def step_seconds(self, pixels: Pixels, state: EyeState) -> dict[str, float]:
        """Time the steps of one picture.

        Parameters
        ----------
        pixels : ndarray of float32, shape (rows, columns, 3)
            As for a call.
        state : EyeState
            The eye now.

        Returns
        -------
        dict of str to float
            Seconds, by step, in order.
        """
        out = np.empty((*self.source.frames.shape, 3), dtype=np.float32)
        seconds, start = {}, perf_counter()
        for name in self._steps(pixels, state, out):
            now = perf_counter()
            seconds[name], start = now - start, now
        return seconds

    def _steps(self, pixels: Pixels, state: EyeState, out: Pixels) -> Iterator[str]:
        """Do all steps for one picture; yield the name of each when it is done."""
        given = refuse.all_finite("pixels", refuse.shape_of("pixels", pixels, out.shape))
        picture = np.ascontiguousarray(given, dtype=np.float32).reshape(self._lit.shape)
        mix = self.source.mix(state)
        yield "choosing frames"
        self._light_up(picture)
        yield "weighing light"
        low = (*self.source.frames.kernels.shape, 3)
        lowest = 0.0 if float(self._low.min()) >= 0 else -np.inf
        yield from self._convolve.steps(self._low.reshape(low), mix, self._glare.reshape(low), lowest)
        if self._is_half:
            self._share_rows(
                lambda _, first, last: _kernels_real_time.widen(
                    self._glare, (first + 1) // 2, (last + 1) // 2, self._wide
                )
            )
        less, more = (np.tile(factors, out.shape[1]) for factors in self._take(mix))
        dimming = np.float32(self.source.open_share(state) if self.dimming else 1)
        rows = out.reshape(picture.shape)
        self._share_rows(
            lambda _, first, last: _kernels_real_time.lay(
                picture, self._lit, self._wide, less, more, dimming, first, last, rows
            )
        )
        yield "laying over"

    def _light_up(self, picture: Pixels) -> None:
        """Find the light that makes glare, on the patterns' pixels."""
        low, high = self._knee

        def weigh(task: int, first: int, last: int) -> None:
            if self.mode == "replace":
                _kernels_real_time.weigh(picture, self._weights, first, last, self._lit)
            else:
                _kernels_real_time.weigh_above(
                    picture, self._weights, self._luminance, low, high, first, last, self._lit
                )

        self._share_rows(weigh)
        if self._is_half:
            self._share_rows(
                lambda _, first, last: _kernels_real_time.boxes(
                    self._lit, (first + 1) // 2, (last + 1) // 2, self._low
                )
            )

    def _take(self, mix: list[tuple[int, float]]) -> tuple[Pixels, Pixels]:
        """Work out what is taken from each pixel; return each channel's factors on that and on the glare."""
        if self.mode == "add":
            return np.zeros(3, dtype=np.float32), np.full(3, self.gain, dtype=np.float32)
        shares, (down, after) = self._shares(mix), self._down
        self._share_rows(
            lambda task, first, last: _kernels_real_time.take(
                self._lit, shares, down, after, self._wide, first, last, self._sums[task]
            )
        )
        as_is = np.ones(3, dtype=np.float32)
        if self.border == "lose":
            return as_is, as_is
        taken, found = self._sums.sum(axis=0, dtype=np.float64).reshape(2, -1, 3).sum(axis=1)
        # What straight lines between nodes, half boxes and rounding leave over is taken back as a whole.
        is_close = (taken != 0) & (np.abs(found - taken) < 0.6 * np.abs(taken))
        return np.where(is_close, found / np.where(is_close, taken, 1), 1).astype(np.float32), as_is

    def _shares(self, mix: list[tuple[int, float]]) -> Pixels:
        """Return the share that is taken from each column's light, at the nodes down the rows."""
        frames = self.source.frames
        if self.border == "lose":
            spread = sum(weight * frames.kernels.sums[place] for place, weight in mix)
            nodes = np.broadcast_to(np.asarray(spread, dtype=np.float32), frames.arriving.shape[1:]).copy()
        else:
            total: Any = sum(np.float32(weight) * frames.arriving[place] for place, weight in mix)
            nodes = np.asarray(total, dtype=np.float32)
        shares = np.empty((len(nodes), self._lit.shape[1]), dtype=np.float32)
        _kernels_real_time.spread_nodes(nodes, *self._along, shares)
        return shares

    def _share_rows(self, task: Callable[[int, int, int], None]) -> None:
        """Do a task for each block of rows."""
        ends = self._tasks
        share(lambda k: task(k, ends[k], ends[k + 1]), range(len(ends) - 1), self._threads)


def _knee(threshold: float, knee: float) -> tuple[np.float32, np.float32]:
    """Return where the soft knee starts and where the straight line follows."""
    refuse.between("knee", knee, 0, 1)
    if not refuse.finite("threshold", threshold) >= 0:
        raise refuse.Refusal(f"'threshold' must be a number >= 0, got {threshold:g}.")
    return np.float32(threshold * (1 - knee)), np.float32(threshold * (1 + knee))


def _between_nodes(length: int, step: int) -> tuple[NDArray[np.int64], Pixels]:
    """Return for each pixel the node before it, and how far it is on the way to the next."""
    places = border_nodes(-(-length // step)).astype(np.float64)
    at = (np.arange(length) + 0.5) / step - 0.5
    before = np.clip(np.searchsorted(places, at, side="right") - 1, 0, len(places) - 2)
    apart = np.maximum(places[before + 1] - places[before], 1)
    return before, np.clip((at - places[before]) / apart, 0, 1).astype(np.float32)
