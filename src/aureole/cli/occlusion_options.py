"""Flags for what stands before the lights of a picture and crops the iris that they see."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from aureole import jobs, refuse, units
from aureole.cli.moving import given
from aureole.jobs.glare_occlusion import MOST

OCCLUSION = "Lights behind things"


@dataclass(frozen=True)
class OcclusionFlags:
    """The flags of occlusion, as text; each field's option teaches its use.

    Parameters
    ----------
    occlusion, occluder, occluder_distance : optional
        How it is found, a matte, and how far away it is.
    occluded_lights : int, optional
        How many lights are looked at.
    """

    occlusion: Annotated[
        str | None,
        typer.Option(
            "--occlusion",
            help="picture: what is dark about a light crops the iris that it sees. A guess: right where that "
            "stands before the light and is sharp in the picture; what is near the lens needs --occluder.",
            rich_help_panel=OCCLUSION,
        ),
    ] = None
    occluder: Annotated[
        Path | None,
        typer.Option(
            "--occluder",
            help="Picture whose white stands before the lights, as large as IN; #### for the frame's number.",
            rich_help_panel=OCCLUSION,
        ),
    ] = None
    occluder_distance: Annotated[
        str | None,
        typer.Option(
            "--occluder-distance",
            help="From the lens to what stands before the lights, such as 0.5m: it says how much about a "
            "light crops the iris; the circle about each light without it.",
            rich_help_panel=OCCLUSION,
        ),
    ] = None
    occluded_lights: Annotated[
        int | None,
        typer.Option(
            "--occluded-lights",
            help=f"So many lights are looked at, those with most light: {MOST} unless given.",
            rich_help_panel=OCCLUSION,
        ),
    ] = None

    def wanted(self) -> jobs.GlareOcclusion | None:
        """Return what crops the iris, None where nothing does."""
        if self.occlusion is not None:
            refuse.one_of("occlusion", self.occlusion, ("picture",))
        if self.occlusion is None and self.occluder is None:
            for name in given(self):
                raise refuse.Refusal(f"'{name}' needs --occlusion picture, or --occluder FILE.")
            return None
        if self.occlusion is not None and self.occluder is not None:
            raise refuse.Refusal("'occlusion' and 'occluder' both say what crops the iris; give one of them.")
        text = self.occluder_distance
        distance = None if text is None else units.length(text, "occluder-distance", "0.5m")
        if distance is not None:
            refuse.positive("occluder-distance", distance)
        most = MOST if self.occluded_lights is None else self.occluded_lights
        return jobs.GlareOcclusion(self.occluder, distance, refuse.at_least("occluded-lights", most, 1))
