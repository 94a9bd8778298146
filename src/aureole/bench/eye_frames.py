"""Figures 4.1 and 4.2 of the eye thesis and its memory: frames with glare from flipbooks."""

import math
from collections.abc import Generator, Iterator, Sequence
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import glare, picture
from aureole.bench.report import Column, Table
from aureole.bench.timing import alternate, within, workers
from aureole.glare import flipbook, glare_frames
from aureole.picture import torus
from aureole.records import Stage

FIELD = math.radians(60)
RESOLUTIONS = ("full", "half")
# Figure 4.1, milliseconds a frame by rows of the viewport and of the glare.
PRINTED_FRAMES = {(512, 512): 12.5, (1024, 512): 14.0, (512, 1024): 33.0, (1024, 1024): 34.0}
# Figure 4.2, milliseconds of one transform by rows of the glare; forward and inverse are alike.
PRINTED_TRANSFORMS = {512: 6.0, 1024: 16.0}
# Section 4.1, for glare of 512²: eight textures of 60 frames and five buffers.
PRINTED_MEMORY_MB = 970.0
# Two nodes on each axis: as many frames are mixed as of the whole flipbooks.
NODES = {name: dict.fromkeys(axes, 2) for name, axes in flipbook.FRAMES.items()}
FRAME_NOTES = (
    "A frame: solid angles, forward transforms of three channels in a frame of zeros, components mixed "
    "from the nodes around the eye's state and multiplied, inverse transforms, compositing. Patterns are "
    "smooth stand-ins: time does not depend on them. The scene is the bundled night.",
    "The thesis's 512p glare is 512², its frame of zeros inside, so that 256² of it are the picture (5.2); "
    "ours is padded outside. It also prints 33 ms for 1024p glare on a 512p viewport.",
)
Rows = list[dict[str, Any]]


def frames(viewports: Sequence[tuple[int, int]], runs: int, wanted: Sequence[str]) -> Iterator[Stage]:
    """Time whole frames and their stages.

    Parameters
    ----------
    viewports : sequence of tuple of int
        (rows, columns) of the frames.
    runs : int
        How often each is timed.
    wanted : sequence of str
        "figure-4-1" and "figure-4-2".

    Yields
    ------
    Stage
        The last one holds the tables.
    """
    cases = [(viewport, resolution) for viewport in viewports for resolution in RESOLUTIONS]
    rows: Rows = []
    for index, (viewport, resolution) in enumerate(cases):
        work = _case(viewport, resolution, runs)
        row = yield from within(work, index / len(cases), (index + 1) / len(cases))
        rows.append(row)
    case = (
        Column("viewport", "{columns}×{rows}", words=True),
        Column("glare", "{resolution}", words=True),
    )
    tables = {
        "figure-4-1": Table(
            "figure-4-1",
            "Figure 4.1: a frame with glare",
            (
                *case,
                Column("median", "{frame_ms:.1f} ms"),
                Column("a second", "{rate:.0f}"),
                Column("thesis", "{printed_frame_ms:g} ms"),
            ),
            tuple(rows),
            FRAME_NOTES,
        ),
        "figure-4-2": Table(
            "figure-4-2",
            "Figure 4.2: stages of a frame",
            (
                *case,
                Column("forward", "{forward_ms:.1f} ms"),
                Column("thesis", "{printed_transform_ms:g} ms"),
                Column("mix, multiply", "{mix_ms:.1f} ms"),
                Column("inverse", "{inverse_ms:.1f} ms"),
                Column("thesis", "{printed_transform_ms:g} ms"),
                Column("compositing", "{rest_ms:.1f} ms"),
            ),
            tuple(rows),
            ("mix, multiply and compositing: what the whole takes beyond the other stages.",),
        ),
    }
    yield Stage(1.0, "frames", tuple(tables[name] for name in wanted))


def _case(viewport: tuple[int, int], resolution: str, runs: int) -> Generator[Stage, None, dict[str, Any]]:
    """Time one viewport at one resolution of the glare."""
    yield Stage(0.0, f"flipbooks for {viewport[1]}×{viewport[0]}, {resolution}")
    stand_in = partial(_stand_in, glare_frames.pattern_shape(viewport, resolution))
    books = glare.make_flipbooks(
        shape=viewport, field_of_view=FIELD, frames=NODES, resolution=resolution, patterns=stand_in
    )
    scene = np.ascontiguousarray(picture.night_scene(viewport).pixels[..., :3])
    state = glare.EyeState(pupil_diameter=5.3e-3, lid_opening=0.8, vitreous_angle=0.01)
    whole = glare.RealTimeGlare(books)
    convolve = picture.MixedConvolver(books.frames.kernels)
    low = np.ascontiguousarray(scene[: books.frames.kernels.shape[0], : books.frames.kernels.shape[1]])
    out, low_out = np.empty_like(scene), np.empty_like(low)
    forward, inverse = _transforms(books.frames.kernels, low, low_out)
    mix = books.mix(state)
    tasks = {
        "frame": lambda: whole(scene, state, out),
        "convolution": lambda: convolve(low, mix, low_out),
        "forward": forward,
        "inverse": inverse,
    }
    times = yield from alternate(tasks, runs, label=f"{viewport[1]}×{viewport[0]} {resolution}")
    rows = viewport[0] // (2 if resolution == "half" else 1)
    return {
        "rows": viewport[0],
        "columns": viewport[1],
        "resolution": resolution,
        "mixed": len(mix),
        "frame_ms": times["frame"],
        "rate": 1e3 / times["frame"],
        "forward_ms": times["forward"],
        "inverse_ms": times["inverse"],
        "mix_ms": max(0.0, times["convolution"] - times["forward"] - times["inverse"]),
        "rest_ms": max(0.0, times["frame"] - times["convolution"]),
        "printed_frame_ms": PRINTED_FRAMES.get((viewport[0], rows)),
        "printed_transform_ms": PRINTED_TRANSFORMS.get(rows),
    }


def _transforms(
    kernels: picture.KernelMix, light: NDArray[np.float32], out: NDArray[np.float32]
) -> tuple[Any, Any]:
    """Return the forward and the inverse transforms of three channels in their frame of zeros."""
    centre = kernels.reach[0] // 2, kernels.reach[1] // 2
    ring = torus.torus_for(kernels.shape, kernels.reach, centre, np.float32, workers())
    halves = {channel: np.zeros_like(ring.half_spectrum()) for channel in range(3)}
    blocks = [half[block] for half in halves.values() for block in range(len(half))]

    def down(block: NDArray[np.float32]) -> None:
        block[len(light) :] = 0
        ring.down.down(block)

    def up(block: NDArray[np.float32]) -> None:
        ring.down.up(block)

    def forward() -> None:
        ring.rows_down(light, (0, 0), halves)
        torus.share(down, blocks, ring.threads)

    def inverse() -> None:
        torus.share(up, blocks, ring.threads)
        ring.rows_up(halves, np.float32(-np.inf), out)

    return forward, inverse


def memory(viewports: Sequence[tuple[int, int]]) -> Iterator[Stage]:
    """Say how much memory flipbooks take.

    Parameters
    ----------
    viewports : sequence of tuple of int
        (rows, columns) of the frames.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    counts = {name: _count(name) for name in flipbook.FRAMES}
    rows: Rows = []
    for viewport in viewports:
        for resolution in RESOLUTIONS:
            one = glare_frames.GlareFrames.empty(viewport, FIELD, resolution).nbytes
            printed = PRINTED_MEMORY_MB if (viewport[0], resolution) == (512, "full") else None
            total = one * sum(counts.values())
            rows.append(
                {
                    "rows": viewport[0],
                    "columns": viewport[1],
                    "resolution": resolution,
                    "frames": sum(counts.values()),
                    "memory_mb": total / 1e6,
                    "printed_mb": printed,
                }
            )
    columns = (
        Column("viewport", "{columns}×{rows}", words=True),
        Column("glare", "{resolution}", words=True),
        Column("frames", "{frames}"),
        Column("memory", "{memory_mb:.0f} MB"),
        Column("thesis", "{printed_mb:.0f} MB"),
    )
    each = ", ".join(f"{name} {count}" for name, count in counts.items())
    notes = (
        f"Frames: {each}; what lies between is interpolated. Real half spectra in 16 bits, padded. "
        "The thesis keeps 60 frames of each component, complex, in a frame that holds its padding.",
    )
    yield Stage(1.0, "memory", (Table("memory", "Memory of flipbooks", columns, tuple(rows), notes),))


def _count(name: str) -> int:
    axes = flipbook.FRAMES[name].values()
    return math.prod(nodes if isinstance(nodes, int) else len(nodes) for nodes in axes)


def _stand_in(shape: tuple[int, int], name: str, state: glare.EyeState) -> tuple[NDArray[np.float32], float]:
    """Return a smooth pattern and a component's share."""
    return _smooth(shape), 0.7 if name == "bloom" else 0.1


@lru_cache(maxsize=1)
def _smooth(shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return a pattern that falls with the cube of the distance, as an eye's does."""
    rows, columns = (np.arange(length, dtype=np.float32) - length // 2 for length in shape)
    pattern = (1 + rows[:, None] ** 2 + columns**2) ** np.float32(-1.5)
    pattern /= pattern.sum()
    return np.repeat(pattern[..., None], 3, axis=2)
