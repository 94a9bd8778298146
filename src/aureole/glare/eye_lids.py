"""The lids: blinks, fast and at irregular times, and squinting at bright scenes.

Times between blinks are log-normal with a mean of about 4 s (17 blinks a minute at rest: Bentivoglio et
al., Movement Disorders 12:1028, 1997). Each minute is drawn on its own, so that any time costs the same.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.glare.eye_noise import STREAMS
from aureole.glare.eye_pupil import BRIGHTEST

# Seconds that are drawn together, and more blinks than such a block can hold.
BLOCK = 60.0
MOST_BLINKS = 64
# Between the end of a blink and the next: median in seconds, spread of the logarithm, and the least.
MEDIAN_GAP, GAP_SPREAD, LEAST_GAP = 2.75, 0.75, 0.3
# Shortest and longest, seconds.
CLOSING, CLOSED, OPENING = (0.075, 0.100), (0.010, 0.060), (0.150, 0.250)
# How open the lids stay in glare, and the luminance at which they have gone half of the way, cd/m².
SQUINTED, HALF_SQUINT = 0.45, 3000.0


def blinks(start: float, end: float, seed: int) -> NDArray[np.float64]:
    """Return the blinks that lie in an interval.

    Parameters
    ----------
    start, end : float
        Seconds, not negative.
    seed : int
        The eye's.

    Returns
    -------
    ndarray, shape (N, 4)
        When each begins, is closed, begins to open and is open again, seconds, in their order.
    """
    first, last = int(start // BLOCK), int(end // BLOCK)
    all_blinks = np.concatenate([block * BLOCK + _drawn(seed, block) for block in range(first, last + 1)])
    return np.asarray(all_blinks[(all_blinks[:, 3] > start) & (all_blinks[:, 0] < end)])


def blink(time: float, seed: int) -> float:
    """Return how open a blinking eye's lids are.

    Parameters
    ----------
    time : float
        Seconds, not negative.
    seed : int
        The eye's.

    Returns
    -------
    float
        0 closed to 1 open; it changes by less than 20 per second.
    """
    block = int(time // BLOCK)
    drawn, within = _drawn(seed, block), time - block * BLOCK
    current = drawn[(drawn[:, 0] < within) & (within < drawn[:, 3])]
    if not len(current):
        return 1.0
    begins, closed, opens, ends = current[0]
    if within < closed:
        return _smooth((closed - within) / (closed - begins))
    return _smooth((within - opens) / (ends - opens)) if within > opens else 0.0


def squint(luminance: float) -> float:
    """Return how open lids are that squint at a bright scene.

    The law is ours: 1 − 0.55 L / (L + 3000 cd/m²), hardly less than 1 indoors, 0.45 in glare.

    Parameters
    ----------
    luminance : float
        To which the eye is adapted, damped in time, cd/m².

    Returns
    -------
    float
        0.45 to 1.

    Raises
    ------
    refuse.Refusal
        Where the luminance is negative or not finite.
    """
    refuse.between("luminance", luminance, 0, BRIGHTEST)
    return 1 - (1 - SQUINTED) * luminance / (luminance + HALF_SQUINT)


@lru_cache(maxsize=256)
def _drawn(seed: int, block: int) -> NDArray[np.float64]:
    """Draw the blinks of a block, which all end within it; times count from its start."""
    from scipy.special import ndtri

    chances = apertures.uniform((seed, STREAMS.index("blinks"), block), 4 * MOST_BLINKS).reshape(-1, 4)
    gaps = np.maximum(MEDIAN_GAP * np.exp(GAP_SPREAD * ndtri(np.maximum(chances[:, 0], 1e-12))), LEAST_GAP)
    low, high = np.transpose([CLOSING, CLOSED, OPENING])
    parts = low + (high - low) * chances[:, 1:]
    # A block begins somewhere between two blinks.
    gaps[0] = LEAST_GAP + gaps[0] * chances[-1, 0]
    begins = np.cumsum(gaps + np.concatenate([[0.0], parts[:-1].sum(axis=1)]))
    drawn = begins[:, None] + np.concatenate([np.zeros((len(parts), 1)), np.cumsum(parts, axis=1)], axis=1)
    return np.asarray(drawn[drawn[:, 3] < BLOCK])


def _smooth(share: float) -> float:
    return float(share * share * (3 - 2 * share))
