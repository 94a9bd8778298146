"""`aureole eye` and `aureole glare --eye`: what they write, what they say, what they refuse."""

import json

import numpy as np
import pytest

from aureole import Picture, glare, light, picture
from aureole.cli import eye_options
from aureole.cli.main import run
from aureole.refuse import Refusal

SMALL = ["--grid", "256", "--field-of-view", "60deg"]
EYE = ["eye", *SMALL, "--size", "64"]


def told(words, capsys):
    assert run([str(word) for word in words]) == 0
    return json.loads(capsys.readouterr().out)


def refused(words, capsys):
    assert run([str(word) for word in words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.strip().splitlines()
    assert len(lines) == 1
    return lines[0]


@pytest.fixture
def night(tmp_path):
    """A dark picture with two lamps, and alpha."""
    pixels = np.full((40, 64, 4), 1e-3, dtype=np.float32)
    pixels[10:12, 20:22, :3] = (400, 200, 100)
    pixels[30, 50, :3] = (100, 200, 900)
    pixels[..., 3] = 0.5
    picture.write(tmp_path / "night.exr", Picture(pixels))
    return tmp_path / "night.exr"


def test_an_eye_writes_what_a_point_of_light_looks_like_to_it(tmp_path, capsys):
    out, png, parts = tmp_path / "psf.exr", tmp_path / "psf.png", tmp_path / "eye.png"
    words = [*EYE, "--luminance", "0.1cd/m2", "--age", "30", "--time", "1.5"]
    found = told([*words, "-o", out, "--preview", png, "--parts", parts, "--json"], capsys)
    state = glare.EyeState.at(1.5, 0.1, eye=glare.eye_named("standard"))
    assert found["degrees_per_pixel"] == pytest.approx(60 / 64)
    assert found["pupil_diameter_m"] == pytest.approx(state.pupil_diameter)
    assert found["pupil_diameter_mm"] == pytest.approx(1e3 * state.pupil_diameter)
    assert found["lid_opening"] == pytest.approx(state.lid_opening)
    assert (found["age"], found["time_s"], found["luminance_cd_per_m2"]) == (30, 1.5, pytest.approx(0.1))
    assert found["files"] == [str(out), str(parts), str(png)]
    psf = picture.read(out)
    assert psf.pixels.shape == (64, 64, 3)
    sums = psf.pixels.sum(axis=(0, 1), dtype=np.float64)
    np.testing.assert_allclose(sums, found["energy_inside"], rtol=2e-3)
    assert 0.8 < found["energy_inside"] <= 1.001
    assert np.unravel_index(psf.pixels[..., 1].argmax(), (64, 64)) == (32, 32)
    said = picture.header_of(psf).attributes
    assert said["aureole:degrees_per_pixel"].value == pytest.approx(60 / 64)
    assert said["aureole:pupil_diameter_m"].value == pytest.approx(state.pupil_diameter)
    for path in (png, parts):
        shown = picture.read(path).pixels
        assert shown.shape[0] > 300
        assert shown.std() > 0.02


def test_older_and_lighter_eyes_scatter_more(tmp_path, capsys):
    """CIE 135: haze grows with age and with less pigment."""
    words = [*EYE, "-o", tmp_path / "psf.exr", "--json", "--no-blink", "--lashes", "0"]
    core = {}
    for age in ("25", "75"):
        for colour in ("black", "light-blue"):
            found = told([*words, "--age", age, "--pigment", colour], capsys)
            core[age, colour] = found["energy_in_core_pixel"]
    assert core["25", "black"] > core["75", "black"] > core["75", "light-blue"]
    assert core["25", "black"] > core["25", "light-blue"] > core["75", "light-blue"]


def test_luminance_sets_the_pupil_and_an_eye_alone_opens_wider(tmp_path, capsys):
    words = [*EYE, "-o", tmp_path / "psf.exr", "--json"]
    dark = told([*words, "--luminance", "0.001cd/m2"], capsys)["pupil_diameter_m"]
    lit = told([*words, "--luminance", "1000 nit"], capsys)["pupil_diameter_m"]
    alone = told([*words, "--luminance", "1000cd/m2", "--one-eye"], capsys)["pupil_diameter_m"]
    assert dark > 6e-3 > 3e-3 > lit
    assert alone > lit
    assert told(words, capsys)["luminance_cd_per_m2"] == 10


def test_one_wavelength_is_grey_and_kinds_of_eyes_differ(tmp_path, capsys):
    out = tmp_path / "psf.exr"
    words = [*EYE, "--grid", "512", "-o", out, "--json", "--luminance", "0.1cd/m2"]
    line = light.illuminant("line:568nm")
    assert told([*words, "--wavelength", "568nm"], capsys)["illuminant"] == line.name
    pixels = picture.read(out).pixels
    np.testing.assert_array_equal(pixels[..., 0], pixels[..., 2])
    assert told([*words, "--preset", "elderly"], capsys)["age"] == 70
    assert told([*words, "--preset", "elderly", "--age", "50"], capsys)["age"] == 50
    kinds = {}
    for name, more in {
        "plain": [],
        "seed": ["--seed", "5"],
        "fibres": ["--fibres", "ritschel-2009"],
        "thesis": ["--combine", "thesis"],
        "tail": ["--no-tail"],
        "perspective": ["--projection", "perspective"],
        "source": ["--source=20deg,-10deg"],
    }.items():
        told([*words, *more], capsys)
        kinds[name] = picture.read(out).pixels
    for name, pixels in kinds.items():
        if name != "plain":
            assert not np.allclose(pixels, kinds["plain"], rtol=1e-4, atol=1e-12), name


def test_an_unsharp_eye_spreads_the_core(tmp_path, capsys):
    out = tmp_path / "psf.exr"
    words = ["eye", "--grid", "256", "--size", "33", "--field-of-view", "1deg", "-o", out, "--json"]
    sharp = told(words, capsys)["energy_in_core_pixel"]
    soft = told([*words, "--defocus", "0.5D"], capsys)["energy_in_core_pixel"]
    coma = told([*words, "--zernike", "coma-x=200nm"], capsys)["energy_in_core_pixel"]
    assert soft < 0.5 * sharp
    assert coma < 0.9 * sharp


def test_frames_are_numbered_kept_and_made_again(tmp_path, capsys):
    out, sheet = tmp_path / "psf.###.exr", tmp_path / "sheet.png"
    words = [*EYE, "--animate", "500ms", "--fps", "8", "-o", out, "--json"]
    words += ["--luminance-from", "0.1cd/m2", "--luminance-to", "1000cd/m2"]
    found = told([*words, "--contact-sheet", sheet], capsys)
    files = [tmp_path / f"psf.{number:03d}.exr" for number in (1, 2, 3, 4)]
    assert found["files"] == [str(path) for path in [*files, sheet]]
    assert (found["frames_made"], found["frames_kept"]) == (4, 0)
    assert [frame["time_s"] for frame in found["frames"]] == [0, 0.125, 0.25, 0.375]
    pupils = [frame["pupil_diameter_m"] for frame in found["frames"]]
    assert pupils[0] - pupils[-1] > 0.3e-3
    assert found["largest_pupil_diameter_m"] == max(pupils)
    assert picture.read(sheet).pixels.shape[1] > 4 * 64
    # A frame that is missing is made again, the same; the others stay as they are.
    before = {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in files}
    files[2].unlink()
    again = told(words, capsys)
    assert [frame["kept"] for frame in again["frames"]] == [True, True, False, True]
    assert again["files"] == [str(files[2])]
    for path in files:
        assert path.read_bytes() == before[path][0]
        assert (path.stat().st_mtime_ns == before[path][1]) == (path != files[2])
    assert [frame["pupil_diameter_m"] for frame in again["frames"]] == pytest.approx(pupils)
    # Frames of another eye are no frames of this job.
    assert "is no frame of this job" in refused([*words, "--age", "60"], capsys)
    some = told([*words, "--age", "60", "--frames", "2-4x2", "--overwrite"], capsys)
    assert [frame["number"] for frame in some["frames"]] == [2, 4]
    assert files[0].read_bytes() == before[files[0]][0] != files[1].read_bytes()


def test_an_eye_sees_a_picture_whose_sum_stays(night, tmp_path, capsys):
    out, psf, png = tmp_path / "seen.exr", tmp_path / "psf.exr", tmp_path / "look.png"
    words = ["glare", night, "-o", out, "--eye", *SMALL, "--json"]
    young = told([*words, "--age", "25", "--psf", psf, "--preview", png], capsys)
    before, after = picture.read(night).pixels, picture.read(out).pixels
    np.testing.assert_allclose(young["sum_after"], young["sum_before"], rtol=1e-4)
    np.testing.assert_allclose(
        after[..., :3].sum(axis=(0, 1), dtype=np.float64), young["sum_after"], rtol=1e-4
    )
    np.testing.assert_array_equal(after[..., 3], before[..., 3])
    assert after[20, 21, 0] > before[20, 21, 0]
    # The kernel is in the picture's pixels: 60 degrees across 64 columns of a flat picture.
    pitch = np.degrees(2 * np.tan(np.radians(30)) / 64)
    assert young["degrees_per_pixel"] == pytest.approx(pitch)
    assert picture.read(psf).pixels.shape[1] == young["kernel_size"][0] == 127
    assert picture.read(png).pixels.shape[0] == 40
    old = told([*words, "--age", "75"], capsys)
    assert picture.read(out).pixels[20, 21, 0] > 1.5 * after[20, 21, 0]
    np.testing.assert_allclose(old["sum_after"], old["sum_before"], rtol=1e-4)


def test_modes_half_resolution_and_an_eye_preset(night, tmp_path, capsys):
    out = tmp_path / "seen.exr"
    words = ["glare", night, "-o", out, "--eye", *SMALL, "--json"]
    kinds = [["--mode", "scatter"], ["--half"], ["--patterns", "2", "--stamps", "1"], ["--preset", "elderly"]]
    for more in kinds:
        found = told([*words, *more], capsys)
        np.testing.assert_allclose(found["sum_after"], found["sum_before"], rtol=1e-3)
    found = told([*words, "--mode", "add", "--threshold", "50", "--gain", "2"], capsys)
    assert min(np.subtract(found["sum_after"], found["sum_before"])) > 0
    assert found["mode"] == "add"


def test_a_picture_through_time_darkens_with_the_lids(night, tmp_path, capsys):
    """A blink of this seed is found from the states themselves."""
    first = _shut_time() - 2 / 24
    out = tmp_path / "seen.####.exr"
    words = ["glare", night, "-o", out, "--eye", *SMALL, "--json"]
    words += ["--time", f"{first}s", "--animate", "250ms"]
    found = told([*words, "--contact-sheet", tmp_path / "sheet.png"], capsys)
    assert len(found["frames"]) == 6
    sums = [picture.read(frame["file"]).pixels[..., :3].sum(dtype=np.float64) for frame in found["frames"]]
    told_sums = [sum(frame["sum_after"]) for frame in found["frames"]]
    np.testing.assert_allclose(sums, told_sums, rtol=1e-4, atol=1e-6)
    opened = [frame["light_let_through"] for frame in found["frames"]]
    assert min(opened) < 1e-3 < 0.9 < max(opened)
    # Each frame is as bright as its lids are open, over lids that do not blink.
    awake = glare.open_share(glare.EyeState.at(first, 10.0, blinking=False))
    shares = np.array(told_sums) / sum(found["sum_before"])
    np.testing.assert_allclose(shares, np.array(opened) / awake, rtol=2e-3, atol=2e-3)
    again = told(words, capsys)
    assert again["frames_kept"] == 6


REFUSALS = [
    (["eye", "-o", "a.exr", "--luminance", "10"], "'luminance' needs a unit (cd/m2 or nit)"),
    (["eye", "-o", "a.exr", "--luminance", "10lux"], "unknown unit 'lux'"),
    (["eye", "-o", "a.exr", "--luminance=-1cd/m2"], ">= 0"),
    (["eye", "-o", "a.exr", "--luminance", "1s:1cd/m2,0s:2cd/m2"], "rising times"),
    (["eye", "-o", "a.exr", "--age", "200"], "'age'"),
    (["eye", "-o", "a.exr", "--pigment", "purple"], "black, brown, green, light-blue"),
    (["eye", "-o", "a.exr", "--fibres", "wool"], "'real', 'ritschel-2009'"),
    (["eye", "-o", "a.exr", "--preset", "elderlyy"], "elderly"),
    (["eye", "-o", "a.exr", "--field-of-view", "200deg"], "at most 180 degrees"),
    (["eye", "-o", "a.exr", "--field-of-view", "180deg", "--projection", "perspective"], "at most 179"),
    (["eye", "-o", "a.exr", "--defocus", "275nm"], "dioptres such as 0.5D"),
    (["eye", "-o", "a.exr", "--time", "5min"], "use s or ms"),
    (["eye", "-o", "a.exr", "--time=-2"], "'time'"),
    (["eye", "-o", "a.exr", "--size", "0"], "'size'"),
    (["eye", "-o", "a.exr", "--quick", "--grid", "512"], "give one of them"),
    (["eye", "-o", "a.exr", "--grid", "513"], "'grid' must be an even number from 64"),
    (["eye", "-o", "a.exr", "--size", "90000"], "see --size and --quick"),
    (["eye", "-o", "a.exr", "--combine", "magic"], "'coherent', 'thesis'"),
    (["eye", "-o", "a.exr", "--source", "10deg"], "two angles"),
    (["eye", "-o", "a.exr", "--fps", "24"], "'fps' needs 'animate'"),
    (["eye", "-o", "a.####.exr"], "--animate 4s makes frames"),
    (["eye", "-o", "a.exr", "--animate", "1s"], "####"),
    (["eye", "-o", "a.##.exr", "--animate", "0s"], "'animate'"),
    (["eye", "-o", "a.##.exr", "--animate", "1s", "--frames", "30"], "from 1 to 24"),
    (["eye", "-o", "a.##.exr", "--animate", "1s", "--preview", "a.png"], "does not go with 'animate'"),
    (["eye", "-o", "a.##.exr", "--animate", "1s", "--luminance-to", "1cd/m2"], "one is missing"),
    (["eye", "-o", "a.xyz"], ".xyz"),
    (["eye", "-o", "none/a.exr"], "no folder"),
    (["glare", "night.exr", "-o", "a.exr", "--eye", "--f-number", "8"], "'f-number' is of cameras"),
    (["glare", "night.exr", "-o", "a.exr", "--eye", "--dust", "10%"], "'dust' is of cameras"),
    (["glare", "night.exr", "-o", "a.exr", "--age", "70"], "needs --eye"),
    (["glare", "night.exr", "-o", "a.exr", "--animate", "1s"], "needs --eye"),
    (["glare", "night.exr", "-o", "a.exr", "--eye", "--photosafe"], "needs --animate"),
    (["glare", "night.exr", "-o", "a.exr", "--eye", "--field-of-view", "180deg"], "at most 179"),
    (["glare", "night.exr", "-o", "a.exr", "--eye", "--memory", "1MB"], "--memory"),
]


@pytest.mark.parametrize(("words", "part"), REFUSALS, ids=lambda value: " ".join(value[1:])[:60])
def test_refusals_are_one_line_and_leave_nothing(words, part, night, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert part in refused(words, capsys)
    assert [path.name for path in tmp_path.iterdir()] == ["night.exr"]


def test_an_eye_in_a_blink_is_refused_and_said(tmp_path, capsys):
    middle = _shut_time()
    out = tmp_path / "psf.exr"
    said = refused([*EYE, "-o", out, "--time", f"{middle}"], capsys)
    assert "--no-blink" in said
    assert not out.exists()
    assert told([*EYE, "-o", out, "--time", f"{middle}", "--no-blink", "--json"], capsys)["lid_opening"] > 0.5


def _shut_time():
    """Return a time at which the standard eye is shut."""
    times = np.arange(0, 5, 1 / 100)
    lids = [state.lid_opening for state in glare.states(times, 10.0)]
    return round(float(times[int(np.argmin(lids))]), 3)


@pytest.mark.parametrize(
    ("text", "value"), [("black", 0.0), ("brown", 0.5), ("green", 1.0), ("light-blue", 1.2), ("0.3", 0.3)]
)
def test_pigment(text, value):
    assert eye_options.pigment(text) == value


@pytest.mark.parametrize(("text", "value"), [("0.5D", 0.5), ("-1.25 D", -1.25), ("2d", 2.0)])
def test_dioptres(text, value):
    assert eye_options.dioptres(text) == value


def test_luminances_that_change():
    assert eye_options.luminances("5cd/m2") == ((0.0, 5.0),)
    assert eye_options.luminances("0s:0.1cd/m2,500ms:2nit") == ((0.0, 0.1), (0.5, 2.0))
    with pytest.raises(Refusal, match="time:luminance"):
        eye_options.luminances("0s:0.1cd/m2,2nit")


def test_eyes_are_among_the_presets(capsys):
    assert {"standard", "ritschel-2009", "elderly"} <= set(told(["presets", "--json"], capsys)["eyes"])
