"""`aureole surface`: what its commands write, what they say, what they refuse."""

import json
import math

import numpy as np
import pytest

from aureole import Picture, picture, surface
from aureole.cli.main import run

FRAME = ["--size", "96x54", "--samples", "1", "--table-size", "96"]


def told(words, capsys):
    assert run([str(word) for word in words]) == 0
    return json.loads(capsys.readouterr().out)


def refused(words, capsys):
    assert run([str(word) for word in words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.strip().splitlines()
    assert len(lines) == 1
    return lines[0]


@pytest.fixture
def cd(tmp_path):
    """A table of a compact disc, small."""
    assert run(["surface", "table", "--grating", "cd", "--size", "96", "-o", str(tmp_path / "cd.npz")]) == 0
    return tmp_path / "cd.npz"


def test_gratings_are_listed(capsys):
    found = told(["surface", "list", "--json"], capsys)["gratings"]
    assert {"cd", "dvd", "bluray", "lcd-342ppi", "lcd-534ppi", "blazed-600"} <= set(found)
    assert found["cd"]["period_um"] == 1.6
    assert run(["surface", "list"]) == 0
    assert "Compact disc" in capsys.readouterr().out


@pytest.mark.parametrize(("nanometres", "degrees"), [(380, 13.74), (532, 19.42), (650, 23.97), (780, 29.18)])
def test_orders_of_a_compact_disc_stand_where_the_grating_equation_says(nanometres, degrees, capsys):
    """d (sin in + sin out) = m lambda with d = 1.6 um at normal incidence."""
    words = ["surface", "table", "--grating", "cd", "--orders", "--wavelength", f"{nanometres}nm", "--json"]
    found = {row["order"]: row for row in told(words, capsys)["orders"]}
    assert found[1]["angle_deg"] == pytest.approx(degrees, abs=0.05)
    assert found[-1]["angle_deg"] == pytest.approx(-degrees, abs=0.05)
    assert found[1]["h"] == pytest.approx(nanometres / 1600)


def test_orders_at_an_incidence_are_printed_for_people(capsys):
    words = ["surface", "table", "--grating", "bluray", "--orders", "--incidence", "0deg"]
    assert run(words) == 0
    assert len(capsys.readouterr().out.splitlines()) == 3, "only order 0 leaves a Blu-ray at normal incidence"
    assert run(["surface", "table", "--slits", "0.5um,1.6um,21", "--orders", "--incidence", "30"]) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[2:]]
    for row in rows:
        expected = math.asin(int(row[0]) * 0.532 / 1.6 - 0.5)
        assert float(row[1]) == pytest.approx(math.degrees(expected), abs=0.005)


@pytest.mark.parametrize("suffix", [".exr", ".pfm", ".npz"])
def test_a_table_is_written_with_what_it_means(tmp_path, capsys, suffix):
    out, look = tmp_path / f"slits{suffix}", tmp_path / "look.png"
    words = [
        "surface",
        "table",
        "--slits",
        "0.5um,2um,21",
        "--illuminant",
        "A",
        "--size",
        "128x64",
        "-o",
        out,
    ]
    found = told([*words, "--preview", look, "--json"], capsys)
    assert found["files"] == [str(out), f"{out}.json", str(look)]
    table = surface.read_table(out)
    assert table.values.shape == (64, 128, 3)
    assert table.illuminant == "A"
    assert found["albedo_0deg"] == pytest.approx(surface.albedo(table)[1], rel=1e-5)
    # Slits reflect their share of the light; what goes below the horizon is missing.
    assert 0.1 < found["albedo_60deg"] < found["albedo_0deg"] < 0.25
    assert picture.read(look).pixels[..., :3].std() > 0.02


def test_kinds_of_surfaces_differ(tmp_path, capsys):
    out, heights = tmp_path / "t.npz", tmp_path / "heights.npy"
    x = np.arange(48)
    np.save(heights, np.tile(30.0 * np.sin(2 * np.pi * x / 24), (48, 1)))
    kinds = {
        "slits": ["--slits", "0.5um,1.6um,21"],
        "crossed": ["--slits", "0.5um,1.6um,21", "--across", "0.5um,1.6um,21"],
        "radial": ["--slits", "0.5um,1.6um,21", "--radial"],
        "blazed": ["--blazed", "600,500nm"],
        "exact": ["--height", heights, "--pixel", "100nm", "--height-unit", "1nm"],
        "born": ["--height", heights, "--pixel", "100nm", "--height-unit", "1nm", "--method", "born"],
        "removed": ["--slits", "0.5um,1.6um,21", "--zero-order", "remove"],
        "narrow": ["--slits", "0.5um,1.6um,21", "--range", "0.5"],
    }
    made = {}
    for name, words in kinds.items():
        told(["surface", "table", *words, "--size", "32", "-o", out, "--json"], capsys)
        made[name] = surface.read_table(out).values
    for name, values in made.items():
        others = [other for key, other in made.items() if key != name]
        assert all(not np.allclose(values, other, rtol=1e-3) for other in others), name
    # Crossed equal slits are the same along both axes; rings the same at every angle.
    for name in ("crossed", "radial"):
        np.testing.assert_allclose(made[name], made[name].transpose(1, 0, 2), rtol=1e-4, atol=1e-9)


def test_heights_too_deep_for_a_series_are_told(tmp_path, capsys):
    """sin x of 300 nm is a phase of 4 pi 0.3 / 0.38 = 10 radians at the shortest wavelength."""
    heights, out = tmp_path / "deep.npy", tmp_path / "deep.npz"
    np.save(heights, np.tile(300.0 * np.sin(2 * np.pi * np.arange(48) / 24), (48, 1)))
    words = ["surface", "table", "--height", heights, "--pixel", "100nm", "--height-unit", "1nm"]
    words += ["--size", "32", "-o", out, "--method", "taylor", "--order", "2"]
    assert run([str(word) for word in words]) == 0
    assert "note: Order 2 puts" in capsys.readouterr().err


def test_a_compact_disc_is_violet_inside(tmp_path, capsys):
    """With the lamp at the eye the first order is a ring: h = 2 sin a grows outward, and so lambda = d h."""
    out = tmp_path / "cd.exr"
    words = ["surface", "render", "cd", "--size", "161x161", "--samples", "1", "--table-size", "512"]
    words += ["--lamp", "0cm,0cm,20cm", "--camera", "0cm,0cm,20cm", "--diffuse", "0", "--specular", "0"]
    found = told([*words, "-o", out, "--json"], capsys)
    assert found["shape"] == "disc"
    pixels = picture.read(out).pixels
    assert pixels.shape == (161, 161, 4)
    assert pixels[..., 3].mean() == pytest.approx(found["coverage"], rel=1e-5)
    # From the inner rim outward; order 1 ends where d h is above 780 nm.
    line = picture.into_gamut(pixels[80, 81:, :3])
    x = (2 * np.arange(81, 161) + 1) / 161 - 1
    radius = x * 0.2 * math.tan(math.radians(18))
    wavelength = 1.6e-6 * 2 * np.sin(np.arctan(radius / 0.2))
    first = (wavelength > 400e-9) & (wavelength < 700e-9) & (pixels[80, 81:, 3] > 0)
    peaks = [wavelength[first][line[first, channel].argmax()] for channel in (2, 1, 0)]
    assert peaks == sorted(peaks)
    assert peaks[0] < 490e-9 < peaks[1] < 570e-9 < peaks[2]


def test_pictures_for_screens_and_alike_from_a_file_and_a_preset(tmp_path, cd, capsys):
    out, same, look = tmp_path / "a.exr", tmp_path / "b.exr", tmp_path / "a.png"
    words = [
        "surface",
        "render",
        "--specular",
        "0.1",
        "--diffuse",
        "0.1,0.2,0.3",
        "--size",
        "96x54",
        "--json",
    ]
    told([*words, "cd", "--table-size", "96", "-o", out, "--preview", look], capsys)
    found = told([*words, cd, "-o", same], capsys)
    assert found["shape"] == "disc", "the sidecar says what the table is of"
    ours, theirs = picture.read(out).pixels, picture.read(same).pixels
    np.testing.assert_allclose(ours, theirs, rtol=1e-5)
    shown = picture.read(look).pixels
    assert shown.shape == (54, 96, 3)
    darker = told([*words, "cd", "--table-size", "96", "-o", look, "--exposure", "-9"], capsys)
    assert darker["exposure_stops"] == -9
    assert picture.read(look).pixels.mean() < shown.mean()


def test_objects_lights_cameras_and_materials_change_the_picture(tmp_path, cd, capsys):
    out, mask, mesh = tmp_path / "x.exr", tmp_path / "mask.png", tmp_path / "quad.obj"
    half = np.zeros((8, 8, 3), dtype=np.float32)
    half[:, :4] = 1
    picture.write(mask, Picture(half))
    mesh.write_text(
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"
    )
    kinds = {
        "disc": [],
        "straight": ["--straight"],
        "plane": ["--shape", "plane"],
        "cylinder": ["--shape", "cylinder", "--sweep", "120deg"],
        "mesh": ["--shape", mesh, "--object-size", "4cm"],
        "tilted": ["--tilt=-20deg", "--turn", "10deg"],
        "masked": ["--mask", mask],
        "lamp": ["--lamp", "5cm,5cm,20cm"],
        "far": ["--lamp", "20deg,10deg"],
        "large": ["--lamp", "5cm,5cm,20cm", "--lamp-size", "4cm"],
        "red": ["--lamp-colour", "1,0,0"],
        "two": [
            "--lamp",
            "5cm,5cm,20cm",
            "--lamp=-5cm,5cm,20cm",
            "--lamp-strength",
            "1",
            "--lamp-strength",
            "2",
        ],
        "room": ["--environment", "room", "--environment-samples", "16"],
        "near": ["--camera", "0cm,0cm,15cm"],
        "flat": ["--view-height", "13cm"],
        "soft": ["--depth-of-field", "2cm", "--lens-samples", "5"],
        "gold": ["--fresnel", "gold"],
        "window": ["--window", "0.3,0.02"],
        "stam": ["--geometry", "stam"],
        "rough": ["--specular", "1", "--roughness", "0.3"],
    }
    made = {}
    for name, more in kinds.items():
        told(
            ["surface", "render", cd, "--size", "24x16", "--samples", "1", *more, "-o", out, "--json"], capsys
        )
        made[name] = picture.read(out).pixels
        assert made[name][..., :3].max() > 0, name
    for name, pixels in made.items():
        if name != "disc":
            assert not np.allclose(pixels, made["disc"], rtol=1e-3), name
    assert made["red"][..., 1:3].max() == 0


def test_a_turntable_goes_on_where_it_stopped(tmp_path, cd, capsys):
    out, sheet = tmp_path / "cd.###.exr", tmp_path / "sheet.png"
    words = ["surface", "render", cd, "--size", "48x32", "--samples", "1", "--animate", "1s", "--fps", "4"]
    words += ["--turntable", "tilt:40deg", "-o", out, "--json"]
    found = told([*words, "--contact-sheet", sheet], capsys)
    assert [frame["tilt_deg"] for frame in found["frames"]] == [0, 10, 20, 30]
    files = [tmp_path / f"cd.{number:03d}.exr" for number in (1, 2, 3, 4)]
    assert found["files"] == [str(path) for path in [*files, sheet]]
    still = tmp_path / "still.exr"
    told(
        ["surface", "render", cd, "--size", "48x32", "--samples", "1", "--tilt", "20", "-o", still, "--json"],
        capsys,
    )
    np.testing.assert_array_equal(picture.read(files[2]).pixels, picture.read(still).pixels)
    before = {path: path.stat().st_mtime_ns for path in files}
    files[1].unlink()
    again = told(words, capsys)
    assert [frame["kept"] for frame in again["frames"]] == [True, False, True, True]
    assert files[0].stat().st_mtime_ns == before[files[0]]
    assert "is no frame of this job" in refused([*words, "--diffuse", "0.5"], capsys)


def test_exports_hold_the_table(tmp_path, cd, capsys):
    page = told(["surface", "export", cd, "-o", tmp_path / "cd.html", "--title", "My disc", "--json"], capsys)
    text = (tmp_path / "cd.html").read_text()
    assert page["open"].startswith("file://")
    assert "My disc" in text
    assert "http" not in text.split("<script", 1)[1].replace("http://www.w3.org", "")
    glsl = told(
        ["surface", "export", "cd", "--table-size", "64", "-o", tmp_path / "disc.glsl", "--json"], capsys
    )
    assert glsl["files"][0] == str(tmp_path / "disc.glsl")
    assert surface.read_table(tmp_path / "disc.exr").values.shape == (64, 64, 3)
    words = ["surface", "export", cd, "-o", tmp_path / "cd.xml", "--lamp", "0cm,10cm,30cm", "--json"]
    scene = told(words, capsys)
    assert scene["table"] == "cd.npz"
    assert "aureole_surface" in (tmp_path / "cd.xml").read_text()


TABLE, RENDER, EXPORT = (["surface", word] for word in ("table", "render", "export"))
MEASURE = ["surface", "measure", "photo.exr", "-o", "out.npz"]
BENCH = ["--h-per-pixel", "1e-3"]
BAD = {
    "no surface": ([*TABLE, "-o", "out.npz"], "give one of 'grating', 'slits'"),
    "two surfaces": (
        [*TABLE, "--grating", "cd", "--display", "300", "-o", "out.npz"],
        "got grating and display",
    ),
    "unknown preset": ([*TABLE, "--grating", "cdd", "-o", "out.npz"], "Did you mean 'cd'?"),
    "no output": ([*TABLE, "--grating", "cd"], "'output' is missing"),
    "orders and a table": ([*TABLE, "--grating", "cd", "--orders", "-o", "out.npz"], "leave 'output' out"),
    "table's suffix": ([*TABLE, "--grating", "cd", "-o", "out.png"], "must be one of '.exr', '.pfm', '.npz'"),
    "slits without a unit": ([*TABLE, "--slits", "1,2,3", "-o", "out.npz"], "needs a unit"),
    "slits wider than apart": ([*TABLE, "--slits", "3um,2um,5", "-o", "out.npz"], "no wider than"),
    "even warp": ([*TABLE, "--grating", "cd", "--warp", "4", "-o", "out.npz"], "'warp' must be odd"),
    "range": (
        [*TABLE, "--grating", "cd", "--range", "3", "-o", "out.npz"],
        "'range' must be a number from 0 to 2",
    ),
    "illuminant": ([*TABLE, "--grating", "cd", "--illuminant", "D66", "-o", "out.npz"], "'D65'"),
    "pixel of a grating": (
        [*TABLE, "--grating", "cd", "--pixel", "20nm", "-o", "out.npz"],
        "goes with 'height'",
    ),
    "heights without pixel": ([*TABLE, "--height", "x.exr", "-o", "out.npz"], "'height' needs 'pixel'"),
    "taylor without order": (
        [*TABLE, "--height", "heights.npy", "--pixel", "20nm", "--method", "taylor", "-o", "out.npz"],
        "needs 'order'",
    ),
    "huge table": ([*TABLE, "--grating", "cd", "--size", "2000000", "-o", "out.npz"], "GB of memory"),
    "no such table": ([*RENDER, "lost.npz", "-o", "out.png"], "There is no file 'lost.npz'"),
    "neither table nor preset": ([*RENDER, "cd.jpg", "-o", "out.png"], "neither a table"),
    "shape": ([*RENDER, "cd", "--shape", "cone", "-o", "out.png"], "'shape' must be one of"),
    "lamp": ([*RENDER, "cd", "--lamp", "1cm", "-o", "out.png"], "'lamp' must be three lengths"),
    "lamp inside": ([*RENDER, "cd", "--lamp", "0cm,0cm,0cm", "-o", "out.png"], "'lamp' must not stand"),
    "strengths": (
        [*RENDER, "cd", "--lamp-strength", "1", "--lamp-strength", "2", "-o", "out.png"],
        "each of 1 lamps",
    ),
    "metal": ([*RENDER, "cd", "--fresnel", "tin", "-o", "out.png"], "'aluminium'"),
    "picture's suffix": ([*RENDER, "cd", "-o", "out.gif"], "out.gif"),
    "fps alone": ([*RENDER, "cd", "--fps", "12", "-o", "out.png"], "'fps' needs 'animate'"),
    "turntable alone": (
        [*RENDER, "cd", "--turntable", "spin", "-o", "out.png"],
        "'turntable' needs 'animate'",
    ),
    "focus alone": ([*RENDER, "cd", "--focus", "20cm", "-o", "out.png"], "'focus' needs 'depth-of-field'"),
    "mesh lost": ([*RENDER, "cd", "--shape", "lost.obj", "-o", "out.png"], "lost.obj"),
    "target": ([*EXPORT, "cd", "-o", "out.html", "--to", "glsl"], "must be one of '.glsl'"),
    "suffix of no target": ([*EXPORT, "cd", "-o", "out.txt"], "'.html'"),
    "title of a shader": ([*EXPORT, "cd", "-o", "out.glsl", "--title", "x"], "'title' is for --to web"),
    "lamp of a shader": ([*EXPORT, "cd", "-o", "out.glsl", "--lamp", "1deg,1deg"], "'lamp' is of a scene"),
    "no wavelength": ([*MEASURE, *BENCH], "give one of 'wavelength'"),
    "no photograph": ([*MEASURE, *BENCH, "--wavelength", "530nm"], "photo.exr"),
    "no bench": (
        [*MEASURE[:2], "light.exr", *MEASURE[3:], "--wavelength", "530nm"],
        "give 'h-per-pixel', or 'camera-distance'",
    ),
    "exposures": (
        [*MEASURE[:2], "light.exr", *MEASURE[3:], *BENCH, "--wavelength", "530nm", "--exposures", "1,2"],
        "'exposures' must be one for each of 1",
    ),
    "dark": ([*MEASURE[:2], "dark.exr", *MEASURE[3:], *BENCH, "--wavelength", "530nm"], "have no light"),
    "model": (
        [*MEASURE[:2], "light.exr", *MEASURE[3:], *BENCH, "--wavelength", "530nm", "--model", "born"],
        "'model' must be one of",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_is_refused_in_one_line_and_nothing_is_written(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    np.save("heights.npy", np.zeros((8, 8)))
    picture.write("dark.exr", Picture(np.zeros((16, 16, 3), dtype=np.float32)))
    picture.write("light.exr", Picture(np.ones((16, 16, 3), dtype=np.float32)))
    before = sorted(tmp_path.iterdir())
    words, said = BAD[name]
    assert said in refused(words, capsys)
    assert sorted(tmp_path.iterdir()) == before
