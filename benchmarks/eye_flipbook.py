"""Glare of a moving eye in real time: time a frame, memory, and how far flipbooks are from the wave itself.

    python benchmarks/eye_flipbook.py [--rows 512] [--columns 910] [--runs 31] [--size 2048] [--keep FOLDER]

Flipbooks of the standard eye over 60 degrees, at full and at half resolution, are made once (`--keep` leaves
them in a folder and reads them from there the next time). Each timed frame is a state of its own, 1/24 s
after the last, so that frames are blended between nodes; the ways alternate. Times are by the clock, and of
all processors together, which holds on a busy machine, too. Errors: what rounding to 16 bits does to the
glare, and what adding intensities and blending between nodes do, against one wave through all parts.
"""

import argparse
import math
import os
import pathlib
import platform
import statistics
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

import aureole
from aureole import glare, picture
from aureole.glare.flipbook import eye_patterns

FIELD = math.radians(60)
FPS = 24
RESOLUTIONS = ("full", "half")


def made(shape: tuple[int, int], resolution: str, size: int, keep: pathlib.Path | None) -> glare.Flipbooks:
    """Make flipbooks, or read those of an earlier run."""
    path = None if keep is None else keep / f"eye-{shape[1]}x{shape[0]}-{resolution}-{size}.npz"
    if path is not None and path.exists():
        return glare.load_flipbooks(path)
    start = time.process_time()
    books = glare.make_flipbooks(shape=shape, field_of_view=FIELD, resolution=resolution, size=size)
    print(f"{resolution}: made in {time.process_time() - start:.0f} s of processor time")
    if path is not None:
        glare.save_flipbooks(books, path)
    return books


def milliseconds(task: Callable[[], object]) -> tuple[float, float]:
    """Time one call: by the clock, and of all processors together."""
    start, busy = time.perf_counter(), time.process_time()
    task()
    return (time.perf_counter() - start) * 1e3, (time.process_time() - busy) * 1e3


def time_frames(books: dict[str, glare.Flipbooks], scene: np.ndarray, runs: int, size: int) -> None:
    """Time frames of all ways in turn, each frame in a state of its own."""
    states = glare.states([i / FPS for i in range(runs + 1)], 1.0)
    out = np.empty_like(scene)
    ways = {
        f"{resolution}, {mode}": glare.RealTimeGlare(books[resolution], mode)
        for resolution in RESOLUTIONS
        for mode in ("replace", "add")
    }
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in ways}
    steps: dict[str, dict[str, list[float]]] = {resolution: {} for resolution in RESOLUTIONS}
    for state in states:
        for name, way in ways.items():
            times[name].append(milliseconds(lambda way=way, state=state: way(scene, state, out)))
        for resolution, own in steps.items():
            for step, seconds in ways[f"{resolution}, replace"].step_seconds(scene, state).items():
                own.setdefault(step, []).append(seconds * 1e3)
    fresh = glare.RealTimeGlare(glare.FreshGlare.of(shape=scene.shape[:2], field_of_view=FIELD, size=size))
    times[f"full, a wave of {size} samples afresh"] = [
        milliseconds(lambda state=state: fresh(scene, state, out)) for state in states[:4]
    ]
    print(f"\n{'milliseconds a frame':40}{'median':>10}{'fastest':>10}{'processors':>12}")
    for name, taken in times.items():
        clock, busy = zip(*taken[1:], strict=True)
        print(f"{name:40}{statistics.median(clock):10.1f}{min(clock):10.1f}{statistics.median(busy):12.1f}")
    for resolution, own in steps.items():
        parts = (f"{step} {statistics.median(taken[1:]):.1f}" for step, taken in own.items())
        print(f"{resolution}: {', '.join(parts)}")


def rounding(books: glare.Flipbooks, scene: np.ndarray, state: glare.EyeState, size: int) -> None:
    """Print what 16 bits do to the glare of a scene, against double precision."""
    frames = books.frames
    make = eye_patterns(frames.shape, FIELD, frames.resolution, size=size)
    total = np.zeros((*frames.kernels.reach, 3))
    for book, name in ((book, name) for name, book in books.books.items()):
        nodes = [node for _, node in book.axes]
        for index, at in enumerate(np.ndindex(*map(len, nodes))):
            weight = dict(books.mix(state)).get(book.first + index, 0.0)
            if weight:
                changes = {axis: own[k] for (axis, own), k in zip(book.axes, at, strict=True)}
                total += weight * make(name, replace(glare.EyeState(books.eye), **changes))[0]
    total[total.shape[0] // 2, total.shape[1] // 2] = 0
    wanted = picture.Convolver(total, frames.kernels.shape, "double")(scene)
    found = picture.MixedConvolver(frames.kernels)(scene, books.mix(state))
    difference = math.sqrt(float(np.mean((found - wanted) ** 2)))
    print(
        f"\n16 bits: root mean square of the difference {difference / math.sqrt(np.mean(wanted**2)):.1e} of "
        f"the glare's, {difference / math.sqrt(np.mean(scene**2)):.1e} of the frame's; largest, "
        f"{np.abs(found / wanted - 1).max():.1e} of a pixel's own glare"
    )


def coherent(books: glare.Flipbooks, scene: aureole.Picture, size: int) -> None:
    """Print the table of differences from one wave through all parts."""
    open_eye = glare.EyeState(books.eye)
    states = {
        "pupil 3.2 mm": replace(open_eye, pupil_diameter=3.2e-3),
        "pupil 5 mm": replace(open_eye, pupil_diameter=5e-3),
        "pupil 7 mm": replace(open_eye, pupil_diameter=7e-3),
        "pupil 5 mm, vitreous 1.4 deg": replace(open_eye, vitreous_angle=0.025),
        "pupil 5 mm, lens +0.1 %": replace(open_eye, lens_stretch=1e-3),
        "pupil 5 mm, lids at 0.55": replace(open_eye, lid_opening=0.55),
        "pupil 5 mm, lids at 0.25": replace(open_eye, lid_opening=0.25),
    }
    print("\nflipbooks, which add intensities, over one wave: mean of rings (root mean square difference)")
    for number, (name, state) in enumerate(states.items()):
        found = glare.flipbook_error(books, state, size, scene)
        if not number:
            rings = "".join(f"{math.degrees(edge):11.2f}" for edge in found.edges[1:])
            print(f"{'up to degrees':30}{rings}  spread  PSNR  log")
        cells = "".join(f"{r:6.2f}({d:.2f})" for r, d in zip(found.ratios, found.deviations, strict=True))
        print(f"{name:30}{cells}{found.spread:7.3f}{found.psnr:7.1f}{found.log_psnr:6.1f}")


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Time a moving eye's glare, and measure its flipbooks.")
    parser.add_argument("--rows", type=int, default=512)
    parser.add_argument("--columns", type=int, default=910)
    parser.add_argument("--runs", type=int, default=31)
    parser.add_argument("--size", type=int, default=2048, help="samples a side of the wave")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the flipbooks")
    return parser.parse_args()


def main() -> None:
    """Make or read the flipbooks, time frames, print errors."""
    given = arguments()
    shape = (given.rows, given.columns)
    print(
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, NumPy "
        f"{np.__version__}, Aureole {aureole.__version__}, {given.columns} x {given.rows}, 60 degrees"
    )
    scene = picture.night_scene(shape)
    pixels = np.ascontiguousarray(scene.pixels[..., :3])
    books = {resolution: made(shape, resolution, given.size, given.keep) for resolution in RESOLUTIONS}
    for resolution, book in books.items():
        counts = ", ".join(f"{name} {len(own.shares)}" for name, own in book.books.items())
        print(f"{resolution}: {book.nbytes / 1e6:.0f} MB, frames: {counts}")
    time_frames(books, pixels, given.runs, given.size)
    rounding(books["full"], pixels, glare.EyeState.at(1.5, 1.0), given.size)
    coherent(books["full"], scene, given.size)


if __name__ == "__main__":
    main()
