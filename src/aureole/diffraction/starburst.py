"""A whole starburst: the far field's energy over all wavelengths, in XYZ.

The plane is measured in direction cosines s = sin θ (on a sensor s = x / f), so that one grid serves
every wavelength: the frequency there is s / λ. The energy fraction at s per unit of s is
|F(s/λ)|² / (λ² ∬|f|²), and it sums to 1 over the infinite plane at every wavelength.

"exact" transforms every wavelength at its own scale. "scaled" transforms once and looks the others
up at scaled places (quad paper Eq. 14-16), finely sampled in the core, where fringes are wide, and
on the pixels themselves outside it. "batch" does the same with the paper's two passes of look-ups, fewer
and faster and not so fine. "coherence" keeps that core and sums all wavelengths in closed form
outside it, for outlines of straight edges.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse
from aureole.diffraction import autocorrelation, coherence, core, discs, pixels
from aureole.diffraction.far import check_grid
from aureole.diffraction.pixels import REFERENCE_WAVELENGTH, SHORTEST, node_counts
from aureole.records import Aperture, Grid, Pattern, Picture, Spectrum, Stage

Way = Callable[[Aperture, Grid, Spectrum, str], Iterator[Stage]]
METHODS = ("auto", "exact", "scaled", "batch", "coherence")
SAMPLES = ("area", "point")
EXACT_WAVELENGTHS = 81
OUTER_WAVELENGTHS, BATCH_WAVELENGTHS = 161, 60
# The core of "scaled" reaches so many of the pattern's finest fringes, and at least so many pixels;
# that of "coherence" can be smaller, in a ring of finely divided pixels.
SCALED_CORE = (16.0, 16)
COHERENT_CORE = (5.0, 5)
RING, DIVISION = 16.0, 5
# A disc-shaped light is spread on the pixels out to so many of its radii.
DISC_REACH = 24.0
# Outside the core a pixel is sampled no finer than this along each axis.
MOST_OUTER_NODES = 6
# One wavelength by itself may cost more, and most in the pixels about the axis.
MOST_EXACT_NODES, MOST_CORE_NODES, EXACT_CORE = 24, 256, (1.5, 1.5)
# Edges times samples that an outer pattern may cost before its pixels are sampled more coarsely.
OUTER_BUDGET = 3e9


def starburst(
    aperture: Aperture,
    grid: Grid,
    spectrum: Spectrum,
    method: str = "auto",
    sample: str = "area",
    light_radius: float = 0.0,
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
        "batch", so with the quad paper's 4 + 15 look-ups for 60 wavelengths;
        "coherence", all wavelengths in closed form, for straight edges; "auto" is exact for few lines and
        for wavefronts, coherent where that serves, and scaled elsewhere.
    sample : str
        "area", the integral over each pixel; "point", the density at its centre times its area.
    light_radius : float
        Of a disc-shaped light, in direction cosines: the sine of half the angle that it subtends. 0 is a
        point.

    Returns
    -------
    Picture
        XYZ, shape (rows, columns, 3), the energy fraction of each pixel weighted by the observer: over
        the infinite plane it sums to the spectrum's white with Y = 1.

    Raises
    ------
    refuse.Refusal
        Where the grid, the method, the sampling or the light's size does not fit.
    """
    for stage in starburst_stages(aperture, grid, spectrum, method, sample, light_radius):
        picture = stage.result
    assert isinstance(picture, Picture)
    return picture


def starburst_stages(
    aperture: Aperture,
    grid: Grid,
    spectrum: Spectrum,
    method: str = "auto",
    sample: str = "area",
    light_radius: float = 0.0,
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
    light_radius : float
        As in `starburst`.

    Yields
    ------
    Stage
        The last one holds the picture.
    """
    check_grid(grid)
    refuse.one_of("method", method, METHODS)
    refuse.one_of("sample", sample, SAMPLES)
    refuse.between("light_radius", light_radius, 0, 1)
    if light_radius and sample == "point":
        raise refuse.Refusal("a light with a size is averaged over pixels; use sample 'area'.")
    if method == "auto":
        method = _choose(aperture, spectrum)
    if aperture.wavefront is not None and method != "exact":
        raise refuse.Refusal(
            f"method '{method}' takes one pattern for all wavelengths and this aperture has a wavefront, "
            "whose phase is another at each; use method 'exact'."
        )
    if light_radius:
        yield from _of_disc(aperture, grid, spectrum, method, light_radius)
        return
    ways: dict[str, Way] = {"exact": _exact, "scaled": _scaled, "batch": _batch, "coherence": _coherent}
    yield from ways[method](aperture, grid, spectrum, sample)


def _of_disc(
    aperture: Aperture, grid: Grid, spectrum: Spectrum, method: str, radius: float
) -> Iterator[Stage]:
    """Spread a point light's starburst over a disc, outside the core within the closed form itself."""

    def point(part: Grid) -> NDArray[np.floating]:
        return starburst(aperture, part, spectrum, method).pixels

    yield Stage(0.0, "starburst of a disc")
    if method != "coherence":
        pixels_of_disc = discs.spread(point, grid, radius)
        yield Stage(1.0, "starburst", Picture(pixels_of_disc.astype(np.float32, copy=False), "xyz"))
        return
    total = _closed_form(aperture, grid, spectrum, "area", radius)
    yield Stage(0.4, "starburst's core")
    # The closed form takes all but its waves as constant over the disc, which holds far from it.
    reach = (
        max(RING, DISC_REACH * radius / grid.spacing[0]),
        max(RING, DISC_REACH * radius / grid.spacing[1]),
    )
    part = core.part_within(grid, reach)
    if 0 not in part.shape:
        core.join(total, discs.spread_on_parts(point, part, radius), grid, part, reach)
    yield Stage(1.0, "starburst", Picture(total, "xyz"))


def _choose(aperture: Aperture, spectrum: Spectrum) -> str:
    if aperture.wavefront is not None:
        return "exact"
    if spectrum.kind == "lines" and len(spectrum.wavelengths) <= 8:
        return "exact"
    return "coherence" if coherence.serves(aperture, spectrum) else "scaled"


def _exact(aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str) -> Iterator[Stage]:
    """Transform every wavelength at its own scale."""
    wavelengths, weights = light.quadrature(spectrum, EXACT_WAVELENGTHS)
    total = np.zeros((*grid.shape, 3))
    for index, (wavelength, weight) in enumerate(zip(wavelengths, weights, strict=True)):
        yield Stage(index / len(wavelengths), f"starburst at {wavelength * 1e9:.0f} nm")
        total += _fractions(aperture, grid, float(wavelength), sample)[..., None] * weight
    yield _finished(aperture, grid, spectrum, sample, total)


def _scaled(
    aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str, method: str = "auto"
) -> Iterator[Stage]:
    """Look all wavelengths up in one pattern, and in a finer one in the core."""
    yield Stage(0.0, "starburst's core")
    reach = core.reach(aperture, grid, *SCALED_CORE)
    part = core.part_within(grid, reach)
    middle = core.from_pattern(aperture, part, spectrum, sample)
    yield Stage(0.2, "starburst's rays")
    total = _outer(aperture, grid, spectrum, sample, method)
    core.join(total, middle, grid, part, reach)
    yield _finished(aperture, grid, spectrum, sample, total)


def _batch(aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str) -> Iterator[Stage]:
    """Do what `_scaled` does with the look-ups of the quad paper's Fig. 4."""
    if spectrum.kind == "lines":
        raise refuse.Refusal("method 'batch' needs a light that is not made of lines; use method 'exact'.")
    yield from _scaled(aperture, grid, spectrum, sample, "batch")


def _coherent(aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str) -> Iterator[Stage]:
    """Sum all wavelengths in closed form, on divided pixels about the axis, and look the core up."""
    yield Stage(0.0, "starburst's rays")
    total = _closed_form(aperture, grid, spectrum, sample)
    yield Stage(0.7, "starburst's core")
    inner = core.reach(aperture, grid, *COHERENT_CORE)
    if sample == "area":
        ring = core.part_within(grid, (RING, RING))
        core.join(total, _divided(aperture, ring, spectrum), grid, ring, (RING, RING))
    part = core.part_within(grid, inner)
    core.join(total, core.from_pattern(aperture, part, spectrum, sample), grid, part, inner)
    yield _finished(aperture, grid, spectrum, sample, total)


def _finished(
    aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str, total: NDArray[np.floating]
) -> Stage:
    if sample == "area":
        core.leave_rest_to_axis(aperture, grid, spectrum, total)
    return Stage(1.0, "starburst", Picture(total.astype(np.float32, copy=False), "xyz"))


def _outer(
    aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str, method: str
) -> NDArray[np.float32]:
    """Sum the wavelengths from a pattern on the pixels themselves, each sampled at a few nodes."""
    wavelength = REFERENCE_WAVELENGTH
    stretch = wavelength / SHORTEST
    counts = [
        2 * (math.ceil(np.abs(axis).max() / step * stretch) + 1) + 1
        for axis, step in zip(grid.axes(), grid.spacing, strict=True)
    ]
    wide = pixels.in_frequency(Grid((counts[0], counts[1]), grid.spacing), wavelength)
    nodes = node_counts(aperture, grid, wavelength, sample, _most_nodes(aperture, wide))
    power = pixels.centred_mean(aperture, wide, nodes)
    picture = light.spectral_sum(
        Pattern(power, wide, wavelength, pixels.energy(aperture)),
        wavelength,
        spectrum,
        method,
        grid=pixels.in_frequency(grid, wavelength),
        samples=BATCH_WAVELENGTHS if method == "batch" else OUTER_WAVELENGTHS,
        interpolation="cubic",
        symmetric=grid.centre == (0.0, 0.0),
    )
    return picture.pixels * np.float32(pixels.share(aperture, grid, wavelength))


def _closed_form(
    aperture: Aperture, grid: Grid, spectrum: Spectrum, sample: str, light_radius: float = 0.0
) -> NDArray[np.float32]:
    """Sum all wavelengths in closed form."""
    wavelength = REFERENCE_WAVELENGTH
    frequencies = pixels.in_frequency(grid, wavelength)
    pixel = frequencies.spacing if sample == "area" else (0.0, 0.0)
    scale = pixels.share(aperture, grid, wavelength)
    return coherence.coherent_power(
        aperture, frequencies, wavelength, spectrum, pixel, light_radius / wavelength, scale
    )


def _divided(aperture: Aperture, grid: Grid, spectrum: Spectrum) -> NDArray[np.floating]:
    """Sum all wavelengths in closed form on equal parts of each pixel."""
    if 0 in grid.shape:
        return np.zeros((*grid.shape, 3), dtype=np.float32)
    fine = pixels.divided(grid, DIVISION)
    return pixels.gathered(_closed_form(aperture, fine, spectrum, "area"), DIVISION)


def _fractions(aperture: Aperture, grid: Grid, wavelength: float, sample: str) -> NDArray[np.float32]:
    """Return each pixel's share of the energy at one wavelength."""
    if aperture.wavefront is not None and sample == "area":
        mean = autocorrelation.mean_power(aperture, pixels.in_frequency(grid, wavelength), wavelength)
        return mean * np.float32(pixels.share(aperture, grid, wavelength))
    mean = _mean_power(aperture, grid, wavelength, sample, MOST_EXACT_NODES)
    if max(node_counts(aperture, grid, wavelength, sample)) > MOST_EXACT_NODES:
        # Fewer nodes do outside the core, where many fringes are alike.
        part = core.part_within(grid, EXACT_CORE)
        top, left = core.place(part, grid)
        accurate = _mean_power(aperture, part, wavelength, sample, MOST_CORE_NODES)
        mean[top : top + part.shape[0], left : left + part.shape[1]] = accurate
    return mean * np.float32(pixels.share(aperture, grid, wavelength))


def _mean_power(
    aperture: Aperture, grid: Grid, wavelength: float, sample: str, most: int
) -> NDArray[np.float32]:
    mean = np.zeros(grid.shape, dtype=np.float32)
    if mean.size:
        for moved, weight in pixels.shifted(grid, node_counts(aperture, grid, wavelength, sample, most)):
            pixels.add_power(aperture, pixels.in_frequency(moved, wavelength), weight, mean, wavelength)
    return mean


def _most_nodes(aperture: Aperture, grid: Grid) -> int:
    edges = sum(len(ring.vertices) * (8 if np.any(ring.bulges) else 1) for ring in aperture.outlines)
    samples = grid.shape[0] * grid.shape[1] / 2 * max(edges, 8)
    return max(2, min(MOST_OUTER_NODES, int(math.sqrt(OUTER_BUDGET / samples))))
