"""The circle's near field agrees with the reference on every kind of grid; no number makes it fail."""

import numpy as np
import pytest

from aureole import Grid, aperture
from aureole.aperture import Circle
from aureole.diffraction import near_field
from aureole.diffraction.near_circles import circle_near

WAVELENGTH = 550e-9
R = 1e-3
ABSOLUTE = 5e-7


@pytest.mark.parametrize("number", [0.05, 4.0, 9.0, 80.0])
@pytest.mark.parametrize("size", [(1, 1), (1, 12), (16, 16), (15, 9), (8, 1)])
@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.0, 0.31e-3), (-0.7e-3, 0.0), (1.1e-3, -3.3e-3)])
def test_grids(number, size, centre):
    grid = Grid(size, (R / 4, R / 7), centre)
    distance = R**2 / (WAVELENGTH * number)
    for x, y in ((0.0, 0.0), (0.31e-3, 0.0), (0.2e-3, -0.5e-3)):
        shape = aperture.moved(aperture.circle(2 * R), x, y)
        wanted = near_field(shape, grid, distance, WAVELENGTH, "reference").amplitude
        found = circle_near(Circle(x, y, R), grid, distance, WAVELENGTH)
        assert found.dtype == np.complex64
        assert found.shape == size
        np.testing.assert_allclose(found, wanted, rtol=0, atol=ABSOLUTE)


def test_no_number_makes_a_field_that_is_none():
    for radius in (1e-300, 1e-3, 1e100):
        for distance in (5e-324, 1e-200, 1e-9, 1e9, 1e300):
            for wavelength in (5e-324, 1e-100, 5e-7, 1e300):
                for spacing in (1e-300, 1e-4, 1e150):
                    for centre in ((0.0, 0.0), (0.0, R)):
                        grid = Grid((3, 4), (spacing, spacing), centre)
                        field = circle_near(Circle(0.0, 0.0, radius), grid, distance, wavelength)
                        assert np.isfinite(field).all(), (radius, distance, wavelength, spacing)
                        assert np.abs(field).max() < 3


def test_close_behind_is_the_shadow():
    grid = Grid((20, 21), (R / 7, R / 7), (R / 50, 0.0))
    y, x = grid.axes()
    distance = np.hypot(*np.meshgrid(y, x, indexing="ij"))
    clear = np.abs(distance - R) > 0.01 * R
    found = circle_near(Circle(0.0, 0.0, R), grid, R**2 / (WAVELENGTH * 1e9), WAVELENGTH)
    np.testing.assert_allclose(found[clear], distance[clear] < R, rtol=0, atol=2e-3)
