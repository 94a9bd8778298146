"""Photographs from files, as planes to merge: linear pictures, portable float maps, brackets with Exif."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.surface.pfm import read_pfm

CHANNELS = ("mean", "red", "green", "blue", "all")
_SPEEDS = (
    "Exif:PhotographicSensitivity",
    "Exif:ISOSpeedRatings",
    "PhotographicSensitivity",
    "ISOSpeedRatings",
)


@dataclass(frozen=True, eq=False)
class Photographs:
    """A bracket as read.

    Parameters
    ----------
    planes : tuple of ndarray of float32, each of shape (rows, columns) or (rows, columns, 3)
        Of one shape, in the order of the files.
    exposures : tuple of float or None
        Seconds × ISO / 100 / f-number² of each, as far as the files say them; None where one says no time.
    names : tuple of str
        Of the files.
    """

    planes: tuple[NDArray[np.float32], ...]
    exposures: tuple[float, ...] | None
    names: tuple[str, ...]


def read_photographs(
    paths: Sequence[str | os.PathLike[str]],
    channel: str = "mean",
    transfer: str = "auto",
    memory: int | None = None,
) -> Photographs:
    """Read one HDR photograph, or a bracket.

    Parameters
    ----------
    paths : sequence of path_like
        Portable float maps, or what `picture.read` takes.
    channel : {"mean", "red", "green", "blue", "all"}
        Which channel of a colour file; "all" keeps three.
    transfer : {"auto", "srgb", "linear"}
        "auto" decodes sRGB from files of integers; "linear" leaves their numbers as they are, 0 to 1, for
        linear TIFF, or for `camera_response`.
    memory : int or None
        Bytes that all pixels may take; None is three quarters of what is free.

    Returns
    -------
    Photographs
        The bracket.

    Raises
    ------
    refuse.Refusal
        Where there is no file, one cannot be read, or sizes differ.
    """
    refuse.one_of("channel", channel, CHANNELS)
    refuse.one_of("transfer", transfer, ("auto", "srgb", "linear"))
    if not paths:
        raise refuse.Refusal("There is no photograph; give one HDR picture or the files of a bracket.")
    left = picture.allowed_memory(memory)
    planes: list[NDArray[np.float32]] = []
    times: list[float | None] = []
    for path in paths:
        pixels, time = _read(path, transfer, left)
        plane = _picked(pixels, channel)
        if planes and plane.shape != planes[0].shape:
            raise refuse.Refusal(
                f"'{path}' is of {_size(plane)} pixels, '{paths[0]}' of {_size(planes[0])}: not one bracket."
            )
        left -= plane.nbytes
        planes.append(plane)
        times.append(time)
    told = tuple(time for time in times if time is not None)
    names = tuple(Path(path).name for path in paths)
    return Photographs(tuple(planes), told if len(told) == len(planes) else None, names)


def exposure_said(header: picture.Header) -> float | None:
    """Return the exposure that a picture's Exif says.

    Parameters
    ----------
    header : picture.Header
        What the file says.

    Returns
    -------
    float or None
        Seconds × ISO / 100 / f-number², what is not said being 1; None where no time is said.
    """
    time = _number(header, ("ExposureTime", "Exif:ExposureTime"))
    if time is None:
        return None
    stop = _number(header, ("FNumber", "Exif:FNumber")) or 1.0
    return time * (_number(header, _SPEEDS) or 100.0) / 100.0 / stop**2


def _read(
    path: str | os.PathLike[str], transfer: str, memory: int
) -> tuple[NDArray[np.float32], float | None]:
    """Read one file's pixels, and its exposure where it says one."""
    if Path(path).suffix.lower() == ".pfm":
        return read_pfm(path, memory), None
    found = picture.read(path, transfer=transfer, memory=memory)  # type: ignore[arg-type]
    header = picture.header_of(found)
    return found.pixels[..., :3], None if header is None else exposure_said(header)


def _picked(pixels: NDArray[np.float32], channel: str) -> NDArray[np.float32]:
    if pixels.ndim == 2:
        return np.repeat(pixels[..., None], 3, axis=2) if channel == "all" else pixels
    if channel == "all":
        return pixels
    if channel == "mean":
        return np.asarray(pixels.mean(axis=2), dtype=np.float32)
    return np.ascontiguousarray(pixels[..., CHANNELS.index(channel) - 1])


def _number(header: picture.Header, names: Sequence[str]) -> float | None:
    """Return the first positive number among attributes."""
    for name in names:
        attribute = header.attributes.get(name)
        if attribute is not None and isinstance(attribute.value, int | float) and attribute.value > 0:
            return float(attribute.value)
    return None


def _size(plane: NDArray[np.float32]) -> str:
    return f"{plane.shape[1]} x {plane.shape[0]}"
