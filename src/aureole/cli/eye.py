"""The command `aureole eye`: what a point of light looks like to an eye, at a time or through time."""

from pathlib import Path
from typing import Annotated

import typer

from aureole import jobs, refuse, units
from aureole.cli import eye_runs, options
from aureole.cli.eye_options import EYE, AnimationFlags, EyeFlags
from aureole.cli.options import FILES
from aureole.cli.pupil_options import NAMES, with_flags

Preset = Annotated[
    str | None,
    typer.Option("--preset", help="Eye preset, or a TOML file; see `aureole presets`.", rich_help_panel=EYE),
]
Seed = Annotated[
    int | None,
    typer.Option("--seed", help="Which person: the same gives the same.", rich_help_panel=EYE),
]
Defocus = Annotated[
    str | None,
    typer.Option("--defocus", help="Out of focus by so many dioptres: 0.5D.", rich_help_panel=EYE),
]
Zernike = Annotated[
    list[str] | None,
    typer.Option(
        "--zernike",
        help=f"Zernike polynomial (Noll) and its RMS: 3,1=30nm or coma-x=40nm; repeat it. {NAMES}.",
        rich_help_panel=EYE,
    ),
]
Projection = Annotated[
    str,
    typer.Option(
        "--projection",
        help="angle: as many degrees in each pixel; perspective: as a picture shows them, to lay over one.",
        rich_help_panel=options.KERNEL,
    ),
]
From = Annotated[
    str | None,
    typer.Option(
        "--source",
        help="Where the light stands, to the right and downward: 10deg,-5deg. It moves the lashes' shadow.",
        rich_help_panel=options.KERNEL,
    ),
]
Parts = Annotated[
    Path | None,
    typer.Option(
        "--parts", help="Also draw the eye from the front, its parts in colours: PNG.", rich_help_panel=FILES
    ),
]
Look = Annotated[
    Path | None,
    typer.Option(
        "--preview",
        help="Also write a picture to look at, over many decades, with degrees: PNG, JPEG, PDF or SVG.",
        rich_help_panel=FILES,
    ),
]


@with_flags("moving", AnimationFlags)
@with_flags("flags", EyeFlags)
def eye(
    out: options.Out,
    flags: EyeFlags,
    moving: AnimationFlags,
    preset: Preset = None,
    seed: Seed = None,
    defocus: Defocus = None,
    zernike: Zernike = None,
    size: options.Size = "512",
    projection: Projection = "angle",
    source: From = None,
    illuminant: options.Illuminant = "E",
    wavelength: options.Wavelength = None,
    colour_space: options.ColourSpace = "rec709",
    preview: Look = None,
    parts: Parts = None,
    as_json: options.Json = False,
) -> None:
    """Write what a point of light looks like to an eye: its point spread function.

    Each pixel holds its share of the light that enters the eye, and stands for an angle as the eye sees it.
    The core is the pupil's; round it lie fine needles (particles in the eye), a coloured ring (fibres of the
    lens) and streaks (eyelashes and lids). What the eye is adapted to sets its pupil: in the dark it is wide,
    so that the ring appears. With --animate there is a picture for each moment; those in which the lids are
    shut are black.

    Examples:

        aureole eye -o psf.exr --luminance 0.1cd/m2 --age 30 --time 1.5 --size 1024 --field-of-view 60deg
        --preview psf.png

        aureole eye -o old.exr --age 70 --luminance 1cd/m2 --quick --json

        aureole eye -o ring.exr --luminance 0.001cd/m2 --wavelength 568nm --field-of-view 10deg
        --parts eye.png

        aureole eye -o soft.exr --defocus 0.5D --zernike coma-x=100nm --field-of-view 2deg

        aureole eye -o thesis.exr --preset ritschel-2009 --combine thesis --luminance 0.01cd/m2
        --field-of-view 4deg

        aureole eye --animate 4s --fps 24 --luminance-from 0.1cd/m2 --luminance-to 100cd/m2 --quick
        -o psf.####.exr --contact-sheet psf.png
    """
    how = flags.how()
    still = jobs.EyeJob(
        flags.viewer(preset, seed, defocus, zernike, moving.track(flags, how["time"])),
        shape=options.size(size),
        illuminant=illuminant if wavelength is None else options.line(wavelength),
        colour_space=colour_space,
        projection=projection,
        source=(0.0, 0.0) if source is None else _angles(source),
        parts=None if parts is None else eye_runs.PARTS_SIZE,
        **how,
    )
    if moving.wanted(out):
        for name, path in (("preview", preview), ("parts", parts)):
            if path is not None:
                raise refuse.Refusal(f"'{name}' is for one picture; it does not go with 'animate'.")
        eye_runs.animation(still, moving, out, as_json)
    else:
        eye_runs.still(still, out, preview, parts, as_json)


def _angles(text: str) -> tuple[float, float]:
    """Read two angles that are parted by a comma."""
    parts = text.split(",")
    if len(parts) != 2:
        raise refuse.Refusal(f"'source' must be two angles such as 10deg,-5deg, got '{text}'.")
    right, down = (units.angle(part.strip(), "source") for part in parts)
    return right, down
