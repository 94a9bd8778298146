"""Sequences of pictures at full size: one killed in the middle, and memory over many frames.

    python benchmarks/sequences.py kill --frames 20
    python benchmarks/sequences.py memory --frames 200

`kill` starts `aureole glare` on numbered pictures, ends it with SIGKILL when a few frames are there, starts
it again, reads every frame, and compares four with the same command's on its picture alone. `memory` makes
frames one by one and prints the resident memory as it goes. Both work in a folder that is removed afterwards.
"""

import argparse
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import psutil

import aureole
from aureole import jobs, picture

SEED = 1
COMMAND = [sys.executable, "-m", "aureole.cli", "glare"]


def write_shot(folder: Path, count: int, shape: tuple[int, int], different: bool) -> None:
    """Write the bundled scene, lit a little otherwise in each frame, or the same file under all names."""
    scene = picture.night_scene(shape, SEED)
    for number in range(1, count + 1):
        path = folder / f"shot.{number:04d}.exr"
        if different or number == 1:
            factor = np.float32(1 + 0.01 * number)
            picture.write(path, aureole.Picture(scene.pixels * factor, scene.colour_space), pixel_type="half")
        else:
            os.link(folder / "shot.0001.exr", path)


def kill(folder: Path, count: int, shape: tuple[int, int]) -> None:
    """Kill a run in the middle, go on, and say whether frames were touched, whole and right."""
    write_shot(folder, count, shape, different=True)
    words = [*COMMAND, str(folder / "shot.####.exr"), "-o", str(folder / "out.####.exr")]
    running = subprocess.Popen(words, stdout=subprocess.DEVNULL)
    out = [folder / f"out.{number:04d}.exr" for number in range(1, count + 1)]
    while not out[count // 3].exists() and running.poll() is None:
        time.sleep(0.01)
    running.send_signal(signal.SIGKILL)
    running.wait()
    stamps = {path: path.stat().st_mtime_ns for path in out if path.exists()}
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    touched = sum(path.stat().st_mtime_ns != stamp for path, stamp in stamps.items())
    whole = sum(np.isfinite(picture.read(path).pixels).all() for path in out)
    different, compared = 0, sorted({1, len(stamps), len(stamps) + 1, count})
    for number in compared:
        single = folder / "single.exr"
        source = str(folder / f"shot.{number:04d}.exr")
        subprocess.run([*COMMAND, source, "-o", str(single)], check=True, stdout=subprocess.DEVNULL)
        made, wanted = picture.read(out[number - 1]).pixels, picture.read(single).pixels
        different += not np.array_equal(made, wanted)
    print(f"frames when it was killed     {len(stamps)} of {count}")
    print(f"finished frames touched       {touched}")
    print(f"frames whole after the second run  {whole} of {count}")
    print(f"frames {compared} beside their picture's alone: {different} differ")


def memory(folder: Path, count: int, shape: tuple[int, int], kernel_size: int | None) -> None:
    """Make frames one by one and print the resident memory."""
    write_shot(folder, count, shape, different=False)
    maker, process = jobs.GlareMaker.of(jobs.Optics(), kernel_size=kernel_size), psutil.Process()
    names = folder / "shot.####.exr", folder / "out.####.exr"
    # Neither the disk nor the compression is what is measured.
    quick = {"compression": "none", "pixel_type": "half"}
    tasks = jobs.sequence_tasks(*names, range(1, count + 1), maker, maker.words(), writing=quick)
    told = {1, 2, 5, 10, 20, 50, 100, 150, count}
    sizes, start = [], time.perf_counter()
    for stage in jobs.run(jobs.SequenceJob(tasks)):
        if isinstance(stage.result, jobs.FrameOutcome):
            assert stage.result.state == "done", stage.result.reason
            sizes.append(process.memory_info().rss)
            if len(sizes) in told:
                print(f"after frame {len(sizes):4d}   {sizes[-1] / 2**20:8.1f} MiB", flush=True)
            # What is measured is memory, so the disk need not hold them all.
            stage.result.target.unlink()
    reference = sizes[min(20, count) - 1]
    print(f"frame {count} over frame 20  {sizes[-1] / reference:.4f}; most {max(sizes[19:]) / reference:.4f}")
    print(f"seconds a frame     {(time.perf_counter() - start) / count:.2f}")


def main() -> None:
    """Run what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=("kill", "memory"))
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--kernel-size", type=int, help="of memory; the picture's longer side otherwise")
    asked = parser.parse_args()
    columns, rows = (int(part) for part in asked.size.split("x"))
    machine = f"{platform.system()} {platform.release()}, {os.cpu_count()} cores"
    print(f"{machine}, NumPy {np.__version__}, seed {SEED}")
    with tempfile.TemporaryDirectory() as name:
        if asked.what == "kill":
            kill(Path(name), asked.frames, (rows, columns))
        else:
            memory(Path(name), asked.frames, (rows, columns), asked.kernel_size)


if __name__ == "__main__":
    main()
