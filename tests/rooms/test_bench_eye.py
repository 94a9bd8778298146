"""The bench of the eye: what it times is there, what it compares is right, and what it prints is plain."""

import json

import numpy as np
import pytest

from aureole import bench, glare, refuse
from aureole.bench import eye, eye_frames, eye_patterns
from aureole.cli.main import run
from aureole.glare import flipbook

VIEWPORT = (24, 40)


def last(stages):
    """Follow a part of the bench; return its tables by name."""
    every = list(stages)
    assert [stage.fraction for stage in every] == sorted(stage.fraction for stage in every)
    return {table.name: table for table in every[-1].result}


@pytest.fixture(scope="module")
def frames():
    return last(eye_frames.frames((VIEWPORT,), 1, eye.FIGURES))


def test_frames_and_their_stages_are_timed_for_both_resolutions(frames):
    assert list(frames) == ["figure-4-1", "figure-4-2"]
    rows = frames["figure-4-1"].rows
    assert [(row["rows"], row["columns"], row["resolution"]) for row in rows] == [
        (24, 40, "full"),
        (24, 40, "half"),
    ]
    for row in rows:
        # Bloom and streaks by pupil and lids, the corona by pupil and vitreous: four corners; the halo two.
        assert row["mixed"] == 4 + 2 + 4 + 4
        assert row["frame_ms"] > 0
        assert row["rate"] == pytest.approx(1e3 / row["frame_ms"])
        assert row["printed_frame_ms"] is None


def test_printed_times_stand_beside_the_thesiss_viewports():
    """Figure 4.1: 12.5 and 14 ms of 512p glare, 34 ms of 1024p; 4.2: 6 and 16 ms."""
    assert eye.VIEWPORTS == ((512, 910), (1024, 1820))
    printed = eye_frames.PRINTED_FRAMES
    assert [printed[key] for key in ((512, 512), (1024, 512), (1024, 1024))] == [12.5, 14, 34]
    assert eye_frames.PRINTED_TRANSFORMS == {512: 6, 1024: 16}


def test_memory_is_that_of_the_default_flipbooks():
    rows = last(eye_frames.memory((VIEWPORT,)))["memory"].rows
    found = glare.make_flipbooks(
        shape=VIEWPORT,
        field_of_view=1.0,
        patterns=lambda name, state: (np.ones((47, 79, 3), np.float32) / 3713, 0.2),
    )
    assert rows[0]["memory_mb"] == pytest.approx(found.nbytes / 1e6)
    assert rows[0]["frames"] == sum(len(book.shares) for book in found.books.values())
    assert set(flipbook.FRAMES) == set(glare.COMPONENTS)


def test_the_veil_by_circles_is_that_of_the_pattern():
    """Beyond the waves' reach the pattern is CIE 135's own curve, normalised."""
    state = glare.EyeState.at(1.0, 1.0, blinking=False, hippus=False)
    angles = (8.0, 12.0)
    means = eye_patterns.circle_means(state, angles, grid=256)
    standard = glare.veil.cie_135(np.radians(angles), 30.0, 0.5)
    np.testing.assert_allclose(means / standard, 1, atol=0.05)


def test_names_and_numbers_are_checked(capsys):
    assert run(["bench", "eye", "--quick", "--only", "memory", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert [table["name"] for table in said["tables"]] == ["memory"]
    with pytest.raises(refuse.Refusal, match="only"):
        bench.run_eye(bench.EyeBench(only=("table-1",)))
    with pytest.raises(refuse.Refusal, match="runs"):
        bench.run_eye(bench.EyeBench(runs=0))
