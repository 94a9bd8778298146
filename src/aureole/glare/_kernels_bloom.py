"""Light between pixels and square boxes of them, and light that goes from bright pixels to those near by.

A pixel at t boxes from the middle of its own box (-1/2 < t < 1/2) shares with the next one on that side:
1 - |t| and |t| along each axis. The same shares bring light to the boxes and back. Beyond the frame the last
box stands for the next. Rows of a picture are walked as they lie in memory, channel beside channel.
"""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def _shares(box, boxes, side, length, shares):  # type: ignore[no-untyped-def]
    """Fill what a box gets of each pixel from half a box before it on, and return how many give to it."""
    count = 2 * side - side % 2
    shares[:] = 0
    for n in range(count):
        i = box * side - side // 2 + n
        from_middle = (2 * n + 1 - count) / (2 * side)
        alone = (box == 0 and from_middle < 0) or (box == boxes - 1 and from_middle > 0)
        if 0 <= i < length:
            shares[n] = 1 if alone else 1 - abs(from_middle)
    return count


@njit(cache=True, nogil=True, fastmath={"contract"})
def _add_rows(along, start, shares, line):  # type: ignore[no-untyped-def]
    """Add up rows by their shares, four at a time."""
    end = len(along) - 1
    line[:] = 0
    for n in range(0, len(shares), 4):
        i = start + n
        a, b, c, d = shares[n], shares[n + 1], shares[n + 2], shares[n + 3]
        one, two = along[min(max(i, 0), end)], along[min(max(i + 1, 0), end)]
        three, four = along[min(max(i + 2, 0), end)], along[min(max(i + 3, 0), end)]
        for j in range(len(line)):
            line[j] += a * one[j] + b * two[j] + c * three[j] + d * four[j]


@njit(cache=True, nogil=True)
def gather(pixels, side, first, last, boxes, brightest):  # type: ignore[no-untyped-def]
    """Fill rows of boxes with the light of the pixels about them, and with their own brightest value."""
    rows, columns = boxes.shape[0], boxes.shape[1]
    height, width = pixels.shape[0], pixels.shape[1]
    along = pixels.reshape(height, width * 3)
    zero = along.dtype.type(0)
    line, most = along[0].copy(), along[0].copy()
    down, inside, edge = np.zeros((3, 2 * side // 4 * 4 + 4), dtype=line.dtype)
    for box in range(first, last):
        _shares(box, rows, side, height, down)
        _add_rows(along, box * side - side // 2, down, line)
        most[:] = along[box * side]
        for i in range(box * side + 1, min((box + 1) * side, height)):
            row = along[i]
            for j in range(len(most)):
                most[j] = max(most[j], row[j])
        count = _shares(1, 3, side, 9 * side, inside)
        for column in range(columns):
            shares = inside
            if column == 0 or column >= columns - 2:
                _shares(column, columns, side, width, edge)
                shares = edge
            begin = column * side - side // 2
            red, green, blue = zero, zero, zero
            for n in range(max(0, -begin), min(count, width - begin)):
                j = 3 * (begin + n)
                red += shares[n] * line[j]
                green += shares[n] * line[j + 1]
                blue += shares[n] * line[j + 2]
            boxes[box, column, 0], boxes[box, column, 1], boxes[box, column, 2] = red, green, blue
            red, green, blue = zero, zero, zero
            for j in range(column * side, min((column + 1) * side, width)):
                red, green, blue = (
                    max(red, most[3 * j]),
                    max(green, most[3 * j + 1]),
                    max(blue, most[3 * j + 2]),
                )
            brightest[box, column] = max(red, green, blue)


@njit(cache=True, nogil=True)
def pick(pixels, brightest, side, level, rows, columns, light):  # type: ignore[no-untyped-def]
    """List the pixels with a channel above a level, box by box, and return how many there are."""
    count = 0
    for box in range(brightest.shape[0]):
        for beside in range(brightest.shape[1]):
            if brightest[box, beside] <= level:
                continue
            for i in range(box * side, min((box + 1) * side, pixels.shape[0])):
                for j in range(beside * side, min((beside + 1) * side, pixels.shape[1])):
                    if max(pixels[i, j, 0], pixels[i, j, 1], pixels[i, j, 2]) > level:
                        rows[count], columns[count] = i, j
                        for k in range(light.shape[1]):
                            light[count, k] = pixels[i, j, k]
                        count += 1
    return count


@njit(cache=True, nogil=True)
def share_out(rows, columns, light, side, boxes):  # type: ignore[no-untyped-def]
    """Add the light of some pixels to the boxes about them."""
    high, wide, channels = boxes.shape
    for n in range(len(rows)):
        y, x = (rows[n] % side + 0.5) / side - 0.5, (columns[n] % side + 0.5) / side - 0.5
        row, column = rows[n] // side, columns[n] // side
        next_row = min(max(row + (1 if y > 0 else -1), 0), high - 1)
        next_column = min(max(column + (1 if x > 0 else -1), 0), wide - 1)
        y, x = abs(y), abs(x)
        for k in range(channels):
            boxes[row, column, k] += (1 - y) * (1 - x) * light[n, k]
            boxes[row, next_column, k] += (1 - y) * x * light[n, k]
            boxes[next_row, column, k] += y * (1 - x) * light[n, k]
            boxes[next_row, next_column, k] += y * x * light[n, k]


@njit(cache=True, nogil=True)
def widen(boxes, side, wide):  # type: ignore[no-untyped-def]
    """Bring boxes back to pixels along each row of them."""
    columns, width = boxes.shape[1], wide.shape[1]
    scale = boxes.dtype.type(1 / (side * side))
    for box in range(boxes.shape[0]):
        for n in range(side):
            t = (n + 0.5) / side - 0.5
            aside = 1 if t > 0 else -1
            near, far = scale * boxes.dtype.type(1 - abs(t)), scale * boxes.dtype.type(abs(t))
            for column in range((width - n - 1) // side + 1):
                own, beside = boxes[box, column], boxes[box, min(max(column + aside, 0), columns - 1)]
                target = wide[box, column * side + n]
                target[0] = near * own[0] + far * beside[0]
                target[1] = near * own[1] + far * beside[1]
                target[2] = near * own[2] + far * beside[2]


@njit(cache=True, nogil=True, fastmath={"contract"})
def lay(wide, side, pixels, kept, first, last, out):  # type: ignore[no-untyped-def]
    """Fill rows of pixels with the light of boxes and with what they keep of their own."""
    height, length = wide.shape[0], out.shape[1] * out.shape[2]
    lines, onto = wide.reshape(height, length), out.reshape(len(out), length)
    lit = pixels.reshape(len(out), length)
    for i in range(first, last):
        t = (i % side + 0.5) / side - 0.5
        own = i // side
        beside = min(max(own + (1 if t > 0 else -1), 0), height - 1)
        near, far = wide.dtype.type(1 - abs(t)), wide.dtype.type(abs(t))
        here, there, source, target = lines[own], lines[beside], lit[i], onto[i]
        for j in range(length):
            target[j] = near * here[j] + far * there[j] + kept[j] * source[j]


@njit(cache=True, nogil=True, fastmath={"contract"})
def splat_rows(rows, columns, times, taps, reach, first, last, out):  # type: ignore[no-untyped-def]
    """Add kernels to some rows of a picture, each about its place and times its light.

    A kernel's row is as long as that of the light, which is repeated for all of its pixels.
    """
    channels = out.shape[2]
    onto = out.reshape(out.shape[0], out.shape[1] * channels)
    for n in range(len(rows)):
        top, left = rows[n] - len(taps) // 2, channels * (columns[n] - reach)
        begin, end = max(left, 0), min(left + taps.shape[1], onto.shape[1])
        light = times[n, begin - left :]
        for y in range(max(top, first), min(top + len(taps), last)):
            target, source = onto[y, begin:end], taps[y - top, begin - left :]
            for q in range(end - begin):
                target[q] += light[q] * source[q]
