"""What the file of a scene may hold: a camera, lamps, and what passes before them."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Finite = Annotated[float, Field(ge=-1e9, le=1e9, allow_inf_nan=False)]
Size = Annotated[float, Field(gt=0, le=1e9, allow_inf_nan=False)]
Angle = Annotated[float, Field(gt=0, le=170, allow_inf_nan=False)]
Turn = Annotated[float, Field(ge=-360, le=360)]
Light = Annotated[float, Field(ge=0, le=1e9, allow_inf_nan=False)]
Colour = Annotated[list[Light], Field(min_length=3, max_length=3)]
Point = Annotated[list[Finite], Field(min_length=2, max_length=2)]
Key = Annotated[list[Finite], Field(min_length=3, max_length=3)]
Path = Annotated[list[Key], Field(min_length=1, max_length=10000)]
Corners = Annotated[list[Point], Field(min_length=3, max_length=1000)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class SceneCamera(_Strict):
    """The camera of a scene; what is left out comes from its preset.

    Parameters
    ----------
    preset, iris : str, optional
        Names of presets, or their files.
    focal_length_mm, f_number, sensor_width_mm : float, optional
        Millimetres; focal length over the iris's diameter.
    blades : int, optional
        Of the iris.
    curvature, rotation_deg : float, optional
        Of its blades, 0 straight to 1 circle; degrees, counter-clockwise as seen.
    """

    preset: str | None = None
    iris: str | None = None
    focal_length_mm: Size | None = None
    f_number: Size | None = None
    sensor_width_mm: Size | None = None
    blades: Annotated[int, Field(ge=3, le=100)] | None = None
    curvature: Annotated[float, Field(ge=0, le=1)] | None = None
    rotation_deg: Turn | None = None


class SceneLamp(_Strict):
    """A lamp with a size.

    Parameters
    ----------
    name : str
        For the report.
    shape : str
        "disc", "square", "polygon" or "picture".
    size_mm, size_deg : float, optional
        Diameter of a disc, side of a square, longer side of a picture; as it is, or as it is seen.
    corners_mm : list of list of float
        Of a polygon, [right, down] from its place.
    file : str, optional
        Picture of how bright its parts are.
    distance_m : float, optional
        From the camera's opening; without it the lamp is as far as the stars, and told in degrees.
    path_m, path_deg : list of list of float, optional
        Where its middle is: [frame, right, down] from the axis, straight from key to key, still before the
        first and after the last; in its plane, or as directions.
    illuminant : str
        Its spectrum.
    colour : list of float
        Red, green and blue.
    radiance : float
        What a pixel that it fills is worth, times the colour.
    """

    name: str = ""
    shape: Literal["disc", "square", "polygon", "picture"] = "disc"
    size_mm: Size | None = None
    size_deg: Angle | None = None
    corners_mm: Corners | None = None
    file: str | None = None
    distance_m: Size | None = None
    path_m: Path | None = None
    path_deg: Path | None = None
    illuminant: str = "D65"
    colour: Colour = [1.0, 1.0, 1.0]
    radiance: Light = 1000.0


class SceneOccluder(_Strict):
    """Something opaque, flat, and parallel to the camera's opening.

    Parameters
    ----------
    name : str
        For the report.
    shape : str
        "railing", "edge", "disc", "rectangle", "polygon" or "picture".
    distance_m : float
        From the camera's opening.
    path_m : list of list of float
        Where its middle is: [frame, right, down] from the axis, as of a lamp.
    rotation_deg : float
        Counter-clockwise as seen. An edge covers all on its right unless it is turned.
    bar_mm, gap_mm : float
        Of a railing.
    bars : int
        Of a railing.
    width_mm, height_mm : float, optional
        Of a rectangle, of a railing's bars (height) and of a picture (width: its longer side).
    diameter_mm : float, optional
        Of a disc.
    corners_mm : list of list of float, optional
        Of a polygon, [right, down] from its place.
    file : str, optional
        Picture whose white is opaque; #### in its name stands for the frame's number.
    colour : list of float
        What it looks like: red, green and blue.
    """

    name: str = ""
    shape: Literal["railing", "edge", "disc", "rectangle", "polygon", "picture"]
    distance_m: Size
    path_m: Path = [[1.0, 0.0, 0.0]]
    rotation_deg: Turn = 0.0
    bar_mm: Size | None = None
    gap_mm: Size | None = None
    bars: Annotated[int, Field(ge=1, le=2000)] = 41
    width_mm: Size | None = None
    height_mm: Size | None = None
    diameter_mm: Size | None = None
    corners_mm: Corners | None = None
    file: str | None = None
    colour: Colour = [0.0, 0.0, 0.0]


class SceneBackground(_Strict):
    """What is seen behind all lamps, infinitely far.

    Parameters
    ----------
    file : str, optional
        Linear picture; #### in its name stands for the frame's number. It sets the size of the frames.
    top, bottom : list of float
        Red, green and blue of the frame's upper and lower border, without a file.
    """

    file: str | None = None
    top: Colour = [0.0, 0.0, 0.0]
    bottom: Colour = [0.0, 0.0, 0.0]


class ScenePreset(_Strict):
    """Lamps behind occluders, before a camera, through time.

    Parameters
    ----------
    title : str
        What it is, for a person.
    source : str
        Where the numbers come from.
    columns, rows : int
        Pixels of a frame.
    frames : int
        How many there are, from 1.
    fps : float
        Frames a second, of a video.
    colour_space : str
        Of the frames and of all colours.
    camera : SceneCamera
        The camera.
    lamps : list of SceneLamp
        At least one.
    occluders : list of SceneOccluder
        In any order; each hides what is farther away.
    background : SceneBackground
        Behind all.
    """

    title: str = ""
    source: str = ""
    columns: Annotated[int, Field(ge=1, le=100_000)] = 960
    rows: Annotated[int, Field(ge=1, le=100_000)] = 540
    frames: Annotated[int, Field(ge=1, le=1_000_000)] = 1
    fps: Annotated[float, Field(gt=0, le=1000)] = 24.0
    colour_space: str = "rec709"
    camera: SceneCamera = Field(default_factory=SceneCamera)
    lamps: Annotated[list[SceneLamp], Field(min_length=1, max_length=1000)]
    occluders: Annotated[list[SceneOccluder], Field(max_length=1000)] = []
    background: SceneBackground = Field(default_factory=SceneBackground)
