"""`aureole nearfield` as a person types it: what it writes, what it keeps, what it says and refuses."""

import json
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from aureole import Grid, Picture, aperture, diffraction, picture
from aureole.cli import near_options
from aureole.cli.main import run
from aureole.jobs import frame_files

WAVELENGTH = 550e-9
SLIT = ["--aperture", "rectangle", "--width", "2mm", "--height", "1mm"]
SMALL = ["--extent", "4mm", "--size", "32x24"]


def told(words, capsys):
    """Run, and return what the command printed for machines, and what it said besides."""
    assert run([str(word) for word in ["nearfield", *words, "--json"]]) == 0
    said = capsys.readouterr()
    return json.loads(said.out), said.err


def refused(words, capsys):
    """Run, and return the one line of the refusal."""
    assert run([str(word) for word in ["nearfield", *words]]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.strip().splitlines()
    assert len(lines) == 1
    return lines[0]


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def power(distance, shape=(24, 32), spacing=1.25e-4, centre=(0.0, 0.0)):
    """The library's irradiance of the slit."""
    grid = Grid(shape, (spacing, spacing), centre)
    return diffraction.near_power(aperture.rectangle(2e-3, 1e-3), grid, distance, WAVELENGTH)


def test_the_file_holds_the_librarys_irradiance(tmp_path, capsys):
    out = tmp_path / "out.exr"
    words = [*SLIT, *SMALL, "--distance", "0.5m", "--wavelength", "550nm", "--centre=-0.2mm,0.5mm"]
    report, _ = told([*words, "-o", out], capsys)
    wanted = power(0.5, centre=(5e-4, -2e-4))
    read = picture.read(out)
    for channel in range(3):
        np.testing.assert_array_equal(read.pixels[..., channel], wanted)
    assert report["files"] == [str(out)]
    assert report["size"] == [32, 24]
    assert report["plane_m"] == pytest.approx([4e-3, 3e-3])
    assert (report["plane_centre_x_m"], report["plane_centre_y_m"]) == pytest.approx((-2e-4, 5e-4))
    assert report["largest_irradiance"] == pytest.approx(wanted.max())
    assert report["mean_irradiance"] == pytest.approx(wanted.mean())
    assert report["fresnel_number"] == pytest.approx(1e-6 / (WAVELENGTH * 0.5))
    attributes = picture.header_of(read).attributes
    assert attributes["aureole:distance_m"].value == pytest.approx(0.5)
    assert "behind opening 'rectangle'" in attributes["ImageDescription"].value
    assert names(tmp_path) == ["out.exr"]


def test_a_quarter_of_the_light_falls_on_a_straight_edges_shadow(tmp_path, capsys):
    out = tmp_path / "edge.exr"
    told(["--aperture", "half-plane", "--distance", "1m", "--size", "201x3", "-o", out], capsys)
    row = picture.read(out).pixels[1, :, 0]
    assert row[100] == pytest.approx(0.25, abs=1e-6)
    assert row.max() == pytest.approx(1.370, abs=2e-3)
    assert np.argmax(row) < 100
    assert np.all(np.diff(row[100:]) < 0)


def test_a_picture_for_people_fits_the_brightest_and_keeps_ratios(tmp_path, capsys):
    out = tmp_path / "out.png"
    report, said = told([*SLIT, *SMALL, "--fresnel-number", "4", "-o", out], capsys)
    wanted = power(report["distance_m"])
    shown = picture.read(out).pixels[..., 1]
    assert "brighter than white" not in said
    assert report["exposure_stops"] == pytest.approx(-np.log2(wanted.max()), abs=1e-3)
    # A step of 8-bit sRGB is at most 0.9 % of white.
    np.testing.assert_allclose(shown, wanted / wanted.max(), atol=5e-3)


def test_light_beyond_white_is_said(tmp_path, capsys):
    words = [*SLIT, *SMALL, "--fresnel-number", "4", "--exposure", "0", "-o", tmp_path / "out.png"]
    report, said = told(words, capsys)
    over = 100 * np.mean(power(report["distance_m"]) > 1)
    assert f"note: 'out.png': {over:.2g} % of its pixels are brighter than white" in said
    assert report["exposure_stops"] == 0


def test_a_preview_goes_beside_the_exr(tmp_path, capsys):
    out, png = tmp_path / "out.exr", tmp_path / "look.png"
    report, _ = told([*SLIT, *SMALL, "--distance", "1m", "-o", out, "--preview", png], capsys)
    assert report["files"] == [str(out), str(png)]
    linear = picture.read(out).pixels
    np.testing.assert_allclose(picture.read(png).pixels, linear / linear.max(), atol=5e-3)


def test_colour_is_neutral_where_nothing_is_in_the_way_and_not_at_fringes(tmp_path, capsys):
    out = tmp_path / "colour.exr"
    words = ["--aperture", "circle", "--width", "2mm", "--obstacle", "--illuminant", "D65"]
    words += ["--distance", "0.1m", "--extent", "20mm", "--size", "65"]
    report, _ = told([*words, "-o", out], capsys)
    pixels = picture.read(out).pixels
    np.testing.assert_allclose(pixels[:4], 1, atol=0.05)
    assert report["illuminant"] == "D65"
    assert "wavelength_m" not in report
    # The spot of Arago is as bright as the free wave at every wavelength.
    np.testing.assert_allclose(pixels[32, 32], 1, atol=0.02)


def test_colour_may_be_approximate(tmp_path, capsys):
    """One pattern, slightly scaled: the middle is nearly grey, and the energy stays."""
    pixels = {}
    for spectral in ("exact", "approximate"):
        out = tmp_path / f"{spectral}.exr"
        words = [*SLIT, "--size", "128", "--illuminant", "E", "--samples", "20", "--fresnel-number", "8"]
        report, _ = told([*words, "--spectral", spectral, "-o", out], capsys)
        assert report["spectral"] == spectral
        pixels[spectral] = picture.read(out).pixels
    np.testing.assert_allclose(pixels["approximate"].mean(), pixels["exact"].mean(), rtol=0.05)
    spread = {name: np.ptp(value[56:72, 56:72], axis=2).mean() for name, value in pixels.items()}
    assert spread["approximate"] < 0.5 * spread["exact"]


def test_the_amplitude_for_numpy(tmp_path, capsys):
    out, npz = tmp_path / "out.exr", tmp_path / "field.npz"
    report, _ = told([*SLIT, *SMALL, "--distance", "0.5m", "-o", out, "--amplitude", npz], capsys)
    assert report["files"] == [str(out), str(npz)]
    with np.load(npz) as held:
        assert held["distance"] == 0.5
        assert held["wavelength"] == pytest.approx(WAVELENGTH)
        grid = Grid((24, 32), (1.25e-4, 1.25e-4))
        y, x = grid.axes()
        np.testing.assert_array_equal(held["x"], x)
        np.testing.assert_array_equal(held["y"], y)
        wanted = diffraction.near_field(aperture.rectangle(2e-3, 1e-3), grid, 0.5, WAVELENGTH)
        np.testing.assert_array_equal(held["amplitude"], wanted.amplitude)
        np.testing.assert_allclose(
            np.abs(held["amplitude"]) ** 2, picture.read(out).pixels[..., 0], atol=1e-6
        )


def test_the_amplitude_as_channels(tmp_path, capsys):
    out, exr = tmp_path / "out.exr", tmp_path / "field.exr"
    told([*SLIT, *SMALL, "--distance", "0.5m", "-o", out, "--amplitude", exr], capsys)
    read = picture.read(exr)
    extra = picture.extra_channels(read)
    total = extra["amplitude.real"] ** 2 + extra["amplitude.imaginary"] ** 2
    np.testing.assert_allclose(total, read.pixels[..., 0], atol=1e-6)
    assert extra["amplitude.real"].dtype == np.float32


SWEEP = [*SLIT, *SMALL, "--sweep", "0.1m:1.6m:5"]


def test_a_sweep_writes_each_plane(tmp_path, capsys):
    report, _ = told([*SWEEP, "-o", tmp_path / "ring.####.exr"], capsys)
    assert names(tmp_path) == [f"ring.{n:04d}.exr" for n in range(1, 6)]
    assert [one["number"] for one in report["frames"]] == [1, 2, 3, 4, 5]
    for one, distance in zip(report["frames"], (0.1, 0.2, 0.4, 0.8, 1.6), strict=True):
        assert one["distance_m"] == pytest.approx(distance)
        assert one["kept"] is False
        pixels = picture.read(one["file"]).pixels
        np.testing.assert_allclose(pixels[..., 0], power(distance), atol=1e-6)
        assert one["largest_irradiance"] == pytest.approx(pixels.max())
    assert report["files"] == [one["file"] for one in report["frames"]]


def test_a_sweep_goes_on_where_it_was_left(tmp_path, capsys):
    pattern = tmp_path / "ring.##.exr"
    told([*SWEEP, "-o", pattern], capsys)
    whole = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    (tmp_path / "ring.02.exr").unlink()
    before = {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    report, _ = told([*SWEEP, "-o", pattern], capsys)
    assert report["planes"] == 1
    assert report["kept"] == 4
    assert report["files"] == [str(tmp_path / "ring.02.exr")]
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == whole
    after = {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert {name: after[name] for name in before} == before
    report, _ = told([*SWEEP, "-o", pattern, "--overwrite"], capsys)
    assert report["kept"] == 0
    assert (tmp_path / "ring.01.exr").stat().st_mtime_ns > before["ring.01.exr"]


# Tests that run in the background of a shell hand on that SIGINT is ignored.
HEEDS_INTERRUPTS = (
    "import runpy, signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "runpy.run_module('aureole.cli', run_name='__main__')"
)


def test_an_interrupted_sweep_leaves_whole_planes(tmp_path):
    words = [sys.executable, "-c", HEEDS_INTERRUPTS, "nearfield", *SLIT, "--size", "256"]
    words += ["--sweep", "0.1m:2m:900", "-o", "r.####.png"]
    with subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as child:
        while child.poll() is None and len(names(tmp_path)) < 3:
            time.sleep(0.02)
        child.send_signal(signal.SIGINT)
        said = child.communicate()[1]
    assert child.returncode == 130
    assert said == "aureole: interrupted; nothing half-written is left.\n"
    found = names(tmp_path)
    assert found == [f"r.{n:04d}.png" for n in range(1, len(found) + 1)]
    assert 2 <= len(found) < 900
    for name in found:
        assert picture.read(tmp_path / name).pixels.shape == (256, 256, 3)


@pytest.mark.parametrize("suffix", ["exr", "png"])
def test_planes_of_another_job_are_neither_kept_nor_replaced(suffix, tmp_path, capsys):
    pattern = tmp_path / f"ring.#.{suffix}"
    told([*SWEEP, "-o", pattern], capsys)
    (tmp_path / f"ring.1.{suffix}").unlink()
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    others = [["--wavelength", "633nm"], ["--centre", "1mm,0mm"], ["--sweep", "0.1m:1.7m:5"]]
    others += [["--exposure", "1"]] if suffix == "png" else []
    for other in others:
        line = refused([*SWEEP, *other, "-o", pattern], capsys)
        assert f"ring.2.{suffix}' is there and is no plane of this job; --overwrite replaces it." in line
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
    damaged = tmp_path / f"ring.2.{suffix}"
    damaged.write_bytes(damaged.read_bytes()[:200])
    assert "is no plane of this job" in refused([*SWEEP, "-o", pattern], capsys)
    told([*SWEEP, "-o", pattern, "--overwrite"], capsys)
    assert picture.read(damaged).pixels.shape == (24, 32, 3)


def test_only_some_planes(tmp_path, capsys):
    report, _ = told([*SWEEP, "--frames", "1-5x2", "-o", tmp_path / "r.#.exr"], capsys)
    assert names(tmp_path) == ["r.1.exr", "r.3.exr", "r.5.exr"]
    assert [one["number"] for one in report["frames"]] == [1, 3, 5]
    np.testing.assert_allclose(picture.read(tmp_path / "r.3.exr").pixels[..., 0], power(0.4), atol=1e-6)


def test_planes_for_people_share_an_exposure(tmp_path, capsys):
    report, _ = told([*SWEEP, "-o", tmp_path / "r.#.png"], capsys)
    for one in report["frames"]:
        shown = picture.read(one["file"]).pixels
        assert shown.max() == pytest.approx(one["largest_irradiance"] / 4, abs=5e-3)


def test_a_sweep_without_a_pattern_is_a_strip(tmp_path, capsys):
    out = tmp_path / "strip.exr"
    report, _ = told([*SWEEP, "-o", out], capsys)
    assert report["files"] == [str(out)]
    assert names(tmp_path) == ["strip.exr"]
    pixels = picture.read(out).pixels
    assert pixels.shape == (24, 5 * 32 + 4 * 4, 3)
    for index, distance in enumerate((0.1, 0.2, 0.4, 0.8, 1.6)):
        tile = pixels[:, index * 36 :][:, :32, 1]
        np.testing.assert_allclose(tile, power(distance), atol=1e-6)
    assert "file" not in report["frames"][0]


def test_a_strip_beside_planes_that_are_kept_has_them_too(tmp_path, capsys):
    pattern, strip = tmp_path / "r.#.exr", tmp_path / "strip.exr"
    told([*SWEEP, "-o", pattern], capsys)
    before = {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    report, _ = told([*SWEEP, "-o", pattern, "--strip", strip], capsys)
    assert report["files"] == [str(strip)]
    assert {path.name: path.stat().st_mtime_ns for path in tmp_path.glob("r.*")} == before
    tile = picture.read(strip).pixels[:, 2 * 36 :][:, :32, 1]
    np.testing.assert_allclose(tile, power(0.4), atol=1e-6)


def test_a_section_needs_no_planes(tmp_path, capsys):
    """The carpet of fringes: along the axis of a circle the light is 4 sin²(πN/2)."""
    out = tmp_path / "axis.exr"
    words = ["--aperture", "circle", "--width", "2mm", "--sweep", "2m:0.1m", "--sweep-by", "fresnel-number"]
    report, _ = told([*words, "--size", "9x41", "--section", out], capsys)
    pixels = picture.read(out).pixels
    assert pixels.shape == (41, 9, 3)
    assert report["distances"] == 41
    assert (report["first_distance_m"], report["last_distance_m"]) == (2.0, 0.1)
    number = np.linspace(report["first_fresnel_number"], report["last_fresnel_number"], 41)
    # The outline as pixels is right to 1e-2 here.
    np.testing.assert_allclose(pixels[:, 4, 0], 4 * np.sin(np.pi * number / 2) ** 2, atol=0.05)
    np.testing.assert_allclose(pixels[:, 1], pixels[:, 7], atol=1e-5)


def test_people_get_a_table(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run([str(w) for w in ["nearfield", *SWEEP, "-o", "r.##.exr"]]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for word in ("first distance", "100 mm", "1.6 m", "first fresnel number", "r.##.exr", "550 nm"):
        assert word in text
    assert "number': 1" not in text


def test_fringes_finer_than_pixels_are_said(tmp_path, capsys):
    words = [*SLIT, "--distance", "5mm", "--size", "16", "-o", tmp_path / "o.exr"]
    report, said = told(words, capsys)
    assert report["finest_fringe_pixels"] == pytest.approx(WAVELENGTH * 5e-3 / 2e-3 / (4e-3 / 16))
    assert "note: the finest fringes are 0.0055 pixels wide" in said


D = ["--distance", "1m"]
BAD = [
    ([], "'distance' and 'fresnel_number' are both missing; give one of them."),
    ([*D, "--fresnel-number", "3"], "both say where the plane is; give one of them."),
    (["--distance", "1"], "'distance' needs a unit (m, cm, mm, um or nm), got 1; write 0.5m."),
    (["--distance", "0m"], "'distance' must be a finite number > 0, got 0."),
    (["--fresnel-number", "0"], "'fresnel_number' must be a finite number > 0, got 0."),
    ([*D, "--extent", "0mm"], "'extent' must be a finite number > 0, got 0."),
    ([*D, "--size", "0"], "'size' must be an integer >= 1, got 0."),
    ([*D, "--size", "big"], "'size' must be pixels such as 512 or 640x480, got 'big'."),
    ([*D, "--centre", "1mm"], "'centre' must be two lengths such as 1mm,0mm, got '1mm'."),
    ([*D, "--centre", "1,2"], "'centre' needs a unit"),
    ([*D, "--wavelength", "550"], "'wavelength' needs a unit (m, cm, mm, um or nm), got 550; write 550nm."),
    ([*D, "--wavelength", "550nm", "--illuminant", "D65"], "both say the light; give one of them."),
    ([*D, "--samples", "9"], "'samples' is for light of many wavelengths; give 'illuminant', too."),
    ([*D, "--illuminant", "E", "--samples", "0"], "'samples' must be an integer >= 1, got 0."),
    ([*D, "--spectral", "quick"], "'spectral' must be one of 'exact', 'approximate', got 'quick'."),
    ([*D, "--method", "rowz"], "Did you mean 'rows'?"),
    ([*D, "--finest", "ninth"], "'finest' must be one of"),
    ([*D, "--cull", "-1"], "cull"),
    ([*D, "--aperture", "heptagon"], "'aperture' must be one of 'iris', 'circle'"),
    ([*D, "--aperture", "circle", "--blades", "5"], "'blades' does not go with aperture 'circle'"),
    ([*D, "--blades", "2"], "'blades' must be an integer >= 3, got 2."),
    ([*D, "--defocus", "1waves", "--obstacle"], "an obstacle has no wavefront"),
    ([*D, "--housing", "1,2"], "'housing' must be 3 numbers parted by commas, got '1,2'."),
    ([*D, "--housing", "0,0,0"], "'housing_diameter' must be a finite number > 0, got 0."),
    ([*D, "--aperture", "half-plane", "--width", "2mm"], "'width' does not go with aperture 'half-plane'"),
    (["--fresnel-number", "1", "--aperture", "half-plane"], "a half plane has no width"),
    ([*D, "--aperture", "half-plain"], "Did you mean 'half-plane'?"),
    ([*D, "--memory", "100KB"], "see --memory and --size."),
    ([*D, "--exposure", "bright"], "'exposure' must be stops such as -1.5, or auto, got 'bright'."),
    ([*D, "--exposure", "nan"], "'exposure' must be a number from -100 to 100, got nan."),
    ([*D, "--exposure", "1000"], "'exposure' must be a number from -100 to 100, got 1000."),
    ([*D, "--amplitude", "f.tif"], "'suffix of the amplitude' must be one of '.npz', '.exr', got '.tif'."),
    ([*D, "--preview", "no/o.png"], "there is no folder"),
    ([*D, "--strip", "s.png"], "'strip' needs 'sweep', such as --sweep 0.05m:2m:48."),
    ([*D, "--section", "s.png"], "'section' needs 'sweep'"),
    ([*D, "--frames", "1-3"], "'frames' needs 'sweep'"),
    ([*D, "--overwrite"], "'overwrite' needs 'sweep'"),
    ([*D, "--sweep", "1m:2m:3"], "'distance' does not go with 'sweep', which says the distances."),
    (["--sweep", "1m:2m"], "'sweep' must say how many planes, such as 0.05m:2m:48."),
    (["--sweep", "1m"], "'sweep' must be the first distance, the last and how many"),
    (["--sweep", "1m:2m:many"], "'sweep' must be the first distance, the last and how many"),
    (["--sweep", "1:2:3"], "'sweep' needs a unit (m, cm, mm, um or nm), got 1; write 0.05m:2m:48."),
    (["--sweep", "0m:2m:3"], "'sweep' must be a finite number > 0, got 0."),
    (["--sweep", "1m:2m:1"], "'planes of the sweep' must be an integer >= 2, got 1."),
    (["--sweep", "1m:1m:3"], "'sweep' must end at another distance than 1 m."),
    (["--sweep", "1m:2m:3", "--sweep-by", "lin"], "'sweep_by' must be one of 'log', 'distance'"),
    ([*D, "--zoom"], "'zoom' needs 'sweep'"),
    (["--sweep", "1m:2m:3", "--size", "5x1", "--section", "s.exr"], "'rows of the section' must be an"),
    (["--sweep", "1m:2m:3", "--preview", "p.png"], "'preview' is for one plane"),
    (["--sweep", "1m:2m:3", "--amplitude", "a.npz"], "'amplitude' is for one plane"),
    (["--sweep", "1m:2m:3", "--strip", "s.png"], "has no #### for the planes' numbers"),
    (["--sweep", "1m:2m:3", "--frames", "2-9"], "'frames' must lie from 1 to 3, got 4."),
    (["--sweep", "1m:2m:3", "--frames", "3-1"], "'frames' must be frames such as 1-100"),
]


@pytest.mark.parametrize(("words", "text"), BAD, ids=[" ".join(words) for words, _ in BAD])
def test_bad_input_is_refused_in_one_line_and_nothing_is_written(words, text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert text in refused([*words, "-o", "out.exr"], capsys)
    assert names(tmp_path) == []


NO_PLACE = [
    (D, "'output' is missing: name the file to write, such as -o near.exr."),
    (["--sweep", "1m:2m:3"], "'sweep' has nothing to write: give -o ring.####.exr"),
    (["--sweep", "1m:2m:3", "-o", "a.#.b.#.exr"], "must have one run of # for the frame's number"),
    (["--sweep", "1m:2m:3", "-o", "a.#.xyz"], "must be one of '.exr'"),
    (["--sweep", "1m:2m:3", "-o", "no/a.#.exr"], "there is no folder 'no'"),
    (["--sweep", "1m:2m:3", "--strip", "s.exr", "--section", "s.exr"], "would be written twice"),
    (["--sweep", "1m:2m:3", "-o", "r.#.exr", "--strip", "r.1.exr"], "would be written twice"),
    ([*D, "-o", "a.exr", "--amplitude", "a.exr"], "would be written twice"),
]


@pytest.mark.parametrize(("words", "text"), NO_PLACE, ids=[" ".join(words) for words, _ in NO_PLACE])
def test_bad_places_are_refused(words, text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert text in refused(words, capsys)
    assert names(tmp_path) == []


def test_help_teaches_by_example(capsys):
    assert run(["nearfield", "--help"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for word in (
        "Examples",
        "--distance",
        "--fresnel-number",
        "--sweep",
        "--section",
        "--dust",
        "--obstacle",
    ):
        assert word in text


def test_numbered_files():
    from pathlib import Path

    assert frame_files.frame(Path("a/ring.####.exr"), 7) == Path("a/ring.0007.exr")
    assert frame_files.frame(Path("r#.png"), 123) == Path("r123.png")
    assert frame_files.is_pattern(Path("a#/b.##.exr"))
    assert not frame_files.is_pattern(Path("a#/b.exr"))
    assert frame_files.numbers("1-9x4, 3,7") == (1, 3, 5, 7, 9)
    assert near_options.place("-1mm, 2um") == (pytest.approx(-1e-3), pytest.approx(2e-6))


def test_every_aperture_of_a_camera_serves(tmp_path, capsys):
    """Light only moves: what dust and vanes leave is what the plane holds."""
    picture.write(tmp_path / "disc.png", Picture(np.ones((8, 8, 3), dtype=np.float32)))
    for words in (
        ["--blades", "9", "--curvature", "0.6", "--rotation", "10"],
        ["--aperture", "circle", "--obstruction", "30%", "--spiders", "4"],
        ["--dust", "20%", "--scratches", "5", "--seed", "3"],
        ["--aperture-picture", tmp_path / "disc.png"],
        ["--blades", "6", "--housing", "0.3,-0.2,1"],
        ["--aperture", "whirl", "--shadow", "0.1,0,0.2"],
    ):
        more = ["--fresnel-number", "20", "--extent", "9mm", "--size", "200", "-o", tmp_path / "o.exr"]
        report, _ = told([*words, *more], capsys)
        assert report["energy_through_plane"] == pytest.approx(1, abs=0.02), words
