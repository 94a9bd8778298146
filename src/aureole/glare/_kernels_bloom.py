"""Light between pixels and square boxes of them, and what the boxes' smooth light leaves of bright pixels.

A pixel at t boxes from the middle of its own box (-1/2 < t < 1/2) shares with the next one on that side:
1 - |t| and |t| along each axis. The same shares bring light to the boxes and back. Beyond the frame the last
box stands for the next.
"""

from numba import njit


@njit(cache=True, nogil=True)
def gather(pixels, side, first, last, boxes):  # type: ignore[no-untyped-def]
    """Fill rows of boxes with the light of the pixels about them."""
    rows, columns, channels = boxes.shape
    height, width = pixels.shape[0], pixels.shape[1] * channels
    along = pixels.reshape(pixels.shape[0], width)
    line = along[0].copy()
    for box in range(first, last):
        line[:] = 0
        for i in range(max((box - 1) * side, 0), min((box + 2) * side, height)):
            t = (i % side + 0.5) / side - 0.5
            own = i // side
            beside = min(max(own + (1 if t > 0 else -1), 0), rows - 1)
            share = (1 - abs(t) if own == box else 0.0) + (abs(t) if beside == box else 0.0)
            if share > 0:
                weight = line.dtype.type(share)
                row = along[i]
                for j in range(width):
                    line[j] += weight * row[j]
        boxes[box] = 0
        for j in range(pixels.shape[1]):
            t = (j % side + 0.5) / side - 0.5
            own = j // side
            beside = min(max(own + (1 if t > 0 else -1), 0), columns - 1)
            near, far = line.dtype.type(1 - abs(t)), line.dtype.type(abs(t))
            for k in range(channels):
                value = line[j * channels + k]
                boxes[box, own, k] += near * value
                boxes[box, beside, k] += far * value


@njit(cache=True, nogil=True)
def lay(boxes, side, lit, kept, lowest, first, last, out):  # type: ignore[no-untyped-def]
    """Add the boxes' light, brought back to rows of pixels, and what the picture keeps of its own."""
    rows, columns, channels = boxes.shape
    line = boxes[0].copy()
    scale = 1.0 / (side * side)
    for i in range(first, last):
        t = (i % side + 0.5) / side - 0.5
        own = i // side
        beside = min(max(own + (1 if t > 0 else -1), 0), rows - 1)
        near, far = line.dtype.type((1 - abs(t)) * scale), line.dtype.type(abs(t) * scale)
        for column in range(columns):
            for k in range(channels):
                line[column, k] = near * boxes[own, column, k] + far * boxes[beside, column, k]
        for column in range(columns):
            left, right = max(column - 1, 0), min(column + 1, columns - 1)
            for p in range(min(side, out.shape[1] - column * side)):
                j = column * side + p
                t = (p + 0.5) / side - 0.5
                next_column = right if t > 0 else left
                part = line.dtype.type(abs(t))
                for k in range(channels):
                    glare = line[column, k] + part * (line[next_column, k] - line[column, k])
                    out[i, j, k] = max(out[i, j, k] + glare, lowest) + lit[i, j, k] * kept[k]


@njit(cache=True, nogil=True)
def _left_over(pixels, boxes, side, i, j, k):  # type: ignore[no-untyped-def]
    """Return what a pixel has above the light that its boxes bring back to it; 0 where that is less."""
    rows, columns, _ = boxes.shape
    row, column = i // side, j // side
    y, x = (i % side + 0.5) / side - 0.5, (j % side + 0.5) / side - 0.5
    next_row = min(max(row + (1 if y > 0 else -1), 0), rows - 1)
    next_column = min(max(column + (1 if x > 0 else -1), 0), columns - 1)
    y, x = abs(y), abs(x)
    here = (1 - x) * boxes[row, column, k] + x * boxes[row, next_column, k]
    there = (1 - x) * boxes[next_row, column, k] + x * boxes[next_row, next_column, k]
    return max(pixels[i, j, k] - ((1 - y) * here + y * there) / (side * side), 0.0)


@njit(cache=True, nogil=True)
def roughness(pixels, boxes, side, least, first, last, rough):  # type: ignore[no-untyped-def]
    """Find the most that a pixel of each box that holds enough light has above the boxes' light."""
    for row in range(first, last):
        for column in range(boxes.shape[1]):
            most = 0.0
            light = max(boxes[row, column, 0], boxes[row, column, 1], boxes[row, column, 2])
            if light > least:
                for i in range(row * side, min((row + 1) * side, pixels.shape[0])):
                    for j in range(column * side, min((column + 1) * side, pixels.shape[1])):
                        for k in range(3):
                            most = max(most, _left_over(pixels, boxes, side, i, j, k))
            rough[row, column] = most


@njit(cache=True, nogil=True)
def splat_rough(pixels, boxes, side, rough, level, kernel, out, moved):  # type: ignore[no-untyped-def]
    """Add the kernel for what pixels have above the boxes' light, none of it up to a level.

    Boxes are filled with the light that was spread so.
    """
    high, wide, _ = kernel.shape
    rows, columns, _ = boxes.shape
    left_over = kernel[0, 0].copy()
    for row in range(rough.shape[0]):
        for column in range(rough.shape[1]):
            if rough[row, column] <= level:
                continue
            for i in range(row * side, min((row + 1) * side, pixels.shape[0])):
                for j in range(column * side, min((column + 1) * side, pixels.shape[1])):
                    most = 0.0
                    for k in range(3):
                        left_over[k] = _left_over(pixels, boxes, side, i, j, k)
                        most = max(most, left_over[k])
                    if most <= level:
                        continue
                    share = left_over.dtype.type(1 - (level / most) ** 2)
                    y, x = (i % side + 0.5) / side - 0.5, (j % side + 0.5) / side - 0.5
                    next_row = min(max(row + (1 if y > 0 else -1), 0), rows - 1)
                    next_column = min(max(column + (1 if x > 0 else -1), 0), columns - 1)
                    y, x = abs(y), abs(x)
                    for k in range(3):
                        left_over[k] *= share
                        moved[row, column, k] += (1 - y) * (1 - x) * left_over[k]
                        moved[row, next_column, k] += (1 - y) * x * left_over[k]
                        moved[next_row, column, k] += y * (1 - x) * left_over[k]
                        moved[next_row, next_column, k] += y * x * left_over[k]
                    top, left = i - high // 2, j - wide // 2
                    for p in range(max(0, -top), min(high, out.shape[0] - top)):
                        for q in range(max(0, -left), min(wide, out.shape[1] - left)):
                            for k in range(3):
                                out[top + p, left + q, k] += left_over[k] * kernel[p, q, k]
