"""Named conversions for the edges: text with a unit in, SI numbers and radians out.

Inside the library every length is in metres, every angle in radians, every time in seconds.
Only the command line, the files from outside and the printed reports use other units, and they
convert here.
"""

import math
import re

from aureole import refuse

LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "nm": 1e-9}
LUMINANCES = {"cd/m²": 1.0, "nit": 1.0, "nits": 1.0, "mcd/m²": 1e-3, "kcd/m²": 1e3}
TIMES = {"": 1.0, "s": 1.0, "ms": 1e-3}
_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([^\s\d.]*)\s*")


def length(text: str, name: str, example: str) -> float:
    """Read a length that carries its unit.

    Parameters
    ----------
    text : str
        A number with one of the units m, cm, mm, um (or µm), nm: "50mm", "0.55 um".
    name : str
        What the length is, for the refusal.
    example : str
        A value with the unit that fits, for the refusal.

    Returns
    -------
    float
        The length in metres.

    Raises
    ------
    refuse.Refusal
        Where the text is not a number with a unit of length.
    """
    number, unit = _split(text, name, f"a length with its unit, such as {example}")
    if not unit:
        raise refuse.Refusal(f"'{name}' needs a unit (m, cm, mm, um or nm), got {text}; write {example}.")
    if unit not in LENGTHS:
        raise refuse.Refusal(f"'{name}' has an unknown unit '{unit}' in {text}; use m, cm, mm, um or nm.")
    return number * LENGTHS[unit]


def angle(text: str, name: str) -> float:
    """Read an angle in degrees, with or without the unit.

    Parameters
    ----------
    text : str
        "10", "10deg" or "0.2rad".
    name : str
        What the angle is, for the refusal.

    Returns
    -------
    float
        The angle in radians.

    Raises
    ------
    refuse.Refusal
        Where the text is not an angle.
    """
    number, unit = _split(text, name, "an angle in degrees, such as 10deg")
    if unit in ("", "deg", "°"):
        return math.radians(number)
    if unit == "rad":
        return number
    raise refuse.Refusal(f"'{name}' has an unknown unit '{unit}' in {text}; use deg or rad.")


def luminance(text: str, name: str) -> float:
    """Read a luminance that carries its unit.

    Parameters
    ----------
    text : str
        "10cd/m2", "10 cd/m²", "10nit", "2kcd/m2" or "0.5mcd/m2".
    name : str
        What the luminance is, for the refusal.

    Returns
    -------
    float
        Candela per square metre, none below zero.

    Raises
    ------
    refuse.Refusal
        Where the text is not a number with a unit of luminance, or is below zero.
    """
    number, unit = _split(
        text.replace("m^2", "m²").replace("m2", "m²"), name, "a luminance with its unit, such as 10cd/m2"
    )
    if not unit:
        raise refuse.Refusal(f"'{name}' needs a unit (cd/m2 or nit), got {text}; write 10cd/m2.")
    if unit not in LUMINANCES:
        raise refuse.Refusal(f"'{name}' has an unknown unit '{unit}' in {text}; use cd/m2 or nit.")
    if number < 0:
        raise refuse.Refusal(f"'{name}' must be a luminance >= 0, got {text}.")
    return number * LUMINANCES[unit]


def seconds(text: str, name: str) -> float:
    """Read a time in seconds, with or without the unit.

    Parameters
    ----------
    text : str
        "1.5", "1.5s" or "500ms".
    name : str
        What the time is, for the refusal.

    Returns
    -------
    float
        Seconds.

    Raises
    ------
    refuse.Refusal
        Where the text is not a time.
    """
    number, unit = _split(text, name, "a time in seconds, such as 1.5s or 500ms")
    if unit not in TIMES:
        raise refuse.Refusal(f"'{name}' has an unknown unit '{unit}' in {text}; use s or ms.")
    return number * TIMES[unit]


def metres_as_text(value: float) -> str:
    """Write a length with the unit that keeps its number readable, for reports.

    Parameters
    ----------
    value : float
        A length in metres.

    Returns
    -------
    str
        Such as "3.125 mm" or "550 nm".
    """
    for unit, scale in (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6)):
        if abs(value) >= scale:
            return f"{value / scale:.4g} {unit}"
    return f"{value / 1e-9:.4g} nm"


def _split(text: str, name: str, wanted: str) -> tuple[float, str]:
    """Split a quantity into its finite number and the text of its unit."""
    match = _QUANTITY.fullmatch(text)
    if match is None or not math.isfinite(float(match[1])):
        raise refuse.Refusal(f"'{name}' must be {wanted}, got {text!r}.")
    return float(match[1]), match[2]
