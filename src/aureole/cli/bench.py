"""The commands `aureole bench`: measure, and print tables with what others print beside it."""

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table as Drawn

from aureole import bench, picture, refuse
from aureole.cli import options, output
from aureole.records import Stage

app = typer.Typer(
    help="Measure Aureole on this machine beside what papers print and other libraries take.\n\n"
    "Everything is timed in turn, in one run, and medians are quoted, so that ratios hold on a busy machine. "
    "Nothing is random.\n\n"
    "Examples:\n\n"
    "    aureole bench quad-paper --only table-1,figure-10\n\n"
    "    aureole bench near-field --size 1024\n\n"
    "    aureole bench peers -o peers.json\n",
    no_args_is_help=True,
    rich_markup_mode="markdown",
)
WIDEST = 100

Runs = Annotated[int, typer.Option(help="How often each is timed.")]
Only = Annotated[str | None, typer.Option(help="What to keep, parted by commas.")]
Results = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Also write the result as JSON.", rich_help_panel=options.FILES),
]


@app.command(name="quad-paper")
def quad_paper(
    size: Annotated[int, typer.Option(help="Largest size, a power of two; figures stop at 1024.")] = 4096,
    runs: Runs = 5,
    frames: Annotated[int, typer.Option(help="Frames of the moving shadow.")] = 41,
    only: Only = None,
    out: Results = None,
    as_json: options.Json = False,
) -> None:
    """Tables 1-3 and Figures 8-11 of the quad paper, beside what it prints.

    L. Scandolo, S. Lee, E. Eisemann, "Quad-based Fourier transform for efficient diffraction synthesis",
    2018; its times are a GeForce GTX 1080 Ti's. Names for --only: table-1, table-2, table-3, figure-8,
    figure-9, figure-10, figure-11.

    Examples:

        aureole bench quad-paper

        aureole bench quad-paper --only table-1 --size 1024 --json
    """
    _run(bench.run_quad_paper(bench.QuadPaperBench(size, runs, frames, _names(only))), out, as_json)


@app.command()
def peers(
    size: Annotated[int, typer.Option(help="Pixels on each side, even.")] = 1024,
    runs: Runs = 5,
    only: Only = None,
    out: Results = None,
    as_json: options.Json = False,
) -> None:
    """SciPy, prysm, HCIPy, diffractsim and dLux on the same far-field work, where they are installed.

    They come with `pip install 'aureole[bench]'`. The whole takes some minutes: a loop over 60
    wavelengths takes 10 to 40 seconds and runs once. Names for --only: zoom, starburst, scipy, prysm,
    hcipy, diffractsim, dlux.

    Examples:

        aureole bench peers

        aureole bench peers --only zoom,prysm --runs 9 -o peers.json
    """
    _run(bench.run_peers(bench.PeersBench(size, runs, _names(only))), out, as_json)


@app.command(name="near-field")
def near_field(
    size: Annotated[
        int, typer.Option(help="Largest size, a power of two; only table-4 goes beyond 1024.")
    ] = 4096,
    runs: Runs = 5,
    only: Only = None,
    out: Results = None,
    as_json: options.Json = False,
) -> None:
    """Near fields: Table 4 and Figure 6 of the quad paper, and SciPy, diffractsim and LightPipes.

    The paper's times are a GeForce GTX 1080 Ti's; its discrete rivals are measured here as well. The
    libraries come with `pip install 'aureole[bench]'`. Names for --only: table-4, figure-6, peers, growth,
    colour, scipy, diffractsim, lightpipes; a library alone means peers.

    Examples:

        aureole bench near-field --size 1024

        aureole bench near-field --only peers,lightpipes --runs 9 -o near.json
    """
    _run(bench.run_near_field(bench.NearFieldBench(size, runs, _names(only))), out, as_json)


@app.command(name="tile-paper")
def tile_paper(
    base: Annotated[int, typer.Option(help="Rays along each side of the largest grids.")] = 256,
    runs: Runs = 3,
    grids: Annotated[
        str, typer.Option(help="What they lie over: bounds (each ghost's own part of the pupil) or front.")
    ] = "bounds",
    quick: Annotated[
        bool, typer.Option("--quick", help="A small picture, coarse grids, two lenses.")
    ] = False,
    only: Only = None,
    out: Results = None,
    as_json: options.Json = False,
) -> None:
    """Tables 2-8 of the tile paper, beside what it prints, and whole pictures of ghosts.

    A. Bodonyi, R. Kunkli, "Efficient tile-based rendering of lens flare ghosts", 2023; its times are a
    GeForce RTX 3060's. All lenses take about half an hour. Names for --only: table-2 ... table-8, whole,
    and the lenses heliar, itoh, nikon, canon-135, canon-200.

    Examples:

        aureole bench tile-paper --quick

        aureole bench tile-paper --only table-2,table-3,heliar -o heliar.json
    """
    _run(bench.run_tile_paper(bench.TilePaperBench(base, runs, grids, quick, _names(only))), out, as_json)


@app.command(name="flare-peers")
def flare_peers(
    side: Annotated[int, typer.Option(help="Rays along each side of the grid.")] = 256,
    runs: Runs = 5,
    out: Results = None,
    as_json: options.Json = False,
) -> None:
    """Rays through lenses by the ways of ghosts: optiland on the same rays, where it is installed.

    It comes with `pip install 'aureole[bench]'`. Says how many rays a second, and how far apart they land.

    Examples:

        aureole bench flare-peers

        aureole bench flare-peers --side 128 --json
    """
    _run(bench.run_flare_peers(bench.FlarePeersBench(side, runs)), out, as_json)


@app.command()
def eye(
    runs: Runs = 9,
    quick: Annotated[bool, typer.Option("--quick", help="A small picture, a coarse pupil, one run.")] = False,
    only: Only = None,
    out: Results = None,
    as_json: options.Json = False,
) -> None:
    """Figures 4.1 and 4.2 and the memory of the eye thesis, and the eye's veil beside CIE 135.

    J. Delavennat, "Physically-based Real-time Glare", 2021; its times are a GeForce GTX 1050 Ti's. All takes
    some minutes, most of them for flipbooks. Names for --only: figure-4-1, figure-4-2, memory, fresh, sum,
    veil.

    Examples:

        aureole bench eye --quick

        aureole bench eye --only veil,sum -o eye.json
    """
    _run(bench.run_eye(bench.EyeBench(runs, quick, _names(only))), out, as_json)


@app.command()
def surface(
    runs: Runs = 5,
    quick: Annotated[
        bool, typer.Option("--quick", help="Small tables, photographs and pictures, one run.")
    ] = False,
    only: Only = None,
    out: Results = None,
    as_json: options.Json = False,
) -> None:
    """Tables of diffractive surfaces, frames, light from all around and orders, beside the surface paper.

    A. Toisoul, A. Ghosh, "Practical acquisition and rendering of diffraction effects in surface reflectance",
    2017. All takes some minutes. Mitsuba is timed where it is installed (`pip install 'aureole[mitsuba]'`).
    Names for --only: table, frame, environment, measurement, orders, mitsuba.

    Examples:

        aureole bench surface --quick

        aureole bench surface --only table,frame -o surface.json
    """
    _run(bench.run_surface(bench.SurfaceBench(runs, quick, _names(only))), out, as_json)


@app.command(name="area-light")
def area_light(
    size: Annotated[int, typer.Option(help="Pixels on each side, even.")] = 1024,
    across: Annotated[int, typer.Option(help="Samples along each side of the light.")] = 9,
    runs: Runs = 5,
    only: Only = None,
    out: Results = None,
    as_json: options.Json = False,
) -> None:
    """Lights with a size behind occluders: few transforms for all samples beside an FFT for each.

    The scene of the quad paper's section 6.1, 81 samples at 1024²; it does not describe its occluder, so
    there are four. Says how far each sum is from that of all transforms. Names for --only: box, circle,
    heptagon, whirl; disc, leaf, railing, slanted bars.

    Examples:

        aureole bench area-light

        aureole bench area-light --only whirl,leaf --runs 9 -o area.json
    """
    _run(bench.run_area_light(bench.AreaLightBench(size, across, runs, _names(only))), out, as_json)


@app.command()
def bloom(
    source: Annotated[
        Path | None, typer.Argument(help="A linear picture; the bundled night scene otherwise.")
    ] = None,
    width: Annotated[int, typer.Option(help="Columns that the picture is scaled to.")] = 1920,
    height: Annotated[int, typer.Option(help="Rows.")] = 1080,
    runs: Runs = 9,
    out: Results = None,
    as_json: options.Json = False,
) -> None:
    """Bloom beside the full convolution of a picture: time, and how far apart what they add is.

    The camera is the default one, the full convolution that of --mode scatter, whose glare bloom stands for.
    A picture is scaled by straight lines.

    Examples:

        aureole bench bloom

        aureole bench bloom photograph.exr --runs 15 -o bloom.json
    """
    _run(bench.run_bloom(bench.BloomBench(source, (height, width), runs)), out, as_json)


def _names(only: str | None) -> tuple[str, ...]:
    return () if only is None else tuple(name.strip().lower() for name in only.split(","))


def _run(stages: Iterator[Stage], out: Path | None, as_json: bool) -> None:
    """Follow a bench, write its result and print it."""
    start = time.perf_counter()
    if out is not None:
        if out.suffix.lower() != ".json":
            raise refuse.Refusal(f"'output' must end in .json, got '{out}'.")
        picture.writable(out)
    report = output.follow(stages)
    values = bench.plain(report)
    if out is not None:
        with picture.whole_file(out) as place:
            place.write_text(json.dumps(values, indent=1, ensure_ascii=False), encoding="utf-8")
    if as_json:
        output.as_json(values)
        return
    _print(report, time.perf_counter() - start)
    if out is not None:
        print(f"wrote {out}")


def _print(report: bench.Report, seconds: float) -> None:
    # Where stdout is no terminal, tables are as wide as they are on one.
    console = Console()
    if not console.is_terminal:
        console = Console(width=WIDEST)
    console.print(_environment(report), style="dim", highlight=False)
    for table in report.tables:
        drawn = Drawn(box=None, padding=(0, 2, 0, 0))
        for column in table.columns:
            drawn.add_column(column.head, justify="left" if column.words else "right", no_wrap=True)
        for row in table.rows:
            drawn.add_row(*(column.cell(row) for column in table.columns))
        console.print(f"\n{table.title}", style="bold", highlight=False)
        console.print(drawn)
        for note in table.notes:
            console.print(note, style="dim", highlight=False, markup=False)
    console.print(f"\n{seconds:.0f} s", highlight=False)


def _environment(report: bench.Report) -> str:
    where, settings = report.environment, report.settings
    versions = ", ".join(f"{name} {number}" for name, number in where["versions"].items())
    asked = ", ".join(
        f"{name} {' '.join(value) if isinstance(value, list) else value}"
        for name, value in settings.items()
        if value not in (None, [])
    )
    return (
        f"{where['platform']}, {where['processor']}, {where['processors']} processors, Python "
        f"{where['python']}\n{versions}\n{asked}; nothing is random"
    )
