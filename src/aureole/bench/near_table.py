"""Table 4 of the quad paper: near fields of four shapes, beside the discrete ways."""

from collections.abc import Generator, Iterator, Sequence
from typing import Any

from aureole import diffraction
from aureole.bench import shapes
from aureole.bench.convolved import transfer_function
from aureole.bench.fractional import fractional_near
from aureole.bench.report import Column, Table
from aureole.bench.timing import Task, alternate
from aureole.records import Grid, Stage

SIZES = (256, 512, 1024, 2048, 4096)
# Table 4, as printed, in milliseconds on a GeForce GTX 1080 Ti, but for the first on a processor.
PRINTED_FRACTIONAL_MS = (15.98, 33.01, 128.72, 533.85, 2133.19)
PRINTED_DISCRETE_MS = (4.87, 20.94, 94.73)
PRINTED_MS = {
    "box": (0.12, 0.14, 0.28, 7.88, 30.88),
    "circle": (0.11, 0.23, 0.84, 5.43, 41.30),
    "heptagon": (0.14, 0.36, 1.71, 15.78, 137.16),
    "whirl": (0.16, 0.49, 2.93, 23.42, 255.72),
}
# A window of width 1 in light of wavelength 1: only the Fresnel number counts, here of the opening.
WIDTH, WAVELENGTH, FRESNEL_NUMBER = 1.0, 1.0, 100.0
DISTANCE = (0.5 * shapes.HALF * WIDTH) ** 2 / (WAVELENGTH * FRESNEL_NUMBER)
OUTLINES = "polygons"
# An exact outline is left out where it would take longer, four times as long as at half the size.
OUTLINE_PATIENCE_MS = 1e4
# So far the paper could pad eight times, and so far it is done here.
FRAMED, FRAME = 1024, 8
FRACTIONAL, DISCRETE, EIGHT = "fractional", "discrete", "discrete, 8x"
COLUMNS = (
    Column("size", "{size}²"),
    Column("aperture", "{aperture}", words=True),
    Column("mask", "{mask_ms:.1f}"),
    Column("outline", "{outline_ms:.0f}"),
    Column("paper's", "{printed_ms:.2f}"),
    Column("fractional", "{fractional_ms:.0f}"),
    Column("CPU-FrFT", "{printed_fractional_ms:.0f}"),
    Column("FFT 2x", "{discrete_ms:.0f}"),
    Column("FFT 8x", "{framed_ms:.0f}"),
    Column("GPU-NFD", "{printed_discrete_ms:.1f}"),
)
NOTES = (
    "Milliseconds. Shapes across half of the mask, as many places on the plane as pixels, as far apart; "
    f"Fresnel number {FRESNEL_NUMBER:g} (the paper does not say its own). mask: the irradiance of a mask of "
    "so many pixels. outline: that of the exact outline, where it takes less than "
    f"{OUTLINE_PATIENCE_MS / 1e3:g} s.",
    "fractional: the discrete fractional Fourier transform in complex64 (Ozaktas et al. 1996), on its own "
    "wider plane. FFT: convolution with the transfer function in frames of zeros twice and eight times as "
    "wide. Neither depends on the shape.",
    "paper's, CPU-FrFT, GPU-NFD: as printed; a GeForce GTX 1080 Ti but for CPU-FrFT. Its discrete way takes "
    f"{FRAME} times the resolution.",
)


def table_4(sizes: Sequence[int], runs: int) -> Iterator[Stage]:
    """Time near fields of the four shapes.

    Parameters
    ----------
    sizes : sequence of int
        Pixels on each side.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    for index, size in enumerate(sizes):
        for stage in _of_size(size, runs, _patient(rows), rows):
            yield Stage((index + stage.fraction) / len(sizes), stage.label)
    yield Stage(1.0, "near fields", (Table("table-4", "Table 4: near fields", COLUMNS, tuple(rows), NOTES),))


def _patient(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Return the shapes whose exact outline is not too slow, going by the size before."""
    last = {row["aperture"]: row.get("outline_ms", OUTLINE_PATIENCE_MS) for row in rows}
    return [name for name in shapes.OUTLINES if 4 * last.get(name, 0) < OUTLINE_PATIENCE_MS]


def _of_size(
    size: int, runs: int, outlines: Sequence[str], rows: list[dict[str, Any]]
) -> Generator[Stage, None, None]:
    """Time everything at one size in turn and append the shapes' rows."""
    yield Stage(0.0, f"masks of {size}²")
    grid = Grid((size, size), (WIDTH / size, WIDTH / size))
    tasks: dict[str, Task] = {}
    for name in shapes.OUTLINES:
        opening, outline = shapes.raster(name, size), shapes.outline(name)
        tasks[f"{name}, mask"] = lambda opening=opening: _power(opening, grid)  # type: ignore[misc]
        if name in outlines:
            tasks[f"{name}, outline"] = lambda outline=outline: _power(outline, grid, OUTLINES)  # type: ignore[misc]
    mask = shapes.mask("heptagon", size)
    tasks[FRACTIONAL] = lambda: fractional_near(mask, WIDTH, DISTANCE, WAVELENGTH)
    tasks[DISCRETE] = lambda: transfer_function(mask, WIDTH, DISTANCE, WAVELENGTH)
    if size <= FRAMED:
        tasks[EIGHT] = lambda: transfer_function(mask, WIDTH, DISTANCE, WAVELENGTH, FRAME)
    times = yield from alternate(tasks, runs, label=f"{size}²,")
    shared = {"fractional_ms": times[FRACTIONAL], "discrete_ms": times[DISCRETE]}
    if EIGHT in times:
        shared["framed_ms"] = times[EIGHT]
    for name in shapes.OUTLINES:
        own = {
            f"{kind}_ms": times[key] for kind in ("mask", "outline") if (key := f"{name}, {kind}") in times
        }
        rows.append({"size": size, "aperture": name} | own | shared | _printed(name, size))


def _power(aperture: Any, grid: Grid, method: str = "auto") -> object:
    return diffraction.near_power(aperture, grid, DISTANCE, WAVELENGTH, method)


def _printed(name: str, size: int) -> dict[str, float]:
    if size not in SIZES:
        return {}
    index = SIZES.index(size)
    found = {
        "printed_ms": PRINTED_MS[name][index],
        "printed_fractional_ms": PRINTED_FRACTIONAL_MS[index],
    }
    if index < len(PRINTED_DISCRETE_MS):
        found["printed_discrete_ms"] = PRINTED_DISCRETE_MS[index]
    return found
