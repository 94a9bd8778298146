"""Time tables of diffractive surfaces from a photograph, against direct sums, on this machine.

    python benchmarks/surface_table.py [--size 2048] [--photo 1000] [--wavelengths 81] [--runs 7]

Noise, seed 1, is the photograph, over |h| <= 1 at 650 nm; the light is of equal energy, the warp 5. All
ways alternate: "cell" is what `table_from_pattern` does, means over the table's cells; "point" looks the
pattern up at the table's samples, as the surface paper's Eq. 15 does. The direct sums are those a script
would do: one wavelength after the other, bilinear look-ups of all samples by SciPy's `map_coordinates` in
float32, and the same in NumPy in float64, on every 16th row, its time times 16. Times are by the clock, and
of all processors together, which holds on a busy machine, too; ratios are of these. Errors are largest
differences from the float64 sums, of their largest value. Then what light the table of a comb of orders
holds, by both ways, beside what it should.
"""

import argparse
import os
import platform
import statistics
import time

import numpy as np
from scipy import ndimage

from aureole import light, surface
from aureole.bench.surface_tables import HALF_RANGE, ROWS, SEED, WAVELENGTH, memory, pattern
from aureole.bench.timing import processor
from aureole.surface.integrate import table_rows
from aureole.surface.table import axes, axis, energy


def with_scipy(source, size, wavelengths):
    """Return some rows of a table as one would make them with SciPy."""
    places, weights = light.quadrature(light.illuminant("E"), wavelengths)
    half = (source.values.shape[0] - 1) / 2
    h = axis(size)
    total = np.zeros((len(h[::ROWS]), size, 3), np.float32)
    for wavelength, weight in zip(places, weights, strict=True):
        scale = WAVELENGTH / wavelength
        where = np.meshgrid(
            half * (1 + scale * h[::ROWS] / HALF_RANGE), half * (1 + scale * h / HALF_RANGE), indexing="ij"
        )
        found = ndimage.map_coordinates(source.values, where, order=1, mode="grid-constant")
        for channel in range(3):
            total[..., channel] += np.float32(scale**4 * weight[channel]) * found
    return total


def clocked(task):
    """Return the milliseconds of one call by the clock and of all processors, and what it returned."""
    start, busy = time.perf_counter(), time.process_time()
    found = task()
    return 1e3 * (time.perf_counter() - start), 1e3 * (time.process_time() - busy), found


def compare(size, photo, wavelengths, runs):
    """Print times, ratios and errors."""
    source, lamp = pattern(photo), light.illuminant("E")
    rows = slice(None, None, ROWS)
    tasks = {
        "cell": lambda: surface.table_from_pattern(source, "E", size, wavelengths=wavelengths).values,
        "point": lambda: (
            surface.table_from_pattern(source, "E", size, wavelengths=wavelengths, sample="point").values
        ),
        "direct, SciPy float32": lambda: with_scipy(source, size, wavelengths),
        "direct, NumPy float64": lambda: table_rows(source, lamp, size, rows, wavelengths, "point"),
    }
    for name in ("cell", "point"):
        tasks[name]()  # compiles
    taken = {name: [] for name in tasks}
    found = {}
    for run in range(runs):
        for name, task in tasks.items():
            if run < 2 or "direct" not in name:
                *spent, found[name] = clocked(task)
                taken[name].append(np.array(spent) * (ROWS if "direct" in name else 1))
    truths = {
        "cell": table_rows(source, lamp, size, rows, wavelengths, "cell"),
        "point": found["direct, NumPy float64"],
    }
    middle = {
        name: [statistics.median(each) for each in zip(*spans, strict=True)] for name, spans in taken.items()
    }
    print(f"\n{'':24}{'median':>12}{'processors':>12}{'of cell':>10}{'error':>10}{'memory':>10}")
    for name, (clock, busy) in middle.items():
        said = f"{name:24}{clock:9.0f} ms{busy:9.0f} ms{busy / middle['cell'][1]:9.1f}x"
        if name in truths:
            error = np.abs(found[name][rows] - truths[name]).max() / truths[name].max()
            said += f"{error:10.1e}{memory(size, photo, wavelengths, name):7.0f} MB"
        print(said, flush=True)


def kept(size):
    """Print what light tables hold of a photograph of a comb of sharp orders."""
    reach, count = 0.024, 1001
    h = np.linspace(-reach, reach, count)
    comb = sum(np.exp(-(((h - k * reach / 20) / (reach / 500)) ** 2) / 2) for k in range(-18, 19))
    source = surface.diffraction_pattern(np.outer(comb, comb), reach, 530e-9)
    held = source.values.sum(dtype=float) * (h[1] - h[0]) ** 2
    print(f"\nlight of a comb of orders over |h| < {reach}, held by a table of {size}²")
    for sample in ("cell", "point"):
        table = surface.table_from_pattern(source, light.line(530e-9), size, sample=sample)
        widest = np.diff(axes(table)[1][np.abs(axes(table)[1]) < reach]).max() / (h[1] - h[0])
        print(f"{sample:8}{energy(table)[1] / held:8.4f}   (cells up to {widest:.1f} samples wide)")


def main():
    """Read the command line and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--size", type=int, default=2048)
    parser.add_argument("--photo", type=int, default=1000)
    parser.add_argument("--wavelengths", type=int, default=81)
    parser.add_argument("--runs", type=int, default=7)
    given = parser.parse_args()
    print(
        f"{processor()}, {os.cpu_count()} processors, Python {platform.python_version()}, numpy "
        f"{np.__version__}, seed {SEED}, {given.runs} runs (direct sums 2), medians; {given.size}² from "
        f"{given.photo}², {given.wavelengths} wavelengths"
    )
    compare(given.size, given.photo, given.wavelengths, given.runs)
    kept(given.size)


if __name__ == "__main__":
    main()
