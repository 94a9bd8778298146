"""A screen of known diffraction, photographed and measured, is the screen again."""

import math

import numpy as np
import pytest

from aureole import light, surface
from aureole.light.differences import difference_2000, lab
from aureole.light.lookups import stretched_at
from aureole.surface import virtual
from aureole.surface.table import axes

WAVELENGTH, STEP, SIZE, REACH = 530e-9, 4.8e-5, 400, 0.0094
CENTRE = (201.37, 197.82)
EXPOSURES = [1.0, 4.0, 16.0, 64.0, 256.0, 1024.0]
SCREEN = surface.lcd_screen()
GEOMETRY = surface.UniformGeometry(STEP)
# The wavelengths of the paper's sums, and a table's places where every one of them was photographed.
WAVELENGTHS = np.linspace(380e-9, 780e-9, 81)
PLACES = 2.0 * np.linspace(-1, 1, 1025) ** 5
PLACES = PLACES[np.abs(PLACES) <= REACH * 380 / 530]


def weights():
    positions, functions = light.observer()
    found = np.stack([np.interp(WAVELENGTHS, positions, part) for part in functions.T], axis=1)
    return found / found[:, 1].sum()


@pytest.fixture(scope="module")
def truth():
    """Eq. 12 itself: the screen's own diffraction at each wavelength, added up."""
    planes = (SCREEN(PLACES[None, :], -PLACES[:, None], wavelength) for wavelength in WAVELENGTHS)
    return sum(plane[..., None] * share for plane, share in zip(planes, weights(), strict=True))


def errors(pattern, truth):
    """Median relative error of Y, and mean ΔE00, where Y is above 1e-4."""
    ratios = pattern.wavelength / WAVELENGTHS
    scaled = weights() * ratios[:, None] ** 2
    found = stretched_at(surface.on_grid(pattern), ratios, scaled, -PLACES[::-1], PLACES, 2)
    return apart(found.astype(float), truth)


def apart(found, truth):
    seen = truth[..., 1] > 1e-4
    white = light.white(light.illuminant("E"))
    colours = difference_2000(lab(truth[seen], white), lab(found[seen], white))
    return np.median(np.abs(found[..., 1] - truth[..., 1])[seen] / truth[..., 1][seen]), colours.mean()


def photographed(band, blur=1.0):
    camera = surface.VirtualCamera(blur=blur)
    scene = virtual.radiance(SCREEN, band, GEOMETRY, (SIZE, SIZE), CENTRE)
    full = 0.9 * (camera.saturation - camera.black)
    return {
        "photos": surface.photograph(0.9 * scene, EXPOSURES, camera, seed=3),
        "exposures": [full * value for value in EXPOSURES],
        "geometry": GEOMETRY,
        "wavelength": WAVELENGTH,
        "black": "estimate",
        "saturation": camera.saturation,
        "read_noise": camera.read_noise / camera.gain,
        "gain": camera.gain,
        "irradiance": 1 / (4 * np.pi**2),
    }


def test_an_ideal_photograph_gives_the_screen_to_half_a_percent(truth):
    scene = virtual.radiance(SCREEN, light.line(WAVELENGTH), GEOMETRY, (SIZE, SIZE), CENTRE)
    pattern = surface.measure_pattern(scene, 1.0, GEOMETRY, WAVELENGTH, irradiance=1 / (4 * np.pi**2))
    luminance, colour = errors(pattern, truth)
    assert luminance < 0.003
    assert colour < 0.12


BAND = virtual.gaussian_filter_spectrum(WAVELENGTH, 10e-9)


@pytest.fixture(scope="module")
def noisy():
    return photographed(BAND)


def test_a_noisy_bracket_through_a_10_nm_filter_gives_it_within_three_percent(noisy, truth):
    assert errors(surface.measure_pattern(**noisy), truth)[0] < 0.03


def test_the_whole_way_to_a_table_of_who_knows_the_filter_but_not_the_lens_is_as_exact(noisy, truth):
    stages = list(surface.table_from_photo_stages(**noisy, band=BAND, model="amplitude", table_size=1025))
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert fractions[0] == 0.0
    assert fractions[-1] == 1.0
    assert all(stage.result is None for stage in stages[:-1])
    table = stages[-1].result
    h_b, h_t = axes(table)
    np.testing.assert_allclose(h_t[np.abs(h_t) <= PLACES[-1]], PLACES, atol=1e-12)
    found = table.values[np.ix_(np.abs(h_b) <= PLACES[-1], np.abs(h_t) <= PLACES[-1])].astype(float)
    luminance, colour = apart(found, truth)
    assert luminance < 0.02
    assert colour < 0.6
    (said,) = table.metadata["patterns"]
    assert math.hypot(*np.subtract(said["centre"], CENTRE)) < 0.2
    assert said["period"] == pytest.approx([74.27e-6, 74.27e-6], rel=2e-3)
    assert said["notes"] == []


def test_a_wrong_wavelength_and_a_wrong_centre_cost_what_they_cost_and_are_noted(truth):
    photos = photographed(light.line(WAVELENGTH), blur=0.0)
    right = errors(surface.measure_pattern(**photos), truth)[0]
    off = errors(surface.measure_pattern(**{**photos, "wavelength": WAVELENGTH + 5e-9}), truth)[0]
    assert off > 2 * right
    away = surface.measure_pattern(**photos, centre=(CENTRE[0] + 3.0, CENTRE[1]))
    assert errors(away, truth)[0] > 0.1
    assert "check 'centre'" in away.metadata["notes"][0]
    told = surface.measure_pattern(**{**photos, "wavelength": WAVELENGTH + 5e-9}, period=74.27e-6)
    assert "too large" in told.metadata["notes"][0]


def test_the_filters_width_is_undone(truth):
    band = virtual.gaussian_filter_spectrum(WAVELENGTH, 40e-9)
    photos = photographed(band)
    plain = errors(surface.measure_pattern(**photos), truth)
    sharp = errors(surface.measure_pattern(**photos, band=band, blur=1.0, power=2.0, iterations=3), truth)
    assert plain[0] > 0.02
    assert sharp[0] < 0.01
    assert sharp[1] < 0.5
