"""`aureole glare --lights` and `aureole flare --lights`: a picture's lights decide, found or from a file."""

import json

import numpy as np
import pytest

from aureole import Picture, glare, jobs, picture
from aureole.cli.main import run

SMALL = ["--kernel-size", "33", "--f-number", "16", "--json"]


def told(words, capsys, code=0):
    assert run([str(word) for word in words]) == code
    return json.loads(capsys.readouterr().out)


def refused(words, capsys):
    assert run([str(word) for word in words]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    return lines[0]


def street(n=1):
    """A wall, a bright lamp that moves to the right, and one that stands still."""
    pixels = np.full((48, 80, 3), 0.1, dtype=np.float32)
    pixels[12:14, 8 + 4 * n : 10 + 4 * n] = 400.0
    pixels[32:35, 60:63] = 100.0
    return Picture(pixels)


@pytest.fixture
def shot(tmp_path):
    for n in (1, 2, 3):
        picture.write(tmp_path / f"in.{n:04d}.exr", street(n), pixel_type="float")
    return tmp_path


def pixels_of(path):
    return picture.read(path).pixels


def test_only_lamps_make_glare(shot, capsys):
    out = shot / "a.exr"
    told(["glare", shot / "in.0001.exr", "-o", out, "--lights", "auto", *SMALL], capsys)
    given = street().pixels
    wall_black = Picture(np.where(given > 1, given, 0))
    told(["glare", shot / "in.0001.exr", "-o", shot / "b.exr", *SMALL], capsys)
    picture.write(shot / "lamps.exr", wall_black, pixel_type="float")
    told(["glare", shot / "lamps.exr", "-o", shot / "c.exr", *SMALL], capsys)
    # The wall stays as it is, and the lamps' glare is that of the lamps on black.
    wall = np.where(given > 1, 0, given)
    np.testing.assert_allclose(pixels_of(out), pixels_of(shot / "c.exr") + wall, rtol=1e-4, atol=1e-5)
    assert np.abs(pixels_of(out) - pixels_of(shot / "b.exr"))[24, 1] == pytest.approx(0, abs=0.1)
    assert pixels_of(out).sum() == pytest.approx(given.sum(), rel=1e-3)


def test_a_luminance_and_a_file_choose_the_lamps(shot, capsys):
    """Above 150 there is one lamp; the same one alone in a file gives the same picture."""
    told(["glare", shot / "in.0001.exr", "-o", shot / "a.exr", "--lights", "150", *SMALL], capsys)
    lights = shot / "one.jsonl"
    lights.write_text('{"x": 13, "y": 13}\n', encoding="utf-8")
    told(["glare", shot / "in.0001.exr", "-o", shot / "b.exr", "--lights", lights, *SMALL], capsys)
    np.testing.assert_allclose(pixels_of(shot / "a.exr"), pixels_of(shot / "b.exr"), rtol=1e-5)
    far = pixels_of(shot / "a.exr") - street().pixels
    # Beyond the kernel's reach of sixteen pixels nothing comes from the lamp that was not chosen.
    assert np.abs(far[:, 40:]).max() < 1e-3


def test_each_frame_of_a_shot_has_its_own_lamps(shot, capsys):
    """Tracked lamps, of which one is left: frames are as made one by one."""
    source, lights = shot / "in.####.exr", shot / "all.jsonl"
    told(["lights", "track", source, "--frames", "1-3", "-o", lights, "--json"], capsys)
    found = glare.read_lamps(lights)
    moving = tuple(seen for seen in found.sightings if seen.lamp.place[1] < 20)
    assert [seen.lamp.place[0] for seen in moving] == pytest.approx([13, 17, 21])
    glare.write_lamps(shot / "moving.jsonl", glare.LampList(moving, found.shape, "rec709", found.threshold))
    words = ["--lights", shot / "moving.jsonl", *SMALL]
    told(["glare", source, "-o", shot / "out.####.exr", "--frames", "1-3", *words], capsys)
    single = ["glare", shot / "in.0002.exr", "-o", shot / "one.exr", "--lights-frame", "2", *words]
    told(single, capsys)
    assert np.array_equal(pixels_of(shot / "one.exr"), pixels_of(shot / "out.0002.exr"))
    for n in (1, 2, 3):
        added = np.abs(pixels_of(shot / f"out.{n:04d}.exr") - street(n).pixels).max(axis=2)
        assert added[:, 50:].max() < 1e-3
        assert added[10:16, 8 + 4 * n].min() > 1e-3
    # Another file of lights is another job: its frames are not those that lie there.
    said = refused(
        ["glare", source, "-o", shot / "out.####.exr", "--frames", "1-3", "--lights", "auto", *SMALL], capsys
    )
    assert "out.0001.exr" in said


def test_one_threshold_serves_a_whole_shot(shot, capsys):
    """Made alone or with the others, a frame is the same: the threshold is that of all that lie there."""
    source, words = shot / "in.####.exr", ["--lights", "auto", *SMALL]
    picture.write(shot / "in.0003.exr", Picture(street(3).pixels * 3), pixel_type="float")
    told(["glare", source, "-o", shot / "out.####.exr", "--frames", "1-3", *words], capsys)
    told(["glare", source, "-o", shot / "alone.####.exr", "--frames", "2", *words], capsys)
    assert np.array_equal(pixels_of(shot / "alone.0002.exr"), pixels_of(shot / "out.0002.exr"))
    level = jobs.shot_threshold([shot / f"in.{n:04d}.exr" for n in (1, 2, 3)])
    assert level == pytest.approx(1.6)


def test_a_fading_lamp_takes_its_glare_with_it_evenly():
    """No frame's glare changes by more than the light does, times two near the threshold."""
    lights = jobs.GlareLights(threshold=2.0)
    spread = []
    for value in np.linspace(6, 0, 61):
        pixels = np.zeros((9, 9, 3), dtype=np.float32)
        pixels[4, 4] = value
        spread.append(float((lights.matte(Picture(pixels)) * pixels[..., 0]).sum()))
    steps = -np.diff(spread)
    assert steps.min() >= -1e-6
    assert steps.max() <= 0.2 + 1e-5
    assert spread[-1] == 0


def test_flares_take_lights_of_a_file_and_found_ones(shot, capsys):
    common = [
        "--lens",
        "heliar_tronnier_100mm",
        "--only",
        "2-5",
        "--grid",
        "8",
        "--wavelengths",
        "3",
        "--json",
    ]
    over, lights = shot / "in.0001.exr", shot / "found.jsonl"
    told(["lights", "find", over, "-o", lights, "--json"], capsys)
    words = ["flare", "--over", over, "-o", shot / "a.exr", *common]
    listed = told([*words, "--lights", lights], capsys)["lights"]
    found = told([*words, "--find-lights", "auto"], capsys)["lights"]
    assert [light["place_pixels"] for light in listed] == [
        pytest.approx([13, 13]),
        pytest.approx([61.5, 33.5]),
    ]
    # Even squares of 2 and 3 pixels: by their spread less a pixel's own, and by their area.
    spread = [4 * (variance - 1 / 12) ** 0.5 for variance in (1 / 4, 2 / 3)]
    area = [side * (4 / np.pi) ** 0.5 for side in (2, 3)]
    for one, other, wide, covered in zip(listed, found, spread, area, strict=True):
        assert one["place_pixels"] == pytest.approx(other["place_pixels"], abs=1e-3)
        # The file's flux is above the ground, which the other keeps.
        assert one["strength"] == pytest.approx(other["strength"], rel=0.01)
        assert one["size_deg"] / other["size_deg"] == pytest.approx(wide / covered, rel=0.01)
    # A file may say no more than places, and may be of a proxy; the picture says the strength.
    lights.write_text(
        '{"lamps": 1, "width": 40, "height": 24}\n{"x": 6.5, "y": 6.5, "frame": 7}\n', encoding="utf-8"
    )
    (alone,) = told([*words, "--lights", lights], capsys)["lights"]
    assert alone["place_pixels"] == pytest.approx([13, 13])
    assert alone["strength"] == pytest.approx(1600, rel=1e-5)


def test_many_lights_are_cut_and_said(shot, capsys):
    lines = [json.dumps({"x": 4 + 3 * n, "y": 9, "flux": n + 1}) for n in range(12)]
    (shot / "many.jsonl").write_text("\n".join(lines), encoding="utf-8")
    words = ["flare", "--lens", "heliar_tronnier_100mm", "--only", "2-5", "--grid", "8", "--wavelengths", "3"]
    words += ["--size", "80x48", "-o", shot / "a.exr", "--lights", shot / "many.jsonl", "--most-lights", "2"]
    assert run([str(word) for word in [*words, "--json"]]) == 0
    said = capsys.readouterr()
    assert "of 12 lights the 2 strongest are taken; see --most-lights" in said.err
    assert [light["strength"] for light in json.loads(said.out)["lights"]] == [12, 11]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--lights", "bright"], "'lights' must be auto, a file or a luminance such as 50, got 'bright'"),
        (["--lights", "-3"], "'lights' must be a finite number > 0"),
        (["--lights", "{0}/none.jsonl"], "none.jsonl' cannot be read"),
        (["--lights-frame", "3"], "'lights-frame' needs the file of lights"),
        (["--lights", "auto", "--lights-frame", "3"], "'lights-frame' needs the file of lights"),
        (["--lights", "{0}/two.jsonl"], "has lights of frames 1 to 2; say which with --lights-frame"),
        (["--lights", "{0}/two.jsonl", "--lights-frame", "9"], "says nothing of frame 9; it has 1 to 2"),
        (["--lights", "{0}/wide.jsonl"], "whose proportions 80 x 48 pixels have not"),
    ],
)
def test_refusals(words, said, shot, capsys):
    first = '{"lamps": 1, "frames": [1, 2]}\n'
    (shot / "two.jsonl").write_text(first + '{"frame": 1, "x": 3, "y": 4}\n', encoding="utf-8")
    (shot / "wide.jsonl").write_text('{"lamps": 1, "width": 80, "height": 20}\n{"x": 3, "y": 4}\n', "utf-8")
    words = [word.format(shot) for word in words]
    assert said in refused(["glare", shot / "in.0001.exr", "-o", shot / "a.exr", *words], capsys)
    assert not (shot / "a.exr").exists()


def test_flares_refuse_strange_lights(shot, capsys):
    words = ["flare", "--lens", "heliar_tronnier_100mm", "-o", shot / "a.exr"]
    assert "'find-lights' needs the picture" in refused([*words, "--find-lights", "auto"], capsys)
    assert "'find-lights' must be auto or a lum" in refused([*words, "--find-lights", "x"], capsys)
    assert "'lights-frame' needs the file" in refused([*words, "--lights-frame", "1"], capsys)
    assert "cannot be read" in refused([*words, "--lights", shot / "none.jsonl"], capsys)


def test_frames_that_a_file_does_not_know_are_broken(shot, capsys):
    """The others are made."""
    (shot / "two.jsonl").write_text(
        '{"lamps": 1, "frames": [1, 2]}\n{"frame": 1, "x": 13, "y": 13}\n', encoding="utf-8"
    )
    words = ["glare", shot / "in.####.exr", "-o", shot / "out.####.exr", "--frames", "1-3", *SMALL]
    frames = told([*words, "--lights", shot / "two.jsonl"], capsys, code=1)["frames"]
    assert [frame["state"] for frame in frames] == ["done", "done", "broken"]
    # Frame 2 has no light: it stays as it is.
    np.testing.assert_allclose(pixels_of(shot / "out.0002.exr"), street(2).pixels, rtol=1e-6)
