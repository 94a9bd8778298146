"""The command `aureole surface measure`: from photographs of a flat sample to its table."""

from typing import Annotated

import typer

from aureole import jobs, light, refuse
from aureole.cli import options, surface_runs
from aureole.cli.pupil_options import with_flags
from aureole.cli.surface_measure_options import (
    BenchFlags,
    PhotoFlags,
    Photos,
    ProcessingFlags,
    columns_of,
)
from aureole.cli.surface_options import (
    TABLE,
    ColourSpace,
    Illuminant,
    Preview,
    PreviewRange,
)

Model = Annotated[
    str,
    typer.Option(
        "--model",
        help="How the pattern's brightness goes with the wavelength: phase (shallow heights), amplitude "
        "(screens, masks) or paper (the power that the surface paper prints, that of amplitude).",
        rich_help_panel=TABLE,
    ),
]
ZeroOrder = Annotated[
    str,
    typer.Option(
        "--zero-order",
        help="The mirror's own highlight: keep it in the table, where it takes on a colour; remove it; or "
        "specular: draw it as an ordinary lobe, which stays white.",
        rich_help_panel=TABLE,
    ),
]


@with_flags("processing", ProcessingFlags)
@with_flags("bench", BenchFlags)
@with_flags("photos", PhotoFlags)
def measure(
    paths: Photos,
    out: options.Out,
    photos: PhotoFlags,
    bench: BenchFlags,
    processing: ProcessingFlags,
    model: Model = "phase",
    zero_order: ZeroOrder = "keep",
    zero_radius: Annotated[
        float | None,
        typer.Option(
            "--zero-radius", help="Of that highlight, in h; found unless given.", rich_help_panel=TABLE
        ),
    ] = None,
    illuminant: Illuminant = "D65",
    size: Annotated[
        int, typer.Option("--size", help="Samples on each side of the table.", rich_help_panel=TABLE)
    ] = 2048,
    warp: Annotated[
        int,
        typer.Option("--warp", help="Odd power that crowds samples where h is small.", rich_help_panel=TABLE),
    ] = 5,
    normalise: Annotated[
        bool,
        typer.Option(
            "--normalise",
            help="Darken the table, where needed, so that no more light comes back than was sent.",
            rich_help_panel=TABLE,
        ),
    ] = False,
    colour_space: ColourSpace = "xyz",
    preview: Preview = None,
    preview_range: PreviewRange = None,
    as_json: options.Json = False,
) -> None:
    """Measure a flat sample from photographs, and make its table under any light.

    Lay the sample flat, light it with one small lamp (a phone's flash) through a narrow filter, stand so
    that the lamp's mirror image is in the picture, and take a bracket of exposures without moving. The
    table is what the photographs show, laid out over h and scaled to all wavelengths.

    Examples:

        aureole surface measure bracket-*.tif -o sample.exr --linear --exposures 1,1/4,1/16,1/64
        --wavelength 530nm --band 10nm --camera-distance 60cm --lamp-distance 60cm --photo-width 12cm

        aureole surface measure phone.pfm -o phone.exr --wavelength 532nm --h-per-pixel 2.4e-5
        --model amplitude --zero-order specular --preview phone.png

        aureole surface measure b1.exr b2.exr g1.exr g2.exr r1.exr r2.exr -o foil.exr --exposures 1,1/8
        --wavelength 450nm,532nm,650nm --band 10nm --camera-distance 85cm --photo-width 20cm --tilt 5deg,0deg

        aureole surface measure wrapping.exr -o wrapping.exr.npz --colour E --h-per-pixel 1e-3 --json
    """
    refuse.one_of("colour-space", colour_space, light.SPACES)
    files = surface_runs.TableFiles(out, preview, preview_range, colour_space)
    files.places()
    found = processing.processing(paths, photos.linear)
    brackets = photos.brackets(paths)
    job = jobs.SurfaceMeasureJob(
        brackets,
        bench.geometry(columns_of(brackets)),
        processing.name or paths[0].stem,
        lamp=photos.colour,
        response=photos.response,
        processing=found,
        model=model,
        zero_order=zero_order,
        zero_radius=None if zero_radius is None else refuse.positive("zero-radius", zero_radius),
        illuminant=illuminant,
        size=refuse.at_least("size", size, 2),
        warp=warp,
        normalise=normalise,
        period=processing.known_period(),
    )
    surface_runs.table(job, files, as_json, "measure")
