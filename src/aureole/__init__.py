"""Aureole: the light that a camera or an eye adds to a picture, from physics.

Rooms (imports go one way, from the bottom of this list to the top):

records       the records that flow between rooms
units         lengths and angles as people write them
refuse        one voice for refusals
light         wavelength to colour
aperture      what blocks the light
picture       pictures in and out, convolution, display
presets       named irises, cameras, lenses and glasses, as data
diffraction   how a blocked wave spreads
glare         point spread functions and compositing
flare         lenses and their ghosts
surface       diffractive surfaces, from a pattern or a grating to a table
jobs          what the command line and other faces call
bench         the papers' tables and the peers, measured on this machine
cli           the command `aureole`
"""

import ctypes
import importlib
import os
from typing import TYPE_CHECKING, Any

# Idle OpenMP threads that spin starve the FFT's own threads, so they are asked to sleep.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
os.environ.setdefault("GOMP_SPINCOUNT", "0")
from aureole.records import (
    Aperture,
    Camera,
    Field,
    Grid,
    Light,
    Outline,
    Pattern,
    Picture,
    Spectrum,
    Stage,
)
from aureole.refuse import Refusal

if TYPE_CHECKING:
    from aureole import aperture, diffraction, flare, glare, jobs, light, picture, presets, surface

__version__ = "0.1.0"

_ROOMS = ("aperture", "diffraction", "flare", "glare", "jobs", "light", "picture", "presets", "surface")

__all__ = [
    "Aperture",
    "Camera",
    "Field",
    "Grid",
    "Light",
    "Outline",
    "Pattern",
    "Picture",
    "Refusal",
    "Spectrum",
    "Stage",
    "aperture",
    "diffraction",
    "flare",
    "glare",
    "jobs",
    "light",
    "picture",
    "presets",
    "surface",
]


# The GNU C library's words for what it gives back to the system, and how much it keeps for the next arrays.
_TRIM, _MAP, _KEPT, _MAPPED = -1, -3, 1 << 28, 1 << 25


def _keep_freed_memory() -> None:
    """Keep up to 256 MB of what is freed: new pages for every picture take as long as its transform."""
    if any(name.startswith("MALLOC_") for name in os.environ):
        return
    try:
        set_option = ctypes.CDLL(None).mallopt
    except (OSError, TypeError, AttributeError):
        return
    set_option(_TRIM, _KEPT)
    set_option(_MAP, _MAPPED)


_keep_freed_memory()


def __getattr__(name: str) -> Any:
    """Import a room when it is first asked for, so that `import aureole` stays quick."""
    if name in _ROOMS:
        return importlib.import_module(f"aureole.{name}")
    raise AttributeError(f"module 'aureole' has no attribute '{name}'")
