"""Particles of the eye: as many of each size as scatter what the CIE's glare function says.

A particle is a transparent disc in which the wave is half a wave late. Light that meets it turns its sign
and is neither absorbed nor coloured, and discs of n per unit of area at random places scatter the density

    4 n (π r²)² (2 J1(v) / v)² / λ²,   v = 2π r sin θ / λ,

per steradian, each its Airy disc. Many radii are weighed so that their sum, with the mean of the pupil's
own Airy pattern, is CIE 135's function for an age and a pigment. Where discs overlap, c being the part of
the pupil that they cover, 4 c (1 − c) of the light is scattered, for which the densities are corrected.
(Arias, Ginis and Artal 2018 fit a random phase all over the pupil to the same function instead.)
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.glare.veil import cie_135, hemisphere_energy

LAYERS = ("cornea", "lens", "vitreous")
SMALLEST, LARGEST, SIZES = 1e-6, 100e-6, 60
NEAREST, FARTHEST, ANGLES = math.radians(0.1), math.radians(12), 160
# Wavelengths over which a disc's rings are averaged, and the pupil whose Airy pattern is allowed for.
SHORTEST, LONGEST, WAVELENGTHS = 450e-9, 650e-9, 41
REFERENCE_WAVELENGTH, REFERENCE_PUPIL = 575e-9, 5e-3
# How much the smoothness of the densities over the radii weighs against the fit.
SMOOTHNESS = 0.3
# The cornea gives 25 to 30 % of the scattered light (van den Berg and others 2005); here it has the largest.
CORNEA, VITREOUS_OF_REST = 0.27, 0.2


@dataclass(frozen=True)
class Population:
    """Particles of one size in one layer.

    Parameters
    ----------
    layer : str
        One of `LAYERS`: the cornea stands still, the lens follows accommodation, the vitreous the head.
    radius : float
        Metres.
    density : float
        Particles per square metre of the pupil.
    """

    layer: str
    radius: float
    density: float


def populations(age: float = 30.0, pigment: float = 0.5, factor: float = 1.0) -> tuple[Population, ...]:
    """Return the particles of an eye.

    Parameters
    ----------
    age : float
        Years.
    pigment : float
        The CIE's p, 0 (black) to 1.2 (light blue).
    factor : float
        Times as many particles as scatter what CIE 135 says.

    Returns
    -------
    tuple of Population
        Layer by layer, radii rising; none of density zero.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, or more than half of the light would be turned.
    """
    many = refuse.between("factor", factor, 0, 100)
    radii, single = _densities(refuse.between("age", age, 0, 120), refuse.between("pigment", pigment, 0, 1.2))
    shares = many * 4 * single * np.pi * radii**2
    if shares.sum() >= 1:
        raise refuse.Refusal(
            f"'factor' {factor:g} would scatter {shares.sum():.3g} times the light; the most is "
            f"{factor / shares.sum():.3g}."
        )
    densities = many * single * _for_overlap(float(shares.sum()))
    layers = _layers(shares)
    return tuple(
        Population(layer, float(radius), float(part * density))
        for layer, parts in zip(LAYERS, layers, strict=True)
        for radius, density, part in zip(radii, densities, parts, strict=True)
        if part * density > 0
    )


def covered(particles: tuple[Population, ...]) -> float:
    """Return the part of the pupil that particles at random places cover.

    Parameters
    ----------
    particles : tuple of Population
        Any.

    Returns
    -------
    float
        1 − exp(−Σ n π r²).
    """
    return -math.expm1(-sum(math.pi * one.radius**2 * one.density for one in particles))


def scattered_share(particles: tuple[Population, ...]) -> float:
    """Return the part of the light that particles scatter out of the image.

    Parameters
    ----------
    particles : tuple of Population
        Any.

    Returns
    -------
    float
        4 c (1 − c), c the covered part.
    """
    part = covered(particles)
    return 4 * part * (1 - part)


def scattered_density(particles: tuple[Population, ...], angle: ArrayLike) -> NDArray[np.float64]:
    """Return how much light particles scatter to an angle, in the mean over the visible wavelengths.

    Parameters
    ----------
    particles : tuple of Population
        Any.
    angle : array_like
        Radians from the source, 0 to π/2.

    Returns
    -------
    ndarray of float64
        1 / steradian, of the angles' shape.
    """
    angles = np.asarray(refuse.all_finite("angle", angle), dtype=np.float64)
    radii = np.array([one.radius for one in particles])
    densities = np.array([one.density for one in particles])
    if not particles:
        return np.zeros(angles.shape)
    single = densities / _for_overlap(scattered_share(particles))
    return np.asarray(_patterns(radii, angles.ravel()) @ single).reshape(angles.shape)


@lru_cache(maxsize=64)
def _densities(age: float, pigment: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Weigh the radii by least squares of relative errors, none below zero; overlap is left out."""
    from scipy.optimize import nnls  # a slow import, of use to eyes alone

    angles = np.geomspace(NEAREST, FARTHEST, ANGLES)
    radii = np.geomspace(SMALLEST, LARGEST, SIZES)

    def glare(angle: NDArray[np.float64]) -> NDArray[np.float64]:
        return cie_135(angle, age, pigment)

    target = glare(angles) / hemisphere_energy(glare)
    pupil = REFERENCE_WAVELENGTH / (np.pi**3 * REFERENCE_PUPIL * np.sin(angles) ** 3)
    # The unknowns are parts of the area, which differ less than numbers of particles do.
    columns = _patterns(radii, angles) / (np.pi * radii**2) / target[:, None]
    bends = np.diff(np.eye(SIZES), 2, axis=0) * columns.max(axis=0)
    weight = SMOOTHNESS * math.sqrt(ANGLES / SIZES)
    wanted = np.concatenate([np.maximum(target - pupil, 0) / target, np.zeros(SIZES - 2)])
    areas, _ = nnls(np.vstack([columns, weight * bends]), wanted)
    return radii, areas / (np.pi * radii**2)


def _patterns(radii: NDArray[np.float64], angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean pattern (A, R) of one disc per unit of area, for angles (A,) and radii (R,)."""
    from scipy.special import j1

    total = np.zeros((len(angles), len(radii)))
    wavelengths = np.linspace(SHORTEST, LONGEST, WAVELENGTHS)
    for wavelength in wavelengths:
        v = np.maximum(2 * np.pi / wavelength * np.sin(angles)[:, None] * radii, 1e-9)
        total += 4 * (np.pi * radii**2 * 2 * j1(v) / v / wavelength) ** 2
    return total / WAVELENGTHS


def _for_overlap(share: float) -> float:
    """Return by how much more particles scatter a share of the light than if none overlapped."""
    # 4 c (1 − c) = share, c = 1 − exp(−a), where a is the area of all discs.
    part = (1 - math.sqrt(1 - share)) / 2
    return -4 * math.log1p(-part) / share if share > 0 else 1.0


def _layers(shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Divide each radius among the layers (3, R): the largest are the cornea's until it has its part."""
    larger = np.cumsum(shares[::-1])[::-1] - shares
    left = np.maximum(CORNEA * shares.sum() - larger, 0)
    cornea = np.clip(np.divide(left, shares, out=np.zeros(len(shares)), where=shares > 0), 0, 1)
    rest = 1 - cornea
    return np.array([cornea, rest * (1 - VITREOUS_OF_REST), rest * VITREOUS_OF_REST])
