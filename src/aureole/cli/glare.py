"""The command `aureole glare`: a picture as a camera or an eye sees it."""

from typing import Any

from aureole import jobs, refuse
from aureole.cli import eye_runs, options, runs, sequence_runs
from aureole.cli.eye_options import AnimationFlags, EyeFlags, OverFlags
from aureole.cli.field_options import FieldFlags
from aureole.cli.glare_options import FileFlags, KernelFile, Look, LookFlags
from aureole.cli.lights_options import GlareLightFlags
from aureole.cli.moving import MovingFlags, given
from aureole.cli.occlusion_options import OcclusionFlags
from aureole.cli.options import ShapeFlags
from aureole.cli.pupil_options import PupilFlags, with_flags
from aureole.cli.sequence_runs import SequenceFlags
from aureole.jobs import frame_files

# Flags of a pupil that an eye has, too.
SHARED = ("seed", "defocus", "zernike")


@with_flags("pupil", PupilFlags)
@with_flags("moving", AnimationFlags)
@with_flags("viewer", EyeFlags)
@with_flags("over", OverFlags)
@with_flags("sequence", SequenceFlags)
@with_flags("across", FieldFlags)
@with_flags("mixing", LookFlags)
@with_flags("how", FileFlags)
@with_flags("lit", GlareLightFlags)
@with_flags("behind", OcclusionFlags)
def glare(
    source: options.Source,
    out: options.Out,
    pupil: PupilFlags,
    over: OverFlags,
    viewer: EyeFlags,
    moving: AnimationFlags,
    sequence: SequenceFlags,
    across: FieldFlags,
    mixing: LookFlags,
    how: FileFlags,
    lit: GlareLightFlags,
    behind: OcclusionFlags,
    focal_length: options.FocalLength = None,
    f_number: options.FNumber = None,
    preset: options.Preset = None,
    sensor: options.Sensor = None,
    pitch: options.PixelPitch = None,
    iris: options.Iris = None,
    aperture: options.Shape = None,
    blades: options.Blades = None,
    curvature: options.Curvature = None,
    rotation: options.Rotation = None,
    obstruction: options.Obstruction = None,
    width: options.Width = None,
    height: options.Height = None,
    aperture_picture: options.ApertureFile = None,
    matte: options.Matte = None,
    kernel_size: options.KernelSide = None,
    kernel_file: KernelFile = None,
    psf: options.Psf = None,
    preview: options.Preview = None,
    as_json: options.Json = False,
) -> None:
    """Lay the glare of a camera, or of an eye, over a linear HDR picture.

    A camera's picture spans its sensor's width, an eye's its field of view. Energy is kept: what glare
    spreads is taken from the lamps. With --eye and --animate the picture is seen through time: the pupil
    trembles, the lids blink, the needles shimmer. IN and OUT with #### are sequences of pictures: frames that
    lie there whole are kept, one that is missing or broken does not stop the rest (exit code 1).

    Examples:

        aureole glare night.exr -o out.exr --focal-length 50mm --f-number 16 --blades 7

        aureole glare night.exr -o out.exr --preset super35-35mm-f8 --mode scatter --preview look.png

        aureole glare night.exr -o out.exr --mode add --threshold 2 --gain 3 --tint 1,0.9,0.8

        aureole glare night.exr -o out.exr --lights auto

        aureole glare sunset.exr -o out.exr --occlusion picture

        aureole glare night.exr -o out.exr --dust 10% --dust-scale 0.3mm --scratches 20 --seed 7

        aureole glare night.exr -o out.exr --f-number 2.8 --lens zeiss_biotar_50mm --field 5x3

        aureole glare night.exr -o out.exr --aperture circle --eyelashes 8

        aureole glare night.exr -o seen.exr --eye --age 70 --luminance 10cd/m2 --field-of-view 60deg

        aureole glare night.exr -o seen.####.exr --eye --animate 2s --fps 12 --quick --photosafe

        aureole glare shot.####.exr -o out.####.exr --frames 1001-1240 --log shot.log --video look.mp4
    """
    shape = ShapeFlags(
        aperture, blades, curvature, rotation, obstruction, width, height, aperture_picture, pupil
    )
    files = runs.GlareFiles(source, out, psf, preview, matte, how, lit.chosen())
    look = mixing.look()
    many = sequence_runs.Sequence(files, sequence, moving)
    lens = {"focal-length": focal_length, "f-number": f_number, "sensor": sensor, "iris": iris}
    lens |= {"pixel-pitch": pitch}
    hidden = behind.wanted()
    if over.eye:
        if hidden is not None:
            raise refuse.Refusal("'occlusion' is of cameras; it does not go with --eye.")
        _refuse_camera({**lens, "kernel": kernel_file}, shape, across, "--eye", SHARED)
        eye = _eye(viewer, moving, pupil, preset, look.illuminant)
        _seen(eye_runs.Over(eye, files, look, over, kernel_size), many, as_json)
        return
    _refuse_eye(over, viewer)
    if kernel_file is not None:
        _refuse_camera({**lens, "preset": preset}, shape, across, "--kernel")
    camera = options.optics(shape, preset, iris, focal_length, f_number, sensor)
    ready = None if kernel_file is None else str(kernel_file)
    field = across.wanted(pupil)
    size = options.pixel_pitch(pitch)
    kernel = runs.Kernel(kernel_size, size, across.whole_kernel, field, ready, hidden)
    _camera(camera, many, look, kernel, as_json)


def _camera(
    camera: jobs.Optics, asked: sequence_runs.Sequence, look: Look, kernel: runs.Kernel, as_json: bool
) -> None:
    """Lay a camera's glare over one picture, or over many."""
    if frame_files.is_pattern(asked.files.source):
        sequence_runs.glare(camera, asked, look, kernel, as_json)
        return
    _refuse_many(asked.flags, asked.moving)
    runs.glare(camera, asked.files, look, kernel, as_json)


def _seen(eye: eye_runs.Over, asked: sequence_runs.Sequence, as_json: bool) -> None:
    """Let an eye see one picture, or many."""
    if frame_files.is_pattern(asked.files.source):
        sequence_runs.seen(eye, asked, as_json)
        return
    for name in given(asked.flags):
        raise refuse.Refusal(f"'{name}' is for sequences; IN and OUT need #### for the frame's number.")
    assert isinstance(asked.moving, AnimationFlags)
    eye_runs.over(eye, asked.moving, as_json)


def _refuse_eye(over: OverFlags, viewer: EyeFlags) -> None:
    """Refuse flags of an eye where there is none."""
    for name in (*given(over), *given(viewer)):
        raise refuse.Refusal(f"'{name}' is for an eye's glare; it needs --eye.")


def _refuse_many(sequence: SequenceFlags, moving: MovingFlags) -> None:
    """Refuse flags of many pictures where there is one."""
    for name in given(sequence):
        raise refuse.Refusal(f"'{name}' is for sequences; IN and OUT need #### for the frame's number.")
    for name in given(moving):
        raise refuse.Refusal(f"'{name}' is for an eye or a sequence; it needs --eye, or IN with ####.")


def _refuse_camera(
    lens: dict[str, Any], shape: ShapeFlags, across: FieldFlags, beside: str, shared: tuple[str, ...] = ()
) -> None:
    """Refuse flags of a camera beside an eye, or beside a kernel that is ready."""
    opening = {name.replace("_", "-"): value for name, value in vars(shape).items() if name != "pupil"}
    typed = {**lens, **opening}
    names = [name for name, value in typed.items() if value is not None]
    names += [name for name in given(shape.pupil) if name not in shared] + given(across)
    for name in names:
        flag = "aperture-picture" if name == "picture" else name
        raise refuse.Refusal(f"'{flag}' is of cameras; it does not go with {beside}.")


def _eye(
    viewer: EyeFlags, moving: AnimationFlags, pupil: PupilFlags, preset: str | None, illuminant: str
) -> jobs.EyeJob:
    """Return the eye that the flags describe, some of which are a camera's otherwise."""
    how = viewer.how()
    track = moving.track(viewer, how["time"])
    person = viewer.viewer(preset, pupil.seed, pupil.defocus, pupil.zernike, track)
    return jobs.EyeJob(person, illuminant=illuminant, **how)
