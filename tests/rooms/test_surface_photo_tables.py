"""Tables of measured patterns: zero orders that stay white, mixed bands, a colour photograph's channels."""

import numpy as np
import pytest

from aureole import light, refuse, surface
from aureole.light.spectra import spectrum
from aureole.surface import virtual

STEP, SIZE, CENTRE = 4e-4, 121, (61.3, 58.6)
GEOMETRY = surface.UniformGeometry(STEP)


def lobe(width, height, half_range=0.05, size=201, wavelength=530e-9):
    """A zero order of a known width on an even ground."""
    h = np.linspace(-half_range, half_range, size)
    values = height * np.exp(-0.5 * (h[:, None] ** 2 + h**2) / width**2) + 1.0
    return surface.diffraction_pattern(values, half_range, wavelength)


@pytest.mark.parametrize("illuminant", ["E", "A"])
@pytest.mark.parametrize("model", ["phase", "amplitude"])
def test_a_specular_zero_order_is_a_white_share_of_the_light(illuminant, model):
    table = surface.table_from_measured(
        lobe(0.004, 100.0), illuminant, model=model, zero_order="specular", zero_radius=0.02, table_size=65
    )
    share = 4 * np.pi**2 * 100.0 * 2 * np.pi * 0.004**2
    white = light.white(light.illuminant(illuminant))
    np.testing.assert_allclose(table.metadata["zero_order_energy"], share * white, rtol=2e-3)
    assert table.metadata["zero_order_width"] == pytest.approx(0.004, rel=0.01)
    assert table.zero_order == "specular"
    # What is left is the ground alone.
    kept = surface.table_from_measured(lobe(0.004, 0.0), illuminant, model=model, table_size=65)
    np.testing.assert_allclose(table.values, kept.values, rtol=1e-3, atol=1e-6)


def test_a_removed_zero_order_leaves_no_energy_behind():
    table = surface.table_from_measured(
        lobe(0.004, 100.0), zero_order="remove", zero_radius=0.02, table_size=65
    )
    assert "zero_order_energy" not in table.metadata
    assert table.zero_order == "remove"


def test_bands_zero_orders_are_mixed_over_wavelength():
    bands = [lobe(0.004, 50.0, wavelength=480e-9), lobe(0.004, 100.0, wavelength=620e-9)]
    mixed = surface.table_from_measured(
        bands, "line:550nm", zero_order="specular", zero_radius=0.02, table_size=65
    )
    half_way = 4 * np.pi**2 * 75.0 * 2 * np.pi * 0.004**2
    assert mixed.metadata["zero_order_energy"][1] == pytest.approx(half_way, rel=2e-3)
    assert len(mixed.metadata["patterns"]) == 2


def test_two_bands_follow_a_pattern_that_changes_with_wavelength_where_one_cannot():
    def pattern(wavelength):
        # An order whose strength rises linearly with wavelength.
        h = np.linspace(-0.1, 0.1, 401)
        row = np.exp(-0.5 * ((h - wavelength / 1e-5) / 0.006) ** 2) * (wavelength / 500e-9 - 0.5)
        return surface.diffraction_pattern(row[None, :] * np.ones((401, 1)), 0.1, wavelength)

    truth = surface.table_from_measured(pattern(550e-9), "line:550nm", model="amplitude", table_size=257)
    ends = [pattern(500e-9), pattern(600e-9)]
    both = surface.table_from_measured(ends, "line:550nm", model="amplitude", table_size=257)
    one = surface.table_from_measured(ends[0], "line:550nm", model="amplitude", table_size=257)
    place = surface.lookup(truth, 0.055, 0.0)[1]
    assert surface.lookup(both, 0.055, 0.0)[1] == pytest.approx(place, rel=0.05)
    assert surface.lookup(one, 0.055, 0.0)[1] < 0.8 * place


def colour_photo(curves, size=SIZE):
    """A screen as the three channels of a camera show it under E."""
    screen = surface.lcd_screen(pitch=40e-6, width=12e-6, count=5)
    channels = []
    for curve in curves:
        places = np.linspace(400e-9, 720e-9, 65)
        values = np.interp(places, curve.wavelengths, curve.values) * np.diff(places)[0]
        band = spectrum(places, values, "lines")
        channels.append(virtual.radiance(screen, band, GEOMETRY, (size, size), CENTRE))
    return np.stack(channels, axis=-1), screen


def test_a_colour_photographs_channels_are_patterns_at_their_own_wavelengths():
    curves = surface.assumed_sensitivities()
    photo, screen = colour_photo(curves)
    found = surface.measure_channels(
        photo, 1.0, GEOMETRY, "E", power=2.0, blur=0.0, iterations=12, irradiance=1 / (4 * np.pi**2)
    )
    plain = surface.measure_channels(
        photo, 1.0, GEOMETRY, "E", power=2.0, blur=0.0, iterations=1, irradiance=1 / (4 * np.pi**2)
    )
    assert [1e9 * pattern.wavelength for pattern in found] == pytest.approx([600, 535, 460], abs=3)
    for sharp, dull in zip(found, plain, strict=True):
        assert sharp.metadata["sensitivities"] == "assumed"
        h = np.linspace(-sharp.half_range, sharp.half_range, sharp.values.shape[0])
        seen = np.abs(h) < 0.02
        inside = np.ix_(seen, seen)
        truth = screen(h[None, :], h[::-1, None], sharp.wavelength)[inside]
        errors = [np.abs(pattern.values[inside] - truth).sum() / truth.sum() for pattern in (sharp, dull)]
        assert errors[0] < 0.2
        assert errors[0] < 0.6 * errors[1]


def test_the_cameras_own_sensitivities_and_white_are_used():
    curves = surface.assumed_sensitivities()
    photo, _ = colour_photo(curves)
    tinted = photo * np.array([0.5, 1.0, 2.0])
    how = {"geometry": GEOMETRY, "sensitivities": curves, "blur": 0.0, "iterations": 2}
    right = surface.measure_channels(photo, 1.0, **how)
    found = surface.measure_channels([tinted], [1.0], white=(0.5, 1.0, 2.0), **how)
    for one, other in zip(right, found, strict=True):
        np.testing.assert_allclose(one.values, other.values, rtol=1e-4, atol=1e-9)
        assert one.metadata["sensitivities"] == "given"


def test_channels_that_cannot_be_measured_are_refused():
    photo = np.ones((20, 20, 3))
    with pytest.raises(refuse.Refusal, match="three each"):
        surface.measure_channels(photo, 1.0, GEOMETRY, white=(1.0, 1.0))
    with pytest.raises(refuse.Refusal, match="photos"):
        surface.measure_channels(np.ones((20, 20)), 1.0, GEOMETRY)
    red = light.spectrum([700e-9, 720e-9], [1.0, 1.0])
    with pytest.raises(refuse.Refusal, match="No light passes"):
        surface.band_of(light.illuminant("line:550nm"), red)
    with pytest.raises(refuse.Refusal, match="power"):
        surface.table_from_photo(np.ones((20, 20)), 1.0, GEOMETRY, 530e-9, power=2.0)


def test_a_band_is_the_product_of_lamp_filter_and_sensor():
    lamp = light.spectrum([400e-9, 700e-9], [1.0, 2.0])
    glass = light.spectrum([500e-9, 550e-9, 600e-9], [0.0, 1.0, 0.0])
    band = surface.band_of(lamp, glass)
    assert np.interp(550e-9, band.wavelengths, band.values) == pytest.approx(1.5)
    assert band.values[0] == band.values[-1] == 0.0
    lines = surface.band_of(lamp, light.line(550e-9))
    assert lines.kind == "lines"
    assert lines.values == pytest.approx([1.5])
