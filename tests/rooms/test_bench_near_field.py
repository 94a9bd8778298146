"""The near field's bench: its discrete rivals against closed forms and direct integrals, and its tables."""

import importlib.util
import json
import types

import numpy as np
import pytest

from aureole import Aperture, Grid, bench, diffraction
from aureole.bench import (
    convolved,
    fractional,
    near_field,
    near_levels,
    near_peers,
    near_table,
    peer_ways,
    shapes,
)
from aureole.bench.optics import Plane
from aureole.cli.main import run

WIDTH, WAVELENGTH = 0.1, 550e-9


def places(size):
    return (np.arange(size) - size // 2) / np.sqrt(size)


def lump(size):
    """A smooth complex picture that is not symmetric and dies away before the border."""
    x = places(size)
    across = np.exp(-np.pi * ((x - 0.8) / 1.3) ** 2 + 2j * x)
    return np.outer(np.exp(-np.pi * ((x + 0.7) / 0.8) ** 2), across)


def distance(fresnel_number, width=WIDTH):
    """The distance at which an opening across half of the window has a Fresnel number."""
    return (width / 4) ** 2 / (WAVELENGTH * fresnel_number)


@pytest.mark.parametrize("order", [-1.7, -0.4, 0, 0.1, 0.5, 0.77, 1, 1.2, 1.5, 2, 2.5, 3.9])
def test_a_gaussian_is_its_own_fractional_transform(order):
    """exp(−πx²) is the first eigenfunction, with eigenvalue 1 for every order."""
    gaussian = np.exp(-np.pi * places(144) ** 2)
    picture = np.outer(gaussian, gaussian).astype(complex)
    np.testing.assert_allclose(fractional.fractional(picture, order), picture, atol=1e-12)


@pytest.mark.parametrize("order", [0.3, 0.62, 1.4, -0.8])
def test_the_first_hermite_function_turns_with_the_order(order):
    """x exp(−πx²) has eigenvalue exp(−iaπ/2)."""
    x = places(144)
    picture = np.outer(np.exp(-np.pi * x**2), x * np.exp(-np.pi * x**2)).astype(complex)
    wanted = np.exp(-0.5j * np.pi * order) * picture
    np.testing.assert_allclose(fractional.fractional(picture, order), wanted, atol=1e-12)


@pytest.mark.parametrize("size", [144, 161])
def test_order_one_is_the_fourier_transform(size):
    picture = lump(size)
    phase = np.exp(-2j * np.pi * np.outer(places(size), places(size))) / np.sqrt(size)
    wanted = phase @ picture @ phase.T
    np.testing.assert_allclose(fractional.fractional(picture, 1), wanted, atol=1e-12)
    # It is a limit from both sides, where the algorithm takes other ways.
    for near in (1 - 1e-9, 1 + 1e-9):
        np.testing.assert_allclose(fractional.fractional(picture, near), wanted, atol=1e-7)


def test_order_two_turns_the_picture_about():
    picture = lump(161)
    np.testing.assert_allclose(fractional.fractional(picture, 2), picture[::-1, ::-1], atol=1e-12)


@pytest.mark.parametrize(("first", "second"), [(0.37, 0.85), (0.37, -0.37), (1.3, 0.9), (-0.6, 0.2)])
def test_orders_add_up(first, second):
    twice = fractional.fractional(fractional.fractional(lump(144), first), second)
    np.testing.assert_allclose(twice, fractional.fractional(lump(144), first + second), atol=1e-12)


@pytest.mark.parametrize("order", [0.2, 0.62, 1.1])
@pytest.mark.parametrize("size", [144, 161])
def test_the_fractional_transform_is_its_integral(order, size):
    """The defining integral, summed finely."""
    angle = 0.5 * np.pi * order
    t = np.linspace(-8, 8, 6001)
    x = places(size)[:, None]
    kernel = np.exp(1j * np.pi * ((x**2 + t**2) / np.tan(angle) - 2 * x * t / np.sin(angle)))
    kernel *= np.sqrt(1 - 1j / np.tan(angle)) * (t[1] - t[0])
    across = kernel @ (np.exp(-np.pi * ((t - 0.8) / 1.3) ** 2 + 2j * t))
    down = kernel @ np.exp(-np.pi * ((t + 0.7) / 0.8) ** 2)
    np.testing.assert_allclose(fractional.fractional(lump(size), order), np.outer(down, across), atol=1e-12)


def test_single_precision_stays_single():
    found = fractional.fractional(lump(144).astype(np.complex64), 0.4)
    assert found.dtype == np.complex64
    np.testing.assert_allclose(found, fractional.fractional(lump(144), 0.4), atol=1e-5)


@pytest.mark.parametrize("fresnel_number", [0.5, 4, 60])
def test_fresnel_diffraction_of_a_gaussian_by_its_order(fresnel_number):
    """exp(−πx²/b²) spreads to exp(−πx²/(b² + iλz)) b / √(b² + iλz) a direction: phase and scale as well."""
    size, far = 256, distance(fresnel_number)
    waist = WIDTH / 6
    x = (np.arange(size) - size // 2) * WIDTH / size
    gaussian = np.exp(-np.pi * (x / waist) ** 2)
    mask = np.outer(gaussian, gaussian).astype(np.float32)
    field, spacing = fractional.fractional_near(mask, WIDTH, far, WAVELENGTH)
    order = fractional.fresnel_order(size, WIDTH, far, WAVELENGTH)
    window = (WIDTH / 2) ** 2 / (WAVELENGTH * far)
    assert np.tan(0.5 * np.pi * order) == pytest.approx(size / (4 * window))
    assert spacing == pytest.approx(WIDTH / size / np.cos(0.5 * np.pi * order))
    wide = waist**2 + 1j * WAVELENGTH * far
    seen = (np.arange(size) - size // 2) * spacing
    line = waist / np.sqrt(wide) * np.exp(-np.pi * seen**2 / wide)
    np.testing.assert_allclose(field, np.outer(line, line), atol=3e-6)


def rms(found, truth):
    """The difference of two irradiances, root mean square, of the mean."""
    found, truth = np.abs(found) ** 2, np.abs(truth) ** 2
    return float(np.sqrt(np.mean((found - truth) ** 2)) / truth.mean())


@pytest.fixture(scope="module")
def opening():
    return shapes.mask("heptagon", 128)


def truth(mask, far, spacing):
    """The exact near field of the mask at the places of samples, of which the middle one is on the axis."""
    size = len(mask)
    half = 0.5 * WIDTH / size
    grid = Grid((size, size), (spacing, spacing), (half, half))
    return diffraction.near_field(Aperture(WIDTH, mask=mask), grid, far, WAVELENGTH, "reference").amplitude


@pytest.mark.parametrize("fresnel_number", [1, 3, 10])
def test_the_fractional_near_field_of_a_mask_comes_near_the_exact_one(opening, fresnel_number):
    """Hard edges have no highest frequency, so that samples lose some of them."""
    far = distance(fresnel_number)
    field, spacing = fractional.fractional_near(opening, WIDTH, far, WAVELENGTH)
    exact = truth(opening, far, spacing)
    assert rms(field, exact) < 0.06
    assert rms(field[:, ::-1], exact) > 0.1


CONVOLUTIONS = [
    convolved.impulse_response,
    convolved.impulse_response_by_axes,
    convolved.transfer_function,
]


@pytest.mark.parametrize("way", CONVOLUTIONS)
@pytest.mark.parametrize("size", [24, 25])
def test_padded_convolutions_are_sums_over_samples(way, size):
    """Σ f h of a random mask, with the impulse response, or with the transfer function's own transform."""
    mask = np.random.default_rng(7).random((size, size), dtype=np.float32)
    far, spacing = distance(0.7), WIDTH / size
    lag = np.arange(size)[:, None] - np.arange(size)
    if way is convolved.transfer_function:
        frequency = np.fft.fftfreq(2 * size, spacing)
        response = np.exp(-1j * np.pi * WAVELENGTH * far * frequency**2)
        line = (response * np.exp(2j * np.pi * lag[..., None] * spacing * frequency)).mean(axis=-1)
    else:
        scale = WAVELENGTH * far
        line = spacing * np.exp(1j * np.pi * (lag * spacing) ** 2 / scale) / np.sqrt(1j * scale)
    wanted = line @ mask @ line.T
    np.testing.assert_allclose(way(mask, WIDTH, far, WAVELENGTH), wanted, atol=3e-6 * np.abs(wanted).max())


def test_convolutions_have_the_errors_that_sampling_gives(opening):
    """The impulse response aliases at short distances and the transfer function at long ones."""
    far, near = distance(0.5), distance(30)
    step = WIDTH / len(opening)
    errors = {
        (way.__name__, z): rms(way(opening, WIDTH, z, WAVELENGTH), truth(opening, z, step))
        for way in CONVOLUTIONS
        for z in (far, near)
    }
    assert errors["impulse_response", far] == pytest.approx(errors["impulse_response_by_axes", far], rel=0.01)
    assert errors["impulse_response", far] < 0.01 < 0.1 < errors["transfer_function", far]
    assert errors["transfer_function", near] < 0.2 < 0.5 < errors["impulse_response", near]


def test_without_a_frame_the_light_comes_round(opening):
    far = distance(2)
    exact = truth(opening, far, WIDTH / len(opening))
    framed, bare = (convolved.impulse_response(opening, WIDTH, far, WAVELENGTH, k) for k in (2, 1))
    assert rms(bare, exact) > 4 * rms(framed, exact)


@pytest.fixture(scope="module")
def tables():
    """The whole bench at 64², as plain values: stages, the whole, rows by table."""
    stages = list(bench.run_near_field(bench.NearFieldBench(size=64, runs=1)))
    values = bench.plain(stages[-1].result)
    return stages, values, {table["name"]: table["rows"] for table in values["tables"]}


def test_every_table_is_measured_and_tells_how_far_it_is(tables):
    stages, values, rows = tables
    assert tuple(rows) == near_field.TASKS
    assert all(table["rows"] and table["notes"] for table in values["tables"])
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1
    assert all(stage.label for stage in stages)
    assert values["settings"] == {"size": 64, "runs": 1, "only": [], "seed": None}


def test_printed_figures_are_the_papers():
    """Quad paper: Table 4."""
    assert near_table.PRINTED_FRACTIONAL_MS == (15.98, 33.01, 128.72, 533.85, 2133.19)
    assert near_table.PRINTED_DISCRETE_MS == (4.87, 20.94, 94.73)
    assert near_table.PRINTED_MS == {
        "box": (0.12, 0.14, 0.28, 7.88, 30.88),
        "circle": (0.11, 0.23, 0.84, 5.43, 41.30),
        "heptagon": (0.14, 0.36, 1.71, 15.78, 137.16),
        "whirl": (0.16, 0.49, 2.93, 23.42, 255.72),
    }


def test_printed_figures_stand_beside_their_own_sizes():
    """The largest size that the paper's discrete way could do is 1024²."""
    assert near_table._printed("whirl", 512) == {
        "printed_ms": 0.49,
        "printed_fractional_ms": 33.01,
        "printed_discrete_ms": 20.94,
    }
    assert near_table._printed("box", 2048) == {"printed_ms": 7.88, "printed_fractional_ms": 533.85}
    assert near_table._printed("box", 64) == {}


def test_table_4_times_every_shape_and_the_discrete_ways(tables):
    rows = tables[2]["table-4"]
    assert [(row["size"], row["aperture"]) for row in rows] == [
        (size, name) for size in (32, 64) for name in shapes.OUTLINES
    ]
    for row in rows:
        assert all(row[f"{key}_ms"] > 0 for key in ("mask", "fractional", "discrete", "framed"))


def test_outlines_that_would_take_too_long_are_left_out():
    """Half the side is a quarter of the time; what was left out once stays out."""
    assert near_table._patient([]) == list(shapes.OUTLINES)
    limit = near_table.OUTLINE_PATIENCE_MS
    rows = [
        {"aperture": "box", "outline_ms": 0.24 * limit},
        {"aperture": "circle", "outline_ms": 0.26 * limit},
        {"aperture": "heptagon"},
        {"aperture": "whirl", "outline_ms": 0.01 * limit},
    ]
    assert near_table._patient(rows) == ["box", "whirl"]


def test_figure_6_loses_a_little_with_each_level(tables):
    rows = tables[2]["figure-6"]
    for number in near_levels.FRESNEL_NUMBERS:
        full, *coarse = (row for row in rows if row["fresnel_number"] == number)
        assert full["finest"] == "full"
        assert full["auto_gain"] == full["quads_gain"] == 1
        quality = [row["psnr"] for row in coarse]
        assert quality == sorted(quality, reverse=True)
        assert [row["quads"] for row in (full, *coarse)] == sorted(
            (row["quads"] for row in (full, *coarse)), reverse=True
        )
        for row in coarse:
            assert row["quads_gain"] == pytest.approx(full["quads_ms"] / row["quads_ms"])


def test_the_shadow_of_figure_6_covers_a_part():
    mask, whole = near_levels.covered(128), shapes.mask("heptagon", 128)
    assert 0.4 < mask.sum() / whole.sum() < 0.9
    assert (mask <= whole).all()
    place = np.add(near_levels.SHADOW, 0.5) * 128
    assert mask[int(place[1]), int(place[0])] == 0


def test_growth_is_the_ratio_of_its_rows(tables):
    first, second, third = tables[2]["growth"]
    assert (first["places"], second["places"], third["places"]) == (64, 128, 256)
    assert second["growth"] == pytest.approx(second["median_ms"] / first["median_ms"])
    assert third["growth"] == pytest.approx(third["median_ms"] / second["median_ms"])


def test_colour_in_one_call_is_the_sum_of_its_wavelengths(tables):
    fields, powers, exact, approximate = tables[2]["colour"]
    assert fields["part"] == exact["gain"] == 1
    assert fields["difference"] == 0
    assert max(powers["difference"], exact["difference"]) < 1e-5
    assert 1e-4 < approximate["difference"] < 0.1
    assert approximate["gain"] == pytest.approx(exact["median_ms"] / approximate["median_ms"])
    assert exact["part"] == pytest.approx(exact["median_ms"] / fields["median_ms"])


def test_libraries_that_are_there_are_measured_and_the_others_are_missed(tables):
    rows, values = tables[2]["peers"], tables[1]
    there = [peer for peer in near_peers.PEERS if importlib.util.find_spec(peer.MODULE) is not None]
    ways = [row["way"] for row in rows]
    assert ways[:3] == [near_peers.OURS, near_peers.CENTRED, near_peers.AMPLITUDE]
    plane = Plane(shapes.mask("box", 16), 1.0, 1e-6)
    assert ways[3:] == [way for peer in there for way in peer.near_ways(plane)]
    notes = next(table["notes"] for table in values["tables"] if table["name"] == "peers")
    for peer in near_peers.PEERS:
        missed = f"{peer.NAME}: not installed: {peer_ways.INSTALL}" in notes
        assert missed == (peer not in there)
    assert not any("fails here" in note for note in notes)


def test_errors_of_the_libraries_are_what_sampling_gives(tables):
    """At 64² only the transfer function holds at these Fresnel numbers, and it is not exact."""
    rows = {row["way"]: row for row in tables[2]["peers"]}
    ours = rows[near_peers.OURS]
    for number in near_peers.FRESNEL_NUMBERS:
        for way in (near_peers.OURS, near_peers.CENTRED, near_peers.AMPLITUDE):
            assert rows[way][f"error_{number}"] < 3e-6
            assert rows[way][f"error_{number}"] <= rows[way][f"largest_{number}"] < 1e-4
        assert 0.01 < rows["SciPy, transfer function"][f"error_{number}"] < 1
        assert rows["SciPy, impulse response"][f"error_{number}"] > 1
        for row in rows.values():
            assert row[f"ratio_{number}"] == pytest.approx(row[f"ms_{number}"] / ours[f"ms_{number}"])


@pytest.mark.parametrize("peer", near_peers.PEERS, ids=lambda peer: peer.NAME)
def test_a_librarys_places_are_the_pixels_middles(peer):
    """A mask that is not symmetric: moved by a pixel or mirrored, the answers are further from the truth."""
    if importlib.util.find_spec(peer.MODULE) is None:
        # Said by the bench as well: there is nothing of it to test.
        return
    mask = shapes.mask("heptagon", 128) * (np.arange(128) < 70) * (np.arange(128) < 62)[:, None]
    plane = Plane(mask.astype(np.float32), near_peers.WIDTH, near_peers.WAVELENGTH)
    far = plane.distance(3.0)
    truth = diffraction.near_power(plane.aperture, plane.grid, far, plane.wavelength, "reference")
    for way, at, _ in peer_ways.working([peer], lambda peer: peer.near_ways(plane), far, []):
        found = at(far)

        def off(picture, truth=truth):
            return float(np.abs(picture - truth)[4:-4, 4:-4].mean() / truth.mean())

        right = off(found)
        wrong = [found.T, *(np.roll(found, s, a) for s in (1, -1) for a in (0, 1))]
        assert right < 0.35, way
        assert all(off(each) > 1.02 * right for each in wrong), way


def test_a_peer_that_fails_is_said_and_the_others_go_on():
    def near_ways(plane):
        raise ImportError("no such backend")

    broken = types.SimpleNamespace(NAME="Broken", MODULE="scipy", PACKAGE="broken", near_ways=near_ways)
    stages = list(near_peers.near_peers(32, 1, [broken, near_peers.peer_scipy]))
    (table,) = stages[-1].result
    assert "Broken: installed, but fails here: ImportError: no such backend" in table.notes
    assert "SciPy, transfer function" in [row["way"] for row in table.rows]


@pytest.mark.parametrize(("size", "middle"), [(8, 0.5), (9, 0.0)])
def test_a_planes_places_are_its_pixels_middles(size, middle):
    plane = Plane(np.ones((size, size), dtype=np.float32), 2.0, 0.5)
    step = 2.0 / size
    np.testing.assert_allclose(plane.grid.axes()[0], (np.arange(size) + 0.5) * step - 1.0, atol=1e-15)
    assert plane.grid.centre == (middle * step, middle * step)
    assert 0.0 in plane.centred.axes()[1]
    assert plane.distance(4.0) == pytest.approx(0.5**2 / (0.5 * 4.0))


def test_tables_fit_a_hundred_columns(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr(near_table, "OUTLINE_PATIENCE_MS", 300)
    assert run(["bench", "near-field", "--size", "256", "--runs", "1", "--only", "table-4"]) == 0
    said = capsys.readouterr()
    lines = said.out.splitlines()
    assert max(len(line) for line in lines) <= 100
    assert "…" not in said.out
    whirl = next(line for line in lines if line.startswith("256²") and "whirl" in line)
    assert {"0.16", "16", "4.9"} <= set(whirl.split())
    assert said.err == ""


def test_a_library_alone_asks_for_the_peers_and_results_are_written_whole(tmp_path, capsys):
    out = tmp_path / "near.json"
    words = ["bench", "near-field", "--only", "scipy", "--size", "32", "--runs", "1", "-o", str(out)]
    assert run(words) == 0
    values = json.loads(out.read_text(encoding="utf-8"))
    assert [table["name"] for table in values["tables"]] == ["peers"]
    assert "not installed" not in out.read_text(encoding="utf-8")
    assert list(tmp_path.iterdir()) == [out]
    assert max(len(line) for line in capsys.readouterr().out.splitlines() if "(1.0x)" in line) <= 100


REFUSED = [
    (["--only", "table-5"], "Did you mean 'table-4'?"),
    (["--size", "100"], "'size' must be a power of two, such as 1024, got 100."),
    (["--size", "16"], "'size' must be an integer >= 32, got 16."),
    (["--runs", "0"], "'runs' must be an integer >= 1, got 0."),
    (["-o", "results.txt"], "'output' must end in .json, got 'results.txt'."),
]


@pytest.mark.parametrize(("words", "text"), REFUSED, ids=[" ".join(words) for words, _ in REFUSED])
def test_bad_input_is_refused_in_one_line_before_work(words, text, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert run(["bench", "near-field", *words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.strip().splitlines()) == 1
    assert text in said.err
    assert not list(tmp_path.iterdir())


def test_help_teaches_by_example(capsys):
    assert run(["bench", "near-field", "--help"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "aureole bench near-field --size 1024" in text
    assert all(name in text for name in near_field.CHOICES)
