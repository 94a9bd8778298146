"""Running the eye's jobs: one picture or many frames, each written whole, finished ones kept."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aureole import jobs, picture, refuse
from aureole.cli import output, views
from aureole.cli.eye_options import AnimationFlags, OverFlags
from aureole.cli.glare_options import Look
from aureole.cli.moving import SHOWN, FrameFiles, given
from aureole.cli.runs import GlareFiles, read, write_picture
from aureole.records import Picture

PARTS_SIZE = 768
# Less light than this part of an open eye's is worth a word.
LITTLE = 0.5


def still(job: jobs.EyeJob, out: Path, preview: Path | None, parts: Path | None, as_json: bool) -> None:
    """Make a point spread function of an eye, write and report.

    Parameters
    ----------
    job : EyeJob
        What to make.
    out : Path
        Kernel out.
    preview, parts : Path, optional
        Pictures to look at.
    as_json : bool
        Whether a machine reads the report.
    """
    start = time.perf_counter()
    written = output.places(out, parts)
    if preview is not None:
        written.append(output.another(jobs.check_page(preview, "preview"), written))
    result = output.follow(jobs.run(job))
    _write(out, result.picture, None)
    if preview is not None:
        jobs.write_eye_preview(preview, result.picture, job.field_of_view, job.projection)
    if parts is not None:
        output.write_display(parts, picture.to_display(result.parts, exposure=0.0, tone="clip"))
    output.say_notes(notes(result.report))
    output.report("eye", for_reading(result.report, as_json), written, as_json, time.perf_counter() - start)


def animation(job: jobs.EyeJob, moving: AnimationFlags, out: Path, as_json: bool) -> None:
    """Make an animation of an eye's point spread function, write each frame when it is ready, and report.

    Parameters
    ----------
    job : EyeJob
        Of each frame.
    moving : AnimationFlags
        How long, and which frames.
    out : Path
        Name with #### for the frame's number.
    as_json : bool
        Whether a machine reads the report.
    """
    start = time.perf_counter()
    files = FrameFiles(out, moving, lambda path, frame: _write(path, frame.picture, frame.description))
    written = files.places()
    result = files.follow(jobs.run(jobs.EyeAnimationJob(job, files.frames())))
    if moving.contact_sheet is not None:
        output.write_display(moving.contact_sheet, jobs.eye_brightness(result.contact_sheet)[0])
    files.tell("eye", result.report, written, as_json, time.perf_counter() - start)


@dataclass(frozen=True)
class Over:
    """An eye's glare on a picture: all that the command `glare` was told about it.

    Parameters
    ----------
    eye : EyeJob
        The eye, the time and the field of view.
    files : GlareFiles
        What to read and write.
    look : Look
        How to mix.
    flags : OverFlags
        Of the eye's glare alone.
    kernel_size : int, optional
        Pixels.
    """

    eye: jobs.EyeJob
    files: GlareFiles
    look: Look
    flags: OverFlags
    kernel_size: int | None

    def job(self, source: Picture) -> jobs.EyeGlareJob:
        """Return the job for a picture."""
        look = {name: value for name, value in vars(self.look).items() if name != "illuminant"}
        return jobs.EyeGlareJob(
            source,
            self.eye,
            matte=self.files.sources(source),
            resolution="half" if self.flags.half else "full",
            patterns=1 if self.flags.patterns is None else self.flags.patterns,
            stamps=refuse.at_least("stamps", self.flags.stamps, 0),
            kernel_size=self.kernel_size,
            memory=self.files.how.most(),
            **look,
        )


def over(asked: Over, moving: AnimationFlags, as_json: bool) -> None:
    """Read a picture, let an eye see it, write and report.

    Parameters
    ----------
    asked : Over
        What to do.
    moving : AnimationFlags
        Whether through time.
    as_json : bool
        Whether a machine reads the report.
    """
    if moving.wanted(asked.files.out):
        _over_frames(asked, moving, as_json)
        return
    for name in ("photosafe", "white", "real-time"):
        if name in given(asked.flags):
            raise refuse.Refusal(f"'{name}' is for frames; it needs --animate.")
    start, files = time.perf_counter(), asked.files
    written = output.places(files.out, files.psf, files.preview)
    source = read(files)
    result = output.follow(jobs.run(asked.job(source)))
    write_picture(files, files.out, result.picture)
    if files.psf is not None:
        output.write(files.psf, result.psf, "float")
    if files.preview is not None:
        output.write_display(files.preview, views.before_and_after(source, result.picture))
    output.say_notes(notes(result.report))
    output.report("glare", for_reading(result.report, as_json), written, as_json, time.perf_counter() - start)


def _over_frames(asked: Over, moving: AnimationFlags, as_json: bool) -> None:
    """Let an eye see a picture through time."""
    for name in ("psf", "preview"):
        if getattr(asked.files, name) is not None:
            raise refuse.Refusal(f"'{name}' is for one picture; it does not go with 'animate'.")
    if asked.flags.white is not None and not asked.flags.photosafe:
        raise refuse.Refusal("'white' needs 'photosafe'.")
    start = time.perf_counter()

    def write(path: Path, frame: jobs.Frame) -> None:
        words = {"ImageDescription": picture.Attribute("string", frame.description)}
        write_picture(asked.files, path, picture.with_attributes(frame.picture, words))

    files = FrameFiles(asked.files.out, moving, write)
    written = files.places()
    source = read(asked.files)
    flags = asked.flags
    job = jobs.EyeGlareAnimationJob(
        asked.job(source), files.frames(), flags.photosafe, flags.white, flags.real_time
    )
    result = files.follow(jobs.run(job))
    if moving.contact_sheet is not None:
        output.write_display(moving.contact_sheet, views.exposed(result.contact_sheet, source))
    files.tell("glare", result.report, written, as_json, time.perf_counter() - start)


def notes(report: dict[str, Any]) -> list[str]:
    """Return what a person should know about an eye at a moment.

    Parameters
    ----------
    report : dict
        As an eye's job tells it.

    Returns
    -------
    list of str
        One line each.
    """
    let = report["light_let_through"]
    if let > LITTLE:
        return []
    return [f"the lids let {100 * let:.0f} % through at {report['time_s']:.4g} s; --no-blink keeps them open"]


def for_reading(report: dict[str, Any], as_json: bool) -> dict[str, Any]:
    """Return a report for its reader: machines get the pupil in millimetres, too.

    Parameters
    ----------
    report : dict
        Plain numbers.
    as_json : bool
        Whether a machine reads.

    Returns
    -------
    dict
        Plain numbers.
    """
    if not as_json:
        return report
    return report | {"pupil_diameter_mm": 1e3 * report["pupil_diameter_m"]}


def _write(path: Path, psf: Picture, words: str | None) -> None:
    """Write a kernel as it is, or over its decades where the format is for people."""
    attributes = {} if words is None else {"ImageDescription": picture.Attribute("string", words)}
    if picture.format_of(path) in SHOWN:
        output.write_display(path, jobs.eye_brightness(psf)[0], attributes)
        return
    told = picture.with_attributes(psf, attributes) if attributes else psf
    output.write(path, told, output.pixel_type_for(path, "auto"))
