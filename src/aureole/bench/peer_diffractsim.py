"""diffractsim: the focal plane of a lens over a chosen interval, by Bluestein's method."""

import importlib

import numpy as np
from numpy.typing import NDArray

from aureole.bench.optics import Intensity, Optics

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


def _focused(optics: Optics, wavelength: float) -> NDArray[np.floating]:
    diffractsim = importlib.import_module("diffractsim")
    size = optics.size
    field = diffractsim.MonochromaticField(
        wavelength=wavelength,
        extent_x=optics.width,
        extent_y=optics.width,
        Nx=size,
        Ny=size,
        intensity=1.0,
    )
    field.add(diffractsim.ApertureFromFunction(lambda xx, yy, wave: optics.mask))
    # The interval's ends are the first and the last sample.
    interval = [-(size // 2) * optics.pitch, (size - 1 - size // 2) * optics.pitch]
    field.propagate_to_lens_focal_plane(optics.focal_length, interval, interval)
    power: NDArray[np.floating] = np.asarray(field.get_intensity())
    return power
