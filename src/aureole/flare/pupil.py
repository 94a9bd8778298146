"""Where rays must enter to make a ghost, and grids of rays there.

Few of the rays that meet the front of a lens come through by a ghost's way (2 to 30 %). `bounds` finds the
rectangle of the pupil that holds them all; `sheets` lays a regular grid over it for each ghost.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.flare import rays, tracing
from aureole.flare.tracing import Flags, Numbers, Path, Prepared, Rays, Singles

ADAPTS = ("bounds", "paper")
# Rays along each side of the first grid over the front, of the following ones, and how many follow.
COARSE, FINE, ROUNDS = 48, 24, 4
# A ray that did not arrive counts as this far outside.
LOST = 1e3


class Rectangle(NamedTuple):
    """A part of the pupil, metres.

    Parameters
    ----------
    left, top, right, bottom : float
        Least x and y, largest x and y.
    """

    left: float
    top: float
    right: float
    bottom: float


@dataclass(frozen=True, eq=False)
class Sheet:
    """A ghost's regular grid of rays as it lands on the sensor.

    Parameters
    ----------
    path : GhostPath or sequence of int
        The way.
    x, y : ndarray of float32, shape (W, rows, columns)
        On the sensor, metres, for rows along the pupil's y and columns along its x.
    weight, level, stop_x, stop_y : ndarray of float32, shape (W, rows, columns)
        As in `Rays`.
    reached : ndarray of bool, shape (W, rows, columns)
        As in `Rays`.
    cell : float
        Area of the light's cross-section that each cell between four rays stands for, m²: Δx Δy cos θ.
    rectangle : Rectangle, optional
        Where the grid's outermost rays cross the pupil.
    """

    path: Path
    x: Singles
    y: Singles
    weight: Singles
    level: Singles
    stop_x: Singles
    stop_y: Singles
    reached: Flags
    cell: float
    rectangle: Rectangle | None = None

    @property
    def passed(self) -> Flags:
        """Whether each ray reached the sensor through all semi-apertures and a round iris."""
        return self.reached & (self.level <= 1.0) & (self.stop_x**2 + self.stop_y**2 <= 1.0)


def bounds(prepared: Prepared, path: Path, direction: ArrayLike) -> Rectangle | None:
    """Return a rectangle of the pupil that holds every ray that passes by a way.

    Parameters
    ----------
    prepared : Prepared
        The lens, from `aureole.flare.tracing.prepare`.
    path : GhostPath or sequence of int
        The reflections; () is the image.
    direction : array_like, shape (3,)
        From the lens towards the light, z > 0.

    Returns
    -------
    Rectangle or None
        None where no ray passes.

    Raises
    ------
    refuse.Refusal
        Where the light stands behind the lens, or the reflections are no way through it.
    """
    return all_bounds(prepared, [path], direction)[0]


def all_bounds(prepared: Prepared, paths: Sequence[Path], direction: ArrayLike) -> list[Rectangle | None]:
    """Return what `bounds` does, for many ways at a time.

    Parameters
    ----------
    prepared : Prepared
        The lens.
    paths : sequence
        The ways.
    direction : array_like, shape (3,)
        From the lens towards the light, z > 0.

    Returns
    -------
    list of Rectangle or None
        One a way.
    """
    along = tracing.travel(direction)
    half = _reach(prepared, along)
    boxes = np.tile([-half, -half, half, half], (len(paths), 1))
    found = np.zeros(len(paths), dtype=bool)
    open_ = np.arange(len(paths))
    for turn in range(ROUNDS):
        side = FINE if turn else COARSE
        boxes[open_], keep, found[open_] = _narrowed(prepared, paths, boxes, open_, along, side)
        open_ = open_[keep]
        if not len(open_):
            break
    return [Rectangle(*map(float, box)) if hit else None for box, hit in zip(boxes, found, strict=True)]


def sheets(
    prepared: Prepared,
    paths: Sequence[Path],
    direction: ArrayLike,
    base: int = 64,
    adapt: str = "bounds",
) -> list[Sheet]:
    """Trace a regular grid of rays for each of many ghosts.

    Parameters
    ----------
    prepared : Prepared
        The lens.
    paths : sequence
        The ways; those by which no ray passes have no sheet.
    direction : array_like, shape (3,)
        From the lens towards the light, z > 0.
    base : int
        Rays along each side.
    adapt : {"bounds", "paper"}
        Over each ghost's own part of the pupil, or over the whole front of the lens as in the tile paper.

    Returns
    -------
    list of Sheet
        In the order of the paths.

    Raises
    ------
    refuse.Refusal
        Where the light stands behind the lens, a path is no way through it, or the base is below 2.
    """
    refuse.one_of("adapt", adapt, ADAPTS)
    side = refuse.at_least("base", base, 2)
    along = tracing.travel(direction)
    boxes = all_bounds(prepared, paths, direction)
    lit = [k for k, box in enumerate(boxes) if box is not None]
    half = _reach(prepared, along)
    whole = Rectangle(-half, -half, half, half)
    used = [whole if adapt == "paper" else boxes[k] or whole for k in lit]
    points = _grids(np.array(used).reshape(-1, 4), side)
    chosen = [paths[k] for k in lit]
    found = tracing.follow(prepared, chosen, points, along)
    pairs = enumerate(zip(chosen, used, strict=True))
    return [_sheet(path, tracing.taken(found, k), box, side, along) for k, (path, box) in pairs]


def image_power(prepared: Prepared, direction: ArrayLike, side: int = 256) -> Numbers:
    """Return the power that reaches the sensor by the image's way, over the light's irradiance.

    Parameters
    ----------
    prepared : Prepared
        The lens.
    direction : array_like, shape (3,)
        From the lens towards the light, z > 0.
    side : int
        Rays along each side of the grid.

    Returns
    -------
    ndarray, shape (W,)
        m², for a round iris: the bundle's cross-section times what the surfaces let through; 0 where the lens
        is dark.

    Raises
    ------
    refuse.Refusal
        Where the light stands behind the lens.
    """
    made = sheets(prepared, [()], direction, base=side)
    if not made:
        return np.zeros(len(prepared.wavelengths))
    sheet = made[0]
    inside = _inside(_merit(sheet))
    return np.asarray(np.sum(inside * sheet.weight, axis=(1, 2), dtype=np.float64) * sheet.cell)


def _sheet(path: Path, found: Rays, box: Rectangle, side: int, along: Numbers) -> Sheet:
    """Return one path's rays as a sheet of as many columns as rows."""
    cell = (box.right - box.left) * (box.bottom - box.top) / (side - 1) ** 2 * float(along[2])
    shape = (-1, side, side)
    x, y, weight, level = (part.reshape(shape) for part in (found.x, found.y, found.weight, found.level))
    stop_x, stop_y = found.stop_x.reshape(shape), found.stop_y.reshape(shape)
    return Sheet(path, x, y, weight, level, stop_x, stop_y, found.reached.reshape(shape), cell, box)


def _reach(prepared: Prepared, along: Numbers) -> float:
    """Return half the side of a square of the pupil in which all rays cross that meet the front surface."""
    front = prepared.lens.surfaces[0]
    shapes = rays.shapes_of(prepared.lens)
    rim = np.array([[front.semi_aperture * (1.0 if front.cylinder != "y" else 0.0), 0.0, 0.0]])
    rim[0, 1] = front.semi_aperture if front.cylinder == "y" else 0.0
    sag = abs(float(rays.sag_of(shapes, np.array([0]), rim)[0][0]))
    slant = max(abs(float(along[0])), abs(float(along[1]))) / float(along[2])
    return (front.semi_aperture + sag * slant) * 1.001


def _narrowed(
    prepared: Prepared,
    paths: Sequence[Path],
    boxes: Numbers,
    open_: NDArray[np.int64],
    along: Numbers,
    side: int,
) -> tuple[Numbers, Flags, Flags]:
    """Return boxes around what passes, which of them may shrink further, and where something passes."""
    points = _grids(boxes[open_], side)
    found = tracing.follow(prepared, [paths[k] for k in open_], points, along)
    merit = _merit(found)
    # Rays pass at any of the wavelengths.
    merit = merit.min(axis=1).reshape(-1, side, side)
    near = _hopeful(merit)
    step = (boxes[open_, 2:] - boxes[open_, :2]) / (side - 1)
    fresh = np.empty((len(open_), 4))
    for axis, other in ((0, 1), (1, 2)):
        lit = np.asarray(near.any(axis=other), dtype=np.bool_)
        first, last = lit.argmax(axis=1), side - 1 - lit[:, ::-1].argmax(axis=1)
        fresh[:, axis] = boxes[open_, axis] + (first - 1) * step[:, axis]
        fresh[:, axis + 2] = boxes[open_, axis] + (last + 1) * step[:, axis]
    fresh[:, :2] = np.maximum(fresh[:, :2], boxes[open_, :2] - step)
    old_area = np.prod(boxes[open_, 2:] - boxes[open_, :2], axis=1)
    area = np.prod(fresh[:, 2:] - fresh[:, :2], axis=1)
    passes = merit.min(axis=(1, 2)) <= 1.0
    alive = np.asarray(near.any(axis=(1, 2)), dtype=np.bool_)
    return np.where(alive[:, None], fresh, boxes[open_]), alive & (area < 0.7 * old_area), passes


def _hopeful(merit: Singles) -> Flags:
    """Return the rays that pass or next to which one might, by how fast the merit changes there."""
    spread = np.zeros_like(merit)
    arrived = merit < LOST
    for axis in (1, 2):
        change = np.abs(np.diff(merit, axis=axis))
        both = np.delete(arrived, 0, axis=axis) & np.delete(arrived, -1, axis=axis)
        change = np.where(both, change, 0.0)
        low, high = [(0, 0)] * 3, [(0, 0)] * 3
        low[axis], high[axis] = (1, 0), (0, 1)
        spread += np.maximum(np.pad(change, low), np.pad(change, high))
    return np.asarray(merit - spread <= 1.0, dtype=np.bool_)


def _merit(found: Rays | Sheet) -> Singles:
    """Return how far each ray lies from the outermost one that passes: 1 on the rim."""
    radius = np.maximum(found.level, np.hypot(found.stop_x, found.stop_y))
    return np.where(found.reached, radius, np.float32(LOST))


def _inside(merit: Singles) -> Singles:
    """Return which part of the cell around each ray passes, from the merit and its slopes."""
    near = np.minimum(merit, 3.0)
    slope = np.abs(np.gradient(near, axis=1)) + np.abs(np.gradient(near, axis=2))
    return np.asarray(np.clip(0.5 + (1.0 - merit) / np.maximum(slope, 1e-9), 0.0, 1.0), dtype=np.float32)


def _grids(boxes: Numbers, side: int) -> Numbers:
    """Return the points of a regular grid over each box, shape (G, side * side, 2), rows along y."""
    part = np.linspace(0.0, 1.0, side)
    x = boxes[:, :1] + part * (boxes[:, 2:3] - boxes[:, :1])
    y = boxes[:, 1:2] + part * (boxes[:, 3:4] - boxes[:, 1:2])
    points = np.empty((len(boxes), side, side, 2))
    points[..., 0], points[..., 1] = x[:, None, :], y[:, :, None]
    return points.reshape(len(boxes), side * side, 2)
