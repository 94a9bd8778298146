"""The main job on the bundled scene: a night by the water, and what a camera makes of its lamps."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from aureole import flare, picture
from aureole.jobs.flare import FlareJob, FlareResult, run_flare
from aureole.jobs.glare import GlareJob, GlareResult, run_glare
from aureole.jobs.optics import DEFAULT_CAMERA, Opening, Optics
from aureole.presets import CameraPreset, load
from aureole.records import Picture, Stage

# A lens of the camera's focal length whose glass is bare, so that its ghosts are seen without a gain.
LENS = "zeiss_biotar_50mm"
# The lamps of the scene that are bright enough, in candela per square metre, and how many of them count.
LAMP_LUMINANCE, LAMPS = 2000.0, 3
GHOSTS = "top:10"
GLARE_DONE = 0.6


@dataclass(frozen=True)
class DemoJob:
    """The bundled scene, and the camera and the lens to see it with.

    Parameters
    ----------
    optics : Optics
        The camera, whose starbursts all lamps have.
    lens : str
        The lens, whose ghosts the brightest lamps have.
    shape : tuple of int
        (rows, columns) of the scene.
    seed : int
        Of the scene's chances.
    """

    optics: Optics = field(default_factory=Optics)
    lens: str = LENS
    shape: tuple[int, int] = (1080, 1920)
    seed: int = 1


@dataclass(frozen=True, eq=False)
class DemoResult:
    """The scene before and after.

    Parameters
    ----------
    scene : Picture
        Without glare.
    glare : GlareResult
        With it.
    ghosts : FlareResult
        The ghosts by themselves.
    picture : Picture
        The scene with its glare and its ghosts.
    """

    scene: Picture
    glare: GlareResult
    ghosts: FlareResult
    picture: Picture


def run_demo(job: DemoJob) -> Iterator[Stage]:
    """Run the demonstration.

    Parameters
    ----------
    job : DemoJob
        What to show.

    Yields
    ------
    Stage
        The last one holds a `DemoResult`.
    """
    yield Stage(0.0, "painting the scene")
    scene = picture.night_scene(job.shape, job.seed)
    glare = None
    for stage in run_glare(GlareJob(scene, job.optics)):
        glare = stage.result
        yield Stage(0.1 + (GLARE_DONE - 0.1) * stage.fraction, stage.label)
    assert isinstance(glare, GlareResult)
    ghosts = None
    for stage in run_flare(_flare_job(job, scene)):
        ghosts = stage.result
        yield Stage(GLARE_DONE + (0.99 - GLARE_DONE) * stage.fraction, stage.label)
    assert isinstance(ghosts, FlareResult)
    whole = Picture(glare.picture.pixels + ghosts.ghosts.pixels, scene.colour_space, scene.metadata)
    yield Stage(1.0, "demo", DemoResult(scene, glare, ghosts, whole))


def _flare_job(job: DemoJob, scene: Picture) -> FlareJob:
    """Let the brightest lamps shine into the lens as points, its iris set as the camera's."""
    camera: CameraPreset = load("cameras", job.optics.preset or DEFAULT_CAMERA)
    return FlareJob(
        flare.load(job.lens),
        over=scene,
        find=LAMP_LUMINANCE,
        most_lights=LAMPS,
        ghosts=GHOSTS,
        f_number=job.optics.f_number or camera.f_number,
        opening=Opening(),
        iris=job.optics.iris or camera.iris,
        points=1,
    )
