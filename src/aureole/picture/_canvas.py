"""A canvas in picture heights, drawn on by the share of each pixel that a shape covers, and smooth noise."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.float32]
Reals = NDArray[np.float64]
Colour = tuple[float, float, float]

PIXEL = 1 / 1080  # sizes of lamps are given in pixels of a picture 1080 rows high
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
COLOURS: dict[str, Colour] = {
    "sodium": (1.0, 0.42, 0.06),
    "mercury": (0.70, 1.0, 0.92),
    "warm": (1.0, 0.68, 0.36),
    "white": (1.0, 0.90, 0.80),
    "cool": (0.80, 0.92, 1.0),
    "red": (1.0, 0.03, 0.015),
    "green": (0.03, 1.0, 0.28),
    "magenta": (1.0, 0.06, 0.55),
    "cyan": (0.04, 0.75, 1.0),
}


@dataclass(frozen=True, eq=False)
class Canvas:
    """A picture with the positions of its pixels, in picture heights."""

    pixels: Pixels
    x: Reals
    y: Reals
    pixel: float

    @classmethod
    def blank(cls, rows: int, columns: int) -> "Canvas":
        x = (np.arange(columns) + 0.5) / rows + (16 / 9 - columns / rows) / 2
        return cls(np.zeros((rows, columns, 3), np.float32), x, (np.arange(rows) + 0.5) / rows, 1 / rows)

    def rows(self, top: float, bottom: float) -> slice:
        """Pixels that touch a span of y."""
        return _touched(self.y, self.pixel, top, bottom)

    def columns(self, left: float, right: float) -> slice:
        """Pixels that touch a span of x."""
        return _touched(self.x, self.pixel, left, right)

    def rectangle(self, left: float, top: float, right: float, bottom: float, colour: Colour) -> None:
        """Cover a rectangle, however small, by its share of each pixel."""
        rows, columns = self.rows(top, bottom), self.columns(left, right)
        share = np.outer(
            _overlap(self.y[rows], self.pixel, top, bottom),
            _overlap(self.x[columns], self.pixel, left, right),
        )
        self.cover((rows, columns), share, colour)

    def cover(self, where: tuple[slice, slice], share: Reals, colour: Colour | Reals) -> None:
        """Mix a colour into a part of the picture."""
        part = self.pixels[where]
        part += (share[..., None] * (np.asarray(colour) - part)).astype(np.float32)

    def disc(self, rows: slice, columns: slice, x: float, y: float, radius: float) -> Reals:
        """The share of each pixel inside a circle, by 8 × 8 points in each."""
        offsets = (np.arange(8) - 3.5) / 8 * self.pixel
        across = (self.x[columns, None] + offsets - x) ** 2
        down = (self.y[rows, None] + offsets - y) ** 2
        inside = down[:, None, :, None] + across[None, :, None, :] < radius**2
        return np.asarray(inside.mean(axis=(2, 3)))

    def splat(self, x: float, y: float, radius: float, flux: Reals) -> None:
        """Add a small square of light whose energy does not depend on the pixels' size."""
        rows, columns = self.rows(y - radius, y + radius), self.columns(x - radius, x + radius)
        share = np.outer(
            _overlap(self.y[rows], self.pixel, y - radius, y + radius),
            _overlap(self.x[columns], self.pixel, x - radius, x + radius),
        )
        self.pixels[rows, columns] += (share[..., None] * (flux / (4 * radius**2))).astype(np.float32)

    def below(self, top: Reals, rows: slice, columns: slice) -> Reals:
        """The share of each pixel below an outline y = top(x)."""
        return np.clip((self.y[rows, None] - top[..., None, columns]) / self.pixel + 0.5, 0, 1)


def _touched(axis: Reals, pixel: float, low: float, high: float) -> slice:
    first, last = np.searchsorted(axis, (low - pixel / 2, high + pixel / 2))
    return slice(int(first), int(last))


def _overlap(centres: Reals, pixel: float, low: float, high: float) -> Reals:
    """The share of each pixel that lies between two bounds."""
    inside = np.minimum(centres + pixel / 2, high) - np.maximum(centres - pixel / 2, low)
    return np.clip(inside / pixel, 0, 1)


def _noise(u: Reals, v: Reals, generator: np.random.Generator) -> Reals:
    """Random values −1..1 at whole (u, v), smooth in between."""
    lattice = generator.uniform(-1, 1, 128 * 128)
    column, row = np.floor(u), np.floor(v)
    s, t = u - column, v - row
    s, t = s * s * (3 - 2 * s), t * t * (3 - 2 * t)
    i, j = row.astype(np.int64), column.astype(np.int64)
    above, below = (i & 127) << 7, ((i + 1) & 127) << 7
    left, right = j & 127, (j + 1) & 127
    upper = lattice.take(above + left) * (1 - s) + lattice.take(above + right) * s
    lower = lattice.take(below + left) * (1 - s) + lattice.take(below + right) * s
    return np.asarray(upper * (1 - t) + lower * t)


def turbulence(u: Reals, v: Reals, generator: np.random.Generator, octaves: int = 4) -> Reals:
    """Noise of finer and finer grain."""
    total = np.zeros(np.broadcast(u, v).shape)
    for octave in range(octaves):
        total += _noise(u * 2.03**octave + 7 * octave, v * 2.03**octave, generator) * 0.55**octave
    return total


def tint(name: str, luminance: float = 1.0) -> Reals:
    """Return a named colour in linear Rec.709, scaled to a luminance."""
    colour = np.asarray(COLOURS[name])
    return np.asarray(colour * (luminance / (colour @ LUMINANCE)))
