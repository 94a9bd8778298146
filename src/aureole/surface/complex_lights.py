"""Lamps that are not points: a table convolved with the lamp's shape (surface paper, section 6.2).

A lamp's mirror image in the sample shows each of its parts where h = 0 for that part, so in h the whole
pattern is the point lamp's pattern convolved with the mirror image. In: a photograph of the mirror image,
with its step in h; out: the lamp's shape, and a table that shows the whole lamp as if it were a point.

A photograph runs against h: further right on a sample the eye lies further left. So does a lamp's shape.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from aureole import light, picture, refuse
from aureole.records import Picture, Stage
from aureole.surface.resampling import on_even_steps, on_warped_steps
from aureole.surface.table import ScatterTable, axis, neutral_white, rgb

BYTES = 3 * 4 * 8  # per sample of the plane: three channels, some copies of them
HALF_PLANE = 1024  # samples on each side of a plane


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
    middle : tuple of int
        Row and column of the photograph that became the middle: the table of the whole lamp has its h = 0
        where a point lamp would have its mirror image there.
    """

    weights: NDArray[np.float32]
    step: float
    colour_space: str = "rec709"
    middle: tuple[int, int] = (0, 0)


def lamp_from_reflection(
    photograph: Picture,
    step: float,
    threshold: float = 0.1,
    neutral: bool = False,
    rotation: float = 0.0,
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
    rotation : float
        Radians, counter-clockwise on the photograph from its right to the surface's tangent.

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
    shares /= _luminance(shares, photograph.colour_space).sum()
    centred, middle = _about_middle(shares, photograph.colour_space)
    # A photograph runs against h: further right on a sample the eye lies further left.
    turned = _turned(centred[::-1, ::-1], refuse.finite("rotation", rotation))
    return LampShape(turned.astype(np.float32), step, photograph.colour_space, middle)


def convolved(table: ScatterTable, lamp: LampShape, method: str = "auto") -> ScatterTable:
    """Convolve a table with a lamp's shape: what the whole lamp does, looked up as for a point.

    The table goes to even steps of h, the lamp's own about h = 0 and coarser ones farther out, where its
    warp is coarser too; is convolved in the lamp's colour space; and comes back to its warp. Detail finer
    than a step is lost, as the lamp blurs it. All light is kept.

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
        Where the lamp is wider than the table, or there is not enough memory.
    """
    result = None
    for stage in convolved_stages(table, lamp, method):
        result = stage.result
    assert isinstance(result, ScatterTable)
    return result


def convolved_stages(table: ScatterTable, lamp: LampShape, method: str = "auto") -> Iterator[Stage]:
    """Convolve a table with a lamp's shape, plane by plane.

    Parameters
    ----------
    table, lamp, method : ScatterTable, LampShape, str
        As for `convolved`.

    Yields
    ------
    Stage
        The last one has the table.

    Raises
    ------
    refuse.Refusal
        As `convolved`.
    """
    planes = _planes(table, lamp)
    rows, columns = table.values.shape[:2]
    side = max(2 * half + 1 for _, half, _ in planes)
    needed, allowed = side * side * BYTES, picture.allowed_memory(None)
    if needed > allowed:
        raise refuse.Refusal(
            f"The table and the lamp need {needed / 1e9:.3g} GB of memory, {allowed / 1e9:.3g} GB are free."
        )
    colours = rgb(table, lamp.colour_space)
    far = [np.abs(axis(count, table.half_range, table.warp)) for count in (rows, columns)]
    distance = np.maximum(far[0][:, None], far[1][None, :])
    warped = np.zeros(colours.shape, dtype=np.float32)
    # The coarsest plane covers the whole table, each finer one the part about h = 0.
    for index, (shape, half, valid) in enumerate(planes):
        yield Stage(index / len(planes), "convolving with the lamp")
        counts = (2 * half + 1, 2 * half + 1)
        plane = on_even_steps(colours, table.half_range, table.warp, counts, shape.step)
        blurred = picture.convolve(plane, shape.weights, method)
        back = on_warped_steps(blurred, shape.step, (rows, columns), table.half_range, table.warp)
        here = distance <= valid
        warped[here] = back[here]
    values = light.to_xyz(warped, lamp.colour_space, neutral_white(table.white, lamp.colour_space))
    metadata = {**table.metadata, "lamp": "shaped"}
    yield Stage(
        1.0, "convolved", replace(table, values=np.asarray(values, dtype=np.float32), metadata=metadata)
    )


def _planes(table: ScatterTable, lamp: LampShape) -> list[tuple[LampShape, int, float]]:
    """The lamp at steps that grow by threes until a plane covers the table, coarsest first.

    Each comes with the samples on each side of its plane, and the h up to which it is used.
    """
    found = []
    while True:
        extent = lamp.step * (max(lamp.weights.shape[:2]) // 2)
        if extent > table.half_range:
            raise refuse.Refusal(
                f"'lamp' reaches {extent:.3g} in h, farther than the table's {table.half_range:.3g}."
            )
        whole = int(np.ceil((table.half_range + extent) / lamp.step))
        half = min(whole, HALF_PLANE)
        valid = np.inf if half == whole else half * lamp.step - 2 * extent
        if valid > 0:
            found.append((lamp, half, valid))
        if half == whole:
            return found[::-1]
        lamp = _coarser(lamp)


def _coarser(lamp: LampShape) -> LampShape:
    """The lamp in pixels of three times the size, about the same middle."""
    rows, columns = lamp.weights.shape[:2]
    aside = [(-(size // 2 - 1)) % 3 for size in (rows, columns)]
    wide = np.pad(lamp.weights, ((aside[0], aside[0]), (aside[1], aside[1]), (0, 0)))
    high, broad = wide.shape[0] // 3, wide.shape[1] // 3
    merged = wide.reshape(high, 3, broad, 3, 3).sum(axis=(1, 3))
    return replace(lamp, weights=merged, step=3 * lamp.step)


def _about_middle(
    shares: NDArray[np.float64], colour_space: str
) -> tuple[NDArray[np.float64], tuple[int, int]]:
    """Crop to the lit pixels, in an odd frame about the pixel nearest to the middle of the light."""
    weight = _luminance(shares, colour_space)
    middle = [round(place) for place in ndimage.center_of_mass(weight)]
    lit = np.argwhere(weight > 0)
    reach = np.abs(lit - middle).max(axis=0)
    wide = np.pad(shares, ((reach[0], reach[0]), (reach[1], reach[1]), (0, 0)))
    cut = wide[middle[0] : middle[0] + 2 * reach[0] + 1, middle[1] : middle[1] + 2 * reach[1] + 1]
    return cut, (middle[0], middle[1])


def _turned(shares: NDArray[np.float64], rotation: float) -> NDArray[np.float64]:
    """Turn about the middle pixel, from the photograph's right to the tangent; the light is kept."""
    if rotation == 0.0:
        return shares
    shares = np.pad(shares, ((1, 1), (1, 1), (0, 0)))
    side = int(np.ceil(np.hypot(*shares.shape[:2]))) | 1
    cosine, sine = np.cos(rotation), np.sin(rotation)
    matrix = np.array([[cosine, -sine], [sine, cosine]])
    offset = np.array(shares.shape[:2]) // 2 - matrix @ np.array([side // 2, side // 2])
    channels = [
        ndimage.affine_transform(shares[..., k], matrix, offset, (side, side), order=1) for k in range(3)
    ]
    turned = np.stack(channels, axis=-1)
    return np.asarray(turned * (shares.sum() / turned.sum()))


def _luminance(pixels: NDArray[np.floating], colour_space: str) -> NDArray[np.float64]:
    return np.asarray(light.to_xyz(pixels, colour_space)[..., 1], dtype=np.float64)
