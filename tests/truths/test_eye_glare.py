"""An eye's glare has its size in degrees in every format of picture, and its strength wherever it stands."""

import math
from functools import cache

import numpy as np
import pytest

from aureole import Picture, glare, picture
from aureole.glare.veil import cie_135

STATE = glare.EyeState.at(time=0.5, luminance=0.1, blinking=False)
LAMP = 1e4  # luminance of lamps


def psf_for(shape, field, reach, state=STATE, source=(0.0, 0.0)):
    """A pattern on the picture's own pixels, out to an angle."""
    pitch = glare.tangent_pitch(shape, field)
    side = 2 * round(math.tan(reach) / pitch) + 1
    across = 2 * math.atan(pitch * side / 2)
    return glare.eye_psf(
        state, (side, side), across, projection="perspective", size=512, wavelengths=8, source=source
    )


def lamp(shape, field, radius, off_axis=0.0):
    """A round lamp on black: each pixel by the covered part of its solid angle, from 12 × 12 places."""
    pitch = glare.tangent_pitch(shape, field)
    pixels = np.zeros((*shape, 3), dtype=np.float32)
    middle = (shape[0] - 1) / 2, (shape[1] - 1) / 2 + math.tan(off_axis) / pitch
    reach = round(math.tan(off_axis + 2 * radius) / pitch - math.tan(off_axis) / pitch) + 2
    rows, columns = (slice(max(0, round(at) - reach), round(at) + reach + 1) for at in middle)
    within = (np.arange(12) + 0.5) / 12 - 0.5
    y, x = (
        ((np.arange(part.start, min(part.stop, n))[:, None] + within).ravel() - (n - 1) / 2) * pitch
        for part, n in ((rows, shape[0]), (columns, shape[1]))
    )
    weights = (1 + y[:, None] ** 2 + x**2) ** -1.5
    towards = math.cos(off_axis) + math.sin(off_axis) * x
    inside = towards / np.sqrt(1 + y[:, None] ** 2 + x**2) > math.cos(radius)

    def by_pixel(values):
        return values.reshape(len(y) // 12, 12, len(x) // 12, 12).sum(axis=(1, 3))

    pixels[rows, columns] = (LAMP * by_pixel(weights * inside) / by_pixel(weights))[..., None]
    return Picture(pixels)


def test_the_lamp_has_its_solid_angle():
    field, shape = math.radians(100), (300, 400)
    weights = glare.solid_angle_weights(shape, field) * glare.tangent_pitch(shape, field) ** 2
    for off_axis in (0.0, math.radians(30)):
        drawn = lamp(shape, field, math.radians(2), off_axis).pixels[..., 0] / LAMP
        expected = 2 * math.pi * (1 - math.cos(math.radians(2)))
        assert float((drawn * weights).sum()) == pytest.approx(expected, rel=5e-3)


@cache
def glare_profile(shape):
    """Luminance of the glare of a lamp half a degree wide, over the angle."""
    field = math.radians(60)
    out = glare.eye_composite(
        lamp(shape, field, math.radians(0.25)), psf_for(shape, field, math.radians(6)), field
    )
    pitch = glare.tangent_pitch(shape, field)
    y, x = ((np.arange(n) - (n - 1) / 2) * pitch for n in shape)
    angle = np.degrees(np.arctan(np.hypot(y[:, None], x)))
    edges = np.arange(0.5, 5.0, 0.1)
    which = np.digitize(angle.ravel(), edges)
    light = np.bincount(which, out.pixels[..., 1].ravel(), len(edges) + 1)
    count = np.bincount(which, minlength=len(edges) + 1)
    return edges[:-1] + 0.05, (light / count)[1:-1]


def glare_radius(shape, level):
    angle, luminance = glare_profile(shape)
    return float(np.interp(-math.log(level), -np.log(luminance), angle))


FORMATS = [(360, 640), (720, 1280), (1000, 1000)]


@pytest.mark.parametrize("level", [5.0, 0.6, 0.25])
def test_glare_has_the_same_radius_in_degrees_in_every_format(level):
    radii = [glare_radius(shape, level) for shape in FORMATS]
    assert 1 < radii[0] < 4.5
    assert max(radii) - min(radii) < 60 / 1280


@pytest.mark.parametrize("off_axis", [15, 30, 40])
def test_a_source_glares_alike_wherever_it_stands(off_axis):
    shape, field = (150, 400), math.radians(100)
    psf = psf_for(shape, field, math.radians(8))

    def total(place, known_field):
        source = lamp(shape, field, math.radians(1.0), place)
        out = glare.eye_composite(source, psf, known_field, "add", threshold=0.0, knee=0.0)
        return float((out.pixels - source.pixels).sum(dtype=np.float64))

    place = math.radians(off_axis)
    assert total(place, field) == pytest.approx(total(0.0, field), rel=0.01)
    # Pixels alone would make it glare more by 1 / cos³.
    assert total(place, None) / total(0.0, None) == pytest.approx(math.cos(place) ** -3, rel=0.01)


@pytest.mark.parametrize("age", [30, 70])
@pytest.mark.parametrize("resolution", glare.RESOLUTIONS)
def test_the_sum_of_a_night_scene_is_kept(age, resolution):
    shape, field = (90, 160), math.radians(60)
    source = picture.night_scene(shape)
    state = glare.EyeState.at(0.0, 1.0, age=age, blinking=False)
    ready = glare.eye_prepare(
        psf_for(shape, field, math.radians(35), state), shape, field, resolution=resolution
    )
    out = glare.eye_composite(source, ready)
    before, after = (p.pixels[..., :3].sum(axis=(0, 1), dtype=np.float64) for p in (source, out))
    np.testing.assert_allclose(after, before, rtol=1e-6)
    # Something was spread, and in no pixel is there less than nothing.
    assert np.abs(out.pixels - source.pixels).sum() > 0.01 * before.sum()
    assert out.pixels.min() >= 0


def test_an_old_eye_veils_more():
    shape, field = (90, 160), math.radians(60)
    source = lamp(shape, field, math.radians(2))
    veils = []
    for age in (30, 70):
        state = glare.EyeState.at(0.0, 1.0, age=age, blinking=False)
        psf = psf_for(shape, field, math.radians(35), state)
        veils.append(float(glare.eye_composite(source, psf, field).pixels[:, :40, 1].mean()))
    # CIE 135 at 15 to 30 degrees, brown eyes: 70 years against 30 years.
    angles = np.radians(np.arange(16, 30))
    expected = float(np.mean(cie_135(angles, 70, 0.5) / cie_135(angles, 30, 0.5)))
    assert veils[1] / veils[0] == pytest.approx(expected, rel=0.1)


def test_streaks_of_lashes_turn_with_the_place_of_the_source():
    shape, field = (60, 80), math.radians(60)
    state = glare.EyeState.at(0.0, 0.1, eye=glare.Eye(lashes=6), blinking=False)
    field_glare = glare.eye_field(
        lambda source: psf_for(shape, field, math.radians(20), state, source), shape, field, (1, 2)
    )
    plain = glare.eye_prepare(psf_for(shape, field, math.radians(20), state), shape, field)
    for column in (8, 71):
        pixels = np.zeros((*shape, 3), dtype=np.float32)
        pixels[30, column] = LAMP
        own, same = (glare.eye_composite(Picture(pixels), k).pixels for k in (field_glare, plain))
        np.testing.assert_allclose(own.sum(), same.sum(), rtol=1e-5)
        # So much of the scattered light is elsewhere.
        assert np.abs(own - same).sum() / 2 > 0.02 * same[pixels == 0].sum()
