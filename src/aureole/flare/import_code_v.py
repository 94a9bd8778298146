"""CODE V .seq: lenses of spherical, conic and aspheric surfaces, as command sequences."""

from collections.abc import Iterator
from typing import Any

from aureole import refuse
from aureole.flare.import_draft import Draft, glass_keys, number

UNITS = {"M": 1.0, "C": 10.0, "I": 25.4}
# Coefficients of r⁴, r⁶, ... in the polynomial asphere.
LETTERS = "ABCDEFGHJ"
NOT_READ = ("XDE", "YDE", "ZDE", "ADE", "BDE", "CDE", "BEN", "DAR", "CYL", "XTO", "YTO", "SPS", "DIF", "GRT")


def read(text: str, where: str) -> Draft:
    """Read the text of a .seq file.

    Parameters
    ----------
    text : str
        The file.
    where : str
        Its name, for refusals.

    Returns
    -------
    Draft
        CIR is a semi-aperture there; surfaces without one get theirs from the entrance pupil.

    Raises
    ------
    aureole.refuse.Refusal
        At tilted or unusual surfaces, mirrors, and what is not a number.
    """
    draft = Draft(title="", source="A CODE V file.")
    scale, radius_mode, ended = 1.0, False, False
    for line, raw, words in _commands(text):
        key, rest = words[0].upper(), words[1:]
        if key == "RDM":
            radius_mode = not rest or rest[0].upper() != "N"
        elif key == "TITLE" or key == "TIT":
            draft.title = raw.partition(" ")[2].strip().strip("'\"").strip()
        elif key == "DIM" and rest:
            scale = UNITS.get(rest[0].upper(), 1.0)
        elif key == "EPD" and rest:
            draft.entrance_diameter_mm = number(rest[0], where, line)
        elif key == "FNO" and rest:
            draft.f_number = number(rest[0], where, line)
        elif key == "SI":
            ended = True
        elif key == "S" and not ended:
            draft.surfaces.append(_surface(draft, rest, radius_mode, where, line))
        elif draft.surfaces and not ended:
            _surface_key(draft.surfaces[-1], key, rest, where, line)
    _scale(draft, scale)
    return draft


def _commands(text: str) -> Iterator[tuple[int, str, list[str]]]:
    """Yield line, command and its words; a semicolon ends a command, an ampersand joins lines, ! comments."""
    joined = ""
    for line, raw in enumerate(text.splitlines(), 1):
        joined += raw.partition("!")[0].strip()
        if joined.endswith("&"):
            joined = joined[:-1] + " "
            continue
        for command in joined.split(";"):
            if command.split():
                yield line, command.strip(), command.split()
        joined = ""


def _surface(draft: Draft, words: list[str], radius_mode: bool, where: str, line: int) -> dict[str, Any]:
    if len(words) < 2:
        raise refuse.Refusal(f"'{where}' line {line}: a surface needs its radius and its thickness.")
    first = number(words[0], where, line)
    radius = first if radius_mode or first == 0 else 1.0 / first
    found: dict[str, Any] = {"radius_mm": radius, "thickness_mm": number(words[1], where, line)}
    return found | (glass_keys(draft, words[2]) if len(words) > 2 else {})


def _surface_key(surface: dict[str, Any], key: str, rest: list[str], where: str, line: int) -> None:
    if key in NOT_READ:
        raise refuse.Refusal(f"'{where}' line {line}: '{key}' cannot be read; surfaces about one axis can.")
    if key == "STO":
        surface["stop"] = True
    elif key == "CIR" and rest:
        # CIR EDG is where the glass ends, not where light does.
        if rest[0].upper() not in ("EDG", "OBS", "HOL"):
            surface["semi_aperture_mm"] = number(rest[-1], where, line)
    elif key == "K" and rest:
        surface["conic"] = number(rest[0], where, line)
    elif len(key) == 1 and key in LETTERS and rest:
        terms = surface.setdefault("asphere_mm", [])
        place = LETTERS.index(key)
        terms.extend([0.0] * (place + 1 - len(terms)))
        terms[place] = number(rest[0], where, line)


def _scale(draft: Draft, scale: float) -> None:
    if scale == 1.0:
        return
    for surface in draft.surfaces:
        for key in ("radius_mm", "thickness_mm", "semi_aperture_mm"):
            if key in surface:
                surface[key] *= scale
        terms = surface.get("asphere_mm", [])
        surface["asphere_mm"] = [a * scale ** (-3 - 2 * m) for m, a in enumerate(terms)]
    if draft.entrance_diameter_mm is not None:
        draft.entrance_diameter_mm *= scale
    draft.notes.append(f"lengths are multiplied by {scale:g} to be millimetres")
