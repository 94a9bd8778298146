"""Convolution of a linear picture with a kernel, the picture's size, black outside the picture.

The kernel's centre is its pixel (rows // 2, columns // 2): a kernel that is 1 there and 0 elsewhere
changes nothing. A kernel has one channel for all, or one for each channel of the picture.

The fast method is a Fourier transform that does only what is needed. Its circle has N + max(K // 2,
K − 1 − K // 2) samples, not N + K − 1: what wraps round may fall on everything but the picture
itself, so the kept part is still exact. Rows are transformed two at a time as one complex sequence,
empty rows not at all, columns in blocks that stay in the cache, and the product is taken while the
block is there.

Its rounding is that of the bright parts, spread over the whole picture: in single precision the error
is about 2e-7 of the result's root mean square, and nowhere above 2e-7 or so of its maximum, but it has
nothing to do with a pixel's own value, so pixels a million times darker than the brightest may be off
by per cents. Where neither input is negative, noise below zero is cut off. `precision="double"`
lowers all this by nine decimal digits.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from aureole import refuse
from aureole.picture.torus import Pixels, Torus, Value, thread_count, torus_for

PRECISIONS: dict[str, DTypeLike] = {"single": np.float32, "double": np.float64}
DIRECT_PRODUCTS = 4_000_000  # up to so many products a direct sum is quicker than preparing a transform


def convolve(
    pixels: ArrayLike,
    kernel: ArrayLike,
    method: str = "auto",
    precision: str = "single",
    threads: int | None = None,
) -> Pixels:
    """Convolve a linear picture with a kernel, same size out, black outside the picture.

    Parameters
    ----------
    pixels : array_like, shape (rows, columns) or (rows, columns, channels)
        Linear colour, without alpha.
    kernel : array_like, shape (rows, columns) or (rows, columns, channels)
        Centre at (rows // 2, columns // 2); one channel, or as many as the picture.
    method : str
        "reference" sums directly in double precision; "fft" transforms; "auto" takes the quicker.
    precision : str
        "single" computes and returns float32; "double" float64.
    threads : int, optional
        How many to use; by default one for each processor that this process may use.

    Returns
    -------
    ndarray of float32 or float64, shape of `pixels`
        Not negative where neither input is negative.
    """
    dtype = PRECISIONS[refuse.one_of("precision", precision, PRECISIONS)]
    picture, response = _checked("pixels", pixels, dtype), _checked("kernel", kernel, dtype)
    _refuse_channels(picture, response.shape[2])
    chosen = refuse.one_of("method", method, ("auto", *METHODS))
    if chosen == "auto":
        products = picture.size * response.shape[0] * response.shape[1]
        chosen = "reference" if products <= DIRECT_PRODUCTS else "fft"
    result = METHODS[chosen](picture, response, thread_count(threads))
    return result.reshape(np.shape(pixels))


class Convolver:
    """A kernel that is transformed once, to convolve many pictures of one size with it.

    Parameters
    ----------
    kernel : array_like, shape (rows, columns) or (rows, columns, channels)
        Centre at (rows // 2, columns // 2); one channel, or as many as the pictures.
    shape : tuple of int
        The pictures' (rows, columns); a third number is not needed.
    precision : str
        "single" computes and returns float32; "double" float64.
    threads : int, optional
        How many to use; by default one for each processor that this process may use.
    """

    def __init__(
        self, kernel: ArrayLike, shape: tuple[int, ...], precision: str = "single", threads: int | None = None
    ) -> None:
        dtype = PRECISIONS[refuse.one_of("precision", precision, PRECISIONS)]
        response = _checked("kernel", kernel, dtype)
        self.shape = tuple(refuse.at_least("shape", length, 1) for length in shape[:2])
        response, self._torus = _prepared(response, self.shape, thread_count(threads))
        channels = range(response.shape[2])
        self._spectra = [self._torus.kernel_spectrum(response, channel) for channel in channels]
        self._is_positive = bool(response.min() >= 0)

    def __call__(self, pixels: ArrayLike) -> Pixels:
        """Convolve one picture.

        Parameters
        ----------
        pixels : array_like, shape (rows, columns) or (rows, columns, channels)
            Linear colour, without alpha, of the size that was prepared for.

        Returns
        -------
        ndarray of float32 or float64, shape of `pixels`
            Not negative where neither the picture nor the kernel is negative.
        """
        refuse.shape_of("pixels", pixels, (*self.shape, None)[: np.ndim(pixels)])
        picture = _checked("pixels", pixels, self._torus.down.cosines.dtype)
        _refuse_channels(picture, len(self._spectra))
        out = np.empty_like(picture, order="C")
        half, lowest = self._torus.half_spectrum(), _lowest(picture, self._is_positive)
        for channel in range(picture.shape[2]):
            spectrum = self._spectra[min(channel, len(self._spectra) - 1)]
            self._torus.filter(picture, channel, spectrum, half, lowest, out)
        return out.reshape(np.shape(pixels))


def _by_sum(picture: Pixels, kernel: Pixels, threads: int) -> Pixels:
    """Add the picture once for each pixel of the kernel, shifted and weighted, in double precision."""
    kernel, (centre_y, centre_x) = _cropped(kernel, picture.shape)
    rows, columns, channels = picture.shape
    high, wide, _ = kernel.shape
    padded = np.zeros((rows + high - 1, columns + wide - 1, channels))
    padded[high - 1 - centre_y :, wide - 1 - centre_x :][:rows, :columns] = picture
    total = np.zeros(picture.shape)
    for y, x in np.argwhere(np.any(kernel != 0, axis=2)):
        top, left = high - 1 - y, wide - 1 - x
        total += padded[top : top + rows, left : left + columns] * kernel[y, x].astype(np.float64)
    return total.astype(picture.dtype)


def _by_transform(picture: Pixels, kernel: Pixels, threads: int) -> Pixels:
    """Transform kernel and picture channel by channel, so that one channel's spectra are held at a time."""
    kernel, torus = _prepared(kernel, picture.shape, threads)
    out = np.empty_like(picture, order="C")
    half, spectrum = torus.half_spectrum(), torus.half_spectrum()
    lowest = _lowest(picture, bool(kernel.min() >= 0))
    for channel in range(picture.shape[2]):
        if channel < kernel.shape[2]:
            torus.kernel_spectrum(kernel, channel, spectrum)
        torus.filter(picture, channel, spectrum, half, lowest, out)
    return out


METHODS: dict[str, Callable[[Pixels, Pixels, int], Pixels]] = {"reference": _by_sum, "fft": _by_transform}


def _prepared(kernel: Pixels, shape: tuple[int, ...], threads: int) -> tuple[Pixels, Torus]:
    """Crop a kernel to what counts, and choose the samples for it and the picture."""
    response, centre = _cropped(kernel, shape)
    return response, torus_for(shape, response.shape, centre, kernel.dtype, threads)


def _cropped(kernel: Pixels, shape: tuple[int, ...]) -> tuple[Pixels, tuple[int, int]]:
    """Cut off what no pixel of the picture can reach; return the rest and its centre."""
    cuts, centres = [], []
    for size, length in zip(kernel.shape[:2], shape[:2], strict=True):
        before, after = min(size // 2, length - 1), min(size - 1 - size // 2, length - 1)
        cuts.append(slice(size // 2 - before, size // 2 + after + 1))
        centres.append(before)
    return kernel[cuts[0], cuts[1]], (centres[0], centres[1])


def _lowest(picture: Pixels, kernel_is_positive: bool) -> Value:
    """The lowest value that a result can have: rounding must not make light negative."""
    lowest: Value = picture.dtype.type(0 if kernel_is_positive and picture.min() >= 0 else -np.inf)
    return lowest


def _checked(name: str, array: ArrayLike, dtype: DTypeLike) -> Pixels:
    """Refuse what is not a picture; return it with channels, in the type to compute in."""
    found = refuse.shape_of(name, array, (None,) * (3 if np.ndim(array) == 3 else 2))
    return found.reshape((*found.shape[:2], -1)).astype(dtype, copy=False)


def _refuse_channels(picture: Pixels, count: int) -> None:
    if count not in (1, picture.shape[2]):
        raise refuse.Refusal(
            f"'kernel' must have 1 channel or the picture's {picture.shape[2]}, got {count}."
        )
