"""Spectra: from numbers, a single line, a black body.

Wavelengths are in metres. A spectrum of kind "power" is a density joined by straight lines and is
zero outside its samples; one of kind "lines" is a set of separate lines with their powers.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.records import Spectrum

KINDS = ("power", "lines")

# Exact since the SI of 2019 (CODATA 2018): 2hc² in W m² and hc/k in m K.
FIRST_RADIATION_CONSTANT = 2.0 * 6.62607015e-34 * 299792458.0**2
SECOND_RADIATION_CONSTANT = 6.62607015e-34 * 299792458.0 / 1.380649e-23

_EVERY_NANOMETRE = np.arange(300, 831) / 1e9


def spectrum(
    wavelengths: ArrayLike, values: ArrayLike, kind: str = "power", name: str = "spectrum"
) -> Spectrum:
    """Make a spectrum from samples.

    Parameters
    ----------
    wavelengths : array_like, shape (W,)
        Metres, positive and rising.
    values : array_like, shape (W,)
        Power per wavelength (kind "power") or power of each line (kind "lines"), none negative.
    kind : {"power", "lines"}
        A density joined by straight lines, or separate lines.
    name : str
        What to call it in reports.

    Returns
    -------
    Spectrum
        The spectrum; it owns its arrays.

    Raises
    ------
    refuse.Refusal
        Where the samples are not finite, not rising, negative, or all zero.
    """
    refuse.one_of("kind", kind, KINDS)
    positions = _numbers("wavelengths", wavelengths, None)
    powers = _numbers("values", values, positions.size)
    if positions[0] <= 0:
        raise refuse.Refusal(f"'wavelengths' must be > 0 (metres), got {positions[0]:g}.")
    falls = np.flatnonzero(np.diff(positions) <= 0)
    if falls.size:
        here, after = positions[falls[0]], positions[falls[0] + 1]
        raise refuse.Refusal(f"'wavelengths' must rise, got {here:g} followed by {after:g}.")
    if powers.min() < 0:
        raise refuse.Refusal(f"'values' must not be negative, got {powers.min():g}.")
    if not powers.any():
        raise refuse.Refusal("'values' must not all be zero: a spectrum needs some light.")
    if kind == "power" and positions.size < 2:
        raise refuse.Refusal("'wavelengths' needs two samples or more for kind 'power'; use kind 'lines'.")
    return Spectrum(positions, powers, kind, name)


def line(wavelength: float) -> Spectrum:
    """Make a spectrum of one line: monochromatic light.

    Parameters
    ----------
    wavelength : float
        Metres.

    Returns
    -------
    Spectrum
        Of kind "lines", with power 1.
    """
    wavelength = refuse.positive("wavelength", wavelength)
    return spectrum([wavelength], [1.0], "lines", f"{wavelength * 1e9:g} nm")


def black_body(kelvin: float) -> Spectrum:
    """Make the spectrum of a black body by Planck's law.

    L(λ) = (2hc²/λ⁵) / (exp(hc / (λ k T)) − 1), sampled every nanometre from 300 to 830 nm.

    Parameters
    ----------
    kelvin : float
        Temperature T.

    Returns
    -------
    Spectrum
        Spectral radiance in W m⁻² sr⁻¹ per metre of wavelength.

    Raises
    ------
    refuse.Refusal
        Where the temperature is not positive, or too low for any light.
    """
    kelvin = refuse.positive("kelvin", kelvin)
    decay = np.exp(-SECOND_RADIATION_CONSTANT / (_EVERY_NANOMETRE * kelvin))
    exitance = FIRST_RADIATION_CONSTANT / _EVERY_NANOMETRE**5 * decay / (1.0 - decay)
    return spectrum(_EVERY_NANOMETRE, exitance, name=f"black body at {kelvin:g} K")


def _numbers(name: str, values: ArrayLike, count: int | None) -> NDArray[np.float64]:
    found = refuse.all_finite(name, refuse.shape_of(name, values, (count,)))
    return np.array(found, dtype=np.float64)
