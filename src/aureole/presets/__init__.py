"""Named cameras and irises, as data: TOML files, each with its source.

In: a kind ("cameras", "irises") and a name. Out: a validated record of numbers with units in their
names. The files lie beside this page, one a preset; a file of the user's own is read the same way.

models   what a file of each kind may hold
"""

from aureole.presets.models import KINDS, CameraPreset, IrisPreset, load, names

__all__ = ["KINDS", "CameraPreset", "IrisPreset", "load", "names"]
