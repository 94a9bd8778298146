"""Laws of the near field: closed forms, symmetries, conservation, and its far limit."""

import math

import numpy as np
import pytest
from scipy import special

from aureole import Grid, aperture
from aureole.diffraction import _kernels_near, far_field, near_field
from aureole.diffraction.fresnel import decay_polynomial, fresnel_integrals
from aureole.diffraction.near import METHODS

WAVELENGTH = 550e-9
D = 2e-3  # metres, of every opening here
OF_PIXELS = pytest.mark.parametrize("method", [name for name in METHODS if name not in ("polygons", "fft")])
FLOAT32 = 2e-6


def at(fresnel_number, width=D):
    """Return the distance at which (width / 2)² / (λz) is this."""
    return (width / 2) ** 2 / (WAVELENGTH * fresnel_number)


def plane(shape, extent, centre=(0.0, 0.0)):
    return Grid(shape, (extent / shape[0], extent / shape[1]), centre)


def field(shape, grid, distance, method="rows", raster_size=64):
    return near_field(shape, grid, distance, WAVELENGTH, method, raster_size).amplitude.astype(complex)


def between(low, high, places, distance):
    """∫ exp(iπ(x − x')²/(λz)) dx over an interval, over √(λz/2): Fresnel integrals at its ends."""
    scale = math.sqrt(2 / (WAVELENGTH * distance))
    (s0, c0), (s1, c1) = (special.fresnel(scale * (end - places)) for end in (low, high))
    return c1 - c0 + 1j * (s1 - s0)


def square(width):
    """A raster of one pixel: an opening as large as one likes, for every method of pixels."""
    return aperture.from_mask(np.ones((1, 1)), width)


def pixels(shape, size=64):
    return aperture.from_mask(aperture.rasterize(shape, size), shape.width)


def mask(size=40, seed=1):
    return np.random.default_rng(seed).random((size, size))


@pytest.mark.parametrize("number", [0.01, 7.0, 300.0])
@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.3e-3, -1.1e-3), (5e-3, 0.0)])
@OF_PIXELS
def test_rectangle(method, centre, number):
    """D = −i/2 (E(y₁) − E(y₀)) (E(x₁) − E(x₀)), E = C + iS (Goodman, Introduction to Fourier Optics)."""
    grid, distance = plane((30, 33), 2 * D, centre), at(number)
    y, x = grid.axes()
    along_y, along_x = between(-D / 4, D / 4, y, distance), between(-D / 2, D / 2, x, distance)
    wanted = -0.5j * along_y[:, None] * along_x
    found = field(pixels(aperture.rectangle(D, D / 2)), grid, distance, method)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-6)


@OF_PIXELS
def test_the_integral_itself(method):
    """Brute force: 40 Gauss-Legendre nodes a pixel and axis, for grey pixels."""
    values, distance = mask(5), at(4.0)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    pixel = D / 5
    starts = (np.arange(5) + 0.5) * pixel - D / 2
    points = (starts[:, None] + 0.5 * pixel * nodes).ravel()
    sizes = np.tile(0.5 * pixel * weights, 5)
    spread = np.kron(values, np.ones((40, 40)))
    grid = plane((4, 5), 1.5 * D, (0.1e-3, 0.0))
    y, x = grid.axes()
    rate = 1j * np.pi / (WAVELENGTH * distance)
    along_y, along_x = (sizes * np.exp(rate * (points - axis[:, None]) ** 2) for axis in (y, x))
    wanted = along_y @ spread @ along_x.T / (1j * WAVELENGTH * distance)
    found = field(aperture.from_mask(values, D), grid, distance, method)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=FLOAT32)


@OF_PIXELS
def test_half_plane(method):
    """Intensity 1/4 at the edge, and the maxima and minima of Cornu's spiral beside it."""
    wide, distance = 1000.0, 0.5
    unit = math.sqrt(WAVELENGTH * distance / 2)
    grid = Grid((1, 801), (unit, unit * 0.005), (0.0, wide / 2 - 2 * unit))
    power = np.abs(field(square(wide), grid, distance, method)[0]) ** 2
    inside = (wide / 2 - grid.axes()[1]) / unit
    assert np.interp(0.0, inside[::-1], power[::-1]) == pytest.approx(0.25, abs=1e-4)
    most = int(np.argmax(power))
    assert power[most] == pytest.approx(1.370, abs=1e-3)
    assert inside[most] == pytest.approx(1.217, abs=4e-3)
    # Fringes run on inside; the shadow darkens evenly.
    assert np.all(np.diff(power[inside < 0]) < 0)
    least = int(np.argmin(np.where((inside > 1.5) & (inside < 2.2), power, 9)))
    assert power[least] == pytest.approx(0.778, abs=1e-3)


@OF_PIXELS
@pytest.mark.parametrize("distance", [1e-3, 1.0, 1e3])
def test_where_nothing_blocks_the_wave(method, distance):
    found = field(square(1e6), plane((6, 7), 1.0), distance, method)
    np.testing.assert_allclose(found, 1.0, rtol=0, atol=5e-6)


@OF_PIXELS
@pytest.mark.parametrize("number", [1e-6, 1e-7])
def test_far_limit(method, number):
    """D → exp(iπ|x'|²/(λz)) F(x'/(λz)) / (iλz)."""
    distance = at(number)
    shape = aperture.from_mask(mask(), D)
    reach = WAVELENGTH * distance
    frequencies = Grid((20, 21), (0.7 / D, 0.9 / D), (1.3 / D, 0.0))
    grid = Grid((20, 21), (0.7 / D * reach, 0.9 / D * reach), (1.3 / D * reach, 0.0))
    y, x = grid.axes()
    phase = np.exp(1j * np.pi * (y[:, None] ** 2 + x**2) / reach)
    wanted = phase * far_field(shape, frequencies, "reference").amplitude / (1j * reach)
    found = field(shape, grid, distance, method)
    # What the limit leaves out is π N_F at most. Nearer to infinity float64 loses the phase itself.
    np.testing.assert_allclose(found, wanted, rtol=0, atol=(FLOAT32 + 4 * number) * np.abs(wanted).max())


@OF_PIXELS
@pytest.mark.parametrize("number", [1e-10, 1e-20])
def test_far_away_the_opening_counts_as_a_point(method, number):
    """|D| → ∬ f / (λz), a fraction of N_F or its root aside; "reference" keeps its digits at any distance."""
    shape, distance = aperture.from_mask(mask(), D), at(number)
    aside = math.sqrt(WAVELENGTH * distance)
    found = field(shape, Grid((1, 1), (D, D), (aside, -aside)), distance, method)[0, 0]
    wanted = np.sum(shape.mask, dtype=float) * (D / 40) ** 2 / (WAVELENGTH * distance)
    assert np.isfinite(found)
    if method == "reference":
        assert abs(found) / wanted == pytest.approx(1, rel=1e-9 + 4 * number)
    elif number >= 1e-10:
        assert abs(found) / wanted == pytest.approx(1, rel=FLOAT32 + 4 * number)


@OF_PIXELS
def test_babinet(method):
    """Two masks that fill a window together have fields that add up to the window's."""
    values = np.round(mask(33), 2)
    grid, distance = plane((24, 25), 1.5 * D, (0.0, 0.2e-3)), at(20.0)
    one, other, window = (
        field(aperture.from_mask(each, D), grid, distance, method)
        for each in (values, 1 - values, np.ones((33, 33)))
    )
    np.testing.assert_allclose(one + other, window, rtol=0, atol=2 * FLOAT32)
    assert np.abs(one).max() > 0.3


@OF_PIXELS
def test_an_opaque_square_leaves_what_the_wave_without_it_had(method):
    """Babinet with the whole wave: 1 minus the field of an opening of the same shape."""
    blocked = np.ones((301, 301))
    blocked[150, 150] = 0
    side = 301 * 0.2e-3
    grid, distance = plane((9, 9), 0.5e-3), 1e-3
    opening = field(square(0.2e-3), grid, distance, method)
    screen = field(aperture.from_mask(blocked, side), grid, distance, method)
    window = field(square(side), grid, distance, method)
    np.testing.assert_allclose(screen + opening, window, rtol=0, atol=2 * FLOAT32)
    np.testing.assert_allclose(window, 1, atol=1e-3)


@pytest.mark.parametrize("number", [0.5, 10.0])
def test_energy_through_a_large_plane_is_the_area(number):
    """The tails beyond ±X hold about 1/X of it: twice as large a plane loses half as much."""
    shape, distance = aperture.iris(7, D), at(number)
    area = float(np.sum(aperture.rasterize(shape, 64) ** 2)) * (D / 64) ** 2
    # |D|² holds no finer fringes than two waves from opposite edges make.
    spacing = 0.95 * WAVELENGTH * distance / D
    losses = []
    for factor in (1, 2):
        extent = factor * (4 * D + 60 * WAVELENGTH * distance / D)
        count = 2 * int(extent / spacing / 2) + 1
        power = np.abs(field(shape, Grid((count, count), (spacing, spacing)), distance)) ** 2
        losses.append(1 - power.sum() * spacing**2 / area)
    assert 0 < losses[1] < 0.6 * losses[0]
    assert losses[0] < 0.02


@OF_PIXELS
def test_an_opening_that_moves_takes_its_field_along(method):
    values = np.zeros((32, 32))
    values[4:14, 6:13] = mask(20)[:10, :7]
    moved = np.roll(values, (9, 12), (0, 1))
    pixel, distance = D / 32, at(30.0)
    here = plane((20, 21), D, (-0.1e-3, 0.2e-3))
    there = plane((20, 21), D, (-0.1e-3 + 9 * pixel, 0.2e-3 + 12 * pixel))
    one, other = (
        field(aperture.from_mask(each, D), grid, distance, method)
        for each, grid in ((values, here), (moved, there))
    )
    np.testing.assert_allclose(one, other, rtol=0, atol=FLOAT32)


@OF_PIXELS
def test_mirror_images(method):
    values, distance = mask(21), at(12.0)
    grid = plane((15, 17), 1.3 * D)
    whole = field(aperture.from_mask(values, D), grid, distance, method)
    turned = field(aperture.from_mask(values[::-1, ::-1], D), grid, distance, method)
    np.testing.assert_allclose(whole, turned[::-1, ::-1], rtol=0, atol=FLOAT32)
    transposed = field(aperture.from_mask(values.T, D), plane((17, 15), 1.3 * D), distance, method)
    assert transposed.shape == (17, 15)
    square = plane((16, 16), 1.3 * D)
    one, other = (field(aperture.from_mask(each, D), square, distance, method) for each in (values, values.T))
    np.testing.assert_allclose(one, other.T, rtol=0, atol=FLOAT32)


@OF_PIXELS
def test_similarity(method):
    """Lengths across k times, distance k² times: the same picture."""
    values = mask(16)
    near = field(aperture.from_mask(values, D), plane((12, 13), D), at(5.0), method)
    far = field(aperture.from_mask(values, 3 * D), plane((12, 13), 3 * D), 9 * at(5.0), method)
    np.testing.assert_allclose(near, far, rtol=0, atol=FLOAT32)


def test_close_behind_is_the_shadow():
    """At a Fresnel number of 10⁸ light goes straight on."""
    values = np.round(mask(8))
    grid = Grid((8, 8), (D / 8, D / 8), (D / 16, D / 16))
    for method in ("reference", "quads", "rows"):
        found = field(aperture.from_mask(values, D), grid, at(1e8), method)
        np.testing.assert_allclose(found, values, atol=2e-3)


def test_fresnel_integrals():
    dense = np.linspace(-12, 12, 20001)
    wide = np.concatenate([np.geomspace(1e-300, 1e8, 20001), [5.999999, 6.0, 6.000001, 1 / 128, 0.0]])
    for x in (dense, wide, -wide):
        sine, cosine = special.fresnel(x)
        c, s = fresnel_integrals(x)
        np.testing.assert_allclose(c, cosine, rtol=0, atol=1e-9)
        np.testing.assert_allclose(s, sine, rtol=0, atol=1e-9)
    inner = np.abs(dense) < 12
    c, s = fresnel_integrals(dense[inner])
    sine, cosine = special.fresnel(dense[inner])
    assert np.abs(c - cosine).max() < 2e-12
    assert np.abs(s - sine).max() < 2e-12


def test_one_polynomial_gives_the_fresnel_integrals_everywhere():
    for start, step in ((-30.0, 1e-3), (0.0, 1e-7), (-1e4, 0.37), (1e8, 1e9)):
        x = start + step * np.arange(60001)
        c, s = np.empty(len(x)), np.empty(len(x))
        _kernels_near.line_integrals(start, step, decay_polynomial(), c, s)
        sine, cosine = special.fresnel(x)
        # Far out float64 loses the phase, which matters as 1 / x.
        np.testing.assert_allclose(c, cosine, rtol=1e-8, atol=1e-10)
        np.testing.assert_allclose(s, sine, rtol=1e-8, atol=1e-10)


def test_fresnel_integrals_at_the_ends_of_the_numbers():
    x = np.array([np.inf, 1e9, 1e200, np.finfo(float).max, 5e-324, 0.0])
    for sign in (1, -1):
        c, s = fresnel_integrals(sign * x)
        np.testing.assert_allclose(c, sign * np.array([0.5, 0.5, 0.5, 0.5, 0, 0]), atol=1e-9)
        np.testing.assert_allclose(s, sign * np.array([0.5, 0.5, 0.5, 0.5, 0, 0]), atol=1e-9)
    assert fresnel_integrals(np.zeros((2, 3)))[0].shape == (2, 3)
    assert fresnel_integrals(1.0)[0] == pytest.approx(0.7798934, abs=1e-7)  # Abramowitz and Stegun, 7.7
    assert fresnel_integrals(1.0)[1] == pytest.approx(0.4382591, abs=1e-7)
