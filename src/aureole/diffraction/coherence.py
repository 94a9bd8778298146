"""Starbursts of straight-edged openings over all wavelengths at once, in closed form.

With edges e_j from v_j to v_{j+1}, x_j = q·e_j and κ_j = u e_y − v e_x, the far field is

    F(q) = 1 / (4π² |q|²) Σ_j κ_j E_j,   E_j = (exp(−i2π q·v_j) − exp(−i2π q·v_{j+1})) / x_j.

At the wavelength λ_r / ρ it is F(ρq), and ρ only enters the phases and a factor. So the sum over all
wavelengths is a sum over pairs of edges of a tabulated function of one number, the spectral coherence
Γ(s) = Σ w(λ) ρ⁻² cos(2π ρ s), which dies away within some tens of fringes: far out only each edge with
itself and its neighbours is left. Averaging over a pixel multiplies the cosine of a difference d of
vertices by sinc(ρ p_x d_x) sinc(ρ p_y d_y). An edge with itself gives A(x) = 2 (Γ(0) − Γ(x)) / x², and
with its neighbour B(x) = (Γ(0) − Γ(x)) / x, both smooth across the streak at x = 0 and averaged over the
pixel under their integrals. The rest of the sum is taken as constant over a pixel, which holds away
from the origin; there `starburst` has its core.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from aureole import light, refuse
from aureole.diffraction import _kernels_coherence
from aureole.diffraction._kernels_streaks import Corners, Tables
from aureole.diffraction.rows import multiply
from aureole.records import Aperture, Grid, Spectrum

MOST_VERTICES = 24
WAVELENGTHS, SHORT_REACH = 201, 64
# Γ counts as zero from where it stays below this share of Γ(0), and tables reach no farther than so many
# fringes beyond the blur of pixel and light.
NEGLIGIBLE, FARTHEST = 1e-3, 160
# Table entries a fringe, where the reach is looked for, where cubics join them, and where straight lines.
SURVEY_STEPS, STEPS, FINE_STEPS = 6, 48, 192
# No pair's phases hold more entries than so many rows of the plane.
MOST_ENTRIES = 8
LEAST_HEIGHTS, HEIGHTS_A_FRINGE = 384, 8
NEAR_FRINGES, NEAR_PIXELS = 0.5, 10.0
# Edges within this part of the width of one line lie on it.
SAME = 1e-9


def serves(aperture: Aperture, spectrum: Spectrum) -> bool:
    """Return whether an opening and a light can be summed in closed form.

    Parameters
    ----------
    aperture : Aperture
        Any.
    spectrum : Spectrum
        Any.

    Returns
    -------
    bool
        True for outlines of few straight edges in light that is not made of lines, where no two rings have
        a border in common: light from edges that cancel would be left over.
    """
    if aperture.mask is not None or spectrum.kind != "power":
        return False
    straight = all(not np.any(ring.bulges) for ring in aperture.outlines)
    few = sum(len(ring.vertices) for ring in aperture.outlines) <= MOST_VERTICES
    return straight and few and not _shares_borders(aperture)


def coherent_power(
    aperture: Aperture,
    grid: Grid,
    reference_wavelength: float,
    spectrum: Spectrum,
    pixel: tuple[float, float] = (0.0, 0.0),
    light_radius: float = 0.0,
    scale: float = 1.0,
) -> NDArray[np.float32]:
    """Return the sum over wavelengths of ρ² |F(ρq)|², averaged over pixels and the light's disc.

    Parameters
    ----------
    aperture : Aperture
        Outlines of straight edges.
    grid : Grid
        Frequencies at the reference wavelength, cycles per metre.
    reference_wavelength : float
        Metres.
    spectrum : Spectrum
        The light's.
    pixel : tuple of float
        Pixel size (y, x) in cycles per metre at the reference wavelength; 0 for point samples.
    light_radius : float
        Radius of a disc-shaped light, likewise; 0 for a point.
    scale : float
        Factor of everything.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Square of square metres, weighted as `aureole.light.quadrature` weights; not to be trusted
        within a few pixels or fringes of the origin.

    Raises
    ------
    refuse.Refusal
        Where the opening or the light cannot be summed this way.
    """
    if not serves(aperture, spectrum):
        raise refuse.Refusal(
            f"method 'coherence' needs outlines of at most {MOST_VERTICES} straight edges, none of them "
            "twice in one place, and light that is not made of lines; use method 'scaled'."
        )
    unit = aperture.width
    vertices, following, weights = _edges(aperture)
    blur = _Blur(pixel[1] * unit, pixel[0] * unit, light_radius * unit)
    edges = vertices[following] - vertices
    # Within so many fringes or pixels of its streak an edge is averaged over the pixel by itself.
    widths = blur.mean_square(edges)
    limits = np.maximum(NEAR_FRINGES, NEAR_PIXELS * np.sqrt(12 * widths))
    v, u = (axis * unit for axis in grid.axes())
    rows, columns = grid.shape
    mirrored = grid.centre == (0.0, 0.0)
    if mirrored:
        # The power of a real opening is even: rows above the axis, with as many columns on either side.
        v = v[: rows // 2 + 1]
        u = np.asarray(np.arange(-(columns // 2), columns // 2 + 1) * (grid.spacing[1] * unit), np.float64)
    lamp = _lamp(spectrum, reference_wavelength)
    tables = _tables(vertices, edges, blur, lamp, grid.spacing[1] * unit, len(u))
    out = np.empty((rows, columns, 3), dtype=np.float32)
    # F is in units of the width squared, and |F|² in its fourth power.
    corners = Corners(vertices, following, weights, limits, widths)
    _kernels_coherence.fill_power(u, v, corners, tables, scale * unit**4, mirrored, out)
    return out


@dataclass(frozen=True)
class _Blur:
    """What a value is averaged over: a box pixel and the disc of the light, in cycles per width."""

    x: float
    y: float
    radius: float

    def transform(self, difference: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the blur's own Fourier transform at differences (..., 2) of places."""
        x, y = difference[..., 0], difference[..., 1]
        box = np.sinc(x * self.x) * np.sinc(y * self.y)
        if self.radius == 0:
            return np.asarray(box)
        turn = 2 * np.pi * self.radius * np.hypot(x, y)
        safe = np.where(turn < 1e-6, 1.0, turn)
        return np.asarray(box * np.where(turn < 1e-6, 1.0, 2 * special.j1(safe) / safe))

    def mean_square(self, edges: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the mean of (q·e)² over the blur about its centre, for edges (V, 2)."""
        square = edges**2
        box = square @ np.array([self.x**2, self.y**2]) / 12
        return np.asarray(box + self.radius**2 / 4 * square.sum(axis=1))


def _edges(aperture: Aperture) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Return vertices in units of the width, the index of each one's next, and signed weights."""
    vertices, following, weights = [], [], []
    start = 0
    for ring in aperture.outlines:
        points = ring.vertices / aperture.width
        count = len(points)
        turned = np.roll(points, -1, axis=0)
        area = float(np.sum(points[:, 0] * turned[:, 1] - points[:, 1] * turned[:, 0]))
        vertices.append(points)
        following.append(start + (np.arange(count) + 1) % count)
        weights.append(np.full(count, ring.transmittance * np.sign(area)))
        start += count
    return np.concatenate(vertices), np.concatenate(following), np.concatenate(weights)


def _shares_borders(aperture: Aperture) -> bool:
    """Return whether two edges lie on one line and overlap there."""
    vertices, following, _ = _edges(aperture)
    along = vertices[following] - vertices
    lengths = np.hypot(along[:, 0], along[:, 1])
    unit = along / np.maximum(lengths, SAME)[:, None]
    # Of every other edge's ends: how far they are from an edge's line, and where along it.
    apart = vertices[None, :] - vertices[:, None]
    starts = np.einsum("ijk,ik->ij", apart, unit)
    ends = starts + unit @ along.T
    turned = np.stack([-unit[:, 1], unit[:, 0]], axis=1)
    off = np.einsum("ijk,ik->ij", apart, turned)
    on_line = (np.abs(off) < SAME) & (np.abs(off + turned @ along.T) < SAME)
    overlap = np.minimum(np.maximum(starts, ends), lengths[:, None]) - np.maximum(np.minimum(starts, ends), 0)
    np.fill_diagonal(overlap, 0)
    return bool(np.any(on_line & (overlap > SAME)))


@dataclass(frozen=True, eq=False)
class _Lamp:
    """The wavelengths of a light as ratios ρ, their weights, Γ(0), and from where Γ is negligible."""

    ratios: NDArray[np.float64]
    white: NDArray[np.float64]
    total: NDArray[np.float64]
    reach: float


@lru_cache(maxsize=8)
def _lamp(spectrum: Spectrum, reference_wavelength: float) -> _Lamp:
    for count in (WAVELENGTHS, 2 * WAVELENGTHS):
        wavelengths, white = light.quadrature(spectrum, count)
        ratios: NDArray[np.float64] = reference_wavelength / wavelengths
        weights = white / ratios[:, None] ** 2
        total = weights.sum(axis=0)
        places = np.arange(FARTHEST * SURVEY_STEPS) / SURVEY_STEPS
        coherence = np.cos(2 * np.pi * np.outer(places, ratios)) @ weights
        reach = _reach(coherence, total) / SURVEY_STEPS
        # Narrow peaks stay coherent over many fringes, and take more wavelengths.
        if reach < SHORT_REACH:
            break
    return _Lamp(ratios, white, total, reach)


def _reach(coherence: NDArray[Any], total: NDArray[np.float64]) -> int:
    """Return from which entry on a table (T, 3) stays negligible."""
    lives = np.flatnonzero(np.any(np.abs(coherence) > NEGLIGIBLE * total, axis=1))
    return int(lives[-1]) + 1 if lives.size else 0


def _tables(
    vertices: NDArray[np.float64],
    edges: NDArray[np.float64],
    blur: _Blur,
    lamp: _Lamp,
    step: float,
    columns: int,
) -> Tables:
    """Tabulate Γ of each pair of corners, A and B of each edge."""
    length = math.ceil(lamp.reach + 1.5 * math.sqrt(12 * float(blur.mean_square(edges).max())))
    first, second = np.tril_indices(len(vertices), -1)
    differences = vertices[first] - vertices[second]
    blurred = blur.transform(differences[:, None] * lamp.ratios[:, None])
    weights = lamp.white / lamp.ratios[:, None] ** 2
    flat = np.moveaxis(blurred[..., None] * weights, 1, 0).reshape(len(lamp.ratios), -1)
    pairs = _tabulated(_waves(lamp.ratios.tobytes(), length), flat)
    entries = [min(_reach(pair[:, :3], lamp.total), pair.shape[0] - 4) for pair in pairs]
    reaches = np.array(entries) / STEPS
    phases = _phases(pairs, reaches, np.abs(differences[:, 0]) * step, columns)
    own, shared = _edge_tables(edges, blur, lamp, length)
    return Tables(pairs, reaches, *phases, own, shared, lamp.total, STEPS)


def _phases(
    pairs: NDArray[np.float32], reaches: NDArray[np.float64], strides: NDArray[np.float64], columns: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.float32]]:
    """Lay the tables of pairs out in phases of their steps from column to column."""
    # Along a pair that is nearly upright, steps are too small for that, and few look-ups differ.
    served = (strides * MOST_ENTRIES * columns > 2 * reaches) & (reaches > 0)
    safe = np.where(served, strides, 1.0)
    counts = np.where(served, np.ceil(safe * FINE_STEPS), 0).astype(np.int64)
    lengths = np.where(served, np.ceil(2 * reaches / safe) + 2, 0).astype(np.int64)
    sizes = 3 * (counts + 1) * lengths
    starts = np.cumsum(sizes) - sizes
    out = np.empty(int(sizes.sum()), dtype=np.float32)
    _kernels_coherence.lay_out_phases(pairs, reaches, STEPS, strides, counts, lengths, starts, out)
    return counts, lengths, starts, out


def _edge_tables(
    edges: NDArray[np.float64], blur: _Blur, lamp: _Lamp, length: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Tabulate A and B for each edge, shape (V, T, 4).

    A(x) = ∫ cos(2πxy) W_A(y) dy and B(x) = ∫ sin(2πxy) W_B(y) dy over 0 < y < ρ, with
    W_A = 8π² Σ w (ρ − y) / ρ² and W_B = 2π Σ w / ρ² over the ρ above y; the blur is a factor of y.
    The weights are joined by straight lines, whose transform is a sinc².
    """
    # Heights a little beyond the largest ρ, lest every wavelength has waves of its own.
    top = math.ceil(8 * float(lamp.ratios.max())) / 8
    heights = max(LEAST_HEIGHTS, HEIGHTS_A_FRINGE * length)
    step = top / heights
    y = np.arange(heights) * step
    beyond = _above(y, lamp.ratios, lamp.white / lamp.ratios[:, None] ** 2)
    moment = _above(y, lamp.ratios, lamp.white / lamp.ratios[:, None])
    to_own = 8 * np.pi**2 * (moment - y[:, None] * beyond)
    to_shared = 2 * np.pi * beyond
    to_own[0] /= 2
    blurred = blur.transform(y[:, None, None] * edges)
    cosine, sine = _height_waves(top, heights, length)
    tables = []
    for wave, weight in ((cosine, to_own), (sine, to_shared)):
        flat = (blurred[:, :, None] * weight[:, None] * step).reshape(heights, -1)
        tables.append(_tabulated(wave, flat))
    return tables[0], tables[1]


def _above(heights: NDArray[Any], ratios: NDArray[np.float64], density: NDArray[Any]) -> NDArray[np.float64]:
    """Return the sum (Y, 3) of a density (W, 3) over the ρ above each height, as if it were continuous."""
    order = np.argsort(ratios)
    rising, parts = ratios[order], density[order]
    # At its own ρ, half of each part lies above.
    running = np.cumsum(parts[::-1], axis=0)[::-1] - parts / 2
    ends = running[0] + parts[0] / 2
    return np.stack(
        [np.interp(heights, rising, running[:, c], left=ends[c], right=0.0) for c in range(3)], axis=1
    )


def _tabulated(waves: NDArray[np.float32], amounts: NDArray[np.float64]) -> NDArray[np.float32]:
    """Sum waves (T, W) times amounts (W, N × 3): N tables one after the other, each (T, 4)."""
    columns = np.empty((len(waves), amounts.shape[1]), dtype=np.float32)
    multiply([(waves, amounts.astype(np.float32), columns)])
    out = np.zeros((columns.shape[1] // 3, len(columns), 4), dtype=np.float32)
    out[..., :3] = np.moveaxis(columns.reshape(len(columns), -1, 3), 1, 0)
    return out


def _places(length: int) -> NDArray[np.float64]:
    """Return the abscissas of coarse tables, one step before zero and two beyond for the cubic's sake."""
    return np.arange(-1, length * STEPS + 2) / STEPS


@lru_cache(maxsize=8)
def _waves(ratios: bytes, length: int) -> NDArray[np.float32]:
    """Return cos(2πρs) at the places of a table of so many fringes, shape (T, W)."""
    return np.cos(2 * np.pi * np.outer(_places(length), np.frombuffer(ratios))).astype(np.float32)


@lru_cache(maxsize=4)
def _height_waves(top: float, heights: int, length: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return cos(2πxy) and sin(2πxy) at a table's places and heights, with the hats' transform."""
    places, step = _places(length), top / heights
    phase = 2 * np.pi * np.outer(places, np.arange(heights) * step)
    hat = np.sinc(places * step)[:, None] ** 2
    return (np.cos(phase) * hat).astype(np.float32), (np.sin(phase) * hat).astype(np.float32)
