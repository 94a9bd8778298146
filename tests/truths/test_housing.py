"""The housing of a lens: circles' shared areas, and real rays through a prescription."""

import math

import numpy as np
import pytest

from aureole import aperture, flare, refuse
from aureole.aperture import Rim
from aureole.flare import paraxial, tracing
from aureole.flare.pupil import image_power


def lens_of_circles(first, second, apart):
    """Area that two circles share."""
    if apart <= abs(first - second):
        return math.pi * min(first, second) ** 2
    one = (apart**2 + first**2 - second**2) / (2 * apart)
    two = apart - one
    return (
        first**2 * math.acos(one / first)
        - one * math.sqrt(first**2 - one**2)
        + second**2 * math.acos(two / second)
        - two * math.sqrt(second**2 - two**2)
    )


@pytest.mark.parametrize("degrees", [0.0, 4.0, 9.0, 15.0])
def test_one_rim_leaves_the_area_that_two_circles_share(degrees):
    pupil, rim = aperture.circle(20e-3), Rim(24e-3, 40e-3)
    direction = (math.radians(degrees) * 0.6, math.radians(degrees) * 0.8)
    apart = 40e-3 * math.hypot(*(math.tan(angle) for angle in direction))
    expected = lens_of_circles(10e-3, 12e-3, apart) / (math.pi * 1e-4)
    assert aperture.open_part(pupil, [rim], direction) == pytest.approx(expected, abs=2e-6)


def test_rims_before_and_behind_crop_opposite_sides():
    pupil = aperture.circle(20e-3)
    direction = (math.radians(10), 0.0)
    before = aperture.behind_rims(pupil, [Rim(20e-3, 30e-3)], direction)
    behind = aperture.behind_rims(pupil, [Rim(20e-3, -30e-3)], direction)
    centre = [
        np.concatenate([ring.vertices for ring in left.outlines]).mean(axis=0)[0] for left in (before, behind)
    ]
    # Light from the right throws the shadow of the front rim to the left.
    assert centre[0] < -1e-3
    assert centre[1] == pytest.approx(-centre[0], abs=1e-4)
    both = aperture.behind_rims(pupil, [Rim(20e-3, 30e-3), Rim(20e-3, -30e-3)], direction)
    assert aperture.energy(both) < 0.7 * aperture.energy(before)


def test_a_rim_that_cuts_nothing_leaves_the_pupil_itself():
    pupil = aperture.iris(7, 10e-3)
    assert aperture.behind_rims(pupil, [Rim(50e-3, 20e-3)], (0.1, 0.1)) is pupil


@pytest.mark.parametrize("name", ["cooke_triplet_100mm", "kodak_symmetric_100mm", "leica_summicron_r_50mm"])
def test_rims_near_the_axis_say_what_real_rays_find(name):
    """The image's light by angle, wide open: paraxial rims against rays through every semi-aperture."""
    lens, _ = flare.open_lens(name)
    rims = flare.housing_rims(lens)
    _, radius = paraxial.entrance_pupil(lens)
    pupil = aperture.circle(2 * radius)
    prepared = tracing.prepare(lens, [550e-9])
    angles = np.radians([0.0, 4.0, 8.0])
    real, near = [], []
    for angle in angles:
        power = image_power(prepared, [math.sin(angle), 0.0, math.cos(angle)])
        real.append(float(np.mean(power)) / math.cos(angle))
        near.append(aperture.energy(aperture.behind_rims(pupil, rims, (float(angle), 0.0))))
    np.testing.assert_allclose(np.array(near) / near[0], np.array(real) / real[0], atol=0.025)
    assert near[2] < 0.97 * near[0]


def test_a_lens_of_another_focal_length_has_its_rims_scaled():
    lens, _ = flare.open_lens("cooke_triplet_100mm")
    own, double = flare.housing_rims(lens), flare.housing_rims(lens, 2 * paraxial.focal_length(lens))
    for one, two in zip(own, double, strict=True):
        assert two.diameter == pytest.approx(2 * one.diameter)
        assert two.distance == pytest.approx(2 * one.distance)


def open_parts(name, degrees):
    """What is left at some angles of what is open on the axis: by real rays' power, and by their outline."""
    lens, _ = flare.open_lens(name)
    _, radius = paraxial.entrance_pupil(lens)
    pupil, housing = aperture.circle(2 * radius), flare.TracedHousing(lens, radius)
    prepared = tracing.prepare(lens, [550e-9])
    real, found = [], []
    for degree in (0.0, *degrees):
        right = math.radians(degree)
        power = float(image_power(prepared, [math.tan(right), 0.0, 1.0])[0])
        real.append(power / math.cos(right))
        seen = housing.seen_from((right, 0.0))
        left = pupil if seen.outline is None else aperture.intersection(pupil, seen.outline)
        found.append(aperture.energy(left) * seen.stretch)
    return np.array(real) / real[0], np.array(found) / found[0]


@pytest.mark.parametrize("name", ["nikkor_50mm_f1_2", "zeiss_biotar_50mm", "heliar_tronnier_100mm"])
def test_traced_rims_leave_the_light_that_real_rays_carry(name):
    """Fast lenses, too, whose rims near the axis are 0.1 off; coatings lose a little more from aside."""
    real, found = open_parts(name, [4.0, 8.0, 14.0])
    np.testing.assert_allclose(found, real, atol=0.006)
    assert found[-1] < 0.85


@pytest.mark.parametrize("degrees", [4.0, 9.0, 14.0])
def test_traced_rims_of_a_tube_leave_the_area_that_two_circles_share(degrees):
    """A rim of air 40 mm before the stop, and a wide lens behind: nothing bends light before the stop."""
    glass = flare.named("N-BK7")
    surfaces = (
        flare.Surface(0.0, 40e-3, 12e-3),
        flare.Surface(0.0, 1e-3, 10e-3, stop=True),
        flare.Surface(10.0, 5e-3, 60e-3, glass),
        flare.Surface(-10.0, 9.6, 60e-3),
    )
    housing = flare.TracedHousing(flare.Lens("tube", "Tube", 9.6, 480, (36e-3, 24e-3), surfaces), 10e-3)
    direction = (math.radians(0.6 * degrees), -math.radians(0.8 * degrees))
    seen = housing.seen_from(direction)
    apart = 40e-3 * math.hypot(*(math.tan(angle) for angle in direction))
    left = aperture.intersection(aperture.circle(20e-3), seen.outline)
    assert aperture.energy(left) == pytest.approx(lens_of_circles(10e-3, 12e-3, apart), rel=2e-3)
    assert seen.stretch == pytest.approx(1, abs=1e-3)
    # Light from the right and above throws the rim's shadow to the left and down.
    expected = aperture.behind_rims(aperture.circle(20e-3), [Rim(24e-3, 40e-3)], direction)
    masks = [aperture.rasterize(shape, 64) for shape in (left, expected)]
    assert np.abs(masks[0] - masks[1]).mean() < 2e-3


def test_a_dark_direction_is_refused():
    lens, _ = flare.open_lens("nikon_tele_zoom_200mm")
    housing = flare.TracedHousing(lens, 5e-3)
    with pytest.raises(refuse.Refusal, match=r"^the lens 'nikon\w+' lets no light through from 40 deg"):
        housing.seen_from((math.radians(40), 0.0))


def test_the_outline_on_the_stop_is_that_of_the_pupil():
    """By the image's way: the same crop, in parts of the stop."""
    lens, _ = flare.open_lens("heliar_tronnier_100mm")
    _, radius = paraxial.entrance_pupil(lens)
    direction = (math.radians(8), math.radians(-3))
    seen = flare.TracedHousing(lens, radius).seen_from(direction).outline
    iris = aperture.circle(1.0)
    towards = (math.tan(direction[0]), math.tan(direction[1]), 1.0)
    outline = flare.stop_outline(lens, (), towards, iris)
    areas = [
        aperture.energy(aperture.intersection(whole, crop)) / aperture.energy(whole)
        for whole, crop in ((aperture.circle(2 * radius), seen), (iris, outline))
    ]
    assert areas[1] == pytest.approx(areas[0], abs=2e-3)
    assert areas[0] < 0.95
    assert flare.stop_outline(lens, (), (0.0, 0.0, 1.0), aperture.circle(1.0), 16.0) is None
