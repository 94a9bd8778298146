"""The eye's point spread function against CIE 135, the Airy disc, and its energy kept whole."""

import math

import numpy as np
import pytest
from scipy.special import j0, j1

from aureole import light
from aureole.glare import Eye, EyeState, component_psfs, eye_psf, veil

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


def test_components_are_each_of_energy_one_and_their_shares_too():
    state = EyeState(pupil_diameter=6e-3)
    psfs = component_psfs(state, (90, 90), math.pi, size=1024)
    assert sum(psf.metadata["weight"] for psf in psfs.values()) == pytest.approx(1, abs=1e-12)
    for psf in psfs.values():
        if psf.metadata["weight"]:
            np.testing.assert_allclose(psf.pixels.sum(axis=(0, 1), dtype=float), 1, atol=1e-3)
