"""Time rays through lenses: the compiled tracer beside the slow truth, and each ghost's bounds.

    python benchmarks/flare_trace.py [--rays 64] [--runs 5]

All ghosts on one side of the stop, 3 wavelengths, so many rays along each side over each ghost's own part
of the pupil. A step is one ray at one surface. The slow tracer takes 400 rays of every twentieth ghost; the
runs alternate, and medians are given. The last column: rays that a 1920 x 1080 picture wants, over these.
"""

import argparse
import os
import platform
import statistics
import time

import numpy as np

from aureole import flare
from aureole.flare import ghost_paths, primitives, probes, pupil, rays, tracing

LENSES = ("heliar_tronnier_100mm", "zeiss_biotar_50mm", "canon_tele_zoom_135mm", "schneider_anamorphic_31mm")
WAVES = (450e-9, 550e-9, 650e-9)
TOWARDS = (np.tan(np.radians(5.0)), np.tan(np.radians(3.0)), 1.0)
SLOW_GHOSTS, SLOW_RAYS = 20, 400


def timed(task: object) -> float:
    """Return a call's seconds."""
    start = time.perf_counter()
    task()  # type: ignore[operator]
    return time.perf_counter() - start


def slow_task(lens: flare.Lens, paths: list, along: np.ndarray) -> tuple[int, object]:
    """Return how many steps the slow tracer takes in its share, and the call."""
    points = probes.points_of([-0.005, -0.005, 0.005, 0.005], (20, SLOW_RAYS // 20))
    origins = np.column_stack([points, np.zeros(len(points))])
    headings = np.tile(along, (len(points), 1))
    few = paths[::SLOW_GHOSTS]
    steps = sum(len(ghost_paths.steps(lens, path.reflections)) for path in few) * len(points)

    def task() -> None:
        for path in few:
            traced = rays.trace_reference(lens, path.reflections, origins, headings, WAVES[1])
            rays.power(lens, traced)

    return steps, task


def line(name: str, side: int, runs: int) -> str:
    """Return one lens's line."""
    lens = flare.load(name)
    prepared, paths, along = tracing.prepare(lens, WAVES), flare.ghosts(lens), tracing.travel(TOWARDS)
    found = probes.probe(prepared, paths, along)
    lit = [paths[int(k)] for k in found.lit]
    points = np.concatenate([probes.points_of(box, (side, side)) for box in found.boxes])
    counts = [side * side] * len(lit)
    steps = sum(len(ghost_paths.steps(lens, path.reflections)) for path in lit) * side * side * len(WAVES)
    slow_steps, slow = slow_task(lens, paths, along)
    tasks = {
        "trace": lambda: tracing.follow(prepared, lit, counts, points, along),
        "bounds": lambda: probes.probe(prepared, paths, along),
        "slow": slow,
    }
    taken: dict[str, list[float]] = {key: [] for key in tasks}
    for run in range(runs + 1):
        for key, task in tasks.items():
            spent = timed(task)
            if run:
                taken[key].append(spent)
    trace, bounds, truth = (statistics.median(taken[key]) for key in tasks)
    frame = primitives.Frame((1080, 1920), lens.sensor[0] / 1920)
    wanted = sum(s.x[0].size for s in pupil.sheets(prepared, paths, TOWARDS, 2 * side, frame=frame))
    speed, slow_speed = steps / trace, slow_steps / truth
    share = wanted / (len(lit) * side * side)
    return (
        f"{name:28} {len(paths):4} {steps / 1e6:8.1f} {1e3 * trace:8.1f} {speed / 1e6:8.0f} "
        f"{1e3 * bounds:8.1f} {slow_speed / 1e6:8.2f} {speed / slow_speed:7.0f} {share:8.2f}"
    )


def main() -> None:
    """Print a line for each lens."""
    parser = argparse.ArgumentParser(description="Time rays through lenses.")
    parser.add_argument("--rays", type=int, default=64)
    parser.add_argument("--runs", type=int, default=5)
    given = parser.parse_args()
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores, numpy {np.__version__}")
    print(
        f"{'lens':28} {'ways':>4} {'M steps':>8} {'ms':>8} {'M/s':>8} {'bounds':>8} {'slow M/s':>8} "
        f"{'ratio':>7} {'wanted':>8}"
    )
    for name in LENSES:
        print(line(name, given.rays, given.runs), flush=True)


if __name__ == "__main__":
    main()
