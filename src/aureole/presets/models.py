"""What a preset file may hold, checked with pydantic, and how one is found by its name."""

import tomllib
from collections.abc import Iterable, Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from aureole import refuse
from aureole.presets.eye_model import EyePreset
from aureole.presets.grating_model import GratingPreset
from aureole.presets.job_model import JobPreset
from aureole.presets.lens_model import GlassCatalogue, LensPreset
from aureole.presets.scene_model import ScenePreset

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class IrisPreset(BaseModel):
    """Shape of an iris.

    Parameters
    ----------
    title : str
        What it is, for a person.
    source : str
        Where the numbers come from.
    shape : str
        "circle" or "iris".
    blades : int
        3 to 100; of an iris.
    curvature : float
        Of an iris's blades over that of the circle through its corners, 0..1.
    rotation_deg : float
        Degrees, counter-clockwise as seen.
    obstruction : float
        Diameter of a central disc over the iris's own, 0 <= d < 1.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    title: str
    source: str
    shape: str = Field(default="iris", pattern="^(circle|iris)$")
    blades: Annotated[int, Field(ge=3, le=100)] = 7
    curvature: Annotated[float, Field(ge=0, le=1)] = 0.0
    rotation_deg: Annotated[float, Field(ge=-360, le=360)] = 0.0
    obstruction: Annotated[float, Field(ge=0, lt=1)] = 0.0


class CameraPreset(BaseModel):
    """A camera with its lens.

    Parameters
    ----------
    title : str
        What it is, for a person.
    source : str
        Where the numbers come from.
    focal_length_mm : float
        Millimetres.
    f_number : float
        Focal length over the iris's diameter.
    sensor_width_mm, sensor_height_mm : float
        Millimetres.
    columns, rows : int
        Pixels of the whole sensor.
    iris : str
        Name or path of its iris preset.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    title: str
    source: str
    focal_length_mm: Positive
    f_number: Positive
    sensor_width_mm: Positive
    sensor_height_mm: Positive
    columns: Annotated[int, Field(ge=1)]
    rows: Annotated[int, Field(ge=1)]
    iris: str


KINDS: dict[str, type[BaseModel]] = {
    "cameras": CameraPreset,
    "eyes": EyePreset,
    "glasses": GlassCatalogue,
    "gratings": GratingPreset,
    "irises": IrisPreset,
    "jobs": JobPreset,
    "lenses": LensPreset,
    "scenes": ScenePreset,
}


def names(kind: str) -> list[str]:
    """Return the names of the shipped presets of a kind.

    Parameters
    ----------
    kind : str
        One of `KINDS`.

    Returns
    -------
    list of str
        Sorted.
    """
    refuse.one_of("kind", kind, KINDS)
    folder = resources.files("aureole.presets") / kind
    return sorted(
        entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml")
    )


def load(kind: str, name: str) -> Any:
    """Return a preset by its name, or by the path of a TOML file.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    name : str
        A shipped preset's name, or a path that ends in ".toml".

    Returns
    -------
    BaseModel
        The checked record of its kind.

    Raises
    ------
    refuse.Refusal
        Where there is no such preset (with the nearest name), or the file does not hold one.
    """
    known = names(kind)
    if name in known:
        text = (resources.files("aureole.presets") / kind / f"{name}.toml").read_text(encoding="utf-8")
        return check(kind, _toml(text, name), name)
    if not name.endswith(".toml"):
        raise refuse.unknown_key(f"presets/{kind}", name, known)
    try:
        text = Path(name).read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise refuse.Refusal(f"'{name}' cannot be read: {_reason(error)}.") from None
    return check(kind, _toml(text, name), name)


def path(kind: str, name: str) -> Path:
    """Return where a preset's file lies.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    name : str
        A shipped preset's name, or a path that ends in ".toml".

    Returns
    -------
    Path
        Not looked at.
    """
    if name not in names(kind):
        return Path(name)
    return Path(str(resources.files("aureole.presets"))) / kind / f"{name}.toml"


def check(kind: str, data: Mapping[str, Any], where: str) -> Any:
    """Return the record that plain values mean.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    data : mapping
        Keys and values as in a file.
    where : str
        What was read, for the refusal.

    Returns
    -------
    BaseModel
        The checked record of its kind.

    Raises
    ------
    refuse.Refusal
        At the first key that is unknown, and the first value that is wrong.
    """
    model = KINDS[refuse.one_of("kind", kind, KINDS)]
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise first_refusal(where, error, model) from None


def _toml(text: str, where: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise refuse.Refusal(f"'{where}' is not TOML: {error}.") from None
    except RecursionError:
        raise refuse.Refusal(f"'{where}' is not a preset: its values are nested too deeply.") from None


def first_refusal(where: str, error: ValidationError, model: type[BaseModel]) -> refuse.Refusal:
    """Say the first thing that is wrong with a file's keys, a misspelt key before all others.

    Parameters
    ----------
    where : str
        The file's name.
    error : ValidationError
        What pydantic found.
    model : type
        What the file should hold.

    Returns
    -------
    refuse.Refusal
        One line, to be raised by the caller.
    """
    errors = error.errors()
    # A misspelt key is also a missing one; the misspelling says more.
    first = next((found for found in errors if found["type"] == "extra_forbidden"), errors[0])
    *table, key = [str(part + 1) if isinstance(part, int) else part for part in first["loc"]]
    if isinstance(first["loc"][-1], int):
        key = f"{table.pop()} {key}"
    inside = f"'{where}'" if not table else f"{' '.join(table)} in '{where}'"
    if first["type"] == "extra_forbidden":
        return refuse.unknown_key(inside, key, _fields_at(model, first["loc"][:-1]))
    return refuse.Refusal(f"'{key}' in {inside}: {first['msg'][0].lower()}{first['msg'][1:]}.")


def _fields_at(model: Any, path: Iterable[str | int]) -> Iterable[str]:
    """Return the keys of the table that a path through lists and tables leads to."""
    for part in path:
        if isinstance(part, str) and part in getattr(model, "model_fields", {}):
            model = model.model_fields[part].annotation
        while get_args(model):
            model = get_args(model)[0 if get_origin(model) is Annotated else -1]
    return list(getattr(model, "model_fields", {}))


def _reason(error: Exception) -> str:
    return str(getattr(error, "strerror", None) or error)
