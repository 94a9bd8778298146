"""The eye's state through time: lens, vitreous, lids and adaptation; presets and refusals."""

import math
import re
from dataclasses import fields, replace

import numpy as np
import pytest

from aureole import glare, presets, refuse
from aureole.glare.eye_adaptation import BRIGHTER, DARKER, DARKEST, adapted, adapted_after
from aureole.glare.eye_lids import CLOSED, CLOSING, LEAST_GAP, OPENING, blink, blinks, squint
from aureole.glare.eye_motion import (
    DAMPING,
    HEAD_HERTZ,
    HEAD_TREMOR,
    STIFFNESS,
    accommodation,
    lens_stretch,
    vitreous_angle,
)
from aureole.glare.eye_noise import log_normal_noise

HOUR = 3600.0
# Of seed 11 at 12.5 s and 0.5 cd/m²: metres, dioptres, radians; its first blink, seconds.
PUPIL, DIOPTRES, ANGLE, BLINK = 0.0051469735649, -0.049534383392, 0.0088373975114, 1.0201267130344
RATE = 8.0
TIMES = np.arange(4096) / RATE


def spectrum(series):
    power = np.abs(np.fft.rfft((series - series.mean()) * np.hanning(len(series)))) ** 2
    return np.fft.rfftfreq(len(series), 1 / RATE), power / power.sum()


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


# The lens.


@pytest.mark.parametrize("seed", [1, 2])
def test_accommodation_is_slow_noise_and_a_small_fast_part(seed):
    series = np.array([accommodation(time, 5e-3, 30, seed) for time in TIMES])
    frequencies, power = spectrum(series)
    slow = power[frequencies < 0.61].sum()
    fast = power[(frequencies > 1.29) & (frequencies < 2.11)].sum()
    assert slow + fast > 0.9999
    # 0.1 and 0.03 dioptres: nine parts in a hundred.
    assert fast / slow == pytest.approx(0.09, abs=0.02)
    assert series.std() == pytest.approx(math.hypot(0.1, 0.03), rel=0.1)
    # Noise-like: no narrow line holds much of it.
    assert power.max() < 0.1


def test_the_slow_part_grows_with_the_pupil_and_the_fast_one_does_not():
    small, wide = (np.array([accommodation(t, d, 30, 1) for t in TIMES]) for d in (3e-3, 6e-3))
    frequencies, _ = spectrum(small)
    parts = [np.abs(np.fft.rfft(series * np.hanning(len(series)))) ** 2 for series in (small, wide)]
    slow, fast = frequencies < 0.61, (frequencies > 1.35) & (frequencies < 2.05)
    assert parts[1][slow].sum() / parts[0][slow].sum() == pytest.approx(4, rel=0.01)
    assert parts[1][fast].sum() / parts[0][fast].sum() == pytest.approx(1, rel=0.01)


def test_old_lenses_rest():
    young, thirty, old, oldest = (accommodation(2.0, 5e-3, age, 1) for age in (10, 30, 50, 90))
    assert young == thirty
    assert old == pytest.approx(thirty * 3.5 / 9.5)
    assert oldest == pytest.approx(thirty * 0.1)


def test_a_lens_that_focuses_nearer_is_narrower():
    assert lens_stretch(0.0) == 0
    assert lens_stretch(1.0) == pytest.approx(-0.067 / 9.33, rel=0.01)
    state = glare.EyeState.at(4.0, 1.0)
    assert state.lens_stretch == lens_stretch(state.accommodation)


# The vitreous.


def test_a_head_that_turned_leaves_the_vitreous_behind_and_it_swings_back():
    # Against the head it starts at -0.2 with the speed 2ζω · 0.2 that the damper's jolt gives.
    turned = 0.2
    damped = math.sqrt(1 - DAMPING**2)
    for later in (0.05, 0.3, 0.7, 1.5, 4.0):
        turns = STIFFNESS * damped * later
        swing = math.cos(turns) - DAMPING / damped * math.sin(turns)
        expected = -turned * math.exp(-DAMPING * STIFFNESS * later) * swing
        found = vitreous_angle(20 + later, 1, lambda time: turned if time >= 20 else 0.0)
        # The jump falls between two lags, 22.5 ms apart.
        assert found == pytest.approx(expected, abs=turned * STIFFNESS * 0.0225)


def test_the_vitreous_obeys_its_equation_of_motion():
    def head(time):
        return 0.3 * math.sin(2.1 * time) + 0.1 * math.cos(5.3 * time + 1)

    step = 0.02
    for time in (12.0, 13.7):
        earlier, now, later = (vitreous_angle(time + k * step, 1, head) for k in (-1, 0, 1))
        speed, acceleration = (later - earlier) / (2 * step), (later - 2 * now + earlier) / step**2
        left = acceleration + 2 * DAMPING * STIFFNESS * speed + STIFFNESS**2 * now
        turning = -(0.3 * 2.1**2 * math.sin(2.1 * time) + 0.1 * 5.3**2 * math.cos(5.3 * time + 1))
        assert left == pytest.approx(-turning, abs=0.02)


def test_a_still_head_leaves_it_at_rest_and_a_steady_turn_takes_it_along():
    assert vitreous_angle(5.0, 1, lambda time: 0.7) == 0
    # The swing is followed for nine seconds only.
    assert vitreous_angle(30.0, 1, lambda time: 0.5 * time) == pytest.approx(0, abs=1e-5)


def test_the_small_motion_is_the_answer_to_a_small_motion_of_the_head():
    noise = log_normal_noise(3, "head", *HEAD_HERTZ)

    def head(time):
        return HEAD_TREMOR * noise.at(time)

    for time in (10.0, 33.3):
        assert vitreous_angle(time, 3) == pytest.approx(vitreous_angle(time, 3, head), abs=HEAD_TREMOR * 1e-3)
    series = np.array([vitreous_angle(time, 3) for time in TIMES])
    assert math.radians(0.3) < series.std() < math.radians(3)


def test_the_head_is_asked_only_about_times_that_have_been():
    asked = []
    vitreous_angle(4.0, 1, lambda time: asked.append(time) or 0.0)
    assert (min(asked), max(asked)) == (0.0, 4.0)


# The lids.


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_blinks_are_fast_irregular_and_never_overlap(seed):
    found = blinks(0, HOUR, seed)
    # 10 to 20 a minute at rest; Bentivoglio et al. 1997 find 17.
    assert 13 < len(found) / (HOUR / 60) < 17
    durations = np.diff(found, axis=1)
    for part, (low, high) in zip(durations.T, (CLOSING, CLOSED, OPENING), strict=True):
        assert low - 1e-9 <= part.min() < low + 0.1 * (high - low)
        assert high - 0.1 * (high - low) < part.max() <= high + 1e-9
    gaps = found[1:, 0] - found[:-1, 3]
    assert gaps.min() >= LEAST_GAP - 1e-9
    assert gaps.mean() == pytest.approx(3.7, abs=0.4)
    assert 0.5 < gaps.std() / gaps.mean() < 1.1
    # One does not tell the next.
    assert abs(np.corrcoef(gaps[1:], gaps[:-1])[0, 1]) < 0.12


def test_an_interval_holds_the_blinks_that_touch_it():
    whole = blinks(0, 600, 5)
    begins, ends = whole[20, 0], whole[24, 3]
    assert np.array_equal(blinks(begins, ends, 5), whole[20:25])
    assert np.array_equal(blinks(ends, whole[25, 0], 5), np.empty((0, 4)))


def test_lids_close_wholly_and_move_without_jumps():
    times = np.arange(0, 130, 1 / 240)
    opening = np.array([blink(time, 1) for time in times])
    assert opening.min() == 0
    assert opening.max() == 1
    assert np.abs(np.diff(opening)).max() <= 1.5 / CLOSING[0] / 240 + 1e-12
    for begins, closed, opens, ends in blinks(0, 130, 1):
        assert blink(begins, 1) == 1
        assert blink((begins + closed) / 2, 1) == pytest.approx(0.5)
        assert blink((closed + opens) / 2, 1) == 0
        assert blink((opens + ends) / 2, 1) == pytest.approx(0.5)
        assert blink(ends, 1) == 1


def test_a_state_blinks_only_where_asked():
    middle = float(blinks(0, 60, 1)[0, 1:3].mean())
    assert glare.EyeState.at(middle, 1.0).lid_opening == 0
    assert glare.EyeState.at(middle, 1.0, blinking=False).lid_opening == squint(1.0)


def test_lids_squint_in_glare():
    openings = [squint(luminance) for luminance in (0, 1, 100, 3000, 1e4, 1e10)]
    assert openings == sorted(openings, reverse=True)
    assert openings[0] == 1
    assert openings[2] > 0.97
    assert openings[3] == pytest.approx(0.725)
    assert openings[-1] == pytest.approx(0.45, abs=1e-4)


# Adaptation.


def test_a_number_is_taken_as_it_is():
    assert adapted(0.0, [1.0]).tolist() == [0.0]
    assert adapted(3.3, [0.0, 9.0]).tolist() == [3.3, 3.3]
    assert adapted(3.3, []).tolist() == []


@pytest.mark.parametrize(("before", "after", "lag"), [(1.0, 1000.0, BRIGHTER), (1000.0, 1.0, DARKER)])
def test_the_logarithm_follows_with_a_lag_faster_towards_brighter(before, after, lag):
    times = [1.9, 2.0, 2.1, 2.123, 2.5, 4.0]
    found = adapted(lambda time: before if time < 2 else after, times)
    for time, level in zip(times, found, strict=True):
        left = math.exp(-max(0.0, time - 2) / lag)
        assert math.log(level) == pytest.approx(math.log(after) + left * math.log(before / after), abs=1e-9)


def test_a_ramp_of_the_logarithm_is_followed_one_lag_behind():
    # A decade in ten seconds, up: in the end the eye sees what was BRIGHTER seconds ago.
    found = adapted(lambda time: 10 ** (time / 10), [15.0])
    assert math.log10(found[0]) == pytest.approx((15.0 - BRIGHTER) / 10, abs=1e-4)


def test_a_table_is_a_function_and_stays_at_its_ends():
    table = ([1.0, 2.0, 3.0], [1.0, 5.0, 2.0])
    times = [0.0, 1.5, 2.0, 2.5, 10.0]
    function = adapted(lambda time: float(np.interp(time, *table)), times)
    assert np.array_equal(adapted(table, times), function)
    assert adapted(table, [0.9]) == pytest.approx([1.0])
    assert adapted(table, [40.0]) == pytest.approx([2.0])


def test_many_times_are_as_each_alone_and_in_any_order():
    def scene(time):
        return 100 * (1.01 + math.sin(0.7 * time))

    times = [40.0, 0.0, 33.337, 5.001, 33.337]
    together = adapted(scene, times)
    alone = [adapted(scene, [time])[0] for time in times]
    assert together == pytest.approx(alone, rel=1e-4)
    assert together[2] == together[4]
    states = glare.states(times, scene, seed=4)
    for time, state in zip(times, states, strict=True):
        single = glare.EyeState.at(time, scene, seed=4)
        for part in fields(state)[1:]:
            assert getattr(state, part.name) == pytest.approx(getattr(single, part.name), rel=2e-4, abs=1e-12)


def test_darkness_has_an_end_and_frames_may_come_one_by_one():
    assert adapted(lambda time: 0.0, [3.0]) == pytest.approx([DARKEST])
    level = 1.0
    for _ in range(60):
        level = adapted_after(level, 1000.0, 1 / 60)
    whole = adapted_after(1.0, 1000.0, 1.0)
    assert level == pytest.approx(whole)
    assert whole == pytest.approx(1000 * 1000 ** (-math.exp(-1 / BRIGHTER)))


def test_the_pupil_and_the_squint_follow_the_damped_luminance():
    def flash(time):
        return 0.1 if time < 10 else 1e4

    before, during, after = glare.states([9.9, 10.2, 14.0], flash, hippus=False, blinking=False)
    assert before.pupil_diameter > during.pupil_diameter > after.pupil_diameter
    assert before.lid_opening > during.lid_opening > after.lid_opening
    assert after.pupil_diameter == pytest.approx(glare.pupil_diameter(1e4, 3600), rel=1e-4)


# The state.


def test_states_of_frames_are_continuous():
    def scene(time):
        return 10 ** (2 * math.sin(time))

    states = glare.states(np.arange(20, 21.5, 1 / 240), scene, head=lambda time: 0.5 * math.sin(3 * time))
    steps = {
        part.name: np.abs(np.diff([getattr(state, part.name) for state in states])).max()
        for part in fields(states[0])[3:]
    }
    # Metres, dioptres, relative, radians, 1: in a 240th of a second.
    assert steps["pupil_diameter"] < 0.04e-3
    assert steps["accommodation"] < 0.02
    assert steps["lens_stretch"] < 1.5e-4
    assert steps["vitreous_angle"] < 0.02
    assert steps["lid_opening"] < 0.09


def test_the_same_seed_is_the_same_eye_on_every_machine():
    state = glare.EyeState.at(12.5, 0.5, seed=11)
    assert state.pupil_diameter == pytest.approx(PUPIL, rel=1e-6)
    assert state.accommodation == pytest.approx(DIOPTRES, rel=1e-6)
    assert state.vitreous_angle == pytest.approx(ANGLE, rel=1e-6)
    assert blinks(0, 60, 11)[0, 0] == pytest.approx(BLINK, rel=1e-6)
    again = glare.EyeState.at(12.5, 0.5, seed=11)
    assert (again, hash(again)) == (state, hash(state))


def test_seeds_and_ages_are_the_eyes_own_unless_given():
    old = replace(glare.Eye(), age=70.0, seed=9)
    state = glare.EyeState.at(1.0, 0.1, eye=old)
    assert state.eye == old
    assert state == glare.EyeState.at(1.0, 0.1, age=70.0, seed=9)
    assert state.pupil_diameter < glare.EyeState.at(1.0, 0.1, seed=9).pupil_diameter - 1e-3


def test_named_eyes_are_what_their_files_say():
    standard, own = glare.eye_named("standard"), glare.Eye()
    for part in fields(own):
        found, expected = getattr(standard, part.name), getattr(own, part.name)
        assert found == (pytest.approx(expected) if isinstance(expected, float) else expected), part.name
    ritschel = glare.eye_named("ritschel-2009")
    assert (ritschel.fibre_count, ritschel.pupil, ritschel.name) == (200, "ritschel", "ritschel-2009")
    # 94 µm between gratings at a radius of 3 mm.
    assert 2 * math.pi * ritschel.fibre_annulus[1] / 200 == pytest.approx(94e-6, rel=0.01)
    assert glare.EyeState.at(0, 1.0, eye=ritschel, hippus=False).pupil_diameter == pytest.approx(
        3.76e-3, abs=5e-6
    )
    assert glare.eye_named("elderly").age == 70
    # C/2 R² / (2 √6) for 0.75 dioptres over 6 mm.
    assert glare.eye_named("astigmatic").zernike["astigmatism"] == pytest.approx(
        0.375 * 9e-6 / (2 * math.sqrt(6)), rel=0.01
    )


@pytest.mark.parametrize("name", presets.names("eyes"))
def test_each_named_eye_can_be_and_can_be_changed(name):
    eye = glare.eye_named(name, age=51, seed=3)
    assert (eye.age, eye.seed) == (51, 3)
    assert 1.5e-3 < glare.EyeState.at(2.0, 10.0, eye=eye).pupil_diameter < 9e-3


def test_an_eye_of_ones_own(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(
        'title = "Mine"\nsource = "A mirror"\nlashes = 8\nlash_width_um = 60\nzernike_um = {coma-x = 0.1}\n'
    )
    eye = glare.eye_named(str(path))
    assert (eye.lashes, eye.lash_width, eye.zernike) == (
        8,
        pytest.approx(60e-6),
        {"coma-x": pytest.approx(1e-7)},
    )


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: glare.EyeState.at(-1, 1), "'time' must be a number from 0 to 1e+06, got -1."),
        (lambda: glare.EyeState.at(0, -2), "'luminance' must be a number from 0 to 1e+10, got -2."),
        (lambda: glare.EyeState.at(0, math.inf), "'luminance' must be a number from 0 to 1e+10, got inf."),
        (
            lambda: glare.EyeState.at(2, lambda t: -t),
            "'luminance' must be a number from 0 to 1e+10, got -0.00833333.",
        ),
        (lambda: glare.EyeState.at(0, ([0, 1], [1])), "'luminance' must be an array of shape (2), got (1,)."),
        (
            lambda: glare.EyeState.at(0, ([0, 0], [1, 2])),
            "the times of 'luminance' must grow from each to the next.",
        ),
        (
            lambda: glare.EyeState.at(0, ([0], [1], [2])),
            "'luminance' must be a number, a function or (times, values), got 3.",
        ),
        (lambda: glare.EyeState.at(0, 1, age=0), "'age' must be a number from 1 to 120, got 0."),
        (lambda: glare.EyeState.at(0, 1, seed=-1), "'seed' must be an integer >= 0, got -1."),
        (
            lambda: glare.EyeState.at(0, 1, field_of_view=0),
            "'field_of_view' must be a number from 1e-06 to 6.28319, got 0.",
        ),
        (
            lambda: glare.EyeState.at(0, 1, head=lambda t: math.nan),
            "'head' must be a finite number, got nan.",
        ),
        (lambda: adapted_after(1, 1, -1), "'elapsed' must be a number from 0 to 1e+06, got -1."),
        (lambda: squint(-1), "'luminance' must be a number from 0 to 1e+10, got -1."),
        (lambda: glare.eye_named("elderley"), "presets/eyes has no 'elderley'. Did you mean 'elderly'?"),
        (lambda: glare.eye_named("standard", ages=3), "Eye has no 'ages'. Did you mean 'age'?"),
        (lambda: glare.eye_named("standard", pigment=2), "'pigment' must be a number from 0 to 1.2, got 2."),
        (
            lambda: glare.eye_named("standard", pupil="round"),
            "'pupil' must be one of 'watson-yellott', 'ritschel', got 'round'.",
        ),
        (
            lambda: glare.eye_named("standard", lashes=101),
            "'lashes' must be a number from 0 to 100, got 101.",
        ),
        (lambda: glare.eye_named("standard", fibre_count=0), "'fibre_count' must be an integer >= 1, got 0."),
        (lambda: glare.eye_named("standard", fibre_annulus=(3e-3, 2e-3)), "inner radius"),
        (lambda: glare.eye_named("standard", zernike={"comma": 1e-7}), "'zernike' must be one of"),
    ],
)
def test_refusals(ask, message):
    with pytest.raises(refuse.Refusal, match=re.escape(message)):
        ask()
