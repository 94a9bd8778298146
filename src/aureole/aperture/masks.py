"""Between openings and pixels: masks in, anti-aliased masks out.

A mask of a given width tiles the square [−width/2, width/2]² with n × n pixels, each a small square
of constant transmittance. Rasterizing gives each pixel the mean transmittance over its square.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.aperture import _kernels
from aureole.aperture.geometry import chords, orientation
from aureole.records import Aperture, Picture

# Chords stray from arcs by less than this part of a pixel.
CHORD_TOLERANCE = 1e-4
# Coverage below this is rounding, not light.
ROUNDING = 1e-9
REC709_LUMINANCE = (0.2126, 0.7152, 0.0722)


def from_mask(mask: ArrayLike, width: float) -> Aperture:
    """Make an aperture of pixels.

    Parameters
    ----------
    mask : array_like, shape (n, n)
        Amplitude transmittance of each pixel, 0..1; row 0 is the top.
    width : float
        Side of the whole mask, metres.

    Returns
    -------
    Aperture
        A raster aperture that holds a float32 copy of the mask.

    Raises
    ------
    refuse.Refusal
        Where the mask is not a square of finite numbers from 0 to 1, or is dark all over.
    """
    values = refuse.all_finite("mask", refuse.shape_of("mask", mask, (None, None)))
    if values.shape[0] != values.shape[1]:
        raise refuse.Refusal(f"'mask' must be square, got {values.shape[0]} x {values.shape[1]} pixels.")
    if values.min() < 0 or values.max() > 1:
        low, high = float(values.min()), float(values.max())
        raise refuse.Refusal(f"'mask' must hold values from 0 to 1, got {low:g} to {high:g}.")
    if not values.any():
        raise refuse.Refusal("'mask' must let some light through, got zero everywhere.")
    pixels = np.array(values, dtype=np.float32, order="C")
    return Aperture(refuse.positive("width", width), mask=pixels, name=f"mask of {len(pixels)}² pixels")


def from_picture(picture: Picture, width: float) -> Aperture:
    """Make an aperture from a picture: white lets light through, black blocks it.

    Parameters
    ----------
    picture : Picture
        Its luminance, relative to the brightest pixel where that is above 1, is the transmittance.
        A picture that is not square is set on a dark square.
    width : float
        Length of the picture's longer side, metres.

    Returns
    -------
    Aperture
        A raster aperture.

    Raises
    ------
    refuse.Refusal
        Where the picture is black, or holds NaN or infinity.
    """
    colour = refuse.all_finite("picture", picture.pixels[..., :3]).astype(np.float64)
    grey = colour @ np.array(REC709_LUMINANCE) if colour.shape[-1] == 3 else colour[..., 0]
    grey = np.clip(grey / max(1.0, float(grey.max())), 0, 1)
    side = max(grey.shape)
    top, left = ((side - length) // 2 for length in grey.shape)
    square = np.zeros((side, side))
    square[top : top + grey.shape[0], left : left + grey.shape[1]] = grey
    return from_mask(square, width)


def rasterize(aperture: Aperture, size: int) -> NDArray[np.float32]:
    """Paint an aperture on its square, each pixel the mean over its area.

    Parameters
    ----------
    aperture : Aperture
        Outlines are painted with exact coverage; a raster is resampled by areas.
    size : int
        Pixels on each side.

    Returns
    -------
    ndarray of float32, shape (size, size)
        Amplitude transmittance 0..1; a wavefront is not told.

    Raises
    ------
    refuse.Refusal
        Where the size is not an integer of at least 1.
    """
    refuse.at_least("size", size, 1)
    if aperture.mask is not None:
        return _resample(aperture.mask, size)
    pixel = aperture.width / size
    total = np.zeros((size, size))
    alike: dict[float, list[NDArray[np.float64]]] = {}
    for ring in aperture.outlines:
        points = chords(ring, CHORD_TOLERANCE * pixel) / pixel + size / 2
        alike.setdefault(ring.transmittance * orientation(ring), []).append(points)
    # Rings of one weight are summed along the rows at once, and only along rows that they reach.
    for weight, rings in alike.items():
        heights = np.concatenate([points[:, 1] for points in rings])
        top, bottom = (int(np.clip(edge, 0, size)) for edge in (heights.min(), np.ceil(heights.max())))
        coverage = np.zeros((bottom - top, size + 2))
        for points in rings:
            _kernels.accumulate_edges(points - np.array([0.0, top]), coverage)
        np.cumsum(coverage, axis=1, out=coverage)
        coverage *= weight
        total[top:bottom] += coverage[:, :size]
    # Running sums end a rounding error off zero; a pixel without light must be exactly dark.
    total[total < ROUNDING] = 0
    return np.minimum(total, 1).astype(np.float32)


def darken(mask: NDArray[np.floating], points: NDArray[np.float64], opacity: float = 1.0) -> None:
    """Take a ring's coverage times its opacity off a mask, in place, where the ring lies.

    Parameters
    ----------
    mask : ndarray, shape (rows, columns)
        Multiplied by 1 − opacity · covered part.
    points : ndarray of float64, shape (V, 2)
        The ring's corners (x, y) in pixels from the mask's top left corner, turning either way.
    opacity : float
        Amplitude that it takes away, 0 to 1.
    """
    rows, columns = mask.shape
    left, top = np.clip(np.floor(points.min(axis=0)).astype(int), 0, (columns, rows))
    right, bottom = np.clip(np.ceil(points.max(axis=0)).astype(int), 0, (columns, rows))
    if right <= left or bottom <= top:
        return
    coverage = np.zeros((bottom - top, right - left + 2))
    _kernels.accumulate_edges(np.ascontiguousarray(points - [left, top]), coverage)
    after = np.roll(points, -1, axis=0)
    sign = np.sign(np.sum(points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]))
    covered = np.clip(sign * np.cumsum(coverage, axis=1)[:, :-2], 0, 1)
    mask[top:bottom, left:right] *= 1 - opacity * covered


def seen_through(
    aperture: Aperture, mask: NDArray[np.floating], dirt: str, remedy: str = "take less"
) -> Aperture:
    """Return an aperture whose raster is what dirt before it leaves.

    Parameters
    ----------
    aperture : Aperture
        Without the dirt; its wavefront is kept.
    mask : ndarray, shape (size, size)
        Transmittance with the dirt.
    dirt : str
        What it is, in the plural.
    remedy : str
        What to do where it lets no light through.

    Returns
    -------
    Aperture
        A raster on the aperture's width.

    Raises
    ------
    refuse.Refusal
        Where no light is left, or a wavefront would be resampled.
    """
    if aperture.wavefront is not None and len(aperture.wavefront) != len(mask):
        raise refuse.Refusal(
            f"a wavefront of {len(aperture.wavefront)} pixels a side cannot be resampled to {len(mask)}; "
            "give it to the aperture after the dirt."
        )
    if not mask.any():
        raise refuse.Refusal(f"the {dirt} let no light through; {remedy}.")
    pixels = np.ascontiguousarray(mask, dtype=np.float32)
    name = f"{aperture.name} behind {dirt}"
    return Aperture(aperture.width, mask=pixels, name=name, wavefront=aperture.wavefront)


def _resample(mask: NDArray[np.float32], size: int) -> NDArray[np.float32]:
    """Average a mask over the squares of another pixel grid on the same area."""
    if len(mask) == size:
        return mask.copy()
    overlap = _overlaps(len(mask), size)
    return np.clip(overlap @ mask @ overlap.T, -1, 1).astype(np.float32)


def _overlaps(have: int, want: int) -> NDArray[np.float64]:
    """Return which part of each wanted pixel each given pixel covers, shape (want, have)."""
    edges_have, edges_want = np.arange(have + 1) / have, np.arange(want + 1) / want
    low = np.maximum(edges_have[None, :-1], edges_want[:-1, None])
    high = np.minimum(edges_have[None, 1:], edges_want[1:, None])
    return np.asarray(np.clip(high - low, 0, None) * want)
