"""Time the near field of rasters, method by method, and fit the chooser's costs.

    python benchmarks/near_field.py [--size 1024] [--runs 5] [--fit] [--work]
    python benchmarks/near_field.py --moving [--size 1024] [--runs 5] [--work]

Four anti-aliased shapes across half of the mask and across all of it, and a mask of random pixels; places
with the pixels' pitch on a plane as wide as the mask, and on one twice as wide; a centred plane and one
aside, where nothing mirrors. For each, |D|² without D by each method at a Fresnel number of 100 (no
method's time depends on it), from the mask on. The methods alternate; medians. "auto/best" is what `auto`
takes over what the fastest method does, by the medians of the methods; it is named behind it.

With --fit, non-negative costs of a call and of each unit of work are fitted to the relative errors, over
a quarter, a half and all of the size, and printed under the names that `near.py` gives them. With --work
the time that all processors spent is taken instead of the clock, over the number of processors, which is
steadier on a busy machine.

With --moving, a round shadow wanders over the heptagon: a frame by `ProgressiveNearField`, and afresh.
"""

import argparse
import importlib.metadata
import itertools
import os
import platform
import statistics
import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
import scipy
from scipy import optimize

from aureole import Aperture, Grid, aperture
from aureole.bench import shapes
from aureole.diffraction import NearOperator, ProgressiveNearField, near, near_field, near_power
from aureole.diffraction.near_fft import lattice

METHODS = ("rows", "fft", "quads")
WAVELENGTH, FRESNEL_NUMBER, SEED = 550e-9, 100, 5


def cases(size: int) -> Iterator[tuple[str, Aperture, Grid]]:
    """Yield the masks and planes, with a name."""
    masks = {
        f"{name} {fill:g}": shapes.raster(name, size, fill) for fill in (0.5, 1.0) for name in shapes.OUTLINES
    }
    noise = np.random.default_rng(SEED).random((size, size))
    masks["noise"] = aperture.from_mask(noise, next(iter(masks.values())).width)
    for name, mask in masks.items():
        pitch = mask.width / size
        for times in (1, 2):
            for aside in (0, 1):
                count = times * size
                grid = Grid((count, count), (pitch, pitch), (aside * 10.3 * pitch, aside * 20.7 * pitch))
                yield f"{name}, {times}x{', aside' if aside else ''}", mask, grid


def once(task: Callable[[], object], work: bool) -> float:
    """Time a task, in milliseconds."""
    clock, worked = time.perf_counter(), time.process_time()
    task()
    if work:
        return 1e3 * (time.process_time() - worked) / (os.cpu_count() or 1)
    return 1e3 * (time.perf_counter() - clock)


def medians(tasks: dict[str, Callable[[], object]], runs: int, work: bool) -> dict[str, float]:
    """Time tasks in turn, in milliseconds; the first time does not count."""
    taken: dict[str, list[float]] = {name: [] for name in tasks}
    for run in range(runs + 1):
        for name, task in tasks.items():
            spent = once(task, work)
            if run:
                taken[name].append(spent)
    return {name: statistics.median(each) for name, each in taken.items()}


def works(mask: Aperture, grid: Grid) -> dict[str, list[float]]:
    """Return the units of work of 'rows' and of 'fft'."""
    found = lattice(mask, grid)
    assert found is not None
    factors = NearOperator(mask, grid, "rows").prepared["factors"]
    return {"rows": near.rows_work(mask, factors, grid), "fft": near.fft_work(mask, grid, found)}


def fit(gathered: dict[str, list[tuple[list[float], float]]]) -> None:
    """Print the costs that leave the least relative errors."""
    for method, rows in gathered.items():
        times = np.array([spent / 1e3 for _, spent in rows])
        features = np.array([work for work, _ in rows])
        costs, _ = optimize.nnls(features / times[:, None], np.ones(len(times)))
        off = np.abs(features @ costs / times - 1)
        print(
            f"{method.upper()}_COSTS = ({', '.join(f'{cost:.1e}' for cost in costs)})  # off by "
            f"{100 * np.median(off):.0f} % in the median, {100 * off.max():.0f} % at most"
        )


def moving(size: int, runs: int, work: bool) -> None:
    """Print a line for each size of a shadow: a frame from the one before, and afresh."""
    opening = shapes.raster("heptagon", size, 1.0)
    pitch = opening.width / size
    grid = Grid((size, size), (pitch, pitch))
    distance = (opening.width / 2) ** 2 / (WAVELENGTH * FRESNEL_NUMBER)
    y, x = np.mgrid[:size, :size] / size - 0.5
    print(f"{'shadow over opening':30}{'update':>9}{'afresh':>9}{'ratio':>8}")
    for across in (0.04, 0.12, 0.3):
        progressive = ProgressiveNearField(grid, distance, WAVELENGTH)
        frames = (
            aperture.from_mask(
                np.where(np.hypot(x - 0.008 * k, y + 0.05 - 0.005 * k) < across / 2, 0, opening.mask),
                opening.width,
            )
            for k in range(1000)
        )
        progressive.update(next(frames))
        taken: dict[str, list[float]] = {"update": [], "afresh": []}
        for shape in itertools.islice(frames, runs):
            taken["update"].append(once(partial(progressive.update, shape), work))
            taken["afresh"].append(once(partial(near_field, shape, grid, distance, WAVELENGTH), work))
        update_ms, afresh_ms = (statistics.median(each) for each in taken.values())
        print(f"{across:<30}{update_ms:9.2f}{afresh_ms:9.2f}{afresh_ms / update_ms:8.2f}", flush=True)


def main() -> None:
    """Print a line for each mask and plane."""
    parser = argparse.ArgumentParser(description="Time the near field of rasters, method by method.")
    parser.add_argument("--size", type=int, default=1024, help="a multiple of 4")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--fit", action="store_true", help="fit the chooser's costs")
    parser.add_argument("--work", action="store_true", help="take the processors' time, not the clock's")
    parser.add_argument("--moving", action="store_true", help="a shadow that wanders, instead")
    given = parser.parse_args()
    if given.moving:
        moving(given.size, given.runs, given.work)
        return
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, NumPy "
        f"{np.__version__}, SciPy {scipy.__version__}, Aureole {importlib.metadata.version('aureole')}\n"
        f"{given.size}² pixels, {given.runs} runs, medians in ms, seed {SEED}\n\n"
        f"{'':30}{''.join(f'{name:>9}' for name in METHODS)}{'auto':>7}{'auto/best':>11}"
    )
    gathered: dict[str, list[tuple[list[float], float]]] = {"rows": [], "fft": []}
    for size in (given.size // 4, given.size // 2, given.size) if given.fit else (given.size,):
        for name, mask, grid in cases(size):
            distance = (mask.width / 2) ** 2 / (WAVELENGTH * FRESNEL_NUMBER)
            tasks: dict[str, Callable[[], object]] = {
                method: lambda method=method, mask=mask, grid=grid, distance=distance: near_power(
                    mask, grid, distance, WAVELENGTH, method
                )
                for method in METHODS
            }
            found = medians(tasks, given.runs, given.work)
            for method, work in works(mask, grid).items():
                gathered[method].append((work, found[method]))
            auto = NearOperator(mask, grid).method
            times = "".join(f"{found[method]:9.2f}" for method in METHODS)
            ratio = found[auto] / min(found.values())
            print(f"{f'{size}, {name}':30}{times}{auto:>7}{ratio:11.2f}", flush=True)
    if given.fit:
        print()
        fit(gathered)


if __name__ == "__main__":
    main()
