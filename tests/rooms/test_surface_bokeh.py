"""Bokeh: a known grating comes back, as sharp as the blur allows, and lenses say where they end."""

import numpy as np
import pytest
from scipy import ndimage

from aureole import refuse, surface

PIXEL = 0.083e-6
PERIOD = 1e-3 / 600


def facets(count=2130):
    return np.arange(count) * PIXEL / PERIOD % 1.0


def test_lines_of_the_papers_bokeh_give_its_pixel():
    """Appendix C: 106 lines of 600 a millimetre, 0.083 µm a pixel."""
    lines = surface.count_lines(0.1 + facets())
    assert lines == pytest.approx(2130 * PIXEL / PERIOD, abs=0.02)
    assert surface.pixel_pitch(lines, PERIOD, 2130) == pytest.approx(PIXEL, rel=1e-3)


def test_heights_are_fitted_exactly_where_brightness_is_affine():
    heights = facets(300) * 0.247e-6
    a, b, error = surface.fit_heights(0.2 + 3e6 * heights, heights)
    assert (a, b, error) == pytest.approx((1 / 3e6, 0.2, 0.0), abs=1e-12)


def test_sharpening_brings_the_facets_nearer_and_keeps_light():
    heights = facets(400) * 0.247e-6
    blurred = ndimage.gaussian_filter(np.tile(0.1 + heights / 0.247e-6, (9, 1)), (0, 1.5))
    errors = [surface.fit_heights(blurred[4], heights)[2]]
    for iterations in (10, 30, 100):
        sharp = surface.richardson_lucy(blurred, 1.5, iterations)
        assert sharp.min() >= 0.0
        assert sharp.sum() == pytest.approx(blurred.sum(), rel=1e-6)
        errors.append(surface.fit_heights(sharp[4], heights)[2])
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 0.8 * errors[0]


def test_a_bokeh_is_turned_and_blue():
    pixels = np.zeros((4, 6, 3))
    pixels[0, 5] = (1.0, 2.0, 3.0)
    upright = surface.bokeh_profile(pixels)
    assert upright.shape == (6, 4)
    assert upright[0, 0] == 3.0
    assert upright.sum() == 3.0


def test_the_papers_lens_shows_displays_and_no_discs():
    """250 mm at f/5.6 from 85 cm: 117 line pairs a millimetre."""
    limit = surface.abbe_limit(0.85, 0.25, 5.6)
    assert 1e-3 / limit == pytest.approx(117, abs=0.5)
    assert surface.abbe_note(24.8e-6, limit) is None
    assert "faintly" in surface.abbe_note(12e-6, limit)
    assert "cannot be seen" in surface.abbe_note(1.6e-6, limit)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: surface.bokeh_profile(-np.ones((3, 3))), "black level"),
        (lambda: surface.bokeh_profile(np.ones(3)), "shape"),
        (lambda: surface.richardson_lucy(np.ones((3, 3)), 0.0), "'deviation'"),
        (lambda: surface.fit_heights([1.0, 1.0], [0.0, 1.0]), "must vary"),
        (lambda: surface.count_lines(np.ones(20)), "vary"),
        (lambda: surface.abbe_limit(0.0, 0.25, 5.6), "'distance'"),
        (lambda: surface.multislit(0.1, 3e-6, 2e-6, 5, 5e-7), "at most the period"),
        (lambda: surface.grating("cdd"), "Did you mean 'cd'"),
        (lambda: surface.blazed_grating(600, 4e-6), "'wavelength' must be below"),
        (lambda: surface.table_from_height(np.zeros((4, 4))), "'pixel' is needed"),
        (lambda: surface.table_from_height(np.full((4, 4), 2.0), 1e-7, method="amplitude"), "reflectances"),
        (lambda: surface.table_from_grating("cd", zero_order="gone"), "'zero_order' must be one of"),
    ],
)
def test_what_cannot_be_is_refused(ask, message):
    with pytest.raises(refuse.Refusal, match=message):
        ask()
