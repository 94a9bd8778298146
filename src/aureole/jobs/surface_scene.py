"""What suits a surface that is drawn where nothing else is asked for: object, distance, metals, highlight."""

import json
import math

import numpy as np

from aureole import presets, refuse, surface
from aureole.jobs.surface_sources import is_table

# Room around an object that fills the picture.
MARGIN = 1.12
# Refractive index and absorption near 617, 549 and 451 nm. Aluminium: Rakic 1995 (Applied Optics 34, 4755),
# between its lines; silver and gold: Johnson and Christy 1972 (Physical Review B 6, 4370).
METALS = {
    "aluminium": ((1.351, 1.011, 0.636), (7.37, 6.62, 5.47)),
    "silver": ((0.06, 0.06, 0.04), (4.152, 3.586, 2.657)),
    "gold": ((0.21, 0.43, 1.38), (3.272, 2.455, 1.914)),
}


def usual_shape(text: str) -> tuple[str, tuple[float, float]]:
    """Return the object on which a surface is usually found.

    Parameters
    ----------
    text : str
        A table's file, a grating's preset, or a preset's file.

    Returns
    -------
    shape : str
        "disc" or "plane".
    lengths : tuple of float
        Diameter and hole, or width and height, metres.
    """
    name = _grating_in(text) if is_table(text) else text
    if name not in presets.names("gratings") and not name.endswith(".toml"):
        return "plane", (0.05, 0.05)
    preset = presets.load("gratings", name)
    width, height = preset.object_mm
    return preset.shape, (1e-3 * width, 1e-3 * height)


def fitting_distance(
    body: surface.Plane | surface.Disc | surface.Cylinder | surface.Mesh, angle: float, shape: tuple[int, int]
) -> float:
    """Return how far before an object's middle a camera sees all of it.

    Parameters
    ----------
    body : Plane, Disc, Cylinder or Mesh
        The object, facing the camera.
    angle : float
        Of the picture's height, radians.
    shape : tuple of int
        (rows, columns) of the picture.

    Returns
    -------
    float
        Metres.

    Raises
    ------
    refuse.Refusal
        Where a mesh has no extent.
    """
    aspect = shape[1] / shape[0]
    before = 0.0
    match body:
        case surface.Disc():
            wide = high = 0.5 * body.diameter
        case surface.Plane():
            wide, high = 0.5 * body.width, 0.5 * body.height
        case surface.Cylinder():
            wide, high, before = body.radius, 0.5 * body.height, body.radius
        case _:
            wide, high, before = (float(reach) for reach in np.abs(body.vertices).max(axis=0))
    return before + MARGIN * refuse.positive("object-size", max(high, wide / aspect)) / math.tan(0.5 * angle)


def _grating_in(text: str) -> str:
    """Return the name of the grating that a table was made of, as its sidecar says, or nothing."""
    try:
        said = json.loads(surface.sidecar_of(text).read_text(encoding="utf-8"))
        return str(said["metadata"]["grating"])
    except (OSError, ValueError, KeyError, TypeError):
        return ""
