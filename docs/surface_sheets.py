"""What the scripts of docs/surface.md share: sheets of pictures, lamps, samples, and views of them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aureole import Picture, picture, surface
from aureole.picture.transfer import decode_srgb

Pixels = NDArray[np.float32]
# A phone's screen and a sheet of paper, metres.
SCREEN, SHEET = surface.Plane(0.056, 0.098), surface.Plane(0.12, 0.12)
ROOM_ROWS = 768
COMPACT_DISC = surface.Disc(0.12, 0.044)


def shown(drawn: Picture | NDArray[np.floating], stops: float) -> Pixels:
    """Return a linear picture for a screen.

    Spectral colours have negative parts, which are cut off: to keep their luminance instead would draw a
    line where violet passes the screen's own blue.
    """
    pixels = drawn.pixels[..., :3] if isinstance(drawn, Picture) else drawn
    return picture.to_display(np.maximum(pixels, 0.0).astype(np.float32), stops, "filmic")


def sheet(rows: Sequence[Sequence[Pixels]], gap: int = 6) -> Pixels:
    """Put pictures of one size beside and below each other, white between them."""
    strips = [picture.side_by_side(row, gap) for row in rows]
    line = np.ones((gap, strips[0].shape[1], 3), np.float32)
    return np.concatenate([part for strip in strips for part in (strip, line)][:-1])


def write(pixels: Pixels, path: Path) -> None:
    """Write a picture that is ready for a screen."""
    picture.write(path, Picture(decode_srgb(np.ascontiguousarray(pixels, dtype=np.float32)), "rec709"))


def facing(shape: tuple[int, int], height: float, distance: float) -> "surface.View":
    """Return a view along −z that shows so many metres of z = 0 from above to below."""
    angle = 2 * np.arctan(0.5 * height / distance)
    return surface.view_from((0.0, 0.0, distance), (0.0, 0.0, 0.0), shape, float(angle))


def lamp(place: Sequence[float], irradiance: float = 1.0, radius: float = 0.0) -> tuple["surface.Lamp", ...]:
    """Return a lamp that gives the origin so much irradiance; with a radius, a ball of even light."""
    centre = np.asarray(place, dtype=float)
    strength = irradiance * float(centre @ centre)
    if not radius:
        return (surface.point_lamp(centre, strength),)
    toward = centre / np.linalg.norm(centre)
    across = np.cross(toward, (0.0, 1.0, 0.0) if abs(toward[1]) < 0.9 else (1.0, 0.0, 0.0))
    across /= np.linalg.norm(across)
    along = np.cross(toward, across)
    # A sunflower's seeds cover a disc evenly.
    count = 61
    spots = np.sqrt((np.arange(count) + 0.5) / count) * radius
    turns = np.arange(count) * np.pi * (3 - np.sqrt(5))
    places = centre + np.outer(spots * np.cos(turns), across) + np.outer(spots * np.sin(turns), along)
    return tuple(surface.point_lamp(each, strength / count) for each in places)


def drawn(
    table: "surface.ScatterTable | Sequence[surface.ScatterTable]",
    shape: "surface.Shape",
    view: "surface.View",
    lamps: Sequence["surface.Lamp"],
    material: "surface.Material | None" = None,
    samples: int = 2,
    **others: object,
) -> Picture:
    """Return the picture of a sample under lamps."""
    scene = surface.Scene(tuple(lamps), view, material=material or surface.Material(), **others)
    return surface.render(scene, table, shape, samples)


def holographic() -> "surface.Grating":
    """Return a stand-in for holographic paper: wide lobes about crossed lines, 2 µm apart."""
    lines = surface.Lines(2.0e-6, 0.7e-6, 4)
    return surface.crossed_grating(lines, lines, "holographic paper")


def hall(rows: int = ROOM_ROWS, seed: int = 7) -> "surface.Environment":
    """Return a dark hall with rows of small warm lamps, a round window and three white lamps.

    Radiance is relative. All are where a sample sees them that looks along +z.
    """
    latitude = np.pi / 2 - np.pi * (np.arange(rows)[:, None] + 0.5) / rows
    longitude = np.pi * ((np.arange(2 * rows)[None, :] + 0.5) / rows - 1.0)
    toward = np.stack(
        [
            np.cos(latitude) * np.sin(longitude),
            np.sin(latitude) + 0 * longitude,
            -np.cos(latitude) * np.cos(longitude),
        ],
        axis=-1,
    )
    radiance = 0.03 * (1.2 + toward[..., 1:2]) * np.array([1.0, 0.85, 0.7])

    def add(place: Sequence[float], radius: float, colour: Sequence[float]) -> None:
        where = np.asarray(place) / np.linalg.norm(place)
        away = np.arccos(np.clip(toward @ where, -1, 1))
        cover = np.clip((radius - away) * rows / np.pi + 0.5, 0, 1)
        # A lamp smaller than a pixel keeps its light.
        area = cover.sum() * (np.pi / rows) ** 2 * np.cos(np.arcsin(where[1]))
        share = 1.0 if radius > 2 * np.pi / rows else np.pi * radius**2 / area
        nonlocal radiance
        radiance = radiance + share * cover[..., None] * np.asarray(colour)

    add((0.17, 0.36, 1.0), 0.07, (9.0, 10.0, 12.0))
    generator = np.random.default_rng(seed)
    for side in (-1.0, 1.0):
        for step in range(7):
            place = (side * (0.55 + 0.03 * step), 0.42 + 0.05 * step, 1.6 - 0.42 * step)
            add(place, np.radians(0.5), 2500.0 * np.array([1.0, 0.74, 0.45]) * generator.uniform(0.7, 1.3))
    for place in ((-0.07, 0.44, 1.0), (0.03, 0.22, 1.0), (0.0, 0.8, 1.0)):
        add(place, np.radians(0.6), (2600.0, 2900.0, 3200.0))
    return surface.Environment(radiance.astype(np.float32), "rec709", "hall")
