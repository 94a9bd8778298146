"""The commands about lenses: list, check, show, ghosts, import."""

import math
import time
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from aureole import flare, jobs, picture, refuse, units
from aureole.cli import options, output

app = typer.Typer(
    help="List, check, draw and import lenses.",
    no_args_is_help=True,
    rich_markup_mode="markdown",
)

Name = Annotated[str, typer.Argument(metavar="LENS", help="A shipped lens's name, or its file.")]
State = Annotated[str | None, typer.Option("--state", help="Position of a zoom, by the file's name for it.")]


@app.command(name="list")
def list_lenses(as_json: options.Json = False) -> None:
    """List the lenses that come with Aureole.

    Example:

        aureole lens list
    """
    found = jobs.lens_list()
    if as_json:
        output.as_json({"lenses": found})
        return
    table = Table(title="lenses", title_justify="left", title_style="bold", box=None, pad_edge=False)
    for heading in ("name", "length", "f/", "surfaces", "ghosts", "status"):
        left = heading in ("name", "status")
        table.add_column(heading, justify="left" if left else "right", no_wrap=True)
    for line in found:
        length = units.metres_as_text(line["focal_length_m"])
        numbers = (f"{line['f_number']:.3g}", str(line["surfaces"]), str(line["ghosts"]["same-side"]))
        table.add_row(line["lens"], length, *numbers, line["status"])
    Console().print(table)


@app.command()
def check(lens: Name, state: State = None, as_json: options.Json = False) -> None:
    """Measure a lens near its axis, count its ghosts, and say what looks wrong in its file.

    Ghosts are counted with both reflections on one side of the stop ("same-side"), by the tables of the
    tile paper ("paper", which leave out the last surface), and in all pairs ("all").

    Examples:

        aureole lens check heliar_tronnier_100mm

        aureole lens check mine.toml --json
    """
    start = time.perf_counter()
    found, notes = flare.open_lens(lens, state)
    output.say_notes(notes)
    report = jobs.lens_report(found)
    if as_json:
        output.report("lens", report, [], True, time.perf_counter() - start)
        return
    output.report("lens", _for_people(report), [], False, time.perf_counter() - start)


@app.command()
def show(
    lens: Name,
    out: options.Out,
    ghost: Annotated[
        list[str] | None, typer.Option("--ghost", help="Reflecting surfaces, such as 2,5; may be repeated.")
    ] = None,
    angle: Annotated[
        str | None, typer.Option("--angle", help="Of the light off the axis; half the field without it.")
    ] = None,
    state: State = None,
    as_json: options.Json = False,
) -> None:
    """Draw a lens from the side, with rays of the image and of chosen ghosts: PNG, JPEG, PDF or SVG.

    Examples:

        aureole lens show heliar_tronnier_100mm -o heliar.png

        aureole lens show nikon_tele_zoom_140mm_seed --ghost 2,5 --ghost 10,14 --angle 3deg -o ghosts.svg
    """
    start = time.perf_counter()
    jobs.check_drawing(out)
    found, notes = flare.open_lens(lens, state)
    output.say_notes(notes)
    paths = [flare.path_of(found, _pair(text)) for text in ghost or []]
    off_axis = None if angle is None else units.angle(angle, "angle")
    if off_axis is not None:
        refuse.between("angle", math.degrees(off_axis), -80, 80)
    output.say_notes(jobs.write_drawing(out, found, paths, off_axis))
    report = {"lens": found.name, "title": found.title, "ghosts": [path.name for path in paths]}
    output.report("lens", report, [out], as_json, time.perf_counter() - start)


@app.command()
def ghosts(
    lens: Name,
    light: Annotated[
        str | None,
        typer.Option(
            "--light",
            help="Angles to the right and downward: 8deg,3deg; half way to the lower edge without it.",
        ),
    ] = None,
    which: Annotated[
        str, typer.Option("--ghosts", help="top:20 or 90% of all pairs; all, same-side or paper.")
    ] = "top:20",
    f_number: Annotated[float | None, typer.Option("--f-number", help="Wide open without it.")] = None,
    illuminant: options.Illuminant = "E",
    four: Annotated[
        bool, typer.Option("--four-bounces", help="Ghosts of four reflections, such as 5-7-9-1, instead.")
    ] = False,
    everywhere: Annotated[
        bool, typer.Option("--everywhere", help="Count light that misses the sensor, too.")
    ] = False,
    state: State = None,
    as_json: options.Json = False,
) -> None:
    """Rank a lens's ghosts by the light that they carry, as a part of that in the light's own image.

    A ghost's name is its two reflecting surfaces. Energies are as the eye weighs wavelengths, of what falls
    on the sensor.

    Examples:

        aureole lens ghosts zeiss_biotar_50mm --light 8deg,3deg

        aureole lens ghosts canon_tele_zoom_135mm --f-number 8 --ghosts 90% --json
    """
    start = time.perf_counter()
    found, notes = flare.open_lens(lens, state)
    output.say_notes(notes)
    within = "plane" if everywhere else "frame"
    report = jobs.lens_ghosts(found, _angles(light), which, f_number, illuminant, within, 4 if four else 2)
    if as_json:
        output.report("ghosts", report, [], True, time.perf_counter() - start)
        return
    count, ratio = report["out_of"]["count"], report["ghost_to_image"]
    print(f"{found.name}: {count} ghosts together carry {ratio:.2e} of the image")
    table = Table(box=None, pad_edge=False)
    for heading in ("ghost", "of the image", "of the ghosts", "so far"):
        table.add_column(heading, justify="left" if heading == "ghost" else "right", no_wrap=True)
    for line in report["ghosts"]:
        shares = (f"{100 * line[key]:.2f} %" for key in ("share", "cumulative"))
        table.add_row(line["ghost"], f"{line['energy']:.2e}", *shares)
    Console().print(table)


@app.command(name="import")
def import_lens(
    source: Annotated[Path, typer.Argument(metavar="FILE", help=".zmx, .seq, .xml, .json, .lens or .dat.")],
    out: options.Out,
    as_json: options.Json = False,
) -> None:
    """Turn another program's lens file into TOML, saying what was converted and what looks wrong in it.

    Reads Zemax (.zmx), CODE V (.seq), OpenLensFlare (.xml), realflare (.json), FlareSim (.lens) and
    pbrt (.dat).

    Example:

        aureole lens import lens.zmx -o lens.toml
    """
    start = time.perf_counter()
    refuse.one_of("suffix of the output", out.suffix.lower(), (".toml",))
    picture.writable(out)
    found, notes = flare.import_lens(source)
    output.say_notes(notes)
    flare.write(out, found)
    report = jobs.lens_report(found) | {"lens": str(out), "notes": notes}
    if not as_json:
        report = _for_people(report)
        del report["notes"]
    output.report("lens", report, [out], as_json, time.perf_counter() - start)


def _pair(text: str) -> tuple[int, ...]:
    """Read "2,5"."""
    words = text.replace("-", ",").split(",")
    if not all(word.strip().isdecimal() for word in words):
        raise refuse.Refusal(f"'ghost' must be two numbers of surfaces such as 2,5, got '{text}'.")
    return tuple(int(word) for word in words)


def _angles(text: str | None) -> tuple[float, float] | None:
    """Read "8deg,3deg"."""
    if text is None:
        return None
    words = text.split(",")
    if len(words) != 2:
        raise refuse.Refusal(f"'light' must be two angles such as 8deg,3deg, got '{text}'.")
    x, y = (units.angle(word.strip(), "light") for word in words)
    return x, y


def _for_people(report: dict[str, Any]) -> dict[str, Any]:
    """Return a report with each ghost count and finding on a line of its own."""
    flat = {key: value for key, value in report.items() if key not in ("ghosts", "findings", "states")}
    flat |= {"states": ", ".join(report["states"])}
    flat = {key: value for key, value in flat.items() if value != ""}
    flat |= {f"ghosts, {which}": count for which, count in report["ghosts"].items()}
    texts = [found["text"] for found in report["findings"]]
    return flat | ({f"finding {k}": text for k, text in enumerate(texts, 1)} or {"findings": "none"})
