"""The bench of area lights: few transforms, errors as said, and refusals."""

import pytest

from aureole import bench, refuse


@pytest.fixture(scope="module")
def rows():
    settings = bench.AreaLightBench(64, 5, 1, ("circle", "leaf", "slanted bars"))
    *_, last = bench.run_area_light(settings)
    (table,) = last.result.tables
    return table.rows


def test_every_method_is_beside_the_transforms(rows):
    kinds = {(row["occluder"], row["method"]) for row in rows}
    assert len(kinds) == len(rows) == 8
    assert all(row["transforms"] == row["samples"] == 25 for row in rows if row["method"] == "FFT")


def test_errors_are_no_larger_than_said(rows):
    compared = [row for row in rows if row["method"] != "FFT"]
    assert all(row["of_light"] <= row["said"] + 1e-5 and row["of_peak"] < 0.01 for row in compared)
    modes = [row for row in compared if row["method"].startswith("modes")]
    assert all(row["transforms"] <= row["samples"] for row in modes)
    assert any(row["transforms"] < 10 for row in modes)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (bench.AreaLightBench(size=63), "'size' must be even"),
        (bench.AreaLightBench(across=0), "'across' must be an integer >= 1"),
        (bench.AreaLightBench(only=("lamp",)), "'only' must be one of"),
    ],
)
def test_refusals(settings, words):
    with pytest.raises(refuse.Refusal, match=words):
        list(bench.run_area_light(settings))
