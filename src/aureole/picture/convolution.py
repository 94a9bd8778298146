"""Convolution of a linear picture with a kernel, the picture's size, black outside the picture.

The kernel's centre is its pixel (rows // 2, columns // 2): a kernel that is 1 there and 0 elsewhere
changes nothing. A kernel has one channel for all, or one for each channel of the picture.

The fast method is a Fourier transform that does only what is needed. Its circle has N + max(K // 2,
K − 1 − K // 2) samples, not N + K − 1: what wraps round may fall on everything but the picture
itself, so the kept part is still exact. Rows are transformed two at a time as one complex sequence,
empty rows not at all, columns in blocks that stay in the cache, and the product is taken while the
block is there.

Its rounding is that of the bright parts, spread over the whole picture: in single precision the error
is about 2e-7 of the result's root mean square, and nowhere above 2e-7 or so of its maximum, but it has
nothing to do with a pixel's own value, so pixels a million times darker than the brightest may be off
by per cents. Where neither input is negative, noise below zero is cut off. `precision="double"`
lowers all this by nine decimal digits.
"""

import os
import queue
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray
from scipy.fft import next_fast_len

from aureole import refuse
from aureole.picture import _kernels

Pixels = NDArray[Any]
Value = np.floating[Any]

PRECISIONS: dict[str, DTypeLike] = {"single": np.float32, "double": np.float64}
DIRECT_PRODUCTS = 4_000_000  # up to so many products a direct sum is quicker than preparing a transform


def convolve(
    pixels: ArrayLike,
    kernel: ArrayLike,
    method: str = "auto",
    precision: str = "single",
    threads: int | None = None,
) -> Pixels:
    """Convolve a linear picture with a kernel, same size out, black outside the picture.

    Parameters
    ----------
    pixels : array_like, shape (rows, columns) or (rows, columns, channels)
        Linear colour, without alpha.
    kernel : array_like, shape (rows, columns) or (rows, columns, channels)
        Centre at (rows // 2, columns // 2); one channel, or as many as the picture.
    method : str
        "reference" sums directly in double precision; "fft" transforms; "auto" takes the quicker.
    precision : str
        "single" computes and returns float32; "double" float64.
    threads : int, optional
        How many to use; by default one for each processor that this process may use.

    Returns
    -------
    ndarray of float32 or float64, shape of `pixels`
        Not negative where neither input is negative.
    """
    dtype = PRECISIONS[refuse.one_of("precision", precision, PRECISIONS)]
    picture, response = _checked("pixels", pixels, dtype), _checked("kernel", kernel, dtype)
    _refuse_channels(picture, response.shape[2])
    chosen = refuse.one_of("method", method, ("auto", *METHODS))
    if chosen == "auto":
        products = picture.size * response.shape[0] * response.shape[1]
        chosen = "reference" if products <= DIRECT_PRODUCTS else "fft"
    result = METHODS[chosen](picture, response, _thread_count(threads))
    return result.reshape(np.shape(pixels))


class Convolver:
    """A kernel that is transformed once, to convolve many pictures of one size with it.

    Parameters
    ----------
    kernel : array_like, shape (rows, columns) or (rows, columns, channels)
        Centre at (rows // 2, columns // 2); one channel, or as many as the pictures.
    shape : tuple of int
        The pictures' (rows, columns); a third number is not needed.
    precision : str
        "single" computes and returns float32; "double" float64.
    threads : int, optional
        How many to use; by default one for each processor that this process may use.
    """

    def __init__(
        self, kernel: ArrayLike, shape: tuple[int, ...], precision: str = "single", threads: int | None = None
    ) -> None:
        dtype = PRECISIONS[refuse.one_of("precision", precision, PRECISIONS)]
        response = _checked("kernel", kernel, dtype)
        self.shape = tuple(refuse.at_least("shape", length, 1) for length in shape[:2])
        response, self._torus = _prepared(response, self.shape, _thread_count(threads))
        channels = range(response.shape[2])
        self._spectra = [self._torus.kernel_spectrum(response, channel) for channel in channels]
        self._is_positive = bool(response.min() >= 0)

    def __call__(self, pixels: ArrayLike) -> Pixels:
        """Convolve one picture.

        Parameters
        ----------
        pixels : array_like, shape (rows, columns) or (rows, columns, channels)
            Linear colour, without alpha, of the size that was prepared for.

        Returns
        -------
        ndarray of float32 or float64, shape of `pixels`
            Not negative where neither the picture nor the kernel is negative.
        """
        refuse.shape_of("pixels", pixels, (*self.shape, None)[: np.ndim(pixels)])
        picture = _checked("pixels", pixels, self._torus.down.cosines.dtype)
        _refuse_channels(picture, len(self._spectra))
        out = np.empty_like(picture, order="C")
        half, lowest = self._torus.half_spectrum(), _lowest(picture, self._is_positive)
        for channel in range(picture.shape[2]):
            spectrum = self._spectra[min(channel, len(self._spectra) - 1)]
            self._torus.filter(picture, channel, spectrum, half, lowest, out)
        return out.reshape(np.shape(pixels))


def _by_sum(picture: Pixels, kernel: Pixels, threads: int) -> Pixels:
    """Add the picture once for each pixel of the kernel, shifted and weighted, in double precision."""
    kernel, (centre_y, centre_x) = _cropped(kernel, picture.shape)
    rows, columns, channels = picture.shape
    high, wide, _ = kernel.shape
    padded = np.zeros((rows + high - 1, columns + wide - 1, channels))
    padded[high - 1 - centre_y :, wide - 1 - centre_x :][:rows, :columns] = picture
    total = np.zeros(picture.shape)
    for y, x in np.argwhere(np.any(kernel != 0, axis=2)):
        top, left = high - 1 - y, wide - 1 - x
        total += padded[top : top + rows, left : left + columns] * kernel[y, x].astype(np.float64)
    return total.astype(picture.dtype)


def _by_transform(picture: Pixels, kernel: Pixels, threads: int) -> Pixels:
    """Transform kernel and picture channel by channel, so that one channel's spectra are held at a time."""
    kernel, torus = _prepared(kernel, picture.shape, threads)
    out = np.empty_like(picture, order="C")
    half, spectrum = torus.half_spectrum(), torus.half_spectrum()
    lowest = _lowest(picture, bool(kernel.min() >= 0))
    for channel in range(picture.shape[2]):
        if channel < kernel.shape[2]:
            torus.kernel_spectrum(kernel, channel, spectrum)
        torus.filter(picture, channel, spectrum, half, lowest, out)
    return out


METHODS: dict[str, Callable[[Pixels, Pixels, int], Pixels]] = {"reference": _by_sum, "fft": _by_transform}


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
class _Torus:
    """The samples that picture and kernel are laid out on: a circle down the columns, one along the rows."""

    down: Circle
    along: Circle
    centre: tuple[int, int]
    threads: int

    def half_spectrum(self) -> Pixels:
        blocks = len(self.along.cosines) // 2 // _kernels.LANES + 1
        return np.empty((blocks, len(self.down.cosines), _kernels.WIDTH), dtype=self.down.cosines.dtype)

    def kernel_spectrum(self, kernel: Pixels, channel: int, half: Pixels | None = None) -> Pixels:
        """Transform one channel of a kernel, its centre turned to sample 0."""
        spectrum = self.half_spectrum() if half is None else half
        sizes = len(self.down.cosines), len(self.along.cosines)
        shifts = (sizes[0] - self.centre[0]) % sizes[0], (sizes[1] - self.centre[1]) % sizes[1]

        def transform(block: int) -> None:
            spectrum[block, len(kernel) - self.centre[0] : sizes[0] - self.centre[0]] = 0
            self.down.down(spectrum[block])

        self._rows_down(kernel, channel, shifts, spectrum)
        _share(transform, range(len(spectrum)), self.threads)
        return spectrum

    def filter(
        self, picture: Pixels, channel: int, spectrum: Pixels, half: Pixels, lowest: Value, out: Pixels
    ) -> None:
        """Convolve one channel, by way of the half spectrum that is given as room to work in."""
        scale = half.dtype.type(1 / (len(self.down.cosines) * len(self.along.cosines)))

        def product(block: int) -> None:
            half[block, len(picture) :] = 0
            self.down.down(half[block])
            _kernels.multiply(half[block], spectrum[block], scale)
            self.down.up(half[block])

        self._rows_down(picture, channel, (0, 0), half)
        _share(product, range(len(half)), self.threads)
        self._rows_up(half, channel, lowest, out)

    def _rows_down(self, pixels: Pixels, channel: int, shifts: tuple[int, int], half: Pixels) -> None:
        """Transform the rows of one channel, turned round by the shifts (row, column)."""

        def block(first: int, count: int, work: Pixels) -> None:
            _kernels.load(pixels, channel, first, count, shifts[1], work)
            self.along.down(work)
            _kernels.split(work, self.along.places, first, count, shifts[0], half)

        self._share_rows(block, len(pixels))

    def _rows_up(self, half: Pixels, channel: int, lowest: Value, out: Pixels) -> None:
        """Transform the kept rows back into one channel of the picture, nothing below the lowest value."""

        def block(first: int, count: int, work: Pixels) -> None:
            _kernels.join(half, self.along.places, first, count, work)
            self.along.up(work)
            _kernels.store(work, first, count, channel, lowest, out)

        self._share_rows(block, len(out))

    def _share_rows(self, task: Callable[[int, int, Pixels], None], rows: int) -> None:
        """Do a task for every block of rows, with a work array that no other thread is using."""
        free: queue.SimpleQueue[Pixels] = queue.SimpleQueue()
        for _ in range(self.threads):
            free.put(np.empty((len(self.along.cosines), _kernels.WIDTH), dtype=self.along.cosines.dtype))
        size = 2 * _kernels.LANES

        def with_work(first: int) -> None:
            work = free.get()
            task(first, min(size, rows - first), work)
            free.put(work)

        _share(with_work, range(0, rows, size), self.threads)


def _prepared(kernel: Pixels, shape: tuple[int, ...], threads: int) -> tuple[Pixels, _Torus]:
    """Crop a kernel to what counts, and choose the samples for it and the picture."""
    response, centre = _cropped(kernel, shape)
    down, along = (
        circle(next_fast_len(length + max(before, size - 1 - before), real=True), kernel.dtype)
        for length, size, before in zip(shape[:2], response.shape[:2], centre, strict=True)
    )
    return response, _Torus(down, along, centre, threads)


def _cropped(kernel: Pixels, shape: tuple[int, ...]) -> tuple[Pixels, tuple[int, int]]:
    """Cut off what no pixel of the picture can reach; return the rest and its centre."""
    cuts, centres = [], []
    for size, length in zip(kernel.shape[:2], shape[:2], strict=True):
        before, after = min(size // 2, length - 1), min(size - 1 - size // 2, length - 1)
        cuts.append(slice(size // 2 - before, size // 2 + after + 1))
        centres.append(before)
    return kernel[cuts[0], cuts[1]], (centres[0], centres[1])


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


def _share(task: Callable[[int], None], items: Iterable[int], threads: int) -> None:
    """Do a task for every item, on so many threads."""
    with ThreadPoolExecutor(threads) as pool:
        for _ in pool.map(task, items):
            pass


def _lowest(picture: Pixels, kernel_is_positive: bool) -> Value:
    """The lowest value that a result can have: rounding must not make light negative."""
    lowest: Value = picture.dtype.type(0 if kernel_is_positive and picture.min() >= 0 else -np.inf)
    return lowest


def _thread_count(threads: int | None) -> int:
    if threads is not None:
        return refuse.at_least("threads", threads, 1)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _checked(name: str, array: ArrayLike, dtype: DTypeLike) -> Pixels:
    """Refuse what is not a picture; return it with channels, in the type to compute in."""
    found = refuse.shape_of(name, array, (None,) * (3 if np.ndim(array) == 3 else 2))
    return found.reshape((*found.shape[:2], -1)).astype(dtype, copy=False)


def _refuse_channels(picture: Pixels, count: int) -> None:
    if count not in (1, picture.shape[2]):
        raise refuse.Refusal(
            f"'kernel' must have 1 channel or the picture's {picture.shape[2]}, got {count}."
        )
