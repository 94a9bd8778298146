"""The sum over all directions of light, look-up by look-up: what every faster way is held against."""

from numba import njit, prange


@njit(cache=True, nogil=True)
def _place(h, half_range, inverse_warp, count):  # type: ignore[no-untyped-def]
    """Where a component of h lies among the table's samples, which are even in u with h = half_range uⁿ."""
    ratio = min(abs(h) / half_range, 1.0)
    u = ratio**inverse_warp
    return 0.5 * (count - 1) * (1.0 + (u if h >= 0 else -u))


@njit(cache=True, nogil=True, parallel=True)
def add_samples(views, places, energies, count, values, half_range, inverse_warp, total):  # type: ignore[no-untyped-def]
    """Add the table's value at each sample's and view's h, times its energy, to each view's total."""
    rows, columns, _ = values.shape
    for v in prange(views.shape[0]):
        red, green, blue = 0.0, 0.0, 0.0
        for p in range(count):
            if abs(places[p, 0] + views[v, 0]) > half_range or abs(places[p, 1] + views[v, 1]) > half_range:
                continue
            x = _place(places[p, 0] + views[v, 0], half_range, inverse_warp, columns)
            y = rows - 1 - _place(places[p, 1] + views[v, 1], half_range, inverse_warp, rows)
            j, i = min(int(x), columns - 2), min(int(y), rows - 2)
            right, down = x - j, y - i
            a, b = (1.0 - down) * (1.0 - right), (1.0 - down) * right
            c, d = down * (1.0 - right), down * right
            upper, lower = values[i], values[i + 1]
            red += energies[p, 0] * (
                a * upper[j, 0] + b * upper[j + 1, 0] + c * lower[j, 0] + d * lower[j + 1, 0]
            )
            green += energies[p, 1] * (
                a * upper[j, 1] + b * upper[j + 1, 1] + c * lower[j, 1] + d * lower[j + 1, 1]
            )
            blue += energies[p, 2] * (
                a * upper[j, 2] + b * upper[j + 1, 2] + c * lower[j, 2] + d * lower[j + 1, 2]
            )
        total[v, 0] += red
        total[v, 1] += green
        total[v, 2] += blue
