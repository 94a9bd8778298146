"""What a worker of this machine does before its first frame; Dask calls it in each process that it starts."""

import os
import signal
from collections.abc import Sequence
from typing import Any

# The environment's word for how many workers share the machine.
WORKERS = "AUREOLE_WORKERS"


def dask_setup(worker: Any) -> None:
    """Keep a worker to its share of the cores, since it has as many threads as cores, and deaf to Ctrl-C.

    Parameters
    ----------
    worker : distributed.Worker
        Its name is its number, from 0.
    """
    # Ctrl-C reaches all processes of a terminal; who started the workers hears it, and ends them.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(os, "sched_setaffinity"):
        cores = sorted(os.sched_getaffinity(0))
        os.sched_setaffinity(0, share(cores, int(worker.name), int(os.environ[WORKERS])))


def share(cores: Sequence[int], number: int, count: int) -> list[int]:
    """Return the cores of one worker: all have as many, but for one, and none is idle.

    Parameters
    ----------
    cores : sequence of int
        Of the machine.
    number : int
        The worker's, from 0.
    count : int
        How many workers there are.

    Returns
    -------
    list of int
        At least one; several workers share one where there are more of them.
    """
    first, last = (turn * len(cores) // count for turn in (number, number + 1))
    return list(cores[first:last]) or [cores[first % len(cores)]]
