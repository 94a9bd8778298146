"""Flipbooks in a file, so that a session starts at once: written whole or not at all."""

import json
import os
import zipfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from aureole import picture, refuse
from aureole.glare.eye import Eye, check_eye
from aureole.glare.flipbook import Flipbook, Flipbooks
from aureole.glare.glare_frames import GlareFrames
from aureole.picture import KernelMix

SUFFIX = ".npz"
VERSION = 1


def save_flipbooks(flipbooks: Flipbooks, path: str | os.PathLike[str]) -> None:
    """Write flipbooks to a file.

    Parameters
    ----------
    flipbooks : Flipbooks
        Any.
    path : path_like
        Ends in ".npz"; a file that exists is replaced.

    Raises
    ------
    refuse.Refusal
        Where the name ends otherwise, or the place cannot be written.
    """
    if Path(path).suffix != SUFFIX:
        raise refuse.Refusal(f"'path' of flipbooks must end in '{SUFFIX}', got '{path}'.")
    frames, kernels = flipbooks.frames, flipbooks.frames.kernels
    head = {
        "version": VERSION,
        "eye": {**asdict(flipbooks.eye), "zernike": list(flipbooks.eye.zernike.items())},
        "colour_space": flipbooks.colour_space,
        "shape": frames.shape,
        "field_of_view": frames.field_of_view,
        "resolution": frames.resolution,
        "books": {name: _said(book) for name, book in flipbooks.books.items()},
        "opening": _said(flipbooks.opening),
    }
    with picture.whole_file(path) as part:
        np.savez(
            part,
            head=np.array(json.dumps(head)),
            spectra=kernels.spectra,
            steps=kernels.steps,
            sums=kernels.sums,
            arriving=frames.arriving,
        )


def load_flipbooks(path: str | os.PathLike[str]) -> Flipbooks:
    """Read flipbooks from a file.

    Parameters
    ----------
    path : path_like
        Written by `save_flipbooks`.

    Returns
    -------
    Flipbooks
        As they were.

    Raises
    ------
    refuse.Refusal
        Where the file is missing, or holds no flipbooks of this version.
    """
    try:
        with Path(path).open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            held = {name: file[name] for name in file.files}
            return _flipbooks(json.loads(str(held.pop("head"))), held)
    except FileNotFoundError:
        raise refuse.Refusal(f"There is no file '{path}'.") from None
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile) as error:
        if isinstance(error, refuse.Refusal):
            raise
        raise refuse.Refusal(f"'{path}' holds no flipbooks.") from error


def _said(book: Flipbook) -> dict[str, Any]:
    return {"axes": book.axes, "first": book.first, "shares": book.shares.tolist()}


def _flipbooks(head: dict[str, Any], held: dict[str, Any]) -> Flipbooks:
    """Build the record of a file's head and arrays, refusing what does not fit together."""
    if head["version"] != VERSION:
        raise refuse.Refusal(f"'flipbooks' must be of version {VERSION}, got {head['version']}.")
    own: dict[str, Any] = head["eye"]
    zernike = {tuple(term) if isinstance(term, list) else term: rms for term, rms in own.pop("zernike")}
    lists: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value for name, value in own.items()
    }
    eye = check_eye(Eye(**lists, zernike=zernike))
    books = {name: _book(said) for name, said in head["books"].items()}
    shape, count = (int(head["shape"][0]), int(head["shape"][1])), len(held["sums"])
    is_even = held["spectra"].shape[-1] == 64
    room = GlareFrames.empty(shape, float(head["field_of_view"]), head["resolution"], 0, is_even)
    wanted = (count, *room.kernels.spectra.shape[1:])
    refuse.shape_of("spectra", held["spectra"], wanted)
    refuse.shape_of("steps", held["steps"], wanted[:4])
    refuse.shape_of("arriving", held["arriving"], (count, *room.arriving.shape[1:]))
    kernels = KernelMix(room.kernels.shape, room.kernels.reach, held["spectra"], held["steps"], held["sums"])
    frames = GlareFrames(shape, room.field_of_view, room.resolution, kernels, held["arriving"])
    return Flipbooks(eye, str(head["colour_space"]), books, frames, _book(head["opening"]))


def _book(said: dict[str, Any]) -> Flipbook:
    axes = tuple((str(name), tuple(float(node) for node in nodes)) for name, nodes in said["axes"])
    return Flipbook(axes, int(said["first"]), np.array(said["shares"], dtype=np.float64))
