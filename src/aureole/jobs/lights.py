"""The lights of pictures: found in one, or followed through the frames of a shot."""

import dataclasses
import statistics
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from aureole import glare, picture, refuse
from aureole.glare import Lamp, LampList, LampTracker, Sighting
from aureole.records import Picture, Stage

# A threshold for a whole shot is the middle of those of so many frames, evenly through it.
PROBES = 8
# Part of the picture's width that a light may be from where it is looked for.
REACH = 0.025
LISTED = 10


@dataclass(frozen=True)
class LightsJob:
    """Lights to find.

    Parameters
    ----------
    pictures : tuple of (int or None, Path)
        Each frame's number and file; one without a number is a single picture.
    threshold : float, optional
        Luminance above which a pixel belongs to a light; found from the pictures without it.
    most : int
        Of each picture, the lights with most light.
    connect : int
        Regions fewer than so many pixels apart are one light.
    follow : bool
        Whether lights keep their number from frame to frame.
    reach : float, optional
        Pixels that a light may be from where it is looked for; a fortieth of the width without it.
    patience : int
        Frames for which a light that is not seen keeps its number.
    least : int
        Leave out lights that are seen in fewer frames.
    memory : int, optional
        Bytes that a picture may take.
    nan : str
        "refuse" or "zero".
    """

    pictures: tuple[tuple[int | None, Path], ...]
    threshold: float | None = None
    most: int = glare.MOST_LAMPS
    connect: int = 1
    follow: bool = False
    reach: float | None = None
    patience: int = glare.PATIENCE
    least: int = 1
    memory: int | None = None
    nan: Literal["refuse", "zero"] = "refuse"


@dataclass(frozen=True, eq=False)
class LightsResult:
    """Lights that were found.

    Parameters
    ----------
    lamps : LampList
        Their places count from the upper left corner of what the pictures are meant to show.
    report : dict
        Plain numbers.
    """

    lamps: LampList
    report: dict[str, Any]


def run_lights(job: LightsJob) -> Iterator[Stage]:
    """Find lights, and follow them.

    Parameters
    ----------
    job : LightsJob
        Where.

    Yields
    ------
    Stage
        The last one holds a `LightsResult`.
    """
    _check(job)
    yield Stage(0.0, "the threshold")
    first = _read(job, job.pictures[0][1])
    shape = shown_shape(first)
    threshold = _threshold(job, first) if job.threshold is None else job.threshold
    reach = max(REACH * shape[1], 2.0) if job.reach is None else job.reach
    tracker = LampTracker(reach, job.patience)
    sightings: list[Sighting] = []
    for index, (number, path) in enumerate(job.pictures):
        label = path.name if number is None else f"frame {number}"
        yield Stage(0.05 + 0.95 * index / len(job.pictures), label)
        source = first if index == 0 else _read(job, path)
        if shown_shape(source) != shape or source.colour_space != first.colour_space:
            raise refuse.Refusal(f"'{path}' must have the size and colour space of '{job.pictures[0][1]}'.")
        lamps = shown_lamps(source, glare.find_lamps(source, threshold, job.most, job.connect))
        if job.follow and number is not None:
            sightings += tracker.follow(number, lamps)
        else:
            sightings += [Sighting(number, k, lamp) for k, lamp in enumerate(lamps, 1)]
    if job.follow:
        sightings = glare.lasting(sightings, job.least)
    frames = tuple(number for number, _ in job.pictures if number is not None)
    found = LampList(tuple(sightings), shape, first.colour_space, threshold, frames)
    yield Stage(1.0, "lights", LightsResult(found, _report(job, found)))


def shown_lamps(source: Picture, lamps: list[Lamp]) -> list[Lamp]:
    """Return lights by their places on what a picture is meant to show.

    Parameters
    ----------
    source : Picture
        As it was read; it may have pixels beyond what it shows.
    lamps : list of Lamp
        By their places on its pixels.

    Returns
    -------
    list of Lamp
        The same lights.
    """
    left, top = _corner(source)
    if (left, top) == (0, 0):
        return lamps
    return [
        dataclasses.replace(
            lamp,
            place=(lamp.place[0] + left, lamp.place[1] + top),
            box=(lamp.box[0] + left, lamp.box[1] + top, lamp.box[2] + left, lamp.box[3] + top),
        )
        for lamp in lamps
    ]


def shown_shape(source: Picture) -> tuple[int, int]:
    """Return the (rows, columns) that a picture is meant to show.

    Parameters
    ----------
    source : Picture
        As it was read.

    Returns
    -------
    tuple of int
        Of its display window; all its pixels where it has none.
    """
    header = picture.header_of(source)
    rows, columns = source.pixels.shape[:2]
    return (rows, columns) if header is None else (header.display_window.height, header.display_window.width)


def _corner(source: Picture) -> tuple[int, int]:
    """Return the column and row, of what is shown, of a picture's first pixel."""
    header = picture.header_of(source)
    if header is None:
        return 0, 0
    data, shown = header.data_window, header.display_window
    return data.x - shown.x, data.y - shown.y


def _check(job: LightsJob) -> None:
    if not job.pictures:
        raise refuse.Refusal("'frames' must name at least one frame, got none.")
    if job.threshold is not None:
        refuse.positive("threshold", job.threshold)
    if job.reach is not None:
        refuse.positive("reach", job.reach)
    for name, value, smallest in (
        ("most", job.most, 1),
        ("connect", job.connect, 1),
        ("patience", job.patience, 0),
        ("least", job.least, 1),
    ):
        refuse.at_least(name, value, smallest)


def _read(job: LightsJob, path: Path) -> Picture:
    return picture.read(path, nan=job.nan, memory=job.memory)


def _threshold(job: LightsJob, first: Picture) -> float:
    """Return one threshold for all frames, so that no light comes and goes with it."""
    count = min(len(job.pictures), PROBES)
    chosen = {round(k * (len(job.pictures) - 1) / max(count - 1, 1)) for k in range(count)}
    levels = [
        glare.lamp_threshold(first if index == 0 else _read(job, job.pictures[index][1]))
        for index in sorted(chosen)
    ]
    # Black frames say nothing about the others.
    return statistics.median([level for level in levels if level > 0] or [1.0])


def _report(job: LightsJob, found: LampList) -> dict[str, Any]:
    assert found.shape is not None
    told: dict[str, Any] = {
        "size": [found.shape[1], found.shape[0]],
        "colour_space": found.colour_space,
        "threshold": found.threshold,
    }
    if job.follow:
        tracks: dict[int, list[Sighting]] = {}
        for sighting in found.sightings:
            tracks.setdefault(sighting.id, []).append(sighting)
        told |= {"frames": len(found.frames), "lights": len(tracks), "sightings": len(found.sightings)}
        told["tracks"] = [_track_report(number, seen) for number, seen in sorted(tracks.items())]
        return told
    told["lights"] = len(found.sightings)
    told["flux"] = float(sum(sighting.lamp.flux for sighting in found.sightings))
    told["brightest"] = [_lamp_report(sighting) for sighting in found.sightings[:LISTED]]
    return told


def _lamp_report(sighting: Sighting) -> dict[str, Any]:
    lamp = sighting.lamp
    return {
        "id": sighting.id,
        "place_pixels": list(lamp.place),
        "flux": lamp.flux,
        "colour": list(lamp.colour),
        "size_pixels": lamp.size,
    }


def _track_report(number: int, seen: list[Sighting]) -> dict[str, Any]:
    return {
        "id": number,
        "first_frame": seen[0].frame,
        "last_frame": seen[-1].frame,
        "frames": len(seen),
        "merged_frames": sum(bool(sighting.merged) for sighting in seen),
        "largest_flux": max(sighting.lamp.flux for sighting in seen),
        "from_pixels": list(seen[0].lamp.place),
        "to_pixels": list(seen[-1].lamp.place),
    }
