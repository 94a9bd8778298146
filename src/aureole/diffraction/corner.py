"""The corner function: what the end of a straight edge does to a wave, by Fresnel's approximation.

With lengths in units of √(λz / 2), an edge at the signed distance h from a place, seen from a point s along
it on, sends there

    G(h, s) = 1 / (2π) ∫ exp(iπ(h² + τ²) / 2) h / (h² + τ²) dτ, from s to infinity,

the generalised Fresnel integral of P. C. Clemmow and T. B. A. Senior (Proc. Camb. Phil. Soc. 49, 1953). A
straight-edged opening's field is its winding number less G(h, s₀) − G(h, s₁), summed over its edges.

With ρ² = h² + s², G = exp(iπρ² / 2) g, and g turns with no phase. For h, s ≥ 0

    G(h, s) = arctan(h / s) / (2π) + ih / 2 ∫ exp(iπt²h² / 2) (E∞ − E(ts)) dt, t from 0 to 1,
    g(h, s) = h / (2π) Σ (−1)^k m_k ρ^(−2k−2), m_k = ∫ exp(iπ(τ² − s²) / 2) (τ² − s²)^k dτ from s on,
    g(h, s) + g(s, h) = −i / 2 w(h) w(s), w = m_0,

the last because two edges that meet at a right angle are a product of two Fresnel integrals. E = C + iS.
Integration by parts gives m_{k+1} = i / π ((2k + 1 + iπs²) m_k + 2ks² m_{k−1}), and s in place of the last
term where k = 0.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

from aureole import refuse
from aureole.diffraction._kernels_corner import NEAR, STRETCH

# From this ρ on twelve terms of the series are below 1e-14; within it so many nodes reach 1e-13.
SERIES_FROM, TERMS, NODES = 6.0, 12, 64
# Farther ends send less than 2e-10.
FARTHEST = 1e9
# Nodes of the fit along s and along (h / s)², and its largest terms that are left out.
FIT = (32, 16)
LEFT_OUT = {"fine": 1e-10, "coarse": 1e-8}


def corner_integral(h: ArrayLike, s: ArrayLike) -> NDArray[np.complex128]:
    """Return the corner function G(h, s), to 1e-10 for all real numbers.

    Parameters
    ----------
    h : array_like
        Signed distance from the edge's line, in units of √(λz / 2).
    s : array_like
        Place along the line, counted from the foot of the perpendicular, at which the edge starts; same
        unit; broadcast with h.

    Returns
    -------
    ndarray of complex128
        Odd in h; on the edge itself, where h = 0, the mean of both sides, which is 0.

    Raises
    ------
    refuse.Refusal
        Where a value is NaN.
    """
    distance, start = np.broadcast_arrays(np.asarray(h, dtype=np.float64), np.asarray(s, dtype=np.float64))
    bad = np.count_nonzero(np.isnan(distance) | np.isnan(start))
    if bad:
        raise refuse.Refusal(f"'h' and 's' must hold numbers, got {bad} that are NaN.")
    size, along = np.abs(distance.ravel()), np.abs(start.ravel())
    reach = np.hypot(size, along)
    wave = np.zeros(size.shape, dtype=np.complex128)
    near, far = reach < SERIES_FROM, (reach >= SERIES_FROM) & (reach < FARTHEST)
    wave[near] = _by_angle(size[near], along[near])
    wave[far] = _by_series(size[far], along[far])
    # From behind the foot on, the edge is the whole line less what is missing of it.
    wave = np.where(start.ravel() < 0, half_plane_wave(size) - wave, wave)
    return np.asarray((np.sign(distance.ravel()) * wave).reshape(distance.shape))


def half_plane_wave(h: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return (1 − i) / 2 (E∞ − E(h)), the wave that a whole straight edge sends to the distance h >= 0.

    Parameters
    ----------
    h : ndarray
        In units of √(λz / 2).

    Returns
    -------
    ndarray of complex128
        1/2 on the edge.
    """
    far = np.minimum(h, FARTHEST)
    turns = 0.25 * far * far
    return np.asarray(0.5 * _tail_function(far) * (1 - 1j) * np.exp(2j * np.pi * (turns - np.rint(turns))))


def _tail_function(s: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return w(s) = (E∞ − E(s)) exp(−iπs² / 2), s >= 0, a complex error function."""
    return np.asarray((0.5 + 0.5j) * special.wofz((0.5 + 0.5j) * np.sqrt(np.pi) * s))


def _by_angle(h: NDArray[np.float64], s: NDArray[np.float64]) -> NDArray[np.complex128]:
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    total = np.zeros(h.shape, dtype=np.complex128)
    for t, weight in zip((nodes + 1) / 2, weights / 2, strict=True):
        sine, cosine = special.fresnel(t * s)
        total += weight * np.exp(0.5j * np.pi * (t * h) ** 2) * (0.5 + 0.5j - cosine - 1j * sine)
    return np.asarray(np.arctan2(h, s) / (2 * np.pi) + 0.5j * h * total)


def _by_series(h: NDArray[np.float64], s: NDArray[np.float64]) -> NDArray[np.complex128]:
    square, inverse = s * s, 1 / (h * h + s * s)
    before, moment = np.zeros_like(s, dtype=np.complex128), _tail_function(s)
    factor, last = inverse, s.astype(np.complex128)
    total = factor * moment
    for k in range(TERMS):
        before, moment = moment, 1j / np.pi * ((2 * k + 1 + 1j * np.pi * square) * moment + last)
        factor = -factor * inverse
        last = 2 * (k + 1) * square * before
        total += factor * moment
    turns = 0.25 * (h * h + s * s)
    return np.asarray(h / (2 * np.pi) * total * np.exp(2j * np.pi * (turns - np.rint(turns))))


@lru_cache(maxsize=2)
def corner_table(kind: str = "fine") -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return what the compiled loops read of g near a corner, where no series serves.

    For h <= s <= NEAR, g s / h is a polynomial of x = A / (1 + STRETCH s) + B and of y = 2 (h / s)² − 1, both
    from −1 to 1.

    Parameters
    ----------
    kind : str
        "fine", to about 1e-9; "coarse", to about 3e-8.

    Returns
    -------
    coefficients : ndarray of float64, shape (2, J, K)
        Real and imaginary parts of the factors of y^j x^k. Read only.
    orders : ndarray of int64, shape (J,)
        How many of each row's factors are not zero. Read only.
    """
    chebyshev = np.polynomial.chebyshev
    x, y = (np.cos(np.pi * (np.arange(count) + 0.5) / count) for count in FIT)
    first = 1 / (1 + STRETCH * NEAR)
    s = (1 / (first + 0.5 * (x + 1) * (1 - first)) - 1) / STRETCH
    ratio = np.sqrt(0.5 * (y + 1))[:, None]
    values = _by_angle(ratio * s, np.broadcast_to(s, (len(ratio), len(s)))) / ratio
    values *= np.exp(-0.5j * np.pi * (1 + ratio**2) * s**2)
    along_x, along_y = chebyshev.chebvander(x, FIT[0] - 1), chebyshev.chebvander(y, FIT[1] - 1)
    terms = np.linalg.solve(along_y, values) @ np.linalg.inv(along_x).T
    terms[np.abs(terms) < LEFT_OUT[kind]] = 0
    rows, columns = (np.flatnonzero(terms.any(axis=axis)).max() + 1 for axis in (1, 0))
    powers = np.zeros((rows, columns), dtype=np.complex128)
    by_y = [chebyshev.cheb2poly(np.eye(rows)[j]) for j in range(rows)]
    for j, row in enumerate(terms[:rows]):
        of_x = chebyshev.cheb2poly(row[:columns])
        powers[: len(by_y[j])] += by_y[j][:, None] * np.pad(of_x, (0, columns - len(of_x)))
    orders = np.array([1 + max(np.flatnonzero(row), default=-1) for row in powers], dtype=np.int64)
    table = np.stack([powers.real, powers.imag])
    table.setflags(write=False)
    orders.setflags(write=False)
    return table, orders
