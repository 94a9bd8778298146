"""How far the glare of flipbooks is from that of one wave through all parts of the eye.

Flipbooks add intensities and blend frames; a wave adds amplitudes, and its parts interfere.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.glare.eye import EyeState
from aureole.glare.flipbook import SIZE, Flipbooks
from aureole.glare.fresh_glare import FreshGlare
from aureole.glare.real_time import GlareSource, RealTimeGlare
from aureole.picture import MixedConvolver
from aureole.records import Picture

RINGS = 8


@dataclass(frozen=True)
class FlipbookError:
    """How far flipbooks are from the wave through all parts of the eye.

    Parameters
    ----------
    edges : tuple of float
        Radians: bounds of the rings about a point source, one more than rings.
    ratios : tuple of float
        Mean of each ring over the wave's.
    deviations : tuple of float
        Root mean square of the difference between the two in each ring, pixel by pixel and channel by
        channel, over the wave's mean.
    spread : float
        Light that the flipbooks spread on the frame over what the wave does.
    psnr : float or None
        Peak signal-to-noise ratio on the scene, decibels.
    log_psnr : float or None
        The same of the logarithms, which counts dark pixels, too.
    """

    edges: tuple[float, ...]
    ratios: tuple[float, ...]
    deviations: tuple[float, ...]
    spread: float
    psnr: float | None = None
    log_psnr: float | None = None


def flipbook_error(
    flipbooks: Flipbooks, state: EyeState, size: int = SIZE, scene: Picture | None = None
) -> FlipbookError:
    """Compare the glare of flipbooks, which add intensities, with the coherent wave's.

    Parameters
    ----------
    flipbooks : Flipbooks
        Of an eye.
    state : EyeState
        Of the same eye.
    size : int
        Of the wave's grid.
    scene : Picture, optional
        Of the flipbooks' size, to see the difference on.

    Returns
    -------
    FlipbookError
        Differences in rings about a point source in the middle, and on the scene.

    Raises
    ------
    refuse.Refusal
        Where no light comes through, or there are too few pixels to compare.
    """
    own = flipbooks.frames
    fresh = FreshGlare.of(
        state.eye, own.shape, own.field_of_view, own.resolution, flipbooks.colour_space, size
    )
    ours, wave = _of_point(flipbooks, state), _of_point(fresh, state)
    if min(own.kernels.shape) < 3 or not wave.any():
        raise refuse.Refusal(
            "'flipbooks' must have 3 x 3 pixels, and 'state' must let light through the lids."
        )
    middle = [n // 2 for n in ours.shape[:2]]
    y, x = (np.arange(n) - m for n, m in zip(ours.shape[:2], middle, strict=True))
    step = 2 if own.resolution == "half" else 1
    pitch = 2 * math.tan(own.field_of_view / 2) / own.shape[1] * step
    angles = np.arctan(np.hypot(y[:, None], x) * pitch)
    wanted = np.geomspace(0.5 * pitch, math.atan((min(middle) + 0.5) * pitch), RINGS + 1)
    edges, ratios, deviations = [float(wanted[0])], [], []
    for high in wanted[1:].tolist():
        ring = (angles >= edges[-1]) & (angles < high)
        # Near the middle, rings are wider: each has a pixel.
        if ring.any():
            mean = float(wave[ring].mean())
            ratios.append(float(ours[ring].mean()) / mean)
            deviations.append(float(np.sqrt(np.mean((ours[ring] - wave[ring]) ** 2))) / mean)
            edges.append(high)
    spread = float(ours.sum() / wave.sum())
    judged = (None, None) if scene is None else _on_scene(flipbooks, fresh, state, scene)
    return FlipbookError(tuple(edges), tuple(ratios), tuple(deviations), spread, *judged)


def _of_point(source: GlareSource, state: EyeState) -> NDArray[np.float64]:
    """Return the glare about one bright pixel in the frame's middle."""
    kernels, mix = source.frames.kernels, source.mix(state)
    point = np.zeros((*kernels.shape, 3), dtype=np.float32)
    point[kernels.shape[0] // 2, kernels.shape[1] // 2] = 1
    return MixedConvolver(kernels)(point, mix).astype(np.float64)


def _on_scene(one: GlareSource, two: GlareSource, state: EyeState, scene: Picture) -> tuple[float, float]:
    """Return plain and logarithmic signal-to-noise ratios of one's picture against the other's."""
    pixels = np.ascontiguousarray(scene.pixels[..., :3], dtype=np.float32)
    found, wanted = (RealTimeGlare(source)(pixels, state) for source in (one, two))
    return float(picture.psnr(found, wanted).min()), float(picture.log_psnr(found, wanted).min())
