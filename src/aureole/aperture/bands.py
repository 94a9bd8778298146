"""Work on rows in bands, one after another on each thread."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

# A band of this many rows is worth a thread's while, and there are no more bands than these a thread.
LEAST_ROWS, BANDS_A_THREAD = 32, 4


def in_bands(work: Callable[[int, int], object], rows: int) -> None:
    """Do work on all rows, on as many threads as this process may use.

    Parameters
    ----------
    work : callable
        Called with a first row and the row after the last; it must let other threads run. It must not itself
        work in bands: all threads could then wait for each other.
    rows : int
        How many.
    """
    threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    bands = max(1, min(rows // LEAST_ROWS, threads * BANDS_A_THREAD))
    edges = [rows * band // bands for band in range(bands + 1)]
    if bands == 1:
        work(0, rows)
        return
    for done in _pool(threads).map(work, edges[:-1], edges[1:]):
        assert done is None


@lru_cache(maxsize=1)
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="bands")


if hasattr(os, "register_at_fork"):
    # A forked process has none of its parent's threads.
    os.register_at_fork(after_in_child=_pool.cache_clear)
