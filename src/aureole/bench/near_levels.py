"""Figure 6 of the quad paper: the near field of a partly covered opening, seen coarser and coarser."""

from collections.abc import Generator, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import diffraction, picture
from aureole.bench import shapes
from aureole.bench.near_table import WAVELENGTH, WIDTH
from aureole.bench.report import Column, Table
from aureole.bench.timing import Task, alternate
from aureole.records import Aperture, Grid, Stage

FRESNEL_NUMBERS = (10, 100)
# Where the round shadow lies and how far it reaches, of the window.
SHADOW, RADIUS = (-0.16, -0.1), 0.18
CALL, QUADS = "auto", "quads"
COLUMNS = (
    Column("Fresnel number", "{fresnel_number}"),
    Column("finest", "{finest}", words=True),
    Column("quads", "{quads}"),
    Column("a call", "{auto_ms:.1f} ms"),
    Column("gain", "{auto_gain:.1f}x"),
    Column("by quads", "{quads_ms:.1f} ms"),
    Column("gain", "{quads_gain:.1f}x"),
    Column("PSNR", "{psnr:.1f} dB"),
    Column("SSIM", "{ssim:.4f}"),
)
NOTES = (
    "Irradiance behind a heptagon that a round shadow partly covers, as many places as pixels, against that "
    "of the full mask. a call: from the mask, by the method that is chosen. by quads: the paper's way, quads "
    "given. PSNR is of the brightest place.",
    "Printed: 128² for 1024² looks very similar and is about 7 times faster (Figure 6); how near the plane "
    "was is not said.",
)


def figure_6(size: int, runs: int) -> Iterator[Stage]:
    """Compare the levels at two distances.

    Parameters
    ----------
    size : int
        Pixels and places on each side.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    mask = covered(size)
    for index, number in enumerate(FRESNEL_NUMBERS):
        for stage in _distance(mask, number, runs, rows):
            yield Stage((index + stage.fraction) / len(FRESNEL_NUMBERS), stage.label)
    title = f"Figure 6: near fields of coarse quadtrees, {size}²"
    yield Stage(1.0, "levels", (Table("figure-6", title, COLUMNS, tuple(rows), NOTES),))


def covered(size: int) -> NDArray[np.float32]:
    """Draw the heptagon with a part of it behind a round shadow.

    Parameters
    ----------
    size : int
        Pixels on each side.

    Returns
    -------
    ndarray of float32, shape (size, size)
        Transmittance.
    """
    place = (np.arange(size) + 0.5) / size - 0.5
    away = np.hypot(place - SHADOW[0], place[:, None] - SHADOW[1])
    open_part = np.clip((away - RADIUS) * size + 0.5, 0, 1)
    return np.asarray(shapes.mask("heptagon", size) * open_part, dtype=np.float32)


def _distance(
    mask: NDArray[np.float32], number: int, runs: int, rows: list[dict[str, Any]]
) -> Generator[Stage, None, None]:
    aperture, size = Aperture(WIDTH, mask=mask), len(mask)
    grid = Grid((size, size), (WIDTH / size, WIDTH / size))
    distance = (0.5 * shapes.HALF * WIDTH) ** 2 / (WAVELENGTH * number)

    def power(finest: str) -> NDArray[Any]:
        found: NDArray[Any] = diffraction.near_power(aperture, grid, distance, WAVELENGTH, finest=finest)
        return found

    tasks: dict[str, Task] = {}
    for finest in diffraction.FINEST:
        operator = diffraction.NearOperator(aperture, grid, QUADS, finest=finest)
        tasks[f"{CALL}, {finest}"] = lambda finest=finest: power(finest)  # type: ignore[misc]
        tasks[f"{QUADS}, {finest}"] = lambda operator=operator: operator.power(distance, WAVELENGTH)  # type: ignore[misc]
    times = yield from alternate(tasks, runs, label=f"Fresnel number {number},")
    truth = power("full")
    for finest in diffraction.FINEST:
        row = {
            "fresnel_number": number,
            "finest": finest,
            "quads": len(diffraction.quadtree(mask, WIDTH, finest)),
        }
        for way in (CALL, QUADS):
            row[f"{way}_ms"] = times[f"{way}, {finest}"]
            row[f"{way}_gain"] = times[f"{way}, full"] / times[f"{way}, {finest}"]
        if finest != "full":
            found = power(finest)
            row["psnr"] = float(picture.psnr(found, truth))
            row["ssim"] = float(picture.ssim(found, truth))
        rows.append(row)
