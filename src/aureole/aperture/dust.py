"""Dirt on the opening: dust of gradient noise, and scratches.

Dust is Perlin's improved noise (Perlin 2002), octave over octave, where it rises above a level; its
third dimension is time, so that an animation is coherent. Scratches are slender lenses between two
arcs. Both follow from their seed alone, through the bits of PCG64, which never change; both lie on endless
glass that can be moved behind the opening, so that dirt drifts with the camera (`housing.parallax`).
"""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.aperture import _kernels_noise
from aureole.aperture.chances import bits, uniform
from aureole.aperture.geometry import chords
from aureole.aperture.masks import CHORD_TOLERANCE, darken, rasterize, seen_through
from aureole.records import Aperture, Outline

# Cells after which the noise repeats.
TABLE = 1 << 16
# A finer cell would lie between the pixels.
SMALLEST_CELL = 2.0
STRETCH_LIMIT, SOFTNESS_LIMIT = 1000.0, 100.0
# Numbers that describe a scratch: x, y, direction, length, width, bend, darkness.
SCRATCH_CHANCES = 7
# Glass can be moved by so many times the aperture's width.
FARTHEST = 1e6


def dust(
    aperture: Aperture,
    size: int,
    amount: float,
    scale: float,
    seed: int,
    stretch: float = 1.0,
    angle: float = 0.0,
    time: float = 0.0,
    octaves: int = 4,
    softness: float = 0.3,
    shift: tuple[float, float] = (0.0, 0.0),
) -> Aperture:
    """See an aperture through dust (quad paper §4.4, Fig. 5).

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.
    size : int
        Pixels on each side of the result.
    amount : float
        Part of the open area that dust touches, 0 to 1.
    scale : float
        Size of the noise's largest cells, metres.
    seed : int
        The same gives the same dust on every machine.
    stretch : float
        How many times longer than broad the specks are, 1 to 1000.
    angle : float
        Direction along which they are stretched, radians, counter-clockwise as seen from +x.
    time : float
        Seconds; after about one the dust is another, close times give close pictures.
    octaves : int
        How many sizes of detail, each half of the one before; those below two pixels are left out.
    softness : float
        How far above its level the noise darkens a pixel wholly, over the noise's standard
        deviation, 0 to 100; 0 makes sharp specks.
    shift : tuple of float
        (x, y) by which the specks are moved, metres. They keep their shapes: the amount is that of dust
        that is not moved.

    Returns
    -------
    Aperture
        A raster on the aperture's width, with its wavefront.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, no light is left, or a wavefront would be resampled.
    """
    refuse.at_least("size", size, 1)
    refuse.between("amount", amount, 0, 1)
    pixel = aperture.width / size
    cell = refuse.positive("scale", scale) / pixel
    if cell < SMALLEST_CELL:
        raise refuse.Refusal(
            f"'scale' must be at least two pixels, here {SMALLEST_CELL * pixel:g} m, got {scale:g}."
        )
    refuse.between("stretch", stretch, 1, STRETCH_LIMIT)
    refuse.between("softness", softness, 0, SOFTNESS_LIMIT)
    octaves = min(refuse.at_least("octaves", octaves, 1), 1 + int(math.log2(cell / SMALLEST_CELL)))
    refuse.finite("time", time)
    refuse.finite("angle", angle)
    refuse.at_least("seed", seed, 0)
    mask = rasterize(aperture, size).astype(np.float64)
    moved = _pixels(shift, pixel)
    if amount > 0:
        still = _noise(size, cell, seed, stretch, angle, time, octaves)
        level, ramp = _level(still, mask > 0, amount, softness)
        noise = _noise(size, cell, seed, stretch, angle, time, octaves, moved) if any(moved) else still
        mask = mask * (1 - _darkness(noise, level, ramp))
    return seen_through(aperture, mask, "dust")


def scratches(
    aperture: Aperture,
    size: int,
    count: int,
    length: float,
    width: float,
    seed: int,
    bend: float = 0.05,
    opacity: float = 1.0,
    shift: tuple[float, float] | None = None,
) -> Aperture:
    """See an aperture through scratched glass.

    Parameters
    ----------
    aperture : Aperture
        Outlines or a raster.
    size : int
        Pixels on each side of the result.
    count : int
        How many scratches lie on the aperture's square; one more leaves the others where they are.
    length, width : float
        Of the longest and broadest, metres; each scratch takes between half and all of both.
    seed : int
        The same gives the same scratches on every machine.
    bend : float
        Largest rise of a scratch's arc over half its length: 0 straight, 1 a half circle.
    opacity : float
        Amplitude that the darkest scratch takes away, 0 to 1; each takes between half and all of it.
    shift : tuple of float, optional
        (x, y) by which the glass is moved, metres. The glass is endless then: each square beside the
        aperture's own has as many scratches of its own, and those that reach over are seen.

    Returns
    -------
    Aperture
        A raster on the aperture's width, with its wavefront; each pixel loses by the exact area that a
        scratch covers.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range, no light is left, or a wavefront would be resampled.
    """
    refuse.at_least("size", size, 1)
    refuse.at_least("count", count, 0)
    refuse.at_least("seed", seed, 0)
    refuse.between("width", refuse.positive("width", width), 0, refuse.positive("length", length) / 4)
    refuse.between("bend", bend, 0, 1)
    refuse.between("opacity", opacity, 0, 1)
    mask = rasterize(aperture, size).astype(np.float64)
    pixel = aperture.width / size
    for chances, corner in _squares(count, seed, aperture.width, length, shift):
        for chance in chances:
            ring = _scratch(chance, aperture.width, length, width, bend)
            points = (chords(ring, CHORD_TOLERANCE * pixel) + corner) / pixel + size / 2
            darken(mask, points, opacity * (1 + chance[6]) / 2)
    return seen_through(aperture, mask, "scratches")


def _squares(
    count: int, seed: int, square: float, length: float, shift: tuple[float, float] | None
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Return the chances of scratches on each square of glass that can be seen, and where it lies."""
    shape = (count, SCRATCH_CHANCES)
    if shift is None:
        yield uniform(seed, count * SCRATCH_CHANCES).reshape(shape), np.zeros(2)
        return
    moved = refuse.all_finite("shift", refuse.shape_of("shift", shift, (2,)))
    refuse.between("shift", float(np.abs(moved).max()), 0, FARTHEST * square)
    # A scratch reaches half its length beyond its square, an arc's rise less.
    reach = square + length
    first = np.ceil((-moved - reach) / square).astype(int)
    last = np.floor((-moved + reach) / square).astype(int)
    for row in range(first[1], last[1] + 1):
        for column in range(first[0], last[0] + 1):
            # Seeds are not negative: 0, 1, -1, 2, -2 are numbered 0, 1, 2, 3, 4.
            place = [2 * n - 1 if n > 0 else -2 * n for n in (column, row)]
            own = seed if not any(place) else (seed, *place)
            chances = uniform(own, count * SCRATCH_CHANCES).reshape(shape)
            yield chances, moved + square * np.array([column, row], dtype=np.float64)


def _pixels(shift: tuple[float, float], pixel: float) -> tuple[float, float]:
    """Return a shift in pixels."""
    x, y = refuse.all_finite("shift", refuse.shape_of("shift", shift, (2,)))
    return float(x) / pixel, float(y) / pixel


def _noise(
    size: int,
    cell: float,
    seed: int,
    stretch: float,
    angle: float,
    time: float,
    octaves: int,
    shift: tuple[float, float] = (0.0, 0.0),
) -> NDArray[np.float64]:
    """Return noise on the pixels' centres; cell and shift in pixels."""
    drawn = bits(seed, TABLE)
    table = np.argsort(drawn, kind="stable").astype(np.int64)
    # The lattice's planes have less noise on them, so each octave starts off them, elsewhere.
    starts = uniform(seed, TABLE + 3 * octaves)[TABLE:].reshape(octaves, 3)
    x, y = (np.arange(size) + 0.5 - size / 2 - moved for moved in shift)
    cosine, sine = math.cos(angle), math.sin(angle)
    # Rows count downward, angles turn counter-clockwise as seen.
    rows = np.stack([-y * sine / (cell * stretch), y * cosine / cell], axis=1)
    columns = np.stack([x * cosine / (cell * stretch), x * sine / cell], axis=1)
    depths = time + TABLE * starts[:, 2]
    return _kernels_noise.fractal_noise(rows, columns, depths, TABLE * starts[:, :2].copy(), table)


def _level(
    noise: NDArray[np.float64], lit: NDArray[np.bool_], amount: float, softness: float
) -> tuple[float, float]:
    """Return the level that leaves the amount of lit pixels above it, and how far above it all is dark."""
    return float(np.quantile(noise[lit], 1 - amount)), softness * float(noise[lit].std())


def _darkness(noise: NDArray[np.float64], level: float, ramp: float) -> NDArray[np.float64]:
    """Return how dark dust makes each pixel."""
    above = noise - level
    if ramp == 0:
        return np.asarray(above >= 0, dtype=np.float64)
    share = np.clip(above / ramp, 0, 1)
    return np.asarray(share * share * (3 - 2 * share))


def _scratch(chance: NDArray[np.float64], square: float, length: float, width: float, bend: float) -> Outline:
    """Return a lens between two arcs that share their ends."""
    centre = (chance[:2] - 0.5) * square
    direction = math.pi * chance[2]
    half = length * (1 + chance[3]) / 4 * np.array([math.cos(direction), math.sin(direction)])
    # An arc's rise is its bulge times half the chord, so these two lie the width apart.
    middle = bend * (2 * chance[5] - 1)
    spread = width * (1 + chance[4]) / (length * (1 + chance[3]))
    bulges = np.array([middle + spread, spread - middle])
    return Outline(np.stack([centre - half, centre + half]), bulges)
