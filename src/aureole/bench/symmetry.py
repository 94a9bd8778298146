"""Table 2 of the quad paper: what symmetry and culling save, on the heptagon."""

from collections.abc import Callable, Generator, Iterator, Sequence
from typing import Any

import numpy as np

from aureole import diffraction
from aureole.bench import shapes
from aureole.bench.report import Column, Table
from aureole.bench.timing import alternate
from aureole.records import Aperture, Grid, Stage

SIZES = (256, 512, 1024, 2048, 4096)
# Table 2, as printed: milliseconds on a GeForce GTX 1080 Ti.
PRINTED_MS = {
    "no optimizations": (0.13, 0.40, 2.25, 19.46, 139.35),
    "culling": (0.21, 0.32, 1.06, 5.65, 31.63),
    "symmetry": (0.14, 0.25, 1.20, 9.76, 74.70),
    "culling + symmetry": (0.14, 0.26, 0.71, 3.57, 20.22),
}
COLUMNS = (
    Column("size", "{size}²"),
    Column("", "{way}", words=True),
    Column("here", "{median_ms:.1f} ms"),
    Column("gain", "{gain:.1f}x"),
    Column("GTX 1080 Ti", "{printed_ms:.2f} ms"),
    Column("its gain", "{printed_gain:.1f}x"),
    Column("error", "{error:.0e}"),
    Column("lost", "{energy_lost:.1e}"),
)
NOTES = (
    "The heptagon's quads ('half', as the paper's) transformed to as many frequencies as pixels, to power on "
    "the full plane; finding the quads, or the rows, included.",
    "GTX 1080 Ti: as the paper prints, with its own gain. error: of the peak, against the first; lost: the "
    "share of the power that culling leaves out.",
    "no optimizations: the factors of every quad at every frequency. symmetry: those of the mask's rows on a "
    "quarter plane, mirrored. culling: of rows, too; tiles below 1e-6 of the peak are left at zero. Without "
    "symmetry the grid lies off centre, by 1e-9 of a step, so that nothing is mirrored.",
)
# Power below this share of the peak may be left out.
CULL = 1e-6
# Steps off centre that undo the mirroring and change nothing else.
ASIDE = 1e-9
Way = Callable[[Aperture, Grid], Any]


def _all_quads(aperture: Aperture, grid: Grid) -> Any:
    return diffraction.far_power(aperture, _aside(grid), "quads")


def _by_symmetry(aperture: Aperture, grid: Grid) -> Any:
    return diffraction.far_power(aperture, grid, "rows")


def _by_culling(aperture: Aperture, grid: Grid) -> Any:
    return diffraction.far_power(aperture, _aside(grid), "rows", cull=CULL)


def _by_both(aperture: Aperture, grid: Grid) -> Any:
    return diffraction.far_power(aperture, grid, "rows", cull=CULL)


def _aside(grid: Grid) -> Grid:
    """Return a grid that is not centred on zero, and so cannot be mirrored."""
    return Grid(grid.shape, grid.spacing, (ASIDE * grid.spacing[0], ASIDE * grid.spacing[1]))


WAYS: dict[str, Way] = {
    "no optimizations": _all_quads,
    "culling": _by_culling,
    "symmetry": _by_symmetry,
    "culling + symmetry": _by_both,
}


def table_2(sizes: Sequence[int], runs: int) -> Iterator[Stage]:
    """Time the heptagon's transform with and without symmetry and culling.

    Parameters
    ----------
    sizes : sequence of int
        Frequencies on each side.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    for index, size in enumerate(sizes):
        found: list[dict[str, Any]] = []
        for stage in _of_size(size, runs, found):
            yield Stage((index + stage.fraction) / len(sizes), stage.label)
        rows += found
    table = Table("table-2", "Table 2: symmetry and culling, heptagon", COLUMNS, tuple(rows), NOTES)
    yield Stage(1.0, "symmetry and culling", (table,))


def _of_size(size: int, runs: int, rows: list[dict[str, Any]]) -> Generator[Stage, None, None]:
    """Time all ways at one size and append their rows."""
    level = diffraction.level_mask(shapes.mask("heptagon", size), "half")
    aperture = Aperture(1.0, mask=level.astype(np.float32), name="heptagon")
    grid = Grid((size, size), (1.0, 1.0))
    tasks = {name: lambda way=way: way(aperture, grid) for name, way in WAYS.items()}
    times = yield from alternate(tasks, runs, label=f"{size}²,")
    truth = _all_quads(aperture, grid)
    whole = float(truth.sum(dtype=np.float64))
    slowest = times["no optimizations"]
    for name, spent in times.items():
        row = {"size": size, "way": name, "median_ms": spent, "gain": slowest / spent}
        power = WAYS[name](aperture, grid)
        row["error"] = float(np.abs(power - truth).max() / truth.max())
        if "culling" in name:
            row["energy_lost"] = 1 - float(power.sum(dtype=np.float64)) / whole
        rows.append(row | _printed(name, size))


def _printed(name: str, size: int) -> dict[str, Any]:
    if size not in SIZES or name not in PRINTED_MS:
        return {}
    index = SIZES.index(size)
    printed = PRINTED_MS[name][index]
    return {"printed_ms": printed, "printed_gain": PRINTED_MS["no optimizations"][index] / printed}
