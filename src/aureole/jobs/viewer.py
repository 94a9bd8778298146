"""An eye as people describe it, and the light that it is adapted to, made into states of the eye."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from aureole import glare, refuse
from aureole.glare import Eye, EyeState

DEFAULT_EYE = "standard"
# Where nothing is said: a lit street at night, or a room in the evening.
LUMINANCE = 10.0
# What darkness is where a luminance between two is asked for, in candela per square metre.
DARKEST = 1e-6


@dataclass(frozen=True)
class Viewer:
    """Who looks, and at how bright a world.

    Parameters
    ----------
    preset : str
        Name of an eye preset, or a TOML file.
    changes : mapping
        Fields of `aureole.glare.Eye` that differ from the preset's.
    luminance : tuple of (float, float)
        Adapting luminances as (seconds, candela per square metre), in order of time: straight lines of
        log luminance join them, and the first and the last hold before and after.
    adapting_field : float
        Side in radians of the square of that luminance.
    binocular : bool
        Whether both eyes see it.
    blinking : bool
        Whether the lids blink.
    """

    preset: str = DEFAULT_EYE
    changes: Mapping[str, Any] = field(default_factory=dict)
    luminance: tuple[tuple[float, float], ...] = ((0.0, LUMINANCE),)
    adapting_field: float = math.radians(60)
    binocular: bool = True
    blinking: bool = True

    def eye(self) -> Eye:
        """Return the eye."""
        return glare.eye_named(self.preset, **self.changes)

    def adapting(self) -> float | Callable[[float], float]:
        """Return the luminance, or it as a function of time where it changes."""
        times = [time for time, _ in self.luminance]
        if not times or any(later <= earlier for earlier, later in itertools.pairwise(times)):
            raise refuse.Refusal("'luminance' must name rising times, each once.")
        if len(times) == 1:
            return self.luminance[0][1]
        levels = [math.log10(max(luminance, DARKEST)) for _, luminance in self.luminance]
        return lambda time: float(10 ** np.interp(time, times, levels))

    def state(self, time: float) -> EyeState:
        """Return the eye at a time in seconds."""
        return self.states([time])[0]

    def states(self, times: Sequence[float]) -> list[EyeState]:
        """Return the eye at times in seconds."""
        return glare.states(
            times,
            self.adapting(),
            field_of_view=self.adapting_field,
            eye=self.eye(),
            binocular=self.binocular,
            blinking=self.blinking,
        )
