"""What people look at: previews of pictures and kernels."""

import math

import numpy as np
from numpy.typing import NDArray

from aureole import light, picture
from aureole.records import Picture

# No picture is made brighter by more: what is left is rounding.
MOST_STOPS = 100.0
# A flare on black: so many per cent of its lit pixels are no brighter than that; the most stops for it.
FLARE_EXPOSURE = (98.0, 0.5, 60.0)


def exposed(after: Picture, before: Picture) -> NDArray[np.float32]:
    """Show a picture at the exposure that suits another.

    Parameters
    ----------
    after : Picture
        Linear; what is shown.
    before : Picture
        Linear; what the exposure is chosen from.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Ready for a screen.
    """
    return picture.to_display(after, exposure=picture.auto_exposure(before))


def before_and_after(before: Picture, after: Picture) -> NDArray[np.float32]:
    """Show a picture without and with glare side by side, at one exposure.

    Parameters
    ----------
    before, after : Picture
        Linear.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Ready for a screen.
    """
    return picture.side_by_side([exposed(before, before), exposed(after, before)])


def kernel(psf: Picture) -> NDArray[np.float32]:
    """Show a kernel over ten decades, in its own colours.

    Parameters
    ----------
    psf : Picture
        Energy per pixel.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Ready for a screen.
    """
    return picture.to_display(psf, exposure=0.0, tone="log")


def irradiance(source: Picture, exposure: float | str) -> tuple[NDArray[np.float32], float, float]:
    """Show irradiance as it is, nothing bent: twice the light is twice the light.

    Parameters
    ----------
    source : Picture
        Linear.
    exposure : float or str
        Stops; 0 shows 1 as white. "auto" shows the brightest pixel as white.

    Returns
    -------
    shown : ndarray of float32, shape (rows, columns, 3)
        Ready for a screen.
    stops : float
        The exposure.
    over : float
        Part of the pixels that are brighter than white.
    """
    largest = picture.into_gamut(light.convert(source, "rec709").pixels[..., :3]).max(axis=2)
    peak = float(largest.max())
    # A ten-thousandth of room keeps rounding from calling the brightest too bright.
    stops = min(-math.log2(peak * 1.0001), MOST_STOPS) if exposure == "auto" and peak > 0 else 0.0
    if exposure != "auto":
        stops = float(exposure)
    over = float(np.mean(largest * 2.0**stops > 1))
    return picture.to_display(source, exposure=stops, tone="clip"), stops, over


def flare(after: Picture, before: Picture | None) -> NDArray[np.float32]:
    """Show a flare: over a picture at the exposure that suits the picture, on black as its ghosts need it.

    Parameters
    ----------
    after : Picture
        Linear; what is shown.
    before : Picture, optional
        Linear; the picture over which the flare lies.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Ready for a screen.
    """
    if before is not None:
        return exposed(after, before)
    return picture.to_display(after, exposure=picture.auto_exposure(after, *FLARE_EXPOSURE))
