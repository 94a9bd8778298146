"""The sum over all directions of light, look-up by look-up: the reference for lights from all around.

Each pixel of the surroundings is an even patch; it is cut into smaller and smaller patches until every
view's light has settled. In: a table, an environment, a frame, views; out: radiance and its last change.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.surface import _kernels_quadrature
from aureole.surface.environment import (
    FOUR_PI_SQUARED,
    Environment,
    directions,
    directions_checked,
)
from aureole.surface.table import ScatterTable, rgb


@dataclass(frozen=True, eq=False)
class Quadrature:
    """Light towards some views, summed direction by direction.

    Parameters
    ----------
    radiance : ndarray of float64, shape (V, 3)
        4π² ∫ S_d L_i ds, without F² G.
    change : ndarray of float64, shape (V,)
        What the last halving of the patches changed, over the view's largest channel.
    parts : int
        Into how many parts each pixel was cut along each side.
    """

    radiance: NDArray[np.float64]
    change: NDArray[np.float64]
    parts: int


def quadrature(
    table: ScatterTable,
    environment: Environment,
    frame: ArrayLike,
    views: ArrayLike,
    tolerance: float = 1e-4,
    most_parts: int = 16,
) -> Quadrature:
    """Sum the light that a flat sample sends to some views, direction by direction.

    Parameters
    ----------
    table : ScatterTable
        Of the sample.
    environment : Environment
        The light; multiplied with the table in its colour space.
    frame : array_like, shape (3, 3)
        Tangent, bitangent and normal of the sample in the world.
    views : array_like, shape (V, 2)
        Direction cosines along tangent and bitangent.
    tolerance : float
        Patches are halved until no view changes by more than this share.
    most_parts : int
        Pixels are cut into no more parts along a side, settled or not.

    Returns
    -------
    Quadrature
        Radiance, and how far it has settled.
    """
    places = directions_checked("views", views).reshape(-1, 2)
    refuse.positive("tolerance", tolerance)
    refuse.at_least("most_parts", most_parts, 2)
    colours = rgb(table, environment.colour_space)
    parts, change = 1, np.full(len(places), np.inf)
    radiance = _summed(table, colours, environment, frame, places, parts)
    while 2 * parts <= most_parts and change.max(initial=0.0) > tolerance:
        parts *= 2
        finer = _summed(table, colours, environment, frame, places, parts)
        scale = np.maximum(np.abs(finer).max(axis=1), np.finfo(np.float64).tiny)
        change = np.abs(finer - radiance).max(axis=1) / scale
        radiance = finer
    return Quadrature(radiance, change, parts)


def _summed(
    table: ScatterTable,
    colours: NDArray[np.float32],
    environment: Environment,
    frame: ArrayLike,
    views: NDArray[np.float64],
    parts: int,
) -> NDArray[np.float64]:
    total = np.zeros((len(views), 3))
    for places, energies, count in directions(environment, frame, parts):
        _kernels_quadrature.add_samples(
            views, places, energies, count, colours, table.half_range, 1.0 / table.warp, total
        )
    return FOUR_PI_SQUARED * total
