"""Figures 8 and 9 of the quad paper: how close coarse quadtrees come to the brute-force transform."""

from collections.abc import Generator, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import diffraction, light, picture
from aureole.bench import shapes
from aureole.bench.report import Column, Table
from aureole.bench.spectral import REFERENCE_WAVELENGTH
from aureole.bench.timing import alternate
from aureole.diffraction.quads import quads_field
from aureole.records import Aperture, Grid, Pattern, Stage

LEVELS = ("full", "half", "quarter")
# What SSIM compares: so many decades of the logarithm, as the paper's pictures are scaled to be seen.
DECADES = 10.0
QUALITY = (
    Column("PSNR", "{psnr:.1f} dB"),
    Column("SSIM", "{ssim:.4f}"),
    Column("log-PSNR", "{log_psnr:.1f} dB"),
    Column("log SSIM", "{log_ssim:.4f}"),
)
COLUMNS_8 = (Column("aperture", "{aperture}", words=True), Column("finest", "{finest}", words=True), *QUALITY)
COLUMNS_9 = (
    Column("finest", "{finest}", words=True),
    Column("light", "{light}", words=True),
    Column("quads", "{quads}"),
    Column("transform", "{median_ms:.1f} ms"),
    *QUALITY,
)
HOW = (
    "Power at as many frequencies as pixels, against direct sums over the full mask in float64. PSNR and "
    "SSIM are of the power itself, of the peak; log-PSNR and log SSIM of its logarithm over ten decades."
)
NOTES_8 = (
    HOW,
    "The paper prints its SSIM and PSNR inside the pictures of Figure 8 and calls the differences marginal "
    "(section 5.1); how it scaled the pictures is not said.",
)
NOTES_9 = (
    HOW,
    "Printed: one step coarser is a negligible visual difference and twice as fast (Figure 9, GeForce GTX "
    "1080 Ti).",
)


def figure_8(size: int) -> Iterator[Stage]:
    """Compare the levels on four apertures at one wavelength.

    Parameters
    ----------
    size : int
        Pixels and frequencies on each side.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    for index, name in enumerate(shapes.OUTLINES):
        yield Stage(index / len(shapes.OUTLINES), f"quality, {name}")
        mask, grid = shapes.mask(name, size), _grid(size)
        truth = brute_force(mask, grid)
        for level in LEVELS:
            found = power(quads_field(diffraction.quadtree(mask, 1.0, level), grid))
            rows.append({"aperture": name, "finest": level} | compared(found, truth))
    title = f"Figure 8: far fields from quads, {size}²"
    yield Stage(1.0, "quality", (Table("figure-8", title, COLUMNS_8, tuple(rows), NOTES_8),))


def figure_9(size: int, runs: int) -> Iterator[Stage]:
    """Compare the levels on the heptagon at one wavelength and in white light, with their time.

    Parameters
    ----------
    size : int
        Pixels and frequencies on each side.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    yield from _levels(size, runs, rows)
    title = f"Figure 9: quadtree levels of the heptagon, {size}²"
    yield Stage(1.0, "levels", (Table("figure-9", title, COLUMNS_9, tuple(rows), NOTES_9),))


def _levels(size: int, runs: int, rows: list[dict[str, Any]]) -> Generator[Stage, None, None]:
    mask, grid = shapes.mask("heptagon", size), _grid(size)
    quads = {level: diffraction.quadtree(mask, 1.0, level) for level in LEVELS}
    tasks = {level: lambda level=level: power(quads_field(quads[level], grid)) for level in LEVELS}
    times = yield from alternate(tasks, runs, label="level")
    truth = brute_force(mask, grid)
    white_truth = _white(truth, grid)
    for level in LEVELS:
        found = power(quads_field(quads[level], grid))
        row = {"finest": level, "quads": len(quads[level]), "median_ms": times[level]}
        rows.append(row | {"light": "one wavelength"} | compared(found, truth))
        rows.append({"finest": level, "light": "white"} | compared(_white(found, grid), white_truth))


def brute_force(mask: NDArray[np.float32], grid: Grid) -> NDArray[np.float64]:
    """Return the power of a mask by direct sums over its pixels.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Transmittance, in a window of width 1.
    grid : Grid
        Frequencies.

    Returns
    -------
    ndarray of float64, shape (rows, columns)
        Squared amplitude.
    """
    found: NDArray[np.float64] = diffraction.far_power(Aperture(1.0, mask=mask), grid, "reference")
    return found


def compared(found: NDArray[Any], truth: NDArray[Any]) -> dict[str, float]:
    """Return how close a power comes to the truth, linear and logarithmic.

    Parameters
    ----------
    found, truth : ndarray, shape (rows, columns)
        Power.

    Returns
    -------
    dict
        psnr, ssim, log_psnr, log_ssim.
    """
    peak = truth.max()
    logarithms = [np.log10(np.maximum(each / peak, 10.0**-DECADES)) / DECADES + 1 for each in (found, truth)]
    return {
        "psnr": float(picture.psnr(found, truth)),
        "ssim": float(picture.ssim(found, truth)),
        "log_psnr": float(picture.log_psnr(found, truth)),
        "log_ssim": float(picture.ssim(logarithms[0], logarithms[1], 1.0)),
    }


def power(amplitude: NDArray[Any]) -> NDArray[Any]:
    """Return squared amplitudes.

    Parameters
    ----------
    amplitude : ndarray, complex
        Any shape.

    Returns
    -------
    ndarray
        Real, same shape.
    """
    return np.asarray(amplitude.real**2 + amplitude.imag**2)


def _white(values: NDArray[Any], grid: Grid) -> NDArray[np.float32]:
    """Return Y of a power in white light."""
    pattern = Pattern(values.astype(np.float32), grid, REFERENCE_WAVELENGTH, float(values.sum()))
    return light.spectral_sum(pattern, None, light.illuminant("E")).pixels[..., 1]


def _grid(size: int) -> Grid:
    return Grid((size, size), (1.0, 1.0))
