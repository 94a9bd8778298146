"""Barycentric coordinates: how much each corner of a quad says about a point in it.

The five of the tile paper (Bodonyi and Kunkli 2023, section 3.4), and the inverse of the bilinear map, which
is what a cell of a ray grid is. All but Loop and DeRose's find a point again from its weights; that one as
printed does so on parallelograms only, and is here for comparison.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.flare import _kernels_barycentric as kernels

# A method's place is its number in the kernels.
METHODS = ("triangle", "homogeneous", "mean-value", "wachspress", "loop-derose", "bilinear")
Numbers = NDArray[np.float64]


def coordinates(quads: ArrayLike, points: ArrayLike, method: str = "bilinear") -> Numbers:
    """Return the weights of a quad's corners at points.

    Parameters
    ----------
    quads : array_like, shape (N, 4, 2)
        Corners around each quad, in any unit.
    points : array_like, shape (N, 2)
        One for each quad, in the same unit.
    method : str
        "triangle" (Eq. 3-4) and Skala's "homogeneous" (Eq. 5-6): the triangle of corners 0, 1, 2 or 0, 2, 3
        on the point's side; Hormann and Tarini's "mean-value" (Eq. 7), for every quad; "wachspress"
        (Eq. 8-9) and "loop-derose" (Eq. 8, 10), for convex ones; "bilinear": the corners' weights
        (1-u)(1-v), u(1-v), uv, (1-u)v; "reference": these in plain steps.

    Returns
    -------
    ndarray, shape (N, 4)
        Without NaN: they add up to 1, or are all 0 where a quad has no area or no cell maps onto the point.

    Raises
    ------
    refuse.Refusal
        Where shapes or numbers are wrong, or the method is unknown.
    """
    refuse.one_of("method", method, (*METHODS, "reference"))
    corners = refuse.all_finite("quads", refuse.shape_of("quads", quads, (None, 4, 2))).astype(np.float64)
    places = refuse.shape_of("points", points, (len(corners), 2))
    places = refuse.all_finite("points", places).astype(np.float64)
    if method == "reference":
        return _reference(corners, places)
    found = np.empty((len(corners), 4))
    kernels.coordinates(corners, places, METHODS.index(method), found)
    return found


def _reference(quads: Numbers, points: Numbers) -> Numbers:
    """Return the bilinear weights from every root, one point at a time."""
    found = np.zeros((len(quads), 4))
    for k, (corners, point) in enumerate(zip(quads, points, strict=True)):
        a, e, f = corners[0] - point, corners[1] - corners[0], corners[3] - corners[0]
        g = corners[2] - corners[1] - f
        # v solves (a + v f) × (e + v g) = 0; the root that lies deepest in the cell is meant.
        factors = np.array([_cross(f, g), _cross(a, g) + _cross(f, e), _cross(a, e)])
        roots = np.roots(factors if factors[0] else factors[1:])
        best = -np.inf
        for v in roots[np.isreal(roots)].real:
            along = e + v * g
            length = along @ along
            if length == 0.0:
                continue
            u = -((a + v * f) @ along) / length
            depth = min(u, 1 - u, v, 1 - v)
            if depth > best:
                best = depth
                found[k] = (1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v
    return found


def _cross(a: Numbers, b: Numbers) -> float:
    return float(a[0] * b[1] - a[1] * b[0])
