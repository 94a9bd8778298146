"""What luminance the eye is adapted to: that of the scene, damped in time.

The logarithm of the luminance follows that of the scene with a first-order lag, faster towards brighter:
the pupil's muscles close it within some tenths of a second and let it open within seconds.
"""

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.glare.eye_pupil import BRIGHTEST

# Time constants, seconds; the first is the lag of the iris in models of the pupil's reflex.
BRIGHTER, DARKER = 0.3, 1.5
# Times between which the lag is followed, seconds, and how far back it is worth following.
STEP = 1 / 60
MEMORY = 12 * DARKER
# The least light that a rested eye notices, cd/m²; darker is as dark.
DARKEST = 1e-6
# Longer than any animation, short enough that phases keep their digits.
LONGEST = 1e6

Luminance = float | Callable[[float], float] | tuple[ArrayLike, ArrayLike]


def adapted(luminance: Luminance, times: Sequence[float]) -> NDArray[np.float64]:
    """Return the luminances that the eye is adapted to at some times.

    Parameters
    ----------
    luminance : float or callable or tuple
        Of the scene, cd/m²: a number, to which the eye has been adapted forever; a function of the time
        in seconds; or (times, values), between which it is linear and beyond which it stays.
    times : sequence of float
        Seconds, not negative. At time 0 the eye is adapted to the scene as it is then.

    Returns
    -------
    ndarray, shape (N,)
        cd/m². Scenes that change are at least 1e-6.

    Raises
    ------
    refuse.Refusal
        Where a time or a luminance is negative or not finite.
    """
    moments = np.array([refuse.between("time", time, 0, LONGEST) for time in times])
    if isinstance(luminance, tuple):
        luminance = partial(np.interp, **_table(luminance))
    if not callable(luminance):
        return np.full(len(moments), _checked(luminance))
    order = np.argsort(moments, kind="stable")
    damped = np.empty(len(moments))
    if len(moments):
        damped[order] = _followed(luminance, moments[order])
    return damped


def adapted_after(previous: float, luminance: float, elapsed: float) -> float:
    """Return the luminance that the eye is adapted to after a while, for scenes that come frame by frame.

    Parameters
    ----------
    previous : float
        To which it was adapted, cd/m².
    luminance : float
        Of the scene since, cd/m².
    elapsed : float
        Seconds.

    Returns
    -------
    float
        cd/m², at least 1e-6.

    Raises
    ------
    refuse.Refusal
        Where a number is negative or not finite.
    """
    refuse.between("elapsed", elapsed, 0, LONGEST)
    return math.exp(_nearer(_logarithm(_checked(previous)), _logarithm(_checked(luminance)), elapsed))


def _followed(luminance: Callable[[float], float], moments: NDArray[np.float64]) -> NDArray[np.float64]:
    """Follow the scene from one moment to the next, in steps that end on a fixed lattice of times."""
    step = max(0, math.floor((moments[0] - MEMORY) / STEP))
    now = step * STEP
    level = _logarithm(_checked(luminance(now)))
    found = []
    for moment in moments:
        while (step + 1) * STEP <= moment:
            step += 1
            level = _lagged(level, luminance, now, step * STEP)
            now = step * STEP
        # The last part of a step leads to the moment and is not kept, so that any moment is served alike.
        found.append(math.exp(_lagged(level, luminance, now, float(moment))))
    return np.array(found)


def _lagged(level: float, luminance: Callable[[float], float], now: float, then: float) -> float:
    """Return the logarithm a little later, the scene being as it is halfway."""
    if then <= now:
        return level
    return _nearer(level, _logarithm(_checked(luminance((now + then) / 2))), then - now)


def _nearer(level: float, target: float, elapsed: float) -> float:
    lag = BRIGHTER if target > level else DARKER
    return target + (level - target) * math.exp(-elapsed / lag)


def _logarithm(luminance: float) -> float:
    return math.log(max(luminance, DARKEST))


def _checked(luminance: float) -> float:
    return refuse.between("luminance", luminance, 0, BRIGHTEST)


def _table(table: tuple[ArrayLike, ArrayLike]) -> dict[str, NDArray[np.float64]]:
    if len(table) != 2:
        raise refuse.Refusal(
            f"'luminance' must be a number, a function or (times, values), got {len(table)}."
        )
    times = refuse.all_finite(
        "times of 'luminance'", refuse.shape_of("times of 'luminance'", table[0], (None,))
    )
    values = refuse.all_finite("luminance", refuse.shape_of("luminance", table[1], times.shape))
    if np.any(np.diff(times) <= 0):
        raise refuse.Refusal("the times of 'luminance' must grow from each to the next.")
    return {"xp": times.astype(float), "fp": values.astype(float)}
