"""From sheets of rays at few traced wavelengths to sheets in many bands of colour.

Places on the sensor, levels and places in the stop are interpolated by polynomials in 1 / λ; weights follow
each ghost's own curve (`aureole.flare.ghost_colour`), and so does the colour of each band. A ghost that moves
over the sensor with the wavelength takes more bands than one that does not.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole.flare import ghost_colour, pupil, tracing
from aureole.flare.prescription import Lens
from aureole.flare.primitives import Frame
from aureole.flare.spectral import Bands, Sampling, band_count

Numbers = NDArray[np.float64]
# Bands by which the light's own image is weighed.
IMAGE_BANDS = 32


@dataclass(frozen=True, eq=False)
class Blend:
    """A lens made ready for a light's wavelengths.

    Parameters
    ----------
    sampling : Sampling
        Which wavelengths are traced.
    prepared : Prepared
        The lens at those.
    exact : Prepared
        The lens at those by which weights are interpolated; not used where each stands for itself.
    """

    sampling: Sampling
    prepared: tracing.Prepared
    exact: tracing.Prepared


def prepare_blend(lens: Lens, sampling: Sampling) -> Blend:
    """Make a lens ready for a light's wavelengths.

    Parameters
    ----------
    lens : Lens
        The lens, its stop as wide as it is to be.
    sampling : Sampling
        The light's.

    Returns
    -------
    Blend
        For `in_bands` and `image_luminance`.
    """
    prepared = tracing.prepare(lens, sampling.wavelengths)
    exact = ghost_colour.prepare_curves(lens, sampling) if sampling.blended else prepared
    return Blend(sampling, prepared, exact)


def in_bands(
    blend: Blend, sheets: Sequence[pupil.Sheet], direction: ArrayLike, frame: Frame, step: float, largest: int
) -> tuple[list[pupil.Sheet], list[Numbers]]:
    """Return ghosts' sheets at the wavelengths that are drawn, and each wavelength's colour.

    Parameters
    ----------
    blend : Blend
        From `prepare_blend`.
    sheets : sequence of Sheet
        At the traced wavelengths.
    direction : array_like, shape (3,)
        From the lens towards the light.
    frame : Frame
        The picture.
    step : float
        How far apart neighbouring bands may lie, pixels.
    largest : int
        The most bands of a ghost that fills the frame; one that fills less of it takes more if it must.

    Returns
    -------
    sheets : list of Sheet
        With M wavelengths each, as many as its bands.
    colours : list of ndarray, shape (M, 3)
        XYZ of a power of 1 in each.
    """
    sampling = blend.sampling
    if not sampling.blended:
        return list(sheets), [sampling.bands(1).colours] * len(sheets)
    known: dict[int, Bands] = {}
    made, colours = [], []
    curves = ghost_colour.curves(blend.exact, sheets, direction)
    for sheet, curve in zip(sheets, curves, strict=True):
        shift, part = _extent(sheet, frame)
        count = band_count(shift, step, int(largest / max(part, 1e-3)))
        if count not in known:
            known[count] = sampling.bands(count)
        bands = known[count]
        weights = ghost_colour.weight_blend(curve, blend.exact, sampling.wavelengths, sampling.cells)
        made.append(_mixed(sheet, bands, bands.average @ weights))
        colours.append(_colours(sheet, sampling, bands, weights))
    return made, colours


def image_luminance(blend: Blend, powers: Numbers) -> float:
    """Return the luminous power of the light's own image in parts of its luminous irradiance.

    Parameters
    ----------
    blend : Blend
        From `prepare_blend`.
    powers : ndarray, shape (W,)
        The image's power at the traced wavelengths over the irradiance, m².

    Returns
    -------
    float
        m².
    """
    bands = blend.sampling.bands(IMAGE_BANDS)
    return float(bands.colours[:, 1] @ (bands.blend @ powers))


def _extent(sheet: pupil.Sheet, frame: Frame) -> tuple[float, float]:
    """Return how many pixels the fastest ray moves over the spectrum, and which part of the frame is lit."""
    lit = sheet.passed[[0, -1]].any(axis=0) & sheet.reached.all(axis=0)
    if not lit.any():
        return 0.0, 0.0
    x, y = sheet.x[[0, -1]][:, lit] / frame.pitch, sheet.y[[0, -1]][:, lit] / frame.pitch
    part = 1.0
    for places, length in ((x, frame.shape[1]), (y, frame.shape[0])):
        inside = np.clip(places, -0.5 * length, 0.5 * length)
        part *= float(np.ptp(inside)) / length
    return float(np.hypot(x[1] - x[0], y[1] - y[0]).max()), part


def _mixed(sheet: pupil.Sheet, bands: Bands, weights: Numbers) -> pupil.Sheet:
    """Return a sheet at each band's wavelength, its weights by an interpolation (M, W) of their own."""
    blend = bands.blend.astype(np.float32)
    # Where a ray was lost at one wavelength, the nearest that was traced stands for it.
    broken = ~sheet.reached.all(axis=0)
    parts = []
    for part in (sheet.x, sheet.y, sheet.weight, sheet.level, sheet.stop_x, sheet.stop_y):
        mixture = weights.astype(np.float32) if part is sheet.weight else blend
        mixed = np.tensordot(mixture, part, axes=1)
        if broken.any():
            mixed[:, broken] = part[bands.nearest][:, broken]
        parts.append(mixed)
    x, y, weight, level, stop_x, stop_y = parts
    weight = np.maximum(weight, np.float32(0.0))
    return pupil.Sheet(
        sheet.path, x, y, weight, level, stop_x, stop_y, sheet.reached[bands.nearest], sheet.cell
    )


def _colours(sheet: pupil.Sheet, sampling: Sampling, bands: Bands, weights: Numbers) -> Numbers:
    """Return the bands' colours as the ghost's own curve weighs the wavelengths within each."""
    passed = sheet.passed
    total = np.sum(sheet.weight * passed, axis=(1, 2), dtype=np.float64)
    typical = total / np.maximum(passed.sum(axis=(1, 2)), 1)
    profile = np.maximum(weights @ typical, 0.0)
    mass = sampling.colours.sum(axis=1)
    shares = bands.average * profile
    held = shares.sum(axis=1, keepdims=True)
    own = (
        shares
        @ (sampling.colours / np.where(mass > 0.0, mass, 1.0)[:, None])
        * bands.colours.sum(axis=1, keepdims=True)
    )
    return np.where(held > 0.0, own / np.where(held > 0.0, held, 1.0), bands.colours)
