"""Colour is found by name: plain, grey, in a layer, in any order."""

import numpy as np
import picture_samples as samples
import pytest

from aureole import picture
from aureole.picture.channels import choose_colour

CHOICES = [
    (("A", "B", "G", "R"), ("R", "G", "B"), "A", ""),
    (("Z", "b", "g", "r"), ("r", "g", "b"), None, ""),
    (("R", "G", "B", "beauty.R", "beauty.A"), ("R", "G", "B"), None, ""),
    (("BY", "RY", "Y", "A"), ("Y", "RY", "BY"), "A", ""),
    (("Y", "A"), ("Y",), "A", ""),
    (("density",), ("density",), None, ""),
    (("Z", "key.R", "key.G", "key.B", "key.A", "rim.R"), ("key.R", "key.G", "key.B"), "key.A", "key"),
    (("a.b.B", "a.b.G", "a.b.R"), ("a.b.R", "a.b.G", "a.b.B"), None, "a.b"),
    (("A", "key.R", "key.G", "key.B"), ("key.R", "key.G", "key.B"), None, "key"),
]


@pytest.mark.parametrize(("names", "colour", "alpha", "layer"), CHOICES)
def test_colour_is_chosen_by_name(names, colour, alpha, layer):
    chosen, note = choose_colour(names)
    assert (chosen.names, chosen.alpha) == (colour, alpha)
    assert (layer in note) if layer else note == ""


@pytest.mark.parametrize("names", [("R", "G"), ("Z", "id"), ("N.X", "N.Y", "N.Z")])
def test_what_is_no_picture_is_not_chosen(names):
    assert choose_colour(names)[0] is None


def test_the_first_layer_is_read_with_a_note_and_keeps_its_names(tmp_path):
    pixels = samples.light(channels=4)
    layer = {f"beauty.{name}": plane for name, plane in samples.planes(pixels).items()}
    other = {f"rim.{name}": plane for name, plane in samples.planes(samples.light(seed=2)).items()}
    source = samples.write_exr(tmp_path / "in.exr", {**other, **layer})
    read = picture.read(source)
    np.testing.assert_array_equal(read.pixels, pixels)
    assert picture.notes(read) == (
        "'in.exr': there is no plain R, G, B; the first layer, 'beauty', is read.",
    )
    picture.write(tmp_path / "out.exr", read)
    before, after = samples.exr_channels(source), samples.exr_channels(tmp_path / "out.exr")
    assert set(before) == set(after)
    for name in before:
        np.testing.assert_array_equal(before[name], after[name])


@pytest.mark.parametrize("names", ["Y", "YA"])
def test_grey_is_read_on_all_three_and_written_as_grey(tmp_path, names):
    pixels = samples.light(channels=len(names))
    read = picture.read(samples.write_exr(tmp_path / "in.exr", samples.planes(pixels, names)))
    assert read.pixels.shape == (*samples.SHAPE, 2 + len(names))
    for k in range(3):
        np.testing.assert_array_equal(read.pixels[..., k], pixels[..., 0])
    picture.write(tmp_path / "out.exr", read)
    back = samples.exr_channels(tmp_path / "out.exr")
    assert set(back) == set(names)
    np.testing.assert_array_equal(back["Y"], pixels[..., 0])


def test_grey_that_took_on_colour_is_written_in_colour(tmp_path):
    read = picture.read(
        samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light(channels=1), "Y"))
    )
    read.pixels[..., 0] *= 2
    picture.write(tmp_path / "out.exr", read)
    np.testing.assert_array_equal(samples.read_oiio(tmp_path / "out.exr"), read.pixels)


def test_whole_numbers_in_exr_are_values_not_shares(tmp_path):
    counts = np.arange(samples.SHAPE[0] * samples.SHAPE[1], dtype=np.uint32).reshape(samples.SHAPE)
    read = picture.read(samples.write_exr(tmp_path / "in.exr", {"Y": counts}))
    np.testing.assert_array_equal(read.pixels[..., 1], counts.astype(np.float32))
    picture.write(tmp_path / "out.exr", read)
    assert picture.describe(tmp_path / "out.exr").pixel_type == "float"
