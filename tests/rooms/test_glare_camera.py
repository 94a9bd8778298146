"""Cameras and their point spread functions."""

import numpy as np
import pytest

from aureole import Refusal, aperture, glare, light

F, N = 50e-3, 16.0


def pixels_of(pitch, size=128):
    """A camera whose sensor is `size` pixels of a pitch."""
    return glare.camera(F, N, aperture.iris(7, 1.0), pitch * size, pitch * size, (size, size))


def test_pupil_has_the_diameter_that_the_f_number_says():
    camera = pixels_of(4e-6)
    assert glare.pupil(camera).width == pytest.approx(F / N)
    # A regular heptagon in a circle of diameter d has the area 7/8 d² sin(2π/7).
    assert aperture.area(glare.pupil(camera)) == pytest.approx(7 / 8 * (F / N) ** 2 * np.sin(2 * np.pi / 7))


def test_channels_hold_equal_energy_whatever_the_light():
    for name in ("E", "A", "D65", "blackbody:2700K"):
        psf = glare.camera_psf(pixels_of(6e-6), (256, 256), light.illuminant(name), border_fade=0)
        total = psf.pixels.sum(axis=(0, 1), dtype=np.float64)
        # What a finite kernel loses differs by channel: red spreads wider than blue.
        np.testing.assert_allclose(total, total.mean(), rtol=4e-3)
        assert 0.98 < total.mean() < 1.0005


def test_red_spreads_wider_than_blue():
    psf = glare.camera_psf(pixels_of(2e-6), (256, 256), light.illuminant("E"))
    y, x = np.mgrid[:256, :256] - 128
    radius = np.hypot(x, y)
    core = psf.pixels[radius < 5].sum(axis=0)
    assert core[2] > core[1] > core[0]


def test_the_kernel_fades_to_zero_and_says_what_that_costs():
    psf = glare.camera_psf(pixels_of(4e-6), (129, 129))
    border = np.concatenate([psf.pixels[0], psf.pixels[-1], psf.pixels[:, 0], psf.pixels[:, -1]])
    assert np.all(border == 0)
    inside, before = psf.metadata["energy_inside"], psf.metadata["energy_before_fade"]
    assert inside == pytest.approx(float(psf.pixels.sum(dtype=np.float64)) / 3, rel=1e-6)
    assert 0 < before - inside < 0.01


def test_energy_inside_grows_with_the_kernel():
    held = [glare.camera_psf(pixels_of(6e-6), (n, n)).metadata["energy_inside"] for n in (33, 65, 129, 257)]
    assert np.all(np.diff(held) > 0)
    assert held[-1] < 1.0002


def test_rectangular_pixels_are_integrated_over_their_own_area():
    square = glare.camera(F, N, aperture.circle(1.0), 4e-6 * 64, 4e-6 * 64, (64, 64))
    wide = glare.camera(F, N, aperture.circle(1.0), 8e-6 * 32, 4e-6 * 64, (64, 32))
    fine = glare.camera_psf(square, (65, 64), light.line(550e-9), border_fade=0).pixels[..., 0]
    broad = glare.camera_psf(wide, (65, 32), light.line(550e-9), border_fade=0).pixels[..., 0]
    # Two fine pixels that are shifted by half a wide one make up a wide one only at their common edge,
    # so whole rows are compared: their sums count the same strips of the sensor.
    np.testing.assert_allclose(broad.sum(axis=1)[20:45], fine.sum(axis=1)[20:45], rtol=5e-3)


def test_a_single_line_gives_three_equal_channels():
    psf = glare.camera_psf(pixels_of(2e-6), (64, 64), light.line(480e-9)).pixels
    np.testing.assert_array_equal(psf[..., 0], psf[..., 1])
    np.testing.assert_array_equal(psf[..., 0], psf[..., 2])


def test_stages_end_with_the_one_shot_answer():
    camera = pixels_of(4e-6)
    stages = list(glare.camera_psf_stages(camera, (65, 65)))
    assert stages[-1].fraction == 1
    assert np.all(np.diff([stage.fraction for stage in stages]) >= 0)
    np.testing.assert_array_equal(stages[-1].result.pixels, glare.camera_psf(camera, (65, 65)).pixels)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"focal_length": 0}, "'focal_length' must be a finite number > 0, got 0."),
        ({"f_number": float("nan")}, "'f_number' must be a finite number > 0, got nan."),
        ({"sensor_width": -1}, "'sensor_width' must be a finite number > 0, got -1."),
        ({"resolution": (0, 5)}, "'rows' must be an integer >= 1, got 0."),
    ],
)
def test_refusals(change, text):
    given = {"focal_length": F, "f_number": N, "iris": aperture.circle(1.0)} | change
    with pytest.raises(Refusal) as refused:
        glare.camera(**given)
    assert str(refused.value) == text
