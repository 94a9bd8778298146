"""Noise in time for the eye's small motions: many cosines whose frequencies follow a law.

Their frequencies are the law's quantiles, each moved at random within its own share, their phases are
random. So the power spectrum is the law's, no value ever repeats, and the noise at any time costs the
same, without a start. Everything follows from the seed and the name of the motion.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures

COSINES = 64
# Each motion draws from its own stream of the eye's seed.
STREAMS = ("hippus", "accommodation", "pulse", "head", "blinks")
# How far the quantiles of the normal law at 0.5 and 0.9 lie apart, in standard deviations.
NINTH_DECILE = 1.2815515655446004


@dataclass(frozen=True)
class Noise:
    """A sum of cosines with unit variance.

    Parameters
    ----------
    frequencies : ndarray, shape (K,)
        Hertz.
    phases : ndarray, shape (K,)
        Radians.
    """

    frequencies: NDArray[np.float64]
    phases: NDArray[np.float64]

    def at(self, time: float, response: NDArray[np.complex128] | None = None) -> float:
        """Return the noise at a time.

        Parameters
        ----------
        time : float
            Seconds.
        response : ndarray, shape (K,), optional
            What a linear system makes of each cosine; none leaves them as they are.

        Returns
        -------
        float
            Of mean 0 and, without a response, variance 1.
        """
        angles = 2 * np.pi * np.mod(self.frequencies * time, 1.0) + self.phases
        if response is None:
            terms = np.cos(angles)
        else:
            terms = response.real * np.cos(angles) - response.imag * np.sin(angles)
        return float(np.sqrt(2 / len(terms)) * terms.sum())


@lru_cache(maxsize=256)
def log_normal_noise(seed: int, stream: str, median: float, ninth_decile: float) -> Noise:
    """Return noise half of whose power lies below a frequency, and nine tenths below another.

    Parameters
    ----------
    seed : int
        The eye's.
    stream : str
        One of `STREAMS`.
    median, ninth_decile : float
        The two frequencies, hertz.

    Returns
    -------
    Noise
        Its power follows the log-normal law over frequency.
    """
    from scipy.special import ndtri

    shares, phases = _drawn(seed, stream)
    spread = np.log(ninth_decile / median) / NINTH_DECILE
    return Noise(median * np.exp(spread * ndtri(shares)), phases)


@lru_cache(maxsize=256)
def band_noise(seed: int, stream: str, low: float, high: float) -> Noise:
    """Return noise whose power is spread evenly over a band of frequencies.

    Parameters
    ----------
    seed : int
        The eye's.
    stream : str
        One of `STREAMS`.
    low, high : float
        The band's ends, hertz.

    Returns
    -------
    Noise
        Without power elsewhere.
    """
    shares, phases = _drawn(seed, stream)
    return Noise(low + (high - low) * shares, phases)


def _drawn(seed: int, stream: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return a random place within each of equal shares of 0..1, and random phases."""
    chances = apertures.uniform((seed, STREAMS.index(stream)), 2 * COSINES)
    # The middle half of each share keeps the quantiles of the outermost finite.
    shares = (np.arange(COSINES) + 0.25 + chances[:COSINES] / 2) / COSINES
    return shares, 2 * np.pi * chances[COSINES:]
