"""The near field of an aperture: Fresnel diffraction on a plane at any distance, with any sampling.

`near_field` returns D(x', y') = 1 / (iλz) ∬ f(x, y) exp(iπ((x − x')² + (y − y')²) / (λz)) dx dy, so that
|D|² is 1 where nothing blocks the wave; the phase exp(ikz) is left out. Nothing is sampled in the
opening: there is no aliasing, whatever the distance.
"""

from collections.abc import Callable
from typing import Any

from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import refuse
from aureole.diffraction.far import RASTER_SIZE, check_grid
from aureole.diffraction.near_outlines import reference_outlines
from aureole.diffraction.near_pixels import quads_near, reference_near, rows_near
from aureole.records import Aperture, Field, Grid

METHODS: dict[str, Callable[..., NDArray[Any]]] = {
    "reference": lambda aperture, *rest: (reference_outlines if aperture.mask is None else reference_near)(
        aperture, *rest
    ),
    "quads": quads_near,
    "rows": rows_near,
}


def near_field(
    aperture: Aperture,
    grid: Grid,
    distance: float,
    wavelength: float,
    method: str = "auto",
    raster_size: int = RASTER_SIZE,
) -> Field:
    """Return the amplitude behind an aperture lit by a plane wave of amplitude 1 (Fresnel).

    Parameters
    ----------
    aperture : Aperture
        A raster, or outlines, which all methods but "reference" rasterize: pixels of a coverage raster
        are near the exact outline, and not the same.
    grid : Grid
        Places on the plane in metres; any spacing, any centre, odd and even sizes.
    distance : float
        Of the plane from the aperture, metres.
    wavelength : float
        Metres.
    method : str
        "reference", direct sums in float64, of outlines along their boundary; "quads", over signed
        rectangles; "rows", over the mask's distinct rows; "auto" takes "rows", and "reference" for an
        aperture with a wavefront, which the others do not serve.
    raster_size : int
        Pixels a side to which outlines are rasterized.

    Returns
    -------
    Field
        D, without unit; complex64, complex128 from "reference".

    Raises
    ------
    refuse.Refusal
        Where the grid, the distance, the wavelength or the method does not fit.
    """
    check_grid(grid)
    refuse.positive("distance", distance)
    refuse.positive("wavelength", wavelength)
    name = refuse.one_of("method", method, ("auto", *METHODS))
    if aperture.wavefront is not None:
        apertures.check_wavefront(aperture, wavelength)
        if name not in ("auto", "reference"):
            raise refuse.Refusal(
                f"method '{name}' takes real transmittances and this aperture has a wavefront; "
                "use 'reference'."
            )
        name = "reference"
    elif aperture.mask is None and name != "reference":
        mask = apertures.rasterize(aperture, raster_size)
        aperture = Aperture(aperture.width, mask=mask, name=aperture.name)
    name = "rows" if name == "auto" else name
    return Field(METHODS[name](aperture, grid, distance, wavelength), grid)
