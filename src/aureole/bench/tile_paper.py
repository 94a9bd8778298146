"""The tile paper's tables, measured here beside what it prints.

A. Bodonyi, R. Kunkli, "Efficient tile-based rendering of lens flare ghosts", Computers & Graphics, 2023. Its
times are a GeForce RTX 3060's.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from aureole import refuse
from aureole.bench import timing
from aureole.bench.tile_measures import measured
from aureole.bench.tile_systems import GRIDS, SYSTEMS, System
from aureole.bench.tile_tables import table
from aureole.bench.tile_whole import whole
from aureole.records import Stage

TABLES = ("table-2", "table-3", "table-4", "table-5", "table-6", "table-7", "table-8")
WHOLE = "whole"
NAMES = {"heliar": 0, "itoh": 1, "nikon": 2, "canon-135": 3, "canon-200": 4}
CHOICES = (*TABLES, WHOLE, *NAMES)
TWO_LIGHTS = ("table-2", "table-3", "table-5", "table-6")
SHAPE, BASE = (1080, 1920), 256
# What --quick takes: a smaller picture, coarser grids, two lenses, one run.
QUICK_SHAPE, QUICK_BASE, QUICK = (270, 480), 32, ("heliar", "nikon")


@dataclass(frozen=True)
class TilePaperBench:
    """What to measure.

    Parameters
    ----------
    base : int
        Rays along each side of the largest grids (Eq. 13).
    runs : int
        How often each is timed.
    grids : {"bounds", "front"}
        Whether grids lie over the part of the pupil that a ghost uses, or over the whole front of the lens.
    quick : bool
        Whether a small picture, coarse grids and two lenses are enough.
    only : tuple of str
        Tables ("table-2" to "table-8", "whole") and lenses (heliar, itoh, nikon, canon-135, canon-200) to
        keep; all where none is named.
    """

    base: int = BASE
    runs: int = 3
    grids: str = "bounds"
    quick: bool = False
    only: tuple[str, ...] = ()


def run_tile_paper(bench: TilePaperBench) -> Iterator[Stage]:
    """Measure the paper's tables.

    Parameters
    ----------
    bench : TilePaperBench
        What to measure.

    Returns
    -------
    iterator of Stage
        The last one holds a `Report`.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range or a name is unknown.
    """
    refuse.at_least("base", bench.base, 8)
    refuse.at_least("runs", bench.runs, 1)
    refuse.one_of("grids", bench.grids, GRIDS)
    for name in bench.only:
        refuse.one_of("only", name, CHOICES)
    wanted = [name for name in (*TABLES, WHOLE) if name in bench.only] or [*TABLES, WHOLE]
    named = [name for name in NAMES if name in bench.only] or list(QUICK if bench.quick else NAMES)
    systems = [SYSTEMS[NAMES[name]] for name in named]
    shape, base, runs = SHAPE, bench.base, bench.runs
    if bench.quick:
        shape, base, runs = QUICK_SHAPE, min(base, QUICK_BASE), 1
    parts: list[timing.Part] = []
    if set(wanted) - {WHOLE}:
        parts.append(lambda: _tables(systems, shape, base, bench.grids, runs, wanted))
    if WHOLE in wanted:
        parts.append(lambda: whole(systems, shape, base, runs))
    settings = {"base": base, "runs": runs, "grids": bench.grids, "size": f"{shape[1]}x{shape[0]}"}
    return timing.finish("tile-paper", settings | {"only": list(bench.only), "seed": None}, parts)


def _tables(
    systems: Sequence[System], shape: tuple[int, int], base: int, grids: str, runs: int, wanted: Sequence[str]
) -> Iterator[Stage]:
    """Measure every lens with one light and with two, and lay the tables out."""
    lights = (1, 2) if set(wanted) & set(TWO_LIGHTS) else (1,)
    cases = [(system, count) for system in systems for count in lights]
    rows: list[dict[str, Any]] = []
    for index, (system, count) in enumerate(cases):
        work = measured(system, count, shape, base, grids, runs, wanted)
        row = yield from timing.within(work, index / len(cases), (index + 1) / len(cases))
        rows.append(row)
    tables = tuple(table(name, rows) for name in TABLES if name in wanted)
    yield Stage(1.0, "tables", tables)
