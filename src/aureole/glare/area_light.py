"""Lights with a size behind things that hide parts of them: samples of the light, each with its view.

Every sample of the light sees another part of the opening, and spreads its light as the far field of that
part (quad paper §4.4, §6.1). Powers of samples add up, since different points of a lamp are not coherent.
Each sample's opening differs little from its neighbour's, so few transforms can do for all (`power_sums`):
samples follow each other as a snake goes through the light.

A sample's power is weighed by the opening's whole energy, not by its own: what is hidden is missing, and the
sum holds the visible part of the light.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.aperture import Occluder
from aureole.glare.power_sums import power_sum
from aureole.records import Aperture, Grid

# Parts of a sample's cell along each axis that find how much of the light it holds, and where.
CELL = 8
# Numbers of samples across the light that are tried until the error allows it.
STEPS = (3, 5, 9, 17, 33)
# Pixels a side of the rasters of openings.
RASTER_SIZE = 1024


@dataclass(frozen=True, eq=False)
class AreaLight:
    """A light with a size, equally bright all over.

    Parameters
    ----------
    shape : Aperture
        Its outline as the opening of its shape, or a raster of how bright its parts are; the unit is the
        tangent of the angle as seen from the opening: metres over the distance.
    toward : tuple of float
        Tangents of the direction to its middle, to the right and downward.
    distance : float
        Metres from the opening; infinite for the sun.
    """

    shape: Aperture
    toward: tuple[float, float] = (0.0, 0.0)
    distance: float = math.inf


@dataclass(frozen=True, eq=False)
class LightSamples:
    """Points that stand for a light, in the order of a snake.

    Parameters
    ----------
    toward : ndarray of float64, shape (K, 2)
        Tangents of their directions, to the right and downward.
    weights : ndarray of float64, shape (K,)
        Shares of the light, which add up to 1.
    cells : ndarray of int64, shape (K, 2)
        Row and column of each one's cell in the light's square.
    """

    toward: NDArray[np.float64]
    weights: NDArray[np.float64]
    cells: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class AreaPower:
    """The power of an area light behind occluders, at one wavelength.

    Parameters
    ----------
    power : ndarray of float32, shape (rows, columns)
        Mean over the light of |F|² of the openings that its points see, metres to the fourth.
    visible : float
        Part of the opening's energy that the light's points see, mean over the light, 0..1.
    samples : int
        How many points of the light were taken.
    error : float
        How far the power is from that of the next coarser samples, sum of absolute differences over the
        sum; 0 where their number was given and nothing was compared.
    transforms : int
        How many far fields were taken.
    estimated : float
        Share of the light whose spread was estimated, 0..1: the power's mean absolute difference from that
        of a transform for each sample is at most this part of it.
    """

    power: NDArray[np.float32]
    visible: float
    samples: int
    error: float = 0.0
    transforms: int = 0
    estimated: float = 0.0


def light_samples(light: AreaLight, across: int) -> LightSamples:
    """Return points that stand for a light: the middles of what lies of it in equal square cells.

    Parameters
    ----------
    light : AreaLight
        Any.
    across : int
        Cells along each side of the light's square.

    Returns
    -------
    LightSamples
        Of the cells that hold light, every second row backward.

    Raises
    ------
    refuse.Refusal
        Where the number is not an integer >= 1, or the light is dark.
    """
    count = refuse.at_least("across", across, 1)
    fine = apertures.rasterize(light.shape, count * CELL).astype(np.float64)
    parts = fine.reshape(count, CELL, count, CELL)
    weights = parts.sum(axis=(1, 3))
    if not weights.any():
        raise refuse.Refusal("'light' is dark all over.")
    step = light.shape.width / (count * CELL)
    axis = (np.arange(count * CELL) - (count * CELL - 1) / 2) * step
    lit = np.where(weights > 0, weights, 1)
    x = np.einsum("aibj,bj->ab", parts, axis.reshape(count, CELL)) / lit
    y = np.einsum("aibj,ai->ab", parts, axis.reshape(count, CELL)) / lit
    cells = np.array(
        [
            (row, column)
            for row in range(count)
            for column in (range(count) if row % 2 == 0 else range(count - 1, -1, -1))
            if weights[row, column] > 0
        ],
        dtype=np.int64,
    )
    at = cells[:, 0], cells[:, 1]
    toward = np.stack([x[at], y[at]], axis=1) + np.asarray(light.toward)
    return LightSamples(toward, weights[at] / weights.sum(), cells)


def sample_openings(
    opening: Aperture,
    occluders: Sequence[Occluder],
    light: AreaLight,
    samples: LightSamples,
    size: int | None = None,
) -> Iterator[tuple[float, Aperture | None]]:
    """Yield what of an opening each point of a light sees, with the point's share of the light.

    Parameters
    ----------
    opening : Aperture
        At its size in metres.
    occluders : sequence of Occluder
        What stands between.
    light : AreaLight
        The light.
    samples : LightSamples
        Its points.
    size : int, optional
        Pixels a side to which all is rasterized; outlines stay outlines without.

    Yields
    ------
    tuple
        Share, and the opening, or None where it is hidden.
    """
    base = opening if size is None else apertures.from_mask(apertures.rasterize(opening, size), opening.width)
    for (x, y), weight in zip(samples.toward, samples.weights, strict=True):
        yield float(weight), apertures.seen_past(base, occluders, (float(x), float(y)), light.distance, size)


def area_power(
    opening: Aperture,
    occluders: Sequence[Occluder],
    light: AreaLight,
    grid: Grid,
    across: int | None = None,
    tolerance: float = 0.01,
    size: int = RASTER_SIZE,
    method: str = "auto",
) -> AreaPower:
    """Return the mean far-field power of an opening over the points of a light behind occluders.

    Parameters
    ----------
    opening : Aperture
        At its size in metres.
    occluders : sequence of Occluder
        What stands between.
    light : AreaLight
        The light.
    grid : Grid
        Frequencies in cycles per metre.
    across : int, optional
        Samples across the light; without it as many as the tolerance needs, 33 at most.
    tolerance : float
        Sum of absolute differences over the sum. Without a number of samples, finer ones are taken until the
        power differs by less from that of half as many across. Method "modes" may estimate the spread of
        half this share of the light.
    size : int
        Pixels a side of the openings' rasters.
    method : str
        "transforms", a transform for each sample; "progressive", each from its neighbour's change (quad paper
        §4.3); "modes", few transforms for all, to the tolerance; "auto", modes unless samples are few.

    Returns
    -------
    AreaPower
        With the error that was found.

    Raises
    ------
    refuse.Refusal
        Where a number does not fit.
    """
    refuse.positive("tolerance", tolerance)
    if across is not None:
        return _summed_power(opening, occluders, light, grid, across, tolerance, size, method)
    before = _summed_power(opening, occluders, light, grid, STEPS[0], tolerance, size, method)
    for count in STEPS[1:]:
        found = _summed_power(opening, occluders, light, grid, count, tolerance, size, method)
        before = replace(found, error=difference(found.power, before.power))
        if before.error <= tolerance:
            break
    return before


def difference(found: NDArray[np.floating], before: NDArray[np.floating], least: float = 0.0) -> float:
    """Return how far two patterns are from each other: the sum of absolute differences over the sum.

    Parameters
    ----------
    found, before : ndarray
        Of one shape, not negative.
    least : float
        What the sum counts for where it is less.

    Returns
    -------
    float
        0 where both are dark.
    """
    sums = (float(each.sum(dtype=np.float64)) for each in (found, before))
    total = max(*sums, least)
    return float(np.abs(found - before).sum(dtype=np.float64)) / total if total > 0 else 0.0


def _summed_power(
    opening: Aperture,
    occluders: Sequence[Occluder],
    light: AreaLight,
    grid: Grid,
    across: int,
    tolerance: float,
    size: int,
    method: str,
) -> AreaPower:
    """Sum the powers of the samples' openings."""
    samples = light_samples(light, across)
    whole = apertures.energy(Aperture(opening.width, mask=apertures.rasterize(opening, size)))
    visible = 0.0
    total = power_sum(method, grid, size, min(tolerance / 2, 1.0), len(samples.weights))
    for weight, seen in sample_openings(opening, occluders, light, samples, size):
        if seen is not None:
            visible += weight * apertures.energy(seen) / whole
            total.add(seen, weight)
    power = total.result()
    return AreaPower(
        power,
        min(visible, 1.0),
        len(samples.weights),
        transforms=total.transforms,
        estimated=total.estimated,
    )
