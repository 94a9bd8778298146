"""Bloom beside the full convolution: how much faster, and how far what it adds is from what that one adds."""

from collections.abc import Generator, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from aureole import glare, light, picture, refuse
from aureole.bench.report import Column, Table
from aureole.bench.timing import Task, alternate, finish, within
from aureole.jobs.optics import Optics
from aureole.records import Picture, Stage

SCENE = "night"
# What "as exposed" means: this share of what the full one adds lies below 1.
EXPOSED = 99.9
COLUMNS = (
    Column("picture", "{picture}", words=True),
    Column("bloom", "{bloom_ms:.0f} ms"),
    Column("double", "{double_ms:.0f} ms"),
    Column("faster", "{faster_than_double:.1f}x"),
    Column("single", "{single_ms:.0f} ms"),
    Column("faster", "{faster_than_single:.1f}x"),
    Column("added", "{psnr_db:.1f} dB"),
    Column("worst", "{psnr_worst_db:.1f} dB"),
    Column("shown", "{psnr_shown_db:.1f} dB"),
    Column("dark", "{darker_half:+.2%}"),
)
NOTES = (
    "double, single: the mode scatter, which bloom stands for, at both precisions; the command takes double "
    "unless told otherwise. Kernels are prepared before, as for a sequence; ms are medians from picture in "
    "to picture out, in turn.",
    "added: PSNR of what bloom adds (out − in) to what the full one adds, all channels together, exposed so "
    f"that the full one's {EXPOSED}th percentile is 1. worst: one channel. shown: all, cut to 0..1. dark: "
    "bloom's light over the full one's, less one, where the full one adds less than its median.",
)


@dataclass(frozen=True)
class BloomBench:
    """What to measure.

    Parameters
    ----------
    source : Path, optional
        A linear picture; the bundled night scene otherwise.
    size : tuple of int
        (rows, columns) that the picture is scaled to, or made at.
    runs : int
        How often each is timed.
    """

    source: Path | None = None
    size: tuple[int, int] = (1080, 1920)
    runs: int = 9


def run_bloom(bench: BloomBench) -> Iterator[Stage]:
    """Measure bloom.

    Parameters
    ----------
    bench : BloomBench
        What to measure.

    Returns
    -------
    iterator of Stage
        The last one holds a `Report`.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range or the picture cannot be read.
    """
    for name, length in zip(("height", "width"), bench.size, strict=True):
        refuse.at_least(name, length, 16)
    refuse.at_least("runs", bench.runs, 1)
    name = SCENE if bench.source is None else bench.source.name
    source = picture.night_scene(bench.size) if bench.source is None else _scaled(bench.source, bench.size)
    settings = {"picture": name, "size": f"{bench.size[1]} x {bench.size[0]}", "runs": bench.runs}
    return finish("bloom", settings, [partial(_bloom, name, source, bench.runs)])


def _scaled(path: Path, size: tuple[int, int]) -> Picture:
    """Read a picture and scale it by straight lines."""
    given = picture.read(path)
    factors = [wanted / length for wanted, length in zip(size, given.pixels.shape[:2], strict=True)]
    pixels = ndimage.zoom(given.pixels[..., :3], (*factors, 1), order=1, mode="nearest", grid_mode=True)
    space = given.colour_space if given.colour_space in light.SPACES else "rec709"
    return Picture(np.ascontiguousarray(pixels, dtype=np.float32), space)


def _bloom(name: str, source: Picture, runs: int) -> Iterator[Stage]:
    """Time bloom and the full convolution, and compare what they add."""
    row: dict[str, Any] = {"picture": name}
    yield from _compared(source, runs, row)
    size = f"{row['columns']}×{row['rows']}"
    title = f"Bloom beside the full convolution, {size}, the default camera"
    yield Stage(1.0, "bloom", (Table("bloom", title, COLUMNS, (row,), NOTES),))


def _compared(source: Picture, runs: int, row: dict[str, Any]) -> Generator[Stage, None, None]:
    source = Picture(np.ascontiguousarray(source.pixels[..., :3]), source.colour_space)
    rows, columns = source.pixels.shape[:2]
    camera = Optics().camera((rows, columns), 1.0, None)
    side = max(rows, columns) | 1
    psf: Any = None
    for stage in glare.camera_psf_stages(camera, (side, side), light.illuminant("D65"), source.colour_space):
        psf = stage.result
        yield Stage(0.3 * stage.fraction, "point spread function")
    bloom = glare.prepare(psf, (rows, columns), "bloom")
    full = {
        each: glare.prepare(psf, (rows, columns), "scatter", precision=each) for each in ("double", "single")
    }
    tasks: dict[str, Task] = {name: partial(glare.composite, source, each) for name, each in full.items()}
    work = alternate({"bloom": partial(glare.composite, source, bloom), **tasks}, runs, label="timing")
    times = yield from within(work, 0.3, 1.0)
    added = (glare.composite(source, each).pixels - source.pixels for each in (bloom, full["double"]))
    row |= {"rows": rows, "columns": columns, **{f"{each}_ms": spent for each, spent in times.items()}}
    row |= {f"faster_than_{each}": times[each] / times["bloom"] for each in full}
    row |= differences(*added)


def differences(found: NDArray[np.float32], expected: NDArray[np.float32]) -> dict[str, float]:
    """Compare what two ways add to a picture.

    Parameters
    ----------
    found, expected : ndarray, shape (rows, columns, 3)
        What they add; the second counts as right, and says how both are exposed.

    Returns
    -------
    dict
        psnr_db and psnr_shown_db (cut to 0..1), both of all channels together; psnr_worst_db of one channel;
        darker_half: the first's light over the second's, less one, where the second adds less than its
        median.
    """
    exposed = np.float32(np.percentile(expected, EXPOSED))
    one, other = found / exposed, expected / exposed

    def together(one: NDArray[np.float32], other: NDArray[np.float32]) -> float:
        return float(picture.psnr(one.reshape(len(one), -1), other.reshape(len(other), -1), peak=1.0))

    dark = np.nonzero(expected.max(axis=2) < np.median(expected.max(axis=2)))
    return {
        "psnr_db": together(one, other),
        "psnr_worst_db": float(picture.psnr(one, other, peak=1.0).min()),
        "psnr_shown_db": together(np.clip(one, 0, 1), np.clip(other, 0, 1)),
        "darker_half": float(found[dark].sum(dtype=np.float64) / expected[dark].sum(dtype=np.float64) - 1),
    }
