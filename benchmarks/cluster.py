"""Frames by several processes: how much faster, and a cluster of other programs, one of whose workers dies.

    python benchmarks/cluster.py speed --workers 2 --rounds 3
    python benchmarks/cluster.py farm

`speed` makes the same frames in this process and by workers of this machine, in turn, with and without the
start of the workers. `farm` starts `dask scheduler` and `dask worker` as a farm does, ends one worker with
SIGKILL when a few frames are there, and compares every frame with those of one process, bit by bit. Both work
in a folder that is removed afterwards.
"""

import argparse
import os
import platform
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import numpy as np
import psutil

import aureole
from aureole import jobs, picture

SEED = 1
COMMAND = [sys.executable, "-m", "aureole.cli", "glare"]


def write_shot(folder: Path, count: int, shape: tuple[int, int]) -> None:
    """Write the bundled scene, lit a little otherwise in each frame."""
    scene = picture.night_scene(shape, SEED)
    for number in range(1, count + 1):
        lit = aureole.Picture(scene.pixels * np.float32(1 + 0.01 * number), scene.colour_space)
        picture.write(folder / f"shot.{number:04d}.exr", lit, pixel_type="half")


def made(folder: Path, name: str, count: int, crew: jobs.Crew, kernel_size: int) -> tuple[float, float]:
    """Make all frames; return the seconds from the start, and from the first frame to the last."""
    maker = jobs.GlareMaker.of(jobs.Optics(), kernel_size=kernel_size)
    names = folder / "shot.####.exr", folder / f"{name}.####.exr"
    how = {"writing": {"pixel_type": "float"}, "overwrite": True}
    tasks = jobs.sequence_tasks(*names, range(1, count + 1), maker, maker.words(), **how)
    start, came = time.perf_counter(), []
    job = jobs.SequenceJob(tasks) if crew.alone else jobs.SequenceJob(tasks, jobs.spread_over(crew))
    for stage in jobs.run(job):
        if isinstance(stage.result, jobs.FrameOutcome):
            assert stage.result.state == "done", stage.result.reason
            came.append(time.perf_counter() - start)
    return time.perf_counter() - start, came[-1] - came[0]


def speed(folder: Path, asked: argparse.Namespace, shape: tuple[int, int]) -> None:
    """Print the time of frames by one process and by several."""
    write_shot(folder, asked.frames, shape)
    crews = {"one process": jobs.Crew(), f"{asked.workers} workers": jobs.Crew(workers=asked.workers)}
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in crews}
    made(folder, "first", 1, jobs.Crew(), asked.kernel_size)
    for _ in range(asked.rounds):
        for name, crew in crews.items():
            times[name].append(made(folder, name[:3], asked.frames, crew, asked.kernel_size))
    for name, found in times.items():
        whole, frames = (median(column) for column in zip(*found, strict=True))
        print(f"{name:12s}  whole run {whole:7.2f} s   first frame to last {frames:7.2f} s")
    one, many = times.values()
    for what, k in (("whole run", 0), ("first frame to last", 1)):
        ratios = [a[k] / b[k] for a, b in zip(one, many, strict=True)]
        print(f"{what}: {median(ratios):.2f} times as fast, from {min(ratios):.2f} to {max(ratios):.2f}")
    print(f"same bits: {different(folder, asked.frames, 'one', str(asked.workers) + ' w') == 0}")


def different(folder: Path, count: int, first: str, second: str) -> int:
    """Return how many frames of two runs are not the same."""
    names = [f"{number:04d}.exr" for number in range(1, count + 1)]
    read = [
        [picture.read(folder / f"{run}.{name}").pixels.tobytes() for name in names] for run in (first, second)
    ]
    return sum(a != b for a, b in zip(*read, strict=True))


def farm(folder: Path, asked: argparse.Namespace, shape: tuple[int, int]) -> None:
    """Kill a worker of a cluster in the middle of a run, and say what became of the frames."""
    write_shot(folder, asked.frames, shape)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    dask, port = [sys.executable, "-m"], address.rpartition(":")[2]
    scheduler = [*dask, "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", port]
    worker = [*dask, "distributed.cli.dask_worker", address, "--nthreads", "1", "--nworkers", "2"]
    started = [subprocess.Popen(words, cwd="/", **quiet) for words in (scheduler, worker)]
    files = [str(folder / "shot.####.exr"), "-o", str(folder / "farm.####.exr")]
    size = ["--kernel-size", str(asked.kernel_size)]
    try:
        running = subprocess.Popen(
            [*COMMAND, *files, *size, "--scheduler", address, "--log", str(folder / "log")]
        )
        while not (folder / f"farm.{max(1, asked.frames // 3):04d}.exr").exists():
            assert running.poll() is None
            time.sleep(0.01)
        children = psutil.Process(started[1].pid).children(recursive=True)
        victim = next(child for child in children if "spawn_main" in " ".join(child.cmdline()))
        victim.send_signal(signal.SIGKILL)
        code = running.wait()
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait()
    made(folder, "one", asked.frames, jobs.Crew(), asked.kernel_size)
    there = sum((folder / f"farm.{number:04d}.exr").exists() for number in range(1, asked.frames + 1))
    print(f"exit code                      {code}")
    print(f"frames there                   {there} of {asked.frames}")
    print(f"not as one process makes them  {different(folder, asked.frames, 'one', 'farm')}")
    print(f"halves left                    {len(list(folder.glob('.*.partial*')))}")


def main() -> None:
    """Run what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=("speed", "farm"))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--kernel-size", type=int, default=513)
    asked = parser.parse_args()
    columns, rows = (int(part) for part in asked.size.split("x"))
    machine = f"{platform.system()} {platform.release()}, {os.cpu_count()} cores"
    print(f"{machine}, NumPy {np.__version__}, seed {SEED}")
    with tempfile.TemporaryDirectory() as name:
        {"speed": speed, "farm": farm}[asked.what](Path(name), asked, (rows, columns))


if __name__ == "__main__":
    main()
