"""Light from all around in a picture: what every sample of a shape sends to the eye from its surroundings."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from aureole.surface.environment import Environment, EnvironmentReflection, ReflectedLight, in_space
from aureole.surface.shading import Shader, map_places
from aureole.surface.shapes import Seen
from aureole.surface.surroundings import environment_light, irradiance, mirror_light, surroundings

_REFLECTION = 1023  # samples across the disc of directions


class Around:
    """A shader's surface in light from all around, made ready for many frames.

    Flat shapes have their diffraction exactly, by one correlation for all views; the others by the table's
    cells. Diffuse and mirror-like parts are the same on all.

    Parameters
    ----------
    prepared : Shader
        The surface.
    environment : Environment
        The light; multiplied with the first light's tables in the shader's colour space.
    samples : int
        Cells that a table is cut into where a shape is not flat.
    """

    def __init__(self, prepared: Shader, environment: Environment, samples: int) -> None:
        self._prepared, self._samples = prepared, samples
        self._light = in_space(environment, prepared.colour_space)
        self._blurred = surroundings(self._light)
        self._reflections: tuple[EnvironmentReflection, ...] = ()
        self._frame, self._reflected = np.zeros((3, 3)), list[ReflectedLight]()

    def __call__(self, seen: Seen, flat: bool, side: int = 1) -> NDArray[np.float32]:
        """Return what reaches the eye.

        Parameters
        ----------
        seen : Seen
            What is seen, tangents turned already.
        flat : bool
            Whether all samples have one normal and one tangent.
        side : int
            Samples along a pixel's side. Lobes are found for one of a pixel's samples and stand for all.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 3)
            Radiance in the shader's colour space; 0 where there is no surface.
        """
        made_of = self._prepared.material
        out = np.zeros((*seen.hit.shape, 3), dtype=np.float32)
        if not seen.hit.any():
            return out
        diffuse = np.broadcast_to(np.asarray(made_of.diffuse, dtype=np.float32), (3,))
        specular = np.broadcast_to(np.asarray(made_of.specular, dtype=np.float32), (3,))
        if diffuse.any():
            out += diffuse / np.float32(np.pi) * irradiance(seen, self._blurred)
        if specular.any():
            one, whole = _one_a_pixel(seen, side)
            out += specular * whole(
                mirror_light(one, self._blurred, made_of.roughness, self._prepared.fresnel)
            )
        if made_of.diffraction > 0:
            row, column = map_places(seen.frames, self._prepared.mask)
            strength = np.float32(made_of.diffraction) * self._prepared.mask[row, column]
            plain = made_of.geometry == "one" and made_of.window is None
            if flat and plain:
                out += strength[..., None] * self._of_flat(seen)
            else:
                one, whole = _one_a_pixel(seen, side if self._prepared.regions.size == 1 else 1)
                out += strength[..., None] * whole(self._of_cells(one))
        return out

    def _of_cells(self, seen: Seen) -> NDArray[np.float32]:
        """Diffraction, cell by cell of the tables."""
        prepared, made_of = self._prepared, self._prepared.material
        row, column = map_places(seen.frames, prepared.regions)
        return environment_light(
            seen,
            prepared.sources,
            self._blurred,
            self._samples,
            prepared.fresnel,
            made_of.geometry,
            made_of.window,
            prepared.regions[row, column],
        )

    def _of_flat(self, seen: Seen) -> NDArray[np.float32]:
        """Diffraction of one frame, by correlation; F² is that of the mirror's angle, before the integral."""
        prepared = self._prepared
        first = np.argmax(seen.hit.ravel())
        axes = (part.reshape(-1, 3)[first] for part in (seen.tangents, seen.bitangents, seen.normals))
        frame = _orthonormal(np.stack(list(axes)).astype(np.float64))
        cosines = seen.outward.astype(np.float64) @ frame.T
        row, column = map_places(seen.frames, prepared.regions)
        which = prepared.regions[row, column]
        out = np.zeros((*seen.hit.shape, 3), dtype=np.float32)
        for number, reflected in enumerate(self._towards_all(frame)):
            here = seen.hit & (which == number) & (cosines[..., 2] > 0)
            views = cosines[here][:, :2]
            views /= np.maximum(1.0, np.linalg.norm(views, axis=1, keepdims=True))
            out[here] = reflected.towards(views)
        table = prepared.fresnel
        at = np.clip(cosines[..., 2], 0.0, 1.0) * (len(table) - 1)
        mirror = np.stack([np.interp(at, np.arange(len(table)), table[:, k]) for k in range(3)], axis=-1)
        return np.asarray(out * mirror**2, dtype=np.float32)

    def _towards_all(self, frame: NDArray[np.float64]) -> list[ReflectedLight]:
        """Reflect the light off a flat sample, once for all pictures of it in one pose."""
        if not self._reflections:
            space, tables = self._prepared.colour_space, self._prepared.sources
            self._reflections = tuple(EnvironmentReflection(table, space, _REFLECTION) for table in tables)
        if not np.array_equal(frame, self._frame):
            self._frame = frame
            self._reflected = [reflection(self._light, frame) for reflection in self._reflections]
        return self._reflected


def _one_a_pixel(seen: Seen, side: int) -> tuple[Seen, Callable[[NDArray[np.float32]], NDArray[np.float32]]]:
    """Take one sample of each pixel, and say how its light becomes that of all that are seen."""
    rows, columns, width = seen.frames.shape
    if side == 1:
        return seen, lambda light: light
    blocks = seen.frames.reshape(rows // side, side, columns // side, side, width).swapaxes(1, 2)
    blocks = blocks.reshape(rows // side, columns // side, side * side, width)
    # The one in the middle where it is seen, else the first that is.
    middle = (side // 2) * (side + 1)
    number = np.where(blocks[:, :, middle, 0] > 0, middle, np.argmax(blocks[..., 0] > 0, axis=2))
    taken = np.take_along_axis(blocks, number[:, :, None, None], axis=2)[:, :, 0]

    def whole(light: NDArray[np.float32]) -> NDArray[np.float32]:
        return light.repeat(side, axis=0).repeat(side, axis=1) * seen.hit[..., None]

    return Seen(np.ascontiguousarray(taken)), whole


def _orthonormal(frame: NDArray[np.float64]) -> NDArray[np.float64]:
    """Take off what rounding to single precision has left of angles that are not right."""
    normal = frame[2] / np.linalg.norm(frame[2])
    tangent = frame[0] - (frame[0] @ normal) * normal
    tangent /= np.linalg.norm(tangent)
    across = np.cross(normal, tangent)
    return np.stack([tangent, across * np.sign(across @ frame[1]), normal])
