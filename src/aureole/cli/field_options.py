"""Flags for what of a camera's glare changes over the frame: its housing, and how finely it is found."""

from dataclasses import dataclass
from typing import Annotated

import typer

from aureole import aperture, jobs, refuse
from aureole.cli import options
from aureole.cli.pupil_options import PupilFlags, lengths

FIELD = "Over the frame"


@dataclass(frozen=True)
class FieldFlags:
    """The flags of a field, as text; each field's option teaches its use.

    Parameters
    ----------
    field, lens, rim, lens_rims : optional
        How many places, whose housing, further rims, and how the lens's are found.
    vignette, whole_kernel : bool
        Whether the picture darkens with them, and whether kernels reach any pixel.
    """

    field: Annotated[
        str | None,
        typer.Option(
            "--field",
            help="Places across x down, each with a kernel of its own; light between them is shared: 5x3 "
            "unless given.",
            rich_help_panel=FIELD,
        ),
    ] = None
    lens: Annotated[
        str | None,
        typer.Option(
            "--lens",
            help="Lens, or its file, whose rims crop the opening towards the frame's border (cat's eye), "
            "scaled to the focal length; see `aureole lens list`.",
            rich_help_panel=FIELD,
        ),
    ] = None
    rim: Annotated[
        list[str] | None,
        typer.Option(
            "--rim",
            help="A further round rim: its diameter, and how far before the pupil it stands, negative behind "
            "it: 30mm,25mm; repeat it.",
            rich_help_panel=FIELD,
        ),
    ] = None
    lens_rims: Annotated[
        str | None,
        typer.Option(
            "--lens-rims",
            help="How the lens's rims are found: traced (by real rays, unless given) or paraxial (as images "
            "near the axis).",
            rich_help_panel=FIELD,
        ),
    ] = None
    vignette: Annotated[
        bool,
        typer.Option(
            "--vignette",
            help="Darken the picture as the rims close, too; a photograph is dark there already.",
            rich_help_panel=FIELD,
        ),
    ] = False
    whole_kernel: Annotated[
        bool,
        typer.Option(
            "--whole-kernel",
            help="Kernel that reaches from any pixel to any other, not faded.",
            rich_help_panel=FIELD,
        ),
    ] = False

    def wanted(self, pupil: PupilFlags) -> jobs.GlareField | None:
        """Return what changes over the frame, None where nothing does."""
        changes = self.lens is not None or bool(self.rim) or pupil.dirt_distance is not None
        if not changes:
            for name, value in (
                ("field", self.field),
                ("vignette", self.vignette),
                ("lens-rims", self.lens_rims),
            ):
                if value:
                    raise refuse.Refusal(
                        f"'{name}' needs something that changes over the frame: 'lens', 'rim' or "
                        "'dirt-distance'."
                    )
            return None
        if self.lens_rims is not None and self.lens is None:
            raise refuse.Refusal("'lens-rims' needs 'lens'.")
        nodes = jobs.GlareField.nodes if self.field is None else options.size(self.field, "field")
        rims = tuple(aperture.Rim(*lengths(text, "rim")) for text in self.rim or ())
        return jobs.GlareField(nodes, self.lens, rims, self.vignette, self.lens_rims or jobs.LENS_RIMS[0])
