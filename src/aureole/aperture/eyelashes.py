"""Lashes and lids before any opening: what a camera would see that looked out of an eye.

The opening stands in for a pupil of a given diameter, so that lids and lashes of human size (`lashes`) are
scaled to it: a plain picture of the eye's needles by a camera's own starburst (quad paper Fig. 14).
"""

import math
from collections.abc import Sequence

from aureole import refuse
from aureole.aperture.lashes import close_lids, lash_coverage, lashes, lids
from aureole.aperture.masks import rasterize, seen_through
from aureole.records import Aperture

# The pupil that an opening stands for, and breadth and spread of its lashes.
PUPIL_DIAMETER, LASH_WIDTH, LASH_SPREAD = 6e-3, 0.1e-3, math.radians(20)
# The lids nearly touch the pupil, and lashes reach down to its middle.
LID_OPENING = 0.7


def eyelashes(
    aperture: Aperture,
    size: int,
    count: int,
    seed: int | Sequence[int],
    opening: float = LID_OPENING,
    spread: float = LASH_SPREAD,
    width: float = LASH_WIDTH,
    pupil_diameter: float = PUPIL_DIAMETER,
    root_shift: tuple[float, float] = (0.0, 0.0),
    tip_shift: tuple[float, float] = (0.0, 0.0),
) -> Aperture:
    """See an aperture through eyelashes (quad paper Fig. 14).

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.
    size : int
        Pixels on each side of the result.
    count : int
        How many lashes over 6 mm of the lid.
    seed : int or sequence of int
        The same gives the same lashes on every machine.
    opening : float
        Of the lids, 0 closed to 1 wide open; the lids cover what they cover of the pupil.
    spread : float
        Standard deviation of the lashes' directions, radians.
    width : float
        Of a lash at its root, metres before an eye.
    pupil_diameter : float
        Of the pupil that the aperture's width stands for, metres: it scales lids and lashes.
    root_shift, tip_shift : tuple of float
        (x, y) by which the shadows of the lids with the roots, and of the tips, are moved, metres before an
        eye (`aureole.aperture.parallax`).

    Returns
    -------
    Aperture
        A raster on the aperture's width, with its wavefront.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, no light is left, or a wavefront would be resampled.
    """
    refuse.at_least("size", size, 1)
    refuse.positive("pupil_diameter", pupil_diameter)
    hairs = lashes(count, spread, width, opening, seed, root_shift, tip_shift)
    mask = rasterize(aperture, size)
    mask *= 1 - lash_coverage(hairs, size, pupil_diameter)
    close_lids(mask, lids(opening), pupil_diameter, root_shift)
    return seen_through(aperture, mask, "eyelashes", "take fewer, or open the lids")
