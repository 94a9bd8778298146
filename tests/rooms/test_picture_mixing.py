"""Kernels kept in 16 bits: mixed and convolved they are the convolution with their sum."""

import numpy as np
import pytest
import scipy.signal

from aureole import refuse
from aureole.picture import Convolver, KernelMix, MixedConvolver

# Each number is wrong by half a step of a 32767th of the largest of its neighbours, at most.
ROUNDING = 2.0**-15


def even_kernels(reach, count, seed=3, channels=3):
    """Kernels with a steep middle and seeded speckle, even about their centres."""
    y, x = (np.arange(n) - n // 2 for n in reach)
    radius = np.hypot(y[:, None], x)
    speckle = np.random.default_rng(seed).exponential(1, (count, *reach, channels))
    kernels = (speckle + speckle[:, ::-1, ::-1]) / (1 + radius[..., None]) ** 2
    kernels /= 4 * kernels.sum(axis=(1, 2), keepdims=True)
    return kernels.astype(np.float32)


def lights(shape, seed=4):
    return np.random.default_rng(seed).lognormal(0, 2, (*shape, 3)).astype(np.float32)


def filled(shape, kernels, even=True, threads=None):
    mix = KernelMix.empty(shape, kernels.shape[1:3], len(kernels), kernels.shape[3], even)
    for index, kernel in enumerate(kernels):
        mix.put(index, kernel, threads)
    return mix


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (13, 1), (24, 37), (37, 24), (70, 131)])
@pytest.mark.parametrize("threads", [1, 2])
def test_a_mix_is_the_convolution_with_the_weighted_sum(shape, threads):
    reach = tuple(2 * n - 1 for n in shape)
    kernels, picture = even_kernels(reach, 3), lights(shape)
    weights = (0.2, 0.7, 1.1)
    total = sum(weight * kernel.astype(np.float64) for weight, kernel in zip(weights, kernels, strict=True))
    wanted = Convolver(total, shape, "double")(picture)
    found = MixedConvolver(filled(shape, kernels), threads)(picture, enumerate(weights))
    scale = np.sqrt(np.mean(wanted**2))
    assert np.sqrt(np.mean((found - wanted) ** 2)) < ROUNDING * scale


def test_kernels_that_reach_less_far():
    shape, reach = (40, 33), (7, 11)
    kernels, picture = even_kernels(reach, 1), lights(shape)
    wanted = np.stack(
        [scipy.signal.convolve(picture[..., c], kernels[0, ..., c], mode="same") for c in range(3)], axis=2
    )
    found = MixedConvolver(filled(shape, kernels))(picture, [(0, 1.0)])
    np.testing.assert_allclose(found, wanted, rtol=0, atol=ROUNDING * wanted.max())


def test_any_kernel_with_complex_spectra():
    shape = (30, 41)
    kernel = np.random.default_rng(1).random((1, 59, 81, 3), dtype=np.float32) / 5000
    picture = lights(shape)
    wanted = Convolver(kernel[0], shape, "double")(picture)
    found = MixedConvolver(filled(shape, kernel, even=False))(picture, [(0, 1.0)])
    assert np.sqrt(np.mean((found - wanted) ** 2)) < ROUNDING * np.sqrt(np.mean(wanted**2))


def test_light_is_neither_lost_nor_made():
    """On a dark surround all that a kernel spreads stays in the frame. The sum over the torus is exact; what
    rounding puts beyond the frame is far less than that."""
    shape = (64, 48)
    kernels = even_kernels((21, 21), 2)
    picture = np.zeros((*shape, 3), dtype=np.float32)
    picture[12:-12, 12:-12] = lights((40, 24))
    found = MixedConvolver(filled(shape, kernels))(picture, [(0, 0.3), (1, 0.9)])
    spread = 0.3 * kernels[0].sum(axis=(0, 1), dtype=float) + 0.9 * kernels[1].sum(axis=(0, 1), dtype=float)
    wanted = picture.sum(axis=(0, 1), dtype=float) * spread
    np.testing.assert_allclose(found.sum(axis=(0, 1), dtype=float), wanted, rtol=1e-5)


def test_a_kernel_takes_two_bytes_for_each_sample_of_half_a_plane():
    mix = KernelMix.empty((512, 910), (1023, 1819), 1)
    blocks = mix.spectra.shape[2]
    assert mix.nbytes == 3 * blocks * 1024 * (64 * 2 + 4)
    assert mix.nbytes < 6.1e6
    assert KernelMix.empty((512, 910), (1023, 1819), 1, even=False).nbytes < 2 * mix.nbytes


@pytest.mark.parametrize("factor", [1e-12, 1.0, 1e12])
def test_the_scale_of_a_kernel_does_not_matter(factor):
    shape = (20, 20)
    kernels, picture = even_kernels((39, 39), 1), lights(shape)
    plain = MixedConvolver(filled(shape, kernels))(picture, [(0, 1.0)])
    scaled = MixedConvolver(filled(shape, (kernels * factor).astype(np.float32)))(picture, [(0, 1.0)])
    np.testing.assert_allclose(scaled / factor, plain, rtol=1e-3)


def test_buffers_of_one_picture_leave_no_trace_in_the_next():
    shape = (30, 20)
    mixed = MixedConvolver(filled(shape, even_kernels((59, 39), 2)))
    one, two = lights(shape, 1), lights(shape, 2)
    first = mixed(one, [(0, 1.0)])
    mixed(two, [(1, 1.0)])
    np.testing.assert_array_equal(mixed(one, [(0, 1.0)]), first)


def test_refusals():
    mix = KernelMix.empty((8, 8), (15, 15), 1)
    lopsided = np.zeros((15, 15, 3), dtype=np.float32)
    lopsided[2, 3] = 1
    with pytest.raises(refuse.Refusal, match="'kernel' must be even about its centre"):
        mix.put(0, lopsided)
    with pytest.raises(refuse.Refusal, match=r"'kernel' must be an array of shape \(15, 15, 3\)"):
        mix.put(0, np.zeros((15, 14, 3)))
    with pytest.raises(refuse.Refusal, match="'reach' must be odd and at most 15, got 17"):
        KernelMix.empty((8, 8), (15, 17), 1)
    with pytest.raises(refuse.Refusal, match="'pixels' must be an array of shape"):
        MixedConvolver(mix)(np.zeros((8, 9, 3), dtype=np.float32), [(0, 1.0)])
