"""The near field at many distances: a sweep of planes, and a section along the axis."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from aureole import refuse, units
from aureole.jobs.contact_sheet import sheet, tile
from aureole.jobs.near_field import (
    NearFieldJob,
    NearFieldResult,
    NearPlane,
    NearSetup,
    on_grid,
    plane_stages,
    set_up,
    shared_report,
)
from aureole.records import Grid, Picture, Stage

SPACINGS = ("log", "distance", "fresnel-number")


@dataclass(frozen=True)
class Sweep:
    """Distances from a first to a last one.

    Parameters
    ----------
    first, last : float
        Metres.
    spacing : str
        What is evenly spaced: "log", each distance the one before times a factor; "distance";
        "fresnel-number", its inverse.
    """

    first: float
    last: float
    spacing: str = "log"

    def distances(self, count: int) -> list[float]:
        """Return so many distances in metres, both ends among them."""
        refuse.positive("first distance", self.first)
        refuse.positive("last distance", self.last)
        refuse.one_of("sweep_by", self.spacing, SPACINGS)
        refuse.at_least("count", count, 2)
        if self.first == self.last:
            raise refuse.Refusal(f"'sweep' must end at another distance than {self.first:g} m.")
        part = np.linspace(0, 1, count)
        if self.spacing == "log":
            # Logarithms first: the quotient of extreme lengths has no float.
            inner = np.exp((1 - part) * math.log(self.first) + part * math.log(self.last))
        elif self.spacing == "distance":
            inner = (1 - part) * self.first + part * self.last
        else:
            inner = 1 / ((1 - part) / self.first + part / self.last)
        return [self.first, *(float(value) for value in inner[1:-1]), self.last]


@dataclass(frozen=True)
class NearSweepJob:
    """What planes to make.

    Parameters
    ----------
    plane : NearFieldJob
        Each of them, without a distance; where its extent is left out, it suits the farthest.
    sweep : Sweep
        The distances.
    count : int
        How many planes, numbered from 1.
    numbers : tuple of int, optional
        Those that are wanted; all where it is left out.
    strip : bool
        Whether to make a strip of small pictures of them, too.
    zoom : bool
        Whether each plane is as wide as its own light spreads; all are of one size otherwise.
    is_done : callable, optional
        Asked with a plane's number and description, before any work; planes that it says are done are
        not made again, but for a strip.
    """

    plane: NearFieldJob
    sweep: Sweep
    count: int
    numbers: tuple[int, ...] | None = None
    strip: bool = False
    zoom: bool = False
    is_done: Callable[[int, str], bool] | None = None


@dataclass(frozen=True)
class NearSectionJob:
    """What section to make: a row of the picture for each distance, the line y = centre's across it.

    Parameters
    ----------
    plane : NearFieldJob
        Without a distance; its shape is (distances, places).
    sweep : Sweep
        The distances, the first on top.
    """

    plane: NearFieldJob
    sweep: Sweep


@dataclass(frozen=True, eq=False)
class NearFrame:
    """One plane of a sweep.

    Parameters
    ----------
    number : int
        From 1.
    plane : NearFieldResult
        The light on it.
    done : bool
        Whether it was said to be done before.
    """

    number: int
    plane: NearFieldResult
    done: bool = False


@dataclass(frozen=True, eq=False)
class NearSweepResult:
    """What is left of a sweep when its planes have been taken away.

    Parameters
    ----------
    report : dict
        Plain numbers; "frames" holds a dict for each plane.
    description : str
        What it is in words.
    strip : Picture, optional
        Small pictures of all planes in their order, by rows.
    """

    report: dict[str, Any]
    description: str
    strip: Picture | None = None


@dataclass(frozen=True, eq=False)
class NearSectionResult:
    """A section along the axis.

    Parameters
    ----------
    picture : Picture
        Irradiance, a row for each distance.
    report : dict
        Plain numbers.
    description : str
        What it is in words.
    """

    picture: Picture
    report: dict[str, Any]
    description: str


def run_near_sweep(job: NearSweepJob) -> Iterator[Stage]:
    """Run a sweep.

    Parameters
    ----------
    job : NearSweepJob
        What to make.

    Yields
    ------
    Stage
        Each plane as a `NearFrame` when it is ready; the last one holds a `NearSweepResult`.
    """
    yield Stage(0.0, "aperture")
    setup, distances = _set_up(job.plane, job.sweep, job.count)
    far = max(distances)
    numbers = _numbers(job)
    grids = {n: setup.grid(distances[n - 1] if job.zoom else far, job.zoom) for n in numbers}
    done = set()
    if job.is_done is not None:
        done = {n for n in numbers if job.is_done(n, setup.description(grids[n], distances[n - 1]))}
    reports = {n: {"number": n, "distance_m": distances[n - 1], "kept": n in done} for n in numbers}
    made = numbers if job.strip else [n for n in numbers if n not in done]
    ready, tiles = on_grid(setup, grids[numbers[0]]), []
    for index, number in enumerate(made):
        plane, ready = None, ready if grids[number] == ready.grid else on_grid(setup, grids[number])
        for stage in plane_stages(ready, distances[number - 1]):
            plane = stage.result
            if plane is None:
                yield Stage((index + stage.fraction) / len(made), f"plane {number} of {job.count}")
        assert isinstance(plane, NearFieldResult)
        if job.strip:
            tiles.append(tile(plane.picture.pixels))
        reports[number] |= _frame_report(plane.report)
        fraction = 0.999 * (index + 1) / len(made)
        yield Stage(fraction, f"plane {number} of {job.count}", NearFrame(number, plane, number in done))
    strip = Picture(sheet(tiles), job.plane.colour_space) if job.strip else None
    report = _report(ready, job.sweep) | {"planes": len(made), "kept": len(numbers) - len(made)}
    report["frames"] = [reports[n] for n in numbers]
    yield Stage(1.0, "sweep", NearSweepResult(report, _words(setup, job.sweep), strip))


def run_near_section(job: NearSectionJob) -> Iterator[Stage]:
    """Run a section along the axis.

    Parameters
    ----------
    job : NearSectionJob
        What to make.

    Yields
    ------
    Stage
        The last one holds a `NearSectionResult`.
    """
    yield Stage(0.0, "aperture")
    rows = job.plane.shape[0]
    setup, distances = _set_up(job.plane, job.sweep, rows)
    whole = setup.grid(max(distances))
    ready = on_grid(setup, Grid((1, whole.shape[1]), whole.spacing, whole.centre))
    pixels, largest = np.empty((*whole.shape, 3), dtype=np.float32), 0.0
    for row, distance in enumerate(distances):
        yield Stage(row / rows, f"line {row + 1} of {rows}")
        for stage in plane_stages(ready, distance):
            result = stage.result
        assert isinstance(result, NearFieldResult)
        pixels[row] = result.picture.pixels[0]
        largest = max(largest, float(result.irradiance.max()))
    report = _report(ready, job.sweep)
    report |= {
        "plane_m": report["plane_m"][:1],
        "size": [whole.shape[1], 1],
        "distances": rows,
        "largest_irradiance": largest,
    }
    picture, words = Picture(pixels, job.plane.colour_space), f"section, {_words(setup, job.sweep)}"
    yield Stage(1.0, "section", NearSectionResult(picture, report, words))


def _set_up(plane: NearFieldJob, sweep: Sweep, count: int) -> tuple[NearSetup, list[float]]:
    for name in ("distance", "fresnel_number"):
        if getattr(plane, name) is not None:
            raise refuse.Refusal(f"'{name}' does not go with 'sweep', which says the distances.")
    if plane.amplitude:
        raise refuse.Refusal("'amplitude' is for one plane; it does not go with 'sweep'.")
    distances = sweep.distances(count)
    return set_up(plane), distances


def _numbers(job: NearSweepJob) -> list[int]:
    wanted = range(1, job.count + 1) if job.numbers is None else job.numbers
    for number in wanted:
        if not 1 <= number <= job.count:
            raise refuse.Refusal(f"'frames' must lie from 1 to {job.count}, got {number}.")
    return sorted(set(wanted))


def _words(setup: NearSetup, sweep: Sweep) -> str:
    first, last = (units.metres_as_text(distance) for distance in (sweep.first, sweep.last))
    return f"near field {first} to {last} behind {setup.words()}"


def _report(plane: NearPlane, sweep: Sweep) -> dict[str, Any]:
    """Return the plain numbers of a sweep."""
    setup = plane.setup
    report = shared_report(plane) | {
        "first_distance_m": sweep.first,
        "last_distance_m": sweep.last,
        "sweep_by": sweep.spacing,
    }
    if setup.has_width:
        report["first_fresnel_number"] = setup.fresnel_number(sweep.first)
        report["last_fresnel_number"] = setup.fresnel_number(sweep.last)
    return report


def _frame_report(plane: dict[str, Any]) -> dict[str, Any]:
    """Keep of a plane's numbers what differs from plane to plane."""
    own = (
        "plane_m",
        "fresnel_number",
        "largest_irradiance",
        "mean_irradiance",
        "irradiance_on_axis",
        "energy_through_plane",
        "finest_fringe_pixels",
    )
    return {name: plane[name] for name in own if name in plane}
