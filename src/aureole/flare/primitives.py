"""Primitives: the quads of a ray grid that carry light into the picture, merged where none is missed.

Cells of 2×2 rays are kept as in the tile paper (Bodonyi and Kunkli 2023, section 4.1) and merged 2×2 in up to
four steps, so that sizes are 1, 2, 4, 8 and 16 cells. Its test (Eq. 11-12) is a signed sum: edges that differ
by any amount pass where the sum is negative, and errors in x and y cancel. The correct test bounds what a
picture shows: how far a point moves, and by how much brightness changes.
"""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.flare import _kernels_merge as merging
from aureole.flare import _kernels_primitives as kernels
from aureole.flare.prescription import Lens
from aureole.flare.pupil import Sheet

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
Flags = NDArray[np.bool_]
Rays: TypeAlias = tuple[F32, F32, F32, F32]
TESTS = ("none", "published", "correct")
MOST_STEPS = 4
# Of one primitive: corners, attributes, area, colour, ghost, size.
BYTES = 4 * (8 + 16 + 4)


@dataclass(frozen=True)
class Frame:
    """The part of the sensor's plane that the picture shows, its middle on the axis.

    Parameters
    ----------
    shape : tuple of int
        Rows and columns.
    pitch : float
        Width of the square pixels, metres.
    """

    shape: tuple[int, int]
    pitch: float


@dataclass(frozen=True)
class Merge:
    """When cells of a ray grid become one primitive.

    Parameters
    ----------
    test : {"none", "published", "correct"}
        The published one is Eq. 12 as printed, in normalised device coordinates: 2 across the picture's width
        and across its height, x to the right, y upward, of edges along the grid's rows and columns.
    gamma : float
        Bound of the published test.
    position : float
        Bound of the correct test: by how many pixels a point, or an iris's edge, may move.
    brightness : float
        Bound of the correct test: the largest relative change of brightness. Not asked in a block whose
        diagonals add up to less than two pixels: all its power stays within a pixel's width.
    steps : int
        How often 2×2 blocks may merge, 0..4.
    stitch : bool
        Whether nodes on a large block's edge move onto it (by no more than `position`), so that no crack
        opens between it and smaller ones. The published test leaves the cracks.
    """

    test: str = "correct"
    gamma: float = 0.001
    position: float = 0.5
    brightness: float = 0.02
    steps: int = MOST_STEPS
    stitch: bool = True


# The paper's settings (section 5.6), and the bounds of ours that stand beside them.
MERGES = {
    "none": Merge("none", steps=0, stitch=False),
    "light": Merge(position=0.5, brightness=0.02),
    "heavy": Merge(position=2.0, brightness=0.1),
    "published-light": Merge("published", gamma=0.001, stitch=False),
    "published-heavy": Merge("published", gamma=0.1, stitch=False),
}


@dataclass(frozen=True, eq=False)
class Primitives:
    """Quads in the picture, each with the power of its part of the pupil.

    Parameters
    ----------
    corners : ndarray of float32, shape (P, 4, 2)
        (column, row) in pixels around each quad; pixel (i, j) covers [j, j + 1] × [i, i + 1].
    attributes : ndarray of float32, shape (P, 4, 4)
        At each corner: weight, level, stop_x, stop_y, as a sheet's. Corners may be invalid (level above 1, or
        outside the stop): light ends where the interpolated values say so.
    area : ndarray of float32, shape (P,)
        Power for an irradiance of 1 before the weight, m².
    colour : ndarray of int32, shape (P,)
        Row of a table of colours, one for each wavelength sample and light.
    ghost : ndarray of int32, shape (P,)
        Which ghost it belongs to.
    size : ndarray of int32, shape (P,)
        Cells merged along each side: 1, 2, 4, 8 or 16.
    outside : ndarray of float64, shape (S,)
        For each sheet that the primitives come from: about the power, m², of those that miss the frame,
        summed over its wavelengths.
    """

    corners: F32
    attributes: F32
    area: F32
    colour: I32
    ghost: I32
    size: I32
    outside: NDArray[np.float64]


class _How(NamedTuple):
    """What is kept and merged."""

    merge: Merge
    crossed: bool
    reach: float
    clip: bool


class _Blocks(NamedTuple):
    """A sheet in pixels, and where its blocks begin."""

    x: F32
    y: F32
    rays: Rays
    reached: Flags
    sizes: NDArray[np.int8]
    power: F32
    outside: float
    found: int


def frame_of(lens: Lens, shape: tuple[int, int] = (1080, 1920)) -> Frame:
    """Return the frame whose columns span a lens's sensor.

    Parameters
    ----------
    lens : Lens
        The lens; its sensor's width counts.
    shape : tuple of int
        Rows and columns.

    Returns
    -------
    Frame
        With square pixels.

    Raises
    ------
    refuse.Refusal
        Where the shape is not two whole numbers from 1.
    """
    rows, columns = (refuse.at_least("shape", n, 1) for n in refuse.shape_of("shape", shape, (2,)).tolist())
    return Frame((rows, columns), lens.sensor[0] / columns)


def construct(
    sheets: Sheet | Sequence[Sheet],
    frame: Frame,
    colours: Sequence[Sequence[int]] | None = None,
    merge: str | Merge = "none",
    keep: str = "crossed",
    reach: float = 1.0,
    ghosts: Sequence[int] | None = None,
    clip: bool = True,
) -> Primitives:
    """Return the primitives of sheets of rays that may touch the frame.

    A cell stays where one of its rays is valid: it reached the sensor inside all semi-apertures and the stop.
    A cell with one ray that was lost keeps a corner without weight where the others make a parallelogram.

    Parameters
    ----------
    sheets : Sheet or sequence of Sheet
        Rays on a grid over the pupil, one sheet a ghost (and light).
    frame : Frame
        The picture.
    colours : sequence of sequence of int, optional
        For each sheet and wavelength the row of the table of colours; otherwise the wavelength's place.
    merge : str or Merge
        "none", "light", "heavy", "published-light" or "published-heavy" (`MERGES`), or bounds of one's own.
    keep : {"crossed", "valid"}
        Whether to keep cells, too, that have no valid ray but that a strip of light may cross, between one
        aperture's edge and the stop's; the paper drops them: "valid".
    reach : float
        How far from the stop's middle light passes, in parts of its radius; above 1 for masks with light in
        the corners of their square.
    ghosts : sequence of int, optional
        Each sheet's ghost; otherwise the sheets are counted from 0.
    clip : bool
        Whether to leave out primitives that do not touch the frame.

    Returns
    -------
    Primitives
        Sheet by sheet, each wavelength by wavelength.

    Raises
    ------
    refuse.Refusal
        Where words, bounds or shapes are wrong.
    """
    grids: list[Sheet] = list(sheets) if isinstance(sheets, Sequence) else [sheets]
    how = _How(checked(merge), _crossed(keep), refuse.positive("reach", reach), clip)
    rows = _colour_rows(grids, colours)
    names = list(range(len(grids))) if ghosts is None else list(ghosts)
    refuse.shape_of("ghosts", names, (len(grids),))
    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        found = list(pool.map(lambda grid: _arrange(grid, frame, how), grids))
        ends = np.cumsum([0, *(blocks.found for blocks in found)])
        whole = _empty(int(ends[-1]), np.array([blocks.outside for blocks in found]))
        parts = zip(grids, found, rows, names, ends[:-1].tolist(), strict=True)
        list(pool.map(lambda part: _fill(part, whole), parts))
    return whole


def count(sheets: Sequence[Sheet], frame: Frame, merge: str | Merge = "none", keep: str = "crossed") -> int:
    """Return how many primitives `construct` would make, without making them (Table 5).

    Parameters
    ----------
    sheets : sequence of Sheet
        Rays on a grid over the pupil.
    frame : Frame
        The picture.
    merge : str or Merge
        As in `construct`.
    keep : {"crossed", "valid"}
        As in `construct`.

    Returns
    -------
    int
        Each takes `BYTES` bytes.

    Raises
    ------
    refuse.Refusal
        Where a word or bound is wrong.
    """
    how = _How(checked(merge), _crossed(keep), 1.0, True)
    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        return sum(pool.map(lambda sheet: _arrange(sheet, frame, how).found, sheets))


def checked(merge: str | Merge) -> Merge:
    """Return the bounds that a word stands for, or one's own where they can be served.

    Parameters
    ----------
    merge : str or Merge
        One of `MERGES`, or bounds.

    Returns
    -------
    Merge
        The bounds.

    Raises
    ------
    refuse.Refusal
        Where the word is unknown, a bound is not positive, or there are more than 4 steps.
    """
    if isinstance(merge, str):
        return MERGES[refuse.one_of("merge", merge, MERGES)]
    refuse.one_of("test", merge.test, TESTS)
    refuse.between("steps", refuse.at_least("steps", merge.steps, 0), 0, MOST_STEPS)
    for name in ("gamma", "position", "brightness"):
        refuse.positive(name, getattr(merge, name))
    return merge


def _crossed(keep: str) -> bool:
    return refuse.one_of("keep", keep, ("crossed", "valid")) == "crossed"


def _colour_rows(grids: Sequence[Sheet], colours: Sequence[Sequence[int]] | None) -> list[I32]:
    """Return each sheet's colours, one a wavelength."""
    if colours is None:
        return [np.arange(len(grid.x), dtype=np.int32) for grid in grids]
    if len(colours) != len(grids):
        raise refuse.Refusal(
            f"'colours' must have a row for each of {len(grids)} sheets, got {len(colours)}."
        )
    pairs = zip(grids, colours, strict=True)
    return [refuse.shape_of("colours", row, (len(grid.x),)).astype(np.int32) for grid, row in pairs]


def _arrange(grid: Sheet, frame: Frame, how: _How) -> _Blocks:
    """Return where a sheet's blocks begin: mark its cells, merge them, close cracks, drop what is outside."""
    weight, level = _plain(grid.weight), _plain(grid.level)
    rays = (weight, level, _plain(grid.stop_x), _plain(grid.stop_y))
    reached = np.ascontiguousarray(grid.reached)
    waves, rows, columns = grid.x.shape
    x, y = np.empty(grid.x.shape, dtype=np.float32), np.empty(grid.x.shape, dtype=np.float32)
    sizes = np.empty((waves, rows - 1, columns - 1), dtype=np.int8)
    whole, outside = np.empty(sizes.shape, dtype=np.bool_), np.zeros(waves)
    # Numbers in single precision keep the loops in it.
    height, width = frame.shape
    half: Any = np.array([0.5 * width, 0.5 * height, 1.0 / frame.pitch, how.reach], dtype=np.float32)
    limits = (half[3], how.crossed, how.merge.test == "correct")
    sensor = (_plain(grid.x), _plain(grid.y))
    kernels.mark(sensor, rays, reached, half[:3], limits, x, y, sizes, whole)
    power = _merge(x, y, rays, frame, how.merge, sizes, whole)
    if how.merge.stitch:
        kernels.stitch(x, y, how.merge.steps, sizes)
    if how.clip:
        kernels.drop_outside(x, y, weight, 2 * half[0], 2 * half[1], sizes, outside)
    found = int(np.count_nonzero(sizes >= 0))
    return _Blocks(x, y, rays, reached, sizes, power, float(outside.sum()) * grid.cell, found)


def _merge(
    x: F32, y: F32, rays: Rays, frame: Frame, how: Merge, sizes: NDArray[np.int8], whole: Flags
) -> F32:
    """Merge blocks by one of the tests; return their powers where merging conserves them."""
    bounds: Any = np.array([how.gamma, how.position, how.brightness], dtype=np.float32)
    if how.test == "correct":
        power = np.empty(sizes.shape, dtype=np.float32)
        merging.merge_correct(x, y, rays, how.steps, bounds[1], bounds[2], sizes, whole, power)
        return power
    if how.test == "published":
        units: Any = np.array([2.0 / frame.shape[1], -2.0 / frame.shape[0]], dtype=np.float32)
        merging.merge_published(x, y, how.steps, units, bounds[0], sizes, whole)
    return np.empty((0, 0, 0), dtype=np.float32)


def _plain(values: F32) -> F32:
    return np.ascontiguousarray(values, dtype=np.float32)


def _empty(count: int, outside: NDArray[np.float64]) -> Primitives:
    corners, attributes = np.empty((count, 4, 2), np.float32), np.empty((count, 4, 4), np.float32)
    colour, ghost, size = (np.empty(count, np.int32) for _ in range(3))
    return Primitives(corners, attributes, np.empty(count, np.float32), colour, ghost, size, outside)


def _fill(sheet: tuple[Sheet, _Blocks, I32, int, int], whole: Primitives) -> None:
    """Fill a sheet's part of the primitives."""
    grid, b, colours, ghost, start = sheet
    part = slice(start, start + b.found)
    size = whole.size[part]
    out = whole.corners[part], whole.attributes[part], size, whole.colour[part]
    kernels.fill(b.x, b.y, b.rays, b.reached, b.sizes, b.power, colours, *out)
    np.left_shift(1, size, out=size)
    whole.area[part] = size.astype(np.float32) ** 2 * np.float32(grid.cell)
    whole.ghost[part] = ghost
