"""Few fields that stand for many: the coherent modes of openings that differ little.

With weights w_s that add up to W, the mean opening μ = Σ w_s m_s / W and the deviations d_s = m_s − μ,

    Σ w_s |F m_s|² = W |F μ|² + Σ w_s |F d_s|² = W |F μ|² + Σ_j |F u_j|²,

where the u_j are the deviations' principal components: orthogonal sums of them, so that F takes powers over
unchanged. In optics they are the coherent modes of partly coherent light (Wolf 1982), in lithography a sum of
coherent systems (Cobb 1998). Openings past an edge that moves by little have few strong ones.

The weak ones are not left out, since the far streaks are theirs: sums of the weak parts with random signs
have their power in the mean (Hutchinson 1990). For two such sums the mean absolute difference from the truth
is at most the power that they stand for, at every frequency; and their energy is set to be exactly its own.

E. Wolf, "New theory of partial coherence in the space-frequency domain. Part I", JOSA 72, 343 (1982).
N. Cobb, "Fast optical and process proximity correction algorithms", thesis, Berkeley (1998).
M. F. Hutchinson, "A stochastic estimator of the trace of the influence matrix", 1990.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole.diffraction.rows import in_threads

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

# Rows that are compared at once: of all masks they lie in a processor's cache.
BAND = 16
# Sums with random signs that stand for the weak modes.
SUMS = 2
# Share of the light that is float32's rounding.
ROUNDING = 1e-7


@dataclass(frozen=True, eq=False)
class Modes:
    """Signed masks whose powers add up to those of many masks.

    Parameters
    ----------
    patterns : ndarray of float32, shape (M, n, n)
        The mean, the strong modes, and the sums that stand for the weak ones.
    estimated : float
        Share of the light that those sums stand for: the mean absolute difference of the summed powers
        from the truth is at most this part of them.
    """

    patterns: F32
    estimated: float


@dataclass(frozen=True, eq=False)
class _Band:
    """Some rows of all masks: their mean, where they differ, and by how much they differ there.

    Parameters
    ----------
    mean : ndarray of float32, shape (rows, n)
        Weighed mean of the masks.
    places : ndarray of int64, shape (P,)
        Flat indices within the band of pixels that are not the same in all masks.
    deviations : ndarray of float32, shape (K, P)
        From the mean.
    products : ndarray of float32, shape (K, K)
        Of each mask's deviations with each other's.
    """

    mean: F32
    places: NDArray[np.int64]
    deviations: F32
    products: F32


def coherent_modes(masks: Sequence[F32], weights: F64, tolerance: float, seed: int = 0) -> Modes:
    """Return few signed masks whose powers add up to the weighed sum of all masks' powers.

    Parameters
    ----------
    masks : sequence of ndarray of float32, shape (n, n)
        K masks, all of one size; they may be negative.
    weights : ndarray of float64, shape (K,)
        Of their powers, > 0.
    tolerance : float
        Share of the light that random sums may stand for. With 0 all modes are taken.
    seed : int
        Of the random signs.

    Returns
    -------
    Modes
        The masks themselves, times the roots of their weights, where modes would be no fewer.
    """
    count, bands, roots = len(masks), _bands(masks, weights), np.sqrt(weights)
    gram = np.zeros((count, count))
    for band in bands:
        gram += band.products
    gram *= roots[:, None] * roots
    strengths, vectors = _components(gram)
    mean = np.concatenate([band.mean for band in bands])
    energy = float(weights.sum() * np.einsum("ij,ij->", mean, mean, dtype=np.float64) + strengths.sum())
    # What is left beyond the first j modes.
    left = np.append(np.cumsum(strengths[::-1])[::-1], 0)
    left[left <= ROUNDING * energy] = 0
    strong = int(np.argmax(left <= tolerance * energy))
    if strong + 1 + SUMS >= count:
        return Modes(np.stack([np.float32(r) * m for r, m in zip(roots, masks, strict=True)]), 0.0)
    shares = vectors[:, :strong].T
    estimated = float(left[strong]) / energy if energy > 0 else 0.0
    if estimated > 0:
        shares = np.concatenate([shares, _random_shares(gram, vectors[:, :strong], left[strong], seed)])
    patterns = _combined(bands, (shares * roots).astype(np.float32), np.float32(weights.sum() ** 0.5) * mean)
    return Modes(patterns, estimated)


def _bands(masks: Sequence[F32], weights: F64) -> list[_Band]:
    """Compare all masks, band by band."""
    size = len(masks[0])
    bits = [mask.view(np.int32) for mask in masks]
    shares = (weights / weights.sum()).astype(np.float32)
    found: dict[int, _Band] = {}

    def look(top: int) -> None:
        rows = np.s_[top : top + BAND]
        differ = np.zeros(bits[0][rows].shape, dtype=bool)
        here = np.empty_like(differ)
        for each in bits[1:]:
            np.not_equal(each[rows], bits[0][rows], out=here)
            np.logical_or(differ, here, out=differ)
        places = np.flatnonzero(differ)
        values = np.empty((len(masks), len(places)), dtype=np.float32)
        for mask, row in zip(masks, values, strict=True):
            np.take(mask[rows].reshape(-1), places, out=row, mode="clip")
        mean = masks[0][rows].copy()
        middle = shares @ values
        mean.reshape(-1)[places] = middle
        values -= middle
        found[top] = _Band(mean, places, values, values @ values.T)

    in_threads(look, range(0, size, BAND))
    return [found[top] for top in sorted(found)]


def _components(gram: F64) -> tuple[F64, F64]:
    """Return the strengths of principal components, the strongest first, and their columns of shares."""
    found: list[tuple[F64, F64]] = []
    in_threads(lambda products: found.append(np.linalg.eigh(products)), [gram])
    strengths, vectors = found[0]
    return np.maximum(strengths[::-1], 0), vectors[:, ::-1]


def _random_shares(gram: F64, strong: F64, energy: float, seed: int) -> F64:
    """Return sums of the deviations with random signs, less what the strong modes hold of them.

    Parameters
    ----------
    gram : ndarray, shape (K, K)
        Products of the deviations.
    strong : ndarray, shape (K, J)
        The strong modes.
    energy : float
        Of the sums together.
    seed : int
        Of the signs.

    Returns
    -------
    ndarray, shape (SUMS, K)
        Shares of each deviation.
    """
    signs = np.random.default_rng(seed).choice([-1.0, 1.0], (SUMS, len(gram)))
    signs -= (signs @ strong) @ strong.T
    held = float(np.einsum("rs,st,rt->", signs, gram, signs))
    return np.asarray(signs * np.sqrt(energy / held))


def _combined(bands: Sequence[_Band], shares: F32, mean: F32) -> F32:
    """Return a mean, and the sums of deviations with given shares (M, K)."""
    size = len(mean)
    out = np.zeros((len(shares) + 1, size * size), dtype=np.float32)
    out[0] = mean.reshape(-1)

    def add(number: int) -> None:
        band = bands[number]
        places = band.places + number * BAND * size
        for line, values in zip(out[1:], shares @ band.deviations, strict=True):
            line[places] = values

    in_threads(add, range(len(bands)))
    return out.reshape(-1, size, size)
