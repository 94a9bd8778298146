"""Laws of ringing textures: energy, symmetry, limits, and the order of the colours at an edge."""

import math
import re

import numpy as np
import pytest

from aureole import aperture, light, refuse
from aureole.diffraction import near_field, ringing_texture
from aureole.records import Grid

WIDTH = 8e-3
GREY = light.illuminant("E")


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def cats_eye(diameter=WIDTH, x=3e-3):
    return aperture.cats_eye(aperture.circle(WIDTH), diameter, (x, 0.0))


def texels(texture):
    """Relative stop coordinates of the texels' middles."""
    size = len(texture.pixels)
    return (2 * (np.arange(size) + 0.5) / size - 1) * texture.reach


@pytest.mark.parametrize("size", [96, 97])
@pytest.mark.parametrize("shape", [aperture.iris(6, WIDTH, rotation=0.4), cats_eye()])
def test_energy(shape, size):
    """The sum times the texel's area is the opening's area times the share that the texture states."""
    texture = ringing_texture(shape, 40.0, size)
    texel = (texture.reach * WIDTH / size) ** 2
    total = texture.pixels.sum(dtype=np.float64) * texel
    assert total == pytest.approx(texture.kept * aperture.area(shape), rel=1e-6)
    assert 0.98 < texture.kept < 1.001


def test_a_wider_margin_keeps_more():
    kept = [ringing_texture(aperture.iris(6, WIDTH), 5.0, 128, margin).kept for margin in (0.0, 0.25, 1.0)]
    assert kept == sorted(kept)
    assert kept[-1] == pytest.approx(1, abs=0.01)


def test_made_whole():
    plain, whole = (ringing_texture(cats_eye(), 10.0, 64, 0.1, whole=each) for each in (False, True))
    np.testing.assert_allclose(whole.pixels * plain.kept, plain.pixels, rtol=1e-5)
    assert whole.kept == pytest.approx(plain.kept)


def test_the_border_is_what_it_says():
    texture = ringing_texture(aperture.iris(5, WIDTH), 20.0, 64)
    rim = np.ones((64, 64), bool)
    rim[1:-1, 1:-1] = False
    assert texture.border == pytest.approx(texture.pixels[rim].max())
    assert texture.border < 0.01


@pytest.mark.parametrize("size", [50, 51])
def test_mirror_images(size):
    """A circle is like its mirror images along both axes and the diagonal; a cat's eye along y."""
    circle = ringing_texture(aperture.circle(WIDTH), 25.0, size).pixels
    for mirrored in (circle[::-1], circle[:, ::-1], circle.T):
        np.testing.assert_allclose(mirrored, circle, rtol=0, atol=1e-5)
    eye = ringing_texture(cats_eye(), 25.0, size).pixels
    np.testing.assert_allclose(eye[::-1], eye, rtol=0, atol=1e-5)
    assert np.abs(eye[:, ::-1] - eye).max() > 0.5


def test_texels_lie_where_they_say():
    """The near field at the relative stop coordinates of each texel's middle, y downward."""
    shape = aperture.moved(aperture.iris(5, WIDTH / 2, rotation=0.2), 0.2 * WIDTH, -0.1 * WIDTH)
    texture = ringing_texture(shape, 10.0, 41)
    places = texels(texture) * shape.width / 2
    step = places[1] - places[0]
    distance = (shape.width / 2) ** 2 / (550e-9 * 10.0)
    field = near_field(shape, Grid((41, 41), (step, step)), distance, 550e-9).amplitude
    np.testing.assert_allclose(texture.pixels, np.abs(field) ** 2, rtol=0, atol=1e-4)
    y, x = (np.average(places, weights=texture.pixels.sum(axis=axis)) for axis in (1, 0))
    assert x == pytest.approx(0.2 * WIDTH, abs=0.01 * WIDTH)
    assert y == pytest.approx(-0.1 * WIDTH, abs=0.01 * WIDTH)


def test_a_large_fresnel_number_gives_the_mask():
    shape = aperture.iris(6, WIDTH, rotation=0.1)
    fine = ringing_texture(shape, 3e6, 64, margin=0.0).pixels
    assert np.abs(fine - aperture.rasterize(shape, 64)).mean() < 0.01


def test_a_small_fresnel_number_gives_the_far_field():
    """On the axis |D|² goes to (area / (λz))² = (4 N_F area / width²)²."""
    shape, number = aperture.iris(6, WIDTH), 1e-3
    texture = ringing_texture(shape, number, 3, margin=0.0)
    wanted = (4 * number * aperture.area(shape) / WIDTH**2) ** 2
    assert texture.pixels[1, 1] == pytest.approx(wanted, rel=1e-2)


def test_only_the_fresnel_number_counts():
    """At another wavelength, and for the same shape at another size, the texture is the same."""
    wanted = ringing_texture(aperture.iris(6, WIDTH), 30.0, 40).pixels
    for found in (
        ringing_texture(aperture.iris(6, WIDTH), 30.0, 40, wavelength=700e-9).pixels,
        ringing_texture(aperture.iris(6, 3 * WIDTH), 30.0, 40).pixels,
    ):
        np.testing.assert_allclose(found, wanted, rtol=0, atol=2e-5)


def test_a_line_in_colour_is_one_wavelength_in_grey():
    grey = ringing_texture(cats_eye(), 15.0, 48)
    line = ringing_texture(cats_eye(), 15.0, 48, spectrum=light.line(550e-9))
    np.testing.assert_allclose(line.pixels[..., 1], grey.pixels, rtol=0, atol=1e-5)
    assert line.kept == pytest.approx(grey.kept)


def test_blue_fringes_lie_nearer_to_the_edge():
    """The first maximum lies 0.861 √(λz) inside a straight edge: nearer for blue than for red."""
    shape = aperture.rectangle(WIDTH, WIDTH)
    maxima = []
    for wavelength in (450e-9, 620e-9):
        texture = ringing_texture(shape, 60.0, 601, 0.0, spectrum=light.line(wavelength))
        row = texture.pixels[300, :100, 1]
        maxima.append(1 + texels(texture)[np.argmax(row)])
    blue, red = maxima
    assert blue / red == pytest.approx(math.sqrt(450 / 620), rel=0.05)
    # λz of green is (width / 2)² / 60, so that of red is 620/550 of it.
    assert red == pytest.approx(0.861 * math.sqrt(620 / 550 / 60), rel=0.05)


def test_refusals():
    shape = aperture.circle(WIDTH)
    with refused("'fresnel_number' must be a finite number > 0, got 0."):
        ringing_texture(shape, 0.0)
    with refused("'size' must be an integer >= 2, got 1."):
        ringing_texture(shape, 1.0, 1)
    with refused("'margin' must be a number from 0 to 10, got -0.1."):
        ringing_texture(shape, 1.0, margin=-0.1)
    with pytest.raises(refuse.Refusal, match="comes from beyond its width"):
        ringing_texture(aperture.obstacle(shape), 1.0)
    with refused("'whole' needs light on the square; 'fresnel_number' 1e-300 has none."):
        ringing_texture(shape, 1e-300, 8, whole=True)
