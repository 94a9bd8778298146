"""Running any job: stages as they come, or only the end."""

from collections.abc import Iterable, Iterator
from functools import singledispatch
from typing import Any

from aureole.jobs import (
    aperture,
    demo,
    eye,
    eye_glare,
    eye_glare_frames,
    flare,
    glare,
    lamp_glare,
    lights,
    near_field,
    near_sweep,
    near_texture,
    sequence,
    starburst,
    surface,
    surface_measure,
    surface_render,
)
from aureole.records import Stage


@singledispatch
def run(job: Any) -> Iterator[Stage]:
    """Run a job, telling how far it is.

    Parameters
    ----------
    job : GlareJob, StarburstJob, ApertureJob, FlareJob, LightsJob, DemoJob, SequenceJob
        What to do; a near-field's, an eye's or a surface's job, too.

    Returns
    -------
    iterator of Stage
        The last stage has fraction 1 and holds the job's result.
    """
    raise TypeError(f"{type(job).__name__} is not a job")


run.register(glare.GlareJob, glare.run_glare)
run.register(starburst.StarburstJob, starburst.run_starburst)
run.register(aperture.ApertureJob, aperture.run_aperture)
run.register(flare.FlareJob, flare.run_flare)
run.register(lamp_glare.LampGlareJob, lamp_glare.run_lamp_glare)
run.register(lights.LightsJob, lights.run_lights)
run.register(near_field.NearFieldJob, near_field.run_near_field)
run.register(near_sweep.NearSweepJob, near_sweep.run_near_sweep)
run.register(near_sweep.NearSectionJob, near_sweep.run_near_section)
run.register(near_texture.NearTextureJob, near_texture.run_near_texture)
run.register(eye.EyeJob, eye.run_eye)
run.register(eye.EyeAnimationJob, eye.run_eye_animation)
run.register(eye_glare.EyeGlareJob, eye_glare.run_eye_glare)
run.register(eye_glare_frames.EyeGlareAnimationJob, eye_glare_frames.run_eye_glare_animation)
run.register(surface.SurfaceTableJob, surface.run_surface_table)
run.register(surface_measure.SurfaceMeasureJob, surface_measure.run_surface_measure)
run.register(surface_render.SurfaceRenderJob, surface_render.run_surface_render)
run.register(surface_render.SurfaceTurnJob, surface_render.run_surface_turn)
run.register(sequence.SequenceJob, sequence.run_sequence)
run.register(demo.DemoJob, demo.run_demo)


def finish(stages: Iterable[Stage]) -> Any:
    """Run stages to the end and return the last one's result.

    Parameters
    ----------
    stages : iterable of Stage
        As `run` yields them.

    Returns
    -------
    object
        The result.
    """
    result = None
    for stage in stages:
        result = stage.result
    return result
