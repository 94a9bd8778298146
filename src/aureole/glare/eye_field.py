"""Glare that changes with the source's place in the frame, and with its strength.

Lashes stand before the pupil, so their shadow on it moves with the direction of the light: the streaks of
a lamp at the frame's left are not those of one at its right (Kakimoto and others 2005). A field has a
point spread function for each of a few places; each pixel's light is shared among the nearest four by
straight lines, so that

    glare = Σ_k K_k ⊗ (h_k w L),   Σ_k h_k = 1,

and all light is kept. Stamps give the brightest sources a point spread function of their own. Layers
take a point spread function apart by angle, so that weak lights get its short needles only.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.glare import _kernels_half
from aureole.glare.eye_composite import (
    BORDERS,
    CORE_ANGLE,
    EyeComposition,
    GlarePart,
    core_pixels,
    glare_kernel,
    glare_part,
    part_of,
    solid_angle_weights,
    tangent_pitch,
)
from aureole.glare.lamps import luminances
from aureole.glare.sources import refuse_other_space
from aureole.records import Picture

PsfAt = Callable[[tuple[float, float]], Picture]
# Sources of up to so many pixels are laid pixel by pixel; larger ones are convolved.
FEW_PIXELS = 64
# Part of the brightest pixel from which on neighbouring pixels are one source.
SOURCE_SHARE = 0.01


def field_places(
    shape: tuple[int, int], field_of_view: float, nodes: tuple[int, int] = (3, 3)
) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Return the places of a field's point spread functions.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns) of the pictures.
    field_of_view : float
        Radians across the columns.
    nodes : tuple of int
        How many places (down, across): the border's pixels and between them; 1 is the middle.

    Returns
    -------
    list of ((row, column), (right, down))
        Each place in pixels, and its direction off the axis in radians; row by row.

    Raises
    ------
    refuse.Refusal
        Where a count is below 1 or the field is not between 0 and 180 degrees.
    """
    down, across = (axis_nodes(n, count) for n, count in zip(shape, nodes, strict=True))
    return [((y, x), direction_of((y, x), shape, field_of_view)) for y in down for x in across]


def direction_of(
    place: tuple[float, float], shape: tuple[int, int], field_of_view: float
) -> tuple[float, float]:
    """Return the direction that a place on a flat picture stands for.

    Parameters
    ----------
    place : tuple of float
        (row, column) of a pixel.
    shape : tuple of int
        (rows, columns) of the picture.
    field_of_view : float
        Radians across the columns.

    Returns
    -------
    tuple of float
        Radians off the axis (right, down).
    """
    pitch = tangent_pitch(shape, field_of_view)
    down, right = (math.atan((at - (n - 1) / 2) * pitch) for at, n in zip(place, shape, strict=True))
    return right, down


def eye_field(
    psf_at: PsfAt,
    shape: tuple[int, int],
    field_of_view: float,
    nodes: tuple[int, int] = (3, 3),
    mode: str = "replace",
    border: str = "keep",
    resolution: str = "full",
    core_angle: float = CORE_ANGLE,
    precision: str = "single",
) -> EyeComposition:
    """Make point spread functions of several places ready for many pictures of one size.

    Parameters
    ----------
    psf_at : callable
        Takes a direction (right, down) in radians off the axis to a point spread function, as
        ``lambda source: glare.eye_psf(state, shape, field_of_view, source=source)``.
    shape : tuple of int
        (rows, columns) of the pictures.
    field_of_view : float
        Radians across the pictures' columns.
    nodes : tuple of int
        How many places (down, across).
    mode, border, resolution : str
        As in `aureole.glare.eye_prepare`.
    core_angle : float
        As in `aureole.glare.eye_prepare`.
    precision : str
        As in `aureole.glare.eye_prepare`.

    Returns
    -------
    EyeComposition
        To be given to `aureole.glare.eye_composite`; each place costs one more convolution.

    Raises
    ------
    refuse.Refusal
        As `aureole.glare.eye_prepare`, or where the point spread functions' colour spaces differ.
    """
    refuse.one_of("border", border, BORDERS)
    weights = solid_angle_weights(shape, field_of_view)
    radius = core_pixels(shape, field_of_view, core_angle)
    places = field_places(shape, field_of_view, nodes)
    parts, spaces = [], set()
    for (_, direction), share in zip(places, node_shares(shape, nodes), strict=True):
        psf = psf_at(direction)
        spaces.add(psf.colour_space)
        parts.append(glare_part(psf, weights * share, field_of_view, mode, resolution, radius, precision))
    if len(spaces) > 1:
        raise refuse.Refusal(f"'psf_at' must give one colour space, got {', '.join(sorted(spaces))}.")
    return EyeComposition(mode, border, tuple(parts), spaces.pop(), field_of_view, radius)


def eye_stamps(
    source: Picture, psf_at: PsfAt, rest: EyeComposition, count: int = 4, threshold: float | None = None
) -> EyeComposition:
    """Give the brightest sources of a picture point spread functions of their own.

    Parameters
    ----------
    source : Picture
        Linear RGB; the result is for this picture only.
    psf_at : callable
        As in `eye_field`.
    rest : EyeComposition
        What all other light is spread with, from `aureole.glare.eye_prepare` or `eye_field`; made with a
        field of view.
    count : int
        How many sources, by their light.
    threshold : float, optional
        Luminance from which on neighbouring pixels are one source; a hundredth of the brightest pixel's
        unless given.

    Returns
    -------
    EyeComposition
        To be given to `aureole.glare.eye_composite`.

    Raises
    ------
    refuse.Refusal
        Where the count is negative, the picture does not fit, or the field of view is not known.
    """
    if rest.field_of_view is None:
        raise refuse.Refusal("'rest' must be made with a field of view for stamps, got none.")
    shape = (source.pixels.shape[0], source.pixels.shape[1])
    refuse.shape_of("picture", source.pixels[..., 0], rest.parts[0].weights.shape)
    weights = solid_angle_weights(shape, rest.field_of_view)
    parts, free = [], np.ones(shape, dtype=np.float32)
    for mask, place in _brightest(source, weights, count, threshold):
        psf = psf_at(direction_of(place, shape, rest.field_of_view))
        refuse_other_space(source, psf)
        parts.append(_stamp(psf, rest, mask, weights))
        free -= mask
    others = [replace(part, weights=part.weights * free) for part in rest.parts]
    return replace(rest, parts=(*others, *parts))


def radial_layers(psf: Picture, angles: Sequence[float], pitch: float) -> list[Picture]:
    """Take a point spread function apart by angle, so that each part can have its own threshold.

    Parameters
    ----------
    psf : Picture
        Energy per pixel, its core at (rows//2, columns//2).
    angles : sequence of float
        Rising, radians: each part goes smoothly into the next from half to twice its angle.
    pitch : float
        Tangent of a pixel's angle at the core (`aureole.glare.tangent_pitch`).

    Returns
    -------
    list of Picture
        One more than the angles, from the core outward; together they are the point spread function.

    Raises
    ------
    refuse.Refusal
        Where the angles do not rise from above zero to below 90 degrees.
    """
    refuse.positive("pitch", pitch)
    edges = [0.0, *(refuse.between("angles", angle, 0, math.pi / 2) for angle in angles)]
    if any(low >= high for low, high in pairwise(edges)):
        raise refuse.Refusal(f"'angles' must rise from above 0, got {list(angles)}.")
    y, x = (np.arange(n) - n // 2 for n in psf.pixels.shape[:2])
    radius = np.arctan(pitch * np.hypot(y[:, None], x))
    inside = [np.ones_like(radius)]
    for angle in reversed(edges[1:]):
        turns = np.clip(np.log2(np.maximum(radius, 1e-12) / angle) + 1, 0, 2) / 2
        # Each window lies inside the next, so no part is negative.
        inside.append(inside[-1] * (0.5 + 0.5 * np.cos(np.pi * turns)))
    windows = [*inside[::-1]]
    parts = [windows[0], *(outer - inner for inner, outer in pairwise(windows))]
    colour = psf.pixels[..., :3]
    return [
        Picture((colour * part[..., None]).astype(np.float32), psf.colour_space, psf.metadata)
        for part in parts
    ]


def _stamp(
    psf: Picture, rest: EyeComposition, mask: NDArray[np.float32], weights: NDArray[np.float32]
) -> GlarePart:
    """Make one source's kernel ready, laid pixel by pixel where the source is small."""
    shape = (mask.shape[0], mask.shape[1])
    kernel = glare_kernel(psf, shape, rest.field_of_view, rest.mode, rest.core_radius)
    is_small = np.count_nonzero(mask) <= FEW_PIXELS
    spread = partial(_laid, kernel) if is_small else picture.Convolver(kernel, shape)
    return part_of(kernel, weights * mask, spread)


def _laid(kernel: NDArray[np.float32], lit: NDArray[np.float32]) -> NDArray[np.float32]:
    rows, columns = np.nonzero(lit.any(axis=2))
    out = np.zeros_like(lit)
    _kernels_half.splat(rows, columns, lit[rows, columns], kernel, out)
    return out


def _brightest(
    source: Picture, weights: NDArray[np.float32], count: int, threshold: float | None
) -> list[tuple[NDArray[np.float32], tuple[float, float]]]:
    """Return the masks and places of the sources with most light, the strongest first."""
    luminance = luminances(source)
    if threshold is None:
        threshold = SOURCE_SHARE * float(luminance.max())
    level = refuse.finite("threshold", threshold)
    found = picture.measured_regions(picture.bright_labels(luminance, max(level, 0)), luminance * weights)
    # Directions count from the middle of pixels.
    return [
        ((found.labels == k + 1).astype(np.float32), (float(y) - 0.5, float(x) - 0.5))
        for k, (x, y) in enumerate(found.places[: refuse.at_least("count", count, 0)])
    ]


def axis_nodes(length: int, count: int) -> list[float]:
    """Return places along an axis, from the first pixel to the last.

    Parameters
    ----------
    length : int
        Pixels along it.
    count : int
        How many places; 1 is the middle.

    Returns
    -------
    list of float
        In pixels.

    Raises
    ------
    refuse.Refusal
        Where the count is below 1.
    """
    if refuse.at_least("nodes", count, 1) == 1:
        return [(length - 1) / 2]
    return [float(at) for at in np.linspace(0, length - 1, count)]


def node_shares(shape: tuple[int, int], nodes: tuple[int, int]) -> list[NDArray[np.float32]]:
    """Return each place's share of each pixel: straight lines to the next places, together 1.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns).
    nodes : tuple of int
        How many places (down, across), as `axis_nodes` lays them.

    Returns
    -------
    list of ndarray of float32, shape (rows, columns)
        Row by row.
    """
    down, across = (_hats_along(n, count) for n, count in zip(shape, nodes, strict=True))
    return [np.outer(y, x).astype(np.float32) for y in down for x in across]


def _hats_along(length: int, count: int) -> NDArray[np.float64]:
    if count == 1 or length == 1:
        return np.eye(count)[:, :1] * np.ones(length)
    places = np.arange(length) * (count - 1) / (length - 1)
    return np.asarray(np.maximum(1 - np.abs(places - np.arange(count)[:, None]), 0))
