"""A night by the water, made by code: the picture that the demonstration adds its glare to.

Values are luminances in candela per square metre, as a photographer's meter would find them: a
hundredth in the sky, tens in the windows, some hundred on the low moon, a hundred thousand and more
in the lamps. So the picture's range is what real glare meets.

The scene is described in units of the picture's height, x to the right and y downward, for a picture
of 16 : 9 (other shapes see more or less at the sides), and every edge is drawn by the share of the
pixel that it covers: another size shows the same scene.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.picture._canvas import PIXEL, Canvas, Reals, tint, turbulence
from aureole.picture._far_shore import HORIZON, bridge, city, hills
from aureole.records import Picture

MOON = (0.655, 0.405, 0.0115)  # x, y, radius: half a degree through a 50 mm lens on 36 mm


@dataclass(frozen=True)
class Lamp:
    """A round light.

    Parameters
    ----------
    x, y : float
        Its centre, in picture heights.
    radius : float
        In pixels of a picture 1080 rows high.
    luminance : float
        Candela per square metre.
    colour : str
        A key of `COLOURS`.
    foot : float
        Where its reflection on the water begins, in picture heights.
    """

    x: float
    y: float
    radius: float
    luminance: float
    colour: str
    foot: float = HORIZON


# The quay runs from a point on the horizon towards the right; at "nearness" s it is 1.6 m below the eye,
# which is 0.4 s of the picture's height. Its lamps stand 5 m high, equally far from each other.
QUAY = (0.86, 1.12)  # where it vanishes, and how far right it comes at nearness 1
EYE = 0.4  # picture heights at nearness 1, for 1.6 m
POST = 0.85  # from the horizon up to a lamp at nearness 1
HOUSES = 3.1  # how far right the houses come at nearness 1
WALL = 0.24  # from the quay's edge down to the water at nearness 1
LAMP_RADIUS = 0.044  # metres, as they look
NEARNESS = tuple(1 / (2.05 + 1.45 * i) for i in range(8))
QUAY_COLOURS = ("warm", "sodium", "sodium", "mercury", "sodium", "sodium", "warm", "sodium")

LAMPS = (
    *(
        Lamp(QUAY[0] + QUAY[1] * s, HORIZON - POST * s, 12 * s, 1.4e4, colour, HORIZON + (EYE + WALL) * s)
        for s, colour in zip(NEARNESS, QUAY_COLOURS, strict=True)
    ),
    Lamp(0.118, 0.462, 1.8, 8e4, "cool"),  # lighthouse
    Lamp(0.214, 0.578, 1.2, 2.5e4, "green"),  # end of the breakwater
    Lamp(0.405, 0.668, 1.2, 2.5e4, "red", 0.678),  # buoy
    Lamp(0.52, 0.372, 1.1, 1.3e4, "red"),  # towers of the bridge
    Lamp(0.80, 0.372, 1.1, 1.3e4, "red"),
)
DECK = tuple(Lamp(0.435 + 0.035 * i, 0.566, 0.55, 0.9e4, "white") for i in range(13))


def lamps() -> tuple[Lamp, ...]:
    """Name the lamps of the scene.

    Returns
    -------
    tuple of Lamp
        The quay's from near to far, the sea marks, the bridge's.
    """
    return LAMPS + DECK


def night_scene(shape: tuple[int, int] = (1080, 1920), seed: int = 1) -> Picture:
    """Make a linear HDR picture of a harbour at night.

    Parameters
    ----------
    shape : tuple of int
        Number of (rows, columns).
    seed : int
        For stars, clouds, windows and ripples; the lamps stay where they are.

    Returns
    -------
    Picture
        Linear Rec.709 in candela per square metre, no values below zero.
    """
    rows, columns = (refuse.at_least("shape", length, 1) for length in shape)
    generator = np.random.default_rng(refuse.at_least("seed", seed, 0))
    canvas = Canvas.blank(rows, columns)
    _sky(canvas, generator)
    _stars(canvas, generator)
    hills(canvas, generator)
    city(canvas, generator)
    bridge(canvas)
    ripples = _Ripples.made(canvas, generator)
    _water(canvas, ripples)
    _glitter(canvas, ripples)
    _breakwater(canvas, generator)
    _quay(canvas, generator)
    _houses(canvas, generator)
    _posts(canvas)
    _moon(canvas, generator)
    _light_lamps(canvas)
    return Picture(np.ascontiguousarray(canvas.pixels), "rec709", {"description": "a harbour at night"})


def _sky(canvas: Canvas, generator: np.random.Generator) -> None:
    """Deep blue above, the town's and the moon's glow below, a few thin clouds that catch it."""
    rows = canvas.rows(0, HORIZON + 0.02)
    x, y = canvas.x[None, :], canvas.y[rows, None]
    height = np.maximum(HORIZON - y, 0)
    blue = 0.0045 + 0.055 * np.exp(-height / 0.16)
    town = 0.085 * np.exp(-height / 0.06) * np.exp(-(((x - 0.36) / 0.50) ** 2))
    halo = 0.09 / (1 + ((x - MOON[0]) ** 2 + (y - MOON[1]) ** 2) / 0.045**2) ** 1.2
    cloud = turbulence(x * 2.2, (y + 0.09 * x) * 13, generator)
    veil = np.clip((cloud - 0.12) / 0.9, 0, 1) ** 1.5 * np.exp(-(((y - 0.36) / 0.16) ** 2))
    light = blue[..., None] * np.array((0.42, 0.86, 2.3)) + town[..., None] * np.array((2.0, 0.78, 0.38))
    light = light + halo[..., None] * np.array((1.15, 0.98, 0.80))
    lit = 0.030 * np.array((0.9, 0.95, 1.1)) + 1.2 * halo[..., None] + 0.6 * town[..., None]
    canvas.pixels[rows] = light + veil[..., None] * lit


def _stars(canvas: Canvas, generator: np.random.Generator) -> None:
    """Sprinkle faint stars."""
    for _ in range(420):
        x, y, faint, warm = generator.random(4)
        flux = 0.03 / (0.02 + faint) ** 1.1 * (1 - y) * PIXEL**2
        colour = np.array((0.8 + 0.5 * warm, 1.0, 1.35 - 0.6 * warm))
        canvas.splat(x * 2.4 - 0.3, y * 0.5, 0.6 * PIXEL, flux * colour)


def _moon(canvas: Canvas, generator: np.random.Generator) -> None:
    """Hang the moon low, warm and with its seas, where nothing stands before it."""
    x, y, radius = MOON
    rows, columns = canvas.rows(y - radius, y + radius), canvas.columns(x - radius, x + radius)
    share = canvas.disc(rows, columns, x, y, radius)
    seas = turbulence(canvas.x[None, columns] * 170, canvas.y[rows, None] * 170, generator, 3)
    bright = 520 * (1 - 0.35 * np.clip(seas + 0.15, 0, 1))
    canvas.cover((rows, columns), share, bright[..., None] * np.array((1.22, 0.97, 0.65)))


@dataclass(frozen=True, eq=False)
class _Ripples:
    """The water's waves: rows that they fill, depth below the horizon, a smooth height, a steep one."""

    rows: slice
    depth: Reals
    swell: Reals
    chop: Reals

    @classmethod
    def made(cls, canvas: Canvas, generator: np.random.Generator) -> "_Ripples":
        rows = canvas.rows(HORIZON + canvas.pixel / 2, 2.0)
        depth = canvas.y[rows, None] - HORIZON
        u = (canvas.x[None, :] - 0.8) * 6.0 / (depth + 0.025)
        v = 32 * np.log(depth + 0.025) + np.zeros_like(u)
        layers = [turbulence(u * k, v * k, generator, 2) for k in (1.0, 2.3, 4.1)]
        return cls(rows, depth, layers[0], (layers[0] + layers[1] + layers[2]) / 2)


def _water(canvas: Canvas, ripples: _Ripples) -> None:
    """Mirror what stands above the water, shaken and stretched by the waves, over its own dark blue."""
    above = canvas.rows(0, HORIZON)
    world = np.minimum(canvas.pixels[above], np.float32(8))  # brighter things glitter instead
    shake = 0.002 + 0.12 * ripples.depth
    total = np.zeros_like(canvas.pixels[ripples.rows])
    for k, stretch in enumerate((-0.8, 0.0, 0.8)):
        y = HORIZON - ripples.depth - shake * (ripples.chop * 0.9 + stretch)
        x = canvas.x[None, :] + 0.05 * shake * ripples.swell * (-1) ** k
        total += _seen(world, canvas, x, np.minimum(y, 2 * HORIZON - y))
    share = 0.25 + 0.5 * np.exp(-ripples.depth / 0.12) + 0.10 * ripples.swell
    deep = np.array((0.0020, 0.0042, 0.0085))
    canvas.pixels[ripples.rows] = np.clip(share, 0.05, 1)[..., None] * total / 3 + deep


def _seen(world: NDArray[np.float32], canvas: Canvas, x: Reals, y: Reals) -> NDArray[np.float32]:
    """Look up colours between pixels."""
    column = np.clip((x - canvas.x[0]) / canvas.pixel, 0, max(world.shape[1] - 1.001, 0))
    row = np.clip((y - canvas.y[0]) / canvas.pixel, 0, max(len(world) - 1.001, 0))
    i, j = row.astype(np.int64), column.astype(np.int64)
    s, t = (column - j)[..., None].astype(np.float32), (row - i)[..., None].astype(np.float32)
    i1, j1 = np.minimum(i + 1, len(world) - 1), np.minimum(j + 1, world.shape[1] - 1)
    upper = world[i, j] * (1 - s) + world[i, j1] * s
    lower = world[i1, j] * (1 - s) + world[i1, j1] * s
    return np.asarray(upper * (1 - t) + lower * t)


def _glitter(canvas: Canvas, ripples: _Ripples) -> None:
    """Draw the columns of light that lamps and moon throw over the waves, sparkle by sparkle."""
    moon = Lamp(MOON[0], MOON[1], MOON[2] / PIXEL, 520, "warm")
    for lamp in (*lamps(), moon):
        reach = 0.010 + 0.8 * (lamp.foot - lamp.y)
        rows = canvas.rows(max(lamp.foot, HORIZON), min(lamp.foot + 4 * reach, 2.0))
        rows = slice(max(rows.start, ripples.rows.start), rows.stop)
        here = slice(rows.start - ripples.rows.start, rows.stop - ripples.rows.start)
        columns = canvas.columns(lamp.x - 0.12, lamp.x + 0.12)
        depth, chop = ripples.depth[here], ripples.chop[here, columns]
        width = 0.0022 + 0.022 * depth
        across = (canvas.x[None, columns] - lamp.x + 0.6 * width * ripples.swell[here, columns]) / width
        from_mirror = (depth - (2 * lamp.foot - lamp.y - HORIZON)) / reach
        spread = (
            np.exp(-(across**2) / 2 - from_mirror**2 / 2) * _overlap_from(canvas, rows, lamp.foot)[:, None]
        )
        facets = np.clip(0.15 + 1.1 * chop, 0, None) ** 2
        flux = np.pi * (lamp.radius * PIXEL) ** 2 * tint(lamp.colour, lamp.luminance)
        area = 2 * np.pi * width * reach
        canvas.pixels[rows, columns] += (0.55 * spread * facets / area)[..., None] * flux


def _overlap_from(canvas: Canvas, rows: slice, top: float) -> Reals:
    return np.clip((canvas.y[rows] - top) / canvas.pixel + 0.5, 0, 1)


def _breakwater(canvas: Canvas, generator: np.random.Generator) -> None:
    """Rocks on the left with a lighthouse, and a buoy."""
    stone = (0.0028, 0.0030, 0.0040)
    rows = canvas.rows(HORIZON - 0.03, HORIZON + 0.05)
    bumps = 0.0028 * turbulence(canvas.x * 70, np.zeros_like(canvas.x), generator)
    fall = 0.018 * np.clip((canvas.x - 0.12) / 0.1, 0, 1)
    end = 10 * np.clip(canvas.x - 0.218, 0, None)
    upper = canvas.below(HORIZON - 0.014 + fall * 0.6 + bumps + end, rows, slice(None))
    lower = canvas.below(HORIZON + 0.016 - fall * 0.5 + bumps - end, rows, slice(None))
    canvas.cover((rows, slice(None)), np.clip(upper - lower, 0, 1), stone)
    canvas.rectangle(0.114, 0.468, 0.122, 0.59, (0.016, 0.016, 0.018))
    canvas.rectangle(0.1125, 0.466, 0.1235, 0.470, stone)
    canvas.rectangle(0.1145, 0.4545, 0.1215, 0.4575, stone)
    canvas.rectangle(0.2132, 0.580, 0.2148, 0.60, stone)
    canvas.rectangle(0.4042, 0.670, 0.4058, 0.680, stone)
    canvas.rectangle(0.4015, 0.677, 0.4085, 0.681, stone)


def _houses(canvas: Canvas, generator: np.random.Generator) -> None:
    """A row of low houses behind the promenade, lit by its lamps, some windows warm."""
    columns = canvas.columns(QUAY[0], 9.0)
    s = np.maximum((canvas.x[columns] - QUAY[0]) / HOUSES, 1e-4)
    walls = np.arange(2.7, 30.0, 1.7)
    heights = generator.uniform(0.62, 1.05, len(walls) + 1)
    shades = generator.uniform(0.5, 1.2, len(walls) + 1)
    which = np.searchsorted(walls, 1 / s)
    light = np.full((len(s), 3), 0.004)
    for lamp, near in zip(LAMPS, NEARNESS, strict=False):
        power = tint(lamp.colour, lamp.luminance * np.pi * LAMP_RADIUS**2)
        light += (0.005 / np.pi) * (8 / (64 + (4 / s - 4 / near) ** 2) ** 1.5)[:, None] * power
    rows = canvas.rows(0.0, 2.0)
    top = np.full_like(canvas.x, 9.0)
    top[columns] = HORIZON - heights[which] * s
    ground = HORIZON + EYE * (canvas.x - QUAY[0]) / HOUSES
    share = canvas.below(top, rows, columns) - canvas.below(ground, rows, columns)
    canvas.cover((rows, columns), share, light * shades[which, None])
    for wall, height in zip(walls[1:], heights[1:], strict=False):
        for far in (0.25, 0.7, 1.15):
            for sill in (0.12, 0.50):
                chance, bright, kind = generator.random(3)
                middle = 1 / (wall - 1.7 + far + 0.13)
                if chance < 0.45 and sill + 0.3 < height + 0.02:
                    left, right = (QUAY[0] + HOUSES / (wall - 1.7 + far + d) for d in (0.26, 0.0))
                    colour = tint("sodium" if kind < 0.4 else "warm", 0.3 * 6.0**bright)
                    for pane in (0.0, 0.13):
                        bottom = HORIZON - (sill + pane) * middle
                        canvas.rectangle(left, bottom - 0.12 * middle, right, bottom, tuple(colour))


def _quay(canvas: Canvas, generator: np.random.Generator) -> None:
    """A wet promenade on the right: pools of light, stones, a wall down to the water, lamp posts."""
    rows, columns = canvas.rows(HORIZON, 2.0), canvas.columns(QUAY[0], 9.0)
    x, y = canvas.x[columns], canvas.y[rows, None]
    edge, foot = (HORIZON + (x - QUAY[0]) * (height / QUAY[1]) for height in (EYE, EYE + WALL))
    depth = np.maximum(y - HORIZON, 1e-4)
    ahead = 1.6 / depth  # metres: 1.6 m of height are 0.4 at nearness 1, which is 4 m away
    across = (x[None, :] - QUAY[0]) * ahead - QUAY[1] * 4
    grain = turbulence(across * 2.3, ahead * 1.1, generator, 3) * np.minimum(1, 30 * depth**1.5)
    stones = np.zeros((*grain.shape, 3)) + np.array((0.0035, 0.0042, 0.0065))
    for lamp, s in zip(LAMPS, NEARNESS, strict=False):
        power = tint(lamp.colour, lamp.luminance * np.pi * LAMP_RADIUS**2)
        pool = 125 / (25 + (ahead - 4 / s) ** 2 + across**2) ** 2.5
        shine = ((x[None, :] - lamp.x) / (0.006 + 0.04 * s)) ** 2 + ((depth - EYE * s) / (0.6 * s)) ** 2
        stones += ((0.025 / np.pi) * pool + 0.004 * np.exp(-shine))[..., None] * power
    stones *= np.clip(1 + 0.8 * grain, 0.1, None)[..., None]
    canvas.cover((rows, columns), np.clip((foot - y) / canvas.pixel + 0.5, 0, 1), (0.0026, 0.0030, 0.0046))
    canvas.cover((rows, columns), np.clip((edge - y) / canvas.pixel + 0.5, 0, 1), stones)
    curb = np.clip((edge + 0.012 * (x - QUAY[0]) - y) / canvas.pixel + 0.5, 0, 1)
    curb -= np.clip((edge - 0.004 * (x - QUAY[0]) - y) / canvas.pixel + 0.5, 0, 1)
    canvas.cover((rows, columns), curb, (0.012, 0.012, 0.014))


def _posts(canvas: Canvas) -> None:
    iron = (0.0022, 0.0022, 0.0028)
    for s in NEARNESS[::-1]:
        x, top = QUAY[0] + QUAY[1] * s, HORIZON - POST * s
        canvas.rectangle(x - 0.006 * s, top, x + 0.006 * s, HORIZON + EYE * s, iron)
        canvas.rectangle(x - 0.014 * s, HORIZON + (EYE - 0.10) * s, x + 0.014 * s, HORIZON + EYE * s, iron)
        canvas.rectangle(x - 0.034 * s, top - 0.026 * s, x + 0.034 * s, top - 0.013 * s, iron)


def _light_lamps(canvas: Canvas) -> None:
    """Draw the lamps themselves, over all else."""
    for lamp in lamps():
        radius = lamp.radius * PIXEL
        rows = canvas.rows(lamp.y - radius, lamp.y + radius)
        columns = canvas.columns(lamp.x - radius, lamp.x + radius)
        share = canvas.disc(rows, columns, lamp.x, lamp.y, radius)
        canvas.cover((rows, columns), share, tint(lamp.colour, lamp.luminance))
