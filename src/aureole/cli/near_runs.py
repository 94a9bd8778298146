"""Running near-field jobs: a plane, a sweep of planes, a ringing texture; files appear whole."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from aureole import jobs, picture, refuse
from aureole.cli import output, views
from aureole.cli.near_options import SweepFlags
from aureole.jobs import frame_files
from aureole.records import Field, Picture

SHOWN = ("png", "jpeg")
# Planes of a sweep share an exposure: white is 4, the most that a round opening's light reaches.
SWEEP_STOPS = -2.0
AMPLITUDE_SUFFIXES = (".npz", ".exr")


@dataclass(frozen=True)
class NearFiles:
    """The files of the command `nearfield`.

    Parameters
    ----------
    out : Path, optional
        Picture out; of a sweep a name with #### for its planes, or the strip.
    preview, amplitude : Path, optional
        PNG out, complex amplitude out, of one plane.
    strip, section : Path, optional
        Of a sweep.
    exposure : float, "auto" or None
        Stops for what is shown; None is "auto" but for a sweep's planes.
    """

    out: Path | None
    preview: Path | None = None
    amplitude: Path | None = None
    strip: Path | None = None
    section: Path | None = None
    exposure: float | str | None = None


def plane(job: jobs.NearFieldJob, files: NearFiles, as_json: bool) -> None:
    """Make one plane, write and report.

    Parameters
    ----------
    job : NearFieldJob
        What to make.
    files : NearFiles
        What to write.
    as_json : bool
        Whether a machine reads the report.
    """
    start = time.perf_counter()
    written = _one_picture(files)
    if files.amplitude is not None:
        written.append(output.another(_amplitude_place(files.amplitude), written))
    result = output.follow(jobs.run(job))
    _write_one(files, result)
    if files.amplitude is not None:
        _write_amplitude(files.amplitude, result)
    output.report("near field", result.report, written, as_json, time.perf_counter() - start)


def texture(job: jobs.NearTextureJob, files: NearFiles, as_json: bool) -> None:
    """Make a ringing texture, write and report.

    Parameters
    ----------
    job : NearTextureJob
        What to make.
    files : NearFiles
        What to write.
    as_json : bool
        Whether a machine reads the report.
    """
    start = time.perf_counter()
    written = _one_picture(files)
    result = output.follow(jobs.run(job))
    _write_one(files, result)
    output.report("ringing texture", result.report, written, as_json, time.perf_counter() - start)


def sweep(plane: jobs.NearFieldJob, many: SweepFlags, files: NearFiles, as_json: bool) -> None:
    """Make the planes, the strip and the section of a sweep, write each when it is ready, and report.

    Parameters
    ----------
    plane : NearFieldJob
        What each of them is.
    many : SweepFlags
        Where they are and which of them are wanted.
    files : NearFiles
        What to write.
    as_json : bool
        Whether a machine reads the report.
    """
    start = time.perf_counter()
    distances, count = many.distances()
    numbers = many.numbers()
    pattern, strip = _outputs(files, count)
    first = None if pattern is None else frame_files.frame(pattern, 1)
    written = output.places(first, strip, files.section)[first is not None :]
    if files.section is not None:
        refuse.at_least("rows of the section", plane.shape[0], 2)
    report: dict[str, Any] = {}
    if count is not None and (pattern is not None or strip is not None):

        def is_done(number: int, description: str) -> bool:
            if pattern is None:
                return False
            path = frame_files.frame(pattern, number)
            return frame_files.is_there(path, _words(path, description, files), many.overwrite, "plane")

        job = jobs.NearSweepJob(plane, distances, count, numbers, strip is not None, many.zoom, is_done)
        result = _planes(job, pattern, files)
        report |= result.report
        if strip is not None:
            assert result.strip is not None
            _write(strip, result.strip, result.description, report, _stops(files))
    if files.section is not None:
        section = output.follow(jobs.run(jobs.NearSectionJob(plane, distances)))
        _write(files.section, section.picture, section.description, section.report, _stops(files))
        report = section.report | report
    _tell(report, pattern, written, as_json, time.perf_counter() - start)


def _one_picture(files: NearFiles) -> list[Path]:
    """Return the files of one picture, and of its preview, before any work."""
    if files.out is None:
        raise refuse.Refusal("'output' is missing: name the file to write, such as -o near.exr.")
    return output.places(files.out, files.preview)


def _write_one(files: NearFiles, result: jobs.NearFieldResult | jobs.NearTextureResult) -> None:
    assert files.out is not None
    _write(files.out, result.picture, result.description, result.report, _stops(files))
    if files.preview is not None:
        shown, _, _ = views.irradiance(result.picture, _stops(files))
        output.write_display(files.preview, shown)


def _outputs(files: NearFiles, count: int | None) -> tuple[Path | None, Path | None]:
    """Return the pattern of the planes' files and the strip's file."""
    for name in ("preview", "amplitude"):
        if getattr(files, name) is not None:
            raise refuse.Refusal(f"'{name}' is for one plane; it does not go with 'sweep'.")
    pattern = files.out if files.out is not None and frame_files.is_pattern(files.out) else None
    strip = files.strip
    if files.out is not None and pattern is None:
        if strip is not None:
            raise refuse.Refusal(
                f"'{files.out}' has no #### for the planes' numbers, and the strip has its own file; "
                "name it as ring.####.exr."
            )
        strip = files.out
    if pattern is None and strip is None and files.section is None:
        raise refuse.Refusal(
            "'sweep' has nothing to write: give -o ring.####.exr, --strip FILE or --section FILE."
        )
    if count is None and (pattern is not None or strip is not None):
        raise refuse.Refusal("'sweep' must say how many planes, such as 0.05m:2m:48.")
    return pattern, strip


def _planes(job: jobs.NearSweepJob, pattern: Path | None, files: NearFiles) -> jobs.NearSweepResult:
    """Write each plane when it is ready; the result tells where each is."""
    result = None
    for stage in output.shown(jobs.run(job)):
        result = stage.result
        if isinstance(result, jobs.NearFrame) and pattern is not None and not result.done:
            path, plane = frame_files.frame(pattern, result.number), result.plane
            _write(
                path, plane.picture, _words(path, plane.description, files), plane.report, _frame_stops(files)
            )
    assert isinstance(result, jobs.NearSweepResult)
    if pattern is not None:
        for told in result.report["frames"]:
            told["file"] = str(frame_files.frame(pattern, told["number"]))
    return result


def _words(path: Path, description: str, files: NearFiles) -> str:
    """Return what a file says of itself; a picture for people depends on its exposure, too."""
    shown = picture.format_of(path) in SHOWN
    return f"{description}, exposure {_frame_stops(files)}" if shown else description


def _frame_stops(files: NearFiles) -> float | str:
    return SWEEP_STOPS if files.exposure is None else files.exposure


def _stops(files: NearFiles) -> float | str:
    return "auto" if files.exposure is None else files.exposure


def _write(path: Path, source: Picture, words: str, report: dict[str, Any], stops: float | str) -> None:
    """Write irradiance as it is, or shown where the format is for people; the report tells the exposure."""
    attributes = {"ImageDescription": picture.Attribute("string", words)}
    if picture.format_of(path) in SHOWN:
        shown, stops, over = views.irradiance(source, stops)
        output.write_display(path, shown, attributes)
        report["exposure_stops"] = stops
        if over > 0:
            share = f"{100 * over:.2g} % of its pixels are brighter than white"
            output.say_notes([f"'{path.name}': {share}; --exposure auto shows them"])
        return
    source = picture.with_attributes(source, attributes | _numbers(report))
    output.write(path, source, output.pixel_type_for(path, "auto"))


def _numbers(report: Mapping[str, Any]) -> dict[str, picture.Attribute]:
    """Return a report's plain numbers and words as a file's attributes."""
    types = {float: "float", str: "string"}
    return {
        f"aureole:{name}": picture.Attribute(types[type(value)], value)
        for name, value in report.items()
        if type(value) in types
    }


def _amplitude_place(path: Path) -> Path:
    refuse.one_of("suffix of the amplitude", path.suffix.lower(), AMPLITUDE_SUFFIXES)
    return picture.writable(path)


def _write_amplitude(path: Path, result: jobs.NearFieldResult) -> None:
    """Write the complex amplitude for NumPy, or as channels beside the irradiance."""
    field = result.amplitude
    assert isinstance(field, Field)
    if path.suffix.lower() == ".exr":
        extra = {
            "amplitude.real": np.ascontiguousarray(field.amplitude.real, dtype=np.float32),
            "amplitude.imaginary": np.ascontiguousarray(field.amplitude.imag, dtype=np.float32),
        }
        metadata = {**result.picture.metadata, "extra_channels": extra}
        source = Picture(result.picture.pixels, result.picture.colour_space, metadata)
        _write(path, source, result.description, result.report, 0.0)
        return
    y, x = field.grid.axes()
    report = result.report
    with picture.whole_file(path) as place, place.open("wb") as file:
        np.savez(
            file,
            amplitude=field.amplitude,
            x=x,
            y=y,
            distance=report["distance_m"],
            wavelength=report["wavelength_m"],
        )


def _tell(
    report: dict[str, Any], pattern: Path | None, written: list[Path], as_json: bool, seconds: float
) -> None:
    """Report every frame to a machine, and their pattern to people."""
    if as_json:
        made = [Path(one["file"]) for one in report.get("frames", []) if "file" in one and not one["kept"]]
        output.report("sweep", report, [*made, *written], as_json, seconds)
        return
    shared = {name: value for name, value in report.items() if name != "frames"}
    output.report("sweep", shared, written if pattern is None else [pattern, *written], as_json, seconds)
