"""The measurement's parts: geometry, merging, the centre, and what cannot be served."""

import math

import numpy as np
import pytest

from aureole import light, refuse, surface
from aureole.surface import virtual
from aureole.surface.geometry import pixel_map, pixels_at

SHAPE = (200, 240)
BENCH = surface.BenchGeometry(
    0.6, 0.4, 5e-5, tilt=(math.radians(7), math.radians(-4)), rotation=0.2, axis=(90.0, 130.0)
)
CENTRE = (104.3, 111.8)


def test_h_is_zero_where_the_mirror_shows_the_lamp():
    h_t, h_b, irradiance = BENCH.h_of(np.array(CENTRE[0]), np.array(CENTRE[1]), CENTRE, SHAPE)
    assert abs(h_t) < 1e-15
    assert abs(h_b) < 1e-15
    assert irradiance == pytest.approx(1.0, abs=1e-14)


def test_near_the_centre_of_a_level_sample_h_is_the_place_over_the_distances():
    # dh = −x (1 / r_camera + 1 / r_lamp) to first order, x to the right along t.
    bench = surface.BenchGeometry(0.5, 0.25, 1e-6)
    middle = ((SHAPE[0] - 1) / 2, (SHAPE[1] - 1) / 2)
    h_t, h_b, _ = bench.h_of(np.array(middle[0] - 3.0), np.array(middle[1] + 2.0), middle, SHAPE)
    assert h_t == pytest.approx(-2e-6 * (1 / 0.5 + 1 / 0.25), rel=1e-6)
    assert h_b == pytest.approx(-3e-6 * (1 / 0.5 + 1 / 0.25), rel=1e-6)


def test_even_pixels_are_those_of_a_bench_seen_from_afar():
    # Both ways round: a sample that is brighter on one side is drawn brighter on that side again.
    far = surface.BenchGeometry(50.0, 80.0, 1e-4, rotation=0.3)
    even = surface.UniformGeometry(1e-4 * (1 / 50.0 + 1 / 80.0), rotation=0.3)
    rows, columns = np.mgrid[0.0:200.0:20.0, 0.0:240.0:20.0]
    middle = ((SHAPE[0] - 1) / 2, (SHAPE[1] - 1) / 2)
    for one, other in zip(
        far.h_of(rows, columns, middle, SHAPE), even.h_of(rows, columns, middle, SHAPE), strict=True
    ):
        np.testing.assert_allclose(one, other, rtol=1e-6, atol=1e-12)


def test_pixels_and_h_are_inverse():
    rows, columns = np.mgrid[0:200:40.0, 0:240:40.0]
    h_t, h_b, _ = BENCH.h_of(rows, columns, CENTRE, SHAPE)
    found = pixels_at(BENCH, CENTRE, SHAPE, h_t, h_b)
    np.testing.assert_allclose(found[0], rows, atol=1e-6)
    np.testing.assert_allclose(found[1], columns, atol=1e-6)


def test_the_map_between_knots_is_exact_to_a_thousandth_of_a_pixel():
    axis = np.linspace(-0.02, 0.02, 301)
    rows, columns, _ = pixel_map(BENCH, CENTRE, SHAPE, axis)
    h_t, h_b, _ = BENCH.h_of(rows, columns, CENTRE, SHAPE)
    step = 5e-5 * (1 / 0.6 + 1 / 0.4)
    assert np.abs(h_t - axis[None, :]).max() < 1e-3 * step
    assert np.abs(h_b + axis[:, None]).max() < 1e-3 * step


def test_a_lamp_far_away_lights_evenly_and_a_near_one_by_the_square_of_distance():
    far = surface.BenchGeometry(0.5, math.inf, 1e-3)
    near = surface.BenchGeometry(0.5, 0.25, 1e-3)
    middle = ((SHAPE[0] - 1) / 2, (SHAPE[1] - 1) / 2)
    place = (np.array(middle[0]), np.array(middle[1] + 50.0))
    assert far.h_of(*place, middle, SHAPE)[2] == pytest.approx(1.0)
    # cos θ / r² with x = 50 mm beside a lamp 250 mm above: (250 / r)³.
    assert near.h_of(*place, middle, SHAPE)[2] == pytest.approx((0.25 / math.hypot(0.25, 0.05)) ** 3)


def test_a_photograph_from_far_away_is_even_in_h_and_runs_against_it():
    far = surface.BenchGeometry(50.0, math.inf, 1e-3, rotation=0.3)
    even = surface.UniformGeometry(1e-3 / 50.0, rotation=0.3)
    middle = ((SHAPE[0] - 1) / 2, (SHAPE[1] - 1) / 2)
    place = (np.array(middle[0] + 7.0), np.array(middle[1] + 50.0))
    found, expected = even.h_of(*place, middle, SHAPE), far.h_of(*place, middle, SHAPE)
    assert found[:2] == pytest.approx(expected[:2], rel=1e-5)


@pytest.mark.parametrize(
    ("bench", "word"),
    [
        (surface.BenchGeometry(-0.5, 1.0, 1e-5), "camera_distance"),
        (surface.BenchGeometry(0.5, 0.0, 1e-5), "lamp_distance"),
        (surface.BenchGeometry(0.5, 1.0, 0.0), "pixel_scale"),
        (surface.BenchGeometry(0.5, 1.0, 1e-5, tilt=(1.5, 0.0)), "80°"),
        (surface.BenchGeometry(0.05, 1.0, 1e-3, tilt=(1.3, 0.0)), "horizon"),
        (surface.UniformGeometry(0.0), "h_per_pixel"),
    ],
)
def test_a_bench_that_cannot_stand_is_refused(bench, word):
    rows, columns = np.mgrid[0.0:200.0, 0.0:240.0]
    with pytest.raises(refuse.Refusal, match=word):
        bench.h_of(rows, columns, CENTRE, SHAPE)


def test_a_bracket_merges_to_the_scene_within_its_expected_deviation():
    scene = np.geomspace(1e-4, 0.9, 100 * 100).reshape(100, 100)
    camera = surface.VirtualCamera()
    exposures = [1.0, 8.0, 64.0, 512.0]
    photos = surface.photograph(scene, exposures, camera, seed=2)
    full = camera.saturation - camera.black
    merged = surface.merge(
        photos,
        [full * value for value in exposures],
        camera.black,
        camera.saturation,
        camera.read_noise / camera.gain,
        camera.gain,
    )
    ratio = (merged.values - scene) / merged.deviation
    assert not merged.saturated.any()
    assert abs(ratio.mean()) < 0.05
    assert 0.9 < ratio.std() < 1.1


def test_a_bracket_tells_its_black_level():
    scene = np.geomspace(1e-4, 0.9, 10000).reshape(100, 100)
    photos = surface.photograph(scene, [1.0, 8.0, 64.0], surface.VirtualCamera(black=512.0), seed=1)
    assert surface.estimate_black(photos, [1.0, 8.0, 64.0]) == pytest.approx(512.0, abs=0.3)


def test_dark_frames_take_hot_pixels_away():
    scene = np.full((40, 40), 0.2)
    hot = np.zeros((40, 40))
    hot[7, 9], hot[30, 3] = 900.0, 300.0
    exposures = [1.0, 4.0]
    camera = surface.VirtualCamera(read_noise=0.0)
    photos = [
        photo + time * hot
        for photo, time in zip(surface.photograph(scene, exposures, camera), exposures, strict=True)
    ]
    dark = [camera.black + time * hot for time in exposures]
    merged = surface.merge(photos, exposures, dark, camera.saturation + 4000.0)
    np.testing.assert_allclose(merged.values, merged.values[0, 0], rtol=1e-3)
    plain = surface.merge(photos, exposures, camera.black, camera.saturation + 4000.0)
    assert plain.values[7, 9] > 1.2 * merged.values[7, 9]
    with pytest.raises(refuse.Refusal, match="dark frame for each"):
        surface.merge(photos, exposures, dark[:1])


def test_what_all_exposures_clip_is_marked():
    scene = np.full((8, 8), 0.1)
    scene[3, 4] = 5.0
    camera = surface.VirtualCamera(read_noise=0.0)
    photos = surface.photograph(scene, [1.0, 4.0], camera)
    merged = surface.merge(photos, [1.0, 4.0], camera.black, camera.saturation)
    assert np.argwhere(merged.saturated).tolist() == [[3, 4]]


def test_a_clipped_bracket_asks_where_the_camera_clips():
    scene = np.full((8, 8), 0.01)
    scene[3, 2:6] = 0.5
    camera = surface.VirtualCamera()
    photos = surface.photograph(scene, [1.0, 16.0], camera)
    with pytest.raises(refuse.Refusal, match="'photos' look clipped at 16383: say so by 'saturation'"):
        surface.merge(photos, [1.0, 16.0], camera.black)
    assert surface.merge(photos, [1.0, 1.5], camera.black).values.shape == (8, 8)


def test_brackets_that_do_not_fit_are_refused():
    flat = np.ones((4, 4))
    with pytest.raises(refuse.Refusal, match="exposures"):
        surface.merge([flat, flat], [1.0])
    with pytest.raises(refuse.Refusal, match="shape"):
        surface.merge([flat, np.ones((4, 5))], [1.0, 2.0])
    with pytest.raises(refuse.Refusal, match="NaN"):
        surface.merge([np.full((4, 4), np.nan)], [1.0])
    with pytest.raises(refuse.Refusal, match="differ"):
        surface.estimate_black([flat, flat], [1.0, 1.0])


@pytest.mark.parametrize("shortest", [1.0, 30.0, 1024.0])
@pytest.mark.parametrize("centre", [(201.37, 197.82), (212.25, 180.75)])
def test_the_centre_is_found_to_a_fifth_of_a_pixel_even_where_it_is_clipped(shortest, centre):
    scene = virtual.radiance(
        surface.lcd_screen(), light.line(530e-9), surface.UniformGeometry(1.2e-4), (400, 400), centre
    )
    camera = surface.VirtualCamera(blur=1.0)
    photo = surface.photograph(0.9 * scene, [shortest], camera, seed=4)[0] - camera.black
    found = surface.find_centre(photo)
    assert math.hypot(found.row - centre[0], found.column - centre[1]) < 0.2


def test_the_dimmer_order_is_the_centre_where_it_is_said_to_be_near():
    rows, columns = np.mgrid[0:100.0, 0:100.0]
    photo = sum(
        top * np.exp(-0.5 * ((rows - 50.2) ** 2 + (columns - column) ** 2) / 9.0)
        for top, column in ((1.0, 70.0), (0.4, 40.3))
    )
    found = surface.find_centre(photo, "core", near=(50.0, 41.0))
    assert math.hypot(found.row - 50.2, found.column - 40.3) < 0.1


def test_darkness_has_no_centre():
    with pytest.raises(refuse.Refusal, match="no light"):
        surface.find_centre(np.zeros((20, 20)))


def test_the_zero_order_takes_its_energy_with_it():
    # A Gaussian of energy 2πσ² on nothing, cut at 6σ.
    axis = np.linspace(-0.1, 0.1, 401)
    values = np.exp(-0.5 * (axis[:, None] ** 2 + axis**2) / 0.005**2)
    pattern = surface.diffraction_pattern(values, 0.1, 530e-9)
    left, cut = surface.split_zero_order(pattern, 0.03)
    assert cut.energy == pytest.approx(2 * math.pi * 0.005**2, rel=1e-5)
    assert cut.width == pytest.approx(0.005, rel=1e-3)
    assert left.values.max() < 1e-6


def dots():
    """A zero order and four orders."""
    rows, columns = np.mgrid[0:121.0, 0:121.0]
    return sum(
        top * np.exp(-0.5 * ((rows - 60.0) ** 2 + (columns - 60.0 - 25 * order) ** 2) / 9.0)
        for order, top in ((-2, 0.1), (-1, 0.3), (0, 1.0), (1, 0.3), (2, 0.1))
    )


def test_a_flat_field_undoes_the_lenss_falling_off():
    rows, columns = np.mgrid[0:121.0, 0:121.0]
    falling = 1.0 / (1.0 + ((rows - 60.0) ** 2 + (columns - 50.0) ** 2) / 90.0**2) ** 2
    geometry = surface.UniformGeometry(1e-3)
    how = {"geometry": geometry, "wavelength": 530e-9, "centre": (60.0, 60.0)}
    right = surface.measure_pattern(dots(), 1.0, **how)
    evened = surface.measure_pattern(dots() * falling, 1.0, **how, flat=700.0 * falling)
    plain = surface.measure_pattern(dots() * falling, 1.0, **how)
    top = right.values.max()
    assert np.abs(evened.values - right.values).max() < 0.01 * top
    assert np.abs(plain.values - right.values).max() > 0.05 * top


@pytest.mark.parametrize(
    ("photo", "options", "word"),
    [
        (np.zeros((60, 60)), {}, "no light"),
        (512.0 + np.random.default_rng(1).normal(size=(300, 300)), {"black": 512.0}, "no light"),
        (np.full((60, 60), 500.0), {"black": 512.0}, "no light"),
        (dots(), {"flat": np.zeros((121, 121))}, "flat"),
        (dots(), {"flat": np.ones((121, 120))}, "flat"),
        (dots(), {"blur": -1.0}, "blur"),
        (dots(), {"centre": (200.0, 60.0)}, "centre"),
        (dots(), {"half_range": 2.5}, "half_range"),
        (dots(), {"half_range": 0.5, "size": 100000}, "samples"),
        (dots(), {"period": -1e-6}, "period"),
        (dots(), {"iteration": 3}, "iterations"),
        (dots(), {"irradiance": 0.0}, "irradiance"),
    ],
)
def test_what_cannot_be_measured_is_refused(photo, options, word):
    with pytest.raises(refuse.Refusal, match=word):
        surface.measure_pattern(photo, 1.0, surface.UniformGeometry(1e-3), 530e-9, **options)


def test_sharpening_does_not_crowd_light_at_the_rim():
    # An even pattern stays even under any band: what comes in over the rim is accounted for.
    band = virtual.gaussian_filter_spectrum(530e-9, 40e-9)
    even = surface.diffraction_pattern(np.ones((101, 101)), 0.02, 530e-9)
    wavelengths, shares = band.wavelengths, band.values
    level = float(shares @ (530e-9 / wavelengths) ** 2)
    sharp = surface.sharpen(even, band, 2.0, iterations=20)
    assert np.abs(sharp.values * level - 1.0).max() < 0.01


def test_sharpening_leaves_what_was_not_measured_empty():
    seen = np.ones((101, 101), bool)
    seen[:, 80:] = False
    band = virtual.gaussian_filter_spectrum(530e-9, 40e-9)
    pattern = surface.diffraction_pattern(np.where(seen, 1.0, 0.0), 0.02, 530e-9)
    level = float(band.values @ (530e-9 / band.wavelengths) ** 2)
    sharp = surface.sharpen(pattern, band, 2.0, iterations=20, seen=seen)
    assert not sharp.values[~seen].any()
    assert np.abs(sharp.values[seen] * level - 1.0).max() < 0.02
