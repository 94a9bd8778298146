"""What looks wrong in a prescription: the mistakes that lens files are known to hold."""

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from aureole.flare import paraxial
from aureole.flare.glass import AIR
from aureole.flare.prescription import Lens, Surface, refracts

# Published tables are rounded: within these a lens is what it says.
FOCAL_LENGTH_ERROR, FOCUS_ERROR = 0.03, 0.005
# Diameters in place of radii make a lens about twice as fast as it says, halved ones half as fast.
DOUBLED, HALVED = (0.4, 0.62), (1.65, 2.5)
# Lengths in tables have two decimals of a millimetre.
LEAST_CROSSING = 1e-5
UNITS = {25.4: "inches", 10.0: "centimetres", 1000.0: "metres"}


@dataclass(frozen=True)
class Finding:
    """Something that looks wrong.

    Parameters
    ----------
    kind : str
        "focal-length", "sign", "unit", "sensor", "semi-aperture", "coating" or "edge".
    text : str
        One line for a person.
    surface : int, optional
        Number of the surface, counted from 1.
    """

    kind: str
    text: str
    surface: int | None = None


def findings(lens: Lens) -> list[Finding]:
    """Return what looks wrong in a lens.

    Parameters
    ----------
    lens : Lens
        The lens.

    Returns
    -------
    list of Finding
        Empty where nothing does.
    """
    return [*_focal_length(lens), *_sensor(lens), *_semi_apertures(lens), *_coatings(lens), *_edges(lens)]


def _focal_length(lens: Lens) -> Iterator[Finding]:
    found = _nearest_axis(lens)
    if _fits(found, lens.focal_length):
        return
    computed = "none: the lens is afocal" if math.isinf(found) else f"{1e3 * found:.4g} mm"
    stated = f"{1e3 * lens.focal_length:.4g} mm"
    yield Finding("focal-length", f"focal length is stated as {stated}, the surfaces give {computed}")
    for times, unit in UNITS.items():
        if _fits(found * times, lens.focal_length) or _fits(found / times, lens.focal_length):
            yield Finding("unit", f"lengths are off by a factor of {times:g}: {unit} for millimetres?")
    for k, surface in enumerate(lens.surfaces):
        flipped = _flipped(lens, k)
        if surface.curvature and _fits(_nearest_axis(flipped), lens.focal_length) and _focused(flipped):
            yield Finding("sign", f"surface {k + 1}: the other sign of its radius gives {stated}", k + 1)


def _sensor(lens: Lens) -> Iterator[Finding]:
    focus = paraxial.back_focus(lens)
    off = lens.sensor_distance - focus
    if not _focused(lens):
        where = "behind" if off > 0 else "before"
        text = f"the sensor stands {1e3 * abs(off):.3g} mm {where} the focus at {1e3 * focus:.5g} mm"
        yield Finding("sensor", "there is no focus" if math.isinf(focus) else text)


def _semi_apertures(lens: Lens) -> Iterator[Finding]:
    allowed = paraxial.f_number(lens)
    ratio = allowed / lens.f_number
    said = f"they give f/{allowed:.3g}, stated is f/{lens.f_number:.3g}"
    if DOUBLED[0] <= ratio <= DOUBLED[1]:
        yield Finding("semi-aperture", f"semi-apertures look like diameters: {said}")
    elif HALVED[0] <= ratio <= HALVED[1]:
        yield Finding("semi-aperture", f"semi-apertures look halved: {said}")


def _coatings(lens: Lens) -> Iterator[Finding]:
    """Bare rear sides beside coated fronts, and coatings between glasses, are what converters leave."""
    fronts: list[int] = []
    rears: list[int] = []
    cemented: list[int] = []
    for k, surface in enumerate(lens.surfaces):
        before, behind = lens.glass_before(k), surface.glass
        if refracts(lens, k) and not surface.stop:
            (fronts if before == AIR else rears if behind == AIR else cemented).append(k)
    bare = [k for k in rears if lens.surfaces[k].coating is None]
    if bare and len(bare) == len(rears) and any(lens.surfaces[k].coating for k in fronts):
        text = f"all {len(bare)} surfaces from glass to air are bare, those from air to glass are not"
        yield Finding("coating", text)
    for k in cemented:
        if lens.surfaces[k].coating is not None:
            yield Finding("coating", f"surface {k + 1} is cemented and coated", k + 1)


def _edges(lens: Lens) -> Iterator[Finding]:
    for k, (one, other) in enumerate(pairwise(lens.surfaces), 1):
        height = min(one.semi_aperture, other.semi_aperture)
        gap = one.thickness + sag(other, height) - sag(one, height)
        if gap < -LEAST_CROSSING:
            place = f"{1e3 * height:.4g} mm off the axis"
            text = f"surfaces {k} and {k + 1} overlap by {-1e3 * gap:.2g} mm {place}"
            yield Finding("edge", text, k)


def sag(surface: Surface, height: float) -> float:
    """Return how far a surface lies behind its vertex.

    Parameters
    ----------
    surface : Surface
        The surface.
    height : float
        Distance from the axis, along the curved axis of a cylinder, metres.

    Returns
    -------
    float
        Metres, positive towards the sensor.
    """
    c, square = surface.curvature, height**2
    root = math.sqrt(max(1.0 - (1.0 + surface.conic) * c * c * square, 0.0))
    terms = sum(a * square ** (m + 2) for m, a in enumerate(surface.asphere))
    return c * square / (1.0 + root) + terms


def _nearest_axis(lens: Lens) -> float:
    """Return the focal length along the axis where it is nearer to the stated one."""
    found = [paraxial.focal_length(lens, axis) for axis in paraxial.AXES]
    return found[int(np.argmin([abs(f - lens.focal_length) for f in found]))]


def _focused(lens: Lens) -> bool:
    off = lens.sensor_distance - paraxial.back_focus(lens)
    return abs(off) < FOCUS_ERROR * abs(_nearest_axis(lens))


def _fits(found: float, stated: float) -> bool:
    return abs(found / stated - 1.0) <= FOCAL_LENGTH_ERROR


def _flipped(lens: Lens, index: int) -> Lens:
    surfaces = list(lens.surfaces)
    surfaces[index] = dataclasses.replace(surfaces[index], curvature=-surfaces[index].curvature)
    return dataclasses.replace(lens, surfaces=tuple(surfaces))
