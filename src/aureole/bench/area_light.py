"""Area lights of many samples behind an occluder: sums of powers by our methods, and by an FFT each.

The quad paper takes 81 samples at 1024² in 31.9 ms where FFT takes 63.4 ms (section 6.1, GeForce GTX 1080 Ti,
without the making of the masks, which both need; that takes 9.42 ms there).
"""

from collections.abc import Generator, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from aureole import aperture, glare, picture, refuse
from aureole.bench import shapes
from aureole.bench.report import Column, Table
from aureole.bench.timing import Task, alternate, finish, milliseconds, workers
from aureole.records import Aperture, Grid, Stage

# Pixels of 1024 that the shadow moves from a sample to its neighbour, as from frame to frame in the paper.
STEP = 5.0
OCCLUDERS = ("disc", "leaf", "railing", "slanted bars")
# Shares of the light whose spread "modes" may estimate.
TOLERANCES = (1e-2, 1e-3)
FFT, PROGRESSIVE = "FFT", "progressive"
PRINTED_MS, PRINTED_FFT_MS = 31.9, 63.4
COLUMNS = (
    Column("opening", "{opening}", words=True),
    Column("occluder", "{occluder}", words=True),
    Column("method", "{method}", words=True),
    Column("taken", "{transforms}"),
    Column("ms", "{ms:.0f}"),
    Column("faster", "{faster:.1f}x"),
    Column("peak", "{of_peak:.0e}"),
    Column("light", "{of_light:.0e}"),
    Column("said", "{said:.0e}"),
    Column("log-PSNR", "{log_psnr:.0f} dB"),
)
NOTES = (
    "Each sample sees the opening past an occluder whose shadow moves by 5 pixels of 1024 from it to the "
    "next, as the paper's moves from frame to frame. FFT: a real transform of each mask, powers summed on "
    "half of the plane. modes: few transforms for all (so many are taken), a share of the light estimated; "
    "progressive: each from the change (section 4.3). Masks are made before; ms are medians, all in turn.",
    "peak: largest difference from FFT's sum, of its peak. light: sum of absolute differences over the sum. "
    "said: the bound of it that the method gives. log-PSNR: over ten decades of the peak.",
    f"Printed in section 6.1, 81 samples at 1024²: {PRINTED_MS:g} ms, and {PRINTED_FFT_MS:g} ms by FFT "
    f"({PRINTED_FFT_MS / PRINTED_MS:.1f}x; GeForce GTX 1080 Ti, occluder not described).",
)


@dataclass(frozen=True)
class AreaLightBench:
    """What to measure.

    Parameters
    ----------
    size : int
        Pixels on each side, even.
    across : int
        Samples along each side of the light.
    runs : int
        How often each is timed.
    only : tuple of str
        Openings (box, circle, heptagon, whirl) and occluders (disc, leaf, railing, slanted bars) to keep; the
        heptagon, and all occluders, where none is named.
    """

    size: int = 1024
    across: int = 9
    runs: int = 5
    only: tuple[str, ...] = ()


def run_area_light(bench: AreaLightBench) -> Iterator[Stage]:
    """Measure area lights.

    Parameters
    ----------
    bench : AreaLightBench
        What to measure.

    Returns
    -------
    iterator of Stage
        The last one holds a `Report`.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range or a name is unknown.
    """
    size = refuse.at_least("size", bench.size, 32)
    if size % 2:
        raise refuse.Refusal(f"'size' must be even, such as 1024, got {size}.")
    refuse.at_least("across", bench.across, 1)
    refuse.at_least("runs", bench.runs, 1)
    for name in bench.only:
        refuse.one_of("only", name, (*shapes.OUTLINES, *OCCLUDERS))
    openings = [name for name in shapes.OUTLINES if name in bench.only] or ["heptagon"]
    occluders = [name for name in OCCLUDERS if name in bench.only] or list(OCCLUDERS)
    settings = {"size": size, "across": bench.across, "runs": bench.runs, "only": list(bench.only), "seed": 0}
    return finish("area-light", settings, [partial(area_lights, bench, openings, occluders)])


def area_lights(bench: AreaLightBench, openings: list[str], occluders: list[str]) -> Iterator[Stage]:
    """Time every opening behind every occluder.

    Parameters
    ----------
    bench : AreaLightBench
        Size, samples and runs.
    openings, occluders : list of str
        As of `masks`.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    pairs = [(name, before) for name in openings for before in occluders]
    for index, (name, before) in enumerate(pairs):
        for stage in _scene(name, before, bench, rows):
            yield Stage((index + stage.fraction) / len(pairs), f"{name} behind {before}, {stage.label}")
    title = f"Area lights of {bench.across} x {bench.across} samples, {bench.size}²"
    yield Stage(1.0, "area lights", (Table("area-light", title, COLUMNS, tuple(rows), NOTES),))


def masks(name: str, occluder: str, size: int, across: int = 9) -> list[Aperture]:
    """Paint what of an opening the samples of a square light see past an occluder.

    Parameters
    ----------
    name : str
        Opening: box, circle, heptagon or whirl.
    occluder : str
        disc, leaf, railing or slanted bars.
    size : int
        Pixels a side.
    across : int
        Samples along each side of the light.

    Returns
    -------
    list of Aperture
        In the order of the samples.
    """
    opening = shapes.raster(name, size, across=1.0)
    silhouettes = {
        "disc": aperture.circle(0.3),
        "leaf": aperture.polygon([(-0.35, -0.1), (0.0, -0.18), (0.4, 0.15), (0.05, 0.12)]),
        "railing": aperture.railing(0.12, 0.22, 7, 4.0),
        "slanted bars": aperture.railing(0.12, 0.22, 7, 4.0, 0.4),
    }
    before = aperture.occluder(silhouettes[occluder], 1.0)
    side = STEP / 1024 * across
    light = glare.AreaLight(aperture.rectangle(side, side))
    samples = glare.light_samples(light, across)
    return [seen for _, seen in glare.sample_openings(opening, [before], light, samples, size) if seen]


def by_transforms(painted: list[Aperture]) -> NDArray[np.float32]:
    """Sum the powers of real transforms on half the plane, and mirror the sum.

    Parameters
    ----------
    painted : list of Aperture
        Rasters of an even number of pixels.

    Returns
    -------
    ndarray of float32, shape (n, n)
        The mean at the transform's own frequencies, zero in the middle; without the pixel's sinc.
    """
    assert painted[0].mask is not None
    size = len(painted[0].mask)
    half = np.zeros((size, size // 2 + 1), dtype=np.float32)
    for each in painted:
        field = scipy.fft.rfft2(each.mask, workers=workers())
        half += field.real**2 + field.imag**2
    half *= np.float32(1 / (len(painted) * size**4))
    out = np.empty((size, size), dtype=np.float32)
    middle = size // 2
    rows = np.roll(half, middle, axis=0)
    out[:, middle:] = rows[:, :middle]
    out[:, 0] = rows[:, middle]
    out[1:, 1:middle] = rows[:0:-1, middle - 1 : 0 : -1]
    out[0, 1:middle] = rows[0, middle - 1 : 0 : -1]
    return out


def by_method(painted: list[Aperture], method: str, tolerance: float) -> glare.Summing:
    """Sum the powers by one of our methods.

    Parameters
    ----------
    painted : list of Aperture
        Rasters.
    method : str
        transforms, modes or progressive.
    tolerance : float
        Share of the light whose spread "modes" may estimate.

    Returns
    -------
    TransformSum, ModeSum or PowerSum
        With the mean for its result, at the transform's own frequencies.
    """
    assert painted[0].mask is not None
    size = len(painted[0].mask)
    total = glare.power_sum(method, Grid((size, size), (1.0, 1.0)), size, tolerance, len(painted))
    for each in painted:
        total.add(each, 1 / len(painted))
    return total


def _scene(
    name: str, occluder: str, bench: AreaLightBench, rows: list[dict[str, Any]]
) -> Generator[Stage, None, None]:
    """Time one opening behind one occluder by every method in turn, and append its rows."""
    yield Stage(0.0, "masks")
    made: list[list[Aperture]] = []
    making = milliseconds(lambda: made.append(masks(name, occluder, bench.size, bench.across)))
    (painted,) = made
    ways = {f"modes, {each:g}": partial(by_method, painted, "modes", each) for each in TOLERANCES}
    ways[PROGRESSIVE] = partial(by_method, painted, PROGRESSIVE, 0.0)
    tasks: dict[str, Task] = {FFT: partial(by_transforms, painted)}
    tasks |= {way: lambda sum_of=sum_of: sum_of().result() for way, sum_of in ways.items()}  # type: ignore[misc]
    times = yield from alternate(tasks, bench.runs)
    shared = {"opening": name, "occluder": occluder, "samples": len(painted), "masks_ms": making}
    rows.append(shared | {"method": FFT, "transforms": len(painted), "ms": times[FFT]})
    truth = with_pixels(by_transforms(painted))
    for way, sum_of in ways.items():
        total = sum_of()
        found = total.result()
        rows.append(
            shared
            | {"method": way, "transforms": total.transforms, "ms": times[way], "said": total.estimated}
            | {"faster": times[FFT] / times[way]}
            | errors(found, truth)
        )


def errors(found: NDArray[np.float32], truth: NDArray[np.float32]) -> dict[str, float]:
    """Say how far a sum of powers is from another one.

    Parameters
    ----------
    found, truth : ndarray of float32, shape (n, n)
        Sums.

    Returns
    -------
    dict
        of_peak, of_light, log_psnr.
    """
    apart = np.abs(found - truth)
    return {
        "of_peak": float(apart.max() / truth.max()),
        "of_light": float(apart.sum(dtype=np.float64) / truth.sum(dtype=np.float64)),
        "log_psnr": float(picture.log_psnr(found, truth)),
    }


def with_pixels(power: NDArray[np.float32]) -> NDArray[np.float32]:
    """Multiply a power at an FFT's own frequencies by that of a pixel, which is a small square.

    Parameters
    ----------
    power : ndarray of float32, shape (n, n)
        Frequency zero in the middle.

    Returns
    -------
    ndarray of float32, shape (n, n)
        The power of the mask as pixels.
    """
    size = len(power)
    pixel = np.sinc((np.arange(size) - size // 2) / size) ** 2
    return (power * pixel[:, None] * pixel).astype(np.float32)
