"""Crews: what they deliver when workers die, and which workers they do not trust."""

import os
import signal
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from aureole import Picture, jobs, picture, refuse
from aureole.jobs import cluster, cluster_versions

FRAMES = 8


@dataclass(frozen=True)
class Shot:
    """A frame of a lamp that moves; `kills` says where its worker leaves word before it dies."""

    number: int
    folder: Path
    kills: Path | None = None
    always: bool = False

    @property
    def path(self) -> Path:
        return self.folder / f"frame.{self.number:04d}.exr"


def shoot(shot: Shot) -> int:
    """Make a frame with glare; a shot that kills takes its worker along, once or always."""
    if shot.kills is not None and (shot.always or not shot.kills.exists()):
        shot.kills.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if shot.number < 0:
        raise refuse.Refusal(f"frame {shot.number} is none.")
    pixels = np.full((48, 80, 3), 1e-3, dtype=np.float32)
    pixels[20, 5 + 8 * shot.number % 70] = (900, 600, 200)
    made = jobs.finish(jobs.run(jobs.GlareJob(Picture(pixels), jobs.Optics(f_number=16.0))))
    picture.write(shot.path, made.picture, pixel_type="float")
    return shot.number


def files(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """All frames as this process makes them."""
    folder = tmp_path_factory.mktemp("alone")
    told = list(jobs.deliver(shoot, [Shot(n, folder) for n in range(FRAMES)]))
    assert [delivery.outcome for delivery in told] == list(range(FRAMES))
    assert {delivery.worker for delivery in told} == {"here"}
    return files(folder)


def test_a_killed_worker_loses_no_frame_and_changes_no_bit(alone, tmp_path):
    folder, died = tmp_path / "out", tmp_path / "died"
    folder.mkdir()
    shots = [Shot(n, folder, died if n == 3 else None) for n in range(FRAMES)]
    told = list(jobs.deliver(shoot, [*shots, Shot(-1, folder)], jobs.Crew(workers=2), [folder]))
    assert died.exists()
    assert sorted(delivery.index for delivery in told) == list(range(FRAMES + 1))
    by_index = {delivery.index: delivery for delivery in told}
    assert [by_index[n].outcome for n in range(FRAMES)] == list(range(FRAMES))
    # What cannot be made says why, and stops none of the rest.
    assert by_index[FRAMES].outcome is None
    assert by_index[FRAMES].reason == "frame -1 is none."
    assert len({by_index[n].worker for n in range(FRAMES)}) >= 2
    assert files(folder) == alone


def test_a_frame_that_kills_all_its_workers_is_told_and_stops_no_other(alone, tmp_path, monkeypatch):
    folder = tmp_path / "out"
    folder.mkdir()
    monkeypatch.setattr(cluster, "TRIES", 1)
    shots = [replace(Shot(n, folder), kills=tmp_path / "died", always=n == 0) for n in (0, 1)]
    (tmp_path / "died").touch()
    told = {delivery.index: delivery for delivery in jobs.deliver(shoot, shots, jobs.Crew(workers=1))}
    assert told[0].reason == "the workers that made it died"
    assert told[1].outcome == 1
    assert files(folder) == {"frame.0001.exr": alone["frame.0001.exr"]}


def test_the_rest_is_made_when_one_cannot_be_here_too(tmp_path):
    told = list(jobs.deliver(shoot, [Shot(-1, tmp_path), Shot(1, tmp_path)]))
    assert [delivery.reason for delivery in told] == ["frame -1 is none.", None]
    assert told[1].outcome == 1


@pytest.mark.parametrize(
    ("crew", "line"),
    [
        (jobs.Crew(workers=0), "'workers' must be an integer >= 1, got 0."),
        (jobs.Crew(2, "tcp://a:1"), "'workers' are of this machine; it does not go with 'scheduler'."),
        (
            jobs.Crew(scheduler="farm:8786"),
            "'scheduler' must be an address such as tcp://host:8786, got 'farm:8786'.",
        ),
        (
            jobs.Crew(scheduler="tcp://farm"),
            "'scheduler' must be an address such as tcp://host:8786, got 'tcp://farm'.",
        ),
        (jobs.Crew(workers=1, patience=0), "'patience' must be a finite number > 0, got 0."),
    ],
)
def test_what_no_crew_is(crew, line):
    with pytest.raises(refuse.Refusal) as refused:
        crew.check()
    assert str(refused.value) == line


def test_without_dask_the_refusal_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(refuse.Refusal, match=r"'workers' needs Dask.*aureole\[cluster\]"):
        jobs.Crew(workers=2).check()
    with pytest.raises(refuse.Refusal, match="'scheduler' needs Dask"):
        jobs.Crew(scheduler="tcp://farm:8786").check()
    assert jobs.Crew().check().alone


def test_a_scheduler_that_does_not_answer_is_no_refusal_but_worth_another_try(monkeypatch, tmp_path):
    monkeypatch.setattr(cluster, "ANSWER", 0.5)
    with pytest.raises(ConnectionError, match=r"'tcp://127\.0\.0\.1:9' does not answer"):
        list(jobs.deliver(shoot, [Shot(0, tmp_path)], jobs.Crew(scheduler="tcp://127.0.0.1:9")))


def test_memory_is_shared_among_the_workers_of_one_machine():
    assert jobs.Crew(workers=4).memory(8_000) == 2_000
    assert jobs.Crew().memory(8_000) == jobs.Crew(scheduler="tcp://farm:1").memory(8_000) == 8_000
    free = picture.allowed_memory()
    assert jobs.Crew(workers=4).memory(None) == pytest.approx(free / 4, rel=0.2)
    assert jobs.Crew().memory(None) is None


class Workers:
    """Stands for a cluster whose workers tell what they are told to."""

    def __init__(self, told):
        self.told = told

    def run(self, function, *given, on_error):
        assert on_error == "return"
        return self.told


def test_workers_that_frames_cannot_be_trusted_to_are_refused(tmp_path):
    ours = cluster_versions.signature()
    cases = {
        "has Aureole 0.0.9, this machine 0.1.0": (replace(ours, version="0.0.9"), []),
        "has other files of Aureole 0.1.0 than this machine": (replace(ours, source="0" * 10), []),
        "does not see the folder '/shots'": (ours, ["/shots"]),
        "has no Aureole, or another one": ModuleNotFoundError("No module named 'aureole'"),
    }
    for line, told in cases.items():
        with pytest.raises(refuse.Refusal) as refused:
            cluster._check_workers(Workers({"tcp://a:1": (ours, []), "tcp://b:2": told}), [tmp_path], print)
        assert f"the worker tcp://b:2 {line}" in str(refused.value)


def test_other_packages_are_worth_a_note_and_a_dead_worker_none():
    ours = cluster_versions.signature()
    other = replace(ours, others={**ours.others, "numpy": "2.0.1"})
    notes: list[str] = []
    told = {"tcp://a:1": (ours, []), "tcp://b:2": (other, []), "tcp://c:3": OSError("gone")}
    cluster._check_workers(Workers(told), [], notes.append)
    assert notes == [
        f"1 of 3 workers have numpy 2.0.1, this machine {np.__version__}; last digits may differ"
    ]
    cluster._check_workers(Workers({}), [], notes.append)
    assert notes[1] == "the cluster has no worker yet; frames wait for one"


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


FARM = """
import sys
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address="127.0.0.1:0") as made:
        print(made.scheduler_address, flush=True)
        sys.stdin.read()
"""


def test_a_cluster_that_stands_elsewhere_makes_the_same_frames(alone, tmp_path):
    script, folder = tmp_path / "farm.py", tmp_path / "out"
    script.write_text(FARM)
    folder.mkdir()
    paths = os.pathsep.join([str(Path(__file__).parent), *sys.path])
    with subprocess.Popen(
        [sys.executable, str(script)],
        env={**os.environ, "PYTHONPATH": paths},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as farm:
        crew = jobs.Crew(scheduler=farm.stdout.readline().strip())
        told = list(jobs.deliver(shoot, [Shot(n, folder) for n in (1, 2)], crew, [folder]))
        with pytest.raises(refuse.Refusal, match="does not see the folder"):
            list(jobs.deliver(shoot, [Shot(1, folder)], crew, [tmp_path / "nowhere"]))
        farm.stdin.close()
        farm.wait()
    assert sorted(delivery.outcome for delivery in told) == [1, 2]
    assert all(delivery.worker.startswith("tcp://") for delivery in told)
    made = files(folder)
    assert made == {name: alone[name] for name in made}
    assert len(made) == 2
