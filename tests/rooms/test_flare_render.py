"""Ghosts as a picture: symmetry, sums, energy, colour, layers, irises, area lights, refusals."""

import dataclasses
import importlib
import math

import numpy as np
import pytest

from aureole import aperture, diffraction, flare, light, refuse
from aureole.flare import energy, glass, lights, paraxial
from aureole.flare.iris import stop_mask
from aureole.flare.render import render, render_layers, render_stages
from aureole.records import Light, Picture

DEGREE = math.pi / 180
# As high over wide as the Biotar's sensor.
SHAPE = (64, 88)
# Small pictures and grids: what is tested here does not depend on them.
QUICK = {"grid": 32, "wavelengths": 3, "blend": "flat", "merge": "none"}


@pytest.fixture(scope="module")
def biotar():
    return flare.load("zeiss_biotar_50mm")


def at(x, y=0.0, **more):
    return lights.light_at(x * DEGREE, y * DEGREE, **more)


def test_a_mirrored_light_makes_a_mirrored_picture(biotar):
    picture = render(biotar, at(9, 4), SHAPE, **QUICK).pixels
    assert picture.max() > 0
    across = render(biotar, at(-9, 4), SHAPE, **QUICK).pixels
    np.testing.assert_allclose(across, picture[:, ::-1], atol=2e-3 * picture.max())
    down = render(biotar, at(9, -4), SHAPE, **QUICK).pixels
    np.testing.assert_allclose(down, picture[::-1], atol=2e-3 * picture.max())


def test_ghosts_of_a_lens_with_one_image_lie_through_the_centre(biotar):
    """The first of the stop's ghosts lies on the line from the light through the middle of the picture."""
    picture = render(biotar, at(10, 0), SHAPE, **QUICK).pixels[..., 1]
    rows = np.arange(SHAPE[0]) + 0.5
    assert float(rows @ picture.sum(axis=1) / picture.sum()) == pytest.approx(SHAPE[0] / 2, abs=0.05)


def test_two_lights_are_the_sum_of_each(biotar):
    warm, cold = light.illuminant("A"), light.illuminant("D65")
    first, second = at(6, 2, spectrum=warm, irradiance=2.0), at(-9, 5, spectrum=cold)
    both = render(biotar, [first, second], SHAPE, **QUICK).pixels
    apart = [render(biotar, each, SHAPE, **QUICK).pixels for each in (first, second)]
    np.testing.assert_allclose(both, apart[0] + apart[1], atol=1e-6 * both.max())


@pytest.mark.parametrize("name", ["zeiss_biotar_50mm", "heliar_tronnier_100mm"])
def test_a_ghosts_picture_sums_to_its_energy(name):
    lens = flare.load(name)
    source = at(5, 2, spectrum=light.line(550e-9))
    paths = flare.ranked(lens, flare.ghosts(lens), source, within="frame")[:4]
    for path in paths:
        # As high as the sensor, so that both count what falls on it.
        shape = (round(90 * lens.sensor[1] / lens.sensor[0]), 90) if name.startswith("heliar") else SHAPE
        picture = render(lens, source, shape, ghosts=[path], merge="none", adapt="bounds", grid=128)
        assert picture.metadata["ghost_to_image"] == pytest.approx(path.energy, rel=0.01)
        assert picture.pixels[..., 1].sum(dtype=np.float64) == pytest.approx(path.energy, rel=0.01)


def test_ratio_gain_and_irradiance(biotar):
    plain = render(biotar, at(6, 2), SHAPE, **QUICK)
    bright = render(biotar, at(6, 2, irradiance=5.0), SHAPE, gain=4.0, **QUICK)
    np.testing.assert_allclose(bright.pixels, 20 * plain.pixels, rtol=1e-5)
    assert bright.metadata["ghost_to_image"] == pytest.approx(plain.metadata["ghost_to_image"], rel=1e-5)
    assert plain.pixels[..., 1].sum() == pytest.approx(plain.metadata["ghost_to_image"], rel=1e-5)


def _neutral(lens):
    """Return the lens of glass that neither disperses nor is coated."""
    surfaces = [
        dataclasses.replace(
            each, glass=each.glass if each.glass == glass.AIR else glass.of_numbers(each.glass.index)
        )
        for each in flare.with_coating(lens, ()).surfaces
    ]
    return dataclasses.replace(lens, surfaces=tuple(surfaces))


@pytest.mark.parametrize("blend", ["blended", "flat"])
@pytest.mark.parametrize("name", ["E", "A"])
def test_white_light_stays_white_in_glass_of_one_index(biotar, blend, name):
    spectrum = light.illuminant(name)
    picture = render(_neutral(biotar), at(7, 3, spectrum=spectrum), SHAPE, **QUICK | {"blend": blend})
    lit = picture.pixels[..., 1] > 1e-3 * picture.pixels.max()
    colours = picture.pixels[lit] / picture.pixels[lit][:, 1:2]
    np.testing.assert_allclose(colours, np.broadcast_to(light.white(spectrum), colours.shape), rtol=2e-4)
    # In the space of a display the lamp's own white is neutral.
    shown = light.convert(picture, "rec709").pixels[lit]
    np.testing.assert_allclose(shown / shown[:, 1:2], 1.0, rtol=1e-3)


def test_coloured_lights_keep_their_colour(biotar):
    orange = lights.colour_spectrum((1.0, 0.5, 0.1))
    picture = render(_neutral(biotar), at(7, 3, spectrum=orange), SHAPE, **QUICK)
    red, green, blue = light.convert(picture, "rec709").pixels.sum(axis=(0, 1), dtype=np.float64)
    assert (green / red, blue / red) == pytest.approx((0.5, 0.1), rel=1e-3)


def test_layers_add_up_to_the_picture(biotar):
    sources = [at(6, 2), at(-9, 5, spectrum=light.illuminant("A"))]
    picture = render(biotar, sources, SHAPE, **QUICK).pixels
    total = np.zeros(picture.shape)
    names = []
    for layer in render_layers(biotar, sources, SHAPE, **QUICK):
        rows, columns = layer.pixels.shape[:2]
        total[layer.top : layer.top + rows, layer.left : layer.left + columns] += layer.pixels
        names.append(layer.path.name)
    assert names == [path.name for path in flare.ghosts(biotar)]
    np.testing.assert_allclose(total, picture, atol=1e-6 * picture.max())


def test_the_last_stage_is_the_answer(biotar):
    stages = list(render_stages(biotar, [at(6, 2), at(7, 2), at(8, 2)], SHAPE, **QUICK))
    fractions = [stage.fraction for stage in stages]
    assert len(stages) == 3
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    once = render(biotar, [at(6, 2), at(7, 2), at(8, 2)], SHAPE, **QUICK)
    np.testing.assert_array_equal(stages[-1].result.pixels, once.pixels)
    assert isinstance(stages[0].result, Picture)


def test_more_primitives_than_fit_are_drawn_in_turns(biotar, monkeypatch):
    whole = render(biotar, [at(6, 2), at(7, 2)], SHAPE, **QUICK).pixels
    module = importlib.import_module("aureole.flare.render")
    monkeypatch.setattr(module, "MOST_PRIMITIVES", 100)
    monkeypatch.setattr(module, "BATCH", 3)
    turns = render(biotar, [at(6, 2), at(7, 2)], SHAPE, **QUICK).pixels
    np.testing.assert_allclose(turns, whole, atol=1e-6 * whole.max())


@pytest.mark.parametrize("angle", [25.0, 40.0, 70.0, 88.0])
def test_lights_off_the_frame_bring_ghosts_or_nothing(biotar, angle):
    picture = render(biotar, at(angle, 3), SHAPE, ghosts="all", **QUICK)
    assert np.isfinite(picture.pixels).all()
    assert math.isfinite(picture.metadata["ghost_to_image"])
    if angle == 25.0:
        assert picture.pixels.max() > 0
    # No more than a light in the frame brings.
    inside = render(biotar, at(10, 3), SHAPE, ghosts="all", **QUICK)
    assert picture.metadata["ghost_to_image"] < inside.metadata["ghost_to_image"]


def test_brightness_is_continuous_across_the_frames_edge(biotar):
    edge = math.degrees(math.atan(0.5 * biotar.sensor[0] / paraxial.focal_length(biotar)))
    inner, outer = (
        render(biotar, at(edge + d), SHAPE, **QUICK).metadata["ghost_to_image"] for d in (-0.05, 0.05)
    )
    assert outer == pytest.approx(inner, rel=0.05)


def test_a_smaller_iris_makes_smaller_ghosts(biotar):
    lit = [
        np.count_nonzero(render(biotar, at(8, 3), SHAPE, f_number=f, **QUICK).pixels[..., 1])
        for f in (4, 8, 16)
    ]
    assert lit[0] > lit[1] > lit[2] > 0


def test_a_round_iris_as_a_mask_is_the_round_iris(biotar):
    round_ = render(biotar, at(8, 3), SHAPE, f_number=8, **QUICK).pixels
    masked = render(biotar, at(8, 3), SHAPE, f_number=8, iris=aperture.circle(5e-3), **QUICK).pixels
    assert masked.sum() == pytest.approx(round_.sum(), rel=0.01)
    assert np.abs(masked - round_).mean() < 0.03 * round_.mean()


def test_a_mirrored_iris_and_light_make_a_mirrored_picture(biotar):
    generator = np.random.default_rng(3)
    mask = np.kron(generator.random((4, 4)), np.ones((16, 16)))
    one = render(biotar, at(8, 3), SHAPE, f_number=4, iris=mask, **QUICK).pixels
    other = render(biotar, at(-8, 3), SHAPE, f_number=4, iris=mask[:, ::-1], **QUICK).pixels
    np.testing.assert_allclose(other[:, ::-1], one, atol=5e-3 * one.max())
    assert np.abs(one - render(biotar, at(8, 3), SHAPE, f_number=4, **QUICK).pixels).max() > 0.1 * one.max()


def test_ringing_keeps_the_light_and_reaches_beyond_the_stop(biotar):
    iris = aperture.iris(6, 5e-3)
    texture = diffraction.ringing_texture(iris, 20.0, size=128)
    plain = render(biotar, at(8, 3), SHAPE, f_number=8, iris=iris, **QUICK)
    ringing = render(biotar, at(8, 3), SHAPE, f_number=8, iris=texture, **QUICK)
    assert ringing.metadata["ghost_to_image"] == pytest.approx(plain.metadata["ghost_to_image"], rel=0.05)
    assert np.count_nonzero(ringing.pixels[..., 1]) > np.count_nonzero(plain.pixels[..., 1])


def test_stop_masks_hold_all_their_light_within_their_circle():
    square = stop_mask(np.ones((64, 64)))
    assert square.reach == pytest.approx(math.sqrt(2), abs=0.05)
    assert square.pixels.sum() == 64 * 64
    assert stop_mask(aperture.circle(1.0)).reach == 1.0
    # A hexagon's part of its circle, exact but for the rounding of coverage.
    hexagon = stop_mask(aperture.iris(6, 1.0))
    open_part = hexagon.pixels.mean() * 4 * hexagon.reach**2
    assert open_part == pytest.approx(1.5 * math.sqrt(3), rel=1e-3)


def test_a_large_light_is_blurred_and_keeps_its_energy(biotar):
    large, options = at(8, 3, angular_size=2 * DEGREE), {"f_number": 16, "ghosts": "top:4", **QUICK}
    point = render(biotar, at(8, 3), SHAPE, **options)
    pictures = [render(biotar, large, SHAPE, points=n, **options) for n in (3, 10, 40)]
    # Edges are softer by far.
    steps = [float(np.abs(np.diff(each.pixels[..., 1], axis=1)).max()) for each in (pictures[2], point)]
    assert steps[0] < 0.7 * steps[1]
    assert pictures[2].metadata["ghost_to_image"] == pytest.approx(point.metadata["ghost_to_image"], rel=0.05)
    errors = [np.abs(each.pixels - pictures[2].pixels).mean() for each in pictures[:2]]
    assert errors[1] < 0.6 * errors[0]


def test_blended_bands_come_near_to_many_wavelengths():
    lens = flare.load("heliar_tronnier_100mm")
    options = {"ghosts": flare.ghosts(lens, "paper")[3:6], "f_number": 8, "merge": "none"}

    def error(picture):
        return float(np.abs(picture.pixels - many.pixels).mean() / many.pixels.mean())

    shape = (180, 270)
    many = render(lens, at(6, 2), shape, wavelengths=40, blend="flat", **options)
    flat = error(render(lens, at(6, 2), shape, wavelengths=4, blend="flat", **options))
    # Each further wavelength that is traced shrinks the error.
    few, some, more = (error(render(lens, at(6, 2), shape, wavelengths=n, **options)) for n in (2, 3, 4))
    assert more < 0.5 * some < 0.4 * few
    assert more < 0.1 * flat
    assert more < 0.003


def test_ghosts_by_word_and_by_path(biotar):
    source = at(6, 2)
    strongest = energy.chosen(biotar, "top:3", source)
    by_word = render(biotar, source, SHAPE, ghosts="top:3", **QUICK).pixels
    by_path = render(biotar, source, SHAPE, ghosts=strongest, **QUICK).pixels
    np.testing.assert_array_equal(by_word, by_path)


@pytest.mark.parametrize(
    ("lights_given", "options", "message"),
    [
        ([], {}, r"'lights' needs one light or more, got none\."),
        (Light((0.0, 0.0, -1.0), light.illuminant("E")), {}, r"'direction' must be in front of the lens"),
        (at(5), {"ghosts": "same-sid"}, r"'ghosts' must be one of .* Did you mean 'same-side'\?"),
        (
            at(5),
            {"f_number": 1.0},
            r"'f_number' must be at least 1\.39, 'zeiss_biotar_50mm' wide open, got 1\.",
        ),
        (at(5), {"gain": 0.0}, r"'gain' must be a finite number > 0, got 0\."),
        (at(5), {"merge": "lihgt"}, r"'merge' must be one of .* Did you mean 'light'\?"),
        (at(5), {"methud": "tiles"}, r"'render' has no 'methud'\. Did you mean 'method'\?"),
        (at(5), {"method": "tils"}, r"'method' must be one of .* Did you mean 'tiles'\?"),
        (at(5), {"blend": "flad"}, r"'blend' must be one of .* Did you mean 'flat'\?"),
        (at(5), {"grid": 1}, r"'grid' must be an integer >= 5, got 1\."),
        (at(5), {"points": 0}, r"'points' must be an integer >= 1, got 0\."),
        (at(5), {"iris": np.zeros((8, 8))}, r"'iris' must let some light through"),
        (at(5), {"iris": np.ones((8, 9))}, r"'iris' must be a square mask, got 8 by 9\."),
    ],
)
def test_refusals(biotar, lights_given, options, message):
    with pytest.raises(refuse.Refusal, match=message):
        render(biotar, lights_given, SHAPE, **options)
