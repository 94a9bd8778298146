"""The command `aureole flare`: the ghosts of a lens, and the starbursts, for given lights."""

import math
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from aureole import flare as lenses
from aureole import jobs, picture, refuse
from aureole.cli import flare_options, options, output, sequence_runs, views
from aureole.cli.flare_options import GhostFlags, LightFlags
from aureole.cli.glare_options import FileFlags
from aureole.cli.moving import MovingFlags, given
from aureole.cli.options import ShapeFlags
from aureole.cli.pupil_options import PupilFlags, with_flags
from aureole.cli.runs import GlareFiles
from aureole.cli.sequence_runs import SequenceFlags
from aureole.jobs import frame_files

# Of the ghosts, how many a person is told.
TOLD = 5


@dataclass(frozen=True)
class FlareFiles:
    """The files of the command.

    Parameters
    ----------
    out : Path
        Picture out.
    over : Path, optional
        Picture in.
    layers : bool
        Whether the picture out has layers.
    preview : Path, optional
        PNG out.
    memory : int, optional
        Bytes that may be used.
    """

    out: Path
    over: Path | None
    layers: bool
    preview: Path | None
    memory: int | None


@with_flags("pupil", PupilFlags)
@with_flags("ghosts", GhostFlags)
@with_flags("lights", LightFlags)
@with_flags("moving", MovingFlags)
@with_flags("sequence", SequenceFlags)
def flare(
    lens: flare_options.Name,
    out: options.Out,
    lights: LightFlags,
    ghosts: GhostFlags,
    pupil: PupilFlags,
    moving: MovingFlags,
    sequence: SequenceFlags,
    state: flare_options.State = None,
    f_number: flare_options.FNumber = None,
    iris: options.Iris = None,
    aperture: flare_options.Shape = None,
    blades: options.Blades = None,
    curvature: options.Curvature = None,
    rotation: options.Rotation = None,
    obstruction: options.Obstruction = None,
    aperture_picture: options.ApertureFile = None,
    over: flare_options.Over = None,
    size: flare_options.Size = None,
    layers: flare_options.LayersFlag = False,
    colour_space: flare_options.ColourSpace = "rec709",
    preview: options.Preview = None,
    memory: options.Memory = None,
    as_json: options.Json = False,
) -> None:
    """Write the ghosts of a lens for lights in front of it, on black or over a picture.

    Every ghost is light that two surfaces of the lens throw back. A light's own image sums to its strength,
    and the ghosts to as much less as the lens makes them: the ghost-to-image ratio is printed, and --gain
    makes them brighter for the look. With --over the lights are as strong as the picture shows them. Where
    --over and OUT have #### they are sequences: frames that lie there whole are kept, one that is missing or
    broken does not stop the rest (exit code 1).

    Examples:

        aureole flare --lens heliar_tronnier_100mm --light 8deg,3deg --f-number 16 --blades 6 -o out.exr
        --preview look.png

        aureole flare --lens zeiss_biotar_50mm --light 1500px,200px --ghosts top:20 --starburst -o sun.exr

        aureole flare --lens heliar_tronnier_100mm --over night.exr --find-lights 50 --gain 100 -o out.exr

        aureole flare --lens canon_tele_zoom_135mm --light 5deg,-2deg --layers --starburst -o layers.exr

        aureole flare --lens heliar_tronnier_100mm --light 8deg,3deg --only 2-5 --size 960x540 -o one.exr

        aureole flare --lens heliar_tronnier_100mm --over shot.####.exr --lights lights.jsonl -o out.####.exr
    """
    start = time.perf_counter()
    files = FlareFiles(out, over, layers, preview, options.memory(memory))
    many = _many(files, sequence, moving, memory)
    written = [] if many is not None else _places(files)
    shape = ShapeFlags(
        aperture, blades, curvature, rotation, obstruction, None, None, aperture_picture, pupil
    )
    found, notes = lenses.open_lens(lens, state)
    output.say_notes(notes)
    job = jobs.FlareJob(
        found,
        over=None if many is not None else _read(files),
        shape=None if size is None else options.size(size),
        f_number=None if f_number is None else refuse.positive("f-number", f_number),
        opening=shape.opening(),
        iris=iris,
        layers=layers,
        colour_space=colour_space,
        memory=files.memory,
        **(lights if many is None else _unlisted(lights)).values(),
        **ghosts.values(),
    )
    if many is not None:
        sequence_runs.flare(job, many, lights.lights, as_json)
        return
    result = output.follow(jobs.run(job))
    output.say_notes(result.notes)
    _write(files, result)
    report = result.report if as_json else _for_people(result.report)
    output.report("flare", report, written, as_json, time.perf_counter() - start)


def _many(
    files: FlareFiles, sequence: SequenceFlags, moving: MovingFlags, memory: str | None
) -> sequence_runs.Sequence | None:
    """Return which frames to make, None for one picture; refuse flags that do not go with what it is."""
    if files.over is None or not frame_files.is_pattern(files.over):
        for name in (*given(sequence), *given(moving)):
            raise refuse.Refusal(
                f"'{name}' is for sequences; --over and OUT need #### for the frame's number."
            )
        return None
    if files.layers:
        raise refuse.Refusal("'layers' is for one picture; it does not go with a sequence.")
    how = FileFlags(memory=memory)
    told = GlareFiles(files.over, files.out, preview=files.preview, how=how)
    return sequence_runs.Sequence(told, sequence, moving)


def _unlisted(lights: LightFlags) -> LightFlags:
    """Return the same without the file of lights, from which each frame of a sequence takes its own."""
    if lights.lights_frame is not None:
        raise refuse.Refusal("'lights-frame' is for one picture; frames of a sequence know their number.")
    return replace(lights, lights=None)


def _places(files: FlareFiles) -> list[Path]:
    """Refuse, before any work, files that could not be written."""
    if files.layers and picture.format_of(files.out) != "openexr":
        raise refuse.Refusal(f"only EXR holds layers; '{files.out}' must end in .exr.")
    return output.places(files.out, files.preview)


def _read(files: FlareFiles) -> Any:
    if files.over is None:
        return None
    given = picture.read(files.over, memory=files.memory)
    output.say_notes(picture.notes(given))
    return given


def _write(files: FlareFiles, result: jobs.FlareResult) -> None:
    if result.layers is None:
        output.write(files.out, result.picture, output.pixel_type_for(files.out, "auto"))
    else:
        output.say_notes(picture.write_layers(files.out, result.picture, result.layers))
    if files.preview is not None:
        output.write_display(files.preview, views.flare(result.picture, result.over))


def _for_people(report: dict[str, Any]) -> dict[str, Any]:
    """Return a report with each light, and the strongest ghosts, on a line of its own."""
    flat = {key: value for key, value in report.items() if key not in ("lights", "energies")}
    for k, light in enumerate(report["lights"], 1):
        right, down = light["angles_deg"]
        x, y = light["place_pixels"]
        flat[f"light {k}"] = (
            f"{right:.4g} deg right, {down:.4g} deg down, at {x:.1f}, {y:.1f} pixels, "
            f"strength {light['strength']:.4g}"
        )
    whole = sum(report["energies"].values())
    for name, energy in list(report["energies"].items())[:TOLD]:
        share = 100 * energy / whole if math.isfinite(whole) and whole > 0 else 0.0
        flat[f"ghost {name}"] = f"{energy:.3g} of the image, {share:.3g} % of all ghosts"
    return flat
