"""Occluders before an opening: where their shadows fall, how large they are, and what is refused."""

import math

import numpy as np
import pytest

from aureole import aperture, refuse
from aureole.records import Aperture

OPENING = aperture.circle(10e-3)


def seen(*occluders: aperture.Occluder, toward=(0.0, 0.0), distance=math.inf, size=None, opening=OPENING):
    return aperture.seen_past(opening, occluders, toward, distance, size)


def lost(left: Aperture) -> float:
    return aperture.area(OPENING) - aperture.area(left)


def test_a_far_lights_shadow_is_as_large_as_the_occluder():
    left = seen(aperture.occluder(aperture.circle(2e-3), 0.5))
    assert lost(left) == pytest.approx(math.pi * 1e-6, rel=1e-6)


def test_a_near_lights_shadow_is_larger():
    # Halfway to the light it is twice as large along each axis.
    left = seen(aperture.occluder(aperture.circle(2e-3), 0.5), distance=1.0)
    assert lost(left) == pytest.approx(4 * math.pi * 1e-6, rel=1e-6)


@pytest.mark.parametrize("distance", [math.inf, 2.0])
def test_the_shadow_falls_on_the_line_from_the_light_through_the_occluder(distance):
    place, toward, depth = (1e-3, -0.5e-3), (2e-3, 1e-3), 0.5
    left = seen(aperture.occluder(aperture.circle(1e-3), depth, place), toward=toward, distance=distance)
    mask = aperture.rasterize(OPENING, 500) - aperture.rasterize(left, 500)
    axis = (np.arange(500) - 249.5) * 10e-3 / 500
    found = np.array([(mask.sum(axis=0) * axis).sum(), (mask.sum(axis=1) * axis).sum()]) / mask.sum()
    # The opening's point p, the occluder's place q and the light lie on one line.
    light = np.array([*toward])
    if math.isinf(distance):
        assert found + depth * light == pytest.approx(place, abs=2e-6)
    else:
        on_line = found + (distance * light - found) * depth / distance
        assert on_line == pytest.approx(place, abs=2e-6)


def test_what_stands_behind_the_light_covers_nothing():
    left = seen(aperture.occluder(aperture.circle(2e-3), 0.5), distance=0.4)
    assert aperture.area(left) == aperture.area(OPENING)


@pytest.mark.parametrize("size", [None, 64])
def test_a_hidden_light_sees_nothing(size):
    assert seen(aperture.occluder(aperture.rectangle(20e-3, 20e-3), 0.5), size=size) is None


def test_outlines_and_rasters_let_the_same_light_through():
    bars = aperture.occluder(aperture.railing(1.3e-3, 1.9e-3, 9, 40e-3, 0.3), 0.5, (0.4e-3, 0.0))
    exact, painted = seen(bars, distance=3.0), seen(bars, distance=3.0, size=512)
    assert painted.mask is not None
    assert not exact.mask
    assert aperture.area(painted) == pytest.approx(aperture.area(exact), rel=1e-4)


def test_a_matte_covers_what_its_silhouette_covers():
    leaf = aperture.polygon([(-1e-3, -2e-3), (2e-3, 0.5e-3), (0.0, 1.5e-3)])
    matte = aperture.from_mask(aperture.rasterize(leaf, 256), leaf.width)
    place = (0.7e-3, -0.3e-3)
    painted = seen(aperture.occluder(matte, 0.4, place), distance=2.0, size=256)
    exact = seen(aperture.occluder(leaf, 0.4, place), distance=2.0, size=256)
    assert np.abs(painted.mask - exact.mask).mean() < 2e-3
    assert aperture.area(painted) == pytest.approx(aperture.area(exact), rel=1e-5)


def test_a_grey_matte_dims():
    pane = aperture.from_mask(np.full((4, 4), 0.25), 40e-3)
    left = seen(aperture.occluder(pane, 0.4), size=32)
    np.testing.assert_allclose(left.mask, 0.75 * aperture.rasterize(OPENING, 32), rtol=1e-6)


def test_a_railing_blocks_its_bars_share():
    bars = aperture.occluder(aperture.railing(1e-3, 1e-3, 2, 1.0), 0.5)
    window = aperture.rectangle(4e-3, 4e-3)
    left = aperture.seen_past(window, [bars])
    # Two bars of 1 mm before a window of 4 mm.
    assert aperture.area(left) == pytest.approx(8e-6, rel=1e-9)


def test_a_moved_occluder_keeps_its_shape():
    bars = aperture.occluder(aperture.circle(2e-3), 0.5).moved_to(1e-3, 2e-3)
    assert bars.place == (1e-3, 2e-3)
    assert bars.distance == 0.5


def test_refusals():
    disc = aperture.circle(1e-3)
    with pytest.raises(refuse.Refusal, match="'distance' must be"):
        aperture.occluder(disc, 0.0)
    with pytest.raises(refuse.Refusal, match="'distance' must be > 0, got -1"):
        aperture.seen_past(disc, [], distance=-1.0)
    with pytest.raises(refuse.Refusal, match="'place' must hold finite"):
        aperture.occluder(disc, 1.0, (math.nan, 0.0))
    with pytest.raises(refuse.Refusal, match="give 'size'"):
        seen(aperture.occluder(aperture.from_mask(np.ones((4, 4)), 1e-3), 1.0))
    with pytest.raises(refuse.Refusal, match="'bar' must be"):
        aperture.railing(0.0, 1e-3, 3, 1.0)
    with pytest.raises(refuse.Refusal, match="'count' must be"):
        aperture.railing(1e-3, 1e-3, 0, 1.0)
