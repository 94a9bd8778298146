"""The commands about lights in pictures: find them, and follow them through a shot."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from aureole import glare, jobs, picture, refuse
from aureole.cli import options, output
from aureole.cli.lights_options import AUTO, ReadFlags
from aureole.cli.lights_options import threshold as chosen_threshold
from aureole.cli.options import FILES
from aureole.cli.pupil_options import with_flags
from aureole.cli.sequence_runs import INCOMPLETE
from aureole.jobs import frame_files as numbered
from aureole.records import Stage

app = typer.Typer(
    help="Find the lights that pictures show, and follow them through a shot.",
    no_args_is_help=True,
    rich_markup_mode="markdown",
)

LIGHTS, TRACKS = "Lights", "Tracks"
# What the columns of the report are called where a person reads them, who has eighty signs across.
HEADINGS = {
    "place_pixels": "place",
    "size_pixels": "size",
    "first_frame": "first",
    "last_frame": "last",
    "merged_frames": "merged",
    "largest_flux": "flux",
    "from_pixels": "from",
    "to_pixels": "to",
}

Out = Annotated[
    Path,
    typer.Option(
        "--output", "-o", help="File of lights, a line each, to write: .jsonl.", rich_help_panel=FILES
    ),
]
Threshold = Annotated[
    str,
    typer.Option(
        "--threshold",
        help="Luminance of a pixel that belongs to a light. auto: 16 times the median, but at least a "
        "thousandth of the brightest; one for all frames.",
        rich_help_panel=LIGHTS,
    ),
]
Most = Annotated[
    int, typer.Option("--most", help="Of each picture, so many with most light.", rich_help_panel=LIGHTS)
]
Connect = Annotated[
    int,
    typer.Option(
        "--connect", help="Regions fewer than so many pixels apart are one light.", rich_help_panel=LIGHTS
    ),
]

Shot = Annotated[Path, typer.Argument(metavar="IN", help="Pictures of a shot, #### for the frame's number.")]
Which = Annotated[str, typer.Option("--frames", help="Such as 1001-1240 or 1-100x2.", rich_help_panel=FILES)]
Reach = Annotated[
    float | None,
    typer.Option(
        "--reach",
        help="Pixels that a light may be from where it is looked for; else a fortieth of the width.",
        rich_help_panel=TRACKS,
    ),
]
Patience = Annotated[
    int,
    typer.Option(
        "--patience",
        help="So many frames a light may be hidden and keep its number.",
        rich_help_panel=TRACKS,
    ),
]
Least = Annotated[
    int, typer.Option("--least", help="Leave out lights seen in fewer frames.", rich_help_panel=TRACKS)
]
Looks = Annotated[
    Path | None,
    typer.Option(
        "--preview", help="Also write PNGs with the lights marked: look.####.png.", rich_help_panel=FILES
    ),
]


@app.command()
@with_flags("how", ReadFlags)
def find(
    source: options.Source,
    out: Out,
    how: ReadFlags,
    threshold: Threshold = AUTO,
    most: Most = glare.MOST_LAMPS,
    connect: Connect = 1,
    preview: options.Preview = None,
    as_json: options.Json = False,
) -> None:
    """Find the lights of a picture: where each stands, how strong, how large and of which colour it is.

    A light is a connected region of bright pixels with those that it covers in part. Its light is counted
    above the ground on which it lies.

    Examples:

        aureole lights find night.exr -o lights.jsonl --preview lights.png

        aureole lights find night.exr -o lights.jsonl --threshold 50 --most 20 --json
    """
    start = time.perf_counter()
    written = _places(out, preview)
    job = jobs.LightsJob(((None, source),), chosen_threshold(threshold), most, connect, reading=how.reading())
    result = output.follow(jobs.run(job))
    glare.write_lamps(out, result.lamps)
    if preview is not None:
        given = picture.read(source, **job.reading)
        seen = result.lamps.sightings
        output.write_display(preview, jobs.lights_drawing(given, seen, None, jobs.shown_corner(given)))
    _report("lights", result.report, "brightest", written, as_json, time.perf_counter() - start)


@app.command()
@with_flags("how", ReadFlags)
def track(
    source: Shot,
    out: Out,
    which: Which,
    how: ReadFlags,
    threshold: Threshold = AUTO,
    most: Most = glare.MOST_LAMPS,
    connect: Connect = 1,
    reach: Reach = None,
    patience: Patience = glare.PATIENCE,
    least: Least = 1,
    preview: Looks = None,
    as_json: options.Json = False,
) -> None:
    """Follow the lights of a shot: each keeps its number from frame to frame.

    A light is looked for where it would stand if it moved on as before. One that passes behind something
    keeps its number, and two whose images run together for a while part as the two that they were. Frames
    that are missing or broken are told at the end (exit code 1); the others are followed past them.

    Examples:

        aureole lights track shot.####.exr --frames 1001-1048 -o lights.jsonl

        aureole lights track shot.####.exr --frames 1001-1048 -o lights.jsonl --least 3
        --preview look.####.png
    """
    start = time.perf_counter()
    written = _places(out, None)
    wanted = numbered.numbers(which)
    looks = {} if preview is None else {number: numbered.frame(preview, number) for number in wanted}
    output.places(*looks.values())
    job = jobs.LightsJob(
        tuple((number, numbered.frame(source, number)) for number in wanted),
        chosen_threshold(threshold),
        most,
        connect,
        True,
        None if reach is None else refuse.positive("reach", reach),
        patience,
        least,
        how.reading(),
    )
    result = output.follow(jobs.run(job))
    glare.write_lamps(out, result.lamps)
    if looks:
        output.follow(_look_stages(job, result.lamps, looks))
    written += [] if preview is None else [preview]
    output.say_notes([f"frame {lost.number} is {lost.state}: {lost.reason}" for lost in result.failures])
    _report("lights", result.report, "tracks", written, as_json, time.perf_counter() - start)
    if result.failures:
        raise typer.Exit(INCOMPLETE)


def _places(out: Path, preview: Path | None) -> list[Path]:
    """Refuse, before any work, files that could not be written."""
    refuse.one_of("suffix of the output", out.suffix.lower(), (".jsonl",))
    return [picture.writable(out), *output.places(preview)]


def _look_stages(job: jobs.LightsJob, lamps: glare.LampList, looks: dict[int, Path]) -> Iterator[Stage]:
    """Write a marked picture of each frame that was looked at."""
    trails: dict[int, list[tuple[float, float]]] = {}
    files = dict(job.pictures)
    for k, number in enumerate(lamps.frames):
        yield Stage(k / len(lamps.frames), f"picture {number}")
        seen, given = lamps.at(number), picture.read(files[number], **job.reading)
        output.write_display(
            looks[number], jobs.lights_drawing(given, seen, trails, jobs.shown_corner(given))
        )
        for sighting in seen:
            trails.setdefault(sighting.id, []).append(sighting.lamp.place)
    yield Stage(1.0, "pictures", len(lamps.frames))


def _report(
    title: str, report: dict[str, Any], listed: str, files: list[Path], as_json: bool, seconds: float
) -> None:
    """Print what was found: for people, its list as a table of its own."""
    if as_json:
        output.report(title, report, files, True, seconds)
        return
    output.report(
        title, {key: value for key, value in report.items() if key != listed}, files, False, seconds
    )
    lines = report[listed]
    if not lines:
        return
    table = Table(box=None, pad_edge=False)
    for heading in lines[0]:
        table.add_column(HEADINGS.get(heading, heading), justify="right", no_wrap=True)
    for line in lines:
        table.add_row(*(_shown(value) for value in line.values()))
    Console().print(table)


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(_shown(part) for part in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)
