"""What a table is, in numbers: for reports, sidecars and the command line."""

import math
from typing import Any

import numpy as np

from aureole.surface.albedo import albedo, albedo_bound
from aureole.surface.table import ScatterTable, energy

INCIDENCES_DEG = (0, 30, 60)


def describe(table: ScatterTable) -> dict[str, Any]:
    """Return what a table is, and how much light it sends back.

    Parameters
    ----------
    table : ScatterTable
        Any.

    Returns
    -------
    dict
        Plain numbers and text: rows, columns, half_range, warp, illuminant, white, model, zero_order;
        `energy`, the shares 4π² ∫ S_d dh of the light's X, Y and Z; `albedo`, the share of the luminance of
        light at 0, 30 and 60 degrees along the tangent that is sent back, with F² G = 1; `albedo_bound`,
        which no incidence exceeds; `normalised_by` where the table was darkened; `brightest`, the largest Y,
        1/sr.
    """
    rows, columns = table.values.shape[:2]
    white = np.asarray(table.white)
    shares = 4.0 * np.pi**2 * energy(table)
    sines = [math.sin(math.radians(angle)) for angle in INCIDENCES_DEG]
    found = albedo(table, [[sine, 0.0] for sine in sines])[:, 1]
    said: dict[str, Any] = {
        "rows": rows,
        "columns": columns,
        "half_range": float(table.half_range),
        "warp": int(table.warp),
        "illuminant": table.illuminant,
        "white": [float(value) for value in table.white],
        "model": table.model,
        "zero_order": table.zero_order,
        "energy": np.divide(shares, white, out=np.zeros(3), where=white > 0).tolist(),
        "albedo": {f"{angle}_deg": float(value) for angle, value in zip(INCIDENCES_DEG, found, strict=True)},
        "albedo_bound": albedo_bound(table),
        "brightest": float(table.values[:, :, 1].max()),
    }
    if "normalised_by" in table.metadata:
        said["normalised_by"] = float(table.metadata["normalised_by"])
    return said
