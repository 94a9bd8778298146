"""A table cut into cells that each reflect as a small mirror-like lobe, for sums over light from all around.

In: a table and a count; out: for each cell its mean h, its spread and its whole energy, exact in sum. Cells
that send much light far apart are cut first, so that sharp orders get small cells and dim parts large ones.
"""

import heapq
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.surface.table import ScatterTable, areas, axes, rgb

FOUR_PI_SQUARED = 4 * np.pi**2
OVERLAP = 2.0  # a blur's variance over that of the cell's light: neighbours overlap without gaps
Block = tuple[int, int, int, int]


def table_cells(
    table: ScatterTable,
    count: int = 512,
    colour_space: str = "rec709",
    window: tuple[float, float] | None = None,
) -> NDArray[np.float32]:
    """Cut a table into cells, those first that send much light far apart.

    Parameters
    ----------
    table : ScatterTable
        Any.
    count : int
        How many cells; fewer where the table has fewer lit samples.
    colour_space : str
        Linear RGB space of the energies; the table's white is neutral.
    window : tuple of float or None
        σ along tangent and bitangent of the Gaussian in h that multiplies the table (surface paper, 6.1).

    Returns
    -------
    ndarray of float32, shape (count, 7)
        Mean h · t and h · b, the variance of the light's blur, the reach to the cell's side, and
        4π² ∫ S_d dh in R, G and B. The energies add up to the table's own.
    """
    wanted = refuse.at_least("count", count, 1)
    masses = _masses(table, colour_space, window)
    brightness = np.abs(masses).sum(axis=2)
    lines = axes(table)
    whole = (0, brightness.shape[0], 0, brightness.shape[1])
    heap: list[tuple[float, Block, tuple[int, int]]] = []
    _push(heap, brightness, lines, whole)
    done: list[Block] = []
    while heap and len(heap) + len(done) < wanted:
        _, block, (axis, place) = heapq.heappop(heap)
        if place == 0:
            done.append(block)
            continue
        for part in _halves(block, axis, place):
            _push(heap, brightness, lines, part)
    blocks = done + [block for _, block, _ in heap]
    sides = areas(table)
    found = [_cell(masses, brightness, lines, sides, block) for block in blocks]
    cells = np.zeros((wanted, 7), dtype=np.float32)
    if found:
        cells[: len(found)] = found
    return cells


def hat_integrals(count: int, half_range: float, warp: int) -> NDArray[np.float64]:
    """Integrate over h the share that each sample of a warped axis has in what lies between samples.

    Parameters
    ----------
    count : int
        Number of samples.
    half_range : float
        h of the outermost ones.
    warp : int
        n of h = half_range · uⁿ.

    Returns
    -------
    ndarray of float64, shape (count,)
        They add up to 2 half_range.
    """
    u = (2 * np.arange(count) - (count - 1)) / (count - 1)
    gap = 2.0 / (count - 1)
    length = half_range * np.diff(u**warp)
    moment = half_range * warp / (warp + 1) * np.diff(u ** (warp + 1))
    right = (moment - u[:-1] * length) / gap
    whole = np.zeros(count)
    whole[1:] += right
    whole[:-1] += length - right
    return whole


def _masses(
    table: ScatterTable, colour_space: str, window: tuple[float, float] | None
) -> NDArray[np.float64]:
    """4π² S_d dh of each sample, exact for a table that is linear in u between samples."""
    rows, columns = table.values.shape[:2]
    down, along = (hat_integrals(size, table.half_range, table.warp) for size in (rows, columns))
    h_b, h_t = axes(table)
    if window is not None:
        along = along * np.exp(-0.5 * (h_t / refuse.positive("window", window[0])) ** 2)
        down = down * np.exp(-0.5 * (h_b / refuse.positive("window", window[1])) ** 2)
    weights = FOUR_PI_SQUARED * down[:, None, None] * along[None, :, None]
    return np.asarray(rgb(table, colour_space) * weights, dtype=np.float64)


def _push(
    heap: list[tuple[float, Block, tuple[int, int]]],
    brightness: NDArray[np.float64],
    lines: Sequence[NDArray[np.float64]],
    block: Block,
) -> None:
    """Put a block on the heap, brightest and widest first, with where to cut it: across its longer side."""
    inside = brightness[block[0] : block[1], block[2] : block[3]]
    best, cut, energy = 0.0, (0, 0), 0.0
    for axis in (0, 1):
        weight = inside.sum(axis=1 - axis)
        energy = float(weight.sum())
        if energy <= 0.0:
            return
        h = lines[axis][block[2 * axis] : block[2 * axis + 1]]
        mean = float(weight @ h) / energy
        variance = float(weight @ (h - mean) ** 2) / energy
        if len(h) > 1 and variance >= best:
            # Samples on one side of the mean; b falls along rows, t rises along columns.
            before = int(np.count_nonzero(h > mean if axis == 0 else h < mean))
            best, cut = variance, (axis, block[2 * axis] + min(max(before, 1), len(h) - 1))
    heapq.heappush(heap, (-energy * np.sqrt(best), block, cut))


def _halves(block: Block, axis: int, place: int) -> tuple[Block, Block]:
    top, bottom, left, right = block
    if axis == 0:
        return (top, place, left, right), (place, bottom, left, right)
    return (top, bottom, left, place), (top, bottom, place, right)


def _cell(
    masses: NDArray[np.float64],
    brightness: NDArray[np.float64],
    lines: Sequence[NDArray[np.float64]],
    sides: Sequence[NDArray[np.float64]],
    block: Block,
) -> list[float]:
    """Mean, spread and energy of a block."""
    top, bottom, left, right = block
    inside = brightness[top:bottom, left:right]
    means, variances = [], []
    for axis in (1, 0):
        weight = inside.sum(axis=1 - axis)
        weight = weight / weight.sum()
        span = slice(block[2 * axis], block[2 * axis + 1])
        h = lines[axis][span]
        mean = float(weight @ h)
        # A sample stands for a tent over its neighbours' distance, whose variance is a sixth of its square.
        variances.append(float(weight @ ((h - mean) ** 2 + sides[axis][span] ** 2 / 6)))
        means.append(mean)
    spread = 0.5 * (variances[0] + variances[1])
    energy = masses[top:bottom, left:right].sum(axis=(0, 1))
    return [*means, OVERLAP * spread, float(np.sqrt(3 * spread)), *energy]
