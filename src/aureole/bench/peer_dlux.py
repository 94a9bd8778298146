"""dLux: its matrix transform, compiled by JAX."""

import importlib

import numpy as np
from numpy.typing import NDArray

from aureole.bench.optics import Intensity, Optics

NAME, MODULE, PACKAGE = "dLux", "dLux", "dLux"
LOOP = "dLux, MFT compiled"
LOOP_KEEPS = False


def ways(optics: Optics) -> dict[str, Intensity]:
    """Return dLux's way to the intensity on the sensor; it computes in single precision.

    Parameters
    ----------
    optics : Optics
        Mask, lens and sensor.

    Returns
    -------
    dict
        Name to a function of the wavelength.
    """
    jax = importlib.import_module("jax")
    utils = importlib.import_module("dLux.utils")
    size = optics.size
    mask = jax.numpy.asarray(optics.mask, dtype=jax.numpy.complex64)
    # Its planes are centred between samples at even sizes; ours on a sample.
    shift = jax.numpy.full(2, 0.5 * (1 - size % 2))

    def transform(phasor: object, wavelength: object) -> object:
        field = utils.MFT(
            phasor, wavelength, optics.pixel, size, optics.pitch, optics.focal_length, shift=shift
        )
        return jax.numpy.abs(field) ** 2

    compiled = jax.jit(transform)

    def focused(wavelength: float) -> NDArray[np.floating]:
        return np.asarray(compiled(mask, wavelength))

    return {LOOP: focused}
