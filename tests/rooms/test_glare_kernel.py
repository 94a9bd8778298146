"""Kernels: fading borders, gamut, other programs' conventions, encircled energy."""

import numpy as np
import pytest

from aureole import Picture, Refusal, glare, light


def psf_of(pixels):
    return Picture(np.asarray(pixels, dtype=np.float32))


@pytest.mark.parametrize("shape", [(64, 64), (65, 65), (64, 33), (33, 101)])
def test_fade_is_one_at_the_core_and_exactly_zero_on_the_whole_border(shape):
    window = glare.fade(shape)
    assert window[shape[0] // 2, shape[1] // 2] == 1
    border = np.concatenate([window[0], window[-1], window[:, 0], window[:, -1]])
    assert np.all(border == 0)
    along = window[shape[0] // 2, shape[1] // 2 :]
    assert np.all(np.diff(along) <= 0)


def test_fade_can_be_left_out_and_spares_small_kernels():
    assert np.all(glare.fade((64, 64), 0) == 1)
    assert np.all(glare.fade((1, 1)) == 1)
    assert np.all(glare.fade((8, 200)) == 1)


def test_nonnegative_keeps_each_channels_sum_and_leaves_good_pixels_in_proportion():
    generator = np.random.default_rng(5)
    pixels = generator.random((40, 50, 3)).astype(np.float32)
    pixels[::7, ::5, 1] = -0.05
    mended = glare.nonnegative(psf_of(pixels)).pixels
    assert mended.min() >= 0
    np.testing.assert_allclose(mended.sum((0, 1)), pixels.sum((0, 1), dtype=np.float64), rtol=1e-5)
    good = pixels.min(axis=2) >= 0
    factor = mended[good].sum(axis=0) / pixels[good].sum(axis=0)
    np.testing.assert_allclose(mended[good], pixels[good] * factor, atol=5e-6)


def test_nonnegative_returns_good_kernels_untouched():
    psf = psf_of(np.random.default_rng(1).random((5, 6, 3)))
    assert glare.nonnegative(psf) is psf


def test_nonnegative_keeps_the_luminance_of_a_mended_pixel():
    # One pixel among many: the rescaling of the sums is then negligible.
    pixels = np.ones((200, 200, 3), dtype=np.float32)
    pixels[3, 4] = (0.5, -0.1, 0.2)
    weights = light.SPACES["rec709"].to_xyz[1]
    mended = glare.nonnegative(psf_of(pixels)).pixels[3, 4]
    np.testing.assert_allclose(mended @ weights, pixels[3, 4] @ weights, rtol=1e-4)
    assert mended.min() == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("side", [8, 9])
def test_blenders_kernel_is_turned_and_its_core_stays_at_half_the_side(side):
    # Blender's Convolve node correlates: turning the kernel makes it a convolution.
    pixels = np.zeros((side, side, 3))
    pixels[side // 2, side // 2] = 0.5
    pixels[side // 2 + 1, side // 2 + 3 - 1] = 0.25
    turned = glare.kernel_for(psf_of(pixels), "blender").pixels
    assert turned[side // 2, side // 2, 0] == 0.5
    assert turned[side // 2 - 1, side // 2 - 2, 0] == 0.25


def test_a_correlation_with_blenders_kernel_is_a_convolution_with_ours():
    from scipy.signal import convolve2d, correlate2d

    generator = np.random.default_rng(8)
    pixels = generator.random((9, 9, 3))
    picture = generator.random((20, 20))
    theirs = glare.kernel_for(psf_of(pixels), "blender").pixels[..., 0]
    ours = convolve2d(picture, pixels[..., 0], mode="same")
    np.testing.assert_allclose(correlate2d(picture, theirs, mode="same"), ours, rtol=1e-5)


def test_unreals_kernel_is_square_with_the_core_at_its_centre_and_the_same_sum():
    pixels = np.random.default_rng(2).random((20, 41, 3))
    pixels[10, 20] = 7
    square = glare.kernel_for(psf_of(pixels), "unreal").pixels
    assert square.shape == (41, 41, 3)
    assert square[20, 20, 1] == 7
    np.testing.assert_allclose(square.sum(), pixels.sum(), rtol=1e-5)


def test_nukes_kernel_sums_to_one_in_each_channel():
    pixels = np.random.default_rng(2).random((20, 41, 3)) * 0.01
    total = glare.kernel_for(psf_of(pixels), "nuke").pixels.sum(axis=(0, 1), dtype=np.float64)
    np.testing.assert_allclose(total, 1, rtol=1e-5)


def test_unknown_host_is_refused_with_the_nearest():
    with pytest.raises(Refusal, match="Did you mean 'blender'"):
        glare.kernel_for(psf_of(np.ones((3, 3, 3))), "blendr")


def test_encircled_energy_of_a_flat_disc_is_its_area():
    flat = psf_of(np.full((101, 101, 3), 1.0))
    for radius in (5.0, 20.5, 40.0):
        assert glare.encircled_energy(flat, radius, (1, 1)) == pytest.approx(np.pi * radius**2, rel=2e-3)
    assert glare.encircled_energy(flat, 10e-6, (1e-6, 2e-6)) == pytest.approx(np.pi * 100 / 2, rel=5e-3)
