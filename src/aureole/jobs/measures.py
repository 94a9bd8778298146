"""What people in optics ask of a camera's pupil, as curves and numbers on the sensor."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import diffraction, glare
from aureole.records import Camera, Spectrum

MIDDLE_WAVELENGTH = 550e-9
# First dark ring of a circle, in units of λN.
AIRY = 1.2196698912665045
SHARES = (0.5, 0.8, 0.9)
# The circles of a curve reach until so much energy lies within, or so many Airy radii.
ENOUGH, FEWEST_AIRY, MOST_AIRY = 0.93, 4.0, 256.0
FREQUENCIES, RADII = 257, 257
TANGENTIAL, SAGITTAL = math.pi / 2, 0.0


@dataclass(frozen=True, eq=False)
class PupilMeasures:
    """Measures of a camera's pupil; the light is the job's, one wavelength of it is looked at alone.

    Parameters
    ----------
    wavelength : float
        The one, metres.
    frequencies : ndarray, shape (K,)
        Cycles per metre on the sensor, from 0 to the cut-off 1 / (λ N).
    transfer : ndarray, shape (2, K)
        MTF at the wavelength: tangential (fine structure along y) and sagittal (along x).
    transfer_in_light : ndarray, shape (2, K)
        The same in all of the light, weighted by luminance.
    transfer_limit : ndarray, shape (K,)
        That of an open circle of the same f-number without aberration, at the wavelength.
    radii : ndarray, shape (R,)
        Metres on the sensor, about the axis.
    encircled, encircled_in_light, encircled_limit : ndarray, shape (R,)
        Parts of the energy within the radii, as the transfer functions.
    report : dict
        Plain numbers with units in their names.
    """

    wavelength: float
    frequencies: NDArray[np.float64]
    transfer: NDArray[np.float64]
    transfer_in_light: NDArray[np.float64]
    transfer_limit: NDArray[np.float64]
    radii: NDArray[np.float64]
    encircled: NDArray[np.float64]
    encircled_in_light: NDArray[np.float64]
    encircled_limit: NDArray[np.float64]
    report: dict[str, Any]


def pupil_measures(camera: Camera, lamp: Spectrum) -> PupilMeasures:
    """Measure a camera's pupil.

    Parameters
    ----------
    camera : Camera
        Any.
    lamp : Spectrum
        The light; a single line is also the one wavelength, which is 550 nm otherwise.

    Returns
    -------
    PupilMeasures
        Curves and numbers.

    Raises
    ------
    Refusal
        Where the pupil's wavefront cannot be served.
    """
    single = lamp.kind == "lines" and len(lamp.wavelengths) == 1
    wavelength = float(lamp.wavelengths[0]) if single else MIDDLE_WAVELENGTH
    pupil, focal_length = glare.pupil(camera), camera.focal_length
    cutoff = 1 / (wavelength * camera.f_number)
    frequencies = np.linspace(0, cutoff, FREQUENCIES)
    directions = np.array([[TANGENTIAL], [SAGITTAL]])
    transfer = diffraction.mtf(pupil, frequencies * focal_length, wavelength, directions)
    in_light = transfer
    if not single:
        in_light = diffraction.mtf(pupil, frequencies * focal_length, lamp, directions)
    airy = AIRY * wavelength * camera.f_number
    radii, encircled_in_light = _enough(pupil, airy / focal_length, wavelength if single else lamp)
    encircled = encircled_in_light
    if not single:
        encircled = diffraction.encircled_energy(pupil, radii, wavelength)
    report = {
        "measured_at_m": wavelength,
        "strehl": diffraction.strehl(pupil, wavelength),
        "strehl_in_light": diffraction.strehl(pupil, lamp),
        "wavefront_rms_m": apertures.wavefront_rms(pupil),
        "airy_radius_m": airy,
        "cutoff_cycles_per_mm": 1e-3 * cutoff,
        "cutoff_tangential_cycles_per_mm": _cutoff(pupil, wavelength, TANGENTIAL, focal_length),
        "cutoff_sagittal_cycles_per_mm": _cutoff(pupil, wavelength, SAGITTAL, focal_length),
        **_mtf_50(frequencies, transfer),
        **_radii_of_shares(radii * focal_length, encircled_in_light),
    }
    return PupilMeasures(
        wavelength,
        frequencies,
        transfer,
        in_light,
        _limit_of_transfer(frequencies / cutoff),
        radii * focal_length,
        encircled,
        encircled_in_light,
        _limit_of_energy(radii * focal_length / (wavelength * camera.f_number)),
        report,
    )


def _enough(
    pupil: Any, airy: float, light: float | Spectrum
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return radii that hold enough of the energy, as directions, and what they hold."""
    reach = FEWEST_AIRY
    while True:
        radii = np.linspace(0, reach * airy, RADII)
        held = diffraction.encircled_energy(pupil, radii, light)
        if held[-1] >= ENOUGH or reach >= MOST_AIRY:
            return radii, held
        reach *= 2


def _cutoff(pupil: Any, wavelength: float, angle: float, focal_length: float) -> float:
    return 1e-3 * diffraction.cutoff_frequency(pupil, wavelength, angle) / focal_length


def _mtf_50(frequencies: NDArray[np.float64], transfer: NDArray[np.float64]) -> dict[str, float]:
    """Return where the contrast first falls to a half."""
    found = {}
    for name, curve in zip(("tangential", "sagittal"), transfer, strict=True):
        after = int(np.argmax(curve < 0.5))
        place = np.interp(-0.5, -curve[after - 1 : after + 1], frequencies[after - 1 : after + 1])
        found[f"mtf50_{name}_cycles_per_mm"] = 1e-3 * float(place)
    return found


def _radii_of_shares(radii: NDArray[np.float64], held: NDArray[np.float64]) -> dict[str, float | None]:
    """Return the radii within which shares of the energy lie; None where they lie beyond the curve."""
    found: dict[str, float | None] = {}
    for share in SHARES:
        after = int(np.argmax(held >= share))
        radius = None
        if held[after] >= share:
            part = (share - held[after - 1]) / (held[after] - held[after - 1])
            radius = float(radii[after - 1] + part * (radii[after] - radii[after - 1]))
        found[f"radius_of_{round(100 * share)}_percent_energy_m"] = radius
    return found


def _limit_of_transfer(s: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return 2/π (acos s − s √(1 − s²)), that of a circle."""
    s = np.clip(s, 0, 1)
    return np.asarray(2 / np.pi * (np.arccos(s) - s * np.sqrt(1 - s**2)))


def _limit_of_energy(z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return 1 − J0² − J1², that of a circle at radii in units of λN."""
    from scipy.special import j0, j1

    return np.asarray(1 - j0(np.pi * z) ** 2 - j1(np.pi * z) ** 2)
