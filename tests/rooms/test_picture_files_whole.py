"""A file appears whole or not at all, whatever happens meanwhile."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import picture_samples as samples
import pytest

from aureole import picture, refuse
from aureole.records import Picture


def test_the_temporary_lies_beside_hidden_with_the_suffix(tmp_path):
    with picture.whole_file(tmp_path / "job.json") as part:
        assert part.parent == tmp_path
        assert part.name.startswith(f".job.json.{os.getpid()}")
        assert part.name.endswith(".partial.json")
        part.write_text("{}")
        assert not (tmp_path / "job.json").exists()
    assert (tmp_path / "job.json").read_text() == "{}"
    assert [path.name for path in tmp_path.iterdir()] == ["job.json"]


def write_half(path, error):
    with picture.whole_file(path) as part:
        part.write_text("half of")
        raise error


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError, refuse.Refusal])
def test_on_an_error_nothing_changes(tmp_path, error):
    (tmp_path / "out.txt").write_text("before")
    with pytest.raises(error):
        write_half(tmp_path / "out.txt", error)
    assert (tmp_path / "out.txt").read_text() == "before"
    assert [path.name for path in tmp_path.iterdir()] == ["out.txt"]


def test_a_failing_disk_is_a_refusal(tmp_path):
    with (
        pytest.raises(refuse.Refusal, match=r"out\.txt' could not be written: No space left on device\.$"),
        picture.whole_file(tmp_path / "out.txt"),
    ):
        raise OSError(28, "No space left on device")
    assert not list(tmp_path.iterdir())


def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "real.txt").write_text("before")
    (tmp_path / "link.txt").symlink_to(tmp_path / "real.txt")
    with picture.whole_file(tmp_path / "link.txt") as part:
        part.write_text("after")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "real.txt").read_text() == "after"


def test_an_interrupted_write_leaves_nothing(tmp_path, monkeypatch):
    def interrupted(*args):
        raise KeyboardInterrupt

    monkeypatch.setattr("aureole.picture.whole_files._flush", interrupted)
    with pytest.raises(KeyboardInterrupt):
        picture.write(tmp_path / "out.exr", Picture(np.ones((8, 8, 3), np.float32)))
    assert not list(tmp_path.iterdir())


STRIKES, LONGEST = 12, 120
WRITER = """
import sys
from aureole import picture
read = picture.read(sys.argv[1])
print("ready", flush=True)
while True:
    picture.write(sys.argv[2], read)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
def test_kill_9_leaves_a_whole_file_or_none(tmp_path):
    pixels = np.random.default_rng(0).normal(size=(300, 400, 3)).astype(np.float16)
    source = samples.write_exr(tmp_path / "in.exr", samples.planes(pixels))
    out = tmp_path / "out.exr"
    found = {"whole": 0, "none": 0, "partial": 0}
    for turn in range(LONGEST):
        out.unlink(missing_ok=True)
        with subprocess.Popen(
            [sys.executable, "-c", WRITER, str(source), str(out)], stdout=subprocess.PIPE
        ) as process:
            assert process.stdout.readline() == b"ready\n"
            time.sleep(turn % STRIKES * 0.005)
            process.kill()
        if out.exists():
            np.testing.assert_array_equal(picture.read(out).pixels, pixels)
        found["whole" if out.exists() else "none"] += 1
        found["partial"] += bool(list(tmp_path.glob(".out.exr.*.partial.exr")))
        assert {path for path in tmp_path.iterdir() if path.name[0] != "."} <= {source, out}
        # The test is worth something only if it struck before, during and after.
        if turn + 1 >= STRIKES and min(found.values()) > 0:
            break
    assert min(found.values()) > 0, found


def test_what_killed_processes_left_is_removed_once_the_file_is_whole(tmp_path):
    out = tmp_path / "out.0001.exr"
    left = [tmp_path / f".out.0001.exr.{number}-0.partial.exr" for number in (4711, 4712)]
    others = [tmp_path / ".out.0002.exr.4711-0.partial.exr", tmp_path / ".out.0001.exr"]
    for path in (*left, *others):
        path.write_text("half of")
        os.utime(path, ns=(1, 1))
    assert picture.clear_partials(out) == 0
    out.write_text("whole")
    # One that is younger than the file may still be written by somebody.
    os.utime(left[1], ns=(2 * out.stat().st_mtime_ns,) * 2)
    assert picture.clear_partials(out) == 1
    assert {path.name for path in tmp_path.iterdir()} == {p.name for p in (out, left[1], *others)}
