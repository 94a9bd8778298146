"""How far apart two colours look: CIELAB and its difference of the year 2000."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse

# CIE 15:2018, Eq. 8.6 to 8.8: (6/29)³ and the slope below it.
_LINEAR_BELOW = (6.0 / 29.0) ** 3
_SLOPE = (29.0 / 6.0) ** 2 / 3.0
_FAR = 25.0**7

Values = NDArray[np.float64]


def lab(xyz: ArrayLike, white: ArrayLike) -> Values:
    """Convert XYZ to CIELAB (CIE 15:2018, section 8.2.1).

    Parameters
    ----------
    xyz : array_like, shape (..., 3)
        Tristimulus values.
    white : array_like, shape (3,)
        X, Y, Z of the white, which becomes L* = 100.

    Returns
    -------
    ndarray of float64, shape (..., 3)
        L*, a*, b*.

    Raises
    ------
    refuse.Refusal
        Where the values are not finite or the white is not positive.
    """
    values = _triples("xyz", xyz)
    reference = _triples("white", white)
    if reference.shape != (3,) or not (reference > 0).all():
        raise refuse.Refusal(f"'white' must be three numbers > 0, got {reference.tolist()}.")
    ratio = values / reference
    bent = np.where(ratio > _LINEAR_BELOW, np.cbrt(ratio), _SLOPE * ratio + 4.0 / 29.0)
    x, y, z = np.moveaxis(bent, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def difference_2000(first: ArrayLike, second: ArrayLike) -> Values:
    """Measure how different colours look by CIEDE2000 (ISO/CIE 11664-6; Sharma, Wu and Dalal 2005).

    Parameters
    ----------
    first, second : array_like, shape (..., 3)
        L*, a*, b*, broadcast against each other.

    Returns
    -------
    ndarray of float64, shape (...)
        ΔE00 with all parametric factors 1; about 1 is just noticeable.

    Raises
    ------
    refuse.Refusal
        Where the values are not finite or not triples.
    """
    one, two = np.broadcast_arrays(_triples("first", first), _triples("second", second))
    chroma_7 = (0.5 * (np.hypot(one[..., 1], one[..., 2]) + np.hypot(two[..., 1], two[..., 2]))) ** 7
    stretch = 1.5 - 0.5 * np.sqrt(chroma_7 / (chroma_7 + _FAR))
    chroma_1, hue_1 = _polar(one, stretch)
    chroma_2, hue_2 = _polar(two, stretch)
    product = chroma_1 * chroma_2
    # The turn from hue to hue, the short way round; none where a colour is grey.
    turn = np.where(product > 0, (hue_2 - hue_1 + 180.0) % 360.0 - 180.0, 0.0)
    turn = np.where((turn == -180.0) & (hue_2 > hue_1), 180.0, turn)
    lightness = two[..., 0] - one[..., 0]
    chroma = chroma_2 - chroma_1
    hue = 2.0 * np.sqrt(product) * np.sin(np.radians(0.5 * turn))
    mean_hue = np.where(product > 0, _middle(hue_1, hue_2), hue_1 + hue_2)
    weights = _weights(0.5 * (one[..., 0] + two[..., 0]), 0.5 * (chroma_1 + chroma_2), mean_hue)
    light, chroma, hue = lightness / weights[0], chroma / weights[1], hue / weights[2]
    square = light**2 + chroma**2 + hue**2 + weights[3] * chroma * hue
    return np.asarray(np.sqrt(np.maximum(square, 0.0)))


def _polar(colours: Values, stretch: Values) -> tuple[Values, Values]:
    """Return chroma and hue in degrees, 0..360, with a* stretched."""
    a, b = stretch * colours[..., 1], colours[..., 2]
    return np.hypot(a, b), np.degrees(np.arctan2(b, a)) % 360.0


def _middle(hue_1: Values, hue_2: Values) -> Values:
    """Return the hue halfway along the shorter arc; of opposite hues the plain mean."""
    mean = 0.5 * (hue_1 + hue_2)
    far = np.abs(hue_1 - hue_2) > 180.0
    return np.where(far, np.where(mean < 180.0, mean + 180.0, mean - 180.0), mean)


def _weights(lightness: Values, chroma: Values, hue: Values) -> tuple[Values, Values, Values, Values]:
    """Return the weights of lightness, chroma and hue, and the factor of the term that turns blue."""

    def wave(times: float, shift: float) -> Values:
        return np.asarray(np.cos(np.radians(times * hue + shift)))

    dark = (lightness - 50.0) ** 2
    by_lightness = 1.0 + 0.015 * dark / np.sqrt(20.0 + dark)
    by_chroma = 1.0 + 0.045 * chroma
    sway = 1.0 - 0.17 * wave(1, -30) + 0.24 * wave(2, 0) + 0.32 * wave(3, 6) - 0.20 * wave(4, -63)
    by_hue = 1.0 + 0.015 * chroma * sway
    angle = 60.0 * np.exp(-(((hue - 275.0) / 25.0) ** 2))
    turning = -np.sin(np.radians(angle)) * 2.0 * np.sqrt(chroma**7 / (chroma**7 + _FAR))
    return by_lightness, by_chroma, by_hue, turning


def _triples(name: str, values: ArrayLike) -> Values:
    found = np.asarray(refuse.all_finite(name, values), dtype=np.float64)
    if found.ndim == 0 or found.shape[-1] != 3:
        raise refuse.Refusal(f"'{name}' must be an array of shape (..., 3), got {found.shape}.")
    return found
