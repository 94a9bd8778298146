"""The four apertures of the quad paper: box, circle, heptagon, whirl.

Their exact sizes are not published. Here they reach across half of the window, and the box's edges lie
on pixels from 256² on.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from aureole import aperture
from aureole.records import Aperture

HALF = 0.5
BOX = 42 / 64
OUTLINES: dict[str, Callable[[float], Aperture]] = {
    "box": lambda across: aperture.rectangle(BOX * across, BOX * across),
    "circle": aperture.circle,
    "heptagon": lambda across: aperture.iris(7, across),
    "whirl": aperture.whirl,
}


def outline(name: str, across: float = HALF) -> Aperture:
    """Return an aperture's exact outline in a window of width 1.

    Parameters
    ----------
    name : str
        box, circle, heptagon or whirl.
    across : float
        Diameter of the circle that it reaches, of the window.

    Returns
    -------
    Aperture
        Its width is the window's: 1.
    """
    return Aperture(1.0, OUTLINES[name](across).outlines, name=name)


def mask(name: str, size: int, across: float = HALF) -> NDArray[np.float32]:
    """Draw an aperture with grey pixels along its edge.

    Parameters
    ----------
    name : str
        As for `outline`.
    size : int
        Pixels on each side.
    across : float
        As for `outline`.

    Returns
    -------
    ndarray of float32, shape (size, size)
        Transmittance.
    """
    return aperture.rasterize(outline(name, across), size)


def raster(name: str, size: int, across: float = HALF) -> Aperture:
    """Draw an aperture as pixels.

    Parameters
    ----------
    name : str
        As for `outline`.
    size : int
        Pixels on each side.
    across : float
        As for `outline`.

    Returns
    -------
    Aperture
        Width 1.
    """
    return Aperture(1.0, mask=mask(name, size, across), name=name)
