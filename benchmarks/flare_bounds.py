"""Compare each ghost's part of the pupil with a dense grid of rays over the whole front of the lens.

    python benchmarks/flare_bounds.py [LENS ...] [--side 200] [--stride 7]

For each lens and field angle, over every so many ghosts: those that the bounds lose although a ray passes,
the largest part of a ghost's power outside its bounds, and how many times fewer rays the bounds need.
"""

import argparse

import numpy as np

from aureole import flare, presets
from aureole.flare import probes, tracing

WAVES = (450e-9, 550e-9, 650e-9)
ANGLES_DEG = ((0.0, 0.0), (3.0, 1.0), (10.0, -6.0), (20.0, 12.0))


def compare(prepared: tracing.Prepared, paths: list, direction: tuple, side: int) -> tuple[int, float, float]:
    """Return how many ghosts are lost, the worst loss of power, and the saving's median."""
    along = tracing.travel(direction)
    box = probes.whole(prepared, along)
    points = probes.points_of(box, (side, side))
    found = probes.probe(prepared, paths, along)
    place = {int(k): n for n, k in enumerate(found.lit)}
    lost, worst, savings = 0, 0.0, []
    for k, path in enumerate(paths):
        rays = tracing.trace(prepared, path, points, direction)
        power = np.sum(rays.weight * rays.passed, axis=0, dtype=np.float64)
        if k not in place:
            lost += power.sum() > 0
            continue
        left, top, right, bottom = found.boxes[place[k]]
        x, y = points.T
        outside = (x < left) | (x > right) | (y < top) | (y > bottom)
        if power.sum() > 0:
            worst = max(worst, power[outside].sum() / power.sum())
        savings.append((box[2] - box[0]) * (box[3] - box[1]) / ((right - left) * (bottom - top)))
    return lost, worst, float(np.median(savings)) if savings else 1.0


def main() -> None:
    """Print a line for each lens and angle."""
    parser = argparse.ArgumentParser(description="Compare bounds with a dense grid.")
    parser.add_argument("lenses", nargs="*", default=presets.names("lenses"))
    parser.add_argument("--side", type=int, default=200)
    parser.add_argument("--stride", type=int, default=7)
    given = parser.parse_args()
    print(f"{'lens':30} {'angle':>12} {'ghosts':>6} {'lost':>4} {'worst loss':>10} {'fewer rays':>10}")
    for name in given.lenses:
        lens = flare.load(name)
        prepared = tracing.prepare(lens, WAVES)
        paths = [(), *flare.ghosts(lens, "all")[:: given.stride]]
        for x, y in ANGLES_DEG:
            direction = (np.tan(np.radians(x)), np.tan(np.radians(y)), 1.0)
            lost, worst, saved = compare(prepared, paths, direction, given.side)
            print(f"{name:30} {x:5g},{y:5g}° {len(paths):6} {lost:4} {worst:10.1e} {saved:10.1f}", flush=True)


if __name__ == "__main__":
    main()
