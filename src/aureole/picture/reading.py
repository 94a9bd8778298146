"""Pixels in: `read` turns a picture file into a linear `Picture`.

Files of 8 and 16 bit integers are display-referred and decoded from sRGB; EXR, HDR and float TIFF are
linear already. Colour stays associated with alpha and is never divided by it; straight alpha, as in
PNG, is multiplied in after decoding.
"""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.picture import color_config as ocio
from aureole.picture import luminance_chroma
from aureole.picture.files import QUARTER_TURNS, describe, opened, orientation, refuse_memory, said
from aureole.picture.metadata import Header
from aureole.picture.transfer import decode_srgb
from aureole.records import Picture

if TYPE_CHECKING:
    import OpenImageIO

Planes = dict[str, NDArray[Any]]

_EXTRA_TYPES = {"half": np.float16, "uint": np.uint32}


def read(
    path: str | os.PathLike[str],
    *,
    nan: Literal["refuse", "zero"] = "refuse",
    memory: int | None = None,
    transfer: Literal["auto", "srgb", "linear"] = "auto",
    color_config: str | os.PathLike[str] | None = None,
    color_space: str | None = None,
) -> Picture:
    """Read a picture file as linear colour.

    Parameters
    ----------
    path : path_like
        EXR, HDR, TIFF, PNG or JPEG.
    nan : str
        "refuse", or "zero" to set NaN and infinity in the colour and alpha to zero.
    memory : int or None
        Bytes that the pixels may take; None is three quarters of what is free.
    transfer : str
        "auto" decodes sRGB from 8 and 16 bit integers, "srgb" always, "linear" never.
    color_config : path_like or None
        OpenColorIO configuration in which `color_space` is looked up; "ocio://..." names a built-in
        one, None is $OCIO or OpenImageIO's own.
    color_space : str or None
        Colour space of the file's numbers in that configuration; it takes the place of `transfer`.

    Returns
    -------
    Picture
        Float32 RGB or RGBA; its metadata as in `aureole.picture.metadata`.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read whole, has NaN or infinity, or needs more memory than allowed.
    """
    refuse.one_of("nan", nan, ("refuse", "zero"))
    refuse.one_of("transfer", transfer, ("auto", "srgb", "linear"))
    if color_config is not None and color_space is None:
        raise refuse.Refusal("'color_config' needs 'color_space': the space of the file's numbers.")
    header = describe(path)
    refuse_memory(path, header, memory)
    pixels, extra, straight = _stored(Path(path), header)
    notes, space = header.notes, header.colour_space
    if color_space is not None:
        pixels, space, more = ocio.to_working(pixels, color_config, color_space)
        notes += more
    elif transfer == "srgb" or (transfer == "auto" and _is_display_referred(header)):
        pixels[..., :3] = decode_srgb(pixels[..., :3])
    if straight and pixels.shape[-1] == 4:
        pixels[..., :3] *= pixels[..., 3:]
    notes += _mend(path, pixels, nan)
    return Picture(pixels, space, {"header": header, "extra_channels": extra, "notes": notes})


def _is_display_referred(header: Header) -> bool:
    return header.format != "openexr" and header.pixel_type.startswith("uint")


def _stored(path: Path, header: Header) -> tuple[NDArray[np.float32], Planes, bool]:
    """Read the file's numbers: colour, other channels, and whether alpha is straight."""
    if header.colour.is_luminance_chroma:
        planes = luminance_chroma.read(path, header)
        return (*_picked(planes, ("R", "G", "B"), header.colour.alpha), False)
    with opened(path) as source:
        assert source is not None  # only subsampled files are not opened
        spec = source.spec()
        planes = _planes(path, source, header)
    turn = orientation(spec, header.format)
    pixels, extra = _picked(planes, header.colour.names, header.colour.alpha)
    extra = {name: _upright(_as_stored(plane, name, header), turn) for name, plane in extra.items()}
    return _upright(pixels, turn), extra, spec.get_int_attribute("oiio:UnassociatedAlpha") == 1


def _planes(path: Path, source: "OpenImageIO.ImageInput", header: Header) -> Planes:
    """Read every channel, integers of EXR as they are."""
    names = [channel.name for channel in header.channels]
    planes = dict(zip(names, np.moveaxis(_numbers(path, source, 0, len(names), "float"), -1, 0), strict=True))
    for i, channel in enumerate(header.channels):
        # As float they would be scaled to 0..1 and lose their last digits.
        if header.format == "openexr" and channel.pixel_type == "uint":
            planes[channel.name] = _numbers(path, source, i, i + 1, "uint")[..., 0]
    return planes


def _numbers(path: Path, source: "OpenImageIO.ImageInput", begin: int, end: int, type: str) -> NDArray[Any]:
    numbers = source.read_image(0, 0, begin, end, type)
    # Both are asked for: some readers return what they have with an error.
    if numbers is None or source.has_error:
        raise refuse.Refusal(f"'{path}' is damaged or cut short: {said(source)}.")
    return numbers


def _picked(planes: Planes, names: tuple[str, ...], alpha: str | None) -> tuple[NDArray[np.float32], Planes]:
    """Split channels into the picture (grey on all three colours) and the rest."""
    colour = names * 3 if len(names) == 1 else names
    wanted = [*colour, alpha] if alpha else [*colour]
    shape = planes[wanted[0]].shape
    pixels = np.empty((*shape, len(wanted)), np.float32)
    for k, name in enumerate(wanted):
        pixels[..., k] = planes[name]
    return pixels, {name: plane for name, plane in planes.items() if name not in wanted}


def _as_stored(plane: NDArray[Any], name: str, header: Header) -> NDArray[Any]:
    """Give a channel its own pixel type again, apart from the picture's memory."""
    pixel_type = next(channel.pixel_type for channel in header.channels if channel.name == name)
    integers = pixel_type == "uint" and plane.dtype != np.uint32
    dtype = np.float32 if integers else _EXTRA_TYPES.get(pixel_type, np.float32)
    return np.array(plane, dtype=dtype)


def _upright(array: NDArray[Any], turn: int) -> NDArray[Any]:
    """Turn an array as its file's Orientation (Exif) asks, so that the first row is the top."""
    if turn in QUARTER_TURNS:
        array = np.swapaxes(array, 0, 1)
    if turn in (3, 4, 7, 8):
        array = array[::-1]
    if turn in (2, 3, 6, 7):
        array = array[:, ::-1]
    return np.ascontiguousarray(array)


def _mend(path: str | os.PathLike[str], pixels: NDArray[np.float32], nan: str) -> tuple[str, ...]:
    """Refuse NaN and infinity, or set them to zero and say so."""
    finite = np.isfinite(pixels)
    bad = pixels.size - int(np.count_nonzero(finite))
    if not bad:
        return ()
    if nan == "refuse":
        raise refuse.Refusal(f"'{path}' has {bad} values that are NaN or infinite; --nan zero mends them.")
    pixels[~finite] = 0
    return (f"'{Path(path).name}': {bad} values that were NaN or infinite are set to zero.",)
