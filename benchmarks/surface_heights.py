"""Time tables of gratings and of height fields, and judge series and the sharpening of a bokeh.

    python benchmarks/surface_heights.py [--runs 3] [--only gratings|heights|series|bokeh]

The height field is 96 x 96 samples of 0.1 µm: two crossed waves and noise, seed 1, 0.2 µm from the lowest to
the highest. "whole matrices" is `spread_orders` for each wavelength, one after the other: the reference.
Runs alternate; medians of the clock and of the processors' time, which is what other work on the machine
does not lengthen as much. The bokeh is a blazed grating of 600 lines a millimetre at 0.083 µm a pixel, with
the noise of 4000 counts, seed 7.
"""

import argparse
import os
import platform
import statistics
import time

import numpy as np
from scipy import ndimage

from aureole import light, surface
from aureole.surface.height import order_powers, spread_orders
from aureole.surface.table import cells

GRATINGS = ("cd", "dvd", "bluray", "lcd-342ppi", "lcd-534ppi", "blazed-600")
SIZE = 512


def field(depth=0.2e-6, tiles=1):
    """Return the height field, repeated."""
    y, x = np.mgrid[:96, :96]
    waves = np.sin(2 * np.pi * 4 * x / 96) + 0.6 * np.sin(2 * np.pi * (3 * y + x) / 96)
    waves = np.tile(waves, (tiles, tiles)) + 0.2 * np.random.default_rng(1).random((96 * tiles, 96 * tiles))
    return surface.height_field(depth * (waves - waves.min()) / np.ptp(waves), 0.1e-6)


def whole_matrices(heights, size, count):
    """Add each wavelength's pattern by matrix products."""
    t, b = cells(size), cells(size)[:, ::-1]
    total = np.zeros((size, size, 3))
    for wavelength, weight in zip(*light.quadrature(light.illuminant("E"), count), strict=True):
        powers = order_powers(heights, float(wavelength))
        total += spread_orders(powers, heights.pixel, float(wavelength), t, b)[..., None] * weight
    return total


def timed(ways, runs):
    """Run each way in turn; return medians of (clock, processors) and the last results."""
    times, results = {name: [] for name in ways}, {}
    for _ in range(runs):
        for name, way in ways.items():
            start = time.perf_counter(), time.process_time()
            results[name] = way()
            times[name].append((time.perf_counter() - start[0], time.process_time() - start[1]))
    medians = {
        name: [statistics.median(part) for part in zip(*found, strict=True)] for name, found in times.items()
    }
    return medians, results


def gratings(runs):
    """Time tables of 2048 x 2048."""
    ways = {name: lambda name=name: surface.table_from_grating(name) for name in GRATINGS}
    ways["radial"] = lambda: surface.table_from_grating(surface.radial_grating(surface.Lines(1.6e-6, 0.5e-6)))
    medians, results = timed(ways, runs)
    for name, (clock, busy) in medians.items():
        count = results[name].metadata["wavelengths"]
        print(f"| {name} | {count} wavelengths | {clock:.2f} s | {busy:.2f} s |")


def heights(runs):
    """Time tables of height fields, against the reference where that is not too slow."""
    one, wide = field(), field(tiles=6)
    surface.table_from_height(one, size=33, wavelengths=5)
    count = surface.table_from_height(one, size=SIZE).metadata["wavelengths"]
    ways = {
        f"{SIZE}²": lambda: surface.table_from_height(one, size=SIZE).values,
        f"{SIZE}², whole matrices": lambda: whole_matrices(one, SIZE, count),
    }
    medians, results = timed(ways, runs)
    fast, slow = results.values()
    more, _ = timed(
        {
            "1024²": lambda: surface.table_from_height(one, size=1024),
            "1024², 576² samples": lambda: surface.table_from_height(wide, size=1024),
            "Taylor tables of order 5, 256²": lambda: surface.taylor_tables(one, order=5),
        },
        runs,
    )
    for name, (clock, busy) in (medians | more).items():
        print(f"| {name} | {clock:.2f} s | {busy:.2f} s |")
    apart = np.abs(fast - slow).max() / slow.max()
    print(f"| largest difference from whole matrices | {apart:.1e} of the peak |")


def series():
    """Say how wrong series are at 450 nm, and which order is enough."""
    for depth in (0.02, 0.05, 0.1, 0.2, 0.4347):
        one = field(depth * 1e-6)
        errors = [f"{100 * surface.taylor_error(one, 450e-9, order):.3g} %" for order in (1, 2, 5)]
        print(f"| {depth} µm | {' | '.join(errors)} | {surface.taylor_order(one, 450e-9)} |")


def bokeh():
    """Fit a known grating before and after sharpening."""
    lines = surface.blazed_grating(600, 500e-9).along
    y, x = np.mgrid[:300, :300] - 149.5
    facets = (x * 0.083e-6 / lines.period) % 1.0
    for blur in (1.5, 3.0, 5.0):
        lit = ndimage.gaussian_filter((0.1 + 0.9 * facets) * (np.hypot(x, y) < 135), blur)
        seen = np.random.default_rng(7).poisson(4000 * lit) / 4000
        errors = []
        for count in (0, 10, 30, 100):
            found = surface.heights_from_bokeh(
                seen, known=lines, angle=0.0, deviation=blur if count else 0.0, iterations=max(count, 1)
            )
            errors.append(f"{100 * found.error:.1f} %")
        print(f"| {blur} px | {' | '.join(errors)} |")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--only", choices=("gratings", "heights", "series", "bokeh"))
    given = parser.parse_args()
    print(f"{platform.platform()}, Python {platform.python_version()}, {os.cpu_count()} processors")
    parts = {
        "gratings": lambda: gratings(given.runs),
        "heights": lambda: heights(given.runs),
        "series": series,
        "bokeh": bokeh,
    }
    for name, part in parts.items():
        if given.only in (None, name):
            print(f"\n{name}")
            part()


if __name__ == "__main__":
    main()
