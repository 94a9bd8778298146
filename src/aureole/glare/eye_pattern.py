"""From the wave behind an eye's pupil to the pixels of its pattern: wavelengths, and the veil beyond.

Where the raster's frequencies end, the pattern fades into the glare function of CIE 135. The fading follows
the frequency, so that red light is carried by wave optics farther than blue, and the veil fills what each
wavelength lacks.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from aureole import light
from aureole.glare.eye import Eye, EyeState
from aureole.glare.eye_pixels import RIGHT_ANGLE, Frame, add_wave, radial_energies
from aureole.glare.eye_wave import View, Wave, fade_share, wave_of
from aureole.glare.veil import cie_135, hemisphere_energy
from aureole.records import Aperture, Spectrum

WAVELENGTHS = 32
SHORTEST, LONGEST, REFERENCE_WAVELENGTH = 380e-9, 770e-9, 575e-9
# Wavelengths lie so densely that streaks step by at most so many pixels, but no more than MOST.
STEP, MOST_WAVELENGTHS = 1.5, 128
# The raster is so much wider than the pupil; its pixels are between these sizes, in metres, by default.
MARGIN, FINEST_PIXEL, COARSEST_PIXEL = 1.1, 1.95e-6, 3.9e-6
BLOCK, SMALLEST_SIZE, LARGEST_SIZE = 64, 256, 4096
# Fewer pixels than this on the pupil make no pattern worth the name.
FEWEST_PIXELS = 64
# With a wavefront so many groups of wavelengths are transformed, of a raster of at most so many pixels.
GROUPS, LARGEST_WITH_WAVEFRONT = 12, 1536
VEIL_ANGLES = 600
# Where the energy that is missing to the whole goes: about the axis, to all parts alike, or nowhere.
RESTS = ("core", "all", "none")


@dataclass(frozen=True, eq=False)
class Lamp:
    """The wavelengths of a light.

    Parameters
    ----------
    wavelengths : ndarray of float64, shape (K,)
        Metres.
    weights : ndarray of float64, shape (K, 3)
        By channel; their sum over K is 1 in each.
    """

    wavelengths: NDArray[np.float64]
    weights: NDArray[np.float64]


@dataclass(frozen=True)
class Veil:
    """CIE 135's glare function, times a strength.

    Parameters
    ----------
    age : float
        Years.
    pigment : float
        p, 0 to 1.2.
    strength : float
        Its integral over the hemisphere.
    """

    age: float
    pigment: float
    strength: float = 1.0

    @classmethod
    def of(cls, eye: Eye, share: float = 1.0) -> "Veil":
        """Return an eye's veil relative to a share of the light."""
        return cls(eye.age, eye.pigment, eye.particles / share)

    def density(self, angle: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return 1 / steradian, normalised over the hemisphere before the strength counts."""

        def glare(places: NDArray[np.float64]) -> NDArray[np.float64]:
            return cie_135(places, self.age, self.pigment)

        return self.strength * glare(angle) / hemisphere_energy(glare)


def raster_size(state: EyeState, frame: Frame) -> int:
    """Return how many pixels a side the amplitude on the pupil should have.

    Parameters
    ----------
    state : EyeState
        The eye.
    frame : Frame
        What is looked at.

    Returns
    -------
    int
        Even, with small prime factors, 256 to 4096.
    """
    frequency = math.sin(frame.farthest) / SHORTEST
    pixel = min(max(FINEST_PIXEL, 0.25 / frequency), COARSEST_PIXEL)
    blocks = math.ceil(MARGIN * state.pupil_diameter / pixel / BLOCK)
    size = BLOCK * int(fft.next_fast_len(blocks, real=True))
    largest = LARGEST_WITH_WAVEFRONT if state.eye.defocus or state.eye.zernike else LARGEST_SIZE
    return min(max(size, SMALLEST_SIZE), largest)


def lamp_of(spectrum: Spectrum | None, colour_space: str, frame: Frame, wavelengths: int) -> Lamp:
    """Choose the wavelengths of a light and weigh them in RGB.

    Parameters
    ----------
    spectrum : Spectrum or None
        Equal energy unless given.
    colour_space : str
        Of the weights; the light itself is white in it.
    frame : Frame
        Streaks step by few of its pixels from one wavelength to the next.
    wavelengths : int
        At least so many.

    Returns
    -------
    Lamp
        Each channel's weights sum to 1.
    """
    lamp = light.illuminant("E") if spectrum is None else spectrum
    radius = min(frame.farthest, math.radians(6)) / frame.step
    wanted = math.ceil(radius * math.log(LONGEST / SHORTEST) / STEP)
    count = max(wavelengths, min(wanted, MOST_WAVELENGTHS))
    places, weights = light.quadrature(lamp, count, SHORTEST, LONGEST)
    if lamp.kind == "lines" and len(lamp.wavelengths) == 1:
        return Lamp(places, np.ones((1, 3)))
    weights = weights @ light.matrix("xyz", colour_space, light.white(lamp)).T
    return Lamp(places, weights)


def pattern_of(
    opening: Aperture, energy: float, frame: Frame, lamp: Lamp, veil: Veil | None, rest: str, fades: bool
) -> NDArray[np.float32]:
    """Return the energy that an opening sends into each pixel, with the veil beyond the wave's reach.

    Parameters
    ----------
    opening : Aperture
        A raster. With a wavefront, groups of wavelengths are transformed by themselves.
    energy : float
        What it lets through, square metres.
    frame : Frame
        The pixels.
    lamp : Lamp
        The light.
    veil : Veil or None
        What follows where the wave fades; None for the wave alone.
    rest : str
        One of `RESTS`: where each wavelength's energy is made 1 over the hemisphere. With a wavefront there
        is no core, and "core" is "all".
    fades : bool
        Whether the wave fades before the raster's last frequency.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Energy of each pixel.

    Raises
    ------
    refuse.Refusal
        Where the raster cannot serve.
    """
    view = _view(frame, fades)
    if opening.wavefront is None:
        return _developed(wave_of(opening, energy, view), frame, lamp, veil, rest)
    pixels = np.zeros((*frame.shape, 3), dtype=np.float32)
    for part, wavelength in _groups(lamp):
        wave = wave_of(opening, energy, view, wavelength)
        pixels += _developed(wave, frame, part, veil, "all" if rest == "core" else rest)
    return pixels


def _groups(lamp: Lamp) -> Iterator[tuple[Lamp, float]]:
    """Divide a light into few groups of neighbouring wavelengths, and name the middle of each."""
    count = min(len(lamp.wavelengths), GROUPS)
    for chosen in np.array_split(np.arange(len(lamp.wavelengths)), count):
        weight = np.abs(lamp.weights[chosen]).sum(axis=1)
        middle = float(np.average(lamp.wavelengths[chosen], weights=weight))
        yield Lamp(lamp.wavelengths[chosen], lamp.weights[chosen]), middle


def _developed(wave: Wave, frame: Frame, lamp: Lamp, veil: Veil | None, rest: str) -> NDArray[np.float32]:
    """Integrate a wave over pixels and wavelengths, and add the veil."""
    pixels = np.zeros((*frame.shape, 3), dtype=np.float32)
    ones = np.ones(len(lamp.wavelengths))
    angles, beyond, energies = _beyond(wave, lamp, veil)
    core_gains, scale = ones, ones
    if rest == "core":
        missing = 1 - wave.energy - energies
        core_gains = np.maximum(1 + missing / wave.core_energy, 0.0)
        scale = 1 / (wave.energy + energies + (core_gains - 1) * wave.core_energy)
    elif rest == "all":
        scale = 1 / (wave.energy + energies)
    weights = lamp.weights * scale[:, None]
    add_wave(wave, frame, lamp.wavelengths, weights, core_gains, pixels)
    if veil is not None:
        pixels += radial_energies(frame, angles, beyond @ weights)
    return pixels


def _view(frame: Frame, fades: bool) -> View:
    """Return which frequencies a frame's pixels look at, at all visible wavelengths."""
    return View(math.sin(frame.farthest) / SHORTEST, frame.step / REFERENCE_WAVELENGTH, fades)


def _beyond(
    wave: Wave, lamp: Lamp, veil: Veil | None
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return angles (N,), the veil's density (N, K) where the wave fades, and its energies (K,)."""
    start = math.asin(min(1.0, wave.fade[0] * float(lamp.wavelengths.min())))
    angles = np.geomspace(0.99 * start, RIGHT_ANGLE, VEIL_ANGLES)
    if veil is None:
        return angles, np.zeros((VEIL_ANGLES, len(lamp.wavelengths))), np.zeros(len(lamp.wavelengths))
    frequencies = np.sin(angles)[:, None] / lamp.wavelengths
    beyond = veil.density(angles)[:, None] * (1 - fade_share(frequencies, wave.fade))
    rings = 2 * np.pi * (np.sin(angles) * angles)[:, None] * beyond
    return angles, beyond, np.trapezoid(rings, np.log(angles), axis=0)
