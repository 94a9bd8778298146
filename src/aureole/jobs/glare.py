"""The main job: a linear HDR picture in, the same picture with a camera's glare out."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import glare, light, picture, refuse
from aureole.jobs.optics import Optics
from aureole.jobs.starburst import psf_report
from aureole.records import Camera, Picture, Stage

# Measured peaks, rounded up: the starburst's widest pattern and the convolution's spectra.
BYTES_PER_KERNEL_PIXEL = 150
BYTES_PER_PIXEL = 100


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
        "replace", "scatter" or "add".
    matte : ndarray, optional
        0..1, which pixels are sources.
    threshold, knee, gain : float
        Of mode "add".
    tint : tuple of float
        Of mode "add".
    kernel_size : int, optional
        Side of the square kernel in pixels; as large as the picture's longer side otherwise.
    pixel_pitch : float, optional
        Metres on the sensor, in place of the sensor's width over the picture's.
    method : str
        As in `aureole.diffraction.starburst`.
    border_fade : float
        Part of the kernel's half size over which it fades to zero.
    precision : str
        Of the convolution, "single" or "double".
    memory : int, optional
        Most bytes to use; three quarters of what is free otherwise.
    """

    picture: Picture
    optics: Optics = field(default_factory=Optics)
    illuminant: str = "D65"
    mode: str = "replace"
    matte: NDArray[np.floating] | None = None
    threshold: float = 1.0
    knee: float = 0.5
    gain: float = 1.0
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)
    kernel_size: int | None = None
    pixel_pitch: float | None = None
    method: str = "auto"
    border_fade: float = 0.25
    precision: str = "double"
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
    illuminant : str
        The light's name.
    """

    camera: Camera
    psf: Picture
    composition: glare.Composition
    illuminant: str


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
    yield Stage(1.0, "glare", lay_over(job, prepared))


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
    _, space = in_working_space(job.picture)
    lamp = light.illuminant(job.illuminant)
    camera = picture_camera(job)
    size = _kernel_size(job, camera)
    _refuse_memory(job, size)
    psf = None
    for stage in glare.camera_psf_stages(
        camera, (size, size), lamp, space, job.method, "area", job.border_fade
    ):
        psf = stage.result
        yield Stage(0.875 * stage.fraction, stage.label)
    assert isinstance(psf, Picture)
    yield Stage(0.875, "preparing the kernel")
    rows, columns = job.picture.pixels.shape[:2]
    ready = glare.prepare(psf, (rows, columns), job.mode, precision=job.precision)
    yield Stage(1.0, "preparing the kernel", PreparedGlare(camera, psf, ready, lamp.name))


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
    source, _ = in_working_space(job.picture)
    out = glare.composite(
        source,
        prepared.composition,
        matte=job.matte,
        threshold=job.threshold,
        knee=job.knee,
        gain=job.gain,
        tint=job.tint,
    )
    report = psf_report(prepared.camera, prepared.psf, prepared.illuminant)
    report["mode"] = job.mode
    report["energy_returned_to_core"] = prepared.composition.returned
    report["sum_before"] = picture_sums(job.picture)
    report["sum_after"] = picture_sums(out)
    out = Picture(out.pixels, job.picture.colour_space, job.picture.metadata)
    return GlareResult(out, prepared.psf, prepared.camera, report)


def refuse_words(job: GlareJob) -> None:
    """Refuse words of a job that mean nothing.

    Parameters
    ----------
    job : GlareJob
        Any.

    Raises
    ------
    refuse.Refusal
        Where its mode or its precision is unknown.
    """
    refuse.one_of("mode", job.mode, glare.MODES)
    refuse.one_of("precision", job.precision, ("single", "double"))


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


def _kernel_size(job: GlareJob, camera: Camera) -> int:
    """Return an odd side, so that the core has as much on each side."""
    if job.kernel_size is not None:
        return refuse.at_least("kernel_size", job.kernel_size, 1)
    return max(camera.resolution) | 1


def _refuse_memory(job: GlareJob, size: int) -> None:
    """Refuse a kernel and a picture that would not fit, before any work."""
    rows, columns = job.picture.pixels.shape[:2]
    needed = BYTES_PER_KERNEL_PIXEL * size**2 + BYTES_PER_PIXEL * rows * columns
    limit = picture.allowed_memory(job.memory)
    if needed > limit:
        raise refuse.Refusal(
            f"a kernel of {size} x {size} on {columns} x {rows} pixels needs about {needed / 1e9:.3g} GB of "
            f"memory, {limit / 1e9:.3g} GB are allowed; see --memory and --kernel-size."
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
