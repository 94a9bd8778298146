"""The jobs of diffractive surfaces: stages, measurements, turntables, previews, exports."""

import dataclasses
import math

import numpy as np
import pytest

from aureole import Picture, jobs, picture, surface
from aureole.jobs import surface_preview, surface_scene
from aureole.jobs.surface_render import description
from aureole.refuse import Refusal
from aureole.surface.virtual import gaussian_filter_spectrum, radiance

PERIOD, STEP, SHAPE, CENTRE = 74.27e-6, 2.4e-4, (201, 201), (98.4, 103.7)


@pytest.fixture(scope="module")
def table():
    return surface.table_from_grating("cd", "E", 48)


def still(table, **changes):
    view = surface.view_from((0, 0, 0.2), shape=(12, 16), field_of_view=0.6)
    job = jobs.SurfaceRenderJob(table, surface.Disc(0.12, 0.046), (surface.point_lamp((0, 0.01, 0.2)),), view)
    return dataclasses.replace(job, samples=1, **changes)


def photographs(exposures=(1.0, 8.0, 64.0)):
    """A screen's orders as a camera takes them through a filter 10 nm wide."""
    screen = surface.lcd_screen(PERIOD, 20e-6, 5)
    light_of = gaussian_filter_spectrum(530e-9, 10e-9, 7)
    scene = radiance(screen, light_of, surface.UniformGeometry(STEP), SHAPE, CENTRE)
    return surface.photograph(scene, exposures, surface.VirtualCamera())


def test_a_table_job_ends_with_the_table_and_its_numbers():
    job = jobs.SurfaceTableJob(surface.grating("dvd"), "E", (32, 64), zero_order="remove", normalise=True)
    stages = list(jobs.run(job))
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1
    result = stages[-1].result
    direct = surface.table_from_grating("dvd", "E", (32, 64), zero_order="remove")
    np.testing.assert_array_equal(result.table.values, direct.values)
    assert result.report["size"] == [64, 32]
    assert result.report["albedo_0deg"] == pytest.approx(surface.albedo(direct)[1])
    assert result.notes == ()


def test_a_measurement_finds_centre_and_period_of_what_was_photographed():
    camera = surface.VirtualCamera()
    bracket = jobs.Bracket(photographs(), (1.0, 8.0, 64.0), 530e-9, 10e-9)
    job = jobs.SurfaceMeasureJob(
        (bracket,),
        surface.UniformGeometry(STEP),
        "screen",
        processing={"black": camera.black, "saturation": camera.saturation, "iterations": 3},
        model="amplitude",
        size=64,
        period=PERIOD,
    )
    stages = list(jobs.run(job))
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    result = stages[-1].result
    np.testing.assert_allclose(result.report["centre_row_column"], CENTRE, atol=0.2)
    assert result.report["period_along_t_m"] == pytest.approx(PERIOD, rel=0.01)
    assert result.report["period_along_b_m"] == pytest.approx(PERIOD, rel=0.01)
    assert result.report["h_measured_to"] == pytest.approx(STEP * 104, rel=0.02)
    assert result.table.model == "amplitude"
    assert not [note for note in result.notes if "period" in note]
    wrong = dataclasses.replace(job, period=1.2 * PERIOD)
    assert any("µm" in note for note in jobs.finish(jobs.run(wrong)).notes)


def test_bands_are_one_to_three():
    job = jobs.SurfaceMeasureJob((), surface.UniformGeometry(STEP))
    with pytest.raises(Refusal, match="one to three bands"):
        jobs.finish(jobs.run(job))


def test_a_rendering_is_what_the_renderer_draws(table):
    job = still(table, tilt=0.3, material=surface.Material(diffuse=0.1))
    result = jobs.finish(jobs.run(job))
    pose = surface.pose_of(tilt=0.3)
    scene = surface.Scene(job.lamps, job.view, pose, job.material)
    np.testing.assert_array_equal(result.picture.pixels, surface.render(scene, table, job.shape).pixels)
    assert result.report["coverage"] == pytest.approx(result.picture.pixels[..., 3].mean())
    with pytest.raises(Refusal, match="there is no light"):
        jobs.finish(jobs.run(dataclasses.replace(job, lamps=())))


def test_light_of_lamps_adds_up(table):
    lamps = (surface.point_lamp((0.05, 0, 0.2)), surface.distant_lamp((0.1, 0.3, 1)))
    both, one, other = (
        jobs.finish(jobs.run(still(table, lamps=those))).picture.pixels[..., :3]
        for those in (lamps, lamps[:1], lamps[1:])
    )
    np.testing.assert_allclose(both, one + other, rtol=1e-4, atol=1e-6 * both.max())


def test_turntables_differ_by_all_that_they_show(table):
    job = jobs.SurfaceTurnJob(still(table), jobs.Frames(1.0, 4.0))
    brighter = surface.scatter_table(2 * table.values, table.white)
    others = [
        dataclasses.replace(job, about="spin"),
        dataclasses.replace(job, sweep=1.0),
        dataclasses.replace(job, still=dataclasses.replace(job.still, table=brighter)),
        dataclasses.replace(job, still=dataclasses.replace(job.still, samples=2)),
        dataclasses.replace(
            job, still=dataclasses.replace(job.still, material=surface.Material(diffuse=0.1))
        ),
    ]
    words = {description(one) for one in (job, *others)}
    assert len(words) == 1 + len(others)
    assert description(job) == description(dataclasses.replace(job, still=still(table)))
    frames = [stage.result for stage in jobs.run(job) if isinstance(stage.result, jobs.Frame)]
    assert [frame.report["turn_deg"] for frame in frames] == [0, 90, 180, 270]
    # A disc seen from its edge covers nothing.
    assert frames[1].report["coverage"] < 0.1 * frames[0].report["coverage"]


def test_a_camera_that_no_one_placed_sees_all_of_the_object():
    angle, shape = math.radians(36), (90, 160)
    for body in (surface.Disc(0.12), surface.Plane(0.3, 0.1), surface.Cylinder(0.03, 0.09)):
        away = surface_scene.fitting_distance(body, angle, shape)
        seen = surface.see(body, surface.view_from((0, 0, away), shape=shape, field_of_view=angle)).hit
        assert seen.any(axis=1).mean() > 0.3
        assert not seen[[0, -1]].any()
        assert not seen[:, [0, -1]].any()


def test_presets_have_objects_and_tables_remember_theirs(tmp_path, table):
    assert surface_scene.usual_shape("cd") == ("disc", (0.12, 0.046))
    assert surface_scene.usual_shape("lcd-342ppi")[0] == "plane"
    surface.write_table(tmp_path / "mine.npz", table)
    assert surface_scene.usual_shape(str(tmp_path / "mine.npz")) == ("disc", (0.12, 0.046))
    surface.write_table(tmp_path / "other.npz", surface.scatter_table(table.values, table.white))
    assert surface_scene.usual_shape(str(tmp_path / "other.npz"))[0] == "plane"


def test_a_preview_reaches_as_far_as_the_light():
    values = np.zeros((65, 65, 3))
    values[32, 32] = 1.0
    assert surface_preview.preview_reach(surface.scatter_table(values, (1, 1, 1), warp=1)) <= 0.05
    values[32, 64] = 1e3
    assert surface_preview.preview_reach(surface.scatter_table(values, (1, 1, 1), warp=1)) == 2.0


def test_heights_are_read_in_their_unit(tmp_path):
    picture.write(tmp_path / "h.png", Picture(np.full((4, 6, 3), 0.5, np.float32)), transfer="linear")
    field = jobs.heights_from_file(tmp_path / "h.png", 20e-9, 1e-6)
    assert field.heights.shape == (4, 6)
    np.testing.assert_allclose(field.heights, 0.5e-6, rtol=5e-3)
    np.save(tmp_path / "words.npy", np.array(["a"]))
    for name, said in (("words.npy", "real numbers"), ("lost.npy", "There is no file"), ("lost.pfm", "lost")):
        with pytest.raises(Refusal, match=said):
            jobs.read_plane(tmp_path / name)


def test_a_shader_never_writes_over_the_table_that_it_reads(tmp_path, table):
    surface.write_table(tmp_path / "cd.exr", table)
    asked = jobs.SurfaceExport("glsl", tmp_path / "cd.glsl", still(table), tmp_path / "cd.exr")
    with pytest.raises(Refusal, match="written over"):
        jobs.export(asked)
    told = jobs.export(dataclasses.replace(asked, path=tmp_path / "disc.glsl"))
    assert told["table"] == "disc.exr"
    made = jobs.export(dataclasses.replace(asked, target="gltf", path=tmp_path / "disc.gltf"))
    assert (tmp_path / made["table"]).is_file()
    with pytest.raises(Refusal, match=r"\.html"):
        jobs.export_target(tmp_path / "a.xml", "web")
