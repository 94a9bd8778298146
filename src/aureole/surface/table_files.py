"""Tables in files: EXR, PFM or NPZ for the numbers, and beside it `<file>.json` that says what they are."""

import json
import os
import zipfile
import zlib
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from aureole import light, picture, refuse
from aureole.presets.models import first_refusal
from aureole.records import Picture
from aureole.surface.pfm import read_pfm, write_pfm
from aureole.surface.report import describe
from aureole.surface.table import TANGENT_CONVENTION, ScatterTable, neutral_white, rgb, scatter_table

SUFFIXES = (".exr", ".pfm", ".npz")
FORMAT = "aureole scatter table 1"
COORDINATES = "h = half_range * u^warp of h = omega_i + omega_o, u from -1 to 1 at first and last samples"
BRDF = "f_r = diffuse + specular + 4 pi^2 F^2 G S_d(h), G = 1 at normal incidence"
# What the sidecar does not say elsewhere.
REPORTED = ("energy", "albedo", "albedo_bound", "brightest")

_Finite = Annotated[float, Field(allow_inf_nan=False)]


class Sidecar(BaseModel):
    """What the JSON beside a table says.

    Parameters
    ----------
    format : str
        What the file is, with its version.
    rows, columns : int
        Samples.
    half_range : float
        h of the outermost samples.
    warp : int
        n of h = half_range · uⁿ.
    coordinates, tangent_convention, brdf, unit : str
        How the samples lie and what they mean, for a person.
    colour_space : str
        "xyz", or the linear RGB space of the numbers.
    illuminant : str
        Name of the light.
    white : list of float
        X, Y, Z of the light.
    model, zero_order : str
        As in `ScatterTable`.
    metadata : dict
        What else is known.
    report : dict
        What `describe` says of the table, for a person; not read back.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal["aureole scatter table 1"]
    rows: Annotated[int, Field(ge=2)]
    columns: Annotated[int, Field(ge=2)]
    half_range: _Finite
    warp: int
    coordinates: str = COORDINATES
    tangent_convention: Literal["columns along +t to the right, rows along b with +b at the top"]
    brdf: str = BRDF
    unit: Literal["1/sr"] = "1/sr"
    colour_space: str
    illuminant: str
    white: Annotated[list[_Finite], Field(min_length=3, max_length=3)]
    model: str
    zero_order: str
    metadata: dict[str, Any] = Field(default_factory=dict)
    report: dict[str, Any] = Field(default_factory=dict)


def sidecar_of(path: str | os.PathLike[str]) -> Path:
    """Return where the JSON beside a table lies.

    Parameters
    ----------
    path : path_like
        The table's file.

    Returns
    -------
    Path
        The same name with ".json" after it.
    """
    return Path(f"{os.fspath(path)}.json")


def write_table(
    path: str | os.PathLike[str], table: ScatterTable, colour_space: str = "xyz"
) -> tuple[Path, Path]:
    """Write a table and its sidecar; each file appears whole or not at all.

    Parameters
    ----------
    path : path_like
        .exr, .pfm or .npz; float32 in each.
    table : ScatterTable
        Any.
    colour_space : str
        "xyz", or a linear RGB space whose white is the light's own.

    Returns
    -------
    tuple of Path
        The table and its sidecar.

    Raises
    ------
    refuse.Refusal
        Where the place cannot be written, or the metadata are not plain numbers and text.
    """
    place, beside = picture.writable(path), sidecar_of(path)
    suffix = refuse.one_of(f"suffix of {place.name}", place.suffix.lower(), SUFFIXES)
    refuse.one_of("colour_space", colour_space, light.SPACES)
    values = table.values if colour_space == "xyz" else rgb(table, colour_space)
    text = _sidecar_text(table, colour_space)
    # The sidecar is renamed last: where it lies, the table beside it is whole.
    with picture.whole_file(beside) as part:
        part.write_text(text, encoding="utf-8")
        _write_values(place, suffix, values, colour_space)
    return place, beside


def read_table(path: str | os.PathLike[str]) -> ScatterTable:
    """Read a table that `write_table` wrote.

    Parameters
    ----------
    path : path_like
        .exr, .pfm or .npz, with its sidecar beside it.

    Returns
    -------
    ScatterTable
        In XYZ, whatever space the file holds.

    Raises
    ------
    refuse.Refusal
        Where a file is missing or damaged, or the sidecar has an unknown key or does not fit.
    """
    place = Path(path)
    suffix = refuse.one_of(f"suffix of {place.name}", place.suffix.lower(), SUFFIXES)
    if not place.is_file():
        raise refuse.Refusal(f"There is no file '{place}'.")
    said = _read_sidecar(sidecar_of(place))
    values = _read_values(place, suffix)
    if values.shape != (said.rows, said.columns, 3):
        raise refuse.Refusal(
            f"'{place}' does not fit its sidecar: {values.shape} instead of ({said.rows}, {said.columns}, 3)."
        )
    if said.colour_space != "xyz":
        white = neutral_white(said.white, said.colour_space)
        values = np.asarray(light.to_xyz(values, said.colour_space, white), dtype=np.float32)
    return scatter_table(
        values,
        said.white,
        said.half_range,
        said.warp,
        said.illuminant,
        said.model,
        said.zero_order,
        said.metadata,
    )


def _sidecar_text(table: ScatterTable, colour_space: str) -> str:
    rows, columns = table.values.shape[:2]
    said = Sidecar(
        format=FORMAT,  # type: ignore[arg-type]
        rows=rows,
        columns=columns,
        half_range=table.half_range,
        warp=table.warp,
        tangent_convention=TANGENT_CONVENTION,  # type: ignore[arg-type]
        colour_space=colour_space,
        illuminant=table.illuminant,
        white=list(table.white),
        model=table.model,
        zero_order=table.zero_order,
        metadata=dict(table.metadata),
        report={key: value for key, value in describe(table).items() if key in REPORTED},
    )
    try:
        return json.dumps(said.model_dump(), indent=1, ensure_ascii=False, allow_nan=False, default=_plain)
    except (TypeError, ValueError) as error:
        raise refuse.Refusal(f"'metadata' must be finite numbers and text: {error}.") from None


def _plain(value: object) -> Any:
    """Turn NumPy's numbers and arrays into Python's."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")


def _write_values(place: Path, suffix: str, values: NDArray[np.float32], colour_space: str) -> None:
    if suffix == ".exr":
        picture.write(place, Picture(values, colour_space), pixel_type="float")
    elif suffix == ".pfm":
        write_pfm(place, values)
    else:
        with picture.whole_file(place) as part, part.open("wb") as file:
            np.savez_compressed(file, values=values)


def _read_sidecar(beside: Path) -> Sidecar:
    if not beside.is_file():
        raise refuse.Refusal(f"There is no '{beside}', which says what the table beside it holds.")
    try:
        data = json.loads(beside.read_text(encoding="utf-8"))
        said = Sidecar.model_validate(data)
    except ValidationError as error:
        if not isinstance(data, dict):
            raise refuse.Refusal(f"'{beside}' must hold one table of keys and values.") from None
        raise first_refusal(str(beside), error, Sidecar) from None
    except (OSError, ValueError, RecursionError) as error:
        raise refuse.Refusal(f"'{beside}' cannot be read: {str(error).splitlines()[0]}.") from None
    refuse.one_of(f"colour_space in {beside}", said.colour_space, light.SPACES)
    return said


def _read_values(place: Path, suffix: str) -> NDArray[np.floating]:
    if suffix == ".exr":
        pixels: NDArray[np.floating] = picture.read(place).pixels[..., :3]
        return pixels
    return read_pfm(place) if suffix == ".pfm" else _read_npz(place)


def _read_npz(place: Path) -> NDArray[np.floating]:
    try:
        with place.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            numbers = np.asarray(file["values"])
    except (OSError, ValueError, TypeError, KeyError, EOFError, zlib.error, zipfile.BadZipFile) as error:
        raise refuse.Refusal(f"'{place}' is damaged or no table: {str(error).strip(chr(39))}.") from None
    return refuse.all_finite(str(place), numbers)
