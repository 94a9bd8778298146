"""Follow a moving shadow as `aureole bench quad-paper` does for Figure 10, along any way of it.

    python benchmarks/progressive.py [--size 1024] [--frames 101] [--radius 100] [--step 5 0] [--grey]

The bench moves the shadow straight across black and white masks; --step 4 3 takes it aslant, where the
change has no symmetry, and --grey keeps the grey pixels along the openings' edges.
"""

import argparse

from aureole.bench import progressive, shapes, timing


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Time a moving shadow against fresh transforms.")
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--frames", type=int, default=101)
    parser.add_argument("--radius", type=float, default=100)
    parser.add_argument("--step", type=float, nargs=2, default=(5, 0))
    parser.add_argument("--grey", action="store_true")
    return parser.parse_args()


def main() -> None:
    """Measure every shape, print the table."""
    given = arguments()
    machine = timing.environment()
    print(f"{machine['platform']}, {machine['processors']} processors, {machine['versions']}")
    print(f"{given.size}², {given.frames} frames, radius {given.radius:g} px, step {given.step} px\n")
    print(f"{'':12}{'update':>10}{'rfft2':>10}{'faster':>8}{'quads':>8}{'fresh':>8}{'part':>7}{'error':>10}")
    for name in shapes.OUTLINES:
        painted = progressive.frames(name, given.size, given.frames, given.radius, given.step, given.grey)
        row = progressive.follow(painted)
        faster = row["rfft2_ms"] / row["update_ms"]
        times = f"{row['update_ms']:7.2f} ms{row['rfft2_ms']:7.2f} ms{faster:7.2f}x"
        quads = f"{row['update_quads']:8.0f}{row['fresh_quads']:8.0f}{row['part']:7.1%}"
        print(f"{name:12}{times}{quads}{row['error']:10.1e}")


if __name__ == "__main__":
    main()
