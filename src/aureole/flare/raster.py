"""Rasters: the picture of primitives, each laid on its own or gathered in tiles.

A primitive carries its part of the pupil's power times what the lens lets through, spread over its quad as
the bilinear map of the cell spreads it: power a pixel is area · Σ b w / Σ b J, with b the barycentric
coordinates of the place, w the corners' weights, and J the areas of the parallelograms at the corners. Where
the level or the distance from the stop's middle passes 1, light ends; that edge is antialiased. Quads that
are concave, cross themselves, or are smaller than a pixel, as at caustics, are laid as samples that share out
their power exactly.

`reference` lays quad after quad, ghost after ghost, over the whole picture (Hullin et al. 2011). `tiles`
first lists the primitives of each tile, by coarse tiles and dense ones (Bodonyi and Kunkli 2023, sections
4.3-4.5, Algorithms 2-3), and sums up all that is of one colour before it is coloured.
"""

import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.flare import _kernels_raster as layers
from aureole.flare import _kernels_raster_points as points
from aureole.flare import _kernels_raster_prepare as numbers
from aureole.flare import _kernels_raster_tiles as kernels
from aureole.flare import barycentric
from aureole.flare.primitives import Frame, Primitives

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]

METHODS = ("auto", "reference", "tiles")
# Ours covers pixels by area; the others ask at their middles, with the coordinates of the tile paper.
COORDINATES = ("auto", "coverage", *barycentric.METHODS)
# Sides of coarse and dense tiles, pixels.
COARSE, DENSE = 128, 64
# Blocks in which kernels keep pixels, and in how many bands the reference cuts the picture.
BLOCK, BANDS = 8, 8
# Parts into which the work of each thread is cut, so that none waits long for another.
PARTS = 4


@dataclass(frozen=True)
class Effort:
    """What a raster did, for benches.

    Parameters
    ----------
    prepare, coarse, dense, traversal : float
        Seconds for the primitives' numbers, the lists of coarse tiles and of dense tiles, and the pixels.
    coarse_indices, dense_indices : int
        Primitives' numbers in all lists, 4 bytes each.
    memory : int
        Bytes held beside the primitives and the picture: numbers, lists, and one tile a thread.
    """

    prepare: float
    coarse: float
    dense: float
    traversal: float
    coarse_indices: int
    dense_indices: int
    memory: int


class _Lists(NamedTuple):
    """Windows of the picture and the primitives that touch each."""

    windows: I32
    starts: I64
    items: I32


class _Prepared(NamedTuple):
    """What the kernels know of primitives."""

    table: F32
    boxes: I32
    kinds: NDArray[np.int8]


def rasterize(
    primitives: Primitives,
    colours: ArrayLike,
    frame: Frame,
    method: str = "auto",
    coordinates: str = "auto",
    iris: ArrayLike | None = None,
    tiles: tuple[int | None, int] = (COARSE, DENSE),
) -> F32:
    """Return the picture of primitives.

    Parameters
    ----------
    primitives : Primitives
        Quads in pixels, from `construct`.
    colours : array_like, shape (K, 3)
        Colour of a power of 1, for each number in `primitives.colour`.
    frame : Frame
        The picture.
    method : {"auto", "reference", "tiles"}
        "auto" is tiles.
    coordinates : {"auto", "coverage", "triangle", "homogeneous", "mean-value", ...}
        How a pixel's part and the numbers inside a quad are found. "coverage" is ours: how much of the pixel
        the quad covers, and planes or the undone bilinear map. The others decide by the pixel's middle, and
        take the numbers by barycentric coordinates. "auto" is coverage: it keeps power where quads are small,
        and its loops have no branches, so that it is the fastest, too.
    iris : array_like, shape (rows, columns), optional
        Transmission over the square [-1, 1]² of the stop's plane, x along columns and y along rows, bilinear
        between samples, 0 outside; otherwise the iris is round.
    tiles : tuple of int
        Sides of the coarse and the dense tiles, pixels, multiples of 8, the coarse one of the dense one;
        None for no coarse tiles. The paper's are (128, 8).

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Power a pixel in each colour's channel, m² times the colour's unit.

    Raises
    ------
    refuse.Refusal
        Where a word or a shape is wrong, a number is not finite, or colours are missing.
    """
    return rasterize_timed(primitives, colours, frame, method, coordinates, iris, tiles)[0]


def rasterize_timed(
    primitives: Primitives,
    colours: ArrayLike,
    frame: Frame,
    method: str = "auto",
    coordinates: str = "auto",
    iris: ArrayLike | None = None,
    tiles: tuple[int | None, int] = (COARSE, DENSE),
) -> tuple[F32, Effort]:
    """Return the picture of primitives, and what it took.

    Parameters
    ----------
    primitives : Primitives
        As for `rasterize`, and so are the others.
    colours : array_like, shape (K, 3)
        Of a power of 1.
    frame : Frame
        The picture.
    method : {"auto", "reference", "tiles"}
        How.
    coordinates : str
        Inside a quad.
    iris : array_like, shape (rows, columns), optional
        Transmission of the stop.
    tiles : tuple of int
        Sides of the coarse and the dense tiles.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        The picture.
    Effort
        Times, counts and memory.

    Raises
    ------
    refuse.Refusal
        As for `rasterize`.
    """
    tiled = refuse.one_of("method", method, METHODS) != "reference"
    inside = refuse.one_of("coordinates", coordinates, COORDINATES)
    palette, mask, sides = _checked(primitives, colours, iris, tiles)
    clock = [time.perf_counter()]
    ready = _prepare(primitives, mask, frame)
    clock.append(time.perf_counter())
    drawn = np.flatnonzero(ready.kinds).astype(np.int32)
    if tiled:
        # One colour after the other, so that each is summed before it is coloured.
        drawn = drawn[np.argsort(primitives.colour[drawn].astype(np.uint16), kind="stable")]
        passes = primitives.colour
        coarse = _coarse(ready.boxes, drawn, frame, sides[0])
        clock.append(time.perf_counter())
        lists = _dense(ready.boxes, coarse, sides[1])
    else:
        passes = _passes(primitives)
        coarse = lists = _bands(ready.boxes, drawn, frame)
        clock.append(clock[-1])
    clock.append(time.perf_counter())
    picture = np.empty((*frame.shape, 3), dtype=np.float32)
    arrays = (primitives.corners, primitives.attributes, primitives.area, passes, primitives.colour)
    sweep: Any = kernels.sweep
    known: tuple[Any, ...] = (*ready, *arrays, palette, mask)
    if inside in barycentric.METHODS:
        sweep, way = points.sweep_points, list(barycentric.METHODS).index(inside)
        known = (ready.kinds, ready.boxes, *arrays, palette, mask, way)
    _in_parts(lambda first, last: sweep(*known, *lists, first, last, picture), len(lists.windows))
    clock.append(time.perf_counter())
    preparing, listing, refining, laying = np.diff(clock).tolist()
    sizes = len(coarse.items), len(lists.items)
    return picture, Effort(preparing, listing, refining, laying, *sizes, _memory(ready, coarse, lists))


def tile_indices(
    primitives: Primitives, frame: Frame, tiles: tuple[int | None, int] = (COARSE, DENSE)
) -> tuple[int, int]:
    """Return how many primitives' numbers all coarse and all dense tiles hold (the paper's Table 6).

    Parameters
    ----------
    primitives : Primitives
        Quads in pixels.
    frame : Frame
        The picture.
    tiles : tuple of int
        As for `rasterize`.

    Returns
    -------
    int, int
        Of coarse and of dense tiles, by the primitives' bounding boxes; 4 bytes each.

    Raises
    ------
    refuse.Refusal
        As for `rasterize`.
    """
    palette = np.ones((int(primitives.colour.max(initial=0)) + 1, 3))
    _, mask, sides = _checked(primitives, palette, None, tiles)
    ready = _prepare(primitives, mask, frame)
    coarse = _coarse(ready.boxes, np.flatnonzero(ready.kinds).astype(np.int32), frame, sides[0])
    return len(coarse.items), len(_dense(ready.boxes, coarse, sides[1]).items)


def _checked(
    primitives: Primitives, colours: ArrayLike, iris: ArrayLike | None, tiles: tuple[int | None, int]
) -> tuple[F32, F32, tuple[int, int]]:
    """Return the colours, the iris (0, 0 for a round one) and the tiles' sides as kernels want them."""
    palette = refuse.all_finite("colours", refuse.shape_of("colours", colours, (None, 3)))
    most = int(primitives.colour.max(initial=-1))
    if most >= len(palette):
        raise refuse.Refusal(f"'colours' must have a row for each of {most + 1} colours, got {len(palette)}.")
    for name in ("corners", "attributes", "area"):
        # A sum is finite only where every number is.
        if not np.isfinite(np.sum(getattr(primitives, name), dtype=np.float64)):
            raise refuse.Refusal(f"'primitives' must be finite, got {name} that are not.")
    mask = np.zeros((0, 0), dtype=np.float32)
    if iris is not None:
        mask = refuse.all_finite("iris", refuse.shape_of("iris", iris, (None, None)))
    sides = (tiles[1] if tiles[0] is None else tiles[0]), tiles[1]
    if sides[1] < BLOCK or sides[1] % BLOCK or sides[0] % sides[1]:
        raise refuse.Refusal(
            f"'tiles' must be multiples of {BLOCK}, the coarse one of the dense one, got {tiles}."
        )
    return _plain(palette), _plain(mask), sides


def _plain(values: ArrayLike) -> F32:
    return np.ascontiguousarray(values, dtype=np.float32)


def _in_parts(task: Callable[[int, int], None], count: int) -> None:
    """Do a task for parts of a range in all threads; what a part does depends on no other."""
    threads = os.cpu_count() or 1
    edges = np.linspace(0, count, min(count, PARTS * threads) + 1).astype(int).tolist()
    with ThreadPoolExecutor(max_workers=threads) as pool:
        list(pool.map(task, edges[:-1], edges[1:]))


def _prepare(primitives: Primitives, iris: F32, frame: Frame) -> _Prepared:
    """Return what each primitive is, the pixels it touches, and its numbers."""
    count = len(primitives.area)
    ready = _Prepared(
        np.empty((count, int(layers.ROW)), np.float32),
        np.zeros((count, 4), np.int32),
        np.empty(count, np.int8),
    )
    # Sums over an iris tell at once whether all of a rectangle is open, or closed.
    opened = np.zeros((2, iris.shape[0] + 1, iris.shape[1] + 1), dtype=np.int32)
    for k, wanted in enumerate((1.0, 0.0)):
        opened[k, 1:, 1:] = np.cumsum(np.cumsum(iris == wanted, axis=0, dtype=np.int32), axis=1)
    arrays = primitives.corners, primitives.attributes, primitives.area, primitives.size, opened
    size = np.array([frame.shape[1], frame.shape[0]], dtype=np.int32)
    _in_parts(lambda start, stop: numbers.prepare(*arrays, size, start, stop, *ready), count)
    return ready


def _passes(primitives: Primitives) -> I32:
    """Return numbers that change with the ghost and the colour."""
    ghost, colour = np.diff(primitives.ghost, prepend=0), np.diff(primitives.colour, prepend=0)
    return np.cumsum((ghost != 0) | (colour != 0), dtype=np.int32)


def _bands(boxes: I32, drawn: I32, frame: Frame) -> _Lists:
    """Return bands of the picture and the primitives that touch each."""
    rows, columns = frame.shape
    high = BLOCK * -(-rows // (BANDS * BLOCK))
    everything = np.array([[0, 0, columns, rows]], dtype=np.int32)
    return _listed(boxes, _Lists(everything, np.array([0, len(drawn)]), drawn), (high, columns))


def _coarse(boxes: I32, drawn: I32, frame: Frame, side: int) -> _Lists:
    """Return coarse tiles and the primitives that touch each."""
    everything = np.array([[0, 0, frame.shape[1], frame.shape[0]]], dtype=np.int32)
    return _listed(boxes, _Lists(everything, np.array([0, len(drawn)]), drawn), (side, side))


def _dense(boxes: I32, coarse: _Lists, side: int) -> _Lists:
    """Return dense tiles and the primitives that touch each, from the coarse tiles' lists."""
    if len(coarse.windows) == 0 or side == int((coarse.windows[0, 2:] - coarse.windows[0, :2]).max()):
        return coarse
    return _listed(boxes, coarse, (side, side))


def _listed(boxes: I32, groups: _Lists, side: tuple[int, int]) -> _Lists:
    """Cut each group's window into tiles, and list which of its primitives touch each."""
    wide, high = (int((groups.windows[:, 2 + k] - groups.windows[:, k]).max()) for k in range(2))
    across, down = -(-wide // side[1]), -(-high // side[0])
    tile = np.array([*side, across], dtype=np.int32)
    counts = np.empty((len(groups.windows), across * down), dtype=np.int64)

    def count(first: int, last: int) -> None:
        part = groups.starts[first : last + 1], groups.windows[first:last]
        kernels.count(boxes, groups.items, *part, tile, counts[first:last])

    def fill(first: int, last: int) -> None:
        part = groups.starts[first : last + 1], groups.windows[first:last]
        kernels.fill(boxes, groups.items, *part, tile, places[first:last], items)

    _in_parts(count, len(counts))
    starts = np.concatenate([[0], np.cumsum(counts)])
    places, items = starts[:-1].reshape(counts.shape).copy(), np.empty(starts[-1], dtype=np.int32)
    _in_parts(fill, len(counts))
    # Tiles that lie wholly outside the picture are empty, and have no pixels.
    top, left = (edge.ravel() for edge in np.mgrid[: down * side[0] : side[0], : across * side[1] : side[1]])
    corner = np.stack([left, top, left + side[1], top + side[0]], axis=1)
    windows = np.minimum(
        groups.windows[:, None, [0, 1, 0, 1]] + corner, groups.windows[:, None, [2, 3, 2, 3]]
    )
    return _Lists(windows.reshape(-1, 4).astype(np.int32), starts, items)


def _memory(ready: _Prepared, coarse: _Lists, lists: _Lists) -> int:
    """Return how many bytes the kernels' numbers take: primitives, lists, and a window a thread."""
    wide = lists.windows[:, 2:] - lists.windows[:, :2]
    window = 16 * int(np.prod(wide, axis=1).max()) * (os.cpu_count() or 1)
    kept = {id(each): each.nbytes for each in (*ready, *coarse, *lists)}
    return sum(kept.values()) + window
