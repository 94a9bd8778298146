"""LightPipes: planes behind a mask, by convolution and by the spectral method."""

import importlib

import numpy as np
from numpy.typing import NDArray

from aureole.bench.optics import Irradiance, Plane

NAME, MODULE, PACKAGE = "LightPipes", "LightPipes", "LightPipes"


def near_ways(plane: Plane) -> dict[str, Irradiance]:
    """Return LightPipes' ways to the irradiance behind a mask, in its own double precision.

    Its third, Forward, takes a loop over all pixels for each place: hours at 1024².

    Parameters
    ----------
    plane : Plane
        Mask and wavelength.

    Returns
    -------
    dict
        Name to a function of the distance.
    """
    # Fresnel takes its samples to lie width / (n − 1) apart: this width puts them on the pixels.
    inner = plane.width * (plane.size - 1) / plane.size
    return {
        "LightPipes, Fresnel": lambda z: _propagated(plane, inner, "Fresnel", z),
        "LightPipes, Forvard": lambda z: _propagated(plane, plane.width, "Forvard", z),
    }


def _propagated(plane: Plane, width: float, name: str, distance: float) -> NDArray[np.floating]:
    lightpipes = importlib.import_module("LightPipes")
    field = lightpipes.Begin(width, plane.wavelength, plane.size)
    field = lightpipes.MultIntensity(field, plane.mask**2)
    field = getattr(lightpipes, name)(field, distance)
    power: NDArray[np.floating] = lightpipes.Intensity(field)
    return power
