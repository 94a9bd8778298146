"""How much light a table sends back: the directional albedo, and tables that send back no more than came.

In direction cosines ds = cos θ dω, so that the albedo of light from s_i is ∫ f_r cos θ_o dω_o =
4π² F² G ∫ S_d(s_i + s_o) ds_o over the unit disc: the table's integral over a disc about s_i. Here F² G is 1,
as at normal incidence on a mirror. Tables whose albedo is at most 1 conserve energy; f_r is reciprocal in
any case, since h is the same with ω_i and ω_o exchanged.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.surface.table import ScatterTable, areas, axes, cells

# Incidences of the bound: points of a square grid over the disc of direction cosines.
_ACROSS = 64
_STRIP = 1.0 / 64.0  # rows and columns that lie together in less are one to the bound
_TOGETHER = 16  # discs that are integrated at once


def albedo(table: ScatterTable, incidence: ArrayLike = (0.0, 0.0)) -> NDArray[np.float64]:
    """Return which share of the light from one direction a table sends back.

    Parameters
    ----------
    table : ScatterTable
        Any.
    incidence : array_like, shape (..., 2)
        Components (s · t, s · b) of the unit vector towards the light, in or on the unit circle;
        sin 30° = 0.5.

    Returns
    -------
    ndarray of float64, shape (..., 3)
        Shares of the light's X, Y and Z with F² G = 1; the second is the share of its luminance.

    Raises
    ------
    refuse.Refusal
        Where an incidence is not a direction above the surface.
    """
    given = np.asarray(refuse.all_finite("incidence", incidence), dtype=np.float64)
    if given.shape[-1:] != (2,):
        raise refuse.Refusal(f"'incidence' must be an array of shape (..., 2), got {given.shape}.")
    longest = float(np.hypot(given[..., 0], given[..., 1]).max())
    if longest > 1.0 + 1e-12:
        raise refuse.Refusal(f"'incidence' must be at most 1 long (grazing light), got {longest:g}.")
    masses, (h_b, _), edges = _masses(table, table.values), axes(table), _edges(table)
    return _discs(masses, h_b, edges, given.reshape(-1, 2), 1.0).reshape(*given.shape[:-1], 3)


def albedo_bound(table: ScatterTable) -> float:
    """Return a number that a table's albedo exceeds at no incidence.

    Parameters
    ----------
    table : ScatterTable
        Any.

    Returns
    -------
    float
        The largest share of X, Y or Z over a grid of incidences, each with a disc that is wider by the
        grid's half diagonal: so it holds between the grid's points, too. What the whole table sends back,
        where that is less. Negative values count as zero.
    """
    masses, (h_b, h_t), edges = _masses(table, np.maximum(table.values, 0.0)), axes(table), _edges(table)
    total = float(masses.sum(axis=(0, 1)).max())
    if total <= 1.0:
        return total
    rows, columns = _strips(h_b), _strips(h_t)
    masses = np.add.reduceat(np.add.reduceat(masses, rows, axis=0), columns, axis=1)
    middles = 0.5 * (h_b[rows] + h_b[np.append(rows[1:], h_b.size) - 1])
    line = np.linspace(-1.0, 1.0, _ACROSS)
    grid = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    # Strips move what is in them by their breadth at most, in each direction.
    radius = 1.0 + np.sqrt(2.0) * (1.0 / (_ACROSS - 1) + _STRIP)
    near = grid[np.hypot(grid[:, 0], grid[:, 1]) <= radius]
    found = _discs(masses, middles, np.append(edges[columns], edges[-1]), near, radius)
    return min(total, float(found.max()))


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


def _masses(table: ScatterTable, values: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the share of the light's X, Y and Z that each cell sends back: (R, C, 3)."""
    along_b, along_t = areas(table)
    white = np.asarray(table.white)
    # A single line may have no X, Y or Z at all; then nothing of it is sent back.
    scale = np.divide(4.0 * np.pi**2, white, out=np.zeros(3), where=white > 0)
    masses: NDArray[np.float64] = values * scale
    masses *= along_b[:, None, None]
    masses *= along_t[None, :, None]
    return masses


def _edges(table: ScatterTable) -> NDArray[np.float64]:
    """Return the ends of the cells along t: (C + 1,)."""
    low, high = cells(table.values.shape[1], table.half_range, table.warp)
    return np.append(low, high[-1])


def _strips(places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return where a new strip begins along rising or falling places."""
    return np.flatnonzero(np.diff(np.floor(places / _STRIP), prepend=np.inf))


def _discs(
    masses: NDArray[np.float64],
    h_b: NDArray[np.float64],
    edges: NDArray[np.float64],
    centres: NDArray[np.float64],
    radius: float,
) -> NDArray[np.float64]:
    """Add the masses (R, C, 3) of rows at h_b and between edges in discs about centres (N, 2): (N, 3)."""
    # The sum along each row up to an edge; a chord is a difference of two.
    running = np.zeros((h_b.size, edges.size, 3))
    np.cumsum(masses, axis=1, out=running[:, 1:])
    total = np.empty((len(centres), 3))
    for start in range(0, len(centres), _TOGETHER):
        centre_t, centre_b = centres[start : start + _TOGETHER].T[:, :, None]
        half = np.sqrt(np.maximum(radius**2 - (h_b - centre_b) ** 2, 0.0))
        chords = _at(running, edges, centre_t + half) - _at(running, edges, centre_t - half)
        total[start : start + _TOGETHER] = chords.sum(axis=1)
    return total


def _at(
    running: NDArray[np.float64], edges: NDArray[np.float64], t: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Read the running integral of each row (R, E, 3) at one place a row and centre, t (N, R): (N, R, 3)."""
    rows = np.arange(t.shape[1])
    index = np.clip(np.searchsorted(edges, t, side="right") - 1, 0, edges.size - 2)
    share = np.clip((t - edges[index]) / (edges[index + 1] - edges[index]), 0.0, 1.0)[..., None]
    return np.asarray((1.0 - share) * running[rows, index] + share * running[rows, index + 1])
