"""Time the spectral sum, method by method, against SciPy's `map_coordinates`, and judge all of them.

    python benchmarks/spectral_sum.py [--size 1024] [--runs 7] [--samples 60] [--finer 1 2 4]
    python benchmarks/spectral_sum.py --fit

The pattern is |F|² of a heptagon at 529 nm, float32, point samples, 1, 2 or 4 of them in 1 / diameter
(|F|² has no fringe finer than that; two are its Nyquist rate), and reaches 529 / 380 as far as the output.
The output has the pattern's spacing; the light is of equal energy, its range 380 to 780 nm.

SciPy's way is one `map_coordinates(order=1)` for each wavelength on the whole plane, added to three
channels. The methods use that P(−q) = P(q), except where the table says "whole plane". The runs
alternate; ratios are those of the medians. Quality is the PSNR of the logarithms, ten decades, the
worst of X, Y and Z (`aureole.picture.log_psnr`): "exact" against 401 wavelengths, each transformed at its
own scale without interpolation; "full" against method "full" with the same interpolation.

--fit measures the constants by which "auto" chooses, and prints them.
"""

import argparse
import importlib.metadata
import os
import platform
import statistics
import time
from collections.abc import Callable

import numpy as np
from scipy import ndimage, optimize

from aureole import Grid, aperture, light, picture
from aureole.diffraction.polygons import add_polygons_power
from aureole.light import lookups, rays
from aureole.light.scaling import Task
from aureole.records import Aperture, Pattern

SEED = 7
DIAMETER = 3e-3
WAVELENGTH = 529e-9
SHORTEST = 380e-9
EXACT_WAVELENGTHS = 401
SLOW = "60 map_coordinates"
WAYS = [
    (method, interpolation) for interpolation in ("linear", "cubic") for method in ("full", "batch", "rays")
]


def heptagon() -> Aperture:
    """Draw a heptagon, turned by a random angle so that it mirrors in no axis."""
    turn = np.random.default_rng(SEED).uniform(0, 2 * np.pi / 7)
    return aperture.iris(7, DIAMETER, rotation=float(turn))


def power(shape: Aperture, grid: Grid) -> np.ndarray:
    """Return |F|² on a grid."""
    total = np.zeros(grid.shape, dtype=np.float32)
    add_polygons_power(shape, grid, 1.0, total)
    return total


def sampled(shape: Aperture, size: int, spacing: float) -> Pattern:
    """Sample |F|² as far as the shortest wavelength looks."""
    half = int(np.ceil(size / 2 * WAVELENGTH / SHORTEST)) + 2
    grid = Grid((2 * half + 1, 2 * half + 1), (spacing, spacing))
    return Pattern(power(shape, grid), grid, WAVELENGTH, 1.0)


def exact(shape: Aperture, size: int, spacing: float) -> np.ndarray:
    """Sum wavelengths, each transformed at its own scale; the upper half with the centre's row."""
    rows = size // 2 + 1
    total = np.zeros((rows, size, 3))
    for wavelength, weight in zip(*light.quadrature(light.illuminant("E"), EXACT_WAVELENGTHS), strict=True):
        ratio = WAVELENGTH / wavelength
        step = ratio * spacing
        grid = Grid((rows, size), (step, step), ((rows // 2 - size // 2) * step, 0.0))
        total += ratio**2 * power(shape, grid)[:, :, None] * weight
    return total


def with_scipy(pattern: Pattern, grid: Grid, samples: int) -> np.ndarray:
    """Sum the wavelengths as one would with SciPy alone."""
    y, x = grid.axes()
    rows, columns = pattern.grid.shape
    total = np.zeros((*grid.shape, 3), dtype=np.float32)
    wavelengths, weights = light.quadrature(light.illuminant("E"), samples)
    for wavelength, weight in zip(wavelengths, weights, strict=True):
        ratio = WAVELENGTH / wavelength
        places = np.meshgrid(
            ratio * y / pattern.grid.spacing[0] + rows // 2,
            ratio * x / pattern.grid.spacing[1] + columns // 2,
            indexing="ij",
        )
        scaled = ndimage.map_coordinates(pattern.intensity, places, order=1, mode="constant")
        for channel in range(3):
            total[..., channel] += np.float32(ratio**2 * weight[channel]) * scaled
    return total


def seconds(task: Callable[[], object]) -> float:
    """Time one call."""
    start = time.perf_counter()
    task()
    return time.perf_counter() - start


def compare(size: int, runs: int, samples: int, finer: int) -> None:
    """Time and judge all ways at one sampling."""
    shape, spacing = heptagon(), 1 / (finer * DIAMETER)
    pattern, grid, spectrum = sampled(shape, size, spacing), Grid((size, size), (spacing, spacing)), "E"

    def summed(method: str, interpolation: str, symmetric: bool = True) -> np.ndarray:
        return light.spectral_sum(
            pattern,
            None,
            light.illuminant(spectrum),
            method,
            grid=grid,
            samples=samples,
            interpolation=interpolation,
            symmetric=symmetric,
        ).pixels

    tasks: dict[str, Callable[[], np.ndarray]] = {SLOW: lambda: with_scipy(pattern, grid, samples)}
    for method, interpolation in WAYS:
        tasks[f"{method}, {interpolation}"] = lambda m=method, i=interpolation: summed(m, i)
    tasks["full, linear, whole plane"] = lambda: summed("full", "linear", False)
    tasks["rays, cubic, whole plane"] = lambda: summed("rays", "cubic", False)
    found = {name: task() for name, task in tasks.items()}  # warms up
    taken: dict[str, list[float]] = {name: [] for name in tasks}
    for run in range(runs):
        for name, task in tasks.items():
            if name != SLOW or run < 3:
                taken[name].append(seconds(task))
    middle = {name: statistics.median(times) for name, times in taken.items()}
    truth = exact(shape, size, spacing)
    print(f"\n{finer} samples in 1 / diameter\n")
    print(f"{'':28}{'median':>10}{'SciPy /':>9}{'full /':>8}{'exact':>9}{'full':>9}")
    for name, pixels in found.items():
        interpolation = "cubic" if "cubic" in name else "linear"
        full = f"full, {interpolation}"
        quality = picture.log_psnr(pixels[: size // 2 + 1], truth).min()
        to_full = picture.log_psnr(pixels, found[full]).min()
        print(
            f"{name:28}{1e3 * middle[name]:7.1f} ms{middle[SLOW] / middle[name]:8.0f}x"
            f"{middle[full] / middle[name]:7.1f}x{quality:6.1f} dB{to_full:6.1f} dB"
        )


def fit(runs: int) -> None:
    """Measure what a look-up, a crossing and a pixel cost, by least squares over sizes."""
    shape, spectrum = heptagon(), light.illuminant("E")
    for interpolation in ("linear", "cubic"):
        sums, costs, looks = [], [], []
        for size in (64, 128, 256, 512, 1024):
            for symmetric, zoom in ((True, 1), (False, 1), (True, 4)):
                pattern = sampled(shape, size, 0.5 / DIAMETER)
                grid = Grid((size, size), (pattern.grid.spacing[0] / zoom,) * 2)
                task = Task(pattern, grid, WAVELENGTH, spectrum, 60, interpolation, symmetric)
                for method in (lookups.full, rays.rays):
                    method(task)
                looks.append(min(seconds(lambda t=task: lookups.full(t)) for _ in range(runs)))
                costs.append(min(seconds(lambda t=task: rays.rays(t)) for _ in range(runs)))
                sums.append((lookups.look_ups(task), 1, *rays.counts(task)))
        table = np.array(sums, dtype=float)
        # Relative errors, no cost below zero.
        each = optimize.nnls(table[:, 1:] / np.array(costs)[:, None], np.ones(len(costs)))[0]
        per_look = np.median(np.array(looks)[-6:] / table[-6:, 0])
        print(
            f"{interpolation}: {1e9 * per_look:.2f} ns a look-up; rays {1e3 * each[0]:.2f} ms, "
            f"{1e9 * each[1]:.2f} ns a crossing, {1e9 * each[2]:.2f} ns a pixel"
        )


def main() -> None:
    """Read the command line and do what it says."""
    parser = argparse.ArgumentParser(description="Time and judge the spectral sum's methods.")
    parser.add_argument("--size", type=int, default=1024, help="even")
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--samples", type=int, default=60)
    parser.add_argument("--finer", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--fit", action="store_true", help="measure the costs by which 'auto' chooses")
    given = parser.parse_args()
    versions = ", ".join(
        f"{name} {importlib.metadata.version(name)}" for name in ("aureole", "numpy", "scipy", "numba")
    )
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, "
        f"{versions}, seed {SEED}"
    )
    if given.fit:
        fit(given.runs)
        return
    print(f"{given.size}², {given.samples} wavelengths, float32, {given.runs} runs (SciPy 3), medians")
    for finer in given.finer:
        compare(given.size, given.runs, given.samples, finer)


if __name__ == "__main__":
    main()
