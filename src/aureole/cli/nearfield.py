"""The command `aureole nearfield`: the light behind an opening, at one distance or at many."""

from pathlib import Path
from typing import Annotated

import typer

from aureole import jobs
from aureole.cli import near_options, near_runs, options
from aureole.cli.near_options import PlaneFlags, SweepFlags, TextureFlags
from aureole.cli.options import FILES, ShapeFlags
from aureole.cli.pupil_options import PupilFlags, with_flags


@with_flags("pupil", PupilFlags)
@with_flags("ghosts", TextureFlags)
@with_flags("many", SweepFlags)
@with_flags("plane", PlaneFlags)
def nearfield(
    pupil: PupilFlags,
    plane: PlaneFlags,
    many: SweepFlags,
    ghosts: TextureFlags,
    out: near_options.Out = None,
    iris: options.Iris = None,
    aperture: near_options.Shape = None,
    blades: options.Blades = None,
    curvature: options.Curvature = None,
    rotation: options.Rotation = None,
    obstruction: options.Obstruction = None,
    width: near_options.Width = None,
    height: options.Height = None,
    aperture_picture: options.ApertureFile = None,
    exposure: near_options.Exposure = None,
    preview: Annotated[
        Path | None, typer.Option("--preview", help="Also write a PNG to look at.", rich_help_panel=FILES)
    ] = None,
    amplitude: near_options.Amplitude = None,
    as_json: options.Json = False,
) -> None:
    """Write the light behind an opening: its Fresnel pattern on a plane.

    A plane wave falls on the opening. Each pixel holds the irradiance at its centre; it is 1 where
    nothing is in the way. Near the opening its shadow has fringes along the edges (large Fresnel
    numbers); far away it becomes the far field (small ones). With --sweep the plane moves: a picture
    for each distance, a strip of them, or a section along the axis. With --texture it is a square
    picture to lay on the ghosts of a lens flare.

    Examples:

        aureole nearfield --aperture rectangle --width 2mm --height 1mm --distance 0.5m
        --wavelength 550nm --extent 4mm --size 512 -o out.exr

        aureole nearfield --blades 7 --width 2mm --fresnel-number 30 -o heptagon.png

        aureole nearfield --aperture half-plane --distance 1m --extent 8mm -o edge.exr --preview edge.png

        aureole nearfield --aperture circle --width 2mm --obstacle --fresnel-number 10 -o spot.png

        aureole nearfield --blades 7 --fresnel-number 50 --illuminant D65 --size 1024 -o colour.exr

        aureole nearfield --blades 7 --sweep 0.05m:2m:48 -o ring.####.exr --strip ring.png

        aureole nearfield --aperture circle --sweep 0.2m:4m --size 1024x512 --section axis.png

        aureole nearfield --texture --blades 7 --housing 0.5,0,1.1 --fresnel-number 30 --illuminant D65
        --size 512 -o ghost.exr --preview ghost.png
    """
    shape = ShapeFlags(
        aperture, blades, curvature, rotation, obstruction, width, height, aperture_picture, pupil
    )
    job = jobs.NearFieldJob(shape.opening(), iris, **plane.values(), amplitude=amplitude is not None)
    files = near_runs.NearFiles(
        out, preview, amplitude, many.strip, many.section, near_options.exposure(exposure)
    )
    if ghosts.wanted(many):
        near_runs.texture(ghosts.job(job), files, as_json)
    elif many.wanted():
        near_runs.sweep(job, many, files, as_json)
    else:
        near_runs.plane(job, files, as_json)
