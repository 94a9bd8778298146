"""Surfaces as people describe them: presets, slits, pictures of heights, tables in files."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from aureole import picture, presets, refuse, surface
from aureole.jobs.surface import SurfaceTableJob, table_stages
from aureole.records import Stage

TABLE_SUFFIXES = (".exr", ".pfm", ".npz")
PFM, NUMPY = ".pfm", ".npy"


def read_plane(path: Path, transfer: Literal["auto", "linear"] = "auto") -> NDArray[np.float64]:
    """Read a picture's numbers as one plane.

    Parameters
    ----------
    path : Path
        EXR, HDR, TIFF, PNG, JPEG, PFM, or NPY of two dimensions.
    transfer : str
        "linear" takes the numbers of 8 and 16 bit files as they are, "auto" decodes them.

    Returns
    -------
    ndarray of float64, shape (rows, columns)
        The mean of a picture's colour channels; row 0 is the uppermost.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read.
    """
    pixels = read_pixels(path, transfer)
    return pixels if pixels.ndim == 2 else np.asarray(pixels[..., :3].mean(axis=2))


def read_pixels(path: Path, transfer: Literal["auto", "linear"] = "auto") -> NDArray[np.float64]:
    """Read a picture's numbers, whatever its channels.

    Parameters
    ----------
    path : Path
        EXR, HDR, TIFF, PNG, JPEG, PFM, or NPY.
    transfer : str
        "linear" takes the numbers of 8 and 16 bit files as they are, "auto" decodes them.

    Returns
    -------
    ndarray of float64, shape (rows, columns) or (rows, columns, channels)
        Row 0 is the uppermost.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read, or holds NaN.
    """
    suffix = path.suffix.lower()
    if suffix not in (PFM, NUMPY):
        return picture.read(path, transfer=transfer).pixels.astype(np.float64)
    if not path.is_file():
        raise refuse.Refusal(f"There is no file '{path}'.")
    if suffix == PFM:
        return np.asarray(surface.read_pfm(path), dtype=np.float64)
    try:
        numbers = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise refuse.Refusal(f"'{path}' is damaged or no array: {str(error).splitlines()[0]}.") from None
    if numbers.ndim not in (2, 3) or numbers.dtype.kind not in "biuf":
        raise refuse.Refusal(f"'{path}' must hold real numbers in rows and columns, got {numbers.shape}.")
    return np.asarray(refuse.all_finite(str(path), numbers), dtype=np.float64)


def heights_from_file(path: Path, pixel: float, unit: float) -> surface.HeightField:
    """Read a height field.

    Parameters
    ----------
    path : Path
        A picture whose values are heights.
    pixel : float
        Metres from one to the next.
    unit : float
        Metres that a value of 1 stands for.

    Returns
    -------
    HeightField
        Metres.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read.
    """
    scale = refuse.finite("height-unit", unit)
    return surface.height_field(scale * read_plane(path, "linear"), pixel, path.stem)


def surface_from_bokeh(
    path: Path, slits: bool = False, **known: Any
) -> tuple[surface.Grating | surface.HeightField, dict[str, Any], tuple[str, ...]]:
    """Read a surface from the photograph of an out-of-focus highlight on it.

    Parameters
    ----------
    path : Path
        The photograph.
    slits : bool
        Whether the lines that it shows are taken as slits; as heights otherwise.
    **known : dict
        What else `aureole.surface.heights_from_bokeh` takes.

    Returns
    -------
    source : Grating or HeightField
        The surface.
    facts : dict
        Plain numbers.
    notes : tuple of str
        What to mind: a bokeh is a likeness, and no lens shows lines finer than its limit.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read, or it is not said how large a pixel or how deep dark is.
    """
    found = surface.heights_from_bokeh(path, **known)
    facts: dict[str, Any] = {
        "surface": path.stem,
        "turned_deg": round(math.degrees(found.angle), 3),
        "period_along_t_m": found.period,
        "bright_width_m": found.width,
        "lit_lines": found.lit,
        "pixel_m": found.heights.pixel,
    }
    if found.across:
        facts["period_along_b_m"] = found.across
    return (found.grating() if slits else found.heights), facts, found.notes


def is_table(text: str) -> bool:
    """Return whether a text names a table's file, not a grating's preset.

    Parameters
    ----------
    text : str
        As typed.

    Returns
    -------
    bool
        By its suffix.
    """
    return Path(text).suffix.lower() in TABLE_SUFFIXES


def named_table_stages(
    text: str, illuminant: str = "D65", size: int | None = None, zero_order: str = "keep"
) -> Iterator[Stage]:
    """Read a table, or make one of a grating's preset.

    Parameters
    ----------
    text : str
        A table's file, a preset's name, or a preset's file.
    illuminant : str
        Of a preset's light.
    size : int, optional
        Of a preset's table.
    zero_order : str
        What becomes of a preset's light about h = 0.

    Yields
    ------
    Stage
        The last one holds a `ScatterTable`.

    Raises
    ------
    refuse.Refusal
        Where there is no such table or preset.
    """
    if is_table(text):
        yield Stage(0.0, "reading the table")
        yield Stage(1.0, "table", surface.read_table(text))
        return
    if "." in text and not text.endswith(".toml"):
        raise refuse.Refusal(
            f"'{text}' is neither a table ({', '.join(TABLE_SUFFIXES)}) nor a grating's preset or .toml file."
        )
    shape = None if size is None else (size, size)
    yield from table_stages(SurfaceTableJob(surface.grating(text), illuminant, shape, zero_order=zero_order))


def grating_titles() -> dict[str, str]:
    """Return the gratings that come with Aureole.

    Returns
    -------
    dict of str to str
        Title by name.
    """
    return {name: presets.load("gratings", name).title for name in presets.names("gratings")}
