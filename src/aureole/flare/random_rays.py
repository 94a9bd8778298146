"""The energy of a ghost by chance: rays anywhere over the lens's front, each followed on its own.

The truth for the energies that sheets of rays and rendered pictures give: it knows nothing of cells,
edges or pixels. One ray falls at a random place of each cell of a fine grid over all of the first surface,
so that the mean of what the rays carry has no bias and little noise.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.flare import paraxial, tracing
from aureole.flare.ghost_paths import GhostPath
from aureole.flare.glass import D_LINE
from aureole.flare.lint import sag
from aureole.flare.prescription import Lens
from aureole.flare.rays import power, trace_reference

METHODS = ("compiled", "reference")
# How many rays are followed at once: their arrays stay below 100 MB by either method.
CHUNK = {"compiled": 1 << 18, "reference": 1 << 15}
RIM_HEIGHTS = 65

Numbers = NDArray[np.float64]
Direction = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Estimate:
    """What a ghost carries for each unit of irradiance of the light.

    Parameters
    ----------
    energy, error : ndarray, shape (W,)
        Power that reaches the sensor's plane over the irradiance, m², and its standard error.
    in_frame, in_frame_error : ndarray, shape (W,)
        The part that falls on the sensor, and its standard error, m².
    hits : ndarray of int, shape (W,)
        How many rays came through.
    rays : int
        How many were sent at each wavelength.
    picture : ndarray of float32, shape (W, rows, columns), or None
        Power over irradiance of each pixel of the frame, m².
    """

    energy: Numbers
    error: Numbers
    in_frame: Numbers
    in_frame_error: Numbers
    hits: NDArray[np.int64]
    rays: int
    picture: NDArray[np.float32] | None = None


class _Arrived(NamedTuple):
    """Rays at the sensor's plane, (N,) each: metres, and the part of their power that is left."""

    x: Numbers
    y: Numbers
    weight: Numbers


Follow = Callable[[Numbers], _Arrived]


def monte_carlo(
    lens: Lens,
    path: GhostPath | Sequence[int],
    direction: Direction,
    wavelengths: ArrayLike = D_LINE,
    rays: int = 10**6,
    seed: int = 0,
    f_number: float | None = None,
    shape: tuple[int, int] | None = None,
    method: str = "compiled",
) -> Estimate:
    """Return the energy of a ghost, or of the light's own image, by random rays.

    Parameters
    ----------
    lens : Lens
        The lens.
    path : GhostPath or sequence of int
        The ghost, or its reflections; () is the image.
    direction : tuple of float
        Unit vector from the lens towards the light: x to the right, y downward, z forward.
    wavelengths : array_like, shape (W,)
        Metres.
    rays : int
        How many to send at each wavelength, about.
    seed : int
        Of the random numbers.
    f_number : float, optional
        Wide open without it.
    shape : tuple of int, optional
        Rows and columns of the picture to make, too; its width is the sensor's.
    method : {"compiled", "reference"}
        Which tracer follows the rays.

    Returns
    -------
    Estimate
        Cells of the grid are compared with their neighbours for the standard error, which is so rather
        too large than too small.

    Raises
    ------
    refuse.Refusal
        Where the light is not in front of the lens, or a number is out of its range.
    """
    refuse.one_of("method", method, METHODS)
    refuse.at_least("rays", rays, 4)
    heading = tracing.travel(direction)
    reflections = tracing.reflections(path)
    waves = np.atleast_1d(np.asarray(wavelengths, dtype=np.float64))
    stopped = stopped_down(lens, f_number)
    low, high = front(lens, direction)
    cells = _grid(rays, high - low)
    density = float(np.prod(high - low)) * heading[2] / (cells[0] * cells[1])
    tally = _Tally(len(waves), lens.sensor, shape, density)
    tracer = _compiled if method == "compiled" else _reference
    for k, wave in enumerate(waves):
        follow = tracer(stopped, reflections, direction, float(wave))
        chance = np.random.default_rng([seed, k])
        for points in _scattered(low, high, cells, CHUNK[method], chance):
            tally.add(k, follow(points))
    return tally.estimate(cells[0] * cells[1])


def stopped_down(lens: Lens, f_number: float | None) -> Lens:
    """Return the lens with its iris closed to an f-number.

    Parameters
    ----------
    lens : Lens
        The lens.
    f_number : float or None
        None leaves it wide open.

    Returns
    -------
    Lens
        The same surfaces, the stop's semi-aperture that of the round iris.
    """
    if f_number is None:
        return lens
    surfaces = list(lens.surfaces)
    surfaces[lens.stop] = replace(surfaces[lens.stop], semi_aperture=paraxial.stop_radius(lens, f_number))
    return replace(lens, surfaces=tuple(surfaces))


def front(lens: Lens, direction: Direction) -> tuple[Numbers, Numbers]:
    """Return a rectangle of the plane z = 0 that holds every ray through the first surface's rim.

    Parameters
    ----------
    lens : Lens
        The lens.
    direction : tuple of float
        Unit vector from the lens towards the light.

    Returns
    -------
    low, high : ndarray, shape (2,)
        Its corners (x, y), metres.
    """
    heading = tracing.travel(direction)
    first = lens.surfaces[0]
    # A ray that meets the surface at height r has crossed z = 0 a slope times the sag before.
    sags = np.array([sag(first, r) for r in np.linspace(0.0, first.semi_aperture, RIM_HEIGHTS)])
    shifts = sags[:, None] * heading[:2] / heading[2]
    return -first.semi_aperture - shifts.max(axis=0), first.semi_aperture - shifts.min(axis=0)


class _Tally:
    """Sums of what has arrived."""

    def __init__(
        self, waves: int, sensor: tuple[float, float], shape: tuple[int, int] | None, density: float
    ) -> None:
        self.density, self.half = density, np.asarray(sensor) / 2.0
        self.sums, self.squares = np.zeros((2, waves)), np.zeros((2, waves))
        self.hits = np.zeros(waves, dtype=np.int64)
        self.picture = None if shape is None else np.zeros((waves, *shape))
        self.pitch = 1.0 if shape is None else sensor[0] / shape[1]

    def add(self, k: int, arrived: _Arrived) -> None:
        """Count one chunk's rays, which stand in the order of their cells."""
        inside = (np.abs(arrived.x) <= self.half[0]) & (np.abs(arrived.y) <= self.half[1])
        self.hits[k] += np.count_nonzero(arrived.weight)
        for part, carried in enumerate((arrived.weight, np.where(inside, arrived.weight, 0.0))):
            self.sums[part, k] += carried.sum()
            # Two neighbours differ by chance and a little by their places: their difference squared is
            # the sum of both variances, or more.
            even = carried[: len(carried) // 2 * 2].reshape(-1, 2)
            self.squares[part, k] += np.sum((even[:, 0] - even[:, 1]) ** 2)
        if self.picture is not None:
            rows, columns = self.picture.shape[1:]
            places = (rows / 2 - arrived.y / self.pitch, columns / 2 - arrived.x / self.pitch)
            edges = [np.arange(rows + 1), np.arange(columns + 1)]
            self.picture[k] += np.histogram2d(*places, bins=edges, weights=arrived.weight)[0]

    def estimate(self, count: int) -> Estimate:
        """Return the sums as energies."""
        energy, error = self.sums * self.density, np.sqrt(self.squares) * self.density
        picture = None if self.picture is None else (self.picture * self.density).astype(np.float32)
        return Estimate(energy[0], error[0], energy[1], error[1], self.hits, count, picture)


def _grid(count: int, size: Numbers) -> tuple[int, int]:
    """Return how many columns and rows of nearly square cells there are to be."""
    columns = max(2, round(float(np.sqrt(count * size[0] / size[1]))))
    return columns + columns % 2, max(1, round(count / columns))


def _scattered(
    low: Numbers, high: Numbers, cells: tuple[int, int], most: int, chance: np.random.Generator
) -> Iterator[Numbers]:
    """Yield points (N, 2), one in each cell, whole rows at a time."""
    columns, rows = cells
    step = (high - low) / cells
    together = max(1, most // columns)
    for first in range(0, rows, together):
        i, j = np.mgrid[first : min(first + together, rows), 0:columns]
        corners = np.stack([j.ravel(), i.ravel()], axis=1)
        yield low + (corners + chance.random(corners.shape)) * step


def _reference(lens: Lens, reflections: Sequence[int], direction: Direction, wave: float) -> Follow:
    heading = tracing.travel(direction)

    def follow(points: Numbers) -> _Arrived:
        origins = np.column_stack([points, np.zeros(len(points))])
        headings = np.broadcast_to(heading, origins.shape)
        traced = trace_reference(lens, reflections, origins, headings, wave)
        weight = np.where(traced.passed, power(lens, traced), 0.0)
        return _Arrived(traced.positions[:, 0], traced.positions[:, 1], weight)

    return follow


def _compiled(lens: Lens, reflections: Sequence[int], direction: Direction, wave: float) -> Follow:
    prepared = tracing.prepare(lens, np.array([wave]))

    def follow(points: Numbers) -> _Arrived:
        found = tracing.trace(prepared, reflections, points, direction)
        weight = np.where(found.passed[0], found.weight[0], 0.0).astype(np.float64)
        return _Arrived(found.x[0].astype(np.float64), found.y[0].astype(np.float64), weight)

    return follow
