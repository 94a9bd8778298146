"""A lens drawn from the side: its glass, stop and sensor, rays of the image and of chosen ghosts."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole.flare import GhostPath, Lens, Traced, paraxial, trace_reference
from aureole.flare.glass import AIR
from aureole.flare.lint import sag
from aureole.jobs.page import ACCENT, BLUE, INK, QUIET, check_page, save

GLASS, FLINT, EDGE = "#dbeafe", "#bfd3ef", "#64748b"
GHOSTS = ("#b91c1c", "#7c3aed", "#047857", "#b45309", "#be185d", "#0e7490")
# Rays are sought among so many across the front; so many of them are drawn.
TRIED, IMAGE_RAYS, GHOST_RAYS = 801, 5, 9
WIDTH_INCHES, LEAST_INCHES, MOST_INCHES = 11.7, 3.6, 9.0
MM = 1e3
Numbers = NDArray[np.float64]


def check_drawing(path: Path) -> Path:
    """Refuse, before any work, a place or a format for which no drawing can be written.

    Parameters
    ----------
    path : Path
        File to write.

    Returns
    -------
    Path
        The same.
    """
    return check_page(path, "drawing")


def write_drawing(
    path: Path, lens: Lens, ghosts: Sequence[GhostPath] = (), angle: float | None = None
) -> list[str]:
    """Draw a lens in the y-z plane and write the picture.

    Parameters
    ----------
    path : Path
        File to write; its suffix says the format: PNG, JPEG, PDF or SVG.
    lens : Lens
        The lens.
    ghosts : sequence of GhostPath
        Ghosts whose rays are drawn, too.
    angle : float, optional
        Of the light off the axis, radians; half of the field without it.

    Returns
    -------
    list of str
        Notes: ghosts of which no ray passes all semi-apertures.

    Raises
    ------
    aureole.refuse.Refusal
        Where the file cannot be written.
    """
    from matplotlib.figure import Figure

    check_drawing(path)
    slope = np.tan(field_angle(lens) / 2 if angle is None else angle)
    half_height, span = _size(lens)
    inches = np.clip(WIDTH_INCHES * 2 * half_height / span + 1.2, LEAST_INCHES, MOST_INCHES)
    figure = Figure(figsize=(WIDTH_INCHES, float(inches)), facecolor="white", layout="constrained")
    axes = figure.add_subplot()
    _draw_glass(axes, lens)
    _draw_stop_and_sensor(axes, lens)
    _draw_numbers(axes, lens)
    start, label = -0.12 * span, f"light at {np.degrees(np.arctan(slope)):.3g}°"
    ways: list[tuple[str, tuple[int, ...], float, str]] = []
    ways.append((label, (), slope, BLUE if ghosts else ACCENT))
    if not ghosts:
        ways.insert(0, ("light on the axis", (), 0.0, BLUE))
    for ghost, colour in zip(ghosts, GHOSTS * len(ghosts), strict=False):
        ways.append((f"ghost {ghost.name.replace('-', ', ')}", ghost.reflections, slope, colour))
    notes = []
    for name, reflections, lean, colour in ways:
        traced, passes = _passing(lens, reflections, lean, start, GHOST_RAYS if ghosts else IMAGE_RAYS)
        _draw_rays(axes, traced, colour, name if passes else f"{name} (blocked)", "-" if passes else ":")
        if not passes:
            notes.append(f"{name}: no ray passes all semi-apertures; blocked ones are dotted")
    _finish(axes, lens, half_height, span)
    save(path, figure)
    return notes


def field_angle(lens: Lens) -> float:
    """Return the angle from the axis to the sensor's upper edge.

    Parameters
    ----------
    lens : Lens
        The lens.

    Returns
    -------
    float
        Radians.
    """
    return float(np.arctan(lens.sensor[1] / (2 * abs(paraxial.focal_length(lens)))))


def _size(lens: Lens) -> tuple[float, float]:
    """Return half the drawing's height and its length, millimetres."""
    widest = max(surface.semi_aperture for surface in lens.surfaces)
    length = sum(surface.thickness for surface in lens.surfaces)
    return MM * 1.25 * max(widest, lens.sensor[1] / 2), MM * 1.18 * length


def _vertices(lens: Lens) -> Numbers:
    return np.concatenate([[0.0], np.cumsum([surface.thickness for surface in lens.surfaces])])


def _profile(lens: Lens, index: int, place: float) -> Numbers:
    """Return a surface's outline from its lower to its upper rim, shape (N, 2) as (z, y) in metres."""
    surface = lens.surfaces[index]
    heights = np.linspace(-surface.semi_aperture, surface.semi_aperture, 81)
    curved = surface.cylinder != "x"
    return np.array([[place + (sag(surface, y) if curved else 0.0), y] for y in heights])


def _draw_glass(axes: Any, lens: Lens) -> None:
    """Fill each piece of glass between two surfaces; the wider one says where it ends."""
    places = _vertices(lens)
    for k, surface in enumerate(lens.surfaces[:-1]):
        if surface.glass == AIR:
            continue
        front, rear = _profile(lens, k, places[k]), _profile(lens, k + 1, places[k + 1])
        rim = max(front[-1, 1], rear[-1, 1])
        upper = [[front[-1, 0], rim], [rear[-1, 0], rim]]
        lower = [[rear[0, 0], -rim], [front[0, 0], -rim]]
        outline = MM * np.concatenate([front, upper, rear[::-1], lower])
        shade = FLINT if (surface.glass.abbe or 99.0) < 45 else GLASS
        axes.fill(outline[:, 0], outline[:, 1], facecolor=shade, edgecolor=EDGE, lw=0.7, zorder=2)


def _draw_stop_and_sensor(axes: Any, lens: Lens) -> None:
    places, stop = MM * _vertices(lens), lens.surfaces[lens.stop]
    height, widest = MM * stop.semi_aperture, MM * max(s.semi_aperture for s in lens.surfaces)
    for side in (1, -1):
        ends = [side * height, side * max(1.25 * height, 0.9 * widest)]
        axes.plot([places[lens.stop]] * 2, ends, color=INK, lw=2.2, solid_capstyle="butt", zorder=4)
    half = MM * lens.sensor[1] / 2
    axes.plot([places[-1]] * 2, [-half, half], color=INK, lw=3, solid_capstyle="butt", zorder=4)


def _draw_numbers(axes: Any, lens: Lens) -> None:
    """Count the surfaces from 1, on three lines where they stand close."""
    places, (half_height, _) = MM * _vertices(lens), _size(lens)
    for k in range(len(lens.surfaces)):
        height = half_height * (1.03 + 0.07 * (k % 3))
        word = f"{k + 1}" if k != lens.stop else f"{k + 1} stop"
        axes.text(places[k], height, word, fontsize=6, color=QUIET, ha="center", va="center")


def _passing(
    lens: Lens, reflections: Sequence[int], slope: float, start: float, wanted: int
) -> tuple[Traced, bool]:
    """Return rays of a bundle that pass, spread evenly over those that do; else the least blocked ones."""
    z = start / MM
    place, _ = paraxial.entrance_pupil(lens)
    reach = 1.2 * max(surface.semi_aperture for surface in lens.surfaces)
    # Heights in the plane of the entrance pupil, so that slanted bundles are met, too.
    heights = np.linspace(-reach, reach, TRIED) + (z - place) * slope
    traced = _trace(lens, reflections, heights, slope, z)
    passed = np.flatnonzero(traced.passed)
    if len(passed):
        chosen = passed[np.unique(np.linspace(0, len(passed) - 1, wanted).round().astype(int))]
        return _trace(lens, reflections, heights[chosen], slope, z), True
    order = np.argsort(np.where(traced.reached, traced.relative_radius, np.inf))
    return _trace(lens, reflections, heights[np.sort(order[:wanted])], slope, z), False


def _trace(lens: Lens, reflections: Sequence[int], heights: Numbers, slope: float, z: float) -> Traced:
    zeros = np.zeros_like(heights)
    origins = np.column_stack([zeros, heights, zeros + z])
    return trace_reference(lens, reflections, origins, np.column_stack([zeros, zeros + slope, zeros + 1.0]))


def _draw_rays(axes: Any, traced: Traced, colour: str, label: str, style: str = "-") -> None:
    for k in np.flatnonzero(traced.reached):
        way = MM * traced.points[:, k]
        axes.plot(way[:, 2], way[:, 1], color=colour, lw=0.8, ls=style, label=label, zorder=3)
        label = "_"


def _finish(axes: Any, lens: Lens, half_height: float, span: float) -> None:
    focal, stops = MM * paraxial.focal_length(lens), paraxial.f_number(lens)
    title = f"{lens.title}: {focal:.4g} mm, f/{stops:.3g}"
    axes.set_title(title, fontsize=11, color=INK, loc="left", weight="bold")
    axes.plot([-0.12 * span, 0.88 * span], [0, 0], color=QUIET, lw=0.5, ls=(0, (8, 3, 1, 3)), zorder=1)
    axes.set_xlim(-0.12 * span, 0.88 * span)
    axes.set_ylim(-1.1 * half_height, 1.22 * half_height)
    axes.set_aspect("equal")
    axes.set_xlabel("mm", fontsize=8, color=QUIET)
    axes.tick_params(labelsize=7, colors=QUIET)
    for spine in axes.spines.values():
        spine.set_visible(False)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower left", fontsize=7, edgecolor="none", labelcolor=INK, ncols=4)
