"""Flags of the eye, shared by the commands `eye` and `glare`, and what they mean."""

import itertools
from dataclasses import dataclass
from typing import Annotated, Any

import typer

from aureole import glare, refuse, units
from aureole.cli.moving import MOVING, MovingFlags
from aureole.cli.pupil_options import ratio, zernike_term
from aureole.jobs import QUICK_GRID, Viewer

EYE, WORLD, OVER = "Eye", "Eye: what it looks at", "Eye: over a picture"
RITSCHEL = "ritschel-2009"
FIBRES = ("real", RITSCHEL)
# Pigment p of CIE 135 by the colour of the iris.
PIGMENTS = {"black": 0.0, "brown": 0.5, "green": 1.0, "light-blue": 1.2}
FIELD_OF_VIEW = "60deg"


@dataclass(frozen=True)
class EyeFlags:
    """The flags of an eye and of what it looks at, as text; each field's option teaches its use.

    Parameters
    ----------
    luminance, time, field_of_view, adapting_field, one_eye : optional
        What it looks at.
    age, pigment, fibres, lashes, particles, no_blink : optional
        The eye.
    combine, no_tail, quick, grid : optional
        How its light is computed.
    """

    luminance: Annotated[
        str | None,
        typer.Option(
            "--luminance",
            help="What the eye is adapted to, with its unit: 0.1cd/m2 a dark street, 10cd/m2 (unless "
            "given) a lit one, 100cd/m2 a room, 1000cd/m2 and more daylight. It sets the pupil. Or as it "
            "changes: 0s:0.1cd/m2,1s:100cd/m2.",
            rich_help_panel=WORLD,
        ),
    ] = None
    time: Annotated[
        str | None,
        typer.Option(
            "--time",
            help="Seconds: 1.5, 1.5s or 500ms; of the first frame with --animate. The pupil trembles, the "
            "lens and the lids move.",
            rich_help_panel=WORLD,
        ),
    ] = None
    field_of_view: Annotated[
        str | None,
        typer.Option(
            "--field-of-view",
            help="Angle across the picture's columns: 60deg unless given.",
            rich_help_panel=WORLD,
        ),
    ] = None
    adapting_field: Annotated[
        str | None,
        typer.Option(
            "--adapting-field",
            help="Side of the square of that luminance: 60deg unless given; a smaller one leaves the pupil "
            "wider.",
            rich_help_panel=WORLD,
        ),
    ] = None
    one_eye: Annotated[
        bool,
        typer.Option(
            "--one-eye", help="The other eye is covered: the pupil is wider.", rich_help_panel=WORLD
        ),
    ] = False
    age: Annotated[
        float | None,
        typer.Option(
            "--age", help="Years: the older, the more haze and the smaller the pupil.", rich_help_panel=EYE
        ),
    ] = None
    pigment: Annotated[
        str | None,
        typer.Option(
            "--pigment",
            help="Colour of the iris: black, brown, green, light-blue, or CIE 135's number 0 to 1.2. The "
            "lighter, the more haze.",
            rich_help_panel=EYE,
        ),
    ] = None
    fibres: Annotated[
        str | None,
        typer.Option(
            "--fibres",
            help="Of the lens: real (10.2 um wide: a ring at 3 degrees) or ritschel-2009 (200 of them: at "
            "0.35 degrees).",
            rich_help_panel=EYE,
        ),
    ] = None
    lashes: Annotated[
        int | None,
        typer.Option(
            "--lashes", help="Eyelashes in front of the pupil: 6 unless given.", rich_help_panel=EYE
        ),
    ] = None
    particles: Annotated[
        str | None,
        typer.Option(
            "--particles",
            help="Particles in the eye, over as many as the age asks for: 0, 1, 200%.",
            rich_help_panel=EYE,
        ),
    ] = None
    no_blink: Annotated[
        bool, typer.Option("--no-blink", help="The lids do not blink.", rich_help_panel=EYE)
    ] = False
    combine: Annotated[
        str | None,
        typer.Option(
            "--combine",
            help="coherent: the eye's parts act on one wave; thesis: their own patterns are added.",
            rich_help_panel=EYE,
        ),
    ] = None
    no_tail: Annotated[
        bool,
        typer.Option(
            "--no-tail",
            help="Wave optics alone; without CIE 135 where they end.",
            rich_help_panel=EYE,
        ),
    ] = False
    quick: Annotated[
        bool,
        typer.Option(
            "--quick",
            help=f"A small grid in the pupil, as --grid {QUICK_GRID}: faster, but the wave's own pattern "
            "ends at one to three degrees, and wide pupils lose their ring.",
            rich_help_panel=EYE,
        ),
    ] = False
    grid: Annotated[
        int | None,
        typer.Option(
            "--grid",
            help="Samples on each side of the pupil's plane: 2048 tell the fibres of the lens. The pupil and "
            "the field choose up to 4096 otherwise.",
            rich_help_panel=EYE,
        ),
    ] = None

    def viewer(
        self,
        preset: str | None,
        seed: int | None,
        defocus: str | None,
        zernike: list[str] | None,
        track: tuple[tuple[float, float], ...] | None = None,
    ) -> Viewer:
        """Return the eye and what it is adapted to; a track of luminance takes the flag's place."""
        changes: dict[str, Any] = {
            "age": self.age,
            "pigment": None if self.pigment is None else pigment(self.pigment),
            "seed": seed,
            "lashes": None if self.lashes is None else refuse.at_least("lashes", self.lashes, 0),
            "particles": None if self.particles is None else ratio(self.particles, "particles"),
            "defocus": None if defocus is None else dioptres(defocus),
            "zernike": None if not zernike else dict(zernike_term(text) for text in zernike),
        }
        if self.fibres is not None:
            changes |= fibres(self.fibres)
        known = {name: value for name, value in changes.items() if value is not None}
        given: dict[str, Any] = {"changes": known, "blinking": not self.no_blink}
        if preset is not None:
            given["preset"] = preset
        if self.luminance is not None:
            given["luminance"] = luminances(self.luminance)
        if track is not None:
            given["luminance"] = track
        if self.adapting_field is not None:
            side = units.angle(self.adapting_field, "adapting-field")
            given["adapting_field"] = refuse.positive("adapting-field", side)
        return Viewer(**given, binocular=not self.one_eye)

    def how(self) -> dict[str, Any]:
        """Return how the light is computed, by the names of an `EyeJob`."""
        if self.quick and self.grid is not None:
            raise refuse.Refusal("'quick' and 'grid' both set the grid; give one of them.")
        return {
            "time": 0.0 if self.time is None else units.seconds(self.time, "time"),
            "field_of_view": units.angle(self.field_of_view or FIELD_OF_VIEW, "field-of-view"),
            "combine": self.combine or "coherent",
            "tail": not self.no_tail,
            "grid": QUICK_GRID if self.quick else self.grid,
        }


@dataclass(frozen=True)
class OverFlags:
    """The flags of an eye's glare on a picture; each field's option teaches its use.

    Parameters
    ----------
    eye : bool
        Whether an eye looks at the picture instead of a camera.
    half : bool
        Whether glare is computed on boxes of two by two pixels.
    patterns, stamps : optional
        How many patterns there are along the picture's width, and for lights by themselves.
    photosafe, white, real_time : optional
        Of an animation.
    """

    eye: Annotated[
        bool,
        typer.Option(
            "--eye",
            help="An eye looks at the picture instead of a camera. --preset, --seed, --defocus (0.5D) and "
            "--zernike are the eye's then, and flags of cameras and apertures are refused.",
            rich_help_panel=OVER,
        ),
    ] = False
    half: Annotated[
        bool,
        typer.Option(
            "--half",
            help="Glare on boxes of 2 x 2 pixels: faster; the picture itself stays sharp.",
            rich_help_panel=OVER,
        ),
    ] = False
    patterns: Annotated[
        int | None,
        typer.Option(
            "--patterns",
            help="Patterns along the picture's width, blended over it, since streaks of lashes depend on "
            "where the light stands: 3. One for the whole picture unless given.",
            rich_help_panel=OVER,
        ),
    ] = None
    stamps: Annotated[
        int,
        typer.Option(
            "--stamps",
            help="So many of the brightest lights have patterns of their own: 4. None unless given.",
            rich_help_panel=OVER,
        ),
    ] = 0
    photosafe: Annotated[
        bool,
        typer.Option(
            "--photosafe",
            help="With --animate: hold changes from frame to frame below those of flashes, for people whom "
            "flashes make ill. It lowers the risk and is no certificate.",
            rich_help_panel=OVER,
        ),
    ] = False
    white: Annotated[
        float | None,
        typer.Option(
            "--white",
            help="For --photosafe: the picture's value that the screen shows as its brightest white; the "
            "automatic exposure's unless given.",
            rich_help_panel=OVER,
        ),
    ] = None
    real_time: Annotated[
        bool,
        typer.Option(
            "--real-time",
            help="With --animate: frames from flipbooks of the eye's parts, which are made first; then each "
            "takes a fraction of a second.",
            rich_help_panel=OVER,
        ),
    ] = False


@dataclass(frozen=True)
class AnimationFlags(MovingFlags):
    """The flags of an eye's animation, as text; each field's option teaches its use.

    Parameters
    ----------
    animate, fps, frames, overwrite, contact_sheet : optional
        As for `MovingFlags`.
    luminance_from, luminance_to : optional
        A change of what the eye is adapted to.
    """

    luminance_from: Annotated[
        str | None,
        typer.Option(
            "--luminance-from",
            help="What the eye looks at on the first frame; it changes by even factors until the last.",
            rich_help_panel=MOVING,
        ),
    ] = None
    luminance_to: Annotated[
        str | None,
        typer.Option("--luminance-to", help="The same on the last frame.", rich_help_panel=MOVING),
    ] = None

    def track(self, flags: EyeFlags, first: float) -> tuple[tuple[float, float], ...] | None:
        """Return the luminance from the first frame's time on, where it is to change."""
        if self.luminance_from is None and self.luminance_to is None:
            return None
        if self.luminance_from is None or self.luminance_to is None:
            raise refuse.Refusal("'luminance-from' and 'luminance-to' go together; one is missing.")
        if flags.luminance is not None:
            raise refuse.Refusal("'luminance' does not go with 'luminance-from' and 'luminance-to'.")
        if self.animate is None:
            raise refuse.Refusal("'luminance-from' needs 'animate', such as --animate 4s.")
        start = units.luminance(self.luminance_from, "luminance-from")
        end = units.luminance(self.luminance_to, "luminance-to")
        return (first, start), (first + self.duration(), end)


def pigment(text: str) -> float:
    """Read the pigment of an iris.

    Parameters
    ----------
    text : str
        "black", "brown", "green", "light-blue", or a number from 0 to 1.2.

    Returns
    -------
    float
        The p of CIE 135.

    Raises
    ------
    refuse.Refusal
        Where the text is neither.
    """
    if text in PIGMENTS:
        return PIGMENTS[text]
    try:
        value = float(text)
    except ValueError:
        names = ", ".join(PIGMENTS)
        raise refuse.Refusal(f"'pigment' must be {names}, or a number 0 to 1.2, got '{text}'.") from None
    return refuse.between("pigment", value, 0.0, max(PIGMENTS.values()))


def dioptres(text: str) -> float:
    """Read a defocus of the eye.

    Parameters
    ----------
    text : str
        "0.5D" or "-1.25D".

    Returns
    -------
    float
        Dioptres.

    Raises
    ------
    refuse.Refusal
        Where the text is none.
    """
    word = text.strip()
    try:
        if word[-1:] not in ("D", "d"):
            raise ValueError
        return refuse.finite("defocus", float(word[:-1]))
    except ValueError:
        raise refuse.Refusal(f"'defocus' of an eye must be dioptres such as 0.5D, got '{text}'.") from None


def fibres(text: str) -> dict[str, Any]:
    """Return an eye's fibres by name, as fields of `aureole.glare.Eye`.

    Parameters
    ----------
    text : str
        "real" or "ritschel-2009".

    Returns
    -------
    dict
        Their width, count, annulus and depth.

    Raises
    ------
    refuse.Refusal
        Where the name is unknown.
    """
    refuse.one_of("fibres", text, FIBRES)
    eye = glare.eye_named(RITSCHEL if text == RITSCHEL else "standard")
    return {name: getattr(eye, name) for name in vars(eye) if name.startswith("fibre_")}


def luminances(text: str) -> tuple[tuple[float, float], ...]:
    """Read a luminance, or one that changes.

    Parameters
    ----------
    text : str
        "10cd/m2", or "0s:0.1cd/m2,1.5s:100cd/m2".

    Returns
    -------
    tuple of (float, float)
        Seconds and candela per square metre, times rising.

    Raises
    ------
    refuse.Refusal
        Where a part cannot be read, or times do not rise.
    """
    if ":" not in text:
        return ((0.0, units.luminance(text, "luminance")),)
    found = []
    for part in text.split(","):
        time, colon, level = part.partition(":")
        if not colon:
            raise refuse.Refusal(f"'luminance' must be time:luminance, such as 1s:100cd/m2, got '{part}'.")
        found.append((units.seconds(time, "luminance"), units.luminance(level, "luminance")))
    if any(later[0] <= earlier[0] for earlier, later in itertools.pairwise(found)):
        raise refuse.Refusal(f"'luminance' must have rising times, got '{text}'.")
    return tuple(found)
