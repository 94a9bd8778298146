"""Running the jobs of diffractive surfaces: tables and pictures, each written whole."""

import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from aureole import jobs, picture, refuse, surface
from aureole.cli import output
from aureole.cli.moving import SHOWN, FrameFiles, MovingFlags
from aureole.records import Picture


@dataclass(frozen=True)
class TableFiles:
    """The files of a table.

    Parameters
    ----------
    out : Path
        The table.
    preview : Path, optional
        Picture to look at.
    preview_range : float, optional
        h at its borders.
    colour_space : str
        Of the table's numbers.
    """

    out: Path
    preview: Path | None = None
    preview_range: float | None = None
    colour_space: str = "xyz"

    def places(self) -> list[Path]:
        """Refuse, before any work, files that could not be written; return them."""
        refuse.one_of(f"suffix of {self.out.name}", self.out.suffix.lower(), jobs.TABLE_SUFFIXES)
        written = [picture.writable(self.out), surface.sidecar_of(self.out)]
        picture.writable(written[1])
        if self.preview_range is not None:
            refuse.between("preview-range", refuse.positive("preview-range", self.preview_range), 0.0, 2.0)
        if self.preview is not None:
            written.append(output.another(jobs.check_page(self.preview, "preview"), written))
        return written

    def write(self, table: surface.ScatterTable, title: str) -> None:
        """Write the table, its sidecar and its preview."""
        surface.write_table(self.out, table, self.colour_space)
        if self.preview is not None:
            jobs.write_table_preview(self.preview, table, title, self.preview_range)


def table(job: Any, files: TableFiles, as_json: bool, title: str = "table") -> None:
    """Make a table, write and report.

    Parameters
    ----------
    job : SurfaceTableJob or SurfaceMeasureJob
        What to make.
    files : TableFiles
        What to write.
    as_json : bool
        Whether a machine reads the report.
    title : str
        Of the report.
    """
    start = time.perf_counter()
    written = files.places()
    result = output.follow(jobs.run(job))
    files.write(result.table, str(result.report["surface"]))
    output.say_notes(result.notes)
    output.report(title, result.report, written, as_json, time.perf_counter() - start)


def made_table(text: str, illuminant: str, size: int | None) -> surface.ScatterTable:
    """Read a table or make one of a preset, under a progress bar.

    Parameters
    ----------
    text : str
        A table's file, or a grating's preset.
    illuminant : str
        Of a preset's light.
    size : int, optional
        Of a preset's table.

    Returns
    -------
    ScatterTable
        The table.
    """
    found = output.follow(jobs.named_table_stages(text, illuminant, size))
    assert isinstance(found, surface.ScatterTable)
    return found


@dataclass(frozen=True)
class PictureFiles:
    """The files of a rendering.

    Parameters
    ----------
    out : Path
        The picture: linear with alpha in EXR, for a screen in PNG and JPEG.
    preview : Path, optional
        Picture to look at.
    exposure : float, optional
        Stops of what is to be looked at.
    """

    out: Path
    preview: Path | None = None
    exposure: float | None = None

    def write(self, path: Path, drawn: Picture, stops: float, words: str | None = None) -> None:
        """Write a picture as its format wants it."""
        attributes = {} if words is None else {"ImageDescription": picture.Attribute("string", words)}
        if picture.format_of(path) in SHOWN:
            output.write_display(path, picture.to_display(_on_screen(drawn), exposure=stops), attributes)
            return
        told = picture.with_attributes(drawn, attributes) if attributes else drawn
        output.write(path, told, output.pixel_type_for(path, "auto"))


def still(job: jobs.SurfaceRenderJob, files: PictureFiles, as_json: bool) -> None:
    """Draw a surface, write and report.

    Parameters
    ----------
    job : SurfaceRenderJob
        What to draw.
    files : PictureFiles
        What to write.
    as_json : bool
        Whether a machine reads the report.
    """
    start = time.perf_counter()
    written = output.places(files.out, files.preview)
    result = output.follow(jobs.run(job))
    if files.exposure is not None:
        result.report["exposure_stops"] = files.exposure
    stops = result.report["exposure_stops"]
    files.write(files.out, result.picture, stops)
    if files.preview is not None:
        output.write_display(files.preview, picture.to_display(_on_screen(result.picture), exposure=stops))
    output.report("render", result.report, written, as_json, time.perf_counter() - start)


def turntable(
    job: jobs.SurfaceRenderJob,
    turning: dict[str, Any],
    moving: MovingFlags,
    files: PictureFiles,
    as_json: bool,
) -> None:
    """Draw a surface that turns, write each frame when it is ready, and report.

    Parameters
    ----------
    job : SurfaceRenderJob
        The first frame.
    turning : dict
        What turns, and how far.
    moving : MovingFlags
        How long, and which frames.
    files : PictureFiles
        Name with #### for the frame's number, and the exposure of all.
    as_json : bool
        Whether a machine reads the report.
    """
    if files.preview is not None:
        raise refuse.Refusal("'preview' is for one picture; --contact-sheet shows all frames.")
    start = time.perf_counter()
    stops: list[float] = [] if files.exposure is None else [files.exposure]

    def exposure() -> float:
        # All frames are shown alike: as the first suits, whichever of them are made.
        if not stops:
            stops.append(output.follow(jobs.run(job)).report["exposure_stops"])
        return stops[0]

    def write(path: Path, frame: jobs.Frame) -> None:
        shown = exposure() if picture.format_of(path) in SHOWN else 0.0
        files.write(path, frame.picture, shown, frame.description)

    made = FrameFiles(files.out, moving, write)
    written = made.places()
    result = made.follow(jobs.run(jobs.SurfaceTurnJob(job, made.frames(), **turning)))
    if moving.contact_sheet is not None:
        shown = picture.to_display(result.contact_sheet, exposure=exposure())
        output.write_display(moving.contact_sheet, shown)
    made.tell("render", result.report, written, as_json, time.perf_counter() - start)


def _on_screen(drawn: Picture) -> Picture:
    """Cut off the negative parts of spectral colours, whose luminance would draw a line through violet."""
    return replace(drawn, pixels=np.maximum(drawn.pixels, np.float32(0.0)))
