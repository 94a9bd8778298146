"""The same disc by Mitsuba 3, where it is installed: time, and how far its mean is from ours."""

import importlib
from collections.abc import Callable, Generator, Iterator
from typing import Any

import numpy as np

from aureole import refuse, surface
from aureole.bench.report import Column, Table
from aureole.bench.timing import alternate
from aureole.records import Stage

TABLE, OUTER, HOLE = 512, 0.12, 0.015
COLUMNS = (
    Column("picture", "{way}", words=True),
    Column("samples", "{samples}"),
    Column("median", "{seconds:.2f} s"),
    Column("million a second", "{rate:.1f}"),
    Column("mean over ours", "{mean_ratio:.4f}"),
)


def in_mitsuba(shape: tuple[int, int], samples: int, runs: int) -> Iterator[Stage]:
    """Time a disc under a lamp in Mitsuba and by our own shader.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns) of the picture.
    samples : int
        Samples a pixel; ours takes the square root along each axis.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    yield Stage(0.0, "trying Mitsuba")
    notes = ("A compact disc's table of 512², a lamp; Mitsuba compiles before it is timed. llvm_ad_rgb.",)
    try:
        mitsuba = importlib.import_module("aureole.surface.mitsuba").use()
    except refuse.Refusal as reason:
        notes = (str(reason),)
    else:
        yield from _timed(mitsuba, shape, samples, runs, rows)
    title = f"Mitsuba, {shape[1]}×{shape[0]}"
    yield Stage(1.0, "mitsuba", (Table("mitsuba", title, COLUMNS, tuple(rows), notes),))


def _timed(
    mitsuba: Any, shape: tuple[int, int], samples: int, runs: int, rows: list[dict[str, Any]]
) -> Generator[Stage, None, None]:
    from aureole.surface.mitsuba_scenes import mitsuba_scene

    table = surface.table_from_grating("cd", size=TABLE)
    material = surface.Material(diffuse=0.05, fresnel=surface.schlick(0.9))
    view = surface.view_from((0.0, 0.0, 0.3), shape=shape)
    lamps, pose = (surface.point_lamp((0.05, 0.1, 0.5), 0.2),), surface.pose_of(tilt=-0.2)
    scene = surface.Scene(lamps, view, pose, material)
    disc = surface.Disc(OUTER, HOLE)
    theirs = mitsuba.load_dict(mitsuba_scene(scene, table, disc, samples))
    prepared = surface.shader(table, material)
    side = max(1, round(samples**0.5))
    tasks: dict[str, Callable[[], Any]] = {
        "Mitsuba": lambda: np.array(mitsuba.render(theirs, seed=1)),
        "ours": lambda: surface.render(scene, prepared, disc, side).pixels[..., :3],
    }
    means = {way: float(np.asarray(task()).mean()) for way, task in tasks.items()}
    times = yield from alternate(tasks, runs, label="picture,", patience=60.0)
    for way, spent in times.items():
        count = samples if way == "Mitsuba" else side * side
        rows.append(
            {
                "way": way,
                "samples": count,
                "seconds": spent / 1e3,
                "rate": shape[0] * shape[1] * count / spent / 1e3,
                "mean_ratio": means[way] / means["ours"],
            }
        )
