"""A table of a diffractive surface to look at: its decades as brightness, h along its sides."""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aureole import light, picture, surface
from aureole.jobs.page import check_page, save
from aureole.surface.resampling import on_even_steps
from aureole.surface.table import areas, axes

SAMPLES = 701
INCHES, LEFT, RIGHT, TOP, BOTTOM = 5.4, 0.85, 0.2, 0.45, 0.62
DECADES = 5.0
# The view reaches as far as all but this share of the light, and is one of these.
LEFT_OUT = 0.02
REACHES = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
BACK, INK = "#0b0d11", "#c9ced8"


def write_table_preview(
    path: Path, table: surface.ScatterTable, title: str, reach: float | None = None
) -> None:
    """Draw a table over even steps of h, and write it, whole or not at all.

    Parameters
    ----------
    path : Path
        File to write; its suffix says the format: PNG, JPEG, PDF or SVG.
    table : ScatterTable
        Any.
    title : str
        Over the picture.
    reach : float, optional
        h at the borders; as far as nearly all of the light reaches where it is left out.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be written.
    """
    from matplotlib.figure import Figure

    check_page(path, "preview")
    half = preview_reach(table) if reach is None else reach
    shown, high = table_brightness(table, half)
    wide, tall = INCHES + LEFT + RIGHT, INCHES + TOP + BOTTOM
    figure = Figure(figsize=(wide, tall), facecolor=BACK)
    panel = figure.add_axes((LEFT / wide, BOTTOM / tall, INCHES / wide, INCHES / tall))
    panel.imshow(shown, interpolation="antialiased", extent=(-half, half, -half, half))
    panel.tick_params(colors=INK, labelsize=8, color=INK)
    for side in panel.spines.values():
        side.set_color(INK)
    panel.set_title(f"{title}, under {table.illuminant}", color=INK, fontsize=9, loc="left")
    panel.set_ylabel("h · b", color=INK, fontsize=8)
    words = f"h · t = sin θ in + sin θ out; logarithmic, {DECADES:g} decades up to {high:.3g} per steradian"
    panel.set_xlabel(words, color=INK, fontsize=8)
    save(path, figure)


def preview_reach(table: surface.ScatterTable) -> float:
    """Return the smallest round h that holds nearly all of a table's light.

    Parameters
    ----------
    table : ScatterTable
        Any.

    Returns
    -------
    float
        At most the table's own range, or the next round number.
    """
    h_b, h_t = axes(table)
    along_b, along_t = areas(table)
    light_of = np.maximum(table.values[..., 1], 0.0) * along_b[:, None] * along_t[None, :]
    farther = np.maximum(np.abs(h_b)[:, None], np.abs(h_t)[None, :])
    total = float(light_of.sum())
    for reach in REACHES:
        if reach >= table.half_range or light_of[farther > reach].sum() <= LEFT_OUT * total:
            return min(reach, table.half_range)
    return table.half_range


def table_brightness(table: surface.ScatterTable, reach: float) -> tuple[NDArray[np.float32], float]:
    """Show a table over even steps of h, its decades as steps of brightness.

    Parameters
    ----------
    table : ScatterTable
        Any.
    reach : float
        h at the borders.

    Returns
    -------
    shown : ndarray of float32, shape (701, 701, 3)
        Ready for a screen; each pixel is the mean of the table over it.
    high : float
        Luminance of S_d that is shown brightest, 1/sr.
    """
    step = 2.0 * reach / (SAMPLES - 1)
    colours = surface.rgb(table)
    even = on_even_steps(colours, table.half_range, table.warp, (SAMPLES, SAMPLES), step, "average")
    shown = picture.log_scale(picture.into_gamut(even), DECADES)
    weights = light.SPACES["rec709"].to_xyz[1]
    high = float((even @ weights).max())
    return np.asarray(shown, dtype=np.float32), high if math.isfinite(high) else 0.0
