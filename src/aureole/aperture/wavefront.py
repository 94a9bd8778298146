"""Wavefronts on openings: how far the light of each pixel is off the perfect wave.

A wavefront error W is in metres of optical path, positive where light has gone a longer way, as
through thicker glass. A wave that goes along +z is exp(i (k z − ω t)), so the phase is +2π W / λ:

- a tilt W = a x moves the far field to sin θ = +a along x;
- a defocus W = W20 ρ², W20 > 0, takes the focus beyond the sensor, by 8 N² W20 at f-number N.

An opening with a wavefront is a raster: mask and wavefront are two pictures on the same square.
"""

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.aperture.geometry import chords
from aureole.aperture.masks import rasterize
from aureole.aperture.zernike import Term, zernike
from aureole.records import Aperture

# Chords of the outlines that bound the disc stray from arcs by less than this part of the width.
BOUND_TOLERANCE = 1e-7
# Light that differs by more than this part of a wave between two pixels could turn either way.
STEEPEST = 0.5


def with_wavefront(
    aperture: Aperture,
    size: int,
    terms: Mapping[Term, float] | None = None,
    defocus: float = 0.0,
    focus_shift: float = 0.0,
    f_number: float | None = None,
    radius: float | None = None,
) -> Aperture:
    """Give an aperture a wavefront error of Zernike polynomials and defocus, all added up.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster; a wavefront that it has is added to.
    size : int
        Pixels on each side of the result, each the mean transmittance of its square and the wavefront
        at its centre.
    terms : mapping, optional
        Zernike polynomials, (n, m) or a name of `ZERNIKE_NAMES`, to their root mean squares over the
        disc, in metres of optical path.
    defocus : float
        W20: optical path at the rim of the disc over that at its centre, metres; √12 times the root
        mean square of the Zernike polynomial (2, 0).
    focus_shift : float
        Defocus as the distance from the sensor to the focus, metres, positive beyond the sensor:
        W20 = focus_shift / (8 N²).
    f_number : float, optional
        N, which `focus_shift` needs.
    radius : float, optional
        Of the disc about the axis on which the polynomials stand, metres; that of `bounding_radius`
        unless given.

    Returns
    -------
    Aperture
        A raster with `wavefront`, zero where no light passes.

    Raises
    ------
    refuse.Refusal
        Where a polynomial does not exist, a number is not finite, or a wavefront would be resampled.
    """
    refuse.at_least("size", size, 1)
    if aperture.wavefront is not None and len(aperture.wavefront) != size:
        raise refuse.Refusal(
            f"a wavefront of {len(aperture.wavefront)} pixels a side cannot be resampled to 'size' {size}."
        )
    disc = bounding_radius(aperture) if radius is None else refuse.positive("radius", radius)
    rim = refuse.finite("defocus", defocus) + _path_of_shift(focus_shift, f_number)
    mask = rasterize(aperture, size)
    # Rows count downward, as y does.
    centres = ((np.arange(size) + 0.5) / size - 0.5) * aperture.width / disc
    x, y = centres[None, :], centres[:, None]
    path = rim * (x**2 + y**2)
    for term, rms in (terms or {}).items():
        path += refuse.finite("root mean square of a Zernike polynomial", rms) * zernike(term, x, y)
    if aperture.wavefront is not None:
        path += aperture.wavefront
    wavefront = np.where(mask != 0, path, 0).astype(np.float32)
    return Aperture(aperture.width, mask=mask, name=f"{aperture.name} with wavefront", wavefront=wavefront)


def bounding_radius(aperture: Aperture) -> float:
    """Return the radius of the smallest disc about the axis that holds an aperture.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.

    Returns
    -------
    float
        Metres; of a raster, to the centre of the farthest pixel that is at least half as bright as its
        brightest.
    """
    if aperture.mask is None:
        tolerance = BOUND_TOLERANCE * aperture.width
        lit = [ring for ring in aperture.outlines if ring.transmittance > 0]
        return max(float(np.hypot(*chords(ring, tolerance).T).max()) for ring in lit)
    size = len(aperture.mask)
    centres = ((np.arange(size) + 0.5) / size - 0.5) * aperture.width
    bright = aperture.mask >= aperture.mask.max() / 2
    return float(np.hypot(centres[:, None], centres)[bright].max())


def transmittance(aperture: Aperture, wavelength: float | None = None) -> NDArray[np.inexact]:
    """Return what each pixel of a raster does to a wave.

    Parameters
    ----------
    aperture : Aperture
        A raster, with or without a wavefront.
    wavelength : float, optional
        Metres; a wavefront needs it.

    Returns
    -------
    ndarray, shape (n, n)
        The mask itself, float32, where the wavefront is flat; else mask · exp(i 2π W / λ), complex128.

    Raises
    ------
    refuse.Refusal
        As `check_wavefront` does.
    """
    mask = aperture.mask
    if mask is None:
        raise refuse.Refusal("an aperture's outlines have no pixels; rasterize them first.")
    if aperture.wavefront is None:
        return mask
    known = check_wavefront(aperture, wavelength)
    lit = mask != 0
    wave = np.zeros(mask.shape, dtype=np.complex128)
    wave[lit] = mask[lit] * np.exp(2j * np.pi / known * aperture.wavefront[lit].astype(np.float64))
    return wave


def check_wavefront(aperture: Aperture, wavelength: float | None) -> float:
    """Refuse a wavefront that cannot be served at a wavelength.

    Parameters
    ----------
    aperture : Aperture
        With a wavefront.
    wavelength : float or None
        Metres.

    Returns
    -------
    float
        The wavelength.

    Raises
    ------
    refuse.Refusal
        Where there is no wavelength, no mask of the wavefront's shape, a value that is not finite, or
        a step of more than half a wave between two pixels.
    """
    if wavelength is None:
        raise refuse.Refusal("'wavelength' is needed, in metres: this aperture has a wavefront.")
    refuse.positive("wavelength", wavelength)
    step = steepest_step(aperture)
    if step > STEEPEST * wavelength:
        raise refuse.Refusal(
            f"the wavefront changes by {step / wavelength:.3g} waves from one pixel to the next, at most "
            f"{STEEPEST:g} can be served; give it more pixels or take a smaller error."
        )
    return wavelength


def wavefront_rms(aperture: Aperture) -> float:
    """Return the root mean square of a wavefront about its mean, over the light that passes.

    Parameters
    ----------
    aperture : Aperture
        Any.

    Returns
    -------
    float
        Metres of optical path; 0 for a flat wavefront.
    """
    if aperture.wavefront is None or aperture.mask is None:
        return 0.0
    path, weight = aperture.wavefront.astype(np.float64), np.abs(aperture.mask, dtype=np.float64)
    mean = float(np.average(path, weights=weight))
    return float(np.sqrt(np.average((path - mean) ** 2, weights=weight)))


def _path_of_shift(shift: float, f_number: float | None) -> float:
    """Return W20 of a focus that lies so far beyond the sensor."""
    if refuse.finite("focus_shift", shift) == 0:
        return 0.0
    if f_number is None:
        raise refuse.Refusal("'focus_shift' needs 'f_number', which tells how fast the light converges.")
    return shift / (8 * refuse.positive("f_number", f_number) ** 2)


@lru_cache(maxsize=8)
def steepest_step(aperture: Aperture) -> float:
    """Return the largest difference of path between two lit pixels side by side.

    Parameters
    ----------
    aperture : Aperture
        With a wavefront.

    Returns
    -------
    float
        Metres; half a wavelength is the most that pixels can tell.

    Raises
    ------
    refuse.Refusal
        Where there is no mask of the wavefront's shape, or a value is not finite.
    """
    path, mask = aperture.wavefront, aperture.mask
    if path is None or mask is None or path.shape != mask.shape:
        raise refuse.Refusal("an aperture's 'wavefront' needs a 'mask' of the same shape.")
    lit = mask != 0
    refuse.all_finite("wavefront", path)
    steps = [0.0]
    for axis in (0, 1):
        both = np.diff(lit.astype(np.int8), axis=axis) == 0
        both &= lit[:-1] if axis == 0 else lit[:, :-1]
        steps.append(float(np.abs(np.diff(path, axis=axis)[both]).max(initial=0)))
    return max(steps)
