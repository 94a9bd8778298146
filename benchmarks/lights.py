"""How fast lights are found and followed, and how well: `python benchmarks/lights.py [--peers]`.

A synthetic shot of 1920 x 1080 pixels with two hundred lamps of known places, fluxes and numbers, before a
wall with a soft gradient; the camera pans. With --peers the same frame is given to SExtractor's library (sep)
and to photutils, where they are installed: detection, centroids and fluxes with the same threshold.
"""

import argparse
import statistics
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from aureole import Picture, glare
from aureole.bench import timing

SHAPE = (1080, 1920)
SEED, LAMPS, FRAMES = 7, 200, 200
THRESHOLD = 1.0
# Standard deviation of a lamp's image, pixels; of the pan, pixels a frame.
BLUR, PAN = 1.5, 3.0

# Places and fluxes.
Found = tuple[NDArray[np.float64], NDArray[np.float64]]


class Shot:
    """Frames with lamps whose place and flux are known."""

    def __init__(self) -> None:
        generator = np.random.default_rng(SEED)
        rows, columns = np.linspace(0, 1, SHAPE[0])[:, None], np.linspace(0, 1, SHAPE[1])[None]
        self.wall = (0.02 + 0.03 * rows + 0.02 * columns).astype(np.float32)
        width = SHAPE[1] + PAN * FRAMES
        places = []
        while len(places) < LAMPS:
            place = generator.uniform((20, 20), (width - 20, SHAPE[0] - 20))
            if all(np.hypot(*(place - other)) > 30 for other in places):
                places.append(place)
        self.places = np.array(places)
        self.fluxes = np.exp(generator.uniform(np.log(100), np.log(1e5), LAMPS))

    def at(self, frame: int) -> tuple[Picture, NDArray[np.float64], NDArray[np.intp]]:
        """Return a frame, and the places and numbers of the lamps that lie wholly in it."""
        places = self.places - [PAN * frame, 0.0]
        seen = self.wall.copy()
        inside = (places[:, 0] > -10) & (places[:, 0] < SHAPE[1] + 10)
        for (x, y), flux in zip(places[inside], self.fluxes[inside], strict=True):
            add_lamp(seen, x, y, flux)
        whole = (places[:, 0] > 20) & (places[:, 0] < SHAPE[1] - 20)
        return Picture(np.repeat(seen[..., None], 3, axis=2)), places[whole], np.flatnonzero(whole)


def add_lamp(seen: NDArray[np.float32], x: float, y: float, flux: float) -> None:
    """Add a Gaussian that is integrated over each pixel."""
    reach = 10
    left, top = int(x) - reach, int(y) - reach
    spans = []
    for at, first, count in ((y, top, SHAPE[0]), (x, left, SHAPE[1])):
        edges = np.arange(first, first + 2 * reach + 2)
        parts = np.diff(special.erf((edges - at) / (BLUR * np.sqrt(2)))) / 2
        keep = (edges[:-1] >= 0) & (edges[:-1] < count)
        spans.append((edges[:-1][keep], parts[keep]))
    (rows, down), (columns, across) = spans
    if len(rows) and len(columns):
        seen[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] += (flux * np.outer(down, across)).astype(
            np.float32
        )


def median_seconds(call: Callable[[], Any], times: int = 7) -> float:
    """Return the median processor time of so many runs, after one that does not count."""
    call()
    taken = []
    for _ in range(times):
        start = time.process_time()
        call()
        taken.append(time.process_time() - start)
    return statistics.median(taken)


def errors(
    found: NDArray[np.float64], fluxes: NDArray[np.float64], places: NDArray[np.float64], wanted: NDArray[Any]
) -> str:
    """Return how far found lights are from those that were drawn, and how many are missing."""
    far = np.hypot(*np.moveaxis(found[None] - places[:, None], 2, 0))
    nearest = far.argmin(axis=1)
    hit = far.min(axis=1) < 2
    off = far.min(axis=1)[hit]
    ratio = fluxes[nearest][hit] / wanted[hit] - 1
    return (
        f"{hit.sum()} of {len(places)}; place off by {np.median(off):.4f} px (95 %: "
        f"{np.quantile(off, 0.95):.4f}); flux off by {100 * np.median(np.abs(ratio)):.2f} % (95 %: "
        f"{100 * np.quantile(np.abs(ratio), 0.95):.2f} %)"
    )


def find_and_track(shot: Shot) -> None:
    """Measure finding in one frame, and following over all."""
    source, places, numbers = shot.at(0)
    lamps = glare.find_lamps(source, THRESHOLD)
    found, fluxes = np.array([lamp.place for lamp in lamps]), np.array([lamp.flux for lamp in lamps])
    for name, call in (
        ("find, threshold given", lambda: glare.find_lamps(source, THRESHOLD)),
        ("find, threshold auto", lambda: glare.find_lamps(source)),
        ("matte of all that is bright", lambda: glare.lamp_matte(source, THRESHOLD)),
        (f"matte of {len(lamps)} lamps", lambda: glare.lamp_matte(source, THRESHOLD, lamps)),
    ):
        print(f"{name:28s} {1e3 * median_seconds(call):6.0f} ms")
    print("found:", errors(found, fluxes, places, shot.fluxes[numbers]))
    spent, wrong, total = followed(shot)
    print(f"{'follow, a frame':28s} {1e3 * spent / FRAMES:6.1f} ms")
    print(f"followed: of {FRAMES} frames {wrong} of {total} numbers changed")


def followed(shot: Shot) -> tuple[float, int, int]:
    """Follow all frames; return the seconds, how many numbers are not a lamp's first, and of how many."""
    tracker, spent, wrong, total = glare.LampTracker(reach=48.0), 0.0, 0, 0
    owner: dict[int, int] = {}
    for frame in range(FRAMES):
        source, places, numbers = shot.at(frame)
        lamps = glare.find_lamps(source, THRESHOLD)
        start = time.process_time()
        sightings = tracker.follow(frame, lamps)
        spent += time.process_time() - start
        found = np.array([seen.lamp.place for seen in sightings])
        for place, number in zip(places, numbers, strict=True):
            seen = sightings[int(np.hypot(*(found - place).T).argmin())]
            total += 1
            wrong += owner.setdefault(int(number), seen.id) != seen.id
    return spent, wrong, total


def peers(shot: Shot) -> None:
    """Give the same frame to others' finders, one after the other in turn; processor time is counted."""
    source, places, numbers = shot.at(0)
    seen = np.ascontiguousarray(glare.luminances(source))

    def ours() -> Found:
        lamps = glare.find_lamps(source, THRESHOLD)
        return np.array([lamp.place for lamp in lamps]), np.array([lamp.flux for lamp in lamps])

    calls = {"aureole": ours} | dict(finders(seen))
    taken: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(8):
        for name, call in calls.items():
            start = time.process_time()
            call()
            taken[name].append(time.process_time() - start)
    for name, call in calls.items():
        seconds = statistics.median(taken[name][1:])
        print(f"{name:28s} {1e3 * seconds:6.0f} ms  {errors(*call(), places, shot.fluxes[numbers])}")


def finders(seen: NDArray[np.float64]) -> Iterator[tuple[str, Callable[[], Found]]]:
    """Yield others' finders that are installed: centroids of the detected pixels and their sums."""
    try:
        import sep
    except ImportError:
        print("sep is not installed: pip install sep")
    else:

        def by_sep() -> Found:
            found = sep.extract(seen - sep.Background(seen).back(), THRESHOLD)
            return np.column_stack([found["x"], found["y"]]) + 0.5, found["flux"]

        yield f"sep {sep.__version__}", by_sep
    try:
        import photutils
        from photutils.segmentation import SourceCatalog, detect_sources
    except ImportError:
        print("photutils is not installed: pip install photutils")
    else:

        def by_photutils() -> Found:
            table = SourceCatalog(seen - np.median(seen), detect_sources(seen, THRESHOLD, n_pixels=1))
            places = np.column_stack([table.x_centroid, table.y_centroid]) + 0.5
            return places, np.asarray(table.segment_flux)

        yield f"photutils {photutils.__version__}", by_photutils


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--peers", action="store_true", help="measure sep and photutils, too")
    given = parser.parse_args()
    machine = timing.environment()
    print(f"{machine['platform']}, {machine['processors']} processors, {machine['versions']}")
    print(f"{SHAPE[1]} x {SHAPE[0]}, {LAMPS} lamps, seed {SEED}\n")
    shot = Shot()
    find_and_track(shot)
    if given.peers:
        peers(shot)


if __name__ == "__main__":
    main()
