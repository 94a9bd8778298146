"""HCIPy: its Fraunhofer propagator, which plans the transform, and its prepared matrix transform."""

import importlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole.bench.optics import Intensity, Optics

NAME, MODULE, PACKAGE = "HCIPy", "hcipy", "hcipy"
LOOP = "HCIPy, Fraunhofer"
# The propagator keeps the plans of eleven wavelengths only, so a second loop makes them all again.
LOOP_KEEPS = False


def ways(optics: Optics) -> dict[str, Intensity]:
    """Return HCIPy's ways to the intensity on the sensor, in single precision.

    Parameters
    ----------
    optics : Optics
        Mask, lens and sensor.

    Returns
    -------
    dict
        Name to a function of the wavelength.
    """
    hcipy = importlib.import_module("hcipy")
    size = optics.size
    pupil = hcipy.make_pupil_grid(size, optics.width)
    step = np.array([optics.pitch, optics.pitch])
    sensor = hcipy.CartesianGrid(hcipy.RegularCoords(step, [size, size], -(size // 2) * step))
    propagator = hcipy.FraunhoferPropagator(pupil, sensor, optics.focal_length)
    mask = hcipy.Field(optics.mask.ravel(), pupil)

    def fraunhofer(wavelength: float) -> NDArray[np.floating]:
        power: NDArray[np.floating] = propagator.forward(hcipy.Wavefront(mask, wavelength)).intensity.shaped
        return power

    prepared: dict[float, Any] = {}

    def matrices(wavelength: float) -> NDArray[np.floating]:
        if wavelength not in prepared:
            scaled = sensor.scaled(2 * np.pi / (optics.focal_length * wavelength))
            prepared[wavelength] = hcipy.MatrixFourierTransform(
                pupil, scaled, precompute_matrices=True, allocate_intermediate=True
            )
        field = prepared[wavelength].forward(mask.astype(np.complex64)).shaped
        power: NDArray[np.floating] = (field.real**2 + field.imag**2) / wavelength**2
        return power

    return {LOOP: fraunhofer, "HCIPy, matrices": matrices}
