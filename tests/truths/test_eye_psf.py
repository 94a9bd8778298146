"""The eye's point spread function against CIE 135, the Airy disc, and its energy kept whole."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import j0, j1

from aureole import light
from aureole.glare import Eye, EyeState, component_psfs, eye_named, eye_psf, veil

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
CLEAN = Eye(particles=0, lashes=0, fibre_depth=0)


def angles_of(psf):
    """Return each pixel's angle in degrees and its solid angle."""
    rows, columns = psf.pixels.shape[:2]
    step = psf.metadata["degrees_per_pixel"]
    angle = np.hypot((np.arange(rows) - rows // 2)[:, None], np.arange(columns) - columns // 2) * step
    return angle, math.radians(step) ** 2 * np.sinc(np.radians(angle) / np.pi)


def over_cie(psf, age, edges):
    """Return the mean over rings between angles in degrees, over that of CIE 135."""
    angle, area = angles_of(psf)
    rings = np.digitize(angle.ravel(), edges)
    found = np.bincount(rings, (psf.pixels @ LUMINANCE).ravel(), len(edges) + 1)
    glare = (veil.cie_135(np.radians(angle), age) * area).ravel()
    return (found / np.bincount(rings, glare, len(edges) + 1))[1:-1]


@pytest.mark.parametrize("age", [25, 70])
def test_the_mean_over_rings_is_within_a_factor_of_two_of_cie_135(age):
    state = EyeState(Eye(age=age), pupil_diameter=3.7e-3)
    wide = over_cie(eye_psf(state, (512, 512), math.radians(64)), age, np.geomspace(0.5, 30, 12))
    assert np.all((wide > 0.5) & (wide < 2))
    narrow = over_cie(
        eye_psf(state, (320, 320), math.radians(6.4), tail=False), age, np.geomspace(0.1, 3, 12)
    )
    assert np.all((narrow > 0.5) & (narrow < 2))


@pytest.mark.parametrize(("age", "diameter", "shape"), [(25, 3e-3, (180, 180)), (70, 6e-3, (91, 91))])
def test_each_channel_holds_the_whole_energy_over_the_hemisphere(age, diameter, shape):
    state = EyeState(Eye(age=age), pupil_diameter=diameter)
    psf = eye_psf(state, shape, math.pi, size=1024)
    np.testing.assert_allclose(psf.pixels.sum(axis=(0, 1), dtype=float), 1, atol=1e-3)
    assert psf.pixels.min() >= 0


@pytest.mark.parametrize(
    ("field", "side", "radii"), [(0.25, 129, (1, 2, 3.8, 7, 13)), (1.5, 128, (3.8, 13, 26))]
)
def test_a_clean_eye_makes_an_airy_disc(field, side, radii):
    wavelength, diameter = 550e-9, 3e-3
    state = EyeState(CLEAN, pupil_diameter=diameter)
    psf = eye_psf(state, (side, side), math.radians(field), light.line(wavelength), tail=False)
    angle, area = angles_of(psf)
    v, green = math.pi * diameter / wavelength * np.sin(np.radians(angle)), psf.pixels[..., 1]
    for radius in radii:
        # Rayleigh's encircled energy; a pixel on the rim counts by its middle.
        expected = 1 - j0(radius) ** 2 - j1(radius) ** 2
        assert float(green[v < radius].sum()) == pytest.approx(expected, abs=0.01)
    if field < 1:
        density = (j1(np.maximum(v, 1e-9)) / np.maximum(v, 1e-9)) ** 2 * math.pi * diameter**2 / wavelength**2
        # Over a pixel the mean of the peak is 1.4 % below it.
        np.testing.assert_allclose(green, density * area, atol=0.015 * green.max())


def contrast_of_halo(eye, diameter, low, high, side, field):
    """Return rings' middles in degrees, and by what part fibres brighten them at 568 nm."""
    edges = np.linspace(low, high, 25)
    means = []
    for one in (eye, replace(eye, fibre_depth=0.0)):
        state = EyeState(one, pupil_diameter=diameter)
        psf = eye_psf(state, (side, side), math.radians(field), light.line(568e-9), tail=False, size=2048)
        means.append(over_cie(psf, eye.age, edges))
    return (edges[1:] + edges[:-1]) / 2, means[0] / means[1] - 1


def test_real_fibres_make_a_halo_of_three_degrees_in_wide_pupils_alone():
    # Fibres of 10.2 µm from 2.25 to 4.0 mm: λ / width is 3.19 degrees.
    middles, contrast = contrast_of_halo(Eye(), 7e-3, 2.5, 4.0, 301, 8.4)
    assert 3.0 < middles[np.argmax(contrast)] < 3.3
    assert contrast.max() > 1
    assert contrast[(middles < 2.8) | (middles > 3.8)].max() < 0.2
    _, narrow = contrast_of_halo(Eye(), 3e-3, 2.5, 4.0, 301, 8.4)
    assert np.abs(narrow).max() < 0.05


def test_two_hundred_gratings_make_a_halo_of_a_third_of_a_degree():
    eye = replace(eye_named("ritschel-2009"), particles=0)
    middles, contrast = contrast_of_halo(eye, 7e-3, 0.2, 0.5, 301, 1.05)
    assert middles[np.argmax(contrast)] == pytest.approx(0.35, abs=0.03)


def test_a_small_wavefront_error_lowers_the_peak_by_its_strehl_ratio():
    error, wavelength = 0.07 * 550e-9, 550e-9
    peaks = []
    for eye in (CLEAN, replace(CLEAN, zernike={"astigmatism": error}, zernike_diameter=3e-3)):
        state = EyeState(eye, pupil_diameter=3e-3)
        psf = eye_psf(state, (41, 41), math.radians(0.08), light.line(wavelength), tail=False, size=512)
        peaks.append(psf.pixels[20, 20, 1])
    assert peaks[1] / peaks[0] == pytest.approx(
        math.exp(-((2 * math.pi * error / wavelength) ** 2)), abs=0.01
    )


def test_a_defocused_eye_spreads_a_point_over_its_blur_disc():
    # Geometry: a pupil of diameter d out of focus by D dioptres blurs a point to a disc of d D radians.
    diameter, dioptres = 4e-3, 2.0
    state = EyeState(replace(CLEAN, defocus=dioptres), pupil_diameter=diameter)
    psf = eye_psf(state, (121, 121), math.radians(1), tail=False, size=512, wavelengths=12)
    angle, _ = angles_of(psf)
    radius = math.degrees(diameter * dioptres / 2)
    energy = (psf.pixels @ LUMINANCE) / (psf.pixels @ LUMINANCE).sum()
    for part in (0.5, 0.8):
        assert float(energy[angle < part * radius].sum()) == pytest.approx(part**2, abs=0.06)
    assert float(energy[angle < 1.15 * radius].sum()) > 0.95


def test_components_are_each_of_energy_one_and_their_shares_too():
    state = EyeState(pupil_diameter=6e-3)
    psfs = component_psfs(state, (90, 90), math.pi, size=1024)
    assert sum(psf.metadata["weight"] for psf in psfs.values()) == pytest.approx(1, abs=1e-12)
    for psf in psfs.values():
        if psf.metadata["weight"]:
            np.testing.assert_allclose(psf.pixels.sum(axis=(0, 1), dtype=float), 1, atol=1e-3)
