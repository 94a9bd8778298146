"""Linear colour spaces: primaries and white, the matrices between them, adaptation to a white.

XYZ is relative to the equal-energy white unless a white is named, and every conversion adapts
whites (Bradford): what is white on one side is white on the other. Colours out of gamut keep their
negative values. Arrays are (..., 3); float32 stays float32.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse
from aureole.light import _kernels_spaces
from aureole.records import Picture

# So few numbers are not worth a compiled loop.
FEW = 30_000
WHITE_KEY = "white_xyz"  # metadata of a picture in XYZ: the X, Y, Z that its white has

# Lam 1985; as printed in ICC.1:2022, Annex E.
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


@dataclass(frozen=True, eq=False)
class Space:
    """A linear RGB space.

    Parameters
    ----------
    name : str
        What to call it.
    primaries : ndarray of float64, shape (3, 2)
        Chromaticities (x, y) of red, green and blue.
    white : ndarray of float64, shape (3,)
        X, Y, Z of RGB (1, 1, 1), with Y = 1.
    to_xyz : ndarray of float64, shape (3, 3)
        XYZ from RGB as the standard prints it, relative to the space's own white.
    """

    name: str
    primaries: NDArray[np.float64]
    white: NDArray[np.float64]
    to_xyz: NDArray[np.float64]


def space_from_primaries(name: str, primaries: ArrayLike, white: ArrayLike) -> Space:
    """Make a space from the chromaticities of its primaries and its white (SMPTE RP 177:1993).

    Parameters
    ----------
    name : str
        What to call it.
    primaries : array_like, shape (3, 2)
        Chromaticities (x, y) of red, green and blue.
    white : array_like, shape (2,)
        Chromaticity (x, y) of RGB (1, 1, 1).

    Returns
    -------
    Space
        The space with its matrix.

    Raises
    ------
    refuse.Refusal
        Where the primaries lie on one line, or the white has no luminance.
    """
    corners = _numbers("primaries", primaries, (3, 2))
    neutral = _xyz_of(_numbers("white", white, (2,)))
    if not np.isfinite(neutral).all() or neutral[1] <= 0:
        raise refuse.Refusal(f"'white' must be a chromaticity with y > 0, got {np.asarray(white).tolist()}.")
    columns = np.column_stack([corners, 1.0 - corners.sum(axis=1)]).T
    if abs(np.linalg.det(columns)) < 1e-9:
        raise refuse.Refusal(f"'primaries' must span a triangle, got {corners.tolist()}.")
    # Each primary's strength follows from RGB (1, 1, 1) being the white.
    return Space(name, corners, neutral, columns * np.linalg.solve(columns, neutral))


def adaptation(source: ArrayLike, target: ArrayLike) -> NDArray[np.float64]:
    """Return the Bradford matrix that carries one white to another (ICC.1:2022, Annex E).

    Parameters
    ----------
    source, target : array_like, shape (3,)
        X, Y, Z of the two whites; their luminances are set aside, only colour is adapted.

    Returns
    -------
    ndarray of float64, shape (3, 3)
        XYZ under the target white from XYZ under the source white.

    Raises
    ------
    refuse.Refusal
        Where a white has no positive response in each of the three Bradford cones, as saturated
        light such as a single line: nothing can be adapted to it, so treat it as neutral yourself.
    """
    before, after = _cones("source", source), _cones("target", target)
    adapted = np.linalg.solve(BRADFORD, (after / before)[:, None] * BRADFORD)
    return np.asarray(adapted, dtype=np.float64)


def matrix(source: str | Space, target: str | Space, white: ArrayLike | None = None) -> NDArray[np.float64]:
    """Return the matrix from one space to another, adapted from white to white.

    Parameters
    ----------
    source, target : str or Space
        Names in `SPACES`, or spaces.
    white : array_like, shape (3,), or None
        X, Y, Z of the white that "xyz" is relative to (the source, where both are); None is the
        equal-energy white. Two RGB spaces take no white.

    Returns
    -------
    ndarray of float64, shape (3, 3)
        Target values from source values.

    Raises
    ------
    refuse.Refusal
        Where a space is unknown, or the white cannot be adapted or has no use.
    """
    start, end = _space("source", source), _space("target", target)
    if white is None:
        return _between(start, end)
    if "xyz" not in (start.name, end.name):
        raise refuse.Refusal(f"'white' belongs to XYZ; from '{start.name}' to '{end.name}' it has no use.")
    given = _relative(_numbers("white", white, (3,)))
    if start.name == "xyz":
        return _between(replace(start, white=given), end)
    return _between(start, replace(end, white=given))


def from_xyz(
    xyz: ArrayLike, space: str | Space = "rec709", white: ArrayLike | None = None
) -> NDArray[np.floating]:
    """Convert XYZ to a linear RGB space.

    Parameters
    ----------
    xyz : array_like, shape (..., 3)
        Tristimulus values relative to `white`.
    space : str or Space
        A name in `SPACES`, or a space.
    white : array_like, shape (3,), or None
        X, Y, Z of the light that is to come out neutral, at any luminance; None is the equal-energy
        white. `SPACES[space].white` leaves colours as the standard's own matrix gives them.

    Returns
    -------
    ndarray, shape (..., 3)
        RGB; float32 where the input is, else float64. Negative out of gamut.

    Raises
    ------
    refuse.Refusal
        Where the space is unknown, or the white cannot be adapted.
    """
    return _apply(matrix("xyz", space, white), _colours("xyz", xyz))


def to_xyz(
    rgb: ArrayLike, space: str | Space = "rec709", white: ArrayLike | None = None
) -> NDArray[np.floating]:
    """Convert a linear RGB space to XYZ: the inverse of `from_xyz`.

    Parameters
    ----------
    rgb : array_like, shape (..., 3)
        Linear values.
    space : str or Space
        A name in `SPACES`, or a space.
    white : array_like, shape (3,), or None
        X, Y, Z that neutral values are to have, at any luminance; None is the equal-energy white.

    Returns
    -------
    ndarray, shape (..., 3)
        XYZ; float32 where the input is, else float64.

    Raises
    ------
    refuse.Refusal
        Where the space is unknown, or the white cannot be adapted.
    """
    return _apply(np.linalg.inv(matrix("xyz", space, white)), _colours("rgb", rgb))


def convert(picture: Picture, space: str) -> Picture:
    """Convert a picture to another space; alpha and metadata stay.

    Parameters
    ----------
    picture : Picture
        In a space of `SPACES`. One in XYZ may name its white in ``metadata["white_xyz"]``, as those
        from `spectral_sum` do; without it the white is the equal-energy one.
    space : str
        A name in `SPACES`.

    Returns
    -------
    Picture
        The picture in that space, neutral where it was neutral.

    Raises
    ------
    refuse.Refusal
        Where a space is unknown, or the picture's white cannot be adapted.
    """
    refuse.one_of("space", space, SPACES)
    if space == picture.colour_space:
        return picture
    white = picture.metadata.get(WHITE_KEY) if picture.colour_space == "xyz" else None
    change = matrix(picture.colour_space, space, white)
    colour = _apply(change, picture.pixels[..., :3])
    pixels = (
        np.concatenate([colour, picture.pixels[..., 3:]], axis=-1) if picture.pixels.shape[-1] > 3 else colour
    )
    kept = {key: value for key, value in picture.metadata.items() if key != WHITE_KEY}
    return Picture(pixels.astype(np.float32, copy=False), space, kept)


def _apply(change: NDArray[np.floating], colours: NDArray[np.floating]) -> NDArray[np.floating]:
    factors = change.astype(colours.dtype)
    if colours.size < FEW:
        return np.asarray(colours @ factors.T)
    flat = np.ascontiguousarray(colours).reshape(-1, 3)
    out = np.empty_like(flat)
    _kernels_spaces.apply(factors, flat, out)
    return out.reshape(colours.shape)


def _between(start: Space, end: Space) -> NDArray[np.float64]:
    inverse = np.linalg.inv(end.to_xyz)
    return np.asarray(inverse @ adaptation(start.white, end.white) @ start.to_xyz, dtype=np.float64)


def _space(name: str, value: str | Space) -> Space:
    return value if isinstance(value, Space) else SPACES[refuse.one_of(name, value, SPACES)]


def _cones(name: str, white: ArrayLike) -> NDArray[np.float64]:
    cones = BRADFORD @ _relative(_numbers(name, white, (3,)))
    if not (cones > 1e-6).all():
        shown = ", ".join(f"{value:.3g}" for value in np.asarray(white))
        raise refuse.Refusal(
            f"'white' ({shown}) is too saturated to adapt to: a Bradford cone does not respond to it."
            " Leave the white out, or treat the light as neutral."
        )
    return cones


def _relative(white: NDArray[np.float64]) -> NDArray[np.float64]:
    if white[1] <= 0:
        raise refuse.Refusal(f"'white' must have a luminance Y > 0, got {white[1]:g}.")
    relative: NDArray[np.float64] = white / white[1]
    return relative


def _xyz_of(xy: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y = xy
    return np.array([x / y, 1.0, (1.0 - x - y) / y]) if y > 0 else np.full(3, np.nan)


def _numbers(name: str, values: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    return np.array(refuse.all_finite(name, refuse.shape_of(name, values, shape)), dtype=np.float64)


def _colours(name: str, values: ArrayLike) -> NDArray[np.floating]:
    found = np.asarray(values)
    if found.ndim == 0 or found.shape[-1] != 3:
        raise refuse.Refusal(f"'{name}' must be an array of shape (..., 3), got {found.shape}.")
    return found if found.dtype == np.float32 else found.astype(np.float64)


_D65 = (0.3127, 0.3290)
_ACES = (0.32168, 0.33767)

SPACES = {
    made.name: made
    for made in (
        # ITU-R BT.709-6, Table 1, items 1.3 and 1.4; IEC 61966-2-1 has the same.
        space_from_primaries("rec709", [(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)], _D65),
        # SMPTE ST 2065-1 and ACES S-2014-004: AP1.
        space_from_primaries("acescg", [(0.713, 0.293), (0.165, 0.830), (0.128, 0.044)], _ACES),
        # ITU-R BT.2020-2, Table 3.
        space_from_primaries("rec2020", [(0.708, 0.292), (0.170, 0.797), (0.131, 0.046)], _D65),
        # SMPTE ST 2065-1: AP0.
        space_from_primaries("aces2065-1", [(0.7347, 0.2653), (0.0, 1.0), (0.0001, -0.0770)], _ACES),
        # CIE 1931 XYZ relative to the equal-energy white.
        space_from_primaries("xyz", [(1.0, 0.0), (0.0, 1.0), (0.0, 0.0)], (1 / 3, 1 / 3)),
    )
}
