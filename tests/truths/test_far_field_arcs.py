"""Arcs: the uniform expansion of curved edges against quadrature of the boundary integral."""

import math

import numpy as np
import pytest

from aureole import Grid, Outline, aperture
from aureole.diffraction import far_field
from aureole.records import Aperture

D = 2e-3
PEAK = 5e-7  # error over the area of a square of the same perimeter
LOCAL = 1e-4  # error over the root mean square of the field on the same grid


def grids():
    """Near, far and off-centre grids, spans and centres in cycles per D."""
    for span in (0.01, 1, 20, 70):
        for centre in ((0.0, 0.0), (3.3, -7.1), (-40.0, 11.0), (130.0, 95.0)):
            yield Grid((9, 10), (span / 9 / D, span / 10 / D), (centre[0] / D, centre[1] / D))


def check(shape):
    perimeter = sum(np.hypot(*aperture.boundary_nodes(r, D)[1].T).sum() for r in shape.outlines)
    area = perimeter**2 / 16
    for grid in grids():
        found = far_field(shape, grid, "polygons").amplitude
        wanted = far_field(shape, grid, "reference").amplitude
        error = float(np.max(np.abs(found - wanted)))
        assert error < PEAK * area, grid
        assert error < LOCAL * math.sqrt(np.mean(np.abs(wanted) ** 2)), grid


@pytest.mark.parametrize("blades", [3, 4, 7])
@pytest.mark.parametrize("curvature", [0.001, 0.01, 0.1, 0.3, 0.6, 0.9, 1.0])
def test_curved_irises(blades, curvature):
    check(aperture.iris(blades, D, curvature, 0.3))


@pytest.mark.parametrize(
    "bulges", [(1.0, 0.0), (0.4, 0.4), (2.5, 0.0), (0.3, -0.2), (-1.0, -0.05), (0.9, 1e-5)]
)
def test_rings_of_two_arcs(bulges):
    """Half discs, lenses, more than half circles, crescents, either way round."""
    vertices = np.array([[0.4, 0.1], [-0.3, -0.2]]) * D
    check(Aperture(D, (Outline(vertices, np.array(bulges)),)))


def test_arcs_that_bend_inward():
    """An astroid-like star, its blades bent towards the middle."""
    ring = aperture.iris(4, D, 0.0, 0.2).outlines[0]
    check(Aperture(D, (Outline(ring.vertices, np.full(4, -0.25)),)))


def test_holes_with_arcs():
    check(
        aperture.subtraction(
            aperture.iris(5, D, 0.5), aperture.moved(aperture.iris(6, D / 3, 0.8), 1e-4, 2e-4)
        )
    )


@pytest.mark.parametrize("blades", [3, 5, 8])
def test_curvature_one_is_the_circle(blades):
    circle, iris = aperture.circle(D), aperture.iris(blades, D, 1.0, 0.1)
    for grid in grids():
        found = far_field(iris, grid).amplitude
        wanted = far_field(circle, grid).amplitude
        np.testing.assert_allclose(found, wanted, rtol=0, atol=PEAK * aperture.area(circle))


def test_curvature_nought_is_the_limit_of_flat_arcs():
    """Continuous through the bulge below which an arc counts as straight."""
    straight = aperture.iris(6, D)
    for curvature in (1e-7, 3e-6, 1e-5):
        flat = aperture.iris(6, D, curvature)
        for grid in grids():
            found, wanted = (far_field(shape, grid).amplitude for shape in (flat, straight))
            # The sagitta, curvature × D / 16, adds to the area, and moves the edge's wave by 2π |q| of it.
            reach = np.hypot(*(np.abs(axis).max() for axis in grid.axes())) * D
            bound = PEAK + curvature * (1 + 2 * math.pi * reach / 4)
            assert np.max(np.abs(found - wanted)) < bound * aperture.area(straight)
