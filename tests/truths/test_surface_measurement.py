"""A screen of known diffraction, photographed and measured, is the screen again."""

import numpy as np
import pytest

from aureole import light, surface
from aureole.light.differences import difference_2000, lab
from aureole.light.lookups import stretched_at
from aureole.surface import virtual

WAVELENGTH, STEP, SIZE, REACH = 530e-9, 4.8e-5, 500, 0.0118
CENTRE = (251.37, 247.82)
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
    ratios = WAVELENGTH / WAVELENGTHS
    scaled = weights() * ratios[:, None] ** 2
    found = stretched_at(surface.on_grid(pattern), ratios, scaled, -PLACES[::-1], PLACES, 2)
    seen = truth[..., 1] > 1e-4
    white = light.white(light.illuminant("E"))
    apart = difference_2000(lab(truth[seen], white), lab(found[seen].astype(float), white))
    return np.median(np.abs(found[..., 1] - truth[..., 1])[seen] / truth[..., 1][seen]), apart.mean()


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


def test_a_noisy_bracket_through_a_10_nm_filter_gives_it_within_three_percent(truth):
    band = virtual.gaussian_filter_spectrum(WAVELENGTH, 10e-9)
    photos = photographed(band)
    plain = errors(surface.measure_pattern(**photos), truth)
    assert plain[0] < 0.03
    sharp = errors(surface.measure_pattern(**photos, band=band, blur=1.0, power=2.0, iterations=3), truth)
    assert sharp[0] < 0.005
    assert sharp[1] < 0.25


def test_the_filters_width_is_undone(truth):
    band = virtual.gaussian_filter_spectrum(WAVELENGTH, 40e-9)
    photos = photographed(band)
    plain = errors(surface.measure_pattern(**photos), truth)
    sharp = errors(surface.measure_pattern(**photos, band=band, blur=1.0, power=2.0, iterations=4), truth)
    assert plain[0] > 0.02
    assert sharp[0] < 0.01
    assert sharp[1] < 0.5
