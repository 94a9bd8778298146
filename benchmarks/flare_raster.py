"""Time the rasters of lens-flare ghosts: quad by quad against tiles and merged primitives.

    python benchmarks/flare_raster.py [--grid 128] [--runs 5] [--size 1080x1920] [--lenses heliar,itoh,...]

The tile paper's five systems at its f-numbers, its counts of ghosts, three wavelengths; a light at (8°, 3°),
and a second at (-5°, 6°). Rays lie on `--grid` squared places over each ghost's own part of the pupil,
traced once. Times are of the raster alone, from primitives to picture, on all threads (Tables 2-8):

reference   unmerged quads, ghost after ghost, over the whole picture
tiles       unmerged quads in coarse tiles of 128 and dense ones of 64 pixels
light       the same of lightly merged primitives
heavy       the same of heavily merged ones
two         light, with both lights

Runs alternate; medians by the clock, and how many times less than the reference by the clock and by the work
of all processors (steadier on a busy machine). PSNR is against the reference's picture, exposed so that its
99.9th percentile is 1 and clipped; "energy" is the largest change of a ghost's energy. No chance is involved.
"""

import argparse
import os
import platform
import statistics
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from aureole import flare
from aureole.flare import barycentric, pupil, raster, tracing

SYSTEMS = {
    "heliar": ("heliar_tronnier_100mm", 16.0),
    "itoh": ("itoh_wide_zoom_123mm_seed", 32.0),
    "nikon": ("nikon_tele_zoom_140mm_seed", 16.0),
    "canon135": ("canon_tele_zoom_135mm", 32.0),
    "canon200": ("canon_tele_zoom_200mm", 32.0),
}
WAVELENGTHS = (610e-9, 550e-9, 465e-9)
LIGHTS = ((8.0, 3.0), (-5.0, 6.0))
TILES = ((None, 8), (128, 8), (128, 16), (128, 32), (128, 64), (None, 128))


def direction(degrees: tuple[float, float]) -> np.ndarray:
    """Return the unit vector towards a light at angles right and down."""
    towards = np.array([*np.tan(np.deg2rad(degrees)), 1.0])
    return towards / np.linalg.norm(towards)


def measured(tasks: dict[str, Callable[[], object]], runs: int) -> dict[str, tuple[float, float]]:
    """Return each task's median milliseconds by the clock and of work; the first round is not counted."""
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in tasks}
    for run in range(runs + 1):
        for name, task in tasks.items():
            clock, work = time.perf_counter(), time.process_time()
            task()
            spent = 1e3 * (time.perf_counter() - clock), 1e3 * (time.process_time() - work)
            if run:
                taken[name].append(spent)
    return {
        name: tuple(statistics.median(each[k] for each in times) for k in (0, 1))
        for name, times in taken.items()
    }


def psnr(picture: np.ndarray, truth: np.ndarray) -> float:
    """Return the PSNR of exposed, clipped pictures in decibels."""
    white = np.percentile(truth.max(axis=-1), 99.9)
    off = np.clip(picture / white, 0, 1) - np.clip(truth / white, 0, 1)
    return -10 * np.log10(max(np.mean(off**2), 1e-20))


def energies(found: flare.Primitives, frame: flare.Frame, count: int) -> np.ndarray:
    """Return the power of each ghost in its picture, ghosts as colours in threes."""
    powers = np.zeros(count)
    for first in range(0, count, 3):
        palette = np.zeros((count, 3))
        palette[np.arange(first, min(first + 3, count)), np.arange(min(3, count - first))] = 1.0
        kept = (found.ghost >= first) & (found.ghost < first + 3)
        arrays = found.corners[kept], found.attributes[kept], found.area[kept], found.ghost[kept]
        part = flare.Primitives(*arrays, found.ghost[kept], found.size[kept], found.outside)
        sums = raster.rasterize(part, palette, frame).sum(axis=(0, 1), dtype=np.float64)
        powers[first : first + 3] = sums[: min(3, count - first)]
    return powers


def system(name: str, shape: tuple[int, int], grid: int, runs: int) -> None:
    """Measure one system and print its lines."""
    file, f_number = SYSTEMS[name]
    lens = flare.load(file)
    frame = flare.frame_of(lens, shape)
    prepared = tracing.prepare(lens, WAVELENGTHS, f_number)
    ghosts = flare.ghosts(lens, "paper")
    sheets = [pupil.sheets(prepared, ghosts, direction(light), base=grid) for light in LIGHTS]
    one = {how: flare.construct(sheets[0], frame, merge=how) for how in ("none", "light", "heavy")}
    rows = [[3 * k, 3 * k + 1, 3 * k + 2] for k, each in enumerate(sheets) for _ in each]
    two = flare.construct([sheet for each in sheets for sheet in each], frame, rows, "light")
    palette = np.tile(np.eye(3), (2, 1))
    tasks: dict[str, Callable[[], np.ndarray]] = {
        "reference": lambda: raster.rasterize(one["none"], palette, frame, "reference"),
        "tiles": lambda: raster.rasterize(one["none"], palette, frame, "tiles"),
        "light": lambda: raster.rasterize(one["light"], palette, frame, "tiles"),
        "heavy": lambda: raster.rasterize(one["heavy"], palette, frame, "tiles"),
        "two": lambda: raster.rasterize(two, palette, frame, "tiles"),
    }
    times, truth = measured(tasks, runs), tasks["reference"]()
    exact = energies(one["none"], frame, len(ghosts))
    print(f"\n{name}: {len(sheets[0])} ghosts arrive")
    print("            primitives      ms  x less  x less work    PSNR  energy")
    for task, (clock, work) in times.items():
        found = one[{"reference": "none", "tiles": "none"}.get(task, task)] if task != "two" else two
        less = times["reference"][0] / clock, times["reference"][1] / work
        line = f"{task:10s} {len(found.area):11d} {clock:7.1f} {less[0]:7.2f} {less[1]:12.2f}"
        if task not in ("reference", "two"):
            lit = exact > 1e-6 * exact.sum()
            change = np.abs(energies(found, frame, len(ghosts))[lit] / exact[lit] - 1).max()
            line += f" {psnr(tasks[task](), truth):7.1f} {change:7.2%}"
        print(line)
    ratio = [times["two"][k] / times["light"][k] for k in (0, 1)]
    print(f"two lights cost {ratio[0]:.2f}x one by the clock, {ratio[1]:.2f}x by work")
    phases(one["light"], palette, frame, runs)


def phases(found: flare.Primitives, palette: np.ndarray, frame: flare.Frame, runs: int) -> None:
    """Print tile sizes with their phases and lists, and the coordinates, for lightly merged primitives."""
    print("tiles (light)  prepare  coarse   dense traversal ms   indices  memory MB")
    for tiles in TILES:
        efforts = [raster.rasterize_timed(found, palette, frame, tiles=tiles)[1] for _ in range(runs)]
        middle = [1e3 * statistics.median(getattr(e, n) for e in efforts) for n in ("prepare", "coarse")]
        middle += [1e3 * statistics.median(getattr(e, n) for e in efforts) for n in ("dense", "traversal")]
        numbers = " ".join(f"{value:7.1f}" for value in middle)
        label = "/".join(str(side) for side in tiles if side)
        print(f"{label:14s} {numbers} {efforts[0].dense_indices:13d} {efforts[0].memory / 1e6:8.1f}")
    ways = {
        way: partial(raster.rasterize, found, palette, frame, coordinates=way)
        for way in ("coverage", *barycentric.METHODS)
    }
    truth = ways["coverage"]()
    for way, (clock, work) in measured(ways, 1).items():
        print(f"{way:14s} {clock:7.1f} ms, work {work:7.1f} ms, PSNR {psnr(ways[way](), truth):5.1f}")


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--grid", type=int, default=128)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--size", default="1080x1920")
    parser.add_argument("--lenses", default=",".join(SYSTEMS))
    given = parser.parse_args()
    rows, columns = (int(n) for n in given.size.split("x"))
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} threads, numpy {np.__version__}")
    print(f"{columns}x{rows}, {given.grid}² rays a ghost and wavelength, medians of {given.runs}")
    for name in given.lenses.split(","):
        system(name, (rows, columns), given.grid, given.runs)


if __name__ == "__main__":
    main()
