"""The samples that a picture and a kernel are laid out on, and the transforms along them.

A circle has a length of twos, threes and fives; a torus is a circle down the columns and one along the
rows. Rows are transformed two at a time as one complex sequence, blocks of columns while they stay in
the cache (`_kernels`). Work is shared out among threads that are kept from call to call.
"""

import os
import queue
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray
from scipy.fft import next_fast_len

from aureole import refuse
from aureole.picture import _kernels

Pixels = NDArray[Any]
Value = np.floating[Any]


@dataclass(frozen=True, eq=False)
class Circle:
    """A circle of n samples: what transforms along it read, and where they leave each frequency.

    Parameters
    ----------
    radices : ndarray of int64, shape (S,)
        Factors of n, in the order of the stages.
    cosines, sines : ndarray, shape (n,)
        Of −2πj/n.
    places : ndarray of int64, shape (n + 1,)
        Row of the work array where `down` leaves each frequency; frequency n is frequency 0.
    """

    radices: NDArray[np.int64]
    cosines: Pixels
    sines: Pixels
    places: NDArray[np.int64]

    def down(self, work: Pixels) -> None:
        """Transform a work array in place (`aureole.picture._kernels`)."""
        _kernels.down(work, self.radices, self.cosines, self.sines)

    def up(self, work: Pixels) -> None:
        """Transform a work array back in place, times n."""
        _kernels.up(work, self.radices, self.cosines, self.sines)


@dataclass(frozen=True, eq=False)
class Torus:
    """The samples that picture and kernel are laid out on: a circle down the columns, one along the rows.

    Parameters
    ----------
    down, along : Circle
        Of the columns and of the rows.
    centre : tuple of int
        The kernel's centre (row, column) in the kernel.
    threads : int
        How many to use.
    """

    down: Circle
    along: Circle
    centre: tuple[int, int]
    threads: int

    @property
    def scale(self) -> Value:
        """What the way down and back up must be multiplied by."""
        scale: Value = self.down.cosines.dtype.type(1 / (len(self.down.cosines) * len(self.along.cosines)))
        return scale

    @property
    def blocks(self) -> int:
        """In how many blocks of columns a half spectrum comes."""
        return len(self.along.cosines) // 2 // _kernels.LANES + 1

    def half_spectrum(self) -> Pixels:
        """Return room for a half spectrum (`aureole.picture._kernels`)."""
        shape = (self.blocks, len(self.down.cosines), _kernels.WIDTH)
        return np.empty(shape, dtype=self.down.cosines.dtype)

    def kernel_spectrum(self, kernel: Pixels, channel: int, half: Pixels | None = None) -> Pixels:
        """Transform one channel of a kernel, its centre turned to sample 0."""
        spectrum = self.half_spectrum() if half is None else half
        sizes = len(self.down.cosines), len(self.along.cosines)
        shifts = (sizes[0] - self.centre[0]) % sizes[0], (sizes[1] - self.centre[1]) % sizes[1]

        def transform(block: int) -> None:
            spectrum[block, len(kernel) - self.centre[0] : sizes[0] - self.centre[0]] = 0
            self.down.down(spectrum[block])

        self.rows_down(kernel, shifts, {channel: spectrum})
        share(transform, range(len(spectrum)), self.threads)
        return spectrum

    def filter(
        self, picture: Pixels, channel: int, spectrum: Pixels, half: Pixels, lowest: Value, out: Pixels
    ) -> None:
        """Convolve one channel, by way of the half spectrum that is given as room to work in."""
        scale = self.scale

        def multiply(block: int) -> None:
            half[block, len(picture) :] = 0
            self.down.down(half[block])
            _kernels.multiply(half[block], spectrum[block], scale)
            self.down.up(half[block])

        self.rows_down(picture, (0, 0), {channel: half})
        share(multiply, range(len(half)), self.threads)
        self.rows_up({channel: half}, lowest, out)

    def back(self, half: Pixels, channel: int, lowest: Value, out: Pixels) -> None:
        """Transform a half spectrum back into one channel of the picture, nothing below the lowest value."""
        share(lambda block: self.down.up(half[block]), range(len(half)), self.threads)
        self.rows_up({channel: half}, lowest, out)

    def rows_down(self, pixels: Pixels, shifts: tuple[int, int], halves: Mapping[int, Pixels]) -> None:
        """Transform the rows of some channels, turned round by the shifts (row, column)."""

        def block(channel: int, first: int, count: int, work: Pixels) -> None:
            _kernels.load(pixels, channel, first, count, shifts[1], work)
            self.along.down(work)
            _kernels.split(work, self.along.places, first, count, shifts[0], halves[channel])

        self.share_rows(block, len(pixels), halves)

    def rows_up(self, halves: Mapping[int, Pixels], lowest: Value, out: Pixels) -> None:
        """Transform the kept rows back into some channels of the picture, nothing below the lowest value."""

        def block(channel: int, first: int, count: int, work: Pixels) -> None:
            _kernels.join(halves[channel], self.along.places, first, count, work)
            self.along.up(work)
            _kernels.store(work, first, count, channel, lowest, out)

        self.share_rows(block, len(out), halves)

    def share_rows(
        self, task: Callable[[int, int, int, Pixels], None], rows: int, channels: Iterable[int]
    ) -> None:
        """Do a task for every block of rows of each channel, with a work array that no other thread uses."""
        free: queue.SimpleQueue[Pixels] = queue.SimpleQueue()
        for _ in range(self.threads):
            free.put(np.empty((len(self.along.cosines), _kernels.WIDTH), dtype=self.along.cosines.dtype))
        size = 2 * _kernels.LANES

        def with_work(item: tuple[int, int]) -> None:
            work = free.get()
            try:
                task(*item, min(size, rows - item[1]), work)
            finally:
                free.put(work)

        share(with_work, product(channels, range(0, rows, size)), self.threads)


def torus_for(
    shape: tuple[int, ...],
    kernel_shape: tuple[int, ...],
    centre: tuple[int, int],
    dtype: DTypeLike,
    threads: int,
) -> Torus:
    """Choose the samples for pictures and kernels of given sizes: what wraps round misses the picture.

    Parameters
    ----------
    shape, kernel_shape : tuple of int
        (rows, columns, ...) of the pictures and of the kernels.
    centre : tuple of int
        The kernels' centre.
    dtype : dtype
        float32 or float64.
    threads : int
        How many to use.

    Returns
    -------
    Torus
        Ready for transforms.
    """
    down, along = (
        circle(next_fast_len(length + max(before, size - 1 - before), real=True), np.dtype(dtype))
        for length, size, before in zip(shape[:2], kernel_shape[:2], centre, strict=True)
    )
    return Torus(down, along, centre, threads)


@lru_cache(maxsize=16)
def circle(n: int, dtype: np.dtype[Any]) -> Circle:
    """Return what the transforms of n samples side by side read.

    Parameters
    ----------
    n : int
        A product of twos, threes and fives.
    dtype : dtype
        float32 or float64.

    Returns
    -------
    Circle
        Its arrays are shared, not to be written.
    """
    radices, rest = [], n
    for factor in (4, 5, 3, 2):
        while rest % factor == 0:
            radices.append(factor)
            rest //= factor
    frequencies = np.zeros(1, dtype=np.int64)
    for factor in reversed(radices):
        frequencies = np.concatenate([q + factor * frequencies for q in range(factor)])
    places = np.argsort(frequencies)
    angles = -2 * np.pi * np.arange(n) / n
    turns = np.cos(angles).astype(dtype), np.sin(angles).astype(dtype)
    return Circle(np.array(radices, dtype=np.int64), *turns, np.append(places, places[0]))


def share(task: Callable[[Any], None], items: Iterable[Any], threads: int) -> None:
    """Do a task for every item, on so many threads.

    Parameters
    ----------
    task : callable
        Takes an item; lets the interpreter go while it computes.
    items : iterable
        What to do it for.
    threads : int
        How many to use; 1 does all in the caller's.
    """
    if threads == 1:
        for item in items:
            task(item)
    else:
        for _ in _crew(threads).map(task, items):
            pass


@lru_cache(maxsize=8)
def _crew(threads: int) -> ThreadPoolExecutor:
    """Threads that wait for the next call: starting them anew takes as long as a small transform."""
    return ThreadPoolExecutor(threads, thread_name_prefix="aureole")


if hasattr(os, "register_at_fork"):
    # A forked process has none of its parent's threads.
    os.register_at_fork(after_in_child=_crew.cache_clear)


def thread_count(threads: int | None) -> int:
    """Return how many threads to use.

    Parameters
    ----------
    threads : int or None
        None takes one for each processor that this process may use.

    Returns
    -------
    int
        At least 1.
    """
    if threads is not None:
        return refuse.at_least("threads", threads, 1)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
