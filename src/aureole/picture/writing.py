"""Pixels out: `write` turns a `Picture` into a file that appears whole or not at all.

EXR keeps everything: linear colour in its own space, windows, attributes, extra channels, tiles. The
other formats hold what they can, in Rec.709; integers are encoded as sRGB and clipped, colours out of
gamut brought to its edge. Compression never loses anything unless it is asked for.
"""

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.picture import color_config as ocio
from aureole.picture import radiance
from aureole.picture.files import format_of, said
from aureole.picture.layout import LOSSLESS, PIXEL_TYPES, Sheet, exr_sheet, flat_sheet
from aureole.picture.metadata import DESCRIPTION, Header, header_of
from aureole.picture.whole_files import whole_file, writable
from aureole.records import Picture

if TYPE_CHECKING:  # imported where it is used, so that importing the room stays quick
    import OpenImageIO

COMPRESSIONS = (*LOSSLESS, "pxr24", "b44", "b44a", "dwaa", "dwab")

PNG_LEVEL = 3  # nearly as small as the usual 6, in half the time


def write(
    path: str | os.PathLike[str],
    picture: Picture,
    *,
    pixel_type: Literal["auto", "half", "float", "uint8", "uint16"] = "auto",
    compression: str | None = None,
    transfer: Literal["auto", "srgb", "linear"] = "auto",
    color_config: str | os.PathLike[str] | None = None,
    color_space: str | None = None,
) -> tuple[str, ...]:
    """Write a picture; the suffix says the format.

    Parameters
    ----------
    path : path_like
        Where the file shall lie: .exr, .hdr, .tif, .png or .jpg.
    picture : Picture
        What was read, or made; windows, attributes and extra channels come from its metadata.
    pixel_type : str
        "auto" is the source's own where the format has it (half becomes float where a value would
        overflow), else float for EXR and TIFF and uint8 for PNG.
    compression : str or None
        For EXR, one of `COMPRESSIONS`; None is the source's own where that loses nothing, else zip.
    transfer : str
        "auto" encodes integers as sRGB, "srgb" always, "linear" never.
    color_config : path_like or None
        OpenColorIO configuration in which `color_space` is looked up.
    color_space : str or None
        Colour space of the numbers to write; it takes the place of `transfer`.

    Returns
    -------
    tuple of str
        What a person should know: what was left out, clipped or stored otherwise.

    Raises
    ------
    refuse.Refusal
        Where the place cannot be written, or the format cannot hold what is asked.
    """
    place, format = writable(path), format_of(path)
    refuse.one_of("transfer", transfer, ("auto", "srgb", "linear"))
    refuse.one_of("pixel type", pixel_type, ("auto", *PIXEL_TYPES[format]))
    if compression is not None:
        refuse.one_of("compression", compression, COMPRESSIONS)
    picture = _checked(picture)
    if color_space is not None:
        # The numbers are the configuration's from here on; nothing converts or encodes them again.
        picture, transfer = _encoded(picture, format, color_config, color_space), "linear"
    if format == "openexr":
        sheet = exr_sheet(picture, pixel_type, compression)
    else:
        sheet = flat_sheet(format, picture, pixel_type, transfer)
    with whole_file(place) as part:
        _save(part, path, sheet)
        described = header_of(picture)
        if format == "hdr" and described is not None and DESCRIPTION in described.attributes:
            radiance.set_words(part, str(described.attributes[DESCRIPTION].value))
    return tuple(f"'{place.name}': {note}." for note in sheet.notes)


def _checked(picture: Picture) -> Picture:
    pixels = refuse.all_finite("pixels", refuse.shape_of("pixels", picture.pixels, (None, None, None)))
    if pixels.shape[-1] not in (3, 4):
        raise refuse.Refusal(f"'pixels' must have 3 or 4 channels, got {pixels.shape[-1]}.")
    return Picture(pixels.astype(np.float32, copy=False), picture.colour_space, picture.metadata)


def _encoded(picture: Picture, format: str, config: ocio.Config, space: str) -> Picture:
    """Convert to a configuration's space; EXR names its primaries where they are known."""
    numbers, ours = ocio.from_working(picture.pixels, picture.colour_space, config, space)
    metadata, header = dict(picture.metadata), header_of(picture)
    if header:
        metadata["header"] = replace(header, chromaticities=None)
    return Picture(numbers, ours if ours and format == "openexr" else "rec709", metadata)


def _save(part: Path, path: str | os.PathLike[str], sheet: Sheet) -> None:
    """Write the temporary file, every step checked."""
    import OpenImageIO

    spec, whole = spec_of(sheet), _interleaved(sheet)
    output = OpenImageIO.ImageOutput.create(str(part))
    done = output is not None and output.open(str(part), spec) and output.write_image(whole)
    # Closed in any case: what is still buffered may fail now.
    if output is None or not output.close() or not done:
        raise refuse.Refusal(f"'{path}' could not be written: {said(output or OpenImageIO)}.")
    integers = {name: sheet.planes[name] for name, type in sheet.types.items() if type == "uint"}
    if integers:
        _set_integers(part, integers)


def _interleaved(sheet: Sheet) -> NDArray[np.float32]:
    rows, columns = sheet.shape
    whole = np.empty((rows, columns, len(sheet.planes)), np.float32)
    for k, plane in enumerate(sheet.planes.values()):
        whole[..., k] = 0 if plane.dtype == np.uint32 else plane
    return whole


def _set_integers(part: Path, planes: dict[str, NDArray[Any]]) -> None:
    """Put 32-bit integers in place: OpenImageIO writes all channels from float, which rounds them."""
    import OpenEXR

    file = OpenEXR.File(str(part), separate_channels=True)
    for name, plane in planes.items():
        file.channels()[name].pixels = np.ascontiguousarray(plane)
    part.unlink()
    file.write(str(part))


def spec_of(sheet: Sheet) -> "OpenImageIO.ImageSpec":
    """Say what a sheet holds in OpenImageIO's words.

    Parameters
    ----------
    sheet : Sheet
        What goes into a file.

    Returns
    -------
    ImageSpec
        Its channels with their pixel types, its attributes and windows.
    """
    import OpenImageIO

    rows, columns = sheet.shape
    types = [OpenImageIO.TypeDesc(type) for type in sheet.types.values()]
    spec = OpenImageIO.ImageSpec(columns, rows, len(types), types[0])
    spec.channelnames = tuple(sheet.planes)
    if len(set(sheet.types.values())) > 1:
        spec.channelformats = tuple(types)
    if "A" in sheet.planes and sheet.types["A"].startswith("uint"):
        spec.attribute("oiio:UnassociatedAlpha", 1)
    if sheet.compression:
        spec.attribute("compression", sheet.compression)
    spec.attribute("png:compressionLevel", PNG_LEVEL)
    spec.attribute("DateTime", "")  # else the writer invents a date of capture
    if sheet.format == "jpeg":
        spec.attribute("jpeg:subsampling", "4:4:4")
    for name, attribute in sheet.attributes.items():
        spec.attribute(name, OpenImageIO.TypeDesc(attribute.type), attribute.value)
    if sheet.windows:
        _set_windows(spec, sheet.windows)
    return spec


def _set_windows(spec: "OpenImageIO.ImageSpec", source: Header) -> None:
    data, display = source.data_window, source.display_window
    spec.x, spec.y = data.x, data.y
    spec.full_x, spec.full_y = display.x, display.y
    spec.full_width, spec.full_height = display.width, display.height
    if source.tile:
        spec.tile_height, spec.tile_width = source.tile
