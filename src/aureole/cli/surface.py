"""The commands about diffractive surfaces: list, measure, table, render, export."""

import math
import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from aureole import jobs, light, presets, refuse, surface, units
from aureole.cli import options, output, surface_export, surface_measure, surface_runs
from aureole.cli.moving import MovingFlags
from aureole.cli.options import FILES
from aureole.cli.pupil_options import with_flags
from aureole.cli.surface_options import (
    ColourSpace,
    Illuminant,
    Name,
    Preview,
    PreviewRange,
    SourceFlags,
    TableFlags,
    TableOut,
)
from aureole.cli.surface_render_options import (
    CameraFlags,
    Exposure,
    LightFlags,
    MaterialFlags,
    ObjectFlags,
    Size,
    TableSize,
    Turntable,
    turning,
)

app = typer.Typer(
    help="Diffractive surfaces: measure them, make their tables, render them, hand them on.\n\n"
    "Start with `aureole surface render cd -o cd.png`.",
    no_args_is_help=True,
    rich_markup_mode="markdown",
)

app.command()(surface_measure.measure)

Orders = Annotated[
    bool,
    typer.Option(
        "--orders",
        help="Print where the grating's orders go at --incidence and --wavelength; no table is written then.",
        rich_help_panel="Orders",
    ),
]
Incidence = Annotated[
    str,
    typer.Option("--incidence", help="Of the light, from the normal: 30deg.", rich_help_panel="Orders"),
]
Wavelength = Annotated[
    str,
    typer.Option("--wavelength", help="Such as 532nm.", rich_help_panel="Orders"),
]


@app.command(name="list")
def list_gratings(as_json: options.Json = False) -> None:
    """List the gratings that come with Aureole.

    Example:

        aureole surface list
    """
    found = jobs.grating_titles()
    if as_json:
        output.as_json({"gratings": {name: presets.load("gratings", name).model_dump() for name in found}})
        return
    output.table("gratings", found)


@app.command()
@with_flags("form", TableFlags)
@with_flags("source", SourceFlags)
def table(
    source: SourceFlags,
    form: TableFlags,
    out: TableOut = None,
    illuminant: Illuminant = "D65",
    colour_space: ColourSpace = "xyz",
    preview: Preview = None,
    preview_range: PreviewRange = None,
    orders: Orders = False,
    incidence: Incidence = "0deg",
    wavelength: Wavelength = "532nm",
    as_json: options.Json = False,
) -> None:
    """Make the table of a surface that is known: a grating, slits, facets, a screen, heights.

    A table holds what a surface does to light over h, the sum of the unit vectors to the light and to the
    eye: along the tangent in its columns, along the bitangent in its rows. It is for one spectrum of light.
    All programs that render with it look it up by h; what the numbers mean stands in NAME.json beside it.

    Examples:

        aureole surface table --grating cd -o cd.exr --preview cd.png

        aureole surface table --grating cd --orders --incidence 30deg --wavelength 532nm

        aureole surface table --slits 0.5um,2um,21 --illuminant A -o slits.npz --json

        aureole surface table --slits 20um,74um,5 --across 20um,74um,5 --range 0.2 -o net.exr

        aureole surface table --height scratches.exr --pixel 50nm --height-unit 1nm -o scratches.exr

        aureole surface table --bokeh spot.png --period 24.8um --depth 100nm --lens 85cm,250mm,5.6
        -o screen.exr

        aureole surface table --height scratches.exr --pixel 50nm --method taylor --order 5 -o taylor.exr
    """
    made, facts, notes = source.source()
    if orders:
        if out is not None:
            raise refuse.Refusal("'orders' prints and writes no table; leave 'output' out.")
        _print_orders(made, incidence, wavelength, as_json)
        return
    if out is None:
        raise refuse.Refusal("'output' is missing: -o cd.exr writes a table; --orders needs none.")
    refuse.one_of("colour-space", colour_space, light.SPACES)
    job = jobs.SurfaceTableJob(made, illuminant, **form.form(), **source.how(), facts=facts, notes=notes)
    surface_runs.table(job, surface_runs.TableFiles(out, preview, preview_range, colour_space), as_json)


@app.command()
@with_flags("moving", MovingFlags)
@with_flags("material", MaterialFlags)
@with_flags("camera", CameraFlags)
@with_flags("lights", LightFlags)
@with_flags("body", ObjectFlags)
def render(
    name: Name,
    out: options.Out,
    body: ObjectFlags,
    lights: LightFlags,
    camera: CameraFlags,
    material: MaterialFlags,
    moving: MovingFlags,
    turntable: Turntable = None,
    size: Size = "1280x720",
    illuminant: Illuminant = "D65",
    table_size: TableSize = None,
    colour_space: options.ColourSpace = "rec709",
    exposure: Exposure = None,
    preview: Annotated[
        Path | None,
        typer.Option("--preview", help="Also write a PNG to look at.", rich_help_panel=FILES),
    ] = None,
    as_json: options.Json = False,
) -> None:
    """Draw a diffractive surface on a disc, a plane, a cylinder or a mesh.

    EXR gets linear light with the object's coverage as alpha; PNG and JPEG are exposed for a screen. The
    object lies about the origin and faces the camera; x is right, y up, z towards the camera.

    Examples:

        aureole surface render cd -o cd.png

        aureole surface render cd -o spokes.png --tilt=-35deg --lamp 0cm,20cm,30cm --lamp=-25cm,5cm,30cm

        aureole surface render lcd-342ppi -o phone.exr --lamp 3deg,8deg --preview phone.png

        aureole surface render cd -o room.png --environment room --fresnel aluminium --tilt=-20deg

        aureole surface render blazed-600 -o foil.png --shape cylinder --lamp 10cm,0cm,40cm

        aureole surface render cd.exr -o turning.####.exr --animate 2s --turntable tilt:60deg
        --contact-sheet turning.png
    """
    shape = options.size(size)
    thing = body.body(name)
    view = camera.view(shape, thing)
    lamps, around, mask = lights.lamps(view), lights.around(), body.masked()
    moves = moving.wanted(out)
    if turntable is not None and not moves:
        raise refuse.Refusal("'turntable' needs 'animate', such as --animate 4s.")
    turns = turning(turntable)
    material.material(None)
    if table_size is not None:
        refuse.at_least("table-size", table_size, 2)
    output.places(*([] if moves else [out, preview]))
    made = surface_runs.made_table(name, illuminant, table_size)
    job = jobs.SurfaceRenderJob(
        made,
        thing,
        lamps,
        view,
        material.material(made),
        around,
        mask=mask,
        colour_space=refuse.one_of("colour-space", colour_space, light.SPACES),
        environment_samples=lights.environment_samples,
        **body.angles(),
        **camera.lens(around is not None),
    )
    files = surface_runs.PictureFiles(out, preview, exposure)
    if moves:
        surface_runs.turntable(job, turns, moving, files, as_json)
    else:
        surface_runs.still(job, files, as_json)


app.command()(surface_export.export)


def _print_orders(
    made: surface.Grating | surface.HeightField, incidence: str, wavelength: str, as_json: bool
) -> None:
    """Print where orders go, for people or machines."""
    start = time.perf_counter()
    if isinstance(made, surface.HeightField):
        raise refuse.Refusal("'orders' are a grating's; a height field has a table.")
    angle = units.angle(incidence, "incidence")
    refuse.between("incidence", math.degrees(angle), -90.0, 90.0)
    line = refuse.positive("wavelength", units.length(wavelength, "wavelength", "532nm"))
    rows = jobs.order_rows(made, angle, line)
    report = {
        "surface": made.name,
        "period_m": made.along.period,
        "incidence_deg": math.degrees(angle),
        "wavelength_m": line,
        "orders": rows,
    }
    if as_json:
        output.report("orders", report, [], True, time.perf_counter() - start)
        return
    period, light_of = units.metres_as_text(made.along.period), units.metres_as_text(line)
    print(f"{made.name}: lines {period} apart, light of {light_of} at {math.degrees(angle):g} degrees")
    drawn = Table(box=None, pad_edge=False)
    for heading in ("order", "degrees", "h = sin in + sin out", "share of the light"):
        drawn.add_column(heading, justify="right", no_wrap=True)
    for row in rows:
        drawn.add_row(
            str(row["order"]),
            f"{row['angle_deg']:.2f}",
            f"{row['h']:.5f}",
            f"{100 * row['efficiency']:.2f} %",
        )
    Console().print(drawn)
