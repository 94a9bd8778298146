"""A camera's glare over the frame: point spread functions of several places, made one after the other."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import flare, glare, refuse
from aureole.aperture import Rim
from aureole.records import Camera, Picture, Stage

# Places (down, across) that a field has unless said otherwise.
NODES = (3, 5)
# How a lens's rims are found: by real rays, or as images near the axis.
LENS_RIMS = ("traced", "paraxial")
# Pixels along each side of the pupils by which places are compared.
PROBE = 96
# A kernel that spreads less of its light than this is all core.
LEAST_SPREAD = 1e-9

Place = tuple[float, float]


@dataclass(frozen=True)
class GlareField:
    """What changes over the frame, and at how many places it is found.

    Parameters
    ----------
    nodes : tuple of int
        Places (down, across), from border to border; light between them is shared among the nearest four.
    lens : str, optional
        Name of a lens, or its file: its rims crop the pupil, scaled to the camera's focal length.
    rims : tuple of Rim
        Further rims, in metres.
    vignette : bool
        Whether the picture darkens as the rims close, too; a photograph is dark there already.
    lens_rims : str
        How the lens's rims are found, one of `LENS_RIMS`.
    """

    nodes: tuple[int, int] = NODES
    lens: str | None = None
    rims: tuple[Rim, ...] = ()
    vignette: bool = False
    lens_rims: str = LENS_RIMS[0]

    def housing(self, camera: Camera) -> "Housing":
        """Return all rims that a camera's light passes."""
        refuse.one_of("lens_rims", self.lens_rims, LENS_RIMS)
        if self.lens is None:
            return Housing(self.rims)
        lens, _ = flare.open_lens(self.lens)
        if self.lens_rims == "paraxial":
            return Housing((*self.rims, *flare.housing_rims(lens, camera.focal_length)))
        radius = apertures.bounding_radius(glare.pupil(camera))
        return Housing(self.rims, flare.TracedHousing(lens, radius, camera.focal_length))


@dataclass(frozen=True, eq=False)
class Housing:
    """Rims that crop a camera's pupil.

    Parameters
    ----------
    rims : tuple of Rim
        Round ones that move with the direction.
    traced : aureole.flare.TracedHousing, optional
        Those of a lens, by real rays.
    """

    rims: tuple[Rim, ...]
    traced: flare.TracedHousing | None = None

    def crop(self, camera: Camera, direction: Place) -> tuple[Camera, float]:
        """Return a camera's pupil as a direction's light finds it, and the part of its light that passes.

        Parameters
        ----------
        camera : Camera
            As on the axis, without its rims.
        direction : tuple of float
            Radians off the axis (right, down).

        Returns
        -------
        camera : Camera
            The same one where no rim cuts its pupil.
        part : float
            Of the light that a pupil without rims would take in; above 1 where a pupil grows as it is seen
            from aside.
        """
        cropped, stretch = glare.camera_at(camera, self.rims, direction), 1.0
        if self.traced is not None:
            seen = self.traced.seen_from(direction)
            stretch = seen.stretch
            if seen.outline is not None:
                cropped = glare.camera_within(cropped, seen.outline)
        return cropped, stretch * glare.open_share_of(camera, cropped)


@dataclass(frozen=True, eq=False)
class PreparedField:
    """A field made ready for pictures of one size.

    Parameters
    ----------
    composition : Composition
        For `aureole.glare.composite`.
    psf : Picture
        Of the place nearest to the middle.
    vignette : ndarray of float32, shape (rows, columns), optional
        What the picture is multiplied by.
    report : dict
        Plain numbers.
    """

    composition: glare.Composition
    psf: Picture
    vignette: NDArray[np.float32] | None
    report: dict[str, Any]


class FieldKernels:
    """Point spread functions by direction, each made once.

    Parameters
    ----------
    housing : Housing
        What crops the pupil.
    camera_from : callable
        Takes a direction (right, down) in radians, or None, to the camera without its rims.
    psf_from : callable
        Takes a camera to stages, the last of which holds its point spread function.
    """

    def __init__(
        self,
        housing: Housing,
        camera_from: Callable[[Place | None], Camera],
        psf_from: Callable[[Camera], Iterator[Stage]],
    ) -> None:
        self.housing, self._camera_from, self._psf_from = housing, camera_from, psf_from
        self.plain = camera_from(None)
        self._cameras: dict[Place, tuple[Camera, float]] = {}
        self._made: dict[Place, Picture] = {}
        self._unchanged: Picture | None = None

    def camera(self, direction: Place) -> Camera:
        """Return the camera as a direction's light finds it."""
        return self._found(direction)[0]

    def open_part(self, direction: Place) -> float:
        """Return the part of the light that passes, over that along the axis."""
        return self._found(direction)[1] / self._found((0.0, 0.0))[1]

    def psf(self, direction: Place) -> Picture:
        """Return a point spread function that has been made."""
        return self._made[_key(direction)]

    def stages(self, directions: Sequence[Place], label: str) -> Iterator[Stage]:
        """Make what is not there yet, from 0 to 1."""
        missing = [where for where in directions if _key(where) not in self._made]
        for number, where in enumerate(missing):
            here = self.camera(where)
            psf = self._unchanged if here is self.plain else None
            for stage in self._psf_from(here) if psf is None else ():
                psf = stage.result
                yield Stage(
                    (number + stage.fraction) / len(missing), f"{label} {number + 1} of {len(missing)}"
                )
            assert psf is not None
            self._unchanged = psf if here is self.plain else self._unchanged
            self._made[_key(where)] = psf

    def _found(self, direction: Place) -> tuple[Camera, float]:
        key = _key(direction)
        if key not in self._cameras:
            self._cameras[key] = self.housing.crop(self._camera_from(direction), direction)
        return self._cameras[key]


def field_stages(
    field: GlareField,
    kernels: FieldKernels,
    shape: tuple[int, int],
    corner: tuple[int, int],
    mode: str,
    precision: str,
) -> Iterator[Stage]:
    """Make a field's point spread functions.

    Parameters
    ----------
    field : GlareField
        What changes.
    kernels : FieldKernels
        Of its housing.
    shape : tuple of int
        (rows, columns) of the pictures.
    corner : tuple of int
        (row, column) on the sensor of the pictures' first pixel.
    mode, precision : str
        As in `aureole.glare.prepare`.

    Yields
    ------
    Stage
        The last one holds a `PreparedField`.

    Raises
    ------
    refuse.Refusal
        Where the lens closes before the frame ends, or a number is outside its range.
    """
    camera = kernels.plain
    nodes, error = field.nodes, 0.0
    for count in nodes:
        refuse.between("field", refuse.at_least("field", count, 1), 1, 99)
    directions = [direction for _, direction in glare.camera_places(camera, shape, nodes, corner)]
    for stage in kernels.stages(directions, "place"):
        yield Stage(0.8 * stage.fraction, stage.label)
    for stage in _error_stages(nodes, kernels, shape, corner):
        error = stage.result or 0.0
        yield Stage(0.8 + 0.1 * stage.fraction, stage.label)
    ready = glare.field_prepare(kernels.psf, camera, shape, nodes, mode, precision=precision, corner=corner)
    dark = glare.vignette(camera, kernels.open_part, shape, corner) if field.vignette else None
    report = {
        "field_places": [nodes[1], nodes[0]],
        "field_kernels": len({id(kernels.psf(where)) for where in directions}),
        "field_error_percent": 100 * error,
        "open_part_least": min(kernels.open_part(where) for where in directions),
    }
    middle = kernels.psf(min(directions, key=lambda where: where[0] ** 2 + where[1] ** 2))
    yield Stage(1.0, "field", PreparedField(ready, middle, dark, report))


def _error_stages(
    nodes: tuple[int, int], kernels: FieldKernels, shape: tuple[int, int], corner: tuple[int, int]
) -> Iterator[Stage]:
    """Find the part of the glare that falls elsewhere where a field is worst: half way between its places.

    The worst place is that where the pupil differs most from the mix of its neighbours' pupils. There the
    point spread function itself is compared with the mix.
    """
    worst, most = None, 0.0
    masks: dict[Place, NDArray[np.float32]] = {}

    def mask(direction: Place) -> NDArray[np.float32]:
        if direction not in masks:
            masks[direction] = apertures.rasterize(kernels.camera(direction).iris, PROBE)
        return masks[direction]

    for direction, neighbours in _between(nodes, kernels.plain, shape, corner):
        mixed = sum(mask(one) for one in neighbours) / len(neighbours)
        apart = float(np.abs(mask(direction) - mixed).sum())
        if apart > most:
            worst, most = (direction, neighbours), apart
    error = 0.0
    if worst is not None:
        direction, neighbours = worst
        for stage in kernels.stages([direction, *neighbours], "between places"):
            yield Stage(stage.fraction, stage.label)
        mix = sum(kernels.psf(one).pixels[..., :3] for one in neighbours) / len(neighbours)
        own = kernels.psf(direction).pixels[..., :3]
        spread = own.sum(axis=(0, 1), dtype=np.float64) - own[own.shape[0] // 2, own.shape[1] // 2]
        away = np.abs(own - mix).sum(axis=(0, 1), dtype=np.float64) / 2
        error = float((away / np.maximum(spread, LEAST_SPREAD)).max())
    yield Stage(1.0, "between places", error)


def _between(
    nodes: tuple[int, int], camera: Camera, shape: tuple[int, int], corner: tuple[int, int]
) -> Iterator[tuple[Place, list[Place]]]:
    """Return directions half way between places (the border's where there is one), and their neighbours."""
    ways = []
    for length, count in zip(shape, nodes, strict=True):
        at = glare.axis_nodes(length, count)
        ways.append([((a + b) / 2, [a, b]) for a, b in pairwise(at)] or [(0.0, at)])
    for (y, ys), (x, xs) in product(*ways):
        near = [glare.camera_direction(camera, (v + corner[0], u + corner[1])) for v in ys for u in xs]
        yield glare.camera_direction(camera, (y + corner[0], x + corner[1])), near


def _key(direction: Place) -> Place:
    """Return a direction without its rounding, so that grids share their places."""
    return round(direction[0], 12), round(direction[1], 12)
