"""The main job: a linear HDR picture in, the same picture with a camera's glare out."""

import dataclasses
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import glare, light, picture, refuse
from aureole.jobs import glare_occlusion
from aureole.jobs.glare_field import FieldKernels, GlareField, PreparedField, field_stages
from aureole.jobs.glare_occlusion import GlareOcclusion
from aureole.jobs.optics import Optics
from aureole.jobs.starburst import psf_report
from aureole.records import Camera, Picture, Stage

# Measured peaks, rounded up: the starburst's widest pattern and the convolution's spectra.
BYTES_PER_KERNEL_PIXEL = 150
BYTES_PER_PIXEL = 100
# A field's kernels are kept twice: as they came, and what of them is spread.
BYTES_PER_FURTHER_KERNEL = 24
# Their spectra are kept where they fit: twice the kernel's pixels at most, three channels, double precision.
BYTES_PER_SPECTRUM_PIXEL = 48


@dataclass(frozen=True, eq=False)
class GlareJob:
    """What glare to lay over which picture.

    Parameters
    ----------
    picture : Picture
        Linear; it spans the sensor's width.
    optics : Optics
        The camera.
    illuminant : str
        Spectrum of white in the picture.
    mode : str
        "replace", "scatter", "add" or "bloom".
    matte : ndarray, optional
        0..1, which pixels are sources.
    threshold, knee, gain : float
        Of mode "add".
    tint : tuple of float
        Of mode "add".
    kernel_size : int, optional
        Side of the square kernel in pixels; as large as the picture's longer side otherwise.
    whole_kernel : bool
        Whether the kernel reaches from any pixel to any other, unfaded, in place of a square one.
    field : GlareField, optional
        What changes over the frame; one kernel serves all of it otherwise.
    pixel_pitch : float, optional
        Metres on the sensor, in place of the sensor's width over the picture's.
    method : str
        As in `aureole.diffraction.starburst`.
    border_fade : float
        Part of the kernel's half size over which it fades to zero.
    precision : str
        Of the convolution, "single" or "double".
    occlusion : GlareOcclusion, optional
        What hides parts of the iris from the lights; nothing does otherwise.
    kernel : str, optional
        File of a point spread function in place of the camera's: energy per pixel, its core at
        (rows // 2, columns // 2), at most 1 in all.
    memory : int, optional
        Most bytes to use; three quarters of what is free otherwise.
    """

    picture: Picture
    optics: Optics = dataclasses.field(default_factory=Optics)
    illuminant: str = "D65"
    mode: str = "replace"
    matte: NDArray[np.floating] | None = None
    threshold: float = 1.0
    knee: float = 0.5
    gain: float = 1.0
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)
    kernel_size: int | None = None
    whole_kernel: bool = False
    field: GlareField | None = None
    pixel_pitch: float | None = None
    method: str = "auto"
    border_fade: float = 0.25
    precision: str = "double"
    occlusion: GlareOcclusion | None = None
    kernel: str | None = None
    memory: int | None = None


@dataclass(frozen=True, eq=False)
class GlareResult:
    """A picture with glare, the kernel that made it, and what is worth knowing.

    Parameters
    ----------
    picture : Picture
        Size, windows and channels of the source.
    psf : Picture
        The point spread function.
    camera : Camera
        The camera it is of.
    report : dict
        Plain numbers with units in their names.
    """

    picture: Picture
    psf: Picture
    camera: Camera
    report: dict[str, Any]


@dataclass(frozen=True, eq=False)
class PreparedGlare:
    """A kernel ready for pictures of one size.

    Parameters
    ----------
    camera : Camera
        The camera it is of.
    psf : Picture
        The point spread function.
    composition : aureole.glare.Composition
        The same, ready to be laid over pictures.
    vignette : ndarray of float32, shape (rows, columns), optional
        By how much the picture darkens where rims crop the opening.
    report : dict
        What is worth knowing of the kernel.
    """

    camera: Camera
    psf: Picture
    composition: glare.Composition
    vignette: NDArray[np.float32] | None = None
    report: dict[str, Any] = dataclasses.field(default_factory=dict)


def run_glare(job: GlareJob) -> Iterator[Stage]:
    """Run a glare job.

    Parameters
    ----------
    job : GlareJob
        What to do.

    Yields
    ------
    Stage
        The last one holds a `GlareResult`.
    """
    prepared = None
    for stage in prepared_glare(job):
        prepared = stage.result
        yield Stage(0.8 * stage.fraction, stage.label)
    assert isinstance(prepared, PreparedGlare)
    yield Stage(0.8, "spreading the light")
    result = lay_over(job, prepared)
    if job.mode == "bloom" and job.field is None:
        yield Stage(0.9, "estimating the error")
        found = glare.bloom_psnr(in_working_space(job.picture)[0], prepared.psf, result.picture, job.matte)
        result.report["bloom_psnr_db"] = round(found, 1) if math.isfinite(found) else None
    yield Stage(1.0, "glare", result)


def prepared_glare(job: GlareJob) -> Iterator[Stage]:
    """Make all of a glare job that does not depend on the picture's pixels.

    Parameters
    ----------
    job : GlareJob
        Of its picture only the size, the windows and the colour space count.

    Yields
    ------
    Stage
        The last one holds a `PreparedGlare`.
    """
    refuse_words(job)
    if job.kernel is not None:
        yield Stage(0.0, "reading the kernel")
        yield Stage(1.0, "preparing the kernel", _from_file(job, Path(job.kernel)))
        return
    _, space = in_working_space(job.picture)
    lamp = light.illuminant(job.illuminant)
    camera = picture_camera(job)
    shape = _kernel_shape(job, camera)
    _refuse_memory(job, shape)
    fade = 0.0 if job.whole_kernel else job.border_fade

    def psf_from(camera: Camera) -> Iterator[Stage]:
        return glare.camera_psf_stages(camera, shape, lamp, space, job.method, "area", fade)

    made: Any = None
    for stage in _field(job, psf_from) if job.field is not None else psf_from(camera):
        made = stage.result
        yield Stage(0.875 * stage.fraction, stage.label)
    yield Stage(0.875, "preparing the kernel")
    if isinstance(made, PreparedField):
        report = psf_report(camera, made.psf, lamp.name) | made.report
        ready = PreparedGlare(camera, made.psf, made.composition, made.vignette, report)
    else:
        rows, columns = job.picture.pixels.shape[:2]
        composition = glare.prepare(made, (rows, columns), job.mode, precision=job.precision)
        ready = PreparedGlare(camera, made, composition, None, psf_report(camera, made, lamp.name))
    yield Stage(1.0, "preparing the kernel", ready)


def lay_over(job: GlareJob, prepared: PreparedGlare) -> GlareResult:
    """Lay glare that is ready over a job's picture.

    Parameters
    ----------
    job : GlareJob
        What to do.
    prepared : PreparedGlare
        Of this job, or of one whose picture has the same size, windows and colour space.

    Returns
    -------
    GlareResult
        The picture with its glare.
    """
    source = _darkened(in_working_space(job.picture)[0], prepared.vignette)
    out = glare.composite(
        source,
        prepared.composition,
        matte=job.matte,
        threshold=job.threshold,
        knee=job.knee,
        gain=job.gain,
        tint=job.tint,
    )
    report = prepared.report | {"mode": job.mode}
    if job.occlusion is not None:
        out, report["occluded_lights"] = _occluded(job, job.occlusion, source, out, prepared)
    report["energy_returned_to_core"] = prepared.composition.returned
    report["sum_before"] = picture_sums(job.picture)
    report["sum_after"] = picture_sums(out)
    out = Picture(out.pixels, job.picture.colour_space, job.picture.metadata)
    return GlareResult(out, prepared.psf, prepared.camera, report)


def _occluded(
    job: GlareJob, how: GlareOcclusion, source: Picture, out: Picture, prepared: PreparedGlare
) -> tuple[Picture, list[dict[str, Any]]]:
    """Give lights behind something the glare of what they see of the iris; tell which they are."""
    lights = glare_occlusion.occluded_lights(source, prepared.camera, how)
    lamp, shape = light.illuminant(job.illuminant), prepared.psf.pixels.shape[:2]
    fade = 0.0 if job.whole_kernel else job.border_fade

    def psf_of(camera: Camera) -> Picture:
        return glare.camera_psf(camera, shape, lamp, source.colour_space, job.method, border_fade=fade)

    def lay(part: Picture, psf: Picture | glare.Composition) -> Picture:
        return glare.composite(part, psf, job.mode, matte=job.matte, precision=job.precision)

    seen = glare_occlusion.with_occlusion(out, source, lights, psf_of, lay, prepared.composition)
    return seen, glare_occlusion.occlusion_report(lights)


def refuse_words(job: GlareJob) -> None:
    """Refuse words of a job that mean nothing.

    Parameters
    ----------
    job : GlareJob
        Any.

    Raises
    ------
    refuse.Refusal
        Where its mode or its precision is unknown, or what makes a kernel stands beside one that is made.
    """
    refuse.one_of("mode", job.mode, glare.MODES)
    refuse.one_of("precision", job.precision, ("single", "double"))
    if job.occlusion is not None:
        glare_occlusion.check(job.occlusion, job.mode)
        for name in (name for name in ("field", "kernel") if getattr(job, name) is not None):
            raise refuse.Refusal(f"'occlusion' needs the camera's one iris; it does not go with '{name}'.")
    if job.kernel is not None:
        sizes = {"kernel_size": job.kernel_size, "whole_kernel": job.whole_kernel or None, "field": job.field}
        for name in (name for name, value in sizes.items() if value is not None):
            raise refuse.Refusal(f"'{name}' does not go with 'kernel', whose file has it all.")


def read_matte(path: Path, source: Picture) -> NDArray[np.float32]:
    """Read a matte of a picture's size.

    Parameters
    ----------
    path : Path
        A picture whose grey is 0..1.
    source : Picture
        The picture that it belongs to.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Luminance, clipped to 0..1.

    Raises
    ------
    refuse.Refusal
        Where the sizes differ.
    """
    given = picture.read(path)
    if given.pixels.shape[:2] != source.pixels.shape[:2]:
        have, want = given.pixels.shape, source.pixels.shape
        raise refuse.Refusal(
            f"'matte' must be {want[1]} x {want[0]} pixels like the picture, got {have[1]} x {have[0]}."
        )
    weights = light.SPACES["rec709"].to_xyz[1].astype(np.float32)
    return np.asarray(np.clip(given.pixels[..., :3] @ weights, 0, 1), dtype=np.float32)


def picture_camera(job: GlareJob) -> Camera:
    """Return the camera whose sensor the picture's display window fills from side to side.

    Parameters
    ----------
    job : GlareJob
        Any.

    Returns
    -------
    Camera
        Its resolution that of the display window.
    """
    header = picture.header_of(job.picture)
    rows, columns = job.picture.pixels.shape[:2]
    aspect = 1.0
    if header is not None:
        rows, columns = header.display_window.height, header.display_window.width
        aspect = header.pixel_aspect
    return job.optics.camera((rows, columns), aspect, job.pixel_pitch)


def _from_file(job: GlareJob, path: Path) -> PreparedGlare:
    """Make a kernel ready that somebody has made, in the picture's own colours."""
    given, _ = in_working_space(picture.read(path, memory=job.memory))
    _, space = in_working_space(job.picture)
    psf = light.convert(Picture(given.pixels[..., :3], given.colour_space), space)
    pixels = psf.pixels
    shape = pixels.shape[0], pixels.shape[1]
    _refuse_memory(job, shape)
    rows, columns = job.picture.pixels.shape[:2]
    composition = glare.prepare(psf, (rows, columns), job.mode, precision=job.precision)
    core = float(pixels[shape[0] // 2, shape[1] // 2].mean())
    report = {
        "kernel": str(path),
        "kernel_size": [shape[1], shape[0]],
        "energy_inside": float(pixels.sum(axis=(0, 1), dtype=np.float64).mean()),
        "energy_in_core_pixel": core,
    }
    return PreparedGlare(job.optics.camera(), psf, composition, None, report)


def _field(job: GlareJob, psf_from: Callable[[Camera], Iterator[Stage]]) -> Iterator[Stage]:
    """Make the field's point spread functions, each with what its direction's light finds."""
    assert job.field is not None
    plain = picture_camera(job)
    moves = job.optics.opening.dirt_distance is not None

    def camera_from(direction: tuple[float, float] | None) -> Camera:
        if direction is None or not moves:
            return plain
        return picture_camera(replace(job, optics=job.optics.at(direction=direction)))

    rows, columns = job.picture.pixels.shape[:2]
    header = picture.header_of(job.picture)
    corner = (0, 0)
    if header is not None:
        data, shown = header.data_window, header.display_window
        corner = (data.y - shown.y, data.x - shown.x)
    kernels = FieldKernels(job.field.housing(plain), camera_from, psf_from)
    return field_stages(job.field, kernels, (rows, columns), corner, job.mode, job.precision)


def _darkened(source: Picture, vignette: NDArray[np.float32] | None) -> Picture:
    """Return a picture as dark as the lens's rims make it."""
    if vignette is None:
        return source
    pixels = source.pixels.copy()
    pixels[..., :3] *= vignette[..., None]
    return Picture(pixels, source.colour_space, source.metadata)


def _kernel_shape(job: GlareJob, camera: Camera) -> tuple[int, int]:
    """Return odd sides, so that the core has as much on each side."""
    if job.whole_kernel:
        if job.kernel_size is not None:
            raise refuse.Refusal(
                "'kernel_size' and 'whole_kernel' both set the kernel's size; give one of them."
            )
        rows, columns = job.picture.pixels.shape[:2]
        return 2 * rows - 1, 2 * columns - 1
    if job.kernel_size is not None:
        return (refuse.at_least("kernel_size", job.kernel_size, 1),) * 2
    return (max(camera.resolution) | 1,) * 2


def _refuse_memory(job: GlareJob, shape: tuple[int, int]) -> None:
    """Refuse kernels and a picture that would not fit, before any work."""
    rows, columns = job.picture.pixels.shape[:2]
    # One more stands half way between places, for the error.
    kernels = 1 if job.field is None else job.field.nodes[0] * job.field.nodes[1] + 1
    needed = (BYTES_PER_KERNEL_PIXEL + BYTES_PER_FURTHER_KERNEL * (kernels - 1)) * shape[0] * shape[1]
    needed += BYTES_PER_PIXEL * rows * columns
    if kernels > 1:
        needed += min(picture.MOST_SPECTRA, BYTES_PER_SPECTRUM_PIXEL * kernels * shape[0] * shape[1])
    limit = picture.allowed_memory(job.memory)
    if needed > limit:
        raise refuse.Refusal(
            f"a kernel of {shape[1]} x {shape[0]} on {columns} x {rows} pixels needs about "
            f"{needed / 1e9:.3g} GB of memory, {limit / 1e9:.3g} GB are allowed; see --memory and "
            "--kernel-size."
        )


def in_working_space(source: Picture) -> tuple[Picture, str]:
    """Take primaries that have no name of ours as the working space's own.

    Parameters
    ----------
    source : Picture
        Any.

    Returns
    -------
    picture : Picture
        The same pixels.
    space : str
        Its colour space, one of `aureole.light.SPACES`.
    """
    space = source.colour_space if source.colour_space in light.SPACES else "rec709"
    return Picture(source.pixels, space, source.metadata), space


def picture_sums(source: Picture) -> list[float]:
    """Return the sum of each colour channel.

    Parameters
    ----------
    source : Picture
        Any.

    Returns
    -------
    list of float
        Three sums, taken in double precision.
    """
    return [float(value) for value in source.pixels[..., :3].sum(axis=(0, 1), dtype=np.float64)]
