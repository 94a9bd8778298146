"""realflare .json: lens models with heights, an aperture's index, no coatings."""

import json
from typing import Any

from aureole import refuse
from aureole.flare.import_draft import Draft

KEYS = ("radius", "distance", "height", "refractive_index", "abbe_nr")


def read(text: str, where: str) -> Draft:
    """Read the text of a realflare lens model.

    Parameters
    ----------
    text : str
        The file.
    where : str
        Its name, for refusals.

    Returns
    -------
    Draft
        Heights there are semi-apertures.

    Raises
    ------
    aureole.refuse.Refusal
        Where it is no such model.
    """
    try:
        model = json.loads(text)
    except (ValueError, RecursionError):
        raise refuse.Refusal(f"'{where}' is not JSON.") from None
    elements = model.get("lens_elements") if isinstance(model, dict) else None
    if not isinstance(elements, list) or not all(isinstance(element, dict) for element in elements):
        raise refuse.Refusal(f"'{where}' is not a realflare lens model: it has no list 'lens_elements'.")
    draft = Draft(title=str(model.get("name") or ""), source="A realflare lens model.")
    draft.patent = str(model.get("patent_number") or "")
    draft.focal_length_mm = _positive(model.get("focal_length"))
    draft.f_number = _positive(model.get("fstop"))
    draft.surfaces = [_surface(element, where, k) for k, element in enumerate(elements, 1)]
    stop = model.get("aperture_index")
    if isinstance(stop, int) and 0 <= stop < len(elements):
        draft.surfaces[stop]["stop"] = True
    return draft


def _surface(element: dict[str, Any], where: str, place: int) -> dict[str, Any]:
    values = {"refractive_index": 1.0, "abbe_nr": 0.0} | {
        key: element.get(key) for key in KEYS if key in element
    }
    checked = []
    for key in KEYS:
        value = values.get(key)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise refuse.Refusal(f"'{where}': '{key}' of element {place} must be a number.")
        checked.append(float(value))
    radius, distance, height, index, abbe = checked
    found: dict[str, Any] = {"radius_mm": radius, "thickness_mm": distance, "semi_aperture_mm": height}
    if index != 1.0:
        found |= {"index": index} | ({"abbe": abbe} if abbe else {})
    return found


def _positive(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and 0 < value < 1e9 else None
