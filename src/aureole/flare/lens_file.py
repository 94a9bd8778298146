"""A lens written back as TOML, so that what is imported can be read and mended by hand."""

import os

from aureole import picture
from aureole.flare.coating import Layer
from aureole.flare.glass import AIR, Glass
from aureole.flare.prescription import MM_PER_M, Lens, Surface
from aureole.presets import toml_text as _text

# Digits that bring a number of millimetres back through metres unchanged.
DIGITS = 12


def write(path: str | os.PathLike[str], lens: Lens) -> None:
    """Write a lens, whole or not at all.

    Parameters
    ----------
    path : path_like
        A file that ends in ".toml".
    lens : Lens
        The lens.

    Raises
    ------
    aureole.refuse.Refusal
        Where the file cannot be written.
    """
    with picture.whole_file(path) as part:
        part.write_text(to_toml(lens), encoding="utf-8")


def to_toml(lens: Lens) -> str:
    """Return a lens as the text of its file.

    Parameters
    ----------
    lens : Lens
        The lens.

    Returns
    -------
    str
        What `aureole.flare.load` reads.
    """
    words = {"title": lens.title, "patent": lens.patent, "kind": lens.kind, "status": lens.status}
    words |= {"source": lens.source, "notes": lens.notes, "reason": lens.reason}
    lines = [f"{key} = {_text(word)}" for key, word in words.items() if word or key in ("title", "source")]
    lines.append(f"focal_length_mm = {_mm(lens.focal_length)}")
    lines.append(f"f_number = {_number(lens.f_number)}")
    lines.append(f"sensor_mm = [{_mm(lens.sensor[0])}, {_mm(lens.sensor[1])}]")
    coatings = {surface.coating for surface in lens.surfaces if surface.coating is not None}
    for coating in sorted(coatings, key=lambda found: found.name):
        layers = ", ".join(_layer(layer) for layer in coating.layers)
        lines.append(f"coatings.{_text(coating.name)} = [{layers}]")
    lines.append("surfaces = [")
    lines += [f"  {{ {_surface(surface)} }}," for surface in lens.surfaces]
    lines.append("]")
    for state in lens.states:
        moved = ", ".join(f"{k + 1} = {_mm(thickness)}" for k, thickness in state.thicknesses)
        lines += ["", "[[states]]", f"name = {_text(state.name)}"]
        lines.append(f"focal_length_mm = {_mm(state.focal_length)}")
        lines.append(f"f_number = {_number(state.f_number)}")
        lines.append(f"thicknesses_mm = {{ {moved} }}")
    return "\n".join(lines) + "\n"


def _surface(surface: Surface) -> str:
    radius = 0.0 if surface.curvature == 0 else 1.0 / surface.curvature
    parts = [f"radius_mm = {_mm(radius)}", f"thickness_mm = {_mm(surface.thickness)}"]
    parts += _glass(surface.glass)
    parts.append(f"semi_aperture_mm = {_mm(surface.semi_aperture)}")
    if surface.conic:
        parts.append(f"conic = {_number(surface.conic)}")
    if surface.asphere:
        terms = (_number(a / 1e3 ** (2 * m + 3)) for m, a in enumerate(surface.asphere))
        parts.append(f"asphere_mm = [{', '.join(terms)}]")
    if surface.cylinder:
        parts.append(f"cylinder = {_text(surface.cylinder)}")
    if surface.coating is not None:
        parts.append(f"coating = {_text(surface.coating.name)}")
    if surface.stop:
        parts.append("stop = true")
    return ", ".join(parts)


def _glass(glass: Glass) -> list[str]:
    if glass == AIR:
        return []
    if glass.b:
        return [f"glass = {_text(glass.name)}"]
    abbe = [] if glass.abbe is None else [f"abbe = {_number(glass.abbe)}"]
    return [f"index = {_number(glass.index)}", *abbe]


def _layer(layer: Layer) -> str:
    glass = layer.glass
    medium = f"glass = {_text(glass.name)}" if glass.b else f"index = {_number(glass.index)}"
    return f"{{ {medium}, thickness_nm = {_number(layer.thickness * 1e9)} }}"


def _mm(metres: float) -> str:
    return _number(metres * MM_PER_M)


def _number(value: float) -> str:
    return f"{value:.{DIGITS}g}"
