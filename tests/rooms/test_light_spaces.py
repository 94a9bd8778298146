"""Colour spaces: round trips, neutral whites, pictures, refusals."""

import numpy as np
import pytest

from aureole import light, refuse
from aureole.light import spaces
from aureole.records import Picture

WHITES = [None, "D65", "A", "F1", "blackbody:2000K"]
SOME = np.random.default_rng(3).uniform(-0.2, 2.0, (5, 7, 3))


def white_of(name):
    return None if name is None else light.white(light.illuminant(name))


@pytest.mark.parametrize("space", list(light.SPACES))
@pytest.mark.parametrize("name", WHITES)
def test_round_trip(space, name):
    back = light.to_xyz(light.from_xyz(SOME, space, white_of(name)), space, white_of(name))
    np.testing.assert_allclose(back, SOME, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("space", list(light.SPACES))
@pytest.mark.parametrize("name", WHITES)
def test_white_comes_out_neutral(space, name):
    white = np.ones(3) if name is None else white_of(name)
    np.testing.assert_allclose(light.from_xyz(white, space, white_of(name)), 1.0, rtol=1e-12)
    np.testing.assert_allclose(light.from_xyz(0.25 * white, space, 8.0 * white), 0.25, rtol=1e-12)


def test_neutral_stays_neutral_between_all_spaces():
    for source in light.SPACES:
        for target in light.SPACES:
            np.testing.assert_allclose(light.matrix(source, target).sum(axis=1), 1.0, rtol=1e-12)


def test_a_space_with_its_own_white_gives_the_plain_matrix():
    rec709 = light.SPACES["rec709"]
    plain = light.matrix("rec709", "xyz", white=rec709.white)
    np.testing.assert_allclose(plain, rec709.to_xyz, rtol=1e-12, atol=1e-15)


def test_a_space_of_ones_own():
    same = light.space_from_primaries("mine", [(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)], (0.3127, 0.329))
    np.testing.assert_allclose(light.matrix(same, "rec709"), np.eye(3), atol=1e-14)
    np.testing.assert_allclose(light.from_xyz(SOME, same), light.from_xyz(SOME, "rec709"))


@pytest.mark.parametrize(
    ("given", "wanted"), [(np.float32, np.float32), (np.float64, np.float64), (int, float)]
)
def test_types_and_shapes_stay(given, wanted):
    for shape in [(3,), (4, 3), (2, 4, 3), (0, 3)]:
        made = light.from_xyz(np.ones(shape, dtype=given))
        assert made.dtype == wanted
        assert made.shape == shape


def test_float32_agrees_with_float64():
    np.testing.assert_allclose(light.from_xyz(SOME.astype(np.float32)), light.from_xyz(SOME), atol=3e-6)


def test_out_of_gamut_stays_negative():
    cyan = light.from_xyz(light.white(light.line(500e-9)), "rec709")
    assert cyan[0] < -0.5
    assert light.from_xyz(light.to_xyz(cyan))[0] == pytest.approx(cyan[0])


@pytest.mark.parametrize("channels", [3, 4])
def test_convert_pictures(channels):
    pixels = np.random.default_rng(1).uniform(0, 3, (6, 5, channels)).astype(np.float32)
    picture = Picture(pixels, "rec709", {"owner": "nobody"})
    there = light.convert(picture, "acescg")
    back = light.convert(there, "rec709")
    assert (there.colour_space, there.metadata) == ("acescg", {"owner": "nobody"})
    assert there.pixels.dtype == np.float32
    assert there.pixels.flags.c_contiguous
    np.testing.assert_allclose(back.pixels, pixels, atol=3e-6)
    np.testing.assert_array_equal(there.pixels[..., 3:], pixels[..., 3:])
    assert light.convert(picture, "rec709") is picture


def test_convert_heeds_a_pictures_own_white():
    white = light.white(light.illuminant("A"))
    pixels = np.broadcast_to(white, (2, 2, 3)).astype(np.float32)
    picture = Picture(pixels, "xyz", {"white_xyz": tuple(white), "frame": 7})
    neutral = light.convert(picture, "rec2020")
    np.testing.assert_allclose(neutral.pixels, 1.0, atol=1e-6)
    assert neutral.metadata == {"frame": 7}
    warm = light.convert(Picture(pixels, "xyz"), "rec2020").pixels[0, 0]
    assert warm[0] > warm[1] > warm[2]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: light.from_xyz(SOME, "rec790"),
            "'target' must be one of 'rec709', 'acescg', 'rec2020', 'aces2065-1', 'xyz', got 'rec790'."
            " Did you mean 'rec709'?",
        ),
        (lambda: light.matrix("srgb", "xyz"), "'source' must be one of 'rec709', 'acescg', "),
        (lambda: light.convert(Picture(np.zeros((1, 1, 3), np.float32)), "aces"), "'space' must be one of "),
        (lambda: light.from_xyz(np.ones((3, 4))), "'xyz' must be an array of shape (..., 3), got (3, 4)."),
        (lambda: light.to_xyz(1.0), "'rgb' must be an array of shape (..., 3), got ()."),
        (lambda: light.from_xyz(SOME, white=[1, 0, 1]), "'white' must have a luminance Y > 0, got 0."),
        (lambda: light.from_xyz(SOME, white=[1, 1]), "'white' must be an array of shape (3), got (2,)."),
        (
            lambda: light.from_xyz(SOME, white=light.white(light.line(550e-9))),
            "'white' (0.436, 1, 0.00879) is too saturated to adapt to: a Bradford cone does not respond"
            " to it. Leave the white out, or treat the light as neutral.",
        ),
        (
            lambda: light.matrix("rec709", "acescg", white=[1, 1, 1]),
            "'white' belongs to XYZ; from 'rec709' to 'acescg' it has no use.",
        ),
        (
            lambda: light.space_from_primaries("flat", [(0, 0), (0.5, 0.5), (1, 1)], (0.3, 0.3)),
            "'primaries' must span a triangle, got [[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]].",
        ),
        (
            lambda: light.space_from_primaries("dark", [(1, 0), (0, 1), (0, 0)], (0.3, 0.0)),
            "'white' must be a chromaticity with y > 0, got [0.3, 0.0].",
        ),
    ],
)
def test_refusals(call, message):
    with pytest.raises(refuse.Refusal) as refusal:
        call()
    assert str(refusal.value).startswith(message)


@pytest.mark.parametrize("nanometres", range(380, 781, 10))
def test_no_line_as_white_gives_nan(nanometres):
    """A line is adapted to where its cones allow it, and refused elsewhere; never NaN."""
    white = light.white(light.line(nanometres * 1e-9))
    if np.all(spaces.BRADFORD @ white > 1e-6):
        np.testing.assert_allclose(light.from_xyz(white, "rec709", white), 1.0, rtol=1e-6)
    else:
        with pytest.raises(refuse.Refusal, match="too saturated"):
            light.from_xyz(white, "rec709", white)
