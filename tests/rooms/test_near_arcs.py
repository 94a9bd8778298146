"""Rings with arcs agree with the reference: curvatures × Fresnel numbers × planes, also on corners."""

import math

import numpy as np
import pytest

from aureole import Grid, aperture
from aureole.diffraction import near_field
from aureole.diffraction._kernels_near_arcs import edge_sum
from aureole.diffraction.corner import corner_table
from aureole.diffraction.fresnel import taylor_table
from aureole.diffraction.near_arcs import FAR, Edge, arcs_near
from aureole.diffraction.near_circles import circle_near
from aureole.records import Aperture, Outline

WAVELENGTH = 550e-9
D = 2e-3
ABSOLUTE = 1e-6


def at(number):
    """Return the distance at which (D / 2)² / (λz) is this."""
    return (D / 2) ** 2 / (WAVELENGTH * number)


def compare(shape, grid, number, atol=ABSOLUTE):
    wanted = near_field(shape, grid, at(number), WAVELENGTH, "reference").amplitude
    found = sum(ring.transmittance * arcs_near(ring, grid, at(number), WAVELENGTH) for ring in shape.outlines)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=atol)


@pytest.mark.parametrize("number", [1e-3, 0.1, 3.0, 30.0, 200.0, 1000.0])
@pytest.mark.parametrize("curvature", [0.0, 1e-3, 0.4, 0.99])
def test_curved_blades(curvature, number):
    """On odd and even planes, off the axis, and through a corner, an arc's middle and an arc's centre."""
    shape = aperture.iris(7, D, curvature)
    (ring,) = shape.outlines
    places = [(0.0, 0.0), (0.4e-3, -0.7e-3), tuple(ring.vertices[2])]
    if curvature:
        centre, radius, first, sweep = aperture.arc_of(*ring.vertices[:2], ring.bulges[0])
        middle = first + sweep / 2
        places += [tuple(centre + radius * np.array([np.cos(middle), np.sin(middle)]))]
        if curvature > 0.1:
            places.append(tuple(centre))
    for k, (x, y) in enumerate(places):
        compare(shape, Grid((3 + k % 2, 5 - k % 2), (D / 9, D / 7), (y, x)), number)


@pytest.mark.parametrize("number", [0.5, 40.0, 400.0])
def test_a_fine_plane_around_a_corner_and_across_an_edge(number):
    shape = aperture.iris(5, D, 0.7, rotation=0.3)
    x, y = shape.outlines[0].vertices[1]
    for spacing in (1e-13, 1e-9, 1e-6, 2e-5):
        compare(shape, Grid((5, 6), (spacing, spacing), (float(y), float(x))), number)


@pytest.mark.parametrize("number", [60.0, 200.0, 1500.0])
def test_long_rows_that_some_edges_serve_by_nodes_and_others_by_their_ends(number):
    shape = aperture.iris(9, D, 0.5)
    y = float(shape.outlines[0].vertices[3, 1])
    for centre in ((0.0, 0.0), (y, 0.3e-3)):
        compare(shape, Grid((3, 200), (0.37e-3, 1.1e-5), centre), number)


@pytest.mark.parametrize("number", [2.0, 250.0])
def test_concave_and_straight_edges_and_half_circles(number):
    vertices = np.array([[-0.8e-3, -0.5e-3], [0.6e-3, -0.7e-3], [0.9e-3, 0.4e-3], [-0.3e-3, 0.8e-3]])
    bulges = np.array([-0.2, 0.0, 1.0, -0.05])
    for way in (1, -1):
        # The other way round, each edge starts where it ended.
        turned = np.roll(-bulges[::-1], -1) if way < 0 else bulges
        ring = Outline(vertices[::way], turned, 0.7)
        compare(Aperture(D, (ring,)), Grid((11, 12), (D / 8, D / 9)), number)


def test_arcs_of_one_circle_are_the_circle():
    grid = Grid((20, 21), (D / 15, D / 15), (1e-4, 0.0))
    circle = aperture.as_circle(aperture.circle(D).outlines[0])
    for number in (0.3, 20.0, 300.0):
        wanted = circle_near(circle, grid, at(number), WAVELENGTH)
        for blades in (3, 9):
            (ring,) = aperture.iris(blades, D, 1.0, 0.1).outlines
            np.testing.assert_allclose(arcs_near(ring, grid, at(number), WAVELENGTH), wanted, atol=ABSOLUTE)
        # Nearly a circle goes the other way.
        (ring,) = aperture.iris(9, D, 1 - 1e-9).outlines
        np.testing.assert_allclose(arcs_near(ring, grid, at(number), WAVELENGTH), wanted, atol=ABSOLUTE)


def test_a_single_arc_by_its_ends():
    """From 2πRd = FAR on, by brute force: before it, beside it, on its extension and on its corners."""
    rng = np.random.default_rng(7)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    where = ((np.arange(3000)[:, None] + (nodes + 1) / 2) / 3000).ravel()
    tables = (taylor_table(), *corner_table("coarse"))
    for k in range(120):
        radius = float(np.exp(rng.uniform(1.5, 4)))
        away = FAR * float(np.exp(rng.uniform(0, 1.5))) / (2 * math.pi * radius)
        if k % 3 == 0:
            radius = float(np.sqrt(FAR / 6 * rng.uniform(1, 3)))
            away = radius + rng.choice([0.0, 1e-12, 1e-3, -0.4])
        first, sweep = rng.uniform(-3, 3), rng.uniform(0.05, math.pi / 3)
        angle = first + rng.choice([0.0, sweep, math.pi, sweep + math.pi, rng.uniform(-3, 3)])
        x, y = away * math.cos(angle), away * math.sin(angle)
        angles = first + sweep * where
        along, down = radius * np.cos(angles) - x, radius * np.sin(angles) - y
        half_phase = np.pi / 4 * (along**2 + down**2)
        cross = (
            radius * (along * np.cos(angles) + down * np.sin(angles)) * np.tile(weights, 3000) * sweep / 6000
        )
        wanted = np.sum(0.5j * np.pi * np.sinc(half_phase / np.pi) * np.exp(1j * half_phase) * cross)
        ends = [radius * np.array([math.cos(end), math.sin(end)]) for end in (first, first + sweep)]
        shape = Edge(*ends, radius, np.zeros(2), first, sweep).shape(1.0)
        found = edge_sum(shape, x, y, *tables)
        assert abs(found - wanted) / (2 * math.pi) < 6e-7, (radius, away, first, sweep, angle)


def test_no_number_makes_a_field_that_is_none():
    (ring,) = aperture.iris(3, D, 0.5).outlines
    for distance in (5e-324, 1e-200, 1e-9, 1e9, 1e300):
        for wavelength in (5e-324, 5e-7, 1e300):
            for spacing in (1e-300, 1e-4, 1e150):
                field = arcs_near(ring, Grid((3, 4), (spacing, spacing), (0.0, D / 2)), distance, wavelength)
                assert np.isfinite(field).all(), (distance, wavelength, spacing)
                assert np.abs(field).max() < 3


def test_close_behind_is_the_shadow():
    """At a Fresnel number of 10⁸ light goes straight on."""
    (ring,) = aperture.iris(6, D, 0.4).outlines
    grid = Grid((9, 8), (D / 8, D / 8), (D / 50, D / 40))
    found = arcs_near(ring, grid, at(1e8), WAVELENGTH)
    y, x = grid.axes()
    ends = np.roll(ring.vertices, -1, axis=0)
    arcs = [aperture.arc_of(*edge) for edge in zip(ring.vertices, ends, ring.bulges, strict=True)]
    inside = np.all([np.hypot(y[:, None] - c[1], x - c[0]) < r for c, r, *_ in arcs], axis=0)
    np.testing.assert_allclose(found, inside, rtol=0, atol=5e-3)
