"""A camera's glare that changes over the frame: the cat's eye of its housing, and dirt before its pupil.

A field has a point spread function for each of a few places; each pixel's light is shared among the
nearest four by straight lines, as in `eye_field`:

    out = Σ_k K_k ⊗ (h_k L),   Σ_k h_k = 1,

and all light is kept, since each kernel keeps its own.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import picture, refuse
from aureole.aperture import Rim
from aureole.glare.bloom import BloomSpread
from aureole.glare.camera import pupil
from aureole.glare.composite import Composition, kernel_parts
from aureole.glare.eye_field import PsfAt, axis_nodes, node_shares
from aureole.records import Aperture, Camera, Picture

Place = tuple[float, float]
# A camera's housing darkens smoothly, so it is found at so many places (down, across).
VIGNETTE_NODES = (9, 13)


def camera_places(
    camera: Camera, shape: tuple[int, int], nodes: tuple[int, int], corner: tuple[int, int] = (0, 0)
) -> list[tuple[Place, Place]]:
    """Return the places of a field's point spread functions.

    Parameters
    ----------
    camera : Camera
        Its resolution that of the whole sensor.
    shape : tuple of int
        (rows, columns) of the pictures.
    nodes : tuple of int
        How many places (down, across): the border's pixels and between them; 1 is the middle.
    corner : tuple of int
        (row, column) on the sensor of the picture's first pixel.

    Returns
    -------
    list of ((row, column), (right, down))
        Each place in pixels of the picture, and its direction off the axis in radians; row by row.

    Raises
    ------
    refuse.Refusal
        Where a count is below 1.
    """
    down, across = (axis_nodes(n, count) for n, count in zip(shape, nodes, strict=True))
    return [((y, x), camera_direction(camera, (y + corner[0], x + corner[1]))) for y in down for x in across]


def camera_direction(camera: Camera, place: Place) -> Place:
    """Return the direction that a place on the sensor stands for.

    Parameters
    ----------
    camera : Camera
        Any.
    place : tuple of float
        (row, column) of a pixel of the whole sensor.

    Returns
    -------
    tuple of float
        Radians off the axis (right, down), as the picture shows them.
    """
    down, right = (
        math.atan((at - (n - 1) / 2) * pitch / camera.focal_length)
        for at, n, pitch in zip(place, camera.resolution, camera.pixel_pitch, strict=True)
    )
    return right, down


def camera_at(camera: Camera, rims: Sequence[Rim], direction: Place) -> Camera:
    """Return a camera whose iris is what the lens's housing leaves of it from a direction.

    Parameters
    ----------
    camera : Camera
        As on the axis.
    rims : sequence of Rim
        Of the lens, metres.
    direction : tuple of float
        Radians off the axis (right, down).

    Returns
    -------
    Camera
        For `camera_psf`; the camera itself where no rim cuts its pupil.

    Raises
    ------
    refuse.Refusal
        Where nothing is left.
    """
    whole = pupil(camera)
    left = apertures.behind_rims(whole, rims, direction)
    return camera if left is whole else replace(camera, iris=left)


def camera_within(camera: Camera, outline: Aperture) -> Camera:
    """Return a camera whose iris is what lies within an outline.

    Parameters
    ----------
    camera : Camera
        Any.
    outline : Aperture
        At its size before the camera's pupil, metres, as `aureole.flare.TracedHousing` finds it.

    Returns
    -------
    Camera
        For `camera_psf`.

    Raises
    ------
    refuse.Refusal
        Where nothing is left.
    """
    return replace(camera, iris=apertures.intersection(pupil(camera), outline))


def open_share_of(camera: Camera, cropped: Camera) -> float:
    """Return the part of a camera's light that is left to it behind its housing.

    Parameters
    ----------
    camera : Camera
        As on the axis.
    cropped : Camera
        From `camera_at`.

    Returns
    -------
    float
        0 to 1.
    """
    if cropped is camera:
        return 1.0
    return min(1.0, apertures.energy(pupil(cropped)) / apertures.energy(pupil(camera)))


def field_prepare(
    psf_at: PsfAt,
    camera: Camera,
    shape: tuple[int, int],
    nodes: tuple[int, int],
    mode: str = "replace",
    core_radius: float = 2.0,
    precision: str = "single",
    corner: tuple[int, int] = (0, 0),
) -> Composition:
    """Make point spread functions of several places ready for many pictures of one size.

    Parameters
    ----------
    psf_at : callable
        Takes a direction (right, down) in radians off the axis to a point spread function, as
        ``lambda direction: glare.camera_psf(glare.camera_at(camera, rims, direction), shape)``.
    camera : Camera
        Its resolution that of the whole sensor.
    shape : tuple of int
        (rows, columns) of the pictures.
    nodes : tuple of int
        How many places (down, across).
    mode : str
        One of `aureole.glare.MODES`.
    core_radius : float
        As in `aureole.glare.prepare`.
    precision : str
        As in `aureole.glare.prepare`.
    corner : tuple of int
        (row, column) on the sensor of the picture's first pixel.

    Returns
    -------
    Composition
        To be given to `aureole.glare.composite`.

    Raises
    ------
    refuse.Refusal
        As `aureole.glare.prepare`, or where the point spread functions' colour spaces differ.
    """
    refuse.one_of("precision", precision, ("single", "double"))
    core = np.zeros((*shape, 3), dtype=np.float32)
    returned = 0.0
    places = camera_places(camera, shape, nodes, corner)
    lots: dict[int, tuple[Picture, NDArray[np.float32]]] = {}
    for (_, direction), share in zip(places, node_shares(shape, nodes), strict=True):
        psf = psf_at(direction)
        # Places that have one point spread function need one convolution.
        lots[id(psf)] = (psf, lots[id(psf)][1] + share if id(psf) in lots else share)
    spaces = {psf.colour_space for psf, _ in lots.values()}
    if len(spaces) > 1:
        raise refuse.Refusal(f"'psf_at' must give one colour space, got {', '.join(sorted(spaces))}.")
    kernels, shares, stays = [], [], []
    for psf, share in lots.values():
        kernel, kept, lost = kernel_parts(psf, mode, core_radius)
        core += share[..., None] * kept
        returned += lost * float(share.mean(dtype=np.float64))
        kernels.append(kernel)
        shares.append(share)
        stays.append(kept)
    if mode == "bloom":
        return Composition(mode, core, returned, _BloomField(kernels, shares, stays))
    return Composition(mode, core, returned, picture.PlacesConvolver(kernels, shares, precision))


class _BloomField:
    """Bloom of several places, each with its share of each pixel, and what stays of it."""

    def __init__(
        self,
        kernels: Sequence[NDArray[np.float32]],
        shares: Sequence[NDArray[np.float32]],
        stays: Sequence[NDArray[np.float32]],
    ) -> None:
        rows, columns = shares[0].shape
        spreads = [
            BloomSpread(kernel, kept, (rows, columns)) for kernel, kept in zip(kernels, stays, strict=True)
        ]
        self._parts = list(zip(spreads, shares, strict=True))

    def __call__(self, pixels: NDArray[np.floating]) -> NDArray[np.float32]:
        """Spread the light of one picture, and add what stays."""
        out = np.zeros(pixels.shape, dtype=np.float32)
        for spread, share in self._parts:
            out += spread(pixels * share[..., None])
        return out


def vignette(
    camera: Camera,
    open_part: Callable[[Place], float],
    shape: tuple[int, int],
    corner: tuple[int, int] = (0, 0),
) -> NDArray[np.float32]:
    """Return the part of the pupil that is open to each pixel's light: mechanical vignetting.

    Parameters
    ----------
    camera : Camera
        Its resolution that of the whole sensor.
    open_part : callable
        Takes a direction (right, down) in radians off the axis to the part that is open, as
        ``lambda direction: aperture.open_part(pupil, rims, direction)``.
    shape : tuple of int
        (rows, columns) of the picture.
    corner : tuple of int
        (row, column) on the sensor of the picture's first pixel.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        1 where no rim cuts the pupil; the natural fall by cos⁴ is not in it.

    Raises
    ------
    refuse.Refusal
        Where nothing is left of the pupil somewhere.
    """
    places = camera_places(camera, shape, VIGNETTE_NODES, corner)
    out = np.zeros(shape, dtype=np.float32)
    for (_, direction), share in zip(places, node_shares(shape, VIGNETTE_NODES), strict=True):
        out += np.float32(open_part(direction)) * share
    return out
