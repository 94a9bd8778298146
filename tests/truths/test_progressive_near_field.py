"""The progressive near field equals a fresh one, after any sequence of changes and after very many."""

import numpy as np
import pytest

from aureole import Aperture, Grid, aperture
from aureole.diffraction import ProgressiveNearField, near_field

WIDTH = 2e-3
WAVELENGTH = 550e-9
CLOSE = 5e-6  # of the unblocked wave, after a few updates
DRIFT = 1e-4  # of the unblocked wave, after any number

GRIDS = [
    Grid((20, 20), (1e-4, 1e-4)),
    Grid((21, 20), (1e-4, 1.3e-4)),
    Grid((1, 1), (1e-4, 1e-4)),
    Grid((150, 131), (1.6e-5, 1.7e-5)),
    Grid((16, 17), (1e-4, 1.1e-4), (0.3e-3, -2e-3)),
    Grid((15, 100), (1e-4, 2e-5), (0.0, 0.4e-3)),
]


def error(progressive, opening, grid, number):
    """Return the largest errors of the field and of the power, of the unblocked wave's."""
    distance = (WIDTH / 2) ** 2 / (WAVELENGTH * number)
    truth = near_field(opening, grid, distance, WAVELENGTH, "reference").amplitude
    field = progressive.update(opening)
    assert field.grid == grid
    power = np.abs(progressive.power() - np.abs(truth) ** 2).max()
    return max(np.abs(field.amplitude - truth).max(), power)


def begun(grid, number):
    return ProgressiveNearField(grid, (WIDTH / 2) ** 2 / (WAVELENGTH * number), WAVELENGTH)


def next_mask(mask, rng):
    """Set a random rectangle, flat or noisy."""
    out = mask.copy()
    (top, bottom), (left, right) = np.sort(rng.integers(0, len(mask), (2, 2)))
    box = out[top : bottom + 1, left : right + 1]
    box[...] = rng.random(box.shape) if rng.random() < 0.5 else rng.integers(0, 2)
    return out


@pytest.mark.parametrize("size", [1, 2, 31, 32])
@pytest.mark.parametrize("grid", GRIDS)
def test_equals_a_fresh_field_after_random_changes(grid, size):
    rng = np.random.default_rng(size)
    for number in (0.3, 40.0):
        mask = rng.random((size, size)).astype(np.float32)
        progressive = begun(grid, number)
        for _ in range(8):
            assert error(progressive, Aperture(WIDTH, mask=mask), grid, number) < CLOSE
            mask = next_mask(mask, rng)


def test_equals_a_fresh_field_after_a_hundred_updates_of_a_moving_shadow():
    grid, size, number = Grid((48, 49), (5e-5, 5e-5)), 96, 20.0
    opening = aperture.rasterize(aperture.iris(7, WIDTH), size)
    progressive = begun(grid, number)
    y, x = np.mgrid[:size, :size] + 0.5
    refreshes = 0
    for frame in range(100):
        angle = 0.31 * frame
        shadow = np.hypot(x - 48 - 30 * np.cos(angle), y - 48 - 20 * np.sin(angle)) < 12
        found = error(progressive, Aperture(WIDTH, mask=np.where(shadow, 0, opening)), grid, number)
        refreshes += progressive.refreshed
        assert found < 3e-5 + CLOSE
    assert 1 <= refreshes <= 4


@pytest.mark.parametrize("centre", [(0.0, 0.0), (1.5e-3, 0.0)])
def test_hundreds_of_updates_do_not_drift(centre):
    """Three masks in turn repeat the same rounding, the worst case; each is the others' opposite in part."""
    grid, rng = Grid((12, 13), (1e-4, 1e-4), centre), np.random.default_rng(5)
    cycle = [Aperture(WIDTH, mask=rng.random((16, 16)).astype(np.float32)) for _ in range(3)]
    progressive = begun(grid, 3.0)
    refreshes = 0
    for count in range(500):
        progressive.update(cycle[count % 3])
        refreshes += progressive.refreshed
    assert error(progressive, cycle[500 % 3], grid, 3.0) < DRIFT
    assert 3 < refreshes < 50


def test_far_away_rounding_is_measured_by_the_faint_field():
    grid, rng = Grid((12, 13), (0.1, 0.1)), np.random.default_rng(5)
    progressive = begun(grid, 1e-6)
    refreshes = 0
    for _ in range(70):
        mask = (rng.random((16, 16)) < 0.5).astype(np.float32)
        found = error(progressive, Aperture(WIDTH, mask=mask), grid, 1e-6)
        refreshes += progressive.refreshed
        assert found < 1e-4 * 4e-6
    assert refreshes >= 1


def test_a_dark_mask_leaves_nothing_behind():
    grid, rng = GRIDS[0], np.random.default_rng(5)
    progressive = begun(grid, 5.0)
    for _ in range(3):
        progressive.update(Aperture(WIDTH, mask=rng.random((16, 16)).astype(np.float32)))
    field = progressive.update(Aperture(WIDTH, mask=np.zeros((16, 16), dtype=np.float32)))
    assert progressive.refreshed
    np.testing.assert_array_equal(field.amplitude, 0)
    np.testing.assert_array_equal(progressive.power(), 0)
