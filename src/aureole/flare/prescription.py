"""A lens as its surfaces: read from TOML, checked, written back.

Millimetres at the file's edge, metres inside; light travels along +z from the first surface to the
sensor, and a curvature is positive where its centre lies on the sensor's side.
"""

import dataclasses
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass

from aureole import presets, refuse
from aureole.flare import glass as glasses
from aureole.flare.coating import Coating, Layer, quarter_wave
from aureole.flare.glass import AIR, Glass

# Dividing by it rounds as a moved decimal point does; multiplying by 0.001 does not.
MM_PER_M = 1e3


@dataclass(frozen=True)
class Surface:
    """One surface and the medium behind it.

    Parameters
    ----------
    curvature : float
        One over the radius, 1/m; 0 is a plane.
    thickness : float
        Along the axis to the next surface, or to the sensor, metres.
    semi_aperture : float
        Half the clear diameter, metres.
    glass : Glass
        The medium behind.
    coating : Coating, optional
        Layers on the surface.
    conic : float
        Conic constant: 0 a sphere, -1 a paraboloid.
    asphere : tuple of float
        Coefficients of r⁴, r⁶, ... in the sag, all lengths in metres.
    cylinder : str
        "x" or "y": the only axis along which the surface is curved; "" for both.
    stop : bool
        Whether the iris stands here.
    """

    curvature: float
    thickness: float
    semi_aperture: float
    glass: Glass = AIR
    coating: Coating | None = None
    conic: float = 0.0
    asphere: tuple[float, ...] = ()
    cylinder: str = ""
    stop: bool = False

    def curvature_along(self, axis: str) -> float:
        """Return the curvature in the plane of one axis, "x" or "y"."""
        return 0.0 if self.cylinder and self.cylinder != axis else self.curvature


@dataclass(frozen=True)
class ZoomState:
    """One position of a zoom.

    Parameters
    ----------
    name : str
        Such as "135mm".
    focal_length : float
        As the source states it, metres.
    f_number : float
        As the source states it.
    thicknesses : tuple of (int, float)
        Index of a surface, counted from 0, and the distance behind it in metres.
    """

    name: str
    focal_length: float
    f_number: float
    thicknesses: tuple[tuple[int, float], ...]


@dataclass(frozen=True)
class Lens:
    """A lens prescription.

    Parameters
    ----------
    name : str
        A shipped lens's name, or the file's.
    title : str
        What it is, for a person.
    focal_length, f_number : float
        As the source states them; `aureole.flare.paraxial` computes the true ones. Metres.
    sensor : tuple of float
        Width and height, metres.
    surfaces : tuple of Surface
        From the light to the sensor, one of them the stop.
    patent, kind, status, source, notes : str
        Where the numbers come from, and what else is known.
    reason : str
        Why the surfaces give another focal length than the stated one, where it is over 1 % off.
    states : tuple of ZoomState
        Further positions of a zoom.
    """

    name: str
    title: str
    focal_length: float
    f_number: float
    sensor: tuple[float, float]
    surfaces: tuple[Surface, ...]
    patent: str = ""
    kind: str = ""
    status: str = "own"
    source: str = ""
    notes: str = ""
    reason: str = ""
    states: tuple[ZoomState, ...] = ()

    @property
    def stop(self) -> int:
        """Index of the stop among the surfaces."""
        return next(k for k, surface in enumerate(self.surfaces) if surface.stop)

    @property
    def sensor_distance(self) -> float:
        """From the last surface to the sensor, metres."""
        return self.surfaces[-1].thickness

    def glass_before(self, index: int) -> Glass:
        """Return the medium in front of a surface."""
        return self.surfaces[index - 1].glass if index else AIR


def load(name: str | os.PathLike[str], state: str | None = None) -> Lens:
    """Return a lens by its name, or read a TOML file.

    Parameters
    ----------
    name : str or path_like
        A shipped lens's name, or a path that ends in ".toml".
    state : str, optional
        One of the zoom's positions by its name; that of the surfaces' own distances without it.

    Returns
    -------
    Lens
        Checked.

    Raises
    ------
    refuse.Refusal
        Where there is no such lens (with the nearest name), or the file does not hold one.
    """
    word = os.fspath(name)
    lens = from_preset(presets.load("lenses", word), word)
    return lens if state is None else at_state(lens, state)


def at_state(lens: Lens, state: str) -> Lens:
    """Return a zoom lens at one of its positions.

    Parameters
    ----------
    lens : Lens
        The zoom.
    state : str
        The position's name.

    Returns
    -------
    Lens
        With that position's distances, focal length and f-number, which its title says, and no further
        positions.

    Raises
    ------
    refuse.Refusal
        Where the lens has no such position.
    """
    known = {found.name: found for found in lens.states}
    if state not in known:
        raise refuse.unknown_key(f"'{lens.name}'", state, known)
    found = known[state]
    moved = dict(found.thicknesses)
    surfaces = tuple(
        dataclasses.replace(surface, thickness=moved.get(k, surface.thickness))
        for k, surface in enumerate(lens.surfaces)
    )
    title = f"{lens.title}, moved to {state}"
    stated = dataclasses.replace(lens, title=title, focal_length=found.focal_length, f_number=found.f_number)
    return dataclasses.replace(stated, surfaces=surfaces, states=())


def with_coating(lens: Lens, layers: Sequence[Layer], cemented: bool = False) -> Lens:
    """Return a lens whose every surface has the same coating.

    Parameters
    ----------
    lens : Lens
        The lens.
    layers : sequence of Layer
        From the side of the lower index on; none leaves all surfaces bare.
    cemented : bool
        Whether surfaces between two glasses are coated, too, as in the tile paper's Table 1.

    Returns
    -------
    Lens
        The stop stays bare.
    """
    coating = Coating("all", tuple(layers)) if layers else None
    surfaces = []
    for k, surface in enumerate(lens.surfaces):
        between = AIR not in (lens.glass_before(k), surface.glass)
        coated = refracts(lens, k) and (cemented or not between)
        surfaces.append(dataclasses.replace(surface, coating=coating if coated else None))
    return dataclasses.replace(lens, surfaces=tuple(surfaces))


def refracts(lens: Lens, index: int) -> bool:
    """Return whether the media before and behind a surface differ.

    Parameters
    ----------
    lens : Lens
        The lens.
    index : int
        Of the surface.

    Returns
    -------
    bool
        False for a stop in air and for planes that only mark a place.
    """
    return lens.glass_before(index) != lens.surfaces[index].glass


def travelling_layers(lens: Lens, index: int, forward: bool = True) -> tuple[Layer, ...]:
    """Return the layers of a surface in the order in which light meets them.

    Parameters
    ----------
    lens : Lens
        The lens.
    index : int
        Of the surface.
    forward : bool
        Whether the light travels towards the sensor.

    Returns
    -------
    tuple of Layer
        Empty for a bare surface.
    """
    surface = lens.surfaces[index]
    if surface.coating is None:
        return ()
    # Files list layers from the side of the lower index on.
    from_front = lens.glass_before(index).index <= surface.glass.index
    layers = surface.coating.layers
    return layers if from_front == forward else layers[::-1]


def from_preset(preset: presets.LensPreset, name: str) -> Lens:
    """Return the lens that a checked file means.

    Parameters
    ----------
    preset : LensPreset
        Its numbers, in millimetres.
    name : str
        The lens's name, or the file's.

    Returns
    -------
    Lens
        In metres.

    Raises
    ------
    refuse.Refusal
        Where the numbers do not make a lens: no stop or two, a surface wider than its sphere, an unknown
        glass or coating.
    """
    coatings = {
        word: Coating(word, tuple(_layer(word, layer) for layer in layers))
        for word, layers in preset.coatings.items()
    }
    surfaces = tuple(
        _surface(f"surface {k} of '{name}'", line, coatings) for k, line in enumerate(preset.surfaces, 1)
    )
    _check_stop(name, surfaces)
    return Lens(
        name=name,
        title=preset.title,
        focal_length=preset.focal_length_mm / MM_PER_M,
        f_number=preset.f_number,
        sensor=(preset.sensor_mm[0] / MM_PER_M, preset.sensor_mm[1] / MM_PER_M),
        surfaces=surfaces,
        patent=preset.patent,
        kind=preset.kind,
        status=preset.status,
        source=preset.source,
        notes=preset.notes,
        reason=preset.reason,
        states=tuple(_state(name, state, preset) for state in preset.states),
    )


def _layer(word: str, line: presets.LayerPreset) -> Layer:
    where = f"each layer of coating '{word}'"
    if (line.index is None) == (line.glass is None):
        raise refuse.Refusal(f"{where} needs either 'index' or 'glass'.")
    if (line.quarter_wave_nm is None) == (line.thickness_nm is None):
        raise refuse.Refusal(f"{where} needs either 'quarter_wave_nm' or 'thickness_nm'.")
    medium = glasses.named(line.glass) if line.glass else glasses.of_numbers(line.index or 1.0)
    if line.quarter_wave_nm is not None:
        return quarter_wave(medium, line.quarter_wave_nm * 1e-9)
    assert line.thickness_nm is not None
    return Layer(medium, line.thickness_nm * 1e-9)


def _surface(where: str, line: presets.SurfacePreset, coatings: dict[str, Coating]) -> Surface:
    if line.coating is not None and line.coating not in coatings:
        raise refuse.unknown_key(f"the table of coatings for {where}", line.coating, coatings)
    curvature = 0.0 if line.radius_mm == 0 else MM_PER_M / line.radius_mm
    semi = line.semi_aperture_mm / MM_PER_M
    if line.radius_mm and abs(line.radius_mm) < presets.SHARPEST_MM:
        least = f"{presets.SHARPEST_MM:g}"
        raise refuse.Refusal(f"{where}: 'radius_mm' must be 0 (a plane) or at least {least} long.")
    # A conic ends where (1 + k) c² r² reaches 1.
    if (1.0 + line.conic) * (curvature * semi) ** 2 >= 1.0:
        reach = abs(line.radius_mm) / math.sqrt(1.0 + line.conic)
        what = "the reach of its conic" if line.conic else "its radius of curvature"
        raise refuse.Refusal(
            f"{where}: 'semi_aperture_mm' must be below {what} {reach:g}, got {line.semi_aperture_mm:g}."
        )
    asphere = tuple(a * 1e3 ** (2 * m + 3) for m, a in enumerate(line.asphere_mm))
    return Surface(
        curvature,
        line.thickness_mm / MM_PER_M,
        semi,
        _medium(where, line),
        None if line.coating is None else coatings[line.coating],
        line.conic,
        asphere,
        line.cylinder or "",
        line.stop,
    )


def _medium(where: str, line: presets.SurfacePreset) -> Glass:
    if line.glass is not None:
        if line.index is not None or line.abbe is not None:
            raise refuse.Refusal(f"{where} has a 'glass' by name and numbers for it; give one of them.")
        return glasses.named(line.glass)
    if line.index is None:
        if line.abbe is not None:
            raise refuse.Refusal(f"{where} has an 'abbe' number without an 'index'.")
        return AIR
    return glasses.of_numbers(line.index, line.abbe)


def _check_stop(name: str, surfaces: tuple[Surface, ...]) -> None:
    stops = [k for k, surface in enumerate(surfaces, 1) if surface.stop]
    if not stops:
        raise refuse.Refusal(f"'{name}' has no stop: give one surface 'stop = true'.")
    if len(stops) > 1:
        listed = ", ".join(map(str, stops))
        raise refuse.Refusal(f"'{name}' must have one stop, got {len(stops)}: surfaces {listed}.")
    if surfaces[-1].glass != AIR:
        raise refuse.Refusal(f"'{name}' must end in air: its last surface has a glass behind it.")
    if surfaces[-1].thickness <= 0:
        raise refuse.Refusal(f"'{name}' must end before the sensor: its last 'thickness_mm' must be > 0.")


def _state(name: str, line: presets.StatePreset, preset: presets.LensPreset) -> ZoomState:
    count = len(preset.surfaces)
    moved = []
    for key, thickness in line.thicknesses_mm.items():
        if not key.isdecimal() or not 1 <= int(key) <= count:
            raise refuse.Refusal(
                f"'thicknesses_mm' of state '{line.name}' in '{name}' must have the numbers of surfaces, "
                f"1 to {count}, as keys, got '{key}'."
            )
        moved.append((int(key) - 1, thickness / MM_PER_M))
    f_number = preset.f_number if line.f_number is None else line.f_number
    return ZoomState(line.name, line.focal_length_mm / MM_PER_M, f_number, tuple(moved))
