"""From photographs of a flat sample to its diffraction pattern on a uniform grid of h.

In: a bracket under one narrow band and a small lamp (surface paper, section 4.3). Black level and merge,
the zero order's place, each pixel's h from real positions, and one resampling, so that the table's sums
along rows and columns are separable.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.records import Spectrum, Stage
from aureole.surface.bandwidth import sharpen_stages
from aureole.surface.centre import Centre, find_centre
from aureole.surface.geometry import Geometry, farthest_h, pixel_map
from aureole.surface.hdr_merge import merge
from aureole.surface.pattern import DiffractionPattern
from aureole.surface.period import order_notes, period_of
from aureole.surface.response import Response

MOST_SAMPLES = 4097  # along an axis
# Pixels, standard deviation: between a sharp lens and one of a pixel, as cameras with a colour mosaic blur.
TYPICAL_BLUR = 0.7
FLAT_SMOOTHING = 100.0  # a picture's side over the radius over which a flat field is smoothed
BRIGHT = 3.0  # times the photograph's noise from which something in it is light
# Shares of the time that merging, finding the centre and resampling take, of a bracket of six.
MERGING, FINDING, RESAMPLING, ITERATION = 0.4, 0.5, 0.3, 0.2


@dataclass(frozen=True, eq=False)
class Processing:
    """How photographs become a pattern.

    Parameters
    ----------
    black : float, sequence of array_like, or str
        As for `merge`.
    saturation : float or None
        As for `merge`.
    read_noise, gain : float
        As for `merge`.
    response : Response or None
        As for `merge`: of files that are not linear in light.
    flat : array_like of shape (rows, columns), or None
        A linear photograph of an evenly lit white sheet, black level taken off: the lens's falling off to
        the corners, which is divided out. The lamp's own falling off is the geometry's, not this one's.
    centre : tuple of float or str
        The zero order's (row, column), or a method of `find_centre`.
    irradiance : float
        E on the sample at the zero order, in the photographs' radiance; 1 leaves the scale relative.
    reflectance : float
        Fresnel factor F_0 at normal incidence that was in the measurement, and is divided out.
    band : Spectrum or None
        Lamp × filter × sensor, whose width is undone by `sharpen`; None takes it as one wavelength.
    blur : float or None
        Standard deviation, in pixels, of the lens's Gaussian blur that is undone. None is `TYPICAL_BLUR`
        where a band is given, so that what is sharpened is sharpened whole, and otherwise 0.
    power : float
        Exponent of the model, which undoing a band's width needs: 4 phase, 2 amplitude.
    iterations : int
        Of `sharpen`.
    period : float, sequence of two floats, or None
        A known period in metres of the sample, along both directions or along tangent and bitangent, against
        which the orders are checked; None does not know.
    half_range : float or None
        h · t and h · b of the outermost samples; None covers the whole photograph.
    size : int or None
        Samples along each axis; None keeps the step of the photograph's central pixels.
    name : str
        What to call it in reports.
    """

    black: float | Sequence[ArrayLike] | str = 0.0
    saturation: float | None = None
    read_noise: float = 1.0
    gain: float = 1.0
    response: Response | None = None
    flat: ArrayLike | None = None
    centre: tuple[float, float] | str = "auto"
    irradiance: float = 1.0
    reflectance: float = 1.0
    band: Spectrum | None = None
    blur: float | None = None
    power: float = 4.0
    iterations: int = 10
    period: float | Sequence[float] | None = None
    half_range: float | None = None
    size: int | None = None
    name: str = "measured"


def measure_pattern(
    photos: ArrayLike | Sequence[ArrayLike],
    exposures: Sequence[float] | float,
    geometry: Geometry,
    wavelength: float,
    **processing: Any,
) -> DiffractionPattern:
    """Measure a flat sample's diffraction pattern from photographs under one narrow band.

    Parameters
    ----------
    photos : array_like of shape (rows, columns), or sequence of them
        One linear HDR photograph, or a bracket.
    exposures : float or sequence of float
        Of each photograph, in seconds or relative.
    geometry : BenchGeometry or UniformGeometry
        Where camera and lamp stood.
    wavelength : float
        Metres: the band's.
    **processing : dict
        What `Processing` has: black, saturation, read_noise, gain, response, flat, centre, irradiance,
        reflectance, band, blur, power, iterations, period, half_range, size, name.

    Returns
    -------
    DiffractionPattern
        M(h) = L(h) / (4 π² F_0² E(h)) by Eq. 14, zero where the photograph does not reach. Its metadata say
        where the zero order was found ("centre", "centre_method", "symmetry") and how large a share of the
        pixels all exposures clipped ("saturated_share"); the "period" along tangent and bitangent in metres,
        None without orders, and the number of "orders"; and under "notes" what the orders have against
        wavelength and geometry.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described, the photographs are dark, or the zero order lies outside them.
    """
    for stage in measure_pattern_stages(photos, exposures, geometry, wavelength, **processing):
        last = stage
    pattern: DiffractionPattern = last.result
    return pattern


def measure_pattern_stages(
    photos: ArrayLike | Sequence[ArrayLike],
    exposures: Sequence[float] | float,
    geometry: Geometry,
    wavelength: float,
    **processing: Any,
) -> Iterator[Stage]:
    """Do what `measure_pattern` does, with a stage before every step.

    Parameters
    ----------
    photos : array_like of shape (rows, columns), or sequence of them
        As for `measure_pattern`, and so are the others.
    exposures : float or sequence of float
        Of each photograph.
    geometry : BenchGeometry or UniformGeometry
        Where camera and lamp stood.
    wavelength : float
        Metres.
    **processing : dict
        What `Processing` has.

    Yields
    ------
    Stage
        The last one holds the pattern.
    """
    how = _processing(processing)
    bracket, times = _bracket(photos, exposures)
    wavelength = refuse.positive("wavelength", wavelength)
    scale = (
        refuse.positive("irradiance", how.irradiance) * refuse.positive("reflectance", how.reflectance) ** 2
    )
    work = MERGING + FINDING + RESAMPLING + _iterations(how) * ITERATION
    yield Stage(0.0, "merging photographs")
    merged = merge(bracket, times, how.black, how.saturation, how.read_noise, how.gain, how.response)
    values = _evened(merged.values, how.flat)
    _refuse_darkness(values)
    yield Stage(MERGING / work, "finding the zero order")
    place = locate(values, how.centre)
    yield Stage((MERGING + FINDING) / work, "resampling over directions")
    where = (place.row, place.column)
    even, reach, seen = resample(values, geometry, where, how.half_range, how.size)
    radiance = np.maximum(even, 0.0) / (4.0 * math.pi**2 * scale)
    told = {
        "centre": list(where),
        "centre_method": place.method,
        "symmetry": place.symmetry,
        "saturated_share": float(merged.saturated.mean()),
    }
    pattern = DiffractionPattern(radiance.astype(np.float32), reach, wavelength, how.name, told)
    if _iterations(how):
        before = MERGING + FINDING + RESAMPLING
        blur = _blur(how) * farthest_h(geometry, where, _shape(values))[1]
        for stage in sharpen_stages(pattern, how.band, how.power, blur, how.iterations, seen):
            if stage.result is None:
                yield Stage((before + stage.fraction * (work - before)) / work, stage.label)
        pattern = stage.result
    yield Stage(1.0, "pattern", _checked(pattern, how, seen))


def locate(photo: NDArray[np.float64], centre: tuple[float, float] | str) -> Centre:
    """Take the zero order's place as given, or find it.

    Parameters
    ----------
    photo : ndarray of float64, shape (rows, columns)
        Linear.
    centre : tuple of float or str
        (row, column), or a method of `find_centre`.

    Returns
    -------
    Centre
        The place.

    Raises
    ------
    refuse.Refusal
        Where it lies outside the photograph.
    """
    if isinstance(centre, str):
        return find_centre(photo, centre)
    row, column = (
        refuse.between(f"centre ({axis})", place, 0.0, count - 1.0)
        for axis, place, count in zip(("row", "column"), centre, photo.shape, strict=True)
    )
    return Centre(row, column, "given")


def resample(
    photo: NDArray[np.float64],
    geometry: Geometry,
    centre: tuple[float, float],
    half_range: float | None = None,
    size: int | None = None,
) -> tuple[NDArray[np.float64], float, NDArray[np.bool_]]:
    """Resample a photograph onto a uniform grid of h, its irradiance made even.

    Parameters
    ----------
    photo : ndarray of float64, shape (rows, columns)
        Linear.
    geometry : Geometry
        Where camera and lamp stood.
    centre : tuple of float
        The zero order's (row, column).
    half_range : float or None
        h of the outermost samples; None covers the whole photograph.
    size : int or None
        Samples along each axis; None keeps the step of the central pixels.

    Returns
    -------
    values : ndarray of float64, shape (size, size)
        Cubic splines through the photograph's samples; zero outside it.
    half_range : float
        h of the outermost samples.
    seen : ndarray of bool, shape (size, size)
        Where the photograph reaches.

    Raises
    ------
    refuse.Refusal
        Where the grid would have too many samples, or h reaches beyond 2.
    """
    from scipy.ndimage import map_coordinates

    farthest, step = farthest_h(geometry, centre, _shape(photo))
    if half_range is None:
        reach = min(farthest, 2.0)
        # A whole number of steps to either side keeps the centre a sample.
        reach = max(1, math.ceil(reach / step - 1e-6)) * step if size is None else reach
    else:
        reach = refuse.between("half_range", half_range, 1e-9, 2.0)
    count = (
        2 * max(1, math.ceil(reach / step - 1e-6)) + 1 if size is None else refuse.at_least("size", size, 2)
    )
    if count > MOST_SAMPLES:
        raise refuse.Refusal(
            f"The pattern would have {count} samples along each axis, {MOST_SAMPLES} are allowed;"
            " give 'half_range' or 'size'."
        )
    axis = np.linspace(-reach, reach, count)
    rows, columns, irradiance = pixel_map(geometry, centre, _shape(photo), axis)
    values = map_coordinates(photo, [rows, columns], order=3, mode="mirror")
    inside = (rows >= -0.5) & (rows <= photo.shape[0] - 0.5) & (columns >= -0.5)
    inside &= (columns <= photo.shape[1] - 0.5) & (irradiance > 0)
    return np.divide(values, irradiance, out=np.zeros_like(values), where=inside), reach, inside


def _bracket(
    photos: ArrayLike | Sequence[ArrayLike], exposures: Sequence[float] | float
) -> tuple[list[ArrayLike], list[float]]:
    """Take one photograph as a bracket of one."""
    if isinstance(exposures, int | float | np.number):
        exposures = [float(exposures)]
    if isinstance(photos, np.ndarray) and photos.ndim == 2:
        return [photos], list(exposures)
    return list(photos), list(exposures)  # type: ignore[arg-type]


def _shape(photo: NDArray[np.float64]) -> tuple[int, int]:
    return photo.shape[0], photo.shape[1]


def _checked(pattern: DiffractionPattern, how: Processing, seen: NDArray[np.bool_]) -> DiffractionPattern:
    """Add to a pattern what its orders say."""
    rows = period_of(pattern, seen)
    found = {
        "period": [None if row is None else row.period for row in rows],
        "orders": [0 if row is None else row.orders for row in rows],
        "notes": list(order_notes(pattern, how.period, seen=seen)),
    }
    return replace(pattern, metadata={**pattern.metadata, **found})


def _processing(options: dict[str, Any]) -> Processing:
    """Take options as a `Processing`."""
    known = [field.name for field in fields(Processing)]
    for key in options:
        if key not in known:
            raise refuse.unknown_key("measurement", key, known)
    return replace(Processing(), **options)


def _blur(how: Processing) -> float:
    """Return the blur to undo, in pixels."""
    if how.blur is None:
        return 0.0 if how.band is None else TYPICAL_BLUR
    return refuse.between("blur", how.blur, 0.0, 100.0)


def _iterations(how: Processing) -> int:
    """Return how many iterations sharpen, none where there is nothing to undo."""
    return 0 if how.band is None and _blur(how) == 0.0 else refuse.at_least("iterations", how.iterations, 1)


def _evened(photo: NDArray[np.float64], flat: ArrayLike | None) -> NDArray[np.float64]:
    """Divide out how a lens falls off to the corners, by the photograph of an even white."""
    from scipy.ndimage import gaussian_filter

    if flat is None:
        return photo
    white = refuse.all_finite("flat", refuse.shape_of("flat", flat, photo.shape)).astype(np.float64)
    # Falling off is smooth: what is fine in it is noise or dust.
    white = gaussian_filter(white, max(photo.shape) / FLAT_SMOOTHING, mode="nearest")
    if not white.min() > 0:
        raise refuse.Refusal("'flat' must be light everywhere; its darkest place is not above 0.")
    return np.asarray(photo * (white.max() / white))


def _refuse_darkness(photo: NDArray[np.float64]) -> None:
    """Refuse photographs in which nothing stands out of the noise."""
    from scipy.ndimage import median_filter

    # Neighbours differ by the noise; a pattern that is coarser than its pixels adds little.
    steps = np.abs(np.diff(photo, axis=1)) if photo.shape[1] > 1 else np.zeros(1)
    noise = float(np.median(steps)) / (0.6745 * math.sqrt(2.0))
    top = float(median_filter(photo, 3).max())
    if not top > max(0.0, BRIGHT * noise):
        raise refuse.Refusal(
            f"'photos' have no light: their brightest place ({top:.3g}) does not stand out of their"
            f" noise ({noise:.3g}); check exposure, black level and which channel was read."
        )
