"""Laying glare over a picture.

replace   picture ⊗ psf: what the camera does to light that was sharp before. Energy is kept; what a
          cropped kernel lost goes back to its core.
scatter   the core is kept sharp and only what is scattered beyond it is spread. Energy is kept too.
bloom     nearly the same, many times faster: from box to box of a few pixels, and near lights as above.
add       an artist's control: bright parts above a soft knee are spread and added.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.glare.bloom import BloomSpread
from aureole.glare.kernel import beyond_core, channel_sums, nonnegative
from aureole.glare.sources import above_knee, checked_matte, refuse_other_space, with_colour
from aureole.records import Picture

MODES = ("replace", "scatter", "add", "bloom")
# Those of eyes, whose glare has a resolution of its own to choose.
EYE_MODES = MODES[:3]
# Radius in pixels within which all modes but "replace" keep the picture sharp, fading over as much again.
CORE_RADIUS = 2.0


@dataclass(frozen=True, eq=False)
class Composition:
    """A point spread function made ready for pictures of one size.

    Parameters
    ----------
    mode : str
        One of `MODES`.
    core : ndarray of float32, shape (3,) or (rows, columns, 3)
        What each channel keeps in its own pixel.
    returned : float
        Energy that the kernel had lost at its border and that went back to the core, mean over
        channels.
    spread : callable
        Takes (rows, columns, 3) to its convolution with all of the kernel but the core; that of "bloom"
        has the core in it.
    """

    mode: str
    core: NDArray[np.float32]
    returned: float
    spread: Any


def prepare(
    psf: Picture,
    shape: tuple[int, int],
    mode: str = "replace",
    core_radius: float = CORE_RADIUS,
    precision: str = "single",
) -> Composition:
    """Make a point spread function ready for many pictures of one size.

    Parameters
    ----------
    psf : Picture
        Energy per pixel, its core at (rows//2, columns//2).
    shape : tuple of int
        (rows, columns) of the pictures.
    mode : str
        One of `MODES`.
    core_radius : float
        Pixels within which all modes but "replace" keep the picture sharp.
    precision : str
        "single" is wrong by about 2e-7 of the picture's root mean square, which can be per cents of
        the darkest pixels beside very bright lamps; "double" is exact there and takes twice the time.
        "bloom" is single in either case.

    Returns
    -------
    Composition
        To be given to `composite`.

    Raises
    ------
    refuse.Refusal
        Where the mode is unknown, or the kernel holds more than all energy.
    """
    kernel, core, returned = kernel_parts(psf, mode, core_radius)
    if mode == "bloom":
        return Composition(mode, core, returned, BloomSpread(kernel, core, shape))
    spread = picture.Convolver(kernel, shape, precision)
    return Composition(mode, core, returned, spread)


def kernel_parts(
    psf: Picture, mode: str, core_radius: float = CORE_RADIUS
) -> tuple[NDArray[np.float32], NDArray[np.float32], float]:
    """Take a point spread function apart into what it spreads and what stays.

    Parameters
    ----------
    psf : Picture
        As in `prepare`.
    mode : str
        One of `MODES`.
    core_radius : float
        As in `prepare`.

    Returns
    -------
    kernel : ndarray of float32, shape (rows, columns, 3)
        What is spread.
    core : ndarray of float32, shape (3,)
        What each channel keeps in its own pixel.
    returned : float
        Energy that the border had lost and that went back to the core, mean over channels.

    Raises
    ------
    refuse.Refusal
        Where the mode is unknown, or the kernel holds more than all energy.
    """
    refuse.one_of("mode", mode, MODES)
    kernel = nonnegative(psf).pixels[..., :3].copy()
    total = channel_sums(kernel)
    if float(total.max()) > 1.01:
        raise refuse.Refusal(
            f"'psf' must hold at most all energy (sum <= 1), got a sum of {total.max():.3g}."
        )
    if mode == "replace":
        kernel[kernel.shape[0] // 2, kernel.shape[1] // 2] = 0
    else:
        kernel *= beyond_core(kernel.shape[:2], core_radius)[..., None]
    # Whatever is not spread stays: the core's own share and what the border lost.
    core = (1 - channel_sums(kernel)).astype(np.float32)
    return kernel, core, float(np.mean(1 - total))


def composite(
    source: Picture,
    psf: Picture | Composition,
    mode: str = "replace",
    matte: NDArray[np.floating] | None = None,
    threshold: float = 1.0,
    knee: float = 0.5,
    gain: float = 1.0,
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0),
    core_radius: float = CORE_RADIUS,
    precision: str = "single",
) -> Picture:
    """Return a picture with glare.

    Parameters
    ----------
    source : Picture
        Linear RGB, with or without alpha, which stays as it is.
    psf : Picture or Composition
        A point spread function, or one made ready with `prepare` (whose mode then counts).
    mode : str
        One of `MODES`.
    matte : ndarray, shape (rows, columns), optional
        0..1, how much of each pixel is a source of glare.
    threshold, knee : float
        For "add": luminance above which light is spread, and how softly that sets in (0 is sharp, 1
        starts at zero). All channels are scaled together, so hue stays.
    gain : float
        For "add": multiplies what is added.
    tint : tuple of float
        For "add": multiplies each channel of what is added.
    core_radius : float
        For all modes but "replace": pixels within which the picture stays sharp.
    precision : str
        "single" or "double", as in `prepare`.

    Returns
    -------
    Picture
        Same size, colour space and metadata as the source.

    Raises
    ------
    refuse.Refusal
        Where the colour spaces, the matte or a number do not fit.
    """
    colour = source.pixels[..., :3]
    shape = colour.shape[:2]
    if isinstance(psf, Picture):
        refuse_other_space(source, psf)
        psf = prepare(psf, (shape[0], shape[1]), mode, core_radius, precision)
    limit = None if matte is None else checked_matte(matte, (shape[0], shape[1]))
    if psf.mode == "add":
        bright = above_knee(source, threshold, knee)
        bright = bright if limit is None else bright * limit
        factor = np.asarray(tint, dtype=np.float32) * np.float32(refuse.finite("gain", gain))
        out = psf.spread(bright)
        for channel in range(3):
            out[..., channel] *= factor[channel]
        out += colour
    else:
        lit = colour if limit is None else colour * limit
        out = _kept_and_spread(lit, psf)
        if limit is not None:
            out += colour - lit
    return with_colour(source, out)


def _kept_and_spread(lit: NDArray[np.floating], psf: Composition) -> NDArray[np.float32]:
    """Return what light stays and what is spread of it."""
    out: NDArray[np.float32] = psf.spread(lit)
    if psf.mode == "bloom":
        return out
    for channel in range(3):
        out[..., channel] += lit[..., channel] * psf.core[..., channel]
    return out
