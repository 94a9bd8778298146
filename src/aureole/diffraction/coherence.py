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

import numpy as np
from numpy.typing import NDArray

from aureole import light, refuse
from aureole.diffraction import _kernels_coherence
from aureole.records import Aperture, Grid, Spectrum

MOST_VERTICES = 24
WAVELENGTHS = 401
# Tables reach so many fringes at so many steps a fringe; beyond, Γ is below a thousandth.
REACH = 48
STEPS = 24
HEIGHTS = 1536
NEAR_FRINGES, NEAR_PIXELS = 0.5, 10.0


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
        True for outlines of few straight edges in light that is not made of lines.
    """
    if aperture.mask is not None or spectrum.kind != "power":
        return False
    straight = all(not np.any(ring.bulges) for ring in aperture.outlines)
    return straight and sum(len(ring.vertices) for ring in aperture.outlines) <= MOST_VERTICES


def coherent_power(
    aperture: Aperture,
    grid: Grid,
    reference_wavelength: float,
    spectrum: Spectrum,
    pixel: tuple[float, float],
) -> NDArray[np.float32]:
    """Return the sum over wavelengths of ρ² |F(ρq)|², averaged over pixels.

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
            f"method 'coherence' needs outlines of at most {MOST_VERTICES} straight edges and light that is "
            "not made of lines; use method 'scaled'."
        )
    unit = aperture.width
    vertices, following, weights = _edges(aperture)
    wavelengths, white = light.quadrature(spectrum, WAVELENGTHS)
    ratios = reference_wavelength / wavelengths
    size = np.array([pixel[1], pixel[0]]) * unit
    pairs = _pair_tables(vertices, size, ratios, white)
    edges = vertices[following] - vertices
    own, shared = _edge_tables(edges, size, ratios, white)
    # Within so many fringes or pixels of its streak an edge is summed with each other one by one.
    limits = np.maximum(NEAR_FRINGES, NEAR_PIXELS * np.abs(edges) @ size)
    v, u = (axis * unit for axis in grid.axes())
    out = np.zeros((*grid.shape, 3), dtype=np.float32)
    total = (white / ratios[:, None] ** 2).sum(axis=0)
    _kernels_coherence.add_pairs(
        u, v, vertices, following, weights, limits, pairs, own, shared, total, STEPS, out
    )
    # F is in units of the width squared, and |F|² in its fourth power.
    return out * np.float32(unit**4)


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


def _pair_tables(
    vertices: NDArray[np.float64],
    pixel: NDArray[np.float64],
    ratios: NDArray[np.float64],
    white: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Tabulate Γ for each pair of vertices, shape (V, V, T, 3)."""
    count = len(vertices)
    difference = vertices[:, None] - vertices[None]
    pixelled = np.sinc(difference[..., None, 0] * pixel[0] * ratios) * np.sinc(
        difference[..., None, 1] * pixel[1] * ratios
    )
    cosine = np.cos(2 * np.pi * np.outer(_places(), ratios))
    weighted = pixelled[..., None] * (white / ratios[:, None] ** 2)
    flat = np.moveaxis(weighted, 2, 0).reshape(len(ratios), -1)
    table = (cosine @ flat).reshape(-1, count, count, 3)
    return np.ascontiguousarray(np.moveaxis(table, 0, 2), dtype=np.float32)


def _edge_tables(
    edges: NDArray[np.float64],
    pixel: NDArray[np.float64],
    ratios: NDArray[np.float64],
    white: NDArray[np.float64],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Tabulate A and B for each edge, shape (V, T, 3).

    A(x) = ∫ cos(2πxy) W_A(y) dy and B(x) = ∫ sin(2πxy) W_B(y) dy over 0 < y < ρ, with
    W_A = 8π² Σ w (ρ − y) / ρ² and W_B = 2π Σ w / ρ² over the ρ above y; the pixel is a factor of y.
    """
    step = float(ratios.max()) / HEIGHTS
    y = (np.arange(HEIGHTS) + 0.5) * step
    above = np.clip((ratios[None] - y[:, None]) / step + 0.5, 0, 1)
    to_own = 8 * np.pi**2 * (np.maximum(ratios[None] - y[:, None], 0) / ratios**2) @ white
    to_shared = 2 * np.pi * (above / ratios**2) @ white
    pixelled = np.sinc(y[:, None] * edges[:, 0] * pixel[0]) * np.sinc(y[:, None] * edges[:, 1] * pixel[1])
    phase = 2 * np.pi * np.outer(_places(), y)
    tables = []
    for wave, weight in ((np.cos(phase), to_own), (np.sin(phase), to_shared)):
        flat = (pixelled[:, :, None] * weight[:, None] * step).reshape(HEIGHTS, -1)
        table = (wave @ flat).reshape(-1, len(edges), 3)
        tables.append(np.ascontiguousarray(np.moveaxis(table, 0, 1), dtype=np.float32))
    return tables[0], tables[1]


def _places() -> NDArray[np.float64]:
    """Return the abscissas of the tables, one step before zero for the cubic's sake."""
    return np.arange(-1, REACH * STEPS + 2) / STEPS
