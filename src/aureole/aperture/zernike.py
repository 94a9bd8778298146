"""Zernike polynomials on the unit disc, orthonormal, so that a coefficient is a root mean square.

    Z(n, m) = √(n + 1) R(n, |m|)(ρ) · { √2 cos mθ for m > 0;  √2 sin |m|θ for m < 0;  1 for m = 0 }

(R. J. Noll, J. Opt. Soc. Am. 66, 207, 1976, Eq. 1-3, with the signs of m in the place of his numbers).
The angle θ follows the screen: 0 is +x, positive turns counter-clockwise as seen.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse

# Higher orders turn faster than any raster of ours could follow.
HIGHEST_ORDER = 100

ZERNIKE_NAMES: Mapping[str, tuple[int, int]] = {
    "piston": (0, 0),
    "tilt-x": (1, 1),
    "tilt-y": (1, -1),
    "defocus": (2, 0),
    "astigmatism": (2, 2),
    "astigmatism-45": (2, -2),
    "coma-x": (3, 1),
    "coma-y": (3, -1),
    "trefoil-x": (3, 3),
    "trefoil-y": (3, -3),
    "spherical": (4, 0),
}

Term = tuple[int, int] | str


def zernike(term: Term, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
    """Return a Zernike polynomial, whose mean square over the unit disc is 1.

    Parameters
    ----------
    term : tuple of int or str
        (n, m), or one of `ZERNIKE_NAMES`.
    x, y : array_like
        Places over the disc's radius, x to the right, y downward; broadcast against each other.

    Returns
    -------
    ndarray of float64
        Values, beyond the disc too.

    Raises
    ------
    refuse.Refusal
        Where there is no such polynomial.
    """
    from scipy.special import eval_jacobi

    n, m = zernike_pair(term)
    # Points have y downward and angles turn counter-clockwise as seen.
    place = np.asarray(x, dtype=np.float64) - 1j * np.asarray(y, dtype=np.float64)
    square = place.real**2 + place.imag**2
    # R(ρ) = ρ^|m| P_k^(0, |m|)(2ρ² − 1) with Jacobi's P and k = (n − |m|) / 2.
    radial = math.sqrt(n + 1) * eval_jacobi((n - abs(m)) // 2, 0, abs(m), 2 * square - 1)
    if m == 0:
        return np.asarray(radial)
    turned = place ** abs(m)
    return np.asarray(math.sqrt(2) * radial * (turned.real if m > 0 else turned.imag))


def zernike_pair(term: Term) -> tuple[int, int]:
    """Return the orders (n, m) of a Zernike polynomial.

    Parameters
    ----------
    term : tuple of int or str
        (n, m), or one of `ZERNIKE_NAMES`.

    Returns
    -------
    tuple of int
        The radial order n and the azimuthal order m, negative for a sine.

    Raises
    ------
    refuse.Refusal
        Where there is no such polynomial.
    """
    if isinstance(term, str):
        return ZERNIKE_NAMES[refuse.one_of("zernike", term, ZERNIKE_NAMES)]
    if not isinstance(term, tuple) or len(term) != 2:
        raise refuse.Refusal(f"'zernike' must be orders (n, m) or a name such as 'coma-x', got {term}.")
    n, m = refuse.at_least("zernike n", term[0], 0), refuse.at_least("zernike m", term[1], -HIGHEST_ORDER)
    refuse.between("zernike n", n, 0, HIGHEST_ORDER)
    if abs(m) > n or (n - m) % 2:
        allowed = ", ".join(str(order) for order in range(-n, n + 1, 2))
        raise refuse.Refusal(f"'zernike' ({n}, {m}) does not exist; for n = {n}, m is one of {allowed}.")
    return n, m
