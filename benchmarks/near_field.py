"""Time the near field of rasters, method by method, and fit the chooser's costs.

    python benchmarks/near_field.py [--size 1024] [--runs 5] [--fit] [--work]

Four anti-aliased shapes across half of the mask and across all of it, and a mask of random pixels; places
with the pixels' pitch on a plane as wide as the mask, and on one twice as wide; a centred plane and one
aside, where nothing mirrors. For each, |D|² without D by each method at a Fresnel number of 100 (no
method's time depends on it), from the mask on. The methods alternate; medians. "auto/best" is what `auto`
takes over what the fastest method does, by the medians of the methods; it is named behind it.

With --fit, non-negative costs of a call and of each unit of work are fitted to the relative errors, over
a quarter, a half and all of the size, and printed under the names that `near.py` gives them. With --work
the time that all processors spent is taken instead of the clock, over the number of processors, which is
steadier on a busy machine.
"""

import argparse
import importlib.metadata
import os
import platform
import statistics
import time
from collections.abc import Callable, Iterator

import numpy as np
import scipy
from scipy import optimize

from aureole import Aperture, Grid, aperture
from aureole.bench import shapes
from aureole.diffraction import NearOperator, near, near_power
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


def medians(tasks: dict[str, Callable[[], object]], runs: int, work: bool) -> dict[str, float]:
    """Time tasks in turn, in milliseconds; the first time does not count."""
    taken: dict[str, list[float]] = {name: [] for name in tasks}
    share = 1 / (os.cpu_count() or 1)
    for run in range(runs + 1):
        for name, task in tasks.items():
            clock, worked = time.perf_counter(), time.process_time()
            task()
            spent = share * (time.process_time() - worked) if work else time.perf_counter() - clock
            if run:
                taken[name].append(1e3 * spent)
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


def main() -> None:
    """Print a line for each mask and plane."""
    parser = argparse.ArgumentParser(description="Time the near field of rasters, method by method.")
    parser.add_argument("--size", type=int, default=1024, help="a multiple of 4")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--fit", action="store_true", help="fit the chooser's costs")
    parser.add_argument("--work", action="store_true", help="take the processors' time, not the clock's")
    given = parser.parse_args()
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
