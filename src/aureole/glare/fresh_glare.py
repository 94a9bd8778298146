"""An eye's glare computed afresh for every picture, behind the same door as flipbooks.

All components take part in one wave, so their amplitudes add, and nothing is blended between frames: what
flipbooks are measured against (`flipbook_error`), and what a slow machine can do without their memory.
"""

import math
from dataclasses import dataclass

from aureole.glare.eye import STANDARD, Eye, EyeState
from aureole.glare.eye_aperture import open_share
from aureole.glare.eye_psf import eye_psf
from aureole.glare.flipbook import SIZE, is_even
from aureole.glare.glare_frames import GlareFrames, pattern_field, pattern_shape
from aureole.glare.kernel import nonnegative


@dataclass(frozen=True, eq=False)
class FreshGlare:
    """An eye's glare, its wave computed for every picture on a small grid.

    Parameters
    ----------
    colour_space : str
        Of the patterns.
    frames : GlareFrames
        Room for one pattern.
    size : int
        Of the wave's grid: 1024 take a third of the time, but cannot tell the fibres in pupils above 4.5 mm.
    """

    colour_space: str
    frames: GlareFrames
    size: int = SIZE

    @classmethod
    def of(
        cls,
        eye: Eye = STANDARD,
        shape: tuple[int, int] = (512, 910),
        field_of_view: float = math.radians(60),
        resolution: str = "full",
        colour_space: str = "rec709",
        size: int = SIZE,
    ) -> "FreshGlare":
        """Make room for the glare of an eye.

        Parameters
        ----------
        eye : Eye
            Whose glare.
        shape : tuple of int
            (rows, columns) of the pictures.
        field_of_view : float
            Radians across the pictures' columns.
        resolution : str
            "full", or "half": patterns on boxes of 2 × 2 pixels.
        colour_space : str
            Of the pictures.
        size : int
            Of the wave's grid.

        Returns
        -------
        FreshGlare
            For `RealTimeGlare`.
        """
        frames = GlareFrames.empty(shape, field_of_view, resolution, 1, is_even(eye))
        return cls(colour_space, frames, size)

    def mix(self, state: EyeState) -> list[tuple[int, float]]:
        """Compute a state's pattern.

        Parameters
        ----------
        state : EyeState
            Of this eye.

        Returns
        -------
        list of (int, float)
            The one pattern, whole.
        """
        own = self.frames
        psf = eye_psf(
            state,
            pattern_shape(own.shape, own.resolution),
            pattern_field(own.shape, own.field_of_view, own.resolution),
            colour_space=self.colour_space,
            projection="perspective",
            size=self.size,
        )
        own.put(0, nonnegative(psf).pixels[..., :3])
        return [(0, 1.0)]

    def open_share(self, state: EyeState) -> float:
        """Return the share of the light that the lids let through.

        Parameters
        ----------
        state : EyeState
            Of this eye.

        Returns
        -------
        float
            0 to 1.
        """
        return open_share(state)
