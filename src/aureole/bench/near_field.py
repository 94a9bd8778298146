"""The near field, measured here: the quad paper's table and figure, other libraries, growth, colour."""

from collections.abc import Iterator
from dataclasses import dataclass

from aureole import refuse
from aureole.bench import timing
from aureole.bench.near_colour import SIZE as COLOUR_SIZE
from aureole.bench.near_colour import colours
from aureole.bench.near_growth import growth
from aureole.bench.near_levels import figure_6
from aureole.bench.near_peers import PEERS, near_peers
from aureole.bench.near_table import table_4
from aureole.bench.quad_paper import FIGURE_SIZE, SIZES, SMALLEST
from aureole.records import Stage

TASKS = ("table-4", "figure-6", "peers", "growth", "colour")
CHOICES = (*TASKS, *(peer.PACKAGE.lower() for peer in PEERS))


@dataclass(frozen=True)
class NearFieldBench:
    """What to measure.

    Parameters
    ----------
    size : int
        Pixels on each side in the table's last rows, a power of two; the others halve it, down to 32.
        Everything else is of this size, 1024 at most, and colour 512.
    runs : int
        How often each is timed.
    only : tuple of str
        Tasks (table-4, figure-6, peers, growth, colour) and peers (scipy, diffractsim, lightpipes) to keep;
        all tasks where none is named, and all peers where none is.
    """

    size: int = 4096
    runs: int = 5
    only: tuple[str, ...] = ()


def run_near_field(bench: NearFieldBench) -> Iterator[Stage]:
    """Measure the near field.

    Parameters
    ----------
    bench : NearFieldBench
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
    for name in bench.only:
        refuse.one_of("only", name, CHOICES)
    peers = [peer for peer in PEERS if peer.PACKAGE.lower() in bench.only] or list(PEERS)
    sizes = [side for side in (bench.size >> step for step in range(SIZES)) if side >= SMALLEST][::-1]
    side, runs = min(bench.size, FIGURE_SIZE), bench.runs
    parts: dict[str, timing.Part] = {
        "table-4": lambda: table_4(sizes, runs),
        "figure-6": lambda: figure_6(side, runs),
        "peers": lambda: near_peers(side, runs, peers),
        "growth": lambda: growth(side, runs),
        "colour": lambda: colours(min(side, COLOUR_SIZE), runs),
    }
    wanted = [task for task in TASKS if task in bench.only]
    if not wanted:
        # A peer's name alone asks for what it takes part in.
        wanted = ["peers"] if bench.only else list(TASKS)
    settings = {"size": bench.size, "runs": runs, "only": list(bench.only), "seed": None}
    packages = [peer.PACKAGE for peer in peers] if "peers" in wanted else []
    return timing.finish("near-field", settings, [parts[task] for task in wanted], packages)
