"""From photographs of a flat sample to its diffraction pattern on a uniform grid of h.

In: a bracket under one narrow band and a small lamp (surface paper, section 4.3). Black level and merge,
the zero order's place, each pixel's h from real positions, and one resampling, so that the table's sums
along rows and columns are separable.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.records import Spectrum
from aureole.surface.bandwidth import sharpen
from aureole.surface.centre import Centre, find_centre
from aureole.surface.geometry import Geometry, farthest_h, pixel_map
from aureole.surface.hdr_merge import merge
from aureole.surface.integrate import table_from_pattern
from aureole.surface.pattern import DiffractionPattern
from aureole.surface.table import MODELS, SIZE, WARP, ScatterTable
from aureole.surface.zero_order import split_zero_order

MOST_SAMPLES = 4097  # along an axis


def measure_pattern(
    photos: ArrayLike | Sequence[ArrayLike],
    exposures: Sequence[float] | float,
    geometry: Geometry,
    wavelength: float,
    *,
    black: float | Sequence[ArrayLike] | str = 0.0,
    saturation: float | None = None,
    read_noise: float = 1.0,
    gain: float = 1.0,
    centre: tuple[float, float] | str = "auto",
    irradiance: float = 1.0,
    reflectance: float = 1.0,
    band: Spectrum | None = None,
    blur: float = 0.0,
    power: float = 4.0,
    iterations: int = 10,
    half_range: float | None = None,
    size: int | None = None,
    name: str = "measured",
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
    black : float, sequence of array_like, or str
        As for `merge`.
    saturation : float or None
        As for `merge`.
    read_noise, gain : float
        As for `merge`.
    centre : tuple of float or str
        The zero order's (row, column), or a method of `find_centre`.
    irradiance : float
        E on the sample at the zero order, in the photographs' radiance; 1 leaves the scale relative.
    reflectance : float
        Fresnel factor F_0 at normal incidence that was in the measurement, and is divided out.
    band : Spectrum or None
        Lamp × filter × sensor, whose width is undone by `sharpen`; None takes it as one wavelength.
    blur : float
        Standard deviation, in pixels, of the lens's Gaussian blur that is undone.
    power : float
        Exponent of the model, which undoing a band's width needs: 4 phase, 2 amplitude.
    iterations : int
        Of `sharpen`.
    half_range : float or None
        h · t and h · b of the outermost samples; None covers the whole photograph.
    size : int or None
        Samples along each axis; None keeps the step of the photograph's central pixels.
    name : str
        What to call it in reports.

    Returns
    -------
    DiffractionPattern
        M(h) = L(h) / (4 π² F_0² E(h)) by Eq. 14, zero where the photograph does not reach.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described, or the zero order lies outside the photograph.
    """
    bracket, times = _bracket(photos, exposures)
    wavelength = refuse.positive("wavelength", wavelength)
    scale = refuse.positive("irradiance", irradiance) * refuse.positive("reflectance", reflectance) ** 2
    merged = merge(bracket, times, black, saturation, read_noise, gain)
    place = locate(merged.values, centre)
    values, reach = resample(merged.values, geometry, (place.row, place.column), half_range, size)
    radiance = np.maximum(values, 0.0) / (4.0 * math.pi**2 * scale)
    pattern = DiffractionPattern(radiance.astype(np.float32), reach, wavelength, name)
    if band is None and not blur:
        return pattern
    step = farthest_h(geometry, (place.row, place.column), _shape(merged.values))[1]
    return sharpen(pattern, band, power, blur * step, iterations)


def table_from_photo(
    photos: ArrayLike | Sequence[ArrayLike],
    exposures: Sequence[float] | float,
    geometry: Geometry,
    wavelength: float,
    spectrum: Spectrum | str = "E",
    *,
    model: str = "phase",
    zero_order: str = "keep",
    zero_radius: float | None = None,
    table_size: int = SIZE,
    warp: int = WARP,
    **measurement: Any,
) -> ScatterTable:
    """Measure a flat sample under one narrow band, and make its table under any light.

    Parameters
    ----------
    photos : array_like of shape (rows, columns), or sequence of them
        One linear HDR photograph, or a bracket.
    exposures : float or sequence of float
        Of each photograph.
    geometry : BenchGeometry or UniformGeometry
        Where camera and lamp stood.
    wavelength : float
        Metres: the band's.
    spectrum : Spectrum or str
        The light of the table.
    model : {"phase", "amplitude", "paper"}
        How the pattern's brightness goes with wavelength; a band's width is undone by the same model.
    zero_order : {"keep", "remove", "specular"}
        "remove" cuts it out of the pattern; "specular" does so and keeps its energy and width in the table's
        metadata, to be drawn as a mirror's lobe that stays white.
    zero_radius : float or None
        Of the zero order in h; None finds it by `split_zero_order`.
    table_size : int
        Samples of the table along each axis.
    warp : int
        Of the table's axes.
    **measurement : dict
        What else `measure_pattern` takes.

    Returns
    -------
    ScatterTable
        The table.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    refuse.one_of("model", model, MODELS)
    refuse.one_of("zero_order", zero_order, ("keep", "remove", "specular"))
    power = float(MODELS[model])
    pattern = measure_pattern(photos, exposures, geometry, wavelength, power=power, **measurement)
    notes: dict[str, Any] = {}
    if zero_order != "keep":
        pattern, cut = split_zero_order(pattern, zero_radius)
        notes = {"zero_order_radius": cut.radius}
        if zero_order == "specular":
            notes |= {"zero_order_energy": cut.energy, "zero_order_width": cut.width}
    return table_from_pattern(
        pattern, spectrum, table_size, warp=warp, model=model, zero_order=zero_order, metadata=notes
    )


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
) -> tuple[NDArray[np.float64], float]:
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
    return np.divide(values, irradiance, out=np.zeros_like(values), where=inside), reach


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
