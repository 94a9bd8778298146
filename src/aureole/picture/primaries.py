"""Which colour space a file means by its primaries, and the way from one to another.

Sources: ITU-R BT.709-6 and BT.2020-2 table 3/4; Academy S-2014-004 (ACEScg, AP1) and SMPTE ST 2065-1
(AP0); CIE XYZ by definition. The interchange names are those of the ASWF Color Interop Forum.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

_D65 = (0.3127, 0.3290)
_ACES_WHITE = (0.32168, 0.33767)

# (x, y) of red, green, blue and white.
CHROMATICITIES: dict[str, tuple[float, ...]] = {
    "rec709": (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, *_D65),
    "acescg": (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, *_ACES_WHITE),
    "rec2020": (0.708, 0.292, 0.170, 0.797, 0.131, 0.046, *_D65),
    "xyz": (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3),
    "aces2065-1": (0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, *_ACES_WHITE),
}
INTERCHANGE = {
    "lin_rec709_scene": "rec709",
    "lin_ap1_scene": "acescg",
    "lin_rec2020_scene": "rec2020",
    "lin_ap0_scene": "aces2065-1",
}
# Files round their primaries to three or four digits.
_TOLERANCE = 1.5e-3
_BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def recognise(chromaticities: Sequence[float]) -> str | None:
    """Name the colour space that has given primaries.

    Parameters
    ----------
    chromaticities : sequence of float
        (x, y) of red, green, blue and white: eight numbers.

    Returns
    -------
    str or None
        Its name, None where it is none of ours.
    """
    for name, known in CHROMATICITIES.items():
        if np.allclose(chromaticities, known, rtol=0, atol=_TOLERANCE):
            return name
    return None


def to_xyz(chromaticities: Sequence[float]) -> NDArray[np.float64]:
    """Find the matrix from RGB of given primaries to XYZ.

    Parameters
    ----------
    chromaticities : sequence of float
        (x, y) of red, green, blue and white: eight numbers.

    Returns
    -------
    ndarray of float64, shape (3, 3)
        Matrix for column vectors; white (1, 1, 1) has Y = 1.
    """
    xy = np.asarray(chromaticities, dtype=np.float64).reshape(4, 2)
    # Each primary's XYZ at x + y + z = 1, scaled so that together they give the white.
    columns = np.column_stack([xy, 1 - xy.sum(axis=1)]).T
    white = columns[:, 3] / xy[3, 1]
    return np.asarray(columns[:, :3] * np.linalg.solve(columns[:, :3], white))


def luminance_weights(chromaticities: Sequence[float]) -> NDArray[np.float64]:
    """Find how much red, green and blue add to luminance.

    Parameters
    ----------
    chromaticities : sequence of float
        (x, y) of red, green, blue and white: eight numbers.

    Returns
    -------
    ndarray of float64, shape (3,)
        Weights with the sum 1.
    """
    return np.asarray(to_xyz(chromaticities)[1])


def conversion(source: str, target: str = "rec709") -> NDArray[np.float64]:
    """Find the matrix from one colour space to another, the white adapted by Bradford.

    Parameters
    ----------
    source, target : str
        Names in `CHROMATICITIES`.

    Returns
    -------
    ndarray of float64, shape (3, 3)
        Matrix for column vectors; it keeps (1, 1, 1).
    """
    given, wanted = to_xyz(CHROMATICITIES[source]), to_xyz(CHROMATICITIES[target])
    cones = _BRADFORD @ wanted.sum(axis=1) / (_BRADFORD @ given.sum(axis=1))
    adapted = np.linalg.solve(_BRADFORD, cones[:, None] * (_BRADFORD @ given))
    return np.asarray(np.linalg.solve(wanted, adapted))


def converted(pixels: NDArray[np.float32], source: str, target: str) -> NDArray[np.float32]:
    """Convert linear colour from one space to another; alpha stays.

    Parameters
    ----------
    pixels : ndarray of float32, shape (rows, columns, 3 or 4)
        Linear colour.
    source, target : str
        Names in `CHROMATICITIES`.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3 or 4)
        The same array where the spaces are one.
    """
    if source == target:
        return pixels
    moved = pixels.copy()
    moved[..., :3] = pixels[..., :3] @ conversion(source, target).T.astype(np.float32)
    return moved
