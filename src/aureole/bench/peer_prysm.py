"""prysm: a pupil to a sensor of fixed sampling, by matrix transform or chirp-z transform."""

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from aureole.bench.optics import Intensity, Optics
from aureole.bench.timing import workers

NAME, MODULE, PACKAGE = "prysm", "prysm", "prysm"
LOOP = "prysm, mdft"
# prysm keeps the matrices of every wavelength, so a second loop is faster than the first.
LOOP_KEEPS = True
MILLI, MICRO = 1e3, 1e6


def ways(optics: Optics) -> dict[str, Intensity]:
    """Return prysm's ways to the intensity on the sensor, in single precision.

    Parameters
    ----------
    optics : Optics
        Mask, lens and sensor.

    Returns
    -------
    dict
        Name to a function of the wavelength.
    """
    return {
        LOOP: lambda wavelength: _focused(optics, wavelength, "mdft"),
        "prysm, czt": lambda wavelength: _focused(optics, wavelength, "czt"),
    }


def _focused(optics: Optics, wavelength: float, method: str) -> NDArray[np.floating]:
    propagation = importlib.import_module("prysm.propagation")
    with _single_precision(), scipy.fft.set_workers(workers()):
        pupil = propagation.Wavefront(optics.mask, wavelength * MICRO, optics.pixel * MILLI)
        image = pupil.focus_fixed_sampling(
            optics.focal_length * MILLI, optics.pitch * MICRO, optics.size, method=method
        )
        power: NDArray[np.floating] = image.intensity.data
    return power


@contextmanager
def _single_precision() -> Iterator[Any]:
    """Ask prysm for float32, and put its setting back afterwards."""
    config = importlib.import_module("prysm.conf").config
    before = 32 if config.precision == np.float32 else 64
    config.precision = 32
    try:
        yield config
    finally:
        config.precision = before
