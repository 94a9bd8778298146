"""A point spread function of an eye to look at: its decades as brightness, degrees along its sides."""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aureole import light, picture
from aureole.jobs.page import check_page, save
from aureole.records import Picture

DOTS_PER_INCH = 150
# Sides of the shown picture in inches, the room for numbers beside it, and what numbers there may be.
LEAST_INCHES, MOST_INCHES = 4.0, 8.0
LEFT, RIGHT, TOP, BOTTOM = 0.62, 0.15, 0.15, 0.55
STEPS = (1, 2, 5)
TICKS = 9
# Percentiles of the pixels' energies that are shown black and white, and the least decades between them.
DARK, BRIGHT, LEAST_DECADES = 1.0, 99.95, 3.0
# Even steps of the logarithm are shown darker than they are, so that what is fine stands out.
CONTRAST = 1.6
BACK, INK = "#0b0d11", "#c9ced8"


def write_eye_preview(path: Path, psf: Picture, field_of_view: float, projection: str = "angle") -> None:
    """Draw a point spread function with degrees, and write it, whole or not at all.

    Parameters
    ----------
    path : Path
        File to write; its suffix says the format: PNG, JPEG, PDF or SVG.
    psf : Picture
        Energy per pixel.
    field_of_view : float
        Radians across its columns.
    projection : str
        "angle" or "perspective".

    Raises
    ------
    refuse.Refusal
        Where the file cannot be written.
    """
    from matplotlib.figure import Figure

    check_page(path, "preview")
    rows, columns = psf.pixels.shape[:2]
    inches = min(max(max(rows, columns) / DOTS_PER_INCH, LEAST_INCHES), MOST_INCHES)
    wide, high = inches * columns / max(rows, columns), inches * rows / max(rows, columns)
    whole_wide, whole_high = wide + LEFT + RIGHT, high + TOP + BOTTOM
    figure = Figure(figsize=(whole_wide, whole_high), facecolor=BACK)
    place = (LEFT / whole_wide, BOTTOM / whole_high, wide / whole_wide, high / whole_high)
    axes = figure.add_axes(place)
    shown, low, high = eye_brightness(psf)
    axes.imshow(shown, interpolation="antialiased", aspect="auto")
    for axis, count in ((axes.xaxis, columns), (axes.yaxis, rows)):
        degrees, at = degree_ticks(count, columns, field_of_view, projection)
        axis.set_ticks(at, [f"{value:g}°" for value in degrees])
    axes.tick_params(colors=INK, labelsize=8, color=INK)
    for side in axes.spines.values():
        side.set_color(INK)
    words = f"energy of a pixel, logarithmic: black {low:.0e}, white {high:.0e} of all light"
    axes.set_xlabel(words, color=INK, fontsize=8)
    save(path, figure)


def eye_brightness(psf: Picture) -> tuple[NDArray[np.float32], float, float]:
    """Show decades of energy as steps of brightness, each pixel in its own colour.

    Parameters
    ----------
    psf : Picture
        Energy per pixel.

    Returns
    -------
    shown : ndarray of float32, shape (rows, columns, 3)
        Ready for a screen.
    low, high : float
        What is black and what is white; all but few pixels lie between.
    """
    colour = picture.into_gamut(light.convert(psf, "rec709").pixels[..., :3])
    level = colour.max(axis=2)
    lit = level[level > 0]
    if lit.size == 0:
        return np.zeros_like(colour), 0.0, 0.0
    low, high = (float(value) for value in np.percentile(lit, (DARK, BRIGHT)))
    decades = max(math.log10(high / low), LEAST_DECADES)
    # What is brighter than white keeps its hue.
    colour = colour * np.minimum(1, high / np.maximum(level, high))[..., None]
    shown = picture.log_scale(colour, decades)
    brightest = shown.max(axis=2, keepdims=True)
    shown = shown * np.maximum(brightest, 1e-6) ** np.float32(CONTRAST - 1)
    return np.asarray(shown, dtype=np.float32), high * 10**-decades, high


def degree_ticks(
    count: int, columns: int, field_of_view: float, projection: str
) -> tuple[list[float], list[float]]:
    """Choose round angles for a side of a picture, and say where they lie.

    Parameters
    ----------
    count : int
        Pixels along the side.
    columns : int
        Columns of the picture.
    field_of_view : float
        Radians across its columns.
    projection : str
        "angle" or "perspective".

    Returns
    -------
    degrees : list of float
        Rising, 0 in the middle.
    at : list of float
        Places in pixels; 0 is the first pixel's centre, and the core lies at count // 2.
    """
    half = field_of_view / 2
    flat = projection == "perspective"
    # Half the side as an angle.
    extent = math.tan(half) * count / columns if flat else half * count / columns
    most = math.degrees(math.atan(extent) if flat else extent)
    step = _step(2 * most / TICKS)
    steps = math.floor(most / step * (1 + 1e-9))
    degrees = [step * k for k in range(-steps, steps + 1)]
    scale = columns / (2 * (math.tan(half) if flat else half))
    angles = np.radians(degrees)
    at = count // 2 + scale * (np.tan(angles) if flat else angles)
    return degrees, [float(value) for value in at]


def _step(least: float) -> float:
    """Return the smallest round number that is no less."""
    power = 10.0 ** math.floor(math.log10(least))
    return next((step * power for step in STEPS if step * power >= least * (1 - 1e-9)), 10 * power)
