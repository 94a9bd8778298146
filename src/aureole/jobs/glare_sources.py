"""Which light of a sequence's frames makes glare: all of it, or what mattes and lights let count."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture
from aureole.jobs import frame_files
from aureole.jobs.frames import digest
from aureole.jobs.glare import read_matte
from aureole.jobs.glare_lights import GlareLights, lit_by
from aureole.records import Picture


@dataclass(frozen=True)
class GlareSources:
    """Which light makes glare; plain values, so that they can be sent to other processes.

    Parameters
    ----------
    matte : Path, optional
        Where mattes are: one for all frames, or a name with #### for the frame's number.
    lights : GlareLights, optional
        Which lights make glare; all light without it.
    """

    matte: Path | None = None
    lights: GlareLights | None = None

    def refuse(self) -> None:
        """Refuse, before any work, a matte for all frames that is not there."""
        if self.matte is not None and not frame_files.is_pattern(self.matte):
            picture.describe(self.matte)

    def words(self) -> tuple[Any, ...]:
        """Return what differs where other light is meant; mattes of single frames count by their age."""
        is_one = self.matte is not None and self.matte.is_file()
        held = digest(self.matte.read_bytes()) if is_one and self.matte is not None else None
        return str(self.matte), held, None if self.lights is None else self.lights.words()

    def inputs(self, number: int) -> tuple[Path, ...]:
        """Return the matte of a frame, where each has its own.

        Parameters
        ----------
        number : int
            The frame's.

        Returns
        -------
        tuple of Path
            One, or none.
        """
        return frame_files.own(self.matte, number)

    def of(self, source: Picture, number: int) -> NDArray[np.floating] | None:
        """Return how much of each pixel's light makes glare.

        Parameters
        ----------
        source : Picture
            Linear.
        number : int
            The frame's.

        Returns
        -------
        ndarray, shape (rows, columns), or None
            0..1; None for all light.
        """
        matte = None if self.matte is None else read_matte(frame_files.of(self.matte, number), source)
        lit = lit_by(self.lights, source, number)
        return matte if lit is None else lit if matte is None else matte * lit
