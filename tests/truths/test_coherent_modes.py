"""Few fields for many: the same power and the same energy, and an error that is known before."""

import numpy as np
import pytest
from scipy import fft

from aureole.glare.coherent_modes import SUMS, coherent_modes

SIZE, COUNT = 64, 40
WEIGHTS = np.linspace(1, 2, COUNT) / 60


def power(mask):
    return np.abs(fft.fft2(mask.astype(np.float64))) ** 2


def moved_edges(step: float = 0.3):
    """Return masks whose right edge moves, and slants more and more."""
    x, y = np.arange(SIZE), np.arange(SIZE)[:, None]
    return [
        np.clip(40 + step * s + 0.02 * s * (y - 32) - x, 0, 1).astype(np.float32) * (np.abs(y - 31.5) < 24)
        for s in range(COUNT)
    ]


MASKS = moved_edges()
TRUTH = sum(weight * power(mask) for weight, mask in zip(WEIGHTS, MASKS, strict=True))


@pytest.mark.parametrize("tolerance", [1e-4, 1e-3, 1e-2, 1e-1])
def test_the_error_is_no_more_than_was_said(tolerance):
    found = coherent_modes(MASKS, WEIGHTS, tolerance)
    total = sum(power(pattern) for pattern in found.patterns)
    assert 0 < found.estimated <= tolerance
    assert len(found.patterns) < COUNT
    # Float32 is as near as one in a million.
    assert np.abs(total - TRUTH).sum() / TRUTH.sum() <= found.estimated + 1e-6
    assert np.abs(total - TRUTH).max() / TRUTH.max() <= found.estimated + 1e-6


@pytest.mark.parametrize("tolerance", [1e-3, 0.5])
def test_no_light_is_lost(tolerance):
    found = coherent_modes(MASKS, WEIGHTS, tolerance)
    total = (found.patterns.astype(np.float64) ** 2).sum()
    assert total == pytest.approx(TRUTH.sum() / SIZE**2, rel=1e-5)


def test_without_tolerance_all_modes_are_taken():
    # Ten masks twice each: ten distinct ones, and a mean.
    masks = MASKS[::4] * 2
    found = coherent_modes(masks, np.full(len(masks), 0.05), 0.0)
    expected = 0.1 * sum(power(mask) for mask in MASKS[::4])
    total = sum(power(pattern) for pattern in found.patterns)
    np.testing.assert_allclose(total, expected, atol=1e-6 * expected.max())


def test_two_masks_are_their_mean_and_half_their_difference():
    first, second = MASKS[0], MASKS[-1]
    found = coherent_modes([first, second] * 4, np.full(8, 1 / 8), 1e-6)
    assert len(found.patterns) == 2
    np.testing.assert_allclose(found.patterns[0], (first + second) / 2, atol=1e-6)
    np.testing.assert_allclose(np.abs(found.patterns[1]), np.abs(first - second) / 2, atol=1e-6)


def test_few_masks_stay_as_they_are():
    found = coherent_modes(MASKS[:3], np.array([1.0, 4.0, 9.0]), 0.1)
    assert found.estimated == 0
    np.testing.assert_allclose(found.patterns, [MASKS[0], 2 * MASKS[1], 3 * MASKS[2]], rtol=1e-6)


def test_equal_masks_are_one():
    found = coherent_modes([MASKS[0]] * 9, np.full(9, 1 / 9), 1e-3)
    assert len(found.patterns) == 1
    np.testing.assert_allclose(found.patterns[0], MASKS[0], atol=1e-6)


def test_random_sums_have_the_right_power_in_the_mean():
    strong = coherent_modes(MASKS, WEIGHTS, 0.02).patterns[:-SUMS]
    weak = TRUTH - sum(power(pattern) for pattern in strong)

    def far(count: int) -> float:
        guesses = [coherent_modes(MASKS, WEIGHTS, 0.02, seed).patterns[-SUMS:] for seed in range(count)]
        mean = sum(power(pattern) for guess in guesses for pattern in guess) / count
        return float(np.abs(mean - weak).sum() / weak.sum())

    assert far(1) < 1
    # Of 25 times as many, a fifth of the error and somewhat more.
    assert far(25) < 0.3 * far(1)


def test_the_same_seed_gives_the_same_patterns():
    first, again = (coherent_modes(MASKS, WEIGHTS, 0.02, seed=3) for _ in range(2))
    np.testing.assert_array_equal(first.patterns, again.patterns)
