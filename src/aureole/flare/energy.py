"""How much light each ghost carries, which ghosts matter, and what they make up together.

Energies come from sheets of rays: a cell of the pupil carries its area times the mean of its corners'
weights, and a cell that an edge crosses only its part inside, cut along the straight line on which the
largest relative radius is 1. `aureole.flare.random_rays` is the truth that they are tested against.
"""

import dataclasses
import re
from collections.abc import Iterator, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.flare import ghost_colour, pupil, tracing
from aureole.flare.ghost_paths import WHICH, GhostPath, ghosts
from aureole.flare.glass import D_LINE
from aureole.flare.prescription import Lens
from aureole.flare.random_rays import front
from aureole.flare.spectral import Sampling, sample_spectrum
from aureole.records import Light

# Rays a side of a sheet: the energies of a lens's ten strongest ghosts are then right to a fraction of 1 %.
BASE = 64
WAVELENGTHS = 4
# For an order of ghosts less will do: most energies are then right to 5 %.
RANKING_BASE, RANKING_WAVELENGTHS = 32, 1
WITHIN = ("plane", "frame")
# How many ghosts' sheets are held at once.
TOGETHER = 64
# Rays a side over the front, and ghosts at a time, when very many are looked through.
PROBES, MANY = 11, 1024
AXIS = (0.0, 0.0, 1.0)
IMAGE, IMAGE_BASE = GhostPath(()), 128
# An image below this part of one on the axis counts as none.
LEAST_IMAGE = 1e-6

Numbers = NDArray[np.float64]
Direction = tuple[float, float, float]
Scalar = TypeVar("Scalar", np.bool_, np.float64)


def sheet_energy(sheet: pupil.Sheet, sensor: tuple[float, float] | None = None) -> Numbers:
    """Return what the rays of a sheet carry through all semi-apertures and the round iris.

    Parameters
    ----------
    sheet : Sheet
        Rays of one ghost on a regular grid of the pupil.
    sensor : tuple of float, optional
        Width and height in metres; only what falls inside then counts.

    Returns
    -------
    ndarray, shape (W,)
        Power over the light's irradiance, m².
    """
    margin = _margins(sheet, sensor)
    reached = _corners(sheet.reached & np.isfinite(margin))
    weight = _corners(np.where(sheet.reached, sheet.weight, 0.0).astype(np.float64))
    inside = _corners(margin)
    whole = (reached & (inside >= 0)).all(axis=-1)
    cut = (reached & (inside >= 0)).any(axis=-1) & ~whole
    found = np.where(whole, weight.mean(axis=-1), 0.0)
    found[cut] = _cut_cells(inside[cut], weight[cut], reached[cut])
    energy: Numbers = found.sum(axis=(1, 2)) * sheet.cell
    return energy


def ghost_powers(
    lens: Lens,
    paths: Sequence[GhostPath],
    direction: Direction,
    wavelengths: ArrayLike = D_LINE,
    f_number: float | None = None,
    base: int = BASE,
    within: str = "plane",
) -> Numbers:
    """Return what each ghost carries at each wavelength.

    Parameters
    ----------
    lens : Lens
        The lens.
    paths : sequence of GhostPath
        The ghosts.
    direction : tuple of float
        Unit vector from the lens towards the light: x to the right, y downward, z forward.
    wavelengths : array_like, shape (W,)
        Metres.
    f_number : float, optional
        Wide open without it.
    base : int
        Rays along each side of each ghost's grid.
    within : {"plane", "frame"}
        All that reaches the sensor's plane, or what falls on the sensor.

    Returns
    -------
    ndarray, shape (G, W)
        Power over the light's irradiance, m².
    """
    refuse.one_of("within", within, WITHIN)
    prepared = tracing.prepare(lens, np.atleast_1d(np.asarray(wavelengths, dtype=np.float64)), f_number)
    sensor = lens.sensor if within == "frame" else None
    place = {path.reflections: k for k, path in enumerate(paths)}
    found = np.zeros((len(paths), prepared.wavelengths.size))
    for together in _sheets(prepared, paths, direction, base):
        for sheet in together:
            found[place[tracing.reflections(sheet.path)]] = sheet_energy(sheet, sensor)
    return found


def ghost_energies(
    lens: Lens,
    paths: Sequence[GhostPath],
    lights: Light | Sequence[Light],
    f_number: float | None = None,
    wavelengths: int = WAVELENGTHS,
    base: int = BASE,
    within: str = "frame",
) -> Numbers:
    """Return each ghost's light as a part of that in the lights' own image, as the eye weighs it.

    Parameters
    ----------
    lens : Lens
        The lens.
    paths : sequence of GhostPath
        The ghosts.
    lights : Light or sequence of Light
        Far from the lens; each counts by its irradiance and is taken as a point.
    f_number : float, optional
        Wide open without it.
    wavelengths : int
        How many to trace for each light.
    base : int
        Rays along each side of each ghost's grid.
    within : {"plane", "frame"}
        All that reaches the sensor's plane, or what falls on the sensor, as the image does.

    Returns
    -------
    ndarray, shape (G,)
        Luminous power of the ghost over that of the image. Where the lens lets no light to the image,
        as from far outside its field, over that of an image on the axis.

    Raises
    ------
    refuse.Refusal
        Where a light is not in front of the lens, or no light is given.
    """
    refuse.one_of("within", within, WITHIN)
    sources = [lights] if isinstance(lights, Light) else list(lights)
    if not sources:
        raise refuse.Refusal("'lights' needs one light or more, got none.")
    sensor = lens.sensor if within == "frame" else None
    ghost, image, centred = np.zeros(len(paths)), 0.0, 0.0
    for light in sources:
        sampling = sample_spectrum(light.spectrum, wavelengths)
        prepared = tracing.prepare(lens, sampling.wavelengths, f_number)
        asked = prepared, sampling, light.irradiance
        ghost += _luminous(*asked, paths, light.direction, base, sensor)
        centred += float(_luminous(*asked, [IMAGE], AXIS, IMAGE_BASE)[0])
        image += float(_luminous(*asked, [IMAGE], light.direction, IMAGE_BASE)[0])
    # A light far outside the field has no image to compare with.
    return ghost / (image if image > LEAST_IMAGE * centred else centred)


def ghost_to_image(
    lens: Lens,
    lights: Light | Sequence[Light],
    which: str = "all",
    f_number: float | None = None,
    wavelengths: int = WAVELENGTHS,
    base: int = BASE,
    within: str = "frame",
) -> float:
    """Return the light in a lens's ghosts over that in the lights' own image.

    Parameters
    ----------
    lens : Lens
        The lens.
    lights : Light or sequence of Light
        Far from the lens.
    which : str
        The ghosts, as in `chosen`.
    f_number : float, optional
        Wide open without it.
    wavelengths : int
        How many to trace for each light.
    base : int
        Rays along each side of each ghost's grid.
    within : {"plane", "frame"}
        All that reaches the sensor's plane, or what falls on the sensor, as the image does.

    Returns
    -------
    float
        Luminous power over luminous power.
    """
    paths = chosen(lens, which, lights, f_number)
    return float(ghost_energies(lens, paths, lights, f_number, wavelengths, base, within).sum())


def ranked(
    lens: Lens,
    paths: Sequence[GhostPath],
    lights: Light | Sequence[Light],
    f_number: float | None = None,
    wavelengths: int = WAVELENGTHS,
    base: int = BASE,
    within: str = "frame",
) -> list[GhostPath]:
    """Return ghosts with their energies, the strongest first.

    Parameters
    ----------
    lens : Lens
        The lens.
    paths : sequence of GhostPath
        The ghosts.
    lights : Light or sequence of Light
        Far from the lens.
    f_number : float, optional
        Wide open without it.
    wavelengths : int
        How many to trace for each light.
    base : int
        Rays along each side of each ghost's grid.
    within : {"plane", "frame"}
        All that reaches the sensor's plane, or what falls on the sensor, as the image does.

    Returns
    -------
    list of GhostPath
        Equal ones stay in the order given.
    """
    energies = ghost_energies(lens, paths, lights, f_number, wavelengths, base, within)
    known = [dataclasses.replace(path, energy=float(e)) for path, e in zip(paths, energies, strict=True)]
    return sorted(known, key=lambda path: -(path.energy or 0.0))


def shortlist(
    lens: Lens,
    paths: Sequence[GhostPath],
    lights: Light | Sequence[Light],
    count: int = 400,
    f_number: float | None = None,
) -> list[GhostPath]:
    """Return the ghosts that few rays say are the strongest, out of very many.

    Parameters
    ----------
    lens : Lens
        The lens.
    paths : sequence of GhostPath
        Such as the two hundred thousand of `aureole.flare.four_bounces` of a zoom.
    lights : Light or sequence of Light
        Far from the lens.
    count : int
        How many to return at most.
    f_number : float, optional
        Wide open without it.

    Returns
    -------
    list of GhostPath
        By what 121 rays over the front bring to the sensor at one wavelength, most first; those that bring
        nothing are left out.
    """
    refuse.at_least("count", count, 1)
    found = np.zeros(len(paths))
    for light in [lights] if isinstance(lights, Light) else lights:
        sampling = sample_spectrum(light.spectrum, 1)
        prepared = tracing.prepare(lens, sampling.wavelengths, f_number)
        low, high = front(lens, light.direction)
        steps = (np.arange(PROBES) + 0.5) / PROBES
        x, y = np.meshgrid(low[0] + (high[0] - low[0]) * steps, low[1] + (high[1] - low[1]) * steps)
        points = np.stack([x.ravel(), y.ravel()], axis=1)
        for first in range(0, len(paths), MANY):
            some = paths[first : first + MANY]
            counts, grids = [len(points)] * len(some), np.tile(points, (len(some), 1))
            rays = tracing.follow(prepared, some, counts, grids, tracing.travel(light.direction))
            seen = (np.abs(rays.x) <= lens.sensor[0] / 2.0) & (np.abs(rays.y) <= lens.sensor[1] / 2.0)
            carried = np.where(rays.passed & seen, rays.weight, 0.0).reshape(len(some), -1).sum(axis=1)
            found[first : first + MANY] += light.irradiance * carried
    order = np.argsort(-found, kind="stable")[:count]
    return [paths[k] for k in order if found[k] > 0.0]


def strongest(paths: Sequence[GhostPath], wanted: str) -> list[GhostPath]:
    """Return the strongest of ranked ghosts: so many, or so much of their energy.

    Parameters
    ----------
    paths : sequence of GhostPath
        From `ranked`.
    wanted : str
        "top:20" for twenty of them; "90%" for as few as hold that much of their energy.

    Returns
    -------
    list of GhostPath
        Strongest first.

    Raises
    ------
    refuse.Refusal
        Where `wanted` is neither.
    """
    count, share = re.fullmatch(r"top:(\d+)", wanted), re.fullmatch(r"(\d+(?:\.\d+)?)%", wanted)
    if count and int(count[1]) >= 1:
        return list(paths[: int(count[1])])
    if not share or not 0 < float(share[1]) <= 100:
        raise refuse.Refusal(f"'ghosts' must be such as 'top:20' or '90%', got '{wanted}'.")
    energies = np.array([path.energy or 0.0 for path in paths])
    part = np.cumsum(energies) / max(float(energies.sum()), np.finfo(float).tiny)
    # Rounding of the sum must not ask for one more.
    enough = int(np.searchsorted(part, float(share[1]) / 100.0 - 1e-12)) + 1
    return list(paths[:enough])


def chosen(
    lens: Lens,
    which: str,
    lights: Light | Sequence[Light],
    f_number: float | None = None,
    pool: str = "all",
) -> list[GhostPath]:
    """Return the ghosts that a word asks for.

    Parameters
    ----------
    lens : Lens
        The lens.
    which : str
        "same-side", "paper" or "all" as in `aureole.flare.ghosts`; "top:20" or "90%" as in `strongest`.
    lights : Light or sequence of Light
        By which the ghosts are ranked.
    f_number : float, optional
        Wide open without it.
    pool : {"all", "same-side", "paper"}
        Out of which ghosts the strongest are taken.

    Returns
    -------
    list of GhostPath
        With their energies where they were ranked, to about 5 %.

    Raises
    ------
    refuse.Refusal
        Where the word is unknown.
    """
    if checked(which) in WHICH:
        return ghosts(lens, which)
    every = ranked(lens, ghosts(lens, pool), lights, f_number, RANKING_WAVELENGTHS, RANKING_BASE)
    return strongest(every, which)


def checked(which: str) -> str:
    """Refuse, before any work, a word that asks for no ghosts.

    Parameters
    ----------
    which : str
        As in `chosen`.

    Returns
    -------
    str
        The same.

    Raises
    ------
    refuse.Refusal
        Where the word is unknown.
    """
    if which in WHICH:
        return which
    if not re.fullmatch(r"top:.*|.*%", which):
        refuse.one_of("ghosts", which, (*WHICH, "top:20", "90%"))
    strongest([], which)
    return which


def _luminous(
    prepared: tracing.Prepared,
    sampling: Sampling,
    irradiance: float,
    paths: Sequence[GhostPath],
    direction: Direction,
    base: int,
    sensor: tuple[float, float] | None = None,
) -> Numbers:
    """Return each ghost's luminous power in parts of the irradiance's, (G,), m²."""
    place = {path.reflections: k for k, path in enumerate(paths)}
    exact = ghost_colour.prepare_curves(prepared.lens, sampling)
    traced, luminous = sampling.wavelengths, irradiance * sampling.colours[:, 1]
    known = np.array_equal(traced, sampling.cells)
    found = np.zeros(len(paths))
    for together in _sheets(prepared, paths, direction, base):
        curves = ghost_colour.curves(exact, together, direction, sensor)
        for sheet, curve in zip(together, curves, strict=True):
            power = sheet_energy(sheet, sensor)
            if not known:
                power = ghost_colour.weight_blend(curve, exact, traced, sampling.cells) @ power
            found[place[tracing.reflections(sheet.path)]] = max(float(luminous @ power), 0.0)
    return found


def _sheets(
    prepared: tracing.Prepared, paths: Sequence[GhostPath], direction: Direction, base: int
) -> Iterator[list[pupil.Sheet]]:
    for first in range(0, len(paths), TOGETHER):
        yield pupil.sheets(prepared, paths[first : first + TOGETHER], direction, base=base)


def _margins(sheet: pupil.Sheet, sensor: tuple[float, float] | None) -> Numbers:
    """Return how far inside every edge each ray is, (W, rows, columns): below 0 it is blocked."""
    outermost = np.maximum(sheet.level, np.hypot(sheet.stop_x, sheet.stop_y)).astype(np.float64)
    if sensor is not None:
        beside = np.maximum(np.abs(sheet.x) / (sensor[0] / 2.0), np.abs(sheet.y) / (sensor[1] / 2.0))
        outermost = np.maximum(outermost, beside)
    return 1.0 - outermost


def _corners(values: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return the four corners of each cell, in order around it, (W, rows - 1, columns - 1, 4)."""
    around = values[:, :-1, :-1], values[:, :-1, 1:], values[:, 1:, 1:], values[:, 1:, :-1]
    return np.stack(around, axis=-1)


def _cut_cells(margin: Numbers, weight: Numbers, reached: NDArray[np.bool_]) -> Numbers:
    """Return which part of their weight cells keep whose corners (N, 4) are not all inside."""
    # A corner that no ray reached is as far outside as its neighbours are inside: the edge is half way.
    deepest = np.max(np.where(reached, margin, 0.0), axis=1, keepdims=True)
    whole = np.where(reached, margin, -deepest), weight
    centre = [each.mean(axis=1) for each in whole]
    total = np.zeros(len(margin))
    for k in range(4):
        ends = [k, (k + 1) % 4]
        corners = (np.column_stack([each[:, ends], mean]) for each, mean in zip(whole, centre, strict=True))
        total += _cut_triangles(*corners) / 4.0
    return total


def _cut_triangles(margin: Numbers, weight: Numbers) -> Numbers:
    """Return the mean over triangles (N, 3) of a linear weight where a linear margin is above 0."""
    order = np.argsort(-margin, axis=1)
    margin = np.take_along_axis(margin, order, axis=1)
    weight = np.take_along_axis(weight, order, axis=1)
    count = np.count_nonzero(margin >= 0, axis=1)
    # With one corner inside the part is a triangle there; with two, all but a triangle at the third.
    tip = np.where(count == 1, 0, 2)[:, None]
    others = np.where(tip == 0, [[1, 2]], [[0, 1]])
    f, w = np.take_along_axis(margin, tip, axis=1), np.take_along_axis(weight, tip, axis=1)
    g, v = np.take_along_axis(margin, others, axis=1), np.take_along_axis(weight, others, axis=1)
    gap = f - g
    along = f / np.where(gap == 0.0, 1.0, gap)
    area = along[:, 0] * along[:, 1]
    corner = area * (w[:, 0] + np.sum(w + along * (v - w), axis=1)) / 3.0
    whole = weight.mean(axis=1)
    return np.select(
        [count == 0, count == 1, count == 2], [np.zeros_like(whole), corner, whole - corner], whole
    )
