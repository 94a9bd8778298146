"""Flags for who makes the frames, shared by the commands that make them."""

from dataclasses import dataclass
from typing import Annotated

import typer

from aureole import jobs

CREW = "Who makes the frames"


@dataclass(frozen=True)
class CrewFlags:
    """The flags of workers; each field's option teaches its use.

    Parameters
    ----------
    workers : optional
        How many processes of this machine.
    scheduler : optional
        A cluster's address.
    """

    workers: Annotated[
        int | None,
        typer.Option(
            "--workers",
            help="Make so many frames at a time, each in a process of this machine; it needs the extra "
            "[cluster].",
            rich_help_panel=CREW,
        ),
    ] = None
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler",
            help="Let a Dask cluster's workers make the frames: its scheduler's address, tcp://host:8786. "
            "They need the same Aureole and the same folders; it needs the extra [cluster].",
            rich_help_panel=CREW,
        ),
    ] = None

    def crew(self) -> jobs.Crew:
        """Return who makes the frames; refuse who cannot, before any work."""
        return jobs.Crew(self.workers, self.scheduler).check()
