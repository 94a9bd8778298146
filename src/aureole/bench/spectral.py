"""Table 3 of the quad paper: the spectral sum, every wavelength by itself or in batches."""

from collections.abc import Generator, Iterator, Sequence
from typing import Any

from aureole import diffraction, light, picture
from aureole.bench import shapes
from aureole.bench.report import Column, Table
from aureole.bench.timing import alternate
from aureole.records import Grid, Pattern, Stage

SIZES = (256, 512, 1024, 2048, 4096)
# Table 3, as printed: milliseconds on a GeForce GTX 1080 Ti.
PRINTED_MS = {
    "full": (0.040, 0.127, 0.530, 1.960, 8.180),
    "batch": (0.019, 0.038, 0.114, 0.430, 1.710),
}
# The paper's reference wavelength: the geometric mean of 400 and 700 nm.
REFERENCE_WAVELENGTH = 529e-9
COLUMNS = (
    Column("size", "{size}²"),
    Column("method", "{method}", words=True),
    Column("here", "{median_ms:.1f} ms"),
    Column("gain", "{gain:.1f}x"),
    Column("GTX 1080 Ti", "{printed_ms:.3f} ms"),
    Column("its gain", "{printed_gain:.1f}x"),
    Column("PSNR to full", "{psnr:.0f} dB"),
    Column("log-PSNR", "{log_psnr:.1f} dB"),
)
NOTES = (
    "The heptagon's pattern at 529 nm summed over 60 wavelengths to XYZ, light E; 'batch' takes 4 + 15.",
    "GTX 1080 Ti: as the paper prints, with its own gain. PSNR and log-PSNR of Y against 'full', the latter "
    "over ten decades.",
)


def table_3(sizes: Sequence[int], runs: int) -> Iterator[Stage]:
    """Time the spectral sum's methods.

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
        found: list[dict[str, Any]] = []
        for stage in _of_size(size, runs, found):
            yield Stage((index + stage.fraction) / len(sizes), stage.label)
        rows += found
    yield Stage(
        1.0, "spectral sum", (Table("table-3", "Table 3: spectral sum", COLUMNS, tuple(rows), NOTES),)
    )


def _of_size(size: int, runs: int, rows: list[dict[str, Any]]) -> Generator[Stage, None, None]:
    """Time all methods at one size and append their rows."""
    yield Stage(0.0, f"pattern of {size}²")
    pattern = heptagon_pattern(size)
    lamp = light.illuminant("E")
    methods = [name for name in light.METHODS if name != "reference"]
    tasks = {name: lambda name=name: light.spectral_sum(pattern, None, lamp, name) for name in methods}
    times = yield from alternate(tasks, runs, label=f"{size}²,")
    truth = light.spectral_sum(pattern, None, lamp, "full").pixels[..., 1]
    for name, spent in times.items():
        row = {"size": size, "method": name, "median_ms": spent, "gain": times["full"] / spent}
        if name != "full":
            found = light.spectral_sum(pattern, None, lamp, name).pixels[..., 1]
            row["psnr"] = float(picture.psnr(found, truth))
            row["log_psnr"] = float(picture.log_psnr(found, truth))
        rows.append(row | _printed(name, size))


def heptagon_pattern(size: int) -> Pattern:
    """Return the heptagon's power at the reference wavelength, at the transform's own spacing.

    Parameters
    ----------
    size : int
        Samples on each side.

    Returns
    -------
    Pattern
        Of a window of width 1.
    """
    grid = Grid((size, size), (1.0, 1.0))
    power = diffraction.far_power(shapes.outline("heptagon"), grid)
    return Pattern(power, grid, REFERENCE_WAVELENGTH, float(power.sum()))


def _printed(name: str, size: int) -> dict[str, Any]:
    if size not in SIZES or name not in PRINTED_MS:
        return {}
    index = SIZES.index(size)
    printed = PRINTED_MS[name][index]
    return {"printed_ms": printed, "printed_gain": PRINTED_MS["full"][index] / printed}
