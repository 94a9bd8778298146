"""Lights followed from frame to frame, each with a number that stays.

A light is looked for where it would stand if it moved on as before, together with all others where the camera
turns. Of all ways to give the frame's lights to the known ones, the one with the least sum of differences is
taken. A light that is hidden keeps its number for some frames; two whose images run together are followed as
two, and part as the two that they were.
"""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from aureole import refuse
from aureole.glare.lamps import Lamp

REACH = 24.0
PATIENCE = 12
# A light that was seen but once may have any speed: so many times the reach.
NEWBORN = 3.0
# What a step of the full reach costs is 1. What a flux four times as strong or weak costs, and any other
# colour at the most; a light may fade behind something, so neither weighs as much as its place.
FLUX_COST, FLUX_RATIO, COLOUR_COST = 0.25, 4.0, 0.5
# Above what any pair within reach can cost.
NOT_PAIRED = 1e3
# A turn of the camera: at least so many lights must agree on it, within so many pixels, of equal flux by a
# factor; it is sought among so many of the strongest.
AGREE, AGREE_WITHIN, AGREE_FLUX, VOTERS = 3, 3.0, 2.0, 32
# Two lights are one region where its flux is that of the first and so much of the other's, too.
BOTH = 0.5


@dataclass(frozen=True)
class Sighting:
    """A light in a frame.

    Parameters
    ----------
    frame : int or None
        The frame's number; None for a light that stands in every frame.
    id : int
        The light's number, from 1, the same in all frames.
    lamp : Lamp
        What the frame shows of it.
    merged : tuple of int
        Numbers of the lights that are in the same region and cannot be told from it in this frame.
    """

    frame: int | None
    id: int
    lamp: Lamp
    merged: tuple[int, ...] = ()


@dataclass(eq=False)
class _Track:
    """What is known of a light: where it stands in the last frame, seen or not, and how it moves."""

    id: int
    place: NDArray[np.float64]
    velocity: NDArray[np.float64]
    flux: float
    colour: NDArray[np.float64]
    seen: int
    sightings: int = 1


class LampTracker:
    """Gives lights their numbers, frame by frame.

    Parameters
    ----------
    reach : float
        Pixels that a light may be from where it is looked for; three times as many for one that was seen
        only once.
    patience : int
        Frames for which a light that is not seen keeps its number.

    Raises
    ------
    refuse.Refusal
        Where a number is out of its range.
    """

    def __init__(self, reach: float = REACH, patience: int = PATIENCE) -> None:
        self.reach = refuse.positive("reach", reach)
        self.patience = refuse.at_least("patience", patience, 0)
        self._tracks: list[_Track] = []
        self._born = 0
        self._frame: int | None = None

    def follow(self, frame: int, lamps: Sequence[Lamp]) -> list[Sighting]:
        """Take the lights of the next frame.

        Parameters
        ----------
        frame : int
            Its number, above the last one's; frames between them may be missing.
        lamps : sequence of Lamp
            As `find_lamps` returns them.

        Returns
        -------
        list of Sighting
            One for each lamp, in their order.

        Raises
        ------
        refuse.Refusal
            Where the frame does not come after the last one.
        """
        if self._frame is not None and frame <= self._frame:
            raise refuse.Refusal(f"'frame' must be above {self._frame}, got {frame}.")
        passed = 1 if self._frame is None else frame - self._frame
        self._frame = frame
        self._tracks = [track for track in self._tracks if frame - track.seen <= self.patience + 1]
        before = [track.place for track in self._tracks]
        self._move_on(passed, lamps)
        owners = self._paired(lamps)
        merged = self._merged(lamps, owners)
        sightings = []
        for k, lamp in enumerate(lamps):
            together = merged.get(k, [])
            if together:
                owners[k] = self._follow_together(frame, lamp, together)
            elif k in owners:
                track = owners[k]
                self._follow_one(frame, passed, lamp, track, before[self._tracks.index(track)])
            sightings.append((k, lamp, together))
        drift = self._common_velocity()
        born = {k: self._birth(frame, lamp, drift) for k, lamp in enumerate(lamps) if k not in owners}
        self._tracks += born.values()
        owners |= born
        return [
            Sighting(
                frame,
                owners[k].id,
                lamp,
                tuple(sorted(track.id for track in together if track is not owners[k])),
            )
            for k, lamp, together in sightings
        ]

    def _move_on(self, passed: int, lamps: Sequence[Lamp]) -> None:
        """Put each track where its light is looked for."""
        for track in self._tracks:
            track.place = track.place + passed * track.velocity
        turn = _common_step(self._tracks, lamps, self.reach)
        for track in self._tracks:
            track.place = track.place + turn

    def _paired(self, lamps: Sequence[Lamp]) -> dict[int, _Track]:
        """Return the track of each lamp that has one."""
        if not self._tracks or not lamps:
            return {}
        cost = self._costs(lamps)
        rows, columns = linear_sum_assignment(cost)
        return {
            int(column): self._tracks[row]
            for row, column in zip(rows, columns, strict=True)
            if cost[row, column] < NOT_PAIRED
        }

    def _costs(self, lamps: Sequence[Lamp]) -> NDArray[np.float64]:
        """Return what each track and lamp differ by, (tracks, lamps)."""
        tracks = self._tracks
        steps = np.array([lamp.place for lamp in lamps])[None] - np.array([t.place for t in tracks])[:, None]
        far = np.hypot(steps[..., 0], steps[..., 1])
        reach = np.array([self.reach * (NEWBORN if track.sightings == 1 else 1.0) for track in tracks])
        logs = np.log([lamp.flux for lamp in lamps])[None] - np.log([track.flux for track in tracks])[:, None]
        ratio = np.minimum(np.abs(logs) / math.log(FLUX_RATIO), 1.0)
        hues = np.array([lamp.colour for lamp in lamps])[None] - np.array([t.colour for t in tracks])[:, None]
        hue = np.minimum(np.abs(hues).max(axis=2), 1.0)
        cost = (far / reach[:, None]) ** 2 + FLUX_COST * ratio + COLOUR_COST * hue
        return np.where(far > reach[:, None], NOT_PAIRED, cost)

    def _merged(self, lamps: Sequence[Lamp], owners: dict[int, _Track]) -> dict[int, list[_Track]]:
        """Return, for each lamp that is several lights, their tracks."""
        found = list(owners.values())
        together: dict[int, list[_Track]] = {}
        for track in self._tracks:
            if any(track is other for other in found):
                continue
            for k, owner in owners.items():
                members = together.get(k, [owner])
                flux = sum(member.flux for member in members)
                if _within(track.place, lamps[k].box) and lamps[k].flux > flux + BOTH * track.flux:
                    together[k] = [*members, track]
                    break
        return together

    def _follow_together(self, frame: int, lamp: Lamp, members: list[_Track]) -> _Track:
        """Move lights of one region as its centre moves, and return the strongest; their fluxes stay."""
        flux = np.array([track.flux for track in members])
        expected = flux @ np.array([track.place for track in members]) / flux.sum()
        for track in members:
            track.place = track.place + (np.asarray(lamp.place) - expected)
            track.seen = frame
        return members[int(np.argmax(flux))]

    def _follow_one(
        self, frame: int, passed: int, lamp: Lamp, track: _Track, before: NDArray[np.float64]
    ) -> None:
        place = np.asarray(lamp.place)
        velocity = (place - before) / passed
        # The first step is all that is known; later ones are smoothed, as centres tremble.
        known = track.sightings > 1
        track.velocity = 0.5 * (track.velocity + velocity) if known else velocity
        track.place, track.flux, track.colour = place, lamp.flux, np.asarray(lamp.colour)
        track.seen, track.sightings = frame, track.sightings + 1

    def _common_velocity(self) -> NDArray[np.float64]:
        """Return how most lights move, which a new one is thought to do, too."""
        moving = [track.velocity for track in self._tracks if track.sightings > 1]
        return np.median(moving, axis=0) if len(moving) >= AGREE else np.zeros(2)

    def _birth(self, frame: int, lamp: Lamp, drift: NDArray[np.float64]) -> _Track:
        self._born += 1
        return _Track(self._born, np.asarray(lamp.place), drift, lamp.flux, np.asarray(lamp.colour), frame)


def track_lamps(
    frames: Iterable[tuple[int, Sequence[Lamp]]],
    reach: float = REACH,
    patience: int = PATIENCE,
    least: int = 1,
) -> list[Sighting]:
    """Follow the lights of a shot.

    Parameters
    ----------
    frames : iterable of (int, sequence of Lamp)
        Each frame's number and lights, by rising number.
    reach : float
        As in `LampTracker`.
    patience : int
        As in `LampTracker`.
    least : int
        Leave out lights that are seen in fewer frames than so many; the others keep their numbers.

    Returns
    -------
    list of Sighting
        By frame, and within one by flux.

    Raises
    ------
    refuse.Refusal
        Where a number is out of its range, or the frames' numbers do not rise.
    """
    tracker = LampTracker(reach, patience)
    return lasting([seen for frame, lamps in frames for seen in tracker.follow(frame, lamps)], least)


def lasting(sightings: Sequence[Sighting], least: int) -> list[Sighting]:
    """Leave out lights that are seen in few frames, such as glints and noise.

    Parameters
    ----------
    sightings : sequence of Sighting
        As `LampTracker.follow` gives them, of all frames.
    least : int
        Frames in which a light must be seen, alone or together with others.

    Returns
    -------
    list of Sighting
        The others, in their order, with their numbers.

    Raises
    ------
    refuse.Refusal
        Where the number is below 1.
    """
    refuse.at_least("least", least, 1)
    counts = Counter(number for sighting in sightings for number in (sighting.id, *sighting.merged))
    return [sighting for sighting in sightings if counts[sighting.id] >= least]


def _within(place: NDArray[np.float64], box: tuple[int, int, int, int]) -> bool:
    left, top, right, bottom = box
    return bool(left <= place[0] <= right and top <= place[1] <= bottom)


def _common_step(tracks: Sequence[_Track], lamps: Sequence[Lamp], reach: float) -> NDArray[np.float64]:
    """Return the step beyond their own motion that most lights agree on, as when the camera turns."""
    none = np.zeros(2)
    strongest = sorted(tracks, key=lambda track: -track.flux)[:VOTERS]
    shown = sorted(lamps, key=lambda lamp: -lamp.flux)[:VOTERS]
    if min(len(strongest), len(shown)) < AGREE:
        return none
    places = np.array([track.place for track in strongest])
    steps = np.array([lamp.place for lamp in shown])[None] - places[:, None]
    ratios = np.array([lamp.flux for lamp in shown])[None] / np.array([t.flux for t in strongest])[:, None]
    alike = np.abs(np.log(ratios)) < math.log(AGREE_FLUX)
    candidates = steps[alike]
    if not len(candidates):
        return none

    still = int((alike & (np.hypot(*np.moveaxis(steps, 2, 0)) <= reach)).any(axis=1).sum())
    voters = np.nonzero(alike)[0]
    near = cKDTree(candidates).query_ball_point(candidates, AGREE_WITHIN)
    counted = [len(set(voters[agreeing])) for agreeing in near]
    best = int(np.argmax(counted))
    if counted[best] < max(AGREE, still + 1, len(strongest) // 2 + 1):
        return none
    agreed = alike & (np.hypot(*np.moveaxis(steps - candidates[best], 2, 0)) <= AGREE_WITHIN)
    return np.asarray(np.median(steps[agreed], axis=0))
