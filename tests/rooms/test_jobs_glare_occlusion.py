"""Lights behind things in pictures that were made: whose iris is cropped, and what becomes of their glare."""

import numpy as np
import pytest

from aureole import Picture, Refusal, jobs, picture
from aureole.cli.main import run
from aureole.jobs import glare_occlusion
from aureole.jobs.glare import picture_camera

SHAPE = (48, 64)


def sun(edge=None):
    """A disc of light, whose right side something dark hides."""
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]] + 0.5
    disc = np.clip(9 - np.hypot(x - 32, y - 24) + 0.5, 0, 1)
    if edge is not None:
        disc = disc * np.clip(edge - x + 0.5, 0, 1)
    pixels = np.repeat((0.01 + 100 * disc)[..., None], 3, axis=2).astype(np.float32)
    return Picture(pixels)


def job(source, occlusion=None, **more):
    return jobs.GlareJob(source, kernel_size=31, pixel_pitch=10e-6, occlusion=occlusion, **more)


def lights(source, how):
    return glare_occlusion.occluded_lights(source, picture_camera(job(source)), how)


def test_only_lights_that_are_cropped_get_an_iris_of_their_own():
    how = jobs.GlareOcclusion()
    assert lights(sun(), how) == []
    (found,) = lights(sun(35), how)
    # The edge stands a third of the disc's radius right of its middle, and 0.9 of it is the iris.
    assert 0.6 < found.open_part < 0.85
    mask = found.camera.iris.mask
    assert mask[:, :256].any()
    assert not mask[:, -100:].any()


def test_energy_stays_and_streaks_grow_across_the_edge():
    source = sun(35)
    plain = jobs.finish(jobs.run(job(source))).picture.pixels
    result = jobs.finish(jobs.run(job(source, jobs.GlareOcclusion())))
    seen = result.picture.pixels
    (told,) = result.report["occluded_lights"]
    assert told["iris_open"] < 0.9
    assert seen.min() >= 0
    np.testing.assert_allclose(seen.sum(axis=(0, 1)), plain.sum(axis=(0, 1)), rtol=2e-3)
    # An upright edge throws light to both sides.
    beside = np.s_[22:26, 46:60]
    assert seen[beside].sum() > 1.05 * plain[beside].sum()


def test_a_matte_and_its_distance_say_what_is_hidden(tmp_path):
    matte = np.zeros((*SHAPE, 3), dtype=np.float32)
    matte[:, 32:] = 1
    picture.write(tmp_path / "matte.0007.exr", Picture(matte))
    how = jobs.GlareOcclusion(tmp_path / "matte.####.exr", 0.5)
    (found,) = lights(sun(), how.at(7))
    assert found.open_part == pytest.approx(0.5, abs=0.02)
    # 50 mm at f/16: the iris is 3.125 mm wide, a pixel 0.1 mm at half a metre.
    assert found.radius == pytest.approx(3.125 / 2 / 0.1, rel=0.02)
    with pytest.raises(Refusal, match=r"matte\.0008\.exr"):
        lights(sun(), how.at(8))
    picture.write(tmp_path / "small.exr", Picture(matte[:-1]))
    with pytest.raises(Refusal, match="'occluder' must be 64 x 48 pixels like the picture, got 64 x 47"):
        lights(sun(), jobs.GlareOcclusion(tmp_path / "small.exr"))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--occluder-distance", "1m"], "'occluder-distance' needs --occlusion picture, or --occluder FILE."),
        (["--occlusion", "pictures"], "'occlusion' must be one of 'picture', got 'pictures'."),
        (["--occlusion", "picture", "--mode", "add"], "'occlusion' does not go with mode 'add'"),
        (["--occlusion", "picture", "--occluder", "m.exr"], "both say what crops the iris"),
        (["--occlusion", "picture", "--eye"], "'occlusion' is of cameras"),
    ],
)
def test_flags_that_mean_nothing_are_refused(tmp_path, capsys, words, said):
    picture.write(tmp_path / "in.exr", sun())
    assert run(["glare", str(tmp_path / "in.exr"), "-o", str(tmp_path / "out.exr"), *words]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out.exr").exists()
