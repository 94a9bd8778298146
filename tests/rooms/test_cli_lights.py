"""`aureole lights`: find and track, as a person types them."""

import json
from dataclasses import replace

import numpy as np
import OpenImageIO
import pytest

from aureole import Picture, glare, jobs, picture
from aureole.cli.main import run


def told(words, capsys):
    assert run([str(word) for word in words]) == 0
    return json.loads(capsys.readouterr().out)


def refused(words, capsys):
    assert run([str(word) for word in words]) == 2
    said = capsys.readouterr()
    lines = said.err.strip().splitlines()
    assert len(lines) == 1
    return lines[0]


def frame_of(n):
    """Two lamps that pass each other in front of a dim wall; the first is hidden in frames 5 and 6."""
    pixels = np.full((60, 120, 3), 0.05, dtype=np.float32)
    if n not in (5, 6):
        pixels[20:23, 10 + 8 * n : 13 + 8 * n] = (40.0, 30.0, 20.0)
    pixels[35:37, 110 - 8 * n : 112 - 8 * n] = (5.0, 6.0, 9.0)
    return Picture(pixels)


@pytest.fixture
def shot(tmp_path):
    for n in range(1, 11):
        picture.write(tmp_path / f"shot.{n:04d}.exr", frame_of(n))
    return tmp_path


def test_find_writes_the_lights_and_marks_them(shot, capsys):
    out, look = shot / "found.jsonl", shot / "look.png"
    report = told(["lights", "find", shot / "shot.0001.exr", "-o", out, "--preview", look, "--json"], capsys)
    assert report["lights"] == 2
    assert report["size"] == [120, 60]
    assert report["brightest"][0]["place_pixels"] == pytest.approx([19.5, 21.5])
    found = glare.read_lamps(out)
    assert [seen.lamp.place for seen in found.sightings] == [
        pytest.approx((19.5, 21.5)),
        pytest.approx((103, 36)),
    ]
    assert found.threshold == pytest.approx(0.8)
    drawn = picture.read(look).pixels
    assert drawn.shape == (60, 120, 3)
    # Round the brighter lamp there is more to be seen than in the picture itself.
    plain = picture.to_display(frame_of(1))
    assert np.abs(picture.encode_srgb(drawn) - plain)[10:33, 8:31].max() > 0.3
    assert np.abs(picture.encode_srgb(drawn) - plain)[50:, 40:70].max() < 0.02


def test_a_threshold_can_be_given(shot, capsys):
    out = shot / "found.jsonl"
    words = ["lights", "find", shot / "shot.0001.exr", "-o", out, "--threshold", 20, "--json"]
    assert told(words, capsys)["lights"] == 1
    assert told([*words[:-3], "--threshold", "0.1", "--most", "1", "--json"], capsys)["lights"] == 1


def test_track_numbers_lights_through_the_shot(shot, capsys):
    out, looks = shot / "tracks.jsonl", shot / "look.####.png"
    report = told(
        [
            "lights",
            "track",
            shot / "shot.####.exr",
            "--frames",
            "1-10",
            "-o",
            out,
            "--preview",
            looks,
            "--json",
        ],
        capsys,
    )
    assert report["lights"] == 2
    assert [line["frames"] for line in report["tracks"]] == [8, 10]
    found = glare.read_lamps(out)
    assert found.frames == tuple(range(1, 11))
    assert [[seen.id for seen in found.at(n)] for n in (1, 5, 8)] == [[1, 2], [2], [1, 2]]
    places = [seen.lamp.place[0] for seen in found.sightings if seen.id == 1]
    assert places == pytest.approx([11.5 + 8 * n for n in range(1, 11) if n not in (5, 6)])
    assert all((shot / f"look.{n:04d}.png").exists() for n in range(1, 11))


def test_people_are_told_in_tables(shot, capsys):
    assert run(["lights", "find", str(shot / "shot.0001.exr"), "-o", str(shot / "a.jsonl")]) == 0
    assert "19.5, 21.5" in capsys.readouterr().out
    words = ["lights", "track", str(shot / "shot.####.exr"), "--frames", "1-3", "-o", str(shot / "a.jsonl")]
    assert run(words) == 0
    said = capsys.readouterr().out
    assert "merged" in said
    assert "19.5, 21.5" in said
    assert "103, 36" in said


def test_places_count_from_what_is_shown(tmp_path, capsys):
    """A picture with pixels beyond what it shows: its lights stand where a viewer sees them."""
    pixels = np.full((40, 80, 3), 0.05, dtype=np.float32)
    pixels[20:23, 30:33] = 40.0
    pixels[2:4, 4:6] = 20.0
    # The first pixel lies ten columns before the first that is shown, and five rows above it.
    picture.write(tmp_path / "plain.exr", Picture(pixels[:30, :60]))
    header = picture.header_of(picture.read(tmp_path / "plain.exr"))
    header = replace(header, data_window=picture.Window(-10, -5, 80, 40))
    picture.write(tmp_path / "over.exr", Picture(pixels, metadata={"header": header}))
    out, look = tmp_path / "a.jsonl", tmp_path / "look.png"
    report = told(["lights", "find", tmp_path / "over.exr", "-o", out, "--preview", look, "--json"], capsys)
    assert report["size"] == [60, 30]
    assert report["brightest"][0]["place_pixels"] == pytest.approx([21.5, 16.5])
    assert report["brightest"][1]["place_pixels"] == pytest.approx([-5, -2])
    lamps = [seen.lamp for seen in glare.read_lamps(out).sightings]
    assert lamps[0].box == (19, 14, 24, 19)
    given = picture.read(tmp_path / "over.exr")
    assert jobs.shown_lamps(given, jobs.placed_lamps(given, lamps)) == lamps
    assert jobs.placed_lamps(given, lamps)[0].place == pytest.approx((31.5, 21.5))
    # The lamp's own pixels are those that make glare.
    matte = jobs.GlareLights(out).matte(given)
    assert np.array_equal(np.argwhere(matte > 0), np.argwhere(pixels[..., 0] > 1))
    # The ring is drawn round the lamp's own pixels.
    drawn, plain = picture.encode_srgb(picture.read(look).pixels), picture.to_display(given)
    changed = np.abs(drawn - plain).max(axis=2) > 0.1
    rows, columns = np.nonzero(changed[:, 20:45])
    assert (columns + 20).mean() == pytest.approx(31.5, abs=4)
    assert rows.mean() == pytest.approx(21.5, abs=6)


def test_values_that_are_no_numbers_are_mended_on_request(tmp_path, capsys):
    pixels = frame_of(1).pixels.copy()
    pixels[50, 100] = np.nan
    made = OpenImageIO.ImageBuf(pixels)
    assert made.write(str(tmp_path / "nan.exr"))
    words = ["lights", "find", tmp_path / "nan.exr", "-o", tmp_path / "a.jsonl"]
    assert "--nan zero mends them" in refused(words, capsys)
    assert told([*words, "--nan", "zero", "--json"], capsys)["lights"] == 2


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["find", "{0}/shot.0001.exr", "-o", "{0}/a.exr"], "'suffix of the output' must be one of '.jsonl'"),
        (["find", "{0}/none.exr", "-o", "{0}/a.jsonl"], "none.exr"),
        (
            ["find", "{0}/shot.0001.exr", "-o", "{0}/a.jsonl", "--threshold", "x"],
            "must be auto or a",
        ),
        (["find", "{0}/shot.0001.exr", "-o", "{0}/a.jsonl", "--most", "0"], "'most' must be an integer >= 1"),
        (["track", "{0}/shot.exr", "--frames", "1-2", "-o", "{0}/a.jsonl"], "must have one run of #"),
        (["track", "{0}/shot.####.exr", "--frames", "11-12", "-o", "{0}/a.jsonl"], "shot.0011.exr"),
        (["track", "{0}/shot.####.exr", "--frames", "2-1", "-o", "{0}/a.jsonl"], "'frames' must be frames"),
    ],
)
def test_refusals(words, said, shot, capsys):
    assert said in refused(["lights", *(word.format(shot) for word in words)], capsys)
    assert not (shot / "a.jsonl").exists()


def test_missing_and_broken_frames_are_told_and_the_others_followed(shot, capsys):
    """The lights keep their numbers over the frames between."""
    (shot / "shot.0003.exr").unlink()
    (shot / "shot.0004.exr").write_bytes(b"half a pict")
    picture.write(shot / "shot.0011.exr", Picture(np.ones((60, 100, 3), dtype=np.float32)))
    words = ["lights", "track", shot / "shot.####.exr", "--frames", "1-11", "-o", shot / "a.jsonl"]
    assert run([str(word) for word in [*words, "--preview", shot / "look.####.png", "--json"]]) == 1
    said = capsys.readouterr()
    assert "frame 3 is missing: " in said.err
    assert "frame 4 is broken: " in said.err
    assert "frame 11 is broken: a frame must have the size and colour space of the first" in said.err
    assert json.loads(said.out)["lights"] == 2
    found = glare.read_lamps(shot / "a.jsonl")
    assert found.frames == (1, 2, 5, 6, 7, 8, 9, 10)
    assert [[seen.id for seen in found.at(n)] for n in (1, 4, 5, 8)] == [[1, 2], [], [2], [1, 2]]
    assert not (shot / "look.0003.png").exists()
    assert (shot / "look.0005.png").exists()
