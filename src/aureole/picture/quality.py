"""How close a picture comes to a reference: plain and logarithmic signal-to-noise ratios, similarity.

The plain ratio is dominated by the brightest pixels: a starburst's core hides all that lies around it.
The logarithmic one weighs every decade alike. All give one number a channel; more is better.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from aureole import refuse
from aureole.records import Picture

DECADES = 10.0  # that `log_psnr` looks at, below the reference's peak
WINDOW, SIGMA = 11, 1.5  # of the Gaussian that `ssim` looks through, in pixels
K1, K2 = 0.01, 0.03


def psnr(
    picture: Picture | ArrayLike, reference: Picture | ArrayLike, peak: float | None = None
) -> NDArray[np.float64]:
    """Return the peak signal-to-noise ratio 20 log10(peak / RMSE) of each channel.

    Parameters
    ----------
    picture : Picture or array_like, shape (rows, columns[, channels])
        What is judged.
    reference : Picture or array_like, same shape
        What it should be.
    peak : float or None
        The range of the values; None takes each channel's largest value in the reference.

    Returns
    -------
    ndarray of float64, shape (channels,) or ()
        Decibels; infinite where nothing differs.

    Raises
    ------
    refuse.Refusal
        Where the shapes differ, a value is not finite, or a channel has no light to compare with.
    """
    found, wanted = _both(picture, reference)
    return _decibels(found - wanted, _peak(wanted, peak))


def log_psnr(picture: Picture | ArrayLike, reference: Picture | ArrayLike) -> NDArray[np.float64]:
    """Return the signal-to-noise ratio of the logarithms, over ten decades, of each channel.

    20 log10(10 / RMSE) of log10 max(Y / Y_peak, 1e-10), where Y_peak is the channel's largest value in
    the reference, for both pictures. At 40 dB pixels differ by 26 % (0.1 decades), at 60 dB by 2.3 %.

    Parameters
    ----------
    picture : Picture or array_like, shape (rows, columns[, channels])
        What is judged.
    reference : Picture or array_like, same shape
        What it should be.

    Returns
    -------
    ndarray of float64, shape (channels,) or ()
        Decibels; infinite where nothing differs.

    Raises
    ------
    refuse.Refusal
        Where the shapes differ, a value is not finite, or a channel has no light to compare with.
    """
    found, wanted = _both(picture, reference)
    peak, floor = _peak(wanted, None), 10.0**-DECADES
    found, wanted = (np.log10(np.maximum(values / peak, floor)) for values in (found, wanted))
    return _decibels(found - wanted, np.asarray(DECADES))


def ssim(
    picture: Picture | ArrayLike, reference: Picture | ArrayLike, peak: float | None = None
) -> NDArray[np.float64]:
    """Return the mean structural similarity of each channel (Wang et al. 2004, Eq. 13-17).

    (2 μ_x μ_y + C1)(2 σ_xy + C2) / ((μ_x² + μ_y² + C1)(σ_x² + σ_y² + C2)) through a Gaussian window of
    11 × 11 pixels, σ 1.5, with C1 = (0.01 peak)² and C2 = (0.03 peak)², averaged over all places where
    the window lies inside the picture.

    Parameters
    ----------
    picture : Picture or array_like, shape (rows, columns[, channels])
        What is judged; at least 11 pixels along each axis.
    reference : Picture or array_like, same shape
        What it should be.
    peak : float or None
        The range L of the values; None takes each channel's largest value in the reference.

    Returns
    -------
    ndarray of float64, shape (channels,) or ()
        1 where nothing differs.

    Raises
    ------
    refuse.Refusal
        Where the shapes differ or are smaller than the window, a value is not finite, or a channel has
        no light to compare with.

    References
    ----------
    Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli, "Image quality assessment: from error
    visibility to structural similarity", IEEE Transactions on Image Processing 13 (4), 2004.
    """
    found, wanted = _both(picture, reference)
    if min(found.shape[:2]) < WINDOW:
        rows, columns = found.shape[:2]
        raise refuse.Refusal(f"'picture' must have {WINDOW} pixels or more an axis, got {rows} x {columns}.")
    scale = _peak(wanted, peak)
    c1, c2 = (K1 * scale) ** 2, (K2 * scale) ** 2
    x, y = _windowed(found), _windowed(wanted)
    variance_x, variance_y = _windowed(found * found) - x * x, _windowed(wanted * wanted) - y * y
    covariance = _windowed(found * wanted) - x * y
    alike = (2 * x * y + c1) * (2 * covariance + c2)
    alike /= (x * x + y * y + c1) * (variance_x + variance_y + c2)
    return np.asarray(alike.mean(axis=(0, 1)))


def _windowed(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Average through the window, where it lies inside."""
    reach = WINDOW // 2
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / SIGMA) ** 2)
    weights /= weights.sum()
    rows = ndimage.correlate1d(values, weights, axis=0)[reach:-reach]
    means: NDArray[np.float64] = ndimage.correlate1d(rows, weights, axis=1)[:, reach:-reach]
    return means


def _decibels(error: NDArray[np.float64], peak: NDArray[np.float64]) -> NDArray[np.float64]:
    root_mean_square = np.sqrt(np.mean(error**2, axis=(0, 1)))
    with np.errstate(divide="ignore"):
        return np.asarray(20.0 * np.log10(peak / root_mean_square))


def _peak(reference: NDArray[np.float64], peak: float | None) -> NDArray[np.float64]:
    if peak is not None:
        return np.asarray(refuse.positive("peak", peak))
    largest = np.asarray(reference.max(axis=(0, 1)))
    if not np.all(largest > 0):
        raise refuse.Refusal("'reference' must have light in every channel to compare with.")
    return largest


def _both(
    picture: Picture | ArrayLike, reference: Picture | ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Check both pictures and return their values in float64."""
    found, wanted = _values("picture", picture), _values("reference", reference)
    if found.shape != wanted.shape:
        raise refuse.Refusal(f"'picture' must be an array of shape {wanted.shape}, got {found.shape}.")
    return found, wanted


def _values(name: str, picture: Picture | ArrayLike) -> NDArray[np.float64]:
    values = refuse.all_finite(name, picture.pixels if isinstance(picture, Picture) else picture)
    refuse.shape_of(name, values, (None,) * (3 if values.ndim == 3 else 2))
    return values.astype(np.float64)
