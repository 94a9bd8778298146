"""Limiting how often a sequence of pictures flashes.

A general flash is a pair of opposing changes of relative luminance by a tenth or more of the greatest,
where the darker picture is below 0.80; a red flash is a pair of opposing changes of R − G − B by 20/320 or
more in saturated red (R at least 0.8 of R + G + B). More than three in one second are a known danger (WCAG
2.2, success criterion 2.3.1, "three flashes or below threshold"; ITU-R BT.1702). The limiter watches the
whole picture and the cells of a coarse grid, and holds back the new picture where it would flash too
often. This lowers a risk. It is no certificate: size of the screen, distance, patterns and the viewer
count, too.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from aureole import light, refuse

FLASHES = 3  # allowed in any one second
CHANGE, DARKEST = 0.1, 0.8  # of the greatest relative luminance
RED_CHANGE, RED_SHARE = 20 / 320, 0.8
GRID = (9, 16)
# What is held back stays within so much of the change that would count.
MARGIN = 0.95
# Where the source flashes too often, the picture follows its mean over this time, seconds.
CALM = 1.0
# After that it is let go within a few times this, seconds.
RELEASE = 0.25

Reals = NDArray[np.float64]


class Swings:
    """Counts changes up and down in many series at once, frame by frame.

    Parameters
    ----------
    first : ndarray, shape (S,)
        Values of the first frame.
    change : ndarray, shape (S,)
        Smallest change that counts.
    darkest : ndarray, shape (S,)
        A change counts only where its lower end is below this.
    """

    def __init__(self, first: Reals, change: Reals, darkest: Reals) -> None:
        self._change, self._darkest = change, darkest
        self._direction = np.zeros(len(first), dtype=np.int8)
        self._low, self._high = first.copy(), first.copy()
        self._times = np.full((2 * FLASHES + 1, len(first)), -np.inf)

    def update(self, values: Reals, time: float) -> NDArray[np.bool_]:
        """Take the next frame.

        Parameters
        ----------
        values : ndarray, shape (S,)
            Its values.
        time : float
            Seconds, later than before.

        Returns
        -------
        ndarray of bool, shape (S,)
            Where it completes a change that counts.
        """
        low, high = np.minimum(self._low, values), np.maximum(self._high, values)
        rises = (self._direction <= 0) & (values - low >= self._change) & (low < self._darkest)
        falls = (self._direction >= 0) & (high - values >= self._change) & (values < self._darkest) & ~rises
        counted = rises | falls
        self._direction = np.where(rises, 1, np.where(falls, -1, self._direction)).astype(np.int8)
        # From a turn on, the next change is measured from the value reached.
        self._low = np.where(counted, values, low)
        self._high = np.where(counted, values, high)
        # While it goes on rising, only the top moves, and the other way round.
        self._low = np.where(self._direction > 0, self._high, self._low)
        self._high = np.where(self._direction < 0, self._low, self._high)
        later = np.vstack([self._times[1:], np.full(len(values), time)])
        self._times = np.where(counted, later, self._times)
        return counted

    def recent(self, time: float) -> NDArray[np.int64]:
        """Return how many changes counted in the last second, up to one more than are allowed.

        Parameters
        ----------
        time : float
            Seconds.

        Returns
        -------
        ndarray of int64, shape (S,)
            Two for a flash.
        """
        return np.asarray((self._times > time - 1 + 1e-9).sum(axis=0), dtype=np.int64)

    def bounds(self, time: float) -> tuple[Reals, Reals]:
        """Return between which values the next frame may lie.

        Parameters
        ----------
        time : float
            Seconds of the next frame.

        Returns
        -------
        low, high : ndarray, shape (S,)
            Infinite where there is room for one more change.
        """
        is_full = self.recent(time) >= 2 * FLASHES
        step, is_dark = MARGIN * self._change, self._low < self._darkest
        lowest = np.minimum(self._high - step, self._darkest)
        low = np.where(is_full & (self._direction >= 0), lowest, -np.inf)
        high = np.where(is_full & (self._direction <= 0) & is_dark, self._low + step, np.inf)
        return low, high


def flashes(values: ArrayLike, fps: float, change: float = CHANGE, darkest: float = DARKEST) -> int:
    """Return how many flashes the worst second of a sequence has.

    Parameters
    ----------
    values : array_like, shape (frames,) or (frames, places)
        Relative luminance, 1 being the greatest that the screen shows; of several places the worst counts.
    fps : float
        Frames per second.
    change : float
        Smallest change that counts; 20/320 for saturated red.
    darkest : float
        A change counts only where its darker end is below this; infinity for saturated red.

    Returns
    -------
    int
        Pairs of opposing changes.

    Raises
    ------
    refuse.Refusal
        Where the frame rate is not above zero, or a value is not a number.
    """
    refuse.positive("fps", fps)
    series = np.asarray(refuse.all_finite("values", values), dtype=np.float64)
    if not series.size:
        return 0
    series = series.reshape(len(series), -1)
    places = series.shape[1]
    swings = Swings(series[0], np.full(places, change), np.full(places, darkest))
    counted = [swings.update(frame, n / fps) for n, frame in enumerate(series)]
    totals = np.vstack([np.zeros(places, dtype=int), np.cumsum(counted, axis=0)])
    # A second ends before its first instant comes again.
    span = int(np.ceil(fps - 1e-9))
    ends = np.arange(1, len(totals))
    return int((totals[ends] - totals[np.maximum(ends - span, 0)]).max()) // 2


def flash_measures(
    pixels: NDArray[np.floating],
    white: float = 1.0,
    colour_space: str = "rec709",
    grid: tuple[int, int] = GRID,
) -> tuple[Reals, Reals]:
    """Return what flashes are counted by, of one picture.

    Parameters
    ----------
    pixels : ndarray, shape (rows, columns, 3 or 4)
        Linear colour as it is to be shown.
    white : float
        The value that the screen shows as its brightest white; what is above is shown so, too.
    colour_space : str
        Its name in `aureole.light.SPACES`.
    grid : tuple of int
        Cells (down, across); no more than there are pixels.

    Returns
    -------
    luminance, red : ndarray of float64, shape (1 + cells,)
        Mean relative luminance, and mean of R − G − B where red is saturated, of the whole picture and
        then of each cell, row by row.

    Raises
    ------
    refuse.Refusal
        Where a number or the colour space does not fit.
    """
    shown = _shown(pixels, refuse.positive("white", white))
    return _measures(shown, _weights(colour_space), _cells(shown.shape, grid))


class FlashLimiter:
    """Holds back new pictures where a sequence would flash more than three times in a second.

    Pictures go in one after another, as they are to be shown. Where nothing flashes too often they come
    out as they went in. Elsewhere a share of the new picture is mixed with the last one shown; the share
    changes smoothly over the picture, and falls to zero rather than let a fourth flash pass. It is for
    linear pictures that are already exposed for the screen.

    Parameters
    ----------
    fps : float
        Frames per second.
    white : float
        The value that the screen shows as its brightest white.
    colour_space : str
        Of the pictures.
    grid : tuple of int
        Cells (down, across) that are watched besides the whole picture.
    """

    def __init__(
        self, fps: float, white: float = 1.0, colour_space: str = "rec709", grid: tuple[int, int] = GRID
    ) -> None:
        self._fps = refuse.positive("fps", fps)
        self._white = refuse.positive("white", white)
        self._weights = _weights(colour_space)
        self._wanted = grid
        self._frame = 0
        self._last: NDArray[np.float32] | None = None
        self.share = 1.0
        """Smallest share of the last picture that was let through, 0..1."""

    def __call__(self, pixels: NDArray[np.float32]) -> NDArray[np.float32]:
        """Take the next picture, return what may be shown.

        Parameters
        ----------
        pixels : ndarray of float32, shape (rows, columns, 3 or 4)
            Linear colour; alpha stays as it is.

        Returns
        -------
        ndarray of float32, shape of `pixels`
            The picture itself where it need not be held back.

        Raises
        ------
        refuse.Refusal
            Where the size differs from that of the first picture, or a value is not a number.
        """
        shown = _shown(pixels, self._white)
        time = self._frame / self._fps
        self._frame += 1
        if self._last is None:
            self._start(shown)
            return pixels
        refuse.shape_of("pixels", shown, self._last.shape)
        measured = self._measured(shown)
        self._source.update(measured, time)
        self._calm_down(time)
        mixed, share = self._held_back(shown, measured, time)
        self.share = float(share.min())
        self._last = mixed
        self._before = measured if self.share >= 1 else self._measured(mixed)
        self._output.update(self._before, time)
        if self.share >= 1:
            return pixels
        out = pixels.copy()
        out[..., :3] = np.where(share[..., None] >= 1, pixels[..., :3], mixed * np.float32(self._white))
        return out

    def _start(self, shown: NDArray[np.float32]) -> None:
        self._cells = _cells(shown.shape, self._wanted)
        self._grid = len(self._cells[0]), len(self._cells[1])
        self._hats = [_hats(n, edges) for n, edges in zip(shown.shape[:2], self._cells, strict=True)]
        self._last = shown
        first: Reals = self._measured(shown)
        self._before = first
        half = len(first) // 2
        change = np.repeat([CHANGE, RED_CHANGE], half)
        darkest = np.repeat([DARKEST, np.inf], half)
        self._source: Swings = Swings(first, change, darkest)
        self._output: Swings = Swings(first, change, darkest)
        # Time over which each series' mean is followed; zero follows at once.
        self._calm = np.zeros(len(first))

    def _measured(self, shown: NDArray[np.float32]) -> Reals:
        return np.concatenate(_measures(shown, self._weights, self._cells))

    def _calm_down(self, time: float) -> None:
        """Follow the mean where the source flashes too often, and let go smoothly where it has ceased."""
        self._calm *= np.exp(-1 / (RELEASE * self._fps))
        self._calm[self._calm < 0.2 / self._fps] = 0
        self._calm[self._source.recent(time) > 2 * FLASHES] = CALM

    def _held_back(
        self, shown: NDArray[np.float32], measured: Reals, time: float
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the picture to show, and the share of the new picture in each of its pixels."""
        assert self._last is not None
        before = self._before
        low, high = self._output.bounds(time)
        share = self._shares(before, measured, low, high)
        for attempt in range(12):
            over_pixels = self._over_pixels(share, shown.shape)
            if over_pixels.min() >= 1:
                mixed, found = shown, measured
            else:
                mixed = self._last + over_pixels[..., None] * (shown - self._last)
                found = self._measured(mixed)
            wrong = (found < np.minimum(low, before)) | (found > np.maximum(high, before))
            if not wrong.any():
                return mixed, over_pixels
            share = np.where(wrong, share * (0.5 if attempt < 6 else 0.0), share)
        # A picture that stays as it was cannot flash.
        return self._last, np.zeros(shown.shape[:2], dtype=np.float32)

    def _shares(self, before: Reals, measured: Reals, low: Reals, high: Reals) -> Reals:
        """Return the greatest share of the new picture that keeps each series in its bounds."""
        step = measured - before
        room = np.where(step < 0, np.minimum(low - before, 0), np.maximum(high - before, 0))
        is_over = np.abs(step) > np.abs(room)
        share = np.where(is_over, np.abs(room) / np.where(is_over, np.abs(step), 1), 1.0)
        slow = -np.expm1(-1 / (np.where(self._calm > 0, self._calm, 1.0) * self._fps))
        return np.minimum(share, np.where(self._calm > 0, slow, 1.0))

    def _over_pixels(self, share: Reals, shape: tuple[int, ...]) -> NDArray[np.float32]:
        """Return each pixel's share: by straight lines between cells, and in none above the cell's own."""
        both = share.reshape(2, -1).min(axis=0)
        cells = np.minimum(both[1:].reshape(self._grid), both[0])
        if cells.min() >= 1:
            return np.ones(shape[:2], dtype=np.float32)
        least = ndimage.minimum_filter(cells, 3, mode="nearest").astype(np.float32)
        smooth = self._hats[0] @ least @ self._hats[1].T
        return np.asarray(np.where(smooth > 1 - 1e-6, 1, smooth), dtype=np.float32)


def _shown(pixels: NDArray[np.floating], white: float) -> NDArray[np.float32]:
    refuse.shape_of("pixels", pixels, (None, None, None))
    colour = refuse.all_finite("pixels", pixels[..., :3])
    return np.asarray(np.clip(colour / np.float32(white), 0, 1), dtype=np.float32)


def _weights(colour_space: str) -> NDArray[np.float32]:
    refuse.one_of("colour_space", colour_space, light.SPACES)
    return np.asarray(light.SPACES[colour_space].to_xyz[1], dtype=np.float32)


def _cells(shape: tuple[int, ...], grid: Iterable[int]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first row and column of each cell."""
    down, across = (
        np.arange(min(refuse.at_least("grid", count, 1), n)) * n // min(count, n)
        for n, count in zip(shape[:2], grid, strict=True)
    )
    return down, across


def _hats(length: int, edges: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return each cell's share of each pixel along an axis: straight lines between the cells' middles."""
    middles = (edges + np.append(edges[1:], length) - 1) / 2
    cells = np.interp(np.arange(length), middles, np.arange(len(edges)))[:, None]
    return np.asarray(np.maximum(1 - np.abs(cells - np.arange(len(edges))), 0), dtype=np.float32)


def _measures(
    shown: NDArray[np.float32],
    weights: NDArray[np.float32],
    cells: tuple[NDArray[np.int64], NDArray[np.int64]],
) -> tuple[Reals, Reals]:
    red, green, blue = (np.ascontiguousarray(shown[..., channel]) for channel in range(3))
    total = red + green + blue
    purity = np.where(red >= np.float32(RED_SHARE) * total, np.maximum(2 * red - total, 0), 0)
    luminance = weights[0] * red + weights[1] * green + weights[2] * blue
    heights, widths = (np.diff(np.append(edges, n)) for n, edges in zip(shown.shape[:2], cells, strict=True))
    areas = np.outer(heights, widths)

    def means(values: NDArray[np.floating]) -> Reals:
        rows = np.add.reduceat(values, cells[0], axis=0, dtype=np.float64)
        sums = np.add.reduceat(rows, cells[1], axis=1)
        return np.concatenate([[sums.sum() / areas.sum()], (sums / areas).ravel()])

    return means(luminance), means(purity)
