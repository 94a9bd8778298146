"""A lamp's light on a frame: where it stands, what it holds, and each pixel against a sum by hand."""

import numpy as np
import pytest

from aureole import Picture, Refusal, aperture, glare

SHAPE = (18, 26)


def camera():
    # A pixel is a thousandth of a radian wide.
    return glare.camera(50e-3, 10, aperture.circle(5e-3), 26 * 50e-6, 18 * 50e-6, SHAPE)


def lamp(x, y, shape=None):
    """A lamp about the middle of a pixel, by its column and row."""
    toward = ((x - SHAPE[1] // 2) * 1e-3, (y - SHAPE[0] // 2) * 1e-3)
    return glare.AreaLight(aperture.circle(4.2e-3) if shape is None else shape, toward, 20.0)


def spread(patch, visible=0.4, seed=3):
    """A spread that holds all of its light in its own square."""
    size = glare.lamp_reach(patch, SHAPE)
    psf = np.random.default_rng(seed).random((*size, 3)) ** 6
    psf *= visible / psf.sum(axis=(0, 1))
    return glare.AreaPsf(Picture(psf.astype(np.float32)), visible, np.full((3, 3), visible / 9), 1)


@pytest.mark.parametrize("place", [(12.0, 9.0), (3.3, 4.7), (-6.5, 12.0), (30.0, -8.0)])
def test_a_lamps_pixels_hold_its_light_where_it_stands(place):
    patch = glare.lamp_patch(camera(), lamp(*place))
    assert patch.share.sum() == pytest.approx(1, rel=1e-6)
    rows, columns = (
        np.arange(n) + at for n, at in zip(patch.share.shape, (patch.top, patch.left), strict=True)
    )
    assert patch.share.sum(axis=0) @ columns == pytest.approx(place[0], abs=2e-3)
    assert patch.share.sum(axis=1) @ rows == pytest.approx(place[1], abs=2e-3)
    assert patch.pixels == pytest.approx(np.pi / 4 * 4.2**2, rel=1e-3)


def test_a_lamp_finer_than_a_pixel_is_in_it():
    patch = glare.lamp_patch(camera(), lamp(5.2, 6.1, aperture.rectangle(1e-4, 2e-4)))
    assert (patch.top, patch.left, patch.share.shape) == (6, 5, (1, 1))
    assert patch.pixels == pytest.approx(0.02, rel=1e-3)


@pytest.mark.parametrize("place", [(12.0, 9.0), (1.5, 16.2), (-5.0, 3.0), (31.0, 22.0)])
def test_each_pixel_is_the_sum_over_the_lamps_pixels(place):
    patch = glare.lamp_patch(camera(), lamp(*place))
    found = spread(patch)
    seen = np.random.default_rng(5).random(patch.share.shape)
    layer = glare.lamp_layer(found, patch, seen, SHAPE).pixels
    sharp = patch.share * seen
    sharp *= found.visible / sharp.sum()
    kernel = found.psf.pixels / found.visible
    expected = np.zeros((*SHAPE, 3))
    for row, column in np.ndindex(*patch.share.shape):
        at = patch.top + row, patch.left + column
        for i, j in np.ndindex(*SHAPE):
            place_in = kernel.shape[0] // 2 + i - at[0], kernel.shape[1] // 2 + j - at[1]
            expected[i, j] += sharp[row, column] * kernel[place_in]
    np.testing.assert_allclose(layer, expected, atol=1e-7)


def test_no_spread_makes_light():
    patch = glare.lamp_patch(camera(), lamp(12.0, 9.0))
    found = spread(patch)
    more = glare.AreaPsf(Picture(found.psf.pixels * np.float32(1.7)), found.visible, found.seen, 1)
    seen = np.ones(patch.share.shape)
    plain, mended = (glare.lamp_layer(each, patch, seen, SHAPE).pixels for each in (found, more))
    np.testing.assert_allclose(mended, plain, atol=1e-7)


def test_a_hidden_lamp_is_dark_and_a_small_spread_is_refused():
    patch = glare.lamp_patch(camera(), lamp(3.0, 4.0))
    found = spread(patch)
    assert not glare.lamp_layer(found, patch, np.zeros(patch.share.shape), SHAPE).pixels.any()
    small = glare.AreaPsf(Picture(found.psf.pixels[2:-2]), 0.4, found.seen, 1)
    with pytest.raises(Refusal, match=r"'psf' must have 49 x 31 pixels to reach all of the frame"):
        glare.lamp_layer(small, patch, np.ones(patch.share.shape), SHAPE)
