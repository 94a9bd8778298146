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
FINE, MOST_CELLS = 24, 6000


def visibility(
    camera: Camera, occluders: Sequence[Occluder], distance: float = math.inf
) -> NDArray[np.float32]:
    """Return what part of the camera's opening each of its pixels' directions sees.

    Parameters
    ----------
    camera : Camera
        Its resolution is the picture's.
    occluders : sequence of Occluder
        What stands between; shadows of several are taken as unrelated, their parts multiplied, which is
        exact for one.
    distance : float
        Of what is seen behind them, metres.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        0..1, a part of the opening's transmittance.

    Raises
    ------
    refuse.Refusal
        Where the distance is not above zero.
    """
    if not distance > 0:
        raise refuse.Refusal(f"'distance' must be > 0, got {distance:g}.")
    share = np.ones(camera.resolution, dtype=np.float32)
    for each in occluders:
        if each.distance < distance:
            share *= _past(camera, each, distance)
    return share


def _past(camera: Camera, occluder: Occluder, distance: float) -> NDArray[np.float32]:
    """Blur an occluder's silhouette by the opening's shape in its plane."""
    opening = pupil(camera)
    opening = apertures.scaled(opening, 1 - occluder.distance / distance)
    pitch = max(camera.pixel_pitch) / camera.focal_length * occluder.distance
    field = pitch * max(camera.resolution) + 2 * opening.width
    cell = max(min(pitch, opening.width / FINE), field / MOST_CELLS)
    count = 2 * math.ceil(field / (2 * cell)) + 1
    side = count * cell
    before = apertures.seen_past(
        _open_square(side),
        [apertures.occluder(occluder.shape, occluder.distance, occluder.place)],
        size=count,
    )
    silhouette = np.ones((count, count), np.float32) if before is None else 1 - before.mask  # type: ignore[operator]
    across = 2 * math.ceil(opening.width / (2 * cell)) + 1
    shape = apertures.rasterize(Aperture(across * cell, opening.outlines, opening.mask), across)
    # Light from the place q comes to the point p of the opening from q − p: the shape is turned round.
    kernel = shape[::-1, ::-1] / shape.sum(dtype=np.float64)
    hidden = picture.convolve(silhouette, kernel, precision="double")
    rows, columns = (
        (np.arange(n) - n // 2) * step / camera.focal_length * occluder.distance / cell + count // 2
        for n, step in zip(camera.resolution, camera.pixel_pitch, strict=True)
    )
    return np.asarray(1 - _between(hidden, rows, columns), dtype=np.float32)


def _open_square(side: float) -> Aperture:
    return apertures.rectangle(side, side)


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
