"""The surface paper's figures and the project's own, measured here beside what the paper prints.

A. Toisoul, A. Ghosh, "Practical acquisition and rendering of diffraction effects in surface reflectance", ACM
Transactions on Graphics, 2017. Its times are an Intel i7-4720HQ's and a GeForce GTX 960M's.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from aureole import refuse
from aureole.bench import timing
from aureole.bench.surface_environment import environment
from aureole.bench.surface_frames import frames
from aureole.bench.surface_measured import measured
from aureole.bench.surface_mitsuba import in_mitsuba
from aureole.bench.surface_orders import orders
from aureole.bench.surface_tables import tables
from aureole.records import Stage

CHOICES = ("table", "frame", "environment", "measurement", "orders", "mitsuba")
# Samples of a table and of a photograph on each side, as in section 4.3 of the paper.
TABLE, PHOTO, WAVELENGTHS = 2048, 1000, 81
QUICK_TABLE, QUICK_PHOTO = 512, 300
FRAME, QUICK_FRAME = (540, 960), (135, 240)


@dataclass(frozen=True)
class SurfaceBench:
    """What to measure.

    Parameters
    ----------
    runs : int
        How often each is timed.
    quick : bool
        Whether small tables, photographs and pictures are enough.
    only : tuple of str
        Tables to keep: "table", "frame", "environment", "measurement", "orders", "mitsuba"; all where none is
        named.
    """

    runs: int = 5
    quick: bool = False
    only: tuple[str, ...] = ()


def run_surface(bench: SurfaceBench) -> Iterator[Stage]:
    """Measure tables, frames, light from all around, the measurement, orders, and Mitsuba where it is.

    Parameters
    ----------
    bench : SurfaceBench
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
    quick = bench.quick
    size, photo = (QUICK_TABLE, QUICK_PHOTO) if quick else (TABLE, PHOTO)
    shape = QUICK_FRAME if quick else FRAME
    parts: dict[str, timing.Part] = {
        "table": lambda: tables(size, photo, WAVELENGTHS, runs),
        "frame": lambda: frames(shape, size, runs),
        "environment": lambda: environment(quick),
        "measurement": lambda: measured(photo, size),
        "orders": lambda: orders(size),
        "mitsuba": lambda: in_mitsuba(shape, 4 if quick else 64, runs),
    }
    wanted = [name for name in CHOICES if name in bench.only] or list(CHOICES)
    settings = {"runs": runs, "quick": quick, "only": list(bench.only), "seed": 1}
    return timing.finish("surface", settings, [parts[name] for name in wanted], ["mitsuba"])
