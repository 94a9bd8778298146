"""`aureole lens`: the list, the check, the drawing, the import, as a person types them."""

import json
import math

import numpy as np
import pytest

from aureole import flare, jobs, picture, presets
from aureole.cli.main import run

HELIAR = "heliar_tronnier_100mm"


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


def test_the_list_names_every_lens(capsys):
    found = told(["lens", "list", "--json"], capsys)["lenses"]
    assert [line["lens"] for line in found] == presets.names("lenses")
    assert run(["lens", "list"]) == 0
    text = capsys.readouterr().out
    assert all(name in text for name in presets.names("lenses"))


@pytest.mark.parametrize(
    ("name", "ghosts"),
    [
        (HELIAR, {"paper": 11, "same-side": 13, "all": 28}),
        ("itoh_wide_zoom_123mm_seed", {"paper": 64, "same-side": 73, "all": 153}),
        ("nikon_tele_zoom_140mm_seed", {"paper": 139, "same-side": 142, "all": 210}),
        ("canon_tele_zoom_135mm", {"paper": 304, "same-side": 312, "all": 528}),
    ],
)
def test_the_check_counts_ghosts_by_each_rule(name, ghosts, capsys):
    assert told(["lens", "check", name, "--json"], capsys)["ghosts"] == ghosts


def test_the_check_measures(capsys):
    found = told(["lens", "check", HELIAR, "--json"], capsys)
    assert found["focal_length_m"] == pytest.approx(99.2358e-3, abs=1e-7)
    assert found["back_focus_m"] == pytest.approx(81.3151e-3, abs=1e-7)
    assert found["f_number"] == pytest.approx(3.430, abs=5e-4)
    assert found["findings"] == []
    across = told(["lens", "check", "schneider_anamorphic_31mm", "--json"], capsys)
    assert across["squeeze"] == pytest.approx(1.92, abs=0.01)
    assert across["back_focus_across_m"] == pytest.approx(across["back_focus_m"], abs=50e-6)


def test_the_check_says_what_is_wrong(tmp_path, capsys):
    text = flare.to_toml(flare.load(HELIAR)).replace("radius_mm = 28.34", "radius_mm = -28.34")
    path = tmp_path / "wrong.toml"
    path.write_text(text, encoding="utf-8")
    kinds = [found["kind"] for found in told(["lens", "check", path, "--json"], capsys)["findings"]]
    assert kinds[:2] == ["focal-length", "sign"]
    assert run(["lens", "check", str(path)]) == 0
    said = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "surface 5: the other sign of its radius gives 100 mm" in said


def test_a_plate_is_reported_without_infinities(tmp_path, capsys):
    path = tmp_path / "plate.toml"
    path.write_text(
        'title = "Plate"\nsource = "None"\nfocal_length_mm = 50\nf_number = 4\nsurfaces = [\n'
        "{ radius_mm = 0, thickness_mm = 3, index = 1.5, semi_aperture_mm = 9 },\n"
        "{ radius_mm = 0, thickness_mm = 3, semi_aperture_mm = 9 },\n"
        "{ radius_mm = 0, thickness_mm = 40, semi_aperture_mm = 9, stop = true }]\n",
        encoding="utf-8",
    )
    found = told(["lens", "check", path, "--json"], capsys)
    assert found["focal_length_m"] is None
    assert found["back_focus_m"] is None
    numbers = [value for value in found.values() if isinstance(value, float)]
    assert all(math.isfinite(value) for value in numbers)
    assert run(["lens", "show", str(path), "-o", str(tmp_path / "plate.png")]) == 0


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_a_drawing_is_written(suffix, tmp_path, capsys):
    out = tmp_path / f"lens{suffix}"
    found = told(["lens", "show", HELIAR, "-o", out, "--ghost", "2,5", "--ghost", "1,4", "--json"], capsys)
    assert found["ghosts"] == ["2-5", "1-4"]
    assert found["files"] == [str(out)]
    assert out.stat().st_size > 5000


def test_a_drawing_shows_ghosts_in_their_colours(tmp_path, capsys):
    """Red rays of the first ghost are there with it, and not without it."""
    reds = []
    for words in ([], ["--ghost", "2,5"]):
        out = tmp_path / f"{len(words)}.png"
        assert run(["lens", "show", HELIAR, "-o", str(out), *words]) == 0
        pixels = picture.read(out).pixels[..., :3]
        reds.append(np.count_nonzero((pixels[..., 0] > 0.4) & (pixels[..., 1:].max(axis=2) < 0.03)))
    assert reds[0] < 50 < reds[1]
    capsys.readouterr()


def test_a_ghost_that_is_blocked_is_said_to_be(tmp_path, capsys):
    out = tmp_path / "a.png"
    words = ["lens", "show", "nikon_tele_zoom_140mm_seed", "-o", out, "--ghost", "1,2", "--angle", "40deg"]
    assert run([str(word) for word in words]) == 0
    assert "ghost 1, 2: no ray passes all semi-apertures" in capsys.readouterr().err


def test_an_import_is_written_and_read(tmp_path, capsys):
    lens = flare.load("cooke_triplet_100mm")
    rows = [
        f"{1e3 / s.curvature if s.curvature else 0} {1e3 * s.thickness} {0 if s.stop else s.glass.index} "
        f"{2e3 * s.semi_aperture}"
        for s in lens.surfaces
    ]
    source, out = tmp_path / "triplet.dat", tmp_path / "triplet.toml"
    source.write_text("# Triplet\n" + "\n".join(rows), encoding="utf-8")
    found = told(["lens", "import", source, "-o", out, "--json"], capsys)
    assert any("diameters" in note for note in found["notes"])
    assert found["files"] == [str(out)]
    checked = told(["lens", "check", out, "--json"], capsys)
    assert checked["focal_length_m"] == pytest.approx(found["focal_length_m"], rel=1e-9)
    assert found["focal_length_m"] == pytest.approx(99.901e-3, abs=1e-6)
    assert told(["lens", "check", source, "--json"], capsys)["ghosts"]["all"] == 15


def test_refusals(tmp_path, capsys):
    out = tmp_path / "a.png"
    assert "has no 'heliar'" in refused(["lens", "check", "heliar"], capsys)
    assert "two different reflecting surfaces out of 1, 2, 3" in refused(
        ["lens", "show", HELIAR, "-o", out, "--ghost", "2,6"], capsys
    )
    assert refused(["lens", "show", HELIAR, "-o", out, "--ghost", "2"], capsys).startswith("aureole: 'ghost'")
    assert "such as 2,5, got 'two'" in refused(["lens", "show", HELIAR, "-o", out, "--ghost", "two"], capsys)
    assert "suffix of the drawing" in refused(["lens", "show", HELIAR, "-o", tmp_path / "a.exr"], capsys)
    assert "'angle'" in refused(["lens", "show", HELIAR, "-o", out, "--angle", "89deg"], capsys)
    assert not out.exists()
    assert "suffix of the output" in refused(["lens", "import", "a.zmx", "-o", out], capsys)
    assert "cannot be read" in refused(["lens", "import", "a.zmx", "-o", tmp_path / "a.toml"], capsys)


HOSTILE = {
    "negative thickness": ("thickness_mm = 7.7,", "thickness_mm = -7.7,"),
    "semi-aperture over radius": ("semi_aperture_mm = 14.5", "semi_aperture_mm = 31"),
    "not a number": ("radius_mm = 30.81", "radius_mm = nan"),
    "no stop": (", stop = true", ""),
    "two stops": ("semi_aperture_mm = 12 ", "semi_aperture_mm = 12, stop = true "),
    "index below one": ("index = 1.652", "index = 0.652"),
    "unknown key": ("radius_mm = 30.81", "radius = 30.81"),
    "wrong unit": ("radius_mm = 30.81", 'radius_mm = "3.081cm"'),
}


@pytest.mark.parametrize("case", [*HOSTILE, "ten thousand surfaces"])
@pytest.mark.parametrize("command", ["check", "show"])
def test_hostile_files_are_refused_in_one_line(case, command, tmp_path, capsys):
    text = flare.to_toml(flare.load(HELIAR)).replace(', coating = "single"', "")
    path, out = tmp_path / "mine.toml", tmp_path / "a.png"
    if case in HOSTILE:
        find, put = HOSTILE[case]
        assert find in text
        text = text.replace(find, put, 1)
    else:
        text = text.replace("surfaces = [\n", "surfaces = [\n" + text.splitlines()[-2] * 10_000)
    path.write_text(text, encoding="utf-8")
    line = refused(["lens", command, path, *(["-o", out] if command == "show" else [])], capsys)
    assert "mine.toml" in line
    assert not out.exists()


def test_a_fields_edge_is_where_the_sensor_ends():
    lens = flare.load(HELIAR)
    angle = jobs.lens_drawing.field_angle(lens)
    assert math.tan(angle) == pytest.approx(12 / 99.2358, rel=1e-5)


def test_ghosts_are_ranked_by_their_light(capsys):
    words = ["lens", "ghosts", HELIAR, "--light", "8deg,3deg", "--illuminant", "line:550nm"]
    found = told([*words, "--ghosts", "90%", "--json"], capsys)
    assert found["out_of"] == {"which": "all", "bounces": 2, "count": 28}
    energies = [line["energy"] for line in found["ghosts"]]
    assert energies == sorted(energies, reverse=True)
    assert found["ghosts"][-2]["cumulative"] < 0.9 <= found["ghosts"][-1]["cumulative"]
    assert sum(energies) == pytest.approx(found["ghosts"][-1]["cumulative"] * found["ghost_to_image"])
    side = told([*words, "--ghosts", "same-side", "--f-number", "8", "--everywhere", "--json"], capsys)
    assert len(side["ghosts"]) == 13
    on_sensor = told([*words, "--ghosts", "same-side", "--f-number", "8", "--json"], capsys)
    assert 0 < on_sensor["ghost_to_image"] < 0.5 * side["ghost_to_image"]
    assert side["ghosts"][-1]["cumulative"] == pytest.approx(1)
    four = told([*words, "--ghosts", "top:3", "--four-bounces", "--json"], capsys)
    assert four["out_of"]["count"] == 658
    assert all(line["ghost"].count("-") == 3 for line in four["ghosts"])
    assert four["ghost_to_image"] < 0.1 * found["ghost_to_image"]
    assert run([*words, "--ghosts", "top:2"]) == 0
    text = capsys.readouterr().out
    assert "28 ghosts together carry" in text
    assert found["ghosts"][1]["ghost"] in text


def test_wrong_words_for_ghosts_are_refused(capsys):
    assert refused(["lens", "ghosts", HELIAR, "--ghosts", "top:x"], capsys) == (
        "aureole: 'ghosts' must be such as 'top:20' or '90%', got 'top:x'."
    )
    assert refused(["lens", "ghosts", HELIAR, "--light", "3deg"], capsys) == (
        "aureole: 'light' must be two angles such as 8deg,3deg, got '3deg'."
    )
    assert "less than 89 degrees" in refused(["lens", "ghosts", HELIAR, "--light", "95deg,0deg"], capsys)
