"""Orders of many wavelengths, each a lobe over a few cells, added into rows of a table."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def add_orders(powers, wanted, weights, rows, row_shares, columns, column_shares, first, out):  # type: ignore[no-untyped-def]
    """Add lobes to rows of a table, `first` being the first of them.

    `powers[wanted[k]]` are the orders of wavelength k, `weights[k]` its X, Y and Z. `rows[k, i]` holds the
    first and the end of the orders that reach row i, and where their shares begin; `columns[k, n]` the first
    and the end of the columns that order n reaches, and where its shares begin. `out` is (3, rows, columns).
    """
    line, row = np.empty(powers.shape[2]), np.empty(out.shape[2])
    for i in range(out.shape[1]):
        for k in range(wanted.shape[0]):
            low, high, place = rows[k, first + i]
            if low == high:
                continue
            # Mix the orders that reach this row.
            line[:] = 0.0
            for m in range(low, high):
                share = row_shares[place + m - low]
                source = powers[wanted[k], m]
                for n in range(line.size):
                    line[n] += share * source[n]
            # Lay their lobes out along it.
            row[:] = 0.0
            for n in range(line.size):
                start, end, place = columns[k, n]
                power = line[n]
                if start < end and power != 0.0:
                    # Unsigned numbers need no look at negative ones, which would keep the loop slow.
                    begin, offset = np.uint64(start), np.uint64(place) - np.uint64(start)
                    for j in range(begin, np.uint64(end)):
                        row[j] += power * column_shares[offset + j]
            for c in range(3):
                target, weight = out[c, i], weights[k, c]
                for j in range(row.size):
                    target[j] += weight * row[j]
