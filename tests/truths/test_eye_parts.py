"""The eye's parts on pixels: areas in closed form, far fields of exact outlines, rings where they belong."""

import math

import numpy as np
import pytest
import scipy.fft
from scipy.special import jv

from aureole import Aperture, Grid, aperture, diffraction, glare
from aureole.aperture.fibres import fibre_outlines
from aureole.records import Outline

SIZE, WIDTH = 256, 1e-3
PIXEL = WIDTH / SIZE
GREEN = 568e-9


def discs(*places):
    table = np.array(places, dtype=float)
    return aperture.Discs(table[:, :2], table[:, 2])


def apart(radius, gap, seed=3):
    """Discs of a radius at random places, none nearer to another than the gap."""
    centres = []
    for centre in aperture.scattered(40, radius, 0.4e-3, seed).centres:
        if all(math.dist(centre, other) > 2 * radius + gap for other in centres):
            centres.append(centre)
    return aperture.Discs(np.array(centres), np.full(len(centres), radius))


def assert_far_field(mask, outlines, width, tolerance):
    """The mask's far field over both sincs of its pixels is the outlines', up to half its highest frequency.

    One sinc is that of the raster's squares, the other that of the means over them.
    """
    pixel, count = width / len(mask), 33
    step = 0.5 / pixel / count
    grid = Grid((count, count), (step, 1.01 * step))
    of_pixels = diffraction.far_field(Aperture(width, mask=mask), grid).amplitude
    exact = diffraction.far_field(Aperture(width, outlines), grid, "polygons").amplitude
    v, u = grid.axes()
    found = of_pixels / (np.sinc(v * pixel)[:, None] * np.sinc(u * pixel)) ** 2
    error = np.sum(np.abs(found - exact) ** 2) / np.sum(np.abs(exact) ** 2)
    assert math.sqrt(error) < tolerance
    # The outermost frequencies, weak as they are, hold the right power, too.
    outer = np.s_[:6]
    assert np.sum(np.abs(found[outer]) ** 2) == pytest.approx(np.sum(np.abs(exact[outer]) ** 2), rel=0.03)


def azimuthal_mean(mask, width, low, high, step):
    """Mean power of a real mask over rings of equal breadth in degrees at 568 nm, and their middles."""
    size = len(mask)
    power = np.abs(scipy.fft.rfft2(mask)) ** 2
    v, u = np.meshgrid(
        scipy.fft.fftfreq(size, width / size), scipy.fft.rfftfreq(size, width / size), indexing="ij"
    )
    angle = np.degrees(GREEN * np.hypot(u, v))
    rings = ((angle - low) // step).astype(int)
    inside = (rings >= 0) & (rings < round((high - low) / step))
    mean = np.bincount(rings[inside], power[inside]) / np.bincount(rings[inside])
    return mean, low + step * (np.arange(len(mean)) + 0.5)


@pytest.mark.parametrize("radius", [0.1, 0.45, 0.8, 1.6, 7.3, 60.0])
def test_a_disc_covers_its_area_wherever_it_lies(radius):
    for x, y in ((0.0, 0.0), (10.3, -4.7), (0.5, 0.5), (-3.99, 2.01)):
        covered = aperture.disc_coverage(discs((x * PIXEL, y * PIXEL, radius * PIXEL)), SIZE, WIDTH)
        assert covered.sum(dtype=float) == pytest.approx(math.pi * radius**2, rel=3e-6)
        assert covered.min() >= 0
        assert covered.max() <= 1
        columns, rows = covered.sum(axis=0), covered.sum(axis=1)
        # The centre of a disc shows to a part of a pixel that is none for large ones.
        middle = (
            np.array([columns @ np.arange(SIZE), rows @ np.arange(SIZE)]) / covered.sum() + 0.5 - SIZE / 2
        )
        assert np.abs(middle - [x, y]).max() <= (0.5 if radius < 0.5 else 0.1 / radius)


def test_each_pixel_of_a_disc_is_as_covered_as_many_points_say():
    x, y, radius = 3.3, -1.2, 5.7
    covered = aperture.disc_coverage(discs((x, y, radius)), 16, 16.0)
    points = (np.arange(16 * 64) + 0.5) / 64 - 8
    inside = np.hypot(points[None, :] - x, points[:, None] - y) < radius
    counted = inside.reshape(16, 64, 16, 64).mean(axis=(1, 3))
    np.testing.assert_allclose(covered, counted, atol=2e-3)


def test_a_disc_that_the_square_cuts_leaves_its_half():
    covered = aperture.disc_coverage(discs((-WIDTH / 2, 0, 20 * PIXEL)), SIZE, WIDTH)
    assert covered.sum(dtype=float) == pytest.approx(math.pi * 200, rel=1e-6)
    assert not aperture.disc_coverage(discs((WIDTH, 0, 20 * PIXEL)), SIZE, WIDTH).any()


def test_many_discs_at_random_cover_one_less_the_exponential_of_their_area():
    lot = aperture.scattered(4000, 6e-6, WIDTH, 5)
    covered = float(aperture.disc_coverage(lot, SIZE, WIDTH).mean())
    # 4000 discs on a round field of twice the square's width.
    area = 4000 * math.pi * 6e-6**2 / (math.pi * WIDTH**2)
    assert covered == pytest.approx(1 - math.exp(-area), rel=0.03)


def test_discs_and_rings_of_discs_spread_light_alike():
    lot = apart(20e-6, 8e-6)
    assert_far_field(aperture.disc_coverage(lot, SIZE, WIDTH), aperture.disc_outlines(lot, 1.0), WIDTH, 0.015)


def test_discs_of_a_few_pixels_spread_light_as_their_rings_do():
    lot = apart(6e-6, 8e-6)
    assert_far_field(aperture.disc_coverage(lot, SIZE, WIDTH), aperture.disc_outlines(lot, 1.0), WIDTH, 0.04)


@pytest.mark.parametrize("kind", [{"count": 24}, {"width": 60e-6, "shell": 0.1e-3}])
def test_gratings_and_their_wedges_spread_light_alike(kind):
    made = aperture.fibres((0.2e-3, 0.4e-3), seed=4, **kind)
    assert_far_field(aperture.fibre_coverage(made, SIZE, WIDTH), fibre_outlines(made), WIDTH, 0.015)


def test_one_lash_spreads_light_as_its_outline_does():
    size, width = 512, 8e-3
    hanging = [
        one for one in aperture.lashes(6, 0.35, 120e-6, 0.6, 3) if np.abs(one.vertices).max() < width / 2
    ]
    lash = Outline(hanging[0].vertices, hanging[0].bulges)
    assert_far_field(aperture.lash_coverage([lash], size, width), (lash,), width, 0.03)


@pytest.mark.parametrize("size", [255, 256])
def test_half_of_an_annulus_is_covered_by_its_fibres(size):
    for made in (aperture.fibres((0.2e-3, 0.4e-3), count=50), aperture.fibres((0.2e-3, 0.4e-3), width=8e-6)):
        covered = aperture.fibre_coverage(made, size, WIDTH)
        area = covered.sum(dtype=float) * (WIDTH / size) ** 2
        assert area == pytest.approx(math.pi / 2 * (0.4e-3**2 - 0.2e-3**2), rel=1e-4)
        assert covered.min() >= 0
        assert covered.max() <= 1


def test_each_pixel_of_a_grating_is_as_covered_as_many_points_say():
    made = aperture.fibres((15.0, 29.0), count=40, seed=2)
    covered = aperture.fibre_coverage(made, 64, 64.0)
    points = (np.arange(64 * 32) + 0.5) / 32 - 32
    x, y = points[None, :], points[:, None]
    turn = np.arctan2(-y, x) / (2 * np.pi) * 40 - made.phases[0]
    inside = (turn % 1 < 0.5) & (np.hypot(x, y) > 15) & (np.hypot(x, y) < 29)
    counted = inside.reshape(64, 32, 64, 32).mean(axis=(1, 3))
    # Bars that narrow towards the middle are parallel in a pixel to the second order.
    np.testing.assert_allclose(covered, counted, atol=0.03)
    assert np.abs(covered - counted).mean() < 2e-3


@pytest.mark.parametrize("size", [63, 64])
def test_a_square_that_cuts_the_fibres_shows_the_middle_of_a_larger_one(size):
    made = aperture.fibres((15.0, 60.0), width=5.0, shell=15.0)
    whole = aperture.fibre_coverage(made, size + 128, size + 128.0)
    middle = aperture.fibre_coverage(made, size, float(size))
    np.testing.assert_allclose(middle, whole[64:-64, 64:-64], atol=1e-6)
    assert not aperture.fibre_coverage(made, 16, 16.0).any()


def test_pixels_beyond_the_reach_are_left_out():
    made = aperture.fibres((15.0, 30.0), count=40)
    near, whole = (aperture.fibre_coverage(made, 64, 64.0, reach) for reach in (20.0, math.inf))
    distance = np.hypot(*np.meshgrid(*[np.arange(64) - 31.5] * 2))
    np.testing.assert_allclose(near[distance < 19.3], whole[distance < 19.3], atol=1e-12)
    assert not near[distance > 20].any()


def test_a_ring_of_bars_sends_light_where_its_bessel_function_is_largest():
    count, outer = 40, 0.4e-3
    made = aperture.fibres((0.3e-3, outer), count=count)
    mean, middles = azimuthal_mean(aperture.fibre_coverage(made, 512, WIDTH), WIDTH, 0.4, 1.6, 0.04)
    order = np.linspace(count, 1.2 * count, 2001)
    largest = order[np.argmax(jv(count, order))]
    assert largest == pytest.approx(count * (1 + 0.81 * count ** (-2 / 3)), rel=1e-3)
    assert middles[np.argmax(mean)] == pytest.approx(
        math.degrees(GREEN * largest / (2 * math.pi * outer)), rel=0.06
    )


def test_real_fibres_make_a_ring_at_three_degrees_behind_a_wide_pupil():
    """10.2 µm at 568 nm is 3.19°; the annulus is 2.25 to 4 mm, a pupil of 7 mm leaves it up to 3.5 mm."""
    state = glare.EyeState(eye=glare.Eye(particles=0.0, lashes=0), pupil_diameter=7e-3)
    parts = glare.eye_parts(state, 2048, 7.2e-3)
    mean, middles = azimuthal_mean(parts["bloom"] * parts["halo"], 7.2e-3, 2.5, 3.9, 0.05)
    assert 3.0 < middles[np.argmax(mean)] < 3.3
    ring, outside = (middles > 3.05) & (middles < 3.3), (middles < 3.0) | (middles > 3.5)
    assert mean[ring].min() > 50 * mean[outside].max()
    # A square grating of depth m sends 2 (m / π)² of its light into both first orders.
    annulus = (3.5**2 - 2.25**2) / 3.5**2
    assert 2 * (state.eye.fibre_depth / math.pi) ** 2 * annulus == pytest.approx(0.004, rel=0.1)


def test_a_small_pupil_shows_no_fibres():
    state = glare.EyeState(eye=glare.Eye(lashes=0), pupil_diameter=3e-3)
    assert not glare.eye_parts(state, 512, 3.3e-3)["halo"].any()


def test_the_200_gratings_of_temporal_glare_make_a_ring_at_a_third_of_a_degree():
    """94 µm apart at a rim of 3 mm, 568 nm: 0.35° (preset `ritschel-2009`)."""
    state = glare.EyeState(eye=glare.eye_named("ritschel-2009"), pupil_diameter=7e-3)
    parts = glare.eye_parts(state, 512, 8e-3)
    mean, middles = azimuthal_mean(parts["bloom"] * parts["halo"], 8e-3, 0.2, 0.6, 0.01)
    assert middles[np.argmax(mean)] == pytest.approx(0.35, abs=0.03)
