"""The benches of the flare room: the tile paper's tables, and rays beside other tracers."""

import importlib.util
import json
import re

import numpy as np
import pytest

from aureole import bench, refuse
from aureole.bench import flare_peers, peer_ways, tile_measures, tile_paper, tile_whole
from aureole.cli.main import run


@pytest.fixture(scope="module")
def rays():
    """The bench of ray tracers at 24², as plain values."""
    stages = list(bench.run_flare_peers(bench.FlarePeersBench(24, 1)))
    assert [stage.fraction for stage in stages] == sorted(stage.fraction for stage in stages)
    return bench.plain(stages[-1].result)["tables"][0]


def test_tracers_that_are_there_are_timed_and_the_others_are_missed(rays):
    there = [peer for peer in flare_peers.PEERS if importlib.util.find_spec(peer.MODULE) is not None]
    ways = [flare_peers.OURS, flare_peers.SLOW, *(peer.NAME for peer in there)]
    assert [row["way"] for row in rays["rows"]] == ways * len(flare_peers.CASES)
    for peer in flare_peers.PEERS:
        assert (f"{peer.NAME}: not installed: {peer_ways.INSTALL}" in rays["notes"]) == (peer not in there)
    assert not any("fails here" in note for note in rays["notes"])


def test_all_tracers_land_in_the_same_places(rays):
    """To a hundredth of a pixel of 19 micrometres; the compiled tracer is in single precision."""
    for row in rays["rows"]:
        assert row["farthest_um"] < 0.19
        assert row["million_rays_per_second"] == pytest.approx(24 * 24 / row["ms"] / 1e3)
        # The grid lies over the part of the pupil that the way uses.
        assert row["passed"] > 0.3


@pytest.mark.parametrize("case", flare_peers.CASES, ids=lambda case: f"{case[0]} {case[1]}")
def test_the_problem_is_where_it_says(case):
    name, numbers, angles = case
    problem = flare_peers.problem_of(name, numbers, angles, 5)
    assert len(problem.points) == 25
    assert np.linalg.norm(problem.heading) == pytest.approx(1)
    x, y, z = problem.direction
    assert np.degrees(np.arctan([x / z, y / z])) == pytest.approx(angles)
    # Rays cross the first vertex's plane at the points.
    steps = -problem.origins[:, 2] / problem.heading[2]
    places = problem.origins + steps[:, None] * problem.heading
    np.testing.assert_allclose(places[:, :2], problem.points, atol=1e-15)


def test_the_command_prints_json(capsys):
    assert run(["bench", "flare-peers", "--side", "4", "--runs", "1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["bench"] == "flare-peers"
    assert run(["bench", "flare-peers", "--side", "3"]) == 2
    assert "'side' must be an integer >= 4, got 3." in capsys.readouterr().err


@pytest.fixture(scope="module")
def tables():
    """The tile paper's bench on one lens, small, as plain values."""
    asked = bench.TilePaperBench(base=24, quick=True, only=("heliar",))
    stages = list(bench.run_tile_paper(asked))
    assert [stage.fraction for stage in stages] == sorted(stage.fraction for stage in stages)
    values = bench.plain(stages[-1].result)
    assert values["settings"]["size"] == "480x270"
    return {table["name"]: table["rows"] for table in values["tables"]}


def test_every_table_of_the_tile_paper_is_measured(tables):
    assert tuple(tables) == (*tile_paper.TABLES, tile_paper.WHOLE)
    for name in tile_paper.TABLES:
        lights = [1, 2] if name in tile_paper.TWO_LIGHTS else [1]
        assert [row["lights"] for row in tables[name]] == lights
        assert all(any(key.startswith("printed_") for key in row) for row in tables[name])


def test_tiles_and_merging_are_the_reference_but_for_little(tables):
    for row in tables["table-3"]:
        assert row["psnr_none"] > 100
        assert row["psnr_light"] > 45.9
        assert row["psnr_heavy"] > 45
        assert row["open_psnr_light"] > 45
        assert max(row["energy_light"], row["energy_heavy"]) < 0.005
        assert row["judged"] > 8


def test_times_add_up(tables):
    one, two = tables["table-2"]
    for row in (one, two):
        assert row["whole_light_ms"] == pytest.approx(
            row["rays_ms"] + row["build_light_ms"] + row["tiles_light_ms"]
        )
        assert row["raster_gain"] == pytest.approx(row["reference_ms"] / row["tiles_light_ms"])
        assert row["printed_raster_gain"] > 1.5
    alone = two["one_rays_ms"] + two["one_build_ms"] + two["one_tiles_ms"]
    assert two["second_light"] == pytest.approx(two["whole_light_ms"] / alone)
    assert two["second_light_raster"] == pytest.approx(two["tiles_light_ms"] / two["one_tiles_ms"])
    assert "second_light" not in one


def test_counts_fall_with_merging(tables):
    for name, key in (("table-5", "prim"), ("table-6", "index")):
        for row in tables[name]:
            found = [row[f"{key}_{merge}"] for merge in tile_measures.MERGES]
            assert found == sorted(found, reverse=True)
            assert row[f"{key}_none_mb"] > 0
    # Four corners of two and of four numbers, an area and three whole numbers.
    row = tables["table-5"][0]
    assert row["prim_none_mb"] * 2**20 == row["prim_none"] * 4 * (8 + 16 + 1 + 3)


def test_the_whole_picture_is_near_fine_grids(tables):
    assert len(tables["whole"]) == len(tile_whole.WAYS)
    assert all(row["psnr"] > 25 for row in tables["whole"])


def test_exposure_and_decibels_by_hand():
    """A tenth off everywhere at 99.9 % exposure of a ramp; light beyond 1 counts only unclipped."""
    reference = np.linspace(0, 1, 30000, dtype=np.float32).reshape(100, 100, 3)
    exposure = np.percentile(reference, 99.9)
    found = reference + 0.1 * exposure
    clipped, unclipped = tile_measures.exposed_psnr(found, reference)
    assert unclipped == pytest.approx(20, abs=1e-3)
    assert clipped > unclipped


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"grids": "pupil"}, "'grids' must be one of 'bounds', 'front', got 'pupil'"),
        ({"only": ("table-9",)}, "'only' must be one of"),
        ({"base": 4}, "'base' must be an integer >= 8, got 4"),
    ],
)
def test_refusals_of_the_tile_papers_bench(asked, message):
    with pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}"):
        bench.run_tile_paper(bench.TilePaperBench(**asked))
