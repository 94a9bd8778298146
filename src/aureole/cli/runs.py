"""Running a command's job: outputs are refused before work, files are written after it."""

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aureole import jobs, picture
from aureole.cli import output, views
from aureole.cli.glare_options import FileFlags, Look
from aureole.records import Picture


@dataclass(frozen=True)
class GlareFiles:
    """The files of the command `glare`, and how they are read and written.

    Parameters
    ----------
    source, out : Path
        Picture in, picture out.
    psf, preview, matte : Path, optional
        Kernel out, PNG out, matte in.
    how : FileFlags
        Pixel type, colours, memory, and what becomes of NaN.
    lights : GlareLights, optional
        Which lights make glare; all light without it.
    """

    source: Path
    out: Path
    psf: Path | None = None
    preview: Path | None = None
    matte: Path | None = None
    how: FileFlags = field(default_factory=FileFlags)
    lights: jobs.GlareLights | None = None

    def sources(self, given: Picture) -> NDArray[np.floating] | None:
        """Return how much of each pixel makes glare, 0..1; None where all does."""
        matte = None if self.matte is None else jobs.read_matte(self.matte, given)
        lit = jobs.lit_by(self.lights, given)
        if lit is not None and not lit.any():
            output.say_notes(["no light is found in the picture: nothing makes glare"])
        return matte if lit is None else lit if matte is None else matte * lit


@dataclass(frozen=True)
class Kernel:
    """The kernel of a camera's glare.

    Parameters
    ----------
    kernel_size : int, optional
        Side in pixels.
    pixel_pitch : float, optional
        Metres.
    whole_kernel : bool
        As in `aureole.jobs.GlareJob`.
    field : GlareField, optional
        As in `aureole.jobs.GlareJob`.
    kernel : str, optional
        As in `aureole.jobs.GlareJob`.
    occlusion : GlareOcclusion, optional
        As in `aureole.jobs.GlareJob`.
    """

    kernel_size: int | None = None
    pixel_pitch: float | None = None
    whole_kernel: bool = False
    field: jobs.GlareField | None = None
    kernel: str | None = None
    occlusion: jobs.GlareOcclusion | None = None


def glare(
    camera: jobs.Optics,
    files: GlareFiles,
    look: Look,
    kernel: Kernel,
    as_json: bool,
) -> None:
    """Read, spread, write and report.

    Parameters
    ----------
    camera : Optics
        The camera.
    files : GlareFiles
        What to read and write.
    look : Look
        How to mix.
    kernel : Kernel
        Its size, and what of it changes over the frame.
    as_json : bool
        Whether a machine reads the report.
    """
    start = time.perf_counter()
    written = output.places(files.out, files.psf, files.preview)
    given = read(files)
    job = jobs.GlareJob(
        given,
        camera,
        matte=files.sources(given),
        memory=files.how.most(),
        **vars(kernel),
        **vars(look),
    )
    result = output.follow(jobs.run(job))
    write_picture(files, files.out, result.picture)
    if files.psf is not None:
        output.write(files.psf, result.psf, "float")
    if files.preview is not None:
        output.write_display(files.preview, views.before_and_after(given, result.picture))
    output.report("glare", result.report, written, as_json, time.perf_counter() - start)


def read(files: GlareFiles) -> Picture:
    """Read the picture in, and say what is worth knowing about it.

    Parameters
    ----------
    files : GlareFiles
        Where it is, and how to read it.

    Returns
    -------
    Picture
        Linear.
    """
    given = picture.read(files.source, **files.how.reading())
    output.say_notes(picture.notes(given))
    return given


def write_picture(files: GlareFiles, path: Path, source: Picture) -> None:
    """Write a picture as the files out are asked for.

    Parameters
    ----------
    files : GlareFiles
        How to write.
    path : Path
        File to write.
    source : Picture
        Linear.
    """
    output.write(path, source, **files.how.writing(path))


def starburst(
    job: jobs.StarburstJob, out: Path, preview: Path | None, page: Path | None, as_json: bool
) -> None:
    """Make a point spread function, write and report.

    Parameters
    ----------
    job : StarburstJob
        What to make.
    out : Path
        Kernel out.
    preview : Path, optional
        PNG out.
    page : Path, optional
        One page of curves and numbers out: PNG, JPEG, PDF or SVG; the job must ask for the measures.
    as_json : bool
        Whether a machine reads the report.
    """
    start = time.perf_counter()
    written = output.places(out, preview)
    if page is not None:
        written.append(output.another(jobs.check_page(page), written))
    result = output.follow(jobs.run(job))
    output.write(out, result.picture, output.pixel_type_for(out, "auto"))
    if preview is not None:
        output.write_display(preview, views.kernel(result.picture))
    if page is not None:
        jobs.write_page(page, result.psf, result.camera, result.measures, result.report["illuminant"])
    output.report("starburst", result.report, written, as_json, time.perf_counter() - start)


def aperture(job: jobs.ApertureJob, out: Path, as_json: bool) -> None:
    """Draw an aperture, write and report.

    Parameters
    ----------
    job : ApertureJob
        What to draw.
    out : Path
        Picture out.
    as_json : bool
        Whether a machine reads the report.
    """
    start = time.perf_counter()
    written = output.places(out)
    result = output.follow(jobs.run(job))
    output.write(out, result.picture, output.pixel_type_for(out, "auto"))
    output.report("aperture", result.report, written, as_json, time.perf_counter() - start)


def demo(job: jobs.DemoJob, folder: Path, as_json: bool) -> None:
    """Run the demonstration, write its files and report.

    Parameters
    ----------
    job : DemoJob
        What to show.
    folder : Path
        Where the files go; made where it is missing.
    as_json : bool
        Whether a machine reads the report.
    """
    start = time.perf_counter()
    output.make_folder(folder)
    names = ("scene.exr", "flare.exr", "ghosts.exr", "psf.exr", "flare.png", "preview.png")
    files = [folder / name for name in names]
    output.places(*files)
    result = output.follow(jobs.run(job))
    scene, after = result.scene, result.picture
    output.write_all(
        [
            lambda: output.write_display(files[5], views.before_and_after(scene, after)),
            lambda: output.write_display(files[4], views.exposed(after, scene)),
            lambda: output.write(files[3], result.glare.psf, "float"),
            lambda: output.write(files[2], result.ghosts.ghosts, "float"),
            lambda: output.write(files[1], after, "float"),
            lambda: output.write(files[0], scene, "float"),
        ]
    )
    ghosts = {name: result.ghosts.report[name] for name in ("lens", "ghosts", "ghost_to_image")}
    output.report("demo", result.glare.report | ghosts, files, as_json, time.perf_counter() - start)
