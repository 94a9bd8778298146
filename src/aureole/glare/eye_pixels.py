"""Where the pixels of an eye's picture lie in angle, and what falls into them.

"angle": equal angles a pixel, all the way to any side (equidistant). "perspective": as a picture has them,
the tangent of the angle grows evenly.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.aperture.bands import in_bands
from aureole.glare.eye_wave import Level, Wave

PROJECTIONS = ("angle", "perspective")
# Pixels so near the axis are divided along both sides, those about it into more parts.
STEEP, PARTS, MOST_PARTS = 16, 6, 240
RIGHT_ANGLE = math.pi / 2


@dataclass(frozen=True)
class Frame:
    """The pixels of a picture about the axis.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns); the axis is the middle of the pixel (rows//2, columns//2).
    field_of_view : float
        Radians across the columns.
    projection : str
        One of `PROJECTIONS`.
    """

    shape: tuple[int, int]
    field_of_view: float
    projection: str = "angle"

    @classmethod
    def checked(cls, shape: tuple[int, int], field_of_view: float, projection: str) -> "Frame":
        """Return the frame, or refuse numbers outside their ranges."""
        refuse.shape_of("shape", shape, (2,))
        for name, count in zip(("rows", "columns"), shape, strict=True):
            refuse.at_least(name, count, 1)
        refuse.one_of("projection", projection, PROJECTIONS)
        refuse.positive("field_of_view", field_of_view)
        widest = math.pi if projection == "angle" else math.radians(170)
        if field_of_view > widest * (1 + 1e-9):
            raise refuse.Refusal(
                f"'field_of_view' must be at most {math.degrees(widest):g} degrees for projection "
                f"'{projection}', got {math.degrees(field_of_view):g}."
            )
        return cls((int(shape[0]), int(shape[1])), float(field_of_view), projection)

    @property
    def step(self) -> float:
        """Size of the pixel on the axis, radians."""
        if self.projection == "angle":
            return self.field_of_view / self.shape[1]
        return 2 * math.tan(self.field_of_view / 2) / self.shape[1]

    @property
    def farthest(self) -> float:
        """Angle of the corner farthest from the axis, at most a right angle."""
        corner = math.hypot(*(count // 2 + 0.5 for count in self.shape)) * self.step
        return min(corner, RIGHT_ANGLE) if self.projection == "angle" else math.atan(corner)

    def direction_cosines(
        self, y: NDArray[np.float64], x: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the direction cosines (along y, along x) of places in pixels from the axis."""
        down, right = y * self.step, x * self.step
        if self.projection == "angle":
            scale = np.sinc(np.minimum(np.hypot(down, right), RIGHT_ANGLE) / np.pi)
        else:
            scale = 1 / np.sqrt(1 + down**2 + right**2)
        return down * scale, right * scale

    def angles(
        self, y: NDArray[np.float64], x: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return angles to the axis and the solid angle of a pixel at places in pixels from the axis."""
        radius = np.hypot(y, x) * self.step
        if self.projection == "angle":
            # Behind the eye there is no light.
            seen = radius <= RIGHT_ANGLE
            return np.minimum(radius, RIGHT_ANGLE), self.step**2 * np.sinc(radius / np.pi) * seen
        angle = np.arctan(radius)
        return angle, self.step**2 * np.cos(angle) ** 3


def add_wave(
    wave: Wave,
    frame: Frame,
    wavelengths: NDArray[np.float64],
    weights: NDArray[np.float64],
    core_gains: NDArray[np.float64],
    out: NDArray[np.float32],
) -> None:
    """Add a wave's energy in each pixel, at many wavelengths.

    Parameters
    ----------
    wave : Wave
        From `wave_of`.
    frame : Frame
        The pixels.
    wavelengths : ndarray of float64, shape (K,)
        Metres.
    weights : ndarray of float64, shape (K, 3)
        Of each wavelength, by channel.
    core_gains : ndarray of float64, shape (K,)
        Factors on the part about the axis.
    out : ndarray of float32, shape (rows, columns, 3)
        Added to.
    """
    reach = math.asin(min(1.0, wave.fade[1] * float(wavelengths.max())))
    for level in wave.levels:
        gains = core_gains[:, None] if level.is_core else 1.0
        extent = level.spacing * level.origin[0] * math.sqrt(2) * float(wavelengths.max())
        angle = min(reach, math.asin(min(1.0, extent)))
        _add_level(level, frame, angle, wavelengths, weights * gains, out)


def radial_energies(
    frame: Frame, angles: NDArray[np.float64], density: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Integrate a function of the angle over each pixel.

    Parameters
    ----------
    frame : Frame
        The pixels.
    angles : ndarray of float64, shape (N,)
        Radians, rising.
    density : ndarray of float64, shape (N, 3)
        1 / steradian, joined by straight lines; what lies before the first angle is as at it.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Energy in each pixel.
    """
    down, right = (np.arange(count // 2 + 1, dtype=np.float64) for count in frame.shape)
    quarter = _at_places(frame, down, right, angles, density)
    # The nearer to the axis, the steeper the veil and the finer the parts.
    finest = math.ceil(4 * frame.step / angles[0])
    for reach, parts in ((STEEP, PARTS), (2, min(max(finest, PARTS), MOST_PARTS))):
        middles = (np.arange(parts) + 0.5) / parts - 0.5
        near_y, near_x = down[:reach], right[:reach]
        fine_y, fine_x = ((axis[:, None] + middles).ravel() for axis in (near_y, near_x))
        fine = _at_places(frame, fine_y, fine_x, angles, density)
        blocks = fine.reshape(len(near_y), parts, len(near_x), parts, 3)
        quarter[: len(near_y), : len(near_x)] = blocks.mean(axis=(1, 3))
    rows, columns = (np.abs(np.arange(count) - count // 2) for count in frame.shape)
    return np.asarray(quarter[rows[:, None], columns].astype(np.float32))


def _at_places(
    frame: Frame,
    y: NDArray[np.float64],
    x: NDArray[np.float64],
    angles: NDArray[np.float64],
    density: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the energy of a whole pixel with the density at places (R,) and (C,)."""
    angle, area = frame.angles(y[:, None], x[None, :])
    values = [np.interp(angle.ravel(), angles, channel).reshape(angle.shape) for channel in density.T]
    return np.stack(values, axis=2) * area[..., None]


def _add_level(
    level: Level,
    frame: Frame,
    reach: float,
    wavelengths: NDArray[np.float64],
    weights: NDArray[np.float64],
    out: NDArray[np.float32],
) -> None:
    """Add the energy of one level in the pixels that it reaches."""
    from aureole.glare import _kernels_eye  # compiled code: loaded when first used

    lengths = frame.step if frame.projection == "angle" else math.cos(min(reach, 1.5)) * frame.step
    pixels = math.ceil(reach / lengths) + 1
    down, right = (min(count // 2, pixels) for count in frame.shape)
    y = np.arange(-down, down + 1, dtype=np.float64)[:, None]
    x = np.arange(0 if level.is_half else -right, right + 1, dtype=np.float64)[None, :]
    edges_y = np.arange(-down, down + 2, dtype=np.float64)[:, None] - 0.5
    edges_x = np.arange(x[0, 0], right + 2)[None, :] - 0.5
    along_y, along_x = frame.direction_cosines(edges_y, x)[0], frame.direction_cosines(y, edges_x)[1]
    if level.is_half:
        along_x[:, 0] = 0.0
    part = np.zeros((y.size, x.size, 3), dtype=np.float32)
    numbers = 1 / (wavelengths * level.spacing), weights.astype(np.float32)
    arguments = level.table, *level.origin, *numbers, along_y, along_x, part
    in_bands(lambda low, high: _kernels_eye.add_pixels(low, high, *arguments), y.size)
    if level.is_half:
        # The other half is this one turned by 180 degrees.
        part[:, 0] += part[::-1, 0]
        part = np.concatenate([part[::-1, :0:-1], part], axis=1)
    rows, columns = frame.shape
    after_y, after_x = min(down, rows - 1 - rows // 2), min(right, columns - 1 - columns // 2)
    window = out[
        rows // 2 - down : rows // 2 + after_y + 1, columns // 2 - right : columns // 2 + after_x + 1
    ]
    window += part[: down + after_y + 1, : right + after_x + 1]
