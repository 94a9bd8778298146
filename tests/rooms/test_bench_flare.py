"""The benches of the flare room: rays beside other tracers."""

import importlib.util
import json

import numpy as np
import pytest

from aureole import bench
from aureole.bench import flare_peers, peer_ways
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
    """To a hundredth of a micrometre; a pixel is 19."""
    for row in rays["rows"]:
        assert row["farthest_um"] < 0.01
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
