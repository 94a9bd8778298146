"""The cheap way to what crops the iris: pixels about a light, laid over the aperture."""

import numpy as np
import pytest

from aureole import Refusal, aperture, glare
from aureole.glare.camera import pupil
from aureole.records import Aperture

SIZE = 256
SHAPE = (81, 101)
CENTRE = (50.5, 40.5)


def disc(radius, centre=CENTRE):
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]] + 0.5
    return np.clip(radius - np.hypot(x - centre[0], y - centre[1]) + 0.5, 0, 1)


def light(seen):
    rows, columns = np.nonzero(seen)
    box = columns.min(), rows.min(), columns.max() + 1, rows.max() + 1
    return glare.Lamp(CENTRE, 1.0, box=tuple(int(side) for side in box))


def test_the_circle_about_a_light_is_found_though_a_third_is_hidden():
    whole = disc(20)
    half = whole.copy()
    half[:, 57:] = 0
    for lit in (whole, half):
        centre, radius = glare.circle_about(lit > 0.5)
        assert np.hypot(centre[0] - CENTRE[0], centre[1] - CENTRE[1]) < 0.5
        assert radius == pytest.approx(20, abs=0.8)
    assert glare.circle_about(disc(1.2, (7.5, 9.5)) > 0.9)[0] == pytest.approx((7.5, 9.5))
    with pytest.raises(Refusal, match="'lit' must have at least one pixel"):
        glare.circle_about(np.zeros((3, 3), dtype=bool))


def test_a_lights_pixels_are_as_bright_as_its_brighter_quarter():
    seen = 40 * disc(12) + 0.2
    seen[:5, :5] = 1000
    share = glare.light_pixels(seen, light(disc(12)))
    assert share[40, 50] == pytest.approx(1)
    assert share[2, 2] == 0
    assert share[30, 39] < 0.1


def test_a_light_that_is_all_seen_leaves_the_iris_whole():
    iris = aperture.iris(7, 10e-3)
    centre, radius = glare.circle_about(disc(20) > 0.5)
    left = glare.cropped_opening(iris, disc(20), centre, glare.INSIDE * radius, SIZE)
    whole = aperture.rasterize(iris, SIZE)
    assert np.abs(left.mask - whole).mean() < 1e-4


@pytest.mark.parametrize(
    ("edge", "part"), [(50.5, 0.5), (55.5, 0.5 + (0.25 * np.sqrt(1 - 1 / 16) + np.arcsin(0.25)) / np.pi)]
)
def test_an_edge_over_the_light_cuts_a_round_iris_there(edge, part):
    # Segment of a circle of radius 1 up to x: 1/2 + (x sqrt(1 - x²) + arcsin x) / π of it.
    passes = np.clip(edge - np.arange(SHAPE[1]), 0, 1) * np.ones((SHAPE[0], 1))
    left = glare.cropped_opening(aperture.circle(8e-3), passes, CENTRE, 20.0, SIZE)
    assert aperture.energy(left) / (np.pi * 16e-6) == pytest.approx(part, abs=4e-3)
    # What is hidden on the picture's right is hidden on the iris's right.
    assert left.mask[:, : SIZE // 4].sum() > 0
    assert left.mask[:, -SIZE // 4 :].sum() == 0


def test_with_its_distance_a_matte_crops_as_the_occluder_itself():
    camera = glare.camera(50e-3, 5, aperture.iris(7, 10e-3), 101 * 50e-6, 81 * 50e-6, SHAPE)
    opening, distance = pupil(camera), 0.5
    leaf = aperture.polygon([(-6e-3, -7e-3), (3e-3, -2e-3), (-1e-3, 8e-3)])
    # Seen from the middle of the opening, a pixel is half a millimetre wide on the occluder's plane.
    side = 0.5e-3 * 81
    matte = np.zeros(SHAPE)
    matte[:, 10:91] = aperture.rasterize(Aperture(side, leaf.outlines), 81)
    radius = glare.neighbourhood_radius(camera, opening, distance)
    assert radius == pytest.approx(10.0)
    for x, y in ((50.5, 40.5), (53.5, 38.5)):
        found = glare.cropped_opening(opening, 1 - matte, (x, y), radius, SIZE)
        toward = (x - 50.5) * 1e-3, (y - 40.5) * 1e-3
        exact = aperture.seen_past(opening, [aperture.occluder(leaf, distance)], toward, size=SIZE)
        shares = [aperture.energy(each) / aperture.area(opening) for each in (found, exact)]
        assert shares[0] == pytest.approx(shares[1], abs=0.01)
        assert np.abs(found.mask - exact.mask).mean() < 0.01


def test_what_is_hidden_whole_and_numbers_that_mean_nothing():
    iris = aperture.circle(8e-3)
    assert glare.cropped_opening(iris, np.zeros(SHAPE), CENTRE, 20.0, SIZE) is None
    with pytest.raises(Refusal, match="'radius' must be a finite number > 0"):
        glare.cropped_opening(iris, np.ones(SHAPE), CENTRE, 0.0, SIZE)
    camera = glare.camera(50e-3, 5, iris)
    with pytest.raises(Refusal, match="'distance' must be > 0 and before the light, got 3"):
        glare.neighbourhood_radius(camera, iris, 3.0, 2.0)
