"""Light between pixels and boxes of 2 × 2 of them, lumps of light, and a small kernel over a few pixels."""

from numba import njit


@njit(cache=True, nogil=True)
def halve(pixels, out):  # type: ignore[no-untyped-def]
    """Add each pixel's light to the boxes about it: 3/4 and 1/4 along each axis, all within the frame."""
    rows, columns, channels = out.shape
    for i in range(pixels.shape[0]):
        row, beside_row = i // 2, min(max(i // 2 + 2 * (i % 2) - 1, 0), rows - 1)
        for j in range(pixels.shape[1]):
            column, beside = j // 2, min(max(j // 2 + 2 * (j % 2) - 1, 0), columns - 1)
            for k in range(channels):
                quarter = pixels[i, j, k] / 16
                out[row, column, k] += 9 * quarter
                out[row, beside, k] += 3 * quarter
                out[beside_row, column, k] += 3 * quarter
                out[beside_row, beside, k] += quarter


@njit(cache=True, nogil=True)
def double(boxes, out):  # type: ignore[no-untyped-def]
    """Give each pixel its light from the boxes about it, by the same shares of a quarter of a box."""
    rows, columns, channels = boxes.shape
    for i in range(out.shape[0]):
        row, beside_row = i // 2, min(max(i // 2 + 2 * (i % 2) - 1, 0), rows - 1)
        for j in range(out.shape[1]):
            column, beside = j // 2, min(max(j // 2 + 2 * (j % 2) - 1, 0), columns - 1)
            for k in range(channels):
                near = 9 * boxes[row, column, k] + boxes[beside_row, beside, k]
                out[i, j, k] = (near + 3 * (boxes[row, beside, k] + boxes[beside_row, column, k])) / 64


@njit(cache=True, nogil=True)
def _above(strength, ground, top, left, side):  # type: ignore[no-untyped-def]
    """Add up what a square's pixels have above the ground."""
    total = 0.0
    for y in range(max(top, 0), min(top + side, strength.shape[0])):
        for x in range(max(left, 0), min(left + side, strength.shape[1])):
            total += strength[y, x] - ground
    return total


@njit(cache=True, nogil=True)
def lumps(strength, size, whole, ring):  # type: ignore[no-untyped-def]
    """Find pixels above their ring whose light fits a square one pixel wider than the size."""
    rows, columns = strength.shape
    reach = size + 1
    for i in range(rows):
        for j in range(columns):
            # Most pixels are told by the first one or two of the ring around them.
            own, ground = strength[i, j], strength.dtype.type(0)
            for y in range(max(i - reach, 0), min(i + reach + 1, rows)):
                step = 1 if abs(y - i) == reach else 2 * reach
                for x in range(j - reach, j + reach + 1, step):
                    if 0 <= x < columns:
                        ground = max(ground, strength[y, x])
                if ground >= own:
                    break
            if ground >= own:
                continue
            densest = 0.0
            for top in range(i - size, i + 1):
                for left in range(j - size, j + 1):
                    densest = max(densest, _above(strength, ground, top, left, size + 1))
            # What lies about the square counts against it.
            lump = 2 * densest - _above(strength, ground, i - size, j - size, 2 * size + 1)
            if lump > 0:
                whole[i, j], ring[i, j] = min(lump, densest), ground


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
