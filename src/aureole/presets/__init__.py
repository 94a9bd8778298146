"""Named cameras, irises, eyes, lenses, glasses and whole jobs, as data: TOML files, each with its source.

In: a kind ("cameras", "irises", "eyes", "gratings", "jobs", "lenses", "glasses", "scenes") and a name. Out: a
validated record of numbers with units in their names; of a job, flags as they are typed. The files lie
beside this page, one a preset; a file of the user's own is read the same way.

models         what a file of a camera or an iris may hold; how a preset is found and checked
eye_model      what a file of an eye may hold
grating_model  what a file of a grating may hold
job_model      what a file of a whole job may hold
lens_model     what a file of a lens or a catalogue of glasses may hold
scene_model    what a file of a scene of lamps and occluders may hold
words          text as TOML writes it
"""

from aureole.presets.eye_model import EyePreset
from aureole.presets.grating_model import GratingPreset
from aureole.presets.job_model import JobPreset
from aureole.presets.lens_model import (
    SHARPEST_MM,
    GlassCatalogue,
    GlassLine,
    LayerPreset,
    LensPreset,
    StatePreset,
    SurfacePreset,
)
from aureole.presets.models import KINDS, CameraPreset, IrisPreset, check, load, names, path
from aureole.presets.scene_model import SceneCamera, SceneLamp, SceneOccluder, ScenePreset
from aureole.presets.words import toml_text

__all__ = [
    "KINDS",
    "SHARPEST_MM",
    "CameraPreset",
    "EyePreset",
    "GlassCatalogue",
    "GlassLine",
    "GratingPreset",
    "IrisPreset",
    "JobPreset",
    "LayerPreset",
    "LensPreset",
    "SceneCamera",
    "SceneLamp",
    "SceneOccluder",
    "ScenePreset",
    "StatePreset",
    "SurfacePreset",
    "check",
    "load",
    "names",
    "path",
    "toml_text",
]
