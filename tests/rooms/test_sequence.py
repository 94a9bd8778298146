"""Sequences of pictures: each frame alone, finished ones kept, whatever befalls the others."""

import dataclasses
import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from aureole import Picture, Refusal, jobs, picture
from aureole.cli.main import run
from aureole.jobs import frame_files, glare_sequence

SHAPE = (24, 36)
LOOK = ["--kernel-size", "15", "--pixel-pitch", "20um"]
COUNT = 20


def shot(folder, count=5, first=1001):
    """A lamp that passes over a dim wall."""
    for k in range(count):
        pixels = np.full((*SHAPE, 3), 0.01, dtype=np.float32)
        pixels[10, 4 + k] = (300, 200, 100)
        picture.write(folder / f"shot.{first + k}.exr", Picture(pixels))
    return folder / "shot.####.exr"


def words(folder, *more):
    # Neither an eye nor a kernel from a file has a camera's pixels.
    look = [] if {"--eye", "--kernel"} & set(more) else LOOK
    return [
        "glare",
        str(folder / "shot.####.exr"),
        "-o",
        str(folder / "out.####.exr"),
        *look,
        *map(str, more),
    ]


def told(words, capsys, code=0):
    assert run([*words, "--json"]) == code
    said = capsys.readouterr()
    return json.loads(said.out), said.err


def refused(words, capsys):
    assert run(words) == 2
    said = capsys.readouterr()
    assert said.out == ""
    return said.err.strip()


def states(report):
    return {frame["number"]: frame["state"] for frame in report["frames"]}


def alone(folder, number):
    """The frame as the command for one picture makes it."""
    single = folder / "single.exr"
    assert run(["glare", str(folder / f"shot.{number}.exr"), "-o", str(single), *LOOK, "--json"]) == 0
    return picture.read(single).pixels


def test_each_frame_is_what_the_command_makes_of_its_picture_alone(tmp_path, capsys):
    shot(tmp_path)
    report, _ = told(words(tmp_path, "--frames", "1001-1005x2"), capsys)
    assert states(report) == {1001: "done", 1003: "done", 1005: "done"}
    assert not (tmp_path / "out.1002.exr").exists()
    for number in (1001, 1003, 1005):
        made = picture.read(tmp_path / f"out.{number}.exr").pixels
        np.testing.assert_array_equal(made, alone(tmp_path, number))
        capsys.readouterr()


def test_without_a_list_all_frames_that_are_there_are_made(tmp_path, capsys):
    shot(tmp_path, 3)
    # Neither another sequence's frame nor a half-written one is a frame.
    (tmp_path / "shot.10010.1.exr").write_bytes(b"")
    (tmp_path / ".shot.1009.exr.7-0.partial.exr").write_bytes(b"")
    report, _ = told(words(tmp_path), capsys)
    assert list(states(report)) == [1001, 1002, 1003]
    assert report["frames_done"] == 3
    assert report["seconds_per_frame"] > 0


def test_missing_and_broken_frames_are_told_and_stop_nothing(tmp_path, capsys):
    shot(tmp_path)
    (tmp_path / "shot.1002.exr").unlink()
    whole = (tmp_path / "shot.1004.exr").read_bytes()
    (tmp_path / "shot.1004.exr").write_bytes(whole[: len(whole) // 2])
    log = tmp_path / "shot.log"
    report, said = told(words(tmp_path, "--frames", "1001-1005", "--log", log), capsys, code=1)
    expected = {1001: "done", 1002: "missing", 1003: "done", 1004: "broken", 1005: "done"}
    assert states(report) == expected
    assert (report["frames_done"], report["frames_missing"], report["frames_broken"]) == (3, 1, 1)
    assert "frame 1002 is missing: there is no" in said
    assert "frame 1004 is broken" in said
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    assert {line["number"]: line["state"] for line in lines} == expected
    assert all("reason" in line for line in lines if line["state"] in ("missing", "broken"))
    assert not (tmp_path / "out.1004.exr").exists()
    # Once they are mended, a second run makes these two alone, and its lines follow in the log.
    pixels = picture.read(tmp_path / "shot.1001.exr")
    for number in (1002, 1004):
        picture.write(tmp_path / f"shot.{number}.exr", pixels)
    report, _ = told(words(tmp_path, "--frames", "1001-1005", "--log", log), capsys)
    assert states(report) == expected | {1001: "kept", 1002: "done", 1003: "kept", 1004: "done", 1005: "kept"}
    assert len(log.read_text().splitlines()) == 10


def test_what_is_kept_and_what_is_made_again(tmp_path, capsys):
    shot(tmp_path)
    told(words(tmp_path), capsys)
    out = [tmp_path / f"out.{number}.exr" for number in range(1001, 1006)]
    before = [path.stat().st_mtime_ns for path in out]
    # One of ours that lost its end on the disk, and one whose source was rendered again.
    out[1].write_bytes(out[1].read_bytes()[:-200])
    new = out[3].stat().st_mtime_ns + 10**9
    os.utime(tmp_path / "shot.1004.exr", ns=(new, new))
    report, _ = told(words(tmp_path), capsys)
    assert list(states(report).values()) == ["kept", "done", "kept", "done", "kept"]
    after = [path.stat().st_mtime_ns for path in out]
    assert [a == b for a, b in zip(before, after, strict=True)] == [True, False, True, False, True]
    np.testing.assert_array_equal(picture.read(out[1]).pixels, alone(tmp_path, 1002))
    capsys.readouterr()
    report, _ = told(words(tmp_path, "--frames", "1001", "--overwrite"), capsys)
    assert report["frames_done"] == 1


def test_radiance_pictures_say_of_which_job_they_are(tmp_path, capsys):
    shot(tmp_path, 2)
    out = [*words(tmp_path)[:3], str(tmp_path / "out.####.hdr"), *LOOK]
    told(out, capsys)
    report, _ = told(out, capsys)
    assert report["frames_kept"] == 2
    # The words take no pixel away.
    single = tmp_path / "single.hdr"
    assert run(["glare", str(tmp_path / "shot.1001.exr"), "-o", str(single), *LOOK]) == 0
    made = picture.read(tmp_path / "out.1001.hdr").pixels
    np.testing.assert_array_equal(made, picture.read(single).pixels)
    capsys.readouterr()
    assert "is no frame of this job" in refused([*out, "--f-number", "8"], capsys)


def test_halves_that_a_killed_run_left_are_removed_with_their_frame(tmp_path, capsys):
    shot(tmp_path, 2)
    half = tmp_path / ".out.1001.exr.4711-0.partial.exr"
    half.write_bytes(b"half")
    told(words(tmp_path), capsys)
    assert not half.exists()
    assert sorted(path.name for path in tmp_path.glob("out*")) == ["out.1001.exr", "out.1002.exr"]


def test_frames_do_not_depend_on_the_number_of_threads():
    """One processor or all that there are give the same bits."""
    pixels = np.random.default_rng(1).random((*SHAPE, 3), dtype=np.float32)
    pixels[5, 7] = 1000
    source, made, processors = Picture(pixels), [], os.sched_getaffinity(0)
    try:
        for allowed in (set(list(processors)[:1]), processors):
            os.sched_setaffinity(0, allowed)
            # Another side of the kernel in between, so that it is made anew.
            for side in (13, 15):
                maker = jobs.GlareMaker.of(jobs.Optics(), kernel_size=side, pixel_pitch=20e-6)
                frame = maker.make(source, 1)[0].pixels
            made.append(frame)
    finally:
        os.sched_setaffinity(0, processors)
    np.testing.assert_array_equal(made[0], made[1])
    for threads in (1, 2, 64):
        kernel = np.full((15, 15, 3), 1 / 225, dtype=np.float32)
        spread = picture.Convolver(kernel, SHAPE, "double", threads)(pixels)
        np.testing.assert_array_equal(spread, picture.Convolver(kernel, SHAPE, "double", 3)(pixels))


def test_frames_of_another_job_are_not_replaced(tmp_path, capsys):
    shot(tmp_path, 2)
    told(words(tmp_path), capsys)
    stamp = (tmp_path / "out.1002.exr").stat().st_mtime_ns
    assert "is no frame of this job" in refused(words(tmp_path, "--f-number", "8"), capsys)
    assert (tmp_path / "out.1002.exr").stat().st_mtime_ns == stamp
    report, _ = told(words(tmp_path, "--f-number", "8", "--overwrite"), capsys)
    assert report["frames_done"] == 2


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--animate", "2s"], "'animate' does not go with a sequence"),
        (["--preview", "a.png"], "'preview' is for one picture"),
        (["--fps", "12"], "'fps' needs 'video', an eye"),
        (["--first-frame", "1"], "'first-frame' needs an eye"),
        (["--video", "a.avi"], "'video' must end in .mp4"),
        (["--frames", "5-1"], "'frames' must be frames such as"),
        (["--mode", "soften"], "'mode' must be one of"),
        (["--illuminant", "moon"], "illuminant"),
        (["--blades", "2"], "'blades' must be"),
        (["--eye", "--photosafe"], "'photosafe' does not go with a sequence"),
        (["--eye", "--f-number", "8"], "'f-number' is of cameras"),
        (["--kernel", "k.exr", "--blades", "5"], "does not go with --kernel"),
        (["--kernel", "k.exr"], "k.exr"),
    ],
)
def test_what_no_frame_could_be_made_with_is_refused_before_work(tmp_path, capsys, more, said):
    shot(tmp_path, 1)
    assert said in refused(words(tmp_path, *more), capsys)
    assert not (tmp_path / "out.1001.exr").exists()


def test_names_that_do_not_fit_are_refused(tmp_path, capsys):
    source = str(shot(tmp_path, 1))
    single = str(tmp_path / "shot.1001.exr")
    assert "must have ####" in refused(["glare", source, "-o", str(tmp_path / "out.exr")], capsys)
    assert "would replace the frames" in refused(["glare", source, "-o", source], capsys)
    absent = str(tmp_path / "other.####.exr")
    assert "no frame of" in refused(["glare", absent, "-o", str(tmp_path / "o.####.exr")], capsys)
    log = ["--log", str(tmp_path / "a.log")]
    assert "is for sequences" in refused(["glare", single, "-o", str(tmp_path / "o.exr"), *log], capsys)


def test_a_kernel_is_made_once_while_nothing_about_it_changes():
    dark = Picture(np.zeros((*SHAPE, 3), dtype=np.float32))
    job = jobs.GlareJob(dark, kernel_size=15, pixel_pitch=20e-6)
    brighter = dataclasses.replace(job, picture=Picture(dark.pixels + 1), gain=1.0)
    first = glare_sequence._kernel(job)
    assert glare_sequence._kernel(brighter) is first
    wider = dataclasses.replace(job, optics=jobs.Optics(f_number=8))
    assert glare_sequence._kernel(wider) is not first
    larger = dataclasses.replace(job, picture=Picture(np.zeros((30, 36, 3), dtype=np.float32)))
    assert glare_sequence._kernel(larger) is not glare_sequence._kernel(wider)


def test_a_job_is_known_by_what_its_files_hold(tmp_path):
    """An aperture that is drawn anew under the same name is another job."""
    mask, name = np.zeros((16, 16, 3), dtype=np.float32), tmp_path / "hole.exr"
    said = []
    for half in (4, 6):
        mask[8 - half : 8 + half, 8 - half : 8 + half] = 1
        picture.write(name, Picture(mask))
        opening = jobs.Opening(picture=str(name))
        said.append(jobs.GlareMaker.of(jobs.Optics(opening)).words())
    assert said[0] != said[1]
    assert said[1] == jobs.GlareMaker.of(jobs.Optics(opening)).words()


def test_mattes_may_be_numbered_too(tmp_path, capsys):
    shot(tmp_path, 2)
    for number, value in ((1001, 0.0), (1002, 1.0)):
        picture.write(tmp_path / f"m.{number}.exr", Picture(np.full((*SHAPE, 3), value, dtype=np.float32)))
    told(words(tmp_path, "--matte", tmp_path / "m.####.exr"), capsys)
    changed = [
        np.abs(
            picture.read(tmp_path / f"out.{n}.exr").pixels - picture.read(tmp_path / f"shot.{n}.exr").pixels
        )
        for n in (1001, 1002)
    ]
    assert changed[0].max() == 0
    assert changed[1].max() > 1


def test_a_name_with_two_places_for_the_number_is_refused(tmp_path):
    with pytest.raises(Refusal, match="one run of #"):
        frame_files.found(tmp_path / "a#.b#.exr")


def test_a_run_killed_in_the_middle_goes_on_where_it_was(tmp_path, capsys):
    shot(tmp_path, COUNT)
    command = [sys.executable, "-m", "aureole.cli", *words(tmp_path)]
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    out = [tmp_path / f"out.{1001 + k}.exr" for k in range(COUNT)]
    while not out[3].exists() and running.poll() is None:
        time.sleep(0.002)
    running.send_signal(signal.SIGKILL)
    assert running.wait() == -signal.SIGKILL
    stamps = {path: path.stat().st_mtime_ns for path in out if path.exists()}
    assert 4 <= len(stamps) < COUNT
    report, _ = told(words(tmp_path), capsys)
    assert (report["frames_kept"], report["frames_done"]) == (len(stamps), COUNT - len(stamps))
    assert all(path.stat().st_mtime_ns == stamp for path, stamp in stamps.items())
    for k in (0, 3, len(stamps), COUNT - 1):
        np.testing.assert_array_equal(picture.read(out[k]).pixels, alone(tmp_path, 1001 + k))


def test_memory_does_not_grow_with_the_frames(tmp_path):
    """A child's own memory after each of 60 frames, so that nothing else counts."""
    script = (
        "import sys, psutil\n"
        "from pathlib import Path\n"
        "from aureole import jobs\n"
        "folder, numbers = Path(sys.argv[1]), range(1, 61)\n"
        "maker = jobs.GlareMaker.of(jobs.Optics(), kernel_size=63)\n"
        "names = folder / 'in.##.exr', folder / 'out.##.exr'\n"
        "tasks = jobs.sequence_tasks(*names, numbers, maker, 'test')\n"
        "for stage in jobs.run(jobs.SequenceJob(tasks)):\n"
        "    print(psutil.Process().memory_info().rss)\n"
    )
    pixels = np.full((180, 320, 3), 0.1, dtype=np.float32)
    pixels[90, 100:110] = 50
    picture.write(tmp_path / "in.01.exr", Picture(pixels))
    for number in range(2, 61):
        os.link(tmp_path / "in.01.exr", tmp_path / f"in.{number:02d}.exr")
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    sizes = [int(line) for line in done.stdout.split()]
    assert len(list(tmp_path.glob("out.*.exr"))) == 60
    assert sizes[60] == pytest.approx(sizes[20], rel=0.05)
