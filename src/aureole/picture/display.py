"""From linear light to something a screen can show.

Three steps: exposure (a factor of 2 a stop), a tone curve that brings what is left into 0..1, and
sRGB's encoding. The curves work on a colour's largest channel and scale all channels together, so
that hue stays; towards the top "filmic" mixes in white, as film and eyes do, so that a red lamp has a
white core and a red glow. "clip" cuts off. "log" shows many decades, for kernels.

What comes out are display-ready arrays (rows, columns, 3) of 0..1, for a PNG or a browser.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.picture.primaries import converted
from aureole.picture.transfer import encode_srgb, into_gamut
from aureole.records import Picture

Pixels = NDArray[np.float32]

SHOULDER = 1.5  # how late "filmic" bends: x / (1 + x^SHOULDER)^(1 / SHOULDER), straight near black
WHITENING = 8.0  # how late "filmic" turns white: the share of white is its brightness to this power
DECADES = 10.0
LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)

# Colour maps by lightness, chroma and hue in Oklab, from dark to bright; hue in degrees.
_Corner = tuple[float, float, float]
COLOUR_MAPS: Mapping[str, tuple[_Corner, ...]] = {
    "ember": ((0.0, 0.02, 290), (0.3, 0.15, 310), (0.58, 0.2, 385), (0.8, 0.16, 430), (0.98, 0.06, 465)),
    "ice": ((0.0, 0.02, 265), (0.35, 0.15, 262), (0.62, 0.13, 240), (0.84, 0.09, 205), (0.99, 0.02, 190)),
    "grey": ((0.0, 0.0, 0), (1.0, 0.0, 0)),
}


def to_display(
    picture: Picture | ArrayLike,
    exposure: float | str = "auto",
    tone: str = "filmic",
    decades: float = DECADES,
) -> Pixels:
    """Make a linear picture ready for a screen.

    Parameters
    ----------
    picture : Picture or array_like, shape (rows, columns[, channels])
        Linear light; an array is taken as Rec.709 or grey. Alpha is left out: black shows through.
    exposure : float or str
        Stops, or "auto" for those of `auto_exposure`.
    tone : str
        "filmic", "clip" or "log".
    decades : float
        For "log": how many powers of ten below the picture's largest value are shown.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Encoded values 0..1.
    """
    refuse.one_of("tone", tone, TONES)
    colour = into_gamut(_colour(picture))
    if tone == "log":
        return log_scale(colour, decades)
    stops = auto_exposure(colour) if exposure == "auto" else refuse.finite("exposure", exposure)  # type: ignore[arg-type]
    return encode_srgb(TONES[tone](colour * np.float32(2.0**stops)))


def auto_exposure(
    picture: Picture | ArrayLike, percentile: float = 90.0, target: float = 0.18, most: float = 20.0
) -> float:
    """Choose an exposure that brings a percentile of the luminance to a target.

    Parameters
    ----------
    picture : Picture or array_like, shape (rows, columns[, channels])
        Linear light.
    percentile : float
        Of the pixels that are above zero.
    target : float
        The linear value to bring it to.
    most : float
        Largest number of stops up or down.

    Returns
    -------
    float
        Stops; 0 for a black picture.
    """
    luminance = _colour(picture) @ LUMINANCE
    lit = luminance[luminance > 0]
    if lit.size == 0:
        return 0.0
    level = float(np.percentile(lit, refuse.between("percentile", percentile, 0, 100)))
    stops = math.log2(refuse.positive("target", target)) - math.log2(level)
    return min(max(stops, -most), most)


def filmic(linear: Pixels) -> Pixels:
    """Bend linear light into 0..1 with a long shoulder, whiter towards the top, hue kept.

    Parameters
    ----------
    linear : ndarray of float32, shape (rows, columns, 3)
        Exposed linear light, not negative.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Linear values 0..1.
    """
    largest = _largest(linear)
    # For large x the quotient is written by 1/x, so that no power overflows.
    small, large = np.minimum(largest, 1), np.maximum(largest, 1)
    below = small / (1 + small**SHOULDER) ** (1 / SHOULDER)
    bright = np.where(largest < 1, below, 1 / (1 + large**-SHOULDER) ** (1 / SHOULDER))
    share = bright**WHITENING
    hue = linear / np.where(largest > 0, largest, 1)
    bent: Pixels = (bright * (hue + share * (1 - hue))).astype(np.float32, copy=False)
    return bent


def clip(linear: Pixels) -> Pixels:
    """Cut linear light off at 1, channel by channel.

    Parameters
    ----------
    linear : ndarray of float32
        Exposed linear light.

    Returns
    -------
    ndarray of float32
        Linear values 0..1.
    """
    return np.clip(linear, 0, 1)


def log_scale(linear: ArrayLike, decades: float = DECADES) -> Pixels:
    """Show the decades below the largest value as even steps of brightness.

    Parameters
    ----------
    linear : array_like, shape (rows, columns) or (rows, columns, 3)
        Values, none of which below zero; colours keep the ratio of their channels.
    decades : float
        Powers of ten from black to white.

    Returns
    -------
    ndarray of float32, same shape
        0..1, encoded: to be shown as it is.
    """
    refuse.positive("decades", decades)
    values = np.asarray(linear, dtype=np.float32)
    is_colour = values.ndim == 3
    level = _largest(values) if is_colour else values
    peak = level.max(initial=0)
    if peak <= 0:
        return np.zeros_like(values)
    with np.errstate(divide="ignore"):
        brightness = np.clip(1 + np.log10(level / peak) / np.float32(decades), 0, 1)
    if not is_colour:
        return np.asarray(brightness, dtype=np.float32)
    hue = (values / np.where(level > 0, level, 1)).astype(np.float32, copy=False)
    return np.asarray(brightness * encode_srgb(hue), dtype=np.float32)


TONES: Mapping[str, Callable[[Pixels], Pixels]] = {"filmic": filmic, "clip": clip, "log": log_scale}


def false_colour(values: ArrayLike, colours: str = "ember") -> Pixels:
    """Show numbers 0..1 as colours whose lightness grows evenly.

    Parameters
    ----------
    values : array_like, shape (rows, columns)
        0..1, such as `log_scale` gives; what lies outside is clipped.
    colours : str
        "ember" (black, violet, red, yellow), "ice" (black, blue, white) or "grey".

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Encoded values 0..1.
    """
    table = _colour_table(refuse.one_of("colours", colours, COLOUR_MAPS))
    place = np.clip(np.asarray(values, dtype=np.float32), 0, 1) * (len(table) - 1)
    below = np.minimum(place.astype(np.intp), len(table) - 2)
    share = (place - below)[..., None]
    return np.asarray(table[below] * (1 - share) + table[below + 1] * share, dtype=np.float32)


def side_by_side(pictures: Sequence[ArrayLike], gap: int = 8, shade: float = 1.0) -> Pixels:
    """Put display-ready pictures next to each other, in a row.

    Parameters
    ----------
    pictures : sequence of array_like, shape (rows, columns) or (rows, columns, 3)
        Encoded values 0..1; lower ones are centred.
    gap : int
        Pixels between two.
    shade : float
        Grey of what lies between and above, 0..1.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Encoded values 0..1.
    """
    refuse.at_least("gap", gap, 0)
    shown = [_colour(picture) for picture in pictures]
    if not shown:
        raise refuse.Refusal("'pictures' must hold at least one picture, got none.")
    rows = max(len(picture) for picture in shown)
    columns = sum(picture.shape[1] + gap for picture in shown) - gap
    sheet = np.full((rows, columns, 3), refuse.between("shade", shade, 0, 1), dtype=np.float32)
    left = 0
    for picture in shown:
        top = (rows - len(picture)) // 2
        sheet[top : top + len(picture), left : left + picture.shape[1]] = picture
        left += picture.shape[1] + gap
    return sheet


def _largest(linear: Pixels) -> Pixels:
    """Return the largest channel of each pixel, shape (rows, columns, 1)."""
    largest = linear[..., 0]
    for channel in range(1, linear.shape[-1]):
        largest = np.maximum(largest, linear[..., channel])
    return largest[..., None]


def _colour(picture: Picture | ArrayLike) -> Pixels:
    """Take the colour of a picture, as Rec.709; a grey one three times."""
    if isinstance(picture, Picture):
        return converted(picture.pixels[..., :3], picture.colour_space, "rec709")
    pixels = np.asarray(picture, dtype=np.float32)
    refuse.shape_of("picture", pixels, (None,) * (3 if pixels.ndim == 3 else 2))
    if pixels.ndim == 2 or pixels.shape[2] < 3:
        grey = pixels.reshape((*pixels.shape[:2], -1))[:, :, :1]
        return np.repeat(grey, 3, axis=2)
    return pixels[:, :, :3]


@lru_cache
def _colour_table(colours: str) -> Pixels:
    """Draw a line through a map's corners in Oklab, and encode it for the screen.

    Oklab: Björn Ottosson, "A perceptual color space for image processing", 2020.
    """
    corners = np.array(COLOUR_MAPS[colours])
    where = np.linspace(corners[0, 0], corners[-1, 0], 257)
    chroma, hue = (np.interp(where, corners[:, 0], corners[:, axis]) for axis in (1, 2))
    a, b = chroma * np.cos(np.radians(hue)), chroma * np.sin(np.radians(hue))
    lab = np.stack([where, a, b], axis=1)
    to_cones = [
        [1, 0.3963377774, 0.2158037573],
        [1, -0.1055613458, -0.0638541728],
        [1, -0.0894841775, -1.2914855480],
    ]
    to_linear = [
        [4.0767416621, -3.3077115913, 0.2309699292],
        [-1.2684380046, 2.6097574011, -0.3413193965],
        [-0.0041960863, -0.7034186147, 1.7076147010],
    ]
    linear = (lab @ np.array(to_cones).T) ** 3 @ np.array(to_linear).T
    return encode_srgb(into_gamut(linear.astype(np.float32)[None])[0])
