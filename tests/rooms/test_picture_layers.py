"""Many pictures in one EXR: named channels, sums that add up, whole files, little memory."""

import tracemalloc

import numpy as np
import OpenEXR
import OpenImageIO
import picture_samples as samples
import pytest

from aureole import picture
from aureole.picture.layers import Layers, attributes_of, write_layers
from aureole.records import Picture
from aureole.refuse import Refusal

SHAPE = (37, 53)


def three_layers(shape=SHAPE, **how):
    """Two crops and their sum over the whole picture."""
    chances = np.random.default_rng(3)
    layers, total = Layers(shape, **how), np.zeros((*shape, 3))
    for name, window in {
        "ghost_2_5": picture.Window(4, 3, 30, 21),
        "ghost_3_4": picture.Window(0, 20, 53, 17),
    }.items():
        pixels = chances.random((window.height, window.width, 3), dtype=np.float32) * np.float32(1e-3)
        layers.add(name, pixels, window)
        total[window.y : window.y + window.height, window.x : window.x + window.width] += pixels
    layers.add("ghosts", total.astype(np.float32))
    return layers, total


def channels(path):
    """Every channel by its name, read by OpenImageIO."""
    source = OpenImageIO.ImageInput.open(str(path))
    planes = source.read_image(OpenImageIO.FLOAT)
    names = source.spec().channelnames
    source.close()
    return {name: planes[..., k] for k, name in enumerate(names)}


def test_layers_come_back_by_their_names(tmp_path):
    layers, total = three_layers()
    whole = Picture(samples.light())
    assert write_layers(tmp_path / "a.exr", whole, layers) == ()
    found = channels(tmp_path / "a.exr")
    assert list(found)[:3] == ["R", "G", "B"]
    assert set(found) == {*"RGB"} | {f"{layer}.{c}" for layer in layers.names for c in "RGB"}
    for k, channel in enumerate("RGB"):
        np.testing.assert_array_equal(found[channel], whole.pixels[..., k])
        each = sum(found[f"{name}.{channel}"].astype(np.float64) for name in ("ghost_2_5", "ghost_3_4"))
        np.testing.assert_allclose(found[f"ghosts.{channel}"], each, rtol=1e-6, atol=0)
        np.testing.assert_allclose(found[f"ghosts.{channel}"], total[..., k], rtol=1e-6, atol=0)
    assert not found["ghost_2_5.G"][:3].any()
    assert not found["ghost_2_5.G"][:, :4].any()
    assert not found["ghost_3_4.G"][:20].any()


def test_the_file_is_one_part_of_float_in_zip(tmp_path):
    layers, _ = three_layers()
    said = attributes_of({"lens": "heliar", "ghost_to_image": 0.25, "ghosts": 2})
    whole = picture.with_attributes(Picture(samples.light(), "acescg"), said)
    write_layers(tmp_path / "a.exr", whole, layers)
    file = OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True)
    assert len(file.parts) == 1
    header = file.header()
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION
    assert header["aureole:lens"] == "heliar"
    assert header["aureole:ghost_to_image"] == 0.25
    assert header["aureole:ghosts"] == 2
    assert all(channel.pixels.dtype == np.float32 for channel in file.channels().values())
    assert all(channel.pixels.shape == SHAPE for channel in file.channels().values())
    # Our own reader takes the plain channels as the picture, in its space, and carries the layers.
    back = picture.read(tmp_path / "a.exr")
    assert back.colour_space == "acescg"
    assert set(picture.extra_channels(back)) == {f"{n}.{c}" for n in layers.names for c in "RGB"}


def test_windows_alpha_and_channels_of_a_source_are_kept(tmp_path):
    """A tiled file with overscan, alpha and integers: all but the tiles and the integers come back."""
    header = {"dataWindow": ((-8, -5), (44, 31)), "displayWindow": ((0, 0), (39, 25))}
    planes = samples.planes(samples.light(channels=4), dtype=np.float32)
    planes |= {"Z": np.full(SHAPE, 7, np.float32), "id": np.full(SHAPE, 5, np.uint32)}
    source = picture.read(samples.write_exr(tmp_path / "in.exr", planes, header))
    layers, _ = three_layers()
    notes = write_layers(tmp_path / "out.exr", source, layers)
    assert len(notes) == 1
    assert "the integers of id are left out" in notes[0]
    back = picture.describe(tmp_path / "out.exr")
    assert back.data_window == picture.Window(-8, -5, 53, 37)
    assert back.display_window == picture.Window(0, 0, 40, 26)
    found = channels(tmp_path / "out.exr")
    np.testing.assert_array_equal(found["A"], source.pixels[..., 3])
    np.testing.assert_array_equal(found["Z"], 7)


def test_layers_wait_on_the_disk_where_they_are_many(tmp_path, monkeypatch):
    """A band at a time is held: far less than all layers."""
    monkeypatch.setattr(picture.layers, "BAND_BYTES", 2**20)
    shape, count = (256, 400), 40
    layers = Layers(shape, in_memory=2**16)
    lit = np.ones((200, 300, 3), np.float32)
    for k in range(count):
        layers.add(f"ghost_{k}", lit * k, picture.Window(k, 5, 300, 200))
    tracemalloc.start()
    write_layers(tmp_path / "a.exr", Picture(np.zeros((*shape, 3), np.float32)), layers)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # 16 rows of 40 layers are 3 MB; all layers would be 49 MB.
    assert peak < 9e6
    found = channels(tmp_path / "a.exr")
    for k in (0, 7, 39):
        assert found[f"ghost_{k}.B"].sum() == k * 200 * 300
        np.testing.assert_array_equal(layers.picture_of(f"ghost_{k}")[..., 1], found[f"ghost_{k}.G"])


def test_bands_join_without_a_seam(tmp_path, monkeypatch):
    monkeypatch.setattr(picture.layers, "BAND_BYTES", 1)
    layers, total = three_layers()
    write_layers(tmp_path / "a.exr", Picture(samples.light()), layers)
    np.testing.assert_array_equal(channels(tmp_path / "a.exr")["ghosts.R"], total[..., 0].astype(np.float32))


def test_a_dark_layer_has_an_empty_window(tmp_path):
    layers = Layers(SHAPE)
    layers.add("ghost_1_2", np.zeros((0, 0, 3), np.float32), picture.Window(0, 0, 0, 0))
    write_layers(tmp_path / "a.exr", Picture(samples.light()), layers)
    assert not channels(tmp_path / "a.exr")["ghost_1_2.R"].any()
    assert not layers.picture_of("ghost_1_2").any()


@pytest.mark.parametrize("name", ["2-5", "2_5", "ghost.2", "ghost-2", "", "ghöst", "ghosts"])
def test_names_that_programs_would_change_are_refused(name):
    """Nuke drops leading digits and turns other signs into _, so that 2-5 and 3-5 would be one layer."""
    layers, _ = three_layers()
    with pytest.raises(Refusal, match="a name of its own of letters, digits and _"):
        layers.add(name, np.zeros((*SHAPE, 3), np.float32))


def test_refusals(tmp_path):
    layers, _ = three_layers()
    whole = Picture(samples.light())
    with pytest.raises(Refusal, match="within 53 x 37 pixels, got columns 50 to 60 and rows 0 to 4"):
        layers.add("beyond", np.zeros((4, 10, 3), np.float32), picture.Window(50, 0, 10, 4))
    with pytest.raises(Refusal, match="finite"):
        layers.add("nan", np.full((*SHAPE, 3), np.nan, np.float32))
    with pytest.raises(Refusal, match="shape"):
        layers.add("small", np.zeros((3, 3, 3), np.float32))
    with pytest.raises(Refusal, match=r"only EXR holds layers; 'a.png' must end in \.exr"):
        write_layers(tmp_path / "a.png", whole, layers)
    with pytest.raises(Refusal, match="shape"):
        write_layers(tmp_path / "a.exr", Picture(whole.pixels[1:]), layers)
    taken = Picture(whole.pixels, "rec709", {"extra_channels": {"ghosts.R": np.zeros(SHAPE, np.float32)}})
    with pytest.raises(Refusal, match=r"a channel 'ghosts.R' of its own already"):
        write_layers(tmp_path / "a.exr", taken, layers)
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_leaves_the_old_file(tmp_path, monkeypatch):
    place = tmp_path / "a.exr"
    place.write_bytes(b"what was there")
    layers, _ = three_layers()

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(layers, "rows", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_layers(place, Picture(samples.light()), layers)
    assert place.read_bytes() == b"what was there"
    assert list(tmp_path.iterdir()) == [place]
