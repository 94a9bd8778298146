"""Flags of vanes, dirt and wavefronts, and the report's page, as a person types them."""

import json

import numpy as np
import pytest

from aureole import Picture, aperture, glare, jobs, light, picture
from aureole.cli import pupil_options
from aureole.cli.main import run

CIRCLE = ["--aperture", "circle", "--focal-length", "50mm", "--f-number", "8"]
SMALL = ["--wavelength", "550nm", "--pixel-pitch", "2um", "--size", "65"]


def told(words, capsys):
    """Run, and return what the command printed for machines."""
    assert run([str(word) for word in [*words, "--json"]]) == 0
    return json.loads(capsys.readouterr().out)


def refused(words, capsys):
    """Run, and return the one line of the refusal."""
    assert run([str(word) for word in words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.strip().splitlines()
    assert len(lines) == 1
    return lines[0]


def test_vanes_have_the_breadth_that_the_default_camera_gives_them(tmp_path, capsys):
    """50 mm at f/16 is 3.125 mm wide; a hexagon covers 3√3/8 of its circle's square."""
    out = tmp_path / "vanes.png"
    words = ["aperture", "--blades", "6", "--spiders", "2", "--spider-width", "0.125mm", "-o", out]
    found = told(words, capsys)
    assert found["aperture"] == "iris of 6 blades with 2 vanes"
    # The strip along x reaches from corner to corner but for its own slant ends.
    strip = 0.04 * (1 - 0.02 / np.sqrt(3))
    assert found["open_area_fraction"] == pytest.approx(3 * np.sqrt(3) / 8 - strip, abs=2e-4)


def test_a_shadow_is_placed_in_parts_of_the_openings_width(tmp_path, capsys):
    words = ["aperture", *CIRCLE[:2], "--shadow", "-0.1,0.2,0.5", "-o", tmp_path / "s.png"]
    found = told(words, capsys)
    assert found["open_area_fraction"] == pytest.approx(np.pi / 4 * (1 - 0.25), abs=1e-5)
    dark = picture.read(tmp_path / "s.png").pixels[..., 0] < 0.5
    at = (np.arange(512) + 0.5) / 512 - 0.5
    y, x = np.meshgrid(at, at, indexing="ij")
    inside = dark & (np.hypot(x, y) < 0.49)
    np.testing.assert_allclose((x[inside].mean(), y[inside].mean()), (-0.1, 0.2), atol=1e-3)


def test_a_housing_leaves_a_cats_eye(tmp_path, capsys):
    """Two circles of one size, each through the other's centre, share 2/3 − √3/(2π) of either."""
    words = ["aperture", *CIRCLE[:2], "--housing", "0.5,0,1", "-o", tmp_path / "eye.png"]
    found = told(words, capsys)
    share = 2 / 3 - np.sqrt(3) / (2 * np.pi)
    assert found["open_area_fraction"] == pytest.approx(np.pi / 4 * share, abs=1e-5)
    lit = picture.read(tmp_path / "eye.png").pixels[..., 0] > 0.5
    assert lit[:, 256:].sum() > 0.99 * lit.sum()


def test_a_change_needs_a_picture_of_the_same_size(tmp_path, capsys):
    before = tmp_path / "before.png"
    told(["aperture", "--size", "64", "-o", before], capsys)
    text = refused(["aperture", "--size", "32", "--since", before, "-o", tmp_path / "c.png"], capsys)
    assert text == "aureole: 'since' must be 32 x 32 pixels, got 64 x 64."
    assert not (tmp_path / "c.png").exists()


def test_obstruction_may_be_a_percentage(tmp_path, capsys):
    found = [
        told(["aperture", *CIRCLE[:2], "--obstruction", text, "-o", tmp_path / "o.png"], capsys)
        for text in ("30%", "0.3")
    ]
    assert found[0]["open_area_fraction"] == found[1]["open_area_fraction"]
    assert found[0]["open_area_fraction"] == pytest.approx(np.pi / 4 * 0.91, abs=1e-5)


def test_dust_and_scratches_follow_their_seed(tmp_path, capsys):
    drawn = []
    for seed in ("7", "7", "8"):
        out = tmp_path / "dirt.exr"
        words = ["aperture", "--dust", "20%", "--dust-scale", "0.4mm", "--dust-stretch", "4"]
        words += ["--dust-angle", "30", "--scratches", "9", "--seed", seed, "--size", "128", "-o", out]
        found = told(words, capsys)
        drawn.append(picture.read(out).pixels)
    assert "behind dust behind scratches" in found["aperture"]
    np.testing.assert_array_equal(drawn[0], drawn[1])
    assert np.abs(drawn[0] - drawn[2]).max() > 0.5


def test_an_aperture_with_a_wavefront_is_drawn_beside_it(tmp_path, capsys):
    out = tmp_path / "bent.png"
    words = ["aperture", *CIRCLE[:2], "--zernike", "defocus=50nm", "--zernike", "2,2=0.1waves", "-o", out]
    found = told(words, capsys)
    assert found["wavefront_rms_m"] == pytest.approx(np.hypot(50e-9, 55e-9), rel=3e-3)
    pixels = picture.read(out).pixels
    assert pixels.shape == (512, 2 * 512 + 8, 3)
    right = pixels[:, 520:]
    # Defocus and astigmatism add up along x and nearly cancel along y; blue is below zero.
    assert right[256, 506, 0] > 5 * right[256, 506, 2]
    assert right[256, 256, 2] > 1.4 * right[256, 256, 0]


def test_defocus_darkens_the_starbursts_axis_as_the_closed_form_says(tmp_path, capsys):
    peaks = []
    for more in ([], ["--defocus", "0.5waves"], ["--focus-shift", "0.1408mm"]):
        out = tmp_path / "psf.exr"
        words = ["starburst", *CIRCLE, *SMALL, "--sample", "point", "--fade", "0", *more, "-o", out]
        found = told(words, capsys)
        peaks.append(picture.read(out).pixels[32, 32, 1])
    # 8 N² · 275 nm = 0.1408 mm.
    assert peaks[1] / peaks[0] == pytest.approx(np.sinc(0.5) ** 2, abs=2e-3)
    assert peaks[2] == pytest.approx(peaks[1], rel=1e-4)
    assert found["wavefront_rms_m"] == pytest.approx(275e-9 / np.sqrt(12), rel=3e-3)


def test_glare_sees_the_dirt(tmp_path, capsys):
    pixels = np.zeros((41, 41, 3), dtype=np.float32)
    pixels[20, 20] = 100
    picture.write(tmp_path / "lamp.exr", Picture(pixels))
    after = []
    for more in ([], ["--scratches", "30", "--dust", "10%"]):
        words = ["glare", tmp_path / "lamp.exr", "-o", tmp_path / "o.exr", "--pixel-pitch", "20um", *more]
        told(words, capsys)
        after.append(picture.read(tmp_path / "o.exr").pixels)
    # Dirt scatters: less stays in the lamp's own pixel, energy is kept.
    assert after[1][20, 20, 1] < 0.99 * after[0][20, 20, 1]
    np.testing.assert_allclose(after[1].sum(), after[0].sum(), rtol=1e-4)


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".pdf", ".svg"])
def test_the_report_tells_the_numbers_and_writes_the_page(suffix, tmp_path, capsys):
    out, page = tmp_path / "psf.exr", tmp_path / f"report{suffix}"
    found = told(["starburst", *CIRCLE, *SMALL, "-o", out, "--report", page], capsys)
    assert found["files"] == [str(out), str(page)]
    wavelength, number = 550e-9, 8
    assert found["airy_radius_m"] == pytest.approx(1.2196699 * wavelength * number)
    assert found["cutoff_cycles_per_mm"] == pytest.approx(1e-3 / (wavelength * number))
    assert found["cutoff_sagittal_cycles_per_mm"] == pytest.approx(1e-3 / (wavelength * number), rel=1e-4)
    assert found["strehl"] == 1
    # 2/π (acos s − s √(1 − s²)) is 1/2 at s = 0.4040.
    assert found["mtf50_tangential_cycles_per_mm"] == pytest.approx(0.4040 * 227.27, rel=1e-3)
    # 1 − J0² − J1² is 1/2 at 0.5346 λN.
    assert found["radius_of_50_percent_energy_m"] == pytest.approx(0.5346 * wavelength * number, rel=2e-3)
    begin = {".png": b"\x89PNG", ".jpg": b"\xff\xd8\xff", ".pdf": b"%PDF", ".svg": b"<?xml"}[suffix]
    assert page.read_bytes().startswith(begin)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["psf.exr", page.name]


def test_the_same_job_writes_the_same_page(tmp_path, capsys):
    pages = [tmp_path / name for name in ("a.pdf", "b.pdf")]
    for page in pages:
        told(["starburst", *CIRCLE, *SMALL, "-o", tmp_path / "psf.exr", "--report", page], capsys)
    assert pages[0].read_bytes() == pages[1].read_bytes()


def test_the_report_leaves_matplotlib_as_it_was(tmp_path, capsys):
    import matplotlib

    before, backend = dict(matplotlib.rcParams), matplotlib.rcParams._get("backend")
    told(["starburst", *CIRCLE, *SMALL, "-o", tmp_path / "p.exr", "--report", tmp_path / "r.png"], capsys)
    assert dict(matplotlib.rcParams) == before
    assert matplotlib.rcParams._get("backend") is backend


def test_measures_in_white_light_with_a_wavefront(tmp_path):
    """Maréchal at 550 nm; the page is drawn from both sets of curves."""
    iris = aperture.with_wavefront(aperture.circle(1.0), 128, {"coma-x": 40e-9})
    camera = glare.camera(50e-3, 8.0, iris, resolution=(2000, 3000))
    lamp = light.illuminant("D65")
    measures = jobs.pupil_measures(camera, lamp)
    report = measures.report
    assert report["strehl"] == pytest.approx(np.exp(-((2 * np.pi * 40 / 550) ** 2)), abs=0.01)
    assert report["strehl_in_light"] == pytest.approx(report["strehl"], abs=0.02)
    assert report["strehl_in_light"] != report["strehl"]
    assert report["mtf50_sagittal_cycles_per_mm"] < report["mtf50_tangential_cycles_per_mm"]
    assert np.all(measures.transfer <= measures.transfer_limit + 0.01)
    assert np.all(np.diff(measures.encircled_in_light) > -1e-4)
    assert np.all(measures.encircled <= measures.encircled_limit + 1e-3)
    psf = Picture(np.full((9, 9, 3), 0.01, dtype=np.float32))
    jobs.write_page(tmp_path / "page.svg", psf, camera, measures, "D65")
    text = (tmp_path / "page.svg").read_text()
    assert text.count("<image") == 5  # three pictures and two scales


def test_energy_that_lies_beyond_the_curve_is_none(tmp_path, capsys):
    """A slit one hundredth as broad as long spreads far beyond 256 Airy radii of its length."""
    words = ["starburst", "--aperture", "rectangle", "--width", "3mm", "--height", "6um", *SMALL]
    found = told([*words, "-o", tmp_path / "p.exr", "--report", tmp_path / "r.png"], capsys)
    assert found["radius_of_90_percent_energy_m"] is None


BAD = [
    (["--obstruction", "third"], "'obstruction' must be a part such as 30% or 0.3, got 'third'."),
    (["--obstruction", "130%"], "'obstruction' must be a number from 0 to 0.999, got 1.3."),
    (["--shadow", "0.1,0.2"], "'shadow' must be 3 numbers parted by commas, got '0.1,0.2'."),
    (["--shadow", "0,0,3"], "lets no light through."),
    (["--spiders", "-3"], "'spiders' must be an integer >= 1, got -3."),
    (["--spider-width", "1mm"], "'spider_width' needs 'spiders'."),
    (["--spiders", "3", "--spider-width", "1"], "'spider-width' needs a unit"),
    (["--spiders", "3", "--spider-rotation", "1m"], "'spider-rotation' has an unknown unit 'm'"),
    (["--dust-scale", "1mm"], "'dust_scale' needs 'dust'."),
    (["--dust", "120%"], "'amount' must be a number from 0 to 1, got 1.2."),
    (["--dust", "10%", "--dust-scale", "1um"], "'scale' must be at least two pixels"),
    (["--dust", "10%", "--dust-stretch", "0"], "'stretch' must be a number from 1 to 1000, got 0."),
    (["--scratches", "-1"], "'count' must be an integer >= 0, got -1."),
    (["--seed", "-1", "--scratches", "1"], "'seed' must be an integer >= 0, got -1."),
    (["--defocus", "275"], "'defocus' needs a unit (m, cm, mm, um or nm), got 275; write 275nm or 0.5waves."),
    (["--defocus", "manywaves"], "'defocus' must be a path such as 0.5waves, got 'manywaves'."),
    (["--zernike", "30nm"], "'zernike' must be a term and its RMS, such as 3,1=30nm, got '30nm'."),
    (["--zernike", "3,2=30nm"], "'zernike' (3, 2) does not exist; for n = 3, m is one of -3, -1, 1, 3."),
    (["--zernike", "3=30nm"], "'zernike' must have two orders n,m, such as 3,1=30nm, got '3=30nm'."),
    (["--zernike", "comma-x=30nm"], "Did you mean 'coma-x'?"),
    (["--defocus", "5mm"], "give it more pixels or take a smaller error."),
    (["--method", "scaled", "--defocus", "100nm"], "use method 'exact'."),
    (
        ["--report", "r.doc"],
        "'suffix of the report' must be one of '.png', '.jpg', '.pdf', '.svg', got '.doc'.",
    ),
    (["--report", "no/r.png"], "there is no folder 'no'"),
]


@pytest.mark.parametrize(("words", "text"), BAD, ids=[" ".join(words) for words, _ in BAD])
def test_bad_input_is_refused_in_one_line_and_nothing_is_written(words, text, tmp_path, capsys):
    out = tmp_path / "psf.exr"
    assert text in refused(["starburst", "--size", "9", *words, "-o", out], capsys)
    assert list(tmp_path.iterdir()) == []


def test_a_report_in_the_place_of_another_output_is_refused(tmp_path, capsys):
    same = tmp_path / "p.png"
    words = ["starburst", "-o", tmp_path / "p.exr", "--preview", same, "--report", same]
    assert "would be written twice" in refused(words, capsys)


def test_paths_and_terms_as_typed():
    assert pupil_options.path("0.5waves", "defocus") == pytest.approx(275e-9)
    assert pupil_options.path("-1 wave", "defocus") == pytest.approx(-550e-9)
    assert pupil_options.path("30 nm", "defocus") == pytest.approx(30e-9)
    assert pupil_options.zernike_term("3,-1=30nm") == ((3, -1), pytest.approx(30e-9))
    assert pupil_options.zernike_term("spherical=-0.1waves") == ((4, 0), pytest.approx(-55e-9))
    assert {name: aperture.zernike_pair(name) for name in aperture.ZERNIKE_NAMES} == aperture.ZERNIKE_NAMES


@pytest.mark.parametrize("command", ["glare", "starburst", "aperture"])
def test_help_has_the_flags(command, capsys):
    assert run([command, "--help"]) == 0
    text = capsys.readouterr().out
    for flag in ("--spiders", "--dust-scale", "--scratches", "--seed", "--defocus", "--zernike"):
        assert flag in text
