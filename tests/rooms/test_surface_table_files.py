"""Tables in files: what is written is read back, and whatever is wrong is said in one line."""

import json

import numpy as np
import pytest

from aureole import light, picture, surface
from aureole.records import Picture
from aureole.refuse import Refusal

SUFFIXES = ["exr", "pfm", "npz"]


def sample_table():
    values = np.random.default_rng(7).random((5, 8, 3)) * [[[1.0, 300.0, 1e-6]]]
    notes = {"wavelength": np.float64(6.5e-7), "name": "näme", "counts": [1, 2]}
    white = light.white(light.illuminant("D65"))
    return surface.scatter_table(values, white, 1.5, 3, "D65", "phase", "remove", notes)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_written_is_read_back(tmp_path, suffix):
    table, path = sample_table(), tmp_path / f"table.{suffix}"
    place, beside = surface.write_table(path, table)
    assert (place, beside) == (path, tmp_path / f"table.{suffix}.json")
    assert sorted(found.name for found in tmp_path.iterdir()) == [path.name, beside.name]
    found = surface.read_table(path)
    assert np.array_equal(found.values, table.values)
    for name in ("half_range", "warp", "illuminant", "white", "model", "zero_order"):
        assert getattr(found, name) == getattr(table, name)
    assert found.metadata == {"wavelength": 6.5e-7, "name": "näme", "counts": [1, 2]}


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("space", ["rec709", "acescg"])
def test_rgb_files_come_back_as_xyz(tmp_path, suffix, space):
    table, path = sample_table(), tmp_path / f"table.{suffix}"
    surface.write_table(path, table, space)
    assert json.loads((tmp_path / f"table.{suffix}.json").read_text())["colour_space"] == space
    assert np.abs(surface.read_table(path).values - table.values).max() <= 1e-6 * table.values.max()


@pytest.mark.parametrize("wavelength", [450e-9, 532e-9, 650e-9])
def test_a_laser_keeps_its_colour_in_rgb(tmp_path, wavelength):
    laser = light.line(wavelength)
    table = surface.table_from_function(lambda t, b, w: np.exp(-(t**2) - b**2), laser, 5, sample="point")
    wanted = light.from_xyz(light.white(laser), "rec709", light.SPACES["rec709"].white)
    assert surface.rgb(table)[2, 2] == pytest.approx(wanted, rel=1e-5)
    surface.write_table(tmp_path / "t.exr", table, "rec709")
    found = surface.read_table(tmp_path / "t.exr").values
    assert np.abs(found - table.values).max() <= 1e-5 * table.values.max()


def test_the_sidecar_reports_albedo_and_energy(tmp_path):
    values = np.full((40, 40, 3), 1e-3)
    table = surface.scatter_table(values, [1.0, 1.0, 1.0])
    surface.write_table(tmp_path / "t.npz", table)
    said = json.loads((tmp_path / "t.npz.json").read_text())["report"]
    assert said["albedo"]["0_deg"] == pytest.approx(surface.albedo(table)[1])
    # 4π² · 10⁻³ over h from −2 to 2.
    assert said["energy"] == pytest.approx([0.064 * np.pi**2] * 3, rel=1e-6)
    assert surface.read_table(tmp_path / "t.npz").metadata == {}


def test_an_exr_says_its_primaries(tmp_path):
    surface.write_table(tmp_path / "t.exr", sample_table())
    assert picture.describe(tmp_path / "t.exr").colour_space == "xyz"
    assert {channel.pixel_type for channel in picture.describe(tmp_path / "t.exr").channels} == {"float"}


def test_the_sidecar_says_how_the_table_lies(tmp_path):
    said = json.loads(surface.write_table(tmp_path / "t.npz", sample_table())[1].read_text(encoding="utf-8"))
    assert said["rows"] == 5
    assert said["columns"] == 8
    assert said["unit"] == "1/sr"
    assert said["tangent_convention"].endswith("+b at the top")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"wrap": 5}, "has no 'wrap'. Did you mean 'warp'"),
        ({"warp": 4}, "'warp' must be odd"),
        ({"warp": "five"}, "'warp' in"),
        ({"rows": 6}, "does not fit its sidecar"),
        ({"format": "other"}, "'format' in"),
        ({"white": [1.0, 1.0]}, "'white' in"),
        ({"half_range": float("nan")}, "'half_range' in"),
        ({"colour_space": "srgb"}, "colour_space in"),
        ({"model": "phases"}, "'model' must be one of"),
        ({"tangent_convention": "rows down"}, "'tangent_convention' in"),
    ],
)
def test_wrong_sidecars_are_refused(tmp_path, change, message):
    path, beside = surface.write_table(tmp_path / "t.npz", sample_table())
    beside.write_text(json.dumps(json.loads(beside.read_text(encoding="utf-8")) | change))
    with pytest.raises(Refusal, match=message) as refusal:
        surface.read_table(path)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("text", ["", "{", "[1]", "\x00", "[" * 20000])
def test_damaged_sidecars_are_refused(tmp_path, text):
    path, beside = surface.write_table(tmp_path / "t.npz", sample_table())
    beside.write_text(text)
    with pytest.raises(Refusal, match=r"t\.npz\.json"):
        surface.read_table(path)


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("share", [0.0, 0.1, 0.9])
def test_files_cut_short_are_refused(tmp_path, suffix, share):
    path, _ = surface.write_table(tmp_path / f"t.{suffix}", sample_table())
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    with pytest.raises(Refusal):
        surface.read_table(path)


@pytest.mark.parametrize("suffix", ["pfm", "npz"])
def test_infinite_numbers_are_refused(tmp_path, suffix):
    path, _ = surface.write_table(tmp_path / f"t.{suffix}", sample_table())
    values = np.full((5, 8, 3), np.inf, np.float32)
    np.savez(path, values=values) if suffix == "npz" else surface.write_pfm(path, values)
    with pytest.raises(Refusal, match="finite"):
        surface.read_table(path)


def test_nothing_is_written_where_something_is_wrong(tmp_path):
    table = sample_table()
    with pytest.raises(Refusal, match="suffix"):
        surface.write_table(tmp_path / "t.png", table)
    with pytest.raises(Refusal, match="'colour_space' must be one of"):
        surface.write_table(tmp_path / "t.exr", table, "cmyk")
    with pytest.raises(Refusal, match="no folder"):
        surface.write_table(tmp_path / "there" / "t.exr", table)
    for wrong in (object(), float("nan")):
        odd = surface.scatter_table(table.values, table.white, metadata={"x": wrong})
        with pytest.raises(Refusal, match="'metadata' must be"):
            surface.write_table(tmp_path / "t.exr", odd)
    assert not list(tmp_path.iterdir())


def test_missing_files_are_refused(tmp_path):
    with pytest.raises(Refusal, match="There is no file"):
        surface.read_table(tmp_path / "t.exr")
    picture.write(tmp_path / "t.exr", Picture(np.ones((4, 4, 3), np.float32), "xyz"))
    with pytest.raises(Refusal, match="which says what the table beside it holds"):
        surface.read_table(tmp_path / "t.exr")


@pytest.mark.parametrize("shape", [(3, 4), (3, 4, 3)])
def test_float_maps_of_either_byte_order(tmp_path, shape):
    pixels = np.random.default_rng(1).normal(size=shape).astype(np.float32)
    surface.write_pfm(tmp_path / "a.pfm", pixels)
    assert np.array_equal(surface.read_pfm(tmp_path / "a.pfm"), pixels)
    kind = b"PF" if len(shape) == 3 else b"Pf"
    turned = pixels[::-1].astype(">f4").tobytes()
    (tmp_path / "b.pfm").write_bytes(kind + b"\n4 3\n1.0\n" + turned)
    assert np.array_equal(surface.read_pfm(tmp_path / "b.pfm"), pixels)


def test_the_bottom_row_comes_first_in_a_float_map(tmp_path):
    surface.write_pfm(tmp_path / "a.pfm", np.array([[1.0], [2.0]], np.float32))
    assert (tmp_path / "a.pfm").read_bytes() == b"Pf\n1 2\n-1.0\n" + np.array([2.0, 1.0], "<f4").tobytes()


@pytest.mark.parametrize(
    "data",
    [b"", b"P6\n2 2\n255\n", b"Pf\n0 2\n-1\n", b"Pf\n2 2\n0.0\n" + bytes(16), b"Pf\n2 2\n-1\n" + bytes(15)],
)
def test_damaged_float_maps_are_refused(tmp_path, data):
    (tmp_path / "a.pfm").write_bytes(data)
    with pytest.raises(Refusal, match="is damaged"):
        surface.read_pfm(tmp_path / "a.pfm")
