"""Luminance/chroma EXR (Y, RY, BY, chroma at half the resolution) read as RGB.

OpenEXR's "Technical Introduction", section "Luminance/Chroma Images": Y is the luminance with the weights
of the file's primaries, RY = (R − Y) / Y, BY = (B − Y) / Y. Missing chroma is filled in along rows,
then columns, by the windowed sinc of OpenEXR's own RGBA reader, which also tames pixels whose
saturation stands out from all their neighbours'. Written again, such a picture is ordinary RGB.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.picture import primaries
from aureole.picture.channels import choose_colour
from aureole.picture.metadata import Attribute, Channel, Header, Window, text_of

# Windowed sinc at ±1, ±3, ... ±13 pixels from a pixel halfway between two chroma samples.
_TAPS = (0.627123, -0.186077, 0.087929, -0.043159, 0.019597, -0.007540, 0.002128)
# How much of the way to full saturation a pixel may go beyond its neighbours' mean.
_SATURATION_LEFT = 0.25
_PIXEL_TYPES = ("uint", "half", "float")
_DTYPES = {"uint": np.uint32, "half": np.float16, "float": np.float32}
_LAYOUT = {"channels", "type", "chunkCount", "lineOrder", "tiles", "version", "name", "compression"}
_NAMED = {"dataWindow", "displayWindow", "pixelAspectRatio", "chromaticities", "preview"}
# OpenImageIO's names for what the format calls otherwise.
_RENAMED = {
    "aperture": "FNumber",
    "capDate": "DateTime",
    "comments": "ImageDescription",
    "expTime": "ExposureTime",
    "owner": "Copyright",
}


def describe(path: Path) -> Header:
    """Read what a file with subsampled channels says.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    Header
        As from `aureole.picture.describe`.

    Raises
    ------
    refuse.Refusal
        Where it has several parts or its channels are not Y, RY, BY (and alpha).
    """
    source = _opened(path)
    said = source.header()
    names = sorted(said["channels"])
    colour, _ = choose_colour(names)
    if colour is None or not colour.is_luminance_chroma:
        raise refuse.Refusal(f"'{path}' has subsampled channels other than RY and BY: {', '.join(names)}.")
    _refuse_sampling(path, said["channels"])
    chromaticities, (attributes, lost) = _chromaticities(said), _attributes(said)
    space = primaries.recognise(chromaticities) if chromaticities else "rec709"
    return Header(
        format="openexr",
        data_window=_window(said["dataWindow"]),
        display_window=_window(said["displayWindow"]),
        channels=tuple(Channel(name, _PIXEL_TYPES[said["channels"][name].type.v]) for name in names),
        colour=colour,
        colour_space=space or "rec709",
        chromaticities=chromaticities,
        pixel_aspect=float(said["pixelAspectRatio"]),
        compression=_compression(said),
        attributes=attributes,
        notes=tuple(
            f"'{path.name}': {note}." for note in ("luminance and chroma are read as RGB", lost) if note
        ),
    )


def read(path: Path, header: Header) -> dict[str, NDArray[Any]]:
    """Read every channel, luminance and chroma turned into R, G and B.

    Parameters
    ----------
    path : Path
        The file.
    header : Header
        What it says.

    Returns
    -------
    dict of str to ndarray
        "R", "G", "B" float32 and the file's other channels, all (rows, columns).

    Raises
    ------
    refuse.Refusal
        Where the file is damaged or cut short.
    """
    source = _opened(path)
    try:
        if not source.isComplete():
            raise OSError("scanlines are missing")
        planes = {channel.name: _plane(source, channel, header) for channel in header.channels}
    except OSError as error:
        raise refuse.Refusal(f"'{path}' is damaged or cut short: {error}.") from error
    y, ry, by = (planes.pop(name) for name in header.colour.names)
    weights = primaries.luminance_weights(header.chromaticities or primaries.CHROMATICITIES["rec709"])
    rgb = to_rgb(y, ry, by, weights)
    return dict(zip("RGB", np.moveaxis(rgb, -1, 0), strict=True)) | planes


def to_rgb(
    y: NDArray[Any], ry: NDArray[Any], by: NDArray[Any], weights: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Turn luminance and chroma into RGB.

    Parameters
    ----------
    y : ndarray, shape (rows, columns)
        Luminance.
    ry, by : ndarray, shape (rows or rows/2, columns or columns/2)
        (R − Y) / Y and (B − Y) / Y at the even pixels.
    weights : ndarray of float64, shape (3,)
        What red, green and blue add to luminance.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        Linear RGB.
    """
    luminance = y.astype(np.float32)
    red_chroma, blue_chroma = (_filled(chroma.astype(np.float32), luminance.shape) for chroma in (ry, by))
    wr, wg, wb = (np.float32(weight) for weight in weights)
    red, blue = (red_chroma + 1) * luminance, (blue_chroma + 1) * luminance
    green = (luminance - red * wr - blue * wb) / wg
    # Grey stays exactly grey.
    green = np.where((red_chroma == 0) & (blue_chroma == 0), luminance, green)
    rgb = np.stack([red, green, blue], axis=-1)
    subsampled = ry.shape != y.shape or by.shape != y.shape
    return _tamed(rgb, weights.astype(np.float32)) if subsampled else rgb


def _filled(chroma: NDArray[np.float32], shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Fill in chroma along rows, then columns, wherever it has half the samples."""
    for axis in (1, 0):
        if chroma.shape[axis] != shape[axis]:
            chroma = np.moveaxis(_doubled(np.moveaxis(chroma, axis, -1)), -1, axis)
    return chroma


def _doubled(samples: NDArray[np.float32]) -> NDArray[np.float32]:
    """Interleave samples with the values halfway between them, the edge repeated outside."""
    count, reach = samples.shape[-1], len(_TAPS)
    padded = np.pad(samples, ((0, 0), (reach - 1, reach)), mode="edge")
    between = np.zeros_like(samples)
    for j, tap in enumerate(_TAPS):
        left, right = reach - 1 - j, reach + j
        pair = padded[:, left : left + count] + padded[:, right : right + count]
        between += np.float32(tap) * pair
    return np.stack([samples, between], axis=-1).reshape(samples.shape[0], 2 * count)


def _tamed(rgb: NDArray[np.float32], weights: NDArray[np.float32]) -> NDArray[np.float32]:
    """Desaturate pixels that stand out from their diagonal neighbours, keeping luminance."""
    highest = rgb.max(axis=-1)
    lit = highest > 0
    saturation = np.where(lit, 1 - rgb.min(axis=-1) / np.where(lit, highest, 1), 0)
    around = np.pad(saturation, 1, mode="edge")
    mean = (around[:-2, :-2] + around[:-2, 2:] + around[2:, :-2] + around[2:, 2:]) / 4
    most = np.minimum(1 - (1 - np.minimum(mean, 1)) * np.float32(_SATURATION_LEFT), 1)
    rows, columns = np.nonzero(saturation > most)
    share = (most[rows, columns] / saturation[rows, columns])[:, None]
    peak, colour = highest[rows, columns, None], rgb[rows, columns]
    softer = np.maximum(peak - (peak - colour) * share, 0)
    before, after = colour @ weights, softer @ weights
    scale = np.where(after > 0, before / np.where(after > 0, after, 1), 1)
    rgb[rows, columns] = softer * scale[:, None]
    return rgb


def _opened(path: Path) -> Any:
    import OpenEXR

    try:
        return OpenEXR.InputFile(str(path))
    except OSError as error:
        raise refuse.Refusal(f"'{path}' cannot be read: {error}.") from error


def _plane(source: Any, channel: Channel, header: Header) -> NDArray[Any]:
    """Read one channel at its own resolution."""
    sampling = source.header()["channels"][channel.name]
    rows, columns = header.shape
    flat = np.frombuffer(source.channel(channel.name), _DTYPES[channel.pixel_type])
    return flat.reshape(rows // sampling.ySampling, columns // sampling.xSampling)


def _refuse_sampling(path: Path, channels: dict[str, Any]) -> None:
    for name, channel in channels.items():
        allowed = (1, 2) if name in ("RY", "BY") else (1,)
        if channel.xSampling not in allowed or channel.ySampling not in allowed:
            found = f"{channel.xSampling} x {channel.ySampling}"
            raise refuse.Refusal(f"'{path}' has channel {name} subsampled {found}; only chroma by 2 is read.")


def _window(box: Any) -> Window:
    return Window(box.min.x, box.min.y, box.max.x - box.min.x + 1, box.max.y - box.min.y + 1)


def _chromaticities(said: dict[str, Any]) -> tuple[float, ...] | None:
    found = said.get("chromaticities")
    if found is None:
        return None
    points = (found.red, found.green, found.blue, found.white)
    return tuple(float(value) for point in points for value in (point.x, point.y))


def _compression(said: dict[str, Any]) -> str:
    name = str(said["compression"]).removesuffix("_COMPRESSION").lower()
    return "none" if name == "no" else name


def _attributes(said: dict[str, Any]) -> tuple[dict[str, Attribute], str]:
    """Keep texts, numbers and pairs of numbers under OpenImageIO's names, and name the rest."""
    kept, lost = {}, []
    for name in sorted(said.keys() - _LAYOUT - _NAMED):
        value = said[name]
        if isinstance(value, bytes):
            attribute = Attribute("string", text_of(value))
        elif isinstance(value, int | float):
            attribute = Attribute("int" if isinstance(value, int) else "float", value)
        elif type(value).__name__ == "V2f":
            attribute = Attribute("float2", (value.x, value.y))
        else:
            lost.append(name)
            continue
        kept[_RENAMED.get(name, name)] = attribute
    return kept, f"attributes that cannot be carried: {', '.join(lost)}" if lost else ""
