"""A frame of a compact disc under a lamp: how long it takes."""

import time
from collections.abc import Generator, Iterator
from typing import Any

from aureole import surface
from aureole.bench.report import Column, Table
from aureole.bench.timing import alternate
from aureole.records import Stage

# Section 6 of the surface paper: frames a second, its size not told, on a GeForce GTX 960M.
PRINTED_RATE = 65.0
OUTER, HOLE = 0.12, 0.015
COLUMNS = (
    Column("frame", "{frame}", words=True),
    Column("hit", "{hit:.0%}"),
    Column("median", "{median_ms:.1f} ms"),
    Column("processors", "{busy_ms:.1f} ms"),
    Column("a second", "{rate:.0f}"),
    Column("printed", "{printed_rate:.0f} a second"),
)


def frames(shape: tuple[int, int], size: int, runs: int) -> Iterator[Stage]:
    """Time frames, everything that can be made once being made before.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns) of a frame.
    size : int
        Samples of the table on each side.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    yield from _frames(shape, size, runs, rows)
    title = f"A frame of {shape[1]}×{shape[0]}, one sample a pixel, a compact disc under a lamp"
    notes = (
        f"A table of {size}², radial tangents, the specular lobe and Fresnel's factor included. hit: pixels "
        "that see the disc. processors: time of all together. printed: a table in a fragment shader.",
    )
    yield Stage(1.0, "frame", (Table("frame", title, COLUMNS, tuple(rows), notes),))


def _frames(
    shape: tuple[int, int], size: int, runs: int, rows: list[dict[str, Any]]
) -> Generator[Stage, None, None]:
    yield Stage(0.0, "the disc's table")
    material = surface.Material(specular=0.05, roughness=0.05, fresnel=surface.schlick(0.9))
    prepared = surface.shader(surface.table_from_grating("cd", size=size), material)
    disc, lamps = surface.Disc(OUTER, HOLE), (surface.point_lamp((0.05, 0.1, 0.5), 0.2),)
    pose = surface.pose_of(tilt=-0.2)
    tasks, hits = {}, {}
    for name, distance in (("filling the picture", 0.24), ("small", 0.45)):
        view = surface.view_from((0.0, 0.0, distance), shape=shape)
        scene = surface.Scene(lamps, view, pose, material)
        tasks[name] = _task(scene, prepared, disc)
        hits[name] = float((tasks[name]().pixels[..., 3] > 0).mean())
    times = yield from alternate(tasks, 5 * runs, label="frame")
    for name, spent in times.items():
        busy = time.process_time()
        for _ in range(runs):
            tasks[name]()
        row = {"frame": name, "hit": hits[name], "median_ms": spent, "rate": 1e3 / spent}
        row["busy_ms"] = 1e3 * (time.process_time() - busy) / runs
        rows.append(row | ({"printed_rate": PRINTED_RATE} if shape == (540, 960) else {}))


def _task(scene: surface.Scene, prepared: surface.Shader, disc: surface.Disc) -> Any:
    return lambda: surface.render(scene, prepared, disc)
