"""Fibres of the lens: rings of radial gratings, bars and gaps of equal breadth.

A ring of N bars sends light where the Bessel function J_N(2π r f) of its outer radius r is largest, at
2π r f = N (1 + 0.81 N^(−2/3)): close to the angle of a straight grating of the outer rim's period.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.aperture import _kernels_gratings
from aureole.aperture.bands import in_bands
from aureole.aperture.chances import uniform
from aureole.records import Outline

# Mean breadth of a ring in which the number of fibres stays the same, metres.
SHELL = 0.25e-3
# By how much of a shell its borders stray in all.
UNEVEN = 0.7
# Fewer bars do not make a grating.
FEWEST = 3


@dataclass(frozen=True, eq=False)
class Fibres:
    """Rings of radial bars about the axis.

    Parameters
    ----------
    radii : ndarray of float64, shape (S + 1,)
        Rising borders of the rings, metres.
    counts : ndarray of int64, shape (S,)
        Bars of each ring; gaps between them are as broad.
    phases : ndarray of float64, shape (S,)
        Periods by which the first bar's edge is turned from +x, counter-clockwise as seen.
    """

    radii: NDArray[np.float64]
    counts: NDArray[np.int64]
    phases: NDArray[np.float64]


def fibres(
    annulus: tuple[float, float],
    width: float | None = None,
    count: int | None = None,
    seed: int | Sequence[int] = 1,
    shell: float = SHELL,
) -> Fibres:
    """Lay fibres into an annulus: shell by shell as many as fit, or a given number from rim to rim.

    Parameters
    ----------
    annulus : tuple of float
        Inner and outer radius, metres.
    width : float, optional
        Of a fibre with its gap, metres: each shell holds round(2π r / width) at its middle r.
    count : int, optional
        Of fibres from the inner to the outer radius, instead of a width.
    seed : int or sequence of int
        Of the shells' phases and borders.
    shell : float
        Largest mean breadth of a shell, metres.

    Returns
    -------
    Fibres
        Shells of about equal breadth.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, or there is not exactly one of width and count.
    """
    inner, outer = refuse.positive("inner radius of the annulus", annulus[0]), annulus[1]
    if refuse.positive("outer radius of the annulus", outer) <= inner:
        raise refuse.Refusal(f"'annulus' must have an outer radius above {inner:g} m, got {outer:g} m.")
    if (width is None) == (count is None):
        raise refuse.Refusal("fibres need either a 'width' or a 'count'.")
    if count is not None:
        radii, counts = np.array([inner, outer]), np.array([refuse.at_least("count", count, FEWEST)])
    else:
        assert width is not None
        refuse.positive("width", width)
        shells = math.ceil((outer - inner) / refuse.positive("shell", shell) - 1e-9)
        radii = np.linspace(inner, outer, shells + 1)
        # Equal shells would differ by equal counts, whose beat is a comb in the ring of light.
        radii[1:-1] += UNEVEN * (outer - inner) / shells * (uniform(seed, 2 * shells - 1)[shells:] - 0.5)
        counts = np.rint(math.pi * (radii[1:] + radii[:-1]) / width).astype(np.int64)
        refuse.at_least("fibres of the innermost shell", int(counts[0]), FEWEST)
    return Fibres(radii, counts.astype(np.int64), uniform(seed, len(counts)))


def stretched_fibres(fibres: Fibres, stretch: float) -> Fibres:
    """Move fibres from the axis as the lens that holds them stretches.

    Parameters
    ----------
    fibres : Fibres
        At rest.
    stretch : float
        Relative change of distances from the axis.

    Returns
    -------
    Fibres
        As many.
    """
    return Fibres(
        fibres.radii * (1 + refuse.between("stretch", stretch, -0.5, 1.0)), fibres.counts, fibres.phases
    )


def fibre_coverage(fibres: Fibres, size: int, width: float, reach: float = math.inf) -> NDArray[np.float32]:
    """Return the part of each pixel of a square that the bars cover.

    Parameters
    ----------
    fibres : Fibres
        Any.
    size : int
        Pixels on each side.
    width : float
        Side of the square, metres.
    reach : float
        Pixels whose centres lie farther from the axis are left at zero, metres.

    Returns
    -------
    ndarray of float32, shape (size, size)
        Exact for borders and bars that are straight across a pixel.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.at_least("size", size, 1)
    pixel = refuse.positive("width", width) / size
    pixels = np.zeros((size, size), dtype=np.float32)
    counts, radii = fibres.counts.astype(np.float64), fibres.radii / pixel
    farthest = min(reach, width) / pixel

    def work(first: int, last: int) -> None:
        _kernels_gratings.cover_gratings(counts, fibres.phases, radii, farthest, pixels, first, last)

    in_bands(work, size)
    return np.clip(pixels, 0, 1, out=pixels)


def fibre_outlines(fibres: Fibres, transmittance: float = 1.0) -> tuple[Outline, ...]:
    """Return the bars as exact rings.

    Parameters
    ----------
    fibres : Fibres
        Any.
    transmittance : float
        What each bar adds to the amplitude.

    Returns
    -------
    tuple of Outline
        Two radial edges and two arcs each.
    """
    rings = []
    for inner, outer, count, phase in zip(
        fibres.radii[:-1], fibres.radii[1:], fibres.counts, fibres.phases, strict=True
    ):
        bulge = math.tan(math.pi / int(count) / 4)
        for bar in range(int(count)):
            angles = 2 * math.pi / count * (phase + bar + np.array([0.0, 0.0, 0.5, 0.5]))
            distances = np.array([inner, outer, outer, inner])
            # Points have y downward, so angles that grow turn from +x towards −y.
            corners = np.stack([distances * np.cos(angles), -distances * np.sin(angles)], axis=1)
            rings.append(Outline(corners, np.array([0.0, -bulge, 0.0, bulge]), transmittance))
    return tuple(rings)
