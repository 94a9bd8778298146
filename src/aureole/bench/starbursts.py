"""A whole starburst in colour: ours in one call, the others' in a loop over wavelengths."""

from collections.abc import Generator, Iterator
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import diffraction, light, picture
from aureole.bench.optics import Intensity, Optics
from aureole.bench.peer_ways import F_NUMBER, FOCAL_LENGTH, WAVELENGTH, WIDTH, ways_of
from aureole.bench.report import Column, Table
from aureole.bench.timing import Task, alternate
from aureole.records import Aperture, Grid, Picture, Spectrum, Stage

OURS = "Aureole, one call"
BLADES, ILLUMINANT, WAVELENGTHS = 7, "D65", 60
# Wavelengths of the reference: the many where fringes are more than so many spacings out, else the few.
MANY, FEW, FEW_REACH = 1601, 401, 350.0
BATCH = 16
COLUMNS = (
    Column("RGB of the full plane", "{way}", words=True),
    Column("median", "{median_ms:.0f} ms"),
    Column("times ours", "{ratio:.1f}x"),
    Column("log-PSNR", "{log_psnr:.1f} dB"),
)


def starbursts(size: int, runs: int, peers: list[ModuleType]) -> Iterator[Stage]:
    """Time a starburst of an iris by every library.

    Parameters
    ----------
    size : int
        Pixels of the mask and of the sensor on each side.
    runs : int
        How often ours is timed; a loop runs once.
    peers : list of module
        Whom to compare with.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    count = MANY if size / np.sqrt(2) > FEW_REACH else FEW
    notes = [
        f"An iris of {BLADES} straight blades, 50 mm at f/{F_NUMBER:g}, {ILLUMINANT}, pixels of "
        f"{WAVELENGTH * F_NUMBER * 1e6:.1f} µm, point samples. The others sum {WAVELENGTHS} wavelengths, "
        f"each at its own scale, from a mask of {size}² pixels; a loop is timed once, warm where the library "
        "keeps what it prepared.",
        f"log-PSNR: over ten decades, the least of X, Y and Z, to {count} wavelengths of the exact outline. "
        "The others' includes what a mask of pixels loses.",
    ]
    yield from _measured(size, runs, peers, count, rows, notes)
    table = Table("starburst", f"Starburst, {size}² RGB", COLUMNS, tuple(rows), tuple(notes))
    yield Stage(1.0, "starburst", (table,))


def _measured(
    size: int,
    runs: int,
    peers: list[ModuleType],
    count: int,
    rows: list[dict[str, Any]],
    notes: list[str],
) -> Generator[Stage, None, None]:
    iris, lamp = apertures.iris(BLADES, WIDTH), light.illuminant(ILLUMINANT)
    pitch = WAVELENGTH * F_NUMBER
    grid = Grid((size, size), (pitch / FOCAL_LENGTH, pitch / FOCAL_LENGTH))
    optics = Optics(apertures.rasterize(iris, size), WIDTH, FOCAL_LENGTH, pitch)
    made: dict[str, NDArray[Any]] = {}
    tasks: dict[str, Task] = {OURS: lambda: made.update({OURS: _ours(iris, grid, lamp)})}
    once = []
    for way, at, peer in ways_of(peers, optics, notes):
        if way == peer.LOOP:
            tasks[way] = lambda way=way, at=at: made.update({way: _loop(at, size, lamp)})  # type: ignore[misc]
            once += [] if peer.LOOP_KEEPS else [way]
    times = yield from _within(alternate(tasks, runs, once), 0.0, 0.8)
    truth = yield from _within(_reference(iris, grid, lamp, count), 0.8, 1.0)
    for way, spent in times.items():
        # Each library has its own constant before the integral.
        scale = 1.0 if way == OURS else truth[..., 1].sum() / made[way][..., 1].sum(dtype=np.float64)
        quality = float(picture.log_psnr(made[way] * scale, truth).min())
        rows.append({"way": way, "median_ms": spent, "ratio": spent / times[OURS], "log_psnr": quality})


def _ours(iris: Aperture, grid: Grid, lamp: Spectrum) -> NDArray[Any]:
    """Make a starburst and its RGB; return the XYZ, to be compared."""
    made = diffraction.starburst(iris, grid, lamp, sample="point")
    light.convert(made, "rec709")
    return made.pixels


def _loop(at: Intensity, size: int, lamp: Spectrum) -> NDArray[Any]:
    """Sum wavelengths one by one, as one would with a peer, and make RGB; return the XYZ."""
    wavelengths, weights = light.quadrature(lamp, WAVELENGTHS)
    total = np.zeros((3, size, size), dtype=np.float32)
    for wavelength, weight in zip(wavelengths, weights.astype(np.float32), strict=True):
        power = at(float(wavelength)).astype(np.float32, copy=False)
        for channel in range(3):
            total[channel] += weight[channel] * power
    xyz = np.ascontiguousarray(np.moveaxis(total, 0, -1))
    light.convert(Picture(xyz, "xyz"), "rec709")
    return xyz


def _reference(
    iris: Aperture, grid: Grid, lamp: Spectrum, count: int
) -> Generator[Stage, None, NDArray[np.float64]]:
    """Sum so many wavelengths of the exact outline, each transformed at its own scale."""
    wavelengths, weights = light.quadrature(lamp, count)
    total = np.zeros((3, grid.shape[0] * grid.shape[1]))
    share = grid.spacing[0] * grid.spacing[1] / apertures.energy(iris)
    for first in range(0, len(wavelengths), BATCH):
        yield Stage(first / len(wavelengths), "reference")
        some = wavelengths[first : first + BATCH]
        powers = np.stack([_power(iris, grid, float(each)).ravel() for each in some])
        factors = weights[first : first + BATCH] * (share / some**2)[:, None]
        total += factors.T.astype(np.float32) @ powers
    return total.T.reshape(*grid.shape, 3)


def _power(iris: Aperture, grid: Grid, wavelength: float) -> NDArray[np.float32]:
    step_y, step_x = grid.spacing
    scaled = Grid(grid.shape, (step_y / wavelength, step_x / wavelength))
    return np.asarray(diffraction.far_power(iris, scaled), dtype=np.float32)


def _within(stages: Generator[Stage, None, Any], low: float, high: float) -> Generator[Stage, None, Any]:
    """Run stages as a part of a whole, and return what they return."""
    while True:
        try:
            stage = next(stages)
        except StopIteration as end:
            return end.value
        yield Stage(low + (high - low) * stage.fraction, stage.label)
