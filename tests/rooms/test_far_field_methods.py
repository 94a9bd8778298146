"""The far field's methods agree with the reference, over masks × samplings × sizes; refusals."""

import re

import numpy as np
import pytest

from aureole import Grid, aperture, refuse
from aureole.diffraction import METHODS, check_grid, far_field, far_power, quadtree
from aureole.diffraction.polygons import _shape
from aureole.diffraction.quads import box_factors, quads_field
from aureole.records import Aperture, Outline

WIDTH = 2e-3
OF_PIXELS = ["quads", "rows", "chirpz", "fft"]
ARBITRARY = ["quads", "rows", "chirpz"]
RELATIVE = 1e-5  # error over the peak, the area of what is lit
OUTPUTS = [(1, 1), (1, 23), (22, 1), (16, 16), (17, 17), (24, 15), (15, 40)]


def mask_of(kind, size):
    rng = np.random.default_rng(size)
    mask = rng.random((size, size))
    if kind == "binary":
        mask = np.round(mask)
    if kind == "sparse":
        mask = mask * (rng.random((size, size)) < 0.1)
    mask[size // 2, size // 2] = 1
    return aperture.from_mask(mask, WIDTH)


def check(shape, grid, method):
    field = far_field(shape, grid, method)
    wanted = far_field(shape, grid, "reference").amplitude
    assert field.grid == grid
    assert field.amplitude.dtype == np.complex64
    assert field.amplitude.shape == grid.shape
    np.testing.assert_allclose(field.amplitude, wanted, rtol=0, atol=RELATIVE * aperture.area(shape))


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def test_the_reference_is_a_sum_over_pixels():
    """By hand, for 2 × 2 pixels: each a square of WIDTH / 2 about its own centre."""
    values = np.array([[0.25, 1.0], [0.5, 0.0]])
    shape = aperture.from_mask(values, WIDTH)
    u, v = 130.0, -410.0
    half = WIDTH / 2
    sinc = half**2 * np.sinc(u * half) * np.sinc(v * half)
    wanted = sum(
        values[row, column] * sinc * np.exp(-2j * np.pi * (u * x + v * y))
        for row, y in enumerate((-half / 2, half / 2))
        for column, x in enumerate((-half / 2, half / 2))
    )
    found = far_field(shape, Grid((1, 1), (1.0, 1.0), (v, u)), "reference").amplitude
    assert found.dtype == np.complex128
    np.testing.assert_allclose(found, wanted, rtol=1e-12)


@pytest.mark.parametrize("method", OF_PIXELS)
@pytest.mark.parametrize("kind", ["grey", "binary", "sparse"])
@pytest.mark.parametrize("size", [1, 2, 7, 16, 21])
@pytest.mark.parametrize("output", OUTPUTS)
def test_on_the_ffts_own_frequencies(method, kind, size, output):
    """Spacings of 1 / (N pixels), with N above, at and below the size of the mask."""
    shape = mask_of(kind, size)
    pixel = WIDTH / size
    for rows, columns in ((size, size), (2 * size, 3 * size + 1), (max(1, size // 2), size + 5)):
        spacing = (1 / (rows * pixel), 1 / (columns * pixel))
        check(shape, Grid(output, spacing), method)
        check(shape, Grid(output, spacing, (3 * spacing[0], -17 * spacing[1])), method)


@pytest.mark.parametrize("method", ARBITRARY)
@pytest.mark.parametrize("kind", ["grey", "binary", "sparse"])
@pytest.mark.parametrize("size", [1, 6, 16, 21])
@pytest.mark.parametrize("output", OUTPUTS)
def test_on_any_frequencies(method, kind, size, output):
    shape = mask_of(kind, size)
    for spacing in ((0.37, 0.91), (1e-4, 30.0), (7.3, 2e-3)):
        per_metre = (spacing[0] / WIDTH, spacing[1] / WIDTH)
        check(shape, Grid(output, per_metre), method)
        check(shape, Grid(output, per_metre, (11.3 / WIDTH, -407.7 / WIDTH)), method)


@pytest.mark.parametrize("output", [(1, 1), (1, 15), (14, 1), (12, 12), (11, 13)])
def test_outlines_on_any_frequencies(output):
    for shape in (
        aperture.iris(7, WIDTH, 0.4),
        aperture.whirl(WIDTH, 2),
        aperture.rectangle(WIDTH, WIDTH / 9),
    ):
        for spacing in ((0.37, 0.91), (1e-4, 1.3), (1.7, 2e-3)):
            per_metre = (spacing[0] / WIDTH, spacing[1] / WIDTH)
            check(shape, Grid(output, per_metre), "polygons")
            check(shape, Grid(output, per_metre, (11.3 / WIDTH, -27.7 / WIDTH)), "polygons")


def check_power(shape, grid, method):
    power = far_power(shape, grid, method)
    wanted = np.abs(far_field(shape, grid, "reference").amplitude) ** 2
    assert power.dtype == np.float32
    assert power.shape == grid.shape
    np.testing.assert_allclose(power, wanted, rtol=0, atol=2 * RELATIVE * aperture.area(shape) ** 2)


@pytest.mark.parametrize("method", [*OF_PIXELS, "auto"])
@pytest.mark.parametrize("size", [1, 2, 7, 16, 21])
@pytest.mark.parametrize("output", OUTPUTS)
def test_power_is_the_squared_field(method, size, output):
    """On the FFT's own frequencies, and others; N above, at and below the size of the mask."""
    shape = mask_of("grey", size)
    pixel = WIDTH / size
    for rows, columns in ((size, size), (2 * size, 3 * size + 1), (max(1, size // 2), size + 5)):
        spacing = (1 / (rows * pixel), 1 / (columns * pixel))
        check_power(shape, Grid(output, spacing), method)
        check_power(shape, Grid(output, spacing, (3 * spacing[0], -17 * spacing[1])), method)
        check_power(shape, Grid(output, spacing, (-2 * spacing[0], 0.0)), method)
    if method != "fft":
        for centre in ((0.0, 0.0), (11.3 / WIDTH, -407.7 / WIDTH), (0.0, 2.6 / WIDTH)):
            check_power(shape, Grid(output, (0.37 / WIDTH, 0.91 / WIDTH), centre), method)


@pytest.mark.parametrize("method", ["polygons", "auto"])
@pytest.mark.parametrize("output", [(1, 1), (1, 15), (14, 1), (12, 12), (11, 13), (40, 150), (33, 161)])
def test_power_of_outlines(method, output):
    for shape in (aperture.iris(7, WIDTH), aperture.iris(6, WIDTH, 0.5), aperture.circle(WIDTH)):
        for centre in ((0.0, 0.0), (11.3 / WIDTH, -27.7 / WIDTH), (0.0, 2.6 / WIDTH)):
            check_power(shape, Grid(output, (0.37 / WIDTH, 0.91 / WIDTH), centre), method)


@pytest.mark.parametrize(
    ("shape", "mirror"),
    [
        (aperture.iris(7, WIDTH), -1),  # a corner at +x: top to bottom
        (aperture.iris(7, WIDTH, rotation=np.pi / 2), 1),
        (aperture.iris(7, WIDTH, rotation=0.1), 0),
        (aperture.iris(5, WIDTH, 0.7), -1),
        (aperture.iris(6, WIDTH, 1.0), 1),
        (aperture.whirl(WIDTH, 5), 0),
        (aperture.circle(WIDTH), 1),
        (aperture.polygon([(0, 0), (WIDTH / 2, 0), (WIDTH / 2, WIDTH / 3)]), 0),
    ],
)
def test_outlines_that_are_their_own_mirror_image(shape, mirror):
    """A quarter of the plane is enough for them; one bent edge is not missed."""
    assert _shape(shape).mirror == mirror
    for size in ((12, 15), (1, 6), (131, 140)):
        grid = Grid(size, (0.9 / WIDTH, 1.3 / WIDTH))
        check(shape, grid, "polygons")
        check_power(shape, grid, "polygons")
    ring = shape.outlines[0]
    bulges = ring.bulges.copy()
    bulges[1 % len(bulges)] += 0.2
    bent = Aperture(WIDTH, (Outline(ring.vertices, bulges),))
    grid = Grid((12, 15), (0.9 / WIDTH, 1.3 / WIDTH))
    check(bent, grid, "polygons")
    check_power(bent, grid, "polygons")


def test_the_reference_has_a_power_in_float64():
    shape, grid = mask_of("grey", 5), Grid((4, 7), (1 / WIDTH, 0.3 / WIDTH))
    power = far_power(shape, grid, "reference")
    assert power.dtype == np.float64
    np.testing.assert_allclose(power, np.abs(far_field(shape, grid, "reference").amplitude) ** 2, rtol=1e-14)


@pytest.mark.parametrize("method", OF_PIXELS)
def test_outlines_are_rasterized_for_methods_of_pixels(method):
    heptagon = aperture.iris(7, WIDTH)
    grid = Grid((20, 21), (1 / WIDTH, 1 / WIDTH))
    found = far_field(heptagon, grid, method, raster_size=40).amplitude
    mask = aperture.from_mask(aperture.rasterize(heptagon, 40), WIDTH)
    wanted = far_field(mask, grid, "reference").amplitude
    np.testing.assert_allclose(found, wanted, rtol=0, atol=RELATIVE * aperture.area(heptagon))
    # A coverage raster is near the exact outline inside, and not the same.
    exact = far_field(heptagon, grid, "reference").amplitude
    error = np.max(np.abs(exact - wanted)) / aperture.area(heptagon)
    assert 1e-4 < error < 1e-2


@pytest.mark.parametrize("method", ["reference", *OF_PIXELS])
def test_a_dark_mask_has_no_far_field(method):
    dark = Aperture(1.0, mask=np.zeros((4, 4), dtype=np.float32))
    field = far_field(dark, Grid((4, 5), (1.0, 1.0)), method)
    np.testing.assert_array_equal(field.amplitude, np.zeros((4, 5)))


def test_auto_takes_outlines_exactly_and_pixels_by_fft_or_chirp(monkeypatch):
    taken = []
    for name in METHODS:
        original = METHODS[name]
        monkeypatch.setitem(METHODS, name, lambda a, g, n=name, f=original: taken.append(n) or f(a, g))
    raster = mask_of("grey", 8)
    far_field(aperture.iris(5, WIDTH), Grid((8, 8), (1 / WIDTH, 1 / WIDTH)))
    far_field(raster, Grid((8, 8), (1 / WIDTH, 0.5 / WIDTH)))
    far_field(raster, Grid((8, 8), (0.7 / WIDTH, 0.7 / WIDTH)))
    far_field(raster, Grid((8, 8), (1 / WIDTH, 1 / WIDTH), (0.5 / WIDTH, 0.0)))
    assert taken == ["polygons", "fft", "chirpz", "chirpz"]


def test_auto_is_as_good_as_what_it_takes():
    raster = mask_of("binary", 20)
    for spacing in (1.0, 0.777):
        check(raster, Grid((31, 32), (spacing / WIDTH, spacing / WIDTH)), "auto")


def test_an_outline_of_very_many_edges_is_rasterized():
    turns = np.linspace(0, 2 * np.pi, 5000, endpoint=False)
    many = aperture.polygon(WIDTH / 2 * np.stack([np.cos(turns), np.sin(turns)], axis=1))
    grid = Grid((9, 9), (0.8 / WIDTH, 0.8 / WIDTH))
    found = far_field(many, grid).amplitude
    wanted = far_field(aperture.circle(WIDTH), grid).amplitude
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-4 * aperture.area(many))


def test_quads_share_the_factors_of_equal_intervals():
    """One quad at a time gives the same sum, tall and wide lists alike."""
    for turn in (False, True):
        mask = np.zeros((16, 16))
        mask[2:14, 3:5] = mask[5:6, :] = 1
        quads = quadtree(mask.T if turn else mask, WIDTH)
        v, u = (np.arange(8) - 4.3) / WIDTH, (np.arange(9) - 3.1) / WIDTH
        grid = Grid((8, 9), (1 / WIDTH, 1 / WIDTH), (v[4], u[4]))
        alone = sum(
            weight * np.outer(box_factors(box[None, 1::2], v)[0], box_factors(box[None, 0::2], u)[0])
            for box, weight in zip(quads.rectangles, quads.weights, strict=True)
        )
        np.testing.assert_allclose(quads_field(quads, grid), alone, rtol=0, atol=1e-6 * WIDTH**2)


def test_float32_phases_hold_far_out():
    """At 4000 cycles per width the phase is 12,000 turns at the corner; float32 alone would lose it."""
    shape = mask_of("grey", 8)
    grid = Grid((9, 9), (0.37 / WIDTH, 0.37 / WIDTH), (4001.3 / WIDTH, -3999.4 / WIDTH))
    wanted = far_field(shape, grid, "reference").amplitude
    for method in ARBITRARY:
        found = far_field(shape, grid, method).amplitude
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-4 * np.max(np.abs(wanted)))


GRID = Grid((8, 8), (1.0, 1.0))
ROUND = aperture.circle(1.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: far_field(mask_of("grey", 4), Grid((8, 8), (0.7 / WIDTH, 1 / WIDTH)), "fft"),
            "method 'fft' needs a spacing of 1 / (N pixels) with a whole N and a centre that is a "
            "multiple of it; use method 'chirpz', which takes any grid.",
        ),
        (
            lambda: far_field(
                mask_of("grey", 4), Grid((8, 8), (1 / WIDTH, 1 / WIDTH), (0.0, 0.25 / WIDTH)), "fft"
            ),
            "method 'fft' needs a spacing of 1 / (N pixels) with a whole N and a centre that is a "
            "multiple of it; use method 'chirpz', which takes any grid.",
        ),
        (
            lambda: far_field(mask_of("grey", 4), Grid((8, 8), (9 / WIDTH, 9 / WIDTH)), "fft"),
            "method 'fft' needs a spacing of 1 / (N pixels) with a whole N and a centre that is a "
            "multiple of it; use method 'chirpz', which takes any grid.",
        ),
        (
            lambda: far_field(mask_of("grey", 4), GRID, "polygons"),
            "method 'polygons' needs outlines and this aperture is a raster; use 'quads'.",
        ),
        (
            lambda: far_field(ROUND, GRID, "chirp"),
            "'method' must be one of 'auto', 'reference', 'polygons', 'quads', 'rows', 'chirpz', "
            "'fft', got 'chirp'. Did you mean 'chirpz'?",
        ),
        (
            lambda: far_field(ROUND, GRID, "quads", raster_size=0),
            "'size' must be an integer >= 1, got 0.",
        ),
    ],
)
def test_methods_that_cannot_serve_refuse(make, message, monkeypatch):
    with refused(message):
        make()
    # The power has the same refusals.
    monkeypatch.setitem(globals(), "far_field", far_power)
    with refused(message):
        make()


@pytest.mark.parametrize(
    ("grid", "message"),
    [
        (Grid((0, 8), (1.0, 1.0)), "'grid rows' must be an integer >= 1, got 0."),
        (Grid((8, -1), (1.0, 1.0)), "'grid columns' must be an integer >= 1, got -1."),
        (Grid((8, 2.5), (1.0, 1.0)), "'grid columns' must be an integer >= 1, got 2.5."),
        (Grid((8, 8), (0.0, 1.0)), "'grid spacing of the rows' must be a finite number > 0, got 0."),
        (Grid((8, 8), (1.0, np.nan)), "'grid spacing of the columns' must be a finite number > 0, got nan."),
        (
            Grid((8, 8), (1.0, 1.0), (np.inf, 0)),
            "'grid centre of the rows' must be a finite number, got inf.",
        ),
        (Grid((8,), (1.0, 1.0)), "'grid shape' must be an array of shape (2), got (1,)."),
        (Grid((8, 8), 1.0), "'grid spacing' must be an array of shape (2), got ()."),
        (Grid((8, 8), (1.0, 1.0), (0, 0, 0)), "'grid centre' must be an array of shape (2), got (3,)."),
    ],
)
def test_grids_that_are_none_are_refused(grid, message):
    with refused(message):
        check_grid(grid)
    for door in (far_field, far_power):
        with refused(message):
            door(ROUND, grid)


def test_good_grids_pass():
    assert check_grid(Grid((1, 1), (1e-9, 1e9), (-5.0, 0.0))) is None
    assert check_grid(Grid((np.int64(3), 4), (1, 1), (0, 0))) is None
