"""What is read from another program's lens file, and what is added so that it is a whole lens."""

import math
import re
from dataclasses import dataclass, field
from typing import Any

from aureole import presets, refuse
from aureole.flare import glass, paraxial
from aureole.flare.prescription import MM_PER_M, Lens, from_preset

# Semi-apertures that are not given reach so far beyond the rays on the axis.
MARGIN = 1.1
PLACEHOLDER_MM = 1e-6
LEAST_NUMBER_OF_SURFACES = 2


@dataclass
class Draft:
    """A lens as its file says it, not yet checked.

    Parameters
    ----------
    title : str
        Its name in the file.
    source : str
        Which program's file it was.
    surfaces : list of dict
        Keys and values as in `aureole.presets.SurfacePreset`; "semi_aperture_mm" may be missing.
    focal_length_mm, f_number, entrance_diameter_mm : float, optional
        As far as the file says.
    sensor_mm : list of float, optional
        Width and height.
    patent : str
        As the file says.
    coatings : dict
        As in `aureole.presets.LensPreset`.
    notes : list of str
        What was converted, a line each.
    """

    title: str
    source: str
    surfaces: list[dict[str, Any]] = field(default_factory=list)
    focal_length_mm: float | None = None
    f_number: float | None = None
    entrance_diameter_mm: float | None = None
    sensor_mm: list[float] | None = None
    patent: str = ""
    coatings: dict[str, Any] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def finish(draft: Draft, where: str) -> Lens:
    """Return the lens of a draft; what the file leaves out is computed near the axis, and noted.

    Parameters
    ----------
    draft : Draft
        As read; its notes grow.
    where : str
        The file, for refusals and as the lens's name.

    Returns
    -------
    Lens
        Checked.

    Raises
    ------
    refuse.Refusal
        Where it is no lens.
    """
    _merge_marks(draft)
    if len(draft.surfaces) < LEAST_NUMBER_OF_SURFACES:
        raise refuse.Refusal(f"'{where}' holds no lens: {len(draft.surfaces)} surfaces were found.")
    missing = [line for line in draft.surfaces if not line.get("semi_aperture_mm")]
    for line in missing:
        line["semi_aperture_mm"] = PLACEHOLDER_MM
    on_focus = draft.surfaces[-1].get("thickness_mm", 0) <= 0
    if on_focus:
        draft.surfaces[-1]["thickness_mm"] = 1.0
    lens = _lens(draft, where)
    if on_focus:
        focus = _positive(where, "focus behind the last surface", paraxial.back_focus(lens))
        draft.surfaces[-1]["thickness_mm"] = _rounded(focus)
        draft.notes.append(f"the sensor is set to the focus, {focus * MM_PER_M:.5g} mm behind the lens")
    if draft.focal_length_mm is None:
        focal = _positive(where, "focal length", paraxial.focal_length(lens))
        draft.focal_length_mm = _rounded(focal)
        draft.notes.append(f"the focal length is computed: {draft.focal_length_mm:.5g} mm")
    if missing:
        _fill_semi_apertures(draft, lens, where, missing)
    if draft.f_number is None:
        draft.f_number = round(paraxial.f_number(_lens(draft, where)), 3)
        draft.notes.append(f"the f-number is that of the semi-apertures: {draft.f_number:.3g}")
    if draft.sensor_mm is None:
        draft.notes.append("the file names no sensor: 36 mm x 24 mm is set")
    return _lens(draft, where)


def glass_keys(
    draft: Draft, name: str, index: float | None = None, abbe: float | None = None
) -> dict[str, Any]:
    """Return the keys for a medium that a file calls by name.

    Parameters
    ----------
    draft : Draft
        Takes a note where the name is not taken as it stands.
    name : str
        Such as "N-BK7", "NBK7_SCHOTT", "BK7" or the code "517.642".
    index, abbe : float, optional
        n_d and V_d that the file gives beside the name, for names that no catalogue has.

    Returns
    -------
    dict
        "glass", or "index" and "abbe"; empty for air.

    Raises
    ------
    refuse.Refusal
        Where the name is unknown and no numbers are given, or the surface is a mirror.
    """
    word = name.strip().strip("'\"").upper()
    if word.startswith("_") and index is not None:
        # Zemax calls a glass that is known by its numbers alone ___BLANK.
        return {"index": index} | ({"abbe": abbe} if abbe and abbe > 0 else {})
    word = word.partition("_")[0]
    if word in ("", "AIR", "VACUUM"):
        return {}
    if word in ("REFL", "MIRROR"):
        raise refuse.Refusal(f"'{draft.title}' has mirrors; only lenses can be read.")
    code = re.fullmatch(r"(\d{3})\.?(\d{3})(?:\.\d*)?", word)
    if code:
        return {"index": 1 + int(code[1]) / 1000, "abbe": int(code[2]) / 10}
    by_letters = {known.replace("-", ""): known for known in glass.catalogue()}
    for candidate in (word.replace("-", ""), "N" + word.replace("-", "")):
        if candidate in by_letters:
            found = by_letters[candidate]
            if candidate != word.replace("-", ""):
                draft.notes.append(f"glass {word} is taken as {found}")
            return {"glass": glass.named(found).name}
    if index is not None and index > 1:
        draft.notes.append(
            f"glass {word} is in no catalogue here: the file's n_d {index:.6g} and V_d are used"
        )
        return {"index": index} | ({"abbe": abbe} if abbe and abbe > 0 else {})
    return {"glass": glass.named(word).name}


def number(text: str, where: str, line: int | None = None) -> float:
    """Return a number, or refuse with the line that holds something else.

    Parameters
    ----------
    text : str
        As it stands in the file.
    where : str
        The file.
    line : int, optional
        Counted from 1.

    Returns
    -------
    float
        Finite.

    Raises
    ------
    refuse.Refusal
        Where it is none.
    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        place = f" line {line}" if line is not None else ""
        raise refuse.Refusal(f"'{where}'{place}: a number is needed, got '{text.strip()[:40]}'.")
    return value


def _merge_marks(draft: Draft) -> None:
    """Take out planes in air that only mark a place; their distances go to the surface before."""
    kept: list[dict[str, Any]] = []
    marks = 0
    for line in draft.surfaces:
        in_air = not (_medium(kept[-1]) if kept else {}) and not _medium(line)
        if line.get("radius_mm", 0) == 0 and in_air and not line.get("stop") and not line.get("asphere_mm"):
            marks += 1
            if kept:
                kept[-1]["thickness_mm"] = kept[-1].get("thickness_mm", 0) + line.get("thickness_mm", 0)
        else:
            kept.append(line)
    draft.surfaces = kept
    if marks:
        draft.notes.append(f"planes in air that only mark a place, left out: {marks}")


def _medium(line: dict[str, Any]) -> dict[str, Any]:
    return {key: line[key] for key in ("glass", "index") if key in line}


def _lens(draft: Draft, where: str) -> Lens:
    data = {
        "title": draft.title or "Without a name",
        "source": draft.source,
        "patent": draft.patent,
        "notes": " ".join(f"{note[:1].upper()}{note[1:]}." for note in draft.notes),
        "focal_length_mm": draft.focal_length_mm or 1.0,
        "f_number": draft.f_number or 1.0,
        "sensor_mm": draft.sensor_mm or [36.0, 24.0],
        "coatings": draft.coatings,
        "surfaces": draft.surfaces,
    }
    return from_preset(presets.check("lenses", data, where), where)


def _fill_semi_apertures(draft: Draft, lens: Lens, where: str, missing: list[dict[str, Any]]) -> None:
    """Let pass what the pupil lets in; without one, what the given semi-apertures do."""
    assert draft.focal_length_mm is not None
    heights = [abs(float(found[0, 0])) for found in paraxial.heights(lens)]
    if draft.entrance_diameter_mm is not None:
        radius = draft.entrance_diameter_mm / 2
    elif draft.f_number is not None:
        radius = abs(draft.focal_length_mm) / (2 * draft.f_number)
    else:
        given = [
            line["semi_aperture_mm"] / max(height, 1e-9)
            for line, height in zip(draft.surfaces, heights, strict=True)
            if all(line is not other for other in missing)
        ]
        if not given:
            raise refuse.Refusal(f"'{where}' gives neither semi-apertures nor an f-number.")
        radius = min(given)
    for line, height in zip(draft.surfaces, heights, strict=True):
        if any(line is other for other in missing):
            margin = 1.0 if line.get("stop") else MARGIN
            line["semi_aperture_mm"] = float(f"{margin * height * radius:.5g}")
    draft.notes.append(f"semi-apertures not in the file, set by the light on the axis: {len(missing)}")


def _positive(where: str, what: str, metres: float) -> float:
    if not (math.isfinite(metres) and metres > 0):
        raise refuse.Refusal(f"'{where}' has no {what}: are the signs of its radii right?")
    return metres


def _rounded(metres: float) -> float:
    return round(metres * MM_PER_M, 6)
