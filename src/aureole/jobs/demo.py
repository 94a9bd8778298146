"""The main job on the bundled scene: a night by the water, and what a camera makes of its lamps."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from aureole import picture
from aureole.jobs.glare import GlareJob, GlareResult, run_glare
from aureole.jobs.optics import Optics
from aureole.records import Picture, Stage


@dataclass(frozen=True)
class DemoJob:
    """The bundled scene and the camera to see it with.

    Parameters
    ----------
    optics : Optics
        The camera.
    shape : tuple of int
        (rows, columns) of the scene.
    seed : int
        Of the scene's chances.
    """

    optics: Optics = field(default_factory=Optics)
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
    """

    scene: Picture
    glare: GlareResult


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
    result = None
    for stage in run_glare(GlareJob(scene, job.optics)):
        result = stage.result
        yield Stage(0.2 + 0.8 * stage.fraction * 0.99, stage.label)
    assert isinstance(result, GlareResult)
    yield Stage(1.0, "demo", DemoResult(scene, result))
