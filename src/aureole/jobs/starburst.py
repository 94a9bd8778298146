"""The starburst job: a camera's point spread function, whole or as another program's kernel."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from aureole import aperture as apertures
from aureole import glare, light, refuse
from aureole.jobs.measures import MIDDLE_WAVELENGTH, PupilMeasures, pupil_measures
from aureole.jobs.optics import Optics
from aureole.records import Camera, Picture, Stage

# An anti-aliased heptagon of 1024² pixels is right to 0.13 dB (median) up to here, in cycles per pixel.
RASTER_LIMIT = 0.125


@dataclass(frozen=True)
class StarburstJob:
    """What point spread function to make.

    Parameters
    ----------
    optics : Optics
        The camera.
    shape : tuple of int
        (rows, columns).
    pixel_pitch : float, optional
        Metres on the sensor; the preset's sensor otherwise.
    illuminant : str
        As `aureole.light.illuminant` reads it: "E", "D65", "blackbody:3200K", "line:550nm".
    colour_space : str
        Primaries of the result.
    sample : str
        "area" or "point".
    method : str
        As in `aureole.diffraction.starburst`.
    border_fade : float
        Part of the half size over which the border fades to zero.
    host : str, optional
        "unreal", "blender" or "nuke", for a kernel in that program's convention.
    measures : bool
        Whether to measure the pupil, too: transfer functions, Strehl ratio, encircled energy.
    light_size : float
        Angle in radians across a disc-shaped light; 0 is a point.
    """

    optics: Optics = field(default_factory=Optics)
    shape: tuple[int, int] = (512, 512)
    pixel_pitch: float | None = None
    illuminant: str = "E"
    colour_space: str = "rec709"
    sample: str = "area"
    method: str = "auto"
    border_fade: float = 0.25
    host: str | None = None
    measures: bool = False
    light_size: float = 0.0


@dataclass(frozen=True, eq=False)
class StarburstResult:
    """A point spread function and what is worth knowing about it.

    Parameters
    ----------
    picture : Picture
        Energy per pixel, or the host's kernel.
    camera : Camera
        The camera it is of.
    report : dict
        Plain numbers with units in their names, those of the measures among them.
    psf : Picture
        Energy per pixel, whatever the host.
    measures : PupilMeasures, optional
        Where the job asked for them.
    """

    picture: Picture
    camera: Camera
    report: dict[str, Any]
    psf: Picture
    measures: PupilMeasures | None = None


def run_starburst(job: StarburstJob) -> Iterator[Stage]:
    """Run a starburst job.

    Parameters
    ----------
    job : StarburstJob
        What to make.

    Yields
    ------
    Stage
        The last one holds a `StarburstResult`.
    """
    refuse.at_least("size", job.shape[0], 1)
    refuse.at_least("size", job.shape[1], 1)
    if job.host is not None:
        refuse.one_of("for", job.host, glare.HOSTS)
    lamp = light.illuminant(job.illuminant)
    camera = job.optics.camera(pixel_pitch=job.pixel_pitch)
    psf = None
    for stage in glare.camera_psf_stages(
        camera, job.shape, lamp, job.colour_space, job.method, job.sample, job.border_fade, job.light_size
    ):
        psf = stage.result
        yield Stage((0.8 if job.measures else 0.98) * stage.fraction, stage.label)
    assert isinstance(psf, Picture)
    picture = psf if job.host is None else glare.kernel_for(psf, job.host)
    report, measures = psf_report(camera, psf, lamp.name), None
    if job.measures:
        yield Stage(0.8, "measuring the pupil")
        measures = pupil_measures(camera, lamp)
        report |= measures.report
    yield Stage(1.0, "starburst", StarburstResult(picture, camera, report, psf, measures))


def psf_report(camera: Camera, psf: Picture, illuminant: str) -> dict[str, Any]:
    """Return the plain numbers of a point spread function.

    Parameters
    ----------
    camera : Camera
        Whose it is.
    psf : Picture
        As `aureole.glare.camera_psf` returns it.
    illuminant : str
        The light's name.

    Returns
    -------
    dict
        Lengths in metres, energies as fractions of the whole.
    """
    rows, columns = psf.pixels.shape[:2]
    report = {
        "focal_length_m": camera.focal_length,
        "f_number": camera.f_number,
        "aperture": camera.iris.name,
        "aperture_diameter_m": camera.focal_length / camera.f_number,
        "pixel_pitch_m": [camera.pixel_pitch[1], camera.pixel_pitch[0]],
        "kernel_size": [columns, rows],
        "illuminant": illuminant,
        "energy_inside": psf.metadata["energy_inside"],
        "energy_before_fade": psf.metadata["energy_before_fade"],
        "energy_in_core_pixel": float(psf.pixels[rows // 2, columns // 2, :3].mean()),
    }
    if camera.iris.wavefront is not None:
        report["wavefront_rms_m"] = apertures.wavefront_rms(camera.iris)
    if camera.iris.mask is not None:
        report["raster_true_to_deg"] = math.degrees(_raster_angle(camera))
    return report


def _raster_angle(camera: Camera) -> float:
    """Return the angle to which a raster's far field stands for the shape that it was painted from.

    Beyond RASTER_LIMIT cycles per pixel the stair steps of its edges show in the rays.
    """
    assert camera.iris.mask is not None
    pixel = camera.focal_length / camera.f_number / len(camera.iris.mask)
    return math.asin(min(1.0, RASTER_LIMIT * MIDDLE_WAVELENGTH / pixel))
