"""Drawings of how an aperture is broken up, for people to look at."""

import numpy as np
from numpy.typing import NDArray

from aureole.diffraction import Quads, paint
from aureole.records import Aperture

# Linear colours: what blocks light, what lets it through, and the quads' edges.
DARK, LIT = 0.02, 0.6
POSITIVE, NEGATIVE = (0.0, 0.12, 0.75), (0.9, 0.08, 0.0)
# Areas that a change opens and covers, and the edges of their quads.
OPENED, COVERED = (0.12, 0.6, 0.14), (0.8, 0.1, 0.06)
OPENED_EDGE, COVERED_EDGE = (0.0, 0.16, 0.01), (0.2, 0.0, 0.0)
WANTED_SIDE, LARGEST_SIDE, LEAST_STEP = 1536, 6144, 3


def quadtree_drawing(quads: Quads, mask: NDArray[np.float64], width: float) -> NDArray[np.float32]:
    """Draw a mask in grey, its positive quads outlined in blue and its negative ones in red.

    Parameters
    ----------
    quads : Quads
        Rectangles in metres.
    mask : ndarray, shape (n, n)
        What they add up to.
    width : float
        Side of the mask, metres.

    Returns
    -------
    ndarray of float32, shape (k n + 1, k n + 1, 3)
        Linear; k pixels, at least 3 up to n = 2048, stand for each of the mask's.
    """
    step = _step(len(mask))
    drawing = _enlarged(DARK + (LIT - DARK) * np.repeat(mask[..., None], 3, axis=2), step)
    for colour, chosen in ((POSITIVE, quads.weights > 0), (NEGATIVE, quads.weights < 0)):
        drawing[_outlined(_edges(quads, width, step, len(mask))[chosen], len(drawing))] = colour
    return drawing


def change_drawing(
    opened: Quads, covered: Quads, mask: NDArray[np.float64], width: float
) -> NDArray[np.float32]:
    """Draw a mask in grey, what was opened in green and what was covered in red (quad paper Fig. 3).

    Parameters
    ----------
    opened, covered : Quads
        As `aureole.diffraction.difference_quads` returns them.
    mask : ndarray, shape (n, n)
        The later mask.
    width : float
        Side of the mask, metres.

    Returns
    -------
    ndarray of float32, shape (k n + 1, k n + 1, 3)
        Linear, with the quads' outlines; k as for `quadtree_drawing`.
    """
    size = len(mask)
    step = _step(size)
    shown = np.asarray(DARK + (LIT - DARK) * np.repeat(mask[..., None], 3, axis=2))
    for colour, quads in ((OPENED, opened), (COVERED, covered)):
        shown += paint(quads, size, width)[..., None] * (np.asarray(colour) - shown)
    drawing = _enlarged(shown, step)
    for colour, quads in ((OPENED_EDGE, opened), (COVERED_EDGE, covered)):
        drawing[_outlined(_edges(quads, width, step, size), len(drawing))] = colour
    return drawing


def wavefront_drawing(aperture: Aperture, size: int) -> NDArray[np.float32]:
    """Draw a wavefront: white at zero, blue below, red above, as deep as the largest error either way.

    Parameters
    ----------
    aperture : Aperture
        With a wavefront.
    size : int
        Pixels on each side of the drawing.

    Returns
    -------
    ndarray of float32, shape (size, size, 3)
        Linear; dark where no light passes.
    """
    assert aperture.wavefront is not None
    assert aperture.mask is not None
    # Each pixel of the drawing takes the one of the wavefront that lies at its centre.
    at = np.minimum(((np.arange(size) + 0.5) / size * len(aperture.mask)).astype(int), len(aperture.mask) - 1)
    error, light = aperture.wavefront[np.ix_(at, at)], aperture.mask[np.ix_(at, at)][..., None]
    depth = (error / max(float(np.abs(error).max()), 1e-30))[..., None]
    colour = np.where(depth < 0, np.asarray(POSITIVE), np.asarray(NEGATIVE))
    shown = 1 + np.abs(depth) * (colour - 1)
    return np.asarray(DARK + (shown - DARK) * light, dtype=np.float32)


def _step(size: int) -> int:
    """Return how many pixels of a drawing stand for one of the mask's."""
    return max(1, min(max(LEAST_STEP, WANTED_SIDE // size), LARGEST_SIDE // size))


def _enlarged(colours: NDArray[np.float64], step: int) -> NDArray[np.float32]:
    """Repeat pixels, and the last row and column once more for the outlines that end there."""
    large = colours.repeat(step, axis=0).repeat(step, axis=1)
    return np.pad(large, ((0, 1), (0, 1), (0, 0)), mode="edge").astype(np.float32)


def _edges(quads: Quads, width: float, step: int, size: int) -> NDArray[np.int_]:
    """Return the rectangles in pixels of the drawing."""
    return np.asarray(np.clip(np.rint((quads.rectangles / width + 0.5) * size), 0, size).astype(int) * step)


def _outlined(edges: NDArray[np.int_], side: int) -> NDArray[np.bool_]:
    """Return which pixels lie on the rectangles' edges."""
    x0, y0, x1, y1 = edges.T
    # Each edge starts a run and ends it one pixel further; running sums fill it in.
    across, down = np.zeros((side, side + 1), np.int32), np.zeros((side + 1, side), np.int32)
    for row in (y0, y1):
        np.add.at(across, (row, x0), 1)
        np.add.at(across, (row, x1 + 1), -1)
    for column in (x0, x1):
        np.add.at(down, (y0, column), 1)
        np.add.at(down, (y1 + 1, column), -1)
    lines = (across.cumsum(axis=1)[:, :-1] > 0) | (down.cumsum(axis=0)[:-1] > 0)
    return np.asarray(lines)
