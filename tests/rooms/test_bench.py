"""The bench room through its command, at tiny sizes: what it measures, prints, writes and refuses."""

import importlib.util
import json
import sys
import types

import numpy as np
import pytest

from aureole import Aperture, Grid, bench, diffraction
from aureole.bench import (
    peer_scipy,
    peer_ways,
    progressive,
    quad_counts,
    quality,
    shapes,
    spectral,
    starbursts,
    symmetry,
    timing,
)
from aureole.bench.optics import Optics
from aureole.cli.main import run

QUAD_PAPER = ("table-1", "table-2", "table-3", "figure-8", "figure-9", "figure-10", "figure-11")


def told(words, capsys):
    """Run a bench with --json and return its tables by name, and all of it."""
    assert run(["bench", *words, "--json"]) == 0
    values = json.loads(capsys.readouterr().out)
    return {table["name"]: table["rows"] for table in values["tables"]}, values


def drained(stages):
    """Run a generator to its end; return what it yielded and what it returned."""
    yielded = []

    def outer():
        yielded.append((yield from stages))

    return list(outer()), yielded[0]


@pytest.fixture(scope="module")
def quad_paper():
    """The whole of the quad paper's bench at 64², as plain values."""
    stages = list(bench.run_quad_paper(bench.QuadPaperBench(size=64, runs=1, frames=5)))
    return stages, bench.plain(stages[-1].result)


def test_quad_paper_measures_every_table_and_tells_how_far_it_is(quad_paper):
    stages, values = quad_paper
    assert tuple(table["name"] for table in values["tables"]) == QUAD_PAPER
    assert all(table["rows"] and table["notes"] for table in values["tables"])
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1
    assert all(stage.label for stage in stages)


def test_the_environment_says_machine_versions_and_settings(quad_paper):
    values = quad_paper[1]
    where = values["environment"]
    assert where["versions"]["numpy"] == np.__version__
    assert where["processors"] >= 1
    assert {"platform", "python", "threads", "processor", "seconds"} <= set(where)
    assert values["settings"] == {"size": 64, "runs": 1, "frames": 5, "only": [], "seed": None}


def test_times_are_positive_and_gains_are_their_ratios(quad_paper):
    tables = {table["name"]: table["rows"] for table in quad_paper[1]["tables"]}
    for name in ("table-2", "table-3", "figure-11"):
        assert all(row["median_ms"] > 0 for row in tables[name])
    assert sum(row["share"] for row in tables["figure-11"]) == pytest.approx(1)
    assert len(tables["figure-10"]) == len(shapes.OUTLINES) * len(progressive.RADII)
    for row in tables["figure-10"]:
        assert ("printed_part" in row) == (row["aperture"] != "box")
        assert row["gain"] == pytest.approx(row["fresh_ms"] / row["update_ms"])
        assert row["part"] == pytest.approx(row["update_quads"] / row["fresh_quads"])
        assert row["error"] < 1e-4


def test_printed_figures_are_the_papers():
    """Quad paper: Tables 1, 2 and 3."""
    assert quad_counts.PRINTED["box"] == (40, 40, 40, 617, 617)
    assert quad_counts.PRINTED["circle"] == (109, 227, 440, 981, 1976)
    assert quad_counts.PRINTED["heptagon"] == (176, 389, 730, 1613, 2996)
    assert quad_counts.PRINTED["whirl"] == (303, 647, 1358, 2673, 5278)
    assert symmetry.PRINTED_MS == {
        "no optimizations": (0.13, 0.40, 2.25, 19.46, 139.35),
        "culling": (0.21, 0.32, 1.06, 5.65, 31.63),
        "symmetry": (0.14, 0.25, 1.20, 9.76, 74.70),
        "culling + symmetry": (0.14, 0.26, 0.71, 3.57, 20.22),
    }
    assert spectral.PRINTED_MS["full"] == (0.040, 0.127, 0.530, 1.960, 8.180)
    assert spectral.PRINTED_MS["batch"] == (0.019, 0.038, 0.114, 0.430, 1.710)


def test_printed_figures_stand_beside_their_own_sizes(capsys):
    words = ["quad-paper", "--only", "table-1, table-3", "--size", "512", "--runs", "1"]
    rows = told(words, capsys)[0]
    circle = {row["size"]: row for row in rows["table-1"] if row["aperture"] == "circle"}
    assert sorted(circle) == [32, 64, 128, 256, 512]
    assert "printed" not in circle[128]
    assert (circle[256]["printed"], circle[512]["printed"]) == (109, 227)
    assert circle[512]["printed_growth"] == pytest.approx(227 / 109)
    assert circle[512]["growth"] == pytest.approx(circle[512]["quads"] / circle[256]["quads"])
    assert all(row["repainted"] for row in rows["table-1"])
    for method in spectral.PRINTED_MS:
        own = {row["size"] for row in rows["table-3"] if row["method"] == method and "printed_ms" in row}
        assert own == {256, 512}


def test_every_way_of_table_2_gives_one_power(quad_paper):
    rows = quad_paper[1]["tables"][1]["rows"]
    assert {row["way"] for row in rows} == set(symmetry.PRINTED_MS)
    assert all(abs(row["energy_lost"]) < 0.05 for row in rows if "culling" in row["way"])
    assert all(row["error"] < 2e-6 for row in rows)


def test_the_full_level_is_the_brute_force_transform(quad_paper):
    """The quads of the full level are the mask itself; coarser levels lose quality, step by step."""
    rows = quad_paper[1]["tables"][3]["rows"]
    for name in shapes.OUTLINES:
        full, half, quarter = (row for row in rows if row["aperture"] == name)
        assert full["psnr"] > 140
        assert full["log_psnr"] > 100
        assert full["log_ssim"] > 0.999
        for key in ("psnr", "log_psnr", "ssim", "log_ssim"):
            assert full[key] >= half[key] >= quarter[key]


def test_what_is_infinite_is_null_in_json():
    rows = ({"psnr": float("inf"), "quads": 3},)
    column = bench.Column("PSNR", "{psnr:.1f} dB")
    report = bench.Report("b", {}, {}, (bench.Table("t", "T", (column,), rows),))
    assert bench.plain(report)["tables"][0]["rows"] == [{"psnr": None, "quads": 3}]
    assert [column.cell(row) for row in (*rows, {"psnr": None}, {"psnr": 4.25}, {})] == [
        "inf dB",
        "",
        "4.2 dB",
        "",
    ]


def test_quality_of_a_known_difference():
    """Everything twice as bright: 20 log10(1 / rms) by hand, and log10(2) of ten decades."""
    truth = np.full((16, 16), 0.25)
    truth[3, 4] = 1.0
    found = quality.compared(2 * truth, truth)
    assert found["psnr"] == pytest.approx(-10 * np.log10(np.mean(truth**2)))
    assert found["log_psnr"] == pytest.approx(20 * np.log10(10 / np.log10(2)))


def test_the_shadow_moves_and_the_last_frame_agrees():
    painted = progressive.frames("circle", 64, 5, radius=6.5, step=(4.0, 3.0))
    opening = np.round(shapes.mask("circle", 64, across=1.0))
    places = [np.argwhere(opening > frame.mask).mean(axis=0) for frame in painted]
    np.testing.assert_allclose(np.diff(places, axis=0), np.tile([3.0, 4.0], (4, 1)), atol=1e-12)
    assert progressive.follow(painted)["error"] < 1e-5


def installed(peer):
    return importlib.util.find_spec(peer.MODULE) is not None


def test_peers_that_are_there_agree_and_the_others_are_missed(capsys):
    """SciPy is always there; any other is measured, or said to be missing with the way to get it."""
    tables, values = told(["peers", "--size", "32", "--runs", "1"], capsys)
    assert set(tables) == {"zoom", "zoom-half", "starburst"}
    there = [peer for peer in peer_ways.PEERS if installed(peer)]
    assert peer_scipy in there
    for name in ("zoom", "zoom-half"):
        assert [row["way"] for row in tables[name]][:3] == ["Aureole", "SciPy rfft, padded", "SciPy ZoomFFT"]
        assert {peer.LOOP for peer in there} <= {row["way"] for row in tables[name]}
        assert all(row["error"] < 1e-5 for row in tables[name])
        assert all(row["heptagon_ms"] > 0 for row in tables[name])
        ours, padded = tables[name][:2]
        assert padded["whirl_ratio"] == pytest.approx(padded["whirl_ms"] / ours["whirl_ms"])
    ours, *loops = tables["starburst"]
    assert ours["way"] == "Aureole, one call"
    assert ours["log_psnr"] > 65
    assert [row["way"] for row in loops] == [peer.LOOP for peer in there]
    for row in loops:
        assert row["ratio"] == pytest.approx(row["median_ms"] / ours["median_ms"])
        # All of them lose the same by their pixels and their 60 wavelengths.
        assert row["log_psnr"] == pytest.approx(loops[0]["log_psnr"], abs=0.1)
        assert row["log_psnr"] < ours["log_psnr"]
    for table in values["tables"]:
        missed = {f"{peer.NAME}: not installed: pip install 'aureole[bench]'" for peer in peer_ways.PEERS}
        missed -= {f"{peer.NAME}: not installed: pip install 'aureole[bench]'" for peer in there}
        assert missed <= set(table["notes"])
        assert not any("fails here" in note for note in table["notes"])


def test_a_peer_that_fails_is_said_and_the_others_go_on():
    def ways(optics):
        raise ImportError("no such backend")

    broken = types.SimpleNamespace(NAME="Broken", MODULE="scipy", PACKAGE="broken", ways=ways)
    optics = Optics(np.ones((4, 4), dtype=np.float32), 1.0, 1.0, 1e-6)
    notes = []
    found = peer_ways.ways_of([broken, peer_scipy], optics, notes)
    assert [way for way, _, _ in found] == ["SciPy ZoomFFT"]
    assert notes == ["Broken: installed, but fails here: ImportError: no such backend"]


def test_what_a_peer_prints_does_not_reach_stdout(capsys):
    def noisy(wavelength):
        print("Computation Took 3 s")
        return np.ones((4, 4))

    peer = types.SimpleNamespace(NAME="Noisy", MODULE="scipy", PACKAGE="noisy", ways=lambda _: {"a": noisy})
    ((_, at, _),) = peer_ways.ways_of([peer], None, [])
    at(550e-9)
    said = capsys.readouterr()
    assert said.out == ""
    assert "Computation" in said.err


@pytest.mark.parametrize("finer", [1, 3, 4])
@pytest.mark.parametrize("size", [16, 22])
def test_the_padded_transform_is_the_dft(size, finer):
    """Σ f exp(−i2π(ux + vy)) over samples, at u = k / (finer · size), summed directly."""
    mask = np.random.default_rng(5).random((size, size), dtype=np.float32)
    place, frequency = np.arange(size), (np.arange(size) - size // 2) / (finer * size)
    wave = np.exp(-2j * np.pi * np.outer(frequency, place))
    wanted = np.abs(wave @ mask @ wave.T) ** 2
    np.testing.assert_allclose(peer_scipy.padded_power(mask, finer), wanted, rtol=0, atol=1e-5 * wanted.max())


@pytest.mark.parametrize("size", [16, 21])
def test_the_real_transform_is_the_dft(size):
    mask = np.random.default_rng(6).random((size, size), dtype=np.float32)
    wanted = np.abs(np.fft.fft2(mask.astype(np.float64))) ** 2
    np.testing.assert_allclose(peer_scipy.real_power(mask), wanted, rtol=0, atol=1e-5 * wanted.max())


def test_scipys_zoom_follows_the_wavelength():
    """|F(x / λf)|² / λ² of the mask's pixels, but for their own transform."""
    size, width, focal = 16, 2e-3, 50e-3
    mask = shapes.mask("whirl", size)
    optics = Optics(mask, width, focal, 7e-6)
    at = peer_scipy.ways(optics)["SciPy ZoomFFT"]
    for wavelength in (450e-9, 650e-9):
        step = optics.pitch / (wavelength * focal)
        grid = Grid((size, size), (step, step))
        wanted = diffraction.far_power(Aperture(width, mask=mask), grid, "reference") / wavelength**2
        pixel = np.sinc(grid.axes()[0] * width / size) ** 2 * (width / size) ** 2
        found = at(wavelength) * pixel[:, None] * pixel
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9 * wanted.max())


def test_the_starbursts_reference_holds_the_lights_white():
    """Summed over all wavelengths, energy over a wide sensor tends to the white of the light."""
    from aureole import aperture, light

    iris, lamp = aperture.iris(7, 1e-3), light.illuminant("D65")
    stages = starbursts._reference(iris, Grid((96, 96), (1e-4, 1e-4)), lamp, 101)
    total = drained(stages)[1]
    np.testing.assert_allclose(total.sum(axis=(0, 1)), light.white(lamp), rtol=0.03)


def test_alternate_takes_medians_in_turn():
    calls = []
    tasks = {name: lambda name=name: calls.append(name) for name in "abcdef"}
    stages = timing.alternate(tasks, 3, once=["c", "d", "e", "f"])
    told, medians = drained(stages)
    assert all(0 <= stage.fraction < 1 for stage in told)
    assert set(medians) == set("abcdef")
    # One call warms a and b; the others are warm already, and one is timed in each round while they last.
    assert "".join(calls) == "ab" + "abcf" + "abd" + "abe"


def test_a_slow_task_is_timed_less_often():
    calls = []
    list(timing.alternate({"slow": lambda: calls.append(1)}, 9, patience=0.0))
    assert len(calls) == 2


def test_tables_fit_a_hundred_columns_and_print_the_paper(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    assert run(["bench", "quad-paper", "--size", "256", "--runs", "1", "--frames", "5"]) == 0
    said = capsys.readouterr()
    lines = said.out.splitlines()
    assert max(len(line) for line in lines) <= 100
    assert "…" not in said.out
    assert "GTX 1080 Ti" in said.out
    circle = next(line for line in lines if line.startswith("circle") and "256²" in line)
    assert "109" in circle.split()
    assert any("0.040 ms" in line for line in lines)
    assert said.err == ""


def test_results_are_written_whole(tmp_path, capsys):
    out = tmp_path / "results.json"
    words = ["bench", "peers", "--only", "zoom,scipy", "--size", "16", "--runs", "1", "-o", str(out)]
    assert run(words) == 0
    values = json.loads(out.read_text(encoding="utf-8"))
    assert values["bench"] == "peers"
    assert [table["name"] for table in values["tables"]] == ["zoom", "zoom-half"]
    assert values["environment"]["versions"]["scipy"]
    # A peer that was not asked for is not missed.
    assert "not installed" not in out.read_text(encoding="utf-8")
    assert list(tmp_path.iterdir()) == [out]
    assert "Far field of a 16² mask" in capsys.readouterr().out


REFUSED = [
    (["quad-paper", "--only", "table-4"], "'only' must be one of 'table-1', 'table-2',"),
    (["quad-paper", "--size", "100"], "'size' must be a power of two, such as 1024, got 100."),
    (["quad-paper", "--size", "16"], "'size' must be an integer >= 32, got 16."),
    (["quad-paper", "--runs", "0"], "'runs' must be an integer >= 1, got 0."),
    (["quad-paper", "--frames", "2"], "'frames' must be an integer >= 3, got 2."),
    (["peers", "--only", "prism"], "Did you mean 'prysm'?"),
    (["peers", "--size", "33"], "'size' must be even, got 33."),
    (["peers", "--runs", "-1"], "'runs' must be an integer >= 1, got -1."),
    (["peers", "-o", "results.txt"], "'output' must end in .json, got 'results.txt'."),
    (["peers", "-o", "no/results.json"], "there is no folder 'no'"),
    (["peer"], "No such command"),
]


@pytest.mark.parametrize(("words", "text"), REFUSED, ids=[" ".join(words) for words, _ in REFUSED])
def test_bad_input_is_refused_in_one_line_before_work(words, text, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert run(["bench", *words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.strip().splitlines()) == 1
    assert text in said.err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("words", [[], ["quad-paper"], ["peers"]])
def test_help_teaches_by_example(words, capsys):
    assert run(["bench", *words, "--help"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "Example" in text
    assert "aureole bench" in text


def test_the_room_imports_no_peer():
    """Peers are imported when they are asked for, so that the command line stays quick without them."""
    code = "import sys, aureole.bench; print([m for m in ('prysm', 'hcipy', 'jax') if m in sys.modules])"
    import subprocess

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
