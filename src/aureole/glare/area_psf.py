"""A lamp with a size behind occluders, in colour: its point spread function, and its picture with glare.

Each distinct opening that a point of the lamp sees has a starburst of its own, in all wavelengths and
integrated over the camera's pixels. Their mean, weighed by what each lets through, is the spread of the
lamp's light about the place where it comes from, and every visible part of the lamp is spread with it (quad
paper §6.1). So the glare of each part is that of the whole lamp, moved to its place: exact where all parts
see alike, and wrong by no more than the lamp's own size elsewhere.
"""

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import diffraction, light, picture, refuse
from aureole.aperture import Occluder
from aureole.glare.area_light import (
    CELL,
    STEPS,
    AreaLight,
    difference,
    light_samples,
    sample_openings,
)
from aureole.glare.camera import in_rgb, pupil
from aureole.glare.kernel import beyond_core
from aureole.records import Aperture, Camera, Grid, Picture, Spectrum, Stage

# Openings whose corners lie nearer than this part of the width are one.
SAME_CORNER = 1e-6
# Pixels about the lamp's own that do not count where patterns are compared.
CORE = 2.0
# Samples across the lamp, at least, that say how much of it is visible.
FINE = 9
# Pixels a side about the core where patterns are compared, and what part of the work that is held to be.
PROBE, PROBED = 129, 0.3


@dataclass(frozen=True, eq=False)
class AreaPsf:
    """The spread of a lamp's light, seen past occluders.

    Parameters
    ----------
    psf : Picture
        Linear RGB, its core at (rows // 2, columns // 2); over the infinite plane it sums to `visible`.
    visible : float
        Part of the lamp's light that comes in, of what would without occluders.
    seen : ndarray of float64, shape (across, across)
        What each cell of the lamp's square sends in, as a share of the lamp's light; it sums to `visible`.
    openings : int
        How many distinct openings were computed.
    error : float
        Sum of absolute differences from the next coarser samples, beyond the core and within 64 pixels of
        it, over the sum there, or over that of the unhidden lamp where it is more; 0 where nothing was
        compared.
    """

    psf: Picture
    visible: float
    seen: NDArray[np.float64]
    openings: int
    error: float = 0.0


def area_psf(
    camera: Camera,
    lamp: AreaLight,
    occluders: Sequence[Occluder],
    shape: tuple[int, int],
    spectrum: Spectrum | None = None,
    colour_space: str = "rec709",
    across: int | None = None,
    tolerance: float = 0.05,
    size: int | None = None,
) -> AreaPsf:
    """Return how a camera spreads the light of a lamp that stands behind occluders.

    Parameters
    ----------
    camera : Camera
        Any.
    lamp : AreaLight
        The lamp.
    occluders : sequence of Occluder
        What stands between.
    shape : tuple of int
        (rows, columns) of the point spread function.
    spectrum : Spectrum, optional
        The lamp's; equal energy unless given.
    colour_space : str
        Primaries of the result.
    across : int, optional
        Samples across the lamp; without it as many as the tolerance needs, 33 at most.
    tolerance : float
        By what part the light about the core may change from about half as many samples across, as the
        result's error says it.
    size : int, optional
        Pixels a side to which openings are rasterized; without it outlines stay exact.

    Returns
    -------
    AreaPsf
        Dark where the lamp is hidden.

    Raises
    ------
    refuse.Refusal
        Where a number or a choice does not fit.
    """
    found = None
    for stage in area_psf_stages(
        camera, lamp, occluders, shape, spectrum, colour_space, across, tolerance, size
    ):
        found = stage.result
    assert isinstance(found, AreaPsf)
    return found


def area_psf_stages(
    camera: Camera,
    lamp: AreaLight,
    occluders: Sequence[Occluder],
    shape: tuple[int, int],
    spectrum: Spectrum | None = None,
    colour_space: str = "rec709",
    across: int | None = None,
    tolerance: float = 0.05,
    size: int | None = None,
) -> Iterator[Stage]:
    """Do what `area_psf` does, telling how far it is.

    Parameters
    ----------
    camera : Camera
        As in `area_psf`.
    lamp : AreaLight
        As in `area_psf`.
    occluders : sequence of Occluder
        As in `area_psf`.
    shape : tuple of int
        As in `area_psf`.
    spectrum : Spectrum, optional
        As in `area_psf`.
    colour_space : str
        As in `area_psf`.
    across : int, optional
        As in `area_psf`.
    tolerance : float
        As in `area_psf`.
    size : int, optional
        As in `area_psf`.

    Yields
    ------
    Stage
        The last one holds the `AreaPsf`.
    """
    refuse.one_of("colour_space", colour_space, light.SPACES)
    refuse.positive("tolerance", tolerance)
    white = light.illuminant("E") if spectrum is None else spectrum
    pitch_y, pitch_x = camera.pixel_pitch
    grid = Grid(shape, (pitch_y / camera.focal_length, pitch_x / camera.focal_length))
    scene, error = (pupil(camera), occluders, lamp), 0.0
    if across is None:
        views, error = yield from _enough(scene, grid, white, tolerance, size)
    else:
        views = _views(*scene, refuse.at_least("across", across, 1), size)
    start = 0.0 if across is not None else PROBED
    total = yield from _summed(views, grid, white, start, 1.0)
    rgb = in_rgb(Picture(total, "xyz"), white, colour_space)
    psf = Picture(rgb, colour_space, {"pixel_pitch": camera.pixel_pitch})
    yield Stage(1.0, "lamp", AreaPsf(psf, float(views.seen.sum()), views.seen, len(views.openings), error))


def _enough(
    scene: tuple[Aperture, Sequence[Occluder], AreaLight],
    grid: Grid,
    white: Spectrum,
    tolerance: float,
    size: int | None,
) -> Generator[Stage, None, tuple["_Views", float]]:
    """Find how many samples are enough, by the pixels about the core: fringes are slowest to settle there.

    Parameters
    ----------
    scene : tuple
        Opening, occluders, lamp.
    grid : Grid
        Of the whole pattern.
    white : Spectrum
        The lamp's.
    tolerance : float
        As in `area_psf`.
    size : int, optional
        As in `area_psf`.

    Yields
    ------
    Stage
        Up to `PROBED`.

    Returns
    -------
    tuple
        The views, and their error.
    """
    shape = min(grid.shape[0], PROBE), min(grid.shape[1], PROBE)
    probe, beyond = Grid(shape, grid.spacing), beyond_core(shape, CORE)[..., None]
    unhidden = diffraction.starburst(scene[0], probe, white).pixels * beyond
    least = float(unhidden.sum(dtype=np.float64))
    before: NDArray[np.float32] | None = None
    visible: list[float] = []
    for step, count in enumerate(STEPS):
        views = _views(*scene, count, size)
        visible.append(float(views.seen.sum()))
        start, end = (PROBED * at / len(STEPS) for at in (step, step + 1))
        found = yield from _summed(views, probe, white, start, end)
        found *= beyond
        if before is not None:
            error = difference(found, before, least)
            if error <= tolerance:
                break
        before = found
    if count < FINE:
        step, count = step + 1, STEPS[step + 1]
        visible.append(float(_views(*scene, count, size).seen.sum()))
    return _scaled(views, _limit(visible[-2:], STEPS[step - 1 : step + 1])), error


def _limit(visible: Sequence[float], counts: Sequence[int]) -> float:
    """Return what the visible part of many more samples would be: its error falls as the square of theirs.

    L. F. Richardson, "The approximate arithmetical solution by finite differences", 1911.
    """
    (coarse, fine), ratio = visible, (counts[1] / counts[0]) ** 2
    return min(max(fine + (fine - coarse) / (ratio - 1), 0.0), 1.0)


def _scaled(views: "_Views", visible: float) -> "_Views":
    """Return views with so much light in all; their shares stay as they are where none has any."""
    total = float(views.seen.sum())
    scale = visible / total if total > 0 else 1.0
    return _Views(views.seen * scale, [(share * scale, opening) for share, opening in views.openings])


def _summed(
    views: "_Views", grid: Grid, white: Spectrum, start: float, end: float
) -> Generator[Stage, None, NDArray[np.float32]]:
    """Return the mean starburst of all views, telling how far it is between two fractions of the whole."""
    total = np.zeros((*grid.shape, 3), dtype=np.float32)
    count = len(views.openings)
    for index, (share, opening) in enumerate(views.openings):
        yield Stage(
            start + (end - start) * index / count, f"lamp seen through opening {index + 1} of {count}"
        )
        total += np.float32(share) * diffraction.starburst(opening, grid, white).pixels
    return total


@dataclass(frozen=True, eq=False)
class _Views:
    """The distinct openings that a lamp's points see, each with its share of the lamp's light.

    Parameters
    ----------
    seen : ndarray of float64, shape (across, across)
        What each cell of the lamp sends in.
    openings : list of tuple
        (share, opening).
    """

    seen: NDArray[np.float64]
    openings: list[tuple[float, Aperture]]


def _views(
    opening: Aperture, occluders: Sequence[Occluder], lamp: AreaLight, across: int, size: int | None
) -> _Views:
    """Look at the opening from each sample of the lamp, and gather the views that are alike."""
    whole = opening
    if size is not None:
        whole = Aperture(opening.width, mask=apertures.rasterize(opening, size))
    all_light = apertures.energy(whole)
    samples = light_samples(lamp, across)
    seen, shares, kept = np.zeros((across, across)), dict[bytes, float](), dict[bytes, Aperture]()
    opened = sample_openings(opening, occluders, lamp, samples, size)
    for (row, column), (weight, left) in zip(samples.cells, opened, strict=True):
        if left is None:
            continue
        key = _key(left)
        kept.setdefault(key, left)
        share = weight * min(apertures.energy(left) / all_light, 1.0)
        seen[row, column] = share
        shares[key] = shares.get(key, 0.0) + share
    return _Views(seen, [(share, kept[key]) for key, share in shares.items()])


def _key(opening: Aperture) -> bytes:
    """Return bytes that are alike where openings are."""
    if opening.mask is not None:
        return opening.mask.tobytes()
    step = SAME_CORNER * opening.width
    words = []
    for ring in opening.outlines:
        corners = np.rint(np.column_stack([ring.vertices / step, ring.bulges / SAME_CORNER])) + 0.0
        words.append(np.append(corners, ring.transmittance).tobytes())
    return b"".join(words)


def area_glare(
    found: AreaPsf, camera: Camera, lamp: AreaLight, colour: tuple[float, float, float] = (1.0, 1.0, 1.0)
) -> Picture:
    """Return the picture of a lamp with its glare, on black.

    Parameters
    ----------
    found : AreaPsf
        As `area_psf` gives it for this camera and this lamp; its point spread function should reach
        across the picture.
    camera : Camera
        Its resolution is the picture's.
    lamp : AreaLight
        The lamp.
    colour : tuple of float
        What all pixels of the unhidden lamp would sum to, in each channel.

    Returns
    -------
    Picture
        Shape (rows, columns, 3); what falls within the frame and the point spread function's reach.

    Raises
    ------
    refuse.Refusal
        Where the colour is not finite.
    """
    strength = refuse.all_finite("colour", refuse.shape_of("colour", colour, (3,))).astype(np.float32)
    sharp = lamp_picture(found, camera, lamp)
    if found.visible <= 0:
        return Picture(np.zeros((*camera.resolution, 3), dtype=np.float32), found.psf.colour_space)
    kernel = found.psf.pixels / np.float32(found.visible)
    stacked = np.repeat(sharp[..., None], 3, axis=2)
    spread = picture.convolve(stacked, kernel, method="fft", precision="double")
    pixels = (spread * strength).astype(np.float32)
    return Picture(pixels, found.psf.colour_space)


def lamp_picture(found: AreaPsf, camera: Camera, lamp: AreaLight) -> NDArray[np.float32]:
    """Return where the light comes from that enters the camera: the visible lamp, sharp.

    Parameters
    ----------
    found : AreaPsf
        What each cell of the lamp sends in.
    camera : Camera
        Its resolution is the picture's.
    lamp : AreaLight
        The lamp.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        Shares of the lamp's light, each pixel what falls on its square; they sum to what is visible of
        it within the frame.
    """
    across = len(found.seen)
    fine = apertures.rasterize(lamp.shape, across * CELL).astype(np.float64)
    parts = fine.reshape(across, CELL, across, CELL)
    lit = parts.sum(axis=(1, 3))
    level = np.divide(found.seen, lit, out=np.zeros_like(lit), where=lit > 0)
    fine = (parts * level[:, None, :, None]).reshape(fine.shape)
    side = len(fine)
    # The middle of pixel (rows // 2, columns // 2) is the axis, as of a `Grid`.
    rows, columns = (
        _covered(at - lamp.shape.width / 2, lamp.shape.width / side, side, pitch / camera.focal_length, count)
        for at, pitch, count in zip(lamp.toward[::-1], camera.pixel_pitch, camera.resolution, strict=True)
    )
    return np.asarray(rows @ fine @ columns.T, dtype=np.float32)


def _covered(first: float, step: float, count: int, pitch: float, pixels: int) -> NDArray[np.float64]:
    """Return which part of each of a row of strips falls on each pixel, (pixels, count)."""
    edges = (np.arange(pixels + 1) - pixels // 2 - 0.5) * pitch
    strips = first + step * np.arange(count + 1)
    low = np.maximum(strips[None, :-1], edges[:-1, None])
    high = np.minimum(strips[None, 1:], edges[1:, None])
    return np.asarray(np.clip(high - low, 0, None) / step)
