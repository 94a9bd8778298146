"""Time the far field of outlines at 1024² against a real FFT of the same size, in one run.

    python benchmarks/polygons.py [--size 1024] [--runs 9]
    python benchmarks/polygons.py --fit

The FFT transforms a random float32 picture with SciPy's rfft2, workers=2: what a raster would cost
without drawing it and without its stair steps. The runs alternate; the ratio is that of the medians.
The error is the largest difference from method "reference" over some samples, of the peak.

--fit computes the constants of `aureole.diffraction._kernels_arcs` anew and prints them.
"""

import argparse
import importlib.metadata
import math
import os
import platform
import statistics
import time
from collections.abc import Callable

import numpy as np
import scipy.fft
from numpy.polynomial import Polynomial, chebyshev
from scipy import special

from aureole import Aperture, Grid, aperture, diffraction
from aureole.diffraction import polygons

SEED = 7
WORKERS = 2
DIAMETER = 3e-3
DEGREE = 9  # of the common denominator of the Fresnel auxiliary functions
NEAR_DISC = 3.0


def whirl() -> Aperture:
    """A shape of 320 straight edges with seven twisted arms."""
    turns = np.arange(320) / 320 * 2 * np.pi
    wave = np.sin(7 * turns)
    radius = 0.33 + 0.14 * np.sign(wave) * np.sqrt(np.abs(wave))
    angle = turns + 1.2 * radius
    return aperture.polygon(DIAMETER * np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1))


SHAPES: dict[str, Callable[[], Aperture]] = {
    "circle": lambda: aperture.circle(DIAMETER),
    "rectangle": lambda: aperture.rectangle(0.8 * DIAMETER, 0.5 * DIAMETER),
    "heptagon": lambda: aperture.iris(7, DIAMETER),
    "heptagon, turned by 5°": lambda: aperture.iris(7, DIAMETER, rotation=math.radians(5)),
    "iris(6, curvature=0.5)": lambda: aperture.iris(6, DIAMETER, 0.5),
    "iris(9, curvature=0.8)": lambda: aperture.iris(9, DIAMETER, 0.8),
    "iris(5, curvature=1)": lambda: aperture.iris(5, DIAMETER, 1.0),
    "whirl, 320 edges": whirl,
}


def error(shape: Aperture) -> float:
    """Return the largest difference from the reference, of the peak."""
    grid = Grid((61, 64), (2.7 / DIAMETER, 2.7 / DIAMETER), (3.3 / DIAMETER, 0.4 / DIAMETER))
    wanted = diffraction.far_field(shape, grid, "reference").amplitude
    found = diffraction.far_field(shape, grid, "polygons").amplitude
    return float(np.abs(found - wanted).max() / aperture.area(shape))


def seconds(task: Callable[[], object]) -> float:
    """Time one call."""
    start = time.perf_counter()
    task()
    return time.perf_counter() - start


def compare(size: int, runs: int) -> None:
    """Time all shapes and the FFT in turn, print the table."""
    generator = np.random.default_rng(SEED)
    picture = generator.random((size, size), dtype=np.float32)
    grid = Grid((size, size), (1 / DIAMETER, 1 / DIAMETER))
    shapes = {name: build() for name, build in SHAPES.items()}
    ways: dict[str, Callable[[], object]] = {
        "scipy.fft.rfft2": lambda: scipy.fft.rfft2(picture, workers=WORKERS)
    }
    for name, shape in shapes.items():
        ways[name] = lambda shape=shape: polygons.polygons_field(shape, grid)
        ways[name + ", power"] = lambda shape=shape: polygons.polygons_power(shape, grid)
    for way in ways.values():
        way()  # warms up
    times: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(runs):
        for name, way in ways.items():
            times[name].append(seconds(way))
    base = statistics.median(times["scipy.fft.rfft2"])
    print(f"{size} x {size}, spacing 1/diameter, {runs} runs\n")
    print(f"{'':40}{'median':>10}{'fastest':>10}{'ratio':>8}{'error':>10}")
    for name, taken in times.items():
        middle = statistics.median(taken)
        wrong = f"{error(shapes[name]):10.0e}" if name in shapes else ""
        print(f"{name:40}{middle * 1e3:7.1f} ms{min(taken) * 1e3:7.1f} ms{middle / base:8.2f}{wrong}")


def auxiliary(w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the Fresnel auxiliary functions f and g (Abramowitz and Stegun 7.3.5-6, 7.3.27-28)."""
    low = np.minimum(w, 30.0)
    sine_integral, cosine_integral = special.fresnel(low)
    phase = np.pi * low * low / 2
    s, c = 0.5 - sine_integral, 0.5 - cosine_integral
    f, g = s * np.cos(phase) - c * np.sin(phase), c * np.cos(phase) + s * np.sin(phase)
    high = np.maximum(w, 30.0)
    square = 1 / (np.pi * high * high)
    far_f, far_g = (1 - 3 * square**2) / (np.pi * high), (1 - 15 * square**2) * square / (np.pi * high)
    return np.where(w > 30, far_f, f), np.where(w > 30, far_g, g)


def fit_auxiliary(rounds: int = 200) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """Fit f = N_f / D and g = N_g / D together; return the error relative to |f + ig|, D, N_f, N_g.

    Linear least squares in N − f D, weighted by 1 / D of the round before and, more and more, where
    the error is largest (Sanathanan and Koerner 1963; Lawson 1961).
    """
    n = DEGREE
    w = np.concatenate([[0.0], np.geomspace(1e-3, 300, 6000), np.linspace(0.01, 6, 4000)])
    f, g = auxiliary(w)
    size = np.hypot(f, g)
    powers = (w[:, None] ** np.arange(n + 1)) / (1 + w[:, None]) ** n
    one = powers[:, 0]
    below, extra = np.ones_like(w), np.ones(2 * len(w))
    best = (np.inf, *(np.zeros(1),) * 3)
    for _ in range(rounds):
        none_f, none_g = np.zeros((len(w), n - 2)), np.zeros((len(w), n))
        upper = np.hstack([-(f / size)[:, None] * powers[:, 1:], powers[:, :n] / size[:, None], none_f])
        lower = np.hstack([-(g / size)[:, None] * powers[:, 1:], none_g, powers[:, : n - 2] / size[:, None]])
        rows = np.vstack([upper, lower]) * (extra / np.tile(below, 2))[:, None]
        wanted = np.concatenate([f / size * one, g / size * one]) * extra / np.tile(below, 2)
        scale = np.abs(rows).max(axis=0)
        found = np.linalg.lstsq(rows / scale, wanted, rcond=1e-16)[0] / scale
        d, top_f, top_g = np.r_[1, found[:n]], found[n : 2 * n], found[2 * n :]
        whole = Polynomial(d)(w)
        errors = [(Polynomial(top_f)(w) / whole - f) / size, (Polynomial(top_g)(w) / whole - g) / size]
        wrong = np.abs(np.concatenate(errors))
        below = whole * one
        if wrong.max() < best[0]:
            best = (wrong.max(), d, top_f, top_g)
        extra = extra * (0.2 + wrong / wrong.max()) ** 0.3
        extra /= extra.mean()
    return best


def interpolated(function: Callable[[np.ndarray], np.ndarray], degree: int, end: float) -> np.ndarray:
    """Return the powers' coefficients of a Chebyshev interpolation over [0, end]."""
    series = chebyshev.chebinterpolate(lambda t: function((t + 1) / 2 * end), degree)
    return Polynomial(chebyshev.cheb2poly(series))(Polynomial([-1, 2 / end])).coef


def bessel_parts(square: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return P and x Q of J1 = √(2 / πx) (P cos χ − Q sin χ) at (NEAR_DISC / x)²."""
    x = NEAR_DISC / np.sqrt(np.maximum(square, 1e-7))
    j, y, root = special.j1(x), special.y1(x), np.sqrt(np.pi * x / 2)
    cosine, sine = np.cos(x - 0.75 * np.pi), np.sin(x - 0.75 * np.pi)
    return root * (j * cosine + y * sine), root * x * (y * cosine - j * sine)


def bessel_core(square: np.ndarray) -> np.ndarray:
    """Return J1(x) / x at x²."""
    x = np.sqrt(np.maximum(square, 1e-12))
    return special.j1(x) / x


def fit() -> None:
    """Print all constants."""
    wrong, d, f, g = fit_auxiliary()
    print(f"auxiliary functions to {wrong:.1e}")
    tables = {
        "DENOMINATOR": d,
        "F_TOP": f,
        "G_TOP": g,
        "SINE": interpolated(lambda z: 2 * np.pi * np.sinc(2 * np.sqrt(z)), 5, 1 / 16),
        "BESSEL_P": interpolated(lambda z: bessel_parts(z)[0], 6, 1),
        "BESSEL_Q": interpolated(lambda z: bessel_parts(z)[1], 6, 1),
        "BESSEL_CORE": interpolated(bessel_core, 6, NEAR_DISC**2),
    }
    for name, values in tables.items():
        print(name, ", ".join(f"{value:.10g}" for value in values))


def main() -> None:
    """Read the command line and do what it says."""
    parser = argparse.ArgumentParser(description="Time the far field of outlines against a real FFT.")
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--fit", action="store_true", help="compute the kernels' constants instead")
    given = parser.parse_args()
    versions = ", ".join(
        f"{name} {importlib.metadata.version(name)}" for name in ("aureole", "numpy", "scipy", "numba")
    )
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, "
        f"{versions}, seed {SEED}"
    )
    if given.fit:
        fit()
    else:
        compare(given.size, given.runs)


if __name__ == "__main__":
    main()
