"""The near field in colour: Fresnel diffraction for all wavelengths of a light.

"exact" computes every wavelength anew (quad paper §4.5, Eq. 18 for dispersive samples, Figure 7a). What
does not depend on the wavelength is found once.

"approximate" looks one wavelength's pattern up at places that hardly move with the others (Figure 7b). It
looks plausible, is many times faster, and is not physically accurate.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import light, refuse
from aureole.diffraction.far import RASTER_SIZE, check_grid
from aureole.diffraction.near import NearOperator
from aureole.diffraction.near_pixels import unfolded
from aureole.diffraction.near_sums import sum_for
from aureole.records import Aperture, Grid, Pattern, Picture, Spectrum, Stage

METHODS = ("exact", "approximate")
STRENGTH = 0.05
# The reference wavelength of "approximate" is the geometric mean of these, or of the light's own within.
LOW, HIGH = 400e-9, 700e-9
# Wavelengths of "exact" where none are asked for: so many to each √(λz) of the longest way from an edge.
FEWEST, MOST = 30, 160
TO_A_ZONE = 3.2
# Wavelengths of "approximate": a step moves the pattern by about a sample at the rim. Five go together.
FEWEST_STRETCHED, MOST_STRETCHED, TOGETHER = 10, 60, 5
# Pixels a side by which it sees outlines, at least: what that leaves is less than its own error.
FEWEST_PIXELS = 256
# A stretched pattern may reach beyond the plane by so many times its samples.
MOST_BEYOND = 8
# The observer's range.
SEEN = (360e-9, 830e-9)


def near_picture(
    aperture: Aperture,
    grid: Grid,
    distance: float,
    spectrum: Spectrum,
    method: str = "exact",
    samples: int | None = None,
    raster_size: int = RASTER_SIZE,
    finest: str = "full",
    field_method: str = "auto",
    reference_wavelength: float | None = None,
    strength: float = STRENGTH,
) -> Picture:
    """Return the irradiance behind an aperture in colour, lit by a plane wave of a spectrum (Fresnel).

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster, at its size in metres.
    grid : Grid
        Places on the plane in metres; any spacing, any centre, odd and even sizes.
    distance : float
        Of the plane from the aperture, metres.
    spectrum : Spectrum
        The light's. One of kind "lines" gives its own wavelengths.
    method : {"exact", "approximate"}
        "exact", each wavelength anew (quad paper Eq. 18); "approximate", the pattern at one wavelength,
        looked up at places scaled about the axis by 1 + strength (1 − ρ), ρ = λ_r / λ (quad paper §4.5,
        Figure 7b): plausible, and not physically accurate.
    samples : int, optional
        Number of wavelengths over 380 to 780 nm. None takes as many as the plane needs, see Notes.
    raster_size : int
        As for `near_field`.
    finest : str
        As for `near_field`.
    field_method : str
        The near field's method, as for `near_field`; but "auto" of "approximate" sees outlines that are no
        circles as pixels, as wide as the plane's samples are apart and at least 256 a side, up to
        `raster_size`. "polygons" takes them exactly.
    reference_wavelength : float, optional
        λ_r of "approximate" in metres. None is the geometric mean of 400 and 700 nm, 529 nm, or of the
        light's own ends within them; a single line's is itself.
    strength : float
        Of "approximate", −1 to 1: 0.05 is the paper's, 0 is one pattern for all wavelengths, and −1 makes
        the scale ρ, the far field's, which is wrong here (Figure 7c).

    Returns
    -------
    Picture
        XYZ, shape (rows, columns, 3); its metadata names the light's white. Where nothing blocks the wave
        it is that white, with luminance 1.

    Raises
    ------
    refuse.Refusal
        Where the grid, the distance, a method, the number of samples or the scaling does not fit.

    Notes
    -----
    At d from an edge the fringes of two wavelengths are out of step by d²/(2λz) · Δλ/λ periods, so that the
    colours wash out far from the edges, and too few wavelengths leave false fringes there, faint ones.
    None takes 3.2 wavelengths to each √(λz) of the longest way from an edge to a place on the plane, at
    least 30 and at most 160. For a heptagon on a plane of twice its width, at Fresnel numbers of 30, 100 and
    300, that leaves an error of about 0.05, 0.15 and 0.1 % of the white (RMS), where 30 wavelengths leave
    0.4, 0.5 and 0.5 %, and single places up to 5 % (`benchmarks/near_field_colour.py --wavelengths`).

    "approximate" keeps the white: the light's where nothing blocks the wave, and so not each wavelength's
    energy, which changes by the square of the scale, 4 % at most with the paper's strength.
    """
    stages = near_picture_stages(
        aperture,
        grid,
        distance,
        spectrum,
        method,
        samples,
        raster_size,
        finest,
        field_method,
        reference_wavelength,
        strength,
    )
    for stage in stages:
        picture = stage.result
    assert isinstance(picture, Picture)
    return picture


def near_picture_stages(
    aperture: Aperture,
    grid: Grid,
    distance: float,
    spectrum: Spectrum,
    method: str = "exact",
    samples: int | None = None,
    raster_size: int = RASTER_SIZE,
    finest: str = "full",
    field_method: str = "auto",
    reference_wavelength: float | None = None,
    strength: float = STRENGTH,
) -> Iterator[Stage]:
    """Do what `near_picture` does, telling how far it is.

    Parameters
    ----------
    aperture : Aperture
        As in `near_picture`.
    grid : Grid
        As in `near_picture`.
    distance : float
        Metres.
    spectrum : Spectrum
        As in `near_picture`.
    method : str
        As in `near_picture`.
    samples : int, optional
        As in `near_picture`.
    raster_size : int
        As in `near_picture`.
    finest : str
        As in `near_picture`.
    field_method : str
        As in `near_picture`.
    reference_wavelength : float, optional
        As in `near_picture`.
    strength : float
        As in `near_picture`.

    Yields
    ------
    Stage
        The last one holds the picture.

    Raises
    ------
    refuse.Refusal
        As `near_picture`.
    """
    check_grid(grid)
    refuse.positive("distance", distance)
    refuse.one_of("method", method, METHODS)
    if samples is not None:
        refuse.at_least("samples", samples, 1)
    light.white(spectrum)
    if method == "exact":
        operator = NearOperator(aperture, grid, field_method, raster_size, finest)
        yield from _exact(operator, distance, spectrum, samples)
        return
    refuse.between("strength", strength, -1, 1)
    wavelength = _reference_wavelength(spectrum, reference_wavelength)
    rule = _Stretch(wavelength, strength, spectrum)
    wide = rule.plane(grid)
    yield Stage(0.0, f"near field at {wavelength * 1e9:.0f} nm")
    if field_method == "auto" and _is_worth_pixels(aperture):
        field_method, raster_size = "rows", _pixels(aperture, grid, raster_size)
    operator = NearOperator(aperture, wide, field_method, raster_size, finest)
    power = operator.power(distance, wavelength)
    yield Stage(0.7, "near field's colours")
    pattern = Pattern(power.astype(np.float32, copy=False), wide, wavelength, 0.0)
    count = rule.samples(grid) if samples is None else samples
    mirrored = _mirrored(operator, pattern.intensity)
    yield Stage(1.0, "near field", _stretched(pattern, spectrum, rule, grid, count, mirrored))


def _is_worth_pixels(aperture: Aperture) -> bool:
    """Say whether an aperture has outlines within its width that are not circles, which are quick."""
    if aperture.mask is not None or all(apertures.as_circle(ring) for ring in aperture.outlines):
        return False
    return apertures.bounding_radius(aperture) <= math.sqrt(0.5) * aperture.width * (1 + 1e-6)


def _pixels(aperture: Aperture, grid: Grid, most: int) -> int:
    """Return how many pixels a side are as wide as the plane's samples are apart."""
    wanted = math.ceil(min(aperture.width / min(grid.spacing), float(most)))
    return min(max(FEWEST_PIXELS, wanted), most)


def wavelengths_needed(aperture: Aperture, grid: Grid, distance: float, wavelength: float) -> int:
    """Return how many wavelengths over 380 to 780 nm the colours of a near field ask for.

    Parameters
    ----------
    aperture : Aperture
        Of which the width counts.
    grid : Grid
        Metres.
    distance, wavelength : float
        Metres.

    Returns
    -------
    int
        30 to 160.
    """
    farthest = max(float(np.abs(axis).max()) for axis in grid.axes()) + aperture.width / 2
    zones = farthest / math.sqrt(wavelength * distance)
    return min(max(FEWEST, math.ceil(TO_A_ZONE * zones)), MOST)


def _exact(
    operator: NearOperator, distance: float, spectrum: Spectrum, samples: int | None
) -> Iterator[Stage]:
    """Add up the powers of all wavelengths."""
    if samples is None:
        middle = _reference_wavelength(spectrum, None)
        samples = wavelengths_needed(operator.aperture, operator.grid, distance, middle)
    wavelengths, weights = light.quadrature(spectrum, samples)
    total = sum_for(operator)
    for first in range(0, len(wavelengths), total.at_once):
        yield Stage(first / len(wavelengths), f"near field at {wavelengths[first] * 1e9:.0f} nm")
        batch = slice(first, first + total.at_once)
        total.add(distance, wavelengths[batch], weights[batch])
    yield Stage(1.0, "near field", light.in_white_of(spectrum, total.pixels()))


def _stretched(
    pattern: Pattern, spectrum: Spectrum, rule: "_Stretch", grid: Grid, samples: int, mirrored: list[bool]
) -> Picture:
    """Look a pattern up, on a part of the plane along the axes where it is its own mirror image."""
    middle = tuple(n // 2 if alike else -1 for n, alike in zip(grid.shape, mirrored, strict=True))
    shape = tuple(n // 2 + 1 if alike else n for n, alike in zip(grid.shape, mirrored, strict=True))
    # A part that starts on the axis has its middle so many samples beyond.
    centre = tuple(
        n // 2 * step if alike else where
        for n, step, alike, where in zip(shape, grid.spacing, mirrored, grid.centre, strict=True)
    )
    part = Grid((shape[0], shape[1]), grid.spacing, (centre[0], centre[1]))
    picture = light.stretched_sum(pattern, spectrum, rule.scales, part, samples)
    return replace(picture, pixels=unfolded(picture.pixels, (middle[0], middle[1]), grid.shape))


def _mirrored(operator: NearOperator, power: NDArray[np.float32]) -> list[bool]:
    """Say along which axes, y and x, a plane is its own mirror image."""
    factors = operator.prepared.get("factors")
    return [
        centre == 0
        and (_is_mirrored(power, axis) if factors is None else not any(each.odd[axis] for each in factors))
        for axis, centre in enumerate(operator.grid.centre)
    ]


def _is_mirrored(power: NDArray[np.float32], axis: int) -> bool:
    """Say whether a plane about the axis is its own mirror image, to the last digit, along one axis."""
    along = np.moveaxis(power, axis, 0)
    middle = len(along) // 2
    after = along[middle + 1 :]
    return np.array_equal(after, along[middle - len(after) : middle][::-1])


class _Stretch:
    """The rule by which "approximate" scales one wavelength's pattern for another."""

    def __init__(self, wavelength: float, strength: float, spectrum: Spectrum) -> None:
        self._strength = strength
        lines = spectrum.wavelengths[[0, -1]]
        ends = lines if spectrum.kind == "lines" else light.lit_range(spectrum, *SEEN)
        scales = self.scales(wavelength / np.array(ends))
        self._low, self._high = float(scales.min()), float(scales.max())
        if self._low <= 0:
            raise refuse.Refusal(
                f"'strength' {strength:g} scales the pattern by {self._low:g} at one end of the spectrum; "
                "use one nearer to 0."
            )

    def scales(self, ratios: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return 1 + strength (1 − ρ)."""
        return np.asarray(1 + self._strength * (1 - ratios))

    def plane(self, grid: Grid) -> Grid:
        """Return a plane with the same samples and as many more as hold every place that is looked up."""
        beyond = [self._beyond(axis, step) for axis, step in zip(grid.axes(), grid.spacing, strict=True)]
        rows, columns = (count + 2 * more for count, more in zip(grid.shape, beyond, strict=True))
        if rows * columns > MOST_BEYOND * (grid.shape[0] * grid.shape[1] + 64):
            raise refuse.Refusal(
                "method 'approximate' scales about the axis, from which this plane is too far; use 'exact'."
            )
        return Grid((rows, columns), grid.spacing, grid.centre)

    def samples(self, grid: Grid) -> int:
        """Return how many wavelengths move the pattern by about a sample from one to the next."""
        reach = max(
            float(np.abs(axis).max()) / step for axis, step in zip(grid.axes(), grid.spacing, strict=True)
        )
        wanted = TOGETHER * round(reach * (self._high - self._low) / TOGETHER)
        return min(max(FEWEST_STRETCHED, wanted), MOST_STRETCHED)

    def _beyond(self, axis: NDArray[np.float64], step: float) -> int:
        """Return by how many samples the look-ups leave an axis, and a neighbour to interpolate with."""
        first, last = float(axis[0]), float(axis[-1])
        low = min(first * self._low, first * self._high)
        high = max(last * self._low, last * self._high)
        return math.ceil(max(first - low, high - last) / step) + 2


def _reference_wavelength(spectrum: Spectrum, given: float | None) -> float:
    """Return the wavelength asked for, or the geometric mean of the light's ends."""
    if given is not None:
        return refuse.positive("reference_wavelength", given)
    if spectrum.kind == "lines":
        low, high = float(spectrum.wavelengths[0]), float(spectrum.wavelengths[-1])
    else:
        low, high = light.lit_range(spectrum, LOW, HIGH)
    return math.sqrt(low) * math.sqrt(high)
