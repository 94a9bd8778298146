"""Count the quads of four shapes with and without merging across levels, and time their transforms.

    python benchmarks/quadtree.py [--size 1024] [--runs 7]

Each shape fills half of the mask, anti-aliased and binary; noise stands for a photograph. As many
frequencies as pixels at the FFT's own spacing. The runs alternate; medians in ms. No chance but the
noise, of seed 1.
"""

import argparse
import importlib.metadata
import os
import platform
import statistics
import time
from collections.abc import Callable

import numpy as np
import scipy

from aureole import Aperture, Grid, aperture, diffraction
from aureole.diffraction.quads import quads_field

SHAPES = {
    "box": aperture.rectangle(0.5, 0.5),
    "circle": aperture.circle(0.5),
    "heptagon": aperture.iris(7, 0.5),
    "whirl": aperture.whirl(0.5),
}


def masks(size: int) -> dict[str, np.ndarray]:
    """Draw the shapes, anti-aliased and binary, and noise."""
    drawn = {}
    for name, shape in SHAPES.items():
        mask = aperture.rasterize(Aperture(1.0, shape.outlines), size)
        drawn[name] = mask
        drawn[f"{name}, binary"] = (mask >= 0.5).astype(np.float32)
    drawn["noise"] = np.random.default_rng(1).random((size, size), dtype=np.float32)
    return drawn


def medians(tasks: dict[str, Callable[[], object]], runs: int) -> dict[str, float]:
    """Time tasks in turn; the first time does not count."""
    taken: dict[str, list[float]] = {name: [] for name in tasks}
    for run in range(runs + 1):
        for name, task in tasks.items():
            start = time.perf_counter()
            task()
            if run:
                taken[name].append(1e3 * (time.perf_counter() - start))
    return {name: statistics.median(spent) for name, spent in taken.items()}


def main() -> None:
    """Print a line for each mask."""
    parser = argparse.ArgumentParser(description="Count quads and time their transforms.")
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--runs", type=int, default=7)
    given = parser.parse_args()
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, NumPy "
        f"{np.__version__}, SciPy {scipy.__version__}, Aureole {importlib.metadata.version('aureole')}\n"
        f"{given.size}² pixels and frequencies, {given.runs} runs, medians in ms, seed 1\n"
    )
    print(f"{'':18}{'quads':>9}{'merged':>9}{'tree':>9}{'+ merge':>9}{'field':>9}{'merged':>9}{'auto':>9}")
    grid = Grid((given.size, given.size), (1.0, 1.0))
    for name, mask in masks(given.size).items():
        plain, merged = (diffraction.quadtree(mask, 1.0, merge=merge) for merge in (False, True))
        shape = Aperture(1.0, mask=mask)
        tasks: dict[str, Callable[[], object]] = {
            "tree": lambda mask=mask: diffraction.quadtree(mask, 1.0),
            "merge": lambda mask=mask: diffraction.quadtree(mask, 1.0, merge=True),
            "plain": lambda quads=plain: quads_field(quads, grid),
            "merged": lambda quads=merged: quads_field(quads, grid),
            "auto": lambda shape=shape: diffraction.far_field(shape, grid),
        }
        found = medians(tasks, given.runs)
        print(f"{name:18}{len(plain):9}{len(merged):9}" + "".join(f"{found[each]:9.1f}" for each in tasks))


if __name__ == "__main__":
    main()
