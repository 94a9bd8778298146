"""From linear light to the numbers of display-referred files, and back (IEC 61966-2-1, sRGB)."""

import numpy as np
from numpy.typing import NDArray

_REC709_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)


def decode_srgb(encoded: NDArray[np.float32]) -> NDArray[np.float32]:
    """Turn sRGB's numbers into linear light.

    Parameters
    ----------
    encoded : ndarray of float32
        Values 0..1 as stored, over the largest integer.

    Returns
    -------
    ndarray of float32
        Linear values 0..1, same shape.
    """
    value = np.asarray(encoded, dtype=np.float32)
    curve = ((np.maximum(value, 0) + np.float32(0.055)) / np.float32(1.055)) ** np.float32(2.4)
    return np.where(value <= np.float32(0.04045), value / np.float32(12.92), curve)


def encode_srgb(linear: NDArray[np.float32]) -> NDArray[np.float32]:
    """Turn linear light into sRGB's numbers.

    Parameters
    ----------
    linear : ndarray of float32
        Linear values; what lies outside 0..1 is clipped, channel by channel.

    Returns
    -------
    ndarray of float32
        Values 0..1 to be stored, same shape.
    """
    value = np.clip(np.asarray(linear, dtype=np.float32), 0, 1)
    curve = np.float32(1.055) * value ** np.float32(1 / 2.4) - np.float32(0.055)
    return np.where(value <= np.float32(0.0031308), value * np.float32(12.92), curve)


def into_gamut(
    linear: NDArray[np.float32], weights: NDArray[np.floating] = _REC709_LUMINANCE
) -> NDArray[np.float32]:
    """Bring colours with negative channels to the gamut's edge, keeping luminance and hue.

    Such a colour is mixed with the grey of its own luminance until its lowest channel is zero.
    Values above one stay.

    Parameters
    ----------
    linear : ndarray of float32, shape (rows, columns, 3)
        Linear RGB.
    weights : ndarray, shape (3,)
        Luminance of the channels; Rec.709's unless given.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Colours without negative values; black where the luminance is not above zero.
    """
    if not linear.size or linear.min() >= 0:
        return linear
    lowest = np.minimum(np.minimum(linear[..., 0], linear[..., 1]), linear[..., 2])
    wrong = lowest < 0
    # Only the colours that are out of gamut are touched.
    colours, below = linear[wrong], lowest[wrong][:, None]
    grey = np.maximum(colours @ np.asarray(weights, dtype=np.float32), 0)[:, None]
    mended = linear.copy()
    mended[wrong] = np.maximum(grey + grey / (grey - below) * (colours - grey), 0)
    return mended
