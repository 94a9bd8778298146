"""A diffraction pattern at one wavelength, over the components of h = ω_i + ω_o in the surface."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.records import Grid, Pattern


@dataclass(frozen=True, eq=False)
class DiffractionPattern:
    """What a surface diffracts at one wavelength: S of f_r = 4π² F² G S(h · t, h · b).

    Parameters
    ----------
    values : ndarray of float32, shape (rows, columns)
        1/sr at `wavelength`. Columns run along h · t to the right, rows along h · b downward from
        +half_range; the outermost samples lie at ±half_range. Zero outside.
    half_range : float
        h · t and h · b of the outermost samples; h is not normalised and reaches 2.
    wavelength : float
        Metres.
    name : str
        What to call it in reports.
    metadata : Mapping
        What else is known, numbers and text; of a measured one what `measure_pattern` found.
    """

    values: NDArray[np.float32]
    half_range: float
    wavelength: float
    name: str = "pattern"
    metadata: Mapping[str, Any] = field(default_factory=dict)


def diffraction_pattern(
    values: ArrayLike, half_range: float, wavelength: float, name: str = "pattern"
) -> DiffractionPattern:
    """Make a diffraction pattern from numbers.

    Parameters
    ----------
    values : array_like, shape (rows, columns)
        1/sr; two rows and two columns or more. Row 0 lies at h · b = +half_range.
    half_range : float
        h · t and h · b of the outermost samples.
    wavelength : float
        Metres.
    name : str
        What to call it in reports.

    Returns
    -------
    DiffractionPattern
        Float32; it owns its values.

    Raises
    ------
    refuse.Refusal
        Where a value is not finite, or a number is not positive.
    """
    numbers = refuse.all_finite("values", refuse.shape_of("values", values, (None, None)))
    if min(numbers.shape) < 2:
        raise refuse.Refusal(f"'values' needs two rows and columns or more, got {numbers.shape}.")
    half_range = refuse.positive("half_range", half_range)
    wavelength = refuse.positive("wavelength", wavelength)
    return DiffractionPattern(np.array(numbers, dtype=np.float32), half_range, wavelength, name)


def on_grid(pattern: DiffractionPattern) -> Pattern:
    """Return a pattern as the spectral sum takes it: y downward along its rows.

    Parameters
    ----------
    pattern : DiffractionPattern
        Any.

    Returns
    -------
    Pattern
        On a grid of (−h · b, h · t); its energy is the integral over h.
    """
    spacing = [2.0 * pattern.half_range / (count - 1) for count in pattern.values.shape]
    # The centre of the range lies between two samples at even sizes.
    centre = [0.5 * step * (1 - count % 2) for step, count in zip(spacing, pattern.values.shape, strict=True)]
    grid = Grid(pattern.values.shape, (spacing[0], spacing[1]), (centre[0], centre[1]))
    energy = float(pattern.values.sum(dtype=np.float64)) * spacing[0] * spacing[1]
    return Pattern(pattern.values, grid, pattern.wavelength, energy)
