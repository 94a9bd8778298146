"""Flags of the command `surface measure`: photographs, bench, processing, and what they mean."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from aureole import jobs, light, refuse, surface, units
from aureole.cli.pupil_options import numbers

PHOTOS, BENCH, PROCESSING = "Photographs", "Bench: where camera and lamp stood", "Processing"
CENTRES = ("auto", "core", "symmetry")
CHANNELS = ("mean", "red", "green", "blue")

Photos = Annotated[
    list[Path],
    typer.Argument(
        metavar="PHOTO...",
        help="One HDR photograph (EXR, HDR, PFM) or a bracket (TIFF, PNG, JPEG, EXR). With several "
        "wavelengths: as many for each, in their order.",
    ),
]


@dataclass(frozen=True)
class PhotoFlags:
    """The flags of the photographs, as text; each field's option teaches its use.

    Parameters
    ----------
    wavelength, band, exposures, channel, colour, linear, response : optional
        The photographs.
    """

    wavelength: Annotated[
        str | None,
        typer.Option(
            "--wavelength",
            help="Of the narrow filter before the lamp or the lens: 530nm; up to three, parted by commas: "
            "450nm,530nm,650nm.",
            rich_help_panel=PHOTOS,
        ),
    ] = None
    band: Annotated[
        str | None,
        typer.Option(
            "--band",
            help="The filter's full width at half its height: 10nm, or one for each wavelength. The smear "
            "that it makes is undone then.",
            rich_help_panel=PHOTOS,
        ),
    ] = None
    exposures: Annotated[
        str | None,
        typer.Option(
            "--exposures",
            help="Of the bracket's photographs, in seconds or relative: 1,1/4,1/16. What the files say "
            "(Exif) "
            "unless given.",
            rich_help_panel=PHOTOS,
        ),
    ] = None
    channel: Annotated[
        str,
        typer.Option("--channel", help="Of colour files: mean, red, green or blue.", rich_help_panel=PHOTOS),
    ] = "mean"
    colour: Annotated[
        str | None,
        typer.Option(
            "--colour",
            help="Instead of --wavelength: a white lamp's spectrum, such as E or D65; the three channels of "
            "colour photographs are the bands. A narrow filter measures better.",
            rich_help_panel=PHOTOS,
        ),
    ] = None
    linear: Annotated[
        bool,
        typer.Option(
            "--linear",
            help="Files of 8 and 16 bit hold linear light, as those made from raw files do.",
            rich_help_panel=PHOTOS,
        ),
    ] = False
    response: Annotated[
        bool,
        typer.Option(
            "--find-response",
            help="They hold neither linear light nor sRGB: find the camera's response from the bracket.",
            rich_help_panel=PHOTOS,
        ),
    ] = False

    def brackets(self, paths: Sequence[Path]) -> tuple[jobs.Bracket, ...]:
        """Read the photographs, band by band."""
        if (self.wavelength is None) == (self.colour is None):
            raise refuse.Refusal("give one of 'wavelength', such as 530nm, and 'colour', such as D65.")
        refuse.one_of("channel", self.channel, CHANNELS)
        if self.linear and self.response:
            raise refuse.Refusal("'linear' and 'find-response' do not go together; give one of them.")
        if self.colour is not None:
            light.illuminant(self.colour)
            if self.band is not None or self.channel != "mean":
                raise refuse.Refusal("'band' and 'channel' are a filter's; they do not go with 'colour'.")
            return (self._bracket(paths, 530e-9, None, "all"),)
        assert self.wavelength is not None
        places = _lengths(self.wavelength, "wavelength", "530nm")
        widths: list[float | None] = [None] if self.band is None else [*_lengths(self.band, "band", "10nm")]
        widths = widths * len(places) if len(widths) == 1 else widths
        if len(widths) != len(places):
            raise refuse.Refusal(f"'band' must be one, or one for each of {len(places)} wavelengths.")
        each, left = divmod(len(paths), len(places))
        if left or not each:
            raise refuse.Refusal(
                f"{len(places)} wavelengths need as many photographs each, got {len(paths)} in all."
            )
        return tuple(
            self._bracket(paths[k * each : (k + 1) * each], place, widths[k], self.channel)
            for k, place in enumerate(places)
        )

    def _bracket(
        self, paths: Sequence[Path], wavelength: float, width: float | None, channel: str
    ) -> jobs.Bracket:
        """Read one band's photographs, and find their exposures."""
        transfer = "linear" if self.linear or self.response else "auto"
        read = surface.read_photographs(paths, channel, transfer)
        times: Any = read.exposures
        if self.exposures is not None:
            times = _exposures(self.exposures)
            if len(times) != len(paths):
                raise refuse.Refusal(
                    f"'exposures' must be one for each of {len(paths)} photographs, got {len(times)}."
                )
        elif len(paths) == 1:
            times = (1.0,)
        elif times is None:
            raise refuse.Refusal(
                "'exposures' is missing, and the files do not say it: --exposures 1,1/4,1/16."
            )
        return jobs.Bracket(read.planes, times, wavelength, width)


@dataclass(frozen=True)
class BenchFlags:
    """The flags of the bench, as text; each field's option teaches its use.

    Parameters
    ----------
    h_per_pixel, camera_distance, lamp_distance, photo_width, tilt, rotation : optional
        Where camera and lamp stood.
    """

    h_per_pixel: Annotated[
        float | None,
        typer.Option(
            "--h-per-pixel",
            help="Step of h from pixel to pixel, where camera and lamp are far away: 2.4e-5. Instead of the "
            "distances.",
            rich_help_panel=BENCH,
        ),
    ] = None
    camera_distance: Annotated[
        str | None,
        typer.Option("--camera-distance", help="From the lens to the sample: 60cm.", rich_help_panel=BENCH),
    ] = None
    lamp_distance: Annotated[
        str | None,
        typer.Option(
            "--lamp-distance",
            help="From the lamp to the sample: 1.2m; far, where it is so. The same as the camera's unless "
            "given.",
            rich_help_panel=BENCH,
        ),
    ] = None
    photo_width: Annotated[
        str | None,
        typer.Option(
            "--photo-width",
            help="What the photograph's width is at the sample: 15cm; put a ruler there.",
            rich_help_panel=BENCH,
        ),
    ] = None
    tilt: Annotated[
        str | None,
        typer.Option(
            "--tilt",
            help="How the sample leans, its normal up and to the right as the camera sees it: 5deg,0deg.",
            rich_help_panel=BENCH,
        ),
    ] = None
    rotation: Annotated[
        str,
        typer.Option(
            "--rotation",
            help="From the photograph's right, counter-clockwise, to the sample's tangent.",
            rich_help_panel=BENCH,
        ),
    ] = "0deg"

    def geometry(self, columns: int) -> surface.BenchGeometry | surface.UniformGeometry:
        """Return where camera and lamp stood, for photographs of so many columns."""
        turn = units.angle(self.rotation, "rotation")
        distances = {
            "camera-distance": self.camera_distance,
            "lamp-distance": self.lamp_distance,
            "photo-width": self.photo_width,
            "tilt": self.tilt,
        }
        if self.h_per_pixel is not None:
            for name, value in distances.items():
                if value is not None:
                    raise refuse.Refusal(f"'{name}' does not go with 'h-per-pixel'; give one or the other.")
            return surface.UniformGeometry(refuse.positive("h-per-pixel", self.h_per_pixel), turn)
        if self.camera_distance is None or self.photo_width is None:
            raise refuse.Refusal(
                "give 'h-per-pixel', or 'camera-distance' and 'photo-width' (with 'lamp-distance', 'tilt')."
            )
        away = _length(self.camera_distance, "camera-distance", "60cm")
        lamp = away
        if self.lamp_distance is not None:
            far = self.lamp_distance.strip().lower() == "far"
            lamp = math.inf if far else _length(self.lamp_distance, "lamp-distance", "1.2m")
        width = _length(self.photo_width, "photo-width", "15cm")
        up, right = (0.0, 0.0) if self.tilt is None else _angles(self.tilt)
        return surface.BenchGeometry(away, lamp, width / columns, (up, right), turn)


@dataclass(frozen=True)
class ProcessingFlags:
    """The flags of the processing, as text; each field's option teaches its use.

    Parameters
    ----------
    black, saturation, flat, centre, blur, iterations, irradiance, reflectance, name, period : optional
        The processing.
    """

    black: Annotated[
        str,
        typer.Option(
            "--black",
            help="What the files show without light: a number, estimate (from a bracket), or a dark "
            "photograph's file.",
            rich_help_panel=PROCESSING,
        ),
    ] = "0"
    saturation: Annotated[
        float | None,
        typer.Option(
            "--saturation",
            help="Value at which the files clip; 1 for files of 8 and 16 bit unless given, none for others.",
            rich_help_panel=PROCESSING,
        ),
    ] = None
    flat: Annotated[
        Path | None,
        typer.Option(
            "--flat",
            help="A photograph of an evenly lit white sheet: how the lens darkens to the corners.",
            rich_help_panel=PROCESSING,
        ),
    ] = None
    centre: Annotated[
        str,
        typer.Option(
            "--centre",
            help="The mirror's highlight: row,column in pixels from the upper left; or auto, core or "
            "symmetry, "
            "which find it.",
            rich_help_panel=PROCESSING,
        ),
    ] = "auto"
    blur: Annotated[
        float | None,
        typer.Option(
            "--blur",
            help="The lens's blur in pixels (standard deviation), which is undone. 0.7 with --band unless "
            "given.",
            rich_help_panel=PROCESSING,
        ),
    ] = None
    iterations: Annotated[
        int,
        typer.Option(
            "--iterations", help="Of undoing blur and the filter's width.", rich_help_panel=PROCESSING
        ),
    ] = 10
    irradiance: Annotated[
        float,
        typer.Option(
            "--irradiance",
            help="On the sample, in the photographs' unit: what a white sheet there shows, times pi. 1 "
            "leaves "
            "the scale unknown; --normalise bounds it.",
            rich_help_panel=PROCESSING,
        ),
    ] = 1.0
    reflectance: Annotated[
        float,
        typer.Option(
            "--reflectance",
            help="Fresnel's, of the sample straight on, which is divided out: 0.9.",
            rich_help_panel=PROCESSING,
        ),
    ] = 1.0
    name: Annotated[
        str | None,
        typer.Option(
            "--name",
            help="What to call the sample; the first file's name unless given.",
            rich_help_panel=PROCESSING,
        ),
    ] = None
    period: Annotated[
        str | None,
        typer.Option(
            "--period",
            help="The sample's known period, to check wavelength and distances by: 1.6um.",
            rich_help_panel=PROCESSING,
        ),
    ] = None

    def processing(self, paths: Sequence[Path], linear: bool) -> dict[str, Any]:
        """Return what `aureole.surface.measure_pattern` takes."""
        found: dict[str, Any] = {
            "black": self._black(len(paths), linear),
            "saturation": self._saturation(paths),
            "centre": self._centre(),
            "blur": None if self.blur is None else refuse.between("blur", self.blur, 0.0, 100.0),
            "iterations": refuse.at_least("iterations", self.iterations, 1),
            "irradiance": refuse.positive("irradiance", self.irradiance),
            "reflectance": refuse.between("reflectance", self.reflectance, 1e-6, 1.0),
        }
        if self.flat is not None:
            found["flat"] = jobs.read_plane(self.flat, "linear" if linear else "auto")
        return found

    def known_period(self) -> float | None:
        """Return the sample's period, None where it is not known."""
        return None if self.period is None else _length(self.period, "period", "1.6um")

    def _black(self, count: int, linear: bool) -> Any:
        """Read a number, a word, or a dark photograph."""
        if self.black == "estimate":
            if count < 2:
                raise refuse.Refusal("'black' can be estimated from a bracket only; give a number or a file.")
            return self.black
        try:
            return refuse.finite("black", float(self.black))
        except ValueError:
            path = Path(self.black)
        if not path.suffix:
            raise refuse.Refusal(
                f"'black' must be a number, estimate or a dark photograph's file, got '{self.black}'."
            )
        return [jobs.read_plane(path, "linear" if linear else "auto")] * count

    def _saturation(self, paths: Sequence[Path]) -> float | None:
        if self.saturation is not None:
            return refuse.positive("saturation", self.saturation)
        clipping = (".png", ".jpg", ".jpeg", ".tif", ".tiff")
        return 1.0 if all(path.suffix.lower() in clipping for path in paths) else None

    def _centre(self) -> Any:
        """Read a method or a place."""
        if self.centre in CENTRES:
            return self.centre
        if "," not in self.centre:
            raise refuse.Refusal(
                f"'centre' must be row,column such as 499.5,512, or {', '.join(CENTRES)}, got "
                f"'{self.centre}'."
            )
        return numbers(self.centre, "centre", 2)


def columns_of(brackets: tuple[jobs.Bracket, ...]) -> int:
    """Return how many columns the photographs have; refuse brackets of different sizes.

    Parameters
    ----------
    brackets : tuple of Bracket
        One for each band.

    Returns
    -------
    int
        Pixels.
    """
    shapes = {np.shape(bracket.photos[0])[:2] for bracket in brackets}
    if len(shapes) > 1:
        raise refuse.Refusal("the photographs of all wavelengths must be of one size.")
    return int(shapes.pop()[1])


def _exposures(text: str) -> list[float]:
    """Read "1,1/4,0.5s"."""
    try:
        times = [float(Fraction(word.strip().removesuffix("s").strip())) for word in text.split(",")]
    except (ValueError, ZeroDivisionError):
        raise refuse.Refusal(f"'exposures' must be such as 1,1/4,1/16, got '{text}'.") from None
    return [refuse.positive("exposures", value) for value in times]


def _lengths(text: str, name: str, example: str) -> list[float]:
    return [_length(word.strip(), name, example) for word in text.split(",")]


def _length(text: str, name: str, example: str) -> float:
    return refuse.positive(name, units.length(text, name, example))


def _angles(text: str) -> tuple[float, float]:
    """Read "5deg,0deg"."""
    words = [word.strip() for word in text.split(",")]
    if len(words) != 2:
        raise refuse.Refusal(f"'tilt' must be two angles such as 5deg,0deg, got '{text}'.")
    up, right = (units.angle(word, "tilt") for word in words)
    return up, right
