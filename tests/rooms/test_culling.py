"""Culling: what is left out lies below the level, what is above is whole, and it is off by default."""

import re

import numpy as np
import pytest

from aureole import Grid, aperture, refuse
from aureole.diffraction import culling, far, far_power
from aureole.diffraction.rows import factor, rows_power
from aureole.records import Aperture

WIDTH = 2e-3
ROUNDING = 5e-7
SHAPES = {
    "box": aperture.rectangle(WIDTH / 2, WIDTH / 2),
    "circle": aperture.circle(WIDTH),
    "heptagon": aperture.iris(7, WIDTH / 2),
    "whirl": aperture.whirl(WIDTH),
    # Streaks that run nearly along the axes slip through a lattice of samples.
    "leaning square": aperture.iris(4, WIDTH / 2, rotation=np.radians(47)),
    # Its transform is zero along the lines of many lattices.
    "diamond": aperture.iris(4, WIDTH / 2),
}
LEVELS = (1e-4, 1e-6, 1e-7, 1e-8)


def raster(name, size):
    return Aperture(WIDTH, mask=aperture.rasterize(Aperture(WIDTH, SHAPES[name].outlines), size))


def grid_of(shape, spacing, centre=(0.0, 0.0)):
    """Return a grid with spacing and centre in cycles per width."""
    return Grid(shape, (spacing / WIDTH,) * 2, tuple(each / WIDTH for each in centre))


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def check(shape, grid, level):
    """Hold culled against whole: the contract. Return the share of frequencies left at zero."""
    whole = rows_power(shape, grid).astype(np.float64)
    culled = far_power(shape, grid, "rows", cull=level)
    assert culled.dtype == np.float32
    area = aperture.area(shape)
    # Rounding where the power is high would exceed the lowest levels.
    assert np.all(np.abs(culled - whole) < level * area**2 + ROUNDING * whole)
    lit = culled > 0
    assert np.all(lit[whole > level * area**2])
    np.testing.assert_allclose(np.sqrt(culled[lit]), np.sqrt(whole[lit]), rtol=0, atol=ROUNDING * area)
    return 1 - lit.mean()


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize(("size", "count", "spacing"), [(256, 512, 1.0), (255, 511, 0.5), (200, 401, 0.25)])
def test_what_is_left_out_lies_below_the_level(name, level, size, count, spacing):
    left_out = check(raster(name, size), grid_of((count, count - 90), spacing), level)
    if level == LEVELS[0] and spacing == 1:
        assert left_out > 0.5


@pytest.mark.parametrize("name", ["heptagon", "whirl", "leaning square"])
@pytest.mark.parametrize("centre", [(0.0, 37.3), (-51.0, 0.0), (90.5, -70.25), (0.0, 900.0)])
def test_grids_off_the_centre(name, centre):
    shape = raster(name, 180)
    for level in LEVELS[1:3]:
        check(shape, grid_of((300, 257), 0.8, centre), level)


def test_an_opening_away_from_the_middle():
    """Its place is a phase ramp and no fringe: as much is left out as of the same opening in the middle."""
    mask = np.zeros((512, 512), dtype=np.float32)
    disc = aperture.rasterize(aperture.circle(WIDTH), 100)
    shares = []
    for corner in (206, 40):
        mask[:] = 0
        mask[corner : corner + 100, corner : corner + 100] = disc
        shares.append(check(Aperture(WIDTH, mask=mask.copy()), grid_of((512, 512), 1.0), 1e-4))
    assert shares[1] == pytest.approx(shares[0], abs=0.05)
    assert shares[0] > 0.2


@pytest.mark.parametrize("seed", range(3))
def test_noise(seed):
    rng = np.random.default_rng(seed)
    mask = rng.random((150, 150), dtype=np.float32)
    mask[rng.random(150) < 0.5] = 0
    assert check(Aperture(WIDTH, mask=mask), grid_of((300, 300), 1.0), 1e-3) > 0.3
    check(Aperture(WIDTH, mask=mask), grid_of((300, 300), 1.0), 1e-5)


def test_a_leaning_line_of_single_pixels():
    mask = np.zeros((128, 128), dtype=np.float32)
    mask[np.arange(128), np.arange(128) // 7] = 0.3
    for level in (1e-2, 1e-4):
        check(Aperture(WIDTH, mask=mask), grid_of((256, 256), 1.0), level)


def test_energy_lost_is_what_is_dark():
    shape, grid = raster("circle", 256), grid_of((512, 512), 1.0)
    whole = rows_power(shape, grid).sum(dtype=np.float64)
    lost = [1 - far_power(shape, grid, "rows", cull=level).sum(dtype=np.float64) / whole for level in LEVELS]
    assert lost == sorted(lost, reverse=True)
    # Outside the radius r in cycles a circle of diameter D has 2 / (π² r D) of its energy, and the level
    # 1e-4 is reached about r D = 7.
    assert lost[0] < 2 / (np.pi**2 * 7)


def test_off_by_default():
    shape, grid = raster("heptagon", 128), grid_of((400, 400), 1.0)
    for cull in (None, 0, 0.0):
        np.testing.assert_array_equal(far_power(shape, grid, "rows", cull=cull), rows_power(shape, grid))
    np.testing.assert_array_equal(far_power(shape, grid), far_power(shape, grid, cull=0))


def test_coarse_grids_are_computed_whole():
    shape, grid = raster("circle", 64), grid_of((200, 200), 3.0)
    assert culling.survey(shape, grid, 1e-4) is None
    np.testing.assert_array_equal(far_power(shape, grid, "rows", cull=1e-4), rows_power(shape, grid))


def test_a_dark_mask_has_no_power():
    dark = Aperture(WIDTH, mask=np.zeros((32, 32), dtype=np.float32))
    assert not far_power(dark, grid_of((100, 101), 1.0), cull=1e-6).any()
    assert not far_power(dark, grid_of((100, 101), 1.0), "rows", cull=1e-6).any()


@pytest.mark.parametrize("shape", [(1, 1), (1, 300), (2, 3), (64, 65), (130, 1)])
def test_any_shape_of_grid(shape):
    check(raster("whirl", 64), grid_of(shape, 0.9), 1e-5)


def test_factors_may_be_given():
    shape, grid = raster("whirl", 90), grid_of((256, 256), 1.0)
    found = culling.culled_power(shape, grid, 1e-5, factor(shape.mask))
    np.testing.assert_array_equal(found, culling.culled_power(shape, grid, 1e-5))


def test_the_share_is_that_of_the_lit_tiles():
    shape, grid = raster("circle", 128), grid_of((512, 512), 1.0)
    found = culling.survey(shape, grid, 1e-5)
    quarter = culling.evaluate(found, shape, grid)[256:, 256:]
    # A tile more at the far edge, of which the plane holds one side only.
    assert np.count_nonzero(quarter) / quarter.size == pytest.approx(found.share(), abs=0.02)
    assert 0 < found.share() < 0.5


def test_auto_culls_or_takes_the_fastest_whole_transform(monkeypatch):
    taken = []
    monkeypatch.setattr(culling, "evaluate", lambda *given: taken.append("culled"))
    for name in ("fft", "chirpz"):
        monkeypatch.setitem(far.POWERS, name, lambda a, g, n=name: taken.append(n))
    far_power(raster("heptagon", 512), grid_of((2048, 2048), 0.5), cull=1e-4)
    noise = np.random.default_rng(1).random((1024, 1024), dtype=np.float32)
    far_power(Aperture(WIDTH, mask=noise), grid_of((1024, 1024), 1.0), cull=1e-9)
    assert taken == ["culled", "fft"]


def test_outlines_are_computed_whole():
    """Exact edges cost little for each frequency: nothing is left out."""
    grid = grid_of((60, 61), 1.0)
    np.testing.assert_array_equal(
        far_power(SHAPES["heptagon"], grid, cull=1e-3), far_power(SHAPES["heptagon"], grid)
    )
    # By rows they are rasterized, as without culling.
    culled = far_power(SHAPES["heptagon"], grid, "rows", raster_size=64, cull=1e-3)
    whole = far_power(SHAPES["heptagon"], grid, "rows", raster_size=64)
    assert np.abs(culled - whole).max() < 1e-3 * whole.max()


@pytest.mark.parametrize("level", [1, 1.0, 2, -1e-6, 1e300])
def test_levels_refused(level):
    message = f"'cull' must be a level above 0 and below 1 of the peak, got {level:g}."
    with refused(message):
        far_power(raster("box", 16), grid_of((8, 8), 1.0), cull=level)
    with refused(message):
        culling.culled_power(raster("box", 16), grid_of((8, 8), 1.0), level)


@pytest.mark.parametrize("level", [np.nan, np.inf, "low"])
def test_levels_that_are_no_numbers_are_refused(level):
    with pytest.raises(refuse.Refusal, match=r"^'cull' must be a finite number, got "):
        far_power(raster("box", 16), grid_of((8, 8), 1.0), cull=level)


def test_methods_that_cannot_cull_are_refused():
    with refused("method 'fft' computes every frequency and cannot cull; use 'rows' or 'auto'."):
        far_power(raster("box", 16), grid_of((8, 8), 1.0), "fft", cull=1e-6)
    with pytest.raises(refuse.Refusal, match="needs a raster"):
        culling.culled_power(SHAPES["circle"], grid_of((8, 8), 1.0), 1e-6)
