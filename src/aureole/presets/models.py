"""What a preset file may hold, checked with pydantic, and how one is found by its name."""

import tomllib
from collections.abc import Iterable
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from aureole import refuse

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


KINDS: dict[str, type[BaseModel]] = {"cameras": CameraPreset, "irises": IrisPreset}
Model = TypeVar("Model", bound=BaseModel)


def names(kind: str) -> list[str]:
    """Return the names of the shipped presets of a kind.

    Parameters
    ----------
    kind : str
        "cameras" or "irises".

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
        "cameras" or "irises".
    name : str
        A shipped preset's name, or a path that ends in ".toml".

    Returns
    -------
    CameraPreset or IrisPreset
        Checked.

    Raises
    ------
    refuse.Refusal
        Where there is no such preset (with the nearest name), or the file does not hold one.
    """
    known = names(kind)
    if name in known:
        text = (resources.files("aureole.presets") / kind / f"{name}.toml").read_text(encoding="utf-8")
        return _parse(KINDS[kind], text, name)
    if not name.endswith(".toml"):
        raise refuse.unknown_key(f"presets/{kind}", name, known)
    try:
        text = Path(name).read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise refuse.Refusal(f"'{name}' cannot be read: {_reason(error)}.") from None
    return _parse(KINDS[kind], text, name)


def _parse(model: type[Model], text: str, where: str) -> Model:
    try:
        return model.model_validate(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise refuse.Refusal(f"'{where}' is not TOML: {error}.") from None
    except RecursionError:
        raise refuse.Refusal(f"'{where}' is not a preset: its values are nested too deeply.") from None
    except ValidationError as error:
        raise _first_refusal(where, error, model.model_fields) from None


def _first_refusal(where: str, error: ValidationError, known: Iterable[str]) -> refuse.Refusal:
    first = error.errors()[0]
    key = ".".join(str(part) for part in first["loc"])
    if first["type"] == "extra_forbidden":
        return refuse.unknown_key(f"'{where}'", key, known)
    return refuse.Refusal(f"'{key}' in '{where}': {first['msg'][0].lower()}{first['msg'][1:]}.")


def _reason(error: Exception) -> str:
    return str(getattr(error, "strerror", None) or error)
