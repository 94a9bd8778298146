"""Kernels kept as spectra in 16 bits, mixed by weights and convolved with a picture in one go.

A kernel that is even about its centre has a real spectrum, so half a plane of real numbers holds it. They
are rounded to 16 bits, each row of 64 neighbours in steps of a 32767th of its largest: the result is off by
about 1e-5 of what the kernels spread, root mean square, where half floats would be off by 1e-4. The sum over
a kernel's pixels, its frequency zero, is kept in double precision beside them, so that no light is lost or
made. Kernels without their cores spread glare only, so that the error has nothing to do with the picture's
own light.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.picture import _kernels, _kernels_mix
from aureole.picture.torus import Torus, share, thread_count, torus_for

STEPS = 32767  # from zero to a row's largest number
# Largest imaginary part of a spectrum, as a part of its root mean square, that passes for rounding.
ODD = 1e-3


@dataclass(frozen=True, eq=False)
class KernelMix:
    """Kernels of one size as spectra in 16 bits, for pictures of one size.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns) of the pictures.
    reach : tuple of int
        (rows, columns) of the kernels, both odd; the centre is in the middle.
    spectra : ndarray of int16, shape (count, channels, blocks, samples, 64 or 128)
        Real parts and, where kernels are not even, imaginary parts, in steps.
    steps : ndarray of float32, shape (count, channels, blocks, samples)
        Size of the steps of each row.
    sums : ndarray of float64, shape (count, channels)
        Of the kernels' pixels.
    """

    shape: tuple[int, int]
    reach: tuple[int, int]
    spectra: NDArray[np.int16]
    steps: NDArray[np.float32]
    sums: NDArray[np.float64]

    @classmethod
    def empty(
        cls,
        shape: tuple[int, int],
        reach: tuple[int, int],
        count: int,
        channels: int = 3,
        even: bool = True,
    ) -> "KernelMix":
        """Return room for kernels, all zero.

        Parameters
        ----------
        shape : tuple of int
            (rows, columns) of the pictures.
        reach : tuple of int
            (rows, columns) of the kernels, odd and at most 2 N − 1 of the pictures' N.
        count, channels : int
            How many kernels, of how many channels.
        even : bool
            Whether all kernels are even about their centres, which halves the memory.

        Returns
        -------
        KernelMix
            To be filled with `put`.
        """
        for length, most in zip(reach, shape, strict=True):
            if refuse.at_least("reach", length, 1) % 2 == 0 or length > 2 * most - 1:
                raise refuse.Refusal(f"'reach' must be odd and at most {2 * most - 1}, got {length}.")
        torus = _torus(shape, reach, 1)
        samples, numbers = len(torus.down.cosines), _kernels.LANES * (1 if even else 2)
        spectra = np.zeros((count, channels, torus.blocks, samples, numbers), dtype=np.int16)
        steps = np.zeros(spectra.shape[:4], dtype=np.float32)
        return cls(shape, reach, spectra, steps, np.zeros((count, channels)))

    @property
    def is_even(self) -> bool:
        """Whether it holds even kernels only."""
        return bool(self.spectra.shape[-1] == _kernels.LANES)

    @property
    def nbytes(self) -> int:
        """Bytes of memory that the spectra take."""
        return int(self.spectra.nbytes + self.steps.nbytes)

    def put(self, index: int, kernel: ArrayLike, threads: int | None = None) -> None:
        """Transform a kernel and keep it.

        Parameters
        ----------
        index : int
            Its place.
        kernel : array_like, shape (rows, columns, channels)
            Of the size `reach`.
        threads : int, optional
            How many to use; by default one for each processor that this process may use.

        Raises
        ------
        refuse.Refusal
            Where its shape is another one, or it is not even and only even ones have room.
        """
        channels = self.sums.shape[1]
        pixels = np.asarray(refuse.shape_of("kernel", kernel, (*self.reach, channels)), dtype=np.float32)
        torus = _torus(self.shape, self.reach, thread_count(threads))
        half = torus.half_spectrum()
        for channel in range(channels):
            self.sums[index, channel] = pixels[..., channel].sum(dtype=np.float64)
            torus.kernel_spectrum(pixels, channel, half)
            # What lies beyond the last frequency is never written.
            used = len(torus.along.cosines) // 2 + 1 - _kernels.LANES * (len(half) - 1)
            parts = half[..., : 2 * _kernels.LANES].reshape(*half.shape[:2], 2, _kernels.LANES)
            parts[-1, ..., used:] = 0
            # Frequency zero is kept as the sum; its neighbours have finer steps without it.
            parts[0, 0, 0, 0] = 0
            self._round(parts, index, channel)

    def _round(self, parts: NDArray[np.float32], index: int, channel: int) -> None:
        """Round real and imaginary parts, (blocks, samples, 2, 64), to steps of their rows."""
        if self.is_even:
            largest, mean_square = float(np.abs(parts).max()), float(np.mean(np.square(parts)))
            if float(np.abs(parts[:, :, 1]).max()) > ODD * max(mean_square**0.5, ODD * largest):
                raise refuse.Refusal(
                    "'kernel' must be even about its centre, or room be made with even=False."
                )
            parts = parts[:, :, :1]
        rows = parts.reshape(self.spectra.shape[2:])
        steps = np.abs(rows).max(axis=2) / np.float32(STEPS)
        self.steps[index, channel] = steps
        self.spectra[index, channel] = np.rint(rows / np.where(steps > 0, steps, 1)[..., None])


class MixedConvolver:
    """Convolve pictures with weighted sums of kept kernels, in buffers that are kept, too.

    Its buffers serve one call at a time.

    Parameters
    ----------
    kernels : KernelMix
        The kernels.
    threads : int, optional
        How many to use; by default one for each processor that this process may use.
    """

    def __init__(self, kernels: KernelMix, threads: int | None = None) -> None:
        self.kernels = kernels
        self._torus = _torus(kernels.shape, kernels.reach, thread_count(threads))
        channels = range(kernels.sums.shape[1])
        self._halves = {channel: self._torus.half_spectrum() for channel in channels}

    def __call__(
        self,
        pixels: NDArray[np.float32],
        mix: Iterable[tuple[int, float]],
        out: NDArray[np.float32] | None = None,
        lowest: float = -np.inf,
    ) -> NDArray[np.float32]:
        """Convolve one picture.

        Parameters
        ----------
        pixels : ndarray of float32, shape (rows, columns, channels)
            Linear colour.
        mix : iterable of (int, float)
            Which kernels, and how much of each.
        out : ndarray of float32, shape of `pixels`, optional
            Where the result shall lie.
        lowest : float
            What lies below is raised to it: 0 where neither picture nor kernels are negative.

        Returns
        -------
        ndarray of float32, shape of `pixels`
            Black outside the picture.
        """
        result = np.empty_like(pixels, order="C") if out is None else out
        for _ in self.steps(pixels, mix, result, lowest):
            pass
        return result

    def steps(
        self,
        pixels: NDArray[np.float32],
        mix: Iterable[tuple[int, float]],
        out: NDArray[np.float32],
        lowest: float = -np.inf,
    ) -> Iterator[str]:
        """Convolve one picture step by step.

        Parameters
        ----------
        pixels : ndarray of float32, shape (rows, columns, channels)
            As for a call.
        mix : iterable of (int, float)
            As for a call.
        out : ndarray of float32, shape of `pixels`
            As for a call.
        lowest : float
            As for a call.

        Yields
        ------
        str
            The step that is done: "rows forward", "columns and product", "rows back".
        """
        kernels, channels = self.kernels, self.kernels.sums.shape[1]
        refuse.shape_of("pixels", pixels, (*kernels.shape, channels))
        chosen, weights, sums = self._weights(mix)
        self._torus.rows_down(pixels, (0, 0), self._halves)
        yield "rows forward"
        rows = len(pixels)

        def multiply(item: tuple[int, int]) -> None:
            channel, block = item
            work = self._halves[channel][block]
            work[rows:] = 0
            self._torus.down.down(work)
            _kernels_mix.multiply_mix(
                work, kernels.spectra, kernels.steps, chosen, weights, channel, block, sums[channel]
            )
            self._torus.down.up(work)

        blocks = kernels.spectra.shape[2]
        share(multiply, [(c, b) for c in range(channels) for b in range(blocks)], self._torus.threads)
        yield "columns and product"
        self._torus.rows_up(self._halves, np.float32(lowest), out)
        yield "rows back"

    def _weights(self, mix: Iterable[tuple[int, float]]) -> tuple[Any, Any, Any]:
        """Return places (k,), their weights (k,) and the sums (channels,), scaled for the way back up."""
        wanted = [(index, weight) for index, weight in mix if weight != 0]
        chosen = np.array([index for index, _ in wanted], dtype=np.int64)
        weights = np.array([weight for _, weight in wanted]) * float(self._torus.scale)
        sums = weights @ self.kernels.sums[chosen]
        return chosen, weights.astype(np.float32), sums.astype(np.float32)


def _torus(shape: tuple[int, int], reach: tuple[int, int], threads: int) -> Torus:
    return torus_for(shape, reach, (reach[0] // 2, reach[1] // 2), np.float32, threads)
