"""From a photograph of a bokeh to heights in one call: turned, one channel, sharpened, scaled, counted.

The steps are those of Toisoul and Ghosh 2017, section 5 and Appendix C; the number of lit slits is that of
section 6.1. Lines come out upright, their normal along the tangent; of lines that cross, the finer ones do.
"""

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft, ndimage

from aureole import picture, refuse
from aureole.records import Stage
from aureole.surface.bokeh import (
    BLUE,
    abbe_limit,
    abbe_note,
    bokeh_profile,
    count_lines,
    fit_heights,
    pixel_pitch,
    richardson_lucy,
)
from aureole.surface.gratings import DEFAULT_SPREAD, Grating, multislit_grating
from aureole.surface.height import HeightField, height_field
from aureole.surface.pfm import read_pfm
from aureole.surface.slits import Lines, checked_lines

Array = NDArray[np.float64]

# A bokeh is where its blurred brightness is above this share of the brightest, and it is smaller than ...
LIT, WHOLE = 0.4, 0.95
# Share of the square inside a bokeh that is used: its rim is bright and bent.
INNER = 0.95
# Places of a known grating's lines that are tried, a period.
PHASES = 128
# A direction whose profile varies less than this share of the other's has no lines.
FAINT = 0.1
# Sine of how far from a right angle lines may cross.
ASIDE = 0.1


@dataclass(frozen=True, eq=False)
class Bokeh:
    """What a photograph of a bokeh tells.

    Parameters
    ----------
    heights : HeightField
        Dark is deep; whole periods of it, row 0 uppermost, lines' normal along columns.
    angle : float
        By which the photograph was turned counter-clockwise, radians.
    period : float
        Of the lines along the tangent, metres on the surface.
    width : float
        Of their bright part, metres.
    lit : int
        Lines across the whole bokeh: the number of slits that are lit (section 6.1).
    across : float
        Period of lines along the bitangent, metres; 0 where there are none.
    scale : tuple of float
        a and b of Eq. 27: heights are a (brightness − b). For other photographs taken alike.
    error : float or None
        Root mean square of the fit to the known lines over their depth; None where none are known.
    notes : tuple of str
        What to mind.
    """

    heights: HeightField
    angle: float
    period: float
    width: float
    lit: int
    across: float
    scale: tuple[float, float]
    error: float | None
    notes: tuple[str, ...]

    def grating(self, spread: float = DEFAULT_SPREAD) -> Grating:
        """Return slits like the lines that were seen, for the analytic pattern of Eq. 16.

        Parameters
        ----------
        spread : float
            Standard deviation of h_b.

        Returns
        -------
        Grating
            Of the period, width and number that were found.
        """
        return multislit_grating(self.period, self.width, self.lit, spread, "bokeh")


@dataclass(frozen=True, eq=False)
class _Upright:
    """A square of a bokeh: brightness, how many of its pixels the bokeh's diameter is, and the turn."""

    values: Array
    diameter: float
    angle: float


def heights_from_bokeh(
    photograph: str | os.PathLike[str] | ArrayLike,
    pixel: float | None = None,
    period: float | None = None,
    depth: float | None = None,
    angle: float | None = None,
    channel: int = BLUE,
    deviation: float = 1.5,
    iterations: int = 30,
    known: Lines | None = None,
    scale: tuple[float, float] | None = None,
    lens: tuple[float, float, float] | None = None,
) -> Bokeh:
    """Turn a photograph of a bokeh into heights.

    Parameters
    ----------
    photograph : path_like or array_like, shape (rows, columns[, 3])
        EXR, HDR, PFM, PNG, TIFF or JPEG, or linear pixels: a lit disc on black, or a part of one.
    pixel : float or None
        What a pixel means on the surface, metres; None where the period is known.
    period : float or None
        Of the lines on the surface, metres; None where the pixel is known.
    depth : float or None
        From the darkest to the brightest, metres; for surfaces whose depth is known otherwise.
    angle : float or None
        Turn counter-clockwise, radians; the paper's lens wants a quarter. None finds the turn that makes
        the lines upright, the finer ones where they cross; half a turn more only a known grating tells.
    channel : int
        2 is blue, the sharpest.
    deviation : float
        Standard deviation of the blur to undo, pixels; 0 leaves it.
    iterations : int
        Of Richardson and Lucy.
    known : Lines or None
        What the photograph shows, where that is known: gives pixel, scale and error (Appendix C).
    scale : tuple of float or None
        a and b of a known grating's `Bokeh.scale`, for a photograph taken alike.
    lens : tuple of float or None
        Distance, focal length and f-number, metres: for a warning where the lens cannot see such lines.

    Returns
    -------
    Bokeh
        Heights, periods, the number of lit lines, and notes.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read, nothing is lit, or it is not said how large a pixel or how deep
        dark is.
    """
    for stage in heights_from_bokeh_stages(
        photograph, pixel, period, depth, angle, channel, deviation, iterations, known, scale, lens
    ):
        last = stage
    found: Bokeh = last.result
    return found


def heights_from_bokeh_stages(
    photograph: str | os.PathLike[str] | ArrayLike,
    pixel: float | None = None,
    period: float | None = None,
    depth: float | None = None,
    angle: float | None = None,
    channel: int = BLUE,
    deviation: float = 1.5,
    iterations: int = 30,
    known: Lines | None = None,
    scale: tuple[float, float] | None = None,
    lens: tuple[float, float, float] | None = None,
) -> Iterator[Stage]:
    """Do what `heights_from_bokeh` does, step by step.

    Parameters
    ----------
    photograph, pixel, period, depth, angle, channel, deviation, iterations, known, scale, lens : see there
        As for `heights_from_bokeh`.

    Yields
    ------
    Stage
        The last one holds the `Bokeh`.
    """
    period = checked_lines(known).period if known is not None else period
    if (pixel is None) == (period is None):
        raise refuse.Refusal("Give either 'pixel' or 'period': one follows from the other.")
    if (depth is not None) + (known is not None) + (scale is not None) != 1:
        raise refuse.Refusal("Give one of 'depth', 'known' and 'scale': what dark means in metres.")
    yield Stage(0.0, "reading the bokeh")
    upright = _upright(bokeh_profile(_pixels(photograph), 0, channel), angle)
    yield Stage(0.1, "undoing the blur")
    values = richardson_lucy(upright.values, deviation, iterations) if deviation else upright.values
    yield Stage(0.9, "counting lines")
    profile = values.mean(axis=0)
    lines = count_lines(profile)
    if lines < 2.0:
        raise refuse.Refusal("'photograph' shows fewer than two lines; a wider part of the bokeh is needed.")
    pitch = refuse.positive("pixel", pixel) if pixel is not None else 0.0
    if period is not None:
        pitch = pixel_pitch(lines, period, profile.size)
    found = _bokeh(upright, values, lines, pitch)
    if known is not None:
        fit, rising = _fitted(profile, known, profile.size / lines)
        found = replace(found, scale=fit[:2], error=fit[2])
        if angle is None and not rising:
            found = _half_turned(found)
    elif scale is not None:
        found = replace(found, scale=(float(scale[0]), float(scale[1])))
    else:
        dark, bright = np.quantile(values, [0.01, 0.99])
        found = replace(found, scale=(refuse.positive("depth", float(depth or 0)) / (bright - dark), dark))
    yield Stage(1.0, "heights", _scaled(found, depth, lens))


def _pixels(photograph: str | os.PathLike[str] | ArrayLike) -> NDArray[np.floating]:
    """Read a file, or take numbers as they are."""
    if not isinstance(photograph, str | os.PathLike):
        return refuse.all_finite("photograph", photograph)
    if os.fspath(photograph).lower().endswith(".pfm"):
        return read_pfm(photograph)
    return picture.read(photograph).pixels


def _upright(values: Array, angle: float | None) -> _Upright:
    """Cut the square out of a bokeh that lies along its lines."""
    fine = max(1.0, min(values.shape) / 50.0)
    blurred = ndimage.gaussian_filter(values, fine)
    lit = blurred > LIT * np.quantile(blurred, 0.99)
    if not lit.any():
        raise refuse.Refusal("'photograph' is dark: nothing of a bokeh is lit.")
    if lit.mean() > WHOLE:
        middle, diameter = tuple(0.5 * (count - 1) for count in values.shape), 0.0
        turn = _lines_angle(values) if angle is None else refuse.finite("angle", angle)
        side = int(min(values.shape) / (abs(math.cos(turn)) + abs(math.sin(turn))) + 1e-9)
    else:
        middle, diameter = ndimage.center_of_mass(lit), 2.0 * math.sqrt(lit.sum() / math.pi)
        side = int(INNER * diameter / math.sqrt(2.0))
        turn = refuse.finite("angle", angle) if angle is not None else 0.0
        if angle is None:
            turn = _lines_angle(_turned(values, middle, 0.0, side))
    if side < 16:
        raise refuse.Refusal(f"'photograph' shows a bokeh of {side} pixels; 16 are the least.")
    return _Upright(_turned(values, middle, turn, side), diameter or float(side), turn)


def _turned(values: Array, middle: tuple[float, ...], angle: float, side: int) -> Array:
    """Return a square about a place, the picture turned counter-clockwise."""
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    offset = np.asarray(middle) - turn @ np.full(2, 0.5 * (side - 1))
    # Whole quarters of a turn find the pixels themselves.
    turned = ndimage.affine_transform(
        values, np.round(turn, 12), offset, (side, side), order=3, mode="mirror"
    )
    return np.asarray(np.maximum(turned, 0.0))


def _lines_angle(values: Array) -> float:
    """Return the turn that lays the normal of the lines along columns, from -90° to 90°."""
    rows, columns = values.shape
    window = np.hanning(rows + 2)[1:-1, None] * np.hanning(columns + 2)[None, 1:-1]
    even = values - np.average(values, weights=window)
    shape = (2 * rows, 2 * columns)
    power = np.abs(fft.rfft2(even * window, shape, workers=2))
    down, across = fft.fftfreq(shape[0])[:, None], fft.rfftfreq(shape[1])[None, :]
    # Below two periods a window's own lobe and uneven light stand.
    power[np.hypot(down * rows, across * columns) < 2.0] = 0.0
    first = _peak(power)
    # Of lines that cross, the finer ones: a display's sub-pixels.
    aside = np.abs(down * first[0] + across * first[1]) < ASIDE * np.hypot(down, across) * np.hypot(*first)
    second = _peak(np.where(aside, power, 0.0))
    place = round(second[0] * shape[0]), round(second[1] * shape[1])
    finer = np.hypot(*second) > np.hypot(*first) and power[place] > FAINT * power.max()
    v, u = second if finer else first
    # Rows run downward: lines whose normal points up to the right are turned clockwise.
    turn = math.atan2(v, u)
    return turn if abs(turn) <= math.pi / 2 else turn - math.copysign(math.pi, turn)


def _peak(power: Array) -> tuple[float, float]:
    """Return the frequency down and across, in cycles a sample, where a real picture has the most power."""
    rows, columns = power.shape[0], 2 * (power.shape[1] - 1)
    row, column = (int(place) for place in np.unravel_index(np.argmax(power), power.shape))
    down = power[[row - 1, row, (row + 1) % rows], column]
    along = power[row, [abs(column - 1), column, min(column + 1, power.shape[1] - 1)]]
    signed = row - rows if row >= rows // 2 else row
    return (signed + _bend(*down)) / rows, (column + (_bend(*along) if column > 0 else 0.0)) / columns


def _bend(low: float, top: float, high: float) -> float:
    """Return how far from the middle a parabola through three values has its peak."""
    bend = low - 2.0 * top + high
    return float(0.5 * (low - high) / bend) if bend < 0 else 0.0


def _bokeh(upright: _Upright, values: Array, lines: float, pixel: float) -> Bokeh:
    """Return what does not depend on the scale of heights."""
    profile, side = values.mean(axis=0), values.shape[0]
    down = values.mean(axis=1)
    rows = count_lines(down) if down.std() > FAINT * profile.std() else 0.0
    dark, bright = np.quantile(profile, [0.05, 0.95])
    period = pixel * side / lines
    share = float(np.clip(np.mean(profile > 0.5 * (dark + bright)), 0.05, 0.95))
    # Whole periods repeat themselves without a seam.
    columns = round(math.floor(lines) * side / lines)
    kept = values[: round(math.floor(rows) * side / rows) if rows else side, :columns]
    lit = max(1, round(lines * upright.diameter / side))
    across = pixel * side / rows if rows else 0.0
    field = height_field(kept, pixel, "bokeh")
    return Bokeh(field, upright.angle, period, share * period, lit, across, (1.0, 0.0), None, ())


def _scaled(found: Bokeh, depth: float | None, lens: tuple[float, float, float] | None) -> Bokeh:
    """Turn brightness into heights, and say what the lens cannot see."""
    a, b = found.scale
    heights = a * (found.heights.heights - b)
    if depth is not None:
        heights = np.clip(heights, 0.0, depth)
    notes = []
    if lens is not None:
        limit = abbe_limit(*lens)
        finest = min(period for period in (found.period, found.across) if period > 0)
        notes = [note for note in [abbe_note(finest, limit)] if note]
    return replace(found, heights=replace(found.heights, heights=heights), notes=tuple(notes))


def _half_turned(found: Bokeh) -> Bokeh:
    """Turn a bokeh upside down, where the angle that was found is that of lines that fall along +t."""
    turned = np.ascontiguousarray(found.heights.heights[::-1, ::-1])
    angle = found.angle - math.copysign(math.pi, found.angle)
    return replace(found, heights=replace(found.heights, heights=turned), angle=angle)


def _fitted(profile: Array, known: Lines, pixels: float) -> tuple[tuple[float, float, float], bool]:
    """Fit a known grating's heights, wherever its lines begin; say whether they rise along +t."""
    if known.profile == "slits":
        raise refuse.Refusal("'known' must have a depth: profile 'grooves' or 'blazed', not 'slits'.")
    places, share, best = np.arange(profile.size) / pixels, known.width / known.period, (0.0, 0.0, math.inf)
    rising_best = True
    for direction in (1.0, -1.0):
        for phase in np.arange(PHASES) / PHASES:
            within = (direction * places + phase) % 1.0
            rising = known.depth * within
            heights = rising if known.profile == "blazed" else -known.depth * (within < share)
            fit = fit_heights(profile, heights)
            # Dark is deep, so brightness rises with height.
            if fit[0] > 0 and fit[2] < best[2]:
                best, rising_best = fit, direction > 0
    return best, rising_best
