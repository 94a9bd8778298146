"""Particles before an opening: discs at seeded places, and how they move.

A disc stands for a small body of the eye. Where discs are transparent and half a wave late the amplitude
is −1 in place of 1: they scatter light and take none away.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.aperture import _kernels_discs
from aureole.aperture.bands import in_bands
from aureole.aperture.chances import uniform
from aureole.records import Outline

# A deformation is a sum of this many waves, each at least so long against the field.
WAVES, SHORTEST_WAVE = 6, 0.8


@dataclass(frozen=True, eq=False)
class Discs:
    """Discs on a plane.

    Parameters
    ----------
    centres : ndarray of float64, shape (N, 2)
        (x, y) in metres.
    radii : ndarray of float64, shape (N,)
        Metres.
    """

    centres: NDArray[np.float64]
    radii: NDArray[np.float64]


def scattered(count: int, radius: float, field_radius: float, seed: int | Sequence[int]) -> Discs:
    """Scatter equal discs over a round field.

    Parameters
    ----------
    count : int
        How many; more of them leave the first ones where they are.
    radius : float
        Of each disc, metres.
    field_radius : float
        Of the field about the axis that holds the centres, metres.
    seed : int or sequence of int
        The same gives the same places on every machine.

    Returns
    -------
    Discs
        Everywhere equally dense.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.at_least("count", count, 0)
    refuse.positive("radius", radius)
    away, turn = uniform(seed, 2 * count).reshape(count, 2).T
    distance, angle = refuse.positive("field_radius", field_radius) * np.sqrt(away), 2 * math.pi * turn
    centres = np.stack([distance * np.cos(angle), distance * np.sin(angle)], axis=1)
    return Discs(centres, np.full(count, float(radius)))


def joined(parts: Iterable[Discs]) -> Discs:
    """Put several lots of discs into one.

    Parameters
    ----------
    parts : iterable of Discs
        Any number.

    Returns
    -------
    Discs
        All of them, in order.
    """
    lots = list(parts)
    if not lots:
        return Discs(np.zeros((0, 2)), np.zeros(0))
    return Discs(np.concatenate([lot.centres for lot in lots]), np.concatenate([lot.radii for lot in lots]))


def turned(discs: Discs, angle: float) -> Discs:
    """Turn discs about the axis.

    Parameters
    ----------
    discs : Discs
        Any.
    angle : float
        Radians, counter-clockwise as seen.

    Returns
    -------
    Discs
        With the same radii.
    """
    cosine, sine = math.cos(refuse.finite("angle", angle)), math.sin(angle)
    # Points have y downward.
    return Discs(discs.centres @ np.array([[cosine, -sine], [sine, cosine]]), discs.radii)


def stretched(
    discs: Discs, stretch: float, seed: int | Sequence[int], field_radius: float, unevenness: float = 0.3
) -> Discs:
    """Move discs from the axis as an elastic body that they lie in stretches, a little unevenly.

    Parameters
    ----------
    discs : Discs
        At rest.
    stretch : float
        Relative change of distances from the axis; 0 leaves the discs where they are.
    seed : int or sequence of int
        Of the unevenness.
    field_radius : float
        Radius of the body, metres.
    unevenness : float
        Root mean square of the smooth displacements across the body over the stretch of its rim.

    Returns
    -------
    Discs
        With the same radii.

    Raises
    ------
    refuse.Refusal
        Where a number is not finite, or the stretch folds the body over.
    """
    refuse.between("stretch", stretch, -0.5, 1.0)
    if stretch == 0 or not len(discs.radii):
        return discs
    chances = uniform(seed, 4 * WAVES).reshape(WAVES, 4)
    lengths = 2 * field_radius * (SHORTEST_WAVE + chances[:, 0])
    waves = 2 * math.pi / lengths * np.exp(2j * math.pi * chances[:, 1])
    phases = discs.centres @ np.stack([waves.real, waves.imag]) + 2 * math.pi * chances[:, 2]
    push = unevenness * stretch * field_radius * math.sqrt(2 / WAVES) * np.exp(2j * math.pi * chances[:, 3])
    swing = np.sin(phases) @ np.stack([push.real, push.imag], axis=1)
    return Discs(discs.centres * (1 + stretch) + swing, discs.radii)


def disc_coverage(discs: Discs, size: int, width: float) -> NDArray[np.float32]:
    """Return the part of each pixel of a square that discs cover.

    Parameters
    ----------
    discs : Discs
        Any, also of less than a pixel.
    size : int
        Pixels on each side.
    width : float
        Side of the square, metres.

    Returns
    -------
    ndarray of float32, shape (size, size)
        0..1, exact for discs apart; where several share a pixel, as much as they cover by chance.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.at_least("size", size, 1)
    pixel = refuse.positive("width", width) / size
    pixels = np.ones((size, size), dtype=np.float32)
    centres, radii = discs.centres / pixel + size / 2, discs.radii / pixel

    def work(first: int, last: int) -> None:
        _kernels_discs.uncover_discs(centres, radii, pixels, first, last)

    in_bands(work, size)
    return np.subtract(1, pixels, out=pixels)


def disc_outlines(discs: Discs, transmittance: float = -2.0) -> tuple[Outline, ...]:
    """Return discs as exact rings.

    Parameters
    ----------
    discs : Discs
        Any.
    transmittance : float
        What each adds to the amplitude: −2 turns the 1 about it into −1.

    Returns
    -------
    tuple of Outline
        Two half circles each.
    """
    return tuple(
        Outline(np.array([[x - radius, y], [x + radius, y]]), np.ones(2), transmittance)
        for (x, y), radius in zip(discs.centres, discs.radii, strict=True)
    )
