"""The eye thesis's tables, measured here beside what it prints.

J. Delavennat, "Physically-based Real-time Glare", thesis, Linköping University, 2021. Its times are a GeForce
GTX 1050 Ti's.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from aureole import refuse
from aureole.bench import timing
from aureole.bench.eye_frames import frames, memory
from aureole.bench.eye_patterns import fresh, summed, veil
from aureole.records import Stage

FIGURES = ("figure-4-1", "figure-4-2")
CHOICES = (*FIGURES, "memory", "fresh", "sum", "veil")
# Rows and columns of the thesis's two viewports.
VIEWPORTS = ((512, 910), (1024, 1820))
QUICK_VIEWPORTS = ((180, 320),)
# Samples on each side of the pupil's plane.
GRIDS, QUICK_GRIDS = (512, 1024, 2048, 4096), (512,)


@dataclass(frozen=True)
class EyeBench:
    """What to measure.

    Parameters
    ----------
    runs : int
        How often each is timed.
    quick : bool
        Whether a small picture and a coarse pupil are enough.
    only : tuple of str
        Tables to keep: "figure-4-1", "figure-4-2", "memory", "fresh", "sum", "veil"; all where none is named.
    """

    runs: int = 9
    quick: bool = False
    only: tuple[str, ...] = ()


def run_eye(bench: EyeBench) -> Iterator[Stage]:
    """Measure the thesis's tables, and the patterns beside the standard.

    Parameters
    ----------
    bench : EyeBench
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
    runs = 1 if bench.quick else refuse.at_least("runs", bench.runs, 1)
    for name in bench.only:
        refuse.one_of("only", name, CHOICES)
    viewports = QUICK_VIEWPORTS if bench.quick else VIEWPORTS
    grids = QUICK_GRIDS if bench.quick else GRIDS
    wanted = [name for name in CHOICES if name in bench.only] or list(CHOICES)
    timed = [name for name in FIGURES if name in wanted]
    parts: dict[str, timing.Part] = {
        "memory": lambda: memory(viewports),
        "fresh": lambda: fresh(grids, runs),
        "sum": lambda: summed(viewports[0], max(grids)),
        "veil": lambda: veil(max(grids)),
    }
    chosen = [lambda: frames(viewports, runs, timed)] if timed else []
    chosen += [parts[name] for name in wanted if name in parts]
    settings = {"runs": runs, "quick": bench.quick, "only": list(bench.only), "seed": 1}
    return timing.finish("eye", settings, chosen)
