"""The period of a grating from where its orders lie, and what the orders say against a measurement.

Orders lie at h = m λ / d along the direction of a period d, evenly and symmetrically about h = 0, whatever
the height or the shape of the lines. A wrong wavelength or scale stretches them all; a wrong centre shifts
them; a wrong tilt makes them wider on one side, and wrong distances make them wider or narrower outward.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.surface.pattern import DiffractionPattern, on_grid

Profile = NDArray[np.float64]

# Powers of the profile that are tried: few strong orders are told by the first, weak ones count in the last.
COMPRESSIONS = (0.5, 0.25)
ALIKE = 0.2  # correlation of a profile with itself, an order farther, from which it is a row of orders
_LEAST_ORDERS, _LEAST_SAMPLES = 3, 9
_TOLD = 0.95  # of the light's rows that must have been seen at a place
_SEEN = 0.4  # of the orders between the outermost ones
_CONTRAST = 0.1  # of an order over the least light beside it, compressed, to count
_DEPTH = 0.3  # of an order over the least light beside it, of itself: blurred orders are not where they seem
_DARK_BETWEEN = 0.5  # half-way between orders, of the orders, compressed
_SCATTER = 0.05  # of the spacing: root mean square of the orders' places about an even row


@dataclass(frozen=True)
class OrderRow:
    """The orders along one direction, as fitted by h_m = offset + spacing · (m + skew · m² + bend · m³).

    Parameters
    ----------
    period : float
        Metres: λ over the spacing.
    spacing : float
        h from one order to the next, near h = 0.
    offset : float
        h of the zero order.
    skew : float
        By how much the spacing differs on the two sides at the outermost order that was seen, of itself.
    bend : float
        By how much it has grown there, of itself; 0 where fewer than seven orders were seen.
    orders : int
        How many orders were seen.
    """

    period: float
    spacing: float
    offset: float
    skew: float
    bend: float
    orders: int


def period_of(
    pattern: DiffractionPattern, seen: NDArray[np.bool_] | None = None
) -> tuple[OrderRow | None, OrderRow | None]:
    """Find a pattern's period along the tangent and along the bitangent.

    Parameters
    ----------
    pattern : DiffractionPattern
        Its zero order at h = 0 or near it; lines along the tangent or the bitangent.
    seen : ndarray of bool, shape (rows, columns), or None
        Where it was measured: orders that a photograph's rim cuts do not count; None is everywhere.

    Returns
    -------
    along_t, along_b : OrderRow or None
        None where there are no orders in a row, three at least.
    """
    y, x = on_grid(pattern).grid.axes()
    values = np.maximum(pattern.values, 0.0).astype(np.float64)
    known = np.ones(values.shape, bool) if seen is None else seen
    along_t = _row(*_within(values, known, x), pattern.wavelength)
    along_b = _row(*_within(values.T[:, ::-1], known.T[:, ::-1], -y[::-1]), pattern.wavelength)
    return along_t, along_b


def _within(values: Profile, known: NDArray[np.bool_], places: Profile) -> tuple[Profile, Profile]:
    """Return the mean over rows, and its places, as far about h = 0 as the lit rows were seen."""
    light = values.sum(axis=1)
    told = light @ known >= _TOLD * light.sum()
    middle = int(np.argmin(np.abs(places)))
    gaps = np.flatnonzero(~told)
    low = int(gaps[gaps < middle].max(initial=-1)) + 1
    high = int(gaps[gaps >= middle].min(initial=places.size))
    return values[:, low:high].mean(axis=0) if high > low else values[0, :0], places[low:high]


def order_notes(
    pattern: DiffractionPattern,
    period: float | Sequence[float] | None = None,
    tolerance: float = 0.005,
    seen: NDArray[np.bool_] | None = None,
) -> tuple[str, ...]:
    """Say what a measured pattern's orders have against the wavelength and the geometry that were given.

    Parameters
    ----------
    pattern : DiffractionPattern
        As measured.
    period : float, sequence of two floats, or None
        The known period in metres along both directions, or along tangent and bitangent, which tells a wrong
        wavelength or scale; None does not know.
    tolerance : float
        Relative differences up to which nothing is said; four times as much of spacings that grow outward,
        since a row's envelope seems to bend it too.
    seen : ndarray of bool, shape (rows, columns), or None
        Where the pattern was measured.

    Returns
    -------
    tuple of str
        Sentences for the person who measured; empty where all agrees, or where there are no orders.
    """
    wanted: Sequence[float] | None = None
    if period is not None:
        wanted = refuse.shape_of("period", np.broadcast_to(period, (2,)), (2,)).tolist()
    steps = [2.0 * pattern.half_range / (count - 1) for count in pattern.values.shape[::-1]]
    notes: list[str] = []
    for axis, row in enumerate(period_of(pattern, seen)):
        if row is not None:
            known = None if wanted is None else refuse.positive("period", wanted[axis])
            notes += _complaints(row, "tb"[axis], steps[axis], known, tolerance)
    return tuple(notes)


def _complaints(
    row: OrderRow, direction: str, step: float, known: float | None, tolerance: float
) -> list[str]:
    """Say in sentences what one row of orders has against the measurement."""
    notes = []
    if abs(row.offset) > 0.5 * step and abs(row.offset) > tolerance * row.spacing:
        notes.append(
            f"Along {direction} the orders lie evenly about a place {row.offset / step:+.1f} samples from the"
            " zero order that was taken; check 'centre'."
        )
    if abs(row.skew) > tolerance:
        notes.append(
            f"Along {direction} the orders' spacing differs by {100 * abs(row.skew):.1f} % between the two"
            " sides; check the tilt and the camera's axis."
        )
    if abs(row.bend) > 4.0 * tolerance:
        notes.append(
            f"Along {direction} the orders' spacing changes by {100 * row.bend:+.1f} % from the centre"
            " outward; check the distances of camera and lamp."
        )
    if known is not None and abs(row.period / known - 1.0) > tolerance:
        notes.append(
            f"Along {direction} the orders tell a period of {1e6 * row.period:.4g} µm where"
            f" {1e6 * known:.4g} µm is known: wavelength or scale is"
            f" {100 * abs(row.period / known - 1.0):.1f} % too"
            f" {'small' if row.period < known else 'large'}."
        )
    return notes


def _row(light: Profile, places: Profile, wavelength: float) -> OrderRow | None:
    """Fit the row of orders in a profile over rising places; None where there is none."""
    if light.size < _LEAST_SAMPLES:
        return None
    rows = [_row_of(light**power, places, wavelength) for power in COMPRESSIONS]
    # Of the same orders the one that tells more of them tells them better.
    return max((row for row in rows if row is not None), key=lambda row: row.orders, default=None)


def _row_of(profile: Profile, places: Profile, wavelength: float) -> OrderRow | None:
    """Fit the row of orders in a compressed profile."""
    step = float(places[1] - places[0])
    spacing = _first_spacing(profile)
    if spacing is None:
        return None
    middle = float(-places[0] / step)  # sample of h = 0
    # Where the zero order is missing, its neighbours lie half-way between what looks like orders.
    if _comb(profile, middle, spacing, 0.5) > _comb(profile, middle, spacing, 0.0):
        spacing = spacing / 2.0
    numbers, found = _peaks(profile, middle, spacing)
    if numbers.size < _LEAST_ORDERS or numbers.size < _SEEN * (np.ptp(numbers) + 1):
        return None
    # A falling envelope draws orders inward; once it is divided out they stand where they are.
    if _comb(profile, middle, spacing, 0.5) > _DARK_BETWEEN * _comb(profile, middle, spacing, 0.0):
        return None
    envelope = _envelope(profile, found)
    numbers, found = _peaks(profile / envelope, middle, spacing)
    if numbers.size < _LEAST_ORDERS:
        return None
    return _fitted(numbers, (found - middle) * step, spacing * step, wavelength)


def _envelope(profile: Profile, found: Profile) -> Profile:
    """Return how orders' heights fall about each order, 1 at the order itself."""
    places = np.arange(profile.size, dtype=np.float64)
    heights = np.maximum(np.interp(found, places, profile), 1e-6 * profile.max())
    slopes = np.gradient(np.log(heights), found)
    nearest = np.searchsorted(0.5 * (found[1:] + found[:-1]), places)
    return np.asarray(np.exp(slopes[nearest] * (places - found[nearest])))


def _fitted(
    numbers: NDArray[np.int64], places: Profile, spacing: float, wavelength: float
) -> OrderRow | None:
    """Fit orders' places by their numbers."""
    square = np.polynomial.polynomial.polyfit(numbers, places, 2 if numbers.size > _LEAST_ORDERS else 1)
    line = square[:2] if numbers.size > _LEAST_ORDERS else square
    rest = places - np.polynomial.polynomial.polyval(numbers, square)
    if np.sqrt(np.mean(rest**2)) > _SCATTER * spacing:
        return None
    outermost = float(np.abs(numbers).max())
    skew, bend = 0.0, 0.0
    if numbers.size > _LEAST_ORDERS:
        # The slopes at ±m differ by 4 c m.
        skew = float(4.0 * square[2] * outermost / line[1])
    if numbers.size >= 7:
        cube = np.polynomial.polynomial.polyfit(numbers, places, 3)
        bend = float(3.0 * cube[3] * outermost**2 / cube[1])
    return OrderRow(wavelength / float(line[1]), float(line[1]), float(line[0]), skew, bend, numbers.size)


def _first_spacing(profile: Profile) -> float | None:
    """Return the shift, in samples, at which a profile is most like itself beyond its first unlikeness."""
    signal = profile - profile.mean()
    size = 2 * signal.size
    likeness = np.fft.irfft(np.abs(np.fft.rfft(signal, size)) ** 2, size)[: signal.size]
    if not likeness[0] > 0:
        return None
    likeness = likeness / likeness[0]
    rising = np.flatnonzero(np.diff(likeness) > 0)
    if rising.size == 0:
        return None
    reach = (3 * signal.size) // 4
    best = int(rising[0] + np.argmax(likeness[rising[0] : reach])) if rising[0] < reach else 0
    return float(best) if best > 2 and likeness[best] > ALIKE else None


def _comb(profile: Profile, middle: float, spacing: float, shift: float) -> float:
    """Return the mean of a profile at every order's place, shifted by a share of the spacing."""
    most = int(profile.size / spacing) + 1
    places = middle + (np.arange(-most, most + 1) + shift) * spacing
    inside = (places >= 0) & (places <= profile.size - 1)
    return float(np.interp(places[inside], np.arange(profile.size), profile).mean())


def _peaks(profile: Profile, middle: float, spacing: float) -> tuple[NDArray[np.int64], Profile]:
    """Find orders one after the other from the middle outward, each from where the last ones point."""
    found: dict[int, float] = {}
    around = max(0.3 * spacing, 2.0)
    start = _peak(profile, middle, around)
    found[0] = middle if start is None else start
    for side in (1, -1):
        place, step = found[0], side * spacing
        for number in range(1, int(profile.size / spacing) + 1):
            expected = place + step
            if not around <= expected <= profile.size - 1 - around:
                break
            peak = _peak(profile, expected, around)
            if peak is not None:
                found[side * number] = peak
                step = (peak - found[0]) / number
            place = expected if peak is None else peak
    if start is None:
        del found[0]
    numbers = np.array(sorted(found), dtype=np.int64)
    return numbers, np.array([found[int(number)] for number in numbers])


def _peak(profile: Profile, place: float, around: float) -> float | None:
    """Return the place of the largest value near a place, between samples; None where nothing stands out."""
    low, high = max(round(place - around), 1), min(round(place + around), profile.size - 2)
    if high - low < 2:
        return None
    part = profile[low : high + 1]
    best = low + int(np.argmax(part))
    top, least = profile[best], part.min()
    if best in (low, high) or top - least < max(_CONTRAST * profile.max(), _DEPTH * top):
        return None
    # The centroid of what rises above half the peak's height, on both sides alike.
    level = 0.5 * (top + least)
    left, right = best, best
    while left > low and profile[left - 1] > level:
        left -= 1
    while right < high and profile[right + 1] > level:
        right += 1
    weights = profile[left : right + 1] - level
    if right - left < 2:
        before, here, after = profile[best - 1 : best + 2]
        return float(best + 0.5 * (before - after) / (before - 2.0 * here + after))
    return float(np.arange(left, right + 1) @ weights / weights.sum())
