"""The commands: each turns flags into a job, and hands it to `runs`."""

from pathlib import Path
from typing import Annotated

import typer

from aureole import jobs, light, presets, refuse, units
from aureole.cli import (
    bench,
    eye,
    flare,
    glare,
    job_commands,
    lamp_glare,
    lens,
    lights,
    nearfield,
    options,
    output,
    runs,
    surface,
)
from aureole.cli.options import FILES, ShapeFlags
from aureole.cli.pupil_options import PupilFlags, with_flags

app = typer.Typer(
    help="Add the light that a camera adds to a picture, from physics.\n\n"
    "Start with `aureole demo`. Lengths carry units (50mm, 550nm, 4um); angles are in degrees.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
)
app.add_typer(bench.app, name="bench")
app.add_typer(lens.app, name="lens")
lights.app.command()(lamp_glare.glare)
app.add_typer(lights.app, name="lights")
app.add_typer(surface.app, name="surface")


@app.callback(invoke_without_command=True)
def _version(
    version: Annotated[bool, typer.Option("--version", help="Print the version and leave.")] = False,
) -> None:
    if version:
        from aureole import __version__

        print(__version__)
        raise typer.Exit


app.command()(glare.glare)


@app.command()
@with_flags("pupil", PupilFlags)
def starburst(
    out: options.Out,
    pupil: PupilFlags,
    focal_length: options.FocalLength = None,
    f_number: options.FNumber = None,
    preset: options.Preset = None,
    sensor: options.Sensor = None,
    pitch: options.PixelPitch = None,
    iris: options.Iris = None,
    aperture: options.Shape = None,
    blades: options.Blades = None,
    curvature: options.Curvature = None,
    rotation: options.Rotation = None,
    obstruction: options.Obstruction = None,
    width: options.Width = None,
    height: options.Height = None,
    aperture_picture: options.ApertureFile = None,
    size: options.Size = "512",
    sample: options.Sample = "area",
    fade: options.Fade = 0.25,
    host: options.Host = None,
    illuminant: options.Illuminant = "E",
    wavelength: options.Wavelength = None,
    light_size: options.LightSize = None,
    colour_space: options.ColourSpace = "rec709",
    method: options.Method = "auto",
    preview: options.Preview = None,
    report: options.Page = None,
    as_json: options.Json = False,
) -> None:
    """Write the point spread function of a camera's aperture.

    Each pixel holds its share of the whole energy, so the sum tells how much the kernel holds.

    Examples:

        aureole starburst --f-number 16 --blades 7 --pixel-pitch 4um --size 1024 -o psf.exr

        aureole starburst --aperture circle --f-number 16 --wavelength 550nm --pixel-pitch 1um
        --sample point -o airy.exr

        aureole starburst --f-number 22 --pixel-pitch 6um --light-size 0.53deg -o sun.exr

        aureole starburst --preset full-frame-24mm-f22 --for unreal -o bloom.exr --preview bloom.png

        aureole starburst --aperture circle --obstruction 30% --spiders 4 --zernike coma-x=40nm
        --pixel-pitch 4um -o telescope.exr --report telescope.pdf
    """
    shape = ShapeFlags(
        aperture, blades, curvature, rotation, obstruction, width, height, aperture_picture, pupil
    )
    job = jobs.StarburstJob(
        options.optics(shape, preset, iris, focal_length, f_number, sensor),
        options.size(size),
        options.pixel_pitch(pitch),
        illuminant if wavelength is None else options.line(wavelength),
        refuse.one_of("colour-space", colour_space, light.SPACES),
        sample,
        method,
        fade,
        host,
        report is not None,
        0.0 if light_size is None else units.angle(light_size, "light-size"),
    )
    runs.starburst(job, out, preview, report, as_json)


app.command()(nearfield.nearfield)
app.command()(flare.flare)
app.command()(eye.eye)


@app.command()
@with_flags("pupil", PupilFlags)
def aperture(
    out: options.Out,
    pupil: PupilFlags,
    iris: options.Iris = None,
    shape: options.Shape = None,
    blades: options.Blades = None,
    curvature: options.Curvature = None,
    rotation: options.Rotation = None,
    obstruction: options.Obstruction = None,
    width: options.Width = None,
    height: options.Height = None,
    aperture_picture: options.ApertureFile = None,
    size: Annotated[int, typer.Option(help="Pixels on each side.")] = 512,
    finest: Annotated[
        str, typer.Option(help="Quadtree's finest level: full, half, quarter, eighth.")
    ] = "full",
    quadtree: Annotated[
        bool, typer.Option("--quadtree", help="Outline the quads: positive blue, negative red.")
    ] = False,
    merge: Annotated[bool, typer.Option("--merge", help="Merge quads across the tree's levels.")] = False,
    since: options.Since = None,
    as_json: options.Json = False,
) -> None:
    """Draw an aperture, and count what its transforms cost.

    Examples:

        aureole aperture --blades 9 --curvature 0.8 -o iris.png

        aureole aperture --aperture whirl --size 1024 -o whirl.exr --json

        aureole aperture --quadtree --size 128 --finest half -o quads.png

        aureole aperture --quadtree --merge --size 128 -o merged.png

        aureole aperture --dust 10% --scratches 5 --defocus 0.5waves -o dirty.png

        aureole aperture --shadow 0.1,0,0.4 -o before.exr

        aureole aperture --shadow 0.14,0,0.4 --since before.exr -o change.png
    """
    flags = ShapeFlags(
        shape, blades, curvature, rotation, obstruction, width, height, aperture_picture, pupil
    )
    earlier = None if since is None else str(since)
    job = jobs.ApertureJob(flags.opening(), iris, size, finest, quadtree, merge, earlier)
    runs.aperture(job, out, as_json)


@app.command()
def demo(
    folder: Annotated[
        Path, typer.Option("--folder", help="Where the files go.", rich_help_panel=FILES)
    ] = Path("demo"),
    size: Annotated[str, typer.Option(help="Pixels of the scene.")] = "1920x1080",
    seed: Annotated[int, typer.Option(help="Of the scene's chances.")] = 1,
    as_json: options.Json = False,
) -> None:
    """Run the main job on a bundled scene: a night by the water, 50 mm at f/16, seven blades.

    flare.exr has the starbursts of all lamps and the ghosts of the brightest three in a lens of 1927;
    ghosts.exr has the ghosts alone, scene.exr is the scene as it was.

    Example:

        aureole demo --folder demo
    """
    runs.demo(jobs.DemoJob(shape=options.size(size), seed=seed), folder, as_json)


@app.command(name="presets")
def list_presets(as_json: options.Json = False) -> None:
    """List the presets that come with Aureole.

    Example:

        aureole presets
    """
    found = {
        kind: {name: presets.load(kind, name).title for name in presets.names(kind)} for kind in presets.KINDS
    }
    if as_json:
        output.as_json(found)
        return
    for kind, titles in found.items():
        output.table(kind, titles)


job_commands.teach(app)
# This one reads a job file itself, and hands it to the command that the file names.
app.command(
    context_settings={
        "allow_extra_args": True,
        "ignore_unknown_options": True,
        "allow_interspersed_args": False,
    }
)(job_commands.run)
