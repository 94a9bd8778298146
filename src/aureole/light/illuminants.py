"""Illuminants by name: the CIE's tables and formulas, and black bodies and lines written as text."""

import re
from collections.abc import Callable
from functools import cache, partial

import numpy as np

from aureole import refuse, units
from aureole.light.spectra import black_body, line, spectrum
from aureole.light.tables import table
from aureole.records import Spectrum

_KELVIN = re.compile(r"(\d+\.?\d*)\s*K?", re.IGNORECASE)


def illuminant(name: str) -> Spectrum:
    """Return an illuminant by its name, a black body by its temperature, a line by its wavelength.

    Parameters
    ----------
    name : str
        One of `ILLUMINANTS`, or "blackbody:3200K", or "line:550nm".

    Returns
    -------
    Spectrum
        Relative power; zero outside the wavelengths that its table has.

    Raises
    ------
    refuse.Refusal
        Where there is no such illuminant.

    Notes
    -----
    "F1" is the lamp that CIE 15:2018 calls FL1. "A" and "D65" reach from 300 to 830 nm, "F1" and
    the light-emitting diodes "LED-B1" (2733 K) to "LED-B5" (6598 K) from 380 to 780 nm.
    """
    word, _, amount = name.partition(":")
    if word == "blackbody" and amount:
        return black_body(_kelvin(amount))
    if word == "line" and amount:
        return line(units.length(amount, "wavelength", "550nm"))
    refuse.one_of("illuminant", name, (*ILLUMINANTS, "blackbody:3200K", "line:550nm"))
    return ILLUMINANTS[name]()


@cache
def _equal_energy() -> Spectrum:
    return spectrum([300e-9, 830e-9], [1.0, 1.0], name="E")


@cache
def _incandescent() -> Spectrum:
    """Evaluate the formula that defines illuminant A (ISO/CIE 11664-2, Eq. 1), 100 at 560 nm."""
    nanometres = np.arange(300.0, 831.0)
    at_560 = np.expm1(1.435e7 / (2848.0 * 560.0))
    values = 100.0 * (560.0 / nanometres) ** 5 * at_560 / np.expm1(1.435e7 / (2848.0 * nanometres))
    return spectrum(nanometres / 1e9, values, name="A")


@cache
def _daylight() -> Spectrum:
    wavelengths, values = table("illuminant_d65")
    return spectrum(wavelengths, values[:, 0], name="D65")


@cache
def _fluorescent() -> Spectrum:
    wavelengths, values = table("illuminant_fl1")
    return spectrum(wavelengths, values[:, 0], name="F1")


@cache
def _diode(number: int) -> Spectrum:
    wavelengths, values = table("illuminant_led_b")
    return spectrum(wavelengths, values[:, number - 1], name=f"LED-B{number}")


ILLUMINANTS: dict[str, Callable[[], Spectrum]] = {
    "E": _equal_energy,
    "A": _incandescent,
    "D65": _daylight,
    "F1": _fluorescent,
    **{f"LED-B{number}": partial(_diode, number) for number in range(1, 6)},
}


def _kelvin(text: str) -> float:
    match = _KELVIN.fullmatch(text.strip())
    if match is None:
        raise refuse.Refusal(f"'blackbody' must be a temperature in kelvin, such as 3200K, got '{text}'.")
    return float(match[1])
