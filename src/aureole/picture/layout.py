"""What goes into a file of each format: named channels, their pixel types, and notes on what is lost."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole.picture import primaries
from aureole.picture.metadata import Attribute, Header, extra_channels, header_of
from aureole.picture.transfer import encode_srgb, into_gamut
from aureole.records import Picture

PIXEL_TYPES = {
    "openexr": ("half", "float"),
    "hdr": ("float",),
    "tiff": ("float", "uint8", "uint16"),
    "png": ("uint8", "uint16"),
    "jpeg": ("uint8",),
}
LOSSLESS = ("none", "rle", "zips", "zip", "piz")
_LARGEST_HALF = 65504.0
_EXTRA_TYPES = {np.dtype(np.float16): "half", np.dtype(np.uint32): "uint"}
_ACES_FLAG = "acesImageContainerFlag"  # SMPTE ST 2065-4 asks for more than the flag
_ACES_CHANNELS = ({"R", "G", "B"}, {"R", "G", "B", "A"})
_STRAIGHT_SLACK = 1 + 1e-6


@dataclass(frozen=True)
class Sheet:
    """What goes into a file.

    Parameters
    ----------
    format : str
        OpenImageIO's name of the format.
    planes : dict of str to ndarray
        Channels (rows, columns) in order.
    types : dict of str to str
        The pixel type of each.
    compression : str
        "" where the format has no choice.
    attributes : dict of str to Attribute
        What the file says besides.
    windows : Header or None
        The source, where its windows and tiles hold for this file too.
    notes : tuple of str
        What a person should know.
    """

    format: str
    planes: dict[str, NDArray[Any]]
    types: dict[str, str]
    compression: str
    attributes: dict[str, Attribute]
    windows: Header | None
    notes: tuple[str, ...]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = next(iter(self.planes.values())).shape
        return rows, columns


def exr_sheet(picture: Picture, pixel_type: str = "auto", compression: str | None = None) -> Sheet:
    """Lay out an EXR: the source's own names, types and compression wherever they serve.

    Parameters
    ----------
    picture : Picture
        What is to be written.
    pixel_type : str
        "auto", "half" or "float".
    compression : str or None
        None is the source's own where that loses nothing, else zip.

    Returns
    -------
    Sheet
        Every channel that fits the picture's size.
    """
    pixels, header = picture.pixels, header_of(picture)
    names = _names(pixels, header)
    planes: dict[str, NDArray[Any]] = {name: pixels[..., k] for name, k in names.items()}
    types, notes = _float_types(pixels, names, header, pixel_type)
    for name, plane in extra_channels(picture).items():
        if plane.shape != pixels.shape[:2]:
            notes.append(f"channel '{name}' is left out, as the picture's size has changed")
        elif name not in planes:
            planes[name] = plane
            types[name] = _EXTRA_TYPES.get(plane.dtype, "float")
    if compression is None:
        compression = _lossless(header, notes)
    attributes = _carried(header) | _primaries(picture.colour_space, header)
    aces = set(planes) in _ACES_CHANNELS and set(types.values()) == {"half"} and compression == "none"
    if _ACES_FLAG in attributes and not (aces and picture.colour_space == "aces2065-1"):
        del attributes[_ACES_FLAG]
        notes.append(f"it is no ACES container any more, so {_ACES_FLAG} is left out")
    windows = header if header and header.shape == pixels.shape[:2] else None
    return Sheet("openexr", planes, types, compression, attributes, windows, tuple(notes))


def flat_sheet(format: str, picture: Picture, pixel_type: str = "auto", transfer: str = "auto") -> Sheet:
    """Lay out a format that holds one picture of Rec.709 colour.

    Parameters
    ----------
    format : str
        "hdr", "tiff", "png" or "jpeg".
    picture : Picture
        What is to be written.
    pixel_type : str
        "auto" or one of the format's `PIXEL_TYPES`.
    transfer : str
        "auto" encodes integers as sRGB, "srgb" always, "linear" never.

    Returns
    -------
    Sheet
        R, G, B or Y, and A where the format holds it.
    """
    header, notes = header_of(picture), _flat_notes(picture)
    own = header.pixel_type if header else ""
    if pixel_type == "auto":
        pixel_type = own if own in PIXEL_TYPES[format] else PIXEL_TYPES[format][0]
    pixels = primaries.converted(picture.pixels, picture.colour_space, "rec709")
    integers = pixel_type != "float"
    colour, alpha = _colour_and_alpha(format, pixels, integers, notes)
    if integers or format == "hdr":
        colour = into_gamut(colour)
    if transfer == "srgb" or (transfer == "auto" and integers):
        colour = encode_srgb(colour)
    grey = header is not None and len(header.colour.names) == 1 and format != "hdr" and _is_grey(colour)
    planes: dict[str, NDArray[Any]] = {name: colour[..., k] for k, name in enumerate("Y" if grey else "RGB")}
    if alpha is not None:
        planes["A"] = alpha
    compression = {"jpeg": "jpeg:95", "tiff": "zip"}.get(format, "")
    types = dict.fromkeys(planes, pixel_type)
    return Sheet(format, planes, types, compression, _carried(header), None, tuple(notes))


def _names(pixels: NDArray[np.float32], header: Header | None) -> dict[str, int]:
    """Name the picture's channels as its source did; grey stays one channel while it is grey."""
    names: tuple[str, ...] = ("R", "G", "B")
    if header and not header.colour.is_luminance_chroma and (header.colour.is_rgb or _is_grey(pixels)):
        names = header.colour.names
    alpha = (header.colour.alpha if header else None) or "A"
    return {name: k for k, name in enumerate(names)} | ({alpha: 3} if pixels.shape[-1] == 4 else {})


def _carried(header: Header | None) -> dict[str, Attribute]:
    """Give back what the source said."""
    if header is None:
        return {}
    return {**header.attributes, "PixelAspectRatio": Attribute("float", header.pixel_aspect)}


def _primaries(space: str, header: Header | None) -> dict[str, Attribute]:
    """Name the primaries: the source's own where they still hold; Rec.709 goes without saying."""
    stated = header.chromaticities if header and header.colour_space == space else None
    if stated is None and space != "rec709":
        stated = primaries.CHROMATICITIES[space]
    return {"chromaticities": Attribute("float[8]", stated)} if stated else {}


def _float_types(
    pixels: NDArray[np.float32], names: dict[str, int], header: Header | None, pixel_type: str
) -> tuple[dict[str, str], list[str]]:
    """Choose half or float for each channel of the picture."""
    source = {channel.name: channel.pixel_type for channel in header.channels} if header else {}
    usual = "half" if header and header.pixel_type == "half" else "float"
    wanted = {name: source.get(name, usual) if pixel_type == "auto" else pixel_type for name in names}
    types = {name: "half" if type == "half" else "float" for name, type in wanted.items()}
    if "half" in types.values() and max(pixels.max(), -pixels.min()) > _LARGEST_HALF:
        note = f"values beyond {_LARGEST_HALF:g} do not fit in half, so it is stored as float"
        return dict.fromkeys(types, "float"), [note]
    return types, []


def _is_grey(pixels: NDArray[np.float32]) -> bool:
    grey = pixels[..., 0]
    return bool((grey == pixels[..., 1]).all() and (grey == pixels[..., 2]).all())


def _lossless(header: Header | None, notes: list[str]) -> str:
    """Take the source's compression where it loses nothing."""
    if header is None or header.format != "openexr":
        return "zip"
    source = header.compression.partition(":")[0]  # "dwaa:45" carries its level
    if source in LOSSLESS:
        return source
    notes.append(f"the source's compression '{source}' loses detail, so zip is used")
    return "zip"


def _colour_and_alpha(
    format: str, pixels: NDArray[np.float32], straight: bool, notes: list[str]
) -> tuple[NDArray[np.float32], NDArray[np.float32] | None]:
    """Split off alpha; where it must be straight and cannot be, show the picture on black."""
    if pixels.shape[-1] == 3:
        return pixels, None
    colour, alpha = pixels[..., :3], pixels[..., 3:]
    holds_alpha = format in ("png", "tiff")
    if holds_alpha and not straight:
        return colour, alpha[..., 0]
    # Light where alpha is zero, or more light than alpha covers, has no straight form.
    fits = (colour >= 0).all() and (colour <= alpha * _STRAIGHT_SLACK).all() and (alpha <= 1).all()
    if holds_alpha and fits:
        return np.divide(colour, np.where(alpha > 0, alpha, 1), dtype=np.float32), alpha[..., 0]
    if (alpha != 1).any():
        notes.append("it is written as it looks on black, without its alpha")
    return colour, None


def _flat_notes(picture: Picture) -> list[str]:
    """Say what only EXR holds."""
    header, notes = header_of(picture), []
    left = list(extra_channels(picture))
    if picture.colour_space != "rec709":
        notes.append(f"colour is converted from {picture.colour_space} to rec709")
    if left:
        notes.append(f"only EXR holds the channels {', '.join(left)}; they are left out")
    if header and header.data_window != header.display_window:
        notes.append("only EXR holds a display window; all pixels of the data window are written")
    return notes
