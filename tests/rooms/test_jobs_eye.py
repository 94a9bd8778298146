"""The eye's jobs: whom they describe, how frames are told apart, what their stages say."""

import dataclasses
import math

import numpy as np
import pytest

from aureole import Picture, glare, jobs
from aureole.jobs.contact_sheet import sheet, tile
from aureole.jobs.eye import description
from aureole.jobs.eye_preview import CONTRAST, degree_ticks, eye_brightness
from aureole.jobs.frames import FramesResult, frame_stages
from aureole.records import Stage
from aureole.refuse import Refusal

QUIET = jobs.Viewer(blinking=False)
SMALL = jobs.EyeJob(QUIET, shape=(48, 64), grid=256)


def scene(rows=24, columns=32):
    pixels = np.full((rows, columns, 3), 0.01, dtype=np.float32)
    pixels[rows // 2, columns // 3] = (300, 200, 100)
    return Picture(pixels)


def test_a_viewer_is_an_eye_of_the_presets_with_changes():
    viewer = jobs.Viewer("elderly", {"seed": 7, "lashes": 0})
    assert viewer.eye() == dataclasses.replace(glare.eye_named("elderly"), seed=7, lashes=0)
    state = viewer.state(1.25)
    assert state == glare.EyeState.at(1.25, 10.0, eye=viewer.eye())
    alone = dataclasses.replace(viewer, binocular=False, adapting_field=math.radians(10)).state(1.25)
    assert alone.pupil_diameter > state.pupil_diameter


def test_luminances_are_joined_by_straight_lines_of_their_logarithm():
    track = jobs.Viewer(luminance=((1.0, 0.1), (3.0, 10.0))).adapting()
    assert [track(t) for t in (0, 1, 2, 3, 9)] == pytest.approx([0.1, 0.1, 1.0, 10.0, 10.0])
    assert jobs.Viewer(luminance=((1.0, 0.0),)).adapting() == 0.0
    with pytest.raises(Refusal, match="rising times"):
        jobs.Viewer(luminance=((1.0, 2.0), (1.0, 3.0))).adapting()


def test_stages_grow_and_end_with_the_point_spread_function():
    stages = list(jobs.run(dataclasses.replace(SMALL, parts=64)))
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1
    result = stages[-1].result
    state = QUIET.state(0.0)
    wanted = glare.eye_psf(state, (48, 64), math.radians(60), size=256)
    np.testing.assert_array_equal(result.picture.pixels, wanted.pixels)
    assert result.state == state
    assert result.report["light_let_through"] == glare.open_share(state)
    assert result.parts.pixels.shape[:2] == (64, 64)


@pytest.mark.parametrize(
    "change",
    [
        {"projection": "flat"},
        {"combine": "sum"},
        {"colour_space": "srgb"},
        {"field_of_view": 0.0},
        {"field_of_view": 4.0},
        {"illuminant": "moon"},
        {"shape": (0, 5)},
        {"time": -1.0},
        {"viewer": jobs.Viewer("nobody")},
        {"viewer": jobs.Viewer(changes={"age": 500.0})},
    ],
    ids=str,
)
def test_jobs_that_cannot_be_served_are_refused(change):
    with pytest.raises(Refusal):
        jobs.finish(jobs.run(dataclasses.replace(SMALL, **change)))


def test_a_description_is_the_same_for_the_same_job_alone():
    words = description(SMALL)
    # The time is said for each frame; drawing parts changes nothing.
    assert description(dataclasses.replace(SMALL, time=3.0, parts=64)) == words
    others = [
        dataclasses.replace(SMALL, viewer=jobs.Viewer()),
        dataclasses.replace(SMALL, viewer=jobs.Viewer(blinking=False, changes={"age": 40.0})),
        dataclasses.replace(SMALL, viewer=jobs.Viewer(blinking=False, luminance=((0.0, 11.0),))),
        dataclasses.replace(SMALL, shape=(64, 48)),
        dataclasses.replace(SMALL, field_of_view=1.0),
        dataclasses.replace(SMALL, illuminant="D65"),
        dataclasses.replace(SMALL, combine="thesis"),
        dataclasses.replace(SMALL, tail=False),
        dataclasses.replace(SMALL, source=(0.1, 0.0)),
        dataclasses.replace(SMALL, grid=1024),
    ]
    assert len({words, description(SMALL, 1), *(description(job) for job in others)}) == len(others) + 2
    # A viewer that says in full what its preset says is the same.
    spelled = dataclasses.replace(QUIET, changes={"age": QUIET.eye().age})
    assert description(dataclasses.replace(SMALL, viewer=spelled)) == words


def test_frames_are_counted_and_timed():
    frames = jobs.Frames(1.0, 24.0)
    assert frames.count() == 24
    assert frames.times(2.0)[::12] == [2.0, 2.5]
    assert jobs.Frames(0.001, 24.0).wanted() == [1]
    assert jobs.Frames(1.0, 10.0, (7, 2, 7)).wanted() == [2, 7]
    with pytest.raises(Refusal, match="from 1 to 10, got 11"):
        jobs.Frames(1.0, 10.0, (11,)).wanted()
    for wrong in (jobs.Frames(0.0), jobs.Frames(1.0, -1.0), jobs.Frames(1e9)):
        with pytest.raises(Refusal):
            wrong.count()


def run_frames(frames, follow=None):
    """Make frames of a single grey each, and return those that came, and the result."""
    made = []

    def make(number):
        made.append(number)
        picture = Picture(np.full((8, 10, 3), number, np.float32))
        yield Stage(0.5, "half")
        yield Stage(1.0, "whole", (picture, {"grey": number}))

    reports = [{"time_s": k / 4} for k in range(4)]
    stages = list(frame_stages(frames, reports, "grey", make, follow))
    came = [stage.result for stage in stages if isinstance(stage.result, jobs.Frame)]
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert isinstance(stages[-1].result, FramesResult)
    return made, came, stages[-1].result


def test_frames_that_are_done_are_not_made_but_for_a_sheet():
    asked = []

    def is_done(number, words):
        asked.append((number, words))
        return number in (1, 3)

    frames = jobs.Frames(1.0, 4.0, is_done=is_done)
    made, came, result = run_frames(frames)
    assert made == [frame.number for frame in came] == [2, 4]
    assert asked == [(n, f"grey, at {(n - 1) / 4:g} s") for n in (1, 2, 3, 4)]
    assert [told["kept"] for told in result.reports] == [True, False, True, False]
    assert [told.get("grey") for told in result.reports] == [None, 2, None, 4]
    assert result.contact_sheet is None
    made, came, result = run_frames(dataclasses.replace(frames, contact_sheet=True))
    assert made == [1, 2, 3, 4]
    assert [frame.done for frame in came] == [True, False, True, False]

    def recall(number):
        return Picture(np.full((8, 10, 3), 10 * number, np.float32))

    made, came, result = run_frames(dataclasses.replace(frames, contact_sheet=True, recall=recall))
    assert made == [2, 4]
    assert sorted(set(result.contact_sheet.pixels.ravel())) == [0, 2, 4, 10, 30]


def test_what_follows_frames_sees_each_in_its_order():
    """It may depend on the frames before, so those that are done are made for it again."""
    seen = []

    def follow(picture):
        seen.append(float(picture.pixels.max()))
        return Picture(picture.pixels / 2)

    def run(*done):
        seen.clear()
        frames = jobs.Frames(1.0, 4.0, is_done=lambda number, words: number in done)
        _, came, _ = run_frames(frames, follow)
        return [(frame.number, float(frame.picture.pixels.max()), frame.done) for frame in came]

    assert run() == [(1, 0.5, False), (2, 1.0, False), (3, 1.5, False), (4, 2.0, False)]
    assert seen == [1, 2, 3, 4]
    # The last frame is done and nobody follows it.
    assert run(1, 4) == [(1, 0.5, True), (2, 1.0, False), (3, 1.5, False)]
    assert run(1, 2, 3, 4) == []


def test_an_animation_is_its_states_one_by_one():
    job = jobs.EyeAnimationJob(SMALL, jobs.Frames(0.25, 8.0, contact_sheet=True))
    frames, result = [], None
    for stage in jobs.run(job):
        result = stage.result
        frames += [result] if isinstance(result, jobs.Frame) else []
    assert [frame.number for frame in frames] == [1, 2]
    for frame, time in zip(frames, (0.0, 0.125), strict=True):
        alone = jobs.finish(jobs.run(dataclasses.replace(SMALL, time=time)))
        np.testing.assert_array_equal(frame.picture.pixels, alone.picture.pixels)
        assert frame.report["pupil_diameter_m"] == alone.report["pupil_diameter_m"]
    assert result.contact_sheet.pixels.shape[0] == 48
    assert result.report["frames_made"] == 2


@pytest.mark.parametrize("shape", [(24, 32), (32, 24), (25, 31)])
def test_a_kernel_is_in_the_pictures_pixels(shape):
    """A flat picture's pixel is 2 tan(half the field) / columns at its centre."""
    field = math.radians(40)
    still = jobs.EyeGlareJob(scene(*shape), dataclasses.replace(SMALL, field_of_view=field))
    result = jobs.finish(jobs.run(still))
    pitch = math.degrees(2 * math.tan(field / 2) / shape[1])
    assert result.report["degrees_per_pixel"] == pytest.approx(pitch, rel=1e-9)
    assert result.psf.pixels.shape[:2] == (2 * shape[0] - 1, 2 * shape[1] - 1)
    np.testing.assert_allclose(result.report["sum_after"], result.report["sum_before"], rtol=1e-5)
    assert result.picture.pixels.shape == (*shape, 3)


def animated(job, **how):
    """Return the frames of an animation, and its result."""
    frames, result = [], None
    for stage in jobs.run(jobs.EyeGlareAnimationJob(job, **how)):
        result = stage.result
        frames += [result] if isinstance(result, jobs.Frame) else []
    return frames, result


def test_flipbooks_show_nearly_what_each_frame_computed_for_itself_shows():
    """Flipbooks add intensities of components at a few states; here glare is compared beyond the lamp."""
    still = jobs.EyeGlareJob(scene(), SMALL, precision="single")
    two = jobs.Frames(0.25, 8.0)
    fresh, _ = animated(still, frames=two)
    quick, result = animated(still, frames=two, real_time=True)
    assert result.report["flipbooks_megabytes"] > 0
    assert result.report["frames_made"] == 2
    dark = still.picture.pixels[..., 1] < 1
    for one, other in zip(fresh, quick, strict=True):
        before, a, b = (p.pixels[dark] for p in (still.picture, one.picture, other.picture))
        assert np.abs(b - a).sum() < 0.35 * (a - before).sum()
        np.testing.assert_allclose(other.report["sum_after"], result.report["sum_before"], rtol=1e-4)


@pytest.mark.parametrize(
    "change",
    [
        {"mode": "scatter"},
        {"patterns": 2},
        {"tint": (1.0, 0.5, 0.5)},
        {"matte": np.ones((24, 32))},
        {"kernel_size": 33},
        {"eye": dataclasses.replace(SMALL, combine="thesis")},
        {"memory": 200_000},
    ],
    ids=lambda change: str([*change]),
)
def test_flipbooks_refuse_what_they_cannot_show(change):
    still = dataclasses.replace(jobs.EyeGlareJob(scene(), SMALL), **change)
    with pytest.raises(Refusal, match=r"real-time|memory"):
        animated(still, frames=jobs.Frames(0.25, 8.0), real_time=True)


def test_frames_that_would_flash_are_held_back():
    """An eye that blinks eight times a second would make a white picture flash."""
    white = Picture(np.ones((24, 32, 3), np.float32))
    still = jobs.EyeGlareJob(white, dataclasses.replace(SMALL, viewer=jobs.Viewer()))
    blinking = Blinks(opened=(1.0, 0.0) * 8)
    flashing = dataclasses.replace(still, eye=dataclasses.replace(still.eye, viewer=blinking))
    plain, _ = animated(flashing, frames=jobs.Frames(1.0, 16.0))
    safe, result = animated(flashing, frames=jobs.Frames(1.0, 16.0), photosafe=True, white=1.0)
    assert glare.flashes([frame.picture.pixels.mean() for frame in plain], 16.0) > 5
    assert glare.flashes([frame.picture.pixels.mean() for frame in safe], 16.0) <= 3
    assert result.report["frames_held_back"] > 0
    with pytest.raises(Refusal, match="'frames' does not go with 'photosafe'"):
        animated(still, frames=jobs.Frames(1.0, 24.0, (1, 5)), photosafe=True)


@dataclasses.dataclass(frozen=True)
class Blinks(jobs.Viewer):
    """A viewer whose lids are told frame by frame."""

    opened: tuple[float, ...] = ()

    def states(self, times):
        found = jobs.Viewer(blinking=False).states(times)
        if not self.blinking:
            return found
        return [dataclasses.replace(s, lid_opening=o) for s, o in zip(found, self.opened, strict=True)]


def test_a_tile_keeps_the_mean_and_a_sheet_the_order():
    rng = np.random.default_rng(1)
    large = rng.random((320, 480, 3), dtype=np.float32)
    small = tile(large)
    assert small.shape == (107, 160, 3)
    assert tile(large[:20, :30]).shape == (20, 30, 3)
    assert small.mean() == pytest.approx(large.mean(), rel=1e-2)
    nine = [np.full((4, 6, 3), k + 1, np.float32) for k in range(9)]
    whole = sheet(nine)
    assert whole.shape == (4 + 4 + 4, 8 * (6 + 4) - 4, 3)
    assert whole[8, 0, 0] == 9
    assert whole[0, 10, 0] == 2


@pytest.mark.parametrize("projection", ["angle", "perspective"])
def test_ticks_stand_where_the_angles_are(projection):
    columns, field = 200, math.radians(60)
    degrees, at = degree_ticks(columns, columns, field, projection)
    assert degrees == [-30, -20, -10, 0, 10, 20, 30]
    assert at[3] == 100
    flat = projection == "perspective"
    for angle, place in zip(degrees, at, strict=True):
        inside = math.tan(math.radians(angle)) / math.tan(field / 2) if flat else angle / 30
        assert place == pytest.approx(100 + 100 * inside)
    degrees, _ = degree_ticks(100, columns, field, projection)
    assert degrees[-1] == 15
    assert len(degree_ticks(columns, columns, math.radians(0.37), projection)[0]) in range(3, 12)


def test_a_preview_shows_each_decade_by_the_same_step():
    rows = np.geomspace(1e-8, 1e-2, 61, dtype=np.float32)
    ramp = np.broadcast_to(rows[:, None, None], (61, 40, 3)).copy()
    shown, low, high = eye_brightness(Picture(ramp))
    assert 0.99e-8 < low < 1e-7 < 1e-3 < high <= 1e-2
    steps = np.diff(shown[5:-5, 0, 1] ** (1 / CONTRAST))
    np.testing.assert_allclose(steps, 1 / (10 * np.log10(high / low)), rtol=1e-2)
    dark, _, _ = eye_brightness(Picture(np.zeros((4, 4, 3), np.float32)))
    assert dark.max() == 0
