"""Barycentric coordinates of quads: what they promise, and where each of them ends."""

import numpy as np
import pytest

from aureole import refuse
from aureole.flare import barycentric
from aureole.flare.barycentric import METHODS, coordinates

PRECISE = [method for method in METHODS if method != "loop-derose"]
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
# A dart: corner 2 lies inside the triangle of the others. A bow tie: edges 0-1 and 2-3 cross.
DART = np.array([[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]])
BOW_TIE = np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]])


def convex_quads(count=400, spread=0.25, seed=3):
    """Squares with moved corners, half of them turned the other way, and points in them."""
    random = np.random.default_rng(seed)
    quads = 40.0 * (SQUARE + random.uniform(-spread, spread, (count, 4, 2))) + random.uniform(
        0, 1000, (count, 1, 2)
    )
    quads[::2] = quads[::2, ::-1]
    shares = random.dirichlet([1.0] * 4, count)
    return quads, np.einsum("nk,nkx->nx", shares, quads)


def again(weights, quads):
    return np.einsum("nk,nkx->nx", weights, quads)


@pytest.mark.parametrize("method", [*METHODS, "reference"])
def test_weights_add_up_to_one_and_are_not_negative_inside(method):
    quads, points = convex_quads()
    weights = coordinates(quads, points, method)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, rtol=0, atol=1e-12)
    assert weights.min() > -1e-12


@pytest.mark.parametrize("method", [*PRECISE, "reference"])
def test_weights_find_the_point_again(method):
    quads, points = convex_quads()
    np.testing.assert_allclose(again(coordinates(quads, points, method), quads), points, rtol=0, atol=1e-9)


def test_loop_derose_as_printed_misses_the_point():
    """By a tenth of the quad's size and more: without Wachspress' areas at the corners lines are not kept."""
    quads, points = convex_quads()
    missed = np.hypot(*(again(coordinates(quads, points, "loop-derose"), quads) - points).T) / 40.0
    assert np.quantile(missed, 0.9) > 0.05
    assert missed.max() > 0.1


@pytest.mark.parametrize("method", METHODS)
def test_a_corner_is_all_its_own(method):
    quads, _ = convex_quads()
    for k in range(4):
        found = coordinates(quads, quads[:, k], method)
        np.testing.assert_allclose(found, np.tile(np.eye(4)[k], (len(quads), 1)), rtol=0, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_an_edge_belongs_to_its_two_corners(method):
    quads, _ = convex_quads()
    for k in range(4):
        middle = 0.25 * quads[:, k] + 0.75 * quads[:, (k + 1) % 4]
        found = coordinates(quads, middle, method)
        np.testing.assert_allclose(found[:, [(k + 2) % 4, (k + 3) % 4]], 0.0, rtol=0, atol=1e-9)
        if method != "loop-derose":
            np.testing.assert_allclose(found[:, [k, (k + 1) % 4]], [[0.25, 0.75]] * len(quads), atol=1e-9)


def test_on_parallelograms_those_of_quads_agree():
    """Mean value coordinates differ from the bilinear ones even there: they are no ratio of polynomials."""
    random = np.random.default_rng(4)
    turned = random.normal(size=(200, 2, 2))
    quads = np.einsum("kx,nxy->nky", SQUARE, turned) + random.normal(size=(200, 1, 2))
    u, v = random.uniform(0.01, 0.99, (2, 200))
    expected = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
    points = again(expected, quads)
    for method in ("wachspress", "loop-derose", "bilinear", "reference"):
        np.testing.assert_allclose(coordinates(quads, points, method), expected, rtol=0, atol=1e-9)
    assert abs(coordinates(quads, points, "mean-value") - expected).max() > 0.01


def test_both_ways_to_a_triangle_agree():
    quads, points = convex_quads()
    pair = [coordinates(quads, points, method) for method in ("triangle", "homogeneous")]
    np.testing.assert_allclose(*pair, rtol=0, atol=1e-9)
    assert np.all((pair[0][:, 1] == 0) | (pair[0][:, 3] == 0))


def test_bilinear_weights_equal_the_reference():
    quads, points = convex_quads(spread=0.2)
    expected = coordinates(quads, points, "reference")
    np.testing.assert_allclose(coordinates(quads, points, "bilinear"), expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_outside_a_convex_quad_a_weight_is_negative(method):
    quads, _ = convex_quads()
    middle = quads.mean(axis=1, keepdims=True)
    beyond = (middle + 1.8 * (quads - middle))[:, 0]
    found = coordinates(quads, beyond, method)
    assert np.all((found.min(axis=1) < 0) | (found.sum(axis=1) == 0))


@pytest.mark.parametrize("method", ["mean-value", "triangle", "homogeneous"])
def test_concave_and_crossing_quads_have_weights_that_find_the_point(method):
    random = np.random.default_rng(5)
    for shape in (DART, BOW_TIE):
        points = random.uniform(0.0, 2.0, (300, 2))
        quads = np.broadcast_to(shape, (300, 4, 2))
        found = coordinates(quads, points, method)
        some = found.any(axis=1)
        assert np.all(np.isfinite(found))
        np.testing.assert_allclose(again(found, quads)[some], points[some], rtol=0, atol=1e-9)


def test_a_dart_is_left_by_wachspress_but_not_by_its_triangles():
    """A point deep in the dart's wing, by the cut from corner 0 to 2 in a triangle of its own."""
    point = [[2.5, 0.25]]
    assert coordinates([DART], point, "triangle").min() >= 0
    assert coordinates([DART], point, "wachspress").min() < 0


def test_a_folded_cell_covers_a_point_twice_and_one_of_the_two_is_found():
    """The bow tie's map (u, v) → (2 (u + v - 2uv), 2u): at each point a root, or none outside."""
    u, v = np.random.default_rng(6).uniform(0.0, 1.0, (2, 200))
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
    quads = np.broadcast_to(BOW_TIE, (200, 4, 2))
    points = again(weights, quads)
    found = coordinates(quads, points, "bilinear")
    assert found.min() > -1e-6
    np.testing.assert_allclose(again(found, quads), points, rtol=0, atol=1e-6)


@pytest.mark.parametrize("method", [*METHODS, "reference"])
def test_a_quad_without_area_has_no_weights_and_no_nan(method):
    quads = np.array([np.zeros((4, 2)), [[0, 0], [1, 1], [2, 2], [3, 3]]])
    found = coordinates(quads, [[0.5, 0.2], [0.5, 0.9]], method)
    assert np.all(np.isfinite(found))
    np.testing.assert_array_equal(found[0], 0.0)


def test_single_precision_stays_single():
    """The raster's numbers: 4 digits of a pixel are left beside 2000 pixels."""
    quads, points = convex_quads()
    exact = coordinates(quads, points)
    found = np.empty((len(quads), 4), dtype=np.float32)
    kernel = barycentric.kernels.coordinates
    kernel(quads.astype(np.float32), points.astype(np.float32), METHODS.index("bilinear"), found)
    assert abs(again(found, quads) - points).max() < 1e-3
    assert np.quantile(abs(found - exact), 0.99) < 1e-4


def test_refusals():
    with pytest.raises(refuse.Refusal, match=r"'method' must be one of .* Did you mean 'wachspress'"):
        coordinates([SQUARE], [[0.5, 0.5]], "wachpress")
    with pytest.raises(refuse.Refusal, match="'quads' must be an array of shape"):
        coordinates(SQUARE, [[0.5, 0.5]])
    with pytest.raises(refuse.Refusal, match="'points' must be an array of shape"):
        coordinates([SQUARE], [0.5, 0.5])
    with pytest.raises(refuse.Refusal, match="'points' must hold finite numbers"):
        coordinates([SQUARE], [[0.5, np.nan]])
