"""Kernels from point spread functions: borders that fade, no negative light, other programs' habits."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import light, picture, refuse
from aureole.records import Picture

# Part of the half size over which a kernel falls to zero at its border.
FADE = 0.25
HOSTS = ("unreal", "blender", "nuke")


def fade(shape: tuple[int, int], width: float = FADE) -> NDArray[np.float32]:
    """Return the radial window that takes a kernel to exactly zero at its border.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns); sides shorter than 9 pixels are not faded.
    width : float
        Part of the half size over which the window falls from 1 to 0.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        1 about the centre, 0 from the border's nearest pixel on.
    """
    if width == 0 or min(shape) < 9:
        return np.ones(shape, dtype=np.float32)
    rows, columns = (np.abs(np.arange(n) - n // 2) / ((n - 1) // 2) for n in shape)
    radius = np.hypot(rows[:, None], columns)
    share = np.clip((1 - radius) / width, 0, 1)
    # The quintic has no visible start and no visible end.
    return np.asarray(share**3 * (10 - 15 * share + 6 * share**2), dtype=np.float32)


def beyond_core(shape: tuple[int, int], radius: float) -> NDArray[np.float32]:
    """Return 0 within a core's radius, rising smoothly to 1 at twice the radius.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns) of the kernel.
    radius : float
        In pixels.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        The share of each pixel that is not core.

    Raises
    ------
    refuse.Refusal
        Where the radius is not above zero.
    """
    refuse.positive("core_radius", radius)
    rows, columns = (np.arange(n) - n // 2 for n in shape)
    share = np.clip(np.hypot(rows[:, None], columns) / radius - 1, 0, 1)
    return np.asarray(share**2 * (3 - 2 * share), dtype=np.float32)


def nonnegative(psf: Picture) -> Picture:
    """Take out-of-gamut colour to the gamut's edge, keeping each channel's sum.

    Parameters
    ----------
    psf : Picture
        Linear RGB.

    Returns
    -------
    Picture
        Each pixel with a negative channel mixed with its own grey until none is negative, then each
        channel scaled to the sum it had.
    """
    colour = psf.pixels[..., :3]
    if float(colour.min()) >= 0:
        return psf
    mapped = picture.into_gamut(colour, light.SPACES[psf.colour_space].to_xyz[1])
    before, after = channel_sums(colour), channel_sums(mapped)
    mapped *= (before / after).astype(np.float32)
    return Picture(mapped, psf.colour_space, psf.metadata)


def channel_sums(pixels: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return each channel's sum in double precision.

    Parameters
    ----------
    pixels : ndarray, shape (rows, columns, channels)
        Any.

    Returns
    -------
    ndarray of float64, shape (channels,)
        The sums.
    """
    rows, columns, channels = pixels.shape
    # Sums down the rows run along memory, which takes a fraction of the time.
    along = pixels.reshape(rows, -1).sum(axis=0, dtype=np.float64)
    return np.asarray(along.reshape(columns, channels).sum(axis=0))


def cropped(kernel: NDArray[np.float32], radius: int) -> NDArray[np.float32]:
    """Return a kernel's middle.

    Parameters
    ----------
    kernel : ndarray of float32, shape (rows, columns, channels)
        Its centre at (rows // 2, columns // 2).
    radius : int
        Pixels to keep on each side of it.

    Returns
    -------
    ndarray of float32, shape (R, C, channels)
        Its centre at (R // 2, C // 2).
    """
    spans = []
    for length in kernel.shape[:2]:
        before, after = min(radius, length // 2), min(radius, length - 1 - length // 2)
        spans.append(slice(length // 2 - before, length // 2 + after + 1))
    return np.ascontiguousarray(kernel[spans[0], spans[1]])


def kernel_for(psf: Picture, host: str) -> Picture:
    """Return a kernel as another program expects it.

    Parameters
    ----------
    psf : Picture
        A point spread function with its core at (rows//2, columns//2).
    host : str
        "unreal": square, core at the centre, for convolution bloom. "blender": turned by 180 degrees,
        since its Convolve node correlates, core at (K//2, K//2). "nuke": each channel sums to 1.

    Returns
    -------
    Picture
        Non-negative float32; sums kept, but for "nuke".

    Raises
    ------
    refuse.Refusal
        Where the host is unknown.
    """
    refuse.one_of("host", host, HOSTS)
    kernel = nonnegative(psf)
    pixels = kernel.pixels[..., :3]
    if host == "unreal":
        pixels = _square(pixels)
    elif host == "blender":
        pixels = pixels[::-1, ::-1]
        # Turning an even side moves the core one pixel up; it is put back.
        pixels = np.roll(pixels, [1 - side % 2 for side in pixels.shape[:2]], axis=(0, 1))
    else:
        pixels = (pixels / channel_sums(pixels)).astype(np.float32)
    return Picture(np.ascontiguousarray(pixels), kernel.colour_space, kernel.metadata)


def encircled_energy(psf: Picture, radius: ArrayLike, pixel_pitch: tuple[float, float]) -> Any:
    """Return the energy within circles about the core, mean over channels.

    Parameters
    ----------
    psf : Picture
        Energy per pixel; a pixel on the circle counts by the part of it within.
    radius : array_like
        Metres on the sensor; one radius or many.
    pixel_pitch : tuple of float
        Pixel size (y, x) in metres.

    Returns
    -------
    float, or ndarray of the radii's shape
        Fractions of the whole energy.
    """
    radii = np.asarray(radius, dtype=np.float64)
    order = np.sort(radii.ravel())
    rows, columns = psf.pixels.shape[:2]
    offsets = (np.arange(8) + 0.5) / 8 - 0.5
    y = ((np.arange(rows) - rows // 2)[:, None] + offsets).ravel() * pixel_pitch[0]
    x = ((np.arange(columns) - columns // 2)[:, None] + offsets).ravel() * pixel_pitch[1]
    energy = psf.pixels[..., :3].mean(axis=2, dtype=np.float64) / 64
    beyond = np.zeros(len(order) + 1)
    for row in range(rows):
        # Each pixel is sampled at 8 × 8 places, and each place lies within the circles from one on.
        first = np.searchsorted(order, np.hypot(y[8 * row : 8 * row + 8, None], x))
        shares = np.broadcast_to(np.repeat(energy[row], 8), first.shape)
        beyond += np.bincount(first.ravel(), shares.ravel(), len(beyond))
    within = np.cumsum(beyond)[np.searchsorted(order, radii)]
    return float(within) if radii.ndim == 0 else within


def _square(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Set pixels on a dark square with the core at its centre."""
    side = max(pixels.shape[:2])
    square = np.zeros((side, side, 3), dtype=np.float32)
    top, left = (side // 2 - length // 2 for length in pixels.shape[:2])
    square[top : top + pixels.shape[0], left : left + pixels.shape[1]] = pixels
    return square
