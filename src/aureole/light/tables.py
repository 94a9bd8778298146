"""The published tables in `data/`: comma-separated numbers under a header that names their source."""

from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import NDArray

NANOMETRES = 1e9  # in a metre; dividing by it rounds to the nearest double, 1e-9 does not


@cache
def table(name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Read a table of functions of wavelength.

    Parameters
    ----------
    name : str
        File in `data/` without its suffix: wavelengths in nm in the first column.

    Returns
    -------
    wavelengths : ndarray of float64, shape (W,)
        Metres, rising; read-only.
    values : ndarray of float64, shape (W, columns)
        As published; read-only.
    """
    file = resources.files("aureole.light") / "data" / f"{name}.csv"
    with file.open(encoding="utf-8") as lines:
        rows = np.loadtxt(lines, delimiter=",", ndmin=2)
    wavelengths, values = rows[:, 0] / NANOMETRES, rows[:, 1:].copy()
    wavelengths.flags.writeable = values.flags.writeable = False
    return wavelengths, values
