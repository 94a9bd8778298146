"""The rims of a lens as they are seen from the front: near the axis, or by real rays.

Every semi-aperture has an image before all glass; light passes where it passes all images and the stop's,
the entrance pupil. From off the axis they no longer lie over one another: the lens's cat's eye. Images near
the axis are circles that move (`housing_rims`); real rays find the outline itself (`TracedHousing`).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aureole import aperture as apertures
from aureole import refuse
from aureole.aperture import Rim
from aureole.flare import tracing
from aureole.flare.paraxial import entrance_pupil, focal_length, heights
from aureole.flare.prescription import Lens
from aureole.flare.tracing import Flags, Numbers, Path, Prepared
from aureole.records import Aperture

# Rims that the entrance pupil's own distance differs from by so little are the stop, parts of the length.
SAME = 1e-9
WAVELENGTH = 550e-9
# Directions about the middle of the light in which the outline is found, halvings of each way to it, and
# rays along each side of the grid that finds the middle.
TURNS, HALVINGS, SIDE = 128, 26, 41
# Ringing along an outline costs time by its corners; fringes are far broader than these chords are flat.
RINGING_TURNS = 48
# Where nothing cuts the pupil the outline goes so far beyond its rim that its chords do not cut it either.
BEYOND = 1.02


def housing_rims(lens: Lens, wanted_focal_length: float | None = None, axis: str = "y") -> list[Rim]:
    """Return the rims of a lens before and behind its stop, imaged by what stands before them.

    Parameters
    ----------
    lens : Lens
        The lens.
    wanted_focal_length : float, optional
        Metres: the lens is scaled to it; its own otherwise.
    axis : {"x", "y"}
        In which plane the images are found; the planes differ where surfaces are cylinders.

    Returns
    -------
    list of Rim
        Of all surfaces but the stop, for `aureole.aperture.behind_rims`. These are images near the axis: the
        light that they leave at 8 degrees is within 0.02 of what real rays find for the Cooke triplet and
        the Summicron, 0.05 too little for the Heliar and 0.11 for the Nikkor of f/1.2 (`TracedHousing`).
    """
    own = focal_length(lens, axis)
    scale = 1.0 if wanted_focal_length is None else wanted_focal_length / own
    place, _ = entrance_pupil(lens, axis)
    rims = []
    for surface, found in zip(lens.surfaces, heights(lens, axis), strict=True):
        across, along = float(found[0, 0]), float(found[0, 1])
        # A rim in a focus of what stands before it is seen from infinitely far.
        if surface.stop or abs(across) <= SAME:
            continue
        diameter = 2 * surface.semi_aperture / abs(across)
        rims.append(Rim(scale * diameter, scale * (place - along / across)))
    return rims


@dataclass(frozen=True, eq=False)
class SeenPupil:
    """What of a lens's pupil can be seen from a direction.

    Parameters
    ----------
    outline : Aperture, optional
        What the rims leave, on the pupil and a little beyond its rim, metres; None where they cut nothing.
    stretch : float
        Cross-section of the light through a part of the stop, without the cosine, over that near the axis:
        pupils of some lenses grow as they are seen from aside.
    """

    outline: Aperture | None
    stretch: float


class TracedHousing:
    """The rims of a lens by real rays.

    Rays of one direction are traced to the stop; on the ways from the light's middle outward, halved again
    and again, lies the place where the first semi-aperture, or the stop's rim, ends the light.

    Parameters
    ----------
    lens : Lens
        The lens.
    pupil_radius : float
        How far from the axis the pupil in use reaches, metres.
    wanted_focal_length : float, optional
        Metres: the lens is scaled to it; its own otherwise.

    Raises
    ------
    refuse.Refusal
        Where a number is not above zero, or no light passes along the axis.
    """

    def __init__(self, lens: Lens, pupil_radius: float, wanted_focal_length: float | None = None) -> None:
        scale = 1.0 if wanted_focal_length is None else wanted_focal_length / focal_length(lens)
        self._radius = scale * entrance_pupil(lens)[1]
        self._reach = BEYOND * refuse.positive("pupil_radius", pupil_radius) / self._radius
        self._upright = math.copysign(1.0, float(heights(lens)[lens.stop][0, 0]))
        self._prepared = tracing.prepare(lens, [WAVELENGTH])
        self._stretch = 1.0
        self._stretch = self.seen_from((0.0, 0.0)).stretch

    def seen_from(self, direction: tuple[float, float]) -> SeenPupil:
        """Return what of the pupil light from a direction finds.

        Parameters
        ----------
        direction : tuple of float
            Towards the light, radians off the axis (right, down).

        Returns
        -------
        SeenPupil
            On the pupil as it is seen along the axis, where the iris keeps its shape.

        Raises
        ------
        refuse.Refusal
            Where no light passes, or an angle is beyond 80 degrees.
        """
        # What stands a metre behind the pupil moves by the tangents.
        along = tracing.travel((*apertures.parallax(direction, -1.0), 1.0))
        found = _outline(self._prepared, (), along, self._reach)
        if found is None:
            right, down = (math.degrees(angle) for angle in direction)
            raise refuse.Refusal(
                f"the lens '{self._prepared.lens.name}' lets no light through from {right:.3g} degrees right "
                f"and {down:.3g} degrees down; take a longer focal length, or a smaller sensor."
            )
        front, stop, is_rim = found
        stretch = _area(front) / _area(stop) / self._stretch
        if not is_rim.any():
            return SeenPupil(None, stretch)
        return SeenPupil(apertures.polygon(self._upright * self._radius * stop), stretch)


def stop_outline(
    lens: Lens, path: Path, direction: ArrayLike, iris: Aperture, f_number: float | None = None
) -> Aperture | None:
    """Return what of an iris the rims leave to a ghost's light, or to the image's.

    Parameters
    ----------
    lens : Lens
        The lens.
    path : GhostPath or sequence of int
        The reflections; () is the image.
    direction : array_like, shape (3,)
        From the lens towards the light, z > 0.
    iris : Aperture
        Its width stands for the stop's diameter.
    f_number : float, optional
        Sets the stop; wide open without it.

    Returns
    -------
    Aperture or None
        A convex outline over the iris; None where no rim cuts it, or no light passes.

    Raises
    ------
    refuse.Refusal
        Where the light stands behind the lens, or the reflections are no way through it.
    """
    from shapely import MultiPoint

    prepared = tracing.prepare(lens, [WAVELENGTH], f_number)
    reach = 2 * BEYOND * apertures.bounding_radius(iris) / iris.width
    found = _outline(prepared, path, tracing.travel(direction), reach, RINGING_TURNS)
    if found is None or not found[2].any():
        return None
    # Rims are nearly discs, and what lies in all of some discs is convex.
    hull = np.asarray(MultiPoint(found[1]).convex_hull.exterior.coords)[:-1]
    return apertures.polygon(iris.width / 2 * hull)


def _outline(
    prepared: Prepared, path: Path, along: Numbers, reach: float, count: int = TURNS
) -> tuple[Numbers, Numbers, Flags] | None:
    """Return the light's outline on the first vertex's plane and on the stop, and where a rim made it."""
    first = prepared.lens.surfaces[0].semi_aperture
    side = first * np.linspace(-1, 1, SIDE)
    grid = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    lit = grid[_merit(prepared, path, grid, along, reach)[0] <= 1]
    if not len(lit):
        return None
    middle = lit.mean(axis=0)
    turns = 2 * np.pi * np.arange(count) / count
    ways = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    inside, outside = np.zeros(count), np.full(count, 4 * first)
    for _ in range(HALVINGS):
        half = (inside + outside) / 2
        passes = _merit(prepared, path, middle + half[:, None] * ways, along, reach)[0] <= 1
        inside, outside = np.where(passes, half, inside), np.where(passes, outside, half)
    front = middle + inside[:, None] * ways
    _, stop, is_rim = _merit(prepared, path, front, along, reach)
    return front, stop, is_rim


def _merit(
    prepared: Prepared, path: Path, points: Numbers, along: Numbers, reach: float
) -> tuple[Numbers, Numbers, Flags]:
    """Return how far out rays go (1: to their end), where on the stop, and whether a rim ends them."""
    rays = tracing.follow(prepared, [path], [len(points)], points, along)
    stop = np.stack([rays.stop_x, rays.stop_y], axis=1).astype(np.float64)
    on_stop = np.hypot(*stop.T) / reach
    merit = np.where(rays.reached, np.maximum(rays.level, on_stop), tracing.LOST)
    return merit, stop, np.asarray(rays.level > on_stop)


def _area(points: Numbers) -> float:
    """Return the area of a polygon."""
    x, y = points.T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
