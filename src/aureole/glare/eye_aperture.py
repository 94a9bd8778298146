"""The eye's parts as amplitudes on the plane of its entrance pupil.

    t(x) = bloom(x) · (1 − halo(x)) · (1 − corona(x)) · (1 − streaks(x))

Pupil and lids let light through (bloom); fibres (halo), particles (corona) and lashes (streaks) take from
its amplitude. Particles are transparent and half a wave late, so they take up to 2 and leave −1.

The plane is seen along the line of sight: x to the right, y downward, as on the picture. A pixel holds the
mean over its square: the discrete Fourier transform of the pixels is the far field of the parts times the
pixel's sinc, and over it their far field itself, to a few percent up to half of the highest frequency.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.aperture import Discs, Fibres
from aureole.glare.eye import EyeState
from aureole.glare.eye_particles import LAYERS, populations
from aureole.records import Aperture, Outline

COMPONENTS = ("bloom", "halo", "corona", "streaks")
# Particles lie within this of the axis: a pupil of 9 mm is filled while the lens moves, metres.
FIELD_RADIUS = 5e-3
# The lids' margins stand so far before the entrance pupil, metres.
LID_DISTANCE = 3e-3
# Larger particles make the inner part of the corona, smaller ones the outer needles, metres.
NEEDLE_RADIUS = 10e-6
# Streams of the eye's seed.
FIBRES, PARTICLES, LENS_SHAPE, LASHES = 16, 17, 18, 19
STEEPEST = math.radians(80)

Source = tuple[float, float]


def eye_parts(
    state: EyeState, size: int, width: float, source: Source = (0.0, 0.0)
) -> dict[str, NDArray[np.float32]]:
    """Return what each part of an eye does to the amplitude on the pupil plane.

    Parameters
    ----------
    state : EyeState
        The eye at a time.
    size : int
        Pixels on each side.
    width : float
        Side of the square about the pupil's middle, metres.
    source : tuple of float
        Direction of the light off the line of sight, (right, down) in radians; lids and lashes stand
        before the pupil and cast their shadow the other way.

    Returns
    -------
    dict of str to ndarray of float32, shape (size, size)
        "bloom": the part of the amplitude that pupil and lids let through, 0..1; "halo", "corona" and
        "streaks": what fibres, particles and lashes take, 0..fibre_depth, 0..2 and 0..1, where the pupil
        may be open.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.at_least("size", size, 1)
    refuse.positive("width", width)
    return {
        "bloom": _open_pupil(state, size, width, source),
        "halo": _halo(state, size, width),
        "corona": _corona(_pupil_particles(state, 1.5 * width / size), size, width),
        "streaks": _streaks(state, size, width, source),
    }


def eye_aperture(state: EyeState, size: int, width: float, source: Source = (0.0, 0.0)) -> Aperture:
    """Return the eye as one opening: a raster, with a wavefront where the eye has one.

    Parameters
    ----------
    state : EyeState
        As in `eye_parts`.
    size : int
        As in `eye_parts`.
    width : float
        As in `eye_parts`.
    source : tuple of float
        As in `eye_parts`.

    Returns
    -------
    Aperture
        Mask of −1..1. Eyes with a defocus or Zernike terms have a wavefront, in which the accommodation
        off its mean counts, too.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    parts = eye_parts(state, size, width, source)
    mask = parts["bloom"]
    for name in COMPONENTS[1:]:
        mask *= np.subtract(1, parts[name], out=parts[name])
    return focused(Aperture(width, mask=mask, name=f"eye {state.eye.name}"), state)


def focused(opening: Aperture, state: EyeState) -> Aperture:
    """Give an opening the wavefront of an eye.

    Parameters
    ----------
    opening : Aperture
        A raster on the pupil plane.
    state : EyeState
        The eye at a time.

    Returns
    -------
    Aperture
        With a wavefront where the eye has a defocus or Zernike terms, in which the accommodation off its
        mean counts, too; the opening itself elsewhere.
    """
    eye = state.eye
    if (eye.defocus == 0 and not eye.zernike) or opening.mask is None:
        return opening
    radius = eye.zernike_diameter / 2
    # An eye that focuses nearer than it should needs a weaker glass.
    rim = (eye.defocus - state.accommodation) * radius**2 / 2
    return apertures.with_wavefront(opening, len(opening.mask), eye.zernike, defocus=rim, radius=radius)


def corona_layers(
    state: EyeState, size: int, width: float, boundary: float = NEEDLE_RADIUS
) -> dict[str, NDArray[np.float32]]:
    """Return the corona's part of the amplitude by the size of the particles.

    Parameters
    ----------
    state : EyeState
        As in `eye_parts`.
    size : int
        As in `eye_parts`.
    width : float
        As in `eye_parts`.
    boundary : float
        Radius that divides the particles, metres.

    Returns
    -------
    dict of str to ndarray of float32, shape (size, size)
        "inner", of particles at least so large, which scatter close to the source; "outer", of the
        smaller ones, whose needles reach far. Each 0..2.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.positive("boundary", boundary)
    discs = _pupil_particles(state, 1.5 * width / size)
    large = discs.radii >= boundary
    return {
        name: _corona(Discs(discs.centres[chosen], discs.radii[chosen]), size, width)
        for name, chosen in (("inner", large), ("outer", ~large))
    }


def open_share(state: EyeState, source: Source = (0.0, 0.0), size: int = 256) -> float:
    """Return the part of the pupil's light that lids and lashes let through.

    Parameters
    ----------
    state : EyeState
        As in `eye_parts`.
    source : tuple of float
        As in `eye_parts`.
    size : int
        Pixels across the pupil with which it is measured.

    Returns
    -------
    float
        0, closed, to 1: by how much a picture dims.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    width = state.pupil_diameter
    passing = _open_pupil(state, size, width, source) * (1 - _streaks(state, size, width, source))
    return float(passing.sum(dtype=np.float64)) / (math.pi / 4 * size**2)


def _open_pupil(state: EyeState, size: int, width: float, source: Source) -> NDArray[np.float32]:
    """Return pupil times lids."""
    radius = refuse.positive("pupil_diameter", state.pupil_diameter) / 2
    pupil = apertures.disc_coverage(Discs(np.zeros((1, 2)), np.array([radius])), size, width)
    apertures.close_lids(pupil, apertures.lids(state.lid_opening), width, lid_shadow(source))
    return pupil


def _halo(state: EyeState, size: int, width: float) -> NDArray[np.float32]:
    reach = state.pupil_diameter / 2 + width / size
    halo = apertures.fibre_coverage(state_fibres(state), size, width, reach)
    halo *= state.eye.fibre_depth
    return halo


def _corona(discs: Discs, size: int, width: float) -> NDArray[np.float32]:
    """Return what transparent discs half a wave late take off the amplitude."""
    corona = apertures.disc_coverage(discs, size, width)
    corona *= 2
    return corona


def _streaks(state: EyeState, size: int, width: float, source: Source) -> NDArray[np.float32]:
    return apertures.lash_coverage(lash_shadows(state, source), size, width)


def state_fibres(state: EyeState) -> Fibres:
    """Return the lens fibres of an eye at a time.

    Parameters
    ----------
    state : EyeState
        The eye at a time.

    Returns
    -------
    Fibres
        Moved with the lens.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    eye = state.eye
    breadth = None if eye.fibre_count is not None else eye.fibre_width
    rest = apertures.fibres(eye.fibre_annulus, breadth, eye.fibre_count, (eye.seed, FIBRES))
    return apertures.stretched_fibres(rest, state.lens_stretch)


def moved_particles(state: EyeState) -> tuple[Discs, ...]:
    """Return the particles of an eye at a time.

    Parameters
    ----------
    state : EyeState
        The eye at a time.

    Returns
    -------
    tuple of Discs
        Of the cornea, where they stay; of the lens, moved with it; of the vitreous, turned with it.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    eye = state.eye
    cornea, lens, vitreous = _at_rest(eye.age, eye.pigment, eye.particles, eye.seed)
    moved = apertures.stretched(lens, state.lens_stretch, (eye.seed, LENS_SHAPE), FIELD_RADIUS)
    return cornea, moved, apertures.turned(vitreous, state.vitreous_angle)


def lash_shadows(state: EyeState, source: Source = (0.0, 0.0)) -> tuple[Outline, ...]:
    """Return the lashes' shadows on the pupil plane.

    Parameters
    ----------
    state : EyeState
        The eye at a time.
    source : tuple of float
        As in `eye_parts`. Roots stand as far before the pupil as the lids, tips at `lash_distance`.

    Returns
    -------
    tuple of Outline
        Opaque rings, metres.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    eye, roots, tips = state.eye, lid_shadow(source), _shadow(source, state.eye.lash_distance)
    chances = (eye.seed, LASHES)
    return apertures.lashes(
        eye.lashes, eye.lash_spread, eye.lash_width, state.lid_opening, chances, roots, tips
    )


def lid_shadow(source: Source) -> tuple[float, float]:
    """Return by how much light from a direction moves the lids' shadow.

    Parameters
    ----------
    source : tuple of float
        As in `eye_parts`.

    Returns
    -------
    tuple of float
        (x, y) in metres.

    Raises
    ------
    refuse.Refusal
        Where an angle is beyond 80 degrees.
    """
    return _shadow(source, LID_DISTANCE)


@lru_cache(maxsize=8)
def _at_rest(age: float, pigment: float, factor: float, seed: int) -> tuple[Discs, ...]:
    """Return the particles of each layer; another age adds or removes the last ones of each size."""
    lots: dict[str, list[Discs]] = {layer: [] for layer in LAYERS}
    for one in populations(age, pigment, factor):
        own = (seed, PARTICLES, LAYERS.index(one.layer), round(one.radius * 1e9))
        count = round(one.density * math.pi * FIELD_RADIUS**2)
        lots[one.layer].append(apertures.scattered(count, one.radius, FIELD_RADIUS, own))
    return tuple(apertures.joined(lots[layer]) for layer in LAYERS)


def _pupil_particles(state: EyeState, margin: float) -> Discs:
    """Return all particles that the iris does not hide, and those within a margin of its rim."""
    discs = apertures.joined(moved_particles(state))
    reach = state.pupil_diameter / 2 + margin + discs.radii
    seen = np.einsum("ij,ij->i", discs.centres, discs.centres) < reach**2
    return Discs(discs.centres[seen], discs.radii[seen])


def _shadow(source: Source, distance: float) -> tuple[float, float]:
    """Return by how much light from a direction moves the shadow of what stands before the pupil."""
    right, down = (refuse.between("source", angle, -STEEPEST, STEEPEST) for angle in source)
    return -distance * math.tan(right), -distance * math.tan(down)
