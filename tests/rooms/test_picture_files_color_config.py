"""Colour configurations: built in, from a file, unknown."""

import numpy as np
import picture_samples as samples
import pytest

from aureole import picture, refuse
from aureole.picture.primaries import conversion
from aureole.records import Picture

BUILT_IN = "ocio://default"
OWN = """ocio_profile_version: 2
roles: {default: raw, scene_linear: lin}
colorspaces:
  - !<ColorSpace> {name: lin}
  - !<ColorSpace> {name: raw, isdata: true}
  - !<ColorSpace>
    name: halved
    to_scene_reference: !<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]}
"""


@pytest.fixture
def own(tmp_path):
    path = tmp_path / "own.ocio"
    path.write_text(OWN)
    return path


@pytest.fixture
def source(tmp_path):
    pixels = np.abs(samples.light(channels=4))
    pixels[0, :, 3] = 0
    return samples.write_exr(tmp_path / "in.exr", samples.planes(pixels))


def test_a_named_space_is_brought_to_the_working_space(source):
    read = picture.read(source, color_config=BUILT_IN, color_space="Linear Rec.709 (sRGB)")
    plain = picture.read(source)
    assert read.colour_space == "acescg"
    expected = plain.pixels[..., :3] @ conversion("rec709", "acescg").T
    np.testing.assert_allclose(read.pixels[..., :3], expected, rtol=2e-5, atol=2e-5)
    np.testing.assert_array_equal(read.pixels[..., 3], plain.pixels[..., 3])


def test_a_configuration_decodes_instead_of_srgb(tmp_path):
    source = samples.write_oiio(tmp_path / "in.png", np.full((2, 2, 3), 128, np.uint8), "uint8")
    read = picture.read(source, color_space="sRGB Encoded Rec.709 (sRGB)", color_config=BUILT_IN)
    np.testing.assert_allclose(read.pixels, 0.2158605, rtol=1e-4)


def test_unknown_primaries_are_noted(source, own):
    read = picture.read(source, color_config=own, color_space="halved")
    np.testing.assert_array_equal(read.pixels[..., :3], 2 * picture.read(source).pixels[..., :3])
    assert read.colour_space == "rec709"
    text = "the configuration does not say which primaries 'lin' has; they are treated as working RGB."
    assert picture.notes(read) == (text,)


def test_a_role_is_a_name_too(source, own):
    read = picture.read(source, color_config=own, color_space="scene_linear")
    np.testing.assert_array_equal(read.pixels, picture.read(source).pixels)


def test_writing_is_the_way_back(source, own, tmp_path):
    read = picture.read(source, color_config=own, color_space="halved")
    picture.write(tmp_path / "out.exr", read, color_config=own, color_space="halved")
    np.testing.assert_array_equal(samples.read_oiio(tmp_path / "out.exr"), samples.read_oiio(source))


def test_written_primaries_are_those_of_the_space(source, tmp_path):
    read = picture.read(source)
    picture.write(tmp_path / "out.exr", read, color_config=BUILT_IN, color_space="ACES2065-1")
    back = picture.read(tmp_path / "out.exr")
    assert back.colour_space == "aces2065-1"
    expected = read.pixels[..., :3] @ conversion("rec709", "aces2065-1").T
    np.testing.assert_allclose(back.pixels[..., :3], expected, rtol=2e-3, atol=2e-3)


def test_a_display_space_is_not_encoded_twice(tmp_path):
    grey = Picture(np.full((2, 2, 3), 0.2158605, np.float32))
    space = "sRGB Encoded Rec.709 (sRGB)"
    picture.write(tmp_path / "out.png", grey, color_config=BUILT_IN, color_space=space)
    assert (samples.read_oiio(tmp_path / "out.png", "uint8") == 128).all()


def test_refusals(source, own, tmp_path):
    with pytest.raises(refuse.Refusal, match=r"no 'halfed'\. Did you mean 'halved'\?$"):
        picture.read(source, color_config=own, color_space="halfed")
    with pytest.raises(refuse.Refusal, match=r"^There is no colour configuration '.*no\.ocio'\.$"):
        picture.read(source, color_config=tmp_path / "no.ocio", color_space="lin")
    with pytest.raises(refuse.Refusal, match=r"^'color_config' needs 'color_space'"):
        picture.read(source, color_config=own)
    own.write_text("no configuration")
    with pytest.raises(refuse.Refusal, match=r"^The colour configuration '.*' cannot be read: .*\.$"):
        picture.read(source, color_config=own, color_space="lin")
