"""Time `glare.area_power` as a whole, masks and all, by every method; and its adaptive samples.

    python benchmarks/area_light.py [--size 1024] [--runs 5]

Prints medians of one run, all taken in turn. `aureole bench area-light` times the sums alone, beside FFT.
The second table lets the number of samples follow from the tolerance, and says how far the result is from
that of 33 x 33 samples.
"""

import argparse
from functools import partial

import numpy as np

from aureole import aperture, glare
from aureole.bench import shapes, timing
from aureole.records import Grid

METHODS = ("transforms", "modes", "progressive")
TOLERANCES = (0.05, 0.02, 0.01)
LIGHT = glare.AreaLight(aperture.circle(0.045))
LEAF = aperture.polygon([(-0.35, -0.1), (0.0, -0.18), (0.4, 0.15), (0.05, 0.12)])


def seen(
    size: int, method: str, tolerance: float = 0.01, across: int | None = None, slant: bool = False
) -> glare.AreaPower:
    """Return the power of a round light past a leaf or slanted bars, before a heptagon."""
    silhouette = aperture.railing(0.12, 0.22, 7, 4.0, 0.4) if slant else LEAF
    opening, grid = shapes.outline("heptagon", 1.0), Grid((size, size), (1.0, 1.0))
    before = [aperture.occluder(silhouette, 1.0)]
    return glare.area_power(opening, before, LIGHT, grid, across, tolerance, size, method)


def whole(size: int, runs: int) -> None:
    """Time 77 samples of a round light by every method."""
    print(f"{'occluder':14}{'method':14}{'samples':>8}{'transforms':>11}{'ms':>8}{'faster':>8}")
    for slant in (False, True):
        ways = {way: partial(seen, size, way, across=9, slant=slant) for way in METHODS}
        times: dict[str, list[float]] = {way: [] for way in METHODS}
        found = {way: task() for way, task in ways.items()}
        for _ in range(runs):
            for way, task in ways.items():
                times[way].append(timing.milliseconds(task))
        for way in METHODS:
            median, slowest = (float(np.median(times[name])) for name in (way, METHODS[0]))
            counts = f"{found[way].samples:8d}{found[way].transforms:11d}"
            print(f"{'bars' if slant else 'leaf':14}{way:14}{counts}{median:8.0f}{slowest / median:7.1f}x")


def adaptive(size: int) -> None:
    """Say how many samples a tolerance takes, and how far they are from very many."""
    print(f"\n{'tolerance':>10}{'samples':>9}{'error said':>12}{'estimated':>11}{'from 33 x 33':>14}")
    truth = seen(size, "modes", 1e-4, across=33)
    for tolerance in TOLERANCES:
        found = seen(size, "modes", tolerance)
        apart = glare.difference(found.power, truth.power)
        print(f"{tolerance:10g}{found.samples:9d}{found.error:12.1e}{found.estimated:11.1e}{apart:14.1e}")


def main() -> None:
    """Measure, print both tables."""
    parser = argparse.ArgumentParser(description="Time area lights.")
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--runs", type=int, default=5)
    given = parser.parse_args()
    machine = timing.environment()
    print(f"{machine['platform']}, {machine['processors']} processors, {machine['versions']}\n")
    whole(given.size, given.runs)
    adaptive(given.size // 4)


if __name__ == "__main__":
    main()
