"""The pupil: published diameters, and a tremor of the published size and spectrum."""

import math

import numpy as np
import pytest

from aureole import glare, refuse
from aureole.glare.eye_pupil import LARGEST, SMALLEST, hippus, ritschel_hippus

# cd/m² and mm at 30 years, 60° x 60°, both eyes: Watson & Yellott 2012 with the constants of ISETBio.
WATSON_YELLOTT = [(1e-3, 7.39), (0.1, 6.2), (1, 4.98), (10, 3.71), (100, 2.82), (1000, 2.35)]
FIELD = 3600.0
SEEDS = (1, 2, 3)
RATE, SECONDS = 4.0, 1024.0
TIMES = np.arange(int(SECONDS * RATE)) / RATE


def stanley_davies(luminance, area_deg2):
    power = (luminance * area_deg2 / 846) ** 0.41
    return 1e-3 * (7.75 - 5.75 * power / (power + 2))


def power_below(series, *hertz):
    """Parts of the variance below some frequencies, by a periodogram under Hann's window."""
    power = np.abs(np.fft.rfft((series - series.mean()) * np.hanning(len(series)))) ** 2
    frequencies = np.fft.rfftfreq(len(series), 1 / RATE)
    return [float(power[frequencies < limit].sum() / power.sum()) for limit in hertz]


@pytest.mark.parametrize(("luminance", "millimetres"), WATSON_YELLOTT)
def test_mean_diameter_is_that_of_watson_and_yellott(luminance, millimetres):
    assert glare.pupil_diameter(luminance, FIELD) == pytest.approx(millimetres * 1e-3, abs=0.02e-3)
    state = glare.EyeState.at(3.0, luminance, hippus=False)
    assert state.pupil_diameter == pytest.approx(millimetres * 1e-3, abs=0.02e-3)


@pytest.mark.parametrize("luminance", [0.0, 0.1, 50.0])
def test_at_the_reference_age_it_is_that_of_stanley_and_davies(luminance):
    assert glare.pupil_diameter(luminance, 100.0, 28.58) == pytest.approx(stanley_davies(luminance, 100.0))


def test_one_eye_counts_for_a_tenth_and_area_for_luminance():
    assert glare.pupil_diameter(10, FIELD, binocular=False) == pytest.approx(glare.pupil_diameter(1, FIELD))
    assert glare.pupil_diameter(10, FIELD / 10) == pytest.approx(glare.pupil_diameter(1, FIELD))
    half = glare.EyeState.at(0, 4.0, field_of_view=math.radians(30), hippus=False)
    assert half.pupil_diameter == pytest.approx(glare.pupil_diameter(1, FIELD))


def test_old_pupils_are_smaller_and_ages_without_data_are_as_the_last_with():
    dark = [glare.pupil_diameter(0.01, FIELD, age) for age in (20, 30, 50, 70, 83)]
    assert dark == sorted(dark, reverse=True)
    # 0.044 mm a year in darkness (Winn et al. 1994 find 0.04), nothing to speak of in sunlight.
    assert (dark[0] - dark[4]) / 63 == pytest.approx(0.047e-3, abs=0.006e-3)
    assert glare.pupil_diameter(0.01, FIELD, 10) == dark[0]
    assert glare.pupil_diameter(0.01, FIELD, 120) == dark[4]


@pytest.mark.parametrize("age", [1, 20, 83, 120])
@pytest.mark.parametrize("luminance", [0.0, 1e-6, 1.0, 1e4, 1e10])
def test_the_mean_is_a_pupil_at_any_luminance(luminance, age):
    for diameter in (glare.pupil_diameter(luminance, FIELD, age), glare.ritschel_diameter(luminance)):
        assert SMALLEST < diameter < LARGEST


@pytest.mark.parametrize(
    ("luminance", "millimetres"),
    [(0.0, 7.9), (0.1, 4.9), (1.0, 3.76), (1e10, 1.9), (0.01, 4.9 + 3 * math.tanh(0.4))],
)
def test_the_formula_of_temporal_glare_takes_the_decimal_logarithm(luminance, millimetres):
    assert glare.ritschel_diameter(luminance) == pytest.approx(millimetres * 1e-3, abs=0.005e-3)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("luminance", [1e-3, 1.0, 1000.0])
def test_hippus_has_the_published_size_and_spectrum(luminance, seed):
    mean = glare.pupil_diameter(luminance, FIELD)
    series = np.array([hippus(time, mean, seed) for time in TIMES])
    assert 0.04e-3 < series.std() < 0.20e-3
    assert series.mean() == pytest.approx(mean, abs=0.01e-3)
    below_median, below_decile, below_two = power_below(series, 0.32, 0.63, 2.0)
    assert below_median == pytest.approx(0.5, abs=0.05)
    assert 0.90 < below_decile < 0.95
    # What is left above is the tail of the law, not a jagged curve's.
    assert below_two > 0.995


def test_a_wide_pupil_trembles_as_that_of_the_demonstration():
    # Measured on a demonstration of Temporal Glare's authors: 6.66 mm, standard deviation 0.11 mm.
    for tremble in (hippus, ritschel_hippus):
        series = np.array([tremble(time, 6.66e-3, 1) for time in TIMES])
        assert series.std() == pytest.approx(0.11e-3, abs=0.01e-3)
        assert power_below(series, 0.32, 0.63) == pytest.approx([0.5, 0.915], abs=0.05)


def test_the_noise_of_temporal_glare_runs_faster_in_small_pupils():
    wide, small = (np.array([ritschel_hippus(time, d, 1, 0.1) for time in TIMES]) for d in (6.66e-3, 3.33e-3))
    # noise(t/p): the same curve at half of the time, larger by (p_max/p) sqrt(1 - p/p_max).
    growth = 2 * math.sqrt((1 - 3.33 / 9) / (1 - 6.66 / 9))
    half = len(TIMES) // 2
    assert small[:half] - 3.33e-3 == pytest.approx(growth * (wide[: 2 * half : 2] - 6.66e-3), abs=2e-6)


@pytest.mark.parametrize("tremble", [hippus, ritschel_hippus])
@pytest.mark.parametrize("diameter", [1.5e-3, 1.52e-3, 2e-3, 5e-3, 8.9e-3, 9e-3])
def test_no_tremor_leaves_what_pupils_can_do(tremble, diameter):
    series = [tremble(time, diameter, 7, 10.0) for time in TIMES[::8]]
    assert min(series) >= SMALLEST
    assert max(series) <= LARGEST


def test_no_contrast_is_no_tremor_and_seeds_differ():
    assert hippus(3.0, 5e-3, 1, 0.0) == 5e-3
    one, other = (np.array([hippus(time, 5e-3, seed) for time in TIMES]) for seed in (1, 2))
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.2


def test_hippus_is_continuous_and_never_repeats():
    fine = np.array([hippus(100 + k / 1000, 5e-3, 1) for k in range(3000)])
    assert np.abs(np.diff(fine)).max() < 2e-6
    early, late = (np.array([hippus(start + t, 5e-3, 1) for t in TIMES[:256]]) for start in (0.0, 1e5))
    assert abs(np.corrcoef(early, late)[0, 1]) < 0.6


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: glare.pupil_diameter(-1, FIELD), "'luminance' must be a number from 0 to 1e\\+10, got -1."),
        (lambda: glare.pupil_diameter(math.nan, FIELD), "'luminance' must"),
        (lambda: glare.pupil_diameter(1, 0), "'area_deg2' must be a finite number > 0, got 0."),
        (lambda: glare.pupil_diameter(1, FIELD, 0), "'age' must be a number from 1 to 120, got 0."),
        (lambda: glare.ritschel_diameter(-0.1), "'luminance' must"),
        (lambda: hippus(0, 1e-3, 1), "'diameter' must be a number from 0.0015 to 0.009, got 0.001."),
        (lambda: hippus(0, 5e-3, 1, -1), "'hippus' must be a number from 0 to 10, got -1."),
    ],
)
def test_refusals(ask, message):
    with pytest.raises(refuse.Refusal, match=message):
        ask()
