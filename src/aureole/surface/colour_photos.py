"""A pattern for each channel of a colour photograph (surface paper, Fig. 16): three wide bands at once.

Under a white lamp a camera's red, green and blue each see a band of some 80 nm. Each channel's pattern is
taken at its band's mean wavelength and its width undone; the three are mixed over wavelength. One narrow
filter remains the better measurement.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from aureole import light, refuse
from aureole.records import Spectrum, Stage
from aureole.surface.bandwidth import band_of, mean_wavelength
from aureole.surface.geometry import Geometry
from aureole.surface.integrate import as_spectrum
from aureole.surface.measure import measure_pattern_stages
from aureole.surface.pattern import DiffractionPattern

COLOURS = ("red", "green", "blue")
# Metres: peak and full width at half of it. Round numbers of ordinary cameras, assumed, not measured:
# one's own camera's curves are better.
ASSUMED = ((600e-9, 70e-9), (535e-9, 90e-9), (460e-9, 75e-9))
_STEP, _RANGE = 2e-9, (380e-9, 780e-9)


def assumed_sensitivities() -> tuple[Spectrum, Spectrum, Spectrum]:
    """Return a colour camera's sensitivities as assumed where none are known.

    Returns
    -------
    tuple of three Spectrum
        Red, green and blue: Gaussians of 600, 535 and 460 nm, 70, 90 and 75 nm wide at half their height,
        each with an integral of 1.
    """
    places = np.arange(_RANGE[0], _RANGE[1] + 0.5 * _STEP, _STEP)
    curves = []
    for name, (peak, width) in zip(COLOURS, ASSUMED, strict=True):
        values = np.exp(-4.0 * math.log(2.0) * ((places - peak) / width) ** 2)
        curves.append(light.spectrum(places, values / (values.sum() * _STEP), name=f"{name}, assumed"))
    return curves[0], curves[1], curves[2]


def measure_channels(
    photos: ArrayLike | Sequence[ArrayLike],
    exposures: Sequence[float] | float,
    geometry: Geometry,
    lamp: Spectrum | str = "E",
    sensitivities: Sequence[Spectrum] | None = None,
    white: Sequence[float] = (1.0, 1.0, 1.0),
    **processing: Any,
) -> tuple[DiffractionPattern, ...]:
    """Measure a pattern for each channel of a colour photograph.

    Parameters
    ----------
    photos : array_like of shape (rows, columns, 3), or sequence of them
        Linear red, green and blue as the camera's own channels, or a bracket.
    exposures : float or sequence of float
        Of each photograph.
    geometry : BenchGeometry or UniformGeometry
        Where camera and lamp stood.
    lamp : Spectrum or str
        The light of the lamp.
    sensitivities : sequence of three Spectrum, or None
        Of the camera; None is `assumed_sensitivities`.
    white : sequence of three floats
        What the camera's channels show of something white under that lamp, which is divided out.
    **processing : dict
        What `Processing` has, but for the band. The centre is found in green, unless it is given.

    Returns
    -------
    tuple of three DiffractionPattern
        Red, green and blue, each at the mean wavelength of its band, for `table_from_measured`. Where the
        sensitivities are assumed, "sensitivities" in their metadata says so.

    Raises
    ------
    refuse.Refusal
        Where an input is not as described.
    """
    for stage in measure_channels_stages(
        photos, exposures, geometry, lamp, sensitivities, white, **processing
    ):
        last = stage
    patterns: tuple[DiffractionPattern, ...] = last.result
    return patterns


def measure_channels_stages(
    photos: ArrayLike | Sequence[ArrayLike],
    exposures: Sequence[float] | float,
    geometry: Geometry,
    lamp: Spectrum | str = "E",
    sensitivities: Sequence[Spectrum] | None = None,
    white: Sequence[float] = (1.0, 1.0, 1.0),
    **processing: Any,
) -> Iterator[Stage]:
    """Do what `measure_channels` does, with a stage before every step.

    Parameters
    ----------
    photos : array_like of shape (rows, columns, 3), or sequence of them
        As for `measure_channels`, and so are the others.
    exposures : float or sequence of float
        Of each photograph.
    geometry : BenchGeometry or UniformGeometry
        Where camera and lamp stood.
    lamp : Spectrum or str
        The light of the lamp.
    sensitivities : sequence of three Spectrum, or None
        Of the camera.
    white : sequence of three floats
        What the channels show of something white.
    **processing : dict
        What `Processing` has, but for the band.

    Yields
    ------
    Stage
        The last one holds the patterns.
    """
    given: list[Any] = [photos] if isinstance(photos, np.ndarray) and photos.ndim == 3 else list(photos)  # type: ignore[arg-type]
    bracket = [refuse.shape_of("photos", photo, (None, None, 3)) for photo in given]
    curves = assumed_sensitivities() if sensitivities is None else tuple(sensitivities)
    if len(curves) != 3 or len(white) != 3:
        raise refuse.Refusal("'sensitivities' and 'white' need three each: red, green and blue.")
    source, irradiance = as_spectrum(lamp), processing.pop("irradiance", 1.0)
    told = "assumed" if sensitivities is None else "given"
    found: dict[str, DiffractionPattern] = {}
    method = ""
    # Green first: it is the sharpest, and tells where the zero order is.
    for done, k in enumerate((1, 0, 2)):
        band = band_of(source, curves[k])
        seen = irradiance * refuse.positive("white", white[k])
        stages = measure_pattern_stages(
            [photo[..., k] for photo in bracket],
            exposures,
            geometry,
            mean_wavelength(band),
            **{"name": COLOURS[k], **_of_channel(processing, k), "band": band, "irradiance": seen},
        )
        for stage in stages:
            if stage.result is None:
                yield Stage((done + stage.fraction) / 3.0, f"{COLOURS[k]}: {stage.label}")
        pattern: DiffractionPattern = stage.result
        method = method or pattern.metadata["centre_method"]
        said = {**pattern.metadata, "centre_method": method, "sensitivities": told}
        found[COLOURS[k]] = replace(pattern, metadata=said)
        processing["centre"] = tuple(pattern.metadata["centre"])
    yield Stage(1.0, "patterns", tuple(found[name] for name in COLOURS))


def _of_channel(processing: dict[str, Any], k: int) -> dict[str, Any]:
    """Take a channel's own plane where a flat field or dark frames have three."""
    own = dict(processing)
    if own.get("flat") is not None and np.ndim(own["flat"]) == 3:
        own["flat"] = np.asarray(own["flat"])[..., k]
    black = own.get("black", 0.0)
    if not isinstance(black, str | int | float) and all(np.ndim(frame) == 3 for frame in black):
        own["black"] = [np.asarray(frame)[..., k] for frame in black]
    return own
