"""Rings cut by circles: exact arcs, areas by closed form and against chords, and the cat's eye."""

import math
import re

import numpy as np
import pytest
import shapely

from aureole import aperture, refuse
from aureole.aperture import clipping
from aureole.aperture.geometry import region
from aureole.records import Outline

CHORDS = 1e-6  # chords stray from arcs by 1e-7 of the width


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def disc(diameter, x, y):
    return aperture.moved(aperture.circle(diameter), x, y).outlines[0]


def reversed_ring(ring):
    return Outline(ring.vertices[::-1].copy(), -np.roll(ring.bulges[::-1], -1))


def signed_area(ring):
    return aperture.ring_moments(ring)[0]


def shape_of(rings):
    return shapely.union_all([region(ring, 1.0) for ring in rings])


def lens_area(radius, other, distance):
    """Area that two circles share (Weisstein, MathWorld, "Circle-Circle Intersection", Eq. 14)."""
    r, s, d = radius, other, distance
    return (
        r**2 * math.acos((d**2 + r**2 - s**2) / (2 * d * r))
        + s**2 * math.acos((d**2 + s**2 - r**2) / (2 * d * s))
        - math.sqrt((-d + r + s) * (d + r - s) * (d - r + s) * (d + r + s)) / 2
    )


def rings(seed):
    """Rings of every kind, with a random turn, and a circle that crosses most of them."""
    chance = np.random.default_rng(seed)
    turn = chance.uniform(0, 2 * np.pi)
    shapes = [
        aperture.circle(2.0),
        aperture.iris(int(chance.integers(3, 9)), 2.0, rotation=turn),
        aperture.iris(5, 2.0, chance.uniform(0.05, 1), turn),
        aperture.whirl(2.0, 5, turn),
        aperture.rectangle(2.0, 1.0),
    ]
    circle = disc(chance.uniform(0.3, 3), *chance.uniform(-1, 1, 2))
    for shape in shapes:
        yield shape.outlines[0], circle
        yield reversed_ring(shape.outlines[0]), circle


@pytest.mark.parametrize("seed", range(12))
def test_against_chords(seed):
    """What is left differs from the chords' own intersection by no more than the chords do."""
    crossed = 0
    for ring, circle in rings(seed):
        wanted = region(ring, 1.0).intersection(region(circle, 1.0))
        found = clipping.within_circle(ring, aperture.as_circle(circle))
        if found is None:
            assert wanted.area == 0 or region(circle, 1.0).within(region(ring, 1.0))
            continue
        crossed += 1
        assert shape_of(found).symmetric_difference(wanted).area < CHORDS
        for piece in found:
            assert np.sign(signed_area(piece)) == np.sign(signed_area(ring))
    assert crossed


def test_a_ring_cut_into_pieces():
    """A circle about a whirl's middle leaves the arms' tips out; one off the middle leaves several pieces."""
    ring = aperture.whirl(2.0, 5).outlines[0]
    found = clipping.within_circle(ring, aperture.Circle(1.2, 0.0, 0.9))
    wanted = region(ring, 1.0).intersection(region(disc(1.8, 1.2, 0.0), 1.0))
    assert len(found) == len(wanted.geoms) > 1
    assert sum(abs(signed_area(piece)) for piece in found) == pytest.approx(wanted.area, abs=CHORDS)


def test_the_arcs_are_exact():
    """Every corner of a heptagon within a circle is a corner of its own or lies on the circle."""
    ring = aperture.iris(7, 2.0, 0.3).outlines[0]
    (left,) = clipping.within_circle(ring, aperture.Circle(0.4, 0.1, 0.9))
    own = np.abs(left.vertices[:, None] - ring.vertices).max(axis=2).min(axis=1) < 1e-15
    on_circle = np.abs(np.hypot(*(left.vertices - [0.4, 0.1]).T) - 0.9) < 1e-14
    assert np.all(own | on_circle)
    assert on_circle.sum() == 2
    assert len(left.vertices) < 10


def test_corners_on_the_circle():
    """A square and the circle through its corners, and one that meets two of them."""
    ring = aperture.rectangle(1.0, 1.0).outlines[0]
    for x, diameter in ((0.5, 1.0), (0.0, 1.0)):
        both = aperture.intersection(
            aperture.rectangle(1.0, 1.0), aperture.moved(aperture.circle(diameter), x, 0.0)
        )
        wanted = region(ring, 1.0).intersection(region(disc(diameter, x, 0.0), 1.0)).area
        assert aperture.area(both) == pytest.approx(wanted, abs=CHORDS)


def test_two_circles_in_few_arcs():
    eye = aperture.cats_eye(aperture.circle(2.0), 1.8, (0.7, -0.4))
    assert aperture.area(eye) == pytest.approx(lens_area(1.0, 0.9, math.hypot(0.7, 0.4)), rel=1e-13)
    (ring,) = eye.outlines
    assert len(ring.vertices) <= 4
    assert eye.width == 2.0


def test_a_housing_wider_than_the_iris_crops_nothing():
    iris = aperture.iris(6, 2.0)
    eye = aperture.cats_eye(iris, 3.0, (0.2, 0.3))
    np.testing.assert_array_equal(eye.outlines[0].vertices, iris.outlines[0].vertices)


def test_a_narrow_housing_is_what_is_left():
    eye = aperture.cats_eye(aperture.iris(6, 2.0), 0.5, (0.2, 0.3))
    assert aperture.as_circle(eye.outlines[0]) == aperture.Circle(0.2, 0.3, 0.25)


def test_a_hole_is_cropped_too():
    """A ring of radii 1 and 0.5: the lens of the outer circle less that of the inner one."""
    ring = aperture.obstruction(aperture.circle(2.0), 0.5)
    eye = aperture.cats_eye(ring, 2.0, (0.8, 0.0))
    wanted = lens_area(1.0, 1.0, 0.8) - lens_area(0.5, 1.0, 0.8)
    assert aperture.area(eye) == pytest.approx(wanted, rel=1e-12)


def test_a_raster_is_cropped_to_pixels():
    mask = aperture.rasterize(aperture.circle(2.0), 200)
    eye = aperture.cats_eye(aperture.from_mask(mask, 2.0), 2.0, (0.6, 0.0))
    assert eye.mask.shape == (200, 200)
    assert aperture.area(eye) == pytest.approx(lens_area(1.0, 1.0, 0.6), rel=1e-3)


def test_refusals():
    iris = aperture.iris(6, 2.0)
    with refused("'housing_diameter' must be a finite number > 0, got 0."):
        aperture.cats_eye(iris, 0.0)
    with refused("'offset' must be an array of shape (2), got (3,)."):
        aperture.cats_eye(iris, 1.0, (0.0, 1.0, 2.0))
    with pytest.raises(refuse.Refusal, match="lets no light through"):
        aperture.cats_eye(iris, 1.0, (3.0, 0.0))
