"""What the file of a grating may hold."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Length = Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False)]


class GratingPreset(BaseModel):
    """A surface of equal lines.

    Parameters
    ----------
    title : str
        What it is, for a person.
    source : str
        Where the numbers come from.
    kind : str
        "slits", "grooves", "blazed", "radial" or "display".
    period_um, width_um : float
        From line to line and of a line, micrometres; of slits, grooves and radial ones.
    depth_um : float
        Optical depth of grooves, micrometres: times the index of what fills them.
    lines_per_mm, blaze_wavelength_nm : float
        Of blazed ones; the wavelength in Littrow mounting, nanometres.
    pixels_per_inch, opening : float
        Of displays; share of a sub-pixel's width and height that reflects.
    count : int
        Lines that are lit in phase.
    spread : float
        Standard deviation of the direction sum along the lines, without unit.
    shape : str
        "disc", whose lines run round it, or "plane": the object on which it is usually found.
    object_mm : list of float
        A disc's diameter and hole, a plane's width and height, millimetres.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    title: str
    source: str
    kind: Literal["slits", "grooves", "blazed", "radial", "display"] = "slits"
    period_um: Length = 1.6
    width_um: Length = 0.5
    depth_um: Length = 0.1
    lines_per_mm: Length = 600.0
    blaze_wavelength_nm: Length = 500.0
    pixels_per_inch: Length = 300.0
    opening: Annotated[float, Field(ge=0.01, le=1)] = 0.7
    count: Annotated[int, Field(ge=1, le=10000)] = 21
    spread: Annotated[float, Field(gt=0, le=1)] = 0.02
    shape: Literal["disc", "plane"] = "plane"
    object_mm: Annotated[list[Length], Field(min_length=2, max_length=2)] = [50.0, 50.0]
