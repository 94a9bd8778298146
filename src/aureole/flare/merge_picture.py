"""What merging does to a ghost's ray grid, as a picture (the tile paper's Fig. 8).

Every primitive's outline, in a colour that tells how many cells it has; the whole ghost fills the picture.
"""

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.flare import primitives
from aureole.flare.primitives import Frame, Merge, Primitives
from aureole.flare.pupil import Sheet

F32 = NDArray[np.float32]
# Display colours of the sizes 1, 2, 4, 8 and 16, on white.
COLOURS = {
    1: (0.80, 0.15, 0.15),
    2: (0.93, 0.55, 0.10),
    4: (0.20, 0.60, 0.25),
    8: (0.15, 0.40, 0.80),
    16: (0.45, 0.20, 0.60),
}
# Points along an outline for each pixel of its length.
POINTS_A_PIXEL = 2.0
MARGIN = 0.03


def merge_picture(
    sheet: Sheet,
    frame: Frame,
    merge: str | Merge = "light",
    shape: tuple[int, int] = (720, 720),
    wavelength: int = 0,
) -> F32:
    """Return the outlines of a ghost's primitives, coloured by the cells that they were merged of.

    Parameters
    ----------
    sheet : Sheet
        The ghost's rays.
    frame : Frame
        The picture for which cells merge: its pixels are what the bounds count in.
    merge : str or Merge
        As in `construct`.
    shape : tuple of int
        Rows and columns of the drawing; the ghost is scaled to it, parts outside the frame included.
    wavelength : int
        Which of the sheet's wavelengths.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Display values 0..1 on white: 1 cell red, 2×2 orange, 4×4 green, 8×8 blue, 16×16 violet.

    Raises
    ------
    refuse.Refusal
        Where the merge or shape cannot be served, or there is no such wavelength.
    """
    waves = len(sheet.x)
    refuse.between("wavelength", refuse.at_least("wavelength", wavelength, 0), 0, waves - 1)
    rows, columns = (refuse.at_least("shape", n, 1) for n in refuse.shape_of("shape", shape, (2,)).tolist())
    found = primitives.construct(sheet, frame, merge=merge, clip=False)
    chosen = found.colour == wavelength
    picture = np.ones((rows, columns, 3), dtype=np.float32)
    if not chosen.any():
        return picture
    corners = _fitted(found.corners[chosen].astype(np.float64), rows, columns)
    # Fine outlines lie over coarse ones.
    for size in sorted(COLOURS, reverse=True):
        cover = _outlines(corners[found.size[chosen] == size], rows, columns)[..., None]
        picture += cover * (np.array(COLOURS[size], dtype=np.float32) - picture)
    return picture


def sizes(found: Primitives) -> dict[int, int]:
    """Return how many primitives there are of each size.

    Parameters
    ----------
    found : Primitives
        Primitives of any sheets.

    Returns
    -------
    dict of int to int
        Cells along a side, 1, 2, 4, 8 and 16, to numbers of primitives.
    """
    return {size: int(np.count_nonzero(found.size == size)) for size in COLOURS}


def _fitted(corners: NDArray[np.float64], rows: int, columns: int) -> NDArray[np.float64]:
    """Scale corners so that their box fills the picture but for a margin."""
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    room = np.array([columns, rows]) * (1.0 - 2.0 * MARGIN)
    scale = np.min(room / np.maximum(high - low, 1e-12))
    placed: NDArray[np.float64] = (corners - 0.5 * (low + high)) * scale + 0.5 * np.array([columns, rows])
    return placed


def _outlines(corners: NDArray[np.float64], rows: int, columns: int) -> F32:
    """Return how much of each pixel the quads' outlines cover, 0..1: points in a row, each on four pixels."""
    start, end = corners.reshape(-1, 2), np.roll(corners, -1, axis=1).reshape(-1, 2)
    counts = np.ceil(POINTS_A_PIXEL * np.hypot(*(end - start).T)).astype(np.int64) + 1
    which = np.repeat(np.arange(len(counts)), counts)
    part = (np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)) / counts[which]
    points = start[which] + part[:, None] * (end - start)[which] - 0.5
    first = np.floor(points).astype(np.int64)
    share = points - first
    cover = np.zeros((rows + 2, columns + 2), dtype=np.float32)
    for right in (0, 1):
        for down in (0, 1):
            across = share[:, 0] if right else 1.0 - share[:, 0]
            along = share[:, 1] if down else 1.0 - share[:, 1]
            np.maximum.at(cover, (first[:, 1] + down + 1, first[:, 0] + right + 1), across * along)
    return cover[1:-1, 1:-1]
