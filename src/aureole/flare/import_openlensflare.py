"""OpenLensFlare .xml: spherical lenses with heights and a coating a surface."""

from typing import Any
from xml.etree import ElementTree

from aureole import refuse
from aureole.flare.import_draft import Draft, number


def read(text: str, where: str) -> Draft:
    """Read the text of an OpenLensFlare system.

    Parameters
    ----------
    text : str
        The file.
    where : str
        Its name, for refusals.

    Returns
    -------
    Draft
        Heights there are semi-apertures; air's Abbe number of 89.3 is a filler and is left out.

    Raises
    ------
    aureole.refuse.Refusal
        Where it is no such system, or an element is aspherical.
    """
    # Entities could make a small file huge; systems have none.
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise refuse.Refusal(f"'{where}' has a document type; an OpenLensFlare system has none.")
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise refuse.Refusal(f"'{where}' is not XML: {error}.") from None
    elements = root.find("elements")
    if root.tag != "opticalSystem" or elements is None:
        raise refuse.Refusal(f"'{where}' is not an OpenLensFlare system: no <elements> in <opticalSystem>.")
    draft = Draft(title=(root.findtext("name") or "").strip(), source="An OpenLensFlare system.")
    draft.focal_length_mm = _positive(root, "effectiveFocalLength", where)
    width, height = _positive(root, "filmWidth", where), _positive(root, "filmHeight", where)
    if width and height:
        draft.sensor_mm = [width, height]
    draft.surfaces = [
        _surface(draft, element, where)
        for element in elements
        if (element.findtext("type") or "").strip() != "sensor"
    ]
    if root.find("fnumber") is not None:
        draft.notes.append("the file's f-number is that of a closed iris; the semi-apertures' is used")
    return draft


def _surface(draft: Draft, element: ElementTree.Element, where: str) -> dict[str, Any]:
    kind = (element.findtext("type") or "").strip()
    if kind not in ("lensSpherical", "apertureStop"):
        raise refuse.Refusal(f"'{where}': elements of type '{kind}' cannot be read.")
    found: dict[str, Any] = {
        "radius_mm": _value(element, "radius", where),
        "thickness_mm": _value(element, "thickness", where),
        "semi_aperture_mm": _value(element, "height", where),
    }
    index, abbe = _value(element, "refractiveIndex", where), _value(element, "abbeNumber", where)
    if index != 1.0:
        found |= {"index": index, "abbe": abbe}
    if kind == "apertureStop":
        return found | {"stop": True}
    wavelength, layer = _value(element, "coatingLambda", where), _value(element, "coatingIor", where)
    if wavelength > 0 and layer > 1:
        name = f"single-{wavelength:g}nm-{layer:g}"
        draft.coatings[name] = [{"index": layer, "quarter_wave_nm": wavelength}]
        found["coating"] = name
    return found


def _value(element: ElementTree.Element, key: str, where: str) -> float:
    return number(element.findtext(key) or "0", where)


def _positive(root: ElementTree.Element, key: str, where: str) -> float | None:
    text = root.findtext(key)
    value = None if text is None else number(text, where)
    return value if value and value > 0 else None
