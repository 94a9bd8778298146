"""The near field in colour: one call for all wavelengths, one for each, and the quad paper's stretching."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import diffraction, light
from aureole.bench import shapes
from aureole.bench.optics import Plane
from aureole.bench.report import Column, Table
from aureole.bench.timing import Task, alternate
from aureole.records import Picture, Stage

SIZE = 512
WIDTH, WAVELENGTH, FRESNEL_NUMBER = 10e-3, 550e-9, 100
ILLUMINANT, WAVELENGTHS = "D65", 30
FIELDS, POWERS = "a call of near_field each", "a call of near_power each"
EXACT, APPROXIMATE = "near_picture, exact", "near_picture, approximate"
COLUMNS = (
    Column("RGB of the plane", "{way}", words=True),
    Column("median", "{median_ms:.1f} ms"),
    Column("of the calls", "{part:.2f}"),
    Column("faster than exact", "{gain:.1f}x"),
    Column("difference", "{difference:.1e}"),
)


def colours(size: int, runs: int) -> Iterator[Stage]:
    """Time a near field in colour.

    Parameters
    ----------
    size : int
        Pixels of the mask and places on the plane on each side.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    plane = Plane(shapes.mask("heptagon", size), WIDTH, WAVELENGTH)
    made: dict[str, NDArray[Any]] = {}
    tasks: dict[str, Task] = {
        FIELDS: lambda: made.update({FIELDS: _calls(plane, _squared)}),
        POWERS: lambda: made.update({POWERS: _calls(plane, _power)}),
        EXACT: lambda: made.update({EXACT: _one_call(plane, "exact")}),
        APPROXIMATE: lambda: made.update({APPROXIMATE: _one_call(plane, "approximate")}),
    }
    times = yield from alternate(tasks, runs, label="colour,")
    white = light.white(light.illuminant(ILLUMINANT))
    rows = []
    for way, spent in times.items():
        off = (made[way] - made[FIELDS]) / white
        rows.append(
            {
                "way": way,
                "median_ms": spent,
                "part": spent / times[FIELDS],
                "gain": times[EXACT] / spent,
                "difference": float(np.sqrt(np.mean(off**2))),
            }
        )
    notes = (
        f"A heptagon in {ILLUMINANT}, {WAVELENGTHS} wavelengths, Fresnel number {FRESNEL_NUMBER} at 550 nm; "
        "from the mask to RGB. of the calls: share of the first row's time. difference: root mean square of "
        "XYZ from the first row's, of the light's white.",
        "'approximate' stretches one pattern a little (Figure 7b): plausible, and not physically accurate. "
        "Printed: 93 and 245 times faster at 256² and 512² (section 5.2; Figure 7 takes 60 wavelengths).",
    )
    table = Table("colour", f"Near field in colour, {size}²", COLUMNS, tuple(rows), notes)
    yield Stage(1.0, "colour", (table,))


def _one_call(plane: Plane, method: str) -> NDArray[np.float32]:
    lamp, distance = light.illuminant(ILLUMINANT), plane.distance(FRESNEL_NUMBER)
    samples = WAVELENGTHS if method == "exact" else None
    made = diffraction.near_picture(plane.aperture, plane.centred, distance, lamp, method, samples)
    light.convert(made, "rec709")
    return made.pixels


def _calls(plane: Plane, power: Any) -> NDArray[np.float32]:
    """Add up wavelengths one by one, as one would without `near_picture`; return the XYZ."""
    wavelengths, weights = light.quadrature(light.illuminant(ILLUMINANT), WAVELENGTHS)
    total = np.zeros((3, plane.size, plane.size), dtype=np.float32)
    for wavelength, weight in zip(wavelengths, weights.astype(np.float32), strict=True):
        found = power(plane, float(wavelength))
        for channel in range(3):
            total[channel] += weight[channel] * found
    xyz = np.ascontiguousarray(np.moveaxis(total, 0, -1))
    light.convert(Picture(xyz, "xyz"), "rec709")
    return xyz


def _squared(plane: Plane, wavelength: float) -> NDArray[np.float32]:
    distance = plane.distance(FRESNEL_NUMBER)
    field = diffraction.near_field(plane.aperture, plane.centred, distance, wavelength).amplitude
    return np.asarray(field.real**2 + field.imag**2)


def _power(plane: Plane, wavelength: float) -> NDArray[np.float32]:
    distance = plane.distance(FRESNEL_NUMBER)
    found: NDArray[np.float32] = diffraction.near_power(plane.aperture, plane.centred, distance, wavelength)
    return found
