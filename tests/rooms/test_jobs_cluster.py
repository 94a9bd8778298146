"""Crews: what they deliver when workers die, and which workers they do not trust."""

import contextlib
import dataclasses
import json
import os
import signal
import socket
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import psutil
import pytest

from aureole import Picture, jobs, picture, refuse
from aureole.cli.main import run
from aureole.jobs import cluster, cluster_frames, cluster_versions, cluster_worker

FRAMES = 8
FATAL = 4
LOOK = ["--kernel-size", "33", "--pixel-pitch", "20um"]
CAMERA = """
title = "A camera of this test"
source = "none"
focal_length_mm = 50
f_number = 16
"""


@dataclass(frozen=True, eq=False)
class Fatal(jobs.GlareMaker):
    """Makes glare, but for once takes its worker along in the middle of a frame, whose half it leaves."""

    target: Path = Path()
    died: Path = Path()

    def make(self, source, number):
        if number == FATAL and not self.died.exists():
            self.died.write_text(str(os.getpid()))
            with picture.whole_file(self.target) as part:
                part.write_bytes(b"half of")
                os.kill(os.getpid(), signal.SIGKILL)
        return super().make(source, number)


def shot(folder, count=FRAMES):
    """A lamp that passes over a dim wall."""
    for k in range(count):
        pixels = np.full((48, 80, 3), 0.01, dtype=np.float32)
        pixels[20, 5 + 8 * k % 70] = (900, 600, 200)
        picture.write(folder / f"shot.{k + 1:04d}.exr", Picture(pixels))
    return folder / "shot.####.exr"


def files(folder):
    """The bits of every frame, and all that is called like one, hidden ones as well."""
    paths = sorted(path for path in folder.iterdir() if path.name.lstrip(".").startswith("out."))
    return {path.name: picture.read(path).pixels.tobytes() for path in paths}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """All frames as this process makes them."""
    folder = tmp_path_factory.mktemp("alone")
    words = ["glare", str(shot(folder)), "-o", str(folder / "out.####.exr"), *LOOK, "--pixel-type", "float"]
    assert run(words) == 0
    return files(folder)


@pytest.fixture(scope="module")
def local():
    """The processes that `--workers 2` starts; they stay for all tests of this file."""
    with cluster._processes(2) as made, pytest.MonkeyPatch.context() as patch:
        patch.setattr(cluster, "_processes", lambda count: contextlib.nullcontext(made))
        yield made


def test_a_killed_worker_loses_no_frame_and_changes_no_bit(alone, local, tmp_path):
    maker = Fatal.of(jobs.Optics(), kernel_size=33, pixel_pitch=20e-6)
    maker = replace(maker, target=tmp_path / f"out.{FATAL:04d}.exr", died=tmp_path / "died")
    tasks = jobs.sequence_tasks(
        shot(tmp_path),
        tmp_path / "out.####.exr",
        None,
        maker,
        maker.words(),
        writing={"pixel_type": "float"},
    )
    result = jobs.finish(jobs.run(jobs.SequenceJob(tasks, jobs.spread_over(jobs.Crew(workers=2)))))
    assert not psutil.pid_exists(int(maker.died.read_text()))
    assert not result.failures()
    assert [outcome.number for outcome in result.outcomes] == list(range(1, FRAMES + 1))
    assert str(os.getpid()) not in {outcome.worker.rpartition(":")[2] for outcome in result.outcomes}
    # Bit for bit what one process makes, and the half that the dead one left is gone.
    assert files(tmp_path) == alone


def test_a_cluster_elsewhere_makes_the_same_frames_and_says_who(alone, local, tmp_path, monkeypatch, capsys):
    # Paths are as seen from here, where the workers do not stand.
    monkeypatch.chdir(tmp_path)
    shot(tmp_path)
    (tmp_path / "shot.0003.exr").write_bytes(b"no picture")
    words = ["glare", "shot.####.exr", "-o", "out.####.exr", *LOOK, "--pixel-type", "float", "--log", "log"]
    assert run([*words, "--frames", "1-9", "--scheduler", local.scheduler_address, "--json"]) == 1
    frames = {frame["number"]: frame for frame in json.loads(capsys.readouterr().out)["frames"]}
    there = {1, 2, 4, 5, 6, 7, 8}
    assert {number for number, frame in frames.items() if frame["state"] == "done"} == there
    assert (frames[3]["state"], frames[9]["state"]) == ("broken", "missing")
    assert frames[1]["file"] == "out.0001.exr"
    assert files(tmp_path) == {f"out.{n:04d}.exr": alone[f"out.{n:04d}.exr"] for n in there}
    # Lines come as frames do, each with the machine and the process that made it.
    lines = {line["number"]: line for line in map(json.loads, Path("log").read_text().splitlines())}
    assert lines == frames
    for number in there:
        host, _, pid = lines[number]["worker"].partition(":")
        assert host == socket.gethostname()
        assert int(pid) in {worker.pid for worker in local.workers.values()}


def work(number: int) -> tuple[int, list[int], int]:
    """Tell where a worker may run, and whether Ctrl-C reaches it; refuse what is below 0."""
    if number < 0:
        raise refuse.Refusal(f"frame {number} is none.")
    return (
        number,
        sorted(os.sched_getaffinity(0)),
        signal.getsignal(signal.SIGINT) == signal.SIG_IGN,
    )


def test_workers_share_the_cores_and_one_reason_stops_none_of_the_rest(local):
    told = list(jobs.deliver(work, [0, 1, -1, 2, 3], jobs.Crew(workers=2)))
    by_index = {delivery.index: delivery for delivery in told}
    assert sorted(by_index) == list(range(5))
    assert (by_index[2].outcome, by_index[2].reason, by_index[2].worker) == (None, "frame -1 is none.", "")
    cores = sorted(os.sched_getaffinity(0))
    shares = [cluster_worker.share(cores, k, 2) for k in (0, 1)]
    for number, index in enumerate((0, 1, 3, 4)):
        assert by_index[index].worker.startswith("tcp://127.0.0.1:")
        given, allowed, deaf = by_index[index].outcome
        assert given == number
        assert allowed in shares
        assert deaf


@pytest.mark.parametrize(("cores", "count"), [(1, 1), (2, 2), (16, 3), (5, 4), (2, 5)])
def test_shares_are_even_and_leave_no_core_idle(cores, count):
    shares = [cluster_worker.share(range(10, 10 + cores), k, count) for k in range(count)]
    assert {core for share in shares for core in share} == set(range(10, 10 + cores))
    sizes = {len(share) for share in shares}
    assert max(sizes) - min(sizes) <= 1
    if count <= cores:
        assert sum(map(len, shares)) == cores


def fatal(number: int) -> int:
    """Take the worker along where it is told 0."""
    if number == 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def test_a_frame_that_kills_all_its_workers_is_told_and_those_that_waited_there_are_made(local, monkeypatch):
    # At the first death all that the worker had is given up; each of it is tried once more, alone.
    monkeypatch.setattr(local.scheduler, "allowed_failures", 0)
    told = {
        delivery.index: delivery for delivery in jobs.deliver(fatal, [0, 1, 2, 3, 4], jobs.Crew(workers=2))
    }
    assert told[0].reason == "the workers that made it died"
    assert [told[number].outcome for number in (1, 2, 3, 4)] == [1, 2, 3, 4]


def test_the_rest_is_made_when_one_cannot_be_here_too():
    told = list(jobs.deliver(work, [-1, 1]))
    assert [(delivery.reason, delivery.worker) for delivery in told] == [
        ("frame -1 is none.", ""),
        (None, "here"),
    ]
    assert told[1].outcome[0] == 1


def strange(**changes):
    """What another installation would say of itself."""
    ours = cluster_versions.signature()
    return lambda: replace(ours, **changes)


def test_workers_that_frames_cannot_be_trusted_to_are_refused(local, tmp_path, monkeypatch):
    local.wait_for_workers(1)
    crew, ours = jobs.Crew(scheduler=local.scheduler_address), cluster_versions.signature()
    with pytest.raises(refuse.Refusal, match=rf"127\.0\.0\.1:\d+ does not see the folder '{tmp_path}/no'"):
        list(jobs.deliver(work, [1], crew, [tmp_path, tmp_path / "no"]))
    for changes, line in (
        ({"version": "9.0"}, f"has Aureole {ours.version}, this machine 9.0; install the same on both."),
        ({"source": "0" * 10}, f"has other files of Aureole {ours.version} than this machine; install"),
    ):
        monkeypatch.setattr(cluster, "signature", strange(**changes))
        with pytest.raises(refuse.Refusal, match="the worker tcp:") as refused:
            list(jobs.deliver(work, [1], crew))
        assert line in str(refused.value)
    # One that came after the others had been asked is found by its first task.
    monkeypatch.setattr(cluster, "_check_workers", lambda *given: None)
    (delivery,) = jobs.deliver(work, [1], crew)
    assert "has other files of Aureole" in delivery.reason


def test_other_packages_are_worth_a_note(local, monkeypatch):
    ours = cluster_versions.signature()
    other = strange(others={**ours.others, "numpy": "9.1"})
    local.wait_for_workers(1)
    monkeypatch.setattr(cluster, "signature", other)
    notes: list[str] = []
    told = list(jobs.deliver(work, [5], jobs.Crew(workers=2), say=notes.append))
    assert told[0].outcome[0] == 5
    assert [note.partition(" of ")[2].partition(" ")[2] for note in notes] == [
        f"workers have numpy {np.__version__}, this machine 9.1; last digits may differ"
    ]


@pytest.fixture
def empty_farm():
    """A scheduler of its own process, without workers."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    words = [
        "-m",
        "distributed.cli.dask_scheduler",
        "--host",
        "127.0.0.1",
        "--port",
        str(port),
        "--no-dashboard",
    ]
    with subprocess.Popen([sys.executable, *words], stderr=subprocess.DEVNULL) as farm:
        yield farm, jobs.Crew(scheduler=f"tcp://127.0.0.1:{port}", patience=0.2)
        farm.kill()


def test_a_cluster_without_workers_and_one_that_is_lost(empty_farm, monkeypatch):
    farm, crew = empty_farm
    monkeypatch.setattr(cluster, "LOOK", 0.1)
    notes: list[str] = []
    told = list(jobs.deliver(work, [1, 2], crew, say=notes.append))
    assert [delivery.reason for delivery in told] == ["the cluster had no worker for 0.2 s"] * 2
    assert notes == ["the cluster has no worker yet; frames wait for one"]
    monkeypatch.setattr(cluster, "ANSWER", 1.0)
    crew = replace(crew, patience=60.0)
    told = list(jobs.deliver(work, [1, 2], crew, say=lambda note: farm.kill()))
    assert [delivery.index for delivery in told] == [0, 1]
    assert {delivery.reason for delivery in told} == {
        "the scheduler was lost; run again to make what is left"
    }


def test_a_scheduler_that_does_not_answer_is_no_refusal_but_worth_another_try(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(cluster, "ANSWER", 0.5)
    words = ["glare", str(shot(tmp_path, 1)), "-o", str(tmp_path / "out.####.exr"), *LOOK]
    assert run([*words, "--scheduler", "tcp://127.0.0.1:9"]) == 1
    assert capsys.readouterr().err == "aureole: the scheduler 'tcp://127.0.0.1:9' does not answer.\n"


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--workers", "0"], "'workers' must be an integer >= 1, got 0."),
        (
            ["--workers", "2", "--scheduler", "tcp://a:1"],
            "'workers' are of this machine; it does not go with 'scheduler'.",
        ),
        (
            ["--scheduler", "farm:8786"],
            "'scheduler' must be an address such as tcp://host:8786, got 'farm:8786'.",
        ),
        (
            ["--scheduler", "tcp://farm"],
            "'scheduler' must be an address such as tcp://host:8786, got 'tcp://farm'.",
        ),
    ],
)
def test_what_no_crew_is(words, line, tmp_path, capsys):
    given = ["glare", str(tmp_path / "shot.####.exr"), "-o", str(tmp_path / "out.####.exr")]
    assert run([*given, *words]) == 2
    assert capsys.readouterr().err == f"aureole: {line}\n"


def test_one_picture_needs_no_crew(tmp_path, capsys):
    assert run(["glare", str(tmp_path / "a.exr"), "-o", str(tmp_path / "b.exr"), "--workers", "2"]) == 2
    assert "'workers' is for sequences" in capsys.readouterr().err


def test_without_dask_the_refusal_says_what_to_install(monkeypatch, tmp_path, capsys):
    monkeypatch.setitem(sys.modules, "distributed", None)
    given = ["glare", str(tmp_path / "shot.####.exr"), "-o", str(tmp_path / "out.####.exr")]
    assert run([*given, "--workers", "2"]) == 2
    assert capsys.readouterr().err == (
        "aureole: 'workers' needs Dask, which is not installed: python -m pip install 'aureole[cluster]'.\n"
    )
    assert run([*given, "--scheduler", "tcp://farm:8786"]) == 2
    assert "'scheduler' needs Dask" in capsys.readouterr().err
    assert jobs.Crew().check().alone


def test_memory_is_shared_among_the_workers_of_one_machine():
    assert jobs.Crew(workers=4).memory(8_000) == 2_000
    assert jobs.Crew().memory(8_000) == jobs.Crew(scheduler="tcp://farm:1").memory(8_000) == 8_000
    free = picture.allowed_memory()
    assert jobs.Crew(workers=4).memory(None) == pytest.approx(free / 4, rel=0.2)
    assert jobs.Crew().memory(None) is None


def test_paths_and_names_of_files_reach_workers_that_stand_elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("cameras").mkdir()
    Path("cameras/mine.toml").write_text(CAMERA)
    optics = jobs.Optics(preset="cameras/mine.toml", iris="none.toml")
    maker = jobs.GlareMaker.of(optics, Path("mattes/m.####.exr"))
    tasks = [
        jobs.FrameTask(n, Path(f"in/a.{n}.exr"), Path(f"out/b.{n}.exr"), maker, "words", {"nan": "zero"})
        for n in (1, 2)
    ]
    first, second = cluster_frames.anywhere(tasks)
    assert (first.source, second.target) == (tmp_path / "in/a.1.exr", tmp_path / "out/b.2.exr")
    assert first.maker is second.maker
    assert first.maker.job.optics.preset == str(tmp_path / "cameras/mine.toml")
    assert first.maker.job.optics.iris == "none.toml"
    assert first.maker.sources.matte == tmp_path / "mattes/m.####.exr"
    assert (first.reading, first.description) == ({"nan": "zero"}, "words")
    names = [folder.relative_to(tmp_path).name for folder in cluster_frames.folders([first, second])]
    assert names == ["cameras", "in", "mattes", "out"]
    given = {f.name: getattr(optics, f.name) for f in dataclasses.fields(optics)}
    changed = {f.name: getattr(first.maker.job.optics, f.name) for f in dataclasses.fields(optics)}
    assert [name for name in given if given[name] != changed[name]] == ["preset"]


def test_the_signature_is_of_the_sources_and_of_nothing_that_a_machine_makes_of_them(tmp_path):
    for name, text in {"a.py": b"x = 1\n", "b/c.toml": b"y = 2\n"}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(text)
    first = cluster_versions.source_digest(tmp_path)
    (tmp_path / "a.nbi").write_bytes(b"compiled")
    (tmp_path / "a.py").write_bytes(b"x = 1\r\n")
    assert cluster_versions.source_digest(tmp_path) == first
    (tmp_path / "a.py").write_bytes(b"x = 2\n")
    assert cluster_versions.source_digest(tmp_path) != first
    ours = cluster_versions.signature()
    assert cluster_versions.differences(ours, ours) == ([], [])
    assert ours.others["numpy"] == np.__version__


def test_signals_end_the_workers_too_and_leave_nothing_half_written(tmp_path, request):
    # More frames than can be made before the signal comes.
    shot(tmp_path, 1)
    for number in range(2, 2000):
        os.link(tmp_path / "shot.0001.exr", tmp_path / f"shot.{number:04d}.exr")
    words = [sys.executable, "-m", "aureole.cli", "glare", "shot.####.exr", *LOOK, "--workers", "1"]
    runs = {}
    for number in (signal.SIGTERM, signal.SIGINT):
        name = number.name
        runs[number] = subprocess.Popen(
            [*words, "-o", f"{name}.####.exr", "--log", f"{name}.log"],
            cwd=tmp_path,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        request.addfinalizer(runs[number].kill)
    workers = {}
    # Whichever of the two has made its first frames is ended at once, while the other may be starting yet.
    while len(workers) < len(runs):
        for number, started in runs.items():
            log = tmp_path / f"{number.name}.log"
            if number in workers or not log.exists() or log.read_text().count("\n") < 2:
                continue
            workers[number] = psutil.Process(started.pid).children(recursive=True)
            # As a terminal does: Ctrl-C reaches all of the group. A farm ends who it started.
            (os.killpg if number == signal.SIGINT else os.kill)(started.pid, number)
        assert all(number in workers or runs[number].poll() is None for number in runs)
        time.sleep(0.02)
    for number, line in (
        (signal.SIGTERM, "aureole: terminated; nothing half-written is left.\n"),
        (signal.SIGINT, "aureole: interrupted; nothing half-written is left.\n"),
    ):
        _, said = runs[number].communicate()
        assert (runs[number].returncode, said) == (128 + number, line)
        assert workers[number]
        _, alive = psutil.wait_procs(workers[number], timeout=10)
        assert not alive
    assert not list(tmp_path.glob(".*partial*"))
    for path in tmp_path.glob("SIG*.exr"):
        assert picture.read(path).pixels.shape == (48, 80, 3)
