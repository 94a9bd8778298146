"""The progressive far field: what it counts, what it keeps, what it refuses."""

import re

import numpy as np
import pytest

from aureole import Aperture, Grid, aperture, refuse
from aureole.diffraction import ProgressiveFarField, far_field, quadtree

WIDTH = 1e-3
GRID = Grid((20, 21), (900.0, 1100.0))


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def opening(size=16, seed=1):
    rng = np.random.default_rng(seed)
    return Aperture(WIDTH, mask=rng.integers(0, 2, (size, size)).astype(np.float32))


def test_the_first_update_is_a_fresh_transform():
    progressive, first = ProgressiveFarField(GRID), opening()
    found = progressive.update(first).amplitude
    truth = far_field(first, GRID, "quads").amplitude
    assert found.dtype == np.complex64
    assert np.abs(found - truth).max() < 1e-6 * np.abs(truth).max()
    positive, negative = progressive.evaluated
    assert 0 < positive <= len(quadtree(first.mask, WIDTH))
    assert negative == 0
    assert not progressive.refreshed


def test_no_change_evaluates_no_quads_and_changes_no_bit():
    progressive = ProgressiveFarField(GRID)
    before = progressive.update(opening()).amplitude.copy()
    after = progressive.update(opening()).amplitude
    assert progressive.evaluated == (0, 0)
    assert [len(quads) for quads in progressive.quads()] == [0, 0]
    np.testing.assert_array_equal(before, after)


def test_nothing_is_evaluated_before_the_first_update():
    progressive = ProgressiveFarField(GRID)
    assert progressive.evaluated == (0, 0)
    np.testing.assert_array_equal(progressive.power(), np.zeros(GRID.shape, dtype=np.float32))


def test_counts_positive_and_negative_quads_apart():
    progressive, mask = ProgressiveFarField(GRID), np.zeros((16, 16), dtype=np.float32)
    mask[:8, :8] = 1
    progressive.update(Aperture(WIDTH, mask=mask))
    moved = np.zeros_like(mask)
    moved[8:, 8:] = moved[0, 0] = 1
    progressive.update(Aperture(WIDTH, mask=moved))
    # One square comes. What goes is a square, of which a pixel stays.
    assert progressive.evaluated == (1, 2)


def test_neighbours_are_merged_across_the_trees_levels():
    mask = np.zeros((16, 16), dtype=np.float32)
    mask[5, 3:14] = mask[7:12, 2] = 1
    progressive = ProgressiveFarField(GRID)
    progressive.update(Aperture(WIDTH, mask=mask))
    assert len(quadtree(mask, WIDTH)) > 2
    assert progressive.evaluated == (2, 0)
    bars, _ = progressive.quads()
    edges = np.rint((bars.rectangles + WIDTH / 2) / WIDTH * 16).astype(int)
    assert sorted(edges.tolist()) == [[2, 7, 3, 12], [3, 5, 14, 6]]
    # Neighbours of unlike weights stay apart.
    mask[5, 3:7] = 0.5
    progressive = ProgressiveFarField(GRID)
    progressive.update(Aperture(WIDTH, mask=mask))
    assert progressive.evaluated[0] >= 3


def test_power_is_the_squared_modulus():
    progressive = ProgressiveFarField(GRID)
    for seed in range(3):
        amplitude = progressive.update(opening(seed=seed)).amplitude
        np.testing.assert_allclose(progressive.power(), np.abs(amplitude) ** 2, rtol=1e-5, atol=1e-20)
        assert progressive.power().dtype == np.float32


def test_the_running_arrays_cannot_be_written():
    progressive = ProgressiveFarField(GRID)
    field = progressive.update(opening())
    for array in (field.amplitude, progressive.power()):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1


def test_a_mask_changed_in_place_counts_as_a_change():
    progressive, first = ProgressiveFarField(GRID), opening()
    progressive.update(first)
    first.mask[3, 4] = 1 - first.mask[3, 4]
    progressive.update(first)
    assert sum(progressive.evaluated) == 1


def test_outlines_are_rasterized_at_the_size_of_the_first():
    progressive = ProgressiveFarField(GRID, raster_size=64)
    shape = aperture.circle(WIDTH)
    found = progressive.update(shape).amplitude
    truth = far_field(shape, GRID, "quads", raster_size=64).amplitude
    assert np.abs(found - truth).max() < 1e-6 * np.abs(truth).max()
    progressive.update(Aperture(WIDTH, mask=aperture.rasterize(shape, 64)))
    assert progressive.evaluated == (0, 0)
    # Where a raster comes first, its size holds.
    progressive = ProgressiveFarField(GRID, raster_size=64)
    progressive.update(Aperture(WIDTH, mask=aperture.rasterize(shape, 32)))
    progressive.update(shape)
    assert progressive.evaluated == (0, 0)


def test_refuses_another_width():
    progressive = ProgressiveFarField(GRID)
    before = progressive.update(opening()).amplitude.copy()
    with refused(
        "'aperture' must be 0.001 m wide as the first one, got 0.002 m; "
        "begin another ProgressiveFarField for another width."
    ):
        progressive.update(Aperture(2 * WIDTH, mask=opening().mask))
    np.testing.assert_array_equal(progressive.update(opening()).amplitude, before)


def test_refuses_another_size():
    progressive = ProgressiveFarField(GRID)
    progressive.update(opening(16))
    with refused(
        "'aperture' must have 16 x 16 pixels as the first one, got 17 x 17; "
        "begin another ProgressiveFarField for another size."
    ):
        progressive.update(opening(17))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_refuses_what_is_not_finite_and_stays_as_it_was(value):
    progressive, wrong = ProgressiveFarField(GRID), opening(seed=2)
    before = progressive.update(opening()).amplitude.copy()
    wrong.mask[3, 4] = value
    with refused("'mask' must be finite, got NaN or infinity."):
        progressive.update(wrong)
    np.testing.assert_array_equal(progressive.update(opening()).amplitude, before)
    assert progressive.evaluated == (0, 0)


def test_refuses_grids_and_sizes():
    with refused("'grid rows' must be an integer >= 1, got 0."):
        ProgressiveFarField(Grid((0, 4), (1.0, 1.0)))
    with refused("'raster_size' must be an integer >= 1, got 0."):
        ProgressiveFarField(GRID, raster_size=0)
