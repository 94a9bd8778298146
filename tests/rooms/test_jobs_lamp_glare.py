"""Frames of a lamp that passes behind a railing: light, changes, files of scenes, and the command."""

import json
import math

import numpy as np
import pytest

from aureole import Picture, Refusal, aperture, jobs, picture
from aureole.cli.main import run
from aureole.glare.camera import pupil
from aureole.jobs import lamp_glare
from aureole.jobs.scene import scene_at

SCENE = """
columns = 96
rows = 54
frames = 8

[camera]
iris = "heptagon"
focal_length_mm = 85
f_number = 8
sensor_width_mm = 3.6

[[lamps]]
shape = "square"
size_mm = 80
distance_m = 20
path_m = [[1, -0.3, 0.0], [8, 0.3, 0.0]]
radiance = 500

[[occluders]]
name = "railing"
shape = "railing"
distance_m = 0.5
bar_mm = 6
gap_mm = 8

[background]
top = [0.01, 0.02, 0.03]
bottom = [0.03, 0.02, 0.01]
"""
SAMPLES = 3


@pytest.fixture
def scene(tmp_path):
    """Write a scene, with lines of it changed."""

    def written(*changes, name="scene.toml"):
        text = SCENE
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return str(path)

    return written


def frame(file, number, **more):
    return jobs.finish(jobs.run(jobs.LampGlareJob(jobs.read_scene(file), number, samples=SAMPLES, **more)))


def openings(then):
    """The iris as points of the lamp see it, from a few columns; its rows all see alike."""
    lamp, bars = then.lamps[0].light, [each.occluder for each in then.occluders]
    iris = pupil(then.camera)
    half = lamp.shape.width / 2
    for at in (np.arange(15) + 0.5) / 15 * 2 - 1:
        yield aperture.seen_past(iris, bars, (lamp.toward[0] + at * half, lamp.toward[1]), lamp.distance, 256)


def masks(then):
    return [np.zeros((256, 256)) if seen is None else seen.mask.astype(float) for seen in openings(then)]


def test_light_is_visible_area_and_no_frame_jumps(scene):
    path, before = scene(), None
    file = jobs.read_scene(path)
    seen_parts = []
    for number in range(1, 9):
        result = frame(path, number)
        then = scene_at(file, number)
        shares = [mask.sum() for mask in masks(then)]
        whole = aperture.rasterize(pupil(then.camera), 256).sum()
        visible = float(np.mean(shares) / whole)
        unhidden = np.asarray(result.report["lamps"][0]["light_unhidden"])
        light = np.asarray(result.report["lamps"][0]["light"]) / unhidden
        np.testing.assert_allclose(light, visible, atol=0.01)
        if before is not None:
            # Every pixel that is as it was in both parts adds nothing; what is new or gone adds all of it.
            old_visible, old_masks = before
            new = np.mean([np.abs(a - b).sum() for a, b in zip(masks(then), old_masks, strict=True)]) / whole
            assert abs(light.mean() - old_visible) <= new + 0.01
        before = float(light.mean()), masks(then)
        seen_parts.append(visible)
    assert max(seen_parts) > 0.75
    assert min(seen_parts) < 0.5


def test_the_frame_is_background_occluders_and_lamps(scene):
    file = scene(("radiance = 500", "radiance = 0"))
    result = frame(file, 2.5)
    assert not result.layers[0].pixels.any()
    then = scene_at(jobs.read_scene(file), 2.5)
    np.testing.assert_allclose(result.picture.pixels, lamp_glare.seen_past(then, then.background))
    # Bars are soft but darken; black ones leave nothing of their own.
    assert 0.2 < result.picture.pixels.sum() / then.background.pixels.sum() < 0.9


def test_places_go_straight_from_key_to_key(scene):
    file = jobs.read_scene(scene())
    for number, x in ((0, -0.3), (1, -0.3), (4.5, 0.0), (8, 0.3), (20, 0.3)):
        assert scene_at(file, number).lamps[0].light.toward == pytest.approx((x / 20, 0.0))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("bar_mm = 6", "bar_m = 6", "Did you mean 'bar_mm'?"),
        ("gap_mm = 8", "", "'railing' of shape 'railing' needs 'gap_mm'."),
        ("gap_mm = 8", "gap_mm = 8\ndiameter_mm = 3", "'diameter_mm' of 'railing' does not go with shape"),
        ("size_mm = 80", "size_mm = 80\nsize_deg = 1", "must have one of 'size_mm' and 'size_deg', got 2."),
        ("distance_m = 20\n", "", "'size_mm' of 'lamp 1' needs 'distance_m'."),
        ("[8, 0.3, 0.0]]", "[1, 0.3, 0.0]]", "the path of 'lamp 1' must have rising frames"),
        ("radiance = 500", "radiance = -1", "'radiance' in lamps 1 in"),
        ("columns = 96", "columns = 0", "'columns' in"),
    ],
)
def test_scenes_that_mean_nothing_are_refused(scene, old, new, said):
    with pytest.raises(Refusal) as refusal:
        jobs.read_scene(scene((old, new)))
    assert said in str(refusal.value)


def test_a_matte_hides_as_the_outline_that_it_shows(scene, tmp_path):
    pixels = np.zeros((64, 64, 3), dtype=np.float32)
    pixels[:, 32:] = 1
    picture.write(tmp_path / "matte.exr", Picture(pixels))
    bars = 'shape = "railing"\ndistance_m = 0.5\nbar_mm = 6\ngap_mm = 8'
    painted = scene((bars, 'shape = "picture"\ndistance_m = 0.5\nfile = "matte.exr"\nwidth_mm = 400'))
    edge = scene((bars, 'shape = "edge"\ndistance_m = 0.5'), name="edge.toml")
    parts = []
    for file in (painted, edge):
        then = scene_at(jobs.read_scene(file), 4.5)
        shares = [0.0 if seen is None else aperture.energy(seen) for seen in openings(then)]
        parts.append(np.mean(shares) / aperture.energy(pupil(then.camera)))
    assert parts[0] == pytest.approx(parts[1], abs=0.01)
    assert 0.4 < parts[1] < 0.6


def test_the_command_makes_a_frame_and_a_shot_that_it_keeps(scene, tmp_path, capsys):
    file = scene(("radiance = 500", "radiance = 0"))
    words = ["lights", "glare", file, "--samples", "1", "--json", "-o"]
    assert run([*words, str(tmp_path / "one.exr"), "--frame", "3"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["lamps"][0]["openings"] == 1
    assert math.isclose(told["visible"][0], told["lamps"][0]["visible"])
    shot = [*words, str(tmp_path / "a.####.exr"), "--frames", "3-4"]
    sheet = tmp_path / "sheet.png"
    assert run([*shot, "--contact-sheet", str(sheet)]) == 0
    assert json.loads(capsys.readouterr().out)["frames_done"] == 2
    assert picture.read(sheet).pixels.shape == (54, 2 * 96 + 4, 3)
    one, of_shot = (picture.read(tmp_path / name).pixels for name in ("one.exr", "a.0003.exr"))
    np.testing.assert_array_equal(one, of_shot)
    assert run(shot) == 0
    assert json.loads(capsys.readouterr().out)["frames_kept"] == 2
    assert run([*words, str(tmp_path / "one.exr"), "--frames", "3"]) == 2
    assert "'frames' is for shots; OUT needs ####" in capsys.readouterr().err


def test_glare_that_would_not_fit_is_refused(scene):
    with pytest.raises(Refusal, match=r"glare that reaches over \d+ x \d+ pixels on 96 x 54 pixels needs"):
        frame(scene(), 1, memory=10**6)
