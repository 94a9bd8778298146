"""Lamps that are not points: a table convolved with the lamp's shape (surface paper, section 6.2).

A lamp's mirror image in the sample shows each of its parts where h = 0 for that part, so in h the whole
pattern is the point lamp's pattern convolved with the mirror image. In: a photograph of the mirror image,
with its step in h; out: the lamp's shape, and a table that shows the whole lamp as if it were a point.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from aureole import light, picture, refuse
from aureole.records import Picture
from aureole.surface.resampling import on_even_steps, on_warped_steps
from aureole.surface.table import ScatterTable, rgb

BYTES = 3 * 4 * 8  # per sample of the plane: three channels, some copies of them


@dataclass(frozen=True, eq=False)
class LampShape:
    """A lamp as its mirror image in a flat sample shows it.

    Parameters
    ----------
    weights : ndarray of float32, shape (rows, columns, 3)
        Share of the lamp's light in each pixel, odd sizes, the light's middle in the middle pixel; the
        luminance adds up to 1.
    step : float
        Between pixels, in h; columns run along the tangent, rows against the bitangent.
    colour_space : str
        Linear RGB space of the weights.
    """

    weights: NDArray[np.float32]
    step: float
    colour_space: str = "rec709"


def lamp_from_reflection(
    photograph: Picture, step: float, threshold: float = 0.1, neutral: bool = False
) -> LampShape:
    """Take a lamp's shape from a photograph of its mirror image in a flat sample.

    Pixels above a share of the brightest are the lamp; the median of all others is taken off as black.
    The photograph must not be overexposed: clipped lamps lose their shape and colour.

    Parameters
    ----------
    photograph : Picture
        Linear, as the camera takes it; the mirror image brighter than the orders around it.
    step : float
        Between pixels, in h: the angle a pixel sees, in radians, times the cosine of the view to the normal.
    threshold : float
        Share of the brightest pixel's luminance, above 0 and below 1.
    neutral : bool
        Whether the lamp's own colour is left out, and only its shape kept.

    Returns
    -------
    LampShape
        About the middle of its light.

    Raises
    ------
    refuse.Refusal
        Where the photograph is black, or a number is not as described.
    """
    refuse.positive("step", step)
    share = refuse.between("threshold", refuse.positive("threshold", threshold), 0.0, 0.999)
    pixels = refuse.all_finite("photograph", photograph.pixels)[..., :3].astype(np.float64)
    brightness = _luminance(pixels, photograph.colour_space)
    if brightness.max(initial=0.0) <= 0:
        raise refuse.Refusal("'photograph' shows no lamp: it is black.")
    lamp = brightness > share * brightness.max()
    black = np.median(pixels[~lamp], axis=0) if not lamp.all() else np.zeros(3)
    shares = np.where(lamp[..., None], np.maximum(pixels - black, 0.0), 0.0)
    if neutral:
        shares = np.repeat(_luminance(shares, photograph.colour_space)[..., None], 3, axis=-1)
    # A photograph runs against h: further right on a sample the eye lies further left.
    shares = shares[::-1, ::-1] / _luminance(shares, photograph.colour_space).sum()
    centred = _about_middle(shares, photograph.colour_space)
    return LampShape(centred.astype(np.float32), step, photograph.colour_space)


def convolved(table: ScatterTable, lamp: LampShape, method: str = "auto") -> ScatterTable:
    """Convolve a table with a lamp's shape: what the whole lamp does, looked up as for a point.

    The table goes to even steps of h, the lamp's own, keeping its energy; is convolved in the lamp's
    colour space; and comes back to its warp. Detail finer than a step is lost, as the lamp blurs it.

    Parameters
    ----------
    table : ScatterTable
        For a point lamp.
    lamp : LampShape
        The lamp.
    method : str
        Of `aureole.picture.convolve`.

    Returns
    -------
    ScatterTable
        Of the same size, range and warp.

    Raises
    ------
    refuse.Refusal
        Where the lamp's step is so fine that the plane would not fit in memory.
    """
    half = int(np.ceil(table.half_range / lamp.step))
    side = 2 * half + 1
    needed, allowed = side * side * BYTES, picture.allowed_memory(None)
    if needed > allowed:
        raise refuse.Refusal(
            f"'lamp' has a step of {lamp.step:g} in h, for which the table needs {needed / 1e9:.3g} GB "
            f"of memory; {allowed / 1e9:.3g} GB are free. A coarser photograph of the lamp needs less."
        )
    colours = rgb(table, lamp.colour_space)
    plane = on_even_steps(colours, table.half_range, table.warp, (side, side), lamp.step)
    blurred = picture.convolve(plane, lamp.weights, method)
    rows, columns = table.values.shape[:2]
    warped = on_warped_steps(blurred, lamp.step, (rows, columns), table.half_range, table.warp)
    values = light.to_xyz(warped, lamp.colour_space, table.white)
    metadata = {**table.metadata, "lamp": "shaped"}
    return replace(table, values=np.asarray(values, dtype=np.float32), metadata=metadata)


def _about_middle(shares: NDArray[np.float64], colour_space: str) -> NDArray[np.float64]:
    """Crop to the lit pixels, in an odd frame about the pixel nearest to the middle of the light."""
    weight = _luminance(shares, colour_space)
    middle = [round(place) for place in ndimage.center_of_mass(weight)]
    lit = np.argwhere(weight > 0)
    reach = np.abs(lit - middle).max(axis=0)
    wide = np.pad(shares, ((reach[0], reach[0]), (reach[1], reach[1]), (0, 0)))
    return wide[middle[0] : middle[0] + 2 * reach[0] + 1, middle[1] : middle[1] + 2 * reach[1] + 1]


def _luminance(pixels: NDArray[np.floating], colour_space: str) -> NDArray[np.float64]:
    return np.asarray(light.to_xyz(pixels, colour_space)[..., 1], dtype=np.float64)
