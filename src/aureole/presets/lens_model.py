"""What the files of lenses and of glasses may hold."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

MOST_SURFACES, MOST_LAYERS = 200, 200
# No lens is larger; what is finite inside of these stays so in all that is computed.
FARTHEST_MM, WIDEST_MM, SHARPEST_MM = 1e7, 1e5, 1e-4
Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Size = Annotated[float, Field(gt=0, le=1e9, allow_inf_nan=False)]
Radius = Annotated[float, Field(ge=-1e12, le=1e12, allow_inf_nan=False)]
Distance = Annotated[float, Field(ge=0, le=FARTHEST_MM, allow_inf_nan=False)]
Coefficient = Annotated[float, Field(ge=-1e20, le=1e20, allow_inf_nan=False)]
Index = Annotated[float, Field(ge=1, le=5)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class GlassLine(_Strict):
    """One glass of a catalogue.

    Parameters
    ----------
    index, abbe : float
        n_d and V_d as the catalogue prints them.
    b, c_um2 : list of float
        Sellmeier constants; those of `c_um2` in square micrometres.
    """

    index: Index
    abbe: Positive
    b: Annotated[list[Finite], Field(min_length=3, max_length=3)]
    c_um2: Annotated[list[Finite], Field(min_length=3, max_length=3)]


class GlassCatalogue(_Strict):
    """Glasses of one maker.

    Parameters
    ----------
    title : str
        Whose they are.
    source : str
        Where the numbers come from.
    glasses : dict of str to GlassLine
        By their names in the catalogue.
    """

    title: str
    source: str
    glasses: dict[str, GlassLine]


class LayerPreset(_Strict):
    """One layer of a coating: its glass or index, and its thickness in one of two ways.

    Parameters
    ----------
    index : float, optional
        Refractive index at every wavelength.
    glass : str, optional
        Name in a catalogue, in place of the index.
    quarter_wave_nm : float, optional
        Wavelength in nanometres of which the layer is a quarter thick.
    thickness_nm : float, optional
        Thickness in nanometres, in place of the wavelength.
    """

    index: Index | None = None
    glass: str | None = None
    quarter_wave_nm: Size | None = None
    thickness_nm: Size | None = None


class SurfacePreset(_Strict):
    """One surface and the medium behind it.

    Parameters
    ----------
    radius_mm : float
        Of curvature, positive where the centre lies on the sensor's side; 0 is a plane.
    thickness_mm : float
        Along the axis to the next surface, or to the sensor.
    semi_aperture_mm : float
        Half the clear diameter.
    index, abbe : float, optional
        n_d and V_d of the medium behind; air where neither they nor a glass are given.
    glass : str, optional
        The medium's name in a catalogue.
    coating : str, optional
        Name of one of the file's coatings.
    conic : float
        Conic constant: 0 a sphere, -1 a paraboloid.
    asphere_mm : list of float
        Coefficients of r^4, r^6, ... in the sag, all lengths in millimetres.
    cylinder : {"x", "y"}, optional
        The only axis along which the surface is curved.
    stop : bool
        Whether the iris stands here.
    """

    radius_mm: Radius
    thickness_mm: Distance
    semi_aperture_mm: Annotated[float, Field(ge=1e-6, le=WIDEST_MM, allow_inf_nan=False)]
    index: Index | None = None
    abbe: Annotated[float, Field(ge=1, le=1e6, allow_inf_nan=False)] | None = None
    glass: str | None = None
    coating: str | None = None
    conic: Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)] = 0.0
    asphere_mm: Annotated[list[Coefficient], Field(max_length=10)] = []
    cylinder: Literal["x", "y"] | None = None
    stop: bool = False


class StatePreset(_Strict):
    """One position of a zoom.

    Parameters
    ----------
    name : str
        Such as "135mm".
    focal_length_mm : float
        As the source states it.
    f_number : float, optional
        As the source states it, where it differs.
    thicknesses_mm : dict of str to float
        Number of a surface, counted from 1, to the distance behind it.
    """

    name: str
    focal_length_mm: Size
    f_number: Size | None = None
    thicknesses_mm: dict[str, Distance]


class LensPreset(_Strict):
    """A lens prescription.

    Parameters
    ----------
    title : str
        What it is, for a person.
    source : str
        Where the numbers come from.
    status : str
        "patent", "textbook", "solved" (derived from a patent's states), "interpolated" (not a state of
        the patent) or "own".
    patent, kind, notes : str
        What else is known.
    reason : str
        Why the surfaces give another focal length than the stated one, where it is over 1 % off.
    focal_length_mm, f_number : float
        As the source states them.
    sensor_mm : list of float
        Width and height.
    coatings : dict of str to list of LayerPreset
        Layers from the side of the lower index on, by the coating's name.
    surfaces : list of SurfacePreset
        From the light to the sensor.
    states : list of StatePreset
        Further positions of a zoom.
    """

    title: str
    source: str
    status: Literal["patent", "textbook", "solved", "interpolated", "own"] = "own"
    patent: str = ""
    kind: str = ""
    notes: str = ""
    reason: str = ""
    focal_length_mm: Size
    f_number: Size
    sensor_mm: Annotated[list[Size], Field(min_length=2, max_length=2)] = [36.0, 24.0]
    coatings: dict[str, Annotated[list[LayerPreset], Field(min_length=1, max_length=MOST_LAYERS)]] = {}
    surfaces: Annotated[list[SurfacePreset], Field(min_length=2, max_length=MOST_SURFACES)]
    states: Annotated[list[StatePreset], Field(max_length=20)] = []
