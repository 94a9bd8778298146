"""The eye's patterns: from scratch, as a sum of components, and beside CIE 135."""

import math
from collections.abc import Generator, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import glare, picture
from aureole.bench.report import Column, Table
from aureole.bench.timing import alternate
from aureole.glare.flipbook import FRAMES
from aureole.glare.flipbook_error import FlipbookError
from aureole.records import Stage

AGES, PUPIL = (25.0, 70.0), 6e-3
ANGLES = (0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 30.0)
# Farthest angle at which waves alone are asked for, degrees.
WAVES_TO = 3.0
# Fields in degrees and the angles within which each is read; pixels on a side.
FIELDS, PIXELS = ((4.0, 0.05, 0.9), (90.0, 0.9, 45.0)), 601
# Lids of which the sum is compared with the wave, the pupil, the field, and rings of degrees.
OPENINGS, SUM_PUPIL, SUM_FIELD = (("open", 1.0), ("half closed", 0.5)), 5e-3, math.radians(40)
RINGS = ((0.05, 0.5), (0.5, 2.0), (2.0, 4.0), (4.0, 15.0))
# Section 5.1 of the thesis: T. Ritschel's own times for a pattern from scratch, 2009 and 2016.
PRINTED_FRESH = (19.0, 10.0)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def fresh(grids: Sequence[int], runs: int) -> Iterator[Stage]:
    """Time a pattern from scratch.

    Parameters
    ----------
    grids : sequence of int
        Samples on each side of the pupil's plane.
    runs : int
        How often each is timed.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    yield from _fresh(grids, runs, rows)
    columns = (
        Column("samples of the pupil", "{grid}²"),
        Column("waves reach", "{reach_deg:.1f}°"),
        Column("median", "{median_ms:.0f} ms"),
        Column("Ritschel 2009", "{printed_2009_ms:.0f} ms"),
        Column("2016", "{printed_2016_ms:.0f} ms"),
    )
    notes = (
        "A pattern of 512² pixels, 60° across, from nothing: drawn, transformed, in colour, with its tail. "
        " Ritschel's times are as the thesis quotes them (section 5.1), on graphics cards.",
    )
    yield Stage(1.0, "fresh", (Table("fresh", "A pattern from scratch", columns, tuple(rows), notes),))


def _fresh(grids: Sequence[int], runs: int, rows: list[dict[str, Any]]) -> Generator[Stage, None, None]:
    state = _still(30.0)
    make = partial(glare.eye_psf, state, (512, 512), np.radians(60.0))
    times = yield from alternate({f"{n}²": partial(make, size=n) for n in grids}, runs, label="pattern")
    for n in grids:
        reach = float(np.degrees(make(size=n).metadata["reach"]))
        printed = dict(zip(("printed_2009_ms", "printed_2016_ms"), PRINTED_FRESH, strict=True))
        rows.append(
            {"grid": n, "reach_deg": reach, "median_ms": times[f"{n}²"]} | (printed if n == 512 else {})
        )


def veil(grid: int) -> Iterator[Stage]:
    """Lay the mean over circles beside CIE 135.

    Parameters
    ----------
    grid : int
        Samples on each side of the pupil's plane.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: dict[float, dict[str, Any]] = {angle: {"angle_deg": angle} for angle in ANGLES}
    columns = [Column("angle", "{angle_deg:g}°")]
    for index, age in enumerate(AGES):
        state, key = replace(_still(age), pupil_diameter=PUPIL), f"{age:.0f}"
        yield Stage(index / len(AGES), f"veil at {age:.0f} years")
        waves, whole = (circle_means(state, ANGLES, tail, grid) for tail in (False, True))
        for place, angle in enumerate(ANGLES):
            standard = float(glare.veil.cie_135(np.radians(angle), age, state.eye.pigment))
            rows[angle] |= {f"standard_{key}": standard, f"ratio_{key}": whole[place] / standard}
            if angle <= WAVES_TO:
                rows[angle][f"waves_{key}"] = waves[place] / standard
        columns += [
            Column(f"CIE 135, {key} years", f"{{standard_{key}:.3g}}"),
            Column("ours over it", f"{{ratio_{key}:.2f}}"),
            Column("waves alone", f"{{waves_{key}:.2f}}"),
        ]
    notes = (
        f"Light per steradian, mean over rings of angle, a pupil of {1e3 * PUPIL:g} mm, equal-energy light "
        "weighted as the eye does. waves alone: diffraction in the pupil, without the standard's tail.",
    )
    title = "Veil beside CIE 135"
    yield Stage(1.0, "veil", (Table("veil", title, tuple(columns), tuple(rows.values()), notes),))


def summed(viewport: tuple[int, int], grid: int) -> Iterator[Stage]:
    """Compare the sum of components, as flipbooks hold it, with one wave through all of the eye.

    Parameters
    ----------
    viewport : tuple of int
        (rows, columns) of the frame.
    grid : int
        Samples on each side of the pupil's plane.

    Yields
    ------
    Stage
        The last one holds the table.
    """
    rows: list[dict[str, Any]] = []
    scene = picture.night_scene(viewport)
    for index, (words, opening) in enumerate(OPENINGS):
        state = glare.EyeState(glare.Eye(), 1.0, 1.0, SUM_PUPIL, lid_opening=opening)
        # The state is a node of each axis, so that no interpolation is mixed into the difference.
        nodes = {name: {axis: (getattr(state, axis),) for axis in axes} for name, axes in FRAMES.items()}
        stages = glare.make_flipbooks_stages(state.eye, viewport, SUM_FIELD, nodes, size=grid)
        for stage in stages:
            yield Stage((index + 0.7 * stage.fraction) / len(OPENINGS), f"sum, {words}: {stage.label}")
            books = stage.result
        error = glare.flipbook_error(books, state, grid, scene)
        rows.append(_differences(words, error))
    columns = (
        Column("lids", "{lids}", words=True),
        *(
            Column(f"{low:g}-{high:g}°", f"{{mean_{place}:+.1%}}, {{rms_{place}:.0%}}")
            for place, (low, high) in enumerate(RINGS)
        ),
        Column("all glare", "{spread:+.2%}"),
        Column("scene", "{psnr_db:.1f} dB"),
    )
    notes = (
        f"A pupil of {1e3 * SUM_PUPIL:g} mm. In each ring of angle: how far the mean of the sum's glare is "
        "from the wave's, and the root mean square of the difference by pixels, of the mean: where parts "
        "interfere, rays lie elsewhere. scene: the bundled night, PSNR of the frames.",
    )
    yield Stage(
        1.0, "sum", (Table("sum", "Sum of components against one wave", columns, tuple(rows), notes),)
    )


def _differences(words: str, error: FlipbookError) -> dict[str, Any]:
    """Gather the rings of an error into wider ones."""
    row: dict[str, Any] = {"lids": words, "spread": error.spread - 1, "psnr_db": error.psnr}
    edges = np.degrees(error.edges)
    middles = np.sqrt(edges[1:] * edges[:-1])
    for place, (low, high) in enumerate(RINGS):
        within = (middles >= low) & (middles < high)
        if within.any():
            row[f"mean_{place}"] = float(np.mean(np.array(error.ratios)[within])) - 1
            row[f"rms_{place}"] = float(np.mean(np.array(error.deviations)[within]))
    return row


def circle_means(
    state: glare.EyeState, angles: Sequence[float], tail: bool = True, grid: int | None = None
) -> NDArray[np.float64]:
    """Return the mean over circles about the core, from a narrow and a wide field.

    Parameters
    ----------
    state : EyeState
        The eye.
    angles : sequence of float
        Degrees from the core, 0.06 to 38; each stands for a ring from 0.9 to 1.1 of it.
    tail : bool
        Whether the pattern has the standard's tail.
    grid : int, optional
        Samples on each side of the pupil's plane.

    Returns
    -------
    ndarray of float64, shape (len(angles),)
        Share of the light per steradian, each wavelength weighted by its luminance.
    """
    found = np.full(len(angles), np.nan)
    for field, low, high in FIELDS:
        psf = glare.eye_psf(state, (PIXELS, PIXELS), np.radians(field), tail=tail, size=grid)
        pixel = np.radians(field) / PIXELS
        down, across = np.indices((PIXELS, PIXELS)) - PIXELS // 2
        radius = np.hypot(down, across) * pixel
        # A pixel of constant angles is narrower on the sphere the farther out it lies.
        solid = pixel**2 * np.sinc(radius / np.pi)
        energy = psf.pixels @ LUMINANCE
        for place, angle in enumerate(angles):
            ring = np.abs(radius / np.radians(angle) - 1) < 0.1
            if low <= angle < high:
                found[place] = energy[ring].sum() / solid[ring].sum()
    return found


def _still(age: float) -> glare.EyeState:
    return glare.EyeState.at(1.0, 0.1, age=age, blinking=False, hippus=False)
