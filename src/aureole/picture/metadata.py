"""What a picture file says besides its pixels, as records, and the notes for the person who gave it.

A `Picture` that was read carries in its metadata:

- ``"header"``: a `Header`, what the file said;
- ``"extra_channels"``: mapping of name to array (rows, columns), in the file's own pixel type;
- ``"notes"``: tuple of str, what a person should know (not refusals); the command line prints them.

Work on a picture passes the metadata on; `write` gives the windows, attributes and channels back.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from aureole.records import Picture


@dataclass(frozen=True)
class Window:
    """A rectangle of pixels; the first pixel's place may be negative (overscan).

    Parameters
    ----------
    x, y : int
        Column and row of the first pixel.
    width, height : int
        Number of columns and rows.
    """

    x: int
    y: int
    width: int
    height: int


# The attribute in which a file says in words what it is.
DESCRIPTION = "ImageDescription"


@dataclass(frozen=True)
class Attribute:
    """One attribute of a file.

    Parameters
    ----------
    type : str
        OpenImageIO's name of its type: "string", "float", "timecode", "float[8]".
    value : object
        Number, text or tuple.
    """

    type: str
    value: Any


@dataclass(frozen=True)
class Channel:
    """One channel of a file.

    Parameters
    ----------
    name : str
        Its name in the file.
    pixel_type : str
        "half", "float", "uint", "uint8" or "uint16".
    """

    name: str
    pixel_type: str


@dataclass(frozen=True)
class Colour:
    """Which of a file's channels are the picture.

    Parameters
    ----------
    names : tuple of str
        Three names for red, green and blue, one for grey, or Y, RY and BY.
    alpha : str or None
        The alpha channel's name.
    """

    names: tuple[str, ...]
    alpha: str | None = None

    @property
    def is_luminance_chroma(self) -> bool:
        """Whether the colour is luminance and chroma."""
        return tuple(name.upper() for name in self.names) == ("Y", "RY", "BY")

    @property
    def is_rgb(self) -> bool:
        """Whether the colour is red, green and blue."""
        return len(self.names) == 3 and not self.is_luminance_chroma


@dataclass(frozen=True)
class Header:
    """What a file says besides its pixels.

    Parameters
    ----------
    format : str
        "openexr", "hdr", "tiff", "png" or "jpeg".
    data_window : Window
        The pixels that the file has.
    display_window : Window
        The pixels that are meant to be seen.
    channels : tuple of Channel
        Every channel, in OpenImageIO's order.
    colour : Colour
        Which of them are the picture.
    colour_space : str
        One of the names in `aureole.light.SPACES`, recognised or assumed.
    chromaticities : tuple of float or None
        (x, y) of red, green, blue and white, where the file says them.
    pixel_aspect : float
        Width of a pixel over its height.
    compression : str
        The file's, "" where it has none to name.
    tile : tuple of int or None
        Tile size as (rows, columns), None for scanlines.
    attributes : mapping of str to Attribute
        Everything else that is carried through.
    notes : tuple of str
        What a person should know about how the file is read.
    """

    format: str
    data_window: Window
    display_window: Window
    channels: tuple[Channel, ...]
    colour: Colour
    colour_space: str = "rec709"
    chromaticities: tuple[float, ...] | None = None
    pixel_aspect: float = 1.0
    compression: str = ""
    tile: tuple[int, int] | None = None
    attributes: Mapping[str, Attribute] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the pixels that the file has."""
        return self.data_window.height, self.data_window.width

    @property
    def pixel_type(self) -> str:
        """Pixel type of the colour."""
        return next(channel.pixel_type for channel in self.channels if channel.name == self.colour.names[0])

    @property
    def memory(self) -> int:
        """Bytes that reading takes: four for each channel of each pixel, in the file and in the picture."""
        picture = 3 + (self.colour.alpha is not None)
        return self.data_window.height * self.data_window.width * (len(self.channels) + picture) * 4


def text_of(stored: bytes) -> str:
    """Read a file's text, whatever program wrote it.

    Parameters
    ----------
    stored : bytes
        The bytes in the file.

    Returns
    -------
    str
        Taken as UTF-8, else as Latin-1.
    """
    try:
        return stored.decode()
    except UnicodeDecodeError:
        return stored.decode("latin-1")


def header_of(picture: Picture) -> Header | None:
    """Find what a picture's file said.

    Parameters
    ----------
    picture : Picture
        Any picture.

    Returns
    -------
    Header or None
        None where the picture was made, not read.
    """
    header = picture.metadata.get("header")
    return header if isinstance(header, Header) else None


def extra_channels(picture: Picture) -> Mapping[str, np.ndarray]:
    """Find the channels that are carried beside a picture's colour.

    Parameters
    ----------
    picture : Picture
        Any picture.

    Returns
    -------
    mapping of str to ndarray
        Arrays (rows, columns) by name; empty where there are none.
    """
    found: Mapping[str, np.ndarray] = picture.metadata.get("extra_channels", {})
    return found


def notes(picture: Picture) -> tuple[str, ...]:
    """List what a person should know about a picture.

    Parameters
    ----------
    picture : Picture
        Any picture.

    Returns
    -------
    tuple of str
        One line each.
    """
    return tuple(picture.metadata.get("notes", ()))


def with_notes(picture: Picture, *more: str) -> Picture:
    """Add notes to a picture.

    Parameters
    ----------
    picture : Picture
        Any picture.
    *more : str
        Lines to add.

    Returns
    -------
    Picture
        The same pixels with the longer list.
    """
    return replace(picture, metadata={**picture.metadata, "notes": (*notes(picture), *more)})


def with_attributes(picture: Picture, attributes: Mapping[str, Attribute]) -> Picture:
    """Let the files of a picture say more.

    Parameters
    ----------
    picture : Picture
        Any picture.
    attributes : mapping of str to Attribute
        EXR holds all of them. "ImageDescription", a text, is held by every format but HDR.

    Returns
    -------
    Picture
        The same pixels with a header that has them besides what was there.
    """
    header = header_of(picture)
    if header is None:
        rows, columns, count = picture.pixels.shape
        whole, names = Window(0, 0, columns, rows), "RGBA"[:count]
        header = Header(
            format="openexr",
            data_window=whole,
            display_window=whole,
            channels=tuple(Channel(name, "float") for name in names),
            colour=Colour(("R", "G", "B"), "A" if count == 4 else None),
            colour_space=picture.colour_space,
            compression="zip",
        )
    header = replace(header, attributes={**header.attributes, **attributes})
    return replace(picture, metadata={**picture.metadata, "header": header})
