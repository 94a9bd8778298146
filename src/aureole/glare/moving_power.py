"""The power of an area light while occluders move: each opening from the last one of the frame before.

Openings of one frame differ little from those of the next, so the far field is never taken anew (quad paper
§4.3 and §4.4): `ProgressiveFarField` transforms the pixels that opened or closed. It is for one wavelength
and for rasters, such as mattes; outlines in colour have starbursts of their own, which are exact
(`area_psf`). Frames must be made in their order for that, in one process; each is what it would be alone, to
rounding.
"""

from collections.abc import Sequence

from aureole import aperture as apertures
from aureole.aperture import Occluder
from aureole.glare.area_light import RASTER_SIZE, AreaLight, AreaPower, light_samples, sample_openings
from aureole.glare.power_sums import PowerSum
from aureole.records import Aperture, Grid


class MovingPower:
    """The powers of frame after frame.

    Parameters
    ----------
    grid : Grid
        Frequencies in cycles per metre.
    size : int
        Pixels a side of the openings' rasters.

    Raises
    ------
    refuse.Refusal
        Where the grid or the size does not fit.
    """

    def __init__(self, grid: Grid, size: int = RASTER_SIZE) -> None:
        self._size = size
        self._sum = PowerSum(grid, size)

    def frame(
        self, opening: Aperture, occluders: Sequence[Occluder], light: AreaLight, across: int = 9
    ) -> AreaPower:
        """Return the mean power of a frame.

        Parameters
        ----------
        opening : Aperture
            At its size in metres.
        occluders : sequence of Occluder
            Where they stand in this frame.
        light : AreaLight
            Where it stands.
        across : int
            Samples across the light.

        Returns
        -------
        AreaPower
            As `area_power` gives it, to rounding.

        Raises
        ------
        refuse.Refusal
            Where a number does not fit.
        """
        samples = light_samples(light, across)
        whole = apertures.energy(Aperture(opening.width, mask=apertures.rasterize(opening, self._size)))
        visible = 0.0
        self._sum.restart()
        for weight, seen in sample_openings(opening, occluders, light, samples, self._size):
            if seen is not None:
                visible += weight * apertures.energy(seen) / whole
                self._sum.add(seen, weight)
        power = self._sum.result()
        count = len(samples.weights)
        return AreaPower(power, min(visible, 1.0), count, transforms=self._sum.transforms)
