"""Glare that changes over the frame: places, shares, energy, kernels of their own, reach."""

import math
import re

import numpy as np
import pytest

from aureole import Picture, aperture, glare, jobs, picture, refuse
from aureole.aperture import Rim

SHAPE = (24, 40)
CAMERA = glare.camera(50e-3, 4, aperture.circle(1.0), 36e-3, 21.6e-3, SHAPE)
# From about the middle of the half frame on, the rim cuts the pupil.
RIMS = (Rim(14e-3, 20e-3),)


def blob(width):
    """A kernel that is as broad as told, its channels alike."""
    y, x = np.mgrid[-11:12, -19:20]
    pixels = np.exp(-(x**2 / width**2 + y**2 / 4.0))
    pixels /= pixels.sum()
    return Picture(np.repeat(pixels[..., None], 3, axis=2).astype(np.float32), "rec709")


def dot(row, column, value=5.0):
    pixels = np.zeros((*SHAPE, 3), dtype=np.float32)
    pixels[row, column] = value
    return Picture(pixels, "rec709")


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def test_places_lie_from_border_to_border_and_know_their_directions():
    places = glare.camera_places(CAMERA, SHAPE, (3, 5))
    assert len(places) == 15
    assert places[0][0] == (0.0, 0.0)
    assert places[-1][0] == (23.0, 39.0)
    right, down = places[-1][1]
    assert right == pytest.approx(math.atan(19.5 * 0.9e-3 / 50e-3))
    assert down == pytest.approx(math.atan(11.5 * 0.9e-3 / 50e-3))
    assert places[7][1] == pytest.approx((0.0, 0.0))


def test_a_window_of_the_sensor_has_the_directions_of_its_place_there():
    part = glare.camera_places(CAMERA, (12, 20), (1, 1), corner=(12, 20))
    assert part[0][1] == pytest.approx(glare.camera_direction(CAMERA, (17.5, 29.5)))


@pytest.mark.parametrize("mode", ["replace", "scatter"])
def test_a_field_of_one_kernel_is_that_kernel(mode):
    psf, noise = blob(3.0), Picture(np.random.default_rng(1).random((*SHAPE, 3), np.float32), "rec709")
    field = glare.field_prepare(lambda direction: psf, CAMERA, SHAPE, (3, 3), mode)
    found, whole = glare.composite(noise, field), glare.composite(noise, psf, mode)
    np.testing.assert_allclose(found.pixels, whole.pixels, atol=2e-6)


def test_a_dot_at_a_place_has_that_places_kernel_and_one_between_has_both():
    wide, narrow = blob(5.0), blob(1.5)
    field = glare.field_prepare(lambda d: wide if d[0] > 0.1 else narrow, CAMERA, SHAPE, (1, 3), "replace")
    for row, column, kernels in ((12, 39, (wide,)), (12, 0, (narrow,))):
        expected = np.mean([glare.composite(dot(row, column), k).pixels for k in kernels], axis=0)
        found = glare.composite(dot(row, column), field).pixels
        np.testing.assert_allclose(found, expected, atol=2e-6)
    # Column 29 lies 9.5 of 19.5 pixels from the middle's place to the border's.
    share = 9.5 / 19.5
    parts = [glare.composite(dot(12, 29), k).pixels for k in (wide, narrow)]
    mixed = share * parts[0] + (1 - share) * parts[1]
    np.testing.assert_allclose(glare.composite(dot(12, 29), field).pixels, mixed, atol=2e-6)


def test_light_is_kept():
    field = glare.field_prepare(lambda d: blob(1.5 + 4 * abs(d[0])), CAMERA, SHAPE, (1, 5), "replace")
    found = glare.composite(dot(12, 20, 7.0), field).pixels.sum(axis=(0, 1), dtype=np.float64)
    np.testing.assert_allclose(found, 7.0, rtol=2e-3)


def test_colour_spaces_that_differ_are_refused():
    psfs = iter([Picture(blob(2.0).pixels, space) for space in ("rec709", "acescg")])
    kept = {}
    with refused("'psf_at' must give one colour space, got acescg, rec709."):
        glare.field_prepare(lambda d: kept.setdefault(d, next(psfs)), CAMERA, SHAPE, (1, 2), "replace")


def test_a_picture_darkens_as_the_pupil_closes():
    pupil = glare.pupil(CAMERA)
    dark = glare.vignette(CAMERA, lambda direction: aperture.open_part(pupil, RIMS, direction), SHAPE)
    # Between the middle, where all is open, and the next place, where the rim cuts a little.
    assert 0.97 < dark[12, 20] == dark.max() <= 1
    direction = glare.camera_direction(CAMERA, (0.0, 0.0))
    corner = aperture.open_part(aperture.circle(12.5e-3), RIMS, direction)
    assert dark[0, 0] == pytest.approx(corner, abs=1e-6)
    assert 0.2 < corner < 0.8
    np.testing.assert_allclose(dark, dark[::-1, ::-1], atol=1e-5)


def run(**more):
    job = jobs.GlareJob(
        more.pop("picture", dot(12, 38)),
        jobs.Optics(jobs.Opening(shape="circle"), f_number=16.0, focal_length=50e-3),
        **more,
    )
    return jobs.finish(jobs.run(job))


def test_a_lamp_at_the_border_has_the_cats_eyes_glare():
    """The pupil is narrow across there, so its light spreads farther across than down."""
    wide = run(pixel_pitch=20e-6, field=jobs.GlareField((1, 3), rims=(Rim(5e-3, 10e-3),))).report
    assert wide["field_kernels"] == 1
    assert wide["field_error_percent"] == 0
    scaled = jobs.GlareField((1, 3), rims=(Rim(3.2e-3, 0.25),))
    found = run(pixel_pitch=20e-6, field=scaled)
    assert found.report["field_places"] == [3, 1]
    assert found.report["open_part_least"] < 0.6
    assert 0 < found.report["field_error_percent"] < 100
    y, x = np.mgrid[:24, :40] - np.array([12, 38])[:, None, None]
    glow = found.picture.pixels[..., 1] * ((x != 0) | (y != 0))
    assert np.sum(glow * (np.abs(x) > np.abs(y))) > 1.2 * np.sum(glow * (np.abs(y) > np.abs(x)))
    np.testing.assert_allclose(found.report["sum_after"], found.report["sum_before"], rtol=0.1)


def test_a_whole_kernel_reaches_any_pixel():
    lamp = dot(0, 0, 1e6)
    short, whole = run(picture=lamp, pixel_pitch=4e-6), run(picture=lamp, pixel_pitch=4e-6, whole_kernel=True)
    assert whole.psf.pixels.shape[:2] == (47, 79)
    assert short.picture.pixels[-1, -1].max() < 1e-6 < whole.picture.pixels[-1, -1].min()


def test_kernels_of_two_sizes_are_refused():
    with refused("'kernel_size' and 'whole_kernel' both set the kernel's size; give one of them."):
        run(whole_kernel=True, kernel_size=9)


def test_bloom_of_a_field_is_its_places_bloom_together():
    """Where two kernels share the picture left and right, each half has its own bloom."""
    wide, narrow = blob(5.0), blob(1.5)
    noise = Picture(np.random.default_rng(2).random((*SHAPE, 3), np.float32), "rec709")
    field = glare.field_prepare(lambda d: wide if d[0] > 0 else narrow, CAMERA, SHAPE, (1, 2), "bloom")
    found = glare.composite(noise, field).pixels
    right = np.linspace(0, 1, SHAPE[1], dtype=np.float32)[:, None]
    parts = [
        glare.composite(Picture(noise.pixels * share, "rec709"), psf, "bloom").pixels
        for psf, share in ((wide, right), (narrow, 1 - right))
    ]
    np.testing.assert_allclose(found, parts[0] + parts[1], atol=2e-5)


def test_kernels_that_share_pixels_are_the_sum_of_convolutions():
    rng = np.random.default_rng(3)
    shares = [np.zeros(SHAPE, np.float32) for _ in range(3)]
    shares[0][:9], shares[1][5:], shares[2][:] = 0.5, 2.0, rng.random(SHAPE, np.float32)
    kernels = [rng.random((31, 20, 3), np.float32) for _ in shares]
    light = rng.random((*SHAPE, 3), np.float32)
    expected = sum(
        picture.convolve(light * share[..., None], kernel, "reference", "double")
        for share, kernel in zip(shares, kernels, strict=True)
    )
    kept = picture.PlacesConvolver(kernels, shares, "double")
    anew = picture.PlacesConvolver(kernels, shares, "double", most_bytes=0)
    for found in (kept(light), kept(light), anew(light)):
        np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_shares_that_do_not_fit_are_refused():
    kernel, share = np.ones((3, 3, 3), np.float32), np.ones(SHAPE, np.float32)
    with refused("'weights' must be one for each kernel, got 1 for 2."):
        picture.PlacesConvolver([kernel, kernel], [share])


def test_a_word_for_rims_that_means_nothing_is_refused():
    field = jobs.GlareField(lens="cooke_triplet_100mm", lens_rims="guessed")
    with refused("'lens_rims' must be one of 'traced', 'paraxial', got 'guessed'."):
        field.housing(CAMERA)
