"""Flags of the command `flare`: the lights, the ghosts, the lens, and what they mean."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from aureole import refuse, units
from aureole.cli import options
from aureole.cli.lights_options import AUTO, threshold
from aureole.cli.options import FILES
from aureole.cli.pupil_options import numbers
from aureole.glare import LampList
from aureole.jobs import Lamp, lights_of_frame

LENS, LIGHTS, GHOSTS = "Lens", "Lights", "Ghosts"
PIXELS = "px"

Name = Annotated[
    str,
    typer.Option(
        "--lens",
        help="A shipped lens's name (see `aureole lens list`), or a file: .toml, .zmx, .seq, .xml, .json, "
        ".lens, .dat.",
        rich_help_panel=LENS,
    ),
]
State = Annotated[
    str | None,
    typer.Option("--state", help="Position of a zoom, by the file's name for it.", rich_help_panel=LENS),
]
FNumber = Annotated[
    float | None,
    typer.Option("--f-number", help="Such as 16; wide open without it.", rich_help_panel=LENS),
]
Shape = Annotated[
    str | None,
    typer.Option(
        "--aperture", help="iris, circle, whirl or picture; round without it.", rich_help_panel=options.SHAPE
    ),
]
Size = Annotated[
    str | None,
    typer.Option("--size", help="Pixels: 1920x1080, as wide as the sensor.", rich_help_panel=FILES),
]
ColourSpace = Annotated[
    str,
    typer.Option(
        "--colour-space",
        help="rec709, acescg, rec2020 or xyz; with --over the picture's own.",
        rich_help_panel=FILES,
    ),
]
Over = Annotated[
    Path | None,
    typer.Option(
        "--over",
        help="Linear HDR picture to which the flare is added; it spans the sensor's width.",
        rich_help_panel=FILES,
    ),
]
LayersFlag = Annotated[
    bool,
    typer.Option(
        "--layers",
        help="Write layers, too: ghosts, starburst, and each ghost (ghost_2_5 is the ghost 2-5). The plain "
        "R, G, B are all together.",
        rich_help_panel=FILES,
    ),
]


@dataclass(frozen=True)
class LightFlags:
    """The flags of the lights, as text; each field's option teaches its use.

    Parameters
    ----------
    light, light_colour, light_strength : optional
        One or more.
    light_size : optional
        Of them all.
    illuminant : str
        Where no colour is said.
    find_lights, lights, lights_frame, most_lights : optional
        Those that a picture shows, or a file lists.
    """

    light: Annotated[
        list[str] | None,
        typer.Option(
            "--light",
            help="Where a light stands: two angles, to the right and downward on the picture (8deg,3deg), or "
            "its place in pixels from the upper left corner (1200px,300px), on the picture or off it. Repeat "
            "it.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    light_colour: Annotated[
        list[str] | None,
        typer.Option(
            "--light-colour",
            help="Linear red,green,blue: 1,0.8,0.6. One for all lights, or one for each.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    light_strength: Annotated[
        list[float] | None,
        typer.Option(
            "--strength",
            help="What the light's own image sums to: 1, or with --over as much as the picture shows at its "
            "place. One for all lights, or one for each.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    light_size: Annotated[
        str | None,
        typer.Option(
            "--light-size",
            help="Angle across disc-shaped lights, such as 0.53deg for the sun.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    illuminant: Annotated[
        str,
        typer.Option(
            "--illuminant",
            help="Spectrum of lights without a colour: E, A, D65, F1, blackbody:3200K or line:550nm.",
            rich_help_panel=LIGHTS,
        ),
    ] = "E"
    find_lights: Annotated[
        str | None,
        typer.Option(
            "--find-lights",
            help="Take the lights that --over shows: regions of more luminance than this. auto: 16 times the "
            "median pixel, but at least a thousandth of the brightest.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    lights: Annotated[
        Path | None,
        typer.Option(
            "--lights",
            help="Take the lights of a file that `aureole lights` wrote, or people: .jsonl.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    lights_frame: Annotated[
        int | None,
        typer.Option(
            "--lights-frame",
            help="Which frame's, where the file has lights of several.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    most_lights: Annotated[
        int,
        typer.Option(
            "--most-lights", help="Of those found or in the file, the brightest.", rich_help_panel=LIGHTS
        ),
    ] = 8

    def values(self) -> dict[str, Any]:
        """Return what the flags mean, by the names of a `FlareJob`."""
        size = 0.0 if self.light_size is None else units.angle(self.light_size, "light-size")
        return {
            "lamps": self._lamps(),
            "light_size": refuse.between("light-size", size, 0.0, 1.0),
            "illuminant": self.illuminant,
            "find": self._find(),
            "lights": self._listed(),
            "most_lights": refuse.at_least("most-lights", self.most_lights, 1),
        }

    def _find(self) -> Any:
        return None if self.find_lights is None else threshold(self.find_lights, "find-lights") or AUTO

    def _listed(self) -> LampList | None:
        if self.lights is None and self.lights_frame is not None:
            raise refuse.Refusal("'lights-frame' needs the file of lights: --lights FILE.")
        return None if self.lights is None else lights_of_frame(self.lights, self.lights_frame)

    def _lamps(self) -> tuple[Lamp, ...]:
        places = [place(text) for text in self.light or []]
        colours = [numbers(text, "light-colour", 3) for text in self.light_colour or []]
        strengths = [refuse.positive("strength", value) for value in self.light_strength or []]
        colours = _one_each("light-colour", colours, len(places))
        strengths = _one_each("strength", strengths, len(places))
        return tuple(
            Lamp(where, on_picture, colour, strength)
            for (where, on_picture), colour, strength in zip(places, colours, strengths, strict=True)
        )


@dataclass(frozen=True)
class GhostFlags:
    """The flags of the ghosts, as text; each field's option teaches its use.

    Parameters
    ----------
    ghosts, hide, only : optional
        Which of them.
    gain : float
        Their brightness.
    starburst : bool
        Whether the lights' starbursts are added.
    ringing, crop_ringing, wavelengths, grid, points, filter, merge : optional
        How they are computed.
    """

    ghosts: Annotated[
        str,
        typer.Option(
            "--ghosts",
            help="same-side: both reflections on one side of the stop; all: those across it, too; paper: the "
            "tile paper's count; top:20: the strongest of all; 90%: as few as hold so much of their light.",
            rich_help_panel=GHOSTS,
        ),
    ] = "same-side"
    hide: Annotated[
        list[str] | None,
        typer.Option(
            "--hide",
            help="Leave out a ghost, named by its two surfaces: 2-5. Repeat it.",
            rich_help_panel=GHOSTS,
        ),
    ] = None
    only: Annotated[
        list[str] | None,
        typer.Option("--only", help="Draw this ghost alone: 2-5. Repeat it.", rich_help_panel=GHOSTS),
    ] = None
    gain: Annotated[
        float,
        typer.Option(
            "--gain",
            help="Multiplies the ghosts; 1 is what the lens does. The starburst stays as it is.",
            rich_help_panel=GHOSTS,
        ),
    ] = 1.0
    starburst: Annotated[
        bool,
        typer.Option(
            "--starburst",
            help="Add the lights' starbursts; on black with the lights' own images.",
            rich_help_panel=GHOSTS,
        ),
    ] = False
    ringing: Annotated[
        float | None,
        typer.Option(
            "--ringing",
            help="Fringes along the iris's edge: their Fresnel number, such as 30.",
            rich_help_panel=GHOSTS,
        ),
    ] = None
    crop_ringing: Annotated[
        bool,
        typer.Option(
            "--crop-ringing",
            help="Fringes along the rims of the housing, too, each ghost with its own (slower).",
            rich_help_panel=GHOSTS,
        ),
    ] = False
    wavelengths: Annotated[
        int | None,
        typer.Option("--wavelengths", help="How many are traced.", rich_help_panel=GHOSTS),
    ] = None
    grid: Annotated[
        int | None,
        typer.Option("--grid", help="Rays a side through the lens: 128.", rich_help_panel=GHOSTS),
    ] = None
    points: Annotated[
        int | None,
        typer.Option(
            "--points",
            help="How many points stand for each light of some size in the ghosts; 1 is fastest.",
            rich_help_panel=GHOSTS,
        ),
    ] = None
    filter: Annotated[
        str | None,
        typer.Option(
            "--filter",
            help="median, or spectral: a blur along the dispersion. They smooth what a coarse grid or few "
            "wavelengths leave.",
            rich_help_panel=GHOSTS,
        ),
    ] = None
    merge: Annotated[
        str,
        typer.Option(
            "--merge", help="none, light or heavy: cells drawn as one, for speed.", rich_help_panel=GHOSTS
        ),
    ] = "light"

    def values(self) -> dict[str, Any]:
        """Return what the flags mean, by the names of a `FlareJob`."""
        return {
            "ghosts": self.ghosts,
            "hide": tuple(self.hide or ()),
            "only": tuple(self.only or ()),
            "gain": refuse.finite("gain", self.gain),
            "starburst": self.starburst,
            "ringing": None if self.ringing is None else refuse.positive("ringing", self.ringing),
            "crop_ringing": self.crop_ringing,
            "wavelengths": _count("wavelengths", self.wavelengths, 1),
            "grid": _count("grid", self.grid, 2),
            "filter": self.filter,
            "points": _count("points", self.points, 1),
            "merge": self.merge,
        }


def place(text: str) -> tuple[tuple[float, float], bool]:
    """Read where a light stands.

    Parameters
    ----------
    text : str
        "8deg,3deg", "8,3" or "1200px,300px".

    Returns
    -------
    place : tuple of float
        Angles in radians, or pixels.
    on_picture : bool
        Whether they are pixels.

    Raises
    ------
    refuse.Refusal
        Where the text is no such place.
    """
    parts = [part.strip() for part in text.split(",")]
    in_pixels = [part.endswith(PIXELS) for part in parts]
    if len(parts) != 2 or any(in_pixels) != all(in_pixels):
        raise refuse.Refusal(
            f"'light' must be two angles such as 8deg,3deg, or pixels such as 1200px,300px, got '{text}'."
        )
    if not all(in_pixels):
        x, y = (units.angle(part, "light") for part in parts)
        return (x, y), False
    try:
        x, y = (float(part.removesuffix(PIXELS)) for part in parts)
    except ValueError:
        raise refuse.Refusal(f"'light' must be a place such as 1200px,300px, got '{text}'.") from None
    return (refuse.finite("light", x), refuse.finite("light", y)), True


def _one_each(name: str, values: Sequence[Any], count: int) -> list[Any]:
    """Give each light a value: none, the only one, or its own."""
    if len(values) in (0, 1):
        return [values[0] if values else None] * count
    if len(values) != count:
        raise refuse.Refusal(
            f"'{name}' must be given once, or for each of {count} lights, got {len(values)}."
        )
    return list(values)


def _count(name: str, value: int | None, smallest: int) -> int | None:
    return None if value is None else refuse.at_least(name, value, smallest)
