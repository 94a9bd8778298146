"""Flags for the lights of pictures, shared by several commands."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from aureole import jobs, refuse
from aureole.cli import options

LIGHTS = "Lights"
AUTO = "auto"


@dataclass(frozen=True)
class ReadFlags:
    """The flags of reading pictures, as text.

    Parameters
    ----------
    nan : str
        "refuse" or "zero".
    color_config : Path, optional
        OpenColorIO configuration.
    color_space : str, optional
        The pictures' space in that configuration.
    memory : str, optional
        The most to use.
    """

    nan: options.Nan = "refuse"
    color_config: options.ColorConfig = None
    color_space: Annotated[
        str | None, typer.Option(help="IN's space in that configuration.", rich_help_panel=options.FILES)
    ] = None
    memory: options.Memory = None

    def reading(self) -> dict[str, Any]:
        """Return the options of `aureole.picture.read`."""
        return {**vars(self), "memory": options.memory(self.memory)}


@dataclass(frozen=True)
class GlareLightFlags:
    """The flags of the lights that make glare; each field's option teaches its use.

    Parameters
    ----------
    lights : str, optional
        Which.
    lights_frame : int, optional
        Whose, of a file.
    """

    lights: Annotated[
        str | None,
        typer.Option(
            "--lights",
            help="Only lights make glare. auto: pixels 16 times as bright as the median, but at least a "
            "thousandth of the brightest; a luminance, such as 50; or a file that `aureole lights` wrote. "
            "Light counts from there on, and in full from twice that. Of a shot all frames have one "
            "threshold, from up to eight of those that lie there.",
            rich_help_panel=LIGHTS,
        ),
    ] = None
    lights_frame: Annotated[
        int | None,
        typer.Option(
            "--lights-frame",
            help="Which frame of the file one picture is; frames of a sequence know their number.",
            rich_help_panel=LIGHTS,
        ),
    ] = None

    def chosen(self) -> jobs.GlareLights | None:
        """Return the lights that make glare; None for all light."""
        if self.lights is None:
            if self.lights_frame is not None:
                raise refuse.Refusal("'lights-frame' needs the file of lights: --lights FILE.")
            return None
        path = Path(self.lights)
        if self.lights != AUTO and (path.suffix or path.exists()) and not _is_number(self.lights):
            return jobs.GlareLights(path, frame=self.lights_frame)
        if self.lights_frame is not None:
            raise refuse.Refusal("'lights-frame' needs the file of lights: --lights FILE.")
        return jobs.GlareLights(threshold=threshold(self.lights, "lights", "auto, a file"))


def threshold(text: str, name: str = "threshold", others: str = AUTO) -> float | None:
    """Read a threshold of lights.

    Parameters
    ----------
    text : str
        "auto" or a luminance.
    name : str
        The flag's name.
    others : str
        What else may be given, for the refusal.

    Returns
    -------
    float or None
        The luminance; None for "auto".

    Raises
    ------
    refuse.Refusal
        Where it is neither.
    """
    if text == AUTO:
        return None
    if not _is_number(text):
        raise refuse.Refusal(f"'{name}' must be {others} or a luminance such as 50, got '{text}'.")
    return refuse.positive(name, float(text))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
