"""The progressive near field: what it counts, what it keeps, what it refuses."""

import re

import numpy as np
import pytest

from aureole import Aperture, Grid, aperture, refuse
from aureole.diffraction import ProgressiveNearField, near_field, paint

WIDTH = 2e-3
WAVELENGTH = 550e-9
GRID = Grid((20, 21), (1e-4, 1.1e-4))


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def opening(size=16, seed=1):
    rng = np.random.default_rng(seed)
    return Aperture(WIDTH, mask=rng.integers(0, 2, (size, size)).astype(np.float32))


def begun(**options):
    return ProgressiveNearField(GRID, 0.2, WAVELENGTH, **options)


def test_the_quads_of_an_update_paint_the_difference():
    progressive = begun()
    old, new = opening(24, 1), opening(24, 2)
    progressive.update(old)
    progressive.update(new)
    positive, negative = progressive.quads()
    np.testing.assert_array_equal(paint(positive, 24, WIDTH), np.maximum(new.mask - old.mask, 0))
    np.testing.assert_array_equal(paint(negative, 24, WIDTH), np.maximum(old.mask - new.mask, 0))
    assert progressive.evaluated == (len(positive), len(negative))


def test_no_change_evaluates_nothing_and_changes_no_bit():
    progressive = begun()
    before = progressive.update(opening()).amplitude.copy()
    after = progressive.update(opening()).amplitude
    assert progressive.evaluated == (0, 0)
    np.testing.assert_array_equal(before, after)


def test_outlines_are_rasterized():
    heptagon = aperture.iris(7, WIDTH)
    mask = aperture.from_mask(aperture.rasterize(heptagon, 40), WIDTH)
    found = begun(raster_size=40).update(heptagon).amplitude
    wanted = near_field(mask, GRID, 0.2, WAVELENGTH, "reference").amplitude
    np.testing.assert_allclose(found, wanted, rtol=0, atol=3e-6)


def test_the_running_arrays_are_not_to_be_written():
    progressive = begun()
    field = progressive.update(opening())
    for array in (field.amplitude, progressive.power()):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1


def test_what_does_not_fit_is_refused_and_changes_nothing():
    for arguments, message in (
        ((GRID, 0.0, WAVELENGTH), "'distance' must be a finite number > 0, got 0."),
        ((GRID, 0.1, np.nan), "'wavelength' must be a finite number > 0, got nan."),
        ((Grid((0, 8), (1.0, 1.0)), 0.1, WAVELENGTH), "'grid rows' must be an integer >= 1, got 0."),
    ):
        with refused(message):
            ProgressiveNearField(*arguments)
    progressive = begun()
    before = progressive.update(opening()).amplitude.copy()
    flat = np.zeros((16, 16), np.float32)
    for shape, message in (
        (
            Aperture(2 * WIDTH, mask=opening().mask),
            "'aperture' must be 0.002 m wide as the first one, got 0.004 m; begin another "
            "ProgressiveNearField for another width.",
        ),
        (
            opening(17),
            "'aperture' must have 16 x 16 pixels as the first one, got 17 x 17; begin another "
            "ProgressiveNearField for another size.",
        ),
        (
            Aperture(WIDTH, mask=opening().mask, wavefront=flat),
            "ProgressiveNearField takes real transmittances and this aperture has a wavefront; use "
            "'near_field', which takes a wavelength.",
        ),
    ):
        with refused(message):
            progressive.update(shape)
    np.testing.assert_array_equal(progressive.update(opening()).amplitude, before)
