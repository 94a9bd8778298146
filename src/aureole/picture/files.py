"""What a picture file is, from its header alone: `describe`, and the refusals before any pixel is read."""

import contextlib
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from aureole import refuse
from aureole.picture import luminance_chroma, primaries, radiance
from aureole.picture.channels import choose_colour
from aureole.picture.metadata import DESCRIPTION, Attribute, Channel, Header, Window, text_of

if TYPE_CHECKING:  # imported where it is used, so that importing the room stays quick
    import OpenImageIO

# The suffixes that are read and written, with OpenImageIO's name of each format.
SUFFIXES = {
    ".exr": "openexr",
    ".hdr": "hdr",
    ".tif": "tiff",
    ".tiff": "tiff",
    ".png": "png",
    ".jpg": "jpeg",
    ".jpeg": "jpeg",
}
# Values of Exif's Orientation that swap rows and columns.
QUARTER_TURNS = (5, 6, 7, 8)
MEMORY_SHARE = 0.75
# Attributes that say how the file is laid out or encoded; writing says its own.
_LAYOUT = ("oiio:", "openexr:", "tiff:", "png:", "jpeg:", "thumbnail_", "iccprofile", "exif:pixel")
_LAYOUT_NAMES = {
    "compression",
    "chromaticities",
    "pixelaspectratio",
    "planarconfig",
    "colorinteropid",
    "cicp",
    "exif:colorspace",
    "textureformat",
    "name",
}
_DISPLAY_SPACES = ("srgb_rec709_scene", "srgb_rec709_display", "")


def format_of(path: str | os.PathLike[str]) -> str:
    """Find the format that a file's suffix names.

    Parameters
    ----------
    path : path_like
        A file, there or not.

    Returns
    -------
    str
        OpenImageIO's name of the format.

    Raises
    ------
    refuse.Refusal
        Where the suffix is none of `SUFFIXES`.
    """
    suffix = refuse.one_of(f"suffix of {Path(path).name}", Path(path).suffix.lower(), SUFFIXES)
    return SUFFIXES[suffix]


def describe(path: str | os.PathLike[str]) -> Header:
    """Read what a picture file says without reading its pixels.

    Parameters
    ----------
    path : path_like
        The file.

    Returns
    -------
    Header
        Size, windows, channels with their pixel types, colour space, attributes and notes.

    Raises
    ------
    refuse.Refusal
        Where the file is missing, a folder, of an unknown suffix, not readable, deep or without colour.
    """
    place = _readable(path)
    with opened(place) as source:
        if source is not None:
            return _header(place, source)
    return luminance_chroma.describe(place)


@contextlib.contextmanager
def opened(path: Path) -> Iterator["OpenImageIO.ImageInput | None"]:
    """Open a picture for reading, its alpha as it is in the file.

    Parameters
    ----------
    path : Path
        The file.

    Yields
    ------
    ImageInput or None
        None where it has subsampled channels, which OpenImageIO does not read.

    Raises
    ------
    refuse.Refusal
        Where it is no picture or its header is damaged.
    """
    import OpenImageIO

    said(OpenImageIO)  # what went wrong earlier is not this file's
    config = OpenImageIO.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    source = OpenImageIO.ImageInput.open(str(path), config)
    if source is None:
        reason = said(OpenImageIO)
        if "Subsampled" not in reason:
            raise refuse.Refusal(f"'{path}' cannot be read, it is damaged or no picture: {reason}.")
        yield None
        return
    try:
        yield source
    finally:
        source.close()


def said(speaker: object) -> str:
    """Take OpenImageIO's last error as one line.

    Parameters
    ----------
    speaker : module or object
        What has ``geterror``.

    Returns
    -------
    str
        Its first line without the full stop.
    """
    try:
        text = str(speaker.geterror())  # type: ignore[attr-defined]
    except UnicodeDecodeError:  # it quotes the damaged bytes
        text = ""
    lines = text.strip().splitlines() or ["its bytes make no sense"]
    return lines[0].strip().rstrip(".")


def allowed_memory(allowed: int | None = None) -> int:
    """Return how much memory may be used.

    Parameters
    ----------
    allowed : int or None
        Bytes; None is three quarters of what is free.

    Returns
    -------
    int
        Bytes.
    """
    import psutil

    return int(MEMORY_SHARE * psutil.virtual_memory().available) if allowed is None else allowed


def refuse_memory(path: str | os.PathLike[str], header: Header, allowed: int | None = None) -> None:
    """Refuse a picture that would need more memory than is allowed.

    Parameters
    ----------
    path : path_like
        The file, for the message.
    header : Header
        What it says.
    allowed : int or None
        Bytes; None is three quarters of what is free.

    Raises
    ------
    refuse.Refusal
        Where its pixels need more.
    """
    limit = allowed_memory(allowed)
    if header.memory > limit:
        rows, columns = header.shape
        raise refuse.Refusal(
            f"'{path}' ({columns} x {rows} pixels, {len(header.channels)} channels) needs "
            f"{header.memory / 1e9:.3g} GB of memory, {limit / 1e9:.3g} GB are allowed; see --memory."
        )


def orientation(spec: "OpenImageIO.ImageSpec", format: str) -> int:
    """Find how a picture lies in its file.

    Parameters
    ----------
    spec : ImageSpec
        The file's header.
    format : str
        OpenImageIO's name of its format.

    Returns
    -------
    int
        Exif's Orientation; 1 is upright, and so is every EXR, which has no such thing.
    """
    return 1 if format == "openexr" else int(spec.get_int_attribute("Orientation", 1))


def _turned(window: Window) -> Window:
    return Window(window.y, window.x, window.height, window.width)


def _readable(path: str | os.PathLike[str]) -> Path:
    place = Path(path)
    if place.is_dir():
        raise refuse.Refusal(f"'{place}' is a folder, not a picture.")
    if not place.exists():
        raise refuse.Refusal(f"There is no file '{place}'.")
    format_of(place)
    if not os.access(place, os.R_OK):
        raise refuse.Refusal(f"'{place}' cannot be read: permission denied.")
    return place


def _header(path: Path, source: "OpenImageIO.ImageInput") -> Header:
    spec, format = source.spec(), source.format_name()
    if format not in SUFFIXES.values():
        raise refuse.Refusal(f"'{path}' is in fact a {format} file; use {', '.join(SUFFIXES)}.")
    if spec.deep:
        raise refuse.Refusal(f"'{path}' is a deep picture; flatten it first.")
    if min(spec.width, spec.height, spec.nchannels) < 1:
        raise refuse.Refusal(f"'{path}' has no pixels ({spec.width} x {spec.height}).")
    colour, layer_note = choose_colour(spec.channelnames)
    if colour is None:
        raise refuse.Refusal(f"'{path}' has no R, G, B or Y channel, only {', '.join(spec.channelnames)}.")
    space, chromaticities, space_note = _colour_space(spec, format)
    data = Window(spec.x, spec.y, spec.width, spec.height)
    display = Window(spec.full_x, spec.full_y, spec.full_width, spec.full_height)
    attributes, lost_note = _attributes(spec, format)
    words = radiance.words_of(path) if format == "hdr" else None
    if words is not None:
        attributes[DESCRIPTION] = Attribute("string", words)
    turned = orientation(spec, format) in QUARTER_TURNS
    aspect = spec.get_float_attribute("PixelAspectRatio", 1.0) or 1.0
    return Header(
        format=format,
        data_window=_turned(data) if turned else data,
        display_window=_turned(display) if turned else display,
        channels=_channels(spec),
        colour=colour,
        colour_space=space,
        chromaticities=chromaticities,
        pixel_aspect=1 / aspect if turned else aspect,
        compression=spec.get_string_attribute("compression"),
        tile=(spec.tile_height, spec.tile_width) if spec.tile_width else None,
        attributes=attributes,
        notes=_notes(path, _parts(spec), layer_note, space_note, _display_note(spec, format), lost_note),
    )


def _channels(spec: "OpenImageIO.ImageSpec") -> tuple[Channel, ...]:
    return tuple(Channel(name, str(spec.channelformat(i))) for i, name in enumerate(spec.channelnames))


def _notes(path: Path, *texts: str) -> tuple[str, ...]:
    return tuple(f"'{path.name}': {text}." for text in texts if text)


def _parts(spec: "OpenImageIO.ImageSpec") -> str:
    parts = spec.get_int_attribute("oiio:subimages", 1)
    name = spec.get_string_attribute("oiio:subimagename")
    return f"it has {parts} parts; the first{f', {name!r},' if name else ''} is read" if parts > 1 else ""


def _colour_space(spec: "OpenImageIO.ImageSpec", format: str) -> tuple[str, tuple[float, ...] | None, str]:
    """Recognise the primaries of a linear file; a display-referred one is Rec.709."""
    stated = spec.getattribute("chromaticities")
    chromaticities = tuple(float(value) for value in stated) if _is_eight(stated) else None
    if chromaticities:
        space = primaries.recognise(chromaticities)
        note = "" if space else "its primaries are none of the known spaces'; they are treated as working RGB"
        return space or "rec709", chromaticities, note
    space = primaries.INTERCHANGE.get(spec.get_string_attribute("oiio:ColorSpace"), "rec709")
    return (space if format == "openexr" else "rec709"), None, ""


def _is_eight(value: object) -> bool:
    return isinstance(value, Sequence) and len(value) == 8


def _display_note(spec: "OpenImageIO.ImageSpec", format: str) -> str:
    """Say where a display-referred file says that it is something else than sRGB."""
    if format == "openexr" or not str(spec.format).startswith("uint"):
        return ""
    profile = spec.get_string_attribute("ICCProfile:profile_description")
    if profile and "srgb" not in profile.lower():
        return f"its profile is '{profile}'; its numbers are taken as sRGB"
    space = spec.get_string_attribute("oiio:ColorSpace")
    return "" if space in _DISPLAY_SPACES else f"it says '{space}'; its numbers are taken as sRGB"


def _attributes(spec: "OpenImageIO.ImageSpec", format: str) -> tuple[dict[str, Attribute], str]:
    """Keep what a file says besides its layout, and name what cannot be given back."""
    kept, lost = {}, []
    for attribute in spec.extra_attribs:
        name = attribute.name.lower()
        laid_out = name.startswith(_LAYOUT) or name in _LAYOUT_NAMES
        # Orientation is obeyed on reading, except in EXR, where nobody does.
        if laid_out or (name == "orientation" and format != "openexr"):
            continue
        found = _attribute(attribute)
        if found:
            kept[attribute.name] = found
        else:
            lost.append(attribute.name)
    return kept, f"attributes that cannot be carried: {', '.join(lost)}" if lost else ""


def _attribute(attribute: "OpenImageIO.ParamValue") -> Attribute | None:
    """Take an attribute if it can be given back; text that is not UTF-8 is taken as Latin-1."""
    import OpenImageIO

    type, value = str(attribute.type), attribute.value
    if type.startswith("uint8["):  # bytes of a type that the library does not know
        return None
    if isinstance(value, str):
        value = text_of(value.encode(errors="surrogateescape"))
    try:
        OpenImageIO.ImageSpec().attribute(attribute.name, OpenImageIO.TypeDesc(type), value)
    except (RuntimeError, TypeError, ValueError):
        return None
    return Attribute(type, value)
