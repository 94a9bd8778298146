"""optiland: real rays through a lens, and by ghosts' ways as its named sequences."""

import functools
import importlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole.bench.lens_rays import LensRays, Positions
from aureole.flare import glass
from aureole.flare.ghost_paths import steps

NAME, MODULE, PACKAGE = "optiland", "optiland", "optiland"
MM, MICROMETRES = 1e3, 1e6


def ray_ways(problem: LensRays) -> dict[str, Positions]:
    """Return optiland's way, in double precision with NumPy; its surfaces are made once.

    Parameters
    ----------
    problem : LensRays
        Lens, way and rays.

    Returns
    -------
    dict
        Name to a function of the wavelength.
    """
    surfaces = functools.cache(lambda wavelength: _surfaces(problem, wavelength))
    return {NAME: lambda wavelength: _traced(problem, wavelength, surfaces(wavelength))}


def _traced(problem: LensRays, wavelength: float, surfaces: Any) -> NDArray[np.float64]:
    real_rays = importlib.import_module("optiland.rays").RealRays
    count = len(problem.points)
    heading = np.tile(problem.heading[:, None], (1, count))
    waves = np.full(count, MICROMETRES * wavelength)
    found = real_rays(*(MM * problem.origins.T), *heading, np.ones(count), waves)
    surfaces.trace(found)
    return np.column_stack([found.x, found.y]) / MM


def _surfaces(problem: LensRays, wavelength: float) -> Any:
    """Return the surfaces in the order in which light meets them."""
    ideal = importlib.import_module("optiland.materials").IdealMaterial
    optic = importlib.import_module("optiland.optic").Optic()
    # Neighbours in a sequence must share one object for the medium between them.
    medium = functools.cache(ideal)
    optic.surfaces.add(index=0, thickness=np.inf, material=medium(1.0))
    for k, surface in enumerate(problem.lens.surfaces):
        optic.surfaces.add(
            index=k + 1,
            radius=MM / surface.curvature if surface.curvature else np.inf,
            thickness=MM * surface.thickness,
            material=medium(float(glass.index(surface.glass, wavelength))),
            is_stop=surface.stop,
        )
    last = len(problem.lens.surfaces) + 1
    optic.surfaces.add(index=last, material=medium(1.0))
    if not problem.reflections:
        return optic.surfaces
    way = [(k + 1, "reflect") if mirror else k + 1 for k, mirror in steps(problem.lens, problem.reflections)]
    return optic.add_sequence("ghost", [0, *way, last]).surfaces
