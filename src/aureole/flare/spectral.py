"""Few wavelengths are traced, many are drawn: samples of a light's spectrum, and their bands of colour.

A band takes the exact integral of spectrum × observer over itself, so that the bands' colours sum to the
light's white whatever their number. Between the traced wavelengths everything that a ray brings along
(place on the sensor, weight, level, place in the stop) is a smooth function of the wavelength, taken from the
polynomial in 1 / λ through the traced values: the phase of a coating goes with 1 / λ, Cauchy's index with its
square. The bands are even in 1 / λ², so that they move evenly over the sensor.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse
from aureole.light.observer import bands
from aureole.records import Spectrum

BLENDS = ("blended", "flat")
# Outside, light brings 0.3 % of a white's X, 0.03 % of Y and 0.7 % of Z; it counts for the outermost bands.
LOW, HIGH = 400e-9, 700e-9
DEFAULT_WAVELENGTHS = 4
MOST_WAVELENGTHS = 64
# Numbers of bands that a ghost may have: a colour table for each is made once.
BAND_COUNTS = (4, 6, 8, 12, 16, 24, 32, 48, 64)
# Width of the fine cells that bands are made of, metres.
STEP = 1e-9

Numbers = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Bands:
    """Wavelengths that are drawn, and how they follow from those traced.

    Parameters
    ----------
    wavelengths : ndarray of float64, shape (M,)
        Mean wavelength of each band, metres, rising.
    colours : ndarray of float64, shape (M, 3)
        XYZ of each band; their sum is the light's white, with Y = 1.
    blend : ndarray of float64, shape (M, W)
        What a band takes of each traced wavelength; each row sums to 1.
    nearest : ndarray of int, shape (M,)
        The traced wavelength nearest to each band.
    average : ndarray of float64, shape (M, C)
        What each of the sampling's fine cells counts in its band; each row sums to 1.
    """

    wavelengths: Numbers
    colours: Numbers
    blend: Numbers
    nearest: NDArray[np.int64]
    average: Numbers


@dataclass(frozen=True, eq=False)
class Sampling:
    """Which wavelengths of a light are traced, and its spectrum in fine cells.

    Parameters
    ----------
    wavelengths : ndarray of float64, shape (W,)
        To be traced, metres, rising.
    blended : bool
        Whether wavelengths between them are drawn.
    cells : ndarray of float64, shape (C,)
        Middle of each fine cell, or each line, metres, rising.
    colours : ndarray of float64, shape (C, 3)
        XYZ of each fine cell; their sum is the light's white.
    """

    wavelengths: Numbers
    blended: bool
    cells: Numbers
    colours: Numbers

    def bands(self, count: int) -> Bands:
        """Return the bands to draw; `count` is heeded where samples are blended."""
        return _bands(self, count)


def sample_spectrum(spectrum: Spectrum, count: int = DEFAULT_WAVELENGTHS, blend: str = "blended") -> Sampling:
    """Choose the wavelengths of a light that are traced.

    Parameters
    ----------
    spectrum : Spectrum
        The light's.
    count : int
        How many; a spectrum of at most so many lines is traced at its lines.
    blend : {"blended", "flat"}
        Whether bands between the traced wavelengths are drawn with interpolated rays, or each traced
        wavelength stands for a band of one colour, as in most other programs.

    Returns
    -------
    Sampling
        For "blended" the wavelengths are Chebyshev's points in 1 / λ of 400 to 700 nm, or of the part that
        is lit, where the interpolation errs least; for "flat" the mean wavelengths of even cells.

    Raises
    ------
    refuse.Refusal
        Where the count is not from 1 to 64, the word is unknown, or nobody sees the light.
    """
    refuse.one_of("blend", blend, BLENDS)
    if refuse.at_least("wavelengths", count, 1) > MOST_WAVELENGTHS:
        raise refuse.Refusal(f"'wavelengths' must be at most {MOST_WAVELENGTHS}, got {count}.")
    cells, colours = _fine(spectrum)
    if spectrum.kind == "lines" and len(cells) <= count:
        return Sampling(cells, False, cells, colours)
    if blend == "flat" and spectrum.kind == "power":
        traced, _ = light.quadrature(spectrum, count, LOW, HIGH)
        return Sampling(traced, False, cells, colours)
    fast, slow = 1.0 / cells[0], 1.0 / cells[-1]
    angles = np.pi * (2.0 * np.arange(count) + 1.0) / (2.0 * count)
    traced = 1.0 / (0.5 * (fast + slow) + 0.5 * (fast - slow) * np.cos(angles))
    return Sampling(traced, blend == "blended" and count > 1, cells, colours)


def band_count(shift: float, step: float, largest: int = BAND_COUNTS[-1]) -> int:
    """Return how many bands a ghost needs that moves over the spectrum.

    Parameters
    ----------
    shift : float
        How far its fastest ray moves from the first to the last traced wavelength, pixels.
    step : float
        How far apart neighbouring bands may lie, pixels.
    largest : int
        The most bands to take.

    Returns
    -------
    int
        One of 4, 6, 8, 12, 16, 24, 32, 48, 64.
    """
    allowed = [count for count in BAND_COUNTS if count <= max(largest, BAND_COUNTS[0])]
    return next((count for count in allowed if shift <= step * (count - 1)), allowed[-1])


def interpolation(traced: Numbers, wanted: Numbers) -> Numbers:
    """Return the weights of the polynomial in 1 / λ through values at traced wavelengths.

    Parameters
    ----------
    traced : ndarray, shape (W,)
        Metres, all different.
    wanted : ndarray, shape (M,)
        Metres.

    Returns
    -------
    ndarray of float64, shape (M, W)
        Lagrange's polynomials; each row sums to 1.
    """
    # Scaled to about 1, so that no product under- or overflows.
    known, sought = LOW / traced, LOW / wanted
    own = np.eye(len(known))
    # For each node the product over all others; the node's own factor is 1.
    above = sought[:, None, None] - known
    below = known[:, None] - known
    return np.asarray(np.prod((above * (1.0 - own) + own) / (below + own), axis=2))


def _bands(sampling: Sampling, count: int) -> Bands:
    """Gather the fine cells into bands even in 1 / λ², or around each traced wavelength."""
    cells, traced = sampling.cells, sampling.wavelengths
    if sampling.blended:
        fast, slow = (LOW / cells[0]) ** 2, (LOW / cells[-1]) ** 2
        place = (fast - (LOW / cells) ** 2) / (fast - slow) * count
        band = np.clip(place.astype(np.int64), 0, count - 1)
    else:
        band = np.searchsorted(0.5 * (traced[1:] + traced[:-1]), cells)
        count = len(traced)
    member = np.zeros((count, len(cells)))
    member[band, np.arange(len(cells))] = 1.0
    average = member * sampling.colours.sum(axis=1)
    lit = average.any(axis=1) if sampling.blended else np.ones(count, dtype=bool)
    mass = average[lit].sum(axis=1, keepdims=True)
    average = average[lit] / np.where(mass > 0.0, mass, 1.0)
    colours = member[lit] @ sampling.colours
    if not sampling.blended:
        return Bands(traced, colours, np.eye(count), np.arange(count), average)
    means = average @ cells
    nearest = np.argmin(np.abs(means[:, None] - traced), axis=1)
    return Bands(means, colours, interpolation(traced, means), nearest, average)


def _fine(spectrum: Spectrum) -> tuple[Numbers, Numbers]:
    """Return the middles and XYZ of fine cells over what is seen of a spectrum, or of its lines."""
    if spectrum.kind == "lines":
        return light.quadrature(spectrum)
    low, high = light.lit_range(spectrum, LOW, HIGH)
    edges = np.linspace(low, high, max(int(np.ceil((high - low) / STEP)), 1) + 1)
    colours = bands(spectrum, edges)
    return 0.5 * (edges[1:] + edges[:-1]), colours
