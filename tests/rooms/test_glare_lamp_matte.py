"""Only lamps make glare: which pixels are theirs, and that nothing pops."""

import numpy as np
import pytest

from aureole import Picture, glare, refuse


def wall_with(*lamps):
    """A dim wall with square lamps: (row, column, side, luminance)."""
    pixels = np.full((60, 90, 3), 0.05, dtype=np.float32)
    for row, column, side, value in lamps:
        pixels[row : row + side, column : column + side] = value
    return Picture(pixels)


def test_light_counts_from_the_threshold_on_and_in_full_from_twice_that():
    values = np.array([0.0, 1.0, 4.0, 4.4, 5.0, 8.0, 1e6], dtype=np.float32)
    matte = glare.lamp_matte(Picture(np.repeat(values[None, :, None], 3, axis=2)), 4.0)
    # What counts of a pixel between is 2 (Y − T): 0 at the threshold, all at twice that.
    assert (matte[0] * values).tolist() == pytest.approx([0, 0, 0, 0.8, 2, 8, 1e6], rel=1e-6)


def test_the_light_that_counts_grows_no_faster_than_twice_the_light():
    values = np.linspace(0, 20, 2001, dtype=np.float32)
    matte = glare.lamp_matte(Picture(np.repeat(values[None, :, None], 3, axis=2)), 4.0)
    steps = np.diff(matte[0].astype(float) * values)
    assert steps.min() >= 0
    assert steps.max() <= 2.001 * 0.01


def test_only_the_lamps_that_are_named_count():
    seen = wall_with((10, 10, 3, 40.0), (40, 60, 5, 30.0), (20, 70, 2, 20.0))
    lamps = glare.find_lamps(seen)
    assert len(lamps) == 3
    everything = glare.lamp_matte(seen)
    assert (everything > 0).sum() == 9 + 25 + 4
    for lamp in lamps:
        matte = glare.lamp_matte(seen, None, [lamp])
        left, top, right, bottom = lamp.box
        inside = np.zeros(matte.shape, dtype=bool)
        inside[top:bottom, left:right] = True
        assert np.array_equal(matte, np.where(inside, everything, 0))
    assert np.array_equal(glare.lamp_matte(seen, None, lamps), everything)
    assert not glare.lamp_matte(seen, None, []).any()


def test_a_lamp_within_another_ones_box_is_not_taken_with_it():
    """As a bulb in the corner of a neon sign."""
    seen = wall_with((10, 10, 30, 40.0), (11, 11, 29, 0.05), (30, 30, 3, 20.0))
    sign, bulb = glare.find_lamps(seen)
    matte = glare.lamp_matte(seen, None, [sign])
    assert matte[30:33, 30:33].max() == 0
    assert matte[10, 10:40].min() == 1
    assert glare.lamp_matte(seen, None, [bulb]).sum() == 9


def test_pieces_that_were_found_as_one_count_as_one():
    seen = wall_with((10, 10, 3, 40.0), (10, 15, 3, 40.0))
    (lamp,) = glare.find_lamps(seen, connect=4)
    assert glare.lamp_matte(seen, None, [lamp], connect=4).sum() == 18


def test_a_place_alone_names_the_region_about_it():
    seen = wall_with((10, 10, 3, 40.0), (40, 60, 5, 30.0))
    matte = glare.lamp_matte(seen, None, [glare.Lamp((62.0, 43.0), 0.0)])
    assert np.array_equal(np.argwhere(matte > 0).min(axis=0), [40, 60])
    assert matte.sum() == 25
    # A lamp that is hidden, or stands off the picture, has no pixels: not those of the wall.
    assert not glare.lamp_matte(seen, None, [glare.Lamp((30.0, 50.0), 0.0)]).any()
    assert not glare.lamp_matte(seen, None, [glare.Lamp((-400.0, 900.0), 0.0)]).any()


def test_a_box_whose_lamp_has_moved_a_little_is_its_still():
    seen = wall_with((10, 10, 3, 40.0), (10, 30, 3, 40.0))
    moved = glare.Lamp((12.5, 11.5), 1.0, box=(10, 9, 15, 14))
    assert glare.lamp_matte(seen, None, [moved]).sum() == 9
    gone = glare.Lamp((50.0, 50.0), 1.0, box=(48, 48, 53, 53))
    assert not glare.lamp_matte(seen, None, [gone]).any()


def test_the_brightest_pixel_near_names_the_light():
    seen = glare.luminances(wall_with((10, 10, 3, 40.0), (10, 13, 2, 8.0), (10, 15, 2, 3.0)))
    lit, brightest = glare.lit_about(seen, (12.0, 11.0))
    assert brightest == pytest.approx(40, rel=1e-6)
    # A tenth of it: the second lamp is joined to the first, the third is too dim.
    assert lit.sum() == 9 + 4
    assert glare.lit_about(np.zeros((5, 5)), (2.0, 2.0))[1] == 0


def test_a_black_picture_has_no_lamps():
    black = Picture(np.zeros((4, 5, 3), dtype=np.float32))
    assert not glare.lamp_matte(black).any()
    assert not glare.lamp_matte(black, None, [glare.Lamp((2.0, 2.0), 0.0)]).any()
    assert not glare.lamp_matte(black, 1.0).any()


def test_refusals():
    with pytest.raises(refuse.Refusal, match="'threshold' must be a finite number > 0"):
        glare.lamp_matte(wall_with(), 0.0)
    with pytest.raises(refuse.Refusal, match="'connect' must be an integer >= 1"):
        glare.lamp_matte(wall_with(), 1.0, [glare.Lamp((1, 1), 1.0, box=(0, 0, 2, 2))], connect=0)
