"""The progressive far field equals a fresh one, after any sequence of changes and after very many."""

import numpy as np
import pytest

from aureole import Aperture, Grid, aperture
from aureole.diffraction import ProgressiveFarField, far_field, paint

WIDTH = 1e-3
CLOSE = 2e-6  # of the peak, after a few updates
DRIFT = 1e-4  # of the peak, after any number

GRIDS = [
    Grid((20, 20), (900.0, 900.0)),
    Grid((21, 20), (900.0, 1100.0)),
    Grid((20, 21), (900.0, 1100.0)),
    Grid((21, 21), (300.0, 300.0)),
    Grid((1, 1), (300.0, 300.0)),
    Grid((400, 372), (100.0, 110.0)),
    Grid((16, 17), (900.0, 1100.0), (300.0, -2000.0)),
    Grid((15, 200), (900.0, 1100.0), (0.0, 4.0)),
]


def error(progressive, opening, grid):
    """Return the largest errors of the field and of the power, of their peaks."""
    truth = far_field(opening, grid, "reference").amplitude
    field = progressive.update(opening)
    assert field.grid == grid
    peak = opening.mask.sum(dtype=np.float64) * (WIDTH / len(opening.mask)) ** 2
    power = np.abs(progressive.power() - np.abs(truth) ** 2).max() / peak**2
    return max(np.abs(field.amplitude - truth).max() / peak, power)


def next_mask(mask, rng):
    """Set a random rectangle, flat or noisy."""
    out = mask.copy()
    (top, bottom), (left, right) = np.sort(rng.integers(0, len(mask), (2, 2)))
    box = out[top : bottom + 1, left : right + 1]
    box[...] = rng.random(box.shape) if rng.random() < 0.5 else rng.integers(0, 2)
    return out


@pytest.mark.parametrize("size", [1, 2, 31, 32])
@pytest.mark.parametrize("grid", GRIDS)
def test_equals_a_fresh_transform_after_random_changes(grid, size):
    rng = np.random.default_rng(size)
    mask = rng.random((size, size)).astype(np.float32)
    progressive = ProgressiveFarField(grid)
    for _ in range(8):
        assert error(progressive, Aperture(WIDTH, mask=mask), grid) < CLOSE
        mask = next_mask(mask, rng)
        mask[0, 0] = 1


@pytest.mark.parametrize("step", [(5, 0), (0, 5), (4, 3)])
def test_equals_a_fresh_transform_under_a_moving_shadow(step):
    grid, size = Grid((64, 64), (1 / WIDTH, 1 / WIDTH)), 96
    opening = aperture.rasterize(aperture.iris(7, WIDTH), size)
    progressive = ProgressiveFarField(grid)
    y, x = np.mgrid[:size, :size] + 0.5
    for frame in range(-12, 13):
        shadow = np.hypot(x - 48 - frame * step[0], y - 48 - frame * step[1]) < 15
        assert error(progressive, Aperture(WIDTH, mask=np.where(shadow, 0, opening)), grid) < CLOSE


@pytest.mark.parametrize("centre", [(0.0, 0.0), (1500.0, 0.0)])
def test_ten_thousand_updates_do_not_drift(centre):
    """Three masks in turn repeat the same rounding, the worst case; each is the others' opposite in part."""
    grid, rng = Grid((12, 13), (1 / WIDTH, 1 / WIDTH), centre), np.random.default_rng(5)
    cycle = [Aperture(WIDTH, mask=rng.random((16, 16)).astype(np.float32)) for _ in range(3)]
    progressive = ProgressiveFarField(grid)
    refreshes = 0
    for count in range(10_000):
        progressive.update(cycle[count % 3])
        refreshes += progressive.refreshed
        if count % 1000 < 3:
            assert error(progressive, cycle[count % 3], grid) < DRIFT
    assert error(progressive, cycle[9_999 % 3], grid) < DRIFT
    assert 5 < refreshes < 500


def test_a_dark_mask_leaves_nothing_behind():
    grid, rng = Grid((12, 13), (1 / WIDTH, 1 / WIDTH)), np.random.default_rng(5)
    progressive = ProgressiveFarField(grid)
    for _ in range(3):
        progressive.update(Aperture(WIDTH, mask=rng.random((16, 16)).astype(np.float32)))
    field = progressive.update(Aperture(WIDTH, mask=np.zeros((16, 16), dtype=np.float32)))
    assert progressive.refreshed
    np.testing.assert_array_equal(field.amplitude, 0)
    np.testing.assert_array_equal(progressive.power(), 0)


def test_the_quads_of_an_update_paint_the_difference():
    rng = np.random.default_rng(8)
    old, new = (rng.random((2, 24, 24)) < 0.5).astype(np.float32)
    progressive = ProgressiveFarField(GRIDS[0])
    progressive.update(Aperture(WIDTH, mask=old))
    progressive.update(Aperture(WIDTH, mask=new))
    positive, negative = progressive.quads()
    np.testing.assert_array_equal(paint(positive, 24, WIDTH), np.maximum(new - old, 0))
    np.testing.assert_array_equal(paint(negative, 24, WIDTH), np.maximum(old - new, 0))
    assert progressive.evaluated == (len(positive), len(negative))
