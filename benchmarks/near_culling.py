"""Say what culling the near field saves, and how cautious its test has to be.

    python benchmarks/near_culling.py [--size 1024] [--runs 5]

Anti-aliased shapes that fill a mask; planes twice and four times as wide, of as many places; Fresnel
numbers 10, 100 and 1000; levels of the unblocked irradiance. "lit" is the share of the places that is
evaluated, "time" what the power takes with culling over what it takes without, by the work of all
processors (from the mask on; medians of runs in turn), "lost" the energy left out, of that in the plane.
"dimmest" is the least that the test saw of a tile with a place above the level, over the level: culling
keeps such a tile as long as this is above its caution (`near_culling.CAUTION`); tiles of every offset of
the plane by up to a step are looked at. No chance is involved, so there is no seed.
"""

import argparse
import os
import platform
import statistics
import time
from collections.abc import Callable

import numpy as np

from aureole import Aperture, Grid
from aureole.bench import shapes
from aureole.diffraction import near_culling, near_power
from aureole.diffraction.near_pixels import power_of, rows_parts

WAVELENGTH = 550e-9
LEVELS = (1e-2, 1e-3, 1e-4)
OFFSETS = (0.0, 0.25, 0.5)


def dimmest(mask: Aperture, grid: Grid, distance: float, level: float) -> float:
    """Return the least sample of a tile that holds a place above a level, over the level."""
    least = np.inf
    for offset in OFFSETS:
        centre = (offset * near_culling.STEP * grid.spacing[0], -offset * grid.spacing[1])
        moved = Grid(grid.shape, grid.spacing, centre)
        parts = rows_parts(mask, moved, distance, WAVELENGTH)
        edges, seen = near_culling.seen_in_tiles(parts, moved)
        power = power_of(parts, moved)
        if offset == 0:
            power = power[power.shape[0] // 2 :, power.shape[1] // 2 :]
        for i, j in np.ndindex(seen.shape):
            rows, columns = (slice(*each[k : k + 2]) for each, k in zip(edges, (i, j), strict=True))
            if power[rows, columns].max(initial=0) > level:
                least = min(least, float(seen[i, j]) / level)
    return least


def work(tasks: list[Callable[[], object]], runs: int) -> list[float]:
    """Time tasks in turn by all processors' work; the first time does not count."""
    taken: list[list[float]] = [[] for _ in tasks]
    for run in range(runs + 1):
        for task, times in zip(tasks, taken, strict=True):
            start = time.process_time()
            task()
            if run:
                times.append(time.process_time() - start)
    return [statistics.median(times) for times in taken]


def main() -> None:
    """Print a line for each shape, plane, Fresnel number and level."""
    parser = argparse.ArgumentParser(description="Say what culling the near field saves.")
    parser.add_argument("--size", type=int, default=1024, help="even")
    parser.add_argument("--runs", type=int, default=5)
    given = parser.parse_args()
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, {given.size}² pixels and places\n\n"
        f"{'':28}{'level':>8}{'lit':>8}{'time':>7}{'lost':>9}{'dimmest':>9}"
    )
    for name in shapes.OUTLINES:
        mask = shapes.raster(name, given.size, 1.0)
        for times in (2, 4):
            step = times * mask.width / given.size
            grid = Grid((given.size, given.size), (step, step))
            for number in (10, 100, 1000):
                distance = (mask.width / 2) ** 2 / (WAVELENGTH * number)
                whole = near_power(mask, grid, distance, WAVELENGTH, "rows")
                for level in LEVELS:
                    power = near_power(mask, grid, distance, WAVELENGTH, "rows", cull=level)
                    before, after = work(
                        [
                            lambda d=distance, g=grid, m=mask: near_power(m, g, d, WAVELENGTH, "rows"),
                            lambda d=distance, g=grid, m=mask, c=level: near_power(
                                m, g, d, WAVELENGTH, "rows", cull=c
                            ),
                        ],
                        given.runs,
                    )
                    lost = 1 - power.sum(dtype=np.float64) / whole.sum(dtype=np.float64)
                    print(
                        f"{f'{name}, {times}x wide, N_F {number}':28}{level:8.0e}"
                        f"{100 * np.count_nonzero(power) / power.size:7.1f}%{after / before:7.2f}"
                        f"{lost:9.1e}{dimmest(mask, grid, distance, level):9.2f}",
                        flush=True,
                    )


if __name__ == "__main__":
    main()
