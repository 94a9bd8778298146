"""Central obstructions, spiders and shadows: closed forms, areas, rays."""

import numpy as np
import pytest
from scipy.special import j1

from aureole import Grid, Refusal, aperture, diffraction

DIAMETER = 3e-3
CIRCLE = aperture.circle(DIAMETER)


def jinc_field(q, diameter):
    """D J1(πDq) / (2q), and the area at zero."""
    safe = np.where(q == 0, 1, q)
    return np.where(q == 0, np.pi * diameter**2 / 4, diameter * j1(np.pi * diameter * safe) / (2 * safe))


@pytest.mark.parametrize("ratio", [0.1, 0.4, 0.9])
def test_an_annulus_is_the_difference_of_two_circles(ratio):
    ring = aperture.obstruction(CIRCLE, ratio)
    grid = Grid((41, 40), (0.7 / DIAMETER, 0.7 / DIAMETER), (3 / DIAMETER, 0.0))
    v, u = grid.axes()
    q = np.hypot(v[:, None], u)
    wanted = jinc_field(q, DIAMETER) - jinc_field(q, ratio * DIAMETER)
    found = diffraction.far_field(ring, grid, "polygons").amplitude
    np.testing.assert_allclose(found, wanted, atol=2e-6 * aperture.area(CIRCLE))
    assert aperture.area(ring) == pytest.approx(np.pi / 4 * DIAMETER**2 * (1 - ratio**2), rel=1e-12)


def vanes_on_a_disc(count, part):
    """Area of vanes of breadth w on a disc: N times half a strip, what N of them share counted once."""
    half, radius = part / 2, 0.5
    strip = half * np.sqrt(radius**2 - half**2) + radius**2 * np.arcsin(half / radius)
    if count == 1:
        return strip
    # Neighbours meet on the line between them, at half / tan(π/N) along each vane.
    return count * (strip - half**2 / np.tan(np.pi / count))


@pytest.mark.parametrize("count", [1, 2, 3, 4, 6])
@pytest.mark.parametrize("rotation", [0.0, 0.4])
def test_vanes_take_their_area_and_energy_is_area(count, rotation):
    held = aperture.spiders(CIRCLE, count, 0.05 * DIAMETER, rotation)
    wanted = (np.pi / 4 - vanes_on_a_disc(count, 0.05)) * DIAMETER**2
    assert aperture.area(held) == pytest.approx(wanted, rel=1e-6)
    assert aperture.energy(held) == pytest.approx(wanted, rel=1e-6)
    assert held.name == f"circle with {count} vane{'s' if count > 1 else ''}"


def test_vanes_stand_where_they_are_put():
    mask = aperture.rasterize(aperture.spiders(CIRCLE, 1, 0.1 * DIAMETER, np.pi / 2), 65)
    # Upward as seen is the first row.
    assert mask[10, 32] == 0
    assert mask[50, 32] == 1
    turned = aperture.rasterize(aperture.spiders(CIRCLE, 3, 0.1 * DIAMETER), 65)
    assert turned[32, 55] == 0
    assert turned[32, 10] == 1


@pytest.mark.parametrize("shape", [CIRCLE, aperture.iris(7, DIAMETER), aperture.iris(6, DIAMETER, 0.5)])
def test_order_does_not_matter_and_outlines_stay_exact(shape):
    one = aperture.spiders(aperture.obstruction(shape, 0.3), 4, 0.02 * DIAMETER, 0.3)
    other = aperture.obstruction(aperture.spiders(shape, 4, 0.02 * DIAMETER, 0.3), 0.3)
    grid = Grid((30, 31), (1.7 / DIAMETER, 1.7 / DIAMETER))
    exact = diffraction.far_field(other, grid, "reference").amplitude
    for each in (one, other):
        assert each.mask is None
        found = diffraction.far_field(each, grid).amplitude
        np.testing.assert_allclose(found, exact, atol=1e-6 * aperture.area(one))


@pytest.mark.parametrize(("count", "rays"), [(3, 6), (4, 4), (6, 6)])
def test_vanes_draw_rays_across_themselves(count, rays):
    held = aperture.spiders(CIRCLE, count, 0.03 * DIAMETER, 0.2)
    angles = 2 * np.pi * np.arange(720) / 720
    at = 20.3 / DIAMETER
    power = np.array(
        [
            diffraction.far_power(held, Grid((1, 1), (1.0, 1.0), (-at * np.sin(t), at * np.cos(t))))[0, 0]
            for t in angles
        ]
    )
    bright = power > 0.3 * power.max()
    assert np.count_nonzero(bright & ~np.roll(bright, 1)) == rays
    across = 0.2 + np.pi / 2
    assert bright[round(across / (2 * np.pi) * 720)]


def test_a_shadow_takes_its_own_field_away_where_it_lies():
    x, y, across = 0.3e-3, -0.5e-3, 1e-3
    shaded = aperture.shadow(CIRCLE, x, y, across)
    grid = Grid((31, 32), (0.8 / DIAMETER, 0.6 / DIAMETER))
    v, u = grid.axes()
    q = np.hypot(v[:, None], u)
    turned = np.exp(-2j * np.pi * (u * x + v[:, None] * y))
    wanted = jinc_field(q, DIAMETER) - jinc_field(q, across) * turned
    found = diffraction.far_field(shaded, grid, "polygons").amplitude
    np.testing.assert_allclose(found, wanted, atol=2e-6 * aperture.area(CIRCLE))
    assert shaded.width == CIRCLE.width
    assert shaded.name == "circle in shadow"


def test_a_shadow_over_the_rim_takes_a_lens_and_one_beside_the_opening_nothing():
    # Two equal circles a radius apart share (2π/3 − √3/2) r².
    radius = DIAMETER / 2
    shared = (2 * np.pi / 3 - np.sqrt(3) / 2) * radius**2
    shaded = aperture.shadow(CIRCLE, radius, 0, DIAMETER)
    assert aperture.area(shaded) == pytest.approx(np.pi * radius**2 - shared, rel=1e-6)
    assert shaded.width == CIRCLE.width
    beside = aperture.shadow(CIRCLE, 2 * DIAMETER, 0, DIAMETER)
    assert aperture.area(beside) == pytest.approx(np.pi * radius**2, rel=1e-12)
    raster = aperture.from_mask(aperture.rasterize(CIRCLE, 256), DIAMETER)
    assert aperture.area(aperture.shadow(raster, radius, 0, DIAMETER)) == pytest.approx(
        np.pi * radius**2 - shared, rel=1e-3
    )


def test_rasters_are_obstructed_too():
    raster = aperture.from_mask(aperture.rasterize(CIRCLE, 256), DIAMETER)
    held = aperture.spiders(aperture.obstruction(raster, 0.3), 4, 0.05 * DIAMETER)
    exact = aperture.spiders(aperture.obstruction(CIRCLE, 0.3), 4, 0.05 * DIAMETER)
    assert aperture.area(held) == pytest.approx(aperture.area(exact), rel=1e-3)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: aperture.obstruction(CIRCLE, 0.0), "'obstruction' must be a finite number > 0, got 0."),
        (lambda: aperture.obstruction(CIRCLE, 1.0), "'obstruction' must be a number from 0 to 0.999, got 1."),
        (lambda: aperture.spiders(CIRCLE, 0, 1e-4), "'spiders' must be an integer >= 1, got 0."),
        (lambda: aperture.spiders(CIRCLE, 3, 0.0), "'spider width' must be a finite number > 0, got 0."),
        (lambda: aperture.spiders(CIRCLE, 3, 1e-4, np.nan), "'spider rotation' must be a finite number"),
        (lambda: aperture.spiders(CIRCLE, 2, 1.1 * DIAMETER), "lets no light through."),
        (lambda: aperture.shadow(CIRCLE, 0, 0, 0), "'shadow's diameter' must be a finite number > 0, got 0."),
        (lambda: aperture.shadow(CIRCLE, np.inf, 0, 1), "'x' must be a finite number"),
        (lambda: aperture.shadow(CIRCLE, 0, 0, 2 * DIAMETER), "lets no light through."),
    ],
)
def test_refusals(make, message):
    with pytest.raises(Refusal) as refused:
        make()
    assert message in str(refused.value)
