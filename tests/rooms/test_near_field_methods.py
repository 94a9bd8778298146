"""The near field's methods agree with the reference, over masks × planes × sizes; refusals."""

import re

import numpy as np
import pytest

from aureole import Grid, aperture, refuse
from aureole.diffraction import NearOperator, level_mask, near_field, near_power
from aureole.diffraction.fresnel import fresnel_integrals
from aureole.records import Aperture

WIDTH = 2e-3
WAVELENGTH = 550e-9
OF_PIXELS = ["reference", "quads", "rows"]  # on any plane
FAST = [name for name in OF_PIXELS if name != "reference"]
ABSOLUTE = 3e-6  # where nothing blocks the wave the field is 1
SHAPES = {
    "grey": np.random.default_rng(1).random((21, 21)),
    "binary": np.random.default_rng(2).random((32, 32)).round(),
    "sparse": np.random.default_rng(3).random((30, 30)) > 0.95,
    "one": np.ones((1, 1)),
    "two": np.array([[0.25, 1.0], [0.5, 0.0]]),
    "circle": aperture.rasterize(aperture.circle(WIDTH), 64),
    "heptagon": aperture.rasterize(aperture.iris(7, WIDTH), 65),
    "whirl": aperture.rasterize(aperture.whirl(WIDTH, 5), 64),
}
SIZES = [(1, 1), (1, 23), (16, 16), (17, 15)]
CENTRES = [(0.0, 0.0), (0.0, 0.31e-3), (-0.7e-3, 0.0), (1.1e-3, -6.3e-3)]


def distance_at(number):
    return (WIDTH / 2) ** 2 / (WAVELENGTH * number)


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


@pytest.mark.parametrize("method", FAST)
@pytest.mark.parametrize("kind", list(SHAPES))
@pytest.mark.parametrize("centre", CENTRES)
def test_methods_agree(method, kind, centre):
    shape = aperture.from_mask(SHAPES[kind], WIDTH)
    for size in SIZES:
        grid = Grid(size, (WIDTH / 11, WIDTH / 17), centre)
        for number in (1e-3, 3.0, 1000.0):
            wanted = near_field(shape, grid, distance_at(number), WAVELENGTH, "reference").amplitude
            found = near_field(shape, grid, distance_at(number), WAVELENGTH, method)
            assert found.grid == grid
            assert found.amplitude.dtype == np.complex64
            assert found.amplitude.shape == size
            atol = ABSOLUTE * min(1.0, 10 * number)
            np.testing.assert_allclose(found.amplitude, wanted, rtol=0, atol=atol)


@pytest.mark.parametrize("shape", [aperture.iris(7, WIDTH), aperture.circle(WIDTH), aperture.whirl(WIDTH)])
def test_the_irradiance_to_7e_6_of_its_mean(shape):
    """At 200 places of a plane twice as wide, behind 1024² pixels: a thousand products a place."""
    raster = aperture.from_mask(aperture.rasterize(shape, 1024), WIDTH)
    y, x = np.random.default_rng(3).uniform(-1e-4, 1e-4, 2)
    grid = Grid((10, 20), (2 * WIDTH / 10, 2 * WIDTH / 20), (y, x))
    operators = {method: NearOperator(raster, grid, method) for method in OF_PIXELS}
    for number in (0.1, 1.0, 10.0, 100.0, 1000.0):
        powers = {method: each.power(distance_at(number), WAVELENGTH) for method, each in operators.items()}
        wanted = powers["reference"]
        for method in FAST:
            assert np.abs(powers[method] - wanted).max() < 7e-6 * wanted.mean(), (method, number)


@pytest.mark.parametrize("method", [*FAST, "auto"])
@pytest.mark.parametrize(
    "grid",
    [
        Grid((12, 12), (2e-4, 2e-4)),
        Grid((12, 13), (2e-4, 2e-4)),
        Grid((12, 12), (2e-4, 1e-4)),
        Grid((12, 12), (2e-4, 2e-4), (3e-4, 3e-4)),
        Grid((12, 12), (2e-4, 2e-4), (3e-4, -3e-4)),
    ],
)
def test_planes_whose_axes_are_alike_or_nearly(method, grid):
    for kind in ("whirl", "grey"):
        shape = aperture.from_mask(SHAPES[kind], WIDTH)
        wanted = near_field(shape, grid, 0.2, WAVELENGTH, "reference").amplitude
        found = near_field(shape, grid, 0.2, WAVELENGTH, method).amplitude
        assert found.dtype == np.complex64
        np.testing.assert_allclose(found, wanted, rtol=0, atol=ABSOLUTE)


@pytest.mark.parametrize("method", FAST)
def test_a_plane_far_to_the_side(method):
    """A hundred widths off the axis the field is faint, and right to what it is."""
    shape = aperture.from_mask(SHAPES["grey"], WIDTH)
    grid = Grid((9, 8), (1e-5, 1e-5), (0.2, -0.15))
    for number in (0.01, 5.0):
        wanted = near_field(shape, grid, distance_at(number), WAVELENGTH, "reference").amplitude
        found = near_field(shape, grid, distance_at(number), WAVELENGTH, method).amplitude
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-3 * np.abs(wanted).max())


@pytest.mark.parametrize("method", FAST)
def test_outlines_are_rasterized(method):
    heptagon, grid = aperture.iris(7, WIDTH), Grid((12, 13), (WIDTH / 9, WIDTH / 9))
    found = near_field(heptagon, grid, 0.1, WAVELENGTH, method, raster_size=40).amplitude
    mask = aperture.from_mask(aperture.rasterize(heptagon, 40), WIDTH)
    wanted = near_field(mask, grid, 0.1, WAVELENGTH, "reference").amplitude
    np.testing.assert_allclose(found, wanted, rtol=0, atol=ABSOLUTE)


@pytest.mark.parametrize("method", [*OF_PIXELS, "auto"])
@pytest.mark.parametrize("centre", CENTRES)
def test_power_is_the_square_of_the_field(method, centre):
    for kind in ("whirl", "grey"):
        shape = aperture.from_mask(SHAPES[kind], WIDTH)
        for size in SIZES:
            grid = Grid(size, (WIDTH / 11, WIDTH / 17), centre)
            amplitude = near_field(shape, grid, 0.2, WAVELENGTH, method).amplitude
            power = near_power(shape, grid, 0.2, WAVELENGTH, method)
            assert power.dtype == (np.float64 if method == "reference" else np.float32)
            np.testing.assert_allclose(power, np.abs(amplitude) ** 2, rtol=0, atol=ABSOLUTE)


@pytest.mark.parametrize("method", OF_PIXELS)
def test_one_operator_serves_many_distances_and_wavelengths(method):
    shape = aperture.from_mask(SHAPES["whirl"], WIDTH)
    grid = Grid((12, 13), (WIDTH / 9, WIDTH / 9))
    operator = NearOperator(shape, grid, method)
    for distance, wavelength in ((0.1, 450e-9), (0.1, 650e-9), (2.0, 550e-9)):
        wanted = near_field(shape, grid, distance, wavelength, method).amplitude
        np.testing.assert_array_equal(operator.field(distance, wavelength).amplitude, wanted)
        power = near_power(shape, grid, distance, wavelength, method)
        np.testing.assert_array_equal(operator.power(distance, wavelength), power)


@pytest.mark.parametrize("method", [*FAST, "auto"])
@pytest.mark.parametrize("finest", ["half", "quarter", "eighth"])
def test_a_coarser_level_is_the_field_of_the_averaged_mask(method, finest):
    mask = np.random.default_rng(4).random((48, 48))
    grid = Grid((12, 13), (WIDTH / 9, WIDTH / 9))
    coarse = aperture.from_mask(level_mask(mask, finest), WIDTH)
    wanted = near_field(coarse, grid, 0.1, WAVELENGTH, "reference").amplitude
    shape = aperture.from_mask(mask, WIDTH)
    found = near_field(shape, grid, 0.1, WAVELENGTH, method, finest=finest).amplitude
    np.testing.assert_allclose(found, wanted, rtol=0, atol=ABSOLUTE)
    power = near_power(shape, grid, 0.1, WAVELENGTH, method, finest=finest)
    np.testing.assert_allclose(power, np.abs(wanted) ** 2, rtol=0, atol=ABSOLUTE)


@pytest.mark.parametrize("method", OF_PIXELS)
def test_a_dark_mask_has_no_field(method):
    dark = Aperture(1.0, mask=np.zeros((4, 4), dtype=np.float32))
    field = near_field(dark, Grid((4, 5), (1.0, 1.0)), 1.0, WAVELENGTH, method)
    np.testing.assert_array_equal(field.amplitude, np.zeros((4, 5)))


@pytest.mark.parametrize("method", OF_PIXELS)
def test_no_number_makes_a_field_that_is_none(method):
    shape = aperture.from_mask(SHAPES["two"], WIDTH)
    for distance in (5e-324, 1e-200, 1e-9, 1e9, 1e300):
        for wavelength in (5e-324, 1e-100, 5e-7, 1e300):
            for spacing in (1e-300, 1e-4, 1e150):
                grid = Grid((3, 4), (spacing, spacing), (0.0, WIDTH / 2))
                field = near_field(shape, grid, distance, wavelength, method).amplitude
                assert np.isfinite(field).all(), (distance, wavelength, spacing)
                assert np.abs(field).max() < 3


def test_a_wavefront_is_a_phase():
    """A flat one turns the field; a lens brings its light together at its focus."""
    shape = aperture.from_mask(SHAPES["circle"], WIDTH)
    grid, distance = Grid((9, 9), (2e-5, 2e-5)), distance_at(2.0)
    plain = near_field(shape, grid, distance, WAVELENGTH, "reference").amplitude
    flat = Aperture(WIDTH, mask=shape.mask, wavefront=np.full((64, 64), WAVELENGTH / 4, dtype=np.float32))
    for method in ("auto", "reference", "rows"):
        turned = near_field(flat, grid, distance, WAVELENGTH, method).amplitude
        np.testing.assert_allclose(turned, 1j * plain, rtol=0, atol=ABSOLUTE)
    x = (np.arange(64) + 0.5) / 64 * WIDTH - WIDTH / 2
    bent = -(x[:, None] ** 2 + x**2) / (2 * distance)
    lens = Aperture(WIDTH, mask=shape.mask, wavefront=bent.astype(np.float32))
    focus = near_field(lens, grid, distance, WAVELENGTH).amplitude
    area = float(shape.mask.sum()) * (WIDTH / 64) ** 2
    assert np.abs(focus[4, 4]) == pytest.approx(area / (WAVELENGTH * distance), rel=0.01)
    with refused("method 'quads' takes real transmittances and this aperture has a wavefront; use 'rows'."):
        near_field(flat, grid, distance, WAVELENGTH, "quads")


PIXEL = WIDTH / 24
ON_LATTICE = [
    Grid((24, 24), (PIXEL, PIXEL)),
    Grid((1, 1), (PIXEL, PIXEL), (0.3 * PIXEL, -7.7 * PIXEL)),
    Grid((33, 50), (PIXEL, PIXEL), (0.11e-3, -0.4e-3)),
    Grid((9, 14), (3 * PIXEL, 2 * PIXEL), (0.0, 0.2e-3)),
    Grid((31, 20), (PIXEL / 2, PIXEL / 8), (-1e-3, 0.0)),
    Grid((7, 60), (5 * PIXEL, PIXEL / 3)),
    Grid((5, 6), (PIXEL, PIXEL), (0.1, -0.2)),
]


@pytest.mark.parametrize("method", ["fft", "rows", "auto"])
@pytest.mark.parametrize("grid", ON_LATTICE)
def test_places_on_a_lattice_of_pixels(method, grid):
    values = np.random.default_rng(6).random((24, 24))
    values[5:9] = 0
    wavefront = (1e-7 * np.random.default_rng(7).random((24, 24))).astype(np.float32)
    for shape in (
        aperture.from_mask(values, WIDTH),
        Aperture(WIDTH, mask=values.astype(np.float32), wavefront=wavefront),
    ):
        for number in (1e-3, 3.0, 1000.0):
            wanted = near_field(shape, grid, distance_at(number), WAVELENGTH, "reference").amplitude
            found = near_field(shape, grid, distance_at(number), WAVELENGTH, method).amplitude
            assert found.dtype == np.complex64
            atol = ABSOLUTE * min(1.0, 10 * number)
            np.testing.assert_allclose(found, wanted, rtol=0, atol=atol)
            power = near_power(shape, grid, distance_at(number), WAVELENGTH, method)
            assert power.dtype == np.float32
            np.testing.assert_allclose(power, np.abs(wanted) ** 2, rtol=0, atol=atol)


@pytest.mark.parametrize("spacing", [1.5, 0.7, 1 / 9, 1e-9, 1.0001])
def test_places_off_the_lattice_are_refused_by_the_convolution(spacing):
    shape = aperture.from_mask(SHAPES["whirl"], WIDTH)
    grid = Grid((20, 20), (WIDTH / 64, spacing * WIDTH / 64))
    with refused(
        "method 'fft' needs places a whole number of pixels apart, or a whole number to a pixel; use 'rows'."
    ):
        near_field(shape, grid, 0.1, WAVELENGTH, "fft")


def test_a_dense_mask_on_its_own_lattice_is_convolved():
    """Its rows are all different, and none is the mirror image of another."""
    dense = aperture.from_mask(np.random.default_rng(8).random((512, 512)), WIDTH)
    box = aperture.from_mask(np.ones((512, 512)), WIDTH)
    grid = Grid((512, 512), (WIDTH / 512, WIDTH / 512))
    assert NearOperator(box, grid).method == "rows"
    assert NearOperator(dense, Grid(grid.shape, grid.spacing, (1e-5, 1e-5))).method == "fft"
    assert NearOperator(dense, Grid(grid.shape, (1.3e-6, 1.3e-6))).method == "rows"


GRID = Grid((8, 8), (1e-4, 1e-4))
ROUND = aperture.circle(WIDTH)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((GRID, 0.0, WAVELENGTH), "'distance' must be a finite number > 0, got 0."),
        ((GRID, -1.0, WAVELENGTH), "'distance' must be a finite number > 0, got -1."),
        ((GRID, np.nan, WAVELENGTH), "'distance' must be a finite number > 0, got nan."),
        ((GRID, 1.0, np.inf), "'wavelength' must be a finite number > 0, got inf."),
        ((GRID, 1.0, 0), "'wavelength' must be a finite number > 0, got 0."),
        (
            (GRID, 1.0, WAVELENGTH, "row"),
            "'method' must be one of 'auto', 'reference', 'polygons', 'quads', 'rows', 'fft', got 'row'. "
            "Did you mean 'rows'?",
        ),
        ((GRID, 1.0, WAVELENGTH, "rows", 0), "'size' must be an integer >= 1, got 0."),
        ((Grid((0, 8), (1.0, 1.0)), 1.0, WAVELENGTH), "'grid rows' must be an integer >= 1, got 0."),
        (
            (Grid((8, 8), (1.0, 0.0)), 1.0, WAVELENGTH),
            "'grid spacing of the columns' must be a finite number > 0, got 0.",
        ),
    ],
)
def test_what_does_not_fit_is_refused(arguments, message):
    with refused(message):
        near_field(ROUND, *arguments)


def test_levels_that_do_not_fit_are_refused():
    with refused(
        "method 'reference' sees an aperture as it is and takes no 'finest'; use 'rows' or 'quads'."
    ):
        near_field(ROUND, GRID, 1.0, WAVELENGTH, "reference", finest="half")
    with refused(
        "'finest' must be one of 'full', 'half', 'quarter', 'eighth', got 'tenth'. Did you mean 'eighth'?"
    ):
        near_power(ROUND, GRID, 1.0, WAVELENGTH, finest="tenth")
    bent = Aperture(WIDTH, mask=np.ones((8, 8), np.float32), wavefront=np.zeros((8, 8), np.float32))
    with refused("'finest' must be 'full' for an aperture with a wavefront, got 'half'."):
        near_field(bent, GRID, 1.0, WAVELENGTH, finest="half")
    for level in (-0.5, 1.0, 2):
        with refused(f"'cull' must be a level above 0 and below 1 of the peak, got {level:g}."):
            near_power(ROUND, GRID, 1.0, WAVELENGTH, cull=level)


def test_fresnel_integrals_refuse_what_is_no_number():
    with refused("'x' must hold numbers, got 2 that are NaN."):
        fresnel_integrals([0.0, np.nan, 1.0, np.nan])
