"""The pupil: how wide it stands at a luminance, and how it trembles (hippus).

The mean diameter is that of A. B. Watson and J. I. Yellott, "A unified formula for light-adapted pupil
size", J. Vision 12(10):12, 2012. T. Ritschel et al., "Temporal Glare", 2009, whose formulas J. Delavennat's
thesis (2021) repeats as Eq. 2.13 and 2.14, serves the preset of their name.
"""

import math

from aureole import refuse
from aureole.glare.eye_noise import log_normal_noise

# Of human pupils; no motion leaves them.
SMALLEST, LARGEST = 1.5e-3, 9e-3
BRIGHTEST = 1e10
# The subjects whose pupils the formula's age term was fitted to.
YOUNGEST, OLDEST = 20.0, 83.0
REFERENCE_AGE = 28.58
# A pupil that one eye's light drives takes it for a tenth.
MONOCULAR = 0.1
# Half of the tremor's power lies below the first, nine tenths below the second (published: 0.63 Hz).
MEDIAN_HERTZ, NINTH_DECILE_HERTZ = 0.32, 0.60
# Of the noise in Ritschel's formula, so that a pupil of 6.66 mm trembles by 0.11 mm as theirs does.
CONTRAST = 0.176
RITSCHEL_DIAMETER = 6.66e-3
LEAST_TREMOR, MOST_TREMOR = 0.045e-3, 0.20e-3
# Standard deviations at which the tremor bends over.
BOUND = 3.0


def pupil_diameter(luminance: float, area_deg2: float, age: float = 30.0, binocular: bool = True) -> float:
    """Return the mean diameter of the pupil (Watson & Yellott 2012).

    D_sd = 7.75 − 5.75 x / (x + 2) with x = (F / 846)^0.41 and F = luminance · area · M (Stanley and
    Davies 1995), D = D_sd + (age − 28.58) (0.02132 − 0.009562 D_sd), in millimetres.

    Parameters
    ----------
    luminance : float
        To which the eye is adapted, cd/m²; 0 is darkness.
    area_deg2 : float
        Of the field that has this luminance, square degrees: 3600 for 60° × 60°.
    age : float
        Years; the formula was fitted from 20 to 83, and ages beyond are taken as these.
    binocular : bool
        Whether both eyes see the field; M is 1, and 0.1 for one eye.

    Returns
    -------
    float
        Metres.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.between("luminance", luminance, 0, BRIGHTEST)
    refuse.between("age", age, 1, 120)
    flux: float = luminance * refuse.positive("area_deg2", area_deg2) * (1.0 if binocular else MONOCULAR)
    x: float = (flux / 846) ** 0.41
    diameter = 7.75 - 5.75 * x / (x + 2)
    years = min(max(age, YOUNGEST), OLDEST) - REFERENCE_AGE
    return 1e-3 * (diameter + years * (0.02132 - 0.009562 * diameter))


def ritschel_diameter(luminance: float) -> float:
    """Return the mean diameter of the pupil as in Temporal Glare (thesis Eq. 2.14).

    p = 4.9 − 3 tanh(0.4 (log10 L + 1)) millimetres. The 1 puts it one decade of luminance away from the
    formula of Moon and Spencer (1944) that it stems from.

    Parameters
    ----------
    luminance : float
        cd/m²; 0 is darkness.

    Returns
    -------
    float
        Metres.

    Raises
    ------
    refuse.Refusal
        Where the luminance is negative or not finite.
    """
    refuse.between("luminance", luminance, 0, BRIGHTEST)
    decades = math.log10(luminance) if luminance > 0 else -math.inf
    return 1e-3 * (4.9 - 3 * math.tanh(0.4 * (decades + 1)))


def tremor(diameter: float, contrast: float = 1.0) -> float:
    """Return the standard deviation of hippus before it is bounded.

    Parameters
    ----------
    diameter : float
        Mean diameter of the pupil, metres.
    contrast : float
        1 for the published size.

    Returns
    -------
    float
        Metres: that of Ritschel's formula, kept within the range that was measured (0.04 to 0.20 mm).
    """
    return contrast * min(max(1e-3 * CONTRAST * _ritschel_factor(diameter), LEAST_TREMOR), MOST_TREMOR)


def hippus(time: float, diameter: float, seed: int, contrast: float = 1.0) -> float:
    """Return the pupil's diameter while it trembles about its mean.

    Nine tenths of the tremor's power lie below 0.63 Hz, half below 0.32 Hz.

    Parameters
    ----------
    time : float
        Seconds.
    diameter : float
        Mean diameter, metres, 1.5 to 9 mm.
    seed : int
        The eye's.
    contrast : float
        0 for none, 1 for the published size.

    Returns
    -------
    float
        Metres, always between 1.5 and 9 mm.

    Raises
    ------
    refuse.Refusal
        Where the diameter is no pupil's.
    """
    _check(diameter, contrast)
    noise = log_normal_noise(seed, "hippus", MEDIAN_HERTZ, NINTH_DECILE_HERTZ).at(time)
    return _bounded(diameter, tremor(diameter, contrast), noise)


def ritschel_hippus(time: float, diameter: float, seed: int, contrast: float = 1.0) -> float:
    """Return the pupil's diameter while it trembles as in Temporal Glare (thesis Eq. 2.13).

    h(t, p) = p + noise(t / p) (p_max / p) √(1 − p / p_max) with p_max = 9 mm. The noise is scaled so that
    a pupil of 6.66 mm trembles as their own does, and bounded, since a small pupil would turn negative.

    Parameters
    ----------
    time : float
        Seconds.
    diameter : float
        p, metres, 1.5 to 9 mm.
    seed : int
        The eye's.
    contrast : float
        0 for none, 1 for the size of their own.

    Returns
    -------
    float
        Metres, always between 1.5 and 9 mm.

    Raises
    ------
    refuse.Refusal
        Where the diameter is no pupil's.
    """
    _check(diameter, contrast)
    noise = log_normal_noise(seed, "hippus", MEDIAN_HERTZ, NINTH_DECILE_HERTZ)
    size = contrast * 1e-3 * CONTRAST * _ritschel_factor(diameter)
    return _bounded(diameter, size, noise.at(time * RITSCHEL_DIAMETER / diameter))


def _check(diameter: float, contrast: float) -> None:
    refuse.between("diameter", diameter, SMALLEST, LARGEST)
    refuse.between("hippus", contrast, 0, 10)


def _ritschel_factor(diameter: float) -> float:
    return LARGEST / diameter * math.sqrt(max(0.0, 1 - diameter / LARGEST))


def _bounded(diameter: float, size: float, noise: float) -> float:
    """Return mean plus noise, which bends over before it leaves what pupils can do."""
    room = min(BOUND * size, diameter - SMALLEST, LARGEST - diameter)
    if room <= 0:
        return diameter
    return diameter + room * math.tanh(noise * size / room)
