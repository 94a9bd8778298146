"""Laying one small kernel over a few pixels, each with its own light."""

from numba import njit


@njit(cache=True, nogil=True)
def splat(rows, columns, light, kernel, out):  # type: ignore[no-untyped-def]
    """Add the kernel, times the light of each place, where it falls on the picture."""
    height, width, channels = kernel.shape
    for n in range(len(rows)):
        top, left = rows[n] - height // 2, columns[n] - width // 2
        for y in range(max(0, -top), min(height, out.shape[0] - top)):
            for x in range(max(0, -left), min(width, out.shape[1] - left)):
                for channel in range(channels):
                    out[top + y, left + x, channel] += light[n, channel] * kernel[y, x, channel]
