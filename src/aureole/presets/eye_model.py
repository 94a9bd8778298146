"""What the file of an eye may hold."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Finite = Annotated[float, Field(allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, le=1)]


class EyePreset(BaseModel):
    """What an eye is made of.

    Parameters
    ----------
    title : str
        Whose it is, for a person.
    source : str
        Where the numbers come from.
    age : float
        Years.
    pigment : float
        CIE 135's p, 0 black to 1.2 light blue.
    seed : int
        Of all that is random.
    fibre_width_um : float
        Of the lens fibres, micrometres.
    fibre_count : int, optional
        Gratings all around, in place of the width.
    fibre_annulus_mm : list of float
        Inner and outer radius of the fibres that diffract, millimetres.
    fibre_depth : float
        What they take off the amplitude, 0 to 1.
    particles : float
        Factor on the density of all particles.
    lashes : int
        In front of the open pupil.
    lash_spread_deg : float
        Standard deviation of their directions, degrees.
    lash_width_um, lash_distance_mm : float
        At the root, micrometres; before the entrance pupil, millimetres.
    defocus_dioptres : float
        Of spectacles that would correct it, negative for a short-sighted eye.
    zernike_um : dict of str to float
        Name of a Zernike polynomial to its root mean square in micrometres.
    zernike_diameter_mm : float
        Of the disc on which the polynomials stand, millimetres.
    pupil : str
        "watson-yellott" or "ritschel".
    hippus : float
        Factor on the tremor of the pupil.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    title: str
    source: str
    age: Annotated[float, Field(ge=1, le=120)] = 30.0
    pigment: Annotated[float, Field(ge=0, le=1.2)] = 0.5
    seed: Annotated[int, Field(ge=0)] = 1
    fibre_width_um: Annotated[float, Field(ge=1, le=1000)] = 10.2
    fibre_count: Annotated[int, Field(ge=1)] | None = None
    fibre_annulus_mm: Annotated[list[Finite], Field(min_length=2, max_length=2)] = [2.25, 4.0]
    fibre_depth: Share = 0.18
    particles: Annotated[float, Field(ge=0, le=100)] = 1.0
    lashes: Annotated[int, Field(ge=0, le=100)] = 6
    lash_spread_deg: Annotated[float, Field(ge=0, le=90)] = 20.0
    lash_width_um: Annotated[float, Field(ge=1, le=1000)] = 80.0
    lash_distance_mm: Annotated[float, Field(ge=0, le=100)] = 12.0
    defocus_dioptres: Annotated[float, Field(ge=-20, le=20)] = 0.0
    zernike_um: dict[str, Annotated[float, Field(ge=-100, le=100)]] = {}
    zernike_diameter_mm: Annotated[float, Field(ge=0.1, le=20)] = 6.0
    pupil: Literal["watson-yellott", "ritschel"] = "watson-yellott"
    hippus: Annotated[float, Field(ge=0, le=10)] = 1.0
