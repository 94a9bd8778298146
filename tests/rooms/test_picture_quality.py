"""Quality figures: closed forms, brute force, refusals."""

import numpy as np
import pytest

from aureole import picture, refuse
from aureole.records import Picture

FIGURES = [picture.psnr, picture.log_psnr, picture.ssim]


def noise(shape, seed=1):
    return np.random.default_rng(seed).random(shape)


def test_psnr_of_an_even_error():
    """An error of a hundredth of the peak everywhere is 40 dB; of the given peak 1, 36.9 dB."""
    reference = 0.7 * noise((9, 12))
    peak = reference.max()
    assert picture.psnr(reference + 0.01 * peak, reference) == pytest.approx(40.0)
    assert picture.psnr(reference + 0.0143, reference, peak=1.0) == pytest.approx(-20 * np.log10(0.0143))


def test_psnr_of_noise():
    reference, error = noise((30, 31)), 1e-3 * noise((30, 31), 2)
    wanted = 20 * np.log10(reference.max() / np.sqrt((error**2).sum() / 930))
    assert picture.psnr(reference + error, reference) == pytest.approx(wanted)


@pytest.mark.parametrize("scale", [1e-20, 1.0, 1e20])
def test_log_psnr_of_one_ratio_everywhere(scale):
    """A tenth of a decade everywhere is 10 / 0.1 = 40 dB, however faint the pixel."""
    reference = scale * 10.0 ** (-9.0 * noise((20, 21)))
    assert picture.log_psnr(reference * 10**0.1, reference) == pytest.approx(40.0)


def test_log_psnr_sees_ten_decades_and_no_more():
    reference = np.ones((4, 4))
    reference[1:] = [[1e-9], [1e-10], [0.0]]
    deeper = reference.copy()
    deeper[2:] = 1e-14
    assert picture.log_psnr(deeper, reference) == np.inf
    deeper[1] = 1e-14  # a quarter of the pixels, wrong by one decade
    assert picture.log_psnr(deeper, reference) == pytest.approx(20 * np.log10(10 / 0.5))


def test_log_psnr_counts_what_psnr_cannot_see():
    reference = np.full((50, 50), 1e-8)
    reference[25, 25] = 1.0
    dimmed = np.where(reference < 1, 0.5 * reference, reference)
    assert picture.psnr(dimmed, reference) > 160
    assert picture.log_psnr(dimmed, reference) == pytest.approx(20 * np.log10(10 / np.log10(2)), abs=0.01)


def test_ssim_of_two_flat_pictures():
    """Without structure the luminance term is left."""
    a, b, c1 = 0.4, 0.6, 1e-4
    flat = np.full((12, 15), a), np.full((12, 15), b)
    wanted = (2 * a * b + c1) / (a * a + b * b + c1)
    assert picture.ssim(*flat, peak=1.0) == pytest.approx(wanted, rel=1e-9)


def test_ssim_by_brute_force():
    first, second = noise((14, 16)), 0.5 * noise((14, 16)) + 0.5 * noise((14, 16), 4)
    steps = np.arange(-5, 6)
    weights = np.exp(-(steps[:, None] ** 2 + steps**2) / (2 * 1.5**2))
    weights /= weights.sum()
    c1, c2 = (0.01 * second.max()) ** 2, (0.03 * second.max()) ** 2
    values = []
    for i in range(4):
        for j in range(6):
            x, y = first[i : i + 11, j : j + 11], second[i : i + 11, j : j + 11]
            mean_x, mean_y = (weights * x).sum(), (weights * y).sum()
            spread_x, spread_y = (weights * (x - mean_x) ** 2).sum(), (weights * (y - mean_y) ** 2).sum()
            shared = (weights * (x - mean_x) * (y - mean_y)).sum()
            luminance = (2 * mean_x * mean_y + c1) / (mean_x**2 + mean_y**2 + c1)
            values.append(luminance * (2 * shared + c2) / (spread_x + spread_y + c2))
    assert picture.ssim(first, second) == pytest.approx(np.mean(values), rel=1e-9)


def test_ssim_of_a_negative_is_below_zero():
    values = noise((20, 20))
    assert picture.ssim(1 - values, values) < -0.9


@pytest.mark.parametrize("figure", FIGURES)
def test_one_number_a_channel(figure):
    first, second = noise((16, 17, 3)), noise((16, 17, 3), 2)
    together = figure(first, second)
    alone = [figure(first[..., c], second[..., c]) for c in range(3)]
    np.testing.assert_allclose(together, alone, rtol=1e-12)
    pictures = (Picture(values.astype(np.float32), "xyz") for values in (first, second))
    np.testing.assert_allclose(figure(*pictures), together, rtol=1e-5)


@pytest.mark.parametrize(("figure", "best"), list(zip(FIGURES, (np.inf, np.inf, 1.0), strict=True)))
def test_nothing_differs(figure, best):
    assert figure(noise((16, 16)), noise((16, 16))) == pytest.approx(best)


@pytest.mark.parametrize("figure", FIGURES)
@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        (np.ones((12, 12)), np.ones((12, 13)), "'picture' must be an array of shape (12, 13), got (12, 12)."),
        (np.ones(12), np.ones(12), "'picture' must be an array of shape (any, any), got (12,)."),
        (
            np.ones((12, 12)),
            np.full((12, 12), np.inf),
            "'reference' must hold finite numbers, got 144 that are NaN or infinite.",
        ),
        (
            np.ones((12, 12)),
            np.zeros((12, 12)),
            "'reference' must have light in every channel to compare with.",
        ),
    ],
)
def test_refusals(figure, first, second, message):
    with pytest.raises(refuse.Refusal) as refusal:
        figure(first, second)
    assert str(refusal.value) == message


def test_ssim_needs_room_for_its_window():
    with pytest.raises(refuse.Refusal, match="11 pixels or more an axis, got 10 x 30"):
        picture.ssim(np.ones((10, 30)), np.ones((10, 30)))
