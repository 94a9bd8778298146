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

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from aureole import refuse
from aureole.picture import _kernels
from aureole.picture.torus import Pixels, Torus, Value, share, thread_count, torus_for

PRECISIONS: dict[str, DTypeLike] = {"single": np.float32, "double": np.float64}
MOST_SPECTRA = 2_000_000_000  # bytes of many kernels' spectra that are kept for the next picture
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


class PlacesConvolver:
    """Kernels of one size, each for its share of each pixel: out = Σ_k K_k ⊗ (w_k · picture).

    Products are added up while they are spectra, and transformed back once; rows without a share are not
    transformed at all.

    Parameters
    ----------
    kernels : sequence of ndarray, shape (rows, columns, channels)
        Centres at (rows // 2, columns // 2); as many channels as the pictures.
    weights : sequence of ndarray, shape (rows, columns)
        One for each kernel, of the pictures' size.
    precision : str
        "single" computes and returns float32; "double" float64.
    threads : int, optional
        How many to use; by default one for each processor that this process may use.
    most_bytes : int
        The kernels' spectra are kept for the next picture where they need no more; else each picture
        transforms the kernels anew.

    Raises
    ------
    refuse.Refusal
        Where sizes or numbers of kernels and weights differ.
    """

    def __init__(
        self,
        kernels: Sequence[Pixels],
        weights: Sequence[Pixels],
        precision: str = "single",
        threads: int | None = None,
        most_bytes: int = MOST_SPECTRA,
    ) -> None:
        dtype = PRECISIONS[refuse.one_of("precision", precision, PRECISIONS)]
        if not kernels or len(kernels) != len(weights):
            raise refuse.Refusal(
                f"'weights' must be one for each kernel, got {len(weights)} for {len(kernels)}."
            )
        self.shape = np.shape(weights[0])
        size = np.shape(kernels[0])
        cut, centre = _cropped(_checked("kernels", kernels[0], dtype), self.shape)
        self._torus = torus_for(self.shape, cut.shape, centre, dtype, thread_count(threads))
        self._kernels, self._weights, self._rows = [], [], []
        for kernel, weight in zip(kernels, weights, strict=True):
            # Kernels keep their own type, since all of them at once are many.
            self._kernels.append(_cropped(refuse.shape_of("kernels", kernel, size), self.shape)[0])
            self._weights.append(refuse.shape_of("weights", weight, self.shape))
            lit = np.flatnonzero(np.any(weight != 0, axis=1))
            self._rows.append((int(lit[0]), int(lit[-1]) + 1) if len(lit) else (0, 0))
        self._is_positive = all(kernel.min() >= 0 for kernel in self._kernels)
        room = self._torus.half_spectrum().nbytes * len(kernels) * size[2]
        self._spectra: dict[tuple[int, int], Pixels] | None = {} if room <= most_bytes else None

    def __call__(self, pixels: ArrayLike) -> Pixels:
        """Convolve one picture.

        Parameters
        ----------
        pixels : array_like, shape (rows, columns, channels)
            Linear colour, without alpha, of the weights' size.

        Returns
        -------
        ndarray of float32 or float64, shape of `pixels`
            Not negative where neither the picture nor the kernels are negative.
        """
        refuse.shape_of("pixels", pixels, (*self.shape, self._kernels[0].shape[2]))
        picture = _checked("pixels", pixels, self._torus.down.cosines.dtype)
        out = np.empty_like(picture, order="C")
        # The last block's unused lanes are added up, too, so they must hold numbers.
        half, lowest = np.zeros_like(self._torus.half_spectrum()), _lowest(picture, self._is_positive)
        for channel in range(picture.shape[2]):
            total = np.zeros_like(half)
            for k, (top, bottom) in enumerate(self._rows):
                if top < bottom:
                    shared = picture[top:bottom, :, channel] * self._weights[k][top:bottom]
                    self._add(shared[..., None], top, self._spectrum(k, channel), half, total)
            self._torus.back(total, channel, lowest, out)
        return out

    def _spectrum(self, k: int, channel: int) -> Pixels:
        """Return a kernel's spectrum, kept from the last picture or made anew."""
        if self._spectra is not None and (k, channel) in self._spectra:
            return self._spectra[k, channel]
        one = self._kernels[k][..., channel : channel + 1].astype(self._torus.down.cosines.dtype)
        spectrum = self._torus.kernel_spectrum(one, 0, np.zeros_like(self._torus.half_spectrum()))
        if self._spectra is not None:
            self._spectra[k, channel] = spectrum
        return spectrum

    def _add(self, shared: Pixels, top: int, spectrum: Pixels, half: Pixels, total: Pixels) -> None:
        """Add the spectrum of a few rows of light, times a kernel's, to the sum of all."""
        scale, bottom = self._torus.scale, top + len(shared)

        def multiply(block: int) -> None:
            half[block, :top], half[block, bottom:] = 0, 0
            self._torus.down.down(half[block])
            _kernels.multiply(half[block], spectrum[block], scale)
            total[block] += half[block]

        self._torus.rows_down(shared, (top, 0), {0: half})
        share(multiply, range(len(half)), self._torus.threads)


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
