"""The tile paper's five lenses, two lights, and their grids of rays (Eq. 13).

The paper does not say over what its grids lie, nor where its lights stand, so counts of primitives agree in
order only. "bounds" are grids over the part of the pupil that each ghost uses, the iris closed. "front" are
grids over the whole front of the lens with the iris open; the closed one is a mask that the raster looks up,
since with the iris as far closed as the paper says such a grid has a few rays a ghost.
"""

import dataclasses
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aureole import aperture, flare
from aureole.flare import paraxial, pupil, tracing
from aureole.flare.ghost_paths import GhostPath
from aureole.flare.primitives import Frame, Merge, Primitives, construct, frame_of
from aureole.flare.pupil import Sheet

# The authors' code traces three wavelengths from 475 to 650 nm, one for each channel of the picture.
WAVELENGTHS = (650e-9, 562.5e-9, 475e-9)
COLOURS = np.eye(3, dtype=np.float32)
# The paper does not say where its lights stand; these are ours, in parts of the picture's width and height.
PLACES = ((0.3, 0.3), (0.62, 0.72))
# Eq. 13: the base is reduced to this part at most; σ is 1 and φ 1/2.
LEAST_PART, POWER = 0.05, 0.5
# Rays along each side of the grids that say how large ghosts are.
PROBE = 16
LEAST_SIDE = 5
GRIDS = ("bounds", "front")
# Pixels of the mask that stands for a closed iris where rays are traced with an open one.
MASK = 1024


@dataclass(frozen=True)
class System:
    """A lens as the paper used it.

    Parameters
    ----------
    label : str
        As in the paper's tables.
    lens : str
        Name of the shipped lens.
    f_number : float
        Of its iris.
    """

    label: str
    lens: str
    f_number: float


SYSTEMS = (
    System("Heliar Tronnier", "heliar_tronnier_100mm", 16.0),
    System("Itoh", "itoh_wide_zoom_123mm_seed", 32.0),
    System("Nikon", "nikon_tele_zoom_140mm_seed", 16.0),
    System("Canon 135 mm", "canon_tele_zoom_135mm", 32.0),
    System("Canon 200 mm", "canon_tele_zoom_200mm", 32.0),
)


@dataclass(frozen=True, eq=False)
class Scene:
    """A lens, its ghosts and the lights, ready to be traced.

    Parameters
    ----------
    prepared : Prepared
        The lens.
    paths : tuple of GhostPath
        The ghosts that the paper counts.
    frame : Frame
        The picture.
    directions : tuple of tuple of float
        Unit vectors towards the lights.
    base : int
        Rays along each side of the largest grids.
    grids : str
        "bounds" or "front".
    iris : ndarray of float32, shape (n, n), optional
        The closed iris as a mask, where rays are traced with an open one.
    """

    prepared: tracing.Prepared
    paths: tuple[GhostPath, ...]
    frame: Frame
    directions: tuple[tuple[float, float, float], ...]
    base: int
    grids: str = "bounds"
    iris: NDArray[np.float32] | None = None


def scene_of(system: System, lights: int, shape: tuple[int, int], base: int, grids: str = "bounds") -> Scene:
    """Return one of the paper's test cases.

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

    Returns
    -------
    Scene
        Ready to be traced.
    """
    lens = flare.load(system.lens)
    front = grids == "front"
    prepared = tracing.prepare(lens, WAVELENGTHS, None if front else system.f_number)
    closed = paraxial.stop_radius(lens, system.f_number) / lens.surfaces[lens.stop].semi_aperture
    sources = [flare.light_on_picture(lens, (x * shape[1], y * shape[0]), shape) for x, y in PLACES[:lights]]
    return Scene(
        prepared,
        tuple(flare.ghosts(lens, "paper")),
        frame_of(lens, shape),
        tuple(source.direction for source in sources),
        base,
        grids,
        _mask(closed) if front else None,
    )


def traced(scene: Scene) -> list[Sheet]:
    """Trace every ghost of every light on grids as large as Eq. 13 says.

    Parameters
    ----------
    scene : Scene
        What to trace.

    Returns
    -------
    list of Sheet
        Light by light, ghost by ghost; those that no ray makes are left out.
    """
    found: list[Sheet] = []
    for direction in scene.directions:
        if scene.grids == "front":
            found += pupil.sheets(scene.prepared, scene.paths, direction, scene.base, "paper")
            continue
        sides = grid_sides(scene, direction)
        made: dict[GhostPath, Sheet] = {}
        for side in sorted(set(sides.values())):
            paths = [path for path, wanted in sides.items() if wanted == side]
            for sheet in pupil.sheets(scene.prepared, paths, direction, side):
                made[_path(sheet)] = sheet
        found += [made[path] for path in scene.paths if path in made]
    return found


def grid_sides(scene: Scene, direction: tuple[float, float, float]) -> dict[GhostPath, int]:
    """Return the rays along each side of every ghost's grid.

    Parameters
    ----------
    scene : Scene
        What to trace.
    direction : tuple of float
        Unit vector towards the light.

    Returns
    -------
    dict
        The base times min(max((G_x G_y / (S_x S_y))^(1/2), 0.05), 1), where G and S are the sides of the
        rectangles that hold the ghost and the sensor (Eq. 13).
    """
    width, height = scene.prepared.lens.sensor
    sides = {}
    for sheet in pupil.sheets(scene.prepared, scene.paths, direction, PROBE):
        x, y = sheet.x[sheet.passed], sheet.y[sheet.passed]
        area = float(np.ptp(x) * np.ptp(y)) if x.size else 0.0
        part = min(max((area / (width * height)) ** POWER, LEAST_PART), 1.0)
        sides[_path(sheet)] = max(round(scene.base * part), LEAST_SIDE)
    return sides


def primitives(scene: Scene, sheets: Sequence[Sheet], merge: str | Merge = "none") -> Primitives:
    """Return the primitives of a scene as the paper keeps them: quads with a valid ray.

    Parameters
    ----------
    scene : Scene
        Frame and ghosts.
    sheets : sequence of Sheet
        From `traced`.
    merge : str or Merge
        As in `aureole.flare.construct`.

    Returns
    -------
    Primitives
        Each with the number of its ghost among the scene's.
    """
    number = {path: k for k, path in enumerate(scene.paths)}
    ghosts = [number[_path(sheet)] for sheet in sheets]
    return construct(sheets, scene.frame, merge=merge, keep="valid", ghosts=ghosts)


def of_ghost(given: Primitives, ghost: int) -> Primitives:
    """Return one ghost's primitives.

    Parameters
    ----------
    given : Primitives
        Those of many ghosts.
    ghost : int
        Number of the ghost.

    Returns
    -------
    Primitives
        In the order in which they came.
    """
    own = np.flatnonzero(given.ghost == ghost)
    return Primitives(
        given.corners[own],
        given.attributes[own],
        given.area[own],
        given.colour[own],
        given.ghost[own],
        given.size[own],
        given.outside,
    )


def rays_of(sheets: Iterable[Sheet]) -> int:
    """Return how many rays sheets hold.

    Parameters
    ----------
    sheets : iterable of Sheet
        At all their wavelengths.

    Returns
    -------
    int
        Traced rays.
    """
    return sum(sheet.x.size for sheet in sheets)


def _path(sheet: Sheet) -> GhostPath:
    assert isinstance(sheet.path, GhostPath)
    return sheet.path


def _mask(radius: float) -> NDArray[np.float32]:
    """Return a round iris in parts of the open one's radius."""
    closed = dataclasses.replace(aperture.circle(2.0 * radius), width=2.0)
    return aperture.rasterize(closed, MASK)
