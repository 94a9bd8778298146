"""The full integral over all directions of light: the reference for lights from all around.

Each pixel of the surroundings is one even patch, so what a flat sample sends to a view is a sum of radiances
times the table's integrals over patches of direction cosines. Two ways, which share nothing but the table:

- "borders" integrates along the patches' borders (Green's theorem): the table is linear between its nodes in
  the warped coordinate, so its integral along h_t is known exactly, and Gauss's rule between nodes does the
  rest to rounding, however sharp the table is. The sum costs as much as there are nodes on borders.
- "directions" cuts each pixel into smaller and smaller patches and looks the table up at their middles, as
  a renderer does. It is slow to settle where table or light are sharp.

In: a table, an environment, a frame, views; out: radiance and how far it has settled.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.surface import _kernels_quadrature
from aureole.surface.environment import (
    FOUR_PI_SQUARED,
    Environment,
    directions,
    directions_checked,
    frame_checked,
)
from aureole.surface.table import ScatterTable, axis, rgb

METHODS = ("borders", "directions")
ABOVE = 1e-12  # cosines to the normal below this are the horizon itself
FEWEST_POINTS = 2


@dataclass(frozen=True, eq=False)
class Quadrature:
    """Light towards some views, integrated over all directions.

    Parameters
    ----------
    radiance : ndarray of float64, shape (V, 3)
        4π² ∫ S_d L_i ds, without F² G.
    change : ndarray of float64, shape (V,)
        What the last refinement changed, over the view's largest channel.
    parts : int
        Gauss points on each piece of a border, or parts of each pixel along a side.
    """

    radiance: NDArray[np.float64]
    change: NDArray[np.float64]
    parts: int


def quadrature(
    table: ScatterTable,
    environment: Environment,
    frame: ArrayLike,
    views: ArrayLike,
    tolerance: float = 1e-4,
    most_parts: int = 16,
    method: str = "borders",
) -> Quadrature:
    """Integrate the light that a flat sample sends to some views over all directions.

    Parameters
    ----------
    table : ScatterTable
        Of the sample.
    environment : Environment
        The light; multiplied with the table in its colour space.
    frame : array_like, shape (3, 3)
        Tangent, bitangent and normal of the sample in the world.
    views : array_like, shape (V, 2)
        Direction cosines along tangent and bitangent.
    tolerance : float
        Refined until no view changes by more than this share.
    most_parts : int
        Refined no further than to so many points or parts, settled or not.
    method : {"borders", "directions"}
        Along the borders of the light's pixels, or look-up by look-up.

    Returns
    -------
    Quadrature
        Radiance, and how far it has settled.

    Raises
    ------
    refuse.Refusal
        Where an argument is not as described.
    """
    places = directions_checked("views", views).reshape(-1, 2)
    axes = frame_checked(frame)
    refuse.positive("tolerance", tolerance)
    refuse.at_least("most_parts", most_parts, 2)
    refuse.one_of("method", method, METHODS)
    if method == "borders":
        whole, edges = BorderSums(table, environment.colour_space), borders(environment, axes)
        ladder = range(FEWEST_POINTS, most_parts + 1)
        sums = (whole(edges, places, points) for points in ladder)
    else:
        colours = rgb(table, environment.colour_space)
        ladder = range(int(np.log2(most_parts)) + 1)
        sums = (_summed(table, colours, environment, axes, places, 2**halvings) for halvings in ladder)
    radiance, change, steps = np.zeros((len(places), 3)), np.full(len(places), np.inf), 0
    for step, finer in zip(ladder, sums, strict=True):
        if step > ladder[0]:
            scale = np.maximum(np.abs(finer).max(axis=1), np.finfo(np.float64).tiny)
            change = np.abs(finer - radiance).max(axis=1) / scale
        radiance, steps = finer, step
        if change.max(initial=0.0) <= tolerance:
            break
    return Quadrature(radiance, change, steps if method == "borders" else 2**steps)


def _summed(
    table: ScatterTable,
    colours: NDArray[np.float32],
    environment: Environment,
    frame: ArrayLike,
    views: NDArray[np.float64],
    parts: int,
) -> NDArray[np.float64]:
    total = np.zeros((len(views), 3))
    for places, energies, count in directions(environment, frame, parts):
        _kernels_quadrature.add_samples(
            views, places, energies, count, colours, table.half_range, 1.0 / table.warp, total
        )
    return FOUR_PI_SQUARED * total


class BorderSums:
    """A table's running integrals, made once for many lights, frames and views.

    Parameters
    ----------
    table : ScatterTable
        Of the sample.
    colour_space : str
        Linear RGB space of the light.
    """

    def __init__(self, table: ScatterTable, colour_space: str = "rec709") -> None:
        rows, columns = table.values.shape[:2]
        self._nodes = axis(columns, table.half_range, table.warp), axis(rows, table.half_range, table.warp)
        # Rows rise with h_b here.
        self._values = np.ascontiguousarray(rgb(table, colour_space)[::-1], dtype=np.float64)
        self._sums = _running(self._values, self._nodes[0], table.half_range, table.warp)
        self._numbers = np.array([table.half_range, 1.0 / table.warp, float(table.warp)])

    def __call__(
        self, edges: NDArray[np.float64], views: NDArray[np.float64], points: int = 3
    ) -> NDArray[np.float64]:
        """Sum the light towards some views.

        Parameters
        ----------
        edges : ndarray of float64, shape (N, 11)
            From `borders`.
        views : ndarray of float64, shape (V, 2)
            Direction cosines along tangent and bitangent.
        points : int
            Gauss points on each piece of a border.

        Returns
        -------
        ndarray of float64, shape (V, 3)
            4π² ∫ S_d L_i ds.
        """
        places, weights = np.polynomial.legendre.leggauss(points)
        gauss = 0.5 + 0.5 * places, 0.5 * weights
        total = np.zeros((len(views), 3))
        table = *self._nodes, self._values, self._sums, self._numbers
        _kernels_quadrature.add_borders(views, edges, *table, *gauss, total)
        return FOUR_PI_SQUARED * total


def _running(
    values: NDArray[np.float64], nodes: NDArray[np.float64], half_range: float, warp: int
) -> NDArray[np.float64]:
    """Integral over h_t from the first node to each node, of what is linear in u between nodes."""
    u = (2 * np.arange(len(nodes)) - (len(nodes) - 1)) / (len(nodes) - 1)
    gap, length = 2.0 / (len(nodes) - 1), np.diff(nodes)
    moment = half_range * warp / (warp + 1) * np.diff(u ** (warp + 1))
    right = ((moment - u[:-1] * length) / gap)[None, :, None]
    pieces = (length[None, :, None] - right) * values[:, :-1] + right * values[:, 1:]
    sums = np.zeros_like(values)
    np.cumsum(pieces, axis=1, out=sums[:, 1:])
    return sums


def borders(environment: Environment, axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """List the borders between pixels of unlike light above a flat sample, and the horizon.

    Parameters
    ----------
    environment : Environment
        The light.
    axes : ndarray of float64, shape (3, 3)
        Tangent, bitangent and normal of the sample in the world.

    Returns
    -------
    ndarray of float64, shape (N, 11)
        c, a, b of h_t's part x(t) = c + a cos t + b sin t, the same of h_b's, first and last t, and the
        radiance on the left of the border less that on its right; x and y do not turn back on any.
    """
    light = environment.radiance.astype(np.float64)
    rows, columns = light.shape[:2]
    latitude = np.pi / 2 - np.pi * np.arange(rows + 1) / rows
    longitude = 2 * np.pi * np.arange(columns + 1) / columns - np.pi
    ahead = np.stack([np.sin(longitude), np.zeros(columns + 1), -np.cos(longitude)])
    # Seen from above, left is left only where tangent, bitangent and normal are right-handed.
    hand = np.sign(np.linalg.det(axes))
    parts = []
    # Meridians, upwards: later columns lie on their left, as seen from outside of the sphere.
    curves = np.zeros((columns, rows, 3, 3))
    curves[..., 1] = (axes @ ahead[:, :-1]).T[:, None]
    curves[..., 2] = axes[:, 1]
    spans = np.stack([latitude[1:], latitude[:-1]], axis=-1)[None].repeat(columns, axis=0)
    jumps = hand * (light - np.roll(light, 1, axis=1)).transpose(1, 0, 2)
    parts.append(_cut(curves.reshape(-1, 3, 3), spans.reshape(-1, 2), jumps.reshape(-1, 3)))
    # Parallels, towards later columns: the row below lies on their left.
    inner = latitude[1:-1]
    curves = np.zeros((rows - 1, columns, 3, 3))
    curves[..., 0] = (np.sin(inner)[:, None] * axes[:, 1])[:, None]
    curves[..., 1] = (-np.cos(inner)[:, None] * axes[:, 2])[:, None]
    curves[..., 2] = (np.cos(inner)[:, None] * axes[:, 0])[:, None]
    spans = np.stack([longitude[:-1], longitude[1:]], axis=-1)[None].repeat(rows - 1, axis=0)
    jumps = hand * (light[1:] - light[:-1])
    parts.append(_cut(curves.reshape(-1, 3, 3), spans.reshape(-1, 2), jumps.reshape(-1, 3)))
    parts.append(_horizon(light, axes, latitude, longitude))
    return np.ascontiguousarray(np.concatenate(parts))


def _cut(
    curves: NDArray[np.float64], spans: NDArray[np.float64], jumps: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Cut borders where x or y turn and at the horizon; keep what separates light above it."""
    lit = np.any(jumps != 0, axis=1)
    curves, spans, jumps = curves[lit], spans[lit], jumps[lit]
    first = spans[:, :1]
    phase = np.arctan2(curves[:, :, 2], curves[:, :, 1])
    turns = first + np.mod(phase[:, :2] - first, np.pi)
    radius = np.hypot(curves[:, 2, 1], curves[:, 2, 2])
    reach = np.arccos(np.clip(-curves[:, 2, 0] / np.maximum(radius, 1e-300), -1, 1))
    sets = phase[:, 2:] + np.stack([reach, -reach], axis=1)
    cuts = np.concatenate([spans, turns, first + np.mod(sets - first, 2 * np.pi)], axis=1)
    cuts = np.sort(np.minimum(np.maximum(cuts, first), spans[:, 1:]), axis=1)
    low, high = cuts[:, :-1].ravel(), cuts[:, 1:].ravel()
    which = np.repeat(np.arange(len(curves)), cuts.shape[1] - 1)
    middle, up = 0.5 * (low + high), curves[which, 2]
    height = up[:, 0] + up[:, 1] * np.cos(middle) + up[:, 2] * np.sin(middle)
    kept = (high > low) & (height > ABOVE)
    which, low, high = which[kept], low[kept], high[kept]
    return np.column_stack([curves[which, 0], curves[which, 1], low, high, jumps[which]])


def _horizon(
    light: NDArray[np.float64],
    axes: NDArray[np.float64],
    latitude: NDArray[np.float64],
    longitude: NDArray[np.float64],
) -> NDArray[np.float64]:
    """The horizon, from tangent to bitangent, with the light just above it on its left."""
    rows, columns = light.shape[:2]
    steepest = np.arctan2(axes[1, 1], axes[0, 1])
    reach = np.arccos(np.clip(np.sin(latitude) / max(np.hypot(axes[1, 1], axes[0, 1]), 1e-300), -1, 1))
    aside = np.stack([np.cos(longitude), np.zeros(columns + 1), np.sin(longitude)])
    phase = np.arctan2(axes[1] @ aside, axes[0] @ aside) + np.pi / 2
    quarters = np.pi / 2 * np.arange(5)
    found = [steepest + reach, steepest - reach, phase, phase + np.pi]
    cuts = np.unique(np.concatenate([np.mod(np.concatenate(found), 2 * np.pi), quarters]))
    middle = 0.5 * (cuts[1:] + cuts[:-1])
    toward = np.outer(np.cos(middle), axes[0]) + np.outer(np.sin(middle), axes[1]) + 1e-9 * axes[2]
    down = (np.pi / 2 - np.arcsin(np.clip(toward[:, 1], -1, 1))) / np.pi * rows
    along = (np.arctan2(toward[:, 0], -toward[:, 2]) + np.pi) / (2 * np.pi) * columns
    seen = light[np.minimum(down.astype(np.int64), rows - 1), along.astype(np.int64) % columns]
    lines = np.zeros((len(middle), 11))
    lines[:, 1] = lines[:, 5] = 1.0
    lines[:, 6], lines[:, 7], lines[:, 8:] = cuts[:-1], cuts[1:], seen
    return np.asarray(lines[np.any(seen != 0, axis=1)])
