"""The flare job: lights measured and placed, starbursts where they stand, layers that add up, refusals."""

import math
from dataclasses import replace

import numpy as np
import pytest

from aureole import aperture, flare, jobs, light, picture
from aureole.flare import paraxial
from aureole.jobs.flare import layer_name
from aureole.jobs.flare_lights import Lamp, Scene, found_lights, light_of
from aureole.jobs.flare_starburst import starburst_stages, working_f_number
from aureole.records import Picture
from aureole.refuse import Refusal

SHAPE = (90, 160)
DEGREE = math.pi / 180


@pytest.fixture(scope="module")
def heliar():
    return flare.load("heliar_tronnier_100mm")


def night(place=(60, 30), colour=(40.0, 20.0, 10.0), shape=SHAPE):
    """A dark picture with a lamp of two by two pixels, its corner at the place (x, y)."""
    pixels = np.full((*shape, 3), 1e-3, dtype=np.float32)
    pixels[place[1] : place[1] + 2, place[0] : place[0] + 2] = colour
    return Picture(pixels)


def finish(lens, **how):
    small = {} if how.get("over") is not None else {"shape": SHAPE}
    return jobs.finish(jobs.run(jobs.FlareJob(lens, **{**small, "ghosts": "top:4", "f_number": 8.0, **how})))


def scene(lens, over=None, shape=SHAPE):
    return Scene(lens, shape, (0, 0), (0, 0), over, light.illuminant("E"))


def luminance(colour):
    """Y relative to equal energy, as spectra have it."""
    return float(light.to_xyz(np.asarray(colour, dtype=float), "rec709")[1])


def test_angles_and_pixels_name_the_same_light(heliar):
    pixel = heliar.sensor[0] / SHAPE[1]
    x = SHAPE[1] / 2 + abs(paraxial.focal_length(heliar)) * math.tan(8 * DEGREE) / pixel
    y = SHAPE[0] / 2 - abs(paraxial.focal_length(heliar)) * math.tan(3 * DEGREE) / pixel
    by_angles = light_of(Lamp((8 * DEGREE, -3 * DEGREE)), scene(heliar))
    by_pixels = light_of(Lamp((x, y), on_picture=True), scene(heliar))
    np.testing.assert_allclose(by_angles.direction, by_pixels.direction, atol=1e-12)
    # To the right and upward on the picture, where y points downward.
    assert by_angles.direction[0] > 0 > by_angles.direction[1]


def test_a_lights_strength_and_colour_are_those_of_the_picture(heliar):
    """Half as much again as the lamp's four pixels is not there; a second lamp is not counted."""
    over = night()
    over.pixels[70:72, 120:122] = 500
    found = light_of(Lamp((61.0, 31.0), on_picture=True), scene(heliar, over))
    assert found.irradiance == pytest.approx(4 * luminance((40, 20, 10)), rel=1e-6)
    xyz = light.tristimulus(found.spectrum)
    rgb = light.from_xyz(xyz, "rec709")
    np.testing.assert_allclose(rgb / rgb[0], [1, 0.5, 0.25], rtol=1e-4)
    # A few pixels beside the lamp it is found, too.
    beside = light_of(Lamp((63.5, 31.0), on_picture=True), scene(heliar, over))
    assert beside.irradiance == pytest.approx(found.irradiance)


def test_a_stated_strength_and_colour_win(heliar):
    lamp = Lamp((61.0, 31.0), True, colour=(0.0, 0.0, 2.0), strength=3.0)
    found = light_of(lamp, scene(heliar, night()))
    assert found.irradiance == 3.0
    rgb = light.from_xyz(light.tristimulus(found.spectrum), "rec709")
    assert abs(rgb[:2]).max() < 1e-3 * rgb[2]
    assert light_of(Lamp((0.1, 0.0)), scene(heliar)).irradiance == 1.0


def test_lights_that_the_picture_shows_are_found(heliar):
    over = night()
    over.pixels[70, 120] = 300
    brightest, other = found_lights(scene(heliar, over), 1.0)
    assert brightest.irradiance == pytest.approx(luminance((300, 300, 300)), rel=1e-6)
    assert other.irradiance == pytest.approx(4 * luminance((40, 20, 10)), rel=1e-6)
    place = flare.place_on_picture(heliar, brightest, SHAPE)
    np.testing.assert_allclose(place, (120.5, 70.5), atol=1e-6)
    with pytest.raises(Refusal, match=r"nothing brighter than 1000; the brightest pixel is 300"):
        found_lights(scene(heliar, over), 1000.0)


def test_a_light_off_the_picture_needs_its_strength(heliar):
    with pytest.raises(Refusal, match=r"the light at -20,31 pixels is off the picture.*give --strength"):
        light_of(Lamp((-20.0, 31.0), True), scene(heliar, night()))
    with pytest.raises(Refusal, match="the picture is black at 10,10 pixels"):
        light_of(Lamp((10.0, 10.0), True), scene(heliar, Picture(np.zeros((*SHAPE, 3), np.float32))))


def starburst(lens, lights, **how):
    *_, last = starburst_stages(lens, lights, SHAPE, aperture.iris(6, 1.0), 8.0, **how)
    return last.result


def test_starbursts_hold_the_lights_energy_where_they_stand(heliar):
    lights = [
        flare.light_on_picture(heliar, (50.5, 40.5), SHAPE, irradiance=3.0),
        flare.light_on_picture(heliar, (110.5, 60.5), SHAPE, irradiance=1.0),
    ]
    pixels = starburst(heliar, lights)
    # A pixel of 0.225 mm holds the core of f/8, all but a thousandth of the light.
    assert pixels[40, 50, 1] == pytest.approx(3.0, rel=0.03)
    assert pixels[60, 110, 1] == pytest.approx(1.0, rel=0.03)
    assert pixels[..., 1].sum() == pytest.approx(4.0, rel=0.005)
    np.testing.assert_allclose(
        pixels, starburst(heliar, lights[:1]) + starburst(heliar, lights[1:]), atol=1e-6
    )
    without = starburst(heliar, lights[:1], with_core=False)
    assert not without[39:42, 49:52].any()
    np.testing.assert_array_equal(without[:30], starburst(heliar, lights[:1])[:30])


def test_a_light_off_the_picture_sends_its_streaks_into_it(heliar):
    """What a sensor three times as wide would show there."""
    wide, broad = replace(heliar, sensor=(heliar.sensor[0] * 3, heliar.sensor[1])), (90, 480)
    lamp = flare.light_on_picture(wide, (80.5, 45.5), broad)
    *_, last = starburst_stages(wide, [lamp], broad, aperture.iris(6, 1.0), 8.0)
    off = flare.light_on_picture(heliar, (80.5 - 160, 45.5), SHAPE)
    np.testing.assert_allclose(off.direction, lamp.direction, atol=1e-12)
    np.testing.assert_allclose(starburst(heliar, [off]), last.result[:, 160:320], atol=1e-9)


def test_the_f_number_of_the_light_that_leaves_the_lens(heliar):
    assert working_f_number(heliar, 8.0, "y") == pytest.approx(8.0, rel=1e-9)
    assert working_f_number(heliar, None, "y") == pytest.approx(paraxial.f_number(heliar))
    # No iris opens a lens wider than it is.
    assert working_f_number(heliar, 1.0, "y") == pytest.approx(paraxial.f_number(heliar))


LAMP = Lamp((2 * DEGREE, 1 * DEGREE))


def test_layers_add_up_to_the_ghosts_and_all_to_the_picture(heliar):
    result = finish(heliar, lamps=(LAMP,), starburst=True, layers=True)
    names = [layer_name(flare.path_named(heliar, name)) for name in result.report["energies"]]
    assert sorted(result.layers.names) == sorted([*names, "ghosts", "starburst"])
    each = sum(result.layers.picture_of(name).astype(np.float64) for name in names)
    np.testing.assert_allclose(result.ghosts.pixels, each, atol=1e-6 * each.max())
    np.testing.assert_array_equal(result.layers.picture_of("ghosts"), result.ghosts.pixels)
    np.testing.assert_allclose(
        result.picture.pixels, result.ghosts.pixels + result.starburst.pixels, atol=1e-12
    )
    assert each.sum() > 0


def test_ghosts_are_the_same_in_layers_and_in_one(heliar):
    one, layered = (finish(heliar, lamps=(LAMP,), layers=layers) for layers in (False, True))
    peak = one.ghosts.pixels.max()
    np.testing.assert_allclose(layered.ghosts.pixels, one.ghosts.pixels, atol=1e-5 * peak)


def test_strength_and_gain_multiply_the_ghosts(heliar):
    few = {"only": ("7-9", "1-3")}
    plain = finish(heliar, lamps=(LAMP,), **few)
    strong = finish(heliar, lamps=(replace(LAMP, strength=3.0),), **few)
    gained = finish(heliar, lamps=(LAMP,), gain=100.0, **few)
    np.testing.assert_allclose(strong.ghosts.pixels, 3 * plain.ghosts.pixels, rtol=1e-5)
    np.testing.assert_allclose(gained.ghosts.pixels, 100 * plain.ghosts.pixels, rtol=1e-5)
    # The ratio is the lens's, whatever the light and the look.
    for other in (strong, gained):
        assert other.report["ghost_to_image"] == pytest.approx(plain.report["ghost_to_image"], rel=1e-6)
    assert plain.report["ghost_to_image"] == pytest.approx(sum(plain.report["energies"].values()))


def test_two_lights_make_the_ghosts_of_each(heliar):
    other = Lamp((-1 * DEGREE, 2 * DEGREE))
    paths = ("1-3", "7-9")
    first, second, both = (
        finish(heliar, lamps=lamps, only=paths).ghosts.pixels for lamps in ((LAMP,), (other,), (LAMP, other))
    )
    np.testing.assert_allclose(both, first + second, atol=1e-5 * both.max())


def test_a_white_light_is_white_in_every_space_and_a_coloured_one_is_not(heliar):
    """A starburst's core has the light's colour: white for any illuminant, else as said."""
    few = {"only": ("7-9",), "starburst": True}
    for space, illuminant in (("rec709", "E"), ("acescg", "A")):
        burst = finish(heliar, lamps=(LAMP,), illuminant=illuminant, colour_space=space, **few).starburst
        np.testing.assert_allclose(burst.pixels.sum(axis=(0, 1)), 1.0, atol=0.02)
    warm = finish(heliar, lamps=(replace(LAMP, colour=(1.0, 0.5, 0.1)),), **few).starburst
    total = warm.pixels.sum(axis=(0, 1))
    np.testing.assert_allclose(total / total[0], [1, 0.5, 0.1], atol=0.01)


def test_the_flare_is_added_to_the_picture(heliar):
    over = night()
    result = finish(heliar, lamps=(Lamp((61.0, 31.0), True),), over=over, starburst=True)
    np.testing.assert_allclose(
        result.picture.pixels,
        over.pixels + result.ghosts.pixels + result.starburst.pixels,
        rtol=1e-6,
    )
    # The lamp itself stays as the picture shows it.
    np.testing.assert_allclose(result.picture.pixels[30:32, 60:62], over.pixels[30:32, 60:62], rtol=1e-3)
    assert result.report["lights"][0]["strength"] == pytest.approx(4 * luminance((40, 20, 10)), rel=1e-6)


def test_overscan_does_not_move_the_flare(heliar, tmp_path):
    """The lens sees the shown pixels; those beyond go on about them."""
    # Small ghosts that lie within both, with edges that a shift by a pixel would show.
    small = {"only": ("2-5", "3-5"), "f_number": 22.0}
    whole = night()
    picture.write(tmp_path / "a.exr", whole)
    read = picture.read(tmp_path / "a.exr")
    plain = finish(heliar, lamps=(Lamp((61.0, 31.0), True),), over=read, **small)
    wide = np.full((SHAPE[0] + 14, SHAPE[1] + 25, 3), 1e-3, np.float32)
    wide[10:-4, 20:-5] = whole.pixels
    header = replace(
        picture.header_of(read), data_window=picture.Window(-20, -10, SHAPE[1] + 25, SHAPE[0] + 14)
    )
    source = Picture(wide, "rec709", {"header": header})
    around = finish(heliar, lamps=(Lamp((61.0, 31.0), True),), over=source, layers=True, **small)
    assert around.picture.pixels.shape == wide.shape
    peak = plain.ghosts.pixels.max()
    np.testing.assert_allclose(around.ghosts.pixels[10:-4, 20:-5], plain.ghosts.pixels, atol=1e-3 * peak)
    each = sum(around.layers.picture_of(name) for name in ("ghost_2_5", "ghost_3_5"))
    np.testing.assert_allclose(each, around.ghosts.pixels, atol=1e-6 * peak)
    assert around.report["lights"][0]["place_pixels"] == pytest.approx([61, 31])


def test_ghosts_are_chosen_hidden_and_alone(heliar):
    most = finish(heliar, lamps=(LAMP,), ghosts="paper")
    assert most.report["ghosts"] == 11
    energies = list(most.report["energies"].values())
    assert energies == sorted(energies, reverse=True)
    hidden = finish(heliar, lamps=(LAMP,), ghosts="paper", hide=("1-3", "2-5"))
    assert set(most.report["energies"]) - set(hidden.report["energies"]) == {"1-3", "2-5"}
    # A ghost of the last surface is none of the paper's, and can be seen alone.
    alone = finish(heliar, lamps=(LAMP,), ghosts="paper", only=("7-9",))
    assert list(alone.report["energies"]) == ["7-9"]


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({}, "'light' is missing"),
        ({"find": 1.0}, "'find-lights' needs the picture"),
        ({"ghosts": "som"}, "ghosts"),
        ({"hide": ("1-99",)}, "1-99"),
        ({"only": ("2-5",), "hide": ("2-5",)}, "no ghost is left"),
        ({"filter": "mean"}, "'filter' must be one of 'median', 'spectral'"),
        ({"filter": "median", "layers": True}, "filter 'median' does not go with 'layers'"),
        ({"merge": "much"}, "merge"),
        ({"illuminant": "D66"}, "illuminant"),
        ({"colour_space": "rgb"}, "'colour-space' must be one of"),
        ({"opening": jobs.Opening(width=1e-3)}, "--f-number sets the iris's size"),
        ({"shape": (20_000, 30_000), "memory": 10**9}, "needs about 48 GB of memory, 1 GB are allowed"),
        ({"lamps": (Lamp((95 * DEGREE, 0.0)),)}, "less than 89 degrees .* got 95"),
        ({"over": night(), "shape": SHAPE, "lamps": (LAMP,)}, "'size' does not go with 'over'"),
        ({"over": night(), "colour_space": "acescg", "lamps": (LAMP,)}, "'colour-space' does not go with"),
    ],
)
def test_refusals(heliar, how, words):
    lamps = () if not how or "find" in how else (LAMP,)
    with pytest.raises(Refusal, match=words):
        finish(heliar, **{"lamps": lamps, **how})


def test_the_filters_keep_the_ghosts_energy(heliar):
    small = {"lamps": (LAMP,), "only": ("7-9",), "shape": (180, 320)}
    plain = finish(heliar, **small).ghosts.pixels
    for name in ("median", "spectral"):
        smooth = finish(heliar, **small, filter=name).ghosts.pixels
        np.testing.assert_allclose(smooth.sum(), plain.sum(), rtol=0.02)
        assert abs(smooth - plain).max() > 1e-3 * plain.max()
    layered = finish(heliar, **small, filter="spectral", layers=True).ghosts.pixels
    np.testing.assert_allclose(layered, smooth, atol=1e-4 * smooth.max())


def test_ringing_follows_the_rims_where_they_crop_the_iris(heliar):
    """At f/16 no rim cuts the light of one degree; at f/4 rims cut that of nine."""
    for f_number, degrees, is_cut in ((16.0, 1.0, False), (4.0, 9.0, True)):
        lamp = Lamp((degrees * DEGREE, 0.0), strength=1.0)
        how = {"lamps": (lamp,), "f_number": f_number, "only": ("3-4",), "ringing": 20.0}
        plain, cropped = (finish(heliar, **how, crop_ringing=crop).ghosts.pixels for crop in (False, True))
        apart = np.abs(cropped - plain).sum() / plain.sum()
        assert apart > 0.02 if is_cut else apart < 1e-6


def test_cropped_ringing_that_is_refused(heliar):
    with pytest.raises(Refusal, match=r"^'crop-ringing' needs 'ringing', and does not go with 'layers'\.$"):
        finish(heliar, lamps=(Lamp((0.1, 0.0)),), crop_ringing=True)
