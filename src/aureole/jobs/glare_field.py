"""A camera's glare over the frame: point spread functions of several places, made one after the other."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import flare, glare, refuse
from aureole.aperture import Rim
from aureole.records import Camera, Picture, Stage

# Places (down, across) that a field has unless said otherwise.
NODES = (3, 5)


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
    """

    nodes: tuple[int, int] = NODES
    lens: str | None = None
    rims: tuple[Rim, ...] = ()
    vignette: bool = False

    def all_rims(self, camera: Camera) -> tuple[Rim, ...]:
        """Return the lens's rims at the camera's focal length, and the further ones."""
        if self.lens is None:
            return self.rims
        lens, _ = flare.open_lens(self.lens)
        return (*self.rims, *flare.housing_rims(lens, camera.focal_length))


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


def field_stages(
    field: GlareField,
    camera_from: Callable[[tuple[float, float] | None], Camera],
    psf_from: Callable[[Camera], Iterator[Stage]],
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
    camera_from : callable
        Takes a direction (right, down) in radians, or None, to the camera without its rims.
    psf_from : callable
        Takes a camera to stages, the last of which holds its point spread function.
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
    for count in field.nodes:
        refuse.between("field", refuse.at_least("field", count, 1), 1, 99)
    camera = camera_from(None)
    rims = field.all_rims(camera)
    places = glare.camera_places(camera, shape, field.nodes, corner)
    seen: dict[tuple[float, float], Picture] = {}
    open_parts: list[float] = []
    unchanged: Picture | None = None
    for number, (_, direction) in enumerate(places):
        here = camera_from(direction)
        cropped = glare.camera_at(here, rims, direction)
        is_plain = cropped is camera
        if not is_plain or unchanged is None:
            label, psf = f"place {number + 1} of {len(places)}", None
            for stage in psf_from(cropped):
                psf = stage.result
                yield Stage((number + stage.fraction) / len(places), label)
            assert isinstance(psf, Picture)
            unchanged = psf if is_plain else unchanged
        else:
            psf = unchanged
        seen[direction] = psf
        open_parts.append(glare.open_share_of(here, cropped))
    ready = glare.field_prepare(
        seen.__getitem__, camera, shape, field.nodes, mode, precision=precision, corner=corner
    )
    dark = glare.vignette(camera, rims, shape, corner) if field.vignette else None
    report = {
        "field_places": [field.nodes[1], field.nodes[0]],
        "field_kernels": len({id(psf) for psf in seen.values()}),
        "rims": len(rims),
        "open_part_least": min(open_parts),
    }
    middle = seen[min(places, key=lambda place: place[1][0] ** 2 + place[1][1] ** 2)[1]]
    yield Stage(1.0, "field", PreparedField(ready, middle, dark, report))
