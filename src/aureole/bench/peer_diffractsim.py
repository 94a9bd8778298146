"""diffractsim: the focal plane of a lens over a chosen interval, and planes behind a mask."""

import importlib
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole.bench.optics import Intensity, Irradiance, Optics, Plane

NAME, MODULE, PACKAGE = "diffractsim", "diffractsim", "diffractsim"
LOOP = "diffractsim, Bluestein"
LOOP_KEEPS = False


def ways(optics: Optics) -> dict[str, Intensity]:
    """Return diffractsim's way to the intensity on the sensor; it computes in double precision.

    Parameters
    ----------
    optics : Optics
        Mask, lens and sensor.

    Returns
    -------
    dict
        Name to a function of the wavelength.
    """
    return {LOOP: lambda wavelength: _focused(optics, wavelength)}


def near_ways(plane: Plane) -> dict[str, Irradiance]:
    """Return diffractsim's ways to the irradiance behind a mask; they compute in double precision.

    Parameters
    ----------
    plane : Plane
        Mask and wavelength.

    Returns
    -------
    dict
        Name to a function of the distance.
    """
    axis = plane.grid.axes()[0] - plane.grid.centre[0]
    ends = [axis[0], axis[-1]]
    return {
        "diffractsim, angular spectrum": lambda z: _propagated(plane, lambda field: field.propagate(z)),
        "diffractsim, two steps": lambda z: _propagated(plane, lambda field: field.scale_propagate(z, 1.0)),
        "diffractsim, Bluestein": lambda z: _propagated(
            plane, lambda field: field.zoom_propagate(z, ends, ends)
        ),
    }


def _propagated(plane: Plane, propagate: Callable[[Any], None]) -> NDArray[np.floating]:
    field = _behind(plane.mask, plane.width, plane.wavelength)
    propagate(field)
    power: NDArray[np.floating] = np.asarray(field.get_intensity())
    return power


def _focused(optics: Optics, wavelength: float) -> NDArray[np.floating]:
    size = optics.size
    field = _behind(optics.mask, optics.width, wavelength)
    # The interval's ends are the first and the last sample.
    interval = [-(size // 2) * optics.pitch, (size - 1 - size // 2) * optics.pitch]
    field.propagate_to_lens_focal_plane(optics.focal_length, interval, interval)
    power: NDArray[np.floating] = np.asarray(field.get_intensity())
    return power


def _behind(mask: NDArray[np.float32], width: float, wavelength: float) -> Any:
    """Return a plane wave right behind a mask."""
    diffractsim = importlib.import_module("diffractsim")
    field = diffractsim.MonochromaticField(
        wavelength=wavelength,
        extent_x=width,
        extent_y=width,
        Nx=len(mask),
        Ny=len(mask),
        intensity=1.0,
    )
    field.add(diffractsim.ApertureFromFunction(lambda xx, yy, wave: mask))
    return field
