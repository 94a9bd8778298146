"""Gratings: which way their orders go, their pattern over h, and their look-up table.

h = ω_i + ω_o is the sum of the unit vectors to the light and to the eye, not normalised; h_t and h_b are its
parts along the tangent (across the grating's lines) and the bitangent. An order m of period d stands at
h_t = m λ / d at every incidence, which is the grating equation d (sin θ_i + sin θ_o) = m λ.

Patterns are S with 4π² ∬ S dh_t dh_b = the share of the light that a perfect mirror in the grating's place
would send on, so that f_r = 4π² F² G S (G = 1 at normal incidence).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import erf, ive

from aureole import presets, refuse
from aureole.surface.slits import Lines, checked_lines

DEFAULT_SPREAD = 0.02
INCH = 0.0254
SUB_PIXELS = 3
CLOUD_RADII = 97

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Grating:
    """Lines in one direction, in two, or in all.

    Parameters
    ----------
    along : Lines
        What repeats along the tangent.
    across : Lines, optional
        What repeats along the bitangent; None for lines that run on along it.
    spread : float
        Standard deviation of h_b around lines that run on: how uneven they are. Without unit.
    radial : bool
        Whether lines of all directions are mixed, so that orders are rings.
    name : str
        What to call it in reports.
    """

    along: Lines
    across: Lines | None = None
    spread: float = DEFAULT_SPREAD
    radial: bool = False
    name: str = "grating"

    def pattern(self, h_t: ArrayLike, h_b: ArrayLike, wavelength: float, cosines: float = 2.0) -> Array:
        """Return the pattern S at points of h; sharp orders need `cell_mean`.

        Parameters
        ----------
        h_t, h_b : array_like
            Parts of h along tangent and bitangent; they are broadcast.
        wavelength : float
            Metres.
        cosines : float
            cos θ_i + cos θ_o, which the phase of a depth grows with; 2 at normal incidence.

        Returns
        -------
        ndarray of float64
            1/sr, of the broadcast shape.
        """
        t, b = np.broadcast_arrays(np.asarray(h_t, dtype=float), np.asarray(h_b, dtype=float))
        if self.radial:
            radius = np.hypot(t, b)
            both = self.along.density(radius, wavelength, cosines)
            both = 0.5 * (both + self.along.density(-radius, wavelength, cosines))
            both *= radius > 0.5 * wavelength / self.along.period
            return (both * self.ring(radius) + self._cloud(radius, wavelength, cosines)) / (4.0 * np.pi**2)
        one = self.along.density(t, wavelength, cosines)
        if self.across is None:
            other = np.exp(-0.5 * (b / self.spread) ** 2) / (math.sqrt(2.0 * math.pi) * self.spread)
        else:
            other = self.across.density(b, wavelength, cosines)
        return np.asarray(one * other / (4.0 * np.pi**2))

    def __call__(self, h_t: ArrayLike, h_b: ArrayLike, wavelength: float) -> Array:
        """Return the pattern S near normal incidence; a grating is a formula for `table_from_function`."""
        return self.pattern(h_t, h_b, wavelength)

    def cell_mean(
        self,
        t_cells: ArrayLike,
        b_cells: ArrayLike,
        wavelength: float,
        cosines: float = 2.0,
        zero_order: bool = True,
    ) -> Array:
        """Return the mean of the pattern S over cells of h.

        Exact for lines and crossed lines; for rings it is that of the ring through the cell.

        Parameters
        ----------
        t_cells : array_like, shape (2, C)
            Lower and upper ends of the columns.
        b_cells : array_like, shape (2, R)
            Lower and upper ends of the rows, in any order of rows.
        wavelength : float
            Metres.
        cosines : float
            cos θ_i + cos θ_o.
        zero_order : bool
            False leaves out what is within half an order of h = 0.

        Returns
        -------
        ndarray of float64, shape (R, C)
            1/sr.
        """
        t, b = np.asarray(t_cells, dtype=np.float64), np.asarray(b_cells, dtype=np.float64)
        if self.radial:
            return self._ring_mean(t, b, wavelength, cosines, zero_order)
        total: Array = np.zeros((b.shape[1], t.shape[1]))
        for rows, columns in self.terms(t, b, wavelength, cosines, zero_order):
            total += np.outer(rows, columns)
        return total

    def terms(
        self, t_cells: Array, b_cells: Array, wavelength: float, cosines: float = 2.0, zero_order: bool = True
    ) -> list[tuple[Array, Array]]:
        """Return parts along rows and columns whose outer products add up to the cells' means.

        Parameters
        ----------
        t_cells : ndarray of float64, shape (2, C)
            Lower and upper ends of the columns.
        b_cells : ndarray of float64, shape (2, R)
            Lower and upper ends of the rows.
        wavelength : float
            Metres.
        cosines : float
            cos θ_i + cos θ_o.
        zero_order : bool
            False leaves out what is within half an order of h = 0.

        Returns
        -------
        list of tuple
            (rows (R,), columns (C,)) of each product, in 1/sr. Not for rings.
        """
        scale = 1.0 / (4.0 * np.pi**2)
        along: Array = scale * self.along.mean(t_cells[0], t_cells[1], wavelength, cosines)
        lit = (
            along
            if zero_order
            else scale * self.along.mean(t_cells[0], t_cells[1], wavelength, cosines, False)
        )
        if self.across is None:
            return [(normal_mean(b_cells, self.spread), lit)]
        across = self.across.mean(b_cells[0], b_cells[1], wavelength, cosines)
        if zero_order:
            return [(across, along)]
        # The order (0, 0) is what both directions' zero orders have in common.
        inner: Array = across - self.across.mean(b_cells[0], b_cells[1], wavelength, cosines, False)
        return [(across, along), (-inner, along - lit)]

    def ring(self, radius: Array) -> Array:
        """Return what a mixture of all directions makes of the light at a distance from h = 0.

        The mean over directions of a normal density across the lines: exp(−x) I₀(x) / (√(2π) σ) with
        x = r² / 4σ², which is 1 / (π r) where r is well beyond σ.

        Parameters
        ----------
        radius : ndarray of float64
            Length of h along the surface.

        Returns
        -------
        ndarray of float64
            Per unit of h.
        """
        return np.asarray(
            ive(0, (radius / (2.0 * self.spread)) ** 2) / (math.sqrt(2.0 * math.pi) * self.spread)
        )

    def cloud(self, radius: Array, wavelength: float, cosines: float = 2.0) -> Array:
        """Return the zero order of a mixture of all directions, which is no ring but a cloud about h = 0.

        Parameters
        ----------
        radius : ndarray of float64, shape (R,)
            Length of h along the surface.
        wavelength : float
            Metres.
        cosines : float
            cos θ_i + cos θ_o.

        Returns
        -------
        ndarray of float64, shape (R,)
            The mean over directions of the zero order across the lines times the normal density along them.
        """
        half = 0.5 * wavelength / self.along.period
        finest = min(self.spread, half / self.along.count)
        # Facets only send different light to both sides; a quarter of a turn serves all others.
        turn = np.pi if self.along.profile == "blazed" else 0.5 * np.pi
        count = int(np.clip(4.0 * turn * float(radius.max()) / finest, 64, 4096))
        angles = turn * (np.arange(count) + 0.5) / count
        across, along = np.cos(angles) * radius[:, None], np.sin(angles) * radius[:, None]
        density = np.where(np.abs(across) <= half, self.along.density(across, wavelength, cosines), 0.0)
        spread = np.exp(-0.5 * (along / self.spread) ** 2) / (math.sqrt(2.0 * math.pi) * self.spread)
        return np.asarray((density * spread).mean(axis=1))

    def _cloud(self, radius: Array, wavelength: float, cosines: float) -> Array:
        """Look the cloud up, where there are many places."""
        places = cloud_radii(self, wavelength)
        values = self.cloud(places, wavelength, cosines)
        return np.asarray(np.interp(radius, places, values, right=0.0))

    def _ring_mean(self, t: Array, b: Array, wavelength: float, cosines: float, zero_order: bool) -> Array:
        """Average over the range of distances that a cell spans."""
        radius, low, high = ring_cells(t, b)
        both = self.along.mean(low, high, wavelength, cosines, False)
        both = 0.5 * (both + self.along.mean(-high, -low, wavelength, cosines, False))
        total = both * self.ring(radius)
        if zero_order:
            total += self._cloud(radius, wavelength, cosines)
        return total / (4.0 * np.pi**2)


def cloud_radii(lines: Grating, longest: float) -> Array:
    """Return radii that a cloud is sampled at: to half an order, close together near h = 0.

    Parameters
    ----------
    lines : Grating
        A radial one.
    longest : float
        Wavelength, metres.

    Returns
    -------
    ndarray of float64, shape (R,)
        From 0, rising.
    """
    return np.asarray(0.5 * longest / lines.along.period * np.linspace(0.0, 1.0, CLOUD_RADII) ** 2)


def ring_cells(t_cells: Array, b_cells: Array) -> tuple[Array, Array, Array]:
    """Return how far cells lie from h = 0, and the range of distances that each spans.

    Parameters
    ----------
    t_cells : ndarray of float64, shape (2, C)
        Lower and upper ends of the columns.
    b_cells : ndarray of float64, shape (2, R)
        Lower and upper ends of the rows.

    Returns
    -------
    radius, low, high : ndarray of float64, shape (R, C)
        Of the cell's middle; nearest and farthest along the line from h = 0, low < high.
    """
    middle_t, middle_b = np.abs(t_cells.mean(axis=0))[None, :], np.abs(b_cells.mean(axis=0))[:, None]
    wide, tall = (t_cells[1] - t_cells[0])[None, :], (b_cells[1] - b_cells[0])[:, None]
    radius = np.hypot(middle_t, middle_b)
    off = radius > 0
    reach = (middle_t * wide + middle_b * tall) / np.where(off, radius, 1.0)
    half = 0.5 * np.where(off, reach, np.maximum(wide, tall))
    return radius, np.maximum(radius - half, 0.0), radius + half


def multislit_grating(
    period: float, width: float, count: int = 21, spread: float = DEFAULT_SPREAD, name: str = "multislit"
) -> Grating:
    """Make a grating of slits that run on along the bitangent.

    Parameters
    ----------
    period, width : float
        From slit to slit and of a slit, metres.
    count : int
        Slits that are lit in phase.
    spread : float
        Standard deviation of h_b.
    name : str
        What to call it.

    Returns
    -------
    Grating
        The grating.
    """
    return checked(Grating(Lines(period, width, count), None, spread, name=name))


def groove_grating(
    period: float,
    width: float,
    depth: float,
    count: int = 21,
    spread: float = DEFAULT_SPREAD,
    name: str = "grooves",
) -> Grating:
    """Make a mirror with rectangular grooves.

    Parameters
    ----------
    period, width, depth : float
        From groove to groove, of a groove, and its optical depth (times the index of what fills it), metres.
    count : int
        Grooves that are lit in phase.
    spread : float
        Standard deviation of h_b.
    name : str
        What to call it.

    Returns
    -------
    Grating
        The grating.
    """
    return checked(Grating(Lines(period, width, count, "grooves", depth), None, spread, name=name))


def blazed_grating(
    lines_per_mm: float,
    blaze_wavelength: float,
    count: int = 21,
    spread: float = DEFAULT_SPREAD,
    name: str = "blazed",
) -> Grating:
    """Make a blazed grating: facets tilted so that one wavelength goes back to the light in order 1.

    Parameters
    ----------
    lines_per_mm : float
        Facets in a millimetre.
    blaze_wavelength : float
        Metres, in Littrow mounting.
    count : int
        Facets that are lit in phase.
    spread : float
        Standard deviation of h_b.
    name : str
        What to call it.

    Returns
    -------
    Grating
        Its `along.depth` is the rise of a facet over one period, d tan θ_B.

    Raises
    ------
    refuse.Refusal
        Where no angle sends the wavelength back.
    """
    period = 1e-3 / refuse.positive("lines_per_mm", lines_per_mm)
    rise = period * math.tan(littrow_angle(period, blaze_wavelength))
    return checked(Grating(Lines(period, period, count, "blazed", rise), None, spread, name=name))


def littrow_angle(period: float, wavelength: float, order: int = 1) -> float:
    """Return the incidence at which an order goes back to the light: 2 d sin θ = m λ.

    Parameters
    ----------
    period : float
        Metres.
    wavelength : float
        Metres.
    order : int
        m.

    Returns
    -------
    float
        Radians.

    Raises
    ------
    refuse.Refusal
        Where there is none.
    """
    sine = order * refuse.positive("wavelength", wavelength) / (2.0 * refuse.positive("period", period))
    if not abs(sine) < 1.0:
        raise refuse.Refusal(
            f"'wavelength' must be below {2 * period / max(abs(order), 1):g} m for order {order}, "
            f"got {wavelength:g}."
        )
    return math.asin(sine)


def crossed_grating(along: Lines, across: Lines, name: str = "crossed") -> Grating:
    """Make a grating of lines in two directions: openings in a net.

    Parameters
    ----------
    along, across : Lines
        What repeats along the tangent and along the bitangent.
    name : str
        What to call it.

    Returns
    -------
    Grating
        The grating.
    """
    return checked(Grating(along, across, name=name))


def radial_grating(lines: Lines, spread: float = DEFAULT_SPREAD, name: str = "radial") -> Grating:
    """Make a mixture of lines of all directions, whose orders are rings.

    Parameters
    ----------
    lines : Lines
        What repeats.
    spread : float
        Standard deviation of h along the lines; far below an order.
    name : str
        What to call it.

    Returns
    -------
    Grating
        The grating.
    """
    return checked(Grating(lines, None, spread, radial=True, name=name))


def display_grating(
    pixels_per_inch: float, opening: float = 0.7, count: int = 5, name: str = "display"
) -> Grating:
    """Make the net of a display's sub-pixels: three to a pixel along the tangent, one along the bitangent.

    Parameters
    ----------
    pixels_per_inch : float
        Of the display.
    opening : float
        Share of a sub-pixel's width and height that reflects.
    count : int
        Sub-pixels and rows of pixels that are lit in phase.
    name : str
        What to call it.

    Returns
    -------
    Grating
        Crossed slits.
    """
    pixel = INCH / refuse.positive("pixels_per_inch", pixels_per_inch)
    opening = refuse.between("opening", opening, 0.01, 1.0)
    column = pixel / SUB_PIXELS
    return crossed_grating(Lines(column, opening * column, count), Lines(pixel, opening * pixel, count), name)


def grating(name: str) -> Grating:
    """Return the grating of a preset, or of a TOML file.

    Parameters
    ----------
    name : str
        "cd", "dvd", "bluray", "lcd-342ppi", "lcd-534ppi", "blazed-600", ..., or a path that ends in ".toml".

    Returns
    -------
    Grating
        The grating.

    Raises
    ------
    refuse.Refusal
        Where there is no such preset, or it cannot be.
    """
    preset = presets.load("gratings", name)
    if preset.kind == "display":
        return display_grating(preset.pixels_per_inch, preset.opening, preset.count, name)
    if preset.kind == "blazed":
        wavelength = preset.blaze_wavelength_nm * 1e-9
        return blazed_grating(preset.lines_per_mm, wavelength, preset.count, preset.spread, name)
    period, width = preset.period_um * 1e-6, preset.width_um * 1e-6
    if preset.kind == "grooves":
        return groove_grating(period, width, preset.depth_um * 1e-6, preset.count, preset.spread, name)
    if preset.kind == "radial":
        return radial_grating(Lines(period, width, preset.count), preset.spread, name)
    return multislit_grating(period, width, preset.count, preset.spread, name)


def orders(grating: Grating, incidence: float, wavelength: float) -> tuple[NDArray[np.int64], Array]:
    """Return the orders that a grating sends out, and where: d (sin θ_i + sin θ_o) = m λ.

    Parameters
    ----------
    grating : Grating
        Its lines along the tangent.
    incidence : float
        Angle of the light from the normal towards +t, radians.
    wavelength : float
        Metres.

    Returns
    -------
    numbers : ndarray of int64, shape (M,)
        m, rising; 0 is the mirror's own direction.
    angles : ndarray of float64, shape (M,)
        θ_o from the normal towards +t, radians.

    Raises
    ------
    refuse.Refusal
        Where the incidence is not within a quarter turn, or the wavelength is not positive.
    """
    sine = math.sin(refuse.between("incidence", incidence, -math.pi / 2, math.pi / 2))
    step = refuse.positive("wavelength", wavelength) / grating.along.period
    first, last = math.ceil((sine - 1.0) / step - 1e-9), math.floor((sine + 1.0) / step + 1e-9)
    numbers = np.arange(first, last + 1, dtype=np.int64)
    return numbers, np.arcsin(np.clip(numbers * step - sine, -1.0, 1.0))


def checked(grating: Grating) -> Grating:
    """Refuse a grating that cannot be.

    Parameters
    ----------
    grating : Grating
        Any values.

    Returns
    -------
    Grating
        The same.

    Raises
    ------
    refuse.Refusal
        At the first wrong value.
    """
    checked_lines(grating.along)
    if grating.across is not None:
        checked_lines(grating.across)
        if grating.radial:
            raise refuse.Refusal("'radial' mixes directions of one set of lines; leave 'across' out.")
    refuse.positive("spread", grating.spread)
    return grating


def normal_mean(cells: Array, deviation: float, centre: Array | float = 0.0) -> Array:
    """Return the mean of a normal density over cells.

    Parameters
    ----------
    cells : ndarray of float64, shape (2, N)
        Lower and upper ends.
    deviation : float
        Standard deviation.
    centre : float or ndarray of float64, shape (M, 1)
        Where the density has its middle.

    Returns
    -------
    ndarray of float64, shape (N,) or (M, N)
        The means, also of cells far narrower than the deviation.
    """
    low, high = ((end - centre) / (math.sqrt(2.0) * deviation) for end in cells)
    at_middle = np.exp(-((0.5 * (low + high)) ** 2)) / (math.sqrt(2.0 * math.pi) * deviation)
    small = high - low < 1e-4
    span = np.where(small, 1.0, (high - low) * math.sqrt(2.0) * deviation)
    return np.asarray(np.where(small, at_middle, 0.5 * (erf(high) - erf(low)) / span))
