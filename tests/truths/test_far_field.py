"""Laws of the far field: closed forms, symmetries, conservation, and how it falls off."""

import math

import numpy as np
import pytest
from scipy import special

from aureole import Grid, aperture
from aureole.diffraction import METHODS, far_field

D = 3e-3  # metres, of every opening here
EVERY = list(METHODS)
OF_OUTLINES = ["reference", "polygons"]
SHAPES = {
    "circle": aperture.circle(D),
    "heptagon": aperture.iris(7, D, rotation=0.2),
    "rounded": aperture.iris(6, D, 0.5, 0.1),
    "whirl": aperture.whirl(D, 5),
    "ring": aperture.subtraction(aperture.circle(D), aperture.iris(5, 0.4 * D)),
    "off": aperture.polygon(np.array([(0.1, 0.2), (0.5, -0.3), (0.3, 0.45)]) * D),
}
ON_SHAPES = pytest.mark.parametrize("name", list(SHAPES))


def frequencies(shape, spacing, centre=(0.0, 0.0)):
    """Return a grid in cycles per D."""
    return Grid(shape, (spacing / D, spacing / D), (centre[0] / D, centre[1] / D))


def amplitude(shape, grid, method="polygons"):
    return far_field(shape, grid, method).amplitude.astype(np.complex128)


def radius_of(grid):
    v, u = grid.axes()
    return np.hypot(v[:, None], u)


def bessel_j1(x):
    """J1 by Bessel's integral, (1 / π) ∫ cos(τ − x sin τ) dτ, which the trapezium rule does exactly."""
    tau = (np.arange(400) + 0.5) * math.pi / 400
    return np.mean(np.cos(tau - np.asarray(x)[..., None] * np.sin(tau)), axis=-1)


def airy_amplitude(diameter, q):
    """F(q) = D J1(π D q) / (2 q), π D² / 4 at the origin."""
    safe = np.where(q == 0, 1.0, q)
    return np.where(
        q == 0, math.pi * diameter**2 / 4, diameter * bessel_j1(math.pi * diameter * safe) / (2 * safe)
    )


@pytest.mark.parametrize("method", OF_OUTLINES)
@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("centre", [(0.0, 0.0), (13.2, -28.9)])
def test_airy(method, curved, centre):
    """The circle, and the iris whose blades are bent to it."""
    shape = aperture.iris(5, D, 1.0, 0.3) if curved else aperture.circle(D)
    grid = frequencies((24, 25), 0.7, centre)
    wanted = airy_amplitude(D, radius_of(grid))
    found = amplitude(shape, grid, method)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=3e-7 * aperture.area(shape))


@pytest.mark.parametrize("shape", [aperture.circle(D), aperture.iris(8, D, 1.0)], ids=["circle", "iris"])
@pytest.mark.parametrize(("ring", "zero"), [(1, 1.2197), (2, 2.2331), (3, 3.2383)])
def test_airy_dark_rings(shape, ring, zero):
    """Zeros of J1(π x): 1.2197, 2.2331, 3.2383 λN (Born and Wolf, Principles of Optics, Table 8.2)."""
    line = frequencies((1, 401), 5e-5, (0.0, zero))
    values = amplitude(shape, line)[0].real
    crossing = np.flatnonzero(np.diff(np.sign(values)))
    assert len(crossing) == 1
    assert line.axes()[1][crossing[0]] * D == pytest.approx(zero, abs=1e-4)


@pytest.mark.parametrize("method", OF_OUTLINES)
@pytest.mark.parametrize(("width", "height"), [(1.0, 1.0), (1.0, 0.3), (0.02, 1.0), (1.0, 1e-5)])
@pytest.mark.parametrize("spacing", [0.61, 0.03, 1e-4])
def test_slits_and_rectangles(method, width, height, spacing):
    """A product of sincs, also where a thin slit's own scale is far from its length's."""
    grid = frequencies((17, 16), spacing, (0.3, -1.0) if spacing > 0.1 else (0.0, 0.0))
    v, u = grid.axes()
    wanted = width * height * D**2 * np.sinc(v * height * D)[:, None] * np.sinc(u * width * D)
    found = amplitude(aperture.rectangle(width * D, height * D), grid, method)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=3e-7 * width * height * D**2)


@pytest.mark.parametrize("method", EVERY)
def test_a_rectangle_of_whole_pixels_by_every_method(method):
    """On frequencies that the FFT of 16 pixels, padded to 32, has."""
    mask = np.zeros((16, 16))
    mask[4:12, 6:10] = 1
    shape = aperture.rectangle(D / 4, D / 2) if method == "polygons" else aperture.from_mask(mask, D)
    grid = frequencies((33, 32), 0.5)
    v, u = grid.axes()
    wanted = D**2 / 8 * np.sinc(v * D / 2)[:, None] * np.sinc(u * D / 4)
    np.testing.assert_allclose(amplitude(shape, grid, method), wanted, rtol=0, atol=1e-6 * D**2 / 8)


@ON_SHAPES
@pytest.mark.parametrize("method", EVERY)
def test_the_origin_holds_the_area(name, method):
    shape = SHAPES[name]
    grid = Grid((3, 3), (1 / shape.width, 1 / shape.width))
    found = far_field(shape, grid, method, raster_size=256).amplitude[1, 1]
    # A raster's arcs stray by 1e-4 of a pixel.
    tolerance = 1e-6 if method in OF_OUTLINES else 1e-5
    assert found == pytest.approx(aperture.area(shape), rel=tolerance)


@pytest.mark.parametrize("size", [1e-1, 1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("curvature", [0.0, 0.7])
@pytest.mark.parametrize("method", OF_OUTLINES)
def test_a_small_opening_far_off_the_axis(size, curvature, method):
    """Shift is phase, though the opening itself is a speck: |q| from zero to where it is a speck."""
    iris = aperture.iris(5, size * D, curvature, 0.2)
    x, y = 0.45 * D, -0.3 * D
    for spacing in (0.003, 0.05, 0.9):
        grid = frequencies((15, 15), spacing)
        v, u = grid.axes()
        wanted = amplitude(iris, grid, "reference") * np.exp(-2j * np.pi * (v[:, None] * y + u * x))
        found = amplitude(aperture.moved(iris, x, y), grid, method)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-6 * aperture.area(iris))


@ON_SHAPES
@pytest.mark.parametrize("spacing", [1e-6, 3e-5, 3e-4, 3e-3, 0.03])
def test_near_the_origin(name, spacing):
    """The quotient by |q|² hands over to a series without a seam: F(q) = F(0) (1 − i2π q·c − ...)."""
    shape, grid = SHAPES[name], frequencies((12, 13), spacing)
    found = amplitude(shape, grid)
    np.testing.assert_allclose(
        found, amplitude(shape, grid, "reference"), rtol=0, atol=2e-7 * aperture.area(shape)
    )
    v, u = grid.axes()
    area, first, second = (
        sum(
            ring.transmittance * aperture.orientation(ring) * np.asarray(aperture.ring_moments(ring)[order])
            for ring in shape.outlines
        )
        for order in range(3)
    )
    linear = u * first[0] + v[:, None] * first[1]
    square = u**2 * second[0, 0] + 2 * u * v[:, None] * second[0, 1] + v[:, None] ** 2 * second[1, 1]
    series = area - 2j * math.pi * linear - 2 * math.pi**2 * square
    # The next term is at most (2π |q| D / √2)³ / 6 of the area.
    rest = (math.pi * math.sqrt(2) * radius_of(grid).max() * D) ** 3 / 6
    np.testing.assert_allclose(found, series, rtol=0, atol=(2e-7 + rest) * area)


@ON_SHAPES
def test_shift_is_phase(name):
    shape, (x, y) = SHAPES[name], (0.31 * D, -0.77 * D)
    grid = frequencies((21, 20), 0.4, (1.0, -2.0))
    v, u = grid.axes()
    wanted = amplitude(shape, grid) * np.exp(-2j * np.pi * (v[:, None] * y + u * x))
    found = amplitude(aperture.moved(shape, x, y), grid)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=5e-7 * aperture.area(shape))


@ON_SHAPES
@pytest.mark.parametrize("factor", [0.25, 3.0])
def test_similarity(name, factor):
    """F of a shape s times larger at q / s is s² times F at q."""
    shape = SHAPES[name]
    found = amplitude(aperture.scaled(shape, factor), frequencies((16, 17), 0.6 / factor))
    wanted = factor**2 * amplitude(shape, frequencies((16, 17), 0.6))
    np.testing.assert_allclose(found, wanted, rtol=0, atol=3e-7 * factor**2 * aperture.area(shape))


@ON_SHAPES
@pytest.mark.parametrize("angle", [math.pi / 2, 0.7, -2.0])
def test_rotation(name, angle):
    """The far field turns with the shape, counter-clockwise as seen."""
    shape = SHAPES[name]
    turned = aperture.rotated(shape, angle)
    for distance, direction in ((0.3, 0.1), (2.2, 1.7), (9.1, 4.0)):
        # Counter-clockwise as seen is from +x towards −y.
        before = (-distance * math.sin(direction), distance * math.cos(direction))
        after = (-distance * math.sin(direction + angle), distance * math.cos(direction + angle))
        one = amplitude(shape, frequencies((1, 1), 1.0, before))
        other = amplitude(turned, frequencies((1, 1), 1.0, after))
        np.testing.assert_allclose(other, one, rtol=0, atol=3e-7 * aperture.area(shape))


@pytest.mark.parametrize("method", EVERY)
def test_linearity(method):
    """Openings that do not overlap add up; a dimmed one counts as much less."""
    left = aperture.moved(aperture.iris(6, D / 4), -D / 4, D / 16)
    right = aperture.dimmed(aperture.moved(aperture.iris(4, D / 4), D / 4, 0.0), 0.3)
    grid = frequencies((16, 15), 0.8, (1.0, 0.0))
    if method not in OF_OUTLINES:
        grid = Grid((16, 15), (1 / left.width, 1 / left.width))
        full = aperture.rectangle(left.width, left.width)
        right = aperture.intersection(full, right)
        left, right = (aperture.from_mask(aperture.rasterize(a, 64), left.width) for a in (left, right))
    both = amplitude(aperture.union(left, right), grid, method)
    apart = amplitude(left, grid, method) + amplitude(right, grid, method)
    peak = aperture.area(left) + aperture.area(right)
    np.testing.assert_allclose(both, apart, rtol=0, atol=1e-6 * peak)


@ON_SHAPES
@pytest.mark.parametrize("method", EVERY)
def test_hermitian_symmetry(name, method):
    """A real aperture has F(−u, −v) = F*(u, v)."""
    shape = SHAPES[name]
    grid = Grid((33, 35), (1 / shape.width, 0.5 / shape.width))
    found = far_field(shape, grid, method, raster_size=64).amplitude
    np.testing.assert_allclose(found[::-1, ::-1], found.conj(), rtol=0, atol=1e-6 * aperture.area(shape))


@pytest.mark.parametrize("method", [name for name in EVERY if name != "polygons"])
def test_babinet_of_pixels(method):
    """A mask and its complement cancel at the window's own frequencies, except at the origin."""
    mask = np.random.default_rng(1).random((24, 24))
    grid = frequencies((24, 24), 1.0)
    one = amplitude(aperture.from_mask(mask, D), grid, method)
    other = amplitude(aperture.from_mask(1 - mask, D), grid, method)
    wanted = np.zeros((24, 24))
    wanted[12, 12] = D**2
    np.testing.assert_allclose(one + other, wanted, rtol=0, atol=1e-6 * D**2)


@pytest.mark.parametrize("method", OF_OUTLINES)
def test_babinet_of_outlines(method):
    window = aperture.rectangle(D, D)
    shape = aperture.iris(7, 0.9 * D, 0.4)
    rest = aperture.subtraction(window, shape)
    grid = frequencies((20, 21), 0.7, (0.4, 3.0))
    together = amplitude(shape, grid, method) + amplitude(rest, grid, method)
    np.testing.assert_allclose(together, amplitude(window, grid, method), rtol=0, atol=5e-7 * D**2)


@pytest.mark.parametrize("method", [name for name in EVERY if name != "polygons"])
@pytest.mark.parametrize("size", [15, 16])
def test_parseval_of_pixels(method, size):
    """One period of the DFT's own frequencies, the pixel's sinc taken off, holds all energy."""
    made = aperture.from_mask(np.random.default_rng(2).random((size, size)), D)
    grid = frequencies((size, size), 1.0)
    v, u = grid.axes()
    dft = amplitude(made, grid, method) / (np.sinc(v * D / size)[:, None] * np.sinc(u * D / size))
    assert np.sum(np.abs(dft) ** 2) / D**2 == pytest.approx(aperture.energy(made), rel=1e-5)


@ON_SHAPES
def test_parseval_of_outlines(name):
    """Σ |F(k / w)|² / w² = ∬ |f|²; beyond |q| = Q lies perimeter / (2 π² Q) of it (Porod's law)."""
    shape = SHAPES[name]
    reach = 90
    grid = Grid((2 * reach + 1, 2 * reach + 1), (1 / shape.width, 1 / shape.width))
    inside = radius_of(grid) < (reach + 0.5) / shape.width
    power = np.abs(amplitude(shape, grid)) ** 2
    perimeter = sum(
        float(np.sum(np.hypot(*aperture.boundary_nodes(ring, D)[1].T))) for ring in shape.outlines
    )
    tail = perimeter / (2 * math.pi**2 * (reach + 0.5) / shape.width)
    energy = power[inside].sum() / shape.width**2
    assert 0.002 < tail / aperture.energy(shape) < 0.02
    assert energy + tail == pytest.approx(aperture.energy(shape), rel=5e-4)


@pytest.mark.parametrize("blades", [3, 4, 5, 6, 7, 8, 9])
def test_streaks_of_a_polygon(blades):
    """N streaks for even N, 2 N for odd, each perpendicular to an edge."""
    rotation = 0.2
    grid = frequencies((241, 241), 1.3)
    v, u = grid.axes()
    q = radius_of(grid) * D
    ring = (q > 70) & (q < 150)
    power = (np.abs(amplitude(aperture.iris(blades, D, rotation=rotation), grid)) ** 2 * q**2)[ring]
    turns = np.broadcast_to(np.arctan2(-v[:, None], u), q.shape)[ring] / (2 * math.pi) % 1
    bins = np.bincount((turns * 360).astype(int), power, 360) / np.bincount((turns * 360).astype(int))
    bright = bins > 10 * np.median(bins)
    starts = np.flatnonzero(bright & ~np.roll(bright, 1))
    # Normals of the edges lie half way between corners, and a streak runs both ways.
    normals = {
        round((math.degrees(rotation) + 180 / blades + 360 / blades * edge + half) % 360, 6)
        for edge in range(blades)
        for half in (0, 180)
    }
    assert len(starts) == len(normals) == (blades if blades % 2 == 0 else 2 * blades)
    for normal in normals:
        degree = int(normal)
        assert bright[degree]
        assert bins[degree] == max(bins[(degree + np.arange(-3, 4)) % 360])


def falloff(shape):
    """Return the exponent of the local mean power along +u between 60 and 1900 cycles per D."""
    means, places = [], (60, 1900)
    for place in places:
        line = frequencies((1, 600), place / 3000, (0.0, place))
        means.append(np.mean(np.abs(amplitude(shape, line)) ** 2))
    return math.log(means[1] / means[0]) / math.log(places[1] / places[0])


@pytest.mark.parametrize("blades", [5, 6, 7])
def test_falloff_along_a_streak_and_between(blades):
    """q⁻² where an edge is square to q, q⁻⁴ where only corners diffract."""
    along = aperture.iris(blades, D, rotation=math.pi / blades)
    spread = 2 * blades if blades % 2 else blades
    between = aperture.iris(blades, D, rotation=math.pi / blades + math.pi / spread)
    assert falloff(along) == pytest.approx(-2, abs=0.05)
    assert falloff(between) == pytest.approx(-4, abs=0.1)


@pytest.mark.parametrize("curvature", [0.5, 1.0])
def test_falloff_of_curved_blades(curvature):
    """q⁻³ everywhere, as around a circle."""
    assert falloff(aperture.iris(6, D, curvature, math.pi / 6)) == pytest.approx(-3, abs=0.1)


def test_the_circles_own_function_is_the_bessel_function():
    """The closed form above against scipy's, so that it stands on two legs."""
    x = np.linspace(0, 150, 301)
    np.testing.assert_allclose(bessel_j1(x), special.j1(x), rtol=0, atol=1e-13)
