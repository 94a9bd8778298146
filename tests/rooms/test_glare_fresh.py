"""Glare computed afresh is compositing's; flipbooks of the same eye come near it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from eye_patterns import lights

from aureole import glare, picture, refuse
from aureole.glare import Eye, EyeState, FreshGlare, RealTimeGlare, flipbook_error, make_flipbooks
from aureole.glare.flipbook import eye_patterns
from aureole.glare.glare_frames import pattern_field, pattern_shape
from aureole.records import Picture

SHAPE, FIELD, SIZE = (45, 80), math.radians(30), 256
STATE = EyeState(pupil_diameter=3e-3)
FEW = {
    "bloom": {"pupil_diameter": (2.6e-3, 3.4e-3), "lid_opening": (1.0,)},
    "halo": {"pupil_diameter": (5e-3,)},
    "corona": {"pupil_diameter": (2.6e-3, 3.4e-3), "vitreous_angle": (0.0,)},
    "streaks": {"pupil_diameter": (3e-3,), "lid_opening": (1.0,)},
}


def psf_of(state, shape=SHAPE):
    return glare.eye_psf(
        state, pattern_shape(shape), pattern_field(shape, FIELD), projection="perspective", size=SIZE
    )


@pytest.mark.parametrize(
    "eye", [Eye(), Eye(defocus=0.5, zernike={"coma-x": 1e-7})], ids=["focused", "with a wavefront"]
)
def test_a_fresh_frame_is_compositing_with_the_eyes_pattern(eye):
    """The wavefront's pattern is not even, so its spectra are complex."""
    scene, state = lights(SHAPE), replace(STATE, eye=eye)
    wanted = glare.eye_composite(Picture(scene), psf_of(state), FIELD).pixels
    fresh = FreshGlare.of(eye, SHAPE, FIELD, size=SIZE)
    assert fresh.frames.kernels.is_even == (eye.defocus == 0)
    found = RealTimeGlare(fresh)(scene, state)
    moved = np.sqrt(np.mean((wanted - scene) ** 2))
    # Between nodes the share that leaves the frame is joined by straight lines.
    assert np.sqrt(np.mean((found - wanted) ** 2)) < 5e-4 * moved


@pytest.fixture(scope="module")
def flipbooks():
    return make_flipbooks(shape=SHAPE, field_of_view=FIELD, frames=FEW, size=SIZE)


def test_flipbooks_come_near_the_coherent_wave(flipbooks):
    """Adding intensities in place of amplitudes, between nodes of the pupil: within a fifth, ring by ring."""
    found = flipbook_error(flipbooks, STATE, SIZE, Picture(lights(SHAPE)))
    assert len(found.edges) == len(found.ratios) + 1 == len(found.deviations) + 1
    assert all(0.8 < ratio < 1.25 for ratio in found.ratios)
    assert all(0 < deviation < 0.6 for deviation in found.deviations)
    assert 0.8 < found.spread < 1.25
    assert found.psnr > 30
    assert found.log_psnr > 30


def test_the_error_of_a_wrong_eye_is_seen(flipbooks):
    """Flipbooks of a 30-year-old are no good for an eye of 85 years, which scatters thrice as much."""
    old = flipbook_error(flipbooks, replace(STATE, eye=Eye(age=85)), SIZE)
    assert old.spread < 0.75


def test_frames_of_few_pixels_are_compared_in_fewer_rings():
    tiny = make_flipbooks(shape=(4, 5), field_of_view=FIELD, frames=FEW, size=SIZE)
    found = flipbook_error(tiny, STATE, SIZE)
    assert 1 <= len(found.ratios) == len(found.edges) - 1 < 8
    assert all(np.isfinite([*found.ratios, *found.deviations, found.spread]))
    with pytest.raises(refuse.Refusal, match="'state' must let light through the lids"):
        flipbook_error(tiny, replace(STATE, lid_opening=0.0), SIZE)


def test_the_blend_between_two_pupils_is_near_the_pupil_between(flipbooks):
    """The parts' own patterns at 3 mm against the blend of 2.6 and 3.4 mm, which the books interpolate."""
    make = eye_patterns(SHAPE, FIELD, size=SIZE)
    wanted = sum(share * pattern for pattern, share in (make(name, STATE) for name in glare.COMPONENTS))
    point = np.zeros((*SHAPE, 3), dtype=np.float32)
    point[SHAPE[0] // 2, SHAPE[1] // 2] = 1
    found = picture.MixedConvolver(flipbooks.frames.kernels)(point, flipbooks.mix(STATE))
    top, left = (n - 1 - n // 2 for n in SHAPE)
    seen = wanted[top : top + SHAPE[0], left : left + SHAPE[1]].copy()
    seen[SHAPE[0] // 2, SHAPE[1] // 2] = 0
    assert found.sum() == pytest.approx(seen.sum(), rel=0.05)
    y, x = (np.arange(n) - n // 2 for n in SHAPE)
    radius = np.hypot(y[:, None], x)
    for low, high in ((1, 3), (3, 8), (8, 20)):
        ring = (radius >= low) & (radius < high)
        assert found[ring].mean() == pytest.approx(seen[ring].mean(), rel=0.1)


@pytest.mark.parametrize("resolution", ["full", "half"])
def test_glare_has_the_same_size_in_degrees_at_any_size(resolution):
    """The radius that holds half of the spread light, in degrees, agrees to a pixel's width."""
    radii, pixels = [], []
    for shape in ((36, 64), (72, 128), (100, 100)):
        fresh = FreshGlare.of(shape=shape, field_of_view=math.radians(10), size=SIZE, resolution=resolution)
        scene = np.zeros((*shape, 3), dtype=np.float32)
        scene[shape[0] // 2, shape[1] // 2] = 1
        spread = RealTimeGlare(fresh, "add", threshold=0.0, knee=0.0)(scene, STATE)[..., 1] - scene[..., 1]
        pitch = 2 * math.tan(math.radians(5)) / shape[1]
        y, x = ((np.arange(n) - n // 2) * pitch for n in shape)
        radius = np.degrees(np.arctan(np.hypot(y[:, None], x)))
        # The same annulus in each: beyond what a coarse pixel hides, within the smallest frame.
        ring = (radius > 0.5) & (radius < 2.6)
        order = np.argsort(radius[ring])
        held = np.cumsum(spread[ring][order])
        radii.append(radius[ring][order][np.searchsorted(held, held[-1] / 2)])
        pixels.append(math.degrees(pitch))
    assert np.ptp(radii) < (2 if resolution == "half" else 1) * max(pixels)
