"""Photographs from files, a camera's response, and what cannot be read."""

import numpy as np
import OpenImageIO
import pytest

from aureole import picture, refuse, surface
from aureole.records import Picture

LIGHT = np.geomspace(2e-3, 8.0, 120 * 160).reshape(120, 160)
TIMES = [1 / 64, 1 / 16, 1 / 4, 1.0, 4.0]


def shown(exposure):
    """A camera's values for light: a toe, a power and a shoulder, never falling."""
    return np.clip(1.06 * (1 - np.exp(-0.9 * np.asarray(exposure))) ** 0.6, 0.0, 1.0)


def with_exif(path, pixels, **said):
    spec = OpenImageIO.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], "uint8")
    for name, value in said.items():
        spec.attribute(name.replace("__", ":"), value)
    file = OpenImageIO.ImageOutput.create(str(path))
    file.open(str(path), spec)
    file.write_image(pixels)
    file.close()


@pytest.mark.parametrize("levels", [255.0, 1.0])
def test_a_bracket_tells_the_cameras_response(levels):
    photos = [np.round(255 * shown(LIGHT * time)) * levels / 255 for time in TIMES]
    response = surface.camera_response(photos, TIMES)
    light = np.geomspace(0.02, 1.2, 50)
    ratio = response.exposure(levels * shown(light)) / light
    # The scale is free: what counts is that it is one.
    assert np.abs(np.log(ratio / np.median(ratio))).max() < 0.02


def test_merging_with_the_response_gives_the_light():
    photos = [np.round(255 * shown(LIGHT * time)) for time in TIMES]
    merged = surface.merge(photos, TIMES, read_noise=0.5, response=surface.camera_response(photos, TIMES))
    ratio = merged.values / LIGHT
    seen = LIGHT > 0.02
    assert np.abs(np.log(ratio / np.median(ratio)))[seen].max() < 0.08
    linear = surface.merge(photos, TIMES, saturation=255.0)
    wrong = linear.values / LIGHT
    assert np.abs(np.log(wrong / np.median(wrong)))[seen].max() > 0.5


def test_what_tells_no_response_is_refused():
    flat = np.full((20, 20), 0.5)
    with pytest.raises(refuse.Refusal, match="two photographs"):
        surface.camera_response([flat], [1.0])
    with pytest.raises(refuse.Refusal, match="differ"):
        surface.camera_response([flat, flat], [1.0, 1.0])
    with pytest.raises(refuse.Refusal, match="overlap"):
        surface.camera_response([np.zeros((20, 20)), np.ones((20, 20))], [1.0, 2.0])
    photo = np.linspace(0.1, 0.9, 400).reshape(20, 20)
    with pytest.raises(refuse.Refusal, match="brighten"):
        surface.camera_response([photo, 0.99 * photo], [1.0, 2.0])
    photos = [shown(LIGHT * time) for time in TIMES]
    with pytest.raises(refuse.Refusal, match="black"):
        surface.merge(photos, TIMES, "estimate", response=surface.camera_response(photos, TIMES))


def test_a_bracket_of_files_says_its_exposures(tmp_path):
    paths = [tmp_path / f"{k}.jpg" for k in range(2)]
    pixels = np.full((16, 16, 3), 100, np.uint8)
    for path, time in zip(paths, (1 / 250, 1 / 60), strict=True):
        with_exif(path, pixels, ExposureTime=time, FNumber=5.6, Exif__PhotographicSensitivity=200)
    bracket = surface.read_photographs(paths)
    assert bracket.exposures == pytest.approx([2 / 250 / 5.6**2, 2 / 60 / 5.6**2], rel=1e-3)
    assert bracket.planes[0].shape == (16, 16)
    # 100 of 255 in sRGB is 0.127 linear; as the file has it, 0.392.
    assert bracket.planes[0][8, 8] == pytest.approx(0.1274, abs=0.002)
    stored = surface.read_photographs(paths, transfer="linear").planes[0][8, 8]
    assert stored == pytest.approx(100 / 255, abs=0.005)


def test_where_one_file_says_no_time_there_are_no_exposures(tmp_path):
    pixels = np.full((16, 16, 3), 100, np.uint8)
    with_exif(tmp_path / "a.jpg", pixels, ExposureTime=1 / 250)
    with_exif(tmp_path / "b.jpg", pixels)
    assert surface.read_photographs([tmp_path / "a.jpg", tmp_path / "b.jpg"]).exposures is None


def test_channels_are_picked_from_a_colour_file(tmp_path):
    pixels = np.zeros((4, 5, 3), np.float32) + np.array([1.0, 2.0, 6.0], np.float32)
    picture.write(tmp_path / "a.exr", Picture(pixels))
    surface.write_pfm(tmp_path / "a.pfm", pixels)
    for suffix in ("exr", "pfm"):
        for channel, value in (("red", 1.0), ("green", 2.0), ("blue", 6.0), ("mean", 3.0)):
            (plane,) = surface.read_photographs([tmp_path / f"a.{suffix}"], channel).planes
            assert plane.shape == (4, 5)
            np.testing.assert_allclose(plane, value)
        (plane,) = surface.read_photographs([tmp_path / f"a.{suffix}"], "all").planes
        np.testing.assert_allclose(plane, pixels)


def test_a_single_band_map_as_the_papers_authors_share_is_measured(tmp_path):
    rows, columns = np.mgrid[0:81.0, 0:81.0]
    photo = sum(
        top * np.exp(-0.5 * ((rows - 40) ** 2 + (columns - place) ** 2) / 4.0)
        for top, place in ((1.0, 40), (0.2, 20), (0.2, 60))
    )
    surface.write_pfm(tmp_path / "sample.pfm", photo.astype(np.float32))
    (plane,) = surface.read_photographs([tmp_path / "sample.pfm"]).planes
    table = surface.table_from_photo(plane, 1.0, surface.UniformGeometry(5e-3), 532e-9, table_size=129)
    order = surface.lookup(table, [-0.1, 0.1], 0.0)[:, 1]
    assert order[0] == pytest.approx(order[1], rel=1e-3)
    assert table.metadata["patterns"][0]["period"][0] == pytest.approx(532e-9 / 0.1, rel=0.02)


@pytest.mark.parametrize("suffix", ["exr", "hdr", "pfm"])
def test_one_hdr_file_is_enough(tmp_path, suffix):
    rows, columns = np.mgrid[0:61.0, 0:61.0]
    photo = np.exp(-0.5 * ((rows - 30.4) ** 2 + (columns - 29.7) ** 2) / 9.0).astype(np.float32) + 1e-3
    path = tmp_path / f"sample.{suffix}"
    if suffix == "pfm":
        surface.write_pfm(path, photo)
    else:
        picture.write(path, Picture(np.repeat(photo[..., None], 3, axis=2)))
    found = surface.read_photographs([path])
    pattern = surface.measure_pattern(found.planes[0], 1.0, surface.UniformGeometry(1e-3), 532e-9)
    assert pattern.metadata["centre"] == pytest.approx([30.4, 29.7], abs=0.1)


def test_files_that_are_no_bracket_are_refused(tmp_path):
    surface.write_pfm(tmp_path / "a.pfm", np.ones((4, 5), np.float32))
    surface.write_pfm(tmp_path / "b.pfm", np.ones((4, 6), np.float32))
    for paths, word in (
        ([], "no photograph"),
        ([tmp_path / "a.pfm", tmp_path / "b.pfm"], "one bracket"),
        ([tmp_path / "missing.pfm"], "There is no file"),
        ([tmp_path / "missing.exr"], "missing"),
    ):
        with pytest.raises(refuse.Refusal, match=word):
            surface.read_photographs(paths)
    with pytest.raises(refuse.Refusal, match="channel"):
        surface.read_photographs([tmp_path / "a.pfm"], "violet")
