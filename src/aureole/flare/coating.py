"""What an interface reflects: bare glass by Fresnel, thin layers by their characteristic matrices.

An interface without absorption sends back R and lets through T = 1 - R; both are computed from the
amplitudes, each on its own. Source: Born & Wolf, Principles of Optics, 7th ed., 1.5.2 and 1.6.2.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.flare.glass import Glass, index, of_numbers

# Grazing light meets an infinite admittance; this cosine stands for zero.
LEAST_COSINE = 1e-12
POLARISATIONS = ("mean", "s", "p")

Complexes = NDArray[np.complex128]


@dataclass(frozen=True)
class Layer:
    """A thin layer.

    Parameters
    ----------
    glass : Glass
        What it is made of.
    thickness : float
        Metres.
    """

    glass: Glass
    thickness: float


@dataclass(frozen=True)
class Coating:
    """Layers on a surface.

    Parameters
    ----------
    name : str
        What its file calls it.
    layers : tuple of Layer
        From the side of the lower index (air) on.
    """

    name: str
    layers: tuple[Layer, ...]


class Amplitudes(NamedTuple):
    """What a wave's electric field is multiplied by; p is the part along the surface.

    Parameters
    ----------
    r_s, r_p : ndarray of complex128
        Of the reflected wave.
    t_s, t_p : ndarray of complex128
        Of the transmitted wave.
    """

    r_s: Complexes
    r_p: Complexes
    t_s: Complexes
    t_p: Complexes


def quarter_wave(medium: Glass | float, wavelength: float) -> Layer:
    """Return the layer that is a quarter of a wave thick at normal incidence.

    Parameters
    ----------
    medium : Glass or float
        What it is made of, or its index.
    wavelength : float
        Design wavelength in air, metres.

    Returns
    -------
    Layer
        λ / (4 n) thick.

    Raises
    ------
    refuse.Refusal
        Where the wavelength is not above zero, or the index is out of 1..5.
    """
    refuse.positive("wavelength", wavelength)
    glass = medium if isinstance(medium, Glass) else of_numbers(medium)
    return Layer(glass, wavelength / (4.0 * float(index(glass, wavelength))))


def amplitudes(
    layers: Sequence[Layer], before: Glass, after: Glass, cosines: ArrayLike, wavelengths: ArrayLike
) -> Amplitudes:
    """Return the reflected and transmitted amplitudes of a stack between two media.

    Parameters
    ----------
    layers : sequence of Layer
        In the order in which the light meets them; none for a bare interface.
    before, after : Glass
        The media.
    cosines : array_like
        Of the angle to the normal in the medium before, 0..1.
    wavelengths : array_like
        Metres in air; broadcast against `cosines`.

    Returns
    -------
    Amplitudes
        Of the broadcast shape.

    Raises
    ------
    refuse.Refusal
        Where a cosine is out of 0..1.
    """
    waves = np.asarray(wavelengths, dtype=np.float64)
    cosine = _cosines(cosines)
    media = [index(glass, waves) for glass in (before, *(layer.glass for layer in layers), after)]
    # Snell keeps n sin θ; beyond the critical angle the cosine is imaginary and the wave fades.
    sine = media[0] * np.sqrt(1.0 - cosine**2)
    turns = [_turned(n, sine) for n in media]
    turns[0] = np.broadcast_to(cosine, sine.shape).astype(np.complex128)
    found = []
    for along_surface in (False, True):
        admittances = [n / c if along_surface else n * c for n, c in zip(media, turns, strict=True)]
        found.append(_stack(layers, media, turns, admittances, waves))
    (r_s, t_s), (r_p, t_p) = found
    return Amplitudes(r_s, r_p, t_s, t_p)


def reflectance(
    layers: Sequence[Layer],
    before: Glass,
    after: Glass,
    cosines: ArrayLike,
    wavelengths: ArrayLike,
    polarisation: str = "mean",
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return which parts of the power a stack reflects and transmits.

    Parameters
    ----------
    layers : sequence of Layer
        In the order in which the light meets them; none for a bare interface.
    before, after : Glass
        The media.
    cosines : array_like
        Of the angle to the normal in the medium before, 0..1.
    wavelengths : array_like
        Metres in air; broadcast against `cosines`.
    polarisation : {"mean", "s", "p"}
        "mean" is unpolarised light.

    Returns
    -------
    reflected, transmitted : ndarray of float64
        R and T of the broadcast shape; R + T = 1.

    Raises
    ------
    refuse.Refusal
        Where a cosine is out of 0..1 or the polarisation is unknown.
    """
    refuse.one_of("polarisation", polarisation, POLARISATIONS)
    found = amplitudes(layers, before, after, cosines, wavelengths)
    waves = np.asarray(wavelengths, dtype=np.float64)
    into, out = index(before, waves), index(after, waves)
    cosine = _cosines(cosines)
    turned = _turned(out, into * np.sqrt(1.0 - cosine**2))
    # Power through the surface goes with the real part of the admittance along it.
    through_s = (out * turned).real / (into * cosine)
    through_p = (out / turned).real / (into / cosine)
    s = np.abs(found.r_s) ** 2, np.abs(found.t_s) ** 2 * through_s
    p = np.abs(found.r_p) ** 2, np.abs(found.t_p) ** 2 * through_p
    if polarisation == "mean":
        return (s[0] + p[0]) / 2.0, (s[1] + p[1]) / 2.0
    return s if polarisation == "s" else p


def _cosines(cosines: ArrayLike) -> NDArray[np.float64]:
    cosine = refuse.all_finite("cosines", np.asarray(cosines, dtype=np.float64))
    if cosine.size and (cosine.min() < 0 or cosine.max() > 1):
        wrong = cosine.min() if cosine.min() < 0 else cosine.max()
        raise refuse.Refusal(f"'cosines' must be numbers from 0 to 1, got {wrong:g}.")
    return np.asarray(np.maximum(cosine, LEAST_COSINE))


def _turned(n: NDArray[np.float64], sine: NDArray[np.float64]) -> Complexes:
    """Return the cosine in a medium, negative imaginary where the wave fades behind the surface."""
    square = 1.0 - (sine / n) ** 2
    root = np.sqrt(np.maximum(np.abs(square), LEAST_COSINE**2))
    return np.asarray(np.where(square >= 0, root, -1j * root))


def _stack(
    layers: Sequence[Layer],
    media: list[NDArray[np.float64]],
    turns: list[Complexes],
    admittances: list[Complexes],
    waves: NDArray[np.float64],
) -> tuple[Complexes, Complexes]:
    """Return r and t from the product of the layers' matrices."""
    # The fields at the last interface, carried forward through each layer (Born & Wolf 1.6 (47)).
    electric, magnetic = np.ones_like(admittances[-1]), admittances[-1]
    for k in range(len(layers), 0, -1):
        phase = 2.0 * np.pi * media[k] * turns[k] * layers[k - 1].thickness / waves
        cosine, sine = np.cos(phase), np.sin(phase)
        electric, magnetic = (
            cosine * electric + 1j * sine / admittances[k] * magnetic,
            1j * sine * admittances[k] * electric + cosine * magnetic,
        )
    total = admittances[0] * electric + magnetic
    return (admittances[0] * electric - magnetic) / total, 2.0 * admittances[0] / total
