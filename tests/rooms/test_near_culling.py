"""Culling the near field leaves out what is dark, and nothing else."""

import re

import numpy as np
import pytest

from aureole import Aperture, Grid, aperture, refuse
from aureole.diffraction import NearOperator, near_power

WIDTH = 2e-3
WAVELENGTH = 550e-9
SHAPES = {
    "heptagon": aperture.rasterize(aperture.iris(7, WIDTH), 256),
    "circle": aperture.rasterize(aperture.circle(WIDTH), 256),
    "whirl": aperture.rasterize(aperture.whirl(WIDTH, 5), 256),
    "aside": np.pad(np.ones((40, 30)), ((16, 200), (200, 26))),
}
PLANES = [
    Grid((512, 512), (4 * WIDTH / 512, 4 * WIDTH / 512)),
    Grid((513, 400), (4 * WIDTH / 512, 5 * WIDTH / 512)),
    Grid((512, 450), (4 * WIDTH / 512, 5 * WIDTH / 512), (0.0, 0.7 * WIDTH)),
    Grid((500, 450), (4 * WIDTH / 512, 5 * WIDTH / 512), (-0.9 * WIDTH, 0.7 * WIDTH)),
]


def distance_at(number):
    return (WIDTH / 2) ** 2 / (WAVELENGTH * number)


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


@pytest.mark.parametrize("kind", list(SHAPES))
@pytest.mark.parametrize("grid", PLANES)
def test_what_is_above_the_level_is_kept_and_the_rest_is_right_or_zero(kind, grid):
    shape = aperture.from_mask(SHAPES[kind], WIDTH)
    for number in (20, 100, 1000):
        whole = near_power(shape, grid, distance_at(number), WAVELENGTH, "rows")
        for level in (1e-2, 1e-3):
            culled = near_power(shape, grid, distance_at(number), WAVELENGTH, "rows", cull=level)
            assert culled.dtype == np.float32
            kept = culled > 0
            assert np.all(kept[whole > level])
            np.testing.assert_allclose(culled[kept], whole[kept], rtol=0, atol=2e-6)


@pytest.mark.parametrize("method", ["rows", "quads", "auto"])
def test_most_of_a_wide_plane_close_behind_is_left_out(method):
    shape = aperture.from_mask(SHAPES["heptagon"], WIDTH)
    culled = near_power(shape, PLANES[0], distance_at(1000), WAVELENGTH, method, cull=1e-3)
    assert np.count_nonzero(culled) < 0.4 * culled.size


def test_nothing_is_left_out_where_it_would_not_pay():
    shape = aperture.from_mask(SHAPES["heptagon"], WIDTH)
    grid = Grid((200, 200), (WIDTH / 200, WIDTH / 200))
    whole = near_power(shape, grid, distance_at(30), WAVELENGTH, "rows")
    np.testing.assert_array_equal(
        near_power(shape, grid, distance_at(30), WAVELENGTH, "rows", cull=1e-3), whole
    )
    dark = Aperture(WIDTH, mask=np.zeros((8, 8), dtype=np.float32))
    assert not near_power(dark, grid, 0.1, WAVELENGTH, "rows", cull=1e-3).any()


def test_methods_that_compute_every_place_refuse_to_cull():
    shape = aperture.from_mask(SHAPES["heptagon"], WIDTH)
    grid = Grid((20, 20), (WIDTH / 256, WIDTH / 256))
    bent = Aperture(WIDTH, mask=shape.mask, wavefront=np.zeros((256, 256), dtype=np.float32))
    for method, opening in (("reference", shape), ("fft", shape), ("rows", bent)):
        with refused(f"method '{method}' computes every place of this aperture and cannot cull; use 'auto'."):
            near_power(opening, grid, 0.1, WAVELENGTH, method, cull=1e-3)
    assert near_power(bent, grid, 0.1, WAVELENGTH, cull=1e-3).all()


def test_a_level_outside_its_range_is_refused():
    operator = NearOperator(aperture.from_mask(SHAPES["circle"], WIDTH), PLANES[0])
    for level in (-0.5, 1.0, 2):
        with refused(f"'cull' must be a level above 0 and below 1 of the peak, got {level:g}."):
            operator.power(0.1, WAVELENGTH, cull=level)
