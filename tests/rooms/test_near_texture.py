"""`aureole nearfield --texture` and its job: the library's ringing texture, in files, and what is refused."""

import json

import numpy as np
import pytest

from aureole import Refusal, aperture, jobs, light, picture
from aureole.cli.main import run
from aureole.diffraction import ringing_texture
from aureole.jobs import NearFieldJob, NearTextureJob, Opening

NUMBER = ["--fresnel-number", "30"]
SLIT = ["--aperture", "rectangle", "--width", "2mm", "--height", "1mm", "--size", "24"]
EYE = ["--aperture", "circle", "--width", "2mm", "--housing", "0.5,0,1.1", "--size", "24"]


def told(words, capsys):
    """Run, and return what the command printed for machines."""
    assert run([str(word) for word in ["nearfield", "--texture", *words, "--json"]]) == 0
    return json.loads(capsys.readouterr().out)


def cats_eye():
    return aperture.cats_eye(aperture.circle(2e-3), 1.1 * 2e-3, (0.5 * 2e-3, 0.0))


def test_the_file_holds_the_librarys_texture(tmp_path, capsys):
    out = tmp_path / "ghost.exr"
    report = told([*EYE, *NUMBER, "-o", out], capsys)
    wanted = ringing_texture(cats_eye(), 30.0, 24)
    read = picture.read(out)
    assert read.pixels.shape == (24, 24, 3)
    for channel in range(3):
        np.testing.assert_allclose(read.pixels[..., channel], wanted.pixels, rtol=1e-6, atol=1e-7)
    assert report["files"] == [str(out)]
    assert report["size"] == [24, 24]
    assert report["fresnel_number"] == 30
    assert report["reach"] == report["texture_m"][0] / 2e-3 == 1.5
    assert report["kept"] == pytest.approx(wanted.kept)
    assert report["border"] == pytest.approx(wanted.border)
    assert report["largest_irradiance"] == pytest.approx(wanted.pixels.max())
    attributes = picture.header_of(read).attributes
    for name in ("reach", "fresnel_number", "kept", "border"):
        assert attributes[f"aureole:{name}"].value == pytest.approx(report[name])
    assert attributes["ImageDescription"].value.startswith("ringing texture, Fresnel number 30, behind")


def test_the_file_alone_tells_the_openings_light(tmp_path, capsys):
    """The sum of the texels, each (reach × width / size)², is the share kept of a slit's 2 mm²."""
    out = tmp_path / "ghost.exr"
    told([*SLIT, *NUMBER, "--margin", "40%", "-o", out], capsys)
    read = picture.read(out)
    held = {name: value.value for name, value in picture.header_of(read).attributes.items()}
    assert held["aureole:reach"] == pytest.approx(1.8)
    texel = (held["aureole:reach"] * held["aureole:aperture_width_m"] / 24) ** 2
    through = read.pixels[..., 0].sum(dtype=np.float64) * texel
    assert through == pytest.approx(held["aureole:kept"] * 2e-6, rel=1e-5)


@pytest.mark.parametrize(("text", "reach"), [("0", 1.0), ("10%", 1.2), ("0.5", 2.0)])
def test_margins(text, reach, tmp_path, capsys):
    report = told([*SLIT, *NUMBER, "--margin", text, "-o", tmp_path / "t.exr"], capsys)
    assert report["reach"] == pytest.approx(reach)


def test_colour_is_the_librarys_in_the_lights_white(tmp_path, capsys):
    out = tmp_path / "ghost.exr"
    words = [*EYE, "--fresnel-number", "8", "--illuminant", "D65", "--samples", "6"]
    report = told([*words, "--colour-space", "xyz", "-o", out], capsys)
    lamp = light.illuminant("D65")
    wanted = ringing_texture(cats_eye(), 8.0, 24, spectrum=lamp, samples=6)
    np.testing.assert_allclose(picture.read(out).pixels, wanted.pixels, rtol=1e-4, atol=1e-5)
    assert report["illuminant"] == "D65"
    assert "wavelength_m" not in report
    assert report["kept"] == pytest.approx(wanted.kept)
    assert report["largest_irradiance"] == pytest.approx(wanted.pixels[..., 1].max())


def test_white_light_behind_a_wide_opening_is_white(tmp_path, capsys):
    """At a large Fresnel number the fringes are far narrower than a texel."""
    out = tmp_path / "white.exr"
    words = ["--aperture", "rectangle", "--width", "2mm", "--height", "2mm", "--size", "8"]
    words += ["--fresnel-number", "1e7", "--illuminant", "A", "--samples", "8", "--margin", "0"]
    told([*words, "-o", out], capsys)
    np.testing.assert_allclose(picture.read(out).pixels[1:-1, 1:-1], 1, atol=0.01)


def test_pictures_for_people(tmp_path, capsys):
    png, look = tmp_path / "ghost.png", tmp_path / "look.png"
    report = told([*EYE, *NUMBER, "-o", png, "--preview", look], capsys)
    wanted = ringing_texture(cats_eye(), 30.0, 24).pixels
    assert report["exposure_stops"] == pytest.approx(-np.log2(wanted.max()), abs=1e-3)
    assert report["files"] == [str(png), str(look)]
    for path in (png, look):
        np.testing.assert_allclose(
            picture.read(path).pixels[..., 1], np.clip(wanted / wanted.max(), 0, 1), atol=5e-3
        )


def test_people_get_a_table(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["nearfield", "--texture", *SLIT, *NUMBER, "-o", "t.exr"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for word in ("ringing texture", "fresnel number", "reach", "kept", "3 mm x 3 mm", "t.exr"):
        assert word in text


def test_only_wavefronts_know_the_wavelength(tmp_path, capsys):
    """A Fresnel number says all of a flat wave; a path in metres is more waves of shorter light."""
    pixels = {}
    for name, bent in (("flat", []), ("bent", ["--defocus", "0.5waves"])):
        for wavelength in ("450nm", "650nm"):
            out = tmp_path / f"{name}{wavelength}.exr"
            words = ["--aperture", "circle", "--width", "2mm", "--size", "24", "--wavelength", wavelength]
            told([*words, *NUMBER, *bent, "-o", out], capsys)
            pixels[name, wavelength] = picture.read(out).pixels
    np.testing.assert_allclose(pixels["flat", "450nm"], pixels["flat", "650nm"], atol=1e-4)
    assert np.abs(pixels["bent", "450nm"] - pixels["bent", "650nm"]).max() > 1e-2


def test_the_job_tells_how_far_it_is_and_ends_with_the_result():
    opening = Opening(shape="circle", width=2e-3)
    plane = NearFieldJob(opening, fresnel_number=5.0, illuminant="E", samples=4, shape=(16, 16))
    stages = list(jobs.run(NearTextureJob(plane)))
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1
    assert len({stage.label for stage in stages}) > 4
    assert all(stage.result is None for stage in stages[:-1])
    wanted = ringing_texture(aperture.circle(2e-3), 5.0, 16, spectrum=light.illuminant("E"), samples=4)
    np.testing.assert_array_equal(stages[-1].result.texture.pixels, wanted.pixels)


def test_memory_is_asked_for_all_samples_before_any_work():
    """Fine fringes take 4 × 4 samples a texel, so that 512 texels are 2048 samples."""
    plane = NearFieldJob(fresnel_number=1e7, shape=(512, 512), memory=300_000_000)
    with pytest.raises(Refusal, match="a plane of 2048 x 2048 samples needs about"):
        jobs.finish(jobs.run(NearTextureJob(plane)))


T = ["--texture", *NUMBER]
BAD = [
    (["--texture"], "'texture' needs 'fresnel_number', such as --fresnel-number 30."),
    (["--texture", "--fresnel-number", "0"], "'fresnel_number' must be a finite number > 0, got 0."),
    (["--texture", "--distance", "1m"], "'distance' does not go with 'texture'; give 'fresnel_number'."),
    ([*T, "--distance", "1m"], "'distance' does not go with 'texture'; give 'fresnel_number'."),
    ([*T, "--extent", "4mm"], "'extent' does not go with 'texture'; 'margin' says how wide it is."),
    ([*T, "--centre", "1mm,0mm"], "'centre' does not go with 'texture'; it lies about the axis."),
    ([*T, "--obstacle"], "'obstacle' does not go with 'texture'; it needs an opening."),
    ([*T, "--amplitude", "a.npz"], "'amplitude' does not go with 'texture'; leave it out."),
    ([*T, "--cull", "1e-6"], "'cull' does not go with 'texture'; leave it out."),
    ([*T, "--method", "rows"], "'method' does not go with 'texture'; leave it out."),
    ([*T, "--finest", "half"], "'finest' does not go with 'texture'; leave it out."),
    ([*T, "--spectral", "approximate"], "'spectral' does not go with 'texture'; leave it out."),
    ([*T, "--aperture", "half-plane"], "a half plane has no width and so no texture"),
    ([*T, "--size", "32x24"], "'size' of a texture must be one number, for it is square; got 32x24."),
    ([*T, "--size", "1"], "'size' must be an integer >= 2, got 1."),
    ([*T, "--margin=-10%"], "'margin' must be a number from 0 to 10, got -0.1."),
    ([*T, "--margin", "wide"], "'margin' must be a part such as 30% or 0.3, got 'wide'."),
    ([*T, "--samples", "9"], "'samples' is for light of many wavelengths; give 'illuminant', too."),
    ([*T, "--wavelength", "550nm", "--illuminant", "E"], "both say the light; give one of them."),
    ([*T, "--housing", "5,0,1"], "lets no light through."),
    ([*T, "--memory", "100KB"], "see --memory and --size."),
    ([*T, "--preview", "out.exr"], "would be written twice"),
    ([*T, "--sweep", "1m:2m:3"], "'sweep' does not go with 'texture', which is one picture."),
    ([*T, "--sweep-by", "distance"], "'sweep_by' does not go with 'texture', which is one picture."),
    ([*T, "--zoom"], "'zoom' does not go with 'texture', which is one picture."),
    ([*T, "--section", "s.png"], "'section' does not go with 'texture', which is one picture."),
    ([*NUMBER, "--margin", "10%"], "'margin' needs 'texture'."),
]


@pytest.mark.parametrize(("words", "text"), BAD, ids=[" ".join(words) for words, _ in BAD])
def test_bad_input_is_refused_in_one_line_and_nothing_is_written(words, text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["nearfield", *words, "-o", "out.exr"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.strip().splitlines()
    assert len(lines) == 1
    assert text in lines[0]
    assert list(tmp_path.iterdir()) == []


def test_a_place_is_needed(capsys):
    assert run(["nearfield", "--texture", *NUMBER]) == 2
    assert "'output' is missing" in capsys.readouterr().err


def test_help_teaches_by_example(capsys):
    assert run(["nearfield", "--help"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for word in ("--texture", "--margin", "aureole nearfield --texture --blades 7 --housing"):
        assert word in text
