"""EXR in and out: what goes in comes out, bit for bit, and what cannot is said."""

import struct
from dataclasses import replace

import numpy as np
import OpenEXR
import OpenImageIO
import picture_samples as samples
import pytest

from aureole import picture
from aureole.records import Picture


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
@pytest.mark.parametrize("channels", [3, 4])
def test_pixels_come_back_bit_for_bit(tmp_path, dtype, channels):
    pixels = samples.light(channels=channels, dtype=dtype)
    if dtype == np.float32:
        pixels *= np.float32(np.pi)  # more digits than half has
    source = samples.write_exr(tmp_path / "in.exr", samples.planes(pixels, dtype=dtype))
    read = picture.read(source)
    assert read.pixels.dtype == np.float32
    np.testing.assert_array_equal(read.pixels, pixels.astype(np.float32))
    assert picture.write(tmp_path / "out.exr", read) == ()
    for name, plane in samples.exr_channels(source).items():
        back = samples.exr_channels(tmp_path / "out.exr")[name]
        assert back.dtype == dtype
        np.testing.assert_array_equal(back, plane)


WINDOWS = {"dataWindow": ((-8, -5), (44, 31)), "displayWindow": ((0, 0), (39, 25))}
ATTRIBUTES = {
    "timeCode": OpenEXR.TimeCode(1, 2, 3, 4, 1, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8),
    "keyCode": OpenEXR.KeyCode(1, 2, 3, 4, 5, 4, 64),
    "aperture": 8.0,
    "capDate": "2024:01:02 03:04:05",
    "expTime": 0.5,
    "focus": float("inf"),
    "camera": "one of ours",
    "take": 7,
    "worldToCamera": np.arange(16, dtype="f4").reshape(4, 4),
    "screenWindowCenter": np.array([0.25, 0.5], "f4"),
    "screenWindowWidth": 1.25,
    "adoptedNeutral": np.array([0.3, 0.31], "f4"),
    "multi": ["a", "b"],
    "pixelAspectRatio": 2.0,
}


def test_windows_and_attributes_come_back(tmp_path):
    header = {**WINDOWS, **ATTRIBUTES}
    source = samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light()), header)
    read = picture.read(source)
    found = picture.header_of(read)
    assert found.data_window == picture.Window(-8, -5, 53, 37)
    assert found.display_window == picture.Window(0, 0, 40, 26)
    assert found.pixel_aspect == 2.0
    assert found.attributes["FNumber"] == picture.Attribute("float", 8.0)
    picture.write(tmp_path / "out.exr", read)
    before, after = samples.exr_header(source), samples.exr_header(tmp_path / "out.exr")
    assert set(before) == set(after)
    for name in before:
        assert str(before[name]) == str(after[name]), name


def test_attributes_of_other_times_and_programs(tmp_path):
    attributes = samples.exr_attribute("owner", "string", "Grüße".encode("latin-1"))
    attributes += samples.exr_attribute("framesPerSecond", "rational", struct.pack("<iI", 24000, 1001))
    attributes += samples.exr_attribute("odd", "oddtype", b"abc")
    plane = np.ones((4, 4), np.float32)
    identifiers = np.arange(16, dtype=np.uint32).reshape(4, 4) + 4_000_000_000
    parts = {"Y": (plane, 1), "id": (identifiers, 1)}
    read = picture.read(samples.write_subsampled(tmp_path / "in.exr", parts, attributes=attributes))
    assert picture.notes(read) == ("'in.exr': attributes that cannot be carried: odd.",)
    picture.write(tmp_path / "out.exr", read)
    after = samples.exr_header(tmp_path / "out.exr")
    assert after["owner"] == "Grüße"
    assert str(after["framesPerSecond"]) == "24000/1001"
    np.testing.assert_array_equal(samples.exr_channels(tmp_path / "out.exr")["id"], identifiers)


def test_no_date_is_invented(tmp_path):
    picture.write(tmp_path / "out.exr", Picture(samples.light(dtype=np.float32)))
    assert "capDate" not in samples.exr_header(tmp_path / "out.exr")


def test_a_picture_of_another_size_gets_windows_of_its_own(tmp_path):
    planes = samples.planes(samples.light()) | {"Z": samples.light(dtype=np.float32)[..., 0]}
    read = picture.read(samples.write_exr(tmp_path / "in.exr", planes, WINDOWS))
    padded = replace(read, pixels=np.pad(read.pixels, ((4, 4), (4, 4), (0, 0))))
    notes = picture.write(tmp_path / "out.exr", padded)
    assert notes == ("'out.exr': channel 'Z' is left out, as the picture's size has changed.",)
    described = picture.describe(tmp_path / "out.exr")
    assert described.data_window == described.display_window == picture.Window(0, 0, 61, 45)


def test_light_under_alpha_zero_is_left_alone(tmp_path):
    pixels = np.abs(samples.light(channels=4))
    pixels[::2, :, 3] = 0
    source = samples.write_exr(tmp_path / "in.exr", samples.planes(pixels))
    read = picture.read(source)
    np.testing.assert_array_equal(read.pixels, pixels)
    picture.write(tmp_path / "out.exr", read)
    np.testing.assert_array_equal(samples.read_oiio(tmp_path / "out.exr"), pixels)


def test_extra_channels_come_back_in_their_own_type(tmp_path):
    generator = np.random.default_rng(3)
    depth = generator.normal(size=samples.SHAPE).astype(np.float32) * 1e10
    depth[0, :2] = np.inf, np.nan  # no colour: nobody minds
    identifiers = generator.integers(0, 2**32, samples.SHAPE, dtype=np.uint32)
    identifiers[0, :3] = 0, 1, 2**32 - 1
    extra = {"Z": depth, "id": identifiers, "diffuse.R": samples.light()[..., 0].copy()}
    source = samples.write_exr(
        tmp_path / "in.exr", samples.planes(samples.light(channels=4)) | extra, {**WINDOWS, "owner": "me"}
    )
    read = picture.read(source)
    assert set(picture.extra_channels(read)) == set(extra)
    assert picture.write(tmp_path / "out.exr", read) == ()
    before, after = samples.exr_channels(source), samples.exr_channels(tmp_path / "out.exr")
    assert set(before) == set(after)
    for name in before:
        assert before[name].dtype == after[name].dtype
        np.testing.assert_array_equal(before[name], after[name])
    assert samples.exr_header(tmp_path / "out.exr")["owner"] == "me"


def test_tiles_come_back(tmp_path):
    header = {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
    header["tiles"].xSize, header["tiles"].ySize = 32, 16
    source = samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light()), header)
    read = picture.read(source)
    assert picture.header_of(read).tile == (16, 32)
    picture.write(tmp_path / "out.exr", read)
    assert samples.exr_header(tmp_path / "out.exr")["tiles"].ySize == 16
    np.testing.assert_array_equal(samples.read_oiio(tmp_path / "out.exr"), samples.light())


def test_the_first_part_of_several_is_read_with_a_note(tmp_path):
    parts = [
        OpenEXR.Part({"type": OpenEXR.scanlineimage}, samples.planes(samples.light(seed=seed)), name)
        for seed, name in ((1, "left"), (2, "right"))
    ]
    OpenEXR.File(parts).write(str(tmp_path / "in.exr"))
    read = picture.read(tmp_path / "in.exr")
    np.testing.assert_array_equal(read.pixels, samples.light(seed=1))
    assert picture.notes(read) == ("'in.exr': it has 2 parts; the first, 'left', is read.",)
    assert picture.write(tmp_path / "out.exr", read) == ()
    np.testing.assert_array_equal(samples.read_oiio(tmp_path / "out.exr"), samples.light(seed=1))


def test_a_mipmap_is_written_as_its_full_size(tmp_path):
    image = OpenImageIO.ImageBuf(samples.light((64, 64), dtype=np.float32))
    config = OpenImageIO.ImageSpec()
    OpenImageIO.ImageBufAlgo.make_texture(OpenImageIO.MakeTxTexture, image, str(tmp_path / "in.exr"), config)
    read = picture.read(tmp_path / "in.exr")
    picture.write(tmp_path / "out.exr", read)
    np.testing.assert_array_equal(samples.read_oiio(tmp_path / "out.exr"), samples.light((64, 64)))


COMPRESSIONS = [
    ("NO", "none", False),
    ("RLE", "rle", False),
    ("ZIPS", "zips", False),
    ("PIZ", "piz", False),
    ("PXR24", "zip", True),
    ("B44", "zip", True),
    ("DWAA", "zip", True),
    ("DWAB", "zip", True),
]


@pytest.mark.parametrize(("source", "expected", "noted"), COMPRESSIONS)
def test_compression_is_kept_where_it_loses_nothing(tmp_path, source, expected, noted):
    header = {"compression": getattr(OpenEXR, f"{source}_COMPRESSION")}
    read = picture.read(samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light()), header))
    notes = picture.write(tmp_path / "out.exr", read)
    assert picture.describe(tmp_path / "out.exr").compression == expected
    text = f"'out.exr': the source's compression '{source.lower()}' loses detail, so zip is used."
    assert notes == ((text,) if noted else ())
    np.testing.assert_array_equal(samples.read_oiio(tmp_path / "out.exr"), read.pixels)


def test_a_lossy_compression_is_used_where_it_is_asked_for(tmp_path):
    picture.write(tmp_path / "out.exr", Picture(samples.light(dtype=np.float32)), compression="dwaa")
    assert picture.describe(tmp_path / "out.exr").compression.startswith("dwaa")


def test_what_overflows_half_is_stored_as_float(tmp_path):
    read = picture.read(samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light())))
    bright = read.pixels.copy()
    bright[3, 4] = 70000
    notes = picture.write(tmp_path / "out.exr", replace(read, pixels=bright))
    assert notes == ("'out.exr': values beyond 65504 do not fit in half, so it is stored as float.",)
    np.testing.assert_array_equal(samples.read_oiio(tmp_path / "out.exr"), bright)


def test_a_made_picture_is_float_unless_half_is_asked_for(tmp_path):
    made = Picture(samples.light(dtype=np.float32))
    picture.write(tmp_path / "out.exr", made)
    assert picture.describe(tmp_path / "out.exr").pixel_type == "float"
    picture.write(tmp_path / "out.exr", made, pixel_type="half")
    assert picture.describe(tmp_path / "out.exr").pixel_type == "half"


# (x, y) of red, green, blue, white as other programs write them.
PRIMARIES = {
    "rec709": (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329),
    "acescg": (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767),
    "rec2020": (0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329),
    "xyz": (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.33333, 0.33333),
    "aces2065-1": (0.73470, 0.26530, 0.0, 1.0, 0.00010, -0.07700, 0.32168, 0.33767),
}


@pytest.mark.parametrize("space", PRIMARIES)
def test_primaries_name_the_colour_space_and_come_back(tmp_path, space):
    header = {"chromaticities": PRIMARIES[space]}
    read = picture.read(samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light()), header))
    assert read.colour_space == space
    assert picture.notes(read) == ()
    picture.write(tmp_path / "out.exr", read)
    np.testing.assert_array_equal(
        samples.exr_header(tmp_path / "out.exr")["chromaticities"],
        samples.exr_header(tmp_path / "in.exr")["chromaticities"],
    )


def test_unknown_primaries_are_carried_with_a_note(tmp_path):
    camera = (0.78, 0.31, 0.2, 0.9, 0.1, 0.02, 0.3127, 0.329)
    source = samples.write_exr(
        tmp_path / "in.exr", samples.planes(samples.light()), {"chromaticities": camera}
    )
    read = picture.read(source)
    text = "'in.exr': its primaries are none of the known spaces'; they are treated as working RGB."
    assert picture.notes(read) == (text,)
    picture.write(tmp_path / "out.exr", read)
    np.testing.assert_allclose(samples.exr_header(tmp_path / "out.exr")["chromaticities"], camera, rtol=1e-6)


def test_a_converted_picture_says_its_new_primaries(tmp_path):
    read = picture.read(samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light())))
    picture.write(tmp_path / "out.exr", replace(read, colour_space="acescg"))
    assert picture.read(tmp_path / "out.exr").colour_space == "acescg"


def test_the_aces_flag_stays_only_while_it_is_true(tmp_path):
    header = {
        "acesImageContainerFlag": 1,
        "chromaticities": PRIMARIES["aces2065-1"],
        "compression": OpenEXR.NO_COMPRESSION,
    }
    read = picture.read(samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light()), header))
    assert picture.write(tmp_path / "out.exr", read) == ()
    assert samples.exr_header(tmp_path / "out.exr")["acesImageContainerFlag"] == 1
    notes = picture.write(tmp_path / "out.exr", read, compression="zip")
    assert notes == ("'out.exr': it is no ACES container any more, so acesImageContainerFlag is left out.",)
    assert "acesImageContainerFlag" not in samples.exr_header(tmp_path / "out.exr")


def test_the_flag_alone_says_aces(tmp_path):
    header = {"acesImageContainerFlag": 1}
    source = samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light()), header)
    assert picture.read(source).colour_space == "aces2065-1"
