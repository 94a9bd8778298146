"""Light from all around on a flat sample: one correlation gives what it sends to every view.

A flat sample's surroundings are, in direction cosines s along tangent and bitangent, a disc of radius 1,
and ds = cos θ dω. So what the sample sends towards s_o is L_o(s_o) = 4π² F² G ∫ S_d(s_i + s_o) L_i(s_i) ds_i,
the correlation of the table with the light on that disc. One transform a channel gives all views at once,
for any turn of sample or light; F and G stand before the integral, which is the only approximation.

World: x right, y up, z towards the viewer. A latitude-longitude picture has y up at its top; its middle
column looks along −z, and columns further right along +x. Rows of planes run against the bitangent.

Colours: table and light are multiplied channel by channel in a linear RGB space. White light is exact
(the table is made for its spectrum); coloured light is as exact as three broad bands are.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import light, refuse
from aureole.picture.convolution import Convolver
from aureole.records import Picture
from aureole.surface import _kernels_environment
from aureole.surface.resampling import on_even_steps
from aureole.surface.table import ScatterTable, rgb

MARGIN = 3  # samples of a plane beyond the disc, which the laying out of light reaches
TURNED_PARTS = 4  # of each pixel along a side, where light is turned
SAMPLES_AT_ONCE = 2_000_000
FOUR_PI_SQUARED = 4 * np.pi**2
Weight = Callable[[int, float], NDArray[np.float64]]


@dataclass(frozen=True, eq=False)
class Environment:
    """Light from all around.

    Parameters
    ----------
    radiance : ndarray of float32, shape (rows, columns, 3)
        Latitude-longitude picture, each pixel one even patch of the sphere: row 0 at y up, the middle
        column towards −z.
    colour_space : str
        One of the names in `aureole.light.SPACES`.
    name : str
        What to call it.
    """

    radiance: NDArray[np.float32]
    colour_space: str = "rec709"
    name: str = "environment"


@dataclass(frozen=True, eq=False)
class HemisphereMap:
    """The light on a sample, on a plane of direction cosines.

    Parameters
    ----------
    energy : ndarray of float32, shape (n, n, 3)
        Integral of radiance over direction cosines about each sample; they add up to the irradiance.
    step : float
        Between samples. The middle one is the normal; columns run along the tangent, rows against the
        bitangent.
    """

    energy: NDArray[np.float32]
    step: float


@dataclass(frozen=True, eq=False)
class ReflectedLight:
    """What a flat sample sends to every view, on a plane of direction cosines.

    Parameters
    ----------
    radiance : ndarray of float32, shape (n, n, 3)
        Diffracted light, 4π² ∫ S_d L_i ds, without F² G.
    step : float
        Between samples, laid out as in `HemisphereMap`.
    colour_space : str
        Of the radiance.
    centre : tuple of float
        Direction cosines of the middle sample.
    """

    radiance: NDArray[np.float32]
    step: float
    colour_space: str
    centre: tuple[float, float] = (0.0, 0.0)

    def towards(self, views: ArrayLike) -> NDArray[np.float32]:
        """Look up the light that leaves towards some views.

        Parameters
        ----------
        views : array_like, shape (..., 2)
            Their direction cosines along tangent and bitangent.

        Returns
        -------
        ndarray of float32, shape (..., 3)
            Radiance, cubic between samples.
        """
        places = directions_checked("views", views) - self.centre
        reach = (len(self.radiance) // 2 - 2) * self.step
        if np.abs(places).max(initial=0.0) > reach:
            raise refuse.Refusal(
                f"'views' must lie within {reach:.4g} of {self.centre} along tangent and bitangent: "
                "no light was reflected towards others."
            )
        middle = len(self.radiance) // 2
        x, y = middle + places[..., 0] / self.step, middle - places[..., 1] / self.step
        return _cubic(self.radiance, x, y)


class EnvironmentReflection:
    """A table made ready to meet light from all around, in any turn of it.

    Parameters
    ----------
    table : ScatterTable
        Of the sample.
    colour_space : str
        RGB space to multiply in; lights are converted to it.
    size : int
        Samples across the disc of directions; an even count is lowered by one.
    filter : str
        "average" takes the table's mean over each step, so that lines narrower than a step keep their
        energy; "sharpened" takes the blur of that off again; "point" takes the table's values.
    precision : str
        "single": rounding is some 2e-7 of the brightest view, in every view; "double": none to speak of.
    threads : int, optional
        How many to use; by default one for each processor.
    weight : callable or None
        Gives, for the samples on each side of h = 0 and their step, what multiplies the table.
    """

    def __init__(
        self,
        table: ScatterTable,
        colour_space: str = "rec709",
        size: int = 1023,
        filter: str = "sharpened",
        precision: str = "single",
        threads: int | None = None,
        weight: Weight | None = None,
    ) -> None:
        refuse.one_of("colour_space", colour_space, light.SPACES)
        self.size, self.step = plane_of(size)
        self.colour_space = colour_space
        colours = rgb(table, colour_space)
        counts = (2 * self.size - 1, 2 * self.size - 1)
        kernel = on_even_steps(colours, table.half_range, table.warp, counts, self.step, filter)
        if weight is not None:
            kernel = kernel * weight(self.size - 1, self.step)[..., None].astype(np.float32)
        shape = (self.size, self.size)
        self._convolver = Convolver(FOUR_PI_SQUARED * kernel, shape, precision, threads)

    def __call__(self, environment: Environment, frame: ArrayLike) -> ReflectedLight:
        """Reflect light from all around.

        Parameters
        ----------
        environment : Environment
            The light.
        frame : array_like, shape (3, 3)
            Tangent, bitangent and normal of the sample, as `frame_of` makes them.

        Returns
        -------
        ReflectedLight
            Towards every view.
        """
        around = hemisphere(in_space(environment, self.colour_space), frame, self.size)
        return self.of(around)

    def of(self, around: HemisphereMap) -> ReflectedLight:
        """Reflect light that is already laid out in the sample's frame.

        Parameters
        ----------
        around : HemisphereMap
            Of this reflection's size.

        Returns
        -------
        ReflectedLight
            Towards every view.
        """
        refuse.shape_of("around", around.energy, (self.size, self.size, 3))
        # Turned by half a turn, light from s_i stands at −s_i, and the correlation is a convolution.
        turned = np.ascontiguousarray(around.energy[::-1, ::-1])
        return ReflectedLight(self._convolver(turned).astype(np.float32), self.step, self.colour_space)


def reflect(
    table: ScatterTable,
    environment: Environment,
    frame: ArrayLike,
    size: int = 1023,
    filter: str = "sharpened",
) -> ReflectedLight:
    """Reflect light from all around off a flat sample, towards every view at once.

    Parameters
    ----------
    table : ScatterTable
        Of the sample.
    environment : Environment
        The light.
    frame : array_like, shape (3, 3)
        Tangent, bitangent and normal of the sample in the world.
    size : int
        Samples across the disc of directions.
    filter : str
        As for `EnvironmentReflection`.

    Returns
    -------
    ReflectedLight
        In the environment's colour space.
    """
    return EnvironmentReflection(table, environment.colour_space, size, filter)(environment, frame)


def hemisphere(environment: Environment, frame: ArrayLike, size: int = 1023) -> HemisphereMap:
    """Lay the light above a flat sample on a plane of direction cosines, all of its energy.

    Each pixel is cut into patches that are finer than the plane; each patch's energy is shared among the
    sixteen samples around it so that sum, mean place and spread are kept (Keys' cubic, 1981, eq. 15).

    Parameters
    ----------
    environment : Environment
        The light.
    frame : array_like, shape (3, 3)
        Tangent, bitangent and normal of the sample in the world.
    size : int
        Samples across the disc; an even count is lowered by one.

    Returns
    -------
    HemisphereMap
        Its sum is the irradiance.
    """
    samples, step = plane_of(size)
    return HemisphereMap(laid_out(environment, frame, (samples, samples), step), step)


def laid_out(
    environment: Environment,
    frame: ArrayLike,
    counts: tuple[int, int],
    step: float,
    centre: ArrayLike = (0.0, 0.0),
) -> NDArray[np.float32]:
    """Lay the light above a flat sample on any plane of direction cosines, what falls on it.

    Parameters
    ----------
    environment : Environment
        The light.
    frame : array_like, shape (3, 3)
        Tangent, bitangent and normal of the sample in the world.
    counts : tuple of int
        Samples of the plane (rows, columns).
    step : float
        Between samples, in direction cosines.
    centre : array_like, shape (2,)
        Direction cosines of its sample (rows // 2, columns // 2).

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Integral of radiance over direction cosines about each sample.
    """
    axes, middle = frame_checked(frame), np.asarray(centre, dtype=np.float64)
    radiance = np.ascontiguousarray(environment.radiance, dtype=np.float32)
    rows = len(radiance)
    parts = max(1, int(np.ceil(1.5 * np.pi / rows / refuse.positive("step", step))))
    plane = np.zeros((*counts, 3))
    _kernels_environment.lay_rows(radiance, (0, rows), parts, axes, middle, step, plane)
    return plane.astype(np.float32)


def directions(
    environment: Environment, frame: ArrayLike, parts: int
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64], int]]:
    """Sample the light above a flat sample, a block of directions at a time.

    Parameters
    ----------
    environment : Environment
        The light.
    frame : array_like, shape (3, 3)
        Tangent, bitangent and normal of the sample in the world.
    parts : int
        Each pixel is cut into parts² patches of equal height and width.

    Yields
    ------
    places : ndarray of float64, shape (N, 2)
        Direction cosines along tangent and bitangent; the arrays are written anew for each block.
    energies : ndarray of float64, shape (N, 3)
        Radiance times solid angle times cosine.
    count : int
        How many of the N are filled.
    """
    axes = frame_checked(frame)
    radiance = np.ascontiguousarray(environment.radiance, dtype=np.float32)
    rows, columns, _ = radiance.shape
    block = max(1, SAMPLES_AT_ONCE // (columns * parts**2))
    most = min(block, rows) * columns * parts**2
    places, energies = np.empty((most, 2)), np.empty((most, 3))
    for first in range(0, rows, block):
        strip = radiance[first : first + block]
        count = _kernels_environment.sample_rows(strip, (first, rows), parts, axes, places, energies)
        if count:
            yield places, energies, count


def environment_from_picture(picture: Picture, name: str = "environment") -> Environment:
    """Take a latitude-longitude picture as light from all around.

    Parameters
    ----------
    picture : Picture
        Twice as wide as high; row 0 is up. Alpha is left out.
    name : str
        What to call it.

    Returns
    -------
    Environment
        In the picture's colour space; values below zero are black.

    Raises
    ------
    refuse.Refusal
        Where the picture is not twice as wide as high, or holds NaN or infinity.
    """
    rows, columns = picture.pixels.shape[:2]
    if columns != 2 * rows:
        raise refuse.Refusal(
            f"A latitude-longitude picture must be twice as wide as high, got {columns} x {rows} pixels."
        )
    pixels = refuse.all_finite("picture", picture.pixels)[..., :3]
    if pixels.shape[2] == 1:
        pixels = np.repeat(pixels, 3, axis=2)
    return Environment(np.maximum(pixels, 0).astype(np.float32), picture.colour_space, name)


def in_space(environment: Environment, colour_space: str) -> Environment:
    """Convert light from all around to another linear RGB space.

    Parameters
    ----------
    environment : Environment
        The light.
    colour_space : str
        One of the names in `aureole.light.SPACES`.

    Returns
    -------
    Environment
        The same light.
    """
    if colour_space == environment.colour_space:
        return environment
    picture = light.convert(Picture(environment.radiance, environment.colour_space), colour_space)
    return Environment(picture.pixels, colour_space, environment.name)


def rotated(environment: Environment, axes: ArrayLike) -> Environment:
    """Turn light from all around.

    Parameters
    ----------
    environment : Environment
        The light.
    axes : array_like, shape (3, 3)
        Where its own x, y and z axis come to lie in the world, a row each: at right angles, right-handed.

    Returns
    -------
    Environment
        Each pixel the mean of what lies behind sixteen even parts of it; a turn about y by whole columns
        is exact.

    Raises
    ------
    refuse.Refusal
        Where the axes are not as described.
    """
    turn = frame_checked(axes)
    if np.linalg.det(turn) < 0:
        raise refuse.Refusal("'axes' must be right-handed: a turn does not mirror light.")
    rows, columns = environment.radiance.shape[:2]
    row, column = (np.arange(TURNED_PARTS * count) + 0.5 for count in (rows, columns))
    latitude = np.pi / 2 - np.pi * row / (TURNED_PARTS * rows)
    longitude = 2 * np.pi * column / (TURNED_PARTS * columns) - np.pi
    found = np.zeros(environment.radiance.shape)
    for part in range(TURNED_PARTS):
        up = latitude[part::TURNED_PARTS, None]
        along = np.broadcast_arrays(
            np.cos(up) * np.sin(longitude), np.sin(up), -np.cos(up) * np.cos(longitude)
        )
        x, y, z = np.tensordot(turn, np.stack(along), axes=1)
        i = (np.arccos(np.clip(y, -1, 1)) / np.pi * rows).astype(np.int64)
        j = ((np.arctan2(x, -z) / (2 * np.pi) + 0.5) * columns).astype(np.int64)
        seen = environment.radiance[np.minimum(i, rows - 1), j % columns]
        found += seen.reshape(rows, columns, TURNED_PARTS, 3).mean(axis=2) / TURNED_PARTS
    return Environment(found.astype(np.float32), environment.colour_space, environment.name)


def frame_of(normal: ArrayLike, tangent: ArrayLike, turn: float = 0.0) -> NDArray[np.float64]:
    """Make a sample's frame from its normal and a tangent.

    Parameters
    ----------
    normal : array_like, shape (3,)
        Out of the surface; any length.
    tangent : array_like, shape (3,)
        Its part along the normal is taken off.
    turn : float
        Radians by which the sample is turned about its normal, positive from tangent to bitangent.

    Returns
    -------
    ndarray of float64, shape (3, 3)
        Rows: tangent, bitangent = normal × tangent, normal; unit vectors.

    Raises
    ------
    refuse.Refusal
        Where one is zero, or both are parallel.
    """
    up = refuse.all_finite("normal", refuse.shape_of("normal", normal, (3,))).astype(np.float64)
    along = refuse.all_finite("tangent", refuse.shape_of("tangent", tangent, (3,))).astype(np.float64)
    if not np.any(up):
        raise refuse.Refusal("'normal' must not be zero.")
    up /= np.linalg.norm(up)
    flat = along - (along @ up) * up
    if np.linalg.norm(flat) <= 1e-9 * np.linalg.norm(along):
        raise refuse.Refusal("'tangent' must not be zero or along 'normal'.")
    flat /= np.linalg.norm(flat)
    across = np.cross(up, flat)
    cosine, sine = np.cos(refuse.finite("turn", turn)), np.sin(turn)
    return np.stack([cosine * flat + sine * across, cosine * across - sine * flat, up])


def frame_checked(frame: ArrayLike) -> NDArray[np.float64]:
    """Refuse a frame that is not three unit vectors at right angles.

    Parameters
    ----------
    frame : array_like, shape (3, 3)
        Rows: tangent, bitangent, normal.

    Returns
    -------
    ndarray of float64, shape (3, 3)
        The frame.
    """
    axes = refuse.all_finite("frame", refuse.shape_of("frame", frame, (3, 3))).astype(np.float64)
    if not np.allclose(axes @ axes.T, np.eye(3), atol=1e-6):
        raise refuse.Refusal(
            "'frame' must be three unit vectors at right angles (tangent, bitangent, normal)."
        )
    return axes


def directions_checked(name: str, places: ArrayLike) -> NDArray[np.float64]:
    """Refuse direction cosines of no direction above the surface.

    Parameters
    ----------
    name : str
        The parameter's public name.
    places : array_like, shape (..., 2)
        Along tangent and bitangent.

    Returns
    -------
    ndarray of float64, shape (..., 2)
        The same.
    """
    found = refuse.all_finite(name, places).astype(np.float64)
    if found.ndim == 0 or found.shape[-1] != 2:
        raise refuse.Refusal(f"'{name}' must have 2 direction cosines in its last axis, got {found.shape}.")
    longest = float(np.sqrt((found**2).sum(axis=-1)).max(initial=0.0))
    if longest > 1 + 1e-9:
        raise refuse.Refusal(f"'{name}' must be direction cosines of length <= 1, got {longest:.6g}.")
    return found


def plane_of(size: int) -> tuple[int, float]:
    """Return the odd number of samples and the step of a plane that holds the disc of directions.

    Parameters
    ----------
    size : int
        Samples across, margins included; an even count is lowered by one.

    Returns
    -------
    samples : int
        Odd, so that the normal is a sample.
    step : float
        Between them, in direction cosines.
    """
    samples = refuse.at_least("size", size, 16) - (size + 1) % 2
    return samples, 1.0 / (samples // 2 - MARGIN)


def _cubic(plane: NDArray[np.float32], x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float32]:
    """Catmull-Rom interpolation of a plane at columns x and rows y."""
    j, i = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    total = np.zeros((*x.shape, plane.shape[2]))
    for a, down in enumerate(_weights(y - i)):
        for b, right in enumerate(_weights(x - j)):
            total += (down * right)[..., None] * plane[i + a - 1, j + b - 1]
    return total.astype(np.float32)


def _weights(t: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    return (
        t * (-0.5 + t * (1.0 - 0.5 * t)),
        1.0 + t * t * (-2.5 + 1.5 * t),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        t * t * (-0.5 + 0.5 * t),
    )
