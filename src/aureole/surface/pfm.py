"""Portable float maps: float32 pictures with three lines of header and the rows from the bottom up."""

import os
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse

_HEADER = re.compile(rb"(P[Ff])\s+(\d{1,6})\s+(\d{1,6})\s+([-+]?[0-9.]+(?:[eE][-+]?\d+)?)\s")


def write_pfm(path: str | os.PathLike[str], pixels: NDArray[np.floating]) -> None:
    """Write a portable float map, whole or not at all.

    Parameters
    ----------
    path : path_like
        Where the file shall lie.
    pixels : ndarray, shape (rows, columns) or (rows, columns, 3)
        Row 0 is the top.

    Raises
    ------
    refuse.Refusal
        Where the place cannot be written.
    """
    rows, columns = pixels.shape[:2]
    kind = "PF" if pixels.ndim == 3 else "Pf"
    with picture.whole_file(path) as part, part.open("wb") as file:
        file.write(f"{kind}\n{columns} {rows}\n-1.0\n".encode("ascii"))
        file.write(np.ascontiguousarray(pixels[::-1], dtype="<f4").tobytes())


def read_pfm(path: str | os.PathLike[str], memory: int | None = None) -> NDArray[np.float32]:
    """Read a portable float map.

    Parameters
    ----------
    path : path_like
        The file.
    memory : int or None
        Bytes that the pixels may take; None is three quarters of what is free.

    Returns
    -------
    ndarray of float32, shape (rows, columns) or (rows, columns, 3)
        Row 0 is the top. The header's scale says the byte order only.

    Raises
    ------
    refuse.Refusal
        Where the file is missing, damaged, too large, or has NaN or infinity.
    """
    place = Path(path)
    if not place.is_file():
        raise refuse.Refusal(f"There is no file '{place}'.")
    size = place.stat().st_size
    if size > picture.allowed_memory(memory):
        raise refuse.Refusal(f"'{place}' needs {size / 1e9:.3g} GB of memory, more than is allowed.")
    try:
        data = place.read_bytes()
    except OSError as error:
        raise refuse.Refusal(f"'{place}' cannot be read: {error.strerror}.") from None
    return np.asarray(refuse.all_finite(str(place), _pixels(data, place)), dtype=np.float32)


def _pixels(data: bytes, place: Path) -> NDArray[np.floating]:
    header = _HEADER.match(data)
    if header is None or float(header[4]) == 0.0:
        raise refuse.Refusal(f"'{place}' is damaged or no portable float map: its header makes no sense.")
    columns, rows, channels = int(header[2]), int(header[3]), 3 if header[1] == b"PF" else 1
    wanted, found = 4 * rows * columns * channels, len(data) - header.end()
    if wanted == 0 or found != wanted:
        raise refuse.Refusal(
            f"'{place}' is damaged or cut short: {wanted} bytes of pixels wanted, {found} found."
        )
    numbers = np.frombuffer(data, ">f4" if float(header[4]) > 0 else "<f4", offset=header.end())
    shape = (rows, columns, 3) if channels == 3 else (rows, columns)
    return numbers.reshape(shape)[::-1]
