"""From spectrum to XYZ, and the weights of a spectral sum."""

import numpy as np
import pytest

from aureole import light, refuse

COUNTS = [1, 2, 3, 15, 59, 60, 401, 1601]
SPECTRA = [*light.ILLUMINANTS, "blackbody:2700K", "line:550nm"]


def narrow_band():
    """A light narrower than a nanometre of the table, off its grid."""
    return light.spectrum(np.array([532.1, 532.2, 532.3]) * 1e-9, [0.0, 1.0, 0.0])


def test_the_table_is_read_only():
    with pytest.raises(ValueError, match="read-only"):
        light.observer()[1][0, 0] = 1.0


@pytest.mark.parametrize("name", SPECTRA)
@pytest.mark.parametrize("count", COUNTS)
def test_weights_sum_to_the_white(name, count):
    made = light.illuminant(name)
    wavelengths, weights = light.quadrature(made, count)
    np.testing.assert_allclose(weights.sum(axis=0), light.white(made), rtol=1e-12)
    assert weights.shape == (wavelengths.size, 3)
    assert wavelengths.size <= count
    assert np.all(np.diff(wavelengths) > 0)
    assert weights.min() >= 0


@pytest.mark.parametrize("count", COUNTS)
def test_weights_keep_the_mean_wavelength(count):
    """Cells stand at their own mean, so the mean over all cells is that of the light."""
    whole, parts = (
        light.quadrature(light.illuminant("D65"), 1),
        light.quadrature(light.illuminant("D65"), count),
    )
    mean = parts[0] @ parts[1].sum(axis=1) / parts[1].sum()
    assert mean == pytest.approx(whole[0][0], rel=1e-6)


def test_cells_stay_in_the_range_except_for_the_tails():
    wavelengths, _ = light.quadrature(light.illuminant("E"), 60, 400e-9, 700e-9)
    assert 390e-9 < wavelengths[0] < 405e-9
    assert 695e-9 < wavelengths[-1] < 710e-9
    assert np.diff(wavelengths)[1:-1] == pytest.approx(5e-9, rel=0.05)


def test_a_narrow_light_gets_all_the_samples():
    wavelengths, weights = light.quadrature(narrow_band(), 8)
    assert wavelengths.size == 8
    assert 532.1e-9 < wavelengths[0] < wavelengths[-1] < 532.3e-9
    np.testing.assert_allclose(weights.sum(axis=0), light.white(light.line(532.2e-9)), rtol=1e-4)


def test_a_narrow_light_is_integrated_not_sampled():
    assert light.tristimulus(narrow_band())[1] == pytest.approx(0.1e-9 * 0.8849624, rel=1e-3)


def test_light_outside_the_range_is_kept():
    violet = light.spectrum([362e-9, 370e-9], [1.0, 1.0])
    wavelengths, weights = light.quadrature(violet, 4)
    assert 362e-9 < wavelengths[0] < wavelengths[-1] < 370e-9
    np.testing.assert_allclose(weights.sum(axis=0), light.white(violet), rtol=1e-12)


def test_lines_keep_their_own_wavelengths():
    lamp = light.spectrum([435.8e-9, 546.1e-9, 577.0e-9, 900e-9], [1.0, 2.0, 0.5, 9.0], "lines", "mercury")
    wavelengths, weights = light.quadrature(lamp, 60)
    assert wavelengths.tolist() == [435.8e-9, 546.1e-9, 577.0e-9]
    np.testing.assert_allclose(weights.sum(axis=0), light.white(lamp), rtol=1e-12)


def test_lines_are_interpolated_in_the_table():
    _, functions = light.observer()
    np.testing.assert_allclose(
        light.tristimulus(light.line(555.5e-9)), functions[195:197].mean(axis=0), rtol=1e-9
    )


def test_tristimulus_values_add_up():
    both = light.spectrum([450e-9, 600e-9], [0.25, 3.0], "lines")
    parts = 0.25 * light.tristimulus(light.line(450e-9)) + 3.0 * light.tristimulus(light.line(600e-9))
    np.testing.assert_allclose(light.tristimulus(both), parts, rtol=1e-14)


@pytest.mark.parametrize("made", [light.line(1000e-9), light.spectrum([840e-9, 900e-9], [1, 1], name="lamp")])
def test_what_nobody_sees_is_refused(made):
    assert light.tristimulus(made).tolist() == [0.0, 0.0, 0.0]
    for seen in (light.white, light.quadrature):
        with pytest.raises(refuse.Refusal, match="'spectrum' needs light between 360 and 830 nm"):
            seen(made)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"count": 0}, "'count' must be an integer >= 1, got 0."),
        ({"count": 60.0}, "'count' must be an integer >= 1, got 60."),
        ({"low": 0.0}, "'low' must be a finite number > 0, got 0."),
        ({"low": 7e-7, "high": 4e-7}, "'low' must be less than 'high', got 7e-07 and 4e-07."),
    ],
)
def test_wrong_ranges_are_refused(options, message):
    with pytest.raises(refuse.Refusal) as refusal:
        light.quadrature(light.illuminant("E"), **options)
    assert str(refusal.value) == message


def test_chromaticity_takes_pictures():
    xy = light.chromaticity(np.full((4, 5, 3), 2.0, dtype=np.float32))
    assert xy.shape == (4, 5, 2)
    np.testing.assert_allclose(xy, 1 / 3, rtol=1e-7)
