"""The far field of signed rectangles: any rectangles, any grid, shared sizes, sums in any order."""

import numpy as np
import pytest

from aureole import Grid
from aureole.diffraction import Quads, far_field, quadtree
from aureole.diffraction.quads import box_factors, quads_field, quads_power
from aureole.records import Aperture

WIDTH = 2e-3
RELATIVE = 5e-7  # of the sum of the magnitudes
GRIDS = [
    Grid((24, 24), (1 / WIDTH, 1 / WIDTH)),
    Grid((75, 40), (0.37 / WIDTH, 2.1 / WIDTH)),
    Grid((40, 17), (0.9 / WIDTH, 0.9 / WIDTH), (3.3 / WIDTH, 0.0)),
    Grid((13, 68), (0.9 / WIDTH, 0.4 / WIDTH), (0.0, -77.7 / WIDTH)),
    Grid((1, 35), (0.9 / WIDTH, 0.4 / WIDTH), (-1.1 / WIDTH, 500 / WIDTH)),
]


def summed(quads, grid):
    """Add up the quads one by one (Eq. 8 and 12)."""
    v, u = grid.axes()
    total = np.zeros(grid.shape, dtype=complex)
    for (x0, y0, x1, y1), weight in zip(quads.rectangles, quads.weights, strict=True):
        along_x = box_factors(np.array([[x0, x1]]), u)[0].astype(complex)
        along_y = box_factors(np.array([[y0, y1]]), v)[0].astype(complex)
        total += weight * along_y[:, None] * along_x
    return total


def check(quads, grid):
    x0, y0, x1, y1 = quads.rectangles.T
    most = np.sum(np.abs(quads.weights) * (x1 - x0) * (y1 - y0))
    wanted = summed(quads, grid)
    np.testing.assert_allclose(quads_field(quads, grid), wanted, rtol=0, atol=RELATIVE * most)
    power = quads_power(quads, grid)
    assert power.dtype == np.float32
    np.testing.assert_allclose(power, np.abs(wanted) ** 2, rtol=0, atol=2 * RELATIVE * most**2)


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("seed", range(3))
def test_rectangles_anywhere(grid, seed):
    """Overlapping, of both signs, off any raster, and beyond the square on one side."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-WIDTH, WIDTH / 4, (30, 2))
    sizes = rng.uniform(1e-3 * WIDTH, WIDTH / 2, (30, 2))
    check(Quads(np.hstack([corners, corners + sizes]), rng.normal(size=30)), grid)


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("size", [16, 21, 64])
def test_quads_of_masks(grid, size):
    rng = np.random.default_rng(size)
    for mask in (rng.random((size, size)), rng.random((size, size)) < 0.3):
        check(quadtree(mask, WIDTH), grid)


@pytest.mark.parametrize("grid", GRIDS)
def test_merged_quads_have_the_same_field(grid):
    mask = np.random.default_rng(7).random((40, 40)) < 0.6
    check(quadtree(mask, WIDTH, merge=True), grid)
    most = WIDTH**2
    one, other = (quads_field(quadtree(mask, WIDTH, merge=merge), grid) for merge in (False, True))
    np.testing.assert_allclose(one, other, rtol=0, atol=RELATIVE * most)


def test_mirror_images_cancel_in_the_odd_parts():
    """The transform of a mask mirrored along both axes is real; mirrored to its negative, imaginary."""
    half = (np.random.default_rng(5).random((32, 32)) < 0.4).astype(float)
    whole = np.vstack([half, half[::-1]])
    for mask, sign in ((np.hstack([whole, whole[:, ::-1]]), 1), (np.hstack([whole, -whole[:, ::-1]]), -1)):
        field = quads_field(quadtree(mask, WIDTH), GRIDS[0])
        none = field.imag if sign > 0 else field.real
        assert np.abs(none).max() < 1e-6 * np.abs(field).max()
        check(quadtree(mask, WIDTH), GRIDS[0])


def test_narrow_quads_sum_to_their_strip():
    """Many congruent quads side by side are one long quad."""
    edges = np.linspace(-WIDTH / 3, WIDTH / 2, 201)
    strips = np.stack([edges[:-1], np.full(200, -1e-4), edges[1:], np.full(200, 2e-4)], axis=1)
    one = Quads(np.array([[edges[0], -1e-4, edges[-1], 2e-4]]), np.ones(1))
    for grid in GRIDS:
        found = quads_field(Quads(strips, np.ones(200)), grid)
        np.testing.assert_allclose(found, quads_field(one, grid), rtol=0, atol=1e-6 * 3e-4 * WIDTH)


def test_a_photograph():
    """As many quads as pixels: slower than a transform of the pixels, and as right."""
    noise = np.random.default_rng(3).random((512, 512), dtype=np.float32)
    grid = Grid((64, 63), (1.3 / WIDTH, 0.7 / WIDTH), (0.0, 5 / WIDTH))
    found = quads_field(quadtree(noise, WIDTH), grid)
    wanted = far_field(Aperture(WIDTH, mask=noise), grid, "reference").amplitude
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-6 * WIDTH**2)
    automatic = far_field(Aperture(WIDTH, mask=noise), grid).amplitude
    np.testing.assert_allclose(automatic, wanted, rtol=0, atol=1e-6 * WIDTH**2)


def test_no_quads_no_field():
    none = Quads(np.zeros((0, 4)), np.zeros(0))
    for grid in GRIDS:
        assert not quads_field(none, grid).any()
        assert not quads_power(none, grid).any()


def test_quads_that_cancel_leave_nothing():
    box = np.array([-1e-4, -3e-4, 2e-4, 1e-4])
    pair = Quads(np.stack([box, box]), np.array([0.7, -0.7]))
    assert not quads_field(pair, GRIDS[1]).any()
