"""Other ray tracers on the ways of ghosts: rays a second, and whether they land in the same places."""

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import flare, refuse
from aureole.bench import peer_optiland, timing
from aureole.bench.lens_rays import LensRays, Positions
from aureole.bench.peer_ways import working
from aureole.bench.report import Column, Table
from aureole.flare import pupil, rays, tracing
from aureole.records import Stage

PEERS: tuple[ModuleType, ...] = (peer_optiland,)
# Lens, reflecting surfaces counted from 1 (none is the image), and the light's angle in degrees (x, y).
CASES = (
    ("heliar_tronnier_100mm", (), (5.0, 3.0)),
    ("heliar_tronnier_100mm", (2, 5), (5.0, 3.0)),
    ("canon_tele_zoom_135mm", (), (3.0, 2.0)),
    ("canon_tele_zoom_135mm", (4, 12), (3.0, 2.0)),
)
WAVELENGTH = 550e-9
OURS, SLOW = "Aureole", "Aureole's reference"
COLUMNS = (
    Column("lens", "{lens}", words=True),
    Column("ghost", "{ghost}", words=True),
    Column("tracer", "{way}", words=True),
    Column("ms", "{ms:.1f}"),
    Column("Mrays/s", "{million_rays_per_second:.2f}"),
    Column("ratio", "{ratio:.1f}x"),
    Column("apart", "{farthest_um:.1e} µm"),
)
NOTES = (
    "Parallel rays of one wavelength over the part of the pupil that the way uses, medians of runs in turn. "
    "Aureole also finds each ray's energy, its place in the iris and how near it comes to rims; optiland "
    "also keeps every ray's place on every surface. No semi-aperture stops a ray here.",
    "apart: farthest from Aureole's reference, of the rays that pass all semi-apertures.",
    "Renderers of ghosts are not here: realflare 0.6.4 does not install on Python 3.11 (it asks for PySide2 "
    "and for a package that is not on PyPI), FlareSim and OpenLensFlare are no Python packages. ray-optics "
    "traces one ray at a time.",
)


@dataclass(frozen=True)
class FlarePeersBench:
    """What to compare.

    Parameters
    ----------
    side : int
        Rays along each side of the grid.
    runs : int
        How often each is timed.
    """

    side: int = 256
    runs: int = 5


def run_flare_peers(bench: FlarePeersBench) -> Iterator[Stage]:
    """Compare with the ray tracers that are installed.

    Parameters
    ----------
    bench : FlarePeersBench
        What to compare.

    Returns
    -------
    iterator of Stage
        The last one holds a `Report`.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.at_least("side", bench.side, 4)
    refuse.at_least("runs", bench.runs, 1)
    settings = {"side": bench.side, "runs": bench.runs, "seed": None}
    packages = [peer.PACKAGE for peer in PEERS]
    return timing.finish("flare-peers", settings, [lambda: traced(bench.side, bench.runs)], packages)


def traced(side: int, runs: int) -> Iterator[Stage]:
    """Time every tracer on every case.

    Parameters
    ----------
    side : int
        Rays along each side of the grid.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    said: list[str] = []
    for index, (name, numbers, angles) in enumerate(CASES):
        for stage in _case(name, numbers, angles, side, runs, rows, said):
            yield Stage((index + stage.fraction) / len(CASES), stage.label)
    title = f"{side * side} rays by the image's way and by ghosts'"
    table = Table("rays", title, COLUMNS, tuple(rows), (*NOTES, *dict.fromkeys(said)))
    yield Stage(1.0, "rays", (table,))


def problem_of(name: str, numbers: tuple[int, ...], angles: tuple[float, float], side: int) -> LensRays:
    """Return a grid of rays over the part of the pupil that a way uses.

    Parameters
    ----------
    name : str
        A lens.
    numbers : tuple of int
        Reflecting surfaces counted from 1; none is the image.
    angles : tuple of float
        Of the light, to the right and downward, degrees.
    side : int
        Rays along each side of the grid.

    Returns
    -------
    LensRays
        The problem.
    """
    lens = flare.load(name)
    reflections = flare.path_of(lens, numbers).reflections if numbers else ()
    x, y = np.tan(np.radians(angles))
    length = float(np.sqrt(1.0 + x * x + y * y))
    direction = (x / length, y / length, 1.0 / length)
    box = pupil.bounds(tracing.prepare(lens, [WAVELENGTH]), reflections, direction)
    assert box is not None, f"no ray passes {name} by {numbers}"
    across, down = np.linspace(box.left, box.right, side), np.linspace(box.top, box.bottom, side)
    points = np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)
    return LensRays(lens, reflections, points, direction)


def own_ways(problem: LensRays) -> dict[str, Positions]:
    """Return our two ways: the compiled one and the reference.

    Parameters
    ----------
    problem : LensRays
        Lens, way and rays.

    Returns
    -------
    dict
        Name to a function of the wavelength.
    """
    prepared = tracing.prepare(problem.lens, [WAVELENGTH])

    def compiled(wavelength: float) -> NDArray[np.floating]:
        found = tracing.trace(prepared, problem.reflections, problem.points, problem.direction)
        return np.column_stack([found.x[0], found.y[0]])

    def slow(wavelength: float) -> NDArray[np.floating]:
        headings = np.tile(problem.heading, (len(problem.points), 1))
        found = rays.trace_reference(problem.lens, problem.reflections, problem.origins, headings, wavelength)
        return np.where(found.passed[:, None], found.positions[:, :2], np.nan)

    return {OURS: compiled, SLOW: slow}


def _case(
    name: str,
    numbers: tuple[int, ...],
    angles: tuple[float, float],
    side: int,
    runs: int,
    rows: list[dict[str, Any]],
    said: list[str],
) -> Generator[Stage, None, None]:
    problem = problem_of(name, numbers, angles, side)
    peers = {way: at for way, at, _ in working(list(PEERS), lambda p: p.ray_ways(problem), WAVELENGTH, said)}
    ways = own_ways(problem) | peers
    tasks: dict[str, Callable[[], object]] = {way: _at(at) for way, at in ways.items()}
    times = yield from timing.alternate(tasks, runs, label=f"{name},")
    truth = ways[SLOW](WAVELENGTH)
    for way, spent in times.items():
        apart = np.hypot(*(ways[way](WAVELENGTH) - truth).T)
        rows.append(
            {
                "lens": name,
                "ghost": "-".join(map(str, numbers)) or "image",
                "way": way,
                "ms": spent,
                "million_rays_per_second": 1e-3 * side * side / spent,
                "ratio": spent / times[OURS],
                "farthest_um": 1e6 * float(np.nanmax(apart)),
                "passed": float(np.isfinite(truth[:, 0]).mean()),
            }
        )


def _at(at: Positions) -> Callable[[], object]:
    return lambda: at(WAVELENGTH)
