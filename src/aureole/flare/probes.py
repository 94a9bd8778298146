"""Coarse rays that find out where in the pupil a ghost's light enters, and how finely it must be sampled.

A ray's merit is how far out it goes: at most 1 where it passes. It changes nearly evenly over the pupil, as
the distance from a circle's middle does; so its change from ray to ray says whether one between may pass.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from aureole.flare import rays as real_rays
from aureole.flare import tracing
from aureole.flare.tracing import Flags, Numbers, Path, Prepared, Rays, Singles

# Rays along each side of the first grid over the front (odd, so that one is in the middle) and of those that
# follow, and how many follow.
COARSE, FINE, ROUNDS = 25, 16, 4
# A lost ray's merit is above 1; beyond the second, merits say nothing of what lies between.
JUST_LOST, FAR = np.float32(1.001), np.float32(3.0)
# A box that has shrunk to less than this part is tried once more.
WORTH = 0.6
# By which part of its side a box grows where light was found at its border.
GROWTH = 0.25
# Fewest cells along a side; numbers of cells are multiples of the second, so that blocks of them merge.
LEAST, MULTIPLE = 16, 4

Values = TypeVar("Values", Singles, Flags)


@dataclass(frozen=True, eq=False)
class Probes:
    """Coarse rays of those paths by which light passes.

    Parameters
    ----------
    lit : ndarray of int, shape (L,)
        Which of the paths.
    boxes : ndarray, shape (L, 4)
        The part of the pupil that holds every ray that passes: least x and y, largest x and y, metres.
    steps : ndarray, shape (L, 2)
        Distance between coarse rays along x and y of the pupil, metres.
    rays : Rays
        Arrays of shape (L, W, FINE, FINE), at up to three of the wavelengths.
    merit : ndarray of float32, shape (L, W, FINE, FINE)
        At most 1 where a ray passes and lands in the window.
    """

    lit: NDArray[np.intp]
    boxes: Numbers
    steps: Numbers
    rays: Rays
    merit: Singles


def probe(
    prepared: Prepared, paths: Sequence[Path], along: Numbers, window: tuple[float, float] | None = None
) -> Probes:
    """Close in on each path's part of the pupil with ever finer grids of rays.

    Parameters
    ----------
    prepared : Prepared
        The lens.
    paths : sequence
        The ways.
    along : ndarray, shape (3,)
        Unit vector of travel, from `aureole.flare.tracing.travel`.
    window : tuple of float, optional
        Half the width and half the height of the part of the sensor, about its middle, that counts; metres.

    Returns
    -------
    Probes
        Without the paths by which no ray was found to pass.
    """
    count = len(prepared.wavelengths)
    middle = tracing.at(prepared, [count // 2])
    boxes, lit = _first(middle, paths, along, window)
    front, growing = whole(prepared, along), np.flatnonzero(lit)
    for _ in range(ROUNDS):
        few, before = [paths[int(k)] for k in growing], boxes[growing]
        near = _near(grid_of(middle, few, before, FINE, along), window, 1.0)
        lit[growing] = np.logical_or.reduce(near, axis=(1, 2))
        boxes[growing] = _around(near, before, 1.0, front)
        # Boxes that no longer shrink are done, unless light was found at their border.
        shrunk = _areas(boxes[growing]) < WORTH * _areas(before)
        growing = growing[lit[growing] & (shrunk | _at_border(near))]
        if not growing.size:
            break
    # The last grid has all wavelengths, the shortest and the longest of many.
    ends = tracing.at(prepared, sorted({0, count // 2, count - 1}))
    left = np.flatnonzero(lit)
    found = grid_of(ends, [paths[int(k)] for k in left], boxes[left], FINE, along)
    merit = _merit(found, window)
    passes = (merit <= 1.0).any(axis=(1, 2, 3))
    tight = _around(_near(found, window, 0.5), boxes[left], 0.5)
    steps = (boxes[left, 2:] - boxes[left, :2]) / (FINE - 1)
    some = np.flatnonzero(passes)
    return Probes(left[some], tight[some], steps[some], found.taken(some), merit[some])


def whole(prepared: Prepared, along: Numbers) -> Numbers:
    """Return the square of the pupil in which all rays cross that meet the front surface.

    Parameters
    ----------
    prepared : Prepared
        The lens.
    along : ndarray, shape (3,)
        Unit vector of travel.

    Returns
    -------
    ndarray, shape (4,)
        Least x and y, largest x and y, metres.
    """
    front = prepared.lens.surfaces[0]
    rim = np.array([[0.0, front.semi_aperture] if front.cylinder == "y" else [front.semi_aperture, 0.0]])
    shapes = real_rays.shapes_of(prepared.lens)
    sag = abs(float(real_rays.sag_of(shapes, np.array([0]), rim)[0][0]))
    slant = max(abs(float(along[0])), abs(float(along[1]))) / float(along[2])
    return (front.semi_aperture + sag * slant) * np.array([-1.001, -1.001, 1.001, 1.001])


def grid_of(prepared: Prepared, paths: Sequence[Path], boxes: Numbers, side: int, along: Numbers) -> Rays:
    """Trace a square grid of rays over each path's box.

    Parameters
    ----------
    prepared : Prepared
        The lens.
    paths : sequence
        G of them.
    boxes : ndarray, shape (G, 4)
        Least x and y, largest x and y, metres.
    side : int
        Rays along each side.
    along : ndarray, shape (3,)
        Unit vector of travel.

    Returns
    -------
    Rays
        Arrays of shape (G, W, side, side), rows along y.
    """
    points = (
        np.concatenate([points_of(box, (side, side)) for box in boxes]) if len(boxes) else np.empty((0, 2))
    )
    found = tracing.follow(prepared, paths, [side * side] * len(paths), points, along)
    return found.part(0, (len(paths), len(prepared.wavelengths), side, side))


def points_of(box: Sequence[float] | Numbers, shape: tuple[int, int]) -> Numbers:
    """Return the points of a regular grid over a box, its outermost ones on the border.

    Parameters
    ----------
    box : sequence of float
        Least x and y, largest x and y, metres.
    shape : tuple of int
        Rows (along y) and columns (along x).

    Returns
    -------
    ndarray, shape (rows * columns, 2)
        (x, y), row after row.
    """
    points = np.empty((*shape, 2))
    points[..., 0] = np.linspace(box[0], box[2], shape[1])
    points[..., 1] = np.linspace(box[1], box[3], shape[0])[:, None]
    return points.reshape(-1, 2)


def shapes_for(probes: Probes, most: int, pitch: float, error: float) -> list[tuple[int, int]]:
    """Return how many rays each path's grid needs, so that points between rays lie where their own rays land.

    Bilinear interpolation over a step h errs by h² f'' / 8; second differences of the coarse rays give f''.
    The edges that surfaces cut are where the level is 1, which is interpolated as well.

    Parameters
    ----------
    probes : Probes
        From `probe`.
    most : int
        Of rays along a side.
    pitch : float
        Width of a pixel, metres.
    error : float
        In the mean of fourth powers, pixels.

    Returns
    -------
    list of tuple of int
        Rows and columns for each.
    """
    found = []
    for axis, (low, high) in ((-2, (1, 3)), (-1, (0, 2))):
        step = probes.steps[:, low]
        strayed = np.maximum(_strayed(probes, axis), _cut(probes, axis)) / pitch
        cells = (probes.boxes[:, high] - probes.boxes[:, low]) / step * np.sqrt(strayed / error)
        whole_blocks = MULTIPLE * np.ceil(np.clip(cells, LEAST, most - 1) / MULTIPLE)
        # Two more for the rim around the box.
        found.append(np.minimum(whole_blocks, most - 1).astype(int) + 1)
    return list(zip(*(sizes.tolist() for sizes in found), strict=True))


def _merit(found: Rays, window: tuple[float, float] | None) -> Singles:
    """Return how far out each ray goes, or lands in the window; for a lost one, how far out it was lost."""
    merit = np.maximum(found.level, np.hypot(found.stop_x, found.stop_y))
    if window is not None:
        beside = np.maximum(np.abs(found.x) / np.float32(window[0]), np.abs(found.y) / np.float32(window[1]))
        merit = np.where(found.reached, np.maximum(merit, beside), merit)
    return np.where(found.reached, merit, np.maximum(merit, JUST_LOST))


def _hopeful(merit: Singles, reached: Flags, reach: float) -> Flags:
    """Return the rays that pass, or one might pass within so many steps of them, by the merit's changes."""
    spread, level = np.zeros_like(merit), np.where(reached, merit, FAR).clip(max=FAR)
    passes = level <= 1.0
    near = passes.copy()
    for axis in (-2, -1):
        first, second = (np.take(passes, range(k, passes.shape[axis] - 1 + k), axis=axis) for k in (0, 1))
        # Where light ends all of a sudden the changes say little.
        near |= _shifted(first, axis, 1) | _shifted(second, axis, 0)
        first, second = (np.take(reached, range(k, passes.shape[axis] - 1 + k), axis=axis) for k in (0, 1))
        change = np.where(first & second, np.abs(np.diff(level, axis=axis)), 0)
        spread += np.maximum(_shifted(change, axis, 1), _shifted(change, axis, 0))
    near |= level - np.float32(reach) * spread <= 1.0
    # Where none passes, the search goes on around the best that arrives, and around the best of all.
    none = ~passes.any(axis=(-2, -1), keepdims=True)
    for values in (level, merit):
        near |= none & (values == values.min(axis=(-2, -1), keepdims=True)) & (values < FAR)
    return np.asarray(near, dtype=np.bool_)


def _shifted(values: Values, axis: int, first: int) -> Values:
    """Return values with one more along an axis, zero: the first or else the last."""
    more = [(0, 0)] * values.ndim
    more[axis] = (first, 1 - first)
    return np.pad(values, more)


def _near(found: Rays, window: tuple[float, float] | None, reach: float) -> Flags:
    """Return where one of the wavelengths passes or might, shape (G, side, side)."""
    hopeful = _hopeful(_merit(found, window), found.reached, reach)
    return np.asarray(np.logical_or.reduce(hopeful, axis=1), dtype=np.bool_)


def _first(
    prepared: Prepared, paths: Sequence[Path], along: Numbers, window: tuple[float, float] | None
) -> tuple[Numbers, Flags]:
    """Return each path's first box, from rays over the whole front, and whether there is any hope."""
    front = whole(prepared, along)
    boxes = np.tile(front, (len(paths), 1))
    found = grid_of(prepared, paths, boxes, COARSE, along)
    dark = np.flatnonzero(~found.passed.any(axis=(1, 2, 3)))
    near = _near(found, window, 1.0)
    lit = np.asarray(np.logical_or.reduce(near, axis=(1, 2)), dtype=np.bool_)
    boxes = _around(near, boxes, 1.0)
    if dark.size:
        # The weakest ghosts enter by a small part of where the image's light does.
        image = _near(grid_of(prepared, [()], front[None], COARSE, along), None, 1.0)
        inner = np.tile(_around(image, front[None], 1.0), (dark.size, 1))
        found = grid_of(prepared, [paths[int(k)] for k in dark], inner, COARSE, along)
        seen = np.flatnonzero(found.passed.any(axis=(1, 2, 3)))
        boxes[dark[seen]] = _around(_near(found.taken(seen), window, 1.0), inner[seen], 1.0)
        lit[dark[seen]] = True
    return boxes, lit


def _around(near: Flags, boxes: Numbers, margin: float, most: Numbers | None = None) -> Numbers:
    """Return boxes around the rays of square grids that are marked, and so many steps more.

    Where `most` is given, a box grows by a quarter beyond a border that is marked, at most to that box.
    """
    side = near.shape[-1]
    steps = (boxes[:, 2:] - boxes[:, :2]) / (side - 1)
    found = np.empty_like(boxes)
    for k, other in ((0, 1), (1, 2)):
        marked = np.logical_or.reduce(near, axis=other)
        first, last = marked.argmax(axis=1), side - 1 - marked[:, ::-1].argmax(axis=1)
        before = margin + (0.0 if most is None else GROWTH * side * (first == 0))
        behind = margin + (0.0 if most is None else GROWTH * side * (last == side - 1))
        found[:, k] = boxes[:, k] + (first - before) * steps[:, k]
        found[:, k + 2] = boxes[:, k] + (last + behind) * steps[:, k]
    if most is not None:
        found[:, :2], found[:, 2:] = np.maximum(found[:, :2], most[:2]), np.minimum(found[:, 2:], most[2:])
    return np.where(np.logical_or.reduce(near, axis=(1, 2))[:, None], found, boxes)


def _at_border(near: Flags) -> Flags:
    """Return whether a ray on the border of its grid is marked."""
    rim = near[:, 0].any(axis=1) | near[:, -1].any(axis=1)
    return np.asarray(rim | near[:, :, 0].any(axis=1) | near[:, :, -1].any(axis=1), dtype=np.bool_)


def _areas(boxes: Numbers) -> Numbers:
    return np.asarray((boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1]))


def _strayed(probes: Probes, axis: int) -> Numbers:
    """Return how far from a straight line between its neighbours' places a ray lands, metres."""
    counts = _inner(_hopeful(probes.merit, probes.rays.reached, 0.5), axis) & _bent(probes.rays.reached, axis)
    x, y = (_second(values, axis) for values in (probes.rays.x, probes.rays.y))
    return _fourth_mean(np.hypot(x, y) / 8.0, counts)


def _cut(probes: Probes, axis: int) -> Numbers:
    """Return how far from its place the edge lies that a surface cuts, where levels are interpolated."""
    level, x, y = probes.rays.level, probes.rays.x, probes.rays.y
    slope = np.hypot(np.gradient(level, axis=-1), np.gradient(level, axis=-2))
    stretch = np.hypot(np.gradient(x, axis=axis), np.gradient(y, axis=axis))
    at_edge = (np.abs(level - 1.0) < slope) & _hopeful(probes.merit, probes.rays.reached, 0.5)
    shift = np.abs(_second(level, axis)) / 8.0 * _inner(stretch / np.maximum(slope, 1e-6), axis)
    return _fourth_mean(shift, _inner(at_edge, axis) & _bent(probes.rays.reached, axis))


def _second(values: Singles, axis: int) -> Singles:
    """Return second differences along an axis."""
    return np.diff(values, n=2, axis=axis)


def _inner(values: Any, axis: int) -> Any:
    """Leave the first and the last along an axis out."""
    return np.take(values, range(1, values.shape[axis] - 1), axis=axis)


def _bent(reached: Flags, axis: int) -> Flags:
    """Return where a ray and both its neighbours arrived."""
    last = reached.shape[axis]
    parts = (np.take(reached, range(k, last - 2 + k), axis=axis) for k in range(3))
    return np.asarray(np.logical_and.reduce(list(parts)), dtype=np.bool_)


def _fourth_mean(values: NDArray[np.floating], counts: Flags) -> Numbers:
    """Return the fourth root of the mean of fourth powers of those that count, for each path."""
    fourth = np.where(counts, values, 0.0).astype(np.float64) ** 4
    number = np.maximum(counts.sum(axis=(1, 2, 3)), 1)
    return np.asarray((fourth.sum(axis=(1, 2, 3)) / number) ** 0.25)
