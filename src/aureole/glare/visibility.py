"""How much of a camera's opening each direction sees past an occluder: the occluder, out of focus.

What passes an occluder's plane on the way from a direction t to the opening is the opening's own shape,
1 − d/D times as large about the place d t. So the visible part over all directions is the occluder's
silhouette blurred by that shape: one convolution on the plane of the occluder.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import picture, refuse
from aureole.aperture import Occluder
from aureole.glare.camera import pupil
from aureole.records import Aperture, Camera

# Cells of the occluder's plane across the opening's shape, at least, and a side at most.
FINE, MOST_CELLS = 40, 6000


def visibility(
    camera: Camera,
    occluders: Sequence[Occluder],
    distance: float = math.inf,
    window: tuple[int, int, int, int] | None = None,
) -> NDArray[np.float32]:
    """Return what part of the camera's opening each of its pixels' directions sees.

    Parameters
    ----------
    camera : Camera
        Its resolution is the picture's; the middle of pixel (rows // 2, columns // 2) is the axis.
    occluders : sequence of Occluder
        What stands between; shadows of several are taken as unrelated, their parts multiplied, which is
        exact for one.
    distance : float
        Of what is seen behind them, metres.
    window : tuple of int, optional
        Top, left, rows and columns of the pixels that are wanted, some of which may lie beyond the picture;
        all of the picture without it.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        0..1, a part of the opening's transmittance.

    Raises
    ------
    refuse.Refusal
        Where the distance is not above zero, or the window is empty.
    """
    if not distance > 0:
        raise refuse.Refusal(f"'distance' must be > 0, got {distance:g}.")
    top, left, rows, columns = (0, 0, *camera.resolution) if window is None else window
    refuse.at_least("rows", rows, 1)
    refuse.at_least("columns", columns, 1)
    pitch_y, pitch_x = (pitch / camera.focal_length for pitch in camera.pixel_pitch)
    down = (np.arange(top, top + rows) - camera.resolution[0] // 2) * pitch_y
    right = (np.arange(left, left + columns) - camera.resolution[1] // 2) * pitch_x
    opening, finest = pupil(camera), max(pitch_y, pitch_x)
    share = np.ones((rows, columns), dtype=np.float32)
    for each in occluders:
        if each.distance < distance:
            share *= _past(opening, each, distance, down, right, finest)
    return share


def _past(
    opening: Aperture,
    occluder: Occluder,
    distance: float,
    down: NDArray[np.floating],
    right: NDArray[np.floating],
    pitch: float,
) -> NDArray[np.float32]:
    """Blur an occluder's silhouette by the opening's shape in its plane, and look directions up."""
    near = occluder.distance
    opening = apertures.scaled(opening, 1 - near / distance)
    middle = [near * (axis[0] + axis[-1]) / 2 for axis in (right, down)]
    field = near * max(np.ptp(right), np.ptp(down)) + 2 * opening.width
    wanted = max(min(pitch * near, opening.width / FINE), field / MOST_CELLS)
    # A whole odd number of cells spans the opening, so that a raster keeps its size.
    across = 2 * math.ceil(opening.width / (2 * wanted)) + 1
    cell = opening.width / across
    count = 2 * math.ceil(field / (2 * cell)) + 1
    silhouette = _silhouette(occluder, (middle[0], middle[1]), count, cell)
    if not silhouette.any():
        return np.ones((len(down), len(right)), dtype=np.float32)
    shape = apertures.rasterize(opening, across)
    # Light from the place q comes to the point p of the opening from q − p: the shape is turned round.
    kernel = shape[::-1, ::-1] / shape.sum(dtype=np.float64)
    hidden = picture.convolve(silhouette, kernel, precision="double")
    rows, columns = (
        (near * axis - at) / cell + count // 2 for axis, at in zip((down, right), middle[::-1], strict=True)
    )
    return np.asarray(np.clip(1 - _between(hidden, rows, columns), 0, 1), dtype=np.float32)


def _silhouette(
    occluder: Occluder, middle: tuple[float, float], count: int, cell: float
) -> NDArray[np.float32]:
    """Paint an occluder on a square of its own plane about a place."""
    x, y = (at - about for at, about in zip(occluder.place, middle, strict=True))
    side = count * cell
    before = apertures.seen_past(
        apertures.rectangle(side, side),
        [apertures.occluder(occluder.shape, occluder.distance, (x, y))],
        size=count,
    )
    if before is None:
        return np.ones((count, count), dtype=np.float32)
    assert before.mask is not None
    return np.asarray(1 - before.mask, dtype=np.float32)


def _between(
    values: NDArray[np.floating], rows: NDArray[np.floating], columns: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Interpolate linearly where chosen rows and columns cross."""
    out = np.asarray(values, dtype=np.float64)
    for axis, at in enumerate((rows, columns)):
        first = np.clip(np.floor(at).astype(int), 0, out.shape[axis] - 2)
        part = np.expand_dims(at - first, 1 - axis)
        out = np.take(out, first, axis) * (1 - part) + np.take(out, first + 1, axis) * part
    return out
