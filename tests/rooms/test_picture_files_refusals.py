"""What cannot be read or written is refused in one line, before any work."""

import numpy as np
import OpenEXR
import OpenImageIO
import picture_samples as samples
import pytest

from aureole import picture, refuse
from aureole.records import Picture


def refusal_of(call, *args, **options):
    with pytest.raises(refuse.Refusal) as caught:
        call(*args, **options)
    text = str(caught.value)
    assert "\n" not in text
    assert text.endswith((".", "?"))
    return text


@pytest.fixture
def source(tmp_path):
    return samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light()))


def test_a_missing_file(tmp_path):
    assert refusal_of(picture.read, tmp_path / "no.exr") == f"There is no file '{tmp_path / 'no.exr'}'."


def test_a_folder(tmp_path):
    assert refusal_of(picture.read, tmp_path) == f"'{tmp_path}' is a folder, not a picture."


@pytest.mark.parametrize("suffix", [".exrr", ".gif", ""])
def test_an_unknown_suffix(tmp_path, suffix):
    (tmp_path / f"in{suffix}").touch()
    text = refusal_of(picture.read, tmp_path / f"in{suffix}")
    assert f"'suffix of in{suffix}' must be one of '.exr', '.hdr', '.tif'" in text
    assert ("Did you mean '.exr'?" in text) == (suffix == ".exrr")


def test_an_unreadable_file(source, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: False)
    assert refusal_of(picture.read, source) == f"'{source}' cannot be read: permission denied."


@pytest.mark.parametrize("content", [b"", b"not a picture", bytes(1000), b"\x76\x2f\x31\x01"])
@pytest.mark.parametrize("suffix", [".exr", ".hdr", ".tif", ".png", ".jpg"])
def test_no_picture(tmp_path, suffix, content):
    path = tmp_path / f"in{suffix}"
    path.write_bytes(content)
    assert f"'{path}' cannot be read, it is damaged or no picture: " in refusal_of(picture.read, path)


LAYOUTS = {
    "scanlines": {},
    "rle": {"compression": OpenEXR.RLE_COMPRESSION},
    "piz": {"compression": OpenEXR.PIZ_COMPRESSION},
    "uncompressed": {"compression": OpenEXR.NO_COMPRESSION},
    "tiles": {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()},
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("share", [0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1])
def test_a_cut_exr(tmp_path, capfd, layout, share):
    pixels = samples.light((200, 160))
    source = samples.write_exr(tmp_path / "in.exr", samples.planes(pixels), LAYOUTS[layout])
    whole = source.read_bytes()
    source.write_bytes(whole[: min(int(len(whole) * share), len(whole) - 1)])
    assert f"'{source}' " in refusal_of(picture.read, source)
    assert capfd.readouterr() == ("", "")  # the libraries say nothing of their own


def test_an_exr_with_a_hole(tmp_path):
    source = samples.write_exr(tmp_path / "in.exr", samples.planes(samples.light((200, 160))))
    whole = bytearray(source.read_bytes())
    middle = len(whole) // 2
    whole[middle : middle + len(whole) // 4] = bytes(len(whole) // 4)
    source.write_bytes(whole)
    assert f"'{source}' is damaged or cut short: " in refusal_of(picture.read, source)


@pytest.mark.parametrize(("suffix", "type"), [("png", "uint8"), ("tif", "float"), ("hdr", "float")])
def test_other_cut_files(tmp_path, suffix, type):
    pixels = np.random.default_rng(2).random((64, 64, 3), dtype=np.float32)
    source = samples.write_oiio(tmp_path / f"in.{suffix}", pixels, type)
    source.write_bytes(source.read_bytes()[: source.stat().st_size // 2])
    assert f"'{source}' " in refusal_of(picture.read, source)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_values_that_are_no_numbers(tmp_path, bad):
    pixels = samples.light(channels=4)
    pixels[0, :3, 1] = bad
    pixels[5, 5, 3] = bad
    source = samples.write_exr(tmp_path / "in.exr", samples.planes(pixels))
    text = f"'{source}' has 4 values that are NaN or infinite; --nan zero mends them."
    assert refusal_of(picture.read, source) == text
    mended = picture.read(source, nan="zero")
    expected = np.where(np.isfinite(pixels), pixels, 0)
    np.testing.assert_array_equal(mended.pixels, expected)
    assert picture.notes(mended) == ("'in.exr': 4 values that were NaN or infinite are set to zero.",)


def test_more_memory_than_allowed(source, monkeypatch):
    needed = picture.describe(source).memory
    assert needed == 37 * 53 * (3 + 3) * 4
    picture.read(source, memory=needed)
    assert refusal_of(picture.read, source, memory=needed - 1) == (
        f"'{source}' (53 x 37 pixels, 3 channels) needs 4.71e-05 GB of memory, "
        "4.71e-05 GB are allowed; see --memory."
    )


def test_by_default_three_quarters_of_free_memory(source, monkeypatch):
    import psutil

    class Free:
        available = 47064 * 4 // 3 - 4

    monkeypatch.setattr(psutil, "virtual_memory", Free)
    assert "needs" in refusal_of(picture.read, source)
    Free.available += 8
    picture.read(source)


def test_memory_is_refused_before_any_pixel_is_read(source):
    source.write_bytes(source.read_bytes()[:-100])
    assert "see --memory" in refusal_of(picture.read, source, memory=100)


def test_a_deep_picture(tmp_path):
    spec = OpenImageIO.ImageSpec(4, 4, 4, "float")
    spec.deep = True
    data = OpenImageIO.DeepData()
    data.init(spec)
    output = OpenImageIO.ImageOutput.create(str(tmp_path / "in.exr"))
    assert output.open(str(tmp_path / "in.exr"), spec)
    assert output.write_deep_image(data)
    assert output.close()
    text = refusal_of(picture.read, tmp_path / "in.exr")
    assert text == f"'{tmp_path / 'in.exr'}' is a deep picture; flatten it first."


def test_no_colour(tmp_path):
    plane = np.ones((4, 4), np.float32)
    source = samples.write_exr(tmp_path / "in.exr", {"Z": plane, "id": plane})
    assert refusal_of(picture.read, source) == f"'{source}' has no R, G, B or Y channel, only Z, id."


def test_another_format_under_a_known_suffix(tmp_path):
    samples.write_oiio(tmp_path / "in.gif", np.ones((4, 4, 3), np.float32), "uint8")
    (tmp_path / "in.gif").rename(tmp_path / "in.png")
    assert "is in fact a gif file" in refusal_of(picture.read, tmp_path / "in.png")


@pytest.mark.parametrize("option", [{"nan": "keep"}, {"transfer": "gamma"}])
def test_an_unknown_word(source, option):
    assert "must be one of" in refusal_of(picture.read, source, **option)


MADE = Picture(np.ones((3, 4, 3), np.float32))


def test_a_missing_output_folder(tmp_path):
    path = tmp_path / "no" / "out.exr"
    text = f"'{path}' cannot be written: there is no folder '{tmp_path / 'no'}'."
    assert refusal_of(picture.write, path, MADE) == refusal_of(picture.writable, path) == text


def test_a_folder_as_output(tmp_path):
    assert (
        refusal_of(picture.write, tmp_path, MADE)
        == f"'{tmp_path}' is a folder; name the file to write in it."
    )


def test_a_read_only_output_folder(tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: path != tmp_path)
    text = f"'{tmp_path / 'out.exr'}' cannot be written: the folder '{tmp_path}' is read-only."
    assert refusal_of(picture.write, tmp_path / "out.exr", MADE) == text


def test_a_read_only_output_file(source, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: path != source)
    assert refusal_of(picture.write, source, MADE) == f"'{source}' cannot be replaced: it is read-only."


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("out.bmp", {}, "'suffix of out.bmp' must be one of"),
        (
            "out.png",
            {"pixel_type": "half"},
            "'pixel type' must be one of 'auto', 'uint8', 'uint16', got 'half'",
        ),
        ("out.exr", {"compression": "zipp"}, "Did you mean 'zip"),
        ("out.exr", {"transfer": "log"}, "'transfer' must be one of"),
    ],
)
def test_what_a_format_cannot_hold(tmp_path, name, options, said):
    assert said in refusal_of(picture.write, tmp_path / name, MADE, **options)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("shape", [(3, 4), (3, 4, 2), (0, 4, 3), (3, 4, 5)])
def test_what_is_no_picture_is_not_written(tmp_path, shape):
    assert "'pixels' must" in refusal_of(
        picture.write, tmp_path / "out.exr", Picture(np.ones(shape, np.float32))
    )


def test_nan_is_not_written(tmp_path):
    bad = np.full((2, 2, 3), np.nan, np.float32)
    text = refusal_of(picture.write, tmp_path / "out.exr", Picture(bad))
    assert text == "'pixels' must hold finite numbers, got 12 that are NaN or infinite."


def test_a_full_disk(tmp_path):
    name = "x" * 240 + ".exr"  # fits, the temporary's name does not
    assert "could not be written: " in refusal_of(picture.write, tmp_path / name, MADE)
    assert not list(tmp_path.iterdir())
