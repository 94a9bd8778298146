"""From a photograph's pixels to h = ω_i + ω_o, by where camera and lamp stand.

Two geometries answer the same question. `BenchGeometry` knows distances and tilt, and follows each
pixel's ray to the sample; the lamp stands where the sample's mirror shows it at the zero order.
`UniformGeometry` is a photograph whose pixels lie evenly in h.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import refuse

Numbers = NDArray[np.float64]
Place = tuple[float, float]

STEEPEST = math.radians(80.0)
_KNOTS = 65  # of the map from h to pixels, along each axis
_NEWTON_STEPS = 8


@dataclass(frozen=True)
class UniformGeometry:
    """A photograph of a sample whose pixels lie evenly in h, as one from far away does.

    It runs against h: further right on a sample lamp and eye lie further left. A picture
    that is laid out over h itself, h · t to the right and h · b up, has rotation = π.

    Parameters
    ----------
    h_per_pixel : float
        Step of h from one pixel to the next.
    rotation : float
        Radians, counter-clockwise on the photograph from its right to the surface's tangent t.
    """

    h_per_pixel: float
    rotation: float = 0.0

    def h_of(
        self, rows: Numbers, columns: Numbers, centre: Place, shape: tuple[int, int]
    ) -> tuple[Numbers, Numbers, Numbers]:
        """Return h · t, h · b and a relative irradiance of 1, at pixels.

        Parameters
        ----------
        rows, columns : ndarray of float64
            Pixels, broadcast against each other.
        centre : tuple of float
            The zero order's (row, column).
        shape : tuple of int
            (rows, columns) of the photograph; not needed.

        Returns
        -------
        h_t, h_b, irradiance : ndarray of float64
            Of one shape.

        Raises
        ------
        refuse.Refusal
            Where the step is not positive.
        """
        step = refuse.positive("h_per_pixel", self.h_per_pixel)
        turn = refuse.finite("rotation", self.rotation)
        x, y = np.broadcast_arrays(step * (centre[1] - columns), step * (rows - centre[0]))
        h_t = math.cos(turn) * x + math.sin(turn) * y
        h_b = math.cos(turn) * y - math.sin(turn) * x
        return h_t, h_b, np.ones_like(h_t)


@dataclass(frozen=True)
class BenchGeometry:
    """A pinhole camera and a small lamp at finite distances from a flat sample.

    Parameters
    ----------
    camera_distance : float
        Metres along the optical axis, from the lens's entrance pupil to the sample.
    lamp_distance : float
        Metres from the lamp to the zero order's place on the sample; math.inf is a lamp far away.
    pixel_scale : float
        Metres that a pixel spans across the axis at the sample's distance.
    tilt : tuple of float
        Radians (α, β) by which the sample's normal leans up and to the right as the camera sees it:
        the normal is along (tan β, tan α, 1).
    rotation : float
        Radians, counter-clockwise on the photograph from its right to the surface's tangent t.
    axis : tuple of float or None
        The optical axis's pixel (row, column); None is the photograph's middle.
    """

    camera_distance: float
    lamp_distance: float
    pixel_scale: float
    tilt: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    axis: Place | None = None

    def h_of(
        self, rows: Numbers, columns: Numbers, centre: Place, shape: tuple[int, int]
    ) -> tuple[Numbers, Numbers, Numbers]:
        """Return h · t, h · b and the irradiance relative to the zero order's, at pixels.

        Parameters
        ----------
        rows, columns : ndarray of float64
            Pixels, broadcast against each other.
        centre : tuple of float
            The zero order's (row, column), from which the lamp's direction follows.
        shape : tuple of int
            (rows, columns) of the photograph.

        Returns
        -------
        h_t, h_b, irradiance : ndarray of float64
            Of one shape; irradiance is cos θ_i / r² over its value at the zero order.

        Raises
        ------
        refuse.Refusal
            Where a distance is not positive, the tilt is too steep, or a pixel does not see the sample.
        """
        tangent, bitangent, normal = self._frame()
        camera = np.array([0.0, 0.0, refuse.positive("camera_distance", self.camera_distance)])
        rows, columns = np.broadcast_arrays(rows, columns)
        points = self._hits(rows, columns, camera, normal, shape)
        start = self._hits(np.asarray(centre[0]), np.asarray(centre[1]), camera, normal, shape)
        # The mirror's law at the zero order gives the lamp's direction.
        seen = _unit(camera - start)
        towards_lamp = 2.0 * (seen @ normal) * normal - seen
        incoming, spread = self._lamp(points, start, towards_lamp)
        h = incoming + _unit(camera - points)
        cosine = (incoming @ normal) / float(towards_lamp @ normal)
        return h @ tangent, h @ bitangent, cosine * spread

    def _frame(self) -> tuple[Numbers, Numbers, Numbers]:
        """Return the sample's tangent, bitangent and normal as the camera sees them: right, up, backward."""
        for name, angle in zip(("up", "right"), self.tilt, strict=True):
            if abs(refuse.finite("tilt", angle)) > STEEPEST:
                raise refuse.Refusal(
                    f"'tilt' must lie within {math.degrees(STEEPEST):.0f}°, got"
                    f" {math.degrees(angle):.4g}° ({name})."
                )
        turn = refuse.finite("rotation", self.rotation)
        normal = _unit(np.array([math.tan(self.tilt[1]), math.tan(self.tilt[0]), 1.0]))
        level = _unit(np.array([1.0, 0.0, 0.0]) - normal[0] * normal)
        upright = np.cross(normal, level)
        tangent = math.cos(turn) * level + math.sin(turn) * upright
        return tangent, np.cross(normal, tangent), normal

    def _hits(
        self, rows: Numbers, columns: Numbers, camera: Numbers, normal: Numbers, shape: tuple[int, int]
    ) -> Numbers:
        """Follow pixels' rays to the sample."""
        scale = refuse.positive("pixel_scale", self.pixel_scale)
        axis = self.axis or ((shape[0] - 1) / 2.0, (shape[1] - 1) / 2.0)
        across = np.stack(
            [scale * (columns - axis[1]), scale * (axis[0] - rows), np.zeros(np.shape(rows))], axis=-1
        )
        height = float(normal @ camera)
        fall = height - across @ normal
        if not np.all(fall > 1e-6 * height):
            raise refuse.Refusal(
                "'tilt' is too steep for this 'camera_distance' and 'pixel_scale':"
                " some pixels would look past the sample's horizon."
            )
        return np.asarray(camera + (height / fall)[..., None] * (across - camera))

    def _lamp(self, points: Numbers, start: Numbers, towards: Numbers) -> tuple[Numbers, Numbers]:
        """Return unit vectors from points to the lamp, and 1 / r² over its value at the start."""
        if self.lamp_distance == math.inf:
            return np.broadcast_to(towards, points.shape), np.ones(points.shape[:-1])
        distance = refuse.positive("lamp_distance", self.lamp_distance)
        path = start + distance * towards - points
        return _unit(path), distance**2 / np.sum(path**2, axis=-1)


# What turns pixels into h.
Geometry = BenchGeometry | UniformGeometry


def pixels_at(
    geometry: Geometry, centre: Place, shape: tuple[int, int], h_t: Numbers, h_b: Numbers
) -> tuple[Numbers, Numbers]:
    """Find the pixels that see given h, by Newton's method.

    Parameters
    ----------
    geometry : Geometry
        Where camera and lamp stand.
    centre : tuple of float
        The zero order's (row, column).
    shape : tuple of int
        (rows, columns) of the photograph.
    h_t, h_b : ndarray of float64
        Of one shape.

    Returns
    -------
    rows, columns : ndarray of float64
        Fractions of pixels, outside the photograph too.
    """
    across = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    at = geometry.h_of(centre[0] + across[0], centre[1] + across[1], centre, shape)
    slopes = np.array([[part[k] - part[0] for k in (1, 2)] for part in at[:2]])
    first = np.linalg.solve(slopes, np.stack([h_t.ravel(), h_b.ravel()]))
    rows, columns = centre[0] + first[0], centre[1] + first[1]
    for _ in range(_NEWTON_STEPS):
        here = geometry.h_of(rows, columns, centre, shape)
        down = geometry.h_of(rows + 0.5, columns, centre, shape)
        right = geometry.h_of(rows, columns + 0.5, centre, shape)
        a, b = 2.0 * (down[0] - here[0]), 2.0 * (right[0] - here[0])
        c, d = 2.0 * (down[1] - here[1]), 2.0 * (right[1] - here[1])
        miss_t, miss_b = h_t.ravel() - here[0], h_b.ravel() - here[1]
        determinant = a * d - b * c
        step_row = (d * miss_t - b * miss_b) / determinant
        step_column = (a * miss_b - c * miss_t) / determinant
        rows, columns = rows + step_row, columns + step_column
        if max(np.abs(step_row).max(), np.abs(step_column).max()) < 1e-7:
            break
    return rows.reshape(h_t.shape), columns.reshape(h_t.shape)


def pixel_map(
    geometry: Geometry, centre: Place, shape: tuple[int, int], axis: Numbers
) -> tuple[Numbers, Numbers, Numbers]:
    """Find the pixels that see a uniform square grid of h: exactly at knots, smoothly between.

    Parameters
    ----------
    geometry : Geometry
        Where camera and lamp stand.
    centre : tuple of float
        The zero order's (row, column).
    shape : tuple of int
        (rows, columns) of the photograph.
    axis : ndarray of float64, shape (N,)
        Values of h · t along columns, rising; h · b falls through them along rows.

    Returns
    -------
    rows, columns, irradiance : ndarray of float64, shape (N, N)
        Fractions of pixels, and the irradiance there relative to the zero order's.
    """
    from scipy.interpolate import RectBivariateSpline

    knots = np.linspace(axis[0], axis[-1], min(_KNOTS, axis.size))
    h_b, h_t = np.meshgrid(knots, knots, indexing="ij")
    rows, columns = pixels_at(geometry, centre, shape, h_t, h_b)
    irradiance = geometry.h_of(rows, columns, centre, shape)[2]
    degree = min(3, knots.size - 1)
    maps = [
        RectBivariateSpline(knots, knots, part, kx=degree, ky=degree)(axis, axis)[::-1]
        for part in (rows, columns, irradiance)
    ]
    return maps[0], maps[1], maps[2]


def farthest_h(geometry: Geometry, centre: Place, shape: tuple[int, int]) -> tuple[float, float]:
    """Measure the square of h that a photograph covers, and the step of h at its centre.

    Parameters
    ----------
    geometry : Geometry
        Where camera and lamp stand.
    centre : tuple of float
        The zero order's (row, column).
    shape : tuple of int
        (rows, columns) of the photograph.

    Returns
    -------
    farthest, step : float
        The largest |h · t| or |h · b| on the photograph's rim, and the smaller step between the
        central pixels along rows and columns.
    """
    rows, columns = np.arange(shape[0], dtype=float), np.arange(shape[1], dtype=float)
    rim = [
        np.concatenate([rows, rows, np.zeros(shape[1]), np.full(shape[1], shape[0] - 1.0)]),
        np.concatenate([np.zeros(shape[0]), np.full(shape[0], shape[1] - 1.0), columns, columns]),
    ]
    h_t, h_b, _ = geometry.h_of(rim[0], rim[1], centre, shape)
    near = geometry.h_of(
        centre[0] + np.array([0.0, 1.0, 0.0]), centre[1] + np.array([0.0, 0.0, 1.0]), centre, shape
    )
    steps = [math.hypot(near[0][k] - near[0][0], near[1][k] - near[1][0]) for k in (1, 2)]
    return float(max(np.abs(h_t).max(), np.abs(h_b).max())), min(steps)


def _unit(vectors: Numbers) -> Numbers:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
