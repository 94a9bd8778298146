"""Diffractive surfaces: from a grating or a height field to a table, and what a table is in numbers."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from aureole import light, picture, refuse, surface
from aureole.records import Stage

# Measured peak of making a table, rounded up.
BYTES_PER_SAMPLE = 80
GRATING_SIZE, HEIGHT_SIZE = 2048, 1024


@dataclass(frozen=True, eq=False)
class SurfaceTableJob:
    """What table to make, of what surface.

    Parameters
    ----------
    source : Grating or HeightField
        The surface.
    illuminant : str
        The light's spectrum, as `aureole.light.illuminant` reads it.
    size : tuple of int, optional
        (rows, columns) of the table; 2048 of gratings, 1024 of height fields where it is left out.
    half_range : float
        h of its outermost samples.
    warp : int
        n of h = half_range · uⁿ, odd.
    zero_order : str
        "keep", "remove" or "specular".
    normalise : bool
        Whether the table is darkened, where needed, so that no light comes back that was not sent.
    method : str
        Of height fields: "exact", "born", "taylor" or "amplitude".
    order : int
        Of a Taylor series.
    facts : mapping
        What is known about the source besides, for the report.
    notes : tuple of str
        What a person should know about the source.
    """

    source: surface.Grating | surface.HeightField
    illuminant: str = "D65"
    size: tuple[int, int] | None = None
    half_range: float = 2.0
    warp: int = 5
    zero_order: str = "keep"
    normalise: bool = False
    method: str = "exact"
    order: int = 1
    facts: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class SurfaceTableResult:
    """A table, and what is worth knowing about it.

    Parameters
    ----------
    table : ScatterTable
        The table.
    report : dict
        Plain numbers.
    notes : tuple of str
        What a person should know, one line each.
    """

    table: surface.ScatterTable
    report: dict[str, Any]
    notes: tuple[str, ...] = ()


def run_surface_table(job: SurfaceTableJob) -> Iterator[Stage]:
    """Run a table's job.

    Parameters
    ----------
    job : SurfaceTableJob
        What to make.

    Yields
    ------
    Stage
        The last one holds a `SurfaceTableResult`.
    """
    table = None
    for stage in table_stages(job):
        table = stage.result
        yield Stage(0.8 * stage.fraction, stage.label)
    assert isinstance(table, surface.ScatterTable)
    yield from finished_table(table, {"surface": job.source.name, **job.facts}, job.normalise, job.notes)


def table_stages(job: SurfaceTableJob) -> Iterator[Stage]:
    """Make a table as it comes, neither normalised nor measured.

    Parameters
    ----------
    job : SurfaceTableJob
        What to make.

    Yields
    ------
    Stage
        The last one holds a `ScatterTable`.
    """
    heights = isinstance(job.source, surface.HeightField)
    size = job.size or ((HEIGHT_SIZE,) * 2 if heights else (GRATING_SIZE,) * 2)
    refuse_table(size)
    shared: dict[str, Any] = {
        "spectrum": light.illuminant(job.illuminant),
        "size": size,
        "half_range": job.half_range,
        "warp": job.warp,
        "zero_order": job.zero_order,
    }
    if isinstance(job.source, surface.HeightField):
        yield from surface.table_from_height_stages(job.source, method=job.method, order=job.order, **shared)
    else:
        yield from surface.table_from_grating_stages(job.source, **shared)


def finished_table(
    table: surface.ScatterTable,
    facts: Mapping[str, Any],
    normalise: bool = False,
    notes: tuple[str, ...] = (),
) -> Iterator[Stage]:
    """Normalise a table where that is wanted, and measure it.

    Parameters
    ----------
    table : ScatterTable
        As it was made.
    facts : mapping
        What is known about it, for the report.
    normalise : bool
        Whether no more light may come back than was sent.
    notes : tuple of str
        What a person should know besides.

    Yields
    ------
    Stage
        The last one holds a `SurfaceTableResult`.
    """
    yield Stage(0.95, "measuring the table")
    if normalise:
        table = surface.normalised(table)
    report = {**facts, **table_report(table)}
    notes += tuple(str(note) for note in table.metadata.get("notes", ()))
    if report["albedo_bound"] > 1.0:
        notes += (
            f"the table sends back up to {report['albedo_bound']:.3g} times the light that came: its scale "
            "is not known, or too high; --normalise brings it to 1 at most",
        )
    yield Stage(1.0, "table", SurfaceTableResult(table, report, notes))


def refuse_table(size: tuple[int, int]) -> None:
    """Refuse, before any work, a table for which there is not enough memory.

    Parameters
    ----------
    size : tuple of int
        (rows, columns).

    Raises
    ------
    refuse.Refusal
        Where it is too large, or smaller than 2 x 2.
    """
    for length in size:
        refuse.at_least("size", length, 2)
    needed, limit = BYTES_PER_SAMPLE * size[0] * size[1], picture.allowed_memory()
    if needed > limit:
        raise refuse.Refusal(
            f"a table of {size[1]} x {size[0]} needs about {needed / 1e9:.3g} GB of memory, "
            f"{limit / 1e9:.3g} GB are allowed; see --size."
        )


def table_report(table: surface.ScatterTable) -> dict[str, Any]:
    """Return the plain numbers of a table.

    Parameters
    ----------
    table : ScatterTable
        Any.

    Returns
    -------
    dict
        What `aureole.surface.describe` says, and what the table's metadata say.
    """
    told = dict(surface.describe(table))
    told |= {f"albedo_{angle.replace('_', '')}": share for angle, share in told.pop("albedo").items()}
    rows, columns = told.pop("rows"), told.pop("columns")
    told = {"size": [columns, rows], **told}
    for name in ("zero_order_energy", "zero_order_radius", "series_error", "wavelengths"):
        if name in table.metadata:
            value = table.metadata[name]
            told[name] = [float(part) for part in value] if isinstance(value, tuple | list) else value
    return told


def order_rows(grating: surface.Grating, incidence: float, wavelength: float) -> list[dict[str, Any]]:
    """Return where a grating's orders go, and how much of the light they take.

    Parameters
    ----------
    grating : Grating
        Its lines along the tangent.
    incidence : float
        Radians.
    wavelength : float
        Metres.

    Returns
    -------
    list of dict
        "order", "angle_deg" and "h"; "efficiency" is the share of the light, by scalar theory.
    """
    numbers, angles = surface.orders(grating, incidence, wavelength)
    return [
        {
            "order": int(number),
            "angle_deg": math.degrees(angle),
            "h": float(number * wavelength / grating.along.period),
            "efficiency": float(
                grating.along.efficiency(int(number), wavelength, math.cos(incidence) + math.cos(angle))
            ),
        }
        for number, angle in zip(numbers, angles, strict=True)
    ]
