"""Dirt on the opening: amounts kept, seeds obeyed, time coherent, stretch seen in the spectrum."""

import itertools
import math
import re

import numpy as np
import pytest

from aureole import aperture, refuse

SQUARE = aperture.rectangle(2e-3, 2e-3)
HEPTAGON = aperture.iris(7, 2e-3)
SIZE = 128
DUST_OF_SEED_3 = [
    [0.8433301, 1.0000000, 1.0000000],
    [1.0000000, 1.0000000, 0.0611941],
    [1.0000000, 0.9591392, 0.8308327],
]
SCRATCHES_OF_SEED_3 = [
    [1.0000000, 1.0000000, 0.9925142],
    [1.0000000, 1.0000000, 1.0000000],
    [0.9281929, 1.0000000, 1.0000000],
]


def dusty(amount=0.2, scale=2e-4, seed=1, shape=SQUARE, size=SIZE, **more):
    return aperture.dust(shape, size, amount, scale, seed, **more).mask


def scratched(count=20, length=1e-3, width=3e-5, seed=1, shape=SQUARE, size=SIZE, **more):
    return aperture.scratches(shape, size, count, length, width, seed, **more).mask


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def spread(mask, angle):
    """Mean square frequency along a direction (counter-clockwise as seen) over that across it."""
    power = np.abs(np.fft.fft2(mask - mask.mean())) ** 2
    v, u = np.meshgrid(np.fft.fftfreq(len(mask)), np.fft.fftfreq(len(mask)), indexing="ij")
    along = u * math.cos(angle) - v * math.sin(angle)
    across = u * math.sin(angle) + v * math.cos(angle)
    return np.sum(power * along**2) / np.sum(power * across**2)


def test_dust_makes_a_raster_on_the_apertures_width_and_names_it():
    made = aperture.dust(HEPTAGON, 64, 0.1, 3e-4, 1)
    assert made.width == HEPTAGON.width
    assert made.mask.shape == (64, 64)
    assert made.mask.dtype == np.float32
    assert not made.outlines
    assert made.name == "iris of 7 blades behind dust"
    assert made.mask.min() == 0
    assert np.all(made.mask <= aperture.rasterize(HEPTAGON, 64))


def test_no_dust_and_no_scratches_change_nothing():
    whole = aperture.rasterize(HEPTAGON, SIZE)
    np.testing.assert_array_equal(dusty(0, shape=HEPTAGON), whole)
    np.testing.assert_array_equal(scratched(0, shape=HEPTAGON), whole)
    np.testing.assert_array_equal(scratched(9, opacity=0, shape=HEPTAGON), whole)


def test_dust_touches_the_part_that_it_is_told_to():
    for amount in (0.05, 0.3, 0.7):
        assert np.mean(dusty(amount) < 1) == pytest.approx(amount, abs=2 / SIZE**2)
        sharp = dusty(amount, softness=0)
        assert set(np.unique(sharp)) == {0.0, 1.0}
        assert 1 - sharp.mean() == pytest.approx(amount, abs=2 / SIZE**2)


def test_dust_touches_the_part_of_what_is_open():
    whole = aperture.rasterize(HEPTAGON, SIZE)
    lit = whole > 0
    assert np.mean(dusty(0.3, shape=HEPTAGON)[lit] < whole[lit]) == pytest.approx(0.3, abs=2e-3)


@pytest.mark.parametrize("softness", [0.0, 0.3, 3.0])
def test_more_dust_lets_less_light_through_everywhere(softness):
    masks = [dusty(amount, softness=softness) for amount in np.linspace(0, 1, 11)[:-1]]
    for less, more in itertools.pairwise(masks):
        assert np.all(more <= less)
        assert more.mean() < less.mean()


def test_a_seed_makes_the_same_dirt_and_another_seed_other_dirt():
    np.testing.assert_array_equal(dusty(seed=7), dusty(seed=7))
    np.testing.assert_array_equal(scratched(seed=7), scratched(seed=7))
    assert np.abs(dusty(seed=7) - dusty(seed=8)).mean() > 0.1
    assert np.abs(scratched(seed=7) - scratched(seed=8)).mean() > 0.01


def test_seeds_mean_the_same_on_every_machine():
    """Pixels as first made, so that no machine and no release draws other dirt."""
    found = dusty(0.5, 1e-3, 3, size=8, softness=2.0)[::3, ::3]
    np.testing.assert_allclose(found, DUST_OF_SEED_3, atol=1e-6)
    found = scratched(5, 1e-3, 1e-4, 3, size=8)[::3, ::3]
    np.testing.assert_allclose(found, SCRATCHES_OF_SEED_3, atol=1e-6)


def test_close_times_give_close_pictures_and_later_ones_others():
    now = dusty()
    changes = [np.abs(dusty(time=step) - now).mean() for step in (1e-4, 1e-3, 1e-2, 1e-1, 2.0, 50.0)]
    assert np.all(np.diff(changes[:5]) > 0)
    assert changes[0] < 1e-3
    assert changes[2] < 0.05
    # Two pictures without anything in common differ by about 2 · 0.2 · 0.8.
    assert min(changes[4:]) > 0.15


def test_time_runs_without_a_jump_over_a_whole_second():
    frames = [dusty(0.3, size=64, softness=1.0, time=second) for second in np.arange(0.5, 2.5, 0.02)]
    steps = [np.abs(b - a).mean() for a, b in itertools.pairwise(frames)]
    assert max(steps) < 3 * np.median(steps)


def test_dust_looks_the_same_at_another_size():
    fine = aperture.from_mask(dusty(size=512, softness=1.0, octaves=2), 2e-3)
    coarse = dusty(size=SIZE, softness=1.0, octaves=2)
    # The level follows the pixels at hand, so it moves by a little.
    assert np.abs(aperture.rasterize(fine, SIZE) - coarse).mean() < 0.005
    assert np.abs(aperture.rasterize(fine, SIZE) - coarse).max() < 0.2


@pytest.mark.parametrize("angle", [0.0, 0.5, math.pi / 2, 2.5])
def test_stretched_dust_spreads_light_across_its_grain(angle):
    assert spread(dusty(size=256, stretch=8, angle=angle), angle) < 0.2
    assert 0.7 < spread(dusty(size=256), angle) < 1.4


def test_more_octaves_make_finer_grain():
    edges = [np.abs(np.diff(dusty(octaves=octaves), axis=1)).sum() for octaves in (1, 2, 3)]
    assert edges[0] < edges[1] < edges[2]


def test_octaves_finer_than_two_pixels_are_left_out():
    # 2e-4 m are 12.8 pixels: cells of 6.4 and 3.2 still show, those of 1.6 do not.
    np.testing.assert_array_equal(dusty(octaves=3), dusty(octaves=9))


def test_the_noise_of_a_lattice_point_is_unbiased():
    """Gradient noise is even about zero: half of a large picture lies above it."""
    from aureole.aperture.dust import _noise

    noise = _noise(512, 8.0, 5, 1.0, 0.0, 0.0, 1)
    assert abs(noise.mean()) < 0.02
    assert 0.15 < noise.std() < 0.4
    assert np.abs(noise).max() <= 1.1


def test_dust_of_a_raster():
    grey = aperture.from_mask(np.full((32, 32), 0.5), 2e-3)
    made = dusty(0.25, shape=grey)
    assert made.max() == 0.5
    assert np.mean(made < 0.5) == pytest.approx(0.25, abs=1e-3)


def test_one_more_scratch_leaves_the_others_where_they_are():
    few, more = scratched(6, width=1e-4), scratched(7, width=1e-4)
    assert np.all(more <= few)
    assert 0 < np.count_nonzero(more < few) < few.size / 8


def test_scratches_are_thin_and_as_dark_as_they_may_be():
    mask = scratched(30, length=1e-3, width=2e-5, opacity=0.4)
    assert mask.mean() > 0.95
    assert np.count_nonzero(mask < 1) > 100
    # Where scratches cross, their transmittances multiply.
    assert scratched(1, width=1e-4, opacity=0.4).min() >= 0.6 - 1e-6


def test_a_scratch_takes_the_area_that_it_covers():
    """Half of all chances: a lens of two thirds of its length times its width, to first order."""
    from aureole.aperture.dust import _scratch
    from aureole.aperture.masks import darken

    ring = _scratch(np.full(7, 0.5), 1.0, 0.4, 0.02, 0.2)
    points = aperture.chords(ring, 1e-9)
    exact = abs(aperture.ring_moments(ring)[0])
    assert exact == pytest.approx(2 / 3 * 0.3 * 0.015, rel=1e-2)
    for size in (16, 50):
        mask = np.ones((size, size))
        darken(mask, points * size + size / 2, 0.5)
        assert 1 - mask.mean() == pytest.approx(0.5 * exact, rel=1e-6)


def test_scratches_bend():
    from aureole.aperture.dust import _scratch

    chance = np.full(7, 0.5)
    straight = aperture.chords(_scratch(chance, 1.0, 0.4, 1e-3, 0.3), 1e-9)
    chance[5] = 0.999
    bent = aperture.chords(_scratch(chance, 1.0, 0.4, 1e-3, 0.3), 1e-9)
    assert np.ptp(straight[:, 0]) == pytest.approx(7.5e-4, rel=1e-3)
    # The arc's rise is its bulge times half its length of 0.3.
    assert np.ptp(bent[:, 0]) == pytest.approx(0.3 * 0.15, rel=0.02)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"amount": -0.1}, "'amount' must be a number from 0 to 1, got -0.1."),
        ({"amount": math.nan}, "'amount' must be a number from 0 to 1, got nan."),
        ({"scale": 0}, "'scale' must be a finite number > 0, got 0."),
        ({"scale": 3e-5}, "'scale' must be at least two pixels, here 3.125e-05 m, got 3e-05."),
        ({"seed": -1}, "'seed' must be an integer >= 0, got -1."),
        ({"seed": 1.5}, "'seed' must be an integer >= 0, got 1.5."),
        ({"stretch": 0.5}, "'stretch' must be a number from 1 to 1000, got 0.5."),
        ({"octaves": 0}, "'octaves' must be an integer >= 1, got 0."),
        ({"softness": -1}, "'softness' must be a number from 0 to 100, got -1."),
        ({"time": math.inf}, "'time' must be a finite number, got inf."),
        ({"angle": math.inf}, "'angle' must be a finite number, got inf."),
        ({"size": 0}, "'size' must be an integer >= 1, got 0."),
        ({"amount": 1, "softness": 0}, "the dust let no light through; take less."),
    ],
)
def test_dust_that_is_refused(more, message):
    with refused(message):
        dusty(**more)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"count": -1}, "'count' must be an integer >= 0, got -1."),
        ({"length": 0}, "'length' must be a finite number > 0, got 0."),
        ({"width": 0}, "'width' must be a finite number > 0, got 0."),
        ({"width": 1e-3}, "'width' must be a number from 0 to 0.00025, got 0.001."),
        ({"bend": 2}, "'bend' must be a number from 0 to 1, got 2."),
        ({"opacity": 1.1}, "'opacity' must be a number from 0 to 1, got 1.1."),
        ({"seed": -1}, "'seed' must be an integer >= 0, got -1."),
    ],
)
def test_scratches_that_are_refused(more, message):
    with refused(message):
        scratched(**more)
