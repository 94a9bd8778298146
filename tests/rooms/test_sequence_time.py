"""Sequences in which something changes with time: dirt that drifts, an eye that looks; each frame alone."""

import json

import numpy as np
import pytest

from aureole import Picture, jobs, picture
from aureole.cli.main import run

SHAPE = (20, 30)
DIRT = ["--kernel-size", "15", "--pixel-pitch", "20um", "--dust", "30%", "--dirt-drift", "2mm,0mm"]
EYE = ["--eye", "--grid", "128", "--kernel-size", "15", "--no-blink"]


def shot(folder, numbers):
    """A lamp that stands still before a dim wall."""
    pixels = np.full((*SHAPE, 3), 0.01, dtype=np.float32)
    pixels[10, 12] = (300, 200, 100)
    for number in numbers:
        picture.write(folder / f"shot.{number:04d}.exr", Picture(pixels))
    return str(folder / "shot.####.exr")


def told(words, capsys):
    assert run([*map(str, words), "--json"]) == 0
    said = capsys.readouterr()
    return json.loads(said.out), said.err


def pixels_of(path):
    return picture.read(path).pixels


def test_dirt_drifts_with_the_frames_and_each_can_be_made_alone(tmp_path, capsys):
    source, many, single = shot(tmp_path, (24, 36)), tmp_path / "many.####.exr", tmp_path / "single.exr"
    _, said = told(["glare", source, "-o", many, *DIRT, "--fps", "24"], capsys)
    # The pace is the frame's number, and the first one is told where nobody chose it.
    assert "frame 24 is at 1 s; --first-frame 24 makes that 0 s" in said
    made = [pixels_of(tmp_path / f"many.00{number}.exr") for number in (24, 36)]
    assert not np.array_equal(*made)
    # It is the single picture's glare with dirt at that time.
    told(["glare", tmp_path / "shot.0036.exr", "-o", single, *DIRT, "--dirt-time", "1.5s"], capsys)
    np.testing.assert_array_equal(made[1], pixels_of(single))


def test_another_pace_or_first_frame_is_another_job_where_something_moves():
    moving = jobs.Optics(jobs.Opening(dust=0.3, dirt_drift=(1e-3, 0.0)))
    paces = (jobs.Pace(24, 0), jobs.Pace(25, 0), jobs.Pace(24, 1))
    assert len({jobs.GlareMaker.of(moving, pace=pace).words() for pace in paces}) == 3
    still = jobs.Optics(jobs.Opening(dust=0.3))
    assert len({jobs.GlareMaker.of(still, pace=pace).words() for pace in paces}) == 1


def test_a_frames_time_is_its_number_less_the_firsts():
    assert jobs.Pace(24, 1001).time(1001) == 0
    assert jobs.Pace(25, 1001).time(1026) == 1.0


def test_an_eye_sees_each_frame_at_its_time(tmp_path, capsys):
    source, out = shot(tmp_path, (1001, 1013)), tmp_path / "seen.####.exr"
    words = ["glare", source, "-o", out, *EYE, "--fps", "24", "--first-frame", "1001"]
    report, _ = told(words, capsys)
    times = {frame["number"]: frame["time_s"] for frame in report["frames"]}
    assert times == {1001: 0.0, 1013: 0.5}
    seen = {number: pixels_of(tmp_path / f"seen.{number}.exr") for number in times}
    assert not np.array_equal(seen[1001], seen[1013])
    single = tmp_path / "single.exr"
    told(["glare", tmp_path / "shot.1013.exr", "-o", single, *EYE, "--time", "0.5"], capsys)
    np.testing.assert_allclose(seen[1013], pixels_of(single), rtol=1e-6)
    # A second run keeps them; an eye that is older is another job.
    report, _ = told(words, capsys)
    assert report["frames_kept"] == 2
    assert run([*map(str, words), "--age", "80"]) == 2
    assert "is no frame of this job" in capsys.readouterr().err
    assert run([*map(str, words[:-1]), "1002", "--overwrite"]) == 2
    assert "frame 1001 is before 'first-frame'" in capsys.readouterr().err


def test_an_eye_that_blinks_gives_a_dark_frame(tmp_path):
    """What lids let through is the frame's light."""
    viewer = jobs.Viewer()
    times = np.arange(0, 20, 1 / 24)
    lids = np.array([state.lid_opening for state in viewer.states(times)])
    number = int(np.argmin(lids))
    dark = Picture(np.ones((*SHAPE, 3), dtype=np.float32))
    job = jobs.EyeGlareJob(dark, jobs.EyeJob(viewer, grid=128), kernel_size=15)
    made, report = jobs.EyeGlareMaker(job, pace=jobs.Pace(24, 0)).make(dark, number)
    assert report["lid_opening"] == pytest.approx(lids[number], abs=1e-6)
    assert made.pixels[..., :3].mean() == pytest.approx(report["light_let_through"], abs=0.05)


def test_a_kernel_that_was_written_serves_a_sequence(tmp_path, capsys):
    source = shot(tmp_path, (1, 2))
    look, kernel = ["--kernel-size", "15", "--pixel-pitch", "20um"], tmp_path / "psf.exr"
    told(["glare", tmp_path / "shot.0001.exr", "-o", tmp_path / "a.exr", *look, "--psf", kernel], capsys)
    report, _ = told(["glare", source, "-o", tmp_path / "b.####.exr", "--kernel", kernel], capsys)
    assert report["frames_done"] == 2
    assert report["frames"][0]["kernel_size"] == [15, 15]
    np.testing.assert_array_equal(pixels_of(tmp_path / "b.0002.exr"), pixels_of(tmp_path / "a.exr"))
    # A kernel with more than all energy, and one that is drawn anew, are not the same job.
    picture.write(kernel, Picture(np.full((3, 3, 3), 1.0, dtype=np.float32)))
    assert run(["glare", source, "-o", str(tmp_path / "b.####.exr"), "--kernel", str(kernel)]) == 2
    assert "is no frame of this job" in capsys.readouterr().err
    assert run(["glare", source, "-o", str(tmp_path / "c.####.exr"), "--kernel", str(kernel)]) == 1
    assert "must hold at most all energy" in capsys.readouterr().err


def test_what_frames_are_made_of_is_in_their_words(tmp_path, capsys):
    """A matte that is painted anew, or another pixel type, is another job."""
    source, matte = shot(tmp_path, (1, 2)), tmp_path / "matte.exr"
    kernel = tmp_path / "k.exr"
    picture.write(kernel, Picture(np.full((3, 3, 3), 0.1, dtype=np.float32)))
    picture.write(matte, Picture(np.ones((*SHAPE, 3), dtype=np.float32)))
    words = ["glare", source, "-o", str(tmp_path / "out.####.exr"), "--kernel", str(kernel)]
    assert run([*words, "--matte", str(matte)]) == 0
    assert run([*words, "--matte", str(matte), "--pixel-type", "half"]) == 2
    picture.write(matte, Picture(np.zeros((*SHAPE, 3), dtype=np.float32)))
    assert run([*words, "--matte", str(matte)]) == 2
    assert capsys.readouterr().err.count("is no frame of this job") == 2
    for number in (1, 2):
        picture.write(tmp_path / f"m.{number}.exr", Picture(np.ones((*SHAPE, 3), dtype=np.float32)))
    own = [*words, "--matte", str(tmp_path / "m.#.exr")]
    told([*own, "--overwrite"], capsys)
    picture.write(tmp_path / "m.2.exr", Picture(np.zeros((*SHAPE, 3), dtype=np.float32)))
    report, _ = told(own, capsys)
    assert [frame["state"] for frame in report["frames"]] == ["kept", "done"]
