"""Time the power of a shape's far field with and without symmetry and culling (quad paper, Table 2).

    python benchmarks/culling.py [--size 4096] [--shape heptagon] [--fill 0.5] [--finer 1] [--runs 5]

The raster is anti-aliased, across a part of the mask (`--fill`); as many frequencies as pixels, at the
FFT's own spacing or finer (`--finer 4`: a quarter of it). All rows but the last are products of the
mask's distinct rows, float32, in bands with one BLAS thread each, from the mask to |F|² in each run:

none        complex spectra of the distinct rows, the whole plane
folding     the mask folded about its centre: real products, but the whole plane
symmetry    `rows_power`: the quarter plane, mirrored
culling     as none, in the tiles that a test on their edges finds, and that test
both        `far_power` with `cull`
scipy       the real FFT of the mask and its power on the whole plane (at a finer spacing the mask stands
            in a frame of zeros, and only the wanted frequencies are kept)

Tables of cosines are kept between runs, as `rows` keeps them. The runs alternate; medians, and how many
times less than none, by the clock and by the work of all processors (steadier on a busy machine).
"lost" is the energy in the plane that culling leaves out, "off" the largest difference from symmetry
over the peak. No chance is involved, so there is no seed.
"""

import argparse
import importlib.metadata
import os
import platform
import statistics
import time
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import scipy

from aureole import Aperture, Grid, diffraction
from aureole.bench import peer_scipy, shapes
from aureole.diffraction import _kernels_culling, _kernels_rows, culling
from aureole.diffraction.rows import in_threads, rows_power

LEVELS = (1e-6, 1e-7, 1e-8)
BAND = 256


def tables(edges: np.ndarray, frequencies: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return ∫ cos(2πux) dx and −∫ sin(2πux) dx from the first edge to the others."""
    rate = np.where(frequencies == 0, 1.0, 2 * np.pi * frequencies)
    turns = 2 * np.pi * np.outer(edges, frequencies)
    sine, cosine = np.sin(turns) / rate, np.cos(turns) / rate
    real, imaginary = (sine - sine[0])[1:], (cosine - cosine[0])[1:]
    real[:, frequencies == 0] = (edges - edges[0])[1:, None]
    return real.astype(np.float32), imaginary.astype(np.float32)


class Plain:
    """The same transform without symmetry: complex spectra of the distinct rows, all frequencies."""

    def __init__(self, shape: Aperture, grid: Grid) -> None:
        """Build the tables, and those of the derivatives on the tiles' edges."""
        self.mask, self.size = np.asarray(shape.mask), len(np.asarray(shape.mask))
        self.keys = 2 * np.random.default_rng(0).integers(0, 1 << 63, self.size, dtype=np.uint64) + 1
        edges = np.arange(self.size + 1) / self.size - 0.5
        reach = 2 * np.abs(edges[:-1][self.mask.any(axis=0)]).max()
        self.rate = np.pi * reach
        self.stride = max(1, min(culling.TILE // 4, int(culling.FINE / (reach * grid.spacing[0]))))
        self.tables, self.lines = [], []
        for count, frequencies in zip(grid.shape, grid.axes(), strict=True):
            lines = np.rint(np.linspace(0, count, round(count / culling.TILE) + 1)).astype(np.int64)
            at = frequencies[np.minimum(lines, count - 1)]
            after, before = (tables(edges, at + shift) for shift in (0.01, -0.01))
            slopes = [(a - b) / np.float32(0.02) for a, b in zip(after, before, strict=True)]
            whole = tables(edges, frequencies)
            self.tables.append([np.hstack(pair) for pair in zip(whole, slopes, strict=True)])
            self.lines.append(lines)
        self.out = np.empty(grid.shape, dtype=np.float32)

    def sides(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the spectra of the places of each distinct row, and of the rows."""
        sums = self.mask.sum(axis=1, dtype=np.float64)
        hashes, _ = _kernels_rows.hash_lines(self.mask.view(np.uint32), sums, self.keys)
        found, first, labels = np.unique(hashes, return_index=True, return_inverse=True)
        if found[0] == 0:
            first, labels = first[1:], labels - 1
        places = np.argsort(labels, kind="stable")
        starts = np.searchsorted(labels[places], np.arange(len(first) + 1))
        lines = np.ascontiguousarray(self.mask[first])
        left, right = [], []
        for across, along in zip(*self.tables, strict=True):
            left.append(_kernels_rows.shared_spectra(places, starts, across))
            right.append(_kernels_rows.line_spectra(lines, along))
        unit = np.complex64(1j)
        return left[0] + unit * left[1], right[0] + unit * right[1]

    def whole(self) -> np.ndarray:
        """Return the power of the whole plane."""
        rows, columns = self.out.shape
        left, right = self.sides()

        def band(top: int) -> None:
            field = left[:, top : min(top + BAND, rows)].T @ right[:, :columns]
            self.out[top : top + BAND] = field.real**2 + field.imag**2

        in_threads(band, range(0, rows, BAND))
        return self.out

    def culled(self, level: float) -> np.ndarray:
        """Return the power in the tiles that may exceed a level, zero elsewhere."""
        out = np.zeros(self.out.shape, dtype=np.float32)
        sides = self.sides()
        threshold = culling.CAUTION * level * float(self.mask.mean(dtype=np.float64)) ** 2
        lit = np.zeros([len(lines) - 1 for lines in self.lines], dtype=np.bool_)
        for axis in (0, 1):
            count = out.shape[axis]
            lines = np.minimum(self.lines[axis], count - 1)
            across = np.hstack([sides[axis][:, lines], sides[axis][:, count:]]).T
            along = sides[1 - axis][:, : out.shape[1 - axis] : self.stride]
            found = np.empty((len(across), along.shape[1]), dtype=np.complex64)
            bands = [slice(low, low + 2 * BAND) for low in range(0, along.shape[1], 2 * BAND)]
            in_threads(lambda b, a=across, o=along, f=found: np.matmul(a, o[:, b], out=f[:, b]), bands)
            power = found.real**2 + found.imag**2
            bright = power[: len(lines)] + power[len(lines) :] / np.float32(self.rate**2)
            target = lit.T if axis else lit
            _kernels_culling.mark_tiles(bright, self.lines[1 - axis], self.stride, threshold, target)

        def tiles(row: int) -> None:
            top, bottom = self.lines[0][row : row + 2]
            steps = np.flatnonzero(np.diff(lit[row].astype(np.int8), prepend=0, append=0))
            for begin, end in pairwise(steps):
                if lit[row, begin]:
                    columns = slice(self.lines[1][begin], self.lines[1][end])
                    field = sides[0][:, top:bottom].T @ sides[1][:, columns]
                    out[top:bottom, columns] = field.real**2 + field.imag**2

        in_threads(tiles, range(len(lit)))
        return out


def medians(tasks: dict[str, Callable[[], object]], runs: int) -> dict[str, tuple[float, float]]:
    """Time tasks in turn, by the clock and by all processors' work; the first time does not count."""
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in tasks}
    for run in range(runs + 1):
        for name, task in tasks.items():
            start, work = time.perf_counter(), time.process_time()
            task()
            if run:
                taken[name].append((1e3 * (time.perf_counter() - start), 1e3 * (time.process_time() - work)))
    return {
        name: (statistics.median(each[0] for each in spent), statistics.median(each[1] for each in spent))
        for name, spent in taken.items()
    }


def main() -> None:
    """Print a row for each combination and level."""
    parser = argparse.ArgumentParser(description="Time the far field's power with symmetry and culling.")
    parser.add_argument("--size", type=int, default=4096, help="even")
    parser.add_argument("--shape", choices=shapes.OUTLINES, default="heptagon")
    parser.add_argument("--fill", type=float, default=0.5)
    parser.add_argument("--finer", type=int, default=1)
    parser.add_argument("--runs", type=int, default=5)
    given = parser.parse_args()
    shape = shapes.raster(given.shape, given.size, given.fill)
    mask, step = np.asarray(shape.mask), 1 / given.finer
    grid = Grid((given.size, given.size), (step, step))
    aside = Grid(grid.shape, grid.spacing, (1e-9 * step, 1e-9 * step))
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, NumPy "
        f"{np.__version__}, SciPy {scipy.__version__}, Aureole {importlib.metadata.version('aureole')}\n"
        f"{given.shape} across {given.fill:g} of {given.size}² pixels, {given.size}² frequencies at 1/"
        f"{given.finer} of the FFT's spacing, {given.runs} runs, medians\n"
    )
    plain = Plain(shape, grid)
    tasks: dict[str, Callable[[], np.ndarray]] = {
        "none": plain.whole,
        "folding": lambda: rows_power(shape, aside),
        "symmetry": lambda: rows_power(shape, grid),
        **{f"culling {level:g}": lambda level=level: plain.culled(level) for level in LEVELS},
        **{
            f"both {level:g}": lambda level=level: diffraction.far_power(shape, grid, "rows", cull=level)
            for level in LEVELS
        },
        "scipy": lambda: (
            peer_scipy.padded_power(mask, given.finer) if given.finer > 1 else peer_scipy.real_power(mask)
        ),
    }
    truth = rows_power(shape, grid)
    peak, energy = float(truth.max()), truth.sum(dtype=np.float64)
    print(f"{'':16}{'lit':>8}{'ms':>9}{'ratio':>8}{'CPU ms':>9}{'ratio':>8}{'lost':>10}{'off':>10}")
    found = medians(tasks, given.runs)
    none = found["none"]
    for name, (clock, work) in found.items():
        times = f"{clock:9.1f}{none[0] / clock:8.2f}{work:9.1f}{none[1] / work:8.2f}"
        if name == "scipy":
            print(f"{name:24}{times}")
            continue
        power = tasks[name]()
        lost = 1 - power.sum(dtype=np.float64) / energy if name[:4] in ("cull", "both") else 0.0
        lit = 100 * np.count_nonzero(power) / power.size
        print(f"{name:16}{lit:7.2f}%{times}{lost:10.1e}{np.abs(power - truth).max() / peak:10.1e}")


if __name__ == "__main__":
    main()
