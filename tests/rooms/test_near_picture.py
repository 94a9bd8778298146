"""The near field in colour: exact sums against brute force, the approximation's rule, whites, refusals."""

import math
import re

import numpy as np
import pytest
from scipy import ndimage

from aureole import Grid, aperture, light, refuse
from aureole.diffraction import near_field, near_picture, near_picture_stages, near_power
from aureole.diffraction.near_picture import wavelengths_needed
from aureole.records import Aperture

WIDTH = 2e-3
GREY = light.illuminant("E")
FLOAT32 = 3e-6
PLANES = {
    "even": Grid((24, 30), (1.3e-4, 0.9e-4)),
    "odd": Grid((25, 17), (1.3e-4, 1.7e-4)),
    "off the axis along x": Grid((18, 21), (1.3e-4, 0.9e-4), (0.0, 0.4e-3)),
    "off the axis along y": Grid((18, 21), (1.3e-4, 0.9e-4), (-0.7e-3, 0.0)),
    "off the axis": Grid((17, 20), (1.3e-4, 0.9e-4), (0.3e-3, -2.1e-3)),
    "one place": Grid((1, 1), (1e-4, 1e-4)),
}
MASKS = {
    "upright heptagon": aperture.rasterize(aperture.iris(7, WIDTH), 64),
    "turned heptagon": aperture.rasterize(aperture.iris(7, WIDTH, rotation=0.3), 65),
    "circle": aperture.rasterize(aperture.circle(WIDTH), 48),
    "grey": np.random.default_rng(4).random((21, 21)),
    "grey columns": np.tile(np.random.default_rng(5).random(32).round(1), (32, 1)),
}


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def raster(kind):
    return aperture.from_mask(MASKS[kind], WIDTH)


def distance_at(number, wavelength=550e-9):
    return (WIDTH / 2) ** 2 / (wavelength * number)


def brute_force(shape, grid, distance, spectrum, samples, method="reference"):
    total = np.zeros((*grid.shape, 3))
    for wavelength, weight in zip(*light.quadrature(spectrum, samples), strict=True):
        amplitude = near_field(shape, grid, distance, float(wavelength), method).amplitude
        total += np.abs(amplitude.astype(complex))[..., None] ** 2 * weight
    return total


@pytest.mark.parametrize("kind", list(MASKS))
@pytest.mark.parametrize("plane", list(PLANES))
def test_exact_is_the_sum_of_near_fields(kind, plane):
    shape, grid = raster(kind), PLANES[plane]
    for number in (0.4, 12.0):
        found = near_picture(shape, grid, distance_at(number), GREY, samples=5)
        wanted = brute_force(shape, grid, distance_at(number), GREY, 5)
        assert found.colour_space == "xyz"
        assert found.pixels.dtype == np.float32
        np.testing.assert_allclose(found.pixels, wanted, rtol=0, atol=FLOAT32)


@pytest.mark.parametrize("field_method", ["quads", "rows", "reference"])
def test_every_method_of_the_near_field_serves(field_method):
    shape, grid = raster("turned heptagon"), PLANES["even"]
    found = near_picture(shape, grid, 0.2, GREY, samples=3, field_method=field_method)
    np.testing.assert_allclose(found.pixels, brute_force(shape, grid, 0.2, GREY, 3), rtol=0, atol=FLOAT32)


def test_outlines():
    """Outlines go the way that the near field itself goes, whichever that is, and nearly as their raster."""
    shape, grid = aperture.iris(5, WIDTH, rotation=0.2), PLANES["even"]
    found = near_picture(shape, grid, 0.4, GREY, samples=4)
    wanted = brute_force(shape, grid, 0.4, GREY, 4, "auto")
    np.testing.assert_allclose(found.pixels, wanted, rtol=0, atol=FLOAT32)
    np.testing.assert_allclose(found.pixels, brute_force(shape, grid, 0.4, GREY, 4), rtol=0, atol=2e-3)


SMALL_PLANES = [
    Grid((6, 7), (3e-4, 4e-4)),
    Grid((5, 38), (5e-4, 1e-4), (0.3e-3, 0.0)),
    Grid((1, 5), (1e-4, 3e-4), (-2.1e-3, 0.4e-3)),
]
OUTLINES = {
    "heptagon": aperture.iris(7, WIDTH),
    "turned pentagon": aperture.iris(5, WIDTH, rotation=0.2),
    "hexagon": aperture.iris(6, WIDTH),
    "frame": aperture.subtraction(aperture.rectangle(WIDTH, WIDTH), aperture.rectangle(WIDTH / 2, WIDTH / 4)),
    "grey and aside": aperture.union(
        aperture.dimmed(aperture.iris(4, WIDTH / 2), 0.5),
        aperture.moved(aperture.iris(3, WIDTH / 8), 7e-4, 2e-4),
    ),
    "whirl": aperture.whirl(WIDTH),
    "ring of a circle and a square": aperture.subtraction(
        aperture.circle(WIDTH), aperture.rectangle(WIDTH / 3, WIDTH / 3)
    ),
}


@pytest.mark.parametrize("kind", list(OUTLINES))
@pytest.mark.parametrize("number", [0.2, 8.0, 40.0])
@pytest.mark.parametrize("samples", [3, 8])
def test_outlines_are_exact(kind, number, samples):
    """Few wavelengths are computed each, many share amplitudes: both as the sum along the boundary."""
    shape, distance = OUTLINES[kind], distance_at(number)
    for grid in SMALL_PLANES:
        found = near_picture(shape, grid, distance, GREY, samples=samples, field_method="polygons").pixels
        wanted = brute_force(shape, grid, distance, GREY, samples)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=FLOAT32)


@pytest.mark.parametrize("number", [3.0, 40.0])
def test_places_on_corners_and_edges(number):
    square, step = aperture.rectangle(WIDTH, WIDTH), WIDTH / 8
    for grid in (Grid((13, 12), (step, step)), Grid((9, 10), (step, step), (step, -step))):
        found = near_picture(square, grid, distance_at(number), GREY, samples=9).pixels
        wanted = brute_force(square, grid, distance_at(number), GREY, 9)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=FLOAT32)


def test_lines_at_the_ends_of_what_is_seen_share_amplitudes():
    lines = light.spectrum(np.linspace(361e-9, 829e-9, 14), np.geomspace(1, 2, 14), "lines")
    shape, grid = OUTLINES["turned pentagon"], SMALL_PLANES[1]
    found = near_picture(shape, grid, distance_at(10.0), lines).pixels
    wanted = brute_force(shape, grid, distance_at(10.0), lines, 1)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=FLOAT32)


def test_more_wavelengths_than_are_computed_at_once():
    shape, grid = OUTLINES["heptagon"], SMALL_PLANES[0]
    stages = list(near_picture_stages(shape, grid, distance_at(9.0), GREY, samples=60))
    assert len(stages) > 2
    wanted = brute_force(shape, grid, distance_at(9.0), GREY, 60)
    np.testing.assert_allclose(stages[-1].result.pixels, wanted, rtol=0, atol=FLOAT32)


def test_a_plane_so_near_that_it_shows_the_shadow():
    """All wavelengths see the same."""
    square, grid = aperture.rectangle(WIDTH, WIDTH), Grid((6, 6), (WIDTH / 3, WIDTH / 3))
    found = near_picture(square, grid, 1e-60, GREY, samples=9).pixels
    inside = np.abs(np.arange(6) - 3) < 1.5
    wanted = np.outer(inside, inside)[..., None] * light.white(GREY)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-4)


def test_a_coarser_mask():
    shape, grid = raster("upright heptagon"), PLANES["odd"]
    found = near_picture(shape, grid, 0.3, GREY, samples=2, finest="quarter")
    coarse = aperture.from_mask(shape.mask.reshape(16, 4, 16, 4).mean(axis=(1, 3)), WIDTH)
    np.testing.assert_allclose(found.pixels, brute_force(coarse, grid, 0.3, GREY, 2), rtol=0, atol=FLOAT32)


def test_a_wavefront():
    shape = aperture.with_wavefront(aperture.circle(WIDTH), 32, {"coma-x": 2e-7})
    found = near_picture(shape, PLANES["odd"], 0.5, GREY, samples=3)
    wanted = brute_force(shape, PLANES["odd"], 0.5, GREY, 3)
    np.testing.assert_allclose(found.pixels, wanted, rtol=0, atol=FLOAT32)


@pytest.mark.parametrize("method", ["exact", "approximate"])
@pytest.mark.parametrize("name", ["E", "D65", "line:550nm", "A"])
def test_where_nothing_blocks_the_light_it_is_its_white(method, name):
    """At the middle of an opening a thousand zones wide the edges' waves are faint."""
    spectrum, grid = light.illuminant(name), Grid((5, 6), (1e-5, 1e-5))
    open_wide = Aperture(1.0, mask=np.ones((4, 4), np.float32))
    found = near_picture(open_wide, grid, 1e-4, spectrum, method, samples=8)
    wanted = np.broadcast_to(light.white(spectrum), found.pixels.shape)
    np.testing.assert_allclose(found.pixels, wanted, rtol=0, atol=1e-4)
    assert found.metadata["white_xyz"] == pytest.approx(light.white(spectrum))


def test_a_single_line_is_its_power_times_its_white():
    shape, grid, spectrum = raster("grey"), PLANES["even"], light.line(610e-9)
    power = near_power(shape, grid, 0.3, 610e-9)
    wanted = power[..., None] * light.white(spectrum)
    for method in ("exact", "approximate"):
        found = near_picture(shape, grid, 0.3, spectrum, method).pixels
        np.testing.assert_allclose(found, wanted, rtol=0, atol=FLOAT32)


def test_lines_are_summed_at_their_own_wavelengths():
    lines = light.spectrum([450e-9, 620e-9], [1.0, 3.0], "lines")
    shape, grid = raster("turned heptagon"), PLANES["odd"]
    found = near_picture(shape, grid, 0.3, lines).pixels
    np.testing.assert_allclose(found, brute_force(shape, grid, 0.3, lines, 9), rtol=0, atol=FLOAT32)


def test_energy():
    """What passes a plane so wide that little misses it: the area for each of X, Y and Z of equal energy."""
    shape = raster("circle")
    grid = Grid((160, 160), (5 * WIDTH / 160,) * 2)
    pixels = near_picture(shape, grid, distance_at(6.0), GREY, samples=6).pixels
    held = pixels.sum(axis=(0, 1), dtype=np.float64) * grid.spacing[0] ** 2
    wanted = aperture.energy(shape) * light.white(GREY)
    np.testing.assert_allclose(held, wanted, rtol=0.02)


def test_red_leaks_farther_into_the_shadow():
    """Behind a wide slit's edge light falls as λz / (2π² d²): red over blue as their wavelengths."""
    slit = Aperture(0.2, mask=np.ones((2, 2), np.float32))
    grid = Grid((1, 1), (1e-5, 1e-5), (0.0, 0.1 + 1e-3))
    red, blue = (near_picture(slit, grid, 0.5, light.line(each)).pixels[0, 0, 1] for each in (650e-9, 450e-9))
    assert red / blue == pytest.approx(650 / 450, rel=0.05)


def scaled_by_spline(power, wide, grid, scale):
    """Look a plane up at scaled places by SciPy's linear interpolation."""
    y, x = (scale * axis for axis in grid.axes())
    places = [
        (values - centre) / step + count // 2
        for values, centre, step, count in zip((y, x), wide.centre, wide.spacing, wide.shape, strict=True)
    ]
    return ndimage.map_coordinates(power.astype(float), np.meshgrid(*places, indexing="ij"), order=1)


@pytest.mark.parametrize("kind", ["turned heptagon", "upright heptagon", "circle"])
@pytest.mark.parametrize("plane", ["even", "odd", "off the axis along x", "off the axis"])
@pytest.mark.parametrize("strength", [0.05, -0.4])
def test_the_approximation_scales_one_pattern(kind, plane, strength):
    """Σ w |D_r((1 + s (1 − ρ)) q)|², ρ = λ_r / λ (quad paper §4.5), and no wavelength is made brighter."""
    shape, grid, reference = raster(kind), PLANES[plane], 540e-9
    found = near_picture(
        shape, grid, 0.2, GREY, "approximate", 7, strength=strength, reference_wavelength=reference
    )
    wide = Grid(tuple(n + 40 for n in grid.shape), grid.spacing, grid.centre)
    power = np.abs(near_field(shape, wide, 0.2, reference, "reference").amplitude) ** 2
    wanted = np.zeros((*grid.shape, 3))
    for wavelength, weight in zip(*light.quadrature(GREY, 7), strict=True):
        scale = 1 + strength * (1 - reference / wavelength)
        wanted += scaled_by_spline(power, wide, grid, scale)[..., None] * weight
    np.testing.assert_allclose(found.pixels, wanted, rtol=0, atol=1e-5)


def test_the_reference_wavelength():
    """529 nm for light over the whole range: the geometric mean of 400 and 700 nm (quad paper §4.4)."""
    shape, grid = raster("grey"), PLANES["odd"]
    by_itself = near_picture(shape, grid, 0.2, GREY, "approximate", 5, strength=0.0).pixels
    power = near_power(shape, grid, 0.2, math.sqrt(400e-9 * 700e-9))
    np.testing.assert_allclose(by_itself, power[..., None] * light.white(GREY), rtol=0, atol=FLOAT32)


def test_the_approximation_is_plausible():
    """Nearer to the exact colours than the far field's scaling is (quad paper Figure 7)."""
    shape, grid = raster("upright heptagon"), Grid((48, 48), (2 * WIDTH / 48,) * 2)
    distance = distance_at(20.0)
    exact = near_picture(shape, grid, distance, GREY).pixels
    error = {
        strength: np.sqrt(
            np.mean(
                (near_picture(shape, grid, distance, GREY, "approximate", strength=strength).pixels - exact)
                ** 2
            )
        )
        for strength in (0.05, -1.0)
    }
    assert error[0.05] < 0.5 * error[-1.0]


def test_how_many_wavelengths_are_taken():
    """30 near the far field, in proportion to the longest way in √(λz) beyond, and 160 at most."""
    shape = raster("circle")
    grid = Grid((41, 41), (WIDTH / 20,) * 2)  # as wide as two apertures
    for number, wanted in ((0.1, 30), (30.0, 53), (80.0, 86), (1e5, 160)):
        assert wavelengths_needed(shape, grid, distance_at(number), 550e-9) == wanted


@pytest.mark.parametrize("number", [3.0, 30.0, 100.0])
def test_the_wavelengths_taken_are_enough(number):
    shape, distance = raster("turned heptagon"), distance_at(number)
    grid = Grid((20, 40), (WIDTH / 30, 2 * WIDTH / 40))
    found, wanted = (near_picture(shape, grid, distance, GREY, samples=n).pixels for n in (None, 360))
    assert np.sqrt(np.mean((found - wanted) ** 2)) < 0.002


@pytest.mark.parametrize("shape", [aperture.iris(7, WIDTH), aperture.iris(6, WIDTH, 0.5)])
def test_the_approximation_sees_outlines_as_pixels_and_says_how_well(shape):
    """What 256 pixels leave is a third of the approximation's own error, at most; circles stay exact."""
    grid, distance = Grid((96, 96), (2 * WIDTH / 96,) * 2), distance_at(30.0)
    quick, by_edges, exact = (
        near_picture(shape, grid, distance, GREY, method, field_method=field).pixels
        for method, field in (("approximate", "auto"), ("approximate", "polygons"), ("exact", "auto"))
    )
    left, own = (np.sqrt(np.mean((each - by_edges) ** 2)) for each in (quick, exact))
    assert 0 < left < own / 3
    for same in (aperture.circle(WIDTH), aperture.obstacle(aperture.iris(7, WIDTH))):
        one, other = (
            near_picture(same, grid, distance, GREY, "approximate", field_method=field).pixels
            for field in ("auto", "polygons")
        )
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("method", ["exact", "approximate"])
def test_stages_end_with_the_picture(method):
    shape, grid = raster("circle"), PLANES["odd"]
    stages = list(near_picture_stages(shape, grid, 0.3, GREY, method, samples=4))
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert fractions[0] == 0
    assert fractions[-1] == 1
    whole = near_picture(shape, grid, 0.3, GREY, method, samples=4)
    np.testing.assert_array_equal(stages[-1].result.pixels, whole.pixels)


def test_refusals():
    shape, grid = raster("circle"), PLANES["odd"]
    with refused("'distance' must be a finite number > 0, got 0."):
        near_picture(shape, grid, 0.0, GREY)
    with refused("'method' must be one of 'exact', 'approximate', got 'exakt'. Did you mean 'exact'?"):
        near_picture(shape, grid, 1.0, GREY, "exakt")
    with refused("'samples' must be an integer >= 1, got 0."):
        near_picture(shape, grid, 1.0, GREY, samples=0)
    with refused("'strength' must be a number from -1 to 1, got 2."):
        near_picture(shape, grid, 1.0, GREY, "approximate", strength=2.0)
    with refused("'reference_wavelength' must be a finite number > 0, got -1."):
        near_picture(shape, grid, 1.0, GREY, "approximate", reference_wavelength=-1.0)
    with pytest.raises(refuse.Refusal, match="'spectrum' needs light between 360 and 830 nm"):
        near_picture(shape, grid, 1.0, light.line(1e-6))
    with pytest.raises(refuse.Refusal, match="too far; use 'exact'"):
        near_picture(shape, Grid((4, 4), (1e-6, 1e-6), (0.0, 1.0)), 1.0, GREY, "approximate")
    with pytest.raises(refuse.Refusal, match="'strength' 1 scales the pattern by"):
        near_picture(shape, grid, 1.0, GREY, "approximate", strength=1.0, reference_wavelength=900e-9)
