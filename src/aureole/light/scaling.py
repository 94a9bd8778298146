"""What one spectral sum is asked to do, and where its scaled samples lie."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.records import Grid, Pattern, Spectrum

Analytic = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

TAPS = {"linear": 2, "cubic": 4}  # samples of the pattern that one interpolated value takes an axis


@dataclass(frozen=True, eq=False)
class Task:
    """One spectral sum, its inputs checked.

    Parameters
    ----------
    source : Pattern or callable
        Intensity over frequency at the reference wavelength.
    grid : Grid
        Where the sum is wanted, in the pattern's frequency.
    wavelength : float
        The reference wavelength λ_r in metres.
    spectrum : Spectrum
        The light.
    samples : int
        Number of wavelengths.
    interpolation : str
        A key of `TAPS`.
    symmetric : bool
        Whether P(−q) = P(q) may be relied on; the grid is then centred on zero.
    """

    source: Pattern | Analytic
    grid: Grid
    wavelength: float
    spectrum: Spectrum
    samples: int
    interpolation: str
    symmetric: bool

    @property
    def taps(self) -> int:
        """Samples of the pattern that one interpolated value takes an axis."""
        return TAPS[self.interpolation]

    def pattern(self, method: str) -> Pattern:
        """Return the source, refusing a callable.

        Parameters
        ----------
        method : str
            The method that needs samples.

        Returns
        -------
        Pattern
            The source.

        Raises
        ------
        refuse.Refusal
            Where the source is a callable.
        """
        if isinstance(self.source, Pattern):
            return self.source
        raise refuse.Refusal(
            f"'method' '{method}' interpolates a sampled pattern; use 'reference' for a callable."
        )


def index_positions(
    grid: Grid, y: NDArray[np.float64], x: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Turn frequencies into positions counted in samples of a grid.

    Parameters
    ----------
    grid : Grid
        The grid.
    y, x : ndarray
        Frequencies along its rows' and columns' axes, any shape each.

    Returns
    -------
    rows, columns : ndarray
        0 at the first sample.
    """
    rows = (y - grid.centre[0]) / grid.spacing[0] + grid.shape[0] // 2
    columns = (x - grid.centre[1]) / grid.spacing[1] + grid.shape[1] // 2
    return rows, columns


def pixels_summed(task: Task) -> int:
    """Count the pixels that a task has to sum, symmetry used.

    Parameters
    ----------
    task : Task
        What to sum.

    Returns
    -------
    int
        Half of them where P(−q) = P(q) serves the other half.
    """
    rows, columns = task.grid.shape
    return (rows // 2 + 1 if task.symmetric else rows) * columns
