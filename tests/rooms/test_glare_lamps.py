"""Lights that a picture shows: their place, flux, colour and size, against shapes whose light is known."""

import itertools

import numpy as np
import pytest
from scipy.special import erf

from aureole import Picture, glare, light, picture, refuse
from aureole.picture import scene

SHAPE = (60, 90)
WARM = np.array([1.6, 0.9, 0.4])


def covered(count, low, high):
    """The part of each pixel of a row that lies between two places."""
    edges = np.arange(count)
    return np.clip(np.minimum(edges + 1, high) - np.maximum(edges, low), 0, 1)


def square(x, y, side):
    across = covered(SHAPE[1], x - side / 2, x + side / 2)
    return np.outer(covered(SHAPE[0], y - side / 2, y + side / 2), across)


def blob(x, y, sigma):
    """The light of a Gaussian of energy 1 in each pixel."""
    sums = [
        np.diff(0.5 * (1 + erf((np.arange(count + 1) - centre) / (sigma * np.sqrt(2)))))
        for count, centre in zip(SHAPE, (y, x), strict=True)
    ]
    return np.outer(*sums)


def shown(luminance, colour=(1.0, 1.0, 1.0)):
    weights = light.SPACES["rec709"].to_xyz[1]
    hue = np.asarray(colour) / (weights @ colour)
    return Picture((luminance[..., None] * hue).astype(np.float32))


@pytest.mark.parametrize("shift", [0.0, 0.21, 0.5, 0.83])
def test_a_light_has_its_whole_flux_and_its_place_wherever_it_lies_between_pixels(shift):
    source = shown(
        1000 * square(30 + shift, 20 + 0.7 * shift, 6) + 0.25 * (1 - square(30 + shift, 20 + 0.7 * shift, 6)),
        WARM,
    )
    (found,) = glare.find_lamps(source, 100.0)
    # Above its ground: what the square has more than what is about it.
    assert found.flux == pytest.approx(36 * (1000 - 0.25), rel=1e-5)
    # Pixels that are covered in part count from their centre: an eighth of a pixel at both edges at most.
    assert found.place == pytest.approx((30 + shift, 20 + 0.7 * shift), abs=0.125 / 6 + 1e-6)
    weights = light.SPACES["rec709"].to_xyz[1]
    assert found.colour == pytest.approx(WARM / (weights @ WARM), rel=1e-5)
    assert found.peak == pytest.approx(1000, rel=1e-6)


@pytest.mark.parametrize("shift", [0.0, 0.3, 0.5])
def test_smooth_lights_are_found_to_a_hundredth_of_a_pixel(shift):
    (found,) = glare.find_lamps(shown(5000 * blob(41.2 + shift, 33.7 - shift, 1.4)), 1.0)
    assert found.place == pytest.approx((41.2 + shift, 33.7 - shift), abs=0.01)
    assert found.flux == pytest.approx(5000, rel=0.005)
    # The variance of a disc is a sixteenth of its diameter's square.
    assert found.size == pytest.approx(4 * 1.4, rel=0.02)


def test_size_is_that_of_the_even_disc():
    y, x = np.mgrid[: SHAPE[0] * 16, : SHAPE[1] * 16] / 16 + 1 / 32
    disc = (np.hypot(x - 40.3, y - 30.6) < 7.25).reshape(SHAPE[0], 16, SHAPE[1], 16).mean(axis=(1, 3))
    (found,) = glare.find_lamps(shown(80 * disc), 1.0)
    assert found.size == pytest.approx(14.5, rel=0.003)
    assert found.flux == pytest.approx(80 * np.pi * 7.25**2, rel=0.002)
    assert found.box == (33, 23, 48, 38) or np.all(np.abs(np.array(found.box) - (33, 23, 48, 38)) <= 1)


def test_a_single_pixel_is_a_point():
    luminance = np.zeros(SHAPE)
    luminance[12, 34] = 7.0
    (found,) = glare.find_lamps(shown(luminance), 1.0)
    assert found.place == pytest.approx((34.5, 12.5))
    assert found.size == 0
    assert found.flux == pytest.approx(7.0)


def test_light_fades_to_nothing_at_the_threshold():
    """No light pops in: the flux of one that just passes the threshold is small beside the pixels' sum."""
    fluxes = []
    for peak in (10.02, 10.2, 12.0, 40.0):
        (found,) = glare.find_lamps(shown(peak * blob(40.5, 30.5, 4.0) / blob(40.5, 30.5, 4.0).max()), 10.0)
        fluxes.append(found.flux)
    assert all(low < high for low, high in itertools.pairwise(fluxes))
    assert fluxes[0] < 0.02 * fluxes[-1]


def test_all_light_is_found_once():
    generator = np.random.default_rng(3)
    luminance = generator.random(SHAPE) ** 30 * 100
    labels = picture.bright_labels(luminance, 3.0)
    found = picture.measured_regions(labels, luminance)
    assert found.flux.sum() == pytest.approx(luminance[luminance > 3].sum(), rel=1e-12)
    assert np.all(np.diff(found.flux) <= 0)
    for k in (0, len(found) // 2, len(found) - 1):
        rows, columns = np.nonzero(found.labels == k + 1)
        weights = luminance[rows, columns]
        assert found.flux[k] == pytest.approx(weights.sum())
        assert found.places[k] == pytest.approx(
            [np.average(columns + 0.5, weights=weights), np.average(rows + 0.5, weights=weights)]
        )
        assert found.boxes[k].tolist() == [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
        assert found.areas[k] == len(rows)
        assert found.peaks[k] == weights.max()


def test_margins_do_not_run_into_other_regions():
    luminance = np.zeros(SHAPE)
    luminance[10, 10], luminance[10, 12] = 5.0, 8.0
    labels = picture.bright_labels(luminance, 1.0, margin=1)
    assert labels[10, 10] != labels[10, 12]
    assert np.count_nonzero(labels) == 15
    assert len(np.unique(picture.bright_labels(luminance, 1.0, connect=3))) == 2


def test_only_the_strongest_are_kept_and_dark_pictures_have_none():
    luminance = sum(10 * k * square(10 * k, 30, 3) for k in range(1, 8))
    found = glare.find_lamps(shown(luminance), 1.0, most=3)
    assert [lamp.flux for lamp in found] == pytest.approx([630, 540, 450], rel=1e-5)
    assert glare.find_lamps(shown(np.zeros(SHAPE))) == []
    assert glare.find_lamps(shown(np.full(SHAPE, 0.4))) == []
    # White paper is no light.
    assert glare.find_lamps(shown(0.18 + 0.72 * square(40, 30, 20))) == []


def test_the_lamps_of_the_night_scene_are_found_where_they_were_drawn():
    shape = (540, 960)
    night = picture.night_scene(shape)
    found = glare.find_lamps(night)
    places = np.array([lamp.place for lamp in found]) / shape[0]
    drawn = [lamp for lamp in scene.LAMPS if 0 < lamp.x < 16 / 9 and 0 < lamp.y < 1]
    far = [np.hypot(*(places - (lamp.x, lamp.y)).T).min() * shape[0] for lamp in drawn]
    assert max(far) < 0.5


def test_places_do_not_depend_on_the_space_of_colours():
    source = shown(5000 * blob(41.2, 33.7, 1.4))
    (one,) = glare.find_lamps(source, 1.0)
    (other,) = glare.find_lamps(light.convert(source, "acescg"), 1.0)
    assert other.place == pytest.approx(one.place, abs=1e-4)
    assert other.flux == pytest.approx(one.flux, rel=1e-4)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: glare.find_lamps(shown(np.ones(SHAPE)), 0.0), "'threshold' must be a finite number > 0"),
        (lambda: glare.find_lamps(shown(np.ones(SHAPE)), 1.0, most=0), "'most' must be an integer >= 1"),
        (
            lambda: glare.find_lamps(shown(np.ones(SHAPE)), 1.0, connect=0),
            "'connect' must be an integer >= 1",
        ),
        (lambda: glare.find_lamps(shown(np.full(SHAPE, np.nan)), 1.0), "'picture' must hold finite numbers"),
    ],
)
def test_refusals(call, words):
    with pytest.raises(refuse.Refusal, match=words):
        call()
