"""A lens of the tile paper with one light or two: all that its tables are made of, measured in one run."""

import dataclasses
import statistics
from collections import defaultdict
from collections.abc import Callable, Collection, Generator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture
from aureole.bench import tile_systems
from aureole.bench.tile_systems import COLOURS, Scene, System
from aureole.bench.timing import alternate, within
from aureole.flare import raster
from aureole.flare.primitives import Primitives
from aureole.flare.pupil import Sheet
from aureole.records import Stage

Pixels = NDArray[np.float32]
MERGES = ("none", "light", "heavy")
PUBLISHED = ("published-light", "published-heavy")
# Pictures are exposed so that this percentile of the reference's values is 1.
EXPOSED = 99.9
# Ghosts that hold less than this part of all ghosts' energy are not asked how exact it is.
LEAST_SHARE = 1e-5
# Sides of dense tiles and of coarse ones, as the paper tries them.
TILINGS = {
    "8": (None, 8),
    "8_128": (128, 8),
    "16": (None, 16),
    "16_128": (128, 16),
    "own": (raster.COARSE, raster.DENSE),
}
PAPERS_TILES = (128, 8)
# The paper's megabytes are of 2^20 bytes: Table 6 has 1.27 for 332,133 numbers of four bytes.
MEBI = 2.0**20


def measured(
    system: System,
    lights: int,
    shape: tuple[int, int],
    base: int,
    grids: str,
    runs: int,
    wanted: Collection[str],
) -> Generator[Stage, None, dict[str, Any]]:
    """Measure a lens with one light or two.

    Parameters
    ----------
    system : System
        The lens.
    lights : int
        1 or 2.
    shape : tuple of int
        Rows and columns of the picture.
    base : int
        Rays along each side of the largest grids.
    grids : {"bounds", "front"}
        What they lie over.
    runs : int
        How often each is timed.
    wanted : collection of str
        Tables: "table-2" to "table-8".

    Yields
    ------
    Stage
        Before each step.

    Returns
    -------
    dict
        Plain numbers, units in their names.
    """
    label = f"{system.label}, {lights} light{'s' if lights > 1 else ''}"
    yield Stage(0.0, f"{label}, rays")
    scene = tile_systems.scene_of(system, lights, shape, base, grids)
    sheets = tile_systems.traced(scene)
    row: dict[str, Any] = {"system": system.label, "lens": system.lens, "lights": lights}
    row |= {"ghosts": len(scene.paths), "million_rays": 1e-6 * tile_systems.rays_of(sheets)}
    made = {merge: tile_systems.primitives(scene, sheets, merge) for merge in (*MERGES, *PUBLISHED)}
    row |= counted(made, scene)
    if {"table-3", "table-7"} & set(wanted):
        yield Stage(0.1, f"{label}, pictures")
        row |= compared(made, scene)
    if "table-3" in wanted:
        yield Stage(0.2, f"{label}, each ghost's energy")
        row |= energies(made, scene)
    timed = yield from within(_timed(scene, sheets, made, runs, wanted, label), 0.3, 1.0)
    return row | timed


def counted(made: dict[str, Primitives], scene: Scene) -> dict[str, Any]:
    """Return how many primitives there are, and how many numbers the paper's dense tiles hold.

    Parameters
    ----------
    made : dict
        Primitives by their merging.
    scene : Scene
        With the picture's frame.

    Returns
    -------
    dict
        prim_*, prim_*_mb, index_*, index_*_mb.
    """
    row: dict[str, Any] = {}
    for merge, primitives in made.items():
        row[f"prim_{merge}"] = len(primitives.area)
        row[f"prim_{merge}_mb"] = _bytes(primitives) / MEBI
        found = raster.tile_indices(primitives, scene.frame, PAPERS_TILES)[1]
        row[f"index_{merge}"], row[f"index_{merge}_mb"] = found, 4 * found / MEBI
    return row


def compared(made: dict[str, Primitives], scene: Scene) -> dict[str, Any]:
    """Return how close tiles come to the reference raster of unmerged primitives.

    Parameters
    ----------
    made : dict
        Primitives by their merging.
    scene : Scene
        With the picture's frame.

    Returns
    -------
    dict
        psnr_* of pictures clipped to 0..1, open_psnr_* of unclipped ones, decibels.
    """
    reference = drawn(made["none"], scene, "reference")
    row: dict[str, Any] = {}
    for merge, primitives in made.items():
        clipped, unclipped = exposed_psnr(drawn(primitives, scene), reference)
        row[f"psnr_{merge}"], row[f"open_psnr_{merge}"] = clipped, unclipped
    return row


def exposed_psnr(found: Pixels, reference: Pixels) -> tuple[float, float]:
    """Return the signal-to-noise ratio of a picture exposed as its reference should be.

    Parameters
    ----------
    found, reference : ndarray, shape (rows, columns, channels)
        Linear pictures.

    Returns
    -------
    clipped, unclipped : float
        Decibels to a peak of 1, over all channels: of values clipped to 0..1, and of all values.
    """
    exposure = float(np.percentile(reference, EXPOSED)) or float(reference.max()) or 1.0
    pair = found / np.float32(exposure), reference / np.float32(exposure)
    cut = [np.clip(each, 0.0, 1.0) for each in pair]
    return _decibels(*cut), _decibels(*pair)


def energies(made: dict[str, Primitives], scene: Scene) -> dict[str, Any]:
    """Return by how much each ghost's energy in the picture differs from the reference's at most.

    Parameters
    ----------
    made : dict
        Primitives by their merging.
    scene : Scene
        With the picture's frame.

    Returns
    -------
    dict
        energy_* for each merging: the largest relative difference; "judged": of how many ghosts.
    """
    truth = _of_each(made["none"], scene, "reference")
    judged = truth > LEAST_SHARE * truth.sum()
    row: dict[str, Any] = {"judged": int(judged.sum())}
    for merge in MERGES:
        found = _of_each(made[merge], scene, "tiles")
        row[f"energy_{merge}"] = float(np.abs(found[judged] / truth[judged] - 1).max(initial=0.0))
    return row


def drawn(primitives: Primitives, scene: Scene, method: str = "tiles") -> Pixels:
    """Return a scene's picture.

    Parameters
    ----------
    primitives : Primitives
        What is drawn.
    scene : Scene
        With the frame and the iris.
    method : str
        As in `aureole.flare.raster.rasterize`.

    Returns
    -------
    ndarray of float32, shape (rows, columns, 3)
        A channel a wavelength.
    """
    return raster.rasterize(primitives, COLOURS, scene.frame, method, iris=scene.iris)


def _timed(
    scene: Scene,
    sheets: list[Sheet],
    made: dict[str, Primitives],
    runs: int,
    wanted: Collection[str],
    label: str,
) -> Generator[Stage, None, dict[str, Any]]:
    """Time the phases in turn."""
    efforts: dict[str, list[raster.Effort]] = defaultdict(list)
    tasks: dict[str, Callable[[], object]] = {}

    def lay(
        name: str, merge: str, method: str = "tiles", of: dict[str, Primitives] = made, **options: Any
    ) -> None:
        def task() -> None:
            _, effort = raster.rasterize_timed(
                of[merge], COLOURS, scene.frame, method, iris=scene.iris, **options
            )
            efforts[name].append(effort)

        tasks[name] = task

    if {"table-2", "table-7"} & set(wanted):
        tasks["rays"] = lambda: tile_systems.traced(scene)
        for merge in MERGES:
            tasks[f"build_{merge}"] = lambda merge=merge: tile_systems.primitives(scene, sheets, merge)  # type: ignore[misc]
            lay(f"tiles_{merge}", merge)
        lay("reference", "none", "reference")
    if "table-2" in wanted and len(scene.directions) > 1:
        # The first light alone, in the same run.
        one = dataclasses.replace(scene, directions=scene.directions[:1])
        own = tile_systems.traced(one)
        tasks["one_rays"] = lambda: tile_systems.traced(one)
        tasks["one_build"] = lambda: tile_systems.primitives(one, own, "light")
        lay("one_tiles", "light", of={"light": tile_systems.primitives(one, own, "light")})
    if "table-4" in wanted:
        for name, tiles in TILINGS.items():
            lay(f"tiling_{name}", "light", tiles=tiles)
    if "table-8" in wanted:
        for coordinates in raster.COORDINATES:
            lay(f"coordinates_{coordinates}", "light", coordinates=coordinates)
    times = yield from alternate(tasks, runs, label=f"{label},")
    row: dict[str, Any] = {f"{name}_ms": spent for name, spent in times.items()}
    for name, kept in efforts.items():
        for phase in ("prepare", "coarse", "dense", "traversal"):
            spent = [getattr(effort, phase) for effort in kept[1:] or kept]
            row[f"{name}_{phase}_ms"] = 1e3 * statistics.median(spent)
    return row | _sums(row)


def _sums(row: dict[str, Any]) -> dict[str, Any]:
    """Return whole times and gains from the phases."""
    if "rays_ms" not in row:
        return {}
    found = {f"whole_{m}_ms": row["rays_ms"] + row[f"build_{m}_ms"] + row[f"tiles_{m}_ms"] for m in MERGES}
    found["previous_ms"] = row["rays_ms"] + row["build_none_ms"] + row["reference_ms"]
    found["raster_gain"] = row["reference_ms"] / row["tiles_light_ms"]
    found["raster_gain_heavy"] = row["reference_ms"] / row["tiles_heavy_ms"]
    found["gain"] = found["previous_ms"] / found["whole_light_ms"]
    if "one_rays_ms" in row:
        alone = row["one_rays_ms"] + row["one_build_ms"] + row["one_tiles_ms"]
        found["second_light"] = found["whole_light_ms"] / alone
        found["second_light_raster"] = row["tiles_light_ms"] / row["one_tiles_ms"]
    return found


def _bytes(primitives: Primitives) -> int:
    arrays = (each for each in vars(primitives).values() if len(each) == len(primitives.area))
    return sum(each.nbytes for each in arrays)


def _of_each(primitives: Primitives, scene: Scene, method: str) -> NDArray[np.float64]:
    """Return the sum of each ghost's picture."""
    pictures = (
        drawn(tile_systems.of_ghost(primitives, ghost), scene, method) for ghost in range(len(scene.paths))
    )
    return np.array([float(pixels.sum(dtype=np.float64)) for pixels in pictures])


def _decibels(found: Pixels, reference: Pixels) -> float:
    flat = found.reshape(-1, 1, 1), reference.reshape(-1, 1, 1)
    return float(picture.psnr(*flat, peak=1.0)[0])
