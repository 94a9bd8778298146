"""The zero order of a pattern: kept, taken away, or told apart as an ordinary mirror's highlight.

A pattern that is scaled to every wavelength scales its zero order too, and colours white light. A mirror's
highlight stays white: cut out of the pattern, its energy can be drawn as a specular lobe.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.surface.pattern import DiffractionPattern, on_grid

_RINGS = 0.6  # a ring's width in samples for profiles


@dataclass(frozen=True)
class ZeroOrder:
    """The disc about h = 0 that was cut out of a pattern.

    Parameters
    ----------
    radius : float
        Of the disc, in h.
    energy : float
        ∫ S dh over it, above what was left in its place. f_r = 4 π² F² G S reflects 4 π² energy of the light
        at F = G = 1.
    width : float
        Root mean square of one component of h over it, from which a lobe's roughness follows.
    """

    radius: float
    energy: float
    width: float


def split_zero_order(
    pattern: DiffractionPattern, radius: float | None = None
) -> tuple[DiffractionPattern, ZeroOrder]:
    """Cut the zero order out of a pattern.

    Parameters
    ----------
    pattern : DiffractionPattern
        Its zero order at h = 0.
    radius : float or None
        Of the disc in h; None is where the median over rings about h = 0 first stops falling.

    Returns
    -------
    pattern : DiffractionPattern
        With the rim's median inside the disc, where that is less than what was there.
    zero_order : ZeroOrder
        What was cut out.

    Raises
    ------
    refuse.Refusal
        Where the radius is not positive or reaches out of the pattern.
    """
    grid = on_grid(pattern)
    y, x = grid.grid.axes()
    distance = np.hypot(y[:, None], x[None, :])
    step = max(grid.grid.spacing)
    if radius is None:
        radius = _first_minimum(pattern.values, distance, step)
    radius = refuse.between("radius", radius, step, pattern.half_range)
    inside = distance <= radius
    rim = np.abs(distance - radius) <= step
    filled = np.where(inside, np.minimum(pattern.values, np.median(pattern.values[rim])), pattern.values)
    cut = (pattern.values - filled).astype(np.float64)
    energy = float(cut.sum()) * grid.grid.spacing[0] * grid.grid.spacing[1]
    width = math.sqrt(float((cut * distance**2).sum()) / (2.0 * float(cut.sum()))) if energy > 0 else 0.0
    return replace(pattern, values=filled.astype(np.float32)), ZeroOrder(radius, energy, width)


def _first_minimum(values: NDArray[np.float32], distance: NDArray[np.float64], step: float) -> float:
    """Return the radius where the median over rings first stops falling."""
    before = math.inf
    for ring in range(min(values.shape) // 2):
        here = float(np.median(values[np.abs(distance - ring * step) <= _RINGS * step]))
        if here >= before:
            return max(ring - 1, 1) * step
        before = here
    return 0.5 * float(distance.max())
