"""The command `aureole surface export`: a surface for browsers, Mitsuba, shaders and glTF."""

import time
from pathlib import Path
from typing import Annotated, Any

import typer

from aureole import jobs, refuse
from aureole.cli import options, output, surface_runs
from aureole.cli.moving import given
from aureole.cli.pupil_options import with_flags
from aureole.cli.surface_options import Illuminant, Name
from aureole.cli.surface_render_options import (
    CameraFlags,
    LightFlags,
    MaterialFlags,
    ObjectFlags,
    Size,
    TableSize,
)

TARGETS = "Target"
PAGE_TABLE = 512

To = Annotated[
    str | None,
    typer.Option(
        "--to",
        help="web: one page that shows the object in a browser; mitsuba: a scene of Mitsuba 3; glsl: a "
        "function "
        "for shaders; gltf: extras of a material. By the output's suffix unless given.",
        rich_help_panel=TARGETS,
    ),
]
Into = Annotated[
    Path | None,
    typer.Option(
        "--into",
        help="gltf: the file whose material gets the table; a new one unless given.",
        rich_help_panel=TARGETS,
    ),
]
MaterialName = Annotated[
    str | None,
    typer.Option(
        "--material", help="gltf: the material's name in it, where it has several.", rich_help_panel=TARGETS
    ),
]
Title = Annotated[
    str | None,
    typer.Option("--title", help="web: the page's title.", rich_help_panel=TARGETS),
]
PageSize = Annotated[
    int,
    typer.Option("--page-table", help="web: longest side of the page's table.", rich_help_panel=TARGETS),
]


@with_flags("matter", MaterialFlags)
@with_flags("camera", CameraFlags)
@with_flags("lights", LightFlags)
@with_flags("body", ObjectFlags)
def export(
    name: Name,
    out: options.Out,
    body: ObjectFlags,
    lights: LightFlags,
    camera: CameraFlags,
    matter: MaterialFlags,
    to: To = None,
    into: Into = None,
    material: MaterialName = None,
    title: Title = None,
    page_table: PageSize = PAGE_TABLE,
    size: Size = "1280x720",
    illuminant: Illuminant = "D65",
    table_size: TableSize = None,
    as_json: options.Json = False,
) -> None:
    """Write a surface for other software.

    A page (.html) holds all that it needs and opens in any browser with WebGL 2: drag the object and the
    lamp. A scene of Mitsuba (.xml) is rendered with `aureole.surface.mitsuba`. A GLSL function (.glsl) and
    the extras of a glTF material (.gltf) read the table that is written beside them.

    Examples:

        aureole surface export cd -o cd.html

        aureole surface export phone.exr --to web -o phone.html --shape plane --title "A phone's screen"

        aureole surface export cd --to mitsuba -o cd.xml --tilt=-30deg --lamp 0cm,20cm,30cm

        aureole surface export cd -o cd.glsl --table-size 512

        aureole surface export cd -o disc.gltf

        aureole surface export cd -o scene-with-cd.gltf --into scene.gltf --material Disc
    """
    start = time.perf_counter()
    target = jobs.export_target(out, to)
    _refuse_strays(target, {"scene": (body, lights, camera, matter)}, into, material, title, page_table)
    if lights.environment is not None:
        raise refuse.Refusal("'environment' is not exported; give lamps, or set it in the other software.")
    if camera.depth_of_field is not None or body.mask is not None:
        raise refuse.Refusal(
            "'depth-of-field' and 'mask' are not exported; `aureole surface render` has them."
        )
    shape = options.size(size)
    thing = body.body(name)
    view = camera.view(shape, thing)
    lamps = lights.lamps(view)
    matter.material(None)
    table_file = Path(name) if jobs.is_table(name) else None
    if material is not None and into is None:
        raise refuse.Refusal("'material' is the name of one in a glTF file; it needs 'into'.")
    made = surface_runs.made_table(name, illuminant, table_size)
    scene = jobs.SurfaceRenderJob(
        made, thing, lamps, view, matter.material(made), **body.angles(), **camera.lens()
    )
    words = title or f"{Path(name).stem}: a diffractive surface"
    asked = jobs.SurfaceExport(
        target, out, scene, table_file, words, into, material, refuse.at_least("page-table", page_table, 2)
    )
    written = jobs.export_places(asked)
    told = jobs.export(asked)
    report = {"surface": Path(name).stem, **told}
    output.report("export", report, written, as_json, time.perf_counter() - start)


def _refuse_strays(
    target: str,
    groups: dict[str, Any],
    into: Path | None,
    material: str | None,
    title: str | None,
    page_table: int,
) -> None:
    """Refuse flags that a target does not use."""
    only = {
        "into": ("gltf", into),
        "material": ("gltf", material),
        "title": ("web", title),
        "page-table": ("web", None if page_table == PAGE_TABLE else page_table),
    }
    for name, (owner, value) in only.items():
        if value is not None and owner != target:
            raise refuse.Refusal(f"'{name}' is for --to {owner}, not for {target}.")
    if target not in ("web", "mitsuba"):
        for flags in groups["scene"]:
            for name in given(flags):
                raise refuse.Refusal(f"'{name}' is of a scene; --to {target} writes none.")
