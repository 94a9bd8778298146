"""Spectral sums along rays from the origin: "rays".

All scaled samples of a pixel lie on one ray through the origin (quad paper, section 4.3). On lines of
slope m = x / y, |m| ≤ 1, a scale changes y and leaves m, so that Eq. 15 becomes one matrix product for all
rays of a fan,

    S_c(y, m) = Σ_i M_c(y, i) P_r(i, m i),    M_c(y, i) = Σ_λ w_c(λ) ρ² h(ρ y − i),

with h the interpolation between rows i. The columns make the other fan, and opposite fans are alike where
P(−q) = P(q). Going onto the rays and leaving them takes interpolation along one axis only. S_c is smooth
along a ray, because a wide spectrum washes out fringes, so that few places y will do: they stand evenly
in u, y = (h / g) sinh(g u), h apart at the origin and a share g of y apart far out.

The number of wavelengths costs next to nothing, and is so large that neighbours lie within a sample.
"""

import math
import os
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

from aureole import refuse
from aureole.light.observer import quadrature
from aureole.light.scaling import Task, index_positions, pixels_summed
from aureole.records import Pattern

NEAR_STEP = 0.5  # between nodes at the origin, in samples of the pattern
# Far nodes are a share of the radius apart: so much over the fringes that the spectrum lets through.
FAR_STEP = 0.5
MOST_FAR_STEP = 0.06
MOST_FRINGES = 100.0
CUBIC_REACH = 48.0
DENSITY = 1.5  # rays in a sample at the output's far end
LEAST_RAYS = 32
CHUNK = 512  # rays that one product takes, so that their samples stay in cache
BLOCK = 8  # nodes that one product takes


def rays(task: Task) -> NDArray[np.float32]:
    """Add all wavelengths along rays by matrix products.

    Parameters
    ----------
    task : Task
        What to sum, with at least the number of samples given.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        The sum in XYZ.

    Raises
    ------
    refuse.Refusal
        Where the source is a callable or not centred on zero, or the light has lines.
    """
    reason = refusal(task)
    if reason:
        raise refuse.Refusal(reason)
    return _Rays(task, task.pattern("rays")).summed()


def refusal(task: Task) -> str | None:
    """Say why a task cannot be summed along rays.

    Parameters
    ----------
    task : Task
        What to sum.

    Returns
    -------
    str or None
        The reason and the method that can; None where it can.
    """
    pattern = task.pattern("rays")
    if task.spectrum.kind == "lines":
        return "'method' 'rays' needs a spectrum of kind 'power'; use 'full' for lines."
    if pattern.grid.centre != (0.0, 0.0):
        return f"'method' 'rays' needs a pattern centred on zero, got {pattern.grid.centre}; use 'full'."
    return None


def counts(task: Task) -> tuple[int, int]:
    """Estimate how many crossings of rays and lines a sum takes, and count its pixels.

    Parameters
    ----------
    task : Task
        What to sum.

    Returns
    -------
    crossings, pixels : int
        What the cost grows with.
    """
    pattern = task.pattern("rays")
    y, x = task.grid.axes()
    extents = [np.abs(axis).max() / step for axis, step in zip((y, x), pattern.grid.spacing, strict=True)]
    lines = [count // 2 + 1 for count in pattern.grid.shape]
    rays = 2 * DENSITY * max(*extents, LEAST_RAYS)
    return int((1 if task.symmetric else 2) * sum(lines) * min(rays, 4 * max(lines))), pixels_summed(task)


class _Rays:
    """The geometry of one sum along rays, in samples of the pattern."""

    def __init__(self, task: Task, pattern: Pattern) -> None:
        from aureole.light import _kernels_rays  # compiled code: loaded when first used

        self._kernels, self._task, self._pattern = _kernels_rays, task, pattern
        y, x = index_positions(pattern.grid, *task.grid.axes())
        self._y, self._x = y - pattern.grid.shape[0] // 2, x - pattern.grid.shape[1] // 2
        reach = max(np.abs(self._y).max(), np.abs(self._x).max(), 1.0)
        count = max(task.samples, math.ceil(min(reach, max(pattern.grid.shape))))
        wavelengths, self._weights = quadrature(task.spectrum, count)
        self._ratios = task.wavelength / wavelengths
        # Beyond the pattern's corner at the smallest scale nothing is left.
        seen = min(reach, (max(pattern.grid.shape) / 2 + 3) / self._ratios.min())
        self._far = far_step(self._ratios, self._weights)
        self._nodes = NEAR_STEP / self._far * np.sinh(self._far * np.arange(self._node(seen) + 3))
        half = max(math.ceil(DENSITY * seen), LEAST_RAYS)
        # The last ray stands there twice: a pixel on it has a neighbour.
        self._slopes = np.append(np.arange(-half, half + 1) / half, 1.0).astype(np.float32)

    def summed(self) -> NDArray[np.float32]:
        """Sum both pairs of fans, and fill the plane from them."""
        task, shape = self._task, self._task.grid.shape
        pixels = np.empty((*shape, 3), dtype=np.float32)
        upper = shape[0] // 2 + 1 if task.symmetric else shape[0]
        by_rows, by_columns = self._fans()
        part, y, x = pixels[:upper], self._y[:upper], self._x
        self._leave(by_rows, y, x, False, part)
        self._leave(by_columns, x, y, True, part)
        if task.symmetric:
            self._lower(by_rows, by_columns, pixels)
        return pixels

    def _lower(
        self, by_rows: NDArray[np.float32], by_columns: NDArray[np.float32], pixels: NDArray[np.float32]
    ) -> None:
        """Turn the upper half by 180°; at even sizes the first column has no partner to turn."""
        from aureole.light import _kernels

        centre, columns = pixels.shape[0] // 2, pixels.shape[1]
        _kernels.turn(pixels, centre)
        if columns % 2 == 0:
            edge, y, x = pixels[centre + 1 :, :1].copy(), self._y[centre + 1 :], self._x[:1]
            self._leave(by_rows, y, x, False, edge)
            self._leave(by_columns, x, y, True, edge)
            pixels[centre + 1 :, :1] = edge

    def _node(self, radius: float) -> int:
        return math.ceil(math.asinh(radius * self._far / NEAR_STEP) / self._far)

    def _fans(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Sum along the rays of the fans by rows and by columns: (1 or 2, N, 3, K) each."""
        turns = 1 if self._task.symmetric else 2
        shape = (turns, self._nodes.size, 3, self._slopes.size)
        fans = (np.zeros(shape, dtype=np.float32), np.zeros(shape, dtype=np.float32))
        blocks = self._weight_blocks()
        rays = range(0, self._slopes.size, CHUNK)
        jobs = []
        for turn in range(turns):
            # The upper half comes first, for at even sizes it has one sample more.
            steps = -1 if turn == 0 else 1
            image = self._pattern.intensity[::steps, ::steps].astype(np.float32, copy=False)
            for by_columns, fan in enumerate(fans):
                framed, origin = self._framed(image, bool(by_columns), turn)
                half = fan[turns - 1 - turn]
                jobs += [(framed, origin, slice(ray, ray + CHUNK), blocks, half) for ray in rays]
        # One BLAS thread in each of ours: its own threads wait for each other at every step.
        with _blas().limit(limits=1):
            list(_pool().map(lambda job: self._sum(*job), jobs))
        return fans

    def _framed(
        self, image: NDArray[np.float32], by_columns: bool, turn: int
    ) -> tuple[NDArray[np.float32], int]:
        """Copy the lines from the origin on into a frame; return them and the framed index of the axis."""
        frame = self._kernels.FRAME
        lines, length = image.shape[::-1] if by_columns else image.shape
        from_origin = lines - lines // 2 if turn else lines // 2 + 1
        framed = np.empty((from_origin, length + 2 * frame), dtype=np.float32)
        self._kernels.frame_lines(image, by_columns, framed)
        return framed, frame + (length // 2 if turn else length - 1 - length // 2)

    def _sum(
        self,
        framed: NDArray[np.float32],
        origin: int,
        rays: slice,
        blocks: list[tuple[slice, int, NDArray[np.float32]]],
        fan: NDArray[np.float32],
    ) -> None:
        """Sum along some rays of one fan."""
        slopes = self._slopes[rays]
        samples = np.empty((len(framed), slopes.size), dtype=np.float32)
        self._kernels.cross_lines(framed, origin, slopes, self._task.taps, samples)
        flat = fan.reshape(-1, fan.shape[2])
        for nodes, first, table in blocks:
            part = samples[first : first + table.shape[1]]
            if len(part):
                np.matmul(table[:, : len(part)], part, out=flat[3 * nodes.start : 3 * nodes.stop, rays])

    def _weight_blocks(self) -> list[tuple[slice, int, NDArray[np.float32]]]:
        """Return M for some nodes each: which, the first line that they look at, and (3 nodes, lines)."""
        weights = self._weights * self._ratios[:, None] ** 2
        low, high = self._ratios.min(), self._ratios.max()
        last = max(self._pattern.grid.shape)
        blocks = []
        for start in range(0, self._nodes.size, BLOCK):
            part = slice(start, min(start + BLOCK, self._nodes.size))
            nodes = self._nodes[part]
            first = min(max(int(low * nodes[0]) - 1, 0), last)
            stop = min(int(high * nodes[-1]) + 3, last)
            table = np.zeros((nodes.size, 3, max(stop - first, 0)))
            taps = self._task.taps if nodes[-1] < CUBIC_REACH else 2
            self._kernels.weigh_lines(nodes, self._ratios, weights, taps, first, table)
            blocks.append((part, first, table.reshape(3 * nodes.size, -1).astype(np.float32)))
        return blocks

    def _leave(
        self,
        fans: NDArray[np.float32],
        lines: NDArray[np.floating],
        across: NDArray[np.floating],
        by_columns: bool,
        out: NDArray[np.float32],
    ) -> None:
        nodes, shares = self._between_nodes(np.abs(lines))
        lines, across = lines.astype(np.float32), across.astype(np.float32)
        sides: tuple[Literal["left", "right"], ...] = ("right", "left") if by_columns else ("left", "right")
        starts = np.searchsorted(across, -np.abs(lines), sides[0])
        stops = np.searchsorted(across, np.abs(lines), sides[1])
        symmetric = self._task.symmetric
        self._kernels.leave_rays(
            fans, nodes, shares, lines, across, starts, stops, symmetric, by_columns, out
        )

    def _between_nodes(self, radii: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
        """Return the four nodes about each radius and their weights: Catmull-Rom in u."""
        last = self._nodes.size - 3
        u = np.minimum(np.arcsinh(radii * self._far / NEAR_STEP) / self._far, last)
        index = np.floor(u).astype(np.int64)
        t = u - index
        shares = np.stack(
            [
                0.5 * t * (t * (2.0 - t) - 1.0),
                0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
                0.5 * t * (t * (4.0 - 3.0 * t) + 1.0),
                0.5 * t * t * (t - 1.0),
            ],
            axis=1,
        )
        # The node before the origin is the mirror image of the first one after it.
        return np.abs(index[:, None] + np.arange(-1, 3)), shares.astype(np.float32)


def far_step(ratios: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    """Choose how far apart nodes stand along a ray, as a share of the radius.

    A fringe of s cycles at λ_r passes a spectrum with the contrast |Γ(s)|, Γ(s) = Σ w ρ² exp(−i2πρs).
    Nodes must follow the largest s |Γ(s)|^(1/3).

    Parameters
    ----------
    ratios : ndarray, shape (W,)
        λ_r / λ of the wavelengths.
    weights : ndarray, shape (W, 3)
        Their weights.

    Returns
    -------
    float
        The share.
    """
    bins, length = 4096, 16384
    width = float(ratios.max()) / (bins - 1)
    places = np.rint(ratios / width).astype(np.int64)
    fringes = np.arange(1, min(int(MOST_FRINGES * length * width), length // 2))
    finest = 0.0
    for part in weights.T:
        density = np.bincount(places, part * ratios**2, bins)
        if density.any():
            contrast = np.abs(np.fft.rfft(density, length)[fringes]) / density.sum()
            finest = max(finest, float((fringes * np.cbrt(contrast)).max()) / (length * width))
    return min(FAR_STEP / finest, MOST_FAR_STEP) if finest > 0 else MOST_FAR_STEP


@lru_cache(maxsize=1)
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(os.cpu_count() or 1, thread_name_prefix="rays")


@lru_cache(maxsize=1)
def _blas() -> ThreadpoolController:
    return ThreadpoolController().select(user_api="blas")
