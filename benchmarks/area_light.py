"""Time an area light of 81 samples behind an occluder: changes alone against a real FFT each, in turn.

    python benchmarks/area_light.py [--size 1024] [--runs 5]

Prints medians of one run. Both sum powers on half the plane; making the masks is not timed, as in the paper.
"""

import argparse

from aureole.bench import area_light, shapes, timing


def main() -> None:
    """Measure every opening behind every occluder, print the table."""
    parser = argparse.ArgumentParser(description="Time area lights.")
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--runs", type=int, default=5)
    given = parser.parse_args()
    machine = timing.environment()
    print(f"{machine['platform']}, {machine['processors']} processors, {machine['versions']}\n")
    print(f"{'opening':10}{'occluder':14}{'samples':>8}{'changes':>10}{'FFT':>10}{'faster':>8}{'error':>10}")
    for name in shapes.OUTLINES:
        for occluder in area_light.OCCLUDERS:
            row = area_light.compare(name, occluder, given.size, given.runs)
            times = f"{row['ours_ms']:7.0f} ms{row['fft_ms']:7.0f} ms{row['faster']:7.2f}x"
            print(f"{name:10}{occluder:14}{row['samples']:8d}{times}{row['error']:10.1e}")


if __name__ == "__main__":
    main()
