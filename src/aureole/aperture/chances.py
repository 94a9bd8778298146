"""Random numbers that are the same on every machine: the bits of PCG64, which never change."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def bits(seed: int | Sequence[int], count: int) -> NDArray[np.uint64]:
    """Return random bits.

    Parameters
    ----------
    seed : int or sequence of int
        Not negative; a sequence such as (seed, stream) starts a stream of its own.
    count : int
        How many.

    Returns
    -------
    ndarray of uint64, shape (count,)
        The outputs of PCG64.
    """
    return np.asarray(np.random.PCG64(seed).random_raw(count), dtype=np.uint64)


def uniform(seed: int | Sequence[int], count: int) -> NDArray[np.float64]:
    """Return random numbers in 0 <= x < 1.

    Parameters
    ----------
    seed : int or sequence of int
        Not negative; a sequence such as (seed, stream) starts a stream of its own.
    count : int
        How many.

    Returns
    -------
    ndarray of float64, shape (count,)
        Multiples of 2^-53.
    """
    return np.asarray((bits(seed, count) >> np.uint64(11)) * 2.0**-53)
