"""The command line as a person types it: what it writes, what it says, what it refuses."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from scipy.special import j1

from aureole import Picture, picture
from aureole.cli.main import run


@pytest.fixture
def lamps(tmp_path):
    """A small night: dark, with three lamps."""
    pixels = np.full((60, 90, 3), 1e-3, dtype=np.float32)
    pixels[20, 30] = (900, 600, 200)
    pixels[40, 60] = (50, 80, 300)
    pixels[10, 80] = (400, 20, 20)
    path = tmp_path / "night.exr"
    picture.write(path, Picture(pixels))
    return path


def refused(words, capsys):
    """Run, and return the one line of the refusal."""
    assert run([str(word) for word in words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.strip().splitlines()
    assert len(lines) == 1
    return lines[0]


def test_glare_writes_the_picture_and_says_what_it_did(lamps, tmp_path, capsys):
    out, psf, png = tmp_path / "out.exr", tmp_path / "psf.exr", tmp_path / "look.png"
    words = ["glare", lamps, "-o", out, "--focal-length", "50mm", "--f-number", "16", "--blades", "7"]
    assert run([str(w) for w in [*words, "--psf", psf, "--preview", png, "--json"]]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["f_number"] == 16
    assert told["focal_length_m"] == pytest.approx(0.05)
    assert told["files"] == [str(out), str(psf), str(png)]
    before, after = picture.read(lamps).pixels, picture.read(out).pixels
    assert after.shape == before.shape
    assert after[20, 33, 0] > before[20, 33, 0]
    np.testing.assert_allclose(told["sum_after"], after.sum(axis=(0, 1)), rtol=1e-4)
    assert picture.read(png).pixels.shape[0] == 60


def test_what_is_added_round_a_lamp_falls_along_and_between_streaks(tmp_path, capsys):
    pixels = np.zeros((257, 257, 3), dtype=np.float32)
    pixels[128, 128] = 1e4
    picture.write(tmp_path / "lamp.exr", Picture(pixels))
    words = [
        "glare",
        "lamp.exr",
        "-o",
        "out.exr",
        "--f-number",
        "16",
        "--blades",
        "6",
        "--pixel-pitch",
        "8um",
    ]
    assert run([str(tmp_path / w) if w.endswith(".exr") else w for w in words]) == 0
    added = picture.read(tmp_path / "out.exr").pixels[..., 1] - pixels[..., 1]
    # A vertex at +x puts the streaks of six blades at 30, 90, 150 degrees; 0 degrees lies between.
    along, between = added[128 + 8 : 250, 128], added[128, 128 + 8 : 250]
    assert added[128 - 60, 128 - 60 : 128 + 60].min() > 0
    for ray in (along, between):
        smooth = ray[: len(ray) // 10 * 10].reshape(-1, 10).mean(axis=1)
        assert np.all(np.diff(smooth) < 0)
    assert along[40] > 10 * between[40]
    capsys.readouterr()


def test_starburst_of_a_circle_is_the_airy_pattern(tmp_path, capsys):
    out = tmp_path / "airy.exr"
    words = "starburst --aperture circle --focal-length 50mm --f-number 16 --wavelength 550nm"
    words += f" --pixel-pitch 1um --size 512 --sample point --json -o {out}"
    assert run(words.split()) == 0
    told = json.loads(capsys.readouterr().out)
    found = picture.read(out).pixels[..., 1].astype(np.float64)
    x = (np.arange(512) - 256) * 1e-6
    radius = np.hypot(x[:, None], x)
    z = np.pi * radius / (550e-9 * 16)
    airy = np.where(z == 0, 1.0, (2 * j1(z) / np.where(z == 0, 1, z)) ** 2)
    whole = radius < 0.7 * 256e-6
    assert np.abs(found / found.max() - airy)[whole].max() < 1e-4
    # Born and Wolf: 83.8 % of the energy lies within the first dark ring.
    assert found[radius < 1.2197 * 550e-9 * 16].sum() == pytest.approx(0.838, abs=2e-3)
    assert told["energy_inside"] == pytest.approx(found.sum(), rel=1e-4)


@pytest.mark.parametrize("host", ["unreal", "blender", "nuke"])
def test_kernels_for_other_programs_are_nonnegative(host, tmp_path, capsys):
    out = tmp_path / "kernel.exr"
    assert run(["starburst", "--for", host, "--size", "65", "--pixel-pitch", "20um", "-o", str(out)]) == 0
    kernel = picture.read(out).pixels
    assert kernel.min() >= 0
    assert kernel[32, 32].min() == kernel.min(axis=2).max()
    total = kernel.sum(axis=(0, 1))
    np.testing.assert_allclose(total, 1, rtol=1e-4 if host == "nuke" else 0.02)
    capsys.readouterr()


def test_aperture_draws_what_it_says(tmp_path, capsys):
    out = tmp_path / "iris.png"
    assert run(["aperture", "--blades", "6", "--obstruction", "0.3", "-o", str(out), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    # A hexagon covers 3√3/8 of its circle's square, the disc π/4 · 0.09 of it.
    assert told["open_area_fraction"] == pytest.approx(3 * np.sqrt(3) / 8 - np.pi / 4 * 0.09, abs=1e-4)
    assert told["quads"] > 100
    assert picture.read(out, transfer="linear").pixels.shape == (512, 512, 3)


def test_aperture_draws_its_quadtree_in_two_colours(tmp_path, capsys):
    out = tmp_path / "quads.png"
    words = ["aperture", "--quadtree", "--size", "64", "--finest", "half", "-o", str(out), "--json"]
    assert run(words) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["positive_quads"] + told["negative_quads"] == told["quads"]
    pixels = picture.read(out).pixels
    # 32 squares of 48 pixels, and the last line.
    assert pixels.shape == (1537, 1537, 3)
    blue = (pixels[..., 2] > 0.5) & (pixels[..., 0] < 0.1)
    red = (pixels[..., 0] > 0.5) & (pixels[..., 2] < 0.1)
    assert blue.any()
    assert red.any() == (told["negative_quads"] > 0)


def test_aperture_merges_quads(tmp_path, capsys):
    words = ["aperture", "--quadtree", "--size", "64", "-o", str(tmp_path / "quads.png"), "--json"]
    counts = []
    for flags in ([], ["--merge"]):
        assert run(words + flags) == 0
        counts.append(json.loads(capsys.readouterr().out))
    assert "quads_before_merging" not in counts[0]
    assert counts[1]["quads_before_merging"] == counts[0]["quads"] > counts[1]["quads"]
    assert counts[1]["positive_quads"] + counts[1]["negative_quads"] == counts[1]["quads"]


def test_demo_writes_its_files(tmp_path, capsys):
    folder = tmp_path / "new" / "demo"
    assert run(["demo", "--folder", str(folder), "--size", "192x108", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert sorted(p.name for p in folder.iterdir()) == sorted(p.rsplit("/", 1)[1] for p in told["files"])
    # Ghosts are added to a picture with glare, which has the scene's light.
    scene, whole, ghosts = (
        picture.read(folder / f"{name}.exr").pixels for name in ("scene", "flare", "ghosts")
    )
    assert ghosts.sum() > 0.001 * scene.sum()
    np.testing.assert_allclose((whole - ghosts).sum(), scene.sum(), rtol=1e-3)


def test_presets_are_listed(capsys):
    assert run(["presets", "--json"]) == 0
    assert "full-frame-50mm-f16" in json.loads(capsys.readouterr().out)["cameras"]


@pytest.mark.parametrize(
    "command", [[], ["glare"], ["starburst"], ["flare"], ["aperture"], ["demo"], ["presets"]]
)
def test_help_teaches_by_example(command, capsys):
    assert run([*command, "--help"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "aureole" in text
    if command:
        assert "Example" in text


def test_version(capsys):
    import aureole

    assert run(["--version"]) == 0
    assert capsys.readouterr().out.strip() == aureole.__version__


BAD = [
    (["missing.exr"], "There is no file 'missing.exr'."),
    (["--f-number", "0"], "'f-number' must be a finite number > 0, got 0."),
    (["--focal-length", "50"], "'focal-length' needs a unit (m, cm, mm, um or nm), got 50; write 50mm."),
    (["--preset", "full-frame-50mm"], "Did you mean 'full-frame-50mm-f16'?"),
    (["--iris", "heptagn"], "presets/irises has no 'heptagn'. Did you mean 'heptagon'?"),
    (["--mode", "repalce"], "Did you mean 'replace'?"),
    (["--illuminant", "D66"], "Did you mean 'D65'?"),
    (["--blades", "2"], "'blades' must be an integer >= 3, got 2."),
    (["--curvature", "1.5"], "'curvature' must be a number from 0 to 1, got 1.5."),
    (["--rotation", "10m"], "'rotation' has an unknown unit 'm' in 10m; use deg or rad."),
    (["--tint", "1,2"], "'tint' must be 3 numbers parted by commas, got '1,2'."),
    (["--memory", "8"], "'memory' must be an amount with its unit, such as 8GB, got '8'."),
    (["--memory", "100KB"], "see --memory"),
    (["--precision", "half"], "'precision' must be one of 'single', 'double', got 'half'."),
    (["--aperture", "rectangle"], "needs 'width' and 'height'"),
    (["--aperture", "circle", "--blades", "5"], "'blades' does not go with aperture 'circle'"),
    (["--width", "2mm", "--f-number", "8"], "give one of them"),
    (["--kernel-size", "0"], "'kernel_size' must be an integer >= 1, got 0."),
    (["--fnumber", "3"], "No such option: --fnumber"),
]


@pytest.mark.parametrize(("words", "text"), BAD, ids=[" ".join(words) for words, _ in BAD])
def test_bad_input_is_refused_in_one_line_and_nothing_is_written(words, text, lamps, tmp_path, capsys):
    source = [] if words == ["missing.exr"] else [lamps]
    out = tmp_path / "out.exr"
    assert text in refused(["glare", *source, *words, "-o", out], capsys)
    assert sorted(tmp_path.iterdir()) == [lamps]


def test_bad_pictures_are_refused(lamps, tmp_path, capsys):
    whole = lamps.read_bytes()
    (tmp_path / "cut.exr").write_bytes(whole[: len(whole) // 2])
    assert "damaged or cut short" in refused(
        ["glare", tmp_path / "cut.exr", "-o", tmp_path / "o.exr"], capsys
    )
    import OpenImageIO

    nan = np.ones((4, 4, 3), dtype=np.float32)
    nan[1, 2] = np.nan
    buffer = OpenImageIO.ImageBuf(nan)
    buffer.write(str(tmp_path / "nan.exr"))
    line = refused(["glare", tmp_path / "nan.exr", "-o", tmp_path / "o.exr"], capsys)
    assert "NaN" in line
    assert "--nan zero" in line
    assert run(["glare", str(tmp_path / "nan.exr"), "-o", str(tmp_path / "o.exr"), "--nan", "zero"]) == 0
    assert np.isfinite(picture.read(tmp_path / "o.exr").pixels).all()
    capsys.readouterr()


def test_bad_outputs_are_refused_before_any_work(lamps, tmp_path, capsys):
    assert "must be one of '.exr'" in refused(["glare", lamps, "-o", tmp_path / "o.xyz"], capsys)
    assert "there is no folder" in refused(["glare", lamps, "-o", tmp_path / "no" / "o.exr"], capsys)
    assert "written twice" in refused(
        ["glare", lamps, "-o", tmp_path / "o.exr", "--psf", tmp_path / "o.exr"], capsys
    )


def test_a_matte_of_another_size_is_refused(lamps, tmp_path, capsys):
    picture.write(tmp_path / "matte.png", Picture(np.ones((5, 5, 3), dtype=np.float32)))
    words = ["glare", lamps, "-o", tmp_path / "o.exr", "--matte", tmp_path / "matte.png"]
    assert "'matte' must be 90 x 60 pixels like the picture, got 5 x 5." in refused(words, capsys)


def test_exit_code_and_stderr_of_the_real_command(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "aureole.cli", "glare", "no.exr", "-o", "out.exr"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr == "aureole: There is no file 'no.exr'.\n"
    assert done.stdout == ""


TERMINATED = """
import os, signal, sys
from aureole import picture
from aureole.cli.main import main

def read(path, **how):
    with picture.whole_file("half.txt") as part:
        part.write_text("half of")
        os.kill(os.getpid(), signal.SIGTERM)
        raise AssertionError("the signal comes before this line ends")

picture.read = read
main(["glare", "night.exr", "-o", "out.exr"])
"""


def test_a_process_that_is_terminated_leaves_nothing_half_written_and_says_so(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", TERMINATED], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert done.returncode == 143
    assert done.stderr == "aureole: terminated; nothing half-written is left.\n"
    assert not list(tmp_path.iterdir())


def test_kill_9_leaves_either_no_output_or_a_whole_one(lamps, tmp_path):
    words = [sys.executable, "-m", "aureole.cli", "glare", str(lamps), "-o", "out.exr", "--kernel-size", "33"]
    out = tmp_path / "out.exr"
    for delay in (0.5, 1.2, 1.6, 2.0):
        out.unlink(missing_ok=True)
        child = subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(delay)
        os.kill(child.pid, signal.SIGKILL)
        child.wait()
        if out.exists():
            assert picture.read(out).pixels.shape == (60, 90, 3)
