"""Fourier transforms of many rows or columns side by side, and the products between them.

A work array has shape (n, WIDTH): n samples of LANES independent sequences, their real parts in the
first LANES places of a row and their imaginary parts in the next, so that every loop over lanes runs
in vector registers and a whole block of sequences stays in the second-level cache. `down` transforms
in place by decimation in frequency and leaves the frequencies in digit-reversed order; `up` is the
inverse (times n) and takes them in that order, so nothing is ever reordered.

A half spectrum has shape (blocks, n, WIDTH): frequency f along the rows is lane f % LANES of block
f // LANES, and each block is a work array for the transform along the columns.

Every kernel works on one block and lets the interpreter go, so the caller's threads share blocks out.
"""

from numba import njit

LANES = 64  # sequences side by side
WIDTH = 2 * LANES + 16  # not a power of two: samples a power of two apart would fall on few cache sets


@njit(fastmath=True, cache=True, nogil=True)
def _turn(re, im, c, s):  # type: ignore[no-untyped-def]
    return re * c - im * s, re * s + im * c


@njit(fastmath=True, cache=True, nogil=True)
def _dft3(ar, ai, br, bi, cr, ci, c, s):  # type: ignore[no-untyped-def]
    sr, si = br + cr, bi + ci
    tr, ti = ar + c * sr, ai + c * si
    ur, ui = s * (ci - bi), s * (br - cr)
    return ar + sr, ai + si, tr + ur, ti + ui, tr - ur, ti - ui


@njit(fastmath=True, cache=True, nogil=True)
def _dft4(ar, ai, br, bi, cr, ci, dr, di):  # type: ignore[no-untyped-def]
    er, ei, fr, fi = ar + cr, ai + ci, ar - cr, ai - ci
    gr, gi, hr, hi = br + dr, bi + di, bi - di, dr - br
    return er + gr, ei + gi, fr + hr, fi + hi, er - gr, ei - gi, fr - hr, fi - hi


@njit(fastmath=True, cache=True, nogil=True)
def _dft5(ar, ai, br, bi, cr, ci, dr, di, er, ei, c1, s1, c2, s2):  # type: ignore[no-untyped-def]
    pr, pi, qr, qi = br + er, bi + ei, cr + dr, ci + di
    ur, ui, vr, vi = br - er, bi - ei, cr - dr, ci - di
    xr, xi = ar + c1 * pr + c2 * qr, ai + c1 * pi + c2 * qi
    yr, yi = ar + c2 * pr + c1 * qr, ai + c2 * pi + c1 * qi
    mr, mi = -(s1 * ui + s2 * vi), s1 * ur + s2 * vr
    nr, ni = s1 * vi - s2 * ui, s2 * ur - s1 * vr
    return ar + pr + qr, ai + pi + qi, xr + mr, xi + mi, yr + nr, yi + ni, yr - nr, yi - ni, xr - mr, xi - mi


@njit(fastmath=True, cache=True, nogil=True)
def _down2(w, n, m, co, si):  # type: ignore[no-untyped-def]
    step = n // (2 * m)
    for start in range(0, n, 2 * m):
        for j in range(m):
            a, b = w[start + j], w[start + j + m]
            c1, s1 = co[j * step], si[j * step]
            for k in range(LANES):
                ar, ai, br, bi = a[k], a[LANES + k], b[k], b[LANES + k]
                a[k], a[LANES + k] = ar + br, ai + bi
                b[k], b[LANES + k] = _turn(ar - br, ai - bi, c1, s1)


@njit(fastmath=True, cache=True, nogil=True)
def _down3(w, n, m, co, si):  # type: ignore[no-untyped-def]
    step = n // (3 * m)
    root_c, root_s = co[n // 3], si[n // 3]
    for start in range(0, n, 3 * m):
        for j in range(m):
            a, b, c = w[start + j], w[start + j + m], w[start + j + 2 * m]
            t = j * step
            c1, s1, c2, s2 = co[t], si[t], co[2 * t], si[2 * t]
            for k in range(LANES):
                xr, xi, yr, yi, zr, zi = _dft3(
                    a[k], a[LANES + k], b[k], b[LANES + k], c[k], c[LANES + k], root_c, root_s
                )
                a[k], a[LANES + k] = xr, xi
                b[k], b[LANES + k] = _turn(yr, yi, c1, s1)
                c[k], c[LANES + k] = _turn(zr, zi, c2, s2)


@njit(fastmath=True, cache=True, nogil=True)
def _down4(w, n, m, co, si):  # type: ignore[no-untyped-def]
    step = n // (4 * m)
    for start in range(0, n, 4 * m):
        for j in range(m):
            a, b, c, d = w[start + j], w[start + j + m], w[start + j + 2 * m], w[start + j + 3 * m]
            t = j * step
            c1, s1, c2, s2, c3, s3 = co[t], si[t], co[2 * t], si[2 * t], co[3 * t], si[3 * t]
            for k in range(LANES):
                xr, xi, yr, yi, zr, zi, vr, vi = _dft4(
                    a[k], a[LANES + k], b[k], b[LANES + k], c[k], c[LANES + k], d[k], d[LANES + k]
                )
                a[k], a[LANES + k] = xr, xi
                b[k], b[LANES + k] = _turn(yr, yi, c1, s1)
                c[k], c[LANES + k] = _turn(zr, zi, c2, s2)
                d[k], d[LANES + k] = _turn(vr, vi, c3, s3)


@njit(fastmath=True, cache=True, nogil=True)
def _down5(w, n, m, co, si):  # type: ignore[no-untyped-def]
    step = n // (5 * m)
    r1, i1, r2, i2 = co[n // 5], si[n // 5], co[2 * (n // 5)], si[2 * (n // 5)]
    for start in range(0, n, 5 * m):
        for j in range(m):
            i = start + j
            a, b, c, d, e = w[i], w[i + m], w[i + 2 * m], w[i + 3 * m], w[i + 4 * m]
            t = j * step
            c1, s1, c2, s2 = co[t], si[t], co[2 * t], si[2 * t]
            c3, s3, c4, s4 = co[3 * t], si[3 * t], co[4 * t], si[4 * t]
            for k in range(LANES):
                xr, xi, yr, yi, zr, zi, vr, vi, ur, ui = _dft5(
                    a[k], a[LANES + k], b[k], b[LANES + k], c[k], c[LANES + k],
                    d[k], d[LANES + k], e[k], e[LANES + k], r1, i1, r2, i2,
                )  # fmt: skip
                a[k], a[LANES + k] = xr, xi
                b[k], b[LANES + k] = _turn(yr, yi, c1, s1)
                c[k], c[LANES + k] = _turn(zr, zi, c2, s2)
                d[k], d[LANES + k] = _turn(vr, vi, c3, s3)
                e[k], e[LANES + k] = _turn(ur, ui, c4, s4)


# The inverse runs the stages backwards, twiddle first, with real and imaginary parts exchanged.


@njit(fastmath=True, cache=True, nogil=True)
def _up2(w, n, m, co, si):  # type: ignore[no-untyped-def]
    step = n // (2 * m)
    for start in range(0, n, 2 * m):
        for j in range(m):
            a, b = w[start + j], w[start + j + m]
            c1, s1 = co[j * step], si[j * step]
            for k in range(LANES):
                ar, ai = a[LANES + k], a[k]
                br, bi = _turn(b[LANES + k], b[k], c1, s1)
                a[LANES + k], a[k] = ar + br, ai + bi
                b[LANES + k], b[k] = ar - br, ai - bi


@njit(fastmath=True, cache=True, nogil=True)
def _up3(w, n, m, co, si):  # type: ignore[no-untyped-def]
    step = n // (3 * m)
    root_c, root_s = co[n // 3], si[n // 3]
    for start in range(0, n, 3 * m):
        for j in range(m):
            a, b, c = w[start + j], w[start + j + m], w[start + j + 2 * m]
            t = j * step
            c1, s1, c2, s2 = co[t], si[t], co[2 * t], si[2 * t]
            for k in range(LANES):
                br, bi = _turn(b[LANES + k], b[k], c1, s1)
                cr, ci = _turn(c[LANES + k], c[k], c2, s2)
                xr, xi, yr, yi, zr, zi = _dft3(a[LANES + k], a[k], br, bi, cr, ci, root_c, root_s)
                a[LANES + k], a[k] = xr, xi
                b[LANES + k], b[k] = yr, yi
                c[LANES + k], c[k] = zr, zi


@njit(fastmath=True, cache=True, nogil=True)
def _up4(w, n, m, co, si):  # type: ignore[no-untyped-def]
    step = n // (4 * m)
    for start in range(0, n, 4 * m):
        for j in range(m):
            a, b, c, d = w[start + j], w[start + j + m], w[start + j + 2 * m], w[start + j + 3 * m]
            t = j * step
            c1, s1, c2, s2, c3, s3 = co[t], si[t], co[2 * t], si[2 * t], co[3 * t], si[3 * t]
            for k in range(LANES):
                br, bi = _turn(b[LANES + k], b[k], c1, s1)
                cr, ci = _turn(c[LANES + k], c[k], c2, s2)
                dr, di = _turn(d[LANES + k], d[k], c3, s3)
                xr, xi, yr, yi, zr, zi, vr, vi = _dft4(a[LANES + k], a[k], br, bi, cr, ci, dr, di)
                a[LANES + k], a[k] = xr, xi
                b[LANES + k], b[k] = yr, yi
                c[LANES + k], c[k] = zr, zi
                d[LANES + k], d[k] = vr, vi


@njit(fastmath=True, cache=True, nogil=True)
def _up5(w, n, m, co, si):  # type: ignore[no-untyped-def]
    step = n // (5 * m)
    r1, i1, r2, i2 = co[n // 5], si[n // 5], co[2 * (n // 5)], si[2 * (n // 5)]
    for start in range(0, n, 5 * m):
        for j in range(m):
            i = start + j
            a, b, c, d, e = w[i], w[i + m], w[i + 2 * m], w[i + 3 * m], w[i + 4 * m]
            t = j * step
            c1, s1, c2, s2 = co[t], si[t], co[2 * t], si[2 * t]
            c3, s3, c4, s4 = co[3 * t], si[3 * t], co[4 * t], si[4 * t]
            for k in range(LANES):
                br, bi = _turn(b[LANES + k], b[k], c1, s1)
                cr, ci = _turn(c[LANES + k], c[k], c2, s2)
                dr, di = _turn(d[LANES + k], d[k], c3, s3)
                er, ei = _turn(e[LANES + k], e[k], c4, s4)
                xr, xi, yr, yi, zr, zi, vr, vi, ur, ui = _dft5(
                    a[LANES + k], a[k], br, bi, cr, ci, dr, di, er, ei, r1, i1, r2, i2
                )
                a[LANES + k], a[k] = xr, xi
                b[LANES + k], b[k] = yr, yi
                c[LANES + k], c[k] = zr, zi
                d[LANES + k], d[k] = vr, vi
                e[LANES + k], e[k] = ur, ui


@njit(cache=True, nogil=True)
def down(w, radices, co, si):  # type: ignore[no-untyped-def]
    """Transform a work array in place; frequencies come out digit-reversed."""
    n = m = len(w)
    for r in radices:
        m //= r
        if r == 4:
            _down4(w, n, m, co, si)
        elif r == 5:
            _down5(w, n, m, co, si)
        elif r == 3:
            _down3(w, n, m, co, si)
        else:
            _down2(w, n, m, co, si)


@njit(cache=True, nogil=True)
def up(w, radices, co, si):  # type: ignore[no-untyped-def]
    """Transform back in place, times n, from digit-reversed frequencies."""
    n, m = len(w), 1
    for r in radices[::-1]:
        if r == 4:
            _up4(w, n, m, co, si)
        elif r == 5:
            _up5(w, n, m, co, si)
        elif r == 3:
            _up3(w, n, m, co, si)
        else:
            _up2(w, n, m, co, si)
        m *= r


@njit(fastmath=True, cache=True, nogil=True)
def multiply(w, other, scale):  # type: ignore[no-untyped-def]
    """Multiply a work array by another, complex number by complex number, and by a scale."""
    for i in range(len(w)):
        a, b = w[i], other[i]
        for k in range(LANES):
            a[k], a[LANES + k] = _turn(a[k], a[LANES + k], scale * b[k], scale * b[LANES + k])


@njit(cache=True, nogil=True)
def load(pixels, channel, first, count, shift, w):  # type: ignore[no-untyped-def]
    """Put every other row in the real parts and the rows between in the imaginary parts, turned round."""
    n, columns = len(w), pixels.shape[1]
    w[:] = 0
    for start in range(0, columns, LANES):
        for lane in range((count + 1) // 2):
            for part in range(min(2, count - 2 * lane)):
                row = pixels[first + 2 * lane + part]
                at = (start + shift) % n
                for j in range(start, min(start + LANES, columns)):
                    w[at, part * LANES + lane] = row[j, channel]
                    at = at + 1 if at + 1 < n else 0


@njit(fastmath=True, cache=True, nogil=True)
def split(w, places, first, count, shift, half):  # type: ignore[no-untyped-def]
    """Part the rows that were transformed two as one complex sequence, and hand them to the columns."""
    n, rows = len(w), half.shape[1]
    for block in range(len(half)):
        start = block * LANES
        for lane in range((count + 1) // 2):
            one = half[block, (first + 2 * lane + shift) % rows]
            two = half[block, (first + 2 * lane + 1 + shift) % rows]
            alone = 2 * lane + 1 == count
            for k in range(min(LANES, n // 2 + 1 - start)):
                p, q = places[start + k], places[n - start - k]
                pr, pi, qr, qi = w[p, lane], w[p, LANES + lane], w[q, lane], w[q, LANES + lane]
                one[k], one[LANES + k] = (pr + qr) / 2, (pi - qi) / 2
                if not alone:
                    two[k], two[LANES + k] = (pi + qi) / 2, (qr - pr) / 2


@njit(fastmath=True, cache=True, nogil=True)
def join(half, places, first, count, w):  # type: ignore[no-untyped-def]
    """Make one complex sequence of the half spectra of two rows, for as many pairs as there are lanes."""
    n = len(w)
    for block in range(len(half)):
        start = block * LANES
        for lane in range((count + 1) // 2):
            one = half[block, first + 2 * lane]
            two = half[block, min(first + 2 * lane + 1, half.shape[1] - 1)]
            for k in range(min(LANES, n // 2 + 1 - start)):
                p, q = places[start + k], places[n - start - k]
                ar, ai, br, bi = one[k], one[LANES + k], two[k], two[LANES + k]
                w[q, lane], w[q, LANES + lane] = ar + bi, br - ai
                w[p, lane], w[p, LANES + lane] = ar - bi, ai + br


@njit(cache=True, nogil=True)
def store(w, first, count, channel, lowest, out):  # type: ignore[no-untyped-def]
    """Copy the lanes to their rows, and nothing below the lowest value."""
    columns = out.shape[1]
    for start in range(0, columns, LANES):
        for lane in range((count + 1) // 2):
            for part in range(min(2, count - 2 * lane)):
                row = out[first + 2 * lane + part]
                for j in range(start, min(start + LANES, columns)):
                    row[j, channel] = max(w[j, part * LANES + lane], lowest)
