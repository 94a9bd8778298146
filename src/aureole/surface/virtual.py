"""Photographs that a camera would take of a surface whose diffraction is known, for tests and demonstrations.

The light passes a filter, the surface diffracts each wavelength by its own pattern, the lens blurs, the
sensor collects electrons with shot and read noise, and a converter counts them above its black level.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.aperture import uniform
from aureole.light import spectrum
from aureole.records import Spectrum
from aureole.surface.geometry import Geometry

Values = NDArray[np.float64]
Diffraction = Callable[[Values, Values, float], Values]


@dataclass(frozen=True)
class VirtualCamera:
    """A sensor and what it adds.

    Parameters
    ----------
    bits : int
        Of the converter.
    black : float
        Counts without light.
    gain : float
        Electrons a count.
    read_noise : float
        Electrons, standard deviation; 0 also turns shot noise off.
    blur : float
        Standard deviation in pixels of the lens's Gaussian point spread function.
    """

    bits: int = 14
    black: float = 512.0
    gain: float = 4.0
    read_noise: float = 3.0
    blur: float = 0.0

    @property
    def saturation(self) -> float:
        """Counts at which it clips."""
        return float(2**self.bits - 1)


def lcd_screen(
    pitch: float = 74.27e-6,
    width: float = 20e-6,
    count: int = 9,
    reference: float = 530e-9,
    power: float = 2.0,
) -> Diffraction:
    """Make the diffraction of a screen's pixels: crossed multislits (surface paper Eq. 16).

    Parameters
    ----------
    pitch, width : float
        Metres between slits, and of one slit.
    count : int
        Slits that are lit along each axis.
    reference : float
        Metres: the wavelength at which the zero order is 1.
    power : float
        The pattern's factor is (reference / λ)^power; 2 is the amplitude model, 4 the phase model.

    Returns
    -------
    callable
        S(h_t, h_b, wavelength), of the shape to which h_t and h_b broadcast.
    """

    def slits(h: Values, wavelength: float) -> Values:
        # N sin x has zeros where the ratio's limit is 1.
        phase = np.pi * pitch * h / wavelength
        below = count * np.sin(phase)
        ratio = np.divide(np.sin(count * phase), below, out=np.ones_like(phase), where=np.abs(below) > 1e-9)
        return np.asarray((np.sinc(width * h / wavelength) * ratio) ** 2)

    def diffraction(h_t: Values, h_b: Values, wavelength: float) -> Values:
        both = slits(h_t, wavelength) * slits(h_b, wavelength)
        return np.asarray(both * (reference / wavelength) ** power)

    return diffraction


def gaussian_filter_spectrum(middle: float, width: float, samples: int = 25) -> Spectrum:
    """Make the light that passes a filter of Gaussian transmittance.

    Parameters
    ----------
    middle, width : float
        Metres: the wavelength of the largest transmittance, and the full width at its half.
    samples : int
        Wavelengths, over three standard deviations to either side.

    Returns
    -------
    Spectrum
        Of kind "lines", whose powers sum to 1.
    """
    deviation = refuse.positive("width", width) / 2.3548200450309493
    wavelengths = np.linspace(middle - 3.0 * deviation, middle + 3.0 * deviation, samples)
    values = np.exp(-0.5 * ((wavelengths - middle) / deviation) ** 2)
    return spectrum(wavelengths, values / values.sum(), "lines", f"filter at {middle * 1e9:g} nm")


def radiance(
    diffraction: Diffraction,
    light: Spectrum,
    geometry: Geometry,
    shape: tuple[int, int],
    centre: tuple[float, float],
) -> Values:
    """Compute what a perfect camera would see.

    Parameters
    ----------
    diffraction : callable
        S(h_t, h_b, wavelength).
    light : Spectrum
        Of kind "lines": what reaches the sensor's counts, filter and sensor included.
    geometry : Geometry
        Where camera and lamp stand.
    shape : tuple of int
        (rows, columns).
    centre : tuple of float
        The zero order's (row, column).

    Returns
    -------
    ndarray of float64, shape (rows, columns)
        Σ power S(h, λ) times the relative irradiance, point samples at pixels' centres.
    """
    rows, columns = np.arange(shape[0], dtype=float)[:, None], np.arange(shape[1], dtype=float)[None, :]
    h_t, h_b, irradiance = geometry.h_of(rows, columns, centre, shape)
    total = np.zeros(shape)
    for wavelength, power in zip(light.wavelengths, light.values, strict=True):
        total += power * diffraction(h_t, h_b, float(wavelength))
    return total * irradiance


def photograph(
    scene: Values, exposures: Sequence[float], camera: VirtualCamera | None = None, seed: int = 0
) -> list[Values]:
    """Take a bracket of photographs.

    Parameters
    ----------
    scene : ndarray of float64, shape (rows, columns)
        Radiance; at exposure 1 the value 1 fills the converter's range.
    exposures : sequence of float
        Of each photograph.
    camera : VirtualCamera or None
        The sensor; None is the default one.
    seed : int
        Of the noise, which is Gaussian with the variance of electrons that arrive at random.

    Returns
    -------
    list of ndarray of float64, shape (rows, columns)
        Whole counts, black level included, clipped.
    """
    from scipy.ndimage import gaussian_filter
    from scipy.special import ndtri

    camera = camera or VirtualCamera()
    seen = gaussian_filter(scene, camera.blur) if camera.blur else scene
    full = camera.gain * (camera.saturation - camera.black)
    photos = []
    for k, exposure in enumerate(exposures):
        electrons = full * refuse.positive("exposure", exposure) * seen
        if camera.read_noise:
            chances = uniform((seed, k), electrons.size).reshape(electrons.shape)
            noise = ndtri(np.clip(chances, 1e-12, 1.0 - 1e-12))
            electrons = electrons + noise * np.sqrt(np.maximum(electrons, 0.0) + camera.read_noise**2)
        photos.append(np.clip(np.round(electrons / camera.gain + camera.black), 0.0, camera.saturation))
    return photos
