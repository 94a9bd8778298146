"""Where rays must enter to make a ghost, and regular grids of rays there.

Few of the rays that meet the front of a lens come through by a ghost's way (2 to 30 %). `bounds` finds the
rectangle of the pupil that holds them all; `sheets` lays a grid over it for each ghost, no finer than needed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from aureole import refuse
from aureole.flare import probes, tracing
from aureole.flare.tracing import Flags, Landed, Numbers, Path, Prepared, Singles

if TYPE_CHECKING:
    from aureole.flare.primitives import Frame

ADAPTS = ("bounds", "paper")
# The tile paper's numbers in Eq. 13: the least part of the base grid, and the power of the ratio of areas.
PAPER_LEAST, PAPER_POWER = 0.05, 0.5


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
class Sheet(Landed):
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
    found = probes.probe(prepared, [path], tracing.travel(direction))
    return Rectangle(*found.boxes[0].tolist()) if len(found.lit) else None


def sheets(
    prepared: Prepared,
    paths: Sequence[Path],
    direction: ArrayLike,
    base: int = 64,
    adapt: str = "bounds",
    frame: "Frame | None" = None,
    error: float = 0.25,
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
        Rays along each side; the most of them where `frame` is given.
    adapt : {"bounds", "paper"}
        Over each ghost's own part of the pupil, or over the whole front of the lens with as many rays as the
        tile paper's Eq. 13 asks for: base · min(max((ghost's area / sensor's area)^½, 0.05), 1).
    frame : Frame, optional
        The picture. With "bounds" each ghost gets only the part of the pupil that lands on it, and only so
        many rays that points between them lie where they should.
    error : float
        How far such a point may lie off, pixels; in the mean of fourth powers.

    Returns
    -------
    list of Sheet
        In the order of the paths.

    Raises
    ------
    refuse.Refusal
        Where the light stands behind the lens, a path is no way through it, or the base is below 5.
    """
    refuse.one_of("adapt", adapt, ADAPTS)
    most = refuse.at_least("base", base, 5)
    refuse.positive("error", error)
    along = tracing.travel(direction)
    window = _window(frame) if adapt == "bounds" else None
    found = probes.probe(prepared, paths, along, window)
    if adapt == "paper":
        shapes = _paper_shapes(found, prepared.lens.sensor, most)
        boxes = np.tile(probes.whole(prepared, along), (len(shapes), 1))
    else:
        shapes = [(most, most)] * len(found.lit)
        if frame is not None:
            shapes = probes.shapes_for(found, most, frame.pitch, error)
        boxes = _widened(found.boxes, np.array(shapes).reshape(-1, 2))
    return _traced(prepared, [paths[k] for k in found.lit], boxes, shapes, along)


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
    inside = _inside(made[0].radius)
    return np.asarray(np.sum(inside * made[0].weight, axis=(1, 2), dtype=np.float64) * made[0].cell)


def _window(frame: "Frame | None") -> tuple[float, float] | None:
    """Return half the width and height of the picture, and half a pixel for what straddles its border."""
    if frame is None:
        return None
    rows, columns = frame.shape
    return (columns + 1) * frame.pitch / 2, (rows + 1) * frame.pitch / 2


def _paper_shapes(found: probes.Probes, sensor: tuple[float, float], base: int) -> list[tuple[int, int]]:
    """Return the sizes of the tile paper's grids (Eq. 13 with σ = 1 and φ = 1/2)."""
    passed = found.merit <= 1.0
    spans = []
    for values in (found.rays.x, found.rays.y):
        least = np.where(passed, values, np.inf).min(axis=(1, 2, 3))
        spans.append(np.where(passed, values, -np.inf).max(axis=(1, 2, 3)) - least)
    part = (spans[0] * spans[1] / (sensor[0] * sensor[1])) ** PAPER_POWER
    sides = np.rint(base * np.clip(part, PAPER_LEAST, 1.0)).astype(int)
    return [(side, side) for side in sides.tolist()]


def _widened(boxes: Numbers, shapes: Numbers) -> Numbers:
    """Return boxes with one more cell on each side, so that what an edge cuts can be interpolated."""
    cells = np.column_stack([shapes[:, 1], shapes[:, 0]]) - 3.0
    more = (boxes[:, 2:] - boxes[:, :2]) / cells
    return np.concatenate([boxes[:, :2] - more, boxes[:, 2:] + more], axis=1)


def _traced(
    prepared: Prepared,
    paths: Sequence[Path],
    boxes: Numbers,
    shapes: Sequence[tuple[int, int]],
    along: Numbers,
) -> list[Sheet]:
    """Trace a grid over each path's box."""
    if not paths:
        return []
    counts = [rows * columns for rows, columns in shapes]
    points = np.concatenate([probes.points_of(box, shape) for box, shape in zip(boxes, shapes, strict=True)])
    found = tracing.follow(prepared, paths, counts, points, along)
    made, first, waves = [], 0, len(prepared.wavelengths)
    for path, box, (rows, columns) in zip(paths, boxes.tolist(), shapes, strict=True):
        part = found.part(first, (waves, rows, columns))
        first += waves * rows * columns
        cell = (box[2] - box[0]) / (columns - 1) * (box[3] - box[1]) / (rows - 1) * float(along[2])
        values = part.x, part.y, part.weight, part.level, part.stop_x, part.stop_y, part.reached
        made.append(Sheet(path, *values, cell, Rectangle(*box)))
    return made


def _inside(radius: Singles) -> Singles:
    """Return which part of the cell around each ray passes, from how far out it goes and its slopes."""
    near = np.minimum(radius, 3.0)
    slope = np.abs(np.gradient(near, axis=1)) + np.abs(np.gradient(near, axis=2))
    return np.asarray(np.clip(0.5 + (1.0 - radius) / np.maximum(slope, 1e-9), 0.0, 1.0), dtype=np.float32)
