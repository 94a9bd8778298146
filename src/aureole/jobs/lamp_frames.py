"""Frames of a scene: lamps that pass behind occluders, each frame made alone from the scene's file."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from aureole import light, refuse
from aureole.jobs import frame_files
from aureole.jobs.frames import FrameMaker, FrameTask, digest
from aureole.jobs.lamp_glare import (
    RASTER_SIZE,
    TOLERANCE,
    LampGlareJob,
    LampGlareResult,
    refuse_numbers,
    run_lamp_glare,
)
from aureole.jobs.scene import SceneFile
from aureole.jobs.sequence import sequence_tasks
from aureole.records import Picture


@dataclass(frozen=True)
class LampMaker(FrameMaker):
    """Makes frames of a scene.

    Parameters
    ----------
    file : SceneFile
        The scene.
    shape : tuple of int, optional
        As in `LampGlareJob`.
    samples, tolerance, raster, memory : optional
        As in `LampGlareJob`.
    """

    file: SceneFile
    shape: tuple[int, int] | None = None
    samples: int | None = None
    tolerance: float = TOLERANCE
    raster: int = RASTER_SIZE
    memory: int | None = None

    def refuse(self) -> None:
        """Refuse, before any work, what no frame could be made with."""
        refuse_numbers(self.job(1.0))
        for lamp in self.file.scene.lamps:
            light.illuminant(lamp.illuminant)
        refuse.one_of("colour_space", self.file.scene.colour_space, light.SPACES)

    def words(self) -> str:
        """Return what a frame's file says of itself, the same for the same scene and flags alone."""
        # Those with a number in their names may change from frame to frame.
        still = [self.file.folder / name for name in self.file.names()]
        contents = [digest(path.read_bytes()) for path in still if path.is_file()]
        numbers = (self.shape, self.samples, self.tolerance, self.raster)
        return f"aureole lights glare {digest(self.file.scene.model_dump(), numbers, contents)}"

    def job(self, frame: float) -> LampGlareJob:
        """Return the job of a frame."""
        return LampGlareJob(
            self.file, frame, self.shape, self.samples, self.tolerance, self.raster, self.memory
        )

    def read(self, path: Path, options: Mapping[str, Any]) -> Picture:
        """Return nothing: a scene's pictures are read as their places are found."""
        return Picture(np.zeros((1, 1, 3), dtype=np.float32))

    def make(self, source: Picture, number: int) -> tuple[Picture, dict[str, Any]]:
        """Return a frame of the scene, and its plain numbers.

        Parameters
        ----------
        source : Picture
            Not looked at.
        number : int
            The frame's.

        Returns
        -------
        picture : Picture
            The frame.
        report : dict
            Plain numbers.
        """
        result = None
        for stage in run_lamp_glare(self.job(number)):
            result = stage.result
        assert isinstance(result, LampGlareResult)
        return result.picture, result.report


def lamp_tasks(
    maker: LampMaker,
    target: Path,
    numbers: Iterable[int] | None,
    writing: Mapping[str, Any] | None = None,
    overwrite: bool = False,
) -> tuple[FrameTask, ...]:
    """Say which frames of a scene there are to make, and refuse before any work what could not be written.

    Parameters
    ----------
    maker : LampMaker
        What to make.
    target : Path
        Name with #### for the frame's number.
    numbers : iterable of int, optional
        The frames; all of the scene's otherwise.
    writing : mapping, optional
        Options of `aureole.picture.write`.
    overwrite : bool
        Whether frames that are there are made again, and other files replaced.

    Returns
    -------
    tuple of FrameTask
        One for each frame, by their numbers.

    Raises
    ------
    refuse.Refusal
        Where the target has no place for the number, or cannot be written.
    """
    scene = maker.file.scene
    background = scene.background.file
    # Each frame is made again when what it is made of is newer.
    source = maker.file.path if background is None else maker.file.folder / background
    frame_files.frame(target, 1)
    wanted = range(1, scene.frames + 1) if numbers is None else numbers
    return sequence_tasks(source, target, wanted, maker, maker.words(), None, writing, overwrite)
