"""`aureole flare`: what it writes, what it says, what it refuses, as a person types it."""

import json

import numpy as np
import OpenImageIO
import pytest

from aureole import Picture, flare, picture
from aureole.cli.flare_options import place
from aureole.cli.main import run
from aureole.refuse import Refusal

HELIAR = "heliar_tronnier_100mm"
SMALL = ["flare", "--lens", HELIAR, "--size", "160x90", "--f-number", "8", "--ghosts", "top:4"]
LIGHT = ["--light", "2deg,1deg"]


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
def night(tmp_path):
    """A dark picture with two lamps."""
    pixels = np.full((90, 160, 3), 1e-3, dtype=np.float32)
    pixels[30:32, 60:62] = (40, 20, 10)
    pixels[70, 120] = (10, 20, 90)
    picture.write(tmp_path / "night.exr", Picture(pixels))
    return tmp_path / "night.exr"


def test_ghosts_on_black(tmp_path, capsys):
    out, png = tmp_path / "out.exr", tmp_path / "look.png"
    found = told([*SMALL, *LIGHT, "--blades", "6", "-o", out, "--preview", png, "--json"], capsys)
    assert found["lens"] == HELIAR
    assert found["ghosts"] == len(found["energies"]) == 4
    assert found["f_number"] == pytest.approx(8)
    assert 1e-5 < found["ghost_to_image"] < 1e-2
    assert found["files"] == [str(out), str(png)]
    assert found["lights"][0]["angles_deg"] == pytest.approx([2, 1])
    read = picture.read(out)
    assert read.pixels.shape == (90, 160, 3)
    # All that falls on the picture is no more than all that reaches the sensor's plane.
    assert 0 < read.pixels[..., 1].sum() < 2 * found["ghost_to_image"]
    attributes = picture.header_of(read).attributes
    assert attributes["aureole:lens"].value == HELIAR
    assert attributes["aureole:ghost_to_image"].value == pytest.approx(found["ghost_to_image"], rel=1e-6)
    # The preview shows something: bright ghosts on black.
    shown = picture.read(png).pixels
    assert shown.shape == (90, 160, 3)
    assert shown.max() > 0.1
    assert run([str(word) for word in [*SMALL, *LIGHT, "-o", out]]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "2 deg right, 1 deg down" in said
    assert "ghost to image" in said


def test_layers_open_elsewhere_and_add_up(tmp_path, capsys):
    out = tmp_path / "layers.exr"
    found = told([*SMALL, *LIGHT, "--layers", "--starburst", "-o", out, "--json"], capsys)
    source = OpenImageIO.ImageInput.open(str(out))
    names = source.spec().channelnames
    planes = dict(zip(names, np.moveaxis(source.read_image(OpenImageIO.FLOAT), 2, 0), strict=True))
    source.close()
    ghosts = ["ghost_" + name.replace("-", "_") for name in found["energies"]]
    wanted = [f"{layer}.{c}" for layer in (*ghosts, "ghosts", "starburst") for c in "RGB"]
    assert sorted(names) == sorted([*"RGB", *wanted])
    for channel in "RGB":
        each = sum(planes[f"{name}.{channel}"].astype(np.float64) for name in ghosts)
        np.testing.assert_allclose(planes[f"ghosts.{channel}"], each, rtol=1e-6, atol=1e-6 * each.max())
        whole = planes[f"ghosts.{channel}"].astype(np.float64) + planes[f"starburst.{channel}"]
        np.testing.assert_allclose(planes[channel], whole, rtol=1e-6, atol=1e-12)


def test_over_a_picture_lights_are_as_strong_as_it_shows(night, tmp_path, capsys):
    out = tmp_path / "out.exr"
    over = ["flare", "--lens", HELIAR, "--over", night, "--only", "1-3", "--only", "7-9", "-o", out, "--json"]
    found = told([*over, "--find-lights", "1"], capsys)
    assert len(found["lights"]) == 2
    assert found["size"] == [160, 90]
    np.testing.assert_allclose(found["lights"][0]["place_pixels"], [61, 31], atol=1e-6)
    added = picture.read(out).pixels - picture.read(night).pixels
    assert added.min() >= -1e-6
    assert added.sum() > 0
    by_hand = told([*over, "--light", "61px,31px", "--light", "120.5px,70.5px"], capsys)
    for one, other in zip(found["lights"], by_hand["lights"], strict=True):
        assert one["strength"] == pytest.approx(other["strength"], rel=1e-5)
    stronger = told([*over, "--light", "61px,31px", "--strength", "5"], capsys)
    assert stronger["lights"][0]["strength"] == 5


def test_colours_and_sizes_of_lights(tmp_path, capsys):
    words = [*SMALL, *LIGHT, "--light=-1deg,-1deg", "-o", tmp_path / "out.exr", "--json"]
    found = told([*words, "--light-colour", "1,0.5,0.2", "--light-size", "0.5deg"], capsys)
    assert [light["size_deg"] for light in found["lights"]] == pytest.approx([0.5, 0.5])
    found = told([*words, "--strength", "1", "--strength", "3", "--illuminant", "A"], capsys)
    assert [light["strength"] for light in found["lights"]] == [1, 3]
    assert found["lights"][1]["angles_deg"] == pytest.approx([-1, -1])


def test_lens_files_and_zooms(tmp_path, capsys):
    """A Zemax file of the lens has the same ghosts; a zoom moves to the position that is named."""
    lens = flare.load(HELIAR)
    lines = ["MODE SEQ", "NAME Copy", "UNIT MM X W X CM MR CPMM", "SURF 0", "  CURV 0.0", "  DISZ INFINITY"]
    for k, surface in enumerate(lens.surfaces, 1):
        lines += [f"SURF {k}", *["  STOP"] * surface.stop, f"  CURV {surface.curvature / 1e3!r} 0 0 0 0"]
        lines += [f"  DISZ {1e3 * surface.thickness!r}", f"  DIAM {1e3 * surface.semi_aperture!r} 1 0 0 1"]
        glass = surface.glass
        lines += [f"  GLAS ___BLANK 1 0 {glass.index} {glass.abbe} 0 0 0 0 0 0"] * (glass.index != 1)
    path = tmp_path / "copy.zmx"
    path.write_text("\n".join([*lines, f"SURF {len(lens.surfaces) + 1}", "  CURV 0.0"]), encoding="utf-8")
    words = ["flare", "--size", "160x90", *LIGHT, "--only", "7-9", "-o", tmp_path / "a.exr", "--json"]
    own, copied = (told([*words, "--lens", name], capsys) for name in (HELIAR, path))
    assert copied["focal_length_m"] == pytest.approx(own["focal_length_m"], rel=1e-4)
    assert copied["ghosts"] == 1
    zoom = flare.load("canon_tele_zoom_70mm")
    found = told([*words, "--lens", zoom.name, "--state", zoom.states[0].name], capsys)
    assert found["focal_length_m"] == pytest.approx(zoom.states[0].focal_length, rel=0.02)


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["-o", "a.exr"], "'light' is missing"),
        ([*LIGHT, "-o", "a.exr", "--lens", "helar"], "heliar"),
        (["--light", "2deg", "-o", "a.exr"], "'light' must be two angles such as 8deg,3deg"),
        (["--light", "2deg,3px", "-o", "a.exr"], "'light' must be two angles"),
        (["--light", "2mm,3mm", "-o", "a.exr"], "unknown unit 'mm'"),
        (["--light", "91deg,0", "-o", "a.exr"], "less than 89 degrees"),
        ([*LIGHT, "-o", "a.png", "--layers"], "only EXR holds layers"),
        ([*LIGHT, "-o", "a.gif"], "suffix"),
        ([*LIGHT, "-o", "nowhere/a.exr"], "no folder"),
        ([*LIGHT, "-o", "a.exr", "--over", "missing.exr"], "missing.exr"),
        ([*LIGHT, "-o", "a.exr", "--light-colour", "1,1"], "'light-colour' must be 3 numbers"),
        (
            [*LIGHT, "-o", "a.exr", "--strength", "1", "--strength", "2"],
            "once, or for each of 1 lights, got 2",
        ),
        ([*LIGHT, "-o", "a.exr", "--strength", "0"], "'strength' must be"),
        ([*LIGHT, "-o", "a.exr", "--ghosts", "top:0"], "top:0"),
        ([*LIGHT, "-o", "a.exr", "--ghosts", "papr"], "paper"),
        ([*LIGHT, "-o", "a.exr", "--only", "2"], "2-5"),
        ([*LIGHT, "-o", "a.exr", "--grid", "1"], "'grid' must be an integer >= 2"),
        ([*LIGHT, "-o", "a.exr", "--wavelengths", "0"], "'wavelengths' must be"),
        ([*LIGHT, "-o", "a.exr", "--f-number", "0.1"], "f"),
        ([*LIGHT, "-o", "a.exr", "--f-number", "-2"], "'f-number' must be"),
        ([*LIGHT, "-o", "a.exr", "--blades", "2"], "'blades' must be an integer >= 3, got 2."),
        ([*LIGHT, "-o", "a.exr", "--state", "wide"], "wide"),
        ([*LIGHT, "-o", "a.exr", "--find-lights", "3"], "'find-lights' needs the picture"),
    ],
)
def test_refusals_are_one_line(words, why, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lens = [] if "--lens" in words else ["--lens", HELIAR]
    assert why in refused(["flare", *lens, "--size", "160x90", *words], capsys)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("8deg,3deg", ((np.deg2rad(8), np.deg2rad(3)), False)),
        ("-8, 3", ((np.deg2rad(-8), np.deg2rad(3)), False)),
        ("1200px,-300.5px", ((1200.0, -300.5), True)),
    ],
)
def test_places_are_angles_or_pixels(text, wanted):
    found = place(text)
    np.testing.assert_allclose(found[0], wanted[0])
    assert found[1] is wanted[1]


@pytest.mark.parametrize("text", ["", "8deg", "1,2,3", "xpx,1px", "nanpx,1px", "1px,2deg"])
def test_what_is_no_place_is_refused(text):
    with pytest.raises(Refusal, match="'light'"):
        place(text)
