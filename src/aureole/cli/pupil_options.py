"""Flags for what stands in an opening, lies on it and bends its wave, shared by several commands."""

import functools
import inspect
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Annotated, Any

import typer

from aureole import aperture, refuse, units

SPIDERS, DIRT, WAVEFRONT = "Aperture: vanes and shadow", "Aperture: dust and scratches", "Aperture: wavefront"
MOVING_DIRT = "Aperture: dirt that moves"
# A wave, where a path is given in waves.
WAVE = 550e-9
NAMES = ", ".join(name for name in aperture.ZERNIKE_NAMES if name != "piston")


@dataclass(frozen=True)
class PupilFlags:
    """The flags of vanes, dirt and wavefronts, as text; each field's option teaches its use.

    Parameters
    ----------
    spiders, spider_width, spider_rotation : optional
        Vanes.
    shadow, housing : optional
        What stands before the lens, and its rim.
    dust, dust_scale, dust_stretch, dust_angle, scratches, eyelashes, lid_opening, seed : optional
        Dirt.
    dirt_drift, dust_speed, dirt_time, dirt_distance : optional
        How dirt moves.
    defocus, focus_shift, zernike : optional
        Wavefront.
    """

    spiders: Annotated[
        int | None,
        typer.Option("--spiders", help="Vanes from the centre to the rim.", rich_help_panel=SPIDERS),
    ] = None
    spider_width: Annotated[
        str | None,
        typer.Option("--spider-width", help="Breadth of a vane: 0.1mm.", rich_help_panel=SPIDERS),
    ] = None
    spider_rotation: Annotated[
        str | None,
        typer.Option(
            "--spider-rotation", help="Direction of the first vane: 45deg.", rich_help_panel=SPIDERS
        ),
    ] = None
    shadow: Annotated[
        str | None,
        typer.Option(
            "--shadow",
            help="Round shadow: x,y of its centre, y downward, and its diameter, in parts of the opening's "
            "width: 0.2,-0.1,0.5.",
            rich_help_panel=SPIDERS,
        ),
    ] = None
    housing: Annotated[
        str | None,
        typer.Option(
            "--housing",
            help="Round rim of the lens seen from off the axis, which leaves a cat's eye: x,y,diameter as of "
            "the shadow: 0.5,0,1.2.",
            rich_help_panel=SPIDERS,
        ),
    ] = None
    dust: Annotated[
        str | None,
        typer.Option(
            "--dust", help="Part of the opening that dust touches: 10% or 0.1.", rich_help_panel=DIRT
        ),
    ] = None
    dust_scale: Annotated[
        str | None,
        typer.Option("--dust-scale", help="Size of the largest specks: 0.2mm.", rich_help_panel=DIRT),
    ] = None
    dust_stretch: Annotated[
        float | None,
        typer.Option(
            "--dust-stretch", help="How many times longer than broad: 1 to 1000.", rich_help_panel=DIRT
        ),
    ] = None
    dust_angle: Annotated[
        str | None,
        typer.Option("--dust-angle", help="Direction of the stretch: 30deg.", rich_help_panel=DIRT),
    ] = None
    scratches: Annotated[
        int | None,
        typer.Option("--scratches", help="How many scratches.", rich_help_panel=DIRT),
    ] = None
    eyelashes: Annotated[
        int | None,
        typer.Option(
            "--eyelashes",
            help="Lashes before the opening, as many over a pupil of 6 mm: 8.",
            rich_help_panel=DIRT,
        ),
    ] = None
    lid_opening: Annotated[
        float | None,
        typer.Option(
            "--lid-opening",
            help="Of the lids that the lashes hang from, 0 closed to 1 wide open: 0.7 unless given.",
            rich_help_panel=DIRT,
        ),
    ] = None
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed", help="Of dust, scratches and eyelashes: the same gives the same.", rich_help_panel=DIRT
        ),
    ] = None
    dirt_drift: Annotated[
        str | None,
        typer.Option(
            "--dirt-drift",
            help="Way of dust and scratches across the opening in a second, right and down: 0.2mm,0mm.",
            rich_help_panel=MOVING_DIRT,
        ),
    ] = None
    dust_speed: Annotated[
        float | None,
        typer.Option(
            "--dust-speed",
            help="How fast dust changes its shape: at 1 it is another after a second.",
            rich_help_panel=MOVING_DIRT,
        ),
    ] = None
    dirt_time: Annotated[
        str | None,
        typer.Option(
            "--dirt-time",
            help="Time of the picture, or of a sequence's frame 0: 1.5s.",
            rich_help_panel=MOVING_DIRT,
        ),
    ] = None
    dirt_distance: Annotated[
        str | None,
        typer.Option(
            "--dirt-distance",
            help="How far before the pupil dust and scratches lie, so that light from the frame's border "
            "finds them elsewhere: 20mm. With --field.",
            rich_help_panel=MOVING_DIRT,
        ),
    ] = None
    defocus: Annotated[
        str | None,
        typer.Option(
            "--defocus",
            help="W20, optical path at the rim over that at the centre: 275nm, or 0.5waves of 550 nm.",
            rich_help_panel=WAVEFRONT,
        ),
    ] = None
    focus_shift: Annotated[
        str | None,
        typer.Option(
            "--focus-shift",
            help="Defocus as the way from the sensor to the focus, positive beyond it: 50um.",
            rich_help_panel=WAVEFRONT,
        ),
    ] = None
    zernike: Annotated[
        list[str] | None,
        typer.Option(
            "--zernike",
            help=f"Zernike polynomial (Noll) and its RMS: 3,1=30nm or coma-x=0.05waves; repeat it. {NAMES}.",
            rich_help_panel=WAVEFRONT,
        ),
    ] = None

    def values(self) -> dict[str, Any]:
        """Return what the flags mean, by the names of an `Opening`."""
        return {
            "spiders": self.spiders,
            "spider_width": _length(self.spider_width, "spider-width", "0.1mm"),
            "spider_rotation": _angle(self.spider_rotation, "spider-rotation"),
            "shadow": None if self.shadow is None else numbers(self.shadow, "shadow", 3),
            "housing": None if self.housing is None else numbers(self.housing, "housing", 3),
            "dust": None if self.dust is None else ratio(self.dust, "dust"),
            "dust_scale": _length(self.dust_scale, "dust-scale", "0.2mm"),
            "dust_stretch": self.dust_stretch,
            "dust_angle": _angle(self.dust_angle, "dust-angle"),
            "scratches": self.scratches,
            "eyelashes": self.eyelashes,
            "lid_opening": self.lid_opening,
            "seed": self.seed,
            "dirt_drift": None if self.dirt_drift is None else lengths(self.dirt_drift, "dirt-drift"),
            "dust_speed": self.dust_speed,
            "dirt_time": None if self.dirt_time is None else units.seconds(self.dirt_time, "dirt-time"),
            "dirt_distance": _signed_length(self.dirt_distance, "dirt-distance", "20mm"),
            "defocus": None if self.defocus is None else path(self.defocus, "defocus"),
            "focus_shift": _signed_length(self.focus_shift, "focus-shift", "50um"),
            "zernike": None if not self.zernike else tuple(zernike_term(text) for text in self.zernike),
        }


def with_flags(name: str, record: type) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command all flags of a record; its parameter of this name gets them as one.

    Parameters
    ----------
    name : str
        Of a parameter of the command.
    record : type
        A dataclass, each of whose fields is annotated with its option and has a default.

    Returns
    -------
    callable
        Takes a command, returns one with a parameter for each flag instead.
    """
    added = [
        inspect.Parameter(f.name, inspect.Parameter.KEYWORD_ONLY, default=f.default, annotation=f.type)
        for f in fields(record)
    ]

    def widened(command: Callable[..., None]) -> Callable[..., None]:
        signature = inspect.signature(command)
        kept = [p for p in signature.parameters.values() if p.name != name]

        @functools.wraps(command)
        def call(**given: Any) -> None:
            flags = record(**{parameter.name: given.pop(parameter.name) for parameter in added})
            command(**given, **{name: flags})

        parameters = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in kept] + added
        call.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        call.__annotations__ = {p.name: p.annotation for p in parameters}
        return call

    return widened


def numbers(text: str, name: str, count: int) -> tuple[Any, ...]:
    """Read numbers that are parted by commas.

    Parameters
    ----------
    text : str
        Such as "1,0.9,0.8".
    name : str
        The flag's name.
    count : int
        How many there must be.

    Returns
    -------
    tuple of float
        The numbers.
    """
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) != count:
        raise refuse.Refusal(f"'{name}' must be {count} numbers parted by commas, got '{text}'.")
    return tuple(refuse.finite(name, value) for value in values)


def lengths(text: str, name: str) -> tuple[float, float]:
    """Read two lengths that are parted by a comma.

    Parameters
    ----------
    text : str
        Such as "0.2mm,-0.1mm".
    name : str
        The flag's name.

    Returns
    -------
    tuple of float
        Metres.

    Raises
    ------
    refuse.Refusal
        Where the text is no two lengths.
    """
    parts = text.split(",")
    if len(parts) != 2:
        raise refuse.Refusal(
            f"'{name}' must be two lengths parted by a comma, such as 0.2mm,0mm, got '{text}'."
        )
    x, y = (units.length(part, name, "0.2mm,0mm") for part in parts)
    return x, y


def ratio(text: str, name: str) -> float:
    """Read a part of a whole.

    Parameters
    ----------
    text : str
        "0.3" or "30%".
    name : str
        The flag's name.

    Returns
    -------
    float
        0.3.

    Raises
    ------
    refuse.Refusal
        Where the text is no number.
    """
    word = text.strip()
    try:
        value = float(word.removesuffix("%"))
    except ValueError:
        raise refuse.Refusal(f"'{name}' must be a part such as 30% or 0.3, got '{text}'.") from None
    return refuse.finite(name, value / 100 if word.endswith("%") else value)


def path(text: str, name: str) -> float:
    """Read an optical path.

    Parameters
    ----------
    text : str
        A length with its unit, or a number of waves of 550 nm: "275nm", "0.5waves".
    name : str
        The flag's name.

    Returns
    -------
    float
        Metres.

    Raises
    ------
    refuse.Refusal
        Where the text is no such path.
    """
    word = text.strip()
    for unit in ("waves", "wave"):
        if word.endswith(unit):
            try:
                return refuse.finite(name, float(word.removesuffix(unit)) * WAVE)
            except ValueError:
                raise refuse.Refusal(f"'{name}' must be a path such as 0.5waves, got '{text}'.") from None
    return units.length(text, name, "275nm or 0.5waves")


def zernike_term(text: str) -> tuple[tuple[int, int], float]:
    """Read a Zernike polynomial and its root mean square.

    Parameters
    ----------
    text : str
        "3,1=30nm", "coma-x=30nm" or "coma-x=0.05waves".

    Returns
    -------
    tuple
        ((n, m), metres).

    Raises
    ------
    refuse.Refusal
        Where the text is none, or there is no such polynomial.
    """
    which, found, rms = text.partition("=")
    if not found:
        raise refuse.Refusal(f"'zernike' must be a term and its RMS, such as 3,1=30nm, got '{text}'.")
    try:
        orders = tuple(int(part) for part in which.split(","))
    except ValueError:
        return aperture.zernike_pair(which.strip()), path(rms, "zernike")
    if len(orders) != 2:
        raise refuse.Refusal(f"'zernike' must have two orders n,m, such as 3,1=30nm, got '{text}'.")
    return aperture.zernike_pair((orders[0], orders[1])), path(rms, "zernike")


def _length(text: str | None, name: str, example: str) -> float | None:
    return None if text is None else refuse.positive(name, units.length(text, name, example))


def _signed_length(text: str | None, name: str, example: str) -> float | None:
    return None if text is None else units.length(text, name, example)


def _angle(text: str | None, name: str) -> float | None:
    return None if text is None else units.angle(text, name)
