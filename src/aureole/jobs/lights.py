"""The lights of pictures: found in one, or followed through the frames of a shot."""

import dataclasses
import statistics
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aureole import glare, picture, refuse
from aureole.glare import Lamp, LampList, LampTracker, Sighting
from aureole.jobs.glare import in_working_space
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
    reading : mapping
        Options of `aureole.picture.read`.
    """

    pictures: tuple[tuple[int | None, Path], ...]
    threshold: float | None = None
    most: int = glare.MOST_LAMPS
    connect: int = 1
    follow: bool = False
    reach: float | None = None
    patience: int = glare.PATIENCE
    least: int = 1
    reading: Mapping[str, Any] = dataclasses.field(default_factory=dict)


@dataclass(frozen=True)
class LostFrame:
    """A frame of a shot that could not be looked at.

    Parameters
    ----------
    number : int
        The frame's.
    path : Path
        Its file.
    state : str
        "missing" or "broken".
    reason : str
        One line.
    """

    number: int
    path: Path
    state: str
    reason: str


@dataclass(frozen=True, eq=False)
class LightsResult:
    """Lights that were found.

    Parameters
    ----------
    lamps : LampList
        Their places count from the upper left corner of what the pictures are meant to show.
    report : dict
        Plain numbers.
    failures : tuple of LostFrame
        Frames that could not be looked at.
    """

    lamps: LampList
    report: dict[str, Any]
    failures: tuple[LostFrame, ...] = ()


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
    threshold = job.threshold
    if threshold is None:
        threshold = shot_threshold([path for _, path in job.pictures], job.reading)
    shot = _Shot(job, threshold)
    for index, (number, path) in enumerate(job.pictures):
        label = path.name if number is None else f"frame {number}"
        yield Stage(0.05 + 0.95 * index / len(job.pictures), label)
        try:
            shot.take(number, picture.read(path, **job.reading))
        except refuse.Refusal as refusal:
            if number is None:
                raise
            state = "broken" if path.exists() else "missing"
            shot.failures.append(LostFrame(number, path, state, str(refusal)))
    yield Stage(1.0, "lights", shot.result())


class _Shot:
    """The lights of a shot, as far as it has been looked at."""

    def __init__(self, job: LightsJob, threshold: float) -> None:
        self.job, self.threshold = job, threshold
        self.failures: list[LostFrame] = []
        self._shape: tuple[int, int] | None = None
        self._space = ""
        self._frames: list[int] = []
        self._sightings: list[Sighting] = []
        self._tracker: LampTracker | None = None

    def take(self, number: int | None, source: Picture) -> None:
        """Find a frame's lights, and follow them."""
        job, (known, space), shape = self.job, in_working_space(source), shown_shape(source)
        if self._shape is None:
            self._shape, self._space = shape, space
            reach = max(REACH * shape[1], 2.0) if job.reach is None else job.reach
            self._tracker = LampTracker(reach, job.patience)
        if shape != self._shape or space != self._space:
            raise refuse.Refusal(
                "a frame must have the size and colour space of the first, "
                f"{_said(self._shape, self._space)}, got {_said(shape, space)}."
            )
        lamps = shown_lamps(source, glare.find_lamps(known, self.threshold, job.most, job.connect))
        if number is not None:
            self._frames.append(number)
        if job.follow and number is not None:
            assert self._tracker is not None
            self._sightings += self._tracker.follow(number, lamps)
        else:
            self._sightings += [Sighting(number, k, lamp) for k, lamp in enumerate(lamps, 1)]

    def result(self) -> LightsResult:
        """Return what was found."""
        if self._shape is None:
            raise refuse.Refusal(f"none of the frames can be read; {self.failures[0].reason}")
        seen = self._sightings
        kept = glare.lasting(seen, self.job.least) if self.job.follow else seen
        found = LampList(
            tuple(kept), self._shape, self._space, self.threshold, tuple(self._frames), self.job.connect
        )
        return LightsResult(found, _report(self.job, found), tuple(self.failures))


def _said(shape: tuple[int, int], space: str) -> str:
    return f"{shape[1]} x {shape[0]} in {space}"


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
    return _shifted(lamps, *shown_corner(source))


def placed_lamps(source: Picture, lamps: list[Lamp]) -> list[Lamp]:
    """Return lights by their places on a picture's pixels: the inverse of `shown_lamps`.

    Parameters
    ----------
    source : Picture
        As it was read.
    lamps : list of Lamp
        By their places on what it is meant to show.

    Returns
    -------
    list of Lamp
        The same lights.
    """
    left, top = shown_corner(source)
    return _shifted(lamps, -left, -top)


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


def shown_corner(source: Picture) -> tuple[int, int]:
    """Return where, on what a picture is meant to show, its first pixel lies.

    Parameters
    ----------
    source : Picture
        As it was read.

    Returns
    -------
    tuple of int
        Column and row; below 0 where it has pixels beyond.
    """
    header = picture.header_of(source)
    if header is None:
        return 0, 0
    data, shown = header.data_window, header.display_window
    return data.x - shown.x, data.y - shown.y


def shot_threshold(pictures: Sequence[Path], reading: Mapping[str, Any] | None = None) -> float:
    """Return one threshold for all frames of a shot, so that no light comes and goes with it.

    Parameters
    ----------
    pictures : sequence of Path
        The frames' files; those that cannot be read say nothing.
    reading : mapping, optional
        Options of `aureole.picture.read`.

    Returns
    -------
    float
        The middle of those of up to eight frames, evenly through the shot.
    """
    count = min(len(pictures), PROBES)
    chosen = {round(k * (len(pictures) - 1) / max(count - 1, 1)) for k in range(count)}
    levels = []
    for index in sorted(chosen):
        try:
            source = picture.read(pictures[index], **(reading or {}))
        except refuse.Refusal:
            continue
        levels.append(glare.lamp_threshold(in_working_space(source)[0]))
    # Black frames say nothing about the others.
    return statistics.median([level for level in levels if level > 0] or [1.0])


def _shifted(lamps: list[Lamp], x: int, y: int) -> list[Lamp]:
    if (x, y) == (0, 0):
        return lamps
    return [
        dataclasses.replace(
            lamp,
            place=(lamp.place[0] + x, lamp.place[1] + y),
            box=_box(lamp, x, y),
        )
        for lamp in lamps
    ]


def _box(lamp: Lamp, x: int, y: int) -> tuple[int, int, int, int]:
    """Move a light's box; one that has none keeps none."""
    left, top, right, bottom = lamp.box
    return (left + x, top + y, right + x, bottom + y) if right > left else lamp.box


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
