"""Lids and lashes before a pupil, as their shadow on it.

The lids' margins are parabolas that meet on a line below the middle as the eye closes. Lashes hang from the
upper margin: curved, tapered bodies that follow it down and bend as they meet the lower lid's.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.aperture.chances import uniform
from aureole.aperture.geometry import chords
from aureole.aperture.masks import CHORD_TOLERANCE, darken
from aureole.records import Outline

# Heights at the middle of the open upper and lower margin and of the line where they meet, metres
# downward, and radii of their curvature, positive where the middle lies above the sides.
UPPER, LOWER, MEETING = -5.2e-3, 5.0e-3, 2.0e-3
UPPER_RADIUS, LOWER_RADIUS, MEETING_RADIUS = 20e-3, -25e-3, -40e-3
# Lashes are counted over this breadth and stand on the margin this far to each side, metres.
COUNTED, FARTHEST = 6e-3, 15e-3
# Length before the eye, its spread, and the tip's breadth over the root's.
LENGTH, LENGTH_SPREAD, TIP = 3.2e-3, 0.25, 0.25
# Bulges of lashes: spread at rest, and what the lower lid adds when the eye closes.
CURVED, BENT = 0.05, 0.3
CHANCES = 5


@dataclass(frozen=True)
class Lids:
    """Margins of two lids: y = height + x² / (2 · radius), y downward.

    Parameters
    ----------
    upper, lower : tuple of float
        Height at x = 0, metres, and curvature 1 / radius, 1/metres. Light passes below the upper and
        above the lower one.
    """

    upper: tuple[float, float]
    lower: tuple[float, float]


def lids(opening: float) -> Lids:
    """Return the lids' margins.

    Parameters
    ----------
    opening : float
        0, where they meet, to 1, where they clear a pupil of 9 mm.

    Returns
    -------
    Lids
        About the middle of the pupil.

    Raises
    ------
    refuse.Refusal
        Where the opening is outside 0 to 1.
    """
    refuse.between("opening", opening, 0, 1)

    def margin(height: float, radius: float) -> tuple[float, float]:
        closed = 1 - opening
        return opening * height + closed * MEETING, opening / radius + closed / MEETING_RADIUS

    return Lids(margin(UPPER, UPPER_RADIUS), margin(LOWER, LOWER_RADIUS))


def close_lids(
    mask: NDArray[np.float32], margins: Lids, width: float, shift: tuple[float, float] = (0.0, 0.0)
) -> None:
    """Take what lids cover off a mask, in place.

    Parameters
    ----------
    mask : ndarray of float32, shape (size, size)
        Multiplied by the part of each pixel that lies between the lids, exact for margins that are
        straight across a pixel.
    margins : Lids
        Of the two lids.
    width : float
        Side of the mask, metres.
    shift : tuple of float
        (x, y) by which the lids' shadow is moved, metres.

    Raises
    ------
    refuse.Refusal
        Where the width is not positive.
    """
    size = len(mask)
    pixel = refuse.positive("width", width) / size
    x = np.linspace(-width / 2, width / 2, size + 1) - shift[0]
    upper, lower = (
        (height + shift[1] + curvature * x**2 / 2) / pixel + size / 2
        for height, curvature in (margins.upper, margins.lower)
    )
    first, last = _rows(upper, size)[0], _rows(lower, size)[1]
    mask[:first], mask[max(first, last) :] = 0, 0
    bands = [_rows(upper, size), _rows(lower, size)]
    if bands[0][1] > bands[1][0]:
        bands = [(min(bands[0][0], bands[1][0]), max(bands[0][1], bands[1][1]))]
    for top, bottom in bands:
        # What lies below the upper margin less what lies below the lower one.
        between = _below(upper, top, bottom) - _below(lower, top, bottom)
        mask[top:bottom] *= np.maximum(between, 0).astype(np.float32)


def lashes(
    count: int,
    spread: float,
    width: float,
    opening: float,
    seed: int | Sequence[int],
    root_shift: tuple[float, float] = (0.0, 0.0),
    tip_shift: tuple[float, float] = (0.0, 0.0),
) -> tuple[Outline, ...]:
    """Hang lashes from the upper lid's margin.

    Parameters
    ----------
    count : int
        Over 6 mm of the margin, which is 30 mm long.
    spread : float
        Standard deviation of their directions about the margin's normal, radians.
    width : float
        At the root, metres; a quarter of it at the tip.
    opening : float
        Of the lids, 0 to 1.
    seed : int or sequence of int
        The same gives the same lashes on every machine.
    root_shift, tip_shift : tuple of float
        (x, y) by which the shadow of the roots and of the tips is moved, metres: the tips stand farther
        before the pupil.

    Returns
    -------
    tuple of Outline
        Opaque lashes of transmittance −1, each between two arcs.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.between("count", refuse.at_least("count", count, 0), 0, 1000)
    refuse.between("spread", spread, 0, math.pi / 2)
    refuse.positive("width", width)
    if count == 0:
        return ()
    height, curvature = lids(opening).upper
    step = COUNTED / count
    side = int(FARTHEST / step)
    places = np.arange(-side, side + 1)
    chances = uniform(seed, len(places) * CHANCES).reshape(len(places), CHANCES)
    roots_x = step * (places + 0.7 * (chances[:, 0] - 0.5))
    roots = np.stack([roots_x, height + curvature * roots_x**2 / 2], axis=1)
    # The margin's normal points down; angles turn counter-clockwise as seen.
    angles = np.arctan(-curvature * roots_x) + spread * _normal(chances[:, 1])
    lengths = LENGTH * (1 + LENGTH_SPREAD * (2 * chances[:, 2] - 1))
    tips = roots + lengths[:, None] * np.stack([np.sin(angles), np.cos(angles)], axis=1)
    bulges = CURVED * _normal(chances[:, 3]) + BENT * (1 - opening) * np.sign(chances[:, 4] - 0.5)
    return tuple(
        _lash(root, tip, width, float(bulge))
        for root, tip, bulge in zip(roots + root_shift, tips + tip_shift, bulges, strict=True)
    )


def lash_coverage(shadows: Sequence[Outline], size: int, width: float) -> NDArray[np.float32]:
    """Return the part of each pixel of a square that lashes cover.

    Parameters
    ----------
    shadows : sequence of Outline
        As `lashes` returns them, also beyond the square.
    size : int
        Pixels on each side.
    width : float
        Side of the square, metres.

    Returns
    -------
    ndarray of float32, shape (size, size)
        Exact for lashes apart; where several share a pixel, as much as they cover by chance.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.at_least("size", size, 1)
    pixel = refuse.positive("width", width) / size
    free = np.ones((size, size), dtype=np.float32)
    for ring in shadows:
        # An arc rises above its chord by half of the bulge times the chord's length.
        rise = np.abs(ring.bulges).max() * np.ptp(ring.vertices, axis=0).sum() / 2
        low, high = ring.vertices.min(axis=0) - rise, ring.vertices.max(axis=0) + rise
        if max(low.max(), -high.min()) > width / 2:
            continue
        darken(free, chords(ring, CHORD_TOLERANCE * pixel) / pixel + size / 2)
    return np.subtract(1, free, out=free)


def _rows(margin: NDArray[np.float64], size: int) -> tuple[int, int]:
    """Return the first row of pixels that a margin crosses, and the row after the last."""
    top = int(np.clip(np.floor(margin.min()), 0, size))
    return top, int(np.clip(np.ceil(margin.max()), top, size))


def _below(margin: NDArray[np.float64], top: int, bottom: int) -> NDArray[np.float64]:
    """Return the part of each pixel of some rows below a line through the columns' borders."""
    low, high = np.minimum(margin[:-1], margin[1:]), np.maximum(margin[:-1], margin[1:])
    edges = np.arange(top, bottom + 1)[:, None]
    # Within a column the line rises evenly: the mean over it of what lies above an edge of the pixels.
    rise = np.maximum(high - low, 1e-9)
    above = (np.clip(edges - low, 0, rise) ** 2 / 2) / rise + np.maximum(edges - high, 0)
    return np.asarray(np.diff(above, axis=0))


def _normal(chances: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return numbers of mean 0 and standard deviation 1, bell-shaped, from even chances."""
    from scipy.special import ndtri

    return np.asarray(ndtri(np.clip(chances, 1e-4, 1 - 1e-4)))


def _lash(root: NDArray[np.float64], tip: NDArray[np.float64], width: float, bulge: float) -> Outline:
    """Return a tapered body between two arcs from a root to a tip."""
    along = (tip - root) / max(float(np.hypot(*(tip - root))), 1e-9)
    aside = np.array([-along[1], along[0]]) * width / 2
    corners = np.stack([root + aside, tip + TIP * aside, tip - TIP * aside, root - aside])
    return Outline(corners, np.array([bulge, 0.0, -bulge, 0.0]), -1.0)
