"""Flags of the command `surface render`: object, light, camera, material, and what they mean."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from aureole import jobs, picture, refuse, surface, units
from aureole.cli.options import FILES
from aureole.cli.pupil_options import numbers

OBJECT, LIGHTS, CAMERA, MATERIAL = "Object", "Light", "Camera", "Material"
SHAPES = ("disc", "plane", "cylinder")
ROOM = "room"
# A side of an area lamp is this many lamps.
LAMP_CELLS = 6

Size = Annotated[str, typer.Option("--size", help="Pixels: 1280x720.", rich_help_panel=FILES)]
Exposure = Annotated[
    float | None,
    typer.Option(
        "--exposure",
        help="Stops for PNG, JPEG and previews; chosen by the brightest orders unless given.",
        rich_help_panel=FILES,
    ),
]
TableSize = Annotated[
    int | None,
    typer.Option(
        "--table-size",
        help="Samples on each side of a preset's table: 2048 unless given.",
        rich_help_panel=OBJECT,
    ),
]
Turntable = Annotated[
    str | None,
    typer.Option(
        "--turntable",
        help="With --animate: what turns, and by how much over the whole: turn:360deg (unless given), "
        "tilt:60deg or spin:90deg.",
        rich_help_panel="Through time",
    ),
]


@dataclass(frozen=True)
class ObjectFlags:
    """The flags of the object, as text; each field's option teaches its use.

    Parameters
    ----------
    shape, object_size, hole, sweep, tilt, turn, spin, mask : optional
        The object.
    """

    shape: Annotated[
        str | None,
        typer.Option(
            "--shape",
            help="disc (tracks run round it), plane, cylinder, or a mesh: .obj, .ply. By the preset unless "
            "given.",
            rich_help_panel=OBJECT,
        ),
    ] = None
    object_size: Annotated[
        str | None,
        typer.Option(
            "--object-size",
            help="Disc: diameter, 120mm. Plane: width x height, 95mmx54mm. Cylinder: diameter x height. "
            "Mesh: "
            "length of its file's unit, 1mm.",
            rich_help_panel=OBJECT,
        ),
    ] = None
    hole: Annotated[
        str | None,
        typer.Option("--hole", help="Diameter of a disc's hole: 46mm.", rich_help_panel=OBJECT),
    ] = None
    sweep: Annotated[
        str | None,
        typer.Option(
            "--sweep", help="How far a cylinder goes round: 360deg unless given.", rich_help_panel=OBJECT
        ),
    ] = None
    straight: Annotated[
        bool,
        typer.Option(
            "--straight", help="A disc whose lines are straight, not round it.", rich_help_panel=OBJECT
        ),
    ] = False
    tilt: Annotated[
        str, typer.Option("--tilt", help="Top away from the camera: -30deg.", rich_help_panel=OBJECT)
    ] = "0deg"
    turn: Annotated[
        str, typer.Option("--turn", help="About the upright axis: 20deg.", rich_help_panel=OBJECT)
    ] = "0deg"
    spin: Annotated[
        str, typer.Option("--spin", help="In its own plane, before both: 45deg.", rich_help_panel=OBJECT)
    ] = "0deg"
    mask: Annotated[
        Path | None,
        typer.Option(
            "--mask",
            help="Picture laid over the object: where it is white the surface diffracts, where black not.",
            rich_help_panel=OBJECT,
        ),
    ] = None

    def angles(self) -> dict[str, Any]:
        """Return how the object is turned, by the names of a `SurfaceRenderJob`."""
        return {name: units.angle(getattr(self, name), name) for name in ("tilt", "turn", "spin")}

    def body(self, source: str) -> surface.Plane | surface.Disc | surface.Cylinder | surface.Mesh:
        """Return the object; what suits the preset where no shape is given."""
        usual, lengths = jobs.usual_shape(source)
        shape = usual if self.shape is None else self.shape
        kind = shape.lower()
        if kind.endswith((".obj", ".ply")):
            self._refuse_strays("mesh", ("hole", "sweep", "straight"))
            return surface.read_mesh(shape, _sides(self.object_size or "1m", 1)[0])
        if kind not in SHAPES:
            raise refuse.Refusal(
                f"'shape' must be one of {', '.join(SHAPES)}, or a mesh's file (.obj, .ply), got '{shape}'."
            )
        if kind == "disc":
            return self._disc(lengths if usual == "disc" else (0.12, 0.046))
        self._refuse_strays(kind, ("hole", "straight"))
        if kind == "plane":
            self._refuse_strays("plane", ("sweep",))
            given = lengths if usual == "plane" else (0.05, 0.05)
            return surface.Plane(*(given if self.object_size is None else _sides(self.object_size, 2)))
        across, high = _sides(self.object_size or "60mmx90mm", 2)
        return surface.Cylinder(0.5 * across, high, units.angle(self.sweep or "360deg", "sweep"))

    def masked(self) -> Any:
        """Return the mask's values, None where there is none."""
        if self.mask is None:
            return None
        return np.clip(jobs.read_plane(self.mask), 0.0, 1.0).astype(np.float32)

    def _disc(self, usual: tuple[float, float]) -> surface.Disc:
        self._refuse_strays("disc", ("sweep",))
        across = usual[0] if self.object_size is None else _sides(self.object_size, 1)[0]
        hole = across * usual[1] / usual[0] if self.hole is None else _length(self.hole, "hole")
        if not 0 <= hole < across:
            raise refuse.Refusal(f"'hole' must be at least 0 and smaller than the disc, got '{self.hole}'.")
        return surface.Disc(across, hole, radial=not self.straight)

    def _refuse_strays(self, kind: str, names: tuple[str, ...]) -> None:
        for name in names:
            if getattr(self, name):
                raise refuse.Refusal(f"'{name}' does not go with a {kind}.")


@dataclass(frozen=True)
class LightFlags:
    """The flags of the light, as text; each field's option teaches its use.

    Parameters
    ----------
    lamp, lamp_strength, lamp_colour, lamp_size, environment, environment_turn : optional
        The light.
    """

    lamp: Annotated[
        list[str] | None,
        typer.Option(
            "--lamp",
            help="Where a lamp stands, from the object's middle: right, up, towards the camera "
            "(0cm,5cm,30cm); "
            "or two angles to the right and up for one far away (20deg,30deg). Repeat it. One by the camera "
            "unless given.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    lamp_strength: Annotated[
        list[float] | None,
        typer.Option(
            "--lamp-strength",
            help="What a lamp sends onto the object's middle: 1. One for all, or one for each.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    lamp_colour: Annotated[
        list[str] | None,
        typer.Option(
            "--lamp-colour",
            help="Linear red,green,blue: 1,0.8,0.6. One for all, or one for each. --illuminant is the "
            "spectrum "
            "of all.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    lamp_size: Annotated[
        str | None,
        typer.Option(
            "--lamp-size",
            help="Side of square lamps that face the object: 2cm. Points unless given.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    environment: Annotated[
        str | None,
        typer.Option(
            "--environment",
            help="Light from all around: a picture twice as wide as high (EXR, HDR), or room, which is made "
            "by code. No lamp then, unless given.",
            rich_help_panel=LIGHTS,
        ),
    ] = None

    environment_samples: Annotated[
        int,
        typer.Option(
            "--environment-samples",
            help="Parts that the table is cut into for it, on objects that are not flat: more are smoother, "
            "and slower.",
            rich_help_panel=LIGHTS,
        ),
    ] = 1024

    def around(self) -> surface.Environment | None:
        """Return the light from all around."""
        refuse.at_least("environment-samples", self.environment_samples, 1)
        if self.environment is None:
            return None
        if self.environment == ROOM:
            return surface.lamps_and_windows(256)
        return surface.environment_from_picture(picture.read(self.environment), Path(self.environment).name)

    def lamps(self, view: surface.View) -> tuple[surface.Lamp, ...]:
        """Return the lamps."""
        if self.lamp is None and self.environment is not None:
            self._refuse_lonely()
            return ()
        places = self.lamp or [_by_camera(view)]
        strengths = _each("lamp-strength", self.lamp_strength or [1.0], len(places))
        colours = _each("lamp-colour", self.lamp_colour or ["1,1,1"], len(places))
        found: list[surface.Lamp] = []
        for place, strength, colour in zip(places, strengths, colours, strict=True):
            tint = np.array(numbers(colour, "lamp-colour", 3), dtype=float)
            found += self._lamp(place, refuse.between("lamp-strength", strength, 0.0, 1e9) * tint)
        return tuple(found)

    def _lamp(self, text: str, light: Any) -> list[surface.Lamp]:
        """Read a place or a direction; `light` is the irradiance at the origin."""
        words = [word.strip() for word in text.split(",")]
        if len(words) == 2:
            if self.lamp_size is not None:
                raise refuse.Refusal("'lamp-size' needs lamps at a place, such as --lamp 0cm,5cm,30cm.")
            right, up = (units.angle(word, "lamp") for word in words)
            across = math.cos(up)
            return [
                surface.distant_lamp(
                    (math.sin(right) * across, math.sin(up), math.cos(right) * across), light
                )
            ]
        place = _place(text, "lamp")
        away = float(np.linalg.norm(place))
        if away < 1e-6:
            raise refuse.Refusal(f"'lamp' must not stand in the object's middle, got '{text}'.")
        if self.lamp_size is None:
            return [surface.point_lamp(place, light * away**2)]
        return _square(place, away, _sides(self.lamp_size, 1, "lamp-size")[0], light)

    def _refuse_lonely(self) -> None:
        for name in ("lamp_strength", "lamp_colour", "lamp_size"):
            if getattr(self, name) is not None:
                raise refuse.Refusal(
                    f"'{name.replace('_', '-')}' needs 'lamp' where there is an environment."
                )


@dataclass(frozen=True)
class CameraFlags:
    """The flags of the camera, as text; each field's option teaches its use.

    Parameters
    ----------
    camera, look_at, field_of_view, view_height, depth_of_field, focus, samples : optional
        The camera.
    """

    camera: Annotated[
        str | None,
        typer.Option(
            "--camera",
            help="Where it stands, from the object's middle: right, up, towards you: 0cm,5cm,30cm. In "
            "front, so "
            "that the object fills the picture, unless given.",
            rich_help_panel=CAMERA,
        ),
    ] = None
    look_at: Annotated[
        str, typer.Option("--look-at", help="What is in the picture's middle.", rich_help_panel=CAMERA)
    ] = "0cm,0cm,0cm"
    field_of_view: Annotated[
        str | None,
        typer.Option(
            "--field-of-view",
            help="Angle of the picture's height: 36deg unless given.",
            rich_help_panel=CAMERA,
        ),
    ] = None
    view_height: Annotated[
        str | None,
        typer.Option(
            "--view-height",
            help="A view by parallel rays instead, so high: 15cm.",
            rich_help_panel=CAMERA,
        ),
    ] = None
    depth_of_field: Annotated[
        str | None,
        typer.Option(
            "--depth-of-field",
            help="Diameter of the lens's opening: 5mm. The picture is drawn through many points of it, so "
            "orders "
            "of diffraction are out of focus as far as they lie behind the surface.",
            rich_help_panel=CAMERA,
        ),
    ] = None
    focus: Annotated[
        str | None,
        typer.Option(
            "--focus",
            help="Distance at which things are sharp; to the object's middle unless given.",
            rich_help_panel=CAMERA,
        ),
    ] = None
    lens_samples: Annotated[
        int,
        typer.Option("--lens-samples", help="Points of that opening.", rich_help_panel=CAMERA),
    ] = 64
    samples: Annotated[
        int | None,
        typer.Option(
            "--samples",
            help="Samples a pixel along each axis: 3 unless given, 2 with an environment.",
            rich_help_panel=CAMERA,
        ),
    ] = None

    def view(self, shape: tuple[int, int], body: Any) -> surface.View:
        """Return the view; one that the object fills where none is given."""
        if self.field_of_view is not None and self.view_height is not None:
            raise refuse.Refusal("'field-of-view' and 'view-height' do not go together; give one of them.")
        angle = units.angle(self.field_of_view or "36deg", "field-of-view")
        refuse.between("field-of-view", math.degrees(angle), 0.01, 170.0)
        height = None if self.view_height is None else _sides(self.view_height, 1, "view-height")[0]
        target = _place(self.look_at, "look-at")
        if self.camera is not None:
            eye: Any = _place(self.camera, "camera")
        else:
            eye = target + np.array([0.0, 0.0, jobs.fitting_distance(body, angle, shape)])
        return surface.view_from(eye, target, shape, angle, height=height)

    def lens(self, around: bool = False) -> dict[str, Any]:
        """Return what is sharp, by the names of a `SurfaceRenderJob`; samples as light from all around "
        "asks."""
        if self.depth_of_field is None and self.focus is not None:
            raise refuse.Refusal("'focus' needs 'depth-of-field', such as --depth-of-field 5mm.")
        return {
            "opening": 0.0
            if self.depth_of_field is None
            else _sides(self.depth_of_field, 1, "depth-of-field")[0],
            "focus": None if self.focus is None else _sides(self.focus, 1, "focus")[0],
            "lens_samples": self.lens_samples,
            "samples": (2 if around else 3) if self.samples is None else self.samples,
        }


@dataclass(frozen=True)
class MaterialFlags:
    """The flags of the material, as text; each field's option teaches its use.

    Parameters
    ----------
    diffuse, specular, roughness, diffraction, fresnel, geometry, window : optional
        The material.
    """

    diffuse: Annotated[
        str,
        typer.Option(
            "--diffuse", help="Albedo of the matt part: 0.05, or red,green,blue.", rich_help_panel=MATERIAL
        ),
    ] = "0.01"
    specular: Annotated[
        float | None,
        typer.Option(
            "--specular",
            help="Weight of the mirror-like lobe; as much as the table left out of its zero order unless "
            "given.",
            rich_help_panel=MATERIAL,
        ),
    ] = None
    roughness: Annotated[
        float | None,
        typer.Option(
            "--roughness",
            help="Slope of that lobe's facets: 0.1 unless given, or as wide as the order that the table "
            "left out.",
            rich_help_panel=MATERIAL,
        ),
    ] = None
    diffraction: Annotated[
        float, typer.Option("--diffraction", help="Weight of the table.", rich_help_panel=MATERIAL)
    ] = 1.0
    fresnel: Annotated[
        str | None,
        typer.Option(
            "--fresnel",
            help="Reflectance straight on: 0.04, or red,green,blue, or aluminium, silver, gold. A perfect "
            "mirror "
            "unless given.",
            rich_help_panel=MATERIAL,
        ),
    ] = None
    geometry: Annotated[
        str,
        typer.Option(
            "--geometry",
            help="one: light is shared out the same at every incidence; stam: Stam's factor, which grows "
            "towards "
            "grazing. Both are 1 straight on.",
            rich_help_panel=MATERIAL,
        ),
    ] = "one"
    window: Annotated[
        str | None,
        typer.Option(
            "--window",
            help="Gaussian over the table, standard deviations in h along and across: 0.5,0.2.",
            rich_help_panel=MATERIAL,
        ),
    ] = None

    def material(self, table: surface.ScatterTable | None) -> surface.Material:
        """Return the material; without a table only to refuse what is wrong."""
        refuse.one_of("geometry", self.geometry, surface.material.GEOMETRY)
        specular = 0.0 if self.specular is None else self.specular
        given = surface.Material(
            diffuse=_colour(self.diffuse, "diffuse"),
            specular=refuse.between("specular", specular, 0.0, 1e6),
            roughness=refuse.between(
                "roughness", 0.1 if self.roughness is None else self.roughness, 1e-3, 10.0
            ),
            diffraction=refuse.between("diffraction", self.diffraction, 0.0, 1e6),
            fresnel=None if self.fresnel is None else _fresnel(self.fresnel),
            geometry=self.geometry,
            window=None if self.window is None else _window(self.window),
        )
        if table is None or self.specular is not None:
            return given
        found = surface.material_of(table, given)
        return found if self.roughness is None else replace(found, roughness=self.roughness)


def turning(text: str | None) -> dict[str, Any]:
    """Read what turns through time, and how far.

    Parameters
    ----------
    text : str, optional
        "turn:360deg".

    Returns
    -------
    dict
        By the names of a `SurfaceTurnJob`.
    """
    about, _, sweep = (text or "turn:360deg").partition(":")
    return {
        "about": refuse.one_of("turntable", about, ("turn", "tilt", "spin")),
        "sweep": units.angle(sweep or "360deg", "turntable"),
    }


def _place(text: str, name: str) -> Any:
    """Read "0cm,5cm,30cm"."""
    words = [word.strip() for word in text.split(",")]
    if len(words) != 3:
        also = ", or two angles such as 20deg,30deg" if name == "lamp" else ""
        raise refuse.Refusal(f"'{name}' must be three lengths such as 0cm,5cm,30cm{also}, got '{text}'.")
    return np.array([units.length(word, name, "0cm,5cm,30cm") for word in words])


def _sides(text: str, count: int, name: str = "object-size") -> list[float]:
    """Read "120mm" or "96mmx54mm"."""
    words = text.replace("×", "x").split("x")
    if len(words) != count:
        example = "96mmx54mm" if count == 2 else "120mm"
        raise refuse.Refusal(f"'{name}' must be such as {example}, got '{text}'.")
    return [refuse.positive(name, units.length(word, name, "96mmx54mm")) for word in words]


def _length(text: str, name: str) -> float:
    """Read "5mm"; nought is allowed."""
    return units.length(text, name, "5mm")


def _by_camera(view: surface.View) -> str:
    """Say where a lamp stands that no one placed: by the camera, a little above it."""
    right, up, away = view.eye + 0.05 * float(np.linalg.norm(view.eye)) * view.up / np.linalg.norm(view.up)
    return f"{right:.9f}m,{up:.9f}m,{away:.9f}m"


def _square(place: Any, away: float, side: float, light: Any) -> list[surface.Lamp]:
    """Return a square lamp that faces the origin."""
    towards = -place / away
    spare = (0.0, 1.0, 0.0) if abs(towards[1]) < 0.9 else (1.0, 0.0, 0.0)
    right = np.cross(towards, spare)
    right *= 0.5 * side / np.linalg.norm(right)
    up = np.cross(towards, right)
    return list(surface.area_lamp(place, right, up, light * (away / side) ** 2, (LAMP_CELLS, LAMP_CELLS)))


def _each(name: str, values: list[Any], count: int) -> list[Any]:
    """Return one value for each lamp."""
    if len(values) == 1:
        return values * count
    if len(values) != count:
        raise refuse.Refusal(
            f"'{name}' must be given once, or once for each of {count} lamps, got {len(values)}."
        )
    return values


def _colour(text: str, name: str) -> Any:
    """Read "0.5" or "0.5,0.4,0.3"."""
    try:
        found = numbers(text, name, 3 if "," in text else 1)
    except refuse.Refusal:
        raise refuse.Refusal(f"'{name}' must be a number or red,green,blue, got '{text}'.") from None
    return np.array([refuse.between(name, value, 0.0, 1.0) for value in found], dtype=float)


def _fresnel(text: str) -> Any:
    """Read a reflectance or a metal."""
    word = text.strip().lower()
    if word.isalpha():
        refuse.one_of("fresnel", word, jobs.METALS)
        return surface.conductor(*jobs.METALS[word])
    return surface.schlick(_colour(text, "fresnel"))


def _window(text: str) -> tuple[float, float]:
    """Read "0.5,0.2"."""
    along, across = (refuse.positive("window", value) for value in numbers(text, "window", 2))
    return along, across
