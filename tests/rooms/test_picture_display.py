"""Display: exposure, curves that rise and keep hue, printed sRGB values, colour maps, side by side."""

import numpy as np
import pytest

from aureole import Picture, refuse
from aureole.picture import display

HUE = 2e-5  # of a colour's channels, after float32's rounding
GREY = np.ones((2, 2))
ENCODED = 1e-4  # sRGB's own constants meet only to this

# Linear 0..1 and sRGB of 0..255, from IEC 61966-2-1's curve.
PRINTED = [(0.0, 0), (0.0031308, 10.31), (0.18, 117.66), (0.2140, 127.5), (0.5, 187.52), (1.0, 255)]


def ramp(colour, stops=12, count=400):
    """A colour from far below one to far above it."""
    steps = np.exp2(np.linspace(-stops, stops, count))[None, :, None]
    return (steps * np.asarray(colour)).astype(np.float32)


def hue_of(rgb):
    """The middle channel's place between the lowest and the highest."""
    low, middle, high = np.moveaxis(np.sort(rgb, axis=-1), -1, 0)
    return (middle - low) / (high - low)


@pytest.mark.parametrize(("linear", "printed"), PRINTED)
def test_clip_is_the_curve_of_srgb(linear, printed):
    shown = display.to_display(np.full((1, 1, 3), linear, np.float32), exposure=0.0, tone="clip")
    np.testing.assert_allclose(shown * 255, printed, atol=255 * ENCODED)


@pytest.mark.parametrize("stops", [-3.0, 0.0, 2.5])
def test_a_stop_is_a_factor_of_two(stops):
    shown = display.to_display(np.full((1, 1), 0.1 * 2.0**-stops), exposure=stops, tone="clip")
    np.testing.assert_allclose(
        shown, display.to_display(np.full((1, 1), 0.1), exposure=0.0, tone="clip"), 1e-5
    )


@pytest.mark.parametrize("tone", display.TONES)
@pytest.mark.parametrize("colour", [(1, 1, 1), (1, 0.4, 0.06), (0.02, 0.2, 1), (1, 0, 0)])
def test_brighter_light_never_looks_darker(tone, colour):
    shown = display.to_display(ramp(colour), exposure=0.0, tone=tone)
    assert shown.dtype == np.float32
    assert shown.min() >= 0
    assert shown.max() <= 1
    assert np.diff(shown, axis=1).min() >= -1e-6
    luminance = shown @ display.LUMINANCE
    assert luminance[0, -1] >= luminance[0, 200] > luminance[0, 0]


@pytest.mark.parametrize("colour", [(1, 0.4, 0.06), (0.02, 0.2, 1), (0.3, 1, 0.5)])
def test_filmic_keeps_the_hue_and_turns_white_at_the_top(colour):
    bent = display.filmic(ramp(colour, 6))
    below = bent[bent.max(axis=-1) < 0.98]
    np.testing.assert_allclose(hue_of(below), hue_of(np.asarray(colour)), atol=HUE)
    assert display.filmic(ramp(colour, 12))[0, -1].min() > 0.99


def test_filmic_is_straight_near_black_and_survives_any_float():
    np.testing.assert_allclose(display.filmic(np.full((1, 1, 3), 1e-4, np.float32)), 1e-4, rtol=1e-5)
    top = np.float32(np.finfo(np.float32).max)
    np.testing.assert_array_equal(display.filmic(np.array([[[0, 0, 0], [top, 0, 0]]], np.float32))[0, 0], 0)
    assert np.isfinite(display.filmic(np.array([[[top, 0, 0]]], np.float32))).all()


@pytest.mark.parametrize("tone", display.TONES)
def test_negative_colours_move_to_grey_and_keep_their_luminance(tone):
    outside = np.array([[[-0.1, 0.5, 0.3], [0.2, 0.2, 0.2]]], np.float32)
    shown = display.to_display(outside, exposure=0.0, tone=tone)
    assert shown.min() >= 0
    inside = display.to_display(outside, exposure=0.0, tone="clip")[0, 0]
    linear = ((inside + 0.055) / 1.055) ** 2.4
    linear = np.where(inside <= 0.04045, inside / 12.92, linear)
    np.testing.assert_allclose(linear @ display.LUMINANCE, outside[0, 0] @ display.LUMINANCE, rtol=1e-4)


@pytest.mark.parametrize(("decades", "low"), [(10, 1e-10), (4, 1e-4)])
def test_log_shows_decades_as_even_steps(decades, low):
    values = np.geomspace(low, 1, decades + 1, dtype=np.float32)[None, :]
    steps = np.linspace(0, 1, decades + 1)
    np.testing.assert_allclose(display.log_scale(values, decades)[0], steps, atol=1e-5)
    kernel = np.repeat(values[..., None], 3, axis=2) * 1e-3
    shown = display.to_display(kernel, tone="log", decades=decades)
    np.testing.assert_allclose(shown[0, :, 1], steps, atol=1e-5)


@pytest.mark.parametrize("tone", display.TONES)
def test_black_stays_black(tone):
    black = np.zeros((4, 5, 3), np.float32)
    np.testing.assert_array_equal(display.to_display(black, tone=tone), black)
    np.testing.assert_array_equal(display.log_scale(black[:, :, 0]), 0)


@pytest.mark.parametrize("level", [1e-6, 0.05, 3.0, 4e4])
def test_automatic_exposure_brings_the_percentile_to_its_target(level):
    picture = np.zeros((10, 10), np.float32)
    picture[:5] = level  # unlit pixels do not count
    stops = display.auto_exposure(picture, target=0.25)
    np.testing.assert_allclose(level * 2.0**stops, 0.25, rtol=1e-5)
    assert display.auto_exposure(np.zeros((3, 3))) == 0
    assert display.auto_exposure(picture * 1e-30, most=7.0) == 7


def test_a_few_lamps_do_not_move_the_exposure():
    picture = np.random.default_rng(1).random((100, 100), dtype=np.float32)
    before = display.auto_exposure(picture)
    picture[::20, ::20] = 1e6
    assert abs(display.auto_exposure(picture) - before) < 0.05


def test_pictures_are_converted_from_their_colour_space():
    pixels = np.random.default_rng(3).random((4, 5, 4)).astype(np.float32) * 0.2 + 0.4
    neutral = Picture(np.full((2, 2, 3), 0.5, np.float32), "acescg")
    shown = display.to_display(neutral, exposure=0.0, tone="clip")
    np.testing.assert_allclose(shown, 0.7353, atol=1e-3)
    one, other = (display.to_display(Picture(pixels, space), 0.0, "clip") for space in ("rec709", "acescg"))
    assert one.shape == (4, 5, 3)
    assert np.abs(one - other).max() > 0.01


@pytest.mark.parametrize("colours", display.COLOUR_MAPS)
def test_colour_maps_grow_evenly_lighter(colours):
    shown = display.false_colour(np.linspace(-0.5, 1.5, 801)[None, :], colours)[0]
    assert shown.min() >= 0
    assert shown.max() <= 1
    linear = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    lightness = np.cbrt(linear @ display.LUMINANCE)[200:601]
    assert np.diff(lightness).min() >= -1e-5
    assert lightness[0] < 0.05
    assert lightness[-1] > 0.9
    np.testing.assert_allclose(lightness[200], 0.5, atol=0.1)


def test_side_by_side_puts_a_gap_between_and_centres_the_lower():
    tall, low = np.zeros((6, 4, 3)), np.full((2, 3), 0.5)
    sheet = display.side_by_side([tall, low, tall], gap=2, shade=1.0)
    assert sheet.shape == (6, 4 + 2 + 3 + 2 + 4, 3)
    np.testing.assert_array_equal(sheet[:, :4], 0)
    np.testing.assert_array_equal(sheet[:, 4:6], 1)
    np.testing.assert_array_equal(sheet[2:4, 6:9], 0.5)
    np.testing.assert_array_equal(sheet[[0, 1, 4, 5], 6:9], 1)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: display.to_display(GREY, tone="flimic"), "Did you mean 'filmic'"),
        (lambda: display.to_display(GREY, exposure=float("nan")), "'exposure' must be a finite number"),
        (lambda: display.to_display(GREY, exposure="bright"), "'exposure' must be a finite number"),
        (lambda: display.to_display(np.ones(2)), "'picture' must be an array of shape"),
        (lambda: display.auto_exposure(GREY, percentile=101), "'percentile' must be a number from 0"),
        (lambda: display.auto_exposure(GREY, target=0), "'target' must be a finite number > 0"),
        (lambda: display.log_scale(GREY, 0), "'decades' must be a finite number > 0"),
        (lambda: display.false_colour(GREY, "viridis"), "'colours' must be one of 'ember', 'ice'"),
        (lambda: display.side_by_side([]), "'pictures' must hold at least one picture"),
        (lambda: display.side_by_side([GREY], gap=-1), "'gap' must be an integer >= 0"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(refuse.Refusal, match=message):
        call()
