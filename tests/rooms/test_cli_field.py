"""Flags of what changes over the frame and with the time, as a person types them."""

import json

import numpy as np
import pytest

from aureole import Picture, picture
from aureole.cli.main import run

NIGHT = ["--aperture", "circle", "--f-number", "16", "--pixel-pitch", "20um", "--precision", "single"]
OPENING = ["aperture", "--aperture", "circle", "--width", "2mm", "--size", "64"]


@pytest.fixture
def night(tmp_path):
    """One lamp near the right border."""
    pixels = np.zeros((24, 40, 3), dtype=np.float32)
    pixels[12, 37] = 5.0
    picture.write(tmp_path / "night.exr", Picture(pixels))
    return tmp_path / "night.exr"


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


def mask(path, words, capsys):
    """Return the opening that the flags mean."""
    told([*OPENING, *words, "-o", path], capsys)
    return picture.read(path).pixels[..., 0]


def test_rims_and_places_are_said_by_flags(night, capsys):
    out = night.with_name("out.exr")
    words = ["glare", night, "-o", out, *NIGHT, "--field", "3x1", "--rim", "3.2mm,150mm", "--vignette"]
    found = told(words, capsys)
    assert found["field_places"] == [3, 1]
    assert found["field_kernels"] == 3
    assert 0.4 < found["open_part_least"] < 0.7
    assert 0 < found["field_error_percent"] < 100
    # Light that the rim stops is gone.
    ratio = found["sum_after"][1] / found["sum_before"][1]
    assert found["open_part_least"] * 0.9 < ratio < 1


def test_a_lens_has_rims_by_real_rays_or_near_the_axis(night, capsys):
    """Wide open the Heliar lets 0.73 through at 8 degrees near the axis, 0.80 by real rays."""
    least = {}
    for way in ("traced", "paraxial"):
        words = ["glare", night, "-o", night.with_name(f"{way}.exr"), *NIGHT[:2], "--f-number", "3.5"]
        # So small a lens sees eight degrees on few pixels, none of which is finer than its light.
        words += ["--focal-length", "1.4mm", "--pixel-pitch", "10um", "--kernel-size", "9"]
        words += ["--lens", "heliar_tronnier_100mm", "--lens-rims", way, "--field", "2x1"]
        found = told(words, capsys)
        least[way] = found["open_part_least"]
    assert least["paraxial"] < least["traced"] - 0.03


def test_a_whole_kernel_lights_the_far_corner(night, capsys):
    out = night.with_name("out.exr")
    told(["glare", night, "-o", out, *NIGHT, "--whole-kernel"], capsys)
    assert picture.read(out).pixels[0, 0].min() > 0


def test_lashes_and_lids_are_said_by_flags(tmp_path, capsys):
    out = tmp_path / "opening.exr"
    none, lashes, low = (
        mask(out, words, capsys).mean()
        for words in ([], ["--eyelashes", "8"], ["--eyelashes", "8", "--lid-opening", "0.4"])
    )
    assert none > lashes > low > 0


def test_dirt_drifts_with_the_time(tmp_path, capsys):
    """A drift of a pixel's width (2 mm / 64) a second, over eight seconds."""
    dust = ["--dust", "20%", "--dust-scale", "0.3mm", "--seed", "3", "--dirt-drift", "31.25um,0mm"]
    still, moved = (
        mask(tmp_path / f"{time}.exr", [*dust, "--dirt-time", time], capsys) for time in ("0s", "8s")
    )
    inside = slice(24, 40), slice(24, 40)
    np.testing.assert_allclose(moved[inside], still[24:40, 16:32], atol=2e-3)
    assert np.abs(moved - still).mean() > 0.01


def test_dust_that_changes_has_close_pictures_at_close_times(tmp_path, capsys):
    dust = ["--dust", "20%", "--dust-scale", "0.3mm", "--dust-speed", "1", "--dirt-time"]
    start, near, far = (
        mask(tmp_path / f"{time}.exr", [*dust, time], capsys) for time in ("0s", "0.02s", "0.7s")
    )
    assert 0 < 4 * np.abs(near - start).mean() < np.abs(far - start).mean()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["--field", "5x3"],
            "'field' needs something that changes over the frame: 'lens', 'rim' or 'dirt-distance'.",
        ),
        (
            ["--vignette"],
            "'vignette' needs something that changes over the frame: 'lens', 'rim' or 'dirt-distance'.",
        ),
        (["--rim", "3mm"], "'rim' must be two lengths parted by a comma, such as 0.2mm,0mm, got '3mm'."),
        (["--rim", "30mm,20mm", "--lens-rims", "traced"], "'lens-rims' needs 'lens'."),
        (
            ["--lens", "cooke_triplet_100mm", "--lens-rims", "guessed"],
            "'lens_rims' must be one of 'traced', 'paraxial', got 'guessed'.",
        ),
        (
            ["--whole-kernel", "--kernel-size", "9"],
            "'kernel_size' and 'whole_kernel' both set",
        ),
        (["--dirt-drift", "1mm,0mm"], "'dirt_drift' needs 'dust' or 'scratches'."),
        (["--dust", "10%", "--dirt-time", "1s"], "'dirt_time' needs 'dust_speed' or 'dirt_drift'."),
        (["--lid-opening", "0.5"], "'lid_opening' needs 'eyelashes'."),
    ],
)
def test_flags_that_do_not_fit_are_refused(night, capsys, words, said):
    assert said in refused(["glare", night, "-o", night.with_name("out.exr"), *NIGHT, *words], capsys)
    assert not night.with_name("out.exr").exists()
