"""What a lens is, as plain numbers: its measures, its ghosts, what looks wrong in it."""

import math
from typing import Any

from aureole import flare, presets
from aureole.flare import lint, paraxial
from aureole.flare.prescription import Lens


def lens_list() -> list[dict[str, Any]]:
    """Return one line for each lens that comes with Aureole.

    Returns
    -------
    list of dict
        Name, title, status, focal length, f-number, how many surfaces and ghosts.
    """
    return [_line(flare.load(name)) for name in presets.names("lenses")]


def lens_report(lens: Lens) -> dict[str, Any]:
    """Return what the surfaces of a lens give, beside what its source states.

    Parameters
    ----------
    lens : Lens
        The lens.

    Returns
    -------
    dict
        Plain numbers in metres; None where a lens has no focus. "ghosts" counts them by each rule,
        "findings" lists what looks wrong.
    """
    pupil_place, pupil_radius = paraxial.entrance_pupil(lens)
    report: dict[str, Any] = {
        "lens": lens.name,
        "title": lens.title,
        "patent": lens.patent,
        "status": lens.status,
        "focal_length_m": _number(paraxial.focal_length(lens)),
        "stated_focal_length_m": lens.focal_length,
        "reason": lens.reason,
        "f_number": _number(paraxial.f_number(lens)),
        "stated_f_number": lens.f_number,
        "back_focus_m": _number(paraxial.back_focus(lens)),
        "sensor_distance_m": lens.sensor_distance,
        "sensor_m": list(lens.sensor),
        "length_m": sum(surface.thickness for surface in lens.surfaces[:-1]),
        "entrance_pupil_m": _number(pupil_place),
        "entrance_pupil_diameter_m": _number(2 * pupil_radius),
        "axial_colour": _number(paraxial.axial_colour(lens)),
        "surfaces": len(lens.surfaces),
        "stop": lens.stop + 1,
        "limiting_surface": paraxial.entrance_radius(lens)[1] + 1,
    }
    if any(surface.cylinder for surface in lens.surfaces):
        report["focal_length_across_m"] = _number(paraxial.focal_length(lens, "x"))
        report["back_focus_across_m"] = _number(paraxial.back_focus(lens, "x"))
        report["squeeze"] = _number(paraxial.focal_length(lens, "x") / paraxial.focal_length(lens, "y"))
    report["states"] = [state.name for state in lens.states]
    report["ghosts"] = flare.counts(lens)
    report["findings"] = [vars(found) for found in lint.findings(lens)]
    return report


def _line(lens: Lens) -> dict[str, Any]:
    return {
        "lens": lens.name,
        "title": lens.title,
        "status": lens.status,
        "focal_length_m": _number(paraxial.focal_length(lens)),
        "f_number": _number(paraxial.f_number(lens)),
        "surfaces": len(lens.surfaces),
        "ghosts": flare.counts(lens),
    }


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
