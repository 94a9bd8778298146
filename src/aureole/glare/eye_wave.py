"""The wave behind an eye's pupil: its power over frequency, ready to be integrated over any pixels.

The power of a raster amplitude is computed on the lattice of frequencies 1 / width, and on a finer one about
the axis, where the Airy disc is narrower than that lattice can tell. Both become tables of integrals
(`_kernels_eye`), so that the energy of a pixel at a wavelength is a few look-ups, and every part of the
power falls into exactly one pixel.

A real amplitude has one pattern for all wavelengths, wider or narrower: a direction has sin θ = λ f.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import diffraction, refuse
from aureole.aperture.bands import in_bands
from aureole.records import Aperture, Grid

# The pattern fades over log frequency between these parts of half a cycle per pixel.
FADE_START, FADE_END = 0.6, 0.96
# About the axis the lattice is this much finer, out to a frequency in cycles per metre (0.05° at 575 nm).
FINER, CORE = 7, 1520.0
# Pixels of fewer cells than this get a finer lattice farther out, too, at least by a factor,
FEWEST_CELLS, COARSEST_FINER = 2.0, 3
# of at most so many samples a side; with a wavefront it holds both halves of the plane, many times.
MOST_FINE, MOST_FINE_COMPLEX = 3000, 800
# A coarser raster does where frequencies stay below this part of half a cycle of its pixels.
LOW_FREQUENCIES, MOST_JOINED = 0.12, 16


@dataclass(frozen=True, eq=False)
class Level:
    """A part of the power over frequency, as a table of integrals.

    Parameters
    ----------
    table : ndarray of float64, shape (rows + 1, columns + 1)
        Integral of the power up to each corner of the lattice's cells, as parts of the whole energy.
    origin : tuple of float
        Where the axis lies in the table, (y, x).
    spacing : float
        Of the lattice, cycles per metre.
    is_half : bool
        Whether the table begins with the column of cells about x = 0, since P(−f) = P(f).
    is_core : bool
        Whether it is the part about the axis.
    """

    table: NDArray[np.float64]
    origin: tuple[float, float]
    spacing: float
    is_half: bool = True
    is_core: bool = False

    @property
    def energy(self) -> float:
        """Its part of the energy, of both halves of the plane."""
        whole = float(self.table[-1, -1])
        return 2 * whole - float(self.table[-1, 1]) if self.is_half else whole


@dataclass(frozen=True, eq=False)
class Wave:
    """The power behind an amplitude.

    Parameters
    ----------
    levels : tuple of Level
        Parts that add up.
    fade : tuple of float
        Frequencies in cycles per metre between which the pattern fades away.
    """

    levels: tuple[Level, ...]
    fade: tuple[float, float]

    @property
    def energy(self) -> float:
        """The part of the energy that the levels hold."""
        return sum(level.energy for level in self.levels)

    @property
    def core_energy(self) -> float:
        """The part of the energy about the axis."""
        return sum(level.energy for level in self.levels if level.is_core)


@dataclass(frozen=True)
class View:
    """What of the plane of frequencies is looked at.

    Parameters
    ----------
    farthest : float
        Largest frequency, cycles per metre.
    finest : float
        Size of the smallest pixel, cycles per metre.
    fades : bool
        Whether the pattern fades before the raster's last frequency, where another takes over.
    """

    farthest: float = math.inf
    finest: float = math.inf
    fades: bool = True


def wave_of(opening: Aperture, energy: float, view: View, wavelength: float | None = None) -> Wave:
    """Transform what an opening lets through.

    Parameters
    ----------
    opening : Aperture
        A raster of n × n pixels, n even, each the mean over itself. Without a wavefront P(−f) = P(f), and
        levels hold half of the plane.
    energy : float
        ∬ amplitude² of what the pixels are the means of, square metres.
    view : View
        What of the pattern will be looked at.
    wavelength : float, optional
        Metres; a wavefront needs it.

    Returns
    -------
    Wave
        The power as parts of `energy`.

    Raises
    ------
    refuse.Refusal
        Where the size is odd, or the wavefront too steep for the pixels.
    """
    assert opening.mask is not None
    size, width = len(opening.mask), opening.width
    if size % 2:
        raise refuse.Refusal(f"'size' must be even, got {size}.")
    pixel, spacing = width / size, 1 / width
    nyquist = 0.5 / pixel
    fade = (FADE_START * nyquist, FADE_END * nyquist) if view.fades else (nyquist, nyquist)
    # The whole energy of a pattern that fades is needed, whatever is looked at.
    last = size // 2 - 1
    reach = last if view.fades else min(math.ceil(min(view.farthest, nyquist) * width) + 1, last)
    inner = min(math.ceil(CORE * width), reach)
    most = MOST_FINE if opening.wavefront is None else MOST_FINE_COMPLEX
    cells = view.finest * width
    near = _Lattice.of(opening, inner, _core_finer(cells, inner, most), wavelength)
    levels = [near.level(energy, 0.0, fade, is_core=True)]
    middle = inner
    if cells < FEWEST_CELLS:
        wanted = min(math.ceil(view.farthest * width) + 1, reach)
        finer, middle = _finer(cells, inner, wanted, most)
        if middle > inner:
            between = _Lattice.of(opening, middle, finer, wavelength)
            levels.append(between.level(energy, (inner + 0.5) * spacing, fade))
    if reach > middle:
        outer = _Lattice.of(opening, reach, 1, wavelength)
        levels.append(outer.level(energy, (middle + 0.5) * spacing, fade))
    return Wave(tuple(levels), fade)


def fade_share(frequencies: NDArray[np.float64], fade: tuple[float, float]) -> NDArray[np.float64]:
    """Return the part of the pattern that is left at frequencies where it fades.

    Parameters
    ----------
    frequencies : ndarray of float64
        Cycles per metre, above 0.
    fade : tuple of float
        Frequencies between which it falls from 1 to 0.

    Returns
    -------
    ndarray of float64
        0 to 1, of the frequencies' shape.
    """
    start, end = fade
    if end <= start:
        return np.asarray(frequencies < end, dtype=np.float64)
    t = np.clip(np.log(end / frequencies) / math.log(end / start), 0, 1)
    return np.asarray(t * t * (3 - 2 * t))


def _core_finer(cells: float, inner: int, most: int) -> int:
    """Return how much finer the lattice is about the axis, where a pixel holds so many cells."""
    finer = 4 * math.ceil(min(1 / cells, most)) + 1
    # Odd, so that whole cells of the one tile the same square as those of the other.
    return max(FINER, min(finer, 2 * (most // (4 * inner + 2)) - 1))


def _finer(cells: float, inner: int, wanted: int, most: int) -> tuple[int, int]:
    """Return how much finer the lattice is farther out, and how many cells of the other it replaces."""
    finer = 2 * math.ceil(min(FEWEST_CELLS / cells, most)) + 1
    while finer > COARSEST_FINER and (2 * wanted + 1) * finer > most:
        finer -= 2
    return finer, max(inner, min(wanted, (most // finer - 1) // 2))


@dataclass(frozen=True, eq=False)
class _Lattice:
    """Power (rows, columns) at frequencies y (rows,), x (columns,), of a raster of pixels of a size."""

    power: NDArray[np.float32]
    y: NDArray[np.float64]
    x: NDArray[np.float64]
    spacing: float
    pixel: float
    is_half: bool

    @classmethod
    def of(cls, opening: Aperture, cells: int, finer: int, wavelength: float | None) -> "_Lattice":
        """Transform a raster out to so many cells of 1 / width from the axis, each divided."""
        count, spacing = ((2 * cells + 1) * finer) // 2, 1 / (finer * opening.width)
        is_half = opening.wavefront is None
        if is_half:
            opening = _joined(opening, count * spacing)
            shape, middle = (2 * count + 1, count + 1), (count + 1) // 2 * spacing
            grid = Grid(shape, (spacing, spacing), (0.0, middle))
        else:
            grid = Grid((2 * count + 1, 2 * count + 1), (spacing, spacing))
        method = "fft" if finer == 1 else "chirpz"
        power = diffraction.far_power(opening, grid, method, wavelength=wavelength)
        assert opening.mask is not None
        return cls(power, *grid.axes(), spacing, opening.width / len(opening.mask), is_half)

    def level(self, energy: float, hole: float, fade: tuple[float, float], is_core: bool = False) -> Level:
        """Add up the power outside a square hole and within the fade."""
        from aureole.glare import _kernels_eye  # compiled code: loaded when first used

        table = np.empty((len(self.y) + 1, len(self.x) + 1))
        # The power has the blur of the raster's pixels twice: from their means, and from their squares.
        gain_y, gain_x = (
            self.spacing / math.sqrt(energy) / np.sinc(axis * self.pixel) ** 4 for axis in (self.y, self.x)
        )
        table[0] = 0
        arguments = self.power, self.y, self.x, gain_y, gain_x, hole, *fade, table[1:]
        in_bands(lambda low, high: _kernels_eye.add_along_rows(low, high, *arguments), len(self.y))
        np.cumsum(table, axis=0, out=table)
        half_x = 0.5 if self.is_half else len(self.x) / 2
        return Level(table, (len(self.y) / 2, half_x), self.spacing, self.is_half, is_core)


def _joined(opening: Aperture, farthest: float) -> Aperture:
    """Return a raster whose pixels are the means of several, where only low frequencies are wanted."""
    assert opening.mask is not None
    size, times = len(opening.mask), 1
    while times < MOST_JOINED and size % (2 * times) == 0 and _is_low(farthest, opening, size // (2 * times)):
        times *= 2
    if times == 1:
        return opening
    joined = opening.mask.reshape(size // times, times, size // times, times).mean(axis=(1, 3))
    return Aperture(opening.width, mask=joined)


def _is_low(farthest: float, opening: Aperture, size: int) -> bool:
    return farthest < LOW_FREQUENCIES / 2 * size / opening.width
