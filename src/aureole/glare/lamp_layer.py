"""A lamp behind occluders as its light lies on a frame: the part of it that is seen, spread by its own glare.

The lamp's pixels, also those beyond the frame, are weighed by how much of the opening sees them: the
occluder's edge falls on the lamp as soft as it is out of focus. Their sum is the visible part of the light
that the samples of the lamp found on exact outlines.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import picture, refuse
from aureole.glare.area_light import AreaLight
from aureole.glare.area_psf import AreaPsf
from aureole.glare.kernel import channel_sums, nonnegative
from aureole.records import Camera, Picture

# Parts along each side of a lamp's square, at least, that find what of it falls on which pixel.
PARTS = 32


@dataclass(frozen=True, eq=False)
class LampPatch:
    """The pixels that a lamp covers, as sharp as it is.

    Parameters
    ----------
    top, left : int
        Row and column of the first of them; the frame's first pixel is (0, 0).
    share : ndarray of float32, shape (rows, columns)
        What each holds of the lamp's light; it sums to 1.
    pixels : float
        How many pixels the lamp fills, as a sum over its parts' brightness.
    """

    top: int
    left: int
    share: NDArray[np.float32]
    pixels: float

    @property
    def window(self) -> tuple[int, int, int, int]:
        """Top, left, rows and columns."""
        return self.top, self.left, *self.share.shape


def lamp_patch(camera: Camera, lamp: AreaLight) -> LampPatch:
    """Return where a lamp stands on a camera's picture.

    Parameters
    ----------
    camera : Camera
        Its resolution is the picture's; the middle of pixel (rows // 2, columns // 2) is the axis.
    lamp : AreaLight
        The lamp.

    Returns
    -------
    LampPatch
        It may lie beyond the picture.

    Raises
    ------
    refuse.Refusal
        Where the lamp is dark.
    """
    pitches = [pitch / camera.focal_length for pitch in camera.pixel_pitch]
    wide = lamp.shape.width / min(pitches)
    size = max(PARTS, 4 * math.ceil(wide)) if lamp.shape.mask is None else max(PARTS, len(lamp.shape.mask))
    fine = apertures.rasterize(lamp.shape, size).astype(np.float64)
    whole = float(fine.sum())
    if not whole:
        raise refuse.Refusal("'light' is dark all over.")
    spans = [
        _covered(at / pitch + count // 2, lamp.shape.width / pitch, size)
        for at, pitch, count in zip(lamp.toward[::-1], pitches, camera.resolution, strict=True)
    ]
    (top, rows), (left, columns) = spans
    share = rows @ fine @ columns.T / whole
    part = lamp.shape.width / size
    return LampPatch(top, left, share.astype(np.float32), whole * part * part / (pitches[0] * pitches[1]))


def _covered(middle: float, width: float, parts: int) -> tuple[int, NDArray[np.float64]]:
    """Return the first pixel under a row of equal parts, and which share of each part is on each pixel."""
    edges = middle + width * (np.arange(parts + 1) / parts - 0.5)
    first, last = math.floor(edges[0] + 0.5), math.floor(edges[-1] + 0.5)
    pixels = np.arange(first, last + 1)[:, None]
    low, high = np.maximum(edges[None, :-1], pixels - 0.5), np.minimum(edges[None, 1:], pixels + 0.5)
    return first, np.clip(high - low, 0, None) * (parts / width)


def lamp_reach(patch: LampPatch, resolution: tuple[int, int]) -> tuple[int, int]:
    """Return the size of a point spread function that takes a lamp's light to all of a frame.

    Parameters
    ----------
    patch : LampPatch
        The lamp's pixels.
    resolution : tuple of int
        (rows, columns) of the frame.

    Returns
    -------
    tuple of int
        Odd (rows, columns).
    """
    farthest = (
        max(at + count - 1, side - 1 - at)
        for at, count, side in zip((patch.top, patch.left), patch.share.shape, resolution, strict=True)
    )
    rows, columns = (2 * max(steps, 1) + 1 for steps in farthest)
    return rows, columns


def lamp_layer(
    found: AreaPsf, patch: LampPatch, seen: NDArray[np.floating], resolution: tuple[int, int]
) -> Picture:
    """Return a lamp's light on a frame: its visible part with its glare, on black.

    Parameters
    ----------
    found : AreaPsf
        The lamp's spread, as large as `lamp_reach` says or larger.
    patch : LampPatch
        The lamp's pixels.
    seen : ndarray, shape of the patch
        Which part of the opening sees each, as `visibility` gives it.
    resolution : tuple of int
        (rows, columns) of the frame.

    Returns
    -------
    Picture
        Shape (rows, columns, 3), shares of the unhidden lamp's light; over an endless frame each channel
        would sum to `found.visible`.

    Raises
    ------
    refuse.Refusal
        Where the point spread function is too small.
    """
    dark = Picture(np.zeros((*resolution, 3), dtype=np.float32), found.psf.colour_space)
    sharp = patch.share * seen
    total = float(sharp.sum(dtype=np.float64))
    if found.visible <= 0 or total <= 0:
        return dark
    needed, given = lamp_reach(patch, resolution), found.psf.pixels.shape[:2]
    if given[0] < needed[0] or given[1] < needed[1]:
        raise refuse.Refusal(
            f"'psf' must have {needed[1]} x {needed[0]} pixels to reach all of the frame, "
            f"got {given[1]} x {given[0]}."
        )
    kernel = nonnegative(found.psf).pixels / np.float32(found.visible)
    # Where slivers of an opening are left, rounding can make more of their light than there is.
    kernel /= np.maximum(channel_sums(kernel), 1).astype(np.float32)
    window = _window(kernel, patch, resolution)
    spread = picture.convolve(
        window, np.repeat((sharp / total)[..., None], 3, axis=2), method="fft", precision="double"
    )
    rows, columns = patch.share.shape
    top, left = rows - 1 - rows // 2, columns - 1 - columns // 2
    inside = spread[top : top + resolution[0], left : left + resolution[1]] * found.visible
    return Picture(np.ascontiguousarray(inside, dtype=np.float32), found.psf.colour_space)


def _window(
    kernel: NDArray[np.float32], patch: LampPatch, resolution: tuple[int, int]
) -> NDArray[np.float32]:
    """Return the part of a kernel that lies between some pixel of the patch and some pixel of the frame."""
    spans = []
    for at, count, side, length in zip(
        (patch.top, patch.left), patch.share.shape, resolution, kernel.shape[:2], strict=True
    ):
        first = length // 2 - (at + count - 1)
        spans.append(slice(first, first + side + count - 1))
    return np.ascontiguousarray(kernel[spans[0], spans[1]])
