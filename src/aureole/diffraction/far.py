"""The far field of an aperture: one signature, several methods, and the chooser.

`far_field` returns F(u, v) = ∬ f(x, y) exp(−i2π (u x + v y)) dx dy in square metres, u and v in cycles
per metre, so that ∬|F|² du dv = ∬|f|² dx dy.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction.chirpz import chirpz_field, fft_field, fft_lengths
from aureole.diffraction.polygons import polygons_field
from aureole.diffraction.quads import quads_field
from aureole.diffraction.quadtree import quadtree
from aureole.diffraction.reference import reference_field
from aureole.records import Aperture, Field, Grid

RASTER_SIZE = 1024
# Above so many edges an outline costs more than the chirp-z transform of its raster.
MOST_EDGES = 4000


def _by_quads(aperture: Aperture, grid: Grid) -> NDArray[np.complex64]:
    assert aperture.mask is not None
    return quads_field(quadtree(aperture.mask, aperture.width), grid)


METHODS: dict[str, Callable[[Aperture, Grid], NDArray[Any]]] = {
    "reference": reference_field,
    "polygons": polygons_field,
    "quads": _by_quads,
    "chirpz": chirpz_field,
    "fft": fft_field,
}
OF_PIXELS = ("quads", "chirpz", "fft")


def far_field(aperture: Aperture, grid: Grid, method: str = "auto", raster_size: int = RASTER_SIZE) -> Field:
    """Return the Fourier transform of an aperture on a regular grid of frequencies.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.
    grid : Grid
        Frequencies in cycles per metre; any spacing, any centre, odd and even sizes.
    method : str
        "reference", direct sums in float64; "polygons", exact for outlines; "quads", "chirpz" and
        "fft" for pixels; "auto" takes exact outlines where they exist and the fastest transform of
        pixels elsewhere.
    raster_size : int
        Pixels a side to which outlines are rasterized where the method works on pixels.

    Returns
    -------
    Field
        F in square metres; complex64, complex128 from "reference".

    Raises
    ------
    refuse.Refusal
        Where the grid or the method does not fit.
    """
    check_grid(grid)
    name = refuse.one_of("method", method, ("auto", *METHODS))
    if name == "auto":
        name = _choose(aperture, grid)
    if name == "polygons" and aperture.mask is not None:
        raise refuse.Refusal("method 'polygons' needs outlines and this aperture is a raster; use 'quads'.")
    if name in OF_PIXELS and aperture.mask is None:
        mask = apertures.rasterize(aperture, raster_size)
        aperture = Aperture(aperture.width, mask=mask, name=aperture.name)
    return Field(METHODS[name](aperture, grid), grid)


def check_grid(grid: Grid) -> None:
    """Refuse a grid without samples, with a spacing that is not above zero, or with a lost centre.

    Parameters
    ----------
    grid : Grid
        Any.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    for name, pair in (("shape", grid.shape), ("spacing", grid.spacing), ("centre", grid.centre)):
        refuse.shape_of(f"grid {name}", pair, (2,))
    for axis, count, spacing, centre in zip(
        ("rows", "columns"), grid.shape, grid.spacing, grid.centre, strict=True
    ):
        refuse.at_least(f"grid {axis}", count, 1)
        refuse.positive(f"grid spacing of the {axis}", spacing)
        refuse.finite(f"grid centre of the {axis}", centre)


def _choose(aperture: Aperture, grid: Grid) -> str:
    """Pick exact outlines where there are any, else an FFT where the grid is its own."""
    if aperture.mask is None:
        edges = sum(len(ring.vertices) for ring in aperture.outlines)
        return "polygons" if edges <= MOST_EDGES else "chirpz"
    return "chirpz" if fft_lengths(aperture, grid) is None else "fft"
