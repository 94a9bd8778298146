"""Other libraries on the same far-field work, in one run, each as its own documentation shows it."""

from collections.abc import Iterator
from dataclasses import dataclass

from aureole import refuse
from aureole.bench import timing
from aureole.bench.peer_ways import PEERS, peers_of
from aureole.bench.starbursts import starbursts
from aureole.bench.zooms import zooms
from aureole.records import Stage

TASKS = ("zoom", "starburst")
CHOICES = (*TASKS, *(peer.PACKAGE.lower() for peer in PEERS))


@dataclass(frozen=True)
class PeersBench:
    """What to compare.

    Parameters
    ----------
    size : int
        Pixels of the mask and of the result on each side; even.
    runs : int
        How often each is timed; a loop over wavelengths runs once.
    only : tuple of str
        Tasks (zoom, starburst) and peers (scipy, prysm, hcipy, diffractsim, dlux) to keep; all
        tasks where none is named, and all peers where none is.
    """

    size: int = 1024
    runs: int = 5
    only: tuple[str, ...] = ()


def run_peers(bench: PeersBench) -> Iterator[Stage]:
    """Compare with the peers that are installed.

    Parameters
    ----------
    bench : PeersBench
        What to compare.

    Returns
    -------
    iterator of Stage
        The last one holds a `Report`.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range or a name is unknown.
    """
    refuse.at_least("size", bench.size, 16)
    if bench.size % 2:
        raise refuse.Refusal(f"'size' must be even, got {bench.size}.")
    refuse.at_least("runs", bench.runs, 1)
    for name in bench.only:
        refuse.one_of("only", name, CHOICES)
    peers = peers_of(bench.only)
    parts: dict[str, timing.Part] = {
        "zoom": lambda: zooms(bench.size, bench.runs, peers),
        "starburst": lambda: starbursts(bench.size, bench.runs, peers),
    }
    wanted = [task for task in TASKS if task in bench.only] or list(TASKS)
    settings = {"size": bench.size, "runs": bench.runs, "only": list(bench.only), "seed": None}
    packages = [peer.PACKAGE for peer in peers]
    return timing.finish("peers", settings, [parts[task] for task in wanted], packages)
