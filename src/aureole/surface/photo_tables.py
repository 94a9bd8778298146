"""From photographs, or patterns measured under one to three bands, to a table.

A pattern that is scaled to every wavelength scales its zero order too; what is cut out of it here goes into
the table's metadata for a mirror's lobe that stays white.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import light, refuse
from aureole.records import Spectrum, Stage
from aureole.surface.geometry import Geometry
from aureole.surface.integrate import as_spectrum, table_from_pattern_stages
from aureole.surface.measure import measure_pattern_stages
from aureole.surface.pattern import DiffractionPattern
from aureole.surface.table import MODELS, SIZE, WARP, WAVELENGTHS, ZERO_ORDERS, ScatterTable
from aureole.surface.zero_order import ZeroOrder, split_zero_order

_MEASURING = 0.8  # share of the time that measuring a band takes, the table being the rest


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
    **processing: Any,
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
        As for `table_from_measured`.
    zero_radius : float or None
        Of the zero order in h; None finds it by `split_zero_order`.
    table_size : int
        Samples of the table along each axis.
    warp : int
        Of the table's axes.
    **processing : dict
        What `Processing` has, but for the power, which is the model's.

    Returns
    -------
    ScatterTable
        Its metadata say under "patterns" what `measure_pattern` found.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    for stage in table_from_photo_stages(
        photos,
        exposures,
        geometry,
        wavelength,
        spectrum,
        model=model,
        zero_order=zero_order,
        zero_radius=zero_radius,
        table_size=table_size,
        warp=warp,
        **processing,
    ):
        last = stage
    table: ScatterTable = last.result
    return table


def table_from_photo_stages(
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
    **processing: Any,
) -> Iterator[Stage]:
    """Do what `table_from_photo` does, with a stage before every step.

    Parameters
    ----------
    photos : array_like of shape (rows, columns), or sequence of them
        As for `table_from_photo`, and so are the others.
    exposures : float or sequence of float
        Of each photograph.
    geometry : BenchGeometry or UniformGeometry
        Where camera and lamp stood.
    wavelength : float
        Metres.
    spectrum : Spectrum or str
        The light of the table.
    model : str
        Power of λ_m / λ.
    zero_order : str
        What becomes of the light about h = 0.
    zero_radius : float or None
        Of the zero order in h.
    table_size : int
        Samples of the table along each axis.
    warp : int
        Of the table's axes.
    **processing : dict
        What `Processing` has, but for the power.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    power = float(MODELS[refuse.one_of("model", model, MODELS)])
    refuse.one_of("zero_order", zero_order, ZERO_ORDERS)
    if "power" in processing:
        raise refuse.Refusal("'power' follows from 'model' here; give 'model' alone.")
    for stage in measure_pattern_stages(photos, exposures, geometry, wavelength, power=power, **processing):
        if stage.result is None:
            yield Stage(_MEASURING * stage.fraction, stage.label)
    for last in table_from_measured_stages(
        stage.result,
        spectrum,
        model=model,
        zero_order=zero_order,
        zero_radius=zero_radius,
        table_size=table_size,
        warp=warp,
    ):
        yield Stage(_MEASURING + (1.0 - _MEASURING) * last.fraction, last.label, last.result)


def table_from_measured(
    patterns: DiffractionPattern | Sequence[DiffractionPattern],
    spectrum: Spectrum | str = "E",
    *,
    model: str = "phase",
    zero_order: str = "keep",
    zero_radius: float | None = None,
    table_size: int = SIZE,
    warp: int = WARP,
) -> ScatterTable:
    """Make a table of patterns measured under one to three bands.

    Parameters
    ----------
    patterns : DiffractionPattern or sequence of them
        At different wavelengths; between two of them they are mixed linearly in wavelength.
    spectrum : Spectrum or str
        The light of the table.
    model : {"phase", "amplitude", "paper"}
        How a pattern's brightness goes with wavelength.
    zero_order : {"keep", "remove", "specular"}
        "remove" cuts it out of every pattern. "specular" does so too and writes into the table's metadata
        "zero_order_energy", the share of the light that a mirror in its place sends on (4π² ∫ M dh, mixed
        between bands) as X, Y, Z of the table's light, so that one band gives a share of the light's own
        white; and "zero_order_width", the root mean square of one component of h over it. A Beckmann lobe
        of root mean square slope m is as wide at m = width / √2, since h is twice the half vector's slope.
    zero_radius : float or None
        Of the zero order in h; None finds it by `split_zero_order`, in each pattern.
    table_size : int
        Samples of the table along each axis.
    warp : int
        Of the table's axes.

    Returns
    -------
    ScatterTable
        The table.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    for stage in table_from_measured_stages(
        patterns,
        spectrum,
        model=model,
        zero_order=zero_order,
        zero_radius=zero_radius,
        table_size=table_size,
        warp=warp,
    ):
        last = stage
    table: ScatterTable = last.result
    return table


def table_from_measured_stages(
    patterns: DiffractionPattern | Sequence[DiffractionPattern],
    spectrum: Spectrum | str = "E",
    *,
    model: str = "phase",
    zero_order: str = "keep",
    zero_radius: float | None = None,
    table_size: int = SIZE,
    warp: int = WARP,
) -> Iterator[Stage]:
    """Do what `table_from_measured` does, with a stage after every few rows.

    Parameters
    ----------
    patterns : DiffractionPattern or sequence of them
        As for `table_from_measured`, and so are the others.
    spectrum : Spectrum or str
        The light of the table.
    model : str
        Power of λ_m / λ.
    zero_order : str
        What becomes of the light about h = 0.
    zero_radius : float or None
        Of the zero order in h.
    table_size : int
        Samples of the table along each axis.
    warp : int
        Of the table's axes.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    refuse.one_of("zero_order", zero_order, ZERO_ORDERS)
    given = [patterns] if isinstance(patterns, DiffractionPattern) else list(patterns)
    lamp, notes = as_spectrum(spectrum), {}
    if zero_order != "keep":
        parts = [split_zero_order(pattern, zero_radius) for pattern in given]
        given = [pattern for pattern, _ in parts]
        notes = _zero_orders([(pattern.wavelength, cut) for pattern, cut in parts], lamp)
        if zero_order == "remove":
            notes = {"zero_order_radius": notes["zero_order_radius"]}
    yield from table_from_pattern_stages(
        given, lamp, table_size, warp=warp, model=model, zero_order=zero_order, metadata=notes
    )


def _zero_orders(cuts: list[tuple[float, ZeroOrder]], lamp: Spectrum) -> dict[str, Any]:
    """Say what was cut out of the patterns: radius, width, and the share of the light in X, Y and Z."""
    cuts = sorted(cuts, key=lambda pair: pair[0])
    wavelengths = np.array([wavelength for wavelength, _ in cuts])
    shares = np.array([4.0 * np.pi**2 * cut.energy for _, cut in cuts])
    places, weights = light.quadrature(lamp, WAVELENGTHS)
    total: NDArray[np.float64] = np.interp(places, wavelengths, shares) @ weights
    widths = np.array([cut.width for _, cut in cuts])
    lit = shares.sum()
    return {
        "zero_order_radius": max(cut.radius for _, cut in cuts),
        "zero_order_energy": [float(part) for part in total],
        "zero_order_width": float(np.sqrt(shares @ widths**2 / lit)) if lit > 0 else 0.0,
    }
