"""The power of a mask's far field where it may exceed a level, zero elsewhere (quad paper §4.3).

Scandolo, Lee, Eisemann, "Quad-based Fourier transform for efficient diffraction synthesis", 2018,
test the power and its analytic derivatives on every eighth frequency of each axis. Fringes are
shorter than that, which the derivatives mend, but so is the width of a streak: one that runs nearly
along an axis slips between the samples. Here the frequencies that are tested lie on the edges of the
tiles instead. What crosses a tile crosses its edges. Along them the pattern is sampled as finely as
it varies; across them the analytic derivative stands for the fringes: |F|² + |∂F|²/κ², where κ is the
fringe rate of the rim.

All is computed on the quarter plane of `rows`, by the same real products of small rank.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.diffraction import _kernels_culling
from aureole.diffraction.rows import Factor, edge_tables, factor, in_threads, rows_power, sides
from aureole.records import Aperture, Grid

# Frequencies a side of a tile, about.
TILE = 64
# What is tested lies below the brightest frequency of a tile by up to 3 (measured over 12 shapes, at
# 8 to 1 frequencies a fringe): tiles count as lit from this share of the level on.
CAUTION = 0.25
# Samples a fringe of the whole aperture, along the tiles' edges; a grid that has less is not culled.
FINE, COARSEST = 0.5, 1.001
# Tiles side by side that are evaluated in one product, and frequencies of an edge.
LONGEST_RUN, BAND = 8, 512
TURN = 2 * np.pi

Sides = dict[int, tuple[NDArray[np.float32], NDArray[np.float32]]]


@dataclass(frozen=True, eq=False)
class Survey:
    """What a test at the tiles' edges found, ready to be evaluated.

    Parameters
    ----------
    parts : dict of int to tuple
        The two thin matrices (R, P) and (R, Q) of each part of the mask that is not empty.
    edges : tuple of ndarray of int64
        Where the tiles begin along y and x, and where the last ends.
    lit : ndarray of bool, shape (N, K)
        Which tiles may hold a frequency above the level.
    """

    parts: Sides
    edges: tuple[NDArray[np.int64], NDArray[np.int64]]
    lit: NDArray[np.bool_]

    def share(self) -> float:
        """Return the share of the frequencies that are to be evaluated, 0 to 1."""
        high, wide = (np.diff(each) for each in self.edges)
        return float(high @ self.lit @ wide / (high.sum() * wide.sum()))


def culled_power(
    aperture: Aperture, grid: Grid, level: float, factors: list[Factor] | None = None
) -> NDArray[np.float32]:
    """Return the power of a raster's far field in the tiles that may exceed a level, zero elsewhere.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre, any spacing, any centre. Where neighbours are further apart
        than a fringe of the aperture, nothing is left out.
    level : float
        Of the power at frequency zero, between 0 and 1.
    factors : list of Factor, optional
        What `rows.factor` found in the aperture's mask.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Metres to the fourth.

    Raises
    ------
    refuse.Refusal
        Where the level is not between 0 and 1, or the aperture has outlines.
    """
    check_level(level)
    found = survey(aperture, grid, level, factors)
    return rows_power(aperture, grid, factors) if found is None else evaluate(found, aperture, grid)


def check_level(level: float) -> float:
    """Refuse a level that is not between 0 and 1.

    Parameters
    ----------
    level : float
        Of the power at frequency zero.

    Returns
    -------
    float
        The level.

    Raises
    ------
    refuse.Refusal
        Where it is not above 0 and below 1.
    """
    if refuse.finite("cull", level) <= 0 or level >= 1:
        raise refuse.Refusal(f"'cull' must be a level above 0 and below 1 of the peak, got {level:g}.")
    return float(level)


def survey(
    aperture: Aperture, grid: Grid, level: float, factors: list[Factor] | None = None
) -> Survey | None:
    """Find the tiles of the plane whose power may exceed a level.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre.
    level : float
        Of the power at frequency zero.
    factors : list of Factor, optional
        What `rows.factor` found in the aperture's mask.

    Returns
    -------
    Survey or None
        None where the grid is too coarse to tell, or the mask is dark.
    """
    if aperture.mask is None:
        raise refuse.Refusal("a transform of pixels needs a raster; rasterize the outlines first.")
    size = len(aperture.mask)
    found = factor(aperture.mask) if factors is None else factors
    if not found:
        return None
    peak, middles, reaches = _moments(found, size)
    strides = _strides(reaches, aperture.width, grid)
    if strides is None:
        return None
    edges, counts, tables = _lines_and_tables(size, aperture.width, grid)
    parts, slopes = {}, {}
    for each in found:
        y, x = each.odd
        left, right = sides(each, tables[0][y], tables[1][x])
        parts[2 * y + x] = left[:, : counts[0]], right[:, : counts[1]]
        slopes[2 * y + x] = left[:, counts[0] :], right[:, counts[1] :]
    lit = np.zeros((len(edges[0]) - 1, len(edges[1]) - 1), dtype=np.bool_)
    for axis, (values, derivatives) in enumerate(_on_lines(parts, slopes, edges, strides)):
        # Fringes of what lies about its centroid; its place in the mask is no fringe.
        rate = max(reaches[axis] - abs(middles[axis]), 0.5 / size)
        bright = _kernels_culling.line_brightness(
            values, derivatives, _present(parts, axis), TURN * middles[axis], TURN * rate, 0 in grid.centre
        )
        target = lit.T if axis else lit
        threshold = CAUTION * level * peak**2
        _kernels_culling.mark_tiles(bright, edges[1 - axis], strides[1 - axis], threshold, target)
    return Survey(parts, edges, lit)


def evaluate(found: Survey, aperture: Aperture, grid: Grid) -> NDArray[np.float32]:
    """Evaluate the tiles that a survey found.

    Parameters
    ----------
    found : Survey
        Of the same aperture and grid.
    aperture : Aperture
        A raster.
    grid : Grid
        Frequencies in cycles per metre.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Metres to the fourth; zero in the other tiles.
    """
    out = np.zeros(grid.shape, dtype=np.float32)
    present = _present(found.parts, 0)
    zero = [count // 2 if centre == 0 else -1 for count, centre in zip(grid.shape, grid.centre, strict=True)]
    scale = np.float32(aperture.width**4)

    def write(run: tuple[int, int, int, int]) -> None:
        top, bottom, first, last = run
        products = np.empty((4, bottom - top, last - first), dtype=np.float32)
        for part, (left, right) in found.parts.items():
            np.matmul(left[:, top:bottom].T, right[:, first:last], out=products[part])
        _kernels_culling.write_tile(products, present, scale, (top, first), (zero[0], zero[1]), out)

    in_threads(write, runs(found))
    return out


def runs(found: Survey) -> list[tuple[int, int, int, int]]:
    """Return runs of lit tiles side by side.

    Parameters
    ----------
    found : Survey
        Which tiles are lit.

    Returns
    -------
    list of tuple of int
        Top, bottom, first and last of each, up to `LONGEST_RUN` tiles wide.
    """
    rows, columns = (each.tolist() for each in found.edges)
    listed = []
    for tile, (top, bottom) in enumerate(pairwise(rows)):
        steps = np.flatnonzero(np.diff(found.lit[tile].astype(np.int8), prepend=0, append=0)).tolist()
        for begin, end in zip(steps[0::2], steps[1::2], strict=True):
            listed += [
                (top, bottom, columns[first], columns[min(first + LONGEST_RUN, end)])
                for first in range(begin, end, LONGEST_RUN)
            ]
    return listed


def _moments(factors: list[Factor], size: int) -> tuple[float, list[float], list[float]]:
    """Return a mask's sum, its centroid and how far it reaches from the middle, along y and x, in widths."""
    half = (size + 1) // 2
    weights = np.full(half, 1 / size, dtype=np.float32)
    weights[0] *= 1 - 0.5 * (size % 2)
    outwards = ((np.arange(half) + 0.5 - 0.5 * (size % 2)) / size).astype(np.float32)
    moments, reaches = np.zeros(4), [0.0, 0.0]
    for each in factors:
        axis = 0 if each.by_rows else 1
        across, along = (weights * outwards if each.odd[k] else weights for k in (axis, 1 - axis))
        sums, lengths = _kernels_culling.line_sums(each.lines, along)
        moments[2 * each.odd[0] + each.odd[1]] = across @ np.append(sums, 0)[each.labels]
        if each.odd == (0, 0):
            # Nothing cancels in the even part of a transmittance.
            for place, last in ((axis, np.flatnonzero(each.labels >= 0)[-1]), (1 - axis, lengths.max() - 1)):
                reaches[place] = float(outwards[last]) + 0.5 / size
    return float(moments[0]), [float(moments[part] / moments[0]) for part in (2, 1)], reaches


def _strides(reaches: list[float], width: float, grid: Grid) -> tuple[int, int] | None:
    """Return how many frequencies along y and x a sample of an edge may stand for."""
    steps = [2 * reach * width * spacing for reach, spacing in zip(reaches, grid.spacing, strict=True)]
    if max(steps) > COARSEST:
        return None
    rows, columns = (max(1, min(TILE // 4, int(FINE / step))) for step in steps)
    return rows, columns


def _lines_and_tables(
    size: int, width: float, grid: Grid
) -> tuple[
    tuple[NDArray[np.int64], NDArray[np.int64]],
    tuple[int, int],
    tuple[NDArray[np.float32], NDArray[np.float32]],
]:
    """Return the tiles' edges, the numbers of frequencies and the tables along y and x."""
    (rows, table_y), (columns, table_x) = (
        _tables_with_slopes(size, count, float(spacing * width), float(centre * width))
        for count, spacing, centre in zip(grid.shape, grid.spacing, grid.centre, strict=True)
    )
    counts = (table_y.shape[2] - len(rows), table_x.shape[2] - len(columns))
    return (rows, columns), counts, (table_y, table_x)


@lru_cache(maxsize=2)
def _tables_with_slopes(
    size: int, count: int, spacing: float, centre: float
) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Return the tiles' edges, and `edge_tables` with their derivatives at these frequencies behind.

    With C = ∫ cos(2πux) dx and S = ∫ sin(2πux) dx from 0 to e: cos(2πue) = 1 − 2πuS, sin(2πue) = 2πuC,
    so C' = (e cos(2πue) − C) / u and S' = (e sin(2πue) − S) / u need no more trigonometry.
    """
    tables = edge_tables(size, count, spacing, centre)
    frequencies = tables.shape[2]
    tiles = max(1, round((frequencies - 1) / TILE))
    edges = np.rint(np.linspace(0, frequencies, tiles + 1)).astype(np.int64)
    lines = np.minimum(edges, frequencies - 1)
    u = (centre + (lines if centre == 0 else lines - count // 2) * spacing).astype(np.float32)
    e = ((np.arange(1, (size + 1) // 2 + 1) - 0.5 * (size % 2)) / size).astype(np.float32)[:, None]
    cosine, sine = tables[:, :, lines]
    turn = np.float32(2 * np.pi)
    apart = np.where(u == 0, np.float32(np.inf), u)
    slope_cosine = (e - cosine) / apart - turn * e * sine
    slope_sine = turn * e * cosine - np.where(u == 0, np.float32(np.pi) * e**2, sine / apart)
    slopes = np.stack([slope_cosine, slope_sine])
    joined = np.concatenate([tables, slopes], axis=2)
    joined.setflags(write=False)
    return edges, joined


def _on_lines(
    parts: Sides, slopes: Sides, edges: tuple[NDArray[np.int64], NDArray[np.int64]], strides: tuple[int, int]
) -> list[NDArray[np.float32]]:
    """Transform every part on the lines across y and across x, and its derivatives across them.

    Shape (2, 4, N, M) each: values and derivatives, parts, lines, samples along the lines.
    """
    outs, products = [], []
    for axis in (0, 1):
        stride = strides[1 - axis]
        out = np.zeros((0,), dtype=np.float32)
        for part, each in parts.items():
            lines = np.minimum(edges[axis], each[axis].shape[1] - 1)
            along = each[1 - axis] if stride == 1 else np.ascontiguousarray(each[1 - axis][:, ::stride])
            if not len(out):
                out = np.empty((4, 2, len(lines), along.shape[1]), dtype=np.float32)
            across = np.concatenate([each[axis][:, lines], slopes[part][axis]], axis=1).T
            target = out[_parity(part, axis)].reshape(-1, along.shape[1])
            for low in range(0, along.shape[1], BAND):
                band = slice(low, low + BAND)
                products.append((across, along[:, band], target[:, band]))
        outs.append(out.swapaxes(0, 1))
    in_threads(lambda each: np.matmul(each[0], each[1], out=each[2]), products)
    return outs


def _parity(part: int, axis: int) -> int:
    """Return a part's number where the parity along `axis` comes first."""
    return part if axis == 0 else (part >> 1) | (part & 1) << 1


def _present(parts: Sides, axis: int) -> NDArray[np.bool_]:
    return np.array([_parity(part, axis) in parts for part in range(4)])
