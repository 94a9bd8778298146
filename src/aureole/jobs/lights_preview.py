"""A picture with its lights marked: a circle about each, its number, and the way that it came."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture
from aureole.glare import Sighting
from aureole.records import Picture

# Of a picture 1080 rows high, in pixels: circles are as large as their light, but no smaller than that; how
# far a number is from its circle, and how high it is; how wide lines are, and the dark about them.
LEAST_RADIUS, APART, TEXT, LINE, DARK = 7.0, 3.0, 15.0, 1.6, 1.6
ROWS = 1080.0
# Marks on small pictures grow no smaller than that of these.
LEAST_SCALE = 0.7
# A digit's width in heights, and the directions in which a number may stand, the best first.
DIGIT = 0.64
SIDES = ((1, -1), (1, 0), (1, 1), (-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1))
# One after the other by the light's number, so that neighbours differ.
COLOURS = ("#ffd54a", "#4ac6ff", "#ff6f91", "#7dff8a", "#c9a0ff", "#ff9d4a", "#5fffe1", "#ffffff")
DPI = 100
# Points of print that a pixel is.
POINT = 72.0 / DPI


def lights_drawing(
    source: Picture,
    sightings: Sequence[Sighting],
    trails: Mapping[int, Sequence[tuple[float, float]]] | None = None,
    corner: tuple[int, int] = (0, 0),
) -> NDArray[np.float32]:
    """Draw circles and numbers over a picture; where lights are dense, the weaker ones have no number.

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
    scale = max(rows / ROWS, LEAST_SCALE)
    figure = Figure(figsize=(columns / DPI, rows / DPI), dpi=DPI, frameon=False)
    canvas: Any = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(corner[0], corner[0] + columns)
    axes.set_ylim(corner[1] + rows, corner[1])
    for sighting in sightings:
        _trail(axes, sighting, (trails or {}).get(sighting.id, ()), scale)
    for sighting in sightings:
        _circle(axes, sighting, scale)
    frame = corner[0], corner[1], corner[0] + columns, corner[1] + rows
    for sighting, x, y in _numbers(sightings, frame, scale):
        _write(axes, sighting, x, y, scale)
    figure.patch.set_alpha(0.0)
    canvas.draw()
    marks = np.asarray(canvas.buffer_rgba(), np.float32)[:rows, :columns] / np.float32(255)
    share = marks[..., 3:]
    return np.asarray(shown * (1 - share) + marks[..., :3] * share, dtype=np.float32)


def _trail(axes: Any, sighting: Sighting, trail: Sequence[tuple[float, float]], scale: float) -> None:
    if trail:
        places, line = np.array([*trail, sighting.lamp.place]), LINE * scale * POINT
        axes.plot(places[:, 0], places[:, 1], color=_colour(sighting), linewidth=line, alpha=0.6, zorder=0.5)


def _circle(axes: Any, sighting: Sighting, scale: float) -> None:
    from matplotlib.patches import Circle

    colour, line = _colour(sighting), LINE * scale * POINT
    radius = _radius(sighting, scale)
    circle = Circle(sighting.lamp.place, radius, fill=False, edgecolor=colour, linewidth=line)
    circle.set_path_effects(_dark_about(scale, LINE))
    axes.add_patch(circle)


def _numbers(
    sightings: Sequence[Sighting], frame: tuple[int, int, int, int], scale: float
) -> list[tuple[Sighting, float, float]]:
    """Return where numbers stand: those of strong lights first, and none where there is no room."""
    left, top, right, bottom = frame
    marks = np.array([_mark_box(sighting, scale) for sighting in sightings]).reshape(-1, 4)
    taken, found = marks, []
    for k in sorted(range(len(sightings)), key=lambda k: -sightings[k].lamp.flux):
        sighting, (x, y) = sightings[k], sightings[k].lamp.place
        half = np.array([DIGIT * len(_name(sighting)), 1.0]) * TEXT * scale / 2
        off = _radius(sighting, scale) + APART * scale
        for side in SIDES:
            # Along a diagonal a circle is nearer than its corner.
            centre = np.array([x, y]) + np.array(side) * ((0.75 if all(side) else 1.0) * off + half)
            box = np.concatenate([centre - half, centre + half])
            inside = box[0] >= left and box[1] >= top and box[2] <= right and box[3] <= bottom
            beyond = np.hstack([box[:2] >= taken[:, 2:], box[2:] <= taken[:, :2]])
            apart = np.asarray(beyond.any(axis=1))
            apart[k] = True
            if inside and apart.all():
                taken = np.vstack([taken, box])
                found.append((sighting, float(centre[0]), float(centre[1])))
                break
    return found


def _write(axes: Any, sighting: Sighting, x: float, y: float, scale: float) -> None:
    text = axes.text(x, y, _name(sighting), color=_colour(sighting), fontsize=TEXT * scale * POINT)
    text.set(ha="center", va="center", weight="bold", clip_on=True)
    text.set_path_effects(_dark_about(scale, 0.0))


def _dark_about(scale: float, width: float) -> list[Any]:
    """Return what draws a dark rim about a line of some width, or about letters."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=(width + 2 * DARK) * scale * POINT, foreground=(0, 0, 0, 0.75))]


def _mark_box(sighting: Sighting, scale: float) -> tuple[float, float, float, float]:
    (x, y), radius = sighting.lamp.place, _radius(sighting, scale)
    return x - radius, y - radius, x + radius, y + radius


def _radius(sighting: Sighting, scale: float) -> float:
    return max(sighting.lamp.size / 2, LEAST_RADIUS * scale)


def _name(sighting: Sighting) -> str:
    return "+".join(str(number) for number in (sighting.id, *sighting.merged))


def _colour(sighting: Sighting) -> str:
    return COLOURS[(sighting.id - 1) % len(COLOURS)]
