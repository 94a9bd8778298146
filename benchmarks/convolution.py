"""Convolve 1920×1080 RGB with a kernel as large: ours against SciPy's padded real FFT, in one run.

    python benchmarks/convolution.py [--rows 1080] [--columns 1920] [--runs 7]

`composite` is the whole of replacing a picture's light by its glare, kernel's transform included.
Both get the same float32 arrays and transform the kernel, too. SciPy's way is the usual one: rfft2 of
both, zero-padded to next_fast_len(2 N − 1), their product, irfft2, and the middle cut out, workers=2.
The runs alternate, so that whatever else the machine does hits all; the ratio is that of the medians.
"""

import argparse
import os
import platform
import statistics
import time
from collections.abc import Callable

import numpy as np
import scipy
import scipy.fft

import aureole
from aureole import Picture, glare
from aureole.picture import convolution

SEED = 7
WORKERS = 2
AGREEMENT = 2e-6  # largest difference allowed, of the largest value


def with_scipy(pixels: np.ndarray, kernel: np.ndarray) -> np.ndarray:
    """Convolve as one would with SciPy alone."""
    rows, columns = pixels.shape[:2]
    shape = [
        scipy.fft.next_fast_len(n + k - 1, real=True)
        for n, k in zip(pixels.shape[:2], kernel.shape[:2], strict=True)
    ]
    forward = {"s": shape, "axes": (0, 1), "workers": WORKERS}
    product = scipy.fft.rfft2(pixels, **forward) * scipy.fft.rfft2(kernel, **forward)
    whole = scipy.fft.irfft2(product, **forward)
    top, left = kernel.shape[0] // 2, kernel.shape[1] // 2
    return whole[top : top + rows, left : left + columns]


def seconds(task: Callable[[], np.ndarray]) -> float:
    """Time one call."""
    start = time.perf_counter()
    task()
    return time.perf_counter() - start


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Time convolution against SciPy's padded real FFT.")
    parser.add_argument("--rows", type=int, default=1080)
    parser.add_argument("--columns", type=int, default=1920)
    parser.add_argument("--runs", type=int, default=7)
    return parser.parse_args()


def main() -> None:
    """Check that all agree, time them in turn, print the table."""
    given = arguments()
    shape = (given.rows, given.columns, 3)
    generator = np.random.default_rng(SEED)
    pixels = generator.lognormal(0, 3, shape).astype(np.float32)
    kernel = generator.random(shape, dtype=np.float32)
    kernel /= kernel.sum(axis=(0, 1), dtype=np.float64)
    source, psf = Picture(pixels), Picture(kernel)
    prepared = convolution.Convolver(kernel, shape, threads=WORKERS)
    ways: dict[str, Callable[[], np.ndarray]] = {
        "scipy.fft rfft2/irfft2, padded": lambda: with_scipy(pixels, kernel),
        "aureole convolve": lambda: convolution.convolve(pixels, kernel, "fft", threads=WORKERS),
        "aureole convolve, double": lambda: convolution.convolve(
            pixels, kernel, "fft", "double", threads=WORKERS
        ),
        "aureole composite": lambda: glare.composite(source, psf).pixels,
        "aureole composite, double": lambda: glare.composite(source, psf, precision="double").pixels,
        "aureole Convolver, kernel prepared": lambda: prepared(pixels),
    }
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, NumPy "
        f"{np.__version__}, SciPy {scipy.__version__}, Aureole {aureole.__version__}, seed {SEED}"
    )
    results = {name: way() for name, way in ways.items()}  # also warms up
    first = next(iter(results.values()))
    for name, result in results.items():
        difference = float(np.abs(result - first).max() / first.max())
        # Compositing also returns what rounding took from the kernel's sum to its core.
        allowed = 20 * AGREEMENT if "composite" in name else AGREEMENT
        assert difference < allowed, f"{name} differs by {difference:.1e}"
    times: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(given.runs):
        for name, way in ways.items():
            times[name].append(seconds(way))
    base = statistics.median(next(iter(times.values())))
    print(f"{given.columns} x {given.rows} x 3, kernel as large, float32, {given.runs} runs\n")
    print(f"{'':36}{'median':>10}{'fastest':>10}{'ratio':>8}")
    for name, taken in times.items():
        middle = statistics.median(taken)
        print(f"{name:36}{middle * 1e3:7.0f} ms{min(taken) * 1e3:7.0f} ms{middle / base:8.2f}")


if __name__ == "__main__":
    main()
