"""Time the far field of rasters, method by method, against SciPy's real FFT, in one run.

    python benchmarks/far_field.py [--size 1024] [--runs 9]

Four shapes, anti-aliased, across half of the mask and across all of it; as many frequencies as pixels,
at the FFT's own spacing ("1x") and at a quarter of it ("4x"). "power" is |F|² from the distinct rows without
the field (`rows_power`); the methods give the complex field. At 4x SciPy would have to transform the
mask in a frame of zeros, four times as wide ("padded": real transforms of the mask's own rows, then of
the wanted columns). Either way it gives the power of the full plane, float32, with a thread a processor.

The runs alternate; ratios are those of the medians. The error is that of `auto` against method
"reference" over some samples, of the peak.
"""

import argparse
import importlib.metadata
import os
import platform
import statistics
import time
from collections.abc import Callable

import numpy as np
import scipy.fft

from aureole import Aperture, Grid, aperture, diffraction
from aureole.bench import peer_scipy, shapes
from aureole.diffraction.rows import rows_power

METHODS = ("rows", "quads", "chirpz", "fft", "auto")


def error(shape: Aperture, spacing: float) -> float:
    """Return the largest error of `auto` over some frequencies, of the peak."""
    worst = 0.0
    for grid in (Grid((64, 65), (spacing, spacing)), Grid((48, 40), (7.3 * spacing, 5.9 * spacing))):
        wanted = diffraction.far_field(shape, grid, "reference").amplitude
        for method in ("rows", "auto"):
            found = diffraction.far_field(shape, grid, method).amplitude
            worst = max(worst, float(np.abs(found - wanted).max() / aperture.area(shape)))
    return worst


def milliseconds(task: Callable[[], object]) -> float:
    """Time one call."""
    start = time.perf_counter()
    task()
    return 1e3 * (time.perf_counter() - start)


def medians(shape: Aperture, size: int, finer: int, runs: int) -> dict[str, float]:
    """Time all methods in turn."""
    grid = Grid((size, size), (1 / finer, 1 / finer))
    mask = np.asarray(shape.mask)
    tasks: dict[str, Callable[[], object]] = {
        "scipy": lambda: peer_scipy.padded_power(mask, finer) if finer > 1 else peer_scipy.real_power(mask)
    }
    tasks["power"] = lambda: rows_power(shape, grid)
    for method in METHODS:
        tasks[method] = lambda method=method: diffraction.far_field(shape, grid, method)
    taken: dict[str, list[float]] = {name: [] for name in tasks}
    for run in range(runs + 1):
        for name, task in tasks.items():
            spent = milliseconds(task)
            if run:  # the first compiles and builds the tables
                taken[name].append(spent)
    return {name: statistics.median(spent) for name, spent in taken.items()}


def main() -> None:
    """Print a line for each shape, size and sampling."""
    parser = argparse.ArgumentParser(description="Time the far field of rasters against SciPy's rfft2.")
    parser.add_argument("--size", type=int, default=1024, help="even")
    parser.add_argument("--runs", type=int, default=9)
    given = parser.parse_args()
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, NumPy "
        f"{np.__version__}, SciPy {scipy.__version__}, Aureole {importlib.metadata.version('aureole')}\n"
        f"{given.size}² pixels and frequencies, {given.runs} runs, medians in ms\n"
    )
    names = ("scipy", "power", *METHODS)
    print(
        f"{'':22}"
        + "".join(f"{name:>8}" for name in names)
        + f"{'power/scipy':>13}{'auto/best':>11}{'error':>9}"
    )
    for finer in (1, 4):
        for fill in (0.5, 1.0):
            for name in shapes.OUTLINES:
                shape = shapes.raster(name, given.size, fill)
                found = medians(shape, given.size, finer, given.runs)
                best = min(found[method] for method in METHODS[:-1])
                print(
                    f"{f'{name}, {fill:g}, {finer}x':22}"
                    + "".join(f"{found[each]:8.2f}" for each in names)
                    + f"{found['power'] / found['scipy']:13.2f}{found['auto'] / best:11.2f}"
                    + f"{error(shape, 1 / finer):9.1e}"
                )


if __name__ == "__main__":
    main()
