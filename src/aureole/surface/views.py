"""Where a picture of a surface is taken from: a pinhole in perspective, or parallel rays.

World coordinates are right-handed, in metres. The picture's x runs right along columns, its rows downward.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse


@dataclass(frozen=True, eq=False)
class View:
    """A pinhole view, or one by parallel rays.

    Parameters
    ----------
    eye : ndarray of float64, shape (3,)
        The pinhole, or the middle of the plane from which parallel rays start; metres.
    right, up : ndarray of float64, shape (3,)
        Half of the picture's width and height: of what lies a metre before the pinhole, or of the plane.
    forward : ndarray of float64, shape (3,)
        Unit vector along which the view looks.
    shape : tuple of int
        Rows and columns of the picture.
    perspective : bool
        Whether rays meet in the eye.
    shift : ndarray of float64, shape (3,)
        What every ray's direction has besides, at right angles to `forward`: a lens that is shifted, in
        perspective.
    """

    eye: NDArray[np.float64]
    right: NDArray[np.float64]
    up: NDArray[np.float64]
    forward: NDArray[np.float64]
    shape: tuple[int, int]
    perspective: bool = True
    shift: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))


def view_from(
    eye: ArrayLike,
    target: ArrayLike = (0.0, 0.0, 0.0),
    shape: tuple[int, int] = (540, 960),
    field_of_view: float = np.pi / 6,
    up: ArrayLike = (0.0, 1.0, 0.0),
    height: float | None = None,
) -> View:
    """Make a view from where the eye is and what it looks at.

    Parameters
    ----------
    eye, target : array_like, shape (3,)
        Metres.
    shape : tuple of int
        Rows and columns.
    field_of_view : float
        Angle of the picture's height in radians; of no use where `height` is given.
    up : array_like, shape (3,)
        What is up on the picture.
    height : float or None
        Height in metres of a view by parallel rays; None is a pinhole.

    Returns
    -------
    View
        The view.

    Raises
    ------
    refuse.Refusal
        Where eye and target coincide, `up` lies along the line of sight, or a number is out of range.
    """
    rows, columns = (refuse.at_least("shape", count, 1) for count in shape)
    place, aim = _vector("eye", eye), _vector("target", target)
    forward = _unit("target", aim - place, "away from the eye")
    right = _unit("up", np.cross(forward, _vector("up", up)), "not along the line of sight")
    if height is None:
        half = np.tan(0.5 * refuse.between("field_of_view", field_of_view, 1e-6, 3.1))
    else:
        half = 0.5 * refuse.positive("height", height)
    upright = np.cross(right, forward)
    return View(
        place, right * (half * columns / rows), upright * half, forward, (rows, columns), height is None
    )


def _vector(name: str, value: ArrayLike) -> NDArray[np.float64]:
    return np.array(refuse.all_finite(name, refuse.shape_of(name, value, (3,))), dtype=np.float64)


def _unit(name: str, value: NDArray[np.float64], what: str) -> NDArray[np.float64]:
    length = float(np.linalg.norm(value))
    if length < 1e-12:
        raise refuse.Refusal(f"'{name}' must lie {what}.")
    unit: NDArray[np.float64] = value / length
    return unit
