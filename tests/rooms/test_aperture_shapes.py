"""Shapes: areas and moments by closed form, which way they turn, refusals."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from aureole import Outline, aperture, refuse

R = 1.5e-3
BLADES = [3, 4, 5, 6, 7, 8, 9, 16]


def shoelace(points):
    x, y = np.asarray(points).T
    return (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def iris_area(blades, curvature, radius):
    """The regular polygon, and on each side a segment of the circle of radius R / curvature."""
    straight = blades / 2 * radius**2 * math.sin(2 * math.pi / blades)
    if curvature == 0:
        return straight
    half = math.asin(curvature * math.sin(math.pi / blades))
    return straight + blades * (radius / curvature) ** 2 * (half - math.sin(half) * math.cos(half))


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def test_circle():
    circle = aperture.circle(2 * R)
    assert circle.width == 2 * R
    assert aperture.area(circle) == pytest.approx(math.pi * R**2, rel=1e-12)
    assert aperture.as_circle(circle.outlines[0]) == aperture.Circle(0.0, 0.0, R)


def test_rectangle():
    slit = aperture.rectangle(3e-3, 1e-4)
    assert slit.width == 3e-3
    assert aperture.area(slit) == pytest.approx(3e-7, rel=1e-12)
    extent = slit.outlines[0].vertices.max(axis=0) - slit.outlines[0].vertices.min(axis=0)
    np.testing.assert_allclose(extent, [3e-3, 1e-4], rtol=1e-15)
    assert aperture.rectangle(1e-4, 3e-3).width == 3e-3


@pytest.mark.parametrize("blades", BLADES)
@pytest.mark.parametrize("curvature", [0, 0.001, 0.5, 0.9, 1])
@pytest.mark.parametrize("rotation", [0.0, 1.1])
def test_iris_area(blades, curvature, rotation):
    iris = aperture.iris(blades, 2 * R, curvature, rotation)
    assert iris.width == 2 * R
    assert aperture.area(iris) == pytest.approx(iris_area(blades, curvature, R), rel=1e-11)


def test_an_iris_of_curvature_one_is_the_circle():
    points, _ = aperture.boundary_nodes(aperture.iris(5, 2 * R, 1.0, 0.3).outlines[0], R / 10)
    np.testing.assert_allclose(np.hypot(*points.T), R, rtol=1e-12)


def test_blades_bend_outward_by_their_sagitta():
    for curvature in (0.001, 0.5, 1.0):
        iris = aperture.iris(6, 2 * R, curvature)
        points, _ = aperture.boundary_nodes(iris.outlines[0], R / 50)
        apothem, blade = R * math.cos(math.pi / 6), R / curvature
        # In the middle of a side, blade − √(blade² − (R sin(π / 6))²) beyond the apothem.
        middle = apothem + blade - math.sqrt(blade**2 - (R / 2) ** 2)
        towards = np.hypot(*points.T)[np.abs(np.arctan2(points[:, 1], points[:, 0]) - math.pi / 6) < 0.02]
        assert towards.min() == pytest.approx(middle, rel=1e-3 * (middle - apothem) / R + 2e-4)


@pytest.mark.parametrize("blades", BLADES)
def test_rotation_zero_puts_a_corner_at_plus_x(blades):
    vertices = aperture.iris(blades, 2 * R).outlines[0].vertices
    np.testing.assert_allclose(vertices[0], [R, 0], atol=1e-18)
    np.testing.assert_allclose(np.hypot(*vertices.T), R, rtol=1e-12)


@pytest.mark.parametrize(
    "turn", [lambda a: aperture.iris(5, 2 * R, 0.2, a), lambda a: aperture.whirl(2 * R, 3, a)]
)
def test_positive_rotation_is_counter_clockwise_on_the_screen(turn):
    """At a quarter turn what was at +x is at the top, where y and the row are smaller."""
    before, after = turn(0.0).outlines[0].vertices, turn(math.pi / 2).outlines[0].vertices
    np.testing.assert_allclose(after[:, 0], before[:, 1], atol=1e-17)
    np.testing.assert_allclose(after[:, 1], -before[:, 0], atol=1e-17)


def test_rotation_turns_the_rasterized_shape_too():
    """A triangle whose corner points up: the narrow end lies in the first rows."""
    mask = aperture.rasterize(aperture.iris(3, 2 * R, rotation=math.pi / 2), 64)
    widths = mask.sum(axis=1)
    assert widths[2] < widths[20] < widths[40]
    assert widths[50:].max() == 0
    right = aperture.rasterize(aperture.iris(3, 2 * R), 64)
    assert right[:, 60].sum() < right[:, 40].sum() < right[:, 20].sum()
    assert right[:, :14].max() == 0
    np.testing.assert_allclose(mask, np.rot90(right), atol=1e-5)


def test_polygon_area_by_the_shoelace():
    points = [(0, 0), (2, 0), (2, 1), (1, 0.25), (0, 1)]
    for corners in (points, points[::-1]):
        made = aperture.polygon(corners)
        assert aperture.area(made) == pytest.approx(abs(shoelace(points)), rel=1e-14)
        assert made.width == 4


@pytest.mark.parametrize("arms", [2, 3, 5, 8])
def test_whirl_follows_its_formula(arms):
    whirl = aperture.whirl(2 * R, arms)
    vertices = whirl.outlines[0].vertices
    assert len(vertices) == 64 * arms
    radius, angle = np.hypot(*vertices.T) / R, np.arctan2(vertices[:, 1], vertices[:, 0])
    t = 2 * math.pi * np.arange(len(vertices)) / len(vertices)
    np.testing.assert_allclose(radius, 0.64 + 0.36 * np.cos(arms * t), rtol=1e-12)
    turned = np.exp(1j * (angle - t - 1.1 * radius**2))
    np.testing.assert_allclose(turned, 1, atol=1e-12)
    assert aperture.area(whirl) == pytest.approx(abs(shoelace(vertices)), rel=1e-12)


def test_area_of_a_fine_whirl():
    """∫ r² / 2 dφ with dφ = dt + 1.1 d(r²): the second part closes on itself, so the turning adds nothing."""
    wanted = math.pi * (0.64**2 + 0.36**2 / 2) * R**2
    assert aperture.area(aperture.whirl(2 * R, 5)) == pytest.approx(wanted, rel=3e-3)


def test_moments_of_a_rectangle():
    """Textbook: width³ height / 12 about the middle, Steiner's part about the origin."""
    ring = aperture.moved(aperture.rectangle(2.0, 0.5), 3.0, -1.0).outlines[0]
    area, first, second = aperture.ring_moments(ring)
    np.testing.assert_allclose(area, 1.0, rtol=1e-13)
    np.testing.assert_allclose(first, [3, -1], rtol=1e-13)
    np.testing.assert_allclose(second, [[4 / 12 + 9, -3], [-3, 0.25 / 12 + 1]], rtol=1e-12)
    area, centroid, central = aperture.central_moments(ring)
    np.testing.assert_allclose(area, 1.0, rtol=1e-13)
    np.testing.assert_allclose(centroid, [3, -1], rtol=1e-13)
    np.testing.assert_allclose(central, [[4 / 12, 0], [0, 0.25 / 12]], rtol=1e-12, atol=1e-13)


def test_moments_of_a_half_disc():
    """Textbook: centroid 4 R / 3π from the diameter, π R⁴ / 8 about it, either way round."""
    for sign in (1.0, -1.0):
        ring = Outline(np.array([[sign, 0.0], [-sign, 0.0]]), np.array([sign, 0.0]))
        area, centroid, central = aperture.central_moments(ring)
        assert area == pytest.approx(sign * math.pi / 2, rel=1e-12)
        np.testing.assert_allclose(centroid, [0, 4 / (3 * math.pi)], atol=1e-12)
        along, across = math.pi / 8, math.pi / 8 - 8 / (9 * math.pi)
        np.testing.assert_allclose(central, sign * np.diag([along, across]), atol=1e-12)
        assert aperture.orientation(ring) == sign


def test_central_moments_keep_their_digits_far_off_the_axis():
    small = aperture.moved(aperture.rectangle(1e-5, 2e-5), 0.7, -0.4).outlines[0]
    area, centroid, central = aperture.central_moments(small)
    np.testing.assert_allclose(area, 2e-10, rtol=1e-9)
    np.testing.assert_allclose(centroid, [0.7, -0.4], rtol=1e-12)
    np.testing.assert_allclose(np.diag(central), [2e-20 / 12, 8e-20 / 12], rtol=1e-9)


@pytest.mark.parametrize("bulge", [0.01, -0.3, 1.0, -1.0, 2.5])
def test_an_arc_joins_its_ends_with_its_sweep(bulge):
    start, end = np.array([1.0, 2.0]), np.array([-0.5, 3.0])
    centre, radius, first, sweep = aperture.arc_of(start, end, bulge)
    at = [centre + radius * np.array([math.cos(a), math.sin(a)]) for a in (first, first + sweep)]
    np.testing.assert_allclose(at, [start, end], atol=1e-12)
    assert math.tan(sweep / 4) == pytest.approx(bulge, rel=1e-12)


def test_chords_stay_within_their_tolerance():
    ring = aperture.circle(2.0).outlines[0]
    for tolerance in (1e-2, 1e-5):
        points = aperture.chords(ring, tolerance)
        np.testing.assert_allclose(np.hypot(*points.T), 1, rtol=1e-12)
        middles = (points + np.roll(points, -1, axis=0)) / 2
        sagitta = 1 - np.hypot(*middles.T)
        assert tolerance / 3 < sagitta.max() <= tolerance * (1 + 1e-6)
    straight = aperture.iris(5, 2.0).outlines[0]
    np.testing.assert_array_equal(aperture.chords(straight, 1e-5), straight.vertices)


def test_only_two_half_arcs_are_a_circle():
    half = Outline(np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([1.0, 0.0]))
    lens = Outline(np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([0.5, 0.5]))
    assert aperture.as_circle(half) is aperture.as_circle(lens) is None
    assert aperture.as_circle(aperture.iris(4, 1.0, 1.0).outlines[0]) is None
    clockwise = Outline(np.array([[2.0, 1.0], [0.0, 1.0]]), -np.ones(2))
    assert aperture.as_circle(clockwise) == aperture.Circle(1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: aperture.circle(0), "'diameter' must be a finite number > 0, got 0."),
        (lambda: aperture.circle(math.nan), "'diameter' must be a finite number > 0, got nan."),
        (lambda: aperture.rectangle(1, -2), "'height' must be a finite number > 0, got -2."),
        (lambda: aperture.rectangle(math.inf, 1), "'width' must be a finite number > 0, got inf."),
        (lambda: aperture.iris(2, 1), "'blades' must be an integer >= 3, got 2."),
        (lambda: aperture.iris(5.0, 1), "'blades' must be an integer >= 3, got 5."),
        (lambda: aperture.iris(5, -1), "'diameter' must be a finite number > 0, got -1."),
        (lambda: aperture.iris(5, 1, 1.5), "'curvature' must be a number from 0 to 1, got 1.5."),
        (lambda: aperture.iris(5, 1, -0.1), "'curvature' must be a number from 0 to 1, got -0.1."),
        (lambda: aperture.iris(5, 1, 0, math.inf), "'rotation' must be a finite number, got inf."),
        (lambda: aperture.whirl(1, 1), "'arms' must be an integer >= 2, got 1."),
        (lambda: aperture.whirl(0), "'diameter' must be a finite number > 0, got 0."),
        (lambda: aperture.whirl(1, 5, math.nan), "'rotation' must be a finite number, got nan."),
        (lambda: aperture.polygon([[0, 0], [1, 0]]), "'vertices' must hold at least 3 points, got 2."),
        (
            lambda: aperture.polygon([[0, 0, 0], [1, 0, 0], [1, 1, 0]]),
            "'vertices' must be an array of shape (any, 2), got (3, 3).",
        ),
        (
            lambda: aperture.polygon([[0, 0], [1, 0], [1, math.nan]]),
            "'vertices' must hold finite numbers, got 1 that are NaN or infinite.",
        ),
    ],
)
def test_refusals(make, message):
    with refused(message):
        make()


@pytest.mark.parametrize(
    "vertices",
    [
        [(0, 0), (1, 1), (0, 1), (1, 0)],  # a bow tie
        [(0, 0), (1, 1), (2, 2)],  # no inside
        [(0, 0), (0, 0), (0, 0)],
    ],
)
def test_edges_that_cross_are_refused(vertices):
    with refused("'vertices' must go round an inside without crossing their own edge."):
        aperture.polygon(vertices)


def test_mirror_images_are_seen():
    """Seven blades with a corner at +x mirror in y alone; six in both; a bent edge counts."""

    def mirrored(shape):
        return [aperture.is_mirrored(shape.outlines[0], axis) for axis in (0, 1)]

    for curvature in (0.0, 0.5):
        assert mirrored(aperture.iris(7, 2e-3, curvature)) == [False, True]
        assert mirrored(aperture.iris(6, 2e-3, curvature)) == [True, True]
        assert mirrored(aperture.iris(7, 2e-3, curvature, rotation=0.1)) == [False, False]
    assert mirrored(aperture.whirl(2e-3)) == [False, False]
    square = aperture.rectangle(1.0, 1.0).outlines[0]
    bent = replace(square, bulges=np.array([0.0, 0.3, 0.0, 0.0]))
    assert [aperture.is_mirrored(bent, axis) for axis in (0, 1)] == [False, True]
