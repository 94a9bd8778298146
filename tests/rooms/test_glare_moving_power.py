"""Occluders that move from frame to frame: each frame from the last one, and as it would be alone."""

import numpy as np

from aureole import aperture, glare
from aureole.records import Grid

WIDTH, SIZE = 8e-3, 128
OPENING = aperture.iris(7, WIDTH)
LAMP = glare.AreaLight(aperture.circle(4e-3), (1e-3, -0.5e-3), 12.0)
GRID = Grid((129, 129), (1 / WIDTH, 1 / WIDTH))


def test_each_frame_of_a_moving_matte_is_as_it_would_be_alone():
    rng = np.random.default_rng(4)
    leaves = np.kron(rng.random((12, 12)) > 0.6, np.ones((8, 8)))
    moving = glare.MovingPower(GRID, SIZE)
    for number in range(5):
        matte = aperture.occluder(aperture.from_mask(leaves, 20e-3), 0.5, (0.4e-3 * number, 0.2e-3 * number))
        found = moving.frame(OPENING, [matte], LAMP, 3)
        alone = glare.area_power(OPENING, [matte], LAMP, GRID, 3, size=SIZE, method="transforms")
        assert np.abs(found.power - alone.power).max() < 1e-6 * alone.power.max()
        assert found.visible == alone.visible
        assert 0.1 < found.visible < 0.9


def test_a_frame_in_which_nothing_moves_takes_no_second_transform():
    moving = glare.MovingPower(GRID, SIZE)
    bar = aperture.occluder(aperture.rectangle(2e-3, 1.0), 0.5)
    first = moving.frame(OPENING, [bar], LAMP, 1)
    again = moving.frame(OPENING, [bar], LAMP, 1)
    assert (first.transforms, again.transforms) == (1, 0)
    np.testing.assert_array_equal(first.power, again.power)
    hidden = moving.frame(OPENING, [aperture.occluder(aperture.rectangle(1.0, 1.0), 0.5)], LAMP, 3)
    assert hidden.visible == 0
    assert not hidden.power.any()
