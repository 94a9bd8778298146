"""Lights in a file: a line for each light of each frame, which people and other programs can write, too.

Each line is a JSON object. Only the place is needed; a light without a frame stands in every frame, and one
without a flux is as strong as the picture shows it:

    {"x": 812.4, "y": 301.7, "flux": 5200.0, "colour": [1.3, 0.93, 0.71], "size": 6.2}
    {"frame": 1001, "id": 3, "x": 812.4, "y": 301.7, "flux": 5200.0, "box": [808, 297, 817, 306]}

A first line may say what holds for all:

    {"lamps": 1, "width": 1920, "height": 1080, "colour_space": "rec709"}
"""

import json
import math
import os
from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from aureole import light, picture, refuse
from aureole.glare.lamps import Lamp
from aureole.glare.tracks import Sighting

VERSION = 1
FARTHEST = 10**6
HEADER = {"lamps", "width", "height", "colour_space", "threshold", "connect", "frames"}
# How far a picture may be from the proportions of the one that lights were found in, in its own pixels.
PROPORTIONS = 1.0
KEYS = {"frame", "id", "x", "y", "flux", "colour", "size", "box", "peak", "merged"}


@dataclass(frozen=True)
class LampList:
    """Lights, and of which pictures.

    Parameters
    ----------
    sightings : tuple of Sighting
        By frame; a light without one stands in every frame, and comes first.
    shape : tuple of int, optional
        (rows, columns) of the pictures.
    colour_space : str
        In which colours are.
    threshold : float, optional
        Luminance that a pixel of a light has.
    frames : tuple of int
        Those that were looked at, with lights or without; none where the file does not say.
    connect : int
        As in `find_lamps`.
    """

    sightings: tuple[Sighting, ...]
    shape: tuple[int, int] | None = None
    colour_space: str = "rec709"
    threshold: float | None = None
    frames: tuple[int, ...] = ()
    connect: int = 1

    def at(self, frame: int | None) -> list[Sighting]:
        """Return the lights of a frame, those that stand in every one among them."""
        return [sighting for sighting in self.sightings if sighting.frame in (None, frame)]

    def scaled_to(self, shape: tuple[int, int]) -> "LampList":
        """Return the same lights on pictures of another size, such as the full size after a proxy.

        Parameters
        ----------
        shape : tuple of int
            (rows, columns).

        Returns
        -------
        LampList
            Places, sizes and boxes in its pixels; the flux grows with their number.

        Raises
        ------
        refuse.Refusal
            Where the proportions differ.
        """
        if self.shape in (None, shape):
            return self
        assert self.shape is not None
        (rows, columns), (old_rows, old_columns) = shape, self.shape
        factor = columns / old_columns
        if abs(old_rows * factor - rows) > PROPORTIONS * max(factor, 1.0):
            raise refuse.Refusal(
                f"the lights are of pictures of {old_columns} x {old_rows} pixels, "
                f"whose proportions {columns} x {rows} pixels have not."
            )
        moved = [replace(seen, lamp=_scaled(seen.lamp, factor)) for seen in self.sightings]
        return replace(self, sightings=tuple(moved), shape=shape)


def write_lamps(path: str | os.PathLike[str], lamps: LampList) -> None:
    """Write lights to a file.

    Parameters
    ----------
    path : path_like
        The file; it appears whole or not at all.
    lamps : LampList
        The lights.

    Raises
    ------
    refuse.Refusal
        Where it cannot be written.
    """
    first: dict[str, Any] = {"lamps": VERSION, "colour_space": lamps.colour_space}
    if lamps.shape is not None:
        first |= {"width": lamps.shape[1], "height": lamps.shape[0]}
    if lamps.threshold is not None:
        first["threshold"] = lamps.threshold
    if lamps.connect > 1:
        first["connect"] = lamps.connect
    if lamps.frames:
        first["frames"] = list(lamps.frames)
    lines = [first, *(_line(sighting) for sighting in lamps.sightings)]
    with picture.whole_file(path) as part:
        part.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")


def read_lamps(path: str | os.PathLike[str]) -> LampList:
    """Read lights from a file.

    Parameters
    ----------
    path : path_like
        As `write_lamps` writes it, or written by hand.

    Returns
    -------
    LampList
        Lights without a number get theirs by their order in the frame; the flux is 0 where none is said.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be read, or a line is no light; it says which.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no text"
        raise refuse.Refusal(f"'{path}' cannot be read: {reason}.") from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    given = [(f"{path}, line {number}", _object(f"{path}, line {number}", line)) for number, line in lines]
    header: dict[str, Any] = {}
    if given and "lamps" in given[0][1]:
        header = _header(*given.pop(0))
    sightings: list[Sighting] = []
    counts: dict[int | None, int] = {}
    for where, values in given:
        frame = _whole(where, "frame", values["frame"]) if "frame" in values else None
        counts[frame] = counts.get(frame, 0) + 1
        sightings.append(_sighting(where, values, frame, counts[frame]))
    sightings.sort(key=lambda sighting: -1 if sighting.frame is None else sighting.frame)
    return LampList(tuple(sightings), **header)


def _line(sighting: Sighting) -> dict[str, Any]:
    lamp = sighting.lamp
    line: dict[str, Any] = {} if sighting.frame is None else {"frame": sighting.frame}
    line |= {"id": sighting.id, "x": lamp.place[0], "y": lamp.place[1]}
    line |= {"flux": lamp.flux} if lamp.flux > 0 else {}
    line |= {"colour": list(lamp.colour), "size": lamp.size, "box": list(lamp.box), "peak": lamp.peak}
    return line | ({"merged": list(sighting.merged)} if sighting.merged else {})


def _object(where: str, line: str) -> dict[str, Any]:
    try:
        values = json.loads(line)
    except json.JSONDecodeError:
        values = None
    if not isinstance(values, dict):
        raise refuse.Refusal(f'{where}: must be a JSON object such as {{"x": 812, "y": 301, "flux": 5000}}.')
    return values


def _header(where: str, values: dict[str, Any]) -> dict[str, Any]:
    _known(where, values, HEADER)
    if values["lamps"] != VERSION:
        raise refuse.Refusal(f"{where}: this version reads lamps {VERSION}, got {values['lamps']}.")
    header: dict[str, Any] = {}
    if "width" in values or "height" in values:
        header["shape"] = tuple(
            _whole(where, name, _given(where, name, values), 1) for name in ("height", "width")
        )
    if "colour_space" in values:
        space = str(values["colour_space"])
        header["colour_space"] = refuse.one_of(f"{where}: colour_space", space, light.SPACES)
    if "threshold" in values:
        header["threshold"] = refuse.positive(f"{where}: threshold", values["threshold"])
    if "connect" in values:
        header["connect"] = _whole(where, "connect", values["connect"], 1)
    if "frames" in values:
        header["frames"] = tuple(_numbers(where, "frames", values["frames"], None, whole=True))
    return header


def _sighting(where: str, values: dict[str, Any], frame: int | None, order: int) -> Sighting:
    _known(where, values, KEYS)
    place = [refuse.finite(f"{where}: {name}", _given(where, name, values)) for name in ("x", "y")]
    colour = _numbers(where, "colour", values.get("colour", [1.0, 1.0, 1.0]), 3)
    box = _numbers(where, "box", values.get("box", [0, 0, 0, 0]), 4, whole=True)
    size = refuse.between(f"{where}: size", values.get("size", 0.0), 0.0, 1e6)
    lamp = Lamp(
        (place[0], place[1]),
        refuse.positive(f"{where}: flux", values["flux"]) if "flux" in values else 0.0,
        (colour[0], colour[1], colour[2]),
        size,
        (int(box[0]), int(box[1]), int(box[2]), int(box[3])),
        refuse.finite(f"{where}: peak", values.get("peak", 0.0)),
    )
    merged = tuple(_numbers(where, "merged", values.get("merged", []), None, whole=True))
    return Sighting(frame, _whole(where, "id", values.get("id", order), 1), lamp, merged)


def _scaled(lamp: Lamp, factor: float) -> Lamp:
    left, top, right, bottom = lamp.box
    return replace(
        lamp,
        place=(lamp.place[0] * factor, lamp.place[1] * factor),
        flux=lamp.flux * factor**2,
        size=lamp.size * factor,
        box=(
            math.floor(left * factor),
            math.floor(top * factor),
            math.ceil(right * factor),
            math.ceil(bottom * factor),
        ),
    )


def _given(where: str, name: str, values: dict[str, Any]) -> Any:
    if name not in values:
        raise refuse.Refusal(f"{where}: '{name}' is missing.")
    return values[name]


def _known(where: str, values: dict[str, Any], known: Collection[str]) -> None:
    for key in values:
        if key not in known:
            raise refuse.unknown_key(where, key, known)


def _whole(where: str, name: str, value: Any, smallest: int = 0) -> int:
    return refuse.at_least(f"{where}: {name}", value, smallest)


def _numbers(where: str, name: str, values: Any, count: int | None, whole: bool = False) -> list[Any]:
    """Refuse what is no list of numbers of that length."""
    if not isinstance(values, list) or (count is not None and len(values) != count):
        wanted = "numbers" if count is None else f"{count} numbers"
        raise refuse.Refusal(f"{where}: '{name}' must be a list of {wanted}, got {values}.")
    if whole:
        # The box of a light at the border of a picture larger than what is shown begins before it.
        return [refuse.at_least(f"{where}: {name}", value, -FARTHEST) for value in values]
    return [refuse.finite(f"{where}: {name}", value) for value in values]
