"""Bloom: energy, places and symmetry kept from box to box, and how near it is to the full convolution."""

import numpy as np
import pytest

from aureole import Picture, Refusal, glare, picture
from aureole.glare import bloom

RNG = np.random.default_rng(8)


def star_psf(side=161, total=0.97):
    """Return a kernel as an iris makes them: a core, a 1/r^3 skirt and streaks."""
    y, x = np.mgrid[:side, :side] - side // 2
    r = np.hypot(y, x)
    skirt = 1 / (1 + r) ** 3 * (1 + 3 * np.exp(-(np.sin(3 * np.arctan2(y, x)) ** 2) * 40))
    skirt *= glare.fade((side, side))
    pixels = skirt / skirt.sum() * total
    return Picture((pixels[..., None] * np.ones(3)).astype(np.float32))


def centroid(pixels):
    rows, columns = np.indices(pixels.shape[:2])
    light = pixels.sum(axis=2, dtype=np.float64)
    return (rows * light).sum() / light.sum(), (columns * light).sum() / light.sum()


def dot(shape, row, column):
    pixels = np.zeros((*shape, 3), dtype=np.float32)
    pixels[row, column] = 1
    return pixels


@pytest.mark.parametrize("side", [2, 3, 4, 5])
@pytest.mark.parametrize("length", [20, 21, 41])
def test_the_boxes_kernel_keeps_the_sum_and_the_middle(side, length):
    kernel = RNG.random((length, length + 6, 3)).astype(np.float32)
    boxed = bloom.boxed_kernel(kernel, side)
    np.testing.assert_allclose(boxed.sum(axis=(0, 1)), kernel.sum(axis=(0, 1)), rtol=1e-5)
    middle = [side * (place - n // 2) for place, n in zip(centroid(boxed), boxed.shape[:2], strict=True)]
    expected = [place - n // 2 for place, n in zip(centroid(kernel), kernel.shape[:2], strict=True)]
    np.testing.assert_allclose(middle, expected, atol=1e-4)


@pytest.mark.parametrize("place", [(60, 60), (61, 62), (63, 57), (58, 59)])
def test_a_moving_light_keeps_its_energy_and_its_place(place):
    kernel = star_psf(41).pixels
    lamp = dot((120, 124), *place)
    out = bloom.BloomSpread(kernel, np.zeros(3), (120, 124))(lamp)
    np.testing.assert_allclose(out.sum(axis=(0, 1)), kernel.sum(axis=(0, 1)), rtol=1e-4)
    np.testing.assert_allclose(centroid(out), place, atol=1e-2)


def test_light_without_detail_is_spread_as_by_the_full_convolution():
    # Straight lines are brought back exactly, so far from the border a ramp is spread exactly.
    rows, columns = np.mgrid[:160, :180].astype(np.float32)
    ramp = np.stack([1 + rows / 50, 2 + columns / 90, 3 + rows / 99 + columns / 70], axis=2)
    kernel = star_psf(61).pixels
    found = bloom.BloomSpread(kernel, np.zeros(3), (160, 180), tiers=())(ramp)
    expected = picture.convolve(ramp, kernel, precision="double")
    np.testing.assert_allclose(found[45:-45, 45:-45], expected[45:-45, 45:-45], rtol=2e-5)


@pytest.mark.parametrize("sides", [(61, 61), (40, 53), (7, 200)])
@pytest.mark.parametrize(
    "tiers", [((100, 8100),), ((100, 8100), (120, 300)), ((100, 8100), (110, 2000), (120, 9))]
)
def test_light_from_pixel_to_pixel_is_spread_as_by_the_full_convolution(sides, tiers):
    # Where each pixel is among the brightest and the kernel ends before it fades, nothing is left to boxes.
    pixels, kernel = RNG.random((90, 90, 3)).astype(np.float32), RNG.random((*sides, 3)).astype(np.float32)
    pixels[RNG.random((90, 90)) < 0.5] = 0
    if sides[1] == 200:
        tiers = [(4 * reach, count) for reach, count in tiers]
    kept = np.float32([3, 4, 5])
    found = bloom.BloomSpread(kernel, kept, (90, 90), tiers=tiers)(pixels)
    expected = picture.convolve(pixels, kernel, precision="double") + kept * pixels
    np.testing.assert_allclose(found, expected, rtol=2e-5)


@pytest.mark.parametrize("threads", [1, 3])
def test_light_is_the_same_on_any_number_of_threads(threads):
    pixels = (RNG.random((200, 210, 3)) ** 9).astype(np.float32)
    spread = bloom.BloomSpread(star_psf(61).pixels, np.ones(3), (200, 210))
    before = spread(pixels)
    spread.threads = threads
    np.testing.assert_array_equal(spread(pixels), before)


def test_energy_is_kept_with_a_dark_border_and_nothing_is_negative():
    pixels = np.zeros((300, 320, 3), dtype=np.float32)
    pixels[90:-90, 90:-90] = RNG.random((120, 140, 3)) ** 20 * [1000, 300, 100]
    out = glare.composite(Picture(pixels), star_psf(), "bloom").pixels
    before, after = (p.sum(axis=(0, 1), dtype=np.float64) for p in (pixels, out))
    np.testing.assert_allclose(after, before, rtol=1e-4)
    assert out.min() >= 0


def test_the_core_stays_sharp():
    kernel = star_psf()
    source = Picture(dot((200, 200), 77, 90) * 5)
    full = glare.composite(source, kernel, "scatter").pixels
    fast = glare.composite(source, kernel, "bloom").pixels
    np.testing.assert_allclose(fast[77, 90], full[77, 90], rtol=5e-3)


def test_what_it_adds_to_the_night_scene_is_within_40_db_of_what_the_full_one_adds():
    source, kernel = picture.night_scene((270, 480), seed=1), star_psf(321)
    full, fast = (
        glare.composite(source, kernel, mode).pixels - source.pixels for mode in ("scatter", "bloom")
    )
    exposure = float(np.percentile(full, 99.9))
    assert picture.psnr(fast, full, peak=exposure).min() > 40
    # The estimate sums the full one at a few pixels: within a few decibels.
    laid = Picture(fast + source.pixels, source.colour_space)
    truth = -10 * np.log10(np.square((fast - full) / exposure, dtype=np.float64).mean())
    assert glare.bloom_psnr(source, kernel, laid, samples=400) == pytest.approx(truth, abs=5)
    # Its darkness shows that the bright places alone do not make the number.
    dark = full.max(axis=2) < np.percentile(full, 50)
    np.testing.assert_allclose(fast[dark].mean(), full[dark].mean(), rtol=0.02)


def test_the_estimate_from_all_pixels_is_the_error_itself():
    pixels, kernel = (RNG.random((40, 50, 3)) ** 9).astype(np.float32) * 30, star_psf(31)
    source, matte = Picture(pixels), RNG.random((40, 50))
    full = glare.composite(source, kernel, "scatter", matte=matte, precision="double").pixels
    other = Picture(full + RNG.normal(0, 0.01, full.shape).astype(np.float32))
    added = other.pixels - pixels
    squares = np.square(other.pixels - full, dtype=np.float64).mean()
    truth = 10 * np.log10(np.percentile(added, 99.9) ** 2 / squares)
    assert glare.bloom_psnr(source, kernel, other, matte, samples=8000) == pytest.approx(truth, abs=0.01)
    assert glare.bloom_psnr(source, kernel, source) == np.inf


def test_a_matte_limits_the_sources():
    pixels = RNG.random((90, 100, 3)).astype(np.float32)
    source = Picture(pixels)
    none = glare.composite(source, star_psf(41), "bloom", matte=np.zeros((90, 100)))
    np.testing.assert_allclose(none.pixels, pixels, atol=1e-6)
    half = np.zeros((90, 100))
    half[:, :50] = 1
    left = pixels * half[..., None].astype(np.float32)
    expected = glare.composite(Picture(left), star_psf(41), "bloom").pixels + pixels - left
    found = glare.composite(source, star_psf(41), "bloom", matte=half).pixels
    np.testing.assert_allclose(found, expected, atol=1e-5)


def test_alpha_is_left_alone():
    pixels = np.zeros((50, 50, 4), dtype=np.float32)
    pixels[25, 25] = (10, 5, 2, 0)
    pixels[:10, :, 3] = 0.5
    out = glare.composite(Picture(pixels), star_psf(31), "bloom").pixels
    np.testing.assert_array_equal(out[..., 3], pixels[..., 3])
    assert out[20, 20, 0] > 0


def test_a_box_of_one_pixel_is_refused():
    with pytest.raises(Refusal, match=r"^'side' must be an integer >= 2, got 1\.$"):
        bloom.BloomSpread(star_psf(31).pixels, np.zeros(3), (50, 50), side=1)
