"""Many pictures in one EXR: the plain channels are the picture, each layer has its own R, G and B.

One part holds all channels over the whole data window, which is what programs read best. A layer arrives as
the rectangle in which it is not black; the file is put together band by band, so that memory holds one band
of all layers, and what the layers hold beyond a limit waits on the disk.
"""

import os
import re
import tempfile
import weakref
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aureole import refuse
from aureole.picture.files import format_of, said
from aureole.picture.layout import Sheet, exr_sheet
from aureole.picture.metadata import Attribute, Window
from aureole.picture.whole_files import whole_file, writable
from aureole.picture.writing import spec_of
from aureole.records import Picture

if TYPE_CHECKING:  # imported where it is used, so that importing the room stays quick
    import OpenImageIO

CHANNELS = "RGB"
# A letter first, then letters, digits and _: Nuke takes digits off the front of a name and turns all other
# signs into _, so that such a name alone is the same everywhere and stays apart from others.
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
IN_MEMORY = 2**30  # bytes of layers beyond which they wait on the disk
BAND_BYTES = 2**26
BLOCK_ROWS = 16  # rows that ZIP compresses together
_BYTES = 4 * len(CHANNELS)


@dataclass(frozen=True)
class _Stored:
    """Where a layer's pixels lie in the picture, and in the store."""

    window: Window
    offset: int


class Layers:
    """Layers of one picture, kept small until they are written.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns) of the picture.
    in_memory : int
        Bytes of pixels beyond which all of them are put on the disk.
    """

    def __init__(self, shape: tuple[int, int], in_memory: int = IN_MEMORY) -> None:
        self.shape = shape
        self._stored: dict[str, _Stored] = {}
        self._file = tempfile.SpooledTemporaryFile(max_size=in_memory)  # noqa: SIM115
        weakref.finalize(self, self._file.close)

    @property
    def names(self) -> tuple[str, ...]:
        """The layers' names in the order in which they came."""
        return tuple(self._stored)

    def add(self, name: str, pixels: NDArray[np.float32], window: Window | None = None) -> None:
        """Add a layer.

        Parameters
        ----------
        name : str
            Letters, digits and "_", a letter first.
        pixels : ndarray of float32, shape (rows, columns, 3)
            Linear, in the picture's colour space.
        window : Window, optional
            Where they lie in the picture; all of it unless given. Outside a layer is black.

        Raises
        ------
        refuse.Refusal
            Where the name does not serve or is taken, or the pixels do not fit into the window or the
            window into the picture.
        """
        if not _NAME.fullmatch(name) or name in self._stored:
            raise refuse.Refusal(
                f"'layer' must have a name of its own of letters, digits and _, got '{name}'."
            )
        place = window or Window(0, 0, self.shape[1], self.shape[0])
        if place.width > 0 and place.height > 0:
            refuse.shape_of(f"pixels of layer '{name}'", pixels, (place.height, place.width, 3))
            refuse.all_finite(f"pixels of layer '{name}'", pixels)
            self._refuse_outside(name, place)
        self._file.seek(0, os.SEEK_END)
        self._stored[name] = _Stored(place, self._file.tell())
        self._file.write(np.ascontiguousarray(pixels, dtype=np.float32).data)

    def rows(self, first: int, last: int, out: NDArray[np.float32]) -> None:
        """Fill a band of all layers' channels.

        Parameters
        ----------
        first, last : int
            Rows of the picture, the last one not included.
        out : ndarray of float32, shape (last - first, columns, 3 * layers)
            Filled: R, G, B of each layer in order, black where it holds nothing.
        """
        out[:] = 0
        for k, stored in enumerate(self._stored.values()):
            window = stored.window
            top, bottom = max(first, window.y), min(last, window.y + window.height)
            if top >= bottom or not window.width:
                continue
            self._file.seek(stored.offset + (top - window.y) * window.width * _BYTES)
            held = self._file.read((bottom - top) * window.width * _BYTES)
            band = np.frombuffer(held, np.float32).reshape(bottom - top, window.width, 3)
            out[top - first : bottom - first, window.x : window.x + window.width, 3 * k : 3 * k + 3] = band

    def picture_of(self, name: str) -> NDArray[np.float32]:
        """Return one layer as a whole picture.

        Parameters
        ----------
        name : str
            Of a layer that is there.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 3)
            Black where it holds nothing.
        """
        window, offset = self._stored[name].window, self._stored[name].offset
        whole = np.zeros((*self.shape, 3), np.float32)
        self._file.seek(offset)
        held = np.frombuffer(self._file.read(window.width * window.height * _BYTES), np.float32)
        inside = whole[window.y : window.y + window.height, window.x : window.x + window.width]
        inside[:] = held.reshape(inside.shape)
        return whole

    def _refuse_outside(self, name: str, window: Window) -> None:
        rows, columns = self.shape
        right, bottom = window.x + window.width, window.y + window.height
        if window.x < 0 or window.y < 0 or right > columns or bottom > rows:
            raise refuse.Refusal(
                f"layer '{name}' must lie within {columns} x {rows} pixels, "
                f"got columns {window.x} to {right} and rows {window.y} to {bottom}."
            )


def write_layers(path: str | os.PathLike[str], picture: Picture, layers: Layers) -> tuple[str, ...]:
    """Write a picture and its layers as one EXR of float32, compressed by ZIP.

    The plain channels are the picture; its windows and attributes are kept. Layer "ghosts" becomes the
    channels ghosts.R, ghosts.G and ghosts.B, in the picture's colour space.

    Parameters
    ----------
    path : path_like
        Where the file shall lie, an .exr.
    picture : Picture
        Linear, with or without alpha.
    layers : Layers
        Of the picture's size.

    Returns
    -------
    tuple of str
        What a person should know: what was left out.

    Raises
    ------
    refuse.Refusal
        Where the place cannot be written, or is no EXR, or the sizes differ.
    """
    place = writable(path)
    if format_of(path) != "openexr":
        raise refuse.Refusal(f"only EXR holds layers; '{place.name}' must end in .exr.")
    pixels = refuse.all_finite("pixels", picture.pixels)
    refuse.shape_of("pixels", pixels, (*layers.shape, None))
    sheet = exr_sheet(replace(picture, pixels=pixels.astype(np.float32, copy=False)), "float", "zip")
    sheet = _in_scanlines(_without_integers(sheet))
    names = [f"{layer}.{channel}" for layer in layers.names for channel in CHANNELS]
    taken = [name for name in names if name in sheet.planes]
    if taken:
        raise refuse.Refusal(f"'{place.name}': the picture has a channel '{taken[0]}' of its own already.")
    with whole_file(place) as part:
        _save(part, path, sheet, names, layers)
    return tuple(f"'{place.name}': {note}." for note in sheet.notes)


def attributes_of(values: Mapping[str, str | float | int]) -> dict[str, Attribute]:
    """Return attributes for a file, their names behind "aureole:".

    Parameters
    ----------
    values : mapping
        Names to text or numbers.

    Returns
    -------
    dict of str to Attribute
        For `with_attributes`.
    """
    types = {str: "string", int: "int", float: "float"}
    return {f"aureole:{name}": Attribute(types[type(value)], value) for name, value in values.items()}


def _without_integers(sheet: Sheet) -> Sheet:
    """Leave out channels of 32-bit integers, which bands of floats would round."""
    left = [name for name, type in sheet.types.items() if type == "uint"]
    if not left:
        return sheet
    note = f"it holds floats alone, so the integers of {', '.join(left)} are left out"
    return replace(
        sheet,
        planes={name: plane for name, plane in sheet.planes.items() if name not in left},
        types={name: type for name, type in sheet.types.items() if name not in left},
        notes=(*sheet.notes, note),
    )


def _in_scanlines(sheet: Sheet) -> Sheet:
    return sheet if sheet.windows is None else replace(sheet, windows=replace(sheet.windows, tile=None))


def _save(part: Path, path: str | os.PathLike[str], sheet: Sheet, names: list[str], layers: Layers) -> None:
    """Write the temporary file band by band, every step checked."""
    import OpenImageIO

    spec = _with_layers(spec_of(sheet), sheet, names)
    rows, columns = sheet.shape
    height = max(1, BAND_BYTES // (4 * spec.nchannels * columns * BLOCK_ROWS)) * BLOCK_ROWS
    output = OpenImageIO.ImageOutput.create(str(part))
    done = output is not None and output.open(str(part), spec)
    for first in range(0, rows if done else 0, height):
        assert output is not None
        last = min(first + height, rows)
        band = np.empty((last - first, columns, spec.nchannels), np.float32)
        for k, plane in enumerate(sheet.planes.values()):
            band[..., k] = plane[first:last]
        layers.rows(first, last, band[..., len(sheet.planes) :])
        done = done and output.write_scanlines(spec.y + first, spec.y + last, spec.z, band)
    # Closed in any case: what is still buffered may fail now.
    if output is None or not output.close() or not done:
        raise refuse.Refusal(f"'{path}' could not be written: {said(output or OpenImageIO)}.")


def _with_layers(spec: "OpenImageIO.ImageSpec", sheet: Sheet, names: list[str]) -> "OpenImageIO.ImageSpec":
    import OpenImageIO

    types = [OpenImageIO.TypeDesc(type) for type in sheet.types.values()]
    types += [OpenImageIO.TypeDesc("float")] * len(names)
    spec.nchannels = len(types)
    spec.channelnames = (*sheet.planes, *names)
    spec.channelformats = tuple(types)
    return spec
