"""Light from all around on a flat sample, towards a camera's part of the views, with orders resolved.

The orders of a display lie 0.007 apart and are far narrower, finer than a plane of all directions can be.
Here the table is split by a smooth weight: what lies within a short reach of h = 0, where the sharp orders
are, is correlated on a fine plane about the camera's views; the rest on a coarse plane of all directions.

In: a table and where the camera looks; then an environment and a frame; out: light towards those views.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import light, picture, refuse
from aureole.picture.convolution import Convolver
from aureole.surface.environment import (
    FOUR_PI_SQUARED,
    MARGIN,
    Environment,
    EnvironmentReflection,
    ReflectedLight,
    directions_checked,
    in_space,
    laid_out,
)
from aureole.surface.resampling import on_even_steps
from aureole.surface.table import ScatterTable, rgb

WHOLE = 0.6  # of the reach: nearer than that all of the table is on the fine plane
BYTES = 3 * 4 * 10  # a sample of the fine plane: three channels, copies and transforms of them


@dataclass(frozen=True, eq=False)
class CloseLight:
    """What a flat sample sends towards a part of the views.

    Parameters
    ----------
    fine, coarse : ReflectedLight
        Two parts that are added: from near h = 0, about the views, and from the rest, towards all.
    """

    fine: ReflectedLight
    coarse: ReflectedLight

    def towards(self, views: ArrayLike) -> NDArray[np.float32]:
        """Look up the light that leaves towards some views.

        Parameters
        ----------
        views : array_like, shape (..., 2)
            Their direction cosines along tangent and bitangent, within the part that was asked for.

        Returns
        -------
        ndarray of float32, shape (..., 3)
            Radiance, cubic between samples.

        Raises
        ------
        refuse.Refusal
            Where a view lies outside.
        """
        return self.fine.towards(views) + self.coarse.towards(views)


class CloseReflection:
    """A table made ready to meet light from all around, towards a part of the views.

    Parameters
    ----------
    table : ScatterTable
        Of the sample.
    centre : array_like, shape (2,)
        Direction cosines of the middle of the views along tangent and bitangent.
    half_width : float
        How far the views reach from there along each axis, in direction cosines.
    step : float
        Of the fine plane, in direction cosines.
    reach : float
        h within which the table is on the fine plane.
    colour_space : str
        RGB space to multiply in; lights are converted to it.
    size : int
        Samples across the coarse plane of all directions.
    precision : str
        As for `EnvironmentReflection`.
    threads : int, optional
        How many to use; by default one for each processor.

    Raises
    ------
    refuse.Refusal
        Where a number is out of range, or the fine plane would not fit in memory.
    """

    def __init__(
        self,
        table: ScatterTable,
        centre: ArrayLike,
        half_width: float,
        step: float = 2.5e-4,
        reach: float = 0.1,
        colour_space: str = "rec709",
        size: int = 1023,
        precision: str = "single",
        threads: int | None = None,
    ) -> None:
        refuse.one_of("colour_space", colour_space, light.SPACES)
        middle = directions_checked("centre", refuse.shape_of("centre", centre, (2,)))
        self.centre = float(middle[0]), float(middle[1])
        self.step, self.reach = refuse.positive("step", step), refuse.positive("reach", reach)
        around = int(np.ceil(self.reach / self.step))
        half = int(np.ceil(refuse.positive("half_width", half_width) / self.step)) + MARGIN
        self._views, self._around = 2 * half + 1, 2 * (half + around) + 1
        _refuse_memory(self._around**2 * BYTES)
        colours = rgb(table, colour_space)
        counts = (2 * around + 1, 2 * around + 1)
        kernel = on_even_steps(colours, table.half_range, table.warp, counts, self.step, "sharpened")
        kernel *= FOUR_PI_SQUARED * self._weight(around, self.step)[..., None]
        self._convolver = Convolver(kernel, (self._around, self._around), precision, threads)
        self._rest = EnvironmentReflection(
            table, colour_space, size, "sharpened", precision, threads, self._outside
        )

    def __call__(self, environment: Environment, frame: ArrayLike) -> CloseLight:
        """Reflect light from all around.

        Parameters
        ----------
        environment : Environment
            The light.
        frame : array_like, shape (3, 3)
            Tangent, bitangent and normal of the sample in the world.

        Returns
        -------
        CloseLight
            Towards the views that were asked for.
        """
        lit = in_space(environment, self._rest.colour_space)
        # Light from s_i = h − s_o: about the views' mirror image.
        counts = (self._around, self._around)
        found = laid_out(lit, frame, counts, self.step, (-self.centre[0], -self.centre[1]))
        turned = np.ascontiguousarray(found[::-1, ::-1])
        border = (self._around - self._views) // 2
        inner = self._convolver(turned)[border:-border, border:-border].astype(np.float32)
        fine = ReflectedLight(np.ascontiguousarray(inner), self.step, self._rest.colour_space, self.centre)
        return CloseLight(fine, self._rest(lit, frame))

    def _weight(self, half: int, step: float) -> NDArray[np.float64]:
        """How much of the table is on the fine plane: 1 about h = 0, falling smoothly to 0 at the reach."""
        distance = np.abs(step * np.arange(-half, half + 1)) / self.reach
        part = np.clip((distance - WHOLE) / (1 - WHOLE), 0, 1)
        side = np.cos(0.5 * np.pi * part) ** 2
        return np.asarray(np.outer(side, side))

    def _outside(self, half: int, step: float) -> NDArray[np.float64]:
        return np.asarray(1 - self._weight(half, step))


def _refuse_memory(needed: int) -> None:
    allowed = picture.allowed_memory(None)
    if needed > allowed:
        raise refuse.Refusal(
            f"'half_width' and 'reach' over 'step' need {needed / 1e9:.3g} GB of memory, "
            f"{allowed / 1e9:.3g} GB are free; a larger 'step' or a narrower part needs less."
        )
