"""Ghosts: the ways through a lens with two reflections, and their names.

A ray that is thrown back at surface j and again at an earlier surface i reaches the sensor as a ghost.
The tile paper (Bodonyi and Kunkli 2023, section 3.2) keeps the pairs on one side of the stop; the counts that
it prints leave out the last glass surface, too.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import comb

from aureole import refuse
from aureole.flare.prescription import Lens, refracts

WHICH = ("same-side", "paper", "all")


@dataclass(frozen=True)
class GhostPath:
    """A way through the lens with two reflections (or four).

    Parameters
    ----------
    reflections : tuple of int
        Indices of the reflecting surfaces, counted from 0, in the order in which the light meets them:
        a later one, an earlier one, and so on.
    energy : float, optional
        Its luminous power over that of the light's own image, where it is known.
    """

    reflections: tuple[int, ...]
    energy: float | None = None

    @property
    def name(self) -> str:
        """The reflecting surfaces as people count them, from 1, front first: "2-5"."""
        return "-".join(str(k + 1) for k in sorted(self.reflections[:2]) + list(self.reflections[2:]))


def ghosts(lens: Lens, which: str = "same-side") -> list[GhostPath]:
    """Return a lens's ghosts of two reflections, by their surfaces from front to back.

    Parameters
    ----------
    lens : Lens
        The lens.
    which : {"same-side", "paper", "all"}
        Both reflections on one side of the stop, by the tile paper's stated rule; the fewer that its
        tables count, without the last glass surface; or all pairs, those across the stop, too.

    Returns
    -------
    list of GhostPath
        Each has the later surface first.

    Raises
    ------
    refuse.Refusal
        Where `which` is unknown.
    """
    refuse.one_of("which", which, WHICH)
    before, behind = sides(lens)
    if which == "all":
        return _pairs(sorted({*before, *behind}))
    return _pairs(before) + _pairs(behind[:-1] if which == "paper" else behind)


def sides(lens: Lens) -> tuple[list[int], list[int]]:
    """Return the reflecting surfaces before and behind the stop.

    Parameters
    ----------
    lens : Lens
        The lens.

    Returns
    -------
    before, behind : list of int
        Indices of the surfaces between two different media; an iris that lies on glass is on both sides.
    """
    reflecting = [k for k in range(len(lens.surfaces)) if refracts(lens, k)]
    return [k for k in reflecting if k <= lens.stop], [k for k in reflecting if k >= lens.stop]


def counts(lens: Lens) -> dict[str, int]:
    """Return how many ghosts each rule has, from the numbers of surfaces alone.

    Parameters
    ----------
    lens : Lens
        The lens.

    Returns
    -------
    dict of str to int
        "paper": C(a, 2) + C(b - 1, 2), "same-side": C(a, 2) + C(b, 2), "all": C(a + b, 2), with a and b
        surfaces before and behind the stop.
    """
    before, behind = sides(lens)
    a, b = len(before), len(behind)
    return {
        "paper": comb(a, 2) + comb(max(b - 1, 0), 2),
        "same-side": comb(a, 2) + comb(b, 2),
        "all": comb(len({*before, *behind}), 2),
    }


def path_of(lens: Lens, numbers: Sequence[int]) -> GhostPath:
    """Return the ghost of two surfaces as people count them.

    Parameters
    ----------
    lens : Lens
        The lens.
    numbers : sequence of int
        Two numbers, the first surface is 1.

    Returns
    -------
    GhostPath
        The later surface first.

    Raises
    ------
    refuse.Refusal
        Where they are not two surfaces that reflect.
    """
    before, behind = sides(lens)
    known = sorted({*before, *behind})
    if len(numbers) != 2 or numbers[0] == numbers[1] or any(n - 1 not in known for n in numbers):
        listed = ", ".join(str(k + 1) for k in known)
        got = ",".join(map(str, numbers))
        raise refuse.Refusal(f"'ghost' must be two different reflecting surfaces out of {listed}, got {got}.")
    first, second = sorted(n - 1 for n in numbers)
    return GhostPath((second, first))


def path_named(lens: Lens, name: str) -> GhostPath:
    """Return the ghost of a name.

    Parameters
    ----------
    lens : Lens
        The lens.
    name : str
        "2-5" or "2,5", and "2-5-1-3" for four reflections, as `GhostPath.name` has them.

    Returns
    -------
    GhostPath
        The ghost.

    Raises
    ------
    refuse.Refusal
        Where the name has no two or four numbers, or they are no way through the lens.
    """
    words = name.replace(",", "-").split("-")
    if len(words) not in (2, 4) or not all(word.strip().isdecimal() for word in words):
        raise refuse.Refusal(f"'ghost' must be two or four numbers of surfaces such as 2-5, got '{name}'.")
    numbers = [int(word) for word in words]
    path = path_of(lens, numbers[:2])
    if len(numbers) == 2:
        return path
    last = numbers[2] - 1, numbers[3] - 1
    # The third surface lies behind the second one met, the fourth before the third.
    if last[0] <= path.reflections[1] or path_of(lens, numbers[2:]).reflections != last:
        raise refuse.Refusal(f"'ghost' must turn back and forth between surfaces, got '{name}'.")
    return GhostPath((*path.reflections, *last))


def only(paths: Sequence[GhostPath], names: Collection[str]) -> list[GhostPath]:
    """Return the ghosts of some names.

    Parameters
    ----------
    paths : sequence of GhostPath
        To choose from.
    names : collection of str
        Such as "2-5".

    Returns
    -------
    list of GhostPath
        In the order of the paths.

    Raises
    ------
    refuse.Refusal
        Where a name is none of the paths'.
    """
    wanted = _known(paths, names)
    return [path for path in paths if path.name in wanted]


def without(paths: Sequence[GhostPath], names: Collection[str]) -> list[GhostPath]:
    """Return the ghosts but those of some names.

    Parameters
    ----------
    paths : sequence of GhostPath
        To choose from.
    names : collection of str
        Such as "2-5".

    Returns
    -------
    list of GhostPath
        In the order of the paths.

    Raises
    ------
    refuse.Refusal
        Where a name is none of the paths'.
    """
    hidden = _known(paths, names)
    return [path for path in paths if path.name not in hidden]


def four_bounces(lens: Lens, which: str = "same-side") -> list[GhostPath]:
    """Return a lens's ghosts of four reflections.

    Parameters
    ----------
    lens : Lens
        The lens.
    which : {"same-side", "paper", "all"}
        Out of which surfaces, as in `ghosts`: all four on one side of the stop; the same without the
        last glass surface; or any.

    Returns
    -------
    list of GhostPath
        n reflecting surfaces have C(n, 2) + 5 C(n, 3) + 5 C(n, 4): hundreds for a prime, two hundred
        thousand for a zoom.

    Raises
    ------
    refuse.Refusal
        Where `which` is unknown.
    """
    refuse.one_of("which", which, WHICH)
    before, behind = sides(lens)
    if which == "all":
        return _fours(sorted({*before, *behind}))
    return _fours(before) + _fours(behind[:-1] if which == "paper" else behind)


def steps(lens: Lens, reflections: Sequence[int] = ()) -> list[tuple[int, bool]]:
    """Return the surfaces that light meets, in order, and at which of them it is thrown back.

    Parameters
    ----------
    lens : Lens
        The lens.
    reflections : sequence of int
        Indices of reflecting surfaces as in `GhostPath`; none is the way of the image.

    Returns
    -------
    list of (int, bool)
        Index of a surface and whether the light is reflected there.

    Raises
    ------
    refuse.Refusal
        Where the reflections are not an even number that turn the light back and forth.
    """
    count = len(lens.surfaces)
    turns = list(reflections)
    wrong = len(turns) % 2 or any(
        not 0 <= here < count or (here >= before if k % 2 == 0 else here <= before)
        for k, (before, here) in enumerate(pairwise(turns))
    )
    if wrong or any(not 0 <= k < count for k in turns):
        raise refuse.Refusal(f"'reflections' must turn back and forth between surfaces, got {tuple(turns)}.")
    found: list[tuple[int, bool]] = []
    place, ahead = 0, 1
    for turn in turns:
        found += [(k, False) for k in range(place, turn, ahead)]
        found.append((turn, True))
        ahead = -ahead
        place = turn + ahead
    return found + [(k, False) for k in range(place, count)]


def _pairs(surfaces: Sequence[int]) -> list[GhostPath]:
    return [GhostPath((j, i)) for k, i in enumerate(surfaces) for j in surfaces[k + 1 :]]


def _fours(surfaces: Sequence[int]) -> list[GhostPath]:
    """Return every a > b < c > d, by b and c first."""
    return [
        GhostPath((a, b, c, d))
        for k, b in enumerate(surfaces)
        for m, c in enumerate(surfaces[k + 1 :], k + 1)
        for a in surfaces[k + 1 :]
        for d in surfaces[:m]
    ]


def _known(paths: Sequence[GhostPath], names: Collection[str]) -> set[str]:
    """Return names as `GhostPath` has them, each of which is one of the paths'."""
    wanted = [name.replace(",", "-").replace(" ", "") for name in names]
    have = {path.name for path in paths}
    for name in wanted:
        if name not in have:
            raise refuse.unknown_key("the list of ghosts", name, have)
    return set(wanted)
