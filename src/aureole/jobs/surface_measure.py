"""Measuring a diffractive surface: from the photographs of a flat sample to its table."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from aureole import light, refuse, surface
from aureole.jobs.surface import finished_table, refuse_table
from aureole.records import Stage

# Share of the time that the patterns take, the table being the rest.
MEASURING = 0.75


@dataclass(frozen=True, eq=False)
class Bracket:
    """Photographs of a sample under one band.

    Parameters
    ----------
    photos : sequence of array_like, each of shape (rows, columns) or (rows, columns, 3)
        Linear in light, unless a response is to be found; three channels of a colour measurement.
    exposures : sequence of float
        Of each photograph, in seconds or relative.
    wavelength : float
        Metres; of no use in colour.
    width : float, optional
        Full width at half maximum of the filter, metres; None takes the band as one wavelength.
    """

    photos: Sequence[ArrayLike]
    exposures: Sequence[float]
    wavelength: float = 530e-9
    width: float | None = None


@dataclass(frozen=True, eq=False)
class SurfaceMeasureJob:
    """What was photographed, and what table to make of it.

    Parameters
    ----------
    brackets : tuple of Bracket
        One for each of one to three bands.
    geometry : BenchGeometry or UniformGeometry
        Where camera and lamp stood.
    name : str
        What to call the sample.
    lamp : str, optional
        Spectrum of the lamp, where the channels of one colour bracket are the bands.
    response : bool
        Whether the files are not linear, and the camera's response is to be found from the bracket.
    processing : mapping
        What else `aureole.surface.measure_pattern` takes.
    model : str
        "phase", "amplitude" or "paper".
    zero_order : str
        "keep", "remove" or "specular".
    zero_radius : float, optional
        Of the zero order, in h.
    illuminant : str
        The light of the table.
    size : int
        Samples on each side of the table.
    warp : int
        Of its axes.
    normalise : bool
        Whether the table is darkened, where needed, so that no light comes back that was not sent.
    period : float, optional
        Known period of the sample, metres, to check the measurement by.
    """

    brackets: tuple[Bracket, ...]
    geometry: surface.BenchGeometry | surface.UniformGeometry
    name: str = "sample"
    lamp: str | None = None
    response: bool = False
    processing: Mapping[str, Any] = field(default_factory=dict)
    model: str = "phase"
    zero_order: str = "keep"
    zero_radius: float | None = None
    illuminant: str = "D65"
    size: int = 2048
    warp: int = 5
    normalise: bool = False
    period: float | None = None


def run_surface_measure(job: SurfaceMeasureJob) -> Iterator[Stage]:
    """Run a measurement.

    Parameters
    ----------
    job : SurfaceMeasureJob
        What was photographed.

    Yields
    ------
    Stage
        The last one holds a `SurfaceTableResult`.
    """
    check_measure(job)
    patterns: list[surface.DiffractionPattern] = []
    for k, bracket in enumerate(job.brackets):
        for stage in _pattern_stages(job, bracket):
            done = (k + stage.fraction) / len(job.brackets)
            yield Stage(MEASURING * done, stage.label)
        patterns += stage.result
    for stage in surface.table_from_measured_stages(
        patterns,
        job.illuminant,
        model=job.model,
        zero_order=job.zero_order,
        zero_radius=job.zero_radius,
        table_size=job.size,
        warp=job.warp,
    ):
        yield Stage(MEASURING + (0.95 - MEASURING) * stage.fraction, stage.label)
    facts = {"surface": job.name, **_facts(patterns)}
    notes = tuple(note for pattern in patterns for note in pattern.metadata["notes"])
    yield from finished_table(stage.result, facts, job.normalise, notes)


def check_measure(job: SurfaceMeasureJob) -> None:
    """Refuse, before any work, what a measurement cannot serve.

    Parameters
    ----------
    job : SurfaceMeasureJob
        Any.

    Raises
    ------
    refuse.Refusal
        Where a choice or a number does not fit.
    """
    refuse.one_of("model", job.model, surface.MODELS)
    refuse.one_of("zero-order", job.zero_order, ("keep", "remove", "specular"))
    light.illuminant(job.illuminant)
    refuse_table((job.size, job.size))
    if not 1 <= len(job.brackets) <= 3:
        raise refuse.Refusal(f"'wavelength' must be one to three bands, got {len(job.brackets)}.")
    if job.lamp is not None and len(job.brackets) > 1:
        raise refuse.Refusal("'colour' takes its bands from the channels of one bracket; give one.")


def _pattern_stages(job: SurfaceMeasureJob, bracket: Bracket) -> Iterator[Stage]:
    """Measure the patterns of a bracket; the last stage holds a list of them."""
    processing = dict(job.processing) | {"name": job.name, "period": job.period}
    power = float(surface.MODELS[job.model])
    if job.response:
        planes = [photo if np.ndim(photo) == 2 else np.asarray(photo)[..., 1] for photo in bracket.photos]
        processing["response"] = surface.camera_response(planes, bracket.exposures)
    if job.lamp is not None:
        stages = surface.measure_channels_stages(
            bracket.photos, bracket.exposures, job.geometry, job.lamp, power=power, **processing
        )
    else:
        if bracket.width is not None:
            width = refuse.positive("band", bracket.width)
            processing["band"] = surface.gaussian_filter_spectrum(bracket.wavelength, width)
        stages = surface.measure_pattern_stages(
            bracket.photos, bracket.exposures, job.geometry, bracket.wavelength, power=power, **processing
        )
    for stage in stages:
        yield Stage(stage.fraction, stage.label)
    found = stage.result
    yield Stage(1.0, "pattern", list(found) if isinstance(found, tuple) else [found])


def _facts(patterns: Sequence[surface.DiffractionPattern]) -> dict[str, Any]:
    """Return what the patterns tell, for the report."""
    told: dict[str, Any] = {
        "wavelengths_nm": [round(1e9 * pattern.wavelength, 3) for pattern in patterns],
        "centre_row_column": [round(float(place), 3) for place in patterns[0].metadata["centre"]],
        "centre_by": patterns[0].metadata["centre_method"],
        "h_measured_to": max(pattern.half_range for pattern in patterns),
        "saturated_share": max(float(pattern.metadata["saturated_share"]) for pattern in patterns),
    }
    for k, name in enumerate(("along_t", "along_b")):
        if patterns[0].metadata["period"][k] is not None:
            told[f"period_{name}_m"] = patterns[0].metadata["period"][k]
            told[f"orders_{name}"] = patterns[0].metadata["orders"][k]
    return told
