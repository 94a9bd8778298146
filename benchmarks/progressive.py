"""Time the progressive far field of a moving shadow against a fresh real FFT of every frame, in one run.

    python benchmarks/progressive.py [--size 1024] [--frames 101] [--radius 100] [--step 5 0] [--grey]

A circular shadow moves 5 px a frame through the middle of an opening; --step 4 3 takes it aslant, where
the change has no symmetry. Output is size × size samples at the FFT's own spacing, 1 / width. One side
updates the field and its power, both to the full plane; the other takes SciPy's rfft2, float32,
workers=2, and squares it to the full plane with NumPy. The sides alternate frame by frame; the ratio is
that of the medians. The error is the last frame's largest difference from `far_field`, of the peak.
Quads are means over every fourth frame: of its own quadtree, and of the update. Masks are
black and white as the paper's; --grey keeps the grey pixels along the openings' edges.
"""

import os

# Idle OpenMP threads that spin would slow SciPy's threads: both sides gain.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
os.environ.setdefault("GOMP_SPINCOUNT", "0")

import argparse
import importlib.metadata
import platform
import statistics
import time
from collections.abc import Callable

import numpy as np
import scipy.fft

from aureole import Aperture, Grid, aperture, diffraction

WORKERS = 2
DIAMETER = 3e-3
COUNTED = 4  # every so many frames

SHAPES: dict[str, Callable[[], Aperture]] = {
    "circle": lambda: aperture.circle(DIAMETER),
    "heptagon": lambda: aperture.iris(7, DIAMETER),
    "whirl": lambda: aperture.whirl(DIAMETER),
}


def frames(shape: Aperture, given: argparse.Namespace) -> list[Aperture]:
    """Paint an opening with a shadow at every place of its way."""
    size = given.size
    opening = aperture.rasterize(shape, size)
    if not given.grey:
        opening = np.round(opening)
    y, x = np.ogrid[:size, :size]
    painted = []
    for frame in range(given.frames):
        along = frame - given.frames // 2
        column, row = (size / 2 + along * step for step in given.step)
        shadow = (x + 0.5 - column) ** 2 + (y + 0.5 - row) ** 2 < given.radius**2
        painted.append(Aperture(DIAMETER, mask=np.where(shadow, np.float32(0), opening)))
    return painted


def fft_power(mask: np.ndarray) -> np.ndarray:
    """Transform a mask with SciPy and square it to the full plane."""
    size = len(mask)
    half = scipy.fft.rfft2(mask, workers=WORKERS)
    power = half.real**2 + half.imag**2
    whole = np.empty((size, size), np.float32)
    columns = power.shape[1]
    whole[:, :columns] = power
    whole[0, columns:] = power[0, size - columns : 0 : -1]
    whole[1:, columns:] = power[:0:-1, size - columns : 0 : -1]
    return whole


def seconds(task: Callable[[], object]) -> float:
    """Time one call."""
    start = time.perf_counter()
    task()
    return time.perf_counter() - start


def measure(painted: list[Aperture], size: int) -> dict[str, float]:
    """Follow a shadow frame by frame."""
    grid = Grid((size, size), (1 / DIAMETER, 1 / DIAMETER))
    progressive = diffraction.ProgressiveFarField(grid)
    progressive.update(painted[0])
    progressive.update(painted[1])
    ours, theirs, fresh, updated = [], [], [], []
    for index, frame in enumerate(painted[2:]):
        ours.append(seconds(lambda frame=frame: (progressive.update(frame), progressive.power())))
        theirs.append(seconds(lambda frame=frame: fft_power(frame.mask)))
        if index % COUNTED == 0:
            fresh.append(len(diffraction.quadtree(frame.mask, DIAMETER)))
            updated.append(sum(progressive.evaluated))
    found = progressive.update(painted[-1]).amplitude
    truth = diffraction.far_field(painted[-1], grid).amplitude
    return {
        "ours": statistics.median(ours) * 1e3,
        "theirs": statistics.median(theirs) * 1e3,
        "fresh": statistics.mean(fresh),
        "updated": statistics.mean(updated),
        "error": float(np.abs(found - truth).max() / np.abs(truth).max()),
    }


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Time a moving shadow against fresh FFTs.")
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--frames", type=int, default=101)
    parser.add_argument("--radius", type=float, default=100)
    parser.add_argument("--step", type=float, nargs=2, default=(5, 0))
    parser.add_argument("--grey", action="store_true")
    return parser.parse_args()


def main() -> None:
    """Measure every shape, print the table."""
    given = arguments()
    versions = ", ".join(
        f"{name} {importlib.metadata.version(name)}" for name in ("numpy", "scipy", "numba", "aureole")
    )
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, {versions}"
    )
    print(
        f"{given.size}², {given.frames} frames, shadow of radius {given.radius:g} px, step {given.step} px\n"
    )
    print(f"{'':12}{'update':>10}{'rfft2':>10}{'faster':>8}{'quads':>8}{'fresh':>8}{'part':>7}{'error':>10}")
    for name, make in SHAPES.items():
        row = measure(frames(make(), given), given.size)
        times = f"{row['ours']:7.2f} ms{row['theirs']:7.2f} ms{row['theirs'] / row['ours']:7.2f}x"
        quads = f"{row['updated']:8.0f}{row['fresh']:8.0f}{row['updated'] / row['fresh']:7.1%}"
        print(f"{name:12}{times}{quads}{row['error']:10.1e}")


if __name__ == "__main__":
    main()
