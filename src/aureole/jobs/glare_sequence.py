"""A camera's glare on each frame of a sequence; its kernel is made once, while nothing about it changes."""

import dataclasses
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from aureole import light, picture, presets
from aureole.jobs.frames import FrameMaker, Pace, digest
from aureole.jobs.glare import GlareJob, PreparedGlare, lay_over, prepared_glare, refuse_words
from aureole.jobs.glare_lights import GlareLights
from aureole.jobs.glare_sources import GlareSources
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
    sources : GlareSources
        Which light makes glare.
    pace : Pace
        When frames are, for what moves on the opening.
    """

    job: GlareJob
    sources: GlareSources = field(default_factory=GlareSources)
    pace: Pace = field(default_factory=Pace)

    @classmethod
    def of(
        cls,
        optics: Optics,
        matte: Path | None = None,
        lights: GlareLights | None = None,
        pace: Pace | None = None,
        **options: Any,
    ) -> "GlareMaker":
        """Return the maker of a camera's glare.

        Parameters
        ----------
        optics : Optics
            The camera.
        matte : Path, optional
            Where mattes are: one for all frames, or a name with #### for the frame's number.
        lights : GlareLights, optional
            Which lights make glare; all light without it.
        pace : Pace, optional
            As above.
        **options : object
            Other fields of `GlareJob`.

        Returns
        -------
        GlareMaker
            For a sequence's tasks.
        """
        nothing = Picture(np.zeros((1, 1, 3), dtype=np.float32))
        return cls(GlareJob(nothing, optics, **options), GlareSources(matte, lights), pace or Pace())

    @property
    def moves(self) -> bool:
        """Whether something on the opening is elsewhere at another time."""
        return self.job.optics.at(time=1.0) != self.job.optics

    def refuse(self) -> None:
        """Refuse, before any work, what no frame could be made with."""
        refuse_words(self.job)
        light.illuminant(self.job.illuminant)
        camera = self.job.optics.camera(pixel_pitch=self.job.pixel_pitch)
        if self.job.field is not None:
            self.job.field.housing(camera)
        if self.job.kernel is not None:
            picture.describe(self.job.kernel)
        self.sources.refuse()

    def words(self) -> str:
        """Return what a frame's file says of itself, the same for the same job alone."""
        held = [digest(path.read_bytes()) for path in _files(self.job)]
        pace = self.pace if self.moves else None
        return f"aureole glare {digest(_described(self.job), self.sources.words(), held, pace)}"

    def inputs(self, number: int) -> tuple[Path, ...]:
        """Return the files that belong to one frame besides its source.

        Parameters
        ----------
        number : int
            The frame's.

        Returns
        -------
        tuple of Path
            Its mattes, where each has its own.
        """
        occlusion = self.job.occlusion
        files = () if occlusion is None or occlusion.matte is None else (occlusion.at(number).matte,)
        return (*self.sources.inputs(number), *(path for path in files if path is not None))

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
        optics = self.job.optics.at(time=self.pace.time(number)) if self.moves else self.job.optics
        matte = self.sources.of(source, number)
        job = dataclasses.replace(self.job, picture=source, matte=matte, optics=optics)
        # What crops the iris changes from frame to frame; the kernel of all other light does not.
        occlusion = None if job.occlusion is None else job.occlusion.at(number)
        kernel = _kernel(dataclasses.replace(job, occlusion=None))
        result = lay_over(dataclasses.replace(job, occlusion=occlusion), kernel)
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
    # A worker lives longer than a job: a file may have changed since.
    stamps = [(str(path), path.stat().st_mtime_ns) for path in _files(job)]
    word = digest(_described(job), frame, stamps)
    return _kernels.get(word, lambda: _finished(job))  # type: ignore[no-any-return]


def _finished(job: GlareJob) -> PreparedGlare:
    made = [stage.result for stage in prepared_glare(job)][-1]
    assert isinstance(made, PreparedGlare)
    return made


def _described(job: GlareJob) -> dict[str, Any]:
    """Return a job's plain values."""
    return {f.name: getattr(job, f.name) for f in dataclasses.fields(job) if f.name not in PIXELS}


def _files(job: GlareJob) -> list[Path]:
    """Return the files that a kernel is described by; names of presets are none."""
    optics = job.optics
    named = [optics.preset, optics.iris, optics.opening.picture, job.kernel]
    named.append(None if job.field is None else job.field.lens)
    if optics.preset is not None:
        camera: presets.CameraPreset = presets.load("cameras", optics.preset)
        named.append(camera.iris)
    return [Path(name) for name in named if name is not None and Path(name).is_file()]
