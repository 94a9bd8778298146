"""A camera's glare on each frame of a sequence; its kernel is made once, while nothing about it changes."""

import dataclasses
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from aureole import light, picture
from aureole.jobs import frame_files
from aureole.jobs.frames import FrameMaker, digest
from aureole.jobs.glare import GlareJob, PreparedGlare, lay_over, prepared_glare, read_matte, refuse_words
from aureole.jobs.glare_lights import GlareLights, lit_by
from aureole.jobs.optics import Optics
from aureole.records import Picture

# Fields of a job that its kernel does not depend on.
PIXELS = ("picture", "matte", "memory")


@dataclass(frozen=True, eq=False)
class GlareMaker(FrameMaker):
    """Lays a camera's glare over frames.

    Parameters
    ----------
    job : GlareJob
        What to do; its picture and its matte are not looked at.
    matte : Path, optional
        Where mattes are: one for all frames, or a name with #### for the frame's number.
    lights : GlareLights, optional
        Which lights make glare; all light without it.
    """

    job: GlareJob
    matte: Path | None = None
    lights: GlareLights | None = None

    @classmethod
    def of(
        cls,
        optics: Optics,
        matte: Path | None = None,
        lights: GlareLights | None = None,
        **options: Any,
    ) -> "GlareMaker":
        """Return the maker of a camera's glare.

        Parameters
        ----------
        optics : Optics
            The camera.
        matte : Path, optional
            As above.
        lights : GlareLights, optional
            As above.
        **options : object
            Other fields of `GlareJob`.

        Returns
        -------
        GlareMaker
            For a sequence's tasks.
        """
        nothing = Picture(np.zeros((1, 1, 3), dtype=np.float32))
        return cls(GlareJob(nothing, optics, **options), matte, lights)

    def refuse(self) -> None:
        """Refuse, before any work, what no frame could be made with."""
        refuse_words(self.job)
        light.illuminant(self.job.illuminant)
        self.job.optics.camera(pixel_pitch=self.job.pixel_pitch)

    def words(self) -> str:
        """Return what a frame's file says of itself, the same for the same job alone."""
        files = [_contents(path) for path in _files(self.job.optics)]
        matte = None if self.matte is None else str(self.matte)
        lights = None if self.lights is None else self.lights.words()
        return f"aureole glare {digest(_described(self.job), matte, files, lights)}"

    def make(self, source: Picture, number: int) -> tuple[Picture, dict[str, Any]]:
        """Return a frame from the picture of its source, and its plain numbers.

        Parameters
        ----------
        source : Picture
            Linear.
        number : int
            The frame's.

        Returns
        -------
        picture : Picture
            With glare.
        report : dict
            Plain numbers.
        """
        matte = None if self.matte is None else read_matte(_numbered(self.matte, number), source)
        lit = lit_by(self.lights, source, number)
        if lit is not None:
            matte = lit if matte is None else matte * lit
        job = dataclasses.replace(self.job, picture=source, matte=matte)
        result = lay_over(job, _kernel(job))
        return result.picture, result.report


class _Kept:
    """The last thing that was made, for as long as it is asked for by the same word."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._word = ""
        self._made: Any = None

    def get(self, word: str, make: Callable[[], Any]) -> Any:
        """Return what the word stands for; another is forgotten before it is made."""
        with self._lock:
            if word != self._word:
                self._word, self._made = "", None
                self._made = make()
                self._word = word
            return self._made


_kernels = _Kept()


def _kernel(job: GlareJob) -> PreparedGlare:
    """Return a job's kernel, made once in each process while nothing about it changes."""
    header = picture.header_of(job.picture)
    windows = header and (header.data_window, header.display_window, header.pixel_aspect)
    frame = (job.picture.pixels.shape[:2], job.picture.colour_space, windows)
    return _kernels.get(digest(_described(job), frame), lambda: _finished(job))  # type: ignore[no-any-return]


def _finished(job: GlareJob) -> PreparedGlare:
    made = [stage.result for stage in prepared_glare(job)][-1]
    assert isinstance(made, PreparedGlare)
    return made


def _described(job: GlareJob) -> dict[str, Any]:
    """Return a job's plain values."""
    return {f.name: getattr(job, f.name) for f in dataclasses.fields(job) if f.name not in PIXELS}


def _files(optics: Optics) -> list[Path]:
    """Return the files that a camera is described by; names of presets are none."""
    named = [optics.preset, optics.iris, optics.opening.picture]
    return [Path(name) for name in named if name is not None and Path(name).is_file()]


def _contents(path: Path) -> str:
    return digest(path.read_bytes())


def _numbered(path: Path, number: int) -> Path:
    return frame_files.frame(path, number) if frame_files.is_pattern(path) else path
