"""The near field of an aperture: Fresnel diffraction on a plane at any distance, with any sampling.

`near_field` returns D(x', y') = 1 / (iλz) ∬ f(x, y) exp(iπ((x − x')² + (y − y')²) / (λz)) dx dy, so that
|D|² is 1 where nothing blocks the wave; the phase exp(ikz) is left out. `near_power` returns |D|².
Nothing is sampled in the opening: there is no aliasing, whatever the distance.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction.culling import check_level
from aureole.diffraction.far import RASTER_SIZE, check_grid, computed
from aureole.diffraction.near_culling import culled_near_power
from aureole.diffraction.near_fft import fft_near, fft_near_power, lattice, lengths
from aureole.diffraction.near_outlines import polygons_near, reference_outlines
from aureole.diffraction.near_pixels import (
    Part,
    quads_near,
    quads_near_power,
    quads_parts,
    reference_near,
    rows_near,
    rows_near_power,
    rows_parts,
    used_edges,
)
from aureole.diffraction.quadtree import FINEST, level_mask, quadtree
from aureole.diffraction.rows import Factor, factor, multiplications
from aureole.records import Aperture, Field, Grid

Method = Callable[..., NDArray[Any]]


def _reference(aperture: Aperture, *rest: Any) -> NDArray[Any]:
    return (reference_outlines if aperture.mask is None else reference_near)(aperture, *rest)


METHODS: dict[str, Method] = {
    "reference": _reference,
    "polygons": polygons_near,
    "quads": quads_near,
    "rows": rows_near,
    "fft": fft_near,
}
POWERS: dict[str, Method] = {"quads": quads_near_power, "rows": rows_near_power, "fft": fft_near_power}
# What tiles are computed from, for culling.
PARTS: dict[str, Callable[..., list[Part]]] = {"quads": quads_parts, "rows": rows_parts}
# Above so many edges an outline costs far more than its raster's rows.
MOST_EDGES = 400
OF_PIXELS = ("quads", "rows", "fft")
OF_WAVEFRONTS = ("reference", "rows", "fft")
# Seconds a call and a unit of work, as `rows_work` and `fft_work` list them, fitted by
# benchmarks/near_field.py on two cores.
ROWS_COSTS = (8e-4, 2.5e-9, 2e-11, 2.7e-9)
FFT_COSTS = (8e-4, 1.4e-8)
# What a method finds in an aperture, whatever the distance and the wavelength.
PREPARATIONS: dict[str, Callable[[Aperture], dict[str, Any]]] = {
    "quads": lambda aperture: {"quads": quadtree(_mask_of(aperture), aperture.width)},
    "rows": lambda aperture: {"factors": factor(_mask_of(aperture))},
}


class NearOperator:
    """One aperture on one plane's grid, for many distances and wavelengths.

    What does not depend on these is found once: pixels of outlines, their coarser level, distinct rows
    or rectangles.

    Parameters
    ----------
    aperture : Aperture
        A raster, or outlines.
    grid : Grid
        Places on the plane in metres; any spacing, any centre, odd and even sizes.
    method : str
        As for `near_field`.
    raster_size : int
        As for `near_field`.
    finest : str
        As for `near_field`.

    Raises
    ------
    refuse.Refusal
        Where the grid, the method or the level does not fit.
    """

    def __init__(
        self,
        aperture: Aperture,
        grid: Grid,
        method: str = "auto",
        raster_size: int = RASTER_SIZE,
        finest: str = "full",
    ) -> None:
        check_grid(grid)
        name = refuse.one_of("method", method, ("auto", *METHODS))
        refuse.one_of("finest", finest, FINEST)
        if aperture.wavefront is not None:
            _check_for_wavefront(name, finest)
        if finest != "full" and name not in ("auto", *OF_PIXELS):
            raise refuse.Refusal(
                f"method '{name}' sees an aperture as it is and takes no 'finest'; use 'rows' or 'quads'."
            )
        self.grid, self._chosen = grid, name != "auto"
        if name == "auto" and finest == "full" and aperture.mask is None and _edges(aperture) <= MOST_EDGES:
            name = "polygons"
        self.aperture = _seen(aperture, raster_size, finest) if name in ("auto", *OF_PIXELS) else aperture
        self.method, self.prepared = _fastest(self.aperture, grid) if name == "auto" else (name, {})
        if self.aperture.wavefront is None and not self.prepared and self.method in PREPARATIONS:
            self.prepared = PREPARATIONS[self.method](self.aperture)

    def field(self, distance: float, wavelength: float) -> Field:
        """Return the amplitude on the plane.

        Parameters
        ----------
        distance, wavelength : float
            Metres.

        Returns
        -------
        Field
            D, without unit; complex64, complex128 from "reference".

        Raises
        ------
        refuse.Refusal
            Where a number is not above zero, or the wavefront is too steep for the wavelength.
        """
        self._check(distance, wavelength)
        method = METHODS[self.method]
        return Field(method(self.aperture, self.grid, distance, wavelength, **self.prepared), self.grid)

    def power(self, distance: float, wavelength: float, cull: float | None = None) -> NDArray[Any]:
        """Return |D|² on the plane.

        Parameters
        ----------
        distance, wavelength : float
            Metres.
        cull : float, optional
            As for `near_power`.

        Returns
        -------
        ndarray of float32, shape (rows, columns)
            Without unit; float64 from "reference".

        Raises
        ------
        refuse.Refusal
            Where a number is not above zero, or the wavefront is too steep for the wavelength.
        """
        if cull:
            check_level(cull)
        self._check(distance, wavelength)
        if cull and self._can_cull():
            parts = PARTS[self.method](self.aperture, self.grid, distance, wavelength, **self.prepared)
            return culled_near_power(parts, self.grid, cull)
        if self.method in POWERS:
            return POWERS[self.method](self.aperture, self.grid, distance, wavelength, **self.prepared)
        amplitude = self.field(distance, wavelength).amplitude
        return np.asarray(amplitude.real**2 + amplitude.imag**2)

    def _can_cull(self) -> bool:
        """Say whether tiles can be left out; refuse where this was not left to us."""
        serves = self.method in PARTS and self.aperture.wavefront is None
        if not serves and self._chosen:
            raise refuse.Refusal(
                f"method '{self.method}' computes every place of this aperture and cannot cull; use 'auto'."
            )
        return serves

    def _check(self, distance: float, wavelength: float) -> None:
        refuse.positive("distance", distance)
        refuse.positive("wavelength", wavelength)
        if self.aperture.wavefront is not None:
            apertures.check_wavefront(self.aperture, wavelength)


def near_field(
    aperture: Aperture,
    grid: Grid,
    distance: float,
    wavelength: float,
    method: str = "auto",
    raster_size: int = RASTER_SIZE,
    finest: str = "full",
) -> Field:
    """Return the amplitude behind an aperture lit by a plane wave of amplitude 1 (Fresnel).

    Parameters
    ----------
    aperture : Aperture
        A raster, or outlines, which the methods of pixels, "quads", "rows" and "fft", rasterize: pixels of
        a coverage raster are near the exact outline, and not the same.
    grid : Grid
        Places on the plane in metres; any spacing, any centre, odd and even sizes.
    distance : float
        Of the plane from the aperture, metres.
    wavelength : float
        Metres.
    method : str
        "reference", direct sums in float64, of outlines along their boundary; "polygons", exact
        outlines by their edges; "quads", over signed rectangles; "rows", over the mask's distinct rows;
        "fft", a convolution, where the places are as far apart as the pixels; "auto" takes "polygons"
        for outlines of up to 400 edges that are not wanted coarser, else what should be the fastest of
        "rows" and "fft". A wavefront is served by these two and by "reference".
    raster_size : int
        Pixels a side to which outlines are rasterized.
    finest : str
        "full", or "half", "quarter" or "eighth" to see the mask averaged over squares of 2, 4 or 8
        pixels (quad paper Figure 6), for methods of pixels.

    Returns
    -------
    Field
        D, without unit; complex64, complex128 from "reference".

    Raises
    ------
    refuse.Refusal
        Where the grid, the distance, the wavelength, the method or the level does not fit.
    """
    refuse.positive("distance", distance)
    refuse.positive("wavelength", wavelength)
    return NearOperator(aperture, grid, method, raster_size, finest).field(distance, wavelength)


def near_power(
    aperture: Aperture,
    grid: Grid,
    distance: float,
    wavelength: float,
    method: str = "auto",
    raster_size: int = RASTER_SIZE,
    finest: str = "full",
    cull: float | None = None,
) -> NDArray[Any]:
    """Return |D|² behind an aperture lit by a plane wave of irradiance 1, D as of `near_field`.

    Parameters
    ----------
    aperture : Aperture
        A raster, or outlines.
    grid : Grid
        Places on the plane in metres; any spacing, any centre, odd and even sizes.
    distance, wavelength : float
        Metres.
    method : str
        As for `near_field`.
    raster_size : int
        As for `near_field`.
    finest : str
        As for `near_field`.
    cull : float, optional
        A level, of the irradiance where nothing blocks the wave: what lies below it may be left at zero
        where that saves time: on planes wider than the opening, close behind it. Methods "auto", "rows"
        and "quads" take it; None or 0 leaves nothing out.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Without unit; float64 from "reference".

    Raises
    ------
    refuse.Refusal
        Where the grid, the distance, the wavelength, the method or a level does not fit.
    """
    refuse.positive("distance", distance)
    refuse.positive("wavelength", wavelength)
    return NearOperator(aperture, grid, method, raster_size, finest).power(distance, wavelength, cull)


def _seen(aperture: Aperture, raster_size: int, finest: str) -> Aperture:
    """Return an aperture as pixels of the wanted level."""
    if aperture.mask is None:
        mask = apertures.rasterize(aperture, raster_size)
        aperture = Aperture(aperture.width, mask=mask, name=aperture.name)
    if finest == "full":
        return aperture
    level = level_mask(_mask_of(aperture), finest).astype(np.float32)
    return Aperture(aperture.width, mask=level, name=aperture.name)


def _check_for_wavefront(name: str, finest: str) -> None:
    if name not in ("auto", *OF_WAVEFRONTS):
        raise refuse.Refusal(
            f"method '{name}' takes real transmittances and this aperture has a wavefront; use 'rows'."
        )
    if finest != "full":
        raise refuse.Refusal(f"'finest' must be 'full' for an aperture with a wavefront, got '{finest}'.")


def _edges(aperture: Aperture) -> int:
    return sum(len(ring.vertices) for ring in aperture.outlines)


def _fastest(aperture: Aperture, grid: Grid) -> tuple[str, dict[str, Any]]:
    """Name the method of pixels that should take the least time; what was found of its rows."""
    found = lattice(aperture, grid)
    if aperture.wavefront is not None:
        # Two masks of full rank never take less than one complex convolution.
        return ("rows" if found is None else "fft"), {}
    factors = factor(_mask_of(aperture))
    if found is not None:
        rows, convolution = (
            sum(cost * work for cost, work in zip(costs, works, strict=True))
            for costs, works in (
                (ROWS_COSTS, rows_work(aperture, factors, grid)),
                (FFT_COSTS, fft_work(aperture, grid, found)),
            )
        )
        if convolution < rows:
            return "fft", {}
    return "rows", {"factors": factors}


def rows_work(aperture: Aperture, factors: list[Factor], grid: Grid) -> list[float]:
    """Return what 'rows' has to do.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    factors : list of Factor
        What `rows.factor` found in its mask.
    grid : Grid
        Metres.

    Returns
    -------
    list of float
        Calls, Fresnel integrals, multiplications, and places and pixels.
    """
    size, (rows, columns) = len(_mask_of(aperture)), computed(grid)
    used_y, used_x = (int(used.sum()) for used in used_edges(factors, (size + 1) // 2))
    integrals = 2 * (max(used_y, used_x) * rows if rows == columns else used_y * rows + used_x * columns)
    outputs = grid.shape[0] * grid.shape[1] + size**2
    return [1, integrals, multiplications(factors, 2 * rows, 2 * columns), outputs]


def fft_work(aperture: Aperture, grid: Grid, found: list[tuple[int, int]]) -> list[float]:
    """Return what 'fft' has to do.

    Parameters
    ----------
    aperture : Aperture
        A raster.
    grid : Grid
        Metres.
    found : list of tuple of int
        From `near_fft.lattice`.

    Returns
    -------
    list of float
        Calls, and samples transformed.
    """
    (_, _, length_y), (_, _, length_x) = lengths(aperture, grid, found)
    lit = int(_mask_of(aperture).any(axis=1).sum())
    return [1, lit * length_x + grid.shape[1] * length_y]


def _mask_of(aperture: Aperture) -> NDArray[np.float32]:
    assert aperture.mask is not None
    return aperture.mask
