"""The core of a starburst: few pixels about the axis, where fringes are wide and each of them counts.

A pattern at one wavelength samples every fringe finely and is looked up for all wavelengths at the nodes
that integrate each pixel. `join` lays the core over what was computed for the whole plane.
"""

import math

import numpy as np
from numpy.typing import NDArray

from aureole import light
from aureole.diffraction import pixels
from aureole.diffraction.pixels import REFERENCE_WAVELENGTH, SHORTEST
from aureole.records import Aperture, Grid, Pattern, Spectrum

WAVELENGTHS = 81
# A pattern has so many samples a fringe, fewer where it would have more than MOST_FINE along its radius.
FINE_SAMPLES = 12.0
COARSEST_SAMPLES = 1.5
MOST_FINE = 2048
# Up to so many Gauss-Legendre nodes a pixel are worth their accuracy; where fringes are more, midpoints do.
MOST_NODES = 12
MIDPOINTS = 4.0
# A pixel of more fringes than this holds all but a trace of the energy: what the others leave.
MOST_FRINGES = MOST_FINE / (COARSEST_SAMPLES * FINE_SAMPLES)


def reach(aperture: Aperture, grid: Grid, cycles: float, fewest: float) -> tuple[float, float]:
    """Return the core's radius in pixels, along rows and columns.

    Parameters
    ----------
    aperture : Aperture
        Any.
    grid : Grid
        Direction cosines.
    cycles : float
        It should reach so many of the pattern's finest fringes,
    fewest : float
        and at least so many pixels.

    Returns
    -------
    tuple of float
        (rows, columns).
    """
    reaches = []
    for spacing in grid.spacing:
        fringes = aperture.width * spacing / SHORTEST
        wanted = max(cycles / fringes, fewest)
        # A pixel of very many fringes leaves room for few pixels.
        reaches.append(max(1.5, min(wanted, MOST_FINE / (FINE_SAMPLES * fringes))))
    return reaches[0], reaches[1]


def part_within(grid: Grid, reaches: tuple[float, float]) -> Grid:
    """Return the pixels of a grid within a radius about the axis.

    Parameters
    ----------
    grid : Grid
        Direction cosines.
    reaches : tuple of float
        Radius in pixels, along rows and columns.

    Returns
    -------
    Grid
        Of no pixels where the axis is farther away.
    """
    shape, centre = [], []
    for count, spacing, middle, radius in zip(grid.shape, grid.spacing, grid.centre, reaches, strict=True):
        first = -(count // 2) + middle / spacing
        low = max(0, math.floor(-radius - first))
        high = min(count, math.ceil(radius - first) + 1)
        length = max(high - low, 0)
        shape.append(length)
        place = first + low + length // 2
        centre.append(0.0 if abs(place) < 1e-9 else place * spacing)
    return Grid((shape[0], shape[1]), grid.spacing, (centre[0], centre[1]))


def from_pattern(aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str) -> NDArray[np.float32]:
    """Sum the wavelengths from a pattern that samples every fringe finely.

    Parameters
    ----------
    aperture : Aperture
        Any.
    grid : Grid
        Direction cosines.
    spectrum : Spectrum
        The light's.
    sample : str
        "area" or "point".

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        XYZ shares of energy.
    """
    if 0 in grid.shape:
        return np.zeros((*grid.shape, 3), dtype=np.float32)
    pattern = _fine_pattern(aperture, grid, REFERENCE_WAVELENGTH)
    counts = pixels.node_counts(aperture, grid, SHORTEST, sample)
    if max(counts) <= MOST_NODES:
        rules = [np.polynomial.legendre.leggauss(count) for count in counts]
        places, weights = [nodes / 2 for nodes, _ in rules], [weights / 2 for _, weights in rules]
    else:
        counts = _midpoint_counts(aperture, grid)
        places = [(np.arange(count) + 0.5) / count - 0.5 for count in counts]
        weights = [np.full(count, 1 / count) for count in counts]
    frequencies = pixels.in_frequency(grid, REFERENCE_WAVELENGTH)
    axes = [
        (axis[:, None] + place * spacing).ravel()
        for axis, place, spacing in zip(frequencies.axes(), places, frequencies.spacing, strict=True)
    ]
    values = _summed(pattern, spectrum, axes[0], axes[1])
    (rows, columns), (many_y, many_x) = grid.shape, counts
    parts = values.reshape(rows, many_y, columns, many_x, 3)
    mean = np.einsum("aibjc,i,j->abc", parts, *(weight.astype(np.float32) for weight in weights))
    return np.asarray(mean * np.float32(pixels.share(aperture, grid, REFERENCE_WAVELENGTH)))


def join(
    total: NDArray[np.float32],
    core: NDArray[np.floating],
    grid: Grid,
    part: Grid,
    reaches: tuple[float, float],
) -> None:
    """Lay the core over the rest, fading from one to the other in the outer third of its radius.

    Parameters
    ----------
    total : ndarray of float32, shape (rows, columns, 3)
        The plane, written in place.
    core : ndarray of float32, shape (r, c, 3)
        The core.
    grid, part : Grid
        Direction cosines of the plane and of the core.
    reaches : tuple of float
        The core's radius in pixels, along rows and columns.
    """
    if not core.size:
        return
    rows, columns = part.axes()
    top, left = place(part, grid)
    radius = np.hypot(
        rows[:, None] / (reaches[0] * grid.spacing[0]), columns / (reaches[1] * grid.spacing[1])
    )
    share = np.clip((1 - radius) * 3, 0, 1)
    blend = (share * share * (3 - 2 * share)).astype(np.float32)[..., None]
    window = total[top : top + part.shape[0], left : left + part.shape[1]]
    # Where the core alone counts, the closed form may be as large as 1 / |q|⁴ makes it.
    outside = np.where(blend == 1, core, window)
    window[...] = outside + blend * (core - outside)


def place(part: Grid, grid: Grid) -> tuple[int, int]:
    """Return the row and column of a grid at which a part of it begins.

    Parameters
    ----------
    part, grid : Grid
        Direction cosines.

    Returns
    -------
    tuple of int
        (row, column); zeros for a part without pixels.
    """
    if not all(part.shape):
        return 0, 0
    (rows, columns), (all_rows, all_columns) = part.axes(), grid.axes()
    top = (rows[0] - all_rows[0]) / grid.spacing[0]
    left = (columns[0] - all_columns[0]) / grid.spacing[1]
    return round(top), round(left)


def leave_rest_to_axis(
    aperture: Aperture, grid: Grid, spectrum: Spectrum, total: NDArray[np.floating]
) -> None:
    """Give the pixel on the axis what the others leave, where pixels hold very many fringes.

    Parameters
    ----------
    aperture : Aperture
        Any.
    grid : Grid
        Direction cosines.
    spectrum : Spectrum
        The light's.
    total : ndarray, shape (rows, columns, 3)
        Written in place.
    """
    (rows, columns), spacing = grid.axes(), grid.spacing
    row, column = int(np.argmin(np.abs(rows))), int(np.argmin(np.abs(columns)))
    on_axis = abs(rows[row]) < 0.25 * spacing[0] and abs(columns[column]) < 0.25 * spacing[1]
    if min(spacing) * aperture.width / SHORTEST > MOST_FRINGES and on_axis:
        total[row, column] = 0
        total[row, column] = np.maximum(light.white(spectrum) - total.sum(axis=(0, 1)), 0)


def _fine_pattern(aperture: Aperture, grid: Grid, wavelength: float) -> Pattern:
    """Return a pattern that reaches as far as the shortest wavelength looks, and two samples more."""
    steps, counts = [], []
    for axis, spacing in zip(grid.axes(), grid.spacing, strict=True):
        farthest = (np.abs(axis).max() + spacing / 2) / SHORTEST
        step = max(1 / (FINE_SAMPLES * aperture.width), farthest / MOST_FINE)
        steps.append(min(step, 1 / (COARSEST_SAMPLES * aperture.width)))
        counts.append(2 * (math.ceil(farthest / steps[-1]) + 2) + 1)
    fine = Grid((counts[0], counts[1]), (steps[0], steps[1]))
    return Pattern(pixels.centred_mean(aperture, fine, (1, 1)), fine, wavelength, pixels.energy(aperture))


def _midpoint_counts(aperture: Aperture, grid: Grid) -> tuple[int, int]:
    """Return how many midpoints along each axis follow a pixel's many fringes."""
    rows, columns = (
        max(1, min(math.ceil(MIDPOINTS * aperture.width * spacing / SHORTEST), 2 * MOST_FINE // count))
        for spacing, count in zip(grid.spacing, grid.shape, strict=True)
    )
    return rows, columns


def _summed(
    pattern: Pattern, spectrum: Spectrum, rows: NDArray[np.float64], columns: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Sum a pattern's wavelengths, half of the samples where the other half mirrors them."""
    half = len(rows) // 2 + len(rows) % 2
    if np.allclose(rows, -rows[::-1]) and np.allclose(columns, -columns[::-1]):
        upper = light.spectral_sum_at(pattern, spectrum, rows[:half], columns, WAVELENGTHS, "cubic")
        return np.concatenate([upper, upper[: len(rows) - half][::-1, ::-1]])
    return light.spectral_sum_at(pattern, spectrum, rows, columns, WAVELENGTHS, "cubic")
