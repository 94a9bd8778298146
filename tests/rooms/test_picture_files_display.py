"""PNG, JPEG, TIFF and HDR: sRGB in and out, straight alpha, gamut, orientation."""

from dataclasses import replace

import numpy as np
import picture_samples as samples
import pytest

from aureole import light, picture
from aureole.picture.primaries import CHROMATICITIES, conversion, to_xyz
from aureole.picture.transfer import into_gamut
from aureole.records import Picture

# IEC 61966-2-1 (sRGB): the linear RGB to XYZ matrix and back, as printed.
IEC_TO_XYZ = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
IEC_FROM_XYZ = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
PRINTED = 6e-5
# Eight-bit codes and their linear light by the standard's equations: below and above the knee at
# 0.04045 (0.0031308), and the middle.
CODES = {0: 0.0, 1: 0.000303527, 10: 0.00303527, 11: 0.00334654, 128: 0.2158605, 188: 0.5028865, 255: 1.0}


@pytest.mark.parametrize(("code", "linear"), CODES.items())
def test_srgb_values_of_the_standard(code, linear):
    assert picture.decode_srgb(np.float32(code / 255)) == pytest.approx(linear, rel=2e-6, abs=1e-12)
    assert picture.encode_srgb(np.float32(linear)) * 255 == pytest.approx(code, abs=1e-3)


def test_rec709_matrices_of_the_standard():
    matrix = to_xyz((0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290))
    np.testing.assert_allclose(matrix, IEC_TO_XYZ, atol=PRINTED)
    np.testing.assert_allclose(np.linalg.inv(matrix), IEC_FROM_XYZ, atol=4e-4)  # the inverse of the rounded


@pytest.mark.parametrize("space", ["acescg", "rec2020", "xyz", "aces2065-1"])
def test_conversion_keeps_white(space):
    np.testing.assert_allclose(conversion(space).sum(axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(conversion(space) @ conversion("rec709", space), np.eye(3), atol=1e-12)


def test_the_light_room_means_the_same_spaces():
    assert set(CHROMATICITIES) == set(light.SPACES)
    for name, space in light.SPACES.items():
        np.testing.assert_allclose(to_xyz(CHROMATICITIES[name]), space.to_xyz, atol=1e-6)


def test_ap0_to_ap1_matrix_of_the_academy():
    # ACES S-2014-004, appendix: AP0 to AP1.
    expected = [
        [1.4514393161, -0.2365107469, -0.2149285693],
        [-0.0765537734, 1.1762296998, -0.0996759264],
        [0.0083161484, -0.0060324498, 0.9977163014],
    ]
    np.testing.assert_allclose(conversion("aces2065-1", "acescg"), expected, atol=1e-9)


@pytest.mark.parametrize(
    ("suffix", "type"), [("png", "uint8"), ("png", "uint16"), ("tif", "uint8"), ("tif", "uint16")]
)
def test_every_code_comes_back(tmp_path, suffix, type):
    largest = np.iinfo(type).max
    codes = np.linspace(0, largest, 256 * 64).round().astype(type).reshape(64, 256)
    pixels = np.stack([codes, codes[::-1], codes[:, ::-1]], axis=-1)
    source = samples.write_oiio(tmp_path / f"in.{suffix}", pixels, type)
    read = picture.read(source)
    expected = picture.decode_srgb(pixels.astype(np.float32) / np.float32(largest))
    np.testing.assert_allclose(read.pixels, expected, rtol=1e-6)
    assert picture.write(tmp_path / f"out.{suffix}", read) == ()
    np.testing.assert_array_equal(samples.read_oiio(tmp_path / f"out.{suffix}", type), pixels)


def test_transfer_can_be_overridden(tmp_path):
    source = samples.write_oiio(tmp_path / "in.png", np.full((2, 2, 3), 128, np.uint8), "uint8")
    assert picture.read(source, transfer="linear").pixels[0, 0, 0] == np.float32(128 / 255)
    floats = samples.write_oiio(tmp_path / "in.tif", np.full((2, 2, 3), 0.5, np.float32), "float")
    assert picture.read(floats).pixels[0, 0, 0] == 0.5
    assert picture.read(floats, transfer="srgb").pixels[0, 0, 0] == pytest.approx(0.214041, rel=1e-5)
    grey = Picture(np.full((2, 2, 3), 0.5, np.float32))
    picture.write(tmp_path / "out.png", grey, transfer="linear")
    assert samples.read_oiio(tmp_path / "out.png", "uint8")[0, 0, 0] == 128
    picture.write(tmp_path / "out.png", grey)
    assert samples.read_oiio(tmp_path / "out.png", "uint8")[0, 0, 0] == 188


@pytest.mark.parametrize(("suffix", "type"), [("png", "uint8"), ("tif", "uint16")])
def test_straight_alpha_is_multiplied_in_after_decoding(tmp_path, suffix, type):
    largest = np.iinfo(type).max
    pixels = np.random.default_rng(5).integers(0, largest, (9, 11, 4), dtype=type, endpoint=True)
    pixels[0, 0] = 10, 20, 30, 0
    pixels[..., 3] = np.maximum(pixels[..., 3], largest // 8)
    source = samples.write_oiio(tmp_path / f"in.{suffix}", pixels, type, oiio__UnassociatedAlpha=1)
    read = picture.read(source)
    share = pixels.astype(np.float32) / np.float32(largest)
    np.testing.assert_allclose(
        read.pixels[..., :3], picture.decode_srgb(share[..., :3]) * share[..., 3:], rtol=1e-5
    )
    picture.write(tmp_path / f"out.{suffix}", read)
    back = picture.read(tmp_path / f"out.{suffix}")
    np.testing.assert_allclose(back.pixels, read.pixels, atol=2.0 / largest)


def test_light_without_cover_is_shown_on_black(tmp_path):
    pixels = np.zeros((3, 3, 4), np.float32)
    pixels[1, 1, :3] = 0.5
    notes = picture.write(tmp_path / "out.png", Picture(pixels))
    assert notes == ("'out.png': it is written as it looks on black, without its alpha.",)
    assert samples.read_oiio(tmp_path / "out.png", "uint8").shape == (3, 3, 3)
    assert samples.read_oiio(tmp_path / "out.png", "uint8")[1, 1].tolist() == [188] * 3


def test_float_tiff_keeps_everything_in_range_or_not(tmp_path):
    made = Picture(samples.light(channels=4, dtype=np.float32) * 1e6)
    assert picture.write(tmp_path / "out.tif", made) == ()
    np.testing.assert_array_equal(picture.read(tmp_path / "out.tif").pixels, made.pixels)


def test_radiance_hdr_comes_back_within_its_eight_bits(tmp_path):
    made = Picture(np.abs(samples.light(dtype=np.float32)) * 1000)
    picture.write(tmp_path / "out.hdr", made)
    back = picture.read(tmp_path / "out.hdr")
    brightest = made.pixels.max(axis=-1, keepdims=True)
    assert (np.abs(back.pixels - made.pixels) / brightest).max() < 1 / 128
    assert picture.describe(tmp_path / "out.hdr").format == "hdr"


def test_jpeg_comes_close(tmp_path):
    ramp = np.linspace(0, 1, 64, dtype=np.float32)
    made = Picture(np.broadcast_to(ramp[None, :, None], (32, 64, 3)).copy())
    picture.write(tmp_path / "out.jpg", made)
    codes = picture.encode_srgb(picture.read(tmp_path / "out.jpg").pixels)
    np.testing.assert_allclose(codes, picture.encode_srgb(made.pixels), atol=3 / 255)


def test_colours_out_of_gamut_keep_hue_and_luminance():
    weights = np.array([0.2126, 0.7152, 0.0722], np.float32)
    colours = np.array([[[-0.2, 0.5, 0.4], [0.3, 0.2, 0.1], [2.0, -0.5, 0.0], [-1, -1, -1]]], np.float32)
    mended = into_gamut(colours)
    assert (mended >= 0).all()
    np.testing.assert_array_equal(mended[0, 1], colours[0, 1])
    np.testing.assert_allclose(mended[0, :3] @ weights, colours[0, :3] @ weights, rtol=1e-5)
    np.testing.assert_array_equal(mended[0, 3], 0)
    assert mended[0, 0, 0] == pytest.approx(0, abs=1e-7)


def test_wide_gamut_is_converted_for_a_display(tmp_path):
    white = Picture(np.ones((2, 2, 3), np.float32), "acescg")
    notes = picture.write(tmp_path / "out.png", white)
    assert notes == ("'out.png': colour is converted from acescg to rec709.",)
    assert (samples.read_oiio(tmp_path / "out.png", "uint8") == 255).all()


def test_what_png_cannot_hold_is_said(tmp_path):
    planes = samples.planes(np.abs(samples.light(scale=0.1))) | {"Z": samples.light()[..., 0].copy()}
    header = {"dataWindow": ((-2, 0), (50, 36)), "displayWindow": ((0, 0), (48, 36))}
    read = picture.read(samples.write_exr(tmp_path / "in.exr", planes, header))
    assert picture.write(tmp_path / "out.png", read) == (
        "'out.png': only EXR holds the channels Z; they are left out.",
        "'out.png': only EXR holds a display window; all pixels of the data window are written.",
    )


TURNS = {
    1: lambda a: a,
    2: lambda a: a[:, ::-1],
    3: lambda a: a[::-1, ::-1],
    4: lambda a: a[::-1],
    5: lambda a: a.swapaxes(0, 1),
    6: lambda a: np.rot90(a, -1),
    7: lambda a: np.rot90(a, 2).swapaxes(0, 1),
    8: lambda a: np.rot90(a),
}


@pytest.mark.parametrize("orientation", TURNS)
def test_a_photo_is_turned_upright(tmp_path, orientation):
    pixels = np.random.default_rng(1).integers(0, 255, (5, 9, 3), dtype=np.uint8)
    source = samples.write_oiio(tmp_path / "in.tif", pixels, "uint8", Orientation=orientation)
    read = picture.read(source, transfer="linear")
    np.testing.assert_allclose(read.pixels * 255, TURNS[orientation](pixels), atol=1e-4)
    assert picture.header_of(read).shape == read.pixels.shape[:2]
    picture.write(tmp_path / "out.tif", read, transfer="linear")
    assert samples.read_oiio(tmp_path / "out.tif", "uint8").tolist() == TURNS[orientation](pixels).tolist()


@pytest.mark.parametrize("channels", [1, 2])
def test_grey_png_comes_back_as_grey(tmp_path, channels):
    pixels = np.full((4, 5, channels), 128, np.uint8)
    read = picture.read(samples.write_oiio(tmp_path / "in.png", pixels, "uint8", oiio__UnassociatedAlpha=1))
    picture.write(tmp_path / "out.png", read)
    assert [channel.name for channel in picture.describe(tmp_path / "out.png").channels] == ["Y", "A"][
        :channels
    ]
    assert (
        samples.read_oiio(tmp_path / "out.png", "uint8")[..., 0]
        == samples.read_oiio(tmp_path / "in.png", "uint8")[..., 0]
    ).all()


def test_attributes_reach_other_formats(tmp_path):
    header = {"owner": "me", "capDate": "2024:01:02 03:04:05"}
    source = samples.write_exr(tmp_path / "in.exr", samples.planes(np.abs(samples.light())), header)
    read = picture.read(source)
    picture.write(tmp_path / "out.tif", replace(read, pixels=read.pixels * 2))
    found = picture.describe(tmp_path / "out.tif").attributes
    assert found["Copyright"].value == "me"
    assert found["DateTime"].value == "2024:01:02 03:04:05"
