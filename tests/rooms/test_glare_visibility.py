"""What part of the opening each pixel sees past an occluder: against the areas of exact outlines."""

import math

import numpy as np
import pytest

from aureole import Refusal, aperture, glare
from aureole.glare.camera import pupil

# Neither the opening nor what is before it looks the same turned round.
KITE = aperture.polygon([(-3e-3, -2e-3), (4e-3, -1e-3), (1e-3, 3.5e-3), (-2e-3, 2e-3)])
LEAF = aperture.polygon([(-6e-3, -7e-3), (3e-3, -2e-3), (-1e-3, 8e-3)])
SHAPE = (12, 20)


def camera(iris=KITE, shape=SHAPE):
    # A pixel is 2.5 mm wide on a plane half a metre away.
    return glare.camera(50e-3, 50e-3 / iris.width, iris, 5e-3, 3e-3, shape)


def areas(seen_by, occluders, distance, window=(0, 0, *SHAPE)):
    """The part of the opening that each pixel's middle sees, from the areas of outlines."""
    opening = pupil(seen_by)
    whole = aperture.area(opening)
    pitch_y, pitch_x = (pitch / seen_by.focal_length for pitch in seen_by.pixel_pitch)
    top, left, rows, columns = window
    found = np.zeros((rows, columns))
    for i in range(rows):
        for j in range(columns):
            toward = (left + j - SHAPE[1] // 2) * pitch_x, (top + i - SHAPE[0] // 2) * pitch_y
            left_of = aperture.seen_past(opening, occluders, toward, distance)
            found[i, j] = 0 if left_of is None else aperture.area(left_of) / whole
    return found


@pytest.mark.parametrize("distance", [math.inf, 2.0])
def test_the_visible_part_is_that_of_the_outlines(distance):
    leaf = aperture.occluder(LEAF, 0.5, (2e-3, -1e-3))
    found = glare.visibility(camera(), [leaf], distance)
    expected = areas(camera(), [leaf], distance)
    assert expected.min() < 0.2
    assert expected.max() == 1
    np.testing.assert_allclose(found, expected, atol=0.01)


def test_a_window_may_reach_beyond_the_picture():
    leaf = aperture.occluder(LEAF, 0.5, (-26e-3, 15e-3))
    window = (9, -3, 7, 8)
    found = glare.visibility(camera(), [leaf], window=window)
    assert found.shape == (7, 8)
    np.testing.assert_allclose(found, areas(camera(), [leaf], math.inf, window), atol=0.01)
    np.testing.assert_allclose(found[:3, 3:], glare.visibility(camera(), [leaf])[9:, :5], atol=0.01)


def test_rasters_and_mattes_see_what_outlines_see():
    leaf = aperture.occluder(LEAF, 0.5)
    size = 640
    raster = aperture.from_mask(aperture.rasterize(KITE, size), KITE.width)
    matte = aperture.from_mask(aperture.rasterize(LEAF, size), LEAF.width)
    expected = glare.visibility(camera(), [leaf])
    np.testing.assert_allclose(glare.visibility(camera(raster), [leaf]), expected, atol=2e-3)
    painted = glare.visibility(camera(), [aperture.occluder(matte, 0.5)])
    np.testing.assert_allclose(painted, expected, atol=2e-3)


def test_what_stands_behind_the_light_hides_nothing():
    leaf = aperture.occluder(LEAF, 0.5)
    assert np.all(glare.visibility(camera(), [leaf], 0.5) == 1)
    assert np.all(glare.visibility(camera(), [leaf.moved_to(9.0, 0.0)]) == 1)


def test_two_occluders_that_never_share_a_view_are_both_seen():
    left, right = (aperture.occluder(LEAF, 0.5, (x, 0.0)) for x in (-17e-3, 17e-3))
    found = glare.visibility(camera(), [left, right])
    np.testing.assert_allclose(found, areas(camera(), [left, right], math.inf), atol=0.01)


def test_distances_and_windows_that_mean_nothing_are_refused():
    with pytest.raises(Refusal, match=r"'distance' must be > 0, got 0\."):
        glare.visibility(camera(), [], 0.0)
    with pytest.raises(Refusal, match="'rows' must be an integer >= 1"):
        glare.visibility(camera(), [], window=(0, 0, 0, 4))
