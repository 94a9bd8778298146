"""The CIE 1931 2° observer: from spectrum to XYZ, and the weights of a spectral sum.

Integrals are trapezoids over the union of the observer's nanometres and the spectrum's own samples:
for a spectrum on whole nanometres this is the CIE's sum over its table.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.light.tables import table
from aureole.records import Spectrum


def observer() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the colour-matching functions of the CIE 1931 2° observer (CIE 018:2019).

    Returns
    -------
    wavelengths : ndarray of float64, shape (471,)
        Metres, 360 to 830 nm, every nanometre; read-only.
    functions : ndarray of float64, shape (471, 3)
        x̄, ȳ, z̄; read-only.
    """
    return table("observer_cie_1931_2deg")


def tristimulus(spectrum: Spectrum) -> NDArray[np.float64]:
    """Integrate a spectrum with the observer (CIE 15:2018, Eq. 7.1, without its factor k).

    Parameters
    ----------
    spectrum : Spectrum
        Any spectrum; what lies outside 360 to 830 nm is not seen.

    Returns
    -------
    ndarray of float64, shape (3,)
        X, Y, Z: for kind "power" in the spectrum's unit times metres, for kind "lines" in its unit.
        With watts, 683 times Y is in lumens.
    """
    if spectrum.kind == "lines":
        return np.asarray(spectrum.values @ _responses(spectrum.wavelengths), dtype=np.float64)
    total: NDArray[np.float64] = _own_segments(spectrum)[1].sum(axis=0)
    return total


def white(spectrum: Spectrum) -> NDArray[np.float64]:
    """Return a spectrum's own white: its colour at luminance 1.

    Parameters
    ----------
    spectrum : Spectrum
        Any spectrum with light between 360 and 830 nm.

    Returns
    -------
    ndarray of float64, shape (3,)
        X, Y, Z with Y = 1.

    Raises
    ------
    refuse.Refusal
        Where the observer does not see the spectrum.
    """
    seen = tristimulus(spectrum)
    if not seen[1] > 0:
        raise refuse.Refusal(f"'spectrum' needs light between 360 and 830 nm; '{spectrum.name}' has none.")
    relative: NDArray[np.float64] = seen / seen[1]
    return relative


def chromaticity(xyz: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the chromaticity of colours.

    Parameters
    ----------
    xyz : ndarray, shape (..., 3)
        Tristimulus values whose sum is not zero.

    Returns
    -------
    ndarray of float64, shape (..., 2)
        x = X / (X + Y + Z) and y = Y / (X + Y + Z).
    """
    values = np.asarray(refuse.all_finite("xyz", xyz), dtype=np.float64)
    shares: NDArray[np.float64] = values[..., :2] / values.sum(axis=-1, keepdims=True)
    return shares


def quadrature(
    spectrum: Spectrum, count: int = 60, low: float = 380e-9, high: float = 780e-9
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Choose the wavelengths of a spectral sum and weigh them for X, Y and Z.

    The range is cut into `count` equal cells. Each takes the integral of spectrum × observer over
    itself and stands at its own mean wavelength, so even a few samples keep the white. Light
    beyond the range counts for the outermost cells; cells without light are left out.

    Parameters
    ----------
    spectrum : Spectrum
        Any spectrum with light between 360 and 830 nm. One of kind "lines" gives its own lines.
    count : int
        Number of cells over the range, or over the part of it where the spectrum has light.
    low, high : float
        The range in metres.

    Returns
    -------
    wavelengths : ndarray of float64, shape (W,)
        Metres, rising; W is at most `count`.
    weights : ndarray of float64, shape (W, 3)
        Their sum over W is `white(spectrum)`, whatever the count.
    """
    count = refuse.at_least("count", count, 1)
    low, high = refuse.positive("low", low), refuse.positive("high", high)
    if not low < high:
        raise refuse.Refusal(f"'low' must be less than 'high', got {low:g} and {high:g}.")
    if spectrum.kind == "lines":
        wavelengths, weights = (
            spectrum.wavelengths,
            spectrum.values[:, None] * _responses(spectrum.wavelengths),
        )
    else:
        edges = np.linspace(*lit_range(spectrum, low, high), count + 1)
        wavelengths, weights = _cells(spectrum, edges)
    seen = weights.sum(axis=1) > 0
    return wavelengths[seen], _to_white(weights, spectrum)[seen]


def bands(spectrum: Spectrum, edges: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weigh bands of wavelengths for X, Y and Z.

    Parameters
    ----------
    spectrum : Spectrum
        Of kind "power", with light between 360 and 830 nm.
    edges : ndarray of float64, shape (B + 1,)
        Metres, rising. Light beyond them counts for the outermost bands.

    Returns
    -------
    ndarray of float64, shape (B, 3)
        The integral of spectrum × observer over each band; their sum is `white(spectrum)`.

    Raises
    ------
    refuse.Refusal
        Where the observer does not see the spectrum.
    """
    return _to_white(_cells(spectrum, edges)[1], spectrum)


def lit_range(spectrum: Spectrum, low: float, high: float) -> tuple[float, float]:
    """Narrow a range of wavelengths to where the observer sees light of a spectrum.

    Parameters
    ----------
    spectrum : Spectrum
        Of kind "power", with light between 360 and 830 nm.
    low, high : float
        The range in metres.

    Returns
    -------
    tuple of float
        The range's lit part; all that is lit where the range has no light.

    Raises
    ------
    refuse.Refusal
        Where the observer does not see the spectrum.
    """
    white(spectrum)
    nodes, segments = _own_segments(spectrum)
    lit = np.flatnonzero(segments.any(axis=1))
    first, last = float(nodes[lit[0]]), float(nodes[lit[-1] + 1])
    if max(low, first) < min(high, last):
        return max(low, first), min(high, last)
    return first, last


def _cells(spectrum: Spectrum, edges: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Integrate over cells between edges; return their mean wavelengths (C,) and integrals (C, 3)."""
    count = edges.size - 1
    # The cells' edges become nodes too, so that no segment spans two cells.
    nodes = np.union1d(_nodes(spectrum), edges)
    segments = _segments(spectrum, nodes)
    middles = 0.5 * (nodes[1:] + nodes[:-1])
    cell = np.clip(np.searchsorted(edges, middles) - 1, 0, count - 1)
    weights = np.empty((count, 3))
    for channel in range(3):
        weights[:, channel] = np.bincount(cell, segments[:, channel], count)
    moments = np.bincount(cell, middles * segments.sum(axis=1), count)
    mass = weights.sum(axis=1)
    return np.divide(moments, mass, out=np.zeros(count), where=mass > 0), weights


def _to_white(weights: NDArray[np.float64], spectrum: Spectrum) -> NDArray[np.float64]:
    """Scale weights (W, 3) so that their sum is the light's white."""
    sums = weights.sum(axis=0)
    scaled: NDArray[np.float64] = weights * np.divide(white(spectrum), sums, out=np.zeros(3), where=sums > 0)
    return scaled


@lru_cache(maxsize=8)
def _own_segments(spectrum: Spectrum) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the nodes of a spectrum, (N,), and its integrals between them, (N − 1, 3)."""
    nodes = _nodes(spectrum)
    return nodes, _segments(spectrum, nodes)


def _nodes(spectrum: Spectrum) -> NDArray[np.float64]:
    """Return every wavelength, (N,), where the spectrum or the observer has a corner."""
    table_wavelengths, own = observer()[0], spectrum.wavelengths
    low, high = max(table_wavelengths[0], own[0]), min(table_wavelengths[-1], own[-1])
    both = np.union1d(table_wavelengths, own)
    shared: NDArray[np.float64] = both[(both >= low) & (both <= high)]
    return shared


def _segments(spectrum: Spectrum, nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integrate spectrum × observer between neighbouring nodes (N,) by trapezoids: (N − 1, 3)."""
    density = np.interp(nodes, spectrum.wavelengths, spectrum.values)[:, None] * _responses(nodes)
    areas: NDArray[np.float64] = 0.5 * (density[1:] + density[:-1]) * np.diff(nodes)[:, None]
    return areas


def _responses(wavelengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Interpolate the colour-matching functions at wavelengths (W,): (W, 3), zero out of sight."""
    positions, functions = observer()
    parts = [np.interp(wavelengths, positions, part, left=0.0, right=0.0) for part in functions.T]
    return np.stack(parts, axis=1)
