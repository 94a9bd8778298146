"""How much light a table sends back: the directional albedo, and tables that send back no more than came.

In direction cosines ds = cos θ dω, so that the albedo of light from s_i is ∫ f_r cos θ_o dω_o =
4π² G ∫ F² S_d(s_i + s_o) ds_o over the unit disc: the table's integral over a disc about s_i. Here G is 1,
and F, too, unless it is given. Tables whose albedo is at most 1 conserve energy; f_r is reciprocal in any
case, since h is the same with ω_i and ω_o exchanged.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from aureole import light, refuse
from aureole.surface.table import ScatterTable, areas, axes, cells, neutral_white

Array = NDArray[np.float64]

_BINS = 256  # of the bound's grid to a direction cosine of 1
_TOGETHER = 64  # discs that are integrated at once
_SPACE = "rec709"  # of Fresnel factors in colour


def albedo(table: ScatterTable, incidence: ArrayLike = (0.0, 0.0), fresnel: ArrayLike | None = None) -> Array:
    """Return which share of the light from one direction a table sends back.

    Parameters
    ----------
    table : ScatterTable
        Any.
    incidence : array_like, shape (..., 2)
        Components (s · t, s · b) of the unit vector towards the light, in or on the unit circle;
        sin 30° = 0.5.
    fresnel : array_like, shape (K,) or (K, 3), or None
        F at cosines 0..1 between light and half vector, as `schlick` and `conductor` give it: each direction
        counts by F² (three columns are linear Rec.709). None is F = 1.

    Returns
    -------
    ndarray of float64, shape (..., 3)
        Shares of the light's X, Y and Z with G = 1; the second is the share of its luminance.

    Raises
    ------
    refuse.Refusal
        Where an incidence is not a direction above the surface, or a Fresnel factor is negative.
    """
    given = np.asarray(refuse.all_finite("incidence", incidence), dtype=np.float64)
    if given.shape[-1:] != (2,):
        raise refuse.Refusal(f"'incidence' must be an array of shape (..., 2), got {given.shape}.")
    longest = float(np.hypot(given[..., 0], given[..., 1]).max())
    if longest > 1.0 + 1e-12:
        raise refuse.Refusal(f"'incidence' must be at most 1 long (grazing light), got {longest:g}.")
    places = given.reshape(-1, 2)
    if fresnel is None:
        found = _shares(table, places)
    else:
        factors = _checked_fresnel(fresnel)
        found = np.concatenate([_shares_by_fresnel(table, place, factors) for place in places])
    return found.reshape(*given.shape[:-1], 3)


def albedo_bound(table: ScatterTable) -> float:
    """Return a number that a table's albedo exceeds at no incidence.

    Parameters
    ----------
    table : ScatterTable
        Any.

    Returns
    -------
    float
        The largest share of X, Y or Z over a fine grid of incidences, each with a disc that is wider by what
        separates places in the grid's bins: so it holds between the grid's points, too, and is above the
        largest albedo by 1.2 % for a perfect diffuser, by less where light lies in orders. What the whole
        table sends back, where that is less. Negative values count as zero.
    """
    most, sums = 0.0, _DiscSums(table)
    for plane in _planes(table, table.values, clipped=True):
        total = float(plane.sum())
        # No disc holds more than all.
        if total > most:
            most = max(most, min(total, sums.largest(plane)) if total > 1.0 else total)
    return most


def normalised(table: ScatterTable) -> ScatterTable:
    """Darken a table, where needed, so that no incidence gives back more light than came.

    Parameters
    ----------
    table : ScatterTable
        Any.

    Returns
    -------
    ScatterTable
        Divided by `albedo_bound` where that is above 1; the metadata's "normalised_by" says by how much.
    """
    factor = max(albedo_bound(table), 1.0)
    values = (
        np.asarray(table.values / np.float32(factor * (1.0 + 1e-6)), np.float32)
        if factor > 1
        else table.values
    )
    return replace(table, values=values, metadata={**table.metadata, "normalised_by": factor})


def _planes(
    table: ScatterTable, values: NDArray[np.floating], white: ArrayLike | None = None, clipped: bool = False
) -> Iterator[Array]:
    """Yield the share of the light that each cell sends back, (R, C), channel by channel."""
    along_b, along_t = areas(table)
    for channel, level in enumerate(np.asarray(table.white if white is None else white)):
        # A single line may have no X, Y or Z at all; then nothing of it is sent back.
        plane = values[:, :, channel] * (4.0 * np.pi**2 / level * along_t if level > 0 else 0.0 * along_t)
        plane *= along_b[:, None]
        yield np.maximum(plane, 0.0, out=plane) if clipped else plane


def _shares(table: ScatterTable, places: Array) -> Array:
    """Return the albedo (N, 3) for light from places (N, 2)."""
    (h_b, _), edges = axes(table), _edges(table)
    found = [_discs(plane, h_b, edges, places) for plane in _planes(table, table.values)]
    return np.stack(found, axis=-1)


def _shares_by_fresnel(table: ScatterTable, place: Array, factors: Array) -> Array:
    """Return the albedo (1, 3) for light from one place, each cell's light times F²."""
    h_b, h_t = axes(table)
    s_t, s_b = h_t[None, :] - place[0], h_b[:, None] - place[1]
    # ω_i · ω_o; cells that the horizon cuts count as grazing.
    both = s_t * place[0] + s_b * place[1]
    both += np.sqrt(np.maximum(1.0 - place @ place, 0.0) * np.maximum(1.0 - s_t**2 - s_b**2, 0.0))
    cosine = np.sqrt(np.clip(0.5 * (1.0 + both), 0.0, 1.0))
    white = neutral_white(table.white, _SPACE)
    colours = light.from_xyz(table.values, _SPACE, white)
    grid = np.linspace(0.0, 1.0, len(factors))
    sums = [
        _discs(plane * np.interp(cosine, grid, factor) ** 2, h_b, _edges(table), place[None])
        for plane, factor in zip(_planes(table, colours, np.ones(3)), factors.T, strict=True)
    ]
    level = np.asarray(table.white)
    found = np.asarray(light.to_xyz(np.stack(sums, axis=-1), _SPACE, white), dtype=np.float64)
    shares: Array = np.divide(found, level, out=np.zeros_like(found), where=level > 0)
    return shares


def _checked_fresnel(fresnel: ArrayLike) -> Array:
    """Return Fresnel factors as (K, 3)."""
    given = np.asarray(refuse.all_finite("fresnel", fresnel), dtype=np.float64)
    factors = given[:, None] if given.ndim == 1 else given
    if factors.ndim != 2 or len(factors) < 2 or factors.shape[1] not in (1, 3):
        raise refuse.Refusal(
            f"'fresnel' must be an array of shape (K,) or (K, 3), K >= 2, got {given.shape}."
        )
    if factors.min() < 0:
        raise refuse.Refusal(f"'fresnel' must not be negative, got {factors.min():g}.")
    return np.broadcast_to(factors, (len(factors), 3))


def _edges(table: ScatterTable) -> Array:
    """Return the ends of the cells along t: (C + 1,)."""
    low, high = cells(table.values.shape[1], table.half_range, table.warp)
    return np.append(low, high[-1])


def _discs(plane: Array, h_b: Array, edges: Array, centres: Array) -> Array:
    """Add the shares (R, C) of rows at h_b and between edges in unit discs about centres (N, 2): (N,)."""
    at = _running(plane, edges)
    total = np.empty(len(centres))
    for start in range(0, len(centres), _TOGETHER):
        centre_t, centre_b = centres[start : start + _TOGETHER].T[:, :, None]
        half = np.sqrt(np.maximum(1.0 - (h_b - centre_b) ** 2, 0.0))
        chords = at(centre_t + half) - at(centre_t - half)
        total[start : start + _TOGETHER] = chords.sum(axis=1)
    return total


def _running(plane: Array, edges: Array) -> Callable[[Array], Array]:
    """Return what integrates each row (R, C) up to a place, (N, R) or (R, M), linear between edges."""
    running = np.zeros((len(plane), edges.size))
    np.cumsum(plane, axis=1, out=running[:, 1:])

    def at(t: Array) -> Array:
        index = np.clip(np.searchsorted(edges, t, side="right") - 1, 0, edges.size - 2)
        share = np.clip((t - edges[index]) / (edges[index + 1] - edges[index]), 0.0, 1.0)
        # Places of their own for each row, or the same for all.
        rows = np.arange(len(plane)) if t.ndim == 2 else np.arange(len(plane))[:, None]
        return np.asarray((1.0 - share) * running[rows, index] + share * running[rows, index + 1])

    return at


class _DiscSums:
    """The sums of cells' shares over discs about the points of a grid, all at once by a transform."""

    def __init__(self, table: ScatterTable) -> None:
        (h_b, _), self._edges = axes(table), _edges(table)
        self._reach = int(np.ceil(table.half_range * _BINS)) + 1
        # Rows stand where they are, columns spread over their cells: so has `albedo` it.
        places = np.rint(h_b * _BINS).astype(np.int64)
        self._starts = np.flatnonzero(np.diff(places, prepend=places[0] + 1))
        self._rows = places[self._starts] + self._reach
        # What a bin holds lies half its diagonal from its middle at most, and so does a light from a point.
        radius = _BINS + np.sqrt(2.0)
        # Within the period no disc meets the table's other end.
        self._side = fft.next_fast_len(2 * self._reach + 5, real=True)
        away = np.fft.fftfreq(self._side, 1.0 / self._side)
        disc = (away[:, None] ** 2 + away[None, :] ** 2 <= radius**2).astype(np.float64)
        self._disc = fft.rfft2(disc)

    def largest(self, plane: Array) -> float:
        """Return the largest sum of one channel's shares, (R, C), over points on the disc of directions."""
        reach, side = self._reach, self._side
        across = _running(np.add.reduceat(plane, self._starts, axis=0), self._edges)
        ends = (np.arange(-reach, reach + 2) - 0.5) / _BINS
        shares = np.zeros((side, side))
        shares[self._rows, : 2 * reach + 1] = np.diff(across(ends), axis=1)
        sums = fft.irfft2(fft.rfft2(shares) * self._disc, (side, side))
        axis = np.arange(side) - reach
        near = np.hypot(axis[:, None], axis[None, :]) <= _BINS + np.sqrt(0.5)
        # Transforms err by a few roundings of the whole.
        return float(sums[near].max()) + 1e-12 * float(plane.sum())
