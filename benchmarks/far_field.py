"""Time the far field of rasters, method by method, against SciPy's real FFT, in one run.

    python benchmarks/far_field.py [--size 1024] [--runs 9]

Four shapes, anti-aliased, across half of the mask and across all of it; as many frequencies as pixels,
at the FFT's own spacing ("1x") and at a quarter of it ("4x"). First |F|² without the field (`far_power`),
then the complex field (`far_field`), by each method.

What they are measured against gives the power of the full plane, float32, with a thread a processor.
"NumPy" is SciPy's rfft2, squared and mirrored with NumPy; "FFT" is the same rfft2 with our own compiled
loop for squares and mirror. At 4x SciPy has to transform the mask in a frame of zeros, four times as wide
("padded": real transforms of the mask's own rows, then of the wanted columns), with NumPy.

The runs alternate; ratios are those of the medians. "power/FFT" is that of `auto` to the "FFT", or to the
padded one at 4x; "auto/best" that of `auto` to the fastest method, for the power and for the field. The
error is that of `auto` against method "reference" over some samples, of the peak.
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
from aureole.diffraction import _kernels_fft

METHODS = ("rows", "quads", "chirpz", "fft")
SEED = 5


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


def fft_power(mask: np.ndarray) -> np.ndarray:
    """Return the power of a mask's DFT, zero frequency in the middle, by SciPy's transform and our loop."""
    size = len(mask)
    half = scipy.fft.rfft2(mask, workers=os.cpu_count())
    ones, out = np.ones(size, np.float32), np.empty((size, size), np.float32)
    _kernels_fft.fill_power(half, (-(size // 2), -(size // 2)), size, ones, ones, out)
    return out


def medians(shape: Aperture, size: int, finer: int, runs: int) -> dict[str, float]:
    """Time all methods in turn, in another order each run, since each leaves its memory behind."""
    grid = Grid((size, size), (1 / finer, 1 / finer))
    mask = np.asarray(shape.mask)
    tasks: dict[str, Callable[[], object]] = {}
    if finer == 1:
        tasks["NumPy"] = lambda: peer_scipy.real_power(mask)
        tasks["FFT"] = lambda: fft_power(mask)
    else:
        tasks["NumPy"] = tasks["FFT"] = lambda: peer_scipy.padded_power(mask, finer)
    for method in ("auto", *METHODS):
        tasks[f"power {method}"] = lambda method=method: diffraction.far_power(shape, grid, method)
        tasks[f"field {method}"] = lambda method=method: diffraction.far_field(shape, grid, method)
    taken: dict[str, list[float]] = {name: [] for name in tasks}
    order = np.random.default_rng(SEED)
    for run in range(runs + 1):
        for name in order.permutation(list(tasks)):
            spent = milliseconds(tasks[name])
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
        f"{given.size}² pixels and frequencies, {given.runs} runs, medians in ms, seed {SEED}\n"
    )
    kinds = ("power", "field")
    names = ["NumPy", "FFT"] + [f"{kind} {method}" for kind in kinds for method in ("auto", *METHODS)]
    heads = "".join(f"{name.replace('power', 'p').replace('field', 'f'):>9}" for name in names)
    print(f"{'':20}{heads}{'power/FFT':>11}{'auto/best':>13}{'error':>9}")
    for finer in (1, 4):
        for fill in (0.5, 1.0):
            for name in shapes.OUTLINES:
                shape = shapes.raster(name, given.size, fill)
                found = medians(shape, given.size, finer, given.runs)
                best = {kind: min(found[f"{kind} {method}"] for method in METHODS) for kind in kinds}
                excess = [f"{found[f'{kind} auto'] / best[kind]:.2f}" for kind in kinds]
                print(
                    f"{f'{name}, {fill:g}, {finer}x':20}"
                    + "".join(f"{found[each]:9.2f}" for each in names)
                    + f"{found['power auto'] / found['FFT']:11.2f}{' '.join(excess):>13}"
                    + f"{error(shape, 1 / finer):9.1e}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
