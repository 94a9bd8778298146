"""Which lights of a picture make glare: all that are bright, or those of a file."""

import functools
import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import glare, refuse
from aureole.glare import LampList
from aureole.jobs.glare import in_working_space
from aureole.jobs.lights import placed_lamps, shot_threshold, shown_shape
from aureole.records import Picture


@dataclass(frozen=True)
class GlareLights:
    """The lights that make glare; plain values, so that they can be sent to other processes.

    Parameters
    ----------
    file : Path, optional
        As `aureole.glare.write_lamps` writes it; all that is bright without it.
    threshold : float, optional
        Luminance from which on light counts; the file's, else one found from the picture without it.
    frame : int, optional
        Which of the file's frames a single picture is.
    """

    file: Path | None = None
    threshold: float | None = None
    frame: int | None = None

    def matte(self, source: Picture, frame: int | None = None) -> NDArray[np.float32]:
        """Return how much of each pixel's light makes glare.

        Parameters
        ----------
        source : Picture
            Linear.
        frame : int, optional
            Its number in a sequence.

        Returns
        -------
        ndarray of float32, shape (rows, columns)
            0..1.

        Raises
        ------
        refuse.Refusal
            Where the file says nothing of this frame, or is of pictures of other proportions.
        """
        known, _ = in_working_space(source)
        if self.file is None:
            return glare.lamp_matte(known, self.threshold)
        number = self.frame if frame is None else frame
        found = lights_of_frame(self.file, number, shown_shape(source))
        lamps = placed_lamps(source, [seen.lamp for seen in found.sightings])
        level = self.threshold if self.threshold is not None else found.threshold
        return glare.lamp_matte(known, level, lamps, found.connect)

    def for_shot(self, pictures: Sequence[Path], reading: Mapping[str, Any]) -> "GlareLights":
        """Return the same with one threshold for a whole shot, so that no light comes and goes with it.

        Parameters
        ----------
        pictures : sequence of Path
            All frames that there are.
        reading : mapping
            Options of `aureole.picture.read`.

        Returns
        -------
        GlareLights
            With a threshold.
        """
        if self.threshold is not None:
            return self
        level = None if self.file is None else read_lights(self.file).threshold
        return replace(self, threshold=shot_threshold(pictures, reading) if level is None else level)

    def words(self) -> tuple[str, float | None]:
        """Return what differs where other lights are meant: the file's contents and the threshold."""
        held = b"" if self.file is None else self.file.read_bytes()
        return hashlib.sha256(held).hexdigest(), self.threshold


def lights_of_frame(path: Path, frame: int | None = None, shape: tuple[int, int] | None = None) -> LampList:
    """Return the lights that a file has for a frame.

    Parameters
    ----------
    path : Path
        File of lights.
    frame : int, optional
        The frame's number; needed where the file has lights of several.
    shape : tuple of int, optional
        (rows, columns) of what the picture is meant to show.

    Returns
    -------
    LampList
        Of this frame alone; in pixels of that shape, or as they lie in the file.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read, says nothing of the frame, or is of pictures of other proportions.
    """
    found = read_lights(path)
    frames = found.frames or tuple(sorted({seen.frame for seen in found.sightings if seen.frame is not None}))
    if frame is None and len(frames) > 1:
        raise refuse.Refusal(
            f"'{path}' has lights of frames {frames[0]} to {frames[-1]}; say which with --lights-frame."
        )
    if frame is None and frames:
        frame = frames[0]
    if found.frames and frame not in found.frames and not any(seen.frame is None for seen in found.sightings):
        raise refuse.Refusal(f"'{path}' says nothing of frame {frame}; it has {frames[0]} to {frames[-1]}.")
    those = replace(found, sightings=tuple(found.at(frame)))
    return those if shape is None else those.scaled_to(shape)


def read_lights(path: Path) -> LampList:
    """Read a file of lights once, however many frames ask for it.

    Parameters
    ----------
    path : Path
        As `aureole.glare.write_lamps` writes it.

    Returns
    -------
    LampList
        Its lights.

    Raises
    ------
    refuse.Refusal
        Where it cannot be read.
    """
    try:
        stamp = os.stat(path).st_mtime_ns
    except OSError:
        stamp = 0
    return _read(path, stamp)


@functools.lru_cache(maxsize=2)
def _read(path: Path, stamp: int) -> LampList:
    return glare.read_lamps(path)


def lit_by(
    lights: GlareLights | None, source: Picture, frame: int | None = None
) -> NDArray[np.float32] | None:
    """Return how much of each pixel's light makes glare, where it is not all.

    Parameters
    ----------
    lights : GlareLights, optional
        Which lights make glare.
    source : Picture
        Linear.
    frame : int, optional
        Its number in a sequence.

    Returns
    -------
    ndarray of float32, shape (rows, columns), or None
        0..1; None for all light.
    """
    return None if lights is None else lights.matte(source, frame)
