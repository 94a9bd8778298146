"""From a photograph to a table, as section 4.3 of the surface paper has it: time, memory, and error."""

import subprocess
import sys
import time
from collections.abc import Generator, Iterator
from functools import partial
from typing import Any

import numpy as np

from aureole import light, surface
from aureole.bench.report import Column, Table
from aureole.bench.timing import alternate
from aureole.records import Stage
from aureole.surface.integrate import table_rows

SEED, HALF_RANGE, WAVELENGTH, WARP = 1, 1.0, 650e-9, 5
PRINTED = "a few seconds"
ROWS = 16  # of the table, of which the slow sums take one
# A process of its own, so that nothing else of the bench is counted. Linux hands the most that a process ever
# had on to those that it starts, but not what /proc says of each; kilobytes.
MEMORY = """
import resource, sys
import numpy as np
from aureole import surface
size, photo, wavelengths = map(int, sys.argv[1:4])
noise = np.random.default_rng(1).random((photo, photo), dtype=np.float32)
pattern = surface.diffraction_pattern(noise, 1.0, 650e-9)
surface.table_from_pattern(pattern, "E", size, wavelengths=wavelengths, sample=sys.argv[4])
try:
    with open("/proc/self/status") as lines:
        print(next(line.split()[1] for line in lines if line.startswith("VmHWM")))
except OSError:
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""
COLUMNS = (
    Column("sum", "{way}", words=True),
    Column("median", "{median_ms:.0f} ms"),
    Column("processors", "{busy_ms:.0f} ms"),
    Column("direct sum", "{direct_ms:.0f} ms"),
    Column("times", "{ratio:.0f}x"),
    Column("error", "{error:.0e}"),
    Column("whole process", "{memory_mb:.0f} MB"),
    Column("printed", "{printed}", words=True),
)


def pattern(photo: int) -> surface.DiffractionPattern:
    """Return noise as a photograph: nothing in it can be skipped.

    Parameters
    ----------
    photo : int
        Samples on each side.

    Returns
    -------
    DiffractionPattern
        At 650 nm, over |h| <= 1.
    """
    noise = np.random.default_rng(SEED).random((photo, photo), dtype=np.float32)
    return surface.diffraction_pattern(noise, HALF_RANGE, WAVELENGTH)


def tables(size: int, photo: int, wavelengths: int, runs: int) -> Iterator[Stage]:
    """Time tables by cells and by points beside the direct sum of the same.

    Parameters
    ----------
    size : int
        Samples of the table on each side.
    photo : int
        Samples of the photograph on each side.
    wavelengths : int
        How many are added.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    yield from compared(size, photo, wavelengths, runs, rows)
    for row in rows:
        yield Stage(0.99, f"memory, {row['way']}")
        row["memory_mb"] = memory(size, photo, wavelengths, row["way"])
    title = f"A table of {size}² from a photograph of {photo}², {wavelengths} wavelengths, warp {WARP}"
    notes = (
        f"Noise as a photograph, seed {SEED}. cell: means over the table's cells; point: values at its "
        "samples, the paper's Eq. 15. processors: time of all together. direct sum: of points, in float64, "
        f"wavelength by wavelength, on every {ROWS}th row, once, its processors' time by {ROWS}; times "
        "ours. error: largest difference from the same sum in float64, of its largest value. whole process: "
        "its largest memory, Python and libraries included. printed: on an Intel i7-4720HQ.",
    )
    yield Stage(1.0, "table", (Table("table", title, COLUMNS, tuple(rows), notes),))


def compared(
    size: int, photo: int, wavelengths: int, runs: int, rows: list[dict[str, Any]]
) -> Generator[Stage, None, None]:
    """Time tables and find their errors.

    Parameters
    ----------
    size, photo, wavelengths, runs : int
        As for `tables`.
    rows : list of dict
        To which a row is added for each way.

    Yields
    ------
    Stage
        Before each step.
    """
    source = pattern(photo)
    make = partial(surface.table_from_pattern, source, "E", size, wavelengths=wavelengths)
    tasks = {sample: partial(make, sample=sample) for sample in ("cell", "point")}
    times = yield from alternate(tasks, runs, label="table")
    for sample, spent in times.items():
        yield Stage(0.9, f"direct sum, {sample}")
        busy = time.process_time()
        found = tasks[sample]().values[::ROWS]
        busy = 1e3 * (time.process_time() - busy)
        start = time.process_time()
        truth = table_rows(source, light.illuminant("E"), size, slice(None, None, ROWS), wavelengths, sample)
        direct = 1e3 * (time.process_time() - start) * size / len(truth)
        row: dict[str, Any] = {
            "way": sample,
            "median_ms": spent,
            "busy_ms": busy,
            "error": float(np.abs(found - truth).max() / truth.max()),
        }
        if sample == "point":
            row |= {"direct_ms": direct, "ratio": direct / busy}
        if (sample, size, photo) == ("point", 2048, 1000):
            row["printed"] = PRINTED
        rows.append(row)


def memory(size: int, photo: int, wavelengths: int, sample: str) -> float:
    """Return the largest memory of a process that makes one table.

    Parameters
    ----------
    size : int
        Samples of the table on each side.
    photo : int
        Samples of the photograph on each side.
    wavelengths : int
        How many are added.
    sample : str
        By cells or by points.

    Returns
    -------
    float
        Megabytes.
    """
    words = [sys.executable, "-c", MEMORY, *map(str, (size, photo, wavelengths, sample))]
    said = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    return int(said) * 1024 / 1e6
