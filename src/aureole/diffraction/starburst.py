"""A whole starburst: the far field's energy over all wavelengths, in XYZ.

The plane is measured in direction cosines s = sin θ (on a sensor s = x / f), so that one grid serves
every wavelength: the frequency there is s / λ. The energy fraction at s per unit of s is
|F(s/λ)|² / (λ² ∬|f|²), and it sums to 1 over the infinite plane at every wavelength.

"exact" transforms every wavelength at its own scale. "scaled" transforms once and looks the others
up at scaled places (quad paper Eq. 14-16), finely sampled in the core, where fringes are wide, and
on the pixels themselves outside it. "coherence" keeps that core and sums all wavelengths in closed form
outside it, for outlines of straight edges.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import light, refuse
from aureole.diffraction import autocorrelation, coherence
from aureole.diffraction.far import MOST_EDGES, check_grid, far_field
from aureole.diffraction.polygons import add_polygons_power
from aureole.records import Aperture, Grid, Pattern, Picture, Spectrum, Stage

Outer = Callable[[Aperture, Grid, Spectrum, str], NDArray[np.float32]]
METHODS = ("auto", "exact", "scaled", "coherence")
SAMPLES = ("area", "point")
SHORTEST, LONGEST = 380e-9, 780e-9
REFERENCE_WAVELENGTH = math.sqrt(SHORTEST * LONGEST)
EXACT_WAVELENGTHS = 81
CORE_WAVELENGTHS = 81
OUTER_WAVELENGTHS = 161
# The core reaches so many of the pattern's finest fringes, and at least so many pixels; its pattern has
# so many samples a fringe, fewer where it would have more than MOST_FINE along its radius.
CORE_CYCLES = 16.0
CORE_PIXELS = 16
FINE_SAMPLES = 12.0
COARSEST_SAMPLES = 1.5
MOST_FINE = 2048
# Up to so many Gauss-Legendre nodes a pixel are worth their accuracy; where fringes are more, midpoints do.
MOST_NODES = 12
MIDPOINTS = 4.0
# A pixel of more fringes than this holds all but a trace of the energy: what the others leave.
MOST_FRINGES = MOST_FINE / (COARSEST_SAMPLES * FINE_SAMPLES)
# Outside the core a pixel is sampled no finer than this along each axis.
MOST_OUTER_NODES = 6
# One wavelength by itself may cost more, and most in the pixels about the axis.
MOST_EXACT_NODES, MOST_CORE_NODES, EXACT_CORE = 24, 256, (1.5, 1.5)
# Edges times samples that an outer pattern may cost before its pixels are sampled more coarsely.
OUTER_BUDGET = 3e9


def starburst(
    aperture: Aperture, grid: Grid, spectrum: Spectrum, method: str = "auto", sample: str = "area"
) -> Picture:
    """Return the starburst of an aperture for light of a spectrum.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster, at its size in metres.
    grid : Grid
        Direction cosines; the spacing is the pixel pitch over the focal length.
    spectrum : Spectrum
        The light's.
    method : str
        "exact", every wavelength transformed; "scaled", one transform looked up at scaled places;
        "coherence", all wavelengths in closed form, for straight edges; "auto" is exact for few lines and
        for wavefronts, coherent where that serves, and scaled elsewhere.
    sample : str
        "area", the integral over each pixel; "point", the density at its centre times its area.

    Returns
    -------
    Picture
        XYZ, shape (rows, columns, 3), the energy fraction of each pixel weighted by the observer: over
        the infinite plane it sums to the spectrum's white with Y = 1.

    Raises
    ------
    refuse.Refusal
        Where the grid, the method or the sampling does not fit.
    """
    for stage in starburst_stages(aperture, grid, spectrum, method, sample):
        picture = stage.result
    assert isinstance(picture, Picture)
    return picture


def starburst_stages(
    aperture: Aperture, grid: Grid, spectrum: Spectrum, method: str = "auto", sample: str = "area"
) -> Iterator[Stage]:
    """Do what `starburst` does, telling how far it is.

    Parameters
    ----------
    aperture : Aperture
        As in `starburst`.
    grid : Grid
        As in `starburst`.
    spectrum : Spectrum
        As in `starburst`.
    method : str
        As in `starburst`.
    sample : str
        As in `starburst`.

    Yields
    ------
    Stage
        The last one holds the picture.
    """
    check_grid(grid)
    refuse.one_of("method", method, METHODS)
    refuse.one_of("sample", sample, SAMPLES)
    if method == "auto":
        method = _choose(aperture, spectrum)
    if aperture.wavefront is not None and method != "exact":
        raise refuse.Refusal(
            f"method '{method}' takes one pattern for all wavelengths and this aperture has a wavefront, "
            "whose phase is another at each; use method 'exact'."
        )
    if method == "exact":
        yield from _exact(aperture, grid, spectrum, sample)
    else:
        outer = _coherent if method == "coherence" else _outer
        yield from _with_core(aperture, grid, spectrum, sample, outer)


def _choose(aperture: Aperture, spectrum: Spectrum) -> str:
    if aperture.wavefront is not None:
        return "exact"
    if spectrum.kind == "lines" and len(spectrum.wavelengths) <= 8:
        return "exact"
    return "coherence" if coherence.serves(aperture, spectrum) else "scaled"


def _exact(aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str) -> Iterator[Stage]:
    wavelengths, weights = light.quadrature(spectrum, EXACT_WAVELENGTHS)
    total = np.zeros((*grid.shape, 3))
    for index, (wavelength, weight) in enumerate(zip(wavelengths, weights, strict=True)):
        yield Stage(index / len(wavelengths), f"starburst at {wavelength * 1e9:.0f} nm")
        total += _fractions(aperture, grid, float(wavelength), sample)[..., None] * weight
    if sample == "area":
        _leave_rest_to_axis(aperture, grid, spectrum, total)
    yield Stage(1.0, "starburst", Picture(total.astype(np.float32), "xyz"))


def _with_core(
    aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str, outer: Outer
) -> Iterator[Stage]:
    yield Stage(0.0, "starburst's core")
    core_grid = _core_grid(aperture, grid)
    core = _core(aperture, core_grid, spectrum, sample)
    yield Stage(0.2, "starburst's rays")
    total = outer(aperture, grid, spectrum, sample)
    yield Stage(0.9, "starburst, joining the two")
    _join(total, core, grid, core_grid, _core_reach(aperture, grid))
    if sample == "area":
        _leave_rest_to_axis(aperture, grid, spectrum, total)
    yield Stage(1.0, "starburst", Picture(total, "xyz"))


def _core_reach(aperture: Aperture, grid: Grid) -> tuple[float, float]:
    """Return the core's radius in pixels, along rows and columns."""
    reaches = []
    for spacing in grid.spacing:
        fringes = aperture.width * spacing / SHORTEST
        wanted = max(CORE_CYCLES / fringes, CORE_PIXELS)
        # A pixel of very many fringes leaves room for few pixels.
        reaches.append(max(1.5, min(wanted, MOST_FINE / (FINE_SAMPLES * fringes))))
    return reaches[0], reaches[1]


def _core_grid(aperture: Aperture, grid: Grid, reaches: tuple[float, float] | None = None) -> Grid:
    """Return the pixels of a grid within a radius about the axis, in pixels; the core's unless given."""
    shape, centre = [], []
    reaches = _core_reach(aperture, grid) if reaches is None else reaches
    for count, spacing, middle, reach in zip(grid.shape, grid.spacing, grid.centre, reaches, strict=True):
        first = -(count // 2) + middle / spacing
        low = max(0, math.floor(-reach - first))
        high = min(count, math.ceil(reach - first) + 1)
        length = max(high - low, 0)
        shape.append(length)
        centre.append((first + low + length // 2) * spacing)
    return Grid((shape[0], shape[1]), grid.spacing, (centre[0], centre[1]))


def _core(aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str) -> NDArray[np.float32]:
    """Sum the wavelengths from a pattern that samples every fringe finely."""
    if 0 in grid.shape:
        return np.zeros((*grid.shape, 3), dtype=np.float32)
    wavelength = REFERENCE_WAVELENGTH
    pattern = _fine_pattern(aperture, grid, wavelength)
    counts = _node_counts(aperture, grid, SHORTEST, sample)
    if max(counts) > MOST_NODES:
        total = _mean_of_midpoints(pattern, grid, spectrum, _midpoint_counts(aperture, grid))
    else:
        total = np.zeros((*grid.shape, 3), dtype=np.float32)
        for shifted, weight in _shifted(grid, counts):
            total += weight * _summed(pattern, shifted, spectrum, CORE_WAVELENGTHS)
    return total * _pixel_share(aperture, grid, wavelength)


def _fine_pattern(aperture: Aperture, grid: Grid, wavelength: float) -> Pattern:
    """Return a pattern that reaches as far as the shortest wavelength looks, and two samples more."""
    steps, counts = [], []
    for axis, spacing in zip(grid.axes(), grid.spacing, strict=True):
        reach = (np.abs(axis).max() + spacing / 2) / SHORTEST
        step = max(1 / (FINE_SAMPLES * aperture.width), reach / MOST_FINE)
        steps.append(min(step, 1 / (COARSEST_SAMPLES * aperture.width)))
        counts.append(2 * (math.ceil(reach / steps[-1]) + 2) + 1)
    fine = Grid((counts[0], counts[1]), (steps[0], steps[1]))
    return Pattern(_centred_mean(aperture, fine, (1, 1)), fine, wavelength, apertures.energy(aperture))


def _midpoint_counts(aperture: Aperture, grid: Grid) -> tuple[int, int]:
    """Return how many midpoints along each axis follow a pixel's many fringes."""
    rows, columns = (
        max(1, min(math.ceil(MIDPOINTS * aperture.width * spacing / SHORTEST), 2 * MOST_FINE // count))
        for spacing, count in zip(grid.spacing, grid.shape, strict=True)
    )
    return rows, columns


def _mean_of_midpoints(
    pattern: Pattern, grid: Grid, spectrum: Spectrum, counts: tuple[int, int]
) -> NDArray[np.float32]:
    """Sum the wavelengths at the midpoints of equal parts of each pixel, and average."""
    (rows, columns), (many_y, many_x) = grid.shape, counts
    fine = (grid.spacing[0] / many_y, grid.spacing[1] / many_x)
    first = [
        axis[0] - pixel / 2 + step / 2
        for axis, pixel, step in zip(grid.axes(), grid.spacing, fine, strict=True)
    ]
    shape = (rows * many_y, columns * many_x)
    centre = (float(first[0] + shape[0] // 2 * fine[0]), float(first[1] + shape[1] // 2 * fine[1]))
    values = _summed(pattern, Grid(shape, fine, centre), spectrum, CORE_WAVELENGTHS)
    parts = values.reshape(rows, many_y, columns, many_x, 3)
    return np.asarray(parts.mean(axis=(1, 3)), dtype=np.float32)


def _outer(aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str) -> NDArray[np.float32]:
    """Sum the wavelengths from a pattern on the pixels themselves, each sampled at a few nodes."""
    wavelength = REFERENCE_WAVELENGTH
    stretch = wavelength / SHORTEST
    spacing = (grid.spacing[0] / wavelength, grid.spacing[1] / wavelength)
    counts = [
        2 * (math.ceil(np.abs(axis).max() / step * stretch) + 1) + 1
        for axis, step in zip(grid.axes(), grid.spacing, strict=True)
    ]
    wide = Grid((counts[0], counts[1]), spacing)
    nodes = _node_counts(aperture, grid, wavelength, sample, _most_nodes(aperture, wide))
    pattern = Pattern(_centred_mean(aperture, wide, nodes), wide, wavelength, apertures.energy(aperture))
    total = _summed(pattern, grid, spectrum, OUTER_WAVELENGTHS)
    return total * _pixel_share(aperture, grid, wavelength)


def _coherent(aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str) -> NDArray[np.float32]:
    """Sum all wavelengths in closed form, half the plane where the other half mirrors it."""
    wavelength = REFERENCE_WAVELENGTH
    pixel = (grid.spacing[0] / wavelength, grid.spacing[1] / wavelength) if sample == "area" else (0.0, 0.0)
    (rows, columns), mirrored = grid.shape, grid.centre == (0.0, 0.0)
    part = _ending_at_axis(Grid((rows // 2 + 1, columns // 2 * 2 + 1), grid.spacing)) if mirrored else grid
    total = coherence.coherent_power(aperture, _in_frequency(part, wavelength), wavelength, spectrum, pixel)
    if mirrored:
        lower = total[1 - rows % 2 : rows // 2][::-1, ::-1]
        total = np.concatenate([total[:, :columns], lower[:, :columns]])
    return total * _pixel_share(aperture, grid, wavelength)


def _join(
    total: NDArray[np.float32],
    core: NDArray[np.float32],
    grid: Grid,
    part: Grid,
    reach: tuple[float, float],
) -> None:
    """Lay the core over the rest, fading from one to the other in the outer third of its radius."""
    if not core.size:
        return
    rows, columns = part.axes()
    top, left = _place(part, grid)
    radius = np.hypot(rows[:, None] / (reach[0] * grid.spacing[0]), columns / (reach[1] * grid.spacing[1]))
    share = np.clip((1 - radius) * 3, 0, 1)
    blend = (share * share * (3 - 2 * share)).astype(np.float32)[..., None]
    window = total[top : top + part.shape[0], left : left + part.shape[1]]
    # Where the core alone counts, the closed form may be as large as 1 / |q|⁴ makes it.
    outside = np.where(blend == 1, core, window)
    window[...] = outside + blend * (core - outside)


def _place(part: Grid, grid: Grid) -> tuple[int, int]:
    """Return the row and column of a grid at which a part of it begins."""
    if not all(part.shape):
        return 0, 0
    (rows, columns), (all_rows, all_columns) = part.axes(), grid.axes()
    top = (rows[0] - all_rows[0]) / grid.spacing[0]
    left = (columns[0] - all_columns[0]) / grid.spacing[1]
    return round(top), round(left)


def _leave_rest_to_axis(
    aperture: Aperture, grid: Grid, spectrum: Spectrum, total: NDArray[np.floating]
) -> None:
    """Give the pixel on the axis what the others leave, where pixels hold very many fringes."""
    (rows, columns), spacing = grid.axes(), grid.spacing
    row, column = int(np.argmin(np.abs(rows))), int(np.argmin(np.abs(columns)))
    on_axis = abs(rows[row]) < 0.25 * spacing[0] and abs(columns[column]) < 0.25 * spacing[1]
    if min(spacing) * aperture.width / SHORTEST > MOST_FRINGES and on_axis:
        total[row, column] = 0
        total[row, column] = np.maximum(light.white(spectrum) - total.sum(axis=(0, 1)), 0)


def _fractions(aperture: Aperture, grid: Grid, wavelength: float, sample: str) -> NDArray[np.float32]:
    """Return each pixel's share of the energy at one wavelength."""
    if aperture.wavefront is not None and sample == "area":
        mean = autocorrelation.mean_power(aperture, _in_frequency(grid, wavelength), wavelength)
        return mean * _pixel_share(aperture, grid, wavelength)
    mean = _mean_power(aperture, grid, wavelength, sample, MOST_EXACT_NODES)
    if max(_node_counts(aperture, grid, wavelength, sample)) > MOST_EXACT_NODES:
        # Fewer nodes do outside the core, where many fringes are alike.
        part = _core_grid(aperture, grid, EXACT_CORE)
        top, left = _place(part, grid)
        accurate = _mean_power(aperture, part, wavelength, sample, MOST_CORE_NODES)
        mean[top : top + part.shape[0], left : left + part.shape[1]] = accurate
    return mean * _pixel_share(aperture, grid, wavelength)


def _mean_power(
    aperture: Aperture, grid: Grid, wavelength: float, sample: str, most: int
) -> NDArray[np.float32]:
    mean = np.zeros(grid.shape, dtype=np.float32)
    if mean.size:
        for shifted, weight in _shifted(grid, _node_counts(aperture, grid, wavelength, sample, most)):
            _add_power(aperture, _in_frequency(shifted, wavelength), weight, mean, wavelength)
    return mean


def _pixel_share(aperture: Aperture, grid: Grid, wavelength: float) -> np.float32:
    """Return what turns |F|² into a pixel's share of the energy: its area over λ² ∬|f|²."""
    pixel = grid.spacing[0] * grid.spacing[1]
    return np.float32(pixel / (wavelength**2 * apertures.energy(aperture)))


def _node_counts(
    aperture: Aperture, grid: Grid, wavelength: float, sample: str, most: int = 1 << 30
) -> tuple[int, int]:
    """Return how many Gauss-Legendre nodes integrate the fringes across a pixel, by rows and columns.

    |F|² has no fringe finer than the width allows: c = width × pixel / λ cycles in a pixel. Gauss's
    rule follows them from π c / 2 nodes on; three more bring the error below 1e-4.
    """
    if sample == "point":
        return 1, 1
    cycles = [aperture.width * spacing / wavelength for spacing in grid.spacing]
    rows, columns = (min(most, math.ceil(math.pi * c / 2) + 3) for c in cycles)
    return rows, columns


def _most_nodes(aperture: Aperture, grid: Grid) -> int:
    edges = sum(len(ring.vertices) * (8 if np.any(ring.bulges) else 1) for ring in aperture.outlines)
    samples = grid.shape[0] * grid.shape[1] / 2 * max(edges, 8)
    return max(2, min(MOST_OUTER_NODES, int(math.sqrt(OUTER_BUDGET / samples))))


def _shifted(grid: Grid, counts: tuple[int, int]) -> Iterator[tuple[Grid, float]]:
    """Yield the grid moved to each node of a Gauss-Legendre rule over its pixel, with the weight."""
    (nodes_y, weights_y), (nodes_x, weights_x) = (np.polynomial.legendre.leggauss(n) for n in counts)
    for node_y, weight_y in zip(nodes_y, weights_y, strict=True):
        for node_x, weight_x in zip(nodes_x, weights_x, strict=True):
            y = grid.centre[0] + node_y / 2 * grid.spacing[0]
            x = grid.centre[1] + node_x / 2 * grid.spacing[1]
            yield Grid(grid.shape, grid.spacing, (float(y), float(x))), float(weight_y * weight_x / 4)


def _centred_mean(aperture: Aperture, grid: Grid, counts: tuple[int, int]) -> NDArray[np.float32]:
    """Return the mean of |F|² over each pixel of an odd, centred grid in frequency.

    |F(−q)|² = |F(q)|² for a real aperture, so the upper half is computed and turned.
    """
    rows, columns = grid.shape
    upper = _ending_at_axis(Grid((rows // 2 + 1, columns), grid.spacing))
    mean = np.zeros(upper.shape, dtype=np.float32)
    for shifted, weight in _shifted(upper, counts):
        _add_power(aperture, shifted, weight, mean)
    return np.concatenate([mean, mean[-2::-1, ::-1]])


def _ending_at_axis(grid: Grid) -> Grid:
    """Return the grid moved along y so that its last row lies at zero."""
    last = (grid.shape[0] - 1 - grid.shape[0] // 2) * grid.spacing[0]
    return Grid(grid.shape, grid.spacing, (-last, grid.centre[1]))


def _add_power(
    aperture: Aperture,
    grid: Grid,
    weight: float,
    mean: NDArray[np.float32],
    wavelength: float | None = None,
) -> None:
    """Add weight × |F|² at the samples of a grid in frequency; a wavefront needs the wavelength."""
    edges = sum(len(ring.vertices) for ring in aperture.outlines)
    if aperture.mask is None and edges <= MOST_EDGES:
        add_polygons_power(aperture, grid, weight, mean)
        return
    amplitude = far_field(aperture, grid, wavelength=wavelength).amplitude
    mean += np.float32(weight) * np.asarray(amplitude.real**2 + amplitude.imag**2, dtype=np.float32)


def _summed(pattern: Pattern, grid: Grid, spectrum: Spectrum, samples: int) -> NDArray[np.float32]:
    """Sum a pattern over wavelengths at the pixels of a grid in direction cosines."""
    frequencies = _in_frequency(grid, pattern.wavelength)
    picture = light.spectral_sum(
        pattern,
        pattern.wavelength,
        spectrum,
        grid=frequencies,
        samples=samples,
        interpolation="cubic",
        symmetric=grid.centre == (0.0, 0.0),
    )
    return picture.pixels


def _in_frequency(grid: Grid, wavelength: float) -> Grid:
    """Return the frequencies s / λ of a grid in direction cosines."""
    (step_y, step_x), (y, x) = grid.spacing, grid.centre
    return Grid(grid.shape, (step_y / wavelength, step_x / wavelength), (y / wavelength, x / wavelength))
