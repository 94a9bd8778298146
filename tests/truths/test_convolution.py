"""Laws that every convolution keeps: identity, shift, linearity, symmetry, energy, and light stays light."""

import numpy as np
import pytest

from aureole.picture import convolution

METHODS = list(convolution.METHODS)
SINGLE = 1e-6  # of the largest value
ENERGY = 1e-6  # of the sum
SHAPE = (61, 84)


def picture_of(shape=SHAPE, seed=3):
    """A dark picture with a few bright points, as glare meets it."""
    generator = np.random.default_rng(seed)
    pixels = generator.random((*shape, 3), dtype=np.float32) * np.float32(0.01)
    pixels[generator.integers(shape[0], size=9), generator.integers(shape[1], size=9)] = 1000.0
    return pixels


def kernel_of(shape, seed=4):
    """A peak with a long falloff, the same when turned by half a turn where the shape is odd."""
    y, x = (np.arange(size) - size // 2 for size in shape)
    fall = 1 / (1 + (y[:, None] ** 2 + x[None, :] ** 2 + 0.3 * np.multiply.outer(y, x)) ** 1.5)
    channels = np.stack([fall, fall**1.1, fall**1.2], axis=2)
    return (channels / channels.sum(axis=(0, 1))).astype(np.float32)


def delta(shape, row, column):
    kernel = np.zeros(shape, dtype=np.float32)
    kernel[row, column] = 1
    return kernel


@pytest.mark.parametrize("shape", [(1, 1), (4, 4), (5, 4), (121, 167), (122, 168), (200, 300)])
@pytest.mark.parametrize("method", METHODS)
def test_a_single_one_at_the_centre_changes_nothing(method, shape):
    pixels = picture_of()
    found = convolution.convolve(pixels, delta(shape, shape[0] // 2, shape[1] // 2), method)
    np.testing.assert_allclose(found, pixels, rtol=0, atol=SINGLE * 1000)


@pytest.mark.parametrize(
    ("down", "right"), [(0, 1), (-1, 0), (3, -5), (60, 83), (-60, -83), (61, 0), (0, 84)]
)
@pytest.mark.parametrize("method", METHODS)
def test_a_one_off_the_centre_shifts_and_black_follows(method, down, right):
    pixels = picture_of()
    found = convolution.convolve(pixels, delta((125, 171), 62 + down, 85 + right), method)
    wanted = np.zeros_like(pixels)
    rows, columns = SHAPE
    wanted[max(down, 0) : rows + min(down, 0), max(right, 0) : columns + min(right, 0)] = pixels[
        max(-down, 0) : rows - max(down, 0), max(-right, 0) : columns - max(right, 0)
    ]
    np.testing.assert_allclose(found, wanted, rtol=0, atol=SINGLE * 1000)


@pytest.mark.parametrize("method", METHODS)
def test_a_sum_of_pictures_gives_the_sum_of_results(method):
    one, two, kernel = picture_of(seed=1), picture_of(seed=2), kernel_of((40, 41))
    together = convolution.convolve(2 * one - 3 * two, kernel, method)
    apart = 2 * convolution.convolve(one, kernel, method) - 3 * convolution.convolve(two, kernel, method)
    np.testing.assert_allclose(together, apart, rtol=0, atol=SINGLE * np.abs(apart).max())


@pytest.mark.parametrize("shape", [(31, 45), (32, 46)])
@pytest.mark.parametrize("method", METHODS)
def test_energy_is_kept_where_the_border_is_dark(method, shape):
    pixels = np.pad(picture_of((31, 45)), ((32, 32), (46, 46), (0, 0)))
    found = convolution.convolve(pixels, kernel_of(shape), method)
    before, after = pixels.sum(axis=(0, 1), dtype=np.float64), found.sum(axis=(0, 1), dtype=np.float64)
    np.testing.assert_allclose(after, before, rtol=ENERGY)


@pytest.mark.parametrize("shape", [(31, 45), (61, 89)])
@pytest.mark.parametrize("method", METHODS)
def test_turning_picture_and_kernel_turns_the_result(method, shape):
    pixels, kernel = picture_of(), kernel_of(shape)
    kernel[: shape[0] // 3] *= 0.25
    turned = convolution.convolve(pixels[::-1, ::-1], kernel[::-1, ::-1], method)
    straight = convolution.convolve(pixels, kernel, method)
    np.testing.assert_allclose(turned[::-1, ::-1], straight, rtol=0, atol=SINGLE * straight.max())


@pytest.mark.parametrize("method", METHODS)
def test_a_kernel_that_is_symmetric_spreads_a_point_alike_to_both_sides(method):
    pixels = np.zeros((41, 51, 3), dtype=np.float32)
    pixels[20, 25] = 1e6
    found = convolution.convolve(pixels, kernel_of((41, 51)), method)
    np.testing.assert_allclose(found, found[::-1, ::-1], rtol=0, atol=SINGLE * found.max())


@pytest.mark.parametrize("shape", [(61, 84), (9, 8), (70, 30)])
@pytest.mark.parametrize("method", METHODS)
def test_light_never_turns_negative(method, shape):
    pixels, kernel = picture_of() * np.float32(1e6), kernel_of(shape)
    assert convolution.convolve(pixels, kernel, method).min() >= 0
    assert convolution.Convolver(kernel, SHAPE)(pixels).min() >= 0


@pytest.mark.parametrize("method", METHODS)
def test_values_that_are_negative_for_a_reason_stay(method):
    kernel = delta((9, 9), 4, 4)
    assert convolution.convolve(-picture_of(), kernel, method).max() < 1e-3
    kernel[4, 4] = -1
    assert convolution.convolve(picture_of(), kernel, method).min() < -999


def test_the_stated_error_of_single_precision():
    pixels, kernel = picture_of((300, 400)), kernel_of((300, 400))
    exact = convolution.convolve(pixels, kernel, "fft", precision="double")
    error = convolution.convolve(pixels, kernel, "fft") - exact
    assert np.sqrt(np.mean(error**2)) < 4e-7 * np.sqrt(np.mean(exact**2))
    assert np.abs(error).max() < 4e-7 * exact.max()
