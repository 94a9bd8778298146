"""Ghosts: how many, which, their names and ways."""

import re

import pytest

from aureole import flare, presets, refuse
from aureole.flare import Surface
from aureole.flare.ghost_paths import GhostPath, sides, steps

# a and b: surfaces between different media before and behind the stop; the counts by brute force below.
SURFACES = {
    "heliar_tronnier_100mm": (5, 3),
    "itoh_wide_zoom_100mm": (8, 10),
    "nikon_tele_zoom_80mm": (17, 4),
    "canon_tele_zoom_70mm": (24, 9),
    "tronnier_double_gauss_100mm": (5, 5),
    "angenieux_double_gauss_100mm": (7, 7),
    "zeiss_biotar_50mm": (5, 5),
    "zeiss_sonnar_50mm": (6, 4),
    "leica_summicron_r_50mm": (5, 5),
    "nikkor_50mm_f1_2": (6, 7),
    "zeiss_master_prime_50mm": (15, 8),
    "kodak_symmetric_100mm": (6, 6),
    "leica_summilux_35mm": (6, 8),
    "nikon_28_70mm_28mm": (14, 13),
    "cooke_triplet_100mm": (4, 2),
    "rudolph_planar_50mm": (5, 5),
    "schneider_anamorphic_31mm": (12, 6),
}


@pytest.mark.parametrize("name", presets.names("lenses"))
def test_counts_are_those_of_the_lists(name):
    lens = flare.load(name)
    assert flare.counts(lens) == {
        which: len(flare.ghosts(lens, which)) for which in ("paper", "same-side", "all")
    }


@pytest.mark.parametrize("name", SURFACES)
def test_lists_hold_each_pair_once(name):
    lens = flare.load(name)
    before, behind = sides(lens)
    assert (len(before), len(behind)) == SURFACES[name]
    pairs = [(i, j) for i in before + behind for j in before + behind if i < j]
    assert {(p.reflections[1], p.reflections[0]) for p in flare.ghosts(lens, "all")} == set(pairs)
    assert len(flare.ghosts(lens, "all")) == len(pairs)
    for path in flare.ghosts(lens):
        later, earlier = path.reflections
        assert earlier < later
        assert not earlier < lens.stop < later
    assert set(flare.ghosts(lens, "paper")) < set(flare.ghosts(lens)) < set(flare.ghosts(lens, "all"))


def test_names_count_from_one():
    lens = flare.load("heliar_tronnier_100mm")
    assert flare.path_of(lens, (5, 2)) == flare.path_of(lens, (2, 5)) == GhostPath((4, 1))
    assert flare.path_of(lens, (2, 5)).name == "2-5"
    assert [path.name for path in flare.ghosts(lens)][:4] == ["1-2", "1-3", "1-4", "1-5"]


def test_steps_turn_at_the_reflections():
    lens = flare.load("cooke_triplet_100mm")
    assert steps(lens) == [(k, False) for k in range(7)]
    way = steps(lens, (3, 1))
    assert [k for k, _ in way] == [0, 1, 2, 3, 2, 1, 2, 3, 4, 5, 6]
    assert [k for k, mirror in way if mirror] == [3, 1]
    assert [mirror for _, mirror in way].index(True) == 3
    four = steps(lens, (3, 1, 5, 0))
    assert [k for k, _ in four] == [0, 1, 2, 3, 2, 1, 2, 3, 4, 5, 4, 3, 2, 1, 0, 1, 2, 3, 4, 5, 6]


def test_an_iris_on_glass_is_on_both_sides():
    """A cemented pair with its stop on the front: all three pairs are behind it."""
    glasses = [flare.named(name) for name in ("N-BK7", "F2")]
    surfaces = (
        Surface(16.0, 6e-3, 0.012, glasses[0], stop=True),
        Surface(-22.0, 2.5e-3, 0.012, glasses[1]),
        Surface(-7.0, 0.1, 0.012),
    )
    lens = flare.Lens("doublet", "Doublet", 0.1, 4.0, (0.036, 0.024), surfaces)
    assert [path.name for path in flare.ghosts(lens)] == ["1-2", "1-3", "2-3"]
    assert flare.counts(lens) == {"paper": 1, "same-side": 3, "all": 3}
    assert len(flare.ghosts(lens, "all")) == 3


def test_refusals():
    lens = flare.load("heliar_tronnier_100mm")
    with pytest.raises(refuse.Refusal, match=r"^'which' must be one of 'same-side', 'paper', 'all', got"):
        flare.ghosts(lens, "some")
    message = "'ghost' must be two different reflecting surfaces out of 1, 2, 3, 4, 5, 7, 8, 9, got 2,6."
    with pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$"):
        flare.path_of(lens, (2, 6))
    for wrong in ((2,), (2, 2), (0, 3), (2, 99)):
        with pytest.raises(refuse.Refusal, match=r"^'ghost' must be two different"):
            flare.path_of(lens, wrong)
