"""Lines that repeat in one direction: slits, grooves and blazed facets, and where their light goes.

What `count` equal periods send towards h, the sum of the directions to the light and to the eye along the
lines' normal, is a density over h (Agu and Hill 2002; Toisoul and Ghosh 2017, Eq. 16)

    D(h) = (d / λ) |c(q)|² sin²(N π q) / (N sin²(π q)),    q = d h / λ,

with c(q) the period's own Fourier transform over d. Whole q are the orders. Over all h it integrates to the
mean of |p|² over a period: 1 for a surface that only shifts the phase, the share of the slits for slits.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicHermiteSpline

from aureole import refuse

PROFILES = ("slits", "grooves", "blazed")
# Steps of the running integral over one fringe of the outermost periods.
STEPS_A_FRINGE = 16
# A cell below this share of an order's width is one parabola.
SMALL_CELL = 0.25
# Gauss's three points from -1 to 1.
NODES, SHARES = np.polynomial.legendre.leggauss(3)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Lines:
    """Equal lines side by side.

    Parameters
    ----------
    period : float
        From line to line, metres.
    width : float
        Of a slit or groove, metres; the period for blazed facets.
    count : int
        Periods that are lit in phase.
    profile : {"slits", "grooves", "blazed"}
        Strips that reflect with nothing between them; rectangular grooves in a mirror; facets that rise along
        +t and fall back at once.
    depth : float
        Of grooves, or rise of a facet, metres; 0 for slits.
    """

    period: float
    width: float
    count: int = 21
    profile: Literal["slits", "grooves", "blazed"] = "slits"
    depth: float = 0.0

    def density(self, h: ArrayLike, wavelength: float, cosines: float = 2.0) -> Array:
        """Return the share of the light towards h, per unit of h.

        Parameters
        ----------
        h : array_like
            Sum of the directions' components along the lines' normal.
        wavelength : float
            Metres.
        cosines : float
            cos θ_i + cos θ_o, which the phase of a depth grows with.

        Returns
        -------
        ndarray of float64
            Of the shape of h.
        """
        orders = np.asarray(h, dtype=np.float64) * (self.period / wavelength)
        return self._by_order(orders, self._waves(wavelength, cosines)) * (self.period / wavelength)

    def mean(
        self,
        low: ArrayLike,
        high: ArrayLike,
        wavelength: float,
        cosines: float = 2.0,
        zero_order: bool = True,
    ) -> Array:
        """Return the mean density over intervals of h, so that sharp orders lose nothing between samples.

        Parameters
        ----------
        low, high : array_like
            The intervals' ends, low < high.
        wavelength : float
            Metres.
        cosines : float
            cos θ_i + cos θ_o.
        zero_order : bool
            False leaves out the half order on both sides of h = 0.

        Returns
        -------
        ndarray of float64
            Of the intervals' shape.
        """
        scale, waves = self.period / wavelength, self._waves(wavelength, cosines)
        first, last = np.asarray(low, dtype=np.float64) * scale, np.asarray(high, dtype=np.float64) * scale
        span = last - first
        if not zero_order:
            below, above = np.minimum(last, -0.5), np.maximum(first, 0.5)
            shares = self._energy(first, np.maximum(below, first), waves)
            shares += self._energy(np.minimum(above, last), last, waves)
        else:
            shares = self._energy(first, last, waves)
        return shares / span * scale

    def efficiency(self, order: ArrayLike, wavelength: float, cosines: float = 2.0) -> Array:
        """Return the share of the light in whole orders, were the lines without end.

        Parameters
        ----------
        order : array_like of int
            Numbers of the orders.
        wavelength : float
            Metres.
        cosines : float
            cos θ_i + cos θ_o.

        Returns
        -------
        ndarray of float64
            |c_m|².
        """
        return self._power(np.asarray(order, dtype=np.float64), self._waves(wavelength, cosines))

    def _waves(self, wavelength: float, cosines: float) -> float:
        """Return by how many waves the depth delays."""
        return 0.0 if self.profile == "slits" else cosines * self.depth / wavelength

    def _power(self, orders: Array, waves: float) -> Array:
        """Return |c|² of one period at whole and broken orders."""
        share = self.width / self.period
        if self.profile == "slits":
            return np.asarray((share * np.sinc(share * orders)) ** 2)
        if self.profile == "blazed":
            return np.asarray(np.sinc(orders - waves) ** 2)
        turn = np.exp(2j * np.pi * waves) - 1.0
        return np.asarray(np.abs(np.sinc(orders) + turn * share * np.sinc(share * orders)) ** 2)

    def _by_order(self, orders: Array, waves: float) -> Array:
        """Return the density per order."""
        return self._power(orders, waves) * _comb(self.count, orders)

    def _energy(self, first: Array, last: Array, waves: float) -> Array:
        """Return the light between orders first and last."""
        span = last - first
        small = span * self.count < SMALL_CELL
        reach = int(np.ceil(max(np.abs(first).max(), np.abs(last).max(), 1.0)))
        if self.profile == "slits":
            # The same for all wavelengths, so that a few of them serve.
            reach = 2 ** (reach - 1).bit_length()
        running = _running(self, waves, reach)
        energy = np.asarray(running(last) - running(first))
        # Differences of a running integral lose their digits in small cells: Gauss's three points do not.
        middle, half = 0.5 * (first + last)[small], 0.5 * span[small]
        energy[small] = half * sum(
            weight * self._by_order(middle + half * node, waves)
            for node, weight in zip(NODES, SHARES, strict=True)
        )
        return energy


def _comb(count: int, orders: Array) -> Array:
    """Return what `count` periods make of one: N sin²(N π q) / (N² sin²(π q)) about whole q."""
    rest = orders - np.round(orders)
    return np.asarray(count * (np.sinc(count * rest) / np.sinc(rest)) ** 2)


@lru_cache(maxsize=8)
def _running(lines: Lines, waves: float, reach: int) -> CubicHermiteSpline:
    """Integrate the density per order from -reach upward."""
    edges, places, combs = _steps(lines.count, reach)
    at_edges, *inside = (lines._power(place, waves) * comb for place, comb in zip(places, combs, strict=True))
    parts = sum(share * part for share, part in zip(SHARES, inside, strict=True))
    half = 0.5 * (edges[1] - edges[0])
    total = np.concatenate([[0.0], np.cumsum(half * parts)])
    return CubicHermiteSpline(edges, total, at_edges)


@lru_cache(maxsize=16)
def _steps(count: int, reach: int) -> tuple[Array, list[Array], list[Array]]:
    """Return steps from -reach to reach, their edges and Gauss's points, and the comb there."""
    edges = np.linspace(-reach, reach, 2 * reach * STEPS_A_FRINGE * count + 1)
    half = 0.5 * (edges[1] - edges[0])
    places = [edges, *(edges[:-1] + half * (1.0 + node) for node in NODES)]
    return edges, places, [_comb(count, place) for place in places]


def multislit(
    sine: ArrayLike, width: float, spacing: float, count: int, wavelength: float
) -> NDArray[np.float64]:
    """Return the intensity of evenly spaced slits, 1 at its peak (Toisoul and Ghosh 2017, Eq. 16).

    Parameters
    ----------
    sine : array_like
        sin θ at normal incidence; h along the slits' normal otherwise.
    width, spacing : float
        Of a slit and from slit to slit, metres.
    count : int
        Number of slits.
    wavelength : float
        Metres.

    Returns
    -------
    ndarray of float64
        0 to 1, of the shape of `sine`.

    Raises
    ------
    refuse.Refusal
        Where a length is not positive, the count is below 1, or a slit is wider than its spacing.
    """
    lines = checked_lines(Lines(spacing, width, count))
    refuse.positive("wavelength", wavelength)
    peak = count * (width / spacing) ** 2 * spacing / wavelength
    return lines.density(refuse.all_finite("sine", sine), wavelength) / peak


def checked_lines(lines: Lines) -> Lines:
    """Refuse lines that cannot be.

    Parameters
    ----------
    lines : Lines
        Any values.

    Returns
    -------
    Lines
        The same.

    Raises
    ------
    refuse.Refusal
        At the first wrong value.
    """
    refuse.positive("period", lines.period)
    refuse.positive("width", lines.width)
    refuse.at_least("count", lines.count, 1)
    refuse.one_of("profile", lines.profile, PROFILES)
    if lines.width > lines.period:
        raise refuse.Refusal(f"'width' must be at most the period, {lines.period:g} m, got {lines.width:g}.")
    if lines.profile == "slits":
        if lines.depth != 0.0:
            raise refuse.Refusal("'depth' must be 0 for slits; use profile 'grooves' or 'blazed'.")
    else:
        refuse.positive("depth", lines.depth)
    return lines
