"""Which light of a picture makes glare: above a knee, within a matte; and colour back into a picture."""

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse
from aureole.glare.eye_stars import lumps
from aureole.records import Picture

KNEES = ("luminance", "thesis")


def above_knee(
    source: Picture,
    threshold: float = 1.0,
    knee: float = 0.5,
    knee_of: str = "luminance",
    star_size: int = 0,
) -> NDArray[np.float32]:
    """Return the part of each pixel's light that lies above a soft knee.

    Parameters
    ----------
    source : Picture
        Linear RGB.
    threshold : float
        Where the straight part of the knee would start, in the picture's own unit.
    knee : float
        0..1, how softly it sets in: 0 is sharp, 1 starts at zero. A parabola joins zero to the straight
        line between (1 − knee) and (1 + knee) times the threshold.
    knee_of : str
        "luminance": a pixel's channels are scaled together by the part of its luminance that lies above,
        so its hue stays. "thesis": each channel has the threshold to itself (Eq. 3.2), which turns an
        orange light red where only its red is above; for comparison.
    star_size : int
        Width in pixels of small sources that are measured whole (`aureole.glare.lumps`), so that they
        do not flicker as they move by fractions of a pixel; 0 measures single pixels.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Light that makes glare.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range or the knee is unknown.
    """
    refuse.one_of("knee_of", knee_of, KNEES)
    refuse.between("knee", knee, 0, 1)
    if not refuse.finite("threshold", threshold) >= 0:
        raise refuse.Refusal(f"'threshold' must be a number >= 0, got {threshold:g}.")
    colour = source.pixels[..., :3]
    if knee_of == "thesis":
        return _over(colour, threshold, knee)
    strength = colour @ light.SPACES[source.colour_space].to_xyz[1].astype(np.float32)
    above = _over(strength, threshold, knee)
    if refuse.at_least("star_size", star_size, 0):
        whole, ring = lumps(strength, star_size)
        # As bright as the whole lump is where it covers its own width, so is each of its pixels taken.
        level = whole / np.float32(star_size**2)
        ground = _over(np.minimum(ring, strength), threshold, knee)
        gained = _over(ring + level, threshold, knee) - _over(ring, threshold, knee)
        slope = np.divide(gained, level, out=np.zeros_like(level), where=level > 0)
        above = np.maximum(above, ground + slope * np.maximum(strength - ring, 0))
    share = np.divide(above, strength, out=np.zeros_like(above), where=strength > 0)
    return np.asarray(colour * share[..., None], dtype=np.float32)


def _over(strength: NDArray[np.floating], threshold: float, knee: float) -> NDArray[np.float32]:
    low = np.float32(threshold * (1 - knee))
    width = np.float32(2 * (threshold - low))
    over = np.maximum(strength - low, 0)
    # A parabola joins zero to the straight line strength − threshold.
    soft = over**2 / (2 * width) if width > 0 else over
    above = np.where(over < width, soft, np.maximum(strength - np.float32(threshold), 0))
    return np.asarray(above, dtype=np.float32)


def checked_matte(matte: NDArray[np.floating], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return a matte as weights of the channels together.

    Parameters
    ----------
    matte : ndarray, shape (rows, columns)
        How much of each pixel is a source of glare; cut to 0..1.
    shape : tuple of int
        (rows, columns) of the picture.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 1)
        The weights.

    Raises
    ------
    refuse.Refusal
        Where its shape differs or a value is not a number.
    """
    values = refuse.all_finite("matte", refuse.shape_of("matte", matte, shape))
    return np.asarray(np.clip(values, 0, 1), dtype=np.float32)[..., None]


def refuse_other_space(source: Picture, psf: Picture) -> None:
    """Refuse a point spread function in other primaries than the picture's.

    Parameters
    ----------
    source, psf : Picture
        The picture and the point spread function.

    Raises
    ------
    refuse.Refusal
        Where they differ.
    """
    if source.colour_space != psf.colour_space:
        raise refuse.Refusal(
            f"'psf' must be in the picture's colour space '{source.colour_space}', got '{psf.colour_space}'."
        )


def with_colour(source: Picture, colour: NDArray[np.floating]) -> Picture:
    """Return a picture with other colour and the same alpha, colour space and metadata.

    Parameters
    ----------
    source : Picture
        Any.
    colour : ndarray, shape (rows, columns, 3)
        The colour.

    Returns
    -------
    Picture
        The picture.
    """
    pixels = colour.astype(np.float32, copy=False)
    if source.pixels.shape[2] > 3:
        pixels = np.concatenate([pixels, source.pixels[..., 3:]], axis=2)
    return Picture(pixels, source.colour_space, source.metadata)
