"""Zemax .zmx: sequential lenses of standard and even aspheric surfaces."""

from typing import Any

from aureole import refuse
from aureole.flare.import_draft import Draft, glass_keys, number

UNITS = {"MM": 1.0, "CM": 10.0, "IN": 25.4, "METER": 1000.0, "M": 1000.0}
TYPES = ("STANDARD", "EVENASPH")


def read(text: str, where: str) -> Draft:
    """Read the text of a .zmx file.

    Parameters
    ----------
    text : str
        The file.
    where : str
        Its name, for refusals.

    Returns
    -------
    Draft
        DIAM is a semi-diameter there, so semi-apertures are taken as they are.

    Raises
    ------
    aureole.refuse.Refusal
        At surfaces of other types, mirrors, and what is not a number.
    """
    draft = Draft(title="", source="A Zemax file.")
    scale, found = 1.0, []
    for line, raw in enumerate(text.splitlines(), 1):
        words = raw.split()
        if not words:
            continue
        key, rest = words[0].upper(), words[1:]
        if key == "SURF":
            found.append({"line": line, "type": "STANDARD", "parms": {}})
        elif found:
            _surface_key(found[-1], key, rest, where, line)
        elif key == "NAME":
            draft.title = raw.strip()[4:].strip()
        elif key == "UNIT" and rest:
            if rest[0].upper() not in UNITS:
                raise refuse.Refusal(f"'{where}' line {line}: unknown unit '{rest[0]}'.")
            scale = UNITS[rest[0].upper()]
        elif key == "FNUM" and rest and float(number(rest[0], where, line)) > 0:
            draft.f_number = number(rest[0], where, line)
        elif key == "ENPD" and rest:
            draft.entrance_diameter_mm = number(rest[0], where, line)
    # The first surface is the object, the last the image.
    draft.surfaces = [_surface(draft, surface, scale, where) for surface in found[1:-1]]
    if draft.entrance_diameter_mm is not None:
        draft.entrance_diameter_mm *= scale
    if scale != 1.0:
        draft.notes.append(f"lengths are multiplied by {scale:g} to be millimetres")
    return draft


def _surface_key(surface: dict[str, Any], key: str, rest: list[str], where: str, line: int) -> None:
    if key == "STOP":
        surface["stop"] = True
    elif key == "TYPE" and rest:
        surface["type"] = rest[0].upper()
    elif key in ("CURV", "DISZ", "DIAM", "CONI") and rest:
        infinite = rest[0].upper().startswith("INF")
        surface[key] = 0.0 if infinite else number(rest[0], where, line)
    elif key == "PARM" and len(rest) > 1:
        surface["parms"][int(number(rest[0], where, line))] = number(rest[1], where, line)
    elif key == "GLAS" and rest:
        surface["glass"] = rest[0]
        surface["numbers"] = [number(word, where, line) for word in rest[3:5]]


def _surface(draft: Draft, surface: dict[str, Any], scale: float, where: str) -> dict[str, Any]:
    if surface["type"] not in TYPES:
        kind, line = surface["type"], surface["line"]
        raise refuse.Refusal(f"'{where}' line {line}: surfaces of type {kind} cannot be read.")
    curvature = surface.get("CURV", 0.0)
    read: dict[str, Any] = {
        "radius_mm": scale / curvature if curvature else 0.0,
        "thickness_mm": scale * surface.get("DISZ", 0.0),
        "semi_aperture_mm": scale * surface.get("DIAM", 0.0),
        "conic": surface.get("CONI", 0.0),
        "stop": surface.get("stop", False),
    }
    if surface["type"] == "EVENASPH":
        read["asphere_mm"] = _terms(surface, scale, where)
    if "glass" in surface:
        read |= glass_keys(draft, surface["glass"], *(surface["numbers"] + [None, None])[:2])
    return read


def _terms(surface: dict[str, Any], scale: float, where: str) -> list[float]:
    """Return the coefficients of r⁴ on; PARM 1 is that of r²."""
    parms = surface["parms"]
    if parms.get(1, 0.0) != 0.0:
        raise refuse.Refusal(f"'{where}' line {surface['line']}: a term of r² cannot be read.")
    last = max((k for k, value in parms.items() if value), default=1)
    return [parms.get(k, 0.0) * scale ** (1 - 2 * k) for k in range(2, last + 1)]
