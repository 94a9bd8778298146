"""Compositing: energy, cores, mattes, the artist's knee, and what stays untouched."""

import numpy as np
import pytest

from aureole import Picture, Refusal, glare

RNG = np.random.default_rng(11)


def gaussian_psf(side=31, width=3.0, total=0.95):
    y, x = np.mgrid[:side, :side] - side // 2
    bell = np.exp(-(x**2 + y**2) / (2 * width**2))
    pixels = (bell / bell.sum() * total)[..., None] * np.ones(3)
    return Picture(pixels.astype(np.float32))


def lamp_picture(shape=(90, 100), margin=40):
    pixels = np.zeros((*shape, 3), dtype=np.float32)
    inner = pixels[margin:-margin, margin:-margin]
    inner[:] = RNG.random(inner.shape) * [100, 50, 20]
    return Picture(pixels)


@pytest.mark.parametrize("mode", ["replace", "scatter"])
def test_energy_is_kept_with_a_dark_border(mode):
    source = lamp_picture()
    out = glare.composite(source, gaussian_psf(), mode)
    before, after = (p.pixels.sum(axis=(0, 1), dtype=np.float64) for p in (source, out))
    np.testing.assert_allclose(after, before, rtol=1e-5)


def test_replace_of_one_pixel_is_the_kernel_with_its_loss_in_the_core():
    psf = gaussian_psf(total=0.9)
    pixels = np.zeros((61, 61, 3), dtype=np.float32)
    pixels[30, 30] = 2
    out = glare.composite(Picture(pixels), psf).pixels
    expected = np.zeros((61, 61, 3))
    expected[15:46, 15:46] = 2 * psf.pixels
    expected[30, 30] += 2 * 0.1
    np.testing.assert_allclose(out, expected, atol=1e-6)


def test_scatter_leaves_the_core_sharp():
    psf = gaussian_psf(width=1.0)
    source = lamp_picture()
    out = glare.composite(source, psf, "scatter", core_radius=20.0)
    np.testing.assert_allclose(out.pixels, source.pixels, rtol=1e-5, atol=1e-6)


def test_a_prepared_kernel_gives_the_same_picture():
    source, psf = lamp_picture(), gaussian_psf()
    ready = glare.prepare(psf, (90, 100), "replace")
    np.testing.assert_array_equal(glare.composite(source, ready).pixels, glare.composite(source, psf).pixels)
    assert ready.returned == pytest.approx(0.05, abs=1e-5)


def test_a_matte_limits_the_sources():
    source, psf = lamp_picture(), gaussian_psf()
    none, all_ = np.zeros((90, 100)), np.ones((90, 100))
    np.testing.assert_allclose(glare.composite(source, psf, matte=none).pixels, source.pixels, atol=1e-5)
    np.testing.assert_allclose(
        glare.composite(source, psf, matte=all_).pixels, glare.composite(source, psf).pixels, atol=1e-5
    )
    half = np.zeros((90, 100))
    half[:, :50] = 1
    left = Picture(source.pixels * half[..., None].astype(np.float32))
    right = source.pixels - left.pixels
    expected = glare.composite(left, psf).pixels + right
    np.testing.assert_allclose(glare.composite(source, psf, matte=half).pixels, expected, atol=1e-4)


def test_alpha_and_its_trap_are_left_alone():
    # Emissive pixels have colour where alpha is zero; nothing may divide by alpha.
    pixels = np.zeros((50, 50, 4), dtype=np.float32)
    pixels[25, 25] = (10, 5, 2, 0)
    pixels[:10, :, 3] = 0.5
    out = glare.composite(Picture(pixels), gaussian_psf()).pixels
    np.testing.assert_array_equal(out[..., 3], pixels[..., 3])
    assert out[24, 24, 0] > 0


def test_add_keeps_hue_and_nothing_below_the_knee_spreads():
    pixels = np.zeros((60, 60, 3), dtype=np.float32)
    pixels[30, 30] = np.array([4.0, 2.0, 1.0])
    pixels[5, 5] = 0.4
    out = glare.composite(Picture(pixels), gaussian_psf(), "add", threshold=1.0, knee=0.5)
    added = out.pixels - pixels
    assert added[30, 36, 0] > 0
    np.testing.assert_allclose(added[30, 36] / added[30, 36, 2], [4, 2, 1], rtol=1e-3)
    # What is left is the rounding of a float32 transform.
    assert np.abs(added[:8, :8]).max() < 1e-6


def test_the_knee_is_a_line_above_and_a_smooth_start_below():
    # Luminance minus threshold above the knee; value and slope join at its end.
    levels = np.linspace(0.01, 4, 400, dtype=np.float32)
    row = Picture(np.repeat(levels[None, :, None], 3, axis=2))
    above = glare.above_knee(row, 1.0, 0.5)[0, :, 0]
    np.testing.assert_allclose(above[levels > 1.5], levels[levels > 1.5] - 1, rtol=1e-5)
    assert np.all(above[levels < 0.5] == 0)
    slope = np.diff(above) / np.diff(levels)
    assert np.abs(np.diff(slope)).max() < 0.02
    sharp = glare.above_knee(row, 1.0, 0.0)[0, :, 0]
    np.testing.assert_allclose(sharp, np.maximum(levels - 1, 0), atol=1e-6)


def test_gain_and_tint_multiply_only_what_is_added():
    source, psf = lamp_picture(), gaussian_psf()
    once = glare.composite(source, psf, "add").pixels - source.pixels
    tinted = glare.composite(source, psf, "add", gain=2.0, tint=(1.0, 0.5, 0.0)).pixels - source.pixels
    np.testing.assert_allclose(tinted, once * [2, 1, 0], atol=2e-5)


def test_a_camera_never_darkens_the_night_below_zero():
    source = lamp_picture()
    for mode in glare.MODES:
        assert glare.composite(source, gaussian_psf(), mode).pixels.min() >= 0


def test_refusals():
    source, psf = lamp_picture(), gaussian_psf()
    with pytest.raises(Refusal, match="Did you mean 'replace'"):
        glare.composite(source, psf, "replac")
    with pytest.raises(Refusal, match="must be an array of shape"):
        glare.composite(source, psf, matte=np.ones((3, 3)))
    with pytest.raises(Refusal, match="'knee' must be a number from 0 to 1"):
        glare.composite(source, psf, "add", knee=2)
    with pytest.raises(Refusal, match="'threshold' must be a number >= 0"):
        glare.composite(source, psf, "add", threshold=-1)
    with pytest.raises(Refusal, match="sum <= 1"):
        glare.composite(source, gaussian_psf(total=2.0))
    with pytest.raises(Refusal, match="'psf' must be in the picture's colour space 'acescg'"):
        glare.composite(Picture(source.pixels, "acescg"), psf)
