"""L. Scandolo, S. Lee, E. Eisemann, "Quad-based Fourier transform for efficient diffraction synthesis", 2018.

Table 1 counts the quads of four apertures at 256² to 4096². The shapes' exact sizes are not printed.
Here they fill half of the window, binary, and the tree starts at half the size, as the paper's does
(§6); then growth and order of magnitude are to agree.
"""

from functools import cache

import numpy as np
import pytest

from aureole import Grid, aperture
from aureole.bench import area_light
from aureole.diffraction import Quads, paint, quadtree
from aureole.diffraction.quads import box_factors, quads_field
from aureole.records import Aperture

SIZES = (256, 512, 1024, 2048, 4096)
# Table 1, as printed.
PRINTED = {
    "box": (40, 40, 40, 617, 617),
    "circle": (109, 227, 440, 981, 1976),
    "heptagon": (176, 389, 730, 1613, 2996),
    "whirl": (303, 647, 1358, 2673, 5278),
}
SHAPES = {
    # Edges that lie on pixels from 256² on.
    "box": aperture.rectangle(42 / 128, 42 / 128),
    "circle": aperture.circle(0.5),
    "heptagon": aperture.iris(7, 0.5),
    "whirl": aperture.whirl(0.5),
}
CURVED = [name for name in SHAPES if name != "box"]


@cache
def count(name, size):
    """Return the number of quads of a shape in a window of 1, on a binary mask of half the size."""
    mask = aperture.rasterize(Aperture(1.0, SHAPES[name].outlines), size // 2) >= 0.5
    quads = quadtree(mask, 1.0)
    np.testing.assert_array_equal(paint(quads, size // 2, 1.0), mask)
    return len(quads)


def test_table_1_the_box_stays():
    """40 at 256², 512² and 1024²: a shape whose edges lie on pixels has as many quads at every size."""
    counts = [count("box", size) for size in SIZES]
    assert len(set(counts)) == 1
    assert 1 < counts[0] < 3 * PRINTED["box"][0]


def test_table_1_the_box_jumps_where_its_edges_leave_the_pixels():
    """617 at 2048² and 4096²: the edge is resolved more finely, and many quads line it."""
    mask = aperture.rasterize(Aperture(1.0, SHAPES["box"].outlines), 1024) >= 0.5
    moved = np.roll(mask, (1, 1), axis=(0, 1))
    assert PRINTED["box"][3] / 3 < len(quadtree(moved, 1.0)) < PRINTED["box"][3] * 3


@pytest.mark.parametrize("name", CURVED)
def test_table_1_growth(name):
    """The boundary's length in pixels doubles with the size, and so does the count, from 512² on."""
    counts = [count(name, size) for size in SIZES[1:]]
    ratios = np.divide(counts[1:], counts[:-1])
    assert np.all((ratios > 1.8) & (ratios < 2.3)), counts
    printed = np.divide(PRINTED[name][2:], PRINTED[name][1:-1])
    assert np.exp(np.log(ratios).mean()) == pytest.approx(np.exp(np.log(printed).mean()), rel=0.05)


@pytest.mark.parametrize("name", CURVED)
@pytest.mark.parametrize("index", range(len(SIZES)))
def test_table_1_counts(name, index):
    printed = PRINTED[name][index]
    assert printed / 2 < count(name, SIZES[index]) < printed * 2


@pytest.mark.parametrize("size", SIZES)
def test_table_1_order_of_shapes(size):
    """The longer the boundary, the more quads."""
    assert count("box", size) < count("circle", size) < count("heptagon", size) < count("whirl", size)


@cache
def full(name, size):
    """Return the number of quads on a binary mask of the whole size, and whether they paint it again."""
    mask = aperture.rasterize(Aperture(1.0, SHAPES[name].outlines), size) >= 0.5
    quads = quadtree(mask, 1.0)
    return len(quads), np.array_equal(paint(quads, size, 1.0), mask)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("size", SIZES)
def test_table_1_up_to_4096_repaints_exactly(name, size):
    assert full(name, size)[1]


@pytest.mark.parametrize("name", CURVED)
def test_table_1_growth_up_to_4096(name):
    """Every doubling of the size, from 256² on, doubles the count about."""
    counts = [full(name, size)[0] for size in SIZES]
    ratios = np.divide(counts[1:], counts[:-1])
    assert np.all((ratios > 1.8) & (ratios < 2.3)), counts


def test_table_1_the_box_stays_up_to_4096():
    """Its edges lie on pixels at every size."""
    assert len({full("box", size)[0] for size in SIZES}) == 1


def test_section_6_quarter_size_takes_about_half_the_quads_of_half_size():
    """The paper's two levels, "half" and the more aggressive "quarter", on an anti-aliased mask."""
    mask = aperture.rasterize(Aperture(1.0, SHAPES["heptagon"].outlines), 1024)
    half, quarter = (len(quadtree(mask, 1.0, finest)) for finest in ("half", "quarter"))
    assert 1.8 < half / quarter < 2.3


def test_section_6_1_an_area_light_of_81_samples_takes_few_transforms():
    # The paper takes half of FFT's time, 31.9 ms for 63.4 ms; FFT takes 81 transforms.
    painted = area_light.masks("heptagon", "disc", 1024)
    assert len(painted) == 81
    total = area_light.by_method(painted, "modes", 0.01)
    found = total.result()
    assert total.transforms < 81 / 8
    apart = area_light.errors(found, area_light.with_pixels(area_light.by_transforms(painted)))
    assert apart["of_peak"] < 0.01
    assert apart["of_light"] <= total.estimated <= 0.01


def test_equation_11():
    """Γ(u) = s sinc(π u s) exp(−i 2π u c), sinc(x) = sin(x) / x; here by quadrature of the box itself."""
    c, s = 0.37, 0.81
    nodes, weights = np.polynomial.legendre.leggauss(60)
    x = c + s / 2 * nodes
    u = np.linspace(-9.0, 9.0, 41)
    integral = (np.exp(-2j * np.pi * np.outer(u, x)) * (weights * s / 2)).sum(axis=1)
    found = box_factors(np.array([[c - s / 2, c + s / 2]]), u)[0]
    np.testing.assert_allclose(found, integral, rtol=0, atol=1e-6 * s)


def test_equation_12():
    """W(u, v) = I Γ_x(u) Γ_y(v) of one quad."""
    quad = Quads(np.array([[0.1, -0.4, 0.7, -0.1]]), np.array([-0.6]))
    grid = Grid((12, 13), (0.5, 0.7), (1.0, -2.0))
    v, u = grid.axes()
    along_x = 0.6 * np.sinc(0.6 * u) * np.exp(-2j * np.pi * u * 0.4)
    along_y = 0.3 * np.sinc(0.3 * v) * np.exp(-2j * np.pi * v * -0.25)
    wanted = -0.6 * along_y[:, None] * along_x
    np.testing.assert_allclose(quads_field(quad, grid), wanted, rtol=0, atol=1e-6 * 0.6 * 0.18)


def test_equation_13():
    """A congruent quad displaced by d has the same transform times a phase."""
    box, d = np.array([0.1, -0.4, 0.7, -0.1]), np.array([-0.45, 0.3])
    grid = Grid((12, 13), (0.5, 0.7))
    v, u = grid.axes()
    here, there = (quads_field(Quads(b[None], np.ones(1)), grid) for b in (box, box + np.tile(d, 2)))
    phase = np.exp(-2j * np.pi * (v[:, None] * d[1] + u * d[0]))
    np.testing.assert_allclose(there, here * phase, rtol=0, atol=1e-6 * 0.18)
