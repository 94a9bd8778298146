"""The command `aureole lights glare`: lamps that pass behind occluders, a frame or a whole shot."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from aureole import jobs, picture, refuse
from aureole.cli import options, output, sequence_runs
from aureole.cli.glare_options import FileFlags
from aureole.cli.moving import MovingFlags, given
from aureole.cli.options import FILES
from aureole.cli.pupil_options import with_flags
from aureole.cli.runs import GlareFiles
from aureole.cli.sequence_runs import SequenceFlags
from aureole.jobs import frame_files
from aureole.jobs.lamp_glare import RASTER_SIZE, TOLERANCE

SAMPLES = "Samples of lamps"


@dataclass(frozen=True)
class ShotFlags:
    """The flags of a scene's frames; each field's option teaches its use.

    Parameters
    ----------
    frames : str, optional
        Which frames are wanted.
    overwrite : bool
        Whether files of frames that are there are made again.
    fps : float, optional
        Of the video.
    contact_sheet : Path, optional
        File to write.
    """

    frames: Annotated[
        str | None,
        typer.Option("--frames", help="Only these frames: 1-48x2, or 3,7,9.", rich_help_panel=FILES),
    ] = None
    overwrite: Annotated[
        bool,
        typer.Option(
            "--overwrite",
            help="Make all frames anew; those that lie there whole from this scene are kept otherwise.",
            rich_help_panel=FILES,
        ),
    ] = False
    fps: Annotated[
        float | None,
        typer.Option("--fps", help="Frames a second of the video; the scene's own.", rich_help_panel=FILES),
    ] = None
    contact_sheet: Annotated[
        Path | None,
        typer.Option(
            "--contact-sheet",
            help="Also write small pictures of all frames on one sheet: PNG or JPEG.",
            rich_help_panel=FILES,
        ),
    ] = None

    def moving(self, scene_rate: float, with_video: bool) -> MovingFlags:
        """Return the same as other sequences have it."""
        rate = scene_rate if with_video and self.fps is None else self.fps
        return MovingFlags(None, rate, self.frames, self.overwrite, self.contact_sheet)


@with_flags("shot", ShotFlags)
@with_flags("sequence", SequenceFlags)
def glare(
    scene: Annotated[
        str, typer.Argument(metavar="SCENE", help="A scene (TOML), or a preset of `aureole presets`.")
    ],
    out: options.Out,
    shot: ShotFlags,
    sequence: SequenceFlags,
    frame: Annotated[
        float | None,
        typer.Option(
            "--frame", help="Of one picture: which frame, such as 12 or 12.5.", rich_help_panel=FILES
        ),
    ] = None,
    size: Annotated[
        str | None,
        typer.Option("--size", help="Pixels in place of the scene's: 960x540.", rich_help_panel=FILES),
    ] = None,
    samples: Annotated[
        int | None,
        typer.Option(
            "--samples",
            help="Samples across each lamp; as many as --tolerance needs, 33 at most, unless given.",
            rich_help_panel=SAMPLES,
        ),
    ] = None,
    tolerance: Annotated[
        float,
        typer.Option(
            "--tolerance",
            help="By what part a lamp's glare may change from about half as many samples across.",
            rich_help_panel=SAMPLES,
        ),
    ] = TOLERANCE,
    raster: Annotated[
        int,
        typer.Option(
            "--raster",
            help="Pixels across the opening, where an occluder is a picture.",
            rich_help_panel=SAMPLES,
        ),
    ] = RASTER_SIZE,
    preview: options.Preview = None,
    pixel_type: options.PixelType = "auto",
    memory: options.Memory = None,
    as_json: options.Json = False,
) -> None:
    """Make pictures of lamps behind occluders: glare changes its shape as bars, edges and leaves pass.

    The iris is drawn as each point of a lamp sees it past what stands between, and the glare of these parts
    is added up. Occluders lie out of focus over the background. OUT with #### makes the scene's frames:
    those that lie there whole are kept, and one that fails does not stop the rest (exit code 1).

    A scene is a file such as

        columns = 960
        rows = 540
        frames = 48

        [camera]
        focal_length_mm = 85
        f_number = 8

        [[lamps]]
        shape = "disc"
        size_mm = 100
        distance_m = 20
        path_m = [[1, -1.0, 0.2], [48, 1.0, -0.2]]
        illuminant = "A"
        radiance = 20000

        [[occluders]]
        shape = "railing"
        distance_m = 0.5
        bar_mm = 12
        gap_mm = 12

    A path has [frame, right, down] from the axis, in metres (path_deg: degrees). Lamps are disc, square,
    polygon or picture; occluders are railing, edge, disc, rectangle, polygon or picture (white is opaque).

    Examples:

        aureole lights glare railing -o lamp.exr --frame 24 --preview lamp.png

        aureole lights glare railing -o shot.####.exr --contact-sheet sheet.png --video shot.mp4

        aureole lights glare scene.toml -o shot.####.exr --frames 1-48x4 --workers 4
    """
    file = jobs.read_scene(scene)
    shape = None if size is None else options.size(size)
    how = FileFlags(pixel_type=pixel_type, memory=memory)
    maker = jobs.LampMaker(file, shape, samples, tolerance, raster, how.most())
    maker.refuse()
    files = GlareFiles(file.path, out, preview=preview, how=how)
    if frame_files.is_pattern(out):
        if frame is not None:
            raise refuse.Refusal("'frame' is for one picture; 'frames' says which of a shot.")
        moving = shot.moving(file.scene.fps, sequence.video is not None)
        _shot(maker, sequence_runs.Sequence(files, sequence, moving), as_json)
        return
    for name in (*given(shot), *given(sequence)):
        raise refuse.Refusal(f"'{name}' is for shots; OUT needs #### for the frame's number.")
    _picture(maker, files, 1.0 if frame is None else frame, as_json)


def _shot(maker: jobs.LampMaker, asked: sequence_runs.Sequence, as_json: bool) -> None:
    """Make many frames."""
    asked.check(False)
    maker = jobs.LampMaker(**{**vars(maker), "memory": asked.frame_memory})
    out = asked.files.out
    tasks = jobs.lamp_tasks(
        maker, out, asked.moving.numbers(), asked.files.how.writing(out), asked.moving.overwrite
    )
    sequence_runs.make("lights glare", asked, tasks, as_json)


def _picture(maker: jobs.LampMaker, files: GlareFiles, frame: float, as_json: bool) -> None:
    """Make one frame."""
    start = time.perf_counter()
    written = output.places(files.out, files.preview)
    result = output.follow(jobs.run(maker.job(frame)))
    output.write(files.out, result.picture, **files.how.writing(files.out))
    if files.preview is not None:
        shown = picture.to_display(result.picture, exposure=picture.auto_exposure(result.picture))
        output.write_display(files.preview, shown)
    report = result.report
    if not as_json:
        lamps = report["lamps"]
        report = {name: value for name, value in report.items() if name != "lamps"}
        report["openings"] = [lamp["openings"] for lamp in lamps]
        report["error"] = [lamp["error"] for lamp in lamps]
    output.report("lights glare", report, written, as_json, time.perf_counter() - start)
