"""The near field of exact outlines agrees with the reference, over shapes × planes × Fresnel numbers."""

import math
import re

import numpy as np
import pytest

from aureole import Grid, aperture, refuse
from aureole.diffraction import near_field, near_power
from aureole.records import Aperture, Outline

WIDTH = 2e-3
WAVELENGTH = 550e-9
ABSOLUTE = 2e-6  # where nothing blocks the wave the field is 1
SHAPES = {
    "rectangle": aperture.rectangle(WIDTH, WIDTH / 2),
    "turned": aperture.rotated(aperture.rectangle(WIDTH, WIDTH / 2), math.pi / 2),
    "triangle": aperture.iris(3, WIDTH, rotation=0.2),
    "heptagon": aperture.iris(7, WIDTH),
    "frame": aperture.subtraction(aperture.rectangle(WIDTH, WIDTH), aperture.rectangle(WIDTH / 2, WIDTH / 4)),
    "two greys": aperture.union(
        aperture.rectangle(WIDTH, WIDTH / 4), aperture.dimmed(aperture.iris(5, WIDTH / 1.3), 0.5)
    ),
    "aside": aperture.moved(aperture.iris(4, WIDTH / 8), 0.7 * WIDTH, -0.2 * WIDTH),
}
NUMBERS = [1e-3, 0.1, 1.0, 10.0, 100.0, 1000.0]
# Corners, edges and their extensions of the rectangles are samples of the first three.
GRIDS = [
    Grid((8, 8), (WIDTH / 8, WIDTH / 8)),
    Grid((5, 6), (WIDTH / 16, WIDTH / 16), (WIDTH / 4, WIDTH / 2)),
    Grid((7, 40), (WIDTH / 8, WIDTH / 32), (-WIDTH / 4, 0.0)),
    Grid((7, 9), (WIDTH / 5, WIDTH / 5), (1e-5, 0.0)),
    Grid((1, 1), (WIDTH, WIDTH), (0.0, WIDTH / 3)),
]


def distance_at(number):
    return (WIDTH / 2) ** 2 / (WAVELENGTH * number)


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def both(shape, grid, distance):
    wanted = near_field(shape, grid, distance, WAVELENGTH, "reference").amplitude
    found = near_field(shape, grid, distance, WAVELENGTH, "polygons")
    assert found.grid == grid
    assert found.amplitude.dtype == np.complex64
    assert found.amplitude.shape == grid.shape
    return found.amplitude, wanted


@pytest.mark.parametrize("kind", list(SHAPES))
@pytest.mark.parametrize("number", NUMBERS)
def test_edges_in_closed_form(kind, number):
    for grid in GRIDS if number < 1000 else [Grid((3, 3), (WIDTH / 4, WIDTH / 4)), GRIDS[-1]]:
        found, wanted = both(SHAPES[kind], grid, distance_at(number))
        np.testing.assert_allclose(found, wanted, rtol=0, atol=ABSOLUTE)


@pytest.mark.parametrize("kind", ["heptagon", "whirl"])
@pytest.mark.parametrize("number", [0.1, 3.0, 30.0, 1000.0])
def test_random_places(kind, number):
    """At 200 places of a plane twice as wide the error is below 1e-5 of the mean."""
    shape = SHAPES["heptagon"] if kind == "heptagon" else aperture.whirl(WIDTH)
    random = np.random.default_rng(7)
    errors, sizes = [], []
    for y, x, step in random.uniform(0, 1, (10 if number < 100 else 1, 3)) * (WIDTH, WIDTH, WIDTH / 4):
        grid = Grid((4, 5), (step, step), (y - WIDTH / 2, x - WIDTH / 2))
        found, wanted = both(shape, grid, distance_at(number))
        errors.append(np.abs(found - wanted).max())
        sizes.append(np.abs(wanted).mean())
    assert max(errors) < 1e-5 * np.mean(sizes)


@pytest.mark.parametrize("shape", [SHAPES["heptagon"], aperture.circle(WIDTH), aperture.whirl(WIDTH)])
@pytest.mark.parametrize("number", [0.1, 1.0, 10.0, 100.0])
def test_the_irradiance_to_4e_6_of_its_mean(shape, number):
    """At 200 places of a plane twice as wide, float32's last digits among them."""
    y, x = np.random.default_rng(3).uniform(-1e-4, 1e-4, 2)
    grid = Grid((10, 20), (2 * WIDTH / 10, 2 * WIDTH / 20), (y, x))
    wanted, found = (
        near_power(shape, grid, distance_at(number), WAVELENGTH, method)
        for method in ("reference", "polygons")
    )
    assert np.abs(found - wanted).max() < 4e-6 * wanted.mean()


@pytest.mark.parametrize("number", [0.3, 20.0, 5e3, 1e6])
@pytest.mark.parametrize("turn", [0.0, 1e-17, 1e-12, 0.3])
def test_on_corners_and_edges_the_field_is_continuous(number, turn):
    """A step of 1e-9 of the width changes nothing, whichever side of an edge a place lies on."""
    distance = distance_at(number)
    shape = aperture.rotated(aperture.rectangle(WIDTH, WIDTH), turn)
    (corner, other) = shape.outlines[0].vertices[:2]
    for part in (0.0, 0.25, 0.999, 1.0, 1.5):
        x, y = corner + part * (other - corner)
        values = [
            near_field(
                shape, Grid((1, 1), (1.0, 1.0), (y + dy, x + dx)), distance, WAVELENGTH, "polygons"
            ).amplitude[0, 0]
            for dx in (-1e-12, 0, 1e-12)
            for dy in (-1e-12, 0, 1e-12)
        ]
        np.testing.assert_allclose(values, values[4], rtol=0, atol=1e-6 + 1e-5 * math.sqrt(number) / 1e3)


def test_no_number_makes_a_field_that_is_none():
    for distance in (5e-324, 1e-200, 1e-9, 1e9, 1e300):
        for wavelength in (5e-324, 1e-100, 5e-7, 1e300):
            for spacing in (1e-300, 1e-4, 1e150):
                grid = Grid((3, 4), (spacing, spacing), (0.0, WIDTH / 2))
                field = near_field(SHAPES["frame"], grid, distance, wavelength, "polygons").amplitude
                assert np.isfinite(field).all(), (distance, wavelength, spacing)
                assert np.abs(field).max() < 3


def test_close_behind_is_the_shadow():
    grid = Grid((9, 9), (WIDTH / 5, WIDTH / 5), (1e-5, 2e-5))
    found = near_field(SHAPES["two greys"], grid, 1e-12, WAVELENGTH, "polygons").amplitude
    y, x = grid.axes()
    inside = (np.abs(y)[:, None] < WIDTH / 8) & (np.abs(x) < WIDTH / 2)
    assert np.abs(found[inside] - 1).max() < 1e-4
    assert np.abs(found[np.hypot(y[:, None], x) > 0.8 * WIDTH]).max() < 1e-4


def test_corners_that_stand_twice_do_not_count():
    points = SHAPES["heptagon"].outlines[0].vertices
    doubled = Aperture(WIDTH, (Outline(np.repeat(points, 2, axis=0), np.zeros(14)),))
    grid = Grid((4, 5), (2e-4, 2e-4))
    wanted = near_field(SHAPES["heptagon"], grid, 0.1, WAVELENGTH, "polygons").amplitude
    found = near_field(doubled, grid, 0.1, WAVELENGTH, "polygons").amplitude
    np.testing.assert_allclose(found, wanted, rtol=0, atol=ABSOLUTE)


def test_rasters_are_refused():
    with refused("method 'polygons' needs outlines and this aperture is a raster; use 'rows'."):
        raster = aperture.from_mask(np.ones((2, 2)), WIDTH)
        near_field(raster, GRIDS[0], 0.1, WAVELENGTH, "polygons")
