"""Flipbooks: the eye's glare at the places of its range of motion, ready to be mixed and convolved.

Each component (bloom, halo, corona, streaks) has frames at nodes along a few axes, which are fields of
`EyeState`: the pupil's diameter, the lids' opening, the vitreous's angle. A state is mixed from the nodes
around it, weighted by straight lines, and the components are added with the shares of the light that they
scatter. All of it happens to spectra, before one product and one inverse transform
(thesis §3.4). Intensities are added, where one wave through all parts would add amplitudes; `flipbook_error`
says by how much that differs.

The middle pixel of each frame is left out: what it holds stays in its pixel anyway.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import picture, refuse
from aureole.glare.eye import STANDARD, Eye, EyeState
from aureole.glare.eye_aperture import COMPONENTS, open_share
from aureole.glare.eye_components import component_psfs
from aureole.glare.glare_frames import GlareFrames, pattern_field, pattern_shape
from aureole.records import Spectrum, Stage

Patterns = Callable[[str, EyeState], tuple[NDArray[np.floating], float]]
Nodes = int | Sequence[float]
Axes = tuple[tuple[str, tuple[float, ...]], ...]

SIZE = 2048
# Where the nodes of an axis lie that is given by their number only, metres and radians.
RANGES = {
    "pupil_diameter": (2e-3, 8e-3),
    "lid_opening": (0.1, 1.0),
    "vitreous_angle": (-0.05, 0.05),
    "lens_stretch": (-0.003, 0.003),
}
FRAMES: dict[str, dict[str, Nodes]] = {
    "bloom": {"pupil_diameter": 4, "lid_opening": 4},
    "halo": {"pupil_diameter": 8},
    "corona": {"pupil_diameter": 7, "vitreous_angle": 3},
    "streaks": {"pupil_diameter": 3, "lid_opening": 5},
}
# Where it is measured how much light the lids let through.
OPENING = (
    ("pupil_diameter", (2.5e-3, 7e-3)),
    ("lid_opening", (0.0, 0.1, 0.2, 0.3, 0.4, 0.55, 0.75, 1.0)),
)


@dataclass(frozen=True, eq=False)
class Flipbook:
    """The frames of one component.

    Parameters
    ----------
    axes : tuple of (str, tuple of float)
        Fields of `EyeState` and their nodes, rising; frames lie in C order along them.
    first : int
        Place of the first frame among all.
    shares : ndarray of float64, shape (frames,)
        Share of the light that the component scatters, at each node.
    """

    axes: Axes
    first: int
    shares: NDArray[np.float64]

    def corners(self, state: EyeState) -> list[tuple[int, float]]:
        """Return the frames around a state and the weight of each, 1 in all.

        Parameters
        ----------
        state : EyeState
            What lies beyond the nodes is taken at the last of them.

        Returns
        -------
        list of (int, float)
            Places among this component's frames, and weights.
        """
        found = [(0, 1.0)]
        for name, nodes in self.axes:
            ends = _between(nodes, float(getattr(state, name)))
            found = [
                (place * len(nodes) + node, weight * part)
                for (place, weight), (node, part) in product(found, ends)
                if part > 0
            ]
        return found


@dataclass(frozen=True, eq=False)
class Flipbooks:
    """The four components of an eye's glare through its range of motion, for frames of one size.

    Parameters
    ----------
    eye : Eye
        Whose glare it is.
    colour_space : str
        Of the patterns.
    books : mapping of str to Flipbook
        The components.
    frames : GlareFrames
        The patterns of all frames.
    opening : Flipbook
        Share of the light that the lids let through, without frames of its own.
    """

    eye: Eye
    colour_space: str
    books: Mapping[str, Flipbook]
    frames: GlareFrames
    opening: Flipbook

    @property
    def nbytes(self) -> int:
        """Bytes of memory that all frames take."""
        return self.frames.nbytes

    def mix(self, state: EyeState) -> list[tuple[int, float]]:
        """Return which frames make up a state's glare, and how much of each.

        Parameters
        ----------
        state : EyeState
            Of this eye.

        Returns
        -------
        list of (int, float)
            Places of frames and weights; the weights' sum is 1.
        """
        found: list[tuple[int, float]] = []
        for name, book in self.books.items():
            if name != "bloom":
                parts = ((place, weight * float(book.shares[place])) for place, weight in book.corners(state))
                found += [(book.first + place, part) for place, part in parts if part > 0]
        rest = 1 - sum(part for _, part in found)
        bloom = self.books["bloom"]
        return [(bloom.first + place, weight * rest) for place, weight in bloom.corners(state)] + found

    def open_share(self, state: EyeState) -> float:
        """Return the share of the light that the lids let through, from the nodes around a state.

        Parameters
        ----------
        state : EyeState
            Of this eye.

        Returns
        -------
        float
            0 to 1.
        """
        return sum(w * float(self.opening.shares[place]) for place, w in self.opening.corners(state))


def make_flipbooks(
    eye: Eye = STANDARD,
    shape: tuple[int, int] = (512, 910),
    field_of_view: float = math.radians(60),
    frames: Mapping[str, Mapping[str, Nodes]] | None = None,
    resolution: str = "full",
    colour_space: str = "rec709",
    size: int = SIZE,
    patterns: Patterns | None = None,
) -> Flipbooks:
    """Compute the flipbooks of an eye.

    Parameters
    ----------
    eye : Eye
        Whose glare.
    shape : tuple of int
        (rows, columns) of the pictures, of any size and aspect ratio.
    field_of_view : float
        Radians across the pictures' columns.
    frames : mapping, optional
        For each component the axes, fields of `EyeState`, and for each axis how many nodes, or the nodes
        themselves; `FRAMES` unless given. A component that is missing has its default.
    resolution : str
        "full", or "half": a quarter of the memory, for glare on boxes of 2 × 2 pixels.
    colour_space : str
        Of the pictures.
    size : int
        Of the wave's grid: 2048 samples tell the fibres in pupils up to 9 mm.
    patterns : callable, optional
        Takes a component's name and a state; returns its pattern, (rows, columns, 3) energy per pixel of
        the size `pattern_shape(shape, resolution)`, none negative, and its share of the light. The eye's
        unless given.

    Returns
    -------
    Flipbooks
        For `RealTimeGlare`.

    Raises
    ------
    refuse.Refusal
        Where a component, an axis or a number is unknown or out of range.
    """
    *_, last = make_flipbooks_stages(
        eye, shape, field_of_view, frames, resolution, colour_space, size, patterns
    )
    return last.result  # type: ignore[no-any-return]


def make_flipbooks_stages(
    eye: Eye = STANDARD,
    shape: tuple[int, int] = (512, 910),
    field_of_view: float = math.radians(60),
    frames: Mapping[str, Mapping[str, Nodes]] | None = None,
    resolution: str = "full",
    colour_space: str = "rec709",
    size: int = SIZE,
    patterns: Patterns | None = None,
) -> Iterator[Stage]:
    """Compute the flipbooks of an eye, frame by frame.

    Parameters
    ----------
    eye : Eye
        As in `make_flipbooks`.
    shape : tuple of int
        As in `make_flipbooks`.
    field_of_view : float
        As in `make_flipbooks`.
    frames : mapping, optional
        As in `make_flipbooks`.
    resolution : str
        As in `make_flipbooks`.
    colour_space : str
        As in `make_flipbooks`.
    size : int
        As in `make_flipbooks`.
    patterns : callable, optional
        As in `make_flipbooks`.

    Yields
    ------
    Stage
        One after each frame, without a result; the last has the `Flipbooks`.

    Raises
    ------
    refuse.Refusal
        As in `make_flipbooks`.
    """
    books, count = _empty_books(eye, frames or {})
    _refuse_memory(count, GlareFrames.empty(shape, field_of_view, resolution, 0, is_even(eye)))
    lids = eye.seed, eye.lashes, eye.lash_spread, eye.lash_width, eye.lash_distance
    opening = Flipbook(OPENING, 0, np.array(_open_shares(*lids)))
    found = GlareFrames.empty(shape, field_of_view, resolution, count, is_even(eye))
    if patterns is None:
        patterns = eye_patterns(shape, field_of_view, resolution, colour_space, size)
    for name, book in books.items():
        for place, state in enumerate(_states(eye, book.axes)):
            pattern, book.shares[place] = patterns(name, state)
            found.put(book.first + place, pattern)
            yield Stage((book.first + place + 1) / (count + 1), f"{name} {place + 1} of {len(book.shares)}")
    yield Stage(1.0, "flipbooks", Flipbooks(eye, colour_space, books, found, opening))


def eye_patterns(
    shape: tuple[int, int],
    field_of_view: float,
    resolution: str = "full",
    colour_space: str = "rec709",
    size: int = SIZE,
    spectrum: Spectrum | None = None,
) -> Patterns:
    """Return a function that computes the pattern of one component of an eye in a state.

    Parameters
    ----------
    shape : tuple of int
        (rows, columns) of the pictures.
    field_of_view : float
        Radians across the pictures' columns.
    resolution : str
        "full" or "half".
    colour_space : str
        Of the pictures.
    size : int
        Of the wave's grid: 2048 samples tell the fibres in pupils up to 9 mm.
    spectrum : Spectrum, optional
        The light's; equal energy unless given.

    Returns
    -------
    callable
        Takes a component's name and a state, returns energy per pixel and the share of the light.
    """
    reach, field = pattern_shape(shape, resolution), pattern_field(shape, field_of_view, resolution)

    def pattern(name: str, state: EyeState) -> tuple[NDArray[np.floating], float]:
        psf = component_psfs(
            state,
            reach,
            field,
            spectrum=spectrum,
            colour_space=colour_space,
            projection="perspective",
            size=size,
            components=(name,),
        )[name]
        return psf.pixels, float(psf.metadata["weight"])

    return pattern


def is_even(eye: Eye) -> bool:
    """Return whether an eye's glare is even about the source, as it is where no wavefront is bent.

    Parameters
    ----------
    eye : Eye
        Any.

    Returns
    -------
    bool
        Whether its spectra are real.
    """
    return eye.defocus == 0 and not any(eye.zernike.values())


def _refuse_memory(count: int, room: GlareFrames) -> None:
    """Refuse more patterns than fit, before the work starts."""
    spectra = math.prod(room.kernels.spectra.shape[1:]) * room.kernels.spectra.itemsize
    needed, allowed = count * spectra, picture.allowed_memory()
    if needed > allowed:
        rows, columns = room.shape
        raise refuse.Refusal(
            f"'frames' ({count} patterns for {columns} x {rows} pixels) need {needed / 1e9:.3g} GB of "
            f"memory, {allowed / 1e9:.3g} GB are allowed; take fewer nodes, or resolution 'half'."
        )


def _states(eye: Eye, axes: Axes) -> Iterator[EyeState]:
    """Yield an eye's states at all nodes, in C order."""
    for nodes in product(*(nodes for _, nodes in axes)):
        changes: dict[str, Any] = dict(zip((axis for axis, _ in axes), nodes, strict=True))
        yield replace(EyeState(eye), **changes)


@lru_cache(maxsize=8)
def _open_shares(seed: int, lashes: int, spread: float, width: float, distance: float) -> tuple[float, ...]:
    """Measure how much light lids and lashes let through; nothing else of the eye counts."""
    eye = Eye(seed=seed, lashes=lashes, lash_spread=spread, lash_width=width, lash_distance=distance)
    return tuple(open_share(state, size=128) for state in _states(eye, OPENING))


def _empty_books(eye: Eye, frames: Mapping[str, Mapping[str, Nodes]]) -> tuple[dict[str, Flipbook], int]:
    """Lay out the nodes of all components; return them and the number of frames."""
    for name in frames:
        refuse.one_of("frames", name, COMPONENTS)
    books, first = {}, 0
    for name in COMPONENTS:
        # A pupil that does not reach the fibres has no halo.
        least = 2 * eye.fibre_annulus[0] if name == "halo" else 0.0
        wanted = frames.get(name) or FRAMES[name]
        axes = tuple((axis, _nodes(axis, nodes, least)) for axis, nodes in wanted.items())
        count = math.prod(len(nodes) for _, nodes in axes)
        books[name] = Flipbook(axes, first, np.ones(count))
        first += count
    return books, first


def _nodes(axis: str, nodes: Nodes, least: float) -> tuple[float, ...]:
    """Return an axis's nodes: those given, or so many over its range, diameters at equal ratios."""
    low, high = RANGES[refuse.one_of("axis of 'frames'", axis, RANGES)]
    if isinstance(nodes, int):
        count = refuse.at_least(f"nodes of '{axis}'", nodes, 1)
        if count == 1:
            return (float((low + high) / 2),)
        if axis == "pupil_diameter":
            return tuple(np.geomspace(min(max(low, least), 0.9 * high), high, count).tolist())
        return tuple(np.linspace(low, high, count).tolist())
    given = tuple(refuse.finite(f"node of '{axis}'", node) for node in nodes)
    if not given or any(b <= a for a, b in pairwise(given)):
        raise refuse.Refusal(f"nodes of '{axis}' must rise, got {', '.join(f'{node:g}' for node in given)}.")
    return given


def _between(nodes: Sequence[float], value: float) -> list[tuple[int, float]]:
    """Return the nodes on both sides of a value and their weights."""
    if value <= nodes[0]:
        return [(0, 1.0)]
    if value >= nodes[-1]:
        return [(len(nodes) - 1, 1.0)]
    after = int(np.searchsorted(nodes, value, side="right"))
    part = (value - nodes[after - 1]) / (nodes[after] - nodes[after - 1])
    return [(after - 1, 1 - part), (after, part)]
