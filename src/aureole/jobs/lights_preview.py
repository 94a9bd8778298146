"""A picture with its lights marked: a circle about each, its number, and the way that it came."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture
from aureole.glare import Sighting
from aureole.records import Picture

# Circles stand off the light by so many pixels and are no smaller than that, of a picture 1080 rows high.
STAND_OFF, LEAST_RADIUS, TEXT = 4.0, 8.0, 16.0
ROWS = 1080.0
# One after the other by the light's number, so that neighbours differ.
COLOURS = ("#ffd54a", "#4ac6ff", "#ff6f91", "#7dff8a", "#c9a0ff", "#ff9d4a", "#5fffe1", "#ffffff")
DPI = 100


def lights_drawing(
    source: Picture,
    sightings: Sequence[Sighting],
    trails: Mapping[int, Sequence[tuple[float, float]]] | None = None,
    corner: tuple[int, int] = (0, 0),
) -> NDArray[np.float32]:
    """Draw circles and numbers over a picture.

    Parameters
    ----------
    source : Picture
        Linear; shown at the exposure that suits it.
    sightings : sequence of Sighting
        Its lights.
    trails : mapping of int to sequence of (x, y), optional
        Where lights stood in the frames before, by their number.
    corner : tuple of int
        Column and row, in what the lights' places count from, of the picture's first pixel.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Ready for a screen, as large as the picture.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    shown = picture.to_display(source)
    rows, columns = shown.shape[:2]
    scale = max(rows / ROWS, 0.5)
    figure = Figure(figsize=(columns / DPI, rows / DPI), dpi=DPI, frameon=False)
    canvas: Any = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(corner[0], corner[0] + columns)
    axes.set_ylim(corner[1] + rows, corner[1])
    for sighting in sightings:
        _mark(axes, sighting, (trails or {}).get(sighting.id, ()), scale)
    figure.patch.set_alpha(0.0)
    canvas.draw()
    marks = np.asarray(canvas.buffer_rgba(), np.float32)[:rows, :columns] / np.float32(255)
    share = marks[..., 3:]
    return np.asarray(shown * (1 - share) + marks[..., :3] * share, dtype=np.float32)


def _mark(axes: Any, sighting: Sighting, trail: Sequence[tuple[float, float]], scale: float) -> None:
    from matplotlib.patches import Circle

    colour = COLOURS[(sighting.id - 1) % len(COLOURS)]
    x, y = sighting.lamp.place
    radius = max(sighting.lamp.size / 2 + STAND_OFF * scale, LEAST_RADIUS * scale)
    points = 72.0 / DPI * scale
    axes.add_patch(Circle((x, y), radius, fill=False, edgecolor=colour, linewidth=1.5 * points))
    if trail:
        places = np.array([*trail, (x, y)])
        axes.plot(places[:, 0], places[:, 1], color=colour, linewidth=1.0 * points, alpha=0.7)
    name = "+".join(str(number) for number in (sighting.id, *sighting.merged))
    axes.text(x + 0.75 * radius, y - 0.75 * radius, name, color=colour, fontsize=TEXT * points, clip_on=True)
