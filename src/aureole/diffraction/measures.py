"""How good an image a pupil makes: transfer functions, Strehl ratio, encircled energy, cut-off.

All four follow from the pupil's autocorrelation A (J. W. Goodman, "Introduction to Fourier Optics",
chapter 6): the optical transfer function at ν cycles per unit of sin θ is A(λν) / A(0). On a sensor at
the focal length f a frequency of ν / f cycles per metre. For light of many wavelengths the transfer
functions and the patterns are added up with the observer's luminance as their weight.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import aperture as apertures
from aureole import light as lights
from aureole import refuse
from aureole.diffraction.autocorrelation import autocorrelation
from aureole.diffraction.far import far_power
from aureole.records import Aperture, Grid, Spectrum

Light = float | Spectrum
RASTER_SIZE = 1024
# Wavelengths that stand for a spectrum, and directions that stand for a circle's half.
WAVELENGTHS = 31
DIRECTIONS = 256
# A wavelength with less of the luminance than this is left out.
UNSEEN = 1e-4
RIGHT_ANGLE = math.pi / 2


AXIS = Grid((1, 1), (1.0, 1.0))


@dataclass(frozen=True, eq=False)
class _Overlap:
    """A / A(0) at shifts of whole pixels, those downward, and a pixel's size in metres."""

    values: NDArray[np.complex128]
    pixel: float


def optical_transfer(
    aperture: Aperture,
    frequencies: ArrayLike,
    light: Light,
    angle: ArrayLike = 0.0,
    raster_size: int = RASTER_SIZE,
) -> NDArray[np.complex128]:
    """Return the optical transfer function of a pupil along one direction or several.

    Parameters
    ----------
    aperture : Aperture
        Outlines, or a raster with or without a wavefront.
    frequencies : array_like
        Cycles per unit of sin θ: those per metre on a sensor times the focal length.
    light : float or Spectrum
        A wavelength in metres, or a spectrum, whose luminance weighs the wavelengths.
    angle : array_like
        Direction along which the intensity varies, radians, counter-clockwise as seen from +x: 0 for
        vertical bars, π/2 for horizontal ones; broadcast against the frequencies.
    raster_size : int
        Pixels a side to which outlines are rasterized.

    Returns
    -------
    ndarray of complex128
        1 at frequency zero.

    Raises
    ------
    refuse.Refusal
        Where a number is not finite, or a wavefront cannot be served.
    """
    places, turns = refuse.all_finite("frequencies", frequencies), refuse.all_finite("angle", angle)
    # Points have y downward and angles turn counter-clockwise as seen.
    along_x, along_y = places * np.cos(turns), -places * np.sin(turns)
    raster, energy = _rastered(aperture, refuse.at_least("raster_size", raster_size, 1))
    total = np.zeros(along_x.shape, dtype=np.complex128)
    for wavelength, weight in _waves(light):
        overlap = _normalised(raster, _own(raster, wavelength), energy)
        total += weight * _at(overlap, wavelength * along_x, wavelength * along_y)
    return total


def mtf(
    aperture: Aperture,
    frequencies: ArrayLike,
    light: Light,
    angle: ArrayLike = 0.0,
    raster_size: int = RASTER_SIZE,
) -> NDArray[np.float64]:
    """Return the modulation transfer function of a pupil: the contrast that fine bars keep.

    Parameters
    ----------
    aperture : Aperture
        As for `optical_transfer`.
    frequencies : array_like
        As for `optical_transfer`.
    light : float or Spectrum
        As for `optical_transfer`.
    angle : array_like
        As for `optical_transfer`.
    raster_size : int
        As for `optical_transfer`.

    Returns
    -------
    ndarray of float64
        0 to 1: the modulus of the optical transfer function.
    """
    return np.abs(optical_transfer(aperture, frequencies, light, angle, raster_size))


def strehl(aperture: Aperture, light: Light) -> float:
    """Return the Strehl ratio: the intensity on the axis over that with a flat wavefront.

    Parameters
    ----------
    aperture : Aperture
        Any; without a wavefront the ratio is 1.
    light : float or Spectrum
        A wavelength in metres, or a spectrum, whose luminance weighs the wavelengths.

    Returns
    -------
    float
        0 to 1. A tilt moves the peak off the axis, and so counts as an error.

    Raises
    ------
    refuse.Refusal
        Where a wavefront cannot be served.
    """
    waves = _waves(light)
    if aperture.wavefront is None:
        return 1.0
    flat = apertures.area(aperture)
    # The density on the axis is |F(0)|² / λ².
    found = sum(
        weight / wavelength**2 * float(far_power(aperture, AXIS, "reference", wavelength=wavelength)[0, 0])
        for wavelength, weight in waves
    )
    return found / sum(weight / wavelength**2 * flat**2 for wavelength, weight in waves)


def encircled_energy(
    aperture: Aperture, radii: ArrayLike, light: Light, raster_size: int = RASTER_SIZE
) -> NDArray[np.float64]:
    """Return how much of the energy falls within circles about the axis.

    With ⟨A⟩ the mean of A / A(0) over directions, E(R) = 1 + ∫ ⟨A⟩'(t) J0(2π R t / λ) dt: no pattern is
    cut off at a border.

    Parameters
    ----------
    aperture : Aperture
        Outlines, or a raster with or without a wavefront.
    radii : array_like, shape (K,)
        R in units of sin θ, 0 or above; times the focal length metres on a sensor.
    light : float or Spectrum
        A wavelength in metres, or a spectrum, whose luminance weighs the wavelengths.
    raster_size : int
        Pixels a side to which outlines are rasterized.

    Returns
    -------
    ndarray of float64, shape (K,)
        Parts of the whole energy.

    Raises
    ------
    refuse.Refusal
        Where a radius is below zero or not finite, or a wavefront cannot be served.
    """
    from scipy.special import j0

    places = refuse.all_finite("radii", refuse.shape_of("radii", radii, (None,)))
    if places.min() < 0:
        raise refuse.Refusal(f"'radii' must be numbers >= 0, got {places.min():g}.")
    raster, energy = _rastered(aperture, refuse.at_least("raster_size", raster_size, 1))
    total = np.zeros(len(places))
    for wavelength, weight in _waves(light):
        shifts, mean = _mean_over_directions(raster, _own(raster, wavelength), energy)
        middles = (shifts[1:] + shifts[:-1]) / 2
        waves = j0(2 * np.pi / wavelength * np.outer(places, middles))
        total += weight * (1 + waves @ np.diff(mean))
    return total


def cutoff_frequency(aperture: Aperture, wavelength: float, angle: float = 0.0) -> float:
    """Return the finest frequency along a direction that a pupil passes at all.

    Parameters
    ----------
    aperture : Aperture
        Outlines, or a raster.
    wavelength : float
        Metres.
    angle : float
        Direction along which the intensity varies, radians, counter-clockwise as seen from +x; for a
        raster a multiple of π/2.

    Returns
    -------
    float
        Cycles per unit of sin θ: the longest distance between two open places along the direction over
        the wavelength, to a pixel in 1024 (1 / (λ N) of a circle at f-number N, times the focal length).

    Raises
    ------
    refuse.Refusal
        Where a raster would have to be turned.
    """
    refuse.positive("wavelength", wavelength)
    quarters = round(refuse.finite("angle", angle) / RIGHT_ANGLE)
    if aperture.mask is None:
        aperture = apertures.rotated(aperture, -angle)
        quarters = 0
    elif abs(angle - quarters * RIGHT_ANGLE) > 1e-9:
        raise refuse.Refusal("a raster's cut-off is known along its rows and columns: 'angle' 0 or π/2.")
    mask = apertures.rasterize(aperture, RASTER_SIZE if aperture.mask is None else len(aperture.mask))
    rows = np.asarray(mask.T if quarters % 2 else mask, dtype=np.float64) / mask.max()
    rows = rows[rows.any(axis=1)]
    first, last = np.argmax(rows > 0, axis=1), rows.shape[1] - 1 - np.argmax(rows[:, ::-1] > 0, axis=1)
    at = np.arange(len(rows))
    # The pixels at both ends count by the part of them that is open.
    lengths = np.where(last > first, last - first - 1 + rows[at, first] + rows[at, last], rows[at, first])
    return float(lengths.max() * aperture.width / rows.shape[1] / wavelength)


@lru_cache(maxsize=4)
def _rastered(aperture: Aperture, size: int) -> tuple[Aperture, float]:
    """Return an aperture's raster, and its energy: that of the exact outlines where there are any."""
    energy = apertures.energy(aperture)
    if aperture.mask is not None:
        return aperture, energy
    mask = apertures.rasterize(aperture, size)
    return Aperture(aperture.width, mask=mask, name=aperture.name), energy


def _waves(light: Light) -> list[tuple[float, float]]:
    """Return wavelengths and their shares of the luminance."""
    if not isinstance(light, Spectrum):
        return [(refuse.positive("light", light), 1.0)]
    wavelengths, weights = lights.quadrature(light, WAVELENGTHS)
    seen = weights[:, 1] > UNSEEN * weights[:, 1].sum()
    luminance = weights[seen, 1] / weights[seen, 1].sum()
    return [(float(each), float(share)) for each, share in zip(wavelengths[seen], luminance, strict=True)]


def _own(raster: Aperture, wavelength: float) -> float | None:
    """Return the wavelength where a wavefront makes each one's autocorrelation another."""
    return None if raster.wavefront is None else wavelength


@lru_cache(maxsize=1)
def _normalised(raster: Aperture, wavelength: float | None, energy: float) -> _Overlap:
    """Return A / A(0) at shifts of whole pixels, as `autocorrelation` lays them out."""
    shifted = autocorrelation(raster, wavelength) / energy
    # Grey pixels on a rim hold less energy than the parts of them that are open.
    shifted[0, shifted.shape[0] - 1] = 1
    return _Overlap(shifted, raster.width / len(shifted))


def _at(overlap: _Overlap, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Interpolate A at shifts in metres, exactly as squares overlap."""
    # A(−τ) is the conjugate of A(τ), and only shifts downward are kept.
    turn = np.where(y < 0, -1.0, 1.0)
    real = _interpolated(overlap.values.real, turn * x / overlap.pixel, turn * y / overlap.pixel)
    imaginary = _interpolated(overlap.values.imag, turn * x / overlap.pixel, turn * y / overlap.pixel)
    return np.asarray(real + 1j * turn * imaginary)


def _interpolated(
    values: NDArray[np.float64], x: NDArray[np.float64], y: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Interpolate along straight lines between shifts of whole pixels; nothing overlaps beyond them."""
    from scipy.ndimage import map_coordinates

    places = np.stack([np.ravel(y), np.ravel(x) + len(values) - 1])
    found = map_coordinates(values, places, order=1, mode="grid-constant", cval=0.0)
    return np.asarray(found).reshape(np.shape(x))


@lru_cache(maxsize=64)
def _mean_over_directions(
    raster: Aperture, wavelength: float | None, energy: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return shifts in metres and the mean of A / A(0) over all directions, which is real."""
    overlap = _normalised(raster, wavelength, energy)
    shifts = np.arange(math.ceil(math.sqrt(2) * len(overlap.values)) + 2)
    angles = (np.arange(DIRECTIONS) + 0.5) * np.pi / DIRECTIONS
    x, y = np.outer(shifts, np.cos(angles)), np.outer(shifts, np.sin(angles))
    values = _interpolated(overlap.values.real, x, y)
    return np.asarray(shifts * overlap.pixel), np.asarray(values.mean(axis=1))
