"""Flags of the command `glare`: how its files are read and written, and how glare is mixed in."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from aureole.cli import options, output
from aureole.cli.pupil_options import numbers

KernelFile = Annotated[
    Path | None,
    typer.Option(
        "--kernel",
        help="A point spread function that is ready, such as `aureole starburst` writes, in place of a "
        "camera's: energy per pixel, at most 1 in all.",
        rich_help_panel=options.MIXING,
    ),
]


@dataclass(frozen=True)
class FileFlags:
    """The flags of reading and writing pictures, as text.

    Parameters
    ----------
    pixel_type : str
        Of the picture out.
    nan : str
        "refuse" or "zero".
    color_config : Path, optional
        OpenColorIO configuration.
    color_space : str, optional
        The space of both pictures in that configuration.
    memory : str, optional
        The most to use.
    """

    pixel_type: options.PixelType = "auto"
    nan: options.Nan = "refuse"
    color_config: options.ColorConfig = None
    color_space: options.ColorSpace = None
    memory: options.Memory = None

    def most(self) -> int | None:
        """Return how many bytes may be used, None for three quarters of what is free."""
        return options.memory(self.memory)

    def reading(self) -> dict[str, Any]:
        """Return the options of `aureole.picture.read`."""
        return {"nan": self.nan, "memory": self.most(), **self._colours()}

    def writing(self, path: Path) -> dict[str, Any]:
        """Return the options of `aureole.picture.write` for a file."""
        return {"pixel_type": output.pixel_type_for(path, self.pixel_type), **self._colours()}

    def _colours(self) -> dict[str, Any]:
        return {"color_config": self.color_config, "color_space": self.color_space}


@dataclass(frozen=True)
class Look:
    """How the glare is mixed in.

    Parameters
    ----------
    illuminant, mode : str
        As in `aureole.jobs.GlareJob`.
    threshold, knee, gain : float
        As in `aureole.jobs.GlareJob`.
    tint : tuple of float
        As in `aureole.jobs.GlareJob`.
    precision : str
        As in `aureole.jobs.GlareJob`.
    """

    illuminant: str
    mode: str
    threshold: float
    knee: float
    gain: float
    tint: tuple[float, float, float]
    precision: str = "double"


@dataclass(frozen=True)
class LookFlags:
    """The flags of mixing, as text.

    Parameters
    ----------
    illuminant, mode : str
        As in `aureole.jobs.GlareJob`.
    threshold, knee, gain : float
        As in `aureole.jobs.GlareJob`.
    tint : str
        Three numbers parted by commas.
    precision : str
        As in `aureole.jobs.GlareJob`.
    """

    illuminant: options.Illuminant = "D65"
    mode: options.Mode = "replace"
    threshold: options.Threshold = 1.0
    knee: options.Knee = 0.5
    gain: options.Gain = 1.0
    tint: options.Tint = "1,1,1"
    precision: options.Precision = "double"

    def look(self) -> Look:
        """Return what the flags mean."""
        return Look(**{**vars(self), "tint": numbers(self.tint, "tint", 3)})
