"""Laying an eye's glare over a picture.

A picture is flat: the same pixels are a smaller solid angle at its border than at its centre. What a
pixel sends to the eye is its luminance times its solid angle, which falls as cos³θ with the angle θ off
the axis, so a source glares as strongly wherever it stands in the frame:

    out = L − k w L + K ⊗ (w L),   w = cos³θ,   k = what the kernel takes from the pixel.

Pixel sums are kept: where glare would leave the frame, it stays in its own pixel (border "keep") or is
lost (border "lose").

replace   all but the core's own pixel is spread: what the eye does to light that was sharp before.
scatter   the core is kept sharp, and only what is scattered beyond it is spread.
add       an artist's control: light above a soft knee is spread and added, in layers where wanted.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.glare.composite import EYE_MODES
from aureole.glare.eye_spread import RESOLUTIONS, spreader
from aureole.glare.kernel import beyond_core, channel_sums, nonnegative
from aureole.glare.sources import above_knee, checked_matte, refuse_other_space, with_colour
from aureole.records import Picture

BORDERS = ("keep", "lose")
# Angle within which "scatter" and "add" keep the picture sharp, fading over as much again.
CORE_ANGLE = math.radians(0.05)
# A kernel whose pixels differ more than so from the picture's was made for another picture.
SCALE_SLACK = 0.02


@dataclass(frozen=True, eq=False)
class GlarePart:
    """A kernel made ready, and the light that it takes from each pixel.

    Parameters
    ----------
    weights : ndarray of float32, shape (rows, columns)
        Share of each pixel's light that is given to this kernel.
    arriving : ndarray of float32, shape (rows, columns, 3)
        Share of the given light that the kernel spreads over the frame.
    scattered : ndarray of float32, shape (3,)
        Share that it spreads in all, beyond the frame too.
    spread : callable
        Takes light (rows, columns, 3) to the glare of that shape.
    """

    weights: NDArray[np.float32]
    arriving: NDArray[np.float32]
    scattered: NDArray[np.float32]
    spread: Any

    def glare(self, light: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the glare of light, its sum in each channel that of the light that arrives.

        Parameters
        ----------
        light : ndarray of float32, shape (rows, columns, 3)
            Light per pixel, already weighted.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 3)
            Light per pixel.
        """
        return self._spread_to(light, channel_sums(self.arriving * light))

    def move(self, light: NDArray[np.float32], out: NDArray[np.float32], border: str) -> None:
        """Take light from its pixels and add the glare that it makes.

        Parameters
        ----------
        light : ndarray of float32, shape (rows, columns, 3)
            Light per pixel, already weighted.
        out : ndarray of float32, shape (rows, columns, 3)
            The picture, which is changed.
        border : str
            "keep": as much is taken as arrives on the frame; "lose": all that is spread.
        """
        arriving = self.arriving * light
        out -= arriving if border == "keep" else light * self.scattered
        out += self._spread_to(light, channel_sums(arriving))

    def _spread_to(self, light: NDArray[np.float32], sums: NDArray[np.float64]) -> NDArray[np.float32]:
        out = np.asarray(self.spread(light), dtype=np.float32)
        found = channel_sums(out)
        # The transform's rounding, and darkness cut off at zero, are taken back as a whole.
        is_close = (found > 0) & (np.abs(sums - found) < 0.05 * np.abs(found))
        out *= np.where(is_close, sums / np.where(is_close, found, 1), 1).astype(np.float32)
        return out


@dataclass(frozen=True, eq=False)
class EyeComposition:
    """An eye's point spread functions made ready for pictures of one size.

    Parameters
    ----------
    mode : str
        "replace", "scatter" or "add".
    border : str
        "keep" or "lose".
    parts : tuple of GlarePart
        One for the whole frame, or several that share it.
    colour_space : str
        Of the point spread functions.
    field_of_view : float or None
        Radians across the columns.
    core_radius : float
        Pixels within which "scatter" and "add" keep the picture sharp.
    """

    mode: str
    border: str
    parts: tuple[GlarePart, ...]
    colour_space: str
    field_of_view: float | None = None
    core_radius: float = 0.5


def solid_angle_weights(shape: tuple[int, int], field_of_view: float | None) -> NDArray[np.float32]:
    """Return the solid angle of each pixel of a flat picture, that at the centre being 1.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns).
    field_of_view : float or None
        Radians across the columns; None for a picture whose pixels are all alike.

    Returns
    -------
    ndarray of float32, shape (rows, columns)
        cos³θ at the middles of the pixels, θ being the angle off the axis.

    Raises
    ------
    refuse.Refusal
        Where the field is not between 0 and 180 degrees.
    """
    if field_of_view is None:
        return np.ones(shape, dtype=np.float32)
    pitch = tangent_pitch(shape, field_of_view)
    y, x = ((np.arange(n) - (n - 1) / 2) * pitch for n in shape)
    return np.asarray((1 + y[:, None] ** 2 + x**2) ** -1.5, dtype=np.float32)


def tangent_pitch(shape: tuple[int, int], field_of_view: float) -> float:
    """Return the size of a flat picture's pixels as a tangent: that of a pixel's angle at the centre.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns).
    field_of_view : float
        Radians across the columns.

    Returns
    -------
    float
        A pixel n columns off the centre lies at the angle atan(n · pitch).

    Raises
    ------
    refuse.Refusal
        Where the field is not between 0 and 180 degrees.
    """
    if not 0 < refuse.positive("field_of_view", field_of_view) < math.pi:
        raise refuse.Refusal(
            f"'field_of_view' must be below 180 degrees, got {math.degrees(field_of_view):g} degrees."
        )
    return 2 * math.tan(field_of_view / 2) / refuse.at_least("columns", shape[1], 1)


def eye_prepare(
    psf: Picture,
    shape: tuple[int, int],
    field_of_view: float | None = None,
    mode: str = "replace",
    border: str = "keep",
    resolution: str = "full",
    core_angle: float = CORE_ANGLE,
    precision: str = "single",
) -> EyeComposition:
    """Make an eye's point spread function ready for many pictures of one size.

    Parameters
    ----------
    psf : Picture
        Energy per pixel, its core at (rows//2, columns//2), in the picture's pixels.
    shape : tuple of int
        (rows, columns) of the pictures.
    field_of_view : float, optional
        Radians across the pictures' columns. Without it every pixel counts alike.
    mode : str
        "replace", "scatter" or "add".
    border : str
        "keep": what would leave the frame stays in its pixel, so the frame's sum is kept; "lose".
    resolution : str
        "full", or "half": boxes of 2 × 2 pixels, but for small stars' near glare.
    core_angle : float
        Radians within which "scatter" and "add" keep the picture sharp; a pixel at least.
    precision : str
        "single" or "double", as in `aureole.glare.prepare`.

    Returns
    -------
    EyeComposition
        To be given to `eye_composite`.

    Raises
    ------
    refuse.Refusal
        Where a choice is unknown, the kernel holds more than all energy, or its pixels are not the
        picture's.
    """
    weights = solid_angle_weights(shape, field_of_view)
    radius = core_pixels(shape, field_of_view, core_angle)
    part = glare_part(psf, weights, field_of_view, mode, resolution, radius, precision)
    refuse.one_of("border", border, BORDERS)
    return EyeComposition(mode, border, (part,), psf.colour_space, field_of_view, radius)


def core_pixels(shape: tuple[int, int], field_of_view: float | None, core_angle: float) -> float:
    """Return how many pixels an angle about the core is at the picture's centre.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns).
    field_of_view : float or None
        Radians across the columns; None where that is not known.
    core_angle : float
        Radians.

    Returns
    -------
    float
        At least half a pixel, which is the core's own.

    Raises
    ------
    refuse.Refusal
        Where the angle is negative or above 45 degrees.
    """
    refuse.between("core_angle", core_angle, 0, math.pi / 4)
    if field_of_view is None:
        return 0.5
    return max(0.5, math.tan(core_angle) / tangent_pitch(shape, field_of_view))


def glare_part(
    psf: Picture,
    weights: NDArray[np.float32],
    field_of_view: float | None = None,
    mode: str = "replace",
    resolution: str = "full",
    core_radius: float = 0.5,
    precision: str = "single",
) -> GlarePart:
    """Make one kernel ready for its share of the frame.

    Parameters
    ----------
    psf : Picture
        As in `eye_prepare`.
    weights : ndarray of float32, shape (rows, columns)
        Share of each pixel's light that the kernel gets.
    field_of_view : float, optional
        As in `eye_prepare`.
    mode, resolution : str
        As in `eye_prepare`.
    core_radius : float
        Pixels within which "scatter" and "add" keep the picture sharp.
    precision : str
        As in `eye_prepare`.

    Returns
    -------
    GlarePart
        Ready.

    Raises
    ------
    refuse.Refusal
        As in `eye_prepare`.
    """
    refuse.one_of("resolution", resolution, RESOLUTIONS)
    shape = (weights.shape[0], weights.shape[1])
    kernel = glare_kernel(psf, shape, field_of_view, mode, core_radius)
    return part_of(kernel, weights, spreader(kernel, shape, resolution, precision))


def glare_kernel(
    psf: Picture,
    shape: tuple[int, int],
    field_of_view: float | None = None,
    mode: str = "replace",
    core_radius: float = 0.5,
) -> NDArray[np.float32]:
    """Return what a point spread function takes from a pixel and lays beyond its core.

    Parameters
    ----------
    psf : Picture
        As in `eye_prepare`.
    shape : tuple of int
        (rows, columns) of the pictures.
    field_of_view : float, optional
        As in `eye_prepare`.
    mode : str
        As in `eye_prepare`.
    core_radius : float
        Pixels within which "scatter" and "add" keep the picture sharp.

    Returns
    -------
    ndarray of float32, shape (K, L, 3)
        Not negative, its core dark.

    Raises
    ------
    refuse.Refusal
        As in `eye_prepare`.
    """
    refuse.one_of("mode", mode, EYE_MODES)
    _refuse_other_scale(psf, shape, field_of_view)
    kernel = nonnegative(psf).pixels[..., :3].copy()
    total = float(channel_sums(kernel).max())
    if total > 1.01:
        raise refuse.Refusal(f"'psf' must hold at most all energy (sum <= 1), got a sum of {total:.3g}.")
    kernel[kernel.shape[0] // 2, kernel.shape[1] // 2] = 0
    if mode != "replace":
        kernel *= beyond_core((kernel.shape[0], kernel.shape[1]), core_radius)[..., None]
    return kernel


def part_of(kernel: NDArray[np.float32], weights: NDArray[np.float32], spread: Any) -> GlarePart:
    """Return a part from a kernel and what convolves with it.

    Parameters
    ----------
    kernel : ndarray of float32, shape (K, L, 3)
        From `glare_kernel`.
    weights : ndarray of float32, shape (rows, columns)
        Share of each pixel's light that the kernel gets.
    spread : callable
        Takes light (rows, columns, 3) to its convolution with the kernel.

    Returns
    -------
    GlarePart
        Ready.
    """
    shape = (weights.shape[0], weights.shape[1])
    return GlarePart(weights, arriving_share(kernel, shape), channel_sums(kernel).astype(np.float32), spread)


def arriving_share(kernel: NDArray[np.floating], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return how much of each pixel's spread light falls on the frame.

    Parameters
    ----------
    kernel : ndarray, shape (K, L, 3)
        Energy per pixel, its centre at (K // 2, L // 2).
    shape : tuple of int
        (rows, columns) of the frame.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Sum of the kernel over the part of it that lies on the frame, from sums over its corners.
    """
    (top, bottom), (left, right) = (
        (np.clip(length // 2 - np.arange(n), 0, length), np.clip(length // 2 - np.arange(n) + n, 0, length))
        for length, n in zip(kernel.shape[:2], shape, strict=True)
    )
    out = np.empty((*shape, kernel.shape[2]), dtype=np.float32)
    corners = np.zeros((kernel.shape[0] + 1, kernel.shape[1] + 1))
    for channel in range(kernel.shape[2]):
        np.cumsum(kernel[..., channel], axis=0, out=corners[1:, 1:])
        np.cumsum(corners, axis=1, out=corners)
        tall = corners[bottom] - corners[top]
        out[..., channel] = tall[:, right] - tall[:, left]
    return out


def eye_composite(
    source: Picture,
    psf: Picture | EyeComposition,
    field_of_view: float | None = None,
    mode: str = "replace",
    border: str = "keep",
    resolution: str = "full",
    matte: NDArray[np.floating] | None = None,
    threshold: float = 1.0,
    knee: float = 0.5,
    knee_of: str = "luminance",
    star_size: int = 1,
    gain: float = 1.0,
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0),
    layers: Iterable[tuple[Picture | EyeComposition, float, float]] = (),
    open_share: float = 1.0,
    core_angle: float = CORE_ANGLE,
    precision: str = "single",
) -> Picture:
    """Return a picture as an eye with glare sees it.

    Parameters
    ----------
    source : Picture
        Linear RGB, with or without alpha, which stays as it is.
    psf : Picture or EyeComposition
        A point spread function, or one made ready with `eye_prepare` or `aureole.glare.eye_field` (whose
        field, mode, border, resolution, core and precision then count).
    field_of_view : float, optional
        Radians across the picture's columns. Without it every pixel counts alike.
    mode, border, resolution : str
        As in `eye_prepare`.
    matte : ndarray, shape (rows, columns), optional
        0..1, how much of each pixel is a source of glare.
    threshold, knee, knee_of, star_size : float, float, str, int
        For "add": as in `aureole.glare.above_knee`.
    gain : float
        For "add": multiplies what is added.
    tint : tuple of float
        For "add": multiplies each channel of what is added.
    layers : iterable of (psf, threshold, gain)
        For "add": further point spread functions with a threshold and a gain each, so that only strong
        lights get long needles (`aureole.glare.radial_layers`).
    open_share : float
        0..1, how much of the light the lids let through; all of the result is dimmed by it.
    core_angle : float
        As in `eye_prepare`.
    precision : str
        As in `eye_prepare`.

    Returns
    -------
    Picture
        Same size, colour space and metadata as the source. Where nothing is lost and nothing is added,
        each channel's sum is the source's to 1e-6.

    Raises
    ------
    refuse.Refusal
        Where the colour spaces, the shapes, a choice or a number do not fit.
    """
    share = refuse.between("open_share", open_share, 0, 1)
    shape = (source.pixels.shape[0], source.pixels.shape[1])
    limit = None if matte is None else checked_matte(matte, shape)

    def ready(kernel: Picture | EyeComposition) -> EyeComposition:
        if isinstance(kernel, Picture):
            kernel = eye_prepare(
                kernel, shape, field_of_view, mode, border, resolution, core_angle, precision
            )
        _refuse_misfit(source, kernel)
        return kernel

    first, others = ready(psf), [(ready(kernel), low, high) for kernel, low, high in layers]
    if first.mode != "add":
        if others:
            raise refuse.Refusal(f"'layers' belong to mode 'add', got mode '{first.mode}'.")
        return with_colour(source, _moved(source.pixels[..., :3], first, limit) * np.float32(share))
    added = np.zeros((*shape, 3), dtype=np.float32)
    for layer, low, high in [(first, threshold, gain), *others]:
        bright = above_knee(source, low, knee, knee_of, star_size)
        glare = _spread(bright if limit is None else bright * limit, layer)
        added += glare * np.float32(refuse.finite("gain", high))
    added *= np.asarray(tint, dtype=np.float32)
    return with_colour(source, (source.pixels[..., :3] + added) * np.float32(share))


def _moved(
    colour: NDArray[np.float32], ready: EyeComposition, limit: NDArray[np.float32] | None
) -> NDArray[np.float32]:
    """Take light from its pixels and lay it where the kernels spread it."""
    lit = colour if limit is None else colour * limit
    out = colour.copy()
    for part in ready.parts:
        part.move(lit * part.weights[..., None], out, ready.border)
    return out


def _spread(bright: NDArray[np.float32], ready: EyeComposition) -> NDArray[np.float32]:
    total = np.zeros_like(bright)
    for part in ready.parts:
        total += part.glare(bright * part.weights[..., None])
    return total


def _refuse_other_scale(psf: Picture, shape: tuple[int, int], field_of_view: float | None) -> None:
    """Refuse a kernel whose degrees per pixel are neither those at the centre nor the frame's mean."""
    said = psf.metadata.get("degrees_per_pixel")
    if field_of_view is None or not isinstance(said, int | float):
        return
    mean, central = math.degrees(field_of_view) / shape[1], math.degrees(tangent_pitch(shape, field_of_view))
    if not mean * (1 - SCALE_SLACK) <= said <= central * (1 + SCALE_SLACK):
        raise refuse.Refusal(
            f"'psf' must have the picture's {mean:.4g} to {central:.4g} degrees per pixel, got {said:.4g}."
        )


def _refuse_misfit(source: Picture, ready: EyeComposition) -> None:
    refuse_other_space(source, Picture(source.pixels, ready.colour_space))
    for part in ready.parts:
        refuse.shape_of("picture", source.pixels, (*part.weights.shape, source.pixels.shape[2]))
