"""Flags of the near field: where the plane is, what light falls on it, how it moves, and textures of it."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any

import typer

from aureole import refuse, units
from aureole.cli import options
from aureole.cli.options import FILES
from aureole.cli.pupil_options import ratio
from aureole.jobs import NearFieldJob, NearTextureJob, Sweep, frame_files
from aureole.jobs.near_texture import MARGIN

MOST_STOPS = 100.0
PLANE, LIGHT, METHOD, SWEEP, TEXTURE = "Plane", "Light", "Method", "Many distances", "Texture for ghosts"

Shape = Annotated[
    str | None,
    typer.Option(
        "--aperture",
        help="iris, circle, rectangle, whirl, picture, or half-plane: a straight edge through the axis.",
        rich_help_panel=options.SHAPE,
    ),
]
Width = Annotated[
    str | None,
    typer.Option(
        "--width",
        help="Opening's width: 2mm; else that of the default camera, 3.125mm.",
        rich_help_panel=options.SHAPE,
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        help="File to write: EXR, HDR and TIFF hold irradiance itself, PNG and JPEG show it. With --sweep "
        "a name with #### for each plane's number, or one without for a strip of all planes.",
        rich_help_panel=FILES,
    ),
]
Amplitude = Annotated[
    Path | None,
    typer.Option(
        "--amplitude",
        help="Also write the complex amplitude: .npz, or .exr with channels amplitude.real and "
        "amplitude.imaginary.",
        rich_help_panel=FILES,
    ),
]
Exposure = Annotated[
    str | None,
    typer.Option(
        "--exposure",
        help="Stops for PNG and JPEG, 0 shows an irradiance of 1 as white; auto, the brightest fits. Planes "
        "of a sweep are shown at -2 unless this says another.",
        rich_help_panel=FILES,
    ),
]


@dataclass(frozen=True)
class PlaneFlags:
    """The flags of a plane and its light, as text; each field's option teaches its use.

    Parameters
    ----------
    obstacle : bool
        Of the shape.
    distance, fresnel_number, extent, size, centre : optional
        The plane.
    wavelength, illuminant, spectral, samples, colour_space : optional
        The light.
    method, finest, cull : optional
        The way to compute it.
    """

    obstacle: Annotated[
        bool,
        typer.Option(
            "--obstacle", help="The shape blocks the light, all else is open.", rich_help_panel=options.SHAPE
        ),
    ] = False
    distance: Annotated[
        str | None, typer.Option("--distance", help="From the opening: 0.5m.", rich_help_panel=PLANE)
    ] = None
    fresnel_number: Annotated[
        float | None,
        typer.Option(
            "--fresnel-number",
            help="In place of the distance: (width/2)^2 / (wavelength x distance), such as 30.",
            rich_help_panel=PLANE,
        ),
    ] = None
    extent: Annotated[
        str | None,
        typer.Option(
            "--extent", help="Width of the plane: 4mm; twice the opening's otherwise.", rich_help_panel=PLANE
        ),
    ] = None
    size: Annotated[str, typer.Option("--size", help="Pixels: 512, or 640x480.", rich_help_panel=PLANE)] = (
        "512"
    )
    centre: Annotated[
        str | None,
        typer.Option(
            "--centre",
            help="Plane's middle pixel, x,y from the axis, y downward: 1mm,0mm.",
            rich_help_panel=PLANE,
        ),
    ] = None
    wavelength: Annotated[
        str | None,
        typer.Option("--wavelength", help="One wavelength; 550nm unless given.", rich_help_panel=LIGHT),
    ] = None
    illuminant: Annotated[
        str | None,
        typer.Option(
            "--illuminant", help="Colour instead: E, A, D65, F1 or blackbody:3200K.", rich_help_panel=LIGHT
        ),
    ] = None
    spectral: Annotated[
        str,
        typer.Option(
            "--spectral",
            help="exact: each wavelength by itself; approximate: one pattern scaled, fast and not accurate.",
            rich_help_panel=LIGHT,
        ),
    ] = "exact"
    samples: Annotated[
        int | None,
        typer.Option("--samples", help="How many wavelengths make the colour.", rich_help_panel=LIGHT),
    ] = None
    colour_space: options.ColourSpace = "rec709"
    method: Annotated[
        str,
        typer.Option(
            "--method",
            help="auto, reference, polygons (exact outlines), or rows, quads and fft, which take pixels.",
            rich_help_panel=METHOD,
        ),
    ] = "auto"
    finest: Annotated[
        str,
        typer.Option(
            "--finest",
            help="Opening's pixels: full, half, quarter or eighth of its 1024 a side, for speed.",
            rich_help_panel=METHOD,
        ),
    ] = "full"
    cull: Annotated[
        float | None,
        typer.Option(
            "--cull", help="Leave dark what stays below this irradiance: 1e-6.", rich_help_panel=METHOD
        ),
    ] = None
    memory: options.Memory = None

    def values(self) -> dict[str, Any]:
        """Return what the flags mean, by the names of a `NearFieldJob`."""
        return {
            "obstacle": self.obstacle,
            "distance": _length(self.distance, "distance", "0.5m"),
            "fresnel_number": self.fresnel_number,
            "wavelength": _length(self.wavelength, "wavelength", "550nm"),
            "illuminant": self.illuminant,
            "spectral": self.spectral,
            "samples": None if self.samples is None else refuse.at_least("samples", self.samples, 1),
            "shape": options.size(self.size),
            "extent": _length(self.extent, "extent", "4mm"),
            "centre": (0.0, 0.0) if self.centre is None else place(self.centre),
            "method": self.method,
            "finest": self.finest,
            "cull": self.cull,
            "colour_space": self.colour_space,
            "memory": options.memory(self.memory),
        }


@dataclass(frozen=True)
class SweepFlags:
    """The flags of many distances, as text; each field's option teaches its use.

    Parameters
    ----------
    sweep, sweep_by : optional
        The distances.
    zoom : bool
        Whether planes grow with the distance.
    frames : optional
        Which of them are wanted.
    overwrite : bool
        Whether files of frames that are there are made again.
    strip, section : Path, optional
        Files to write.
    """

    sweep: Annotated[
        str | None,
        typer.Option(
            "--sweep",
            help="First distance, last distance and how many: 0.05m:2m:48.",
            rich_help_panel=SWEEP,
        ),
    ] = None
    sweep_by: Annotated[
        str,
        typer.Option(
            "--sweep-by",
            help="What is evenly spaced: log (each is the one before times a factor), distance or "
            "fresnel-number.",
            rich_help_panel=SWEEP,
        ),
    ] = "log"
    zoom: Annotated[
        bool,
        typer.Option(
            "--zoom",
            help="Each plane is wider by 8 x wavelength x distance / opening's width, as its light spreads; "
            "all are of one size otherwise.",
            rich_help_panel=SWEEP,
        ),
    ] = False
    frames: Annotated[
        str | None,
        typer.Option("--frames", help="Only these planes: 1-48x2, or 3,7,9.", rich_help_panel=SWEEP),
    ] = None
    overwrite: Annotated[
        bool,
        typer.Option(
            "--overwrite",
            help="Make all planes anew; those that lie there whole from this job are kept otherwise.",
            rich_help_panel=SWEEP,
        ),
    ] = False
    strip: Annotated[
        Path | None,
        typer.Option("--strip", help="Also write small pictures of all planes.", rich_help_panel=SWEEP),
    ] = None
    section: Annotated[
        Path | None,
        typer.Option(
            "--section",
            help="Also write the line across each plane at --centre, a row of --size for each of as many "
            "distances, the first on top.",
            rich_help_panel=SWEEP,
        ),
    ] = None

    def wanted(self) -> bool:
        """Return whether there is a sweep; refuse flags that need one."""
        for name in ("zoom", "frames", "overwrite", "strip", "section"):
            if self.sweep is None and getattr(self, name):
                raise refuse.Refusal(f"'{name}' needs 'sweep', such as --sweep 0.05m:2m:48.")
        return self.sweep is not None

    def distances(self) -> tuple[Sweep, int | None]:
        """Return the distances, and how many planes where that is said."""
        assert self.sweep is not None
        parts = self.sweep.split(":")
        if len(parts) not in (2, 3):
            raise _no_sweep(self.sweep)
        first, last = (units.length(part, "sweep", "0.05m:2m:48") for part in parts[:2])
        for value in (first, last):
            refuse.positive("sweep", value)
        if len(parts) == 2:
            return Sweep(first, last, self.sweep_by), None
        try:
            count = int(parts[2])
        except ValueError:
            raise _no_sweep(self.sweep) from None
        return Sweep(first, last, self.sweep_by), refuse.at_least("planes of the sweep", count, 2)

    def numbers(self) -> tuple[int, ...] | None:
        """Return the planes that are wanted; None for all."""
        return None if self.frames is None else frame_files.numbers(self.frames)


@dataclass(frozen=True)
class TextureFlags:
    """The flags of a ringing texture, as text; each field's option teaches its use.

    Parameters
    ----------
    texture : bool
        Whether it is wanted.
    margin : optional
        Of its square.
    """

    texture: Annotated[
        bool,
        typer.Option(
            "--texture",
            help="Write a ringing texture for lens-flare ghosts instead: each pixel the mean over its area, "
            "on the square of the opening's width and --margin more on each side; needs --fresnel-number.",
            rich_help_panel=TEXTURE,
        ),
    ] = False
    margin: Annotated[
        str | None,
        typer.Option(
            "--margin",
            help="Of the texture on each side, in parts of the opening's width: 25%, or 0.25.",
            rich_help_panel=TEXTURE,
        ),
    ] = None

    def wanted(self, many: SweepFlags) -> bool:
        """Return whether a texture is wanted; refuse flags that need one, or do not go with it."""
        if not self.texture:
            if self.margin is not None:
                raise refuse.Refusal("'margin' needs 'texture'.")
            return False
        for flag in fields(many):
            if getattr(many, flag.name) != flag.default:
                raise refuse.Refusal(f"'{flag.name}' does not go with 'texture', which is one picture.")
        return True

    def job(self, plane: NearFieldJob) -> NearTextureJob:
        """Return the job of the texture behind a plane's opening."""
        return NearTextureJob(plane, MARGIN if self.margin is None else ratio(self.margin, "margin"))


def place(text: str) -> tuple[float, float]:
    """Read a place on the plane.

    Parameters
    ----------
    text : str
        Two lengths, "1mm,0mm".

    Returns
    -------
    tuple of float
        (x, y) in metres.

    Raises
    ------
    refuse.Refusal
        Where the text is no such place.
    """
    parts = text.split(",")
    if len(parts) != 2:
        raise refuse.Refusal(f"'centre' must be two lengths such as 1mm,0mm, got '{text}'.")
    x, y = (units.length(part, "centre", "1mm,0mm") for part in parts)
    return x, y


def exposure(text: str | None) -> float | str | None:
    """Read an exposure.

    Parameters
    ----------
    text : str, optional
        Stops, or "auto".

    Returns
    -------
    float, "auto" or None
        None where it is left out.

    Raises
    ------
    refuse.Refusal
        Where the text is neither.
    """
    if text is None or text == "auto":
        return text
    try:
        stops = float(text)
    except ValueError:
        raise refuse.Refusal(f"'exposure' must be stops such as -1.5, or auto, got '{text}'.") from None
    return refuse.between("exposure", stops, -MOST_STOPS, MOST_STOPS)


def _no_sweep(text: str) -> refuse.Refusal:
    return refuse.Refusal(
        f"'sweep' must be the first distance, the last and how many, such as 0.05m:2m:48, got '{text}'."
    )


def _length(text: str | None, name: str, example: str) -> float | None:
    return None if text is None else refuse.positive(name, units.length(text, name, example))
