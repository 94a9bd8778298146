"""Work on a picture in bands of rows, one after another on each thread."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

# A band of this many rows is worth a thread's while, and there are no more bands than these a thread.
LEAST_ROWS, BANDS_A_THREAD = 32, 4


def in_bands(work: Callable[[int, int], object], rows: int) -> None:
    """Do work on all rows of a picture, on as many threads as there are cores.

    Parameters
    ----------
    work : callable
        Called with a first row and the row after the last; it must let other threads run.
    rows : int
        Of the picture.
    """
    threads = os.cpu_count() or 1
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
