"""Scandolo, Lee, Eisemann 2018, sections 4.3 and 6: changes alone, lamps behind bars, lashes, cropped eyes.

Times stand in benchmarks/; here is what the text and the captions say of the pictures and the quads.
"""

import math

import numpy as np
import pytest

from aureole import Grid, aperture, diffraction, glare
from aureole.diffraction import quadtree
from aureole.records import Aperture

SIZE = 1024
OPENINGS = {"circle": aperture.circle(1.0), "heptagon": aperture.iris(7, 1.0), "whirl": aperture.whirl(1.0)}


def quads(mask):
    """Quads of a raster that changes, its positive and negative parts apart (section 4.3)."""
    parts = (np.maximum(mask, 0), np.maximum(-mask, 0))
    return sum(len(quadtree(part, 1.0, merge=True)) for part in parts if part.any())


@pytest.mark.parametrize("name", OPENINGS)
def test_section_5_1_a_shadow_that_moves_by_5_pixels_leaves_10_to_20_percent_of_the_quads(name):
    """«The number of quads are reduced roughly down to 10-20 %»; the shadow's size is not printed."""
    whole = np.round(aperture.rasterize(Aperture(1.0, OPENINGS[name].outlines), SIZE))
    y, x = np.ogrid[:SIZE, :SIZE]
    before, after = (whole * ((x - 500 - 5 * k) ** 2 + (y - 512) ** 2 > 50**2) for k in range(2))
    part = quads(after - before) / quads(after)
    assert 0.05 < part < 0.3


# A lamp of 0.1 m, 20 m away, seen by 85 mm at f/8 past upright bars half a metre before the lens.
OPENING = aperture.iris(8, 85e-3 / 8, rotation=math.radians(22.5 / 2))
CAMERA = glare.camera(85e-3, 8, OPENING, 36e-3, 20.25e-3, (90, 160))
LAMP = glare.AreaLight(aperture.circle(0.1 / 20), (0.0, 0.0), 20.0)


def seen(*occluders):
    """The lamp's spread at so many columns to each side of its middle."""
    return glare.area_psf(CAMERA, LAMP, occluders, (65, 65), across=3)


def along_rows(psf):
    """Share of the light outside the core that lies within 20 degrees of the horizontal line through it."""
    light = psf[..., 1].astype(np.float64)
    y, x = np.ogrid[-32:33, -32:33]
    far = np.hypot(x, y) > 4
    flat = np.abs(y) < math.tan(math.radians(20)) * np.abs(x)
    return light[far & flat].sum() / light[far].sum()


def test_figure_13_glare_changes_its_shape_with_what_is_seen():
    """(a) varies with the visibility; (b), static, only its intensity does."""
    bars = aperture.occluder(aperture.railing(3e-3, 4e-3, 31, 1.0), 0.5)
    free, behind = seen(), seen(bars)
    assert free.visible == pytest.approx(1, abs=1e-6)
    assert behind.visible == pytest.approx(4 / 7, abs=0.1)
    # Light past upright bars goes across them.
    assert along_rows(behind.psf.pixels) > 1.5 * along_rows(free.psf.pixels)
    static = free.psf.pixels * behind.visible
    static[32, 32] = behind.psf.pixels[32, 32]
    assert np.abs(behind.psf.pixels - static).sum() > 0.3 * (static.sum() - static[32, 32].sum())


def test_figure_14_upright_lashes_spread_light_sideways():
    lashes = aperture.eyelashes(aperture.circle(3e-3), 256, 8, seed=1)
    grid = Grid((65, 65), (2e3, 2e3))
    clean, hairy = (
        diffraction.far_power(each, grid)[..., None].repeat(3, axis=2)
        for each in (aperture.circle(3e-3), lashes)
    )
    assert along_rows(hairy) > 1.5 * along_rows(clean)


def test_figure_15_a_cropped_opening_rings_along_both_edges():
    """Behind each edge that is nearly straight the first fringe is 1.37 times as bright as the free wave."""
    eye = aperture.cats_eye(aperture.circle(4e-3), 4.4e-3, (2e-3, 0.0))
    distance, wavelength = 2e-3, 550e-9
    grid = Grid((1, 4001), (1e-6, 1e-6))
    power = diffraction.near_power(eye, grid, distance, wavelength)[0]
    x = grid.axes()[1]
    # Its ends on the axis: the rim's left edge, 2 - 2.2 mm, and the opening's right one, 2 mm.
    left, right = -0.2e-3, 2e-3
    fringe = 1.217 * math.sqrt(wavelength * distance / 2)
    for edge, way in ((left, 1), (right, -1)):
        near = power[np.abs(x - edge - way * fringe) < 0.2 * fringe]
        assert near.max() == pytest.approx(1.37, abs=0.08)
