"""Primitives of ray grids: which cells stay, what merging may do, and what it must keep."""

from dataclasses import dataclass

import numpy as np
import pytest

from aureole import flare, refuse
from aureole.flare import primitives
from aureole.flare.primitives import MERGES, Frame, Merge, construct

FRAME = Frame((480, 640), 1e-5)


@dataclass(frozen=True)
class Grid:
    """A sheet of rays made by hand."""

    x: np.ndarray
    y: np.ndarray
    weight: np.ndarray
    level: np.ndarray
    stop_x: np.ndarray
    stop_y: np.ndarray
    reached: np.ndarray
    cell: float = 1e-8


def grid_of(place, n=65, rim=0.9, weight=None):
    """Rays on [-1, 1]², placed by a map to pixels from the frame's middle; valid within a circle."""
    v, u = np.meshgrid(*[np.linspace(-1.0, 1.0, n)] * 2, indexing="ij")
    x, y = (-FRAME.pitch * np.broadcast_to(part, u.shape) for part in place(u, v))
    light = np.ones_like(u) if weight is None else weight(u, v)
    fields = [x, y, light, np.hypot(u, v) / rim, u, v]
    return Grid(*(field[None].astype(np.float32) for field in fields), np.ones((1, n, n), dtype=bool))


def bent(u, v):
    return 150 * u + 30 * u**3 + 20 * v * v, 100 * v + 15 * v**3 + 10 * u * u


def folded(u, v):
    """A caustic at u = 0.5."""
    return 150 * (u - u * u), 100 * v + 5 * u


def areas(found):
    x, y = found.corners[..., 0].astype(float), found.corners[..., 1].astype(float)
    return 0.5 * np.abs((x[:, 2] - x[:, 0]) * (y[:, 3] - y[:, 1]) - (x[:, 3] - x[:, 1]) * (y[:, 2] - y[:, 0]))


def power(found):
    return float(np.sum(found.area * found.attributes[:, :, 0].mean(axis=1), dtype=float))


def test_cells_with_a_valid_ray_stay():
    grid = grid_of(bent)
    valid = grid.level[0] <= 1
    some = valid[:-1, :-1] | valid[:-1, 1:] | valid[1:, :-1] | valid[1:, 1:]
    found = construct(grid, FRAME, keep="valid")
    assert len(found.area) == some.sum()
    np.testing.assert_allclose(found.area, grid.cell, rtol=1e-6)
    assert np.all(found.size == 1)
    # Columns run against the sensor's x, rows against its y.
    expected = 320 - grid.x[0] / FRAME.pitch, 240 - grid.y[0] / FRAME.pitch
    i, j = np.argwhere(some)[100]
    corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
    np.testing.assert_allclose(
        found.corners[100], [[expected[0][at], expected[1][at]] for at in corners], rtol=0, atol=1e-3
    )
    np.testing.assert_array_equal(found.attributes[100, :, 1], [grid.level[0][at] for at in corners])


@pytest.mark.parametrize("merge", MERGES)
@pytest.mark.parametrize("place", [bent, folded])
def test_merging_keeps_cells_and_power(merge, place):
    grid = grid_of(place, n=82, weight=lambda u, v: 0.3 + 0.1 * u - 0.05 * v * v)
    plain, found = construct(grid, FRAME), construct(grid, FRAME, merge=merge)
    assert found.area.sum(dtype=float) == pytest.approx(plain.area.sum(dtype=float), rel=1e-6)
    assert np.all(np.isin(found.size, [1, 2, 4, 8, 16]))
    np.testing.assert_allclose(found.area, found.size.astype(float) ** 2 * grid.cell, rtol=1e-6)
    rel = 5e-3 if merge.startswith("published") else 1e-5
    assert power(found) == pytest.approx(power(plain), rel=rel)


def test_refusals():
    grid = grid_of(bent, n=9)
    with pytest.raises(refuse.Refusal, match=r"'merge' must be one of .* Did you mean 'light'"):
        construct(grid, FRAME, merge="ligth")
    with pytest.raises(refuse.Refusal, match="'position' must be a finite number > 0, got 0"):
        construct(grid, FRAME, merge=Merge(position=0.0))
    with pytest.raises(refuse.Refusal, match="'steps' must be a number from 0 to 4, got 5"):
        construct(grid, FRAME, merge=Merge(steps=5))
    with pytest.raises(refuse.Refusal, match="'colours' must have a row for each of 1 sheets, got 2"):
        construct(grid, FRAME, colours=[[0], [1]])
    with pytest.raises(refuse.Refusal, match="'keep' must be one of 'crossed', 'valid'"):
        construct(grid, FRAME, keep="all")
    with pytest.raises(refuse.Refusal, match="'shape' must be an integer >= 1, got 0"):
        primitives.frame_of(flare.load("heliar_tronnier_100mm"), (0, 10))
