"""Glass: the refractive index at any wavelength, from a catalogue's constants or from n_d and V_d."""

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import presets, refuse

# The lines of helium and hydrogen between which Abbe's number is measured (ISO 7944), metres.
D_LINE, F_LINE, C_LINE = 587.5618e-9, 486.1327e-9, 656.2725e-9


@dataclass(frozen=True)
class Glass:
    """A transparent medium.

    Parameters
    ----------
    name : str
        As the catalogue calls it; empty where it is known by its numbers alone.
    index : float
        n_d, at 587.5618 nm, relative to air.
    abbe : float, optional
        V_d = (n_d - 1) / (n_F - n_C); None for a medium without dispersion.
    b : tuple of float
        Sellmeier's numerators; empty where they are not known.
    c : tuple of float
        Sellmeier's squared wavelengths of resonance, square metres.
    """

    name: str
    index: float
    abbe: float | None = None
    b: tuple[float, ...] = ()
    c: tuple[float, ...] = ()


AIR = Glass("air", 1.0)


def of_numbers(index: float, abbe: float | None = None) -> Glass:
    """Return the glass of an index and an Abbe number.

    Parameters
    ----------
    index : float
        n_d, at least 1.
    abbe : float, optional
        V_d; without it the index is the same at every wavelength.

    Returns
    -------
    Glass
        `AIR` for an index of 1.

    Raises
    ------
    refuse.Refusal
        Where the index is below 1 or over 5, or the Abbe number is not above zero.
    """
    refuse.between("index", index, 1.0, 5.0)
    if abbe is not None:
        refuse.positive("abbe", abbe)
    return AIR if index == 1.0 else Glass("", float(index), abbe)


@functools.cache
def catalogue() -> dict[str, Glass]:
    """Return all glasses that come with Aureole, by their names in upper case.

    Returns
    -------
    dict of str to Glass
        Of Schott, Ohara, and crystals.
    """
    found = {}
    for maker in presets.names("glasses"):
        for name, line in presets.load("glasses", maker).glasses.items():
            squares = tuple(1e-12 * c for c in line.c_um2)
            found[name.upper()] = Glass(name, line.index, line.abbe, tuple(line.b), squares)
    return found


def named(name: str) -> Glass:
    """Return a glass of the catalogue.

    Parameters
    ----------
    name : str
        Such as "N-BK7"; large and small letters are the same.

    Returns
    -------
    Glass
        With its Sellmeier constants.

    Raises
    ------
    refuse.Refusal
        Where no catalogue has it, with the nearest name.
    """
    known = catalogue()
    if name.upper() == "AIR":
        return AIR
    if name.upper() not in known:
        raise refuse.unknown_key("the catalogue of glasses", name.upper(), known)
    return known[name.upper()]


def index(glass: Glass, wavelengths: ArrayLike) -> NDArray[np.float64]:
    """Return the refractive index.

    Sellmeier (1871) where the glass has constants: n² = 1 + Σ B λ² / (λ² - C). Otherwise Cauchy (1836),
    n = A + B / λ², through n_d with the slope that the Abbe number asks for.

    Parameters
    ----------
    glass : Glass
        The medium.
    wavelengths : array_like
        Metres, in air.

    Returns
    -------
    ndarray of float64, shape of wavelengths
        Relative to air.

    Raises
    ------
    refuse.Refusal
        Where a wavelength is not above zero, or lies so near a resonance that the formula fails.
    """
    waves = refuse.all_finite("wavelengths", np.asarray(wavelengths, dtype=np.float64))
    if waves.size and waves.min() <= 0:
        raise refuse.Refusal(f"'wavelengths' must be > 0 (metres), got {waves.min():g}.")
    if glass.b:
        terms = zip(glass.b, glass.c, strict=True)
        with np.errstate(divide="ignore"):
            square = 1.0 + sum((b * waves**2 / (waves**2 - c) for b, c in terms), np.zeros_like(waves))
        if not np.all((square >= 1.0) & np.isfinite(square)):
            raise refuse.Refusal(f"the glass '{glass.name}' is not transparent at each of 'wavelengths'.")
        return np.asarray(np.sqrt(square))
    if glass.abbe is None:
        return np.full_like(waves, glass.index)
    slope = (glass.index - 1.0) / (glass.abbe * (F_LINE**-2 - C_LINE**-2))
    return np.asarray(glass.index + slope * (waves**-2.0 - D_LINE**-2))


def abbe_number(glass: Glass) -> float:
    """Return V_d as it follows from the glass's own formula.

    Parameters
    ----------
    glass : Glass
        The medium.

    Returns
    -------
    float
        (n_d - 1) / (n_F - n_C); infinity without dispersion.
    """
    n_d, n_f, n_c = index(glass, [D_LINE, F_LINE, C_LINE])
    return float((n_d - 1.0) / (n_f - n_c)) if n_f != n_c else float("inf")
