"""Flags that several commands share, and what they mean."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import typer

from aureole import refuse, units
from aureole.cli.pupil_options import PupilFlags, ratio
from aureole.jobs import Opening, Optics

CAMERA, SHAPE, FILES, MIXING, KERNEL = "Camera", "Aperture", "Files", "Compositing", "Kernel"

Preset = Annotated[
    str | None,
    typer.Option(
        "--preset", help="Camera preset, or a TOML file; see `aureole presets`.", rich_help_panel=CAMERA
    ),
]
Iris = Annotated[
    str | None,
    typer.Option("--iris", help="Iris preset, or a TOML file; see `aureole presets`.", rich_help_panel=SHAPE),
]
FocalLength = Annotated[
    str | None, typer.Option("--focal-length", help="Such as 50mm.", rich_help_panel=CAMERA)
]
FNumber = Annotated[float | None, typer.Option("--f-number", help="Such as 16.", rich_help_panel=CAMERA)]
Sensor = Annotated[
    str | None,
    typer.Option("--sensor", help="Width, or width x height: 36mm, 36mmx24mm.", rich_help_panel=CAMERA),
]
PixelPitch = Annotated[
    str | None,
    typer.Option("--pixel-pitch", help="Pixel size on the sensor, such as 4um.", rich_help_panel=CAMERA),
]
Shape = Annotated[
    str | None,
    typer.Option("--aperture", help="iris, circle, rectangle, whirl or picture.", rich_help_panel=SHAPE),
]
Blades = Annotated[
    int | None, typer.Option("--blades", help="Blades of the iris, arms of the whirl.", rich_help_panel=SHAPE)
]
Curvature = Annotated[
    float | None,
    typer.Option("--curvature", help="Of the blades: 0 straight to 1 circle.", rich_help_panel=SHAPE),
]
Rotation = Annotated[
    str | None,
    typer.Option("--rotation", help="Degrees, counter-clockwise: 10 or 10deg.", rich_help_panel=SHAPE),
]
Obstruction = Annotated[
    str | None,
    typer.Option(
        "--obstruction", help="Central disc's diameter over the opening's: 30% or 0.3.", rich_help_panel=SHAPE
    ),
]
Width = Annotated[
    str | None,
    typer.Option("--width", help="Opening's width, in place of the f-number: 2mm.", rich_help_panel=SHAPE),
]
Height = Annotated[
    str | None, typer.Option("--height", help="Rectangle's height: 1mm.", rich_help_panel=SHAPE)
]
ApertureFile = Annotated[
    Path | None,
    typer.Option("--aperture-picture", help="Picture whose white lets light through.", rich_help_panel=SHAPE),
]
Since = Annotated[
    Path | None,
    typer.Option(
        "--since",
        help="Picture of it a moment before: draw the change's quads, opened green, covered red.",
        rich_help_panel=FILES,
    ),
]
Illuminant = Annotated[
    str,
    typer.Option(
        "--illuminant",
        help="E, A, D65, F1, LED-B1..5, blackbody:3200K or line:550nm.",
        rich_help_panel="Light",
    ),
]
ColourSpace = Annotated[
    str, typer.Option("--colour-space", help="rec709, acescg, rec2020 or xyz.", rich_help_panel="Light")
]
Json = Annotated[bool, typer.Option("--json", help="Print a machine-readable result.", rich_help_panel=FILES)]
Out = Annotated[
    Path,
    typer.Option("--output", "-o", help="File to write; its suffix says the format.", rich_help_panel=FILES),
]
Preview = Annotated[
    Path | None, typer.Option("--preview", help="Also write a PNG to look at.", rich_help_panel=FILES)
]
Page = Annotated[
    Path | None,
    typer.Option(
        "--report",
        help="Also write a page of MTF, encircled energy and numbers: PNG, JPEG, PDF or SVG.",
        rich_help_panel=FILES,
    ),
]
Memory = Annotated[
    str | None,
    typer.Option(
        "--memory", help="Most to use, such as 8GB; three quarters of what is free.", rich_help_panel=FILES
    ),
]

Source = Annotated[Path, typer.Argument(metavar="IN", help="Linear HDR picture: EXR, HDR, TIFF, PNG, JPEG.")]
Mode = Annotated[
    str,
    typer.Option(
        help="replace, scatter, add or bloom (as scatter, many times faster).", rich_help_panel=MIXING
    ),
]
Threshold = Annotated[
    float, typer.Option(help="Mode add: luminance above which light spreads.", rich_help_panel=MIXING)
]
Knee = Annotated[
    float, typer.Option(help="Mode add: softness of the threshold, 0 to 1.", rich_help_panel=MIXING)
]
Gain = Annotated[float, typer.Option(help="Mode add: strength.", rich_help_panel=MIXING)]
Tint = Annotated[str, typer.Option(help="Mode add: red,green,blue factors.", rich_help_panel=MIXING)]
Matte = Annotated[
    Path | None, typer.Option(help="Picture whose white marks the sources of glare.", rich_help_panel=MIXING)
]
KernelSide = Annotated[
    int | None,
    typer.Option(
        help="Kernel's side in pixels; a camera's is the picture's longer side, an eye's reaches all over "
        "it.",
        rich_help_panel=MIXING,
    ),
]
Precision = Annotated[
    str,
    typer.Option(
        help="double; single is faster, less exact in darks by bright lamps.", rich_help_panel=MIXING
    ),
]
Psf = Annotated[
    Path | None, typer.Option(help="Also write the point spread function.", rich_help_panel=FILES)
]
PixelType = Annotated[str, typer.Option(help="auto (float for EXR), half, float.", rich_help_panel=FILES)]
Nan = Annotated[
    Literal["refuse", "zero"], typer.Option(help="refuse, or zero to mend NaN.", rich_help_panel=FILES)
]
ColorConfig = Annotated[
    Path | None, typer.Option(help="OpenColorIO configuration; $OCIO otherwise.", rich_help_panel=FILES)
]
ColorSpace = Annotated[
    str | None, typer.Option(help="IN's and OUT's space in that configuration.", rich_help_panel=FILES)
]
Size = Annotated[str, typer.Option(help="Pixels: 512, or 640x480.", rich_help_panel=KERNEL)]
Sample = Annotated[
    str, typer.Option(help="area: energy of each pixel; point: at its centre.", rich_help_panel=KERNEL)
]
Fade = Annotated[
    float,
    typer.Option(help="Part of the half size that fades to zero at the border.", rich_help_panel=KERNEL),
]
Host = Annotated[
    str | None, typer.Option("--for", help="unreal, blender or nuke: its convention.", rich_help_panel=KERNEL)
]
Method = Annotated[str, typer.Option(help="auto, exact, scaled, batch or coherence.", rich_help_panel=KERNEL)]
Wavelength = Annotated[
    str | None, typer.Option(help="One wavelength, such as 550nm.", rich_help_panel="Light")
]

LightSize = Annotated[
    str | None,
    typer.Option(
        help="Angle across a disc-shaped light, such as 0.53deg for the sun.", rich_help_panel="Light"
    ),
]

BYTES = {"B": 1, "KB": 10**3, "MB": 10**6, "GB": 10**9, "TB": 10**12}


@dataclass(frozen=True)
class ShapeFlags:
    """The flags that describe an opening, as text.

    Parameters
    ----------
    aperture, blades, curvature, rotation, obstruction, width, height, picture : optional
        As typed.
    pupil : PupilFlags
        What stands in the opening, lies on it and bends its wave.
    """

    aperture: str | None = None
    blades: int | None = None
    curvature: float | None = None
    rotation: str | None = None
    obstruction: str | None = None
    width: str | None = None
    height: str | None = None
    picture: Path | None = None
    pupil: PupilFlags = field(default_factory=PupilFlags)

    def opening(self) -> Opening:
        """Return what the flags mean."""
        if self.blades is not None:
            refuse.at_least("blades", self.blades, 2 if self.aperture == "whirl" else 3)
        return Opening(
            shape=self.aperture,
            blades=self.blades,
            curvature=self.curvature,
            rotation=None if self.rotation is None else units.angle(self.rotation, "rotation"),
            obstruction=None if self.obstruction is None else ratio(self.obstruction, "obstruction"),
            width=_length(self.width, "width", "2mm"),
            height=_length(self.height, "height", "1mm"),
            picture=None if self.picture is None else str(self.picture),
            **self.pupil.values(),
        )


def optics(
    shape: ShapeFlags,
    preset: str | None,
    iris: str | None,
    focal_length: str | None,
    f_number: float | None,
    sensor: str | None,
) -> Optics:
    """Return the camera that the flags describe.

    Parameters
    ----------
    shape : ShapeFlags
        The opening's.
    preset, iris : str, optional
        Names of presets.
    focal_length : str, optional
        With its unit.
    f_number : float, optional
        A number above zero.
    sensor : str, optional
        "36mm" or "36mmx24mm".

    Returns
    -------
    Optics
        For a job.

    Raises
    ------
    refuse.Refusal
        Where a value cannot be read.
    """
    width, height = sensor_size(sensor)
    return Optics(
        opening=shape.opening(),
        preset=preset,
        iris=iris,
        focal_length=_length(focal_length, "focal-length", "50mm"),
        f_number=None if f_number is None else refuse.positive("f-number", f_number),
        sensor_width=width,
        sensor_height=height,
    )


def sensor_size(text: str | None) -> tuple[float | None, float | None]:
    """Read "36mm" or "36mmx24mm".

    Parameters
    ----------
    text : str, optional
        As typed.

    Returns
    -------
    tuple of float or None
        Width and height in metres.
    """
    if text is None:
        return None, None
    width, _, height = text.replace("×", "x").partition("x")
    return (
        refuse.positive("sensor", units.length(width, "sensor", "36mmx24mm")),
        refuse.positive("sensor", units.length(height, "sensor", "36mmx24mm")) if height else None,
    )


def pixel_pitch(text: str | None) -> float | None:
    """Read a pixel's size.

    Parameters
    ----------
    text : str, optional
        As typed, with its unit.

    Returns
    -------
    float or None
        Metres.
    """
    return _length(text, "pixel-pitch", "4um")


def line(wavelength: str) -> str:
    """Return the name of a single wavelength's light.

    Parameters
    ----------
    wavelength : str
        As typed, with its unit.

    Returns
    -------
    str
        As `aureole.light.illuminant` reads it.
    """
    metres = units.length(wavelength, "wavelength", "550nm")
    return f"line:{refuse.positive('wavelength', metres) * 1e9:.6g}nm"


def size(text: str, name: str = "size") -> tuple[int, int]:
    """Read "512" or "640x480".

    Parameters
    ----------
    text : str
        Columns, or columns x rows.
    name : str
        The flag's name.

    Returns
    -------
    tuple of int
        (rows, columns).
    """
    columns, _, rows = text.replace("×", "x").partition("x")
    try:
        shape = int(rows or columns), int(columns)
    except ValueError:
        raise refuse.Refusal(f"'{name}' must be pixels such as 512 or 640x480, got '{text}'.") from None
    return refuse.at_least(name, shape[0], 1), refuse.at_least(name, shape[1], 1)


def memory(text: str | None) -> int | None:
    """Read an amount of memory.

    Parameters
    ----------
    text : str, optional
        A number with B, KB, MB, GB or TB.

    Returns
    -------
    int or None
        Bytes.
    """
    if text is None:
        return None
    word = text.strip().upper()
    unit = next((u for u in ("TB", "GB", "MB", "KB", "B") if word.endswith(u)), "")
    try:
        amount = float(word.removesuffix(unit)) * BYTES[unit]
    except (ValueError, KeyError):
        raise refuse.Refusal(
            f"'memory' must be an amount with its unit, such as 8GB, got '{text}'."
        ) from None
    return int(refuse.positive("memory", amount))


def _length(text: str | None, name: str, example: str) -> float | None:
    return None if text is None else refuse.positive(name, units.length(text, name, example))
