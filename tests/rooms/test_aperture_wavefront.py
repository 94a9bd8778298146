"""Wavefronts on openings: what carries them, what refuses them, what pixels do to a wave."""

import re

import numpy as np
import pytest

from aureole import Aperture, Grid, aperture, diffraction, light, refuse

DIAMETER, SIZE, WAVELENGTH = 3e-3, 64, 550e-9


def refused(message):
    return pytest.raises(refuse.Refusal, match=re.escape(message))


def blurred(**options):
    return aperture.with_wavefront(aperture.circle(DIAMETER), SIZE, **{"defocus": 2e-7, **options})


def grid_of(samples=16):
    return Grid((samples, samples), (1 / DIAMETER, 1 / DIAMETER))


def test_defocus_is_zero_on_the_axis_and_its_value_at_the_rim():
    shape = aperture.with_wavefront(aperture.circle(DIAMETER), 255, defocus=4e-7)
    assert shape.wavefront.dtype == np.float32
    assert shape.wavefront.shape == shape.mask.shape
    assert shape.wavefront[127, 127] == 0
    # The last pixel's centre lies at 254/255 of the radius.
    assert shape.wavefront[127, 254] == pytest.approx(4e-7 * (254 / 255) ** 2, rel=1e-5)
    assert np.all(shape.wavefront[shape.mask == 0] == 0)


def test_defocus_is_the_zernike_polynomial_but_for_piston():
    one, other = blurred(), blurred(defocus=0.0, terms={"defocus": 2e-7 / np.sqrt(12)})
    lit = one.mask > 0
    np.testing.assert_allclose(np.ptp((one.wavefront - other.wavefront)[lit]), 0, atol=1e-13)


def test_a_shift_of_focus_is_defocus():
    """W20 = δz / (8 N²)."""
    np.testing.assert_allclose(
        blurred(defocus=0.0, focus_shift=5e-5, f_number=8.0).wavefront,
        blurred(defocus=5e-5 / 512).wavefront,
        atol=1e-14,
    )


def test_terms_add_up_and_a_second_wavefront_adds_to_the_first():
    both = blurred(terms={(3, 1): 3e-8, "coma-y": -2e-8})
    radius = DIAMETER / 2
    first = aperture.with_wavefront(blurred(), SIZE, {"coma-x": 3e-8}, radius=radius)
    again = aperture.with_wavefront(first, SIZE, {(3, -1): -2e-8}, radius=radius)
    np.testing.assert_allclose(again.wavefront, both.wavefront, atol=1e-13)


def test_tilt_rises_to_the_right_and_upward():
    right = blurred(defocus=0.0, terms={"tilt-x": 1e-7}).wavefront
    up = blurred(defocus=0.0, terms={"tilt-y": 1e-7}).wavefront
    assert right[SIZE // 2, -4] > 0 > right[SIZE // 2, 3]
    assert up[3, SIZE // 2] > 0 > up[-4, SIZE // 2]


def test_the_disc_is_the_one_that_bounds_the_opening():
    assert aperture.bounding_radius(aperture.iris(7, DIAMETER)) == pytest.approx(DIAMETER / 2)
    assert aperture.bounding_radius(aperture.iris(6, DIAMETER, 0.7)) == pytest.approx(DIAMETER / 2)
    assert aperture.bounding_radius(aperture.rectangle(3.0, 4.0)) == pytest.approx(2.5)
    raster = aperture.from_mask(aperture.rasterize(aperture.circle(1.0), 256), 1.0)
    assert aperture.bounding_radius(raster) == pytest.approx(0.5, abs=1 / 256)
    given = blurred(radius=DIAMETER).wavefront
    np.testing.assert_allclose(given, blurred().wavefront / 4, atol=1e-13)


def test_a_wavefronts_root_mean_square():
    shape = aperture.with_wavefront(aperture.circle(1.0), 512, {"coma-x": 3e-8, "spherical": 4e-8})
    assert aperture.wavefront_rms(shape) == pytest.approx(5e-8, rel=2e-3)
    assert aperture.wavefront_rms(aperture.circle(1.0)) == 0


def test_what_pixels_do_to_a_wave():
    shape = blurred()
    wave = aperture.transmittance(shape, WAVELENGTH)
    np.testing.assert_allclose(np.abs(wave), shape.mask, atol=1e-12)
    lit = shape.mask > 0
    phase = 2 * np.pi * shape.wavefront[lit].astype(float) / WAVELENGTH
    np.testing.assert_allclose(np.angle(wave[lit] * np.exp(-1j * phase)), 0, atol=1e-9)
    flat = aperture.from_mask(shape.mask, DIAMETER)
    assert aperture.transmittance(flat) is flat.mask


def test_what_keeps_a_wavefront():
    shape = blurred()
    dim = aperture.dimmed(shape, 0.5)
    wide = aperture.scaled(shape, 3.0)
    hole = aperture.subtraction(shape, aperture.circle(1e-3))
    inner = aperture.intersection(shape, aperture.iris(5, DIAMETER))
    dirty = aperture.scratches(aperture.dust(shape, SIZE, 0.1, 3e-4, 1), SIZE, 3, 1e-3, 1e-4, 1)
    for each in (dim, wide, hole, inner, dirty):
        np.testing.assert_array_equal(each.wavefront, shape.wavefront)
    assert wide.width == 3 * DIAMETER
    twice = aperture.intersection(shape, shape)
    np.testing.assert_allclose(twice.wavefront, 2 * shape.wavefront, atol=1e-13)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: aperture.union(blurred(), aperture.circle(1e-3)), "a union cannot carry a wavefront"),
        (lambda: aperture.union(aperture.circle(1e-3), blurred()), "a union cannot carry a wavefront"),
        (
            lambda: aperture.subtraction(aperture.circle(DIAMETER), blurred()),
            "an obstruction cannot have a wavefront",
        ),
        (
            lambda: aperture.intersection(blurred(), aperture.from_mask(np.ones((99, 99)), DIAMETER)),
            "a wavefront of 64 pixels a side cannot be resampled to 99",
        ),
        (
            lambda: aperture.intersection(aperture.circle(1e-2), blurred()),
            "a wavefront of 64 pixels a side cannot be resampled to 213",
        ),
        (lambda: aperture.rotated(blurred(), 0.1), "a raster cannot be rotated exactly"),
        (lambda: aperture.moved(blurred(), 0.1, 0), "a raster cannot be moved exactly"),
        (lambda: aperture.dust(blurred(), 32, 0.1, 1e-3, 1), "cannot be resampled to 32"),
        (lambda: aperture.scratches(blurred(), 32, 1, 1e-3, 1e-4, 1), "cannot be resampled to 32"),
        (lambda: aperture.with_wavefront(blurred(), 32), "cannot be resampled to 'size' 32"),
        (
            lambda: aperture.with_wavefront(aperture.circle(1.0), 0),
            "'size' must be an integer >= 1, got 0.",
        ),
        (lambda: blurred(defocus=np.nan), "'defocus' must be a finite number, got nan."),
        (lambda: blurred(terms={(2, 0): np.inf}), "must be a finite number, got inf."),
        (
            lambda: blurred(terms={(3, 2): 1e-8}),
            "(3, 2) does not exist; for n = 3, m is one of -3, -1, 1, 3.",
        ),
        (lambda: blurred(terms={(-1, 0): 1e-8}), "'zernike n' must be an integer >= 0, got -1."),
        (lambda: blurred(terms={(400, 0): 1e-8}), "'zernike n' must be a number from 0 to 100, got 400."),
        (lambda: blurred(terms={(2, 0.0): 1e-8}), "'zernike m' must be an integer"),
        (
            lambda: blurred(terms={2: 1e-8}),
            "'zernike' must be orders (n, m) or a name such as 'coma-x', got 2.",
        ),
        (lambda: blurred(terms={"comma-x": 1e-8}), "Did you mean 'coma-x'?"),
        (lambda: blurred(focus_shift=1e-5), "'focus_shift' needs 'f_number'"),
        (lambda: blurred(focus_shift=1e-5, f_number=0), "'f_number' must be a finite number > 0, got 0."),
        (lambda: blurred(radius=0), "'radius' must be a finite number > 0, got 0."),
    ],
)
def test_what_refuses_a_wavefront(make, message):
    with refused(message):
        make()


def test_a_far_field_needs_the_wavelength():
    for method in ("auto", "reference", "chirpz", "fft"):
        with refused("'wavelength' is needed, in metres: this aperture has a wavefront."):
            diffraction.far_field(blurred(), grid_of(), method)
    with refused("'wavelength' must be a finite number > 0, got 0."):
        diffraction.far_power(blurred(), grid_of(), wavelength=0)
    # A flat wavefront has no use for it.
    flat = diffraction.far_field(aperture.circle(DIAMETER), grid_of(), wavelength=WAVELENGTH).amplitude
    np.testing.assert_array_equal(flat, diffraction.far_field(aperture.circle(DIAMETER), grid_of()).amplitude)


@pytest.mark.parametrize("method", ["polygons", "quads", "rows"])
def test_methods_of_real_transmittances_name_one_that_serves(method):
    with refused(
        f"method '{method}' takes real transmittances and this aperture has a wavefront; use 'chirpz'."
    ):
        diffraction.far_field(blurred(), grid_of(), method, wavelength=WAVELENGTH)


@pytest.mark.parametrize("method", ["scaled", "coherence"])
def test_starbursts_with_one_pattern_for_all_wavelengths_refuse(method):
    with refused("use method 'exact'"):
        diffraction.starburst(blurred(), Grid((8, 8), (1e-4, 1e-4)), light.illuminant("E"), method)


def test_a_progressive_field_refuses_and_stays_as_it_was():
    progressive = diffraction.ProgressiveFarField(grid_of())
    flat = aperture.from_mask(blurred().mask, DIAMETER)
    before = progressive.update(flat).amplitude.copy()
    with refused("this aperture has a wavefront; use 'far_field'"):
        progressive.update(blurred())
    np.testing.assert_array_equal(progressive.update(flat).amplitude, before)


def test_wavefronts_that_no_mask_or_raster_can_hold():
    mask = np.ones((8, 8), dtype=np.float32)
    with refused("an aperture's 'wavefront' needs a 'mask' of the same shape."):
        diffraction.far_field(
            Aperture(1.0, mask=mask, wavefront=np.zeros((4, 4), np.float32)), grid_of(), wavelength=1e-6
        )
    with refused("an aperture's 'wavefront' needs a 'mask' of the same shape."):
        outlines = aperture.circle(1.0).outlines
        diffraction.far_field(Aperture(1.0, outlines, wavefront=mask), grid_of(), wavelength=1e-6)
    with refused("'wavefront' must hold finite numbers, got 64 that are NaN or infinite."):
        diffraction.far_field(Aperture(1.0, mask=mask, wavefront=mask * np.nan), grid_of(), wavelength=1e-6)
    steep = aperture.with_wavefront(aperture.circle(1.0), 64, defocus=2e-5)
    with refused("the wavefront changes by 2.2"):
        diffraction.far_field(steep, grid_of(), wavelength=WAVELENGTH)
    with refused("outlines have no pixels; rasterize them first."):
        aperture.transmittance(aperture.circle(1.0))
