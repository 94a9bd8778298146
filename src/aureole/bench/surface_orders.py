"""Where orders stand in tables of gratings, beside the grating equation."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from aureole import light, surface
from aureole.bench.report import Column, Table
from aureole.records import Stage
from aureole.surface.table import areas, axes

GRATINGS = ("cd", "dvd", "bluray")
LINES_NM = (380, 532, 650, 780)
INCIDENCES_DEG = (0, 30)
COLUMNS = (
    Column("grating", "{grating}", words=True),
    Column("light", "{wavelength_nm:.0f} nm"),
    Column("incidence", "{incidence_deg:.0f}°"),
    Column("order", "{order:d}"),
    Column("equation", "{angle_deg:.2f}°"),
    Column("in the table", "{found_deg:.2f}°"),
    Column("apart", "{apart_deg:.4f}°"),
)
NOTES = (
    "equation: d (sin θi + sin θo) = m λ, empty where there is no such direction. in the table: the mean of "
    "h · t within a twelfth of an order.",
)


def orders(size: int) -> Iterator[Stage]:
    """Find first orders in tables of single lines.

    Parameters
    ----------
    size : int
        Samples of the tables along the tangent.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    for index, name in enumerate(GRATINGS):
        yield Stage(index / len(GRATINGS), f"orders of {name}")
        for nanometres in LINES_NM:
            rows += _of_line(name, nanometres, size)
    yield Stage(1.0, "orders", (Table("orders", "First orders of discs", COLUMNS, tuple(rows), NOTES),))


def _of_line(name: str, nanometres: int, size: int) -> list[dict[str, Any]]:
    """Find the first order of one line at each incidence, as far as there is one."""
    wavelength = nanometres * 1e-9
    table = surface.table_from_grating(name, light.line(wavelength), (33, 2 * size + 1), warp=1)
    step = wavelength / surface.grating(name).along.period
    along_b, along_t = areas(table)
    mass = along_b @ table.values[..., 1].astype(np.float64) * along_t
    h_t = axes(table)[1]
    found = []
    for incidence in INCIDENCES_DEG:
        sine = math.sin(math.radians(incidence))
        row = {"grating": name, "wavelength_nm": nanometres, "incidence_deg": incidence, "order": 1}
        if abs(step - sine) <= 1.0:
            near = np.abs(h_t - step) < step / 12
            place = float((mass[near] @ h_t[near]) / mass[near].sum())
            angle, seen = (math.degrees(math.asin(h - sine)) for h in (step, place))
            row |= {"angle_deg": angle, "found_deg": seen, "apart_deg": abs(seen - angle)}
        found.append(row)
    return found
