"""FlareSim .lens: a table of surfaces whose fifth column holds clear diameters."""

import re
from typing import Any

from aureole import refuse
from aureole.flare.import_draft import Draft, number

MGF2 = {"mgf2": [{"index": 1.38, "quarter_wave_nm": 550.0}]}
# Which of our axes is curved: the name there says along which axis the cylinder lies.
CYLINDERS = {"cyl_y": "x", "cyl_x": "y"}


def read(text: str, where: str) -> Draft:
    """Read the text of a .lens file.

    Parameters
    ----------
    text : str
        The file.
    where : str
        Its name, for refusals.

    Returns
    -------
    Draft
        The column "semi_ap" of the published files holds diameters and is halved; coatings are taken as
        listed, except between two glasses.

    Raises
    ------
    aureole.refuse.Refusal
        At toric surfaces and what is not a number.
    """
    draft = Draft(title="", source="A FlareSim lens file.")
    stated = re.search(r"\bf/(\d+(?:\.\d+)?)", text, flags=re.IGNORECASE)
    draft.f_number = float(stated[1]) if stated and float(stated[1]) > 0 else None
    patent = re.search(r"^#\s*Patent:\s*(\S.*)$", text, flags=re.MULTILINE)
    draft.patent = patent[1].strip() if patent else ""
    inside = False
    for line, raw in enumerate(text.splitlines(), 1):
        body = raw.partition("#")[0].strip()
        key, colon, value = body.partition(":")
        if colon and key.strip() == "surfaces":
            inside = True
        elif colon and key.strip() == "name":
            draft.title = value.strip()
        elif colon and key.strip() == "focal_length":
            draft.focal_length_mm = number(value, where, line)
        elif body and inside:
            draft.surfaces.append(_surface(body.split(), where, line))
    _coat(draft)
    draft.notes.append("the column 'semi_ap' holds diameters: semi-apertures are half of it")
    return draft


def _surface(words: list[str], where: str, line: int) -> dict[str, Any]:
    if len(words) < 5:
        raise refuse.Refusal(f"'{where}' line {line}: a surface needs five columns, got {len(words)}.")
    stop = words[0].lower() == "stop"
    radius = 0.0 if stop else number(words[0], where, line)
    thickness, index, abbe, diameter = (number(word, where, line) for word in words[1:5])
    found: dict[str, Any] = {
        "radius_mm": radius,
        "thickness_mm": thickness,
        "semi_aperture_mm": diameter / 2,
        "stop": stop,
    }
    if index != 1.0:
        found |= {"index": index} | ({"abbe": abbe} if abbe > 0 else {})
    if len(words) > 6:
        if words[6] not in CYLINDERS:
            raise refuse.Refusal(f"'{where}' line {line}: surfaces of type '{words[6]}' cannot be read.")
        found["cylinder"] = CYLINDERS[words[6]]
    if len(words) > 5 and number(words[5], where, line) > 0 and not stop:
        found["coating"] = "mgf2"
    return found


def _coat(draft: Draft) -> None:
    """Keep the film of magnesium fluoride where the table has one and a side is air."""
    cemented, before = 0, False
    for surface in draft.surfaces:
        behind = "index" in surface
        if before and behind and surface.pop("coating", None):
            cemented += 1
        before = behind
    if any("coating" in surface for surface in draft.surfaces):
        draft.coatings = dict(MGF2)
    if cemented:
        draft.notes.append(f"cemented surfaces that are coated in the file, bare here: {cemented}")
