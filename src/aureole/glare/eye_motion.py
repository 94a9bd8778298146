"""What moves inside the eye: its lens, which never rests, and the vitreous body, which turns after the head.

The fluctuations of accommodation are noise below 0.6 Hz, larger for larger pupils, and a small part
between 1.3 and 2.1 Hz (thesis §2.4). The vitreous is a damped spring that the head drives.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.glare.eye_noise import band_noise, log_normal_noise

# Hertz.
SLOW, PULSE = (0.02, 0.60), (1.3, 2.1)
# Root mean squares: dioptres a metre of the pupil's diameter (0.1 dioptres at 5 mm), and dioptres.
SLOW_DIOPTRES, PULSE_DIOPTRES = 20.0, 0.03
# Of the lens's equator: -0.067 mm a dioptre of 9.33 mm (Jones, Atchison & Pope 2007).
STRETCH = -0.0072
# Mean amplitude of accommodation at 30 years, dioptres (Hofstetter 1950); what stays in old age.
AMPLITUDE_AT_30, LEAST_MOTION = 9.5, 0.1
# The vitreous's own frequency in radians a second, and its damping over the critical one; ours.
STIFFNESS, DAMPING = 2 * math.pi * 0.8, 0.3
# How long its swing is followed, seconds, until it has died to 1e-6; an even number of steps.
SWING, SWING_STEPS = 9.0, 400
# A head that is held still: root mean square in radians, median and ninth decile in hertz.
HEAD_TREMOR, HEAD_HERTZ = math.radians(1), (0.5, 1.2)

Head = Callable[[float], float]


def _swing() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return lags of the vitreous behind the head, and Simpson's weights of its answer at each."""
    lags = np.linspace(0, SWING, SWING_STEPS + 1)
    damped = math.sqrt(1 - DAMPING**2)
    turns = STIFFNESS * damped * lags
    answer = 2 * DAMPING * np.cos(turns) + (1 - 2 * DAMPING**2) / damped * np.sin(turns)
    answer *= STIFFNESS * np.exp(-DAMPING * STIFFNESS * lags)
    weights = np.full(len(lags), 2.0)
    weights[1::2], weights[[0, -1]] = 4.0, 1.0
    return lags, answer * weights * lags[1] / 3


_LAGS, _WEIGHTS = _swing()


def accommodation(time: float, diameter: float, age: float, seed: int) -> float:
    """Return how far the eye's focus strays from its mean.

    Parameters
    ----------
    time : float
        Seconds.
    diameter : float
        Mean diameter of the pupil, metres; the slow part grows in proportion.
    age : float
        Years; the motion falls with the amplitude of accommodation, 18.5 − 0.3 age dioptres
        (Hofstetter 1950), to a tenth.
    seed : int
        The eye's.

    Returns
    -------
    float
        Dioptres.
    """
    slow = SLOW_DIOPTRES * diameter * band_noise(seed, "accommodation", *SLOW).at(time)
    pulse = PULSE_DIOPTRES * band_noise(seed, "pulse", *PULSE).at(time)
    return min(max((18.5 - 0.3 * age) / AMPLITUDE_AT_30, LEAST_MOTION), 1.0) * (slow + pulse)


def lens_stretch(dioptres: float) -> float:
    """Return how much wider the lens is at an accommodation than at its mean.

    Parameters
    ----------
    dioptres : float
        Of accommodation, off the mean.

    Returns
    -------
    float
        Relative: a place in the lens at radius r moves to r (1 + stretch). An eye that focuses nearer
        lets its lens grow round, so the stretch is negative.
    """
    return STRETCH * dioptres


def vitreous_angle(time: float, seed: int, head: Head | None = None) -> float:
    """Return how far the vitreous lags behind the eye about its line of sight.

    With the head at angle φ the vitreous at θ obeys θ'' = 2ζω (φ' − θ') + ω² (φ − θ), whose answer to a
    jolt of the head is g(τ) = exp(−ζωτ) (2ζω cos ω_d τ + ω (1 − 2ζ²) (ω / ω_d) sin ω_d τ).

    Parameters
    ----------
    time : float
        Seconds, not negative.
    seed : int
        The eye's.
    head : callable, optional
        Time in seconds to the head's angle in radians, counter-clockwise as seen; asked at times from 0
        to `time`, before which the head is at rest. A head that is held still, with its small motion,
        unless given.

    Returns
    -------
    float
        θ − φ, radians, counter-clockwise as seen.

    Raises
    ------
    refuse.Refusal
        Where the head's angle is not a finite number.
    """
    if head is None:
        noise = log_normal_noise(seed, "head", *HEAD_HERTZ)
        omega = 2 * np.pi * noise.frequencies
        lag = omega**2 / (STIFFNESS**2 - omega**2 + 2j * DAMPING * STIFFNESS * omega)
        return HEAD_TREMOR * noise.at(time, lag.astype(np.complex128))
    now = _angle(head, time)
    earlier = np.array([_angle(head, max(0.0, time - lag)) for lag in _LAGS])
    return float(np.dot(_WEIGHTS, earlier - now))


def _angle(head: Head, time: float) -> float:
    return refuse.finite("head", head(time))
