"""The quad paper's tables and figures, measured here beside what it prints.

L. Scandolo, S. Lee, E. Eisemann, "Quad-based Fourier transform for efficient diffraction synthesis",
Computer Graphics Forum 37 (4), 2018. Its times are a GeForce GTX 1080 Ti's.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from aureole import refuse
from aureole.bench import timing
from aureole.bench.progressive import figure_10
from aureole.bench.quad_counts import table_1
from aureole.bench.quality import figure_8, figure_9
from aureole.bench.spectral import table_3
from aureole.bench.stages import figure_11
from aureole.bench.symmetry import table_2
from aureole.records import Stage

CHOICES = ("table-1", "table-2", "table-3", "figure-8", "figure-9", "figure-10", "figure-11")
SIZES = 5
SMALLEST = 32
# The figures are of one size.
FIGURE_SIZE = 1024


@dataclass(frozen=True)
class QuadPaperBench:
    """What to measure.

    Parameters
    ----------
    size : int
        Pixels on each side in the last column of the tables, a power of two; the others halve it, down to
        32. The figures are of this size, 1024 at most.
    runs : int
        How often each is timed.
    frames : int
        Of the moving shadow.
    only : tuple of str
        Tables and figures to keep; all where none is named.
    """

    size: int = 4096
    runs: int = 5
    frames: int = 41
    only: tuple[str, ...] = ()


def run_quad_paper(bench: QuadPaperBench) -> Iterator[Stage]:
    """Measure the paper's tables and figures.

    Parameters
    ----------
    bench : QuadPaperBench
        What to measure.

    Returns
    -------
    iterator of Stage
        The last one holds a `Report`.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range or a name is unknown.
    """
    refuse.at_least("size", bench.size, SMALLEST)
    if bench.size & (bench.size - 1):
        raise refuse.Refusal(f"'size' must be a power of two, such as 1024, got {bench.size}.")
    refuse.at_least("runs", bench.runs, 1)
    refuse.at_least("frames", bench.frames, 3)
    for name in bench.only:
        refuse.one_of("only", name, CHOICES)
    sizes = [side for side in (bench.size >> step for step in range(SIZES)) if side >= SMALLEST][::-1]
    side, runs = min(bench.size, FIGURE_SIZE), bench.runs
    parts: dict[str, timing.Part] = {
        "table-1": lambda: table_1(sizes),
        "table-2": lambda: table_2(sizes, runs),
        "table-3": lambda: table_3(sizes, runs),
        "figure-8": lambda: figure_8(side),
        "figure-9": lambda: figure_9(side, runs),
        "figure-10": lambda: figure_10(side, bench.frames),
        "figure-11": lambda: figure_11(side, runs),
    }
    wanted = [name for name in CHOICES if name in bench.only] or list(CHOICES)
    settings = {
        "size": bench.size,
        "runs": runs,
        "frames": bench.frames,
        "only": list(bench.only),
        "seed": None,
    }
    return timing.finish("quad-paper", settings, [parts[name] for name in wanted])
