"""The lookup table of a diffractive surface: `ScatterTable`, its warped axes, reading it at any h.

f_r = diffuse + specular + 4π² F² G S_d(h · t, h · b) (surface paper, Eq. 7 and 10) with h = ω_i + ω_o,
not normalised, of unit vectors away from the surface. A table holds S_d in XYZ at h = half_range · uⁿ with
u even from −1 to 1, both ends being samples, and n the odd warp: orders crowd where h is small. Columns
run along the tangent t to the right; rows along the bitangent b, which points up: row 0 is +half_range.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import light, picture, refuse

MODELS = {"phase": 4, "amplitude": 2, "paper": 2}
ZERO_ORDERS = ("keep", "remove", "specular")
HALF_RANGE, WARP, SIZE, WAVELENGTHS = 2.0, 5, 2048, 81
TANGENT_CONVENTION = "columns along +t to the right, rows along b with +b at the top"


@dataclass(frozen=True, eq=False)
class ScatterTable:
    """S_d of a diffractive surface under one light, over h · t and h · b.

    Parameters
    ----------
    values : ndarray of float32, shape (rows, columns, 3)
        X, Y, Z of S_d, relative to a light of luminance 1; 1/sr.
    half_range : float
        h of the outermost samples; S_d is zero outside.
    warp : int
        n of h = half_range · uⁿ, odd.
    illuminant : str
        Name of the light.
    white : tuple of float
        X, Y, Z of the light, Y = 1: what a mirror would show.
    model : str
        Which power of the wavelength scaled the pattern: "phase", "amplitude", "paper", or "function".
    zero_order : str
        "keep", "remove" or "specular": whether the light about h = 0 is in the table, dropped, or left
        for an ordinary lobe to render.
    metadata : Mapping
        What else is known: numbers and text.
    """

    values: NDArray[np.float32]
    half_range: float
    warp: int
    illuminant: str
    white: tuple[float, float, float]
    model: str = "phase"
    zero_order: str = "keep"
    metadata: Mapping[str, Any] = field(default_factory=dict)


def scatter_table(
    values: ArrayLike,
    white: ArrayLike,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
    illuminant: str = "E",
    model: str = "function",
    zero_order: str = "keep",
    metadata: Mapping[str, Any] | None = None,
) -> ScatterTable:
    """Make a table from numbers.

    Parameters
    ----------
    values : array_like, shape (rows, columns, 3)
        X, Y, Z; two rows and two columns or more.
    white : array_like, shape (3,)
        X, Y, Z of the light.
    half_range : float
        h of the outermost samples, at most 2.
    warp : int
        Odd, at least 1.
    illuminant : str
        Name of the light.
    model : str
        One of `MODELS`, or "function".
    zero_order : {"keep", "remove", "specular"}
        What became of the light about h = 0.
    metadata : Mapping or None
        What else is known.

    Returns
    -------
    ScatterTable
        Float32.

    Raises
    ------
    refuse.Refusal
        Where a number is not as described.
    """
    numbers = refuse.all_finite("values", refuse.shape_of("values", values, (None, None, 3)))
    if min(numbers.shape[:2]) < 2:
        raise refuse.Refusal(f"'values' needs two rows and columns or more, got {numbers.shape[:2]}.")
    given = refuse.all_finite("white", refuse.shape_of("white", white, (3,)))
    refuse.one_of("model", model, (*MODELS, "function"))
    refuse.one_of("zero_order", zero_order, ZERO_ORDERS)
    return ScatterTable(
        np.ascontiguousarray(numbers, dtype=np.float32),
        checked_half_range(half_range),
        checked_warp(warp),
        illuminant,
        (float(given[0]), float(given[1]), float(given[2])),
        model,
        zero_order,
        dict(metadata or {}),
    )


def checked_half_range(half_range: float) -> float:
    """Refuse a half range that is not above 0 and at most 2.

    Parameters
    ----------
    half_range : float
        h of the outermost samples.

    Returns
    -------
    float
        The value.

    Raises
    ------
    refuse.Refusal
        Where it is outside: h is the sum of two unit vectors.
    """
    return refuse.between("half_range", refuse.positive("half_range", half_range), 0.0, 2.0)


def checked_warp(warp: int) -> int:
    """Refuse a warp that is not odd.

    Parameters
    ----------
    warp : int
        n of h = half_range · uⁿ.

    Returns
    -------
    int
        The value.

    Raises
    ------
    refuse.Refusal
        Where it is not an odd integer of at least 1: an even power folds the sides onto each other.
    """
    if refuse.at_least("warp", warp, 1) % 2 == 0:
        raise refuse.Refusal(f"'warp' must be odd (1, 3, 5, ...), got {warp}.")
    return int(warp)


def refuse_too_large(name: str, shape: tuple[int, ...], bytes_per_sample: float) -> None:
    """Refuse what would need more memory than three quarters of what is free.

    Parameters
    ----------
    name : str
        The argument that says how large it is.
    shape : tuple of int
        Rows and columns.
    bytes_per_sample : float
        That the work takes for each.

    Raises
    ------
    refuse.Refusal
        Where it does not fit.
    """
    needed, allowed = bytes_per_sample * math.prod(shape), picture.allowed_memory()
    if needed > allowed:
        raise refuse.Refusal(
            f"'{name}' of {' x '.join(map(str, shape))} needs {needed / 1e9:.3g} GB of memory; "
            f"{allowed / 1e9:.3g} GB may be used. Take fewer samples."
        )


def axis(count: int, half_range: float = HALF_RANGE, warp: int = WARP) -> NDArray[np.float64]:
    """Return h of a table's samples along one axis, rising.

    Parameters
    ----------
    count : int
        Number of samples.
    half_range : float
        h of the outermost ones.
    warp : int
        n of h = half_range · uⁿ.

    Returns
    -------
    ndarray of float64, shape (count,)
        h · t of the columns; backwards, h · b of the rows.
    """
    # Counted from the middle, so that it is exactly odd.
    u = (2 * np.arange(count) - (count - 1)) / (count - 1)
    return np.asarray(half_range * u**warp, dtype=np.float64)


def cells(count: int, half_range: float = HALF_RANGE, warp: int = WARP) -> NDArray[np.float64]:
    """Return the cells about a table's samples along one axis, rising.

    Parameters
    ----------
    count : int
        Number of samples.
    half_range : float
        h of the outermost samples, where the outermost cells end.
    warp : int
        n of h = half_range · uⁿ.

    Returns
    -------
    ndarray of float64, shape (2, count)
        Lower and upper ends, half-way in u between neighbours.
    """
    u = (2 * np.arange(count + 1) - count) / (count - 1)
    edges = half_range * np.clip(u, -1.0, 1.0) ** warp
    return np.stack([edges[:-1], edges[1:]])


def axes(table: ScatterTable) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where a table's samples lie.

    Parameters
    ----------
    table : ScatterTable
        Any.

    Returns
    -------
    h_b : ndarray of float64, shape (rows,)
        h · b of the rows, falling.
    h_t : ndarray of float64, shape (columns,)
        h · t of the columns, rising.
    """
    rows, columns = table.values.shape[:2]
    return axis(rows, table.half_range, table.warp)[::-1], axis(columns, table.half_range, table.warp)


def areas(table: ScatterTable) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the sides of the cells about a table's samples; products of two are areas in h.

    Parameters
    ----------
    table : ScatterTable
        Any.

    Returns
    -------
    along_b : ndarray of float64, shape (rows,)
        Heights of the rows.
    along_t : ndarray of float64, shape (columns,)
        Widths of the columns.
    """
    rows, columns = table.values.shape[:2]
    down = np.diff(cells(rows, table.half_range, table.warp), axis=0)[0]
    return down[::-1], np.diff(cells(columns, table.half_range, table.warp), axis=0)[0]


def unwarp(h: ArrayLike, half_range: float = HALF_RANGE, warp: int = WARP) -> NDArray[np.float64]:
    """Return u of h = half_range · uⁿ.

    Parameters
    ----------
    h : array_like
        Any shape.
    half_range : float
        h at u = 1.
    warp : int
        n, odd.

    Returns
    -------
    ndarray of float64
        Of the same shape; beyond ±1 outside the table.
    """
    share = np.asarray(h, dtype=np.float64) / half_range
    return np.asarray(np.copysign(np.abs(share) ** (1.0 / warp), share))


def lookup(table: ScatterTable, h_t: ArrayLike, h_b: ArrayLike) -> NDArray[np.float32]:
    """Read a table at any h, bilinear in its warped coordinates u.

    Parameters
    ----------
    table : ScatterTable
        Any.
    h_t, h_b : array_like
        Components of h = ω_i + ω_o along tangent and bitangent, of shapes that broadcast.

    Returns
    -------
    ndarray of float32, shape (..., 3)
        X, Y, Z of S_d; zero outside the table.
    """
    found = bilinear(table.values, h_t, h_b, table.half_range, table.warp)
    return np.asarray(found, dtype=np.float32)


def bilinear(
    values: NDArray[np.floating],
    h_t: ArrayLike,
    h_b: ArrayLike,
    half_range: float = HALF_RANGE,
    warp: int = WARP,
) -> NDArray[np.float64]:
    """Read numbers that are laid out as a table's, bilinear in the warped coordinates u.

    Parameters
    ----------
    values : ndarray, shape (rows, columns, K)
        Any numbers.
    h_t, h_b : array_like
        Components of h along tangent and bitangent, of shapes that broadcast.
    half_range : float
        h of the outermost samples.
    warp : int
        n of h = half_range · uⁿ.

    Returns
    -------
    ndarray of float64, shape (..., K)
        Zero outside.
    """
    across, down = np.broadcast_arrays(unwarp(h_t, half_range, warp), -unwarp(h_b, half_range, warp))
    inside = (np.abs(across) <= 1.0) & (np.abs(down) <= 1.0)
    i, t_row = _split(down, values.shape[0])
    j, t_column = _split(across, values.shape[1])
    upper = (1 - t_column) * values[i, j] + t_column * values[i, j + 1]
    lower = (1 - t_column) * values[i + 1, j] + t_column * values[i + 1, j + 1]
    found = (1 - t_row) * upper + t_row * lower
    return np.asarray(np.where(inside[..., None], found, 0.0), dtype=np.float64)


def rgb(table: ScatterTable, space: str = "rec709") -> NDArray[np.float32]:
    """Return a table in a linear RGB space whose white is the light's own.

    Parameters
    ----------
    table : ScatterTable
        Any.
    space : str
        A name in `light.SPACES`.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        R, G, B; a mirror would be neutral, but a laser keeps its colour.
        Spectral colours lie out of gamut and have negative parts.

    Raises
    ------
    refuse.Refusal
        Where the space is unknown.
    """
    return np.asarray(
        light.from_xyz(table.values, space, neutral_white(table.white, space)), dtype=np.float32
    )


def neutral_white(white: ArrayLike, space: str) -> NDArray[np.float64]:
    """Return the white that comes out neutral when a table is shown in a linear RGB space.

    Parameters
    ----------
    white : array_like, shape (3,)
        X, Y, Z of the table's light.
    space : str
        A name in `light.SPACES`.

    Returns
    -------
    ndarray of float64, shape (3,)
        The light's own; the space's where the light is a line or so saturated that no eye adapts to it,
        which then keeps its colour.

    Raises
    ------
    refuse.Refusal
        Where the space is unknown.
    """
    refuse.one_of("space", space, light.SPACES)
    try:
        light.matrix("xyz", space, white)
    except refuse.Refusal:
        return np.asarray(light.SPACES[space].white, dtype=np.float64)
    return np.asarray(white, dtype=np.float64)


def energy(table: ScatterTable) -> NDArray[np.float64]:
    """Integrate a table over h.

    Parameters
    ----------
    table : ScatterTable
        Any.

    Returns
    -------
    ndarray of float64, shape (3,)
        ∫ S_d dh in X, Y and Z.
    """
    along_b, along_t = areas(table)
    total: NDArray[np.float64] = along_b @ np.einsum("ijc,j->ic", table.values, along_t)
    return total


def _split(u: NDArray[np.float64], count: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the index of the sample before u, and the share of the next one, with a channel axis."""
    place = np.clip(0.5 * (u + 1.0) * (count - 1), 0.0, count - 1.0)
    index = np.minimum(place.astype(np.int64), count - 2)
    return index, (place - index)[..., None]
