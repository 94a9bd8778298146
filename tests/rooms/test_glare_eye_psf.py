"""The eye's point spread function: shapes, projections, symmetry, colours, stages, components, refusals."""

import math
from dataclasses import replace

import numpy as np
import pytest

from aureole import glare, light, refuse
from aureole.glare import Eye, EyeState
from aureole.records import Picture

STATE = EyeState(Eye(age=40), pupil_diameter=4e-3)
SIX, SIXTY = math.radians(6), math.radians(60)


def quick(state=STATE, shape=(96, 96), field=SIX, **options):
    return glare.eye_psf(state, shape, field, **({"size": 512} | options))


@pytest.mark.parametrize("shape", [(1, 1), (2, 3), (31, 64), (64, 31), (90, 160)])
def test_a_smaller_frame_is_the_middle_of_a_larger_one(shape):
    # The same pixels, cut from a frame of twice the size.
    step = math.radians(0.05)
    small = quick(shape=shape, field=shape[1] * step, wavelengths=64).pixels
    rows, columns = 2 * shape[0] + 1, 2 * shape[1] + 1
    large = quick(shape=(rows, columns), field=columns * step, wavelengths=64).pixels
    top, left = rows // 2 - shape[0] // 2, columns // 2 - shape[1] // 2
    cut = large[top : top + shape[0], left : left + shape[1]]
    middle = (slice(max(shape[0] // 2 - 20, 0), shape[0] // 2 + 21), slice(None))
    np.testing.assert_allclose(small[middle], cut[middle], rtol=0.05, atol=2e-4 * large.max())
    assert small.sum() == pytest.approx(cut.sum(), rel=1e-3)


def test_pixels_of_half_the_size_hold_together_what_the_larger_one_holds():
    coarse = quick(shape=(81, 81), field=math.radians(8.1)).pixels
    fine = quick(shape=(243, 243), field=math.radians(8.1)).pixels
    joined = fine.reshape(81, 3, 81, 3, 3).sum(axis=(1, 3))
    np.testing.assert_allclose(joined.sum(axis=2), coarse.sum(axis=2), rtol=0.1, atol=1e-6)
    np.testing.assert_allclose(joined.sum(axis=(0, 1)), coarse.sum(axis=(0, 1)), rtol=2e-4)


@pytest.mark.parametrize("shape", [(65, 65), (64, 80)])
def test_the_pattern_of_a_focused_eye_is_even(shape):
    pixels = quick(shape=shape).pixels
    part = pixels[1 - shape[0] % 2 :, 1 - shape[1] % 2 :]
    np.testing.assert_allclose(part, part[::-1, ::-1], rtol=1e-5, atol=1e-12)


def test_perspective_pixels_see_the_same_pattern():
    # About the axis both projections agree; far from it a perspective pixel sees cos³ of the solid angle.
    field = math.radians(100)
    flat = quick(shape=(101, 101), field=field, projection="perspective")
    step = math.radians(flat.metadata["degrees_per_pixel"])
    assert step == pytest.approx(2 * math.tan(field / 2) / 101, rel=1e-9)
    round_ = quick(shape=(101, 101), field=101 * step)
    assert flat.pixels[50, 50].sum() == pytest.approx(round_.pixels[50, 50].sum(), rel=1e-3)
    angle = math.atan(48 * step)
    density = 1.0 * glare.cie_135(angle, 40) / glare.hemisphere_energy(lambda t: glare.cie_135(t, 40))
    assert flat.pixels[50, 98].mean() == pytest.approx(density * step**2 * math.cos(angle) ** 3, rel=0.01)


def test_a_line_makes_three_equal_channels_and_other_lights_are_white_in_every_space():
    grey = quick(spectrum=light.line(568e-9)).pixels
    np.testing.assert_array_equal(grey[..., 0], grey[..., 2])
    for space, lamp in (("rec709", "A"), ("acescg", "D65"), ("rec2020", "E")):
        pixels = quick(spectrum=light.illuminant(lamp), colour_space=space, field=math.pi).pixels
        np.testing.assert_allclose(pixels.sum(axis=(0, 1)), 1, atol=1e-3)
        assert pixels.min() >= 0


def test_red_light_makes_a_larger_halo_than_blue():
    state = EyeState(Eye(age=20, particles=0.2, lashes=0), pupil_diameter=6e-3)
    sizes = []
    for wavelength in (470e-9, 620e-9):
        pixels = glare.eye_psf(
            state, (101, 101), math.radians(9), light.line(wavelength), tail=False, size=2048
        ).pixels[..., 0]
        angle = np.hypot(*np.meshgrid(*[np.arange(101) - 50] * 2)) * 0.09
        ring = (angle > 2) & (angle < 4.4)
        sizes.append(float(np.average(angle[ring], weights=pixels[ring] ** 2)))
    assert sizes[1] / sizes[0] == pytest.approx(620 / 470, rel=0.1)


def test_the_last_stage_is_the_one_shot_answer():
    stages = list(glare.eye_psf_stages(STATE, (40, 40), SIXTY, size=256))
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1
    once = glare.eye_psf(STATE, (40, 40), SIXTY, size=256)
    np.testing.assert_array_equal(stages[-1].result.pixels, once.pixels)
    told = once.metadata
    assert told["degrees_per_pixel"] == pytest.approx(1.5)
    assert told["energy_inside"] == pytest.approx(float(once.pixels.sum(axis=(0, 1)).mean()), rel=1e-5)
    assert told["pupil_diameter"] == STATE.pupil_diameter
    assert told["size"] == 256
    assert 0 < told["reach"] < glare.eye_psf(STATE, (9, 9), SIXTY, size=1024).metadata["reach"]


def test_closed_lids_spread_nothing():
    closed = replace(STATE, lid_opening=0.0)
    for combine in ("coherent", "thesis"):
        pixels = quick(closed, shape=(20, 30), combine=combine).pixels
        np.testing.assert_array_equal(pixels[10, 15], 1)
        assert pixels.sum() == 3
    assert glare.component_weights(closed) == {"bloom": 1.0, "halo": 0.0, "corona": 0.0, "streaks": 0.0}


def test_the_parts_patterns_add_up_to_nearly_the_whole_pattern():
    state = EyeState(Eye(age=30), pupil_diameter=6e-3)
    whole = quick(state, (60, 60), math.radians(12), size=1600).pixels
    added = quick(state, (60, 60), math.radians(12), size=1600, combine="thesis").pixels
    angle = np.hypot(*np.meshgrid(*[np.arange(60) - 30] * 2))
    for low, high in ((0, 1), (1, 5), (5, 14), (14, 19), (19, 30)):
        ring = (angle >= low) & (angle < high)
        assert added[ring].sum() == pytest.approx(whole[ring].sum(), rel=0.15)
    parts = glare.component_psfs(state, (60, 60), math.radians(12), size=1600)
    shares = glare.component_weights(state, size=1600)
    summed = sum(shares[name] * psf.pixels for name, psf in parts.items())
    np.testing.assert_allclose(summed, added, rtol=0.01, atol=1e-7)


def test_shares_are_those_of_the_particles_and_of_the_lashes_shadow():
    state = EyeState(Eye(age=30), pupil_diameter=6e-3)
    shares = glare.component_weights(state)
    particles = glare.scattered_share(glare.populations(30, 0.5))
    assert shares["corona"] == pytest.approx(particles, rel=0.15)
    assert sum(shares.values()) == pytest.approx(1)
    bare = EyeState(Eye(age=30, lashes=0), pupil_diameter=6e-3)
    assert glare.component_weights(bare)["streaks"] == 0
    shadow = 1 - glare.open_share(state) / glare.open_share(bare)
    # Of what an opaque part leaves, it scatters as much as its own shadow.
    assert shares["streaks"] == pytest.approx(shadow, rel=0.2)
    assert glare.component_weights(EyeState(Eye(), pupil_diameter=3e-3))["halo"] == pytest.approx(0, abs=1e-9)


def test_the_thesis_weights_make_the_halo_brighter():
    state = EyeState(pupil_diameter=6.5e-3)
    plain = quick(state, size=1600, field=math.radians(9), combine="thesis").pixels
    thesis = quick(
        state, size=1600, field=math.radians(9), combine="thesis", weights=glare.THESIS_WEIGHTS
    ).pixels
    angle = np.hypot(*np.meshgrid(*[np.arange(96) - 48] * 2)) * 9 / 96
    ring = (angle > 3) & (angle < 3.4)
    assert thesis[ring].sum() > 5 * plain[ring].sum()


def test_streaks_depend_on_where_the_light_is():
    state = replace(STATE, lid_opening=0.7)
    straight, left, same = (
        quick(state, source=source).pixels for source in ((0.0, 0.0), (0.1, 0.0), (0.0, 0.0))
    )
    np.testing.assert_array_equal(straight, same)
    assert np.abs(straight - left).max() > 1e-4 * straight.max()


def test_streaks_bend_by_the_sine_and_keep_their_light():
    line = np.zeros((41, 61, 3), dtype=np.float32)
    line[20] = 1
    moved = glare.eye_components.bent(Picture(line), 8.0).pixels[..., 0]
    middles = (moved * np.arange(41)[:, None]).sum(axis=0)
    np.testing.assert_allclose(middles - 20, 8 * np.sin((np.arange(61) - 30) / 30.5), atol=1e-5)
    np.testing.assert_allclose(moved.sum(axis=0), 1, rtol=1e-6)
    straight, bent = (quick(combine="thesis", streak_bend=bend).pixels for bend in (0.0, 0.01))
    assert np.abs(straight - bent).max() > 0
    assert bent.sum() == pytest.approx(straight.sum(), rel=1e-3)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"shape": (0, 10)}, "'rows' must be an integer >= 1"),
        ({"shape": (10,)}, "'shape' must be an array of shape"),
        ({"field": 0.0}, "'field_of_view' must be a finite number > 0"),
        ({"field": 4.0}, "'field_of_view' must be at most 180 degrees"),
        ({"field": 3.1, "projection": "perspective"}, "at most 170 degrees"),
        ({"projection": "angel"}, "Did you mean 'angle'"),
        ({"combine": "coherant"}, "Did you mean 'coherent'"),
        ({"colour_space": "rec708"}, "Did you mean 'rec709'"),
        ({"size": 8}, "'size' must be an integer >= 64"),
        ({"size": 257}, "'size' must be even"),
        ({"wavelengths": 0}, "'wavelengths' must be an integer >= 1"),
        ({"weights": {"halo": 1}}, "belong to combine 'thesis'"),
        ({"streak_bend": 0.1}, "belong to combine 'thesis'"),
        ({"weights": {"hallo": 1}, "combine": "thesis"}, "Did you mean 'halo'"),
        ({"weights": {"halo": 0}, "combine": "thesis"}, "must have one above 0"),
        ({"state": EyeState(Eye(defocus=20), pupil_diameter=7e-3), "size": 256}, "give it more pixels"),
    ],
)
def test_what_cannot_be_served_is_refused(options, said):
    with pytest.raises(refuse.Refusal, match=said):
        quick(**options)
