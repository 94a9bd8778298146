"""Jobs: descriptions become cameras, stages lead to results, reports tell the truth."""

import numpy as np
import pytest

from aureole import Picture, Refusal, aperture, jobs, picture


def test_a_description_takes_what_it_leaves_out_from_its_preset():
    camera = jobs.Optics(preset="super35-35mm-f8").camera()
    assert camera.focal_length == pytest.approx(35e-3)
    assert camera.f_number == 8
    assert camera.resolution == (3072, 4096)
    assert len(camera.iris.outlines[0].vertices) == 9
    other = jobs.Optics(preset="super35-35mm-f8", f_number=4.0, opening=jobs.Opening(blades=5)).camera()
    assert other.f_number == 4
    assert len(other.iris.outlines[0].vertices) == 5


def test_a_picture_spans_the_sensors_width():
    camera = jobs.Optics().camera(resolution=(100, 720))
    assert camera.pixel_pitch == pytest.approx((50e-6, 50e-6))
    wide = jobs.Optics().camera(resolution=(100, 720), pixel_aspect=2.0)
    assert wide.pixel_pitch == pytest.approx((25e-6, 50e-6))
    given = jobs.Optics().camera(resolution=(100, 720), pixel_pitch=3e-6)
    assert given.pixel_pitch == pytest.approx((3e-6, 3e-6))


@pytest.mark.parametrize(
    ("opening", "name"),
    [
        (jobs.Opening(), "iris of 7 blades"),
        (jobs.Opening(curvature=0.3), "iris of 7 blades"),
        (jobs.Opening(blades=5), "iris of 5 blades"),
        (jobs.Opening(shape="circle"), "circle"),
        (jobs.Opening(shape="whirl", blades=4), "whirl"),
        (jobs.Opening(shape="rectangle", width=2e-3, height=1e-3), "rectangle"),
        (jobs.Opening(shape="circle", obstruction=0.3), "circle, 30 % obstructed"),
    ],
)
def test_openings(opening, name):
    assert opening.build("heptagon").name == name


def test_an_opening_from_a_picture(tmp_path):
    disc = aperture.rasterize(aperture.circle(1.0), 64)
    picture.write(tmp_path / "disc.exr", Picture(np.repeat(disc[..., None], 3, axis=2)))
    built = jobs.Opening(picture=str(tmp_path / "disc.exr")).build("heptagon")
    np.testing.assert_allclose(built.mask, disc, atol=1e-3)
    report = jobs.finish(
        jobs.run(jobs.StarburstJob(jobs.Optics(jobs.Opening(picture=str(tmp_path / "disc.exr"))), (33, 33)))
    ).report
    # 0.125 cycles per pixel of 3.125 mm / 64, at 550 nm.
    assert report["raster_true_to_deg"] == pytest.approx(
        np.degrees(0.125 * 550e-9 / (3.125e-3 / 64)), rel=1e-4
    )


@pytest.mark.parametrize(
    ("opening", "text"),
    [
        (jobs.Opening(shape="heptagon"), "'aperture' must be one of 'iris', 'circle'"),
        (jobs.Opening(shape="rectangle"), "needs 'width' and 'height'"),
        (jobs.Opening(shape="picture"), "needs the file"),
        (
            jobs.Opening(shape="circle", height=1e-3),
            "'height' does not go with aperture 'circle'; it is for rectangle.",
        ),
        (jobs.Opening(obstruction=1.0), "'obstruction' must be a number from 0 to 0.999, got 1."),
    ],
)
def test_openings_that_are_refused(opening, text):
    with pytest.raises(Refusal) as refused:
        opening.build("heptagon")
    assert text in str(refused.value)


def lamp(shape=(40, 60)):
    pixels = np.zeros((*shape, 3), dtype=np.float32)
    pixels[shape[0] // 2, shape[1] // 2] = 100
    return Picture(pixels)


def test_the_glare_jobs_last_stage_is_its_result_and_the_stages_rise():
    job = jobs.GlareJob(lamp(), pixel_pitch=5e-6)
    stages = list(jobs.run(job))
    assert np.all(np.diff([stage.fraction for stage in stages]) >= 0)
    assert stages[-1].fraction == 1
    again = jobs.finish(jobs.run(job))
    np.testing.assert_array_equal(stages[-1].result.picture.pixels, again.picture.pixels)


def test_the_glare_jobs_report_is_what_the_picture_holds():
    result = jobs.finish(jobs.run(jobs.GlareJob(lamp(), pixel_pitch=5e-6, kernel_size=21)))
    np.testing.assert_allclose(result.report["sum_after"], result.picture.pixels.sum(axis=(0, 1)), rtol=1e-5)
    np.testing.assert_allclose(result.report["sum_after"], result.report["sum_before"], rtol=1e-4)
    assert result.psf.pixels.shape == (21, 21, 3)


def test_glare_does_not_depend_on_where_the_data_window_lies(tmp_path):
    """A picture with overscan keeps the camera of its display window."""
    from dataclasses import replace

    whole = lamp((41, 61))
    picture.write(tmp_path / "a.exr", whole)
    read = picture.read(tmp_path / "a.exr")
    header = picture.header_of(read)
    narrow = replace(header, display_window=replace(header.display_window, x=10, width=41))
    inside = Picture(read.pixels, read.colour_space, {**read.metadata, "header": narrow})
    assert jobs.glare.picture_camera(jobs.GlareJob(inside)).pixel_pitch[1] == pytest.approx(36e-3 / 41)


def test_memory_is_refused_before_it_is_taken():
    with pytest.raises(Refusal, match="see --memory and --kernel-size"):
        jobs.finish(jobs.run(jobs.GlareJob(lamp(), kernel_size=20001, memory=10**9)))


def test_what_is_no_job_is_a_programmers_mistake():
    with pytest.raises(TypeError, match="str is not a job"):
        jobs.run("glare")


def test_a_photograph_as_an_aperture_is_told_what_quads_cost(tmp_path):
    noise = np.random.default_rng(4).random((256, 256, 1), dtype=np.float32)
    picture.write(tmp_path / "noise.exr", Picture(np.repeat(noise, 3, axis=2)))
    opening = jobs.Opening(picture=str(tmp_path / "noise.exr"))
    job = jobs.ApertureJob(opening, size=256, quadtree=True)
    result = jobs.finish(jobs.run(job))
    assert result.report["quads"] > 0.9 * 256**2
    assert "quads do not pay here" in result.report["note"]
    assert result.picture.pixels.shape == (1537, 1537, 3)
    assert "note" not in jobs.finish(jobs.run(jobs.ApertureJob(quadtree=True, size=64))).report


def test_a_change_is_drawn_green_where_it_opens_and_red_where_it_covers(tmp_path):
    """A shadow that moves to the right opens on its left and covers on its right."""
    shadows = ((-0.1, 0.0, 0.4), (0.0, 0.0, 0.4))
    before, after = (jobs.Opening(shape="circle", shadow=shadow) for shadow in shadows)
    earlier = jobs.finish(jobs.run(jobs.ApertureJob(before, size=64))).picture
    for name in ("before.exr", "before.png"):
        picture.write(tmp_path / name, earlier)
        job = jobs.ApertureJob(after, size=64, since=str(tmp_path / name))
        result = jobs.finish(jobs.run(job))
        report, pixels = result.report, result.picture.pixels
        assert 0 < report["quads_opened"] + report["quads_covered"] < report["quads"]
        # 24 pixels stand for each of the mask's 64; the opening shines at 0.6 and darkness at 0.02.
        opened, covered, still = (pixels[32 * 24 + 12, column * 24 + 12] for column in (15, 43, 55))
        assert opened[1] > 3 * opened[0]
        assert covered[0] > 3 * covered[1]
        np.testing.assert_allclose(still, 0.6, atol=1e-6)
    unmoved = jobs.ApertureJob(before, size=64, since=str(tmp_path / "before.exr"))
    report = jobs.finish(jobs.run(unmoved)).report
    assert (report["quads_opened"], report["quads_covered"]) == (0, 0)


def test_a_shadow_does_not_move_the_disc_of_a_wavefront():
    whole = jobs.Opening(shape="circle", width=3e-3, defocus=100e-9)
    from dataclasses import replace

    # It covers the rim on the right, and the middle is left.
    shaded = replace(whole, shadow=(0.5, 0.0, 0.6))
    bent, cut = (opening.build("heptagon") for opening in (whole, shaded))
    lit = cut.mask > 0.5
    assert 0.5 < lit.sum() / (bent.mask > 0.5).sum() < 0.9
    np.testing.assert_allclose(cut.wavefront[lit], bent.wavefront[lit], atol=1e-13)


def test_a_quads_outline_is_one_pixel_wide():
    from aureole.diffraction import quadtree
    from aureole.jobs.drawing import NEGATIVE, POSITIVE, quadtree_drawing

    mask = np.array([[1.0, 1.0], [1.0, 0.0]])
    drawing = quadtree_drawing(quadtree(mask, 1.0), mask, 1.0)
    assert drawing.shape == (1537, 1537, 3)
    positive = np.all(drawing == np.float32(POSITIVE), axis=2)
    negative = np.all(drawing == np.float32(NEGATIVE), axis=2)
    # The dark quarter is taken off the whole; its lines lie over those of the whole.
    assert negative.sum() == 4 * 768
    assert (positive | negative).sum() == 4 * 1536 + 2 * 768 - 1
