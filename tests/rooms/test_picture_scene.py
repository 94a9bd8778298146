"""The bundled scene: the same for a seed, with the range of a real night, the same at every size."""

import hashlib

import numpy as np
import pytest

from aureole import Picture, refuse
from aureole.picture import scene

ROWS = 360
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
SIZE = 0.03  # how far a lamp's light may differ between sizes


def luminance(picture):
    return picture.pixels.astype(np.float64) @ LUMINANCE


@pytest.fixture(scope="module")
def night():
    return scene.night_scene((ROWS, ROWS * 16 // 9))


def around(picture, lamp, reach=0.006):
    """The mean luminance near a lamp times the area: its candela, in picture heights."""
    rows, columns = picture.pixels.shape[:2]
    y, x = (np.arange(rows) + 0.5) / rows, (np.arange(columns) + 0.5) / rows + (16 / 9 - columns / rows) / 2
    near = luminance(picture)[np.abs(y - lamp.y) < reach][:, np.abs(x - lamp.x) < reach]
    return near.sum() / rows**2


def test_it_is_a_linear_picture_of_light(night):
    assert isinstance(night, Picture)
    assert night.colour_space == "rec709"
    assert night.pixels.shape == (ROWS, 640, 3)
    assert night.pixels.dtype == np.float32
    assert night.pixels.flags.c_contiguous
    assert np.isfinite(night.pixels).all()
    assert night.pixels.min() >= 0


def test_it_has_the_range_of_a_real_night(night):
    values = luminance(night)
    assert values.max() / np.median(values) > 1e5
    assert 0.003 < np.median(values) < 0.1
    assert values.max() < 1e6
    assert values.min() > 1e-4


def test_the_same_seed_gives_the_same_picture():
    one, two = (scene.night_scene((90, 160), seed=4).pixels for _ in range(2))
    assert hashlib.sha256(one).hexdigest() == hashlib.sha256(two).hexdigest()


def test_another_seed_moves_stars_and_waves_but_no_lamp():
    one, two = scene.night_scene((180, 320), seed=1), scene.night_scene((180, 320), seed=2)
    assert np.mean(np.abs(one.pixels - two.pixels) > 1e-3) > 0.1
    for lamp in scene.lamps()[:6]:
        np.testing.assert_allclose(around(one, lamp), around(two, lamp), rtol=SIZE)


def test_there_are_lamps_of_many_colours_and_sizes():
    lamps = scene.lamps()
    assert 12 <= len(lamps) <= 40
    assert len({lamp.colour for lamp in lamps}) >= 6
    radii = [lamp.radius for lamp in lamps]
    assert 2 * min(radii) <= 1.2
    assert 2 * max(radii) >= 10


@pytest.mark.parametrize("lamp", scene.lamps()[:13], ids=lambda lamp: f"{lamp.colour}-{lamp.x:.2f}")
def test_every_lamp_stands_out_from_what_is_round_it(night, lamp):
    row, column = round(lamp.y * ROWS - 0.5), round(lamp.x * ROWS - 0.5)
    values = luminance(night)
    peak = values[row - 1 : row + 2, column - 1 : column + 2].max()
    block = values[row - 12 : row + 13, max(column - 12, 0) : column + 13]
    assert peak > 1000
    assert peak > 1e3 * np.median(block)


@pytest.mark.parametrize("rows", [181, 540])
def test_another_size_shows_the_same_lamps_as_bright(night, rows):
    other = scene.night_scene((rows, rows * 16 // 9))
    for lamp in scene.lamps()[:4]:
        wanted = np.pi * (lamp.radius * scene.PIXEL) ** 2 * lamp.luminance
        np.testing.assert_allclose(around(other, lamp, 0.02), wanted, rtol=2 * SIZE)
    ratio = np.median(luminance(other)) / np.median(luminance(night))
    assert abs(ratio - 1) < 0.05


def test_the_moon_is_low_warm_and_brighter_than_the_sky(night):
    x, y, radius = scene.MOON
    disc = night.pixels[round(y * ROWS), round(x * ROWS)]
    assert 0.3 < y < scene.HORIZON
    assert disc[0] > disc[1] > disc[2] > 100
    sky = night.pixels[round(y * ROWS), round((x + 12 * radius) * ROWS)]
    assert disc.max() > 1000 * sky.max()


def test_lamps_and_moon_are_mirrored_in_the_water(night):
    for lamp in (scene.LAMPS[8], scene.LAMPS[-1], scene.Lamp(*scene.MOON, 520, "warm")):
        column, values = round(lamp.x * ROWS), luminance(night)
        below = values[round(0.75 * ROWS) : round(0.9 * ROWS)]
        assert below[:, column - 3 : column + 4].mean() > 3 * below[:, column - 30 : column - 20].mean()


@pytest.mark.parametrize("shape", [(1, 1), (2, 3), (5, 1), (1, 7), (40, 20), (30, 120)])
def test_odd_shapes_work(shape):
    pixels = scene.night_scene(shape).pixels
    assert pixels.shape == (*shape, 3)
    assert np.isfinite(pixels).all()
    assert pixels.min() >= 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [(((0, 5),), "'shape' must be an integer >= 1"), (((5, 5), -1), "'seed' must be an integer >= 0")],
)
def test_refusals(arguments, message):
    with pytest.raises(refuse.Refusal, match=message):
        scene.night_scene(*arguments)
