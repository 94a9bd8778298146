"""Ghosts chosen by energy or by name, four reflections, and what is refused."""

import re
from itertools import product
from math import comb

import numpy as np
import pytest

from aureole import flare, light, presets, refuse
from aureole.flare import energy, ghost_paths, random_rays
from aureole.flare.ghost_paths import GhostPath, sides, steps
from aureole.records import Light

HELIAR = flare.load("heliar_tronnier_100mm")
SLANTED = (0.08, -0.05, float(np.sqrt(1 - 0.08**2 - 0.05**2)))
GREEN = Light(SLANTED, light.line(550e-9))
RANKED = [GhostPath((k + 1, 0), e) for k, e in enumerate((0.5, 0.25, 0.125, 0.0625, 0.0625))]


def test_ranked_ghosts_know_their_energy():
    paths = flare.ghosts(HELIAR)
    found = energy.ranked(HELIAR, paths, GREEN, wavelengths=1, base=16)
    energies = [path.energy for path in found]
    assert energies == sorted(energies, reverse=True)
    assert {path.reflections for path in found} == {path.reflections for path in paths}
    alone = {
        path.name: e
        for path, e in zip(paths, energy.ghost_energies(HELIAR, paths, GREEN, None, 1, 16), strict=True)
    }
    assert [alone[path.name] for path in found] == energies


def test_lights_count_by_their_irradiance():
    paths = flare.ghosts(HELIAR)[:3]
    lights = [GREEN, Light((0.0, 0.0, 1.0), light.illuminant("D65"), 3.0)]
    powers = [energy.ghost_energies(HELIAR, paths, one, base=16, within="plane") for one in lights]
    # Shares of the image add up by what each light's image holds.
    images = [
        one.irradiance * energy.ghost_powers(HELIAR, [GhostPath(())], one.direction, 550e-9)[0, 0]
        for one in lights
    ]
    expected = (powers[0] * images[0] + powers[1] * images[1]) / sum(images)
    np.testing.assert_allclose(
        energy.ghost_energies(HELIAR, paths, lights, base=16, within="plane"), expected, rtol=0.02
    )


@pytest.mark.parametrize(
    ("wanted", "count"),
    [
        ("top:1", 1),
        ("top:3", 3),
        ("top:99", 5),
        ("50%", 1),
        ("50.1%", 2),
        ("87.5%", 3),
        ("90%", 4),
        ("100%", 5),
    ],
)
def test_the_strongest_are_as_few_as_will_do(wanted, count):
    assert energy.strongest(RANKED, wanted) == RANKED[:count]


def test_words_choose_ghosts():
    assert energy.chosen(HELIAR, "paper", GREEN) == flare.ghosts(HELIAR, "paper")
    every = energy.ranked(HELIAR, flare.ghosts(HELIAR, "all"), GREEN)
    four = energy.chosen(HELIAR, "top:4", GREEN)
    assert [path.name for path in four] == [path.name for path in every[:4]]
    for quick, careful in zip(four, every, strict=False):
        assert quick.energy == pytest.approx(careful.energy, rel=0.1)
    one_side = energy.chosen(HELIAR, "90%", GREEN, pool="same-side")
    total = energy.ghost_to_image(HELIAR, GREEN, "same-side", base=energy.RANKING_BASE)
    assert sum(path.energy for path in one_side) >= 0.9 * total > sum(p.energy for p in one_side[:-1])


def test_names_show_and_hide():
    paths = flare.ghosts(HELIAR)
    assert [path.name for path in ghost_paths.only(paths, ["3,5", "1-2"])] == ["1-2", "3-5"]
    assert len(ghost_paths.without(paths, ["1-2"])) == len(paths) - 1
    for one in ghost_paths.only, ghost_paths.without:
        with pytest.raises(refuse.Refusal, match=r"^the list of ghosts has no '2-33'\. Did you mean '2-3'"):
            one(paths, ["2-33"])


@pytest.mark.parametrize("name", presets.names("lenses"))
def test_four_bounces_number_as_the_formula_says(name):
    lens = flare.load(name)
    before, behind = sides(lens)

    def count(n):
        return comb(n, 2) + 5 * comb(n, 3) + 5 * comb(n, 4)

    found = flare.four_bounces(lens)
    assert len(found) == count(len(before)) + count(len(behind))
    assert len(flare.four_bounces(lens, "paper")) == count(len(before)) + count(len(behind) - 1)
    assert len({path.reflections for path in found}) == len(found)


def test_four_bounces_are_all_ways_back_and_forth():
    triplet = flare.load("cooke_triplet_100mm")
    known = sorted({*sides(triplet)[0], *sides(triplet)[1]})
    every = {(a, b, c, d) for a, b, c, d in product(known, repeat=4) if a > b < c > d}
    found = flare.four_bounces(triplet, "all")
    assert {path.reflections for path in found} == every
    for path in found:
        assert [k for k, mirror in steps(triplet, path.reflections) if mirror] == list(path.reflections)
        assert ghost_paths.path_named(triplet, path.name) == path


def test_the_shortlist_holds_the_strongest():
    paths = flare.four_bounces(HELIAR)
    every = energy.ranked(HELIAR, paths, GREEN, wavelengths=1, base=16)
    short = {path.reflections for path in energy.shortlist(HELIAR, paths, GREEN, 30)}
    assert len(short) == 30
    assert {path.reflections for path in every[:10]} <= short
    # Of light along the front hardly a ray comes through.
    grazing = Light((0.9992, 0.0, 0.04), GREEN.spectrum)
    assert len(energy.shortlist(HELIAR, paths, grazing, 30)) < 10


def test_four_bounces_are_weaker():
    four = energy.ghost_energies(HELIAR, flare.four_bounces(HELIAR), GREEN, wavelengths=1, base=16).sum()
    assert 0 < four < 0.1 * energy.ghost_to_image(HELIAR, GREEN, "all", wavelengths=1)


def test_a_light_far_outside_the_field_is_compared_with_one_on_the_axis():
    aside = Light((float(np.sin(1.2)), 0.0, float(np.cos(1.2))), light.line(550e-9))
    found = energy.ghost_energies(HELIAR, flare.ghosts(HELIAR), aside, wavelengths=1, base=16)
    assert np.isfinite(found).all()
    assert (found >= 0).all()


def test_refusals():
    cases = [
        (
            lambda: energy.chosen(HELIAR, "same-sid", GREEN),
            "'ghosts' must be one of 'same-side', 'paper', 'all', 'top:20', '90%', got 'same-sid'. "
            "Did you mean 'same-side'?",
        ),
        (
            lambda: energy.chosen(HELIAR, "top:0", GREEN),
            "'ghosts' must be such as 'top:20' or '90%', got 'top:0'.",
        ),
        (lambda: energy.strongest(RANKED, "101%"), "'ghosts' must be such as 'top:20' or '90%', got '101%'."),
        (
            lambda: energy.ghost_energies(HELIAR, flare.ghosts(HELIAR), []),
            "'lights' needs one light or more, got none.",
        ),
        (
            lambda: energy.ghost_powers(HELIAR, flare.ghosts(HELIAR), SLANTED, within="sky"),
            "'within' must be one of 'plane', 'frame', got 'sky'.",
        ),
        (
            lambda: random_rays.monte_carlo(HELIAR, (4, 1), (0.0, 0.0, -1.0)),
            "'direction' must point forward, z > 0, got z = -1.",
        ),
        (
            lambda: random_rays.monte_carlo(HELIAR, (4, 1), SLANTED, rays=1),
            "'rays' must be an integer >= 4, got 1.",
        ),
        (
            lambda: random_rays.monte_carlo(HELIAR, (4, 1), SLANTED, method="fast"),
            "'method' must be one of 'compiled', 'reference', got 'fast'.",
        ),
        (
            lambda: ghost_paths.path_named(HELIAR, "2"),
            "'ghost' must be two or four numbers of surfaces such as 2-5, got '2'.",
        ),
        (
            lambda: ghost_paths.path_named(HELIAR, "2-5-1-3"),
            "'ghost' must turn back and forth between surfaces, got '2-5-1-3'.",
        ),
    ]
    for call, message in cases:
        with pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$"):
            call()
