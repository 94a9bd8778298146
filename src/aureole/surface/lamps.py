"""Lamps before a surface: near ones, whose direction differs from point to point, distant ones, and areas."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse


@dataclass(frozen=True, eq=False)
class Lamp:
    """A point of light, or light from one direction.

    Its spectrum is that of the table it is reflected by. Lamps of other spectra have tables of their own:
    `light` says which.

    Parameters
    ----------
    place : ndarray of float64, shape (3,)
        Where it is, in metres; the unit vector towards it where `distant`.
    intensity : ndarray of float64, shape (3,)
        Linear RGB: radiant intensity, that is irradiance at one metre; irradiance where `distant`.
    distant : bool
        Whether it is so far away that it has one direction and one irradiance.
    facing : ndarray of float64, shape (3,)
        Unit vector along which it shines with a cosine, as a small flat lamp; zeros shine all ways alike.
    light : int
        Which of a shader's lights it has: 0 is the first table's.
    """

    place: NDArray[np.float64]
    intensity: NDArray[np.float64]
    distant: bool = False
    facing: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    light: int = 0


def point_lamp(place: ArrayLike, intensity: ArrayLike = 1.0) -> Lamp:
    """Make a lamp at a place: each point of a surface sees it in its own direction and distance.

    Parameters
    ----------
    place : array_like, shape (3,)
        Metres.
    intensity : array_like, shape () or (3,)
        Irradiance at one metre, linear RGB.

    Returns
    -------
    Lamp
        The lamp.

    Raises
    ------
    refuse.Refusal
        Where a number is missing, not finite, or an intensity negative.
    """
    return Lamp(_vector("place", place), _intensity(intensity))


def distant_lamp(direction: ArrayLike, irradiance: ArrayLike = 1.0) -> Lamp:
    """Make a lamp far away, such as the sun.

    Parameters
    ----------
    direction : array_like, shape (3,)
        From the surface towards the lamp, of any length.
    irradiance : array_like, shape () or (3,)
        On a surface that faces it, linear RGB.

    Returns
    -------
    Lamp
        The lamp.

    Raises
    ------
    refuse.Refusal
        Where a number is missing, not finite, an irradiance negative, or the direction has no length.
    """
    return Lamp(_unit("direction", direction), _intensity(irradiance), distant=True)


def area_lamp(
    centre: ArrayLike,
    half_width: ArrayLike,
    half_height: ArrayLike,
    radiance: ArrayLike = 1.0,
    samples: tuple[int, int] = (8, 8),
) -> tuple[Lamp, ...]:
    """Make a flat rectangle of even radiance, as small flat lamps at the middles of its cells.

    Parameters
    ----------
    centre, half_width, half_height : array_like, shape (3,)
        Its middle and half of its sides, in metres; it shines along half_width × half_height.
    radiance : array_like, shape () or (3,)
        Linear RGB.
    samples : tuple of int
        Cells along its height and its width. Orders of diffraction are sharp: cells must be closer than a
        lobe of the table is wide, or they show one by one.

    Returns
    -------
    tuple of Lamp
        samples[0] · samples[1] lamps.

    Raises
    ------
    refuse.Refusal
        Where a number is missing or not finite, a radiance negative, or the sides lie on one line.
    """
    middle, across, along = (
        _vector(name, value)
        for name, value in (("centre", centre), ("half_width", half_width), ("half_height", half_height))
    )
    rows, columns = (refuse.at_least("samples", count, 1) for count in samples)
    normal = np.cross(across, along)
    area = 4.0 * float(np.linalg.norm(normal))
    facing = _unit("half_height", normal)
    share = _intensity(radiance) * (area / (rows * columns))
    steps = ((2.0 * np.arange(count) + 1.0) / count - 1.0 for count in (rows, columns))
    ys, xs = (list(step) for step in steps)
    return tuple(Lamp(middle + x * across + y * along, share, facing=facing) for y in ys for x in xs)


def lamp_rows(lamps: Sequence[Lamp], whites: NDArray[np.floating], tables: int) -> NDArray[np.float32]:
    """Write lamps as rows of numbers for the shader.

    Parameters
    ----------
    lamps : sequence of Lamp
        The lamps.
    whites : ndarray of float, shape (K, 3)
        Colour of a white surface under each light.
    tables : int
        Tables that each light has.

    Returns
    -------
    ndarray of float32, shape (L, 14)
        Place, 1 for a place or 0 for a direction, intensity, facing, the first table, the intensity's colour.

    Raises
    ------
    refuse.Refusal
        Where a lamp has a light that is not there.
    """
    rows = []
    for one in lamps:
        if refuse.at_least("light", one.light, 0) >= len(whites):
            raise refuse.Refusal(f"'light' must be an integer from 0 to {len(whites) - 1}, got {one.light}.")
        colour = one.intensity * whites[one.light]
        near = 0.0 if one.distant else 1.0
        rows.append([*one.place, near, *one.intensity, *one.facing, one.light * tables, *colour])
    return np.array(rows, dtype=np.float32).reshape(-1, 14)


def _vector(name: str, value: ArrayLike) -> NDArray[np.float64]:
    return np.array(refuse.all_finite(name, refuse.shape_of(name, value, (3,))), dtype=np.float64)


def _unit(name: str, value: ArrayLike) -> NDArray[np.float64]:
    vector = _vector(name, value)
    length = float(np.linalg.norm(vector))
    if length < 1e-15:
        raise refuse.Refusal(f"'{name}' must have a length.")
    unit: NDArray[np.float64] = vector / length
    return unit


def _intensity(value: ArrayLike) -> NDArray[np.float64]:
    colour = np.broadcast_to(refuse.all_finite("intensity", value), (3,)).astype(np.float64)
    if (colour < 0).any():
        raise refuse.Refusal(f"'intensity' must be >= 0, got {colour.tolist()}.")
    return colour
