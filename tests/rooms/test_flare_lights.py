"""Lights for a lens: directions, places on the picture, sizes, colours, and those found in a picture."""

import math

import numpy as np
import pytest

from aureole import light, refuse
from aureole.flare import lights, load, paraxial
from aureole.records import Light, Picture

SHAPE = (1080, 1920)
DEGREE = math.pi / 180


def test_angles_are_tangents_to_the_right_and_downward():
    x, y, z = lights.light_at(8 * DEGREE, -3 * DEGREE).direction
    assert math.hypot(x, y, z) == pytest.approx(1.0)
    assert (x / z, y / z) == pytest.approx((math.tan(8 * DEGREE), -math.tan(3 * DEGREE)))


def test_a_light_stands_where_its_focal_length_says():
    lens = load("zeiss_biotar_50mm")
    place = lights.place_on_picture(lens, lights.light_at(10 * DEGREE, 0.0), SHAPE)
    pixels = paraxial.focal_length(lens) * math.tan(10 * DEGREE) / (lens.sensor[0] / 1920)
    assert place == pytest.approx((960 + pixels, 540))


@pytest.mark.parametrize("name", ["zeiss_biotar_50mm", "schneider_anamorphic_31mm"])
@pytest.mark.parametrize("place", [(960.0, 540.0), (1200.0, 300.0), (-400.0, 2000.0)])
def test_places_and_directions_are_inverse(name, place):
    lens = load(name)
    found = lights.light_on_picture(lens, place, SHAPE)
    assert lights.place_on_picture(lens, found, SHAPE) == pytest.approx(place)


def test_an_anamorphic_lens_has_two_scales():
    along_x, along_y = lights.pixels_per_tangent(load("schneider_anamorphic_31mm"), SHAPE)
    assert max(along_x, along_y) / min(along_x, along_y) == pytest.approx(1.923, abs=0.01)


def test_points_share_the_disc_evenly():
    source = lights.light_at(20 * DEGREE, 5 * DEGREE, irradiance=3.0, angular_size=2 * DEGREE)
    points = lights.points_of(source, 200)
    directions = np.array([point.direction for point in points])
    assert sum(point.irradiance for point in points) == pytest.approx(3.0)
    cosines = directions @ source.direction
    radii = np.tan(np.arccos(np.minimum(cosines, 1.0)))
    assert radii.max() < math.tan(DEGREE) * 1.01
    # The mean of r² over a disc of radius R is R² / 2, and the centre is the light's own.
    assert np.mean(radii**2) == pytest.approx(math.tan(DEGREE) ** 2 / 2, rel=0.02)
    mean = directions.mean(axis=0)
    assert mean / np.linalg.norm(mean) == pytest.approx(np.array(source.direction), abs=1e-6)


def test_a_point_stays_a_point():
    source = lights.light_at(5 * DEGREE, irradiance=2.0)
    assert [point.direction for point in lights.points_of(source, 9)] == [source.direction]


def test_larger_lights_take_more_points_up_to_a_bound():
    lens = load("zeiss_biotar_50mm")
    sizes = [0.0, 0.1 * DEGREE, 0.5 * DEGREE, 5 * DEGREE]
    counts = [lights.point_count(lens, lights.light_at(0.0, angular_size=size), SHAPE) for size in sizes]
    assert counts == sorted(counts)
    assert (counts[0], counts[-1]) == (1, lights.MOST_POINTS)


@pytest.mark.parametrize(
    "colour", [(1, 1, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0.2, 0.7, 0.4), (5.0, 2.0, 0.01)]
)
def test_a_colour_spectrum_has_the_colour(colour):
    spectrum = lights.colour_spectrum(colour)
    np.testing.assert_allclose(
        light.from_xyz(light.tristimulus(spectrum), "rec709"), colour, rtol=1e-9, atol=1e-9
    )
    assert spectrum.values.min() >= 0
    # Smooth: from nanometre to nanometre it changes by a few per cent of its peak.
    assert np.abs(np.diff(spectrum.values)).max() < 0.04 * spectrum.values.max()


def test_white_is_near_equal_energy():
    values = lights.colour_spectrum((1, 1, 1)).values
    assert np.ptp(values) < 0.05 * values.mean()


def _picture(*spots):
    pixels = np.zeros((90, 160, 3), dtype=np.float32)
    for row, column, size, colour in spots:
        pixels[row : row + size, column : column + size] = colour
    return Picture(pixels)


def test_lights_are_found_with_place_flux_colour_and_size():
    lens = load("zeiss_biotar_50mm")
    red, white = (8.0, 1.0, 0.5), (20.0, 20.0, 20.0)
    found = lights.find_lights(
        _picture((20, 30, 4, red), (60, 100, 2, white), (5, 5, 1, (0.5,) * 3)), lens, 1.0
    )
    assert len(found) == 2
    brightest, second = found
    assert lights.place_on_picture(lens, brightest, (90, 160)) == pytest.approx((101, 61))
    assert lights.place_on_picture(lens, second, (90, 160)) == pytest.approx((32, 22))
    assert brightest.irradiance == pytest.approx(4 * 20.0, rel=1e-4)
    luminance = float(light.to_xyz(np.array(red), "rec709")[1])
    assert second.irradiance == pytest.approx(16 * luminance, rel=1e-5)
    seen = light.from_xyz(light.white(second.spectrum), "rec709") * luminance
    np.testing.assert_allclose(seen, red, rtol=1e-4)
    pitch = lens.sensor[0] / 160
    disc = math.pi * (paraxial.focal_length(lens) * math.tan(second.angular_size / 2)) ** 2
    assert disc == pytest.approx(16 * pitch**2, rel=1e-6)


def test_found_lights_bring_the_light_that_is_there():
    lens = load("zeiss_biotar_50mm")
    generator = np.random.default_rng(5)
    pixels = (generator.random((90, 160, 3)) ** 40 * 50).astype(np.float32)
    luminance = light.to_xyz(pixels.astype(np.float64), "rec709")[..., 1]
    found = lights.find_lights(Picture(pixels), lens, 2.0, most=10_000)
    assert sum(source.irradiance for source in found) == pytest.approx(
        luminance[luminance > 2.0].sum(), rel=1e-4
    )


def test_near_regions_count_as_one_where_asked():
    lens = load("zeiss_biotar_50mm")
    picture = _picture((20, 30, 2, (9.0,) * 3), (20, 34, 2, (9.0,) * 3))
    assert len(lights.find_lights(picture, lens, 1.0)) == 2
    (one,) = lights.find_lights(picture, lens, 1.0, connect=4)
    assert lights.place_on_picture(lens, one, (90, 160)) == pytest.approx((33, 21))
    assert one.irradiance == pytest.approx(8 * 9.0, rel=1e-4)


def test_dark_pictures_have_no_lights_and_many_are_cut():
    lens = load("zeiss_biotar_50mm")
    assert lights.find_lights(_picture(), lens, 1.0) == []
    spots = [(10 * k, 10, 2, (k + 2.0,) * 3) for k in range(8)]
    found = lights.find_lights(_picture(*spots), lens, 1.0, most=3)
    assert [source.irradiance for source in found] == pytest.approx([36, 32, 28], rel=1e-4)


def test_the_white_is_the_lights_own_unless_they_differ_or_are_coloured():
    lamp, day = light.illuminant("A"), light.illuminant("D65")
    alike = [lights.light_at(0.1, spectrum=lamp), lights.light_at(0.2, spectrum=light.illuminant("A"))]
    assert lights.white_of(alike) is lamp
    assert lights.white_of([alike[0], lights.light_at(0.1, spectrum=day)]) is None
    assert lights.white_of([lights.light_at(0.1, spectrum=lights.colour_spectrum((1, 0.5, 0)))]) is None


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (
            lambda: lights.light_at(95 * DEGREE),
            r"'angle_x' must be less than 89 degrees to a side.*got 95\.",
        ),
        (lambda: lights.light_at(0.0, math.nan), r"'angle_y' must be a finite number, got nan\."),
        (
            lambda: lights.light_at(0.0, irradiance=-1.0),
            r"'irradiance' must be a finite number > 0, got -1\.",
        ),
        (lambda: lights.light_at(0.0, angular_size=-0.1), r"'angular_size' must be a number from 0 to"),
        (
            lambda: lights.colour_spectrum((1, -0.1, 0)),
            r"no negative part and some light, got \(1, -0\.1, 0\)",
        ),
        (lambda: lights.colour_spectrum((0, 0, 0)), r"no negative part and some light"),
        (lambda: lights.colour_spectrum((0, 1, 0), "rec2020"), r"more saturated"),
        (
            lambda: lights.find_lights(_picture(), load("zeiss_biotar_50mm"), 0.0),
            r"'threshold' must be a finite",
        ),
        (
            lambda: lights.checked(Light((0.0, 0.0, -1.0), light.illuminant("E"))),
            r"'direction' must be in front of the lens, less than 89 degrees off its axis, got 180\.",
        ),
        (
            lambda: lights.checked(Light((0.0, 0.0, 2.0), light.illuminant("E"))),
            r"'direction' must be a unit vector, got one of length 2\.",
        ),
    ],
)
def test_refusals(made, message):
    with pytest.raises(refuse.Refusal, match=message):
        made()
