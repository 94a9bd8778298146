"""Luminance/chroma EXR against the colour it was made from."""

import struct

import numpy as np
import picture_samples as samples
import pytest

from aureole import picture, refuse
from aureole.picture.luminance_chroma import to_rgb
from aureole.picture.primaries import CHROMATICITIES, luminance_weights

# Rec.709's weights as printed in ITU-R BT.709.
PRINTED_WEIGHTS = (0.2126, 0.7152, 0.0722)
# Half has eleven bits; three roundings (Y, chroma, filter) meet in a channel.
HALF_ERROR = 4 * 2.0**-11


def smooth_colour(shape=(64, 96)):
    """Colour whose chroma changes slowly and whose luminance does not, up to bright lamps."""
    y, x = np.mgrid[: shape[0], : shape[1]] / 40.0
    chroma = np.stack([1 + 0.3 * np.sin(x), 1 + 0.2 * np.cos(y + 1), 1 + 0.3 * np.sin(x - y)], axis=-1)
    light = np.exp(np.random.default_rng(4).normal(size=shape))
    light[10, 20] = 500.0
    return (chroma * light[..., None]).astype(np.float32)


def taken_apart(rgb, weights, step=2):
    luminance = rgb @ np.asarray(weights, np.float32)
    red, blue = ((rgb[..., k] / luminance - 1)[::step, ::step] for k in (0, 2))
    return luminance, red, blue


def test_weights_are_those_of_the_standard():
    assert luminance_weights(CHROMATICITIES["rec709"]) == pytest.approx(PRINTED_WEIGHTS, abs=5e-5)


@pytest.mark.parametrize("origin", [(0, 0), (-4, 6)])
def test_the_original_colour_comes_back(tmp_path, origin):
    rgb = smooth_colour()
    y, ry, by = taken_apart(rgb, luminance_weights(CHROMATICITIES["rec709"]))
    parts = {"Y": (y.astype("f2"), 1), "RY": (ry.astype("f2"), 2), "BY": (by.astype("f2"), 2)}
    read = picture.read(samples.write_subsampled(tmp_path / "in.exr", parts, origin))
    inner = np.s_[14:-14, 14:-14]  # the filter looks thirteen pixels far
    np.testing.assert_allclose(read.pixels[inner], rgb[inner], rtol=HALF_ERROR)
    np.testing.assert_allclose(read.pixels, rgb, rtol=0.05)
    header = picture.header_of(read)
    assert (header.data_window.x, header.data_window.y) == origin
    assert picture.notes(read) == ("'in.exr': luminance and chroma are read as RGB.",)


def test_the_files_primaries_give_the_weights(tmp_path):
    rgb, wide = smooth_colour(), CHROMATICITIES["acescg"]
    y, ry, by = taken_apart(rgb, luminance_weights(wide))
    said = samples.exr_attribute("chromaticities", "chromaticities", struct.pack("<8f", *wide))
    said += samples.exr_attribute("owner", "string", b"me")
    parts = {"Y": (y, 1), "RY": (ry, 2), "BY": (by, 2)}
    read = picture.read(samples.write_subsampled(tmp_path / "in.exr", parts, attributes=said))
    assert read.colour_space == "acescg"
    assert picture.header_of(read).attributes["Copyright"].value == "me"
    np.testing.assert_allclose(read.pixels[14:-14, 14:-14], rgb[14:-14, 14:-14], rtol=1e-3)


def test_it_is_written_as_ordinary_rgb(tmp_path):
    y, ry, by = taken_apart(smooth_colour(), luminance_weights(CHROMATICITIES["rec709"]))
    alpha = np.full(y.shape, 0.5, np.float16)
    parts = {
        "Y": (y.astype("f2"), 1),
        "RY": (ry.astype("f2"), 2),
        "BY": (by.astype("f2"), 2),
        "A": (alpha, 1),
    }
    read = picture.read(samples.write_subsampled(tmp_path / "in.exr", parts))
    assert read.pixels.shape == (*y.shape, 4)
    picture.write(tmp_path / "out.exr", read)
    assert set(samples.exr_channels(tmp_path / "out.exr")) == set("RGBA")
    assert picture.describe(tmp_path / "out.exr").pixel_type == "half"
    np.testing.assert_array_equal(samples.read_oiio(tmp_path / "out.exr"), read.pixels.astype(np.float16))


def test_full_chroma_is_read_as_it_is(tmp_path):
    rgb = smooth_colour((32, 32))
    y, ry, by = taken_apart(rgb, luminance_weights(CHROMATICITIES["rec709"]), step=1)
    source = samples.write_exr(tmp_path / "in.exr", {"Y": y, "RY": ry.copy(), "BY": by.copy()})
    np.testing.assert_allclose(picture.read(source).pixels, rgb, rtol=1e-4)


def test_grey_stays_exactly_grey():
    y = np.abs(samples.light((8, 8))[..., 0]).astype(np.float32)
    rgb = to_rgb(y, np.zeros((4, 4)), np.zeros((4, 4)), np.array(PRINTED_WEIGHTS))
    for k in range(3):
        np.testing.assert_array_equal(rgb[..., k], y)


def test_a_pixel_of_stray_saturation_is_tamed_at_the_same_luminance():
    y = np.ones((16, 16), np.float32)
    chroma = np.zeros((8, 8), np.float32)
    chroma[4, 4] = 3.0
    weights = np.array(PRINTED_WEIGHTS)
    rgb = to_rgb(y, chroma, np.zeros_like(chroma), weights)
    assert rgb[8, 8, 0] < 4.0  # what the file says there
    assert (rgb[8, 8] >= 0).all()
    assert rgb[8, 8] @ weights == pytest.approx(1, abs=1e-6)


def test_other_subsampling_is_refused(tmp_path):
    plane = np.ones((8, 8), np.float16)
    parts = {"Y": (plane, 1), "RY": (plane[:2, :2].copy(), 4), "BY": (plane[:2, :2].copy(), 4)}
    source = samples.write_subsampled(tmp_path / "in.exr", parts)
    with pytest.raises(refuse.Refusal, match=r"channel \w+ subsampled 4 x 4; only chroma by 2 is read\.$"):
        picture.read(source)
    parts = {"Y": (plane, 1), "Z": (plane[:4, :4].copy(), 2)}
    source = samples.write_subsampled(tmp_path / "in.exr", parts)
    with pytest.raises(refuse.Refusal, match=r"has subsampled channels other than RY and BY: Y, Z\.$"):
        picture.read(source)


def test_a_cut_file_is_refused(tmp_path):
    y, ry, by = taken_apart(smooth_colour(), luminance_weights(CHROMATICITIES["rec709"]))
    parts = {"Y": (y, 1), "RY": (ry, 2), "BY": (by, 2)}
    source = samples.write_subsampled(tmp_path / "in.exr", parts)
    source.write_bytes(source.read_bytes()[:-100])
    with pytest.raises(refuse.Refusal, match=r"'.*in\.exr' is damaged or cut short: .*\.$"):
        picture.read(source)


def test_what_cannot_be_carried_is_said(tmp_path):
    plane = np.ones((4, 4), np.float16)
    parts = {"Y": (plane, 1), "RY": (plane[:2, :2].copy(), 2), "BY": (plane[:2, :2].copy(), 2)}
    odd = samples.exr_attribute("odd", "oddtype", b"abc")
    header = picture.describe(samples.write_subsampled(tmp_path / "in.exr", parts, attributes=odd))
    assert header.notes[1:] == ("'in.exr': attributes that cannot be carried: odd.",)
    assert header.compression == "none"
