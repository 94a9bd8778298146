"""Laws of the starburst: Airy's pattern, its energy in rings and pixels, and over all wavelengths."""

import math
import re

import numpy as np
import pytest
from scipy import special

from aureole import Grid, aperture, light, refuse
from aureole.diffraction import starburst, starburst_stages

D = 3e-3  # metres, of every opening here
LINE = 550e-9
GREEN = light.line(LINE)
CIRCLE = aperture.circle(D)
SHAPES = {
    "circle": CIRCLE,
    "heptagon": aperture.iris(7, D, rotation=0.2),
    "ring": aperture.subtraction(CIRCLE, aperture.circle(0.4 * D)),
    "mask": aperture.from_mask(aperture.rasterize(aperture.iris(5, D), 24), D),
}
PEAK = 1e-3  # error of "scaled" over the brightest pixel
SUM = 1e-3  # and of its sum


def pixels(shape, pitch, centre=(0.0, 0.0)):
    """Return a grid whose pixels are so many λ / D of the line across; its centre in pixels."""
    step = pitch * LINE / D
    return Grid(shape, (step, step), (centre[0] * step, centre[1] * step))


def airy_density(s, wavelength):
    """|F|² / (λ² ∬|f|²) of the circle: (π R² / λ²) (2 J1(x) / x)², x = 2 π R s / λ."""
    x = np.pi * D * s / wavelength
    safe = np.where(x == 0, 1.0, x)
    return math.pi * D**2 / 4 / wavelength**2 * np.where(x == 0, 1.0, 2 * special.j1(safe) / safe) ** 2


def radius_of(grid):
    y, x = grid.axes()
    return np.hypot(y[:, None], x)


def luminance(*args, **kwargs):
    return starburst(*args, **kwargs).pixels[..., 1].astype(float)


@pytest.mark.parametrize("method", ["auto", "exact", "scaled"])
@pytest.mark.parametrize("shape", [(41, 41), (40, 37)])
@pytest.mark.parametrize("centre", [(0.0, 0.0), (3.3, -7.25)])
def test_points_are_airys_pattern(method, shape, centre):
    grid = pixels(shape, 0.13, centre)
    wanted = airy_density(radius_of(grid), LINE) * grid.spacing[0] * grid.spacing[1]
    found = luminance(CIRCLE, grid, GREEN, method, "point")
    # A line that is looked up between samples is as exact as their interpolation.
    tolerance = 1e-4 if method != "scaled" else PEAK
    np.testing.assert_allclose(found, wanted, rtol=0, atol=tolerance * wanted.max())


@pytest.mark.parametrize("pitch", [0.3, 0.9, 2.5])
@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.5, -0.25), (2.0, 9.0)])
def test_pixels_integrate_airys_pattern(pitch, centre):
    """By Simpson's rule on 81 × 81 points a pixel."""
    grid = pixels((8, 7), pitch, centre)
    weights = np.tile([2.0, 4.0], 41)[:81]
    weights[0] = weights[-1] = 1
    weights /= weights.sum()
    parts = (np.arange(81) - 40) / 80 * grid.spacing[0]
    y, x = (axis[:, None] + parts for axis in grid.axes())
    density = airy_density(np.hypot(y[:, None, :, None], x[None, :, None, :]), LINE)
    wanted = np.einsum("rcyx,y,x->rc", density, weights, weights) * grid.spacing[0] ** 2
    found = luminance(CIRCLE, grid, GREEN)
    peak = airy_density(0.0, LINE) * grid.spacing[0] ** 2
    np.testing.assert_allclose(found, wanted, rtol=0, atol=5e-5 * min(peak, 1))
    np.testing.assert_allclose(found, wanted, rtol=0, atol=2e-3 * wanted.max())


@pytest.mark.parametrize("method", ["exact", "scaled"])
@pytest.mark.parametrize(("zero", "share"), [(1.2197, 0.838), (2.2331, 0.910)])
def test_encircled_energy(method, zero, share):
    """83.8 % and 91.0 % within the first two dark rings (Born and Wolf, Table 8.2)."""
    grid = pixels((101, 101), 0.05)
    energy = luminance(CIRCLE, grid, GREEN, method)
    inside = energy[radius_of(grid) * D / LINE < zero].sum()
    assert inside == pytest.approx(share, abs=2e-3)
    # Rayleigh 1881: 1 − J0² − J1² at the ring.
    x = math.pi * zero
    assert inside == pytest.approx(1 - special.j0(x) ** 2 - special.j1(x) ** 2, abs=2e-3)


@pytest.mark.parametrize("name", ["E", "D65"])
def test_every_wavelength_is_an_airy_pattern_of_its_own(name):
    """Σ over the observer's 1 nm table, each at its own scale."""
    grid = pixels((21, 22), 0.4)
    wavelengths, functions = light.observer()
    spectrum = light.illuminant(name)
    power = np.interp(wavelengths, spectrum.wavelengths, spectrum.values, left=0, right=0)
    weights = power[:, None] * functions
    weights /= weights[:, 1].sum()
    density = airy_density(radius_of(grid)[..., None], wavelengths)
    wanted = np.einsum("yxw,wc->yxc", density, weights) * grid.spacing[0] ** 2
    for method in ("exact", "scaled"):
        found = starburst(CIRCLE, grid, spectrum, method, "point").pixels
        np.testing.assert_allclose(found, wanted, rtol=0, atol=PEAK * wanted.max())


@pytest.mark.parametrize(
    ("name", "lamp", "shape", "pitch"),
    [
        (name, lamp, shape, pitch)
        for name, lamp in (("circle", "E"), ("ring", "D65"), ("mask", "E"))
        for shape, pitch in (((15, 14), 0.25), ((13, 17), 0.8), ((5, 5), 0.7), ((1, 9), 2.0))
    ]
    + [("heptagon", "D65", (13, 14), 0.8)],
)
def test_scaled_agrees_with_exact(name, lamp, shape, pitch):
    """Also on fields smaller than the core."""
    spectrum, grid = light.illuminant(lamp), pixels(shape, pitch)
    exact = starburst(SHAPES[name], grid, spectrum, "exact").pixels
    scaled = starburst(SHAPES[name], grid, spectrum, "scaled").pixels
    np.testing.assert_allclose(scaled, exact, rtol=0, atol=PEAK * exact.max())
    sums = [field.sum(axis=(0, 1), dtype=float) for field in (exact, scaled)]
    np.testing.assert_allclose(sums[1], sums[0], rtol=SUM)


@pytest.mark.parametrize("centre", [(0.4, -0.3), (9.0, 4.5), (-6.0, 0.0)])
def test_scaled_agrees_with_exact_off_the_centre(centre):
    """Against the peak of the whole pattern, and the sum of what the field holds."""
    spectrum, mask = light.illuminant("D65"), SHAPES["mask"]
    peak = starburst(mask, pixels((1, 1), 0.6), spectrum, "exact").pixels.max()
    grid = pixels((11, 12), 0.6, centre)
    exact, scaled = (starburst(mask, grid, spectrum, method).pixels for method in ("exact", "scaled"))
    np.testing.assert_allclose(scaled, exact, rtol=0, atol=PEAK * peak)
    np.testing.assert_allclose(scaled.sum(axis=(0, 1)), exact.sum(axis=(0, 1)), rtol=5 * SUM)


def test_scaled_agrees_with_exact_far_out():
    """Where fringes are finer than pixels these differ by some per cent, their sum by a part of that."""
    spectrum, grid = light.illuminant("E"), pixels((16, 16), 0.7, (45.0, 30.0))
    exact, scaled = (starburst(SHAPES["mask"], grid, spectrum, m).pixels for m in ("exact", "scaled"))
    np.testing.assert_allclose(scaled.sum(axis=(0, 1)), exact.sum(axis=(0, 1)), rtol=0.01)
    assert np.median(np.abs(scaled / exact - 1)) < 0.15


@pytest.mark.parametrize("name", ["circle", "heptagon", "mask"])
def test_batches_agree_with_exact(name):
    """Also beyond the core, where 60 wavelengths leave bands of some per cent."""
    spectrum, grid = light.illuminant("E"), pixels((80, 81), 0.7)
    exact, batch = (starburst(SHAPES[name], grid, spectrum, method).pixels for method in ("exact", "batch"))
    np.testing.assert_allclose(batch, exact, rtol=0, atol=PEAK * exact.max())
    np.testing.assert_allclose(batch.sum(axis=(0, 1)), exact.sum(axis=(0, 1)), rtol=1e-3)
    y, x = np.ogrid[:80, :81]
    outside = np.hypot(y - 40, x - 40) > 30
    assert 1e-4 < np.median(np.abs(batch[outside] / exact[outside] - 1)) < 0.15


def test_batches_refuse_lines():
    with pytest.raises(refuse.Refusal, match="method 'batch' needs a light that is not made of lines"):
        starburst(CIRCLE, pixels((3, 3), 1.0), GREEN, "batch")


@pytest.mark.parametrize("name", ["circle", "heptagon"])
@pytest.mark.parametrize("lamp", ["E", "D65"])
@pytest.mark.parametrize("pitch", [0.7, 2.1])
def test_a_large_field_holds_all_light_and_its_white(name, lamp, pitch):
    """Beyond a square of half side S lies about 0.9 P λ / (2 π² S A) of the light (Porod's law).

    P is the perimeter and A the area. What is looked up at scaled places may add a few parts in ten
    thousand to the bluest streaks, never to the luminance as a whole.
    """
    shape, spectrum, count = SHAPES[name], light.illuminant(lamp), 301
    found = starburst(shape, pixels((count, count), pitch), spectrum).pixels.sum(axis=(0, 1), dtype=float)
    white = light.white(spectrum)
    perimeter = np.hypot(*aperture.boundary_nodes(shape.outlines[0], D)[1].T).sum()
    beyond = 0.9 * perimeter * D / (math.pi**2 * count * pitch * aperture.area(shape))
    assert found[1] < 1
    assert found[1] == pytest.approx(1 - beyond, abs=5e-4)
    np.testing.assert_allclose(found / white, 1 - beyond, rtol=0, atol=2e-3)


def test_exact_never_holds_more_than_all_light():
    for pitch in (0.2, 1.0, 4.0):
        for name in ("circle", "ring", "mask"):
            energy = luminance(SHAPES[name], pixels((25, 24), pitch), GREEN)
            assert energy.min() >= 0
            assert 0.8 < energy.sum() < 1


def test_energy_grows_with_the_field():
    sums = [
        luminance(SHAPES["heptagon"], pixels((count, count), 0.7), light.illuminant("E")).sum()
        for count in (1, 2, 5, 20, 41, 120)
    ]
    assert np.all(np.diff(sums) > 0)
    assert sums[-1] < 1


@pytest.mark.parametrize("method", ["exact", "scaled"])
def test_a_pixel_does_not_depend_on_the_field_around_it(method):
    """Odd, even and off-centre fields share their pixels."""
    spectrum = GREEN if method == "exact" else light.illuminant("E")
    shape, whole = SHAPES["heptagon"], pixels((33, 33), 0.6)
    energy = starburst(shape, whole, spectrum, method).pixels
    tolerance = {"exact": 1e-5, "scaled": PEAK / 2}[method] * energy.max()
    even = starburst(shape, pixels((12, 10), 0.6), spectrum, method).pixels
    np.testing.assert_allclose(even, energy[10:22, 11:21], rtol=0, atol=tolerance)
    off = starburst(shape, pixels((9, 8), 0.6, (-5.0, 7.0)), spectrum, method).pixels
    np.testing.assert_allclose(off, energy[7:16, 19:27], rtol=0, atol=tolerance)


@pytest.mark.parametrize("method", ["exact", "scaled"])
@pytest.mark.parametrize("name", ["heptagon", "mask"])
def test_symmetric_about_the_axis(method, name):
    """|F(−q)|² = |F(q)|², of whatever shape, and however many blades."""
    spectrum = GREEN if method == "exact" else light.illuminant("D65")
    field = starburst(SHAPES[name], pixels((31, 29), 0.7), spectrum, method).pixels
    np.testing.assert_allclose(field, field[::-1, ::-1], rtol=0, atol=2e-6 * field.max())


def test_turns_with_the_opening():
    """Counter-clockwise as seen, as an iris's rotation."""
    quarter = aperture.rotated(SHAPES["heptagon"], math.pi / 2)
    grid = pixels((21, 21), 0.7)
    here, there = (luminance(shape, grid, GREEN) for shape in (SHAPES["heptagon"], quarter))
    np.testing.assert_allclose(there, np.rot90(here), rtol=0, atol=1e-5 * here.max())
    assert np.max(np.abs(there - here)) > 1e-4 * here.max()


def test_similarity():
    """An opening half as wide spreads light twice as far; so does twice the wavelength."""
    grid = pixels((15, 15), 0.7)
    step = 2 * grid.spacing[0]
    wide = Grid(grid.shape, (step, step))
    heptagon = SHAPES["heptagon"]
    wanted = luminance(heptagon, grid, light.line(380e-9))
    small = luminance(aperture.scaled(heptagon, 0.5), wide, light.line(380e-9))
    np.testing.assert_allclose(small, wanted, rtol=0, atol=1e-5 * wanted.max())
    red = luminance(heptagon, wide, light.line(760e-9))
    np.testing.assert_allclose(red, wanted, rtol=0, atol=1e-5 * wanted.max())


def test_a_dimmed_opening_spreads_its_light_alike():
    """Fractions of what passes, whatever passes."""
    grid = pixels((9, 9), 0.7)
    for name in ("heptagon", "mask"):
        full, dim = (luminance(s, grid, GREEN) for s in (SHAPES[name], aperture.dimmed(SHAPES[name], 0.3)))
        np.testing.assert_allclose(dim, full, rtol=1e-5, atol=1e-8)


@pytest.mark.parametrize("method", ["exact", "scaled"])
def test_a_line_has_the_colour_of_its_wavelength(method):
    field = starburst(CIRCLE, pixels((9, 9), 0.5), GREEN, method).pixels
    wanted = field[..., 1:2] * light.white(GREEN)
    np.testing.assert_allclose(field, wanted, rtol=1e-5)


def test_lines_add_up_by_their_luminance():
    grid = pixels((11, 11), 0.6)
    lines = light.spectrum([460e-9, 610e-9], [3.0, 0.5], "lines")
    parts = [light.line(460e-9), light.line(610e-9)]
    share = np.array([3.0, 0.5]) * [light.tristimulus(part)[1] for part in parts]
    share /= share.sum()
    wanted = sum(s * starburst(CIRCLE, grid, part).pixels for s, part in zip(share, parts, strict=True))
    found = starburst(CIRCLE, grid, lines).pixels
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-6 * wanted.max())


def test_a_raster_is_near_its_outline():
    raster = aperture.from_mask(aperture.rasterize(SHAPES["heptagon"], 1024), D)
    for spectrum in (GREEN, light.illuminant("E")):
        grid = pixels((17, 16), 0.7)
        outline, pixelled = (luminance(s, grid, spectrum) for s in (SHAPES["heptagon"], raster))
        np.testing.assert_allclose(pixelled, outline, rtol=0, atol=1e-3 * outline.max())
        assert pixelled.sum() == pytest.approx(outline.sum(), rel=2e-3)


def test_many_small_points_make_a_pixel():
    """The area of a pixel is the sum of nine small ones."""
    large = luminance(SHAPES["heptagon"], pixels((7, 7), 0.9), GREEN)
    small = luminance(SHAPES["heptagon"], pixels((21, 21), 0.3), GREEN)
    summed = small.reshape(7, 3, 7, 3).sum(axis=(1, 3))
    np.testing.assert_allclose(summed, large, rtol=0, atol=1e-5 * large.max())


@pytest.mark.parametrize("method", ["exact", "scaled"])
def test_the_last_stage_is_the_starburst(method):
    grid, spectrum = pixels((6, 7), 0.8), light.illuminant("D65")
    stages = list(starburst_stages(CIRCLE, grid, spectrum, method))
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert fractions[0] == 0
    assert fractions[-1] == 1
    assert all(stage.label and stage.result is None for stage in stages[:-1])
    whole = starburst(CIRCLE, grid, spectrum, method)
    np.testing.assert_array_equal(stages[-1].result.pixels, whole.pixels)
    assert whole.colour_space == "xyz"
    assert whole.pixels.dtype == np.float32
    assert whole.pixels.shape == (6, 7, 3)


def test_auto_is_exact_for_few_lines_and_scaled_elsewhere():
    grid = pixels((5, 5), 0.8)
    lines = light.spectrum([450e-9, 550e-9, 650e-9], [1.0, 1.0, 1.0], "lines")
    for spectrum, method in ((lines, "exact"), (light.illuminant("E"), "scaled")):
        auto, chosen = (starburst(CIRCLE, grid, spectrum, name).pixels for name in ("auto", method))
        np.testing.assert_array_equal(auto, chosen)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"method": "scald"},
            "'method' must be one of 'auto', 'exact', 'scaled', 'batch', 'coherence', got 'scald'. "
            "Did you mean 'scaled'?",
        ),
        (
            {"sample": "centre"},
            "'sample' must be one of 'area', 'point', got 'centre'.",
        ),
        ({"grid": Grid((0, 4), (1.0, 1.0))}, "'grid rows' must be an integer >= 1, got 0."),
        (
            {"grid": Grid((4, 4), (1.0, -1.0))},
            "'grid spacing of the columns' must be a finite number > 0, got -1.",
        ),
        (
            {"grid": Grid((4, 4), (1.0, 1.0), (0.0, math.nan))},
            "'grid centre of the columns' must be a finite number, got nan.",
        ),
    ],
)
def test_refusals(change, message):
    asked = {"grid": pixels((4, 4), 0.5), "spectrum": GREEN, **change}
    with pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$"):
        starburst(CIRCLE, **asked)
