"""A lens's flare over sequences: each frame with its own lights, each alone."""

import json

import numpy as np
import pytest

from aureole import Picture, picture
from aureole.cli.main import run

SHAPE = (24, 36)
LENS = [
    "--lens",
    "heliar_tronnier_100mm",
    "--grid",
    "8",
    "--wavelengths",
    "3",
    "--only",
    "2-5",
    "--gain",
    "1000",
]


@pytest.fixture
def shot(tmp_path):
    """A lamp that moves, and a third frame in which it is hidden."""
    lines = [{"lamps": 1, "width": SHAPE[1], "height": SHAPE[0], "frames": [1, 2, 3]}]
    for number in (1, 2, 3):
        pixels = np.full((*SHAPE, 3), 0.01, dtype=np.float32)
        if number < 3:
            pixels[8, 10 + number] = 100
            lines.append({"frame": number, "x": 10.5 + number, "y": 8.5, "flux": 100.0})
        picture.write(tmp_path / f"shot.{number}.exr", Picture(pixels))
    (tmp_path / "lights.jsonl").write_text("\n".join(map(json.dumps, lines)) + "\n")
    return tmp_path


def words(folder, name, *more):
    over = ["--over", str(folder / "shot.#.exr"), "-o", str(folder / name)]
    return ["flare", *LENS, *over, *map(str, more)]


def told(words, capsys, code=0):
    assert run([*words, "--json"]) == code
    return json.loads(capsys.readouterr().out)


def pixels_of(path):
    return picture.read(path).pixels


def test_each_frame_has_the_flare_of_its_own_lights(shot, capsys):
    lights = ["--lights", str(shot / "lights.jsonl")]
    report = told(words(shot, "out.#.exr", *lights), capsys)
    assert [frame["state"] for frame in report["frames"]] == ["done"] * 3
    assert [frame["lights"] for frame in report["frames"]] == [1, 1, 0]
    single = shot / "single.exr"
    over = ["--over", str(shot / "shot.2.exr"), "-o", str(single), "--lights-frame", "2"]
    told(["flare", *LENS, *over, *lights], capsys)
    np.testing.assert_array_equal(pixels_of(shot / "out.2.exr"), pixels_of(single))
    assert not np.array_equal(pixels_of(shot / "out.2.exr"), pixels_of(shot / "shot.2.exr"))
    # Where no light is to be seen there is no flare.
    np.testing.assert_array_equal(pixels_of(shot / "out.3.exr"), pixels_of(shot / "shot.3.exr"))
    # A second run keeps them; where one frame's light changes, only that frame is another job's.
    assert told(words(shot, "out.#.exr", *lights), capsys)["frames_kept"] == 3
    text = (shot / "lights.jsonl").read_text()
    (shot / "lights.jsonl").write_text(text.replace('"x": 12.5', '"x": 13.5'))
    assert told(words(shot, "out.#.exr", *lights, "--frames", "1,3"), capsys)["frames_kept"] == 2
    assert run(words(shot, "out.#.exr", *lights)) == 2
    assert "out.2.exr' is there and is no frame of this job" in capsys.readouterr().err


def test_lights_that_the_frames_show_are_found_with_one_threshold(shot, capsys):
    for name, find in (("a.#.exr", "auto"), ("b.#.exr", "50")):
        report = told(words(shot, name, "--find-lights", find, "--frames", "1-2"), capsys)
        assert [frame["lights"] for frame in report["frames"]] == [1, 1]
    report = told(words(shot, "b.#.exr", "--find-lights", "50"), capsys)
    assert [frame["state"] for frame in report["frames"]] == ["kept", "kept", "done"]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ([], "no light is given for the frames"),
        (["--find-lights", "50", "--layers"], "'layers' is for one picture"),
        (["--find-lights", "50", "--preview", "a.png"], "'preview' is for one picture"),
        (["--find-lights", "50", "--lights-frame", "2"], "'lights-frame' is for one picture"),
        (["--find-lights", "50", "--fps", "12"], "'fps' needs 'video'"),
    ],
)
def test_what_no_frame_could_be_made_with_is_refused(shot, capsys, more, said):
    assert run(words(shot, "out.#.exr", *more)) == 2
    assert said in capsys.readouterr().err
    assert not (shot / "out.1.exr").exists()


def test_flags_of_sequences_need_one(shot, capsys):
    over = ["--over", str(shot / "shot.1.exr"), "-o", str(shot / "one.exr"), "--find-lights", "50"]
    assert run(["flare", *LENS, *over, "--frames", "1-2"]) == 2
    assert "'frames' is for sequences" in capsys.readouterr().err
