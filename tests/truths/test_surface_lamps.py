"""A lamp of two diodes shows two patterns, each about its own mirror image (surface paper, Fig. 22)."""

import numpy as np
import pytest

from aureole import light, refuse, surface
from aureole.records import Picture
from aureole.surface.table import axis, energy, lookup

STEP = 0.02


def lobes(size=401, width=0.1):
    h = axis(size)
    values = sum(
        weight * np.exp(-((h[:, None]) ** 2 + (h[None, :] - x) ** 2) / (2 * width**2))
        for x, weight in ((-0.7, 0.4), (0.0, 1.0), (0.7, 0.6))
    )
    return surface.scatter_table(values[..., None] * np.ones(3), (1, 1, 1))


def photograph(places, colours, black=0.01):
    pixels = np.full((41, 61, 3), black, dtype=np.float32)
    for (row, column), colour in zip(places, colours, strict=True):
        pixels[row, column] += np.asarray(colour, dtype=np.float32)
    return Picture(pixels)


def test_two_diodes_show_two_patterns_each_about_its_mirror_image():
    table = lobes()
    lamp = surface.lamp_from_reflection(photograph([(18, 20), (24, 40)], [[1, 1, 1]] * 2), STEP)
    whole = surface.convolved(table, lamp)
    h_t, h_b = np.linspace(-1.2, 1.2, 61)[None, :], np.linspace(-0.6, 0.6, 31)[:, None]
    # The middle of the light lies at row 21, column 30; a photograph runs against h, its rows along it.
    expected = 0.5 * (
        lookup(table, h_t - 10 * STEP, h_b + 3 * STEP) + lookup(table, h_t + 10 * STEP, h_b - 3 * STEP)
    )
    found = lookup(whole, h_t, h_b)
    assert np.abs(found - expected).max() <= 0.02 * expected.max()
    unequal = lookup(table, h_t + 10 * STEP, h_b + 3 * STEP) + lookup(table, h_t - 10 * STEP, h_b - 3 * STEP)
    assert np.abs(found - 0.5 * unequal).max() > 0.2 * expected.max()


def test_a_point_lamp_changes_the_table_no_more_than_its_pixel_does():
    table = lobes()
    lamp = surface.lamp_from_reflection(photograph([(20, 30)], [[3, 3, 3]]), STEP)
    assert lamp.weights.shape == (1, 1, 3)
    whole = surface.convolved(table, lamp)
    assert energy(whole) == pytest.approx(energy(table), rel=5e-3)


def test_the_lamps_luminance_is_one_and_its_colour_is_kept_or_left_out():
    taken = photograph([(18, 20), (24, 40)], [[1, 0, 0], [0, 0, 1]])
    coloured = surface.lamp_from_reflection(taken, STEP, threshold=0.05)
    assert light.to_xyz(coloured.weights)[..., 1].sum() == pytest.approx(1, rel=1e-5)
    assert coloured.weights[..., 0].sum() == pytest.approx(coloured.weights[..., 2].sum(), rel=1e-3)
    neutral = surface.lamp_from_reflection(taken, STEP, threshold=0.05, neutral=True)
    np.testing.assert_array_equal(neutral.weights[..., 0], neutral.weights[..., 2])


def test_a_black_photograph_is_refused():
    with pytest.raises(refuse.Refusal, match="shows no lamp"):
        surface.lamp_from_reflection(photograph([], [], black=0.0), STEP)
    with pytest.raises(refuse.Refusal, match="'step' must be"):
        surface.lamp_from_reflection(photograph([(1, 1)], [[1, 1, 1]]), 0.0)
