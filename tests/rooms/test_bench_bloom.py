"""The bench of bloom: what is compared, how it is exposed, and refusals."""

import json

import numpy as np
import pytest

from aureole import Picture, bench, picture, refuse
from aureole.bench.bloom import differences
from aureole.cli.main import run

RNG = np.random.default_rng(3)


@pytest.fixture(scope="module")
def row(tmp_path_factory):
    path, out = (tmp_path_factory.mktemp("bloom") / name for name in ("small.exr", "bloom.json"))
    picture.write(path, Picture((RNG.random((30, 50, 3)) ** 9 * 40).astype(np.float32)))
    size = ["--width", "80", "--height", "60", "--runs", "1"]
    assert run(["bench", "bloom", str(path), *size, "-o", str(out)]) == 0
    (table,) = json.loads(out.read_text())["tables"]
    return table["rows"][0]


def test_bloom_is_beside_the_full_one_at_both_precisions(row):
    assert (row["picture"], row["rows"], row["columns"]) == ("small.exr", 60, 80)
    for each in ("double", "single"):
        assert row[f"faster_than_{each}"] == pytest.approx(row[f"{each}_ms"] / row["bloom_ms"])
    assert row["psnr_shown_db"] >= row["psnr_db"] > 40


def test_differences_are_exposed_by_what_is_right():
    right = RNG.random((40, 50, 3)).astype(np.float32)
    right[0, 0] = 1000
    exposed = np.percentile(right, 99.9)
    wrong = right + np.float32(0.01 * exposed)
    found = differences(wrong, right)
    assert found["psnr_db"] == pytest.approx(40, abs=0.01)
    assert found["psnr_worst_db"] == pytest.approx(40, abs=0.01)
    again = differences(7 * wrong, 7 * right)
    assert again["psnr_db"] == pytest.approx(found["psnr_db"], abs=1e-3)
    # What is brighter than white is not seen.
    burnt = right.copy()
    burnt[0, 0] = 2000
    assert differences(burnt, right)["psnr_shown_db"] > 100 > differences(burnt, right)["psnr_db"]


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (bench.BloomBench(size=(15, 80)), "'height' must be an integer >= 16"),
        (bench.BloomBench(size=(80, 3)), "'width' must be an integer >= 16"),
        (bench.BloomBench(runs=0), "'runs' must be an integer >= 1"),
    ],
)
def test_refusals(settings, words):
    with pytest.raises(refuse.Refusal, match=words):
        bench.run_bloom(settings)
