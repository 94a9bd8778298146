"""The commands. Each turns flags into a job, runs it, and writes what came out."""

import time
from pathlib import Path
from typing import Annotated, Literal

import typer

from aureole import jobs, light, picture, presets, refuse
from aureole.cli import options, output, views
from aureole.cli.options import FILES, ShapeFlags

app = typer.Typer(
    help="Add the light that a camera adds to a picture, from physics.\n\n"
    "Start with `aureole demo`. Lengths carry units (50mm, 550nm, 4um); angles are in degrees.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
)


@app.callback(invoke_without_command=True)
def _version(
    version: Annotated[bool, typer.Option("--version", help="Print the version and leave.")] = False,
) -> None:
    if version:
        from aureole import __version__

        print(__version__)
        raise typer.Exit


@app.command()
def glare(
    source: Annotated[
        Path, typer.Argument(metavar="IN", help="Linear HDR picture: EXR, HDR, TIFF, PNG, JPEG.")
    ],
    out: options.Out,
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
    illuminant: options.Illuminant = "D65",
    mode: Annotated[
        str, typer.Option(help="replace, scatter or add.", rich_help_panel="Compositing")
    ] = "replace",
    threshold: Annotated[
        float,
        typer.Option(help="Mode add: luminance above which light spreads.", rich_help_panel="Compositing"),
    ] = 1.0,
    knee: Annotated[
        float,
        typer.Option(help="Mode add: softness of the threshold, 0 to 1.", rich_help_panel="Compositing"),
    ] = 0.5,
    gain: Annotated[float, typer.Option(help="Mode add: strength.", rich_help_panel="Compositing")] = 1.0,
    tint: Annotated[
        str, typer.Option(help="Mode add: red,green,blue factors.", rich_help_panel="Compositing")
    ] = "1,1,1",
    matte: Annotated[
        Path | None,
        typer.Option(help="Picture whose white marks the sources of glare.", rich_help_panel="Compositing"),
    ] = None,
    kernel_size: Annotated[
        int | None,
        typer.Option(
            help="Kernel's side in pixels; the picture's longer side.", rich_help_panel="Compositing"
        ),
    ] = None,
    psf: Annotated[
        Path | None, typer.Option(help="Also write the point spread function.", rich_help_panel=FILES)
    ] = None,
    preview: options.Preview = None,
    pixel_type: Annotated[
        str, typer.Option(help="auto (float for EXR), half, float.", rich_help_panel=FILES)
    ] = "auto",
    nan: Annotated[
        Literal["refuse", "zero"], typer.Option(help="refuse, or zero to mend NaN.", rich_help_panel=FILES)
    ] = "refuse",
    color_config: Annotated[
        Path | None, typer.Option(help="OpenColorIO configuration.", rich_help_panel=FILES)
    ] = None,
    color_space: Annotated[
        str | None, typer.Option(help="IN's space in that configuration.", rich_help_panel=FILES)
    ] = None,
    memory: options.Memory = None,
    as_json: options.Json = False,
) -> None:
    """Lay the glare of a camera over a linear HDR picture.

    The picture spans the sensor's width. Energy is kept: what glare spreads is taken from the lamps.

    Examples:

        aureole glare night.exr -o out.exr --focal-length 50mm --f-number 16 --blades 7

        aureole glare night.exr -o out.exr --preset super35-35mm-f8 --mode scatter --preview look.png

        aureole glare night.exr -o out.exr --mode add --threshold 2 --gain 3 --tint 1,0.9,0.8
    """
    start = time.perf_counter()
    shape = ShapeFlags(aperture, blades, curvature, rotation, obstruction, width, height, aperture_picture)
    camera = options.optics(shape, preset, iris, focal_length, f_number, sensor)
    tinted = options.numbers(tint, "tint", 3)
    pitch_m = options.pixel_pitch(pitch)
    limit = options.memory(memory)
    targets = output.places(out, psf, preview)
    given = picture.read(
        source,
        nan=nan,
        memory=limit,
        color_config=color_config,
        color_space=color_space,
    )
    output.say_notes(picture.notes(given))
    job = jobs.GlareJob(
        given,
        camera,
        illuminant,
        mode,
        matte=None if matte is None else views.matte(matte, given),
        threshold=threshold,
        knee=knee,
        gain=gain,
        tint=tinted,
        kernel_size=kernel_size,
        pixel_pitch=pitch_m,
        memory=limit,
    )
    result = output.follow(jobs.run(job))
    output.write(out, result.picture, output.pixel_type_for(out, pixel_type))
    if psf is not None:
        output.write(psf, result.psf, "float")
    if preview is not None:
        output.write_display(preview, views.before_and_after(given, result.picture))
    output.report("glare", result.report, targets, as_json, time.perf_counter() - start)


@app.command()
def starburst(
    out: options.Out,
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
    size: Annotated[str, typer.Option(help="Pixels: 512, or 640x480.", rich_help_panel="Kernel")] = "512",
    sample: Annotated[
        str, typer.Option(help="area: energy of each pixel; point: at its centre.", rich_help_panel="Kernel")
    ] = "area",
    fade: Annotated[
        float,
        typer.Option(
            help="Part of the half size that fades to zero at the border.", rich_help_panel="Kernel"
        ),
    ] = 0.25,
    host: Annotated[
        str | None,
        typer.Option("--for", help="unreal, blender or nuke: its convention.", rich_help_panel="Kernel"),
    ] = None,
    illuminant: options.Illuminant = "E",
    wavelength: Annotated[
        str | None, typer.Option(help="One wavelength, such as 550nm.", rich_help_panel="Light")
    ] = None,
    colour_space: options.ColourSpace = "rec709",
    method: Annotated[str, typer.Option(help="auto, exact or scaled.", rich_help_panel="Kernel")] = "auto",
    preview: options.Preview = None,
    as_json: options.Json = False,
) -> None:
    """Write the point spread function of a camera's aperture.

    Each pixel holds its share of the whole energy, so the sum tells how much the kernel holds.

    Examples:

        aureole starburst --f-number 16 --blades 7 --pixel-pitch 4um --size 1024 -o psf.exr

        aureole starburst --aperture circle --focal-length 50mm --f-number 16 --wavelength 550nm
        --pixel-pitch 1um --sample point -o airy.exr

        aureole starburst --preset full-frame-24mm-f22 --for unreal -o bloom.exr --preview bloom.png
    """
    start = time.perf_counter()
    shape = ShapeFlags(aperture, blades, curvature, rotation, obstruction, width, height, aperture_picture)
    camera = options.optics(shape, preset, iris, focal_length, f_number, sensor)
    job = jobs.StarburstJob(
        camera,
        options.size(size),
        options.pixel_pitch(pitch),
        illuminant if wavelength is None else f"line:{wavelength}",
        refuse.one_of("colour-space", colour_space, light.SPACES),
        sample,
        method,
        fade,
        host,
    )
    targets = output.places(out, preview)
    result = output.follow(jobs.run(job))
    output.write(out, result.picture, output.pixel_type_for(out, "auto"))
    if preview is not None:
        output.write_display(preview, views.kernel(result.picture))
    output.report("starburst", result.report, targets, as_json, time.perf_counter() - start)


@app.command()
def aperture(
    out: options.Out,
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
    as_json: options.Json = False,
) -> None:
    """Draw an aperture, and count what its transforms cost.

    Examples:

        aureole aperture --blades 9 --curvature 0.8 -o iris.png

        aureole aperture --aperture whirl --size 1024 -o whirl.exr --json
    """
    start = time.perf_counter()
    flags = ShapeFlags(shape, blades, curvature, rotation, obstruction, width, height, aperture_picture)
    targets = output.places(out)
    result = output.follow(jobs.run(jobs.ApertureJob(flags.opening(), iris, size, finest)))
    output.write(out, result.picture, output.pixel_type_for(out, "auto"))
    output.report("aperture", result.report, targets, as_json, time.perf_counter() - start)


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

    Example:

        aureole demo --folder demo
    """
    start = time.perf_counter()
    job = jobs.DemoJob(shape=options.size(size), seed=seed)
    output.make_folder(folder)
    files = [folder / name for name in ("scene.exr", "glare.exr", "psf.exr", "glare.png", "preview.png")]
    output.places(*files)
    result = output.follow(jobs.run(job))
    scene, after = result.scene, result.glare
    output.write(files[0], scene, "float")
    output.write(files[1], after.picture, "float")
    output.write(files[2], after.psf, "float")
    output.write_display(files[3], views.exposed(after.picture, scene))
    output.write_display(files[4], views.before_and_after(scene, after.picture))
    output.report("demo", after.report, files, as_json, time.perf_counter() - start)


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
